"""Damped, gyroscopic whirl of a rotor on grounded bearings, on the planar modal basis.

Both planes share the modes at averaged bearing stiffness, X = Φᵀ q_x and Y = Φᵀ q_y. With Λ = diag(ω²),
G the polar inertia matrix and Φ_b the modes' displacements at bearing b,

    q̈_x + Ω G q̇_y + Σ_b Φ_b Φ_bᵀ (c_xx q̇_x + c_xy q̇_y) + Λ q_x + Σ_b Φ_b Φ_bᵀ [(k_xx − k̄) q_x + k_xy q_y] = 0
    q̈_y − Ω G q̇_x + Σ_b Φ_b Φ_bᵀ (c_yx q̇_x + c_yy q̇_y) + Λ q_y + Σ_b Φ_b Φ_bᵀ [k_yx q_x + (k_yy − k̄) q_y] = 0

(TM-104434 Eqs. 11–15 with constant speed and grounded bearings). The sums over bearings are its
compensation matrices. Speed Ω is positive counter-clockwise from +z; motion e^{λt} whirls forward, with
the rotation for Ω > 0, when y lags x by a quarter turn.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from scipy import linalg

from .attachment import attach_loads
from .bearing import Bearing
from .chain import bending_chain
from .errors import require, require_count, require_finite
from .lateral import LateralModes, solve_lateral_modes
from .shaft import Rotor

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

DEFAULT_COUNT = 12
LEAST_MODES = 12
# The basis reaches this many times beyond the highest whirl frequency asked for.
BASIS_REACH = 4.0
# Parts of the lowest elastic frequency below which an imaginary part is rounding, not oscillation.
NO_OSCILLATION = 1e-6


@dataclass(frozen=True)
class WhirlModes:
    """Complex modes at one speed of rotation, ascending in frequency; overdamped motions are left out.

    Attributes
    ----------
    speed
        Ω, rad/s.
    eigenvalues
        (w,) complex, rad/s, with positive imaginary part.
    frequencies
        (w,): natural frequency |λ|, rad/s.
    damping_ratios
        (w,): −Re λ / |λ|; negative is unstable.
    direction
        (w,): between −1 and 1, the mass-weighted mean of how circular the whirl is; 1 is circular and
        counter-clockwise (forward for positive speed), −1 circular and clockwise, 0 planar.
    coordinates
        (w, 2 b) complex: modal coordinates, those of x before those of y, of norm one.
    basis
        The planar modes and attachment vectors, b of them.
    """

    speed: float
    eigenvalues: ComplexArray
    frequencies: FloatArray
    damping_ratios: FloatArray
    direction: FloatArray
    coordinates: ComplexArray = field(repr=False)
    basis: LateralModes = field(repr=False)

    @property
    def damped_frequencies(self) -> FloatArray:
        """Im λ, rad/s, (w,)."""
        return np.asarray(self.eigenvalues.imag)

    def evaluate(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Complex x and y of every mode at positions z (m), both (w, len(z))."""
        displacement = self.basis.evaluate(z)[0]
        planes = self.coordinates.reshape(self.eigenvalues.size, 2, self.basis.count)
        return planes[:, 0] @ displacement, planes[:, 1] @ displacement


def whirl_basis(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
) -> LateralModes:
    """Planar basis for whirl: modes at averaged stiffness, well beyond the need, and attachment vectors.

    It holds every mode below four times ``frequency_limit``, or four more than ``count``, and at least
    twelve; behind them the static responses to a force at each bearing and to a moment at each disc, where
    the compensation and gyroscopic terms act. Build it once to sweep the speed.

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
    supports = tuple(bearing.mean_support for bearing in bearings)
    available = bending_chain(rotor, supports, 1.0).available_modes
    if frequency_limit is None:
        wanted = (count or DEFAULT_COUNT) + 4
        modes = solve_lateral_modes(rotor, supports, count=int(min(max(wanted, LEAST_MODES), available)))
    else:
        require_finite("frequency_limit", frequency_limit, positive=True)
        modes = solve_lateral_modes(rotor, supports, frequency_limit=BASIS_REACH * frequency_limit)
        if modes.count < min(LEAST_MODES, available):
            modes = solve_lateral_modes(rotor, supports, count=int(min(LEAST_MODES, available)))
    forces = [bearing.at for bearing in bearings]
    moments = [disc.at for disc in rotor.discs if disc.polar_inertia > 0.0]
    moments += [bearing.at for bearing in bearings if bearing.spatial_stiffness[3:].any()]
    return attach_loads(modes, forces_at=forces, moments_at=moments)


def solve_whirl(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    speed: float,
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
    basis: LateralModes | None = None,
) -> WhirlModes:
    """Complex modes of the turning rotor on grounded bearings.

    Parameters
    ----------
    rotor, bearings
        The rotor and what holds it.
    speed
        Ω, rad/s; negative is clockwise.
    frequency_limit
        rad/s: modes whose natural frequency is below it. The default basis reaches four times as far.
    count
        How many modes, instead of a limit; with neither, 12.
    basis
        From `whirl_basis`, of the same rotor and bearings, to spare building it at every speed.

    Raises
    ------
    RotorError
        Wrong arguments, or a basis with other supports.
    IncompleteModesError
        The basis fails its own proof.
    """
    require_finite("speed", speed)
    chosen = basis_for(rotor, bearings, frequency_limit, count, basis)
    stiffness, damping = plane_matrices(chosen, bearings)
    b = chosen.count
    gyroscopic = damping.copy()
    gyroscopic[:b, b:] += speed * chosen.polar_inertia_matrix
    gyroscopic[b:, :b] -= speed * chosen.polar_inertia_matrix
    # States W q and q̇ make the undamped system matrix nearly skew, so that high members of the basis
    # do not cost the low eigenvalues their digits.
    weight = frequency_weight(chosen)
    system = np.block([[np.zeros((2 * b, 2 * b)), np.diag(weight)], [-stiffness / weight, -gyroscopic]])
    values, vectors = linalg.eig(system)
    keep = np.flatnonzero(values.imag > NO_OSCILLATION * weight.min())
    keep = keep[np.lexsort((values[keep].imag, np.abs(values[keep])))]
    if frequency_limit is not None:
        keep = keep[np.abs(values[keep]) < frequency_limit]
    else:
        keep = keep[: count or DEFAULT_COUNT]
    values, coordinates = values[keep], (vectors[: 2 * b, keep] / weight[:, None]).T
    coordinates = coordinates / np.linalg.norm(coordinates, axis=1, keepdims=True)
    return WhirlModes(
        speed=speed,
        eigenvalues=values,
        frequencies=np.abs(values),
        damping_ratios=-values.real / np.abs(values),
        direction=whirl_direction(coordinates),
        coordinates=coordinates,
        basis=chosen,
    )


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
    expected = tuple(bearing.mean_support for bearing in bearings)
    require(basis.supports == expected, "supports of the basis", basis.supports, f"{expected}, the bearings'")
    return basis


def plane_matrices(basis: LateralModes, bearings: Sequence[Bearing]) -> tuple[FloatArray, FloatArray]:
    """Stiffness and damping over both planes' coordinates, each (2 b, 2 b), x before y."""
    stiffness: FloatArray = np.kron(np.eye(2), np.diag(basis.frequencies**2)).astype(np.float64)
    damping: FloatArray = np.zeros_like(stiffness)
    kept = np.ix_([0, 1, 3, 4], [0, 1, 3, 4])
    for bearing in bearings:
        shape, slope = (part[:, 0] for part in basis.evaluate([bearing.at]))
        # The section's x, y and rotations about x and y, the first of which is minus the slope in y.
        zero = np.zeros(basis.count)
        motion = np.array([[*shape, *zero], [*zero, *shape], [*zero, *-slope], [*slope, *zero]])
        # Compensation: the basis already holds the averaged stiffness.
        mean = np.repeat([bearing.mean_stiffness, bearing.mean_tilt_stiffness], 2)
        stiffness += motion.T @ (bearing.spatial_stiffness[kept] - np.diag(mean)) @ motion
        damping += motion.T @ bearing.spatial_damping[kept] @ motion
    return stiffness, damping


def frequency_weight(basis: LateralModes) -> FloatArray:
    """The basis's frequencies for both planes, (2 b,), rigid motions' zeros raised to the lowest other."""
    moving = basis.frequencies[basis.frequencies > 0.0]
    lowest = float(moving.min()) if moving.size else 1.0
    return np.tile(np.maximum(basis.frequencies, lowest), 2)


def whirl_direction(coordinates: ComplexArray) -> FloatArray:
    """2 Im(q_x · conj q_y) / (|q_x|² + |q_y|²) of every row (w, 2 b): 1 counter-clockwise, −1 clockwise."""
    half = coordinates.shape[1] // 2
    x, y = coordinates[:, :half], coordinates[:, half:]
    size = (np.abs(coordinates) ** 2).sum(axis=1)
    return np.asarray(2.0 * (x * y.conj()).sum(axis=1).imag / size)
