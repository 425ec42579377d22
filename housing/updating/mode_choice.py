"""Mode choice during a fit: the model modes paired with measured frequencies, at the least total cost.

The modes that are compared in the end are the dominant ones, as many as were measured, in order of frequency. Under
this rule the misfit of a search is discontinuous: where the 8th and the 9th mode exchange their places, one residual
jumps by many per cent, and where a strong mode passes the end of the band, several do. So the search may choose any
modes, and modes that do not dominate cost a penalty beside the errors of frequency. With L the logarithm of a strength,
S the modes chosen, r the gap wanted between chosen and other modes, and t a free threshold,

    Σ_{i in S} ⟨t + r/2 - L_i⟩² / s² + Σ_{j not in S} ⟨L_j - t + r/2⟩² / s²,      ⟨x⟩ = max(x, 0),

is summed over the three measures of dominance, each with a threshold of its own. It is zero where every mode chosen is
stronger than every other one by r. Its minimum over all S, together with the frequencies' errors, is a continuous
function of the design: the choice changes only where both choices cost alike. A mode near the end of the band costs no
more than its distance from being clearly beyond. The minimum is found alternately: thresholds for a choice, and for
thresholds the best choice in order of frequency (dynamic programming), from several initial thresholds.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np

from gearwhine.housing.modes.dominance import Dominance
from gearwhine.numerics.arrays import BoolArray, FloatArray, IntArray

_Shortfalls: TypeAlias = tuple[FloatArray, FloatArray, FloatArray]

GAP_SCALE = 0.02
"""Shortfall of a gap that costs as much as an error of one σ."""

# Distance in ln ω that a strong mode keeps beyond the end of the band, and the shortfall that costs one σ.
_CLEAR_OF_BAND_END = 0.01
_CLEAR_SCALE = 0.005
_TURNS = 8
_SETTLED_STEP = 1e-9
_PLACES = 2  # places of the initial thresholds above and below the number of modes
_FAINTEST_STRENGTH = 1e-300  # strength of modes that have none


@dataclass(frozen=True)
class ChoiceShortfall:
    """Shortfalls of a choice of modes from a clear one, in units of the penalties' scales.

    Attributes
    ----------
    criterion : ndarray of int, shape (n,)
        Index of the measure of dominance: acceleration, velocity, absolute; -1 for the end of the band.
    modes : ndarray of int, shape (n,)
    sign : ndarray, shape (n,)
        Sign of ln strength (or ln ω) in the shortfall: -1 where more is wanted, 1 where less.
    values : ndarray, shape (n,)
        Shortfalls, positive.
    scale : ndarray, shape (n,)
        Unit of each in ln strength or ln ω.
    """

    criterion: IntArray
    modes: IntArray
    sign: FloatArray
    values: FloatArray
    scale: FloatArray

    @property
    def cost(self) -> float:
        """Cost of the choice: sum of squares of the shortfalls."""
        return float(self.values @ self.values)


@dataclass(frozen=True)
class _Strengths:
    """Logarithms of the strengths by the measures in use, and the gaps required of them."""

    rows: IntArray
    logarithms: FloatArray  # (n_measures, n_modes)
    asked: FloatArray  # (n_measures,)
    scale: float  # unit: ln strength; half of a gap lies on either side of a threshold
    end_scale: float  # unit: ln ω
    beyond: FloatArray  # ln ω beyond the end of the band, negative inside; (n_modes,)
    upward: FloatArray  # 1 where that is the upper end, else -1; (n_modes,)

    @cached_property
    def edge(self) -> FloatArray:
        """Shortfall of each mode from being clearly beyond the band, in units of the penalty's scale."""
        return np.maximum(_CLEAR_OF_BAND_END - self.beyond, 0.0) / self.end_scale

    def below(self, thresholds: FloatArray) -> FloatArray:
        """Shortfall of each mode below thresholds (..., n_measures) and gap, shape (..., n_measures, n_modes)."""
        lacks = thresholds[..., None] + 0.5 * self.asked[:, None] - self.logarithms
        return np.asarray(np.maximum(lacks, 0.0) / self.scale)

    def above(self, thresholds: FloatArray) -> FloatArray:
        """Excess of each mode above thresholds less gap, of the same shape."""
        lacks = self.logarithms - thresholds[..., None] + 0.5 * self.asked[:, None]
        return np.asarray(np.maximum(lacks, 0.0) / self.scale)

    def split(self, chosen: BoolArray, thresholds: FloatArray) -> _Shortfalls:
        """Shortfalls of the modes chosen, of the modes left as weak, and of the modes left as beyond the band.

        Parameters
        ----------
        chosen : ndarray of bool, shape (..., n_modes)
        thresholds : ndarray, shape (..., n_measures)

        Returns
        -------
        below, above : ndarray, shape (..., n_measures, n_modes)
        edge : ndarray, shape (..., n_modes)
        """
        above = self.above(thresholds)
        weak = ~chosen & ((above**2).sum(axis=-2) < self.edge**2)
        below = np.where(chosen[..., None, :], self.below(thresholds), 0.0)
        return below, np.where(weak[..., None, :], above, 0.0), np.where(chosen | weak, 0.0, self.edge)


def _strengths(
    strengths: Dominance, band: tuple[float, float], gap: float, margin: float, firmness: float
) -> _Strengths:
    every = np.array([strengths.acceleration, strengths.velocity, strengths.absolute])
    least = np.array([gap, margin, margin])
    rows = np.flatnonzero(np.isfinite(least))
    omega = np.log(np.maximum(strengths.frequencies, _FAINTEST_STRENGTH))
    over, under = omega - np.log(band[1]), np.log(band[0]) - omega
    logarithms = np.log(np.maximum(every[rows], _FAINTEST_STRENGTH))
    return _Strengths(
        rows=rows,
        logarithms=logarithms,
        asked=least[rows],
        scale=GAP_SCALE / np.sqrt(2.0) / firmness,
        end_scale=_CLEAR_SCALE / firmness,
        beyond=np.maximum(over, under),
        upward=np.where(over >= under, 1.0, -1.0),
    )


def choice_shortfall(
    chosen: IntArray,
    strengths: Dominance,
    band: tuple[float, float],
    gap: float,
    margin: float = -np.inf,
    firmness: float = 1.0,
) -> ChoiceShortfall:
    """Shortfalls of a choice of modes, with the thresholds of least cost.

    Parameters
    ----------
    chosen : ndarray of int
    strengths : Dominance
    band : tuple of float
        Band of the dominant modes [rad/s].
    gap : float
        ln of the least ratio of strengths between chosen and other modes, by acceleration.
    margin : float
        Least ratio by the other two measures; negative infinity where it is not asked for.
    firmness : float
        Factor on the penalties, before they are squared.
    """
    table = _strengths(strengths, band, gap, margin, firmness)
    is_chosen = np.zeros(table.logarithms.shape[1], dtype=bool)
    is_chosen[chosen] = True
    _, (below, above, edge) = _settled(table, is_chosen)
    parts = []
    for values, sign in ((below, -1.0), (above, 1.0)):
        rows, modes = np.nonzero(values)
        same = np.ones(len(rows))
        parts.append((table.rows[rows], modes, sign * same, values[rows, modes], table.scale * same))
    (modes,) = np.nonzero(edge)
    same = np.ones(len(modes))
    parts.append((np.full(len(modes), -1), modes, -table.upward[modes], edge[modes], table.end_scale * same))
    return ChoiceShortfall(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def choose_modes(
    logarithms: FloatArray,
    noise: FloatArray,
    strengths: Dominance,
    band: tuple[float, float],
    gap: float,
    margin: float = -np.inf,
    firmness: float = 1.0,
) -> IntArray:
    """Choose the modes of least cost for measured frequencies, ascending.

    Parameters
    ----------
    logarithms : ndarray, shape (n,)
        ln ω of the measured modes, ascending.
    noise : ndarray, shape (n,)
        Relative standard deviation of each.
    strengths : Dominance
        Strengths of all modes, of which ``n`` or more are in the band.
    band, gap, margin, firmness
        See :func:`choice_shortfall`.

    Returns
    -------
    ndarray of int, shape (n,)
    """
    table = _strengths(strengths, band, gap, margin, firmness)
    inside = np.flatnonzero(table.beyond <= 0.0)
    n = len(logarithms)
    if len(inside) == n:
        return inside
    # Initial thresholds: between the n strongest and the rest, and some places up and down.
    ranked = np.sort(table.logarithms[:, inside], axis=1)[:, ::-1]
    places = np.arange(max(n - _PLACES, 1), min(n + _PLACES + 1, len(inside)))
    if not len(places) or not len(table.rows):
        return strengths.strongest(n, band)
    thresholds = 0.5 * (ranked[:, places - 1] + ranked[:, places]).T
    errors = ((np.log(strengths.frequencies[inside]) - logarithms[:, None]) / noise[:, None]) ** 2
    best, least, selection = inside[:n], np.inf, np.zeros((0, 0), dtype=bool)
    for _ in range(_TURNS):
        before, selection = selection, _best_choices(table, inside, errors, thresholds)
        if np.array_equal(selection, before):
            break  # thresholds and costs repeat
        thresholds, (below, above, edge) = _settled(table, selection)
        numbers = np.nonzero(selection[:, inside])[1].reshape(-1, n)
        costs = (
            (below**2 + above**2).sum(axis=(1, 2)) + (edge**2).sum(axis=1) + errors[np.arange(n), numbers].sum(axis=1)
        )
        row = int(np.argmin(costs))
        if not costs[row] < least - _SETTLED_STEP:
            break
        best, least = inside[numbers[row]], float(costs[row])
    return best


def _settled(table: _Strengths, selection: BoolArray) -> tuple[FloatArray, _Shortfalls]:
    """Find the thresholds of least cost for choices (..., n_modes), by Newton's steps, shape (..., n_measures).

    Return with them the shortfalls at these thresholds, as of :meth:`_Strengths.split`.
    """
    inside = table.beyond <= 0.0
    weakest = np.where(selection[..., None, :], table.logarithms, np.inf).min(axis=-1)
    strongest = np.where((~selection & inside)[..., None, :], table.logarithms, -np.inf).max(axis=-1)
    # Initially midway; where no other mode is left, low enough for all.
    thresholds = np.where(np.isfinite(strongest), 0.5 * (weakest + strongest), weakest - 0.5 * table.asked)
    for _ in range(_TURNS):
        shortfalls = below, above, _ = table.split(selection, thresholds)
        active = (below > 0.0).sum(axis=-1) + (above > 0.0).sum(axis=-1)
        step = table.scale * (above.sum(axis=-1) - below.sum(axis=-1)) / np.maximum(active, 1)
        if not step.any():
            return thresholds, shortfalls
        thresholds = thresholds + step
        if np.abs(step).max() < _SETTLED_STEP:
            break
    return thresholds, table.split(selection, thresholds)


def _best_choices(table: _Strengths, inside: IntArray, errors: FloatArray, thresholds: FloatArray) -> BoolArray:
    """Choose the modes of least cost for each row of thresholds, in order of frequency (dynamic programming).

    Parameters
    ----------
    table : _Strengths
    inside : ndarray of int, shape (n_inside,)
        The modes in the band.
    errors : ndarray, shape (n, n_inside)
        Cost of each model mode as the partner of each measured mode.
    thresholds : ndarray, shape (n_rows, n_measures)

    Returns
    -------
    ndarray of bool, shape (n_rows, n_modes)
    """
    taking = (table.below(thresholds)[..., inside] ** 2).sum(axis=1).T
    leaving = np.minimum((table.above(thresholds)[..., inside] ** 2).sum(axis=1), table.edge[inside] ** 2).T
    n, rows = len(errors), len(thresholds)
    # cost[r, k]: least cost with k of the modes considered so far chosen.
    cost = np.full((rows, n + 1), np.inf)
    cost[:, 0] = 0.0
    took = np.zeros((len(inside), rows, n + 1), dtype=bool)
    for place in range(len(inside)):
        cost_taking = cost[:, :-1] + taking[place, :, None] + errors[:, place]
        cost = cost + leaving[place, :, None]
        np.less(cost_taking, cost[:, 1:], out=took[place, :, 1:])
        np.minimum(cost[:, 1:], cost_taking, out=cost[:, 1:])
    chosen = np.zeros((rows, table.logarithms.shape[1]), dtype=bool)
    number, every = np.full(rows, n), np.arange(rows)
    for place in range(len(inside) - 1, -1, -1):
        cost_taking = took[place, every, number]
        chosen[:, inside[place]] = cost_taking
        number = number - cost_taking
    return chosen
