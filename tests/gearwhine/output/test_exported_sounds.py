"""Histories beyond the frequency up to which modes are complete: cut off in sounds, marked in files, warned of."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff
from scipy.io import wavfile
from sounding_gearbox import small_gearbox

from gearwhine.results_folder import export_results, export_sections

pytestmark = pytest.mark.slow

LIMIT = 3000.0
# The third harmonic of 1400 Hz meets a mode beyond the limit of 3 kHz.
FAST = {"operation.speed": "3000 rpm", "transient.revolutions": 14, "transient.discard": 4}


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, dict[str, Any], Path]:
    """A run, and what its folder is exported to."""
    folder = tmp_path_factory.mktemp("loud")
    run = small_gearbox().changed(FAST).simulate()
    run.write(folder, pictures=False)
    return run, export_results(folder, ("uff", "wav")), folder / "exports"


def test_a_sound_has_the_rms_that_the_run_tells(exported: tuple[Any, dict[str, Any], Path]) -> None:
    run, document, place = exported
    assert run.document["trusted_below_hz"] == LIMIT
    assert run.document["record"]["spectra"]["window"] == "uniform"
    told = {sensor["name"]: sensor["rms_m_per_s2"] for sensor in run.document["sensors"]}
    for sound in document["sounds"]:
        rate, samples = wavfile.read(place / sound["file"])
        signal = samples.astype(np.float64) * sound["full_scale_m_per_s2"]
        assert np.sqrt(np.mean(signal**2)) == pytest.approx(told[sound["sensor"]], rel=5e-3)
        assert sound["rms_m_per_s2"] == pytest.approx(told[sound["sensor"]], rel=5e-3)
        lines = np.abs(np.fft.rfft(signal * np.hanning(len(signal))))
        frequencies = np.fft.rfftfreq(len(signal), 1.0 / rate)
        assert lines[frequencies > LIMIT + 10.0].max() < 1e-3 * lines.max()
        assert b"complete below 3000 Hz" in (place / sound["file"]).read_bytes()
        assert sound["complete_below_hz"] == LIMIT
    (section,) = export_sections(document)
    (table,) = [one for one in section.tables if one.caption.startswith("Sounds")]
    columns, texts = table.filled()
    at = [column.heading for column in columns].index("complete below [Hz]")
    assert {row[at] for row in texts} == {"3000"}


def test_histories_are_marked_with_the_limit(exported: tuple[Any, dict[str, Any], Path]) -> None:
    _, _, place = exported
    file = pyuff.UFF(str(place / "simulate.uff"))
    found = [file.read_sets(int(index)) for index in np.flatnonzero(file.get_set_types() == 58)]
    histories = [one for one in found if one["func_type"] == 1]
    assert len(histories) == 2
    assert all("complete below 3000 Hz" in one["id3"] for one in histories)


def test_power_beyond_the_limit_is_warned_of(exported: tuple[Any, dict[str, Any], Path]) -> None:
    run, _, _ = exported
    (warned,) = [entry for entry in run.document["warnings"] if entry["name"] == "power beyond the limit"]
    told = {sensor["name"]: sensor["rms_m_per_s2"] for sensor in run.document["sensors"]}
    acceleration = run.dataset["sensor_acceleration"].values.astype(np.float64)
    whole = dict(zip(run.dataset["sensor"].values.tolist(), acceleration.std(axis=1), strict=True))
    assert warned["parts"]
    for name, part in warned["parts"].items():
        assert part == pytest.approx(1.0 - (told[name] / whole[name]) ** 2, rel=1e-3)
        assert part > 0.5
