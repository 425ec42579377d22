"""Axial modes of a shaft: longitudinal waves in its segments, its discs as masses."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .axis_spring import AxisSpring
from .rods import RodModes, rod_modes
from .rotor_lines import rod_shaft
from .search import find_modes
from .shaft import Rotor

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class AxialModes(RodModes):
    """Axial modes, orthonormal in mass; a free shaft's first is its rigid motion."""

    @property
    def displacement(self) -> FloatArray:
        """Displacement along the shaft at the stations, m per unit modal coordinate, (m, s)."""
        return self.amplitude


def solve_axial_modes(
    rotor: Rotor,
    springs: Sequence[AxisSpring] = (),
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
) -> AxialModes:
    """Every axial mode below a limit, or the lowest ones.

    Segments are rods of EA and ρA (without the lateral contraction that slows waves as short as the diameter),
    discs are masses, couplings are springs.

    Parameters
    ----------
    rotor
        The shaft and its discs.
    springs
        To ground, N/m: a thrust bearing's stiffness; without them the shaft is free.
    frequency_limit
        rad/s: all modes strictly below.
    count
        Number of modes, a rigid motion included; with neither, 10 or all there are.

    Raises
    ------
    RotorError
        A spring off the shaft, both a limit and a count, or more modes than a lumped rotor has.
    IncompleteModesError
        The modes fail their own proof.
    """
    return rod_modes(AxialModes, find_modes(rod_shaft(rotor, springs, "axial"), frequency_limit, count))
