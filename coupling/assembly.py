"""Assembly of the coupled system by component mode synthesis: components, bearings (5x5 stiffness), gear pairs, loads.

Each component enters in its own modal coordinates (:mod:`gearwhine.coupling.machine.components`: projection onto free
modes, and residual attachment modes in place of the constraint modes of the Craig-Bampton method). Connectors join
them: the 5x5 stiffness and damping matrices of bearings over x, y, z and the rotations about x and y, tooth contacts
along the lines of action, dashpots of couplings (:mod:`gearwhine.coupling.machine.connectors`). The equation of motion
is stated in :class:`gearwhine.coupling.machine.coupled_system.CoupledSystem`; loaded flanks and mean mesh stiffness
come from :mod:`gearwhine.coupling.statics`.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import pairwise

import numpy as np

from gearwhine.coupling.description.gear_train import (
    gear_train,
    geared_names,
    geared_shafts,
    mesh_phases,
    require_balance,
    require_meshing,
    turning_senses,
)
from gearwhine.coupling.description.parts import TorqueSupport, bolted_rotors
from gearwhine.coupling.description.thrust import ThrustPair, require_thrust_carried
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears.contact.sliding_friction import sliding_friction
from gearwhine.coupling.gears.geometry.pair import mesh_frequency
from gearwhine.coupling.gears.loaded.face_load import FaceTangent
from gearwhine.coupling.machine.base_motion import base_loads, gravity_load
from gearwhine.coupling.machine.bearing_laws import RollingLaw
from gearwhine.coupling.machine.components import (
    Component,
    HousingComponent,
    PedestalComponent,
    RotorComponent,
    pedestal_component,
    pin_component,
)
from gearwhine.coupling.machine.connectors import (
    ContactConnector,
    LinearConnector,
    NonlinearConnector,
    Sliding,
    SpeedTable,
    turned,
)
from gearwhine.coupling.machine.coordinates import CoordinateLoads, MachineCoordinates, trains
from gearwhine.coupling.machine.coupled_system import CoupledSystem, HarmonicLoad, embed
from gearwhine.coupling.machine.frames import Frames, in_frame, stiffness_in_frame
from gearwhine.coupling.machine.gear_bodies import transport
from gearwhine.coupling.machine.loads import UNLOADED, AnyTorque, MachineLoads, Torque, largest_torques
from gearwhine.coupling.machine.mesh_face import MeshFace, mesh_face
from gearwhine.coupling.machine.mounted_parts import GearMesh, MountedBearing
from gearwhine.coupling.machine.planets import (
    alike_all_round,
    bearing_frame,
    centrifugal_load,
    centrifugal_stiffness,
    deformed_rim,
    frame_speeds,
    mesh_frame,
    pin_in_walls,
    pin_seat,
    shaft_around,
    turning_rims,
)
from gearwhine.coupling.machine.rotating_inertia import rotating_inertia
from gearwhine.coupling.machine.shaft_dashpots import ShaftDashpots, internal_damping, shaft_dashpots
from gearwhine.coupling.machine.speed_profile import SpeedProfile
from gearwhine.coupling.machine.tooth_friction import sliding_flanks, with_balanced_friction
from gearwhine.coupling.statics.flank_swing import (
    swinging_errors,
    swinging_friction,
    swinging_laws,
    swinging_shuttling,
    turn_waves,
)
from gearwhine.coupling.statics.mean_mesh import MeanMesh, equilibrium_over_turn
from gearwhine.coupling.statics.static_equilibrium import with_loaded_flanks
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.rotors import Bearing

# Clearance between tip and root, in normal modules. Teeth compressed by more would touch there, and no
# steel bends so far.
_GREATEST_COMPRESSION = 0.25

_ROUNDS = 12  # largest number of rounds in which mean forces and faces of meshes that share a torque settle
_SAME_FORCE = 1e-9  # relative difference below which two mean forces are one
_SETTLED_FORCE_CHANGE = 1e-6  # change of the mean forces in the last round, over the largest

_PER_GAP = 16  # number of chords that replace a bearing's cubic between two speeds of its table


@dataclass(frozen=True)
class CoupledMachine:
    """Parts of a machine, and the coupled system assembled from them.

    Attributes
    ----------
    rotors : tuple of RotorComponent
    housing : HousingComponent or None
    bearings : tuple of MountedBearing
    meshes : tuple of GearMesh
    system : CoupledSystem
        Components in the order rotors, housing, pedestals; linear connectors in the order ``bearings``, dashpots of
        couplings, rotation of gear bodies, slopes of torques, tilting of meshes; contacts in the order
        drive flanks of ``meshes``, back flanks.
    loads : MachineLoads
    dashpots : tuple of ShaftDashpots
        Dashpots in the rotors' couplings.
    torque_supports : tuple of TorqueSupport
        Springs that hold shafts from rotation.
    speed_range : tuple of float
        Lowest and highest speed that the machine runs at, as parts of its nominal speeds.
    mean_faces : MeanFaces or None
        Faces of its meshes under the mean load, for the machine at other speeds.
    speed_profile : SpeedProfile or None
        Speed over time of the run that it is assembled for; None at constant speed.
    speed_ratios : mapping of str to Fraction
        Speed of each shaft of the leading rotor's train over that one's, which comes first; exact and signed.
    """

    rotors: tuple[RotorComponent, ...]
    housing: HousingComponent | None
    bearings: tuple[MountedBearing, ...]
    meshes: tuple[GearMesh, ...]
    system: CoupledSystem
    loads: MachineLoads = UNLOADED
    dashpots: tuple[ShaftDashpots, ...] = ()
    torque_supports: tuple[TorqueSupport, ...] = ()
    speed_range: tuple[float, float] = (1.0, 1.0)
    mean_faces: "MeanFaces | None" = None
    speed_profile: SpeedProfile | None = None
    speed_ratios: Mapping[str, Fraction] = field(default_factory=dict)

    @property
    def speeds(self) -> dict[str, float]:
        """Signed speed of each rotor [rad/s]."""
        return {rotor.name: speed for rotor, speed in zip(self.rotors, self.system.speeds, strict=False)}

    @property
    def leading_rotor(self) -> str:
        """The rotor whose speed stands for the machine's: that of the first driver, or the first of all."""
        return next(iter(self.speed_ratios)) if self.speed_ratios else self.rotors[0].name

    @property
    def speed(self) -> float:
        """Signed speed of the leading rotor [rad/s]."""
        return self.speeds[self.leading_rotor]

    @property
    def input_torque(self) -> float:
        """Mean torque on the leading rotor from outside, in its sense of rotation [N m]."""
        torques = (load for load in self.loads.torques if isinstance(load, Torque) and load.rotor == self.leading_rotor)
        return math.copysign(1.0, self.speed) * sum(torque.value for torque in torques)

    @property
    def train_inertia(self) -> float:
        """Polar inertia of the leading rotor's train, reduced to that rotor: Σ J (Ω / Ω_lead)² [kg m²]."""
        speeds, lead = self.speeds, self.leading_rotor
        names = [rotor.name for rotor in self.rotors]
        train = next(train for train in trains(names, geared_names(self.meshes)) if lead in train)
        return rotating_inertia(self.rotors, {name: speeds[name] / speeds[lead] for name in train})

    @property
    def loaded_contacts(self) -> tuple[int, ...]:
        """Number of the contact of each mesh that carries the mean load: its drive flanks, or back flanks if braked."""
        contacts = self.system.contacts
        return tuple(
            number if back is None or not contacts[back].loaded else back
            for number, back in enumerate(_back_contacts(self.meshes))
        )

    @property
    def complete_below_hz(self) -> float | None:
        """Frequency below which no mode of the housing is missing [Hz]; None without one, or of unknown modes."""
        limit = None if self.housing is None else self.housing.complete_below
        return None if limit is None else limit / (2.0 * math.pi)

    def rows(self, component: str, rows: FloatArray) -> FloatArray:
        """Rows over the coordinates of one component, shape (..., m), as rows over all of them, shape (..., n)."""
        components = self.system.components
        return embed(components, [part.name for part in components].index(component), rows)

    @property
    def sensor_rows(self) -> dict[str, FloatArray]:
        """Motion along each sensor by the coordinates of the whole system, shape (n,) each."""
        if self.housing is None:
            return {}
        name = self.housing.name
        return {sensor: self.rows(name, row) for sensor, row in self.housing.sensors.items()}

    def flanks(self, number: int) -> tuple[int, bool]:
        """Mesh of a contact of the system, and whether the contact is its back flanks."""
        backs = _back_contacts(self.meshes)
        return (number, False) if number < len(self.meshes) else (backs.index(number), True)

    def face(self, number: int, contact: ToothContact) -> MeshFace:
        """Face of the flanks of a contact of the system, by its number, with another tooth contact in its place."""
        place, back = self.flanks(number)
        sense = _senses(self.meshes, self.speeds, self.speed_ratios)[place] * (-1 if back else 1)
        return _face(MachineCoordinates(self.system.components, self.speeds), self.meshes[place], sense, contact)

    def at_speed(self, speed: float, *, keep_faces: bool = False) -> "CoupledMachine":
        """Return the machine with its leading rotor at a signed speed [rad/s] and the others in proportion.

        Gyroscopic terms, bearings with tables over speed, unbalance forces and mesh frequencies follow; slopes of
        torques and the speeds between which the machine runs stay the same in rad/s. The components keep their modes,
        which are a basis at any speed. Faces of flanks are solved under the mean load at the speed, which the inertia
        of circling planets changes, or kept, as beside a contact state that is kept.

        Raises
        ------
        CouplingError
            Where the machine stands still, which leaves the ratios of its speeds open.
        gearwhine.rotors.RotorError
            Where the speed is beyond the table of a bearing.
        """
        present = self.speed
        if present == 0.0:
            raise CouplingError(f"rotor {self.leading_rotor!r} stands still; expected a machine that turns")
        return assemble_machine(
            self.rotors,
            self.housing,
            speeds={name: value * (speed / present) for name, value in self.speeds.items()},
            bearings=self.bearings,
            meshes=self.meshes,
            loads=self.loads.at_speed_ratio(speed / present),
            dashpots=self.dashpots,
            torque_supports=self.torque_supports,
            speed_range=_about(self.speed_range, speed / present),
            mean_faces=replace(self.mean_faces, are_kept=True) if keep_faces and self.mean_faces else self.mean_faces,
            speed_ratios=self.speed_ratios,
        )


def assemble_machine(
    rotors: Sequence[RotorComponent],
    housing: HousingComponent | None,
    *,
    speeds: dict[str, float],
    bearings: Sequence[MountedBearing] = (),
    meshes: Sequence[GearMesh] = (),
    loads: MachineLoads = UNLOADED,
    dashpots: Sequence[ShaftDashpots] = (),
    torque_supports: Sequence[TorqueSupport] = (),
    speed_range: tuple[float, float] = (1.0, 1.0),
    mean_faces: "MeanFaces | None" = None,
    speed_ratios: Mapping[str, Fraction] | None = None,
) -> CoupledMachine:
    """Assemble the coupled system of components that exist already.

    :class:`gearwhine.coupling.Machine` makes them of its parts.

    Parameters
    ----------
    rotors : sequence of RotorComponent
    housing : HousingComponent or None
    speeds : dict of str to float
        Signed speed of each rotor [rad/s]; at rest by :func:`gearwhine.coupling.description.gear_train.turning_senses`.
    bearings : sequence of MountedBearing
    meshes : sequence of GearMesh
    loads : MachineLoads
        Loads; by default there are none.
    dashpots : sequence of ShaftDashpots
        Dashpots in the rotors' couplings.
    torque_supports : sequence of TorqueSupport
        Springs that hold shafts from rotation.
    speed_range : tuple of float
        Lowest and highest speed that the machine runs at, as parts of ``speeds``: bearings' tables over speed are
        followed between them.
    mean_faces : MeanFaces, optional
        Faces under the mean load of the machine at another speed, which are taken where nothing of them has changed.
    speed_ratios : mapping of str to Fraction, optional
        Speed of each rotor over that of the leading one, which comes first. By default they follow from the meshes,
        the driver of the first one leading; held rotors and second inputs do not follow.

    Raises
    ------
    CouplingError
        Where a bearing's stiffness has still to follow from its load, a name has no component, two components share
        one, a rotor has no speed, a seat no housing, a train more than one drive, helical gears push a rotor that no
        bearing holds along its axis, or the gears of a pair cannot be in mesh: by speeds that are not in the ratio of
        their teeth, or of one sense; by axes that are not at their centre distance; by faces that are not in one plane.
    gearwhine.rotors.RotorError
        Where a bearing's table does not reach as far as the speeds.
    """
    pedestals = [
        pedestal_component(mounted.bearing.name, mounted.bearing.pedestal)
        for mounted in bearings
        if mounted.seat is None and mounted.bearing.pedestal is not None
    ]
    pins = [pin_component(rotor.name, rotor.pin) for rotor in rotors if rotor.pin is not None]
    components: tuple[Component, ...] = (*rotors, *(() if housing is None else (housing,)), *pedestals, *pins)
    _require_assemblable(components, rotors, bearings, speeds)
    frames = Frames(components, frame_speeds(rotors, bearings, meshes, speeds, bolted_rotors(torque_supports)))
    components = tuple(in_frame(part, speeds.get(part.name, 0.0), frames.of(part.name)) for part in components)
    coordinates = MachineCoordinates(components, speeds)
    if speed_ratios is None:
        speed_ratios = gear_train(map(geared_shafts, meshes), [rotor.name for rotor in rotors]).ratios

    require_meshing(meshes, {rotor.name: rotor.start for rotor in rotors}, speeds)
    require_balance(meshes, loads.torques, speeds)
    held = [name for name, ratio in speed_ratios.items() if not ratio]
    _require_thrust_carried(rotors, speeds, bearings, meshes, loads.torques, held)
    pedestals_by_name = {pedestal.name: pedestal for pedestal in pedestals}
    bearing_connectors = [
        _bearing(coordinates, housing, pedestals_by_name, mounted, speed_range, frames) for mounted in bearings
    ]
    within = [_torque_support(coordinates, housing, support) for support in torque_supports]
    within += _connectors_of_shafts(coordinates, rotors, bearings, dashpots, frames, speed_range)

    senses = _senses(meshes, speeds, speed_ratios)
    phases = mesh_phases(
        [mesh.driver.name for mesh in meshes],
        [mesh.driven.name for mesh in meshes],
        [mesh.geometry for mesh in meshes],
        [mesh.centre_line_angle for mesh in meshes],
        senses,
    )
    sides = list(zip(meshes, senses, phases, strict=True))
    with_back = [side for side in sides if side[0].backlash is not None]
    contacts = [_contact(coordinates, *side) for side in sides]
    contacts += [_contact(coordinates, *side, back=True) for side in with_back]

    acting = frames.loads(_coordinate_loads(coordinates, bearings, loads))
    of_planets = centrifugal_load(coordinates, frames)
    acting.constant += of_planets
    for linear in (*(linear for linear, _ in bearing_connectors), *within):
        if linear.offset is not None:
            acting.constant -= linear.directions @ linear.offset
    system = CoupledSystem(
        components=components,
        speeds=tuple(speeds.get(component.name, 0.0) for component in components),
        linear=(*(linear for linear, _ in bearing_connectors), *within, *acting.dashpots),
        contacts=tuple(contacts),
        load=acting.constant,
        harmonic_loads=tuple(acting.harmonic),
        timed_loads=tuple(acting.timed),
        acceleration_load=coordinates.acceleration_load(geared_names(meshes), loads.drives) + acting.angular,
        centrifugal_load=of_planets + acting.centrifugal,
        nonlinear=tuple(nonlinear for _, nonlinear in bearing_connectors if nonlinear is not None),
    )
    flanks = [(mesh, sense) for mesh, sense, _ in sides] + [(mesh, -sense) for mesh, sense, _ in with_back]

    def turning(still: CoupledSystem) -> CoupledSystem:
        return _in_turning_frames(still, coordinates, bearings, flanks, frames) if frames.turn else still

    system = with_loaded_flanks(system, _back_contacts(meshes), turning)
    with_faces, mean_faces = _with_faces(system, coordinates, flanks, frames, turning, mean_faces)
    system = turning(with_balanced_friction(with_faces))
    return CoupledMachine(
        tuple(rotors),
        housing,
        tuple(bearings),
        tuple(meshes),
        system,
        loads,
        tuple(dashpots),
        tuple(torque_supports),
        speed_range,
        mean_faces,
        speed_ratios=speed_ratios,
    )


def _require_assemblable(
    components: Sequence[Component],
    rotors: Sequence[RotorComponent],
    bearings: Sequence[MountedBearing],
    speeds: Mapping[str, float],
) -> None:
    """Refuse two components of one name, bearings without a stiffness yet, and rotors without a speed."""
    if len({component.name for component in components}) < len(components):
        raise CouplingError(f"components named {[part.name for part in components]}; expected each name once")
    # Linearised about a load it has an offset, and may be without stiffness: an unloaded one.
    loose = [
        mounted.bearing.name
        for mounted in bearings
        if mounted.needs_load and mounted.offset is None and mounted.law is None
    ]
    if loose:
        raise CouplingError(
            f"no stiffness yet for {', '.join(loose)}: it follows from the bearing's load; expected a machine at its "
            "operating point (Machine.at_operating_point)"
        )
    without = [rotor.name for rotor in rotors if rotor.name not in speeds]
    if without:
        raise CouplingError(f"no speed for {', '.join(without)}; expected one for every rotor")


def _connectors_of_shafts(
    coordinates: MachineCoordinates,
    rotors: Sequence[RotorComponent],
    bearings: Sequence[MountedBearing],
    dashpots: Sequence[ShaftDashpots],
    frames: Frames,
    speed_range: tuple[float, float],
) -> Iterator[LinearConnector]:
    """Yield what acts within shafts: centrifugal stiffness, dashpots, transports of their frames, pins in walls."""
    for rotor in rotors:
        if rotor.carrier is not None and frames.of(rotor.name) != 0.0:
            yield centrifugal_stiffness(coordinates, rotor, bearings, frames, speed_range)
    for dashpot in dashpots:
        # In the frame of a carrier a shaft turns by so much less.
        relative = coordinates.speeds[dashpot.rotor] - frames.of(dashpot.rotor)
        rows, connector = shaft_dashpots(dashpot, coordinates.rotor(dashpot.rotor), relative, speed_range)
        yield replace(connector, directions=coordinates.rows(dashpot.rotor, rows).T)
    for rotor in rotors:
        if rotor.internal_damping.any():
            relative = coordinates.speeds[rotor.name] - frames.of(rotor.name)
            connector = internal_damping(rotor, relative, speed_range)
            yield replace(connector, directions=coordinates.rows(rotor.name, connector.directions.T).T)
        yield from _transports(coordinates, rotor, coordinates.speeds[rotor.name], frames.of(rotor.name), speed_range)
    yield from (pin_in_walls(coordinates, rotor) for rotor in rotors if rotor.pin is not None)


def _in_turning_frames(
    system: CoupledSystem,
    coordinates: MachineCoordinates,
    bearings: Sequence[MountedBearing],
    flanks: Sequence[tuple[GearMesh, int]],
    frames: Frames,
) -> CoupledSystem:
    """Turn the directions of all connectors with the carriers, and the rims of gears that circle."""
    of_contacts = [mesh_frame(coordinates, mesh) for mesh, _ in flanks]
    of_linear = [bearing_frame(mounted, coordinates, frames) for mounted in bearings]
    for connector in system.linear[len(bearings) :]:
        tilted = connector.of_contact
        of_linear.append(frames.of_motion(connector.directions) if tilted is None else of_contacts[tilted])
    system = frames.turned(system, of_linear, of_contacts)
    rims = [tuple(turning_rims(coordinates, *flank, frame)) for flank, frame in zip(flanks, of_contacts, strict=True)]
    contacts = zip(system.contacts, rims, strict=True)
    return replace(system, contacts=tuple(replace(one, turning=(*one.turning, *of_rims)) for one, of_rims in contacts))


def _senses(meshes: Sequence[GearMesh], speeds: dict[str, float], ratios: Mapping[str, Fraction]) -> list[int]:
    """Sense of rotation of the driver of each mesh, seen from its carrier; at rest that in which it would turn."""
    at_rest = any(mesh.carrier for mesh in meshes) and not any(speeds.values())
    turning = {name: float(ratio) for name, ratio in ratios.items()} if at_rest else speeds
    return turning_senses(list(map(geared_shafts, meshes)), turning)


def _about(speed_range: tuple[float, float], ratio: float) -> tuple[float, float]:
    """Return a speed range over ``ratio`` times the nominal speeds, widened to contain them."""
    low, high = speed_range
    if low == high or ratio == 0.0:
        return 1.0, 1.0
    return min(low / abs(ratio), 1.0), max(high / abs(ratio), 1.0)


def _back_contacts(meshes: Sequence[GearMesh]) -> list[int | None]:
    """Return the number of each mesh's back-flank contact, after all drive flanks; None where they never meet."""
    after = len(meshes) + np.cumsum([mesh.backlash is not None for mesh in meshes]) - 1
    return [None if mesh.backlash is None else int(at) for mesh, at in zip(meshes, after, strict=True)]


def _bearing(
    coordinates: MachineCoordinates,
    housing: HousingComponent | None,
    pedestals_by_name: dict[str, PedestalComponent],
    mounted: MountedBearing,
    speed_range: tuple[float, float],
    frames: Frames,
) -> tuple[LinearConnector, NonlinearConnector | None]:
    """Assemble a bearing between a shaft and a seat, another shaft, a pedestal or the ground: linear, or with a law.

    A grounded bearing that is alike all round stands still in any frame.
    """
    rotor, at = coordinates.rotor(mounted.rotor), mounted.bearing.at
    around = shaft_around(mounted, coordinates)
    speed = coordinates.speeds[rotor.name] - (0.0 if around is None else coordinates.speeds[around.name])
    bearing = mounted.bearing.at_speed(speed)
    table = _over_speed(mounted.bearing, speed, speed_range)
    # Most bearings hold x and y alone: no rows are spent on the motions that they leave free.
    stiffness, damping = bearing.spatial_stiffness, bearing.spatial_damping
    axes = np.union1d(mounted.bearing.axes, [0, 1])
    if isinstance(mounted.law, RollingLaw):
        # The tangent of a rolling law may vanish where its force does not stay zero. A floating ring slides along z.
        axes = np.array([0, 1, 3, 4]) if mounted.law.floats else np.arange(5)
    relative = coordinates.rows(rotor.name, rotor.motions(at))
    if rotor.pin is not None:
        relative = relative - coordinates.rows(*pin_seat(coordinates, rotor, at))
    elif around is not None:
        relative = relative - coordinates.rows(around.name, around.seat_motions(rotor.axis, rotor.start + at))
    elif mounted.seat is not None:
        if housing is None or mounted.seat not in housing.seats:
            raise CouplingError(f"bearing {bearing.name!r}: no seat {mounted.seat!r} in the housing")
        relative = relative - coordinates.rows(housing.name, housing.seat_motions(mounted.seat, rotor.start + at))
    elif bearing.pedestal is not None:
        relative[:2] -= coordinates.rows(bearing.name, pedestals_by_name[bearing.name].motion)
    elif frames.of(rotor.name) != 0.0 and alike_all_round(mounted):
        resting, stiffness = stiffness, stiffness_in_frame(stiffness, damping, frames.of(rotor.name))
        if speed_range[0] != speed_range[1] and np.any(damping):
            # The dashpot's part is proportional to the speed of the frame.
            ends = np.array(speed_range)
            over_speed = resting + ends[:, None, None] * (stiffness - resting)
            table = SpeedTable(ends, over_speed, np.stack([damping, damping]))
    nonlinear = None
    if mounted.law is not None:
        moving = axes[np.any(relative[axes] != 0.0, axis=1)]
        tangent = stiffness[np.ix_(moving, moving)]
        # A planet's carrier stands still in its own frame; a hollow shaft turns against the axes.
        held = 0.0 if around is None else coordinates.speeds[around.name] - frames.of(around.name)
        nonlinear = NonlinearConnector(
            bearing.name, relative[moving].T, moving, mounted.law, tangent, speed, holder_speed=held
        )
    if table is not None:
        parts = (part[:, axes[:, None], axes] for part in (table.stiffness, table.damping))
        table = SpeedTable(table.speed_ratios, *parts)
    among = np.ix_(axes, axes)
    axis_numbers = tuple(axes.tolist())
    # A nonlinear law includes the offset in the force of its elements.
    offset = None if mounted.offset is None or mounted.law is not None else mounted.offset[axes]
    linear = LinearConnector(
        bearing.name, relative[axes].T, stiffness[among], damping[among], table, axis_numbers, offset
    )
    return linear, nonlinear


def _torque_support(
    coordinates: MachineCoordinates, housing: HousingComponent | None, support: TorqueSupport
) -> LinearConnector:
    """Assemble the spring or the bolts that hold a shaft from rotation against a seat or the ground."""
    rotor = coordinates.rotor(support.shaft)
    rows = coordinates.rows(rotor.name, rotor.motions(support.at))
    rows = np.vstack([rows[:5], coordinates.rotation(support.shaft, support.at)])
    if support.seat is not None:
        if housing is None or support.seat not in housing.seats:
            raise CouplingError(f"torque support of {support.shaft!r}: no seat {support.seat!r} in the housing")
        rows = rows - coordinates.rows(housing.name, housing.section_motions(support.seat, rotor.start + support.at))
    if support.is_rigid:
        raise CouplingError(f"torque support of {support.shaft!r} without a stiffness; expected one [N·m/rad]")
    stiffness = support.stiffness_matrix
    name = f"torque support of {support.shaft}"
    return LinearConnector(name, rows[support.held_motions].T, stiffness, support.damping_time * stiffness)


def _transports(
    coordinates: MachineCoordinates, rotor: RotorComponent, speed: float, frame: float, speed_range: tuple[float, float]
) -> list[LinearConnector]:
    """Rotation of gear bodies' modes with two nodal diameters or more, in the coordinates of the rotor's frame.

    See :mod:`gearwhine.coupling.machine.gear_bodies`.
    """
    connectors = []
    for gear, mode, indices in rotor.plates:
        if speed == 0.0:
            break
        directions = coordinates.rows(rotor.name, np.eye(rotor.size)[indices]).T
        name = f"rotation of {gear}, {mode.name}"
        ratios = np.linspace(*speed_range, 1 if speed_range[0] == speed_range[1] else _PER_GAP + 1)
        laws = [transport(mode, rotor.damping_ratio, ratio * speed, ratio * frame) for ratio in ratios.tolist()]
        table = SpeedTable(ratios, *(np.array(part) for part in zip(*laws, strict=True))) if len(laws) > 1 else None
        nominal = transport(mode, rotor.damping_ratio, speed, frame)
        connectors.append(LinearConnector(name, directions, *nominal, table))
    return connectors


def _contact(
    coordinates: MachineCoordinates, mesh: GearMesh, sense: int, phase: float, *, back: bool = False
) -> ContactConnector:
    """Assemble the tooth contact of a mesh's drive or back flanks; the driver rotates in the given sense."""
    relative = geared_shafts(mesh).relative_speed(coordinates.speeds)
    frequency = mesh_frequency(float(relative), abs(mesh.geometry.driver.teeth))
    name, contact, clearance = mesh.name, mesh.contact, 0.0
    if back:
        name, contact, clearance = f"{name}, back", mesh.contact.back_flanks, mesh.backlash or 0.0
        sense, frequency, phase = -sense, -frequency, mesh.contact.back_flank_offset - phase
    direction, errors = _flank(coordinates, mesh, sense)
    return ContactConnector(
        name,
        direction,
        contact,
        phase,
        frequency,
        errors,
        clearance,
        loaded=not back,
        sliding=_sliding(coordinates, mesh, contact, sense),
        compression_limit=_GREATEST_COMPRESSION * mesh.geometry.driver.module,
    )


def _coordinate_loads(
    coordinates: MachineCoordinates, bearings: Sequence[MountedBearing], loads: MachineLoads
) -> CoordinateLoads:
    """All loads on the coordinates but those that accelerate the trains."""
    total = CoordinateLoads(np.zeros(coordinates.size))
    for torque in loads.torques:
        coordinates.add_torque(total, torque)
    for unbalance in loads.unbalances:
        coordinates.add_unbalance(total, unbalance)
    for bow in loads.bows:
        coordinates.add_bow(total, bow)
    places = {
        mounted.bearing.name: (*rotor.axis, rotor.start + mounted.bearing.at)
        for mounted in bearings
        for rotor in [coordinates.rotor(mounted.rotor)]
    }
    components = coordinates.components
    if loads.base is not None:
        speeds = [coordinates.speeds.get(part.name, 0.0) for part in components]
        harmonic, timed = base_loads(components, speeds, loads.base, places)
        total.harmonic += harmonic
        total.timed += timed
    if loads.gravity is not None:
        total.constant += gravity_load(components, loads.gravity, places)
    for force in loads.forces:
        coordinates.add_force(total, force)
    return total


_FaceState = tuple[MeshFace, FaceTangent, MeanMesh, float]
"""Face of a contact, its tangent under the mean load, its mean mesh, and the mean slope over its face [rad]."""


@dataclass(frozen=True, eq=False)
class MeanFaces:
    """Faces of a machine's meshes under its mean load, by the number of the contact.

    Attributes
    ----------
    system : CoupledSystem
        System without the faces, whose mean load and stiffness they have.
    states : dict of int to tuple
    shuttling : dict of int to list of HarmonicLoad
        Moments of load shuttling on the loaded flanks, whose amplitudes are those at any speed.
    errors : dict of int to list of HarmonicLoad
        Loads by the transmission error and friction of flanks that swing, at sidebands of mesh harmonics.
    are_kept : bool
        Whether they stay under another mean load and stiffness of the same flanks.
    """

    system: CoupledSystem
    states: dict[int, _FaceState]
    shuttling: dict[int, list[HarmonicLoad]]
    errors: dict[int, list[HarmonicLoad]] = field(default_factory=dict)
    are_kept: bool = False

    def moments_under(self, number: int, force: float) -> dict[int, ComplexArray] | None:
        """Moments of load shuttling by mesh harmonic; None where they swing or are not those under a force [N]."""
        loads = self.shuttling.get(number)
        if loads is None or number in self.errors or abs(self.states[number][2].force - force) > _SAME_FORCE * force:
            return None
        rate = self.system.contacts[number].mesh_frequency
        return {load.harmonic_of(rate): load.amplitude for load in loads}

    def hold_in(self, system: CoupledSystem) -> bool:
        """Whether a system has the same flanks, turning, and the same mean load and stiffness unless faces are kept."""
        before = self.system
        if len(before.contacts) != len(system.contacts):
            return False
        flanks = all(
            (one.contact is other.contact or not one.loaded)
            and one.loaded == other.loaded
            and one.clearance == other.clearance
            and one.mesh_frequency * other.mesh_frequency > 0.0
            and np.array_equal(one.direction, other.direction)
            for one, other in zip(before.contacts, system.contacts, strict=True)
        )
        if self.are_kept or not flanks:
            return flanks
        linear = not (before.nonlinear or system.nonlinear)
        same_load = np.array_equal(before.load, system.load)
        return linear and same_load and np.array_equal(before.stiffness, system.stiffness)


def _with_faces(
    system: CoupledSystem,
    coordinates: MachineCoordinates,
    flanks: Sequence[tuple[GearMesh, int]],
    frames: Frames,
    turning: Callable[[CoupledSystem], CoupledSystem],
    known: MeanFaces | None = None,
) -> tuple[CoupledSystem, MeanFaces]:
    """Return the system with flanks that resist tilting and with load shuttling, and their faces.

    ``flanks`` are mesh and sense of each contact of the system, ``turning`` turns its directions with the carriers, and
    ``known`` are the faces of the machine at another speed. See `gearwhine.coupling.machine.mesh_face`.
    """
    mean = known if known is not None and known.hold_in(system) else None
    if mean is None:
        states = _face_states(system, coordinates, flanks, turning)
        moving = turning(with_balanced_friction(_on_faces(system, states, slope_is_found=True)))
        laws, waves = swinging_laws(moving), turn_waves(moving)
        shuttling, errors = dict[int, list[HarmonicLoad]](), dict[int, list[HarmonicLoad]]()
        for number, (face, _, under, _) in states.items():
            if under.force > 0.0:
                contact = system.contacts[number]
                shuttling[number] = (
                    swinging_shuttling(face, contact, laws[number], waves)
                    if number in laws
                    else face.shuttling(under.force, contact.phase, contact.mesh_frequency)[1]
                )
                if number in laws:
                    swings, own = moving.contacts[number], laws[number]
                    errors[number] = swinging_errors(swings, under, own, waves) + swinging_friction(swings, own, waves)
        mean = MeanFaces(system, states, shuttling, errors)
    if not mean.states:
        return system, mean
    together: dict[tuple[float, str], HarmonicLoad] = {}
    for of_mesh, in_frames in ((mean.shuttling, False), (mean.errors, True)):
        for number, loads in of_mesh.items():
            frame = mesh_frame(coordinates, flanks[number][0])
            before, present = (abs(one.contacts[number].mesh_frequency) for one in (mean.system, system))
            for load in loads:
                at_speed = replace(load, frequency=load.frequency * (present / before))
                for part in [at_speed] if in_frames else frames.harmonics(at_speed, frame):
                    # Those of all contacts at one frequency act as one.
                    of_others = together.get(at := (round(part.frequency, 6), part.mechanism))
                    amplitude = part.amplitude if of_others is None else of_others.amplitude + part.amplitude
                    together[at] = replace(part, amplitude=amplitude)
    harmonics = (*system.harmonic_loads, *together.values())
    return replace(_on_faces(system, mean.states, slope_is_found=True), harmonic_loads=harmonics), mean


def _face_states(
    system: CoupledSystem,
    coordinates: MachineCoordinates,
    flanks: Sequence[tuple[GearMesh, int]],
    turning: Callable[[CoupledSystem], CoupledSystem],
) -> dict[int, _FaceState]:
    """Solve the faces of all contacts under the mean load.

    Mean forces, the flanks' tangents under them and the mean motion depend on each other only where meshes share a
    torque. Slopes are the means over a turn of the carriers, as are the flanks' gaps of operating points.
    """
    every = {
        number: _face(coordinates, mesh, sense, contact.contact)
        for number, (contact, (mesh, sense)) in enumerate(zip(system.contacts, flanks, strict=True))
        if contact.loaded
    }
    faces = {number: face for number, face in every.items() if face.yields}
    if not faces:
        return {}
    means, motions = equilibrium_over_turn(turning(system))
    slopes = dict.fromkeys(faces, 0.0)
    for number_of_round in range(_ROUNDS):
        states = {}
        for number, face in faces.items():
            mean = means[number] or MeanMesh(0.0, face.contact.unloaded_mean_mesh_stiffness, 0.0, 0.0)
            tangent = face.tangent(mean.force, _standing_phase(system.contacts[number]))
            states[number] = (face, tangent, mean, slopes[number])
        if number_of_round == 0:
            slopes |= _mean_slopes(turning(_on_faces(system, states, slope_is_found=False)), motions)
            states = {number: (*state[:3], slopes[number]) for number, state in states.items()}
        moving = turning(_on_faces(system, states, slope_is_found=False))
        means, motions = equilibrium_over_turn(moving)
        slopes |= _mean_slopes(moving, motions)
        forces = {number: mean.force for number, (_, _, mean, _) in states.items()}
        changes = [abs(mean.force - forces[n]) for n, mean in enumerate(means) if mean is not None and n in faces]
        if max(changes, default=0.0) <= _SETTLED_FORCE_CHANGE * max(forces.values()):
            break
    return {number: (*state[:3], slopes[number]) for number, state in states.items()}


def _mean_slopes(system: CoupledSystem, motions: FloatArray) -> dict[int, float]:
    """Mean slope over the face of flanks that resist tilting, by motions (t, n) at `CoupledSystem.turn_times` [rad]."""
    placed = list(zip(system.turn_times.tolist(), motions, strict=True))
    return {
        tie.of_contact: float(np.mean([turned(tie.directions, tie.turning, time)[:, 0] @ q for time, q in placed]))
        for tie in system.linear
        if tie.of_contact is not None
    }


def _on_faces(system: CoupledSystem, states: Mapping[int, _FaceState], *, slope_is_found: bool) -> CoupledSystem:
    """Return the system with contacts at the stiffness centres of their faces, and with flanks that resist tilting."""
    contacts, linear, load = list(system.contacts), list(system.linear), system.load.copy()
    for number, (face, tangent, mean, slope) in states.items():
        contact = system.contacts[number]
        contacts[number] = face.centred(contact, tangent, slope)
        if mean.stiffness == 0.0:
            continue  # the mean load opens these flanks
        resisting = face.connector(
            number, contact, tangent, mean.force, mean.stiffness, slope if slope_is_found else None
        )
        assert resisting.offset is not None
        linear.append(resisting)
        load -= resisting.directions @ resisting.offset
    return replace(system, contacts=tuple(contacts), linear=tuple(linear), load=load)


def _face(coordinates: MachineCoordinates, mesh: GearMesh, sense: int, contact: ToothContact) -> MeshFace:
    """Face of the flanks that the driver closes by a rotation of a sense, with a contact law."""
    return mesh_face(coordinates, mesh, sense, contact, _flank(coordinates, mesh, sense)[0])


def _standing_phase(contact: ContactConnector) -> float | None:
    """Mesh phase at which teeth stand; None where they turn."""
    return contact.phase if contact.mesh_frequency == 0.0 else None


def _require_thrust_carried(
    rotors: Sequence[RotorComponent],
    speeds: dict[str, float],
    bearings: Sequence[MountedBearing],
    meshes: Sequence[GearMesh],
    torques: Sequence[AnyTorque],
    held: Sequence[str],
) -> None:
    """Refuse helical gears that push a rotor without an axial coordinate or a bearing that holds it axially."""
    pairs = [
        ThrustPair(
            (mesh.driver.rotor, mesh.driven.rotor),
            (mesh.driver.name, mesh.driven.name),
            mesh.geometry,
            mesh.carrier,
        )
        for mesh in meshes
    ]
    names = {rotor.name for rotor in rotors}
    movable = {rotor.name for rotor in rotors if rotor.modal.axial is not None}
    if all(name in names for pair in pairs for name in pair.rotors):
        require_thrust_carried(pairs, bearings, speeds, largest_torques(torques), movable, held)


def _over_speed(bearing: Bearing, speed: float, speed_range: tuple[float, float]) -> SpeedTable | None:
    """Tabulate a bearing over speed between two parts of a nominal one [rad/s]; None where it is constant.

    The monotone cubic of the table is replaced by chords.
    """
    low, high = speed_range
    if bearing.speeds is None or low == high or speed == 0.0:
        return None
    table = bearing.speeds / abs(speed)
    knots = np.unique([low, high, *(knot for knot in [1.0, *table] if low < knot < high)])
    cuts = [np.linspace(*ends, _PER_GAP, endpoint=False) for ends in pairwise(knots)]
    at = np.append(np.concatenate(cuts), knots[-1])
    bearings = [bearing.at_speed(float(ratio) * speed) for ratio in at]
    return SpeedTable(
        at,
        np.array([bearing.spatial_stiffness for bearing in bearings]),
        np.array([bearing.spatial_damping for bearing in bearings]),
    )


def _sliding(coordinates: MachineCoordinates, mesh: GearMesh, contact: ToothContact, sense: int) -> Sliding | None:
    """Sliding of one side of the teeth, with the law ``contact``; None without friction, or where nothing turns."""
    frame = mesh_frame(coordinates, mesh)
    if mesh.friction == 0.0 or coordinates.speeds[mesh.driver.rotor] == frame:
        return None
    return sliding_flanks(
        coordinates,
        list(zip((mesh.driver, mesh.driven), mesh.stations, strict=True)),
        mesh.geometry,
        sliding_friction(mesh.geometry, contact, mesh.friction),
        mesh.line_of_action(sense),
        frame,
    )


def _flank(coordinates: MachineCoordinates, mesh: GearMesh, sense: int) -> tuple[FloatArray, FloatArray]:
    """Direction of compression and the harmonics of the runout error on one side of the teeth.

    The runout error e_err is subtracted from the compression δ of
    :mod:`gearwhine.coupling.machine.mesh_kinematics`. A gear whose centre circles its shaft with eccentricity
    ε moves by ε (cos, sin)(Ωt + phase) on top of u, so e_err = -e (ε_k - ε_i), to first
    order.
    """
    line = mesh.line_of_action(sense)
    direction = np.zeros(coordinates.size)
    errors = []
    sides = ((mesh.driver, mesh.geometry.driver, line.driver), (mesh.driven, mesh.geometry.driven, line.driven))
    for (mounted, gear, flank), at in zip(sides, mesh.stations, strict=True):
        rotor = coordinates.rotor(mounted.rotor)
        section, rim = rotor.motions(at), rotor.rim_section(mounted.name, at)
        compression = flank.turning(rim[5]) + flank.across(rim) + flank.axial(section)
        axial, *slopes = rotor.plate_rows(mounted.name, flank.arm)[:3]
        compression += flank.along(axial) + (at - mounted.at) * flank.across(np.array(slopes))
        direction += coordinates.rows(mounted.rotor, compression)
        direction += sum(part for part, _ in deformed_rim(coordinates, mounted, flank))
        if gear.eccentricity:
            speed = coordinates.speeds[mounted.rotor] - mesh_frame(coordinates, mesh)
            errors.append([-flank.side * gear.eccentricity, speed, gear.eccentricity_phase - line.angle])
    return direction, np.array(errors, dtype=np.float64).reshape(-1, 3)
