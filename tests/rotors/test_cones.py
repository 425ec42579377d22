"""Cones: torsion and axial waves in closed form, the thin cone's Bessel functions, and a cone cut into cones."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.special import iv, jv

from gearwhine.rotors import (
    AxisSpring,
    Disc,
    RadialSupport,
    Rotor,
    Segment,
    ShaftMaterial,
    solve_axial_modes,
    solve_lateral_modes,
    solve_torsional_modes,
)
from gearwhine.rotors.model.shaft import station_inertias

STEEL = ShaftMaterial(207e9, 79.6e9, 7850.0)


def cut(cone: Segment, pieces: int) -> list[Segment]:
    def part(i: int) -> Segment:
        left, right = cone.section(i / pieces), cone.section((i + 1) / pieces)
        return replace(
            cone,
            length=cone.length / pieces,
            outer_diameter=left.outer_diameter,
            inner_diameter=left.inner_diameter,
            right_outer_diameter=right.outer_diameter,
            right_inner_diameter=right.inner_diameter,
        )

    return [part(i) for i in range(pieces)]


@pytest.mark.parametrize("right", [0.02, 0.05, 0.4])
def test_axial_modes_of_a_solid_cone(right: float) -> None:
    """With area ∝ r², r u obeys the plain wave equation: u = (A cos kr + B sin kr) / r from the apex.

    Free at both ends: d/dr[(A cos kr + B sin kr)/r] = 0, or tan k(b − a) = k (b − a) / (1 + k² a b).
    """
    cone = Segment(0.6, 0.1, 0.0, STEEL, right_outer_diameter=right)
    modes = solve_axial_modes(Rotor("cone", [cone]), count=40)
    slope = (right - 0.1) / 0.6
    a, b = 0.1 / slope, right / slope

    def closing(k: float) -> float:
        return math.sin(k * (b - a)) * (1 + k * k * a * b) - k * (b - a) * math.cos(k * (b - a))

    wave = math.sqrt(207e9 / 7850.0)
    assert modes.frequencies[0] == 0.0
    for omega in modes.frequencies[1:]:
        k = omega / wave
        assert k == pytest.approx(brentq(closing, k * (1 - 1e-5), k * (1 + 1e-5), rtol=1e-14), rel=1e-10)
    # No root is left out: their phases advance by π.
    phases = modes.frequencies[1:] / wave * 0.6 / math.pi
    assert np.all(np.abs(phases - np.arange(1, 40)) < 0.5)


def test_torsion_of_a_clamped_solid_cone() -> None:
    """With J ∝ r⁴, θ = r^(−3/2) Z(kr) with Bessel functions of order 3/2; held at one end, free at the other."""
    cone = Segment(0.6, 0.1, 0.0, STEEL, right_outer_diameter=0.03)
    modes = solve_torsional_modes(Rotor("cone", [cone]), [AxisSpring(0.0, math.inf)], count=40)
    slope = 0.07 / 0.6
    a, b = 0.1 / slope, 0.03 / slope

    def closing(k: float) -> float:
        # d/dr (r^−n J_n(kr)) = −k r^−n J_{n+1}(kr), and for J_{−n} the same with +k J_{−n−1}.
        first, second = jv(1.5, k * a), jv(-1.5, k * a)
        return float(-first * jv(-2.5, k * b) - second * jv(2.5, k * b))

    wave = math.sqrt(79.6e9 / 7850.0)
    for omega in modes.frequencies:
        k = omega / wave
        assert k == pytest.approx(brentq(closing, k * (1 - 1e-5), k * (1 + 1e-5), rtol=1e-14), rel=1e-10)
    assert modes.count == 40


def test_thin_cone_is_that_of_bernoulli_and_kirchhoff() -> None:
    """A cone clamped at its base: x = (C₁ J₂(y) + C₂ I₂(y)) / r, y = 2 p √r, p⁴ = ρA ω² / EI · r² (Kirchhoff).

    A full cone to its tip: J₂(y) I₃(y) + I₂(y) J₃(y) = 0 at the base, first root y = 5.906 (textbook ω = 8.719 …).
    """
    length, base = 1.0, 2e-3
    root = brentq(lambda y: jv(2, y) * iv(3, y) + iv(2, y) * jv(3, y), 5.0, 7.0, rtol=1e-14)
    # EI = E π d⁴/64 and ρA = ρ π d²/4 with d = base r / L: ω = y²/4 · d √(E/ρ) / (4 L²).
    exact = root**2 / 4 * base * math.sqrt(207e9 / 7850.0) / (4 * length**2)
    errors = []
    for tip in (1e-3, 1e-4):
        cone = Segment(length * (1 - tip), base, 0.0, STEEL, right_outer_diameter=base * tip)
        modes = solve_lateral_modes(Rotor("cone", [cone]), [RadialSupport(0.0, math.inf, math.inf)], count=1)
        errors.append(abs(modes.frequencies[0] / exact - 1.0))
    # What is left is the blunt tip, and shear and rotary inertia of the order (d/L)² = 4e-6.
    assert errors[1] < 1e-5
    assert root**2 / 4 == pytest.approx(8.719, abs=1e-3)


@st.composite
def cones(draw: st.DrawFn) -> Segment:
    left, right = draw(st.floats(0.02, 0.2)), draw(st.floats(0.02, 0.2))
    bores = [draw(st.sampled_from([0.0, 0.3, 0.8])) for _ in range(2)]
    formula = draw(st.sampled_from(["cowper", "hutchinson", 0.8]))
    force = draw(st.sampled_from([0.0, 1e5]))
    return Segment(
        draw(st.floats(0.1, 0.8)), left, bores[0] * left, STEEL, formula, right, bores[1] * right, axial_force=force
    )


@settings(max_examples=6, deadline=None)
@given(cones(), st.integers(2, 30))
def test_a_cone_cut_into_cones_is_the_same_cone(cone: Segment, pieces: int) -> None:
    supports = [RadialSupport(0.2 * cone.length, 1e8), RadialSupport(0.9 * cone.length, math.inf)]
    discs = [Disc(0.55 * cone.length, 3.0, 0.01, 0.02)]
    whole, parts = (Rotor("cone", row, discs) for row in ([cone], cut(cone, pieces)))
    for solve, held in ((solve_lateral_modes, supports), (solve_torsional_modes, []), (solve_axial_modes, [])):
        one, other = solve(whole, held, count=12), solve(parts, held, count=12)  # type: ignore[operator]
        assert one.certificate.complete
        np.testing.assert_allclose(other.frequencies, one.frequencies, rtol=1e-11)
    turned = replace(
        cone,
        outer_diameter=cone.end_diameters[1][0],
        inner_diameter=cone.end_diameters[1][1],
        right_outer_diameter=cone.outer_diameter,
        right_inner_diameter=cone.inner_diameter,
    )
    mirrored = [replace(support, at=cone.length - support.at) for support in supports]
    backwards = Rotor("turned", [turned], [Disc(0.45 * cone.length, 3.0, 0.01, 0.02)])
    np.testing.assert_allclose(
        solve_lateral_modes(backwards, mirrored, count=12).frequencies,
        solve_lateral_modes(whole, supports, count=12).frequencies,
        rtol=1e-11,
    )


def test_lumped_cone_keeps_mass_centre_and_polar_inertia() -> None:
    cone = Segment(0.3, 0.1, 0.0, STEEL, right_outer_diameter=0.04)
    rotor = Rotor("cone", [cone], mass_model="lumped")
    table = station_inertias(rotor, rotor.stations)
    # Frustum: mass ρ π h (R² + R r + r²)/3, centre h (R² + 2 R r + 3 r²) / 4(R² + R r + r²),
    # I_p = 3/10 m (R⁵ − r⁵)/(R³ − r³).
    R, r, h = 0.05, 0.02, 0.3
    total = R * R + R * r + r * r
    mass = 7850 * math.pi * h * total / 3
    centre = h * (R * R + 2 * R * r + 3 * r * r) / (4 * total)
    np.testing.assert_allclose(table[:, 0].sum(), mass, rtol=1e-13)
    np.testing.assert_allclose(table[1, 0] * h, mass * centre, rtol=1e-13)
    np.testing.assert_allclose(table[:, 2].sum(), 0.3 * mass * (R**5 - r**5) / (R**3 - r**3), rtol=1e-13)
    assert rotor.centre_of_mass == pytest.approx(centre, rel=1e-13)
