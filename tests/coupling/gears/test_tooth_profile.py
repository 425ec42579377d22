"""The outline against what generates it: the rack's flank and its corner, rolled numerically."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from gearwhine.coupling.gears import Gear
from gearwhine.coupling.gears.geometry.profile import (
    fillet_points,
    flank_points,
    load_angle,
    root_half_angle,
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
def test_fillet_is_touched_by_the_rolling_corner(gear: Gear) -> None:
    # Every point of the fillet is one corner radius away from the path of the corner's centre, never less.
    depth, across = gear.rack_corner
    points = fillet_points(gear, np.linspace(math.pi / 2.0, gear.pressure_angle, 9))
    for x, y in zip(points.half_thickness, points.height, strict=True):

        def distance(roll: float, x: float = x, y: float = y) -> float:
            centre = rolled(gear, (across, -depth), roll)
            return math.hypot(centre[0] - x, centre[1] - y)

        # Coarse search first: the distance to a looping trochoid has several dips.
        rolls = np.linspace(-8.0, 8.0, 801) * gear.module
        best = rolls[np.argmin([distance(roll) for roll in rolls])]
        around = (best - 0.03 * gear.module, best + 0.03 * gear.module)
        nearest = minimize_scalar(distance, bounds=around, method="bounded", options={"xatol": 1e-14})
        assert nearest.fun == pytest.approx(gear.rack_tip_radius, abs=1e-8 * gear.module)


@pytest.mark.parametrize("gear", GEARS, ids=lambda gear: gear.name)
def test_flank_is_touched_by_the_rolling_rack(gear: Gear) -> None:
    # The rack's straight flank, as a line family in the gear's frame, just touches each flank point.
    radii = np.linspace(gear.form_radius, gear.tip_radius, 7)
    flank = flank_points(gear, load_angle(gear, radii))
    on_line = math.pi * gear.module / 4.0 + gear.profile_shift * gear.module * math.tan(gear.pressure_angle)
    slope = math.tan(gear.pressure_angle)
    for x, y in zip(flank.half_thickness, flank.height, strict=True):

        def clearance(roll: float, x: float = x, y: float = y) -> float:
            foot = rolled(gear, (on_line, 0.0), roll)
            head = rolled(gear, (on_line - slope * gear.module, gear.module), roll)
            along = (head[0] - foot[0], head[1] - foot[1])
            return ((foot[0] - x) * along[1] - (foot[1] - y) * along[0]) / math.hypot(*along)

        far = 6.0 * gear.module
        nearest = minimize_scalar(clearance, bounds=(-far, far), method="bounded", options={"xatol": 1e-12})
        assert nearest.fun == pytest.approx(0.0, abs=1e-8 * gear.module)


@pytest.mark.parametrize("gear", GEARS, ids=lambda gear: gear.name)
def test_curves_meet_smoothly_and_end_on_their_circles(gear: Gear) -> None:
    fillet = fillet_points(gear, np.array([math.pi / 2.0, gear.pressure_angle]))
    start = load_angle(gear, np.array(gear.form_radius))
    flank = flank_points(gear, np.array([start, start + 1e-7]))
    assert fillet.radius[0] == pytest.approx(gear.root_circle_radius, rel=1e-13)
    assert math.atan2(fillet.half_thickness[0], fillet.height[0]) == pytest.approx(root_half_angle(gear))
    assert fillet.radius[1] == pytest.approx(gear.form_radius, rel=1e-12)
    assert fillet.half_thickness[1] == pytest.approx(flank.half_thickness[0], rel=1e-11)
    # Common tangent: both are normal to the rack's flank there.
    before = fillet_points(gear, np.array([gear.pressure_angle, gear.pressure_angle + 1e-7]))
    if gear.rack_tip_radius > 0.0:  # a sharp corner leaves an edge
        slopes = [np.diff(curve.half_thickness) / np.diff(curve.height) for curve in (before, flank)]
        np.testing.assert_allclose(slopes[0], slopes[1], atol=1e-5)


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
