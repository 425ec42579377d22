"""The search: known minima within limits, discrete values, a published Pareto front, and what ends it."""

import sys

import numpy as np
import pytest

from gearwhine.failures import MissingExtraError
from gearwhine.optimisation.search import Space, Trials, _are_far, balanced, pareto_front, search, tried_whole


def _none(points: np.ndarray) -> np.ndarray:
    return np.zeros((len(points), 0))


def _searched(find, counts=(0, 0), budget=100, aims=1, seed=1, start=None) -> tuple[Trials, str]:
    trials = Trials(Space(counts), find, budget)
    return trials, search(trials, start, seed, aims)


def test_the_minimum_in_a_disc_is_that_of_the_closed_form() -> None:
    """The point of the unit disc that is nearest to (2, 1): on its edge, with a distance of √5 - 1."""

    def find(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x, y = (4.0 * points - 2.0).T
        return ((x - 2.0) ** 2 + (y - 1.0) ** 2)[:, None], (x**2 + y**2 - 1.0)[:, None]

    trials, _ = _searched(find, budget=80)
    best = trials.ranked()[0]
    assert trials.excess(best) == 0.0
    assert 4.0 * trials.points[best] - 2.0 == pytest.approx(np.array([2.0, 1.0]) / np.sqrt(5.0), abs=2e-3)
    assert trials.aims[best][0] == pytest.approx((np.sqrt(5.0) - 1.0) ** 2, rel=1e-4)
    assert len(trials.points) <= 80


def test_a_second_valley_that_is_deeper_is_found() -> None:
    """Two wells in one dimension: the wide one at 0.2 is no deeper than -1, the narrow one at 0.85 is -1.5 deep."""

    def find(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x, y = points.T
        wells = -np.exp(-(((x - 0.2) / 0.2) ** 2)) - 1.5 * np.exp(-(((x - 0.85) / 0.08) ** 2))
        return (wells + (y - 0.5) ** 2)[:, None], _none(points)

    trials, _ = _searched(find)
    best = trials.points[trials.ranked()[0]]
    assert best == pytest.approx([0.85, 0.5], abs=0.01)


def test_discrete_values_go_with_continuous_ones_and_failures_are_passed_over() -> None:
    values = np.array([1.0, 2.0, 3.5, 7.0])

    def find(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        chosen = values[np.floor(4.0 * points[:, 1]).astype(int)]
        aim = (points[:, 0] - 0.3) ** 2 + (chosen - 3.0) ** 2 + 0.5 * (points[:, 2] - 0.8) ** 2
        return np.where(points[:, 0] > 0.9, np.nan, aim)[:, None], _none(points)

    trials, _ = _searched(find, counts=(0, 4, 0), budget=90)
    best = trials.ranked()[0]
    assert values[int(4.0 * trials.points[best][1])] == 3.5
    assert trials.points[best][[0, 2]] == pytest.approx([0.3, 0.8], abs=2e-3)
    assert any(not np.isfinite(aim[0]) for aim in trials.aims)
    places = 4.0 * np.array(trials.points)[:, 1] - 0.5
    assert np.array_equal(places, np.round(places))


def test_few_combinations_are_all_tried_and_each_once() -> None:
    found = list[np.ndarray]()

    def find(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found.extend(points)
        return np.sum((points - 0.6) ** 2, axis=1)[:, None], _none(points)

    trials, ended = _searched(find, counts=(3, 4), budget=12)
    assert ended == "complete"
    assert len(found) == 12
    assert {tuple(np.round(row * [3, 4] - 0.5).astype(int)) for row in found} == {
        (a, b) for a in range(3) for b in range(4)
    }
    # One more than may be tried is searched.
    assert _searched(find, counts=(3, 4), budget=11)[1] != "complete"
    assert trials.points[trials.ranked()[0]] == pytest.approx([0.5, 0.625])


def test_a_grid_has_the_levels_of_ranges_and_the_values_of_lists() -> None:
    trials = Trials(Space((0, 2)), lambda points: (points[:, :1], _none(points)), 6)
    assert tried_whole(trials, [3, 9]) == "complete"
    expected = [[0.0, 0.25], [0.0, 0.75], [0.5, 0.25], [0.5, 0.75], [1.0, 0.25], [1.0, 0.75]]
    assert np.array(trials.points).tolist() == expected


def test_the_budget_holds_and_the_same_seed_gives_the_same_points() -> None:
    def find(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.sum(np.cos(9.0 * points), axis=1)[:, None], _none(points)

    first, ended = _searched(find, budget=37)
    assert (ended, len(first.points)) == ("budget", 37)
    assert np.array_equal(first.points, _searched(find, budget=37)[0].points)
    assert not np.array_equal(first.points, _searched(find, budget=37, seed=2)[0].points)
    start = np.array([0.123, 0.456])
    assert np.array_equal(_searched(find, budget=37, start=start)[0].points[0], start)


def test_where_nothing_is_within_the_limits_the_nearest_point_is_the_least_excess() -> None:
    """x ≤ 0.2 and x ≥ 0.6 exclude each other; from 0.2 to 0.6 the sum of the excesses is 0.4."""

    def find(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x = points[:, 0]
        return x[:, None] ** 2, np.stack([x - 0.2, 0.6 - x], axis=1)

    trials, _ = _searched(find, budget=60)
    best = trials.ranked()[0]
    assert trials.excess(best) == pytest.approx(0.4)
    assert 0.2 <= trials.points[best][0] <= 0.6


def test_the_front_of_binh_and_korn_is_that_of_its_closed_form() -> None:
    """Binh and Korn (1997), unscaled: the front is x = y from 0 to 3, then y = 3 with x from 3 to 5."""
    pytest.importorskip("pymoo")

    def find(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x, y = 5.0 * points[:, 0], 3.0 * points[:, 1]
        aims = np.stack([4.0 * x**2 + 4.0 * y**2, (x - 5.0) ** 2 + (y - 5.0) ** 2], axis=1)
        return aims, np.stack([(x - 5.0) ** 2 + y**2 - 25.0, 7.7 - (x - 8.0) ** 2 - (y + 3.0) ** 2], axis=1)

    trials, ended = _searched(find, budget=400, aims=2)
    assert (ended, len(trials.points)) == ("budget", 400)
    within = [number for number in range(400) if trials.excess(number) == 0.0]
    assert len(within) < 400
    aims = np.array([trials.aims[number] for number in within])
    front = aims[pareto_front(aims)]
    assert len(front) > 40
    along = np.linspace(0.0, 1.0, 4001)
    x = np.concatenate([3.0 * along, 3.0 + 2.0 * along])
    y = np.concatenate([3.0 * along, np.full(4001, 3.0)])
    exact = np.stack([4.0 * x**2 + 4.0 * y**2, (x - 5.0) ** 2 + (y - 5.0) ** 2], axis=1)
    ranges = np.array([136.0, 46.0])
    assert exact.max(axis=0) - exact.min(axis=0) == pytest.approx(ranges)
    distances = np.min(np.linalg.norm((front[:, None] - exact[None]) / ranges, axis=2), axis=1)
    assert np.mean(distances) < 0.01
    # No part of the exact front is far from the front that was found.
    gaps = np.min(np.linalg.norm((exact[:, None] - front[None]) / ranges, axis=2), axis=1)
    assert gaps.max() < 0.12
    assert np.array_equal(trials.points, _searched(find, budget=400, aims=2)[0].points)


def test_several_aims_without_their_library_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gearwhine.optimisation.search.find_spec", lambda name: None)
    monkeypatch.setitem(sys.modules, "pymoo", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'gearwhine\[optimise\]'; or give each aim a weight"):
        _searched(lambda points: (points, _none(points)), aims=2)


def test_the_front_keeps_what_nothing_beats_and_the_balanced_point_is_nearest_to_the_best_of_all() -> None:
    aims = np.array([[1.0, 5.0], [2.0, 2.0], [5.0, 1.0], [2.0, 3.0], [1.0, 5.0], [6.0, 6.0]])
    assert pareto_front(aims) == [0, 1, 2]
    assert balanced(aims[[0, 1, 2]]) == 1
    assert pareto_front(np.array([[3.0], [1.0], [2.0], [1.0]])) == [1]


def test_starts_are_far_apart_in_what_is_continuous_or_another_choice() -> None:
    continuous = np.array([True, False, True])
    point = np.array([0.5, 0.25, 0.75])
    for step, far in (
        ((0.0, 0.0, 0.0), False),
        ((0.5, 0.0, 0.5), True),
        ((0.0, -0.25, 0.0), True),
        ((1e-3, 0.0, 0.0), False),
    ):
        assert _are_far(point, point + step, continuous) is far
        assert _are_far(point + step, point, continuous) is far
