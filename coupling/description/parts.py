"""Parts of a machine: shafts, gears on shafts, excitation; and checks of their names, stations and seats."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from math import cos, hypot, pi, sin
from typing import Any, Protocol

import numpy as np

from gearwhine.coupling.description.arrangement import SeatPlace, pedestal_finding, pin_findings, seat_findings
from gearwhine.coupling.description.gear_train import LARGEST_OFFSET, GearTrain, GivenSpeed, Output
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears import Gear
from gearwhine.coupling.gears.geometry.blank import CoreLength, blank_around
from gearwhine.coupling.gears.geometry.toothed_section import bare_lengths, toothed_section
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.gears.stiffness.beam import shear_modulus
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.coupling.machine.loads import ShaftForce
from gearwhine.coupling.machine.mounted_parts import MountedBearing
from gearwhine.coupling.machine.pins import Pin, PinBeam, PinSprings
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import (
    Finding,
    Instance,
    Number,
    Numbers,
    Part,
    Rule,
    Text,
    attribute_findings,
    in_mm,
    kind_findings,
    refuse,
)
from gearwhine.numerics.names import twin_of
from gearwhine.numerics.own_copies import keep_tuples, unchecked
from gearwhine.rotors import Disc, Rotor, Segment
from gearwhine.rotors import Unbalance as ShaftUnbalance
from gearwhine.rotors.model.loads import Bow
from gearwhine.rotors.model.profile import StiffnessDiameter
from gearwhine.rotors.model.shaft import inertia_findings

LATERAL_LIMIT_HZ = 8000.0
"""Highest natural frequency of the retained bending modes of a shaft without a limit of its own [Hz]."""

SHAFT_DAMPING_RATIO = 0.005
"""Modal damping ratio of a shaft without one of its own, after Lin, Huston and Coy (1988)."""

_SAME_STATION = 1e-6  # part of the rotor's length


@dataclass(frozen=True)
class Shaft:
    """A rotor on its axis in the machine, without its gears.

    Attributes
    ----------
    rotor : gearwhine.rotors.Rotor
        Rotor, whose name is the shaft's name.
    axis : tuple of float
        x and y of the shaft's line [m].
    start : float
        z of the left end [m].
    damping_ratio : float
        Modal damping ratio of the shaft's own material and fits, on every mode of the free shaft; 0.005 by default.
    unbalances : sequence of gearwhine.rotors.Unbalance
    bow : gearwhine.rotors.Bow, optional
    frequency_limit : float, optional
        Highest natural frequency of the retained bending modes [rad/s]; higher modes respond statically. 8 kHz by
        default.
    mode_count : int, optional
        Number of retained modes of each kind, in place of the limit.
    carrier : str, optional
        Name of the shaft with which the axis of this one turns, as that of a planet with its carrier; ``axis`` is its
        place at t = 0. None: the axis stands still.
    rim_seat : str, optional
        Seat of the housing, with ``ring_orders``, whose bore the rim of the ring gear on this shaft follows as it
        deforms; by default the rim moves as one body with the shaft.
    pin_error : tuple of float
        Offset of a planet's pin from ``axis``, away from the carrier's axis and counter-clockwise about it [m].
    pin : PinBeam or PinSprings, optional
        Elastic pin of a planet, on which its bearings sit; by default it is rigid.
    internal_damping : float
        Viscous damping of the shaft over its stiffness, which rotates with it [s].
    """

    rotor: Rotor
    axis: tuple[float, float] = (0.0, 0.0)
    start: float = 0.0
    damping_ratio: float = SHAFT_DAMPING_RATIO
    unbalances: Sequence[ShaftUnbalance] = ()
    bow: Bow | None = None
    frequency_limit: float | None = None
    mode_count: int | None = None
    carrier: str | None = None
    pin_error: tuple[float, float] = (0.0, 0.0)
    rim_seat: str | None = None
    pin: Pin | None = None
    internal_damping: float = 0.0

    def __post_init__(self) -> None:
        """Keep own copies, and check every number."""
        keep_tuples(self, "axis", "unbalances", "pin_error")
        kind = Instance(Rotor, "a rotor")
        refuse(attribute_findings(("shaft", ""), self, rotor=kind), CouplingError)
        rules: dict[str, Rule] = {
            "axis": Numbers(2),
            "start": Number(unit="m"),
            "damping_ratio": Number(at_least=0.0, below=1.0),
            "internal_damping": Number(at_least=0.0, at_most=1e-2, unit="s"),
            "frequency_limit": Number(above=0.0, optional=True, unit="rad/s"),
            "mode_count": Number(at_least=1, optional=True, whole=True),
            "bow": Instance(Bow, "a bow, or None", optional=True),
            "carrier": Text(optional=True),
            "pin_error": Numbers(2),
            "rim_seat": Text(optional=True),
            "pin": Instance((PinBeam, PinSprings), "a pin by its beam or its springs, or None", optional=True),
        }
        part = ("shaft", self.name)
        if not self.name:
            refuse([Finding(part, "rotor", None, "a rotor with a name")], CouplingError)
        kinds = kind_findings(part, self, unbalances=ShaftUnbalance)
        refuse([*attribute_findings(part, self, **rules), *kinds], CouplingError)
        refuse(self._station_findings(), CouplingError)
        bores = [segment.inner_diameter for segment in self.rotor.segments if isinstance(segment, Segment)]
        thickness = self.pin.diameter if isinstance(self.pin, PinBeam) else 0.0
        pin = None if self.pin is None else thickness
        refuse(pin_findings(part, self.carrier, self.pin_error, pin, bores), CouplingError)

    def _station_findings(self) -> Iterator[Finding]:
        """Yield unbalances and points of a bow beyond the ends of the rotor, and a bow that bends nothing."""
        part = ("shaft", self.name)
        for number, unbalance in enumerate(self.unbalances):
            yield from self.rotor.station_findings(part, f"unbalance.{number}.at", unbalance.at)
        if self.bow is not None:
            at = self.bow.at.tolist()
            for number, place in enumerate(at):
                yield from self.rotor.station_findings(part, f"bow.{number}.at", place)
            yield from bow_findings(part, at, self.rotor.length)

    @property
    def name(self) -> str:
        """Name of the rotor."""
        return self.rotor.name

    @property
    def mode_limit(self) -> float:
        """Limit of the retained modes [rad/s]: its own, or the default."""
        return 2.0 * pi * LATERAL_LIMIT_HZ if self.frequency_limit is None else self.frequency_limit


NEAREST_POINTS = 1e-6
"""Distance between two points of a bow below which they are one, as a part of the rotor's length."""


def bow_findings(part: Part, at: Sequence[float], length: float) -> Iterator[Finding]:
    """Yield a bow of one point, which bends nothing, and points of a bow where another one stands already [m]."""
    if len(at) == 1:
        expected = (
            "two points or more: the centre line through one is straight and bends no shaft; add the points that stay "
            "on the axis, such as the bearings', with an amplitude of 0"
        )
        yield Finding(part, "bow", None, expected)
    for place, point in enumerate(at):
        if any(abs(point - other) <= NEAREST_POINTS * length for other in at[:place]):
            yield Finding(part, f"bow.{place}.at", point, "a station of its own; another point of the bow is here")


@dataclass(frozen=True)
class ShaftGear:
    """A gear on a shaft.

    Attributes
    ----------
    gear : gearwhine.coupling.gears.Gear
    shaft : str
        Name of the shaft.
    at : float
        Distance of the middle of the face from the shaft's left end [m].
    inertia : tuple of float, optional
        Mass [kg], polar and diametral moment of inertia [kg m²], in place of those of the gear's geometry; zeros where
        a disc of the rotor stands for the gear. By default the mass of a gear without a bore is what lies outside its
        shaft.
    stiffens_shaft : bool
        Whether the shaft bends, twists and stretches under the gear as in one piece with it
        (`gearwhine.coupling.gears.geometry.toothed_section`); else the gear is a disc on one section of it. A gear with
        a rim is one always.
    """

    gear: Gear
    shaft: str
    at: float
    inertia: tuple[float, float, float] | None = None
    stiffens_shaft: bool = True

    def __post_init__(self) -> None:
        """Keep own copies, and check place and inertia."""
        keep_tuples(self, "inertia")
        refuse(attribute_findings(("shaft gear", ""), self, gear=Instance(Gear, "a gear")), CouplingError)
        rules: dict[str, Rule] = {
            "shaft": Text(),
            "at": Number(at_least=0.0, unit="m"),
            "stiffens_shaft": Instance(bool, "true or false"),
        }
        if self.inertia is not None:
            rules["inertia"] = Numbers(3, Number(at_least=0.0))
        findings = [*attribute_findings(("gear", self.name), self, **rules)]
        if self.inertia is not None and not findings:
            findings += [
                replace(finding, part=("gear", self.name), attribute="inertia")
                for finding in inertia_findings(self.at, *self.inertia)
            ]
        refuse(findings, CouplingError)

    @property
    def name(self) -> str:
        """Name of the gear."""
        return self.gear.name

    @property
    def in_one_piece(self) -> bool:
        """Whether gear and shaft deform as one piece over the face; else the gear stands on one section."""
        return self.stiffens_shaft and self.gear.rim_thickness is None and not self.gear.is_internal

    @property
    def body_inertia(self) -> tuple[float, float, float]:
        """Mass [kg], polar and diametral moment of inertia [kg m²] of the gear's body, its core included."""
        return self.gear.inertia if self.inertia is None else self.inertia


@dataclass(frozen=True)
class SupportBolt:
    """A bolt, pin or bush of a torque support, on a circle about the shaft's axis.

    Attributes
    ----------
    radius : float
        Distance from the axis [m].
    angle : float
        Angle from x about the axis [rad].
    tangential, radial, axial : float
        Stiffness along the circle, outwards and along z [N/m].
    """

    radius: float
    angle: float
    tangential: float
    radial: float = 0.0
    axial: float = 0.0

    def __post_init__(self) -> None:
        """Check that all are numbers."""
        stiffness = Number(at_least=0.0, unit="N/m")
        rules: dict[str, Rule] = {
            "radius": Number(above=0.0, unit="m"),
            "angle": Number(unit="rad"),
            "tangential": Number(above=0.0, unit="N/m"),
            "radial": stiffness,
            "axial": stiffness,
        }
        refuse(attribute_findings(("support bolt", ""), self, **rules), CouplingError)

    @property
    def stiffness(self) -> FloatArray:
        """Stiffness radially, tangentially and axially, shape (3,) [N/m]."""
        return np.array([self.radial, self.tangential, self.axial])

    @property
    def motions(self) -> FloatArray:
        """Motion of the bolt outwards, along the circle and along z by that of the section, shape (3, 6).

        A section that moves by d and turns by θ moves its point p by d + θ × p.
        """
        c, s, r = cos(self.angle), sin(self.angle), self.radius
        return np.array([[c, s, 0, 0, 0, 0], [-s, c, 0, 0, 0, r], [0, 0, 1, r * s, -r * c, 0]], dtype=np.float64)


@dataclass(frozen=True)
class TorqueSupport:
    """A support that holds a shaft from turning, such as the spline or the bolts of a ring gear.

    A support by bolts holds the section in all directions in which they are stiff: unequal ones couple its rotation
    with its shift and tilt.

    Attributes
    ----------
    shaft : str
        Name of the shaft.
    at : float
        Distance from the shaft's left end [m].
    stiffness : float, optional
        Torque about z over rotation [N m/rad]; None: rigid, or that of the bolts.
    seat : str, optional
        Seat of the housing that takes the torque; None: the ground.
    damping_time : float
        Damping over stiffness [s].
    bolts : sequence of SupportBolt
        Bolts in place of a stiffness.
    """

    shaft: str
    at: float = 0.0
    stiffness: float | None = None
    seat: str | None = None
    damping_time: float = 0.0
    bolts: Sequence[SupportBolt] = ()

    def __post_init__(self) -> None:
        """Check every number; "ground", the word of a case, is no seat."""
        keep_tuples(self, "bolts")
        if self.seat == "ground":
            object.__setattr__(self, "seat", None)
        rules: dict[str, Rule] = {
            "shaft": Text(),
            "at": Number(at_least=0.0, unit="m"),
            "stiffness": Number(above=0.0, optional=True, unit="N m/rad"),
            "seat": Text(optional=True),
            "damping_time": Number(at_least=0.0, at_most=1e-2, unit="s"),
        }
        part = ("torque support", str(self.shaft))
        findings = [*attribute_findings(part, self, **rules), *kind_findings(part, self, bolts=SupportBolt)]
        if self.bolts and self.stiffness is not None:
            findings.append(Finding(part, "stiffness", self.stiffness, "none beside bolts, which have their own"))
        refuse(findings, CouplingError)

    @property
    def is_rigid(self) -> bool:
        """Whether it has neither a stiffness nor bolts."""
        return self.stiffness is None and not self.bolts

    @property
    def held_motions(self) -> list[int]:
        """Motions of the section that it resists, among x, y, z and the rotations about them (0 to 5)."""
        return list(range(6)) if self.bolts else [5]

    @property
    def stiffness_matrix(self) -> FloatArray:
        """Stiffness over these motions: Σ Bᵀ k B of the bolts' motions B."""
        if not self.bolts:
            return np.array([[self.stiffness or 0.0]])
        parts = [bolt.motions.T @ (bolt.stiffness[:, None] * bolt.motions) for bolt in self.bolts]
        return np.asarray(sum(parts), dtype=np.float64)


def bolted_rotors(supports: Iterable[TorqueSupport]) -> set[str]:
    """Names of the rotors that bolts hold, and not only their rotation."""
    return {support.shaft for support in supports if support.bolts}


class MachineParts(Protocol):
    """The lists of parts in a machine, see :class:`gearwhine.coupling.Machine`."""

    @property
    def shafts(self) -> Sequence[Shaft]:
        """Shafts of the machine."""
        ...

    @property
    def bearings(self) -> Sequence[MountedBearing]:
        """Bearings between shafts and seats, pedestals or the ground."""
        ...

    @property
    def gears(self) -> Sequence[ShaftGear]:
        """Gears on the shafts."""
        ...

    @property
    def gear_pairs(self) -> Sequence[GearPair]:
        """Gear pairs in mesh."""
        ...

    @property
    def outputs(self) -> Sequence[Output]:
        """Torques that leave the train."""
        ...

    @property
    def torque_at(self) -> float:
        """Position at which the driving torque enters [m]."""
        ...

    @property
    def forces(self) -> Sequence[ShaftForce]:
        """Constant forces on the shafts."""
        ...

    @property
    def torque_supports(self) -> Sequence[TorqueSupport]:
        """Supports that hold shafts from turning."""
        ...

    @property
    def given_speeds(self) -> Sequence[GivenSpeed]:
        """Speeds of further driven shafts."""
        ...

    @property
    def input_shaft(self) -> str | None:
        """Shaft at which the torque comes in; None: that of the first driver."""
        ...

    @property
    def train(self) -> GearTrain:
        """The gear train."""
        ...


def rotor_with_gears(rotor: Rotor, gears: Sequence[ShaftGear]) -> Rotor:
    """Rotor with the gears on it as discs, which stiffen it over their faces; one without inertias adds no disc."""
    return _rotor_with_gears(rotor, tuple(unchecked(gear, gear=gear.gear.sound) for gear in gears))


@lru_cache(maxsize=64)  # gears of one drawing differ in their flanks alone
def _rotor_with_gears(rotor: Rotor, gears: tuple[ShaftGear, ...]) -> Rotor:
    rigid = [gear_disc(gear, rotor) for gear in gears]
    discs = [disc for disc in rigid if disc.mass or disc.polar_inertia or disc.diametral_inertia]
    stiff = [diameter for gear in gears for diameter in _stiffness_diameters(gear, rotor)]
    return replace(rotor, discs=[*rotor.discs, *discs], stiffness_diameters=[*rotor.stiffness_diameters, *stiff])


def gear_disc(mounted: ShaftGear, rotor: Rotor) -> Disc:
    """Return the disc that a gear is on its rotor, at its centre of mass.

    An external gear without a bore is made from its shaft, which has the mass of the core: unless its inertia is given,
    the disc is the part of the blank outside the shaft.
    """
    if mounted.inertia is not None or mounted.gear.bore > 0.0 or mounted.gear.is_internal:
        return Disc(mounted.at, *mounted.body_inertia)
    blank = blank_around(mounted.gear, _shaft_under(mounted, rotor))
    return Disc(mounted.at + blank.centre, *blank.inertia)


def _shaft_under(mounted: ShaftGear, rotor: Rotor) -> Iterator[CoreLength]:
    """Yield the lengths of shaft under a gear's face, without radius beyond the shaft and where it has no mass."""
    at, half = mounted.at, 0.5 * mounted.gear.face_width
    joints = rotor.joints.tolist()
    yield CoreLength(-half, -at, 0.0, 0.0)
    for part, left, right in zip(rotor.segments, joints[:-1], joints[1:], strict=True):
        radii = 0.0, 0.0
        if isinstance(part, Segment) and part.material.density > 0.0:
            (start, _), (end, _) = part.end_diameters
            radii = 0.5 * start, 0.5 * end
        yield CoreLength(left - at, right - at, *radii)
    yield CoreLength(joints[-1] - at, half, 0.0, 0.0)


def carrying_length(mounted: ShaftGear, rotor: Rotor) -> tuple[float, float]:
    """Return the ends of the length of shaft that moves with a gear's body [m].

    The body is rigid beyond them, where the stress of the shaft has not spread into it. A disc moves with the section
    in the middle of its face.
    """
    if not mounted.in_one_piece:
        return mounted.at, mounted.at
    return _core(mounted, rotor)[0]


def _core(mounted: ShaftGear, rotor: Rotor) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the ends of the length over which a gear stiffens its shaft, in bending and in torsion [m]."""
    gear, half = mounted.gear, 0.5 * mounted.gear.face_width
    ends = max(mounted.at - half, 0.0), min(mounted.at + half, rotor.length)
    root = 2.0 * gear.root_circle_radius
    left, right = (bare_lengths(rotor.outer_diameter(end, mounted.at), root, gear.face_width) for end in ends)
    bending, torsion = ((ends[0] + a, ends[1] - b) for a, b in zip(left, right, strict=True))
    return bending, torsion


def _stiffness_diameters(mounted: ShaftGear, rotor: Rotor) -> list[StiffnessDiameter]:
    """Stiffness diameters of a gear on its shaft: root circle, and section with teeth, over their parts of the face.

    They have the gear's own moduli; of another material it is a sleeve that the shaft goes through.
    """
    if not mounted.in_one_piece:
        return []
    root, section = 2.0 * mounted.gear.root_circle_radius, toothed_section(mounted.gear)
    bending, torsion = _core(mounted, rotor)
    lengths = [
        (*bending, root, 0.0),
        (*torsion, 0.0, root),
        (bending[0] + section.end_length, bending[1] - section.end_length, section.bending_diameter, 0.0),
        (torsion[0] + section.end_length, torsion[1] - section.end_length, 0.0, section.torsion_diameter),
    ]
    moduli = mounted.gear.youngs_modulus, shear_modulus(mounted.gear)
    return [StiffnessDiameter(*one, *moduli) for one in lengths if one[0] < one[1]]


def gear_inertia_on_shaft(gear: ShaftGear, rotor: Rotor) -> tuple[float, float, float]:
    """Inertia of a gear's body beside that of its shaft: of its disc, or others there.

    Mass [kg], polar and diametral inertia [kg m²].
    """
    disc = gear_disc(gear, rotor)
    inertias = (disc.mass, disc.polar_inertia, disc.diametral_inertia)
    if any(inertias):
        return inertias
    there = _discs_at(gear, rotor)
    return (
        sum(one.mass for one in there),
        sum(one.polar_inertia for one in there),
        sum(one.diametral_inertia for one in there),
    )


def _discs_at(gear: ShaftGear, rotor: Rotor) -> list[Disc]:
    """Discs of the rotor at a gear's station."""
    return [disc for disc in rotor.discs if abs(disc.at - gear.at) < _SAME_STATION * rotor.length]


def inertia_with_discs(gear: ShaftGear, rotor: Rotor, gears: Sequence[ShaftGear]) -> float:
    """Polar inertia of a gear's body with the discs at its station [kg m²], for the damping ratio of its mesh.

    A gear without a bore counts with its core, which rotates with the teeth. Where gear and discs have no inertia, it
    is that of the whole rotor; where the rotor has none either, that of the gear's geometry.

    Parameters
    ----------
    gear : ShaftGear
    rotor : Rotor
        Rotor of the gear, without gears.
    gears : sequence of ShaftGear
        All gears on the rotor.
    """
    inertia = gear.body_inertia[1] + sum(disc.polar_inertia for disc in _discs_at(gear, rotor))
    if inertia == 0.0:
        inertia = rotor_with_gears(rotor, gears).polar_inertia
    return inertia if inertia > 0.0 else gear.gear.polar_inertia


def on_rigid_seats(
    shafts: Sequence[Shaft], bearings: Sequence[MountedBearing], torque_supports: Sequence[TorqueSupport]
) -> dict[str, Any]:
    """Return parts of a machine with rigid seats in place of those of a housing; bearings between shafts stay.

    They are the keywords ``shafts``, ``bearings`` and ``torque_supports`` of :class:`gearwhine.coupling.Machine`.
    """
    names = {shaft.name for shaft in shafts}
    return {
        "shafts": [shaft if shaft.rim_seat is None else replace(shaft, rim_seat=None) for shaft in shafts],
        "bearings": [one if one.seat in {None, *names} else replace(one, seat=None) for one in bearings],
        "torque_supports": [replace(support, seat=None) for support in torque_supports],
    }


def name_findings(machine: MachineParts) -> Iterator[Finding]:
    """Yield names given twice, unknown names, and gears that are a pair twice or on one shaft."""
    kinds: Mapping[str, Sequence[str]] = {
        "shaft": [shaft.name for shaft in machine.shafts],
        "gear": [gear.name for gear in machine.gears],
        "bearing": [mounted.bearing.name for mounted in machine.bearings],
    }
    whole: Part = ("machine", "")
    for kind, names in kinds.items():
        for name in sorted({name for name in names if names.count(name) > 1}):
            yield Finding((kind, name), "name", name, f"each name once; it is given {names.count(name)} times")
        for name in names:
            twin = twin_of(name, names)
            if twin is not None:
                expected = f"a name that does not look like {twin!r}: both are written with other characters"
                yield Finding((kind, name), "name", name, expected)
    if not machine.shafts:
        yield Finding(whole, "shafts", (), "at least one shaft")
    pairs: list[tuple[Part, GearPair]] = [
        (("gear pair", f"{pair.driver} -> {pair.driven}"), pair) for pair in machine.gear_pairs
    ]
    needed: list[tuple[Part, str, str, str]] = [
        (("bearing", mounted.bearing.name), "rotor", "shaft", mounted.rotor) for mounted in machine.bearings
    ]
    needed += [(("gear", gear.name), "shaft", "shaft", gear.shaft) for gear in machine.gears]
    needed += [(part, "driver", "gear", pair.driver) for part, pair in pairs]
    needed += [(part, "driven", "gear", pair.driven) for part, pair in pairs]
    needed += [(whole, f"outputs.{n}.shaft", "shaft", output.shaft) for n, output in enumerate(machine.outputs)]
    needed += [(whole, f"forces.{n}.rotor", "shaft", force.rotor) for n, force in enumerate(machine.forces)]
    needed += [
        (whole, f"torque_supports.{n}.shaft", "shaft", one.shaft) for n, one in enumerate(machine.torque_supports)
    ]
    needed += [(whole, f"given_speeds.{n}.shaft", "shaft", one.shaft) for n, one in enumerate(machine.given_speeds)]
    needed += [
        (("shaft", one.name), "carrier", "shaft", one.carrier) for one in machine.shafts if one.carrier is not None
    ]
    if machine.input_shaft is not None:
        needed.append((whole, "input_shaft", "shaft", machine.input_shaft))
    for part, attribute, kind, name in needed:
        if name not in kinds[kind]:
            named = ", ".join(map(repr, kinds[kind])) or "there is none"
            yield Finding(part, attribute, name, f"the name of a {kind} of this machine ({named})")
    shafts = {gear.name: gear.shaft for gear in machine.gears}
    for number, (part, pair) in enumerate(pairs):
        if any({pair.driver, pair.driven} == {other.driver, other.driven} for _, other in pairs[:number]):
            yield Finding(part, "", None, "gears that are not yet a pair; it is given twice")
        if shafts.get(pair.driver, pair.driver) == shafts.get(pair.driven, pair.driven):
            yield Finding(part, "driven", pair.driven, f'a gear on another rotor than "{shafts.get(pair.driver)}"')


def station_findings(machine: MachineParts) -> Iterator[Finding]:
    """Yield gears, bearings, torques and forces beyond the ends of their shafts."""
    rotors = {shaft.name: shaft.rotor for shaft in machine.shafts}
    stations: list[tuple[Part, str, str, float]] = []
    for gear in machine.gears:
        stations.append((("gear", gear.name), "at", gear.shaft, gear.at))
    for mounted in machine.bearings:
        stations.append((("bearing", mounted.bearing.name), "at", mounted.rotor, mounted.bearing.at))
    for place, output in enumerate(machine.outputs):
        if output.at is not None:
            stations.append((("machine", ""), f"outputs.{place}.at", output.shaft, output.at))
    for place, force in enumerate(machine.forces):
        stations.append((("machine", ""), f"forces.{place}.at", force.rotor, force.at))
    for place, support in enumerate(machine.torque_supports):
        stations.append((("machine", ""), f"torque_supports.{place}.at", support.shaft, support.at))
    for place, drive in enumerate(machine.given_speeds):
        if drive.at is not None:
            stations.append((("machine", ""), f"given_speeds.{place}.at", drive.shaft, drive.at))
    if machine.gear_pairs:
        stations.append((("machine", ""), "torque_at", machine.train.first, machine.torque_at))
    for part, attribute, shaft, at in stations:
        yield from rotors[shaft].station_findings(part, attribute, at)


def carrier_findings(machine: MachineParts) -> Iterator[Finding]:
    """Yield planets whose carrier cannot carry them or that have no bearing, and meshes that a carrier pulls apart."""
    shafts = {shaft.name: shaft for shaft in machine.shafts}
    shaft_of = {gear.name: shafts[gear.shaft] for gear in machine.gears}
    planets = [shaft for shaft in machine.shafts if shaft.carrier is not None]
    for planet in planets:
        part, carrier = ("shaft", planet.name), shafts[planet.carrier or ""]
        if carrier is planet or carrier.carrier is not None:
            fixed = ", ".join(repr(name) for name, one in shafts.items() if one.carrier is None) or "there is none"
            expected = f"a shaft whose own axis stands still ({fixed})"
            yield Finding(part, "carrier", planet.carrier, expected)
        if not any(mounted.rotor == planet.name for mounted in machine.bearings):
            expected = f'a bearing on its pin, a MountedBearing with rotor "{planet.name}" and seat "{carrier.name}"'
            yield Finding(part, "carrier", planet.carrier, expected)
    for place, support in enumerate(machine.torque_supports):
        if shafts[support.shaft].carrier is not None:
            expected = f'a shaft whose axis stands still, such as its carrier "{shafts[support.shaft].carrier}"'
            yield Finding(("machine", ""), f"torque_supports.{place}.shaft", support.shaft, expected)
    for pair in machine.gear_pairs:
        part = ("gear pair", f"{pair.driver} -> {pair.driven}")
        sides = shaft_of[pair.driver], shaft_of[pair.driven]
        carriers = {side.carrier for side in sides} - {None}
        if len(carriers) > 1:
            names = " and ".join(f'"{side.carrier}"' for side in sides)
            yield Finding(part, "driven", pair.driven, f"planets of one carrier; their axes turn with {names}")
        for side, carrier in ((side, shafts[name or ""]) for side in sides for name in carriers):
            apart = hypot(side.axis[0] - carrier.axis[0], side.axis[1] - carrier.axis[1])
            if side.carrier is None and apart > LARGEST_OFFSET:
                expected = (
                    f'an axis on that of carrier "{carrier.name}", about which its planets turn; it is {in_mm(apart)} '
                    "off it"
                )
                yield Finding(("shaft", side.name), "axis", side.axis, expected)


def rim_findings(
    shaft: Shaft, gears: Sequence[ShaftGear], rings: Mapping[str, int], meshing: Iterable[frozenset[str]]
) -> Iterator[Finding]:
    """Yield a seat for the rim of a ring gear that has no bore to follow, and rims and seats that miss each other.

    The mean forces of N equal planets at equal angles add up in the orders N, 2 N, … around the ring and cancel in all
    others, so that a bore of fewer orders does not deform under them. Harmonics of the meshes drive the others, too.

    Parameters
    ----------
    shaft : Shaft
    gears : sequence of ShaftGear
        Gears on it.
    rings : mapping of str to int
        Highest order of each seat of the housing with ``ring_orders``.
    meshing : iterable of frozenset of str
        Both gears of each pair.
    """
    part, seat = ("shaft", shaft.name), shaft.rim_seat
    inside = [mounted.name for mounted in gears if mounted.gear.is_internal]
    planets = sum(not pair.isdisjoint(inside) for pair in meshing)
    if seat is not None and rings.get(seat, planets) < planets:
        expected = (
            f"a seat with ring_orders of {planets} or more, such as {2 * planets}: the mean load of {planets} equal "
            f"planets deforms a ring in {planets}, {2 * planets}, … waves, which are left out with {rings[seat]}"
        )
        yield Finding(part, "rim_seat", seat, expected, "warning")
    if seat is not None and seat not in rings:
        names = ", ".join(map(repr, rings)) or "none"
        expected = f"a seat of the housing with ring_orders of 1 or more, one of {names}, or none for a rigid rim"
        yield Finding(part, "rim_seat", seat, expected)
    if seat is not None and not inside:
        yield Finding(part, "rim_seat", seat, "none: no ring gear on this shaft, whose rim would follow the bore")
    for mounted in gears:
        support = mounted.gear.ring_support
        if support is None:
            continue
        if seat is not None and support.kind in ("springs", "bolts", "pins"):
            expected = f'a ring_support of the housing, as the rim follows the bore of "{seat}"'
            yield Finding(("gear", mounted.name), "ring_support", support.kind, expected)
        if seat is None and support.kind == "housing":
            expected = (
                f'a rim_seat of "{shaft.name}", the seat whose bore the rim is to follow; without one the '
                "outside of the ring is clamped to its shaft, and the bore's deformation is left out"
            )
            yield Finding(("gear", mounted.name), "ring_support", support.kind, expected, "warning")


def bearing_findings(machine: MachineParts, housing: HousingComponent | None) -> Iterator[Finding]:
    """Yield bearings and supports in seats that the housing does not have or that they miss, and pedestals in seats.

    A planet's bearings sit on its carrier.
    """
    seats = () if housing is None else tuple(housing.seats)
    expected = (
        f"a seat of the housing, one of {', '.join(map(repr, seats))}, or None for the ground"
        if seats
        else "None for the ground, since no housing of the machine has a seat"
    )
    for number, support in enumerate(machine.torque_supports):
        if support.seat is not None and support.seat not in seats:
            yield Finding(("machine", ""), f"torque_supports.{number}.seat", support.seat, expected)
    shafts = {shaft.name: shaft for shaft in machine.shafts}
    for mounted in machine.bearings:
        part, seat, shaft = ("bearing", mounted.bearing.name), mounted.seat, shafts[mounted.rotor]
        if shaft.carrier is not None:
            where = f'on the carrier, seat None or "{shaft.carrier}", since the axis of "{shaft.name}" turns with it'
            if seat not in (None, shaft.carrier):
                yield Finding(part, "seat", seat, f"a bearing {where}")
            if mounted.bearing.pedestal is not None:
                yield Finding(part, "pedestal", None, f"no pedestal under a bearing {where}")
            continue
        if seat is None:
            continue
        if mounted.bearing.pedestal is not None:
            yield pedestal_finding(part, seat, None)
        if seat in shafts:
            yield from _coaxial_findings(part, shaft, shafts[seat])
            continue
        if housing is None or seat not in seats:
            yield Finding(part, "seat", seat, expected)
        elif seat in housing.seat_axes:
            place = SeatPlace(seat, (*housing.seat_axes[seat], housing.seat_z[seat]), housing.seat_reach.get(seat))
            yield from seat_findings(part, shaft.name, shaft.axis, shaft.start, mounted.bearing.at, place)


def _coaxial_findings(part: Part, shaft: Shaft, around: Shaft) -> Iterator[Finding]:
    """Yield a bearing between a shaft and itself, or one that is not on its axis or turns with another carrier."""
    offset = hypot(*(a - b for a, b in zip(shaft.axis, around.axis, strict=True)))
    if shaft is around or offset > LARGEST_OFFSET or around.carrier is not None:
        expected = (
            f'another shaft on the axis of "{shaft.name}"; the axis of "{around.name}" is {in_mm(offset)} off it'
            if shaft is not around and around.carrier is None
            else f'another shaft on the axis of "{shaft.name}" that is no planet'
        )
        yield Finding(part, "seat", around.name, expected)
