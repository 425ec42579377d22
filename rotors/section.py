"""Round cross-section: area, second moment, stiffness and mass per length."""

import math
from dataclasses import dataclass

from .material import ShaftMaterial, ShearFormula, shear_coefficient


@dataclass(frozen=True)
class Section:
    """A round section of a shaft: outer and inner diameter in m, its material, its shear coefficient."""

    outer_diameter: float
    inner_diameter: float
    material: ShaftMaterial
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
        """Area in m²."""
        return math.pi / 4.0 * (self.outer_diameter**2 - self.inner_diameter**2)

    @property
    def second_moment(self) -> float:
        """Second moment of area about a diameter, m⁴; twice this is the polar one."""
        return math.pi / 64.0 * (self.outer_diameter**4 - self.inner_diameter**4)

    @property
    def bending_stiffness(self) -> float:
        """E I in N·m²."""
        return self.material.youngs_modulus * self.second_moment

    @property
    def shear_stiffness(self) -> float:
        """κ G A in N."""
        return self.shear_factor * self.material.shear_modulus * self.area

    @property
    def torsional_stiffness(self) -> float:
        """G J in N·m²."""
        return 2.0 * self.material.shear_modulus * self.second_moment

    @property
    def axial_stiffness(self) -> float:
        """E A in N."""
        return self.material.youngs_modulus * self.area

    @property
    def mass_per_length(self) -> float:
        """ρ A in kg/m."""
        return self.material.density * self.area

    @property
    def polar_inertia_per_length(self) -> float:
        """2 ρ I in kg·m."""
        return 2.0 * self.material.density * self.second_moment
