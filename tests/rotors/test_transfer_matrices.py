"""Transfer matrices of pieces against scipy's matrix exponential and its integration of their equations."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from gearwhine.rotors.model.material import ShaftMaterial
from gearwhine.rotors.model.profile import BENDING, restricted, shaft_profile
from gearwhine.rotors.model.segment import Segment
from gearwhine.rotors.transfer_matrix.timoshenko import ShaftElements

# 1/κGA, 1/EI, ρA, ρI of a short fat steel bar in units of its own length and stiffness.
SHEAR, BEND, MASS, ROTARY = 0.4, 1.3, 0.9, 0.2
CUT_OFF = 1.0 / math.sqrt(SHEAR * ROTARY)
PAIRING = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])


def coefficients(force: float = 0.0) -> np.ndarray:
    stiffness = 1.0 / SHEAR
    share = stiffness / (stiffness + force)
    return np.array([1.0 / (stiffness + force), BEND, MASS, ROTARY, share, share * force])


def bending_equation(squared: complex, force: float = 0.0, rotation: complex | None = None) -> np.ndarray:
    """The first-order form of κGA (x' − β)' + P x'' + ω² ρA x = 0 and EI β'' + κGA (x' − β) + ω² ρI β = 0.

    With f = κGA (x' − β) + P x' the slope is x' = (f + κGA β) / (κGA + P).
    """
    shear, turning = 1.0 / SHEAR, squared if rotation is None else rotation
    slope = np.array([0.0, shear, 1.0, 0.0]) / (shear + force)
    strain = shear * (slope - np.array([0.0, 1.0, 0.0, 0.0]))
    return np.array(
        [slope, [0, 0, 0, BEND], [-squared * MASS, 0, 0, 0], -strain - np.array([0, turning * ROTARY, 0, 0])]
    )


def transfer_of(length: float, force: float, squared: complex, rotation: complex | None = None) -> np.ndarray:
    table = ShaftElements(np.array([length]), coefficients(force)[None, :, None])
    return table.transfer_matrices(squared, rotation)[0, 0, 0]


@pytest.mark.parametrize("frequency", [0.0, 0.3, 1.0, CUT_OFF, 1.2 * CUT_OFF, 1.5 * CUT_OFF])
@pytest.mark.parametrize("length", [1e-4, 0.1, 0.8])
@pytest.mark.parametrize("force", [0.0, 0.8, -0.3])
def test_beam_is_the_exponential_also_at_and_above_the_cut_off(frequency: float, length: float, force: float) -> None:
    exact = expm(bending_equation(frequency**2, force) * length)
    np.testing.assert_allclose(transfer_of(length, force, frequency**2), exact, rtol=1e-12, atol=1e-15)


def test_beam_at_negative_and_complex_frequency_squared() -> None:
    np.testing.assert_allclose(transfer_of(0.7, 0.0, -2.0), expm(bending_equation(-2.0) * 0.7), rtol=1e-13)
    squared, rotation = 1.3 + 0.4j, 2.1 - 0.9j
    exact = expm(bending_equation(squared, 0.2, rotation) * 0.7)
    np.testing.assert_allclose(transfer_of(0.7, 0.2, squared, rotation), exact, rtol=1e-13, atol=1e-15)


def test_massless_beam_is_the_myklestad_field() -> None:
    # Closed form: cantilever deflection under end force and moment, with shear.
    h = 0.6
    field = np.eye(4)
    field[0, 1], field[0, 2], field[0, 3] = h, SHEAR * h - BEND * h**3 / 6, BEND * h**2 / 2
    field[1, 2], field[1, 3], field[3, 2] = -BEND * h**2 / 2, BEND * h, -h
    massless = coefficients() * [1, 1, 0, 0, 1, 1]
    transfer = ShaftElements(np.array([h]), massless[None, :, None]).transfer_matrices(9.0)[0, 0, 0]
    np.testing.assert_allclose(transfer, field, rtol=1e-15, atol=1e-16)


def test_rod_is_trigonometric() -> None:
    h, squared, flexibility, inertia = 0.9, 1.7, 0.8, 1.1
    wave = math.sqrt(squared * flexibility * inertia)
    expected = [
        [math.cos(wave * h), flexibility * math.sin(wave * h) / wave],
        [-squared * inertia * math.sin(wave * h) / wave, math.cos(wave * h)],
    ]
    table = ShaftElements(np.array([h]), np.array([[[flexibility], [inertia]]]))
    np.testing.assert_allclose(table.transfer_matrices(squared)[0, 0, 0], expected, rtol=1e-14)


STEEL = ShaftMaterial(207e9, 79.6e9, 7850.0)
CONES = [
    Segment(0.3, 0.05, 0.0, STEEL, "cowper", 0.08),
    Segment(0.2, 0.10, 0.02, STEEL, "hutchinson", 0.03, 0.025),
    Segment(0.2, 0.06, 0.0, STEEL, "cowper", 0.06, 0.055, axial_force=2e5),
]


def cone_coefficients(cone: Segment, fraction: float) -> np.ndarray:
    """The six of bending at a place, written out here; κ by Cowper or Hutchinson."""
    outer = cone.outer_diameter + fraction * (cone.end_diameters[1][0] - cone.outer_diameter)
    inner = cone.inner_diameter + fraction * (cone.end_diameters[1][1] - cone.inner_diameter)
    nu, m2 = 207 / (2 * 79.6) - 1, (inner / outer) ** 2
    if cone.shear_coefficient == "cowper":
        kappa = 6 * (1 + nu) * (1 + m2) ** 2 / ((7 + 6 * nu) * (1 + m2) ** 2 + (20 + 12 * nu) * m2)
    else:
        below = 7 + 34 * m2 + 7 * m2**2 + (12 * nu + 4 * nu**2) * (1 + 4 * m2 + m2**2)
        kappa = 6 * (1 + nu) ** 2 * (1 + m2) ** 2 / below
    area, moment = math.pi * (outer**2 - inner**2) / 4, math.pi * (outer**4 - inner**4) / 64
    shear, force = kappa * 79.6e9 * area, cone.axial_force
    share = shear / (shear + force)
    return np.array([1 / (shear + force), 1 / (207e9 * moment), 7850 * area, 7850 * moment, share, share * force])


@pytest.mark.parametrize("cone", CONES)
def test_cone_is_the_integral_of_its_equation(cone: Segment) -> None:
    profile = shaft_profile([cone], np.array([0.0, cone.length]))
    # Units in which the states are of one size: EI and length of the cone's left end.
    force = 207e9 * cone.section(0.0).second_moment / cone.length**2
    units = np.array([force, force * cone.length**2, cone.length**2 / force, 1 / force, 1.0, 1 / force])
    given = profile.coefficients[:, BENDING] * units[:, None]
    table = ShaftElements(profile.lengths / cone.length, given)
    squared = 9.0 / (7850 * cone.section(0.0).area * cone.length**2 / force)
    product = np.eye(4)
    for transfer in table.transfer_matrices(squared)[0, :, 0]:
        product = transfer @ product

    def equation(z: float, y: np.ndarray) -> np.ndarray:
        c, b, m, j, g, q = cone_coefficients(cone, z) * units
        matrix = [[0, g, c, 0], [0, 0, 0, b], [-squared * m, 0, 0, 0], [0, q - squared * j, -g, 0]]
        return (np.array(matrix) @ y.reshape(4, 4)).ravel()

    exact = solve_ivp(equation, (0, 1), np.eye(4).ravel(), method="DOP853", rtol=3e-14, atol=1e-15).y[:, -1]
    np.testing.assert_allclose(product, exact.reshape(4, 4), rtol=1e-11, atol=1e-11 * np.abs(product).max())
    np.testing.assert_allclose(product.T @ PAIRING @ product, PAIRING, atol=2e-13 * np.abs(product).max() ** 2)


@pytest.mark.parametrize("cone", CONES)
def test_profile_of_a_cone_is_its_sections(cone: Segment) -> None:
    profile = shaft_profile([cone], np.array([0.0, cone.length]))
    for span, (left, right) in enumerate(zip(profile.edges[:-1], profile.edges[1:], strict=True)):
        for fraction in (0.0, 0.21, 0.5, 0.93, 1.0):
            found = np.polynomial.polynomial.polyval(
                2 * fraction - 1, profile.coefficients[profile.section_of_span[span]].T
            )
            place = (left + fraction * (right - left)) / cone.length
            np.testing.assert_allclose(found[:6], cone_coefficients(cone, place), rtol=2e-14)
    # A part of a span is the same polynomial seen closer.
    part = restricted(profile.coefficients[:1], np.array([0.3]), np.array([0.2]))[0]
    whole = profile.coefficients[0]
    s = np.linspace(-1, 1, 7)
    polyval = np.polynomial.polynomial.polyval
    np.testing.assert_allclose(polyval(s, part.T), polyval(0.3 + 0.2 * s, whole.T), rtol=1e-14)


def test_transfer_to_a_fraction_of_a_piece_leads_on_to_its_end() -> None:
    # T(1) = T of the rest · T(f), the rest being a piece of its own.
    cone = shaft_profile([CONES[0]], np.array([0.0, CONES[0].length]))
    given = cone.coefficients[:1, BENDING]
    table = ShaftElements(np.ones(1), given)
    rest = ShaftElements(np.array([0.6]), restricted(given, np.array([0.4]), np.array([0.6])))
    table, rest = (
        ShaftElements(t.lengths, t.coefficients * 1e-6 * np.array([1, 1, 1, 1, 1e6, 1])[:, None]) for t in (table, rest)
    )
    at = table.transfer_matrices(4.0, fractions=np.array([0.4, 1.0]))[0, 0]
    np.testing.assert_allclose(rest.transfer_matrices(4.0)[0, 0, 0] @ at[0], at[1], rtol=1e-12, atol=1e-12)
    alone = table.transfer_matrices_to(np.zeros(2, dtype=np.intp), np.array([0.4, 1.0]), [4.0])
    np.testing.assert_allclose(alone[:, 0], at, rtol=1e-14)


@pytest.mark.parametrize("force", [0.0, 0.8, -0.3])
def test_reciprocity(force: float) -> None:
    # Maxwell–Betti makes T symplectic: Tᵀ J T = J with J pairing displacements and forces.
    transfer = transfer_of(0.8, force, 3.0)
    np.testing.assert_allclose(transfer.T @ PAIRING @ transfer, PAIRING, atol=1e-14)
