"""Misfit: objective function of updating, the deviation of a design's modes from the measured ones and the prior.

    J = Σ_i (ln ω_i - ln ω_i,measured)² / σ_i² + Σ_i n (1 - MAC_i) / s² + |z|² + penalties,

twice the negative logarithm of the posterior density where frequencies carry independent relative errors σ_i, the n
motions of a measured shape errors of s times their root-mean-square, and the prior of the coordinates z is the unit
normal one (Mottershead and Friswell 1993; Beck and Katafygiotis 1998).
Penalties exclude faults that a good sum would hide: an unclear choice of dominant modes, measures of dominance that
disagree, and a number of modes other than the known one.

Where shapes were measured, modes are paired by the assignment of greatest MAC. Frequencies alone are paired in their
order (:attr:`Target.pairing`): the first with the first; with the nearest ones; or with the dominant ones, during a
search with the modes of least cost (:mod:`gearwhine.housing.updating.mode_choice`), which at a good end are the
dominant ones.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.optimize import linear_sum_assignment

from gearwhine.housing.correlation import modal_assurance_criterion
from gearwhine.housing.correlation.pairing import nearest_in_order
from gearwhine.housing.errors import HousingError
from gearwhine.housing.updating.mode_choice import ChoiceShortfall, choice_shortfall, choose_modes
from gearwhine.housing.updating.surrogate import ModalState, Neighbour
from gearwhine.numerics.arrays import FloatArray, IntArray

UNPAIRED = -1
"""Stands for the partner of a measured mode that has none."""

_LEAST_MAC = 0.5  # below it two shapes are no pair
_COUNT_SCALE = 0.01  # ln ω on the wrong side of the limit of a known number of modes that costs one σ
_COUNT_CLEAR = 0.005  # ln ω by which a mode has to be clear of that limit, so that the mesh does not decide
_TOO_FEW_MODES = 1e6  # J for each mode that a design has too few of to pair
_MET_FREQUENCY_ERROR = 2.0  # largest error of a frequency that counts as met, in σ
_UNPAIRED_COST = 25.0  # J for each measured mode without partner, beside that of its shape: an error of five σ


@dataclass(frozen=True)
class ModeCount:
    """A known number of modes: from ``least`` to ``most`` below ``limit`` [rad/s], rigid ones counted."""

    limit: float
    least: int
    most: int


@dataclass(frozen=True)
class Target:
    """Target of updating: measured modes and their uncertainties.

    Attributes
    ----------
    frequencies : ndarray, shape (n,)
        Circular frequencies, ascending [rad/s].
    noise : ndarray, shape (n,)
        Relative standard deviation of each; infinite for a mode that is left out.
    band : tuple of float
        Band of the dominant modes [rad/s].
    shapes : ndarray, shape (n, n_dofs), optional
        Measured shapes, of any scale.
    shape_noise : float
        Standard deviation of each of their motions, as a part of the shape's root-mean-square; infinite where shapes
        decide the pairs only.
    gap : float
        Least gap ln(strength of the weakest chosen / strongest left out); not asked for where shapes were measured.
    margin : float
        Least gap by the other two measures of dominance; not asked for by default.
    count : ModeCount, optional
    pairing : {"dominance", "nearest", "order"}
        How frequencies are paired where no shapes were measured.
    firmness : float
        Factor on the penalties, before they are squared. Soft penalties let a search pass obstacles; firm ones leave no
        violation at its end.

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
    firmness: float = 1.0
    pairing: Literal["dominance", "nearest", "order"] = "dominance"

    def __post_init__(self) -> None:
        """Check frequencies, noise and number of shapes."""
        measured = self.frequencies
        if len(measured) == 0 or measured[0] <= 0.0 or np.any(np.diff(measured) <= 0.0):
            raise HousingError(f"measured frequencies {measured} rad/s must be positive and ascending")
        if self.noise.shape != measured.shape or not (self.noise > 0.0).all():
            raise HousingError(f"noise {self.noise}: expected a positive number for each of {len(measured)} modes")
        if self.shapes is not None and len(self.shapes) != len(measured):
            raise HousingError(f"{len(self.shapes)} measured shapes for {len(measured)} measured frequencies")

    @property
    def logarithms(self) -> FloatArray:
        """Logarithms ln ω of the measured frequencies, shape (n,)."""
        return np.log(self.frequencies)


@dataclass(frozen=True)
class Misfit:
    """Deviation of a design from the target.

    Attributes
    ----------
    value : float
        J.
    pairs : ndarray of int, shape (n,)
        The place of each measured mode's partner in the design's :class:`ModalState`, from 0; :data:`UNPAIRED` where it
        has none.
    errors : ndarray, shape (n,)
        ln(model / measured); NaN where unpaired.
    gap : float
        ln(strength of the weakest paired / strongest of the others in the band): negative where the modes paired are
        not the dominant ones, infinite where dominance does not decide.
    margin : float
        Least gap by the other two measures of dominance.
    count : int
        Modes below the limit of :class:`ModeCount`; 0 where none is given.
    mac : ndarray, shape (n,), or None
        MAC of each pair, where shapes were measured.
    choice_shortfall : ChoiceShortfall, or None
        Shortfalls of the choice of modes from a clear one, where dominance decides.
    """

    value: float
    pairs: IntArray
    errors: FloatArray
    gap: float
    margin: float
    count: int
    mac: FloatArray | None = None
    choice_shortfall: ChoiceShortfall | None = None

    @property
    def by_dominance(self) -> bool:
        """Whether dominance chose the modes, so that its gap means something."""
        return self.choice_shortfall is not None or bool(np.isfinite(self.gap))

    @property
    def measures_agree(self) -> bool:
        """Whether all three measures of dominance choose the modes that were paired."""
        return min(self.gap, self.margin) > 0.0

    @property
    def in_words(self) -> str:
        """Describe the errors, the clearness of the mode choice and the number of modes, as far as they apply."""
        parts = [f"max {self.max_percent:.2f} %"]
        if self.choice_shortfall is not None:
            clear = np.isfinite([self.gap, self.margin]).all()
            rivals = f"gap {self.gap:.2f}, margin {self.margin:.2f}" if clear else "no other mode in the band"
            parts.append(rivals)
        if self.count:
            parts.append(f"{self.count} modes below the limit")
        return ", ".join(parts)

    @property
    def rms_percent(self) -> float:
        """Root-mean-square error of the paired modes; infinite where none is."""
        errors = np.expm1(self.errors[self.pairs != UNPAIRED])
        return float(100.0 * np.sqrt(np.mean(errors**2))) if len(errors) else float("inf")

    @property
    def max_percent(self) -> float:
        """Largest error of the paired modes; infinite where none is."""
        errors = np.expm1(self.errors[self.pairs != UNPAIRED])
        return float(100.0 * np.abs(errors).max()) if len(errors) else float("inf")


def measure(target: Target, state: ModalState, coordinates: FloatArray, *, strict: bool = False) -> Misfit:
    """Pair the modes of a design with the measured ones and sum up the deviations.

    Parameters
    ----------
    target : Target
    state : ModalState
    coordinates : ndarray, shape (n_parameters,)
    strict : bool
        Whether only the dominant modes are paired, as a model is judged, rather than those of least cost.
    """
    n = len(target.frequencies)
    penalty = float(coordinates @ coordinates)
    mac, gap, margin, clear = None, float("inf"), float("inf"), None
    if target.shapes is None and target.pairing != "dominance":
        pairs = pair_by_frequency(target, state)
        penalty += _TOO_FEW_MODES * np.count_nonzero(pairs == UNPAIRED)
    elif target.shapes is None:
        strengths = state.dominance
        pairs = strengths.strongest(n, target.band)
        if len(pairs) < n:
            penalty += _TOO_FEW_MODES * (n - len(pairs))
            return Misfit(penalty, np.full(n, UNPAIRED), np.full(n, np.nan), 0.0, 0.0, 0)
        if not strict:
            rules = (target.gap, target.margin, target.firmness)
            pairs = choose_modes(target.logarithms, target.noise, strengths, target.band, *rules)
        gap, margin = strengths.gaps(pairs, target.band)
        clear = choice_shortfall(pairs, strengths, target.band, target.gap, target.margin, target.firmness)
        penalty += clear.cost
    else:
        pairs, mac = pair_by_shape(target, state)
        included = np.isfinite(target.noise)
        penalty += _UNPAIRED_COST * np.count_nonzero(pairs[included] == UNPAIRED)
        # A shape without partner costs as much as at the limit of pairing: with less, a search would drop the pair.
        unlike = 1.0 - np.where(pairs == UNPAIRED, _LEAST_MAC, mac)
        penalty += target.shapes.shape[1] / target.shape_noise**2 * float(unlike[included].sum())
    count = 0
    if target.count is not None:
        count = state.n_below(target.count.limit)
        beyond = target.firmness * misplaced_modes(target.count, state)[1]
        penalty += float(beyond @ beyond)
    errors = np.where(pairs == UNPAIRED, np.nan, np.log(state.frequencies[pairs]) - target.logarithms)
    value = float(np.nansum((errors / target.noise) ** 2) + penalty)
    return Misfit(value, pairs, errors, gap, margin, count, mac, clear)


def is_met(target: Target, misfit: Misfit) -> bool:
    """Whether a design meets the target.

    Every frequency is within two standard deviations, the mode choice is as clear as wanted and the same by all
    measures, and the number of modes is the known one. Never where shapes were measured: the least misfit is sought.
    """
    if target.shapes is not None:
        return False
    included = np.isfinite(target.noise)
    if (misfit.pairs[included] == UNPAIRED).any() or (
        np.abs(misfit.errors / target.noise)[included] > _MET_FREQUENCY_ERROR
    ).any():
        return False
    bounds = target.count
    counted = bounds is None or bounds.least <= misfit.count <= bounds.most
    return counted and misfit.gap >= target.gap and (misfit.margin > 0.0 or not np.isfinite(target.margin))


def misplaced_modes(bounds: ModeCount, state: ModalState) -> tuple[IntArray, FloatArray]:
    """Return the modes that violate a known number of modes below a limit, or nearly do.

    The rigid modes are below it and count first.

    Returns
    -------
    modes : ndarray of int, shape (n,)
    beyond : ndarray, shape (n,)
        Distance of each from its own side of the limit in units of the penalty's scale: positive above, negative below.
    """
    beyond = np.log(state.frequencies / bounds.limit)
    shortfall = np.zeros(len(beyond))
    least, most = (max(bound - state.n_rigid, 0) for bound in (bounds.least, bounds.most))
    shortfall[:least] = np.maximum(beyond[:least] + _COUNT_CLEAR, 0.0)
    shortfall[most:] = np.minimum(beyond[most:] - _COUNT_CLEAR, 0.0)
    modes = np.flatnonzero(shortfall)
    return modes, shortfall[modes] / _COUNT_SCALE


def pair_by_frequency(target: Target, state: ModalState) -> IntArray:
    """Pair modes in order of frequency, the first with the first or the nearest ones, as the target asks for."""
    n = len(target.frequencies)
    pairs = np.full(n, UNPAIRED)
    if target.pairing == "order":
        count = min(n, len(state.frequencies))
        pairs[:count] = np.arange(count)
    else:
        model, measured = nearest_in_order(state.frequencies, target.frequencies).T
        pairs[measured] = model
    return pairs


def pair_by_shape(target: Target, state: ModalState) -> tuple[IntArray, FloatArray]:
    """Pair modes by greatest total MAC, and return the MAC of each pair; below one half a mode has no partner.

    Raises
    ------
    HousingError
        Where the model's motion is missing at the degrees of freedom of the shapes.
    """
    assert target.shapes is not None
    if state.measured is None or state.measured.shape[1] != target.shapes.shape[1]:
        raise HousingError(
            f"shapes measured at {target.shapes.shape[1]} degrees of freedom, of which the model has none"
        )
    table = modal_assurance_criterion(target.shapes, state.measured)
    rows, columns = linear_sum_assignment(-table)
    pairs, values = np.full(len(table), UNPAIRED), np.zeros(len(table))
    values[rows] = table[rows, columns]
    pairs[rows] = np.where(values[rows] >= _LEAST_MAC, columns, UNPAIRED)
    return pairs, values


def residuals(
    target: Target, misfit: Misfit, near: Neighbour, *, penalties: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Residuals of a design in units of the noise, and their derivatives by the coordinates.

    Parameters
    ----------
    target : Target
    misfit : Misfit
        Misfit of the design: pairs, errors of the frequencies and shortfalls of the mode choice.
    near : Neighbour
        The design's modes, those that the misfit numbers, and their slopes.
    penalties : bool
        Whether the violations of the known number of modes and the shortfalls of the mode choice are residuals too: a
        search needs these, but they are no measurements.

    Returns
    -------
    residuals : ndarray, shape (n_residuals,)
        (ln ω - ln ω_measured) / σ of the paired modes, then the part of each unit shape √n ψ / s across the model's.
    slopes : ndarray, shape (n_residuals, n_parameters)
    """
    included = (misfit.pairs != UNPAIRED) & np.isfinite(target.noise)
    modes = misfit.pairs[included]
    missed = [misfit.errors[included] / target.noise[included]]
    rows = [near.slopes[:, modes].T / target.noise[included, None]]
    if target.count is not None and penalties:
        lost, beyond = misplaced_modes(target.count, near.state)
        missed.append(target.firmness * beyond)
        rows.append(target.firmness * near.slopes[:, lost].T / _COUNT_SCALE)
    if misfit.choice_shortfall is not None and penalties:
        missed.append(misfit.choice_shortfall.values)
        rows.append(_shortfall_slopes(misfit.choice_shortfall, near))
    if target.shapes is not None and np.isfinite(target.shape_noise) and near.state.measured is not None:
        scale = np.sqrt(target.shapes.shape[1]) / target.shape_noise
        model, turning = near.state.measured[modes], near.measured_slopes(modes)
        length = np.linalg.norm(model, axis=1)[:, None]
        direction = model / length
        turning = (turning - np.einsum("pmd,md->pm", turning, direction)[..., None] * direction) / length
        shapes = target.shapes[included]
        unit = shapes / np.linalg.norm(shapes, axis=1)[:, None]
        along = (unit * direction).sum(axis=1)[:, None]
        missed.append(scale * (along * direction - unit).ravel())
        # d(ψ·v v) = (ψ·dv) v + (ψ·v) dv, with v the model's unit shape.
        change = np.einsum("pmd,md->pm", turning, unit)[..., None] * direction + along * turning
        rows.append(scale * change.reshape(len(change), -1).T)
    return np.concatenate(missed), np.concatenate(rows)


def _shortfall_slopes(shortfall: ChoiceShortfall, near: Neighbour) -> FloatArray:
    """Slopes of the shortfalls of a choice of modes, its thresholds following, shape (n, n_parameters)."""
    weight = shortfall.sign / shortfall.scale
    modes, place = np.unique(shortfall.modes, return_inverse=True)
    strengths = near.strength_slopes(modes)  # (3, n_parameters, n)
    by_strength = strengths[shortfall.criterion, :, place].T
    slopes = np.where(shortfall.criterion < 0, near.slopes[:, shortfall.modes], by_strength).T * weight[:, None]
    for criterion in range(len(strengths)):
        # The threshold is free: a common change of all strengths of one measure costs nothing.
        rows = shortfall.criterion == criterion
        if rows.any():
            free = shortfall.sign[rows] / np.linalg.norm(shortfall.sign[rows])
            slopes[rows] -= np.outer(free, free @ slopes[rows])
    return np.asarray(slopes)
