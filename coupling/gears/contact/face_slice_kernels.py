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


@inner(fastmath=FUSED)
def deflect_pair(
    pair: int,
    base: FloatArray,
    gap: FloatArray,
    touching: BoolArray,
    flattening: float,
    link: float,
    motions: FloatArray,
    fields: FloatArray,
    slopes: FloatArray,
    constants: FloatArray,
    factors: FloatArray,
) -> bool:
    """Find the row of one pair in the last arrays, see `deflect_under_motions`."""
    n, m = motions.shape
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
    factors = np.empty((2, motions.shape[0]))
    for place in range(pairs.size):
        arrays = (base, gap, touching, flattening, link, motions, fields, slopes, constants, factors)
        if not deflect_pair(pairs[place], *arrays):
            return False
    return True


@inner(fastmath=FUSED)
def solve_in_place(matrix: FloatArray, right: FloatArray) -> None:
    """Solve ``matrix x = right``, (m, m) and (m, k), by elimination with row pivots; both are overwritten, x last."""
    m, k = right.shape
    for step in range(m):
        pivot = step
        for row in range(step + 1, m):
            if abs(matrix[row, step]) > abs(matrix[pivot, step]):
                pivot = row
        for column in range(m):
            matrix[step, column], matrix[pivot, column] = matrix[pivot, column], matrix[step, column]
        for column in range(k):
            right[step, column], right[pivot, column] = right[pivot, column], right[step, column]
        for row in range(step + 1, m):
            factor = matrix[row, step] / matrix[step, step]
            for column in range(step, m):
                matrix[row, column] -= factor * matrix[step, column]
            for column in range(k):
                right[row, column] -= factor * right[step, column]
    for step in range(m - 1, -1, -1):
        for column in range(k):
            for later in range(step + 1, m):
                right[step, column] -= matrix[step, later] * right[later, column]
            right[step, column] /= matrix[step, step]


@inner(fastmath=FUSED)
def touch_alone(
    begin: int,
    end: int,
    base: FloatArray,
    gap: FloatArray,
    meeting: BoolArray,
    touching: BoolArray,
    flattening: float,
    line_force: float,
    rounds: int,
) -> None:
    """Set the slices that touch when uncoupled: a close first guess of the slices that touch when coupled.

    The set of a mesh's pairs shrinks from every slice that could touch to those in contact.
    """
    n = gap.shape[1]
    for pair in range(begin, end):
        for i in range(n):
            touching[pair, i] = meeting[pair, i]
    for _ in range(rounds):
        stiffness, offset = 0.0, 0.0
        for pair in range(begin, end):
            for i in range(n):
                if touching[pair, i]:
                    spring = 1.0 / (1.0 / base[pair, i] + 1.0 / flattening)
                    stiffness += spring
                    offset += spring * gap[pair, i]
        compression = (line_force + offset) / stiffness if stiffness > 0.0 else 0.0
        same = True
        for pair in range(begin, end):
            for i in range(n):
                touches = meeting[pair, i] and gap[pair, i] < compression
                same &= touches == touching[pair, i]
                touching[pair, i] = touches
        if same:
            break


@counted(fastmath=FUSED)
def balance_meshes(
    first: IndexArray,
    base: FloatArray,
    gap: FloatArray,
    meeting: BoolArray,
    touching: BoolArray,
    flattening: float,
    link: float,
    width: float,
    motions: FloatArray,
    shared: FloatArray,
    force: FloatArray,
    rounds: tuple[int, int],
    line_load: FloatArray,
    line_tangent: FloatArray,
    compression: FloatArray,
    whole_stiffness: FloatArray,
) -> int:
    """Find the slices that touch in m meshes under their loads, one mesh after the other.

    Parameters
    ----------
    first : ndarray of int, shape (m + 1,)
        First pair of each mesh, and the number of pairs p.
    base, gap, meeting, touching : ndarray, shape (p, n)
        See :func:`gearwhine.coupling.gears.contact.face_slices.face_equilibrium`. ``touching`` is where the search
        starts unless it has rounds of `touch_alone`, and takes the slices in contact.
    flattening, link, width : float
        k_h, T over the square of a slice's width [N/m per m], and that width [m].
    motions : ndarray, shape (n, 1 + k)
        B: ones, and the shapes of the shared deflections.
    shared : ndarray, shape (k, k)
        Shared compliance [m/N].
    force : ndarray, shape (m,)
        Loads [N].
    rounds : tuple of int
        Most rounds of the search, and those of `touch_alone` before it.
    line_load, line_tangent : ndarray, shape (p, n)
        Take the load per width and its derivative by compression, as of `FaceLoads`.
    compression, whole_stiffness : ndarray, shape (m,)
        Take the compression [m], and the stiffness without shared deflections [N/m].

    Returns
    -------
    int
        0, 1 where the slices do not settle, or 2 where they yield without bound.
    """
    n, size = motions.shape
    pairs = gap.shape[0]
    fields, factors = np.empty((pairs, n, 1 + size)), np.empty((2, n))
    slopes, constants = np.empty((pairs, size, size)), np.empty((pairs, size))
    changed = np.ones(pairs, dtype=np.bool_)
    stiffness, resisting, answer = np.empty((size, size)), np.empty((size, size)), np.empty((size, 2))
    constant = np.empty(size)
    for mesh in range(force.size):
        begin, end = first[mesh], first[mesh + 1]
        if rounds[1] > 0:
            line_force = force[mesh] / width
            touch_alone(begin, end, base, gap, meeting, touching, flattening, line_force, rounds[1])
        nearest = np.inf
        for pair in range(begin, end):
            for i in range(n):
                touching[pair, i] &= meeting[pair, i]
                if meeting[pair, i] and gap[pair, i] < nearest:
                    nearest = gap[pair, i]
        settled = False
        for _ in range(rounds[0]):
            for j in range(size):
                constant[j] = 0.0
                for k in range(size):
                    stiffness[j, k] = 0.0
            for pair in range(begin, end):
                if changed[pair]:
                    arrays = (base, gap, touching, flattening, link, motions, fields, slopes, constants, factors)
                    if not deflect_pair(pair, *arrays):
                        return 2
                for j in range(size):
                    constant[j] += width * constants[pair, j]
                    for k in range(size):
                        stiffness[j, k] += width * slopes[pair, j, k]
            # Motions y of a mesh over its face: its compression, then minus the shared deflections, which are the
            # shared compliance times the loads on them. The second column is their derivative by the compression.
            apart = stiffness[0, 0] <= 0.0
            for j in range(size):
                answer[j, 0] = constant[j] + force[mesh] if j == 0 else 0.0
                answer[j, 1] = 1.0 if j == 0 else 0.0
                for k in range(size):
                    if j == 0:
                        resisting[j, k] = stiffness[j, k]
                        continue
                    resisting[j, k] = 1.0 if j == k else 0.0
                    for between in range(1, size):
                        resisting[j, k] += shared[j - 1, between - 1] * stiffness[between, k]
                if j > 0:
                    for between in range(1, size):
                        answer[j, 0] += shared[between - 1, j - 1] * constant[between]
            if apart:
                for j in range(size):
                    answer[j, 0] = nearest if j == 0 else 0.0
            else:
                solve_in_place(resisting, answer)
            whole_stiffness[mesh] = stiffness[0, 0]
            carries = False
            settled = True
            for pair in range(begin, end):
                changed[pair] = False
                for i in range(n):
                    excess = -gap[pair, i] - fields[pair, i, 0]
                    for j in range(size):
                        excess += answer[j, 0] * (motions[i, j] - fields[pair, i, 1 + j])
                    line_load[pair, i] = excess
                    carries |= meeting[pair, i] and excess > 0.0
            for pair in range(begin, end):
                for i in range(n):
                    touches = meeting[pair, i] and line_load[pair, i] > 0.0
                    # At least the nearest slice carries.
                    if not carries and meeting[pair, i] and gap[pair, i] <= nearest:
                        touches = True
                    if touches != touching[pair, i]:
                        touching[pair, i] = touches
                        changed[pair] = True
                        settled = False
            if settled:
                break
        if not settled:
            return 1
        compression[mesh] = answer[0, 0]
        for pair in range(begin, end):
            for i in range(n):
                rate = 0.0
                for j in range(size):
                    rate += answer[j, 1] / answer[0, 1] * (motions[i, j] - fields[pair, i, 1 + j])
                line_load[pair, i] = flattening * line_load[pair, i] if touching[pair, i] else 0.0
                line_tangent[pair, i] = flattening * rate if touching[pair, i] else 0.0
    return 0


@counted(fastmath=FUSED)
def add_tangents(
    first: IndexArray,
    base: FloatArray,
    touching: BoolArray,
    flattening: float,
    link: float,
    width: float,
    basis: FloatArray,
    shapes: FloatArray,
    tangents: FloatArray,
) -> bool:
    """Find the tangents of m meshes by fields of approach of their pairs: the sums of ``w Bᵀ k_h (B - W)``.

    Parameters
    ----------
    first : ndarray of int, shape (m + 1,)
        First pair of each mesh, and the number of pairs p.
    base, touching : ndarray, shape (p, n)
    flattening, link, width : float
        See `balance_meshes`.
    basis : ndarray, shape (p, n, a)
        Approaches of each pair.
    shapes : ndarray, shape (n, k)
        Approaches of all pairs.
    tangents : ndarray, shape (m, a + k, a + k)
        Takes the sums.

    Returns
    -------
    bool
        Whether the deflections are bounded.
    """
    n, own = basis.shape[1], basis.shape[2]
    size = own + shapes.shape[1]
    motions, fields, factors = np.empty((n, size)), np.empty((1, n, size)), np.empty((2, n))
    for i in range(n):
        for k in range(own, size):
            motions[i, k] = shapes[i, k - own]
    for mesh in range(first.size - 1):
        for j in range(size):
            for k in range(size):
                tangents[mesh, j, k] = 0.0
        for pair in range(first[mesh], first[mesh + 1]):
            for i in range(n):
                for k in range(own):
                    motions[i, k] = basis[pair, i, k]
                for k in range(size):
                    fields[0, i, k] = flattening * motions[i, k] if touching[pair, i] else 0.0
            rows = base[pair : pair + 1], touching[pair : pair + 1]
            if not deflect(rows[0], rows[1], flattening, link, 0, fields, factors):
                return False
            for i in range(n):
                if touching[pair, i]:
                    for j in range(size):
                        pushed = width * flattening * motions[i, j]
                        for k in range(j + 1):
                            tangents[mesh, j, k] += pushed * (motions[i, k] - fields[0, i, k])
        for j in range(size):
            for k in range(j):
                tangents[mesh, k, j] = tangents[mesh, j, k]
    return True
