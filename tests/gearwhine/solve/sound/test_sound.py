"""Sound of a case: parts that add up, two motions that sound alike, measurement by ISO 3744, and refusals."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.io import wavfile
from scipy.signal import spectrogram
from sounding_gearbox import swept_point

import gearwhine as gw
from gearwhine.case import CaseError, swept_keys
from gearwhine.coupling.analyses.steady_state import SolvedSteady
from gearwhine.coupling.sound.microphones import microphone_histories
from gearwhine.coupling.sound.solution import build_radiation
from gearwhine.coupling.sweep.reduced_motion import ReducedMotion
from gearwhine.housing.acoustics.modal_radiation import ModalRadiation
from gearwhine.numerics.result_warnings import warning
from gearwhine.output.export import write_sounds
from gearwhine.output.files import staging
from gearwhine.solve.acoustics import acoustics_of, refused_by_key
from gearwhine.solve.housing_modes import solve_housing, write_mode_cache
from gearwhine.solve.kept_radiation import kept_radiation
from gearwhine.sweep.solution import PointResult
from gearwhine.sweep.sound import add_sound

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("mechanisms_left_out")]

COARSE = {"acoustics.mesh_size": "35 mm", "acoustics.highest_frequency": "2.8 kHz", "acoustics.lines": 8}
BOXED = COARSE | {"acoustics.floor": "-21 mm", "acoustics.microphone_box": "1 m"}
ALUMINIUM = {
    "acoustics.method": "erp",
    "acoustics.mesh_size": "34 mm",
    "housing.box.mesh_size": "45 mm",
    "material.aluminium": {"youngs_modulus": "71 GPa", "poisson_ratio": 0.33, "density": "2700 kg/m^3"},
}


@pytest.fixture(scope="module")
def study():
    found = gw.load("small-gearbox", BOXED)
    assert found.housing is not None  # of the case alone, without the checks of the sound
    return found


DOUBT = warning("superposition", "doubtful at a mesh")


@pytest.fixture(scope="module")
def sound(study):
    """Sound of a steady motion that is doubted."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(SolvedSteady, "superposition_warnings", lambda _: [DOUBT])
        return study.sound()


def test_the_sound_of_doubtful_superposed_motions_is_warned_of(sound):
    assert DOUBT in sound.document["warnings"]


def test_parts_add_up_to_the_power(sound):
    assert sound.solved.lines
    for line in sound.solved.lines:
        one = line.sound
        assert one.by_motion.sum() == pytest.approx(one.power, rel=1e-9)
        assert one.by_mode.sum() == pytest.approx(one.surface_power, rel=1e-9)
        assert sum(one.by_face.values()) == pytest.approx(one.surface_power, rel=1e-9)
        assert 10.0 * abs(np.log10(one.surface_power / one.power)) < 0.25
        assert one.radiation_efficiency == pytest.approx(10.0 ** (0.1 * (line.level_db - line.equivalent_db)), rel=1e-9)
    powers = [line.sound.power for line in sound.solved.lines]
    assert sound.solved.total_db == pytest.approx(10.0 * np.log10(sum(powers) / 1e-12))


def test_sound_pressure_falls_by_six_decibels_for_twice_the_distance(sound):
    loudest = max(sound.solved.lines, key=lambda line: line.sound.power).sound
    near, far = np.array([[9.0, 9.0, 9.0], [18.0, 18.0, 18.0]])
    levels = [20.0 * np.log10(abs(loudest.pressure_at(place[None])[0])) for place in (near, far)]
    assert levels[0] - levels[1] == pytest.approx(6.02, abs=0.2)


def test_document_and_arrays_hold_the_solution(sound):
    document, dataset = sound.document, sound.dataset
    assert document["method"] == "boundary-elements"
    for entry, line in zip(document["lines"], sound.solved.lines, strict=True):
        assert entry["frequency_hz"] == line.frequency_hz
        assert entry["sound_power_db"] == pytest.approx(10.0 * np.log10(line.sound.power / 1e-12))
        assert entry["microphones_db"]["box 5"] == pytest.approx(
            20.0 * np.log10(abs(line.microphones[4]) / np.sqrt(2.0) / 20e-6)
        )
    assert dataset["sound_power"].values == pytest.approx([line.sound.power for line in sound.solved.lines])
    assert dataset["sound_power"].attrs["units"] == "W"
    pressure = dataset["sound_pressure"].values
    assert pressure[-1, 3, 0] + 1j * pressure[-1, 3, 1] == pytest.approx(sound.solved.lines[-1].microphones[3])
    assert sound.solved.box_level_db == pytest.approx(sound.solved.total_db, abs=4.0)  # of one tone, at nine places
    by_number = {mode.number: mode.radiation_efficiency for mode in sound.solved.modes}
    assert {entry["number"]: entry["radiation_efficiency"] for entry in document["modes"]} == by_number
    assert document["total_db"] > document["total_db_a"] - 1.3  # A adds at most 1.3 dB, at 2.5 kHz


def test_the_sound_of_modes_is_solved_once_a_folder(sound, monkeypatch, tmp_path):
    """Whatever the operation is; with another surface or limit it is solved anew."""
    folder = tmp_path / "out"
    sound.write(folder, pictures=False)
    monkeypatch.setattr("gearwhine.coupling.sound.solution.sound_of_modes", None)
    again = gw.load("small-gearbox", BOXED, folder=folder).sound()
    assert again.document["modes"] == sound.document["modes"]
    assert again.document["warnings"] == [one for one in sound.document["warnings"] if one != DOUBT]
    modes = again.solved.modes
    assert [mode.known_source for mode in modes] == [mode.known_source for mode in sound.solved.modes]
    slower = gw.load("small-gearbox", BOXED | {"operation.speed": "4000 rpm", "acoustics.lines": 1}, folder=folder)
    assert slower.sound().solved.modes == modes
    for change in ({"acoustics.highest_frequency": "2.7 kHz"}, {"acoustics.caps": "rest"}):
        with pytest.raises(TypeError, match="NoneType"):
            gw.load("small-gearbox", BOXED | change, folder=folder).sound()


@pytest.fixture(scope="module")
def run(study):
    with pytest.MonkeyPatch.context() as patch:
        # Fewer frequencies than of a user's run, whose sound over time is the closer.
        patch.setattr("gearwhine.solve.kept_radiation.POINTS", 25)
        return study.changed({"acoustics.in_run": True}).run()


def test_transient_sounds_as_the_steady_state(study, sound, run):
    lines = {round(line.order, 3): line.level_db for line in run.solved.sound.lines}
    steady = {round(line.order, 3): line.level_db for line in sound.solved.lines}
    loudest = max(steady, key=lambda order: steady[order])
    assert lines[loudest] == pytest.approx(steady[loudest], abs=0.3)
    assert run.document["sound"]["lines"]


def test_known_sources_at_microphones_count_over_time_too(run, monkeypatch):
    """The record has lines to 2.6 kHz, its sound over time the frequencies to 2.8 kHz, of a worse known source."""
    solved = run.solved.sound
    of_lines = np.max([line.microphone_errors for line in solved.lines], axis=0)
    over_time = solved.histories.source_errors
    assert np.all(over_time > 0.0)
    assert over_time.max() > of_lines.max()
    assert solved.histories.source_frequency_hz > max(line.frequency_hz for line in solved.lines)
    told = [one["known_source_error"] for one in run.document["sound"]["microphones"]]
    assert told == pytest.approx(np.maximum(of_lines, over_time))
    assert "microphone_known_source" not in [one["name"] for one in solved.warnings()]
    monkeypatch.setattr("gearwhine.coupling.sound.proofs.SOURCE_HEARD", 0.99 * over_time.max())
    (doubt,) = [one for one in solved.warnings() if one["name"] == "microphone_known_source"]
    assert (doubt["relative"], doubt["frequency_hz"]) == (over_time.max(), solved.histories.source_frequency_hz)
    assert list(solved.microphones)[int(over_time.argmax())] in doubt["message"]


def test_a_tones_level_in_the_sound_file_is_that_of_its_line(run, tmp_path):
    folder = tmp_path / "out"
    run.write(folder, pictures=False)
    line = max(run.solved.sound.lines, key=lambda one: one.sound.power)
    (tmp_path / "wav").mkdir()
    written = [one for one in write_sounds(folder, tmp_path / "wav") if "microphone" in one]
    assert [one["microphone"] for one in written] == list(run.solved.sound.microphones)
    for place, entry in enumerate(written):
        rate, samples = wavfile.read(tmp_path / "wav" / entry["file"])
        pressure = samples.astype(float) * entry["full_scale_pa"]
        window = np.hanning(len(pressure))
        times = np.arange(len(pressure)) / rate
        tone = 2.0 * abs(np.sum(window * pressure * np.exp(-2j * np.pi * line.frequency_hz * times)) / window.sum())
        assert 20.0 * np.log10(tone / abs(line.microphones[place])) == pytest.approx(0.0, abs=0.1)
    assert run.document["sound"]["microphone_error"] < 0.06


def test_a_run_up_played_as_a_spectrogram_shows_the_order(run):
    """Mesh force of a run-up from 10 to 30 rev/s: the loudest tone at every time is 28 times the speed."""
    machine, radiation = run.solved.transient.machine, run.solved.sound.radiation
    transfer = ModalRadiation.solve(radiation, np.array([[0.0, 1.2, 0.0]]), 20.0, 1000.0, points=15)
    times = np.arange(16000) / 8000.0
    speed = 10.0 + 10.0 * times  # rev/s
    tone = np.cos(2.0 * np.pi * 28.0 * (10.0 * times + 5.0 * times**2))
    forces = {
        name: np.zeros((len(times), force.shape[1]))
        for name, force in run.solved.transient.histories.bearing_reaction.items()
    }
    forces["input-back"][:, 1] = 100.0 * tone
    heard = microphone_histories(machine, transfer, times, forces, repeats=False).pressure[0]
    frequencies, at, power = spectrogram(heard, 8000.0, nperseg=1024, noverlap=0)
    loudest = frequencies[power.argmax(axis=0)]
    assert loudest[1:-1] == pytest.approx(28.0 * np.interp(at, times, speed)[1:-1], abs=1.5 * frequencies[1])


def test_rayleigh_of_the_top_is_near_boundary_elements_for_a_mode_of_the_top(study):
    """A face in an infinite baffle radiates like the face of a box where the wavelength is short beside the box."""
    modes = {}
    for method in ("boundary-elements", "rayleigh"):
        changes = {"acoustics.method": method, "acoustics.highest_frequency": "2.8 kHz"}
        changes |= {"acoustics.faces": ["top"]} if method == "rayleigh" else {"acoustics.mesh_size": "30 mm"}
        alone = gw.load(
            "small-gearbox",
            changes | {"operation": "", "rotor": [], "bearing": [], "gear": [], "gear_pair": [], "transient": ""},
        )
        alone._kept.solved = study.housing
        modes[method] = alone.sound().document["modes"]
    most = max(modes["boundary-elements"], key=lambda mode: mode["faces"].get("top", 0.0))
    assert most["faces"]["top"] > 0.4
    baffled = next(one for one in modes["rayleigh"] if one["number"] == most["number"])
    assert 10.0 * abs(np.log10(baffled["radiation_efficiency"] / most["radiation_efficiency"])) < 3.0
    assert baffled["faces"] == {"top": pytest.approx(1.0, abs=0.03)}


def test_triangles_of_no_use_are_refused_by_the_radiation_itself(study):
    """Where nothing was checked before: a sweep's points, whose housing may have changed."""
    case = study.changed({"acoustics.mesh_size": "90 mm"}).case
    acoustics, message = acoustics_of(case), r"^acoustics\.mesh_size: .* too large for 2800 Hz: .*, got '90 mm'"
    with pytest.raises(CaseError, match=message), refused_by_key(acoustics):
        build_radiation(acoustics, study.housing.displacement_field)


def test_many_lines_of_a_sweep_come_from_the_radiation_kept_with_the_modes(monkeypatch, tmp_path):
    """Lines of a point by the table and by solutions agree; the file of modes holds the table for the next sweep."""
    monkeypatch.setattr("gearwhine.solve.kept_radiation.POINTS", 17)
    microphone = {"name": "ear", "position": ["0.5 m", "1 m", "0.1 m"]}
    # The mesh frequency is 2333 Hz, below the highest of the sound.
    low = COARSE | {"acoustics.mesh_size": "34 mm", "acoustics.highest_frequency": "2.5 kHz"}
    low |= {"operation.speed": "5000 rpm", "housing.box.mesh_size": "45 mm"}
    study = gw.load("small-gearbox", low | {"acoustics.microphone": [microphone]})
    housing = solve_housing(study.case)
    size = len(housing.modes.frequencies) + len(housing.modes.residual_modes.frequencies)
    generator = np.random.default_rng(5)
    frequencies = np.linspace(900.0, 2400.0, 6)
    rates = 1e-4 * generator.normal(size=(6, size, 2))
    keys = swept_keys(study.case, ["operation.torque=10 N*m,20 N*m"])

    def heard(most, housing):
        monkeypatch.setattr("gearwhine.sweep.sound.POINTS", most)
        named = ("line",) * 6
        one = PointResult(
            {},
            ReducedMotion(
                np.zeros(0), line_frequencies=frequencies, line_rates=rates, line_names=named, line_kinds=named
            ),
        )
        told, kept, _ = add_sound(study.case, keys, [swept_point(study.case, "10 N*m", one)], housing)
        assert told == []
        return one.document["sound"]["lines"], kept

    solved, same = heard(100, housing)
    assert same is housing
    interpolated, kept = heard(5, housing)
    assert not kept.source_holds
    assert interpolated != solved
    for one, other in zip(interpolated, solved, strict=True):
        assert one["frequency_hz"] == other["frequency_hz"]
        for key in ("sound_power_db", "sound_power_db_a"):
            assert one[key] == pytest.approx(other[key], abs=0.05)
        assert one["power_balance_db"] == pytest.approx(other["power_balance_db"], abs=0.1)
        assert one["microphones_db"]["ear"] == pytest.approx(other["microphones_db"]["ear"], abs=0.05)
        assert one["radiation_efficiency"] == pytest.approx(other["radiation_efficiency"], rel=0.01)
        # Of the table the larger error of the frequencies beside, which grows with them.
        assert 0.9 < one["known_source_error"] / other["known_source_error"] < 1.6
        assert 0.9 < one["known_source_rms"] / other["known_source_rms"] < 1.6
        shares = [
            {part["name"]: part["share"] for part in line["contributions"]["housing_modes"]} for line in (one, other)
        ]
        assert max(abs(shares[0].get(name, 0.0) - shares[1][name]) for name in shares[1]) < 0.03
    with staging(tmp_path / "out") as place:
        write_mode_cache(place, kept)
    again = solve_housing(study.case, folder=tmp_path / "out")
    monkeypatch.setattr("gearwhine.solve.kept_radiation.ModalRadiation.solve", None)  # needs no solution
    assert heard(5, again)[0] == interpolated
    # A file of a version without known sources, whose key is another one, too: its radiation is solved anew.
    sources = [name for name in again.record.extras if "source" in name]
    assert sources == ["radiation_source_error", "radiation_source_rms", "point_source_error"]
    earlier = {name: array for name, array in again.record.extras.items() if name not in sources}
    record = replace(again.record, extras=earlier, notes={**again.record.notes, "radiation": "of an earlier version"})
    with pytest.raises(TypeError):
        heard(5, replace(again, record=record))
    deaf, field = acoustics_of(gw.load("small-gearbox", low).case), again.displacement_field
    monkeypatch.undo()
    monkeypatch.setattr("gearwhine.solve.kept_radiation.POINTS", 5)
    without, same = kept_radiation(deaf, again, build_radiation(deaf, field), np.zeros((0, 3)), (900.0, 2400.0))
    assert len(without.delays) == 0
    read, _ = kept_radiation(deaf, same, None, np.zeros((0, 3)), (900.0, 2400.0))
    assert len(read.delays) == 0  # no microphones of the table before
    monkeypatch.setattr("gearwhine.solve.kept_radiation.ModalRadiation.solve", None)
    louder = acoustics_of(gw.load("small-gearbox", low | {"acoustics.mesh_size": "33 mm"}).case)
    with pytest.raises(TypeError):
        kept_radiation(louder, again, build_radiation(louder, field), np.zeros((0, 3)), (20.0, 3000.0))


def test_sweep_sounds_by_the_housing_of_its_points(swept_here, tmp_path):
    """Which is another one than that of the case where the only value of a key makes it so."""
    short = ALUMINIUM | {"transient.revolutions": 4, "transient.discard": 2, "transient.tolerance": 1e-3}
    over = "rotor[0].material,housing.material=aluminium"
    swept = gw.load("small-gearbox", short).sweep([over], folder=tmp_path / "out", workers=1)
    alone = gw.load("small-gearbox", short | {"rotor.0.material": "aluminium", "housing.material": "aluminium"}).run()
    assert swept.dataset["sound_power_level"].values[0] == pytest.approx(alone.document["sound"]["total_db"], abs=0.05)
    # The coarse mesh alone is told of.
    assert all("mesh" in text for text in swept.warnings)
