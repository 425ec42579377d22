"""Sound of a sweep: the radiated power of each point's lines that matter, once all points are there.

A point stores the rates of the housing's coordinates at its strongest lines. Modes and acoustics have to be the same at
all points: the radiating surface is then made once. Where there are many lines their powers are interpolated over
frequency (:mod:`gearwhine.housing.acoustics.modal_radiation`); lines whose interpolation or proofs are doubtful are
solved.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwhine.coupling.sound.proofs import gathered
from gearwhine.coupling.sweep.line_sound import LineSound, interpolated_line_sound, line_sound, radiated_level
from gearwhine.coupling.sweep.missed_peaks import RadiatedLevel
from gearwhine.housing import HousingError
from gearwhine.housing.acoustics.modal_radiation import POINTS
from gearwhine.housing.acoustics.radiation import counting
from gearwhine.housing.acoustics.sound_levels import a_weighting, power_level, pressure_level, sum_of_levels
from gearwhine.numerics.progress import Progress, in_order, silent
from gearwhine.numerics.result_warnings import warning
from gearwhine.output.quantity import document_of
from gearwhine.results.sound import SWEPT_LINE, SweptLine, parts_of_modes
from gearwhine.sweep.solution import PointResult

if TYPE_CHECKING:
    from gearwhine.case import Case, SweptKey
    from gearwhine.housing import HousingModes
    from gearwhine.sweep.grid import SweptPoint
    from gearwhine.sweep.points import Point


_TWO_PI = 2.0 * np.pi
_FAINT_LINE_RATIO = 1e-3  # part of a point's loudest line, by an estimate, below which a line is left out


def add_sound(
    case: Case,
    keys: Sequence[SweptKey],
    swept: Sequence[SweptPoint[Point]],
    housing: HousingModes,
    progress: Progress = silent,
) -> tuple[list[dict[str, Any]], HousingModes, RadiatedLevel | None]:
    """Add the sound to the documents of a sweep's points.

    Parameters
    ----------
    case : Case
        Case of one of the points, with `[acoustics]`.
    keys : sequence of SweptKey
    swept : sequence of SweptPoint
        Points, at least one.
    housing : HousingModes
        Housing of that case.
    progress : callable

    Returns
    -------
    list of dict
        Warnings.
    HousingModes
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
    from gearwhine.solve.kept_radiation import KeptSpan, kept_radiation

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
        if not isinstance(swept_point.outcome, PointResult) or not len(swept_point.outcome.motion.line_frequencies):
            continue
        frequencies = swept_point.outcome.motion.line_frequencies
        rates = swept_point.outcome.motion.line_rates[..., 0] + 1j * swept_point.outcome.motion.line_rates[..., 1]
        estimate = radiation.equivalent_power(rates.T) * pulsating_efficiency(
            frequencies, radiation.area, radiation.medium.speed_of_sound
        )
        for place in np.flatnonzero(estimate > _FAINT_LINE_RATIO * estimate.max()).tolist():
            jobs.append((number, place, float(frequencies[place]), rates[place][:, None]))

    table, between = None, (AUDIBLE, acoustics.limit_hz(field))
    spans = KeptSpan(acoustics, housing)
    radiation = spans.spanned(radiation, np.array([hertz for *_, hertz, _ in jobs]), between, progress)
    housing = spans.housing
    if radiation.method != "erp" and len(jobs) > POINTS:
        table, housing = kept_radiation(acoustics, housing, radiation, places, between, progress)

    def solve(job: tuple[int, int, float, Any]) -> LineSound:
        *_, hertz, rates = job
        line = None if table is None else interpolated_line_sound(table, radiation, hertz, rates[:, 0], positions)
        return line or line_sound(radiation.solve(hertz, rates), positions)

    lines: dict[int, list[tuple[LineSound, dict[str, Any]]]] = {}
    for (number, place, *_), line in zip(jobs, in_order(solve, jobs, "sound of the sweep", progress), strict=True):
        point, outcome = swept[number].point, swept[number].outcome
        assert isinstance(outcome, PointResult)
        entry, order = _entry(line, natural), line.frequency_hz * _TWO_PI / abs(point.speed)
        entry.update(order=order, name=outcome.motion.line_names[place], kind=outcome.motion.line_kinds[place])
        lines.setdefault(number, []).append((line, entry))
    failures: list[HousingError] = []
    for number, point_lines in lines.items():
        counted = counting([line for line, _ in point_lines])
        refused = next((line.refused for line in counted if line.refused is not None), None)
        if refused is not None:
            failures.append(refused)
            where = _where(keys, swept[number].point)
            warnings.append(warning("sound_of_point", f"the sound at {where} is left out: {refused}"))
            continue
        warnings += [entry for line in counted for entry in line.warnings]
        balances = [line.power_balance_db for line in counted]
        leaks = [line.interior_pressure for line in counted]
        sources = [(line.known_source_error, line.known_source_rms) for line in counted]
        proved = [(error, rms) for error, rms in sources if error is not None]
        source_error, source_rms = max(proved, key=lambda source: source[0], default=(None, None))
        entries = sorted((entry for _, entry in point_lines), key=lambda entry: -float(entry["sound_power_db"]))
        outcome = swept[number].outcome
        assert isinstance(outcome, PointResult)
        outcome.document["sound"] = {
            "method": radiation.method,
            "total_db": sum_of_levels(entry["sound_power_db"] for entry in entries),
            "total_db_a": sum_of_levels(entry["sound_power_db_a"] for entry in entries),
            "power_balance_db": max((value for value in balances if value is not None), key=abs, default=None),
            "interior_pressure": max((value for value in leaks if value is not None), default=None),
            "known_source_error": source_error,
            "known_source_rms": source_rms,
            "loudest": document_of(SWEPT_LINE, SweptLine(entries[0], housing.modes.frequencies_hz)),
            "lines": entries,
        }
    if failures and len(failures) == len(lines):
        raise failures[0]
    warnings = [*gathered(warnings), *_beyond_warnings(keys, swept, acoustics.limit_hz(field))]
    return warnings, housing, partial(radiated_level, radiation, table)


def _beyond_warnings(
    keys: Sequence[SweptKey], swept: Sequence[SweptPoint[Point]], limit: float
) -> Iterator[dict[str, Any]]:
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


def _without_lines(keys: Sequence[SweptKey], swept: Sequence[SweptPoint[Point]]) -> tuple[int, list[dict[str, Any]]]:
    """Return the number of points whose motion has no lines that drive the housing, and the warnings that say why."""
    from gearwhine.coupling.sound.motion_lines import left_out_warnings

    reasons: dict[str, list[Point]] = {}
    for swept_point in swept:
        operation, transient = swept_point.point.case.operation, swept_point.point.case.transient
        base_moves = operation is not None and operation.base is not None
        speed_changes = transient is not None and transient.run is not None
        for entry in left_out_warnings(base_moves=base_moves, speed_changes=speed_changes):
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


def _entry(line: LineSound, natural: int) -> dict[str, Any]:
    """Return the document of a line; ``natural`` is the number of the housing's modes, before its residual modes."""
    level = float(power_level(line.power))
    entry: dict[str, Any] = {
        "frequency_hz": line.frequency_hz,
        "sound_power_db": level,
        "sound_power_db_a": level + float(a_weighting(line.frequency_hz)),
        "radiation_efficiency": line.radiation_efficiency,
    }
    if line.heard:
        entry["microphones_db"] = {name: float(pressure_level(pressure)) for name, pressure in line.heard.items()}
    entry |= {"power_balance_db": line.power_balance_db, "interior_pressure": line.interior_pressure}
    entry |= {"known_source_error": line.known_source_error, "known_source_rms": line.known_source_rms}
    entry["contributions"] = {"housing_modes": parts_of_modes(line.by_mode, natural, line.power)}
    return entry
