"""Sound of a sweep: the radiated power of each point's lines that matter, once all points are there.

A point stores the rates of the housing's coordinates at its strongest lines. Modes and acoustics have to be the same at
all points: the radiating surface is then made once. Where there are many lines their powers are interpolated over
frequency (:mod:`gearwhine.housing.acoustics.modal_radiation`); lines whose interpolation or proofs are doubtful are
solved.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.sound.proofs import (
    doubts,
    gathered,
    interior_pressure,
    known_source,
    known_source_at,
    microphone_doubts,
    power_balance_db,
)
from gearwhine.housing import HousingError
from gearwhine.housing.acoustics.modal_radiation import POINTS, ModalRadiation
from gearwhine.housing.acoustics.radiation import LEAK, POWERS_AGREE, SOURCE_HEARD, SOURCE_OFF, counting
from gearwhine.housing.acoustics.sound_levels import a_weighting, power_level, pressure_level, sum_of_levels
from gearwhine.numerics.progress import Progress, in_order, silent
from gearwhine.numerics.result_warnings import warning
from gearwhine.output.quantity import document_of
from gearwhine.results.sound import SWEPT_LINE, SweptLine, parts_of_modes
from gearwhine.sweep.resolution import RadiatedLevel
from gearwhine.sweep.solution import PointResult

if TYPE_CHECKING:
    from gearwhine.case import Case, SweptKey
    from gearwhine.housing.acoustics.radiation import HousingRadiation, RadiatedSound
    from gearwhine.solve.housing_modes import SolvedHousing
    from gearwhine.sweep.points import Point
    from gearwhine.sweep.run import SweptPoint

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_TWO_PI = 2.0 * np.pi
_LARGEST_INTERPOLATION_ERROR = 0.02  # estimated error of an interpolation up to which it holds: a tenth of a decibel
_FAINT_LINE_RATIO = 1e-3  # part of a point's loudest line, by an estimate, below which a line is left out
_UNPROVED: dict[str, Any] = {"known_source_error": None, "known_source_rms": None}


def add_sound(
    case: Case,
    keys: Sequence[SweptKey],
    swept: Sequence[SweptPoint],
    housing: SolvedHousing,
    progress: Progress = silent,
) -> tuple[list[dict[str, Any]], SolvedHousing, RadiatedLevel | None]:
    """Add the sound to the documents of a sweep's points.

    Parameters
    ----------
    case : Case
        Case of one of the points, with `[acoustics]`.
    keys : sequence of SweptKey
    swept : sequence of SweptPoint
        Points, at least one.
    housing : SolvedHousing
        Housing of that case.
    progress : callable

    Returns
    -------
    list of dict
        Warnings.
    SolvedHousing
        The housing, whose record holds the radiation over frequency where it is solved.
    callable or None
        Sound power level of other rates of the housing's coordinates, without a solution: interpolated where the
        radiation is known over frequency, else by their equivalent power. None where there is no sound.

    Raises
    ------
    CaseError, gearwhine.housing.HousingError
        As :func:`gearwhine.coupling.sound.solution.solve_sound`; where a line fails its proofs, if one does at every
        point. A single point is left without sound, with a warning.
    """
    from gearwhine.coupling.sound.acoustics_checks import acoustics_warnings
    from gearwhine.coupling.sound.motion_lines import AUDIBLE, pulsating_efficiency
    from gearwhine.coupling.sound.solution import build_radiation
    from gearwhine.solve.acoustics import acoustics_of, refused_by_key
    from gearwhine.solve.kept_radiation import kept_radiation

    # Keys that name no part of the housing change its modes too, such as the place of a bearing or a material.
    if len({swept_point.point.modes_key for swept_point in swept}) > 1 or any(
        swept_point.point.case.acoustics != case.acoustics for swept_point in swept
    ):
        message = "the sound of a sweep is left out: its housing's modes or its acoustics change from point to point"
        return [warning("sound_of_sweep", message)], housing, None
    silent_points, warnings = _without_lines(keys, swept)
    if silent_points == len(swept):
        return warnings, housing, None
    acoustics, field = acoustics_of(case), housing.displacement_field
    warnings += acoustics_warnings(acoustics, housing.mesh.bounds, housing.trusted_limit_hz)
    with refused_by_key(acoustics):
        radiation = build_radiation(acoustics, field, progress)
    positions, _ = acoustics.microphones(housing.mesh.bounds)
    places = np.array(list(positions.values())).reshape(-1, 3)
    natural = len(housing.modes.frequencies_hz)
    jobs: list[tuple[int, int, float, Any]] = []  # number of the point and of its line, frequency, rates
    for number, swept_point in enumerate(swept):
        if not isinstance(swept_point.outcome, PointResult) or not len(swept_point.outcome.line_frequencies):
            continue
        frequencies = swept_point.outcome.line_frequencies
        rates = swept_point.outcome.line_rates[..., 0] + 1j * swept_point.outcome.line_rates[..., 1]
        estimate = radiation.equivalent_power(rates.T) * pulsating_efficiency(
            frequencies, radiation.area, radiation.medium.speed_of_sound
        )
        for place in np.flatnonzero(estimate > _FAINT_LINE_RATIO * estimate.max()).tolist():
            jobs.append((number, place, float(frequencies[place]), rates[place][:, None]))

    table = None
    if radiation.method != "erp" and len(jobs) > POINTS:
        between = AUDIBLE, acoustics.limit_hz(field)
        table, housing = kept_radiation(acoustics, housing, radiation, places, between, progress)

    def solve(job: tuple[int, int, float, Any]) -> _Line:
        *_, hertz, rates = job
        line = None if table is None else _interpolated(table, radiation, hertz, rates[:, 0], positions, natural)
        return line or _line(radiation.solve(hertz, rates), positions, places, natural)

    lines: dict[int, list[_Line]] = {}
    for (number, place, *_), line in zip(jobs, in_order(solve, jobs, "sound of the sweep", progress), strict=True):
        point, outcome = swept[number].point, swept[number].outcome
        assert isinstance(outcome, PointResult)
        assert point.case.operation is not None
        order = line.entry["frequency_hz"] * _TWO_PI / abs(point.case.operation.speed)
        line.entry.update(order=order, name=outcome.line_names[place], kind=outcome.line_kinds[place])
        lines.setdefault(number, []).append(line)
    failures: list[HousingError] = []
    for number, point_lines in lines.items():
        counted = counting(point_lines)
        refused = next((line.refused for line in counted if line.refused is not None), None)
        if refused is not None:
            failures.append(refused)
            where = _where(keys, swept[number].point)
            warnings.append(warning("sound_of_point", f"the sound at {where} is left out: {refused}"))
            continue
        warnings += [entry for line in counted for entry in line.warnings]
        balances = [line.entry["power_balance_db"] for line in counted]
        leaks = [line.entry["interior_pressure"] for line in counted]
        sources = [line.entry for line in counted if line.entry["known_source_error"] is not None]
        worst_source = max(sources, key=lambda entry: float(entry["known_source_error"]), default=_UNPROVED)
        entries = sorted((line.entry for line in point_lines), key=lambda entry: -float(entry["sound_power_db"]))
        outcome = swept[number].outcome
        assert isinstance(outcome, PointResult)
        outcome.document["sound"] = {
            "method": radiation.method,
            "total_db": sum_of_levels(entry["sound_power_db"] for entry in entries),
            "total_db_a": sum_of_levels(entry["sound_power_db_a"] for entry in entries),
            "power_balance_db": max((value for value in balances if value is not None), key=abs, default=None),
            "interior_pressure": max((value for value in leaks if value is not None), default=None),
            **{key: worst_source[key] for key in _UNPROVED},
            "loudest": document_of(SWEPT_LINE, SweptLine(entries[0], housing.modes.frequencies_hz)),
            "lines": entries,
        }
    if failures and len(failures) == len(lines):
        raise failures[0]
    warnings = [*gathered(warnings), *_beyond_warnings(keys, swept, acoustics.limit_hz(field))]
    return warnings, housing, partial(_radiated, radiation, table)


def _radiated(radiation: HousingRadiation, table: ModalRadiation | None, hertz: float, rates: ComplexArray) -> float:
    """Sound power level of rates of the housing's coordinates without a solution [dB]."""
    from gearwhine.coupling.sound.motion_lines import pulsating_efficiency

    if table is not None and table.holds(hertz) and table.power(hertz, rates)[2] <= _LARGEST_INTERPOLATION_ERROR:
        return float(power_level(table.power(hertz, rates)[0]))
    sphere = pulsating_efficiency(np.array([hertz]), radiation.area, radiation.medium.speed_of_sound)
    return float(power_level(radiation.equivalent_power(rates[:, None])[0] * sphere[0]))


def _beyond_warnings(keys: Sequence[SweptKey], swept: Sequence[SweptPoint], limit: float) -> Iterator[dict[str, Any]]:
    """Warn where a mesh frequency is above the highest frequency of the sound [Hz]: its lines are left out there."""
    beyond = [
        (max(above), swept_point.point)
        for swept_point in swept
        if isinstance(swept_point.outcome, PointResult)
        and (above := [hertz for hertz in swept_point.point.case.parts.mesh_frequencies if hertz > limit])
    ]
    if beyond:
        highest, point = max(beyond, key=lambda entry: entry[0])
        yield warning(
            "sound_left_out",
            f"at {len(beyond)} of {len(swept)} points, such as {_where(keys, point)}, a mesh frequency of up to "
            f"{highest:.0f} Hz is above {limit:.0f} Hz, where the sound ends: its lines are left out, so that these "
            "points cannot be compared with the others; raise housing.frequency_limit and acoustics.highest_frequency",
        )


def _without_lines(keys: Sequence[SweptKey], swept: Sequence[SweptPoint]) -> tuple[int, list[dict[str, Any]]]:
    """Return the number of points whose motion has no lines that drive the housing, and the warnings that say why."""
    from gearwhine.solve.acoustics import sound_left_out

    reasons: dict[str, list[Point]] = {}
    for swept_point in swept:
        for entry in sound_left_out(swept_point.point.case):
            reasons.setdefault(str(entry["message"]), []).append(swept_point.point)
    warnings = []
    for message, points in reasons.items():
        everywhere = len(points) == len(swept)
        where = "" if everywhere else f"at {len(points)} of {len(swept)} points, such as {_where(keys, points[0])}, "
        warnings.append(warning("sound_left_out", where + message))
    return sum(map(len, reasons.values())), warnings


def _where(keys: Sequence[SweptKey], point: Point) -> str:
    """Return the swept keys of a point with their values."""
    return ", ".join(f"{key.key}={text}" for key, text in zip(keys, point.texts, strict=True))


@dataclass(frozen=True)
class _Line:
    """Sound of a line of a point: its entry in the document, its powers, and warnings or the refusal of its proofs."""

    entry: dict[str, Any]
    power: float
    surface_power: float
    warnings: list[dict[str, Any]]
    refused: HousingError | None


def _line(sound: RadiatedSound, positions: Mapping[str, FloatArray], places: FloatArray, natural: int) -> _Line:
    """Return the figures of a sound, without the sound itself: a sweep has thousands."""
    refused = None
    try:
        sound.require_proofs()
    except HousingError as error:
        refused = error
    heard = sound.pressure_at(places) if len(places) else np.zeros(0, dtype=np.complex128)
    entry = _entry(
        sound.frequency_hz, sound.power, sound.radiation_efficiency, dict(zip(positions, heard, strict=True))
    )
    entry |= {"power_balance_db": power_balance_db(sound), "interior_pressure": interior_pressure(sound)}
    proof, off = known_source(sound), known_source_at(sound, places)
    entry |= _UNPROVED if proof is None else {"known_source_error": proof.largest, "known_source_rms": proof.rms}
    warnings = doubts(sound, "a line")
    if off is not None:
        warnings += microphone_doubts(sound.frequency_hz, dict(zip(positions, off.tolist(), strict=True)))
    entry["contributions"] = {"housing_modes": parts_of_modes(sound.by_mode, natural, sound.power)}
    return _Line(entry, sound.power, sound.surface_power, warnings, refused)


def _interpolated(
    table: ModalRadiation,
    radiation: HousingRadiation,
    hertz: float,
    rates: ComplexArray,
    positions: Mapping[str, FloatArray],
    natural: int,
) -> _Line | None:
    """Return the figures of a line by interpolation; None where that or a proof is doubtful."""
    if not table.holds(hertz):
        return None
    power, surface_power, error = table.power(hertz, rates)
    leak, off, rms, heard_off = (
        table.around(hertz, values)
        for values in (table.interior_residual, table.source_error, table.source_rms, table.point_source_error)
    )
    if (
        max(error, table.pressure_error) > _LARGEST_INTERPOLATION_ERROR
        or abs(surface_power / power - 1.0) > POWERS_AGREE
    ):
        return None
    if leak > LEAK or off > SOURCE_OFF or heard_off > SOURCE_HEARD:
        return None
    heard = table.pressure_at(np.array([hertz]))[0] @ rates
    efficiency = power / float(radiation.equivalent_power(rates[:, None])[0])
    entry = _entry(hertz, power, efficiency, dict(zip(positions, heard, strict=True)))
    entry |= {
        "power_balance_db": float(power_level(surface_power) - power_level(power)),
        "interior_pressure": leak if radiation.method == "boundary-elements" else None,
    }
    proved = {"known_source_error": off, "known_source_rms": rms}
    entry |= proved if radiation.method == "boundary-elements" else _UNPROVED
    entry["contributions"] = {"housing_modes": parts_of_modes(table.by_mode(hertz, rates), natural, power)}
    return _Line(entry, power, surface_power, [], None)


def _entry(hertz: float, power: float, efficiency: float, heard: Mapping[str, complex]) -> dict[str, Any]:
    level = float(power_level(power))
    entry: dict[str, Any] = {
        "frequency_hz": hertz,
        "sound_power_db": level,
        "sound_power_db_a": level + float(a_weighting(hertz)),
        "radiation_efficiency": efficiency,
    }
    if heard:
        entry["microphones_db"] = {name: float(pressure_level(pressure)) for name, pressure in heard.items()}
    return entry
