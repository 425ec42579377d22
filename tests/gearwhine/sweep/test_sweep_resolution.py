"""Peaks between the points of a sweep: a single resonance by its formula, and a gearbox's found by its motion."""

import shlex
import subprocess
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.case import SweptKey, case_document, dump_case
from gearwhine.case.swept_keys import parse_over
from gearwhine.coupling import amplitude_spectrum
from gearwhine.coupling.sweep.missed_peaks import MissedPeak, speeds_to_add
from gearwhine.coupling.sweep.reduced_motion import ReducedMotion
from gearwhine.coupling.sweep.resonances import PLACES_ABOUT_MODE, SOUND, Resonances
from gearwhine.output.quantity import document_of
from gearwhine.output.sections import Finding, Table
from gearwhine.results.first_page import first_page
from gearwhine.results.sweep import PEAK, sections
from gearwhine.sweep.resolution import missed_peaks, over_with, peak_warnings
from gearwhine.sweep.solution import PointResult

ORDER, NATURAL, RATIO = 28.0, 700.0, 0.01
TEETH = "pinion -> wheel"


def size(frequencies: Any, natural: float = NATURAL) -> Any:
    """Square of a single mass's velocity by a unit force, over that at its resonance."""
    ratio = np.asarray(frequencies) / natural
    return 1.0 / (1.0 + ((ratio - 1.0 / ratio) / (2.0 * RATIO)) ** 2)


def level(frequencies: Any, natural: float = NATURAL) -> Any:
    """Level of a line that is at 90 dB at the resonance."""
    return 90.0 + 10.0 * np.log10(size(frequencies, natural))


def resonances(
    rpm: float, natural: float = NATURAL, *, output: str = SOUND, order: float = ORDER, over: float = 3.0
) -> Resonances:
    """Linear response of the one line, lower than the motion has it."""
    width = RATIO * natural
    return Resonances(
        frequencies=np.array([natural]),
        half_widths=np.array([width]),
        names=("housing: housing",),
        lines=(f"1× {TEETH}",),
        line_orders=np.array([order]),
        outputs=(output,),
        line_levels=level([[order * abs(rpm) / 60.0]], natural) - over,
        levels_near=level(natural + width * PLACES_ABOUT_MODE, natural)[None, None, None] - over,
        line_rates=np.zeros((1, 0), dtype=complex),
        mode_rates=np.zeros((1, 1, 0), dtype=complex),
    )


def point(number: int, rpm: float, found: Resonances, *, other: float = 0.0, natural: float = NATURAL) -> Any:
    """Point of a sweep whose first mesh harmonic is at 90 dB at the resonance, beside others [dB]."""
    heard = float(level(ORDER * abs(rpm) / 60.0, natural))
    line = {"order": ORDER, "sound_power_db": heard, "kind": "mesh", "name": f"1× {TEETH}"}
    total = 10.0 * np.log10(10.0 ** (0.1 * heard) + 10.0 ** (0.1 * other))
    motion = ReducedMotion(np.zeros(0), resonances=found)
    result = PointResult({"sound": {"lines": [line], "total_db": total}}, motion)
    place = SimpleNamespace(speed=rpm * np.pi / 30.0, place=(number,), texts=(f"{rpm:g} rpm",))
    return SimpleNamespace(point=place, outcome=result)


def swept(*speeds: float, other: float = 0.0) -> tuple[list[SweptKey], list[Any]]:
    texts = tuple(f"{speed:g} rpm" for speed in speeds)
    points = [point(number, speed, resonances(speed), other=other) for number, speed in enumerate(speeds)]
    return [SweptKey("operation.speed", texts, speeds, "rpm")], points


def test_a_peak_between_two_points_has_the_speed_and_level_of_the_resonance() -> None:
    """The mode is met at 1500 rpm, 100 rpm from the nearer point: 10 log(1 + 6.90²) = 16.9 dB above it."""
    keys, points = swept(1000.0, 1400.0, 1650.0)
    (peak,) = missed_peaks(keys, points)
    assert (peak.below_rpm, peak.above_rpm) == (pytest.approx(1400.0), pytest.approx(1650.0))
    assert peak.speed_rpm == pytest.approx(60.0 * NATURAL / ORDER, abs=0.1)
    assert peak.half_width_rpm == pytest.approx(15.0)
    assert peak.damping_ratio == pytest.approx(RATIO)
    assert peak.level_db == pytest.approx(90.0, abs=0.05)
    assert peak.found_over_linear_db == pytest.approx(3.0)
    assert peak.rise_db == pytest.approx(-10.0 * np.log10(size(1400.0 / 60.0 * ORDER)), abs=0.05)
    assert (peak.line, peak.mode, peak.output) == (f"1× {TEETH}", "housing: housing", SOUND)
    assert speeds_to_add([peak]) == [1500.0]
    assert over_with(keys, points, [1500.0]) == "--over 'operation.speed=1000 rpm,1400 rpm,1500 rpm,1650 rpm'"
    (told,) = peak_warnings([peak])
    assert told["message"].endswith("16.9 dB above the louder point; add 1500 rpm")
    assert "half-power bandwidth of 30 rpm" in told["message"]


def test_points_that_resolve_the_peak_or_stand_above_it_miss_nothing() -> None:
    assert missed_peaks(*swept(1400.0, 1486.0, 1600.0)) == []  # 14 rpm off, within half the bandwidth
    assert len(missed_peaks(*swept(1400.0, 1484.0, 1600.0))) == 1
    assert missed_peaks(*swept(1600.0, 1700.0, 1800.0)) == []
    assert missed_peaks(*swept(1400.0, 1650.0, other=91.0)) == []
    assert missed_peaks(*swept(-1400.0, 1650.0)) == []  # through a standstill


def test_a_line_that_the_linear_response_does_not_make_is_not_followed() -> None:
    """A mesh that hardly excites, beside another cause of the same order: 30 dB above all that the mesh could do."""
    keys, points = swept(1400.0, 1650.0)
    for one, rpm in zip(points, (1400.0, 1650.0), strict=True):
        object.__setattr__(one.outcome.motion, "resonances", resonances(rpm, over=30.0))
    assert missed_peaks(keys, points) == []


def test_a_mode_that_moves_with_the_speed_is_met_where_it_is_there() -> None:
    """From 690 Hz at 1400 rpm to 710 Hz at 1650 rpm: o n / 60 = f (n) = 690 Hz + 0.08 Hz/rpm (n - 1400 rpm).

    Its peak is as high at either point, and so it is between them.
    """
    naturals = {1400.0: 690.0, 1650.0: 710.0}
    points = [point(n, rpm, resonances(rpm, f), natural=f) for n, (rpm, f) in enumerate(naturals.items())]
    keys, _ = swept(*naturals)
    (peak,) = missed_peaks(keys, points)
    met = (690.0 - 0.08 * 1400.0) / (ORDER / 60.0 - 0.08)
    assert peak.speed_rpm == pytest.approx(met, abs=3.0)
    assert peak.level_db == pytest.approx(90.0, abs=0.05)


def test_the_sound_of_a_peak_is_radiated_as_the_lines_are() -> None:
    """A mode that radiates 4 dB more than even walls would: at both points, from which the peak is told, less so."""
    keys, points = swept(1400.0, 1650.0)
    for one, rpm in zip(points, (1400.0, 1650.0), strict=True):
        found = one.outcome.motion.resonances
        rates = 1e4 * np.sqrt(size(ORDER * rpm / 60.0))
        object.__setattr__(found, "mode_rates", np.full((1, 1, 1), 1e4 + 0j))
        object.__setattr__(found, "line_rates", np.full((1, 1), rates + 0j))

    def radiated(hertz: float, rates: Any) -> float:
        return 10.0 * float(np.log10(abs(rates[0]) ** 2)) + (4.0 if abs(hertz - NATURAL) < 1.0 else 0.0)

    (peak,) = missed_peaks(keys, points, radiated)
    assert peak.level_db == pytest.approx(94.0, abs=0.05)


def of_a_sensor(points: list[Any], rpms: tuple[float, ...], order: float = ORDER) -> None:
    """Leave a sensor, the roof, in place of the sound."""
    for one, rpm in zip(points, rpms, strict=True):
        one.outcome.document.pop("sound")
        object.__setattr__(one.outcome.motion, "resonances", resonances(rpm, output="roof", order=order))


def test_without_sound_a_sensor_misses_its_peak() -> None:
    """Its level is that of its rms re 1 µm/s²: an amplitude of √2 1e-6 m/s² is at 0 dB."""
    keys, points = swept(1400.0, 1650.0)
    of_a_sensor(points, (1400.0, 1650.0))
    for one, rpm in zip(points, (1400.0, 1650.0), strict=True):
        amplitude = np.sqrt(2.0) * 1e-6 * 10.0 ** (level(ORDER * rpm / 60.0) / 20.0)
        object.__setattr__(one.outcome.motion, "orders", np.array([0.0, 27.0, ORDER, 29.0]))
        object.__setattr__(one.outcome.motion, "sensor_spectra", {"roof": np.array([1e9, 0.0, amplitude, 0.0])})
    (peak,) = missed_peaks(keys, points)
    assert peak.output == "roof"
    assert peak.level_db == pytest.approx(90.0, abs=0.05)
    assert peak.rise_db == pytest.approx(16.9, abs=0.1)
    written = document_of(PEAK, peak)
    assert written["level_re"] == "1e-6 m/s2 rms"
    assert written["rms_m_per_s2"] == pytest.approx(1e-6 * 10.0 ** (90.0 / 20.0), rel=0.01)


def test_a_sensor_in_a_node_at_the_points_has_the_correction_of_all_sensors() -> None:
    """Half of the line there is of another cause, 60 dB below the roof's: 20 dB over the response near its node."""
    keys, points = swept(1400.0, 1650.0)
    of_a_sensor(points, (1400.0, 1650.0))
    for one, rpm in zip(points, (1400.0, 1650.0), strict=True):
        found = one.outcome.motion.resonances
        amplitude = np.sqrt(2.0) * 1e-6 * 10.0 ** (level(ORDER * rpm / 60.0) / 20.0)
        object.__setattr__(found, "outputs", ("roof", "node"))
        object.__setattr__(found, "line_levels", np.concatenate([found.line_levels, found.line_levels - 80.0]))
        object.__setattr__(found, "levels_near", np.concatenate([found.levels_near, found.levels_near]))
        object.__setattr__(one.outcome.motion, "orders", np.array([0.0, 27.0, ORDER, 29.0]))
        spectra = {"roof": np.array([0.0, 0.0, amplitude, 0.0]), "node": np.array([0.0, 0.0, 1e-3 * amplitude, 0.0])}
        object.__setattr__(one.outcome.motion, "sensor_spectra", spectra)
    (peak,) = missed_peaks(keys, points)
    assert peak.output == "node"
    assert peak.level_db == pytest.approx(90.0, abs=0.05)


@pytest.mark.parametrize(("window", "order"), [("uniform", ORDER), ("hann", ORDER), ("hann", 28.05)])
def test_levels_of_a_sensor_are_the_same_under_either_window(window: Any, order: float) -> None:
    """A sine as high as the resonance asks for, in a record of ten turns: all of it is this line.

    Under Hann's window it stands in three or four lines, none of which is as high as it where it lies between two.
    """
    keys, points = swept(1400.0, 1650.0)
    of_a_sensor(points, (1400.0, 1650.0), order)
    turns = np.arange(4000) / 400.0
    for one, rpm in zip(points, (1400.0, 1650.0), strict=True):
        amplitude = np.sqrt(2.0) * 1e-6 * 10.0 ** (level(order * rpm / 60.0) / 20.0)
        spectrum = amplitude_spectrum(amplitude * np.sin(2.0 * np.pi * order * turns), 1.0 / 400.0, window)
        object.__setattr__(one.outcome.motion, "orders", spectrum.frequencies)
        object.__setattr__(one.outcome.motion, "sensor_spectra", {"roof": spectrum.amplitude})
        object.__setattr__(one.outcome.motion, "window", window)
    (peak,) = missed_peaks(keys, points)
    assert peak.level_db == pytest.approx(90.0, abs=0.05)
    louder = max(float(size(order * rpm / 60.0)) for rpm in (1400.0, 1650.0))
    assert peak.rise_db == pytest.approx(-10.0 * np.log10(louder), abs=0.05)


def test_a_machine_that_turns_the_other_way_meets_the_same_mode() -> None:
    keys, points = swept(-1400.0, -1650.0)
    (peak,) = missed_peaks(keys, points)
    assert peak.speed_rpm == pytest.approx(1500.0, abs=0.1)
    assert over_with(keys, points, [1500.0]) == "--over 'operation.speed=-1650 rpm,-1500 rpm,-1400 rpm'"


def with_modes(points: list[Any], *others: float) -> None:
    """Give all points further modes without any response of their own."""
    naturals = np.array(sorted([NATURAL, *others]))
    widths = RATIO * naturals
    for one in points:
        found = one.outcome.motion.resonances
        near = level(naturals[:, None] + widths[:, None] * PLACES_ABOUT_MODE) - 3.0
        object.__setattr__(found, "frequencies", naturals)
        object.__setattr__(found, "half_widths", widths)
        object.__setattr__(found, "names", tuple(f"mode at {natural:g}" for natural in naturals))
        object.__setattr__(found, "levels_near", near[None, None])
        object.__setattr__(found, "mode_rates", np.zeros((1, len(naturals), 0), dtype=complex))


def test_a_mode_on_the_flank_of_another_is_not_told() -> None:
    keys, points = swept(1400.0, 1650.0)
    with_modes(points, 725.0)
    assert [peak.mode for peak in missed_peaks(keys, points)] == ["mode at 700"]


def test_modes_within_one_half_power_band_are_one_peak() -> None:
    keys, points = swept(1400.0, 1650.0)
    with_modes(points, NATURAL - 0.5)
    assert len(missed_peaks(keys, points)) == 1


def test_the_further_speeds_go_with_all_other_keys_through_a_shell() -> None:
    """The options that a shell reads are a grid with all points of the old one."""
    over = ["operation.speed=1400 rpm,1650 rpm", "gear_pair.*.damping_ratio=0.03,0.06", "title='it, and $HOME',b"]
    keys = [parse_over(text) for text in over]
    _, points = swept(1400.0, 1650.0)
    command = over_with(keys, points, [1500.0])
    shell = subprocess.run(["sh", "-c", f"printf '%s\\n' {command}"], capture_output=True, text=True, check=True)
    words = shell.stdout.splitlines()
    assert words[::2] == ["--over"] * 3
    speeds, *others = (parse_over(text) for text in words[1::2])
    assert speeds.texts == ("1400 rpm", "1500 rpm", "1650 rpm")
    assert others == keys[1:]


def test_speeds_that_are_one_are_added_once() -> None:
    def peak(speed: float, rise: float) -> MissedPeak:
        return MissedPeak({}, 1000.0, 2000.0, speed, 15.0, "1×", 700.0, 0.01, "", SOUND, 80.0, 0.0, rise)

    assert speeds_to_add([peak(1523.4, 9.0), peak(1528.0, 7.0), peak(1203.6, 3.0)]) == [1204.0, 1523.0]


COARSE = {
    "acoustics.method": "erp",
    "acoustics.mesh_size": "34 mm",
    "acoustics.highest_frequency": "2.5 kHz",
    "housing.box.mesh_size": "50 mm",
    "transient.revolutions": 10,
    "transient.discard": 8,
    "transient.tolerance": 1e-3,
}


@pytest.fixture(scope="module")
def sweeps(swept_here: None, tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], dict[str, Any]]:
    """Two speeds of the small gearbox, then the same with those that the first sweep asks for."""
    folder: Path = tmp_path_factory.mktemp("sweep")
    study = gw.load("small-gearbox", COARSE)
    first = study.sweep(["operation.speed=4000 rpm,5000 rpm"], folder=folder, workers=1).document
    over = shlex.split(first["over_with_peaks"])[1]
    return first, study.sweep([over], folder=folder, workers=1).document


@pytest.mark.slow
def test_the_speeds_that_a_gearbox_passes_by_are_as_loud_as_told(sweeps: tuple[dict[str, Any], dict[str, Any]]) -> None:
    first, second = sweeps
    peak = max(first["missed_peaks"], key=lambda one: one["level_db"])
    assert (peak["line"], peak["output"]) == (f"1× {TEETH}", "sound")
    assert peak["rise_db"] > 6.0
    totals = {point["values"]["speed"]: point["sound"]["total_db"] for point in second["points"]}
    (speed,) = [speed for speed in totals if abs(speed - peak["speed_rpm"]) < 0.2 * peak["half_width_rpm"]]
    # What varies with the mesh stiffness, spur teeth's, is not in the estimate.
    assert totals[speed] == pytest.approx(peak["level_db"], abs=1.5)
    assert totals[speed] > max(totals[4000.0], totals[5000.0]) + 6.0
    assert second["resumed"] == 2
    assert second["missed_peaks"] == []


@pytest.mark.slow
def test_terminal_tells_the_loudest_line_its_mode_and_the_speeds_to_add(
    sweeps: tuple[dict[str, Any], dict[str, Any]],
) -> None:
    first, second = sweeps
    (section,) = sections(first)
    _, points, peaks = (part for part in section.content if isinstance(part, Table))
    columns, cells = points.filled()
    row = dict(zip([column.heading.replace("\n", " ") for column in columns], cells[1], strict=True))
    found = first["points"][1]["sound"]
    loudest = max(found["lines"], key=lambda line: line["sound_power_db"])
    largest = max(loudest["contributions"]["housing_modes"], key=lambda part: abs(part["share"]))
    assert row["loudest line"] == loudest["name"].replace("->", "→")
    assert (row["L_W [dB]"], row["L_WA [dB]"]) == (f"{found['total_db']:.1f}", f"{found['total_db_a']:.1f}")
    assert row["its L_W [dB]"] == f"{loudest['sound_power_db']:.1f}"
    number, share = largest["name"].removeprefix("housing mode "), f"{100.0 * largest['share']:.0f} %"
    assert row["most by mode"].startswith(f"{number} at ")
    assert row["most by mode"].endswith(f" Hz, {share}")
    assert found["loudest"]["mode"] == int(number)
    assert len(peaks.rows) == len(first["missed_peaks"])
    said = " ".join(section.sentences)
    assert f"Add {', '.join(f'{speed:g} rpm' for speed in first['speeds_to_add_rpm'])};" in said
    assert first["over_with_peaks"] in said
    (warned,) = [one for one in first["warnings"] if one["name"] == "sweep_resolution"]
    assert warned["speeds_rpm"] == first["speeds_to_add_rpm"]
    assert "Add" not in " ".join(sections(second)[0].sentences)


def split_torque() -> dict[str, Any]:
    """Helical bull gear with a pinion on either side, one of them on a shaft beside the housing."""
    document = case_document(gw.load("small-gearbox", {"housing.box.mesh_size": "50 mm"}).case)
    for name in ("measured", "provenance"):
        document.pop(name)
    output = document["rotor"][1]
    document["rotor"] += [output | {"name": "third", "axis": ["-125.4125 mm", "80 mm"]}]
    for bearing in document["bearing"]:
        bearing["stiffness"] = {"matrix": np.diag([1.2e8, 1.2e8, 5e7, 0.0, 0.0]).tolist()}
    document["bearing"] += [
        bearing | {"name": bearing["name"].replace("output", "third"), "rotor": "third", "seat": "ground"}
        for bearing in document["bearing"][2:]
    ]
    module = 3.175e-3 * float(np.cos(np.radians(15.0)))
    bull, wheel = (
        gear | {"face_width": "20 mm", "module": module, "helix_angle": f"{angle} deg"}
        for gear, angle in zip(document["gear"], (15, -15), strict=True)
    )
    document["gear"] = [bull, wheel, wheel | {"name": "small", "rotor": "third", "teeth": 23}]
    document["gear_pair"] = [{"driver": "pinion", "driven": one, "damping_ratio": 0.05} for one in ("wheel", "small")]
    document["operation"] = {
        "speed": "3400 rpm",
        "torque": "71.77 N*m",
        "output": [{"rotor": "output", "torque": "40 N*m"}, {"rotor": "third", "torque": 31.77 * 23.0 / 28.0}],
    }
    document["transient"] = {"revolutions": 2, "discard": 1, "method": "auto"}
    return document


@pytest.mark.slow
def test_a_peak_by_load_shuttling_in_two_meshes_is_that_of_the_coupled_system_there(tmp_path: Path) -> None:
    """`system` solves the machine at the speed of the peak directly; the sweep has its points alone.

    The line is of both meshes, whose causes partly cancel: of either one alone, or without shuttling, it is another.
    """
    file = tmp_path / "case.toml"
    file.write_text(dump_case(gw.build(**split_torque()).case), encoding="utf-8")
    study = gw.load(str(file))
    over = ["operation.speed=3400 rpm,3900 rpm", "gear_pair.*.damping_ratio=0.05"]
    found = study.sweep(over, folder=tmp_path / "sweep", workers=1).document
    peak = next(
        one for one in found["missed_peaks"] if one["output"] == "right wall" and "0.05" in one["settings"].values()
    )
    assert peak["line"] == f"1× {TEETH}, 1× pinion -> small"
    assert peak["level_re"] == "1e-6 m/s2 rms"
    there = study.changed({"operation.speed": f"{peak['speed_rpm']} rpm"}).system().document["mesh_lines"][0]
    assert there["frequency_hz"] == pytest.approx(peak["frequency_hz"], rel=1e-6)
    amplitudes = {cause: values["right wall"] for cause, values in there["sensor_acceleration_m_per_s2"].items()}
    assert peak["rms_m_per_s2"] == pytest.approx(amplitudes["together"] / np.sqrt(2.0), rel=0.03)
    assert abs(amplitudes["by_transmission_error"] / amplitudes["together"] - 1.0) > 0.1
    assert abs(peak["found_over_linear_db"]) < 0.3
    # The report has the worst points' balances.
    worst = max(found["points"], key=lambda one: one["energy_error"])
    where = ", ".join(f"{key}={text}" for key, text in worst["settings"].items())
    said = [check.text for check in checks_of(found | {"command": "sweep"})]
    assert any(f"closes to {worst['energy_error']:.0e} or better; worst at {where}," in text for text in said)
    residual = max(one["load"]["residual"] for one in found["points"])
    assert any(f"forces balance to {residual:.0e} of the largest load or better" in text for text in said)


def checks_of(document: dict[str, Any]) -> list[Finding]:
    """Checks of the report's first page, passed or not."""
    (section,) = (section for section in first_page(None, [document], []) if section.title == "Are the results sound?")
    return [part for part in section.content if isinstance(part, Finding) and part.passed is not None]


def test_the_checks_of_a_sweep_are_those_of_its_worst_point() -> None:
    points = [
        {"settings": {"operation.speed": f"{rpm} rpm"}, "energy_error": error, "steps": 100, "load": {"residual": left}}
        for rpm, error, left in ((1000, 1e-4, 1e-9), (2000, 2e-2, 1e-12), (3000, 1e-3, 3e-4))
    ]
    energy, forces = checks_of({"command": "sweep", "points": points})
    assert (energy.passed, forces.passed) == (False, False)
    assert "2e-02 or better; worst at operation.speed=2000 rpm" in energy.text
    assert "3e-04 of the largest load or better; worst at operation.speed=3000 rpm" in forces.text
    assert [check.passed for check in checks_of({"command": "sweep", "points": points[:1]})] == [True, True]
