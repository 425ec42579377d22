"""The equations of `rotors.spatial_chain` as a table, from which compiled code makes their entries for any λ.

Beside the transfer matrices of runs of pieces every entry is, with Ω the speed of rotation and s the unit of force,

    (c₀ + c₁ λ + c₂ λ² + c₃ λΩ + c₄ s) / (d₁ s + d₀):

ones and directions by c₀ = d₀ = 1; inertias by c₂, c₃ and d₁; bearings and pedestals by c₀, c₁, c₂ over s plus the
largest stiffness of their row, so that stiff directions and soft ones count alike; their forces by c₄.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .banded import BandPattern
from .chain import Chain
from .spatial_ties import MEMBERS, Tie

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]
Runs = tuple[FloatArray, FloatArray, IntArray, IntArray]

ALONE = np.array([0.0, 1.0])
OVER_FORCE = np.array([1.0, 0.0])
NO_RUNS = (np.zeros(0), np.zeros((0, 2, 1)), np.zeros(0, dtype=np.intp), np.zeros(1, dtype=np.intp))


@dataclass(frozen=True)
class EntryTable:
    """Entries of the equations of one chain.

    Attributes
    ----------
    pattern
        Where they stand.
    blocks
        1 for r+, −1 for r−, 0 for z.
    beams, rods
        Lengths (e,), coefficients (e, 6 or 2, j) of the pieces that differ, which of them each piece is, (p,), and
        the nodes with unknowns, between which pieces run together, (r + 1,); no rods without z.
    numerators, denominators
        (t, 5) complex and (t, 2): of the entries that are no transfer matrix's, and stand behind those.
    """

    pattern: BandPattern
    blocks: IntArray
    beams: Runs
    rods: Runs
    numerators: ComplexArray
    denominators: FloatArray

    def values(self, eigenvalues: ComplexArray, speeds: ComplexArray, scale: FloatArray) -> ComplexArray:
        """Entries at every λ, speed Ω (which may be complex) and unit of force, (b, nnz)."""
        from .entry_kernels import entries

        out = np.empty((eigenvalues.size, self.pattern.rows.size), dtype=np.complex128)
        entries(eigenvalues, speeds, scale, self.arrays, out)
        return out

    def log_determinants(self, eigenvalues: ComplexArray, speeds: ComplexArray, scale: FloatArray) -> ComplexArray:
        """Logarithms of the determinants, (b,), their imaginary parts within (−π, π]."""
        from .entry_kernels import determinants

        return np.asarray(determinants(eigenvalues, speeds, scale, self.arrays, self.pattern.arrays))

    @property
    def arrays(self) -> tuple[IntArray, Runs, Runs, ComplexArray, FloatArray]:
        """The table as compiled functions take it."""
        return self.blocks, self.beams, self.rods, self.numerators, self.denominators


def entry_table(
    bending: Chain,
    axial: Chain | None,
    blocks: tuple[int, ...],
    ties: Sequence[tuple[Tie, tuple[IntArray, IntArray]]],
    kept: IntArray,
    bounds: IntArray,
) -> EntryTable:
    """The table of a chain; ``bounds`` (r + 2,) are those of the unknowns of the nodes ``kept``, (r + 1,)."""
    starts, order = bounds[:-1], int(bounds[-1])
    n = sum(len(MEMBERS[block]) for block in blocks)
    across, right, first = np.arange(n), starts[1:, None], 0
    terms, transfers = _Terms(), []
    # Equations stand n above the unknowns: the first node has no piece to its left.
    for block in blocks:
        own = first + np.arange(len(MEMBERS[block]))
        local = np.concatenate([own, n + own])
        places = np.empty((2, starts.size - 1, local.size, local.size), dtype=np.intp)
        places[0], places[1] = right[:, :, None] - n + local[:, None], starts[:-1, None, None] + local
        transfers.append(places.reshape(2, -1))
        first += own.size
    terms.add(right - n + across, right + across, [1.0])
    node = starts[:, None] + across
    terms.add(node, node + n, [1.0])
    terms.add(node, node, [0.0, 0.0, *_inertias(bending, kept, blocks)], OVER_FORCE)
    for tie, (force, foot) in ties:
        _add_tie(terms, tie, starts[kept.searchsorted(tie.node)] + across, force, foot, n)
    terms.add(order - n + across, starts[-1] + n + across, [1.0])
    rows, columns = np.concatenate(transfers + terms.places, axis=1)
    return EntryTable(
        BandPattern.of(rows, columns, order),
        np.array(blocks, dtype=np.intp),
        _runs(bending, kept),
        NO_RUNS if axial is None else _runs(axial, kept),
        np.concatenate(terms.numerators),
        np.concatenate(terms.denominators),
    )


def _runs(chain: Chain, kept: IntArray) -> Runs:
    return chain.table.lengths, chain.table.coefficients, chain.element, kept


def _inertias(chain: Chain, kept: IntArray, blocks: tuple[int, ...]) -> tuple[FloatArray, ComplexArray]:
    """−M and the gyroscopic term of λΩ, (r + 1, n) both, of the nodes' own inertias."""
    inertia, polar = chain.node_inertia[kept], chain.node_polar[kept]
    squared, turning = [], []
    for block in blocks:
        squared += [-inertia[:, 0], -inertia[:, -1]][: len(MEMBERS[block])]
        turning += [0.0 * polar, block * 1j * polar][: len(MEMBERS[block])]
    return np.stack(squared, axis=1), np.stack(turning, axis=1)


def _add_tie(terms: "_Terms", tie: Tie, own: IntArray, force: IntArray, foot: IntArray, n: int) -> None:
    """Entries of a bearing with forces g and a pedestal's displacements p, behind its node's force balance."""
    shared = list(tie.foot)
    held = _over(tie.stiffness)
    grounded = _over(tie.foot_stiffness)
    terms.add(own[:, None], force, [-tie.frame.conj().T])
    terms.add(force[:, None] - n, own, [-tie.stiffness @ tie.frame, -tie.damping @ tie.frame], held[:, None])
    terms.add(force - n, force, [0.0, 0.0, 0.0, 0.0, 1.0], held)
    if shared:
        felt = [tie.stiffness[:, shared], tie.damping[:, shared]]
        terms.add(force[:, None] - n, foot, felt, held[:, None])
        ground = [tie.foot_stiffness, tie.foot_damping, tie.foot_mass]
        terms.add(foot[:, None] - n, foot, ground, grounded[:, None])
        terms.add(foot - n, force[shared], [0.0, 0.0, 0.0, 0.0, -1.0], grounded)


def _over(stiffness: ComplexArray) -> FloatArray:
    """Denominators of rows (m,) of one size, by a factor that does not vary with λ, (m, 2)."""
    largest = np.abs(stiffness).max(axis=1, initial=0.0)
    return np.stack([np.ones_like(largest), largest], axis=1)


class _Terms:
    """Entries as they come, block by block."""

    def __init__(self) -> None:
        self.places: list[IntArray] = []
        self.numerators: list[ComplexArray] = []
        self.denominators: list[FloatArray] = []

    def add(
        self, rows: IntArray, columns: IntArray, numerator: Sequence[npt.ArrayLike], denominator: FloatArray = ALONE
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
