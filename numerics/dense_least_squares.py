"""Dense least squares of slightly more equations than unknowns, by an LU factorisation with row interchanges.

``P A = [L₁; L₂] U`` takes half the work of a QR factorisation where A is nearly square. The pivots choose rows that
make L well conditioned, so that ``min ‖A x − b‖`` is solved as ``min ‖L y − P b‖``, ``U x = y``, without the square of
A's condition number: G. Peters and J. H. Wilkinson, "The least squares problem and pseudo-inverses", The Computer
Journal 13 (1970), 309-316. With ``w = L₁ y`` and ``B = L₂ L₁⁻¹`` few equations are left for the few other rows:

``min ‖w − b₁‖² + ‖B w − b₂‖²``, ``w = b₁ + Bᴴ (I + B Bᴴ)⁻¹ (b₂ − B b₁)``
"""

import numpy as np
from scipy import linalg
from scipy.linalg import blas, lapack

from gearwhine.numerics.arrays import ComplexArray


def solve_least_squares(matrix: ComplexArray, right: ComplexArray) -> ComplexArray:
    """Return x of ``min ‖A x − b‖`` for each right side; both arguments are overwritten.

    Parameters
    ----------
    matrix : ndarray of complex, shape (m, n)
        A, with m ≥ n, in Fortran order.
    right : ndarray of complex, shape (m, k)
        b.

    Returns
    -------
    ndarray of complex, shape (n, k)

    Raises
    ------
    numpy.linalg.LinAlgError
        Where the columns of A are linearly dependent to the last digit.
    """
    rows, count = matrix.shape
    factors, interchanges, failed = lapack.zgetrf(matrix, overwrite_a=True)
    if failed:
        raise np.linalg.LinAlgError("the columns of the equations are linearly dependent")
    for place, other in enumerate(interchanges):
        right[[place, other]] = right[[other, place]]
    others = np.asfortranarray(factors[count:])
    square = _upper_rows(factors)
    first, second = right[:count], right[count:]
    if rows > count:
        others = blas.ztrsm(1.0, square, others, side=1, lower=1, diag=1, overwrite_b=True)
        normal = np.eye(rows - count) + others @ others.conj().T
        first = first + others.conj().T @ linalg.solve(normal, second - others @ first, assume_a="pos")
    solution = blas.ztrsm(1.0, square, np.asfortranarray(first), lower=1, diag=1, overwrite_b=True)
    return np.ascontiguousarray(blas.ztrsm(1.0, square, solution, overwrite_b=True))


def _upper_rows(factors: ComplexArray) -> ComplexArray:
    """Move the first n rows of an array of shape (m, n) in Fortran order together, in place of a copy."""
    rows, count = factors.shape
    if rows == count:
        return factors
    flat = factors.ravel(order="K")
    for column in range(1, count):
        flat[column * count : (column + 1) * count] = flat[column * rows : column * rows + count]
    return flat[: count * count].reshape(count, count, order="F")
