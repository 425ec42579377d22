"""Two gears in mesh: the path of contact by elementary geometry, and pairs that cannot run."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from gearwhine.coupling.gears import Gear, GearError, GearPairGeometry
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.gears.errors import InterferenceError, MismatchedGearsError, NoContactError
from gearwhine.coupling.gears.loaded.gear_pair import GearPair

ALPHA = math.radians(20.0)
PINION = Gear("pinion", 21, 3e-3, ALPHA, 15e-3, profile_shift=0.25)
WHEEL = Gear("wheel", 43, 3e-3, ALPHA, 12e-3, profile_shift=0.1)
PAIR = GearPairGeometry(PINION, WHEEL)


def test_path_of_contact_is_cut_off_the_line_of_action_by_the_tip_circles() -> None:
    # Plane coordinates: driver at the origin, driven on the x axis, line of action tangent to both base circles.
    angle, distance = PAIR.working_pressure_angle, PAIR.working_centre_distance
    tangent = PINION.base_radius * np.array([math.cos(angle), -math.sin(angle)])
    along = np.array([math.sin(angle), math.cos(angle)])
    other = np.array([distance, 0.0])

    def reach(centre: np.ndarray, radius: float, low: float, high: float) -> float:
        return float(brentq(lambda t: np.linalg.norm(tangent + t * along - centre) - radius, low, high))

    full = distance * math.sin(angle)
    end = reach(np.zeros(2), PINION.tip_radius, 0.0, full)
    start = reach(other, WHEEL.tip_radius, 0.0, full)
    assert PAIR.path_length == pytest.approx(end - start, rel=1e-10)
    assert PAIR.contact_ratio == pytest.approx((end - start) / (math.pi * 3e-3 * math.cos(ALPHA)), rel=1e-10)
    for position in (0.0, 0.4, PAIR.contact_ratio):
        point = tangent + (start + position * PAIR.base_pitch) * along
        assert float(PAIR.driver_radius(position)) == pytest.approx(float(np.linalg.norm(point)), rel=1e-10)
        from_driven = float(np.linalg.norm(point - other))
        assert float(PAIR.driven_radius(position)) == pytest.approx(from_driven, rel=1e-10)


def test_ends_and_pitch_point() -> None:
    assert float(PAIR.driven_radius(0.0)) == pytest.approx(WHEEL.tip_radius, rel=1e-13)
    assert float(PAIR.driver_radius(PAIR.contact_ratio)) == pytest.approx(PINION.tip_radius, rel=1e-13)
    working = PINION.base_radius / math.cos(PAIR.working_pressure_angle)
    assert float(PAIR.driver_radius(PAIR.pitch_point_position)) == pytest.approx(working, rel=1e-13)


def test_roll_angles_are_linear_and_turn_with_the_gears() -> None:
    # One base pitch turns each gear by one tooth, in opposite senses of roll.
    assert float(PAIR.driver_roll_angle(1.0) - PAIR.driver_roll_angle(0.0)) == pytest.approx(2 * math.pi / 21)
    assert float(PAIR.driven_roll_angle(0.0) - PAIR.driven_roll_angle(1.0)) == pytest.approx(2 * math.pi / 43)
    roll = float(PAIR.driver_roll_angle(0.7))
    assert PAIR.driver_position(roll) == pytest.approx(0.7, rel=1e-12)
    assert PAIR.driven_position(float(PAIR.driven_roll_angle(0.7))) == pytest.approx(0.7, rel=1e-12)
    assert roll == pytest.approx(PINION.roll_angle(float(PAIR.driver_radius(0.7))), rel=1e-12)


def test_wider_distance_opens_backlash_and_shortens_contact() -> None:
    wide = GearPairGeometry(PINION, WHEEL, PAIR.working_centre_distance + 0.2e-3)
    assert wide.contact_ratio < PAIR.contact_ratio
    # d(backlash)/d(distance) = 2 sin(w), between the two angles.
    low, high = (2.0 * 0.2e-3 * math.sin(pair.working_pressure_angle) for pair in (PAIR, wide))
    assert low < wide.normal_backlash < high


def test_idle_flanks_of_standard_gears_stand_half_a_pitch_off() -> None:
    # A standard tooth is as thick as its space: when one pair meets at the pitch point on the working flanks,
    # the back flanks' pairs stand half a base pitch before and after it.
    pair = GearPairGeometry(*(replace(gear, profile_shift=0.0) for gear in (PINION, WHEEL)))
    at_pitch_point = pair.pitch_point_position
    idle = (pair.back_flank_offset - at_pitch_point) % 1.0
    assert idle == pytest.approx((at_pitch_point + 0.5) % 1.0, abs=1e-12)


def test_idle_flanks_from_driver_and_driven_agree_without_backlash() -> None:
    # The same phase read from the driven gear: roles exchanged, positions counted from the other end.
    mirrored = GearPairGeometry(WHEEL, PINION)
    # A position s of one pair is eps - s of the other, so the two phases add up to 2 eps.
    left_over = 2.0 * PAIR.contact_ratio - mirrored.back_flank_offset - PAIR.back_flank_offset
    assert left_over == pytest.approx(round(left_over), abs=1e-9)


def test_line_of_action_angle() -> None:
    w = PAIR.working_pressure_angle
    assert PAIR.line_of_action_angle(0.3) == pytest.approx(0.3 + math.pi / 2.0 - w)
    assert PAIR.line_of_action_angle(0.3, sense=-1) == pytest.approx(0.3 - math.pi / 2.0 + w)
    with pytest.raises(GearError, match="sense must be"):
        PAIR.line_of_action_angle(0.0, sense=0)


@pytest.mark.parametrize(
    ("other", "distance", "kind", "words"),
    [
        (replace(WHEEL, module=2e-3), None, MismatchedGearsError, "same module, got 3 and 2 mm"),
        (
            replace(WHEEL, pressure_angle=math.radians(25)),
            None,
            MismatchedGearsError,
            "pressure_angle, got 20 and 25",
        ),
        (
            WHEEL,
            90e-3,
            InterferenceError,
            "do not fit .* 90 mm; they mesh .* at 97.*; it has to exceed the sum of the base radii",
        ),
        (WHEEL, 96.5e-3, InterferenceError, "the teeth jam"),
        (WHEEL, math.nan, InterferenceError, "centre distance"),
        (WHEEL, 101.5e-3, NoContactError, "lose contact .* 101.5 mm; they mesh without backlash at 97"),
        (replace(WHEEL, addendum=0.2), None, NoContactError, "the contact ratio is 0.*; lengthen the teeth$"),
        (replace(WHEEL, addendum=0.2), 100e-3, NoContactError, "the contact ratio is 0.*; lengthen the teeth$"),
        (replace(WHEEL, addendum=1.2), None, InterferenceError, "hits the root of 'pinion'|below the involute"),
    ],
)
def test_impossible_pairs_say_what_is_wrong(other: Gear, distance: float | None, kind: type, words: str) -> None:
    with pytest.raises(kind, match=words) as caught:
        GearPairGeometry(PINION, other, distance)
    assert isinstance(caught.value, GearError)
    assert "'pinion' -> 'wheel'" in str(caught.value)


def test_helical_teeth_that_lose_contact_want_more_height_or_width() -> None:
    """ε = ε_α + b sin β / (π m_n): 1 mm of face adds 0.018 at 10°."""
    helical = [
        replace(gear, helix_angle=turn * math.radians(10.0), addendum=0.25, face_width=1e-3, profile_shift=0.0)
        for gear, turn in ((PINION, 1.0), (WHEEL, -1.0))
    ]
    with pytest.raises(NoContactError, match=r"the total contact ratio is 0.*; lengthen the teeth or widen the faces$"):
        GearPairGeometry(*helical)


def test_shifts_that_never_close_are_refused() -> None:
    gear = Gear("rack-like", 200, 1e-3, ALPHA, 1e-2, profile_shift=-5.0)
    with pytest.raises(InterferenceError, match="do not close at any distance"):
        GearPairGeometry(gear, gear)


def test_sizes_rounded_in_print_mesh() -> None:
    # Eight teeth per inch is 3.175 mm, and Table I of TM-104434 prints 3.1748.
    pair = GearPairGeometry(Gear("inch", 28, 3.175e-3, ALPHA, 6.35e-3), Gear("printed", 28, 3.1748e-3, ALPHA, 6.35e-3))
    assert pair.contact_ratio == pytest.approx(1.638, abs=1e-3)


def test_a_tip_that_reaches_below_the_involute_is_interference() -> None:
    # A blunt rack corner leaves a high fillet on the pinion; the wheel's tip would run into it.
    blunt = Gear("pinion", 18, 3e-3, ALPHA, 15e-3, dedendum=1.25, root_radius=1.4e-3)
    with pytest.raises(InterferenceError, match="below the involute of 'pinion'"):
        GearPairGeometry(blunt, Gear("wheel", 200, 3e-3, ALPHA, 12e-3))


def test_a_given_backlash_is_held_against_that_of_the_teeth() -> None:
    assert PAIR.designed_backlash is None  # closed teeth at their own distance
    thin = GearPairGeometry(replace(PINION, tooth_thinning=60e-6), replace(WHEEL, tooth_thinning=40e-6))
    made = thin.designed_backlash
    assert made == thin.backlash > 0.0
    pair = GearPair("pinion", "wheel")
    assert pair.backlash_of(thin) == made
    assert replace(pair, backlash=2.0 * made).backlash_of(thin) == 2.0 * made
    assert pair.backlash_warning(thin) is None
    assert replace(pair, backlash=1.05 * made).backlash_warning(thin) is None
    assert replace(pair, backlash=2.0 * made).backlash_warning(PAIR) is None
    said = replace(pair, backlash=2.0 * made).backlash_warning(thin)
    assert said is not None
    assert f"{2e3 * made:.4g} mm is not the {1e3 * made:.4g} mm" in said


def test_corners_beside_the_ends_of_a_curve_do_not_cut_it_short() -> None:
    knots = np.array([0.0, 0.5, 1.0])
    found = piecewise.with_corners(knots, [1.0 - 1e-10, 0.25, 0.25 + 1e-10, 0.5 + 1e-10, 1e-10, 1.5, -1.0, 0.75], 1e-9)
    np.testing.assert_array_equal(found, [0.0, 0.25, 0.5, 0.75, 1.0])
