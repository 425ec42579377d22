"""Coalescing eigenvalues, where Newton's method slows down: all roots inside a circle by contour integrals (Beyn).

Where cross-coupling is just as large as the bearings' anisotropy allows, forward and backward whirl meet in one root
with one shape: a defective pair. Under a perturbation each root moves as its square root, but their mean as the
perturbation itself. Beyn's integrals (Linear Algebra Appl. 436, 2012)

    A₀ = (1/2πi) ∮ N(λ)⁻¹ V dλ,    A₁ = (1/2πi) ∮ (λ − c) N(λ)⁻¹ V dλ

over a circle that holds k roots have rank k and give them as the eigenvalues of Uᴴ A₁ W Σ⁻¹, with A₀ = U Σ Wᴴ; the
trapezoidal rule on a circle converges geometrically.
"""

import numpy as np
import numpy.typing as npt
from scipy import linalg

from .certificate import ACCEPTED
from .exact_roots import (
    ExactRoots,
    Speed,
    apart,
    clusters,
    converged_roots,
    distinct,
    random_vectors,
    refine_alone,
)
from .spatial_chain import WhirlEquations

ComplexArray = npt.NDArray[np.complex128]

# Radii of circles tried about a place, as parts of it.
CIRCLES = (0.03, 0.006, 0.1)
POINTS = 48
MOST_INSIDE = 8
# Singular values below this part of the largest count as zero.
RANK = 1e-9
# Roots closer than this are treated together.
ONE_ROOT = 1e-3
# Roots closer than this cannot be resolved: they are set to their mean, whose error is the square of this.
UNRESOLVED = 3e-8
# Rounding moves either of two roots by this over their distance.
ROUNDING = 1e-15
# The narrow circle's radius about them, as a part of them.
CLOSE = 3e-3
# A refined root may differ from the integral's by this part of the circle's radius.
SAME_PLACE = 1e-3


def refine_roots(chain: WhirlEquations, starts: ComplexArray, speed: Speed) -> ExactRoots:
    """Exact roots near starting values; fewer where several lead to one root, or one to none.

    Parameters
    ----------
    chain
        The exact equations.
    starts
        (w,) complex, rad/s.
    speed
        Speed of rotation as an analytic function of λ.
    """
    roots, crawling = converged_roots(chain, starts, speed)
    if crawling.size == 0:
        return roots
    for place in clusters(crawling, CIRCLES[0]):
        roots = with_circle(chain, roots, complex(crawling[place].mean()), speed)
    return distinct(roots)


def with_circle(chain: WhirlEquations, roots: ExactRoots, centre: complex, speed: Speed) -> ExactRoots:
    """The roots, with those about a place replaced by the roots of contour integrals."""
    for part in CIRCLES:
        radius = part * abs(centre)
        found = roots_in_circle(chain, centre, radius, speed)
        if found is not None:
            known = found.take(np.isfinite(found.residuals))
            return distinct(roots.take(np.abs(roots.eigenvalues - centre) > radius).joined(known))
    return roots


def roots_in_circle(chain: WhirlEquations, centre: complex, radius: float, speed: Speed) -> ExactRoots | None:
    """All roots within ``radius`` of ``centre``, rad/s; None where the circle passes too near one, or holds too many.

    The second vector of a coalesced pair is a principal vector: the pair has one shape.
    """
    turn = np.exp(2j * np.pi * (np.arange(POINTS) + 0.5) / POINTS)
    around = centre + radius * turn
    scale = np.full(POINTS, chain.force_scale(np.array([centre]))[0])
    values = chain.values(around, speed(around), scale)
    phases = chain.entries.log_determinants(around, speed(around), scale).imag
    steps = np.diff(np.append(phases, phases[0]))
    steps -= 2.0 * np.pi * np.round(steps / (2.0 * np.pi))
    count = round(float(steps.sum()) / (2.0 * np.pi))
    if np.abs(steps).max() > 1.0 or not 0 < count <= MOST_INSIDE:
        return None
    sides = random_vectors(count, chain.pattern.order)
    solved = chain.pattern.solve(values, np.broadcast_to(sides, (POINTS, *sides.shape)))
    zeroth = np.einsum("b,bko->ok", turn, solved) / POINTS
    first = np.einsum("b,bko->ok", turn**2, solved) / POINTS
    left, sizes, right = np.linalg.svd(zeroth, full_matrices=False)
    if sizes[-1] <= RANK * sizes[0]:
        return None
    offsets, mixture = linalg.eig(left.conj().T @ first @ right.conj().T / sizes)
    found = centre + radius * offsets
    vectors = (left @ mixture).T
    roots = ExactRoots(found, vectors, np.full(count, np.inf), np.full(count, scale[0]))
    parts = [_settled(chain, roots.take(group), left, radius, speed) for group in clusters(found, ONE_ROOT)]
    whole = parts[0]
    for part in parts[1:]:
        whole = whole.joined(part)
    return whole


def _settled(chain: WhirlEquations, roots: ExactRoots, span: ComplexArray, radius: float, speed: Speed) -> ExactRoots:
    """Roots of one group refined one by one, or kept together at their mean where they are not resolved."""
    polished = refine_alone(chain, roots.eigenvalues, roots.solutions, speed)
    moved = np.abs(polished.eigenvalues - roots.eigenvalues)
    near = (polished.residuals <= ACCEPTED) & (moved <= SAME_PLACE * radius)
    if near.all() and apart(polished.eigenvalues, ACCEPTED):
        return polished
    mean = complex(roots.eigenvalues.mean())
    spread = np.abs(roots.eigenvalues - mean) / abs(mean)
    # Roots just outside a circle disturb the integrals by (radius / distance)^48: a narrow circle avoids them.
    narrow = abs(mean) * max(CLOSE, 5.0 * float(spread.max()))
    if narrow < 0.5 * radius:
        again = roots_in_circle(chain, mean, narrow, speed)
        if again is not None and again.eigenvalues.size == roots.eigenvalues.size:
            return again
    if spread.size == 1 or spread.max() > ONE_ROOT:
        return roots  # with infinite residuals: not converged
    # Independent vectors of the space that belongs to the group: the shape, and principal vectors.
    projected = span.conj().T @ roots.solutions.T
    basis = span @ np.linalg.qr(projected)[0]
    if spread.max() <= UNRESOLVED:
        return ExactRoots(np.full(spread.size, mean), basis.T, spread**2, roots.scales)
    return ExactRoots(roots.eigenvalues, basis.T, ROUNDING / spread, roots.scales)
