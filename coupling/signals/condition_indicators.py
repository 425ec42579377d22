r"""Condition indicators of gears and rolling bearings from a signal: time-synchronous average, moments, envelopes.

The synchronous average of a shaft keeps what repeats with its turns. Of its lines the *regular* ones are the mesh
harmonics with their first-order sidebands; the *residual* signal is the average without the mesh harmonics and the
shaft's own first two orders, the *difference* signal also without the sidebands (Stewart 1977; Zakrajsek, Townsend and
Decker, NASA TM-105950, 1993). Of the difference signal d with N samples and the mean square v = (1/N) Σ (d - d̄)²,

    FM4 = (1/N) Σ (d - d̄)⁴ / v²,   M6A = (1/N) Σ (d - d̄)⁶ / v³,   M8A = (1/N) Σ (d - d̄)⁸ / v⁴,

3, 15 and 105 of Gaussian noise. FM0 is the peak to peak of the average over the sum of the amplitudes of its mesh
harmonics. NA4 is the fourth moment of the residual signal over the square of its mean square averaged over the records
up to now, so that it rises with the damage and does not fall again as FM4 does. The energy ratio is the rms of the
difference signal over that of the regular one, the sideband index the mean amplitude of the first-order sidebands of
the mesh frequency itself, and the sideband level factor their sum over the rms of the average (Večeř, Kreidl and Šmíd,
Acta Polytechnica 45(6), 2005).

A healthy gear without any errors has no residual: indicators of it are None.

Spectral kurtosis (Antoni 2006) of the short-time spectrum X(t, f) is ``⟨|X|⁴⟩ / ⟨|X|²⟩² - 2``: 0 of Gaussian noise,
-1 of a tone, high where bursts are. The envelope spectrum is that of the squared magnitude of the analytic signal in a
band.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearwhine.coupling.errors import CouplingError
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, Number, attribute_findings, refuse

_NOTHING = 1e-9
"""Rms of a residual signal over that of the average up to which it is rounding."""
_SHAFT_ORDERS = (1, 2)
_PADDING = 4  # length of a record with the zeros after it, over its own


def synchronous_average(samples: FloatArray, samples_per_turn: int) -> FloatArray:
    """Average of a signal over the whole turns of a shaft, at the same angles, shape (samples_per_turn,).

    Parameters
    ----------
    samples : ndarray, shape (n,)
        Signal at equal steps of the shaft's angle; what is over a whole number of turns is left out.
    samples_per_turn : int

    Raises
    ------
    CouplingError
        Where there is no whole turn.
    """
    turns = len(samples) // samples_per_turn if samples_per_turn > 0 else 0
    if turns < 1:
        raise CouplingError(
            f"synchronous average: {len(samples)} samples, {samples_per_turn} a turn; expected a whole turn or more"
        )
    return np.asarray(np.reshape(samples[: turns * samples_per_turn], (turns, samples_per_turn)).mean(axis=0))


@dataclass(frozen=True, eq=False)
class SynchronousAverage:
    """Time-synchronous average of a shaft with a gear, and the indicators of its teeth.

    Attributes
    ----------
    samples : ndarray, shape (n,)
        Average over one turn of the shaft.
    teeth : int
        Number of teeth, the order of the mesh frequency.
    harmonics : int
        Number of mesh harmonics that are taken, as far as the samples hold them.
    others : tuple of int
        Numbers of teeth of further gears on the shaft, whose mesh harmonics and sidebands are no residual either.

    Raises
    ------
    CouplingError
    """

    samples: FloatArray
    teeth: int
    harmonics: int = 10
    others: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        """Check the numbers, and that the samples hold the mesh frequency with its sidebands."""
        part = ("synchronous average", "")
        rules = {"teeth": Number(at_least=3, whole=True), "harmonics": Number(at_least=1, whole=True)}
        findings = list(attribute_findings(part, self, **rules))
        values = np.asarray(self.samples, dtype=np.float64)
        if values.ndim != 1 or not np.all(np.isfinite(values)):
            findings.append(Finding(part, "samples", None, "finite numbers in one row"))
        elif not findings and len(values) <= 2 * (self.teeth + 1):
            expected = f"more than {2 * (self.teeth + 1)} samples a turn, for the mesh frequency and its sidebands"
            findings.append(Finding(part, "samples", len(values), expected))
        refuse(findings, CouplingError)
        object.__setattr__(self, "samples", values.copy())

    def _harmonics_of(self, teeth: int) -> list[int]:
        """Orders of the mesh harmonics of a gear below half the sampling order."""
        highest = (len(self.samples) - 1) // 2 - 1
        return [h * teeth for h in range(1, self.harmonics + 1) if h * teeth <= highest]

    @cached_property
    def _mesh_orders(self) -> list[int]:
        return self._harmonics_of(self.teeth)

    @cached_property
    def _left_out(self) -> list[int]:
        """Orders without which the average is the residual signal: of the shaft, and of all meshes on it."""
        of_others = [order for teeth in self.others for order in self._harmonics_of(teeth)]
        return [*_SHAFT_ORDERS, *self._mesh_orders, *of_others]

    @cached_property
    def _spectrum(self) -> FloatArray:
        return np.asarray(np.fft.rfft(self.samples))

    def amplitude(self, order: int) -> float:
        """Peak amplitude of an order of the shaft."""
        return float(2.0 * np.abs(self._spectrum[order]) / len(self.samples))

    def _without(self, orders: Sequence[int]) -> FloatArray:
        spectrum = self._spectrum.copy()
        spectrum[[0, *orders]] = 0.0
        return np.asarray(np.fft.irfft(spectrum, n=len(self.samples)))

    @cached_property
    def residual(self) -> FloatArray:
        """Average without its mean, the mesh harmonics and the first two orders of the shaft."""
        return self._without(self._left_out)

    @cached_property
    def difference(self) -> FloatArray:
        """Residual signal without the first-order sidebands of the mesh harmonics."""
        return self._without([*self._left_out, *_sidebands(self._left_out[len(_SHAFT_ORDERS) :])])

    @cached_property
    def regular(self) -> FloatArray:
        """Mesh harmonics with their first-order sidebands."""
        return np.asarray(self.samples - self.samples.mean() - self.difference - self._shaft_orders)

    @property
    def _shaft_orders(self) -> FloatArray:
        spectrum = np.zeros_like(self._spectrum)
        spectrum[list(_SHAFT_ORDERS)] = self._spectrum[list(_SHAFT_ORDERS)]
        return np.asarray(np.fft.irfft(spectrum, n=len(self.samples)))

    def is_nothing(self, part: FloatArray) -> bool:
        """Whether a part of the average is rounding of it."""
        return bool(np.std(part) <= _NOTHING * np.std(self.samples)) or not np.any(part)

    def _moment(self, power: int) -> float | None:
        """Moment of the difference signal over the same power of its standard deviation; None where there is none."""
        if self.is_nothing(self.difference):
            return None
        return float(np.mean(self.difference**power) / np.mean(self.difference**2) ** (power // 2))

    @property
    def fm0(self) -> float | None:
        """Peak to peak of the average over the sum of the amplitudes of the mesh harmonics; None without these."""
        total = sum(self.amplitude(order) for order in self._mesh_orders)
        return float(np.ptp(self.samples)) / total if total > _NOTHING * np.std(self.samples) else None

    @property
    def fm4(self) -> float | None:
        """Kurtosis of the difference signal, 3 of Gaussian noise; None where there is none."""
        return self._moment(4)

    @property
    def m6a(self) -> float | None:
        """Sixth moment of the difference signal, 15 of Gaussian noise; None where there is none."""
        return self._moment(6)

    @property
    def m8a(self) -> float | None:
        """Eighth moment of the difference signal, 105 of Gaussian noise; None where there is none."""
        return self._moment(8)

    @property
    def energy_ratio(self) -> float | None:
        """Rms of the difference signal over that of the regular one; None without a regular one."""
        if self.is_nothing(self.regular):
            return None
        return float(np.std(self.difference) / np.std(self.regular))

    @property
    def sideband_index(self) -> float:
        """Mean amplitude of the first-order sidebands of the mesh frequency."""
        return 0.5 * self._first_sidebands

    @property
    def _first_sidebands(self) -> float:
        """Sum of the amplitudes of the first-order sidebands of the mesh frequency."""
        return sum(self.amplitude(self.teeth + side) for side in (-1, 1))

    @property
    def sideband_level_factor(self) -> float | None:
        """Sum of the amplitudes of the first-order sidebands of the mesh frequency over the average's rms."""
        rms = float(np.std(self.samples))
        return self._first_sidebands / rms if rms > 0.0 else None


def _sidebands(orders: Sequence[int]) -> list[int]:
    """First-order sidebands of mesh orders."""
    return [order + side for order in orders for side in (-1, 1)]


def na4(averages: Sequence[SynchronousAverage]) -> float | None:
    """NA4 of the last of some averages of one gear, in the order in which they were recorded; None where there is none.

    The fourth moment of the last residual signal over the square of the mean square of all of them.

    Raises
    ------
    CouplingError
        Where there are none.
    """
    if not averages:
        raise CouplingError("NA4: expected one synchronous average or more")
    last = averages[-1]
    mean_square = float(np.mean([np.mean(one.residual**2) for one in averages]))
    if last.is_nothing(last.residual) or mean_square == 0.0:
        return None
    return float(np.mean(last.residual**4)) / mean_square**2


def spectral_kurtosis(samples: FloatArray, interval: float, window: int) -> tuple[FloatArray, FloatArray]:
    """Spectral kurtosis of a signal: frequencies [Hz] and kurtosis, shape (f,) both.

    Parameters
    ----------
    samples : ndarray, shape (n,)
    interval : float
        Time between samples [s].
    window : int
        Samples of a window, short against the distance of the bursts; neighbouring windows overlap by three quarters.

    Raises
    ------
    CouplingError
        Where there are not eight windows.
    """
    if not (interval > 0.0 and 8 <= window <= len(samples) // 3):
        raise CouplingError(
            f"spectral kurtosis: {len(samples)} samples of {interval:g} s in windows of {window}; expected windows of "
            "8 samples or more, and a signal three times as long"
        )
    parts = np.lib.stride_tricks.sliding_window_view(samples, window)[:: window // 4]
    power = np.abs(np.fft.rfft(np.hanning(window) * parts)) ** 2
    mean = power.mean(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        kurtosis = np.mean(power**2, axis=0) / mean**2 - 2.0
    frequencies: FloatArray = np.fft.rfftfreq(window, interval).astype(np.float64)
    return frequencies, np.asarray(np.where(mean > 0.0, kurtosis, -1.0))


def envelope_spectrum(
    samples: FloatArray, interval: float, band: tuple[float, float], *, hann: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Envelope spectrum of a signal in a band: frequencies [Hz], amplitudes of the squared envelope, shape (f,) both.

    The signal is taken as periodic over its record. The line at 0 is the mean of the squared envelope, twice the mean
    square of the signal in a band above 0.

    Parameters
    ----------
    samples : ndarray, shape (n,)
    interval : float
        Time between samples [s].
    band : tuple of float
        Ends of the band [Hz].
    hann : bool
        Take the varying part under Hann's window, at four times as many frequencies: for a record that holds no whole
        periods, whose tones then have their height within 1 %.

    Raises
    ------
    CouplingError
        Where the band is none below half the sampling rate.
    """
    low, high = band
    if not (interval > 0.0 and 0.0 <= low < high <= 0.5 / interval):
        raise CouplingError(
            f"envelope spectrum: a band of {low:g} to {high:g} Hz; expected one below half the sampling rate"
        )
    count = len(samples)
    lines = np.fft.fft(np.asarray(samples, dtype=np.float64))
    frequencies = np.fft.fftfreq(count, interval)
    analytic = np.fft.ifft(np.where((frequencies >= low) & (frequencies <= high), 2.0 * lines, 0.0))
    if low == 0.0:
        analytic -= lines[0] / count  # a constant is its own analytic signal
    squared = np.abs(analytic) ** 2
    mean, padded = float(squared.mean()), count
    varying = squared - mean
    if hann:
        padded = _PADDING * count
        varying = varying * (1.0 - np.cos(2.0 * np.pi * np.arange(count) / count))
    spectrum = 2.0 * np.abs(np.fft.rfft(varying, n=padded)) / count
    spectrum[0] = mean
    return np.asarray(np.fft.rfftfreq(padded, interval)), np.asarray(spectrum)
