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
    """ln λ; minus infinity for zero."""
    return complex(math.log(abs(value)), math.atan2(value.imag, value.real))


@counted(error_model="python")
def ascending(values: ComplexArray, least: float, angle: float) -> ComplexArray:
    """Values above the real axis by more than a small angle (rad) and larger than ``least``, by ascending modulus."""
    kept, sizes, count = np.empty(values.size, dtype=np.complex128), np.empty(values.size), 0
    for k in range(values.size):
        size = abs(values[k])
        # Both are false for NaN.
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
    """Whether no two values are closer than ``tolerance`` times either's modulus."""
    for i in range(values.size):
        for j in range(i):
            if abs(values[i] - values[j]) <= tolerance * max(abs(values[i]), abs(values[j])):
                return False
    return True


@uncounted(error_model="python")
def are_converged(values: ComplexArray, residuals: FloatArray, accepted: float, tolerance: float) -> bool:
    """Whether no residual exceeds ``accepted`` and no two values are closer than ``tolerance`` times a modulus."""
    for residual in residuals:
        if not residual <= accepted:
            return False
    return are_apart(values, tolerance)


@uncounted(error_model="python")
def inside(values: ComplexArray, bounds: FloatArray, out: BoolArray) -> None:
    """Mark the values inside a sector; ``bounds`` as in `edge_distance`."""
    for k in range(values.size):
        out[k] = edge_distance(logarithm(values[k]), bounds) < 0.0


@inner(error_model="python")
def edge_distance(place: complex, bounds: FloatArray) -> float:
    """Distance of ln λ from the edge of a sector, negative inside: the larger of those along the two axes.

    ``bounds`` are the least and the greatest ln |λ| and arg λ, in this order.
    """
    across: float = max(bounds[0] - place.real, place.real - bounds[1])
    along: float = max(bounds[2] - place.imag, place.imag - bounds[3])
    return max(across, along)
