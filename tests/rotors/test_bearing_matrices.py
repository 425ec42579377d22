"""Bearings of five motions in whirl, against springs that do the same through an arm."""

import numpy as np
import pytest

from gearwhine.rotors import Bearing, Disc, Rotor, Segment, ShaftMaterial, rest_frequencies, solve_whirl

# So stiff that the shaft is rigid to a millionth.
RIGID = Rotor(
    "rigid",
    [Segment(0.6, 0.08, 0.0, ShaftMaterial(1e18, 4e17, 7800.0))],
    [Disc(0.15, 8.0, 0.05, 0.03)],
)


def through_an_arm(at: float, arm: float, radial: np.ndarray, damping: np.ndarray) -> Bearing:
    """A radial bearing at ``at + arm`` by its forces and moments on the section at ``at``: x + arm θ_y, y − arm θ_x."""
    moves = np.array([[1.0, 0.0, 0.0, 0.0, arm], [0.0, 1.0, 0.0, -arm, 0.0]])
    return Bearing(f"arm at {at}", at, moves.T @ radial @ moves, moves.T @ damping @ moves)


@pytest.mark.parametrize("speed", [0.0, 700.0])
def test_a_matrix_is_a_spring_at_the_end_of_an_arm(speed: float) -> None:
    stiffness, damping = np.array([[2e6, 4e5], [1e5, 1.5e6]]), np.array([[300.0, 40.0], [40.0, 200.0]])
    there = [Bearing("a", 0.1, stiffness, damping), Bearing("b", 0.5, stiffness, damping)]
    here = [through_an_arm(0.02, 0.08, stiffness, damping), through_an_arm(0.58, -0.08, stiffness, damping)]
    expected = solve_whirl(RIGID, there, speed, count=4)
    found = solve_whirl(RIGID, here, speed, count=4)
    np.testing.assert_allclose(found.eigenvalues, expected.eigenvalues, rtol=1e-5)
    at_rest = [rest_frequencies(RIGID, bearings, count=4).frequencies for bearings in (there, here)]
    np.testing.assert_allclose(at_rest[1], at_rest[0], rtol=1e-5)
