"""What is no case file, or none that can be read, is named with its place; files are found beside the case."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from pathlib import Path

import pytest

from gearwhine.case import CaseError, load_case, parse_case
from gearwhine.case.input_files import InputFiles

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
    # Contents that are known from another case are taken over as they were.
    file = str(housing.mesh.file)
    for known in (None, InputFiles({file: "as it was"})):
        taken = parse_case(tomllib.loads(case), folder=tmp_path, files=known).input_files.contents[file]
        assert (taken == "as it was") is (known is not None)
    path.write_text(case.replace("box.msh", "ball.msh"), encoding="utf-8")
    with pytest.raises(CaseError, match=r"housing\.mesh\.file: expected an existing file"):
        load_case(path)
