"""Ranges of plausible materials, and the damping of what is built from them, with sources.

Stiffness, Poisson's ratio and density are those of the solids that machines are made of.

From plastics to diamond and osmium (Ashby, Materials Selection in Mechanical Design, charts
of modulus and density): plastics have 0.5 GPa and more, tungsten carbide 700 GPa, diamond 1200 GPa; wood and foamed
metals have 300 kg/m³ and more, osmium 22,600 kg/m³.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from gearwhine.numerics.findings import Finding, Number, Part

_SOFTEST, _STIFFEST = 0.5e9, 1.3e12  # Pa
_LIGHTEST, _HEAVIEST = 300.0, 23e3  # kg/m³
_SOFTEST_SOLID = 1e3  # Pa, of gels: below it a number has lost its unit
_MOST_POISSON = 0.48
"""Poisson's ratio above which a solid is nearly incompressible and finite elements lock."""
_INCOMPRESSIBLE = 0.4999
"""Poisson's ratio from which on bulk and shear modulus differ so much that stiffness loses the digits of shear."""


@dataclass(frozen=True)
class StructuralDamping:
    """Damping of a structure by the way in which it is built.

    Attributes
    ----------
    ratio : float
        Damping ratio of its modes.
    source : str
        What it is of, and where it is published.
    """

    ratio: float
    source: str

    @classmethod
    def of_decrement(cls, decrement: float, source: str) -> "StructuralDamping":
        """Return the damping of a logarithmic decrement: ratio = decrement / sqrt(4 pi^2 + decrement^2)."""
        return cls(decrement / math.hypot(math.tau, decrement), f"{source}, logarithmic decrement {decrement:g}")


_EUROCODE = "EN 1991-1-4:2005, table F.2"
STRUCTURAL_DAMPING = {
    "welded": StructuralDamping.of_decrement(0.02, f"welded steel, {_EUROCODE}"),
    "bolted": StructuralDamping.of_decrement(0.03, f"steel with high-strength bolts, {_EUROCODE}"),
    "cast": StructuralDamping(0.02, "least of metal structures of one piece, Adams and Askenazi 1998: 0.02 to 0.04"),
}
"""Damping of structures in words. Adams and Askenazi (1998), *Building better products with finite element analysis*,
have 0.02 to 0.04 for metal structures of one piece; the least of these keeps resonances on the safe side. With ordinary
bolts, steel has a logarithmic decrement of 0.05, which is a ratio of 0.008."""


def material_findings(part: Part, youngs_modulus: float, poisson_ratio: float, density: float) -> Iterator[Finding]:
    """Yield what is impossible and what is unlikely of a material.

    Parameters
    ----------
    part : tuple of str
    youngs_modulus : float
        [Pa]
    poisson_ratio : float
    density : float
        [kg/m³]
    """
    modulus = Number(at_least=_SOFTEST_SOLID, unit="Pa")
    if not modulus.accepts(youngs_modulus):
        expected = "an elastic modulus of a solid, of at least 1 kPa (steel has 207 GPa)"
        yield Finding(part, "youngs_modulus", youngs_modulus, expected)
    elif not _SOFTEST <= youngs_modulus <= _STIFFEST:
        expected = "an elastic modulus of 0.5 to 1300 GPa, as plastics, metals and ceramics have (steel has 207 GPa)"
        if _SOFTEST <= 1e3 * youngs_modulus <= _STIFFEST:
            expected += "; is GPa meant in place of MPa?"
        yield Finding(part, "youngs_modulus", youngs_modulus, expected, "warning")
    if not Number(above=0.0).accepts(density):
        yield Finding(part, "density", density, "a density above 0 kg/m^3")
    elif not _LIGHTEST <= density <= _HEAVIEST:
        expected = "a density of 300 to 23000 kg/m^3, as solids have (steel has 7850 kg/m^3)"
        yield Finding(part, "density", density, expected, "warning")
    if not Number(at_least=0.0, below=_INCOMPRESSIBLE).accepts(poisson_ratio):
        expected = "a Poisson ratio of at least 0 and below 0.4999, above which elements lock (steel has 0.3)"
        yield Finding(part, "poisson_ratio", poisson_ratio, expected)
    elif poisson_ratio > _MOST_POISSON:
        expected = "a Poisson ratio of at most 0.48: finite elements of a nearly incompressible solid are too stiff"
        yield Finding(part, "poisson_ratio", poisson_ratio, expected, "warning")
