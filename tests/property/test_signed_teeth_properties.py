"""Identities of the involute that hold for gears of either sign of teeth, and for internal pairs."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gearwhine.coupling.gears import Gear, GearError, GearPairGeometry
from gearwhine.coupling.gears.geometry.involute import involute
from gearwhine.coupling.gears.geometry.pair import profile_shift_sum
from gearwhine.coupling.gears.geometry.path_of_contact import specific_sliding
from gearwhine.coupling.gears.geometry.profile import fillet_points, flank_points, load_angle, meshing_rotations
from gearwhine.coupling.gears.geometry.thickness import over_balls, tooth_thickness
from gearwhine.coupling.machine.mesh_kinematics import line_of_action

MODULE, ALPHA = 2e-3, math.radians(20.0)
patient = settings(deadline=None, max_examples=60)


@st.composite
def gears(draw: st.DrawFn) -> Gear:
    """External or internal gear, spur or helical."""
    internal = draw(st.booleans())
    teeth = draw(st.integers(40, 120)) if internal else draw(st.integers(18, 120))
    return Gear(
        "drawn",
        -teeth if internal else teeth,
        MODULE,
        ALPHA,
        20e-3,
        profile_shift=draw(st.floats(-0.3, 0.3)) if internal else draw(st.floats(0.0, 0.4)),
        addendum=draw(st.floats(0.4, 0.7)) if internal else 1.0,
        helix_angle=draw(st.sampled_from([0.0, 0.2, -0.3])),
        tooth_thinning=draw(st.sampled_from([0.0, 30e-6])),
    )


@st.composite
def internal_pairs(draw: st.DrawFn) -> GearPairGeometry:
    pinion, helix = draw(st.integers(18, 40)), draw(st.sampled_from([0.0, 0.25, -0.15]))
    shared = {"module": MODULE, "pressure_angle": ALPHA, "face_width": 20e-3, "helix_angle": helix}
    both = [
        Gear("pinion", pinion, profile_shift=draw(st.floats(0.0, 0.5)), addendum=draw(st.floats(0.8, 1.0)), **shared),
        Gear(
            "ring",
            -pinion - draw(st.integers(14, 60)),
            profile_shift=draw(st.floats(-0.4, 0.3)),
            addendum=draw(st.floats(0.4, 0.75)),
            tooth_thinning=draw(st.sampled_from([0.0, 40e-6])),
            **shared,
        ),
    ]
    if draw(st.booleans()):
        both.reverse()
    try:
        return GearPairGeometry(*both)
    except GearError:
        assume(False)
        raise


@patient
@given(gears())
def test_circles_flank_and_fillet_of_either_sign(gear: Gear) -> None:
    radii = [gear.root_circle_radius, gear.form_radius, gear.tip_radius]
    assert radii == sorted(radii)
    assert all(gear.sign * radius > 0.0 for radius in radii)
    assert gear.base_pitch == pytest.approx(2.0 * math.pi * gear.base_radius / gear.teeth)
    # Tooth and space fill the pitch at every radius; the tooth is thickest at its root.
    at = np.linspace(gear.form_radius, gear.tip_radius, 5)
    thickness = [tooth_thickness(gear, float(radius)) for radius in at]
    assert all(0.0 < one < 2.0 * math.pi * abs(r) / gear.tooth_count for one, r in zip(thickness, at, strict=True))
    assert np.all(np.diff(thickness) < 0.0)
    # The same flank by its thickness and by its points, and a fillet that goes on where it ends.
    points = flank_points(gear, load_angle(gear, at))
    np.testing.assert_allclose(points.radius, np.abs(at), rtol=1e-12)
    np.testing.assert_allclose(
        2.0 * np.arcsin(points.half_thickness / points.radius) * np.abs(at), thickness, rtol=1e-9
    )
    foot = fillet_points(gear, np.array([math.pi / 2.0, gear.fillet_end]))
    assert foot.radius[0] == pytest.approx(abs(gear.root_circle_radius), rel=1e-12)
    assert foot.half_thickness[1] == pytest.approx(points.half_thickness[0], rel=1e-9)
    assert foot.height[1] == pytest.approx(points.height[0], rel=1e-9)


@patient
@given(gears(), st.floats(1.3, 2.0))
def test_balls_touch_the_flanks_of_either_sign(gear: Gear, size: float) -> None:
    try:
        balls = over_balls(gear, size * MODULE)
    except GearError:
        return
    # In the plane of action the ball's centre is half its transverse diameter from the flank's normal foot.
    roll = gear.roll_angle(balls.contact_radius)
    centre = gear.roll_angle(balls.centre_radius)
    offset = gear.base_radius * (centre - roll)
    assert offset == pytest.approx(0.5 * size * MODULE * math.cos(gear.base_helix_angle), rel=1e-9)
    # It stands in the middle of the space: its polar angle from the tooth's axis is half a pitch.
    if gear.helix_angle == 0.0:
        assert gear.base_half_angle - roll + math.atan(centre) == pytest.approx(math.pi / gear.teeth, abs=1e-9)


@patient
@given(internal_pairs())
def test_internal_pair_by_lengths_without_signs(pair: GearPairGeometry) -> None:
    pinion, ring = pair.pinion_and_ring
    a, w = -pair.working_centre_distance, pair.working_pressure_angle
    small, large = pinion.base_radius, -ring.base_radius
    assert a == pytest.approx((large - small) / math.cos(w))
    reach = math.sqrt(pinion.tip_radius**2 - small**2), math.sqrt(ring.tip_radius**2 - large**2)
    assert pair.path_length == pytest.approx(reach[0] - reach[1] + a * math.sin(w), rel=1e-9)
    shift = profile_shift_sum(pinion, ring, -a)
    assert shift == pytest.approx(pinion.profile_shift + ring.profile_shift, abs=1e-9)
    # Thicknesses and the backlash fill the pitch of the working circles.
    radii = [small / math.cos(w), -large / math.cos(w)]
    filled = tooth_thickness(pinion, radii[0]) + tooth_thickness(ring, radii[1]) + pair.circumferential_backlash
    assert filled == pytest.approx(2.0 * math.pi * radii[0] / pinion.teeth, rel=1e-9)
    # The contact is as far from both centres as its radii say, by the triangle of the centres.
    at = np.linspace(0.0, pair.contact_ratio, 7)
    first, second = np.abs(pair.driver_radius(at)), np.abs(pair.driven_radius(at))
    near, far = (second, first) if pair.driver.is_internal else (first, second)
    towards = (far**2 - near**2 - a**2) / (2.0 * a)  # of the contact from the pinion's axis, along the line of centres
    assert np.all(np.abs(towards) <= near)
    pitch = pair.pitch_point_position
    assert abs(float(pair.driver_radius(pitch))) == pytest.approx(abs(pair.working_pitch_radii[0]))
    assert specific_sliding(pair, pitch)[0] == pytest.approx(0.0, abs=1e-9)


@patient
@given(internal_pairs(), st.sampled_from([1, -1]), st.floats(-3.0, 3.0), st.floats(0.0, 1.0))
def test_turning_in_mesh_keeps_the_compression(pair: GearPairGeometry, sense: int, line: float, phase: float) -> None:
    before = meshing_rotations(pair, phase, centre_line_angle=line, sense=sense)
    after = meshing_rotations(pair, phase + 0.25, centre_line_angle=line, sense=sense)
    turned = np.subtract(after, before)
    # Both turn the same way, the driver in its sense, by a quarter of a pitch.
    pitches = 2.0 * math.pi / pair.driver.tooth_count, 2.0 * math.pi / pair.driven.tooth_count
    np.testing.assert_allclose(turned, sense * 0.25 * np.array(pitches), rtol=1e-9)
    distance = pair.working_centre_distance
    action = line_of_action(pair, (distance * math.cos(line), distance * math.sin(line)), sense)
    assert action.angle == pytest.approx(pair.line_of_action_angle(line, sense)) or math.cos(
        action.angle - pair.line_of_action_angle(line, sense)
    ) == pytest.approx(1.0)
    moved = action.driver.turning(turned[:1]) + action.driven.turning(turned[1:])
    assert abs(float(moved[0])) < 1e-12 * abs(pair.driver.base_radius)
    # A shift of the driven gear along the push opens the contact, as much as a rotation of it by that over R does.
    step = np.zeros((6, 1))
    step[:2, 0] = action.push
    assert float(action.driven.across(step)[0]) == pytest.approx(-1.0)


@patient
@given(internal_pairs(), st.floats(-2e-4, 0.0))
def test_backlash_grows_as_an_internal_pair_is_moved_together(pair: GearPairGeometry, closer: float) -> None:
    distance = pair.working_centre_distance - closer
    try:
        moved = GearPairGeometry(pair.driver, pair.driven, distance)
    except GearError:
        return
    expected = (
        2.0 * pair.base_radii_sum * (involute(moved.working_pressure_angle) - involute(pair.working_pressure_angle))
    )
    assert moved.backlash == pytest.approx(pair.backlash + expected, abs=1e-12)
    assert moved.backlash >= pair.backlash - 1e-15
