"""Declared quantities of the sound, its sentences and tables on terminal and report, and its first page."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from sounding_box import COARSE, sound_of_lines, sound_of_modes

import gearwhine as gw
from gearwhine.output.dataset import labelled
from gearwhine.output.sections import Table
from gearwhine.results import chapters_of
from gearwhine.results.first_page import first_page
from gearwhine.results.sound import SOUND, sections, sound_document
from gearwhine.solve.housing_modes import solve_housing
from gearwhine.solve.sound import SolvedSound, SoundLine
from housing.acoustics.radiation import HousingRadiation


@pytest.fixture(scope="module")
def solved() -> SolvedSound:
    return sound_of_lines()


@pytest.fixture(scope="module")
def document(solved: SolvedSound) -> dict[str, Any]:
    return {"command": "sound", "title": "box", "warnings": []} | sound_document(solved)


def test_shorter_edges_move_no_line_by_more_than_a_fifth_of_a_decibel(solved: SolvedSound) -> None:
    study = gw.load("steel-box", COARSE)
    housing = solve_housing(study.case)
    shapes = np.concatenate([housing.modes.shapes, housing.modes.residual_modes.shapes])
    finer = HousingRadiation.of_surface(
        housing.mesh, shapes, edge=0.032, close_holes=0.055, natural_modes=len(housing.modes.shapes)
    )
    assert len(finer.faces) > 1.8 * len(solved.radiation.faces)
    for line in solved.lines:
        power = finer.solve(line.frequency_hz, line.sound.coordinates).power
        assert 10.0 * np.log10(power / line.sound.power) == pytest.approx(0.0, abs=0.2), line.name


def test_lines_without_proof_inside_are_warned_of(solved: SolvedSound) -> None:
    assert solved.warnings() == []

    def leaking(line: SoundLine, leak: float) -> SoundLine:
        fields = tuple(replace(field, interior_residual=leak) for field in line.sound.fields)
        return replace(line, sound=replace(line.sound, fields=fields))

    first, second, *others = solved.lines
    told = replace(solved, lines=(leaking(first, np.inf), leaking(second, 0.21), *others)).warnings()
    assert [one["relative"] for one in told] == [None, 0.21]
    assert told[0]["message"].startswith(
        "the sound at 92.0 Hz is doubtful: no point inside the radiating surface is far"
    )
    assert (
        "at 520.0 Hz is doubtful: the pressure inside the radiating surface is 21 % of that on it" in told[1]["message"]
    )


def rows(table: Table) -> list[dict[str, str]]:
    columns, texts = table.filled()
    return [dict(zip((column.heading for column in columns), row, strict=True)) for row in texts]


def test_document_has_the_levels_of_the_solution(solved: SolvedSound, document: dict[str, Any]) -> None:
    powers = [line.sound.power for line in solved.lines]
    assert document["total_db"] == pytest.approx(10.0 * np.log10(sum(powers) / 1e-12))
    assert (document["method"], document["highest_frequency_hz"], document["covered"]) == (
        "boundary-elements",
        2300.0,
        0.97,
    )
    for entry, line in zip(document["lines"], solved.lines, strict=True):
        assert (entry["frequency_hz"], entry["name"], entry["order"]) == (line.frequency_hz, line.name, line.order)
        assert 10.0 ** (0.1 * (entry["sound_power_db"] - entry["equivalent_power_db"])) == pytest.approx(
            entry["radiation_efficiency"]
        )
        assert entry["surface_power_db"] == pytest.approx(10.0 * np.log10(line.sound.surface_power / 1e-12))
    # IEC 61672-1:2013, Table 3, at the nominal 500, 1000 and 2000 Hz, of lines near by.
    weights = {
        entry["frequency_hz"]: entry["sound_power_db_a"] - entry["sound_power_db"] for entry in document["lines"]
    }
    assert [weights[hertz] for hertz in (520.0, 1000.0, 2100.0)] == pytest.approx([-3.2, 0.0, 1.2], abs=0.3)
    surface = solved.radiation.elements[0].surface
    assert (document["surface"]["triangles"], document["surface"]["area_m2"]) == (len(surface.triangles), surface.area)
    assert document["surface"]["caps_m2"] == pytest.approx(2.0 * np.pi * 0.025**2, rel=0.3)
    assert 10.0 * np.log10(sum(10.0 ** (0.1 * band["sound_power_db"]) for band in document["third_octaves"])) == (
        pytest.approx(document["total_db"])
    )
    assert sum(document["faces_w"].values()) == pytest.approx(sum(line.sound.surface_power for line in solved.lines))


def test_parts_of_a_line_are_its_largest(solved: SolvedSound, document: dict[str, Any]) -> None:
    for entry, line in zip(document["lines"], solved.lines, strict=True):
        parts = entry["contributions"]
        for group, shares in (("bearings", line.sound.by_motion / line.sound.power),):
            largest = int(np.argmax(np.abs(shares)))
            assert parts[group][0] == {"name": solved.bearings[largest], "share": pytest.approx(shares[largest])}
        by_mode = line.sound.by_mode[: len(solved.mode_frequencies)]
        local = line.sound.by_mode[len(solved.mode_frequencies) :].sum()
        largest = int(np.argmax(np.abs(by_mode)))
        name = f"housing mode {largest + 1}" if abs(by_mode[largest]) > abs(local) else "local compliance"
        assert parts["housing_modes"][0]["name"] == name
        for group in parts.values():
            shares = [abs(part["share"]) for part in group]
            assert shares == sorted(shares, reverse=True)
            assert min(shares) > 0.02


def test_arrays_are_those_of_the_lines(solved: SolvedSound) -> None:
    arrays = labelled(sound_of_modes().case, (SOUND, solved)).dataset()
    assert arrays["sound_power"].values == pytest.approx([line.sound.power for line in solved.lines])
    ratio = arrays["sound_power"].values / arrays["equivalent_radiated_power"].values
    assert ratio == pytest.approx([line.sound.radiation_efficiency for line in solved.lines])
    assert arrays["sound_frequency"].attrs["units"] == "Hz"
    assert arrays["radiation_efficiency"].values == pytest.approx([mode.radiation_efficiency for mode in solved.modes])
    pressure = arrays["sound_pressure"].sel(microphone="box 5").isel(sound_line=5).values
    assert pressure[0] + 1j * pressure[1] == pytest.approx(solved.lines[5].microphones[4])


def test_terminal_shows_the_loudest_lines_with_their_causes(document: dict[str, Any]) -> None:
    (section,) = sections(document)
    said = " ".join(section.sentences)
    assert f"L_W of 7 lines together: {document['total_db']:.1f} dB re 1 pW" in said
    assert f"A-weighted L_WA {document['total_db_a']:.1f} dB; by an estimate 97 % of the whole" in said
    lines, modes = section.tables
    loudest = max(document["lines"], key=lambda line: line["sound_power_db"])
    first = rows(lines)[0]
    mode = loudest["contributions"]["housing_modes"][0]
    assert first["by mode"] == f"{mode['name'].removeprefix('housing mode ')}, {100.0 * mode['share']:.0f} %"
    assert first["by bearing"] == loudest["contributions"]["bearings"][0]["name"]
    assert (first["line [Hz]"], first["L_W [dB]"]) == (
        f"{loudest['frequency_hz']:.1f}",
        f"{loudest['sound_power_db']:.1f}",
    )
    levels = [float(row["L_W [dB]"]) for row in rows(lines)]
    assert levels == sorted(levels, reverse=True)
    assert [row["mode"] for row in rows(modes)] == [str(mode["number"]) for mode in document["modes"]]


def test_nine_microphones_on_a_box_are_a_sentence_and_others_a_table(document: dict[str, Any]) -> None:
    ear = {"name": "ear", "position_m": [1.0, 1.0, 0.0], "level_db": 70.25, "level_db_a": 71.0}
    (section,) = sections(document | {"microphones": [ear, *document["microphones"]]})
    (table,) = [table for table in section.tables if table.caption == "All lines at the microphones"]
    assert [row["microphone"] for row in rows(table)] == ["ear"]
    levels = [one["level_db"] for one in document["microphones"]]
    (said,) = [sentence for sentence in section.sentences if "ISO 3744" in sentence]
    assert said.endswith(
        f"{document['box_power_db']:.1f} dB; pressure {min(levels):.1f} to {max(levels):.1f} dB re 20 µPa"
    )


def test_report_has_a_chapter_whose_lines_lead_to_pictures(document: dict[str, Any]) -> None:
    (chapter,) = chapters_of(document)
    assert chapter.title == "Sound"
    lines = chapter.tables[0]
    (frequency,) = [column for column in lines.columns if column.heading == "line [Hz]"]
    assert frequency.link is not None
    assert frequency.link(document["lines"][6]) == ("picture sound-faces-2300.0Hz",)
    assert {"order", "ERP [dB]", "efficiency"} <= set(rows(lines)[0])
    begins = [picture.begins for picture in chapter.pictures]
    assert begins.index("sound-faces-all") < begins.index("sound-faces")


def test_first_page_says_how_loud_it_is_and_proves_it(document: dict[str, Any]) -> None:
    page = {section.title: section for section in first_page(None, [document], [])}
    loudest = page["Loudest lines"]
    assert f"{document['total_db']:.1f} dB re 1 pW" in loudest.sentences[0]
    assert len(rows(loudest.tables[0])) == 5
    (proof,) = [one for one in page["Are the results sound?"].content if str(one).startswith("Sound:")]
    assert proof.passed is True  # type: ignore[union-attr]
    # A run that holds the sound as a part has the same.
    nested = {"command": "run", "title": "box", "warnings": [], "sound": sound_document(sound_of_lines())}
    assert "Loudest lines" in {section.title for section in first_page(None, [nested], [])}


def test_powers_that_differ_fail_on_the_first_page(document: dict[str, Any]) -> None:
    lines = [line | {"surface_power_db": line["sound_power_db"] - 0.6} for line in document["lines"]]
    page = {section.title: section for section in first_page(None, [document | {"lines": lines}], [])}
    (proof,) = [one for one in page["Are the results sound?"].content if str(one).startswith("Sound:")]
    assert proof.passed is False  # type: ignore[union-attr]


def test_modes_alone_have_no_lines_and_no_total(solved: SolvedSound) -> None:
    document = sound_document(replace(solved, lines=(), covered=0.0))
    assert (document["total_db"], document["total_db_a"], document["box_power_db"]) == (None, None, None)
    (section,) = sections(document)
    assert "L_W" not in " ".join(section.sentences)
    assert "Loudest lines" not in {one.title for one in first_page(None, [document | {"warnings": []}], [])}
