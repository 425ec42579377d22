"""How far a design's modes are from those measured, as one number that a search can lessen.

    J = Σ_i (ln ω_i - ln ω_i,measured)² / σ_i² + Σ_i n (1 - MAC_i) / s² + |z|² + penalties,

twice the negative logarithm of the posterior density where frequencies carry independent relative errors σ_i, the n
motions of a measured shape errors of s times their root-mean-square, and the prior of the coordinates z is the unit
normal one (Mottershead and Friswell 1993; Beck and Katafygiotis 1998).
Penalties keep out what a good sum would hide: a choice of dominant modes that is a coin toss, measures that choose
differently, and a number of modes that is not the one known.

Modes are paired as they are when model and measurement are compared: the dominant ones in order of frequency, or where
shapes were measured by the assignment of greatest MAC.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from housing.correlation import mac
from housing.errors import HousingError
from housing.updating.surrogate import ModalState, Neighbour

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

UNPAIRED = -1
"""Stands for the partner of a measured mode that has none."""

GAP_SCALE = 0.02
"""How soft the least gap is: so much below it costs as much as an error of one σ."""

_LEAST_MAC = 0.5  # below it two shapes are no pair
_COUNT_SCALE = 0.01  # how soft the number of modes is: in ln ω of the mode that has to lie beyond the limit or below
_HOPELESS = 1e6  # J of a design with too few modes to pair
_LOOSE = 25.0  # J of each measured mode that finds no partner: as much as an error of five σ


@dataclass(frozen=True)
class ModeCount:
    """A number of modes that is known: from ``least`` to ``most`` below ``limit`` [rad/s]."""

    limit: float
    least: int
    most: int


@dataclass(frozen=True)
class Target:
    """What was measured, and how well.

    Attributes
    ----------
    frequencies : ndarray, shape (n,)
        Circular frequencies, ascending [rad/s].
    noise : ndarray, shape (n,)
        Relative standard deviation of each; infinite for a mode that is held back.
    band : tuple of float
        Where dominant modes are looked for [rad/s].
    shapes : ndarray, shape (n, n_dofs), optional
        Measured shapes, of any scale.
    shape_noise : float
        Standard deviation of each of their motions, as a part of the shape's root-mean-square; infinite where shapes
        are to decide the pairs and nothing else.
    gap : float
        Least gap ln(strength of the last chosen / first left out); not asked for where shapes were measured.
    margin : float
        Least gap of the other two measures between the modes chosen and those left out, below 0 where they choose
        others; not asked for by default.
    count : ModeCount, optional
    bias : ndarray, shape (n,), optional
        ln of (a finer mesh's frequencies / this mesh's), which the fit takes for constant.

    Raises
    ------
    HousingError
        Where the frequencies do not ascend, or arrays do not fit each other.
    """

    frequencies: FloatArray
    noise: FloatArray
    band: tuple[float, float]
    shapes: FloatArray | None = None
    shape_noise: float = np.inf
    gap: float = 0.0
    margin: float = -np.inf
    count: ModeCount | None = None
    bias: FloatArray | None = None

    def __post_init__(self) -> None:
        measured = self.frequencies
        if len(measured) == 0 or measured[0] <= 0.0 or np.any(np.diff(measured) <= 0.0):
            raise HousingError(f"measured frequencies {measured} rad/s must be positive and ascending")
        if self.noise.shape != measured.shape or not (self.noise > 0.0).all():
            raise HousingError(f"noise {self.noise}: expected a positive number for each of {len(measured)} modes")
        if self.shapes is not None and len(self.shapes) != len(measured):
            raise HousingError(f"{len(self.shapes)} measured shapes for {len(measured)} measured frequencies")

    @property
    def logarithms(self) -> FloatArray:
        """ln ω that the model should have on its own mesh, shape (n,)."""
        wanted = np.log(self.frequencies)
        return wanted if self.bias is None else wanted - self.bias


@dataclass(frozen=True)
class Misfit:
    """A design seen from the target.

    Attributes
    ----------
    value : float
        J.
    pairs : ndarray of int, shape (n,)
        The model's mode for each measured one, from 0; :data:`UNPAIRED` where it has none.
    errors : ndarray, shape (n,)
        ln(model / measured) on this mesh, its bias taken into account; NaN where unpaired.
    gap : float
        Infinite where shapes decide.
    margin : float
        The least gap of the other two measures of dominance for the same choice; likewise.
    count : int
        Modes below the limit of :class:`ModeCount`; 0 where none is given.
    mac : ndarray, shape (n,), or None
        Of each pair, where shapes were measured.
    """

    value: float
    pairs: IntArray
    errors: FloatArray
    gap: float
    margin: float
    count: int
    mac: FloatArray | None = None

    @property
    def measures_agree(self) -> bool:
        """Whether all three measures of dominance choose the same modes."""
        return self.margin > 0.0

    def clearance(self, target: Target) -> float:
        """By how much the choice of modes is clearer than asked for; negative where it is not clear enough."""
        return min(self.gap - target.gap, self.margin - target.margin)

    @property
    def rms_percent(self) -> float:
        """Root-mean-square error of the paired modes."""
        return float(100.0 * np.sqrt(np.nanmean(np.expm1(self.errors) ** 2)))

    @property
    def max_percent(self) -> float:
        """Largest error of the paired modes."""
        return float(100.0 * np.nanmax(np.abs(np.expm1(self.errors))))


def measure(target: Target, state: ModalState, coordinates: FloatArray) -> Misfit:
    """Pair the modes of a design with the measured ones and sum up what they miss."""
    n = len(target.frequencies)
    penalty = float(coordinates @ coordinates)
    mac, gap, margin = None, float("inf"), float("inf")
    if target.shapes is None:
        strengths = state.dominance
        pairs = strengths.strongest(n, target.band)
        if len(pairs) < n:
            lacking = _HOPELESS * (n - len(pairs))
            return Misfit(lacking + penalty, np.full(n, UNPAIRED), np.full(n, np.nan), 0.0, 0.0, 0)
        gap, margin = strengths.gap(n, target.band), strengths.margin(n, target.band)
        penalty += (max(target.gap - gap, target.margin - margin, 0.0) / GAP_SCALE) ** 2
    else:
        pairs, mac = pair_by_shape(target, state)
        told = (pairs != UNPAIRED) & np.isfinite(target.noise)
        penalty += _LOOSE * np.count_nonzero(pairs == UNPAIRED)
        penalty += target.shapes.shape[1] / target.shape_noise**2 * float((1.0 - mac[told]).sum())
    count = 0
    if target.count is not None:
        count = int(np.count_nonzero(state.frequencies < target.count.limit))
        _, beyond = strays(target.count, state)
        penalty += float(beyond @ beyond)
    errors = np.where(pairs == UNPAIRED, np.nan, np.log(state.frequencies[pairs]) - target.logarithms)
    value = float(np.nansum((errors / target.noise) ** 2)) + penalty
    return Misfit(value, pairs, errors, gap, margin, count, mac)


def strays(known: ModeCount, state: ModalState) -> tuple[IntArray, FloatArray]:
    """The modes that make the number wrong: those that should lie on the other side of the limit.

    Returns
    -------
    modes : ndarray of int, shape (n,)
    beyond : ndarray, shape (n,)
        How far each is on the wrong side, in units of what is soft: positive above the limit, negative below.
    """
    wrong = np.zeros(len(state.frequencies), dtype=bool)
    wrong[: known.least] = state.frequencies[: known.least] > known.limit
    wrong[known.most :] = state.frequencies[known.most :] < known.limit
    modes = np.flatnonzero(wrong)
    return modes, np.log(state.frequencies[modes] / known.limit) / _COUNT_SCALE


def pair_by_shape(target: Target, state: ModalState) -> tuple[IntArray, FloatArray]:
    """The assignment of greatest total MAC, with the MAC of each pair; below one half a mode stays alone.

    Raises
    ------
    HousingError
        Where the model's motion was not taken where the shapes were.
    """
    assert target.shapes is not None
    if state.measured is None or state.measured.shape[1] != target.shapes.shape[1]:
        raise HousingError(
            f"shapes measured at {target.shapes.shape[1]} degrees of freedom, of which the model has none"
        )
    table = mac(target.shapes, state.measured)
    rows, columns = linear_sum_assignment(-table)
    pairs, values = np.full(len(table), UNPAIRED), np.zeros(len(table))
    values[rows] = table[rows, columns]
    pairs[rows] = np.where(values[rows] >= _LEAST_MAC, columns, UNPAIRED)
    return pairs, values


def counterparts(modes: IntArray, state: ModalState, other: ModalState) -> IntArray:
    """The other design's modes that move seats and skin as some of one's modes do, whatever their order there."""
    motions = [np.hstack([of.seats.reshape(len(of.seats), -1), of.skin]) for of in (state, other)]
    rows, columns = linear_sum_assignment(-mac(motions[0][modes], motions[1]))
    assert (rows == np.arange(len(modes))).all()
    return np.asarray(columns)


def residuals(
    target: Target, misfit: Misfit, near: Neighbour, *, penalties: bool = False
) -> tuple[FloatArray, FloatArray]:
    """What a neighbour misses in units of the noise, and how that changes with the coordinates.

    With ``penalties`` also how far modes lie on the wrong side of the limit of the number known: a search takes that
    along, but it is no measurement.

    Returns
    -------
    residuals : ndarray, shape (n_residuals,)
        (ln ω - ln ω_measured) / σ of the paired modes, then what of each unit shape √n ψ / s lies across the model's.
    slopes : ndarray, shape (n_residuals, n_parameters)
    """
    told = (misfit.pairs != UNPAIRED) & np.isfinite(target.noise)
    modes = misfit.pairs[told]
    missed = [misfit.errors[told] / target.noise[told]]
    rows = [near.slopes[:, modes].T / target.noise[told, None]]
    if target.count is not None and penalties:
        lost, beyond = strays(target.count, near.state)
        missed.append(beyond)
        rows.append(near.slopes[:, lost].T / _COUNT_SCALE)
    if target.shapes is not None and np.isfinite(target.shape_noise) and near.state.measured is not None:
        scale = np.sqrt(target.shapes.shape[1]) / target.shape_noise
        model, turning = near.state.measured[modes], near.measured_slopes(modes)
        length = np.linalg.norm(model, axis=1)[:, None]
        own = model / length
        turning = (turning - np.einsum("pmd,md->pm", turning, own)[..., None] * own) / length
        shapes = target.shapes[told]
        unit = shapes / np.linalg.norm(shapes, axis=1)[:, None]
        along = (unit * own).sum(axis=1)[:, None]
        missed.append(scale * (along * own - unit).ravel())
        # d(ψ·v v) = (ψ·dv) v + (ψ·v) dv, with v the model's unit shape.
        change = np.einsum("pmd,md->pm", turning, unit)[..., None] * own + along * turning
        rows.append(scale * change.reshape(len(change), -1).T)
    return np.concatenate(missed), np.concatenate(rows)
