"""Axial and torsional springs from the shaft to ground."""

from dataclasses import dataclass

from .errors import require, require_finite


@dataclass(frozen=True)
class AxisSpring:
    """A spring from the shaft to ground: along its axis in axial motion, about it in torsion.

    Parameters
    ----------
    at
        Position from the rotor's left end, m.
    stiffness
        N/m, or N·m/rad in torsion; zero is allowed, and ``math.inf`` holds the shaft there exactly.
    """

    at: float
    stiffness: float

    def __post_init__(self) -> None:
        require_finite("axis spring position", self.at, minimum=0.0)
        require(self.stiffness >= 0.0, "axis spring stiffness", self.stiffness, "zero, a positive number or infinity")
