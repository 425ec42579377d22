"""Lines of a motion that drive the housing: of motions that are superposed, of broken turns, and those left out."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from sounding_gearbox import EAR, QUICK, TOP, quick_run, sounding_gearbox, sounding_housing, swept_point

import gearwhine as gw
from gearwhine.case import CaseError, load_case, swept_keys
from gearwhine.coupling.signals.spectrum import amplitude_spectrum
from gearwhine.coupling.sound.motion_lines import lines_of_run, lines_of_steady, strongest_lines, tones_of
from gearwhine.coupling.sound.solution import build_radiation, solve_sound
from gearwhine.coupling.sweep.reduced_motion import ReducedMotion, sounding_lines
from gearwhine.housing.pictures.drawn_shapes import drawn_housing
from gearwhine.numerics.arrays import FloatArray
from gearwhine.results.motion import _line as motion_words
from gearwhine.solve.acoustics import acoustics_of
from gearwhine.solve.operating_shapes import highest_lines, operating_shape_of_line
from gearwhine.sweep import SweptPoint, sweep_points
from gearwhine.sweep.solution import PointResult
from gearwhine.sweep.sound import add_sound

pytestmark = pytest.mark.usefixtures("mechanisms_left_out")


def motion(period: float, harmonics: dict[int, complex], weight: int = 1) -> Any:
    """One period of a bearing's force along x, of harmonics of the period."""
    at = np.arange(256) / 256
    force = np.sum([(a * np.exp(2j * np.pi * n * at)).real for n, a in harmonics.items()], axis=0)
    histories = SimpleNamespace(forces_on_housing={"front": force[:, None]})
    group = SimpleNamespace(weight=weight)
    return SimpleNamespace(response=SimpleNamespace(period=period), histories=histories, group=group)


def test_lines_of_superposed_motions_at_one_frequency_are_added_with_their_phases() -> None:
    """Harmonics of 30 and of 100 Hz meet at 300 Hz, the tenth and the third, and at 600 Hz, where they cancel."""
    slow = motion(1.0 / 30.0, {1: 5.0, 10: 2.0, 20: 1.0 + 1.0j})
    fast = motion(1.0 / (100.0 * (1.0 + 1e-12)), {1: 7.0, 3: 3.0j, 6: -1.0 - 1.0j})
    solved: Any = SimpleNamespace(motions=(fast, slow), superposed=object())
    found = lines_of_steady(solved, 650.0)
    assert len(np.unique(np.round(found.frequencies, 3))) == len(found.frequencies)
    assert np.all(np.diff(found.frequencies) > 0.0)
    heights = dict(zip(np.round(found.frequencies, 6).tolist(), found.forces["front"][:, 0].tolist(), strict=True))
    assert heights[30.0] == pytest.approx(5.0)
    assert heights[100.0] == pytest.approx(7.0)
    assert heights[300.0] == pytest.approx(2.0 + 3.0j)
    assert abs(heights[600.0]) < 1e-9
    assert max(heights) == 630.0  # nothing above the limit
    # One that is taken off: its second harmonic is alone at 400 Hz.
    off = motion(1.0 / 200.0, {1: 2.0, 2: 4.0j, 3: 3.0}, weight=-1)
    solved = SimpleNamespace(motions=(off, fast, slow), superposed=object())
    found = lines_of_steady(solved, 650.0)
    heights = dict(zip(np.round(found.frequencies, 6).tolist(), found.forces["front"][:, 0].tolist(), strict=True))
    assert heights[400.0] == pytest.approx(-4.0j)
    assert heights[600.0] == pytest.approx(-3.0)
    # Of several motions at one speed on a branch the first is taken.
    branch: Any = SimpleNamespace(motions=(fast, slow), superposed=None)
    assert lines_of_steady(branch, 650.0).forces["front"][2, 0] == pytest.approx(3.0j)


def test_bearings_share_the_frequencies_of_their_tones() -> None:
    """Two bearings; the second holds a moment as well, which is of another unit: its own tone at 300 Hz has no say."""
    times = 1e-4 * np.arange(6000)
    tones = {211.3: ([1.0, 0.5j], [0.2, 3.0]), 488.85: ([0.3 - 0.2j, 0.1], [-0.5j, 1.0j])}

    def forces(bearing: int) -> FloatArray:
        parts = [np.outer(a[bearing], np.exp(2j * np.pi * hertz * times)).real for hertz, a in tones.items()]
        return np.asarray(np.sum(parts, axis=0))

    back = forces(1)
    back[1] += 50.0 * np.cos(2.0 * np.pi * 300.0 * times)
    spectra = {name: amplitude_spectrum(one, 1e-4, "hann") for name, one in (("front", forces(0)), ("back", back))}
    found = tones_of(spectra, {"front": (0, 1), "back": (0, 3)}).between(100.0, 1000.0)
    assert found.frequencies == pytest.approx(list(tones), abs=1e-3)
    for row, (of_front, of_back) in enumerate(tones.values()):
        np.testing.assert_allclose(found.forces["front"][row], of_front, atol=2e-3)
        np.testing.assert_allclose(found.forces["back"][row], of_back, atol=5e-3)


@pytest.mark.slow
def test_a_record_of_broken_turns_sounds_as_one_of_whole_turns() -> None:
    whole, broken = quick_run(24.0).solved, quick_run(24.37).solved
    assert whole.transient is not None
    assert broken.transient is not None
    assert whole.sound is not None
    assert broken.sound is not None
    windows = [one.transient.record.sampling.window for one in (whole, broken)]  # type: ignore[union-attr]
    # Spectra of a record of broken turns are those of its last whole periods.
    assert windows == ["uniform", "uniform"]
    expected = {line.name: line for line in whole.sound.lines if line.level_db > whole.sound.total_db - 40.0}
    found = {line.name: line for line in broken.sound.lines}
    assert len(expected) >= 8
    for name, line in expected.items():
        assert found[name].frequency_hz == pytest.approx(line.frequency_hz, abs=0.01)
        assert found[name].level_db == pytest.approx(line.level_db, abs=0.1)
    assert broken.sound.total_db == pytest.approx(whole.sound.total_db, abs=0.1)
    # A tone is one line.
    assert np.diff(sorted(line.frequency_hz for line in found.values())).min() > 40.0


@pytest.mark.slow
@pytest.mark.parametrize("revolutions", [24.0, 24.37])
def test_a_sweep_takes_the_strongest_lines_of_a_run(revolutions: float) -> None:
    result = quick_run(revolutions)
    solved = result.solved
    assert solved.transient is not None
    assert solved.sound is not None
    case = gw.load("small-gearbox", QUICK | {"acoustics.lines": 5}).case
    frequencies, rates, names = strongest_lines(acoustics_of(case), solved.transient)
    named = {line.frequency_hz: line.name for line in solved.sound.lines}
    assert [one.name for one in names] == [named[hertz] for hertz in frequencies.tolist()]
    lines = {line.frequency_hz: line for line in solved.sound.lines}
    assert len(frequencies) == 5
    assert frequencies[0] == pytest.approx(90.0, abs=0.01)
    assert set(frequencies.tolist()) <= set(lines)
    for hertz, rate in zip(frequencies.tolist(), rates, strict=True):
        of_run = lines[hertz].sound.coordinates.sum(axis=1)
        np.testing.assert_allclose(rate[:, 0] + 1j * rate[:, 1], of_run, rtol=1e-9)


@pytest.mark.slow
def test_the_surface_moves_as_a_sensor_on_it_feels() -> None:
    """Velocity of the radiating surface at two sensors on walls, against their spectra in the same record."""
    solved = quick_run(24.0).solved
    assert solved.transient is not None
    assert solved.sound is not None
    spectra = solved.transient.sensor_spectra
    lines = [line for line in solved.sound.lines if line.level_db > solved.sound.total_db - 35.0]
    assert len(lines) >= 3
    for name, place in (("top", [0.02, 0.16, 0.03]), ("right wall", [0.11, 0.09, -0.02])):
        surface = lines[0].sound.fields[0].surface
        corners = surface.points[surface.triangles] - np.array(place)
        # Weights of the corners of the triangle that holds the sensor: the plane through it is the wall's.
        weights = np.array(
            [np.linalg.lstsq(np.vstack([one.T, np.ones(3)]), [0, 0, 0, 1], rcond=None)[0] for one in corners]
        )
        off = np.linalg.norm(np.einsum("ij,ijk->ik", weights, corners), axis=1)
        (number,) = np.flatnonzero((off < 1e-4) & (weights > -1e-6).all(axis=1))[:1]
        for line in lines:
            (field,) = line.sound.fields
            assert field.surface is surface
            velocity = weights[number] @ field.velocity.reshape(-1, 3, field.velocity.shape[1])[number].sum(axis=1)
            spectrum = spectra[name]
            at = int(np.argmin(np.abs(spectrum.frequencies - line.frequency_hz)))
            felt = spectrum.lines[at] / (2j * np.pi * line.frequency_hz)
            assert abs(velocity - felt) < 0.08 * abs(felt), (name, line.name)


@pytest.mark.slow
def test_lines_beyond_the_wanted_number_and_frequency_are_named() -> None:
    """Two lines up to 2 kHz: the next ones and the mesh frequency are left out with their part of the whole."""
    result = quick_run(24.0)
    every = result.solved.sound
    assert every is not None
    study = sounding_gearbox(QUICK | {"acoustics.lines": 2, "acoustics.highest_frequency": "2 kHz"})
    case = study.case
    transient = result.solved.transient
    assert transient is not None
    field = sounding_housing().displacement_field
    found = solve_sound(acoustics_of(case), field, lines_of_run(transient, 3000.0), transient.machine)
    # Powers by the same estimate: that of the walls' velocity, times the efficiency of a sphere that pulsates.
    radius = np.sqrt(every.lines[0].sound.area / (4.0 * np.pi))
    squares = {line.name: (2.0 * np.pi * line.frequency_hz / 343.2 * radius) ** 2 for line in every.lines}
    powers = {line.name: line.sound.power * squares[line.name] / (1.0 + squares[line.name]) for line in every.lines}
    shares = {name: power / sum(powers.values()) for name, power in powers.items()}
    assert [line.name for line in found.lines] == ["1× input", "22× input"]
    assert found.covered == pytest.approx(sum(shares[line.name] for line in found.lines), rel=0.01)
    left_out = {one.name: one for one in found.left_out}
    assert left_out["1× pinion -> wheel"].share == pytest.approx(shares["1× pinion -> wheel"], rel=0.01)
    assert left_out["23× input"].share == pytest.approx(shares["23× input"], rel=0.01)
    assert "1× input" not in left_out
    known = [one.share for one in found.left_out if one.share is not None]
    assert known == sorted(known, reverse=True)
    assert min(known) >= 1e-3
    # Beyond the modes nothing is known of the harmonics.
    high = {name: (one.frequency_hz, one.share) for name, one in left_out.items() if one.share is None}
    assert high == {
        "2× pinion -> wheel": (pytest.approx(5040.0), None),
        "3× pinion -> wheel": (pytest.approx(7560.0), None),
    }


RUN_UP = {
    "transient.run": {"from": "5000 rpm", "to": "5500 rpm", "time": "0.1 s"},
    "transient.revolutions": "",
    "transient.discard": 1,
    "transient.tolerance": 1e-3,
}
BASE = {"operation.base": {"harmonic": [{"frequency": "300 Hz", "y": "3 m/s^2"}]}, "transient.tolerance": 1e-3}


@pytest.mark.slow
def test_a_run_up_has_no_lines_but_microphones_over_time(monkeypatch: pytest.MonkeyPatch) -> None:
    # Fewer frequencies than of a user's run: that there is a sound over time, not how close it is, counts here.
    monkeypatch.setattr("gearwhine.solve.kept_radiation.POINTS", 17)
    result = sounding_gearbox(TOP | RUN_UP).run()
    sound = result.solved.sound
    assert sound is not None
    assert sound.lines == ()
    assert sound.modes
    assert sound.histories is not None
    assert np.abs(sound.histories.pressure).max() > 0.0
    (told,) = [one for one in result.document["warnings"] if one["name"] == "sound_left_out"]
    assert told["message"].startswith("the sound of lines is left out: the speed changes")
    assert result.document["sound"]["total_db"] is None


@pytest.mark.slow
def test_on_a_moving_base_neither_lines_nor_microphones_are_heard() -> None:
    """The base shakes the housing itself, which the bearings' forces do not know."""
    study = sounding_gearbox(TOP | BASE)
    for result in (study.run(), study.sound()):
        sound = result.solved if result.command == "sound" else result.solved.sound
        assert sound.modes
        assert (sound.lines, sound.histories) == ((), None)
        (told,) = [one for one in result.document["warnings"] if one["name"] == "sound_left_out"]
        assert told["message"].startswith("the sound of the motion is left out: the base moves")


@pytest.mark.slow
@pytest.mark.parametrize("changes", [RUN_UP, BASE])
def test_a_sweep_leaves_out_what_a_run_leaves_out(changes: dict[str, Any]) -> None:
    case = sounding_gearbox(TOP | changes).case
    keys, swept = swept_keys(case, ["operation.torque=10 N*m,20 N*m"]), [swept_point(case, "10 N*m")]
    (told,), *_ = add_sound(case, keys, swept, sounding_housing())
    assert told["name"] == "sound_left_out"
    solved = quick_run(24.0).solved.transient
    assert solved is not None
    machine = solved.machine
    changed = {"speed_profile": object()} if changes is RUN_UP else {"loads": replace(machine.loads, base=object())}
    moving = replace(solved, machine=replace(machine, **changed))
    assert len(sounding_lines(moving, acoustics_of(case))[0]) == 0


def test_a_sweep_tells_which_of_its_points_have_no_lines() -> None:
    """Whether the case that is swept has them or not."""
    steady, moving = (sounding_gearbox(TOP | changes).case for changes in ({}, BASE))
    keys = swept_keys(steady, ["operation.torque=10 N*m,20 N*m,30 N*m"])
    for case in (steady, moving):
        swept = [swept_point(one, text) for one, text in ((steady, "10 N*m"), (moving, "20 N*m"), (steady, "30 N*m"))]
        (told,), _, radiated = add_sound(case, keys, swept, sounding_housing())
        assert told["message"].startswith("at 1 of 3 points, such as operation.torque=20 N*m, the sound of the motion")
        assert radiated is not None


ALUMINIUM = 'material.aluminium={youngs_modulus="71 GPa", poisson_ratio=0.33, density="2700 kg/m^3"}'


@pytest.mark.parametrize(
    "over",
    [
        "housing.material=steel,aluminium",
        "rotor[0].material,housing.material=steel,aluminium",
        "bearing.input-back.at=20 mm,22 mm",
        "acoustics.speed_of_sound=340 m/s,350 m/s",
        "rotor[0].material=steel,aluminium",
        "housing.damping_ratio=0.01,0.02",
    ],
)
def test_points_of_a_sweep_share_the_modes_that_radiate(over: str) -> None:
    """Natural modes follow from stiffness and mass, and attachments from the places of the bearings: not from damping.

    Of the same rates of the same modes in the same air the power is the same.
    """
    settings = ["acoustics.method=rayleigh", "acoustics.faces=['top']", "acoustics.highest_frequency=3 kHz", ALUMINIUM]
    case = load_case("small-gearbox", settings).case
    keys = swept_keys(case, [over])
    points = sweep_points(load_case("small-gearbox", settings).source, keys)
    radiation = build_radiation(acoustics_of(case), sounding_housing().displacement_field)
    rates = np.zeros((1, radiation.modal[0].shape[1], 2))
    rates[0, 4] = [1e-3, 2e-3]
    named: Any = {"line_names": ("10× input",), "line_kinds": ("other",)}
    swept = [
        SweptPoint(
            point,
            PointResult({}, ReducedMotion(np.zeros(0), line_frequencies=np.array([900.0]), line_rates=rates, **named)),
            False,
        )
        for point in points
    ]
    told, *_ = add_sound(case, keys, swept, sounding_housing())
    sounds = [one.outcome.document.get("sound") for one in swept if isinstance(one.outcome, PointResult)]
    if over.startswith(("rotor[0].material=", "housing.damping_ratio")):
        assert told == []
        assert sounds[0] == sounds[1] is not None
    else:
        assert "sound of a sweep is left out" in told[0]["message"]
        assert sounds == [None, None]


def test_the_box_of_microphones_stands_on_the_floor() -> None:
    """Nine places 1 m from the reference box, which reaches down to the floor (ISO 3744:2010, 7.2.4)."""
    case = gw.load("small-gearbox", {"acoustics.floor": "-200 mm", "acoustics.microphone_box": "1 m"}).case
    housing = sounding_housing()
    places, area = acoustics_of(case).microphones(housing.mesh.bounds)
    low, high = housing.mesh.bounds
    sides, height = high - low + 2.0, high[1] + 1.0 + 0.2
    assert area == pytest.approx(sides[0] * sides[2] + 2.0 * height * (sides[0] + sides[2]))
    assert places["box 1"][1] == pytest.approx(-0.2 + 0.5 * height)
    assert places["box 5"][1] == pytest.approx(high[1] + 1.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"acoustics.microphone_box": "1 m"}, "acoustics.floor: expected a 'floor' such as"),
        (
            TOP | {"acoustics.microphone_box": "1 m"},
            "acoustics.microphone_box: expected no box of microphones with the method 'rayleigh'",
        ),
        ({"acoustics.microphone": [EAR, EAR | {"name": "box 3"}]}, r"microphone\[1\].name .*: expected another name"),
    ],
)
def test_refuses_a_box_without_a_floor_and_its_names(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(CaseError, match=message):
        gw.load("small-gearbox", changes)


MESH = "1× pinion -> wheel"


@pytest.mark.slow
def test_titles_of_operating_shapes_have_arrows() -> None:
    solved = quick_run(24.0).solved
    assert solved.signature is not None
    surface = drawn_housing(sounding_housing().mesh)
    lines = [line for line in highest_lines(solved.signature, 3000.0, 6) if "->" in line.name]
    titles = [operating_shape_of_line(line, sounding_housing().modes, surface).title for line in lines]
    assert "Operating shape at 2520.0 Hz   1× pinion → wheel" in titles
    assert not any("->" in title for title in titles)


@pytest.mark.slow
def test_operating_shapes_of_a_record_of_broken_turns_are_those_of_one_of_whole_turns() -> None:
    """A mesh line between two lines of the spectrum has its frequency, and all of its amplitude, in every mode."""
    broken_turns = sounding_gearbox(QUICK | {"transient.revolutions": 24.37, "transient.discard": 16.0})
    signatures = [one.solved.signature for one in (quick_run(24.0), broken_turns.simulate())]
    whole, broken = ([line for line in highest_lines(one, 3000.0, 6) if line.name == MESH] for one in signatures if one)
    assert broken[0].hertz == pytest.approx(whole[0].hertz, abs=0.05)
    sizes, others = (np.abs(lines[0].shape.modal) for lines in (whole, broken))
    np.testing.assert_allclose(others, sizes, rtol=0.01, atol=0.01 * sizes.max())


@pytest.mark.parametrize(("amplitude", "shown"), [(147.0, "150"), (0.0583, "0.058"), (3.0, "3"), (12345.0, "12000")])
def test_two_digits_of_a_line_have_no_exponent(amplitude: float, shown: str) -> None:
    assert motion_words({"frequency_hz": 733.3, "amplitude_m_per_s2": amplitude}) == f"733 ({shown})"
