"""Which modes stand for the measured ones: against trying every choice, and closed forms of small ones."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

from gearwhine.housing.modes.dominance import Dominance
from gearwhine.housing.updating import Target, measure
from gearwhine.housing.updating.mode_choice import GAP_SCALE, choice_shortfall, choose_modes
from gearwhine.housing.updating.surrogate import ModalState
from gearwhine.numerics.arrays import FloatArray

BAND = (90.0, 1000.0)
WIDE = (1.0, 1e9)  # so wide that no mode is left for being near its end


def dominance(frequencies: FloatArray, logarithms: FloatArray) -> Dominance:
    acceleration, velocity, absolute = np.exp(logarithms)
    return Dominance(acceleration, velocity, absolute, frequencies)


def cost_by_hand(strengths: Dominance, chosen: tuple[int, ...], gap: float, margin: float) -> float:
    """The sum of squares of the definition for modes far inside the band, thresholds by scalar minimisation."""
    total = 0.0
    measures = (strengths.acceleration, strengths.velocity, strengths.absolute)
    for row, asked in zip(np.log(measures), (gap, margin, margin), strict=True):
        taken = np.isin(np.arange(len(row)), chosen)

        def squares(threshold: float, row: FloatArray = row, taken: object = taken, asked: float = asked) -> float:
            lacks = np.where(taken, threshold - row, row - threshold) + 0.5 * asked
            return float((np.maximum(lacks, 0.0) ** 2).sum() / (GAP_SCALE**2 / 2.0))

        low, high = row.min() - asked, row.max() + asked
        total += float(minimize_scalar(squares, bounds=(low, high), method="bounded", options={"xatol": 1e-12}).fun)
    return total


@pytest.mark.slow
@given(st.integers(0, 2**32 - 1))
@settings(max_examples=25, deadline=None)
def test_no_choice_costs_less_by_much(seed: int) -> None:
    """Of all choices of 3 among 8, tried one by one. Turns may end beside the least, but never far above it."""
    generator = np.random.default_rng(seed)
    frequencies = np.sort(generator.uniform(100.0, 800.0, 8))
    strengths = dominance(frequencies, generator.normal(scale=0.1, size=(3, 8)))
    measured = np.sort(generator.uniform(100.0, 800.0, 3))
    noise = np.full(3, 0.05)

    def cost(chosen: tuple[int, ...]) -> float:
        errors = np.log(frequencies[list(chosen)] / measured) / noise
        return float(errors @ errors) + cost_by_hand(strengths, chosen, 0.1, 0.03)

    found = tuple(choose_modes(np.log(measured), noise, strengths, WIDE, 0.1, 0.03).tolist())
    costs = sorted(cost(chosen) for chosen in combinations(range(8), 3))
    assert cost(found) <= costs[2] + 1e-6
    assert cost(found) <= 1.2 * costs[0] + 5.0


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.3), st.floats(0.0, 0.3))
@settings(max_examples=25, deadline=None)
def test_what_a_choice_lacks_is_the_sum_of_its_definition(seed: int, gap: float, margin: float) -> None:
    generator = np.random.default_rng(seed)
    strengths = dominance(np.linspace(100.0, 800.0, 9), generator.normal(scale=0.2, size=(3, 9)))
    chosen = np.sort(generator.choice(9, 4, replace=False))
    by_hand = cost_by_hand(strengths, tuple(chosen), gap, margin)
    assert choice_shortfall(chosen, strengths, WIDE, gap, margin).cost == pytest.approx(by_hand, rel=1e-6, abs=1e-6)


def test_a_clear_choice_lacks_nothing_and_one_pair_lacks_what_it_lacks() -> None:
    logarithms = np.array([1.0, 0.0, 0.3])[None] * np.ones((3, 1))
    strengths = dominance(np.array([100.0, 200.0, 300.0]), logarithms)
    assert choice_shortfall(np.array([0, 2]), strengths, BAND, 0.3, 0.3).cost == pytest.approx(0.0, abs=1e-20)
    # One measure, one pair, 0.02 too near each other: as an error of one σ, half of it on either side.
    alone = choice_shortfall(np.array([0, 2]), strengths, BAND, 0.32)
    assert alone.cost == pytest.approx(1.0)
    assert sorted(zip(alone.modes.tolist(), alone.sign.tolist(), strict=True)) == [(1, 1.0), (2, -1.0)]
    assert alone.values == pytest.approx(np.sqrt([0.5, 0.5]))
    assert choice_shortfall(np.array([0, 2]), strengths, BAND, 0.32, firmness=3.0).cost == pytest.approx(9.0)


def test_a_strong_mode_beyond_the_band_costs_what_it_lacks_to_be_clearly_beyond() -> None:
    def strengths(last: float) -> Dominance:
        return dominance(np.array([100.0, 200.0, last]), np.array([0.0, -1.0, 2.0])[None] * np.ones((3, 1)))

    for beyond, cost in ((0.0, 4.0), (0.005, 1.0), (0.01, 0.0), (0.2, 0.0)):
        just = choice_shortfall(np.array([0]), strengths(1000.0 * np.exp(beyond + 1e-12)), BAND, 0.1, 0.1)
        assert just.cost == pytest.approx(cost, abs=1e-6)
    inside = choice_shortfall(np.array([0]), strengths(1000.0 * np.exp(-0.005)), BAND, 0.1, 0.1)
    assert inside.cost == pytest.approx(9.0)  # nearer to the end than to being weak


def test_the_misfit_has_no_step_where_modes_exchange_their_places() -> None:
    """The 2nd and 3rd strongest exchange: judged strictly the error jumps by 30 %, the search's misfit does not."""
    target = Target(np.array([100.0, 200.0]), np.full(2, 0.01), (50.0, 500.0), gap=0.1, margin=0.03)

    def state(excess: float) -> ModalState:
        strengths = np.sqrt(np.array([2.0, 1.0, np.exp(excess)]))
        seats = np.stack([strengths, 0.0 * strengths], axis=1)[:, None]
        return ModalState(np.array([100.0, 200.0, 260.0]), seats, strengths[:, None])

    z, ways = np.zeros(1), np.linspace(-0.6, 0.6, 601)
    values = np.array([measure(target, state(excess), z).value for excess in ways])
    strict = np.array([measure(target, state(excess), z, strict=True).value for excess in ways])
    assert np.abs(np.diff(strict)).max() > 500.0
    assert np.abs(np.diff(values)).max() < 30.0  # a slope, of squares of gaps over 0.02
    assert measure(target, state(-0.6), z).value == pytest.approx(0.0, abs=1e-12)
    before = measure(target, state(0.05), z)
    assert before.pairs.tolist() == [0, 1]
    assert not before.measures_agree
    assert before.gap < 0.0
    assert measure(target, state(0.05), z, strict=True).pairs.tolist() == [0, 2]


def test_measures_that_are_not_asked_for_take_no_part() -> None:
    strengths = dominance(np.array([100.0, 200.0]), np.array([[0.0, 1.0], [5.0, 0.0], [5.0, 0.0]]))
    assert choice_shortfall(np.array([1]), strengths, BAND, 0.5).cost == 0.0
    assert choice_shortfall(np.array([1]), strengths, BAND, 0.5, 0.1).cost > 100.0
    assert choose_modes(np.log([190.0]), np.array([0.01]), strengths, BAND, 0.5).tolist() == [1]
    assert choose_modes(np.log([105.0]), np.array([10.0]), strengths, BAND, 0.5).tolist() == [1]
