"""Geometry of single gears and pairs against printed calculations.

[1] MESYS AG, online calculation of helical gear geometry after ISO 21771, its example (mesys.ag/calc/helicalgear.fcgi):
    z 20, m_n 1 mm, alpha_n 20 deg, x 0, rack addendum 1, dedendum 1.25, tip radius 0.25; balls of 1.7 mm, span over 2.
[2] A spreadsheet of profile shifts after ISO 21771, "Gear generating profile shift calculations" (scribd.com, document
    376176518): z 31 and 30, m_n 3.5 mm, alpha_n 20 deg, alpha_t 21.2990642859 deg (so a helix angle of 21 deg), working
    centre distance 116.5 mm.
[3] Contact ratio of equal full-depth gears of 20 degrees at their standard distance,
    (sqrt((z + 2)^2 - (z cos(alpha))^2) - z sin(alpha)) / (pi cos(alpha)), here in thirty decimal digits.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from decimal import Decimal, localcontext

import pytest

from gearwhine.coupling.gears import Gear, GearPairGeometry
from gearwhine.coupling.gears.geometry.involute import involute
from gearwhine.coupling.gears.geometry.pair import profile_shift_sum
from gearwhine.coupling.gears.geometry.thickness import normal_tooth_thickness, over_balls, span_measurement

Published = Callable[..., None]

FULL_DEPTH = "Full-depth gears of 20 degrees, closed form"
MESYS = "MESYS helical gear geometry (ISO 21771), example"
SHIFTS = "Profile shifts at a centre distance (ISO 21771), spreadsheet"

ALPHA = math.radians(20.0)
EXAMPLE = Gear("example", 20, 1e-3, ALPHA, 10e-3, root_radius=0.25e-3)
BALLS = over_balls(EXAMPLE, 1.7e-3)
SPAN = span_measurement(EXAMPLE, 2)


@pytest.mark.parametrize(
    ("quantity", "printed", "metres"),
    [
        ("reference diameter", 20.0, 2.0 * EXAMPLE.pitch_radius),
        ("base diameter", 18.7939, 2.0 * EXAMPLE.base_radius),
        ("tip diameter", 22.0, 2.0 * EXAMPLE.tip_radius),
        ("root diameter", 17.5, 2.0 * EXAMPLE.root_circle_radius),
        ("root form diameter", 18.8003, 2.0 * EXAMPLE.form_radius),
        ("tooth thickness on the reference circle", 1.5708, normal_tooth_thickness(EXAMPLE, EXAMPLE.pitch_radius)),
        ("tooth thickness on the tip circle", 0.6949, normal_tooth_thickness(EXAMPLE, EXAMPLE.tip_radius)),
        ("dimension over balls of 1.7 mm", 22.2941, BALLS.length),
        ("diameter where the balls touch", 19.9594, 2.0 * BALLS.contact_radius),
        ("span over 2 teeth", 4.7083, SPAN.length),
        ("diameter where the span touches", 19.3746, 2.0 * SPAN.contact_radius),
    ],
)
def test_sizes_of_the_example(quantity: str, printed: float, metres: float, published: Published) -> None:
    published(MESYS, quantity, printed, 1e3 * metres, "mm", abs=0.5e-4)


def test_least_shift_of_the_example(published: Published) -> None:
    published(MESYS, "generating shift at the limit of undercut", -0.0843, EXAMPLE.least_generating_shift, abs=0.5e-4)


def test_shifts_at_a_centre_distance(published: Published) -> None:
    helix = math.radians(21.0)
    pinion = Gear("pinion", 31, 3.5e-3, ALPHA, 30e-3, profile_shift=0.291, helix_angle=helix)
    wheel = Gear("wheel", 30, 3.5e-3, ALPHA, 30e-3, helix_angle=-helix)
    transverse = pinion.transverse_pressure_angle
    published(SHIFTS, "transverse pressure angle", 21.2990642859, math.degrees(transverse), "°", abs=0.5e-10)
    published(SHIFTS, "its involute function", 0.0181260949, involute(transverse), abs=0.5e-10)
    reference = 1e3 * (pinion.pitch_radius + wheel.pitch_radius)
    published(SHIFTS, "reference centre distance", 114.3447280708, reference, "mm", abs=0.5e-10)
    shift = profile_shift_sum(pinion, wheel, 116.5e-3)
    published(SHIFTS, "sum of the profile shifts", 0.6518771312, shift, abs=0.5e-10)
    pair = GearPairGeometry(pinion, replace(wheel, profile_shift=shift - pinion.profile_shift))
    working = math.degrees(pair.working_pressure_angle)
    published(SHIFTS, "working transverse pressure angle", 23.8707609654, working, "°", abs=0.5e-10)
    published(SHIFTS, "working centre distance", 116.5, 1e3 * pair.working_centre_distance, "mm", abs=1e-9)


def contact_ratio_in_decimals(teeth: int) -> Decimal:
    """The closed form [3] with cos(20 deg) from its own cubic, 4 c^3 - 3 c = cos(60 deg)."""
    with localcontext() as context:
        context.prec = 30
        cosine = Decimal("0.94")
        for _ in range(8):
            cosine -= (4 * cosine**3 - 3 * cosine - Decimal("0.5")) / (12 * cosine**2 - 3)
        pi = Decimal("3.14159265358979323846264338328")
        reach = (Decimal(teeth + 2) ** 2 - (teeth * cosine) ** 2).sqrt()
        return (reach - teeth * (1 - cosine**2).sqrt()) / (pi * cosine)


@pytest.mark.parametrize(("teeth", "printed"), [(28, "1.63800"), (62, "1.7897798668")])
def test_contact_ratio_in_thirty_digits(teeth: int, printed: str, published: Published) -> None:
    exact = contact_ratio_in_decimals(teeth)
    assert str(round(exact, len(printed) - 2)) == printed
    gear = Gear("full depth", teeth, 3e-3, ALPHA, 20e-3)
    found = GearPairGeometry(gear, gear).contact_ratio
    published(FULL_DEPTH, f"contact ratio, {teeth} / {teeth} teeth, in decimals", float(exact), found, abs=1e-13)
