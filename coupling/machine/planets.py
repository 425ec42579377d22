"""Planets in a machine: frames of rotors and connectors, seats in other shafts, centrifugal forces, rims in a housing.

Planets turn with their carrier (:mod:`gearwhine.coupling.machine.frames`). Here stands which rotors have the carrier's
frame, at which speed each connector turns, and what the circling adds to the equations of motion.
"""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np

from gearwhine.coupling.machine.base_motion import rotor_participation
from gearwhine.coupling.machine.components import HousingComponent, RotorComponent, pin_name
from gearwhine.coupling.machine.connectors import LinearConnector, SpeedTable, TurningPart
from gearwhine.coupling.machine.coordinates import MachineCoordinates
from gearwhine.coupling.machine.frames import Frames, is_isotropic
from gearwhine.coupling.machine.mesh_kinematics import FlankMotion
from gearwhine.coupling.machine.mounted_parts import GearMesh, MountedBearing, MountedGear
from gearwhine.numerics.arrays import FloatArray

_SPEEDS_OF_A_RUN = 33  # number of speeds between which the square of the speed is taken as linear


def shaft_around(mounted: MountedBearing, coordinates: MachineCoordinates) -> RotorComponent | None:
    """Return the shaft that holds a bearing: a planet's carrier, or one named as its seat; None for other seats."""
    name = coordinates.rotor(mounted.rotor).carrier or mounted.seat
    return coordinates.rotor(name) if name is not None and coordinates.is_rotor(name) else None


def frame_speeds(
    rotors: Sequence[RotorComponent],
    bearings: Sequence[MountedBearing],
    meshes: Sequence[GearMesh],
    speeds: Mapping[str, float],
    bolted: Collection[str] = (),
) -> dict[str, float]:
    """Speed of the frame of each rotor's coordinates [rad/s], with the names of the rotors that bolts hold.

    Planets and their carriers turn with the carrier. So does a sun or a ring whose other connectors are alike all
    round: what joins it to the planets is constant there. All other parts stand still, and among them what bolts hold.
    """
    carriers = {rotor.name: rotor.carrier for rotor in rotors if rotor.carrier is not None}
    frames = {name: speeds[carrier] for name, carrier in carriers.items()}
    frames |= {pin_name(rotor.name): frames[rotor.name] for rotor in rotors if rotor.pin is not None}
    frames |= {carrier: speeds[carrier] for carrier in carriers.values()}
    for rotor in rotors:
        pairs = [(mesh.driver.rotor, mesh.driven.rotor) for mesh in meshes]
        others = [set(pair) - {rotor.name} for pair in pairs if rotor.name in pair]
        around = {carriers.get(other) for one in others for other in one}
        if rotor.name in frames or rotor.name in bolted or len(around) != 1 or None in around:
            continue
        carrier = carriers[next(iter(others[0]))]
        on_it = [mounted for mounted in bearings if rotor.name in (mounted.rotor, mounted.seat)]
        if all(alike_all_round(one) or {one.rotor, one.seat} == {rotor.name, carrier} for one in on_it):
            frames[rotor.name] = speeds[carrier]
    return frames


def alike_all_round(mounted: MountedBearing) -> bool:
    """Whether a bearing stands on rigid ground and has a linear law that is the same in all directions."""
    if mounted.seat is not None or mounted.law is not None or mounted.bearing.pedestal is not None:
        return False
    if mounted.offset is not None or mounted.bearing.speeds is not None:
        return False
    bearing = mounted.bearing
    return is_isotropic(bearing.spatial_stiffness) and is_isotropic(bearing.spatial_damping)


def bearing_frame(mounted: MountedBearing, coordinates: MachineCoordinates, frames: Frames) -> float:
    """Speed at which a bearing turns [rad/s]: with the shaft that holds it, or with any frame where it is isotropic."""
    around = shaft_around(mounted, coordinates)
    if around is not None:
        return frames.of(around.name)
    return frames.of(mounted.rotor) if alike_all_round(mounted) else 0.0


def centrifugal_load(coordinates: MachineCoordinates, frames: Frames) -> FloatArray:
    """Centrifugal forces of the planets on their coordinates, (n,): their axes circle with their carriers."""
    load = np.zeros(coordinates.size)
    for part in coordinates.components:
        if isinstance(part, RotorComponent) and part.carrier is not None:
            outward = np.subtract(part.axis, coordinates.rotor(part.carrier).axis)
            participation = rotor_participation(part, (0.0, 0.0, 0.0))[:, :2]
            load += coordinates.rows(part.name, participation @ (frames.of(part.name) ** 2 * outward))
    return load


def centrifugal_stiffness(
    coordinates: MachineCoordinates,
    planet: RotorComponent,
    bearings: Sequence[MountedBearing],
    frames: Frames,
    speed_range: tuple[float, float] = (1.0, 1.0),
) -> LinearConnector:
    """Geometric stiffness of a pin under the centrifugal force N = m a f² of its planet.

    The force follows the carrier: a rotation θ beyond the nominal one turns it, and the planet's tangential motion u
    beside the carrier's gives it an arm. By the second-order terms of the pin's deflection in the carrier's own frame
    its energy is N (θ u - a θ² / 2). Set and carrier that turn as one, u = a θ, then stay in equilibrium. N follows the
    square of the speed, tabulated over the speeds of a run, ``speed_range``.
    """
    carrier = coordinates.rotor(planet.carrier or "")
    outward = np.subtract(planet.axis, carrier.axis)
    distance = math.hypot(*outward)
    participation = rotor_participation(planet, (0.0, 0.0, 0.0))[:, :2]
    mass = float(np.sum(participation[:, 0] ** 2))
    at = float(np.mean([one.bearing.at for one in bearings if one.rotor == planet.name]))
    station = carrier.station(planet.start + at)
    along = np.array([-outward[1], outward[0]]) / distance
    # The planet's motion is that of its centre of mass, so that the force is spread as the inertia that it balances.
    tangential = coordinates.rows(planet.name, participation @ along / mass)
    tangential = tangential - coordinates.rows(carrier.name, along @ carrier.motions(station)[:2])
    force = mass * distance * frames.of(planet.name) ** 2
    law = force * np.array([[0.0, 1.0], [1.0, -distance]])
    directions = np.column_stack([tangential, coordinates.rotation(carrier.name, station)])
    none = np.zeros((2, 2))
    table = None
    if speed_range[0] != speed_range[1] and force != 0.0:
        ratios = np.linspace(*speed_range, _SPEEDS_OF_A_RUN)
        table = SpeedTable(ratios, ratios[:, None, None] ** 2 * law, np.zeros((len(ratios), 2, 2)))
    return LinearConnector(f"centrifugal force of {planet.name}", directions, law, none, table)


def pin_seat(coordinates: MachineCoordinates, planet: RotorComponent, at: float) -> tuple[str, FloatArray]:
    """Name of a planet's pin, and the motion (5, n) of the seat of a bearing on it, at a station of the planet."""
    pin = coordinates.pin(planet.name)
    return pin.name, pin.motions(planet.start + at)


def pin_in_walls(coordinates: MachineCoordinates, planet: RotorComponent) -> LinearConnector:
    """Stiffness of an elastic pin between its bearings' seats and the walls of the carrier that clamp it."""
    pin, carrier = coordinates.pin(planet.name), coordinates.rotor(planet.carrier or "")
    own = coordinates.rows(pin.name, np.diag(1.0 / pin.mounted.scale))
    walls = [coordinates.rows(carrier.name, carrier.seat_motions(planet.axis, wall)) for wall in pin.mounted.walls]
    stiffness = pin.mounted.stiffness
    directions, undamped = np.vstack([own, *walls]).T, np.zeros_like(stiffness)
    return LinearConnector(pin.name, directions, stiffness, undamped, offset=pin.mounted.offset)


def mesh_frame(coordinates: MachineCoordinates, mesh: GearMesh) -> float:
    """Speed at which the line of centres of a mesh turns, that of the carrier of a planet in it [rad/s]."""
    return 0.0 if mesh.carrier is None else coordinates.speeds[mesh.carrier]


def deformed_rim(
    coordinates: MachineCoordinates, mounted: MountedGear, flank: FlankMotion
) -> list[tuple[FloatArray, FloatArray]]:
    """Parts of the compression by the bore that a ring's rim follows, by the orders of its circumference, (n,) both.

    See :meth:`gearwhine.coupling.machine.components.HousingComponent.ring_harmonics`.
    """
    housing = next((part for part in coordinates.components if isinstance(part, HousingComponent)), None)
    if mounted.rim_seat is None or housing is None:
        return []
    place = math.atan2(flank.arm[1], flank.arm[0])
    return [
        (flank.side * coordinates.rows(housing.name, cosine), flank.side * coordinates.rows(housing.name, sine))
        for cosine, sine in housing.ring_harmonics(mounted.rim_seat, flank.push, place)
    ]


def turning_rims(coordinates: MachineCoordinates, mesh: GearMesh, sense: int, frame: float) -> Iterator[TurningPart]:
    """Yield the parts by which the deformation of a ring's bore moves the flanks of a mesh that turns in it."""
    line = mesh.line_of_action(sense)
    for mounted, flank in ((mesh.driver, line.driver), (mesh.driven, line.driven)):
        for order, (cosine, sine) in enumerate(deformed_rim(coordinates, mounted, flank)):
            if order and frame != 0.0:
                yield TurningPart(order * frame, cosine[:, None], sine[:, None])
