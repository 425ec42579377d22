"""Waits of a user: whole commands on a reducer from STEP, with the time, the silence and the deafness of each step.

    python benchmarks/waits.py                                   # all seven, in this checkout, into build/waits
    python benchmarks/waits.py gears sound                       # some of them
    python benchmarks/waits.py --checkout ../before --folder /tmp/before
    python benchmarks/waits.py gears --profile                   # with cProfile, FOLDER/gears.prof

Each command is a process of its own in the checkout that is named, which records every call of its progress. A step
lasts from its words to the next ones. Its columns:

cpu      processor time of the process and of the children that have ended [s]; two checkouts are compared by it
wall     time on the clock [s]
silence  longest time without any call of the progress [s]
deaf     longest time in which the main thread took no signal [s], so that Ctrl-C had waited for it

The commands of the reducer share one results folder, in the order of the list, so that those after ``housing`` find its
modes there, as a user's do. Whatever is shorter than 1 s in all columns is left out of the tables.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

_REDUCER = "two-stage-reducer"
# 223 000 degrees of freedom and 60 modes; a microphone, without which no sound is found over time.
_SIZE = ("housing.cad.mesh_size=13.6 mm", "housing.frequency_limit=4 kHz")
_SOUND = ("acoustics.floor=-20 mm", "acoustics.in_run=false")
_RUN_UP = (
    "transient.revolutions=",
    "transient.discard=",
    'transient.run={ from = "725 rpm", to = "1450 rpm", time = "1 s" }',
)

WAITS: dict[str, tuple[str, ...]] = {
    "demo": ("run", "nasa-gear-noise-rig"),
    "housing": ("modes", _REDUCER, *_SIZE),
    "gears": ("gears", _REDUCER, *_SIZE),
    "load": ("load", _REDUCER, *_SIZE, "--sensitivity"),
    "sound": ("sound", _REDUCER, *_SIZE, *_SOUND),
    "run": ("run", _REDUCER, *_SIZE),
    "run-up": ("run", _REDUCER, *_SIZE, *_RUN_UP),
}
"""Command, case, and changes of keys or options."""

# Runs in the checkout that is measured, which may be older than this file: it needs no more of it than this.
_RECORDER = """
import contextlib, json, resource, signal, sys, time
import gearwhine.progress as shown_progress

file, profiled, *arguments = sys.argv[1:]
start = time.perf_counter()
rows = []

def cpu():
    return sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))

def begin(words):
    rows.append([words, cpu(), time.perf_counter() - start, 0.0, 0.0])

def sign_of_life(message, fraction=None):
    global last
    now = time.perf_counter()
    rows[-1][3], last = max(rows[-1][3], now - last), now
    words = message.partition(":")[0]
    if words != rows[-1][0]:
        begin(words)

def hear(number, frame):
    global heard, worked_before
    now, inner = time.perf_counter(), frame
    while frame is not None:
        if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
            return
        frame = frame.f_back
    worked = time.process_time()
    rows[-1][4] = max(rows[-1][4], now - heard)
    if now - heard > 1.0 and inner is not None:
        deaf.append([now - heard, worked - worked_before, rows[-1][0], inner.f_code.co_filename, inner.f_lineno])
    heard, worked_before = now, worked

deaf, worked_before = [], time.process_time()
last = heard = time.perf_counter()
begin("starting")

@contextlib.contextmanager
def recorded(*, quiet):
    yield sign_of_life

shown_progress.shown = recorded
signal.signal(signal.SIGALRM, hear)
signal.setitimer(signal.ITIMER_REAL, 0.2, 0.2)
from gearwhine.cli import run_command

if profiled:
    import cProfile
    profile = cProfile.Profile()
    code = profile.runcall(run_command, arguments)
    profile.dump_stats(profiled)
else:
    code = run_command(arguments)
signal.setitimer(signal.ITIMER_REAL, 0.0)
sign_of_life("end")
with open(file, "w") as out:
    json.dump({"rows": rows, "deaf": deaf}, out)
sys.exit(code)
"""


def measured(name: str, checkout: Path, folder: Path, *, profile: bool) -> dict[str, Any]:
    """Run one of the commands in a checkout; its steps, and where the main thread was deaf."""
    command, case, *rest = WAITS[name]
    changes = [part for key in rest if "=" in key for part in ("--set", key)]
    options = [key for key in rest if "=" not in key]
    results = folder / (case if name != "run-up" else f"{case}-run-up")
    if name in ("demo", "housing"):
        shutil.rmtree(results, ignore_errors=True)
    if name == "run-up" and not results.exists():  # the run before it keeps its own motion, this one the housing
        shutil.copytree(folder / case, results)
    record = folder / f"{name}.json"
    arguments = [command, case, *changes, *options, "-o", str(results)]
    profiled = str(folder / f"{name}.prof") if profile else ""
    threads = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    environment = threads | os.environ | {"PYTHONPATH": str(checkout)}
    with (folder / f"{name}.txt").open("w") as shown:
        line = [sys.executable, "-c", _RECORDER, str(record), profiled, *arguments]
        subprocess.run(line, env=environment, cwd=folder, stdout=shown, stderr=subprocess.STDOUT, check=True)
    document: dict[str, Any] = json.loads(record.read_text())
    return document


def table(name: str, rows: Sequence[tuple[str, float, float, float, float]]) -> str:
    """Return the steps of a command as a table in Markdown."""
    lines = [f"| {name} | cpu, s | wall, s | silence, s | deaf, s |", "|---|---|---|---|---|"]
    for (words, cpu, wall, silence, deaf), after in pairwise(rows):
        values = (after[1] - cpu, after[2] - wall, silence, deaf)
        if max(values) >= 1.0:
            lines.append(f"| {words} | " + " | ".join(f"{value:.1f}" for value in values) + " |")
    first, last = rows[0], rows[-1]
    most = (max(row[3] for row in rows), max(row[4] for row in rows))
    total = (last[1], last[2] - first[2], *most)
    lines.append("| in all | " + " | ".join(f"{value:.1f}" for value in total) + " |")
    return "\n".join(lines)


def main() -> None:
    """Measure the commands that are named, and print their tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("waits", nargs="*", choices=[[], *WAITS], default=[], help="commands (default: all)")
    parser.add_argument("--checkout", type=Path, default=Path(__file__).parents[1], help="checkout to measure")
    parser.add_argument("--folder", type=Path, default=Path("build/waits"), help="folder for results and records")
    parser.add_argument("--profile", action="store_true", help="also profile each command, which adds a fifth")
    given = parser.parse_args()
    folder = given.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    for name in given.waits or WAITS:
        document = measured(name, given.checkout.resolve(), folder, profile=given.profile)
        print(table(name, document["rows"]), flush=True)
        for wall, cpu, words, file, line in document["deaf"]:
            print(f"deaf for {wall:.1f} s ({cpu:.1f} s of work) in {words!r}, until {file}:{line}")
        print(flush=True)


if __name__ == "__main__":
    main()
