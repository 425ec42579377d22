"""Directions that turn, compiled: mixing of the constant columns of which they are sums.

The directions of all laws are D(s) = V M(s), V (n, m) constant and M(s) (m, k) with few entries
c + a cos w s + b sin w s, so that only M follows the nominal time s. Deflections are Mᵀ (Vᵀ q), their rates
Mᵀ (Vᵀ q') + s' M'ᵀ (Vᵀ q), the forces f push as V (M f), and the flexibility is Mᵀ (Vᵀ S⁻¹ V) M.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.connector_forces.kernel_arrays import Bearings, Turning
from gearwhine.numerics.compiled import inner, uncounted

FloatArray = npt.NDArray[np.float64]


@inner()
def turn_directions(turning: Turning, nominal_time: float, speed: float, mix: FloatArray, mix_rate: FloatArray) -> None:
    """Entries of M at a nominal time, and their rates s' M', into two arrays (e,)."""
    for w in range(turning.rates.size):
        rate = turning.rates[w]
        angle = rate * nominal_time
        cosine, sine, moved = math.cos(angle), math.sin(angle), rate * speed
        for e in range(turning.first_of_rate[w], turning.first_of_rate[w + 1]):
            a, b = turning.cosine[e], turning.sine[e]
            mix[e] = turning.constant[e] + a * cosine + b * sine
            mix_rate[e] = moved * (b * cosine - a * sine)


@inner()
def mix_columns(turning: Turning, mix: FloatArray, along: FloatArray, out: FloatArray) -> None:
    """Add up Mᵀ x for the projections x (m,) on the columns, into as many directions as ``out`` has."""
    for k in range(out.size):
        out[k] = 0.0
    for e in range(mix.size):
        k = turning.direction[e]
        if k < out.size:
            out[k] += mix[e] * along[turning.column[e]]


@inner()
def push_columns(turning: Turning, mix: FloatArray, push: FloatArray, out: FloatArray) -> None:
    """Add up M f for the forces f (k,), into an array (m,)."""
    for j in range(out.size):
        out[j] = 0.0
    for e in range(mix.size):
        out[turning.column[e]] += mix[e] * push[turning.direction[e]]


@inner(fastmath={"contract"})
def turned_flexibility(
    turning: Turning, mix: FloatArray, of_columns: FloatArray, work: FloatArray, across: FloatArray, out: FloatArray
) -> None:
    """Flexibility Mᵀ H M (k, k) of the directions by that of the columns, H (m, m).

    ``work`` (k, m) and ``across`` (m, k) are overwritten: by Mᵀ H and its transpose, whose rows vectorise.
    """
    for i in range(work.shape[0]):
        for j in range(work.shape[1]):
            work[i, j] = 0.0
        for k in range(out.shape[1]):
            out[i, k] = 0.0
    for e in range(mix.size):
        value, row, of_column = mix[e], work[turning.direction[e]], of_columns[turning.column[e]]
        for j in range(row.size):
            row[j] += value * of_column[j]
    for j in range(across.shape[0]):
        for i in range(across.shape[1]):
            across[j, i] = work[i, j]
    for e in range(mix.size):
        value, row, of_column = mix[e], out[turning.direction[e]], across[turning.column[e]]
        for i in range(row.size):
            row[i] += value * of_column[i]
    for i in range(out.shape[0]):
        for k in range(i):
            out[i, k], out[k, i] = out[k, i], out[i, k]


@uncounted()
def set_laws_at_speed(turning: Turning, bearings: Bearings, speed: float) -> None:
    """Interpolate stiffness and damping of the linear laws that turn linearly at a speed, in place."""
    ratios, last = turning.speed_ratios, turning.speed_ratios.size - 1
    at = 0
    while at < last - 1 and speed > ratios[at + 1]:
        at += 1
    part = min(max((speed - ratios[at]) / (ratios[at + 1] - ratios[at]), 0.0), 1.0)
    for number in range(bearings.damping.shape[0]):
        for i in range(5):
            for j in range(5):
                low, high = turning.linear[at, number, i, j], turning.linear[at + 1, number, i, j]
                bearings.linear[number, i, j] = low + part * (high - low)
                low, high = turning.damping[at, number, i, j], turning.damping[at + 1, number, i, j]
                bearings.damping[number, i, j] = low + part * (high - low)
