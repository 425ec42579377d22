"""Certificate of a set of modes: none is missing, none stands twice, and each is accurate."""

from dataclasses import dataclass

RESIDUAL_BOUND = 1e-8
OVERLAP_BOUND = 1e-8
NOT_COUNTED = -1
"""Stands for the expected number of modes where no inertia was computed."""


@dataclass(frozen=True)
class Certificate:
    """The proof of a set of modes.

    Attributes
    ----------
    limit : float
        The circular frequency up to which the set is complete [rad/s].
    expected : int
        Modes below the limit by the inertia of K - limit² M; :data:`NOT_COUNTED` where it was not computed.
    found : int
        Modes in the set.
    max_residual : float
        Largest of |K φ - λ M φ| / ((λ + limit² + floor) |M φ|): the limit gives rigid modes a scale too, and the
        floor is never so small that the rounding of K alone would exceed the bound.
    max_overlap : float
        Largest |φᵢᵀ M φⱼ| of two modes: a mode found twice, which would hide a missing one, has an overlap of 1.
    """

    limit: float
    expected: int
    found: int
    max_residual: float
    max_overlap: float

    @property
    def complete(self) -> bool:
        """Whether nothing is missing, no mode stands twice and every mode is accurate."""
        proved = self.max_residual < RESIDUAL_BOUND and self.max_overlap < OVERLAP_BOUND
        return self.expected == self.found and proved
