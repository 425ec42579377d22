"""Sound of a sweep: the radiated power of each point's lines that matter, once all points are there.

A point stores the rates of the housing's coordinates at its strongest lines; the housing is the same at all points, so
that its radiating surface is made once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from gearwhine.output.quantity import warning
from gearwhine.progress import Progress, in_order, silent
from gearwhine.solve.sound_proofs import counting, interior_pressure, power_balance_db, require_proof
from gearwhine.sweep.solution import PointResult
from housing import HousingError
from housing.acoustics.sound_levels import a_weighting, power_level, pressure_level, sum_of_levels

if TYPE_CHECKING:
    from gearwhine.case import Case, SweptKey
    from gearwhine.solve.housing_modes import SolvedHousing
    from gearwhine.sweep.run import SweptPoint
    from housing.acoustics.radiation import RadiatedSound

FloatArray = npt.NDArray[np.float64]

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
    from gearwhine.solve.motion_lines import left_out_warnings, pulsating_efficiency
    from gearwhine.solve.sound import build_radiation, microphones_of

    if any(key.key.split(".")[0].split("[")[0] in _OF_THE_HOUSING for key in keys):
        message = "the sound of a sweep is left out: its housing, materials or acoustics change from point to point"
        return [warning("sound_of_sweep", message)]
    if told := left_out_warnings(case):
        return told
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

    def solve(job: tuple[int, float, Any]) -> tuple[int, _Line]:
        number, hertz, rates = job
        return number, _line(radiation.solve(hertz, rates), positions, places)

    lines: dict[int, list[_Line]] = {}
    for number, line in in_order(solve, jobs, "sound of the sweep", progress):
        lines.setdefault(number, []).append(line)
    for number, found in lines.items():
        counted = counting(found)
        for line in counted:
            if line.refused is not None:
                raise line.refused
            told += line.told
        balances = [line.entry["power_balance_db"] for line in counted]
        leaks = [line.entry["interior_pressure"] for line in counted]
        entries = [line.entry for line in found]
        outcome = swept[number].outcome
        assert isinstance(outcome, PointResult)
        outcome.document["sound"] = {
            "method": radiation.method,
            "total_db": sum_of_levels(entry["sound_power_db"] for entry in entries),
            "total_db_a": sum_of_levels(entry["sound_power_db_a"] for entry in entries),
            "power_balance_db": max((one for one in balances if one is not None), key=abs, default=None),
            "interior_pressure": max((one for one in leaks if one is not None), default=None),
            "lines": sorted(entries, key=lambda entry: -float(entry["sound_power_db"])),
        }
    return told


@dataclass(frozen=True)
class _Line:
    """Sound of a line of a point: its entry in the document, its powers, and what its proofs say if it counts."""

    entry: dict[str, Any]
    power: float
    surface_power: float
    told: list[dict[str, Any]]
    refused: HousingError | None


def _line(sound: RadiatedSound, positions: Mapping[str, FloatArray], places: FloatArray) -> _Line:
    """Return the figures of a sound, which is not held: a sweep has thousands."""
    told, refused = [], None
    try:
        told = require_proof(sound, "a line")
    except HousingError as error:
        refused = error
    level = float(power_level(sound.power))
    entry: dict[str, Any] = {
        "frequency_hz": sound.frequency_hz,
        "sound_power_db": level,
        "sound_power_db_a": level + float(a_weighting(sound.frequency_hz)),
        "radiation_efficiency": sound.radiation_efficiency,
        "power_balance_db": power_balance_db(sound),
        "interior_pressure": interior_pressure(sound),
    }
    if len(places):
        heard = sound.pressure_at(places)
        entry["microphones_db"] = {name: float(pressure_level(heard[row])) for row, name in enumerate(positions)}
    return _Line(entry, sound.power, sound.surface_power, told, refused)
