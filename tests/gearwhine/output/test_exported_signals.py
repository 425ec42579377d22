"""Universal files and sound files of signals by hand: points, directions, units, remarks, levels and comments."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff
import xarray as xr
from scipy.io import wavfile

from gearwhine.output import export
from gearwhine.output.export import write_sounds, write_universal_files
from gearwhine.output.store import DATA

RATE, COUNT, LIMIT = 20_000.0, 2000, 3000.0  # a record of 0.1 s
TIMES = np.arange(COUNT) / RATE
LOW, HIGH = np.sin(2.0 * np.pi * 500.0 * TIMES + 0.3), np.cos(2.0 * np.pi * 4000.0 * TIMES)
PHASES = np.array([[0.1, 0.2, 0.3], [-0.4, 0.5, 0.6]])


def _results(folder: Path, monkeypatch: pytest.MonkeyPatch, window: str = "uniform", **left_out: str) -> Path:
    """Results of a run: two sensors, a microphone, a bearing's force and a transmissibility."""
    spectrum = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    frequencies = ("line", [100.0, 200.0, 300.0], {"units": "Hz"})
    of_error = np.arange(6.0).reshape(2, 3, 1)
    limits = {"units": "m/s2", "long_name": "acceleration of sensors", "trusted_below_hz": LIMIT}
    data = xr.Dataset(
        {
            "sensor_acceleration": (("sensor", "time"), [2.0 + 3.0 * LOW + 5.0 * HIGH, 0.25 * LOW], limits),
            "sensor_spectrum": (("sensor", "line"), spectrum, {"units": "m/s2", "window": "hann"}),
            "sensor_spectrum_phase": (("sensor", "line"), PHASES, {"units": "rad"}),
            "transmissibility_sensor": (("sensor", "line", "mesh_error"), of_error, {"units": "m s-2 m-1"}),
            "transmissibility_sensor_phase": (("sensor", "line", "mesh_error"), 0.0 * of_error + np.pi, {}),
            "bearing_force": (("bearing", "time"), [LOW], {"units": "N"}),
            "modal_motion": (("mode", "time"), [LOW], {"units": "m"}),
            "sensor_position": (("sensor", "axis"), [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]]),
            "sensor_direction": (("sensor", "axis"), [[0.0, -1.0, 0.0], [0.6, 0.8, 0.0]]),
            "microphone_position": (("axis", "microphone"), [[1.0], [2.0], [3.0]]),
            "microphone_pressure": (("microphone", "microphone_time"), [0.03 * LOW], {"units": "Pa"}),
            "sound_pressure": (("sound_line", "microphone", "part"), [[[3.0, -4.0]], [[1.0, 2.0]]], {"units": "Pa"}),
            "sound_frequency": ("sound_line", [500.0, 900.0], {"units": "Hz"}),
        },
        {
            "time": ("time", TIMES, {"units": "s"}),
            "microphone_time": ("microphone_time", TIMES, {"units": "s"}),
            "line": frequencies,
            "sensor": ["top", "side"],
            "microphone": ["ear"],
            "bearing": ["front"],
            "mesh_error": ["pinion -> wheel"],
            "mode": [1],
        },
    ).drop_vars([*left_out.values()])
    (folder / "exports").mkdir(parents=True)
    data.to_netcdf(folder / DATA, engine="h5netcdf")
    document = {"command": "run", "record": {"spectra": {"window": window}}}
    monkeypatch.setattr(export, "stored_results", lambda _: [("", document)])
    return folder


def _functions(path: Path) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    file = pyuff.UFF(str(path))
    kinds = file.get_set_types()
    functions = [file.read_sets(int(number)) for number in np.flatnonzero(kinds == 58)]
    return functions, file.read_sets(int(np.flatnonzero(kinds == 2411)[0]))


def test_functions_have_the_points_directions_and_units_of_what_was_measured(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = _results(tmp_path / "out", monkeypatch)
    assert write_universal_files(folder, folder / "exports") == [{"file": "run.uff", "functions": 8}]
    functions, points = _functions(folder / "exports" / "run.uff")
    assert [points[axis].tolist() for axis in "xyz"] == [[0.1, 0.4, 1.0], [0.2, 0.5, 2.0], [0.3, 0.6, 3.0]]
    # A direction along an axis has its number and sign, one between axes and a microphone none.
    at = [(one["rsp_ent_name"].strip(), one["rsp_node"], one["rsp_dir"]) for one in functions]
    assert at == [("top", 1, -2), ("side", 2, 0)] * 3 + [("ear", 3, 0)] * 2
    assert [one["ordinate_axis_lab"] for one in functions][::2] == [
        "sensor acceleration",
        "sensor",
        "sensor",
        "microphone pressure",
    ]
    assert [one["func_type"] for one in functions] == [1, 1, 12, 12, 4, 4, 1, 12]
    units = [one["ordinate_axis_units_lab"].strip() for one in functions]
    assert units == ["m/s2"] * 6 + ["Pa"] * 2
    history, _, spectrum, _, of_error, _, heard, lines = functions
    np.testing.assert_allclose(history["data"], 2.0 + 3.0 * LOW + 5.0 * HIGH)
    assert (history["id1"], history["id2"]) == ("top", "acceleration of sensors")
    assert history["id3"] == f"sampling interval {1.0 / RATE!r} s; complete below 3000 Hz"
    np.testing.assert_allclose(spectrum["data"], np.array([1.0, 2.0, 3.0]) * np.exp(1j * PHASES[0]))
    np.testing.assert_allclose(spectrum["x"], [100.0, 200.0, 300.0])
    assert spectrum["id3"] == "window hann; amplitudes are peaks, phases at t = 0"
    np.testing.assert_allclose(of_error["data"], [0.0, -1.0, -2.0], atol=1e-12)
    assert (of_error["id1"], of_error["id3"]) == ("top, pinion -> wheel", "amplitudes are peaks")
    assert of_error["ref_ent_name"].strip() == "mesh"
    assert of_error["orddenom_axis_lab"].strip() == "transmission error"
    assert of_error["orddenom_axis_units_lab"].strip() == "m"
    np.testing.assert_allclose(heard["data"], 0.03 * LOW)
    np.testing.assert_allclose(lines["data"], [3.0 - 4.0j, 1.0 + 2.0j])
    np.testing.assert_allclose(lines["x"], [500.0, 900.0])
    assert (lines["id1"], lines["id2"]) == ("ear", "sound pressure of the lines")
    # What is asked for besides: forces of bearings, not what stands along numbers, as of modes.
    (told,) = write_universal_files(folder, folder / "exports", "all")
    assert told["functions"] == 9
    (force,) = (one for one in _functions(folder / "exports" / "run.uff")[0] if one["rsp_ent_name"].strip() == "front")
    assert (force["ordinate_axis_units_lab"].strip(), force["rsp_node"]) == ("N", 0)


def test_sensors_without_points_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = _results(tmp_path / "out", monkeypatch, a="sensor_position", b="microphone_position", c="sound_pressure")
    (told,) = write_universal_files(folder, folder / "exports")
    assert told == {"file": "run.uff", "functions": 7, "without_point": ["top", "side"]}


def test_a_sound_has_its_level_its_length_and_its_comment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The mean and what is above the limit are left out: 3 m/s² at 500 Hz, in ten periods of 0.1 s."""
    folder = _results(tmp_path / "out", monkeypatch)
    top, side, ear = write_sounds(folder, folder / "exports", seconds=1.0)
    assert top["file"] == "run-top-full-scale-5-m-per-s2.wav"
    assert (top["sensor"], side["sensor"], ear["microphone"]) == ("top", "side", "ear")
    assert (top["full_scale_m_per_s2"], side["full_scale_m_per_s2"], ear["full_scale_pa"]) == (5.0, 0.5, 0.05)
    assert [top["peak_m_per_s2"], ear["peak_pa"]] == pytest.approx([3.0, 0.03], rel=1e-3)
    assert [top["rms_m_per_s2"], ear["rms_pa"]] == pytest.approx([3.0 / np.sqrt(2.0), 0.03 / np.sqrt(2.0)], rel=1e-4)
    assert (top["seconds"], top["periods"], top["sampling_rate_hz"]) == (pytest.approx(1.0), 10, 48_000)
    assert (top["complete_below_hz"], "complete_below_hz" in ear) == (LIMIT, False)
    rate, samples = wavfile.read(folder / "exports" / top["file"])
    assert (rate, len(samples)) == (48_000, 48_000)
    expected = 3.0 * np.sin(2.0 * np.pi * 500.0 * np.arange(len(samples)) / rate + 0.3)
    np.testing.assert_allclose(5.0 * samples, expected, atol=1e-3)
    content = (folder / "exports" / top["file"]).read_bytes()
    # The length of a RIFF file is that of what follows it; the comment ends it, padded to even length.
    assert int.from_bytes(content[4:8], "little") == len(content) - 8
    comment = (
        b"acceleration at top; full scale (sample 1.0) is 5 m/s2; complete below 3000 Hz, cut off there; gearwhine run"
    )
    assert content.rstrip(b"\0").endswith(comment)
    size = len(comment) + 1 + (len(comment) + 1) % 2
    assert content[-size - 20 :].startswith(b"LIST" + (size + 12).to_bytes(4, "little") + b"INFOICMT")
    assert content[-size - 4 : -size] == size.to_bytes(4, "little")
    # A record of no whole turns is as long as it is.
    other = _results(tmp_path / "other", monkeypatch, "hann")
    assert [(one["periods"], one["seconds"]) for one in write_sounds(other, other / "exports")] == [(1, 0.1)] * 3
