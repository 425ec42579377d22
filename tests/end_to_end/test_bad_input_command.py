"""Bad input through the real command: exit code 2, a message that names key, value and expectation, nothing written."""

from pathlib import Path

import pytest

RIG = "nasa-gear-noise-rig"
BOX = "steel-box"

# What is wrong, the case, the changes, and what the message must say.
WRONG: list[tuple[str, str, list[str], list[str]]] = [
    ("wrong unit", RIG, ['housing.box.mesh_size="12 kg"'], ["housing.box.mesh_size", "12 kg", "length"]),
    ("misspelt key", RIG, ['gear.driver.face_with="6 mm"'], ["face_with", "face_width"]),
    ("dangling seat", RIG, ["bearing.input-back.seat=nowhere"], ["seat", "nowhere"]),
    ("overlapping bores", RIG, ['housing.seat.output-back.center=["-20 mm", "127 mm", "-165 mm"]'], ["output-back"]),
    ("seat in no wall", RIG, ['housing.seat.output-back.center=["44.45 mm", "127 mm", "0 mm"]'], ["output-back"]),
    ("two geometries", RIG, ['housing.mesh={file="x.msh"}'], ["housing"]),
    ("no such mesh file", BOX, ["housing.box=", 'housing.mesh={file="none.msh"}'], ["none.msh"]),
    ("gears in different planes", RIG, ['gear.driven.at="150 mm"'], ["driven"]),
    ("discarding everything", RIG, ["transient.discard=60"], ["discard", "60"]),
    ("foot support without feet", RIG, ["housing.box.feet="], ["foot-1"]),
    ("unknown path in --set", RIG, ["housing.cellar.depth=3"], ["cellar"]),
    ("a value that does not fit a list", RIG, ["bearing.9.at=1"], ["bearing"]),
]


@pytest.mark.parametrize(("case", "changes", "said"), [row[1:] for row in WRONG], ids=[row[0] for row in WRONG])
def test_wrong_value(gearwhine, tmp_path: Path, case: str, changes: list[str], said: list[str]) -> None:
    outcome = gearwhine("run", case, "-q", *[part for change in changes for part in ("--set", change)])
    assert outcome.code == 2
    assert outcome.out == ""
    assert "Traceback" not in outcome.err
    for text in said:
        assert text in outcome.err
    assert list(tmp_path.iterdir()) == []


def test_several_errors_are_told_at_once(gearwhine) -> None:
    changes = ['housing.box.mesh_size="12 kg"', "bearing.input-back.seat=nowhere", "gear.driver.teeth=-1"]
    outcome = gearwhine("check", RIG, *[part for change in changes for part in ("--set", change)])
    assert outcome.code == 2
    assert all(key in outcome.err for key in ("housing.box.mesh_size", "nowhere", "teeth"))


@pytest.mark.parametrize(
    ("content", "said"),
    [
        pytest.param(b'title = "cut off', ["line 1"], id="truncated TOML"),
        pytest.param(b"title = \xff\xfe", ["UTF-8"], id="not text"),
        pytest.param(b"", [], id="empty file"),
        pytest.param(b"title = 'only a title'", [], id="nothing to run"),
    ],
)
def test_wrong_file(gearwhine, tmp_path: Path, content: bytes, said: list[str]) -> None:
    (tmp_path / "case.toml").write_bytes(content)
    outcome = gearwhine("modes", "case.toml", "-q")
    assert outcome.code == 2
    assert "Traceback" not in outcome.err
    assert "case.toml" in outcome.err or "housing" in outcome.err
    for text in said:
        assert text in outcome.err
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


def test_missing_case_lists_the_bundled_ones(gearwhine) -> None:
    outcome = gearwhine("run", "no-such-case")
    assert outcome.code == 2
    assert "no-such-case" in outcome.err
    assert RIG in outcome.err


def test_a_folder_is_not_a_case(gearwhine, tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    outcome = gearwhine("run", "folder")
    assert outcome.code == 2
    assert "folder" in outcome.err


@pytest.mark.parametrize(
    ("command", "case", "said"),
    [
        ("modes", "friswell-rotor", "[housing]"),
        ("rotors", "steel-box", "[[rotor]]"),
        ("gears", "steel-box", "[[gear_pair]]"),
        ("system", "steel-box", "[operation]"),
        ("compare", "steel-box", "[measured]"),
    ],
)
def test_a_command_says_what_the_case_lacks(gearwhine, command: str, case: str, said: str) -> None:
    outcome = gearwhine(command, case)
    assert outcome.code == 2
    assert said in outcome.err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["fly"], "fly"),
        (["run"], "run: expected CASE"),
        (["modes", BOX, "more"], "modes: expected no further argument, got 'more'"),
        (["modes", BOX, "--colour"], "--colour"),
        (["mesh", "a", "--format", "x"], "--format"),
    ],
)
def test_wrong_usage(gearwhine, arguments: list[str], said: str) -> None:
    outcome = gearwhine(*arguments)
    assert outcome.code == 2
    assert "Traceback" not in outcome.err
    assert said in outcome.err
    assert "--help" in outcome.err


def test_what_a_command_finds_in_the_case_has_the_file(gearwhine) -> None:
    outcome = gearwhine("check", "small-gearbox", "-q", "--set", "acoustics.floor=0")
    assert outcome.code == 2
    assert "small-gearbox.toml: acoustics.floor: expected a height at or below the soles" in outcome.err


def test_modes_to_draw_that_do_not_exist(gearwhine, tmp_path: Path) -> None:
    outcome = gearwhine("render", "steel-box", "--modes", "three", "-q")
    assert outcome.code == 2
    assert "three" in outcome.err
    assert list(tmp_path.iterdir()) == []
