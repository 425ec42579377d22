"""Lengths: the units that files may be in, the sizes that a housing may have, and how messages write them."""

UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}
"""Units of length that a user may name [m]."""

SMALLEST, LARGEST = 0.01, 20.0
"""A gearbox housing's longest side is longer than the one and shorter than the other [m]; else its unit is mistaken."""


def plausible(length: float) -> bool:
    """Whether a housing may be so long [m]."""
    return SMALLEST <= length <= LARGEST


def length_text(length: float) -> str:
    """Write a length [m] for a message: in mm, from a metre on in m."""
    return f"{1e3 * length:.3g} mm" if length < 1.0 else f"{length:.4g} m"
