"""Mode pairing: the best assignment of measured modes to model modes by shape and frequency.

A measured mode j and a model mode i score

    s_ij = MAC_ij · exp(-½ (ln(ω_i / ω_j) / σ)²),

nothing where ω_i / ω_j is beyond exp(±2σ) or the MAC below its least. The pairs are the linear assignment with the
largest sum of scores, each mode in one pair at most: choosing the largest MAC row by row would give one model mode to
two measured ones. The margin of an assignment is its lead over the next best one. The frequency has a light weight
(σ = 0.2: 5 % off costs 3 % of the score), because shapes are to decide and frequencies to be judged.

Close modes, of the model or of the test, mix. Each is then scored by the part of a shape that lies in the span of the
other's group (:func:`gearwhine.housing.correlation.subspaces.span_mac`), which is the same however a group is mixed.
Within a group the members' own MACs decide where each is most of that score; where not, the members cannot be
distinguished and the order of frequency is kept.

Frequencies without shapes are paired in their order: the first with the first, or by the monotone assignment of least
squares (:func:`nearest_in_order`).
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.housing.correlation.modal_assurance_criterion import ShapeArray, modal_assurance_criterion, two_sets
from gearwhine.housing.correlation.subspaces import close_modes, span_mac
from gearwhine.housing.errors import HousingError
from gearwhine.numerics.arrays import BoolArray, FloatArray, IntArray


def best_assignment(scores: FloatArray) -> list[tuple[int, int]]:
    """Rows and columns, each at most once, with the largest sum of scores; pairs without a score are left out.

    Parameters
    ----------
    scores : ndarray, shape (n, m)
        Zero or above; zero forbids.

    Returns
    -------
    list of (row, column)
        Ascending in the rows.
    """
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(scores, maximize=True)
    return [(int(i), int(j)) for i, j in zip(rows, columns, strict=True) if scores[i, j] > 0.0]


def nearest_in_order(model: FloatArray, measured: FloatArray) -> IntArray:
    """Pair frequencies in ascending order with the least sum of squared logarithmic errors.

    All of the shorter list are paired, and some of the longer one are left out. With the shorter list s and the longer
    one l, D_j(i) is the least sum of pairs of s_0 … s_j with members of l up to l_i:

        D_j(i) = min over k ≤ i of D_{j-1}(k - 1) + (ln s_j - ln l_k)²,

    the recurrence of dynamic time warping without repetitions (Sakoe and Chiba 1978).

    Parameters
    ----------
    model, measured : ndarray, shapes (a,) and (b,)
        Positive frequencies, ascending, in one unit.

    Returns
    -------
    ndarray of int, shape (min(a, b), 2)
        Indices of the model's and of the measured mode of each pair, ascending.
    """
    swapped = len(measured) > len(model)
    short, long = (model, measured) if swapped else (measured, model)
    costs = (np.log(short)[:, None] - np.log(long)) ** 2
    before = np.zeros(len(long) + 1)  # D_{j-1}(k - 1), with D of no pairs at k = 0
    taken = np.empty(costs.shape, dtype=np.int64)
    for j, row in enumerate(costs):
        ending = before[:-1] + row
        least = np.minimum.accumulate(ending)
        # The last k at which the minimum was lowered is the one that it is taken at.
        lowered = np.concatenate(([True], ending[1:] < least[:-1]))
        taken[j] = np.maximum.accumulate(np.where(lowered, np.arange(len(long)), 0))
        before = np.concatenate(([np.inf], least))
    chosen = np.empty(len(short), dtype=np.int64)
    last = len(long) - 1
    for j in range(len(short) - 1, -1, -1):
        chosen[j] = taken[j, last]
        last = chosen[j] - 1
    order = np.arange(len(short))
    return np.column_stack((order, chosen) if swapped else (chosen, order))


def margin(scores: FloatArray, row: int, columns: BoolArray) -> float:
    """Relative loss of the best assignment where a row may not take any of some columns.

    The best sum with the row in one of these columns, less the best sum with it in none of them, over the row's score
    in the first assignment; clipped to 0. 1: the other rows gain nothing. 0: another assignment is as good.

    It measures the clearness of the choice, not its probability: a row with one poor partner and no other has 1.

    Parameters
    ----------
    scores : ndarray, shape (n, m)
        Zero or above.
    row : int
    columns : ndarray of bool, shape (m,)
        Columns, in one of which the row scores above zero.
    """
    within, without = scores.copy(), scores.copy()
    # A bonus larger than any sum keeps the row in these columns, and is taken off again.
    bonus = 1.0 + float(scores.sum())
    within[row] = np.where(columns & (scores[row] > 0.0), scores[row] + bonus, 0.0)
    without[row, columns] = 0.0
    pairs = best_assignment(within)
    score = next(scores[i, j] for i, j in pairs if i == row)
    best = sum(scores[i, j] for i, j in pairs)
    lost = best - sum(scores[i, j] for i, j in best_assignment(without))
    return float(np.clip(lost / score, 0.0, 1.0))


_CLEAR_MAC_SHARE = 0.75  # least share of one close mode in a shape's MAC with their span, by which it is identified
_LEAST_FREEDOMS = 2
_WINDOW = 2.0  # spreads of frequency within which pairs are made


@dataclass(frozen=True)
class PairingRule:
    """Criteria of a pair, fixed before the pairs are known.

    Attributes
    ----------
    least_mac : float
        Below it a measured mode stays alone. At 0.5 a pair shares more than half of the shape's square, which no second
        model mode can where the survey sees the model's modes as orthogonal.
    frequency_spread : float
        σ of the logarithm of the frequencies' ratio.
    closeness : float
        Neighbours within this part of their frequency are close modes.
    duplicate_mac : float
        Two measured modes as alike as this are one mode found twice, or two that the survey cannot separate.
    """

    least_mac: float = 0.5
    frequency_spread: float = 0.2
    closeness: float = 0.01
    duplicate_mac: float = 0.9

    @property
    def window(self) -> float:
        """Largest logarithm of the frequencies' ratio within which pairs are made."""
        return _WINDOW * self.frequency_spread

    def __post_init__(self) -> None:
        """Check that the thresholds lie within their ranges."""
        for name, low, high in (
            ("least_mac", 0.0, 1.0),
            ("frequency_spread", 0.0, np.inf),
            ("duplicate_mac", 0.0, 1.0),
        ):
            value = getattr(self, name)
            if not low < value <= high:
                raise HousingError(f"{name} is {value}; expected a number above {low:g} and at most {high:g}")
        close_modes([], self.closeness)


@dataclass(frozen=True)
class ShapePair:
    """Pair of a measured mode and its model mode.

    Attributes
    ----------
    model, measured : int
        Indices.
    mac : float
        MAC of the two shapes; among close modes, of one with the span of the other's, which is the same however these
        are mixed.
    confidence : float
        Margin of the best assignment with this pair over the best without it, as a part of the pair's score, from 0
        (another is as good) to 1; see :func:`gearwhine.housing.correlation.pairing.margin`. Not a probability. For want
        of this pair its measured mode may take one of a MAC below the least, other modes may not.
    close_model, close_measured : tuple of int
        Close modes to which the pair's mode belongs; empty where it stands apart.
    mixed : bool
        Whether shapes could not identify the single modes of the close group, so that the order of frequency was kept.
    """

    model: int
    measured: int
    mac: float
    confidence: float
    close_model: tuple[int, ...]
    close_measured: tuple[int, ...]
    mixed: bool


def pair_modes(
    model_frequencies: FloatArray,
    model_shapes: npt.ArrayLike,
    measured_frequencies: FloatArray,
    measured_shapes: npt.ArrayLike,
    rule: PairingRule | None = None,
) -> tuple[ShapePair, ...]:
    """Pair measured modes with the model's by the best assignment over shape and frequency.

    Parameters
    ----------
    model_frequencies, measured_frequencies : ndarray, shapes (a,) and (b,)
        Ascending [rad/s]; rigid motion of the model, at zero, is paired with nothing.
    model_shapes, measured_shapes : array_like, shapes (a, n_dofs) and (b, n_dofs)
        Shapes at the measured degrees of freedom; NaN where not measured.
    rule : PairingRule, optional

    Returns
    -------
    tuple of ShapePair
        Ascending in the measured modes. The same whatever complex numbers scale the shapes.

    Raises
    ------
    HousingError
        Where sets and frequencies do not fit together, or a shape has too few degrees of freedom to be distinguished
        from any other.
    """
    rule = rule or PairingRule()
    phi, psi = two_sets(model_shapes, measured_shapes, ("the model's", "the measured"))
    few = np.flatnonzero((~np.isnan(psi)).sum(axis=1) < _LEAST_FREEDOMS)
    if few.size:
        raise HousingError(
            f"measured shape {int(few[0]) + 1} has one degree of freedom, at which every mode looks alike; measure more"
        )
    groups = _groups(model_frequencies, rule, len(phi), "model")
    test_groups = _groups(measured_frequencies, rule, len(psi), "measured")
    mac = modal_assurance_criterion(phi, psi)
    elastic = tuple(group for group in groups if model_frequencies[group[0]] > 0.0)
    shared = _shared(phi, psi, mac, elastic, test_groups)
    scores = (shared * _weight(model_frequencies, measured_frequencies, rule)).T
    allowed = (shared >= rule.least_mac) & (scores > 0.0).T
    possible = np.where(allowed.T, scores, 0.0)
    chosen = best_assignment(possible)
    distance = np.abs(np.log(np.maximum(model_frequencies, 1e-300)[:, None] / measured_frequencies))
    pairs = []
    for members, rivals in _blocks(chosen, groups, test_groups):
        place = np.ix_(rivals, members)
        by_mac = _distinguished(mac[place], shared[place])
        order = _in_order(distance[place]) if by_mac is None else by_mac
        mixed = by_mac is None
        partners = rivals[order]
        if not allowed[partners, members].all():  # a chain of close modes, whose ends are not alike
            partners = np.array([i for j, i in chosen if j in members])
        inside = np.isin(np.arange(len(phi)), rivals)
        for i, j in zip(map(int, partners), members, strict=True):
            # A near miss of the rule is a rival of the mode's own pair; others are paired by the rule.
            rivalled = possible.copy()
            rivalled[j, ~inside] = scores[j, ~inside]
            pairs.append(
                ShapePair(
                    i,
                    int(j),
                    float(shared[i, j]),
                    margin(rivalled, int(j), inside),
                    _company(groups, i),
                    _company(test_groups, int(j)),
                    mixed,
                )
            )
    return tuple(sorted(pairs, key=lambda pair: pair.measured))


def _groups(frequencies: FloatArray, rule: PairingRule, count: int, whose: str) -> tuple[IntArray, ...]:
    if np.shape(frequencies) != (count,):
        raise HousingError(f"{np.size(frequencies)} {whose} frequencies for {count} shapes; expected as many")
    if whose == "measured" and np.any(np.asarray(frequencies) <= 0.0):
        raise HousingError("a measured frequency is not above zero")
    return close_modes(frequencies, rule.closeness)


def _shared(
    phi: ShapeArray,
    psi: ShapeArray,
    mac: FloatArray,
    groups: tuple[IntArray, ...],
    test_groups: tuple[IntArray, ...],
) -> FloatArray:
    """MAC of each mode with the span of the other's close modes, or with the other where it stands apart; (a, b)."""
    shared = mac.copy()
    for group in groups:
        if len(group) > 1:
            shared[group] = np.maximum(shared[group], span_mac(phi[group], psi))
    for group in test_groups:
        seen = ~np.isnan(psi[group]).any(axis=0)
        if len(group) > 1 and seen.sum() > len(group):
            part = span_mac(psi[np.ix_(group, seen)], phi[:, seen])
            shared[:, group] = np.maximum(shared[:, group], part[:, None])
    return shared


def _weight(model: FloatArray, measured: FloatArray, rule: PairingRule) -> FloatArray:
    with np.errstate(divide="ignore"):
        off = np.log(np.asarray(model)[:, None]) - np.log(measured)
    return np.asarray(np.where(np.abs(off) <= rule.window, np.exp(-0.5 * (off / rule.frequency_spread) ** 2), 0.0))


def _blocks(
    chosen: list[tuple[int, int]], groups: tuple[IntArray, ...], test_groups: tuple[IntArray, ...]
) -> list[tuple[IntArray, IntArray]]:
    """Split measured modes into sets that share a group of close modes, each with all its possible model modes."""
    model = {int(i): number for number, group in enumerate(groups) for i in group}
    test = {int(j): number for number, group in enumerate(test_groups) for j in group}
    blocks: list[tuple[set[int], set[int]]] = []
    for j, i in chosen:
        members, rivals = {j}, {int(other) for other in groups[model[i]]}
        for block in [
            block for block in blocks if block[1] & rivals or any(test[other] == test[j] for other in block[0])
        ]:
            blocks.remove(block)
            members, rivals = members | block[0], rivals | block[1]
        blocks.append((members, rivals))
    return [(np.array(sorted(members)), np.array(sorted(rivals))) for members, rivals in blocks]


def _distinguished(mac: FloatArray, shared: FloatArray) -> IntArray | None:
    """Return each measured mode's (column's) model mode (row) where single MACs are most of the shared ones."""
    from scipy.optimize import linear_sum_assignment

    if mac.shape == (1, 1):
        return np.zeros(1, dtype=np.int64)
    columns, rows = linear_sum_assignment(mac.T, maximize=True)
    return rows if (mac[rows, columns] >= _CLEAR_MAC_SHARE * shared[rows, columns]).all() else None


def _in_order(distance: FloatArray) -> IntArray:
    """Return the model modes (rows) nearest in frequency to the measured ones (columns), in ascending order."""
    from scipy.optimize import linear_sum_assignment

    _, rows = linear_sum_assignment(distance.T)
    return np.sort(rows)


def _company(groups: tuple[IntArray, ...], member: int) -> tuple[int, ...]:
    group = next(group for group in groups if member in group)
    return tuple(int(other) for other in group) if len(group) > 1 else ()
