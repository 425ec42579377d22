"""Rotor: round shaft segments end to end with rigid discs on them, and its inertias."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np

from gearwhine.numerics.arrays import FloatArray, IndexArray
from gearwhine.numerics.findings import (
    Finding,
    Instance,
    Number,
    Part,
    Severity,
    attribute_findings,
    kind_findings,
    refuse,
)
from gearwhine.rotors.errors import RotorError, require, require_finite
from gearwhine.rotors.model.material import ShaftMaterial
from gearwhine.rotors.model.profile import (
    STATION_TOLERANCE,
    Profile,
    StiffnessDiameter,
    merged_positions,
    shaft_profile,
)
from gearwhine.rotors.model.segment import Coupling, Segment

_LARGEST_STRAIN = 0.1

MassModel = Literal["distributed", "lumped"]


@dataclass(frozen=True)
class Disc:
    """A rigid body fixed to the shaft at a point; with zero inertias, a point mass.

    Parameters
    ----------
    at : float
        Position from the rotor's left end [m].
    mass : float
        Mass [kg].
    polar_inertia, diametral_inertia : float
        Moments of inertia about the axis and about a diameter [kg·m²].
    size : tuple of float, optional
        Width, outer and inner diameter [m], of a disc by its dimensions.

    Raises
    ------
    RotorError
        A number that is negative or not finite, or inertias that no body has.
    """

    at: float
    mass: float
    polar_inertia: float = 0.0
    diametral_inertia: float = 0.0
    size: tuple[float, float, float] | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        """Check that position, mass and inertias are finite and not negative, and that a body can have them."""
        rules = dict.fromkeys(("at", "mass", "polar_inertia", "diametral_inertia"), Number(at_least=0.0))
        refuse(attribute_findings(("disc", ""), self, **rules), RotorError)
        refuse(self.findings, RotorError)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Inertias that no body has, or hardly one on a shaft.

        About a diameter through the centre of mass J_d = J_p / 2 + ∫ z² dm, so that J_p is at most 2 J_d.
        """
        return tuple(inertia_findings(self.at, self.mass, self.polar_inertia, self.diametral_inertia))

    @classmethod
    def from_dimensions(
        cls, at: float, width: float, outer_diameter: float, inner_diameter: float, density: float
    ) -> "Disc":
        """Disc of a round ring of the given width and diameters [m] and density [kg/m³]."""
        ring = Segment(width, outer_diameter, inner_diameter, ShaftMaterial(1.0, 0.5, density))
        return cls(at, ring.mass, ring.polar_inertia, ring.diametral_inertia, (width, outer_diameter, inner_diameter))


def station_findings(part: Part, attribute: str, at: float, rotor: str, length: float) -> Iterator[Finding]:
    """Yield a finding where a place is not on a rotor of some length [m]."""
    slack = STATION_TOLERANCE * length
    if not -slack <= at <= length + slack:
        yield Finding(part, attribute, at, f'a station on rotor "{rotor}", which is {1e3 * length:.6g} mm long')


_PRINTED = 1.02  # rounding of printed inertias
_LARGEST_GYRATION = 10.0  # m, of any rotor


def inertia_findings(at: float, mass: float, polar: float, diametral: float) -> Iterator[Finding]:
    """Yield inertias about the axis of more than twice those about a diameter, and masses too far out."""
    part = ("disc", f"at {at:g} m")
    if polar > 2.0 * _PRINTED * diametral:
        expected = (
            f"at most twice the diametral_inertia of {diametral:g} kg·m², as of any body (a thin disc has just twice)"
        )
        severity: Severity = "error" if diametral > 0.0 else "warning"
        yield Finding(part, "polar_inertia", polar, expected, severity)
    if mass > 0.0 and polar > mass * _LARGEST_GYRATION**2:
        gyration = math.sqrt(polar / mass)
        expected = f"an inertia that {mass:g} kg have on a rotor; they would lie {gyration:.4g} m off the axis"
        yield Finding(part, "polar_inertia", polar, expected)


@dataclass(frozen=True)
class Rotor:
    """A shaft of segments, left to right, carrying discs.

    Parameters
    ----------
    name : str
        Name in messages.
    segments : sequence of Segment or Coupling
        At least one `Segment`, from the left end; a `Coupling` may stand between them.
    discs : sequence of Disc
        Any number of `Disc`; several may share a place.
    mass_model : MassModel
        ``"distributed"``: every segment is an exact Timoshenko beam and rod with its own mass. ``"lumped"``: every
        segment is massless and its inertias go to its two ends (`station_inertias`).
    stiffness_diameters : sequence of StiffnessDiameter
        Lengths over which other bodies stiffen the shaft.

    Raises
    ------
    RotorError
        No segments, a disc or a stiffness diameter beyond the shaft, an unknown mass model, or a rotor without mass.
    """

    name: str
    segments: Sequence[Segment | Coupling]
    discs: Sequence[Disc] = ()
    mass_model: MassModel = "distributed"
    stiffness_diameters: Sequence[StiffnessDiameter] = ()

    def __post_init__(self) -> None:
        """Check for segments, the mass model, discs and stiffness diameters on the shaft and a mass; keep tuples."""
        for attribute in ("segments", "discs", "stiffness_diameters"):
            if isinstance(given := getattr(self, attribute), Iterable):
                object.__setattr__(self, attribute, tuple(given))
        part = ("rotor", str(self.name))
        refuse([*attribute_findings(part, self, name=Instance(str, "a name")), *self._kind_findings(part)], RotorError)
        places = {f"discs.{number}.at": disc.at for number, disc in enumerate(self.discs)}
        refuse((finding for key, at in places.items() for finding in self.station_findings(part, key, at)), RotorError)
        for stiffness in self.stiffness_diameters:
            for end in (stiffness.left, stiffness.right):
                self.require_on_shaft(f"rotor {self.name!r} stiffness diameter", end)
        if self.mass <= 0.0:
            refuse([Finding(part, "mass", self.mass, "a positive mass, of segments or of discs")], RotorError)

    def _kind_findings(self, part: Part) -> Iterator[Finding]:
        """Yield segments and discs of another kind, and an unknown mass model."""
        if not self.segments:
            yield Finding(part, "segments", (), "at least one segment")
        yield from kind_findings(part, self, segments=(Segment, Coupling), discs=Disc)
        if self.mass_model not in ("distributed", "lumped"):
            yield Finding(part, "mass_model", self.mass_model, "'distributed' or 'lumped'")

    def station_findings(self, part: Part, attribute: str, at: float) -> Iterator[Finding]:
        """Yield a finding of a part whose place on this shaft [m] is beyond its ends."""
        yield from station_findings(part, attribute, at, self.name, self.length)

    def require_on_shaft(self, label: str, at: float) -> None:
        """Raise `RotorError` unless ``at`` (m from the left end) is a finite place on the shaft."""
        slack = STATION_TOLERANCE * self.length
        inside = math.isfinite(at) and -slack <= at <= self.length + slack
        require(inside, f"{label} position", at, f"a place on the shaft, 0 to {self.length:g} m")

    @cached_property
    def highest_speed(self) -> float:
        """Speed at which the shaft's own rotation would strain its surface by a tenth [rad/s]; inf without inertia.

        The hoop strain of a thin ring is ρ ω² r² / E (Timoshenko, Strength of Materials II): steel would move at
        1.6 km/s, five times the speed at which any steel bursts, and linear elasticity ends before.
        """
        shafts = [part for part in self.segments if isinstance(part, Segment) and part.material.density > 0.0]
        speeds = [
            math.sqrt(_LARGEST_STRAIN * part.material.youngs_modulus / part.material.density)
            * (2.0 / max(part.section(end).outer_diameter for end in (0.0, 1.0)))
            for part in shafts
        ]
        return min(speeds, default=math.inf)

    def require_speed(self, speed: float) -> None:
        """Raise `RotorError` unless ``speed`` [rad/s] is finite and one that a shaft can turn at."""
        require_finite("speed", speed)
        possible = abs(speed) <= self.highest_speed
        require(possible, "speed", speed, f"at most {self.highest_speed:.3g} rad/s, where rotor {self.name!r} is torn")

    @cached_property
    def joints(self) -> FloatArray:
        """Positions of the segments' ends, (segments + 1,) [m]."""
        # Extended precision, because 400 rounded additions would move the right end.
        lengths = np.array([0.0, *(segment.length for segment in self.segments)], dtype=np.longdouble)
        return np.cumsum(lengths).astype(np.float64)

    @cached_property
    def profile(self) -> Profile:
        """Stiffness and inertia along the shaft, as its transfer matrices take them."""
        return shaft_profile(self.segments, self.joints, self.stiffness_diameters)

    @cached_property
    def spans(self) -> "ShaftSpans":
        """The shaft between the places where its section changes or an inertia sits."""
        return shaft_spans(self)

    @property
    def length(self) -> float:
        """Length of the shaft [m]."""
        return float(self.joints[-1])

    def outer_diameter(self, at: float, towards: float) -> float:
        """Outer diameter of the segment that begins at a place and lies towards another one [m]; 0 for a coupling."""
        inward = math.copysign(STATION_TOLERANCE * self.length, towards - at)
        number = int(np.clip(np.searchsorted(self.joints, at + inward) - 1, 0, len(self.segments) - 1))
        part = self.segments[number]
        if isinstance(part, Coupling):
            return 0.0
        fraction = (at - float(self.joints[number])) / part.length
        return part.section(min(max(fraction, 0.0), 1.0)).outer_diameter

    @property
    def stations(self) -> FloatArray:
        """Segment ends and disc positions, ascending, each place once, (stations,) [m]."""
        return merged_positions(self.joints, [disc.at for disc in self.discs])

    @cached_property
    def mass(self) -> float:
        """Total mass [kg]."""
        return math.fsum([part.mass for part in self.segments] + [disc.mass for disc in self.discs])

    @cached_property
    def is_compressed(self) -> bool:
        """Whether an axial force compresses some part of the shaft."""
        return any(part.axial_force < 0.0 for part in self.segments)

    @property
    def polar_inertia(self) -> float:
        """Total moment of inertia about the axis [kg·m²]."""
        return math.fsum([part.polar_inertia for part in self.segments] + [d.polar_inertia for d in self.discs])

    @property
    def centre_of_mass(self) -> float:
        """Distance of the centre of mass from the left end [m]."""
        lefts = self.joints[:-1].tolist()
        moments = [part.mass * (left + part.mass_centre) for part, left in zip(self.segments, lefts, strict=True)]
        return math.fsum([*moments, *(disc.mass * disc.at for disc in self.discs)]) / self.mass


@dataclass(frozen=True)
class ShaftSpans:
    """A rotor's spans between the places where its section changes or an inertia sits.

    Attributes
    ----------
    nodes : ndarray, shape (s + 1,)
        Ends of the spans [m].
    kind, start, end, lengths : ndarray, shape (s,)
        Kinds and lengths as in `gearwhine.rotors.transfer_matrix.discretised_shaft.ContinuousShaft`, the kinds those of
        the rotor's profile.
    inertias : ndarray, shape (s + 1, 3)
        Mass [kg], diametral and polar moment of inertia [kg·m²] at the nodes.
    """

    nodes: FloatArray
    kind: IndexArray
    start: FloatArray
    end: FloatArray
    lengths: FloatArray
    inertias: FloatArray


def station_index(stations: FloatArray, at: float) -> int:
    """Index of the station at the position ``at`` [m], which must be one of them."""
    return int(np.abs(stations - at).argmin())


def shaft_spans(rotor: Rotor) -> ShaftSpans:
    """Spans of a rotor; neighbours of one uniform kind without an inertia between them are merged.

    So a plain shaft given in sixty elements costs no more than one given whole. The transfer matrix of a uniform span
    is exact at any length, and the field inside it is exact too.
    """
    profile = rotor.profile
    edges = profile.edges
    nodes = merged_positions(edges, [disc.at for disc in rotor.discs])
    inertias = station_inertias(rotor, nodes)
    span = np.clip(np.searchsorted(edges, 0.5 * (nodes[1:] + nodes[:-1])) - 1, 0, edges.size - 2)
    left, width, kind = edges[span], np.diff(edges)[span], profile.section_of_span[span]
    start, end = (nodes[:-1] - left) / width, (nodes[1:] - left) / width
    lengths = np.where((start == 0.0) & (end == 1.0), profile.lengths[span], np.diff(nodes))
    first = np.ones(kind.size, dtype=np.bool_)
    first[1:] = (kind[1:] != kind[:-1]) | ~profile.uniform[kind[1:]] | inertias[1:-1].any(axis=1)
    if first.all():
        return ShaftSpans(nodes, kind, start, end, lengths, inertias)
    index = np.flatnonzero(first)
    node_index = np.append(index, nodes.size - 1)
    tapers = ~profile.uniform[kind[index]]
    return ShaftSpans(
        nodes=nodes[node_index],
        kind=kind[index],
        start=np.where(tapers, start[index], 0.0),
        end=np.where(tapers, end[index], 1.0),
        lengths=np.add.reduceat(lengths, index),
        inertias=inertias[node_index],
    )


def station_inertias(rotor: Rotor, stations: FloatArray) -> FloatArray:
    """Lumped inertias at the stations (Myklestad–Prohl).

    They sum the discs, and half of a coupling at each of its ends. In the lumped model each segment also gives
    its own inertia to its two ends: mass in the shares that keep its centre of mass where it is, polar inertia in
    those that keep its centre, and the diametral inertia about its own centre of mass,
    I_p/2 + m l²/12 of a cylinder, as the mass. A cylinder is thus halved; in the seven-station table of the
    RAPPID example this rule gives the printed 0.020568 kg·m² at a plain station and 0.010284 kg·m² at an end.

    Parameters
    ----------
    rotor : Rotor
        The rotor.
    stations : ndarray, shape (s,)
        Positions that include at least the rotor's segment ends and discs [m].

    Returns
    -------
    ndarray, shape (s, 3)
        Mass [kg], diametral and polar moment of inertia [kg·m²].
    """
    inertias = np.zeros((stations.size, 3))
    for disc in rotor.discs:
        inertias[station_index(stations, disc.at)] += disc.mass, disc.diametral_inertia, disc.polar_inertia
    # Joints are stations to the last digit.
    ends = np.searchsorted(stations, rotor.joints).tolist()
    for part, left, right in zip(rotor.segments, ends[:-1], ends[1:], strict=True):
        if rotor.mass_model == "lumped" or isinstance(part, Coupling):
            segment_inertias = np.array([part.mass, part.diametral_inertia, part.polar_inertia])
            centres = np.array([part.mass_centre, part.mass_centre, part.polar_centre])
            to_right = segment_inertias * (centres / part.length)
            inertias[left] += segment_inertias - to_right
            inertias[right] += to_right
    return inertias
