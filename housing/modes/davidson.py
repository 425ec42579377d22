"""Block Davidson method: modes from residuals in double precision and a factor that is an approximate inverse.

A factor F of K - σM in single precision is the factor of K - σM + E exactly, with a backward error E of some 1e-7 of
its entries, which beside the smallest eigenvalues is large. A Lanczos recurrence on F⁻¹ M would find the modes of that
pencil. With θ, x a Ritz pair of K and M in a space S, r = K x - θ M x its residual in double precision, and x + e a
mode,

    F⁻¹ r ≈ x + (σ - θ) F⁻¹ M x ≈ -e - (σ - θ) (K - σM)⁻¹ M e.

By the first form S extended by F⁻¹ r is the Krylov space of F⁻¹ M, and the modes converge as they do in block Lanczos;
by the second one each step also removes what E has left in x (Davidson 1975; Morgan and Scott 1986). Only the accuracy
of r limits that of the modes. As long as the space has hardly more vectors than modes are wanted, E does not matter,
and it is extended by F⁻¹ M of its last block, which takes fewer products. Where S is full, it keeps the lowest Ritz
vectors and the last changes of the wanted ones (Knyazev 2001), which costs hardly a step.

A block has sixteen columns, since the direct solver takes as long for eight. Where the memory beside the factor is
short, it has eight, and the space is smaller too.
"""

from collections.abc import Callable

import numpy as np
from scipy import linalg

from gearwhine.housing.fem.linear_algebra import BlockAlgebra, Operator
from gearwhine.housing.fem.memory import available_memory
from gearwhine.numerics.arrays import FloatArray

_BLOCK = 16
_STEPS = 40  # beside those of eight times the number of modes
_CLOSE = 1e-7  # residual below which every correction gains, unless rounding ends it
_WELL_OUTSIDE = 1e-4  # least squared part of a block outside the space, and outside itself, that is orthonormal at once
_WITHIN = 1e-22  # squared part of a column outside the space, below which the column lies in it
_DEPENDENT = 1e-12  # least eigenvalue of a block's correlations before it counts as fewer columns


def davidson_modes(
    stiffness: Operator,
    mass: Operator,
    solve_approximately: Callable[[FloatArray], FloatArray],
    count: int,
    *,
    floor: float,
    tolerance: float,
    seed: int = 0,
    threads: int = 1,
) -> tuple[FloatArray, FloatArray]:
    """Solve for the lowest modes by the block Davidson method.

    Parameters
    ----------
    stiffness, mass : operator, shape (n, n)
        K [N/m] and M [kg].
    solve_approximately : callable
        X from (K - σM) X = Y, shape (n, m) both, with a relative error well below 1; σ next to the modes wanted or
        among them.
    count : int
        Number of modes.
    floor : float
        Eigenvalue that gives rigid modes a scale [rad²/s²].
    tolerance : float
        Bound of |K φ - λ M φ| / ((λ + λ_count + floor) |M φ|). A mode that rounding keeps above it is returned as it
        is: the certificate then tells.
    seed : int
        Seed of the random starting block; each also doubles its width.
    threads : int
        Number of threads of products with the space.

    Returns
    -------
    values : ndarray, shape (count,)
        λ, ascending [rad²/s²].
    vectors : ndarray, shape (n, count)
        φ, with φᵀ M φ = 1; fewer where the starting block has no part in the others.
    """
    n = mass.shape[0]
    width, share = min(_BLOCK * 2**seed, n), 3
    if 8.0 * n * (4 * count + 9 * width) > available_memory():
        width, share = (width + 1) // 2, 2
    kept, most, begin = share * count + width, (share + 1) * count + 4 * width, count + 4 * width
    space = _RitzSpace(stiffness, mass, most, BlockAlgebra(n, threads))
    residuals = np.full(count, np.inf)
    block = np.random.default_rng(seed).standard_normal((n, width))
    block = mass @ block
    for _ in range(_STEPS + 8 * count // width):
        if space.size + block.shape[1] > most:
            space.shrink(kept, count)
        block = solve_approximately(block)
        if not space.extend(block):
            break
        if space.size < begin:
            block = mass @ space.last
            continue
        values, mixture = space.ritz(count)
        scales = np.abs(values) + abs(values[-1]) + floor
        block = np.empty((n, 0))
        while not block.shape[1] and (residuals > tolerance).any():
            # The largest first: those of the modes that wait for a step are the larger ones of the next.
            worst = np.argsort(-residuals, kind="stable")[: min(width, np.count_nonzero(residuals > tolerance))]
            vectors = space.combined(mixture[:, worst])
            forces, inertia = stiffness @ vectors, mass @ vectors
            del vectors
            lengths = np.linalg.norm(inertia, axis=0)
            inertia *= values[worst]
            forces -= inertia
            del inertia
            sizes = np.linalg.norm(forces, axis=0) / (scales[worst] * lengths)
            stalled = (sizes < _CLOSE) & (sizes > residuals[worst])
            residuals[worst] = np.where(stalled, 0.0, sizes)
            block = forces[:, residuals[worst] > tolerance]
            del forces
        if not block.shape[1]:
            break
    values, mixture = space.ritz(count)
    return values, space.combined(mixture)


class _RitzSpace:
    """M-orthonormal basis V of a space, and Vᵀ K V.

    Attributes
    ----------
    size : int
        Number of vectors of V.
    stiffness : ndarray, shape (size, size)
        Vᵀ K V.
    """

    def __init__(self, stiffness: Operator, mass: Operator, most: int, algebra: BlockAlgebra) -> None:
        self._stiffness, self._mass, self._algebra = stiffness, mass, algebra
        # The operating system allocates only the pages that are used.
        self._vectors = np.empty((mass.shape[0], most), order="F")
        self._before = self.size = 0
        self.stiffness = np.empty((0, 0))

    @property
    def last(self) -> FloatArray:
        """Vectors by which the space was last extended, shape (n, r)."""
        return self._vectors[:, self._before : self.size]

    def ritz(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Lowest Ritz values, shape (count,), and their vectors in terms of V, shape (size, count)."""
        values, mixture = linalg.eigh(self.stiffness)
        return values[:count], mixture[:, :count]

    @property
    def _basis(self) -> FloatArray:
        return self._vectors[:, : self.size]

    def combined(self, mixture: FloatArray) -> FloatArray:
        """V m, shape (n, columns of m)."""
        return self._algebra.combined(self._basis, mixture)

    def extend(self, block: FloatArray) -> bool:
        """Extend the space by a block of shape (n, width), which is overwritten; return whether it lay outside.

        K and M are multiplied with the block as it is: of its part outside the space the products follow from those
        with V, unless that part is so small that rounding shows. Then this part is taken as a block once more.
        """
        algebra = self._algebra
        block /= np.linalg.norm(block, axis=0)
        for last in (False, True):
            inertia = self._mass @ block
            within, gram = algebra.products(self._basis, inertia), algebra.products(block, inertia)
            del inertia
            outside = gram - within.T @ within
            parts = outside.diagonal() / gram.diagonal()
            independent = parts > _WITHIN
            lengths = np.sqrt(outside.diagonal()[independent])
            values, turn = linalg.eigh(outside[np.ix_(independent, independent)] / np.outer(lengths, lengths))
            chosen = values > _DEPENDENT
            mixture = np.zeros((len(parts), int(chosen.sum())))
            mixture[independent] = turn[:, chosen] / lengths[:, None] / np.sqrt(values[chosen])
            if last or min(parts.min(), values.min(initial=1.0)) > _WELL_OUTSIDE:
                break
            algebra.subtract(block, self._basis, within)
            block = algebra.combined(block, mixture)
        if not mixture.shape[1]:
            return False
        forces = self._stiffness @ block
        coupling, own = algebra.products(self._basis, forces), algebra.products(block, forces)
        del forces
        shared = within.T @ coupling
        own = mixture.T @ (own - shared - shared.T + within.T @ self.stiffness @ within) @ mixture
        coupling = (coupling - self.stiffness @ within) @ mixture
        algebra.subtract(block, self._basis, within)
        added = algebra.combined(block, mixture)
        self._before, self.size = self.size, self.size + added.shape[1]
        self._vectors[:, self._before : self.size] = added
        self.stiffness = np.block([[self.stiffness, coupling], [coupling.T, 0.5 * (own + own.T)]])
        return True

    def shrink(self, kept: int, count: int) -> None:
        """Keep the lowest Ritz vectors, and the changes of the first ``count`` ones by the last block."""
        mixture = self.ritz(kept)[1]
        changes = mixture[:, :count].copy()
        changes[: self._before] = 0.0
        changes -= mixture @ (mixture.T @ changes)
        changes = np.linalg.svd(changes, full_matrices=False)[0][:, : min(count, self.size - self._before)]
        mixture = np.linalg.qr(np.concatenate([mixture, changes], axis=1))[0]
        self._algebra.replace(self._basis, mixture)
        self.stiffness, self.size = mixture.T @ self.stiffness @ mixture, mixture.shape[1]
