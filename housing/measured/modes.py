"""Measured modes of a modal test: frequencies, and damping and shapes where they were measured."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.errors import HousingError
from housing.measured.geometry import MeasuredGeometry

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class MeasuredModes:
    """The modes of a modal test, ascending in frequency.

    Attributes
    ----------
    frequencies : ndarray, shape (n_modes,)
        Undamped natural frequencies [rad/s].
    damping_ratios : ndarray, shape (n_modes,), or None
        Of critical damping; None where not known.
    shapes : ndarray of complex, shape (n_modes, n_dofs), or None
        At the geometry's degrees of freedom, to an unknown scale; NaN where a degree of freedom was not measured.
    geometry : MeasuredGeometry or None
        Of the shapes; None where there are none.

    Raises
    ------
    HousingError
        Where the frequencies are not positive and ascending, or the arrays do not fit together.
    """

    frequencies: FloatArray
    damping_ratios: FloatArray | None = None
    shapes: ComplexArray | None = None
    geometry: MeasuredGeometry | None = None

    def __post_init__(self) -> None:
        count = len(self.frequencies)
        if count == 0 or not self.frequencies[0] > 0.0 or not np.all(np.diff(self.frequencies) >= 0.0):
            raise HousingError(f"measured frequencies {self.frequencies} rad/s must be positive and ascending")
        if self.damping_ratios is not None and self.damping_ratios.shape != (count,):
            raise HousingError(f"{len(self.damping_ratios)} damping ratios for {count} measured frequencies")
        if (self.shapes is None) != (self.geometry is None):
            raise HousingError("measured shapes need the geometry they were measured at, and the geometry shapes")
        if self.shapes is not None and self.geometry is not None:
            expected = (count, len(self.geometry.points))
            if self.shapes.shape != expected:
                raise HousingError(f"measured shapes have shape {self.shapes.shape}; expected {expected}")
