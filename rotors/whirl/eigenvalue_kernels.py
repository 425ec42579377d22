"""Compiled whirl eigenvalues: perturbation by damping for starting values, Newton iteration, and tests of eigenvalues.

The second-order perturbation is derived in `gearwhine.rotors.whirl.modal_projection`, the iteration for each root by
itself in `gearwhine.rotors.whirl.eigenvalues`. The tests decide whether eigenvalues oscillate, are separated, or lie
inside a sector. Importing this module imports numba.
"""

import cmath
import math

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.banded_kernels import TINY, adjoint, factor, fill, forward_back, orthonormalise, put
from gearwhine.numerics.compiled import FUSED, counted, inner, uncounted
from gearwhine.rotors.certificate import ACCEPTED, MOST_STEPS, SETTLED
from gearwhine.rotors.whirl.shooting_matrix_kernels import Pattern, Table, force_unit, put_entries, scratch

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.intp]

# Relative step above which slopes are recomputed.
STALE = 1e-4
# Relative step above which a step is shortened: its start is not near a root.
LONGEST_STEP = 0.3
# Relative step below which the existing factors serve for the next step.
CLOSE = 1e-6
# Largest correction of the vector in that step: its remaining error is a few times the square of the correction.
TURNED = 1e-7
# Relative step of the forward difference for slopes of the entries, accurate to about 1e-6.
FORWARD = 1e-6


@inner(error_model="python")
def logarithm(value: complex) -> complex:
    """Return ln λ; minus infinity for zero."""
    return complex(math.log(abs(value)), math.atan2(value.imag, value.real))


@counted(error_model="python")
def ascending(values: ComplexArray, least: float, angle: float) -> ComplexArray:
    """Values above the real axis by more than a small angle [rad] and larger than ``least``, by ascending modulus."""
    selected, sizes, count = np.empty(values.size, dtype=np.complex128), np.empty(values.size), 0
    for k in range(values.size):
        size = abs(values[k])
        # Both are false for NaN.
        if not (size > least and values[k].imag > angle * size):
            continue
        place = count
        while place > 0 and sizes[place - 1] > size:
            selected[place], sizes[place] = selected[place - 1], sizes[place - 1]
            place -= 1
        selected[place], sizes[place] = values[k], size
        count += 1
    return selected[:count].copy()


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


@inner(error_model="python", fastmath=FUSED)
def forms(
    rows: IntArray,
    columns: IntArray,
    values: ComplexArray,
    slopes: ComplexArray,
    left: ComplexArray,
    right: ComplexArray,
) -> tuple[complex, complex]:
    """Compute yᴴ N x and yᴴ N' x; the varying entries come first."""
    top, bottom = 0.0j, 0.0j
    for entry in range(slopes.size):
        both = np.conj(left[rows[entry]]) * right[columns[entry]]
        top += both * values[entry]
        bottom += both * slopes[entry]
    for entry in range(slopes.size, values.size):
        top += np.conj(left[rows[entry]]) * right[columns[entry]] * values[entry]
    return top, bottom


@counted(error_model="python")
def newton(
    starts: ComplexArray,
    start_vectors: ComplexArray,
    bases: ComplexArray,
    rate: complex,
    mass: float,
    table: Table,
    pattern: Pattern,
) -> tuple[ComplexArray, ComplexArray, FloatArray, FloatArray]:
    """Newton's method from starting values (w,) and vectors (w or more, order).

    The speed of rotation is Ω = base + rate λ, with one base for all or one for each, the unit of force the inertia
    force of a ``mass``. Returned are roots (w,), vectors (w, order), the last correction as a part of the root, (w,),
    and the unit of force in each vector, (w,).

    Close to a root one step reuses the factors of the last: with N the matrix at the new place and F the factored one,
    x ← x − F⁻¹ N x reduces the vector's error by the relative change of the root (Neumaier, SIAM J. Numer. Anal. 22,
    1985). A vector from factors belongs to the place where they were made: it has converged only if the root has not
    moved from there.
    """
    rows, columns, envelope, lower, upper = pattern
    order = envelope.shape[0]
    beams, rods, values, varying = scratch(table, rows.size)
    slopes = np.empty(varying, dtype=np.complex128)
    matrix = np.empty((order, 2 * lower + upper + 1), dtype=np.complex128)
    left, side = np.empty((1, order), dtype=np.complex128), np.empty(order, dtype=np.complex128)
    pivots, ends = np.empty(order, dtype=np.intp), np.empty(order, dtype=np.intp)
    count = starts.size
    roots, vectors = np.empty(count, dtype=np.complex128), np.empty((count, order), dtype=np.complex128)
    residuals, scales = np.empty(count), np.empty(count)
    for root in range(count):
        at, base, last, reuse = starts[root], bases[root % bases.size], math.inf, False
        residuals[root], right = math.inf, vectors[root : root + 1]
        put(start_vectors[root], right[0])
        for _ in range(MOST_STEPS):
            scale = scales[root] if reuse else force_unit(at, mass)
            scales[root] = scale
            put_entries(at, base + rate * at, scale, table, beams, rods, values)
            # Slopes of the last step serve for a root that has hardly moved: they do not enter the residual.
            if last > STALE:
                ahead = at * (1.0 + FORWARD)
                put_entries(ahead, base + rate * ahead, scale, table, beams, rods, slopes)
                over = 1.0 / (ahead - at)
                for entry in range(varying):
                    slopes[entry] = (slopes[entry] - values[entry]) * over
            turned = 0.0
            if reuse:
                # The factors of the last step correct the vector.
                for i in range(order):
                    side[i] = 0.0
                for entry in range(rows.size):
                    side[rows[entry]] += values[entry] * right[0, columns[entry]]
                forward_back(matrix, lower, envelope, pivots, ends, side)
                along = 0.0j
                for i in range(order):
                    along += np.conj(right[0, i]) * side[i]
                for i in range(order):
                    change = side[i] - along * right[0, i]
                    turned += change.real**2 + change.imag**2
                    right[0, i] -= change
                orthonormalise(right)
            else:
                largest = fill(rows, columns, lower, values, matrix)
                factor(matrix, lower, envelope, pivots, ends, TINY * largest)
                put(right[0], left[0])
                adjoint(matrix, lower, envelope, pivots, ends, left[0])
                orthonormalise(left)
                put(left[0], right[0])
                forward_back(matrix, lower, envelope, pivots, ends, right[0])
                orthonormalise(right)
                put(right[0], left[0])
                adjoint(matrix, lower, envelope, pivots, ends, left[0])
                orthonormalise(left)
            top, bottom = forms(rows, columns, values, slopes, left[0], right[0])
            change = -top / bottom if bottom != 0.0 else complex(math.inf, 0.0)
            share = abs(change) / abs(at)
            if share > LONGEST_STEP:
                change = LONGEST_STEP * abs(at) * cmath.exp(1j * cmath.phase(change))
            # Only rounding moves a converged root: it keeps its value of the last good step.
            rounding = share < ACCEPTED and share >= 0.5 * last
            if not rounding and cmath.isfinite(change):
                at += change
            # Estimated error after the step, from the decrease of the last two steps.
            forecast = math.inf
            if share < math.sqrt(ACCEPTED) and 0.0 < last < 1.0:
                forecast = share**2 * (1.0 / last if reuse else max(1.0, share / last**2)) + STALE * share
            residuals[root] = share if rounding else min(share, forecast)
            # Old factors serve one step: a root that has not converged by then gets new ones.
            reused, reuse, last = reuse, not reuse and share <= CLOSE, share
            if turned <= TURNED**2 and (rounding or share <= SETTLED or (reused and forecast <= SETTLED)):
                break
        roots[root] = at
    return roots, vectors, residuals, scales


@inner(error_model="python")
def _project(matrix: FloatArray, motions: FloatArray, spare: FloatArray, out: FloatArray) -> None:
    """Compute ½ MᵀDM of motions M (n, N) into ``out`` (N, N); ``spare`` (n, N) is scratch space for DM."""
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
    """Compute CᵀC at every speed, (speeds, N, N)."""
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
    """Compute λ and conjugates at every speed, (speeds, 2N), and the coupling of the lower half by damping, (speeds,).

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
