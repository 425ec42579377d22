"""Signatures against signals whose content is known in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import jv

from gearwhine.coupling import CouplingError, SpeedProfile, amplitude_spectrum
from gearwhine.coupling.signals import (
    AngleSignal,
    OrderMap,
    decibels,
    from_decibels,
    order_map,
    order_spectrum,
    peak_of_rms,
    power_density,
    resample_by_angle,
    rms_of_peak,
    sidebands,
    spectrogram,
)
from gearwhine.coupling.signals.spectrum import lines_at, signal_parts

INTERVAL = 1e-4
TIMES = INTERVAL * np.arange(10_000)  # one second


def test_levels_by_their_definition() -> None:
    """ISO 1683: 120 dB re 1 µm/s² is 1 m/s² rms; a peak of 1 m/s² stands 10 lg 2 below."""
    assert decibels(np.sqrt(2.0)) == pytest.approx(120.0)
    assert decibels(1.0) == pytest.approx(120.0 - 10.0 * np.log10(2.0))
    assert decibels(1.0, reference=1.0 / np.sqrt(2.0)) == pytest.approx(0.0, abs=1e-12)
    assert decibels(0.0) == -np.inf
    assert rms_of_peak(3.0) == pytest.approx(3.0 / np.sqrt(2.0))
    with pytest.raises(CouplingError, match="reference of 0"):
        decibels(1.0, reference=0.0)


@given(st.floats(1e-9, 1e6), st.floats(1e-9, 1e3))
def test_levels_and_back(amplitude: float, reference: float) -> None:
    assert from_decibels(decibels(amplitude, reference), reference) == pytest.approx(amplitude, rel=1e-9)
    assert peak_of_rms(rms_of_peak(amplitude)) == pytest.approx(amplitude)


def test_fixed_and_varying_part() -> None:
    parts = signal_parts(np.stack([-4.0 + 3.0 * np.sin(2 * np.pi * 50.0 * TIMES), 0.0 * TIMES + 2.0]))
    assert parts.mean == pytest.approx([-4.0, 2.0])
    assert parts.rms == pytest.approx([3.0 / np.sqrt(2.0), 0.0], abs=1e-12)
    assert parts.peak == pytest.approx([3.0, 0.0], abs=1e-12)


@pytest.mark.parametrize("window", ["uniform", "hann"])
def test_lines_at_frequencies_of_the_record_are_those_of_its_spectrum(window: str) -> None:
    signal = np.random.default_rng(3).normal(2.0, 1.0, size=(2, 500))
    spectrum = amplitude_spectrum(signal, INTERVAL, window)
    places = np.array([1, 7, 130])
    found = lines_at(signal, INTERVAL, spectrum.frequencies[places], window)
    np.testing.assert_allclose(found, spectrum.lines[:, places], rtol=1e-9)


@pytest.mark.parametrize("count", [1, 2, 17, 900, 1000])
def test_lines_are_the_sum_that_they_stand_for(count: int) -> None:
    signal = np.random.default_rng(count).normal(size=(2, 3, count))
    frequencies = np.array([31.7, 444.4])
    turning = np.exp(-2j * np.pi * INTERVAL * np.outer(np.arange(count), frequencies))
    expected = (signal - signal.mean(axis=-1, keepdims=True)) @ turning * (2.0 / count)
    np.testing.assert_allclose(lines_at(signal, INTERVAL, frequencies), expected, rtol=0.0, atol=1e-12)
    assert lines_at(signal, INTERVAL, np.empty(0)).shape == (2, 3, 0)


def test_a_line_between_two_of_the_record() -> None:
    """Under Hann's window a sine's height is read at its own frequency wherever that lies: only its image leaks in."""
    signal = 5.0 + 2.0 * np.cos(2 * np.pi * 1234.37 * TIMES + 0.4)
    (line,) = lines_at(signal, INTERVAL, np.array([1234.37]), "hann")
    assert line == pytest.approx(2.0 * np.exp(0.4j), rel=1e-6)


@pytest.mark.parametrize("window", ["uniform", "hann"])
def test_power_density_of_noise_and_of_a_sine(window: str) -> None:
    """White noise of variance σ² has the density 2 σ² Δt; the average's scatter over n stretches is about 1/√n."""
    noise = np.random.default_rng(8).normal(0.0, 3.0, 400_000)
    found = power_density(noise, INTERVAL, 1000, window=window)
    assert found.density[5:-5].mean() == pytest.approx(2.0 * 9.0 * INTERVAL, rel=0.01)
    assert np.ptp(found.density[5:-5]) < 12.0 / np.sqrt(found.stretches) * 2.0 * 9.0 * INTERVAL
    assert found.rms(5000.0) == pytest.approx(3.0, rel=0.01)
    sine = power_density(4.0 + 2.0 * np.sin(2 * np.pi * 500.0 * TIMES), INTERVAL, 1000, window=window)
    assert sine.frequencies[49] == pytest.approx(500.0)
    assert sine.amplitude[49] == pytest.approx(2.0, rel=1e-9)
    assert sine.rms(1000.0) == pytest.approx(2.0 / np.sqrt(2.0), rel=1e-9)
    with pytest.raises(CouplingError, match="expected 2 to 10000"):
        power_density(TIMES, INTERVAL, 20_000)
    with pytest.raises(CouplingError, match="overlap below 1"):
        power_density(TIMES, INTERVAL, 100, overlap=1.0)


def test_spectrogram_follows_a_chirp() -> None:
    """f(t) = 200 + 800 t: the highest line of each stretch is the frequency at its middle, within a line's spacing."""
    chirp = np.cos(2 * np.pi * (200.0 * TIMES + 400.0 * TIMES**2))
    found = spectrogram(chirp, INTERVAL, 500, 250, start=1.0)
    highest = found.frequencies[np.argmax(found.amplitude, axis=1)]
    assert np.abs(highest - (200.0 + 800.0 * (found.times - 1.0))).max() <= found.frequencies[1]
    assert found.times[[0, -1]] == pytest.approx([1.025, 1.975])


@settings(max_examples=30, deadline=None)
@given(st.floats(0.01, 0.9), st.floats(-3.0, 3.0), st.floats(0.1, 50.0), st.integers(1, 3))
def test_amplitude_modulation(depth: float, angle: float, size: float, number: int) -> None:
    """a (1 + m cos nΩt) cos wt has lines a m/2 at w ± nΩ and no other."""
    shaft, carrier = 20.0, 700.0
    signal = size * (1.0 + depth * np.cos(2 * np.pi * number * shaft * TIMES + angle))
    signal = 3.0 + signal * np.cos(2 * np.pi * carrier * TIMES + 0.6)
    pairs = sidebands(signal, INTERVAL, [carrier], shaft)
    assert [pair.number for pair in pairs] == [1, 2, 3]
    for pair in pairs:
        there = pair.number == number
        assert pair.carrier_amplitude == pytest.approx(size, rel=1e-9)
        assert [pair.lower, pair.upper] == pytest.approx([0.5 * size * depth * there] * 2, abs=1e-9 * size)
        assert pair.amplitude_modulation == pytest.approx(depth * there, abs=1e-8)
        assert pair.phase_modulation == pytest.approx(0.0, abs=1e-8)


@pytest.mark.parametrize("window", ["uniform", "hann"])
def test_phase_modulation(window: str) -> None:
    """cos(wt + β sin Ωt) has lines J_n(β) (Jacobi and Anger), and no modulation of amplitude to first order."""
    beta, shaft, carrier = 0.3, 25.0, 900.0
    signal = np.cos(2 * np.pi * carrier * TIMES + beta * np.sin(2 * np.pi * shaft * TIMES))
    first, second, _ = sidebands(signal, INTERVAL, [carrier], shaft, window=window)
    assert first.carrier_amplitude == pytest.approx(jv(0, beta), rel=1e-6)
    assert [first.lower, first.upper] == pytest.approx([jv(1, beta)] * 2, rel=1e-6)
    assert [second.lower, second.upper] == pytest.approx([jv(2, beta)] * 2, rel=1e-6)
    assert first.phase_modulation == pytest.approx(2.0 * jv(1, beta) / jv(0, beta), rel=1e-6)
    assert first.amplitude_modulation == pytest.approx(0.0, abs=1e-6)


def test_sidebands_that_cannot_be_told_apart() -> None:
    with pytest.raises(CouplingError, match="expected one of 1 periods"):
        sidebands(TIMES, INTERVAL, [700.0], 0.4)
    # Those beyond 0 Hz and half the sampling rate are left out.
    assert len(sidebands(TIMES, INTERVAL, [50.0, 4990.0], 20.0)) == 2


RUN_UP = SpeedProfile(np.array([0.0, 2.0]), np.array([0.5, 1.5]))
SHAFT_HZ = 30.0


def run_up(times: np.ndarray) -> np.ndarray:
    """Orders 1, 7 and 28.5 of a shaft that runs up; its turns follow from the linear speed by hand."""
    turns = SHAFT_HZ * (0.5 * times + 0.25 * times**2)
    return (
        2.0
        + np.cos(2 * np.pi * turns + 0.3)
        + 0.5 * np.cos(2 * np.pi * 7.0 * turns)
        + 0.1 * np.cos(2 * np.pi * 28.5 * turns)
    )


def test_orders_of_a_run_up_stand_as_lines() -> None:
    times = 2e-5 * np.arange(100_000)
    turned = resample_by_angle(run_up(times), times, RUN_UP, SHAFT_HZ)
    # With the same angular acceleration, 15 turns/s², all along: v² = v₀² + 2 a n.
    np.testing.assert_allclose(turned.speeds, np.sqrt(15.0**2 + 30.0 * turned.turns), rtol=1e-12)
    # An even number of turns holds whole cycles of the half order.
    even = turned.turns.size // (2 * turned.per_turn) * 2 * turned.per_turn
    spectrum = order_spectrum(replace(turned, values=turned.values[:even]))
    assert spectrum.frequencies[-1] > 1000.0  # samples by angle as dense as those in time at the lowest speed
    expected = np.zeros(spectrum.frequencies.size)
    for order, size in ((0.0, 2.0), (1.0, 1.0), (7.0, 0.5), (28.5, 0.1)):
        expected[np.argmin(np.abs(spectrum.frequencies - order))] = size
    np.testing.assert_allclose(spectrum.amplitude, expected, atol=1e-9)
    # Over time the same orders are smeared out.
    assert amplitude_spectrum(run_up(times) - 2.0, 2e-5, "hann").amplitude.max() < 0.3


def within(found: OrderMap, turned: AngleSignal, turns: int) -> np.ndarray:
    """Windows that no end of the record cuts."""
    middles = np.searchsorted(turned.times, found.times - 1e-9)
    half = turns * turned.per_turn // 2
    return (middles >= half) & (middles <= turned.times.size - half)


def test_order_slices_over_speed() -> None:
    times = 2e-5 * np.arange(100_001)
    turned = resample_by_angle(run_up(times), times, RUN_UP, SHAFT_HZ, whole_turns=False)
    found = order_map(turned, turns=4, step=2, follow=[1.0, 7.0, 28.5])
    # From end to end, at the speed of each place: v² = v₀² + 2 a n at 15 turns/s².
    assert found.speeds[[0, -1]] == pytest.approx([15.0, 45.0], rel=1e-4)
    np.testing.assert_allclose(found.speeds, np.linspace(15.0, 45.0, found.times.size), rtol=1e-3)
    for order, size in ((1.0, 1.0), (7.0, 0.5), (28.5, 0.1)):
        # All the orders of the signal are fitted together: none leaks into another, not at the ends either.
        assert found.order_slice(order) == pytest.approx(np.full(found.times.size, size), abs=1e-6)
    lines = order_map(turned, turns=4, step=2)
    inside = within(lines, turned, 4)
    assert inside.sum() > 20
    for order, size in ((1.0, 1.0), (7.0, 0.5), (28.5, 0.1)):
        assert lines.order_slice(order)[inside] == pytest.approx(size, abs=1e-6)
    assert lines.order_slice(3.0)[inside].max() < 1e-6
    with pytest.raises(CouplingError, match=r"no line at order 7\.1"):
        found.order_slice(7.1)
    with pytest.raises(CouplingError, match="expected 1 or more"):
        order_map(turned, turns=1000)


def test_an_order_cut_follows_a_resonance_to_both_ends_of_a_run() -> None:
    """Order 28 through a resonance of 2 % damping at a quarter of an octave a turn; its mean over a window is lower.

    The amplitude at each speed is known. Over the windows the mean of the order errs by a third of the peak.
    """
    rate, first = 4000.0 / 60.0, 500.0 / 60.0
    times = np.arange(0.0, 1.0, 1e-5)
    turns = first * times + 0.5 * rate * times**2
    profile = SpeedProfile(np.array([0.0, 1.0]), np.array([first, first + rate]) / 10.0)

    def answer(speed: np.ndarray) -> np.ndarray:
        hertz = 28.0 * speed
        return np.asarray(hertz**2 / (1250.0**2 - hertz**2 + 0.04j * hertz * 1250.0))

    signal = np.real(answer(first + rate * times) * np.exp(2j * np.pi * 28.0 * turns))
    turned = resample_by_angle(signal, times, profile, 10.0, per_turn=200, whole_turns=False)
    found = order_map(turned, turns=2, step=0.25, follow=[28.0, 56.0])
    expected = np.abs(answer(found.speeds))
    cut = found.order_slice(28.0)
    assert found.speeds[[0, -1]] * 60.0 == pytest.approx([500.0, 4500.0], rel=1e-3)
    assert np.abs(cut - expected).max() < 0.1 * expected.max()
    assert cut[[0, -1]] == pytest.approx(expected[[0, -1]], rel=0.15)
    # The line of the window is flattened.
    assert np.abs(found.amplitude[:, 56] - expected).max() > 0.15 * expected.max()


def test_orders_that_windows_hold_no_whole_cycles_of_are_followed() -> None:
    """A shaft that turns 27/29 times for each turn of the leading one, beside that one's own order."""
    times = 2e-5 * np.arange(100_000)
    turns = SHAFT_HZ * (0.5 * times + 0.25 * times**2)
    signal = np.cos(2 * np.pi * turns) + 0.3 * np.cos(2 * np.pi * 27.0 / 29.0 * turns + 0.4) + 0.5
    turned = resample_by_angle(signal, times, RUN_UP, SHAFT_HZ)
    found = order_map(turned, turns=43, step=5, follow=[27.0 / 29.0, 1.0])
    assert found.order_slice(27.0 / 29.0) == pytest.approx(np.full(found.times.size, 0.3), rel=1e-6)
    assert found.order_slice(1.0) == pytest.approx(np.full(found.times.size, 1.0), rel=1e-6)
    with pytest.raises(CouplingError, match="no line at order"):
        order_map(turned, turns=43).order_slice(27.0 / 29.0)
    with pytest.raises(CouplingError, match="expected them above 0"):
        order_map(turned, turns=4, follow=[1e6])


def test_spectra_to_the_ends_of_a_record_keep_the_height_and_the_rms_of_a_line() -> None:
    signal = 2.0 + 3.0 * np.cos(2 * np.pi * 500.0 * TIMES + 0.4)
    whole = spectrogram(signal, INTERVAL, 400, 100)
    found = spectrogram(signal, INTERVAL, 400, 100, start=5.0, to_the_ends=True)
    assert found.times[[0, -1]] == pytest.approx([5.0, 5.0 + TIMES[-1]])
    line = np.argmin(np.abs(found.frequencies - 500.0))
    # Windows beside the ends do not hold whole periods.
    assert found.amplitude[:, line] == pytest.approx(3.0, rel=5e-3)
    assert found.amplitude[:, 0] == pytest.approx(2.0, rel=0.03)
    assert found.rms == pytest.approx(3.0 / np.sqrt(2.0), rel=0.01)
    assert whole.rms == pytest.approx(3.0 / np.sqrt(2.0), rel=1e-9)


def test_orders_above_the_samples_of_a_turn_do_not_fold_onto_those_below() -> None:
    """100 samples a turn pass orders up to 40; orders 93 and 171.5, ten times as strong, would fold to 7 and 28.5."""
    times = 2e-5 * np.arange(100_000)
    turns = SHAFT_HZ * (0.5 * times + 0.25 * times**2)
    high = 5.0 * np.cos(2 * np.pi * 93.0 * turns) + 1.0 * np.cos(2 * np.pi * 171.5 * turns + 0.2)
    turned = resample_by_angle(np.stack([run_up(times) + high, high]), times, RUN_UP, SHAFT_HZ, per_turn=100)
    assert turned.values.shape == (2, turned.turns.size)
    assert turned.turns.size % 100 == 0
    found = order_map(replace(turned, values=turned.values[0]), turns=4, step=2)
    inside = within(found, turned, 6)  # at the ends half a filter's length is made up
    assert inside.sum() > 20
    assert found.order_slice(7.0)[inside] == pytest.approx(0.5, abs=1e-6)
    assert found.order_slice(28.5)[inside] == pytest.approx(0.1, abs=1e-6)
    # The samples stand at their own angles: turns 10 to 20 of the low orders, to the last digit of the filter.
    part = slice(10 * 100, 20 * 100)
    low = turned.values[0, part] - turned.values[1, part]
    np.testing.assert_allclose(low, run_up(turned.times[part]), atol=1e-5)


def test_at_steady_speed_orders_are_the_lines_of_the_record() -> None:
    """With a whole number of samples each turn nothing is resampled: the same numbers, on another axis."""
    times = np.arange(4000) / 8000.0
    signal = np.random.default_rng(1).normal(size=4000)
    turned = resample_by_angle(signal, times, SpeedProfile.steady(), 40.0)
    assert turned.per_turn == 200
    np.testing.assert_allclose(turned.values, signal, atol=1e-9)
    spectrum, plain = order_spectrum(turned), amplitude_spectrum(signal, 1.0 / 8000.0)
    np.testing.assert_allclose(spectrum.frequencies * 40.0, plain.frequencies, rtol=1e-12)
    np.testing.assert_allclose(spectrum.amplitude, plain.amplitude, atol=1e-9)


def test_runs_without_an_angle_to_sample_by() -> None:
    stopping = SpeedProfile(np.array([0.0, 0.5]), np.array([1.0, 0.0]))
    with pytest.raises(CouplingError, match="stands still"):
        resample_by_angle(TIMES, TIMES, stopping, 40.0)
    with pytest.raises(CouplingError, match="expected a whole one"):
        resample_by_angle(TIMES[:50], TIMES[:50], SpeedProfile.steady(), 40.0)
    with pytest.raises(CouplingError, match="expected as many"):
        resample_by_angle(TIMES[1:], TIMES, SpeedProfile.steady(), 40.0)
    with pytest.raises(CouplingError, match="samples a turn"):
        resample_by_angle(TIMES, TIMES, SpeedProfile.steady(), 40.0, per_turn=1)
