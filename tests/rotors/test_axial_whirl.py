"""Motions along the axis that bearings tie to whirl: known as such, and no critical speeds."""

import math

import numpy as np
import pytest
from scipy import linalg

from gearwhine.rotors import (
    Bearing,
    Rotor,
    Segment,
    ShaftMaterial,
    Unbalance,
    campbell,
    critical_speeds,
    rest_frequencies,
    solve_whirl,
    unbalance_response,
)
from gearwhine.rotors.whirl.whirl_modes import MOSTLY_AXIAL

STEEL = ShaftMaterial.from_poisson_ratio(2.1e11, 0.3, 7850.0)
SHAFT = Rotor("shaft", [Segment(0.1, 0.04, 0.0, STEEL)] * 4)
ALONG = 1e6  # N/m
BOUNCE = math.sqrt(ALONG / SHAFT.mass)  # rad/s: the shaft is rigid beside so soft a spring


def bearings(tie: float) -> list[Bearing]:
    """The left one holds along the axis too, and ties that to a tilt."""
    stiffness = np.diag([2e8, 2e8, ALONG, 1e4, 1e4])
    stiffness[2, 4] = stiffness[4, 2] = tie
    return [
        Bearing("left", 0.02, stiffness, np.zeros((5, 5))),
        Bearing("right", 0.38, np.diag([2e8, 2e8]), np.zeros((2, 2))),
    ]


def test_a_motion_along_the_axis_is_told_from_whirl() -> None:
    whirl = solve_whirl(SHAFT, bearings(2e4), 300.0, count=6)
    along = whirl.axial_share > MOSTLY_AXIAL
    assert along.tolist() == [True, False, False, False, False, False]
    assert whirl.frequencies[0] == pytest.approx(BOUNCE, rel=3e-3)
    assert whirl.axial_share[0] > 0.999
    assert np.all(whirl.axial_share[1:] < 1e-3)
    # Shapes have unit inertia, along the axis too: so much of it moves across.
    x, y = whirl.evaluate([0.0, 0.2, 0.4])
    assert np.abs([x[0], y[0]]).max() < 0.01 / math.sqrt(SHAFT.mass)


def test_it_is_no_critical_speed() -> None:
    """Nothing that unbalance drives: the others are where they are without any tie."""
    critical = critical_speeds(SHAFT, bearings(2e4), count=5)
    assert critical.speeds[0] == pytest.approx(BOUNCE, rel=3e-3)
    assert critical.axial_share[0] > 0.999
    assert 0.9 * critical.forward[0] > BOUNCE
    radial = critical_speeds(SHAFT, bearings(0.0), count=4)
    np.testing.assert_allclose(critical.lateral.speeds, radial.speeds, rtol=1e-4)


def test_a_diagram_over_speed_tells_it_too() -> None:
    diagram = campbell(SHAFT, bearings(2e4), np.linspace(10.0, 1000.0, 12), count=4)
    assert (diagram.axial_share > MOSTLY_AXIAL).any(axis=0).tolist()[0] is True
    assert not (diagram.axial_share[:, 1:] > 1e-3).any()
    (crossing,) = diagram.crossings()
    assert crossing.speed == pytest.approx(BOUNCE, rel=3e-3)
    assert crossing.axial_share > 0.999


def test_frequencies_at_rest_tell_it() -> None:
    rest = rest_frequencies(SHAFT, bearings(2e4), count=5)
    assert rest.frequencies[0] == pytest.approx(BOUNCE, rel=3e-3)
    assert (rest.axial_share > MOSTLY_AXIAL).tolist() == [True, False, False, False, False]
    assert not rest_frequencies(SHAFT, bearings(0.0), count=4).axial_share.any()


@pytest.mark.parametrize("turned", [0.1, 0.5])
def test_a_mixed_motion_is_axial_where_next_to_nothing_is_left_across(turned: float) -> None:
    """A rigid body on springs along slanting lines: its shares by hand. Unbalance drives one of 0.77."""
    stiff = ShaftMaterial(2.11e15, 8.12e14, 7810.0)
    body = Rotor("body", [Segment(0.05, 0.08, 0.0, stiff)] * 2)
    turn = np.array([[math.cos(turned), -math.sin(turned)], [math.sin(turned), math.cos(turned)]])
    slanting = turn @ np.diag([6e6, 2e6]) @ turn.T  # over x and z
    matrix = np.diag([0.0, 3e7, 0.0, 1e9, 1e9])
    matrix[np.ix_([0, 2], [0, 2])] = slanting
    bearing = Bearing("b", 0.05, matrix, np.zeros((5, 5)))
    squares, shapes = linalg.eigh(slanting / body.mass)
    modes = solve_whirl(body, [bearing], 0.0, count=3)
    for square, shape in zip(squares, shapes.T, strict=True):
        number = int(np.argmin(np.abs(modes.frequencies - math.sqrt(square))))
        assert modes.frequencies[number] == pytest.approx(math.sqrt(square), rel=1e-4)
        assert modes.axial_share[number] == pytest.approx(shape[1] ** 2, abs=1e-4)
    mixed = math.cos(turned) ** 2 < MOSTLY_AXIAL
    slowest = math.sqrt(squares[0])
    lateral = critical_speeds(body, [bearing], count=2).lateral.speeds
    assert (np.abs(lateral / slowest - 1.0).min() < 1e-3) == mixed
    # Two thousandths below it: each motion by its own resonance, by how far it goes across.
    heavy = unbalance_response(body, [bearing], [Unbalance(0.05, 1e-4)], [0.998 * slowest])
    across = 1e-4 * slowest**2 / body.mass * math.sin(turned) ** 2 / (slowest**2 * (1.0 - 0.998**2))
    rest = 1e-4 * slowest**2 / body.mass * math.cos(turned) ** 2 / (squares[1] - slowest**2)
    assert abs(heavy.motion.evaluate([0.05])[0][0, 0]) == pytest.approx(across + rest, rel=0.02)
    assert (across > 10.0 * rest) == mixed
