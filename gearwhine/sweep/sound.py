"""Sound of a sweep: the radiated power of each point's lines that matter, once all points are there.

A point stores the rates of the housing's coordinates at its strongest lines; the housing is the same at all points, so
that its radiating surface is made once.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwhine.output.quantity import warning
from gearwhine.progress import Progress, silent
from gearwhine.sweep.solution import PointResult
from housing.acoustics.sound_levels import a_weighting, power_level, pressure_level, sum_of_levels

if TYPE_CHECKING:
    from gearwhine.case import Case, SweptKey
    from gearwhine.solve.housing_modes import SolvedHousing
    from gearwhine.sweep.run import SweptPoint

_FAINT = 1e-3  # part of a point's loudest line, by an estimate, below which a line is left out
_OF_THE_HOUSING = ("housing", "material", "acoustics")


def add_sound(
    case: Case,
    keys: Sequence[SweptKey],
    swept: Sequence[SweptPoint],
    housing: SolvedHousing | None,
    progress: Progress = silent,
) -> list[dict[str, Any]]:
    """Add the sound to the documents of a sweep's points; return warnings.

    Parameters
    ----------
    case : Case
        With `[acoustics]`.
    keys : sequence of SweptKey
    swept : sequence of SweptPoint
    housing : SolvedHousing
        Of all points.
    progress : callable

    Raises
    ------
    CaseError, housing.HousingError
        As :func:`gearwhine.solve.sound.solve_sound`.
    """
    from gearwhine.solve.sound import build_radiation, microphones_of, pulsating_efficiency, solved_in_order

    if any(key.key.split(".")[0].split("[")[0] in _OF_THE_HOUSING for key in keys):
        message = "the sound of a sweep is left out: its housing, materials or acoustics change from point to point"
        return [warning("sound_of_sweep", message)]
    assert housing is not None
    radiation = build_radiation(case, housing, progress)
    positions, _ = microphones_of(case, housing)
    places = np.array(list(positions.values())).reshape(-1, 3)
    jobs: list[tuple[int, float, Any]] = []
    for number, one in enumerate(swept):
        if not isinstance(one.outcome, PointResult) or not len(one.outcome.line_frequencies):
            continue
        frequencies = one.outcome.line_frequencies
        rates = one.outcome.line_rates[..., 0] + 1j * one.outcome.line_rates[..., 1]
        estimate = radiation.equivalent_power(rates.T) * pulsating_efficiency(
            frequencies, radiation.area, radiation.medium.speed_of_sound
        )
        for place in np.flatnonzero(estimate > _FAINT * estimate.max()).tolist():
            jobs.append((number, float(frequencies[place]), rates[place][:, None]))

    def solve(place: int) -> tuple[int, dict[str, Any]]:
        number, hertz, rates = jobs[place]
        sound = radiation.solve(hertz, rates)
        sound.require_balance()
        level = float(power_level(sound.power))
        entry: dict[str, Any] = {
            "frequency_hz": hertz,
            "sound_power_db": level,
            "sound_power_db_a": level + float(a_weighting(hertz)),
            "radiation_efficiency": sound.radiation_efficiency,
        }
        if len(places):
            heard = sound.pressure_at(places)
            entry["microphones_db"] = {name: float(pressure_level(heard[row])) for row, name in enumerate(positions)}
        return number, entry

    lines: dict[int, list[dict[str, Any]]] = {}
    for number, entry in solved_in_order(solve, range(len(jobs)), "sound of the sweep", progress):
        lines.setdefault(number, []).append(entry)
    for number, entries in lines.items():
        outcome = swept[number].outcome
        assert isinstance(outcome, PointResult)
        outcome.document["sound"] = {
            "method": radiation.method,
            "total_db": sum_of_levels(entry["sound_power_db"] for entry in entries),
            "total_db_a": sum_of_levels(entry["sound_power_db_a"] for entry in entries),
            "lines": sorted(entries, key=lambda entry: -float(entry["sound_power_db"])),
        }
    return []
