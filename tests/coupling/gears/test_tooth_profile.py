"""The outline of a tooth: its rates are derivatives, and it is symmetric and reaches the tip."""

import math

import numpy as np
import pytest

from gearwhine.coupling.gears import Gear
from gearwhine.coupling.gears.geometry.profile import (
    fillet_points,
    flank_points,
    load_angle,
    tooth_outline,
)

ALPHA = math.radians(20.0)
GEARS = [
    Gear("standard", 62, 2e-3, ALPHA, 20e-3),
    Gear("nasa", 28, 3.175e-3, ALPHA, 6.35e-3, root_radius=1.35e-3),
    Gear("shifted", 19, 4e-3, ALPHA, 20e-3, profile_shift=0.4),
    Gear("coarse", 40, 5e-3, math.radians(25.0), 20e-3, profile_shift=-0.2, root_radius=0.0),
]


def rolled(gear: Gear, point: tuple[float, float], roll: float) -> tuple[float, float]:
    """A point of the rack (across, above the pitch line) in the gear's frame after rolling by `roll` [m]."""
    x, y = point[0] + roll, gear.pitch_radius + point[1]
    turn = roll / gear.pitch_radius
    return x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn)


@pytest.mark.parametrize("gear", GEARS, ids=lambda gear: gear.name)
def test_height_rates_are_derivatives(gear: Gear) -> None:
    step = 1e-6
    for curve, parameter in (
        (fillet_points, np.linspace(gear.pressure_angle + 0.05, 1.5, 8)),
        (flank_points, load_angle(gear, np.linspace(gear.form_radius * 1.001, gear.tip_radius, 8))),
    ):
        change = curve(gear, parameter + step).height - curve(gear, parameter - step).height
        np.testing.assert_allclose(curve(gear, parameter).height_rate, change / (2.0 * step), rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("gear", GEARS, ids=lambda gear: gear.name)
def test_outline_is_symmetric_and_reaches_the_tip(gear: Gear) -> None:
    outline = tooth_outline(gear, points=20)
    assert outline.shape == (78, 2)
    np.testing.assert_allclose(outline, outline[::-1] * [-1.0, 1.0], atol=1e-15)
    radius = np.hypot(outline[:, 0], outline[:, 1])
    assert radius.max() == pytest.approx(gear.tip_radius, rel=1e-12)
    assert radius.min() == pytest.approx(gear.root_circle_radius, rel=1e-12)
