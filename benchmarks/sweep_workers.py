"""A sweep of many speeds by one worker and by more, in one run.

    python benchmarks/sweep_workers.py

The case is the small gearbox with a coarse housing. Each sweep is the whole command in a process of its own and starts
with an empty folder: reading the program, solving the housing, starting the workers, drawing and writing all count, and
are what keeps two workers from taking half the time of one. The sweeps take turns, so that what else the machine does
falls on all of them.

What the machine itself leaves of its cores is measured beside: as many sweeps by one worker as there are workers, all
at once, share nothing and wait for nothing. Cores that slow each other down (hyperthreads of one, a shared cache, the
clock) show there, and no sweep can be below that.
"""

import os
import statistics
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
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


def at_once(count: int, speeds: int, revolutions: int, folder: Path) -> None:
    """So many sweeps by one worker each, none of which knows of the others."""
    with ThreadPoolExecutor(count) as pool:
        list(pool.map(lambda number: sweep(1, speeds, revolutions, folder / str(number)), range(count)))


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
        ways = {
            "one": lambda place: sweep(1, options.speeds, options.revolutions, place),
            "more": lambda place: sweep(options.workers, options.speeds, options.revolutions, place),
            "at once": lambda place: at_once(options.workers, options.speeds, options.revolutions, place),
        }
        seconds: dict[str, list[float]] = {name: [] for name in ways}
        for repeat in range(options.repeats):
            for name, way in ways.items():
                place = Path(folder) / f"{name}-{repeat}"
                seconds[name].append(timed(lambda way=way, to=place: way(to))[1])
                print(f"  {name}: {seconds[name][-1]:.1f} s", flush=True)
    one, more, together = (statistics.median(taken) for taken in seconds.values())
    print(f"1 worker {one:.1f} s, {options.workers} workers {more:.1f} s: {more / one:.2f} of the time")
    print(
        f"{options.workers} such sweeps by 1 worker at once {together:.1f} s: "
        f"{together / options.workers / one:.2f} of the time for each, what this machine's cores leave"
    )


if __name__ == "__main__":
    main()
