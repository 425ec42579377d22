"""Sensors by effective independence, places for the hammer, and candidates spread over the surface."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from gearwhine.housing import HousingError
from gearwhine.housing.measured import candidate_points, map_survey, plan_survey, planned_geometry
from gearwhine.meshes import Mesh


def beam(modes: int, places: int) -> np.ndarray:
    """A simply supported beam: φ_r = sin rπx at inner places."""
    x = np.arange(1, places + 1) / (places + 1)
    return np.sin(np.pi * np.outer(np.arange(1, modes + 1), x))


def test_as_many_sensors_as_modes_are_each_indispensable() -> None:
    """With n sensors for n modes the projector is the identity: every share is 1."""
    plan = plan_survey(beam(4, 30), 4)
    np.testing.assert_allclose(plan.independence, np.ones(4), atol=1e-12)
    assert len(set(plan.sensors.tolist())) == 4


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10_000), modes=st.integers(1, 5), extra=st.integers(0, 8))
def test_shares_sum_to_the_number_of_modes(seed: int, modes: int, extra: int) -> None:
    """The trace of a projector is its rank; no scale of a mode changes anything."""
    rng = np.random.default_rng(seed)
    shapes = rng.normal(size=(modes, 20))
    plan = plan_survey(shapes, modes + extra)
    assert plan.independence.sum() == pytest.approx(modes)
    assert ((plan.independence > 0.0) & (plan.independence < 1.0 + 1e-9)).all()
    scaled = plan_survey(shapes * rng.uniform(0.1, 10.0, (modes, 1)), modes + extra)
    np.testing.assert_array_equal(np.sort(scaled.sensors), np.sort(plan.sensors))
    np.testing.assert_allclose(np.diag(plan.auto_mac), 1.0)


def test_a_candidate_left_out_costs_its_share_of_the_determinant() -> None:
    """Kammer: det after / det before = 1 - E_i, so leaving out the least costs least: here against trying all."""
    shapes = np.random.default_rng(4).normal(size=(3, 9))
    plan = plan_survey(shapes, 8)
    left_out = (set(range(9)) - set(plan.sensors.tolist())).pop()
    determinants = [np.linalg.det(np.delete(shapes, one, 1) @ np.delete(shapes, one, 1).T) for one in range(9)]
    assert left_out == int(np.argmax(determinants))


def test_the_choice_is_nearly_the_best_of_all() -> None:
    """Against all 4845 choices of 4 sensors from 20: within a factor of 2 of the largest determinant."""
    shapes = beam(4, 20)
    plan = plan_survey(shapes, 4)
    chosen = np.linalg.det(shapes[:, plan.sensors]) ** 2
    best = max(np.linalg.det(shapes[:, list(choice)]) ** 2 for choice in combinations(range(20), 4))
    assert chosen > best / 2.0


def test_the_hammer_misses_no_mode() -> None:
    """Of a beam's first three modes: the nodes of 2 and 3 are at 1/2 and 1/3, 2/3; min of squares over the modes."""
    shapes = beam(3, 59)
    plan = plan_survey(shapes, 6)
    x = np.arange(1, 60) / 60.0
    least = (np.sin(np.pi * np.outer([1, 2, 3], x)) ** 2).min(axis=0)
    assert least[plan.driving_points[0]] == pytest.approx(least.max())
    assert np.all(np.diff(plan.residues) >= 0.0)
    # With a second place each mode has the better of two.
    assert plan.residues[1] > 1.5 * plan.residues[0]


def test_modes_that_look_alike_and_wrong_counts_are_refused() -> None:
    shapes = beam(3, 20)
    with pytest.raises(HousingError, match="2 sensors for 3 modes"):
        plan_survey(shapes, 2)
    with pytest.raises(HousingError, match="look alike at all 20"):
        plan_survey(np.vstack([shapes, 2.0 * shapes[:1]]), 6)


def test_candidates_are_spread_over_the_outside(box: Mesh) -> None:
    candidates = candidate_points(box, 100, without=box.surface("front-seat"))
    mapped = map_survey(box, candidates)
    assert mapped.distances.max() < 1e-9
    np.testing.assert_allclose(np.einsum("pi,pi->p", mapped.normals, candidates.directions), 1.0, atol=0.05)
    gaps = cKDTree(candidates.positions).query(candidates.positions, k=2)[0][:, 1]
    assert gaps.min() > 0.4 * gaps.max()
    seat = np.hypot(candidates.positions[:, 0] + 0.03, candidates.positions[:, 1] - 0.08)
    inside = (candidates.positions[:, 2] > 0.1) & (seat < 0.0249)
    assert not inside.any()


def test_the_plan_is_a_survey_of_its_own(box: Mesh) -> None:
    candidates = candidate_points(box, 60)
    survey = planned_geometry(candidates, np.array([5, 3, 40]))
    assert survey.labels == ("1", "2", "3")
    np.testing.assert_array_equal(survey.positions, candidates.positions[[5, 3, 40]])
    assert set(survey.lines) == {(0, 1), (0, 2), (1, 2)}
    with pytest.raises(HousingError, match="candidates for sensors"):
        candidate_points(box, 10**6)
