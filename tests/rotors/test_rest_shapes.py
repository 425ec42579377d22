"""Mode shapes at rest against the balance of momentum, which ties each shape to its own frequency."""

import math

import numpy as np
import pytest

from gearwhine.rotors import Bearing, Rotor, Segment, ShaftMaterial
from gearwhine.rotors.analyses.rest_frequencies import rest_frequencies

LENGTH, DIAMETER, DENSITY = 0.6, 0.04, 7810.0
BAR = Rotor("bar", [Segment(LENGTH, DIAMETER, 0.0, ShaftMaterial(211e9, 81.2e9, DENSITY))], [])
PLACES = np.linspace(0.0, LENGTH, 2001)
PLANAR = np.diag([2e7, 5e7, 0.0, 0.0, 0.0])
TURNED = PLANAR + np.array([[0, 8e6, 0, 0, 0], [8e6, 0, 0, 0, 0], *3 * [[0] * 5]])
THRUST = TURNED + np.array([[0, 0, 6e6, 0, 0], [0] * 5, [6e6, 0, 3e7, 0, 0], *2 * [[0] * 5]])
ROUND = np.diag([3e7, 3e7, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("stiffness", [PLANAR, TURNED, THRUST, ROUND], ids=["planes", "turned", "thrust", "round"])
def test_springs_carry_what_the_shape_accelerates(stiffness: np.ndarray) -> None:
    """ω² ∫ρA u dz = Σ K u at the bearings, in every direction of every mode; ∫ρA |u|² dz is nearly 1 of a slim bar."""
    at = [0.08, 0.45]
    bearings = [Bearing(f"b{z}", z, stiffness, np.zeros((5, 5))) for z in at]
    rest = rest_frequencies(BAR, bearings, count=6)
    along, held = rest.evaluate(PLACES), rest.evaluate(at)
    line = DENSITY * math.pi * DIAMETER**2 / 4.0
    for frequency, shape, springs in zip(rest.frequencies, along, held, strict=True):
        accelerated = frequency**2 * line * np.trapezoid(shape, PLACES, axis=1)
        carried = (stiffness[:3, :3] @ springs).sum(axis=1)
        scale = np.abs(stiffness[:3, :3] @ springs).max()
        assert accelerated == pytest.approx(carried, abs=2e-4 * scale)
        assert line * np.trapezoid((shape**2).sum(axis=0), PLACES) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("tie", [0.0, 2e5])
def test_twins_on_round_bearings_are_two_motions(tie: float) -> None:
    """Also where forces tilt the bearings, which are as round: both planes are then solved together."""
    stiffness = np.diag([3e7, 3e7, 0.0, 1e4, 1e4])
    stiffness[0, 4] = stiffness[4, 0] = tie
    stiffness[1, 3] = stiffness[3, 1] = -tie
    rest = rest_frequencies(BAR, [Bearing(f"b{z}", z, stiffness, np.zeros((5, 5))) for z in (0.08, 0.45)], count=4)
    along = rest.evaluate(PLACES)
    for one, other in ((0, 1), (2, 3)):
        assert rest.frequencies[one] == pytest.approx(rest.frequencies[other], rel=1e-9)
        assert abs(np.vdot(along[one], along[other])) < 1e-6 * np.vdot(along[one], along[one])
