"""Whirl eigenvalues by Newton's method on the exact equations, and by contour integrals where they coalesce.

Roots of a cluster are refined together, and duplicates are recognised. With the equations N(λ) x = 0 of
`gearwhine.rotors.whirl.equations`, let X and Y span the right and left singular vectors of the k smallest singular
values of N(σ), k the number of roots near σ. Projected on them the equations are Y^H [N(σ) + (λ − σ) N'(σ)] X q = 0 up
to second order in λ − σ, a small eigenproblem that gives all k roots at once, double ones and nearly double ones with
all their digits: a determinant would keep only half. For k = 1 this is Newton's method on the two-sided Rayleigh
functional,

    λ ← λ − (yᴴ N x) / (yᴴ N' x),

whose error is squared at every step (Schwetlick and Schreiber, Linear Algebra Appl. 436, 2012). Roots of a cluster
that are found to be separated are then refined one by one. Those that are not, whose vectors would mix, stay together;
the neglected terms, of the order of the square of their distance, are below rounding.

Newton's method slows down at coalescing eigenvalues. Where cross-coupling is just as large as the bearings' anisotropy
allows, forward and backward whirl meet in one root with one shape: a defective pair. Under a perturbation each root
moves as its square root, but their mean as the perturbation itself. Beyn's integrals (Linear Algebra Appl. 436, 2012)
give all roots inside a circle:

    A₀ = (1/2πi) ∮ N(λ)⁻¹ V dλ,    A₁ = (1/2πi) ∮ (λ − c) N(λ)⁻¹ V dλ

over a circle that holds k roots have rank k and give them as the eigenvalues of Uᴴ A₁ W Σ⁻¹, with A₀ = U Σ Wᴴ; the
trapezoidal rule on a circle converges geometrically.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from scipy import linalg

from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.rotors.certificate import ACCEPTED, MOST_STEPS, SETTLED
from gearwhine.rotors.whirl.equations import WhirlEquations

# Relative distance below which starting values are refined together first: their errors may be as large.
NEAR = 1e-3
# Relative distance below which refined roots stay together: its square is below rounding.
TIED = 1e-7
# Relative distance below which refined roots with parallel vectors are one root, found twice.
SAME = 1e-9
PARALLEL = 1e-3
# Relative step of the central difference for slopes of the entries: accurate to about 1e-10. The refined roots lose
# nothing by it, as their residual is exact.
SLOPE_STEP = 1e-5
NO_PLACES = np.zeros(0, dtype=np.complex128)


@dataclass(frozen=True)
class Speed:
    """Speed of rotation Ω = base + rate λ [rad/s]: an analytic function of the root.

    Attributes
    ----------
    base : complex or ndarray of complex
        Constant part of the speed [rad/s]; a number, or one for each root, (w,).
    rate : complex
        Slope of the speed over the root [rad/s per rad/s].
    """

    base: complex | ComplexArray
    rate: complex = 0.0

    def __call__(self, eigenvalues: ComplexArray) -> ComplexArray:
        """Evaluate Ω at every λ, (w,)."""
        return np.asarray(self.base + self.rate * eigenvalues, dtype=np.complex128)


@dataclass(frozen=True)
class ExactRoots:
    """Eigenvalues of one set of exact equations, with their vectors.

    Attributes
    ----------
    eigenvalues : ndarray of complex, shape (w,)
        Eigenvalues [rad/s].
    solutions : ndarray of complex, shape (w, order)
        Right null vectors, of unit norm in the scaled unknowns.
    residuals : ndarray, shape (w,)
        Last relative correction of each root.
    scales : ndarray, shape (w,)
        Unit of forces in each solution.
    """

    eigenvalues: ComplexArray
    solutions: ComplexArray
    residuals: FloatArray
    scales: FloatArray

    def take(self, index: npt.NDArray[np.intp] | npt.NDArray[np.bool_]) -> "ExactRoots":
        """Return selected roots."""
        return ExactRoots(self.eigenvalues[index], self.solutions[index], self.residuals[index], self.scales[index])

    def joined(self, other: "ExactRoots") -> "ExactRoots":
        """Join these roots and others."""
        return ExactRoots(
            np.concatenate([self.eigenvalues, other.eigenvalues]),
            np.concatenate([self.solutions, other.solutions]),
            np.concatenate([self.residuals, other.residuals]),
            np.concatenate([self.scales, other.scales]),
        )


# Speed of rotation at which a root is synchronous, Ω = −iλ: the frequency itself where λ = iω.
SYNCHRONOUS = Speed(0.0, -1j)


def constant_speed(speed: float) -> Speed:
    """Speed of rotation that does not follow the root."""
    return Speed(complex(speed))


def converged_roots(equations: WhirlEquations, starts: ComplexArray, speed: Speed) -> tuple[ExactRoots, ComplexArray]:
    """Exact roots near starting values, each once, and the places where the iteration has not converged.

    Parameters
    ----------
    equations : WhirlEquations
        The exact equations.
    starts : ndarray of complex, shape (w,)
        Starting values [rad/s].
    speed : Speed
        Speed of rotation as an analytic function of λ.
    """
    order = equations.pattern.order
    first = random_vectors(starts.size, order)
    if starts.size and apart(starts, NEAR):
        return _accepted(refine_alone(equations, starts, first, speed))
    groups = clusters(starts, NEAR)
    alone: list[tuple[complex, ComplexArray]] = []
    settled: list[ExactRoots] = []
    for members in groups:
        if members.size == 1:
            alone.append((starts[members[0]], first[members[0]]))
            continue
        near = _together(equations, starts[members], first[members], speed, steps=3)
        for nearer in clusters(near.eigenvalues, TIED):
            values, vectors = near.eigenvalues[nearer], near.solutions[nearer]
            if nearer.size == 1:
                alone.append((values[0], vectors[0]))
            else:
                settled.append(_together(equations, values, vectors, speed, steps=MOST_STEPS))
    if alone:
        values, vectors = np.array([one[0] for one in alone]), np.array([one[1] for one in alone])
        settled.append(refine_alone(equations, values, vectors, speed))
    if not settled:
        return ExactRoots(np.zeros(0, complex), np.zeros((0, order), complex), np.zeros(0), np.zeros(0)), starts
    roots = settled[0]
    for more in settled[1:]:
        roots = roots.joined(more)
    return _accepted(roots)


def _accepted(roots: ExactRoots) -> tuple[ExactRoots, ComplexArray]:
    """Return the converged roots, each once, and the values of the others."""
    from gearwhine.rotors.whirl.eigenvalue_kernels import are_converged

    if are_converged(roots.eigenvalues, roots.residuals, ACCEPTED, SAME):
        return roots, NO_PLACES
    good = roots.residuals <= ACCEPTED
    return distinct(roots.take(good)), roots.eigenvalues[~good]


def apart(values: ComplexArray, tolerance: float) -> bool:
    """Whether no two values are closer than ``tolerance`` times their modulus."""
    from gearwhine.rotors.whirl.eigenvalue_kernels import are_apart

    return bool(are_apart(values, tolerance))


def clusters(values: ComplexArray, tolerance: float) -> list[npt.NDArray[np.intp]]:
    """Clusters of values, as indices: single linkage with distances below ``tolerance`` times the modulus."""
    label = np.arange(values.size)
    if apart(values, tolerance):
        return list(label[:, None])
    near = np.abs(values[:, None] - values) <= tolerance * np.abs(values)[:, None]
    for i, j in np.argwhere(near & ~np.eye(values.size, dtype=np.bool_)):
        label[label == label[j]] = label[i]
    order = np.argsort(label, kind="stable")
    edges = np.flatnonzero(np.diff(label[order])) + 1
    return np.split(order, edges) if values.size else []


def distinct(roots: ExactRoots) -> ExactRoots:
    """Each root once: equal values are several roots only where their vectors are independent."""
    if apart(roots.eigenvalues, SAME):
        return roots
    chosen: list[int] = []
    for cluster in clusters(roots.eigenvalues, SAME):
        first = len(chosen)
        for i in cluster.tolist():
            if len(chosen) > first:
                basis = np.linalg.qr(roots.solutions[chosen[first:]].T)[0]
                rest = roots.solutions[i] - basis @ (basis.conj().T @ roots.solutions[i])
                if np.linalg.norm(rest) < PARALLEL:
                    continue
            chosen.append(i)
    return roots.take(np.array(sorted(chosen), dtype=np.intp))


def slopes_at(equations: WhirlEquations, eigenvalues: ComplexArray, speed: Speed, scale: FloatArray) -> ComplexArray:
    """Entries of dN/dλ at every λ, (b, nnz)."""
    step = SLOPE_STEP * np.abs(eigenvalues)
    ahead, behind = (
        equations.values(shifted, speed(shifted), scale) for shifted in (eigenvalues + step, eigenvalues - step)
    )
    return np.asarray((ahead - behind) / (2.0 * step[:, None]))


def refine_each(equations: WhirlEquations, starts: ComplexArray, speeds: FloatArray) -> ExactRoots:
    """Exact roots from starting values, each alone and at its own speed, (w,) both; none is dropped.

    A root that does not converge has a residual above `ACCEPTED`.
    """
    vectors = random_vectors(starts.size, equations.pattern.order)
    return refine_alone(equations, starts, vectors, Speed(speeds.astype(np.complex128)))


def refine_alone(equations: WhirlEquations, starts: ComplexArray, vectors: ComplexArray, speed: Speed) -> ExactRoots:
    """Exact roots from starting values (w,) and vectors (w, order), each by itself; none is dropped."""
    from gearwhine.rotors.whirl.eigenvalue_kernels import newton

    # Arrays of one type, so that the kernel is compiled once: some of those given are read-only.
    starts, vectors = (np.array(given, dtype=np.complex128, order="C") for given in (starts, vectors))
    bases = np.array(speed.base, dtype=np.complex128, ndmin=1)
    matrix = equations.shooting_matrix
    arrays = matrix.arrays, matrix.pattern.arrays
    return ExactRoots(*newton(starts, vectors, bases, complex(speed.rate), equations.total_mass, *arrays))


@lru_cache(maxsize=64)
def random_vectors(count: int, order: int) -> ComplexArray:
    """Reproducible random complex vectors to start iterations from, (count, order), read-only."""
    random = np.random.default_rng(1991)
    vectors = random.standard_normal((count, order)) + 1j * random.standard_normal((count, order))
    vectors.setflags(write=False)
    return np.asarray(vectors)


def _together(
    equations: WhirlEquations, values: ComplexArray, vectors: ComplexArray, speed: Speed, steps: int
) -> ExactRoots:
    """All roots of one cluster by the small eigenproblem about their mean."""
    basis, mixture = vectors[None], np.eye(values.size, dtype=np.complex128)
    change = np.full(values.size, np.inf)
    scale = np.ones(1)
    for step in range(steps):
        centre = np.array([values.mean()])
        scale = equations.force_scale(centre)
        entries = equations.values(centre, speed(centre), scale)
        slopes = slopes_at(equations, centre, speed, scale)
        right, left = equations.pattern.null_vectors(entries, basis, 3 if step == 0 else 1)
        top, bottom = (equations.pattern.forms(matrix, left, right)[0] for matrix in (entries, slopes))
        offsets, mixing = linalg.eig(top, -bottom)
        if not np.isfinite(offsets).all():
            return ExactRoots(values, basis[0], np.full(values.size, np.inf), np.full(values.size, scale[0]))
        eigenvalues = centre[0] + offsets
        moved = np.abs(np.sort_complex(eigenvalues) - np.sort_complex(values)).max() / np.abs(eigenvalues)
        # The small eigenproblem neglects terms of the order of the squared distances.
        change = np.maximum(moved, np.abs(offsets / eigenvalues) ** 2)
        values, basis, mixture = eigenvalues, right, mixing
        if step > 0 and moved.max() <= 5.0 * SETTLED:
            break
    mixed = mixture.T @ basis[0]
    mixed /= np.linalg.norm(mixed, axis=1, keepdims=True)
    return ExactRoots(values, mixed, change, np.full(values.size, scale[0]))


# Radii of the circles tried about a place, relative to it.
CIRCLES = (0.03, 0.006, 0.1)
POINTS = 48
MOST_INSIDE = 8
# Part of the largest singular value below which a singular value counts as zero.
RANK = 1e-9
# Relative distance below which roots are treated together.
ONE_ROOT = 1e-3
# Relative distance below which roots are not resolved: they are set to their mean, whose error is its square.
UNRESOLVED = 3e-8
# Relative move of either of two roots by rounding, times their distance.
ROUNDING = 1e-15
# Radius of the narrow circle about such roots, relative to them.
CLOSE = 3e-3
# Largest difference of a refined root from the integral's, over the circle's radius.
SAME_PLACE = 1e-3


def refine_roots(equations: WhirlEquations, starts: ComplexArray, speed: Speed) -> ExactRoots:
    """Exact roots near starting values; fewer where several lead to one root, or one to none.

    Arguments are those of `converged_roots`.
    """
    roots, crawling = converged_roots(equations, starts, speed)
    if crawling.size == 0:
        return roots
    for place in clusters(crawling, CIRCLES[0]):
        roots = with_circle(equations, roots, complex(crawling[place].mean()), speed)
    return distinct(roots)


def with_circle(equations: WhirlEquations, roots: ExactRoots, centre: complex, speed: Speed) -> ExactRoots:
    """Replace the roots about a place by the roots of contour integrals."""
    for part in CIRCLES:
        radius = part * abs(centre)
        in_circle = roots_in_circle(equations, centre, radius, speed)
        if in_circle is not None:
            resolved = in_circle.take(np.isfinite(in_circle.residuals))
            return distinct(roots.take(np.abs(roots.eigenvalues - centre) > radius).joined(resolved))
    return roots


def roots_in_circle(equations: WhirlEquations, centre: complex, radius: float, speed: Speed) -> ExactRoots | None:
    """All roots within ``radius`` of ``centre`` [rad/s]; None where the circle passes too near one, or holds too many.

    The second vector of a coalesced pair is a principal vector: the pair has one shape.
    """
    turn = np.exp(2j * np.pi * (np.arange(POINTS) + 0.5) / POINTS)
    around = centre + radius * turn
    scale = np.full(POINTS, equations.force_scale(np.array([centre]))[0])
    values = equations.values(around, speed(around), scale)
    phases = equations.shooting_matrix.log_determinants(around, speed(around), scale).imag
    steps = np.diff(np.append(phases, phases[0]))
    steps -= 2.0 * np.pi * np.round(steps / (2.0 * np.pi))
    count = round(float(steps.sum()) / (2.0 * np.pi))
    if np.abs(steps).max() > 1.0 or not 0 < count <= MOST_INSIDE:
        return None
    sides = random_vectors(count, equations.pattern.order)
    solved = equations.pattern.solve(values, np.broadcast_to(sides, (POINTS, *sides.shape)))
    zeroth = np.einsum("b,bko->ok", turn, solved) / POINTS
    first = np.einsum("b,bko->ok", turn**2, solved) / POINTS
    left, sizes, right = np.linalg.svd(zeroth, full_matrices=False)
    if sizes[-1] <= RANK * sizes[0]:
        return None
    offsets, mixture = linalg.eig(left.conj().T @ first @ right.conj().T / sizes)
    eigenvalues = centre + radius * offsets
    vectors = (left @ mixture).T
    roots = ExactRoots(eigenvalues, vectors, np.full(count, np.inf), np.full(count, scale[0]))
    parts = [_settled(equations, roots.take(group), left, radius, speed) for group in clusters(eigenvalues, ONE_ROOT)]
    whole = parts[0]
    for part in parts[1:]:
        whole = whole.joined(part)
    return whole


def _settled(
    equations: WhirlEquations, roots: ExactRoots, span: ComplexArray, radius: float, speed: Speed
) -> ExactRoots:
    """Roots of one group refined one by one, or kept together at their mean where they are not resolved."""
    polished = refine_alone(equations, roots.eigenvalues, roots.solutions, speed)
    moved = np.abs(polished.eigenvalues - roots.eigenvalues)
    near = (polished.residuals <= ACCEPTED) & (moved <= SAME_PLACE * radius)
    if near.all() and apart(polished.eigenvalues, ACCEPTED):
        return polished
    mean = complex(roots.eigenvalues.mean())
    spread = np.abs(roots.eigenvalues - mean) / abs(mean)
    # Roots just outside a circle disturb the integrals by (radius / distance)^48: a narrow circle avoids them.
    narrow = abs(mean) * max(CLOSE, 5.0 * float(spread.max()))
    if narrow < 0.5 * radius:
        again = roots_in_circle(equations, mean, narrow, speed)
        if again is not None and again.eigenvalues.size == roots.eigenvalues.size:
            return again
    if spread.size == 1 or spread.max() > ONE_ROOT:
        return roots  # infinite residuals: not converged
    # Independent vectors of the space that belongs to the group: the shape, and principal vectors.
    projected = span.conj().T @ roots.solutions.T
    basis = span @ np.linalg.qr(projected)[0]
    if spread.max() <= UNRESOLVED:
        return ExactRoots(np.full(spread.size, mean), basis.T, spread**2, roots.scales)
    return ExactRoots(roots.eigenvalues, basis.T, ROUNDING / spread, roots.scales)
