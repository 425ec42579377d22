"""Bearings of a shaft against each other in cases: arrangement, preload by offsets and springs, without torque."""

import json
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.case.bearings import RollingCatalogue
from gearwhine.cli import run_command
from gearwhine.results.check import sections as check_sections
from gearwhine.results.operating_point import sections
from gearwhine.rotors.rolling_bearings import (
    RollingBearing,
    Row,
    catalogue_row,
    rolling_equilibrium,
    rolling_state,
    static_rating,
)

TWO_ROWS = ("double-row-angular-contact", "spherical-roller", "self-aligning-ball")
SIZE = {"type": "tapered-roller", "bore": "40 mm", "outer_diameter": "80 mm", "width": "19.75 mm"}


def opposed(carries: tuple[str, str] = ("+z", "-z"), **more: Any) -> dict[str, Any]:
    """Changes of the helical pair: tapered rollers at both ends of both shafts, on the ground."""
    changes: dict[str, Any] = {}
    for number in range(4):
        rolling = {"catalogue": SIZE, "carries": carries[number % 2], **more}
        changes[f"bearing.{number}.stiffness"] = {"rolling": rolling}
        changes[f"bearing.{number}.damping"] = {"xx": "8e2 N*s/m", "yy": "8e2 N*s/m"}
    return changes


def inline(value: Any) -> str:
    """Write a value as TOML on one line."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {inline(one)}" for key, one in value.items()) + " }"
    return json.dumps(value)


def lines_of(study: gw.CaseStudy) -> str:
    return "\n".join(
        f"{section.title}{section.note} {' '.join(section.sentences)}"
        for section in check_sections(study.check().document)
    )


def test_each_part_of_a_checked_case_stands_under_its_own_name() -> None:
    document = gw.load("helical-pair").check().document
    first = {section.title: section.note.strip() for section in check_sections(document)}
    words = {"rotors": "kg", "bearings": "on ground", "thrust": "thrust", "analysis": "Campbell", "operation": "rpm"}
    words |= {"gear pairs": "contact ratio", "damping": "% of critical", "transient": "revolutions"}
    assert {part for part, word in words.items() if word not in first.get(part, "")} == set()
    assert first["bearings"].startswith(f"{document['bearings'][0]['name']}: ")
    assert first["thrust"].startswith(f"{document['axial_location'][0]['rotor']}: ")
    assert [row["torques"] for row in document["rotor_analysis"]] == [0] * len(document["rotor_analysis"])


@pytest.mark.slow
def test_check_names_the_arrangement_and_who_takes_which_thrust() -> None:
    back, face = gw.load("helical-pair", opposed()), gw.load("helical-pair", opposed(("-z", "+z")))
    assert back.warnings == face.warnings == ()
    both = "O arrangement, back to back; thrust towards +z on input-left, towards -z on input-right"
    assert f"input: {both}" in lines_of(back)
    assert "X arrangement, face to face; thrust towards +z on input-right, towards -z on input-left" in lines_of(face)
    (first, _) = back.check().document["axial_location"]
    assert first == {
        "rotor": "input",
        "arrangement": "O",
        "thrust_plus_z": ["input-left"],
        "thrust_minus_z": ["input-right"],
        "rows": {},
    }
    assert "input: thrust both ways on input-left" in lines_of(gw.load("helical-pair"))
    assert "input: no bearing holds it along its axis" in lines_of(gw.load("spur-pair"))
    assert "intermediate: thrust both ways on intermediate-front (O, back to back)" in lines_of(
        gw.load("two-stage-reducer")
    )


def test_rows_that_carry_one_way_are_warned_of_by_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    changes = opposed(("+z", "+z"))
    study = gw.load("helical-pair", changes)
    found = [text.partition(" is located one way only")[0] for text in study.warnings]
    assert found == ["shaft 'input'", "shaft 'output'"]
    assert study.machine.warnings == study.warnings
    line = "input: thrust towards +z on input-left, input-right; nothing holds it towards -z"
    assert line in lines_of(study)
    texts = [f"{key}={inline(value)}" for key, value in changes.items()]
    assert run_command(["check", "helical-pair", "-q", *(part for text in texts for part in ("--set", text))]) == 0
    assert capsys.readouterr().err.splitlines() == [f"warning: {text}" for text in study.warnings]


def test_a_spring_of_each_of_two_opposed_rows_is_warned_of() -> None:
    study = gw.load("helical-pair", opposed(preload="300 N"))
    assert all("cancel and press no element" in text and "`axial_offset`" in text for text in study.warnings)
    assert len(study.warnings) == 2
    assert [one["preload_n"] < 1.0 for one in study.operating_point().document["bearings"]] == [True] * 4


def test_without_torque_the_equilibrium_is_that_of_the_preload() -> None:
    """The rows as springs in series with the shaft, which is so stiff here that it takes a few per cent off."""
    changes = opposed(axial_offset="5 um")
    result = gw.load("helical-pair", changes | {"operation.torque": "0 N*m"}).operating_point()
    document = result.document
    row = catalogue_row("tapered-roller", 0.04, 0.08, 0.01975)
    rigid = row.axial_force(5e-6)
    for one, sense in zip(document["bearings"], (1.0, -1.0, 1.0, -1.0), strict=True):
        assert one["force_n"][2] == pytest.approx(sense * one["preload_n"])
        assert 0.9 * rigid < one["preload_n"] < rigid
        # Z c/n Σ δ^(10/9) sin α along its axis: the tangent is that of the power law at the force.
        slope = (row.axial_force(5.001e-6) - row.axial_force(4.999e-6)) / 2e-9
        assert one["stiffness"][2][2] == pytest.approx(slope * (one["preload_n"] / rigid) ** 0.1, rel=2e-3)
    assert document["gear_pairs"] == []
    assert "loaded_pair" not in result.dataset.dims
    assert result.dataset["bearing_preload"].attrs["units"] == "N"
    (section,) = sections(document)
    text = " ".join(section.sentences)
    assert (
        "Static equilibrium without torque, under preload alone, in rigid seats (no housing); no flanks carry" in text
    )
    assert [table.caption.partition(":")[0] for table in section.tables] == [
        "Force and tilting moment of the shafts on their bearings",
        "Rolling bearings",
        "Deflection of the shafts",
    ]
    # Under the torque the same preload is told.
    loaded = gw.load("helical-pair", changes).operating_point().document["bearings"]
    assert [one["preload_n"] for one in loaded] == pytest.approx([one["preload_n"] for one in document["bearings"]])
    figures = dict(result.figures())
    assert list(figures) == ["load-shaft-input", "load-shaft-output"]
    # The preload pulls at the shaft along its axis alone.
    assert [one["largest_deflection_m"] for one in document["shafts"]] == [0.0, 0.0]
    note = figures["load-shaft-input"].texts[1].get_text()
    assert note == "no deflection across the axis; arrows: forces on the shaft, below them thrusts"
    for axes in figures["load-shaft-input"].axes:
        told = [text.get_text() for text in axes.texts if text.get_text()]
        assert told == [f"{document['bearings'][0]['preload_n']:.4g} N"] * 2


def test_shafts_without_preload_have_none() -> None:
    changes = {key: value for key, value in opposed(axial_offset="5 um").items() if key[8] in "01"}
    found = gw.load("helical-pair", changes).operating_point().document["bearings"]
    assert [one["preload_n"] is None for one in found] == [False, False, True, True]


def test_moments_stand_beside_the_forces() -> None:
    result = gw.load("helical-pair", opposed(axial_offset="5 um")).operating_point()
    forces, rolling, *_ = sections(result.document)[0].tables
    columns, texts = forces.filled()
    headings = [column.heading.replace("\n", " ") for column in columns]
    assert headings == ["bearing", "x [N]", "y [N]", "z [N]", "about x [N·m]", "about y [N·m]", "tilt [µrad]"]
    for one, row in zip(result.solved.point.bearings, texts, strict=True):
        shown = np.array([float(text) for text in row[1:6]])
        np.testing.assert_allclose(shown, one.force, atol=0.51)
        np.testing.assert_allclose(shown[3:], one.force[3:], atol=0.051)
    columns, texts = rolling.filled()
    headings = [column.heading.replace("\n", " ") for column in columns]
    assert headings == ["bearing", "pressure [GPa]", "preload [N]", "L10 [h]", "L10r [h]", "x, y, z [N/µm]"]
    stiffness = np.diag(result.solved.point.bearings[0].stiffness)[:3]
    assert [float(part) for part in texts[0][-1].split(",")] == pytest.approx(1e-6 * stiffness, rel=1e-3)


def test_balls_that_carry_thrust_on_the_wrong_shoulder_are_warned_of() -> None:
    """Both bearings of each shaft carry towards +z; the wheel is pushed along -z, with all of the thrust."""
    balls = {"count": 13, "element_diameter": "9.6 mm", "pitch_diameter": "46 mm", "contact_angle": "40 deg"}
    changes = opposed(("+z", "+z"))
    for number in range(4):
        changes[f"bearing.{number}.stiffness"] = {"rolling": balls}
    document = gw.load("helical-pair", changes).operating_point().document
    found = [one for one in document["warnings"] if one["name"] == "thrust side"]
    assert {one["bearing"] for one in found} == {"output-left", "output-right"}
    assert sum(one["thrust_n"] for one in found) == pytest.approx(-document["gear_pairs"][0]["thrust_n"], rel=1e-6)
    assert "N towards -z, against their contact angle" in found[0]["message"]


def two_rows(kind: str, **keys: Any) -> RollingBearing:
    size = {"type": kind, "bore": "35 mm", "outer_diameter": "72 mm", "width": "27 mm"}
    return RollingCatalogue.model_validate({"catalogue": size, **keys}).build("two rows")


@pytest.mark.parametrize("carries", ["+z", "-z"])
@pytest.mark.parametrize("kind", TWO_ROWS)
def test_an_offset_moves_the_ring_with_both_rows(kind: str, carries: str) -> None:
    """The forces are those of the same bearing without an offset, its inner ring displaced along `carries`."""
    sense = 1 if carries == "+z" else -1
    offset = two_rows(kind, axial_offset="20 um", carries=carries)
    assert offset.ring_offset == pytest.approx(sense * 20e-6)
    for place in ([0.0] * 5, [4e-6, -3e-6, 5e-6, 1e-5, -2e-5]):
        there = rolling_state(offset, place)
        moved = rolling_state(two_rows(kind), place + np.array([0.0, 0.0, sense * 20e-6, 0.0, 0.0]))
        # A spherical ring tilts freely: its moments are rounding.
        np.testing.assert_allclose(there.reaction, moved.reaction, rtol=1e-9, atol=1e-9)
    # The ring is pressed onto one row and away from the other.
    thrusts = dict(
        zip((row.direction for row in offset.rows), rolling_state(offset, [0.0] * 5).row_thrusts, strict=True)
    )
    assert thrusts[sense] > 50.0
    assert thrusts[-sense] == pytest.approx(0.0, abs=1e-9)


def test_an_offset_of_two_rows_presses_an_opposed_bearing() -> None:
    """Two springs in series, the double row and a single row at the other end, share the offset with the shaft."""
    changes: dict[str, Any] = {"operation.torque": "0 N*m"}
    double = {"type": "double-row-angular-contact", "bore": "40 mm", "outer_diameter": "80 mm", "width": "30.2 mm"}
    single = {"type": "angular-contact", "bore": "40 mm", "outer_diameter": "80 mm", "width": "18 mm"}
    for number in range(4):
        left = {"catalogue": double, "axial_offset": "20 um"}
        changes[f"bearing.{number}.stiffness"] = {
            "rolling": {"catalogue": single, "carries": "-z"} if number % 2 else left
        }
        changes[f"bearing.{number}.damping"] = {"xx": "8e2 N*s/m", "yy": "8e2 N*s/m"}
    study = gw.load("helical-pair", changes)
    first, second, *_ = study.operating_point().document["bearings"]
    force = first["preload_n"]
    assert second["preload_n"] == pytest.approx(force)
    assert [first["force_n"][2], second["force_n"][2]] == pytest.approx([force, -force])
    rows = [
        catalogue_row("double-row-angular-contact", 0.04, 0.08, 0.0302),
        catalogue_row("angular-contact", 0.04, 0.08, 0.018),
    ]
    deep = [
        rolling_equilibrium(
            RollingBearing([row]), [0.0, 0.0, force, 0.0, 0.0], held=dict.fromkeys(("x", "y", "rx", "ry"), 0.0)
        )
        for row in rows
    ]
    # F L / (E A) of the 200 mm of shaft between them, 40 mm thick, which the pinion stiffens a little.
    shaft = force * 0.2 / (206e9 * np.pi / 4.0 * 0.04**2)
    assert sum(state.displacement[2] for state in deep) + shaft == pytest.approx(20e-6, rel=3e-3)


@pytest.mark.parametrize("kind", TWO_ROWS)
def test_two_rows_of_a_bearing_press_each_other_with_the_preload(kind: str) -> None:
    """Each row is displaced as far as 500 N displace it alone, and nothing pushes at the shaft."""
    bearing = two_rows(kind, preload="500 N", clearance="6 um", carries="-z")
    state = rolling_equilibrium(bearing, np.zeros(5))
    assert state.row_thrusts == pytest.approx([500.0, 500.0], rel=1e-9)
    assert state.reaction == pytest.approx(np.zeros(5), abs=1e-6)
    assert state.displacement[:3] == pytest.approx(np.zeros(3), abs=1e-12)
    for row in two_rows(kind, clearance="6 um").rows:
        held = dict.fromkeys(("x", "y", "rx", "ry"), 0.0)
        alone = rolling_equilibrium(RollingBearing([row]), [0.0, 0.0, 500.0 * row.direction, 0.0, 0.0], held=held)
        (pressed,) = {one.axial_offset for one in bearing.rows}
        assert pressed == pytest.approx(row.direction * alone.displacement[2], rel=1e-9)
    assert bearing.ring_offset == 0.0
    # An offset of the ring stands beside it: where nothing opposes it, the shaft goes back by as much.
    both = two_rows(kind, preload="500 N", axial_offset="2 um")
    assert both.ring_offset == pytest.approx(2e-6)
    assert rolling_equilibrium(both, np.zeros(5)).displacement[2] == pytest.approx(-2e-6)


def test_rows_of_a_pair_share_its_static_rating() -> None:
    """ISO 76: 40 kN of the pair are 20 kN of either row, as those of a single bearing of 20 kN."""
    size = {"type": "angular-contact", "bore": "40 mm", "outer_diameter": "80 mm", "width": "18 mm"}

    def rows(**keys: Any) -> tuple[Row, ...]:
        return tuple(RollingCatalogue.model_validate({"catalogue": size, **keys}).build("pair").rows)

    (single,) = rows(static_rating="20 kN")
    pair = rows(static_rating="40 kN", arrangement="back to back", spacing="18 mm")
    assert [static_rating(row) for row in pair] == pytest.approx([20e3, 20e3])
    assert [row.element_diameter for row in pair] == pytest.approx([single.element_diameter] * 2)


def test_check_shows_the_inside_of_a_catalogue_bearing() -> None:
    """A 6306 has eight balls of 12.3 mm (NSK) and C₀ = 16.0 kN (SKF); C is the one that the case gives."""
    size = {"type": "deep-groove", "bore": "30 mm", "outer_diameter": "72 mm", "width": "19 mm"}
    rolling = {"catalogue": size, "clearance": "8 um", "dynamic_rating": "29.6 kN"}
    study = gw.load(
        "helical-pair", {"bearing.0.stiffness": {"rolling": rolling}, "bearing.0.damping": {"xx": "8e2 N*s/m"}}
    )
    first, second, *_ = study.check().document["bearings"]
    inside = first["rolling"]
    assert (inside["elements"], inside["clearance_m"], inside["dynamic_rating_n"]) == ([8], 8e-6, 29.6e3)
    assert inside["element_diameter_m"] == pytest.approx(12.3e-3, rel=0.03)
    assert inside["static_rating_n"] == pytest.approx(16.0e3, rel=0.03)
    assert "rolling" not in second
    words = lines_of(study)
    assert "estimated inside: 8 elements of 12." in words
    assert ", clearance 8 µm; C 29.6 kN (given), C₀ 16.3" in words
