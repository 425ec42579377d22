"""The transfer matrix of a piece against scipy's matrix exponential of its differential equation."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from rotors.timoshenko import transfer_matrices

# 1/κGA, 1/EI, ρA, ρI of a short fat steel bar in units of its own length and stiffness.
FLEXIBILITY, INERTIA = np.array([0.4, 1.3]), np.array([0.9, 0.2])
CUT_OFF = 1.0 / math.sqrt(0.4 * 0.2)


def bending_equation(squared: float) -> np.ndarray:
    (shear, bend), (mass, rotary) = FLEXIBILITY, INERTIA
    return np.array([[0, 1, shear, 0], [0, 0, 0, bend], [-squared * mass, 0, 0, 0], [0, -squared * rotary, -1, 0]])


@pytest.mark.parametrize("frequency", [0.0, 0.3, 1.0, CUT_OFF, 1.2 * CUT_OFF, 1.5 * CUT_OFF])
@pytest.mark.parametrize("length", [1e-4, 0.1, 0.8])
def test_beam_is_the_exponential_also_at_and_above_the_cut_off(frequency: float, length: float) -> None:
    squared = frequency**2
    transfer = transfer_matrices(FLEXIBILITY, INERTIA, np.array(length), np.array(squared))
    np.testing.assert_allclose(transfer, expm(bending_equation(squared) * length), rtol=1e-12, atol=1e-15)


def test_beam_at_negative_frequency_squared() -> None:
    transfer = transfer_matrices(FLEXIBILITY, INERTIA, np.array(0.7), np.array(-2.0))
    np.testing.assert_allclose(transfer, expm(bending_equation(-2.0) * 0.7), rtol=1e-13)


def test_massless_beam_is_the_myklestad_field() -> None:
    # Closed form: cantilever deflection under end force and moment, with shear.
    h, (shear, bend) = 0.6, FLEXIBILITY
    field = np.eye(4)
    field[0, 1], field[0, 2], field[0, 3] = h, shear * h - bend * h**3 / 6, bend * h**2 / 2
    field[1, 2], field[1, 3], field[3, 2] = -bend * h**2 / 2, bend * h, -h
    transfer = transfer_matrices(FLEXIBILITY, np.zeros(2), np.array(h), np.array(9.0))
    np.testing.assert_allclose(transfer, field, rtol=1e-15, atol=1e-16)


def test_rod_is_trigonometric() -> None:
    h, squared, flexibility, inertia = 0.9, 1.7, 0.8, 1.1
    wave = math.sqrt(squared * flexibility * inertia)
    expected = [
        [math.cos(wave * h), flexibility * math.sin(wave * h) / wave],
        [-squared * inertia * math.sin(wave * h) / wave, math.cos(wave * h)],
    ]
    transfer = transfer_matrices(np.array([flexibility]), np.array([inertia]), np.array(h), np.array(squared))
    np.testing.assert_allclose(transfer, expected, rtol=1e-14)


def test_reciprocity() -> None:
    # Maxwell–Betti makes T symplectic: Tᵀ J T = J with J pairing displacements and forces.
    transfer = transfer_matrices(FLEXIBILITY, INERTIA, np.array(0.8), np.array(3.0))
    pairing = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])
    np.testing.assert_allclose(transfer.T @ pairing @ transfer, pairing, atol=1e-14)
