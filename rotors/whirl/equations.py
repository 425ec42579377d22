"""Whirl equations: the exact transfer-matrix equations of both planes of a turning shaft at any complex frequency.

A motion e^{λt} of a disc turning at Ω obeys I_d λ²β_x + Ω I_p λ β_y = M_x and I_d λ²β_y − Ω I_p λ β_x = M_y
(`gearwhine.rotors.whirl.whirl_modes`). In the circular coordinates of `gearwhine.rotors.whirl.circular_coordinates`
these part into

    (I_d λ² ∓ iΩ I_p λ) β± = M± ,

and since a round section's polar inertia is twice its diametral one, every shaft element obeys the planar
equations of `gearwhine.rotors.transfer_matrix.timoshenko` with

    ω² → −λ² for translation,     ω² → −λ² ± 2iΩλ for rotation.

So the exact transfer matrices of both senses follow for any λ, with no modal truncation. Only the bearings couple the
two senses, and the shaft's axial motion where their 5x5 matrices do. At λ = iω forward whirl is r+.

The unknowns are the states (displacements u, forces f to the right) at some nodes, the forces g of bearings and the
displacements p of pedestals; the equations are those of multiple shooting,

    u_{i+1} = T₁₁ u_i + T₁₂ f_i
    f_{i+1} = T₂₁ u_i + T₂₂ f_i + (λ² M + λ G) u_{i+1} + Fᴴ g
    g = (K_b + λ C_b) (F u − p),        (K_p + λ C_p + λ² M_p) p = g

with the forces g in a node's bearings along directions F u of their own, and no force f right of the last node. Every
entry is an entire function of λ, the pedestals' resonances included, and so is the determinant; its zeros are the
eigenvalues, each with its multiplicity. (Elimination of the states shows it: the equations of the elements and of
the bearings' forces have unit diagonal, and what is left is the map from the displacements of the left end and of
the pedestals to the forces on the right end and the pedestals.) `gearwhine.rotors.whirl.shooting_matrix` puts them in
order.

A node without inertia or bearing needs no unknowns unless the motion grows too much along the way: a run of elements
has the product of their transfer matrices (`WhirlEquations.in_runs`), so that a shaft of sixty steps has no more
unknowns than a plain one.

Forces are scaled by the inertia forces of the frequency at hand, so that a nearly rigid shaft on soft
bearings loses no digits to its own stiffness.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearwhine.numerics.arrays import ComplexArray, FloatArray, IndexArray
from gearwhine.numerics.banded import BandPattern
from gearwhine.rotors.model.bearing import Bearing, RadialSupport
from gearwhine.rotors.model.shaft import Rotor
from gearwhine.rotors.transfer_matrix.discretised_shaft import DiscretisedShaft
from gearwhine.rotors.transfer_matrix.rotor_shafts import axial_shaft_on, discretised_bending_shaft
from gearwhine.rotors.whirl.circular_coordinates import BLOCK_COORDINATES, NodeBearing, bearing_at_node
from gearwhine.rotors.whirl.shooting_matrix import Layout, ShootingMatrix, shooting_matrix

# Least unit of force of a response, as a part of the stiffest bearing's force per unit displacement.
STATIC_FORCE = 1e-6
# Largest growth of motion along a run of elements, as a power of e: it costs the states two digits at most.
MOST_GROWTH = 4.5
# Number of frequencies in an octave for which equations are assembled.
REACH_STEPS = 4


@dataclass(frozen=True)
class WhirlEquations:
    """Exact equations of a rotor on its bearings, for one set of coupled motions.

    Attributes
    ----------
    rotor : Rotor
        The rotor.
    bending : DiscretisedShaft
        Elements and node inertias of one plane, without springs.
    blocks : tuple of int
        Blocks in the order of the unknowns: 1 for r+, −1 for r−, 0 for z.
    node_bearings : tuple of NodeBearing
        Bearings with constant coefficients.
    kept : ndarray of int, shape (r + 1,)
        Nodes whose states are unknowns, ascending: both ends, and nodes with inertia or a bearing.
    """

    rotor: Rotor
    bending: DiscretisedShaft
    blocks: tuple[int, ...]
    node_bearings: tuple[NodeBearing, ...]
    kept: IndexArray

    @property
    def size(self) -> int:
        """Number n of displacements at a node."""
        return sum(len(BLOCK_COORDINATES[block]) for block in self.blocks)

    @property
    def units(self) -> FloatArray:
        """SI value of each displacement of a node, (n,); forces have its reciprocal."""
        return block_units(self.bending, self.blocks)

    @cached_property
    def axial(self) -> DiscretisedShaft:
        """Axial motion of the same shaft, with the same nodes and units."""
        return axial_shaft_on(self.rotor, self.bending)

    @cached_property
    def total_mass(self) -> float:
        """Approximate mass of the rotor in scaled units."""
        shaft = self.bending
        along = shaft.coefficients_at(np.arange(shaft.element.size), np.full(shaft.element.size, 0.5))[:, 2]
        return float(along @ shaft.lengths + shaft.node_inertia[:, 0].sum())

    @cached_property
    def layout(self) -> Layout:
        """Order of unknowns and equations."""
        return Layout.of(self.blocks, self.kept, self.node_bearings)

    @cached_property
    def shooting_matrix(self) -> ShootingMatrix:
        """The table from which the matrix is made at any λ."""
        axial = self.axial if 0 in self.blocks else None
        return shooting_matrix(self.bending, axial, self.blocks, self.node_bearings, self.kept, self.layout)

    @property
    def pattern(self) -> BandPattern:
        """Rows and columns of the entries in `values`."""
        return self.shooting_matrix.pattern

    def force_scale(self, eigenvalues: ComplexArray) -> FloatArray:
        """Return the unit of forces for roots near every λ: the lesser of the inertia forces and the shaft's own."""
        return np.asarray(np.minimum(np.maximum(np.abs(eigenvalues) ** 2 * self.total_mass, 1e-30), 1.0))

    def response_scale(self, eigenvalues: ComplexArray) -> FloatArray:
        """Return the unit of forces for responses at every λ, zero included: bearings may carry more than inertia."""
        stiffest = max(
            (float(np.abs(node_bearing.stiffness).max(initial=0.0)) for node_bearing in self.node_bearings), default=1.0
        )
        least = np.full(eigenvalues.size, min(max(STATIC_FORCE * stiffest, 1e-30), 1.0))
        return np.asarray(np.maximum(self.force_scale(eigenvalues), least))

    def values(self, eigenvalues: ComplexArray, speeds: ComplexArray, scale: FloatArray) -> ComplexArray:
        """Entries of the equations at every λ, speed Ω (which may be complex) and unit of force, (b, nnz)."""
        return self.shooting_matrix.values(eigenvalues, speeds, scale)

    def node_terms(self, eigenvalues: ComplexArray, speeds: ComplexArray) -> ComplexArray:
        """Inertia terms λ²M ∓ iΩλ I_p of the nodes, (b, p + 1, n)."""
        shaft = self.bending
        squared = eigenvalues[:, None] ** 2
        columns = []
        for block in self.blocks:
            columns.append(squared * shaft.node_inertia[:, 0])
            if block:
                gyroscopic = (block * 1j * speeds * eigenvalues)[:, None] * shaft.node_polar
                columns.append(squared * shaft.node_inertia[:, 1] - gyroscopic)
        return np.stack(columns, axis=-1)

    def dense_transfers(self, eigenvalues: ComplexArray, speeds: ComplexArray, scale: FloatArray) -> ComplexArray:
        """Transfer matrices of all blocks together, (p, b, 2n, 2n), displacements before forces."""
        n = self.size
        dense = np.zeros((self.bending.lengths.size, eigenvalues.size, 2 * n, 2 * n), dtype=np.complex128)
        first = 0
        for block in self.blocks:
            local = first + np.arange(len(BLOCK_COORDINATES[block]))
            both = np.concatenate([local, n + local])
            dense[:, :, both[:, None], both] = self._transfers(block, eigenvalues, speeds, scale)
            first += local.size
        return dense

    def _transfers(
        self, block: int, eigenvalues: ComplexArray, speeds: ComplexArray, scale: FloatArray
    ) -> ComplexArray:
        shaft = self.bending if block else self.axial
        transfer = shaft.transfer_matrices(*squared_frequencies(block, eigenvalues, speeds))
        half = transfer.shape[-1] // 2
        transfer[..., :half, half:] *= scale[:, None, None]
        transfer[..., half:, :half] /= scale[:, None, None]
        return transfer

    def states(
        self, solutions: ComplexArray, eigenvalues: ComplexArray, speeds: ComplexArray, scale: FloatArray
    ) -> dict[int, ComplexArray]:
        """States (b, p + 1, 2 or 4) of every block at all nodes in scaled units, from solutions (b, order)."""
        from gearwhine.rotors.whirl.shooting_matrix_kernels import node_states

        states, unknowns = {}, np.ascontiguousarray(solutions)
        for block, places in zip(self.blocks, self._state_places, strict=True):
            block_states = np.empty((eigenvalues.size, self.bending.nodes.size, places.shape[1]), dtype=np.complex128)
            runs = self.shooting_matrix.beams if block else self.shooting_matrix.rods
            node_states(runs, *squared_frequencies(block, eigenvalues, speeds), places, scale, unknowns, block_states)
            states[block] = block_states
        return states

    @cached_property
    def _state_places(self) -> list[IndexArray]:
        """Unknown of every state of every block at the kept nodes, (r + 1, 2 or 4); −1 where there is none."""
        first, places, layout = 0, [], self.layout
        forces = np.concatenate([layout.forces, np.full((1, self.size), -1)])
        for block in self.blocks:
            columns = slice(first, first + len(BLOCK_COORDINATES[block]))
            places.append(np.concatenate([layout.displacements[:, columns], forces[:, columns]], axis=1))
            first = columns.stop
        return places

    def in_runs(self) -> "WhirlEquations":
        """Reduce the equations to unknowns at loaded nodes only; no external load may act at the others."""
        shaft = self.bending
        needed = shaft.node_inertia.any(axis=1) | (shaft.node_polar != 0.0)
        needed[[0, -1, *(node_bearing.node for node_bearing in self.node_bearings)]] = True
        growth, total = shaft.table.growth(shaft.highest)[shaft.element].tolist(), 0.0
        for number, element_growth in enumerate(growth):
            needed[number] |= total + element_growth > MOST_GROWTH
            total = element_growth if needed[number] else total + element_growth
        return replace(self, kept=np.flatnonzero(needed))


def block_units(shaft: DiscretisedShaft, blocks: tuple[int, ...]) -> FloatArray:
    """Units of a node's displacements, (n,)."""
    return np.concatenate([shaft.displacement_unit if block else shaft.displacement_unit[:1] for block in blocks])


def squared_frequencies(
    block: int, eigenvalues: ComplexArray, speeds: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """ω² of translation and of rotation in the circular coordinates of a block, (w,) both."""
    translation = -(eigenvalues**2)
    return translation, translation + block * 2j * speeds * eigenvalues


def whirl_reach(limit: float, speed: float) -> float:
    """Planar frequency for which elements must be short enough, for whirl up to ``limit`` at ``speed`` [rad/s].

    The rotary inertia's ω² ± 2Ωω is largest in magnitude at ω(ω + 2|Ω|).
    """
    return math.sqrt(limit * (limit + 2.0 * abs(speed)))


def whirl_equations(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    blocks: tuple[int, ...],
    highest: float,
    places: Sequence[float] = (),
) -> WhirlEquations:
    """Exact equations of one set of coupled motions of a rotor on bearings of constant coefficients.

    Parameters
    ----------
    rotor, bearings : Rotor, sequence of Bearing
        The rotor and its bearings.
    blocks : tuple of int
        One of `gearwhine.rotors.whirl.circular_coordinates.coupled_motions`.
    highest : float
        Planar frequency up to which elements are short enough [rad/s]: see `whirl_reach`.
    places : sequence of float
        Further places to be nodes [m].
    """
    supports = [RadialSupport(at, 0.0) for at in (*(bearing.at for bearing in bearings), *places)]
    shaft = discretised_bending_shaft(rotor, tuple(supports), highest)
    units = block_units(shaft, blocks)
    node_bearings = tuple(bearing_at_node(bearing, shaft.node_at(bearing.at), blocks, units) for bearing in bearings)
    return WhirlEquations(rotor, shaft, blocks, node_bearings, np.arange(shaft.nodes.size))


def whirl_equations_in_runs(
    rotor: Rotor, bearings: Sequence[Bearing], blocks: tuple[int, ...], highest: float
) -> WhirlEquations:
    """Assemble the equations of `whirl_equations` in runs, for whirl up to a planar frequency of ``highest`` rad/s."""
    return whirl_equations(rotor, bearings, blocks, reach_step(highest)).in_runs()


def reach_step(highest: float) -> float:
    """Round up to a frequency [rad/s] that equations are made for, so that those of near speeds are the same."""
    return math.exp2(math.ceil(REACH_STEPS * math.log2(highest)) / REACH_STEPS)


def equations_at_speed(equations: WhirlEquations, bearings: Sequence[Bearing], speed: float) -> WhirlEquations:
    """Replace the bearings' coefficients in the equations by those at another speed [rad/s]."""
    units = block_units(equations.bending, equations.blocks)
    node_bearings = tuple(
        bearing_at_node(bearing.at_speed(speed), node_bearing.node, equations.blocks, units)
        for bearing, node_bearing in zip(bearings, equations.node_bearings, strict=True)
    )
    return replace(equations, node_bearings=node_bearings)
