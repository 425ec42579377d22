"""Signals resampled for sound files and their full scale, and exports of folders that hold nothing for them."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from gearwhine.cli import run_command
from gearwhine.output import file_stems
from gearwhine.output.export import full_scale, low_passed, periods, repeated, resampled


@given(st.floats(50.0, 15e3), st.floats(0.0, 6.0), st.sampled_from([1 / 163840, 1 / 44100, 1 / 96e3, 1.9e-5]))
def test_a_sine_keeps_pitch_phase_and_amplitude(frequency: float, phase: float, interval: float) -> None:
    signal = np.sin(2 * np.pi * frequency * interval * np.arange(int(0.05 / interval)) + phase)
    found = resampled(signal, interval, 48_000)
    middle = slice(len(found) // 4, 3 * len(found) // 4)
    expected = np.sin(2 * np.pi * frequency * np.arange(len(found)) / 48_000 + phase)
    np.testing.assert_allclose(found[middle], expected[middle], atol=2e-4)


def test_a_sine_above_the_audio_band_is_silent() -> None:
    signal = np.sin(2 * np.pi * 40e3 / 163840 * np.arange(16384))
    found = resampled(signal, 1 / 163840, 48_000)
    assert np.abs(found[len(found) // 4 : 3 * len(found) // 4]).max() < 1e-4


def test_a_period_loses_its_lines_above_the_limit_alone() -> None:
    times = np.arange(4096) / 4096 * 0.02  # 50 Hz between lines
    low, high = np.cos(2 * np.pi * 3000 * times + 0.4), 20.0 * np.cos(2 * np.pi * 3050 * times)
    found = low_passed(low + high, times[1], 3000.0, repeats=True)
    np.testing.assert_allclose(found, low, atol=1e-12)
    assert np.array_equal(low_passed(low + high, times[1], 1e6, repeats=True), low + high)


def test_a_record_without_period_is_cut_off_at_the_limit() -> None:
    times = np.arange(40_000) * 5e-6
    low, high = np.cos(2 * np.pi * 2990 * times + 0.4), 20.0 * np.cos(2 * np.pi * 3310 * times)
    found = low_passed(low + high, times[1], 3000.0, repeats=False)
    middle = slice(10_000, 30_000)
    np.testing.assert_allclose(found[middle], low[middle], atol=1e-3)


@given(st.floats(1e-9, 1e9))
def test_full_scale_is_the_next_round_number(peak: float) -> None:
    scale = full_scale(peak)
    assert peak <= scale <= 2.5 * peak * (1.0 + 1e-12)
    assert f"{scale:.15e}"[0] in "125"


def test_what_is_not_there_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["export", "small-gearbox", "-q", "-o", str(tmp_path / "none")]) == 2
    assert "as `gearwhine run CASE -o" in capsys.readouterr().err
    assert run_command(["check", "small-gearbox", "-q", "-o", str(tmp_path / "out")]) == 0
    assert run_command(["export", "small-gearbox", "-q", "--wav", "-o", str(tmp_path / "out")]) == 2
    assert "results with what can be written as wav" in capsys.readouterr().err
    assert not (tmp_path / "out" / "exports").exists()


def test_a_period_is_repeated_without_a_seam() -> None:
    """Three harmonics of 37 Hz, known at every time: 185 periods of 2,000 samples are 5 s."""
    count, period = 2000, 1.0 / 37.0

    def sound(times: np.ndarray) -> np.ndarray:
        w = 2.0 * np.pi * 37.0
        return np.sin(w * times + 0.3) + 0.5 * np.cos(11.0 * w * times) + 0.2 * np.sin(60.0 * w * times - 1.0)

    signal = sound(period / count * np.arange(count))
    assert periods(period, 5.0, 48_000) == 185
    found = repeated(signal, period / count, 48_000, 185)
    assert len(found) == 240_000
    # It begins at the sample next to a period's beginning.
    shift = round(48_000 * period) / 48_000 - period
    shifts = [shift, *(round(n * 48_000 * period) / 48_000 - n * period for n in (2, 3))]
    errors = [np.abs(found - sound(np.arange(240_000) / 48_000 + one)).max() for one in shifts]
    assert min(errors) < 1e-4
    # Played again and again there is no seam: the next sample is the first one.
    assert (
        np.abs(found[:100] - sound(np.arange(240_000, 240_100) / 48_000 + shifts[int(np.argmin(errors))])).max() < 1e-4
    )
    assert np.sqrt(np.mean(found**2)) == pytest.approx(np.sqrt(np.mean(signal**2)), rel=1e-5)
    assert np.array_equal(repeated(signal, period / count, 48_000, 0), resampled(signal, period / count, 48_000))


def test_the_number_of_periods_closes_the_loop_best() -> None:
    assert periods(0.5, 5.0, 48_000) == 10
    assert periods(0.5, 0.0, 48_000) == 1
    assert periods(12.0, 5.0, 48_000) == 1
    # 480.25 samples a period: four of them are whole, and 52 the first multiple of four that lasts 0.5 s.
    assert periods(480.25 / 48_000, 0.5, 48_000) == 52
    assert periods(480.0 / 48_000, 0.5, 48_000) == 50


@given(st.lists(st.text("aB3- /", max_size=6), max_size=8))
@example(["a b", "a-b-3", "a/b"])
@example(["a b", "a-b-3", "a-b-3-3", "a/b"])
def test_every_name_has_a_file_of_its_own(names: list[str]) -> None:
    stems = file_stems(names, "signal-")
    assert len({stem.lower() for stem in stems}) == len(names)
