"""Operating deflection shape: motion of the housing at one line of its spectrum, as a sum of its modes."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.errors import HousingError
from housing.modes import ModeSet

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True)
class OperatingShape:
    """The motion of a housing at one frequency.

    Attributes
    ----------
    frequency : float
        ω [rad/s].
    modal : ndarray of complex, shape (n_modes,)
        Complex amplitudes of the modes' accelerations [m √kg / s²]: each mode's is Re q̈ e^{iωt}.

    Raises
    ------
    HousingError
        Where the frequency is not positive, or nothing moves.
    """

    frequency: float
    modal: ComplexArray

    def __post_init__(self) -> None:
        if not self.frequency > 0.0:
            raise HousingError(f"an operating shape at {self.frequency} rad/s; expected a frequency above zero")
        if not np.all(np.isfinite(self.modal)) or not np.any(self.modal):
            raise HousingError("no mode of the housing moves at this line, or its amplitude is no number")

    @property
    def kinetic_shares(self) -> FloatArray:
        """Share of each mode in the mean kinetic energy ¼ Σ |q̇|², unit modal masses, shape (n_modes,)."""
        energy = np.abs(self.modal) ** 2
        return np.asarray(energy / energy.sum())

    def displacement(self, modes: ModeSet, nodes: IntArray) -> ComplexArray:
        """Complex amplitudes of the displacement of nodes, −φ q̈ / ω² summed over the modes [m], shape (n_nodes, 3)."""
        if len(self.modal) != len(modes.shapes):
            raise HousingError(f"{len(self.modal)} modal amplitudes for {len(modes.shapes)} modes")
        return np.asarray(np.tensordot(-self.modal / self.frequency**2, modes.shapes[:, nodes], axes=1))
