"""Modes paired from speed to speed, the table of their branches, and crossings, on cases with known answers."""

import numpy as np
import pytest

from gearwhine.numerics.branch_following import BranchPoint, extended_branches, paired_modes, refined_crossing

SETTINGS = {"jump_scale": 0.1, "most_jumps": 100.0, "longest_jump": 0.5}


def test_modes_that_cross_keep_their_shapes_and_modes_that_veer_their_order() -> None:
    # Equally near in frequency: the shape decides.
    near = np.array([[0.01, 0.01], [0.01, 0.01]])
    assert paired_modes(near, np.array([[0.1, 0.9], [0.9, 0.1]]), **SETTINGS).tolist() == [1, 0]
    # Alike in shape: the frequency decides.
    apart = np.array([[0.01, 0.05], [0.05, 0.01]])
    assert paired_modes(apart, np.full((2, 2), 0.5), **SETTINGS).tolist() == [0, 1]


def test_a_pair_too_far_apart_is_none_unless_its_shape_is_sure() -> None:
    jump, likeness = np.array([[0.6]]), np.array([[0.95]])
    assert paired_modes(jump, likeness, **SETTINGS).tolist() == [-1]
    assert paired_modes(jump, likeness, **SETTINGS, sure_likeness=0.9).tolist() == [0]
    # Beyond the cap all jumps weigh the same, and the likeness decides.
    far = np.array([[30.0, 20.0], [20.0, 30.0]])
    assert paired_modes(far, np.eye(2), **SETTINGS, sure_likeness=0.9).tolist() == [0, 1]


@pytest.mark.parametrize(("before", "after"), [(0, 2), (2, 0), (3, 1), (1, 3)])
def test_each_mode_has_one_partner_at_most(before: int, after: int) -> None:
    partner = paired_modes(np.zeros((before, after)), np.ones((before, after)), **SETTINGS)
    assert partner.shape == (before,)
    assert sorted(partner[partner >= 0]) == list(range(min(before, after)))


def test_branches_begin_and_end() -> None:
    table = np.zeros((0, 0), dtype=np.intp)
    table = extended_branches(table, np.zeros(0, dtype=np.intp), 2)
    # The first mode ends, the second becomes the last of three, and two begin.
    table = extended_branches(table, np.array([-1, 2]), 3)
    table = extended_branches(table, np.array([1, -1, 0]), 2)
    assert table.tolist() == [[0, 1, -1, -1], [-1, 2, 0, 1], [-1, 0, 1, -1]]


def test_no_modes_at_all_leave_no_branches() -> None:
    table = extended_branches(np.zeros((0, 0), dtype=np.intp), np.zeros(0, dtype=np.intp), 0)
    table = extended_branches(table, np.zeros(0, dtype=np.intp), 0)
    assert table.shape == (2, 0)


def branch_point(speed: float) -> BranchPoint[None]:
    """A mode whose frequency falls as 10 − Ω² / 5: the first order meets it at Ω = (√225 − 5) / 2 = 5."""
    frequency = 10.0 - 0.2 * speed**2
    return BranchPoint(speed, -0.1 + 1j * frequency, frequency - speed, None)


def between(part: float, low: BranchPoint[None], high: BranchPoint[None]) -> BranchPoint[None]:
    return branch_point(low.speed + part * (high.speed - low.speed))


@pytest.mark.parametrize(("low", "high"), [(0.0, 6.0), (-4.0, 40.0)])
def test_a_crossing_is_found_to_its_tolerance(low: float, high: float) -> None:
    found = refined_crossing(branch_point(low), branch_point(high), between, tolerance=1e-13, steps=60)
    assert found is not None
    assert found.speed == pytest.approx(5.0, rel=1e-12)
    assert found.eigenvalue == pytest.approx(-0.1 + 5.0j, rel=1e-12)


def test_a_crossing_that_is_lost_or_needs_more_steps_is_none() -> None:
    ends = branch_point(0.0), branch_point(6.0)
    assert refined_crossing(*ends, lambda *_: None, tolerance=1e-12, steps=60) is None
    assert refined_crossing(*ends, between, tolerance=1e-12, steps=2) is None
