"""Signals resampled for sound files and their full scale, and exports of folders that hold nothing for them."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearwhine.cli import run_command
from gearwhine.output.export import full_scale, resampled


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
