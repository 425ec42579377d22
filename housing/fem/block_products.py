"""Products of stiffness and mass with block vectors, from the 3 x 3 blocks themselves: no matrix is assembled.

On a large mesh the assembled matrix is a good part of the memory beside the factor. The blocks on and above the
diagonal are read once for both triangles, and once for both matrices, which have one pattern. Importing this module
imports numba.
"""

from functools import partial

import numba
import numpy as np
import numpy.typing as npt

from gearwhine.housing.fem.linear_algebra import at_once
from gearwhine.numerics.arrays import FloatArray, IntArray

_compiled = numba.njit(cache=True, nogil=True, fastmath={"contract"}, error_model="numpy")

_COLUMNS = 8  # columns of one pass over the blocks: of a fixed number, they stand in registers
_ROWS_AT_ONCE = 2**14  # rows moved in place


@_compiled
def _add_products(
    pointer: npt.NDArray[np.int32],
    neighbors: npt.NDArray[np.int32],
    entries: FloatArray,
    node_mass: FloatArray,
    motions: FloatArray,
    begin: int,
    forces: FloatArray,
    inertia: FloatArray,
) -> None:
    """Add K u to forces, and (m ⊗ I₃) u to inertia unless that is empty, of _COLUMNS columns from ``begin`` on.

    Entries are those of all blocks, flat; motions, forces and inertia have three rows for each node.
    """
    own = np.empty((6, _COLUMNS))
    massive = inertia.size > 0
    for i in range(pointer.size - 1):
        own[:] = 0.0
        row = 3 * i
        for place in range(pointer[i], pointer[i + 1]):
            other = 3 * neighbors[place]
            xx, xy, xz = entries[9 * place], entries[9 * place + 1], entries[9 * place + 2]
            yx, yy, yz = entries[9 * place + 3], entries[9 * place + 4], entries[9 * place + 5]
            zx, zy, zz = entries[9 * place + 6], entries[9 * place + 7], entries[9 * place + 8]
            for k in range(_COLUMNS):
                x, y, z = motions[other, begin + k], motions[other + 1, begin + k], motions[other + 2, begin + k]
                own[0, k] += xx * x + xy * y + xz * z
                own[1, k] += yx * x + yy * y + yz * z
                own[2, k] += zx * x + zy * y + zz * z
            if other != row:
                for k in range(_COLUMNS):
                    x, y, z = motions[row, begin + k], motions[row + 1, begin + k], motions[row + 2, begin + k]
                    forces[other, begin + k] += xx * x + yx * y + zx * z
                    forces[other + 1, begin + k] += xy * x + yy * y + zy * z
                    forces[other + 2, begin + k] += xz * x + yz * y + zz * z
            if massive:
                m = node_mass[place]
                for component in range(3):
                    for k in range(_COLUMNS):
                        own[3 + component, k] += m * motions[other + component, begin + k]
                    if other != row:
                        for k in range(_COLUMNS):
                            inertia[other + component, begin + k] += m * motions[row + component, begin + k]
        for component in range(3):
            for k in range(_COLUMNS):
                forces[row + component, begin + k] += own[component, k]
            if massive:
                for k in range(_COLUMNS):
                    inertia[row + component, begin + k] += own[3 + component, k]


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
        Free degrees of freedom, ascending.
    threads : int
        Number of threads; each multiplies eight columns at a time.
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
        self._blocks = pointer, neighbors, blocks.ravel(), node_mass
        self._order = 3 * (len(pointer) - 1)
        self._free, self._threads = free, threads
        self.shape = (len(free), len(free))

    def __matmul__(self, vectors: FloatArray) -> FloatArray:
        """Multiply by one vector or by many, shape (n, m)."""
        return self._products(vectors, massive=False)[0]

    def with_inertia(self, vectors: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Products of the matrix and of m ⊗ I₃ with one vector or with many, in single or double precision."""
        return self._products(vectors, massive=True)

    def _products(self, vectors: FloatArray, *, massive: bool) -> tuple[FloatArray, FloatArray]:
        columns = vectors.reshape(len(vectors), -1)
        width = columns.shape[1]
        begins = range(0, width, _COLUMNS)
        motions = np.zeros((self._order, _COLUMNS * len(begins)))
        for first in range(0, len(self._free), _ROWS_AT_ONCE):
            few = slice(first, first + _ROWS_AT_ONCE)
            motions[self._free[few], :width] = columns[few]
        forces = np.zeros_like(motions)
        inertia = np.zeros_like(motions) if massive else np.empty((0, 0))

        def multiply(begins: range) -> None:
            for begin in begins:
                _add_products(*self._blocks, motions, begin, forces, inertia)

        at_once([partial(multiply, begins[share :: self._threads]) for share in range(min(self._threads, len(begins)))])
        del motions
        return self._of_free(forces, vectors), self._of_free(inertia, vectors) if massive else inertia

    def _of_free(self, product: FloatArray, vectors: FloatArray) -> FloatArray:
        """Rows of the free degrees of freedom, moved up in place, and as many columns as the vectors have."""
        for first in range(0, len(self._free), _ROWS_AT_ONCE):
            few = self._free[first : first + _ROWS_AT_ONCE]
            product[first : first + len(few)] = product[few]
        return product[: len(self._free), : vectors[0].size].reshape(vectors.shape)
