"""Sound pressure over time at microphones: the bearings' forces through the housing and the air, filtered as a whole.

Housing and air are linear and do not change with time, also in a run-up. With the transfer T(ω) from the rates of the
modes' coordinates to the sound pressure and the housing's stiffness K, damping C and forces D_b f_b by its bearings,

``p(ω) = T(ω) i ω (K - ω² + i ω C)⁻¹ Σ_b (-D_b f_b(ω))``

line by line of the record's Fourier transform. T is interpolated over frequency, see
:mod:`gearwhine.housing.acoustics.modal_radiation`; the resonances of the housing are not.

A record that does not repeat begins and ends abruptly, which would be heard as clicks. Its forces lose their linear
trend and, like the pressure, fade in and out over `FADE`; silence is put behind them, in which the housing rings down.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import polynomial

from gearwhine.coupling import CoupledMachine
from gearwhine.coupling.signals.transfer_paths import housing_paths
from gearwhine.housing.acoustics.modal_radiation import ModalRadiation
from gearwhine.numerics.arrays import FloatArray

_TWO_PI = 2.0 * np.pi
_BLOCK = 2048  # lines at once
FADE = 0.02
"""Time over which a record that does not repeat fades in and out [s]."""

_LONGEST_FADE = 0.25  # longest fade as a part of the record
_DECAY = 1.0  # silence behind a record that does not repeat [s]: a mode of 100 Hz and 1 % decays to a part in 500


@dataclass(frozen=True)
class MicrophoneHistories:
    """Sound pressure over time.

    Attributes
    ----------
    times : ndarray, shape (s,)
        Times [s].
    pressure : ndarray, shape (n_microphones, s)
        Sound pressure [Pa].
    error : float
        Error of the transfer's interpolation, see
        :attr:`gearwhine.housing.acoustics.modal_radiation.ModalRadiation.pressure_error`.
    source_errors : ndarray, shape (n_microphones,)
        Largest error of known sources over the transfer's frequencies, see
        :attr:`gearwhine.housing.acoustics.modal_radiation.ModalRadiation.point_source_error`.
    source_frequency_hz : float
        Frequency of the largest of these errors [Hz].
    """

    times: FloatArray
    pressure: FloatArray
    error: float
    source_errors: FloatArray
    source_frequency_hz: float


def microphone_histories(
    machine: CoupledMachine,
    transfer: ModalRadiation,
    times: FloatArray,
    forces: Mapping[str, FloatArray],
    *,
    repeats: bool,
) -> MicrophoneHistories:
    """Filter the forces of the bearings through the housing and the air.

    Parameters
    ----------
    machine : CoupledMachine
        Machine with a housing.
    transfer : ModalRadiation
        Radiation with the microphones as its points.
    times : ndarray, shape (s,)
        Evenly spaced times [s].
    forces : mapping of str to ndarray, shape (s, d)
        Forces and moments of each bearing over time [N, N m].
    repeats : bool
        Whether the record holds whole periods; else it fades in and out, and silence is put behind it, so that its end
        does not sound at its beginning.
    """
    interval = float(times[-1] - times[0]) / (len(times) - 1)
    weights = np.ones(len(times)) if repeats else fading_weights(len(times), interval)
    length = len(times) if repeats else len(times) + int(np.ceil(_DECAY / interval))
    lines = np.asarray(np.fft.rfftfreq(length, interval), dtype=np.float64)
    covered = np.flatnonzero((lines >= transfer.frequencies[0]) & (lines <= transfer.frequencies[-1]))
    degree = 0 if repeats else 1
    spectra = {
        name: np.fft.rfft(weights[:, None] * _less_its_trend(force, degree), length, axis=0)
        for name, force in forces.items()
    }
    sound = np.zeros((len(lines), len(transfer.delays)), dtype=np.complex128)
    for start in range(0, len(covered), _BLOCK):
        block = covered[start : start + _BLOCK]
        omega = np.asarray(_TWO_PI * lines[block], dtype=np.float64)
        paths = housing_paths(machine, omega, {name: values[block] for name, values in spectra.items()})
        rates = paths.acceleration.sum(axis=1) / (1j * omega[:, None])
        sound[block] = (transfer.pressure_at(lines[block]) @ rates[..., None])[..., 0]
    pressure = np.fft.irfft(sound, length, axis=0)[: len(times)] * weights[:, None]
    return MicrophoneHistories(
        np.asarray(times),
        np.ascontiguousarray(pressure.T),
        transfer.pressure_error,
        transfer.point_source_error.max(axis=0),
        float(transfer.frequencies[transfer.point_source_error.max(axis=1).argmax()]),
    )


def fading_weights(count: int, interval: float) -> FloatArray:
    """Weights of samples that fade in and out by half a period of a cosine each, shape (count,).

    Parameters
    ----------
    count : int
    interval : float
        Time between samples [s].
    """
    length = max(min(round(FADE / interval), int(_LONGEST_FADE * count)), 1)
    rising = np.sin(0.5 * np.pi * np.arange(length) / length) ** 2
    weights = np.ones(count)
    weights[:length] = rising
    weights[count - length :] = rising[::-1]
    return weights


def _less_its_trend(record: FloatArray, degree: int) -> FloatArray:
    """Subtract the polynomial that fits each signal of a record (s, k) best."""
    places = np.linspace(-1.0, 1.0, len(record))
    trend = polynomial.polyval(places, polynomial.polyfit(places, record, degree))
    return np.asarray(record - trend.T, dtype=np.float64)
