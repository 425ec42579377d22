"""Results that carry their digests: damaged files are named, sets of files are whole, other files are left alone."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.failures import DamagedResultsError
from gearwhine.output import files as output_files
from gearwhine.output import staging
from gearwhine.output.manifest import MANIFEST, listed_digests, require_as_written

pytestmark = pytest.mark.usefixtures("few_reliefs_tried")


def write_set(folder: Path, command: str, mark: str, drawings: tuple[str, ...] = ("a.png",)) -> None:
    """A command's results, each file with a mark of its own run."""
    with staging(folder) as place:
        for name in ("results.nc", *drawings):
            (place / name).write_text(mark, encoding="utf-8")
        listed = ["results.nc", *drawings, "summary.json"]
        (place / "summary.json").write_text(json.dumps({"command": command, "mark": mark, "files": listed}), "utf-8")


def flip(path: Path, at: float, bit: int = 0) -> None:
    """Flip one bit of a file, at a part of its length."""
    content = bytearray(path.read_bytes())
    content[int(at * (len(content) - 1))] ^= 1 << bit
    path.write_bytes(content)


def marks(folder: Path) -> set[str]:
    """The runs whose files stand in a folder."""
    marked = {path.read_text(encoding="utf-8") for path in folder.iterdir() if path.suffix in (".nc", ".png")}
    return marked | {json.loads((folder / "summary.json").read_text(encoding="utf-8"))["mark"]}


def test_every_file_of_a_run_is_listed_and_one_changed_bit_is_found(tmp_path: Path) -> None:
    write_set(tmp_path, "gears", "one")
    assert set(listed_digests(tmp_path)) == {"results.nc", "a.png", "summary.json"}
    assert require_as_written(tmp_path) == []
    flip(tmp_path / "results.nc", 0.5)
    with pytest.raises(DamagedResultsError, match=r"results\.nc is damaged"):
        require_as_written(tmp_path)
    (remark,) = require_as_written(tmp_path, lambda name: name == "summary.json")
    assert "results.nc" in remark
    (tmp_path / "results.nc").unlink()
    (remark,) = require_as_written(tmp_path)
    assert remark.endswith("results.nc is missing")


@pytest.mark.parametrize("content", ["", "[]", "{", '{"files": {}}', '{"files": 7}', '{"files": {"a": 1}}', "\x00"])
def test_a_damaged_manifest_is_named(tmp_path: Path, content: str) -> None:
    write_set(tmp_path, "gears", "one")
    (tmp_path / MANIFEST).write_text(content, encoding="utf-8")
    with pytest.raises(DamagedResultsError, match=MANIFEST):
        listed_digests(tmp_path)


def test_a_changed_digest_in_the_manifest_blames_the_manifest(tmp_path: Path) -> None:
    write_set(tmp_path, "gears", "one")
    text = (tmp_path / MANIFEST).read_text(encoding="utf-8")
    (tmp_path / MANIFEST).write_text(text.replace("a.png", "b.png"), encoding="utf-8")
    with pytest.raises(DamagedResultsError, match=MANIFEST):
        listed_digests(tmp_path)


@pytest.mark.parametrize("survived", range(5))
def test_a_run_killed_while_its_files_move_leaves_one_whole_set(
    tmp_path: Path, survived: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_set(tmp_path, "gears", "one", ("a.png", "b.png"))
    real, moves = os.replace, []

    def dying(source: Path, target: Path) -> None:
        if len(moves) == survived:
            raise SystemExit  # as by a kill: nothing after it runs that matters
        moves.append(target)
        real(source, target)

    monkeypatch.setattr(output_files.os, "replace", dying)
    if survived < 4:
        with pytest.raises(SystemExit):
            write_set(tmp_path, "gears", "two", ("a.png",))
    else:
        write_set(tmp_path, "gears", "two", ("a.png",))
    monkeypatch.undo()
    output_files.finish_moves(tmp_path)
    assert marks(tmp_path) == {"two"}
    assert not (tmp_path / "b.png").exists()
    assert require_as_written(tmp_path) == []
    assert {path.name for path in tmp_path.iterdir()} == {"results.nc", "a.png", "summary.json", MANIFEST}


def test_a_run_takes_the_place_of_another_command_whose_results_move_whole(tmp_path: Path) -> None:
    study = gw.load("spur-pair")
    gears = study.gears()
    gears.write(tmp_path, pictures=False)
    before = (tmp_path / "results.nc").read_bytes()
    (tmp_path / "notes.txt").write_text("mine", encoding="utf-8")
    gears.__class__("run", gears.case, gears.solved, dict(gears.document)).write(tmp_path, pictures=False)
    assert (tmp_path / "gears" / "results.nc").read_bytes() == before
    assert not (tmp_path / "results.nc").exists()
    assert require_as_written(tmp_path) == []
    assert "gears/results.nc" in listed_digests(tmp_path)
    assert "results.nc" not in listed_digests(tmp_path)
    assert (tmp_path / "notes.txt").read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("name", ["results.nc", "summary.json", "case.toml"])
@pytest.mark.parametrize("at", [0.0, 0.37, 1.0])
def test_export_and_report_name_a_damaged_file(tmp_path: Path, name: str, at: float) -> None:
    study = gw.load("spur-pair")
    gears_of(study).write(tmp_path, pictures=False)
    flip(tmp_path / name, at, 3)
    with pytest.raises(DamagedResultsError, match=name):
        study.export(tmp_path, ("csv",))
    with pytest.raises(DamagedResultsError, match=name):
        study.report(tmp_path)


@pytest.mark.parametrize("size", [0, 100, 3000])
def test_a_truncated_file_of_results_without_digests_is_named(tmp_path: Path, size: int) -> None:
    study = gw.load("spur-pair")
    gears_of(study).write(tmp_path, pictures=False)
    (tmp_path / MANIFEST).unlink()
    os.truncate(tmp_path / "results.nc", size)
    with pytest.raises(DamagedResultsError, match=r"results\.nc"):
        study.export(tmp_path, ("uff",))


_GEARS: list[gw.Result] = []


def gears_of(study: gw.CaseStudy) -> gw.Result:
    """The pair's analysis, solved once for all tests."""
    if not _GEARS:
        _GEARS.append(study.gears())
    return _GEARS[0]


def test_the_arrays_of_a_sound_folder_are_as_they_were(tmp_path: Path) -> None:
    study = gw.load("spur-pair")
    result = gears_of(study)
    result.write(tmp_path, pictures=False)
    from gearwhine.output.manifest import opened_dataset

    with opened_dataset(tmp_path / "results.nc") as stored:
        name = next(name for name in result.dataset.data_vars if stored[name].dtype.kind == "f")
        assert np.array_equal(stored[name].values, result.dataset[name].values, equal_nan=True)
