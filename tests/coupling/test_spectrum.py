"""Spectra against sines whose lines are known."""

from typing import Literal

import numpy as np
import pytest

from gearwhine.coupling import amplitude_spectrum
from gearwhine.coupling.signals.spectrum import whole_period_samples

INTERVAL = 1e-3


@pytest.mark.parametrize("count", [400, 401])
def test_sine_in_whole_periods(count: int) -> None:
    times = INTERVAL * np.arange(count)
    frequency = 23.0 / (count * INTERVAL)
    signal = -4.0 + 2.5 * np.cos(2.0 * np.pi * frequency * times + 0.7)
    spectrum = amplitude_spectrum(signal, INTERVAL)
    assert spectrum.frequencies.shape == (count // 2 + 1,)
    assert spectrum.frequencies[23] == pytest.approx(frequency, rel=1e-12)
    assert spectrum.amplitude[23] == pytest.approx(2.5, rel=1e-12)
    assert spectrum.phase[23] == pytest.approx(0.7, rel=1e-10)
    assert spectrum.amplitude[0] == pytest.approx(4.0, rel=1e-12)
    assert spectrum.phase[0] == pytest.approx(np.pi)
    others = np.delete(spectrum.amplitude, [0, 23])
    assert others.max() < 1e-12


@pytest.mark.parametrize("count", [256, 255])
def test_parseval(count: int) -> None:
    """Mean square: the mean's square, half the square of every line, and the whole one at half the sampling rate."""
    signal = np.random.default_rng(5).normal(1.0, 2.0, size=(3, count))
    amplitude = amplitude_spectrum(signal, INTERVAL).amplitude
    weights = np.full(amplitude.shape[-1], 0.5)
    weights[0] = 1.0
    if count % 2 == 0:
        weights[-1] = 1.0
    np.testing.assert_allclose((weights * amplitude**2).sum(axis=-1), (signal**2).mean(axis=-1), rtol=1e-12)


@pytest.mark.parametrize("window", ["uniform", "hann"])
def test_rms_of_a_band(window: Literal["uniform", "hann"]) -> None:
    """Two sines and a mean: a/√2 of each sine in the band."""
    times = INTERVAL * np.arange(1000)
    signal = 9.0 + 3.0 * np.sin(2 * np.pi * 40.0 * times) + 4.0 * np.sin(2 * np.pi * 200.0 * times + 1.0)
    spectrum = amplitude_spectrum(signal, INTERVAL, window)
    assert spectrum.rms(100.0) == pytest.approx(3.0 / np.sqrt(2.0), rel=1e-9)
    assert spectrum.rms(400.0) == pytest.approx(5.0 / np.sqrt(2.0), rel=1e-9)
    assert spectrum.rms(10.0) == pytest.approx(0.0, abs=1e-9)


def test_a_line_at_half_the_sampling_rate() -> None:
    signal = np.tile([3.0, -3.0], 32)
    spectrum = amplitude_spectrum(signal, INTERVAL)
    assert spectrum.frequencies[-1] == pytest.approx(0.5 / INTERVAL)
    assert spectrum.amplitude[-1] == pytest.approx(3.0, rel=1e-12)


def test_hann_keeps_the_height() -> None:
    count = 1000
    times = INTERVAL * np.arange(count)
    whole = amplitude_spectrum(7.0 + 2.5 * np.sin(2.0 * np.pi * 50.0 * times), INTERVAL, "hann")
    assert whole.amplitude[50] == pytest.approx(2.5, rel=1e-9)
    # Half the height on both sides, nothing beyond, and no leak of the mean.
    np.testing.assert_allclose(whole.amplitude[[49, 51]], 1.25, rtol=1e-9)
    assert whole.amplitude[[1, 2, 40, 47, 53, 60]].max() < 1e-9
    assert whole.amplitude[0] == pytest.approx(7.0, rel=1e-12)
    # Between two lines Hann's loss is at worst 1 - 8/(3π), about 15 %; the uniform window's 1 - 2/π, about 36 %.
    between = np.sin(2.0 * np.pi * 50.5 * times)
    assert amplitude_spectrum(between, INTERVAL, "hann").amplitude.max() == pytest.approx(8.0 / (3.0 * np.pi), rel=2e-3)
    assert amplitude_spectrum(between, INTERVAL).amplitude.max() == pytest.approx(2.0 / np.pi, rel=2e-2)
    far = slice(70, 400)
    leak = amplitude_spectrum(between, INTERVAL).amplitude[far].max()
    assert amplitude_spectrum(between, INTERVAL, "hann").amplitude[far].max() < 0.02 * leak


def test_a_derivative_multiplies_lines() -> None:
    """Acceleration lines are (2πf)² times those of the displacement, in opposite phase."""
    times = np.arange(500) / 500.0
    w = 2.0 * np.pi * 20.0
    motion = amplitude_spectrum(np.cos(w * times + 0.3), 1.0 / 500.0)
    acceleration = amplitude_spectrum(-(w**2) * np.cos(w * times + 0.3), 1.0 / 500.0)
    assert acceleration.amplitude[20] / motion.amplitude[20] == pytest.approx(w**2, rel=1e-12)
    assert np.cos(acceleration.phase[20] - motion.phase[20]) == pytest.approx(-1.0, abs=1e-12)


@pytest.mark.parametrize(("count", "whole"), [(10_300, 10_000), (1_900, 1_000), (1_000, 1_000), (999, None)])
def test_whole_periods_at_the_end_of_a_record(count: int, whole: int | None) -> None:
    """A shaft of 1 Hz and its 28 teeth: whole seconds of 1000 samples; the lines of those samples are exact."""
    assert whole_period_samples(count, INTERVAL, [1.0, 28.0]) == whole
    if whole is not None:
        times = INTERVAL * np.arange(count)
        signal = 7.0 * np.sin(2.0 * np.pi * times) + 81.1 * np.cos(2.0 * np.pi * 28.0 * times + 0.3)
        seconds = whole // 1000
        amplitude = amplitude_spectrum(signal[-whole:], INTERVAL).amplitude
        assert amplitude[[seconds, 28 * seconds]] == pytest.approx([7.0, 81.1], rel=1e-9)
