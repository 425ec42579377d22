"""Surrogate of a housing's modes about a design: modes of neighbouring designs in a millisecond.

Fixed modes fail where two of them cross or exchange their dominance. The surrogate lets all modes at hand mix: with
Λ = diag(λ) of the design's mass-normalised modes Φ and d the step in the parameters, the modes of the neighbour are
those of the symmetric matrix

    A(d) = Λ + Σ_j d_j [Φᵀ dK_j Φ - ½ (Λ Φᵀ dM_j Φ + Φᵀ dM_j Φ Λ)] + O(d²),

with eigenvalues λ and with eigenvectors C that make its shapes Φ (I - ½ Σ_j d_j Φᵀ dM_j Φ) C. The surrogate expands
the logarithm of A,

    H(d) = diag(ln λ) + Σ_j d_j [Φᵀ dK_j Φ - ½ (Λ Φᵀ dM_j Φ + Φᵀ dM_j Φ Λ)]_ab / L(λ_a, λ_b),

which has the same eigenvectors and the eigenvalues ln λ. L is the logarithmic mean (λ_a - λ_b) / (ln λ_a - ln λ_b), the
inverse of the divided difference of ln, by which a function of a symmetric matrix is differentiated (theorem of
Daleckii and Krein: Higham 2008, Functions of Matrices, section 3.2). So H is exact to first order in frequencies and
shapes (shapes except for contributions of modes above those at hand), and in logarithms: a frequency that is a power of
a parameter is reproduced exactly where that parameter's coordinate is its logarithm.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearwhine.housing.errors import HousingError
from gearwhine.housing.modes.dominance import Dominance, dominance
from gearwhine.housing.updating.sensitivities import ModalSensitivities
from gearwhine.numerics.arrays import FloatArray, IntArray

_TOGETHER = 1e-9  # difference of ln λ below which two modes are one
_SMALLEST_MOTION = 1e-300  # motion of seats and skin at rest


@dataclass(frozen=True)
class ModalState:
    """A design's elastic modes in the quantities that a fit compares, ascending in frequency.

    Rigid modes, which no parameter moves and no survey measures, are left out. A fit numbers modes by their place here,
    from 0; :meth:`number` is a mode's number in the housing.

    Attributes
    ----------
    frequencies : ndarray, shape (n_modes,)
        Circular frequencies, positive [rad/s].
    seats : ndarray, shape (n_modes, n_seats, 2)
        x and y translation of each bearing seat in the mass-normalised shapes [1/√kg].
    skin : ndarray, shape (n_modes, n_points)
        Outward normal motion at the survey's points [1/√kg].
    measured : ndarray, shape (n_modes, n_dofs), or None
        Motion at the degrees of freedom where shapes were measured [1/√kg].
    n_rigid : int
        Number of the housing's rigid modes, below all of these.

    Raises
    ------
    HousingError
        Where a frequency is not positive.
    """

    frequencies: FloatArray
    seats: FloatArray
    skin: FloatArray
    measured: FloatArray | None = None
    n_rigid: int = 0

    def __post_init__(self) -> None:
        """Check that no mode is rigid: its ln ω is infinite, and its place would shift those of the others."""
        if not (self.frequencies > 0.0).all():
            raise HousingError(f"frequencies {self.frequencies} rad/s: expected positive ones, of elastic modes")

    def number(self, mode: int) -> int:
        """Return the number of a mode in the housing, from 1, the rigid ones counted."""
        return self.n_rigid + mode + 1

    def n_below(self, limit: float) -> int:
        """Count the housing's modes below a circular frequency [rad/s], the rigid ones among them."""
        return self.n_rigid + int(np.count_nonzero(self.frequencies < limit))

    @property
    def dominance(self) -> Dominance:
        """Each mode's strength between seats and skin."""
        return dominance(self.frequencies, self.seats, self.skin)


@dataclass(frozen=True)
class Neighbour:
    """The surrogate's modes at some coordinates.

    Attributes
    ----------
    state : ModalState
    surrogate : Surrogate
        The surrogate that it belongs to.
    step : ndarray, shape (n_parameters,)
        Step from the surrogate's centre.
    mixture : ndarray, shape (n_modes, n_modes)
        C, the eigenvectors of H.
    """

    state: ModalState
    surrogate: "Surrogate"
    step: FloatArray
    mixture: FloatArray

    @cached_property
    def slopes(self) -> FloatArray:
        """Slopes d ln ω of each mode by each coordinate, shape (n_parameters, n_modes)."""
        return np.asarray(0.5 * np.einsum("am,pam->pm", self.mixture, self.surrogate.rates @ self.mixture))

    def measured_slopes(self, modes: IntArray) -> FloatArray:
        """Rates of some modes' motions where shapes were measured, shape (n_parameters, n_modes, n_dofs) [1/√kg]."""
        assert self.surrogate.state.measured is not None
        return np.asarray(self._turning(modes) @ self.surrogate.state.measured)

    def strength_slopes(self, modes: IntArray) -> FloatArray:
        """Return d ln strength of modes by acceleration, velocity and absolute, shape (3, n_parameters, n_modes)."""
        state, base, turning = self.state, self.surrogate.state, self._turning(modes)
        seats, skin = state.seats[modes], state.skin[modes]
        seats_rate = (turning @ base.seats.reshape(len(base.seats), -1)).reshape(len(turning), *seats.shape)
        skin_rate = turning @ base.skin
        along = (seats * seats_rate).sum(axis=3)  # radial motion times its rate, (n_parameters, n_modes, n_seats)
        radial = np.maximum(np.linalg.norm(seats, axis=2), _SMALLEST_MOTION)
        squares = along.sum(axis=2) / (radial**2).sum(axis=1)
        squares += (skin * skin_rate).sum(axis=2) / np.maximum((skin**2).sum(axis=1), _SMALLEST_MOTION)
        means = (along / radial).sum(axis=2) / radial.sum(axis=1)
        means += (np.sign(skin) * skin_rate).sum(axis=2) / np.maximum(np.abs(skin).sum(axis=1), _SMALLEST_MOTION)
        return np.array([squares, squares - self.slopes[:, modes], means])

    def _turning(self, modes: IntArray) -> FloatArray:
        """Rates of some modes as mixtures of the design's own, shape (n_parameters, n_modes, n_own).

        The eigenvectors of H turn by dC = C R, R_ab = (Cᵀ H_j C)_ab / (μ_b - μ_a) for the coordinate j, with
        μ = ln λ, and the mass adds -½ Φᵀ dM_j Φ C.
        """
        surrogate, mixture = self.surrogate, self.mixture
        logarithms = 2.0 * np.log(self.state.frequencies)
        apart = logarithms[modes] - logarithms[:, None]
        # Modes of one frequency have no distinct shapes, and do not turn into each other; nor does a mode into itself.
        inverse = np.divide(1.0, apart, out=np.zeros_like(apart), where=np.abs(apart) > _TOGETHER)
        turned = mixture @ ((mixture.T @ (surrogate.rates @ mixture[:, modes])) * inverse)
        whole = turned - 0.5 * _weighted(self.step, surrogate.mass) @ turned
        whole -= 0.5 * surrogate.mass @ mixture[:, modes]
        return np.asarray(whole.transpose(0, 2, 1))


@dataclass(frozen=True)
class Surrogate:
    """The modes of a design and their derivatives by each coordinate.

    Attributes
    ----------
    center : ndarray, shape (n_parameters,)
        The design's coordinates.
    state : ModalState
        State at the design.
    rates : ndarray, shape (n_parameters, n_modes, n_modes)
        Derivatives of H by each coordinate.
    mass : ndarray, shape (n_parameters, n_modes, n_modes)
        Φᵀ dM Φ of each coordinate.
    """

    center: FloatArray
    state: ModalState
    rates: FloatArray
    mass: FloatArray

    @classmethod
    def about(cls, center: FloatArray, state: ModalState, rates: ModalSensitivities) -> "Surrogate":
        """Build the surrogate about a design, from its modes and the derivatives by the same modes."""
        eigenvalues, mass = state.frequencies**2, rates.mass
        change = rates.stiffness - 0.5 * (eigenvalues[:, None] * mass + mass * eigenvalues)
        return cls(center, state, change / _logarithmic_means(eigenvalues), mass)

    def at(self, coordinates: FloatArray) -> Neighbour:
        """Modes at other coordinates."""
        step = coordinates - self.center
        whole = _weighted(step, self.rates)
        diagonal = np.arange(len(whole))
        whole[diagonal, diagonal] += 2.0 * np.log(self.state.frequencies)
        values, mixture = np.linalg.eigh(whole)
        carried = mixture - 0.5 * _weighted(step, self.mass) @ mixture
        state = self.state
        n = len(carried)
        moved = replace(
            state,
            frequencies=np.exp(0.5 * values),
            seats=(carried.T @ state.seats.reshape(n, -1)).reshape(state.seats.shape),
            skin=carried.T @ state.skin,
            measured=None if state.measured is None else carried.T @ state.measured,
        )
        return Neighbour(moved, self, step, mixture)


def _logarithmic_means(values: FloatArray) -> FloatArray:
    """Logarithmic mean of each two of some positive values, shape (n, n): (a - b) / ln(a / b), and a where a = b.

    With x = ½ ln(a / b) it is √(a b) sinh(x) / x, which stays accurate where both are nearly the same.
    """
    logarithms = np.log(values)
    half = 0.5 * (logarithms[:, None] - logarithms)
    ratio = np.divide(np.sinh(half), half, out=np.ones_like(half), where=half != 0.0)
    return np.asarray(np.sqrt(values[:, None] * values) * ratio)


def _weighted(weights: FloatArray, matrices: FloatArray) -> FloatArray:
    """Weighted sum of matrices (n, m, m), shape (m, m); `tensordot` takes several times as long for small ones."""
    return np.asarray((weights @ matrices.reshape(len(weights), -1)).reshape(matrices.shape[1:]))
