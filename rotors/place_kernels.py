"""Compiled tests of eigenvalues: oscillating or not, separated or not, inside a sector or not.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from .compiled import counted, inner, uncounted

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
BoolArray = npt.NDArray[np.bool_]


@inner(error_model="python")
def logarithm(value: complex) -> complex:
    """ln λ, of zero minus infinity."""
    return complex(math.log(abs(value)), math.atan2(value.imag, value.real))


@counted(error_model="python")
def ascending(values: ComplexArray, least: float, angle: float) -> ComplexArray:
    """Values that lie above the real axis by more than an angle (small, rad), larger than ``least``, by their size."""
    kept, sizes, count = np.empty(values.size, dtype=np.complex128), np.empty(values.size), 0
    for k in range(values.size):
        size = abs(values[k])
        # Neither holds of what is no number.
        if not (size > least and values[k].imag > angle * size):
            continue
        place = count
        while place > 0 and sizes[place - 1] > size:
            kept[place], sizes[place] = kept[place - 1], sizes[place - 1]
            place -= 1
        kept[place], sizes[place] = values[k], size
        count += 1
    return kept[:count].copy()


@uncounted(error_model="python")
def are_apart(values: ComplexArray, tolerance: float) -> bool:
    """Whether no two values are nearer than a part of either's size."""
    for i in range(values.size):
        for j in range(i):
            if abs(values[i] - values[j]) <= tolerance * max(abs(values[i]), abs(values[j])):
                return False
    return True


@uncounted(error_model="python")
def are_done(values: ComplexArray, residuals: FloatArray, accepted: float, tolerance: float) -> bool:
    """Whether no residual exceeds what is accepted, and no two values are nearer than a part of either's size."""
    for residual in residuals:
        if not residual <= accepted:
            return False
    return are_apart(values, tolerance)


@uncounted(error_model="python")
def inside(values: ComplexArray, bounds: FloatArray, out: BoolArray) -> None:
    """Which of the values lie in a sector of the bounds that `edge_distance` takes."""
    for k in range(values.size):
        out[k] = edge_distance(logarithm(values[k]), bounds) < 0.0


@inner(error_model="python")
def edge_distance(place: complex, bounds: FloatArray) -> float:
    """How far ln λ lies from the edge of a sector, negative inside; along the axes, the larger part.

    ``bounds`` are the least and the greatest ln |λ| and arg λ, in this order.
    """
    across: float = max(bounds[0] - place.real, place.real - bounds[1])
    along: float = max(bounds[2] - place.imag, place.imag - bounds[3])
    return max(across, along)
