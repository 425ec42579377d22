"""Every kind of wrong input is reported by key path, value and expectation; all of it in one error."""

from __future__ import annotations

import copy
import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from gearwhine.case import CaseError, load_case, parse_case

GEARBOX = tomllib.loads(files("gearwhine.cases").joinpath("small-gearbox.toml").read_text(encoding="utf-8"))
"""A sound case with all tables; each test breaks it in one place."""

GONE = object()


def broken(*changes: tuple[str, Any]) -> dict[str, Any]:
    """Return the sound case with values replaced, or taken away, at dotted paths."""
    document = copy.deepcopy(GEARBOX)
    for path, value in changes:
        *way, last = [int(step) if step.isdecimal() else step for step in path.split(".")]
        here: Any = document
        for step in way:
            here = here[step]
        if value is GONE:
            del here[last]
        else:
            here[last] = value
    return document


def problems(document: dict[str, Any]) -> list[str]:
    with pytest.raises(CaseError) as caught:
        parse_case(document, source="case.toml")
    return str(caught.value).splitlines()


NOWHERE_BOX = [["1 m", "1 m", "1 m"], ["2 m", "2 m", "2 m"]]
CAVITY_BOX = [["-10 mm", "70 mm", "-10 mm"], ["10 mm", "90 mm", "10 mm"]]

ONE_WRONG = {
    # units and numbers
    "mass for a length": ("rotor.0.segments.1.length", "3 kg", "rotor[0].segments[1].length", "(mass)"),
    "unknown unit": ("rotor.0.start", "3 furlungs", "rotor[0].start", "'furlungs' is not known"),
    "no unit in text": ("rotor.0.start", "3", "rotor[0].start", "with its unit"),
    "not a quantity": ("rotor.0.start", "long", "rotor[0].start", "a length such as '6.35 mm'"),
    "nm for N*m": ("operation.torque", "70 Nm", "operation.torque", "write 'N*m'"),
    "boolean": ("housing.box.mesh_size", True, "housing.box.mesh_size", "a length"),
    "not a number": ("housing.box.mesh_size", float("nan"), "housing.box.mesh_size", "finite"),
    "infinite": ("operation.torque", float("inf"), "operation.torque", "finite"),
    "huge integer": ("operation.torque", 10**400, "operation.torque", "that a computer number can hold"),
    "list for a number": ("operation.speed", ["1 rpm"], "operation.speed", "an angular speed such as '5500 rpm'"),
    "table for a number": ("operation.speed", {"value": 3}, "operation.speed", "an angular speed"),
    "rpm for a frequency": ("housing.frequency_limit", "3000 rpm", "housing.frequency_limit", "a frequency"),
    "1/s for a speed": ("operation.speed", "90 1/s", "operation.speed", "an angular speed"),
    "percent for an angle": ("gear.0.pressure_angle", "20 %", "gear[0].pressure_angle", "an angle"),
    "power that is no unit": ("rotor.0.start", "9**9**9", "rotor[0].start", "a length"),
    "metres for millimetres": ("rotor.0.segments.0.length", 254, "rotor[0].segments[0].length", "'254 mm'"),
    "box in metres": ("housing.box.size.0", 220, "housing.box.size[0]", "at most 20 m such as '6.35 mm'; plain"),
    "box of a hair": ("housing.box.size.1", "0.1 mm", "housing.box.size[1]", "of at least 0.001 m"),
    # ranges
    "negative length": ("rotor.0.segments.1.length", "-3 mm", "rotor[0].segments[1].length", "above 0 m"),
    "poisson ratio": ("material.steel.poisson_ratio", 0.5, "material.steel.poisson_ratio", "below 0.5"),
    "no density": ("material.steel.density", 0, "material.steel.density", "above 0 kg/m^3"),
    "four teeth": ("gear.0.teeth", 4, "gear[0].teeth", "a whole number from 5"),
    "half a tooth": ("gear.0.teeth", 28.5, "gear[0].teeth", "a whole number from 5"),
    "pressure angle": ("gear.0.pressure_angle", "40 deg", "gear[0].pressure_angle", "at most 35 deg"),
    "damping ratio": ("gear_pair.0.damping_ratio", 1.5, "gear_pair[0].damping_ratio", "below 1"),
    "damping per cent": ("housing.damping_ratio", 2, "housing.damping_ratio", "of at least 0 and below 1"),
    "few points": ("transient.points_per_revolution", 100, "transient.points_per_revolution", "from 200"),
    "bore of a segment": ("rotor.0.segments.0.bore", "30 mm", "rotor[0].segments[0].bore", "smaller than the"),
    "bore of a gear": ("gear.0.bore", "84 mm", "gear[0].bore", "smaller than the base circle"),
    "no segments": ("rotor.0.segments", [], "rotor[0].segments", "at least 1 entries"),
    "discard all": ("transient.discard", 10, "transient.discard", "fewer revolutions than the 10 of the run"),
    "bearing stiffness": ("bearing.0.stiffness.xx", "0 N/m", "bearing[0].stiffness.xx", "above 0 N/m"),
    # keys, forms and choices
    "misspelt key": ("gear.0.facewidth", "6 mm", "gear[0].facewidth", "did you mean 'face_width'?"),
    "unknown table": ("gaer", [], "gaer", "did you mean 'gear'?"),
    "fault without its kind": ("gear.0.fault", {"tooth": 1}, "gear[0].fault[0].kind", "missing-tooth"),
    "fault on no tooth": (
        "gear.0.fault",
        {"kind": "missing-tooth", "tooth": 99},
        "gear[0].fault[0].tooth",
        "a tooth from 0 to",
    ),
    "spall that ends first": (
        "gear.0.fault",
        {"kind": "spall", "tooth": 1, "depth": "1 um", "start_roll_angle": "20 deg", "end_roll_angle": "19 deg"},
        "gear[0].fault[0].end_roll_angle",
        "beyond start_roll_angle",
    ),
    "crack of a part of the face": (
        "gear.0.fault",
        {"kind": "crack", "tooth": 1, "depth": "1 mm", "width": "2 mm"},
        "gear[0].fault[0].width",
        "no 'width' of a fault of kind 'crack', got '2 mm'",
    ),
    "one fault's value": (
        "gear.0.fault",
        {"kind": "missing-tooth", "tooth": 99},
        "gear[0].fault[0].tooth",
        "a tooth from 0 to 27, got 99",
    ),
    "relief from nowhere": ("gear.0.tip_relief", {"amount": "10 um"}, "gear[0].tip_relief", "exactly one of"),
    "end relief without length": (
        "gear.0.errors",
        {"helix": {"end_relief": "5 um"}},
        "gear[0].errors.helix.end_relief_length",
        "length of the end relief",
    ),
    "profile table of one row": (
        "gear.0.errors",
        {"profile": {"table": [["20 deg", "1 um"]]}},
        "gear[0].errors.profile.table",
        "two rows or more",
    ),
    "eccentric twice": (
        "gear.0.errors",
        {"eccentricity": "5 um", "runout": "10 um"},
        "gear[0].errors.runout",
        "eccentricity or runout",
    ),
    "spacing of too few teeth": (
        "gear.0.errors",
        {"spacing": ["1 um", "2 um"]},
        "gear[0].errors.spacing",
        "one deviation for each",
    ),
    "web without rim": ("gear.0.web", "5 mm", "gear[0].web", "a rim around it"),
    "steep helix": ("gear.0.helix_angle", "70 deg", "gear[0].helix_angle", "at most 60 deg"),
    "no addendum": ("gear.0.addendum", 0, "gear[0].addendum", "above 0 and of at most 3"),
    "pitch as a length": ("gear.0.diametral_pitch", "8 mm", "gear[0].diametral_pitch", "such as '8 1/in'"),
    "undercut by a word": ("gear.0.allow_undercut", "certainly", "gear[0].allow_undercut", "true or false"),
    "rolling without load": (
        "bearing.2.stiffness",
        {"rolling": {"count": 7, "element_diameter": "11.5 mm", "pitch_diameter": "43.5 mm"}},
        "bearing[2].load",
        "{ x, y, z }, the force of the shaft on it",
    ),
    "load of a spring": ("bearing.0.load", {"x": "5 N"}, "bearing[0].load", "only the stiffness of a rolling bearing"),
    "rollers without length": (
        "bearing.2.stiffness",
        {"rolling": {"element": "roller", "count": 7, "element_diameter": "8 mm", "pitch_diameter": "43.5 mm"}},
        "bearing[2].stiffness.rolling.element_length",
        "the length of the rollers",
    ),
    "preload on rollers": (
        "bearing.2.stiffness",
        {
            "rolling": {
                "catalogue": {"type": "cylindrical-roller", "bore": 0.025, "outer_diameter": 0.052, "width": 0.015},
                "preload": "50 N",
            }
        },
        "bearing[2].stiffness.rolling.preload",
        "cylindrical rollers carry no axial load",
    ),
    "catalogue in inches": (
        "bearing.2.stiffness",
        {"rolling": {"catalogue": {"type": "deep-groove", "bore": "5 cm", "outer_diameter": "2 in", "width": "x"}}},
        "bearing[2].stiffness.rolling.catalogue.width",
        "a length",
    ),
    "ring inside out": (
        "bearing.2.stiffness",
        {"rolling": {"catalogue": {"type": "deep-groove", "bore": 0.06, "outer_diameter": 0.05, "width": 0.015}}},
        "bearing[2].stiffness.rolling.catalogue.outer_diameter",
        "more than the bore of 0.06 m",
    ),
    "unknown catalogue": (
        "bearing.2.stiffness",
        {"rolling": {"catalogue": {"type": "tapered", "bore": 0.03, "outer_diameter": 0.05, "width": 0.015}}},
        "bearing[2].stiffness.rolling.catalogue.type",
        "'deep-groove', 'angular-contact' or 'cylindrical-roller'",
    ),
    "pair without spacing": (
        "bearing.2.stiffness",
        {
            "rolling": {
                "count": 7,
                "element_diameter": "11.5 mm",
                "pitch_diameter": "43.5 mm",
                "preload": "10 N",
                "arrangement": "tandem",
            }
        },
        "bearing[2].stiffness.rolling.spacing",
        "the distance between the two rows",
    ),
    "matrix that pushes": (
        "bearing.0.stiffness",
        {"matrix": [[0.0] * 3 + [-1.0] * 2] * 5},
        "bearing[0].stiffness.matrix[3][3]",
        "at least 0",
    ),
    "matrix of four rows": (
        "bearing.1.damping",
        {"matrix": [[1.0] * 5] * 4},
        "bearing[1].damping.matrix",
        "five rows of five",
    ),
    "profile that is no table": ("gear.0.errors", {"profile": "1 um"}, "gear[0].errors.profile", "table"),
    "pitch of some teeth": ("gear.0.errors", {"pitch": ["1 um"] * 27}, "gear[0].errors.pitch", "each of 28 teeth"),
    "pitch of one tooth": ("gear.0.errors", {"pitch": "1 um"}, "gear[0].errors.pitch", "a list"),
    "pitch by weight": ("gear.0.errors", {"pitch": ["0 um", "1 kg"]}, "gear[0].errors.pitch[1]", "a length"),
    "pitch in millimetres": ("gear.0.errors", {"pitch": [0, 5]}, "gear[0].errors.pitch[1]", "at most 0.001 m"),
    "measured file": ("measured.file", "survey.uff", "measured.file", "an existing file"),
    "missing key": ("gear.0.teeth", GONE, "gear[0].teeth", "a whole number from 5"),
    "missing length": ("rotor.0.segments.0.diameter", GONE, "rotor[0].segments[0].diameter", "'6.35 mm'"),
    "short vector": ("housing.box.size", ["1 m", "1 m"], "housing.box.size[2]", "a length"),
    "wrong choice": ("rotor.0.mass", "lumpy", "rotor[0].mass", "'distributed' or 'lumped'"),
    "stiffness model": ("gear_pair.0.stiffness.model", "cornel", "gear_pair[0].stiffness.model", "'constant'"),
    "constant of nothing": (
        "gear_pair.0.stiffness",
        {"model": "constant"},
        "gear_pair[0].stiffness.value",
        "a stiffness",
    ),
    "table without file": ("gear_pair.0.stiffness", {"model": "table"}, "gear_pair[0].stiffness.file", "a file"),
    "text for a table": ("operation", "fast", "operation", "a table"),
    "table for a list": ("rotor.0.segments", {"length": "1 m"}, "rotor[0].segments", "a list"),
    "name with a slash": ("rotor.0.name", "a/b", "rotor[0].name", "without slashes"),
    "seat named ground": ("housing.seat.0.name", "ground", "housing.seat[0].name", "another name than 'ground'"),
    "seat named as a face": ("housing.seat.0.name", "front", "housing.seat[0].name", "of a face or foot"),
    "no such surface": ("housing.support.0.surface", "lid", "housing.support[0].surface", "left, right, bottom, top"),
    "title": ("title", 3, "title", "text"),
    "matrix": ("bearing.0.stiffness", {"matrix": [[1.0]]}, "bearing[0].stiffness.matrix", "five rows of five"),
    "two modules": ("gear.0.base_radius", "40 mm", "gear[0]", "exactly one of 'module', 'diametral_pitch' and"),
    "module and pitch": ("gear.0.diametral_pitch", "8 1/in", "gear[0]", "exactly one of 'module'"),
    "half an inertia": ("gear.0.mass", "1 kg", "gear[0]", "or none of them"),
    "direction": ("housing.sensor.0.direction", "up", "housing.sensor[0].direction", "'x', 'y' or 'z'"),
    "null direction": ("housing.sensor.0.direction", [0, 0, 0], "housing.sensor[0].direction", "a vector with a"),
    "two patches": ("housing.support.0.box", CAVITY_BOX, "housing.support[0]", "exactly one of 'box', 'surface'"),
    "held and sprung": ("housing.support.0.fixed", ["x"], "housing.support[0]", "either 'fixed', or"),
    "mesh file": ("housing.mesh", {"file": "none.msh"}, "housing.mesh.file", "an existing file"),
    "sweep step": (
        "sweep",
        {"speed": {"from": "9 rpm", "to": "3 rpm", "step": "1 rpm"}},
        "sweep.speed.step",
        "leads from",
    ),
    "measured order": ("measured.frequencies", ["9 Hz", "3 Hz"], "measured.frequencies[1]", "above the one before"),
    "measured zero": ("measured.frequencies.0", "0 Hz", "measured.frequencies[0]", "above 0 Hz"),
    "damping table": ("housing.damping_ratio", {"often": 0.01}, "housing.damping_ratio", "such as '658 Hz' as a key"),
    # names
    "material": ("housing.material", "steal", "housing.material", "did you mean 'steel'?"),
    "rotor of a bearing": ("bearing.0.rotor", "inptu", "bearing[0].rotor", "did you mean 'input'?"),
    "rotor of a gear": ("gear.0.rotor", "x", "gear[0].rotor", "'input', 'output'"),
    "seat": ("bearing.0.seat", "input-bakc", "bearing[0].seat", "did you mean 'input-back'?"),
    "gear": ("gear_pair.0.driven", "weel", "gear_pair[0].driven", "did you mean 'wheel'?"),
    "output rotor": ("operation.output", [{"rotor": "y", "torque": 1}], "operation.output[0].rotor", "of a rotor"),
    "rotor named housing": ("rotor.0.name", "housing", "rotor[0].name", "another name than 'housing'"),
    "same name": ("rotor.1.name", "input", "rotor[1].name", "rotor[0] has this one"),
    # places
    "bearing off the rotor": ("bearing.0.at", "1 m", "bearing[0].at", "which is 200 mm long"),
    "gear off the rotor": ("gear.0.at", "201 mm", "gear[0].at", "which is 200 mm long"),
    "unbalance": ("rotor.0.unbalance.0.at", "1 m", "rotor[0].unbalance[0].at", "which is 200 mm long"),
    "disc": ("rotor.0.discs", [{"at": "1 m", "mass": "1 kg"}], "rotor[0].discs[0].at", "which is 200 mm long"),
    "output station": (
        "operation.output",
        [{"rotor": "output", "torque": "71.77 N*m", "at": "3 m"}],
        "operation.output[0].at",
        "which is 200 mm long",
    ),
    "seat in no wall": ("housing.seat.0.center.2", "0 mm", "housing.seat[0].center[2]", "in the back wall, -80 mm to"),
    "bore beyond": ("housing.seat.0.diameter", "150 mm", "housing.seat[0].diameter", "beyond the edge"),
    "boss beyond": (
        "housing.seat.0.boss",
        {"diameter": "180 mm", "length": "5 mm"},
        "housing.seat[0].boss.diameter",
        "a boss within its wall",
    ),
    "boss in its bore": (
        "housing.seat.0.boss",
        {"diameter": "52 mm", "length": "5 mm"},
        "housing.seat[0].boss.diameter",
        "wider than its bore",
    ),
    "bores touch": ("housing.seat.2.diameter", "127 mm", "housing.seat[2].diameter", "overlap by 0.6 mm"),
    "axis off the seat": ("rotor.0.axis.0", "-44.4 mm", "bearing[0].seat", "is 0.05 mm off it"),
    "bearing off its wall": ("bearing.0.at", "100 mm", "bearing[0].at", 'of seat "input-back" along z'),
    "thick walls": ("housing.box.wall", "80 mm", "housing.box.wall", "leave room inside the 160 mm"),
    "large feet": ("housing.box.feet.size.0", "111 mm", "housing.box.feet.size[0]", "half the base along x, 110 mm"),
    "no feet": ("housing.box.feet", GONE, "housing.support[0].surface", "it has no feet"),
    "fifth foot": ("housing.support.0.surface", "foot-5", "housing.support[0].surface", "did you mean 'foot-"),
    "sensor outside": ("housing.sensor.0.position.1", "300 mm", "housing.sensor[0].position", "140 mm outside"),
    "sensor in cavity": ("housing.sensor.0.position.1", "80 mm", "housing.sensor[0].position", "from the front face"),
    "no geometry": ("housing.box", GONE, "housing", "exactly one of [housing.box], [housing.cad]"),
    "how many modes": ("housing.modes", 5, "housing", "exactly one of 'frequency_limit'"),
    # gears and running
    "module": ("gear.1.module", "3 mm", "gear_pair[0].driven", "gears of one module"),
    "angle": ("gear.1.pressure_angle", "25 deg", "gear_pair[0].driven", "gears of one pressure angle"),
    "helix of one gear": ("gear.0.helix_angle", "10 deg", "gear_pair[0].driven", 'has +10 deg, "wheel" +0 deg'),
    "planes": ("gear.1.at", "104 mm", "gear_pair[0].driven", "they are 4 mm apart along z"),
    "itself": ("gear_pair.0.driven", "pinion", "gear_pair[0].driven", "another gear than the driver itself"),
    "too few teeth": ("gear.1.teeth", 26, "gear_pair[0]", "the gears lose contact"),
    "too many teeth": ("gear.1.teeth", 30, "gear_pair[0]", "the gears jam"),
    "distance": ("gear_pair.0.centre_distance", "89 mm", "gear_pair[0].centre_distance", "axes, 88.9 mm"),
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


@pytest.mark.parametrize("kind", ONE_WRONG)
def test_one_wrong_value_is_named_with_its_place_and_what_was_expected(kind: str) -> None:
    path, value, key, expected = ONE_WRONG[kind]
    report = problems(broken((path, value)))
    lines = [line for line in report if line.startswith((f"case.toml: {key}:", f"case.toml: {key} ("))]
    assert lines, report
    assert expected in " ".join(lines)
    assert "expected" in lines[0]
    if isinstance(value, str) and lines[0].startswith(f"case.toml: {key}") and key.endswith(path.split(".")[-1]):
        assert f", got {value!r}" in lines[0]


WHEEL = {"name": "wheel", "rotor": "output", "at": "100 mm", "teeth": 28}

SEVERAL_CHANGES: dict[str, tuple[list[tuple[str, Any]], str, str]] = {
    "support that misses": (
        [("housing.support.0.surface", GONE), ("housing.support.0.box", NOWHERE_BOX)],
        "housing.support[0].box",
        "spans x = -110 mm to 110 mm",
    ),
    "support in the cavity": (
        [("housing.support.0.surface", GONE), ("housing.support.0.box", CAVITY_BOX)],
        "housing.support[0].box",
        "all in its cavity",
    ),
    "damping for each mode": (
        [("housing.frequency_limit", GONE), ("housing.modes", 3), ("housing.damping_ratio", [0.01, 0.02])],
        "housing.damping_ratio",
        "each of the 3 modes (there are 2)",
    ),
    "two geometries": (
        [("housing.cad", {"file": "a.step", "mesh_size": "9 mm"})],
        "housing",
        "['box', 'cad']",
    ),
    "coarser at the seats": (
        [
            ("housing.box", GONE),
            ("housing.cad", {"file": __file__, "mesh_size": "9 mm", "seat_mesh_size": "10 mm"}),
        ],
        "housing.cad.seat_mesh_size",
        "at most the mesh_size",
    ),
    "a loop that locks": (
        [
            (
                "gear",
                [
                    *GEARBOX["gear"],
                    {**GEARBOX["gear"][0], "name": "third", "teeth": 29},
                    {**GEARBOX["gear"][1], "name": "fourth", "teeth": 27},
                ],
            ),
            ("gear_pair", [*GEARBOX["gear_pair"], {"driver": "third", "driven": "fourth"}]),
        ],
        "gear_pair[1]",
        "a loop that can turn",
    ),
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
    "two gears on one rotor": (
        [("gear.1.rotor", "input")],
        "gear_pair[0].driven",
        'another rotor than "input"',
    ),
    "a shape for potential energy": (
        [("gear.1", {**WHEEL, "base_radius": "41.77 mm", "mass": 1, "polar_inertia": 1, "diametral_inertia": 1})],
        "gear_pair[0].stiffness.model",
        'gear "wheel" has no face_width',
    ),
    "base radii of other teeth": (
        [("gear.1", {**WHEEL, "base_radius": "45 mm", "face_width": "6.35 mm"})],
        "gear_pair[0].driven",
        "gears of one module",
    ),
    "a gear without its rotor": ([("gear.1.rotor", GONE), ("gear.1.at", GONE)], "gear[1].rotor", "'input', 'output'"),
}


@pytest.mark.parametrize("kind", SEVERAL_CHANGES)
def test_what_does_not_go_together_is_named(kind: str) -> None:
    changes, key, expected = SEVERAL_CHANGES[kind]
    report = problems(broken(*changes))
    assert any(line.startswith(f"case.toml: {key}") and expected in line for line in report), report


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


BAD_FILES = {
    "truncated": (b'title = "x', "line 1, column 11", "Unterminated string"),
    "no value": (b"title = 'a'\n[rotor]\nname =\n", "line 3, column 7", "Invalid value"),
    "float": (b"x = .3", "line 1, column 5", "expected TOML (Invalid value)"),
    "twice": (b"title = 'a'\ntitle = 'b'\n", "line 2, column 12", "Cannot overwrite"),
    "binary": (b"title = 'a'\n\xff\xfe", "line 2", "text in UTF-8"),
    "deep": (b"title = " + b"[" * 100_000, "case", "at most 32 deep"),
    "dotted": (b"title" + b".a" * 5000 + b" = 1", "case", "at most 32 deep"),
    "digits": (b"title = " + b"9" * 5000, "line", "TOML"),
}


@pytest.mark.parametrize("kind", BAD_FILES)
def test_what_is_not_toml_is_named_with_line_and_column(kind: str, tmp_path: Path) -> None:
    content, place, expected = BAD_FILES[kind]
    path = tmp_path / "bad.toml"
    path.write_bytes(content)
    with pytest.raises(CaseError) as caught:
        load_case(path)
    assert str(caught.value).startswith(f"bad.toml: {place}")
    assert expected in str(caught.value)


def test_every_truncation_of_a_case_is_a_case_or_a_case_error(tmp_path: Path) -> None:
    text = files("gearwhine.cases").joinpath("steel-box.toml").read_text(encoding="utf-8")
    path = tmp_path / "cut.toml"
    for length in range(0, len(text), 37):
        path.write_text(text[:length], encoding="utf-8")
        try:
            load_case(path)
        except CaseError as error:
            report = str(error)
        else:
            report = "cut.toml: nothing wrong"
        assert report.startswith("cut.toml: ")


def test_what_is_no_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="this is a folder"):
        load_case(tmp_path)
    with pytest.raises(CaseError, match=r"an existing file, or one of the bundled cases .*steel-box"):
        load_case(tmp_path / "none.toml")
    with pytest.raises(CaseError, match="did you mean 'steel-box'"):
        load_case("steel-bx")
    with pytest.raises(CaseError):
        load_case("a\0b")
    with pytest.raises(CaseError):
        load_case("a" * 5000)


def test_files_are_looked_for_beside_the_case(tmp_path: Path) -> None:
    """A relative file name starts at the case file's folder, wherever the program runs."""
    (tmp_path / "box.msh").write_text("", encoding="utf-8")
    path = tmp_path / "case.toml"
    case = """
        material.steel = { youngs_modulus = "207 GPa", poisson_ratio = 0.3, density = "7850 kg/m^3" }
        housing = { material = "steel", modes = 5, mesh = { file = "box.msh" } }
    """
    path.write_text(case, encoding="utf-8")
    housing = load_case(path).case.housing
    assert housing is not None
    assert housing.mesh is not None
    assert housing.mesh.file == (tmp_path / "box.msh").resolve()
    path.write_text(case.replace("box.msh", "ball.msh"), encoding="utf-8")
    with pytest.raises(CaseError, match=r"housing\.mesh\.file: expected an existing file"):
        load_case(path)
