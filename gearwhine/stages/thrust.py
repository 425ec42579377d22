"""Whether the bearings of a case carry the thrust of its helical gears: by arithmetic, before anything is solved."""

import coupling as room
from gearwhine.case import Case, applied_torques, rotor_speeds
from gearwhine.stages.bearings import build_bearings
from gearwhine.stages.gears import pair_geometries


def require_carried_thrust(case: Case) -> None:
    """Refuse a case whose helical gears push a rotor that no bearing holds along its axis.

    Raises
    ------
    coupling.CouplingError
        As :func:`coupling.require_thrust_carried`.
    CaseError
        For a rolling bearing that cannot be under its load.
    """
    if not case.gear_pair or not case.rotor or case.operation is None:
        return
    pairs = []
    for given, geometry in zip(case.gear_pair, pair_geometries(case), strict=True):
        rotors = [case.gear_named(name).rotor for name in (given.driver, given.driven)]
        if rotors[0] is None or rotors[1] is None:
            continue
        pairs.append(room.ThrustPair((rotors[0], rotors[1]), (given.driver, given.driven), geometry))
    torques: dict[str, float] = {}
    for torque in applied_torques(case):
        torques[torque.shaft] = torques.get(torque.shaft, 0.0) + torque.torque
    speeds = rotor_speeds(case)
    forces = room.axial_forces(pairs, speeds, torques)
    carriers = {
        rotor: any(b.at_speed(speeds[rotor]).spatial_stiffness[2, 2] > 0.0 for b in build_bearings(case, rotor))
        for rotor in forces
    }
    room.require_thrust_carried(forces, carriers)
