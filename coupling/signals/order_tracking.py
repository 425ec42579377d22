"""Order tracking: signals of a run-up resampled by rotation angle, and their order spectra.

A component that repeats with every revolution is a line at its order, whatever the speed; over time such a line is
smeared across all frequencies that it passes. A tachometer would have to be interpolated for this (Potter 1990); here
:class:`coupling.SpeedProfile` gives the angle exactly. Only the signal is interpolated, by splines of the fifth degree,
whose error falls with the sixth power of the sampling interval.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from scipy.interpolate import make_interp_spline

from coupling.errors import CouplingError
from coupling.machine.speed_profile import SpeedProfile
from coupling.signals.decimation import decimation
from coupling.signals.spectrum import Spectrum, Window, amplitude_spectrum, lines_at

FloatArray = npt.NDArray[np.float64]

_MOST_SAMPLES = 50_000_000  # largest number of samples by angle
_DEGREE = 5
_BAND = 0.4  # orders that an anti-aliasing filter passes, over the samples per revolution


@dataclass(frozen=True)
class AngleSignal:
    """A signal at even spacing in revolutions of the machine's leading shaft, s samples.

    Attributes
    ----------
    turns : ndarray, shape (s,)
        Revolutions since t = 0, beginning with a whole number.
    times : ndarray, shape (s,)
        [s].
    Times [s].
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
    turning: SpeedProfile,
    turns_per_second: float,
    *,
    per_turn: int | None = None,
) -> AngleSignal:
    """Resample a signal by rotation angle, over the whole revolutions in its record.

    Parameters
    ----------
    signal : ndarray, shape (..., s)
    times : ndarray, shape (s,)
        Times [s], evenly spaced, s at least 6.
    turning : SpeedProfile
        Speed of the machine over time, relative to the nominal one.
    turns_per_second : float
        Nominal speed of the leading shaft [Hz], positive.
    per_turn : int, optional
        Samples per revolution, by default as many as in time at the lowest speed. With fewer, an anti-aliasing filter
        (:mod:`coupling.signals.decimation`) leaves orders up to 0.4 of them as they are and takes away those that
        would fold onto them. Half its length, some twenty samples, is made up at both ends of the record by odd
        reflection.

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
    rates = turning.at(
        np.concatenate([times, turning.times[(turning.times > times[0]) & (turning.times < times[-1])]])
    )[1]
    slowest = turns_per_second * float(rates.min())
    if slowest <= 0.0:
        raise CouplingError("the machine stands still in the record; take a part of it in which the machine turns")
    begin, end = turns_per_second * turning.at(times[[0, -1]])[0]
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
    turns = first + np.arange(int(last - first) * per_turn * factor) / (per_turn * factor)
    # The last ones may lie within the last sample's interval, where the spline goes on.
    at = turning.times_of(turns / turns_per_second)
    values = make_interp_spline(times, np.moveaxis(signal, -1, 0), k=_DEGREE)(at)
    values, at, turns = _decimated(np.asarray(values), factor), at[::factor], turns[::factor]
    speeds = turns_per_second * turning.at(at)[1]
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
    """Order spectra along a run-up, w windows of whole revolutions.

    Attributes
    ----------
    times : ndarray, shape (w,)
        Time of the middle of each window [s].
    speeds : ndarray, shape (w,)
        Mean speed of the leading shaft over each window [Hz].
    orders : ndarray, shape (m,)
        Cycles per revolution of the leading shaft.
    amplitude : ndarray, shape (w, m)
        Peak amplitudes in the signal's unit; the mean at order 0.
    window : {"uniform", "hann"}
    followed : dict of float to ndarray, shape (w,)
        Amplitudes of given orders, whether lines of the windows or not.
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
    turned: AngleSignal, *, turns: int, step: int = 1, window: Window = "hann", follow: Sequence[float] = ()
) -> OrderMap:
    """Order spectra of windows along a signal of shape (s,).

    Parameters
    ----------
    turned : AngleSignal
    turns, step : int
        Length of a window, and distance to the next, in revolutions.
    window : {"uniform", "hann"}
    follow : sequence of float
        Orders whose amplitude is evaluated in every window, whole cycles or not: a shaft at 27/29 of the leading speed
        has no line where windows hold whole revolutions of the leading shaft. Under Hann's window each must
        be more than 2 / turns from any other that the signal has, and from 0.

    Raises
    ------
    CouplingError
        Where the windows are longer than the record, or an order is beyond half the samples of a turn.
    """
    if any(not 0.0 < order < 0.5 * turned.per_turn for order in follow):
        raise CouplingError(f"orders {list(follow)}; expected them above 0 and below {0.5 * turned.per_turn:g}")
    total = turned.turns.size // turned.per_turn
    if not (1 <= turns <= total and step >= 1):
        raise CouplingError(
            f"windows of {turns} turns, {step} apart, of a record of {total}; expected 1 or more of each"
        )
    starts = np.arange(0, total - turns + 1, step) * turned.per_turn
    length = turns * turned.per_turn
    interval = 1.0 / turned.per_turn
    stretches = [turned.values[s : s + length] for s in starts]
    spectra = [amplitude_spectrum(stretch, interval, window) for stretch in stretches]
    followed = np.abs([lines_at(stretch, interval, np.array(follow), window) for stretch in stretches])
    # A window's last sample closes it but for one interval.
    spans = [turned.times[s + length - 1] - turned.times[s] for s in starts]
    return OrderMap(
        times=np.array([turned.times[s + length // 2] for s in starts]),
        speeds=(turns - 1.0 / turned.per_turn) / np.array(spans),
        orders=spectra[0].frequencies,
        amplitude=np.array([spectrum.amplitude for spectrum in spectra]),
        window=window,
        followed={order: followed[:, number] for number, order in enumerate(follow)},
    )
