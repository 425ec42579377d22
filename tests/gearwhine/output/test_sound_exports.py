"""Microphones in the files that a run's folder is exported to, and the sound on its terminal."""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff
from scipy.io import wavfile
from sounding_gearbox import QUICK, heard_run

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.cli.command_line import run_command
from gearwhine.output.export import write_sounds
from gearwhine.results_folder import export_results, export_sections

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("mechanisms_left_out")]

Exported = tuple[Path, dict[str, Any]]


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Exported:
    folder = tmp_path_factory.mktemp("heard")
    heard_run().write(folder, pictures=False)
    return folder / "exports", export_results(folder)


def test_a_microphone_is_exported_like_a_sensor(exported: Exported) -> None:
    place, _ = exported
    data = heard_run().dataset
    file = pyuff.UFF(str(place / "run.uff"))
    found = [file.read_sets(int(index)) for index in np.flatnonzero(file.get_set_types() == 58)]
    own = [one for one in found if one["rsp_node"] == 3]  # behind two sensors
    assert [one["rsp_ent_name"].strip() for one in own] == ["ear", "ear"]
    (history,) = (one for one in own if one["func_type"] == 1)
    assert (history["ordinate_spec_data_type"], history["ordinate_axis_units_lab"].strip()) == (15, "Pa")
    assert "ear" in history["id1"]
    np.testing.assert_array_equal(history["data"], data["microphone_pressure"].sel(microphone="ear").values)
    np.testing.assert_allclose(history["x"], data["microphone_time"].values, rtol=1e-5)
    (spectrum,) = (one for one in own if one["func_type"] == 12)
    parts = data["sound_pressure"].sel(microphone="ear").values
    np.testing.assert_array_equal(spectrum["data"], parts[:, 0] + 1j * parts[:, 1])
    np.testing.assert_array_equal(spectrum["x"], data["sound_frequency"].values)
    # Sensors are where they were.
    assert {one["rsp_node"] for one in found if one["ordinate_spec_data_type"] == 12} == {1, 2}
    points = file.read_sets(int(np.flatnonzero(file.get_set_types() == 2411)[0]))
    assert [points[axis][2] for axis in "xyz"] == [0.1, 1.2, 0.2]
    assert [points[axis][0] for axis in "xyz"] == pytest.approx([0.02, 0.16, 0.03])


def test_tables_of_the_microphone_have_all_digits(exported: Exported) -> None:
    place, _ = exported
    (microphone,) = heard_run().document["sound"]["microphones"]
    with (place / "run-Sound-All-lines-at-the-microphones.csv").open(encoding="utf-8", newline="") as file:
        (row,) = csv.DictReader(file)
    assert (row["microphone"], float(row["sound pressure [dB re 20 µPa]"])) == ("ear", microphone["level_db"])
    with (place / "run-Sound-Loudest-lines-at-each-microphone.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    loudest = max(heard_run().document["sound"]["lines"], key=lambda line: float(line["microphones_db"]["ear"]))
    assert rows[0]["microphone"] == "ear"
    assert float(rows[0]["line [Hz]"]) == loudest["frequency_hz"]
    assert float(rows[0]["sound pressure [dB re 20 µPa]"]) == loudest["microphones_db"]["ear"]


def test_sounds_are_told_in_their_own_unit(exported: Exported) -> None:
    place, document = exported
    (written,) = [one for one in document["sounds"] if "microphone" in one]
    rate, samples = wavfile.read(place / written["file"])
    assert np.abs(samples * written["full_scale_pa"]).max() == pytest.approx(written["peak_pa"], rel=1e-6)
    assert len(samples) / rate == pytest.approx(written["seconds"])
    (section,) = export_sections(document)
    (table,) = [one for one in section.tables if one.caption.startswith("Sounds")]
    columns, texts = table.filled()
    rows = [dict(zip((column.heading for column in columns), row, strict=True)) for row in texts]
    (ear,) = [row for row in rows if row["sensor or microphone"] == "ear"]
    assert (ear["unit"], ear["peak"]) == ("Pa", f"{written['peak_pa']:.3g}")
    (top,) = [one for one in document["sounds"] if one.get("sensor") == "top"]
    (row,) = [row for row in rows if row["sensor or microphone"] == "top"]
    assert (row["unit"], row["rms"]) == ("m/s²", f"{top['rms_m_per_s2']:.3g}")


def test_a_steady_record_is_repeated_at_its_own_level(exported: Exported, tmp_path: Path) -> None:
    """Eight turns at 5500 rpm last 87 ms; repeated for seconds every line keeps its level, and the file its scale."""
    place, document = exported
    own = tmp_path / "once"
    own.mkdir()
    once = {one["file"]: one for one in write_sounds(place.parent, own, seconds=0.0)}
    assert len(once) == len(document["sounds"])
    for one in document["sounds"]:
        short = once[one["file"]]  # with the same full scale in its name
        assert short["periods"] == 1
        assert short["seconds"] == pytest.approx(8.0 * 60.0 / 5500.0, abs=1e-4)
        assert one["seconds"] >= 5.0 - 1e-4
        assert one["seconds"] == pytest.approx(one["periods"] * 8.0 * 60.0 / 5500.0, abs=1e-4)
        unit = "pa" if "microphone" in one else "m_per_s2"
        assert one[f"rms_{unit}"] == pytest.approx(short[f"rms_{unit}"], rel=0.03)
    # A window over all of it finds every line of the sound at the level that the document has.
    (ear,) = [one for one in document["sounds"] if "microphone" in one]
    rate, samples = wavfile.read(place / ear["file"])
    window, times = np.hanning(len(samples)), np.arange(len(samples)) / rate
    loudest = sorted(heard_run().document["sound"]["lines"], key=lambda line: -line["microphones_db"]["ear"])[:3]
    for line in loudest:
        rotating = np.exp(-2j * np.pi * line["frequency_hz"] * times)
        amplitude = 2.0 * abs(np.sum(window * samples * ear["full_scale_pa"] * rotating)) / window.sum()
        level = 20.0 * np.log10(amplitude / np.sqrt(2.0) / 20e-6)
        assert level == pytest.approx(line["microphones_db"]["ear"], abs=0.05)


def test_lengths_that_are_none_and_folders_without_signals_are_told(exported: Exported, tmp_path: Path) -> None:
    place, _ = exported
    with pytest.raises(CaseError, match="a length of sound files from 0 to 600 s"):
        export_results(place.parent, formats=("wav",), seconds=-1.0)
    gw.load("steel-box", {"housing.box.mesh_size": "60 mm"}).modes().write(tmp_path / "modes", pictures=False)
    with pytest.raises(CaseError, match=r"with sensors, or with \[acoustics\], in_run = true and microphones"):
        export_results(tmp_path / "modes", formats=("wav",))


def test_the_command_tells_the_sound_of_its_record(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    changes = {"acoustics.method": "erp", "acoustics.mesh_size": QUICK["acoustics.mesh_size"]}
    changes |= {"acoustics.highest_frequency": "2 kHz", "transient.tolerance": "1e-3"}
    changes |= {"housing.box.mesh_size": "45 mm"}
    arguments = ["run", "small-gearbox", "--no-pictures", "-q", "-o", str(tmp_path / "out")]
    assert run_command(arguments + [f"--set={key}={value}" for key, value in changes.items()]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "Sound power level L_W of" in said
    assert "dB re 1 pW, A-weighted L_WA" in said
    assert "Loudest lines of the sound" in said
    # The mesh frequency is above 2 kHz, and holds nearly all of the sound.
    assert "Left out: 100 % of the power by the estimate, most of it 1× pinion → wheel at 2567 Hz (100 %)" in said
    assert "2× pinion → wheel at 5133 Hz, 3× pinion → wheel at 7700 Hz, where the housing's modes are not" in said
