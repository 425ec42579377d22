"""Compiled Gram-Schmidt orthonormalisation of shaft fields in mass, for `rotors.planar_basis`.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from .compiled import inner, uncounted

FloatArray = npt.NDArray[np.float64]


@inner(error_model="python")
def _product(motion: FloatArray, one: int, other: int, mass: FloatArray) -> float:
    total = 0.0
    for i in range(mass.size):
        total += mass[i] * motion[one, i] * motion[other, i]
    return total


@uncounted(error_model="python")
def mass_orthonormal(motion: FloatArray, strain: FloatArray, shapes: FloatArray, mass: FloatArray, least: float) -> int:
    """Make rows of ``motion`` (k, g) orthonormal under the weights ``mass`` (g,) in place, combining the others alike.

    Rows reduced below the part ``least`` of their norm are dropped, the rest moved up; returns the number left.
    """
    kept = 0
    for row in range(motion.shape[0]):
        source, left = row, 1.0
        # First normalised, then orthogonalised twice, because of rounding.
        for turn in range(3):
            for other in range(kept if turn else 0):
                overlap = _product(motion, other, kept, mass)
                for rows in (motion, strain, shapes):
                    for i in range(rows.shape[1]):
                        rows[kept, i] -= overlap * rows[other, i]
            norm = math.sqrt(_product(motion, source, source, mass))
            left = left * norm if turn else norm
            if left <= (least if turn else 0.0):
                left = 0.0
                break
            for rows in (motion, strain, shapes):
                for i in range(rows.shape[1]):
                    rows[kept, i] = rows[source, i] / norm
            source, left = kept, left if turn else 1.0
        if left > 0.0:
            kept += 1
    return kept
