"""What is wrong with a case's acoustics is told by `check`, and by commands before they solve modes, all at once."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.case import CaseError, load_case
from gearwhine.cli.command_line import run_command
from gearwhine.coupling.sound.acoustics import Acoustics, Microphone
from gearwhine.coupling.sound.acoustics_checks import acoustics_warnings
from gearwhine.results.run import sections
from gearwhine.solve.acoustics import check_before_modes

pytestmark = pytest.mark.usefixtures("mechanisms_left_out")

INSIDE = {"name": "in", "position": ["0 mm", "80 mm", "0 mm"]}
UNDER = {"name": "under", "position": ["1 m", "-30 mm", "0 m"]}
AT_THE_WALL = {"name": "wall", "position": ["110.01 mm", "80 mm", "0 mm"]}
FREE = {"name": "free", "position": ["1 m", "0.5 m", "0.2 m"]}
WRONG: dict[str, Any] = {
    "acoustics.mesh_size": "50 mm",
    "acoustics.highest_frequency": "3 kHz",
    "acoustics.floor": "-20 mm",
    "acoustics.still": ["sole"],
    "acoustics.microphone": [INSIDE, FREE, UNDER, AT_THE_WALL],
}
TOLD = {
    "acoustics.still[0]": "a surface of the housing (",
    "acoustics.mesh_size": "too large for 3000 Hz",
    'acoustics.microphone[0].position (microphone "in")': "inside the radiating surface",
    'acoustics.microphone[2].position (microphone "under")': "behind the hard plane",
    'acoustics.microphone[3].position (microphone "wall")': "from the radiating surface; expected at least",
}


def problems(changes: dict[str, Any], of: str = "check", source: str = "small-gearbox") -> dict[str, str]:
    """Problems of a case by key, as an analysis tells them."""
    study = gw.load(source, changes)
    with pytest.raises(CaseError) as caught:
        getattr(study, of)()
    return {problem.key: problem.expected for problem in caught.value.problems}


def refused(changes: dict[str, Any]) -> dict[str, str]:
    """Problems of a case by key, as it is read."""
    with pytest.raises(CaseError) as caught:
        gw.load("small-gearbox", changes)
    return {problem.key: problem.expected for problem in caught.value.problems}


@pytest.fixture
def no_modes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Solving the modes fails."""
    monkeypatch.setattr("gearwhine.solve.housing_modes._solve_modes", None)


@pytest.mark.usefixtures("no_modes")
@pytest.mark.parametrize("of", ["check", "sound", "run"])
def test_all_that_is_wrong_is_told_before_modes_are_solved(of: str, tmp_path: Path) -> None:
    found = problems(WRONG | {"acoustics.in_run": True}, of)
    assert list(found) == list(TOLD)
    for key, text in TOLD.items():
        assert text in found[key]


@pytest.mark.parametrize(
    ("changes", "sounds"),
    [
        ({}, False),
        ({"acoustics.in_run": True}, True),
        ({"acoustics.method": "erp"}, True),
        ({"acoustics.method": "erp", "acoustics.in_run": False}, False),
    ],
)
def test_a_run_solves_boundary_elements_where_the_case_says_so(
    monkeypatch: pytest.MonkeyPatch, changes: dict[str, Any], *, sounds: bool
) -> None:
    coarse = {"housing.box.mesh_size": "45 mm", "acoustics.mesh_size": "50 mm", "acoustics.highest_frequency": "1 kHz"}
    monkeypatch.setattr("gearwhine.solve.kept_radiation.solve_sound", None)
    study = gw.load("steel-box", coarse | changes)
    if sounds:
        with pytest.raises(TypeError, match="NoneType"):
            study.run()
        return
    result = study.run()
    assert "the command sound finds" in result.document["sound_not_solved"]
    assert result.document["sound_not_solved"] in [text for part in sections(result.document) for text in part.content]
    assert result.solved.sound is None


@pytest.mark.usefixtures("no_modes")
def test_a_floor_above_the_soles_does_not_hide_the_rest() -> None:
    found = problems(WRONG | {"acoustics.floor": "5 mm", "acoustics.microphone_box": "1 m"})
    assert found["acoustics.floor"] == "a height at or below the soles, y = -20 mm"
    assert set(TOLD) - set(found) == {'acoustics.microphone[2].position (microphone "under")'}
    # Between two vertices of the wrap, and at its own accuracy, it stands on the floor.
    assert gw.load("small-gearbox", {"acoustics.floor": "-20 mm", "acoustics.mesh_size": "26 mm"}).check()


@pytest.mark.usefixtures("no_modes")
def test_microphones_of_the_box_are_told_by_its_distance() -> None:
    found = problems(
        {"acoustics.mesh_size": "30 mm", "acoustics.floor": "-20 mm", "acoustics.microphone_box": "0.1 mm"}
    )
    assert list(found) == ["acoustics.microphone_box"]
    assert "a distance at which microphone 'box " in found["acoustics.microphone_box"]


@pytest.mark.usefixtures("no_modes")
def test_faces_of_rayleigh_and_what_is_in_front_of_them() -> None:
    rayleigh = {"acoustics.method": "rayleigh", "acoustics.highest_frequency": "2 kHz"}
    assert "flat surface" in problems(rayleigh | {"acoustics.faces": ["input-back"]})["acoustics.faces[0]"]
    assert "a surface of the housing" in problems(rayleigh | {"acoustics.faces": ["lid"]})["acoustics.faces[0]"]
    found = problems(rayleigh | {"acoustics.faces": ["top"], "acoustics.microphone": [INSIDE, FREE]})
    assert list(found) == ['acoustics.microphone[0].position (microphone "in")']
    assert "behind the hard plane" in next(iter(found.values()))


@pytest.mark.usefixtures("no_modes")
@pytest.mark.parametrize("of", ["check", "sound"])
def test_elements_of_a_face_that_are_too_large_are_told_with_its_microphones(of: str) -> None:
    coarse = {"housing.box.mesh_size": "60 mm", "housing.frequency_limit": "8 kHz"}
    rayleigh = {"acoustics.method": "rayleigh", "acoustics.faces": ["top"], "acoustics.microphone": [INSIDE]}
    found = problems(coarse | rayleigh, of)
    assert set(found) == {"acoustics.faces[0]", 'acoustics.microphone[0].position (microphone "in")'}
    assert "too large for 8000 Hz" in found["acoustics.faces[0]"]
    fine = {"housing.box.mesh_size": "60 mm", "housing.frequency_limit": "2 kHz"}
    assert "acoustics.faces[0]" not in problems(fine | rayleigh, of)


def test_choices_that_rayleigh_does_not_take_are_told_together() -> None:
    found = refused(
        {
            "acoustics.method": "rayleigh",
            "acoustics.floor": "-20 mm",
            "acoustics.mesh_size": "20 mm",
            "acoustics.microphone_box": "1 m",
            "acoustics.microphone": [{"name": "box 3", "position": ["1 m", "1 m", "1 m"]}],
        }
    )
    keys = ("microphone[0].name", "faces", "floor", "mesh_size", "microphone_box")
    named = {key.split(" ")[0] for key in found}
    assert named == {f"acoustics.{key}" for key in keys}
    assert "no box of microphones with the method 'rayleigh'" in found["acoustics.microphone_box"]
    both = {"acoustics.method": "rayleigh", "acoustics.faces": ["top", "front"], "acoustics.microphone": [FREE]}
    assert "no microphones with 2 faces" in refused(both)["acoustics.microphone"]


def test_choices_of_other_methods() -> None:
    box = refused({"acoustics.microphone_box": "1 m"})
    assert list(box) == ["acoustics.floor"]
    assert "ISO 3744" in box["acoustics.floor"]
    estimate = {"acoustics.method": "erp", "acoustics.floor": "-20 mm", "acoustics.microphone": [FREE]}
    assert set(refused(estimate | {"acoustics.faces": ["top"]})) == {
        "acoustics.faces",
        "acoustics.floor",
        "acoustics.microphone",
    }


def told(changes: dict[str, Any]) -> dict[str, str]:
    """Warnings of `check` about acoustics."""
    document = gw.load("small-gearbox", changes).check().document
    found = document.get("warnings") or []
    return {one["name"]: one["message"] for one in found if one["name"].startswith("acoustics")}


def test_lengths_that_lack_their_unit_are_warned_of() -> None:
    coarse = {"acoustics.mesh_size": "30 mm", "acoustics.highest_frequency": "2 kHz"}
    near = coarse | {"acoustics.floor": "-2 m", "acoustics.microphone": [FREE]}
    assert told(near) == {}
    far = told(coarse | {"acoustics.floor": -20, "acoustics.microphone": [FREE | {"position": [60, 70, 0]}]})
    assert "lies 20 m below the housing, 91 times the size of the housing, 220 mm" in far["acoustics floor"]
    assert "floor = '-20 mm'" in far["acoustics floor"]
    assert 'microphone "free" is 92.1 m from the housing' in far["acoustics microphone"]
    wide = told(coarse | {"acoustics.floor": "-20 mm", "acoustics.microphone_box": 100})
    assert "microphone_box of 100 m is 455 times" in wide["acoustics microphone"]


def test_a_sound_beyond_the_modes_is_warned_of() -> None:
    limit = load_case("small-gearbox").case.housing.frequency_limit  # type: ignore[union-attr]
    assert limit is not None
    at_most = {"acoustics.mesh_size": "20 mm", "acoustics.highest_frequency": f"{limit} Hz"}
    assert told(at_most) == {}
    message = told(at_most | {"acoustics.highest_frequency": f"{1.2 * limit} Hz"})["acoustics frequency"]
    assert f"of {1.2 * limit:.5g} Hz is above {limit:.5g} Hz" in message


def test_a_case_without_acoustics_has_nothing_to_tell() -> None:
    case = load_case("small-gearbox").case
    assert check_before_modes(case.acoustics, case.housing) is None
    assert told({}) == {}


def test_the_exit_code_is_that_of_bad_input(capsys: pytest.CaptureFixture[str]) -> None:
    settings = ("--set", "acoustics.floor=5 mm", "--set", "acoustics.mesh_size=50 mm")
    settings += ("--set", "acoustics.highest_frequency=3 kHz")
    assert run_command(["check", "small-gearbox", "-q", *settings]) == 2
    said = capsys.readouterr().err
    assert "acoustics.floor: expected a height at or below the soles" in said
    assert "acoustics.mesh_size: expected an edge that suits" in said


BOUNDS = np.array([[0.0, 0.0, 0.0], [0.8, 0.4, 0.4]])  # its size is 0.8 m


@pytest.mark.parametrize(
    ("near", "far", "named"),
    [
        ({"floor": -15.9}, {"floor": -16.1}, "acoustics floor"),
        ({"microphone": (159.0, 0.0, 0.0)}, {"microphone": (0.0, 161.0, 0.0)}, "acoustics microphone"),
        ({"floor": 0.0, "microphone_box": 159.0}, {"floor": 0.0, "microphone_box": 161.0}, "acoustics microphone"),
        ({"highest_frequency": 3000.0}, {"highest_frequency": 3001.0}, "acoustics frequency"),
    ],
)
def test_what_is_far_from_a_housing_for_its_size_is_doubted(
    near: dict[str, Any], far: dict[str, Any], named: str
) -> None:
    """A floor from 20 and microphones from 200 sizes of the housing on; a sound above the modes' 3 kHz."""
    for given, expected in ((near, []), (far, [named])):
        place = given.get("microphone")
        microphones = (
            {} if place is None else {"microphone": (Microphone("m", tuple((place + BOUNDS.mean(axis=0)).tolist())),)}
        )
        warnings = acoustics_warnings(Acoustics(**given | microphones), BOUNDS, 3000.0)
        assert [one["name"] for one in warnings] == expected
