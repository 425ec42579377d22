"""Compiled second-order perturbation of whirl eigenvalues by damping, for `rotors.whirl.modal_projection`.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from rotors.numerics.compiled import counted, inner

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
BoolArray = npt.NDArray[np.bool_]


@inner(error_model="python")
def _project(matrix: FloatArray, motions: FloatArray, spare: FloatArray, out: FloatArray) -> None:
    """½ MᵀDM of motions M (n, N) into ``out`` (N, N); ``spare`` (n, N) is scratch space for DM."""
    for i in range(matrix.shape[0]):
        for k in range(out.shape[0]):
            spare[i, k] = 0.0
        for j in range(matrix.shape[0]):
            for k in range(out.shape[0]):
                spare[i, k] += matrix[i, j] * motions[j, k]
    for k in range(out.shape[0]):
        for other in range(out.shape[0]):
            out[k, other] = 0.0
    for i in range(matrix.shape[0]):
        for k in range(out.shape[0]):
            for other in range(out.shape[0]):
                out[k, other] += 0.5 * motions[i, k] * spare[i, other]


@counted(error_model="python")
def squares(frequencies: FloatArray, gyroscopic: FloatArray, speeds: FloatArray) -> FloatArray:
    """CᵀC at every speed, (speeds, N, N)."""
    order, (y, x) = frequencies.size, gyroscopic.shape
    whole = np.zeros((speeds.size, order, order))
    for speed in range(speeds.size):
        turning = speeds[speed]
        for k in range(order):
            whole[speed, k, k] = frequencies[k] * frequencies[k]
        for i in range(y):
            for j in range(x):
                coupled = turning * gyroscopic[i, j]
                whole[speed, j, x + i] = whole[speed, x + i, j] = coupled * frequencies[x + i]
                for k in range(x):
                    whole[speed, j, k] += coupled * turning * gyroscopic[i, k]
    return whole


@counted(error_model="python")
def damped(
    squared: FloatArray,
    right: FloatArray,
    frequencies: FloatArray,
    gyroscopic: FloatArray,
    speeds: FloatArray,
    damping_x: FloatArray,
    damping_y: FloatArray,
) -> tuple[ComplexArray, FloatArray]:
    """λ and conjugates at every speed, (speeds, 2N), and how strongly damping couples the lower half, (speeds,).

    ``squared`` (speeds, N) and ``right`` (speeds, N, N) are σ² and V.
    """
    count, order = squared.shape
    x, y = damping_x.shape[0], damping_y.shape[0]
    values, mixed = np.empty((count, 2 * order), dtype=np.complex128), np.zeros(count)
    by_x, by_y = np.empty((order, order)), np.empty((order, order))
    moving, spare, sizes = np.empty((y, order)), np.empty((max(x, y), order)), np.empty(order)
    for speed in range(count):
        for k in range(order):
            sizes[k] = math.sqrt(squared[speed, k])
        # p = C s / σ; the velocities of y come last.
        for i in range(y):
            for k in range(order):
                moving[i, k] = frequencies[x + i] * right[speed, x + i, k]
            for j in range(x):
                for k in range(order):
                    moving[i, k] += speeds[speed] * gyroscopic[i, j] * right[speed, j, k]
            for k in range(order):
                moving[i, k] /= sizes[k]
        _project(damping_x, right[speed, :x], spare, by_x)
        _project(damping_y, moving, spare, by_y)
        for k in range(order):
            shift, most = 0.0, 0.0
            for j in range(order):
                # (A − B)(A − B) has the sign of neither.
                far = (by_x[k, j] - by_y[k, j]) * (by_x[j, k] - by_y[j, k]) / (sizes[k] + sizes[j])
                near = 0.0
                if j != k:
                    apart = sizes[k] - sizes[j]
                    near = (by_x[k, j] + by_y[k, j]) * (by_x[j, k] + by_y[j, k])
                    # Equal frequencies: any coupling mixes them completely.
                    if abs(near) > apart * apart:
                        most, near = math.inf, 0.0
                    elif near != 0.0:
                        most += abs(near) / (apart * apart)
                        near /= apart
                shift += near + far
            values[speed, k] = complex(-by_x[k, k] - by_y[k, k], sizes[k] - shift)
            values[speed, order + k] = values[speed, k].conjugate()
            if k < order // 2:
                mixed[speed] = max(mixed[speed], most)
    return values, mixed
