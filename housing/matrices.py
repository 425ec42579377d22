"""Stiffness and mass of a housing as sparse matrices of 3 x 3 blocks between pairs of nodes."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import sparse

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int32]


@dataclass(frozen=True)
class Matrices:
    """Stiffness and mass on one sparsity pattern of 3 x 3 blocks, rows in order (block compressed sparse rows).

    Attributes
    ----------
    pointer : ndarray of int, shape (n_nodes + 1,)
        Where each node's row of blocks begins.
    neighbors : ndarray of int, shape (n_blocks,)
        The column node of each block.
    blocks : ndarray, shape (n_blocks, 3, 3)
        Stiffness K [N/m].
    node_mass : ndarray, shape (n_blocks,)
        Scalar mass m [kg]; M = m ⊗ I₃.
    """

    pointer: IntArray
    neighbors: IntArray
    blocks: FloatArray
    node_mass: FloatArray

    @property
    def n_nodes(self) -> int:
        """Number of nodes; the matrices are of order three times as many."""
        return len(self.pointer) - 1

    @property
    def total_mass(self) -> float:
        """∫ ρ dV [kg]."""
        return float(self.node_mass.sum())

    @cached_property
    def stiffness(self) -> sparse.csr_array:
        """K [N/m], shape (3 n_nodes, 3 n_nodes), symmetric."""
        return self._matrix(self.blocks)

    @cached_property
    def mass(self) -> sparse.csr_array:
        """M [kg], shape (3 n_nodes, 3 n_nodes), symmetric positive definite."""
        scalar = sparse.csr_array((self.node_mass, self.neighbors, self.pointer))
        return sparse.csr_array(sparse.kron(scalar, sparse.eye_array(3), format="csr"))

    def shifted(self, shift: float) -> sparse.csr_array:
        """K - shift M, always on the same pattern, whatever the shift [rad²/s²]."""
        return self._matrix(self.blocks - shift * self.node_mass[:, None, None] * np.eye(3))

    def _matrix(self, blocks: FloatArray) -> sparse.csr_array:
        order = 3 * self.n_nodes
        return sparse.csr_array(sparse.bsr_array((blocks, self.neighbors, self.pointer), shape=(order, order)).tocsr())
