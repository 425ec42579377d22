"""Speeds at which no shaft holds: refused, in place of a diagram without modes."""

import math

import numpy as np
import pytest

from gearwhine.rotors import Bearing, Rotor, RotorError, Segment, ShaftMaterial, Unbalance, campbell, solve_whirl
from gearwhine.rotors import unbalance_response as response

STEEL = ShaftMaterial.from_poisson_ratio(2.1e11, 0.3, 7850.0)
ROTOR = Rotor("shaft", [Segment(0.1, 0.03, 0.0, STEEL), Segment(0.1, 0.04, 0.0, STEEL)])
HELD = [Bearing(str(at), at, np.diag([2e8, 2e8]), np.zeros((2, 2))) for at in (0.02, 0.18)]
# A surface at √(0.1 E / ρ) strains by a tenth: steel of 40 mm at 81 800 rad/s.
HIGHEST = math.sqrt(0.1 * 2.1e11 / 7850.0) / 0.02


def test_a_diagram_up_to_the_highest_speed_has_its_modes() -> None:
    assert ROTOR.highest_speed == pytest.approx(HIGHEST, rel=1e-12)
    diagram = campbell(ROTOR, HELD, [0.0, 0.99 * HIGHEST], count=4)
    assert np.isfinite(diagram.eigenvalues).any(axis=1).all()


def test_a_massless_shaft_has_no_highest_speed() -> None:
    spring = ShaftMaterial.from_poisson_ratio(2.1e11, 0.3, 0.0)
    segments = [Segment(0.1, 0.04, 0.0, spring), Segment(0.1, 0.02, 0.0, STEEL)]
    assert Rotor("shaft", segments).highest_speed == pytest.approx(2.0 * HIGHEST, rel=1e-12)


@pytest.mark.parametrize("speed", [1.01 * HIGHEST, 1e9, -1e9, 1e300, math.inf, math.nan])
def test_a_speed_at_which_no_shaft_holds_is_refused(speed: float) -> None:
    with pytest.raises(RotorError, match="speed"):
        campbell(ROTOR, HELD, sorted([0.0, speed]), count=4)
    with pytest.raises(RotorError, match="speed is"):
        solve_whirl(ROTOR, HELD, speed, count=4)
    with pytest.raises(RotorError, match="speed"):
        response(ROTOR, HELD, [Unbalance(0.1, 1e-4)], [speed])


def test_the_refusal_names_the_highest_speed() -> None:
    with pytest.raises(RotorError, match=r"at most 8.18e\+04 rad/s, where rotor 'shaft' is torn"):
        campbell(ROTOR, HELD, [0.0, 1e9], count=4)
