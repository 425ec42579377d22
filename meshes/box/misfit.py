"""A misfit of a box: the dimension that does not fit, and what is expected of it."""

from dataclasses import dataclass

SLACK = 1e-9
"""Rounding of lengths [m]."""


@dataclass(frozen=True)
class BoxMisfit:
    """A part of a box that does not fit.

    Attributes
    ----------
    location : tuple of str or int
        Attributes and indices from the :class:`~meshes.BoxGeometry` down, such as ``("ribs", 0, "at")``.
    expected : str
        The expected value, to be read after "expected".
    """

    location: tuple[str | int, ...]
    expected: str

    def __str__(self) -> str:
        """Write the misfit as a message."""
        place = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in self.location)
        return f"box: {place.lstrip('.')}: expected {self.expected}"


def mm(length: float) -> str:
    """Write a length [m] in mm for a message."""
    return f"{1e3 * length:.6g} mm"
