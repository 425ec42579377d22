"""Tones between the lines of a record, against the tones that it was made of."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.signals.spectrum import Spectrum, amplitude_spectrum
from gearwhine.coupling.signals.tones import hann_tones, tones_at
from gearwhine.numerics.arrays import FloatArray

_INTERVAL, _COUNT = 1e-4, 8192  # 0.82 s, lines 1.22 Hz apart


def record(tones: dict[float, list[complex]]) -> FloatArray:
    """Signals, one for each amplitude, of tones by frequency [Hz]."""
    times = _INTERVAL * np.arange(_COUNT)
    return np.sum([np.outer(a, np.exp(2j * np.pi * hertz * times)).real for hertz, a in tones.items()], axis=0)


def spectrum_of(tones: dict[float, list[complex]]) -> Spectrum:
    return amplitude_spectrum(record(tones), _INTERVAL, "hann")


def test_two_tones_between_lines_are_found_in_frequency_amplitude_and_phase() -> None:
    tones = {200.8: [3.0 * np.exp(0.7j), 0.2 * np.exp(-1.1j)], 313.91: [0.5j, 0.8 - 0.3j]}
    spectrum = spectrum_of(tones)
    highest = spectrum.amplitude.max(axis=1)
    assert 20.0 * np.log10(highest[0] / 3.0) < -0.3  # no line holds all of it
    found = hann_tones(spectrum, [1.0, 1.0], floor=1e-3)
    assert found.frequencies == pytest.approx(list(tones), abs=1e-3)
    np.testing.assert_allclose(found.amplitudes.T, list(tones.values()), rtol=2e-3)


@given(st.floats(0.0, 1.0), st.floats(-3.0, 3.0), st.floats(4.0, 40.0), st.floats(0.1, 1.0), st.booleans())
def test_a_tone_and_a_weaker_one_are_within_a_tenth_of_a_decibel(
    offset: float, phase: float, apart: float, weak: float, above: bool
) -> None:
    first = (400 + offset) / (_INTERVAL * _COUNT)
    second = first + (apart if above else -apart) / (_INTERVAL * _COUNT)
    found = hann_tones(spectrum_of({first: [1.0], second: [weak * np.exp(1j * phase)]}), [1.0], floor=1e-2)
    order = np.argsort([first, second])
    assert found.frequencies == pytest.approx(np.array([first, second])[order], abs=0.01)
    levels = 20.0 * np.log10(np.abs(found.amplitudes[0]) / np.array([1.0, weak])[order])
    assert np.abs(levels).max() < 0.1


def test_a_tone_on_a_line_is_that_line() -> None:
    hertz = 250.0 / (_INTERVAL * _COUNT)
    found = hann_tones(spectrum_of({hertz: [2.0 - 1.0j]}), [1.0])
    assert found.frequencies == pytest.approx([hertz], rel=1e-9)
    assert found.amplitudes[0] == pytest.approx([2.0 - 1.0j], rel=1e-4)


def test_the_power_of_tones_is_that_of_the_signal() -> None:
    """The squares of the lines under the window add up to half as much again."""
    tones = {120.3: [1.0], 333.7: [0.5j], 1500.2: [0.8]}
    spectrum = spectrum_of(tones)
    whole = 0.5 * sum(abs(a) ** 2 for (a,) in tones.values())
    assert 0.5 * (spectrum.amplitude[0] ** 2).sum() == pytest.approx(1.5 * whole, rel=1e-2)
    found = hann_tones(spectrum, [1.0], floor=1e-3)
    assert 0.5 * (np.abs(found.amplitudes) ** 2).sum() == pytest.approx(whole, rel=1e-3)


def test_signals_of_no_weight_have_no_say_in_the_frequencies() -> None:
    """A signal of another unit has an amplitude at the frequencies of the others, and no tones of its own."""
    tones = {200.37: [1.0, 40.0], 260.0: [0.0, 1000.0]}
    found = hann_tones(spectrum_of(tones), [1.0, 0.0], floor=1e-3)
    assert found.frequencies == pytest.approx([200.37], abs=1e-3)
    assert found.amplitudes[:, 0] == pytest.approx([1.0, 40.0], rel=5e-2)


def test_only_hanns_window_is_interpolated() -> None:
    with pytest.raises(CouplingError, match="'uniform'; expected 'hann'"):
        hann_tones(amplitude_spectrum(record({100.0: [1.0]}), _INTERVAL), [1.0])


def test_silence_has_no_tones() -> None:
    assert len(hann_tones(amplitude_spectrum(np.zeros((2, 64)), 0.1, "hann"), [1.0, 1.0]).frequencies) == 0


def test_a_large_mean_hides_no_tone() -> None:
    found = hann_tones(amplitude_spectrum(record({313.9: [1.0]}) + 1e7, _INTERVAL, "hann"), [1.0], floor=1e-3)
    assert found.frequencies == pytest.approx([313.9], abs=1e-3)


def test_tones_of_known_frequencies_follow_from_the_lines_beside_them() -> None:
    """Between lines under Hann's window, on a line, and the nearest line without a window."""
    spacing = 1.0 / (_INTERVAL * _COUNT)
    tones = {200.8: [3.0 * np.exp(0.7j), 1.0j], 400 * spacing: [0.5j, 0.8 - 0.3j]}
    spectrum = spectrum_of(tones)
    frequencies, amplitudes = tones_at(spectrum.lines, spectrum.spacing, list(tones), spectrum.window)
    assert frequencies == pytest.approx(list(tones), rel=1e-12)
    np.testing.assert_allclose(amplitudes.T, list(tones.values()), rtol=2e-3)
    plain = amplitude_spectrum(record(tones), _INTERVAL)
    frequencies, amplitudes = tones_at(plain.lines, spacing, [399.6 * spacing], "uniform")
    assert frequencies == pytest.approx([400 * spacing])
    assert amplitudes[:, 0].tolist() == plain.lines[:, 400].tolist()
