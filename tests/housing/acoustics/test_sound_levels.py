"""Sound levels: decibels, frequency weighting A by its table, third octaves, and the box of microphones."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearwhine.housing.acoustics.sound_levels import (
    a_weighting,
    measurement_box,
    power_level,
    pressure_level,
    sum_of_levels,
    third_octave_bands,
)

# IEC 61672-1:2013, Table 3: nominal frequencies [Hz] and frequency weighting A [dB].
TABLE = {
    10: -70.4, 20: -50.5, 31.5: -39.4, 50: -30.2, 63: -26.2, 100: -19.1, 125: -16.1, 200: -10.9, 250: -8.6,
    400: -4.8, 500: -3.2, 630: -1.9, 800: -0.8, 1000: 0.0, 1250: 0.6, 1600: 1.0, 2000: 1.2, 2500: 1.3, 3150: 1.2,
    4000: 1.0, 5000: 0.5, 6300: -0.1, 8000: -1.1, 10000: -2.5, 12500: -4.3, 16000: -6.6, 20000: -9.3,
}  # fmt: skip


def test_a_weighting_is_that_of_the_standards_table():
    # The table holds at the exact frequencies 1000 · 10^(n/10), which the nominal ones are near.
    exact = 1000.0 * 10.0 ** (np.round(10.0 * np.log10(np.array(list(TABLE)) / 1000.0)) / 10.0)
    assert a_weighting(exact) == pytest.approx(list(TABLE.values()), abs=0.0501)


def test_levels_of_known_amounts():
    assert power_level(1e-12) == pytest.approx(0.0)
    assert power_level(2e-3) == pytest.approx(93.01, abs=0.005)
    assert power_level(0.0) == -np.inf
    assert pressure_level(np.sqrt(2.0) * 1.0) == pytest.approx(93.98, abs=0.005)  # 1 Pa rms: a calibrator's 94 dB
    assert sum_of_levels([60.0, 60.0]) == pytest.approx(63.01, abs=0.005)
    assert sum_of_levels([]) == -np.inf


def test_third_octaves_hold_their_lines():
    nominal, sums = third_octave_bands(np.array([446.0, 447.0, 1000.0, 1122.0, 1123.0]), np.ones(5))
    assert nominal.tolist() == [400.0, 500.0, 630.0, 800.0, 1000.0, 1250.0]  # the edges are at 446.7 and 1122.0 Hz
    assert sums.tolist() == [1.0, 1.0, 0.0, 0.0, 2.0, 1.0]
    assert third_octave_bands(np.zeros(0), np.zeros(0))[0].size == 0


@given(st.lists(st.tuples(st.floats(20, 20000), st.floats(1e-12, 1.0)), min_size=1, max_size=20))
def test_third_octaves_keep_the_power(lines):
    frequencies, powers = np.array(lines).T
    assert third_octave_bands(frequencies, powers)[1].sum() == pytest.approx(powers.sum())


@given(st.floats(0.2, 1.5), st.floats(0.2, 1.5), st.floats(0.2, 1.5), st.floats(0.5, 3.0))
def test_box_measures_a_source_on_the_floor(x, y, z, distance):
    """Intensity of a point source on a hard floor at the places of ISO 3744: its mean gives the power within 1.5 dB."""
    positions, area = measurement_box(np.array([-x / 2, 0.0, -z / 2]), np.array([x / 2, y, z / 2]), distance)
    intensity = 1.0 / (2.0 * np.pi * (positions**2).sum(axis=1))
    assert 10.0 * np.log10(intensity.mean() * area) == pytest.approx(0.0, abs=1.5)
    a, b, c = 0.5 * x + distance, 0.5 * z + distance, y + distance
    assert area == pytest.approx(4.0 * (a * b + b * c + c * a))  # ISO 3744:2010, equation 5
