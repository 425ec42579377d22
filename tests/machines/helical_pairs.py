"""Two shafts with helical gears between them, for tests."""

import math

import numpy as np

from gearwhine.coupling import (
    CoupledMachine,
    GearMesh,
    MachineLoads,
    MountedBearing,
    MountedGear,
    Torque,
    assemble_machine,
)
from gearwhine.coupling.gears import Gear, GearPairGeometry, SquareStiffness, tooth_contact
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.machine.components import rotor_component
from gearwhine.rotors import Bearing, Rotor, Segment, ShaftMaterial, modal_rotor

TORQUE = 150.0
ANGLE = math.radians(15.0)


def helical(hand: float, angle: float = ANGLE) -> GearPairGeometry:
    """Return the teeth of a pair whose driver has a helix of this hand, 1 to the right and -1 to the left."""
    return GearPairGeometry(
        Gear("pinion", 23, 3e-3, math.radians(20.0), 25e-3, helix_angle=hand * angle),
        Gear("wheel", 41, 3e-3, math.radians(20.0), 25e-3, helix_angle=-hand * angle),
    )


def couple_pairs(
    *hands: float, thrust_stiffness: float = 0.0, speed: float = 300.0, sliced: bool = False
) -> CoupledMachine:
    """Two shafts on radial bearings, or on those with an axial stiffness, and gear pairs of these hands.

    Where `sliced`, the load spreads over the slices of their faces.
    """
    steel = ShaftMaterial.from_poisson_ratio(2.06e11, 0.3, 7850.0)
    shaft = Rotor("", [Segment(0.12, 0.04, 0.0, steel)] * 2)
    held = [
        Bearing(str(at), at, np.diag([2e8, 2e8, thrust_stiffness, 0.0, 0.0]), np.zeros((5, 5))) for at in (0.02, 0.22)
    ]
    component = modal_rotor(shaft, held, count=4, gears_at=[0.12])
    rotors = [rotor_component(name, component, start=0.0) for name in ("input", "output")]
    meshes = []
    for number, hand in enumerate(hands):
        pair = helical(hand)
        places = [
            MountedGear(f"{gear}-{number}", rotor, 0.12, (axis, 0.0))
            for gear, rotor, axis in (("pinion", "input", 0.0), ("wheel", "output", pair.working_centre_distance))
        ]
        law = tooth_contact(pair, SquareStiffness(2e8), faces=face_slices(pair) if sliced else None)
        meshes.append(GearMesh(*places, pair, law))
    ratio = helical(1.0).ratio
    return assemble_machine(
        rotors,
        None,
        speeds={"input": speed, "output": -speed / ratio},
        bearings=[MountedBearing(bearing, rotor.name, None) for rotor in rotors for bearing in held],
        meshes=meshes,
        loads=MachineLoads(torques=[Torque("input", 0.12, TORQUE), Torque("output", 0.12, TORQUE * ratio)]),
    )
