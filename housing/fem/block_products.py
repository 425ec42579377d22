"""Products of the stiffness with block vectors, from its 3 x 3 blocks themselves: no matrix is assembled.

On a large mesh the assembled matrix is a good part of the memory beside the factor. The blocks on and above the
diagonal are read once for both triangles. Importing this module imports numba.
"""

from functools import partial

import numba
import numpy as np
import numpy.typing as npt

from gearwhine.housing.fem.linear_algebra import at_once
from gearwhine.numerics.arrays import FloatArray, IntArray

_compiled = numba.njit(cache=True, nogil=True, fastmath={"contract"}, error_model="numpy")

_COLUMNS = 4  # columns of one pass over the blocks: of a fixed number, they stand in registers


@_compiled
def _add_stiffness(
    pointer: npt.NDArray[np.int32],
    neighbors: npt.NDArray[np.int32],
    entries: FloatArray,
    motions: FloatArray,
    forces: FloatArray,
) -> None:
    """Add K u to forces; entries are those of all blocks, motions and forces of n_nodes x 3 x _COLUMNS, all flat."""
    own = np.empty(3 * _COLUMNS)
    for i in range(pointer.size - 1):
        own[:] = 0.0
        row = 3 * _COLUMNS * i
        for place in range(pointer[i], pointer[i + 1]):
            j = neighbors[place]
            other = 3 * _COLUMNS * j
            xx, xy, xz = entries[9 * place], entries[9 * place + 1], entries[9 * place + 2]
            yx, yy, yz = entries[9 * place + 3], entries[9 * place + 4], entries[9 * place + 5]
            zx, zy, zz = entries[9 * place + 6], entries[9 * place + 7], entries[9 * place + 8]
            for column in range(_COLUMNS):
                x = motions[other + column]
                y = motions[other + _COLUMNS + column]
                z = motions[other + 2 * _COLUMNS + column]
                own[column] += xx * x + xy * y + xz * z
                own[_COLUMNS + column] += yx * x + yy * y + yz * z
                own[2 * _COLUMNS + column] += zx * x + zy * y + zz * z
            if j != i:
                for column in range(_COLUMNS):
                    x = motions[row + column]
                    y = motions[row + _COLUMNS + column]
                    z = motions[row + 2 * _COLUMNS + column]
                    forces[other + column] += xx * x + yx * y + zx * z
                    forces[other + _COLUMNS + column] += xy * x + yy * y + zy * z
                    forces[other + 2 * _COLUMNS + column] += xz * x + yz * y + zz * z
        for column in range(3 * _COLUMNS):
            forces[row + column] += own[column]


@_compiled
def _spread(free: IntArray, columns: FloatArray, begin: int, motions: FloatArray) -> None:
    """Write _COLUMNS columns from ``begin`` on, or those that there are, to the free degrees of freedom of motions."""
    width = min(_COLUMNS, columns.shape[1] - begin)
    motions[:] = 0.0
    for k in range(free.size):
        for column in range(width):
            motions[_COLUMNS * free[k] + column] = columns[k, begin + column]


@_compiled
def _gather(free: IntArray, columns: FloatArray, begin: int, forces: FloatArray) -> None:
    """Read these columns from the free degrees of freedom of forces."""
    width = min(_COLUMNS, columns.shape[1] - begin)
    for k in range(free.size):
        for column in range(width):
            columns[k, begin + column] = forces[_COLUMNS * free[k] + column]


class BlockProduct:
    """Symmetric matrix on the free degrees of freedom, an operator.

    Parameters
    ----------
    pointer, neighbors : ndarray of int
        Pattern of the blocks, as of :class:`~gearwhine.housing.fem.matrices.Matrices`.
    blocks : ndarray, shape (n_blocks, 3, 3)
        Blocks on and above the diagonal.
    free : ndarray of int, shape (n,)
        Free degrees of freedom, ascending.
    threads : int
        Number of threads; each multiplies four columns at a time.
    """

    def __init__(
        self,
        pointer: npt.NDArray[np.int32],
        neighbors: npt.NDArray[np.int32],
        blocks: FloatArray,
        free: IntArray,
        threads: int = 1,
    ) -> None:
        self._blocks = pointer, neighbors, blocks.ravel()
        self._order = 3 * (len(pointer) - 1)
        self._free, self._threads = free, threads
        self.shape = (len(free), len(free))

    def __matmul__(self, vectors: FloatArray) -> FloatArray:
        """Multiply by one vector or by many, shape (n, m)."""
        columns = np.ascontiguousarray(vectors.reshape(len(vectors), -1))
        product = np.empty_like(columns)
        begins = range(0, columns.shape[1], _COLUMNS)

        def multiply(begins: range) -> None:
            motions, forces = np.empty(self._order * _COLUMNS), np.empty(self._order * _COLUMNS)
            for begin in begins:
                _spread(self._free, columns, begin, motions)
                forces[:] = 0.0
                _add_stiffness(*self._blocks, motions, forces)
                _gather(self._free, product, begin, forces)

        at_once([partial(multiply, begins[share :: self._threads]) for share in range(min(self._threads, len(begins)))])
        return product.reshape(vectors.shape)
