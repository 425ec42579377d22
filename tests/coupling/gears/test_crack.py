"""A cracked tooth: the sections that are left, integrated anew on the drawn outline, and what the mesh makes of it."""

import itertools
import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from gearwhine.coupling.gears import (
    Gear,
    GearError,
    GearPairGeometry,
    PotentialEnergyStiffness,
    ToothCrack,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears.geometry.profile import load_angle, tooth_outline

GEAR = Gear("cracked", 30, 3e-3, math.radians(20.0), 15e-3)
ROLLS = np.linspace(GEAR.roll_angle(GEAR.form_radius), GEAR.roll_angle(GEAR.tip_radius), 7)


def of_sections_left(gear: Gear, crack: ToothCrack, radii: Iterable[float]) -> list[float]:
    """Additional compliance of the tooth of a spur gear [m/N], integrated over the sections of its drawn outline."""
    points = 20000
    across, along = tooth_outline(gear, points)[: 2 * points - 1].T
    half = -across
    left = half[0] - crack.depth * math.sin(crack.angle)
    modulus, shear = gear.youngs_modulus * gear.face_width, gear.youngs_modulus / 2.6 * gear.face_width
    found = []
    for radius in radii:
        beta = float(load_angle(gear, np.array(radius)))
        height = float(np.interp(radius, np.hypot(across, along), along))
        lever = float(np.interp(height, along, half))
        below = along <= height
        y, x = along[below], half[below]
        kept = np.minimum(2.0 * x, x + left + max(0.0, half[-1] - left) * (y - along[0]) / (along[-1] - along[0]))
        moment = math.cos(beta) * (height - y) - math.sin(beta) * lever
        more = 12.0 * moment**2 / modulus * (kept**-3 - (2.0 * x) ** -3)
        more += (1.2 * math.cos(beta) ** 2 / shear + math.sin(beta) ** 2 / modulus) * (1.0 / kept - 0.5 / x)
        found.append(float(np.trapezoid(more, y)))
    return found


@pytest.mark.parametrize("depth", [0.4e-3, 1.5e-3, 3.5e-3])
def test_extra_compliance_is_that_of_the_sections_left(depth: float) -> None:
    crack = ToothCrack(2, depth, math.radians(60.0))
    expected = of_sections_left(GEAR, crack, GEAR.base_radius * np.hypot(1.0, ROLLS))
    assert crack.extra_compliance(GEAR, ROLLS) == pytest.approx(expected, rel=2e-4, abs=1e-14)


@pytest.mark.parametrize(("teeth", "normal"), [(30, 32), (22, 30), (17, 30)])
def test_a_helical_tooth_is_cracked_in_its_normal_section(teeth: int, normal: int) -> None:
    """Teeth of z_n = z / (cos² β_b cos β), 1 / cos β_b softer along the transverse line of action."""

    def missing(beta: float) -> float:
        return teeth / (1.0 - (math.sin(beta) * math.cos(math.radians(20.0))) ** 2) / math.cos(beta) - normal

    beta = float(brentq(missing, 0.01, 1.0))
    gear, spur = replace(GEAR, teeth=teeth, helix_angle=beta), replace(GEAR, teeth=normal, allow_undercut=True)
    shares = np.array([0.2, 0.5, 0.9])
    rolls, spur_rolls = (
        one.roll_angle(one.form_radius) * (1.0 - shares) + one.roll_angle(one.tip_radius) * shares
        for one in (gear, spur)
    )
    crack = ToothCrack(0, 2e-3)
    cosine = math.cos(math.asin(math.sin(beta) * math.cos(math.radians(20.0))))
    expected = np.array(of_sections_left(spur, crack, spur.base_radius * np.hypot(1.0, spur_rolls))) / cosine
    np.testing.assert_allclose(crack.extra_compliance(gear, rolls), expected, rtol=3e-4)


def test_no_crack_no_difference_and_deeper_is_softer() -> None:
    np.testing.assert_array_equal(ToothCrack(0, 0.0).extra_compliance(GEAR, ROLLS), 0.0)
    depths = [ToothCrack(0, depth).extra_compliance(GEAR, ROLLS) for depth in (0.5e-3, 1e-3, 2e-3, 4e-3)]
    for shallow, deep in itertools.pairwise(depths):
        assert np.all(deep > shallow)


def test_the_mesh_is_softer_while_the_cracked_tooth_carries() -> None:
    sound = GearPairGeometry(GEAR, replace(GEAR, name="sound"))
    cracked = replace(sound, driver=replace(GEAR, faults=(ToothCrack(4, 2e-3),)))
    phases = np.arange(0.0, 30.0, 0.02)
    before, after = (
        loaded_transmission_error(tooth_contact(pair, PotentialEnergyStiffness(), corner_contact=True), 3000.0, phases)
        for pair in (sound, cracked)
    )
    lag = after.transmission_error - before.transmission_error
    assert np.all(lag > -1e-15)
    assert lag.max() > 0.02 * before.mean_transmission_error
    assert set(np.floor(phases[lag > 1e-12]).tolist()) <= {3.0, 4.0, 5.0}


def test_a_crack_through_the_foot_is_refused() -> None:
    with pytest.raises(GearError, match=r"expected at most .* it goes through the foot"):
        ToothCrack(0, 8e-3).extra_compliance(GEAR, ROLLS)
    with pytest.raises(GearError, match="angle must be above 0"):
        ToothCrack(0, 1e-3, 0.0)


@pytest.mark.parametrize("depth", [4.5e-3, 5.5e-3, 6.5e-3])
def test_a_crack_beyond_the_axis_leaves_a_section_that_carries(depth: float) -> None:
    """At most as soft as a cantilever of the thinnest section that is left, bent over the height of the load.

    A line along the axis would leave nothing of the tooth's upper part, and the compliance would have a pole there.
    """
    across, along = tooth_outline(GEAR, 400)[: 2 * 400 - 1].T
    half, up = -across, (along - along[0]) / (along[-1] - along[0])
    left = half[0] - depth * math.sin(math.radians(70.0))
    thinnest = float(np.min(half + left + (half[-1] - left) * up))
    modulus, shear = GEAR.youngs_modulus * GEAR.face_width, GEAR.youngs_modulus / 2.6 * GEAR.face_width
    heights = np.interp(GEAR.base_radius * np.hypot(1.0, ROLLS), np.hypot(across, along), along) - along[0]
    most = 4.0 * heights**3 / (modulus * thinnest**3) + (1.2 / shear + 1.0 / modulus) * heights / thinnest
    found = ToothCrack(0, depth).extra_compliance(GEAR, ROLLS)
    shallower = ToothCrack(0, depth - 1e-4).extra_compliance(GEAR, ROLLS)
    assert np.all(found < most)
    assert np.all((shallower < found) & (found < 1.5 * shallower))
    assert np.all(np.diff(found) > 0.0)


@pytest.mark.parametrize("gear", [GEAR, replace(GEAR, teeth=12, allow_undercut=True), replace(GEAR, teeth=90)])
def test_the_deepest_crack_leaves_a_tenth_of_the_thinnest_section(gear: Gear) -> None:
    across, along = tooth_outline(gear, 400)[: 2 * 400 - 1].T
    half, up = -across, (along - along[0]) / (along[-1] - along[0])
    rolls = np.linspace(gear.roll_angle(gear.form_radius), gear.roll_angle(gear.tip_radius), 5)
    with pytest.raises(GearError, match="at most") as refused:
        ToothCrack(0, 1.0).extra_compliance(gear, rolls)
    deepest = 1e-3 * float(str(refused.value).split("at most ")[1].split()[0])
    left = half[0] - deepest * math.sin(math.radians(70.0))
    kept = half + left + np.maximum(0.0, half[-1] - left) * up
    assert np.min(kept / (2.0 * half)) == pytest.approx(0.1, abs=2e-3)
    assert np.all(np.isfinite(ToothCrack(0, 0.999 * deepest).extra_compliance(gear, rolls)))


@pytest.mark.parametrize("gear", [GEAR, replace(GEAR, helix_angle=math.radians(20.0))])
def test_a_crack_beyond_half_the_foot_is_doubted_and_one_through_it_refused(gear: Gear) -> None:
    """Half of the foot, along the crack's angle, as the outline of the tooth in its normal section has it."""
    normal = replace(gear, helix_angle=0.0, teeth=math.floor(gear.virtual_teeth + 1e-9))
    across, _ = tooth_outline(normal, 400)[: 2 * 400 - 1].T
    half = -across[0] / math.sin(math.radians(70.0))

    def found(depth: float) -> list[tuple[str, str]]:
        cracked = replace(gear, faults=(ToothCrack(0, depth),))
        return [(one.attribute, one.severity) for one in cracked.findings if one.attribute.startswith("faults")]

    assert found(0.98 * half) == []
    assert found(1.02 * half) == [("faults.0.depth", "warning")]
    with pytest.raises(GearError, match=r"gear 'cracked': faults\[0\].depth is .*: it goes through the foot"):
        found(2.1 * half)
