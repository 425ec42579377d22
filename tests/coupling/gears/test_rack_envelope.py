"""The outline against the rack itself: rolled past the gear, it touches every point and cuts into none.

Nothing of the trochoid or the involute is used: the rack's tooth is lines and circles in its normal section, and the
gear's points are carried into its frame by rolling alone.  Undercut teeth are held to the same.
"""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from gearwhine.coupling.gears import Gear, GearError
from gearwhine.coupling.gears.geometry.profile import fillet_points, flank_points, load_angle
from gearwhine.numerics.arrays import FloatArray

ALPHA = math.radians(20.0)
GEARS = [
    Gear("spur", 28, 3.175e-3, ALPHA, 6.35e-3, root_radius=1.35e-3),
    Gear("helical", 19, 4e-3, ALPHA, 20e-3, profile_shift=0.4, helix_angle=math.radians(30.0)),
    Gear("steep", 31, 2e-3, math.radians(25.0), 20e-3, profile_shift=-0.2, helix_angle=math.radians(-45.0)),
    Gear("sharp", 40, 5e-3, ALPHA, 20e-3, root_radius=0.0, helix_angle=math.radians(12.0)),
    Gear("thinned", 24, 2e-3, ALPHA, 20e-3, tooth_thinning=0.1e-3, helix_angle=math.radians(20.0)),
    Gear("undercut", 10, 3e-3, ALPHA, 20e-3, allow_undercut=True),
    Gear("undercut, helical", 9, 3e-3, ALPHA, 20e-3, allow_undercut=True, helix_angle=math.radians(15.0)),
    Gear("undercut, sharp", 12, 3e-3, ALPHA, 20e-3, allow_undercut=True, root_radius=0.0),
]


def rack_penetration(gear: Gear, x: FloatArray, y: FloatArray, rolls: FloatArray) -> FloatArray:
    """How deep points of the gear (n,) are inside the rack's teeth after `rolls` (n, m) [m], negative outside.

    In the rack's normal section, so a depth is a distance there.
    """
    radius, alpha, helix = gear.pitch_radius, gear.pressure_angle, gear.helix_angle
    turn = rolls / radius
    across = x[:, None] * np.cos(turn) + y[:, None] * np.sin(turn) - rolls
    height = y[:, None] * np.cos(turn) - x[:, None] * np.sin(turn) - radius
    thinned = gear.tooth_thinning / (2.0 * math.tan(alpha))
    below = gear.profile_shift * gear.module - thinned - height
    # The rack's teeth stand in the gear's spaces, one every pitch.
    pitch = math.pi * gear.module
    across = across * math.cos(helix) - 0.5 * pitch
    across = np.abs((across + 0.5 * pitch) % pitch - 0.5 * pitch)
    # A trapezoid drawn in by the corner's radius: corner at (half, deep), flank and bottom from there.
    rho = gear.rack_tip_radius
    deep = gear.dedendum * gear.module - rho
    half = 0.25 * pitch - deep * math.tan(alpha) - rho / math.cos(alpha)
    u, v = across - half, below - deep
    flank = u * math.cos(alpha) + v * math.sin(alpha)
    beyond_flank = u * math.sin(alpha) - v * math.cos(alpha) < 0.0  # past the flank's lower end
    to_corner = np.hypot(u, v)
    outside = np.where(u <= 0.0, v, np.where(beyond_flank, to_corner, flank))
    distance = np.where((flank <= 0.0) & (v <= 0.0), np.maximum(flank, v), outside)
    return np.asarray(rho - distance)


def deepest_penetration(gear: Gear, x: FloatArray, y: FloatArray) -> FloatArray:
    """The deepest that the rack ever reaches beyond each point [m], by ever finer searches around the best roll."""
    best, span = np.zeros(x.size), 20.0 * gear.transverse_module
    for _ in range(5):
        rolls = best[:, None] + np.linspace(-span, span, 1001)
        depth = rack_penetration(gear, x, y, rolls)
        best = rolls[np.arange(x.size), np.argmax(depth, axis=1)]
        span *= 0.02
    return np.asarray(np.max(depth, axis=1))


def side(gear: Gear, points: int = 15) -> tuple[FloatArray, FloatArray]:
    """Points of fillet and flank, from the root circle to the tip."""
    fillet = fillet_points(gear, np.linspace(math.pi / 2.0, gear.fillet_end, points))
    ends = load_angle(gear, np.array([gear.form_radius, gear.tip_radius]))
    flank = flank_points(gear, np.linspace(ends[0], ends[1], points))
    return (
        np.concatenate([fillet.half_thickness, flank.half_thickness]),
        np.concatenate([fillet.height, flank.height]),
    )


@pytest.mark.parametrize("gear", GEARS, ids=lambda gear: gear.name)
def test_the_rolling_rack_touches_every_point_and_cuts_none(gear: Gear) -> None:
    depth = deepest_penetration(gear, *side(gear))
    np.testing.assert_allclose(depth / gear.module, 0.0, atol=1e-9)


@pytest.mark.parametrize("gear", GEARS, ids=lambda gear: gear.name)
def test_the_search_tells_inside_from_outside(gear: Gear) -> None:
    # The measure itself: points a hundredth of a module into the tooth are clear, as far into the space are cut.
    x, y = side(gear)
    inward, outward = (deepest_penetration(gear, x + sign * 0.01 * gear.module, y) for sign in (-1.0, 1.0))
    assert np.all(inward[1:-1] < 0.0)
    assert np.all(outward[1:-1] > 0.0)


@pytest.mark.parametrize("gear", GEARS, ids=lambda gear: gear.name)
def test_fillet_and_flank_meet(gear: Gear) -> None:
    fillet = fillet_points(gear, np.array([math.pi / 2.0, gear.fillet_end]))
    flank = flank_points(gear, load_angle(gear, np.array([gear.form_radius])))
    assert fillet.height[1] == pytest.approx(flank.height[0], rel=1e-12)
    assert fillet.half_thickness[1] == pytest.approx(flank.half_thickness[0], rel=1e-11)
    assert fillet.radius[0] == pytest.approx(gear.root_circle_radius, rel=1e-13)


@pytest.mark.parametrize("gear", GEARS, ids=lambda gear: gear.name)
def test_the_fillets_climb_is_its_derivative(gear: Gear) -> None:
    gamma, step = np.linspace(gear.fillet_end + 0.05, 1.5, 8), 1e-6
    change = fillet_points(gear, gamma + step).height - fillet_points(gear, gamma - step).height
    np.testing.assert_allclose(fillet_points(gear, gamma).height_rate, change / (2.0 * step), rtol=1e-6, atol=1e-9)


@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.filter_too_much])
@given(
    teeth=st.integers(5, 150),
    angle=st.floats(12.0, 32.0),
    helix=st.floats(-60.0, 60.0),
    shift=st.floats(-1.0, 1.0),
    addendum=st.floats(0.4, 1.5),
    dedendum=st.floats(0.6, 1.5),
    corner=st.floats(0.0, 1.0),
    thinning=st.floats(0.0, 0.1),
)
def test_any_gear_is_the_envelope_of_its_rack(
    teeth: int,
    angle: float,
    helix: float,
    shift: float,
    addendum: float,
    dedendum: float,
    corner: float,
    thinning: float,
) -> None:
    try:
        plain = Gear("plain", 200, 1.0, math.radians(angle), 10.0, dedendum=dedendum)
        gear = Gear(
            "drawn",
            teeth,
            1.0,
            math.radians(angle),
            10.0,
            profile_shift=shift,
            addendum=addendum,
            dedendum=dedendum,
            root_radius=corner * plain.full_rack_tip_radius,
            helix_angle=math.radians(helix),
            tooth_thinning=thinning,
            allow_undercut=True,
        )
    except GearError:
        assume(False)
    np.testing.assert_allclose(deepest_penetration(gear, *side(gear, 8)), 0.0, atol=1e-7)


def test_undercut_shortens_the_involute_and_more_so_with_fewer_teeth() -> None:
    cut = [Gear("cut", teeth, 1e-3, ALPHA, 1e-2, allow_undercut=True) for teeth in (16, 14, 12, 10, 8)]
    relative = [gear.form_radius / gear.base_radius for gear in cut]
    assert all(gear.is_undercut for gear in cut)
    assert relative == sorted(relative)
    assert min(relative) > 1.0
    # On the verge of undercut the flank begins on the base circle, whichever side it is seen from.
    least = Gear("edge", 14, 1e-3, ALPHA, 1e-2, allow_undercut=True).least_generating_shift
    assert least == pytest.approx(1.0 - 7.0 * math.sin(ALPHA) ** 2, rel=1e-12)
    for step in (-1e-7, 1e-7):
        edge = Gear("edge", 14, 1e-3, ALPHA, 1e-2, profile_shift=least + step, allow_undercut=True)
        assert edge.form_radius == pytest.approx(edge.base_radius, rel=1e-6)
