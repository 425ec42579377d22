"""Resonances that a sweep over speed passes by between two of its points, and the speeds at which their peaks lie.

A line of order o has the frequency o n at the speed n, and meets a mode of the damped frequency f at n = f / o. Where
neither of two neighbouring speeds lies within the mode's half-power bandwidth 2 ζ f about it, the points do not resolve
the peak. Its level is that of the line at the points times the ratio of the linear response to the mesh's transmission
error, between the points in proportion to their distance; the transmission error is taken as that of the points. The
sound power of that response is radiated as those of the lines are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from coupling.signals.spectrum import Spectrum, line_height, peak_of_rms
from gearwhine.case import SPEED_KEY, SweptKey
from gearwhine.case.units import to_rpm
from gearwhine.output.quantity import warning
from gearwhine.sweep.resonances import SOUND, Resonances
from gearwhine.sweep.run import SweptPoint
from gearwhine.sweep.solution import PointResult

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_SAME = 1e-6  # relative difference of two orders that are one
_NEAR = 0.5 + 1e-6  # largest distance of a line from its order, over the spacing of a record's lines, with rounding
_ONE = 0.5  # distance up to which two speeds to be added are one, over the half-power half-width
_TINY = 1e-300
_STEPS = 21  # number of frequencies within a mode's half-power bandwidth
_OUTSIDE = 2.0  # distance from a peak at which the curve must be lower, in half-power half-widths


@dataclass(frozen=True)
class MissedPeak:
    """A peak between two neighbouring points of a sweep over speed.

    Attributes
    ----------
    settings : dict of str to str
        The other swept keys.
    below_rpm, above_rpm : float
        Speeds of the points on either side, of the first driver.
    speed_rpm : float
        Speed of the peak.
    half_width_rpm : float
        Half of the half-power bandwidth over the speed.
    line : str
        Name of the mesh harmonic.
    frequency_hz : float
        Frequency of the mode at which the line meets it [Hz].
    damping_ratio : float
    mode : str
        Kind and place of the coupled mode.
    output : str
        ``sound``, or the sensor at which the peak stands out most.
    level_db : float
        Estimated level of the line at the peak: sound power level re 1 pW, or of the amplitude re 1 m/s².
    rise_db : float
        This level over that of all lines at the louder of the two points.
    """

    settings: dict[str, str]
    below_rpm: float
    above_rpm: float
    speed_rpm: float
    half_width_rpm: float
    line: str
    frequency_hz: float
    damping_ratio: float
    mode: str
    output: str
    level_db: float
    rise_db: float


RadiatedLevel = Callable[[float, ComplexArray], float]


def missed_peaks(
    keys: Sequence[SweptKey], swept: Sequence[SweptPoint], radiated: RadiatedLevel | None = None
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
    rows: dict[tuple[int, ...], list[SweptPoint]] = {}
    for swept_point in swept:
        if isinstance(swept_point.outcome, PointResult) and swept_point.outcome.resonances is not None:
            rows.setdefault(swept_point.point.place[:along] + swept_point.point.place[along + 1 :], []).append(
                swept_point
            )
    peaks: list[MissedPeak] = []
    for points in rows.values():
        points.sort(key=_speed)
        settings = {
            key.key: text
            for number, (key, text) in enumerate(zip(keys, points[0].point.texts, strict=True))
            if number != along
        }
        for below, above in pairwise(points):
            # Speeds of two senses have a standstill between them.
            if _speed(below) * _speed(above) > 0.0:
                peaks += _between(settings, below, above, radiated)
    return sorted(peaks, key=lambda peak: -peak.rise_db)


def speeds_to_add(peaks: Sequence[MissedPeak]) -> list[float]:
    """Return the speeds of peaks [rpm], ascending, without those within half a half-width of a higher peak's."""
    chosen: list[float] = []
    for peak in peaks:
        if all(abs(speed - peak.speed_rpm) > _ONE * peak.half_width_rpm for speed in chosen):
            # To a tenth of the half-width, which changes the level by 0.04 dB.
            places = int(np.ceil(-np.log10(0.1 * peak.half_width_rpm)))
            chosen.append(round(peak.speed_rpm, places))
    return sorted(chosen)


def over_with(keys: Sequence[SweptKey], swept: Sequence[SweptPoint], speeds: Sequence[float]) -> str:
    """Return the option of the command for a sweep with further speeds [rpm]."""
    along, key = next((number, key) for number, key in enumerate(keys) if SPEED_KEY in key.keys)
    texts = {point.point.texts[along]: _speed(point) for point in swept}
    sign = -1.0 if max(texts.values()) < 0.0 else 1.0
    texts |= {f"{sign * speed:g} rpm": sign * speed for speed in speeds}
    return f"--over {key.key}='{','.join(sorted(texts, key=lambda text: texts[text]))}'"


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


def _speed(swept_point: SweptPoint) -> float:
    """Return the speed of a point in rpm, signed."""
    assert swept_point.point.case.operation is not None
    return float(f"{to_rpm(swept_point.point.case.operation.speed):.12g}")


@dataclass(frozen=True)
class _End:
    """One of two neighbouring points."""

    speed_rpm: float
    resonances: Resonances
    result: PointResult
    radiated: RadiatedLevel | None = None

    def level(self, output: str, order: float) -> float | None:
        """Level of a line at an output; None where it is not known."""
        if output == SOUND:
            lines = self.result.document["sound"]["lines"]
            levels = (line["sound_power_db"] for line in lines if abs(line["order"] - order) <= _SAME * order)
            return next(levels, None)
        orders = self.result.orders
        place = int(np.argmin(np.abs(orders - order)))
        if len(orders) < 2:
            return None
        spacing = orders[1] - orders[0]
        if abs(orders[place] - order) > _NEAR * spacing:
            return None
        # The line nearest to a tone between lines is lower than the tone: under Hann's window by up to 1.4 dB.
        height = float(line_height((orders[place] - order) / spacing, self.result.window))
        return float(20.0 * np.log10(max(self.result.sensor_spectra[output][place] / height, _TINY)))

    def total(self, output: str) -> float:
        """Level of all lines, as of a line of their mean square."""
        if output == SOUND:
            return float(self.result.document["sound"]["total_db"])
        amplitude = self.result.sensor_spectra[output]
        spectrum = Spectrum(self.result.orders, amplitude, np.zeros_like(amplitude), self.result.window)
        return float(20.0 * np.log10(max(float(peak_of_rms(spectrum.rms(np.inf))), _TINY)))

    def mode_near(self, hertz: float) -> int:
        """Return the number of the mode nearest to a frequency [Hz]: another speed may have it elsewhere."""
        return int(np.argmin(np.abs(self.resonances.frequencies - hertz)))

    def correction(self, output: str, mesh: int, harmonic: int, mode: int) -> float:
        """Level by which a mode's peak over the line at this point differs from that of even walls [dB]."""
        resonances = self.resonances
        if output != SOUND or self.radiated is None or harmonic > resonances.harmonic_rates.shape[1]:
            return 0.0
        at = np.array(
            [float(resonances.frequencies[mode]), harmonic * resonances.mesh_orders[mesh] * self.speed_rpm / 60.0]
        )
        rates = (resonances.mode_rates[mesh, mode], resonances.harmonic_rates[mesh, harmonic - 1])
        if not all(np.any(rate) for rate in rates):
            return 0.0
        peak, line = (self.radiated(hertz, rate) for hertz, rate in zip(at.tolist(), rates, strict=True))
        even = self.response(output, mesh, at)
        return peak - line - float(even[0] - even[1])

    def response(self, output: str, mesh: int, frequencies: FloatArray) -> FloatArray:
        """Level of the response of an output to a mesh's error at some frequencies [Hz]."""
        resonances = self.resonances
        curve = resonances.response[resonances.outputs.index(output), mesh]
        return np.asarray(np.interp(frequencies, resonances.grid, curve))


def _between(
    settings: dict[str, str], below: SweptPoint, above: SweptPoint, radiated: RadiatedLevel | None
) -> Iterator[MissedPeak]:
    ends = []
    for swept_point in sorted((below, above), key=lambda point: abs(_speed(point))):
        assert isinstance(swept_point.outcome, PointResult)
        assert swept_point.outcome.resonances is not None
        ends.append(_End(abs(_speed(swept_point)), swept_point.outcome.resonances, swept_point.outcome, radiated))
    low, high = ends
    if (low.resonances.meshes, low.resonances.outputs) != (high.resonances.meshes, high.resonances.outputs):
        return
    outputs = [name for name in low.resonances.outputs if name != SOUND]
    if all("sound" in end.result.document for end in ends):
        outputs = [SOUND]
    totals = {name: max(end.total(name) for end in ends) for name in outputs}
    resonances = low.resonances
    for mesh, (name, order) in enumerate(zip(resonances.meshes, resonances.mesh_orders.tolist(), strict=True)):
        for harmonic in range(1, 1 + int(60.0 * resonances.grid[-1] / (order * low.speed_rpm))):
            peaks: dict[int, MissedPeak] = {}
            for output in outputs:
                for number, hertz, level in _peaks(low, high, output, mesh, harmonic):
                    rise = level - totals[output]
                    if rise > 0.0 and (number not in peaks or rise > peaks[number].rise_db):
                        rpm = 60.0 / (harmonic * order)
                        peaks[number] = MissedPeak(
                            settings=settings,
                            below_rpm=low.speed_rpm,
                            above_rpm=high.speed_rpm,
                            speed_rpm=rpm * hertz,
                            half_width_rpm=rpm * float(resonances.half_widths[number]),
                            line=f"{harmonic}× {name}",
                            frequency_hz=hertz,
                            damping_ratio=float(resonances.half_widths[number] / resonances.frequencies[number]),
                            mode=resonances.names[number],
                            output=output,
                            level_db=level,
                            rise_db=rise,
                        )
            yield from _apart(peaks.values())


def _apart(peaks: Iterable[MissedPeak]) -> Iterator[MissedPeak]:
    """Yield the peaks of a line, the one that rises most first, without those of modes within its half-power band."""
    separate: list[MissedPeak] = []
    for peak in sorted(peaks, key=lambda missed: -missed.rise_db):
        if all(abs(peak.speed_rpm - louder.speed_rpm) > louder.half_width_rpm for louder in separate):
            separate.append(peak)
            yield peak


def _peaks(low: _End, high: _End, output: str, mesh: int, harmonic: int) -> Iterator[tuple[int, float, float]]:
    """Yield the peaks of a line between two points that neither resolves: number of the mode, frequency, and level."""
    order = harmonic * float(low.resonances.mesh_orders[mesh])
    first, last = order * low.speed_rpm / 60.0, order * high.speed_rpm / 60.0
    levels = [(end, at, end.level(output, order)) for end, at in ((low, first), (high, last))]
    at_ends = [(end, at, level) for end, at, level in levels if level is not None]
    resonances = low.resonances
    if not at_ends:
        return

    def between(frequencies: FloatArray, values: Sequence[FloatArray | float]) -> FloatArray:
        part = (frequencies - first) / (last - first)
        return np.asarray(values[0] if len(values) == 1 else (1.0 - part) * values[0] + part * values[1])

    def curve(frequencies: FloatArray) -> FloatArray:
        values = [
            level + end.response(output, mesh, frequencies) - end.response(output, mesh, np.array([at]))
            for end, at, level in at_ends
        ]
        return between(frequencies, values)

    inside = (resonances.frequencies - resonances.half_widths > first) & (
        resonances.frequencies + resonances.half_widths < last
    )
    for number in np.flatnonzero(inside).tolist():
        middle, half = float(resonances.frequencies[number]), float(resonances.half_widths[number])
        near = middle + half * np.linspace(-1.0, 1.0, _STEPS)
        level = curve(near)
        top = int(np.argmax(level))
        # A mode on the flank of a higher peak has no peak of its own.
        if level[top] > curve(middle + half * np.array([-_OUTSIDE, _OUTSIDE])).max():
            values = [end.correction(output, mesh, harmonic, end.mode_near(middle)) for end, _, _ in at_ends]
            yield number, float(near[top]), float(level[top] + between(near[top], values))
