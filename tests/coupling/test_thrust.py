"""Thrust of helical gears: what each rotor is pushed with along its axis, and who must carry it."""

import math

import pytest
from helical_pairs import ANGLE, TORQUE, couple_pairs, helical

from gearwhine.coupling import CouplingError
from gearwhine.coupling.description.thrust import ThrustPair, axial_forces


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
