"""Condition indicators of signals whose indicators are known in closed form."""

import numpy as np
import pytest
from scipy import stats

from gearwhine.coupling import CouplingError
from gearwhine.coupling.signals.condition_indicators import (
    SynchronousAverage,
    envelope_spectrum,
    na4,
    spectral_kurtosis,
    synchronous_average,
)

N, TEETH = 4096, 23
ANGLES = 2.0 * np.pi * np.arange(N) / N
MESH = 3.0 * np.cos(TEETH * ANGLES) + 0.5 * np.cos(2 * TEETH * ANGLES + 0.3)


def test_the_average_keeps_what_repeats_with_the_turn() -> None:
    rng = np.random.default_rng(1)
    turns = np.tile(MESH, 50) + np.sin(np.sqrt(2.0) * np.arange(50 * N + 7)[: 50 * N]) + rng.normal(size=50 * N)
    found = synchronous_average(np.append(turns, [9.0, 9.0]), N)
    # Of unit noise and a tone of another period, a fiftieth of the power each at most.
    assert np.std(found - MESH) == pytest.approx(1.0 / np.sqrt(50.0), rel=0.1)
    with pytest.raises(CouplingError, match="a whole turn"):
        synchronous_average(MESH[:10], N)


def test_a_pure_mesh_tone_has_no_residual_and_no_indicators_of_one() -> None:
    found = SynchronousAverage(MESH + 7.0, TEETH)
    assert (found.fm4, found.m6a, found.m8a) == (None, None, None)
    assert na4([found]) is None
    assert found.fm0 == pytest.approx(np.ptp(MESH) / 3.5, rel=1e-12)
    assert found.energy_ratio == pytest.approx(0.0, abs=1e-12)
    assert found.sideband_index == pytest.approx(0.0, abs=1e-12)
    assert SynchronousAverage(np.cos(5 * ANGLES), TEETH).fm0 is None


def test_modulation_is_regular_and_shows_in_the_sidebands() -> None:
    """(1 + m cos φ) of a tone has two sidebands of half m times its amplitude."""
    modulated = (
        (1.0 + 0.2 * np.cos(ANGLES)) * 3.0 * np.cos(TEETH * ANGLES) + 0.4 * np.cos(ANGLES) + 0.05 * np.cos(9 * ANGLES)
    )
    found = SynchronousAverage(modulated, TEETH, harmonics=1)
    assert found.sideband_index == pytest.approx(0.3, rel=1e-12)
    assert found.sideband_level_factor == pytest.approx(0.6 / np.std(modulated), rel=1e-12)
    assert found.difference == pytest.approx(0.05 * np.cos(9 * ANGLES), abs=1e-12)
    regular = np.sqrt(0.5 * (3.0**2 + 2.0 * 0.3**2))
    assert found.energy_ratio == pytest.approx(0.05 / np.sqrt(2.0) / regular, rel=1e-12)
    assert found.fm4 == pytest.approx(1.5, rel=1e-12)  # of a sine
    assert np.std(found.residual) == pytest.approx(np.sqrt(0.5 * (2.0 * 0.3**2 + 0.05**2)), rel=1e-12)


def test_na4_rises_with_a_residual_that_grows() -> None:
    """Residuals a cos of amplitudes a_j: 3/8 a⁴ over (½ mean a_j²)²."""
    sizes = [1.0, 1.0, 1.0, 2.0]
    averages = [SynchronousAverage(MESH + size * np.cos(9 * ANGLES), TEETH) for size in sizes]
    assert na4(averages[:3]) == pytest.approx(1.5, rel=1e-9)
    assert na4(averages) == pytest.approx(0.375 * 16.0 / (0.5 * 7.0 / 4.0) ** 2, rel=1e-9)
    with pytest.raises(CouplingError, match="one synchronous average"):
        na4([])


def test_spectral_kurtosis_is_0_of_noise_minus_1_of_a_tone_and_high_where_bursts_ring() -> None:
    rate, count = 10e3, 400_000
    times = np.arange(count) / rate
    noise = np.random.default_rng(3).normal(size=count)
    frequencies, of_noise = spectral_kurtosis(noise, 1.0 / rate, 64)
    inner = slice(3, -3)
    assert np.abs(of_noise[inner]).max() < 0.15
    assert frequencies[1] == pytest.approx(rate / 64)
    _, of_tone = spectral_kurtosis(np.cos(2.0 * np.pi * 2500.0 * times), 1.0 / rate, 64)
    assert of_tone[16] == pytest.approx(-1.0, abs=1e-6)
    bursts = np.exp(-300.0 * (times % 0.1)) * np.cos(2.0 * np.pi * 2500.0 * times)
    _, ringing = spectral_kurtosis(bursts + 0.1 * noise, 1.0 / rate, 64)
    assert ringing[16] > 3.0
    assert np.abs(ringing[29:31]).max() < 0.3
    with pytest.raises(CouplingError, match="windows of"):
        spectral_kurtosis(noise[:100], 1.0 / rate, 64)


def test_an_envelope_has_the_lines_of_its_modulation() -> None:
    """(1 + m cos)² a² is a² (1 + m²/2), 2 m a² and ½ m² a² at 0, 1 and 2 times the modulation."""
    rate, count, m, a = 10e3, 20_000, 0.6, 2.0
    times = np.arange(count) / rate
    carrier = a * (1.0 + m * np.cos(2.0 * np.pi * 37.0 * times)) * np.cos(2.0 * np.pi * 2500.0 * times)
    frequencies, lines = envelope_spectrum(carrier + np.cos(2.0 * np.pi * 300.0 * times), 1.0 / rate, (2000.0, 3000.0))
    at = {f: float(lines[np.argmin(np.abs(frequencies - f))]) for f in (0.0, 37.0, 74.0, 111.0)}
    assert at[0.0] == pytest.approx(a**2 * (1.0 + 0.5 * m**2), rel=1e-9)
    assert at[37.0] == pytest.approx(2.0 * m * a**2, rel=1e-9)
    assert at[74.0] == pytest.approx(0.5 * m**2 * a**2, rel=1e-9)
    assert at[111.0] < 1e-9
    with pytest.raises(CouplingError, match="half the sampling rate"):
        envelope_spectrum(carrier, 1.0 / rate, (2000.0, 6000.0))


@pytest.mark.parametrize(
    ("samples", "teeth", "said"),
    [(MESH[:48], TEETH, "more than 48 samples"), (np.full(N, np.nan), TEETH, "finite"), (MESH, 2, "at least 3")],
)
def test_averages_that_cannot_be_are_refused(samples: np.ndarray, teeth: int, said: str) -> None:
    with pytest.raises(CouplingError, match=said):
        SynchronousAverage(samples, teeth)


def test_the_envelope_under_hanns_window_has_the_height_of_a_tone_between_lines() -> None:
    """A carrier of depth m modulated at f: the squared envelope 1 + 2 m cos + m² cos² has a line of 2 m at f.

    No whole number of periods of 123.7 Hz lies in the record; its mean is 1 + m²/2 but for a part of a period.
    """
    rate, depth, tone = 16384.0, 0.4, 123.7
    times = np.arange(4000) / rate
    signal = (1.0 + depth * np.cos(2.0 * np.pi * tone * times)) * np.cos(2.0 * np.pi * 2500.0 * times)
    frequencies, lines = envelope_spectrum(signal, 1.0 / rate, (2000.0, 3000.0), hann=True)
    highest = int(np.argmax(lines[1:])) + 1
    assert frequencies[highest] == pytest.approx(tone, abs=0.6 * rate / 16000)
    assert lines[highest] == pytest.approx(2.0 * depth, rel=0.02)
    assert lines[0] == pytest.approx(1.0 + 0.5 * depth**2, rel=0.02)


def _lines(samples: np.ndarray, orders: list[int]) -> np.ndarray:
    """What a signal has of some orders, by least squares of their cosines and sines."""
    angles = 2.0 * np.pi * np.arange(len(samples)) / len(samples)
    columns = np.column_stack([wave(order * angles) for order in orders for wave in (np.cos, np.sin)])
    return columns @ np.linalg.lstsq(columns, samples)[0]


def test_indicators_are_those_of_their_definitions_by_another_way() -> None:
    """Of random signals, by fits of single orders and moments of scipy: Zakrajsek 1993, Vecer 2005."""
    rng = np.random.default_rng(8)
    harmonics, other = [TEETH, 2 * TEETH, 3 * TEETH], [31, 62, 93]
    records, residuals = [], []
    for size in (1.0, 1.3, 2.0):
        samples = 0.4 + 5.0 * np.cos(TEETH * ANGLES) + size * np.convolve(rng.normal(size=N), np.ones(9), "same")
        records.append(SynchronousAverage(samples, TEETH, 3, (31,)))
        residuals.append(samples - samples.mean() - _lines(samples, [1, 2, *harmonics, *other]))
    last, sides = records[-1], [order + side for order in (*harmonics, *other) for side in (-1, 1)]
    np.testing.assert_allclose(last.residual, residuals[-1], atol=1e-9)
    difference = residuals[-1] - _lines(residuals[-1], sides)
    regular = _lines(last.samples, [*harmonics, *other, *sides])
    assert last.energy_ratio == pytest.approx(np.sqrt(stats.moment(difference, 2) / stats.moment(regular, 2)), rel=1e-9)
    assert last.fm4 == pytest.approx(stats.kurtosis(difference, fisher=False), rel=1e-9)
    assert last.m6a == pytest.approx(stats.moment(difference, 6) / stats.moment(difference, 2) ** 3, rel=1e-9)
    assert last.m8a == pytest.approx(stats.moment(difference, 8) / stats.moment(difference, 2) ** 4, rel=1e-9)
    mean_square = np.mean([stats.moment(one, 2) for one in residuals])
    assert na4(records) == pytest.approx(stats.moment(residuals[-1], 4) / mean_square**2, rel=1e-9)
    first = [np.sqrt(2.0) * np.std(_lines(last.samples, [TEETH + side])) for side in (-1, 1)]
    assert last.sideband_index == pytest.approx(np.mean(first), rel=1e-9)
    assert last.sideband_level_factor == pytest.approx(sum(first) / np.std(last.samples), rel=1e-9)
    meshes = [np.sqrt(2.0) * np.std(_lines(last.samples, [order])) for order in harmonics]
    assert last.fm0 == pytest.approx((last.samples.max() - last.samples.min()) / sum(meshes), rel=1e-9)


def test_spectral_kurtosis_is_that_of_windows_transformed_one_by_one() -> None:
    """Antoni 2006: windows begin at each fourth of their length, as far as they lie in the signal."""
    signal, window = np.random.default_rng(9).normal(size=1000) ** 3, 64
    frequencies, found = spectral_kurtosis(signal, 1e-3, window)
    hann = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(window) / (window - 1))
    begins = range(0, 1000 - window + 1, window // 4)
    power = np.array([np.abs(np.fft.rfft(hann * signal[at : at + window])) ** 2 for at in begins])
    np.testing.assert_allclose(found, np.mean(power**2, axis=0) / np.mean(power, axis=0) ** 2 - 2.0, rtol=1e-9)
    np.testing.assert_allclose(frequencies, np.fft.rfftfreq(window, 1e-3))


def test_the_envelope_of_a_band_from_zero_has_the_constant_once() -> None:
    """|c + a e^(iωt)|² has the mean c² + a² and the line 2 c a at ω."""
    times = np.arange(1000) / 1e3
    _, lines = envelope_spectrum(0.5 + 2.0 * np.cos(2.0 * np.pi * 40.0 * times), 1e-3, (0.0, 100.0))
    assert lines[0] == pytest.approx(0.25 + 4.0, rel=1e-12)
    assert lines[40] == pytest.approx(2.0, rel=1e-12)
