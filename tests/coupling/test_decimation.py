"""Decimation of a record in pieces: no trace of the joints, sines kept, and what would fold back gone."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import signal

from gearwhine.coupling import CouplingError, amplitude_spectrum
from gearwhine.coupling.analyses.recording import Sampling, Signals, TransientRecord, record_spectra
from gearwhine.coupling.signals.decimation import decimation
from gearwhine.coupling.signals.spectrum import averaged_spectrum


@given(st.lists(st.integers(0, 300), max_size=12), st.sampled_from([1, 2, 3, 16]), st.integers(0, 2**32 - 1))
def test_pieces_leave_no_trace(cuts: list[int], factor: int, seed: int) -> None:
    record = np.random.default_rng(seed).normal(size=(sum(cuts), 3))
    plan = decimation(factor, 0.25)
    whole, _ = plan.through(record[:0], record)
    held, parts = record[:0], [record[:0]]
    for piece in np.split(record, np.cumsum(cuts)):
        kept, held = plan.through(held, piece)
        parts.append(kept)
    assert np.concatenate(parts).tobytes() == whole.tobytes()
    assert len(whole) == plan.kept(len(record))


@pytest.mark.parametrize("factor", [2, 8, 32])
def test_a_sine_in_the_band_is_kept_in_place_and_one_that_folds_is_gone(factor: int) -> None:
    plan = decimation(factor, 0.25)
    n = np.arange(400 * factor)
    kept_at = plan.delay + factor * np.arange(plan.kept(len(n)))
    for cycles in (0.0, 0.1, 0.25):  # per kept sample
        wave = np.cos(2.0 * np.pi * cycles / factor * n + 0.3)
        kept, _ = plan.through(np.zeros((0, 1)), wave[:, None])
        assert np.abs(kept[:, 0] - wave[kept_at]).max() < 3e-6
    for cycles in (0.75, 0.9, 1.1, 1.25):  # these would stand at 0.25 or below
        wave = np.cos(2.0 * np.pi * cycles / factor * n + 0.3)
        assert np.abs(plan.through(np.zeros((0, 1)), wave[:, None])[0]).max() < 3e-6


@pytest.mark.parametrize("factor", [2, 5, 32])
def test_the_filter_is_the_textbook_s(factor: int) -> None:
    taps = decimation(factor, 0.2).taps
    window = ("kaiser", signal.kaiser_beta(120.0))
    np.testing.assert_allclose(taps, signal.firwin(len(taps), 1.0 / factor, window=window), rtol=0.0, atol=1e-14)


@pytest.mark.parametrize(("factor", "band"), [(0, 0.25), (4, 0.5), (4, 0.0)])
def test_a_filter_that_cannot_be_is_refused(factor: int, band: float) -> None:
    with pytest.raises(CouplingError, match="decimation by"):
        decimation(factor, band)


def test_an_average_keeps_power_whatever_the_phases() -> None:
    """A sine whose phase differs from stretch to stretch keeps its height; the mean is the mean of the means."""
    times = np.arange(256) / 256.0
    phases = np.array([0.0, 1.0, 2.5, 4.0])
    stretches = np.array([[2.0 + k + 3.0 * np.sin(2.0 * np.pi * 20.0 * times + phi)] for k, phi in enumerate(phases)])
    spectrum = averaged_spectrum(iter(stretches), 1.0 / 256.0)
    assert spectrum.averages == 4
    assert spectrum.amplitude[0, 20] == pytest.approx(3.0)
    assert spectrum.amplitude[0, 0] == pytest.approx(3.5)
    assert float(spectrum.rms(128.0)[0]) == pytest.approx(3.0 / np.sqrt(2.0))


def test_the_average_of_one_is_its_spectrum() -> None:
    signal = np.random.default_rng(1).normal(size=(2, 512)) + 1.0
    for window in ("uniform", "hann"):
        one, average = amplitude_spectrum(signal, 0.1, window), averaged_spectrum([signal], 0.1, window)
        assert average.amplitude == pytest.approx(np.abs(one.amplitude), rel=1e-12)
        assert np.exp(1j * average.phase) == pytest.approx(np.exp(1j * one.phase), abs=1e-9)


class KnownRecord(TransientRecord):
    """A record of known columns, the acceleration of a sensor and the force of a mesh, in pieces."""

    @property
    def samples(self) -> int:
        """Number of stored samples."""
        return sum(len(block["columns"]) for block in self.blocks)


def known_record(columns: Any, cuts: list[int], stretch: int, factor: int) -> TransientRecord:
    """Samples from 2 s on, each 10 ms times the factor, that the filter delays by its half."""

    def with_columns(times: Any, values: Any) -> Any:
        histories = SimpleNamespace(sensor_acceleration={"top": values[:, 0]}, mesh_force={"a -> b": values[:, 1]})
        return SimpleNamespace(times=times, columns=values, histories=histories)

    settings: Any = SimpleNamespace(record_from=2.0, sample_interval=0.01)
    sampling = Sampling(settings, 100, decimation(factor, 0.25), stretch, "uniform")
    signals: Signals = SimpleNamespace(columns=columns[:0], with_columns=with_columns)  # type: ignore[assignment]
    blocks: Any = [{"columns": piece} for piece in np.split(columns, cuts)]
    return KnownRecord(sampling, blocks, signals)


@pytest.mark.parametrize("cuts", [[], [5], [7, 7, 30, 31], [40, 60, 88]])
def test_stretches_of_a_record_end_with_it_wherever_its_pieces_end(cuts: list[int]) -> None:
    """Of 89 samples in stretches of 20 the first 9 are left out; a stretch is no longer than the record."""
    columns = np.arange(178.0).reshape(89, 2)
    record = known_record(columns, cuts, 20, 4)
    stretches = [*record.stretches(), record.last_stretch()]
    for one, first in zip(stretches, (9, 29, 49, 69, 69), strict=True):
        np.testing.assert_array_equal(one.columns, columns[first : first + 20])
        numbers = record.sampling.decimation.delay + 4.0 * np.arange(first, first + 20)
        np.testing.assert_allclose(one.times, 2.0 + 0.01 * numbers)
    (whole,) = known_record(columns, cuts, 100, 4).stretches()
    np.testing.assert_array_equal(whole.columns, columns)


def test_lines_of_a_long_record_are_root_mean_squares_up_to_the_limit() -> None:
    """Stretches of 1 s, 25 samples, in which a line of 3 Hz is 1, 2 and 3 high, and one of 8 Hz always."""
    turns = 2.0 * np.pi * np.arange(75) / 25.0
    sizes = np.repeat([1.0, 2.0, 3.0], 25)
    columns = np.stack([sizes * np.cos(3.0 * turns) + 5.0, np.cos(3.0 * turns + 0.4) + 4.0 * np.cos(8.0 * turns)], 1)
    record = known_record(columns, [10, 40], 25, 4)
    of_sensors, of_meshes = record_spectra(record, record.last_stretch().histories, 5.0)
    top, mesh = of_sensors["top"], of_meshes["a -> b"]
    assert (list(of_sensors), list(of_meshes)) == (["top"], ["a -> b"])
    np.testing.assert_allclose(top.frequencies, np.arange(8.0))  # two beyond the limit
    assert (top.amplitude[3], top.amplitude[0], top.averages) == (
        pytest.approx(np.sqrt(14.0 / 3.0)),
        pytest.approx(5.0),
        3,
    )
    assert (mesh.amplitude[3], mesh.phase[3]) == (pytest.approx(1.0), pytest.approx(0.4))
    assert len(mesh.amplitude) == 8
    # A record that is short is taken whole, with all its lines.
    short = known_record(columns, [], 75, 1)
    whole = record_spectra(short, short.last_stretch().histories, 5.0)[1]["a -> b"]
    assert (len(whole.frequencies), whole.amplitude.max()) == (38, pytest.approx(4.0))
