"""Damaged results folders under every command that reads them, and commands that are killed: nothing may be lost.

    OMP_NUM_THREADS=1 python benchmarks/lost_results.py              # 100 damaged folders, 60 kills
    OMP_NUM_THREADS=1 python benchmarks/lost_results.py 10 6 --seed 7

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
READERS = {
    "export": ("export", "{}", "--csv"),
    "report": ("report", "{}"),
    "run": (*RUN, "-o", "{}"),
    "gears": ("gears", "spur-pair", "-o", "{}"),
    "load": ("load", "spur-pair", "-o", "{}"),
    "steady": ("steady", "spur-pair", "-o", "{}"),
    "sweep": (*SWEEP, "-o", "{}"),
}
KILLED = {
    "run": (*RUN, "-o", "{}"),
    "sweep": (*SWEEP, "-o", "{}"),
    "load": ("load", "helical-pair", "-o", "{}"),
    "gears": ("gears", "spur-pair", "-o", "{}"),
    "report": ("report", "{}"),
    "sound": ("sound", "steel-box", "--set", "acoustics.method=erp", "-o", "{}"),
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


def damaged(count: int, chance: random.Random, sound: Path, folder: Path) -> int:
    """Have commands read damaged copies of a folder; return the number of faults."""
    files = sorted(path.relative_to(sound) for path in sound.rglob("*") if path.is_file())
    faults = 0
    for number in range(count):
        print(f"damaged folder {number + 1} of {count}", file=sys.stderr, flush=True)
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(sound, folder)
        name, reader = chance.choice(files), list(READERS)[number % len(READERS)]
        before = (folder / name).read_bytes()
        kind = damage(folder / name, chance)
        changed = kind == "missing" or (folder / name).read_bytes() != before
        begin = time.monotonic()
        process = command(READERS[reader], folder)
        said = process.communicate()[1]
        wrong = fault(process.returncode, said, time.monotonic() - begin)
        # A picture that is gone is none of an export's concern.
        concerns = reader == "report" or (reader == "export" and (kind, name.suffix) != ("missing", ".png"))
        if not wrong and changed and concerns and name.name != "report.html":
            # A later file of the same command's name is drawn anew; a reader says what it misses.
            wrong = "" if name.name in said else "silent"
        if not wrong and reader in ("run", "gears", "load", "steady", "sweep") and process.returncode:
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
        sound, folder = Path(name, "sound"), Path(name, "folder")
        for words in (RUN, ("gears", "spur-pair"), ("load", "spur-pair"), ("steady", "spur-pair")):
            assert command((*words, "-o", "{}"), sound).wait() == 0, words
        wrong = damaged(given.damages, chance, sound, folder)
        print(f"{given.damages} damaged folders: {wrong} faults", flush=True)
        wrong = killed(given.kills, chance, sound, folder)
        print(f"{given.kills} kills: {wrong} faults", flush=True)


if __name__ == "__main__":
    main()
