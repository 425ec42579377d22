"""Eigenpairs of small systems against closed forms: rigid motions, doubles, critical damping, soft supports."""

import numpy as np
import numpy.typing as npt
import pytest
from scipy import linalg

from gearwhine.coupling import CoupledSystem, CouplingError, ModesError, coupled_modes, receptance
from gearwhine.coupling.linear.eigenpairs import pair_residuals, quadratic_eigenpairs, refine_pair
from gearwhine.coupling.machine.components import Component

HALVES = (slice(0, 2), slice(2, 4))


def one(stiffness: npt.ArrayLike, damping: npt.ArrayLike, kind: str = "torsion") -> CoupledSystem:
    """A system of one component, nothing tied to it."""
    k, c = np.array(stiffness, dtype=float), np.array(damping, dtype=float)
    return CoupledSystem((Component("body", (kind,) * len(k), k, c, np.zeros_like(k)),), (0.0,))


def test_free_chain_has_one_double_zero() -> None:
    """Two inertias on a spring: 0 twice and √(k/a + k/b)."""
    a, b, k = 0.4, 1.7, 350.0
    root = np.sqrt(np.array([a, b]))
    stiffness = k * np.array([[1.0, -1.0], [-1.0, 1.0]]) / np.outer(root, root)
    system = one(stiffness, np.zeros((2, 2)))
    modes = coupled_modes(system)
    assert modes.kinds == ("rigid", "torsion")
    assert modes.eigenvalues[0] == 0.0
    assert modes.eigenvalues[1] == pytest.approx(1j * np.sqrt(k / a + k / b), rel=1e-14)
    # Both turn by one angle: coordinates in proportion to the roots of the inertias.
    np.testing.assert_allclose(np.abs(modes.shapes[0]), root / np.linalg.norm(root), rtol=1e-13)
    assert (modes.certificate.expected, modes.certificate.found, modes.certificate.zeros) == (4, 4, 2)
    # Superposed, the free motion answers by -1/w², the other by 1/(ω² - w²).
    w, free = np.array([3.0, 70.0]), np.outer(root, root) / (a + b)
    gains = 1.0 / (np.array([0.0, k / a + k / b])[:, None, None, None] - w[:, None, None] ** 2)
    found = receptance(system, np.eye(2), np.eye(2), w, modes=modes)
    np.testing.assert_allclose(found, gains[0] * free + gains[1] * (np.eye(2) - free), rtol=1e-12)


@pytest.mark.parametrize("soft", [1e-4, 1e-7, 1e-9, 1e-12])
def test_soft_supports_are_not_taken_for_none(soft: float) -> None:
    """Two masses, one held by a spring that is softer by orders of magnitude than the one between them."""
    stiffness = 1e10 * np.array([[1.0 + soft, -1.0], [-1.0, 1.0]])
    modes = coupled_modes(one(stiffness, np.zeros((2, 2))))
    assert "rigid" not in modes.kinds
    # λ² from trace and determinant; the small one as their quotient, without cancellation.
    trace, determinant = 1e10 * (2.0 + soft), 1e20 * soft
    large = 0.5 * (trace + np.sqrt(trace**2 - 4.0 * determinant))
    expected = np.sqrt([determinant / large, large])
    np.testing.assert_allclose(np.abs(modes.eigenvalues), expected, rtol=4e-16 / soft + 1e-13)


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_gears_tied_hard_between_soft_shafts_leave_one_rigid_motion(unit: float) -> None:
    """Inertia, shaft of 0.1 N m/rad, gears tied at 1e13 N/m, shaft, inertia: one rigid motion in any units.

    The softest elastic motion has both gears as one inertia, turning between the shafts.
    """
    inertias, (r, s), k, tie = np.array([2.0, 1e-3, 3e-3, 4.0]), (0.04, 0.06), 0.1, 1e13
    rows = np.array([[1.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -1.0], [0.0, r, s, 0.0]]) / np.sqrt(inertias)
    # In the free shafts' own modes, as a machine has them: the tie is in every coordinate, and no scaling parts it.
    shafts = [np.linalg.eigh(k * np.outer(row[part], row[part])) for row, part in zip(rows, HALVES, strict=False)]
    own = linalg.block_diag(*(shape for _, shape in shafts))
    stiffness = np.diag(np.concatenate([[0.0, values[1]] for values, _ in shafts])) + tie * np.outer(
        *[rows[2] @ own] * 2
    )
    modes = coupled_modes(one(unit * stiffness, np.zeros((4, 4))))
    assert modes.kinds.count("rigid") == 1
    # Gears as one: the second turns by -r/s of the first.
    tied = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -r / s, 0.0], [0.0, 0.0, 1.0]])
    springs = np.array([[1.0, -1.0, 0.0], [0.0, -r / s, -1.0]])
    squares = linalg.eigvalsh(k * springs.T @ springs, tied.T @ np.diag(inertias) @ tied)[1:]
    np.testing.assert_allclose(np.abs(modes.eigenvalues[1:3]), np.sqrt(unit * squares), rtol=1e-2)


def test_drag_leaves_a_zero_and_a_decay() -> None:
    """A free mass in a fluid: anywhere at rest, and velocities that decay as e^{-ct}."""
    modes = coupled_modes(one([[0.0]], [[0.8]]))
    np.testing.assert_allclose(modes.eigenvalues, [0.0, -0.8], rtol=1e-14)
    assert modes.kinds[0] == "rigid"
    assert (modes.certificate.found, modes.certificate.zeros) == (2, 1)


def test_free_gyroscope() -> None:
    """Two tilts tied by a gyroscopic term alone: any attitude, and precession at ±G."""
    pairs = quadratic_eigenpairs(np.zeros((2, 2)), np.array([[0.0, 3.0], [-3.0, 0.0]]))
    assert (len(pairs.rigid), pairs.drifts) == (2, 0)
    np.testing.assert_allclose(np.sort_complex(pairs.values), [-3.0j, 3.0j], atol=1e-14)


def test_unlike_null_spaces() -> None:
    """[[0, 1], [0, 0]]: what K leaves alone and what its forces cannot push are two motions, at right angles."""
    pairs = quadratic_eigenpairs(np.array([[0.0, 1.0], [0.0, 0.0]]), np.diag([0.1, 0.2]))
    # det = λ² (λ + 0.1) (λ + 0.2): of the two zeros one comes from each factor.
    np.testing.assert_allclose(np.sort(pairs.values.real), [-0.2, -0.1], rtol=1e-12)
    assert len(pairs.rigid) + pairs.drifts == 2


def test_critical_damping_is_defective() -> None:
    """q'' + 2ω q' + ω² q has one vector for its double root: 1 / (s + ω)², half the digits of the root being lost."""
    omega, turn = np.array([2.0, 3.0]), np.array([[0.6, 0.8], [-0.8, 0.6]])
    system = one(*(turn @ np.diag(values) @ turn.T for values in (omega**2, 2.0 * omega)))
    modes = coupled_modes(system)
    np.testing.assert_allclose(np.sort(np.abs(modes.pairs.values)), np.repeat(omega, 2), rtol=1e-6)
    rows, w = np.eye(2), np.array([0.7, 5.0])
    expected = np.einsum("ij,fj,kj->fik", turn, 1.0 / (1j * w[:, None] + omega) ** 2, turn)
    np.testing.assert_allclose(receptance(system, rows, rows, w), expected, rtol=1e-12)
    np.testing.assert_allclose(receptance(system, rows, rows, w, modes=modes), expected, rtol=1e-6)


def test_vectors_that_are_one_cannot_be_superposed() -> None:
    """Two critically damped motions of one frequency; solving does not care."""
    system = one(4.0 * np.eye(2), 4.0 * np.eye(2))
    modes = coupled_modes(system)
    np.testing.assert_allclose(modes.eigenvalues, -2.0, rtol=1e-6)
    rows, w = np.eye(2), np.array([0.7, 5.0])
    with pytest.raises(ModesError, match="cannot be superposed"):
        receptance(system, rows, rows, w, modes=modes)
    expected = np.eye(2) / (1j * w[:, None, None] + 2.0) ** 2
    np.testing.assert_allclose(receptance(system, rows, rows, w), expected, rtol=1e-12)


@pytest.mark.parametrize("ratio", [0.0, 0.02])
def test_double_roots_have_independent_vectors(ratio: float) -> None:
    """A double and a triple frequency, turned into general coordinates: every pair there, biorthogonal."""
    omega = np.array([2.0, 2.0, 5.0, 5.0, 5.0, 11.0])
    turn = np.linalg.qr(np.random.default_rng(4).normal(size=(6, 6)))[0]
    stiffness, damping = (turn @ np.diag(d) @ turn.T for d in (omega**2, 2.0 * ratio * omega))
    pairs = quadratic_eigenpairs(stiffness, damping)
    assert pairs.sum_rule < 1e-12
    expected = omega * (-ratio + 1j * np.sqrt(1.0 - ratio**2))
    np.testing.assert_allclose(np.sort(pairs.values[pairs.values.imag > 0.0].imag), expected.imag, rtol=1e-12)
    sums = pairs.values[:, None] + pairs.values[None, :]
    products = sums * (pairs.left.conj() @ pairs.right.T) + pairs.left.conj() @ damping @ pairs.right.T
    np.testing.assert_allclose(products, np.eye(12), atol=1e-11)


def test_sum_rule_sees_what_is_missing() -> None:
    """The certificate's own measure, with a pair taken out and with one put in twice."""
    rng = np.random.default_rng(2)
    stiffness = np.diag([1.0, 4.0, 9.0]) + 0.1 * np.ones((3, 3))
    damping = 0.05 * rng.normal(size=(3, 3))
    pairs = quadratic_eigenpairs(stiffness, damping)
    terms = np.einsum("m,mi,mj->mij", pairs.values, pairs.right, pairs.left.conj())
    np.testing.assert_allclose(terms.sum(axis=0), np.eye(3), atol=1e-13)
    assert np.abs(terms[1:].sum(axis=0) - np.eye(3)).max() > 0.05


def test_refining_from_afar() -> None:
    """Newton's method on a perturbed pair comes back to the closed form."""
    stiffness, damping = np.diag([4.0, 9.0]), 0.1 * np.diag([4.0, 9.0])
    value, vector, residual = refine_pair(stiffness, damping, 0.02 + 2.1j, np.array([1.0, 0.1j]))
    assert value == pytest.approx(-0.2 + 1j * np.sqrt(4.0 - 0.04), rel=1e-13)
    assert abs(vector[0]) == pytest.approx(1.0, rel=1e-12)
    assert residual < 1e-14
    # One that is none is seen: λ² + 4 = 3 over terms of 5.
    wrong = pair_residuals(stiffness, 0.0 * damping, np.array([1.0j]), np.array([[1.0 + 0j, 0.0]]))
    assert wrong[0] == pytest.approx(0.6)


def test_no_receptance_at_rest() -> None:
    with pytest.raises(CouplingError, match="drifts at 0"):
        receptance(one([[1.0]], [[0.1]]), np.eye(1), np.eye(1), np.array([0.0, 1.0]))
    with pytest.raises(ModesError, match="its own frequency"):
        receptance(one([[4.0]], [[0.0]]), np.eye(1), np.eye(1), np.array([2.0]))
