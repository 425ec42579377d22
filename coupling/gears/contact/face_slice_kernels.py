"""Compiled deflections of coupled slices, see :mod:`gearwhine.coupling.gears.contact.face_slices`.

Importing this module imports numba.
"""

import numpy as np

from gearwhine.numerics.arrays import BoolArray, FloatArray, IndexArray
from gearwhine.numerics.compiled import FUSED, counted, inner, uncounted

# The arguments of `deflect_pair` after its row.
Slices = tuple[
    FloatArray, FloatArray, BoolArray, float, float, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray
]


@inner(fastmath=FUSED)
def deflect(
    base: FloatArray,
    touching: BoolArray,
    flattening: float,
    link: float,
    pair: int,
    row: int,
    fields: FloatArray,
    factors: FloatArray,
) -> bool:
    """Turn the fields of load per width of a pair, ``fields[row]`` (n, m), into its deflections.

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
                fields[row, i, k] += factors[1, i - 1] * fields[row, i - 1, k]
        if not pivot > 0.0:
            return False
        factors[0, i] = 1.0 / pivot
        factors[1, i] = link * factors[0, i]
    for k in range(m):
        fields[row, n - 1, k] *= factors[0, n - 1]
    for i in range(n - 2, -1, -1):
        for k in range(m):
            fields[row, i, k] = factors[0, i] * fields[row, i, k] + factors[1, i] * fields[row, i + 1, k]
    return True


@inner(fastmath=FUSED)
def deflect_pair(
    pair: int,
    row: int,
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
    """Find a row of the last arrays for one pair, see `deflect_under_motions`."""
    n, m = motions.shape[1], motions.shape[2]
    own = pair if motions.shape[0] > 1 else 0
    for i in range(n):
        flat = flattening if touching[pair, i] else 0.0
        fields[row, i, 0] = -flat * gap[pair, i]
        for k in range(m):
            fields[row, i, 1 + k] = flat * motions[own, i, k]
    if not deflect(base, touching, flattening, link, pair, row, fields, factors):
        return False
    for j in range(m):
        constants[row, j] = 0.0
        for k in range(j + 1):
            slopes[row, j, k] = 0.0
    for i in range(n):
        fields[row, i, 0] = -gap[pair, i] - fields[row, i, 0]
        for k in range(m):
            fields[row, i, 1 + k] = motions[own, i, k] - fields[row, i, 1 + k]
        if touching[pair, i]:
            for j in range(m):
                moved = flattening * motions[own, i, j]
                constants[row, j] += moved * fields[row, i, 0]
                for k in range(j + 1):
                    slopes[row, j, k] += moved * fields[row, i, 1 + k]
    for j in range(m):
        for k in range(j):
            slopes[row, k, j] = slopes[row, j, k]
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
    motions : ndarray, shape (p, n, m) or (1, n, m)
        Motions of each pair, or of all.
    fields : ndarray, shape (p, n, 1 + m)
        Takes what the flattening yields without motion, ``-gap - w_0``, then that of each motion, B - W.
    slopes, constants : ndarray, shape (p, m, m) and (p, m)
        Take Bᵀ k_h (B - W), symmetric, and -Bᵀ k_h (gap + w_0), sums over the touching slices [N/m per m].

    Returns
    -------
    bool
        Whether the deflections are bounded.
    """
    factors = np.empty((2, gap.shape[1]))
    for place in range(pairs.size):
        arrays = (base, gap, touching, flattening, link, motions, fields, slopes, constants, factors)
        if not deflect_pair(pairs[place], pairs[place], *arrays):
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


@counted(fastmath=FUSED, no_cpython_wrapper=True)
def condense(total: FloatArray, shared: FloatArray, condensed: FloatArray) -> None:
    """Condense a tangent (a + k, a + k) onto its first a motions: the others yield to their loads, by ``shared``."""
    own, k = condensed.shape[0], shared.shape[0]
    resisting, yielding = np.empty((k, k)), np.empty((k, own))
    for i in range(k):
        for j in range(k):
            resisting[i, j] = 1.0 if i == j else 0.0
            for between in range(k):
                resisting[i, j] += shared[i, between] * total[own + between, own + j]
        for j in range(own):
            yielding[i, j] = 0.0
            for between in range(k):
                yielding[i, j] += shared[i, between] * total[own + between, j]
    solve_in_place(resisting, yielding)
    for i in range(own):
        for j in range(own):
            condensed[i, j] = total[i, j]
            for between in range(k):
                condensed[i, j] -= total[own + between, i] * yielding[between, j]


@counted(fastmath=FUSED)
def condense_all(first: IndexArray, width: float, slopes: FloatArray, shared: FloatArray, tangents: FloatArray) -> None:
    """Sum what resists the pairs of each mesh, ``slopes`` of `deflect_under_motions`, into ``tangents``, condensed."""
    total = np.empty((slopes.shape[1], slopes.shape[1]))
    for mesh in range(first.size - 1):
        for i in range(total.shape[0]):
            for j in range(total.shape[0]):
                total[i, j] = 0.0
                for pair in range(first[mesh], first[mesh + 1]):
                    total[i, j] += width * slopes[pair, i, j]
        condense(total, shared, tangents[mesh])


@uncounted(fastmath=FUSED)
def mean_at_even_loads(tangents: FloatArray, even: FloatArray, by_force: FloatArray, by_shape: FloatArray) -> float:
    """Find the means over meshes that carry one load, whatever their approach, of how they yield.

    Parameters
    ----------
    tangents : ndarray, shape (m, a, a)
        Derivatives K of the loads of each mesh by its approaches.
    even : ndarray, shape (a,)
        c.
    by_force, by_shape : ndarray, shape (a,) and (a, a)
        Take the means of K c / κ, with κ = cᵀ K c, and of K - K c cᵀ K / κ.

    Returns
    -------
    float
        Mean of 1 / κ.
    """
    meshes, size = tangents.shape[0], tangents.shape[1]
    compliance = 0.0
    for i in range(size):
        by_force[i] = 0.0
        for j in range(size):
            by_shape[i, j] = 0.0
    for mesh in range(meshes):
        kappa = 0.0
        for i in range(size):
            for j in range(size):
                kappa += even[i] * tangents[mesh, i, j] * even[j]
        compliance += 1.0 / (kappa * meshes)
        for i in range(size):
            pull = 0.0
            for j in range(size):
                pull += tangents[mesh, i, j] * even[j]
            by_force[i] += pull / (kappa * meshes)
            for j in range(size):
                other = 0.0
                for k in range(size):
                    other += tangents[mesh, j, k] * even[k]
                by_shape[i, j] += (tangents[mesh, i, j] - pull * other / kappa) / meshes
    return compliance


@inner(fastmath=FUSED)
def shaped_gap(
    begin: int,
    end: int,
    gap: FloatArray,
    meeting: BoolArray,
    motions: FloatArray,
    shape: FloatArray,
    shaped: FloatArray,
) -> float:
    """Set the gap of a mesh's pairs less an approach, and return the least where slices meet; infinite without any."""
    nearest = np.inf
    for pair in range(begin, end):
        own = pair if motions.shape[0] > 1 else 0
        for i in range(gap.shape[1]):
            shaped[pair, i] = gap[pair, i]
            for j in range(shape.size):
                shaped[pair, i] -= motions[own, i, j] * shape[j]
            if meeting[pair, i] and shaped[pair, i] < nearest:
                nearest = shaped[pair, i]
    return nearest


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
                    spring = base[pair, i] * flattening / (base[pair, i] + flattening)
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


@inner(fastmath=FUSED)
def touch_as_before(begin: int, end: int, before: int, meeting: BoolArray, touching: BoolArray) -> None:
    """Set the slices that touch to those of the pairs ``before`` places from them, where they meet."""
    for pair in range(begin, end):
        for i in range(meeting.shape[1]):
            touching[pair, i] = touching[pair + before, i] and meeting[pair, i]


@inner(fastmath=FUSED)
def sum_pairs(
    begin: int,
    end: int,
    shift: int,
    width: float,
    known: BoolArray,
    slices: Slices,
    total: FloatArray,
    at_rest: FloatArray,
) -> bool:
    """Sum what resists a mesh's pairs over them, with the deflections of those that are not known yet.

    ``total`` and ``at_rest`` take the sums of its slopes and constants over the face. Returns whether
    the deflections are bounded.
    """
    slopes, constants = slices[7], slices[8]
    size = at_rest.size
    for j in range(size):
        at_rest[j] = 0.0
        for k in range(size):
            total[j, k] = 0.0
    for pair in range(begin, end):
        row = pair + shift
        if not known[pair]:
            if not deflect_pair(pair, row, *slices):
                return False
            known[pair] = True
        for j in range(size):
            at_rest[j] += width * constants[row, j]
            for k in range(size):
                total[j, k] += width * slopes[row, j, k]
    return True


@inner(fastmath=FUSED)
def reduce_to_compression(
    total: FloatArray, at_rest: FloatArray, even: FloatArray, whole: FloatArray, constant: FloatArray
) -> None:
    """Reduce what resists a mesh to its compression, which comes first, and its shared deflections.

    ``whole`` (1 + k, 1 + k) and ``constant`` (1 + k) take cᵀ K c, cᵀ K and K, and the forces at rest likewise.
    """
    own, size = even.size, constant.size
    constant[0] = 0.0
    for j in range(size):
        whole[0, j] = 0.0
        whole[j, 0] = 0.0
    for j in range(own):
        constant[0] += even[j] * at_rest[j]
        for k in range(own):
            whole[0, 0] += even[j] * total[j, k] * even[k]
        for k in range(1, size):
            whole[0, k] += even[j] * total[j, own + k - 1]
    for j in range(1, size):
        constant[j] = at_rest[own + j - 1]
        whole[j, 0] = whole[0, j]
        for k in range(1, size):
            whole[j, k] = total[own + j - 1, own + k - 1]


@inner(fastmath=FUSED)
def solve_compression(
    force: float, whole: FloatArray, constant: FloatArray, shared: FloatArray, resisting: FloatArray, answer: FloatArray
) -> None:
    """Find the compression of a mesh under a force, and minus its shared deflections, ``answer[:, 0]``.

    The shared deflections are the shared compliance times the loads on them. ``answer[:, 1]`` takes the derivatives by
    the force.
    """
    size = constant.size
    for k in range(size):
        resisting[0, k] = whole[0, k]
    answer[0, 0], answer[0, 1] = force - constant[0], 1.0
    for j in range(1, size):
        answer[j, 0], answer[j, 1] = 0.0, 0.0
        for between in range(1, size):
            answer[j, 0] -= shared[j - 1, between - 1] * constant[between]
        for k in range(size):
            resisting[j, k] = 1.0 if j == k else 0.0
            for between in range(1, size):
                resisting[j, k] += shared[j - 1, between - 1] * whole[between, k]
    solve_in_place(resisting, answer)


@inner(fastmath=FUSED)
def excess_of_slices(
    begin: int,
    end: int,
    shift: int,
    meeting: BoolArray,
    fields: FloatArray,
    motion: FloatArray,
    excess: FloatArray,
) -> bool:
    """Find how far the slices of a mesh are pressed into each other; returns whether any that meet are."""
    carries = False
    for pair in range(begin, end):
        row = pair + shift
        for i in range(meeting.shape[1]):
            pressed = fields[row, i, 0]
            for j in range(motion.size):
                pressed += motion[j] * fields[row, i, 1 + j]
            excess[pair, i] = pressed
            carries |= meeting[pair, i] and pressed > 0.0
    return carries


@inner(fastmath=FUSED)
def nearest_alone(
    begin: int,
    end: int,
    gap: FloatArray,
    meeting: BoolArray,
    motions: FloatArray,
    shape: FloatArray,
    pressed: FloatArray,
) -> None:
    """Set ``pressed`` to 1 at the nearest slices of a mesh, and to 0 at the others."""
    nearest = shaped_gap(begin, end, gap, meeting, motions, shape, pressed)
    for pair in range(begin, end):
        for i in range(gap.shape[1]):
            pressed[pair, i] = 1.0 if pressed[pair, i] <= nearest else 0.0


@inner(fastmath=FUSED)
def update_touching(
    begin: int, end: int, meeting: BoolArray, pressed: FloatArray, touching: BoolArray, known: BoolArray
) -> bool:
    """Let those slices touch that meet and are pressed into each other; returns whether it was these before."""
    settled = True
    for pair in range(begin, end):
        for i in range(meeting.shape[1]):
            touches = meeting[pair, i] and pressed[pair, i] > 0.0
            if touches != touching[pair, i]:
                touching[pair, i] = touches
                known[pair] = False
                settled = False
    return settled


@inner(fastmath=FUSED)
def load_slices(
    begin: int,
    end: int,
    shift: int,
    gap: FloatArray,
    touching: BoolArray,
    flattening: float,
    fields: FloatArray,
    rate: FloatArray,
    line_load: FloatArray,
    line_tangent: FloatArray,
) -> tuple[float, float, float]:
    """Turn the excess of a mesh's slices, ``line_load``, into loads per width, with their derivatives.

    Returns the sum of the loads per width, the least of them, and the sum of their products with the gaps.
    """
    carried, least, closed = 0.0, 0.0, 0.0
    for pair in range(begin, end):
        row = pair + shift
        for i in range(gap.shape[1]):
            by_compression = 0.0
            for j in range(rate.size):
                by_compression += rate[j] * fields[row, i, 1 + j]
            line_tangent[pair, i] = flattening * by_compression if touching[pair, i] else 0.0
            line_load[pair, i] = flattening * line_load[pair, i] if touching[pair, i] else 0.0
            carried += line_load[pair, i]
            closed += line_load[pair, i] * gap[pair, i]
            least = min(least, line_load[pair, i])
    return carried, least, closed


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
    even: FloatArray,
    shape: FloatArray,
    shared: FloatArray,
    force: FloatArray,
    rounds: tuple[int, int],
    known: BoolArray,
    fields: FloatArray,
    slopes: FloatArray,
    constants: FloatArray,
    line_load: FloatArray,
    line_tangent: FloatArray,
    results: FloatArray,
    loads: FloatArray,
    tangents: FloatArray,
) -> int:
    """Find the slices that touch in m meshes under their loads, one mesh after the other.

    Parameters
    ----------
    first : ndarray of int, shape (m + 1,)
        First pair of each mesh, and the number of pairs p.
    base, gap, meeting, touching : ndarray, shape (p, n)
        See :class:`gearwhine.coupling.gears.contact.face_slices.SlicedMeshes`. ``touching`` is where the search starts
        unless it has rounds of `touch_alone`, and takes the slices in contact.
    flattening, link, width : float
        k_h, T over the square of a slice's width [N/m per m], and that width [m].
    motions : ndarray, shape (p, n, a + k) or (1, n, a + k)
        B: approaches of each pair, or of all, and the shapes of the shared deflections.
    even, shape : ndarray, shape (a,)
        Approach that is 1 all over the face, and the approach but for the compression [m].
    shared : ndarray, shape (k, k)
        Shared compliance [m/N].
    force : ndarray, shape (m,)
        Loads [N].
    rounds : tuple of int
        Most rounds of the search, and those of `touch_alone` before it. Then a mesh starts from the one before, where
        it has as many pairs.
    known : ndarray of bool, shape (p,)
        Pairs whose rows of the next three arrays are those of ``touching``.
    fields, slopes, constants : ndarray
        See `deflect_under_motions`; of as many pairs as a mesh has at most, where they are not kept.
    line_load, line_tangent : ndarray, shape (p, n)
        Take the load per width and its derivative by compression, as of `FaceLoads`.
    results : ndarray, shape (6, m)
        Takes the compression [m] and its derivative by the load [m/N], the energy of teeth and shared deflections [J],
        the sum of the slices' loads [N], the least load per width [N/m], and the stiffness without shared deflections
        [N/m].
    loads : ndarray, shape (m, a + k)
        Takes the loads conjugate to the motions [N, N m].
    tangents : ndarray, shape (m, a, a)
        Takes their derivatives by the approaches; none where its length is 0.

    Returns
    -------
    int
        0, 1 where the slices do not settle, or 2 where they yield without bound.
    """
    all_motions, own_motions = motions.shape[2], shape.size
    size = 1 + all_motions - own_motions
    kept = fields.shape[0] >= gap.shape[0]
    factors = np.empty((2, gap.shape[1]))
    whole, resisting, answer = np.empty((size, size)), np.empty((size, size)), np.empty((size, 2))
    total, at_rest = np.empty((all_motions, all_motions)), np.empty(all_motions)
    constant, motion, rate = np.empty(size), np.empty(all_motions), np.empty(all_motions)
    slices = (base, gap, touching, flattening, link, motions, fields, slopes, constants, factors)
    for mesh in range(force.size):
        begin, end = first[mesh], first[mesh + 1]
        # Row of a pair's deflections, less its number.
        shift = 0 if kept else -begin
        if rounds[1] > 0:
            before = first[mesh - 1] if mesh > 0 else end
            if mesh > 0 and begin - before == end - begin:
                touch_as_before(begin, end, before - begin, meeting, touching)
            else:
                shaped_gap(begin, end, gap, meeting, motions, shape, line_load)
                line_force = force[mesh] / width
                touch_alone(begin, end, base, line_load, meeting, touching, flattening, line_force, rounds[1])
        settled = False
        for _ in range(rounds[0]):
            if not sum_pairs(begin, end, shift, width, known, slices, total, at_rest):
                return 2
            for j in range(all_motions):
                for k in range(own_motions):
                    at_rest[j] += total[j, k] * shape[k]
            reduce_to_compression(total, at_rest, even, whole, constant)
            if whole[0, 0] > 0.0:
                solve_compression(force[mesh], whole, constant, shared, resisting, answer)
            else:
                answer[0, 0] = shaped_gap(begin, end, gap, meeting, motions, shape, line_load)
                for j in range(1, size):
                    answer[j, 0] = 0.0
            for j in range(own_motions):
                motion[j] = shape[j] + even[j] * answer[0, 0]
            for j in range(1, size):
                motion[own_motions + j - 1] = answer[j, 0]
            pressed = line_load
            if not excess_of_slices(begin, end, shift, meeting, fields, motion, line_load):
                # At least the nearest slice carries.
                pressed = line_tangent
                nearest_alone(begin, end, gap, meeting, motions, shape, pressed)
            settled = update_touching(begin, end, meeting, pressed, touching, known)
            if settled:
                break
        if not settled:
            return 1
        for j in range(own_motions):
            rate[j] = even[j]
        for j in range(1, size):
            rate[own_motions + j - 1] = answer[j, 1] / answer[0, 1]
        work = 0.0
        for j in range(all_motions):
            loads[mesh, j] = at_rest[j]
            for k in range(all_motions):
                loads[mesh, j] += total[j, k] * (motion[k] - shape[k] if k < own_motions else motion[k])
            if j < own_motions:
                work += loads[mesh, j] * motion[j]
        carried, least, closed = load_slices(
            begin, end, shift, gap, touching, flattening, fields, rate, line_load, line_tangent
        )
        results[0, mesh], results[1, mesh] = answer[0, 0], answer[0, 1]
        results[2, mesh] = 0.5 * (work - width * closed)
        results[3, mesh], results[4, mesh], results[5, mesh] = width * carried, least, whole[0, 0]
        if tangents.shape[0]:
            condense(total, shared, tangents[mesh])
    return 0
