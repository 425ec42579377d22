"""Block Davidson method: modes from residuals in double precision and a factor that is an approximate inverse.

A factor F of K - σM in single precision is the factor of K - σM + E exactly, with a backward error E of some 1e-7 of
its entries, which beside the smallest eigenvalues is large. A Lanczos recurrence on F⁻¹ M would find the modes of that
pencil. With θ, x a Ritz pair of K and M in a space S, r = K x - θ M x its residual in double precision, and x + e a
mode,

    F⁻¹ r ≈ x + (σ - θ) F⁻¹ M x ≈ -e - (σ - θ) (K - σM)⁻¹ M e.

By the first form S extended by F⁻¹ r is the Krylov space of F⁻¹ M, and the modes converge as they do in block Lanczos;
by the second one each step also removes what E has left in x (Davidson 1975; Morgan and Scott 1986). Only the accuracy
of r limits that of the modes. As long as the Ritz values still move, E is the smaller error: S is extended by F⁻¹ M V
of its last vectors V, whose product with M is at hand, and no residual is computed.

S has the vectors V as the factor gives them, in single precision, which halves their memory: they are no more accurate.
The Ritz vectors are V y, with

    (VᵀK V) y = θ (VᵀM V) y,

where both matrices are products in double precision of the vectors as they are kept. These are orthonormal but for
their rounding, without M, which is enough for the small problem to be well conditioned. Where S is full, it keeps the
lowest Ritz vectors; the rounding of the wanted ones to single precision is kept in vectors of its own.

A block has sixteen columns, since the direct solver and the products with K and M take as long for eight.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import linalg

from gearwhine.housing.fem.linear_algebra import BlockAlgebra
from gearwhine.numerics.arrays import FloatArray

_BLOCK = 16
_STEPS = 40  # beside those of eight times the number of modes
_MOVED = 1e-3  # part of the last Ritz value by which one moves in a step while no residual is worth its products
_CLOSE = 1e-7  # residual below which every correction gains, unless rounding ends it
_WITHIN = 1e-10  # squared length of a vector outside the space, below which it is rounding
_WELL_OUTSIDE = 1e-8  # the same, above which one projection leaves it orthogonal enough


def davidson_modes(
    size: int,
    products: Callable[[npt.NDArray[Any]], tuple[FloatArray, FloatArray]],
    solve_approximately: Callable[[npt.NDArray[np.float32]], npt.NDArray[np.float32]],
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
    size : int
        Number n of degrees of freedom.
    products : callable
        K X [N/m] and M X [kg] in double precision, of X of shape (n, m) in either.
    solve_approximately : callable
        X from (K - σM) X = Y, shape (n, m) both, in single precision, with a relative error well below 1; σ next to the
        modes wanted or among them.
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
    width = min(_BLOCK * 2**seed, size)
    space = _RitzSpace(products, 4 * count + 9 * width, BlockAlgebra(size, threads))
    residuals = np.full(count, np.inf)
    block = np.random.default_rng(seed).standard_normal((size, width), dtype=np.float32)
    values, moving = np.empty(0), True
    for _ in range(_STEPS + 8 * count // width):
        if space.is_full(block.shape[1]):
            space.shrink(count)
            moving = False
        outside = space.outside(solve_approximately(block))
        del block
        if not (outside.shape[1] or moving):
            break
        before, block = values, space.extend(outside)
        del outside
        values, mixture = space.ritz(count)
        moving = moving and block.shape[1] > 0
        if moving and (len(before) < len(values) or (before - values > _MOVED * (abs(values[-1]) + floor)).any()):
            continue
        moving = False
        scales = np.abs(values) + abs(values[-1]) + floor
        block = np.empty((size, 0), np.float32)
        left = residuals[: len(values)]
        while not block.shape[1] and (left > tolerance).any():
            # The largest first: those of the modes that wait for a step are the larger ones of the next.
            worst = np.argsort(-left, kind="stable")[: min(width, np.count_nonzero(left > tolerance))]
            block, sizes = space.residuals(values[worst], mixture[:, worst])
            sizes /= scales[worst]
            stalled = (sizes < _CLOSE) & (sizes > left[worst])
            left[worst] = np.where(stalled, 0.0, sizes)
            if (left[worst] <= tolerance).any():
                block = block[:, left[worst] > tolerance]
        if not block.shape[1]:
            break
    values, mixture = space.ritz(count)
    return values, space.combined(mixture)


class _RitzSpace:
    """Space of vectors V in single precision, with VᵀK V and VᵀM V in double.

    Attributes
    ----------
    size : int
        Number of vectors of V.
    """

    def __init__(
        self,
        products: Callable[[npt.NDArray[Any]], tuple[FloatArray, FloatArray]],
        most: int,
        algebra: BlockAlgebra,
    ) -> None:
        self._products, self._algebra = products, algebra
        # The operating system allocates only the pages that are used.
        self._vectors = np.empty((algebra.rows, most), np.float32, order="F")
        self._gram = np.empty((2, most, most))  # VᵀK V and VᵀM V
        self.size = 0

    def is_full(self, width: int) -> bool:
        """Whether a block of this width no longer fits."""
        return self.size + width > self._vectors.shape[1]

    def ritz(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Lowest Ritz values, up to ``count`` of them, and their vectors in terms of V, one in each column."""
        stiffness, mass = self._gram[:, : self.size, : self.size]
        return linalg.eigh(stiffness, mass, subset_by_index=(0, min(count, self.size) - 1))

    def combined(self, mixture: FloatArray) -> FloatArray:
        """V y, shape (n, columns of y)."""
        return self._algebra.combined(self._vectors[:, : self.size], mixture)

    def residuals(self, values: FloatArray, mixture: FloatArray) -> tuple[npt.NDArray[np.float32], FloatArray]:
        """Residuals r = K x - θ M x of Ritz pairs as unit vectors, shape (n, m), and |r| / |M x|, shape (m,)."""
        force, inertia = self._products(self.combined(mixture))
        lengths = _lengths(inertia)
        inertia *= values
        force -= inertia
        del inertia
        norms = _lengths(force)
        units = np.empty(force.shape, np.float32)
        # An exact mode has no residual.
        np.divide(force, np.where(norms > 0.0, norms, 1.0), out=units, casting="same_kind")
        return units, norms / lengths

    def outside(self, block: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
        """Orthonormal basis of the part of a block, shape (n, width), outside the space; the block is overwritten."""
        basis, algebra = self._vectors[:, : self.size], self._algebra
        block /= _lengths(block)
        for last in (False, True):
            algebra.subtract(block, basis, algebra.products(basis, block))
            values, turn = linalg.eigh(algebra.products(block, block, kind=np.float64))
            chosen = values > _WITHIN
            block = algebra.combined(block, (turn[:, chosen] / np.sqrt(values[chosen])).astype(np.float32))
            if last or not chosen.any() or values[0] > _WELL_OUTSIDE:
                break
        return block

    def extend(self, vectors: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
        """Extend the space by orthonormal vectors outside it, shape (n, r), and return their products with M."""
        before, self.size = self.size, self.size + vectors.shape[1]
        self._vectors[:, before : self.size] = vectors
        return self._multiply(slice(before, self.size))

    def _multiply(self, new: slice) -> npt.NDArray[np.float32]:
        """Products of some vectors with those before them and with themselves; and their products with M."""
        vectors = self._vectors[:, : new.stop]
        force, inertia = self._products(vectors[:, new])
        shares = self._algebra.products(vectors, force, inertia)
        for gram, share in zip(self._gram, np.hsplit(shares, 2), strict=True):
            share[new] = 0.5 * (share[new] + share[new].T)
            gram[: new.stop, new], gram[new, : new.stop] = share, share.T
        return inertia.astype(np.float32)

    def shrink(self, count: int) -> None:
        """Keep the 2 ``count`` lowest Ritz vectors, and what rounding takes from the first ``count`` of them."""
        mixture = np.linalg.qr(self.ritz(2 * count)[1])[0]
        self._algebra.replace(self._vectors[:, : self.size], mixture, count)
        self.size = mixture.shape[1] + count
        for first in range(0, self.size, _BLOCK):
            self._multiply(slice(first, min(first + _BLOCK, self.size)))


def _lengths(columns: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Length of each column, without the squares in memory."""
    return np.asarray(np.sqrt(np.einsum("ij,ij->j", columns, columns)))
