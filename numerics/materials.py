"""Ranges of plausible materials: stiffness, Poisson's ratio and density of the solids that machines are made of.

From plastics to diamond and osmium (Ashby, Materials Selection in Mechanical Design, charts
of modulus and density): plastics have 0.5 GPa and more, tungsten carbide 700 GPa, diamond 1200 GPa; wood and foamed
metals have 300 kg/m³ and more, osmium 22,600 kg/m³.
"""

from collections.abc import Iterator

from gearwhine.numerics.findings import Finding, Number, Part

_SOFTEST, _STIFFEST = 0.5e9, 1.3e12  # Pa
_LIGHTEST, _HEAVIEST = 300.0, 23e3  # kg/m³
_SOFTEST_SOLID = 1e3  # Pa, of gels: below it a number has lost its unit
_MOST_POISSON = 0.48
"""Poisson's ratio above which a solid is nearly incompressible and finite elements lock."""


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
        yield Finding(part, "youngs_modulus", youngs_modulus, expected, "warning")
    if not Number(above=0.0).accepts(density):
        yield Finding(part, "density", density, "a density above 0 kg/m^3")
    elif not _LIGHTEST <= density <= _HEAVIEST:
        expected = "a density of 300 to 23000 kg/m^3, as solids have (steel has 7850 kg/m^3)"
        yield Finding(part, "density", density, expected, "warning")
    if not Number(at_least=0.0, below=0.5).accepts(poisson_ratio):
        yield Finding(part, "poisson_ratio", poisson_ratio, "a Poisson ratio of at least 0 and below 0.5")
    elif poisson_ratio > _MOST_POISSON:
        expected = "a Poisson ratio of at most 0.48: finite elements of a nearly incompressible solid are too stiff"
        yield Finding(part, "poisson_ratio", poisson_ratio, expected, "warning")
