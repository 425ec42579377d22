"""Rotor assembly as it is drawn: shaft, gears, probes, unbalances, bearings with their seats."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from gearwhine.rotors import Bearing, Coupling, Disc, ElasticMaterial, Rotor, Segment

# A disc without a plausible ring (a mass alone, or inertias that no uniform ring has) is drawn as a point.
_THINNEST = 1e-6


@dataclass(frozen=True)
class DrawnGear:
    """Outline of a gear: its name, the place of its middle, its face width and its diameters [m].

    ``disc`` is the disc of the rotor that carries its inertia, which is then not drawn beside it.
    """

    name: str
    at: float
    face_width: float
    tip_diameter: float
    pitch_diameter: float
    root_diameter: float
    teeth: int | None = None
    disc: Disc | None = None


@dataclass(frozen=True)
class DrawnUnbalance:
    """An unbalance: its place [m], mass times eccentricity [kg·m] and angle from x [rad]."""

    at: float
    moment: float
    phase: float = 0.0


@dataclass(frozen=True)
class DrawnProbe:
    """A displacement probe: its name, its place [m] and its angle from x [rad]."""

    name: str
    at: float
    angle: float = 0.0


@dataclass(frozen=True)
class RotorAssembly:
    """Rotor with the parts that its figures show.

    Parameters
    ----------
    rotor : Rotor
        Segments and shaft couplings are drawn to scale, its discs as the rings that have their inertias.
    bearings : sequence of Bearing
    gears, unbalances, probes : sequence
        Gears, unbalances and probes on the rotor.
    rolling : collection of str
        Names of the bearings drawn with the sign of a rolling bearing; the others are springs.
    seats : mapping of str to str
        Seat of each bearing by the bearing's name; the others stand on the ground or on their pedestal.
    materials : mapping of ElasticMaterial to str
        Names of the segments' materials; a material without a name is shown by modulus and density.
    """

    rotor: Rotor
    bearings: Sequence[Bearing] = ()
    gears: Sequence[DrawnGear] = ()
    unbalances: Sequence[DrawnUnbalance] = ()
    probes: Sequence[DrawnProbe] = ()
    rolling: Collection[str] = ()
    seats: Mapping[str, str] = field(default_factory=dict)
    materials: Mapping[ElasticMaterial, str] = field(default_factory=dict)

    @property
    def parts(self) -> Sequence[Segment | Coupling]:
        """The row of segments, couplings among them."""
        return self.rotor.segments

    @property
    def discs(self) -> list[Disc]:
        """Discs of the rotor that are drawn as discs: those that no gear stands for."""
        remaining = list(self.rotor.discs)
        for gear in self.gears:
            if gear.disc in remaining:
                remaining.remove(gear.disc)
        return remaining

    def shaft_radius(self, at: float) -> float:
        """Return the outer radius of the shaft at a place [m]; where two meet, the larger one."""
        slack = 1e-9 * self.rotor.length
        radii = [
            _radius_in(part, (at - left) / part.length)
            for part, left in zip(self.parts, self.rotor.joints[:-1].tolist(), strict=True)
            if isinstance(part, Segment) and left - slack <= at <= left + part.length + slack
        ]
        return max(radii, default=self.largest_shaft_radius)

    @property
    def largest_shaft_radius(self) -> float:
        """Largest outer radius of the shaft [m]; of a row of couplings alone, half the mean length of one."""
        ends = [outer for part in self.parts if isinstance(part, Segment) for outer, _ in part.end_diameters]
        return 0.5 * max(ends) if ends else 0.5 * self.rotor.length / len(self.parts)

    @property
    def largest_radius(self) -> float:
        """Largest radius of anything on the rotor [m]."""
        rings = [ring for disc in self.discs if (ring := self.ring(disc)) is not None]
        return max(
            [self.largest_shaft_radius, *(radius for radius, _ in rings), *(0.5 * g.tip_diameter for g in self.gears)]
        )

    def outer_radius(self, at: float) -> float:
        """Return the radius of the largest part on the rotor that covers a place [m]."""
        radii = [self.shaft_radius(at)]
        for disc in self.discs:
            ring = self.ring(disc)
            if ring is not None and abs(disc.at - at) <= 0.5 * ring[1]:
                radii.append(ring[0])
        radii += [0.5 * gear.tip_diameter for gear in self.gears if abs(gear.at - at) <= 0.5 * gear.face_width]
        return max(radii)

    @property
    def reach(self) -> tuple[float, float]:
        """Ends of the drawing along the axis [m]: of the shaft, and of discs and gears beyond it."""
        widths = [(disc.at, ring[1]) for disc in self.discs if (ring := self.ring(disc)) is not None]
        widths += [(gear.at, gear.face_width) for gear in self.gears]
        return (
            min([0.0, *(at - 0.5 * width for at, width in widths)]),
            max([self.rotor.length, *(at + 0.5 * width for at, width in widths)]),
        )

    def ring(self, disc: Disc) -> tuple[float, float] | None:
        """Return outer radius and width [m] of the uniform ring round the shaft that has a disc's mass and inertias.

        A ring of bore radius r has I_p = m (R² + r²) / 2 and I_d = I_p / 2 + m h² / 12, so that
        R² = 2 I_p / m − r² and h² = 12 (I_d − I_p / 2) / m. A disc that is thinner than any, or given without
        its diametral inertia, is drawn thin.

        Returns
        -------
        tuple or None
            None for a point mass, and where the ring would not reach beyond the shaft.
        """
        if disc.mass == 0.0 or disc.polar_inertia == 0.0:
            return None
        bore = self.shaft_radius(disc.at)
        squared = 2.0 * disc.polar_inertia / disc.mass - bore**2
        if squared <= bore**2:
            return None
        thick = 12.0 * (disc.diametral_inertia - 0.5 * disc.polar_inertia) / disc.mass
        return math.sqrt(squared), math.sqrt(max(thick, _THINNEST * squared))


def _radius_in(part: Segment, fraction: float) -> float:
    return 0.5 * part.section(min(max(fraction, 0.0), 1.0)).outer_diameter
