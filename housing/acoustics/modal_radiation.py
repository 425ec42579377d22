"""Radiation resistance of a housing's modes over frequency, and their sound pressure at points: solved once, on file.

The radiation resistance R(f) and the pressure at points per unit rate of each mode belong to the housing and the air
alone. They are solved at evenly spaced frequencies, the pressures without the delay of the air, and interpolated by
cubic splines. Resonances of the housing are not in them: they vary with the size of the housing over the wavelength.

The power ½ q̇ᴴ R q̇ of rates q̇ comes with an estimate of its error: its difference from that of the splines through
every second frequency. Where R is smooth their error is 16 times as large, so that the estimate is on the safe side; on
a gearbox the error was a twentieth of it. Where the estimate is large, as for weak radiators at low frequencies, whose
R rises with a high power of frequency, the field is to be solved.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from gearwhine.housing.acoustics.boundary_elements import surface_product
from gearwhine.housing.acoustics.radiation import EquivalentField, HousingRadiation
from gearwhine.housing.errors import HousingError
from gearwhine.housing.storage.netcdf import LabelledArray
from gearwhine.numerics.arrays import ComplexArray, FloatArray


class SolvedAt(NamedTuple):
    """Radiation at one frequency; :class:`ModalRadiation` has it at all."""

    resistance: FloatArray
    surface_resistance: FloatArray
    surface_reactance: FloatArray
    pressure: ComplexArray
    interior_residual: float
    source_error: float
    source_rms: float
    source_error_at_points: FloatArray


Solve = Callable[[float], SolvedAt]
Each = Callable[[Solve, Sequence[float]], Iterable[SolvedAt]]

_TWO_PI = 2.0 * np.pi
POINTS = 41
"""Frequencies at which the matrices are solved; every second one is the coarser table of the estimate."""
ARRAYS = (
    "radiation_frequency",
    "radiation_resistance",
    "surface_resistance",
    "surface_reactance",
    "radiation_interior_residual",
    "radiation_source_error",
    "radiation_source_rms",
    "point_pressure",
    "point_delay",
    "point_source_error",
)
"""Names of the labelled arrays of a table; one without points has not the last three."""

_AXIS = "radiation_frequency"
_MATRIX = (_AXIS, "coordinate", "other_coordinate")


@dataclass(frozen=True)
class ModalRadiation:
    """Radiation of a housing's modes, for unit rates of their coordinates, at some frequencies.

    Attributes
    ----------
    frequencies : ndarray, shape (f,)
        Frequencies, evenly spaced [Hz].
    resistance : ndarray, shape (f, n, n)
        Radiation resistance R from the far field, symmetric: rates q̇ have the power ½ q̇ᴴ R q̇ [W s²/(kg m²)].
    surface_resistance : ndarray, shape (f, n, n)
        Radiation resistance from the intensity on the surface.
    surface_reactance : ndarray, shape (f, n, n)
        Imaginary part of ∫ vᵢ pⱼ dS, symmetric: power that the modes exchange, and that none of them radiates.
    pressure : ndarray of complex, shape (f, m, n)
        Pressure at m points, times exp(+i ω delay) [Pa per unit rate].
    delays : ndarray, shape (m,)
        Delays of the air, from the middle of the housing [s].
    interior_residual : ndarray, shape (f,)
        Largest pressure inside, see :attr:`gearwhine.housing.acoustics.boundary_elements.SoundField.interior_residual`.
    source_error, source_rms : ndarray, shape (f,)
        Largest error of known sources inside and its root mean square over the vertices, see
        :class:`gearwhine.housing.acoustics.known_source.SourceError`.
    point_source_error : ndarray, shape (f, m)
        Error of known sources at the points, relative to their amplitude there.
    """

    frequencies: FloatArray
    resistance: FloatArray
    surface_resistance: FloatArray
    surface_reactance: FloatArray
    pressure: ComplexArray
    delays: FloatArray
    interior_residual: FloatArray
    source_error: FloatArray
    source_rms: FloatArray
    point_source_error: FloatArray

    def __post_init__(self) -> None:
        """Refuse frequencies of which every second one does not reach both ends."""
        if len(self.frequencies) < 5 or len(self.frequencies) % 2 == 0:
            raise HousingError(f"radiation at {len(self.frequencies)} frequencies; expected an odd number from 5 on")

    @classmethod
    def solve(
        cls,
        radiation: HousingRadiation,
        places: FloatArray,
        lowest: float,
        highest: float,
        *,
        points: int = POINTS,
        each: Each = map,
    ) -> "ModalRadiation":
        """Solve between two frequencies [Hz].

        Parameters
        ----------
        radiation : HousingRadiation
            Radiation by any method; one with pressures where there are places.
        places : ndarray, shape (m, 3)
            Places in the air [m].
        lowest, highest : float
        points : int
            Number of frequencies, odd.
        each : callable
            A map of a function over the frequencies, in order, such as one by several threads.
        """
        unit = np.eye(radiation.modal[0].shape[1])
        middle = radiation.elements[0].surface.points.mean(axis=0)
        delays = np.linalg.norm(places - middle, axis=1) / radiation.medium.speed_of_sound

        def at(hertz: float) -> SolvedAt:
            sound = radiation.solve(hertz, unit)
            pressure, off = np.zeros((0, len(unit)), dtype=np.complex128), np.zeros(0)
            if len(places):
                field = sound.fields[0]
                assert not isinstance(field, EquivalentField)
                delayed = field.pressure_at(places)  # type: ignore[attr-defined]
                pressure = np.asarray(delayed * np.exp(1j * _TWO_PI * hertz * delays)[:, None])
                off = sound.source_error_at(places)
            product = np.asarray(
                sum(surface_product(field.surface, field.velocity, field.pressure_at_corners) for field in sound.fields)
            )
            # Symmetric by reciprocity, but for the discretisation.
            impedance = 0.5 * (product + product.T)
            return SolvedAt(
                sound.resistance,
                impedance.real,
                impedance.imag,
                pressure,
                sound.interior_residual,
                sound.source_error.largest,
                sound.source_error.rms,
                off,
            )

        frequencies = np.linspace(lowest, highest, points)
        of_all = (np.array(values) for values in zip(*each(at, frequencies.tolist()), strict=True))
        resistance, surface, reactance, pressure, *proofs = of_all
        return cls(frequencies, resistance, surface, reactance, pressure, delays, *proofs)

    @cached_property
    def _powers(self) -> tuple[CubicSpline, CubicSpline, CubicSpline]:
        return (
            CubicSpline(self.frequencies, self.resistance, axis=0),
            CubicSpline(self.frequencies[::2], self.resistance[::2], axis=0),
            CubicSpline(self.frequencies, self.surface_resistance, axis=0),
        )

    @cached_property
    def _reactance(self) -> CubicSpline:
        return CubicSpline(self.frequencies, self.surface_reactance, axis=0)

    @cached_property
    def _pressures(self) -> "tuple[CubicSpline[np.complex128], CubicSpline[np.complex128]]":
        return (
            CubicSpline(self.frequencies, self.pressure, axis=0),
            CubicSpline(self.frequencies[::2], self.pressure[::2], axis=0),
        )

    def holds(self, frequency_hz: float) -> bool:
        """Whether a frequency lies within the table."""
        rounding = 1e-9 * self.frequencies[-1]
        return bool(self.frequencies[0] - rounding <= frequency_hz <= self.frequencies[-1] + rounding)

    def around(self, frequency_hz: float, values: FloatArray) -> float:
        """Largest of some values at the two frequencies of the table around a frequency."""
        above = min(int(np.searchsorted(self.frequencies, frequency_hz)), len(self.frequencies) - 1)
        return float(values[max(above - 1, 0) : above + 1].max(initial=0.0))

    def power(self, frequency_hz: float, rates: ComplexArray) -> tuple[float, float, float]:
        """Sound power of rates q̇, shape (n,): from the far field and the surface [W], and its relative error.

        Raises
        ------
        HousingError
            Where the table does not reach the frequency.
        """
        self._require_held(frequency_hz)
        fine, coarse, surface = (
            float(0.5 * (rates.conj() @ spline(frequency_hz) @ rates).real) for spline in self._powers
        )
        return fine, surface, abs(coarse - fine) / fine if fine > 0.0 else np.inf

    def by_mode(self, frequency_hz: float, rates: ComplexArray) -> FloatArray:
        """Part of each mode in the power of rates q̇ on the surface [W], shape (n,): ½ Re q̇̄ᵢ Σⱼ (R + iX)ᵢⱼ q̇ⱼ.

        Raises
        ------
        HousingError
            Where the table does not reach the frequency.
        """
        self._require_held(frequency_hz)
        impedance = self._powers[2](frequency_hz) + 1j * self._reactance(frequency_hz)
        return np.asarray(0.5 * (rates.conj() * (impedance @ rates)).real)

    def _require_held(self, frequency_hz: float) -> None:
        if not self.holds(frequency_hz):
            raise HousingError(
                f"radiation at {frequency_hz:.6g} Hz; expected a frequency from {self.frequencies[0]:.6g} to "
                f"{self.frequencies[-1]:.6g} Hz"
            )

    def pressure_at(self, frequencies: FloatArray) -> ComplexArray:
        """Sound pressure at the points for unit rates [Pa], shape (l, m, n)."""
        delay = np.exp(-1j * _TWO_PI * np.multiply.outer(frequencies, self.delays))
        return np.asarray(self._pressures[0](frequencies) * delay[..., None])

    @cached_property
    def pressure_error(self) -> float:
        """Estimated relative error of the interpolated pressure, of the point and the frequency where it is largest.

        Halfway between the frequencies, relative to the point's largest pressure by any mode there; 0 without points.
        """
        if not len(self.delays):
            return 0.0
        middles = 0.5 * (self.frequencies[1:] + self.frequencies[:-1])
        fine, coarse = (spline(middles) for spline in self._pressures)
        size = np.maximum(np.abs(fine).max(axis=2), np.finfo(float).tiny)
        # A sixteenth of the difference, since the coarser spline has sixteen times the error.
        return float((np.abs(fine - coarse).max(axis=2) / size).max() / 16.0)

    def arrays(self) -> dict[str, LabelledArray]:
        """Return the table as labelled arrays."""
        parts = np.stack([self.pressure.real, self.pressure.imag], axis=-1)
        named = {
            "radiation_frequency": LabelledArray((_AXIS,), self.frequencies, "Hz", "frequency of the radiation"),
            "radiation_resistance": LabelledArray(
                _MATRIX, self.resistance, "W s2 kg-1 m-2", "radiation resistance of the modes, from the far field"
            ),
            "surface_resistance": LabelledArray(
                _MATRIX, self.surface_resistance, "W s2 kg-1 m-2", "radiation resistance of the modes, on the surface"
            ),
            "surface_reactance": LabelledArray(
                _MATRIX, self.surface_reactance, "W s2 kg-1 m-2", "radiation reactance of the modes, on the surface"
            ),
            "radiation_interior_residual": LabelledArray(
                (_AXIS,), self.interior_residual, "1", "pressure inside relative to that on the surface"
            ),
            "radiation_source_error": LabelledArray(
                (_AXIS,), self.source_error, "1", "largest error of the pressure of a known source inside"
            ),
            "radiation_source_rms": LabelledArray(
                (_AXIS,), self.source_rms, "1", "root mean square error of the pressure of a known source inside"
            ),
        }
        if len(self.delays):
            named |= {
                "point_pressure": LabelledArray(
                    (_AXIS, "point", "coordinate", "part"),
                    parts,
                    "Pa s kg-0.5 m-1",
                    "sound pressure at the points without the delay of the air",
                ),
                "point_delay": LabelledArray(("point",), self.delays, "s", "delay of the air to the points"),
                "point_source_error": LabelledArray(
                    (_AXIS, "point"), self.point_source_error, "1", "error of a known source's pressure at the points"
                ),
            }
        return named

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, LabelledArray]) -> "ModalRadiation":
        """Return the table of labelled arrays, equal bit for bit.

        Raises
        ------
        KeyError
            Where one is missing.
        """
        resistance = arrays["radiation_resistance"].values
        pressure = np.zeros((len(resistance), 0, resistance.shape[1]), dtype=np.complex128)
        delays, off = np.zeros(0), np.zeros((len(resistance), 0))
        if "point_delay" in arrays:
            parts, delays = arrays["point_pressure"].values, arrays["point_delay"].values
            pressure = parts[..., 0] + 1j * parts[..., 1]
            off = arrays["point_source_error"].values
        return cls(
            arrays["radiation_frequency"].values,
            resistance,
            arrays["surface_resistance"].values,
            arrays["surface_reactance"].values,
            pressure,
            delays,
            arrays["radiation_interior_residual"].values,
            arrays["radiation_source_error"].values,
            arrays["radiation_source_rms"].values,
            off,
        )
