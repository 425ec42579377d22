"""Geometry of single gears and pairs against printed calculations.

[1] MESYS AG, online calculation of helical gear geometry after ISO 21771, its example (mesys.ag/calc/helicalgear.fcgi):
    z 20, m_n 1 mm, alpha_n 20 deg, x 0, rack addendum 1, dedendum 1.25, tip radius 0.25; balls of 1.7 mm, span over 2.
    The same after Ondrives' settings (mesys.ch/calc/ondrives.fcgi): z 30, m_n 1 mm, rack tip radius 0.2, the teeth
    thinned by 0.06 and by 0.03 mm, balls of 1.7 mm.
[2] A spreadsheet of profile shifts after ISO 21771, "Gear generating profile shift calculations" (scribd.com, document
    376176518): z 31 and 30, m_n 3.5 mm, alpha_n 20 deg, alpha_t 21.2990642859 deg (so a helix angle of 21 deg), working
    centre distance 116.5 mm.
[3] Contact ratio of equal full-depth gears of 20 degrees at their standard distance,
    (sqrt((z + 2)^2 - (z cos(alpha))^2) - z sin(alpha)) / (pi cos(alpha)), here in thirty decimal digits.
[4] D. Bolsover, help of "Utilities for Alibre" (bolsover.com/utilitiesforalibre): calculated pairs with profile shift,
    after tables of KHK's gear technical reference: external spur 12 / 24, helical 12 / 60, helical internal 16 / 24, of
    module 3 mm and 20 degrees.
[5] The pair 19 / 104 of module 4 mm that din3990 (github.com/hanslhansl/din3990, tests/test_1.py) prints after DIN ISO
    21771, rack of DIN 867.
[6] ISO/TR 6336-30:2022, example 1, as the tests of gearcore quote it: module 8 mm, helix angle 15.8 degrees, centre
    distance 500 mm, x_2 = 0, from which it calculates x_1 = 0.145 22. Its teeth, 17 / 103, are quoted elsewhere
    (test_gear_tables.py).
[7] SDP/SI, Elements of Metric Gear Technology, tables 10-1, 10-3 and 10-4: normal tooth thicknesses of a spur gear, of
    a helical one with a profile shift by the normal system, and of one by the transverse system.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from decimal import Decimal, localcontext
from typing import NamedTuple

import pytest

from gearwhine.coupling.gears import Gear, GearPairGeometry
from gearwhine.coupling.gears.errors import InterferenceError
from gearwhine.coupling.gears.geometry.involute import involute
from gearwhine.coupling.gears.geometry.pair import profile_shift_sum
from gearwhine.coupling.gears.geometry.thickness import normal_tooth_thickness, over_balls, span_measurement

Published = Callable[..., None]

FULL_DEPTH = "Full-depth gears of 20 degrees, closed form"
MESYS = "MESYS helical gear geometry (ISO 21771), example"
BOLSOVER = "Bolsover, Utilities for Alibre, pairs with profile shift"
DIN_21771 = "din3990 (DIN ISO 21771), external pair 19 / 104"
SDP_SI = "SDP/SI, Elements of Metric Gear Technology, section 10"
TR_6336_30 = "ISO/TR 6336-30, example 1"
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


@pytest.mark.parametrize(
    ("thinning", "root", "form", "at_tip", "shift", "centre", "over", "touching"),
    [
        (60e-6, 27.3352, 28.3762, 0.6734, -0.0824, 16.0821, 32.1641, 29.8612),
        (30e-6, 27.4176, 28.4047, 0.7054, -0.0412, 16.1190, 32.2380, 29.9256),
    ],
)
def test_thinned_teeth(
    thinning: float,
    root: float,
    form: float,
    at_tip: float,
    shift: float,
    centre: float,
    over: float,
    touching: float,
    published: Published,
) -> None:
    gear = Gear("thinned", 30, 1e-3, ALPHA, 20e-3, root_radius=0.2e-3, tooth_thinning=thinning)
    balls = over_balls(gear, 1.7e-3)
    for quantity, value, ours in (
        ("root diameter", root, 2e3 * gear.root_circle_radius),
        ("root form diameter", form, 2e3 * gear.form_radius),
        ("tooth thickness on the tip circle", at_tip, 1e3 * normal_tooth_thickness(gear, gear.tip_radius)),
        ("generating shift", shift, gear.generating_shift),
        ("radius to the far side of a ball", centre, 1e3 * balls.centre_radius + 0.85),
        ("dimension over balls", over, 1e3 * balls.length),
        ("diameter where the balls touch", touching, 2e3 * balls.contact_radius),
    ):
        unit = "" if quantity == "generating shift" else "mm"
        published(MESYS, f"{quantity}, z 30 thinned by {1e6 * thinning:.0f} µm", value, ours, unit, abs=0.51e-4)
    if thinning == 60e-6:
        published(
            MESYS, "generating shift at the limit of undercut, z 30", -0.6363, gear.least_generating_shift, abs=0.5e-4
        )


TRANSVERSE_HELIX = math.radians(22.5)


@pytest.mark.parametrize(
    ("table", "module", "angle", "teeth", "shift", "helix", "printed"),
    [
        ("10-1, spur", 10e-3, ALPHA, 12, 0.3, 0.0, 17.8918),
        ("10-3, normal system", 5e-3, ALPHA, 16, 0.2, math.radians(25.0), 8.5819),
        (
            *("10-4, transverse system", 4e-3 * math.cos(TRANSVERSE_HELIX)),
            math.atan(math.tan(ALPHA) * math.cos(TRANSVERSE_HELIX)),
            *(20, 0.3 / math.cos(TRANSVERSE_HELIX), TRANSVERSE_HELIX, 6.6119),
        ),
    ],
)
def test_tooth_thickness(
    table: str,
    module: float,
    angle: float,
    teeth: int,
    shift: float,
    helix: float,
    printed: float,
    published: Published,
) -> None:
    gear = Gear("thick", teeth, module, angle, 60e-3, profile_shift=shift, helix_angle=helix, allow_undercut=True)
    found = 1e3 * normal_tooth_thickness(gear, gear.pitch_radius)
    published(SDP_SI, f"normal tooth thickness, table {table}", printed, found, "mm", abs=0.51e-4)


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


class ShiftedPair(NamedTuple):
    """A printed pair: what was given, and circles of both gears, distance [mm], angle [degrees] and contact ratio."""

    source: str
    name: str
    module: float
    teeth: tuple[int, int]
    shifts: tuple[float, float]
    addendum: float
    helix: float
    circles: dict[str, tuple[float, float]]
    distance: float
    working_angle: float
    angle_tolerance: float
    contact_ratio: float
    last_digit: float

    @property
    def gears(self) -> list[Gear]:
        return [
            Gear(name, z, self.module, ALPHA, 20e-3, x, self.addendum, helix_angle=helix, allow_undercut=True)
            for name, z, x, helix in zip(
                ("pinion", "wheel"), self.teeth, self.shifts, (self.helix, -self.helix), strict=True
            )
        ]


# Addenda are shortened by what the sum of the shifts exceeds the centre distance increment factor.
SPUR = ShiftedPair(
    *(BOLSOVER, "external spur", 3e-3, (12, 24), (0.6, 0.36), 1.0 + 2.5 / 3.0 - 0.96, 0.0),
    {
        "reference": (36.0, 72.0),
        "base": (33.8289, 67.6579),
        "working": (37.667, 75.333),
        "tip": (44.840, 79.400),
        "root": (32.100, 66.660),
    },
    # The angle is printed for 56.5 mm; the shifts, rounded from 0.9601 to 0.96, make 56.49987 mm.
    *(56.5, 26.0888, 3e-4, 1.202, 1e-3),
)
HELICAL = ShiftedPair(
    *(BOLSOVER, "external helical", 3e-3, (12, 60), (0.09809, 0.0), 1.0 + 0.09744 - 0.09809, math.radians(30.0)),
    {
        "reference": (41.569, 207.846),
        "base": (38.322, 191.611),
        "working": (41.667, 208.333),
        "tip": (48.154, 213.842),
        "root": (34.658, 200.346),
    },
    *(125.0, 23.1126, 0.5e-4, 1.294, 1e-3),
)
TEETH_19_104 = ShiftedPair(
    *(DIN_21771, "19 / 104", 4e-3, (19, 104), (0.5, 0.15), 1.0, 0.0),
    {
        "reference": (76.0, 416.0),
        "base": (71.41663917972905, 390.9121302469379),
        "working": (76.77447193086583, 420.23921477947613),
        "tip": (88.0, 425.2),
        "root": (70.0, 407.2),
    },
    *(248.506843355171, 21.531902292465457, 1e-10, 1.5363235945832296, 1e-9),
)


@pytest.mark.parametrize("printed", [SPUR, HELICAL, TEETH_19_104], ids=lambda pair: pair.name)
def test_pair_with_profile_shift(printed: ShiftedPair, published: Published) -> None:
    gears = printed.gears
    pair = GearPairGeometry(gears[0], gears[1])
    source, half = printed.source, 0.5 * printed.last_digit
    for gear, working, place in zip(gears, pair.working_pitch_radii, (0, 1), strict=True):
        radii = {
            "reference": gear.pitch_radius,
            "base": gear.base_radius,
            "working": working,
            "tip": gear.tip_radius,
            "root": gear.root_circle_radius,
        }
        for circle, diameters in printed.circles.items():
            quantity = f"{circle} diameter of the {gear.name}, {printed.name}"
            published(source, quantity, diameters[place], 2e3 * radii[circle], "mm", abs=half)
    for quantity, value, ours, unit, tolerance in (
        ("working centre distance", printed.distance, 1e3 * pair.working_centre_distance, "mm", half),
        (
            "working angle",
            printed.working_angle,
            math.degrees(pair.working_pressure_angle),
            "°",
            printed.angle_tolerance,
        ),
        ("transverse contact ratio", printed.contact_ratio, pair.contact_ratio, "", half),
    ):
        published(source, f"{quantity}, {printed.name}", value, ours, unit, abs=tolerance)


def test_overlap_of_the_helical_pair(published: Published) -> None:
    pinion, wheel = HELICAL.gears
    published(
        BOLSOVER, "overlap ratio, external helical", 1.061, GearPairGeometry(pinion, wheel).overlap_ratio, abs=0.5e-3
    )
    shift = profile_shift_sum(pinion, wheel, 125e-3)
    published(BOLSOVER, "sum of the profile shifts, external helical", 0.09809, shift, abs=0.5e-5)


def test_helical_internal_pair(published: Published, remark: Callable[[str, str], None]) -> None:
    remark(
        BOLSOVER,
        "The internal pair's shift at 14 mm is 0.0492 by its own involute functions, 0.026893 and 0.022414; printed is "
        "0.04263. Its ring's tip, 77.394 mm, meets the pinion inside the base circle, so that the contact ratio, "
        "1.735, counts teeth that do not touch: such a ring is refused, and is shorter here.",
    )
    helix = math.radians(30.0)
    pinion = Gear("pinion", 16, 3e-3, ALPHA, 20e-3, helix_angle=helix, root_radius=0.15e-3, allow_undercut=True)
    ring = Gear("ring", -24, 3e-3, ALPHA, 20e-3, helix_angle=helix, addendum=0.7)
    shift = profile_shift_sum(pinion, ring, -14e-3)
    by_its_involutes = (0.026893 - 0.022414) * 8.0 / (2.0 * math.tan(ALPHA))
    published(BOLSOVER, "profile shift by its involutes, internal", by_its_involutes, -shift, abs=2e-5)
    ring = replace(ring, profile_shift=shift)
    pair = GearPairGeometry(pinion, ring)
    published(
        BOLSOVER, "working pressure angle, internal", 24.156, math.degrees(pair.working_pressure_angle), "°", abs=1e-3
    )
    reference = 1e3 * abs(pinion.pitch_radius + ring.pitch_radius)
    published(BOLSOVER, "reference centre distance, internal", 13.8564, reference, "mm", abs=0.5e-4)
    for what, printed, radii in (
        ("reference diameter", (55.426, 83.138), (pinion.pitch_radius, ring.pitch_radius)),
        ("base diameter", (51.096, 76.645), (pinion.base_radius, ring.base_radius)),
        ("working pitch diameter", (56.0, 84.0), pair.working_pitch_radii),
    ):
        for name, value, radius in zip(("pinion", "ring"), printed, radii, strict=True):
            published(BOLSOVER, f"{what} of the {name}, internal", value, 2e3 * abs(radius), "mm", abs=0.6e-3)
    # As long as the table has it, the ring's tip is not in the line of action at all.
    reach = math.sqrt((77.394 / 2.0) ** 2 - (1e3 * ring.base_radius) ** 2)
    assert reach < 14.0 * math.sin(pair.working_pressure_angle)
    with pytest.raises(InterferenceError, match="inside the base circle"):
        GearPairGeometry(pinion, replace(ring, addendum=0.7 + (2e3 * -ring.tip_radius - 77.394) / 6.0))


def test_shift_of_example_1_of_iso_tr_6336_30(published: Published) -> None:
    helix = math.radians(15.8)
    pinion = Gear("pinion", 17, 8e-3, ALPHA, 0.1, helix_angle=-helix)
    shift = profile_shift_sum(pinion, Gear("wheel", 103, 8e-3, ALPHA, 0.1, helix_angle=helix), 0.5)
    published(TR_6336_30, "profile shift of the pinion at 500 mm", 0.14522, shift, abs=0.5e-5)


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
