"""Gear train: speed ratios, senses of rotation, power flow, mesh phases; checks that a train can exist.

Gears on parallel shafts roll without slip where ω₁ z₁ = -ω₂ z₂, z negative of an internal gear (ISO 21771); their
shafts are as far apart as the geometry of the pair says, and the middles of their faces at most half of the narrower
face apart along the shafts. A train at constant speed takes as much power as it gives, Σ T ω = 0 over its shafts.

Gear pairs that share gears have related mesh phases. Each gear is fitted to its shaft so that the first pair it belongs
to begins a mesh period at t = 0. The phase of every further pair of the same gear follows from the gear's teeth: as
gears roll without slip, tooth 0 of driver and driven gear lie at angles that are linear in the pair's phase
(`gearwhine.coupling.gears.geometry.profile.meshing_rotations`), and an angle that is already known gives the phase.
Gears that close a loop must fit: where teeth would clash, they cannot be assembled.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import hypot
from typing import Literal

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears import Gear, GearPairGeometry
from gearwhine.coupling.gears.errors import InterferenceError, NoContactError
from gearwhine.coupling.gears.geometry.pair import mesh_frequency, pair_label, signed_distance, turning_sense
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
_NO_TORQUE = 1e-9  # part of the input torque below which the torque of a gear pair is rounding


EQUAL_MESHES = "equal meshes"
"""Origin of mean forces in a loop of pairs, which the torques alone do not fix: equal meshes would carry them."""


@dataclass(frozen=True)
class GearedShafts:
    """Two shafts that a gear pair connects.

    Attributes
    ----------
    driver, driven : str
        Names of the shafts.
    teeth : tuple of int
        Tooth numbers of the driver and of the driven gear.
    """

    driver: str
    driven: str
    teeth: tuple[int, int]

    @property
    def ratio(self) -> Fraction:
        """Speed of the driven shaft over that of the driver, negative: external gears turn opposite ways."""
        return Fraction(-self.teeth[0], self.teeth[1])


@dataclass(frozen=True)
class Contradiction:
    """A gear pair that closes a loop in which the shafts cannot turn.

    Attributes
    ----------
    pair : int
        Index of the pair.
    shaft : str
        Shaft that would have to turn at two speeds.
    ratio, other : Fraction
        Speed of that shaft over that of the first driver by the other pairs, and by this pair.
    """

    pair: int
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
class GearTrain:
    """Gear train: pairs and the speed ratios that follow from them; see :func:`gear_train`.

    Attributes
    ----------
    pairs : tuple of GearedShafts
    ratios : mapping of str to Fraction
        Signed speed of each shaft over that of the first driver; shafts that no pair leads to are absent.
    contradictions : tuple of Contradiction
        Empty in a train that can turn.
    """

    pairs: tuple[GearedShafts, ...]
    ratios: Mapping[str, Fraction]
    contradictions: tuple[Contradiction, ...]

    @property
    def output_shafts(self) -> tuple[str, ...]:
        """Shafts that drive no other: the power leaves there unless outputs are given."""
        drivers = {pair.driver for pair in self.pairs}
        return tuple(shaft for shaft in self.ratios if shaft not in drivers)

    @property
    def force_origins(self) -> tuple[str, ...]:
        """What the mean force of each pair follows from: the torques alone, or in a loop of pairs `EQUAL_MESHES`."""
        return tuple(EQUAL_MESHES if shares else "torques" for shares in self.shares_torque)

    @property
    def shares_torque(self) -> tuple[bool, ...]:
        """Whether the share of each pair is statically indeterminate: it is in a loop of pairs, as of a power split."""
        return tuple(self._is_in_loop(number) for number in range(len(self.pairs)))

    def _is_in_loop(self, number: int) -> bool:
        """Whether other pairs lead from the driver of a pair to its driven shaft."""
        reached, start = {self.pairs[number].driver}, 0
        others = [{pair.driver, pair.driven} for other, pair in enumerate(self.pairs) if other != number]
        while len(reached) > start:
            start = len(reached)
            for shafts in others:
                reached |= shafts if shafts & reached else set()
        return self.pairs[number].driven in reached

    def turning_ratios(self, shafts: Sequence[str], labels: Sequence[str]) -> Mapping[str, Fraction]:
        """Speed ratios of a train in which every shaft turns.

        Parameters
        ----------
        shafts : sequence of str
            Names of all shafts.
        labels : sequence of str
            Names of the pairs in messages.

        Raises
        ------
        CouplingError
            Where a shaft is in no gear pair that the first driver turns, or a loop of pairs cannot turn.
        """
        for wrong in self.contradictions:
            raise CouplingError(
                f"{labels[wrong.pair]} closes a loop that cannot turn: shaft {wrong.shaft!r} would turn at "
                f"{float(wrong.ratio):.6g} of the first driver's speed by the other pairs, and at "
                f"{float(wrong.other):.6g} by this one"
            )
        idle = [name for name in shafts if name not in self.ratios]
        if idle:
            raise CouplingError(
                f"no gear pair leads from shaft {self.pairs[0].driver!r}, the first driver, to "
                f"{', '.join(map(repr, idle))}; expected a pair that turns each shaft"
            )
        return self.ratios

    def pair_torques(self, torques: Mapping[str, float]) -> tuple[float, ...]:
        """Mean torque that each pair takes from its driver [N m].

        Parameters
        ----------
        torques : mapping of str to float
            External torques on the shafts [N m], each positive in the sense in which its shaft turns.

        Returns
        -------
        tuple of float
            Positive where power flows from driver to driven.

        Notes
        -----
        Speeds fix the power through every pair of a tree. Where pairs form a loop, the smallest flows that balance are
        taken, which is what equal contacts carry: f = Bᵀ p with B Bᵀ p = P, B the incidence matrix of the train's
        graph and P the power that enters each shaft over the speed of the first driver.
        """
        if not self.pairs:
            return ()
        entering = {shaft: torques.get(shaft, 0.0) * abs(float(ratio)) for shaft, ratio in self.ratios.items()}
        potential = _potentials(self.pairs, entering)
        return tuple(
            (potential[pair.driver] - potential[pair.driven]) / abs(float(self.ratios[pair.driver]))
            for pair in self.pairs
        )

    def applied_torques(
        self,
        torque: float,
        speed: float,
        outputs: Sequence[Output],
        at: float = 0.0,
        *,
        ends: Mapping[str, float],
    ) -> tuple[Torque, ...]:
        """Torques from outside: the input first, then the outputs; they balance through the gears.

        The input drives the first driver's shaft in its sense of rotation, or without pairs the first output's shaft;
        outputs work against the rotation of theirs, see :func:`shared_torques`.

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
        """
        if torque == 0.0 or not (self.pairs or outputs):
            return ()
        first = self.pairs[0].driver if self.pairs else outputs[0].shaft
        applied = [Torque(first, at, math.copysign(1.0, speed) * torque)]
        for output, value in shared_torques(self, torque, outputs):
            place = ends[output.shaft] if output.at is None else output.at
            applied.append(Torque(output.shaft, place, -self.rotation_sense(output.shaft, speed) * value))
        return tuple(applied)

    def rotation_sense(self, shaft: str, speed: float) -> float:
        """Sense of rotation of a shaft about z, 1 or -1, at a speed of the first driver's shaft [rad/s].

        A torque taken off the shaft is positive against it.
        """
        return math.copysign(1.0, speed) * math.copysign(1.0, self.ratios[shaft])

    def mesh_frequencies(self, speed: float) -> tuple[float, ...]:
        """Tooth-mesh frequency of each pair [Hz] at a speed of the first driver's shaft [rad/s]."""
        return tuple(mesh_frequency(speed * float(self.ratios[pair.driver]), pair.teeth[0]) for pair in self.pairs)

    def mean_pair_torques(self, applied: Sequence[Torque], speed: float) -> tuple[float, ...]:
        """Mean torque that each pair takes from its driver [N m], under torques about z; see :meth:`pair_torques`.

        Parameters
        ----------
        applied : sequence of Torque
        speed : float
            Signed speed of the first driver's shaft [rad/s].
        """
        along = dict.fromkeys(self.ratios, 0.0)
        for torque in applied:
            along[torque.rotor] += torque.value * self.rotation_sense(torque.rotor, speed)
        return self.pair_torques(along)


def gear_train(pairs: Iterable[GearedShafts], shafts: Iterable[str] = ()) -> GearTrain:
    """Follow tooth ratios from the driver of the first pair through all pairs; without pairs all shafts are as fast."""
    pairs = tuple(pairs)
    ratios = {pairs[0].driver: Fraction(1)} if pairs else dict.fromkeys(shafts, Fraction(1))
    contradictions: dict[int, Contradiction] = {}
    waiting = list(enumerate(pairs))
    while waiting:
        left = []
        for place, pair in waiting:
            first, second = ratios.get(pair.driver), ratios.get(pair.driven)
            if first is not None and second is not None:
                if second != first * pair.ratio:
                    contradictions[place] = Contradiction(place, pair.driven, second, first * pair.ratio)
            elif first is not None:
                ratios[pair.driven] = first * pair.ratio
            elif second is not None:
                ratios[pair.driver] = second / pair.ratio
            else:
                left.append((place, pair))
        if len(left) == len(waiting):
            break
        waiting = left
    return GearTrain(pairs, ratios, tuple(contradictions[place] for place in sorted(contradictions)))


def _potentials(pairs: Sequence[GearedShafts], entering: Mapping[str, float]) -> dict[str, float]:
    """Solve L p = P on the graph of a connected train, p of its first shaft zero.

    The Laplacian L = B Bᵀ is positive definite without the first shaft, so elimination needs no pivoting.
    """
    shafts = list(entering)
    place = {shaft: index for index, shaft in enumerate(shafts)}
    size = len(shafts)
    rows = [[0.0] * size + [entering[shaft]] for shaft in shafts]
    for pair in pairs:
        i, j = place[pair.driver], place[pair.driven]
        rows[i][i] += 1.0
        rows[j][j] += 1.0
        rows[i][j] -= 1.0
        rows[j][i] -= 1.0
    for pivot in range(size - 1, 0, -1):
        for row in range(pivot):
            factor = rows[row][pivot] / rows[pivot][pivot]
            if factor != 0.0:
                rows[row] = [a - factor * b for a, b in zip(rows[row], rows[pivot], strict=True)]
    solution = [0.0] * size
    for row in range(1, size):
        substituted = sum(rows[row][column] * solution[column] for column in range(row))
        solution[row] = (rows[row][size] - substituted) / rows[row][row]
    return dict(zip(shafts, solution, strict=True))


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
    ratios = {shaft: float(ratio) for shaft, ratio in train.ratios.items()}
    outputs = list(outputs) or [Output(shaft) for shaft in train.output_shafts]
    if not any(output.torque for output in outputs):
        outputs = [
            Output(output.shaft, torque / len(outputs) / abs(ratios[output.shaft]), output.at) for output in outputs
        ]
    power = sum((output.torque or 0.0) * abs(ratios[output.shaft]) for output in outputs)
    return [(output, (output.torque or 0.0) * torque / power) for output in outputs]


def output_torque(train: GearTrain, outputs: Sequence[Output]) -> float:
    """Torque of the outputs, reduced to the first driver by the tooth ratios [N m]."""
    return sum((output.torque or 0.0) * abs(float(train.ratios[output.shaft])) for output in outputs)


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
        Where only some outputs have torques, there is no input for them, or their power is off by more than one in a
        hundred.
    """
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
            f"outputs that amount to {leaving:g} N m at the first driver; expected outputs that balance the input "
            f"torque of {torque:g} N m through the tooth ratios"
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


def turning_senses(pairs: Sequence[tuple[str, str]], speeds: Mapping[str, float]) -> list[int]:
    """Return the sense of rotation of each pair's driver, 1 or -1.

    Gears in mesh turn opposite ways, at rest too. There the first pair of a train has the sense that
    :func:`gearwhine.coupling.gears.geometry.pair.turning_sense` gives its driver, and the others follow.

    Parameters
    ----------
    pairs : sequence of tuple of str
        Rotors of driver and driven.
    speeds : mapping of str to float
        Signed speed of each rotor [rad/s].
    """
    senses = {name: turning_sense(speed) for name, speed in speeds.items() if speed != 0.0}
    for number in connected_order(pairs, senses):
        driver, driven = pairs[number]
        if driver not in senses:
            senses[driver] = -senses[driven] if driven in senses else turning_sense(speeds[driver])
        senses.setdefault(driven, -senses[driver])
    return [senses[driver] for driver, _ in pairs]


def connected_order(pairs: Sequence[tuple[str, str]], known: Iterable[str] = ()) -> Iterator[int]:
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
        that are not at the centre distance of their geometry, or faces whose middles are more than half of the
        narrower face apart.
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
    for train in trains(list(speeds), [(mesh.driver.rotor, mesh.driven.rotor) for mesh in meshes]):
        if len(train) < 2 or varying.intersection(train):
            continue
        powers = {name: total.get(name, 0.0) * speeds[name] for name in train}
        power_in = sum(power for power in powers.values() if power > 0.0)
        power_out = -sum(power for power in powers.values() if power < 0.0)
        if abs(power_in - power_out) > LARGEST_IMBALANCE * max(power_in, power_out):
            listed = ", ".join(f"{total.get(name, 0.0):.6g} N m on {name!r}" for name in train)
            raise CouplingError(
                f"torques of {listed} bring {power_in:.6g} W into their gear train and take {power_out:.6g} W "
                "out of it; expected torques that balance through the tooth ratios"
            )


def _require_ratio(mesh: GearMesh, speeds: Mapping[str, float]) -> None:
    rotors = mesh.driver.rotor, mesh.driven.rotor
    if rotors[0] == rotors[1]:
        raise CouplingError(f"{mesh.label}: both gears are on rotor {rotors[0]!r}; expected the driven one on another")
    first, second = (speeds[name] for name in rotors)
    teeth = mesh.geometry.driver.teeth, mesh.geometry.driven.teeth
    needed = -first * teeth[0] / teeth[1]
    if abs(second - needed) <= _RATIO_ROUNDING * abs(needed):
        return
    if first * second > 0.0:
        raise CouplingError(
            f"{mesh.label}: rotors {rotors[0]!r} and {rotors[1]!r} turn the same way; expected speeds of opposite "
            "signs, since external gears turn opposite ways"
        )
    raise CouplingError(
        f"{mesh.label}: rotor {rotors[1]!r} turns at {second:.6g} rad/s; expected {needed:.6g} rad/s, by {teeth[0]} "
        f"and {teeth[1]} teeth with rotor {rotors[0]!r} at {first:.6g} rad/s"
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
    """Yield gears that are not in one plane, as :func:`require_one_plane`."""
    shift, reach = abs(places[0] - places[1]), 0.5 * min(gear.face_width for gear in gears)
    if shift > reach + LARGEST_OFFSET:
        expected = (
            f"gears in one plane, within half a face width, {1e3 * reach:.6g} mm; they are {1e3 * shift:.6g} mm "
            "apart along z"
        )
        yield Finding(part, "driven", None, expected)


_MISFIT = 1e-3  # largest misfit over the pitch that may come from rounding of the axes


def mesh_phases(
    drivers: Sequence[str],
    drivens: Sequence[str],
    geometries: Sequence[GearPairGeometry],
    centre_lines: Sequence[float],
    senses: Sequence[int],
) -> list[float]:
    """Phase of each pair at t = 0 [mesh periods].

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
    angles: dict[str, float] = {}
    rows = list(zip(drivers, drivens, geometries, centre_lines, senses, strict=True))
    phases = [0.0] * len(rows)
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
        if driver in angles:
            phase = (angles[driver] - at_zero[0]) / pitches[0]
        elif driven in angles:
            phase = (angles[driven] - at_zero[1]) / pitches[1]
        else:
            phase = 0.0
        for gear, zero, pitch in zip((driver, driven), at_zero, pitches, strict=True):
            stands = zero + phase * pitch
            # A whole number of pitches is the same place.
            misfit = (angles.setdefault(gear, stands) - stands) / pitch
            if abs(misfit - round(misfit)) > _MISFIT:
                raise CouplingError(
                    f"{driver} -> {driven}: the gears form a loop that cannot be assembled: teeth of {gear} would "
                    f"stand {abs(misfit - round(misfit)):.3f} pitches beside the gaps that they belong in; move an "
                    "axis, or change a number of teeth"
                )
        phases[number] = phase
    return phases
