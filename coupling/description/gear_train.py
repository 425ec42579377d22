"""Gear train: speed ratios, senses of rotation, power flow, mesh phases; checks that a train can exist.

Gears on parallel shafts roll without slip where ω₁ z₁ = -ω₂ z₂, z negative of an internal gear (ISO 21771); their
shafts are as far apart as the geometry of the pair says, and half of the narrower face or more meets the other one. A
train at constant speed takes as much power as it gives, Σ T ω = 0 over its shafts.

Gear pairs that share gears have related mesh phases. Each gear is fitted to its shaft so that the first pair it belongs
to begins a mesh period at t = 0. The phase of every further pair of the same gear follows from the gear's teeth: as
gears roll without slip, tooth 0 of driver and driven gear lie at angles that are linear in the pair's phase
(`gearwhine.coupling.gears.geometry.profile.meshing_rotations`), and an angle that is already known gives the phase.
Gears that close a loop must fit: where teeth would clash, they cannot be assembled.
"""

import math
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from math import hypot
from typing import Literal, NamedTuple

from gearwhine.coupling.description.train_matrix import GearedShafts as GearedShafts
from gearwhine.coupling.description.train_matrix import SpeedRows, connected_shafts, dependent_rows, least_flows
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears import Gear, GearPairGeometry
from gearwhine.coupling.gears.errors import InterferenceError, NoContactError
from gearwhine.coupling.gears.geometry.pair import (
    ToothNumbering,
    mesh_frequency,
    pair_label,
    signed_distance,
    turning_sense,
)
from gearwhine.coupling.gears.geometry.profile import meshing_rotations
from gearwhine.coupling.machine.coordinates import trains
from gearwhine.coupling.machine.loads import (
    AnyTorque,
    Ripple,
    Torque,
    TorqueOverTime,
    TorqueRipple,
    largest_torques,
)
from gearwhine.coupling.machine.mounted_parts import GearMesh
from gearwhine.numerics.findings import (
    Finding,
    Instance,
    Number,
    Part,
    Rule,
    Text,
    attribute_findings,
    kind_findings,
    refuse,
)
from gearwhine.numerics.own_copies import keep_tuples

LARGEST_OFFSET = 1e-6
"""Largest difference between the distance of two axes and the centre distance of the gears on them [m]."""

LARGEST_IMBALANCE = 0.01
"""Largest imbalance of the power of a train, relative."""

_RATIO_ROUNDING = 1e-9
_INTERNAL_SENSE = "an internal gear and its pinion turn the same way"
_NO_TORQUE = 1e-9  # part of the input torque below which the torque of a gear pair is rounding


EQUAL_MESHES = "equal meshes"
"""Origin of mean forces in a loop of pairs, which the torques alone do not fix: equal meshes would carry them."""


@dataclass(frozen=True)
class Contradiction:
    """A connection with which the shafts cannot turn.

    Attributes
    ----------
    pair : int or None
        Index of the gear pair; None where the speed that a shaft is given is at fault.
    shaft : str
        Shaft that would have to turn at two speeds.
    ratio, other : Fraction
        Speed of that shaft over that of the first driver by the other connections, and by this one.
    """

    pair: int | None
    shaft: str
    ratio: Fraction
    other: Fraction


@dataclass(frozen=True)
class Output:
    """Output torque of a train.

    Attributes
    ----------
    shaft : str
    torque : float, optional
        Torque against the rotation of the shaft [N m]; None: the outputs share the power equally.
    at : float, optional
        Distance from the shaft's left end [m]; None: the right end.
    over_time : TorqueOverTime, optional
        Torque taken off besides; its share of the input's where no output has one.
    ripple : sequence of Ripple
        Harmonic parts of the torque taken off.
    """

    shaft: str
    torque: float | None = None
    at: float | None = None
    over_time: TorqueOverTime | None = None
    ripple: Sequence[Ripple] = ()

    def __post_init__(self) -> None:
        """Keep own copies; check that torque and place are numbers."""
        keep_tuples(self, "ripple")
        place = Number(at_least=0.0, optional=True, unit="m")
        rules: dict[str, Rule] = {
            "shaft": Text(),
            "torque": Number(optional=True, unit="N m"),
            "at": place,
            "over_time": Instance(TorqueOverTime, "a TorqueOverTime, or None", optional=True),
        }
        part = ("output", str(self.shaft))
        findings = [*attribute_findings(part, self, **rules), *kind_findings(part, self, ripple=Ripple)]
        refuse(findings, CouplingError)


@dataclass(frozen=True)
class GivenSpeed:
    """Speed of a second driven shaft, as of a differential; its torque follows from the balance of the train.

    Attributes
    ----------
    shaft : str
    speed : float
        Signed speed about z [rad/s].
    at : float, optional
        Distance of its torque from the shaft's left end [m]; None: the right end.
    """

    shaft: str
    speed: float
    at: float | None = None

    def __post_init__(self) -> None:
        """Check that speed and place are numbers."""
        rules: dict[str, Rule] = {
            "shaft": Text(),
            "speed": Number(unit="rad/s"),
            "at": Number(at_least=0.0, optional=True, unit="m"),
        }
        refuse(attribute_findings(("given speed", str(self.shaft)), self, **rules), CouplingError)


@dataclass(frozen=True)
class GearTrain:
    """Gear train: pairs and the speed ratios that follow from them; see :func:`gear_train`.

    Attributes
    ----------
    pairs : tuple of GearedShafts
    ratios : mapping of str to Fraction
        Signed speed of each shaft over that of the first driver, which comes first; shafts whose speed does not follow
        are absent.
    contradictions : tuple of Contradiction
        Empty in a train that can turn.
    first : str
        Shaft of the first driver, at which the torque comes in.
    held : tuple of str
        Shafts that are held and stand still.
    planets : tuple of str
        Shafts whose axes turn with a carrier.
    given : tuple of str
        Further shafts whose speeds are given.
    open_shafts : tuple of str
        Connected shafts whose speeds do not follow.
    freedoms : int
        Degrees of freedom: number of speeds that have to be given.
    speed_shares : mapping of str to mapping
        Speed of each shaft in ``ratios`` as its sum over the speeds of the first driver and of ``given``.
    """

    pairs: tuple[GearedShafts, ...]
    ratios: Mapping[str, Fraction]
    contradictions: tuple[Contradiction, ...]
    first: str
    held: tuple[str, ...] = ()
    planets: tuple[str, ...] = ()
    given: tuple[str, ...] = ()
    open_shafts: tuple[str, ...] = ()
    freedoms: int = 1
    speed_shares: Mapping[str, Mapping[str, Fraction]] = field(default_factory=dict)

    @property
    def output_shafts(self) -> tuple[str, ...]:
        """Shafts that drive no other: the power leaves there unless outputs are given.

        A planet has no end to take power from, a shaft at rest none to give.
        """
        closed = {pair.driver for pair in self.pairs}.union(self.planets, self.given)
        if self.pairs:
            closed.add(self.first)
        return tuple(shaft for shaft, ratio in self.ratios.items() if shaft not in closed and ratio)

    @property
    def force_origins(self) -> tuple[str, ...]:
        """What the mean force of each pair follows from: the torques alone, or in a loop of pairs `EQUAL_MESHES`."""
        return tuple(EQUAL_MESHES if shares else "torques" for shares in self.shares_torque)

    @property
    def turns(self) -> bool:
        """Whether the speed of every connected shaft follows from the drives, and none is driven against another."""
        return not self.contradictions and not any(self.drive_problems())

    @cached_property
    def shares_torque(self) -> tuple[bool, ...]:
        """Whether the share of each pair is statically indeterminate: it is in a loop of pairs, as of a power split.

        Planets of a set are in loops through sun, ring and carrier.
        """
        balancing = self._balancing
        rows = [{shaft: value for shaft, value in pair.row.items() if shaft in balancing} for pair in self.pairs]
        return dependent_rows(rows)

    @property
    def _balancing(self) -> list[str]:
        """Shafts whose torques have to balance: all but those whose drive or support gives what is missing."""
        supported = {self.first, *self.held, *self.given}
        return [shaft for shaft in self.ratios if shaft not in supported]

    def turning_ratios(self, shafts: Sequence[str], labels: Sequence[str]) -> Mapping[str, Fraction]:
        """Speed ratios of a train in which the speed of every shaft follows from the drives.

        Parameters
        ----------
        shafts : sequence of str
            Names of all shafts.
        labels : sequence of str
            Names of the pairs in messages.

        Raises
        ------
        CouplingError
            Where the first driver cannot turn, a shaft is in no gear pair that it turns, pairs, held shafts and given
            speeds contradict each other, or speeds are left open.
        """
        for problem in self.problems(shafts, labels):
            raise CouplingError(problem)
        return self.ratios

    def problems(self, shafts: Sequence[str], labels: Sequence[str]) -> Iterator[str]:
        """Yield sentences on what keeps a train from turning, as :meth:`turning_ratios`."""
        if self.first in (*self.planets, *self.held):
            yield from self.drive_problems()
            return
        for wrong in self.contradictions:
            yield self.sentence(wrong, "gear pairs" if wrong.pair is None else labels[wrong.pair])
        connected = {*self.ratios, *self.open_shafts}
        idle = [name for name in shafts if name not in connected]
        if idle:
            yield (
                f"no gear pair leads from shaft {self.first!r}, the first driver, to "
                f"{', '.join(map(repr, idle))}; expected a pair that turns each shaft"
            )
        yield from self.drive_problems()

    def drive_problems(self) -> Iterator[str]:
        """Yield a sentence on a drive where none can be, or on speeds that are left open."""
        if self.first in (*self.planets, *self.held):
            why = "a planet, whose axis turns with its carrier" if self.first in self.planets else "held"
            candidates = [name for name in self.ratios if name not in (*self.planets, *self.held)]
            candidates += [name for name in self.open_shafts if name not in self.planets]
            yield (
                f"the torque comes in on shaft {self.first!r}, which is {why}; expected an input on a shaft that turns "
                f"about a fixed axis, one of {', '.join(map(repr, candidates))}"
            )
            return
        if self.open_shafts:
            drives = ", ".join(map(repr, (self.first, *self.given)))
            candidates = [name for name in self.open_shafts if name not in self.planets] or list(self.open_shafts)
            missing = self.freedoms - 1 - len(self.given)
            given = "1 speed is given, that" if not self.given else f"{1 + len(self.given)} speeds are given, those"
            yield (
                f"the train has {self.freedoms} degrees of freedom and {given} of {drives}: "
                f"{', '.join(map(repr, self.open_shafts))} turn freely; expected {missing} more of "
                f"{', '.join(map(repr, candidates))} held by a torque support, driven at a given speed, or geared to "
                "another shaft"
            )

    def sentence(self, wrong: Contradiction, label: str) -> str:
        """Return a contradiction as a sentence; ``label`` names the pair."""
        shaft, ratio, other = repr(wrong.shaft), float(wrong.ratio), float(wrong.other)
        if wrong.pair is None:
            return (
                f"shaft {shaft} is given {other:.6g} of the first driver's speed, and turns at {ratio:.6g} of it by "
                "the gear pairs: two shafts are driven against each other; expected one of them driven, or a train "
                "with another degree of freedom"
            )
        if self.held:
            return (
                f"{label} cannot turn: shaft {shaft} would turn at {ratio:.6g} of the first driver's speed by the "
                f"other connections, and at {other:.6g} by this one; expected one of the held shafts "
                f"({', '.join(map(repr, self.held))}) free, or teeth in the ratio of these speeds"
            )
        return (
            f"{label} closes a loop that cannot turn: shaft {shaft} would turn at {ratio:.6g} of the first driver's "
            f"speed by the other pairs, and at {other:.6g} by this one"
        )

    def pair_torques(self, torques: Mapping[str, float]) -> tuple[float, ...]:
        """Mean torque that each pair takes from its driver [N m].

        Parameters
        ----------
        torques : mapping of str to float
            External torques on the shafts [N m], each positive in the sense in which its shaft turns.

        Returns
        -------
        tuple of float
            Positive where power flows from driver to driven, seen from the carrier where there is one.

        Notes
        -----
        Speeds fix the power through every pair of a tree. Where pairs form a loop, the smallest flows that balance are
        taken, which is what equal contacts carry, see
        :func:`gearwhine.coupling.description.train_matrix.least_flows`: B is the constraint matrix,
        each column times the speed of its shaft and each row over the speed of its mesh, and P the power that enters
        each shaft, both over the speed of the first driver. The shaft of the first driver, held shafts and those with
        given speeds take what is left.
        """
        if not self.pairs:
            return ()
        speeds, leaving = self.ratios, dict[str, float]()
        for shaft in self._balancing:
            leaving[shaft] = torques.get(shaft, 0.0) * float(abs(speeds[shaft]) or 1)
        # A shaft at rest balances its torque in place of its power, teeth without relative motion their force.
        turning = [self._mesh_turning(number) for number in range(len(self.pairs))]
        rows = [
            {
                shaft: float(value * (speeds[shaft] or 1) / (pair.teeth[0] * relative))
                for shaft, value in pair.row.items()
            }
            for pair, relative in zip(self.pairs, turning, strict=True)
        ]
        flows = least_flows(rows, leaving)
        return tuple(flow / float(abs(relative)) for flow, relative in zip(flows, turning, strict=True))

    def _mesh_turning(self, number: int) -> Fraction:
        """Speed of a pair's driver relative to its carrier, over that of the first driver; its sense if it rests."""
        return Fraction(self.pairs[number].relative_speed(self.ratios)) or Fraction(self.senses[number])

    @cached_property
    def senses(self) -> tuple[int, ...]:
        """Sense of rotation of each pair's driver relative to its carrier where the first driver turns about +z."""
        return tuple(turning_senses(self.pairs, {name: float(ratio) for name, ratio in self.ratios.items()}))

    def support_torques(self, torques: Mapping[str, float], speed: float) -> dict[str, float]:
        """Torque about z by which each held shaft is held [N m].

        Parameters
        ----------
        torques : mapping of str to float
            External torques, as of :meth:`pair_torques`.
        speed : float
            Signed speed of the first driver's shaft [rad/s].
        """
        sense = math.copysign(1.0, speed)
        on_shafts = self.mesh_torques(self.pair_torques(torques), speed)
        return {
            name: -sum((each.get(name, 0.0) for each in on_shafts), sense * torques.get(name, 0.0))
            for name in self.held
        }

    def mesh_torques(self, pair_torques: Sequence[float], speed: float) -> list[dict[str, float]]:
        """Torques about z of each mesh on its shafts, carrier included [N m].

        Parameters
        ----------
        pair_torques : sequence of float
            See :meth:`pair_torques`.
        speed : float
            Signed speed of the first driver's shaft [rad/s].
        """
        senses = [math.copysign(1.0, speed) * sense for sense in self.senses]
        rows = zip(self.pairs, pair_torques, senses, strict=True)
        return [pair.torques(sense * torque) for pair, torque, sense in rows]

    def applied_torques(
        self,
        torque: float,
        speed: float,
        outputs: Sequence[Output],
        at: float = 0.0,
        *,
        ends: Mapping[str, float],
        given: Sequence[GivenSpeed] = (),
    ) -> tuple[Torque, ...]:
        """Torques from outside: the input first, then the outputs, then further drives; they balance by the gears.

        The input drives the first driver's shaft in its sense of rotation, or without pairs the first output's shaft;
        outputs work against the rotation of theirs, see :func:`shared_torques`. Shafts whose speed is given have the
        torque that their own motion, all other drives at rest, balances: virtual work.

        Parameters
        ----------
        torque : float
            Input torque, negative where it brakes [N m].
        speed : float
            Signed speed of the first driver's shaft [rad/s].
        outputs : sequence of Output
        at : float
            Station of the input torque [m].
        ends : mapping of str to float
            Length of each shaft [m]: the default station of an output.
        given : sequence of GivenSpeed
            Drives of the shafts ``given`` of the train, for their stations.
        """
        if torque == 0.0 or not (self.pairs or outputs):
            return ()
        first = self.first if self.pairs else outputs[0].shaft
        applied = [Torque(first, at, math.copysign(1.0, speed) * torque)]
        shared = shared_torques(self, torque, outputs)
        for output, value in shared:
            place = ends[output.shaft] if output.at is None else output.at
            applied.append(Torque(output.shaft, place, -self.rotation_sense(output.shaft, speed) * value))
        for drive in given:
            place = ends[drive.shaft] if drive.at is None else drive.at
            balancing = sum(value * self.torque_ratio(output.shaft, drive.shaft) for output, value in shared)
            applied.append(Torque(drive.shaft, place, math.copysign(1.0, speed) * balancing))
        return tuple(applied)

    def torque_ratio(self, shaft: str, drive: str | None = None) -> float:
        """Torque about +z on a drive, by default the first driver, that balances a unit torque on a shaft.

        The unit torque acts against the rotation of the shaft where the first driver turns about +z. The others of the
        drives stand still.
        """
        ratio = self.ratios[shaft]
        if shaft not in self.speed_shares:
            return abs(float(ratio))
        share = self.speed_shares[shaft].get(self.first if drive is None else drive, Fraction(0))
        return math.copysign(1.0, ratio) * float(share)

    def rotation_sense(self, shaft: str, speed: float) -> float:
        """Sense of rotation of a shaft about z, 1 or -1, at a speed of the first driver's shaft [rad/s].

        A torque taken off the shaft is positive against it.
        """
        return math.copysign(1.0, speed) * math.copysign(1.0, self.ratios[shaft])

    def mesh_frequencies(self, speed: float) -> tuple[float, ...]:
        """Tooth-mesh frequency of each pair [Hz] at a speed of the first driver's shaft [rad/s]."""
        return tuple(
            mesh_frequency(speed * float(pair.relative_speed(self.ratios)), abs(pair.teeth[0])) for pair in self.pairs
        )

    def mean_pair_torques(self, applied: Sequence[Torque], speed: float) -> tuple[float, ...]:
        """Mean torque that each pair takes from its driver [N m], under torques about z; see :meth:`pair_torques`.

        Parameters
        ----------
        applied : sequence of Torque
        speed : float
            Signed speed of the first driver's shaft [rad/s].
        """
        return self.pair_torques(self.torques_along(applied, speed))

    def torques_along(self, applied: Sequence[Torque], speed: float) -> dict[str, float]:
        """Torques about z in the sense in which their shafts turn, by shaft [N m], as :meth:`pair_torques` takes them.

        Parameters
        ----------
        applied : sequence of Torque
        speed : float
            Signed speed of the first driver's shaft [rad/s].
        """
        along = dict.fromkeys(self.ratios, 0.0)
        for torque in applied:
            along[torque.rotor] += torque.value * self.rotation_sense(torque.rotor, speed)
        return along


_LARGEST_TERM = 1_000_000  # of a speed ratio of two drives, which no teeth fix


def drive_ratio(ratio: float) -> Fraction:
    """Return the speed ratio of two drives as a fraction of terms below a million."""
    return Fraction(ratio).limit_denominator(_LARGEST_TERM)


def gear_train(
    pairs: Iterable[GearedShafts],
    shafts: Iterable[str] = (),
    *,
    held: Iterable[str] = (),
    planets: Iterable[str] = (),
    given: Mapping[str, Fraction] | None = None,
    first: str | None = None,
) -> GearTrain:
    """Solve the constraint matrix of a gear train for the speeds of its shafts; without pairs all are as fast.

    Parameters
    ----------
    pairs : iterable of GearedShafts
    shafts : iterable of str
        Names of all shafts.
    held : iterable of str
        Shafts that are held.
    planets : iterable of str
        Shafts whose axes turn with a carrier.
    given : mapping of str to Fraction, optional
        Speeds of further driven shafts over that of the first driver.
    first : str, optional
        Shaft at which the torque comes in. By default that of the first pair's driver, or where that one is held or a
        planet, the first pair's carrier.
    """
    pairs, held, planets, speeds = tuple(pairs), tuple(held), tuple(planets), dict(given or {})
    names = list(shafts)
    if not pairs:
        first = names[0] if first is None and names else first or ""
        return GearTrain((), dict.fromkeys(names, Fraction(1)), (), first, held, planets, tuple(speeds))
    if first is None:
        first = pairs[0].driver
        if pairs[0].carrier is not None and first in (*held, *planets):
            first = pairs[0].carrier
    drives = {first: Fraction(1)} | speeds
    rows = SpeedRows(list(drives))
    for name in held:
        rows.add({name: Fraction(1)})
    order, wrong = list[str](), list[int]()
    for number in _adding_order(pairs, rows):
        if not rows.add(pairs[number].row):
            wrong.append(number)
        order += [shaft for shaft in pairs[number].row if shaft not in order]
    connected = connected_shafts([pair.row for pair in pairs], first)
    found = [shaft for shaft in (first, *order) if shaft in connected and rows.is_determined(shaft)]
    ratios = {shaft: rows.at(shaft, drives) for shaft in found}
    contradictions = [_contradiction(number, pairs[number], rows, drives) for number in sorted(wrong)]
    contradictions += [
        Contradiction(None, name, ratios[name], ratio)
        for name, ratio in speeds.items()
        if name in rows.dependent and name in ratios
    ]
    independent = {free for shaft in connected for free in rows.shares(shaft)}
    return GearTrain(
        pairs,
        ratios,
        tuple(contradictions),
        first,
        held,
        planets,
        tuple(speeds),
        tuple(shaft for shaft in order if shaft in connected and shaft not in ratios),
        len(independent),
        {shaft: dict(rows.shares(shaft)) for shaft in found},
    )


def _adding_order(pairs: Sequence[GearedShafts], rows: SpeedRows) -> Iterator[int]:
    """Yield pairs whose row fixes or checks one speed, in rounds from the drives on; if there is none, the next.

    Then the pair that closes a loop is the one that is found to contradict the others.
    """
    left = list(range(len(pairs)))
    while left:
        before = len(left)
        for number in tuple(left):
            if sum(not rows.is_determined(shaft) for shaft in pairs[number].row) <= 1:
                left.remove(number)
                yield number
        if len(left) == before:
            yield left.pop(0)


def _contradiction(number: int, pair: GearedShafts, rows: SpeedRows, drives: Mapping[str, Fraction]) -> Contradiction:
    """Speed of the driven shaft by the other connections, and by this pair from its driver and carrier."""
    driver, driven = rows.at(pair.driver, drives), rows.at(pair.driven, drives)
    carried = Fraction(0) if pair.carrier is None else rows.at(pair.carrier, drives)
    return Contradiction(number, pair.driven, driven, carried + pair.ratio * (driver - carried))


def shared_torques(train: GearTrain, torque: float, outputs: Sequence[Output]) -> list[tuple[Output, float]]:
    """Torque of each output [N m], against the rotation of its shaft.

    Without outputs, the shafts that drive no other take equal power. Given torques are proportions: they are scaled to
    balance the input exactly.

    Parameters
    ----------
    train : GearTrain
    torque : float
        Torque at the first driver, in the sense in which it turns [N m].
    outputs : sequence of Output
    """
    outputs = list(outputs) or [Output(shaft) for shaft in train.output_shafts]
    if not any(output.torque for output in outputs):
        outputs = [
            Output(output.shaft, torque / len(outputs) / abs(float(train.ratios[output.shaft])), output.at)
            for output in outputs
        ]
    power = output_torque(train, outputs)
    return [(output, (output.torque or 0.0) * torque / power) for output in outputs]


def output_torque(train: GearTrain, outputs: Sequence[Output]) -> float:
    """Torque of the outputs, reduced to the first driver by the tooth ratios [N m]."""
    return sum((output.torque or 0.0) * train.torque_ratio(output.shaft) for output in outputs)


def is_balanced(entering: float, leaving: float) -> bool:
    """Whether two torques [N m] are equal within :data:`LARGEST_IMBALANCE`."""
    return abs(leaving - entering) <= LARGEST_IMBALANCE * max(abs(entering), abs(leaving))


def lacks_input(torque: float, outputs: Sequence[Output]) -> bool:
    """Whether outputs have torques without an input, even if they balance: they are proportions of an input."""
    return torque == 0.0 and any(output.torque for output in outputs)


def require_balanced_outputs(train: GearTrain, torque: float, outputs: Sequence[Output]) -> None:
    """Refuse outputs whose power is not the input power; see :func:`shared_torques`.

    Raises
    ------
    CouplingError
        Where an output is on a shaft that gives no power, no shaft is left for one, only some outputs have torques,
        there is no input for them, or their power is off by more than one in a hundred.
    """
    if train.pairs and torque != 0.0:
        _require_turning_outputs(train, outputs)
    with_torque = [output for output in outputs if output.torque is not None]
    if not with_torque:
        return
    if len(with_torque) < len(outputs):
        raise CouplingError("outputs of which some have a torque and some have none; expected all or none")
    if lacks_input(torque, outputs):
        raise CouplingError(
            "outputs with torques, and an input torque of 0; expected the torque that drives them, as the input: where "
            "they drive each other, on the shaft that gives the power, a gear of which is the first pair's driver"
        )
    leaving = output_torque(train, outputs)
    if not is_balanced(torque, leaving):
        raise CouplingError(
            f"outputs that amount to {leaving:g} N·m at the first driver; expected outputs that balance the input "
            f"torque of {torque:g} N·m through the tooth ratios"
        )


def _require_turning_outputs(train: GearTrain, outputs: Sequence[Output]) -> None:
    """Refuse a train with nothing to take the input, and outputs where nothing can be taken."""
    names = [output.shaft for output in outputs] or list(train.output_shafts)
    turning = ", ".join(repr(name) for name, ratio in train.ratios.items() if ratio and name not in train.planets)
    for name in names:
        if name in train.planets:
            raise CouplingError(
                f"an output on shaft {name!r}, a planet, whose axis turns with its carrier; expected one of {turning}"
            )
        if not train.ratios[name]:
            raise CouplingError(f"an output on shaft {name!r}, which stands still; expected one of {turning}")
    if not names:
        raise CouplingError(
            "no shaft where the torque leaves: each drives another, is held or is a planet; expected outputs"
        )
    if train.given and sum(train.torque_ratio(name) for name in names) <= 0.0:
        raise CouplingError(
            f"outputs on {', '.join(map(repr, names))}, which at these speeds drive the first driver, "
            f"{train.first!r}, in place of being driven by it; expected a negative torque of an input that brakes, or "
            "the input on a shaft that drives"
        )


@dataclass(frozen=True)
class ShaftImbalance:
    """A shaft in no gear pair whose torques do not balance.

    Attributes
    ----------
    output : int
        Index of the first output on the shaft.
    shaft : str
    entering, leaving : float
        Torque that comes in and torque that its outputs take [N m].
    """

    output: int
    shaft: str
    entering: float
    leaving: float


def imbalances_of_shafts(torque: float, outputs: Sequence[Output]) -> Iterator[ShaftImbalance]:
    """Shafts without gear pairs whose torques do not balance; the input is on the first output's shaft."""
    first: dict[str, int] = {}
    for place, output in enumerate(outputs):
        first.setdefault(output.shaft, place)
    for shaft, place in first.items():
        entering = torque if place == 0 else 0.0
        leaving = sum(output.torque or 0.0 for output in outputs if output.shaft == shaft)
        if not is_balanced(entering, leaving):
            yield ShaftImbalance(place, shaft, entering, leaving)


def carrying_flanks(pair_torques: Sequence[float], torque: float) -> list[Literal["drive", "back", "reversed"] | None]:
    """Flanks that carry the mean torque of each gear pair.

    Parameters
    ----------
    pair_torques : sequence of float
        Mean torque that each pair takes from its driver [N m].
    torque : float
        Input torque of the train [N m]; negative where it brakes.

    Returns
    -------
    list
        "drive"; "back" where the torque brakes, so that the driven gear drives by the back flanks; "reversed" where
        power flows against the input, from driven gear to driver; None where the pair carries no torque.
    """
    least = _NO_TORQUE * abs(torque)
    sense = math.copysign(1.0, torque)
    flanks: list[Literal["drive", "back", "reversed"] | None] = []
    for pair_torque in pair_torques:
        if abs(pair_torque) <= least:
            flanks.append(None)
        elif sense * pair_torque < 0.0:
            flanks.append("reversed")
        elif pair_torque > 0.0:
            flanks.append("drive")
        else:
            flanks.append("back")
    return flanks


def turning_senses(pairs: Sequence[GearedShafts], speeds: Mapping[str, float]) -> list[int]:
    """Return the sense of rotation of each pair's driver relative to its carrier, 1 or -1.

    Seen from the carrier external gears in mesh turn opposite ways, an internal gear and its pinion the same way, at
    rest too. There the first pair of a train has the sense that
    :func:`gearwhine.coupling.gears.geometry.pair.turning_sense` gives its driver, and the others follow.

    Parameters
    ----------
    pairs : sequence of GearedShafts
    speeds : mapping of str to float
        Signed speed of each shaft, or its part of another's [rad/s].
    """
    seen = [[(shaft, pair.carrier) for shaft in (pair.driver, pair.driven)] for pair in pairs]
    senses = dict[tuple[str, str | None], int]()
    for shaft, carrier in (member for members in seen for member in members):
        carried = 0.0 if carrier is None else speeds[carrier]
        relative = speeds[shaft] - carried
        if abs(relative) > _RATIO_ROUNDING * abs(carried):
            senses[shaft, carrier] = turning_sense(relative)
    for number in connected_order(seen, senses):
        driver, driven = seen[number]
        other = -1 if math.prod(pairs[number].teeth) > 0 else 1
        if driver not in senses:
            senses[driver] = other * senses[driven] if driven in senses else turning_sense(speeds[driver[0]])
        senses.setdefault(driven, other * senses[driver])
    return [senses[driver] for driver, _ in seen]


def geared_shafts(mesh: GearMesh) -> GearedShafts:
    """Return the rotors of a mesh as the shafts of a train."""
    teeth = mesh.geometry.driver.teeth, mesh.geometry.driven.teeth
    return GearedShafts(mesh.driver.rotor, mesh.driven.rotor, teeth, mesh.carrier)


def geared_names(meshes: Iterable[GearMesh]) -> list[tuple[str, str]]:
    """Names of rotors that meshes connect, in twos: driver and driven, driver and carrier."""
    return [
        (mesh.driver.rotor, other)
        for mesh in meshes
        for other in (mesh.driven.rotor, mesh.carrier)
        if other is not None
    ]


def connected_order(pairs: Sequence[Sequence[Hashable]], known: Iterable[Hashable] = ()) -> Iterator[int]:
    """Yield indices of all pairs, first those that share a name with a pair before; ``known`` names come before all.

    The first of the others begins a new group of connected pairs.
    """
    named, left = set(known), list(range(len(pairs)))
    while left:
        number = next((number for number in left if not named.isdisjoint(pairs[number])), left[0])
        left.remove(number)
        named.update(pairs[number])
        yield number


def require_meshing(meshes: Sequence[GearMesh], starts: Mapping[str, float], speeds: Mapping[str, float]) -> None:
    """Refuse gear pairs that cannot be in mesh.

    Parameters
    ----------
    meshes : sequence of GearMesh
    starts : mapping of str to float
        Left end of each rotor along z [m].
    speeds : mapping of str to float
        Signed speed of each rotor [rad/s].

    Raises
    ------
    CouplingError
        Where both gears of a pair sit on one rotor, turn the same way or not in the ratio of their teeth, have axes
        that are not at the centre distance of their geometry, or faces of which less than half of the
        narrower one meets the other.
    """
    for mesh in meshes:
        _require_ratio(mesh, speeds)
        _require_place(mesh, starts)


def require_balance(meshes: Sequence[GearMesh], torques: Sequence[AnyTorque], speeds: Mapping[str, float]) -> None:
    """Refuse constant torques that do not balance in their gear train.

    Trains that stand still, or whose torques vary over time or with the speed, are left to the solution.

    Raises
    ------
    CouplingError
        Where the power that a train takes in and the power that it gives out differ by more than one in a hundred.
    """
    varying = {torque.rotor for torque in torques if not isinstance(torque, Torque | TorqueRipple)}
    total = largest_torques(torques)
    for train in trains(list(speeds), geared_names(meshes)):
        if len(train) < 2 or varying.intersection(train):
            continue
        powers = {name: total.get(name, 0.0) * speeds[name] for name in train}
        power_in = sum(power for power in powers.values() if power > 0.0)
        power_out = -sum(power for power in powers.values() if power < 0.0)
        if abs(power_in - power_out) > LARGEST_IMBALANCE * max(power_in, power_out):
            listed = ", ".join(f"{total.get(name, 0.0):.6g} N·m on {name!r}" for name in train)
            raise CouplingError(
                f"torques of {listed} bring {power_in:.6g} W into their gear train and take {power_out:.6g} W "
                "out of it; expected torques that balance through the tooth ratios"
            )


def _require_ratio(mesh: GearMesh, speeds: Mapping[str, float]) -> None:
    rotors = mesh.driver.rotor, mesh.driven.rotor
    if rotors[0] == rotors[1]:
        raise CouplingError(f"{mesh.label}: both gears are on rotor {rotors[0]!r}; expected the driven one on another")
    shafts = geared_shafts(mesh)
    carried = 0.0 if shafts.carrier is None else speeds[shafts.carrier]
    first, second = (speeds[name] - carried for name in rotors)
    teeth = shafts.teeth
    needed = -first * teeth[0] / teeth[1]
    if abs(second - needed) <= _RATIO_ROUNDING * max(abs(needed), abs(carried)):
        return
    if first * second * math.prod(teeth) > 0.0:
        same, expected = ("the same way", "opposite") if math.prod(teeth) > 0 else ("opposite ways", "equal")
        raise CouplingError(
            f"{mesh.label}: rotors {rotors[0]!r} and {rotors[1]!r} turn {same}; expected speeds of {expected} "
            f"signs, since {'external gears turn opposite ways' if math.prod(teeth) > 0 else _INTERNAL_SENSE}"
        )
    relative = "" if shafts.carrier is None else f" relative to carrier {shafts.carrier!r}"
    raise CouplingError(
        f"{mesh.label}: rotor {rotors[1]!r} turns at {second:.6g} rad/s{relative}; expected {needed:.6g} rad/s, by "
        f"{teeth[0]} and {teeth[1]} teeth with rotor {rotors[0]!r} at {first:.6g} rad/s"
    )


def _require_place(mesh: GearMesh, starts: Mapping[str, float]) -> None:
    gears = mesh.driver, mesh.driven
    apart = hypot(gears[0].axis[0] - gears[1].axis[0], gears[0].axis[1] - gears[1].axis[1])
    distance = abs(mesh.geometry.working_centre_distance)
    if abs(apart - distance) > LARGEST_OFFSET:
        raise CouplingError(
            f"{mesh.label}: the axes of rotors {gears[0].rotor!r} and {gears[1].rotor!r} are {1e3 * apart:.6g} mm "
            f"apart; expected the gears' centre distance, {1e3 * distance:.6g} mm"
        )
    places = [starts[gear.rotor] + gear.at for gear in gears]
    require_one_plane(mesh.label, places, (mesh.geometry.driver, mesh.geometry.driven))
    offset = places[1] - places[0]
    if abs(offset - mesh.geometry.axial_offset) > LARGEST_OFFSET:
        raise CouplingError(
            f"{mesh.label}: the driven gear is {1e3 * offset:.6g} mm along z from the driver; expected its geometry's "
            f"axial_offset, {1e3 * mesh.geometry.axial_offset:.6g} mm"
        )


def geometry_on_axes(
    driver: Gear,
    driven: Gear,
    shafts: tuple[str, str],
    axes: Sequence[tuple[float, float]],
    places: Sequence[float] = (0.0, 0.0),
) -> GearPairGeometry:
    """Two gears in mesh at the distance of their shafts' axes.

    Parameters
    ----------
    driver, driven : Gear
    shafts : tuple of str
        Names of the two shafts.
    axes : sequence of (float, float)
        Positions x, y of the axes [m].
    places : sequence of float
        Places of the middles of both faces along z [m].

    Raises
    ------
    CouplingError
        Where the gears are not in one plane.
    gearwhine.coupling.gears.GearError
        Where the gears do not fit each other; the message names this distance, the distance that the gears need, and
        the shafts.
    """
    distance = signed_distance(driver, driven, hypot(axes[1][0] - axes[0][0], axes[1][1] - axes[0][1]))
    require_one_plane(pair_label(driver.name, driven.name), places, (driver, driven))
    offset = places[1] - places[0]
    try:
        return GearPairGeometry(driver, driven, distance, offset if abs(offset) > LARGEST_OFFSET else 0.0)
    except (InterferenceError, NoContactError) as error:
        raise type(error)(f"{error}; the axes are those of {shafts[0]!r} and {shafts[1]!r}") from error


def require_one_plane(label: str, places: Sequence[float], gears: Sequence[Gear]) -> None:
    """Refuse gears that are not in one plane, by the places of the middles of their faces along z [m].

    A pair of which half the narrower face or more misses the other is one by mistake.
    """
    refuse(plane_findings((label, ""), places, gears), CouplingError)


def plane_findings(part: Part, places: Sequence[float], gears: Sequence[Gear]) -> Iterator[Finding]:
    """Yield gears that are not in one plane, as :func:`require_one_plane`.

    A long pinion may have its mate at an end of its face.
    """
    shift, reach = abs(places[0] - places[1]), 0.5 * max(gear.face_width for gear in gears)
    if shift > reach + LARGEST_OFFSET:
        expected = (
            f"gears in one plane, within half a face width, {1e3 * reach:.6g} mm; they are {1e3 * shift:.6g} mm "
            "apart along z"
        )
        yield Finding(part, "driven", None, expected)


LARGEST_MISFIT = 1e-3
"""Largest misfit of teeth in a loop of gears that may come from rounding of the axes, over the pitch."""


@dataclass(frozen=True)
class MeshStart:
    """A mesh at t = 0.

    Attributes
    ----------
    phase : float
        Phase [mesh periods].
    numbering : tuple of ToothNumbering
        Numbers of the driver's and of the driven teeth in the mesh.
    """

    phase: float
    numbering: tuple[ToothNumbering, ToothNumbering]


def mesh_starts(
    drivers: Sequence[str],
    drivens: Sequence[str],
    geometries: Sequence[GearPairGeometry],
    centre_lines: Sequence[float],
    senses: Sequence[int],
) -> list[MeshStart]:
    """Phase of each pair at t = 0, and the numbers of its teeth by those of the first pair of each gear.

    Parameters
    ----------
    drivers, drivens : sequence of str
        The gears' names, pair by pair.
    geometries : sequence of GearPairGeometry
    centre_lines : sequence of float
        Angle from x of the line from the driver's centre to the driven gear's, of an internal pair back [rad].
    senses : sequence of int
        +1 where the driver turns counter-clockwise, -1 where clockwise.

    Raises
    ------
    CouplingError
        Where a loop of gears cannot be assembled.
    """
    placed: dict[str, _PlacedTeeth] = {}
    rows = list(zip(drivers, drivens, geometries, centre_lines, senses, strict=True))
    starts: dict[int, MeshStart] = {}
    for number in connected_order([row[:2] for row in rows]):
        driver, driven, pair, line, sense = rows[number]
        met = meshing_rotations(pair, 0.0, centre_line_angle=line, sense=sense)
        # A pair enters at the middle of the common face; there helical teeth stand turned from the middle of their own.
        at_zero = [
            angle - gear.turn_along(middle)
            for angle, gear, middle in zip(met, (pair.driver, pair.driven), pair.common_middles, strict=True)
        ]
        along = pair.flank_sense(sense)
        pitches = along * 2.0 * math.pi / pair.driver.teeth, -along * 2.0 * math.pi / pair.driven.teeth
        if driver in placed:
            phase = (placed[driver].angle - at_zero[0]) / pitches[0]
        elif driven in placed:
            phase = (placed[driven].angle - at_zero[1]) / pitches[1]
        else:
            phase = 0.0
        numbering = []
        members = zip((driver, driven), at_zero, pitches, (1, -1), strict=True)
        for gear, zero, pitch, role in members:
            # A driver touches with the flank ahead, a driven gear with the one behind.
            side = role if pitch > 0.0 else -role
            stands = zero + phase * pitch
            own = placed.setdefault(gear, _PlacedTeeth(stands, pitch, side))
            # A whole number of pitches is the same place.
            misfit = (own.angle - stands) / own.pitch
            if abs(misfit - round(misfit)) > LARGEST_MISFIT:
                raise CouplingError(
                    f"{driver} -> {driven}: the gears form a loop that cannot be assembled: teeth of {gear} would "
                    f"stand {abs(misfit - round(misfit)):.3f} pitches beside the gaps that they belong in; move an "
                    "axis, or change a number of teeth"
                )
            step: Literal[1, -1] = 1 if pitch * own.pitch > 0.0 else -1
            numbering.append(ToothNumbering(round(misfit), step, side == own.side))
        starts[number] = MeshStart(phase, (numbering[0], numbering[1]))
    return [starts[number] for number in range(len(rows))]


class _PlacedTeeth(NamedTuple):
    """Angle of a gear's tooth 0 at t = 0 [rad], the turn by which the next one takes its place, its first flank."""

    angle: float
    pitch: float
    side: int


def mesh_phases(
    drivers: Sequence[str],
    drivens: Sequence[str],
    geometries: Sequence[GearPairGeometry],
    centre_lines: Sequence[float],
    senses: Sequence[int],
) -> list[float]:
    """Phase of each pair at t = 0 [mesh periods]; see :func:`mesh_starts`."""
    return [start.phase for start in mesh_starts(drivers, drivens, geometries, centre_lines, senses)]
