"""Shaft segment, cylindrical or conical, and flexible coupling between two shafts on one axis."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, Number, Rule, attribute_findings, refuse
from gearwhine.rotors.errors import RotorError
from gearwhine.rotors.model.material import ElasticMaterial, Section, ShearFormula

DAMPINGS = ("lateral_damping", "tilt_damping", "torsional_damping", "axial_damping")


def gauss_rule(points: int) -> tuple[FloatArray, FloatArray]:
    """Gauss–Legendre rule: fractions of a length and weights that add up to one, (points,) both.

    Exact to the degree 2 points − 1.
    """
    places, weights = np.polynomial.legendre.leggauss(points)
    return np.asarray(0.5 * (places + 1.0)), np.asarray(0.5 * weights)


@dataclass(frozen=True)
class Coupling:
    """A flexible coupling between two shafts on one axis, in their row of segments.

    Its compliances are spread evenly over its length L, as those of a massless beam with κGA = k L, EI = k_t L,
    GJ = k_θ L and EA = k_z L; half of its mass is at either end. It passes the axial force P on, which does work on
    the slope of its centre line as in a `Segment`: its energy in bending is

        ½ ∫ k L (x' − β)² + k_t L β'² + P x'² dz,

    over its length. So one that is rigid against tilting resists an offset of the shafts by k + P / L.

    Parameters
    ----------
    length : float
        Length from hub to hub [m].
    lateral_stiffness, axial_stiffness : float
        Stiffnesses k and k_z [N/m].
    tilt_stiffness, torsional_stiffness : float
        Stiffnesses k_t against an angle between the axes and k_θ about them [N·m/rad].
    mass, polar_inertia, diametral_inertia : float
        Mass [kg] and moments of inertia [kg·m²] of the whole coupling.
    lateral_damping, axial_damping, tilt_damping, torsional_damping : float
        Dashpots parallel to the stiffnesses [N·s/m, N·m·s/rad]: c of the coupled system, which turn with the shaft.
    axial_force : float
        Static force that the coupling carries, tension positive [N].

    Raises
    ------
    RotorError
        A length or stiffness that is not positive and finite, a negative inertia or damping, or an axial force that is
        not finite.
    """

    length: float
    lateral_stiffness: float
    tilt_stiffness: float
    torsional_stiffness: float
    axial_stiffness: float
    mass: float = 0.0
    polar_inertia: float = 0.0
    diametral_inertia: float = 0.0
    lateral_damping: float = 0.0
    tilt_damping: float = 0.0
    torsional_damping: float = 0.0
    axial_damping: float = 0.0
    axial_force: float = 0.0

    def __post_init__(self) -> None:
        """Check that length and stiffness are positive, inertia and damping not negative and the force finite."""
        positive, not_negative = Number(above=0.0), Number(at_least=0.0)
        rules: dict[str, Rule] = dict.fromkeys(
            ("length", "lateral_stiffness", "tilt_stiffness", "torsional_stiffness", "axial_stiffness"), positive
        )
        rules |= dict.fromkeys(("mass", "polar_inertia", "diametral_inertia", *DAMPINGS), not_negative)
        refuse(attribute_findings(("coupling", ""), self, **rules, axial_force=Number(unit="N")), RotorError)

    @property
    def clamped_buckling_load(self) -> float:
        """Compression at which it buckles whatever holds the shafts, Engesser's 1 / (L/(4π² k_t) + 1/(k L)) [N]."""
        bending = 4.0 * math.pi**2 * self.tilt_stiffness / self.length
        return 1.0 / (1.0 / bending + 1.0 / (self.lateral_stiffness * self.length))

    @property
    def is_damped(self) -> bool:
        """Whether it has damping."""
        return any(getattr(self, what) > 0.0 for what in DAMPINGS)

    @property
    def mass_centre(self) -> float:
        """Distance of the centre of mass from the left end [m]."""
        return 0.5 * self.length

    @property
    def polar_centre(self) -> float:
        """Distance of the centre of the polar inertia from the left end [m]."""
        return 0.5 * self.length


_GAUSS = tuple(zip(*(part.tolist() for part in gauss_rule(4)), strict=True))


@dataclass(frozen=True)
class Segment:
    """A straight round length of shaft, cylindrical or conical.

    Parameters
    ----------
    length, outer_diameter, inner_diameter : float
        Length and diameters [m]; the bore (inner diameter) is zero by default. For a cone, diameters at its left end.
    material : ElasticMaterial
        Material of the segment; by its name where the bore is left out, ``material=STEEL``.
    shear_coefficient : ShearFormula or float
        ``"cowper"``, ``"hutchinson"``, or the number κ itself.
    right_outer_diameter, right_inner_diameter : float or None
        Diameters at the right end [m]; the diameters change linearly. None for a cylinder.
    axial_force : float
        Static force that the segment carries, tension positive [N].

    Raises
    ------
    RotorError
        A length or outer diameter that is not positive, a bore not inside the section, or a material
        whose Poisson ratio the shear formula cannot take.
    """

    length: float
    outer_diameter: float
    inner_diameter: float = 0.0
    material: ElasticMaterial = None  # type: ignore[assignment]  # has to be given: None is refused
    shear_coefficient: ShearFormula | float = "cowper"
    right_outer_diameter: float | None = None
    right_inner_diameter: float | None = None
    axial_force: float = 0.0

    def __post_init__(self) -> None:
        """Check the length, the axial force, the diameters at both ends and the shear coefficient."""
        part = ("segment", "")
        rules: dict[str, Rule] = {
            "length": Number(above=0.0, unit="m"),
            "outer_diameter": Number(above=0.0, unit="m"),
            "inner_diameter": Number(at_least=0.0, unit="m"),
            "right_outer_diameter": Number(above=0.0, optional=True, unit="m"),
            "right_inner_diameter": Number(at_least=0.0, optional=True, unit="m"),
            "axial_force": Number(unit="N"),
        }
        if not isinstance(self.shear_coefficient, str):
            rules["shear_coefficient"] = Number(above=0.0)
        findings = list(attribute_findings(part, self, **rules))
        if not hasattr(self.material, "shear_modulus"):
            findings.append(Finding(part, "material", self.material, "a material"))
        refuse(findings, RotorError)
        refuse(
            (
                Finding(part, f"{side}inner_diameter", inner, f"less than the outer diameter {outer:g} m")
                for side, (outer, inner) in zip(("", "right_"), self.end_diameters, strict=True)
                if inner >= outer
            ),
            RotorError,
        )
        if isinstance(self.shear_coefficient, str):
            _ = self.section(0.0).shear_factor  # raises where the material does not suit the formula

    @property
    def end_diameters(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Outer and inner diameter at the left end, and at the right end [m]."""
        right_outer = self.outer_diameter if self.right_outer_diameter is None else self.right_outer_diameter
        right_inner = self.inner_diameter if self.right_inner_diameter is None else self.right_inner_diameter
        return (self.outer_diameter, self.inner_diameter), (right_outer, right_inner)

    @property
    def is_conical(self) -> bool:
        """Whether a diameter changes along the segment."""
        left, right = self.end_diameters
        return left != right

    def section(self, fraction: float) -> Section:
        """Return the cross-section at a fraction of the length from the left end, 0 to 1."""
        (outer, inner), (right_outer, right_inner) = self.end_diameters
        return Section(
            outer + fraction * (right_outer - outer),
            inner + fraction * (right_inner - inner),
            self.material,
            self.shear_coefficient,
        )

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return self._integral(lambda section, _: section.mass_per_length)

    @property
    def mass_centre(self) -> float:
        """Distance of the centre of mass from the left end [m]."""
        return self._integral(lambda section, z: section.mass_per_length * z) / self.mass if self.mass else 0.0

    @property
    def polar_inertia(self) -> float:
        """Moment of inertia about the axis [kg·m²]."""
        return self._integral(lambda section, _: section.polar_inertia_per_length)

    @property
    def polar_centre(self) -> float:
        """Distance of the centre of the polar inertia from the left end [m]."""
        about_left = self._integral(lambda section, z: section.polar_inertia_per_length * z)
        return about_left / self.polar_inertia if self.polar_inertia else 0.0

    @property
    def diametral_inertia(self) -> float:
        """Moment of inertia about a diameter through its own centre of mass [kg·m²]."""
        about_left = self._integral(lambda section, z: section.mass_per_length * z**2)
        return 0.5 * self.polar_inertia + about_left - self.mass * self.mass_centre**2

    def _integral(self, density: Callable[[Section, float], float]) -> float:
        """Integral along the segment; Gauss's four points are exact for the polynomials of a cone (degree 5)."""
        return self.length * math.fsum(
            weight * density(self.section(fraction), fraction * self.length) for fraction, weight in _GAUSS
        )


def forces_beside(parts: Sequence[Segment | Coupling], number: int) -> tuple[float | None, float | None]:
    """Axial forces of the nearest segments to the left and right of a part of a row [N]; None where there is none."""
    left = next((part.axial_force for part in reversed(parts[:number]) if isinstance(part, Segment)), None)
    right = next((part.axial_force for part in parts[number + 1 :] if isinstance(part, Segment)), None)
    return left, right
