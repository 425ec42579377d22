"""Products of stiffness and mass with block vectors, from the 3 x 3 blocks themselves: no matrix is assembled.

On a large mesh the assembled matrix is a good part of the memory beside the factor. Both matrices have one pattern, and
are multiplied at once, each row by one thread. Importing this module imports numba.
"""

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import Any

import numba
import numpy as np
import numpy.typing as npt
from scipy import sparse

from gearwhine.housing.fem.linear_algebra import at_once
from gearwhine.numerics.arrays import FloatArray, IntArray

_compiled = numba.njit(cache=True, nogil=True, fastmath={"contract"}, error_model="numpy")


def _products_of(columns: int, *, has_mass: bool) -> Callable[..., None]:
    """Kernel that multiplies so many columns at once, a number known to the compiler, with the mass or without."""

    @_compiled
    def write_products(
        first: int,
        last: int,
        pointer: npt.NDArray[np.int32],
        neighbors: npt.NDArray[np.int32],
        lower_pointer: npt.NDArray[np.int32],
        lower_neighbors: npt.NDArray[np.int32],
        lower_places: npt.NDArray[np.int32],
        entries: FloatArray,
        node_mass: FloatArray,
        number: npt.NDArray[np.int32],
        motions: npt.NDArray[Any],
        forces: FloatArray,
        inertia: FloatArray,
    ) -> None:
        """Write K u to forces and (m ⊗ I₃) u to inertia at nodes ``first`` to ``last`` - 1.

        Entries are those of all blocks, flat; motions, forces and inertia have a row for each free degree of freedom,
        and motions a last one of zeros, which is the row of every fixed one: ``number`` has the rows of all nodes. The
        lower pattern has the places of blocks below the diagonal, which are kept above it, transposed.
        """
        own = np.empty((6, columns))
        for node in range(first, last):
            own[:] = 0.0
            for place in range(pointer[node], pointer[node + 1]):
                other = 3 * neighbors[place]
                first_row, second_row, third_row = number[other], number[other + 1], number[other + 2]
                xx, xy, xz = entries[9 * place], entries[9 * place + 1], entries[9 * place + 2]
                yx, yy, yz = entries[9 * place + 3], entries[9 * place + 4], entries[9 * place + 5]
                zx, zy, zz = entries[9 * place + 6], entries[9 * place + 7], entries[9 * place + 8]
                m = node_mass[place]
                for k in range(columns):
                    x, y, z = motions[first_row, k], motions[second_row, k], motions[third_row, k]
                    own[0, k] += xx * x + xy * y + xz * z
                    own[1, k] += yx * x + yy * y + yz * z
                    own[2, k] += zx * x + zy * y + zz * z
                    if has_mass:
                        own[3, k] += m * x
                        own[4, k] += m * y
                        own[5, k] += m * z
            for below in range(lower_pointer[node], lower_pointer[node + 1]):
                other, place = 3 * lower_neighbors[below], lower_places[below]
                first_row, second_row, third_row = number[other], number[other + 1], number[other + 2]
                xx, xy, xz = entries[9 * place], entries[9 * place + 1], entries[9 * place + 2]
                yx, yy, yz = entries[9 * place + 3], entries[9 * place + 4], entries[9 * place + 5]
                zx, zy, zz = entries[9 * place + 6], entries[9 * place + 7], entries[9 * place + 8]
                m = node_mass[place]
                for k in range(columns):
                    x, y, z = motions[first_row, k], motions[second_row, k], motions[third_row, k]
                    own[0, k] += xx * x + yx * y + zx * z
                    own[1, k] += xy * x + yy * y + zy * z
                    own[2, k] += xz * x + yz * y + zz * z
                    if has_mass:
                        own[3, k] += m * x
                        own[4, k] += m * y
                        own[5, k] += m * z
            for component in range(3):
                row = number[3 * node + component]
                if row < len(forces):
                    for k in range(columns):
                        forces[row, k] = own[component, k]
                        if has_mass:
                            inertia[row, k] = own[3 + component, k]

    return write_products


AT_ONCE = 16
"""Columns multiplied at once. Loops of 2 to 12 are unrolled by the compiler, and then take as long as those of 16."""
_ALONE = {columns: _products_of(columns, has_mass=False) for columns in (1, AT_ONCE)}
_BOTH = {AT_ONCE: _products_of(AT_ONCE, has_mass=True)}
"""Kernels of K alone, and of K and M, by the number of columns that they multiply at once."""


class BlockProduct:
    """Symmetric matrix on the free degrees of freedom, an operator; and a mass beside it on the same pattern.

    Parameters
    ----------
    pointer, neighbors : ndarray of int
        Pattern of the blocks, as of :class:`~gearwhine.housing.fem.matrices.Matrices`.
    blocks : ndarray, shape (n_blocks, 3, 3)
        Blocks on and above the diagonal.
    node_mass : ndarray, shape (n_blocks,)
        Scalar mass m.
    free : ndarray of int, shape (n,)
        Free degrees of freedom.
    threads : int
        Number of threads; each multiplies a share of the rows.
    """

    def __init__(
        self,
        pointer: npt.NDArray[np.int32],
        neighbors: npt.NDArray[np.int32],
        blocks: FloatArray,
        node_mass: FloatArray,
        free: IntArray,
        threads: int = 1,
    ) -> None:
        n_nodes = len(pointer) - 1
        above = np.flatnonzero(neighbors != np.repeat(np.arange(n_nodes, dtype=np.int32), np.diff(pointer)))
        # Above the diagonal, a row begins after its diagonal block.
        upper = sparse.csr_array(
            (above.astype(np.int32), neighbors[above], pointer - np.arange(n_nodes + 1, dtype=np.int32)),
            shape=(n_nodes, n_nodes),
        )
        lower = sparse.csc_array(upper)
        below = lower.indptr, lower.indices, lower.data
        number = np.full(3 * n_nodes, len(free), dtype=np.int32)
        number[free] = np.arange(len(free), dtype=np.int32)
        self._blocks: tuple[Any, ...] = pointer, neighbors, *below, blocks.ravel(), node_mass, number
        ends = np.searchsorted(pointer, np.linspace(0, pointer[-1], threads + 1)).tolist()
        self._shares = list(pairwise(ends))
        self.shape = (len(free), len(free))

    def __matmul__(self, vectors: FloatArray) -> FloatArray:
        """Multiply by one vector or by many, shape (n, m)."""
        return self._products(vectors, has_mass=False)[0]

    def with_inertia(self, vectors: npt.NDArray[Any]) -> tuple[FloatArray, FloatArray]:
        """Products of the matrix and of m ⊗ I₃ with one vector or with many, in single or double precision."""
        forces, inertia = self._products(vectors, has_mass=True)
        return forces, inertia

    def _products(self, vectors: npt.NDArray[Any], *, has_mass: bool) -> list[FloatArray]:
        columns = vectors.reshape(len(vectors), -1)
        if columns.shape[1] <= AT_ONCE:
            return [part.reshape(vectors.shape) for part in self._few_products(columns, has_mass=has_mass)]
        found = [np.empty(columns.shape) for _ in range(1 + has_mass)]
        for begin in range(0, columns.shape[1], AT_ONCE):
            few = slice(begin, begin + AT_ONCE)
            for whole, part in zip(found, self._few_products(columns[:, few], has_mass=has_mass), strict=True):
                whole[:, few] = part
        return [product.reshape(vectors.shape) for product in found]

    def _few_products(self, columns: npt.NDArray[Any], *, has_mass: bool) -> list[FloatArray]:
        """Multiply as many columns as a kernel takes, or fewer."""
        n, width = columns.shape
        at_most, write = next(one for one in (_BOTH if has_mass else _ALONE).items() if one[0] >= width)
        motions = np.zeros((n + 1, at_most), np.float32 if columns.dtype == np.float32 else np.float64)
        motions[:n, :width] = columns
        forces, inertia = np.empty((n, at_most)), np.empty((n if has_mass else 0, at_most))
        at_once([partial(write, *share, *self._blocks, motions, forces, inertia) for share in self._shares])
        return [product[:, :width] for product in ([forces, inertia] if has_mass else [forces])]
