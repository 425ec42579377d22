"""Rolling bearing: rows of balls or rollers that share their rings.

The inner ring moves by q = (x, y, z, rotation about x, rotation about y) against the outer, taken at the bearing's
centre. A row's own direction is +1 where pushing the inner ring towards +z loads its contacts, −1 where −z does.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from rotors.errors import RotorError, require, require_finite

from .ball_row import BallRow
from .roller_row import RollerRow

Row = BallRow | RollerRow


@dataclass(frozen=True)
class RollingBearing:
    """A rolling bearing: one row or several that share their rings.

    Parameters
    ----------
    rows
        At least one.
    axial_preload
        A constant force of a spring on the inner ring along z, N.
    name
        Name in messages.

    Raises
    ------
    RotorError
        No rows, a preload that is not finite, or one on rollers, which have no axial stiffness.
    """

    rows: Sequence[Row]
    axial_preload: float = 0.0
    name: str = "rolling bearing"

    def __post_init__(self) -> None:
        object.__setattr__(self, "rows", tuple(self.rows))
        if not self.rows:
            raise RotorError(f"{self.name} has no rows; expected at least one")
        require_finite(f"axial preload of {self.name}", self.axial_preload)
        held = self.axial_preload == 0.0 or self.has_axial_stiffness
        require(
            held, f"axial preload of {self.name}", self.axial_preload, "none: cylindrical rollers carry no axial load"
        )

    @property
    def force_scale(self) -> float:
        """E* D² of the smallest element, a force far above its capacity, N."""
        return min(row.elasticity.contact_modulus * row.element_diameter**2 for row in self.rows)

    @property
    def has_axial_stiffness(self) -> bool:
        """Whether any row carries an axial load."""
        return any(isinstance(row, BallRow) for row in self.rows)

    @property
    def reach(self) -> float:
        """Half the largest pitch diameter, by which rotations are scaled to displacements of the contacts, m."""
        return 0.5 * max(row.pitch_diameter for row in self.rows)
