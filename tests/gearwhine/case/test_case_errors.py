"""Every kind of wrong input is reported by key path, value and expectation; all of it in one error."""

from __future__ import annotations

import re
from typing import Any

import pytest
from broken_cases import GEARBOX, GONE, broken, check_one_wrong, check_several_wrong, problems

from gearwhine.case import CaseError, load_case, parse_case
from gearwhine.case.model import lacking

ONE_WRONG = {
    # units and numbers
    "mass for a length": ("rotor.0.segments.1.length", "3 kg", "rotor[0].segments[1].length", "(mass)"),
    "unknown unit": ("rotor.0.start", "3 furlungs", "rotor[0].start", "'furlungs' is not known"),
    "no unit in text": ("rotor.0.start", "3", "rotor[0].start", "with its unit"),
    "not a quantity": ("rotor.0.start", "long", "rotor[0].start", "a length such as '6.35 mm'"),
    "nm for N*m": ("operation.torque", "70 nm", "operation.torque", "(length)"),
    "infinite": ("operation.torque", float("inf"), "operation.torque", "finite"),
    "huge integer": ("operation.torque", 10**400, "operation.torque", "that a computer number can hold"),
    "list for a number": ("operation.speed", ["1 rpm"], "operation.speed", "an angular speed such as '5500 rpm'"),
    "table for a number": ("operation.speed", {"value": 3}, "operation.speed", "an angular speed"),
    "1/s for a speed": ("operation.speed", "90 1/s", "operation.speed", "an angular speed"),
    "power that is no unit": ("rotor.0.start", "9**9**9", "rotor[0].start", "a length"),
    "metres for millimetres": ("rotor.0.segments.0.length", 254, "rotor[0].segments[0].length", "'254 mm'"),
    # ranges
    "negative length": ("rotor.0.segments.1.length", "-3 mm", "rotor[0].segments[1].length", "above 0 m"),
    "poisson ratio": ("material.steel.poisson_ratio", 0.5, "material.steel.poisson_ratio", "below 0.5"),
    "no density": ("material.steel.density", 0, "material.steel.density", "above 0 kg/m^3"),
    "few points": ("transient.points_per_revolution", 100, "transient.points_per_revolution", "from 200"),
    "bore of a segment": ("rotor.0.segments.0.bore", "30 mm", "rotor[0].segments[0].bore", "smaller than the"),
    "no segments": ("rotor.0.segments", [], "rotor[0].segments", "at least 1 entries"),
    "discard all": ("transient.discard", 10, "transient.discard", "fewer revolutions than the 10 of the run"),
    # keys, forms and choices
    "missing length": ("rotor.0.segments.0.diameter", GONE, "rotor[0].segments[0].diameter", "'6.35 mm'"),
    **{
        f"rib {end} beyond the wall": (
            "housing.box.ribs",
            [{"face": "top", "along": "x", "at": 0, "height": "10 mm", "thickness": "8 mm", end: "900 mm"}],
            f"housing.box.ribs[0].{end}",
            "x = -110 mm to 110 mm",
        )
        for end in ("from", "to")
    },
    "wrong choice": ("rotor.0.mass", "lumpy", "rotor[0].mass", "'distributed' or 'lumped'"),
    "text for a table": ("operation", "fast", "operation", "a table"),
    "table for a list": ("rotor.0.segments", {"length": "1 m"}, "rotor[0].segments", "a list"),
    "name with a slash": ("rotor.0.name", "a/b", "rotor[0].name", "without slashes"),
    "title": ("title", 3, "title", "text"),
    "sweep step": (
        "sweep",
        {"speed": {"from": "9 rpm", "to": "3 rpm", "step": "1 rpm"}},
        "sweep.speed.step",
        "leads from",
    ),
    # names
    "output rotor": ("operation.output", [{"rotor": "y", "torque": 1}], "operation.output[0].rotor", "of a rotor"),
    "force rotor": ("operation.force", [{"rotor": "y", "at": 0}], "operation.force[0].rotor", "of a rotor"),
    "force station": (
        "operation.force",
        [{"rotor": "output", "at": "3 m", "x": "5 N"}],
        "operation.force[0].at",
        "which is 200 mm long",
    ),
    "rotor named housing": ("rotor.0.name", "housing", "rotor[0].name", "another name than 'housing'"),
    "same name": ("rotor.1.name", "input", "rotor[1].name", "rotor[0] has this one"),
    # places
    "unbalance": ("rotor.0.unbalance.0.at", "1 m", "rotor[0].unbalance[0].at", "which is 200 mm long"),
    "disc": ("rotor.0.discs", [{"at": "1 m", "mass": "1 kg"}], "rotor[0].discs[0].at", "which is 200 mm long"),
    "output station": (
        "operation.output",
        [{"rotor": "output", "torque": "71.77 N*m", "at": "3 m"}],
        "operation.output[0].at",
        "which is 200 mm long",
    ),
    "axis off the seat": ("rotor.0.axis.0", "-44.4 mm", "bearing[0].seat", "is 0.05 mm off it"),
    # gears and running
    "balance": (
        "operation.output",
        [{"rotor": "output", "torque": "70 N*m"}],
        "operation.output",
        "amount to 70 N*m",
    ),
    "in and out": (
        "operation.output",
        [{"rotor": "input", "torque": "1 N*m"}],
        "operation.output[0].rotor",
        "other than",
    ),
    "no speed": ("operation", GONE, "operation", "a speed to run the [transient] at"),
    "no turning": ("operation.speed", 0, "operation.speed", "other than zero"),
    # provenance
    "origin": ("provenance", {"title": "guessed"}, "provenance.title", "'published', 'nominal' or 'found'"),
    "origin of nothing": (
        "provenance",
        {"gear.*.width": "found"},
        "provenance.'gear.*.width'",
        "the path of something",
    ),
}

SEVERAL_WRONG: dict[str, tuple[list[tuple[str, Any]], str, str]] = {
    "a rotor that nothing turns": (
        [("rotor", [*GEARBOX["rotor"], {**GEARBOX["rotor"][0], "name": "idle"}])],
        "rotor[2].name",
        "no pair leads here",
    ),
    "operation of a housing": (
        [("rotor", GONE), ("bearing", GONE), ("gear", GONE), ("gear_pair", GONE), ("transient", GONE)],
        "operation",
        "to turn",
    ),
}


@pytest.mark.parametrize("kind", ONE_WRONG)
def test_one_wrong_value_is_named_with_its_place_and_what_was_expected(kind: str) -> None:
    check_one_wrong(*ONE_WRONG[kind])


@pytest.mark.parametrize("kind", SEVERAL_WRONG)
def test_what_does_not_go_together_is_named(kind: str) -> None:
    check_several_wrong(*SEVERAL_WRONG[kind])


def test_everything_wrong_comes_at_once_with_the_entries_own_names() -> None:
    """Structural errors, cross-checks of sound entries and names of broken ones stand in one report."""
    report = problems(
        broken(
            ("rotor.0.segments.1.length", "-3 mm"),
            ("gear.0.facewidth", "6 mm"),
            ("bearing.3.seat", "nowhere"),
            ("housing.seat.2.diameter", "127 mm"),
            ("housing.box.mesh_size", "3 kg"),
            ("material.steel.density", "1 rpm"),
            ("bearing.2.at", "5 m"),
        )
    )
    text = "\n".join(report)
    assert 'rotor[0].segments[1].length (rotor "input"): expected a length above 0 m such as' in text
    assert "gear[0].facewidth (gear \"pinion\"): expected no such key; did you mean 'face_width'?" in text
    assert 'bearing[3].seat (bearing "output-front"): expected the name of a seat' in text
    assert "housing.box.mesh_size: expected a length such as '6.35 mm', got '3 kg' (mass)" in text
    assert "material.steel.density" in text
    assert "bearing[2].at" in text
    assert len(report) == 6  # the seats cannot be judged: their box could not be read


def test_an_entry_that_failed_still_counts_as_there() -> None:
    """A rotor, gear, material or seat with an error in it leaves no dangling names behind."""
    report = problems(
        broken(
            ("rotor.0.mass", "lumpy"),
            ("gear.0.teeth", 1),
            ("material.steel.density", -1),
            ("housing.seat.0.diameter", 0),
        )
    )
    assert len(report) == 4


def test_problems_can_be_read_by_a_program() -> None:
    with pytest.raises(CaseError) as caught:
        parse_case(broken(("gear.0.teeth", 1), ("operation.speed", "fast")))
    first, second = caught.value.problems
    assert (first.key, first.value, first.label) == ("gear[0].teeth", 1, 'gear "pinion"')
    assert (second.key, second.value) == ("operation.speed", "fast")


@pytest.mark.parametrize("table", ["operation", "transient", "sweep"])
def test_what_a_command_wants_of_a_missing_table_is_accepted_in_it(table: str) -> None:
    case = load_case("steel-box").case
    (line,) = str(lacking(case, table, command="run")).splitlines()
    example = re.search(r"such as (\w+) = ('[^']+'|\{.*?\}|\d+)", line)
    assert example is not None
    load_case("small-gearbox", [f"{table}.{example[1]}={example[2]}"])
