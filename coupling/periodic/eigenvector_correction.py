r"""Eigenvector perturbation: eigenvectors of a matrix from those of a neighbouring one.

With right vectors X and left ones Y = X⁻¹ of the neighbour, B = Y A X is all but diagonal, and to the first order

    X ← X (1 + E),    Y ← (1 + E)⁻¹ Y,        E_ij = B_ij / (B_jj - B_ii),    i ≠ j,

which squares the error each time. Where eigenvalues are too close for that, the correction fails.

- G. W. Stewart, J. Sun, *Matrix Perturbation Theory*, 1990, chapter V.
"""

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_LARGEST = 0.05  # of E for which it is small
_SMALLEST = 1e-8  # of E: its square is rounding
_ROUNDING = 1e-13  # of the largest eigenvalue
_STEPS = 5
_MISSED = 1e-12  # residual of X and Y, relative to the sizes that they sum


def corrected_eigenvectors(
    matrix: FloatArray, values: ComplexArray, right: ComplexArray, left: ComplexArray
) -> tuple[ComplexArray, ComplexArray, ComplexArray] | None:
    """Eigenvalues and vectors of a real matrix (2 N, 2 N); None where the given ones are too far from them.

    Parameters
    ----------
    matrix : ndarray, shape (2 N, 2 N)
    values : ndarray of complex, shape (m,)
        Of the neighbour, one of each conjugate pair.
    right, left : ndarray of complex, shapes (2 N, m) and (m, 2 N)
        Right vectors that count for both of a pair, and left ones.

    Returns
    -------
    values, right, left
        The same of the matrix, in the same order.
    """
    turning = values.imag > 0.0
    weights = np.where(turning, 2.0, 1.0)
    single = right / weights
    x = np.concatenate([single, single[:, turning].conj()], axis=1)
    y = np.concatenate([left, left[turning].conj()])
    if x.shape[1] != len(matrix):
        return None
    identity, size = np.eye(len(matrix)), np.inf
    for _ in range(_STEPS):
        turned = y @ (matrix @ x)
        found = np.diagonal(turned)
        apart = found[None, :] - found[:, None] + identity
        # Any vectors serve for a multiple eigenvalue: their coupling is rounding.
        coupled = (identity == 0.0) & (np.abs(turned) > _ROUNDING * np.abs(found).max())
        move = np.where(coupled, turned / np.where(apart == 0.0, 1e-300, apart), 0.0)
        size = float(np.abs(move).max())
        if not size < _LARGEST:
            return None
        x = x + x @ move
        y = y - move @ (y - move @ y)
        y = 2.0 * y - y @ (x @ y)  # its inverse to rounding
        if size < _SMALLEST:
            break
    found = np.diagonal(y @ (matrix @ x)).copy()
    missed = np.abs((x * found) @ y - matrix)
    sizes = np.abs(x) @ np.abs(found[:, None] * y)
    if size >= _SMALLEST or np.any(missed > _MISSED * sizes.max()) or np.any(found[: len(values)][turning].imag <= 0.0):
        return None
    kept, vectors, rows = found[: len(values)], x[:, : len(values)], y[: len(values)]
    # Vectors of a real eigenvalue are real but for rounding.
    kept[~turning], vectors[:, ~turning], rows[~turning] = (
        part[...].real for part in (kept[~turning], vectors[:, ~turning], rows[~turning])
    )
    return kept, np.ascontiguousarray(vectors * weights), np.ascontiguousarray(rows)
