"""Bores off their places: what they do to shafts and flanks, at the operating point and in motion."""

import math
from dataclasses import replace

import numpy as np
import pytest
from own_statics import STEEL, WIDTH, linear_bearing, one_stage, toothed

from gearwhine.coupling import CouplingError, GapLaw, Machine, MountedBearing, Shaft, ShaftForce
from gearwhine.coupling.gears.geometry.modifications import HelixDeviation
from gearwhine.coupling.statics.mean_mesh import mean_equilibrium
from gearwhine.rotors import Rotor, Segment

ANGLE = 2e-4


def tilted(machine: Machine, rx: float, ry: float) -> Machine:
    """The machine with the bores of its first shaft on an axis that is turned about x and y, through its left end."""
    held = [
        replace(one, seat_error=(ry * one.bearing.at, -rx * one.bearing.at, rx, ry)) if one.rotor == "in" else one
        for one in machine.bearings
    ]
    return replace(machine, bearings=held)


def test_a_bore_between_two_others_bends_the_shaft_by_its_error() -> None:
    length, diameter, error = 0.6, 0.02, 5e-5
    stiffness = np.array([1e7, 1e7, 1e7])
    rotor = Rotor("shaft", [Segment(length, diameter, 0.0, STEEL)])
    held = [
        MountedBearing(linear_bearing(f"at {at}", at, k * np.eye(2)), "shaft", None, seat_error=wrong)
        for at, k, wrong in zip((0.0, 0.3, 0.6), stiffness, (None, (0.0, error, 0.0, 0.0), None), strict=True)
    ]
    # A force on a bearing goes into it, and bends nothing.
    pushed = ShaftForce("shaft", 0.0, (1e-3, 0.0, 0.0))
    point = Machine([Shaft(rotor)], held, speed=10.0, forces=[pushed]).operating_point()
    bending = length**3 / (48 * STEEL.youngs_modulus * math.pi / 64 * diameter**4)
    force = error / (bending + 1 / stiffness[1] + 1 / (4 * stiffness[0]) + 1 / (4 * stiffness[2]))
    forces = [one.force[1] for one in point.bearings]
    # Shear makes a shaft of thirty diameters softer by a hundredth of its bending.
    assert forces == pytest.approx([0.5 * force, -force, 0.5 * force], rel=1e-2)
    assert point.bearing("at 0.3").seat_motion[1] == error


def test_a_tilted_axis_loads_the_face_as_a_helix_slope_does() -> None:
    nominal = one_stage(hand=0.0)
    # The plane of action sees the tilt about each axis by a component of a unit vector.
    parts = [
        tilted(nominal, *turned).operating_point().pairs[0].misalignment_by_cause["seats"]
        for turned in ((ANGLE, 0.0), (0.0, ANGLE))
    ]
    assert math.hypot(*parts) == pytest.approx(ANGLE, rel=1e-9)
    assert nominal.operating_point().pairs[0].misalignment_by_cause["seats"] == 0.0
    for turned, part in zip(((ANGLE, 0.0), (0.0, ANGLE)), parts, strict=True):
        by_bores = tilted(nominal, *turned).operating_point()
        pinion = toothed("pinion", 23, helix_deviation=HelixDeviation(slope=-part * WIDTH))
        gears = [replace(nominal.gears[0], gear=pinion), nominal.gears[1]]
        by_helix = replace(nominal, gears=gears).operating_point()
        assert by_bores.pairs[0].k_h_beta == pytest.approx(by_helix.pairs[0].k_h_beta, rel=1e-4)
        for one in by_helix.bearings:
            size = float(np.abs(one.force).max())
            np.testing.assert_allclose(by_bores.bearing(one.name).force, one.force, atol=1e-4 * size)
        assert by_bores.pairs[0].misalignment - part == pytest.approx(by_helix.pairs[0].misalignment, abs=1e-3 * ANGLE)


def test_the_mean_of_the_motion_has_the_forces_of_the_operating_point() -> None:
    # Three bearings on a shaft: an error of one loads all, and the flanks with them.
    nominal = one_stage(hand=0.0)
    third = MountedBearing(
        linear_bearing("in 0.12", 0.12, 1.5e8 * np.eye(2)), "in", None, seat_error=(4e-5, 2e-5, 0, 0)
    )
    machine = replace(nominal, bearings=[*nominal.bearings, third])
    point = machine.operating_point()
    coupled = machine.at_operating_point(point).assembled
    _, q = mean_equilibrium(coupled.system)
    for one in coupled.system.linear:
        if one.name.startswith("in"):
            found = one.stiffness @ (one.directions.T @ q) + (0.0 if one.offset is None else one.offset)
            np.testing.assert_allclose(found[:2], point.bearing(one.name).force[:2], rtol=2e-2, atol=1.0)


def test_a_law_about_the_nominal_place_is_refused() -> None:
    held = linear_bearing("stop", 0.1, np.eye(2))
    with pytest.raises(CouplingError, match=r"stop.*seat_error.*nonlinear law"):
        MountedBearing(held, "shaft", None, GapLaw(10.0, 1e-5, 1.5, 1e-4), seat_error=(1e-5, 0.0, 0.0, 0.0))
    with pytest.raises(CouplingError, match="seat_error"):
        MountedBearing(held, "shaft", None, seat_error=(1e-5, 0.0))
