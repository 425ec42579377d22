"""Files of the user in the output folder: what a case reads and what no run made is never replaced."""

import os
import shutil
from pathlib import Path
from typing import Any

import pytest

import gearwhine as gw
from gearwhine.case import bundled_files
from gearwhine.failures import ForeignFileError
from gearwhine.output.files import staging
from gearwhine.output.manifest import listed_digests
from gearwhine.output.own_files import require_free, require_own

ROTOR = bundled_files("friswell-rotor")[0]
MESH_CASE = """
title = "own mesh"
[material.steel]
youngs_modulus = "207 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"
[housing]
material = "steel"
modes = 7
mesh = { file = "mesh.inp" }
"""


@pytest.fixture
def own_case(tmp_path: Path) -> Path:
    """The user's own case file, named as the resolved case of results is."""
    shutil.copy(ROTOR, tmp_path / "case.toml")
    with (tmp_path / "case.toml").open("a", encoding="utf-8") as file:
        file.write("# my remarks\n")
    return tmp_path / "case.toml"


def _linked(folder: Path, case: Path, how: str) -> str:
    """Return the name of an output folder whose case.toml is the user's."""
    if how == "itself":
        return "."
    if how == "linked folder":
        (folder / "same").symlink_to(folder)
        return "same"
    (folder / "out").mkdir()
    if how == "hard link":
        os.link(case, folder / "out" / "case.toml")
    else:
        (folder / "out" / "case.toml").symlink_to(case)
    return "out"


@pytest.mark.parametrize("how", ["itself", "linked folder", "hard link", "symbolic link"])
def test_the_case_that_is_read_is_not_replaced(gearwhine: Any, own_case: Path, how: str) -> None:
    before = own_case.read_bytes()
    out = _linked(own_case.parent, own_case, how)
    outcome = gearwhine("check", "case.toml", "-q", "-o", out, "--set", "title=other")
    assert outcome.code == 2
    assert "case.toml: a file that the case reads; the results would replace it" in outcome.err
    assert own_case.read_bytes() == before
    assert not (own_case.parent / "summary.json").exists()


def test_the_mesh_that_the_case_names_is_not_replaced(gearwhine: Any, tmp_path: Path, block_of: Any) -> None:
    from gearwhine.meshes import write_mesh

    write_mesh(block_of("hexahedron"), tmp_path / "mesh.inp")
    (tmp_path / "own.toml").write_text(MESH_CASE, encoding="utf-8")
    before = (tmp_path / "mesh.inp").read_bytes()
    outcome = gearwhine("mesh", "own.toml", "-q", "-o", ".", "--format", "inp")
    assert outcome.code == 2
    assert "mesh.inp: a file that the case reads" in outcome.err
    assert (tmp_path / "mesh.inp").read_bytes() == before
    assert gearwhine("mesh", "own.toml", "-q", "-o", ".", "--format", "vtu").code == 0  # another file
    assert gearwhine("mesh", "own.toml", "-q", "-o", ".", "--format", "vtu").code == 0  # which is ours now
    (tmp_path / "mesh.msh").write_text("the user's own", encoding="utf-8")
    outcome = gearwhine("mesh", "own.toml", "-o", ".")  # the format that it has by default
    assert outcome.code == 2
    assert "mesh.msh: a file that no run of gearwhine made" in outcome.err
    assert "writing results" not in outcome.err


@pytest.mark.parametrize("name", ["results.nc", "case.toml", "rotor-rotor-modes.png", "modes.nc"])
def test_a_file_that_no_run_made_is_refused_before_the_solution(
    gearwhine: Any, own_case: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def solved(*_: object, **__: object) -> None:
        raise AssertionError("solved before the refusal")

    monkeypatch.setattr("gearwhine.case_study.CaseStudy.rotors", solved)
    monkeypatch.setattr("gearwhine.case_study.CaseStudy.modes", solved)
    folder = own_case.parent / "out"
    folder.mkdir()
    (folder / name).write_text("mine", encoding="utf-8")
    command = ("modes", "steel-box") if name == "modes.nc" else ("rotors", "case.toml")
    outcome = gearwhine(*command, "-q", "-o", "out")
    assert outcome.code == 2
    assert f"out/{name}: a file that no run of gearwhine made" in outcome.err
    assert (folder / name).read_text(encoding="utf-8") == "mine"
    assert list(folder.iterdir()) == [folder / name]


def test_results_of_earlier_runs_are_replaced_and_foreign_pages_are_not(gearwhine: Any, own_case: Path) -> None:
    folder = own_case.parent / "out"
    for _ in range(2):
        assert gearwhine("check", "case.toml", "-q", "-o", "out").code == 0
    again = gearwhine("check", "out/case.toml", "-q", "-o", "out")
    assert again.code == 2
    assert "out/case.toml: a file that the case reads" in again.err
    for _ in range(2):
        assert gearwhine("report", "out", "-q").code == 0
    (folder / ".gearwhine.json").unlink()  # the summary still says which files are ours
    assert gearwhine("check", "case.toml", "-q", "-o", "out").code == 0
    outcome = gearwhine("report", "out", "-q")
    assert outcome.code == 2
    assert "out/report.html: a file that no run of gearwhine made" in outcome.err


def test_what_patterns_do_not_foresee_is_held_back_when_files_move(tmp_path: Path) -> None:
    (tmp_path / "odd.dat").write_text("mine", encoding="utf-8")

    def write(*names: str) -> None:
        with staging(tmp_path) as place:
            for name in names:
                (place / name).write_text("theirs", encoding="utf-8")

    with pytest.raises(ForeignFileError, match=r"odd\.dat: a file that no run"):
        write("odd.dat", "other.dat")
    assert (tmp_path / "odd.dat").read_text(encoding="utf-8") == "mine"
    assert not (tmp_path / "other.dat").exists()
    write("other.dat")
    assert list(listed_digests(tmp_path)) == ["other.dat"]
    require_own(tmp_path, ["other.dat", "absent.dat"])


def test_python_replaces_no_case_file_either(own_case: Path) -> None:
    before = own_case.read_bytes()
    with pytest.raises(ForeignFileError, match="no run of gearwhine made"):
        gw.load(own_case).check().write(own_case.parent)
    assert own_case.read_bytes() == before


def test_a_command_beside_another_has_its_own_place(tmp_path: Path) -> None:
    with staging(tmp_path) as place:
        (place / "summary.json").write_text('{"command": "rotors", "files": ["summary.json"]}', encoding="utf-8")
    (tmp_path / "results.nc").write_text("mine", encoding="utf-8")
    require_free("gears", tmp_path, [])  # its results go to the folder `gears`
    (tmp_path / "gears").mkdir()
    (tmp_path / "gears" / "results.nc").write_text("mine", encoding="utf-8")
    for command in ("gears", "rotors", "run"):
        with pytest.raises(ForeignFileError, match=r"results\.nc"):
            require_free(command, tmp_path, [])
