"""Detectability of a fault by sensor and indicator: threshold, responses to its sizes, probability of detection."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearwhine.case.units import split_quantity
from gearwhine.detection.records import indicator_values, watched_signal
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.detection_probability import Detection, DetectionError, Law, Threshold, detection, threshold
from gearwhine.solutions import Failure
from gearwhine.variation.quantities import Evaluation


@dataclass(frozen=True)
class Monitor:
    """What watches a gearbox.

    Attributes
    ----------
    sensors, indicators : tuple of str
    sensor_noise : float
        Rms value of the noise of a sensor [m/s²].
    averages : int
        Number of turns over which it is averaged.
    false_alarm : float
    law : {"log-normal", "normal", "order"}
    seed : int
    has_own_baseline : bool
        Whether a record is compared with an earlier one of the same gearbox.
    """

    sensors: tuple[str, ...]
    indicators: tuple[str, ...]
    sensor_noise: float
    averages: int
    false_alarm: float
    law: Law
    seed: int
    has_own_baseline: bool = True


@dataclass(frozen=True, eq=False)
class Detectability:
    """Detectability of a fault by one indicator at one sensor.

    Attributes
    ----------
    sensor, indicator : str
    healthy : ndarray, shape (h,)
        Values of healthy gearboxes; NaN where it is undefined.
    sizes, responses : ndarray, shape (f,)
        Sizes of the faults in SI, and values of the gearboxes with them.
    threshold : Threshold or None
    detection : Detection or None
    undefined : str
        Why one of the two is None; else empty.
    """

    sensor: str
    indicator: str
    healthy: FloatArray
    sizes: FloatArray
    responses: FloatArray
    threshold: Threshold | None
    detection: Detection | None
    undefined: str = ""

    @property
    def a90(self) -> float | None:
        """Size that is found with a probability of 0.9; None where none is."""
        return None if self.detection is None else self.detection.a90

    @property
    def a90_95(self) -> float | None:
        """Size that is so with a confidence of 95 %; None where none is."""
        return None if self.detection is None else self.detection.a90_95


def detectability(
    sensor: str,
    indicator: str,
    healthy: FloatArray,
    sizes: FloatArray,
    responses: FloatArray,
    false_alarm: float,
    law: Law,
    reason: str = "",
) -> Detectability:
    """Find how well a fault is seen by an indicator at a sensor, from its values without and with the fault.

    Parameters
    ----------
    sensor, indicator : str
    healthy : ndarray, shape (h,)
        NaN of a gearbox without a value.
    sizes, responses : ndarray, shape (f,)
    false_alarm : float
    law : {"log-normal", "normal", "order"}
    reason : str
        Why a healthy value is undefined, where one is.
    """
    known, answered = healthy[np.isfinite(healthy)], np.isfinite(responses)
    all_values = np.concatenate([known, responses[answered]])
    if law == "log-normal" and not np.all(all_values > 0.0):
        law = "normal"
    limit, found, undefined = None, None, ""
    try:
        limit = threshold(known, false_alarm, law)
        found = detection(sizes[answered], responses[answered], limit)
    except DetectionError as error:
        undefined = reason if reason and known.size < healthy.size else str(error)
    return Detectability(sensor, indicator, healthy, sizes, responses, limit, found, undefined)


@dataclass(frozen=True, eq=False)
class DetectionResult:
    """Detectability of a fault by every indicator at every sensor.

    Attributes
    ----------
    fault : str
        Key of the fault's size.
    gear : str
        Gear by whose shaft signals are averaged.
    severities : dict of float to str
        Sizes as the case writes them, by their value in SI.
    monitor : Monitor
    is_varied : bool
        Whether the gearboxes are drawn from distributions.
    turns : float
        Turns of the shaft in a record.
    limit_hz : float
        Trusted limit, up to which signals and noise reach.
    parts : tuple of Detectability
        By sensor, and by indicator within it.
    failures : dict of int to Failure
        Samples without a record.
    samples, resumed : int
        Number of simulated gearboxes, and of those that an earlier run had found.
    """

    fault: str
    gear: str
    severities: dict[float, str]
    monitor: Monitor
    is_varied: bool
    turns: float
    limit_hz: float
    parts: tuple[Detectability, ...]
    failures: dict[int, Failure]
    samples: int
    resumed: int

    @cached_property
    def matrix(self) -> FloatArray:
        """Sizes a90 by sensor and indicator, NaN where no size is found, shape (sensors, indicators)."""
        values = [np.nan if one.a90 is None else one.a90 for one in self.parts]
        return np.array(values, dtype=np.float64).reshape(len(self.monitor.sensors), len(self.monitor.indicators))

    @cached_property
    def shown_unit(self) -> tuple[str, float]:
        """Unit of the largest size as the case writes it, and the factor to it from SI."""
        size, written = max(self.severities.items())
        parts = split_quantity(written)
        return ("", 1.0) if parts is None else (parts[1], float(parts[0]) / size)

    def part(self, sensor: str, indicator: str) -> Detectability:
        """Return the detectability by an indicator at a sensor."""
        return next(one for one in self.parts if (one.sensor, one.indicator) == (sensor, indicator))

    @cached_property
    def best(self) -> dict[str, Detectability | None]:
        """Indicator that sees the smallest fault, by sensor; None where none sees a size of the study.

        The one of the smallest a90, of equal ones that of the smallest a90/95; one whose hits contradict its curve
        comes after all others.
        """
        chosen: dict[str, Detectability | None] = {}
        for sensor in self.monitor.sensors:
            seen = [one for one in self.parts if one.sensor == sensor and one.a90 is not None]
            chosen[sensor] = min(seen, key=_rank, default=None)
        return chosen


def _rank(one: Detectability) -> tuple[bool, float, float]:
    """Return the place of an indicator among those that see the fault: the least is the best."""
    contradicted = one.detection is not None and one.detection.is_contradicted
    a90, a90_95 = (math.inf if size is None else size for size in (one.a90, one.a90_95))
    return contradicted, a90, a90_95


@dataclass(frozen=True)
class Observation:
    """A record of a gearbox, and the one that it is compared with.

    Attributes
    ----------
    found, earlier : Evaluation
    size : float
        Size of the fault; 0 of a healthy gearbox.
    noise : int
        Number of its noise: records of one gearbox alike differ by that alone.
    """

    found: Evaluation
    earlier: Evaluation
    size: float
    noise: int


def detected_parts(monitor: Monitor, observations: Sequence[Observation]) -> tuple[Detectability, ...]:
    """Find the detectability by every indicator at every sensor from records without and with the fault.

    Parameters
    ----------
    monitor : Monitor
    observations : sequence of Observation
    """
    sizes = np.array([one.size for one in observations])
    healthy = sizes == 0.0
    parts = list[Detectability]()
    for place, sensor in enumerate(monitor.sensors):
        rows = [_values(monitor, one, place) for one in observations]
        for column, name in enumerate(monitor.indicators):
            values = np.array([found[column] for found, _ in rows], dtype=np.float64)
            reasons = [said[column] for (_, said), sound in zip(rows, healthy, strict=True) if sound and said[column]]
            parts.append(
                detectability(
                    sensor,
                    name,
                    values[healthy],
                    sizes[~healthy],
                    values[~healthy],
                    monitor.false_alarm,
                    monitor.law,
                    reasons[0] if reasons else "",
                )
            )
    return tuple(parts)


def _values(monitor: Monitor, one: Observation, place: int) -> tuple[list[float], list[str]]:
    sensor, noise, averages = monitor.sensors[place], monitor.sensor_noise, monitor.averages
    now, before = (np.random.default_rng([monitor.seed, one.noise, place, record]) for record in (0, 1))
    if monitor.has_own_baseline:
        earlier = watched_signal(one.earlier, sensor, noise, averages, before)
        watched = watched_signal(one.found, sensor, noise, averages, now, earlier.average)
        return indicator_values(watched, monitor.indicators, earlier)
    reference = watched_signal(one.earlier, sensor).average
    watched = watched_signal(one.found, sensor, noise, averages, now, reference)
    return indicator_values(watched, monitor.indicators)
