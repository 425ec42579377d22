"""Hertz's elliptic contact of two smooth elastic bodies, by the exact elliptic integrals.

Two bodies touch at a point with the principal relative curvatures Σρ_y ≥ Σρ_x (1/m). Under a load Q the contact is an
ellipse of semi-axes a ≥ b, κ = a/b, with m = 1 − 1/κ² the parameter of the complete elliptic integrals K and E
(Johnson 1985, Eqs. 4.24–4.32; Harris and Kotzalas 2006, section 6.2):

    Σρ_y / Σρ_x = [κ² E − K] / [K − E] = R_D(0, 1, 1/κ²) / R_D(0, 1/κ², 1)
    a = (2 κ² E / π)^{1/3} [3 Q / (2 Σρ E*)]^{1/3},   b = a / κ,   p_max = 3 Q / (2 π a b)
    δ = (2 K / π) (π / 2 κ² E)^{1/3} [3 Q / (2 Σρ E*)]^{2/3} Σρ / 2

with Σρ = Σρ_x + Σρ_y and the contact modulus E* of rings and rolling elements (`ContactElasticity`). Carlson's R_D
(DLMF 19.25.1) writes both differences of the first line without cancellation, so κ is found to rounding from a circle
to the longest ellipse.
"""

import math
from dataclasses import dataclass

from scipy.optimize import brentq
from scipy.special import ellipe, ellipkm1, elliprd

from gearwhine.rotors.errors import require, require_finite


@dataclass(frozen=True)
class ContactElasticity:
    """Young's moduli [Pa], Poisson's ratios and the elements' density [kg/m³]; bearing steel where not given.

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
        """Check that moduli and density are positive and that Poisson's ratios are admissible."""
        for attribute in ("ring_modulus", "element_modulus", "element_density"):
            require_finite(f"contact {attribute}", getattr(self, attribute), positive=True)
        for attribute in ("ring_poisson_ratio", "element_poisson_ratio"):
            ratio = getattr(self, attribute)
            require(-1.0 < ratio <= 0.5, f"contact {attribute}", ratio, "a number above -1 and at most 0.5")

    @property
    def contact_modulus(self) -> float:
        """Contact modulus E* by 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ [Pa]."""
        ring = (1.0 - self.ring_poisson_ratio**2) / self.ring_modulus
        element = (1.0 - self.element_poisson_ratio**2) / self.element_modulus
        return 1.0 / (ring + element)


STEEL = ContactElasticity()

# Value log κ of the longest ellipse considered: far beyond any groove, and R_D still has all its digits.
_LONGEST_ELLIPSE_LOGARITHM = 30.0


@dataclass(frozen=True)
class PointContact:
    """A point contact, Q = stiffness · δ^{3/2}.

    Attributes
    ----------
    stiffness : float
        Stiffness [N/m^{3/2}].
    ellipticity : float
        Ellipticity κ = a/b, 1 or more.
    unit_semi_major, unit_semi_minor : float
        Semi-axes a and b under a load of 1 N [m]; they grow as Q^{1/3}.
    """

    stiffness: float
    ellipticity: float
    unit_semi_major: float
    unit_semi_minor: float

    @property
    def unit_pressure(self) -> float:
        """Greatest pressure under a load of 1 N [Pa]; it grows as Q^{1/3}."""
        return 1.5 / (math.pi * self.unit_semi_major * self.unit_semi_minor)

    def load_at_pressure(self, pressure: float) -> float:
        """Load under which the greatest pressure is ``pressure`` (in Pa) [N]."""
        return (pressure / self.unit_pressure) ** 3


def ellipticity(curvature_ratio: float) -> float:
    """κ = a/b of the contact ellipse of two bodies with the relative curvatures' ratio Σρ_y / Σρ_x ≥ 1."""

    def excess(log_kappa: float) -> float:
        squared = math.exp(-2.0 * log_kappa)
        return math.log(elliprd(0.0, 1.0, squared) / elliprd(0.0, squared, 1.0)) - math.log(curvature_ratio)

    if excess(0.0) >= 0.0:
        return 1.0
    return math.exp(brentq(excess, 0.0, _LONGEST_ELLIPSE_LOGARITHM, xtol=1e-15, rtol=8.9e-16))


def point_contact(curvature_along_major: float, curvature_along_minor: float, contact_modulus: float) -> PointContact:
    """Contact of two bodies from their relative curvatures.

    Parameters
    ----------
    curvature_along_major, curvature_along_minor : float
        Sums Σρ_x and Σρ_y of both bodies' curvatures in the plane of the longer and of the shorter semi-axis [1/m]; a
        hollow one counts negative, and the plane of the longer axis has the smaller sum.
    contact_modulus : float
        Contact modulus E* [Pa].

    Raises
    ------
    RotorError
        A curvature or modulus that is not positive, as of a ball in a conforming socket.
    """
    require_finite("relative curvature in the longer axis", curvature_along_major, positive=True)
    require_finite("relative curvature in the shorter axis", curvature_along_minor, minimum=curvature_along_major)
    require_finite("contact modulus", contact_modulus, positive=True)
    kappa = ellipticity(curvature_along_minor / curvature_along_major)
    integral_k = float(ellipkm1(1.0 / kappa**2))
    integral_e = float(ellipe(1.0 - 1.0 / kappa**2))
    total = curvature_along_major + curvature_along_minor
    size = (1.5 / (total * contact_modulus)) ** (1.0 / 3.0)
    shape = (2.0 * kappa**2 * integral_e / math.pi) ** (1.0 / 3.0)
    approach = (2.0 * integral_k / math.pi) / shape * size**2 * total / 2.0
    return PointContact(approach**-1.5, kappa, shape * size, shape * size / kappa)


def in_series(first: PointContact, second: PointContact) -> float:
    """Stiffness [N/m^{3/2}] of two contacts that carry one load: K^{−2/3} = K₁^{−2/3} + K₂^{−2/3}."""
    return float((first.stiffness ** (-2.0 / 3.0) + second.stiffness ** (-2.0 / 3.0)) ** -1.5)
