"""Eigenvalues refined on the exact equations, with their vectors; clusters together, duplicates recognised.

With the equations N(λ) x = 0 of `rotors.spatial_chain`, let X and Y span the right and left singular vectors of the
k smallest singular values of N(σ), k the number of roots near σ. Projected on them the equations are
Y^H [N(σ) + (λ − σ) N'(σ)] X q = 0 up to second order in λ − σ, a small eigenproblem that gives all k roots at once,
double ones and nearly double ones with all their digits: a determinant would keep only half. For k = 1 this is
Newton's method on the two-sided Rayleigh functional,

    λ ← λ − (yᴴ N x) / (yᴴ N' x),

whose error is squared at every step (Schwetlick and Schreiber, Linear Algebra Appl. 436, 2012). Roots of a cluster
that turn out to lie apart are then refined one by one; those that do not, and would blur each other's vectors,
stay together, where what is left out, the square of their distance, is below rounding.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import linalg

from .spatial_chain import SLOPE_STEP, SpatialChain

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
Speed = Callable[[ComplexArray], ComplexArray]

# Starting values nearer than this are refined together first, as their errors may be as large.
NEAR = 1e-3
# Refined roots nearer than this stay together: the square of it is below rounding.
TIED = 1e-7
# Refined roots nearer than this with parallel vectors are one root found twice.
SAME = 1e-9
SETTLED = 2e-14
ACCEPTED = 1e-11
MOST_STEPS = 14
# A step larger than this part of the root starts from nowhere near it, and is shortened.
LONGEST_STEP = 0.3


@dataclass(frozen=True)
class ExactRoots:
    """Roots of the exact equations of one chain.

    Attributes
    ----------
    eigenvalues
        (w,) complex, rad/s.
    solutions
        (w, order) complex: right null vectors, of unit norm in the scaled unknowns.
    residuals
        (w,): the last correction, as a part of the root.
    """

    eigenvalues: ComplexArray
    solutions: ComplexArray
    residuals: FloatArray

    def take(self, index: npt.NDArray[np.intp] | npt.NDArray[np.bool_]) -> "ExactRoots":
        """Some of the roots."""
        return ExactRoots(self.eigenvalues[index], self.solutions[index], self.residuals[index])

    def joined(self, other: "ExactRoots") -> "ExactRoots":
        """These roots and then those."""
        return ExactRoots(
            np.concatenate([self.eigenvalues, other.eigenvalues]),
            np.concatenate([self.solutions, other.solutions]),
            np.concatenate([self.residuals, other.residuals]),
        )


def constant_speed(speed: float) -> Speed:
    """Speed of rotation that does not follow the root."""
    return lambda eigenvalues: np.full(eigenvalues.shape, complex(speed))


def synchronous_speed(eigenvalues: ComplexArray) -> ComplexArray:
    """Speed of rotation at which a root is synchronous, Ω = −iλ: the frequency itself where λ = iω."""
    return -1j * eigenvalues


def refine_roots(chain: SpatialChain, starts: ComplexArray, speed: Speed) -> ExactRoots:
    """Exact roots near starting values; fewer than those where several lead to one root, or one to none.

    Parameters
    ----------
    chain
        The exact equations.
    starts
        (w,) complex, rad/s.
    speed
        Speed of rotation as an analytic function of λ.
    """
    order = chain.pattern.order
    random = np.random.default_rng(1991)
    first = random.standard_normal((starts.size, order)) + 1j * random.standard_normal((starts.size, order))
    alone: list[tuple[complex, ComplexArray]] = []
    settled: list[ExactRoots] = []
    for members in clusters(starts, NEAR):
        if members.size == 1:
            alone.append((starts[members[0]], first[members[0]]))
            continue
        values, vectors, _ = _together(chain, starts[members], first[members], speed, steps=3)
        for nearer in clusters(values, TIED):
            if nearer.size == 1:
                alone.append((values[nearer[0]], vectors[nearer[0]]))
            else:
                tied = _together(chain, values[nearer], vectors[nearer], speed, steps=MOST_STEPS)
                settled.append(ExactRoots(*tied))
    if alone:
        settled.append(_singly(chain, np.array([a[0] for a in alone]), np.array([a[1] for a in alone]), speed))
    if not settled:
        return ExactRoots(np.zeros(0, complex), np.zeros((0, order), complex), np.zeros(0))
    roots = settled[0]
    for more in settled[1:]:
        roots = roots.joined(more)
    return distinct(roots.take(roots.residuals <= ACCEPTED))


def clusters(values: ComplexArray, tolerance: float) -> list[npt.NDArray[np.intp]]:
    """Indices of values that chains of distances below ``tolerance`` of their modulus connect."""
    near = np.abs(values[:, None] - values) <= tolerance * np.abs(values)[:, None]
    label = np.arange(values.size)
    for i in range(values.size):
        joined = np.unique(label[near[i] | near[:, i]])
        label[np.isin(label, joined)] = joined[0] if joined.size else label[i]
    return [np.flatnonzero(label == one) for one in np.unique(label)]


def distinct(roots: ExactRoots) -> ExactRoots:
    """Each root once: equal values are several roots only where their vectors are independent."""
    kept: list[int] = []
    for i, value in enumerate(roots.eigenvalues):
        rivals = [k for k in kept if abs(roots.eigenvalues[k] - value) <= SAME * abs(value)]
        if rivals:
            basis = np.linalg.qr(roots.solutions[rivals].T)[0]
            rest = roots.solutions[i] - basis @ (basis.conj().T @ roots.solutions[i])
            if np.linalg.norm(rest) < 1e-3:
                continue
        kept.append(i)
    return roots.take(np.array(kept, dtype=np.intp))


def equations_at(
    chain: SpatialChain, eigenvalues: ComplexArray, speed: Speed, scale: FloatArray
) -> tuple[ComplexArray, ComplexArray]:
    """Entries of N and of dN/dλ at every λ, (b, nnz) both."""
    step = SLOPE_STEP * np.abs(eigenvalues)
    ahead, behind = (
        chain.values(shifted, speed(shifted), scale) for shifted in (eigenvalues + step, eigenvalues - step)
    )
    return chain.values(eigenvalues, speed(eigenvalues), scale), (ahead - behind) / (2.0 * step[:, None])


def _singly(chain: SpatialChain, values: ComplexArray, vectors: ComplexArray, speed: Speed) -> ExactRoots:
    values, vectors = values.copy(), vectors.copy()
    residuals = np.full(values.size, np.inf)
    active = np.arange(values.size)
    for step in range(MOST_STEPS):
        if active.size == 0:
            break
        at = values[active]
        scale = chain.force_scale(at)
        entries, slopes = equations_at(chain, at, speed, scale)
        right, left = chain.pattern.null_vectors(entries, vectors[active][:, None], 2 if step == 0 else 1)
        top = chain.pattern.forms(entries, left, right)[:, 0, 0]
        bottom = chain.pattern.forms(slopes, left, right)[:, 0, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            change = np.where(bottom != 0.0, -top / bottom, np.inf)
        share = np.abs(change) / np.abs(at)
        long = share > LONGEST_STEP
        change = np.where(long, LONGEST_STEP * np.abs(at) * np.exp(1j * np.angle(change)), change)
        change = np.where(np.isfinite(change), change, 0.0)
        vectors[active] = right[:, 0]
        # Rounding alone moves a settled root: it stays where its last good step brought it.
        rounding = (share < ACCEPTED) & (share >= 0.5 * residuals[active])
        values[active] = np.where(rounding, at, at + change)
        residuals[active] = share
        done = rounding | (share <= SETTLED)
        active = active[~done]
    return ExactRoots(values, vectors, residuals)


def _together(
    chain: SpatialChain, values: ComplexArray, vectors: ComplexArray, speed: Speed, steps: int
) -> tuple[ComplexArray, ComplexArray, FloatArray]:
    """All roots of one cluster by the small eigenproblem about their mean; values, vectors and residuals."""
    basis = vectors[None]
    change = np.full(values.size, np.inf)
    for step in range(steps):
        centre = np.array([values.mean()])
        scale = chain.force_scale(centre)
        entries, slopes = equations_at(chain, centre, speed, scale)
        right, left = chain.pattern.null_vectors(entries, basis, 3 if step == 0 else 1)
        top, bottom = (chain.pattern.forms(matrix, left, right)[0] for matrix in (entries, slopes))
        offsets, mixture = linalg.eig(top, -bottom)
        if not np.isfinite(offsets).all():
            break
        found = centre[0] + offsets
        change = np.abs(np.sort_complex(found) - np.sort_complex(values)) / np.abs(found)
        values, basis = found, right
        if change.max() <= SETTLED * 5.0 and step > 0:
            break
    if not np.isfinite(offsets).all():
        return values, basis[0], np.full(values.size, np.inf)
    mixed = mixture.T @ basis[0]
    mixed /= np.linalg.norm(mixed, axis=1, keepdims=True)
    return values, mixed, np.maximum(change, np.abs(offsets / values) ** 2)
