"""Units of length of files, plausible sizes of a housing, and lengths in messages."""

UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}
"""Units of length that a user may name [m]."""

SMALLEST, LARGEST = 0.01, 20.0
"""Bounds of the longest side of a gearbox housing [m]; beyond them its unit is mistaken."""


def plausible(length: float) -> bool:
    """Whether a length is plausible for the longest side of a housing [m]."""
    return SMALLEST <= length <= LARGEST


def length_text(length: float) -> str:
    """Write a length [m] for a message: in mm, from a metre on in m."""
    return f"{1e3 * length:.3g} mm" if length < 1.0 else f"{length:.4g} m"
