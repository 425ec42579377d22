"""Machine description: shafts, gears, gear pairs, bearings, a housing; the quantities derived from them, and checks.

Speed ratios and senses of rotation follow from the teeth, centre distances from the shafts' axes, torques of the gear
pairs from the torques that enter and leave the train. Parts that cannot form a machine are refused before anything is
solved. :meth:`Machine.assemble` reduces shafts and housing to modes (component mode synthesis) and couples them.
The machine's analyses are its methods: :meth:`Machine.modes`, :meth:`Machine.campbell`,
:meth:`Machine.mesh_error_response`, :meth:`Machine.simulate` and :meth:`Machine.steady`.
"""

import math
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, partial
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.assembly import CoupledMachine, assemble_machine
from gearwhine.coupling.description.arrangement import (
    BACKLASH_OF_A_BRAKE,
    POWER_FROM_THE_DRIVER,
    gravity_findings,
    output_elsewhere,
    table_findings_of_speeds,
)
from gearwhine.coupling.description.axial_location import AxialLocation, axial_support
from gearwhine.coupling.description.excitation import Run, machine_driving, unbalanced_torque
from gearwhine.coupling.description.gear_train import (
    GearedShafts,
    GearTrain,
    GivenSpeed,
    MeshStart,
    Output,
    carrying_flanks,
    drive_ratio,
    gear_train,
    geometry_on_axes,
    imbalances_of_shafts,
    mesh_starts,
    require_balanced_outputs,
)
from gearwhine.coupling.description.parts import (
    Shaft,
    ShaftGear,
    TorqueSupport,
    bearing_findings,
    carrier_findings,
    carrying_length,
    gear_inertia_on_shaft,
    inertia_with_discs,
    name_findings,
    rim_findings,
    rotor_with_gears,
    station_findings,
)
from gearwhine.coupling.description.planetary import PlacedSet, PlanetarySet, SetMember, placed_set, set_findings
from gearwhine.coupling.description.solids import force_findings, machine_findings, unbalance_findings
from gearwhine.coupling.description.thrust import ThrustPair, require_thrust_carried
from gearwhine.coupling.errors import CouplingError, EquilibriumNotFoundError
from gearwhine.coupling.gears import Gear, GearError, GearPairGeometry
from gearwhine.coupling.gears.contact.contact_law import law_between_rims
from gearwhine.coupling.gears.contact.face_slices import face_stations
from gearwhine.coupling.gears.geometry.pair import turning_sense
from gearwhine.coupling.gears.geometry.pitch_deviations import has_different_teeth
from gearwhine.coupling.gears.loaded.gear_pair import GearPair, LoadedGearPair, load_gear_pair, operation_findings
from gearwhine.coupling.gears.stiffness.beam import PlaneState
from gearwhine.coupling.gears.stiffness.models import follows_load, rim_compliances
from gearwhine.coupling.gears.stiffness.rim_on_hub import rotation_shares, shift_shares
from gearwhine.coupling.linear.campbell import SystemCampbell, system_campbell
from gearwhine.coupling.linear.complex_modes import CoupledModes, coupled_modes
from gearwhine.coupling.linear.frequency_response import FrequencyResponse, mesh_error_response
from gearwhine.coupling.machine.base_motion import BaseMotion
from gearwhine.coupling.machine.bearing_laws import RollingLaw
from gearwhine.coupling.machine.components import (
    HousingComponent,
    RotorComponent,
    component_of_housing,
    rotor_component,
)
from gearwhine.coupling.machine.coupled_system import times_over_turn
from gearwhine.coupling.machine.driving_frequencies import least_sampling_rate
from gearwhine.coupling.machine.face_compliance import face_compliance
from gearwhine.coupling.machine.gear_bodies import (
    BodyOutOfPlane,
    GearBody,
    body_out_of_plane,
    rim_spring,
    stiffest,
)
from gearwhine.coupling.machine.loads import (
    BowReactions,
    MachineLoads,
    Ripple,
    ShaftForce,
    Torque,
    TorqueOverTime,
    Unbalance,
    largest_torques,
)
from gearwhine.coupling.machine.mounted_parts import GearMesh, MountedBearing, MountedGear
from gearwhine.coupling.machine.pins import MountedPin, stiff_pin
from gearwhine.coupling.machine.reduced_component import component_of_reduced_housing
from gearwhine.coupling.machine.shaft_dashpots import ShaftDashpots
from gearwhine.coupling.machine.speed_profile import TorqueLine
from gearwhine.coupling.periodic.response import PeriodicResponse
from gearwhine.coupling.periodic.settling import SettledMotion, circles, settled_response
from gearwhine.coupling.periodic.shooting import periodic_response
from gearwhine.coupling.statics.operating_point import FlankGap, OperatingPoint, flank_gaps, linearised_about
from gearwhine.coupling.statics.operating_point_search import solve_operating_point
from gearwhine.coupling.statics.static_model import (
    StaticGear,
    StaticPair,
    StaticShaftPart,
    static_bearing,
    static_pair,
)
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.coupling.time.settings import TransientSettings
from gearwhine.coupling.time.transient import Motion, simulate
from gearwhine.housing import HousingModes
from gearwhine.housing.reduced import ReducedHousing
from gearwhine.numerics.findings import (
    Finding,
    Instance,
    Number,
    Numbers,
    Rule,
    Text,
    attribute_findings,
    kind_findings,
    refuse,
)
from gearwhine.numerics.materials import material_findings
from gearwhine.numerics.own_copies import keep_tuples, unchecked
from gearwhine.numerics.progress import Progress, silent
from gearwhine.rotors import Coupling, EquilibriumError, Rotor, Segment, modal_rotor
from gearwhine.rotors.analyses.static_stiffness import static_shaft
from gearwhine.rotors.analyses.unbalance import bow_shape

FloatArray = npt.NDArray[np.float64]

_ROUNDING = 1e-6  # part of a force by which two operating points differ by rounding

_ROUNDS = 20  # largest number of rounds in which forces and stiffness of teeth settle; each leaves at most a quarter
_SETTLED_FORCE = 1e-6  # change of a mesh force in the last round, over the largest

_GEOMETRIC = frozenset(
    (
        "_geometries",
        "_mesh_starts",
        "_rotors",
        "bodies_out_of_plane",
        "carrying_pairs",
        "constant_torques",
        "findings",
        "gear_bodies",
        "housing_component",
        "mesh_frequencies",
        "mesh_phases",
        "mesh_speeds",
        "pair_geometries",
        "pair_torques",
        "placed_sets",
        "speeds",
        "support_torques",
        "train",
        "turning_senses",
        "unbalanced_torque",
    )
)
"""What a machine keeps that follows neither from its bearings' stiffness nor from its flanks' misalignment."""


@dataclass(frozen=True, repr=False)
class Machine:
    """A gearbox or a rotor train as a list of its parts, at one speed and torque.

    Attributes
    ----------
    shafts : sequence of Shaft
    bearings : sequence of MountedBearing
        Bearings, each on a shaft, in a seat of the housing or on the ground.
    gears : sequence of ShaftGear
    gear_pairs : sequence of GearPair
        The driver of the first one turns at ``speed`` and takes ``torque`` in.
    speed : float
        Signed speed of the first driver's shaft about z [rad/s]; of every shaft where there are no gear pairs.
        Where that shaft is held or a planet, the carrier is in its place, see ``input_shaft``.
    torque : float
        Driving torque on the first driver's shaft [N m]; negative where it brakes.
    outputs : sequence of Output
        Shafts where the torque leaves; by default the shafts that drive no other, with equal power.
    housing : HousingModes, ReducedHousing or HousingComponent, optional
        Result of :meth:`gearwhine.Housing.modes`, or a :class:`gearwhine.housing.reduced.ReducedHousing`.
    torque_at : float
        Station of the input torque, from the left end of its shaft [m].
    forces : sequence of ShaftForce
        Constant forces from outside, such as belts and weights on the ends of shafts.
    torque_over_time : TorqueOverTime, optional
        Torque added to the input over time; the outputs share it in their proportions, unless one has its own.
    ripple : sequence of Ripple
        Harmonic parts of the input torque.
    motor : TorqueLine, optional
        Input torque over speed, of a run whose speed is free.
    load : TorqueLine, optional
        Torque over speed that the outputs take in all, at the first driver's shaft, of such a run; by default
        ``torque`` at any speed.
    base : BaseMotion, optional
        Motion of the ground under bearings and the housing's supports.
    gravity : sequence of float, optional
        Acceleration of free fall along x, y, z [m/s²]; parts have no weight by default.
    torque_supports : sequence of TorqueSupport
        Shafts held from turning, such as the ring of a planetary set.
    input_shaft : str, optional
        Shaft that turns at ``speed`` and takes ``torque`` in, in place of the first driver's.
    given_speeds : sequence of GivenSpeed
        Speeds of further driven shafts, as of a differential with two inputs.
    planetary_sets : sequence of PlanetarySet
        Planetary sets, by the names of their parts, for what is checked and told of sets.

    Raises
    ------
    CouplingError
        Where a name is given twice or unknown, no gear pair turns a shaft, a loop of pairs locks, gears are a pair
        twice, both gears of a pair sit on one shaft, a carrier does not carry its planets, members of the train are
        driven against each other or left without a drive, faces are not in one plane, outputs do not balance the torque
        or nothing takes it, a part is beyond the end of its shaft, power flows from driven to driver, a bearing sits in
        a seat that the housing does not have or that it misses, its table does not hold its speed, or nothing carries
        the thrust of helical gears.
    gearwhine.coupling.gears.GearError
        Where the gears of a pair do not fit each other at the distance of their shafts.
    """

    shafts: Sequence[Shaft]
    bearings: Sequence[MountedBearing] = ()
    gears: Sequence[ShaftGear] = ()
    gear_pairs: Sequence[GearPair] = ()
    speed: float = 0.0
    torque: float = 0.0
    outputs: Sequence[Output] = ()
    housing: HousingComponent | HousingModes | ReducedHousing | None = None
    torque_at: float = 0.0
    forces: Sequence[ShaftForce] = ()
    torque_over_time: TorqueOverTime | None = None
    ripple: Sequence[Ripple] = ()
    motor: TorqueLine | None = None
    load: TorqueLine | None = None
    base: BaseMotion | None = None
    gravity: Sequence[float] | None = None
    torque_supports: Sequence[TorqueSupport] = ()
    input_shaft: str | None = None
    given_speeds: Sequence[GivenSpeed] = ()
    planetary_sets: Sequence[PlanetarySet] = ()

    def __repr__(self) -> str:
        """Return the numbers of parts, and the operation; the parts hold arrays of thousands of lines."""
        parts = {"shaft": self.shafts, "bearing": self.bearings, "gear": self.gears, "gear pair": self.gear_pairs}
        counts = ", ".join(f"{len(each)} {name}{'' if len(each) == 1 else 's'}" for name, each in parts.items())
        housing = "without" if self.housing is None else "with a"
        rpm = self.speed * 30.0 / np.pi
        return f"<Machine: {counts}, {housing} housing; {rpm:.5g} rpm, {self.torque:.5g} N·m>"

    def __post_init__(self) -> None:
        """Require unique names, existing stations and seats, meshing gears, and balanced power and thrust."""
        keep_tuples(self, "shafts", "bearings", "gears", "gear_pairs", "outputs", "forces", "ripple", "gravity")
        keep_tuples(self, "torque_supports", "given_speeds", "planetary_sets")
        refuse(_type_findings(self), CouplingError)
        refuse(name_findings(self), CouplingError)
        refuse([*carrier_findings(self), *set_findings(self.planetary_sets, self)], CouplingError)
        refuse([*station_findings(self), *bearing_findings(self, self.housing_component)], CouplingError)
        refuse(self._reach_findings(), CouplingError)
        _ = self.speeds, self.pair_geometries, self.constant_torques
        self._require_power_flow()
        self._require_thrust_carried()
        refuse(self.findings, CouplingError)

    def _reach_findings(self) -> Iterator[Finding]:
        """Yield bearings whose table does not hold the speed of their shaft."""
        for mounted in self.bearings:
            speeds = mounted.bearing.speeds
            if speeds is not None:
                part, turning = ("bearing", mounted.bearing.name), abs(self.bearing_speed(mounted))
                yield from table_findings_of_speeds(part, mounted.rotor, speeds.tolist(), [turning])

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What is impossible or unlikely of the machine: places of its parts, meshes, loads and speeds."""
        return tuple(self._findings())

    def _findings(self) -> Iterator[Finding]:
        meshing = [frozenset((pair.driver, pair.driven)) for pair in self.gear_pairs]
        motions = {} if self.housing_component is None else self.housing_component.ring_motions
        rings = {name: (motion.shape[-1] - 2) // 4 for name, motion in motions.items()}
        yield from machine_findings(self.shafts, self.gears, self.bearings, meshing)
        yield from self._doubted_materials()
        for shaft in self.shafts:
            tips = [mounted.gear.outer_radius for mounted in self._gears_on(shaft.name)]
            yield from unbalance_findings(shaft, self.rotor(shaft.name), max(tips, default=0.0))
            yield from rim_findings(shaft, self._gears_on(shaft.name), rings, meshing)
        for place, force in enumerate(self.forces):
            yield from force_findings(force, self.shaft(force.rotor).rotor, place)
        if self.gravity is not None:
            yield from gravity_findings(self.gravity)
        for mounted in self.gears:
            yield from mounted.gear.findings
        for placed in self.placed_sets:
            yield from placed.findings()
        rows = zip(self.gear_pairs, self.pair_geometries, self.pair_torques, self.mesh_speeds, strict=True)
        for pair, geometry, torque, speed in rows:
            yield from pair.findings(geometry)
            if geometry.has_face:
                yield from operation_findings(geometry, torque, speed)

    def _doubted_materials(self) -> Iterator[Finding]:
        """Yield unlikely materials of shafts and of the housing; a shaft without mass is a spring, and no error."""
        for shaft in self.shafts:
            parts = (part.material for part in shaft.rotor.segments if isinstance(part, Segment))
            for one in sorted({(part.youngs_modulus, part.poisson_ratio, part.density) for part in parts}):
                doubts = material_findings(("shaft", shaft.name), *one)
                yield from (
                    replace(doubt, attribute=f"material.{doubt.attribute}")
                    for doubt in doubts
                    if doubt.severity == "warning"
                )
        if isinstance(self.housing, HousingModes):
            yield from self.housing.housing.findings

    @cached_property
    def housing_component(self) -> HousingComponent | None:
        """The housing as a component of the coupled system."""
        if isinstance(self.housing, ReducedHousing):
            return component_of_reduced_housing(self.housing)
        if not isinstance(self.housing, HousingModes):
            return self.housing
        return component_of_housing(self.housing, participates=self.moves_housing_as_a_body)

    @property
    def moves_housing_as_a_body(self) -> bool:
        """Whether the base moves or there is weight, which act on the housing by its participation."""
        return self.base is not None or self.gravity is not None

    @cached_property
    def train(self) -> GearTrain:
        """The gear train."""
        names = [shaft.name for shaft in self.shafts]
        return gear_train(
            map(self._geared_shafts, self.gear_pairs),
            names,
            held=dict.fromkeys(support.shaft for support in self.torque_supports),
            planets=[shaft.name for shaft in self.shafts if shaft.carrier is not None],
            given={given.shaft: self._given_ratio(given) for given in self.given_speeds},
            first=self.input_shaft,
        )

    @cached_property
    def placed_sets(self) -> tuple[PlacedSet, ...]:
        """The planetary sets with their gears at their places: assembly, clearance, phasing."""
        return tuple(placed_set(one, self) for one in self.planetary_sets)

    def members_of(self, placed: PlacedSet) -> tuple[SetMember, ...]:
        """Speed, torque and power of the members of a planetary set."""
        return placed.members(self.train, self.pair_torques, self.speed)

    def _geared_shafts(self, pair: GearPair) -> GearedShafts:
        """Shafts that a pair connects, with the carrier that carries an axis of them."""
        driver, driven = self._gears_of(pair)
        carriers = [self.shaft(gear.shaft).carrier for gear in (driver, driven)]
        return GearedShafts(
            driver.shaft, driven.shaft, (driver.gear.teeth, driven.gear.teeth), carriers[0] or carriers[1]
        )

    def _given_ratio(self, given: GivenSpeed) -> Fraction:
        """Speed of a further driven shaft over that of the first driver, a fraction of terms below a million."""
        if self.speed == 0.0:
            part = ("given speed", given.shaft)
            expected = "a speed of the first driver other than 0, over which a second speed is taken"
            refuse([Finding(part, "speed", given.speed, expected)], CouplingError)
        return drive_ratio(given.speed / self.speed)

    @cached_property
    def speeds(self) -> dict[str, float]:
        """Signed speed of each shaft [rad/s]."""
        names = [shaft.name for shaft in self.shafts]
        ratios = self.train.turning_ratios(names, [pair.label for pair in self.gear_pairs])
        return {name: self.speed * float(ratios[name]) for name in names}

    @cached_property
    def turning_senses(self) -> tuple[int, ...]:
        """Sense of rotation of each pair's driver, 1 or -1, relative to the carrier of a planet among the two."""
        return tuple(turning_sense(self.speed) * sense for sense in self.train.senses)

    @cached_property
    def mesh_speeds(self) -> tuple[float, ...]:
        """Signed speed of each pair's driver [rad/s], relative to the carrier of a planet among the two."""
        return tuple(float(shafts.relative_speed(self.speeds)) for shafts in self.train.pairs)

    def bearing_speed(self, mounted: MountedBearing) -> float:
        """Signed speed of a shaft in its bearing [rad/s], relative to a shaft that holds it, as a planet's carrier."""
        around = self.shaft_around(mounted)
        return self.speeds[mounted.rotor] - (0.0 if around is None else self.speeds[around])

    def ratio_on_seats(self, name: str) -> float:
        """Speed of a shaft over that of the first driver, of a planet its speed relative to the carrier."""
        ratios, carrier = self.train.ratios, self.shaft(name).carrier
        return float(ratios.get(name, Fraction(0)) - (0 if carrier is None else ratios[carrier]))

    @property
    def _torque_springs(self) -> list[TorqueSupport]:
        """Torque supports with a stiffness; behind a rigid one the shaft swings at twice the limit of its modes."""
        return [
            replace(support, stiffness=self.rotor(shaft.name).polar_inertia * (2.0 * shaft.mode_limit) ** 2)
            if support.is_rigid
            else support
            for support in self.torque_supports
            for shaft in [self.shaft(support.shaft)]
        ]

    @cached_property
    def support_torques(self) -> dict[str, float]:
        """Mean torque about z by which each held shaft is held [N m]."""
        return self.train.support_torques(self.train.torques_along(self.constant_torques, self.speed), self.speed)

    @cached_property
    def mesh_frequencies(self) -> tuple[float, ...]:
        """Tooth-mesh frequency of each gear pair [Hz]."""
        return self.train.mesh_frequencies(self.speed)

    @cached_property
    def pair_geometries(self) -> tuple[GearPairGeometry, ...]:
        """Both gears of every pair in mesh, at the distance of their shafts, with the numbers of teeth that differ."""
        geometries = self._geometries
        if not any(has_different_teeth(mounted.gear) for mounted in self.gears):
            return geometries
        return tuple(
            replace(geometry, numbering=start.numbering)
            if has_different_teeth(geometry.driver) or has_different_teeth(geometry.driven)
            else geometry
            for geometry, start in zip(geometries, self._mesh_starts, strict=True)
        )

    @cached_property
    def _geometries(self) -> tuple[GearPairGeometry, ...]:
        """Geometry of every pair, without the numbers of teeth."""
        geometries = []
        for pair in self.gear_pairs:
            driver, driven = self._gears_of(pair)
            shafts = self.shaft(driver.shaft), self.shaft(driven.shaft)
            axes = shafts[0].axis, shafts[1].axis
            places = shafts[0].start + driver.at, shafts[1].start + driven.at
            geometries.append(geometry_on_axes(driver.gear, driven.gear, (driver.shaft, driven.shaft), axes, places))
        return tuple(geometries)

    @cached_property
    def mesh_phases(self) -> tuple[float, ...]:
        """Phase of each gear pair at t = 0 [mesh periods].

        Raises
        ------
        CouplingError
            Where gears in a loop cannot be assembled.
        """
        return tuple(start.phase for start in self._mesh_starts)

    @cached_property
    def _mesh_starts(self) -> tuple[MeshStart, ...]:
        """Phase of each pair at t = 0, and numbers of its teeth."""
        lines = []
        for (driver, driven), geometry in zip(map(self._gears_of, self.gear_pairs), self._geometries, strict=True):
            x, y = np.subtract(self.shaft(driven.shaft).axis, self.shaft(driver.shaft).axis)
            side = -1.0 if geometry.is_internal else 1.0
            lines.append(math.atan2(side * y, side * x))
        names = [(pair.driver, pair.driven) for pair in self.gear_pairs]
        drivers, drivens = [first for first, _ in names], [second for _, second in names]
        return tuple(mesh_starts(drivers, drivens, self._geometries, lines, self.turning_senses))

    @cached_property
    def constant_torques(self) -> tuple[Torque, ...]:
        """Torques about z that act from outside: the input first, then the outputs, by default at right ends."""
        if not self.gear_pairs:
            self._require_balance_of_each_shaft()
        first = self.train.first if self.gear_pairs else None
        refuse(
            (
                Finding(("machine", ""), f"outputs.{place}.shaft", first, output_elsewhere(first))
                for place, output in enumerate(self.outputs)
                if first is not None and output.shaft == first
            ),
            CouplingError,
        )
        require_balanced_outputs(self.train, self.torque, self.outputs)
        return self.torques_from_outside(self.torque)

    def torques_from_outside(self, torque: float) -> tuple[Torque, ...]:
        """Return the torques about z by an input torque [N m], which the outputs take in their proportions."""
        ends = {shaft.name: shaft.rotor.length for shaft in self.shafts}
        return self.train.applied_torques(
            torque, self.speed, self.outputs, self.torque_at, ends=ends, given=self.given_speeds
        )

    @cached_property
    def pair_torques(self) -> tuple[float, ...]:
        """Mean torque that each pair takes from its driver [N m], positive where power flows to the driven gear."""
        return self.train.mean_pair_torques(self.constant_torques, self.speed)

    @cached_property
    def carrying_pairs(self) -> tuple[bool, ...]:
        """Whether each gear pair carries a part of the torque; an idle one is pressed by deflections alone."""
        return tuple(flank is not None for flank in carrying_flanks(self.pair_torques, self.torque))

    @property
    def is_loaded(self) -> bool:
        """Whether torque, force, weight or preload loads the shafts in their bearings."""
        preloaded = any(mounted.elements is not None and mounted.elements.is_preloaded for mounted in self.bearings)
        loads = bool(self.torque or self.forces or preloaded) or self.gravity is not None
        return loads and bool(self.bearings)

    @cached_property
    def unbalanced_torque(self) -> float:
        """Largest torque over time that nothing balances, by which the train turns away from its rotation [N m]."""
        return unbalanced_torque(self)

    @cached_property
    def axial_locations(self) -> tuple[AxialLocation, ...]:
        """Axial location of each shaft by its bearings."""
        return tuple(
            AxialLocation(shaft.name, [axial_support(bearing) for bearing in self._bearings_on(shaft.name)])
            for shaft in self.shafts
        )

    @cached_property
    def gear_bodies(self) -> tuple[GearBody, ...]:
        """Bodies of the gears whose rims move on their hubs in motion.

        See :mod:`gearwhine.coupling.machine.gear_bodies`.
        """
        compliances: dict[str, list[tuple[float, float]]] = {}
        states: dict[str, PlaneState] = {}
        for pair, geometry in zip(self.gear_pairs, self.pair_geometries, strict=True):
            of_rims = rim_compliances(pair.stiffness, geometry)
            for name, gear, rim in zip(
                (pair.driver, pair.driven), (geometry.driver, geometry.driven), of_rims, strict=True
            ):
                compliances.setdefault(name, []).append((rim.twist / gear.base_radius**2, rim.shift))
                states[name] = rim.state
        bodies = []
        for mounted in self.gears:
            of_gear = compliances.get(mounted.name, [])
            twisting, shifting = stiffest([twist for twist, _ in of_gear]), stiffest([shift for _, shift in of_gear])
            outward = self.bodies_out_of_plane.get(mounted.name)
            if twisting == shifting == np.inf and outward is None:
                continue
            shaft = self.shaft(mounted.shaft)
            mode_limit = shaft.mode_limit
            limit = mode_limit if len(of_gear) == 1 else np.inf
            mass, polar, _ = gear_inertia_on_shaft(mounted, shaft.rotor)
            twist = rim_spring(twisting, polar, rotation_shares(mounted.gear), limit)
            shift = None
            if mounted.name in states:
                shift = rim_spring(shifting, mass, shift_shares(mounted.gear, states[mounted.name]), limit)
            body = GearBody(mounted.name, mounted.at, twist, shift)
            if outward is not None and outward.kept:
                body = replace(body, plates=outward.kept, limit=mode_limit)
            elif twist is None and shift is None:
                continue
            bodies.append(body)
        return tuple(bodies)

    @cached_property
    def bodies_out_of_plane(self) -> dict[str, BodyOutOfPlane]:
        """Modes out of the plane of the gears with a body on a hub, and which of them the machine follows."""
        bodies = {}
        for mounted in self.gears:
            shaft = self.shaft(mounted.shaft)
            inertia = gear_inertia_on_shaft(mounted, shaft.rotor)
            body = body_out_of_plane(mounted.gear, inertia, shaft.mode_limit)
            if body is not None:
                bodies[mounted.name] = body
        return bodies

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of permitted but unlikely inputs: bearings that do not hold their shaft, and :attr:`findings`."""
        of_location = (text for location in self.axial_locations for text in location.warnings)
        return (*of_location, *map(str, self.findings))

    def shaft(self, name: str) -> Shaft:
        """Return the shaft of this name."""
        return next(shaft for shaft in self.shafts if shaft.name == name)

    def rotor(self, name: str) -> Rotor:
        """Return a shaft's rotor with its gears, which are discs that stiffen it over their faces."""
        if name not in self._rotors:
            self._rotors[name] = rotor_with_gears(self.shaft(name).rotor, self._gears_on(name))
        return self._rotors[name]

    @cached_property
    def _rotors(self) -> dict[str, Rotor]:
        """Rotors with their gears, as far as they have been asked for."""
        return {}

    def loaded_pairs(self, progress: Callable[[str], None] = lambda text: None) -> tuple[LoadedGearPair, ...]:
        """Contact law of every gear pair, and its static mesh under the mean torque.

        Flanks whose misalignment is None take that of the operating point, and pairs that share a torque their part of
        it there, see :attr:`assembled`.
        """
        loaded, pairs = [], self._aligned.gear_pairs
        rows = zip(pairs, self.pair_geometries, self.pair_torques, self.mesh_speeds, strict=True)
        for pair, geometry, torque, speed in rows:
            progress(f"gear pair {pair.driver} -> {pair.driven}")
            driver, driven = (
                inertia_with_discs(gear, self.shaft(gear.shaft).rotor, self._gears_on(gear.shaft))
                for gear in self._gears_of(pair)
            )
            loaded.append(load_gear_pair(pair, geometry, torque=torque, inertias=(driver, driven), speed=speed))
        return tuple(loaded)

    def rotor_components(
        self, *, limit_factor: float = 1.0, progress: Callable[[str], None] = lambda text: None
    ) -> tuple[RotorComponent, ...]:
        """Shafts with their gears, reduced to modes on the bearings' mean stiffness.

        Parameters
        ----------
        limit_factor : float
            Multiplies the frequency limit, or the number, of the retained modes of the shafts.
        progress : callable
            Called with a line of text for each shaft.
        """
        return tuple(self._component(shaft, limit_factor, progress) for shaft in self.shafts)

    def assemble(
        self,
        pairs: Sequence[LoadedGearPair] | None = None,
        components: Sequence[RotorComponent] | None = None,
        run: Run | None = None,
    ) -> CoupledMachine:
        """Assemble the coupled equations of motion.

        Parameters
        ----------
        pairs : sequence of LoadedGearPair, optional
            Pairs; by default :meth:`loaded_pairs`.
        components : sequence of RotorComponent, optional
            Components; by default :meth:`rotor_components`.
        run : SpeedRun or FreeRun, optional
            Speed over time; constant by default.

        Raises
        ------
        CouplingError
            As :func:`gearwhine.coupling.assemble_machine`.
        TransientError
            Where a free speed cannot start or stalls.
        gearwhine.rotors.RotorError
            Where a bearing's table over speed does not reach as far as the speeds.
        """
        pairs = self.loaded_pairs() if pairs is None else pairs
        components = self.rotor_components() if components is None else components
        driving = machine_driving(self, components, run)
        bows = [
            BowReactions(shaft.name, shaft.bow.at, bow_shape(self.rotor(shaft.name), shaft.bow).reactions)
            for shaft in self.shafts
            if shaft.bow is not None
        ]
        loads = MachineLoads(
            unbalances=[
                Unbalance(shaft.name, unbalance.at, unbalance.moment, unbalance.phase)
                for shaft in self.shafts
                for unbalance in shaft.unbalances
            ],
            bows=bows,
            torques=driving.torques,
            drives=driving.drives,
            base=driving.base,
            gravity=driving.gravity,
            forces=self.forces,
        )
        assembled = assemble_machine(
            components,
            self.housing_component,
            speeds=self.speeds,
            bearings=[self._in_displaced_seat(mounted) for mounted in self.bearings],
            meshes=[self._mesh(pair, components) for pair in pairs],
            loads=loads,
            dashpots=[dashpot for shaft in self.shafts for dashpot in _dashpots(shaft.rotor)],
            torque_supports=self._torque_springs,
            speed_range=driving.speed_range,
            speed_ratios=self.train.ratios,
        )
        return replace(assembled, speed_profile=driving.speed_profile)

    def operating_point(self) -> OperatingPoint:
        """Solve static equilibrium under the mean torques: loads, deflections, misalignment, load over the faces.

        Without any torque no flanks carry, and the result has no gear pairs: it is the equilibrium of preloads and
        weight. Teeth whose stiffness depends on the load have that of their own mesh force: of pairs that share a
        torque it is found in rounds, from equal shares on. Teeth of the stiffness k ~ F^α, 1/4 at most, on parts of the
        compliance C settle: with dF = (I + k C)⁻¹ α dF' a change dF' of a round falls to α at most, in √(dFᵀ k⁻¹ dF).

        Raises
        ------
        CouplingError
            Where a load drives a motion that nothing holds, or the torques do not load the gears.
        EquilibriumNotFoundError
            Where no equilibrium is found, or the forces do not balance.
        gearwhine.rotors.EquilibriumError
            Where a rolling bearing is loaded beyond its theory.
        """
        shared = [body for body in self.gear_bodies if self._pair_count(body.gear) > 1]
        alone = [replace(body, twist=None, shift=None) for body in self.gear_bodies if body not in shared]
        rims = {body.gear: body for body in (*shared, *alone) if body in shared or body.plates}
        carrying = any(torque.value != 0.0 for torque in self.constant_torques)
        forces = self._equal_mesh_forces if carrying else np.zeros(0)
        pairs = [self._static_pair(number, force, rims) for number, force in enumerate(forces.tolist())]
        follows = np.array([pair.under is not None for pair in pairs], dtype=bool)
        for _ in range(_ROUNDS):
            point = self._equilibrium(pairs, rims)
            change = np.where(follows, [pair.force for pair in point.pairs] - forces, 0.0)
            if np.abs(change).max(initial=0.0) <= _SETTLED_FORCE * forces[follows].max(initial=0.0):
                return point
            forces = forces + change
            # The structure that the search starts from stays as it is.
            pairs = [
                pair if pair.under is None else replace(pair.under(force), nominal=pair.nominal, under=pair.under)
                for pair, force in zip(pairs, forces.tolist(), strict=True)
            ]
        # Own laws of Python may be steeper than those of teeth.
        raise EquilibriumNotFoundError(
            f"the stiffness of teeth that share a torque does not settle in {_ROUNDS} rounds; their forces still "
            f"change by {np.abs(change).max():.3g} N"
        )

    def _static_pair(self, number: int, force: float, rims: Mapping[str, GearBody]) -> StaticPair:
        """Place a pair in the static model, of teeth as stiff as under a mesh force [N]."""
        pair, geometry = self.gear_pairs[number], self.pair_geometries[number]
        torque, rotation = self.pair_torques[number], self.turning_senses[number]
        driver, driven = self._gears_of(pair)
        axes = self.shaft(driver.shaft).axis, self.shaft(driven.shaft).axis
        gears = self._static_gears((driver, driven), geometry)
        behind = _behind_rims(pair, geometry, rims)
        under = partial(static_pair, pair, geometry, gears, axes, rotation, torque, behind_rims=behind)
        follows = self.train.shares_torque[number] and follows_load(pair.stiffness)
        return replace(under(force), under=under if follows else None)

    def _equilibrium(self, pairs: Sequence[StaticPair], rims: Mapping[str, GearBody]) -> OperatingPoint:
        """Solve static equilibrium with the gear pairs of a static model."""
        try:
            return solve_operating_point(
                [self._static_shaft(shaft, pairs) for shaft in self.shafts],
                [
                    static_bearing(mounted, self.bearing_speed(mounted), self._seat_displacement(mounted))
                    for mounted in self.bearings
                ],
                pairs,
                self.housing_component,
                self.constant_torques,
                self.gravity,
                self.forces,
                list(rims.values()) if pairs else (),
                self._torque_springs,
            )
        except EquilibriumNotFoundError as error:
            of_location = (text for location in self.axial_locations for text in location.warnings)
            raise EquilibriumNotFoundError("; ".join((str(error), *of_location))) from error

    def preload_point(self) -> OperatingPoint:
        """Solve static equilibrium without torques, forces and weight, which gives the bearings' preloads.

        Raises
        ------
        EquilibriumNotFoundError, gearwhine.rotors.EquilibriumError
            As :meth:`operating_point`.
        """
        outputs = [output if output.torque is None else replace(output, torque=0.0) for output in self.outputs]
        return replace(self, torque=0.0, outputs=outputs, forces=(), gravity=None).operating_point()

    @property
    def needs_operating_point(self) -> bool:
        """Whether a bearing's stiffness, a pair's misalignment or its share is still to follow from the loads."""
        return self._needs_flanks or any(mounted.needs_load for mounted in self.bearings)

    @property
    def leaves_flanks_to_load(self) -> bool:
        """Whether a pair has no misalignment, or shares a torque and has no mean force."""
        rows = zip(self.gear_pairs, self.train.shares_torque, strict=True)
        return any(pair.misalignment is None or (shares and pair.mean_force is None) for pair, shares in rows)

    @property
    def _needs_flanks(self) -> bool:
        """Whether a torque on shafts in bearings loads flanks that are left to it."""
        loaded = bool(self.bearings) and any(torque.value != 0.0 for torque in self.constant_torques)
        return loaded and self.leaves_flanks_to_load

    def at_operating_point(self, point: OperatingPoint | None = None) -> "Machine":
        """Return the machine linearised about its static equilibrium.

        Rolling bearings whose stiffness is not given get their tangent stiffness under load, with the force that they
        have there; those with a nonlinear law start there. Pairs whose misalignment is None get the gap over the face
        by the deflection of shafts, bearings and housing. Given stiffness and misalignment stay as they are. Pairs that
        share a torque, as planets do, get their mean force, see :meth:`with_flanks_of`; as carriers turn, tangent,
        force and deflection of bearings are means, too.

        Parameters
        ----------
        point : OperatingPoint, optional
            Operating point; by default :meth:`operating_point`.

        Raises
        ------
        CouplingError, EquilibriumNotFoundError, gearwhine.rotors.EquilibriumError
            As :meth:`operating_point`; and where a bearing leaves its shaft loose under its load.
        """
        points = self.over_turn(self.operating_point() if point is None else point)
        about = self._with_flanks_of(points) if points[0].pairs else self
        return about._linear(
            bearings=tuple(map(linearised_about, zip(*(turned.bearings for turned in points), strict=True)))
        )

    def _linear(self, **parts: Sequence[Any]) -> "Machine":
        """Return the machine with other stiffness of its bearings, or other misalignment of its pairs.

        Neither has a part in the checks, nor in what `_GEOMETRIC` names, which is not found again.
        """
        return unchecked(self, _GEOMETRIC, **parts)

    def with_flanks_of(self, point: OperatingPoint | None) -> "Machine":
        """Return the machine whose pairs have the gap over the face of an operating point, where they give none.

        Pairs that share a torque get their mean force there. As carriers turn, what stands still changes the loads of
        their planets: forces and gaps are means over a common turn, from ``point`` on. Without a point flanks that give
        no misalignment are aligned, and shares those of equal meshes.
        """
        return self._with_flanks_of(() if point is None else self.over_turn(point))

    def _with_flanks_of(self, points: Sequence[OperatingPoint]) -> "Machine":
        open_pairs = [pair.label for pair in self.gear_pairs if pair.misalignment is None]
        gaps = flank_gaps(points, open_pairs)
        pairs = []
        for pair, shares, force in zip(
            self.gear_pairs, self.train.shares_torque, self._mean_mesh_forces(points), strict=True
        ):
            if pair.misalignment is None:
                gap = gaps.get((pair.driver, pair.driven), FlankGap())
                pair = replace(pair, misalignment=0.0, **gap._asdict())
            if shares and pair.mean_force is None:
                pair = replace(pair, mean_force=force)
            pairs.append(pair)
        return self._linear(gear_pairs=tuple(pairs))

    def _mean_mesh_forces(self, points: Sequence[OperatingPoint]) -> list[float]:
        """Mean mesh force of each pair over operating points [N]; that of the torques without any or up to rounding."""
        equal = self._equal_mesh_forces
        if not points or not points[0].pairs:
            return list(equal.tolist())
        mean = np.mean([[pair.force for pair in point.pairs] for point in points], axis=0)
        return list(np.where(np.abs(mean - equal) <= _ROUNDING * equal, equal, mean).tolist())

    def over_turn(self, point: OperatingPoint) -> tuple[OperatingPoint, ...]:
        """Operating points over a common turn of all carriers, from a given one on; that alone where all are alike.

        They stand at :func:`gearwhine.coupling.machine.coupled_system.times_over_turn`. Planets are turned back to
        their first places: their forces and bearings are along the axes that turn with them. Points that the given one
        has with it at these angles are not solved again.

        Raises
        ------
        CouplingError, EquilibriumNotFoundError, gearwhine.rotors.EquilibriumError
            As :meth:`operating_point`.
        """
        names = dict.fromkeys(shaft.carrier for shaft in self.shafts if shaft.carrier is not None)
        times = times_over_turn([self.speeds[name] for name in names])[1:].tolist()
        angles = [{name: self.speeds[name] * time for name in names} for time in times]
        if len(point.over_turn) == 1 or (angles and [one.turned_by for one in point.over_turn[1:]] == angles):
            return point.over_turn
        points = [point]
        for turned_by in angles:
            turned = self
            for carrier, angle in turned_by.items():
                turned = turned.turned(angle, carrier)
            points.append(turned.operating_point().in_carriers(turned_by))
            if len(points) == 2 and points[1].is_alike(point, _ROUNDING):
                return (point,)
        return tuple(points)

    @property
    def _equal_mesh_forces(self) -> FloatArray:
        """Mesh forces by the torques, of pairs that share one by equal shares [N], shape (p,)."""
        rows = zip(self.pair_torques, self.pair_geometries, strict=True)
        return np.array([abs(torque / geometry.driver.base_radius) for torque, geometry in rows])

    def turned(self, angle: float, carrier: str) -> "Machine":
        """Return the machine with a carrier and its planets turned about its axis [rad]."""
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        center = np.array(self.shaft(carrier).axis)
        shafts = [
            replace(shaft, axis=tuple((center + turn @ (np.array(shaft.axis) - center)).tolist()))
            if shaft.carrier == carrier
            else shaft
            for shaft in self.shafts
        ]
        return replace(self, shafts=shafts)

    def linearised(self, point: OperatingPoint | None) -> "Machine":
        """Return the machine whose bearings and flanks that are left to an operating point are those of a given one.

        Parameters
        ----------
        point : OperatingPoint or None
            None for flanks that are aligned where their misalignment is None.

        Raises
        ------
        CouplingError
            Where a bearing is left to an operating point, and there is none.
        """
        if any(mounted.needs_load for mounted in self.bearings):
            if point is None:
                names = [mounted.bearing.name for mounted in self.bearings if mounted.needs_load]
                raise CouplingError(f"no operating point; the stiffness of {', '.join(names)} follows from it")
            return self.at_operating_point(point)
        return self.with_flanks_of(point) if self._needs_flanks else self

    @cached_property
    def _linearised(self) -> "Machine":
        if any(mounted.needs_load for mounted in self.bearings):
            return self.at_operating_point()
        return self._aligned

    @cached_property
    def _aligned(self) -> "Machine":
        """The machine with the flanks of its operating point; as it is where none is found, with a warning."""
        if not self._needs_flanks:
            return self
        try:
            return self.with_flanks_of(self.operating_point())
        except (CouplingError, EquilibriumNotFoundError, EquilibriumError, GearError) as error:
            if any(mounted.needs_load for mounted in self.bearings):
                raise
            unaligned = any(pair.misalignment is None for pair in self.gear_pairs)
            taken = "flanks are taken as aligned" if unaligned else "meshes are taken to share the torque equally"
            message = f"{taken}, as the machine has no operating point: {error}"
            warnings.warn(message, stacklevel=2)
            return self.with_flanks_of(None)

    @cached_property
    def assembled(self) -> CoupledMachine:
        """The coupled equations of motion under constant torques, see :meth:`assemble`; assembled once.

        They are linearised about the operating point where :attr:`needs_operating_point`.
        """
        return self._linearised.assemble()

    def modes(self) -> CoupledModes:
        """Complex natural modes about the mean contact, see :func:`gearwhine.coupling.coupled_modes`.

        Raises
        ------
        ModesError
            Where an eigenpair fails its proof.
        """
        return coupled_modes(self.assembled.system)

    def campbell(
        self,
        speeds: Sequence[float] | FloatArray,
        *,
        frequency_limit: float,
        progress: Progress = silent,
    ) -> SystemCampbell:
        """Campbell diagram: coupled modes over speed and their crossings with the orders of shafts and meshes.

        Parameters
        ----------
        speeds : sequence of float
            Signed speeds of the first driver [rad/s], two or more of one sense, ascending in size; zero may begin them.
        frequency_limit : float
            Branches below it at some speed are followed [rad/s].
        progress : callable

        Raises
        ------
        CouplingError
            For speeds that do not ascend, a limit that is not positive, or a machine that stands still.
        ModesError
            Where a mode fails its proof.
        """
        for shaft in self.shafts:
            ratio = abs(self.speeds[shaft.name] / self.speed) if self.speed != 0.0 else 0.0
            for speed in np.ravel(speeds):
                shaft.rotor.require_speed(ratio * float(speed))
        return system_campbell(self.assembled, speeds, frequency_limit=frequency_limit, progress=progress)

    def mesh_error_response(self, frequencies: FloatArray, *, mesh: int = 0) -> FrequencyResponse:
        """Response of bearings, meshes and sensors to a unit transmission error of one gear pair [1/m].

        Parameters
        ----------
        frequencies : ndarray, shape (f,)
            ω > 0 [rad/s].
        mesh : int
            Index of the gear pair in ``gear_pairs``.

        Raises
        ------
        CouplingError
            Where the machine has no such pair, or its teeth do not touch.
        """
        return mesh_error_response(self.assembled, frequencies, mesh=mesh)

    def steady(self, *, tolerance: float | None = None) -> PeriodicResponse | SettledMotion:
        """Periodic steady state under the excitation of all meshes and unbalances, by shooting.

        Of a machine whose carriers turn it is the motion that the machine settles in.

        Parameters
        ----------
        tolerance : float, optional
            Relative tolerance of the state after a period. Default: 1e-8, and 1e-5 where carriers turn; see
            :func:`gearwhine.coupling.periodic_response` and :func:`gearwhine.coupling.settled_response`.

        Raises
        ------
        CouplingError
            Where the excitations have no common period.
        PeriodicError
            Where no periodic motion is found.
        """
        system = self.assembled.system
        if circles(system):
            return settled_response(system) if tolerance is None else settled_response(system, closure=tolerance)
        return periodic_response(system) if tolerance is None else periodic_response(system, tolerance=tolerance)

    def simulate(
        self,
        revolutions: int,
        discard: int,
        *,
        points_per_revolution: int = 1024,
        tolerance: float = 5e-4,
    ) -> Motion:
        """Integrate the motion at constant speed from static equilibrium, by Newmark's method with adaptive steps.

        Parameters
        ----------
        revolutions : int
            Number of revolutions of the first driver.
        discard : int
            Number of revolutions before the record begins.
        points_per_revolution : int
            Least number of samples of the record in a revolution, doubled until no excitation folds down to a lower
            frequency; the largest step is the interval of so many.
        tolerance : float
            Tolerance of the local error of a step, see :class:`gearwhine.coupling.TransientSettings`.

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
        coupled = self.assembled
        duration, record_from = revolutions * period, discard * period
        least = least_sampling_rate(coupled.system, record_from, duration)[0] * period
        samples = points_per_revolution * 2 ** max(math.ceil(math.log2(max(least / points_per_revolution, 1.0))), 0)
        settings = TransientSettings(
            duration=duration,
            record_from=record_from,
            sample_interval=period / samples,
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
            Naming the shafts, the gears and the forces [N].
        """
        pairs = [
            ThrustPair((shafts.driver, shafts.driven), (pair.driver, pair.driven), geometry, shafts.carrier)
            for shafts, pair, geometry in zip(self.train.pairs, self.gear_pairs, self.pair_geometries, strict=True)
        ]
        largest = largest_torques(self.constant_torques)
        require_thrust_carried(pairs, self.bearings, self.speeds, largest, held=self.train.held)

    def _require_balance_of_each_shaft(self) -> None:
        """Refuse torques that no gear pair leads away and that do not balance on their own shaft.

        Raises
        ------
        CouplingError
            Also where a torque comes in and no output takes it.
        """
        if self.torque != 0.0 and not self.outputs:
            raise CouplingError(
                f"a torque of {self.torque:g} N·m that nothing takes; expected a gear pair or an output that leads it "
                "away"
            )
        if len(self.shafts) == 1 or any(output.torque is None for output in self.outputs):
            return
        for imbalance in imbalances_of_shafts(self.torque, self.outputs):
            raise CouplingError(
                f"shaft {imbalance.shaft!r} takes in {imbalance.entering:g} N·m and gives out {imbalance.leaving:g} "
                f"N·m; expected torques that balance on shaft {imbalance.shaft!r}, as no gear pair leads to or from it"
            )

    def _require_power_flow(self) -> None:
        """Refuse pairs whose driven gear drives the driver, and braked pairs without back flanks."""
        flanks = carrying_flanks(self.pair_torques, self.torque)
        for pair, geometry, flank in zip(self.gear_pairs, self.pair_geometries, flanks, strict=True):
            part = ("gear pair", f"{pair.driver} -> {pair.driven}")
            if flank == "reversed":
                refuse([Finding(part, "", None, POWER_FROM_THE_DRIVER)], CouplingError)
            if flank == "back" and pair.backlash_of(geometry) is None:
                refuse([Finding(part, "backlash", None, BACKLASH_OF_A_BRAKE)], CouplingError)

    def _component(self, shaft: Shaft, limit_factor: float, progress: Callable[[str], None]) -> RotorComponent:
        progress(f"modes of rotor {shaft.name}")
        bearings = self._bearings_on(shaft.name)
        limit, count = shaft.frequency_limit, shaft.mode_count
        if limit is None and count is None:
            limit = shaft.mode_limit
        if shaft.rotor.mass_model == "distributed":
            # A lumped rotor has no more modes than its masses allow.
            limit = None if limit is None else limit_factor * limit
            count = None if count is None else round(limit_factor * count)
        gears = self._gears_on(shaft.name)
        forces = [force for force in self.forces if force.rotor == shaft.name]
        loaded_at = [*((gear.at, gear.gear) for gear in gears), *self._meshes_on(shaft.name)]
        moments_at = list(dict.fromkeys(at for at, gear in loaded_at if gear.helix_angle != 0.0))
        thrusts_at = [*moments_at, *(force.at for force in forces if force.force[2] != 0.0)]
        # The tangent of a rolling bearing's law may vanish where its moments do not stay zero.
        for mounted in bearings:
            if isinstance(mounted.law, RollingLaw):
                moments_at.append(mounted.bearing.at)
                if not mounted.law.floats:
                    thrusts_at.append(mounted.bearing.at)
        seats = self._seats_in(shaft)
        twisted_at = [*seats, *(support.at for support in self.torque_supports if support.shaft == shaft.name)]
        moments_at += seats
        modal = modal_rotor(
            self.rotor(shaft.name),
            [mounted.bearing.at_speed(self.bearing_speed(mounted)) for mounted in bearings],
            frequency_limit=limit,
            count=count,
            gears_at=list(
                dict.fromkeys([*(at for at, _ in loaded_at), *self._ends_of_shared_faces(shaft), *twisted_at])
            ),
            forces_at=[*(force.at for force in forces), *([] if shaft.bow is None else shaft.bow.at.tolist())],
            moments_at=moments_at,
            thrusts_at=thrusts_at,
        )
        names = [gear.name for gear in gears]
        return rotor_component(
            shaft.name,
            modal,
            start=shaft.start,
            damping_ratio=shaft.damping_ratio,
            axis=shaft.axis,
            bodies=[body for body in self.gear_bodies if body.gear in names],
            carrier=shaft.carrier,
            pin=self._displaced_pin(shaft),
            internal_damping=shaft.internal_damping,
        )

    def _mounted_pin(self, shaft: Shaft) -> MountedPin | None:
        """Elastic pin of a planet under its bearings; None of a rigid one."""
        if shaft.pin is None:
            return None
        return shaft.pin.mounted([shaft.start + mounted.bearing.at for mounted in self._bearings_on(shaft.name)])

    def _static_gears(
        self, gears: tuple[ShaftGear, ShaftGear], geometry: GearPairGeometry
    ) -> tuple[StaticGear, StaticGear]:
        """Place both gears of a pair on their shafts, with stations over the common face."""
        placed = []
        for gear, middle in zip(gears, geometry.common_middles, strict=True):
            at = gear.at + middle
            stations = at + face_stations(geometry.face_width)
            carriers = np.clip(stations, *carrying_length(gear, self.shaft(gear.shaft).rotor))
            placed.append(StaticGear(gear.name, gear.shaft, at, carriers, stations - carriers))
        return placed[0], placed[1]

    def _static_shaft(self, shaft: Shaft, pairs: Sequence[StaticPair]) -> StaticShaftPart:
        """Shaft with nodes at bearings, loads and faces."""
        places = [mounted.bearing.at for mounted in self._bearings_on(shaft.name)]
        places += [torque.at for torque in self.constant_torques if torque.rotor == shaft.name]
        places += [force.at for force in self.forces if force.rotor == shaft.name]
        places += [support.at for support in self.torque_supports if support.shaft == shaft.name]
        places += self._seats_in(shaft)
        for pair in pairs:
            for gear in (pair.driver, pair.driven):
                if gear.shaft == shaft.name:
                    places += [gear.at, *gear.carriers.tolist()]
        exact = static_shaft(self.rotor(shaft.name), places)
        acceleration = self._acceleration_on(shaft)
        place = shaft.name, shaft.axis, shaft.start
        pin = self._mounted_pin(shaft)
        return StaticShaftPart(*place, exact, acceleration, shaft.carrier, shaft.rim_seat, pin)

    def _acceleration_on(self, shaft: Shaft) -> tuple[float, ...] | None:
        """Acceleration that acts on a shaft's mass as weight does: free fall, and that of its circling axis [m/s²]."""
        if shaft.carrier is None or self.speeds[shaft.carrier] == 0.0:
            return None if self.gravity is None else tuple(self.gravity)
        outward = np.subtract(shaft.axis, self.shaft(shaft.carrier).axis)
        x, y = (self.speeds[shaft.carrier] ** 2 * outward).tolist()
        fall = (0.0, 0.0, 0.0) if self.gravity is None else self.gravity
        return x + fall[0], y + fall[1], fall[2]

    def shaft_around(self, mounted: MountedBearing) -> str | None:
        """Name of the shaft that holds a bearing: a planet's carrier, or one that is its seat; None for other seats."""
        name = self.shaft(mounted.rotor).carrier or mounted.seat
        return name if any(shaft.name == name for shaft in self.shafts) else None

    def _pin_displacement(self, shaft: str) -> FloatArray | None:
        """Displacement of a planet's pin by its error over x, y, z and the rotations about x, y; None without one."""
        planet = self.shaft(shaft)
        if planet.carrier is None or not any(planet.pin_error):
            return None
        x, y = np.subtract(planet.axis, self.shaft(planet.carrier).axis) / math.dist(
            planet.axis, self.shaft(planet.carrier).axis
        )
        radial, tangential = planet.pin_error
        return np.array([radial * x - tangential * y, radial * y + tangential * x, 0.0, 0.0, 0.0])

    def _seat_displacement(self, mounted: MountedBearing, *, of_pin: bool = True) -> FloatArray:
        """Displacement of a bearing's seat by its own error and, of a planet, by its pin's [m, rad], (5,)."""
        pin = self._pin_displacement(mounted.rotor) if of_pin else None
        return mounted.seat_displacement if pin is None else mounted.seat_displacement + pin

    def _in_displaced_seat(self, mounted: MountedBearing) -> MountedBearing:
        """Return a bearing with a linear law with the force of its seat's error, but for what a pin has in motion.

        The offset of one that is linear about its load is of the deflection in its seat.
        """
        displacement = self._seat_displacement(mounted, of_pin=not self._pin_has_error(mounted.rotor))
        if not np.any(displacement):
            return mounted
        stiffness = mounted.bearing.at_speed(self.bearing_speed(mounted)).spatial_stiffness
        about = np.zeros(5) if mounted.offset is None else mounted.offset
        return replace(mounted, offset=about - stiffness @ displacement)

    def _pin_has_error(self, planet: str) -> bool:
        """Whether a planet's pin itself is displaced in motion, as a nonlinear law on it has no offset of its own."""
        nonlinear = any(mounted.law is not None for mounted in self._bearings_on(planet))
        return nonlinear and self._pin_displacement(planet) is not None

    def _displaced_pin(self, shaft: Shaft) -> MountedPin | None:
        """Pin of a planet in motion: an elastic one, and a stiff one where it has an error under a nonlinear law."""
        pin = self._mounted_pin(shaft)
        if not self._pin_has_error(shaft.name):
            return pin
        if pin is None:
            pin = stiff_pin([shaft.start + mounted.bearing.at for mounted in self._bearings_on(shaft.name)])
        return replace(pin, displacement=self._pin_displacement(shaft.name))

    def _seats_in(self, shaft: Shaft) -> list[float]:
        """Stations of a shaft at the bearings or pins that it holds, as those of planets, from its left end [m]."""
        places: list[float] = []
        for mounted in self.bearings:
            if self.shaft_around(mounted) == shaft.name:
                held = self.shaft(mounted.rotor)
                pin = self._mounted_pin(held)
                places += [held.start + mounted.bearing.at] if pin is None else pin.walls
        return [min(max(z - shaft.start, 0.0), shaft.rotor.length) for z in dict.fromkeys(places)]

    def _bearings_on(self, shaft: str) -> list[MountedBearing]:
        return [mounted for mounted in self.bearings if mounted.rotor == shaft]

    def _gears_on(self, shaft: str) -> list[ShaftGear]:
        return [gear for gear in self.gears if gear.shaft == shaft]

    def _meshes_on(self, shaft: str) -> list[tuple[float, Gear]]:
        """Stations of a shaft on which mesh forces act, the middles of common faces, each with its gear."""
        return [
            (gear.at + middle, gear.gear)
            for pair, geometry in zip(self.gear_pairs, self.pair_geometries, strict=True)
            for gear, middle in zip(self._gears_of(pair), geometry.common_middles, strict=True)
            if gear.shaft == shaft
        ]

    def _ends_of_shared_faces(self, shaft: Shaft) -> list[float]:
        """Return both ends of the faces in several meshes, as far as the shaft moves with them [m].

        Loads there are ports of the shaft. The load of one mesh, spread over the face, moves the face of the other by
        more than a load in the middle would; a compliance in series with one mesh cannot have that part.
        """
        ends = list[float]()
        for gear in self._gears_on(shaft.name):
            if self._pair_count(gear.name) > 1:
                half = 0.5 * gear.gear.face_width
                ends += np.clip([gear.at - half, gear.at + half], *carrying_length(gear, shaft.rotor)).tolist()
        return ends

    def _pair_count(self, gear: str) -> int:
        """Count the pairs that a gear takes part in."""
        return sum(gear in (pair.driver, pair.driven) for pair in self.gear_pairs)

    def _gears_of(self, pair: GearPair) -> tuple[ShaftGear, ShaftGear]:
        """Driver and driven gear of a pair."""
        gears = {gear.name: gear for gear in self.gears}
        return gears[pair.driver], gears[pair.driven]

    def _mesh(self, loaded: LoadedGearPair, components: Sequence[RotorComponent]) -> GearMesh:
        """Place a pair on its shafts; what the rims of the components turn is no part of its contact law."""
        gears = []
        for gear, middle in zip(self._gears_of(loaded.pair), loaded.geometry.common_middles, strict=True):
            shaft = self.shaft(gear.shaft)
            carried = carrying_length(gear, shaft.rotor)
            modal = next(part.modal for part in components if part.name == shaft.name)
            width = loaded.geometry.face_width
            missing = face_compliance(self.rotor(shaft.name), modal, gear.at + middle, width, carried)
            gears.append(MountedGear(gear.name, shaft.name, gear.at, shaft.axis, carried, missing, shaft.rim_seat))
        bodies = {body.gear: body for part in components for body in part.bodies}
        behind = _behind_rims(loaded.pair, loaded.geometry, bodies)
        contact = law_between_rims(loaded.contact, behind)
        driver, driven = gears
        return GearMesh(
            driver,
            driven,
            loaded.geometry,
            contact,
            loaded.backlash,
            loaded.pair.friction,
            behind_rims=behind,
            faces=loaded.tilting_faces,
            carrier=self._geared_shafts(loaded.pair).carrier,
        )


def _behind_rims(pair: GearPair, geometry: GearPairGeometry, bodies: Mapping[str, GearBody]) -> float:
    """Compliance of those rims of a pair on their hubs that are coordinates, along the line of action [m/N]."""
    gears = zip((pair.driver, pair.driven), (geometry.driver, geometry.driven), strict=True)
    return sum(bodies[name].compliance(gear.base_radius) for name, gear in gears if name in bodies)


def _dashpots(rotor: Rotor) -> list[ShaftDashpots]:
    """Dashpots of the flexible couplings of a rotor."""
    dashpots, left = list[ShaftDashpots](), 0.0
    for part in rotor.segments:
        if isinstance(part, Coupling) and part.is_damped:
            label = f"coupling {len(dashpots) + 1} of {rotor.name}"
            values = (part.lateral_damping, part.tilt_damping, part.torsional_damping, part.axial_damping)
            dashpots.append(ShaftDashpots(label, rotor.name, left, left + part.length, *values))
        left += part.length
    return dashpots


def _type_findings(machine: Machine) -> Iterator[Finding]:
    """Yield parts of a wrong kind, and numbers that are none."""
    part = ("machine", "")
    number = Number()
    yield from attribute_findings(
        part, machine, speed=number, torque=number, torque_at=number, input_shaft=Text(optional=True)
    )
    kinds: dict[str, type] = {
        "shafts": Shaft,
        "bearings": MountedBearing,
        "gears": ShaftGear,
        "gear_pairs": GearPair,
        "outputs": Output,
        "forces": ShaftForce,
        "ripple": Ripple,
        "torque_supports": TorqueSupport,
        "given_speeds": GivenSpeed,
        "planetary_sets": PlanetarySet,
    }
    yield from kind_findings(part, machine, **kinds)
    rules: dict[str, Rule] = {
        "housing": Instance(
            (HousingModes, ReducedHousing, HousingComponent),
            "result of Housing.modes(), a ReducedHousing, or None",
            optional=True,
        ),
        "torque_over_time": Instance(TorqueOverTime, "a TorqueOverTime, or None", optional=True),
        "motor": Instance(TorqueLine, "a TorqueLine, or None", optional=True),
        "load": Instance(TorqueLine, "a TorqueLine, or None", optional=True),
        "base": Instance(BaseMotion, "a BaseMotion, or None", optional=True),
    }
    if machine.gravity is not None:
        rules["gravity"] = Numbers(3)
    if machine.given_speeds and (machine.motor is not None or machine.load is not None):
        expected = "none beside a motor or load over speed: a speed that is free follows from one drive"
        yield Finding(part, "given_speeds", None, expected)
    yield from attribute_findings(part, machine, **rules)
