"""Products of stiffness and mass with block vectors, from the 3 x 3 blocks themselves: no matrix is assembled.

On a large mesh the assembled matrices are a good part of the memory beside the factor. The blocks on and above the
diagonal are read once for both triangles. Importing this module imports numba.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numba
import numpy as np
import numpy.typing as npt

from gearwhine.housing.fem.linear_algebra import Operator, at_once
from gearwhine.numerics.arrays import FloatArray, IntArray

_compiled = numba.njit(cache=True, nogil=True, fastmath={"contract"})


@_compiled
def _add_stiffness(
    pointer: npt.NDArray[np.int32],
    neighbors: npt.NDArray[np.int32],
    blocks: FloatArray,
    motions: FloatArray,
    forces: FloatArray,
) -> None:
    """Add K u to forces; motions and forces have the shape (n_nodes, 3, m)."""
    columns = motions.shape[2]
    for i in range(pointer.size - 1):
        for place in range(pointer[i], pointer[i + 1]):
            j = neighbors[place]
            for a in range(3):
                for b in range(3):
                    entry = blocks[place, a, b]
                    for column in range(columns):
                        forces[i, a, column] += entry * motions[j, b, column]
                    if j != i:
                        for column in range(columns):
                            forces[j, b, column] += entry * motions[i, a, column]


@_compiled
def _add_mass(
    pointer: npt.NDArray[np.int32],
    neighbors: npt.NDArray[np.int32],
    masses: FloatArray,
    motions: FloatArray,
    forces: FloatArray,
) -> None:
    """Add m ⊗ I₃ u to forces; motions and forces have the shape (n_nodes, 3, m)."""
    columns = motions.shape[2]
    for i in range(pointer.size - 1):
        for place in range(pointer[i], pointer[i + 1]):
            j = neighbors[place]
            entry = masses[place]
            for a in range(3):
                for column in range(columns):
                    forces[i, a, column] += entry * motions[j, a, column]
                if j != i:
                    for column in range(columns):
                        forces[j, a, column] += entry * motions[i, a, column]


class BlockProduct:
    """Symmetric matrix on the free degrees of freedom, as an operator.

    Parameters
    ----------
    pointer, neighbors : ndarray of int
        Pattern of the blocks, as of :class:`~gearwhine.housing.fem.matrices.Matrices`.
    entries : ndarray, shape (n_blocks, 3, 3) or (n_blocks,)
        Blocks on and above the diagonal; of one number each, those of m ⊗ I₃.
    free : ndarray of int, shape (n,)
        Free degrees of freedom, ascending.
    threads : int
        Number of threads; each multiplies some of the columns.
    further : operator of shape (n, n), optional
        Added to the matrix.
    """

    def __init__(
        self,
        pointer: npt.NDArray[np.int32],
        neighbors: npt.NDArray[np.int32],
        entries: FloatArray,
        free: IntArray,
        threads: int = 1,
        further: Operator | None = None,
    ) -> None:
        kernel: Any = _add_stiffness if entries.ndim == 3 else _add_mass
        self._add: Callable[[FloatArray, FloatArray], None] = partial(kernel, pointer, neighbors, entries)
        self._order = 3 * (len(pointer) - 1)
        # A slice copies rows at twice the speed of a list of places.
        self._free: IntArray | slice = slice(None) if len(free) == self._order else free
        self._threads, self._further = threads, further
        self.shape = (len(free), len(free))

    def __matmul__(self, vectors: FloatArray) -> FloatArray:
        """Multiply by one vector or by many, shape (n, m)."""
        columns = vectors.reshape(len(vectors), -1)
        count = columns.shape[1]
        ends = [count * share // self._threads for share in range(self._threads + 1)]
        product = np.empty_like(columns, order="C")

        def fill(share: int) -> None:
            part = slice(ends[share], ends[share + 1])
            motions = np.zeros((self._order, ends[share + 1] - ends[share]))
            motions[self._free] = columns[:, part]
            forces = np.zeros_like(motions)
            shape = (self._order // 3, 3, -1)
            self._add(motions.reshape(shape), forces.reshape(shape))
            product[:, part] = forces[self._free]

        shares = [share for share in range(self._threads) if ends[share + 1] > ends[share]]
        at_once([partial(fill, share) for share in shares])
        if self._further is not None:
            product += self._further @ columns
        return product.reshape(vectors.shape)
