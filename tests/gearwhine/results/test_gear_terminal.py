"""What a newcomer reads of his gears: the figures of the document, in words that hold for them."""

import math
from functools import cache
from typing import Any

import pytest

from gearwhine.case import load_case
from gearwhine.coupling.analyses.gear_pairs import solve_over_torques
from gearwhine.coupling.description.gear_train import EQUAL_MESHES
from gearwhine.from_case.machine import solve_gears
from gearwhine.output.terminal import show
from gearwhine.results.gears import gears_document, report, sections
from gearwhine.solve.gear_pairs import analyse_pairs

pytestmark = pytest.mark.usefixtures("few_reliefs_tried")
Document = dict[str, Any]


@cache
def document(name: str, *settings: str) -> Document:
    case = load_case(name, settings).case
    return gears_document(solve_over_torques(analyse_pairs(case, solve_gears(case.parts))))


def said(capsys: pytest.CaptureFixture[str], given: Document) -> str:
    show(given, sections(given))
    return capsys.readouterr().out


def changed(given: Document, **changes: Any) -> Document:
    (pair,) = given["pairs"]
    return {"pairs": [pair | changes]}


def test_the_rig_in_one_screen(capsys: pytest.CaptureFixture[str]) -> None:
    given = document("nasa-gear-noise-rig")
    (pair,) = given["pairs"]
    out = said(capsys, given)
    assert len(out.splitlines()) <= 36
    for text in (
        "module 3.175 mm, pressure angle 20°",
        "95.250",  # tip circle
        "34.051 (4)",  # span, as any table for 28 teeth of module 3.175 has it: 10.7246 modules
        "20.85°",  # roll angle at the pitch point, tan 20°
        "Contact ratio 1.63800",
        "Mesh frequency 2566.67 Hz, torque on the driver 71.77 N·m, mesh force 1718.2 N",
        "in the first mesh period",
        f"over the hunting period: {1e6 * pair['transmission_error_m']['over_hunting_period']['mean']:.3f} µm",
        f"Contact pressure {1e-6 * pair['contact_pressure_pa']['max']:.0f} MPa at most in the first mesh period",
        "Pairs of teeth that carry in the first mesh period: ",
        "The relief of 0.023/0.025 mm from 24° leaves",
        "all teeth alike",
        "Best linear relief: ",
    ):
        assert text in out, text


def test_the_report_has_every_pair_as_the_terminal_shows_it_with_its_pictures() -> None:
    first, second = (document("spur-pair")["pairs"][0] | {"driver": name, "driven": "b"} for name in ("a", "c"))
    both = {"pairs": [first, second]}
    chapter, shown = report(both), sections(both)
    chapters, screens = (
        [(one.title, one.sentences, [table.filled()[1] for table in one.tables]) for one in several]
        for several in (chapter.inner, shown)
    )
    assert chapters == screens
    for inner, stem in zip(chapter.inner, ("gears-a-b-", "gears-c-b-"), strict=True):
        assert inner.pictures
        assert all(picture.begins.startswith(stem) for picture in inner.pictures)


def test_a_share_of_the_torque_stands_behind_the_force_that_it_gives(capsys: pytest.CaptureFixture[str]) -> None:
    plain, shared = (
        said(capsys, changed(document("spur-pair"), mean_force_from=origin)).splitlines()
        for origin in (None, EQUAL_MESHES)
    )
    (force,) = [line for line in plain if "mesh force" in line]
    (other,) = set(shared) - set(plain)
    assert set(plain) - set(shared) == {force}
    assert other.startswith(force)
    assert any(line.strip().startswith("Backlash") for line in plain)


def test_alike_teeth_are_not_said_to_be(capsys: pytest.CaptureFixture[str]) -> None:
    out = said(capsys, document("spur-pair"))
    for text in ("hunting", "first mesh period", "all teeth alike", "shift", "helix", "overlap", "Corners"):
        assert text not in out


def test_without_a_load(capsys: pytest.CaptureFixture[str]) -> None:
    out = said(capsys, document("gear-62-62", "operation="))
    assert "Contact ratio 1.78978" in out
    assert "Transmission error without load 0.000 µm" in out
    for text in ("N·m", "MPa", "relief", "carry", "Mesh frequency"):
        assert text not in out


def test_gears_without_relief_are_told_what_would_suit_them(capsys: pytest.CaptureFixture[str]) -> None:
    given = document("gear-62-62")
    out = said(capsys, given)
    error = 1e6 * given["pairs"][0]["optimal_tip_relief"]["peak_to_peak_as_given_m"]
    assert f"Without relief {error:.2f} µm peak to peak at 100 N·m" in out
    assert "Best linear relief" in out
    assert "quietest" not in out


def test_a_relief_that_is_as_good_as_any(capsys: pytest.CaptureFixture[str]) -> None:
    given = document("spur-pair")
    best = given["pairs"][0]["optimal_tip_relief"]
    good = changed(given, optimal_tip_relief=best | {"peak_to_peak_as_given_m": 1.05 * best["peak_to_peak_m"]})
    assert "Hardly better would be" in said(capsys, good)


def test_helical_shifted_gears_with_corners(capsys: pytest.CaptureFixture[str]) -> None:
    given = document("spur-pair")
    (pair,) = given["pairs"]
    gears = [
        gear | {"helix_angle_rad": hand * math.radians(12.5), "profile_shift": 0.25}
        for gear, hand in zip(pair["gears"], (-1, 1), strict=True)
    ]
    points = [point | {"driver_specific_sliding": -math.inf} for point in pair["path_of_contact"]]
    sharing = pair["load_sharing"] | {"corner_force_n": 123.0}
    helical = changed(
        given,
        gears=gears,
        overlap_ratio=0.8,
        total_contact_ratio=2.438,
        load_sharing=sharing,
        path_of_contact=points,
    )
    out = said(capsys, helical)
    for text in ("helix angle 12.5°, the driver's left-hand", "0.25", "with the overlap of 0.8000 in all 2.4380"):
        assert text in out
    assert "Corners carry up to 123 N beyond the path of contact" in out
    assert "-∞" in out
