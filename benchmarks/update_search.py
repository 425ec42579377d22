"""The search of model updating against scipy's `least_squares`, on housings whose walls and springs are secret.

    python benchmarks/update_search.py

The twins of ``tests/gearwhine/test_updating_twin.py``: a small box on springs with five parameters, "measured" at 116
points with noise and without two of its modes; each secret is a draw of the prior. Both have the same misfit and the
same derivatives. scipy gets residuals of a fixed length, the costs of lost pairs as the last of them, and at most
thirty solutions. Counted are full solutions after the first design's, timed is the processor, and a fit is right where
every measured mode has the mode for its partner that it was made from.
"""

import math
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares
from timing import arguments, machine

from gearwhine.from_case.parametric_housing import HousingAtParameters, ParametricHousing, fitted_case
from gearwhine.housing.updating import Effort, Target, measure, search
from gearwhine.housing.updating.misfit import Misfit, residuals
from gearwhine.housing.updating.parameters import coordinate_bounds

sys.path.append(str(Path(__file__).parents[1] / "tests" / "gearwhine"))
import contextlib

from test_updating_twin import housing_case, measured, secret_coordinates, survey_normals

FloatArray = npt.NDArray[np.float64]
MOST = 30


class EnoughError(Exception):
    """All solutions are used."""


def by_search(designs: ParametricHousing, start: HousingAtParameters, target: Target) -> tuple[Misfit, int]:
    """Fit as the command ``update`` does from one start: steps on the surrogate, solutions of what these promise."""
    found = search(designs.solve, target, designs.parameters, start, Effort(solves=10, starts=10, trust=0.4))
    return found.misfit, len(found.steps)


def by_scipy(
    designs: ParametricHousing, start: HousingAtParameters, target: Target, method: str, tolerance: float
) -> tuple[Misfit, int]:
    """Fit by Gauss-Newton steps on the solved designs themselves, within the bounds."""
    assert target.shapes is not None
    rows, n = len(target.frequencies) + target.shapes.size + 1, len(designs.parameters)
    solved: dict[bytes, tuple[Misfit, FloatArray, FloatArray]] = {}

    def at(z: FloatArray) -> tuple[Misfit, FloatArray, FloatArray]:
        if z.tobytes() not in solved:
            if len(solved) > MOST:
                raise EnoughError
            design = designs.solve(z, start) if solved else start
            misfit = measure(target, design.state, z)
            missed, slopes = residuals(target, misfit, design.surrogate().at(z), penalties=True)
            row, matrix = np.zeros(rows), np.zeros((rows, n))
            row[: len(missed)], matrix[: len(missed)] = missed, slopes
            row[-1] = math.sqrt(max(misfit.value - float(missed @ missed) - float(z @ z), 0.0))
            solved[z.tobytes()] = misfit, np.concatenate([row, z]), np.vstack([matrix, np.eye(n)])
        return solved[z.tobytes()]

    limits = {"xtol": tolerance, "ftol": tolerance}
    bounds = coordinate_bounds(designs.parameters)
    with contextlib.suppress(EnoughError):
        least_squares(lambda z: at(z)[1], start.coordinates, lambda z: at(z)[2], bounds, method, **limits)
    return min((misfit for misfit, *_ in solved.values()), key=lambda misfit: misfit.value), len(solved) - 1


def main() -> None:
    given = arguments(__doc__, secrets=(int, 12, "number of housings"))
    print(machine())
    case = housing_case()
    assert case.update is not None
    designs = ParametricHousing(fitted_case(case), case.update.modes, measured=survey_normals, threads=1)
    start = designs.solve(designs.start)
    ways: dict[str, Callable[[Target], tuple[Misfit, int]]] = {
        "trust region on the surrogate": lambda target: by_search(designs, start, target),
    }
    for method in ("trf", "dogbox"):
        for tolerance in (1e-3, 2e-2):
            ways[f"least_squares, {method}, tolerance {tolerance:g}"] = lambda target, m=method, t=tolerance: by_scipy(
                designs, start, target, m, t
            )
    rows: dict[str, list[tuple[float, int, float, bool]]] = {name: [] for name in ways}
    for seed in range(given.secrets):
        generator = np.random.default_rng(seed)
        target, own = measured(designs.solve(secret_coordinates(designs, generator), start).state, generator)
        for name, fit in ways.items():
            begin = time.process_time()
            misfit, solves = fit(target)
            rows[name].append((misfit.value, solves, time.process_time() - begin, misfit.pairs.tolist() == own))
    least = np.min([[row[0] for row in table] for table in rows.values()], axis=0)
    for name, table in rows.items():
        values, solves, seconds, right = (np.array(column) for column in zip(*table, strict=True))
        print(
            f"  {name:38s} right {int(right.sum()):2d} of {len(table)}, solutions {solves.mean():.1f}, "
            f"{seconds.mean():.1f} s, misfit above the least {np.median(values - least):.1f} in the median, "
            f"{(values - least).max():.0f} at most"
        )


if __name__ == "__main__":
    main()
