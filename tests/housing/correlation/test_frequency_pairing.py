"""Pairs of frequencies in their order: the assignment of least squares against all there are; chance; odd lists."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwhine.housing import HousingError, compare_by_frequency
from gearwhine.housing.correlation.pairing import nearest_in_order

FREQUENCIES = st.lists(st.floats(100.0, 1000.0), min_size=1, max_size=7).map(sorted).map(np.array)


@settings(max_examples=80, deadline=None)
@given(FREQUENCIES, FREQUENCIES)
def test_no_other_monotone_assignment_has_less_squared_error(model: np.ndarray, measured: np.ndarray) -> None:
    pairs = nearest_in_order(model, measured)
    count = min(len(model), len(measured))
    assert len(pairs) == count
    assert (np.diff(pairs, axis=0) > 0).all()
    cost = float((np.log(model[pairs[:, 0]] / measured[pairs[:, 1]]) ** 2).sum())
    least = min(
        float((np.log(model[list(rows)] / measured[list(columns)]) ** 2).sum())
        for rows in combinations(range(len(model)), count)
        for columns in combinations(range(len(measured)), count)
    )
    assert cost == pytest.approx(least, abs=1e-12)


def test_model_modes_are_left_out_and_named() -> None:
    comparison = compare_by_frequency(np.array([98.0, 310.0]), np.array([0.0, 100.0, 200.0, 300.0, 400.0]))
    assert [(pair.measured_mode, pair.mode) for pair in comparison.pairs] == [(1, 2), (2, 4)]  # none with rigid motion
    assert [(mode.number, mode.frequency) for mode in comparison.unpaired_model] == [(2, 100.0), (3, 200.0)][1:]
    assert comparison.unpaired_measured == ()
    assert (comparison.gap, comparison.measures_agree) == (None, None)


def test_consecutive_modes_are_paired_the_first_with_the_first() -> None:
    measured, model = np.array([100.0, 200.0, 290.0]), np.array([104.0, 190.0, 298.0, 299.0, 302.0])
    comparison = compare_by_frequency(measured, model, "order")
    assert [pair.mode for pair in comparison.pairs] == [1, 2, 3]
    assert [pair.error_percent for pair in comparison.pairs] == pytest.approx([4.0, -5.0, 100 * (298 / 290 - 1)])
    assert comparison.chance_error_percent is None


@pytest.mark.parametrize(("pairing", "alone"), [("order", [3, 4]), ("nearest", [1, 3])])
def test_measured_modes_beyond_those_of_the_model_are_named(pairing: str, alone: list[int]) -> None:
    comparison = compare_by_frequency(np.array([50.0, 100.0, 150.0, 200.0]), np.array([101.0, 205.0]), pairing)
    assert [mode.number for mode in comparison.unpaired_measured] == alone
    assert len(comparison.pairs) == 2


def test_the_error_of_chance_is_that_of_frequencies_drawn_at_random() -> None:
    model = np.array([0.0, 80.0, 130.0, 131.0, 190.0, 500.0])
    comparison = compare_by_frequency(np.array([100.0, 200.0]), model)
    low, high = comparison.band
    drawn = np.exp(np.random.default_rng(1).uniform(np.log(low), np.log(high), 200_000))
    nearest = np.abs(np.log(drawn[:, None] / model[1:])).min(axis=1)
    assert comparison.chance_error_percent == pytest.approx(100.0 * np.sqrt(np.mean(nearest**2)), rel=0.01)


def test_one_measured_frequency_has_the_nearest_mode() -> None:
    (pair,) = compare_by_frequency(np.array([205.0]), np.array([100.0, 200.0, 300.0])).pairs
    assert pair.mode == 2


@pytest.mark.parametrize(
    ("measured", "model"), [([], [1.0]), ([2.0, 1.0], [1.0]), ([0.0, 1.0], [1.0]), ([1.0], []), ([1.0], [0.0])]
)
def test_lists_that_cannot_be_paired_are_refused(measured: list[float], model: list[float]) -> None:
    with pytest.raises(HousingError):
        compare_by_frequency(np.array(measured), np.array(model))
