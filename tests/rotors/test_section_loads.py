"""Shear forces, bending moments and strain energies of modes: equilibrium, ends, closed forms."""

import math

import numpy as np
import pytest

from gearwhine.rotors import Disc, RadialSupport, Rotor, RotorError, Segment, ShaftMaterial, solve_lateral_modes

STEEL = ShaftMaterial.from_poisson_ratio(2.1e11, 0.3, 7850.0)
BAR = Segment(0.5, 0.06, 0.02, STEEL)
SHAFT = Rotor("shaft", [BAR, BAR], [Disc(0.3, 5.0, 0.02, 0.012)])
SPRINGS = [RadialSupport(0.0, 3e7, 2e4), RadialSupport(1.0, 5e7)]


def test_loads_balance_the_inertia_along_the_shaft() -> None:
    """f' = −ω² ρA x, m' = −ω² ρI β − f and m = EI β', by central differences inside a segment."""
    modes = solve_lateral_modes(SHAFT, SPRINGS, count=5)
    z, h = np.linspace(0.55, 0.95, 7), 1e-4
    section, squared = BAR.section(0.0), (modes.frequencies**2)[:, None]
    x, slope = modes.evaluate(z)
    force, moment = modes.section_loads(z)
    ahead, behind = modes.section_loads(z + h), modes.section_loads(z - h)
    bent = (modes.evaluate(z + h)[1] - modes.evaluate(z - h)[1]) / (2.0 * h)
    for found, expected in (
        ((ahead[0] - behind[0]) / (2.0 * h), -squared * section.mass_per_length * x),
        ((ahead[1] - behind[1]) / (2.0 * h), -squared * 0.5 * section.polar_inertia_per_length * slope - force),
        (moment, section.bending_stiffness * bent),
    ):
        scale = np.abs(expected).max(axis=1, keepdims=True)
        assert np.abs((found - expected) / scale).max() < 1e-5


def test_ends_carry_what_the_supports_press() -> None:
    modes = solve_lateral_modes(SHAFT, SPRINGS, count=5)
    force, moment = modes.section_loads([0.0, 1.0])
    x, slope = modes.evaluate([0.0, 1.0])
    scale = np.abs(force).max()
    assert np.abs(force[:, 0] - 3e7 * x[:, 0]).max() < 1e-9 * scale
    assert np.abs(moment[:, 0] - 2e4 * slope[:, 0]).max() < 1e-9 * np.abs(moment).max()
    assert np.abs(force[:, 1] + 5e7 * x[:, 1]).max() < 1e-9 * scale
    assert np.abs(moment[:, 1]).max() < 1e-9 * np.abs(moment).max()  # a spring without tilt stiffness


def test_shares_are_one_together_and_those_of_the_springs() -> None:
    modes = solve_lateral_modes(SHAFT, SPRINGS, count=6)
    lengths, supports = modes.strain_energy_shares(SHAFT.joints)
    assert lengths.shape == (6, 2)
    assert supports.shape == (6, 2)
    assert np.abs(lengths.sum(axis=1) + supports.sum(axis=1) - 1.0).max() < 1e-9
    x, slope = modes.evaluate([0.0])
    left = (3e7 * x[:, 0] ** 2 + 2e4 * slope[:, 0] ** 2) / modes.frequencies**2
    np.testing.assert_allclose(supports[:, 0], left, rtol=1e-12)
    # Cut anywhere else, the parts add up to the same.
    finer = modes.strain_energy_shares([0.0, 0.2, 0.5, 0.77, 1.0])[0]
    np.testing.assert_allclose(finer[:, :2].sum(axis=1), lengths[:, 0], rtol=1e-9)


def test_a_symmetric_pinned_bar_shares_its_halves_and_a_rigid_one_leaves_all_to_its_springs() -> None:
    pins = [RadialSupport(at, math.inf) for at in (0.0, 1.0)]
    lengths, supports = solve_lateral_modes(Rotor("bar", [BAR, BAR]), pins, count=4).strain_energy_shares(
        [0.0, 0.5, 1.0]
    )
    np.testing.assert_allclose(lengths, 0.5, rtol=1e-9)
    assert not supports.any()
    soft = [RadialSupport(at, 1e2) for at in (0.0, 1.0)]
    modes = solve_lateral_modes(Rotor("bar", [BAR, BAR]), soft, count=2)
    np.testing.assert_allclose(modes.strain_energy_shares([0.0, 1.0])[1], 0.5, rtol=1e-4)


def test_rigid_motions_have_no_strain_and_places_must_be_on_the_shaft() -> None:
    free = solve_lateral_modes(SHAFT, count=3)
    lengths, supports = free.strain_energy_shares(SHAFT.joints)
    assert not lengths[:2].any()
    assert lengths[2].sum() == pytest.approx(1.0, rel=1e-9)
    assert supports.shape == (3, 0)
    with pytest.raises(RotorError, match="places on the shaft"):
        free.section_loads([1.2])
