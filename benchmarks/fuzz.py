"""Bad input to every command: mutated cases and damaged files, none of which may end in a traceback or take long.

    OMP_NUM_THREADS=1 python benchmarks/fuzz.py                    # 1500 cases, 50 copies of every format
    OMP_NUM_THREADS=1 python benchmarks/fuzz.py 200 5 --seed 7     # fewer, others

Every case goes through `gearwhine check`; those that it accepts through the cheap commands as well: what `check` lets
pass, later commands refuse in words or do. Each runs in a process of its own, which is stopped after the limit.
"""

import argparse
import copy
import json
import math
import os
import random
import select
import signal
import sys
import tempfile
import time
import tomllib
import traceback
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gearwhine.analyses.machine_results

LIMIT = 10.0  # seconds of a command
UNFORESEEN = 70  # exit code of a child that raised what nobody foresaw
STOPPED = -1
COMMANDS = ("rotors", "gears", "system", "mesh")

HOSTILE: tuple[Any, ...] = (
    *(0, -1, 1, 10**30, -(10**30), 2**63, 0.0, -0.0, 1e-300, 1e300, math.inf, -math.inf, math.nan, True, False),
    *("", " ", "nan", "inf", "1e400 mm", "1e300 m", "1e-300 m", "-5 mm", "0 mm", "5 parsec", "5 kg", "mm", "1e", "½ m"),
    *("a" * 40_000, "x\u0000y", "\u202egnp.exe", "Ünïcode ☃", "../../etc/passwd", "/dev/zero", "[", "'", "\n", "5 rpm"),
    *([], [[]], {}, {"": 1}, {"a": {"b": {}}}, [1, 2, 3], ["1 mm"] * 1000, [math.nan] * 3, [{}]),
)
FACTORS = (0.0, -1.0, 1e-12, 1e-3, 0.1, 0.9, 1.1, 10.0, 1e3, 1e6, 1e12, 1e30, 1e200)

Document = dict[str, Any]
Path_ = tuple[Any, ...]


@dataclass(frozen=True)
class Outcome:
    """How a command ended: its exit code, `UNFORESEEN` or `STOPPED`, after how long [s], and what it said."""

    code: int
    seconds: float
    said: str

    @property
    def fault(self) -> str:
        """What is wrong with it; empty for nothing."""
        if self.code == STOPPED:
            return f"still at work after {self.seconds:.1f} s"
        if self.code not in (0, 1, 2) or "Traceback" in self.said:
            return self.said.strip().rpartition("\n")[2][:300] or f"ended with {self.code}"
        if self.seconds > LIMIT:
            return f"took {self.seconds:.1f} s"
        if self.code == 1 and not self.said.strip():
            return "failed without a word"
        return ""


def run(arguments: list[str], folder: Path, limit: float = 3.0 * LIMIT) -> Outcome:
    """Run a command in a process of its own, in a folder, and stop it after a limit."""
    said = folder / "said.txt"
    begin = time.monotonic()
    child = os.fork()
    if child == 0:
        _in_child(arguments, folder, said)
    watch = os.pidfd_open(child)
    ready, _, _ = select.select([watch], [], [], limit)
    os.close(watch)
    if not ready:
        os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    seconds = time.monotonic() - begin
    text = said.read_text(encoding="utf-8", errors="replace") if said.is_file() else ""
    return Outcome(os.waitstatus_to_exitcode(status) if ready else STOPPED, seconds, text)


def _in_child(arguments: list[str], folder: Path, said: Path) -> None:
    code = UNFORESEEN
    try:
        os.chdir(folder)
        target = os.open(said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        nothing = os.open(os.devnull, os.O_RDWR)
        os.dup2(nothing, 0)
        os.dup2(nothing, 1)
        os.dup2(target, 2)
        sys.stdout, sys.stderr = os.fdopen(1, "w", encoding="utf-8"), os.fdopen(2, "w", encoding="utf-8")
        from gearwhine.cli import run_command

        code = run_command(arguments)
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os._exit(code)


def written(value: Any) -> str:
    """A value as TOML, tables inline."""
    match value:
        case bool():
            return "true" if value else "false"
        case float() if math.isnan(value):
            return "nan"
        case float() if math.isinf(value):
            return "inf" if value > 0.0 else "-inf"
        case int() | float():
            return repr(value)
        case str():
            return json.dumps(value)
        case list():
            return "[" + ", ".join(written(one) for one in value) + "]"
        case dict():
            return "{ " + ", ".join(f"{json.dumps(str(key))} = {written(one)}" for key, one in value.items()) + " }"
        case _:
            return json.dumps(str(value))


def case_text(document: Document) -> str:
    """A document as a case file."""
    return "\n".join(f"{json.dumps(str(key))} = {written(value)}" for key, value in document.items()) + "\n"


def places(value: Any, here: Path_ = ()) -> Iterator[Path_]:
    """Where anything stands in nested tables and lists, outermost first."""
    if here:
        yield here
    if isinstance(value, dict):
        for key in value:
            yield from places(value[key], (*here, key))
    elif isinstance(value, list):
        for number in range(len(value)):
            yield from places(value[number], (*here, number))


def at(document: Any, place: Path_) -> Any:
    for key in place:
        document = document[key]
    return document


def mutated(random: random.Random, document: Document, donors: list[Document]) -> Document:
    """A copy with one to three changes; what it says of its numbers goes, which no change could leave true."""
    changed = copy.deepcopy(document)
    changed.pop("provenance", None)
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        everywhere = list(places(changed))
        if not everywhere:
            break
        place = random.choice(everywhere)
        holder, key, value = at(changed, place[:-1]), place[-1], at(changed, place)
        random.choice(CHANGES)(random, changed, holder, key, value, donors)
    return changed


def _hostile(random: random.Random, changed: Any, holder: Any, key: Any, value: Any, donors: Any) -> None:
    holder[key] = copy.deepcopy(random.choice(HOSTILE))


def _scaled(random: random.Random, changed: Any, holder: Any, key: Any, value: Any, donors: Any) -> None:
    factor = random.choice(FACTORS)
    if isinstance(value, bool):
        holder[key] = not value
    elif isinstance(value, int):
        holder[key] = int(value * factor) if abs(value * factor) < 1e18 else value * factor
    elif isinstance(value, float):
        holder[key] = value * factor
    elif isinstance(value, str):
        number, _, unit = value.partition(" ")
        try:
            holder[key] = f"{float(number) * factor!r} {unit}".strip()
        except ValueError:
            holder[key] = value + random.choice(("x", "-1", " ", "é"))
    else:
        _dropped(random, changed, holder, key, value, donors)


def _dropped(random: random.Random, changed: Any, holder: Any, key: Any, value: Any, donors: Any) -> None:
    del holder[key]


def _doubled(random: random.Random, changed: Any, holder: Any, key: Any, value: Any, donors: Any) -> None:
    if isinstance(holder, list):
        holder.insert(random.randrange(len(holder) + 1), copy.deepcopy(value))
    else:
        holder[f"{key}2" if random.random() < 0.5 else str(key) * 1000] = copy.deepcopy(value)


def _renamed(random: random.Random, changed: Any, holder: Any, key: Any, value: Any, donors: Any) -> None:
    if isinstance(holder, dict):
        name = random.choice((str(key)[:-1], str(key).upper(), "", "x" * 40_000, "名前", f"{key}.{key}", f"{key} "))
        holder[name] = holder.pop(key)


def _swapped(random: random.Random, changed: Any, holder: Any, key: Any, value: Any, donors: Any) -> None:
    other = random.choice(list(places(changed)))
    holder[key] = copy.deepcopy(at(changed, other))


def _grafted(random: random.Random, changed: Any, holder: Any, key: Any, value: Any, donors: Any) -> None:
    donor = random.choice(donors)
    place = random.choice(list(places(donor)))
    part = copy.deepcopy(at(donor, place))
    if isinstance(holder, dict) and random.random() < 0.7:
        named = [name for name in place if isinstance(name, str)]
        holder[named[-1] if named else key] = part
    else:
        holder[key] = part


CHANGES: tuple[Callable[..., None], ...] = (
    _hostile,
    _hostile,
    _scaled,
    _scaled,
    _scaled,
    _dropped,
    _doubled,
    _renamed,
    _swapped,
    _grafted,
)


def damaged(random: random.Random, content: bytes) -> bytes:
    """A file cut short, with bytes flipped, lost, doubled or zeroed, or numbers in it changed."""
    data = bytearray(content)
    if not data:
        return b""
    kind = random.randrange(7)
    begin = random.randrange(len(data))
    length = random.choice((1, 4, 64, 1024, len(data) // 10 + 1))
    if kind == 0:
        return bytes(data[:begin])
    if kind == 1:
        for _ in range(random.choice((1, 8, 200))):
            data[random.randrange(len(data))] ^= 1 << random.randrange(8)
    elif kind == 2:
        del data[begin : begin + length]
    elif kind == 3:
        data[begin:begin] = data[begin : begin + length]
    elif kind == 4:
        data[begin : begin + length] = bytes(len(data[begin : begin + length]))
    elif kind == 5:
        data[begin : begin + length] = random.randbytes(len(data[begin : begin + length]))
    else:
        digits = [place for place, byte in enumerate(data) if 48 <= byte <= 57]
        for place in random.sample(digits, min(len(digits), random.choice((1, 5, 50)))):
            data[place] = random.choice(b"0123456789-.eN")
    return bytes(data)


def case_outcomes(random: random.Random, count: int, folder: Path) -> Iterator[tuple[str, Path, Outcome]]:
    """Mutated cases through `check`, and those that pass through another command: what ran, on which file, and how."""
    from gearwhine.case.load import bundled_case, bundled_names

    texts = [bundled.read_bytes() for name in bundled_names() if (bundled := bundled_case(name)) is not None]
    documents = [tomllib.loads(text.decode()) for text in texts]
    for number in range(count):
        place = folder / f"case-{number:04d}.toml"
        if random.random() < 0.1:
            place.write_bytes(damaged(random, random.choice(texts)))
        else:
            text = case_text(mutated(random, random.choice(documents), documents))
            place.write_text(text, encoding="utf-8", errors="surrogateescape")
        outcome = run(["check", place.name], folder)
        yield "check", place, outcome
        if outcome.code != 0:
            continue
        document = tomllib.loads(place.read_text(encoding="utf-8-sig"))
        fitting = [command for command in COMMANDS if _fits(command, document)]
        if fitting:
            command = random.choice(fitting)
            changes = ["--set", "housing.box.mesh_size=40 mm"] if command == "mesh" else []
            # Thousands of speeds are long work, and no fault.
            changes += ["--set", "sweep="] if "sweep" in document else []
            yield command, place, run([command, place.name, "-q", *changes], folder)


def _fits(command: str, document: Document) -> bool:
    """Whether a case has what a command is for, and asks no hours of it."""
    if command == "mesh":
        return "box" in document.get("housing", {})
    if command == "system":
        return "rotor" in document and "operation" in document and "housing" not in document
    return {"rotors": "rotor", "gears": "gear_pair"}[command] in document


def file_outcomes(
    random: random.Random, count: int, folder: Path, formats: Sequence[str] = ()
) -> Iterator[tuple[str, Path, Outcome]]:
    """Damaged copies of every format, or of some, through the command that reads it; the first copy is sound."""
    if not count:
        return
    from fuzz_files import readable_files

    for format_, content, name, command in readable_files(folder, formats):
        for number in range(count + 1):
            place = folder / f"{format_}-{number:03d}"
            place.mkdir()
            for other, more in content.items():
                (place / other).parent.mkdir(parents=True, exist_ok=True)
                (place / other).write_bytes(damaged(random, more) if number and other == name else more)
            outcome = run(command, place)
            # Copy 0 is sound: what refuses it would prove nothing of the others.
            if not number and outcome.code != 0:
                raise RuntimeError(f"a sound {format_} file ends with {outcome.code}: {outcome.said}")
            yield format_, place / name, outcome


def main() -> int:
    """Print what failed, and how many of each ended how."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("cases", nargs="?", type=int, default=1500)
    parser.add_argument("copies", nargs="?", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="a folder for all files; otherwise only names of faults are told")
    given = parser.parse_args()

    assert gearwhine.analyses.machine_results
    faults, ends, slowest = 0, Counter[tuple[str, int]](), 0.0
    with tempfile.TemporaryDirectory(prefix="gearwhine-fuzz-") as name:
        folder = given.keep or Path(name)
        folder.mkdir(parents=True, exist_ok=True)
        for outcomes in (
            case_outcomes(random.Random(given.seed), given.cases, folder),
            file_outcomes(random.Random(given.seed), given.copies, folder),
        ):
            for what, place, outcome in outcomes:
                ends[what, outcome.code] += 1
                slowest = max(slowest, outcome.seconds)
                if outcome.fault:
                    faults += 1
                    print(f"{what} {place.relative_to(folder)}: {outcome.fault}", flush=True)
    for (what, code), number in sorted(ends.items()):
        print(f"| {what} | {code} | {number} |")
    print(f"{faults} faults; the slowest took {slowest:.1f} s")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
