"""Named points of the path of contact, sliding, and centre distances from profile shifts and back."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwhine.coupling.gears import Gear, GearError, GearPairGeometry, path_of_contact
from gearwhine.coupling.gears.errors import InterferenceError
from gearwhine.coupling.gears.geometry.pair import profile_shift_sum
from gearwhine.coupling.gears.geometry.path_of_contact import POINTS_OF_CONTACT, specific_sliding
from gearwhine.coupling.gears.geometry.thickness import tooth_thickness

ALPHA, BETA = math.radians(20.0), math.radians(16.0)
PINION = Gear("pinion", 21, 3e-3, ALPHA, 15e-3, profile_shift=0.25, helix_angle=BETA)
WHEEL = Gear("wheel", 43, 3e-3, ALPHA, 12e-3, profile_shift=0.1, helix_angle=-BETA)
PAIR = GearPairGeometry(PINION, WHEEL)


def test_named_points_are_where_their_names_say() -> None:
    path = path_of_contact(PAIR)
    named = dict(zip(POINTS_OF_CONTACT, path.driver_radius, strict=True))
    other = dict(zip(POINTS_OF_CONTACT, path.driven_radius, strict=True))
    assert named["EAP"] == pytest.approx(PINION.tip_radius, rel=1e-13)
    assert other["SAP"] == pytest.approx(WHEEL.tip_radius, rel=1e-13)
    assert named["pitch point"] + other["pitch point"] == pytest.approx(PAIR.working_centre_distance, rel=1e-13)
    assert named["pitch point"] == pytest.approx(PAIR.working_pitch_radii[0], rel=1e-13)
    # Alone between the leaving of the pair before and the entering of the next, a base pitch from the ends.
    base = PINION.base_radius
    along = {name: math.sqrt(radius**2 - base**2) for name, radius in named.items()}
    assert along["EAP"] - along["LPSTC"] == pytest.approx(PINION.base_pitch, rel=1e-12)
    assert along["HPSTC"] - along["SAP"] == pytest.approx(PINION.base_pitch, rel=1e-12)
    assert list(path.driver_roll_angle) == sorted(path.driver_roll_angle)


def test_sliding_by_the_velocities_of_the_touching_points() -> None:
    # Rigid bodies in the plane: the points' velocities along the flank's tangent, from positions and angular speeds.
    angle, distance = PAIR.working_pressure_angle, PAIR.working_centre_distance
    normal = np.array([math.sin(angle), math.cos(angle)])
    tangent = np.array([normal[1], -normal[0]])
    foot = PINION.base_radius * np.array([math.cos(angle), -math.sin(angle)])
    position = np.array([0.0, 0.4, 1.1, PAIR.contact_ratio])
    driver, driven = specific_sliding(PAIR, position)
    for place, ours, theirs in zip(position, driver, driven, strict=True):
        point = foot + (PAIR.start_distance + place * PAIR.base_pitch) * normal
        first = np.array([-point[1], point[0]])
        arm = point - [distance, 0.0]
        second = -21 / 43 * np.array([-arm[1], arm[0]])
        assert first @ normal == pytest.approx(second @ normal, rel=1e-12)  # the flanks stay in touch
        u, v = first @ tangent, second @ tangent
        assert ours == pytest.approx((u - v) / u, rel=1e-10)
        assert theirs == pytest.approx((v - u) / v, rel=1e-10)
    assert specific_sliding(PAIR, PAIR.pitch_point_position)[0] == pytest.approx(0.0, abs=1e-12)


def test_sliding_on_the_base_circle_has_no_bound() -> None:
    on_base = -PAIR.start_distance / PAIR.base_pitch
    driver, driven = specific_sliding(PAIR, on_base)
    assert driver < -1e12
    assert driven == pytest.approx(1.0, abs=1e-12)


@settings(deadline=None, max_examples=60)
@given(
    st.integers(18, 80),
    st.integers(18, 80),
    st.floats(-40.0, 40.0),
    st.floats(0.0, 0.4),
    st.floats(0.0, 0.4),
)
def test_shifts_give_the_distance_and_the_distance_the_shifts(
    first: int, second: int, helix: float, x: float, y: float
) -> None:
    driver = Gear("driver", first, 2e-3, ALPHA, 20e-3, profile_shift=x, helix_angle=math.radians(helix))
    driven = Gear("driven", second, 2e-3, ALPHA, 20e-3, profile_shift=y, helix_angle=-math.radians(helix))
    pair = GearPairGeometry(driver, driven)
    distance = pair.working_centre_distance
    assert profile_shift_sum(driver, driven, distance) == pytest.approx(x + y, abs=1e-9)
    # The thicknesses fill the working pitch.
    radii = pair.working_pitch_radii
    filled = tooth_thickness(driver, radii[0]) + tooth_thickness(driven, radii[1])
    assert filled == pytest.approx(2.0 * math.pi * radii[0] / first, rel=1e-10)
    # Exchanged, nothing changes.
    other = GearPairGeometry(driven, driver)
    assert other.contact_ratio == pytest.approx(pair.contact_ratio, rel=1e-11)
    assert other.overlap_ratio == pair.overlap_ratio
    np.testing.assert_allclose(
        path_of_contact(other).driven_radius[::-1], path_of_contact(pair).driver_radius, rtol=1e-10
    )


def test_backlash_is_the_pitch_that_the_teeth_leave_empty() -> None:
    thinned = replace(PINION, tooth_thinning=0.04e-3), replace(WHEEL, tooth_thinning=0.07e-3)
    assert GearPairGeometry(*thinned).working_centre_distance == PAIR.working_centre_distance
    for gears, distance in (
        (thinned, None),
        ((PINION, WHEEL), PAIR.working_centre_distance + 0.1e-3),
        (thinned, PAIR.working_centre_distance + 0.1e-3),
    ):
        pair = GearPairGeometry(*gears, distance)
        radii = pair.working_pitch_radii
        filled = sum(tooth_thickness(gear, radius) for gear, radius in zip(gears, radii, strict=True))
        empty = 2.0 * math.pi * radii[0] / PINION.teeth - filled
        assert pair.circumferential_backlash == pytest.approx(empty, rel=1e-9)
        # A normal to helical flanks is turned by the pressure angle and by the helix angle on the pitch cylinder.
        normal_angle = math.atan(math.tan(pair.working_pressure_angle) * math.cos(pair.working_helix_angle))
        normal = empty * math.cos(normal_angle) * math.cos(pair.working_helix_angle)
        assert pair.normal_backlash == pytest.approx(normal, rel=1e-9)
        assert pair.backlash == pytest.approx(empty * math.cos(pair.working_pressure_angle), rel=1e-9)


def test_interference_names_both_radii() -> None:
    blunt = Gear("pinion", 18, 3e-3, ALPHA, 15e-3, root_radius=1.4e-3)
    wheel = Gear("wheel", 200, 3e-3, ALPHA, 12e-3)
    # The start of contact from the standard centre distance: what the wheel's tip leaves of the line of action.
    lowest = 1.5e-3 * 218 * math.sin(ALPHA) - math.sqrt(wheel.tip_radius**2 - wheel.base_radius**2)
    radii = 1e3 * math.hypot(blunt.base_radius, lowest), 1e3 * blunt.form_radius
    with pytest.raises(
        InterferenceError, match="start at a radius of {:.6g} mm.* a radius of {:.6g} mm".format(*radii)
    ):
        GearPairGeometry(blunt, wheel)
    with pytest.raises(InterferenceError, match="start inside the base circle of"):
        GearPairGeometry(blunt, replace(wheel, addendum=1.2, dedendum=1.5, teeth=400))
    cut = Gear("pinion", 13, 3e-3, ALPHA, 15e-3, allow_undercut=True)
    with pytest.raises(InterferenceError, match=f"starts at a radius of {cut.form_radius * 1e3:.6g} mm"):
        GearPairGeometry(cut, Gear("wheel", 40, 3e-3, ALPHA, 12e-3))
    assert GearPairGeometry(cut, Gear("wheel", 40, 3e-3, ALPHA, 12e-3, addendum=0.7)).contact_ratio > 1.0


@pytest.mark.parametrize("distance", [80e-3, math.nan])
def test_distances_that_no_shift_closes(distance: float) -> None:
    with pytest.raises(GearError):
        profile_shift_sum(PINION, WHEEL, distance)
