"""Damaged results folders under every command that reads them, and commands that are killed: nothing may be lost.

    OMP_NUM_THREADS=1 python benchmarks/lost_results.py              # 100 damaged folders, 60 kills
    OMP_NUM_THREADS=1 python benchmarks/lost_results.py 14 8 --seed 7

A damaged file is named, or done anew; a killed command leaves one whole set of files, the user's own among them, and
the same command then runs to its end. Damages and moments are those of the seed.
"""

import argparse
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from gearwhine.failures import DamagedResultsError
from gearwhine.output.files import finish_moves
from gearwhine.output.manifest import require_as_written

LIMIT = 60.0  # seconds of a command
SETS = ("transient.revolutions=6", "transient.discard=2")
RUN = ("run", "spur-pair", "--no-pictures", *(word for text in SETS for word in ("--set", text)))
SWEEP = ("sweep", "spur-pair", "--over", "operation.speed=1000 rpm,2000 rpm", "--workers", "1")
SWEEP = (*SWEEP, *(word for text in SETS for word in ("--set", text)))
BOX = """
[housing]
modes = 5
material = "steel"
box = { size = ["200 mm", "160 mm", "240 mm"], wall = "10 mm", mesh_size = "60 mm" }
[material.steel]
youngs_modulus = "207 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"
[[housing.support]]
name = "base"
surface = "bottom"
fixed = ["x", "y", "z"]
[measured]
frequencies = ["1600 Hz", "1900 Hz"]
pairing = "order"
[acoustics]
method = "erp"
mesh_size = "60 mm"
highest_frequency = "900 Hz"
[update]
mesh_size = "80 mm"
solves = 3
explore = 1
[[update.parameter]]
name = "steel"
keys = ["material.steel.youngs_modulus"]
range = ["150 GPa", "230 GPa"]
spread = "20 GPa"
"""
HOUSING = {
    "modes": ("modes", "box.toml", "-o", "{}"),
    "compare": ("compare", "box.toml", "-o", "{}"),
    "sound": ("sound", "box.toml", "-o", "{}"),
    "update": ("update", "box.toml", "-o", "{}"),
    "survey": ("survey", "box.toml", "--sensors", "3", "--modes", "2", "-o", "{}"),
}
GEARS = {
    "run": (*RUN, "-o", "{}"),
    "gears": ("gears", "spur-pair", "-o", "{}"),
    "load": ("load", "spur-pair", "-o", "{}"),
    "steady": ("steady", "spur-pair", "-o", "{}"),
}
SHOWN = {"export": ("export", "{}", "--csv"), "report": ("report", "{}")}
READERS = {
    "gears": SHOWN | GEARS | {"sweep": (*SWEEP, "-o", "{}")},
    "housing": {"report": SHOWN["report"]} | HOUSING,
    "interrupted": {"run": GEARS["run"]},
}
"""Commands that read the results of those of gear pairs, of housings, and of a run that was killed while it marched."""
KILLED = {
    "run": GEARS["run"],
    "sweep": (*SWEEP, "-o", "{}"),
    "load": ("load", "helical-pair", "-o", "{}"),
    "gears": GEARS["gears"],
    "report": SHOWN["report"],
    "sound": HOUSING["sound"],
    "update": HOUSING["update"],
    "compare": HOUSING["compare"],
}
NOTES = "notes.txt"


def command(words: tuple[str, ...], folder: Path) -> subprocess.Popen[str]:
    """Start a command on a folder."""
    line = [sys.executable, "-m", "gearwhine", *(word.format(folder) for word in words)]
    return subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, cwd=folder.parent)


def fault(code: int, said: str, seconds: float) -> str:
    """What is wrong with how a command ended; empty for nothing."""
    if "Traceback" in said or code not in (0, 1, 2):
        return f"ended with {code}: {said.strip().rpartition(chr(10))[2][:200]}"
    return f"took {seconds:.0f} s" if seconds > LIMIT else ""


def damage(path: Path, chance: random.Random) -> str:
    """Damage a file in one of several ways; return which."""
    content = bytearray(path.read_bytes())
    match kind := chance.choice(("flipped", "truncated", "empty", "missing", "foreign", "zeroed")):
        case "flipped":
            content[chance.randrange(len(content))] ^= 1 << chance.randrange(8)
        case "truncated":
            del content[chance.randrange(len(content)) :]
        case "empty":
            content.clear()
        case "foreign":
            content[:] = b"\x89HDF\r\n\x1a\n something else"
        case "zeroed":
            begin = chance.randrange(len(content))
            content[begin : begin + 64] = bytes(len(content[begin : begin + 64]))
    path.write_bytes(content)
    if kind == "missing":
        path.unlink()
    return kind


def interrupted(folder: Path) -> None:
    """Kill a run that has stored the first block of its march."""
    process = command(GEARS["run"], folder)
    while not any(folder.glob(".resume-*/block-*.npz")) and process.poll() is None:
        time.sleep(0.01)
    process.kill()
    process.communicate()
    assert any(folder.glob(".resume-*/block-*.npz"))


def damaged(count: int, chance: random.Random, intact: Path, folder: Path) -> int:
    """Have commands read damaged copies of the folders of results; return the number of faults."""
    readers = [(kind, reader) for kind, commands in READERS.items() for reader in commands]
    faults = 0
    for number in range(count):
        print(f"damaged folder {number + 1} of {count}", file=sys.stderr, flush=True)
        results, reader = readers[number % len(readers)]
        sound = intact / results
        files = sorted(path.relative_to(sound) for path in sound.rglob("*") if path.is_file())
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(sound, folder)
        name = chance.choice(files)
        before = (folder / name).read_bytes()
        kind = damage(folder / name, chance)
        changed = kind == "missing" or (folder / name).read_bytes() != before
        begin = time.monotonic()
        process = command(READERS[results][reader], folder)
        said = process.communicate()[1]
        wrong = fault(process.returncode, said, time.monotonic() - begin)
        # A picture that is gone is none of an export's concern.
        concerns = reader == "report" or (reader == "export" and (kind, name.suffix) != ("missing", ".png"))
        if not wrong and changed and concerns and name.name != "report.html":
            # A later file of the same command's name is drawn anew; a reader says what it misses.
            wrong = "" if name.name in said else "silent"
        if not wrong and reader not in SHOWN and process.returncode:
            wrong = f"does not do it anew: {said.strip()[-200:]}"
        if wrong:
            faults += 1
            print(f"{number}: {reader} of {name} {kind}: {wrong}", flush=True)
    return faults


def killed(count: int, chance: random.Random, sound: Path, folder: Path) -> int:
    """Kill commands over a copy of a folder; return the number of faults."""
    faults = 0
    took: dict[str, float] = {}
    for number in range(count):
        print(f"kill {number + 1} of {count}", file=sys.stderr, flush=True)
        name = list(KILLED)[number % len(KILLED)]
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(sound, folder)
        (folder / NOTES).write_text("mine", encoding="utf-8")
        if name not in took:
            begin = time.monotonic()
            command(KILLED[name], folder).communicate()
            took[name] = time.monotonic() - begin
            shutil.rmtree(folder)
            shutil.copytree(sound, folder)
            (folder / NOTES).write_text("mine", encoding="utf-8")
        process = command(KILLED[name], folder)
        # As often near the end, where files move, as anywhere.
        time.sleep(took[name] * (chance.uniform(0.8, 1.0) if chance.random() < 0.5 else chance.random()))
        kind = chance.choice((signal.SIGKILL, signal.SIGINT, signal.SIGTERM))
        process.send_signal(kind)
        said = process.communicate()[1]
        wrong = "Traceback" if "Traceback" in said else ""
        finish_moves(folder)
        try:
            missing = require_as_written(folder)
        except DamagedResultsError as error:
            wrong = str(error)
        else:
            wrong = wrong or "; ".join(missing)
        if (folder / NOTES).read_text(encoding="utf-8") != "mine":
            wrong = "the user's file is lost"
        if not wrong:
            again = command(KILLED[name], folder)
            said = again.communicate()[1]
            wrong = f"the next one ended with {again.returncode}: {said[-200:]}" if again.returncode else ""
            left = [
                path.name for path in folder.iterdir() if path.name.startswith((".partial", ".complete", ".resume"))
            ]
            wrong = wrong or (f"left behind: {left}" if left else "")
        if wrong:
            faults += 1
            print(f"{number}: {name} ended by {kind.name}: {wrong}", flush=True)
    return faults


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("damages", nargs="?", type=int, default=100)
    parser.add_argument("kills", nargs="?", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    chance = random.Random(given.seed)
    with tempfile.TemporaryDirectory() as name:
        intact, folder = Path(name), Path(name, "folder")
        Path(name, "box.toml").write_text(BOX, encoding="utf-8")
        for results, commands in (("gears", GEARS), ("housing", HOUSING)):
            for words in commands.values():
                assert command(words, intact / results).wait() == 0, words
        interrupted(intact / "interrupted")
        wrong = damaged(given.damages, chance, intact, folder)
        print(f"{given.damages} damaged folders: {wrong} faults", flush=True)
        wrong = killed(given.kills, chance, intact / "gears", folder)
        print(f"{given.kills} kills: {wrong} faults", flush=True)


if __name__ == "__main__":
    main()
