"""A long run of the command: peak memory, and what is left of it after kills.

    python benchmarks/long_run.py --revolutions 120 --kills 10
    python benchmarks/long_run.py --run-up 600 --kills 10

Runs ``gearwhine run`` on a bundled case as processes of their own: once through, and with --kills again, killed with
SIGKILL at random moments of the march and started anew each time. Prints the peak memory of each process and
compares all numbers of the two results, bit for bit.
"""

import json
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import xarray as xr
from timing import arguments, machine

_MEGABYTE = 1024.0  # of the kilobytes that the system tells

_RUN = """
import resource, sys
from gearwhine.cli import run_command
code = run_command(sys.argv[1:])
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
sys.exit(code)
"""


# Two modes of each shaft and coarse steps: they follow the shafts, not their highest vibrations.
_RUN_UP = (
    "transient.revolutions=",
    "transient.discard=0",
    "transient.tolerance=1e-2",
    "operation.speed=600 rpm",
    "transient.run.from=60 rpm",
    "transient.run.to=600 rpm",
    "rotor.input.modes=2",
    "rotor.output.modes=2",
)


def main() -> None:
    """Run once through, then once with kills, and compare."""
    given = arguments(
        "A long run of the command.",
        case=(str, "spur-pair", "case file or bundled case"),
        revolutions=(int, 120, "of the first driver; a tenth of them is discarded"),
        run_up=(float, 0.0, "seconds of a run-up from 60 to 600 rpm in place of the revolutions"),
        kills=(int, 0, "how often to kill the second run"),
        seed=(int, 1, "of the moments"),
    )
    print(machine())
    settings = [f"transient.revolutions={given.revolutions}", f"transient.discard={given.revolutions // 10}"]
    if given.run_up:
        settings = [*_RUN_UP, f"transient.run.time={given.run_up}"]
    with tempfile.TemporaryDirectory() as place:
        whole, killed = Path(place) / "whole", Path(place) / "killed"
        begin = time.perf_counter()
        peak = finished(started(given.case, settings, whole))
        seconds = time.perf_counter() - begin
        print(f"through: peak memory {peak:.0f} MB, {seconds:.0f} s, {told(whole)}")
        if not given.kills:
            return
        chance = random.Random(given.seed)
        marching = float(summary(whole)["seconds"]["transient"])
        for _ in range(given.kills):
            kill_one(given.case, settings, killed, chance.uniform(0.0, marching / (2 * given.kills)))
        peak = finished(started(given.case, settings, killed))
        print(f"after {given.kills} kills: peak memory {peak:.0f} MB, {told(killed)}")
        print("same, bit for bit" if same(whole, killed) else "NOT THE SAME")


def started(case: str, settings: list[str], out: Path) -> "subprocess.Popen[str]":
    """A run as a process of its own."""
    changes = [word for setting in settings for word in ("--set", setting)]
    command = [sys.executable, "-c", _RUN, "run", case, "-q", "--json", "-o", str(out), *changes]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=os.environ)


def finished(process: "subprocess.Popen[str]") -> float:
    """Peak memory of a run that ended well [MB]."""
    out, _ = process.communicate()
    assert process.returncode == 0
    return int(out.split()[-1]) / _MEGABYTE


def kill_one(case: str, settings: list[str], out: Path, seconds: float) -> None:
    """Kill a run some seconds after it has added a first block to those that are there."""
    process = started(case, settings, out)
    before = written(out)
    while written(out) <= before and process.poll() is None:
        time.sleep(1e-3)
    time.sleep(seconds)
    process.kill()
    process.communicate()
    print(f"  killed with {written(out)} blocks written")


def written(out: Path) -> int:
    """Blocks on file."""
    return len(list(out.glob(".resume-*/block-*.npz")))


def told(out: Path) -> str:
    """Steps and size of a result."""
    document, size = summary(out), (out / "results.nc").stat().st_size / 2**20
    return f"{document['steps']} steps, {document['record']['samples']} samples kept, results.nc {size:.0f} MB"


def summary(out: Path) -> dict[str, Any]:
    """What a run says of itself."""
    return dict(json.loads((out / "summary.json").read_text(encoding="utf-8")))


def same(one: Path, other: Path) -> bool:
    """Whether two results files hold the same bits."""
    with xr.open_dataset(one / "results.nc") as first, xr.open_dataset(other / "results.nc") as second:
        alike = [first[name].values.tobytes() == second[name].values.tobytes() for name in first.variables]
        return set(first.variables) == set(second.variables) and all(alike)


if __name__ == "__main__":
    main()
