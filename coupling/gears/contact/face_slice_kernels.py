"""Compiled deflections of coupled slices, see :mod:`gearwhine.coupling.gears.contact.face_slices`.

Importing this module imports numba.
"""

import numpy as np

from gearwhine.numerics.arrays import BoolArray, FloatArray, IndexArray
from gearwhine.numerics.compiled import FUSED, counted, inner


@inner(fastmath=FUSED)
def deflect(
    base: FloatArray,
    touching: BoolArray,
    flattening: float,
    link: float,
    pair: int,
    fields: FloatArray,
    factors: FloatArray,
) -> bool:
    """Turn the fields of load per width of a pair, ``fields[pair]`` (n, m), into its deflections.

    ``link`` is T over the square of a slice's width. The matrix is tridiagonal, symmetric and diagonally dominant, so
    that elimination needs no pivots; ``factors`` (2, n) takes those of its rows. Returns whether it is positive
    definite.
    """
    n, m = fields.shape[1], fields.shape[2]
    for i in range(n):
        neighbours = (1.0 if i > 0 else 0.0) + (1.0 if i < n - 1 else 0.0)
        pivot = base[pair, i] + (flattening if touching[pair, i] else 0.0) + link * neighbours
        if i > 0:
            pivot -= link * factors[1, i - 1]
            for k in range(m):
                fields[pair, i, k] += factors[1, i - 1] * fields[pair, i - 1, k]
        if not pivot > 0.0:
            return False
        factors[0, i] = 1.0 / pivot
        factors[1, i] = link * factors[0, i]
    for k in range(m):
        fields[pair, n - 1, k] *= factors[0, n - 1]
    for i in range(n - 2, -1, -1):
        for k in range(m):
            fields[pair, i, k] = factors[0, i] * fields[pair, i, k] + factors[1, i] * fields[pair, i + 1, k]
    return True


@counted(fastmath=FUSED)
def deflect_all(base: FloatArray, touching: BoolArray, flattening: float, link: float, fields: FloatArray) -> bool:
    """Turn fields of load per width of p pairs, (p, n, m), into their deflections; returns whether all are bounded."""
    factors = np.empty((2, fields.shape[1]))
    bounded = True
    for pair in range(fields.shape[0]):
        bounded &= deflect(base, touching, flattening, link, pair, fields, factors)
    return bounded


@counted(fastmath=FUSED)
def deflect_under_motions(
    pairs: IndexArray,
    base: FloatArray,
    gap: FloatArray,
    touching: BoolArray,
    flattening: float,
    link: float,
    motions: FloatArray,
    fields: FloatArray,
    slopes: FloatArray,
    constants: FloatArray,
) -> bool:
    """Find the deflections of some pairs whose flanks move like ``motions`` B (n, m) times y, and what resists them.

    Parameters
    ----------
    pairs : ndarray of int, shape (c,)
        Pairs to find; the rows of the others stay.
    base, gap, touching : ndarray, shape (p, n)
        See :func:`gearwhine.coupling.gears.contact.face_slices.face_loads`.
    flattening, link : float
        k_h, and T over the square of a slice's width [N/m per m].
    motions : ndarray, shape (n, m)
    fields : ndarray, shape (p, n, 1 + m)
        Takes the deflection without motion w_0, then that of each motion W, ``w = w_0 + W y``.
    slopes, constants : ndarray, shape (p, m, m) and (p, m)
        Take Bᵀ k_h (B - W) and Bᵀ k_h (gap + w_0), sums over the touching slices [N/m per m].

    Returns
    -------
    bool
        Whether the deflections are bounded.
    """
    n, m = motions.shape
    factors = np.empty((2, n))
    for place in range(pairs.size):
        pair = pairs[place]
        for i in range(n):
            flat = flattening if touching[pair, i] else 0.0
            fields[pair, i, 0] = -flat * gap[pair, i]
            for k in range(m):
                fields[pair, i, 1 + k] = flat * motions[i, k]
        if not deflect(base, touching, flattening, link, pair, fields, factors):
            return False
        for j in range(m):
            constants[pair, j] = 0.0
            for k in range(m):
                slopes[pair, j, k] = 0.0
        for i in range(n):
            if touching[pair, i]:
                apart = gap[pair, i] + fields[pair, i, 0]
                for j in range(m):
                    moved = flattening * motions[i, j]
                    constants[pair, j] += moved * apart
                    for k in range(m):
                        slopes[pair, j, k] += moved * (motions[i, k] - fields[pair, i, 1 + k])
    return True
