"""Peaks of spectra: lines of whole periods, tones between lines under Hann's window, and what is no lone tone."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearwhine.coupling.signals.peaks import spectral_peaks
from gearwhine.coupling.signals.spectrum import Spectrum, amplitude_spectrum, averaged_spectrum
from gearwhine.numerics.arrays import FloatArray

_INTERVAL, _COUNT = 1e-3, 2000  # 2 s, lines 0.5 Hz apart
_TIMES = _INTERVAL * np.arange(_COUNT)


def tone(hertz: float, amplitude: complex) -> FloatArray:
    return np.asarray((amplitude * np.exp(2j * np.pi * hertz * _TIMES)).real)


def lines(*amplitudes: float) -> Spectrum:
    a = np.array(amplitudes)
    return Spectrum(10.0 * np.arange(a.size, dtype=np.float64), a, np.zeros(a.size), "uniform")


def test_peaks() -> None:
    spectrum = lines(9.0, 0.1, 3.0, 0.2, 5.0, 4.0, 4.5, 0.1, 0.004, 0.001, 8.0)
    found = [(peak.frequency, peak.amplitude) for peak in spectral_peaks(spectrum).rows]
    # Highest first; the mean and the last line have one neighbour each and are no peaks; 0.004 is below the floor.
    assert found == [(40.0, 5.0), (60.0, 4.5), (20.0, 3.0)]
    assert spectral_peaks(spectrum, count=2).frequencies.tolist() == [40.0, 60.0]
    assert spectral_peaks(spectrum, above=20.0, limit=60.0).frequencies.tolist() == [40.0, 60.0]
    assert spectral_peaks(spectrum, limit=59.0).frequencies.tolist() == [40.0, 20.0]
    assert len(spectral_peaks(spectrum, count=0)) == 0
    assert len(spectral_peaks(spectrum, above=1e3)) == 0
    assert spectral_peaks(lines(0.0, 1.0, 0.0, 1e-4, 0.0), floor=1e-5).frequencies.tolist() == [10.0, 30.0]
    assert len(spectral_peaks(lines(0.0, 0.0, 0.0, 0.0))) == 0
    # Two equal neighbours are one peak.
    assert spectral_peaks(lines(0.0, 2.0, 2.0, 0.0)).frequencies.tolist() == [20.0]


@given(st.floats(3.0, 990.0), st.floats(-3.0, 3.0), st.floats(1e-3, 1e3))
def test_a_tone_anywhere_between_the_lines_has_its_frequency_height_and_phase(
    place: float, phase: float, size: float
) -> None:
    amplitude = size * np.exp(1j * phase)
    spectrum = amplitude_spectrum(tone(0.5 * place, amplitude), _INTERVAL, "hann")
    peaks = spectral_peaks(spectrum, count=1)
    assert peaks.frequencies == pytest.approx([0.5 * place], abs=0.01)
    assert peaks.amplitudes == pytest.approx([size], rel=0.01)
    np.testing.assert_allclose(peaks.of(spectrum.lines), [amplitude], rtol=0.02)


def test_parts_of_a_signal_add_up_to_its_peaks() -> None:
    """Two parts of a tone at 100.2 Hz with noise, each under its own phase."""
    noise = np.random.default_rng(1).normal(size=(2, _COUNT))
    parts = np.array([tone(100.2, 3.0), tone(100.2, 1.0 - 2.0j)]) + 0.1 * noise
    spectra = amplitude_spectrum(np.vstack([parts, parts.sum(axis=0)]), _INTERVAL, "hann")
    peaks = spectral_peaks(amplitude_spectrum(parts.sum(axis=0), _INTERVAL, "hann"), count=1)
    first, second, whole = peaks.of(spectra.lines)[:, 0]
    assert first + second == pytest.approx(whole, rel=1e-12)
    assert first == pytest.approx(3.0, rel=0.01)
    assert second == pytest.approx(1.0 - 2.0j, rel=0.01)


def test_whole_periods_keep_their_lines() -> None:
    """Leakage of another tone beside a line under no window moves it no more than it raises it."""
    spectrum = amplitude_spectrum(tone(100.0, 2.0) + tone(110.0, 1.5j), _INTERVAL)
    peaks = spectral_peaks(spectrum, count=2)
    assert peaks.frequencies.tolist() == [100.0, 110.0]
    assert peaks.of(spectrum.lines) == pytest.approx([2.0, 1.5j], rel=1e-9)


def test_what_is_no_lone_tone_is_its_own_line() -> None:
    """A ring-down of a wide peak, and two equal tones a line and a half apart."""
    ring_down = np.exp(-20.0 * _TIMES) * tone(100.2, 1.0)
    beat = tone(200.1, 1.0) + tone(200.85, 1.0)
    for signal in (ring_down, beat):
        spectrum = amplitude_spectrum(signal, _INTERVAL, "hann")
        (peak,) = spectral_peaks(spectrum, count=1).rows
        place = int(np.argmax(spectrum.amplitude[1:])) + 1
        assert peak == (spectrum.frequencies[place], spectrum.amplitude[place])
    # Equal tones two and a half lines apart are two peaks, neither of which is raised above both together.
    two = spectral_peaks(amplitude_spectrum(tone(200.1, 1.0) + tone(201.4, 1.0), _INTERVAL, "hann"), count=2)
    assert (two.amplitudes < 1.3).all()


def test_the_average_over_stretches_has_the_height_of_a_tone_whose_phase_differs_in_each() -> None:
    stretches = [tone(100.2, 2.0 * np.exp(1j * phase)) for phase in (0.0, 1.0, 2.5, 4.0)]
    (peak,) = spectral_peaks(averaged_spectrum(stretches, _INTERVAL, "hann"), count=1).rows
    assert peak.frequency == pytest.approx(100.2, abs=1e-3)
    assert peak.amplitude == pytest.approx(2.0, rel=1e-3)


@pytest.mark.parametrize("place", [200.0, 200.25, 200.5, 200.9])
def test_a_tone_is_known_within_a_part_of_the_spacing(place: float) -> None:
    """Noise and a tone seven lines off move it as they disturb its lines; a ring-down has half a spacing."""
    alone = spectral_peaks(amplitude_spectrum(tone(0.5 * place, 1.0), _INTERVAL, "hann"), count=1)
    assert alone.resolution[0] <= 0.1 * 0.5
    assert abs(alone.frequencies[0] - 0.5 * place) <= alone.resolution[0]
    noise = 0.4 * np.random.default_rng(3).normal(size=_COUNT)
    disturbed = tone(0.5 * place, 1.0) + tone(0.5 * (place + 7.3), 1.0) + noise
    peaks = spectral_peaks(amplitude_spectrum(disturbed, _INTERVAL, "hann"), count=2)
    (at,) = np.flatnonzero(np.abs(peaks.frequencies - 0.5 * place) < 0.5)
    assert abs(peaks.frequencies[at] - 0.5 * place) <= peaks.resolution[at] < 0.25
    ring_down = spectral_peaks(
        amplitude_spectrum(np.exp(-20.0 * _TIMES) * tone(0.5 * place, 1.0), _INTERVAL, "hann"), count=1
    )
    assert ring_down.resolution == pytest.approx([0.25], rel=1e-5)


def test_a_tone_beside_a_louder_one_is_known_less_well() -> None:
    """Four times as loud, a tone 3.2 lines off moves this one by more than a lone tone is known within."""
    both = tone(0.5 * 200.5, 1.0) + tone(0.5 * 203.7, 4.0)
    peaks = spectral_peaks(amplitude_spectrum(both, _INTERVAL, "hann"), count=2)
    (at,) = np.flatnonzero(np.abs(peaks.frequencies - 0.5 * 200.5) < 0.25)
    assert 0.05 * 0.5 < abs(peaks.frequencies[at] - 0.5 * 200.5) <= peaks.resolution[at] < 0.1
