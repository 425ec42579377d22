"""Low-rank matrices: the common subspace in which several square matrices act."""

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

_ROUNDING = 1e-13  # part of a matrix's largest singular value that is rounding


def common_span(matrices: list[FloatArray]) -> tuple[FloatArray, list[FloatArray]]:
    """Orthonormal directions U in which all the matrices act, M = U (Uᵀ M U) Uᵀ, and their cores Uᵀ M U.

    Returns
    -------
    directions : ndarray, shape (n, r)
    cores : list of ndarray, shape (r, r)
    """
    scaled = [matrix / scale for matrix in matrices if (scale := float(np.abs(matrix).max(initial=0.0))) > 0.0]
    n = len(matrices[0])
    if not scaled:
        return np.zeros((n, 0)), [np.zeros((0, 0)) for _ in matrices]
    # Coordinates without any entry have no part in the decomposition.
    touched = np.any([np.any(matrix, axis=0) | np.any(matrix, axis=1) for matrix in scaled], axis=0)
    among = np.ix_(touched, touched)
    left, sizes, _ = np.linalg.svd(np.hstack([part for m in scaled for part in (m[among], m[among].T)]))
    count = int(np.count_nonzero(sizes > _ROUNDING * sizes[0]))
    directions = np.zeros((n, count))
    directions[touched] = left[:, :count]
    return directions, [directions.T @ matrix @ directions for matrix in matrices]
