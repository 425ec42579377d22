"""Cross-orthogonality in the SEREP-reduced mass, on a chain of unequal masses whose matrices are known."""

import numpy as np
import pytest
from scipy import linalg

from gearwhine.housing import HousingError
from gearwhine.housing.correlation import (
    cross_orthogonality,
    modal_assurance_criterion,
    outside_span,
)
from gearwhine.housing.correlation.orthogonality import modal_coordinates

COUNT = 12
RANDOM = np.random.default_rng(11)
MASS = np.diag(RANDOM.uniform(0.5, 3.0, COUNT))
_SPRINGS = RANDOM.uniform(1e3, 4e3, COUNT + 1)
STIFFNESS = np.diag(_SPRINGS[:-1] + _SPRINGS[1:]) - np.diag(_SPRINGS[1:-1], 1) - np.diag(_SPRINGS[1:-1], -1)
SHAPES = linalg.eigh(STIFFNESS, MASS)[1].T  # mass-normalised
SURVEY = [0, 2, 5, 6, 8, 9, 11]
KEPT = SHAPES[:5, SURVEY]


def serep_mass(shapes: np.ndarray) -> np.ndarray:
    """SEREP mass (Φ⁺)ᵀ Φ⁺ at the degrees of freedom of the shapes [kg]."""
    inverse = np.linalg.pinv(shapes.T)
    return np.asarray(inverse.T @ inverse)


def test_all_modes_at_all_degrees_of_freedom_give_the_mass_itself() -> None:
    assert serep_mass(SHAPES) == pytest.approx(MASS, abs=1e-12)


def test_the_reduced_mass_normalises_the_modes_it_was_made_for() -> None:
    assert KEPT @ serep_mass(KEPT) @ KEPT.T == pytest.approx(np.eye(5), abs=1e-12)
    assert cross_orthogonality(KEPT, KEPT) == pytest.approx(np.eye(5), abs=1e-12)


def test_the_mass_tells_apart_what_the_mac_does_not() -> None:
    """A test mode of 0.6 and 0.8 of modes 2 and 3 holds these parts of them, to any scale; the MAC says otherwise."""
    mixed = 7j * (0.6 * KEPT[1] - 0.8 * KEPT[2])
    parts = cross_orthogonality(KEPT, mixed)[:, 0]
    assert parts == pytest.approx(np.array([0.0, 0.6, 0.8, 0.0, 0.0]), abs=1e-12)
    assert np.abs(np.sqrt(modal_assurance_criterion(KEPT, mixed)[:, 0]) - parts).max() > 0.05
    assert modal_coordinates(KEPT, mixed)[:, 0] == pytest.approx(np.array([0.0, 4.2j, -5.6j, 0.0, 0.0]), abs=1e-12)


def test_it_is_that_of_the_formed_matrix() -> None:
    test = RANDOM.normal(size=(3, len(SURVEY))) + 1j * RANDOM.normal(size=(3, len(SURVEY)))
    mass = serep_mass(KEPT)
    expected = np.abs(KEPT @ mass @ test.T) / np.sqrt(np.einsum("id,de,ie->i", test.conj(), mass, test).real)
    assert cross_orthogonality(KEPT, test) == pytest.approx(expected)


def test_shapes_are_taken_at_their_own_degrees_of_freedom() -> None:
    test = KEPT + 0j
    test[1, 0] = test[3, 4] = np.nan
    assert cross_orthogonality(KEPT, test) == pytest.approx(np.eye(5), abs=1e-12)
    assert outside_span(KEPT, test) == pytest.approx(np.zeros(5), abs=1e-20)


def test_what_lies_outside_the_modes_is_told() -> None:
    basis = linalg.null_space(KEPT)[:, 0]  # orthogonal to every kept shape, of norm 1
    inside = KEPT[0] / np.linalg.norm(KEPT[0])
    assert outside_span(KEPT, 0.8 * inside + 0.6j * basis) == pytest.approx(0.36)


def test_too_few_degrees_of_freedom_are_refused_in_words() -> None:
    with pytest.raises(HousingError, match="4 degrees of freedom for 5 model modes: SEREP needs at least as many"):
        modal_coordinates(KEPT[:, :4], KEPT[:, :4])
    test = KEPT + 0j
    test[2, :3] = np.nan
    with pytest.raises(HousingError, match="measured shape 3 has 4 degrees of freedom for 5 model modes"):
        cross_orthogonality(KEPT, test)


def test_modes_that_the_survey_cannot_tell_apart_are_refused() -> None:
    alike = np.vstack([KEPT, KEPT[0] + KEPT[1]])
    with pytest.raises(HousingError, match="cannot tell 6 model modes apart"):
        modal_coordinates(alike, alike)
