"""Thrust of helical gears: what each rotor is pushed with along its axis, and who must carry it."""

import math

import numpy as np
import pytest

from coupling import (
    CouplingError,
    GearMesh,
    MountedBearing,
    MountedGear,
    ThrustPair,
    Torque,
    axial_forces,
    couple,
    rotor_component,
)
from coupling.gears import ConstantStiffness, Gear, GearPairGeometry, tooth_contact
from rotors import Bearing, Rotor, Segment, ShaftMaterial, modal_rotor

TORQUE = 150.0
ANGLE = math.radians(15.0)


def helical(hand: float) -> GearPairGeometry:
    return GearPairGeometry(
        Gear("pinion", 23, 3e-3, math.radians(20.0), 25e-3, helix_angle=hand * ANGLE),
        Gear("wheel", 41, 3e-3, math.radians(20.0), 25e-3, helix_angle=-hand * ANGLE),
    )


def couple_pairs(*hands: float, thrust_stiffness: float = 0.0):  # type: ignore[no-untyped-def]
    """Two shafts on radial bearings, or on those with an axial stiffness, and gear pairs of these hands."""
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
        meshes.append(GearMesh(*places, pair, tooth_contact(pair, ConstantStiffness(2e8))))
    ratio = helical(1.0).ratio
    return couple(
        rotors,
        None,
        speeds={"input": 300.0, "output": -300.0 / ratio},
        bearings=[MountedBearing(bearing, rotor.name, None) for rotor in rotors for bearing in held],
        meshes=meshes,
        torques=[Torque("input", 0.12, TORQUE), Torque("output", 0.12, TORQUE * ratio)],
    )


def test_the_thrust_is_the_tangential_force_times_the_tangent_of_the_helix() -> None:
    """F_a = T / r tan β at the reference cylinder, against the base cylinder's that the code takes."""
    pair = helical(1.0)
    named = ThrustPair(("input", "output"), ("pinion", "wheel"), pair)
    forces = axial_forces([named], {"input": 1.0, "output": -1.0}, {"input": TORQUE, "output": TORQUE * pair.ratio})
    expected = TORQUE / (0.5 * 23 * 3e-3 / math.cos(ANGLE)) * math.tan(ANGLE)
    assert forces["input"].net == pytest.approx(expected, rel=1e-12)
    assert forces["output"].net == pytest.approx(-expected, rel=1e-12)


def test_thrust_that_no_bearing_carries_is_refused_with_names_and_newtons() -> None:
    with pytest.raises(CouplingError, match=r"rotor 'input': its gears 'pinion-0' push it .* 1125 N.*'output'"):
        couple_pairs(1.0)


def test_thrust_bearings_and_thrusts_that_cancel_are_accepted() -> None:
    couple_pairs(1.0, thrust_stiffness=1e8)
    double = couple_pairs(1.0, -1.0)
    assert len(double.meshes) == 2
