"""Results folders: files that appear whole, runs that share a folder, drawings of an earlier run."""

import json
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

import pytest

from gearwhine.output import listed_files, staging
from gearwhine.output.manifest import MANIFEST


def results(folder: Path, names: list[str], own: Path = Path()) -> None:
    """A command that leaves these files and lists them."""

    with staging(folder) as place:
        (place / own).mkdir(exist_ok=True)
        for name in names:
            (place / own / name).write_text(f"{name} of {len(names)}", encoding="utf-8")
        listed = [(own / name).as_posix() for name in [*names, "summary.json"]]
        (place / own / "summary.json").write_text(json.dumps({"files": listed}), encoding="utf-8")


def names_in(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()} - {MANIFEST}


@pytest.mark.parametrize("own", [Path(), Path("system")])
def test_new_results_clear_the_drawings_of_the_last_ones(tmp_path: Path, own: Path) -> None:
    results(tmp_path, ["mode-07.png", "mode-08.png", "mode-07.glb", "modes.vtu", "results.nc"], own)
    (tmp_path / own / "photo.png").write_text("mine", encoding="utf-8")
    results(tmp_path, ["mode-08.png", "mode-09.png", "results.nc"], own)
    assert names_in(tmp_path / own) == {"mode-08.png", "mode-09.png", "results.nc", "summary.json", "photo.png"}
    assert (tmp_path / own / "mode-08.png").read_text(encoding="utf-8") == "mode-08.png of 3"


def test_results_elsewhere_clear_nothing(tmp_path: Path) -> None:
    results(tmp_path, ["mode-07.png"])
    results(tmp_path, ["mode-01.png"], Path("system"))
    with staging(tmp_path) as place:
        (place / "report.html").write_text("", encoding="utf-8")
    assert names_in(tmp_path) == {"mode-07.png", "summary.json", "system", "report.html"}


def test_a_failed_run_clears_nothing(tmp_path: Path) -> None:
    results(tmp_path, ["mode-07.png"])
    with pytest.raises(RuntimeError), staging(tmp_path):
        raise RuntimeError
    assert names_in(tmp_path) == {"mode-07.png", "summary.json"}


@pytest.mark.parametrize(
    "content",
    ["", "[]", "7", '{"files": 7}', '{"files": [7, null, ["mode.png"]]}', '{"files": {"a": 1}}', '{"files"', "\x00"],
)
def test_a_summary_that_is_not_ours_lists_nothing(tmp_path: Path, content: str) -> None:
    (tmp_path / "summary.json").write_text(content, encoding="utf-8")
    (tmp_path / "mode.png").write_text("mine", encoding="utf-8")
    assert listed_files(tmp_path, Path()) == []


def test_only_plain_names_of_drawings_in_the_folder_are_cleared(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    (folder / "inner").mkdir(parents=True)
    (folder / "folder.png").mkdir()
    kept = [tmp_path / "outside.png", folder / "inner" / "deep.png", folder / "results.nc", folder / "notes.txt"]
    for path in kept:
        path.write_text("mine", encoding="utf-8")
    (folder / "link.png").symlink_to(tmp_path / "outside.png")
    listed = ["../outside.png", str(kept[0]), "inner/deep.png", "results.nc", "notes.txt", "link.png", "folder.png", ""]
    ours = {"command": "modes", "files": [*listed, "summary.json"]}
    (folder / "summary.json").write_text(json.dumps(ours), encoding="utf-8")
    results(folder, ["mode-01.png"])
    assert all(path.read_text(encoding="utf-8") == "mine" for path in kept)
    assert (folder / "link.png").is_symlink()
    assert (folder / "folder.png").is_dir()


def test_two_runs_at_once_leave_each_other_alone(tmp_path: Path) -> None:
    with ExitStack() as stack:
        first = stack.enter_context(staging(tmp_path))
        (first / "first.txt").write_text("1", encoding="utf-8")
        with staging(tmp_path) as second:
            (second / "second.txt").write_text("2", encoding="utf-8")
        assert (first / "first.txt").exists()
        assert names_in(tmp_path) == {"second.txt", first.name}
    assert names_in(tmp_path) == {"first.txt", "second.txt"}


def test_what_a_killed_run_left_is_cleared_and_what_a_living_one_is_at_is_not(tmp_path: Path) -> None:
    code = (
        "import sys, time; from pathlib import Path; from gearwhine.output import staging\n"
        "with staging(Path(sys.argv[1])) as place:\n"
        "    (place / 'half.txt').write_text('half'); print(place.name, flush=True); time.sleep(60)"
    )
    root = Path(__file__).parents[3]
    with subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path)], stdout=subprocess.PIPE, text=True, cwd=root
    ) as process:
        try:
            assert process.stdout is not None
            place = tmp_path / process.stdout.readline().strip()
            with staging(tmp_path):
                assert (place / "half.txt").exists()
        finally:
            process.kill()
    assert (place / "half.txt").exists()
    with staging(tmp_path):
        assert not place.exists()


def test_a_folder_that_was_made_for_nothing_goes_again(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError), staging(tmp_path / "deep" / "out"):
        raise RuntimeError
    assert not (tmp_path / "deep" / "out").exists()
