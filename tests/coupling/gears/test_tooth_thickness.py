"""Tooth thickness and what a shop measures, by the textbooks' closed forms and by geometry of their own."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from gearwhine.coupling.gears import Gear, GearError
from gearwhine.coupling.gears.errors import PointedToothError, ThinTipError
from gearwhine.coupling.gears.geometry.gear import require_tip_thickness
from gearwhine.coupling.gears.geometry.involute import involute
from gearwhine.coupling.gears.geometry.profile import flank_points, load_angle
from gearwhine.coupling.gears.geometry.thickness import (
    normal_tooth_thickness,
    over_balls,
    span_measurement,
    tooth_thickness,
)

ALPHA = math.radians(20.0)
SPUR = Gear("spur", 28, 3.175e-3, ALPHA, 6.35e-3, profile_shift=0.1)
HELICAL = Gear("helical", 23, 4e-3, ALPHA, 40e-3, profile_shift=0.3, helix_angle=math.radians(-22.0))
THINNED = Gear("thinned", 41, 2e-3, ALPHA, 30e-3, tooth_thinning=0.06e-3, helix_angle=math.radians(15.0))
GEARS = [SPUR, HELICAL, THINNED]
by_name = pytest.mark.parametrize("gear", GEARS, ids=lambda gear: gear.name)


@by_name
def test_normal_thickness_on_the_reference_circle(gear: Gear) -> None:
    # s_n = m_n (pi/2 + 2 x tan(alpha_n)) less the thinning: ISO 21771.
    expected = gear.module * (math.pi / 2.0 + 2.0 * gear.profile_shift * math.tan(ALPHA)) - gear.tooth_thinning
    assert normal_tooth_thickness(gear, gear.pitch_radius) == pytest.approx(expected, rel=1e-12)
    transverse = tooth_thickness(gear, gear.pitch_radius)
    assert transverse == pytest.approx(expected / math.cos(gear.helix_angle), rel=1e-12)


@by_name
def test_thickness_is_what_the_outline_shows(gear: Gear) -> None:
    radii = np.linspace(gear.form_radius, gear.tip_radius, 5)
    flank = flank_points(gear, load_angle(gear, radii))
    for radius, x, y in zip(radii, flank.half_thickness, flank.height, strict=True):
        assert tooth_thickness(gear, radius) == pytest.approx(2.0 * radius * math.atan2(x, y), rel=1e-10)


@by_name
def test_teeth_are_pointed_where_the_thickness_ends(gear: Gear) -> None:
    end = brentq(lambda radius: tooth_thickness(gear, radius), gear.tip_radius, 2.0 * gear.tip_radius, xtol=1e-15)
    addendum = (end - gear.pitch_radius) / gear.module - gear.profile_shift
    replace(gear, addendum=addendum - 1e-6)
    with pytest.raises(PointedToothError):
        replace(gear, addendum=addendum + 1e-6)


@by_name
def test_span_by_the_closed_form(gear: Gear) -> None:
    # W_k = m_n cos(alpha_n) ((k - 1/2) pi + z inv(alpha_t)) + 2 x m_n sin(alpha_n), less the thinning's share.
    found = span_measurement(gear)
    expected = gear.module * math.cos(ALPHA) * (
        (found.teeth - 0.5) * math.pi + gear.teeth * involute(gear.transverse_pressure_angle)
    ) + 2.0 * gear.profile_shift * gear.module * math.sin(ALPHA)
    assert found.length == pytest.approx(expected - gear.tooth_thinning * math.cos(ALPHA), rel=1e-12)
    assert span_measurement(gear, found.teeth + 1).length - found.length == pytest.approx(
        math.pi * gear.module * math.cos(ALPHA), rel=1e-10
    )


def test_span_touches_both_flanks_squarely() -> None:
    # Two involutes of a spur gear, k - 1 pitches apart: the longest distance of points at one radius that is normal to
    # both is the distance of parallel tangents, which the micrometer reads.
    found = span_measurement(SPUR, 4)
    turn = math.pi * (found.teeth - 1) / SPUR.teeth

    def width(radius: float) -> float:
        """Extent across of the right flank of the last tooth, seen along its tangent at the touching point."""
        flank = flank_points(SPUR, load_angle(SPUR, np.array([radius])))
        point = (flank.half_thickness[0] + 1j * flank.height[0]) * np.exp(-1j * turn)
        return 2.0 * float(point.real)

    # Turned to the middle between the teeth, the anvils are upright planes: they touch where the flank is widest.
    widest = minimize_scalar(
        lambda radius: -width(radius),
        bounds=(SPUR.form_radius, SPUR.tip_radius),
        method="bounded",
        options={"xatol": 1e-12},
    )
    assert -widest.fun == pytest.approx(found.length, rel=1e-9)
    assert widest.x == pytest.approx(found.contact_radius, rel=1e-4)


@by_name
def test_balls_by_the_closed_form(gear: Gear) -> None:
    # inv(alpha_K) = inv(alpha_t) + D / (m_n z cos(alpha_n)) - (pi/2 - 2 x tan(alpha_n)) / z: ISO 21771.
    ball = 1.75 * gear.module
    shift = gear.profile_shift - gear.tooth_thinning / (2.0 * gear.module * math.tan(ALPHA))
    value = (
        involute(gear.transverse_pressure_angle)
        + ball / (gear.module * gear.teeth * math.cos(ALPHA))
        - (math.pi / 2.0 - 2.0 * shift * math.tan(ALPHA)) / gear.teeth
    )
    angle = brentq(lambda angle: involute(angle) - value, 0.0, 1.0, xtol=1e-15)
    centre = gear.base_radius / math.cos(angle)
    found = over_balls(gear, ball)
    assert found.centre_radius == pytest.approx(centre, rel=1e-10)
    spread = 1.0 if gear.teeth % 2 == 0 else math.cos(math.pi / (2 * gear.teeth))
    assert found.length == pytest.approx(2.0 * centre * spread + ball, rel=1e-10)


def test_a_ball_is_as_far_from_both_flanks_as_it_is_thick() -> None:
    found = over_balls(SPUR)
    centre = found.centre_radius * complex(math.sin(math.pi / SPUR.teeth), math.cos(math.pi / SPUR.teeth))

    def distance(radius: float) -> float:
        flank = flank_points(SPUR, load_angle(SPUR, np.array([radius])))
        return abs(complex(flank.half_thickness[0], flank.height[0]) - centre)

    nearest = minimize_scalar(
        distance, bounds=(SPUR.form_radius, SPUR.tip_radius), method="bounded", options={"xatol": 1e-12}
    )
    assert nearest.fun == pytest.approx(0.5 * found.diameter, rel=1e-9)
    assert nearest.x == pytest.approx(found.contact_radius, rel=1e-5)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: span_measurement(SPUR, 0), "span is over 1 to 28 teeth"),
        (lambda: span_measurement(SPUR, 9), "does not touch the flank"),
        (lambda: span_measurement(replace(HELICAL, face_width=3e-3)), "needs a face width"),
        (lambda: over_balls(SPUR, 2e-3), "lie on the root|does not touch the flank"),
        (lambda: over_balls(SPUR, 12e-3), "does not touch the flank"),
        (lambda: over_balls(SPUR, -1.0), "ball diameter must be above 0"),
        (lambda: tooth_thickness(SPUR, 0.9 * SPUR.base_radius), "no involute below the base circle"),
    ],
)
def test_measurements_that_cannot_be_taken(call: object, words: str) -> None:
    assert callable(call)
    with pytest.raises(GearError, match=words):
        call()


def test_thin_tips_are_named() -> None:
    require_tip_thickness(SPUR)
    sharp = Gear("sharp", 12, 2e-3, ALPHA, 20e-3, profile_shift=0.55)
    thickness = normal_tooth_thickness(sharp, sharp.tip_radius) / sharp.module
    assert 0.1 < thickness < 0.4
    with pytest.raises(ThinTipError, match=r"'sharp'.*at least 0\.4 modules"):
        require_tip_thickness(sharp, least=0.4)
    require_tip_thickness(sharp, least=thickness - 1e-9)
