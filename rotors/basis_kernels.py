"""Compiled orthonormalisation of fields in mass, for `rotors.planar_basis`.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt
from numba import njit

FloatArray = npt.NDArray[np.float64]


@njit(cache=True, nogil=True)
def mass_orthonormal(motion: FloatArray, strain: FloatArray, shapes: FloatArray, mass: FloatArray, least: float) -> int:
    """Make rows of ``motion`` (k, g) orthonormal under the weights ``mass`` (g,) in place, and the others with them.

    Rows of which less than the part ``least`` is left are dropped, and the rest moved up; returns how many are left.
    """
    kept = 0
    for row in range(motion.shape[0]):
        total = 0.0
        for i in range(mass.size):
            total += mass[i] * motion[row, i] ** 2
        if total == 0.0:
            continue
        _put(motion, row, kept, math.sqrt(total))
        _put(strain, row, kept, math.sqrt(total))
        _put(shapes, row, kept, math.sqrt(total))
        left = 1.0
        # Again, for the rounding that the first time leaves.
        for _ in range(2):
            for other in range(kept):
                overlap = 0.0
                for i in range(mass.size):
                    overlap += mass[i] * motion[other, i] * motion[kept, i]
                _take(motion, other, kept, overlap)
                _take(strain, other, kept, overlap)
                _take(shapes, other, kept, overlap)
            total = 0.0
            for i in range(mass.size):
                total += mass[i] * motion[kept, i] ** 2
            left *= math.sqrt(total)
            if left <= least:
                break
            _put(motion, kept, kept, math.sqrt(total))
            _put(strain, kept, kept, math.sqrt(total))
            _put(shapes, kept, kept, math.sqrt(total))
        if left > least:
            kept += 1
    return kept


@njit(cache=True, nogil=True)
def _put(rows: FloatArray, source: int, target: int, size: float) -> None:
    for i in range(rows.shape[1]):
        rows[target, i] = rows[source, i] / size


@njit(cache=True, nogil=True)
def _take(rows: FloatArray, source: int, target: int, part: float) -> None:
    for i in range(rows.shape[1]):
        rows[target, i] -= part * rows[source, i]
