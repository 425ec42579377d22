"""Sparse symmetric matrices of 3 x 3 blocks between pairs of nodes: additions of fixtures to the solid's matrices."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import sparse

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True)
class NodeBlocks:
    """A sparse symmetric matrix by its blocks, each pair of nodes once, rows and then columns in ascending order.

    Attributes
    ----------
    rows, columns : ndarray of int, shape (n_blocks,)
        The two nodes of each block; with (a, b) there is (b, a).
    blocks : ndarray, shape (n_blocks, 3, 3)
        Entries, in the unit of the matrix.
    """

    rows: IntArray
    columns: IntArray
    blocks: FloatArray

    @classmethod
    def summed(cls, rows: IntArray, columns: IntArray, blocks: FloatArray) -> "NodeBlocks":
        """Blocks in any order, those of one pair added up."""
        if len(rows) == 0:
            return NOTHING
        order = np.lexsort((columns, rows))
        rows, columns = rows[order], columns[order]
        first = np.flatnonzero(np.r_[True, (np.diff(rows) != 0) | (np.diff(columns) != 0)])
        return cls(rows[first], columns[first], np.add.reduceat(blocks[order], first, axis=0))

    @classmethod
    def congruent(cls, port: sparse.csr_array, small: FloatArray) -> "NodeBlocks":
        """Project a small symmetric matrix on a port to the nodes: Pᵀ S P.

        Parameters
        ----------
        port : scipy.sparse.csr_array, shape (n_motions, 3 n_nodes)
            Motions from the nodes' displacements.
        small : ndarray, shape (n_motions, n_motions)
            Symmetric.
        """
        if not small.any():
            return NOTHING
        nodes = np.unique(port.indices // 3).astype(np.int64)
        freedoms = (3 * nodes[:, None] + np.arange(3)).ravel()
        dense = port[:, freedoms].toarray()
        whole = dense.T @ small @ dense
        whole = 0.5 * (whole + whole.T)  # symmetric to the last bit, as the factorisation takes it to be
        n = len(nodes)
        blocks = whole.reshape(n, 3, n, 3).transpose(0, 2, 1, 3).reshape(-1, 3, 3)
        return cls(np.repeat(nodes, n), np.tile(nodes, n), blocks)

    def __add__(self, other: "NodeBlocks") -> "NodeBlocks":
        if not (len(self) and len(other)):
            return self if len(self) else other
        return NodeBlocks.summed(
            np.concatenate([self.rows, other.rows]),
            np.concatenate([self.columns, other.columns]),
            np.concatenate([self.blocks, other.blocks]),
        )

    def __len__(self) -> int:
        return len(self.rows)

    def matrix(self, n_nodes: int) -> sparse.csr_array:
        """The whole matrix, shape (3 n_nodes, 3 n_nodes)."""
        pointer = np.searchsorted(self.rows, np.arange(n_nodes + 1))
        blocked = sparse.bsr_array((self.blocks, self.columns, pointer), shape=(3 * n_nodes, 3 * n_nodes))
        return sparse.csr_array(blocked.tocsr())

    @cached_property
    def upper(self) -> "NodeBlocks":
        """The blocks on and above the diagonal."""
        kept = self.rows <= self.columns
        return NodeBlocks(self.rows[kept], self.columns[kept], self.blocks[kept])

    @cached_property
    def resultant(self) -> FloatArray:
        """The sum of all blocks, shape (3, 3): of a mass matrix, the mass that a translation meets."""
        return np.asarray(self.blocks.sum(axis=0))


NOTHING = NodeBlocks(np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64), np.empty((0, 3, 3)))
"""No blocks: adds nothing and costs nothing."""


@dataclass(frozen=True)
class Additions:
    """Additions of a fixture to a housing's matrices.

    Attributes
    ----------
    stiffness : NodeBlocks
        [N/m].
    mass : NodeBlocks
        [kg].
    damping : NodeBlocks
        [N s/m].
    fixed : ndarray of int
        Degrees of freedom held at zero, ascending.
    """

    stiffness: NodeBlocks = NOTHING
    mass: NodeBlocks = NOTHING
    damping: NodeBlocks = NOTHING
    fixed: npt.NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    def __add__(self, other: "Additions") -> "Additions":
        return Additions(
            self.stiffness + other.stiffness,
            self.mass + other.mass,
            self.damping + other.damping,
            np.union1d(self.fixed, other.fixed),
        )
