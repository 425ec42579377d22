"""Resonances that a sweep over speed passes by between its points, and the sweep that has them, too.

The peaks are those of :mod:`gearwhine.coupling.sweep.missed_peaks`.
"""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from gearwhine.case import SPEED_KEY, SweptKey
from gearwhine.case.units import to_rpm
from gearwhine.coupling.sweep.missed_peaks import (
    MissedPeak,
    RadiatedLevel,
    SoundLevels,
    SpeedPoint,
    peaks_between,
    speeds_to_add,
)
from gearwhine.coupling.sweep.resonances import SOUND
from gearwhine.numerics.result_warnings import warning
from gearwhine.sweep.grid import SweptPoint
from gearwhine.sweep.points import GridPoint
from gearwhine.sweep.solution import PointResult


def missed_peaks(
    keys: Sequence[SweptKey], swept: Sequence[SweptPoint[GridPoint]], radiated: RadiatedLevel | None = None
) -> list[MissedPeak]:
    """Return the peaks between the points of a sweep over speed that are louder than all at both points.

    The peak that rises most comes first. Peaks are those of the sound power in a sweep with sound, else of the sensors.

    Parameters
    ----------
    keys : sequence of SweptKey
    swept : sequence of SweptPoint
        Solved points, with the sound in their documents.
    radiated : callable, optional
        Returns the sound power level [dB] of a frequency [Hz] and the rates of the housing's coordinates, shape (n,).
        By default the sound is that of a body of even walls.
    """
    along = next((number for number, key in enumerate(keys) if SPEED_KEY in key.keys), None)
    if along is None or not keys[along].is_numeric:
        return []
    rows: dict[tuple[int, ...], list[tuple[SpeedPoint, SweptPoint[GridPoint]]]] = {}
    for swept_point in swept:
        point, place = _speed_point(swept_point, radiated), swept_point.point.place
        if point is not None:
            rows.setdefault(place[:along] + place[along + 1 :], []).append((point, swept_point))
    peaks: list[MissedPeak] = []
    for points in rows.values():
        points.sort(key=lambda pair: pair[0].speed_rpm)
        settings = {
            key.key: text
            for number, (key, text) in enumerate(zip(keys, points[0][1].point.texts, strict=True))
            if number != along
        }
        for (below, _), (above, _) in pairwise(points):
            peaks += peaks_between(below, above, settings)
    return sorted(peaks, key=lambda peak: -peak.rise_db)


def over_with(keys: Sequence[SweptKey], swept: Sequence[SweptPoint[GridPoint]], speeds: Sequence[float]) -> str:
    """Return the options of the command, quoted for a shell, for a sweep with further speeds [rpm]: old points stay."""
    along = next(number for number, key in enumerate(keys) if SPEED_KEY in key.keys)
    texts = {point.point.texts[along]: _speed(point) for point in swept}
    sign = -1.0 if max(texts.values()) < 0.0 else 1.0
    texts |= {f"{sign * speed:g} rpm": sign * speed for speed in speeds}
    ascending = sorted(texts, key=lambda text: texts[text])
    values = (ascending if number == along else key.texts for number, key in enumerate(keys))
    options = (f"{key.key}={','.join(of_key)}" for key, of_key in zip(keys, values, strict=True))
    return " ".join(f"--over {shlex.quote(option)}" for option in options)


def peak_warnings(peaks: Sequence[MissedPeak]) -> list[dict[str, Any]]:
    """Return the warning that a sweep passes by peaks, with the highest of them; none where it does not."""
    if not peaks:
        return []
    first = peaks[0]
    where = "".join(f", {key}={text}" for key, text in first.settings.items())
    subject = "the sound power" if first.output == SOUND else first.output
    speeds = speeds_to_add(peaks)
    message = (
        f"between {first.below_rpm:g} and {first.above_rpm:g} rpm{where} {first.line} meets the mode at "
        f"{first.frequency_hz:.1f} Hz ({first.mode}), whose half-power bandwidth of "
        f"{2.0 * first.half_width_rpm:.2g} rpm is narrower than the spacing of the points: by the linear response "
        f"{subject} peaks at {first.speed_rpm:.1f} rpm, {first.rise_db:.1f} dB above the louder point"
    )
    more = f"; {len(peaks) - 1} more in the table" if len(peaks) > 1 else ""
    added = ", ".join(f"{speed:g} rpm" for speed in speeds)
    return [warning("sweep_resolution", f"{message}{more}; add {added}", speeds_rpm=speeds)]


def _speed(swept_point: SweptPoint[GridPoint]) -> float:
    """Return the speed of a point in rpm, signed."""
    return float(f"{to_rpm(swept_point.point.speed):.12g}")


def _speed_point(swept_point: SweptPoint[GridPoint], radiated: RadiatedLevel | None) -> SpeedPoint | None:
    """Return a point as one of its row over speed; None where it has no resonances."""
    outcome = swept_point.outcome
    if not isinstance(outcome, PointResult) or outcome.motion.resonances is None:
        return None
    sound = outcome.document.get("sound")
    levels = None
    if sound is not None:
        lines = [(line["order"], line["sound_power_db"]) for line in sound["lines"]]
        levels = SoundLevels(float(sound["total_db"]), lines)
    return SpeedPoint(_speed(swept_point), outcome.motion, outcome.motion.resonances, levels, radiated)
