"""Inertia against dense eigenvalues, solutions against dense ones, and singular matrices refused; both backends."""

from typing import Literal

import numpy as np
import pytest
from scipy import linalg, sparse

from gearwhine.housing.errors import FactorizationError
from gearwhine.housing.fem import factorization
from gearwhine.housing.fem.factorization import Factorizer, default_backend
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.meshes import Mesh

Backend = Literal["rslab", "superlu"]
BACKENDS = pytest.mark.parametrize("backend", ["rslab", "superlu"])


@BACKENDS
def test_negative_pivots_are_negative_eigenvalues(cube: tuple[Mesh, Matrices], backend: Backend) -> None:
    _, matrices = cube
    values = linalg.eigh(matrices.stiffness.toarray(), matrices.mass.toarray(), eigvals_only=True)
    gaps = np.flatnonzero(np.diff(values) > 1e-3 * values[1:])  # between multiple modes, not within
    shifts = [-0.01 * values[6], *(0.5 * (values[gap] + values[gap + 1]) for gap in gaps[gaps >= 5][::8])]
    assert len(shifts) > 8
    factorizer = Factorizer(backend=backend)
    for shift in shifts:
        shifted = matrices.shifted(shift)
        factor = factorizer.factor(shifted)
        assert factor.negative == np.count_nonzero(values < shift)
        assert factor.negative == np.count_nonzero(np.linalg.eigvalsh(shifted.toarray()) < 0.0)
        assert factor.backend == backend
        assert factor.size == 195
        assert factor.fill > 0


@BACKENDS
def test_solutions_are_those_of_dense_algebra(cube: tuple[Mesh, Matrices], backend: Backend) -> None:
    matrix = cube[1].shifted(-1e9)
    right = np.random.default_rng(3).standard_normal((195, 5))
    expected = np.linalg.solve(matrix.toarray(), right)
    factor = Factorizer(backend=backend).factor(matrix)
    np.testing.assert_allclose(factor.solve(right), expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
    np.testing.assert_allclose(factor.solve(right[:, 0]), expected[:, 0], atol=1e-9 * np.abs(expected).max())


def test_backends_agree_on_a_housing(box_matrices: Matrices) -> None:
    matrix = box_matrices.shifted((2 * np.pi * 4000.0) ** 2)
    right = np.random.default_rng(4).standard_normal(matrix.shape[0])
    one, other = (Factorizer(backend=backend).factor(matrix) for backend in ("rslab", "superlu"))
    assert one.negative == other.negative > 6
    np.testing.assert_allclose(one.solve(right), other.solve(right), atol=1e-8 * np.abs(one.solve(right)).max())


@BACKENDS
def test_singular_matrices_are_refused(backend: Backend) -> None:
    for entries in ([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [[2.0, -1, -1], [-1, 2, -1], [-1, -1, 2]]):
        matrix = sparse.csr_array(np.array(entries))
        with pytest.raises(FactorizationError, match=f"{backend}"):
            Factorizer(backend=backend).factor(matrix)


@BACKENDS
def test_a_free_body_at_rest_is_singular_even_where_rounding_hides_it(box_matrices: Matrices, backend: Backend) -> None:
    """Six eigenvalues of K are rounding errors, of either sign: an inertia read from them would be a guess."""
    with pytest.raises(FactorizationError, match=r"singular or nearly so|may be free"):
        Factorizer(backend=backend).factor(box_matrices.stiffness)


def test_a_backend_that_is_not_installed_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(factorization, "can_import", lambda module: False)
    with pytest.raises(FactorizationError, match="rslab needs the package rslab, which is not installed"):
        Factorizer(backend="rslab")
    assert Factorizer().backend == "superlu"


def test_rslab_is_the_default_where_it_is_installed() -> None:
    pytest.importorskip("rslab")
    assert default_backend() == "rslab"
