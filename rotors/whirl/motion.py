"""Complex motion of a shaft in both planes, continued exactly from its node states, and its strain energy.

In motion Re[q̂ e^{λt}] strain energy swings at twice the frequency about a mean. The strain energy of a length of
shaft, a bearing or a pedestal is here the mean over one turn of the phase, with the growth or decay e^{Re λ t} left
out, ¼ Re(q̂ᴴ K q̂): of the shaft

    ¼ ∫ |f_x|²/(κGA + P) + |f_y|²/(κGA + P) + (|m_x|² + |m_y|²)/EI + g P (|β_x|² + |β_y|²) + |n|²/EA dz

with its complex shear forces f, bending moments m, slopes β and axial force n; of a spring K between the shaft and its
carrier ¼ Re(δᴴ K δ) with the complex deflection δ, in which a skew part of K, which stores nothing, takes no part. As
circular coordinates r± = (x ± i y)/√2 are unitary, the sums over x and y are those over + and −.

Without damping a share is also the sensitivity of the mode's frequency to that stiffness: with λ = iω and Hermitian
matrices, ∂ω/∂ln k of a part is proportional to its energy.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import ComplexArray, FloatArray, IndexArray
from gearwhine.rotors.model.bearing import Bearing
from gearwhine.rotors.model.profile import merged_positions
from gearwhine.rotors.transfer_matrix.discretised_shaft import (
    GAUSS_FRACTIONS,
    GAUSS_WEIGHTS,
    SQUARE_FRACTIONS,
    SQUARE_WEIGHTS,
    DiscretisedShaft,
)
from gearwhine.rotors.transfer_matrix.mode_shapes import require_positions
from gearwhine.rotors.whirl.circular_coordinates import BLOCK_COORDINATES
from gearwhine.rotors.whirl.equations import WhirlEquations, squared_frequencies


@dataclass(frozen=True)
class ShaftMotion:
    """Motions e^{λt} of a shaft, each with its own λ and speed of rotation.

    Attributes
    ----------
    shaft : DiscretisedShaft
        Elements and nodes of one plane.
    eigenvalues, speeds : ndarray of complex, shape (w,)
        Eigenvalues λ and speeds of rotation Ω [rad/s].
    forward, backward : ndarray of complex, shape (w, p + 1, 4)
        States r±, β± and the conjugate forces, right of every node, in scaled units.
    axial : ndarray of complex, shape (w, p + 1, 2)
        State z and its force; zero where no bearing couples it to lateral motion.
    rod : DiscretisedShaft or None
        The shaft's axial motion, discretised; None without any.
    """

    shaft: DiscretisedShaft
    eigenvalues: ComplexArray
    speeds: ComplexArray
    forward: ComplexArray
    backward: ComplexArray
    axial: ComplexArray
    rod: DiscretisedShaft | None = None

    @classmethod
    def of(
        cls,
        equations: WhirlEquations,
        eigenvalues: ComplexArray,
        speeds: ComplexArray,
        solutions: ComplexArray,
        scale: FloatArray,
    ) -> "ShaftMotion":
        """Motions from solutions (w, order) and their unit of force (w,); blocks without equations are at rest."""
        parts = equations.states(solutions, eigenvalues, speeds, scale)
        for block in BLOCK_COORDINATES.keys() - parts.keys():
            shape = (eigenvalues.size, equations.bending.nodes.size, 2 * len(BLOCK_COORDINATES[block]))
            parts[block] = np.zeros(shape, dtype=np.complex128)
        rod = equations.axial if 0 in equations.blocks else None
        return cls(equations.bending, eigenvalues, speeds, parts[1], parts[-1], parts[0], rod)

    @property
    def count(self) -> int:
        """Number of motions w."""
        return int(self.eigenvalues.size)

    def take(self, index: npt.ArrayLike) -> "ShaftMotion":
        """Return selected motions, in the order of the index."""
        chosen = np.asarray(index)
        return replace(
            self,
            eigenvalues=self.eigenvalues[chosen],
            speeds=self.speeds[chosen],
            forward=self.forward[chosen],
            backward=self.backward[chosen],
            axial=self.axial[chosen],
        )

    def joined(self, other: "ShaftMotion") -> "ShaftMotion":
        """Join these motions and others of the same shaft."""
        return replace(
            self,
            eigenvalues=np.concatenate([self.eigenvalues, other.eigenvalues]),
            speeds=np.concatenate([self.speeds, other.speeds]),
            forward=np.concatenate([self.forward, other.forward]),
            backward=np.concatenate([self.backward, other.backward]),
            axial=np.concatenate([self.axial, other.axial]),
        )

    def plus(self, other: "ShaftMotion") -> "ShaftMotion":
        """Sum of two responses at the same frequencies."""
        return replace(
            self,
            forward=self.forward + other.forward,
            backward=self.backward + other.backward,
            axial=self.axial + other.axial,
        )

    def scaled(self, factors: ComplexArray) -> "ShaftMotion":
        """Every motion times a number, (w,)."""
        by = factors[:, None, None]
        return replace(self, forward=by * self.forward, backward=by * self.backward, axial=by * self.axial)

    @cached_property
    def shares(self) -> FloatArray:
        """Integrals ∫ ρA |r±|² + ρI |β±|² dz of forward and backward part, and ∫ ρA |z|² dz, (w, 3) [kg·m²].

        The inertias of the nodes are included.
        """
        from gearwhine.rotors.whirl.shooting_matrix_kernels import inertia_shares

        shaft = self.shaft
        along = shaft.inertia_weights
        elements = shaft.table.lengths, shaft.table.coefficients, shaft.element
        shares = []
        for block, states in ((1, self.forward), (-1, self.backward)):
            squared = self._squared(block)
            shares.append(inertia_shares(elements, *squared, states, SQUARE_FRACTIONS, along, shaft.node_inertia))
        return np.stack([*shares, self._axial_inertia()], axis=-1)

    def _axial_inertia(self) -> FloatArray:
        """Integral ∫ ρA |z|² dz with the nodes' masses, (w,)."""
        rod = self.rod
        if rod is None:
            return np.zeros(self.count)
        numbers = np.repeat(np.arange(rod.element.size), SQUARE_FRACTIONS.size)
        fractions = np.tile(SQUARE_FRACTIONS, rod.element.size)
        transfer_matrices = rod.transfer_matrices_to(numbers, fractions, -(self.eigenvalues**2))
        along = np.einsum("zwj,wzj->wz", transfer_matrices[:, :, 0], self.axial[:, numbers])
        mass = rod.coefficients_at(numbers, fractions)[:, 1]
        weight = np.tile(SQUARE_WEIGHTS, rod.element.size) * np.repeat(rod.lengths, SQUARE_FRACTIONS.size) * mass
        nodal = np.abs(self.axial[:, :, 0]) ** 2 @ rod.node_inertia[:, 0]
        return np.asarray(np.abs(along) ** 2 @ weight + nodal)

    @property
    def direction(self) -> FloatArray:
        """Forward minus backward part of the lateral `shares`, −1 to 1, (w,); 0 without lateral motion."""
        forward, backward = self.shares[:, 0], self.shares[:, 1]
        lateral = forward + backward
        return np.divide(forward - backward, lateral, out=np.zeros_like(lateral), where=lateral > 0.0)

    @property
    def axial_share(self) -> FloatArray:
        """The axial part of all `shares`, (w,)."""
        return np.asarray(self.shares[:, 2] / self.shares.sum(axis=1))

    def at(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Forward and backward states (w, len(z), 4) at positions z [m], in scaled units, by the exact transfer.

        Raises
        ------
        RotorError
            A position is not on the shaft.
        """
        positions = require_positions(self.shaft.nodes, z)
        numbers, fractions = self.shaft.places(positions)
        return (
            self._inside(1, self.forward, numbers, fractions),
            self._inside(-1, self.backward, numbers, fractions),
        )

    def evaluate(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Complex x and y at positions z [m], both (w, len(z)) [m]."""
        forward, backward = self.at(z)
        unit = self.shaft.displacement_unit[0]
        return planes(forward[:, :, 0] * unit, backward[:, :, 0] * unit)

    def evaluate_slopes(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Complex slopes of the section in x and in y at positions z [m], both (w, len(z)) [rad]."""
        forward, backward = self.at(z)
        unit = self.shaft.displacement_unit[1]
        return planes(forward[:, :, 1] * unit, backward[:, :, 1] * unit)

    def section_loads(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Complex shear forces [N] and bending moments [N·m] at positions z [m], both (2, w, len(z)) over x and y."""
        forward, backward = self.at(z)
        unit = self.shaft.displacement_unit
        shear = planes(forward[:, :, 2] / unit[0], backward[:, :, 2] / unit[0])
        moment = planes(forward[:, :, 3] / unit[1], backward[:, :, 3] / unit[1])
        return np.array(shear), np.array(moment)

    def axial_at(self, z: npt.ArrayLike) -> ComplexArray:
        """Axial states (w, len(z), 2) at positions z [m] of a shaft that moves along its axis, in scaled units."""
        assert self.rod is not None
        numbers, fractions = self.rod.places(require_positions(self.rod.nodes, z))
        transfer_matrices = self.rod.transfer_matrices_to(numbers, fractions, -(self.eigenvalues**2))
        return np.asarray(np.einsum("zwij,wzj->wzi", transfer_matrices, self.axial[:, numbers]))

    def evaluate_axial(self, z: npt.ArrayLike) -> ComplexArray:
        """Complex displacement along the axis [m] at positions z [m], (w, len(z)); zero without axial motion."""
        if self.rod is None:
            return np.zeros((len(self.axial), np.size(z)), dtype=np.complex128)
        return np.asarray(self.axial_at(z)[:, :, 0] * self.rod.displacement_unit[0])

    def _inside(self, block: int, states: ComplexArray, numbers: IndexArray, fractions: FloatArray) -> ComplexArray:
        transfer_matrices = self.shaft.transfer_matrices_to(numbers, fractions, *self._squared(block))
        return np.asarray(np.einsum("zwij,wzj->wzi", transfer_matrices, states[:, numbers]))

    def _squared(self, block: int) -> tuple[ComplexArray, ComplexArray]:
        return squared_frequencies(block, self.eigenvalues, self.speeds)


def planes(forward: ComplexArray, backward: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return x and y of circular coordinates r± = (x ± i y)/√2."""
    root = np.sqrt(0.5)
    return np.asarray(root * (forward + backward)), np.asarray(-1j * root * (forward - backward))


@dataclass(frozen=True)
class StrainShares:
    """Shares of every mode's mean strain energy; their sum is one, or zero for a mode that strains nothing.

    Attributes
    ----------
    lengths : ndarray, shape (w, e)
        Shares in lengths of shaft.
    bearings : ndarray, shape (w, b)
        Shares in the bearings; the energy of a destabilising spring counts as negative.
    pedestals : ndarray, shape (w, b)
        Shares in the bearings' pedestals; zero where there is none.
    """

    lengths: FloatArray
    bearings: FloatArray
    pedestals: FloatArray


def strain_shares(motion: ShaftMotion, bearings: Sequence[Bearing], edges: npt.ArrayLike) -> StrainShares:
    """Shares of motions (w,) on bearings of constant coefficients, in lengths between ascending ``edges`` (e + 1,) [m].

    Raises
    ------
    RotorError
        A position is not on the shaft.
    """
    lengths = _along(motion, require_positions(motion.shaft.nodes, edges))
    in_bearings, in_pedestals = np.zeros((2, motion.count, len(bearings)))
    for k, bearing in enumerate(bearings):
        in_bearings[:, k], in_pedestals[:, k] = _in_springs(motion, bearing)
    whole = (lengths.sum(axis=1) + in_bearings.sum(axis=1) + in_pedestals.sum(axis=1))[:, None]
    parts = (
        np.divide(part, whole, out=np.zeros_like(part), where=whole > 0.0)
        for part in (lengths, in_bearings, in_pedestals)
    )
    return StrainShares(*parts)


def _along(motion: ShaftMotion, edges: FloatArray) -> FloatArray:
    """Four times the mean strain energy of the shaft between the edges, (w, e) [J]."""
    shaft = motion.shaft
    cuts = merged_positions(shaft.nodes, edges.tolist())
    widths = np.diff(cuts)
    places = (cuts[:-1, None] + widths[:, None] * GAUSS_FRACTIONS).ravel()
    weights = (widths[:, None] / shaft.length_unit * GAUSS_WEIGHTS).ravel()
    bent = shaft.coefficients_at(*shaft.places(places)) * weights[:, None]
    density = np.zeros((motion.count, places.size))
    for states in motion.at(places):
        squared = np.abs(states) ** 2
        density += squared[:, :, 1] * bent[:, 5] + squared[:, :, 2] * bent[:, 0] + squared[:, :, 3] * bent[:, 1]
    if motion.rod is not None:
        stretched = motion.rod.coefficients_at(*motion.rod.places(places))[:, 0] * weights
        density += np.abs(motion.axial_at(places)[:, :, 1]) ** 2 * stretched
    cells = density.reshape(motion.count, widths.size, -1).sum(axis=2)
    owner = np.searchsorted(edges, 0.5 * (cuts[1:] + cuts[:-1])) - 1
    return np.stack([cells[:, owner == k].sum(axis=1) for k in range(edges.size - 1)], axis=1)


def _in_springs(motion: ShaftMotion, bearing: Bearing) -> tuple[FloatArray, FloatArray]:
    """Four times the mean strain energy in a bearing and in its pedestal, (w,) each [J]."""
    x, y = (part[:, 0] for part in motion.evaluate([bearing.at]))
    slope_x, slope_y = (part[:, 0] for part in motion.evaluate_slopes([bearing.at]))
    along = motion.evaluate_axial([bearing.at])[:, 0]
    # The slope in x is the rotation about y, that in y minus the rotation about x.
    deflection = np.stack([x, y, along, -slope_y, slope_x], axis=1)
    stiffness, pedestal = bearing.spatial_stiffness, bearing.pedestal
    if pedestal is None:
        return _stored(stiffness, deflection), np.zeros(motion.count)
    at = motion.eigenvalues[:, None, None]
    dynamic = stiffness + at * bearing.spatial_damping
    ground = pedestal.stiffness + at * pedestal.damping + at**2 * pedestal.mass * np.eye(2)
    force = (dynamic[:, :2] @ deflection[:, :, None])[:, :, 0]
    foot = np.asarray(np.linalg.solve(ground + dynamic[:, :2, :2], force[:, :, None])[:, :, 0], np.complex128)
    deflection[:, :2] -= foot
    return _stored(stiffness, deflection), _stored(pedestal.stiffness, foot)


def _stored(stiffness: FloatArray, deflection: ComplexArray) -> FloatArray:
    """Compute Re(δᴴ K δ) of deflections (w, n), (w,)."""
    return np.asarray(np.einsum("wi,ij,wj->w", deflection.conj(), stiffness, deflection).real)
