"""Eigensolvers of K φ = λ M φ in shift-invert mode: the choice of one, and scipy's ``eigsh`` (ARPACK).

The default is block Lanczos (:mod:`housing.lanczos`). ARPACK, an implicitly restarted Lanczos method, works on
A = (K - σM)⁻¹ M, which is self-adjoint in the inner product of M and has the eigenvalues ν = 1/(λ - σ). The factor of
K - σM stands behind ``OPinv``, so that it is shared with the inertia certificate. Modes below σ have ν < 0 and are
exactly the smallest algebraic ν; modes above σ have ν > 0 and are the largest.

ARPACK may leave out a copy of a multiple mode without notice; the certificate (:mod:`housing.search`) detects it.
"""

from collections.abc import Callable
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

from housing.errors import IncompleteModesError
from housing.symmetric import Operator

FloatArray = npt.NDArray[np.float64]
Solver = Literal["lanczos", "eigsh"]

DEFAULT_SOLVER: Solver = "lanczos"
"""At least 1.3 times faster than eigsh from factor to certificate, see benchmarks/README.md."""

_LEAST_BASIS = 20  # vectors, ARPACK's own least
_BASIS = 3  # vectors for each mode: with two, the default, restarts cost a third more


def arpack_modes(
    solve: Callable[[FloatArray], FloatArray],
    mass: Operator,
    shift: float,
    count: int,
    *,
    above: bool = False,
    seed: int = 0,
    tolerance: float = 0.0,
) -> tuple[FloatArray, FloatArray]:
    """The modes nearest to a shift on one side of it, by ``scipy.sparse.linalg.eigsh``.

    Parameters
    ----------
    solve, mass, shift, count, above
        As :func:`housing.lanczos.block_lanczos`.
    seed : int
        Of the start vector; each also doubles the basis.
    tolerance : float
        Of a Ritz pair's residual as a part of ν; 0 is rounding.

    Returns
    -------
    values : ndarray, shape (count,)
        λ, ascending [rad²/s²].
    vectors : ndarray, shape (n, count)
        φ, with φᵀ M φ = 1.

    Raises
    ------
    IncompleteModesError
        Where the modes do not converge.
    """
    n = mass.shape[0]
    start = solve(mass @ np.random.default_rng(seed).standard_normal(n))
    try:
        values, vectors = eigsh(
            LinearOperator((n, n), matvec=lambda x: x, dtype=np.float64),  # K itself is not used: OPinv stands for it
            k=count,
            M=LinearOperator((n, n), matvec=lambda x: mass @ x, dtype=np.float64),
            sigma=shift,
            which="SA" if above else "LA",
            v0=start,
            ncv=min(n, max(_BASIS * count, _LEAST_BASIS) * 2**seed),
            tol=tolerance,
            OPinv=LinearOperator((n, n), matvec=solve, dtype=np.float64),
        )
    except ArpackError as error:
        raise IncompleteModesError(
            f"eigsh did not converge to {count} modes ({error}); ask for fewer, move the limit a little or refine the "
            "mesh"
        ) from error
    order = np.argsort(values)
    return values[order], np.asfortranarray(vectors[:, order])
