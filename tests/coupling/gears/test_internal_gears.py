"""Internal gears: signed radii, the root's arc, and the pair by the outlines of both gears."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.coupling.gears import Gear, GearPairGeometry
from gearwhine.coupling.gears.errors import (
    GearError,
    InterferenceError,
    MismatchedGearsError,
    PointedToothError,
)
from gearwhine.coupling.gears.geometry.pair import mesh_frequency
from gearwhine.coupling.gears.geometry.profile import (
    fillet_points,
    flank_points,
    gear_outline,
    load_angle,
    meshing_rotations,
)
from gearwhine.coupling.gears.geometry.thickness import tooth_thickness
from gearwhine.coupling.machine.mesh_kinematics import line_of_action
from tests.machines.internal_pairs import ALPHA, depth_of_overlap, gap_between, pinion, placed_outlines, ring

TIGHT = GearPairGeometry(pinion(), ring())
LOOSE = GearPairGeometry(pinion(profile_shift=0.3), ring(profile_shift=0.2), -38.7e-3)
PAIRS = [
    TIGHT,
    LOOSE,
    GearPairGeometry(TIGHT.driven, TIGHT.driver),
    GearPairGeometry(LOOSE.driven, LOOSE.driver, -38.7e-3),
]


def test_radii_of_a_ring_are_negative_and_those_of_the_norm() -> None:
    gear = ring(addendum=0.75, profile_shift=0.2)
    assert gear.is_internal
    assert (gear.sign, gear.tooth_count) == (-1, 60)
    assert gear.pitch_radius == pytest.approx(-60e-3)
    assert gear.base_radius == pytest.approx(-60e-3 * math.cos(ALPHA))
    assert gear.tip_radius == pytest.approx(-60e-3 + (0.75 + 0.2) * 2e-3)
    assert gear.root_circle_radius == pytest.approx(-60e-3 - (1.25 - 0.2) * 2e-3)
    # s = m (pi/2 + 2 x tan(alpha)); the tooth is thickest at its root.
    thickness = 2e-3 * (math.pi / 2.0 + 0.4 * math.tan(ALPHA))
    assert tooth_thickness(gear, gear.pitch_radius) == pytest.approx(thickness, rel=1e-12)
    assert tooth_thickness(gear, gear.tip_radius) < thickness < tooth_thickness(gear, gear.form_radius)
    assert gear.base_pitch == pytest.approx(math.pi * 2e-3 * math.cos(ALPHA))


def test_root_arc_touches_flank_and_root_circle() -> None:
    gear = ring(root_radius=0.5e-3)
    points = fillet_points(gear, np.linspace(math.pi / 2.0, gear.fillet_end, 201))
    radius = np.hypot(points.height, points.half_thickness)
    assert radius[0] == pytest.approx(-gear.root_circle_radius, rel=1e-12)
    assert radius[0] == radius.max()
    # A circle of that radius through all points.
    (ax, ay), (bx, by), (cx, cy) = ((points.half_thickness[n], points.height[n]) for n in (0, 100, 200))
    sides = math.dist((ax, ay), (bx, by)), math.dist((bx, by), (cx, cy)), math.dist((ax, ay), (cx, cy))
    area = 0.5 * abs((bx - ax) * (cy - ay) - (cx - ax) * (by - ay))
    assert math.prod(sides) / (4.0 * area) == pytest.approx(0.5e-3, rel=1e-9)
    # It ends on the involute, in its direction.
    angle = load_angle(gear, np.array(gear.form_radius))
    flank = flank_points(gear, np.array([float(angle), float(angle) - 1e-7]))
    assert (points.half_thickness[-1], points.height[-1]) == pytest.approx(
        (flank.half_thickness[0], flank.height[0]), rel=1e-12
    )
    near = fillet_points(gear, np.array([gear.fillet_end, gear.fillet_end + 1e-7]))
    slopes = [float(np.diff(curve.half_thickness)[0] / np.diff(curve.height)[0]) for curve in (flank, near)]
    assert slopes[0] == pytest.approx(slopes[1], rel=1e-5)
    numeric = np.gradient(points.height, np.linspace(math.pi / 2.0, gear.fillet_end, 201))
    np.testing.assert_allclose(points.height_rate[1:-1], numeric[1:-1], rtol=1e-3)


def test_full_root_arc_is_one_from_flank_to_flank() -> None:
    full = replace(ring(), root_radius=ring(root_radius=0.0).full_rack_tip_radius)
    assert full.root_arc.centre_angle == pytest.approx(math.pi / full.teeth, rel=1e-12)
    with pytest.raises(GearError, match=r"root_radius is .*; expected at most .* mm, which fits the root of a space"):
        replace(full, root_radius=1.001 * full.full_rack_tip_radius)


def test_outline_of_a_ring_is_its_inside() -> None:
    gear = ring()
    outline = gear_outline(gear, 0.3, (1e-2, 2e-2))
    radius = np.hypot(*(outline - (1e-2, 2e-2)).T)
    assert radius.min() == pytest.approx(-gear.tip_radius, rel=1e-9)
    assert radius.max() == pytest.approx(-gear.root_circle_radius, rel=1e-9)
    x, y = outline.T
    area = 0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
    # Teeth fill half of each pitch circle on the way: area between tip and root circle, counter-clockwise.
    assert math.pi * gear.tip_radius**2 < area < math.pi * gear.root_circle_radius**2
    # Tooth 0 points along the rotation from the other side of the centre.
    place = np.array([1e-2, 2e-2]) + (gear.tip_radius - 1e-4) * np.array([math.cos(0.3), math.sin(0.3)])
    assert np.hypot(*(outline - place).T).min() < 1.2e-3


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: f"{pair.label} {1e3 * pair.working_centre_distance:.4g}")
@pytest.mark.parametrize("sense", [1, -1])
def test_drawn_flanks_touch_along_the_path_of_contact(pair: GearPairGeometry, sense: int) -> None:
    for phase in np.linspace(0.02, 1.45, 6):
        drawn = placed_outlines(pair, phase, sense, 0.7)
        assert depth_of_overlap(*drawn) < 2e-7  # chords of the outlines
        assert gap_between(*drawn) < 2e-7


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: f"{pair.label} {1e3 * pair.working_centre_distance:.4g}")
@pytest.mark.parametrize("sense", [1, -1])
def test_driver_closes_the_flanks_and_backlash_is_where_the_back_flanks_meet(
    pair: GearPairGeometry, sense: int
) -> None:
    # δ = s (R_k θ_k + R_i θ_i): further together they overlap by δ, apart they have the backlash less δ.
    drawn = placed_outlines(pair, 0.4, sense, 0.7, closing=20e-6)
    assert depth_of_overlap(*drawn) == pytest.approx(20e-6, rel=0.02)
    if pair.backlash > 1e-6:
        drawn = placed_outlines(pair, 0.4, sense, 0.7, closing=-0.5 * pair.backlash)
        assert depth_of_overlap(*drawn) == 0.0
        drawn = placed_outlines(pair, 0.4, sense, 0.7, closing=-pair.backlash - 20e-6)
        assert depth_of_overlap(*drawn) == pytest.approx(20e-6, rel=0.02)


@pytest.mark.parametrize("pair", [TIGHT, PAIRS[2]], ids=lambda pair: pair.label)
@pytest.mark.parametrize("sense", [1, -1])
def test_line_of_action_pushes_where_the_driver_turns(pair: GearPairGeometry, sense: int) -> None:
    distance = abs(pair.working_centre_distance)
    centre = distance * np.array([math.cos(0.7), math.sin(0.7)])
    line = line_of_action(pair, centre, sense)
    pitch = np.array(line.driver.arm)
    # One point for both gears, on their pitch circles, on the far side of the pinion.
    np.testing.assert_allclose(pitch, centre + np.array(line.driven.arm), atol=1e-12)
    assert math.hypot(*pitch) == pytest.approx(abs(pair.working_pitch_radii[0]))
    pinion_at = centre if pair.driver.is_internal else np.zeros(2)
    ring_at = np.zeros(2) if pair.driver.is_internal else centre
    assert (pitch - pinion_at) @ (pinion_at - ring_at) > 0.0
    # The driver's point there moves along the push, as the sense turns it, and the driven gear turns the same way.
    push, velocity = np.array(line.push), sense * np.array([-pitch[1], pitch[0]])
    assert velocity @ push == pytest.approx(abs(pair.driver.base_radius), rel=1e-12)
    assert line.driver.turning(np.array([float(sense)]))[0] > 0.0
    driven_arm = np.array(line.driven.arm)
    moved = sense * abs(pair.driver.teeth / pair.driven.teeth) * np.array([-driven_arm[1], driven_arm[0]])
    np.testing.assert_allclose(moved, velocity, rtol=1e-12)
    # Rolling without slip keeps δ.
    turned = line.driver.turning(np.array([1.0])) + line.driven.turning(
        np.array([abs(pair.driver.teeth / pair.driven.teeth)])
    )
    assert abs(turned[0]) < 1e-15


@pytest.mark.parametrize("hand", [1.0, -1.0])
def test_helical_pair_of_equal_hands_touches_in_every_plane(hand: float) -> None:
    helix = hand * math.radians(15.0)
    pair = GearPairGeometry(pinion(helix_angle=helix), ring(helix_angle=helix))
    assert pair.driven.lead == pytest.approx(3.0 * pair.driver.lead)
    rotations = meshing_rotations(pair, 0.5)
    centre = (pair.working_centre_distance, 0.0)
    for z in (-8e-3, 5e-3):
        inside = gear_outline(pair.driver, rotations[0], axial_position=z, points=40)
        around = gear_outline(pair.driven, rotations[1], centre, axial_position=z, points=40)
        assert depth_of_overlap(around, inside) < 2e-7
        assert gap_between(around, inside) < 2e-7
        assert pair.driven.turn_along(z) == pytest.approx(pair.driver.turn_along(z) / 3.0)
    line = line_of_action(pair, (-centre[0], 0.0), 1)
    # Moving along z by what a rotation of the helix makes up for leaves the flanks as they are.
    moved = line.driver.along(np.array([1e-3])) + line.driver.turning(np.array([pair.driver.turn_along(1e-3)]))
    assert abs(float(moved[0])) < 1e-15
    moved = line.driven.along(np.array([1e-3])) + line.driven.turning(np.array([pair.driven.turn_along(1e-3)]))
    assert abs(float(moved[0])) < 1e-15


def test_ring_body_is_a_ring() -> None:
    gear = ring(rim_thickness=10e-3)
    outer, inner, width, density = 60e-3 + 2.5e-3 + 10e-3, 60e-3, 20e-3, gear.density
    mass = density * width * math.pi * (outer**2 - inner**2)
    assert gear.outer_radius == pytest.approx(outer)
    assert gear.mass == pytest.approx(mass)
    assert gear.polar_inertia == pytest.approx(0.5 * mass * (outer**2 + inner**2))
    assert ring().outer_radius == pytest.approx(60e-3 + 2.5e-3 + 7e-3)


def test_mesh_frequency_of_a_ring() -> None:
    assert mesh_frequency(-100.0, -60) == pytest.approx(6000.0 / (2.0 * math.pi))


def test_impossible_rings_are_refused_with_what_would_work() -> None:
    # The tip stays outside the base circle for (h_a + x) <= z (1 - cos(alpha)) / 2.
    allowed = 10.0 * (1.0 - math.cos(ALPHA))
    assert ring(-20, addendum=allowed - 1e-9).tip_radius < 0.0
    message = (
        rf"addendum is 1; expected at most {allowed:.4g}, .*34 teeth.*tip circle of 36 mm.*base circle of 37\.58\d+ mm"
    )
    with pytest.raises(GearError, match=message):
        ring(-20, addendum=1.0)
    with pytest.raises(PointedToothError, match=r"dedendum is 3; .*flanks of a space meet before the root circle"):
        ring(dedendum=3.0)
    with pytest.raises(GearError, match=r"bore is .*; expected none of an internal gear, a ring outside its teeth"):
        ring(bore=10e-3)
    with pytest.raises(GearError, match="teeth is -4; expected a whole number of at least 5"):
        ring(-4)


def test_pairs_that_do_not_fit_are_refused() -> None:
    with pytest.raises(MismatchedGearsError, match="both gears are internal"):
        GearPairGeometry(ring(), ring(-62))
    with pytest.raises(MismatchedGearsError, match="of 60 teeth does not reach around 'pinion' of 60"):
        GearPairGeometry(pinion(60), ring())
    with pytest.raises(MismatchedGearsError, match="need equal helix_angle of one hand, got"):
        GearPairGeometry(pinion(helix_angle=0.2), ring(helix_angle=-0.2))
    with pytest.raises(GearError, match="centre_distance of an internal pair is negative"):
        GearPairGeometry(pinion(), ring(), 40e-3)
    with pytest.raises(InterferenceError, match=r"the teeth jam at a centre distance of 40\.5 mm"):
        GearPairGeometry(pinion(), ring(), -40.5e-3)
    with pytest.raises(InterferenceError, match=r"exceeds the difference of the base radii, 37\.5877 mm"):
        GearPairGeometry(pinion(), ring(), -37e-3)
    with pytest.raises(InterferenceError, match=r"the tip of 'ring' reaches .* below the involute of 'pinion'"):
        GearPairGeometry(pinion(), ring(addendum=1.0))


def test_gear_is_external_unless_its_teeth_are_negative() -> None:
    gear = Gear("pinion", 20, 2e-3, ALPHA, 20e-3)
    assert not gear.is_internal
    assert gear.rim_outer_radius is None
    assert gear.outer_radius == gear.tip_radius
