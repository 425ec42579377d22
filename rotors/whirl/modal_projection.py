"""Modal projection of whirl on planar modes: starting values for the exact roots.

Both planes share the modes at averaged bearing stiffness, X = Φᵀ q_x and Y = Φᵀ q_y. With Λ = diag(ω²),
G the polar inertia matrix and Φ_b the modes' displacements at bearing b,

    q̈_x + Ω G q̇_y + Σ_b Φ_b Φ_bᵀ (c_xx q̇_x + c_xy q̇_y) + Λ q_x + Σ_b Φ_b Φ_bᵀ [(k_xx − k̄) q_x + k_xy q_y] = 0
    q̈_y − Ω G q̇_x + Σ_b Φ_b Φ_bᵀ (c_yx q̇_x + c_yy q̇_y) + Λ q_y + Σ_b Φ_b Φ_bᵀ [k_yx q_x + (k_yy − k̄) q_y] = 0

(TM-104434 Eqs. 11–15 with constant speed and grounded bearings). The sums over bearings are its compensation
matrices. Slopes, axial modes and pedestals are added where bearings have them. Each set of motions that the bearings
couple is projected on its own; where forward and backward motion are not coupled, each in the circular coordinates of
`gearwhine.rotors.whirl.circular_coordinates`.

A lightly damped rotor whose planes are coupled by the gyroscopic moment alone is solved by perturbation. Let Λ_x
and Λ_y be the squared frequencies of both planes at rest, and all matrices be those of their modes. With states
p = (Λ_x^½ q_x, q̇_y) and s = (q̇_x, −Λ_y^½ q_y), undamped motion at the speed Ω is

    ṗ = C s,    ṡ = −Cᵀp,    C = [[Λ_x^½, 0], [Ω G, Λ_y^½]],

so that its frequencies are the singular values of C = U σ Vᵀ, and its motions p = u_k, s = ± i v_k: a symmetric
eigenproblem CᵀC of half the order of the system in q and q̇. Damping is −D_y on q̇_y in p and −D_x on q̇_x in s; with
A = Uᵀ(−D)U / 2 and B = Vᵀ(−D)V / 2 of either, perturbation to second order makes

    λ_k = iσ_k + A_kk + B_kk + Σ_{j≠k} (A + B)_kj (A + B)_jk / i(σ_k − σ_j) + Σ_j (A − B)_kj (A − B)_jk / i(σ_k + σ_j).

The error is of third order, provided that damping couples modes by a small part of the distance of their eigenvalues.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import linalg

from gearwhine.numerics.arrays import BoolArray, ComplexArray, FloatArray, IndexArray
from gearwhine.rotors.model.bearing import Bearing
from gearwhine.rotors.model.shaft import Rotor
from gearwhine.rotors.modes.modal_rotor import gyroscopic_matrix, section_motions
from gearwhine.rotors.modes.torsional_and_axial import solve_axial_modes
from gearwhine.rotors.transfer_matrix.rotor_shafts import rod_shaft
from gearwhine.rotors.whirl.circular_coordinates import BLOCK_COORDINATES, CIRCULAR, coupled_motions
from gearwhine.rotors.whirl.planar_basis import (
    PlanarBasis,
)

# Largest squared coupling of modes by damping, relative to their distance: starting values then err by a thousandth of
# the distance. Checked for the lower half: above are responses to loads, which stand for all higher modes and start no
# root.
MOST_MIXED = 0.01
# Part of the largest squared frequency below which squared frequencies lose their digits in CᵀC.
LEAST_SQUARED = 1e-10
# Largest asymmetry of a stiffness over its size that is rounding.
ROUNDING = 1e-12
NumberArray = npt.NDArray[Any]

AXIAL_MODES = 8
# Mass of a massless pedestal in the projection, as a part of the rotor's: every coordinate needs a mass.
PEDESTAL_MASS = 1e-6


@dataclass(frozen=True)
class CoupledPlanes:
    """Both planes at rest, with gyroscopic coupling and light damping.

    Attributes
    ----------
    frequencies : ndarray, shape (x + y,)
        Natural frequencies of both planes at rest, ascending in each [rad/s].
    gyroscopic : ndarray, shape (y, x)
        Gyroscopic matrix G, per rad/s of the speed.
    damping_x, damping_y : ndarray, shapes (x, x) and (y, y)
        Damping matrices D [1/s].
    """

    frequencies: FloatArray
    gyroscopic: FloatArray
    damping_x: FloatArray
    damping_y: FloatArray

    @classmethod
    def of(
        cls, mass: FloatArray, stiffness: FloatArray, damping: FloatArray, gyroscopic: FloatArray, in_x: BoolArray
    ) -> "CoupledPlanes | None":
        """Split diagonal mass (N,) and matrices (N, N) into planes, one marked by ``in_x``; None if not applicable."""
        x, y = np.flatnonzero(in_x), np.flatnonzero(~in_x)
        apart = np.ix_(x, y), np.ix_(y, x)
        within = np.ix_(x, x), np.ix_(y, y)
        if any(matrix[place].any() for matrix in (stiffness, damping) for place in apart):
            return None
        skewed = np.abs(stiffness - stiffness.T).max() > ROUNDING * np.abs(stiffness).max()
        if skewed or any(gyroscopic[place].any() for place in within):
            return None
        unit = 1.0 / np.sqrt(mass)
        stiffness, damping, gyroscopic = (unit[:, None] * m * unit for m in (stiffness, damping, gyroscopic))
        (squared_x, shapes_x), (squared_y, shapes_y) = (np.linalg.eigh(stiffness[place]) for place in within)
        squared = np.concatenate([squared_x, squared_y])
        if squared.min() <= LEAST_SQUARED * squared.max():
            return None
        return cls(
            np.sqrt(squared),
            -shapes_y.T @ gyroscopic[apart[1]] @ shapes_x,
            shapes_x.T @ damping[within[0]] @ shapes_x,
            shapes_y.T @ damping[within[1]] @ shapes_y,
        )

    def eigenvalues(self, speeds: FloatArray) -> tuple[ComplexArray, BoolArray]:
        """All λ with conjugates, (speeds, 2N), rad/s, and the speeds at which damping couples modes too strongly."""
        from gearwhine.rotors.whirl.eigenvalue_kernels import damped, squares

        squared, right = np.linalg.eigh(squares(self.frequencies, self.gyroscopic, speeds))
        undamped = self.frequencies, self.gyroscopic, speeds
        values, mixed = damped(squared, right, *undamped, self.damping_x, self.damping_y)
        return values, mixed > MOST_MIXED


def slowest(bearing: Bearing) -> float:
    """Return the lowest speed of a bearing's tables, or zero [rad/s]."""
    return 0.0 if bearing.speeds is None else float(bearing.speeds[0])


@dataclass(frozen=True)
class ModalProjection:
    """Projection of one set of coupled motions of a rotor on its modal basis.

    Coordinates are the circular ones of `gearwhine.rotors.whirl.circular_coordinates` where forward or backward motion
    stands alone. Where both are coupled they are those of x and y, in which all matrices are real and the eigenproblem
    costs a third.

    Attributes
    ----------
    basis : PlanarBasis
        Basis of the motions of one plane.
    blocks : tuple of int
        Blocks as of `gearwhine.rotors.whirl.equations.WhirlEquations`.
    axial_frequencies, axial_shapes : ndarray, shapes (a,) and (a, bearings)
        Frequencies of the free axial modes [rad/s], and their shapes at the bearings; empty where no bearing needs
        them.
    total_mass : float
        Mass of the rotor [kg].
    """

    basis: PlanarBasis
    blocks: tuple[int, ...]
    axial_frequencies: FloatArray
    axial_shapes: FloatArray
    total_mass: float

    @classmethod
    def of(
        cls, rotor: Rotor, bearings: Sequence[Bearing], blocks: tuple[int, ...], basis: PlanarBasis
    ) -> "ModalProjection":
        """Project one set of coupled motions of a rotor on a planar basis."""
        frequencies, shapes = np.zeros(0), np.zeros((0, len(bearings)))
        if 0 in blocks:
            frequencies, shapes = _axial_modes(rotor, bearings)
        return cls(basis, blocks, frequencies, shapes, rotor.mass)

    @property
    def floor(self) -> float:
        """The lowest frequency of the basis that is not a rigid motion's zero [rad/s]."""
        return self.basis.floor

    def matrices(self, bearings: Sequence[Bearing]) -> tuple[FloatArray, NumberArray, NumberArray, NumberArray]:
        """Diagonal mass (N,), stiffness, damping and gyroscopic matrix per rad/s, (N, N) each."""
        b, a = self.basis.count, self.axial_frequencies.size
        alone = len(self.blocks) == 1
        shaft = b if alone else 2 * b + a
        relative, stiffnesses, dampings, feet = self._bearing_terms(bearings, shaft)
        order = relative.shape[-1]
        rows = relative.reshape(-1, order)
        mass = np.ones(order)
        stiffness, damping = rows.T @ _times(stiffnesses, relative), rows.T @ _times(dampings, relative)
        gyroscopic = np.zeros_like(stiffness)
        if alone:
            stiffness[:b, :b] += self.basis.stiffness
            gyroscopic[:b, :b] = -1j * self.blocks[0] * self.basis.polar_inertia
        else:
            stiffness[:b, :b] += self.basis.stiffness
            stiffness[b : 2 * b, b : 2 * b] += self.basis.stiffness
            gyroscopic[: 2 * b, : 2 * b] = gyroscopic_matrix(self.basis.polar_inertia)
            axial = np.arange(2 * b, 2 * b + a)
            stiffness[axial, axial] += self.axial_frequencies**2
        for bearing, coordinates, directions in feet:
            assert bearing.pedestal is not None
            foot_block, ground = np.ix_(coordinates, coordinates), np.ix_(directions, directions)
            stiffness[foot_block] += self._turned(bearing.pedestal.stiffness)[ground]
            damping[foot_block] += self._turned(bearing.pedestal.damping)[ground]
            mass[coordinates] = max(bearing.pedestal.mass, PEDESTAL_MASS * self.total_mass)
        return mass, stiffness, damping, gyroscopic

    def pencil(self, bearings: Sequence[Bearing]) -> "Pencil":
        """Return the projected motion as a system of first order; bearings have constant coefficients."""
        mass, stiffness, damping, gyroscopic = self.matrices(bearings)
        order = mass.size
        # States W q and q̇ make the undamped system matrix nearly skew, so that high members of the basis
        # do not cost the low eigenvalues their digits.
        weight = np.sqrt(np.maximum(np.abs(stiffness.diagonal()) / mass, self.floor**2))
        system = np.zeros((2, 2 * order, 2 * order), dtype=np.result_type(stiffness, gyroscopic))
        system[0, :order, order:] = np.diag(weight)
        system[0, order:, :order] = stiffness / (-mass[:, None] * weight)
        system[:, order:, order:] = np.array([damping, gyroscopic]) / -mass[:, None]
        return Pencil(self.blocks, system[0], system[1], self._tied_planes(mass, stiffness, damping, gyroscopic))

    def _tied_planes(
        self, mass: FloatArray, stiffness: NumberArray, damping: NumberArray, gyroscopic: NumberArray
    ) -> CoupledPlanes | None:
        if self.blocks != (1, -1):
            return None
        b = self.basis.count
        # Behind the shaft's coordinates stand those of pedestals, each in the plane that its stiffness couples it to.
        in_x = np.asarray(stiffness[:, :b].any(axis=1))
        in_x[: 2 * b] = np.arange(2 * b) < b
        return CoupledPlanes.of(mass, stiffness, damping, gyroscopic, in_x)

    def critical(self, bearings: Sequence[Bearing]) -> ComplexArray:
        """λ at which λ = iΩ, from K q = ω² (M − iG) q with the gyroscopic term beside the mass, (N,)."""
        mass, stiffness, _, gyroscopic = self.matrices(bearings)
        weight = np.sqrt(np.maximum(np.abs(stiffness.diagonal()) / mass, self.floor**2))
        inertia = (np.diag(mass) - 1j * gyroscopic) / np.outer(weight, weight)
        squared = linalg.eigvals(stiffness / np.outer(weight, weight), inertia)
        return np.asarray(1j * np.sqrt(squared[np.isfinite(squared)]))

    def _bearing_terms(
        self, bearings: Sequence[Bearing], shaft: int
    ) -> tuple[NumberArray, NumberArray, NumberArray, list[tuple[Bearing, IndexArray, list[int]]]]:
        """Motions of every bearing, its stiffness and damping, and the coordinates of its pedestal.

        The motions are those of the shaft less the pedestal's, (bearings, n, N), along x, y, z and the rotations about
        x and y, or along r and β; the matrices (bearings, n, n) belong to them. A pedestal has the coordinates and
        the directions in which its bearing acts.
        """
        b = self.basis.count
        alone = len(self.blocks) == 1
        spatial = np.zeros((2, len(bearings), 5, 5))
        for k, bearing in enumerate(bearings):
            spatial[0, k], spatial[1, k] = bearing.spatial_stiffness, bearing.spatial_damping
        matrices: NumberArray = spatial
        if alone:
            turn = CIRCULAR[list(BLOCK_COORDINATES[self.blocks[0]])]
            matrices = turn @ spatial @ turn.conj().T
        feet: list[tuple[int, IndexArray, list[int]]] = []
        order = shaft
        for k, bearing in enumerate(bearings):
            if bearing.pedestal is None:
                continue
            acts = (matrices[0, k] != 0.0) | (matrices[1, k] != 0.0)
            busy = acts.any(axis=0) | acts.any(axis=1)
            directions = [direction for direction in ((0,) if alone else (0, 1)) if busy[direction]]
            feet.append((k, order + np.arange(len(directions)), directions))
            order += len(directions)
        relative = np.zeros((len(bearings), matrices.shape[-1], order))
        displacement, slope = self.basis.displacement, self.basis.slope
        if bearings and alone:
            relative[:, 0, :b], relative[:, 1, :b] = displacement.T, slope.T
        elif bearings:
            relative[:, :, :shaft] = section_motions(displacement, slope, self.axial_shapes)
        for k, coordinates, directions in feet:
            relative[k, directions, coordinates] -= 1.0
        return (
            relative,
            matrices[0],
            matrices[1],
            [(bearings[k], coordinates, directions) for k, coordinates, directions in feet],
        )

    def _turned(self, radial: FloatArray) -> NumberArray:
        """Transform a matrix over x and y to the projection's coordinates."""
        if len(self.blocks) > 1:
            return radial
        turn = CIRCULAR[BLOCK_COORDINATES[self.blocks[0]][0], :2]
        return np.asarray([[turn @ radial @ turn.conj()]])


@dataclass(frozen=True)
class Pencil:
    """First-order system, still + Ω turning, of one projected set of coupled motions.

    Attributes
    ----------
    blocks : tuple of int
        Blocks as of `gearwhine.rotors.whirl.equations.WhirlEquations`.
    still, turning : ndarray, shape (2N, 2N)
        Constant part [1/s], and part per rad/s of the speed Ω.
    planes : CoupledPlanes or None
        The cheaper form for lightly damped planes, where it applies.
    """

    blocks: tuple[int, ...]
    still: NumberArray
    turning: NumberArray
    planes: CoupledPlanes | None

    def eigenvalues(self, speeds: FloatArray) -> ComplexArray:
        """All eigenvalues at every speed, (speeds, 2N), rad/s, as starting values."""
        if self.planes is None:
            return self._by_systems(speeds)
        values, mixed = self.planes.eigenvalues(speeds)
        if mixed.any():
            values[mixed] = self._by_systems(speeds[mixed])
        return values

    def _by_systems(self, speeds: FloatArray) -> ComplexArray:
        systems = self.still + speeds[:, None, None] * self.turning
        return np.asarray(np.linalg.eigvals(systems), dtype=np.complex128)


def pencils(rotor: Rotor, bearings: Sequence[Bearing], basis: PlanarBasis) -> list[Pencil]:
    """First-order systems of all sets of motions that bearings of constant coefficients couple."""
    sets = coupled_motions(bearings)
    return [ModalProjection.of(rotor, bearings, blocks, basis).pencil(bearings) for blocks in sets]


def _times(matrices: NumberArray, motions: FloatArray) -> NumberArray:
    """Return the forces of all bearings under the motions of every coordinate, (bearings n, N)."""
    return np.asarray((matrices @ motions).reshape(-1, motions.shape[-1]))


def _axial_modes(rotor: Rotor, bearings: Sequence[Bearing]) -> tuple[FloatArray, FloatArray]:
    """Frequencies (a,) and shapes at the bearings (a, bearings) of the shaft free along its axis."""
    available = rod_shaft(rotor, (), "axial").available_modes
    modes = solve_axial_modes(rotor, count=int(min(AXIAL_MODES, available)))
    return modes.frequencies, modes.evaluate([bearing.at for bearing in bearings])
