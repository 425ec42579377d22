"""Stiffness, mass and damping matrices of a housing: sparse, of 3 x 3 blocks between pairs of nodes.

Fixtures add blocks to the matrices of the solid. On the free degrees of freedom stiffness and mass give the shifted
matrix K - σM. Every shifted matrix of a search for modes has one sparsity pattern, so that the source of each entry is
found once. A new shift is then one pass over the entries, and no sparse matrix is cut or converted.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import accumulate, pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from scipy import sparse

from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.linear_algebra import Operator, SymmetricMatrix, at_once
from gearwhine.numerics.arrays import FloatArray, IntArray

if TYPE_CHECKING:
    from gearwhine.housing.fem.block_products import BlockProduct

Int32Array = npt.NDArray[np.int32]


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
        """Take blocks in any order; blocks of one pair of nodes are added up."""
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
            Symmetric matrix.
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
        """Add two matrices block by block."""
        if not (len(self) and len(other)):
            return self if len(self) else other
        return NodeBlocks.summed(
            np.concatenate([self.rows, other.rows]),
            np.concatenate([self.columns, other.columns]),
            np.concatenate([self.blocks, other.blocks]),
        )

    def __len__(self) -> int:
        """Return the number of blocks."""
        return len(self.rows)

    def matrix(self, n_nodes: int) -> sparse.csr_array:
        """Return the whole matrix, shape (3 n_nodes, 3 n_nodes)."""
        pointer = np.searchsorted(self.rows, np.arange(n_nodes + 1))
        blocked = sparse.bsr_array((self.blocks, self.columns, pointer), shape=(3 * n_nodes, 3 * n_nodes))
        return sparse.csr_array(blocked.tocsr())

    @cached_property
    def upper(self) -> "NodeBlocks":
        """The blocks on and above the diagonal."""
        is_upper = self.rows <= self.columns
        return NodeBlocks(self.rows[is_upper], self.columns[is_upper], self.blocks[is_upper])

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
        Stiffness [N/m].
    mass : NodeBlocks
        Mass [kg].
    damping : NodeBlocks
        Damping [N s/m].
    fixed : ndarray of int
        Degrees of freedom held at zero, ascending.
    """

    stiffness: NodeBlocks = NOTHING
    mass: NodeBlocks = NOTHING
    damping: NodeBlocks = NOTHING
    fixed: npt.NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    def __add__(self, other: "Additions") -> "Additions":
        """Add stiffness, mass and damping, and unite the fixed degrees of freedom."""
        return Additions(
            self.stiffness + other.stiffness,
            self.mass + other.mass,
            self.damping + other.damping,
            np.union1d(self.fixed, other.fixed),
        )


@dataclass(frozen=True)
class Matrices:
    """Stiffness and mass on one sparsity pattern of 3 x 3 blocks, rows in order (block compressed sparse rows).

    Both are symmetric, and only the blocks on and above the diagonal are kept. The solid's own mass is scalar,
    m ⊗ I₃, and it has no damping; the mass and damping of fixtures (a rigid body, a dashpot) are kept separately.

    Attributes
    ----------
    pointer : ndarray of int, shape (n_nodes + 1,)
        Place where each node's row of blocks begins, with the node's own.
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
        """Scalar mass m of the solid alone [kg], shape (n_nodes, n_nodes)."""
        pointer, neighbors, place, _ = self._both_triangles
        return sparse.csr_array((self.node_mass[place], neighbors, pointer))

    @cached_property
    def mass(self) -> sparse.csr_array:
        """M [kg], shape (3 n_nodes, 3 n_nodes), symmetric positive definite; entries that m ⊗ I₃ leaves out are out."""
        solid = sparse.csr_array(sparse.kron(self.scalar_mass, sparse.eye_array(3), format="csr"))
        if not len(self.attached_mass):
            return solid
        return sparse.csr_array(solid + self.attached_mass.matrix(self.n_nodes))

    @cached_property
    def stiffness_operator(self) -> Operator:
        """K to multiply with [N/m]; of more than 50,000 nodes no matrix is assembled."""
        return self.product_of(self.blocks) if self._is_large else self.stiffness

    @cached_property
    def absolute_stiffness_operator(self) -> Operator:
        """Absolute values of the entries of K, to multiply with [N/m]."""
        return self.product_of(np.abs(self.blocks)) if self._is_large else abs(self.stiffness)

    @cached_property
    def mass_operator(self) -> Operator:
        """M to multiply with [kg]."""
        return FreeMass(self, np.arange(3 * self.n_nodes), 2) if self._is_large else self.mass

    @property
    def _is_large(self) -> bool:
        return self.n_nodes > _NODES_BY_BLOCKS

    def product_of(self, blocks: FloatArray, free: IntArray | None = None, threads: int = 2) -> "BlockProduct":
        """Matrix to multiply with of blocks (n_blocks, 3, 3), on the free degrees of freedom, by default on all."""
        from gearwhine.housing.fem.block_products import BlockProduct

        places = np.arange(3 * self.n_nodes) if free is None else free
        return BlockProduct(self.pointer, self.neighbors, blocks, self.node_mass, places, threads)

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

    def mass_blocks(self) -> FloatArray:
        """M on the pattern [kg], shape (n_blocks, 3, 3)."""
        blocks = np.zeros_like(self.blocks)
        for component in range(3):
            blocks[:, component, component] = self.node_mass
        if len(self.attached_mass):
            upper = self.attached_mass.upper
            blocks[np.searchsorted(self._keys, self._keys_of(upper))] += upper.blocks
        return blocks

    def mass_diagonal(self) -> FloatArray:
        """Return the diagonal of M [kg], shape (3 n_nodes,)."""
        diagonal = np.repeat(self.node_mass[self.pointer[:-1]], 3)
        if len(self.attached_mass):
            diagonal += self.attached_mass.matrix(self.n_nodes).diagonal()
        return diagonal

    def plus(self, additions: Additions) -> "Matrices":
        """Return the matrices with a fixture added.

        Pairs of nodes that share no element and are now coupled, by stiffness or by mass, join the pattern.
        """
        stiffness, mass = additions.stiffness.upper, additions.mass.upper
        old_keys = self._keys
        coupled = np.unique(np.concatenate([self._keys_of(stiffness), self._keys_of(mass)]))
        # Both ascend, and few pairs are new: a union would sort all of them.
        places = np.searchsorted(old_keys, coupled)
        new = old_keys[np.minimum(places, len(old_keys) - 1)] != coupled
        keys = np.insert(old_keys, places[new], coupled[new])
        pointer, neighbors, blocks, node_mass = self.pointer, self.neighbors, self.blocks, self.node_mass
        if len(keys) > len(old_keys):
            row, column = np.divmod(keys, self.n_nodes)
            pointer = np.searchsorted(row, np.arange(self.n_nodes + 1)).astype(np.int32)
            neighbors = column.astype(np.int32)
            places = np.searchsorted(keys, old_keys)
            blocks, node_mass = np.zeros((len(keys), 3, 3)), np.zeros(len(keys))
            blocks[places], node_mass[places] = self.blocks, self.node_mass
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
        """Return the matrices with further degrees of freedom held at zero, out of 3 n_nodes."""
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
    def _both_triangles(self) -> tuple[Int32Array, Int32Array, npt.NDArray[np.int64], npt.NDArray[np.bool_]]:
        """Return the pattern of both triangles.

        These are its pointer and neighbours, the place where each block is kept, and whether it is kept transposed.
        """
        upper = np.flatnonzero(self.neighbors != self.rows)
        places = np.concatenate([np.arange(len(self.neighbors)), upper])
        row = np.concatenate([self.rows, self.neighbors[upper]])
        column = np.concatenate([self.neighbors, self.rows[upper]])
        # Counting from one, since a stored zero would be none.
        graph = sparse.csr_array((places + 1, (row, column)), shape=(self.n_nodes, self.n_nodes))
        below = graph.indices < np.repeat(np.arange(self.n_nodes), np.diff(graph.indptr))
        return graph.indptr, graph.indices, graph.data - 1, below

    def _matrix(self, blocks: FloatArray) -> sparse.csr_array:
        pointer, neighbors, place, below = self._both_triangles
        whole = blocks[place]
        whole[below] = whole[below].transpose(0, 2, 1)
        order = 3 * self.n_nodes
        return sparse.csr_array(sparse.bsr_array((whole, neighbors, pointer), shape=(order, order)).tocsr())


_FLOOR = 0.06  # part of a limit: its square is small beside the wanted eigenvalues
_STIFFNESS_ROUNDING = 3e-8  # part of the largest K_ii / M_ii: well clear of the rounding of K
_NODES_BY_BLOCKS = 50_000
_WORTH_A_THREAD = 2**16  # entries of the scalar mass: fewer are multiplied sooner than a thread starts


class FreeSystem:
    """K and M without the fixed degrees of freedom.

    Parameters
    ----------
    matrices : Matrices
        Matrices of n_nodes nodes, with supports.
    threads : int
        Threads that multiply K and M with vectors; the products are the same to the last bit for any number.
    by_blocks : bool, optional
        Whether products with K are made of its blocks, without a matrix: by default those of more than 50,000 nodes,
        where the memory counts.

    Attributes
    ----------
    free : ndarray of int, shape (n,)
        Free degrees of freedom, among the 3 n_nodes.
    threads : int
    by_blocks : bool

    Raises
    ------
    HousingError
        Where every degree of freedom is fixed.
    """

    def __init__(self, matrices: Matrices, *, threads: int = 1, by_blocks: bool | None = None) -> None:
        is_fixed = np.zeros(3 * matrices.n_nodes, dtype=bool)
        is_fixed[matrices.fixed] = True
        if is_fixed.all():
            raise HousingError("every degree of freedom is fixed")
        self.free = np.flatnonzero(~is_fixed)
        self._matrices = matrices
        self.threads = threads
        self.by_blocks = matrices.n_nodes > _NODES_BY_BLOCKS if by_blocks is None else by_blocks

    @property
    def size(self) -> int:
        """Number n of free degrees of freedom."""
        return len(self.free)

    @property
    def n_nodes(self) -> int:
        """Nodes of the mesh."""
        return self._matrices.n_nodes

    @cached_property
    def stiffness(self) -> Operator:
        """K [N/m]."""
        return self._by_blocks if self.by_blocks else self.assembled(self._matrices.blocks)

    @cached_property
    def mass(self) -> Operator:
        """M [kg]."""
        return FreeMass(self._matrices, self.free, self.threads)

    @cached_property
    def _by_blocks(self) -> "BlockProduct":
        return self._matrices.product_of(self._matrices.blocks, self.free, self.threads)

    @cached_property
    def _attached_mass(self) -> sparse.csr_array | None:
        return attached_mass(self._matrices, self.free)

    def products(self, vectors: npt.NDArray[Any]) -> tuple[FloatArray, FloatArray]:
        """K u [N] and M u [kg m] of one vector or of many, shape (n, m); by blocks, these are read once for both."""
        if not self.by_blocks:
            return self.stiffness @ vectors, self.mass @ vectors
        forces, inertia = self._by_blocks.with_inertia(vectors)
        if self._attached_mass is not None:
            inertia += self._attached_mass @ vectors
        return forces, inertia

    def shifted(self, shift: float) -> "ShiftedMatrix":
        """K - shift M, always on the same pattern [rad²/s²]."""
        return ShiftedMatrix(self, shift)

    def assembled(self, blocks: FloatArray) -> SymmetricMatrix:
        """Assemble a matrix from its blocks on the pattern of K."""
        pointer, rows, source = self._pattern
        return SymmetricMatrix(pointer, rows, blocks.ravel()[source], self.threads)

    def shifted_blocks(self, shift: float) -> FloatArray:
        """K - shift M on the pattern of blocks, shape (n_blocks, 3, 3)."""
        return self._matrices.shifted_blocks(shift)

    def assembled_pair(self) -> tuple[SymmetricMatrix, SymmetricMatrix]:
        """K [N/m] and M [kg], on one pattern."""
        return self.assembled(self._matrices.blocks), self.assembled(self._matrices.mass_blocks())

    def floor(self, limit: float = 0.0) -> float:
        """λ up to which a mode counts as rigid [rad²/s²].

        It is far above the rounding of K, and its root small beside a limit of circular frequencies [rad/s].
        """
        matrices = self._matrices
        diagonal = np.einsum("nii->ni", matrices.blocks[matrices.pointer[:-1]]).ravel()
        ratio = (diagonal / matrices.mass_diagonal())[self.free]
        return max(_STIFFNESS_ROUNDING * float(ratio.max()), (_FLOOR * limit) ** 2)

    def expand(self, vectors: FloatArray) -> FloatArray:
        """Vectors on the free degrees of freedom, shape (n, m), as motions of all nodes, shape (m, n_nodes, 3)."""
        full = np.zeros((vectors.shape[1], 3 * self.n_nodes))
        full[:, self.free] = vectors.T
        return full.reshape(len(full), self.n_nodes, 3)

    def forget_pattern(self) -> None:
        """Give up the pattern of assembled matrices where products need none; it is found again where it is used."""
        if self.by_blocks:
            self.__dict__.pop("_pattern", None)

    @cached_property
    def _pattern(self) -> tuple[npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[Any]]:
        return _lower_pattern(self._matrices, self.free)


class ShiftedMatrix:
    """K - σM on the free degrees of freedom: assembled where it is factored, and multiplied without that.

    Parameters
    ----------
    system : FreeSystem
    shift : float
        σ [rad²/s²].
    """

    def __init__(self, system: FreeSystem, shift: float) -> None:
        self._system, self._shift = system, shift
        self.shape = (system.size, system.size)

    @property
    def lower(self) -> sparse.csc_array:
        """The lower triangle."""
        return self._assembled().lower

    def full(self) -> sparse.csc_array:
        """Both triangles."""
        return self._assembled().full()

    def entries(self, kind: type) -> npt.NDArray[Any]:
        """Entries of the lower triangle, of a type of numbers; by blocks, the pattern is given up."""
        values = self._system.assembled(self._system.shifted_blocks(self._shift).astype(kind, copy=False)).values
        self._system.forget_pattern()
        return values

    def __matmul__(self, vectors: FloatArray) -> FloatArray:
        """Multiply by one vector or by many, shape (n, m)."""
        product, inertia = self._system.products(vectors)
        inertia *= self._shift
        product -= inertia
        return product

    def _assembled(self) -> SymmetricMatrix:
        return self._system.assembled(self._system.shifted_blocks(self._shift))


class FreeMass:
    """M on the free degrees of freedom: the solid's m ⊗ I₃ acts on the three components of all nodes at once.

    Parameters
    ----------
    matrices : Matrices
    free : ndarray of int, shape (n,)
        Free degrees of freedom, ascending.
    threads : int
        Number of threads; each multiplies a share of the rows.
    least : int
        Entries that a thread is started for; of a small mass there are fewer threads.
    """

    def __init__(self, matrices: Matrices, free: IntArray, threads: int = 1, *, least: int = _WORTH_A_THREAD) -> None:
        nodes = np.unique(free // 3)
        # Not matrices.scalar_mass, which keeps the pattern of both triangles.
        upper = sparse.csr_array((matrices.node_mass, matrices.neighbors, matrices.pointer))
        scalar = sparse.csr_array(upper + sparse.triu(upper, k=1, format="csr").T)
        if len(nodes) < matrices.n_nodes:
            scalar = sparse.csr_array(scalar[nodes][:, nodes])
        threads = max(1, min(threads, scalar.nnz // least))
        ends = [len(nodes) * share // threads for share in range(threads + 1)]
        self._shares = [scalar[first:last] for first, last in pairwise(ends)] if threads > 1 else [scalar]
        self._order = 3 * len(nodes)
        # Where the free degrees of freedom stand among all those of the nodes that have any.
        self._places = None if 3 * len(nodes) == len(free) else 3 * np.searchsorted(nodes, free // 3) + free % 3
        self._attached = attached_mass(matrices, free)
        self.shape = (len(free), len(free))

    def __matmul__(self, vectors: FloatArray) -> FloatArray:
        """Multiply M by one vector or by many, shape (n, m)."""
        columns = vectors.reshape(len(vectors), -1)
        if self._places is not None:
            columns = np.zeros((self._order, columns.shape[1]))
            columns[self._places] = vectors.reshape(len(vectors), -1)
        product = self._multiply(columns.reshape(self._order // 3, -1)).reshape(self._order, -1)
        del columns
        if self._places is not None:
            product = product[self._places]
        if self._attached is not None:
            product += self._attached @ vectors.reshape(len(vectors), -1)
        return product.reshape(vectors.shape)

    def _multiply(self, columns: FloatArray) -> FloatArray:
        """Multiply the scalar mass by some columns; scipy's products release the interpreter to other threads."""
        if len(self._shares) == 1:
            return np.asarray(self._shares[0] @ columns)
        product = np.empty((self._order // 3, columns.shape[1]))

        def fill(start: int, share: sparse.csr_array) -> None:
            product[start : start + share.shape[0]] = share @ columns

        starts = accumulate((share.shape[0] for share in self._shares), initial=0)
        at_once([partial(fill, start, share) for start, share in zip(starts, self._shares, strict=False)])
        return product


def attached_mass(matrices: Matrices, free: IntArray) -> sparse.csr_array | None:
    """Mass of fixtures on the free degrees of freedom [kg]; None where there are none."""
    attached = matrices.attached_mass
    return sparse.csr_array(attached.matrix(matrices.n_nodes)[free][:, free]) if len(attached) else None


def _lower_pattern(matrices: Matrices, free: IntArray) -> tuple[npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[Any]]:
    """Return the lower triangle by columns on the free degrees of freedom: pointer, rows, and places in blocks.

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
    is_lower = entries.indices >= np.repeat(np.arange(3 * n, dtype=np.int32), lengths)
    if len(free) < 3 * n:
        is_lower &= (rows >= 0) & np.repeat(number >= 0, lengths)
    counts = np.add.reduceat(is_lower, entries.indptr[:-1], dtype=np.int64)[free]
    pointer = np.concatenate([[0], np.cumsum(counts)])
    rows = rows[is_lower]
    kind = np.int32 if pointer[-1] < np.iinfo(np.int32).max else np.int64  # scipy takes both arrays of one kind
    return pointer.astype(kind), rows.astype(kind, copy=False), entries.data[is_lower]
