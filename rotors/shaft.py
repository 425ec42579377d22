"""The rotor as the user describes it: round segments end to end, and rigid discs on them."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

from .errors import RotorError, require, require_finite
from .material import ShaftMaterial, ShearFormula
from .section import Section

FloatArray = npt.NDArray[np.float64]
MassModel = Literal["distributed", "lumped"]

# Two positions closer than this fraction of the rotor's length are one station: sums of printed
# segment lengths differ from printed positions by rounding alone.
STATION_TOLERANCE = 1e-9


@dataclass(frozen=True)
class Segment:
    """A straight round piece of shaft, cylindrical or conical.

    Parameters
    ----------
    length, outer_diameter, inner_diameter
        In m; the bore (inner diameter) may be zero. Of a cone these are the diameters at its left end.
    material
        Its material.
    shear_coefficient
        ``"cowper"``, ``"hutchinson"``, or the number κ itself.
    right_outer_diameter, right_inner_diameter
        At the right end in m, between which the diameters change linearly; None where they do not change.
    axial_force
        Static force in N that the piece carries, tension positive.

    Raises
    ------
    RotorError
        A length or outer diameter that is not positive, a bore not inside the section, or a material
        whose Poisson ratio the shear formula cannot take.
    """

    length: float
    outer_diameter: float
    inner_diameter: float
    material: ShaftMaterial
    shear_coefficient: ShearFormula | float = "cowper"
    right_outer_diameter: float | None = None
    right_inner_diameter: float | None = None
    axial_force: float = 0.0

    def __post_init__(self) -> None:
        require_finite("segment length", self.length, positive=True)
        require_finite("segment axial_force", self.axial_force)
        for side, (outer, inner) in zip(("", "right_"), self.end_diameters, strict=True):
            require_finite(f"segment {side}outer_diameter", outer, positive=True)
            require_finite(f"segment {side}inner_diameter", inner, minimum=0.0)
            expected = f"less than the outer diameter {outer:g} m"
            require(inner < outer, f"segment {side}inner_diameter", inner, expected)
        if isinstance(self.shear_coefficient, str):
            _ = self.section(0.0).shear_factor  # raises where the material does not suit the formula
        else:
            require_finite("shear coefficient", self.shear_coefficient, positive=True)

    @property
    def end_diameters(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Outer and inner diameter at the left end, and at the right end, m."""
        right_outer = self.outer_diameter if self.right_outer_diameter is None else self.right_outer_diameter
        right_inner = self.inner_diameter if self.right_inner_diameter is None else self.right_inner_diameter
        return (self.outer_diameter, self.inner_diameter), (right_outer, right_inner)

    @property
    def is_conical(self) -> bool:
        """Whether a diameter changes along the piece."""
        left, right = self.end_diameters
        return left != right

    def section(self, fraction: float) -> Section:
        """The section at a fraction of the length from the left end, 0 to 1."""
        (outer, inner), (right_outer, right_inner) = self.end_diameters
        return Section(
            outer + fraction * (right_outer - outer),
            inner + fraction * (right_inner - inner),
            self.material,
            self.shear_coefficient,
        )

    @property
    def mass(self) -> float:
        """Mass in kg."""
        return self._integral(lambda section, _: section.mass_per_length)

    @property
    def mass_centre(self) -> float:
        """Distance of the centre of mass from the left end, m."""
        return self._integral(lambda section, z: section.mass_per_length * z) / self.mass if self.mass else 0.0

    @property
    def polar_inertia(self) -> float:
        """Moment of inertia about the axis, kg·m²."""
        return self._integral(lambda section, _: section.polar_inertia_per_length)

    @property
    def diametral_inertia(self) -> float:
        """Moment of inertia about a diameter through its own centre of mass, kg·m²."""
        about_left = self._integral(lambda section, z: section.mass_per_length * z**2)
        return 0.5 * self.polar_inertia + about_left - self.mass * self.mass_centre**2

    def _integral(self, density: Callable[[Section, float], float]) -> float:
        """Integral along the piece; Gauss's four points are exact for the polynomials of a cone (degree 4)."""
        points, weights = np.polynomial.legendre.leggauss(4)
        fractions = 0.5 * (points + 1.0)
        return (
            0.5
            * self.length
            * math.fsum(
                weight * density(self.section(fraction), fraction * self.length)
                for fraction, weight in zip(fractions.tolist(), weights.tolist(), strict=True)
            )
        )


@dataclass(frozen=True)
class Disc:
    """A rigid body fixed to the shaft at a point; with zero inertias, a point mass.

    Parameters
    ----------
    at
        Position from the rotor's left end, m.
    mass
        kg.
    polar_inertia, diametral_inertia
        About the axis and about a diameter, kg·m².
    """

    at: float
    mass: float
    polar_inertia: float = 0.0
    diametral_inertia: float = 0.0

    def __post_init__(self) -> None:
        require_finite("disc position", self.at, minimum=0.0)
        require_finite("disc mass", self.mass, minimum=0.0)
        require_finite("disc polar_inertia", self.polar_inertia, minimum=0.0)
        require_finite("disc diametral_inertia", self.diametral_inertia, minimum=0.0)

    @classmethod
    def from_dimensions(
        cls, at: float, width: float, outer_diameter: float, inner_diameter: float, density: float
    ) -> "Disc":
        """Disc of a round ring of the given width and diameters (m) and density (kg/m³)."""
        ring = Segment(width, outer_diameter, inner_diameter, ShaftMaterial(1.0, 0.5, density))
        return cls(at, ring.mass, ring.polar_inertia, ring.diametral_inertia)


@dataclass(frozen=True)
class Rotor:
    """A shaft of segments, left to right, carrying discs.

    Parameters
    ----------
    name
        What messages call it.
    segments
        At least one `Segment`, from the left end.
    discs
        Any number of `Disc`; several may share a place.
    mass_model
        ``"distributed"``: every segment is an exact Timoshenko beam and rod with its own mass.
        ``"lumped"``: every segment is massless and its inertias go to its two ends.

    Raises
    ------
    RotorError
        No segments, a disc beyond the shaft, an unknown mass model, or a rotor without mass.
    """

    name: str
    segments: Sequence[Segment]
    discs: Sequence[Disc] = ()
    mass_model: MassModel = "distributed"

    def __post_init__(self) -> None:
        object.__setattr__(self, "segments", tuple(self.segments))
        object.__setattr__(self, "discs", tuple(self.discs))
        where = f"rotor {self.name!r}"
        if not self.segments:
            raise RotorError(f"{where} has no segments; expected at least one")
        known = self.mass_model in ("distributed", "lumped")
        require(known, f"{where} mass_model", self.mass_model, "'distributed' or 'lumped'")
        for disc in self.discs:
            self.require_on_shaft(f"{where} disc", disc.at)
        require(self.mass > 0.0, f"{where} mass", self.mass, "a positive mass, of segments or of discs")

    def require_on_shaft(self, what: str, at: float) -> None:
        """Raise `RotorError` unless ``at`` (m from the left end) is a finite place on the shaft."""
        slack = STATION_TOLERANCE * self.length
        inside = math.isfinite(at) and -slack <= at <= self.length + slack
        require(inside, f"{what} position", at, f"a place on the shaft, 0 to {self.length:g} m")

    @cached_property
    def joints(self) -> FloatArray:
        """Positions of the segments' ends, (segments + 1,), m."""
        # Extended precision, because 400 rounded additions would move the right end.
        lengths = np.array([0.0, *(segment.length for segment in self.segments)], dtype=np.longdouble)
        return np.cumsum(lengths).astype(np.float64)

    @property
    def length(self) -> float:
        """Length of the shaft, m."""
        return float(self.joints[-1])

    @property
    def stations(self) -> FloatArray:
        """Segment ends and disc positions, ascending, each place once, (stations,), m."""
        return merged_positions(self.joints, [disc.at for disc in self.discs])

    @property
    def mass(self) -> float:
        """Total mass, kg."""
        return math.fsum([part.mass for part in self.segments] + [disc.mass for disc in self.discs])

    @property
    def polar_inertia(self) -> float:
        """Total moment of inertia about the axis, kg·m²."""
        return math.fsum([part.polar_inertia for part in self.segments] + [d.polar_inertia for d in self.discs])

    @property
    def centre_of_mass(self) -> float:
        """Distance of the centre of mass from the left end, m."""
        centres = 0.5 * (self.joints[1:] + self.joints[:-1])
        moments = [segment.mass * centre for segment, centre in zip(self.segments, centres, strict=True)]
        return math.fsum([*moments, *(disc.mass * disc.at for disc in self.discs)]) / self.mass


def merged_positions(joints: FloatArray, others: Sequence[float]) -> FloatArray:
    """Joints and other positions, ascending; one that lies on a joint or another position is that one.

    Parameters
    ----------
    joints
        Ascending positions that stay exactly as they are, (n,), m.
    others
        Further positions on the shaft, m.
    """
    slack = STATION_TOLERANCE * float(joints[-1])
    kept = list(joints)
    for position in sorted(others):
        if min(abs(position - other) for other in kept) > slack:
            kept.append(position)
    return np.array(sorted(kept))


def station_index(stations: FloatArray, at: float) -> int:
    """Index of the station at the position ``at`` (m), which must be one of them."""
    return int(np.argmin(np.abs(stations - at)))
