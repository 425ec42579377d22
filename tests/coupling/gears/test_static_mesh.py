"""The loaded mesh: equilibrium by bisection, sharing, closed forms of square and relieved meshes."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from gearwhine.coupling.gears import (
    ConstantStiffness,
    Gear,
    GearError,
    GearPairGeometry,
    PotentialEnergyStiffness,
    SquareStiffness,
    TipRelief,
    loaded_transmission_error,
    mesh_stiffness,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force
from gearwhine.coupling.gears.loaded.transmission_error import mesh_period_phases

ALPHA = math.radians(20.0)
PLAIN = Gear("plain", 28, 3.175e-3, ALPHA, 6.35e-3)
RELIEVED = replace(PLAIN, name="relieved", tip_relief=TipRelief(0.023e-3, math.radians(24.0)))
FORCE = 71.77 / PLAIN.base_radius
CONTACT = tooth_contact(GearPairGeometry(RELIEVED, RELIEVED), PotentialEnergyStiffness(), damping=5.0)
EPS = GearPairGeometry(PLAIN, PLAIN).contact_ratio


@pytest.mark.parametrize("force", [1e-6, 10.0, FORCE, 1e5])
def test_equilibrium_by_root_finding_on_the_dynamic_law(force: float) -> None:
    mesh = loaded_transmission_error(CONTACT, force, np.linspace(0.0, 1.0, 23))
    for phase, delta in zip(mesh.phases, mesh.transmission_error, strict=True):

        def surplus(compression: float, phase: float = phase) -> float:
            return tooth_force(phase, compression, 0.0, *CONTACT.kernel_arguments)[0] - force

        assert delta == pytest.approx(brentq(surplus, 0.0, 1e-2, xtol=1e-18, rtol=1e-14), rel=1e-10, abs=1e-17)


def test_square_mesh_in_closed_form() -> None:
    # Without relief: two pairs carry half each for eps - 1 of the period, one carries all for the rest.
    contact = tooth_contact(GearPairGeometry(PLAIN, PLAIN), SquareStiffness(1e8))
    mesh = loaded_transmission_error(contact, 2000.0)
    assert mesh.mean_transmission_error == pytest.approx(1e-5 * (EPS - 1.0) + 2e-5 * (2.0 - EPS), rel=1e-6)
    assert mesh.peak_to_peak_transmission_error == pytest.approx(1e-5, rel=1e-12)
    assert mesh.mean_mesh_stiffness == pytest.approx(1e8 * EPS, rel=1e-6)
    double = mesh.phases < EPS - 1.0
    np.testing.assert_allclose(mesh.load_shares[double], 0.5, rtol=1e-12)
    np.testing.assert_allclose(mesh.load_shares[~double], [[1.0, 0.0]] * int(np.sum(~double)), atol=1e-15)


def test_constant_mesh_has_no_transmission_error_to_hear() -> None:
    mesh = loaded_transmission_error(tooth_contact(GearPairGeometry(RELIEVED, PLAIN), ConstantStiffness(1e8)), 1e3)
    np.testing.assert_allclose(mesh.transmission_error, 1e-5, rtol=1e-14)
    np.testing.assert_allclose(mesh.secant_stiffness, 1e8, rtol=1e-12)


def test_relief_hands_the_load_over_gently() -> None:
    # At its entry a relieved pair at this load does not touch yet; unrelieved it takes its share at once.
    entry = np.array([1e-9])
    gentle = loaded_transmission_error(CONTACT, FORCE, entry)
    hard = loaded_transmission_error(
        tooth_contact(GearPairGeometry(PLAIN, PLAIN), PotentialEnergyStiffness()), FORCE, entry
    )
    assert gentle.load_shares[0, 0] == 0.0
    assert 0.3 < hard.load_shares[0, 0] < 0.5
    assert gentle.tangent_stiffness[0] < hard.tangent_stiffness[0]


def test_no_load_leaves_first_touch() -> None:
    mesh = loaded_transmission_error(CONTACT, 0.0, np.linspace(0.0, 0.99, 30))
    np.testing.assert_allclose(
        mesh.transmission_error, np.min(CONTACT.pairs(mesh.phases).deviation, axis=1), atol=1e-18
    )
    np.testing.assert_array_equal(mesh.load_shares, 0.0)
    assert np.all(np.isfinite(mesh.secant_stiffness))


def test_all_pairs_touch_under_a_great_load() -> None:
    mesh = loaded_transmission_error(CONTACT, 1e7)
    np.testing.assert_allclose(mesh.tangent_stiffness, mesh_stiffness(CONTACT, mesh.phases), rtol=1e-12)
    assert mesh.mean_mesh_stiffness == pytest.approx(CONTACT.unloaded_mean_mesh_stiffness, rel=1e-5)


def test_period_phases_stand_beside_every_step() -> None:
    phases = mesh_period_phases(CONTACT, points=10)
    assert np.all(np.diff(phases) > 0.0)
    assert phases[0] >= 0.0
    assert phases[-1] < 1.0
    for event in (1.0, EPS - 1.0):
        assert np.min(np.abs(phases - (event - 1e-9))) < 1e-12
    for corner in CONTACT.corner_phases:
        assert np.min(np.abs(phases - corner)) < 1e-15


@pytest.mark.parametrize("force", [-1.0, math.nan, math.inf])
def test_impossible_loads_are_refused(force: float) -> None:
    with pytest.raises(GearError, match="load must be at least 0 N"):
        loaded_transmission_error(CONTACT, force)
