"""Complementary energy of a ball's outer contact, which presses with 3/5 F^(5/3) / K^(2/3) over its path."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearwhine.rotors.rolling_bearings.centrifugal_balls import CentrifugalBalls


@pytest.mark.parametrize("force", [(1e-6, 2e-6), (50.0, -80.0), (-20.0, 5.0), (-95.0, 1.0)])
def test_the_rise_is_the_difference_of_the_energies(force: tuple[float, float]) -> None:
    thrown, stiffness, arm = 100.0, 8e9, 3e-4

    def energy(total: float) -> float:
        return arm * total + 0.6 * total ** (5.0 / 3.0) / stiffness ** (2.0 / 3.0)

    contact = SimpleNamespace(outer_contact=SimpleNamespace(stiffness=stiffness))
    ball: Any = SimpleNamespace(thrown=thrown, _outwards=np.array([thrown, 0.0]), _outer_arm=arm, row=contact)
    total = np.hypot(thrown + force[0], force[1])
    rise = CentrifugalBalls._outer_rise(ball, np.array(force))
    assert rise == pytest.approx(energy(total) - energy(thrown), rel=1e-6)
