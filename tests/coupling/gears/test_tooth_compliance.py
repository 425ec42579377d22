"""Tooth compliance against direct integration over a finely sampled outline, and limits of the body's formula."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad, simpson

from gearwhine.coupling.gears import Gear, GearError, GearPairGeometry, PotentialEnergyStiffness, tooth_contact
from gearwhine.coupling.gears.errors import StiffnessModelError
from gearwhine.coupling.gears.geometry.profile import root_half_angle, tooth_outline
from gearwhine.coupling.gears.stiffness.foundation import foundation_compliance, root_section_angle, within_fitted_range
from gearwhine.coupling.gears.stiffness.hertz import hertz_compliance
from gearwhine.coupling.gears.stiffness.iso6336 import iso6336_stiffness
from gearwhine.coupling.gears.stiffness.models import stiffness_model

ALPHA = math.radians(20.0)
GEARS = [
    Gear("standard", 62, 2e-3, ALPHA, 20e-3, bore=35e-3),
    Gear("nasa", 28, 3.175e-3, ALPHA, 6.35e-3, root_radius=1.35e-3),
    Gear("shifted", 19, 4e-3, math.radians(22.0), 20e-3, profile_shift=0.4, bore=30e-3),
]


@pytest.mark.parametrize("gear", GEARS, ids=lambda gear: gear.name)
@pytest.mark.parametrize("fraction", [0.05, 0.5, 1.0])
def test_energy_integrals_over_the_sampled_outline(gear: Gear, fraction: float) -> None:
    # Sections taken from the outline's points, the load from the involute's tangent length: no curve parameter.
    right = tooth_outline(gear, points=4000)[: 2 * 4000 - 1]
    half, height = -right[:, 0], right[:, 1]
    radius = gear.form_radius + fraction * (gear.tip_radius - gear.form_radius)
    below = np.hypot(half, height) < radius
    y, x = height[below], half[below]
    # Load: normal to the flank, tangent to the base circle.
    tangent = math.sqrt(radius**2 - gear.base_radius**2)
    beta = tangent / gear.base_radius - gear.base_half_angle
    polar = beta - math.atan(tangent / gear.base_radius) + math.pi / 2.0
    load_x, load_y = radius * math.cos(polar), radius * math.sin(polar)
    y, x = np.append(y, load_y), np.append(x, load_x)
    modulus, width = gear.youngs_modulus, gear.face_width
    moment = math.cos(beta) * (load_y - y) - math.sin(beta) * load_x
    bending = simpson(moment**2 / (modulus * width * (2.0 * x) ** 3 / 12.0), x=y)
    area = simpson(1.0 / (2.0 * x * width), x=y)
    shear = 1.2 * math.cos(beta) ** 2 * area * 2.0 * (1.0 + gear.poisson_ratio) / modulus
    axial = math.sin(beta) ** 2 * area / modulus
    tooth = PotentialEnergyStiffness().tooth(gear, np.array(radius))
    assert float(tooth.bending) == pytest.approx(bending, rel=1e-5)
    assert float(tooth.shear) == pytest.approx(shear, rel=1e-6)
    assert float(tooth.axial) == pytest.approx(axial, rel=1e-6)


def test_flank_integral_by_adaptive_quadrature() -> None:
    # The difference between loads sheds the fillet: shear over [form radius, r] in the involute's own roll angle.
    gear = GEARS[0]
    psi, rb = gear.base_half_angle, gear.base_radius
    low, high = gear.roll_angle(gear.form_radius), gear.roll_angle(0.5 * (gear.pitch_radius + gear.tip_radius))

    def inverse_thickness(roll: float) -> float:
        angle = roll - psi
        return roll * math.cos(angle) / (2.0 * (roll * math.cos(angle) - math.sin(angle)))

    flank, _ = quad(inverse_thickness, low, high, epsabs=0.0, epsrel=1e-13)
    radii = rb * np.sqrt(1.0 + np.array([low, high]) ** 2)
    tooth = PotentialEnergyStiffness().tooth(gear, radii)
    per_angle = tooth.axial / np.sin(np.array([low, high]) - psi) ** 2 * gear.youngs_modulus * gear.face_width
    assert per_angle[1] - per_angle[0] == pytest.approx(flank, rel=1e-10)


def test_bending_grows_toward_the_tip_and_arrays_keep_their_shape() -> None:
    gear = GEARS[0]
    radii = np.linspace(gear.form_radius, gear.tip_radius, 12).reshape(3, 4)
    tooth = PotentialEnergyStiffness().tooth(gear, radii)
    assert tooth.total.shape == (3, 4)
    assert np.all(np.diff(tooth.foundation.ravel()) > 0.0)
    assert np.all(np.diff(tooth.bending.ravel()[3:]) > 0.0)
    np.testing.assert_allclose(tooth.total, tooth.bending + tooth.shear + tooth.axial + tooth.foundation, rtol=1e-15)


def test_loads_act_on_the_flank_only() -> None:
    gear = GEARS[0]
    for radius in (gear.root_circle_radius, 1.01 * gear.tip_radius, math.nan):
        with pytest.raises(GearError, match="loads act on the flank"):
            PotentialEnergyStiffness().tooth(gear, np.array([radius]))


def test_hertz_of_two_half_planes() -> None:
    gear = GEARS[0]
    nu = gear.poisson_ratio
    alike = 4.0 * (1.0 - nu**2) / (math.pi * gear.youngs_modulus * gear.face_width)
    assert hertz_compliance(GearPairGeometry(gear, gear)) == pytest.approx(alike, rel=1e-14)
    rigid = replace(gear, youngs_modulus=1e30, face_width=1.0)
    assert hertz_compliance(GearPairGeometry(gear, rigid)) == pytest.approx(0.5 * alike, rel=1e-14)


def test_root_angle_readings() -> None:
    # With the rack's own addendum (the gear's dedendum) in the place of the gear's, Ma's formula is the exact one.
    gear = GEARS[0]
    as_rack = replace(gear, addendum=1.25, root_radius=gear.rack_tip_radius)
    assert root_section_angle(as_rack, "ma2014") == pytest.approx(root_half_angle(gear), rel=1e-13)
    assert root_section_angle(gear, "trochoid") == root_half_angle(gear)
    assert root_section_angle(gear, "ma2014") < root_half_angle(gear)
    with pytest.raises(StiffnessModelError, match="'ma2014' or 'trochoid', got 'other'"):
        root_section_angle(gear, "other")  # type: ignore[arg-type]


def ring_of(ratio: float) -> Gear:
    return replace(GEARS[0], bore=2.0 * GEARS[0].root_circle_radius / ratio)


def test_thin_body_outside_the_fitted_range_is_refused() -> None:
    ring = ring_of(1.39)
    with pytest.raises(StiffnessModelError, match=r"rings of at least 1.4"):
        foundation_compliance(ring, np.array([ring.pitch_radius]))
    assert not within_fitted_range(ring, "trochoid")


@pytest.mark.parametrize("ratio", [10.0, 20.0])
def test_small_bore_in_a_large_wheel_adds_the_twist_of_the_exact_ring(ratio: float) -> None:
    """From h = 7 to a smaller bore the body yields more by its twist, as the exact elastic ring does."""
    pinion = GEARS[0]
    compliance = {}
    for model in ("potential-energy", "elastic-ring"):
        teeth = (
            stiffness_model(model).teeth_compliance(GearPairGeometry(pinion, replace(ring_of(h), name="wheel")))
            for h in (7.0, ratio)
        )
        smallest, ring = (float(each(np.array([0.8]))[0]) for each in teeth)
        compliance[model] = ring - smallest
    assert compliance["potential-energy"] == pytest.approx(compliance["elastic-ring"], rel=0.02)
    radius = np.array([pinion.pitch_radius])
    within, beyond = (foundation_compliance(ring_of(h), radius)[0] for h in (7.0, 7.0 + 1e-6))
    assert beyond == pytest.approx(within, rel=1e-6)  # no jump at the end of the range
    assert not within_fitted_range(ring_of(ratio), "trochoid")


def test_a_rim_alone_is_a_ring_held_at_its_inside() -> None:
    gear = replace(GEARS[0], rim_thickness=20e-3)
    ring = replace(GEARS[0], bore=2.0 * (gear.root_circle_radius - 20e-3))
    radius = np.array([gear.pitch_radius])
    np.testing.assert_allclose(foundation_compliance(gear, radius), foundation_compliance(ring, radius), rtol=1e-12)
    with pytest.raises(StiffnessModelError, match="give a rim its web"):
        foundation_compliance(replace(gear, rim_thickness=5e-3), radius)


def test_fitted_range() -> None:
    assert within_fitted_range(GEARS[0], "ma2014")
    assert within_fitted_range(replace(GEARS[0], bore=0.0), "trochoid")
    assert not within_fitted_range(GEARS[2], "trochoid")  # 19 teeth: too wide a root


@pytest.mark.parametrize("teeth", [28, 40, 62, 90])
def test_a_solid_gear_is_as_soft_as_its_dent(teeth: int) -> None:
    # The dent around a tooth hardly knows the bore: whatever the ring, the compliance less its twist agrees
    # with the solid gear's within the scatter of the published fit (10 %).
    solid = Gear("solid", teeth, 2e-3, ALPHA, 20e-3)
    radius = np.array([solid.pitch_radius])
    dent = float(foundation_compliance(solid, radius, "trochoid")[0])
    shear_modulus = solid.youngs_modulus / (2.0 * (1.0 + solid.poisson_ratio))
    for ratio in (1.5, 2.0, 4.0, 5.0, 7.0):
        ring = replace(solid, bore=2.0 * solid.root_circle_radius / ratio)
        turn = (4.0 / ring.bore**2 - 1.0 / ring.root_circle_radius**2) / (
            4.0 * math.pi * shear_modulus * ring.face_width
        )
        of_ring = float(foundation_compliance(ring, radius, "trochoid")[0])
        assert of_ring - turn * ring.base_radius**2 == pytest.approx(dent, rel=0.1)


@pytest.mark.parametrize("teeth", [28, 40, 62, 90])
def test_a_solid_gear_is_near_the_norm(teeth: int) -> None:
    # ISO 6336-1 and the energy method are independent models of one pair; for solid gears they are 15 % apart at most.
    # The norm's mesh adds pairs as if each had bodies of its own, so that it is the stiffer the more teeth there are.
    gear = Gear("solid", teeth, 2e-3, ALPHA, 20e-3, youngs_modulus=206e9)
    pair = GearPairGeometry(gear, gear)
    contact, norm = tooth_contact(pair, PotentialEnergyStiffness()), iso6336_stiffness(pair)
    single = float(contact.stiffness(0.5 * pair.contact_ratio)) / gear.face_width
    assert single == pytest.approx(norm.single_pair, rel=0.15)
    alone = replace(contact, shared_compliance=0.0).unloaded_mean_mesh_stiffness / gear.face_width
    assert alone == pytest.approx(norm.mesh_mean, rel=0.2)
    assert contact.unloaded_mean_mesh_stiffness < alone * gear.face_width
