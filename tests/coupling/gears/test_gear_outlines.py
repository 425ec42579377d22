"""Whole gears and pairs as points: closed outlines, and flanks that touch without cutting into each other."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gearwhine.coupling.gears import Gear, GearError, GearPairGeometry
from gearwhine.coupling.gears.geometry.profile import (
    fillet_points,
    flank_points,
    gear_outline,
    load_angle,
    meshing_rotations,
    pair_outlines,
    root_half_angle,
)
from gearwhine.numerics.arrays import FloatArray

ALPHA = math.radians(20.0)
PINION = Gear("pinion", 21, 3e-3, ALPHA, 15e-3, profile_shift=0.25, helix_angle=math.radians(18.0))
WHEEL = Gear("wheel", 43, 3e-3, ALPHA, 12e-3, profile_shift=0.1, helix_angle=math.radians(-18.0))
PAIR = GearPairGeometry(PINION, WHEEL)


def area(outline: FloatArray) -> float:
    """Area of a polygon, positive where it runs counter-clockwise [m^2]."""
    x, y = outline.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def test_an_outline_runs_once_round_counter_clockwise() -> None:
    outline = gear_outline(PINION)
    radius = np.hypot(*outline.T)
    assert radius.min() == pytest.approx(PINION.root_circle_radius, rel=1e-12)
    assert radius.max() == pytest.approx(PINION.tip_radius, rel=1e-12)
    around = np.unwrap(np.arctan2(outline[:, 1], outline[:, 0]))
    assert around[-1] - around[0] == pytest.approx(2.0 * math.pi, abs=2.0 * math.pi / PINION.teeth)
    steps = np.hypot(*np.diff(np.vstack([outline, outline[:1]]), axis=0).T)
    assert steps.max() < 0.5 * PINION.module
    assert steps.min() > 0.0


def test_the_area_is_that_of_the_teeth_and_the_root_circle() -> None:
    # By quadrature over the radius of the angle that the teeth fill, instead of along the outline.
    gear = PINION
    nodes, weights = np.polynomial.legendre.leggauss(40)
    gamma = np.linspace(math.pi / 2.0, gear.fillet_end, 4001)
    fillet = fillet_points(gear, gamma)
    total = math.pi * gear.root_circle_radius**2
    for low, high, of_flank in (
        (gear.root_circle_radius, gear.form_radius, False),
        (gear.form_radius, gear.tip_radius, True),
    ):
        radius = 0.5 * (low + high) + 0.5 * (high - low) * nodes
        if of_flank:
            flank = flank_points(gear, load_angle(gear, radius))
            angle = np.arctan2(flank.half_thickness, flank.height)
        else:
            angle = np.interp(radius, fillet.radius, np.arctan2(fillet.half_thickness, fillet.height))
        total += float(np.sum(weights * radius * 2.0 * angle) * 0.5 * (high - low)) * gear.teeth
    assert area(gear_outline(gear, points=400)) == pytest.approx(total, rel=2e-6)


def test_turning_and_moving_an_outline() -> None:
    plain = gear_outline(PINION)
    moved = gear_outline(PINION, 0.3, (0.01, -0.02))
    turn = np.array([[math.cos(0.3), math.sin(0.3)], [-math.sin(0.3), math.cos(0.3)]])
    np.testing.assert_allclose(moved, plain @ turn + [0.01, -0.02], atol=1e-16)
    # A right-hand helix turns counter-clockwise along the shaft, once in a lead.
    np.testing.assert_allclose(
        gear_outline(PINION, axial_position=PINION.lead / 8.0), gear_outline(PINION, math.pi / 4.0), atol=1e-15
    )


def test_teeth_of_an_outline_leave_the_spaces_of_the_root_circle() -> None:
    outline = gear_outline(PINION, points=12)
    angle = np.degrees(np.arctan2(outline[:, 1], outline[:, 0]))
    on_root = np.hypot(*outline.T) < PINION.root_circle_radius * (1.0 + 1e-12)
    first_space = sorted(angle[on_root & (angle > 0.0) & (angle < 360.0 / PINION.teeth)])
    assert first_space[0] == pytest.approx(math.degrees(root_half_angle(PINION)), rel=1e-9)
    assert first_space[-1] == pytest.approx(360.0 / PINION.teeth - first_space[0], rel=1e-9)


def contact_points(pair: GearPairGeometry, phase: float, centre_line: float, sense: int) -> tuple[complex, complex]:
    """Where the flanks of the two teeth touch, by the driver's flank and by the driven's."""
    rotations = meshing_rotations(pair, phase, centre_line_angle=centre_line, sense=sense)
    centre = pair.working_centre_distance * np.exp(1j * centre_line)
    points = []
    for gear, radius, rotation, origin in (
        (pair.driver, pair.driver_radius(phase), rotations[0], 0.0),
        (pair.driven, pair.driven_radius(phase), rotations[1], centre),
    ):
        flank = flank_points(gear, load_angle(gear, np.asarray(radius)))
        # A driver turning counter-clockwise pushes with its counter-clockwise flank, which meets the driven's own
        # counter-clockwise flank; clockwise, the other way round.
        on_axis = complex(float(flank.height), sense * float(flank.half_thickness))
        points.append(complex(origin + on_axis * np.exp(1j * rotation)))
    return points[0], points[1]


@st.composite
def meshing_pairs(draw: st.DrawFn) -> GearPairGeometry:
    helix = math.radians(draw(st.floats(-35.0, 35.0)))
    angle = math.radians(draw(st.floats(17.0, 25.0)))
    gears = [
        Gear(
            name,
            draw(st.integers(9, 90)),
            1e-3,
            angle,
            10e-3,
            profile_shift=draw(st.floats(-0.3, 0.6)),
            helix_angle=hand * helix,
            tooth_thinning=draw(st.floats(0.0, 0.05e-3)),
            allow_undercut=True,
        )
        for name, hand in (("driver", 1.0), ("driven", -1.0))
    ]
    return GearPairGeometry(gears[0], gears[1])


@st.composite
def valid_pairs(draw: st.DrawFn) -> GearPairGeometry:
    try:
        return draw(meshing_pairs())
    except GearError:
        assume(False)
    raise AssertionError


@settings(deadline=None, max_examples=100)
@given(valid_pairs(), st.floats(0.0, 1.0), st.floats(-3.2, 3.2), st.sampled_from([1, -1]))
def test_flanks_placed_in_mesh_touch(pair: GearPairGeometry, part: float, centre_line: float, sense: int) -> None:
    phase = part * pair.contact_ratio
    first, second = contact_points(pair, phase, centre_line, sense)
    # On gears of up to a hundred modules: 1e-12 of a module beside the rounding of their own coordinates.
    rounding = 16.0 * np.finfo(float).eps * pair.working_centre_distance
    assert abs(first - second) <= 1e-12 * pair.driver.module + rounding
    # And the line through the contact along the push passes both base circles at their radius.
    push = np.exp(1j * pair.line_of_action_angle(centre_line, sense))
    centre = pair.working_centre_distance * np.exp(1j * centre_line)
    for origin, gear in ((0.0, pair.driver), (centre, pair.driven)):
        arm = abs(((first - origin) * np.conj(push)).imag)
        assert arm == pytest.approx(gear.base_radius, rel=1e-11)


def inside(gear: Gear, rotation: float, centre: complex, outline: FloatArray) -> FloatArray:
    """How far points are inside the teeth of a placed gear, along the arc [m]; negative outside.

    Between root and tip circle; the fillet is interpolated, its points being dense enough for a millionth of a module.
    """
    points = (outline[:, 0] + 1j * outline[:, 1] - centre) * np.exp(-1j * rotation)
    radius, pitch = np.abs(points), 2.0 * math.pi / gear.teeth
    off_axis = np.abs((np.angle(points) + 0.5 * pitch) % pitch - 0.5 * pitch)
    fillet = fillet_points(gear, np.linspace(math.pi / 2.0, gear.fillet_end, 2001))
    half = np.interp(radius, fillet.radius, np.arctan2(fillet.half_thickness, fillet.height))
    on_flank = radius >= gear.form_radius
    flank = flank_points(gear, load_angle(gear, radius[on_flank]))
    half[on_flank] = np.arctan2(flank.half_thickness, flank.height)
    depth = radius * (half - off_axis)
    depth[radius > gear.tip_radius] = -np.inf
    depth[radius < gear.root_circle_radius] = np.inf
    return np.asarray(depth)


@settings(deadline=None, max_examples=50)
@given(valid_pairs(), st.floats(-3.0, 3.0), st.sampled_from([1, -1]))
def test_gears_in_mesh_touch_and_never_overlap(pair: GearPairGeometry, phase: float, sense: int) -> None:
    driver, driven = pair_outlines(pair, phase, sense=sense, points=40)
    rotations = meshing_rotations(pair, phase, sense=sense)
    module = pair.driver.module
    for gear, rotation, centre, other in (
        (pair.driver, rotations[0], 0.0, driven),
        (pair.driven, rotations[1], pair.working_centre_distance, driver),
    ):
        depth = inside(gear, rotation, complex(centre), other)
        assert depth.max() <= 1e-6 * module
        assert depth.max() >= -0.01 * module  # the densest points come this close to a touching flank


def test_every_pair_on_the_path_touches() -> None:
    # One mesh period on, the next teeth stand where these stood.
    for first, second in pairwise(meshing_rotations(PAIR, phase) for phase in (0.2, 1.2, 2.2)):
        assert second[0] - first[0] == pytest.approx(2.0 * math.pi / 21, rel=1e-12)
        assert second[1] - first[1] == pytest.approx(-2.0 * math.pi / 43, rel=1e-12)


@pytest.mark.parametrize("sense", [1, -1])
def test_helical_gears_mesh_in_every_plane_of_their_face(sense: int) -> None:
    # Opposite hands turn the two sections against each other just as rolling does: another phase of the same mesh.
    z, phase = 4e-3, 0.3
    rotations = meshing_rotations(PAIR, phase, sense=sense)
    there = meshing_rotations(PAIR, phase + sense * z / PINION.axial_pitch, sense=sense)
    centre = PAIR.working_centre_distance
    for gear, origin, here, moved in zip((PINION, WHEEL), (0.0, centre), rotations, there, strict=True):
        section = gear_outline(gear, here, (origin, 0.0), axial_position=z)
        np.testing.assert_allclose(section, gear_outline(gear, moved, (origin, 0.0)), atol=1e-15)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: gear_outline(PINION, points=1), "at least 2 points"),
        (lambda: meshing_rotations(PAIR, 0.0, sense=2), "sense must be"),
    ],
)
def test_outlines_that_cannot_be_drawn(call: object, words: str) -> None:
    assert callable(call)
    with pytest.raises(GearError, match=words):
        call()
