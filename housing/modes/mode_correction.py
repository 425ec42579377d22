"""Correction of approximate modes by residuals in double precision: generalised Davidson with an approximate inverse.

A factor F of K - σM in single precision is the factor of K - σM + E exactly, with a backward error E of some 1e-7 of
its entries. Lanczos on F⁻¹ M finds the modes of that pencil. Relative to the smallest eigenvalues E is far larger, and
leaves residuals of K φ - λ M φ of 1e-3 to 1e-2.

With θ, x a Ritz pair of K and M in a space S, r = K x - θ M x its residual in double precision and e its error,

    F⁻¹ r ≈ e + (σ - θ) (K - σM)⁻¹ M e,

so that the space of x and F⁻¹ r has far less of the error in every mode that is farther from the shift than θ is. The
modes that are not are the few next to the shift on its other side; approximations of these stand in the space as well,
where the Rayleigh-Ritz step removes them. The space of a step is that of these, of the Ritz vectors, of their last
changes, and of F⁻¹ r (Davidson 1975; Morgan and Scott 1986; the last changes after Knyazev 2001), and an error falls
some ten to twenty times a step. Only the accuracy of r limits that of the modes.
"""

from collections.abc import Callable

import numpy as np
from scipy import linalg

from gearwhine.housing.fem.linear_algebra import BlockAlgebra, Operator
from gearwhine.housing.modes.eigensolver import orthonormal
from gearwhine.numerics.arrays import FloatArray

_STEPS = 20
_GAIN = 2.0  # of the largest residual by a step, below which the next is of no use
_COLUMNS = 8
_INDEPENDENT = 1e-10  # least eigenvalue of the correlations of approximate modes
_NO_CHANGE = 1e-10  # least singular value of the changes, beside 1


def corrected_modes(
    stiffness: Operator,
    mass: Operator,
    solve_approximately: Callable[[FloatArray], FloatArray],
    vectors: FloatArray,
    count: int,
    *,
    floor: float,
    tolerance: float,
    threads: int = 1,
) -> tuple[FloatArray, FloatArray]:
    """Correct the lowest modes of a space of approximate ones.

    Parameters
    ----------
    stiffness, mass : operator, shape (n, n)
        K [N/m] and M [kg].
    solve_approximately : callable
        X from (K - σM) X = Y, shape (n, m) both, with a relative error well below 1 for every part of Y that modes
        outside the space have.
    vectors : ndarray, shape (n, m)
        Approximate modes, the wanted ones and companions that are next to them or to the shift.
    count : int
        Number of the lowest modes that are corrected, at most m.
    floor : float
        Eigenvalue that gives rigid modes a scale [rad²/s²].
    tolerance : float
        Bound of |K φ - λ M φ| / ((λ + λ_count + floor) |M φ|) at which the correction ends. It ends earlier where it
        no longer gains: the certificate then tells.
    threads : int
        Number of threads of products with the space.

    Returns
    -------
    values : ndarray, shape (count,)
        λ, ascending [rad²/s²].
    vectors : ndarray, shape (n, count)
        φ, with φᵀ M φ = 1.
    """
    algebra = BlockAlgebra(len(vectors), threads)
    space, kept = _orthonormal_space(vectors, 2 * count, mass, algebra)
    del vectors
    count = min(count, kept)
    small = np.concatenate(
        [algebra.products(space[:, :kept], stiffness @ space[:, part]) for part in _parts(kept)], axis=1
    )
    last, size = np.inf, kept
    for _ in range(_STEPS):
        values, mixture = linalg.eigh(0.5 * (small + small.T))
        values = values[:count]
        changed = _changes(mixture[:, :count], mixture[:, :kept], kept)
        mixture = np.concatenate([mixture[:, :kept], changed], axis=1)
        algebra.replace(space[:, :size], mixture)
        small = mixture.T @ small @ mixture
        size = mixture.shape[1]
        largest = 0.0
        for part in _parts(count):
            inertia = mass @ space[:, part]
            residuals = stiffness @ space[:, part] - inertia * values[part]
            scale = np.abs(values[part]) + abs(values[-1]) + floor
            sizes = np.linalg.norm(residuals, axis=0) / (scale * np.linalg.norm(inertia, axis=0))
            del inertia
            largest = max(largest, float(sizes.max()))
            if np.any(sizes > tolerance):
                corrections = solve_approximately(residuals[:, sizes > tolerance])
                corrections /= np.linalg.norm(corrections, axis=0)
                added = orthonormal(space[:, :size], corrections, mass, algebra).block
                end = size + added.shape[1]
                space[:, size:end] = added
                forces = algebra.products(space[:, :end], stiffness @ added)
                small = np.block([[small, forces[:size]], [forces[:size].T, forces[size:]]])
                size = end
        if not tolerance < largest < last / _GAIN:
            break
        last = largest
    return values, np.array(space[:, :count], order="F")


def _parts(count: int) -> list[slice]:
    """Columns that are multiplied at a time: more take more memory."""
    return [slice(begin, min(begin + _COLUMNS, count)) for begin in range(0, count, _COLUMNS)]


def _orthonormal_space(
    vectors: FloatArray, further: int, mass: Operator, algebra: BlockAlgebra
) -> tuple[FloatArray, int]:
    """M-orthonormal vectors of the span, with room for some further ones, and their number."""
    n, kept = vectors.shape
    space = np.empty((n, kept + further), order="F")
    space[:, :kept] = vectors
    del vectors
    for _ in range(2):
        gram = np.concatenate(
            [algebra.products(space[:, :kept], mass @ space[:, part]) for part in _parts(kept)], axis=1
        )
        lengths = np.sqrt(gram.diagonal())
        shares, turn = linalg.eigh(gram / np.outer(lengths, lengths))
        independent = shares > _INDEPENDENT
        algebra.replace(space[:, :kept], (turn / lengths[:, None])[:, independent] / np.sqrt(shares[independent]))
        kept = int(independent.sum())
    return space, kept


def _changes(wanted: FloatArray, ritz: FloatArray, kept: int) -> FloatArray:
    """Parts of the Ritz vectors wanted outside the last ones, orthonormal and orthogonal to the new ones."""
    changes = wanted.copy()
    changes[:kept] = 0.0
    for _ in range(2):
        changes -= ritz @ (ritz.T @ changes)
    left, sizes, _ = np.linalg.svd(changes, full_matrices=False)
    left = left[:, sizes > _NO_CHANGE]
    left -= ritz @ (ritz.T @ left)
    return np.asarray(np.linalg.qr(left)[0])
