"""The tooth models against their printed forms, half planes in closed form, and each other."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad, simpson

from gearwhine.coupling.gears import (
    CornellStiffness,
    ElasticRingStiffness,
    Gear,
    GearError,
    GearPairGeometry,
    PotentialEnergyStiffness,
    WeberBanaschekStiffness,
    stiffness_model,
)
from gearwhine.coupling.gears.errors import StiffnessModelError
from gearwhine.coupling.gears.geometry.profile import fillet_points, load_angle, tooth_outline
from gearwhine.coupling.gears.stiffness.beam import axis_crossing, beam_compliance, foot_at_height, foot_at_slope
from gearwhine.coupling.gears.stiffness.compliant_teeth import REFERENCE_LINE_LOAD
from gearwhine.coupling.gears.stiffness.hertz import line_contact
from gearwhine.coupling.gears.stiffness.iso6336 import blank_factor, iso6336_stiffness
from gearwhine.coupling.gears.stiffness.tooth_compliance import cornell_state

ALPHA = math.radians(20.0)
RIG = Gear("rig", 28, 3.175e-3, ALPHA, 6.35e-3, root_radius=1.35e-3, bore=40e-3)
WIDE = Gear("wide", 41, 2e-3, ALPHA, 40e-3, profile_shift=0.2)
PAIR = GearPairGeometry(RIG, replace(RIG, name="wheel", teeth=41))
LOADED = [ElasticRingStiffness(), CornellStiffness(), WeberBanaschekStiffness()]


def sampled(gear: Gear, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Height and thickness of the tooth up to the load, from points of the outline."""
    right = tooth_outline(gear, points=4000)[: 2 * 4000 - 1]
    below = np.hypot(*right.T) <= radius
    return right[below, 1], -2.0 * right[below, 0]


@pytest.mark.parametrize("gear", [RIG, WIDE], ids=lambda gear: gear.name)
def test_weber_and_banaschek_in_their_printed_numbers(gear: Gear) -> None:
    # The numbers as later papers print them for nu = 0.3, rounded to two or three digits.
    radius = 0.5 * (gear.pitch_radius + gear.tip_radius)
    height, thickness = sampled(gear, radius)
    beta = float(load_angle(gear, np.array(radius)))
    lever = gear.base_radius / math.cos(beta) - height[0]
    thrust = 1.0 + 0.294 * math.tan(beta) ** 2
    tooth = 10.92 * simpson((lever - height + height[0]) ** 2 / thickness**3, x=height)
    tooth += 3.1 * thrust * simpson(1.0 / thickness, x=height)
    body = 5.2 * (lever / thickness[0]) ** 2 + lever / thickness[0] + 1.4 * thrust
    printed = math.cos(beta) ** 2 / (gear.youngs_modulus * gear.face_width) * np.array([tooth, body])
    found = WeberBanaschekStiffness().tooth(gear, np.array(radius))
    assert float(found.foundation) == pytest.approx(printed[1], rel=0.01)
    assert float(found.bending + found.shear + found.axial) == pytest.approx(printed[0], rel=0.01)


def test_the_edge_of_a_half_plane_turns_by_18_over_pi() -> None:
    # Work of a linear normal traction of unit moment over unit thickness, its displacement being the logarithm's:
    # -2/pi int int p(x) p(s) ln|x - s|, p = 12 x on |x| < 1/2.  The inner integral in closed form.
    def displacement(x: float) -> float:
        near, far = 0.5 - x, 0.5 + x
        moment = sum(math.log(d) * (0.125 - 0.5 * x * x) * side for d, side in ((near, 1.0), (far, -1.0)))
        return -2.0 / math.pi * 12.0 * (moment - 0.5 * x)

    work, _ = quad(lambda x: 12.0 * x * displacement(x), -0.5, 0.5)
    assert work == pytest.approx(18.0 / math.pi, rel=1e-9)


def test_cornell_stands_on_the_fillet_at_75_degrees() -> None:
    foot = foot_at_slope(RIG, math.radians(75.0))
    here, there = (fillet_points(RIG, np.array(foot + step)) for step in (1e-5, -1e-5))
    lean = math.atan2(here.half_thickness - there.half_thickness, there.height - here.height)
    assert math.degrees(lean) == pytest.approx(75.0, abs=1e-3)
    # The bottom of the fillet leans by a right angle less the half angle there; beyond it there is no section.
    assert foot_at_slope(RIG, math.radians(89.9)) == math.pi / 2.0
    assert foot_at_slope(RIG, 0.0) == pytest.approx(RIG.fillet_end, abs=1e-9)


def test_cornells_foundation_in_its_printed_form() -> None:
    radius = np.array([RIG.pitch_radius, RIG.tip_radius])
    section = fillet_points(RIG, np.array(foot_at_slope(RIG, math.radians(75.0))))
    beta = load_angle(RIG, radius)
    ratio = (axis_crossing(RIG, radius) - section.height) / (2.0 * section.half_thickness)
    thrust = 1.534 * (1.0 + np.tan(beta) ** 2 / 3.12)
    scale = np.cos(beta) ** 2 / (207e9 * 6.35e-3)
    narrow = scale * (5.306 * ratio**2 + 1.4 * ratio + thrust)
    wide = scale * 0.91 * (5.306 * ratio**2 + 2.0 * 0.52 / 0.91 * ratio + thrust)
    np.testing.assert_allclose(CornellStiffness().tooth(RIG, radius).foundation, narrow, rtol=1e-4)
    np.testing.assert_allclose(CornellStiffness("plane-strain").tooth(RIG, radius).foundation, wide, rtol=1e-4)
    assert cornell_state(RIG) == "plane-stress"
    assert cornell_state(WIDE) == "plane-strain"


def test_the_ring_takes_the_tooth_from_the_height_of_the_root_circle() -> None:
    foot = foot_at_height(RIG, RIG.root_circle_radius)
    assert float(fillet_points(RIG, np.array(foot)).height) == pytest.approx(RIG.root_circle_radius, rel=1e-12)
    radius = np.array([RIG.pitch_radius])
    tooth, whole = ElasticRingStiffness().tooth(RIG, radius), PotentialEnergyStiffness().tooth(RIG, radius)
    assert 0.9 * whole.shear < tooth.shear < whole.shear
    # Plane strain: bending and compression by 1 - nu^2, shear the same.
    strained = beam_compliance(RIG, radius, state="plane-strain")
    np.testing.assert_allclose(strained.bending, 0.91 * whole.bending, rtol=1e-12)
    np.testing.assert_allclose(strained.axial, 0.91 * whole.axial, rtol=1e-12)
    np.testing.assert_allclose(strained.shear, whole.shear, rtol=1e-12)
    with pytest.raises(GearError, match="'plane-stress' or 'plane-strain', got 'thick'"):
        ElasticRingStiffness("thick").tooth(RIG, radius)  # type: ignore[arg-type]


def test_webers_approach_is_the_integral_of_the_strain_under_a_hertzian_strip() -> None:
    contact = line_contact(PAIR, [0.4])
    force = 1700.0
    strip = float(contact.half_width(force)[0])
    peak = 2.0 * force / (math.pi * strip * contact.width)
    sinking = 0.0
    for depth, nu in zip(contact.depths[:, 0], contact.poisson_ratios, strict=True):

        def strain(z: float, nu: float = nu) -> float:
            root = math.hypot(strip, z)
            across = -((strip**2 + 2.0 * z * z) / (strip * root) - 2.0 * z / strip)
            return -(1.0 - nu**2) / 207e9 * peak * (-strip / root - nu / (1.0 - nu) * across)

        sinking += quad(strain, 0.0, depth, limit=200, epsabs=0.0)[0]
    assert float(contact.approach(force)[0]) == pytest.approx(sinking, rel=(strip / contact.depths.min()) ** 2)


def test_the_contact_stiffens_with_its_load() -> None:
    contact = line_contact(PAIR, np.linspace(0.0, PAIR.contact_ratio, 5))
    forces = np.array([1.0, 100.0, 1700.0])
    approach = np.array([contact.approach(force) for force in forces])
    assert np.all(np.diff(approach, axis=0) > 0.0)
    step = 1e-3
    slope = (contact.approach(1700.0 + step) - contact.approach(1700.0 - step)) / (2.0 * step)
    assert np.all(slope < contact.secant_compliance(1700.0))
    # Hertz: half width as the root of the load; doubled with four times it.
    np.testing.assert_allclose(contact.half_width(400.0), 2.0 * contact.half_width(100.0), rtol=1e-14)
    for force in (0.0, -1.0, math.nan):
        with pytest.raises(GearError, match="force must be above 0"):
            contact.approach(force)
    with pytest.raises(GearError, match="lower the load"):
        contact.approach(1e7)


@pytest.mark.parametrize("model", LOADED, ids=lambda model: type(model).__name__)
def test_the_contact_is_frozen_at_the_models_load(model: CornellStiffness) -> None:
    position = np.linspace(0.0, PAIR.contact_ratio, 7)
    reference = REFERENCE_LINE_LOAD * PAIR.face_width
    default = model.pair_compliance(PAIR, position)
    np.testing.assert_allclose(default, model.pair_compliance(PAIR, position, force=reference), rtol=1e-14)
    loaded = replace(model, force=500.0)
    np.testing.assert_allclose(loaded.pair_compliance(PAIR, position), model.pair_compliance(PAIR, position, 500.0))
    curve = loaded.pair_stiffness(PAIR)
    np.testing.assert_allclose(1.0 / curve(position), loaded.pair_compliance(PAIR, position), rtol=1e-8)
    constant = replace(model, contact="yang-sun")
    np.testing.assert_array_equal(
        constant.pair_compliance(PAIR, position, force=1.0), constant.pair_compliance(PAIR, position, force=1e4)
    )


def test_loads_and_contacts_that_make_no_sense_are_refused() -> None:
    with pytest.raises(StiffnessModelError, match="'cornell': force must be above 0"):
        stiffness_model("cornell", force=0.0)
    with pytest.raises(StiffnessModelError, match="'potential-energy': contact must be"):
        PotentialEnergyStiffness(contact="dry")  # type: ignore[arg-type]


@pytest.mark.parametrize("model", LOADED, ids=lambda model: type(model).__name__)
def test_models_of_the_rigs_gears_are_near_the_norm(model: CornellStiffness) -> None:
    # 15 %, but for Weber's, which is the norm's theory without its C_M = 0.8: the model page.
    pair = GearPairGeometry(RIG, RIG)
    mean = model.pair_stiffness(pair).mean * pair.contact_ratio / pair.face_width
    bar = 0.22 if isinstance(model, WeberBanaschekStiffness) else 0.15
    assert mean == pytest.approx(iso6336_stiffness(pair).mesh_mean, rel=bar)


@pytest.mark.parametrize("teeth", [20, 28, 40, 62, 100])
def test_webers_teeth_are_those_of_the_norms_theory(teeth: int) -> None:
    # c'_th comes from Weber and Banaschek, before C_M = 0.8 brings it to what is measured.  The norm's series in teeth
    # is held to +5 and -8 %.
    gear = Gear("like the norm's", teeth, 3e-3, ALPHA, 15e-3, youngs_modulus=206e9)
    pair = GearPairGeometry(gear, gear)
    single = float(WeberBanaschekStiffness().pair_stiffness(pair)(0.5 * pair.contact_ratio)) / 15e-3
    assert single == pytest.approx(iso6336_stiffness(pair).theoretical * 0.975, rel=0.08)


def test_a_helical_pair_by_the_norm() -> None:
    # The norm's own formula, from its printed constants, for x = 0 and h_fP = 1.25.
    beta = math.radians(15.0)
    gear = Gear("helical", 28, 3e-3, ALPHA, 20e-3, youngs_modulus=206e9, helix_angle=beta)
    pair = GearPairGeometry(gear, replace(gear, helix_angle=-beta))
    base_helix = math.asin(math.sin(beta) * math.cos(ALPHA))
    virtual = 28.0 / (math.cos(base_helix) ** 2 * math.cos(beta))
    theory = 1.0 / (0.04723 + (0.15551 + 0.25791) / virtual)
    values = iso6336_stiffness(pair)
    assert values.theoretical == pytest.approx(1e9 * theory, rel=1e-12)
    assert values.single_pair == pytest.approx(1e9 * theory * 0.8 * 0.975 * math.cos(beta), rel=1e-12)
    assert values.mesh_mean == pytest.approx(values.single_pair * (0.75 * pair.contact_ratio + 0.25), rel=1e-12)


def test_blank_factor_of_the_norm() -> None:
    def blank(web: float, rim: float) -> float:
        return blank_factor(replace(WIDE, web_thickness=web * 40e-3, rim_thickness=rim * 2e-3))

    assert blank(1.0, 2.0) == 1.0
    assert blank(0.3, 4.0) == pytest.approx(1.0 - 1.2039728 / (5.0 * 2.2255409), rel=1e-6)
    assert blank(0.1, 4.0) == blank(0.2, 4.0)
    assert blank(0.3, 0.5) == blank(0.3, 1.0)
    assert blank_factor(WIDE) == blank_factor(replace(WIDE, rim_thickness=5e-3)) == 1.0
    webbed = replace(WIDE, web_thickness=12e-3, rim_thickness=8e-3)
    stiffness = [iso6336_stiffness(GearPairGeometry(WIDE, gear)).single_pair for gear in (WIDE, webbed)]
    assert stiffness[1] / stiffness[0] == pytest.approx(0.5 * (1.0 + blank_factor(webbed)), rel=1e-12)
