"""Contact energy and element loads: the common form of ball and roller rows."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class RowEnergy:
    """Energy (J), its gradient (5,) and Hessian (5, 5) over the inner ring's displacement q.

    ``force`` is the sum of the elements' loads, N: the scale of the gradient's rounding.
    """

    value: float
    gradient: FloatArray
    hessian: FloatArray
    force: float


@dataclass(frozen=True)
class ElementLoads:
    """Loads, contact angles and pressures of each rolling element of a row.

    Attributes
    ----------
    azimuths
        (n,): from x towards y, rad.
    inner_load, outer_load
        (n,): of the contacts with either ring, N; they differ only with centrifugal forces.
    inner_angle, outer_angle
        (n,): contact angles, in the row's direction, rad.
    inner_pressure, outer_pressure
        (n,): Hertz's greatest, Pa; of a roller that of its worst slice.
    inner_semi_axes, outer_semi_axes
        (n, 2): of a ball's contact ellipses, across the groove and along it, m; of a roller's worst slice, half the
        slice's length and half the contact's width.
    approach
        (n,): of the rings through the element, m; of a roller at its worst slice.
    slice_loads
        (n, slices), N, of rollers.
    """

    azimuths: FloatArray
    inner_load: FloatArray
    outer_load: FloatArray
    inner_angle: FloatArray
    outer_angle: FloatArray
    inner_pressure: FloatArray
    outer_pressure: FloatArray
    inner_semi_axes: FloatArray
    outer_semi_axes: FloatArray
    approach: FloatArray
    slice_loads: FloatArray | None = None

    @property
    def loaded(self) -> int:
        """Number of elements that press on the inner ring."""
        return int(np.count_nonzero(self.inner_load > 0.0))

    @property
    def peak_pressure(self) -> float:
        """Greatest pressure in the row, Pa."""
        return float(max(self.inner_pressure.max(), self.outer_pressure.max()))


class RowContacts(Protocol):
    """Contacts of a row with its elements at given azimuths."""

    def energy(self, q: FloatArray) -> RowEnergy:
        """Energy and its derivatives at the inner ring's displacement q, (5,)."""

    def loads(self, q: FloatArray) -> ElementLoads:
        """Element loads at that displacement."""
