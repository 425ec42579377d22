"""A sweep of many speeds by one worker and by more, in one run.

    python benchmarks/sweep_workers.py

The case is the small gearbox with a coarse housing. Each sweep is the whole command in a process of its own and starts
with an empty folder: reading the program, solving the housing, starting the workers, drawing and writing all count, and
are what keeps two workers from taking half the time of one. The sweeps take turns, so that what else the machine does
falls on all of them.
"""

import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from timing import arguments, machine, timed


def sweep(workers: int, speeds: int, revolutions: int, folder: Path) -> None:
    """One sweep from 1500 to 6000 rpm, by the command."""
    command = [sys.executable, "-m", "gearwhine", "sweep", "small-gearbox", "-q", "--json"]
    settings = {"housing.box.mesh_size": "40 mm", "transient.revolutions": revolutions, "transient.discard": 1}
    for key, value in settings.items():
        command += ["--set", f"{key}={value}"]
    command += ["--over", f"operation.speed=1500 rpm:6000 rpm:{speeds}"]
    command += ["--workers", str(workers), "-o", str(folder)]
    root = Path(__file__).parent.parent
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(root)}
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment)


def main() -> None:
    options = arguments(
        __doc__.splitlines()[0],
        speeds=(int, 24, "points of each sweep"),
        workers=(int, 2, "against one"),
        revolutions=(int, 10, "of each point: more make each of them longer"),
        repeats=(int, 1, "of each sweep, in turn; medians are shown"),
    )
    print(f"{machine()}\n{options.speeds} speeds, {options.revolutions} revolutions each\n", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        # What numba compiles is kept on disk from here on.
        sweep(1, 2, 2, Path(folder) / "warm")
        seconds: dict[int, list[float]] = {1: [], options.workers: []}
        for repeat in range(options.repeats):
            for workers, taken in seconds.items():
                place = Path(folder) / f"{workers}-{repeat}"
                taken.append(timed(lambda n=workers, to=place: sweep(n, options.speeds, options.revolutions, to))[1])
    one, more = (statistics.median(taken) for taken in seconds.values())
    print(f"1 worker {one:.1f} s, {options.workers} workers {more:.1f} s: {more / one:.2f} of the time")


if __name__ == "__main__":
    main()
