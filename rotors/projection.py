"""Whirl on a basis of planar modes: starting values for the exact roots.

Both planes share the modes at averaged bearing stiffness, X = Φᵀ q_x and Y = Φᵀ q_y. With Λ = diag(ω²),
G the polar inertia matrix and Φ_b the modes' displacements at bearing b,

    q̈_x + Ω G q̇_y + Σ_b Φ_b Φ_bᵀ (c_xx q̇_x + c_xy q̇_y) + Λ q_x + Σ_b Φ_b Φ_bᵀ [(k_xx − k̄) q_x + k_xy q_y] = 0
    q̈_y − Ω G q̇_x + Σ_b Φ_b Φ_bᵀ (c_yx q̇_x + c_yy q̇_y) + Λ q_y + Σ_b Φ_b Φ_bᵀ [k_yx q_x + (k_yy − k̄) q_y] = 0

(TM-104434 Eqs. 11–15 with constant speed and grounded bearings). The sums over bearings are its compensation
matrices. Here the same is written in the circular coordinates of `rotors.spatial_ties`, with slopes, axial modes
and pedestals where bearings have them, and only for the motions that the bearings tie to each other.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import linalg

from .attachment import attach_loads
from .axial import solve_axial_modes
from .bearing import Bearing, RadialSupport
from .errors import require, require_count, require_finite
from .lateral import LateralModes, solve_lateral_modes
from .rotor_lines import bending_line, rod_line
from .shaft import Rotor
from .spatial_ties import make_tie

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

DEFAULT_COUNT = 12
LEAST_MODES = 8
SPARE_MODES = 4
AXIAL_MODES = 8
# The basis reaches this many times beyond the highest whirl frequency asked for: it gives starting values only.
BASIS_REACH = 1.5
# A massless pedestal weighs this part of the rotor in the basis, where every coordinate has a mass.
PEDESTAL_MASS = 1e-6


def whirl_basis(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
) -> LateralModes:
    """Planar basis for whirl: modes at averaged stiffness, well beyond the need, and attachment vectors.

    It holds every mode below ``frequency_limit`` and half as far again, or four more than half of ``count``, and at
    least eight; behind them the static responses to a force at each bearing and to a moment at each disc, where
    the compensation and gyroscopic terms act. Build it once to sweep the speed. Of tables over speed it holds
    the stiffness at the middle of the table.

    Parameters
    ----------
    rotor, bearings
        The rotor and what holds it.
    frequency_limit
        Highest whirl frequency of interest, rad/s.
    count
        How many whirl modes are of interest, instead.

    Raises
    ------
    RotorError, IncompleteModesError
        As `rotors.solve_lateral_modes`.
    """
    both = (frequency_limit, count)
    require(frequency_limit is None or count is None, "frequency_limit and count", both, "one of the two")
    supports = mean_supports(bearings)
    available = bending_line(rotor, supports).available_modes
    if frequency_limit is None:
        wanted = (count or DEFAULT_COUNT) // 2 + SPARE_MODES
        modes = solve_lateral_modes(rotor, supports, count=int(min(max(wanted, LEAST_MODES), available)))
    else:
        require_finite("frequency_limit", frequency_limit, positive=True)
        modes = solve_lateral_modes(rotor, supports, frequency_limit=BASIS_REACH * frequency_limit)
        if modes.count < min(LEAST_MODES, available):
            modes = solve_lateral_modes(rotor, supports, count=int(min(LEAST_MODES, available)))
    forces = [bearing.at for bearing in bearings]
    moments = [disc.at for disc in rotor.discs if disc.polar_inertia > 0.0]
    moments += [bearing.at for bearing in bearings if bearing.stiffness.shape[-1] == 5]
    return attach_loads(modes, forces_at=forces, moments_at=moments)


def basis_for(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    frequency_limit: float | None,
    count: int | None,
    basis: LateralModes | None,
) -> LateralModes:
    """The given basis if it fits the bearings, or a new one; checks the limit and the count."""
    for bearing in bearings:
        rotor.require_on_shaft(f"bearing {bearing.name!r}", bearing.at)
    require_count("count of modes", count)
    if basis is None:
        return whirl_basis(rotor, bearings, frequency_limit=frequency_limit, count=count)
    expected = mean_supports(bearings)
    require(basis.supports == expected, "supports of the basis", basis.supports, f"{expected}, the bearings'")
    return basis


def mean_supports(bearings: Sequence[Bearing]) -> tuple[RadialSupport, ...]:
    """The planar springs that a basis holds, of tables those at the middle of their speeds."""
    return tuple(
        bearing.at_speed(float(bearing.speeds[bearing.speeds.size // 2])).mean_support
        if bearing.speeds is not None
        else bearing.mean_support
        for bearing in bearings
    )


def slowest(bearing: Bearing) -> float:
    """The lowest speed of a bearing's tables, or zero, rad/s."""
    return 0.0 if bearing.speeds is None else float(bearing.speeds[0])


@dataclass(frozen=True)
class Projection:
    """One set of tied motions of a rotor on its modal basis.

    Attributes
    ----------
    basis
        Planar modes and attachment vectors.
    blocks
        As of `rotors.spatial_chain.SpatialChain`.
    axial_frequencies, axial_shapes
        (a,) in rad/s and (a, bearings): free axial modes at the bearings; empty where no bearing needs them.
    total_mass
        Of the rotor, kg.
    """

    basis: LateralModes
    blocks: tuple[int, ...]
    axial_frequencies: FloatArray
    axial_shapes: FloatArray
    total_mass: float

    @classmethod
    def of(
        cls, rotor: Rotor, bearings: Sequence[Bearing], blocks: tuple[int, ...], basis: LateralModes
    ) -> "Projection":
        """The projection for some tied motions of a rotor."""
        frequencies, shapes = np.zeros(0), np.zeros((0, len(bearings)))
        if 0 in blocks:
            frequencies, shapes = _axial_modes(rotor, bearings)
        return cls(basis, blocks, frequencies, shapes, rotor.mass)

    @cached_property
    def floor(self) -> float:
        """The lowest frequency of the basis that is not a rigid motion's zero, rad/s."""
        moving = self.basis.frequencies[self.basis.frequencies > 0.0]
        return float(moving.min()) if moving.size else 1.0

    def matrices(self, bearings: Sequence[Bearing]) -> tuple[FloatArray, ComplexArray, ComplexArray, ComplexArray]:
        """Diagonal mass (N,), stiffness, damping and gyroscopic matrix per rad/s, (N, N) each."""
        b, units = self.basis.count, self._units
        ties = [make_tie(bearing, node, self.blocks, units) for node, bearing in enumerate(bearings)]
        sizes = [b if block else self.axial_frequencies.size for block in self.blocks]
        order = sum(sizes) + sum(len(tie.foot) for tie in ties)
        mass = np.ones(order)
        stiffness, damping, gyroscopic = (np.zeros((order, order), dtype=np.complex128) for _ in range(3))
        first, supported = 0, self.basis.support_matrix
        for block, size in zip(self.blocks, sizes, strict=True):
            own = slice(first, first + size)
            squared = (self.basis.frequencies if block else self.axial_frequencies) ** 2
            stiffness[own, own] = np.diag(squared)
            if block:
                stiffness[own, own] -= supported
                gyroscopic[own, own] = -1j * block * self.basis.polar_inertia_matrix
            first += size
        for tie, bearing, moved in zip(ties, bearings, self._displacements(bearings, order), strict=True):
            foot = list(tie.foot)
            rows = first + np.arange(len(foot))
            first += len(foot)
            # The bearing feels the shaft less its pedestal.
            relative = tie.frame @ moved
            relative[foot, rows] -= 1.0
            stiffness += relative.conj().T @ tie.stiffness @ relative
            damping += relative.conj().T @ tie.damping @ relative
            if foot:
                stiffness[np.ix_(rows, rows)] += tie.foot_stiffness
                damping[np.ix_(rows, rows)] += tie.foot_damping
                own_mass = bearing.pedestal.mass if bearing.pedestal is not None else 0.0
                mass[rows] = max(own_mass, PEDESTAL_MASS * self.total_mass)
        return mass, stiffness, damping, gyroscopic

    def eigenvalues(self, bearings: Sequence[Bearing], speeds: FloatArray) -> ComplexArray:
        """All eigenvalues of the projected motion at every speed, (speeds, 2N); bearings have constant coefficients."""
        mass, stiffness, damping, gyroscopic = self.matrices(bearings)
        order = mass.size
        # States W q and q̇ make the undamped system matrix nearly skew, so that high members of the basis
        # do not cost the low eigenvalues their digits.
        weight = np.sqrt(np.maximum(np.abs(np.diag(stiffness)) / mass, self.floor**2))
        turn = self._real_turn(order)
        system = np.zeros((speeds.size, 2 * order, 2 * order), dtype=np.complex128)
        system[:, :order, order:] = np.diag(weight)
        system[:, order:, :order] = -turn.conj().T @ (stiffness / mass[:, None]) @ turn / weight
        damped = turn.conj().T @ (damping / mass[:, None]) @ turn
        turning = turn.conj().T @ (gyroscopic / mass[:, None]) @ turn
        system[:, order:, order:] = -damped - speeds[:, None, None] * turning
        return np.asarray(np.linalg.eigvals(system.real if len(self.blocks) > 1 else system))

    def critical(self, bearings: Sequence[Bearing]) -> ComplexArray:
        """λ at which λ = iΩ, from K q = ω² (M − iG) q with the gyroscopic term beside the mass, (N,)."""
        mass, stiffness, _, gyroscopic = self.matrices(bearings)
        weight = np.sqrt(np.maximum(np.abs(np.diag(stiffness)) / mass, self.floor**2))
        inertia = (np.diag(mass) - 1j * gyroscopic) / np.outer(weight, weight)
        squared = linalg.eigvals(stiffness / np.outer(weight, weight), inertia)
        return np.asarray(1j * np.sqrt(squared[np.isfinite(squared)]))

    @property
    def _units(self) -> FloatArray:
        return np.concatenate([np.ones(2) if block else np.ones(1) for block in self.blocks])

    def _displacements(self, bearings: Sequence[Bearing], order: int) -> FloatArray:
        """Rows that turn coordinates into the node displacements at every bearing, (bearings, n, order)."""
        rows = np.zeros((len(bearings), self._units.size, order))
        if not bearings:
            return rows
        displacement, slope = self.basis.evaluate([bearing.at for bearing in bearings])
        row = column = 0
        for block in self.blocks:
            if block:
                rows[:, row, column : column + self.basis.count] = displacement.T
                rows[:, row + 1, column : column + self.basis.count] = slope.T
                row, column = row + 2, column + self.basis.count
            else:
                rows[:, row, column : column + self.axial_frequencies.size] = self.axial_shapes.T
                row, column = row + 1, column + self.axial_frequencies.size
        return rows

    def _real_turn(self, order: int) -> ComplexArray:
        """From real coordinates over x and y to circular ones, unitary: a real eigenproblem costs a third."""
        turn = np.eye(order, dtype=np.complex128)
        if len(self.blocks) == 1:
            return turn
        # Pedestals and axial motion are real as they are.
        b, root = self.basis.count, np.sqrt(0.5)
        plus, minus = np.arange(b), b + np.arange(b)
        turn[plus, plus], turn[plus, minus] = root, 1j * root
        turn[minus, plus], turn[minus, minus] = root, -1j * root
        return turn


def _axial_modes(rotor: Rotor, bearings: Sequence[Bearing]) -> tuple[FloatArray, FloatArray]:
    """Frequencies (a,) and shapes at the bearings (a, bearings) of the shaft free along its axis."""

    available = rod_line(rotor, (), "axial").available_modes
    modes = solve_axial_modes(rotor, count=int(min(AXIAL_MODES, available)))
    return modes.frequencies, modes.evaluate([bearing.at for bearing in bearings])
