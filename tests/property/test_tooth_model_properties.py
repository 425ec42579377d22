"""What every tooth model owes to any gear that can be cut: numbers, signs, symmetry and the scaling laws."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gearwhine.coupling.gears import (
    CornellStiffness,
    ElasticRingStiffness,
    Gear,
    GearError,
    GearPairGeometry,
    PotentialEnergyStiffness,
    WeberBanaschekStiffness,
)
from gearwhine.coupling.gears.stiffness.compliant_teeth import CompliantTeeth
from gearwhine.coupling.gears.stiffness.foundation import within_fitted_range

MODELS: list[CompliantTeeth] = [
    PotentialEnergyStiffness("trochoid"),
    PotentialEnergyStiffness(contact="weber"),
    ElasticRingStiffness(),
    ElasticRingStiffness("plane-strain"),
    CornellStiffness("plane-stress"),
    CornellStiffness("plane-strain"),
    WeberBanaschekStiffness(),
]
named = pytest.mark.parametrize("model", MODELS, ids=lambda model: repr(model).replace(" ", ""))
patient = settings(deadline=None, max_examples=20)


@st.composite
def gears(draw: st.DrawFn) -> Gear:
    """Few teeth and many, shifted, stubbed, undercut, helical, bored thin, with rims on webs."""
    try:
        gear = Gear(
            name="drawn",
            teeth=draw(st.integers(8, 200)),
            module=draw(st.floats(0.5e-3, 20e-3)),
            pressure_angle=math.radians(draw(st.floats(14.5, 25.0))),
            face_width=draw(st.floats(5e-3, 100e-3)),
            profile_shift=draw(st.floats(-0.3, 0.8)),
            addendum=draw(st.floats(0.8, 1.1)),
            helix_angle=math.radians(draw(st.sampled_from([0.0, 0.0, 10.0, -25.0]))),
            poisson_ratio=draw(st.floats(0.0, 0.45)),
            youngs_modulus=draw(st.floats(2e9, 400e9)),
            allow_undercut=True,
        )
        if draw(st.booleans()):
            gear = replace(gear, bore=2.0 * gear.root_circle_radius / draw(st.floats(1.45, 6.9)))
            if draw(st.booleans()):
                body = gear.root_circle_radius - 0.5 * gear.bore
                web = draw(st.floats(0.1, 1.0)) * gear.face_width
                gear = replace(gear, rim_thickness=draw(st.floats(0.1, 0.9)) * body, web_thickness=web)
    except GearError:
        assume(False)
    return gear


@named
@patient
@given(gear=gears())
def test_any_tooth_yields_a_finite_amount_in_every_part(model: CompliantTeeth, gear: Gear) -> None:
    radius = np.linspace(gear.form_radius, gear.tip_radius, 9)
    tooth = model.tooth(gear, radius)
    for part in (tooth.bending, tooth.shear, tooth.axial, tooth.rim):
        assert np.all(np.isfinite(part))
        assert np.all(part >= -1e-12 * tooth.total)
    assert np.all(np.isfinite(tooth.total))
    # Sainsot's polynomials are a fit: positive where they were fitted.
    if not isinstance(model, PotentialEnergyStiffness) or within_fitted_range(gear, model.root_section):
        assert np.all(tooth.foundation > 0.0)
        assert np.all(tooth.total > 0.0)


@named
@patient
@given(gear=gears(), size=st.floats(0.1, 10.0), width=st.floats(0.3, 3.0))
def test_teeth_know_no_size_and_share_a_load_over_their_width(
    model: CompliantTeeth, gear: Gear, size: float, width: float
) -> None:
    rim = None if gear.rim_thickness is None else size * gear.rim_thickness
    web = None if gear.web_thickness is None else width * gear.web_thickness
    # The rim goes first out and last in: between, it would not fit the body.
    scaled = replace(gear, rim_thickness=None, web_thickness=None, module=size * gear.module, bore=size * gear.bore)
    scaled = replace(scaled, face_width=width * gear.face_width, rim_thickness=rim, web_thickness=web)
    here, there = (model.tooth(one, np.linspace(one.form_radius, one.tip_radius, 5)).total for one in (gear, scaled))
    np.testing.assert_allclose(there * width, here, rtol=1e-8)


@named
@patient
@given(first=gears(), second=gears(), force=st.floats(1.0, 5e3))
def test_exchanging_driver_and_driven_mirrors_the_pair(
    model: CompliantTeeth, first: Gear, second: Gear, force: float
) -> None:
    shape = {"module": first.module, "pressure_angle": first.pressure_angle, "helix_angle": -first.helix_angle}
    try:
        body = {"bore": second.bore * first.module / second.module, "rim_thickness": None, "web_thickness": None}
        pair = GearPairGeometry(first, replace(second, **shape, **body))
        other = GearPairGeometry(pair.driven, pair.driver)
        position = np.linspace(0.0, pair.contact_ratio, 9)
        here = model.pair_compliance(pair, position, force)
    except GearError:
        assume(False)  # gears that do not mesh, or a load beyond what Hertz can say
    assert np.all(np.isfinite(here))
    assert np.all(here > 0.0)
    np.testing.assert_allclose(other.contact_ratio, pair.contact_ratio, rtol=1e-9)
    mirrored = model.pair_compliance(other, other.contact_ratio - position, force)
    np.testing.assert_allclose(mirrored[1:-1], here[1:-1], rtol=1e-6)


@named
def test_a_straight_helix_is_a_spur(model: CompliantTeeth) -> None:
    spur = Gear("spur", 35, 2.5e-3, math.radians(20.0), 25e-3, bore=25e-3)
    radius = np.array([spur.pitch_radius])
    expected = model.tooth(spur, radius).total
    found = [model.tooth(replace(spur, helix_angle=beta), radius).total for beta in (1e-4, 1e-8)]
    np.testing.assert_allclose(found[0], expected, rtol=1e-6)
    np.testing.assert_allclose(found[1], expected, rtol=1e-12)
