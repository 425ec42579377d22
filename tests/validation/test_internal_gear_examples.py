"""Internal gears of published examples: SDP/SI, Elements of Metric Gear Technology, sections 5 and 10; a DIN 5480 hub.

Table 5-1 has an internal gear of 24 teeth with a pinion of 16, module 3 mm, 20 degrees, shift coefficients 0 and 0.5
(outward, so -0.5 after ISO 21771, which gives a ring negative teeth). Equations are repeated here with lengths that are
positive, as the tables have them. Measures between pins and balls, spans and the contact ratio have no printed example
of a ring there: they are held against the printed equations and against distances from drawn flanks, and against other
programs' prints in ``test_planetary_stage_reports.py``.

A hub with an involute spline is measured as a ring is. DIN 5480-1:2006, figure 6, has the hub N 120 x 3 x 38 x 9H, and
DIN 5480-2:2006, tables 22 and 23, its nominal dimension; both are quoted in thread 388615 of www.eng-tips.com.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from scipy.optimize import minimize

from gearwhine.coupling.gears import Gear, GearPairGeometry
from gearwhine.coupling.gears.errors import InterferenceError
from gearwhine.coupling.gears.geometry.interference import fouling_clearance
from gearwhine.coupling.gears.geometry.pair import backlash_free_pressure_angle, profile_shift_sum
from gearwhine.coupling.gears.geometry.path_of_contact import path_of_contact
from gearwhine.coupling.gears.geometry.profile import gear_outline
from gearwhine.coupling.gears.geometry.thickness import over_balls, span_measurement

FloatArray = npt.NDArray[np.float64]

MM = 1e-3
ALPHA = math.radians(20.0)
PINION = Gear("pinion", 16, 3 * MM, ALPHA, 30 * MM, allow_undercut=True)
RING = Gear("ring", -24, 3 * MM, ALPHA, 30 * MM, profile_shift=-0.5)
SHORTER = replace(RING, addendum=0.9)
"""The tip of the table's ring meets the pinion just below its base circle: by its Eq. 5-1, 16/24 is below 0.668."""


def inv(angle: float) -> float:
    return math.tan(angle) - angle


def test_pair_of_table_5_1() -> None:
    with pytest.raises(InterferenceError, match="inside the base circle"):
        GearPairGeometry(PINION, RING)
    tangents = [math.tan(angle) for angle in (math.acos(67.658 / 69.0), math.radians(31.0937))]
    assert 16.0 / 24.0 < 1.0 - tangents[0] / tangents[1] == pytest.approx(0.668, abs=5e-4)
    pair = GearPairGeometry(PINION, SHORTER)
    # Printed values.
    assert math.degrees(pair.working_pressure_angle) == pytest.approx(31.0937, abs=1e-4)
    assert inv(pair.working_pressure_angle) == pytest.approx(0.060401, abs=1e-6)
    assert -pair.working_centre_distance / MM == pytest.approx(13.1683, abs=1e-4)
    diameters = [2.0 * abs(r) / MM for r in (PINION.base_radius, RING.base_radius, *pair.working_pitch_radii)]
    assert diameters == pytest.approx([45.105, 67.658, 52.673, 79.010], abs=6e-4)
    assert 2.0 * PINION.tip_radius / MM == pytest.approx(54.0)
    assert -2.0 * RING.tip_radius / MM == pytest.approx(69.0)
    assert -2.0 * RING.root_circle_radius / MM == pytest.approx(82.5)
    # They close by the table's equations.
    assert inv(pair.working_pressure_angle) == pytest.approx(2.0 * math.tan(ALPHA) * 0.5 / 8.0 + inv(ALPHA), rel=1e-12)
    # Table 5-2 goes back from the distance to the shift.
    assert profile_shift_sum(PINION, RING, -13.1683 * MM) == pytest.approx(-0.5, abs=2e-5)


def test_contact_ratio_and_sliding_of_the_pair() -> None:
    pair = GearPairGeometry(PINION, SHORTER)
    # Lengths along the line of action: tip of the pinion, tip of the ring, and between the tangent points.
    first = math.sqrt(27.0**2 - (24.0 * math.cos(ALPHA)) ** 2)
    second = math.sqrt(34.8**2 - (36.0 * math.cos(ALPHA)) ** 2)
    between = 13.1683 * math.sin(math.radians(31.0937))
    assert pair.contact_ratio == pytest.approx((first - second + between) / (3.0 * math.pi * math.cos(ALPHA)), rel=1e-5)
    # Sliding at both ends: of the speeds along the flanks, w1 rho1 and w2 rho2 with rho2 = rho1 + between.
    path = path_of_contact(pair)
    for n, rho in ((0, second - between), (-1, first)):
        along = rho, (rho + between) * 16.0 / 24.0
        assert path.driver_sliding[n] == pytest.approx(1.0 - along[1] / along[0], rel=1e-4)
        assert path.driven_sliding[n] == pytest.approx(1.0 - along[0] / along[1], rel=1e-4)
    assert path.driver_sliding[2] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("teeth", [28, 34, 60])
def test_trochoid_interference_of_standard_teeth_needs_ten_teeth_of_difference(teeth: int) -> None:
    # "In the meshing of an external gear and a standard internal gear at 20 degrees, trochoid interference is avoided
    # if the difference of the number of teeth is larger than 9."
    def clearance(difference: int) -> float:
        pinion = Gear("pinion", teeth, 3 * MM, ALPHA, 30 * MM)
        ring = Gear("ring", -teeth - difference, 3 * MM, ALPHA, 30 * MM)
        base = -(pinion.base_radius + ring.base_radius)
        return fouling_clearance(pinion, ring, base / math.cos(backlash_free_pressure_angle(pinion, ring)))

    assert clearance(10) > 0.0
    assert clearance(8) < 0.0


@pytest.mark.parametrize("teeth", [-60, -61])
@pytest.mark.parametrize("shift", [-0.3, 0.0, 0.4])
def test_dimension_between_pins_touches_both_flanks(teeth: int, shift: float) -> None:
    ring = Gear("ring", teeth, 2 * MM, ALPHA, 20 * MM, profile_shift=shift, addendum=0.6)
    pins = over_balls(ring)
    assert pins.diameter == pytest.approx(1.65 * 2 * MM)
    # The pin of the drawn space touches its outline from inside.
    outline = gear_outline(ring, math.pi + math.pi / ring.tooth_count, points=200)
    gap = np.hypot(*(outline - (-pins.centre_radius, 0.0)).T).min()
    assert gap == pytest.approx(0.5 * pins.diameter, abs=2e-8)
    # SDP/SI Eqs. 38 and 39: under pins in opposite spaces, or nearly so.
    spread = 1.0 if teeth % 2 == 0 else math.cos(math.pi / (2.0 * abs(teeth)))
    assert pins.length == pytest.approx(-2.0 * pins.centre_radius * spread - pins.diameter, rel=1e-12)
    # Its equation for the pin's centre, with the width of the space e = p - s at the reference circle.
    r, d = 60.0 * MM * abs(teeth) / 60.0, pins.diameter
    space = math.pi * MM - 4.0 * MM * shift * math.tan(ALPHA)
    at_pin = math.acos(r * math.cos(ALPHA) / -pins.centre_radius)
    assert inv(at_pin) == pytest.approx(inv(ALPHA) + space / (2.0 * r) - d / (2.0 * r * math.cos(ALPHA)), rel=1e-9)


DIN_5480 = "DIN 5480:2006, hub N 120 x 3 x 38 x 9H"


def test_hub_of_din_5480(published: Callable[..., None]) -> None:
    # The reference diameter 120 = m z + 2 x m + 1.1 m sets the shift: x m = 1.35 mm, outward in a hub. The quotations
    # leave the measuring circle out: 5.25 mm is the one near 1.75 modules that gives the nominal dimension.
    hub = Gear("hub", -38, 3 * MM, math.radians(30.0), 20 * MM, profile_shift=-0.45, addendum=0.45, dedendum=0.6)

    def between(space_width: float) -> float:
        return over_balls(replace(hub, tooth_thinning=(space_width - 6.27124) * MM), 5.25 * MM).length / MM

    published(DIN_5480, "dimension between measuring circles, nominal", 109.110, between(6.27124), "mm", abs=0.5e-3)
    factor = (between(6.28124) - between(6.27124)) / 0.01
    published(DIN_5480, "change with the space width", 1.72, factor, abs=0.5e-2)
    # From space widths of three decimals (0.9 um) by the factor 1.72, not by the exact equation (0.7 um).
    published(DIN_5480, "dimension at the widest space", 109.266, between(6.361), "mm", abs=2.1e-3)
    published(DIN_5480, "dimension at the narrowest space", 109.169, between(6.305), "mm", abs=1.6e-3)


def test_span_of_a_ring_is_over_spaces() -> None:
    ring = Gear("ring", -60, 2 * MM, ALPHA, 20 * MM, profile_shift=0.2, addendum=0.6)
    span = span_measurement(ring)
    # W_k = m cos(alpha) ((k - 0.5) pi + z inv(alpha) - 2 x tan(alpha)) over spaces, as wide as the teeth of its mate.
    per_module = (span.teeth - 0.5) * math.pi + 60.0 * inv(ALPHA) - 0.4 * math.tan(ALPHA)
    assert span.length == pytest.approx(2 * MM * math.cos(ALPHA) * per_module, rel=1e-12)
    assert -ring.tip_radius < -span.contact_radius < -ring.form_radius
    # The two points of the drawn flanks in the tangent of the base circle are as far apart.
    outline = gear_outline(ring, math.pi / 60.0 * (span.teeth % 2 == 1), points=400)
    x, y = outline.T
    level = np.flatnonzero(np.diff(np.sign(y - -ring.base_radius)))
    part = (-ring.base_radius - y[level]) / (y[level + 1] - y[level])
    places = x[level] + part * (x[level + 1] - x[level])
    assert np.abs(places - 0.5 * span.length).min() < 1e-7 or np.abs(np.abs(places) - 0.5 * span.length).min() < 1e-7


HELIX = math.radians(15.0)
HELICAL_PINION = Gear("pinion", 20, 2 * MM, ALPHA, 25 * MM, helix_angle=HELIX, profile_shift=0.3)
HELICAL_RING = Gear("ring", -63, 2 * MM, ALPHA, 25 * MM, helix_angle=HELIX, profile_shift=-0.2, addendum=0.8)


def test_helical_pair_with_shifts_by_lengths_that_are_positive() -> None:
    """The equations of the tables above in transverse terms: no printed example of a helical ring is at hand."""
    pair = GearPairGeometry(HELICAL_PINION, HELICAL_RING)
    transverse = math.atan(math.tan(ALPHA) / math.cos(HELIX))
    module = 2.0 / math.cos(HELIX)
    # Outward shifts are 0.3 and 0.2; the working angle by bisection.
    wanted = inv(transverse) + 2.0 * math.tan(ALPHA) * (0.2 - 0.3) / 43.0
    low, high = 0.0, 1.0
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if inv(middle) < wanted else (low, middle)
    distance = 0.5 * 43.0 * module * math.cos(transverse) / math.cos(low)
    assert pair.working_pressure_angle == pytest.approx(low, rel=1e-10)
    assert -pair.working_centre_distance / MM == pytest.approx(distance, rel=1e-10)
    # Tips: of the pinion 1 + 0.3 modules outside its reference circle, of the ring 0.8 - 0.2 inside its own.
    tips = 0.5 * 20.0 * module + 2.0 * 1.3, 0.5 * 63.0 * module - 2.0 * 0.6
    assert 2.0 * HELICAL_PINION.tip_radius / MM == pytest.approx(2.0 * tips[0], rel=1e-12)
    assert -2.0 * HELICAL_RING.tip_radius / MM == pytest.approx(2.0 * tips[1], rel=1e-12)
    bases = [0.5 * z * module * math.cos(transverse) for z in (20.0, 63.0)]
    first, second = (math.sqrt(tip**2 - base**2) for tip, base in zip(tips, bases, strict=True))
    base_pitch = math.pi * module * math.cos(transverse)
    expected = (first - second + distance * math.sin(low)) / base_pitch
    assert pair.contact_ratio == pytest.approx(expected, rel=1e-9)
    assert pair.overlap_ratio == pytest.approx(25.0 * math.sin(HELIX) / (2.0 * math.pi), rel=1e-12)


@pytest.mark.parametrize("teeth", [-63, -64])
def test_a_ball_between_helical_flanks_touches_both(teeth: int) -> None:
    """The distance from its centre to the helicoid, minimised over the surface, is its radius."""
    ring = replace(HELICAL_RING, teeth=teeth)
    ball = over_balls(ring)
    count, base = abs(teeth), -ring.base_radius / MM
    lead = math.pi * count * 2.0 / math.sin(HELIX)
    transverse = math.atan(math.tan(ALPHA) / math.cos(HELIX))
    # Half the width of a space at the base circle, as an angle: e = pi m / 2 + 2 x m tan(alpha) outward in the normal.
    reference = 0.5 * count * 2.0 / math.cos(HELIX)
    space = 0.5 * math.pi + 2.0 * 0.2 * math.tan(ALPHA)
    half = 0.5 * space * 2.0 / math.cos(HELIX) / reference + inv(transverse)

    def distance(place: FloatArray) -> float:
        roll, z = place
        # The flank of a space closes inwards on the middle: the involute of an external tooth of the same space.
        angle = half - (roll - math.atan(roll)) + 2.0 * math.pi * z / lead
        radius = base * math.hypot(1.0, roll)
        x, y = radius * math.cos(angle), radius * math.sin(angle)
        return math.sqrt((x - centre) ** 2 + y**2 + z**2)

    centre = -ball.centre_radius / MM
    found = minimize(
        distance, [math.tan(transverse), 0.0], method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-12}
    )
    assert found.fun == pytest.approx(0.5 * ball.diameter / MM, rel=1e-8)
    spread = 1.0 if count % 2 == 0 else math.cos(math.pi / (2.0 * count))
    assert ball.length / MM == pytest.approx(2.0 * centre * spread - ball.diameter / MM, rel=1e-12)
