"""From rotors, a housing, bearings and gear pairs to the coupled system."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from coupling.base_motion import BaseMotion, base_loads, gravity_load
from coupling.bearing_law import RollingLaw
from coupling.component import Component, HousingComponent, RotorComponent, pedestal_component
from coupling.connector import ContactConnector, LinearConnector, NonlinearConnector, Sliding, SpeedTable
from coupling.errors import CouplingError
from coupling.gear_phases import mesh_phases
from coupling.gear_train import require_balance, require_meshing
from coupling.gears import ToothContact, sliding_friction
from coupling.loads import AnyTorque, BowReactions, Drive, LoadedParts, Loads, Unbalance, constant_torques
from coupling.mean_mesh import mean_meshes
from coupling.mounted import GearMesh, MountedBearing
from coupling.pressed_flanks import with_pressed_flanks
from coupling.shaft_dashpots import ShaftDashpots, shaft_dashpots
from coupling.shuttling import shuttling_loads
from coupling.sliding import held_at_speed, sliding_flanks
from coupling.system import CoupledSystem, embed
from coupling.thrust import ThrustPair, axial_forces, require_thrust_carried
from rotors import Bearing

FloatArray = npt.NDArray[np.float64]

# Part of the normal module: the clearance between tip and root. Teeth pressed in by more would touch there, and no
# steel bends so far.
_GREATEST_COMPRESSION = 0.25

_PER_GAP = 16  # straight pieces that stand for a bearing's cubic between two speeds of its table


@dataclass(frozen=True)
class CoupledMachine:
    """The parts, and the coupled system that they make.

    Attributes
    ----------
    rotors : tuple of RotorComponent
    housing : HousingComponent or None
    bearings : tuple of MountedBearing
    meshes : tuple of GearMesh
    system : CoupledSystem
        Components in the order rotors, housing, pedestals; linear connectors as ``bearings``, then the slopes of
        torques; the drive flanks of ``meshes`` first among its contacts, then the back flanks.
    unbalances, bows, torques, drives, base, gravity
        The loads in the system.
    dashpots : tuple of ShaftDashpots
        In the rotors' couplings; their connectors stand behind those of the bearings.
    """

    rotors: tuple[RotorComponent, ...]
    housing: HousingComponent | None
    bearings: tuple[MountedBearing, ...]
    meshes: tuple[GearMesh, ...]
    system: CoupledSystem
    unbalances: tuple[Unbalance, ...] = ()
    bows: tuple[BowReactions, ...] = ()
    torques: tuple[AnyTorque, ...] = ()
    drives: tuple[Drive, ...] = ()
    base: BaseMotion | None = None
    gravity: tuple[float, ...] | None = None
    dashpots: tuple[ShaftDashpots, ...] = ()

    @property
    def speeds(self) -> dict[str, float]:
        """Signed speed of each rotor [rad/s]."""
        return {rotor.name: speed for rotor, speed in zip(self.rotors, self.system.speeds, strict=False)}

    @property
    def leading_rotor(self) -> str:
        """The rotor whose speed stands for the machine's: that of the first driver, or the first of all."""
        return self.meshes[0].driver.rotor if self.meshes else self.rotors[0].name

    @property
    def pressed_contacts(self) -> tuple[int, ...]:
        """Number of the contact of each mesh that its mean load presses: drive flanks, or back flanks if braked."""
        contacts, found, back = self.system.contacts, list[int](), len(self.meshes)
        for number, mesh in enumerate(self.meshes):
            has_back = mesh.backlash is not None
            found.append(back if has_back and contacts[back].drives else number)
            back += has_back
        return tuple(found)

    def at_speed(self, speed: float) -> "CoupledMachine":
        """The machine with its leading rotor at a signed speed [rad/s] and the others in proportion.

        Gyroscopic terms, bearings with tables over speed, unbalance forces and mesh frequencies follow; the components
        keep their modes, which are a basis at any speed.

        Raises
        ------
        CouplingError
            Where the machine stands still, so that nothing tells how its rotors turn together.
        rotors.RotorError
            Where the speed is beyond the table of a bearing.
        """
        present = self.speeds[self.leading_rotor]
        if present == 0.0:
            raise CouplingError(f"rotor {self.leading_rotor!r} stands still; expected a machine that turns")
        return couple(
            self.rotors,
            self.housing,
            speeds={name: value * (speed / present) for name, value in self.speeds.items()},
            bearings=self.bearings,
            meshes=self.meshes,
            unbalances=self.unbalances,
            bows=self.bows,
            torques=self.torques,
            drives=self.drives,
            base=self.base,
            gravity=self.gravity,
            dashpots=self.dashpots,
        )


def couple(
    rotors: Sequence[RotorComponent],
    housing: HousingComponent | None,
    *,
    speeds: dict[str, float],
    bearings: Sequence[MountedBearing] = (),
    meshes: Sequence[GearMesh] = (),
    unbalances: Sequence[Unbalance] = (),
    bows: Sequence[BowReactions] = (),
    torques: Sequence[AnyTorque] = (),
    drives: Sequence[Drive] = (),
    base: BaseMotion | None = None,
    gravity: Sequence[float] | None = None,
    rates: tuple[float, float] = (1.0, 1.0),
    dashpots: Sequence[ShaftDashpots] = (),
) -> CoupledMachine:
    """Tie rotors and housing together and put the loads on.

    Parameters
    ----------
    rotors, housing
        The components.
    speeds : dict of str to float
        Signed speed of each rotor [rad/s].
    bearings, meshes, unbalances, bows, torques
        What ties and drives them.
    drives
        Where the torque comes in that speeds a train up, see :meth:`coupling.loads.LoadedParts.swing`.
    base
        How the ground moves: under bearings, pedestals and the housing's supports alike.
    gravity
        Acceleration of free fall along x, y, z [m/s²]; none by default.
    dashpots
        In the rotors' couplings.
    rates
        The least and the highest speed that the machine will run at, as parts of ``speeds``: bearings' tables over
        speed are followed between them.

    Raises
    ------
    CouplingError
        Where a name has no component, two components share one, a rotor has no speed, a seat no housing, a train more
        than one drive, helical gears push a rotor that no bearing holds along its axis, or the gears of a pair cannot
        be in mesh: by speeds that are not in the ratio of their teeth, or of one sense; by axes that are not at their
        centre distance; by faces that do not overlap.
    rotors.RotorError
        Where a bearing's table does not reach as far as the speeds.
    """
    components: list[Component] = [*rotors]
    if housing is not None:
        components.append(housing)
    pedestals = [
        pedestal_component(mounted.bearing.name, mounted.bearing.pedestal)
        for mounted in bearings
        if mounted.seat is None and mounted.bearing.pedestal is not None
    ]
    components += pedestals
    number = {component.name: i for i, component in enumerate(components)}
    if len(number) < len(components):
        raise CouplingError(f"components named {[part.name for part in components]}; expected each name once")
    without = [rotor.name for rotor in rotors if rotor.name not in speeds]
    if without:
        raise CouplingError(f"no speed for {', '.join(without)}; expected one for every rotor")
    parts = LoadedParts(components, speeds)

    require_meshing(meshes, {rotor.name: rotor.start for rotor in rotors}, speeds)
    require_balance(meshes, torques, speeds)
    _require_thrust_carried(rotors, speeds, bearings, meshes, torques)
    linear, nonlinear = [], []
    for mounted in bearings:
        which, rotor = parts.rotor(mounted.rotor)
        at = mounted.bearing.at
        law = mounted.bearing.at_speed(speeds[mounted.rotor])
        table = _over_speed(mounted.bearing, speeds[mounted.rotor], rates)
        # Most bearings hold x and y alone: no rows are spent on the motions that they leave free.
        held = np.flatnonzero(np.any(law.spatial_stiffness != 0.0, axis=1) | np.any(law.spatial_damping != 0.0, axis=1))
        held = np.union1d(held, [0, 1])
        if isinstance(mounted.law, RollingLaw):
            # Its tangent may vanish where its force does not stay zero.
            held = np.arange(5)
        if table is not None:
            ever = np.any(table.stiffness != 0.0, axis=(0, 2)) | np.any(table.damping != 0.0, axis=(0, 2))
            held = np.union1d(held, np.flatnonzero(ever))
        relative = np.array([embed(components, which, row) for row in rotor.motions(at)])
        if mounted.seat is not None:
            if housing is None or mounted.seat not in housing.seats:
                raise CouplingError(f"bearing {law.name!r}: no seat {mounted.seat!r} in the housing")
            seat = housing.seat_motions(mounted.seat, rotor.start + at)
            relative = relative - [embed(components, number[housing.name], row) for row in seat]
        elif law.pedestal is not None:
            foot = next(part for part in pedestals if part.name == law.name)
            relative[:2] -= [embed(components, number[foot.name], row) for row in foot.motion]
        among = np.ix_(held, held)
        if mounted.law is not None:
            stiffness = law.spatial_stiffness
            moving = held[np.any(relative[held] != 0.0, axis=1)]
            nonlinear.append(
                NonlinearConnector(
                    law.name,
                    relative[moving].T,
                    moving,
                    mounted.law,
                    stiffness[np.ix_(moving, moving)],
                    speeds[mounted.rotor],
                )
            )
        if table is not None:
            table = SpeedTable(
                table.rates, *(part[:, held[:, None], held] for part in (table.stiffness, table.damping))
            )
        linear.append(
            LinearConnector(
                law.name,
                relative[held].T,
                law.spatial_stiffness[among],
                law.spatial_damping[among],
                over_speed=table,
                axes=tuple(held.tolist()),
            )
        )

    within = []
    for given in dashpots:
        which, rotor = parts.rotor(given.rotor)
        rows, law_of_coupling = shaft_dashpots(given, rotor, speeds[given.rotor], rates)
        within.append(replace(law_of_coupling, directions=np.array([embed(components, which, row) for row in rows]).T))

    senses = [1 if speeds[mesh.driver.rotor] >= 0.0 else -1 for mesh in meshes]
    phases = mesh_phases(
        [mesh.driver.name for mesh in meshes],
        [mesh.driven.name for mesh in meshes],
        [mesh.geometry for mesh in meshes],
        [_centre_line_angle(mesh) for mesh in meshes],
        senses,
    )
    drive, back = [], []
    for mesh, sense, phase in zip(meshes, senses, phases, strict=True):
        rate = abs(speeds[mesh.driver.rotor]) * mesh.geometry.driver.teeth / (2.0 * np.pi)
        direction, errors = _flank(components, mesh, parts, speeds, sense)
        name = f"{mesh.driver.name} -> {mesh.driven.name}"
        sliding = _sliding(components, mesh, mesh.contact, parts, speeds, sense)
        greatest = _GREATEST_COMPRESSION * mesh.geometry.driver.module
        drive.append(
            ContactConnector(
                name,
                direction,
                mesh.contact,
                phase,
                rate,
                errors,
                sliding=sliding,
                greatest_compression=greatest,
            )
        )
        if mesh.backlash is not None:
            direction, errors = _flank(components, mesh, parts, speeds, -sense)
            law_of_back, offset = mesh.contact.back_flanks, mesh.contact.back_flank_offset - phase
            back.append(
                ContactConnector(
                    f"{name}, back",
                    direction,
                    law_of_back,
                    offset,
                    -rate,
                    errors,
                    mesh.backlash,
                    drives=False,
                    sliding=_sliding(components, mesh, law_of_back, parts, speeds, -sense),
                    greatest_compression=greatest,
                )
            )

    loads = Loads(np.zeros(sum(component.size for component in components)))
    for torque in torques:
        parts.add_torque(loads, torque)
    for unbalance in unbalances:
        parts.add_unbalance(loads, unbalance)
    for bow in bows:
        parts.add_bow(loads, bow)

    under = {
        mounted.bearing.name: (*rotor.axis, rotor.start + mounted.bearing.at)
        for mounted in bearings
        for rotor in [parts.rotor(mounted.rotor)[1]]
    }
    if base is not None:
        harmonic, timed = base_loads(components, [speeds.get(part.name, 0.0) for part in components], base, under)
        loads.harmonic += harmonic
        loads.timed += timed
    if gravity is not None:
        loads.constant += gravity_load(components, gravity, under)

    system = CoupledSystem(
        components=tuple(components),
        speeds=tuple(speeds.get(component.name, 0.0) for component in components),
        linear=tuple(linear + within + loads.dashpots),
        contacts=tuple(drive + back),
        load=loads.constant,
        harmonic_loads=tuple(loads.harmonic),
        timed_loads=tuple(loads.timed),
        swing=parts.swing([(mesh.driver.rotor, mesh.driven.rotor) for mesh in meshes], drives),
        nonlinear=tuple(nonlinear),
    )
    after = len(drive) + np.cumsum([mesh.backlash is not None for mesh in meshes]) - 1
    backs = [None if mesh.backlash is None else int(at) for mesh, at in zip(meshes, after, strict=True)]
    system = with_pressed_flanks(system, backs)
    sides = [(mesh, sense) for mesh, sense in zip(meshes, senses, strict=True)]
    sides += [(mesh, -sense) for mesh, sense in sides if mesh.backlash is not None]
    system = _with_shuttling(system, parts, sides)
    return CoupledMachine(
        tuple(rotors),
        housing,
        tuple(bearings),
        tuple(meshes),
        held_at_speed(system),
        tuple(unbalances),
        tuple(bows),
        tuple(torques),
        tuple(drives),
        base,
        None if gravity is None else tuple(gravity),
        tuple(dashpots),
    )


def _with_shuttling(system: CoupledSystem, parts: LoadedParts, sides: Sequence[tuple[GearMesh, int]]) -> CoupledSystem:
    """The system with the moments of loads that wander along the face; ``sides`` are its contacts' flanks."""
    if all(contact.contact.faces is None for contact in system.contacts):
        return system
    constant, harmonics = system.load.copy(), list(system.harmonic_loads)
    for contact, mean, (mesh, sense) in zip(system.contacts, mean_meshes(system), sides, strict=True):
        if mean is None or mean.force <= 0.0:
            continue
        push, axial = _push(mesh, sense)
        tilting = np.zeros(system.size)
        for mounted, side in ((mesh.driver, 1.0), (mesh.driven, -1.0)):
            which, rotor = parts.rotor(mounted.rotor)
            rows = rotor.motions(mounted.at)
            tilting += side * embed(system.components, which, push[0] * rows[4] - push[1] * rows[3])
        shifted, moving = shuttling_loads(
            contact.contact, mesh.geometry, mean.force, axial, tilting, contact.phase, contact.rate
        )
        constant += shifted
        harmonics += moving
    return replace(system, load=constant, harmonic_loads=tuple(harmonics))


def _push(mesh: GearMesh, sense: int) -> tuple[tuple[float, float], float]:
    """Unit vector e in the x-y plane along which the driver pushes on one side of the teeth, and the axial part."""
    angle = mesh.geometry.line_of_action_angle(_centre_line_angle(mesh), sense)
    return (float(np.cos(angle)), float(np.sin(angle))), -sense * float(np.tan(mesh.geometry.driver.base_helix_angle))


def _require_thrust_carried(
    rotors: Sequence[RotorComponent],
    speeds: dict[str, float],
    bearings: Sequence[MountedBearing],
    meshes: Sequence[GearMesh],
    torques: Sequence[AnyTorque],
) -> None:
    pairs = [
        ThrustPair((mesh.driver.rotor, mesh.driven.rotor), (mesh.driver.name, mesh.driven.name), mesh.geometry)
        for mesh in meshes
    ]
    held = {
        mounted.rotor
        for mounted in bearings
        if mounted.rotor in speeds and mounted.bearing.at_speed(speeds[mounted.rotor]).spatial_stiffness[2, 2] > 0.0
    }
    carriers = {rotor.name: rotor.modal.axial is not None and rotor.name in held for rotor in rotors}
    if all(name in carriers for pair in pairs for name in pair.rotors):
        require_thrust_carried(axial_forces(pairs, speeds, constant_torques(torques)), carriers)


def _centre_line_angle(mesh: GearMesh) -> float:
    """Angle from x of the line from the driver's centre to the driven gear's [rad]."""
    x, y = np.subtract(mesh.driven.axis, mesh.driver.axis)
    return float(np.arctan2(y, x))


def _over_speed(bearing: Bearing, speed: float, rates: tuple[float, float]) -> SpeedTable | None:
    """A bearing's law between two speeds, as parts of a nominal one [rad/s]; None where it does not change.

    Its monotone cubic is cut into straight pieces.
    """
    if bearing.speeds is None or rates[0] == rates[1] or speed == 0.0:
        return None
    table = bearing.speeds / abs(speed)
    knots = np.unique([*rates, *(knot for knot in [1.0, *table] if rates[0] < knot < rates[1])])
    cuts = [np.linspace(low, high, _PER_GAP, endpoint=False) for low, high in pairwise(knots)]
    at = np.append(np.concatenate(cuts), knots[-1])
    laws = [bearing.at_speed(float(rate) * speed) for rate in at]
    return SpeedTable(
        at, np.array([law.spatial_stiffness for law in laws]), np.array([law.spatial_damping for law in laws])
    )


def _sliding(
    components: Sequence[Component],
    mesh: GearMesh,
    contact: ToothContact,
    parts: LoadedParts,
    speeds: dict[str, float],
    sense: int,
) -> Sliding | None:
    """How one side of the teeth slides, whose law `contact` is; None without friction, or where nothing turns."""
    gears = (mesh.driver, mesh.driven)
    if mesh.friction == 0.0 or speeds[mesh.driver.rotor] == 0.0:
        return None
    return sliding_flanks(
        components,
        parts,
        [(gear.rotor, gear.at) for gear in gears],
        mesh.geometry,
        sliding_friction(mesh.geometry, contact, mesh.friction),
        mesh.geometry.line_of_action_angle(_centre_line_angle(mesh), sense),
        sense,
        [speeds[gear.rotor] for gear in gears],
    )


def _flank(
    components: Sequence[Component], mesh: GearMesh, parts: LoadedParts, speeds: dict[str, float], sense: int
) -> tuple[FloatArray, FloatArray]:
    """Direction of compression and the harmonics of the runout error on one side of the teeth.

    With e the unit vector along which the driver pushes, δ = s (R_k θ_k + R_i θ_i) + e (u_k - u_i) - e_err. A gear
    whose centre circles its shaft with eccentricity ε moves by ε (cos, sin)(Ωt + phase) on top of u, so
    e_err = -e (ε_k - ε_i): the same first-order runout as :func:`coupling.gears.runout_error`.

    A helical driver of hand h (+1 for a right-hand helix) that moves along z leaves the contact as if it had turned
    back by z tan β_b / R_k, so δ gains -s h tan β_b (w_k - w_i), w the axial motions where the teeth touch: at the
    pitch point, r from a gear's centre, w = z + φ_x r_y - φ_y r_x with the tilts φ. The force has its axial part and
    tilting moment from the same rows.
    """
    driver, driven = mesh.driver, mesh.driven
    line = np.subtract(driven.axis, driver.axis)
    push, thrust = _push(mesh, sense)
    angle = np.arctan2(push[1], push[0])
    towards = line / np.hypot(*line) if np.any(line) else line
    direction = np.zeros(sum(component.size for component in components))
    errors = []
    sides = ((driver, mesh.geometry.driver, 1.0), (driven, mesh.geometry.driven, -1.0))
    for (mounted, gear, side), radius in zip(sides, mesh.geometry.working_pitch_radii, strict=True):
        which, rotor = parts.rotor(mounted.rotor)
        motion = sense * gear.base_radius * rotor.rotation(mounted.at)
        for axis in (0, 1):
            motion = motion + side * push[axis] * rotor.direction(mounted.at, axis)
        if thrust != 0.0:
            rows = rotor.motions(mounted.at)
            x, y = side * radius * towards
            motion = motion + side * thrust * (rows[2] + y * rows[3] - x * rows[4])
        direction += embed(components, which, motion)
        if gear.eccentricity:
            errors.append([-side * gear.eccentricity, speeds[mounted.rotor], gear.eccentricity_phase - angle])
    return direction, np.array(errors, dtype=np.float64).reshape(-1, 3)
