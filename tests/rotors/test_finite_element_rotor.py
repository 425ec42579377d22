"""The finite-element reference itself, against closed forms; and the arithmetic under it, against rational numbers."""

import math
from fractions import Fraction

import inertia_count
import numpy as np
import pytest
from double_double import DoubleDouble
from finite_element_rotor import bending_model, rod_model
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import special
from scipy.optimize import brentq

from gearwhine.rotors import Coupling, Disc, RadialSupport, Rotor, Segment, ShaftMaterial

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
SPRING = ShaftMaterial(211e9, 81.2e9, 0.0)
PIN = math.inf
NUMBERS = st.floats(1e-9, 1e9) | st.floats(-1e9, -1e-9)


def exact(number: DoubleDouble) -> Fraction:
    return Fraction(float(number.high)) + Fraction(float(number.low))


@settings(deadline=None)
@given(NUMBERS, NUMBERS, NUMBERS, NUMBERS)
def test_arithmetic_of_thirty_one_digits(a: float, b: float, c: float, d: float) -> None:
    x, y = DoubleDouble.product(a, b), DoubleDouble.product(c, d)
    assert exact(x) == Fraction(a) * Fraction(b)
    # Sums of opposite sign lose nothing either.
    assert abs(exact(x + y) - (exact(x) + exact(y))) <= abs(exact(x) + exact(y)) * Fraction(2) ** -103
    assert abs(exact(x * y) - exact(x) * exact(y)) <= abs(exact(x) * exact(y)) * Fraction(2) ** -100
    # The compiled operations of the factorisation.
    pairs = (float(x.high), float(x.low)), (float(y.high), float(y.low))
    for operation, true in (
        (inertia_count.product, exact(x) * exact(y)),
        (inertia_count.difference, exact(x) - exact(y)),
        (inertia_count.ratio, exact(x) / exact(y)),
    ):
        assert abs(sum(map(Fraction, operation(*pairs[0], *pairs[1]))) - true) <= abs(true) * Fraction(2) ** -99


def pinned_bar(force: float, count: int) -> np.ndarray:
    """x = X sin kz, β = B cos kz: the two roots ω² of each wave number k = nπ/L, lowest few, rad/s."""
    part = Segment(1.2, 0.05, 0.01, STEEL)
    section, roots = part.section(0.0), []
    for n in range(count + 1):
        k = n * math.pi / part.length
        shear, bend = section.shear_stiffness, section.bending_stiffness
        heavy, rotary = section.mass_per_length, 0.5 * section.polar_inertia_per_length
        stiffness = np.array([[(shear + force) * k**2, -k * shear], [-k * shear, shear + bend * k**2]])
        # k = 0 is pure shear, β alike everywhere; x has no such motion.
        if n == 0:
            roots.append(math.sqrt(shear / rotary))
            continue
        scale = np.sqrt(np.array([heavy, rotary]))
        squared = np.linalg.eigvalsh(stiffness / np.outer(scale, scale))
        # The smaller from the product, which does not cancel.
        determinant = (shear + force) * k**2 * (shear + bend * k**2) - k**2 * shear**2
        roots += [math.sqrt(determinant / (heavy * rotary * squared[1])), math.sqrt(squared[1])]
    return np.sort(roots)[:count]


@pytest.mark.parametrize(("force", "count"), [(0.0, 40), (4e5, 10), (-3e5, 10)])
def test_pinned_bar(force: float, count: int) -> None:
    bar = Rotor("bar", [Segment(length, 0.05, 0.01, STEEL, axial_force=force) for length in (0.7, 0.5)])
    roots = pinned_bar(force, count + 1)
    limit = float(0.5 * (roots[-2] + roots[-1]))
    pins = [RadialSupport(0.0, PIN), RadialSupport(1.2, PIN)]
    found = bending_model(bar, pins, limit).natural_frequencies(limit)
    np.testing.assert_allclose(found, roots[:-1], rtol=3e-12)


def test_convergence_is_that_of_the_degree() -> None:
    bar = Rotor("bar", [Segment(1.2, 0.05, 0.01, STEEL)])
    roots = pinned_bar(0.0, 7)
    pins = [RadialSupport(0.0, PIN), RadialSupport(1.2, PIN)]
    errors = []
    for degree in (4, 6, 8):
        model = bending_model(bar, pins, float(roots[6]), degree=degree, reach=4.0)
        errors.append(np.abs(model.natural_frequencies(float(roots[6]) * 0.99) / roots[:6] - 1.0).max())
    assert errors[0] > 1e-6
    assert errors[1] < 1e-2 * errors[0]
    assert errors[2] < 1e-2 * errors[1]


def test_slender_cone_in_bending() -> None:
    # (z⁴ w'')'' = λ z² w from the apex: w = z⁻¹ C₂(2 λ^¼ √z), C any of J, Y, I, K (Kirchhoff 1879). Clamped at the
    # broad end z = 2, free at z = 1; w'' and (z⁴ w'')' there by recurrences of the cylinder functions.
    slope = 1e-6

    def determinant(q: float) -> float:
        rows = []
        for function in (special.jv, special.yv, special.iv, special.kv):
            # d/dx (x⁻ⁿ Cₙ) = ∓ x⁻ⁿ Cₙ₊₁, with x = 2 q √z, so that each d/dz is a factor ∓2 q² and one order more.
            step = 2.0 * q**2 * (1.0 if function is special.iv else -1.0)
            narrow, broad = 2.0 * q, 2.0 * q * math.sqrt(2.0)
            size = 1.0 / abs(function(2, broad))
            w = 4.0 * q**2 * function(2, broad) / broad**2
            w1 = 4.0 * q**2 * step * function(3, broad) / broad**3
            w2 = 4.0 * q**2 * step**2 * function(4, narrow) / narrow**4
            w3 = 4.0 * q**2 * step**3 * function(5, narrow) / narrow**5
            rows.append(size * np.array([w, w1, w2, 4.0 * w2 + w3]))
        return float(np.linalg.det(rows))

    trials = np.linspace(1.5, 14.0, 500)
    values = [determinant(q) for q in trials]
    roots = [
        brentq(determinant, a, b, xtol=1e-14)
        for a, b, u, v in zip(trials[:-1], trials[1:], values[:-1], values[1:], strict=True)
        if u * v < 0.0
    ][:4]
    # Diameter slope · z: EI / ρA = E slope² z² / 16ρ.
    expected = np.array(roots) ** 2 * math.sqrt(STEEL.youngs_modulus / STEEL.density) * slope / 4.0
    cone = Segment(1.0, slope, 0.0, STEEL, right_outer_diameter=2.0 * slope)
    limit = float(expected[-1]) * 1.05
    found = bending_model(Rotor("cone", [cone]), [RadialSupport(1.0, PIN, PIN)], limit).natural_frequencies(limit)
    np.testing.assert_allclose(found, expected, rtol=1e-9)


@pytest.mark.parametrize(("motion", "order"), [("axial", 0.5), ("torsion", 1.5)])
def test_cone_as_a_rod(motion: str, order: float) -> None:
    # (z²ⁿ⁺¹ u')' + k² z²ⁿ⁺¹ u = 0 from the apex: u = z⁻ⁿ Cₙ(kz), u' = −k z⁻ⁿ Cₙ₊₁(kz); free at z = 1 and z = 2.
    def determinant(k: float) -> float:
        j, y = special.jv, special.yv
        return float(j(order + 1, k) * y(order + 1, 2 * k) - y(order + 1, k) * j(order + 1, 2 * k))

    roots = [brentq(determinant, (n - 0.4) * math.pi, (n + 0.6) * math.pi, xtol=1e-14) for n in range(1, 6)]
    modulus = STEEL.youngs_modulus if motion == "axial" else STEEL.shear_modulus
    expected = np.array(roots) * math.sqrt(modulus / STEEL.density)
    cone = Rotor("cone", [Segment(1.0, 0.1, 0.0, STEEL, right_outer_diameter=0.2)])
    limit = float(expected[-1]) * 1.05
    found = rod_model(cone, motion, limit).natural_frequencies(limit)
    np.testing.assert_allclose(found, [0.0, *expected], rtol=1e-11, atol=1e-3)


def test_two_discs_on_a_coupling() -> None:
    # Equal discs (m, J): tilting against each other 2 k_t / J; sliding against each other with
    # k_e = 1 / (1/k + L²/12 k_t) on 2/m + L²/2J; twisting and stretching 2 k_θ / J_p and 2 k_z / m.
    length, lateral, tilt, twist, stretch, mass, polar, inertia = 0.2, 3e6, 4e4, 7e3, 5e5, 6.0, 0.05, 0.03
    joint = Coupling(length, lateral, tilt, twist, stretch, 2.0, 0.02, 0.014)
    discs = [Disc(at, mass - 1.0, polar - 0.01, inertia - 0.007) for at in (0.1, 0.1 + length)]
    rigid = Segment(0.1, 1.0, 0.0, ShaftMaterial(1e20, 1e20, 0.0))
    rotor = Rotor("coupled", [rigid, joint, rigid], discs)  # type: ignore[list-item]
    effective = 1.0 / (1.0 / lateral + length**2 / (12.0 * tilt))
    bending = [2.0 * tilt / inertia, effective * (2.0 / mass + length**2 / (2.0 * inertia))]
    found = bending_model(rotor, [], 1e4).natural_frequencies(1e4)
    np.testing.assert_allclose(found, [0.0, 0.0, *np.sort(np.sqrt(bending))], rtol=1e-9, atol=1e-5)
    for motion, squared in (("torsion", 2.0 * twist / polar), ("axial", 2.0 * stretch / mass)):
        found = rod_model(rotor, motion, 1e4).natural_frequencies(1e4)
        np.testing.assert_allclose(found, [0.0, math.sqrt(squared)], rtol=1e-9, atol=1e-5)


def test_weakly_tied_masses_across_thirty_decades() -> None:
    # Two discs pinned in tilt on springs 1e-15 and 1e15, joined by a hair: √(k/m) each, to the hair's stiffness.
    hair = Segment(1.0, 1e-7, 0.0, SPRING)
    rotor = Rotor("hair", [hair], [Disc(0.0, 2.0, 0.1, 0.1), Disc(1.0, 3.0, 0.1, 0.1)])
    held = [RadialSupport(0.0, 1e-9, PIN), RadialSupport(1.0, 1e15, PIN)]
    found = bending_model(rotor, held, 1e8).natural_frequencies(1e8, floor=1e-15)
    stiff = 12.0 * hair.section(0.0).bending_stiffness
    assert found[0] == pytest.approx(math.sqrt((1e-9 + stiff) / 2.0), rel=1e-8)
    assert found[1] == pytest.approx(math.sqrt(1e15 / 3.0), rel=1e-11)
    assert found.size == 2
