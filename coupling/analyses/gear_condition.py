"""Condition indicators of every gear at every sensor of a record, with the reason where one is undefined.

The indicators are those of :mod:`gearwhine.coupling.signals.condition_indicators`. Beside the ratios there are the rms
values of the residual and of the difference signal, which no ratio hides, and that of the change of the difference
signal since an earlier record, which takes a tachometer that knows the angle. The spectral kurtosis is the highest one
over the frequencies of the record, by windows of an eighth of a turn; the envelope is that of the upper half of the
band, at the turn of the gear's shaft or at a tone of a bearing, over the mean of the squared envelope.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np

from gearwhine.coupling.analyses.condition_record import ConditionRecord, MonitoredGear
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.signals.condition_indicators import (
    SynchronousAverage,
    envelope_spectrum,
    na4,
    spectral_kurtosis,
)
from gearwhine.numerics.arrays import FloatArray

_WINDOWS_PER_TURN = 8
_LEAST_WINDOW = 8  # samples
_LEAST_PERIODS = 4  # of a tone whose envelope line is taken
_SURE = 2.0  # least rms of a difference signal over that of what the turns differ by


@dataclass(frozen=True, eq=False)
class WatchedSignal:
    """Signal of a sensor as a gear's indicators take it.

    Attributes
    ----------
    average : SynchronousAverage
        Average over the turns of the gear's shaft.
    signal : ndarray, shape (s,)
        Acceleration [m/s²].
    interval : float
        Time between samples [s].
    turn_hz, limit_hz : float
        Turns of the shaft in a second; frequency up to which the signal holds something.
    is_steady : bool
        Whether the speed is constant.
    unsettled : SynchronousAverage or None
        What the average is not sure of; None where that is known to be nothing.
    healthy : SynchronousAverage or None
        Average of an earlier record, without a fault; None where the record is the first one.
    tone_hz : float
        Frequency at which the envelope is taken, as that of a spall of a bearing; 0 for the turns of the shaft.
    """

    average: SynchronousAverage
    signal: FloatArray
    interval: float
    turn_hz: float
    limit_hz: float
    is_steady: bool = True
    unsettled: SynchronousAverage | None = None
    healthy: SynchronousAverage | None = None
    tone_hz: float = 0.0

    @cached_property
    def no_residual(self) -> str:
        """Why there is no difference signal; empty where there is one."""
        if self.average.is_nothing(self.average.difference):
            return "the average holds mesh harmonics with their sidebands alone"
        if self.unsettled is not None:
            rms, unsure = float(np.std(self.average.difference)), float(np.std(self.unsettled.difference))
            if rms < _SURE * unsure:
                return (
                    f"the difference signal, {rms:.2g} m/s², is hardly more than what the turns differ by, "
                    f"{unsure:.2g} m/s²: average more turns, or discard more"
                )
        return ""


@dataclass(frozen=True)
class Indicator:
    """A condition indicator.

    Attributes
    ----------
    key : str
        Key in documents, with the unit at its end.
    title : str
        Short name for tables and figures.
    of : callable
        Value of a watched signal; None where it has none.
    of_residual : bool
        Whether it says nothing without a difference signal.
    of_time : bool
        Whether it needs a constant speed.
    growth : {"ratio", "difference", "itself"}
        How it is compared with that of an earlier record; NA4 and the rms of the change are so already.
    lacking : str
        Reason where it has no value.
    """

    key: str
    title: str
    of: Callable[[WatchedSignal], float | None]
    of_residual: bool = False
    of_time: bool = False
    growth: Literal["ratio", "difference", "itself"] = "ratio"
    lacking: str = "the average has no mesh harmonics"

    def value(self, watched: WatchedSignal) -> tuple[float | None, str]:
        """Return the value, or None with the reason why there is none."""
        if self.of_residual and watched.no_residual:
            return None, watched.no_residual
        if self.of_time and not watched.is_steady:
            return None, "the speed varies over the record"
        try:
            value = self.of(watched)
        except CouplingError as error:
            return None, str(error)
        if value is None or not math.isfinite(value):
            return None, self.lacking
        return value, ""

    def grown(self, value: float, before: float) -> float:
        """Compare a value with that of an earlier record; NaN where there is no ratio."""
        if self.growth == "itself":
            return value
        if self.growth == "difference":
            return value - before
        return value / before if before > 0.0 else math.nan


def _na4(watched: WatchedSignal) -> float | None:
    """NA4 with the mean square of the healthy gear (NA4*), else of the record's own."""
    if watched.healthy is None:
        return na4([watched.average])
    mean_square = float(np.mean(watched.healthy.residual**2))
    return float(np.mean(watched.average.residual**4)) / mean_square**2 if mean_square > 0.0 else None


def _change_rms(watched: WatchedSignal) -> float | None:
    """Rms of the difference signal of the average less that of the earlier record."""
    if watched.healthy is None:
        return None
    return float(np.std(watched.average.difference - watched.healthy.difference))


def _highest_kurtosis(watched: WatchedSignal) -> float:
    turn = 1.0 / (watched.turn_hz * watched.interval)
    window = max(int(turn / _WINDOWS_PER_TURN), _LEAST_WINDOW)
    frequencies, kurtosis = spectral_kurtosis(watched.signal, watched.interval, window)
    return float(kurtosis[(frequencies > 0.0) & (frequencies <= watched.limit_hz)].max())


def envelope_at(signal: FloatArray, interval: float, limit_hz: float, tone_hz: float) -> float:
    """Amplitude of a tone in the squared envelope of the upper half of the band, over its mean.

    The last whole periods of the tone are taken.

    Raises
    ------
    CouplingError
        Where the record holds fewer than four periods.
    """
    periods = math.floor(len(signal) * interval * tone_hz + 1e-9)
    if periods < _LEAST_PERIODS:
        raise CouplingError(f"{periods} periods of {tone_hz:.4g} Hz in the record; expected {_LEAST_PERIODS} or more")
    whole = signal[len(signal) - round(periods / (tone_hz * interval)) :]
    _, lines = envelope_spectrum(whole, interval, (0.5 * limit_hz, limit_hz))
    return float(lines[periods] / lines[0]) if lines[0] > 0.0 else 0.0


INDICATORS: dict[str, Indicator] = {
    "rms": Indicator("rms_m_per_s2", "rms", lambda one: float(np.std(one.average.samples))),
    "residual_rms": Indicator("residual_rms_m_per_s2", "residual rms", lambda one: float(np.std(one.average.residual))),
    "difference_rms": Indicator(
        "difference_rms_m_per_s2", "difference rms", lambda one: float(np.std(one.average.difference))
    ),
    "fm0": Indicator("fm0", "FM0", lambda one: one.average.fm0),
    "fm4": Indicator("fm4", "FM4", lambda one: one.average.fm4, of_residual=True),
    "m6a": Indicator("m6a", "M6A", lambda one: one.average.m6a, of_residual=True),
    "m8a": Indicator("m8a", "M8A", lambda one: one.average.m8a, of_residual=True),
    "na4": Indicator("na4", "NA4", _na4, of_residual=True, growth="itself"),
    "energy_ratio": Indicator("energy_ratio", "energy ratio", lambda one: one.average.energy_ratio),
    "sideband_index": Indicator("sideband_index_m_per_s2", "sideband index", lambda one: one.average.sideband_index),
    "sideband_level_factor": Indicator(
        "sideband_level_factor", "sideband level factor", lambda one: one.average.sideband_level_factor
    ),
    "spectral_kurtosis": Indicator(
        "spectral_kurtosis", "spectral kurtosis", _highest_kurtosis, of_time=True, growth="difference"
    ),
    "envelope": Indicator(
        "envelope",
        "envelope line",
        lambda one: envelope_at(one.signal, one.interval, one.limit_hz, one.tone_hz or one.turn_hz),
        of_time=True,
    ),
    "change_rms": Indicator(
        "change_rms_m_per_s2", "change rms", _change_rms, growth="itself", lacking="there is no earlier record"
    ),
}
"""Condition indicators by name."""
OF_ONE_RECORD = tuple(name for name in INDICATORS if name != "change_rms")
"""Condition indicators that take no earlier record."""


@dataclass(frozen=True)
class SensorCondition:
    """Condition indicators of a gear at a sensor.

    Attributes
    ----------
    sensor : str
    values : dict of str to float or None
        By indicator; None where it is undefined.
    undefined : dict of str to str
        Reason of each that is.
    """

    sensor: str
    values: dict[str, float | None]
    undefined: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class GearCondition:
    """Condition indicators of a gear.

    Attributes
    ----------
    gear : MonitoredGear
    sensors : tuple of SensorCondition
        None where the gear has no average.
    """

    gear: MonitoredGear
    sensors: tuple[SensorCondition, ...]


@dataclass(frozen=True)
class ToneCondition:
    """Line of a rolling bearing's characteristic frequency in the envelope spectra.

    Attributes
    ----------
    tone : str
        Bearing and damaged part.
    frequency_hz : float
    amplitudes : dict of str to float or None
        Over the mean of the squared envelope, by sensor; None where the record is too short or the speed varies.
    """

    tone: str
    frequency_hz: float
    amplitudes: dict[str, float | None]


@dataclass(frozen=True)
class MachineCondition:
    """Condition indicators of the gears and bearings of a machine.

    Attributes
    ----------
    limit_hz : float
        Frequency up to which the signals are taken.
    gears : tuple of GearCondition
    tones : tuple of ToneCondition
    envelope_hz : ndarray, shape (f,)
        Frequencies of the envelope spectra; empty without rolling bearings, and where the speed varies.
    envelopes : dict of str to ndarray, shape (f,)
        Amplitudes of the squared envelope over its mean, under Hann's window, by sensor.
    """

    limit_hz: float
    gears: tuple[GearCondition, ...]
    tones: tuple[ToneCondition, ...]
    envelope_hz: FloatArray = field(default_factory=lambda: np.empty(0))
    envelopes: dict[str, FloatArray] = field(default_factory=dict)


def averaged_gear(gear: MonitoredGear, samples: FloatArray, limit_hz: float) -> SynchronousAverage:
    """Return an average of a gear's shaft with the mesh harmonics that lie below a limit with their sidebands."""
    harmonics = max(int((limit_hz / gear.turn_hz - 1.0) / gear.teeth), 1)
    return SynchronousAverage(samples, gear.teeth, harmonics, gear.others)


def machine_condition(record: ConditionRecord, indicators: Sequence[str] = OF_ONE_RECORD) -> MachineCondition:
    """Find the condition indicators of a record.

    Parameters
    ----------
    record : ConditionRecord
    indicators : sequence of str
        Names of :data:`INDICATORS`.

    Raises
    ------
    CouplingError
        Where an indicator is none of them.
    """
    if unknown := [name for name in indicators if name not in INDICATORS]:
        raise CouplingError(f"indicator {unknown[0]!r}; expected some of {', '.join(INDICATORS)}")
    gears = tuple(GearCondition(gear, tuple(_of_gear(record, gear, indicators))) for gear in record.gears)
    tones = tuple(
        ToneCondition(tone, frequency, {name: _of_tone(record, name, frequency) for name in record.sensors})
        for tone, frequency in record.tones_hz.items()
    )
    frequencies, envelopes = _envelopes(record) if tones and record.is_steady else (np.empty(0), {})
    return MachineCondition(record.limit_hz, gears, tones, frequencies, envelopes)


def _envelopes(record: ConditionRecord) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Return the envelope spectra of the sensors over their means, up to the width of the band."""
    frequencies, found = np.empty(0), dict[str, FloatArray]()
    for name, signal in record.signals.items():
        all_of, lines = envelope_spectrum(signal, record.interval, (0.5 * record.limit_hz, record.limit_hz), hann=True)
        within = all_of <= 0.5 * record.limit_hz
        frequencies = all_of[within]
        found[name] = lines[within] / lines[0] if lines[0] > 0.0 else np.zeros(len(frequencies))
    return frequencies, found


def _of_gear(record: ConditionRecord, gear: MonitoredGear, indicators: Sequence[str]) -> list[SensorCondition]:
    found = list[SensorCondition]()
    for sensor in () if gear.undefined else record.sensors:
        place = gear.shaft, sensor
        watched = WatchedSignal(
            averaged_gear(gear, record.averages[place], record.limit_hz),
            record.signals[sensor],
            record.interval,
            gear.turn_hz,
            record.limit_hz,
            record.is_steady,
            averaged_gear(gear, record.unsettled[place], record.limit_hz) if place in record.unsettled else None,
        )
        both = {name: INDICATORS[name].value(watched) for name in indicators}
        values = {name: value for name, (value, _) in both.items()}
        found.append(SensorCondition(sensor, values, {name: reason for name, (_, reason) in both.items() if reason}))
    return found


def _of_tone(record: ConditionRecord, sensor: str, frequency: float) -> float | None:
    if not record.is_steady:
        return None
    try:
        return envelope_at(record.signals[sensor], record.interval, record.limit_hz, frequency)
    except CouplingError:
        return None
