"""Laws that every gear pair and its contact law obey: symmetry, scaling, energy, equilibrium."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from gearwhine.coupling.gears import (
    Gear,
    GearPairGeometry,
    PotentialEnergyStiffness,
    ProfileDeviation,
    RootRelief,
    TipRelief,
    ToothContact,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force
from gearwhine.coupling.gears.geometry.involute import inverse_involute, involute

RELIEF_START = 0.75
"""Fraction of the tip's roll angle where the reliefs drawn here begin."""


patient = settings(deadline=None)  # the first call of a kernel compiles it


@st.composite
def gears(draw: st.DrawFn, module: float = 2e-3, relieved: bool = True) -> Gear:
    gear = Gear(
        name="drawn",
        teeth=draw(st.integers(18, 120)),
        module=module,
        pressure_angle=math.radians(20.0),
        face_width=draw(st.floats(5e-3, 40e-3)),
        profile_shift=draw(st.floats(0.0, 0.4)),
        youngs_modulus=draw(st.floats(70e9, 210e9)),
    )
    if draw(st.booleans()):
        gear = replace(gear, bore=2.0 * gear.root_circle_radius / draw(st.floats(1.45, 6.9)))
    if relieved and draw(st.booleans()):
        start = RELIEF_START * gear.roll_angle(gear.tip_radius)
        shape = draw(st.sampled_from(["linear", "parabolic"]))
        gear = replace(gear, tip_relief=TipRelief(draw(st.floats(1e-6, 40e-6)), start, shape=shape))
    if relieved and draw(st.booleans()):
        length = draw(st.floats(0.1, 1.0)) * gear.module
        gear = replace(gear, root_relief=RootRelief(draw(st.floats(1e-6, 40e-6)), length=length))
    if relieved and draw(st.booleans()):
        size = st.floats(-10e-6, 10e-6)
        profile = ProfileDeviation(draw(size), draw(st.floats(0.0, 5e-6)), draw(st.floats(0.5, 5.0)), 0.3, draw(size))
        gear = replace(gear, profile_deviation=profile)
    return gear


@st.composite
def pairs(draw: st.DrawFn, relieved: bool = True) -> GearPairGeometry:
    return GearPairGeometry(draw(gears(relieved=relieved)), draw(gears(relieved=relieved)))


@st.composite
def contacts(draw: st.DrawFn) -> ToothContact:
    damping, corners = draw(st.floats(0.0, 1e4)), draw(st.booleans())
    return tooth_contact(draw(pairs()), PotentialEnergyStiffness(), damping, corner_contact=corners)


def evaluate(contact: ToothContact, phase: float, delta: float) -> tuple[float, float, float, float, float, int]:
    return tooth_force(phase, delta, 0.0, *contact.kernel_arguments)


def away_from_events(contact: ToothContact, phase: float, margin: float = 1e-4) -> bool:
    corners = (0.0, *contact.event_phases, *contact.corner_phases)
    return all(abs((phase - corner + 0.5) % 1.0 - 0.5) > margin for corner in corners)


@patient
@given(st.floats(0.0, 1e6))
def test_inverse_involute_solves_its_equation(value: float) -> None:
    assert involute(inverse_involute(value)) == pytest.approx(value, rel=1e-9, abs=1e-15)


@patient
@given(pairs())
def test_exchanging_the_gears_keeps_the_idle_flanks_phase(pair: GearPairGeometry) -> None:
    other = GearPairGeometry(pair.driven, pair.driver)
    left_over = 2.0 * pair.contact_ratio - pair.back_flank_offset - other.back_flank_offset
    assert left_over == pytest.approx(round(left_over), abs=1e-6)


@patient
@given(contacts(), st.floats(-50.0, 50.0), st.floats(-1e-4, 1e-4), st.floats(-1.0, 1.0))
def test_law_is_finite_and_periodic(contact: ToothContact, phase: float, delta: float, rate: float) -> None:
    here = tooth_force(phase, delta, rate, *contact.kernel_arguments)
    assert all(math.isfinite(value) for value in here)
    assert here[1] >= 0.0
    assert here[3] >= 0.0
    assert here[0] >= 0.0  # teeth do not pull
    if here[5] == 0:
        assert here[0] == here[1] == 0.0
    else:
        assert here[1] > 0.0 or here[0] == 0.0
    if away_from_events(contact, phase):
        there = tooth_force(phase + 3.0, delta, rate, *contact.kernel_arguments)
        np.testing.assert_allclose(there, here, rtol=1e-8, atol=1e-8 * (1.0 + abs(here[0])))


@patient
@given(contacts(), st.floats(0.0, 1.0), st.floats(1e-7, 1e-4))
def test_force_is_the_energys_slope(contact: ToothContact, phase: float, delta: float) -> None:
    # dU/d delta = F and dF/d delta, by central differences; a quadratic's are exact but for rounding.
    gaps = contact.pairs(phase).deviation
    step = 1e-3 * delta
    if np.any(np.abs(delta - gaps) < 2.0 * step):
        return  # a pair is just about to touch: the tangent steps there
    before, here, after = (evaluate(contact, phase, delta + change) for change in (-step, 0.0, step))
    scale = contact.unloaded_mean_mesh_stiffness
    assert (after[3] - before[3]) / (2.0 * step) == pytest.approx(here[0], rel=1e-7, abs=1e-9 * scale * delta)
    assert (after[0] - before[0]) / (2.0 * step) == pytest.approx(here[1], rel=1e-7, abs=1e-9 * scale)


@patient
@given(contacts(), st.floats(0.0, 1.0), st.floats(1e-6, 1e-4))
def test_parametric_power_is_the_energys_slope_in_phase(contact: ToothContact, phase: float, delta: float) -> None:
    step = 1e-5
    if not away_from_events(contact, phase, margin=3.0 * step):
        return
    before, here, after = (evaluate(contact, phase + change, delta) for change in (-step, 0.0, step))
    if before[5] != after[5]:
        return  # a relieved pair begins to touch inside the difference
    scale = 0.5 * contact.unloaded_mean_mesh_stiffness * delta**2
    assert (after[3] - before[3]) / (2.0 * step) == pytest.approx(here[4], rel=1e-4, abs=1e-5 * scale)


@settings(deadline=None, max_examples=15)
@given(contacts(), st.floats(0.0, 1e4))
def test_static_mesh_balances_shares_and_only_pushes(contact: ToothContact, force: float) -> None:
    mesh = loaded_transmission_error(contact, force)
    assert np.all(mesh.pair_forces >= 0.0)
    np.testing.assert_allclose(mesh.pair_forces.sum(axis=1), force, rtol=1e-9, atol=1e-9)
    if force > 1e-6:
        np.testing.assert_allclose(mesh.load_shares.sum(axis=1), 1.0, rtol=1e-6)
    heavier = loaded_transmission_error(contact, 1.5 * force + 1.0, mesh.phases)
    assert np.all(heavier.transmission_error > mesh.transmission_error)
    first_touch = np.min(contact.pairs(mesh.phases).deviation, axis=1)
    assert np.all(mesh.transmission_error >= first_touch)


@patient
@given(
    st.floats(1.0, 4.5),
    st.lists(st.floats(1e7, 1e9), min_size=3, max_size=3),
    st.lists(st.floats(0.0, 5e-5), min_size=2, max_size=5),
    st.floats(0.0, 1e4),
    st.floats(0.0, 0.999),
    st.floats(0.0, 0.8),
)
@example(1.0000000000000002, [1e8, 1e8, 1e8], [0.0, 0.0], 1.0, 0.0, 0.0)  # two pairs for a sliver of the period
def test_any_contact_finds_its_equilibrium(
    eps: float, stiffness: list[float], gaps: list[float], force: float, phase: float, shared: float
) -> None:
    # Not gears but any law of this form, with up to five pairs and wild deviations.
    low, middle, high = sorted(stiffness)
    middle = max(middle, 0.5 * (low + high))  # keeps the parabola above its ends
    contact = ToothContact(
        eps,
        piecewise.quadratic(low, middle, high, eps),
        piecewise.polyline(np.linspace(0.0, eps, len(gaps)), np.array(gaps)),
        shared_compliance=shared / max(high, middle),
    )
    mesh = loaded_transmission_error(contact, force, [phase])
    found = evaluate(contact, phase, float(mesh.transmission_error[0]))[0]
    assert found == pytest.approx(force, rel=1e-8, abs=1e-6)
