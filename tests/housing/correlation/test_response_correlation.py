"""Likeness of frequency responses: known factors, shifts and gaps, and the model's against a direct solution."""

import numpy as np
import pytest
from scipy import sparse

from gearwhine.housing import HousingError, Material, assemble, solve_modes
from gearwhine.housing.correlation import frac, synthesised_responses

LINES = np.linspace(10.0, 400.0, 300)
POINTS = np.arange(1, 8) / 8
SINES = np.sin(np.pi * np.outer([1, 2, 3], POINTS))
RESONANCES = np.array([100.0, 210.0, 330.0])


def _responses(resonances: np.ndarray = RESONANCES, lines: np.ndarray = LINES, ratio: float = 0.01) -> np.ndarray:
    """A string of three modes driven at its first point, at all seven."""
    gains = 1.0 / (resonances[:, None] ** 2 - lines**2 + 2j * ratio * resonances[:, None] * lines)
    return np.einsum("rp,r,rf->pf", SINES, SINES[:, 0], gains)


def test_equal_responses_to_any_scale() -> None:
    given = _responses()
    value = frac(given, -3j * given)
    assert value == pytest.approx(np.ones(value.shape))


def test_a_single_resonance_shifted() -> None:
    """Two resonances with little overlap: ∫ a* b dw over all w, by residues, against a and b themselves.

    For H = 1 / (p - w) the integrals give FRAC = 4 γ² / ((Δ)² + 4 γ²), with half-width γ and shift Δ.
    """
    wide = np.linspace(-4000.0, 4000.0, 400001)
    gamma, shift = 1.0, 3.0
    first, second = 1.0 / (1j * gamma - wide), 1.0 / (shift + 1j * gamma - wide)
    assert frac(first, second) == pytest.approx(4 * gamma**2 / (shift**2 + 4 * gamma**2), rel=1e-3)


def test_lines_not_measured_are_left_out() -> None:
    given, test = _responses(), _responses(1.02 * RESONANCES)
    gaps = test.copy()
    gaps[:, 40:90] = np.nan
    kept = np.r_[0:40, 90:300]
    assert frac(given, gaps) == pytest.approx(frac(given[:, kept], test[:, kept]))
    assert np.isnan(frac(np.full(3, np.nan), np.ones(3)))


def test_responses_that_do_not_fit_are_refused() -> None:
    with pytest.raises(HousingError, match="expected them alike"):
        frac(np.ones((2, 3)), np.ones((2, 4)))


def test_synthesised_responses_against_a_direct_solution(block, steel: Material) -> None:
    """Against the whole system of a small block, solved at once with damping that is modal in the kept modes."""
    mesh = block((0.1, 0.08, 0.06), (1, 1, 1), 1)
    matrices = assemble(mesh, steel)
    bottom = np.flatnonzero(np.repeat(mesh.points[:, 2] == 0.0, 3))
    size = 3 * len(mesh.points)
    modes = solve_modes(matrices.held(bottom), count=12)
    ratios = np.full(len(modes.frequencies), 0.02)
    freedoms = np.setdiff1d(np.arange(size), bottom)[:4]
    survey = sparse.csr_array((np.ones(4), (np.arange(4), freedoms)), shape=(4, size))
    driven = survey[[1, 2]]
    lines = np.array([0.3, 0.9]) * modes.frequencies[0]
    free = np.setdiff1d(np.arange(size), bottom)
    stiffness = matrices.stiffness.toarray()[np.ix_(free, free)]
    mass = matrices.mass.toarray()[np.ix_(free, free)]
    # Modal damping of the same ratio in the modes kept: C = M Φ diag(2ζω) Φᵀ M.
    phi = modes.shapes.reshape(len(modes.shapes), -1).T[free]
    damping = mass @ phi @ np.diag(2 * ratios * modes.frequencies) @ phi.T @ mass
    values = synthesised_responses(modes, ratios, driven, survey, lines, "velocity")
    assert values.shape == (4, 2, 2)
    # What is projected on the kept modes, the discarded ones apart.
    for line, w in enumerate(lines):
        direct = np.linalg.solve(stiffness - w**2 * mass + 1j * w * damping, driven[:, free].T.toarray())
        kept = phi @ (phi.T @ (mass @ direct))
        assert values[:, :, line] == pytest.approx(1j * w * (survey[:, free] @ kept), rel=1e-8)
    still = synthesised_responses(modes, ratios, driven, survey, lines, "displacement")
    moving = synthesised_responses(modes, ratios, driven, survey, lines)
    assert moving == pytest.approx(-(lines**2) * still)
    with pytest.raises(HousingError, match="expected one of displacement, velocity, acceleration"):
        synthesised_responses(modes, ratios, driven, survey, lines, "jerk")
