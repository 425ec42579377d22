"""Machine: shafts, gears, gear pairs, bearings and a housing as an engineer lists them, and what follows from the list.

Speed ratios and senses of rotation follow from the teeth, centre distances from the shafts' axes, torques of the gear
pairs from what enters and leaves the train. A list that no machine can have is refused before anything is solved.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import copysign, hypot

import numpy as np
import numpy.typing as npt

from coupling.base_motion import BaseMotion
from coupling.bearing_law import RollingLaw
from coupling.component import HousingComponent, RotorComponent, component_of_housing, rotor_component
from coupling.errors import CouplingError
from coupling.gear_train import (
    LARGEST_OFFSET,
    GearedShafts,
    GearTrain,
    Output,
    gear_train,
    require_balanced_outputs,
    shared_torques,
)
from coupling.gears import Gear, GearPairGeometry
from coupling.gears.gear_pair import GearPair, LoadedGearPair, load_gear_pair
from coupling.histories import histories, transient_outputs
from coupling.loads import AnyTorque, BowReactions, Drive, Torque, Unbalance
from coupling.machine import CoupledMachine, couple
from coupling.motion import Motion
from coupling.mounted import GearMesh, MountedBearing, MountedGear
from coupling.settings import TransientSettings
from coupling.shaft_dashpots import ShaftDashpots
from coupling.thrust import ThrustPair, axial_forces, require_thrust_carried
from coupling.transient import simulate
from housing import HousingModes
from rotors import Bow, Coupling, Disc, Rotor, bow_shape, modal_rotor
from rotors import Unbalance as ShaftUnbalance

FloatArray = npt.NDArray[np.float64]

_LATERAL_LIMIT = 2.0 * np.pi * 8000.0  # of the bending modes of a shaft that says nothing of its own [rad/s]
_SAME_STATION = 1e-6  # part of the rotor's length


@dataclass(frozen=True)
class Shaft:
    """A rotor on its axis in the machine, without its gears.

    Attributes
    ----------
    rotor : rotors.Rotor
        Whose name is the shaft's.
    axis : tuple of float
        x and y of the shaft's line [m].
    start : float
        z of the left end [m].
    damping_ratio : float
        Of the shaft's own material and fits, on every mode of the free shaft.
    unbalances : sequence of rotors.Unbalance
    bow : rotors.Bow, optional
    frequency_limit : float, optional
        Up to which bending modes are kept [rad/s]; what lies above answers statically. 8 kHz by default.
    mode_count : int, optional
        Number of modes of each kind that are kept, in place of the limit.
    """

    rotor: Rotor
    axis: tuple[float, float] = (0.0, 0.0)
    start: float = 0.0
    damping_ratio: float = 0.0
    unbalances: Sequence[ShaftUnbalance] = ()
    bow: Bow | None = None
    frequency_limit: float | None = None
    mode_count: int | None = None

    @property
    def name(self) -> str:
        """Name of the rotor."""
        return self.rotor.name


@dataclass(frozen=True)
class ShaftGear:
    """A gear on a shaft.

    Attributes
    ----------
    gear : coupling.gears.Gear
    shaft : str
        Name of the shaft.
    at : float
        Distance of the middle of the face from the shaft's left end [m].
    inertia : tuple of float, optional
        Mass [kg], polar and diametral moment of inertia [kg m²], in place of those of the gear's geometry; zeros where
        a disc of the rotor stands for the gear.
    """

    gear: Gear
    shaft: str
    at: float
    inertia: tuple[float, float, float] | None = None

    @property
    def name(self) -> str:
        """Name of the gear."""
        return self.gear.name

    @property
    def mass_and_inertias(self) -> tuple[float, float, float]:
        """Mass [kg], polar and diametral moment of inertia [kg m²]."""
        if self.inertia is not None:
            return self.inertia
        return self.gear.mass, self.gear.polar_inertia, self.gear.diametral_inertia


@dataclass(frozen=True)
class Driving:
    """What drives a machine beside its constant torques.

    Attributes
    ----------
    torques : sequence of coupling torques, or None
        In place of the constant ones that follow from the machine's torque; with stations on their rotors.
    drives : sequence of Drive
        Where the torque comes in that speeds a train up.
    rates : tuple of float
        The least and the highest speed that the machine will run at, as parts of its speed.
    base : BaseMotion, optional
        Of the ground.
    gravity : sequence of float, optional
        Acceleration of free fall along x, y, z [m/s²].
    """

    torques: Sequence[AnyTorque] | None = None
    drives: Sequence[Drive] = ()
    rates: tuple[float, float] = (1.0, 1.0)
    base: BaseMotion | None = None
    gravity: Sequence[float] | None = None


CONSTANT = Driving()


@dataclass(frozen=True)
class Machine:
    """A gearbox or a rotor train as a list of its parts, at one speed and torque.

    Attributes
    ----------
    shafts : sequence of Shaft
    bearings : sequence of MountedBearing
        Each on a shaft, in a seat of the housing or on the ground.
    gears : sequence of ShaftGear
    gear_pairs : sequence of GearPair
        The driver of the first one turns at ``speed`` and takes ``torque`` in.
    speed : float
        Signed speed of the first driver's shaft about z [rad/s]; of every shaft where there are no gear pairs.
    torque : float
        That drives the first driver's shaft [N m]; negative where it brakes.
    outputs : sequence of Output
        Shafts where the torque leaves; by default the shafts that drive no other, with equal power.
    housing : housing.HousingModes or HousingComponent, optional
    torque_at : float
        Where the torque comes in, from the left end of its shaft [m].

    Raises
    ------
    CouplingError
        Where a name is given twice or belongs to nothing, no gear pair turns a shaft, a loop of pairs locks, both gears
        of a pair sit on one shaft, faces do not overlap along z, outputs do not balance the torque, a bearing sits in a
        seat that the housing does not have, or nothing carries the thrust of helical gears.
    coupling.gears.GearError
        Where the gears of a pair do not fit each other at the distance of their shafts.
    """

    shafts: Sequence[Shaft]
    bearings: Sequence[MountedBearing] = ()
    gears: Sequence[ShaftGear] = ()
    gear_pairs: Sequence[GearPair] = ()
    speed: float = 0.0
    torque: float = 0.0
    outputs: Sequence[Output] = ()
    housing: HousingComponent | HousingModes | None = None
    torque_at: float = 0.0

    def __post_init__(self) -> None:
        _require_names(self, self.housing_component)
        _ = self.speeds, self.pair_geometries, self.constant_torques
        self._require_planes()
        self._require_thrust_carried()

    @cached_property
    def housing_component(self) -> HousingComponent | None:
        """The housing as a component of the coupled system."""
        return component_of_housing(self.housing) if isinstance(self.housing, HousingModes) else self.housing

    @cached_property
    def train(self) -> GearTrain:
        """The gear train."""
        gears = {gear.name: gear for gear in self.gears}
        return gear_train(
            GearedShafts(
                gears[pair.driver].shaft,
                gears[pair.driven].shaft,
                (gears[pair.driver].gear.teeth, gears[pair.driven].gear.teeth),
            )
            for pair in self.gear_pairs
        )

    @cached_property
    def speeds(self) -> dict[str, float]:
        """Signed speed of each shaft [rad/s]."""
        names = [shaft.name for shaft in self.shafts]
        if not self.gear_pairs:
            return dict.fromkeys(names, self.speed)
        ratios = self.train.require_turning(names, [_label(pair) for pair in self.gear_pairs])
        return {name: self.speed * float(ratios[name]) for name in names}

    @cached_property
    def mesh_frequencies(self) -> tuple[float, ...]:
        """Tooth-mesh frequency of each gear pair [Hz]."""
        gears = {gear.name: gear for gear in self.gears}
        drivers = [gears[pair.driver] for pair in self.gear_pairs]
        return tuple(abs(self.speeds[one.shaft]) * one.gear.teeth / (2.0 * np.pi) for one in drivers)

    @cached_property
    def pair_geometries(self) -> tuple[GearPairGeometry, ...]:
        """Both gears of every pair in mesh, at the distance of their shafts."""
        gears = {gear.name: gear for gear in self.gears}
        found = []
        for pair in self.gear_pairs:
            driver, driven = gears[pair.driver], gears[pair.driven]
            axes = self.shaft(driver.shaft).axis, self.shaft(driven.shaft).axis
            distance = hypot(axes[1][0] - axes[0][0], axes[1][1] - axes[0][1])
            found.append(GearPairGeometry(driver.gear, driven.gear, distance))
        return tuple(found)

    @cached_property
    def constant_torques(self) -> tuple[Torque, ...]:
        """Torques about z that act from outside: the input first, then the outputs, by default at right ends."""
        if not self.gear_pairs:
            ratios = dict.fromkeys((shaft.name for shaft in self.shafts), 1.0)
            first = self.outputs[0].shaft if self.outputs else None
        else:
            ratios = {name: float(ratio) for name, ratio in self.train.ratios.items()}
            first = next(iter(ratios))
        require_balanced_outputs(ratios, self.torque, self.outputs)
        if first is None or self.torque == 0.0:
            return ()
        sense = copysign(1.0, self.speed)
        found = [Torque(first, self.torque_at, sense * self.torque)]
        for output, torque in shared_torques(self.train, ratios, self.torque, self.outputs):
            at = self.shaft(output.shaft).rotor.length if output.at is None else output.at
            against = -sense * copysign(1.0, ratios[output.shaft])
            found.append(Torque(output.shaft, at, against * torque))
        return tuple(found)

    @cached_property
    def pair_torques(self) -> tuple[float, ...]:
        """Mean torque that each pair takes off its driver [N m], positive where power flows to the driven gear."""
        sense = copysign(1.0, self.speed)
        along = dict.fromkeys(self.train.ratios, 0.0)
        for torque in self.constant_torques:
            along[torque.rotor] += torque.value * sense * copysign(1.0, self.train.ratios[torque.rotor])
        return self.train.pair_torques(along)

    def shaft(self, name: str) -> Shaft:
        """The shaft of this name."""
        return next(shaft for shaft in self.shafts if shaft.name == name)

    def rotor(self, name: str) -> Rotor:
        """A shaft's rotor with its gears as discs."""
        rotor = self.shaft(name).rotor
        rigid = [(gear.at, *gear.mass_and_inertias) for gear in self.gears if gear.shaft == name]
        discs = [Disc(*one) for one in rigid if any(one[1:])]
        return Rotor(rotor.name, rotor.segments, [*rotor.discs, *discs], rotor.mass_model)

    def loaded_pairs(self) -> tuple[LoadedGearPair, ...]:
        """Contact law of every gear pair, and its mesh at rest under its mean torque."""
        gears = {gear.name: gear for gear in self.gears}
        found = []
        for pair, geometry, torque in zip(self.gear_pairs, self.pair_geometries, self.pair_torques, strict=True):
            driver, driven = gears[pair.driver], gears[pair.driven]
            inertias = self._inertia_at(driver), self._inertia_at(driven)
            speed = self.speeds[driver.shaft]
            found.append(load_gear_pair(pair, geometry, torque=torque, inertias=inertias, speed=speed))
        return tuple(found)

    def rotor_components(
        self, *, reach: float = 1.0, progress: Callable[[str], None] = lambda text: None
    ) -> tuple[RotorComponent, ...]:
        """Shafts with their gears, reduced to modes on the bearings' mean stiffness.

        Parameters
        ----------
        reach : float
            Multiplies the frequency, or the number, up to which modes of the shafts are kept.
        progress : callable
            Told which shaft is reduced.
        """
        return tuple(self._component(shaft, reach, progress) for shaft in self.shafts)

    def assemble(
        self,
        pairs: Sequence[LoadedGearPair] | None = None,
        components: Sequence[RotorComponent] | None = None,
        driving: Driving = CONSTANT,
    ) -> CoupledMachine:
        """Assemble the coupled equations of motion.

        Parameters
        ----------
        pairs : sequence of LoadedGearPair, optional
            Where they are known already; else :meth:`loaded_pairs`.
        components : sequence of RotorComponent, optional
            Where they are known already; else :meth:`rotor_components`.
        driving : Driving
            Torques that vary, motion of the base, gravity.

        Raises
        ------
        CouplingError
            As :func:`coupling.couple`.
        rotors.RotorError
            Where a bearing's table over speed does not reach as far as the speeds.
        """
        pairs = self.loaded_pairs() if pairs is None else pairs
        components = self.rotor_components() if components is None else components
        bows = [
            BowReactions(shaft.name, shaft.bow.at, bow_shape(self.rotor(shaft.name), shaft.bow).reactions)
            for shaft in self.shafts
            if shaft.bow is not None
        ]
        return couple(
            components,
            self.housing_component,
            speeds=self.speeds,
            bearings=self.bearings,
            meshes=[self._mesh(pair) for pair in pairs],
            unbalances=[
                Unbalance(shaft.name, one.at, one.moment, one.phase)
                for shaft in self.shafts
                for one in shaft.unbalances
            ],
            bows=bows,
            torques=self.constant_torques if driving.torques is None else driving.torques,
            drives=driving.drives,
            rates=driving.rates,
            base=driving.base,
            gravity=driving.gravity,
            dashpots=[one for shaft in self.shafts for one in _dashpots(shaft.rotor)],
        )

    def simulate(
        self,
        revolutions: int,
        discard: int,
        *,
        points_per_revolution: int = 1024,
        tolerance: float = 5e-4,
        driving: Driving = CONSTANT,
    ) -> Motion:
        """March the machine from its static equilibrium, by Newmark's method with steps that adapt.

        Parameters
        ----------
        revolutions : int
            Of the first driver.
        discard : int
            Revolutions before the record begins.
        points_per_revolution : int
            Samples of the record, and the largest step.
        tolerance : float
            Of the local error of a step, see :class:`coupling.TransientSettings`.
        driving : Driving
            Torques that vary, motion of the base, gravity.

        Raises
        ------
        CouplingError
            Where the machine stands still.
        TransientError
            Where the motion cannot be followed or its energies do not balance.
        """
        if self.speed == 0.0:
            raise CouplingError("a machine that stands still has no revolutions; expected a speed")
        period = 2.0 * np.pi / abs(self.speed)
        coupled = self.assemble(driving=driving)
        settings = TransientSettings(
            duration=revolutions * period,
            record_from=discard * period,
            sample_interval=period / points_per_revolution,
            largest_step=period / points_per_revolution,
            tolerance=tolerance,
        )
        result = simulate(coupled.system, settings, transient_outputs(coupled))
        return Motion(coupled, result, histories(coupled, result))

    def _require_thrust_carried(self) -> None:
        """Refuse helical gears that push a shaft which no bearing holds along its axis.

        Raises
        ------
        CouplingError
            With the shafts, the gears and the forces [N].
        """
        gears = {gear.name: gear for gear in self.gears}
        pairs = [
            ThrustPair((gears[pair.driver].shaft, gears[pair.driven].shaft), (pair.driver, pair.driven), geometry)
            for pair, geometry in zip(self.gear_pairs, self.pair_geometries, strict=True)
        ]
        torques: dict[str, float] = {}
        for torque in self.constant_torques:
            torques[torque.rotor] = torques.get(torque.rotor, 0.0) + torque.value
        forces = axial_forces(pairs, self.speeds, torques)
        carriers = {
            name: any(
                mounted.bearing.at_speed(self.speeds[name]).spatial_stiffness[2, 2] > 0.0
                for mounted in self.bearings
                if mounted.rotor == name
            )
            for name in forces
        }
        require_thrust_carried(forces, carriers)

    def _require_planes(self) -> None:
        """Refuse gear pairs on one shaft, and faces that do not overlap along z."""
        gears = {gear.name: gear for gear in self.gears}
        for pair, geometry in zip(self.gear_pairs, self.pair_geometries, strict=True):
            driver, driven = gears[pair.driver], gears[pair.driven]
            places = [self.shaft(one.shaft).start + one.at for one in (driver, driven)]
            apart, reach = abs(places[0] - places[1]), 0.5 * geometry.face_width
            if apart > reach + LARGEST_OFFSET:
                raise CouplingError(
                    f"{_label(pair)}: the gears are {1e3 * apart:.6g} mm apart along z; expected them in one plane, "
                    f"within half a face width, {1e3 * reach:.6g} mm"
                )

    def _component(self, shaft: Shaft, reach: float, progress: Callable[[str], None]) -> RotorComponent:
        progress(f"modes of rotor {shaft.name}")
        held = [mounted for mounted in self.bearings if mounted.rotor == shaft.name]
        limit, count = shaft.frequency_limit, shaft.mode_count
        if limit is None and count is None:
            limit = _LATERAL_LIMIT
        if shaft.rotor.mass_model == "distributed":
            # A lumped rotor has no more modes than its masses allow.
            limit, count = None if limit is None else reach * limit, None if count is None else round(reach * count)
        gears = [gear for gear in self.gears if gear.shaft == shaft.name]
        # The tangent of a rolling bearing's law may vanish where its moments do not stay zero.
        pushed_at = [gear.at for gear in gears if gear.gear.helix_angle != 0.0]
        pushed_at += [mounted.bearing.at for mounted in held if isinstance(mounted.law, RollingLaw)]
        modal = modal_rotor(
            self.rotor(shaft.name),
            [mounted.bearing.at_speed(self.speeds[shaft.name]) for mounted in held],
            frequency_limit=limit,
            count=count,
            gears_at=[gear.at for gear in gears],
            forces_at=() if shaft.bow is None else shaft.bow.at.tolist(),
            moments_at=pushed_at,
            thrusts_at=pushed_at,
        )
        return rotor_component(shaft.name, modal, start=shaft.start, damping_ratio=shaft.damping_ratio, axis=shaft.axis)

    def _mesh(self, loaded: LoadedGearPair) -> GearMesh:
        gears = {gear.name: gear for gear in self.gears}
        driver, driven = (
            MountedGear(one.name, one.shaft, one.at, self.shaft(one.shaft).axis)
            for one in (gears[loaded.pair.driver], gears[loaded.pair.driven])
        )
        return GearMesh(driver, driven, loaded.geometry, loaded.contact, loaded.backlash, loaded.pair.friction)

    def _inertia_at(self, gear: ShaftGear) -> float:
        """Polar inertia of a gear with the discs at its station [kg m²]; of its whole rotor where that is nothing."""
        rotor = self.shaft(gear.shaft).rotor
        inertia = gear.mass_and_inertias[1]
        inertia += sum(
            disc.polar_inertia for disc in rotor.discs if abs(disc.at - gear.at) < _SAME_STATION * rotor.length
        )
        if inertia == 0.0:
            inertia = self.rotor(gear.shaft).polar_inertia
        return inertia if inertia > 0.0 else gear.gear.polar_inertia


def _label(pair: GearPair) -> str:
    return f"gear pair {pair.driver!r} -> {pair.driven!r}"


def _require_names(machine: Machine, housing: HousingComponent | None) -> None:
    """Refuse names given twice, and names of nothing."""
    kinds: Mapping[str, Sequence[str]] = {
        "shaft": [shaft.name for shaft in machine.shafts],
        "gear": [gear.name for gear in machine.gears],
        "bearing": [mounted.bearing.name for mounted in machine.bearings],
    }
    for kind, names in kinds.items():
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise CouplingError(f"{kind} {twice[0]!r} is given {names.count(twice[0])} times; expected each name once")
    if not machine.shafts:
        raise CouplingError("a machine without shafts; expected at least one")
    needed = [(f"bearing {one.bearing.name!r}", "shaft", one.rotor) for one in machine.bearings]
    needed += [(f"gear {one.name!r}", "shaft", one.shaft) for one in machine.gears]
    needed += [(_label(pair), "gear", name) for pair in machine.gear_pairs for name in (pair.driver, pair.driven)]
    needed += [("an output", "shaft", one.shaft) for one in machine.outputs]
    for where, kind, name in needed:
        if name not in kinds[kind]:
            known = ", ".join(map(repr, kinds[kind])) or "none"
            raise CouplingError(f"{where}: no {kind} {name!r}; expected one of {known}")
    for gear in machine.gears:
        machine.shaft(gear.shaft).rotor.require_on_shaft(f"gear {gear.name!r}", gear.at)
    gear_shafts = {gear.name: gear.shaft for gear in machine.gears}
    for pair in machine.gear_pairs:
        if gear_shafts[pair.driver] == gear_shafts[pair.driven]:
            raise CouplingError(
                f"{_label(pair)}: both gears are on shaft {gear_shafts[pair.driver]!r}; expected the driven one on "
                "another"
            )
    seats = () if housing is None else tuple(housing.seats)
    for mounted in machine.bearings:
        if mounted.seat is not None and mounted.seat not in seats:
            known = ", ".join(map(repr, seats)) or "none"
            raise CouplingError(
                f"bearing {mounted.bearing.name!r}: no seat {mounted.seat!r} in the housing; expected one of {known}, "
                "or None for the ground"
            )
        if mounted.seat is None or housing is None or mounted.seat not in housing.seat_axes:
            continue
        centre, axis = housing.seat_axes[mounted.seat], machine.shaft(mounted.rotor).axis
        offset = hypot(axis[0] - centre[0], axis[1] - centre[1])
        if offset > LARGEST_OFFSET:
            raise CouplingError(
                f"bearing {mounted.bearing.name!r}: seat {mounted.seat!r} is {1e3 * offset:.6g} mm off the axis of "
                f"shaft {mounted.rotor!r}; expected a seat on it"
            )


def _dashpots(rotor: Rotor) -> list[ShaftDashpots]:
    """Dashpots of a rotor's flexible couplings."""
    found, left = list[ShaftDashpots](), 0.0
    for part in rotor.segments:
        if isinstance(part, Coupling) and part.is_damped:
            label = f"coupling {len(found) + 1} of {rotor.name}"
            values = (part.lateral_damping, part.tilt_damping, part.torsional_damping, part.axial_damping)
            found.append(ShaftDashpots(label, rotor.name, left, left + part.length, *values))
        left += part.length
    return found
