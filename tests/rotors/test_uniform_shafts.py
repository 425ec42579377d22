"""Uniform shafts against closed-form Timoshenko and rod solutions, however they are cut into segments."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

from rotors import RadialSupport, Rotor, Segment, ShaftMaterial, solve_lateral_modes, solve_torsional_modes

STEEL = ShaftMaterial(207e9, 79.6e9, 7850.0)


def uniform(length: float, diameter: float, bore: float, pieces: int) -> Rotor:
    return Rotor("uniform", [Segment(length / pieces, diameter, bore, STEEL)] * pieces)


def section(length: float, diameter: float, bore: float) -> tuple[float, float, float, float]:
    """EI, κGA, ρA, ρI written out here, κ by Cowper."""
    nu, m2 = 207 / (2 * 79.6) - 1, (bore / diameter) ** 2
    kappa = 6 * (1 + nu) * (1 + m2) ** 2 / ((7 + 6 * nu) * (1 + m2) ** 2 + (20 + 12 * nu) * m2)
    area = math.pi * (diameter**2 - bore**2) / 4
    inertia = math.pi * (diameter**4 - bore**4) / 64
    return 207e9 * inertia, kappa * 79.6e9 * area, 7850.0 * area, 7850.0 * inertia


def pinned_closed_form(length: float, diameter: float, bore: float, count: int) -> np.ndarray:
    """Both spectra of a pinned shaft: with q = nπ/L, x = sin qz and β = B cos qz leave a quadratic in ω².

    ρA ρI ω⁴ − [ρA (EI q² + κGA) + ρI κGA q²] ω² + κGA EI q⁴ = 0, and for n = 0 the pure section
    rotation ω² = κGA/ρI.
    """
    bending, shear, mass, rotary = section(length, diameter, bore)
    roots = [shear / rotary]
    for n in range(1, 200):
        q2 = (n * math.pi / length) ** 2
        half = (mass * (bending * q2 + shear) + rotary * shear * q2) / 2
        product = mass * rotary * shear * bending * q2**2
        upper = (half + math.sqrt(half**2 - product)) / (mass * rotary)
        roots += [upper, shear * bending * q2**2 / (mass * rotary * upper)]
    return np.sqrt(np.sort(roots)[:count])


def free_closed_form(length: float, diameter: float, bore: float, count: int) -> np.ndarray:
    """Free-free roots below the cut-off, symmetric and antisymmetric about the middle, by brentq.

    With λ² = p², −q² the roots of the wave equation, symmetric fields are combinations of cosh pz and
    cos qz, whose rotations follow from the force balance κGA (x'' − β') = −ω² ρA x; both moment and shear
    vanish at z = L/2.
    """
    bending, shear, mass, rotary = section(length, diameter, bore)
    end = length / 2

    def determinant(omega: float, odd: bool) -> float:
        s, d = omega**2 * mass / shear, omega**2 * rotary / bending
        root = math.sqrt((s - d) ** 2 / 4 + omega**2 * mass / bending)
        p, q = math.sqrt(root - (s + d) / 2), math.sqrt(root + (s + d) / 2)
        # β of x = cosh pz is a sinh pz with a p = p² + s; of x = cos qz it is b sin qz with b q = s − q².
        a, b = (p**2 + s) / p, (s - q**2) / q
        grow = math.tanh(p * end)
        if not odd:
            moment = (a * p, b * q * math.cos(q * end))
            force = ((p - a) * grow, (-q - b) * math.sin(q * end))
        else:
            moment = (a * p * grow, b * q * math.sin(q * end))
            force = (p - a, (q + b) * math.cos(q * end))
        return moment[0] * force[1] - moment[1] * force[0]

    cut_off = math.sqrt(shear / rotary)
    grid = np.geomspace(1e-3, 0.999, 4000) * cut_off
    found = []
    for odd in (False, True):
        values = [determinant(omega, odd) for omega in grid]
        for (left, f_left), (right, f_right) in pairwise(zip(grid, values, strict=True)):
            if f_left * f_right < 0:
                found.append(brentq(determinant, left, right, args=(odd,), xtol=1e-13 * left, rtol=1e-14))
    return np.sort(found)[:count]


SHAFTS = [(1.0, 0.05, 0.0), (0.3, 0.1, 0.04), (0.1, 0.2, 0.0)]


@pytest.mark.parametrize("shaft", SHAFTS)
@pytest.mark.parametrize("pieces", [1, 7, 400])
def test_pinned_shaft(shaft: tuple[float, float, float], pieces: int) -> None:
    ends = [RadialSupport(0.0, math.inf), RadialSupport(shaft[0], math.inf)]
    modes = solve_lateral_modes(uniform(*shaft, pieces), ends, count=8)
    # The fat one's eight roots lie on both sides of its cut-off frequency.
    np.testing.assert_allclose(modes.frequencies, pinned_closed_form(*shaft, 8), rtol=1e-11)
    assert modes.certificate.complete


@pytest.mark.parametrize("shaft", SHAFTS[:2])
@pytest.mark.parametrize("pieces", [1, 7, 400])
def test_free_shaft(shaft: tuple[float, float, float], pieces: int) -> None:
    modes = solve_lateral_modes(uniform(*shaft, pieces), count=5)
    np.testing.assert_array_equal(modes.frequencies[:2], 0.0)
    np.testing.assert_allclose(modes.frequencies[2:], free_closed_form(*shaft, 3), rtol=1e-11)


def test_pinned_shape_is_a_sine() -> None:
    shaft = SHAFTS[0]
    ends = [RadialSupport(0.0, math.inf), RadialSupport(1.0, math.inf)]
    modes = solve_lateral_modes(uniform(*shaft, 3), ends, count=4)
    z = np.linspace(0.0, 1.0, 41)
    displacement, slope = modes.evaluate(z)
    _, shear, mass, rotary = section(*shaft)
    for n, (omega, x, beta) in enumerate(zip(modes.frequencies, displacement, slope, strict=True), start=1):
        q = n * math.pi
        ratio = q - omega**2 * mass / (shear * q)
        amplitude = math.sqrt(2.0 / (mass + rotary * ratio**2))
        sign = np.sign(x[1])
        np.testing.assert_allclose(sign * x, amplitude * np.sin(q * z), atol=1e-9 * amplitude)
        np.testing.assert_allclose(sign * beta, ratio * amplitude * np.cos(q * z), atol=1e-9 * q * amplitude)
        np.testing.assert_allclose(
            modes.polar_inertia_matrix[n - 1, n - 1], rotary * (ratio * amplitude) ** 2, rtol=1e-9
        )


@pytest.mark.parametrize("pieces", [1, 400])
def test_slenderness_of_two_thousand_keeps_its_digits(pieces: int) -> None:
    shaft = (10.0, 0.005, 0.0)
    ends = [RadialSupport(0.0, math.inf), RadialSupport(10.0, math.inf)]
    modes = solve_lateral_modes(uniform(*shaft, pieces), ends, count=20)
    np.testing.assert_allclose(modes.frequencies, pinned_closed_form(*shaft, 20), rtol=1e-11)
    free = solve_lateral_modes(uniform(*shaft, pieces), count=8)
    # At this slenderness the Euler–Bernoulli roots of cos x cosh x = 1 hold to (d/L)² = 2.5e-7 times n².
    for n, omega in enumerate(free.frequencies[2:], start=1):
        root = brentq(lambda x: math.cos(x) - 1 / math.cosh(x), (n + 0.3) * math.pi, (n + 0.7) * math.pi)
        euler = (root / 10.0) ** 2 * 0.00125 * math.sqrt(207e9 / 7850.0)
        assert omega == pytest.approx(euler, rel=5e-5)
        assert omega < euler


def test_cantilever_against_its_transcendental_equation() -> None:
    # Timoshenko fields c₁ cosh pz + … clamped at 0 and free at L, as a 4 × 4 determinant written out here.
    shaft = (0.3, 0.06, 0.02)
    bending, shear, mass, rotary = section(*shaft)

    def determinant(omega: float) -> float:
        s, d = omega**2 * mass / shear, omega**2 * rotary / bending
        root = math.sqrt((s - d) ** 2 / 4 + omega**2 * mass / bending)
        p, q = math.sqrt(root - (s + d) / 2), math.sqrt(root + (s + d) / 2)
        a, b, end = (p**2 + s) / p, (s - q**2) / q, 0.3
        ch, sh, co, si = math.cosh(p * end), math.sinh(p * end), math.cos(q * end), math.sin(q * end)
        rows = [
            [1, 0, 1, 0],
            [0, a, 0, -b],
            [a * p * ch, a * p * sh, b * q * co, b * q * si],
            [(p - a) * sh, (p - a) * ch, (-q - b) * si, (q + b) * co],
        ]
        return float(np.linalg.det(rows))

    clamp = [RadialSupport(0.0, math.inf, math.inf)]
    for omega in solve_lateral_modes(uniform(*shaft, 5), clamp, count=4).frequencies:
        root = brentq(determinant, omega * 0.999, omega * 1.001, rtol=1e-14)
        assert omega == pytest.approx(root, rel=1e-11)


@pytest.mark.parametrize("pieces", [1, 7, 400])
def test_uniform_rod_in_torsion(pieces: int) -> None:
    modes = solve_torsional_modes(uniform(1.7, 0.05, 0.02, pieces), count=9)
    wave = math.sqrt(79.6e9 / 7850.0)
    np.testing.assert_allclose(modes.frequencies, np.arange(9) * math.pi * wave / 1.7, rtol=1e-12)
    z = np.linspace(0.0, 1.7, 30)
    inertia = 7850.0 * math.pi * (0.05**4 - 0.02**4) / 32 * 1.7
    expected = np.sqrt(2.0 / inertia) * np.cos(3 * math.pi * z / 1.7)
    third = modes.evaluate(z)[3]
    np.testing.assert_allclose(np.sign(third[0]) * third, expected, atol=1e-10 * expected[0])
    np.testing.assert_allclose(np.abs(modes.angle[0]), 1.0 / math.sqrt(inertia), rtol=1e-12)
