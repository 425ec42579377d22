"""Where paired shapes differ: a sensor turned round, one with a wrong gain, one that was missing."""

import numpy as np
import pytest

from gearwhine.housing import HousingError
from gearwhine.housing.correlation import comac, enhanced_comac

POINTS = 9
SHAPES = np.sin(np.pi * np.outer(np.arange(1, 5), np.arange(1, POINTS + 1)) / (POINTS + 1))
TEST = SHAPES * np.array([[2.0], [-1.0], [0.5j], [3.0 + 1.0j]])


def test_equal_sets_agree_everywhere() -> None:
    assert comac(SHAPES, TEST) == pytest.approx(np.ones(POINTS))
    assert enhanced_comac(SHAPES, TEST) == pytest.approx(np.zeros(POINTS), abs=1e-15)


def test_a_sensor_turned_round_escapes_comac_and_not_its_enhancement() -> None:
    """Its entry differs by twice itself, halved and meant over the pairs; at the others only the scale factor moves."""
    test = TEST.copy()
    test[:, 1] *= -1.0
    assert comac(SHAPES, test) == pytest.approx(np.ones(POINTS))
    unit = np.abs(SHAPES[:, 1]) / np.abs(SHAPES).max(axis=1)
    assert enhanced_comac(SHAPES, test)[1] == pytest.approx(unit.mean())
    assert np.delete(enhanced_comac(SHAPES, test), 1) == pytest.approx(np.zeros(POINTS - 1), abs=1e-15)


def test_comac_of_two_modes_by_hand() -> None:
    """Sensor 0 reads 1 and 0 where the model has 1 and 1: (1·1 + 1·0)² / ((1 + 1)(1 + 0)) = 1/2 before scaling.

    With a thousand other points that agree, the factors of scale are 1 but for parts in a thousand.
    """
    model = np.ones((2, 1001))
    model[1, 1::2] = -1.0
    test = model.copy()
    test[1, 0] = 0.0
    assert comac(model, test)[0] == pytest.approx(0.5, abs=2e-3)


def test_what_no_pair_has_is_unknown() -> None:
    test = TEST.copy()
    test[:, 3] = np.nan
    test[0, 5] = np.nan
    values = comac(SHAPES, test)
    assert np.isnan(values[3])
    assert np.isnan(enhanced_comac(SHAPES, test)[3])
    assert np.delete(values, 3) == pytest.approx(np.ones(POINTS - 1))


def test_sets_that_are_no_pairs_are_refused() -> None:
    with pytest.raises(HousingError, match="4 model and 3 measured shapes; expected pairs"):
        comac(SHAPES, TEST[:3])
    with pytest.raises(HousingError, match="a model shape in a pair is zero"):
        comac(np.zeros((1, 3)), np.ones((1, 3)))
