"""Interference of internal pairs: each check on both sides of its limit, against the drawn outlines."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.coupling.gears import Gear, GearPairGeometry
from gearwhine.coupling.gears.errors import InterferenceError, NoContactError
from gearwhine.coupling.gears.geometry.interference import (
    addendum_without_fouling,
    fouling_clearance,
    radial_clearance,
)
from gearwhine.coupling.gears.geometry.pair import backlash_free_pressure_angle
from gearwhine.coupling.gears.geometry.profile import gear_outline
from tests.machines.internal_pairs import depth_of_overlap, pinion, ring

CHORDS = 3e-7
"""Overlap of touching flanks whose outlines are polygons [m]."""
SMALL = pinion(20, profile_shift=0.5)


def around(teeth: int, addendum: float) -> Gear:
    return ring(teeth, addendum=addendum, profile_shift=-0.5)


def closed_distance(one: Gear, internal: Gear) -> float:
    """Distance of the axes of two gears in mesh without backlash [m]."""
    angle = backlash_free_pressure_angle(one, internal)
    return -(one.base_radius + internal.base_radius) / math.cos(angle)


def overlap_in_mesh(one: Gear, internal: Gear, phases: int = 12) -> float:
    """Depth of overlap of two gears over a mesh period in mesh without backlash [m].

    A tooth of the pinion in a space of the ring on the line of centres, and both turned in the ratio of their teeth.
    """
    centre = (closed_distance(one, internal), 0.0)
    depths = []
    for turned in np.arange(phases) / phases * 2.0 * math.pi:
        inside = gear_outline(one, turned / one.teeth, centre)
        outside = gear_outline(internal, math.pi + (turned + math.pi) / internal.tooth_count)
        depths.append(depth_of_overlap(outside, inside))
    return max(depths)


@pytest.mark.parametrize(("teeth", "addendum"), [(-27, 0.8), (-26, 0.6), (-26, 0.8), (-25, 0.6)])
def test_fouling_is_where_the_outlines_overlap(teeth: int, addendum: float) -> None:
    gear = around(teeth, addendum)
    distance = closed_distance(SMALL, gear)
    clearance, depth = fouling_clearance(SMALL, gear, distance), overlap_in_mesh(SMALL, gear, 50)
    if clearance > 0.0:
        assert depth < CHORDS
        assert GearPairGeometry(SMALL, gear).is_internal
        return
    # The clearance is along the tip circle; at the crossing the corners overlap by less than that.
    assert 0.3 * -clearance < depth < -clearance
    allowed = addendum_without_fouling(SMALL, gear, distance)
    assert allowed is not None
    assert allowed < addendum
    assert fouling_clearance(SMALL, replace(gear, addendum=allowed - 1e-6), distance) > 0.0
    message = rf"teeth foul each other by .* addendum of 'ring' of at most {allowed:.4g}, or a greater difference"
    for gears in ((SMALL, gear), (gear, SMALL)):
        with pytest.raises(InterferenceError, match=message):
            GearPairGeometry(*gears)
    assert overlap_in_mesh(SMALL, replace(gear, addendum=allowed - 1e-3)) < CHORDS


def overlap_while_pushed_in(one: Gear, internal: Gear, distance: float, first: float) -> float:
    """Depth of overlap on the way, with a tooth of the pinion (0) or a space (0.5) on the line of centres [m]."""
    half = math.pi / internal.tooth_count
    outline = gear_outline(internal, math.pi + (half if first == 0.0 else 0.0))
    places = np.linspace(0.75 * abs(distance), abs(distance), 30)
    turned = 2.0 * math.pi * first / one.teeth
    return max(depth_of_overlap(outline, gear_outline(one, turned, (at, 0.0))) for at in places)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("small", "teeth", "addendum"), [(20, -32, 0.8), (20, -31, 0.8), (20, -29, 0.6), (17, -28, 0.8)]
)
def test_radial_mounting_is_where_the_outlines_pass(small: int, teeth: int, addendum: float) -> None:
    # Of the last pair the pinion enters with a space on the line of centres, and not with a tooth.
    pair = GearPairGeometry(pinion(small, profile_shift=0.5), around(teeth, addendum))
    distance = pair.working_centre_distance
    clearance = radial_clearance(pair.driver, pair.driven, distance)
    depths = [overlap_while_pushed_in(pair.driver, pair.driven, distance, first) for first in (0.0, 0.5)]
    if clearance > 0.0:
        assert min(depths) < CHORDS
        assert pair.findings == ()
        assert (depths[0] > 50.0 * CHORDS) is (small == 17)
    else:
        # The deepest place of the way lies between two of those tried.
        assert 0.7 * -clearance < min(depths) < -clearance
        assert "to be mounted along the axes: pushed in radially, the teeth overlap by" in str(pair.findings[0])
        assert pair.findings[0].severity == "warning"


def test_involute_interference_is_where_the_tip_of_the_ring_meets_the_foot_of_the_pinion() -> None:
    # The ring's tip may reach to the pinion's tangent point: r_a2^2 = rb_2^2 + ((rb_2 - rb_1) tan(w))^2. A pinion cut
    # by a rack has its foot there where it is at the limit of undercut.
    alpha = math.radians(20.0)
    small = pinion(20, profile_shift=1.0 - 10.0 * math.sin(alpha) ** 2, root_radius=None)
    assert small.form_radius == pytest.approx(small.base_radius, rel=1e-9)
    shift = -small.profile_shift  # reference centre distance
    tangent = math.hypot(60.0 * math.cos(alpha), 40.0 * math.cos(alpha) * math.tan(alpha))
    limit = (60.0 - tangent) / 2.0 - shift
    pair = GearPairGeometry(small, ring(profile_shift=shift, addendum=limit - 1e-6))
    assert pair.start_distance == pytest.approx(0.0, abs=1e-7)
    with pytest.raises(InterferenceError, match=r"'ring' reaches .* contact would start inside the base circle of"):
        GearPairGeometry(small, ring(profile_shift=shift, addendum=limit + 0.02))
    # The flank is much curved at its foot, on the base circle, where chords cut off more.
    assert overlap_in_mesh(small, ring(profile_shift=shift, addendum=limit - 1e-6)) < 10.0 * CHORDS
    assert overlap_in_mesh(small, ring(profile_shift=shift, addendum=limit + 0.15)) > 30.0 * CHORDS


def test_tip_of_the_pinion_in_the_fillet_of_the_ring() -> None:
    # A ring whose fillet begins before the pinion's tip has left.
    sharp, round_root = ring(root_radius=0.3e-3), ring(dedendum=1.1, root_radius=0.83e-3)
    small = pinion(20, addendum=1.05)
    assert overlap_in_mesh(small, sharp) < CHORDS
    assert GearPairGeometry(small, sharp).contact_ratio > 1.5
    with pytest.raises(InterferenceError, match=r"the tip of 'pinion' reaches .* below the involute of 'ring'"):
        GearPairGeometry(small, round_root)
    assert overlap_in_mesh(small, round_root) > 10.0 * CHORDS


def test_tip_of_the_pinion_in_the_root_of_the_ring() -> None:
    with pytest.raises(InterferenceError, match=r"the tip of 'pinion' hits the root of 'ring' by 0\.1 mm"):
        GearPairGeometry(pinion(20), ring(dedendum=0.95, root_radius=0.01e-3))


def test_teeth_that_jam_or_lose_contact() -> None:
    close = GearPairGeometry(pinion(20), ring())
    assert GearPairGeometry(pinion(20), ring(), -39.9e-3).backlash > 0.0
    with pytest.raises(InterferenceError, match="the teeth jam"):
        GearPairGeometry(pinion(20), ring(), close.working_centre_distance - 0.1e-3)
    with pytest.raises(NoContactError, match=r"the contact ratio is 0\.\d+, below 1"):
        GearPairGeometry(pinion(20, addendum=0.35), ring(addendum=0.25))
