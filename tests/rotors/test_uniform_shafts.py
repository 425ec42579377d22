"""Uniform shafts against closed-form Timoshenko and rod solutions, however they are cut into segments."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from gearwhine.rotors import RadialSupport, Rotor, Segment, ShaftMaterial, solve_lateral_modes, solve_torsional_modes
from gearwhine.rotors.transfer_matrix.rotor_shafts import free_bending_shaft

STEEL = ShaftMaterial(207e9, 79.6e9, 7850.0)


def uniform(length: float, diameter: float, bore: float, pieces: int) -> Rotor:
    """A shaft in pieces of one section that no two neighbours name alike: like ones would be made one span again."""
    by_name = Segment(length / pieces, diameter, bore, STEEL)
    section = by_name.section(0.0)
    number = section.shear_stiffness / (STEEL.shear_modulus * math.pi * (diameter**2 - bore**2) / 4.0)
    by_number = Segment(length / pieces, diameter, bore, STEEL, shear_coefficient=number)
    return Rotor("uniform", [by_number if place % 2 else by_name for place in range(pieces)])


def test_pieces_are_not_made_one_again() -> None:
    assert all(free_bending_shaft(uniform(*SHAFTS[0], pieces)).kind.size == pieces for pieces in (1, 7, 400))


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


# What vanishes at an end: of x, β, moment, shear.
ENDS = {"free": (2, 3), "pinned": (0, 2), "clamped": (0, 1)}
HELD = {"free": None, "pinned": (math.inf, 0.0), "clamped": (math.inf, math.inf)}


def determinants(omega: np.ndarray, left: str, right: str, length: float, diameter: float, bore: float) -> np.ndarray:
    """Determinant of the end conditions over x = e^{p(z−L)}, e^{−pz}, cos qz, sin qz, or cos pz, sin pz beyond cut-off.

    For e^{λz} the force balance κGA (x'' − β') = −ω² ρA x gives β = (λ² + s)/λ e^{λz}, s = ω² ρA/κGA.
    """
    bending, shear, mass, rotary = section(length, diameter, bore)
    s, d = omega**2 * mass / shear, omega**2 * rotary / bending
    root = np.sqrt((s - d) ** 2 / 4 + omega**2 * mass / bending)
    matrix = np.empty((omega.size, 4, 4))
    first_square, second_square = root - (s + d) / 2, -root - (s + d) / 2
    waves = ((first_square, 1), (first_square, -1), (second_square, 1), (second_square, -1))
    for column, (square, sign) in enumerate(waves):
        wave = np.sqrt(square.astype(complex)) * sign
        growing = (square > 0) & (sign > 0)
        for first, (end, place) in ((0, (left, 0.0)), (2, (right, length))):
            field = np.exp(wave * (place - np.where(growing, length, 0.0)))
            beta = (square + s) / wave
            values = np.stack([np.ones_like(wave), beta, beta * wave, wave - beta]) * field
            # Of a conjugate pair of waves the real part and the imaginary part; e^{−pz} is taken with the sign that
            # keeps the determinant's through the cut-off, where the pair is degenerate.
            rows = np.where(square > 0, sign * values.real, values.real if sign > 0 else values.imag)
            matrix[:, first : first + 2, column] = rows[list(ENDS[end])].T
    size = np.abs(matrix).max(axis=2, keepdims=True)
    return np.linalg.det(matrix / size)


def closed_form(left: str, right: str, shaft: tuple[float, float, float], below: float) -> np.ndarray:
    """Every root of the end conditions below a frequency, by a fine grid and brentq."""
    grid = np.concatenate([np.geomspace(1e-4, 2e-2, 400), np.linspace(2.01e-2, 1.0, 20_000)]) * below
    values = determinants(grid, left, right, *shaft)
    changes = np.flatnonzero(values[1:] * values[:-1] < 0)

    def at(omega: float) -> float:
        return float(determinants(np.array([omega]), left, right, *shaft)[0])

    return np.array([brentq(at, grid[k], grid[k + 1], xtol=1e-13 * grid[k], rtol=1e-14) for k in changes])


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
@pytest.mark.parametrize(
    ("left", "right"), [("free", "free"), ("pinned", "pinned"), ("clamped", "clamped"), ("clamped", "free")]
)
def test_forty_modes_of_any_ends(left: str, right: str, shaft: tuple[float, float, float]) -> None:
    # Both shafts' fortieth modes lie beyond their cut-off frequencies.
    supports = [
        RadialSupport(place, *held) for place, held in ((0.0, HELD[left]), (shaft[0], HELD[right])) if held is not None
    ]
    rigid = 2 if left == right == "free" else 0
    whole = solve_lateral_modes(uniform(*shaft, 1), supports, count=40 + rigid)
    np.testing.assert_array_equal(whole.frequencies[:rigid], 0.0)
    elastic = whole.frequencies[rigid:]
    _, shear, _, rotary = section(*shaft)
    assert elastic[-1] > math.sqrt(shear / rotary)
    expected = closed_form(left, right, shaft, elastic[-1] * (1 + 1e-6))
    np.testing.assert_allclose(elastic, expected, rtol=1e-9)
    for pieces in (7, 400):
        cut = solve_lateral_modes(uniform(*shaft, pieces), supports, count=40 + rigid)
        np.testing.assert_allclose(cut.frequencies, whole.frequencies, rtol=1e-10)
        assert cut.certificate.complete


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
    exact = closed_form("free", "free", shaft, free.frequencies[-1] * (1 + 1e-6))
    np.testing.assert_allclose(free.frequencies[2:], exact, rtol=1e-10)
    # At this slenderness the Euler–Bernoulli roots of cos x cosh x = 1 hold to (d/L)² = 2.5e-7 times n².
    for n, omega in enumerate(free.frequencies[2:], start=1):
        root = brentq(lambda x: math.cos(x) - 1 / math.cosh(x), (n + 0.3) * math.pi, (n + 0.7) * math.pi)
        euler = (root / 10.0) ** 2 * 0.00125 * math.sqrt(207e9 / 7850.0)
        assert omega == pytest.approx(euler, rel=5e-5)
        assert omega < euler


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
