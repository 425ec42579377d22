"""Least squares by an LU factorisation against the pseudo-inverse by singular values."""

import numpy as np
import pytest

from gearwhine.numerics.arrays import ComplexArray
from gearwhine.numerics.dense_least_squares import solve_least_squares


def _equations(rows: int, columns: int, condition: float) -> tuple[ComplexArray, ComplexArray]:
    """Random equations with a condition number, and three right sides that they do not fulfil."""
    generator = np.random.default_rng(7)

    def drawn(*shape: int) -> ComplexArray:
        return generator.normal(size=shape) + 1j * generator.normal(size=shape)

    left, right = np.linalg.qr(drawn(rows, columns))[0], np.linalg.qr(drawn(columns, columns))[0]
    return left * np.geomspace(1.0, 1.0 / condition, columns) @ right, drawn(rows, 3)


@pytest.mark.parametrize(("rows", "columns"), [(1, 1), (40, 40), (41, 40), (60, 40), (140, 40)])
@pytest.mark.parametrize("condition", [10.0, 1e6])
def test_least_squares_equal_the_pseudo_inverse(rows: int, columns: int, condition: float) -> None:
    """Also of equations whose condition number squared leaves no digit."""
    matrix, right = _equations(rows, columns, condition)
    expected = np.linalg.pinv(matrix, rcond=1e-14) @ right
    solution = solve_least_squares(np.asfortranarray(matrix), right.copy())
    assert np.abs(solution - expected).max() < 1e-13 * condition * np.abs(expected).max()


def test_first_rows_that_are_dependent() -> None:
    """The first n equations alone have no solution; row interchanges take the others."""
    matrix, right = _equations(60, 40, 10.0)
    matrix[:20] = matrix[0]
    expected = np.linalg.pinv(matrix, rcond=1e-14) @ right
    solution = solve_least_squares(np.asfortranarray(matrix), right.copy())
    assert np.linalg.matrix_rank(matrix) == 40 > np.linalg.matrix_rank(matrix[:40])
    assert np.abs(solution - expected).max() < 1e-11 * np.abs(expected).max()


def test_dependent_columns_are_refused() -> None:
    """An exact zero pivot has no solution that is one."""
    with pytest.raises(np.linalg.LinAlgError, match="linearly dependent"):
        solve_least_squares(np.zeros((5, 3), dtype=np.complex128, order="F"), np.ones((5, 1), dtype=np.complex128))
