"""What `run` writes of a transient, each number held against the physics that its name and unit claim.

The machine has nothing alike, so that a swapped axis, sign, bearing or gear pair shows.
"""

import csv
import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pytest
import pyuff
import xarray as xr
from lopsided_case import (
    AXES,
    FEW_WHIRLS,
    GEARS,
    HALF_FACE,
    HELD_AT,
    PAIRS,
    SPEEDS,
    UNBALANCES,
    bearing_forces,
    bearing_share,
    force,
    imbalance,
    lopsided,
    push,
)
from scipy.io import wavfile

from gearwhine.case import load_case
from gearwhine.cli import run_command
from gearwhine.numerics.arrays import ComplexArray

pytestmark = pytest.mark.slow

TURNS, DISCARDED = 28, 8
TURN = 0.02
"""One turn of the input shaft at 3000 rpm [s]."""
CONTACTS = [" -> ".join(pair) for pair in PAIRS]
OUTPUT = ["output-back", "output-front"]
BEARINGS = [f"{rotor}-{end}" for rotor in AXES for end in ("back", "front")]
SHAPES = {
    "time": (("time",), "s"),
    "frequency": (("frequency",), "Hz"),
    "speed": ((), "rpm"),
    "sensor_acceleration": (("sensor", "time"), "m/s2"),
    "bearing_force": (("bearing", "time", "axis"), "N"),
    "bearing_axial_force": (("bearing", "time"), "N"),
    "bearing_moment": (("bearing", "time", "moment_axis"), "N m"),
    "mesh_force": (("contact", "time"), "N"),
    "mesh_compression": (("contact", "time"), "m"),
    "gear_displacement": (("gear", "time", "axis"), "m"),
    "gear_rotation": (("gear", "time"), "rad"),
    "modal_displacement": (("modal_coordinate", "time"), "m kg0.5"),
    "sensor_spectrum": (("sensor", "frequency"), "m/s2"),
    "sensor_spectrum_phase": (("sensor", "frequency"), "rad"),
    "mesh_force_spectrum": (("contact", "frequency"), "N"),
    "mesh_force_spectrum_phase": (("contact", "frequency"), "rad"),
    "bearing_force_spectrum": (("bearing", "axis", "frequency"), "N"),
    "bearing_axial_force_spectrum": (("bearing", "frequency"), "N"),
    "bearing_moment_spectrum": (("bearing", "moment_axis", "frequency"), "N m"),
    "modal_displacement_spectrum": (("modal_coordinate", "frequency"), "m kg0.5"),
    "line_frequency": (("sensor", "line"), "Hz"),
    "line_amplitude": (("sensor", "line", "part"), "m/s2"),
    "line_by_mode": (("sensor", "line", "mode_path", "part"), "m/s2"),
    "line_by_bearing": (("sensor", "line", "bearing_path", "part"), "m/s2"),
    "housing_acceleration_spectrum": (("housing_mode", "housing_line", "part"), "m kg0.5 s-2"),
    "housing_frequency": (("housing_mode",), "Hz"),
}


class Written(NamedTuple):
    """A run's results file, its summary, the housing's modes, and the folder of its exports."""

    data: xr.Dataset
    summary: dict[str, Any]
    modes: xr.Dataset
    exports: Path


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Written:
    folder = tmp_path_factory.mktemp("lopsided")
    case = folder / "lopsided.toml"
    transient = (
        f"[transient]\nrevolutions = {TURNS}\ndiscard = {DISCARDED}\npoints_per_revolution = 200\ntolerance = 1e-3\n"
        "modal_coordinates = 2\n"
    )
    case.write_text(lopsided(spatial=True, more=transient), encoding="utf-8")
    assert run_command(["run", str(case), "-q", "--no-pictures", "-o", str(folder / "out"), "--set", FEW_WHIRLS]) == 0
    assert run_command(["export", str(case), "-q", "--all-signals", "-o", str(folder / "out")]) == 0
    summary = json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8"))
    # As a whole: each quantity that is looked at would be sought in the file anew.
    data, modes = (xr.load_dataset(folder / "out" / name) for name in ("results.nc", "modes.nc"))
    return Written(data, summary, modes, folder / "out" / "exports")


def lines_of(signal: npt.NDArray[Any]) -> ComplexArray:
    """Complex amplitudes of the lines of records along the last axis, under Hann's window; the mean at 0 Hz."""
    values = np.asarray(signal, dtype=np.float64)
    count = values.shape[-1]
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(count) / count)
    mean = values.mean(axis=-1, keepdims=True)
    lines = 2.0 * np.fft.rfft((values - mean) * window) / window.sum()
    lines[..., 0] = mean[..., 0]
    return np.asarray(lines)


def tones_of(signal: npt.NDArray[Any], lines_from_zero: npt.NDArray[np.float64]) -> ComplexArray:
    """Complex amplitudes of sines at any multiples of the lines' spacing, (..., f), under Hann's window."""
    values = np.asarray(signal, dtype=np.float64)
    share = np.arange(values.shape[-1]) / values.shape[-1]
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * share)
    swing = (values - values.mean(axis=-1, keepdims=True)) * window
    return np.asarray(2.0 * swing @ np.exp(-2j * np.pi * np.outer(share, lines_from_zero)) / window.sum())


def line_of_a_tone(distance: npt.NDArray[np.float64]) -> ComplexArray:
    """Line at a distance from a tone of amplitude 1: half the sum of three sinc functions, turned by -πx."""
    x = distance
    return np.asarray(np.exp(-1j * np.pi * x) * (np.sinc(x) + 0.5 * np.sinc(x - 1) + 0.5 * np.sinc(x + 1)))


def complex_of(data: xr.DataArray) -> ComplexArray:
    return np.asarray((data.sel(part="real") + 1j * data.sel(part="imaginary")).values)


def test_every_quantity_has_its_dimensions_and_unit(written: Written) -> None:
    found = {name: (written.data[name].dims, written.data[name].attrs["units"]) for name in SHAPES}
    assert found == SHAPES
    for name, labels in (
        ("bearing", BEARINGS),
        ("contact", CONTACTS),
        ("gear", list(GEARS)),
        ("sensor", ["cover", "wall"]),
        ("axis", ["x", "y"]),
        ("moment_axis", ["x", "y"]),
    ):
        assert written.data[name].values.tolist() == labels
    assert float(written.data.speed) == pytest.approx(3000.0)


def test_spectra_tell_where_the_modes_of_the_housing_end(written: Written) -> None:
    limit = float(written.modes["certificate_limit"]) / (2.0 * np.pi)
    spectra = {name: data for name, data in written.data.items() if "frequency" in data.dims}
    assert len(spectra) >= 8
    for name, data in spectra.items():
        assert data.attrs["trusted_below_hz"] == pytest.approx(limit, rel=1e-9), name


def test_time_goes_on_from_what_is_discarded(written: Written) -> None:
    times = written.data.time.values
    step = np.diff(times)
    assert step.min() == pytest.approx(step.max(), rel=1e-6)
    assert times[0] == pytest.approx(DISCARDED * TURN, abs=1.01 * step[0])
    assert times.size * step[0] == pytest.approx((TURNS - DISCARDED) * TURN)
    record = written.summary["record"]
    assert (record["samples"], record["interval_s"]) == (times.size, pytest.approx(step[0]))


def test_mean_forces_are_those_of_statics(written: Written) -> None:
    data = written.data
    forces = {pair: force(pair) for pair in PAIRS}
    assert data.mesh_force.mean("time").values == pytest.approx(list(forces.values()), rel=2e-3)
    expected = bearing_forces(forces)
    scale = max(abs(part) for parts in expected.values() for part in parts)
    means, about = (
        {name: data[variable].sel(bearing=name).mean("time").values.astype(float) for name in BEARINGS}
        for variable in ("bearing_force", "bearing_moment")
    )
    for bearing in BEARINGS:
        if not bearing.startswith("output"):
            # The output's bearings hold tilts too: no lever says what each takes. Shafts that bend carry the mesh force
            # off the middle of the face.
            off = HALF_FACE * scale / (HELD_AT["front"] - HELD_AT["back"])
            assert means[bearing] == pytest.approx(np.array(expected[bearing]).real, abs=off), bearing
    couples = []
    for rotor in AXES:
        left = np.array(imbalance(rotor, forces, means, about))
        assert np.abs(left[:2]).max() < 5e-3 * scale, rotor
        assert np.abs(left[2:]).max() < HALF_FACE * scale, rotor
        couples.append(left[2:])
    # What the face of a mesh does to one shaft it does to the other in the opposite sense.
    assert np.abs(sum(couples)).max() < 1e-3 * 0.1 * scale
    assert np.abs(about["output-front"]).min() > 1e-3 * 0.1 * scale
    told = {entry["name"]: entry for entry in written.summary["bearings"]}
    assert list(told) == BEARINGS
    for bearing, entry in told.items():
        history = data.bearing_force.sel(bearing=bearing)
        assert entry["mean_force_n"][:2] == pytest.approx(history.mean("time").values, rel=1e-4, abs=1e-3)
        assert entry["rms_force_n"][:2] == pytest.approx(history.std("time").values, rel=1e-3, abs=1e-3)
        assert entry["mean_moment_n_m"] == pytest.approx(about[bearing].tolist(), rel=1e-4, abs=1e-4)
        along = data.bearing_axial_force.sel(bearing=bearing).values
        assert entry["mean_force_n"][2] == pytest.approx(along.mean(), rel=1e-3, abs=1e-3)
        assert (along.std() > 0.01) == bearing.startswith("output")


def test_gear_pairs_are_told_with_their_own_forces(written: Written) -> None:
    for pair, entry in zip(PAIRS, written.summary["gear_pairs"], strict=True):
        history = written.data.mesh_force.sel(contact=" -> ".join(pair)).values
        assert (entry["driver"], entry["driven"]) == pair
        assert entry["mean_force_n"] == pytest.approx(history.mean(), rel=1e-3)
        # Of the steps, between which the samples lie.
        assert history.max() * (1 - 1e-4) <= entry["peak_force_n"] <= 1.02 * history.max()
        assert entry["contact_loss_fraction"] == 0.0
        at = np.array([peak["frequency_hz"] for peak in entry["force_peaks"]]) / written.data.frequency.values[1]
        found = [peak["amplitude_n"] for peak in entry["force_peaks"]]
        assert found == pytest.approx(np.abs(tones_of(history, at)), rel=0.05, abs=0.005 * max(found))


def test_compression_is_what_gears_move_towards_each_other(written: Written) -> None:
    """δ = e (u_driver - u_driven) + s (r θ_driver + r θ_driven), s the driver's sense; δ > 0 where teeth press."""
    data = written.data
    for pair in PAIRS:
        driver, driven = (GEARS[name] for name in pair)
        e = np.array(push(pair))
        sense = np.sign(SPEEDS[driver.rotor])
        moved = data.gear_displacement.sel(gear=pair[0]) - data.gear_displacement.sel(gear=pair[1])
        turned = driver.base_radius * data.gear_rotation.sel(
            gear=pair[0]
        ) + driven.base_radius * data.gear_rotation.sel(gear=pair[1])
        expected = (moved.values * e).sum(axis=-1) + sense * turned.values
        compression = data.mesh_compression.sel(contact=" -> ".join(pair)).values
        assert compression.min() > 0.0
        # At the stiffness centre, which the mean slope of the shafts has off the middle of the face.
        off = compression - expected
        assert np.abs(off).max() < 0.05 * compression.max()
        assert np.ptp(off) < 1e-2 * compression.max()


@pytest.mark.parametrize(
    ("history", "spectrum"),
    [("sensor_acceleration", "sensor_spectrum"), ("mesh_force", "mesh_force_spectrum")],
)
def test_spectra_are_those_of_the_histories_with_their_phase(written: Written, history: str, spectrum: str) -> None:
    lines = lines_of(written.data[history].values)
    amplitude, phase = written.data[spectrum].values, written.data[f"{spectrum}_phase"].values
    frequencies = written.data.frequency.values
    assert frequencies[1] == pytest.approx(1.0 / ((TURNS - DISCARDED) * TURN))
    lines *= np.exp(-2j * np.pi * frequencies * float(written.data.time[0]))  # phases are those at t = 0
    scale = np.abs(lines[:, 1:]).max(axis=1, keepdims=True)
    assert np.abs(np.abs(lines) - amplitude)[:, 1:].max() < 1e-4 * scale.max()
    strong = np.abs(lines) > 0.02 * scale
    strong[:, 0] = False
    turned = np.exp(1j * phase[strong]) * amplitude[strong]
    assert np.abs(turned - lines[strong]).max() < 1e-3 * scale.max()
    assert np.count_nonzero(strong) > 10


def test_spectra_of_bearings_and_coordinates_are_those_of_their_histories(written: Written) -> None:
    data = written.data
    for spectrum, history in (
        (data.bearing_force_spectrum, data.bearing_force.transpose("bearing", "axis", "time")),
        (
            data.bearing_moment_spectrum.sel(bearing=OUTPUT),
            data.bearing_moment.sel(bearing=OUTPUT).transpose("bearing", "moment_axis", "time"),
        ),
        (data.bearing_axial_force_spectrum.sel(bearing=OUTPUT), data.bearing_axial_force.sel(bearing=OUTPUT)),
        (data.modal_displacement_spectrum, data.modal_displacement),
    ):
        lines = np.abs(lines_of(history.values))
        found = spectrum.values
        scale = lines[..., 1:].max(axis=-1, keepdims=True)
        assert (np.abs(lines - found)[..., 1:] / scale).max() < 2e-3


def test_unbalance_stands_in_the_bearings_at_its_shaft_s_speed(written: Written) -> None:
    """Far below any mode the shaft turns its unbalance's force about, shared by the lever."""
    spectrum = written.data.bearing_force_spectrum
    for rotor, (at, moment, _) in UNBALANCES.items():
        speed = abs(SPEEDS[rotor])
        turning = moment * speed**2
        for end in ("back", "front"):
            found = spectrum.sel(bearing=f"{rotor}-{end}").sel(frequency=speed / (2 * np.pi), method="nearest")
            if rotor == "input":
                # 50 Hz is one of the lines.
                assert found.values == pytest.approx(turning * bearing_share(end, at), rel=0.08)


def test_a_sensor_s_level_is_of_what_lies_below_the_limit(written: Written) -> None:
    limit = written.summary["trusted_below_hz"]
    assert limit == pytest.approx(2500.0)
    frequencies = written.data.frequency.values
    inside = (frequencies > 0.0) & (frequencies <= limit)
    for sensor in written.summary["sensors"]:
        samples = written.data.sensor_acceleration.sel(sensor=sensor["name"]).values
        lines = np.fft.rfft(samples - samples.mean())
        all_of_it = np.std(samples)
        below = np.std(np.fft.irfft(np.where(inside | (frequencies == 0.0), lines, 0.0), samples.size))
        assert all_of_it > 1.01 * below
        assert sensor["rms_m_per_s2"] == pytest.approx(below, rel=1e-3)


def test_lines_and_their_parts(written: Written) -> None:
    """A line is the history's tone there; its modes add up to it, each the mode's acceleration times its shape there.

    Tones stand between the spectrum's lines: those of the modes follow from the two lines beside them by least squares.
    """
    data, shapes = written.data, written.modes.sensor_motion
    frequencies = [mode["frequency_hz"] for mode in written.summary["housing"]["modes"]]
    begin, hertz = float(data.time[0]), data.frequency.values
    # Phases are those at t = 0; interpolation is between lines of the record from its first sample on.
    spectra = complex_of(data.housing_acceleration_spectrum)
    spectra *= np.exp(2j * np.pi * data.housing_line.values * begin)
    names = data.mode_path.values.tolist()
    assert names == [f"housing mode {i} ({hz:.0f} Hz)" for i, hz in enumerate(frequencies, start=1)] + [
        "local compliance"
    ]
    for sensor in ("cover", "wall"):
        at = data.line_frequency.sel(sensor=sensor).values / hertz[1]
        to_zero = np.exp(-2j * np.pi * at * hertz[1] * begin)
        found = complex_of(data.line_amplitude.sel(sensor=sensor))
        scale = np.abs(found).max()
        assert found == pytest.approx(
            to_zero * tones_of(data.sensor_acceleration.sel(sensor=sensor).values, at), abs=0.01 * scale
        )
        by_mode = complex_of(data.line_by_mode.sel(sensor=sensor))
        assert by_mode.sum(axis=-1) == pytest.approx(found, abs=1e-9 * scale)
        low = np.floor(at + 1e-9).astype(int)
        beside = np.stack([line_of_a_tone(low - at), line_of_a_tone(low + 1 - at)])
        pairs = np.stack([spectra[:, low], spectra[:, low + 1]])
        fitted = (beside.conj()[:, None] * pairs).sum(axis=0) / (np.abs(beside) ** 2).sum(axis=0)
        of_modes = np.where(np.abs(at - low) < 1e-9, spectra[:, low], fitted).T * shapes.sel(sensor=sensor).values
        assert by_mode[:, :-1] == pytest.approx(to_zero[:, None] * of_modes, abs=1e-6 * scale)
        by_bearing = complex_of(data.line_by_bearing.sel(sensor=sensor))
        # The motion has settled: what the bearings drive is all but all of the strong lines.
        assert by_bearing.sum(axis=-1)[:4] == pytest.approx(found[:4], abs=0.05 * scale)


def test_lines_in_the_summary_are_those_of_the_file(written: Written) -> None:
    data, modes = written.data, written.summary["system"]["modes"]
    for sensor in written.summary["sensors"]:
        values = complex_of(data.line_amplitude.sel(sensor=sensor["name"]))
        by_mode = data.line_by_mode.sel(sensor=sensor["name"])
        by_bearing = data.line_by_bearing.sel(sensor=sensor["name"])
        names = data.line_name.sel(sensor=sensor["name"]).values
        assert [peak["name"] for peak in sensor["peaks"]] == names.tolist()
        for number, (peak, value) in enumerate(zip(sensor["peaks"], values, strict=True)):
            assert peak["amplitude_m_per_s2"] == pytest.approx(abs(value))
            assert peak["phase_rad"] == pytest.approx(np.angle(value))
            assert peak["level_db"] == pytest.approx(20.0 * np.log10(abs(value) / np.sqrt(2.0) / 1e-6))
            assert peak["order"] == pytest.approx(peak["frequency_hz"] * TURN, rel=1e-3)
            if (near := peak["near_mode"]) is not None:
                mode = modes[near["number"] - 1]
                assert {key: mode[key] for key in ("kind", "where", "frequency_hz")} == {
                    key: near[key] for key in ("kind", "where", "frequency_hz")
                }
                assert mode["frequency_hz"] == pytest.approx(peak["frequency_hz"], rel=0.1)
            for kind, table, path in (
                ("housing_modes", by_mode, "mode_path"),
                ("bearings", by_bearing, "bearing_path"),
            ):
                for part in peak["contributions"][kind]:
                    whole = complex(complex_of(table.isel(line=number).sel({path: part["name"]})))
                    assert part["amplitude_m_per_s2"] == pytest.approx(abs(whole))
                    assert part["share"] == pytest.approx((whole / value).real)
                    if "number" in part:
                        assert part["name"].startswith(f"housing mode {part['number']} (")
                        assert part["number"] == data.mode_path.values.tolist().index(part["name"]) + 1


def test_mesh_lines_are_named_for_their_pair(written: Written) -> None:
    rates = {"a -> b": 23 * 50.0, "c -> d": 21 * 50.0 * 23 / 47}
    for sensor in written.summary["sensors"]:
        named = [peak for peak in sensor["peaks"] if peak["kind"] == "mesh"]
        assert named
        for peak in named:
            harmonic, pair = peak["name"].split("× ")
            assert peak["frequency_hz"] == pytest.approx(float(harmonic) * rates[pair], rel=2e-3)


def test_sidebands_are_lines_of_the_spectrum(written: Written) -> None:
    """Lower ones below their carrier, upper ones above."""
    compared = 0
    for sensor in written.summary["sensors"]:
        spectrum = written.data.sensor_spectrum.sel(sensor=sensor["name"])
        for told in sensor["sidebands"]:
            for side, sign in (("lower", -1.0), ("upper", 1.0)):
                near = spectrum.sel(frequency=told["carrier_hz"] + sign * told["distance_hz"], method="nearest")
                # Where both lie on lines of the record and one of them stands out.
                amplitude = told[f"{side}_amplitude_m_per_s2"]
                on_line = abs(float(near.frequency) - told["carrier_hz"] - sign * told["distance_hz"]) < 0.01
                if on_line and amplitude > 1e-4 and told["gear_pair"] == "a -> b" and told["shafts"] == ["input"]:
                    assert amplitude == pytest.approx(float(near), rel=0.05)
                    compared += 1
    assert compared >= 4


def test_energies_balance_as_they_are_told(written: Written) -> None:
    """What the loads and the teeth's nominal rotation give is lost or kept."""
    energy = written.summary["energy_j"]
    given = energy["loads"] + energy["teeth"]
    assert energy["change"] == pytest.approx(given - energy["lost"], abs=1e-3 * energy["lost"])
    assert energy["lost"] > 0.0


def test_exported_tables_have_all_digits(written: Written) -> None:
    with (written.exports / "run-Housing-modes.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    (column,) = (name for name in rows[0] if "[Hz]" in name)
    assert [float(row[column]) for row in rows] == written.data["housing_frequency"].values.tolist()


def test_exported_functions_are_read_back_by_pyuff(written: Written) -> None:
    data = written.data
    file = pyuff.UFF(str(written.exports / "run.uff"))
    found = [file.read_sets(int(index)) for index in np.flatnonzero(file.get_set_types() == 58)]
    for number, sensor in enumerate(data["sensor"].values, start=1):
        own = [one for one in found if one["rsp_node"] == number]
        (history,) = (one for one in own if one["func_type"] == 1)
        assert history["ordinate_spec_data_type"] == 12
        assert str(sensor) in history["id1"]
        np.testing.assert_array_equal(history["data"], data["sensor_acceleration"].sel(sensor=sensor).values)
        np.testing.assert_allclose(history["x"], data["time"].values, rtol=1e-5)
        (spectrum,) = (one for one in own if one["func_type"] == 12)
        expected = data["sensor_spectrum"] * np.exp(1j * data["sensor_spectrum_phase"])
        np.testing.assert_allclose(spectrum["data"], expected.sel(sensor=sensor).values, rtol=1e-12, atol=1e-15)
        np.testing.assert_array_equal(spectrum["x"], data["frequency"].values)
    force = data["bearing_force"].isel(bearing=1).sel(axis="y")
    label = f"{data['bearing'].values[1]}, y"
    assert any(one["id1"] == label and np.array_equal(one["data"], force.values) for one in found)


def test_points_of_the_exported_functions_are_the_sensors(written: Written) -> None:
    file = pyuff.UFF(str(written.exports / "run.uff"))
    points = file.read_sets(int(np.flatnonzero(file.get_set_types() == 2411)[0]))
    case = load_case(str(written.exports.parent / "case.toml")).case
    assert case.housing is not None
    places = [one.position for one in case.housing.sensor]
    np.testing.assert_allclose(np.stack([points["x"], points["y"], points["z"]], axis=1), places)


def test_an_exported_sound_by_its_full_scale_is_the_acceleration(written: Written) -> None:
    (path,) = written.exports.glob("run-cover-full-scale-*.wav")
    scale = float(path.stem.partition("full-scale-")[2].partition("-m-per")[0])
    rate, samples = wavfile.read(path)
    content = path.read_bytes()
    assert (rate, samples.dtype) == (48_000, np.float32)
    assert np.abs(samples).max() <= 1.0
    assert f"full scale (sample 1.0) is {scale:g} m/s2".encode() in content
    assert int.from_bytes(content[4:8], "little") == len(content) - 8
    times = written.data["time"].values
    signal = written.data["sensor_acceleration"].sel(sensor="cover").values.astype(np.float64)
    signal -= signal.mean()
    interval = times[1] - times[0]
    assert len(samples) / rate == pytest.approx(len(times) * interval, abs=1.0 / rate)
    # The highest line where the modes are complete, and the highest above, which is cut off: by the Fourier sum of each
    # record at its own sampling.
    limit = written.summary["trusted_below_hz"]
    assert f"complete below {limit:.0f} Hz".encode() in content
    heights, frequencies = np.abs(np.fft.rfft(signal)), np.fft.rfftfreq(len(signal), interval)
    inside = frequencies <= limit
    for chosen, is_kept in ((inside, True), (frequencies > 1.15 * limit, False)):
        line = frequencies[np.argmax(np.where(chosen, heights, 0.0))]
        amplitudes = []
        for values, spacing in ((signal, interval), (scale * samples, 1.0 / rate)):
            window = np.hanning(len(values))
            rotating = np.exp(-2j * np.pi * line * spacing * np.arange(len(values)))
            amplitudes.append(abs(np.sum(window * values * rotating)) / window.sum())
        if is_kept:
            assert amplitudes[1] == pytest.approx(amplitudes[0], rel=2e-3)
        else:
            assert amplitudes[1] < 1e-3 * amplitudes[0]
