"""Shear coefficients of ROSS, and their counterparts here.

ROSS has two formulas for the shear coefficient κ. Its ``cowper`` is Cowper's, as in `rotors.shear_coefficient`. Its
``hutchinson`` has the denominator of Hutchinson (J. Appl. Mech. 68, 2001) but a factor 1 + ν less in the numerator,

    κ = 6 (1 + ν)(1 + m²)² / [(1 + m²)²(7 + 12ν + 4ν²) + 4 m²(5 + 6ν + 2ν²)],

0.71 for a solid section of ν = 0.3 where Hutchinson's is 0.93. The results of ROSS follow from it, and so does a rotor
read from its files. Elements without shear deflection (``shear_effects`` false) have a κ so large that they are
rigid in shear to ten digits.
"""

from typing import Final

from rotors.section import Section
from rotors.segment import Segment

RIGID_IN_SHEAR: Final = 1e9
"""Shear coefficient of an element without shear deflection."""

_SAME = 1e-9


def ross_hutchinson(bore_ratio: float, poisson_ratio: float) -> float:
    """κ of ROSS's ``hutchinson`` for a bore over outer diameter m and a Poisson ratio ν."""
    m2, nu = bore_ratio**2, poisson_ratio
    squared = (1.0 + m2) ** 2
    below = squared * (7.0 + 12.0 * nu + 4.0 * nu**2) + 4.0 * m2 * (5.0 + 6.0 * nu + 2.0 * nu**2)
    return 6.0 * squared * (1.0 + nu) / below


def ross_formula(segment: Segment) -> tuple[str, bool, float]:
    """The formula of ROSS that is closest to a segment's shear coefficient.

    Returns
    -------
    name
        ``"cowper"`` or ``"hutchinson"``.
    shear_effects
        False where the segment is rigid in shear.
    difference
        Relative difference of its κ from that of the segment at the middle of its length.
    """
    middle = segment.section(0.5)
    factor = middle.shear_factor
    if factor >= RIGID_IN_SHEAR:
        return "cowper", False, 0.0
    of_ross = {
        "cowper": Section(middle.outer_diameter, middle.inner_diameter, middle.material, "cowper").shear_factor,
        "hutchinson": ross_hutchinson(
            middle.inner_diameter / middle.outer_diameter, middle.material.poisson_ratio
        ),
    }  # fmt: skip
    name = min(of_ross, key=lambda formula: abs(of_ross[formula] - factor))
    difference = of_ross[name] / factor - 1.0
    return name, True, 0.0 if abs(difference) < _SAME else difference
