"""Shooting matrix of the whirl equations: the order of its rows and columns, and the table of its entries.

From the table compiled code makes the entries for any λ. Beside the transfer matrices of runs of shaft elements every
entry is, with Ω the speed of rotation and s the unit of force,

    (c₀ + c₁ λ + c₂ λ² + c₃ λΩ + c₄ s) / (d₁ s + d₀):

inertias have c₂, c₃ and d₁; bearings and pedestals c₀, c₁, c₂ over s plus the largest stiffness of their row, so that
stiff and soft directions are scaled alike; their forces c₄. Unit entries and directions are constant.

Unknowns are columns, equations rows. Elimination goes from left to right, and its cost is its fill-in. At every node
the unknowns of bearings come first, then those of one block after another, displacements before forces; the equations
of a node stand in the order of the blocks too, followed by those of bearings. So a bearing's coupling is eliminated
before the next run begins, and the two senses hardly fill in each other's rows. Right of the last node there is no
force.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import ComplexArray, FloatArray, IndexArray
from gearwhine.numerics.banded import BandPattern
from gearwhine.rotors.transfer_matrix.discretised_shaft import DiscretisedShaft
from gearwhine.rotors.whirl.circular_coordinates import BLOCK_COORDINATES, NodeBearing

Runs = tuple[FloatArray, FloatArray, IndexArray, IndexArray, IndexArray]
UNIT_DENOMINATOR = np.array([0.0, 1.0])  # entries that are polynomials of λ
FORCE_DENOMINATOR = np.array([1.0, 0.0])  # entries over the unit of force
NO_PLACES = np.zeros(0, dtype=np.intp)
NO_RUNS = (np.zeros(0), np.zeros((0, 2, 1)), NO_PLACES, np.zeros(1, dtype=np.intp), NO_PLACES)


@dataclass(frozen=True)
class BearingPlaces:
    """Columns of a bearing's forces (m,) and of its pedestal's displacements (f,), and the rows of both."""

    forces: IndexArray
    feet: IndexArray
    force_rows: IndexArray
    foot_rows: IndexArray


@dataclass(frozen=True)
class Layout:
    """Places of unknowns (columns) and equations (rows), for r + 1 nodes with n displacements each.

    Attributes
    ----------
    order : int
        Number of unknowns, and of equations.
    displacements, forces : ndarray of int, shapes (r + 1, n) and (r, n)
        Columns of the state right of a node.
    continuity, balances : ndarray of int, shapes (r, n) and (r + 1, n)
        Rows of the displacements at every node but the first, and of the forces at every node.
    bearings : tuple of BearingPlaces
        Rows and columns of every bearing.
    """

    order: int
    displacements: IndexArray
    forces: IndexArray
    continuity: IndexArray
    balances: IndexArray
    bearings: tuple[BearingPlaces, ...]

    @classmethod
    def of(cls, blocks: tuple[int, ...], nodes: IndexArray, node_bearings: Sequence[NodeBearing]) -> "Layout":
        """Layout of the blocks at the nodes with unknowns, (r + 1,), and of the bearings at some of them."""
        widths = np.array([len(BLOCK_COORDINATES[block]) for block in blocks])
        n, width = int(widths.sum()), np.repeat(widths, widths)
        # The displacements of a block and then its forces follow those of the previous blocks.
        offsets = np.arange(n) + np.repeat(np.cumsum(widths) - widths, widths)
        at = [int(nodes.searchsorted(node_bearing.node)) for node_bearing in node_bearings]
        extra = np.zeros(nodes.size, dtype=np.intp)
        for node, node_bearing in zip(at, node_bearings, strict=True):
            extra[node] += len(node_bearing.directions) + len(node_bearing.foot)
        # The first node has no continuity equations, the last no forces.
        columns = np.concatenate([[0], np.cumsum(extra[:-1] + 2 * n)])
        rows = np.concatenate([[0], np.cumsum(extra[:-1] + 2 * n) - n])
        states = columns + extra
        displacements, balances = states[:, None] + offsets, rows[:, None] + width + offsets
        displacements[-1], balances[0] = states[-1] + np.arange(n), np.arange(n)
        behind = rows + 2 * n
        behind[0] = n
        places = []
        for node, node_bearing in zip(at, node_bearings, strict=True):
            m, f = len(node_bearing.directions), len(node_bearing.foot)
            column, row = np.arange(columns[node], columns[node] + m + f), np.arange(behind[node], behind[node] + m + f)
            places.append(BearingPlaces(column[:m], column[m:], row[:m], row[m:]))
            columns[node] += m + f
            behind[node] += m + f
        return cls(
            int(states[-1]) + n,
            displacements,
            states[:-1, None] + width + offsets,
            rows[1:, None] + offsets,
            balances,
            tuple(places),
        )


@dataclass(frozen=True)
class ShootingMatrix:
    """The shooting matrix of one set of equations, as a table of its entries.

    Attributes
    ----------
    pattern : BandPattern
        Rows and columns of the entries.
    blocks : ndarray of int
        Blocks: 1 for r+, −1 for r−, 0 for z.
    beams, rods : Runs
        Lengths (e,) and coefficients (e, 6 or 2, j) of the distinct elements, the index of each among them, (p,), the
        nodes with unknowns, between which elements form a run, (r + 1,), and for each run the first equal one, (r,); no
        rods without z.
    numerators, denominators : ndarray of complex and ndarray, shapes (t, 5) and (t, 2)
        Coefficients of the entries that follow those of the transfer matrices.
    constants : ndarray of complex, shape (c,)
        Constant entries, at the end.
    """

    pattern: BandPattern
    blocks: IndexArray
    beams: Runs
    rods: Runs
    numerators: ComplexArray
    denominators: FloatArray
    constants: ComplexArray

    def values(self, eigenvalues: ComplexArray, speeds: ComplexArray, scale: FloatArray) -> ComplexArray:
        """Entries at every λ, speed Ω (which may be complex) and unit of force, (b, nnz)."""
        from gearwhine.rotors.whirl.shooting_matrix_kernels import entries

        out = np.empty((eigenvalues.size, self.pattern.rows.size), dtype=np.complex128)
        entries(eigenvalues, speeds, scale, self.arrays, out)
        return out

    def log_determinants(self, eigenvalues: ComplexArray, speeds: ComplexArray, scale: FloatArray) -> ComplexArray:
        """Logarithms of the determinants, (b,), their imaginary parts within (−π, π]."""
        from gearwhine.rotors.whirl.shooting_matrix_kernels import determinants

        return np.asarray(determinants(eigenvalues, speeds, scale, self.arrays, self.pattern.arrays))

    @property
    def arrays(self) -> tuple[IndexArray, Runs, Runs, ComplexArray, FloatArray, ComplexArray]:
        """The table as compiled functions take it."""
        return self.blocks, self.beams, self.rods, self.numerators, self.denominators, self.constants


def shooting_matrix(
    bending: DiscretisedShaft,
    axial: DiscretisedShaft | None,
    blocks: tuple[int, ...],
    node_bearings: Sequence[NodeBearing],
    nodes: IndexArray,
    layout: Layout,
) -> ShootingMatrix:
    """Assemble the shooting matrix with unknowns at ``nodes``, (r + 1,), in the given layout."""
    first, terms, runs = 0, _Terms(), []
    states = np.stack([layout.displacements[:-1], layout.forces])
    reached = np.stack([layout.continuity, layout.balances[1:]])
    for block in blocks:
        block_columns = slice(first, first + len(BLOCK_COORDINATES[block]))
        # (r, 2n) each, displacements before forces.
        rows, columns = (np.concatenate([*places[:, :, block_columns]], axis=1) for places in (reached, states))
        runs.append(np.array(np.broadcast_arrays(rows[:, :, None], columns[:, None])).reshape(2, -1))
        first = block_columns.stop
    terms.add(layout.balances, layout.displacements, [0.0, 0.0, *_inertias(bending, nodes, blocks)], FORCE_DENOMINATOR)
    terms.add(layout.continuity, layout.displacements[1:], [1.0])
    terms.add(layout.balances[:-1], layout.forces, [1.0])
    for node_bearing, own_places in zip(node_bearings, layout.bearings, strict=True):
        node = int(nodes.searchsorted(node_bearing.node))
        _add_node_bearing(terms, node_bearing, layout.balances[node], layout.displacements[node], own_places)
    places, numerators, denominators, constants = terms.parted()
    rows, columns = np.concatenate(runs + places, axis=1)
    return ShootingMatrix(
        BandPattern.of(rows, columns, layout.order),
        np.array(blocks, dtype=np.intp),
        _runs(bending, nodes),
        NO_RUNS if axial is None else _runs(axial, nodes),
        numerators,
        denominators,
        constants,
    )


def _runs(shaft: DiscretisedShaft, nodes: IndexArray) -> Runs:
    first: dict[bytes, int] = {}
    elements = [shaft.element[left:right].tobytes() for left, right in pairwise(nodes.tolist())]
    like = [first.setdefault(same, run) for run, same in enumerate(elements)]
    return shaft.table.lengths, shaft.table.coefficients, shaft.element, nodes, np.array(like, dtype=np.intp)


def _inertias(shaft: DiscretisedShaft, nodes: IndexArray, blocks: tuple[int, ...]) -> tuple[FloatArray, ComplexArray]:
    """Terms −M and the gyroscopic term of λΩ, (r + 1, n) both, of the inertias at nodes."""
    inertia, polar = shaft.node_inertia[nodes], shaft.node_polar[nodes]
    squared, turning = [], []
    for block in blocks:
        squared += [-inertia[:, 0], -inertia[:, -1]][: len(BLOCK_COORDINATES[block])]
        turning += [0.0 * polar, block * 1j * polar][: len(BLOCK_COORDINATES[block])]
    return np.stack(squared, axis=1), np.stack(turning, axis=1)


def _add_node_bearing(
    terms: "_Terms", node_bearing: NodeBearing, balance: IndexArray, node: IndexArray, places: BearingPlaces
) -> None:
    """Add the entries of a bearing's forces g and its pedestal's displacements p at a node."""
    shared = list(node_bearing.foot)
    denominators = _over(node_bearing.stiffness)
    grounded = _over(node_bearing.foot_stiffness)
    force, foot = places.force_rows, places.foot_rows
    terms.add(balance[:, None], places.forces, [-node_bearing.frame.conj().T])
    terms.add(
        force[:, None],
        node,
        [-node_bearing.stiffness @ node_bearing.frame, -node_bearing.damping @ node_bearing.frame],
        denominators[:, None],
    )
    terms.add(force, places.forces, [0.0, 0.0, 0.0, 0.0, 1.0], denominators)
    if shared:
        felt = [node_bearing.stiffness[:, shared], node_bearing.damping[:, shared]]
        terms.add(force[:, None], places.feet, felt, denominators[:, None])
        ground = [node_bearing.foot_stiffness, node_bearing.foot_damping, node_bearing.foot_mass]
        terms.add(foot[:, None], places.feet, ground, grounded[:, None])
        terms.add(foot, places.forces[shared], [0.0, 0.0, 0.0, 0.0, -1.0], grounded)


def _over(stiffness: ComplexArray) -> FloatArray:
    """Denominators (m, 2) that scale rows (m,) to one size by a factor independent of λ."""
    largest = np.abs(stiffness).max(axis=1, initial=0.0)
    return np.stack([np.ones_like(largest), largest], axis=1)


class _Terms:
    """Entries of the matrix, collected block by block."""

    def __init__(self) -> None:
        self.places: list[IndexArray] = []
        self.numerators: list[ComplexArray] = []
        self.denominators: list[FloatArray] = []

    def add(
        self,
        rows: IndexArray,
        columns: IndexArray,
        numerator: Sequence[npt.ArrayLike],
        denominator: FloatArray = UNIT_DENOMINATOR,
    ) -> None:
        """Entries at rows and columns that broadcast, with the leading coefficients of their numerators."""
        shape = np.broadcast(rows, columns).shape
        places = np.empty((2, *shape), dtype=np.intp)
        places[0], places[1] = rows, columns
        top, bottom = np.zeros((*shape, 5), dtype=np.complex128), np.empty((*shape, 2))
        for k, coefficient in enumerate(numerator):
            top[..., k] = coefficient
        bottom[:] = denominator
        self.places.append(places.reshape(2, -1))
        self.numerators.append(top.reshape(-1, 5))
        self.denominators.append(bottom.reshape(-1, 2))

    def parted(self) -> tuple[list[IndexArray], ComplexArray, FloatArray, ComplexArray]:
        """Rows and columns of varying and of constant entries, terms of the varying, values of the constant ones."""
        places = np.concatenate(self.places, axis=1)
        top, bottom = np.concatenate(self.numerators), np.concatenate(self.denominators)
        is_constant = ~top[:, 1:].any(axis=1) & (bottom == UNIT_DENOMINATOR).all(axis=1)
        varying, others = top.any(axis=1) & ~is_constant, is_constant & (top[:, 0] != 0.0)
        return [places[:, varying], places[:, others]], top[varying], bottom[varying], top[others, 0]
