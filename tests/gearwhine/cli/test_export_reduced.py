"""`gearwhine export CASE --reduced FILE`: the housing's matrices, and the tables of a case that takes them."""

from pathlib import Path

import pytest

from gearwhine.cli.command_line import run_command


def test_the_matrices_and_their_tables_are_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    settings = ["--set", "housing.box.mesh_size=40 mm", "--quiet"]
    assert run_command(["export", "small-gearbox", "--reduced", "made/box.npz", *settings]) == 0
    said = capsys.readouterr().out
    for words in ("of order", "input-back: node 101", "top: node 10001", "box.toml"):
        assert words in said
    assert sorted(path.name for path in (tmp_path / "made").iterdir()) == ["box.npz", "box.toml"]
    first = (tmp_path / "made" / "box.toml").read_text("utf-8").splitlines()[0]
    assert first.startswith("# Reduced by Gearwhine ")
    assert "from Small gearbox" in first


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["small-gearbox", "--reduced", "box.csv"], "ends in one of .npz"),
        (["small-gearbox", "--reduced", "box.npz", "--csv"], "no other format beside it"),
        (["small-gearbox", "--reduced", "box.npz", "--rexs", "unit.rexs"], "no other format beside it"),
        ([".", "--reduced", "box.npz"], "a case, whose housing's modes are taken from its folder"),
        (["spur-pair", "--reduced", "box.npz"], "needs [housing]"),
    ],
)
def test_what_has_no_reduced_housing_is_refused(
    arguments: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run_command(["export", *arguments]) == 2
    assert words in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_what_stands_there_is_refused_before_the_housing_is_solved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("gearwhine.solve.housing_modes.solve_housing", lambda *_, **__: pytest.fail("it was solved"))
    for name in ("box.toml", "box.op4"):
        (tmp_path / name).write_text("mine")
        assert run_command(["export", "small-gearbox", "--reduced", "box.op4"]) == 2
        assert f"a place where no file of that name stands yet, got '{name}'" in capsys.readouterr().err
        (tmp_path / name).unlink()
