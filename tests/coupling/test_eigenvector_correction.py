"""Eigenvectors of a machine from those at a neighbouring speed."""

import numpy as np
import numpy.typing as npt
import pytest

from gearwhine.coupling.collocation.linear_part import corrected_eigenvectors
from gearwhine.numerics.arrays import FloatArray


def machine(speed: float, size: int = 12, overdamped: float = 0.0) -> FloatArray:
    """A state matrix with gyroscopic terms; one motion may be overdamped, with two real eigenvalues."""
    rng = np.random.default_rng(5)
    stiffness = np.diag(np.linspace(1.0, 9.0, size) ** 2)
    turning = rng.normal(size=(size, size))
    damping = 0.02 * np.eye(size) + speed * (turning - turning.T)
    damping[0, 0] += overdamped
    return np.block([[np.zeros((size, size)), np.eye(size)], [-stiffness, -damping]])


def direct(
    matrix: FloatArray,
) -> tuple[npt.NDArray[np.complex128], npt.NDArray[np.complex128], npt.NDArray[np.complex128]]:
    values, vectors = np.linalg.eig(matrix)
    values, vectors = values.astype(np.complex128), vectors.astype(np.complex128)
    kept = values.imag >= 0.0
    weights = np.where(values[kept].imag > 0.0, 2.0, 1.0)
    return values[kept], vectors[:, kept] * weights, np.linalg.inv(vectors)[kept]


@pytest.mark.parametrize("overdamped", [0.0, 5.0])
def test_corrected_ones_are_those_of_the_matrix(overdamped: float) -> None:
    there = machine(0.101, overdamped=overdamped)
    found = corrected_eigenvectors(there, *direct(machine(0.1, overdamped=overdamped)))
    assert found is not None
    values, right, left = found
    assert np.count_nonzero(values.imag == 0.0) == (2 if overdamped else 0)
    # As sets of numbers with no order of their own.
    exact, _, _ = direct(there)
    apart = np.abs(values[:, None] - exact[None, :])
    assert apart.min(axis=1).max() < 1e-12 * np.abs(exact).max()
    assert sorted(apart.argmin(axis=1)) == list(range(len(exact)))
    size = np.abs(there).max()
    np.testing.assert_allclose((right * values @ left).real, there, atol=1e-11 * size)
    np.testing.assert_allclose((right @ left).real, np.eye(len(there)), atol=1e-11)
    np.testing.assert_allclose(there @ right, right * values, atol=1e-11 * size)


def test_equal_eigenvalues_do_not_hinder() -> None:
    """Two planes without coupling, as those of a shaft on round bearings."""
    once = machine(0.0, size=3)
    twice = np.kron(np.eye(2), once)
    found = corrected_eigenvectors(1.001 * twice, *direct(twice))
    assert found is not None
    values, right, left = found
    np.testing.assert_allclose((right * values @ left).real, 1.001 * twice, atol=1e-11 * np.abs(twice).max())


def test_none_where_the_neighbour_is_too_far_or_eigenvalues_meet() -> None:
    assert corrected_eigenvectors(machine(0.6), *direct(machine(0.1))) is None
    # An overdamped motion's two eigenvalues come of a pair that was not there before.
    assert corrected_eigenvectors(machine(0.1, overdamped=5.0), *direct(machine(0.1))) is None
    assert corrected_eigenvectors(machine(0.1, size=8), *direct(machine(0.1))) is None
