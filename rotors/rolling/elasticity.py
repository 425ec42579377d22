"""Elasticity of rings and rolling elements in contact."""

from dataclasses import dataclass

from rotors.errors import require, require_finite


@dataclass(frozen=True)
class ContactElasticity:
    """Young's moduli (Pa), Poisson's ratios and the elements' density (kg/m³); bearing steel where not given.

    Raises
    ------
    RotorError
        A modulus or density that is not positive and finite, or a ratio outside −1 to 0.5.
    """

    ring_modulus: float = 210e9
    ring_poisson_ratio: float = 0.3
    element_modulus: float = 210e9
    element_poisson_ratio: float = 0.3
    element_density: float = 7800.0

    def __post_init__(self) -> None:
        for what in ("ring_modulus", "element_modulus", "element_density"):
            require_finite(f"contact {what}", getattr(self, what), positive=True)
        for what in ("ring_poisson_ratio", "element_poisson_ratio"):
            ratio = getattr(self, what)
            require(-1.0 < ratio <= 0.5, f"contact {what}", ratio, "a number above -1 and at most 0.5")

    @property
    def contact_modulus(self) -> float:
        """E* of 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂, Pa."""
        ring = (1.0 - self.ring_poisson_ratio**2) / self.ring_modulus
        element = (1.0 - self.element_poisson_ratio**2) / self.element_modulus
        return 1.0 / (ring + element)


STEEL = ContactElasticity()
