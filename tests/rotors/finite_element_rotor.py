"""A rotor by finite elements of high degree, in thirty-one digits: the reference that shares nothing with `rotors`.

`PlaneModel` is one motion (bending in a plane, torsion, axial) of a rotor with springs to ground. Its natural
frequencies below any frequency are counted by Sylvester's law of inertia on K − ω² M, factorised in double-double
arithmetic, and found from that count alone. `assembled` gives the same matrices in doubles, for what needs no more.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from double_double import DoubleDouble
from inertia_count import negative_pivots
from lobatto_elements import Elements, Matrices, bending_matrices, cut, rod_matrices
from scipy import linalg

from gearwhine.numerics.arrays import FloatArray, IndexArray
from gearwhine.rotors import Coupling, RadialSupport, Rotor

# Part of itself to which a frequency is known from the count.
WIDTH = 1e-12
SECTIONS = 15
FLOOR = 1e-10


@dataclass(frozen=True)
class PlaneModel:
    """One motion of a rotor: element matrices, and what stands at the nodes.

    Attributes
    ----------
    elements, matrices
        The elements and their matrices.
    node_stiffness, node_mass, node_polar
        (nodes, size): springs to ground, infinite where held, and inertias.
    """

    elements: Elements
    matrices: Matrices
    node_stiffness: FloatArray
    node_mass: FloatArray
    node_polar: FloatArray

    def wittrick_williams_count(self, frequencies: npt.ArrayLike) -> IndexArray:
        """Number of natural frequencies below each of some frequencies (rad/s), multiple ones with multiplicity."""
        omega = np.atleast_1d(np.asarray(frequencies, dtype=np.float64))
        stiffness, mass = self.matrices.stiffness, self.matrices.mass
        arrays = (stiffness.high, stiffness.low, mass.high, mass.low, self.node_stiffness, self.node_mass)
        return np.array([negative_pivots(*arrays, frequency) for frequency in omega.tolist()], dtype=np.intp)

    def natural_frequencies(self, below: float, floor: float = FLOOR) -> FloatArray:
        """Every natural frequency below a limit, ascending, from the count alone, rad/s.

        What lies below ``floor`` times the limit is given as zero.
        """
        # Estimates in doubles only choose where to count first.
        estimates = self._estimates()
        near = (estimates[:, None] * (1.0 + np.outer([-1.0, 1.0], [1e-12, 1e-8, 1e-4]).ravel())).ravel()
        probes = np.unique(np.concatenate([below * np.geomspace(floor, 1.0, 11), near]))
        probes = probes[(probes >= floor * below) & (probes <= below)]
        counts = self.wittrick_williams_count(probes)
        zeros = int(counts[0])
        wanted = np.arange(zeros, int(counts[-1]))
        above = np.array([int(np.argmax(counts > index)) for index in wanted], dtype=np.intp)
        low, high = probes[above - 1], probes[above]
        rows, fractions = np.arange(wanted.size), np.arange(1, SECTIONS + 1) / (SECTIONS + 1)
        while wanted.size and bool((high > low * (1.0 + WIDTH)).any()):
            inner = low[:, None] * (high / low)[:, None] ** fractions
            different, back = np.unique(inner, return_inverse=True)
            is_above = self.wittrick_williams_count(different)[back].reshape(inner.shape) > wanted[:, None]
            edges = np.concatenate([low[:, None], inner, high[:, None]], axis=1)
            first = np.where(is_above.any(axis=1), np.argmax(is_above, axis=1), SECTIONS)
            low, high = edges[rows, first], edges[rows, first + 1]
        return np.concatenate([np.zeros(zeros), np.sqrt(low) * np.sqrt(high)])

    def _estimates(self) -> FloatArray:
        free = np.flatnonzero(~self.held)
        stiffness, mass = (self.assembled(name)[np.ix_(free, free)] for name in ("stiffness", "mass"))
        scale = 1.0 / np.sqrt(np.diag(stiffness) + np.diag(mass))
        balance = np.outer(scale, scale)
        # Inverted, so that inertias may be zero and rounding is that of the highest period, not frequency.
        shift = 1e-8 * np.trace(balance * stiffness) / max(np.trace(balance * mass), 1e-300)
        inverse = linalg.eigh(balance * mass, balance * (stiffness + shift * mass), eigvals_only=True)
        squared = 1.0 / inverse[inverse > 1e-14 * inverse[-1]] - shift
        return np.sqrt(squared[squared > 0.0])

    @property
    def positions(self) -> IndexArray:
        """Places of each element's unknowns in the whole, (e, n); node by node first, then bubbles."""
        size, n = self.matrices.size, self.matrices.stiffness.high.shape[-1]
        count, bubbles = self.elements.lengths.size, n - 2 * size
        ends = size * np.arange(count)[:, None] + np.arange(2 * size)
        inner = size * (count + 1) + bubbles * np.arange(count)[:, None] + np.arange(bubbles)
        return np.hstack([ends, inner])

    @property
    def held(self) -> npt.NDArray[np.bool_]:
        """Which unknowns are held, over the whole."""
        order = int(self.positions.max()) + 1
        held = np.zeros(order, dtype=bool)
        held[: self.node_stiffness.size] = np.isinf(self.node_stiffness).ravel()
        return held

    def assembled(self, name: str) -> FloatArray:
        """Stiffness, mass or polar matrix ("stiffness", ...) of the whole, held unknowns included, in doubles."""
        at_nodes = {"stiffness": self.node_stiffness, "mass": self.node_mass, "polar": self.node_polar}[name].ravel()
        place, blocks = self.positions, getattr(self.matrices, name).high
        whole = np.zeros((self.held.size, self.held.size))
        np.add.at(whole, (place[:, :, None], place[:, None, :]), blocks)
        diagonal = np.arange(at_nodes.size)
        whole[diagonal, diagonal] += np.where(np.isinf(at_nodes), 0.0, at_nodes)
        return whole


def bending_model(
    rotor: Rotor,
    supports: Sequence[RadialSupport],
    highest: float,
    *,
    places: Sequence[float] = (),
) -> PlaneModel:
    """Bending in one plane, converged up to ``highest`` rad/s; with nodes at ``places`` (m) too."""
    elements = cut(rotor, [*places, *(support.at for support in supports)], highest)
    stiffness = np.zeros((elements.nodes.size, 2))
    for support in supports:
        stiffness[elements.node(support.at)] += support.stiffness, support.tilt_stiffness
    inertia = node_inertias(rotor, elements)
    polar = np.stack([np.zeros(elements.nodes.size), inertia[:, 2]], axis=1)
    return PlaneModel(elements, bending_matrices(rotor, elements), stiffness, inertia[:, :2], polar)


def rod_model(
    rotor: Rotor,
    motion: str,
    highest: float,
    *,
    springs: Sequence[tuple[float, float]] = (),
) -> PlaneModel:
    """Torsion ("torsion") or axial motion ("axial"), with springs to ground, each a place (m) and a stiffness."""
    elements = cut(rotor, [at for at, _ in springs], highest, bends=False)
    stiffness = np.zeros((elements.nodes.size, 1))
    for at, value in springs:
        stiffness[elements.node(at)] += value
    inertia = node_inertias(rotor, elements)[:, [2 if motion == "torsion" else 0]]
    matrices = rod_matrices(rotor, elements, motion)
    return PlaneModel(elements, matrices, stiffness, inertia, np.zeros_like(inertia))


def node_inertias(rotor: Rotor, elements: Elements) -> FloatArray:
    """Mass, diametral and polar inertia of discs, couplings' halves and lumped segments' halves, (nodes, 3)."""
    inertias = np.zeros((elements.nodes.size, 3))
    for disc in rotor.discs:
        inertias[elements.node(disc.at)] += disc.mass, disc.diametral_inertia, disc.polar_inertia
    for index, part in enumerate(rotor.segments):
        if isinstance(part, Coupling) or rotor.mass_model == "lumped":
            # Of a joint between tiny segments the place does not tell the node: the elements' own order does.
            own = np.flatnonzero(elements.segment == index)
            for node in (int(own[0]), int(own[-1]) + 1):
                inertias[node] += 0.5 * np.array([part.mass, part.diametral_inertia, part.polar_inertia])
    return inertias


def condensed(model: PlaneModel) -> PlaneModel:
    """The same elements with their bubbles carried along statically (Guyan), in doubles.

    Of uniform segments this is the two-node element of the textbooks: shape functions that are the static deflections
    of a Timoshenko beam, with mass and gyroscopic matrices consistent with them (Przemieniecki 1968; Nelson 1980).
    """
    matrices = model.matrices
    kept = 2 * matrices.size
    stiffness = matrices.stiffness.high
    bubbles = -np.linalg.solve(stiffness[:, kept:, kept:], stiffness[:, kept:, :kept])
    shapes = np.concatenate([np.broadcast_to(np.eye(kept), (stiffness.shape[0], kept, kept)), bubbles], axis=1)
    small = (
        DoubleDouble.of(shapes.transpose(0, 2, 1) @ matrix.high @ shapes)
        for matrix in (matrices.stiffness, matrices.mass, matrices.polar)
    )
    return replace(model, matrices=Matrices(matrices.size, *small))
