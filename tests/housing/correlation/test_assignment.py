"""The best assignment and its margin, against all assignments there are."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gearwhine.housing.correlation.pairing import best_assignment, margin

SCORES = arrays(
    np.float64, st.tuples(st.integers(1, 4), st.integers(1, 4)), elements=st.floats(0.0, 1.0).map(lambda x: round(x, 3))
)


def _all(scores: np.ndarray) -> list[set[tuple[int, int]]]:
    """Every assignment of rows to columns, with pairs that score nothing left out."""
    rows, columns = scores.shape
    ways = permutations([*range(columns), *[-1] * rows], rows)
    return [{(i, j) for i, j in enumerate(way) if j >= 0 and scores[i, j] > 0.0} for way in set(ways)]


def _sum(scores: np.ndarray, pairs: set[tuple[int, int]] | list[tuple[int, int]]) -> float:
    return float(sum(scores[i, j] for i, j in pairs))


@settings(max_examples=60, deadline=None)
@given(SCORES)
def test_no_other_assignment_scores_more(scores: np.ndarray) -> None:
    chosen = best_assignment(scores)
    assert len({i for i, _ in chosen}) == len({j for _, j in chosen}) == len(chosen)
    assert _sum(scores, chosen) == pytest.approx(max(_sum(scores, way) for way in _all(scores)))


@settings(max_examples=60, deadline=None)
@given(SCORES)
def test_the_margin_is_what_is_lost_without_the_pair(scores: np.ndarray) -> None:
    for i, j in best_assignment(scores):
        only = np.arange(scores.shape[1]) == j
        rest = [_sum(scores, way) for way in _all(scores) if (i, j) not in way]
        held = max(_sum(scores, way) for way in _all(scores) if (i, j) in way)
        expected = max(held - max(rest), 0.0) / scores[i, j]
        assert margin(scores, i, only) == pytest.approx(expected, abs=1e-9)
        assert 0.0 <= margin(scores, i, only) <= 1.0


def test_margins_by_hand() -> None:
    assert margin(np.array([[0.9]]), 0, np.array([True])) == 1.0
    assert margin(np.array([[0.9, 0.6]]), 0, np.array([True, False])) == pytest.approx(1.0 / 3.0)
    assert margin(np.array([[0.9, 0.9]]), 0, np.array([True, False])) == pytest.approx(0.0)
    # Columns that are as good as one count together.
    assert margin(np.array([[0.9, 0.9]]), 0, np.array([True, True])) == 1.0
