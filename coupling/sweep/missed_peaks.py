"""Resonances that a sweep over speed passes by between two of its points, and the speeds at which their peaks lie.

A line of order o has the frequency o n at the speed n, and meets a mode of the damped frequency f at n = f / o. Where
neither of two neighbouring speeds lies within the mode's half-power bandwidth 2 ζ f about it, the points do not resolve
the peak. Its level is that of the linear response at the mode's frequency to all that drives the line at a point, the
transmission errors and the load shuttling of all meshes of the order with their phases, taken as that of the points. At
the points themselves the linear response is compared with the motion: the level of the line over all outputs that was
found there, over that of the response, is added. Of both points the estimate is the mean in proportion to their
distance. The sound power of the response is radiated as that of the lines is.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from gearwhine.coupling.signals.spectrum import Spectrum, decibels, line_height, peak_of_rms
from gearwhine.coupling.sweep.reduced_motion import ReducedMotion
from gearwhine.coupling.sweep.resonances import PLACES_ABOUT_MODE, SOUND, Resonances
from gearwhine.numerics.arrays import ComplexArray, FloatArray

_SAME_ORDER_DIFFERENCE = 1e-6  # relative difference of two orders that are one
_LARGEST_LINE_DISTANCE = (
    0.5 + 1e-6
)  # largest distance of a line from its order, over the spacing of a record's lines, with rounding
_SAME_SPEED_DISTANCE = 0.5  # distance up to which two speeds to be added are one, over the half-power half-width
_LOWEST_DB = -1000.0  # level of silence
_OTHER_CAUSE = 20.0  # level over that of the linear response by which a line has another cause than this response
_SAME_MODE = 0.1  # relative difference of frequencies up to which modes of one name at two points may be the same

RadiatedLevel = Callable[[float, ComplexArray], float]


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
        Name of the mesh harmonic, with all meshes that drive it.
    frequency_hz : float
        Frequency of the mode at which the line meets it [Hz].
    damping_ratio : float
    mode : str
        Kind and place of the coupled mode.
    output : str
        ``sound``, or the sensor at which the peak stands out most.
    level_db : float
        Estimated level of the line at the peak: sound power level re 1 pW, or that of the rms acceleration re 1 µm/s².
    found_over_linear_db : float
        Level of the line in the motion at the points over that of the linear response there, which the estimate has.
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
    found_over_linear_db: float
    rise_db: float


@dataclass(frozen=True)
class SoundLevels:
    """Sound power levels of a motion.

    Attributes
    ----------
    total : float
        Level of all lines [dB].
    lines : sequence of (float, float)
        Order over the first driver and level [dB] of each line.
    """

    total: float
    lines: Sequence[tuple[float, float]]


@dataclass(frozen=True)
class SpeedPoint:
    """A point of a sweep over speed.

    Attributes
    ----------
    speed_rpm : float
        Signed speed of the first driver.
    motion : ReducedMotion
    resonances : Resonances
        Resonances of the machine in that motion.
    sound : SoundLevels or None
        Sound of the motion, where it is solved.
    radiated : callable, optional
        Returns the sound power level [dB] of a frequency [Hz] and the rates of the housing's coordinates, shape (n,).
        By default the sound is that of a body of even walls.
    """

    speed_rpm: float
    motion: ReducedMotion
    resonances: Resonances
    sound: SoundLevels | None = None
    radiated: RadiatedLevel | None = None

    @property
    def speed(self) -> float:
        """Speed without its sense [rpm]."""
        return abs(self.speed_rpm)

    def line(self, order: float) -> int | None:
        """Return the number of the line of an order; None where it is above the limit at this speed."""
        same = np.flatnonzero(np.abs(self.resonances.line_orders - order) <= _SAME_ORDER_DIFFERENCE * order)
        return int(same[0]) if same.size else None

    def total(self, output: str) -> float:
        """Level of all lines."""
        if output == SOUND:
            assert self.sound is not None
            return self.sound.total
        amplitude = self.motion.sensor_spectra[output]
        spectrum = Spectrum(self.motion.orders, amplitude, np.zeros_like(amplitude), self.motion.window)
        return _level(float(peak_of_rms(spectrum.rms(np.inf))))

    def mode_near(self, hertz: float, name: str) -> int | None:
        """Return the number of a mode of another speed [Hz], which may be elsewhere here; None where it has left."""
        away = np.abs(self.resonances.frequencies / hertz - 1.0)
        away[np.array(self.resonances.names) != name] = np.inf
        nearest = int(np.argmin(away))
        return nearest if away[nearest] <= _SAME_MODE else None

    def found_over_linear(self, outputs: Sequence[str], line: int) -> float | None:
        """Level of a line in the motion over that of the linear response; None where it is not the line of that.

        That of all outputs together: one of them may be where the response has a node, and its line of other causes.
        """
        order = float(self.resonances.line_orders[line])
        found = [self._found(output, order) for output in outputs]
        linear = [self._linear(output, line) for output in outputs]
        known = [(level, other) for level, other in zip(found, linear, strict=True) if level is not None]
        if not known:
            return None
        over = _sum([level for level, _ in known]) - _sum([other for _, other in known])
        return over if abs(over) <= _OTHER_CAUSE else None

    def near(self, output: str, line: int, mode: int) -> FloatArray:
        """Levels of a line by the linear response about a mode, at the places `PLACES_ABOUT_MODE`, shape (p,)."""
        resonances = self.resonances
        levels: FloatArray = resonances.levels_near[resonances.outputs.index(output), line, mode]
        rates = resonances.mode_rates[line, mode]
        if output != SOUND or self.radiated is None or not np.any(rates):
            return levels
        # Even walls have the shape of the peak, the walls as they are its height.
        return np.asarray(
            levels - levels[len(PLACES_ABOUT_MODE) // 2] + self.radiated(float(resonances.frequencies[mode]), rates)
        )

    def _found(self, output: str, order: float) -> float | None:
        """Level of a line in the motion."""
        if output == SOUND:
            assert self.sound is not None
            lines = self.sound.lines
            levels = (level for other, level in lines if abs(other - order) <= _SAME_ORDER_DIFFERENCE * order)
            return next(levels, None)
        orders = self.motion.orders
        place = int(np.argmin(np.abs(orders - order)))
        if len(orders) < 2:
            return None
        spacing = orders[1] - orders[0]
        if abs(orders[place] - order) > _LARGEST_LINE_DISTANCE * spacing:
            return None
        # The line nearest to a tone between lines is lower than the tone: under Hann's window by up to 1.4 dB.
        height = float(line_height((orders[place] - order) / spacing, self.motion.window))
        return _level(self.motion.sensor_spectra[output][place] / height)

    def _linear(self, output: str, line: int) -> float:
        """Level of a line by the linear response."""
        resonances = self.resonances
        rates = resonances.line_rates[line]
        if output == SOUND and self.radiated is not None and np.any(rates):
            return self.radiated(float(resonances.line_orders[line] * self.speed / 60.0), rates)
        return float(resonances.line_levels[resonances.outputs.index(output), line])


def peaks_between(
    below: SpeedPoint, above: SpeedPoint, settings: Mapping[str, str] | None = None
) -> Iterator[MissedPeak]:
    """Yield the peaks between two neighbouring points that are louder than all at both, by line.

    Peaks are those of the sound power where both points have sound, else of the sensors. Speeds of two senses have a
    standstill between them, and no peaks.

    Parameters
    ----------
    below, above : SpeedPoint
    settings : mapping of str to str, optional
        Other keys of the sweep with their values at both points.
    """
    if below.speed_rpm * above.speed_rpm <= 0.0:
        return
    low, high = sorted((below, above), key=lambda point: point.speed)
    if low.resonances.outputs != high.resonances.outputs:
        return
    outputs = [name for name in low.resonances.outputs if name != SOUND]
    if low.sound is not None and high.sound is not None:
        outputs = [SOUND]
    totals = {name: max(low.total(name), high.total(name)) for name in outputs}
    # The slower point has all lines of the faster one below the limit.
    for line, (name, order) in enumerate(zip(low.resonances.lines, low.resonances.line_orders.tolist(), strict=True)):
        peaks: dict[int, MissedPeak] = {}
        for found in _peaks(low, high, outputs, line):
            rise = found.level - totals[found.output]
            if rise > 0.0 and (found.mode not in peaks or rise > peaks[found.mode].rise_db):
                rpm = 60.0 / order
                peaks[found.mode] = MissedPeak(
                    settings=dict(settings or {}),
                    below_rpm=low.speed,
                    above_rpm=high.speed,
                    speed_rpm=rpm * found.hertz,
                    half_width_rpm=rpm * found.half_width,
                    line=name,
                    frequency_hz=found.hertz,
                    damping_ratio=found.half_width / found.hertz,
                    mode=low.resonances.names[found.mode],
                    output=found.output,
                    level_db=found.level,
                    found_over_linear_db=found.over_linear,
                    rise_db=rise,
                )
        yield from _apart(peaks.values())


def speeds_to_add(peaks: Sequence[MissedPeak]) -> list[float]:
    """Return the speeds of peaks [rpm], ascending, without those within half a half-width of a higher peak's."""
    chosen: list[float] = []
    for peak in peaks:
        if all(abs(speed - peak.speed_rpm) > _SAME_SPEED_DISTANCE * peak.half_width_rpm for speed in chosen):
            # To a tenth of the half-width, which changes the level by 0.04 dB.
            places = int(np.ceil(-np.log10(0.1 * peak.half_width_rpm)))
            chosen.append(round(peak.speed_rpm, places))
    return sorted(chosen)


def _level(amplitude: float) -> float:
    """Level of a sine by its amplitude [m/s²]."""
    return max(float(decibels(amplitude)), _LOWEST_DB)


def _sum(levels: Sequence[float]) -> float:
    """Level of a sum of squares [dB]."""
    highest = max(levels)
    return highest + 10.0 * float(np.log10(sum(10.0 ** (0.1 * (level - highest)) for level in levels)))


def _apart(peaks: Iterable[MissedPeak]) -> Iterator[MissedPeak]:
    """Yield the peaks of a line, the one that rises most first, without those of modes within its half-power band."""
    separate: list[MissedPeak] = []
    for peak in sorted(peaks, key=lambda missed: -missed.rise_db):
        if all(abs(peak.speed_rpm - louder.speed_rpm) > louder.half_width_rpm for louder in separate):
            separate.append(peak)
            yield peak


class _Peak(NamedTuple):
    """Peak of a line at an output: number of the mode, frequency and half-width [Hz], levels."""

    output: str
    mode: int
    hertz: float
    half_width: float
    level: float
    over_linear: float


def _peaks(low: SpeedPoint, high: SpeedPoint, outputs: Sequence[str], line: int) -> Iterator[_Peak]:
    """Yield the peaks of a line of the slower point between two points that neither resolves."""
    order = float(low.resonances.line_orders[line])
    first, last = order * low.speed / 60.0, order * high.speed / 60.0
    at_high = high.line(order)
    over_linear = low.found_over_linear(outputs, line)
    over_linear_high = None if at_high is None else high.found_over_linear(outputs, at_high)
    for mode, name in enumerate(low.resonances.names):
        middle, half = float(low.resonances.frequencies[mode]), float(low.resonances.half_widths[mode])
        part = min(max((middle - first) / (last - first), 0.0), 1.0)
        same = high.mode_near(middle, name)
        if same is not None:
            middle += part * (float(high.resonances.frequencies[same]) - middle)
            half += part * (float(high.resonances.half_widths[same]) - half)
        if not (middle - half > first and middle + half < last):
            continue
        for output in outputs:
            known = []
            if over_linear is not None:
                known.append((1.0 - part, low.near(output, line, mode), over_linear))
            if same is not None and at_high is not None and over_linear_high is not None:
                known.append((part, high.near(output, at_high, same), over_linear_high))
            if not known:
                continue
            weights = np.array([weight for weight, *_ in known]) if len(known) > 1 else np.ones(1)
            over = float(weights @ [level for *_, level in known])
            levels = weights @ np.array([near for _, near, _ in known]) + over
            top = int(np.argmax(levels))
            # A mode on the flank of a higher peak has no peak of its own.
            if 0 < top < len(PLACES_ABOUT_MODE) - 1:
                yield _Peak(output, mode, middle + half * float(PLACES_ABOUT_MODE[top]), half, float(levels[top]), over)
