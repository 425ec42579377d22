"""Stiffness, mass and damping of a housing as sparse matrices of 3 x 3 blocks between pairs of nodes."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import sparse

from housing.node_blocks import NOTHING, Additions, NodeBlocks

FloatArray = npt.NDArray[np.float64]
Int32Array = npt.NDArray[np.int32]


@dataclass(frozen=True)
class Matrices:
    """Stiffness and mass on one sparsity pattern of 3 x 3 blocks, rows in order (block compressed sparse rows).

    Both are symmetric, and only the blocks on and above the diagonal are kept. The solid's own mass is scalar,
    m ⊗ I₃, and it has no damping; the mass and damping of fixtures (a rigid body, a dashpot) are kept separately.

    Attributes
    ----------
    pointer : ndarray of int, shape (n_nodes + 1,)
        Where each node's row of blocks begins, with the node's own.
    neighbors : ndarray of int, shape (n_blocks,)
        The column node of each block, ascending within a row from the node itself.
    blocks : ndarray, shape (n_blocks, 3, 3)
        Stiffness K [N/m], fixtures included.
    node_mass : ndarray, shape (n_blocks,)
        Scalar mass m of the solid [kg].
    attached_mass : NodeBlocks
        Mass of fixtures beyond m ⊗ I₃ [kg], on pairs of the pattern.
    attached_damping : NodeBlocks
        C [N s/m].
    fixed : ndarray of int
        Degrees of freedom that supports hold at zero, ascending.
    """

    pointer: Int32Array
    neighbors: Int32Array
    blocks: FloatArray
    node_mass: FloatArray
    attached_mass: NodeBlocks = NOTHING
    attached_damping: NodeBlocks = NOTHING
    fixed: npt.NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    @property
    def n_nodes(self) -> int:
        """Number of nodes; the matrices are of order three times as many."""
        return len(self.pointer) - 1

    @property
    def total_mass(self) -> float:
        """∫ ρ dV and the masses attached [kg]."""
        solid = 2.0 * self.node_mass.sum() - self.node_mass[self.pointer[:-1]].sum()
        return float(solid + np.trace(self.attached_mass.resultant) / 3.0)

    @cached_property
    def stiffness(self) -> sparse.csr_array:
        """K [N/m], shape (3 n_nodes, 3 n_nodes), symmetric, on the whole pattern."""
        return self._matrix(self.blocks)

    @cached_property
    def scalar_mass(self) -> sparse.csr_array:
        """m of the solid alone [kg], shape (n_nodes, n_nodes)."""
        pointer, neighbors, place, _ = self._whole
        return sparse.csr_array((self.node_mass[place], neighbors, pointer))

    @cached_property
    def mass(self) -> sparse.csr_array:
        """M [kg], shape (3 n_nodes, 3 n_nodes), symmetric positive definite; entries that m ⊗ I₃ leaves out are out."""
        solid = sparse.csr_array(sparse.kron(self.scalar_mass, sparse.eye_array(3), format="csr"))
        if not len(self.attached_mass):
            return solid
        return sparse.csr_array(solid + self.attached_mass.matrix(self.n_nodes))

    @cached_property
    def damping(self) -> sparse.csr_array:
        """C [N s/m] of the fixtures, shape (3 n_nodes, 3 n_nodes), symmetric; empty where nothing damps."""
        return self.attached_damping.matrix(self.n_nodes)

    def shifted(self, shift: float) -> sparse.csr_array:
        """K - shift M, always on the same pattern, whatever the shift [rad²/s²]."""
        return self._matrix(self.shifted_blocks(shift))

    def shifted_blocks(self, shift: float) -> FloatArray:
        """K - shift M on the pattern, shape (n_blocks, 3, 3)."""
        blocks = self.blocks.copy()
        inertia = shift * self.node_mass
        for component in range(3):
            blocks[:, component, component] -= inertia
        if len(self.attached_mass):
            upper = self.attached_mass.upper
            blocks[np.searchsorted(self._keys, self._keys_of(upper))] -= shift * upper.blocks
        return blocks

    def mass_diagonal(self) -> FloatArray:
        """The diagonal of M [kg], shape (3 n_nodes,)."""
        diagonal = np.repeat(self.node_mass[self.pointer[:-1]], 3)
        if len(self.attached_mass):
            diagonal += self.attached_mass.matrix(self.n_nodes).diagonal()
        return diagonal

    def plus(self, additions: Additions) -> "Matrices":
        """The matrices with a fixture added.

        Pairs of nodes that share no element and are now coupled, by stiffness or by mass, join the pattern.
        """
        stiffness, mass = additions.stiffness.upper, additions.mass.upper
        own = self._keys
        keys = np.union1d(own, np.concatenate([self._keys_of(stiffness), self._keys_of(mass)]))
        pointer, neighbors, blocks, node_mass = self.pointer, self.neighbors, self.blocks, self.node_mass
        if len(keys) > len(own):
            row, column = np.divmod(keys, self.n_nodes)
            pointer = np.searchsorted(row, np.arange(self.n_nodes + 1)).astype(np.int32)
            neighbors = column.astype(np.int32)
            kept = np.searchsorted(keys, own)
            blocks, node_mass = np.zeros((len(keys), 3, 3)), np.zeros(len(keys))
            blocks[kept], node_mass[kept] = self.blocks, self.node_mass
        elif len(stiffness):
            blocks = blocks.copy()
        if len(stiffness):
            blocks[np.searchsorted(keys, self._keys_of(stiffness))] += stiffness.blocks
        return replace(
            self,
            pointer=pointer,
            neighbors=neighbors,
            blocks=blocks,
            node_mass=node_mass,
            attached_mass=self.attached_mass + additions.mass,
            attached_damping=self.attached_damping + additions.damping,
            fixed=np.union1d(self.fixed, additions.fixed),
        )

    def held(self, freedoms: npt.ArrayLike) -> "Matrices":
        """The matrices with further degrees of freedom held at zero, of 3 n_nodes."""
        return replace(self, fixed=np.union1d(self.fixed, np.asarray(freedoms, dtype=np.int64)))

    @cached_property
    def rows(self) -> Int32Array:
        """The row node of each block, shape (n_blocks,)."""
        return np.repeat(np.arange(self.n_nodes, dtype=np.int32), np.diff(self.pointer))

    @cached_property
    def _keys(self) -> npt.NDArray[np.int64]:
        """A number for each pair of nodes of the pattern, ascending, shape (n_blocks,)."""
        return self.rows.astype(np.int64) * self.n_nodes + self.neighbors

    def _keys_of(self, blocks: NodeBlocks) -> npt.NDArray[np.int64]:
        return blocks.rows * self.n_nodes + blocks.columns

    @cached_property
    def _whole(self) -> tuple[Int32Array, Int32Array, npt.NDArray[np.int64], npt.NDArray[np.bool_]]:
        """The pattern of both triangles: its pointer and neighbours, where each block is kept, and
        whether it stands there transposed."""
        upper = np.flatnonzero(self.neighbors != self.rows)
        places = np.concatenate([np.arange(len(self.neighbors)), upper])
        row = np.concatenate([self.rows, self.neighbors[upper]])
        column = np.concatenate([self.neighbors, self.rows[upper]])
        # Counting from one, since a stored zero would be none.
        graph = sparse.csr_array((places + 1, (row, column)), shape=(self.n_nodes, self.n_nodes))
        below = graph.indices < np.repeat(np.arange(self.n_nodes), np.diff(graph.indptr))
        return graph.indptr, graph.indices, graph.data - 1, below

    def _matrix(self, blocks: FloatArray) -> sparse.csr_array:
        pointer, neighbors, place, below = self._whole
        whole = blocks[place]
        whole[below] = whole[below].transpose(0, 2, 1)
        order = 3 * self.n_nodes
        return sparse.csr_array(sparse.bsr_array((whole, neighbors, pointer), shape=(order, order)).tocsr())
