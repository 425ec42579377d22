"""Close modes as spaces: planes at known angles, and double modes mixed in any way."""

import numpy as np
import pytest

from gearwhine.housing import HousingError
from gearwhine.housing.correlation import modal_assurance_criterion, principal_angles, span_mac
from gearwhine.housing.correlation.subspaces import close_modes, nearest_in_span

RANDOM = np.random.default_rng(3)


def test_groups_of_close_modes() -> None:
    groups = close_modes([0.0, 0.0, 100.0, 100.9, 101.8, 103.0, 200.0], 0.01)
    assert [list(group) for group in groups] == [[0, 1], [2, 3, 4], [5], [6]]
    assert [list(group) for group in close_modes([1.0, 1.0, 1.1], 0.0)] == [[0, 1], [2]]
    assert close_modes([], 0.1)[0].size == 0


@pytest.mark.parametrize("angle", [0.0, 1e-7, 0.5, np.pi / 2])
def test_planes_at_a_known_angle(angle: float) -> None:
    """Planes that share the first axis and open by the angle about it."""
    flat = np.array([[1.0, 0, 0, 0], [0, 1.0, 0, 0]])
    open_ = np.array([[1.0, 0, 0, 0], [0, np.cos(angle), np.sin(angle), 0]])
    mixed = np.array([[1.0, 2.0], [-0.3j, 1.0]]) @ open_
    assert principal_angles(flat, mixed) == pytest.approx([angle, 0.0], abs=1e-7)
    assert span_mac(flat, open_) == pytest.approx([1.0, np.cos(angle) ** 2], abs=1e-15)


def test_a_double_mode_mixed_in_any_way_is_the_same() -> None:
    pair = RANDOM.normal(size=(2, 10))
    mixed = np.array([[1.0, 1.0j], [0.8, -1.0 - 0.5j]]) @ pair
    assert 0.05 < modal_assurance_criterion(pair, mixed).max() < 0.95
    assert span_mac(pair, mixed) == pytest.approx([1.0, 1.0])
    assert nearest_in_span(pair, mixed) == pytest.approx(mixed)
    assert principal_angles(pair, mixed) == pytest.approx([0.0, 0.0], abs=1e-7)


def test_the_span_has_the_largest_mac_of_all_its_members() -> None:
    basis, shape = RANDOM.normal(size=(2, 9)), RANDOM.normal(size=9)
    angles = np.linspace(0.0, np.pi, 20001)
    unit = np.linalg.qr(basis.T)[0].T
    tried = modal_assurance_criterion(np.column_stack([np.cos(angles), np.sin(angles)]) @ unit, shape)
    assert span_mac(basis, shape)[0] == pytest.approx(tried.max(), rel=1e-7)
    assert modal_assurance_criterion(nearest_in_span(basis, shape), shape)[0, 0] == pytest.approx(tried.max(), rel=1e-7)


def test_gaps_leave_out_their_degrees_of_freedom() -> None:
    basis, shape = RANDOM.normal(size=(2, 9)), RANDOM.normal(size=9) + 0j
    shape[4] = np.nan
    assert span_mac(basis, shape) == pytest.approx(span_mac(np.delete(basis, 4, axis=1), np.delete(shape, 4)))
    combined = np.array([2.0, -1.0]) @ basis + 0j
    expected = combined.copy()
    combined[[0, 7]] = np.nan
    assert nearest_in_span(basis, combined)[0] == pytest.approx(expected)  # expanded to where it was not measured


def test_spans_that_say_nothing_are_refused() -> None:
    with pytest.raises(HousingError, match="2 shapes over the 2 degrees of freedom of shape 1 is like anything"):
        span_mac(np.eye(2), np.ones(2))
    with pytest.raises(HousingError, match="3 shapes share 2 degrees of freedom"):
        principal_angles(np.ones((3, 2)), np.ones((1, 2)))
    with pytest.raises(HousingError, match="must ascend"):
        close_modes([2.0, 1.0], 0.1)
    with pytest.raises(HousingError, match="a closeness of 1"):
        close_modes([1.0], 1.0)
