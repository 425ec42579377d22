"""Shafts with lumped mass in a machine: their bearings carry the load, though modes above a limit are left out."""

import math

import numpy as np
import pytest
from own_statics import STEEL

from gearwhine.coupling import Machine, MountedBearing, Shaft, ShaftForce
from gearwhine.coupling.machine.parts import Driving
from gearwhine.coupling.statics.static_equilibrium import static_equilibrium
from gearwhine.rotors import Bearing, Disc, Rotor, Segment

THICK, LENGTH, LEFT, RIGHT, MIDDLE = 0.03, 0.3, 0.05, 0.25, 0.15
AXIAL = 1e9, 2e8
FORCE = (500.0, -900.0, 400.0)
GRAVITY = (20.0, -90.0, 0.0)


def bearing_forces(frequency_limit: float | None) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Forces x, y, z of the resting shaft on its two bearings, (2, 3)."""
    rotor = Rotor("shaft", [Segment(0.05, THICK, 0.0, STEEL)] * 6, [Disc(0.1, 3.0, 0.02, 0.01)], "lumped")
    bearings = [
        Bearing(f"at {at}", at, np.diag([1e8, 2e8, axial, 0.0, 0.0]), np.zeros((2, 2)))
        for at, axial in zip((LEFT, RIGHT), AXIAL, strict=True)
    ]
    machine = Machine(
        [Shaft(rotor, frequency_limit=frequency_limit)],
        [MountedBearing(bearing, "shaft", None) for bearing in bearings],
        speed=200.0,
        forces=[ShaftForce("shaft", MIDDLE, FORCE)],
    )
    system = machine.assemble(driving=Driving(gravity=GRAVITY)).system
    place = static_equilibrium(system)
    found = np.zeros((2, 5))
    for force, connector in zip(found, system.linear, strict=True):
        assert connector.offset is None
        force[list(connector.axes)] = connector.stiffness @ (connector.directions.T @ place)
    return found[:, :3]


@pytest.mark.parametrize("limit", [2.0 * math.pi * 2e3, None, 2.0 * math.pi * 1e6])
def test_bearings_of_a_lumped_shaft_carry_its_load(limit: float | None) -> None:
    """Weight and force by the lever, the axial force by the springs of bearing and shaft on either side of it."""
    found = bearing_forces(limit)
    area = math.pi / 4.0 * THICK**2
    shaft = STEEL.density * area * LENGTH
    share = (MIDDLE - LEFT) / (RIGHT - LEFT), (0.1 - LEFT) / (RIGHT - LEFT)
    for axis in (0, 1):
        pull = FORCE[axis] + shaft * GRAVITY[axis], 3.0 * GRAVITY[axis]
        right = share[0] * pull[0] + share[1] * pull[1]
        assert found[:, axis] == pytest.approx([sum(pull) - right, right], rel=1e-8)
    softness = [1.0 / axial + (MIDDLE - LEFT) / (STEEL.youngs_modulus * area) for axial in AXIAL]
    expected = [FORCE[2] * other / sum(softness) for other in softness[::-1]]
    # The static response of a free rod is taken a little off its rigid motion.
    assert found[:, 2] == pytest.approx(expected, rel=1e-4)
