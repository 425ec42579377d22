"""Planetary sets: assembly condition, clearance of neighbouring planets, mesh phasing, members with their power.

A set is named over parts that stand in the machine: its sun and ring are gears on shafts about the axis of a carrier,
its planets gears on shafts whose axes turn with the carrier (`Shaft.carrier`). Planets in mesh with each other, as of
double planets, are one group; the groups are alike and stand around the axis.

**Assembly.** With sun and ring at rest a turn θ of the carrier takes a group to the place of the next one. The sun
turns its last planet by ρ_s θ, the ring by ρ_r θ; teeth of both fit where (ρ_s - ρ_r) θ is a whole number of the
steps g in which that planet may be set, g the greatest common divisor of one pitch at each of its meshes. So

    θ = 2π n / E,        E = |ρ_s - ρ_r| 2π / g,

which is E = z_s + |z_r| of a simple set, |z_r| - z_s of double planets, (z_s z_p2 + |z_r| z_p1) / gcd(z_p1, z_p2) of
stepped planets in one piece (Müller, Die Umlaufgetriebe, 1998).

**Phasing.** The meshes of the group at ψ are by z ψ / 2π mesh periods behind those of the group at 0 where the central
gear, of z teeth, turns counter-clockwise as the carrier sees it, and before them else (Parker & Lin, Mesh phasing
relationships in planetary and epicyclic gears, J. Mech. Des. 126 (2004) 365, Eqs. 2 to 4). The l-th mesh harmonics add
up to a torque where Σ exp(2πi l p) is not 0, to a force where Σ exp(2πi l p ± i ψ) is not: where both vanish, only
planet modes are excited (Parker, J. Sound Vib. 236 (2000) 561).
"""

import cmath
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, reduce
from itertools import pairwise
from typing import Literal, Protocol

from gearwhine.coupling.description.gear_train import LARGEST_MISFIT, LARGEST_OFFSET, GearTrain
from gearwhine.coupling.description.parts import Shaft, ShaftGear
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears import Gear, GearError, GearPairGeometry
from gearwhine.coupling.machine.mounted_parts import MountedBearing
from gearwhine.numerics.findings import (
    Finding,
    Part,
    Rule,
    Text,
    attribute_findings,
    in_mm,
    refuse,
)
from gearwhine.numerics.own_copies import keep_tuples

_SUPPRESSED = 1e-6  # sum of the mesh harmonics over that in phase, below which phasing cancels them
_MOST_PLANETS = 12  # of suggestions


@dataclass(frozen=True)
class PlanetarySet:
    """A planetary set, by the names of its parts in the machine.

    Attributes
    ----------
    name : str
    planets : sequence of str
        Gears of the planets: those in mesh with sun or ring, of stepped planets both gears of each.
    carrier : str
        Shaft of the carrier.
    sun, ring : str, optional
        Gears; a set may lack one, as one of two sets that share their planets.
    """

    name: str
    planets: Sequence[str]
    carrier: str
    sun: str | None = None
    ring: str | None = None

    def __post_init__(self) -> None:
        """Keep an own copy of the names, and check that they are such."""
        keep_tuples(self, "planets")
        text, optional = Text(), Text(optional=True)
        rules: dict[str, Rule] = {"name": text, "carrier": text, "sun": optional, "ring": optional}
        part = ("planetary set", str(self.name))
        findings = [*attribute_findings(part, self, **rules)]
        if not self.planets or not isinstance(self.planets, tuple) or not all(map(text.accepts, self.planets)):
            findings.append(Finding(part, "planets", self.planets, "names of gears, one or more"))
        if self.sun is None and self.ring is None:
            findings.append(Finding(part, "sun", None, "a sun or a ring, or both"))
        refuse(findings, CouplingError)

    @property
    def gears(self) -> tuple[str, ...]:
        """Names of all gears: sun, planets, ring."""
        return tuple(name for name in (self.sun, *self.planets, self.ring) if name is not None)


class MeshingPair(Protocol):
    """Two gears in mesh, by name."""

    @property
    def driver(self) -> str:
        """Name of the driver."""
        ...

    @property
    def driven(self) -> str:
        """Name of the driven gear."""
        ...


class PlanetaryParts(Protocol):
    """The parts of a machine among which planetary sets stand, see :class:`gearwhine.coupling.Machine`."""

    @property
    def shafts(self) -> Sequence[Shaft]:
        """Shafts of the machine."""
        ...

    @property
    def gears(self) -> Sequence[ShaftGear]:
        """Gears on the shafts."""
        ...

    @property
    def gear_pairs(self) -> Sequence[MeshingPair]:
        """Gear pairs in mesh."""
        ...

    @property
    def bearings(self) -> Sequence[MountedBearing]:
        """Bearings of the shafts."""
        ...


@dataclass(frozen=True)
class SetParts:
    """Parts of planetary sets where there is no machine yet, see :class:`PlanetaryParts`."""

    shafts: Sequence[Shaft]
    gears: Sequence[ShaftGear]
    gear_pairs: Sequence[MeshingPair]
    bearings: Sequence[MountedBearing]


@dataclass(frozen=True)
class PlanetGroup:
    """Planets in mesh with each other, or one alone, at their place around the carrier's axis.

    Attributes
    ----------
    shafts : tuple of str
        Shafts from the sun outward, of a set without a sun from the ring inward.
    angle : float
        Angle of the first shaft about the carrier's axis from x, from 0 to 2π [rad].
    shape : tuple of (float, float)
        Distance of each shaft from the carrier's axis [m], and angle from the first one [rad].
    """

    shafts: tuple[str, ...]
    angle: float
    shape: tuple[tuple[float, float], ...]

    def is_like(self, other: "PlanetGroup") -> bool:
        """Whether two groups are alike but for their angle."""
        return len(self.shape) == len(other.shape) and all(
            math.dist((a * math.cos(b), a * math.sin(b)), (c * math.cos(d), c * math.sin(d))) <= LARGEST_OFFSET
            for (a, b), (c, d) in zip(self.shape, other.shape, strict=True)
        )


@dataclass(frozen=True)
class SetMesh:
    """A mesh of a planetary set.

    Attributes
    ----------
    driver, driven : str
        Names of the gears.
    kind : {"sun", "ring", "planets"}
        What the planet meshes with.
    group : int
        Number of the group of planets, from 0.
    number : int
        Number of the pair in the machine.
    teeth : tuple of int
    """

    driver: str
    driven: str
    kind: Literal["sun", "ring", "planets"]
    group: int
    number: int
    teeth: tuple[int, int]

    @property
    def common_factor(self) -> int:
        """Greatest common divisor of the teeth: 1 of hunting teeth, of which each meets each of the other gear."""
        return math.gcd(*self.teeth)


@dataclass(frozen=True)
class Clearance:
    """Gap between the tip circles of gears on two planets [m]; negative where they stand in each other."""

    gears: tuple[str, str]
    gap: float


@dataclass(frozen=True)
class SetMember:
    """A member of a planetary set in operation.

    Attributes
    ----------
    role : str
        "sun", "ring", "carrier" or "planet".
    shaft : str
    speed, relative_speed : float
        Signed speed [rad/s], and that relative to the carrier.
    torque : float
        Torque about z from outside the set that balances its meshes on the member [N m].
    state : {"driving", "driven", "held", "free"}
        Whether power comes in by the member, leaves it, it is held, or it has neither power nor support.
    """

    role: str
    shaft: str
    speed: float
    relative_speed: float
    torque: float
    state: Literal["driving", "driven", "held", "free"]

    @property
    def power(self) -> float:
        """Power that enters the set by the member [W]."""
        return self.torque * self.speed + 0.0

    @property
    def rolling_power(self) -> float:
        """Part of the power that enters through meshes, as the carrier sees it; the rest turns with the carrier [W]."""
        return self.torque * self.relative_speed + 0.0


@dataclass(frozen=True)
class PlacedSet:
    """A planetary set with its gears at their places.

    Attributes
    ----------
    of : PlanetarySet
    gears : mapping of str to Gear
    shafts : mapping of str to str
        Shaft of each gear.
    places : mapping of str to (float, float)
        Place of each planet's axis from the carrier's, x and y [m].
    middles : mapping of str to float
        z of the middle of each gear's face [m].
    meshes : tuple of SetMesh
    groups : tuple of PlanetGroup
        In the order in which their gears are named.
    """

    of: PlanetarySet
    gears: Mapping[str, Gear]
    shafts: Mapping[str, str]
    places: Mapping[str, tuple[float, float]]
    middles: Mapping[str, float]
    meshes: tuple[SetMesh, ...]
    groups: tuple[PlanetGroup, ...]

    @property
    def planet_shafts(self) -> tuple[str, ...]:
        """Shafts of the planets, in the order in which their gears are named."""
        return tuple(dict.fromkeys(self.shafts[name] for name in self.of.planets))

    @property
    def angles(self) -> tuple[float, ...]:
        """Angle of each group about the carrier's axis from x [rad]."""
        return tuple(group.angle for group in self.groups)

    def angle_from_first(self, group: int) -> float:
        """Angle of a group from that of the first one, from 0 to 2π [rad]."""
        return (self.groups[group].angle - self.groups[0].angle) % (2.0 * math.pi)

    @property
    def is_evenly_spaced(self) -> bool:
        """Whether the groups stand at equal angles."""
        count = len(self.groups)
        angles = sorted(self.angle_from_first(number) for number in range(count))
        return all(
            abs(angle - 2.0 * math.pi * n / count) * self._reach <= LARGEST_OFFSET for n, angle in enumerate(angles)
        )

    @property
    def _reach(self) -> float:
        return max(math.hypot(*place) for place in self.places.values())

    # ------------------------------------------------------------------ assembly

    def chain(self, group: int) -> list[tuple[str, str]]:
        """Meshes on the way from sun to ring through a group, two gears each; empty where there is none."""
        if self.of.sun is None or self.of.ring is None:
            return []
        edges = [(mesh.driver, mesh.driven) for mesh in self.meshes if mesh.group == group]
        edges += [(second, first) for first, second in edges]
        ways: list[list[tuple[str, str]]] = [[edge] for edge in edges if edge[0] == self.of.sun]
        while ways:
            way = ways.pop(0)
            if way[-1][1] == self.of.ring:
                return way
            passed = {self.shafts[gear] for edge in way for gear in edge}
            here = self.shafts[way[-1][1]]
            ways += [
                [*way, edge] for edge in edges if self.shafts[edge[0]] == here and self.shafts[edge[1]] not in passed
            ]
        return []

    @cached_property
    def assembly_number(self) -> int | None:
        """Number E of angles at which groups in one piece can be put in; 0: at any.

        None where the set lacks sun or ring, or its groups are not alike: nothing closes, or mesh by mesh.
        """
        chain = self.chain(0)
        if not chain or not all(self.groups[0].is_like(group) for group in self.groups):
            return None
        teeth = [(self.gears[first].teeth, self.gears[second].teeth) for first, second in chain]
        if any(self._chain_teeth(number) != teeth for number in range(len(self.groups))):
            return None
        turned, step = Fraction(-1), Fraction(0)
        for first, second in teeth[:-1]:
            turned *= Fraction(-first, second)
            step = _common_divisor(step * Fraction(first, second), Fraction(1, second))
        last, ring = teeth[-1]
        step = _common_divisor(step, Fraction(1, last))
        return int(abs(turned - Fraction(ring, last)) / step)

    def _chain_teeth(self, group: int) -> list[tuple[int, int]]:
        return [(self.gears[first].teeth, self.gears[second].teeth) for first, second in self.chain(group)]

    @property
    def planets_in_one_piece(self) -> bool:
        """Whether a group meshes with sun and ring by the same gears, which no clocking of gears on a shaft can set."""
        chain = self.chain(0)
        return all(first[1] == second[0] for first, second in pairwise(chain))

    @cached_property
    def misfits(self) -> tuple[float, ...]:
        """Part of a step, from -0.5 to 0.5, by which each group misses the next angle at which it can be put in."""
        number = self.assembly_number
        if not number:
            return (0.0,) * len(self.groups)
        steps = [self.angle_from_first(group) * number / (2.0 * math.pi) for group in range(len(self.groups))]
        return tuple(round(step - round(step), 9) for step in steps)

    @property
    def can_be_assembled(self) -> bool:
        """Whether teeth of all groups in one piece fit sun and ring."""
        return all(abs(misfit) <= LARGEST_MISFIT for misfit in self.misfits)

    def nearest_angle(self, group: int) -> float:
        """Angle from the first group, nearest to that of a group, at which it can be put in [rad]."""
        number = self.assembly_number
        angle = self.angle_from_first(group)
        return 2.0 * math.pi * round(angle * number / (2.0 * math.pi)) / number if number else angle

    # ----------------------------------------------------------------- clearance

    @cached_property
    def clearances(self) -> tuple[Clearance, ...]:
        """Gaps between gears of different planets side by side that do not mesh, the least first."""
        meshing = {frozenset((mesh.driver, mesh.driven)) for mesh in self.meshes}
        found = []
        for place, first in enumerate(self.of.planets):
            for second in self.of.planets[place + 1 :]:
                shafts = self.shafts[first], self.shafts[second]
                one, other = self.gears[first], self.gears[second]
                along = abs(self.middles[first] - self.middles[second]) - 0.5 * (one.face_width + other.face_width)
                if shafts[0] == shafts[1] or frozenset((first, second)) in meshing or along >= 0.0:
                    continue
                apart = math.dist(self.places[shafts[0]], self.places[shafts[1]])
                found.append(Clearance((first, second), apart - one.tip_radius - other.tip_radius))
        return tuple(sorted(found, key=lambda one: round(one.gap, 9)))

    # ------------------------------------------------------------------- phasing

    def phases(self, kind: Literal["sun", "ring"], sense: int) -> tuple[float, ...]:
        """Phase of the mesh of each group with sun or ring over that of the first group [mesh periods], 0 to 1.

        Parameters
        ----------
        kind : {"sun", "ring"}
        sense : int
            Sense in which that gear turns relative to the carrier, 1 counter-clockwise or -1.

        Raises
        ------
        CouplingError
            Where kind or sense is another.
        """
        for argument, value, expected in (("kind", kind, ("sun", "ring")), ("sense", sense, (1, -1))):
            if value not in expected:
                raise CouplingError(f"phases: {argument} is {value!r}; expected {expected[0]!r} or {expected[1]!r}")
        name = self.of.sun if kind == "sun" else self.of.ring
        teeth = 0 if name is None else abs(self.gears[name].teeth)
        turns = [self.angle_from_first(group) / (2.0 * math.pi) for group in range(len(self.groups))]
        return tuple(part_of_period(-sense * teeth * turn) for turn in turns)

    def sense(self, kind: Literal["sun", "ring"], speeds: Mapping[str, float]) -> int:
        """Sense in which sun or ring turns relative to the carrier, 1 counter-clockwise or -1; 1 at rest.

        Parameters
        ----------
        kind : {"sun", "ring"}
        speeds : mapping of str to float
            Signed speed of each shaft [rad/s].
        """
        name = self.of.sun if kind == "sun" else self.of.ring
        relative = 0.0 if name is None else speeds[self.shafts[name]] - speeds[self.of.carrier]
        return -1 if relative < 0.0 else 1

    def excitation(self, harmonic: int, kind: Literal["sun", "ring"] | None = None) -> tuple[float, float]:
        """Sum of a mesh harmonic over equal groups, over that in phase: as a torque, and as a force across the axis.

        The first excites rotational modes, the second translational ones. Where both are 0 only planet modes are
        excited.
        """
        kind = kind or ("ring" if self.of.sun is None else "sun")
        count = len(self.groups)
        waves = [cmath.exp(2j * math.pi * harmonic * phase) for phase in self.phases(kind, 1)]
        around = [cmath.exp(1j * self.angle_from_first(group)) for group in range(count)]
        torque = abs(sum(waves)) / count
        force = max(abs(sum(w * a for w, a in zip(waves, (b**sign for b in around), strict=True))) for sign in (1, -1))
        return torque, force / count

    def suppressed(self, harmonic: int) -> tuple[str, ...]:
        """Kinds of modes that a mesh harmonic does not excite: "rotational", "translational"."""
        sums = zip(("rotational", "translational"), self.excitation(harmonic), strict=True)
        return tuple(kind for kind, value in sums if value <= _SUPPRESSED)

    # ------------------------------------------------------------------- members

    def members(self, train: GearTrain, pair_torques: Sequence[float], speed: float) -> tuple[SetMember, ...]:
        """Speed, torque and power of sun, ring, carrier and planets.

        Parameters
        ----------
        train : GearTrain
        pair_torques : sequence of float
            Mean torque that each pair of the machine takes from its driver [N m].
        speed : float
            Signed speed of the first driver's shaft [rad/s].
        """
        on_shafts = train.mesh_torques(pair_torques, speed)
        roles = [("sun", self.of.sun), ("ring", self.of.ring)]
        shafts = [(role, self.shafts[name]) for role, name in roles if name is not None]
        shafts += [("carrier", self.of.carrier), *(("planet", name) for name in self.planet_shafts)]
        carried, found = train.ratios[self.of.carrier], []
        largest = max(abs(value) for on in on_shafts for value in on.values()) if on_shafts else 0.0
        for role, shaft in shafts:
            ratio = train.ratios[shaft]
            torque = -sum(on_shafts[mesh.number].get(shaft, 0.0) for mesh in self.meshes)
            torque = torque if abs(torque) > 1e-12 * largest else 0.0
            turning, relative = speed * float(ratio), speed * float(ratio - carried)
            power = torque * turning
            state: Literal["driving", "driven", "held", "free"] = (
                "held" if shaft in train.held else "driving" if power > 0.0 else "driven" if power < 0.0 else "free"
            )
            found.append(SetMember(role, shaft, turning, relative, torque, state))
        return tuple(found)

    # ------------------------------------------------------------------ findings

    @property
    def _part(self) -> Part:
        return "planetary set", self.of.name

    def findings(self) -> Iterator[Finding]:
        """Yield planets that touch, a ring that does not fit around sun and planets, and teeth that do not fit."""
        touching = [clearance for clearance in self.clearances if clearance.gap <= 0.0]
        for clearance in touching[:1]:
            yield Finding(self._part, "planets", clearance.gears, self._room(clearance))
        yield from self._ring_findings()
        if not self.can_be_assembled:
            severity: Literal["error", "warning"] = "error" if self.planets_in_one_piece else "warning"
            yield Finding(self._part, "planets", None, self._fitting_angles(), severity)

    def _most_at_equal_angles(self, clearance: Clearance) -> int:
        """Largest number of planets at equal angles that two neighbours leave room for."""
        reach = max(math.hypot(*self.places[self.shafts[name]]) for name in clearance.gears)
        tip = max(self.gears[name].tip_radius for name in clearance.gears)
        return math.floor(math.pi / math.asin(tip / reach)) if tip < reach else 1

    def _room(self, clearance: Clearance) -> str:
        """Return what is expected of planets that touch."""
        first, second = (self.gears[name] for name in clearance.gears)
        places = [self.places[self.shafts[name]] for name in clearance.gears]
        reach, most = math.hypot(*places[0]), self._most_at_equal_angles(clearance)
        least = math.degrees(2.0 * math.asin(min((first.tip_radius + second.tip_radius) / (2.0 * reach), 1.0)))
        return (
            f"planets clear of each other: their axes are {in_mm(math.dist(*places))} apart, and their tip circles "
            f"need {in_mm(first.tip_radius + second.tip_radius)}; this many teeth leave room for {most} of them at "
            f"equal angles, or for neighbours {least:.4g} deg apart"
        )

    def _ring_findings(self) -> Iterator[Finding]:
        """Yield a ring that does not mesh with single planets at their places about the sun."""
        chain = self.chain(0)
        if len(chain) != 2 or not self.planets_in_one_piece:
            return
        sun, planet, ring = (self.gears[name] for name in (chain[0][0], chain[0][1], chain[1][1]))
        if ring.module != planet.module or ring.helix_angle != planet.helix_angle:
            return
        distance = math.hypot(*self.places[self.shafts[chain[0][1]]])
        try:
            GearPairGeometry(planet, ring, -distance)
        except GearError as error:
            around = sun.teeth + 2 * planet.teeth
            size = "smaller" if -ring.teeth < around else "larger"
            expected = (
                f"a ring around sun and planets, of {around} teeth (z_s + 2 z_p) or as few more or less as profile "
                f"shifts take up; it has {-ring.teeth}, {'as many' if -ring.teeth == around else size}: {error}"
            )
            yield Finding(self._part, "ring", self.of.ring, expected)

    def _fitting_angles(self) -> str:
        """Return what is expected of groups whose teeth do not fit."""
        number, count = self.assembly_number or 1, len(self.groups)
        angles = [math.degrees(self.nearest_angle(group)) for group in range(count)]
        listed = ", ".join(f"{angle:.6g}" for angle in angles)
        rule = f"planets at multiples of 360/{number} deg, as {listed} deg from the first"
        if len(set(angles)) < count or not self.is_evenly_spaced:
            other = ""
        else:
            most = min([_MOST_PLANETS, *(self._most_at_equal_angles(one) for one in self.clearances)])
            fitting = [n for n in range(2, most + 1) if number % n == 0 and n != count]
            near = sorted(fitting, key=lambda n: abs(n - count))[:2]
            counts = f", {' or '.join(map(str, near))} of them," if near else ""
            low, high = number % count, count - number % count
            other = (
                f"; at equal angles{counts} or teeth whose number E = {number} "
                f"({_number_formula(self._chain_teeth(0))}) is {number - low} or {number + high}"
            )
        misfit = max(map(abs, self.misfits))
        clocked = "" if self.planets_in_one_piece else "; or planets that differ in how their gears stand on each other"
        return f"{rule}{other}{clocked}; their teeth stand {misfit:.3f} of a step beside the gaps that they belong in"


def _number_formula(teeth: Sequence[tuple[int, int]]) -> str:
    return {2: "z_s + |z_r|", 3: "|z_r| - z_s"}.get(len(teeth), "of the teeth on the way from sun to ring")


def _common_divisor(first: Fraction, second: Fraction) -> Fraction:
    denominator = math.lcm(first.denominator, second.denominator)
    return Fraction(math.gcd(int(first * denominator), int(second * denominator)), denominator)


def part_of_period(phase: float) -> float:
    """Return a phase from 0 to 1 [periods], rounding about whole periods aside."""
    part = phase % 1.0
    return 0.0 if min(part, 1.0 - part) < 1e-9 else part


def placed_set(of: PlanetarySet, parts: PlanetaryParts) -> PlacedSet:
    """Find the parts of a set among those of a machine; :func:`set_findings` has checked names and carriers."""
    mounted = {gear.name: gear for gear in parts.gears if gear.name in of.gears}
    shafts = {shaft.name: shaft for shaft in parts.shafts}
    centre = shafts[of.carrier].axis
    places = {
        mounted[name].shaft: (
            shafts[mounted[name].shaft].axis[0] - centre[0],
            shafts[mounted[name].shaft].axis[1] - centre[1],
        )
        for name in of.planets
    }
    pairs = [
        (number, pair) for number, pair in enumerate(parts.gear_pairs) if {pair.driver, pair.driven} <= mounted.keys()
    ]
    linked = [{mounted[pair.driver].shaft, mounted[pair.driven].shaft} for _, pair in pairs]
    groups = [set[str]([name]) for name in places]
    for ends in linked:
        if ends <= places.keys():
            joined = [group for group in groups if group & ends]
            groups = [group for group in groups if not group & ends] + [reduce(set.union, joined)]
    groups.sort(key=lambda group: min(list(places).index(name) for name in group))
    central = mounted[of.sun or of.ring or ""].shaft
    first = {name for ends in linked if central in ends for name in ends}
    ordered = [
        sorted(group, key=lambda name: (name not in first, math.hypot(*places[name]), list(places).index(name)))
        for group in groups
    ]
    number_of = {name: number for number, group in enumerate(ordered) for name in group}
    meshes = []
    for number, pair in pairs:
        gears = pair.driver, pair.driven
        kind: Literal["sun", "ring", "planets"] = (
            "sun" if of.sun in gears else "ring" if of.ring in gears else "planets"
        )
        planet = next(name for name in gears if name in of.planets)
        teeth = mounted[pair.driver].gear.teeth, mounted[pair.driven].gear.teeth
        meshes.append(SetMesh(pair.driver, pair.driven, kind, number_of[mounted[planet].shaft], number, teeth))
    return PlacedSet(
        of,
        {name: gear.gear for name, gear in mounted.items()},
        {name: gear.shaft for name, gear in mounted.items()},
        places,
        {name: shafts[gear.shaft].start + gear.at for name, gear in mounted.items()},
        tuple(meshes),
        tuple(_group(names, places) for names in ordered),
    )


def _group(names: Sequence[str], places: Mapping[str, tuple[float, float]]) -> PlanetGroup:
    angles = [math.atan2(y, x) for x, y in (places[name] for name in names)]
    shape = [(math.hypot(*places[name]), angle - angles[0]) for name, angle in zip(names, angles, strict=True)]
    return PlanetGroup(tuple(names), angles[0] % (2.0 * math.pi), tuple(shape))


def set_findings(sets: Sequence[PlanetarySet], parts: PlanetaryParts) -> Iterator[Finding]:
    """Yield sets whose parts are not there or not such, and what :meth:`PlacedSet.findings` yields of the others."""
    for number, of in enumerate(sets):
        if any(of.name == other.name for other in sets[:number]):
            yield Finding(("planetary set", of.name), "name", of.name, "each name once")
        wrong = [*_part_findings(of, parts)]
        yield from wrong
        if not wrong:
            yield from placed_set(of, parts).findings()


def _part_findings(of: PlanetarySet, parts: PlanetaryParts) -> Iterator[Finding]:
    part = ("planetary set", of.name)
    shafts = {shaft.name: shaft for shaft in parts.shafts}
    gears = {gear.name: gear for gear in parts.gears}
    if of.carrier not in shafts:
        named = ", ".join(map(repr, shafts))
        yield Finding(part, "carrier", of.carrier, f"the name of a shaft of this machine ({named})")
        return
    unknown = [(name, role) for name, role in _roles(of) if name not in gears]
    for name, role in unknown:
        yield Finding(part, role, name, f"the name of a gear of this machine ({', '.join(map(repr, gears)) or 'none'})")
    if unknown:
        return
    for name, role in _roles(of):
        mounted = gears[name]
        carrier = shafts[mounted.shaft].carrier
        if role == "planets" and carrier != of.carrier:
            expected = f'a gear on a shaft with carrier "{of.carrier}"; that of shaft "{mounted.shaft}" is {carrier!r}'
            yield Finding(part, role, name, expected)
        elif role != "planets" and carrier is not None:
            yield Finding(
                part, role, name, f'a gear on a shaft of its own axis; "{mounted.shaft}" turns with "{carrier}"'
            )
        if (role == "ring") != mounted.gear.is_internal:
            kind = "an internal gear, of negative teeth" if role == "ring" else "an external gear, of positive teeth"
            yield Finding(part, role, name, f"{kind}; it has {mounted.gear.teeth}")
    meshing = [{pair.driver, pair.driven} for pair in parts.gear_pairs]
    for name in of.planets:
        others = set(of.gears) - {name}
        if not any(name in pair and pair & others for pair in meshing):
            expected = f"a gear in mesh with {' or '.join(map(repr, filter(None, (of.sun, of.ring))))}, by a gear pair"
            yield Finding(part, "planets", name, expected)
    central = {gears[name].shaft for name in (of.sun, of.ring) if name is not None} | {of.carrier}
    if not any(mounted.rotor in central for mounted in parts.bearings):
        names = ", ".join(repr(name) for name in sorted(central))
        yield Finding(part, "carrier", of.carrier, f"a bearing that locates it, or sun or ring: on one of {names}")


def _roles(of: PlanetarySet) -> list[tuple[str, str]]:
    central = [(name, role) for name, role in ((of.sun, "sun"), (of.ring, "ring")) if name is not None]
    return [*central, *((name, "planets") for name in of.planets)]
