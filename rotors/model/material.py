"""Shaft material, Timoshenko's shear coefficient and the properties of round cross-sections.

A `Section` gives area, second moment, stiffness and mass per length.
"""

import math
from dataclasses import dataclass
from typing import Literal, Protocol

from gearwhine.rotors.errors import require, require_finite

ShearFormula = Literal["cowper", "hutchinson"]


class ElasticMaterial(Protocol):
    """Material of a shaft segment, whatever its class: :class:`ShaftMaterial`, or the `Material` of a housing.

    Rotors and housings share no package below them, so that they agree on these names and not on a class. Poisson's
    ratio is E / 2G − 1.
    """

    @property
    def youngs_modulus(self) -> float:
        """Young's modulus E [Pa]."""

    @property
    def shear_modulus(self) -> float:
        """Shear modulus G [Pa]."""

    @property
    def poisson_ratio(self) -> float:
        """Poisson's ratio ν."""

    @property
    def density(self) -> float:
        """Mass per volume [kg/m³]."""


@dataclass(frozen=True)
class ShaftMaterial:
    """A linear elastic shaft material with an independent shear modulus, as of shafts drawn or wound.

    Parameters
    ----------
    youngs_modulus, shear_modulus : float
        Young's modulus E and shear modulus G [Pa].
    density : float
        Mass per volume in kg/m³; zero makes a segment a pure spring.

    Raises
    ------
    RotorError
        A modulus is not positive, or the density is negative.
    """

    youngs_modulus: float
    shear_modulus: float
    density: float

    def __post_init__(self) -> None:
        """Check that both moduli are positive and that the density is not negative."""
        require_finite("youngs_modulus", self.youngs_modulus, positive=True)
        require_finite("shear_modulus", self.shear_modulus, positive=True)
        require_finite("density", self.density, minimum=0.0)

    @classmethod
    def from_poisson_ratio(cls, youngs_modulus: float, poisson_ratio: float, density: float) -> "ShaftMaterial":
        """Material of modulus E [Pa], Poisson ratio ν and density [kg/m³]; G = E / 2(1 + ν)."""
        require_finite("youngs_modulus", youngs_modulus, positive=True)
        require_finite("poisson_ratio", poisson_ratio)
        require(-1.0 < poisson_ratio <= 0.5, "poisson_ratio", poisson_ratio, "a number in (-1, 0.5]")
        return cls(youngs_modulus, youngs_modulus / (2.0 * (1.0 + poisson_ratio)), density)

    @property
    def poisson_ratio(self) -> float:
        """Poisson's ratio ν = E / 2G − 1."""
        return self.youngs_modulus / (2.0 * self.shear_modulus) - 1.0


def shear_coefficient(formula: ShearFormula, bore_ratio: float, poisson_ratio: float) -> float:
    """Timoshenko's shear coefficient κ of a round section, solid or hollow.

    With m the bore over the outer diameter and ν the Poisson ratio,

    - ``"cowper"`` (Cowper, J. Appl. Mech. 33, 1966, hollow circle)::

          κ = 6 (1 + ν) (1 + m²)² / [(7 + 6ν)(1 + m²)² + (20 + 12ν) m²]

    - ``"hutchinson"`` (Hutchinson, J. Appl. Mech. 68, 2001, hollow circle)::

          κ = 6 (1 + ν)² (1 + m²)²
              / [(7 + 34 m² + 7 m⁴) + 12 ν (1 + 4 m² + m⁴) + 4 ν² (1 + 4 m² + m⁴)]

    Raises
    ------
    RotorError
        Unknown formula, a ratio m outside [0, 1), or ν outside (-1, 0.5].
    """
    require(0.0 <= bore_ratio < 1.0, "bore over outer diameter", bore_ratio, "a number in [0, 1)")
    require(
        -1.0 < poisson_ratio <= 0.5,
        "Poisson ratio E / 2G - 1",
        poisson_ratio,
        "a number in (-1, 0.5]; check the moduli, or give the shear coefficient as a number",
    )
    m2, nu = bore_ratio**2, poisson_ratio
    if formula == "cowper":
        solid = (1.0 + m2) ** 2
        return 6.0 * (1.0 + nu) * solid / ((7.0 + 6.0 * nu) * solid + (20.0 + 12.0 * nu) * m2)
    require(formula == "hutchinson", "shear_coefficient", formula, "'cowper', 'hutchinson' or a number")
    poisson_terms = (12.0 * nu + 4.0 * nu**2) * (1.0 + 4.0 * m2 + m2**2)
    return 6.0 * (1.0 + nu) ** 2 * (1.0 + m2) ** 2 / (7.0 + 34.0 * m2 + 7.0 * m2**2 + poisson_terms)


@dataclass(frozen=True)
class Section:
    """A round section of a shaft: outer and inner diameter in m, its material, its shear coefficient."""

    outer_diameter: float
    inner_diameter: float
    material: ElasticMaterial
    shear_coefficient: ShearFormula | float

    @property
    def shear_factor(self) -> float:
        """Shear coefficient κ as a number."""
        if isinstance(self.shear_coefficient, str):
            ratio = self.inner_diameter / self.outer_diameter
            return shear_coefficient(self.shear_coefficient, ratio, self.material.poisson_ratio)
        return float(self.shear_coefficient)

    @property
    def area(self) -> float:
        """Area [m²]."""
        return math.pi / 4.0 * (self.outer_diameter**2 - self.inner_diameter**2)

    @property
    def second_moment(self) -> float:
        """Second moment of area about a diameter [m⁴]; twice this is the polar one."""
        return math.pi / 64.0 * (self.outer_diameter**4 - self.inner_diameter**4)

    @property
    def bending_stiffness(self) -> float:
        """Bending stiffness E I [N·m²]."""
        return self.material.youngs_modulus * self.second_moment

    @property
    def shear_stiffness(self) -> float:
        """Shear stiffness κ G A [N]."""
        return self.shear_factor * self.material.shear_modulus * self.area

    @property
    def torsional_stiffness(self) -> float:
        """Torsional stiffness G J [N·m²]."""
        return 2.0 * self.material.shear_modulus * self.second_moment

    @property
    def axial_stiffness(self) -> float:
        """Axial stiffness E A [N]."""
        return self.material.youngs_modulus * self.area

    @property
    def mass_per_length(self) -> float:
        """Mass per length ρ A [kg/m]."""
        return self.material.density * self.area

    @property
    def polar_inertia_per_length(self) -> float:
        """Polar inertia per length 2 ρ I [kg·m]."""
        return 2.0 * self.material.density * self.second_moment
