"""Peaks between the points of a sweep: a single resonance by its formula, and a gearbox's found by its motion."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from coupling import amplitude_spectrum
from gearwhine.case import SweptKey
from gearwhine.output.sections import Table
from gearwhine.results.sweep import sections
from gearwhine.sweep.resolution import MissedPeak, missed_peaks, over_with, peak_warnings, speeds_to_add
from gearwhine.sweep.resonances import SOUND, Resonances
from gearwhine.sweep.solution import PointResult

pytestmark = pytest.mark.slow

ORDER, NATURAL, RATIO = 28.0, 700.0, 0.01
TEETH = "pinion -> wheel"


def size(frequencies: Any, natural: float = NATURAL) -> Any:
    """Square of a single mass's velocity by a unit force, over that at its resonance."""
    ratio = np.asarray(frequencies) / natural
    return 1.0 / (1.0 + ((ratio - 1.0 / ratio) / (2.0 * RATIO)) ** 2)


def resonances(natural: float = NATURAL) -> Resonances:
    grid = np.unique(
        np.concatenate([np.linspace(20.0, 3000.0, 600), natural * (1.0 + RATIO * np.linspace(-8, 8, 161))])
    )
    response = 10.0 * np.log10(size(grid, natural))[None, None]
    widths = np.array([RATIO * natural])
    return Resonances(
        np.array([natural]),
        widths,
        ("housing: housing",),
        (TEETH,),
        np.array([ORDER]),
        grid,
        (SOUND,),
        response,
        np.zeros((1, 1, 0), dtype=complex),
        np.zeros((1, 0, 0), dtype=complex),
    )


def point(number: int, rpm: float, found: Resonances, *, other: float = 0.0, text: str = "") -> Any:
    """Point of a sweep whose first mesh harmonic is at 90 dB at the resonance of 700 Hz, beside others [dB]."""
    level = 90.0 + 10.0 * float(np.log10(size(ORDER * abs(rpm) / 60.0)))
    line = {"order": ORDER, "sound_power_db": level, "kind": "mesh", "name": f"1× {TEETH}"}
    total = 10.0 * np.log10(10.0 ** (0.1 * level) + 10.0 ** (0.1 * other))
    result = PointResult({"sound": {"lines": [line], "total_db": total}}, np.zeros(0), resonances=found)
    case = SimpleNamespace(operation=SimpleNamespace(speed=rpm * np.pi / 30.0))
    place = SimpleNamespace(case=case, place=(number,), texts=(text or f"{rpm:g} rpm",))
    return SimpleNamespace(point=place, outcome=result)


def swept(*speeds: float, other: float = 0.0) -> tuple[list[SweptKey], list[Any]]:
    texts = tuple(f"{speed:g} rpm" for speed in speeds)
    points = [point(number, speed, resonances(), other=other) for number, speed in enumerate(speeds)]
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
    assert peak.rise_db == pytest.approx(-10.0 * np.log10(size(1400.0 / 60.0 * ORDER)), abs=0.05)
    assert (peak.line, peak.mode, peak.output) == (f"1× {TEETH}", "housing: housing", SOUND)
    assert speeds_to_add([peak]) == [1500.0]
    assert over_with(keys, points, [1500.0]) == "--over operation.speed='1000 rpm,1400 rpm,1500 rpm,1650 rpm'"
    (told,) = peak_warnings([peak])
    assert told["message"].endswith("16.9 dB above the louder point; add 1500 rpm")
    assert "half-power bandwidth of 30 rpm" in told["message"]


def test_points_that_resolve_the_peak_or_stand_above_it_miss_nothing() -> None:
    assert missed_peaks(*swept(1400.0, 1486.0, 1600.0)) == []  # 14 rpm off, within half the bandwidth
    assert len(missed_peaks(*swept(1400.0, 1484.0, 1600.0))) == 1
    assert missed_peaks(*swept(1600.0, 1700.0, 1800.0)) == []
    assert missed_peaks(*swept(1400.0, 1650.0, other=91.0)) == []
    assert missed_peaks(*swept(-1400.0, 1650.0)) == []  # through a standstill


def test_the_sound_of_a_peak_is_radiated_as_the_lines_are() -> None:
    """A mode that radiates 4 dB more than even walls would: at both points, from which the peak is told, less so."""
    keys, points = swept(1400.0, 1650.0)
    for one, rpm in zip(points, (1400.0, 1650.0), strict=True):
        found = one.outcome.resonances
        rates = np.sqrt(size(ORDER * rpm / 60.0))
        object.__setattr__(found, "mode_rates", np.full((1, 1, 1), 2.0 + 0j))
        object.__setattr__(found, "harmonic_rates", np.full((1, 1, 1), 2.0 * rates + 0j))

    def radiated(hertz: float, rates: Any) -> float:
        return 10.0 * float(np.log10(abs(rates[0]) ** 2)) + (4.0 if abs(hertz - NATURAL) < 1.0 else 0.0)

    (peak,) = missed_peaks(keys, points, radiated)
    assert peak.level_db == pytest.approx(94.0, abs=0.05)


def test_without_sound_a_sensor_misses_its_peak() -> None:
    """Amplitudes of its line; their response is that of the velocity here."""
    keys, points = swept(1400.0, 1650.0)
    for one in points:
        (line,) = one.outcome.document.pop("sound")["lines"]
        object.__setattr__(one.outcome.resonances, "outputs", ("roof",))
        object.__setattr__(one.outcome, "orders", np.array([0.0, 27.0, ORDER, 29.0]))
        amplitude = 10.0 ** (line["sound_power_db"] / 20.0)
        object.__setattr__(one.outcome, "sensor_spectra", {"roof": np.array([1e9, 0.0, amplitude, 0.0])})
    (peak,) = missed_peaks(keys, points)
    assert peak.output == "roof"
    assert peak.level_db == pytest.approx(90.0, abs=0.05)
    assert peak.rise_db == pytest.approx(16.9, abs=0.1)


@pytest.mark.parametrize(("window", "order"), [("uniform", ORDER), ("hann", ORDER), ("hann", 28.05)])
def test_levels_of_a_sensor_are_the_same_under_either_window(window: Any, order: float) -> None:
    """A sine as high as the resonance asks for, in a record of ten turns: all of it is this line.

    Under Hann's window it stands in three or four lines, none of which is as high as it where it lies between two.
    """
    keys, points = swept(1400.0, 1650.0)
    turns = np.arange(4000) / 400.0
    for one, rpm in zip(points, (1400.0, 1650.0), strict=True):
        one.outcome.document.pop("sound")
        object.__setattr__(one.outcome.resonances, "outputs", ("roof",))
        object.__setattr__(one.outcome.resonances, "mesh_orders", np.array([order]))
        signal = 1e-2 * np.sqrt(size(order * rpm / 60.0)) * np.sin(2.0 * np.pi * order * turns)
        spectrum = amplitude_spectrum(signal, 1.0 / 400.0, window)
        object.__setattr__(one.outcome, "orders", spectrum.frequencies)
        object.__setattr__(one.outcome, "sensor_spectra", {"roof": spectrum.amplitude})
        object.__setattr__(one.outcome, "window", window)
    (peak,) = missed_peaks(keys, points)
    assert peak.level_db == pytest.approx(-40.0, abs=0.05)
    louder = max(float(size(order * rpm / 60.0)) for rpm in (1400.0, 1650.0))
    assert peak.rise_db == pytest.approx(-10.0 * np.log10(louder), abs=0.05)


def test_a_machine_that_turns_the_other_way_meets_the_same_mode() -> None:
    keys, points = swept(-1400.0, -1650.0)
    (peak,) = missed_peaks(keys, points)
    assert peak.speed_rpm == pytest.approx(1500.0, abs=0.1)
    assert over_with(keys, points, [1500.0]) == "--over operation.speed='-1650 rpm,-1500 rpm,-1400 rpm'"


def test_a_mode_on_the_flank_of_another_is_not_told() -> None:
    """A second mode without any response of its own."""
    keys, points = swept(1400.0, 1650.0)
    for one in points:
        found = one.outcome.resonances
        object.__setattr__(found, "frequencies", np.array([NATURAL, 720.0]))
        object.__setattr__(found, "half_widths", np.array([7.0, 7.2]))
        object.__setattr__(found, "names", ("housing: housing", "rotor: input"))
    assert [peak.mode for peak in missed_peaks(keys, points)] == ["housing: housing"]


def test_modes_within_one_half_power_band_are_one_peak() -> None:
    keys, points = swept(1400.0, 1650.0)
    for one in points:
        found = one.outcome.resonances
        object.__setattr__(found, "frequencies", np.array([NATURAL - 0.5, NATURAL]))
        object.__setattr__(found, "half_widths", np.array([7.0, 7.0]))
        object.__setattr__(found, "names", ("torsion: input", "housing: housing"))
    assert len(missed_peaks(keys, points)) == 1


def test_speeds_that_are_one_are_added_once() -> None:
    def peak(speed: float, rise: float) -> MissedPeak:
        return MissedPeak({}, 1000.0, 2000.0, speed, 15.0, "1×", 700.0, 0.01, "", SOUND, 80.0, rise)

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
    over = first["over_with_peaks"].removeprefix("--over ").replace("'", "")
    return first, study.sweep([over], folder=folder, workers=1).document


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
