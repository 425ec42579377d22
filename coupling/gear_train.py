"""Checks of a gear train: speed ratios, senses of rotation, centre distances, planes and the balance of torques.

External gears on parallel shafts roll without slip where ω₁ z₁ = -ω₂ z₂; their shafts are as far apart as the geometry
of the pair says, and their faces overlap along the shafts. A train at constant speed takes as much power as it gives,
Σ T ω = 0 over its rotors.
"""

from collections.abc import Mapping, Sequence
from math import hypot

from coupling.errors import CouplingError
from coupling.loads import AnyTorque, Torque, TorqueRipple, constant_torques, trains
from coupling.mounted import GearMesh

LARGEST_OFFSET = 1e-6
"""How far the distance of two axes may be from the centre distance of the gears on them [m]."""

LARGEST_IMBALANCE = 0.01
"""Part of the power of a train that its torques may leave over."""

_RATIO_ROUNDING = 1e-9


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
        that are not at the centre distance of their geometry, or faces that do not overlap.
    """
    for mesh in meshes:
        _require_ratio(mesh, speeds)
        _require_place(mesh, starts)


def require_balance(meshes: Sequence[GearMesh], torques: Sequence[AnyTorque], speeds: Mapping[str, float]) -> None:
    """Refuse constant torques that no rotor of their gear train takes.

    Trains that stand still, or whose torques vary over time or with the speed, are left to the solution.

    Raises
    ------
    CouplingError
        Where the power that a train takes in and the power that it gives out differ by more than one in a hundred.
    """
    varying = {one.rotor for one in torques if not isinstance(one, Torque | TorqueRipple)}
    total = constant_torques(torques)
    for train in trains(list(speeds), [(mesh.driver.rotor, mesh.driven.rotor) for mesh in meshes]):
        if len(train) < 2 or varying.intersection(train):
            continue
        powers = {name: total.get(name, 0.0) * speeds[name] for name in train}
        taken = sum(power for power in powers.values() if power > 0.0)
        given = -sum(power for power in powers.values() if power < 0.0)
        if abs(taken - given) > LARGEST_IMBALANCE * max(taken, given):
            listed = ", ".join(f"{total.get(name, 0.0):.6g} N m on {name!r}" for name in train)
            raise CouplingError(
                f"torques of {listed} bring {taken:.6g} W into their gear train and take {given:.6g} W out of it; "
                "expected torques that balance through the tooth ratios"
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
    distance = mesh.geometry.working_centre_distance
    if abs(apart - distance) > LARGEST_OFFSET:
        raise CouplingError(
            f"{mesh.label}: the axes of rotors {gears[0].rotor!r} and {gears[1].rotor!r} are {1e3 * apart:.6g} mm "
            f"apart; expected the gears' centre distance, {1e3 * distance:.6g} mm"
        )
    places = [starts[gear.rotor] + gear.at for gear in gears]
    shift, reach = abs(places[0] - places[1]), 0.5 * mesh.geometry.face_width
    if shift > reach + LARGEST_OFFSET:
        raise CouplingError(
            f"{mesh.label}: the gears are {1e3 * shift:.6g} mm apart along z; expected them in one plane, within half "
            f"a face width, {1e3 * reach:.6g} mm"
        )
