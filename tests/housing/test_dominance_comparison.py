"""Pairing of measured with dominant modes, by hand."""

import numpy as np
import pytest

from gearwhine.housing import HousingError, compare_by_dominance
from gearwhine.housing.modes.dominance import Dominance

FREQUENCIES = np.array([100.0, 205.0, 290.0, 310.0, 420.0, 900.0])
STRENGTHS = np.array([7.0, 5.0, 1.0, 6.0, 2.0, 50.0])
MODEL = Dominance(STRENGTHS, STRENGTHS, STRENGTHS, FREQUENCIES)
MEASURED = np.array([110.0, 200.0, 300.0])


def test_dominant_modes_are_paired_in_order_and_not_with_their_nearest() -> None:
    comparison = compare_by_dominance(MEASURED, MODEL)
    assert [pair.mode for pair in comparison.pairs] == [1, 2, 4]
    assert [pair.model for pair in comparison.pairs] == [100.0, 205.0, 310.0]
    assert [pair.measured for pair in comparison.pairs] == [110.0, 200.0, 300.0]
    assert [pair.strength for pair in comparison.pairs] == [7.0, 5.0, 6.0]
    errors = [100 * (100 / 110 - 1), 2.5, 100 * (310 / 300 - 1)]
    assert [pair.error_percent for pair in comparison.pairs] == pytest.approx(errors)
    assert comparison.max_error_percent == pytest.approx(abs(errors[0]))
    assert comparison.rms_error_percent == pytest.approx(np.sqrt(np.mean(np.square(errors))))
    assert comparison.pairing == "dominance"
    assert comparison.rule == "dominance in order of frequency"
    assert comparison.measures_agree


def test_band_reaches_beyond_the_measured_frequencies_by_the_fixed_parts() -> None:
    """0.75 of the first to 1.05 of the last: 500-3100 Hz for the rig's 658 and 2962 Hz."""
    comparison = compare_by_dominance(MEASURED, MODEL)
    assert comparison.band == pytest.approx((82.5, 315.0))
    assert comparison.gap == pytest.approx(np.log(5.0 / 1.0))
    rig = 2 * np.pi * np.array([658.0, 2962.0])
    band = compare_by_dominance(rig, Dominance(*[np.ones(2)] * 3, frequencies=rig)).band
    assert np.array(band) / (2 * np.pi) == pytest.approx((500.0, 3100.0), rel=0.02)


def test_a_wider_band_lets_stronger_modes_in() -> None:
    comparison = compare_by_dominance(MEASURED, MODEL, band=(50.0, 1000.0))
    assert [pair.mode for pair in comparison.pairs] == [1, 4, 6]
    assert comparison.gap == pytest.approx(np.log(6.0 / 5.0))


def test_measures_that_disagree_are_reported() -> None:
    other = np.array([7.0, 5.0, 9.0, 6.0, 2.0, 50.0])
    assert not compare_by_dominance(MEASURED, Dominance(STRENGTHS, other, STRENGTHS, FREQUENCIES)).measures_agree


def test_a_model_with_too_few_modes_is_refused() -> None:
    with pytest.raises(HousingError, match="3 measured modes, but the model has only 2 between 40 and 50 Hz"):
        compare_by_dominance(MEASURED, MODEL, band=(2 * np.pi * 40.0, 2 * np.pi * 50.0))


@pytest.mark.parametrize("measured", [[], [200.0, 110.0], [110.0, 110.0], [0.0, 110.0]])
def test_measured_frequencies_that_do_not_ascend_are_refused(measured: list[float]) -> None:
    with pytest.raises(HousingError, match="must be positive and ascending"):
        compare_by_dominance(np.array(measured), MODEL)
