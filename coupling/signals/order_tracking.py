"""Order tracking: signals of a run-up resampled by rotation angle, and their order spectra.

A component that repeats with every revolution is a line at its order, whatever the speed; over time such a line is
smeared across all frequencies that it passes. A tachometer would have to be interpolated for this (Potter 1990); here
:class:`gearwhine.coupling.SpeedProfile` gives the angle exactly. Only the signal is interpolated, by splines of the
fifth degree, whose error falls with the sixth power of the sampling interval.

An order cut is the amplitude of one order along the run. With φ the angle in revolutions and u = φ - φ₀ that from the
middle of a window, the complex amplitudes of the orders o change slowly within the window, so that

    x(φ) = m₀ + m₁ u + m₂ u² + Σ_o Re (a₀ + a₁ u + a₂ u²) e^{2πi o φ}

is fitted to its samples by weighted least squares, for all orders together (local polynomial regression; Fan and
Gijbels 1996), and |a₀| is the amplitude at the middle. Followed orders do not leak into each other, and an amplitude
that rises, falls or bends is not flattened. At an end of the record the window reaches inwards as far as it is cut, and
the polynomial is of the first degree.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import make_interp_spline

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.speed_profile import SpeedProfile
from gearwhine.coupling.signals.decimation import decimation
from gearwhine.coupling.signals.spectrum import Spectrum, Window, amplitude_spectrum, cut_spectra
from gearwhine.numerics.arrays import FloatArray

_MOST_SAMPLES = 50_000_000  # largest number of samples by angle
_DEGREE = 5
_BAND = 0.4  # orders that an anti-aliasing filter passes, over the samples per revolution


@dataclass(frozen=True)
class AngleSignal:
    """A signal at even spacing in revolutions of the machine's leading shaft, s samples.

    Attributes
    ----------
    turns : ndarray, shape (s,)
        Revolutions since t = 0, multiples of 1 / per_turn.
    times : ndarray, shape (s,)
        [s].
    speeds : ndarray, shape (s,)
        Revolutions per second [Hz].
    values : ndarray, shape (..., s)
    per_turn : int
        Samples per revolution.
    """

    turns: FloatArray
    times: FloatArray
    speeds: FloatArray
    values: FloatArray
    per_turn: int


def resample_by_angle(
    signal: FloatArray,
    times: FloatArray,
    speed_profile: SpeedProfile,
    turns_per_second: float,
    *,
    per_turn: int | None = None,
    whole_turns: bool = True,
) -> AngleSignal:
    """Resample a signal by rotation angle, over its record or the whole revolutions in it.

    Parameters
    ----------
    signal : ndarray, shape (..., s)
    times : ndarray, shape (s,)
        Times [s], evenly spaced, s at least 6.
    speed_profile : SpeedProfile
        Speed of the machine over time, relative to the nominal one.
    turns_per_second : float
        Nominal speed of the leading shaft [Hz], positive.
    per_turn : int, optional
        Samples per revolution, by default as many as in time at the lowest speed. With fewer, an anti-aliasing filter
        (:mod:`gearwhine.coupling.signals.decimation`) leaves orders up to 0.4 of them as they are and takes away those
        that would fold onto them. Half its length, some twenty samples, is made up at both ends of the record by odd
        reflection.
    whole_turns : bool
        Whether parts of a revolution at the record's ends are left out.

    Raises
    ------
    CouplingError
        Where the machine does not turn once in the record, stands still in it, or so slowly that the samples would be
        without end.
    """
    if not 0.0 < turns_per_second < np.inf:
        raise CouplingError(f"a nominal speed of {turns_per_second} turns a second; expected a positive number")
    if times.ndim != 1 or signal.shape[-1] != times.size or times.size <= _DEGREE:
        raise CouplingError(
            f"a signal of shape {signal.shape} at times of shape {times.shape}; expected as many, 6 or more"
        )
    interval = float(times[-1] - times[0]) / (times.size - 1)
    given = speed_profile.times
    rates = speed_profile.at(np.concatenate([times, given[(given > times[0]) & (given < times[-1])]]))[1]
    slowest = turns_per_second * float(rates.min())
    if slowest <= 0.0:
        raise CouplingError("the machine stands still in the record; take a part of it in which the machine turns")
    begin, end = turns_per_second * speed_profile.at(times[[0, -1]])[0]
    # The end of the last sample's interval closes a turn.
    first, last = (
        np.ceil(begin - 1e-9),
        np.floor(end + turns_per_second * float(rates[times.size - 1]) * interval + 1e-9),
    )
    if last - first < 1.0:
        raise CouplingError(f"the record has {end - begin:.3g} turns; expected a whole one at least")
    recorded = int(np.ceil(1.0 / (slowest * interval) - 1e-9))
    per_turn = recorded if per_turn is None else per_turn
    factor = max(-(-recorded // max(per_turn, 1)), 1)
    if per_turn < 2 or per_turn * factor * (last - first) > _MOST_SAMPLES:
        raise CouplingError(
            f"{per_turn * factor} samples a turn over {last - first:.0f} turns; expected 2 or more, at most "
            f"{_MOST_SAMPLES} in all: take a part of the record in which the machine turns faster"
        )
    fine = per_turn * factor
    if whole_turns:
        turns = first + np.arange(int(last - first) * fine) / fine
    else:
        turns = np.arange(np.ceil(begin * fine - 1e-6), np.floor(end * fine + 1e-6) + 1.0) / fine
    # The last ones may lie within the last sample's interval, where the spline goes on.
    at = speed_profile.times_of(turns / turns_per_second)
    values = make_interp_spline(times, np.moveaxis(signal, -1, 0), k=_DEGREE)(at)
    values, at, turns = _decimated(np.asarray(values), factor), at[::factor], turns[::factor]
    speeds = turns_per_second * speed_profile.at(at)[1]
    return AngleSignal(turns, at, speeds, np.moveaxis(values, 0, -1), per_turn)


def _decimated(values: FloatArray, factor: int) -> FloatArray:
    """Return every ``factor``-th of the values, shape (s, ...), without orders that would fold onto the band."""
    if factor == 1:
        return values
    low_pass = decimation(factor, _BAND)
    reach = np.arange(1, min(low_pass.delay, len(values) - 1) + 1)
    before, after = 2.0 * values[0] - values[reach[::-1]], 2.0 * values[-1] - values[-1 - reach]
    missing = low_pass.delay - len(reach)
    record = np.concatenate([*[before[:1]] * missing, before, values, after, *[after[-1:]] * missing])
    kept, _ = low_pass.through(np.zeros((0, values[0].size)), record.reshape(len(record), -1))
    return kept.reshape(-1, *values.shape[1:])


def order_spectrum(turned: AngleSignal, window: Window = "uniform") -> Spectrum:
    """Amplitude spectrum by order, over all revolutions: ``frequencies`` are cycles per revolution."""
    return amplitude_spectrum(turned.values, 1.0 / turned.per_turn, window)


@dataclass(frozen=True)
class OrderMap:
    """Order spectra along a run-up, w windows.

    Attributes
    ----------
    times : ndarray, shape (w,)
        Time of the middle of each window [s].
    speeds : ndarray, shape (w,)
        Speed of the leading shaft there [Hz].
    orders : ndarray, shape (m,)
        Cycles per revolution of the leading shaft.
    amplitude : ndarray, shape (w, m)
        Peak amplitudes in the signal's unit; the mean at order 0.
    window : {"uniform", "hann"}
    followed : dict of float to ndarray, shape (w,)
        Order cuts: amplitudes of given orders at the middles of the windows, whether lines of the windows or not.
    """

    times: FloatArray
    speeds: FloatArray
    orders: FloatArray
    amplitude: FloatArray
    window: Window
    followed: dict[float, FloatArray] = field(default_factory=dict)

    def order_slice(self, order: float) -> FloatArray:
        """Amplitude of an order over speed, shape (w,).

        Raises
        ------
        CouplingError
            Where it was not followed and the windows do not hold whole cycles of it, or it is beyond half the samples
            of a revolution.
        """
        if order in self.followed:
            return self.followed[order]
        nearest = int(np.argmin(np.abs(self.orders - order)))
        if abs(float(self.orders[nearest]) - order) > 1e-6 * max(order, 1.0):
            raise CouplingError(
                f"no line at order {order:g}; there are multiples of {self.orders[1]:g} to {self.orders[-1]:g}: take "
                "windows of as many turns as hold whole cycles of it, or ask for it when the map is made"
            )
        return np.asarray(self.amplitude[:, nearest])


def order_map(
    turned: AngleSignal, *, turns: int, step: float = 1.0, window: Window = "hann", follow: Sequence[float] = ()
) -> OrderMap:
    """Order spectra of windows along a signal of shape (s,), and the cuts of some orders.

    The middles of the windows reach from the first sample to the last: a run-up from 1000 to 6000 rpm has its orders at
    1000 and at 6000 rpm. Towards the ends windows are shorter, see
    :func:`gearwhine.coupling.signals.spectrum.cut_spectra`.

    Parameters
    ----------
    turned : AngleSignal
    turns : int
        Length of a window, in revolutions: its lines are 1 / turns apart.
    step : float
        Distance from the middle of a window to the next, in revolutions, in the mean: they are even in time, so that
        they are even over a speed that rises evenly.
    window : {"uniform", "hann"}
    follow : sequence of float
        Orders that are cut. Under Hann's window 0.06 of an order that is not followed leaks into one that is
        2.5 / turns away, and 0.01 at 5 / turns; at the ends of the record 0.4 and 0.2.

    Raises
    ------
    CouplingError
        Where the windows are longer than the record, or an order is beyond half the samples of a turn.
    """
    if any(not 0.0 < order < 0.5 * turned.per_turn for order in follow):
        raise CouplingError(f"orders {list(follow)}; expected them above 0 and below {0.5 * turned.per_turn:g}")
    count, length = turned.turns.size, turns * turned.per_turn
    if not (turns >= 1 and length <= count and 0.0 < step < np.inf):
        raise CouplingError(
            f"windows of {turns} turns, {step:g} apart, of a record of {count / turned.per_turn:g}; expected 1 or "
            "more, a positive step and a record as long"
        )
    windows = int(np.ceil((count - 1) / (step * turned.per_turn) - 1e-9)) + 1
    evenly = np.linspace(turned.times[0], turned.times[-1], windows)
    middles = np.interp(evenly, turned.times, np.arange(count)).round().astype(int)
    cuts = [_order_cut(turned, middle, length, window, follow) for middle in middles.tolist()]
    return OrderMap(
        times=turned.times[middles],
        speeds=turned.speeds[middles],
        orders=np.asarray(np.fft.rfftfreq(length, 1.0 / turned.per_turn), dtype=np.float64),
        amplitude=cut_spectra(turned.values, middles, length, window)[0],
        window=window,
        followed={order: np.array([cut[number] for cut in cuts]) for number, order in enumerate(follow)},
    )


def _order_cut(turned: AngleSignal, middle: int, length: int, window: Window, follow: Sequence[float]) -> FloatArray:
    """Amplitudes of followed orders at the middle of a window, by the fit that the module states, shape (o,)."""
    if not follow:
        return np.zeros(0)
    first, weights = _cut_window(middle, length, turned.turns.size, window)
    inside = slice(first, first + weights.size)
    is_whole = length // 2 <= middle <= turned.turns.size - length + length // 2
    along = (np.arange(inside.start, inside.stop) - middle) / length
    phases = np.outer(2.0 * np.pi * np.asarray(follow), turned.turns[inside])
    shapes = np.concatenate([np.ones((1, along.size)), np.cos(phases), np.sin(phases)])
    basis = np.concatenate([shapes * along**degree for degree in range(3 if is_whole else 2)])
    weighted = basis * weights
    fitted = np.linalg.solve(weighted @ basis.T, weighted @ turned.values[inside])
    count = len(follow)
    return np.asarray(np.hypot(fitted[1 : 1 + count], fitted[1 + count : 1 + 2 * count]))


def _cut_window(middle: int, length: int, samples: int, window: Window) -> tuple[int, FloatArray]:
    """First sample and weights of a window about a sample, which at an end of the record reaches as far inwards.

    It has ``length`` samples everywhere. Half a window at the ends would let four times as much of other orders in.
    """
    first = min(max(middle - length // 2, 0), samples - length)
    if window == "uniform":
        return first, np.ones(length)
    before, after = max(middle - first, length // 2), max(first + length - middle, length - length // 2)
    offset = np.arange(first - middle, first - middle + length)
    return first, 0.5 + 0.5 * np.cos(np.pi * offset / np.where(offset < 0, before, after))
