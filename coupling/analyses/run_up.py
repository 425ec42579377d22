"""Signature of a run-up or run-down: spectra along the run, order cuts and overall level over the speed.

Spectra are those of windows in time, order cuts those of windows in revolutions, see
:mod:`gearwhine.coupling.signals.order_tracking`. Both reach from the first speed of the run to the last. A line of
order o whose shaft gains n' revolutions a second each second moves by o n' T over a window of the duration T, whose own
lines are 1 / T apart: T = 2 / √(o n') balances both.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearwhine.coupling import signals as signature
from gearwhine.coupling.analyses.transient import SolvedTransient
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.linear.excitation_orders import excitation_lines
from gearwhine.coupling.signals import decibels, peak_of_rms
from gearwhine.coupling.signals.spectrum import Window
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Number, attribute_findings, refuse
from gearwhine.numerics.result_warnings import warning

_TWO_PI = 2.0 * np.pi
_SLOWEST = 0.1  # part of the highest speed below which samples are left out: a turn would take too many of them
_LEAST_WINDOWS_PER_RUN = 15  # part of the run that a window of the spectra takes at most
_SPECTRUM_OVERLAP = 0.9  # part of a window of the spectra that the next one shares
_MOST_WINDOWS = 400  # largest number of spectra and of order cuts along a run
_FEWEST_SAMPLES = 60  # least number of samples in which the machine turns
_WINDOWS = 60  # part of the run that a window of the orders takes, where these allow it
_HARMONICS = 3  # harmonics of each mesh that are followed
_ABOVE = 1.25  # highest order of the map over the highest named one
_APART, _PARTED = 3.0, 2.0  # lines of a window between orders: wanted, and the least that Hann's window separates
_FEWEST = 20  # least number of windows over speed, where the run has turns for them
_FEWEST_TURNS = 4
_BEYOND_LIMIT = 2.5  # samples for each cycle of the highest frequency at the lowest speed: all that resampling passes


@dataclass(frozen=True)
class RunSignature:
    """Spectrograms and orders of a run's signals, by their names.

    Attributes
    ----------
    units : dict of str to str
    spectra : dict of str to gearwhine.coupling.signals.Spectrogram
        Spectra of stretches along the run, up to the trusted limit.
    speeds_rpm : ndarray, shape (t,)
        Speed of the leading shaft in the middle of each stretch [rpm], of the sign of the speed of operation.
    overall : dict of str to ndarray, shape (t,)
        Overall level: rms over the lines of each spectrum, without the mean, in the signal's unit.
    orders : dict of str to gearwhine.coupling.signals.OrderMap
        Orders, in cycles each turn of the leading shaft, over its speeds of that sign; NaN of a sensor where an order's
        frequency is beyond the trusted limit.
    named : dict of str to float
        Orders that have names: shafts and harmonics of the meshes, of those of equal order one name for all.
    turns : int
        Turns of the leading shaft in a window of the orders.
    limit : float
        Trusted limit: the frequency up to which the orders of sensors are complete [Hz].
    """

    units: dict[str, str]
    spectra: dict[str, signature.Spectrogram]
    speeds_rpm: FloatArray
    overall: dict[str, FloatArray]
    orders: dict[str, signature.OrderMap]
    named: dict[str, float]
    turns: int
    limit: float

    def followed(self) -> FloatArray:
        """Peak amplitude of each signal at each named order, by the windows' speeds: (signals, orders, windows)."""
        return np.array([[table.order_slice(order) for order in self.named.values()] for table in self.orders.values()])

    def highest(self) -> list["OrderPeak"]:
        """Return the peak of each named order of each signal along the run, where the model is complete."""
        rows = []
        for (name, orders), courses in zip(self.orders.items(), self.followed(), strict=True):
            for (order_name, order), along in zip(self.named.items(), courses, strict=True):
                if np.isnan(along).all():
                    continue
                place = int(np.nanargmax(along))
                speed_rpm = float(60.0 * orders.speeds[place])
                hertz = float(order * abs(orders.speeds[place]))
                rows.append(OrderPeak(name, self.units[name], order_name, order, float(along[place]), speed_rpm, hertz))
        return rows

    def loudest(self) -> list["OverallPeak"]:
        """Return the highest overall level of each signal along the run."""
        return [
            OverallPeak(name, self.units[name], float(overall.max()), float(self.speeds_rpm[int(np.argmax(overall))]))
            for name, overall in self.overall.items()
        ]

    def highest_of(self, signal: str) -> list["OrderPeak"]:
        """Return the rows of :meth:`highest` of one signal, the highest order first."""
        return sorted((row for row in self.highest() if row.signal == signal), key=lambda row: -row.highest_amplitude)


@dataclass(frozen=True)
class OrderPeak:
    """Highest amplitude of an order of a signal along a run.

    Attributes
    ----------
    signal : str
        Sensor or contact.
    unit : str
        Unit of its amplitudes.
    name : str
        Name of the order.
    order : float
        Cycles each turn of the leading shaft.
    highest_amplitude : float
        Peak amplitude, in the unit of the signal.
    at_rpm : float
        Speed of the leading shaft there [rpm].
    frequency_hz : float
        Frequency there [Hz].
    """

    signal: str
    unit: str
    name: str
    order: float
    highest_amplitude: float
    at_rpm: float
    frequency_hz: float

    @property
    def level_db(self) -> float:
        """Level of the amplitude [dB]."""
        return float(decibels(self.highest_amplitude))


@dataclass(frozen=True)
class OverallPeak:
    """Highest root mean square of a signal along a run.

    Attributes
    ----------
    signal : str
        Sensor or contact.
    unit : str
        Unit of its amplitudes.
    highest_rms : float
        Root mean square, in the unit of the signal.
    at_rpm : float
        Speed of the leading shaft there [rpm].
    """

    signal: str
    unit: str
    highest_rms: float
    at_rpm: float

    @property
    def level_db(self) -> float:
        """Level of the root mean square [dB]."""
        return float(decibels(peak_of_rms(self.highest_rms)))


@dataclass(frozen=True)
class _Windows:
    """Windows of a run: the samples in which the machine turns, and the turns of an order map's windows.

    Attributes
    ----------
    span : slice
    turns : int
        Turns of the leading shaft in each window.
    step : float
        Turns from the middle of a window to the next.
    named : dict of str to float
        Orders that windows of that length separate.
    merged : tuple of str
        Names of the orders that they do not separate.
    """

    span: slice
    turns: int
    step: float
    named: dict[str, float]
    merged: tuple[str, ...]


@dataclass(frozen=True)
class OrderTracking:
    """Windows of the order cuts along a run, by revolutions of the first driver's shaft.

    Attributes
    ----------
    window : {"hann", "uniform"}
        Weights of a window's samples.
    resolution : float or None
        Spacing of the orders that a window tells apart: it is as many revolutions long as the inverse, rounded up. By
        default as fine as the orders of shafts and meshes need, as far as the run has revolutions for it.
    overlap : float
        Part of a window that the next one shares.
    """

    window: Window = "hann"
    resolution: float | None = None
    overlap: float = 0.9

    def __post_init__(self) -> None:
        """Require a resolution and an overlap that leave windows."""
        resolution = Number(above=0.0, at_most=1.0, optional=True)
        overlap = Number(at_least=0.0, below=1.0)
        findings = attribute_findings(("order tracking", ""), self, resolution=resolution, overlap=overlap)
        refuse(findings, CouplingError)


def solve_run_signature(solved: SolvedTransient, tracking: OrderTracking) -> RunSignature | None:
    """Spectra and orders of sensors and mesh forces along a run, as far as it is held in memory.

    None at steady speed, and where the run has too few turns to tell orders apart: :func:`run_signature_warnings` says
    why.
    """
    cut = _windows(solved, tracking)
    profile = solved.speed_profile
    if not isinstance(cut, _Windows) or profile is None:
        return None
    span, named = cut.span, cut.named
    times = solved.histories.times[span]
    interval = float(times[1] - times[0])
    turns_per_second, sense = abs(solved.speed) / _TWO_PI, math.copysign(1.0, solved.speed)
    slowest = turns_per_second * float(profile.at(times)[1].min())
    per_turn = math.ceil(min(_BEYOND_LIMIT * solved.trusted_limit / slowest, 1.0 / (slowest * interval)))
    per_turn = max(per_turn, math.ceil(_BEYOND_LIMIT * _ABOVE * max(named.values())))
    length = _window_length(solved, times)
    step = max(round((1.0 - _SPECTRUM_OVERLAP) * length), len(times) // _MOST_WINDOWS, 1)
    units, spectra, overall, orders = {}, {}, {}, {}
    signals = {name: (signal, "m/s²") for name, signal in solved.histories.sensor_acceleration.items()}
    for number in solved.machine.loaded_contacts:
        name = solved.machine.system.contacts[number].name
        signals[name] = solved.histories.mesh_force[name], "N"
    for name, (signal, unit) in signals.items():
        along = signature.spectrogram(
            signal[span], interval, length, step, start=float(times[0]), to_the_ends=True
        ).up_to(solved.trusted_limit)
        units[name], spectra[name], overall[name] = unit, along, along.rms
        turned = signature.resample_by_angle(
            signal[span], times, profile, turns_per_second, per_turn=per_turn, whole_turns=False
        )
        mapped = signature.order_map(
            turned, turns=cut.turns, step=cut.step, window=tracking.window, follow=sorted(set(named.values()))
        )
        mapped = _orders_up_to(replace(mapped, speeds=sense * mapped.speeds), _ABOVE * max(named.values()))
        orders[name] = (
            _complete(mapped, solved.trusted_limit) if name in solved.histories.sensor_acceleration else mapped
        )
    middles = next(iter(spectra.values())).times
    speeds_rpm = 60.0 * sense * turns_per_second * profile.at(middles)[1]
    return RunSignature(units, spectra, speeds_rpm, overall, orders, named, cut.turns, solved.trusted_limit)


def _window_length(solved: SolvedTransient, times: FloatArray) -> int:
    """Return the number of samples of a window of the spectra: T = 2 / √(o n') for the highest mesh order o."""
    assert solved.speed_profile is not None
    turns_per_second = abs(solved.speed) / _TWO_PI
    gain = turns_per_second * float(np.abs(solved.speed_profile.at(times)[2]).max())
    contacts = solved.machine.system.contacts
    order = max(abs(contact.mesh_frequency) for contact in contacts) / turns_per_second
    interval, longest = float(times[1] - times[0]), len(times) // _LEAST_WINDOWS_PER_RUN
    shortest = 2.0 / math.sqrt(order * gain) / interval if gain > 0.0 else longest
    return 2 * max(round(0.5 * min(shortest, longest)), 2)


def run_signature_warnings(solved: SolvedTransient, tracking: OrderTracking) -> list[dict[str, Any]]:
    """Warn of missing parts of a run's signature, with the reason; steady speed has none."""
    cut = _windows(solved, tracking)
    if cut is None:
        return []
    if isinstance(cut, str):
        return [warning("run signature", f"no spectra and orders along the run: {cut}")]
    if not cut.merged:
        return []
    text = (
        f"orders along the run without {', '.join(cut.merged)}: windows of {cut.turns} turns do not tell them from "
        "their neighbours; a longer run does"
    )
    return [warning("run signature", text, turns=cut.turns)]


def _windows(solved: SolvedTransient, tracking: OrderTracking) -> _Windows | str | None:
    """Return the windows of a run; in words why there are none, and None at steady speed or without gears."""
    profile, times = solved.speed_profile, solved.histories.times
    if profile is None or not solved.machine.meshes:
        return None
    span = _turning_span(profile.at(times)[1])
    times = times[span]
    if len(times) < _FEWEST_SAMPLES:
        return f"{len(times)} samples in which the machine turns; expected {_FEWEST_SAMPLES} or more"
    turns_per_second = abs(solved.speed) / _TWO_PI
    first, last = turns_per_second * profile.at(times[[0, -1]])[0]
    # As `resample_by_angle` counts them: the end of the last sample's interval closes a turn.
    last += turns_per_second * float(profile.at(times[-1:])[1][0]) * float(times[1] - times[0])
    total = math.floor(last + 1e-9) - math.ceil(first - 1e-9)
    if total < _FEWEST_TURNS:
        return (
            f"{last - first:.3g} turns of the leading shaft in the record, {max(total, 0)} whole ones; "
            f"expected {_FEWEST_TURNS} or more"
        )
    named = _named_orders(solved)
    # As many turns as separate the closest orders, and the lowest from zero, as far as the run leaves some windows.
    ascending = np.unique([0.0, *named.values()])
    needed = math.ceil(_APART / float(np.diff(ascending).min()) - 1e-9)
    turns = max(2 * total // _WINDOWS, 2, needed)
    whole = math.lcm(*(ratio.denominator for ratio in solved.machine.speed_ratios.values()))
    if whole <= turns:
        # Windows of whole turns of every shaft have every order as a line.
        turns = math.ceil(turns / whole) * whole
    turns = min(turns, max(2 * total // _FEWEST, 2))
    if tracking.resolution is not None:
        turns = math.ceil(1.0 / tracking.resolution - 1e-9)
        if turns > total:
            return f"{total} turns of the leading shaft for windows of {turns}, by the resolution of the orders"
    # Where two orders are too close to each other, the lower harmonic or the first shaft is followed.
    followed: dict[str, float] = {}
    for name, order in named.items():
        neighbours = [0.0, *(followed_order for followed_order in followed.values() if followed_order != order)]
        if min(abs(order - followed_order) for followed_order in neighbours) * turns >= _PARTED - 1e-9:
            followed[name] = order
    merged = tuple(name for name in named if name not in followed)
    if not followed:
        return f"windows of {turns} turns tell no order apart"
    step = max((1.0 - tracking.overlap) * turns, total / _MOST_WINDOWS)
    return _Windows(span, turns, step, followed, merged)


def _turning_span(rates: FloatArray) -> slice:
    """Return the longest stretch of samples in which the machine turns fast enough."""
    fast = np.concatenate([[0], (rates >= _SLOWEST * rates.max()).astype(np.int64), [0]])
    changes = np.diff(fast)
    begins, ends = np.flatnonzero(changes == 1), np.flatnonzero(changes == -1)
    longest = int(np.argmax(ends - begins))
    return slice(int(begins[longest]), int(ends[longest]))


def _named_orders(solved: SolvedTransient) -> dict[str, float]:
    """Shafts and harmonics of the meshes, by the turns of the leading shaft."""
    lines = excitation_lines(solved.machine, shaft_orders=(1.0,), mesh_harmonics=tuple(range(1, _HARMONICS + 1)))
    # Exact fractions: the machine's speeds are rounded.
    whole = math.lcm(*(ratio.denominator for ratio in solved.machine.speed_ratios.values()))
    together: dict[float, list[str]] = {}
    for line in lines:
        together.setdefault(round(line.order * whole) / whole, []).append(line.name)
    return {", ".join(names): order for order, names in together.items()}


def _complete(table: signature.OrderMap, limit: float) -> signature.OrderMap:
    """Return the orders of a sensor without those whose frequency is beyond a limit [Hz]: NaN there."""
    rates, most = np.abs(table.speeds), limit * (1.0 + 1e-9)
    return replace(
        table,
        amplitude=np.where(np.outer(rates, table.orders) <= most, table.amplitude, np.nan),
        followed={order: np.where(order * rates <= most, along, np.nan) for order, along in table.followed.items()},
    )


def _orders_up_to(table: signature.OrderMap, limit: float) -> signature.OrderMap:
    below = table.orders <= limit
    return replace(table, orders=table.orders[below], amplitude=table.amplitude[:, below])
