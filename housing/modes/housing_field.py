"""Displacement field of a housing: its finite-element mesh, and the shapes of its modes and residual modes on that.

A machine takes of its housing only motions at seats and sensors; sound and pictures need the field.
"""

from dataclasses import dataclass

import numpy as np

from gearwhine.housing.modes.natural_modes import ModeSet
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class HousingField:
    """Displacement field of a housing.

    Attributes
    ----------
    mesh : gearwhine.meshes.Mesh
    modes : ModeSet
        Natural modes on its nodes, complete up to the limit of their certificate, and residual modes.
    widest_bore : float or None
        Diameter of its widest bearing seat, an opening of its surface [m]; None where no diameter is known.
    """

    mesh: Mesh
    modes: ModeSet
    widest_bore: float | None = None

    @property
    def complete_below_hz(self) -> float:
        """Frequency below which its modes are complete [Hz]."""
        return self.modes.certificate.limit / (2.0 * np.pi)

    @property
    def shapes(self) -> FloatArray:
        """Shapes of the modes, then of the residual modes, shape (n, n_nodes, 3) [1/√kg]."""
        residual = self.modes.residual_modes
        return self.modes.shapes if residual is None else np.concatenate([self.modes.shapes, residual.shapes])
