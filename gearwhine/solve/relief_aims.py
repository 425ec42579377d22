"""Aims of the tip-relief search: peak to peak, weighted harmonics, or the level at a sensor."""

import math
from pathlib import Path

import numpy as np

from coupling.gears.loaded.gear_pair import LoadedGearPair
from coupling.gears.loaded.optimal_relief import PeakToPeak, WeightedHarmonics
from coupling.gears.loaded.optimal_relief import ReliefAim as GearReliefAim
from coupling.linear.frequency_response import mesh_error_response
from gearwhine.case import Case, CaseError, Problem, require
from gearwhine.case.errors import NOTHING
from gearwhine.case.gears import ReliefAim
from gearwhine.from_case.machine import build_machine
from gearwhine.progress import Progress, silent
from gearwhine.solve.housing_modes import solve_housing

_HARMONICS = 8  # of the mesh frequency, where the case does not name them


def relief_aims(
    case: Case, pairs: tuple[LoadedGearPair, ...], progress: Progress = silent, *, folder: Path | None = None
) -> tuple[GearReliefAim, ...]:
    """Objective of the tip-relief search for each pair.

    The aim at a sensor is the root mean square of its acceleration over the multiples n of the mesh frequency,
    √(½ Σ (w_n |H_n| e_n)²), with H_n the transmissibility about the mesh as the case has it under its load. The
    housing is solved for it.

    Raises
    ------
    CaseError
        Where a sensor is aimed at and the pair does not turn, or no multiple lies below the model's limit.
    """
    aims = [given.relief_aim for given in case.gear_pair]
    if all(aim is None or aim.sensor is None for aim in aims):
        return tuple(_without_sensor(aim) for aim in aims)
    require(case, "rotor", "operation", "housing", command="gears with the aim at a sensor")
    housing = solve_housing(case, progress, folder=folder)
    machine = build_machine(case, housing, pairs, progress)
    limit = housing.trusted_limit_hz
    found = []
    for number, (pair, aim) in enumerate(zip(pairs, aims, strict=True)):
        if aim is None or aim.sensor is None:
            found.append(_without_sensor(aim))
            continue
        key = f"gear_pair[{number}].relief_aim"
        if not pair.mesh_frequency:
            raise CaseError([Problem(key, NOTHING, "a speed: the level at a sensor is of gears that turn")])
        given = aim.weights or dict.fromkeys(range(1, _HARMONICS + 1), 1.0)
        weights = {n: weight for n, weight in given.items() if weight and n * pair.mesh_frequency <= limit}
        if not weights:
            expected = f"multiples of the mesh frequency of {pair.mesh_frequency:.5g} Hz below {limit:.5g} Hz"
            raise CaseError([Problem(f"{key}.harmonics", list(given), f"{expected}, up to which the modes are known")])
        frequencies = 2.0 * np.pi * pair.mesh_frequency * np.array(list(weights))
        response = mesh_error_response(machine, frequencies, mesh=number)
        levels = np.abs(response.sensor_acceleration[aim.sensor]) / math.sqrt(2.0)
        found.append(WeightedHarmonics({n: weights[n] * float(h) for n, h in zip(weights, levels, strict=True)}))
    return tuple(found)


def _without_sensor(aim: ReliefAim | None) -> GearReliefAim:
    return PeakToPeak() if aim is None else WeightedHarmonics(aim.weights)
