"""Stiffness and mass on the free degrees of freedom, and the shifted matrix K - σM.

Every shifted matrix K - σM of a search for modes has one sparsity pattern, so that the source of each entry is found
once. A new shift is then one pass over the entries, and no sparse matrix is cut or converted.
"""

from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import sparse

from housing.errors import HousingError
from housing.matrices import Matrices
from housing.symmetric import SymmetricMatrix

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_FLOOR = 0.06  # part of a limit: its square is small beside the wanted eigenvalues
_ROUNDING = 3e-8  # part of the largest K_ii / M_ii: well clear of the rounding of K
_WORTH_A_THREAD = 2**16  # entries of the scalar mass: fewer are multiplied sooner than a thread starts


class FreeSystem:
    """K and M without the fixed degrees of freedom.

    Parameters
    ----------
    matrices : Matrices
        Of n_nodes nodes, with supports.
    threads : int
        That multiply K and M with vectors; the products are the same to the last bit for any number.

    Attributes
    ----------
    free : ndarray of int, shape (n,)
        Free degrees of freedom, among the 3 n_nodes.
    threads : int

    Raises
    ------
    HousingError
        Where every degree of freedom is fixed.
    """

    def __init__(self, matrices: Matrices, *, threads: int = 1) -> None:
        held = np.zeros(3 * matrices.n_nodes, dtype=bool)
        held[matrices.fixed] = True
        if held.all():
            raise HousingError("every degree of freedom is fixed")
        self.free = np.flatnonzero(~held)
        self._matrices = matrices
        self.threads = threads
        self._pointer, self._rows, self._source = _lower_pattern(matrices, self.free)

    @property
    def size(self) -> int:
        """Number n of free degrees of freedom."""
        return len(self.free)

    @property
    def n_nodes(self) -> int:
        """Nodes of the mesh."""
        return self._matrices.n_nodes

    @cached_property
    def stiffness(self) -> SymmetricMatrix:
        """K [N/m]."""
        return self._matrix(self._matrices.blocks.ravel()[self._source])

    @cached_property
    def mass(self) -> "FreeMass":
        """M [kg], as an operator."""
        return FreeMass(self._matrices, self.free, self.threads)

    def shifted(self, shift: float) -> SymmetricMatrix:
        """K - shift M, always on the same pattern [rad²/s²]."""
        return self._matrix(self._matrices.shifted_blocks(shift).ravel()[self._source])

    def floor(self, limit: float = 0.0) -> float:
        """λ up to which a mode counts as rigid [rad²/s²].

        It is far above the rounding of K, and its root small beside a limit of circular frequencies [rad/s].
        """
        ratio = self.stiffness.diagonal() / self._matrices.mass_diagonal()[self.free]
        return max(_ROUNDING * float(ratio.max()), (_FLOOR * limit) ** 2)

    def expand(self, vectors: FloatArray) -> FloatArray:
        """Vectors on the free degrees of freedom, shape (n, m), as motions of all nodes, shape (m, n_nodes, 3)."""
        full = np.zeros((vectors.shape[1], 3 * self.n_nodes))
        full[:, self.free] = vectors.T
        return full.reshape(len(full), self.n_nodes, 3)

    def _matrix(self, values: FloatArray) -> SymmetricMatrix:
        return SymmetricMatrix(self._pointer, self._rows, values, self.threads)


class FreeMass:
    """M on the free degrees of freedom: the solid's m ⊗ I₃ acts on the three components of all nodes at once.

    Parameters
    ----------
    matrices : Matrices
    free : ndarray of int, shape (n,)
        Ascending.
    threads : int
        Each multiplies a share of the rows.
    least : int
        Entries that a thread is started for; of a small mass there are fewer threads.
    """

    def __init__(self, matrices: Matrices, free: IntArray, threads: int = 1, *, least: int = _WORTH_A_THREAD) -> None:
        kept = np.unique(free // 3)
        scalar = matrices.scalar_mass
        if len(kept) < matrices.n_nodes:
            scalar = sparse.csr_array(scalar[kept][:, kept])
        threads = max(1, min(threads, scalar.nnz // least))
        ends = [len(kept) * share // threads for share in range(threads + 1)]
        self._shares = [scalar[first:last] for first, last in pairwise(ends)] if threads > 1 else [scalar]
        self._order = 3 * len(kept)
        # Where the free degrees of freedom stand among all those of the nodes that have any.
        self._places = None if 3 * len(kept) == len(free) else 3 * np.searchsorted(kept, free // 3) + free % 3
        attached = matrices.attached_mass
        self._attached = sparse.csr_array(attached.matrix(matrices.n_nodes)[free][:, free]) if len(attached) else None
        self.shape = (len(free), len(free))

    def __matmul__(self, vectors: FloatArray) -> FloatArray:
        columns = vectors.reshape(len(vectors), -1)
        if self._places is not None:
            columns = np.zeros((self._order, columns.shape[1]))
            columns[self._places] = vectors.reshape(len(vectors), -1)
        product = self._multiply(columns.reshape(self._order // 3, -1)).reshape(self._order, -1)
        if self._places is not None:
            product = product[self._places]
        if self._attached is not None:
            product += self._attached @ vectors.reshape(len(vectors), -1)
        return product.reshape(vectors.shape)

    def _multiply(self, columns: FloatArray) -> FloatArray:
        """The scalar mass times some columns; scipy's products let other threads run."""
        if len(self._shares) == 1:
            return np.asarray(self._shares[0] @ columns)
        product = np.empty((self._order // 3, columns.shape[1]))

        def fill(share: int) -> None:
            rows = self._shares[share].shape[0]
            start = sum(part.shape[0] for part in self._shares[:share])
            product[start : start + rows] = self._shares[share] @ columns

        with ThreadPoolExecutor(len(self._shares)) as pool:
            list(pool.map(fill, range(len(self._shares))))
        return product


def _lower_pattern(matrices: Matrices, free: IntArray) -> tuple[IntArray, IntArray, npt.NDArray[Any]]:
    """The lower triangle by columns on the free degrees of freedom: pointer, rows, and each entry's place in blocks.

    The blocks are the upper triangle's, by rows, which are the lower one's columns.
    """
    n = matrices.n_nodes
    count = matrices.blocks.size
    places: npt.NDArray[Any] = np.arange(count, dtype=np.int32 if count < np.iinfo(np.int32).max else np.int64)
    blocks = sparse.bsr_array((places.reshape(-1, 3, 3), matrices.neighbors, matrices.pointer), shape=(3 * n, 3 * n))
    entries = sparse.csr_array(blocks.tocsr())
    number = np.full(3 * n, -1, dtype=np.int32)
    number[free] = np.arange(len(free), dtype=np.int32)
    lengths = np.diff(entries.indptr)
    rows = number[entries.indices]
    kept = entries.indices >= np.repeat(np.arange(3 * n, dtype=np.int32), lengths)
    if len(free) < 3 * n:
        kept &= (rows >= 0) & np.repeat(number >= 0, lengths)
    counts = np.add.reduceat(kept, entries.indptr[:-1], dtype=np.int64)[free]
    return np.concatenate([[0], np.cumsum(counts)]), rows[kept].astype(np.int64), entries.data[kept]
