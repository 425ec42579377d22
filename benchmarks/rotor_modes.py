"""Modes, whirl and a Campbell diagram of rotors against ROSS on the same rotors, in one run.

    python benchmarks/rotor_modes.py

The rotor is that of Friswell's example 5.9.2 with damped bearings, once for each number of ROSS's elements; it has a
segment for each of them, so that both programs are given the same file. Of the plain shaft we make few pieces, as equal
segments are one; of the stepped shaft, on which every diameter is another by up to two parts in a hundred, as many as
ROSS does. Both are warm: compiled code is compiled, a solver holds what the speed does not change, as the rotor of ROSS
does its matrices, and every call has a speed of its own, because ROSS keeps what it solved before. One row has a rotor
of ours that is new in every call, while the one of ROSS is not.

Times are processor times, of runs in turn; each that counts follows two of the same that do not, as the other program
leaves nothing of it in the caches; but for ROSS's Campbell diagram, which takes seconds. Shown are the medians of both,
and of the ratios the median, the least and the greatest.
"""

import contextlib
import io
import math
import statistics
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
from timing import arguments, machine

from gearwhine.rotors import (
    Bearing,
    Disc,
    Rotor,
    Segment,
    ShaftMaterial,
    WhirlSolver,
    campbell,
    read_ross,
    rest_frequencies,
    solve_whirl,
    write_ross,
)

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
LENGTH = 1.5
SPEED = 4000 * 2 * np.pi / 60
CAMPBELL_SPEEDS = 100
# Runs of the same before each that counts.
UNCOUNTED = 2
# Part of the diameter by which the stepped shaft's vary.
STEPS = 0.02


@dataclass(frozen=True)
class Row:
    """One thing that both programs do, at a speed of rotation (rad/s)."""

    name: str
    ours: Callable[[float], Any]
    theirs: Callable[[float], Any]
    repeats: int


def written_rotor(elements: int, damping: float, folder: Path, stepped: bool = False) -> Path:
    """The rotor as a file with so many elements, its bearings of so many N s/m in x and two thirds of it in y."""
    discs = [
        Disc.from_dimensions(at, 0.07, diameter, 0.05, STEEL.density) for at, diameter in ((0.5, 0.28), (1.0, 0.35))
    ]
    bearings = [
        Bearing(name, at, np.diag([1e6, 8e5]), damping * np.diag([1.0, 2.0 / 3.0]))
        for name, at in (("left", 0.0), ("right", LENGTH))
    ]
    file = folder / f"rotor-{elements}-{damping:g}-{stepped}.toml"
    if stepped:
        # No two alike, and none far from the rest.
        diameters = [0.05 * (1.0 + STEPS * math.sin(1.0 + 3.1 * number)) for number in range(elements)]
        segments = [Segment(LENGTH / elements, diameter, 0.0, STEEL) for diameter in diameters]
    else:
        segments = [Segment(LENGTH, 0.05, 0.0, STEEL)]
    rotor = Rotor("rotor", segments, discs)
    write_ross(file, rotor, bearings, element_length=LENGTH / elements)
    return file


def rows(ross: Any, elements: int, stepped: bool, modes: int, repeats: int, folder: Path) -> list[Row]:
    """What is compared; ROSS returns half as many frequencies as it is asked for eigenvalues."""
    files = [written_rotor(elements, damping, folder, stepped) for damping in (0.0, 300.0)]
    (rotor, undamped, _), (_, damped, _) = map(read_ross, files)
    at_rest, turning = map(ross.Rotor.load, files)
    solver = WhirlSolver(rotor, damped)

    return [
        Row(
            "modes at rest",
            lambda speed: rest_frequencies(rotor, undamped, count=modes).frequencies,
            # A speed too small to matter, but not one that was solved before.
            lambda speed: at_rest.run_modal(1e-6 * speed, num_modes=2 * modes).wn,
            repeats,
        ),
        Row(
            "whirl at speed",
            lambda speed: solver.modes(speed, count=modes).frequencies,
            lambda speed: turning.run_modal(speed, num_modes=2 * modes).wn,
            repeats,
        ),
        Row(
            "whirl, new rotor",
            lambda speed: solve_whirl(replace(rotor), damped, speed, count=modes).frequencies,
            lambda speed: turning.run_modal(speed, num_modes=2 * modes).wn,
            repeats,
        ),
        Row(
            f"Campbell, {CAMPBELL_SPEEDS} speeds",
            lambda speed: campbell(rotor, damped, np.linspace(0.0, speed, CAMPBELL_SPEEDS), count=modes, solver=solver),
            lambda speed: turning.run_campbell(np.linspace(1e-6, 1.0, CAMPBELL_SPEEDS) * speed, frequencies=modes),
            1,
        ),
    ]


def seconds(work: Callable[[float], Any], speed: float) -> float:
    """Processor time of one run."""
    begun = time.process_time()
    work(speed)
    return time.process_time() - begun


def in_turn(row: Row, speeds: Iterator[float]) -> tuple[list[float], list[float]]:
    """Seconds of our runs and of ROSS's, as many of either."""
    theirs_uncounted = UNCOUNTED if row.repeats > 1 else 0
    mine: list[float] = []
    found: list[float] = []
    for _ in range(row.repeats):
        for work, times, uncounted in ((row.theirs, found, theirs_uncounted), (row.ours, mine, UNCOUNTED)):
            times.append([seconds(work, next(speeds)) for _ in range(1 + uncounted)][-1])
    return mine, found


def apart(row: Row, speed: float) -> float:
    """Largest relative difference of our frequencies from the nearest of ROSS's, which hold torsion as well."""
    mine, found = row.ours(speed), row.theirs(speed)
    return float(max(np.abs(found / frequency - 1.0).min() for frequency in mine[mine < found.max()]))


def imported_ross() -> Any:
    """ROSS, without what it has to say on the way."""
    warnings.simplefilter("ignore")
    with contextlib.redirect_stdout(io.StringIO()):
        import ross
    return ross


def main() -> None:
    options = arguments(
        __doc__.splitlines()[0],
        modes=(int, 6, "frequencies of both planes together"),
        repeats=(int, 11, "runs of each, of which the median is shown; Campbell diagrams are made once"),
    )
    ross = imported_ross()
    speeds = (SPEED * (1.0 + 1e-5 * number) for number in count())
    print(f"{machine()}\n{options.modes} frequencies; the difference is ROSS's discretisation\n")
    print(f"{'elements':>16}  {'':24}{'ours':>12}{'ROSS':>12}{'ratio':>9}{'least':>8}{'most':>8}{'difference':>13}")
    with tempfile.TemporaryDirectory() as folder:
        for elements, stepped in ((6, False), (24, False), (60, False), (24, True), (60, True)):
            name = f"{elements} {'stepped' if stepped else 'plain'}"
            for row in rows(ross, elements, stepped, options.modes, options.repeats, Path(folder)):
                mine, found = in_turn(row, speeds)
                ratios = [theirs / ours for ours, theirs in zip(mine, found, strict=True)]
                middle, ours, theirs = (statistics.median(values) for values in (ratios, mine, found))
                line = f"{name:>16}  {row.name:24}{1e3 * ours:9.2f} ms{1e3 * theirs:9.2f} ms"
                line += f"{middle:9.1f}{min(ratios):8.1f}{max(ratios):8.1f}"
                difference = f"{apart(row, next(speeds)):.1e}" if row.repeats > 1 else ""
                print(f"{line}{difference:>13}", flush=True)


if __name__ == "__main__":
    main()
