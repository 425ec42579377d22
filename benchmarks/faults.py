"""Puts hand-made faults into the code, one at a time, and tells which of them the tests let through: faults.py

Each fault replaces a piece of one file: two axes swapped, a sign, a unit, a name. The faults of a room stand in
`tests/faults/ROOM.toml`, as `[[fault]]` with `area`, `file`, `before` (which the file has once) and `after`; the tests
of each area in `tests/faults/areas.toml`. These run on a copy of the tree with the fault in it; where all of them pass,
it is missed. The copies, one for each worker, stand in a temporary folder with kernels of their own, and the checkout
is not touched::

    python benchmarks/faults.py                       # all: half a day on two cores
    python benchmarks/faults.py --sample 60           # as many at random, the same for the same --seed
    python benchmarks/faults.py --area figures --area report
    python benchmarks/faults.py --only 12 --only 40   # by number, with the end of the tests' output
    python benchmarks/faults.py --check               # whether every fault still fits the code; runs no tests
"""

import argparse
import ast
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tomllib
from collections import Counter
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

from traced_lines import ROOMS

ROOT = Path(__file__).parent.parent
LISTS = ROOT / "tests" / "faults"
# pytest's exit codes for its own failure, wrong usage and no tests; of a process that is ended for want of memory
_NO_VERDICT = (3, 4, 5, -signal.SIGKILL, -signal.SIGTERM)


@dataclass(frozen=True)
class Fault:
    """A piece of a file and what stands in its place; ``number`` is its place in the lists of all rooms, from 1."""

    number: int
    area: str
    file: str
    before: str
    after: str

    def changed(self, text: str) -> str:
        """The text of the file with the fault in it.

        Raises
        ------
        ValueError
            Where the piece does not stand in the text exactly once.
        """
        if text.count(self.before) != 1:
            raise ValueError(
                f"fault {self.number}: {self.before!r} stands {text.count(self.before)} times in {self.file}; "
                "expected once"
            )
        return text.replace(self.before, self.after)

    def put_into(self, root: Path) -> str:
        """Change the file below a root, and return its text as it was.

        Raises
        ------
        ValueError
            As :meth:`changed`.
        """
        path = root / self.file
        text = path.read_text(encoding="utf-8")
        path.write_text(self.changed(text), encoding="utf-8")
        return text


def read_faults() -> tuple[list[Fault], dict[str, list[str]]]:
    """The faults, and for each area the tests that are to catch its faults."""
    listed = [(room, entry) for room in ROOMS for entry in read_list(room).get("fault", [])]
    faults = [Fault(number, **entry) for number, (_, entry) in enumerate(listed, start=1)]
    for fault, (room, _) in zip(faults, listed, strict=True):
        if not fault.file.startswith(f"{room}/"):
            raise ValueError(f"fault {fault.number}: {fault.file} stands in {room}.toml; expected a file of {room}")
    tests = read_list("areas")["tests"]
    unknown = {fault.area for fault in faults} - set(tests)
    if unknown:
        raise ValueError(f"areas without tests: {', '.join(sorted(unknown))}")
    return faults, tests


def read_list(name: str) -> dict[str, Any]:
    """What a file of `tests/faults` holds."""
    return tomllib.loads((LISTS / f"{name}.toml").read_text(encoding="utf-8"))


def misfits(faults: list[Fault], tests: dict[str, list[str]]) -> list[str]:
    """Why the list does not fit the code, a sentence each: lost files and tests, pieces that moved, broken syntax."""
    wrong = [f"area {area}: no test {name}" for area, names in tests.items() for name in names if not exists(name)]
    texts: dict[str, str] = {}
    starts: dict[str, list[int]] = {}
    for fault in faults:
        if not exists(fault.file):
            wrong.append(f"fault {fault.number}: no file {fault.file}")
            continue
        if fault.file not in texts:
            texts[fault.file] = text = (ROOT / fault.file).read_text(encoding="utf-8")
            starts[fault.file] = statement_starts(text) if fault.file.endswith(".py") else []
        text = texts[fault.file]
        try:
            fault.changed(text)
            if fault.file.endswith(".py"):
                ast.parse(changed_statements(fault, text, starts[fault.file]), fault.file)
        except (SyntaxError, ValueError) as error:
            wrong.append(str(error) if isinstance(error, ValueError) else f"fault {fault.number}: {error}")
    return wrong


def statement_starts(text: str) -> list[int]:
    """Offsets in the text of a module at which the lines of its top-level statements begin, and of its end."""
    lines = [0, *accumulate(map(len, text.splitlines(keepends=True)))]
    firsts = [
        min(line.lineno for line in (node, *getattr(node, "decorator_list", ()))) for node in ast.parse(text).body
    ]
    return [0, *(lines[first - 1] for first in firsts), len(text)]


def changed_statements(fault: Fault, text: str, starts: list[int]) -> str:
    """Those top-level statements of a module that a fault changes, with the fault: the others are as they were."""
    at = text.index(fault.before)
    begin = max(start for start in starts if start <= at)
    end = min((start for start in starts if start >= at + len(fault.before)), default=len(text))
    return text[begin:at] + fault.after + text[at + len(fault.before) : end]


def exists(name: str) -> bool:
    """Whether a file or folder of this name stands in the checkout."""
    return (ROOT / name).exists()


def copy_tree(target: Path) -> None:
    """Copy every file of the checkout that is not ignored."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        check=True,
        capture_output=True,
    )
    for name in filter(None, listed.stdout.decode().split("\0")):
        source = ROOT / name
        if source.is_symlink() or source.is_file():  # the package's rooms are links to folders
            (target / name).parent.mkdir(parents=True, exist_ok=True)
            (target / name).unlink(missing_ok=True)
            shutil.copy2(source, target / name, follow_symlinks=False)


def environment(root: Path) -> dict[str, str]:
    """Of a process that works on a copy, on one thread."""
    return os.environ | {
        "PYTHONPATH": str(root),
        "NUMBA_CACHE_DIR": str(root / ".kernels"),
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        "PYTHONDONTWRITEBYTECODE": "1",
    }


def run_tests(root: Path, tests: list[str], *options: str, limit: int | None = None) -> tuple[int, str]:
    """Run tests on a copy until the first fails: the exit code and the end of what they print.

    Tests that do not end within the limit of processor time [s], that of each process that they start, fail.
    """
    command = [sys.executable, "-m", "pytest", "-x", "-q", "--no-header", "-p", "no:cacheprovider", "--tb=line"]
    command += [*options, *tests]
    process = subprocess.Popen(command, cwd=root, env=environment(root), stdout=subprocess.PIPE, text=True)
    if limit is not None:
        resource.prlimit(process.pid, resource.RLIMIT_CPU, (limit, limit + 5))
    text = process.communicate()[0][-1500:]
    if process.returncode == -signal.SIGXCPU:
        return 1, f"no end within {limit} s of processor time"
    return process.returncode, text


def caught(
    root: Path, fault: Fault, tests: list[list[str]], *options: str, limit: int | None = None
) -> tuple[bool, str]:
    """Whether tests fail with a fault in the copy, and the end of what they print.

    Each list of files is one run of pytest; quick ones come first, and the first that fails ends it.
    """
    code, text = 0, ""
    before = fault.put_into(root)
    try:
        for names in tests:
            code, text = run_tests(root, names, *options, limit=limit)
            if code != 0:
                break
    finally:
        (root / fault.file).write_text(before, encoding="utf-8")
    if code in _NO_VERDICT:
        raise RuntimeError(f"fault {fault.number}: pytest ended with {code}\n{text}")
    return code != 0, text


def main() -> None:
    """Try the faults, tell each as it ends, and a table by area."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--area", action="append", help="only faults of this area; may be repeated")
    parser.add_argument("--only", action="append", type=int, help="only the fault of this number; may be repeated")
    parser.add_argument("--sample", type=int, help="only as many of these, chosen at random")
    parser.add_argument("--seed", type=int, default=0, help="of that choice")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--check", action="store_true", help="only tell which faults do not fit the code any more")
    given = parser.parse_args()
    faults, tests = read_faults()
    if given.check:
        wrong = misfits(faults, tests)
        sys.stdout.write("\n".join([*wrong, f"{len(faults)} faults, {len(wrong)} misfits"]) + "\n")
        raise SystemExit(1 if wrong else 0)
    chosen = [
        fault
        for fault in faults
        if (not given.area or fault.area in given.area) and (not given.only or fault.number in given.only)
    ]
    if not chosen:
        parser.error("no fault has these numbers in these areas")
    if given.sample is not None:
        chosen = random.Random(given.seed).sample(chosen, min(given.sample, len(chosen)))
    waiting: SimpleQueue[Fault] = SimpleQueue()
    for fault in chosen:
        waiting.put(fault)
    done: dict[int, bool] = {}
    failures: list[BaseException] = []

    def work(root: Path) -> None:
        try:
            copy_tree(root)
            subprocess.run([sys.executable, "scripts/compile_kernels.py"], cwd=root, env=environment(root), check=True)
            while not failures:
                fault = waiting.get_nowait()
                begin = time.perf_counter()
                done[fault.number], text = caught(root, fault, [[name] for name in tests[fault.area]])
                verdict = "caught" if done[fault.number] else "MISSED"
                sys.stdout.write(
                    f"{fault.number:4d} {verdict} {time.perf_counter() - begin:6.1f} s  {fault.area}: {fault.file}: "
                    f"{fault.before.strip()!r} -> {fault.after.strip()!r}\n" + (text if given.only else "")
                )
                sys.stdout.flush()
        except Empty:
            return
        except BaseException as error:
            failures.append(error)

    with tempfile.TemporaryDirectory(prefix="faults-") as folder:
        places = [Path(folder) / str(number) for number in range(given.workers)]
        workers = [threading.Thread(target=work, args=(place,)) for place in places]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
    if failures:
        raise failures[0]
    total, found = Counter(fault.area for fault in chosen), Counter(f.area for f in chosen if done[f.number])
    for area in [*total, "all"]:
        many = len(chosen) if area == "all" else total[area]
        those = sum(done.values()) if area == "all" else found[area]
        sys.stdout.write(f"{area:12} {those:4d} of {many:4d} caught, {100.0 * those / many:.0f} %\n")


if __name__ == "__main__":
    main()
