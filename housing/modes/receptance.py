"""Receptance between ports: residues, frequency response, selection of modes that carry it, operating deflection shape.

With mass-normalised shapes and damping ratios ζ the motion of port b by a unit load on port a at the circular
frequency w is (Ewins, *Modal Testing*, 2000, chapter 2)

    H_ba(w) = Σ_r φ_r(b) φ_r(a) / (ω_r² - w² + 2 i ζ_r ω_r w),

the sum running over the kept modes and, where the mode set has them, its residual modes: these supply the response of
the modes above the limit, which is nearly static below it. Each term is symmetric in a and b, so that H is reciprocal.
The modes to keep are selected by their part of H in a band.

An operating deflection shape is the motion of the housing at one line of its spectrum, as a sum of its modes.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from gearwhine.housing.errors import HousingError
from gearwhine.housing.modes.natural_modes import ModeSet
from gearwhine.numerics.arrays import ComplexArray, FloatArray, IntArray

_EVEN_POINTS = 400  # frequencies across a band, beside those around each resonance
_CHUNK = 1024  # frequencies at a time: bounds the working memory
_AROUND = np.array([-6.0, -3.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 3.0, 6.0])  # half-power half-widths


@dataclass(frozen=True)
class Selection:
    """Modes ranked by their contribution to the receptance between two ports in a band.

    Attributes
    ----------
    band : tuple of float
        Band [rad/s].
    ranking : ndarray of int, shape (n_modes,)
        Indices of the modes, the strongest first.
    strength : ndarray, shape (n_modes,)
        The largest gain of each mode's term in the band, in the order of the ranking [m/N].
    error_left : ndarray, shape (n_modes + 1,)
        Error with only the first 0, 1, 2, ... of the ranking (and the residual modes): the largest norm of the error in
        the band, as a part of the largest norm of the whole receptance in it.
    tolerance : float
    """

    band: tuple[float, float]
    ranking: IntArray
    strength: FloatArray
    error_left: FloatArray
    tolerance: float

    @property
    def count(self) -> int:
        """Number of modes of the ranking to keep: from here on no error exceeds the tolerance."""
        too_large = np.flatnonzero(self.error_left > self.tolerance)
        return int(too_large[-1]) + 1 if too_large.size else 0

    @property
    def kept(self) -> IntArray:
        """Indices of the modes to keep, ascending."""
        return np.sort(self.ranking[: self.count])


def residues(modes: ModeSet, port_a: sparse.csr_array, port_b: sparse.csr_array) -> FloatArray:
    """φ_r(b) φ_r(a) of every kept mode [1/kg], shape (n_modes, motions of b, motions of a)."""
    return np.asarray(np.einsum("rb,ra->rba", modes.project(port_b), modes.project(port_a)))


def receptance(
    modes: ModeSet,
    damping_ratios: FloatArray,
    port_a: sparse.csr_array,
    port_b: sparse.csr_array,
    frequencies: FloatArray,
) -> ComplexArray:
    """Motion of port b by unit loads on port a, modes and residual modes together.

    Parameters
    ----------
    modes : ModeSet
        n modes.
    damping_ratios : ndarray, shape (n,)
        ζ, parts of critical. Residual modes take the highest of them, as in the coupled system.
    port_a, port_b : scipy.sparse.csr_array, shapes (a, 3 n_nodes) and (b, 3 n_nodes)
    frequencies : ndarray, shape (f,)
        w [rad/s].

    Returns
    -------
    ndarray of complex, shape (f, b, a)
        [m/N] between translations.

    Raises
    ------
    HousingError
        Where the damping does not fit the modes, or the receptance is infinite: of a free body at rest, of an
        undamped mode at its own frequency.
    """
    gains = _gains(modes, damping_ratios, frequencies)
    pairs = residues(modes, port_a, port_b)
    total = np.tensordot(gains, pairs, axes=1)
    return np.asarray(total + _attached(modes, damping_ratios, port_a, port_b, frequencies))


def select_modes(
    modes: ModeSet,
    damping_ratios: FloatArray,
    port_a: sparse.csr_array,
    port_b: sparse.csr_array,
    band: tuple[float, float],
    tolerance: float,
) -> Selection:
    """Rank the modes by their contribution between two ports, and count those that a tolerance needs.

    A mode's strength is the largest value in the band of |φ(b)| |φ(a)| / |ω² - w² + 2 i ζ ω w|, the modal dominance
    index: for a light mode in the band |φ(b)| |φ(a)| / (2 ζ ω²), twice the Hankel singular value that balanced
    truncation would rank it by (Gregory 1984), and for one outside its static or inertial share. The error is not
    estimated but computed from the receptance itself, on frequencies that resolve every resonance of the band.

    Parameters
    ----------
    modes, damping_ratios, port_a, port_b
        As for :func:`receptance`; the motions of each port should be alike, such as translations.
    band : tuple of float
        Band [rad/s], from above zero for a free body.
    tolerance : float
        Bound of the error left, as a part of the largest receptance in the band.

    Raises
    ------
    HousingError
        Where the band is empty, the tolerance not positive, or a mode in the band has no damping.
    """
    if not 0.0 <= band[0] < band[1]:
        raise HousingError(f"a band from {band[0]:g} to {band[1]:g} rad/s; expected 0 <= from < to")
    if not tolerance > 0.0:
        raise HousingError(f"a tolerance of {tolerance:g}; expected it above 0")
    grid = _band_grid(modes.frequencies, damping_ratios, band)
    pairs = residues(modes, port_a, port_b)
    parts = np.array_split(grid, -(-len(grid) // _CHUNK))
    gains = [np.abs(_gains(modes, damping_ratios, part)).max(axis=0) for part in parts]
    strength = np.max(gains, axis=0) * np.linalg.norm(pairs, axis=(1, 2))
    ranking = np.argsort(-strength, kind="stable")
    largest, left = 0.0, np.zeros(len(ranking) + 1)
    for part in parts:
        gain = _gains(modes, damping_ratios, part)
        missing = np.tensordot(gain, pairs, axes=1)
        whole = missing + _attached(modes, damping_ratios, port_a, port_b, part)
        largest = max(largest, _largest(whole))
        left[0] = max(left[0], _largest(missing))
        for place, mode in enumerate(ranking[:-1], start=1):
            missing -= gain[:, mode, None, None] * pairs[mode]
            left[place] = max(left[place], _largest(missing))
    error_left = left / (largest if largest > 0.0 else 1.0)
    return Selection(band, ranking, strength[ranking], error_left, tolerance)


def _largest(values: ComplexArray) -> float:
    """Return the largest norm over both ports' motions."""
    return float(np.linalg.norm(values, axis=(1, 2)).max())


def _gains(modes: ModeSet, damping_ratios: FloatArray, frequencies: FloatArray) -> ComplexArray:
    """1 / (ω² - w² + 2 i ζ ω w), shape (f, n_modes)."""
    omega = modes.frequencies
    if damping_ratios.shape != omega.shape:
        raise HousingError(f"{len(damping_ratios)} damping ratios for {len(omega)} modes; expected as many")
    return _gain(omega, damping_ratios, frequencies)


def _gain(omega: FloatArray, ratios: FloatArray | float, frequencies: FloatArray) -> ComplexArray:
    w = np.asarray(frequencies, dtype=np.float64)[:, None]
    stiffness = omega**2 - w**2 + 2j * ratios * omega * w
    infinite = np.argwhere(stiffness == 0.0)
    if infinite.size:
        place = float(w[infinite[0, 0], 0])
        raise HousingError(
            f"the receptance is infinite at {place:g} rad/s: a free body has none at rest, and a mode without damping "
            "none at its own frequency; leave that frequency out"
        )
    return np.asarray(1.0 / stiffness)


def _attached(
    modes: ModeSet,
    damping_ratios: FloatArray,
    port_a: sparse.csr_array,
    port_b: sparse.csr_array,
    frequencies: FloatArray,
) -> ComplexArray:
    attached = modes.residual_modes
    if attached is None:
        return np.zeros((len(frequencies), port_b.shape[0], port_a.shape[0]), dtype=np.complex128)
    gains = _gain(attached.frequencies, float(damping_ratios.max(initial=0.0)), frequencies)
    return np.asarray(np.einsum("fr,rb,ra->fba", gains, attached.project(port_b), attached.project(port_a)))


def _band_grid(omega: FloatArray, ratios: FloatArray, band: tuple[float, float]) -> FloatArray:
    near = (omega[:, None] * (1.0 + ratios[:, None] * _AROUND)).ravel()
    even = np.linspace(*band, _EVEN_POINTS)
    grid = np.unique(np.concatenate([even, near]))
    return np.asarray(grid[(grid >= band[0]) & (grid <= band[1])])


@dataclass(frozen=True)
class OperatingShape:
    """The motion of a housing at one frequency.

    Attributes
    ----------
    frequency : float
        ω [rad/s].
    modal : ndarray of complex, shape (n_modes,)
        Complex amplitudes of the modes' accelerations [m √kg / s²]: each mode's is Re q̈ e^{iωt}.

    Raises
    ------
    HousingError
        Where the frequency is not positive, or nothing moves.
    """

    frequency: float
    modal: ComplexArray

    def __post_init__(self) -> None:
        """Check the frequency and the modal amplitudes."""
        if not self.frequency > 0.0:
            raise HousingError(f"an operating shape at {self.frequency} rad/s; expected a frequency above zero")
        if not np.all(np.isfinite(self.modal)) or not np.any(self.modal):
            raise HousingError("no mode of the housing moves at this line, or its amplitude is no number")

    @property
    def kinetic_shares(self) -> FloatArray:
        """Share of each mode in the mean kinetic energy ¼ Σ |q̇|², unit modal masses, shape (n_modes,)."""
        energy = np.abs(self.modal) ** 2
        return np.asarray(energy / energy.sum())

    def displacement(self, modes: ModeSet, nodes: IntArray) -> ComplexArray:
        """Complex amplitudes of the displacement of nodes, −φ q̈ / ω² summed over the modes [m], shape (n_nodes, 3)."""
        if len(self.modal) != len(modes.shapes):
            raise HousingError(f"{len(self.modal)} modal amplitudes for {len(modes.shapes)} modes")
        weights = -self.modal / self.frequency**2
        # By real products: of complex numbers they would first make the shapes twice as large.
        real, imaginary = np.stack([weights.real, weights.imag]) @ modes.shapes[:, nodes].reshape(len(weights), -1)
        return np.asarray(real + 1j * imaginary).reshape(-1, 3)
