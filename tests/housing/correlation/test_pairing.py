"""Pairs of a plate's modes, whose shapes and frequencies are known: noise, gaps, crossings, double and missing ones."""

from itertools import pairwise

import numpy as np
import pytest

from gearwhine.housing import HousingError, compare_by_shapes
from gearwhine.housing.correlation import pair_modes, span_mac
from gearwhine.housing.correlation.pairing import PairingRule
from gearwhine.housing.measured import MeasuredGeometry, MeasuredModes
from gearwhine.housing.modes.dominance import Dominance

FloatArray = np.ndarray


def _plate(across: float, count: int) -> tuple[FloatArray, FloatArray]:
    """The lowest modes of a hinged plate, 1 by ``across``, at 9 x 13 points within: ω ∝ m² + (n / across)²."""
    numbers = [(m, n) for m in range(1, 6) for n in range(1, 7)]
    numbers.sort(key=lambda mn: mn[0] ** 2 + (mn[1] / across) ** 2)
    x, y = np.arange(1, 10) / 10, np.arange(1, 14) / 14
    frequencies = np.array([m**2 + (n / across) ** 2 for m, n in numbers[:count]])
    shapes = np.array([np.outer(np.sin(m * np.pi * x), np.sin(n * np.pi * y)).ravel() for m, n in numbers[:count]])
    return 1000.0 * frequencies, shapes


OBLONG = _plate(1.37, 12)
SQUARE = _plate(1.0, 8)  # (1,2) and (2,1), (1,3) and (3,1), ... are double


def _geometry(count: int) -> MeasuredGeometry:
    return MeasuredGeometry(
        tuple(str(number) for number in range(count)),
        np.zeros((count, 3)),
        np.arange(count),
        np.tile([0.0, 0.0, 1.0], (count, 1)),
    )


def _measured(frequencies: FloatArray, shapes: FloatArray) -> MeasuredModes:
    order = np.argsort(frequencies)
    return MeasuredModes(frequencies[order], None, shapes[order] + 0j, _geometry(shapes.shape[1]))


@pytest.mark.parametrize("seed", range(40))
def test_a_noisy_twin_is_paired_rightly_and_what_is_missing_named(seed: int) -> None:
    """3 % on frequencies, 5 % of the largest amplitude on shapes, complex scales, gaps; modes 4 and 9 not found."""
    random = np.random.default_rng(seed)
    frequencies, shapes = OBLONG
    found = [number for number in range(12) if number not in (3, 8)]
    test = frequencies[found] * (1.0 + 0.03 * random.normal(size=10))
    noise = random.normal(size=(2, 10, shapes.shape[1]))
    seen = shapes[found] + 0.05 * (noise[0] + 1j * noise[1]) / np.sqrt(2.0)
    seen = seen * (random.normal(size=(10, 1)) + 1j * random.normal(size=(10, 1)))
    seen[random.random(seen.shape) < 0.1] = np.nan
    order = np.argsort(test)
    comparison = compare_by_shapes(frequencies, shapes, _measured(test, seen))
    assert [pair.mode - 1 for pair in comparison.pairs] == [found[place] for place in order]
    assert comparison.shapes is not None
    assert comparison.shapes.unpaired_measured == ()
    # A mode is missing where it lies in the band that was measured, whose ends are noisy too.
    band = sorted(test)[0], sorted(test)[-1]
    assert comparison.shapes.unpaired_model == tuple(
        number + 1 for number in (3, 8) if band[0] <= frequencies[number] <= band[1]
    )
    assert all(pair.mac is not None and pair.mac > 0.9 for pair in comparison.pairs)
    assert all(pair.confidence is not None and pair.confidence > 0.8 for pair in comparison.pairs)


def test_modes_that_crossed_are_followed() -> None:
    """Modes 3 and 4 of the test in the other order: by frequency alone they would be paired wrongly."""
    frequencies, shapes = OBLONG
    test = frequencies[:6].copy()
    test[[2, 3]] = 1.02 * test[3], 0.98 * test[2]
    pairs = compare_by_shapes(frequencies, shapes, _measured(test, shapes[:6])).pairs
    assert [pair.mode for pair in pairs] == [1, 2, 4, 3, 5, 6]


def test_one_model_mode_is_not_given_twice() -> None:
    """Measured mode 2 is not in the model and half like mode 1, which has its own: it is left alone and named."""
    frequencies, shapes = OBLONG[0][:4], OBLONG[1][:4]
    other = np.sqrt(0.55) * shapes[0] + np.sqrt(0.45) * OBLONG[1][9]  # shapes of one norm
    test = _measured(
        np.array([frequencies[0], 1.05 * frequencies[0], frequencies[1]]), np.array([shapes[0], other, shapes[1]])
    )
    comparison = compare_by_shapes(frequencies, shapes, test)
    assert [(pair.measured_mode, pair.mode) for pair in comparison.pairs] == [(1, 1), (3, 2)]
    assert comparison.shapes is not None
    assert comparison.shapes.mac[0, 1] == pytest.approx(0.55)
    assert comparison.shapes.unpaired_measured == (2,)
    # The rival makes this pair less sure than the other; by hand: 1 - 0.55 exp(-(ln 1.05 / 0.2)² / 2).
    rival = 0.55 * np.exp(-0.5 * (np.log(1.05) / 0.2) ** 2)
    assert comparison.pairs[0].confidence == pytest.approx(1.0 - rival)
    assert comparison.pairs[1].confidence == pytest.approx(1.0)


def test_only_a_mode_s_own_near_misses_lower_its_confidence() -> None:
    """Three model shapes at right angles, at frequencies without weight, and mixtures of them, by hand.

    The first measured mode has a MAC of 0.60 with model mode 1 and of 0.40 with mode 2, the second 0.95 with mode 1 and
    0.05 with mode 3. By the rule only the second is paired, with mode 1. Without that pair the first takes mode 1 and
    the second mode 3: 0.65 for 0.95. That the first cannot take mode 2 beside the pair is the rule's doing.
    """
    model = np.eye(3)
    rule = PairingRule(frequency_spread=1e6)
    mixed = np.sqrt(np.array([[0.60, 0.40, 0.0], [0.95, 0.0, 0.05]]))
    (pair,) = pair_modes(np.array([100.0, 200.0, 300.0]), model, np.array([110.0, 210.0]), mixed, rule)
    assert (pair.measured, pair.model) == (1, 0)
    assert pair.confidence == pytest.approx((0.95 - 0.65) / 0.95)
    # A mode half like each of two is unsure, though the rule leaves it one partner.
    (pair,) = pair_modes(np.array([100.0, 200.0, 300.0]), model, np.array([110.0]), mixed[:1], rule)
    assert pair.confidence == pytest.approx(0.2 / 0.6)


def test_a_mode_found_twice_is_named() -> None:
    frequencies, shapes = OBLONG
    test = np.array([1.0, 1.004, 1.9]) * frequencies[0]
    comparison = compare_by_shapes(frequencies, shapes, _measured(test, shapes[[0, 0, 1]] + 0.01 * shapes[[2, 3, 4]]))
    assert comparison.shapes is not None
    (twice,) = comparison.shapes.measured_look_alikes
    assert (twice.first, twice.second, twice.one_frequency) == (1, 2, True)
    assert len(comparison.shapes.unpaired_measured) == 1
    assert comparison.shapes.unpaired_measured[0] in (1, 2)


def test_modes_that_too_few_points_confuse_are_named() -> None:
    """At 3 points along the beam, sin(πx) and sin(7πx) read alike up to sign."""
    x = np.array([0.25, 0.5, 0.75])
    numbers = np.array([1, 2, 7])
    shapes = np.sin(np.pi * np.outer(numbers, x))
    comparison = compare_by_shapes(
        np.array([100.0, 120.0, 140.0]), shapes, _measured(np.array([100.0, 120.0]), shapes[:2])
    )
    assert comparison.shapes is not None
    (alike,) = comparison.shapes.model_look_alikes
    assert (alike.first, alike.second, alike.one_frequency) == (1, 3, False)
    assert comparison.shapes.cross_orthogonality is None
    assert "cannot tell 3 model modes apart" in comparison.shapes.no_orthogonality
    assert comparison.pairs[0].confidence == pytest.approx(1.0 - np.exp(-0.5 * (np.log(1.4) / 0.2) ** 2))


@pytest.mark.parametrize("angle", np.linspace(0.0, np.pi, 13))
def test_double_modes_pair_alike_however_they_are_turned(angle: float) -> None:
    frequencies, shapes = SQUARE
    assert frequencies[1] == frequencies[2]
    turn = np.eye(len(shapes))
    turn[1:3, 1:3] = [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
    test = np.concatenate([frequencies[:4] * [0.97, 1.01, 1.015, 1.03]])
    comparison = compare_by_shapes(frequencies, shapes, _measured(test, (turn @ shapes)[:4]))
    assert sorted(pair.mode for pair in comparison.pairs) == [1, 2, 3, 4]
    assert [pair.mac for pair in comparison.pairs] == pytest.approx([1.0] * 4)
    assert [pair.error_percent for pair in comparison.pairs] == pytest.approx(
        [100.0 / 0.97 - 100.0, 100.0 / 1.01 - 100.0, 100.0 / 1.015 - 100.0, 100.0 / 1.03 - 100.0]
    )
    assert min(pair.confidence or 0.0 for pair in comparison.pairs) > 0.99
    assert comparison.pairs[1].close_modes == comparison.pairs[2].close_modes == (2, 3)
    assert comparison.shapes is not None
    close = comparison.shapes.close[0]
    assert (close.model, close.measured) == ((2, 3), (2, 3))
    assert close.largest_angle == pytest.approx(0.0, abs=1e-6)
    assert comparison.shapes.comac is not None
    assert np.nanmin(comparison.shapes.comac) > 1.0 - 1e-9  # turned to each other first


def test_one_of_a_double_mode_leaves_the_other_missing() -> None:
    frequencies, shapes = SQUARE
    one = 0.6 * shapes[1] + 0.8 * shapes[2]
    test = _measured(frequencies[[0, 1, 3]], np.array([shapes[0], one, shapes[3]]))
    comparison = compare_by_shapes(frequencies, shapes, test)
    assert [pair.mac for pair in comparison.pairs] == pytest.approx([1.0] * 3)
    assert comparison.shapes is not None
    assert len(comparison.shapes.unpaired_model) == 1
    assert comparison.shapes.unpaired_model[0] in (2, 3)
    assert comparison.pairs[1].mixed


def test_a_test_whose_modes_are_closer_than_the_models() -> None:
    """The model's 3 % apart, the test's 0.4 % and mixed half and half: paired by the span of the test's, in order."""
    frequencies = np.array([1000.0, 1500.0, 1545.0, 2200.0])
    shapes = OBLONG[1][:4]
    mixed = np.array([shapes[0], shapes[1] + shapes[2], shapes[1] - shapes[2], shapes[3]])
    test = _measured(np.array([1010.0, 1520.0, 1526.0, 2190.0]), mixed)
    pairs = compare_by_shapes(frequencies, shapes, test).pairs
    assert [pair.mode for pair in pairs] == [1, 2, 3, 4]
    assert [pair.mixed for pair in pairs] == [False, True, True, False]
    assert [pair.mac for pair in pairs] == pytest.approx([1.0] * 4)
    evidence = compare_by_shapes(frequencies, shapes, test).shapes
    assert evidence is not None
    (close,) = evidence.close
    assert (close.model, close.measured) == ((2, 3), (2, 3))
    assert close.largest_angle == pytest.approx(0.0, abs=1e-6)
    # Nothing but the span tells: without closeness neither half is above the least MAC of a pair.
    strict = compare_by_shapes(frequencies, shapes, test, rule=PairingRule(closeness=0.0, least_mac=0.51)).pairs
    assert [pair.measured_mode for pair in strict] == [1, 4]


def test_close_modes_that_shapes_tell_apart_are_paired_by_them() -> None:
    frequencies = np.array([1000.0, 1005.0, 2000.0])
    shapes = OBLONG[1][:3]
    test = _measured(np.array([990.0, 996.0, 2000.0]), shapes[[1, 0, 2]])
    pairs = compare_by_shapes(frequencies, shapes, test).pairs
    assert [pair.mode for pair in pairs] == [2, 1, 3]
    assert not any(pair.mixed for pair in pairs)


def test_what_is_too_unlike_or_too_far_stays_alone() -> None:
    frequencies, shapes = OBLONG
    far = _measured(frequencies[:1] * 1.6, shapes[:1])
    comparison = compare_by_shapes(frequencies, shapes, far)
    assert comparison.pairs == ()
    assert np.isnan(comparison.rms_error_percent)
    assert np.isnan(comparison.max_error_percent)
    assert comparison.shapes is not None
    assert comparison.shapes.comac is None
    assert comparison.shapes.unpaired_measured == (1,)
    half = np.sqrt(0.4) * shapes[0] + np.sqrt(0.6) * OBLONG[1][11]
    assert pair_modes(frequencies[:3], shapes[:3], frequencies[:1], half) == ()
    assert len(pair_modes(frequencies[:3], shapes[:3], frequencies[:1], half, PairingRule(least_mac=0.3))) == 1


def test_a_test_in_pieces_leaves_unknown_what_its_pieces_do_not_share() -> None:
    """Measured modes 2 and 3, both of a double one, at points of their own each: no angle between spans, but pairs."""
    frequencies, shapes = SQUARE
    test = shapes[:3] + 0j
    test[1, ::2] = np.nan
    test[2, 1::2] = np.nan
    comparison = compare_by_shapes(frequencies, shapes, _measured(frequencies[:3], test))
    assert [pair.mode for pair in comparison.pairs] == [1, 2, 3]
    assert comparison.shapes is not None
    assert np.isnan(comparison.shapes.measured_auto_mac[1, 2])
    assert np.isnan(comparison.shapes.close[0].largest_angle)


def test_rigid_motion_of_the_model_is_paired_with_nothing() -> None:
    frequencies = np.array([0.0, 0.0, 1000.0])
    (pair,) = pair_modes(frequencies, OBLONG[1][:3], np.array([990.0]), OBLONG[1][2])
    assert pair.model == 2
    six = np.array([0.0] * 6 + [1000.0])  # at fewer points than there are rigid motions
    (pair,) = pair_modes(six, OBLONG[1][:7, 3:8], np.array([990.0]), OBLONG[1][6, 3:8])
    assert pair.model == 6


def test_the_evidence_beside_the_pairs() -> None:
    frequencies, shapes = OBLONG
    strengths = Dominance(np.arange(12.0), np.ones(12), np.ones(12), frequencies)
    comparison = compare_by_shapes(
        frequencies, shapes, _measured(frequencies[:5], 2j * shapes[:5]), strengths=strengths
    )
    assert [pair.strength for pair in comparison.pairs] == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert comparison.gap is None
    assert comparison.band == pytest.approx((frequencies[0] * np.exp(-0.4), frequencies[4] * np.exp(0.4)))
    evidence = comparison.shapes
    assert evidence is not None
    assert evidence.collinearity == pytest.approx(np.ones(5))
    assert evidence.cross_orthogonality is not None
    assert evidence.cross_orthogonality[:5] == pytest.approx(np.eye(5), abs=1e-12)
    assert evidence.outside == pytest.approx(np.zeros(5), abs=1e-12)
    assert [after - before for before, after in pairwise(evidence.orthogonality_modes)] == [1] * (
        len(evidence.orthogonality_modes) - 1
    )


def test_inputs_that_do_not_fit_are_refused() -> None:
    frequencies, shapes = OBLONG
    with pytest.raises(HousingError, match="without shapes are paired by dominance"):
        compare_by_shapes(frequencies, shapes, MeasuredModes(frequencies))
    with pytest.raises(HousingError, match="11 model frequencies for 12 shapes"):
        pair_modes(frequencies[1:], shapes, frequencies[:1], shapes[:1])
    with pytest.raises(HousingError, match="has one degree of freedom, at which every mode looks alike"):
        pair_modes(frequencies[:2], shapes[:2, :1], frequencies[:1], shapes[:1, :1])
    with pytest.raises(HousingError, match="measured frequency is not above zero"):
        pair_modes(frequencies, shapes, np.zeros(1), shapes[:1])
    with pytest.raises(HousingError, match=r"least_mac is 0; expected a number above 0 and at most 1"):
        PairingRule(least_mac=0)
    with pytest.raises(HousingError, match="a closeness of 1"):
        PairingRule(closeness=1.0)
    with pytest.raises(HousingError, match="is like anything"):
        span_mac(np.ones((2, 2)), np.ones(2))
