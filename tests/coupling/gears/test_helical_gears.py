"""Helical gears: the plane that everything turns in, the helix, and the body that carries the teeth."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.coupling.gears import Gear, GearError, GearPairGeometry
from gearwhine.coupling.gears.errors import MismatchedGearsError
from gearwhine.coupling.gears.geometry.involute import module_from_base_radius, module_from_diametral_pitch
from gearwhine.coupling.gears.geometry.profile import tooth_outline

ALPHA, BETA = math.radians(20.0), math.radians(24.0)
GEAR = Gear("pinion", 19, 3e-3, ALPHA, 30e-3, profile_shift=0.2, helix_angle=BETA, density=7800.0)
WHEEL = Gear("wheel", 47, 3e-3, ALPHA, 28e-3, profile_shift=-0.1, helix_angle=-BETA)


def test_the_transverse_plane() -> None:
    assert GEAR.transverse_module == pytest.approx(3e-3 / math.cos(BETA), rel=1e-14)
    assert math.tan(GEAR.transverse_pressure_angle) == pytest.approx(math.tan(ALPHA) / math.cos(BETA), rel=1e-14)
    assert GEAR.base_radius == pytest.approx(9.5 * GEAR.transverse_module * math.cos(GEAR.transverse_pressure_angle))
    assert GEAR.tip_radius - GEAR.pitch_radius == pytest.approx(1.2 * 3e-3, rel=1e-12)
    assert GEAR.pitch_radius - GEAR.root_circle_radius == pytest.approx(1.05 * 3e-3, rel=1e-12)


def test_the_helix_by_its_development() -> None:
    # Unrolled, a tooth on any cylinder advances by one lead while it goes once round.
    for radius, angle in (
        (GEAR.pitch_radius, GEAR.helix_angle),
        (GEAR.base_radius, GEAR.base_helix_angle),
        (GEAR.tip_radius, GEAR.helix_angle_at(GEAR.tip_radius)),
    ):
        assert 2.0 * math.pi * radius / math.tan(angle) == pytest.approx(GEAR.lead, rel=1e-12)
    assert GEAR.lead == pytest.approx(19 * GEAR.axial_pitch, rel=1e-14)
    # The normal base pitch is the rack's, whatever the helix.
    normal = GEAR.base_pitch * math.cos(GEAR.base_helix_angle)
    assert normal == pytest.approx(math.pi * 3e-3 * math.cos(ALPHA), rel=1e-12)
    left = replace(GEAR, helix_angle=-BETA)
    assert (left.lead, left.base_helix_angle) == (-GEAR.lead, -GEAR.base_helix_angle)
    assert (left.base_radius, left.form_radius) == (GEAR.base_radius, GEAR.form_radius)


def test_equivalent_teeth() -> None:
    # By Niemann's other form of the base helix angle: cos(beta_b) = sin(alpha_n) / sin(alpha_t).
    cosine = math.sin(ALPHA) / math.sin(GEAR.transverse_pressure_angle)
    assert GEAR.virtual_teeth == pytest.approx(19 / (cosine**2 * math.cos(BETA)), rel=1e-12)


def test_no_helix_is_a_spur_gear_exactly() -> None:
    spur, hardly = replace(GEAR, helix_angle=0.0), replace(GEAR, helix_angle=1e-7)
    assert spur.transverse_module == spur.module
    assert spur.transverse_pressure_angle == spur.pressure_angle
    assert spur.base_helix_angle == 0.0
    assert spur.virtual_teeth == 19
    assert spur.axial_pitch == math.inf
    np.testing.assert_allclose(tooth_outline(hardly), tooth_outline(spur), rtol=0.0, atol=1e-15)


def test_undercut_comes_later_with_a_helix() -> None:
    # The textbook limit of a standard rack: z_n sin^2(alpha_n) = 2 roughly; exactly, 2 cos(beta) / sin^2(alpha_t).
    limit = 2.0 * math.cos(BETA) / math.sin(GEAR.transverse_pressure_angle) ** 2
    assert limit < 17.0
    Gear("least", math.ceil(limit), 3e-3, ALPHA, 30e-3, helix_angle=BETA)
    with pytest.raises(GearError, match="undercut"):
        Gear("fewer", math.floor(limit), 3e-3, ALPHA, 30e-3, helix_angle=BETA)


def test_sizes_from_base_radius_and_from_diametral_pitch() -> None:
    assert module_from_base_radius(GEAR.base_radius, 19, ALPHA, BETA) == pytest.approx(3e-3, rel=1e-14)
    assert module_from_diametral_pitch(8 / 0.0254) == pytest.approx(3.175e-3, rel=1e-14)
    with pytest.raises(GearError, match="diametral_pitch must be above 0"):
        module_from_diametral_pitch(0.0)


def test_contact_ratios_of_a_helical_pair() -> None:
    pair = GearPairGeometry(GEAR, WHEEL)
    # Closed form with diameters alone, as printed in ISO 21771.
    tips = [math.sqrt(gear.tip_radius**2 - gear.base_radius**2) for gear in (GEAR, WHEEL)]
    distance = pair.working_centre_distance
    base = GEAR.base_radius + WHEEL.base_radius
    pitch = math.pi * GEAR.transverse_module * math.cos(GEAR.transverse_pressure_angle)
    assert pair.contact_ratio == pytest.approx((sum(tips) - math.sqrt(distance**2 - base**2)) / pitch, rel=1e-12)
    # The overlap: over the common face a tooth turns by b / lead of a turn, as part of a tooth's pitch.
    assert pair.overlap_ratio == pytest.approx(28e-3 / GEAR.lead * 19, rel=1e-12)
    assert pair.total_contact_ratio == pair.contact_ratio + pair.overlap_ratio
    assert math.tan(pair.working_helix_angle) == pytest.approx(
        2.0 * math.pi * pair.working_pitch_radii[0] / GEAR.lead, rel=1e-12
    )


@pytest.mark.parametrize("helix", [BETA, 0.0, -BETA - 0.01])
def test_helices_that_do_not_match(helix: float) -> None:
    with pytest.raises(MismatchedGearsError, match="opposite hands, got \\+24 and"):
        GearPairGeometry(GEAR, replace(WHEEL, helix_angle=helix))


def test_a_rim_and_a_web_weigh_what_their_rings_weigh() -> None:
    gear = replace(GEAR, teeth=60, bore=40e-3, rim_thickness=8e-3, web_thickness=10e-3)
    inside = gear.root_circle_radius - 8e-3
    # By quadrature over the radius rather than by closed form.
    nodes, weights = np.polynomial.legendre.leggauss(8)
    mass = polar = 0.0
    for low, high, width in ((20e-3, inside, 10e-3), (inside, gear.pitch_radius, 30e-3)):
        radius = 0.5 * (low + high) + 0.5 * (high - low) * nodes
        ring = 7800.0 * width * math.pi * (high - low) * weights * radius
        mass, polar = mass + ring.sum(), polar + (ring * radius**2).sum()
    assert gear.mass == pytest.approx(mass, rel=1e-12)
    assert gear.polar_inertia == pytest.approx(polar, rel=1e-12)
    web = 7800.0 * 10e-3 * math.pi * (inside**2 - 20e-3**2)
    along = (web * 10e-3**2 + (mass - web) * 30e-3**2) / 12.0
    assert gear.diametral_inertia == pytest.approx(0.5 * polar + along, rel=1e-12)
    assert replace(gear, web_thickness=None).mass == pytest.approx(mass - web, rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"helix_angle": 1.1}, "helix_angle is 1.1; expected .* rad"),
        ({"helix_angle": math.nan}, "helix_angle is nan; expected a finite number"),
        ({"rim_thickness": 0.0}, "rim_thickness is 0; expected a finite number above 0"),
        ({"bore": 20e-3, "rim_thickness": GEAR.root_circle_radius - 9.9e-3}, "expected room between rim and bore"),
        ({"web_thickness": 10e-3}, "web_thickness is 0.01; expected no web, or a rim around it"),
        ({"rim_thickness": 5e-3, "web_thickness": 31e-3}, "at most the face width"),
        ({"tooth_thinning": -1e-6}, "tooth_thinning is -1e-06; expected a finite number of at least 0"),
        ({"teeth": 5, "profile_shift": -0.9, "allow_undercut": True}, "cuts the teeth off at their feet"),
    ],
)
def test_impossible_helical_gears(changes: dict[str, object], words: str) -> None:
    with pytest.raises(GearError, match=words):
        replace(GEAR, **changes)
