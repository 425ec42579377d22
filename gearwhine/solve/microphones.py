"""Sound pressure over time at microphones: the bearings' forces through the housing and the air, filtered as a whole.

Housing and air are linear and do not change with time, also in a run-up. With the transfer T(ω) from the rates of the
modes' coordinates to the sound pressure and the housing's stiffness K, damping C and forces D_b f_b by its bearings,

``p(ω) = T(ω) i ω (K - ω² + i ω C)⁻¹ Σ_b (-D_b f_b(ω))``

line by line of the record's Fourier transform. T varies slowly over frequency once the delay of the air is taken out of
it: it is solved at some frequencies and interpolated by cubic splines, whose error is measured between them. The
resonances of the housing are not interpolated.

A record that does not repeat begins and ends abruptly, which would be heard as clicks. Its forces lose their linear
trend and, like the pressure, fade in and out over `FADE`; silence is put behind them, in which the housing rings down.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline
from scipy.signal import detrend

from coupling import CoupledMachine
from coupling.signals.transfer_paths import housing_paths
from gearwhine.progress import Progress, in_order, silent
from housing.acoustics.radiation import HousingRadiation

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_TWO_PI = 2.0 * np.pi
_POINTS = 41  # frequencies at which the transfer is solved
_CHECKS = (0.26, 0.51, 0.74, 0.97)  # of the range: where the spline is held against a solution
_BLOCK = 2048  # lines at once
FADE = 0.02
"""Time over which a record that does not repeat fades in and out [s]."""

_LONGEST_FADE = 0.25  # of the record
_DECAY = 1.0  # [s] of silence behind a record that does not repeat: a mode of 100 Hz and 1 % decays to a part in 500


@dataclass(frozen=True)
class MicrophoneTransfer:
    """Transfer from the rates of the modes' coordinates to the sound pressure at microphones.

    Attributes
    ----------
    frequencies : ndarray, shape (f,)
        At which it was solved [Hz].
    values : ndarray of complex, shape (f, n_microphones, n_modes)
        Without the delay of the air [Pa per rate].
    delays : ndarray, shape (n_microphones,)
        From the middle of the housing [s].
    error : float
        Largest difference between the spline and a solution at four frequencies between, relative to the largest
        transfer of the microphone there.
    """

    frequencies: FloatArray
    values: ComplexArray
    delays: FloatArray
    error: float

    def at(self, frequencies: FloatArray) -> ComplexArray:
        """Transfer at some frequencies [Hz], shape (l, n_microphones, n_modes)."""
        smooth = CubicSpline(self.frequencies, self.values, axis=0)(frequencies)
        return np.asarray(smooth * np.exp(-1j * _TWO_PI * np.multiply.outer(frequencies, self.delays))[..., None])


def solve_transfer(
    radiation: HousingRadiation,
    places: FloatArray,
    lowest: float,
    highest: float,
    progress: Progress = silent,
) -> MicrophoneTransfer:
    """Solve the transfer to microphones between two frequencies [Hz].

    Parameters
    ----------
    radiation : HousingRadiation
        By boundary elements, or Rayleigh's integral of one face.
    places : ndarray, shape (n_microphones, 3)
        [m]
    lowest, highest : float
    progress : callable
    """
    middle = radiation.elements[0].surface.points.mean(axis=0)
    delays = np.linalg.norm(places - middle, axis=1) / radiation.medium.speed_of_sound
    unit = np.eye(radiation.modal[0].shape[1])
    points = np.linspace(lowest, highest, _POINTS)
    checks = lowest + np.array(_CHECKS) * (highest - lowest)

    def solve(hertz: float) -> ComplexArray:
        # One field of all modes' unit rates, each a motion of its own.
        field = radiation.solve(hertz, unit).fields[0]
        pressure = field.pressure_at(places)  # type: ignore[attr-defined]
        return np.asarray(pressure * np.exp(1j * _TWO_PI * hertz * delays)[:, None])

    wanted = [*points.tolist(), *checks.tolist()]
    solved = in_order(solve, wanted, "sound at the microphones over frequency", progress)
    found = MicrophoneTransfer(points, np.array(solved[:_POINTS]), delays, 0.0)
    smooth = CubicSpline(points, found.values, axis=0)(checks)
    exact = np.array(solved[_POINTS:])
    error = np.abs(smooth - exact).max(axis=2) / np.maximum(np.abs(exact).max(axis=2), np.finfo(float).tiny)
    return MicrophoneTransfer(points, found.values, delays, float(error.max()))


@dataclass(frozen=True)
class MicrophoneHistories:
    """Sound pressure over time.

    Attributes
    ----------
    times : ndarray, shape (s,)
        [s].
    pressure : ndarray, shape (n_microphones, s)
        [Pa].
    error : float
        Of the transfer's interpolation, see :class:`MicrophoneTransfer`.
    """

    times: FloatArray
    pressure: FloatArray
    error: float


def microphone_histories(
    machine: CoupledMachine,
    transfer: MicrophoneTransfer,
    times: FloatArray,
    forces: Mapping[str, FloatArray],
    *,
    repeats: bool,
) -> MicrophoneHistories:
    """Filter the forces of the bearings through the housing and the air.

    Parameters
    ----------
    machine : CoupledMachine
        With a housing.
    transfer : MicrophoneTransfer
    times : ndarray, shape (s,)
        Evenly spaced [s].
    forces : mapping of str to ndarray, shape (s, d)
        Of each bearing over time [N, N m].
    repeats : bool
        Whether the record holds whole periods; else it fades in and out, and silence is put behind it, so that its end
        does not sound at its beginning.
    """
    interval = float(times[-1] - times[0]) / (len(times) - 1)
    weights = np.ones(len(times)) if repeats else fading_weights(len(times), interval)
    length = len(times) if repeats else len(times) + int(np.ceil(_DECAY / interval))
    lines = np.asarray(np.fft.rfftfreq(length, interval), dtype=np.float64)
    kept = np.flatnonzero((lines >= transfer.frequencies[0]) & (lines <= transfer.frequencies[-1]))
    order: Literal["constant", "linear"] = "constant" if repeats else "linear"
    spectra = {
        name: np.fft.rfft(weights[:, None] * detrend(force, axis=0, type=order), length, axis=0)
        for name, force in forces.items()
    }
    sound = np.zeros((len(lines), len(transfer.delays)), dtype=np.complex128)
    for start in range(0, len(kept), _BLOCK):
        some = kept[start : start + _BLOCK]
        omega = np.asarray(_TWO_PI * lines[some], dtype=np.float64)
        paths = housing_paths(machine, omega, {name: values[some] for name, values in spectra.items()})
        rates = paths.acceleration.sum(axis=1) / (1j * omega[:, None])
        sound[some] = (transfer.at(lines[some]) @ rates[..., None])[..., 0]
    pressure = np.fft.irfft(sound, length, axis=0)[: len(times)] * weights[:, None]
    return MicrophoneHistories(np.asarray(times), np.ascontiguousarray(pressure.T), transfer.error)


def fading_weights(count: int, interval: float) -> FloatArray:
    """Weights of samples that fade in and out by half a period of a cosine each, shape (count,).

    Parameters
    ----------
    count : int
    interval : float
        Between samples [s].
    """
    length = max(min(round(FADE / interval), int(_LONGEST_FADE * count)), 1)
    rising = np.sin(0.5 * np.pi * np.arange(length) / length) ** 2
    weights = np.ones(count)
    weights[:length] = rising
    weights[count - length :] = rising[::-1]
    return weights
