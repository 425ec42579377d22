"""Modes on file through the real command: solved once, read while the housing is the same, never trusted blindly."""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from gearwhine.cli import run_command
from gearwhine.housing import read_modes
from gearwhine.housing.pictures import scene as renderer

COARSE = ("--set", 'housing.box.mesh_size="45 mm"')
CLOCK = ("seconds", "seconds_when_solved")
ORIGIN = ("reused", "modes_read_from", "warnings", "folder", "files", "made_at", "command", "input_files")


def result(document: dict) -> dict:
    """A document without what depends on the clock, and without where the modes came from."""
    return {key: value for key, value in document.items() if key not in (*CLOCK, *ORIGIN)}


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A results folder with the modes of the coarse steel box; to be copied, not touched."""
    folder = tmp_path_factory.mktemp("solved") / "out"
    assert run_command(["modes", "steel-box", "-q", "-o", str(folder), *COARSE]) == 0
    return folder


@pytest.fixture
def out(solved: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(solved, tmp_path / "out"))


def modes(gearwhine, *arguments: str) -> dict:
    outcome = gearwhine("modes", "steel-box", "--json", "-q", "-o", "out", *COARSE, *arguments)
    assert outcome.code == 0, outcome.err
    return outcome.document | {"stderr": outcome.err}


def told_of_the_mesh(document: dict) -> str:
    """The one warning of a sound run: elements of 45 mm are coarse."""
    (warning,) = document["warnings"]
    assert warning["name"] == "discretisation"
    return warning["message"]


@pytest.mark.slow
def test_the_second_run_reads_and_says_so(gearwhine, out: Path) -> None:
    first = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    before = (out / "modes.nc").read_bytes()
    again = modes(gearwhine)
    assert first["reused"] is False
    assert again["reused"] is True
    assert Path(again["modes_read_from"]) == Path("out/modes.nc")
    # What was told of the coarse mesh is told again, and no more.
    assert again.pop("stderr") == f"warning: {told_of_the_mesh(again)}\n"
    assert again["warnings"] == first["warnings"]
    assert result(again) == result(first)
    assert again["certificate"]["complete"] is True
    # No step of a solution took any time; how long it took then is told beside.
    assert all(again["seconds"][step] == 0.0 for step in ("mesh", "assembly", "factorisation", "eigensolver"))
    assert again["seconds"]["reading"] <= again["seconds"]["total"]
    assert again["seconds_when_solved"] == first["seconds"]
    assert (out / "modes.nc").read_bytes() == before
    assert {path.name for path in out.glob("[!.]*")} == set(again["files"]) == set(first["files"])
    screen = gearwhine("modes", "steel-box", "-o", "out", *COARSE)
    assert "Modes read from out/modes.nc (unchanged housing)" in screen.out
    assert "modes read from out/modes.nc (unchanged housing)" in screen.err


def test_the_screen_says_what_was_written(gearwhine) -> None:
    outcome = gearwhine("modes", "steel-box", "-q", "-o", "out", *COARSE)
    assert "Modes read" not in outcome.out
    assert "Written to out: case.toml, modes.nc, modes.vtu" in outcome.out


def test_nothing_is_kept_without_a_folder(gearwhine, out: Path, tmp_path: Path) -> None:
    outcome = gearwhine("modes", "steel-box", "--json", "-q", *COARSE)
    assert outcome.document["reused"] is False
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


@pytest.mark.slow
def test_another_wall_is_solved_anew_and_replaces_the_file(gearwhine, out: Path) -> None:
    thicker = modes(gearwhine, "--set", 'housing.box.wall="12 mm"')
    assert thicker["reused"] is False
    assert thicker["stderr"] == f"warning: {told_of_the_mesh(thicker)}\n"  # another housing is no damage
    assert modes(gearwhine, "--set", 'housing.box.wall="12 mm"')["reused"] is True
    thinner = modes(gearwhine)
    assert thinner["reused"] is False
    assert thicker["modes"][0]["frequency_hz"] != thinner["modes"][0]["frequency_hz"]


def test_another_sensor_or_damping_is_put_on_the_kept_modes(gearwhine, out: Path) -> None:
    kept = read_modes(out / "modes.nc")
    moved = modes(
        gearwhine,
        "--set",
        'housing.sensor.top.position=["-20 mm", "160 mm", "0 mm"]',
        "--set",
        "housing.damping_ratio=0.03",
    )
    assert moved["reused"] is True
    assert {mode["damping_ratio"] for mode in moved["modes"]} == {0.03}
    found = read_modes(out / "modes.nc")  # written again, with the sensor where it is now
    assert (found.key, found.seats) == (kept.key, kept.seats)
    assert found.modes.shapes.tobytes() == kept.modes.shapes.tobytes()
    assert found.sensors[0].position == pytest.approx((-0.02, 0.16, 0.0))
    assert found.sensors[1] == kept.sensors[1]


@pytest.mark.slow
def test_fresh_solves_again(gearwhine, out: Path) -> None:
    first = modes(gearwhine)
    fresh = modes(gearwhine, "--fresh")
    assert (first["reused"], fresh["reused"]) == (True, False)
    assert fresh["seconds"]["eigensolver"] > 0.0
    found, expected = ([mode["frequency_hz"] for mode in document["modes"]] for document in (fresh, first))
    assert found == pytest.approx(expected, rel=1e-10)


@pytest.mark.slow
def test_a_damaged_file_is_solved_again_with_a_warning(gearwhine, out: Path) -> None:
    """One bit of the shapes is another; every kind of damage is in ``tests/housing/test_mode_file.py``."""
    file = out / "modes.nc"
    content = bytearray(file.read_bytes())
    content[content.index(read_modes(file).modes.shapes.tobytes()) + 100] ^= 1
    file.write_bytes(content)
    document = modes(gearwhine)
    assert document["reused"] is False
    (warning,) = [entry for entry in document["warnings"] if entry["name"] != "discretisation"]
    assert "damaged" in warning["message"]
    assert "solved again" in warning["message"]
    assert f"warning: {warning['message']}" in document["stderr"]
    assert "Traceback" not in document["stderr"]
    assert document["certificate"]["complete"] is True
    assert modes(gearwhine)["reused"] is True


@pytest.mark.slow
def test_every_command_that_needs_modes_reads_them(gearwhine, tmp_path: Path) -> None:
    def command(name: str, *arguments: str) -> dict:
        outcome = gearwhine(name, "small-gearbox", "--json", "-q", "-o", "out", *COARSE, *arguments)
        assert outcome.code == 0, outcome.err
        return outcome.document

    first = command("system")
    assert first["reused"] is False
    assert {path.name for path in (tmp_path / "out").iterdir()} >= {"case.toml", "modes.nc", "summary.json"}
    again = command("system")
    assert again["reused"] is True
    assert result(again) == result(first)  # read modes lead to the very numbers that solved ones did
    assert command("compare")["reused"] is True
    models = command("render", "--format", "glb", "--modes", "1-2")
    assert models["reused"] is True
    drawn = sorted(path.name for path in (tmp_path / "out" / "render").glob("*.glb"))
    assert models["files"][:-1] == ["modes.nc", "render/case.toml", *(f"render/{name}" for name in drawn)]
    assert len(drawn) == 2
    command("render", "--format", "glb", "--modes", "3")
    assert len(list((tmp_path / "out" / "render").glob("*.glb"))) == 3  # beside those drawn before


@pytest.mark.slow
def test_a_run_reads_modes_and_clears_the_pictures_of_the_last_one(
    gearwhine, out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    few = (*COARSE, "--set", "housing.frequency_limit=", "--set", "housing.modes=2", "--set", "housing.seat=")

    def run(wall: str, *options: str) -> dict:
        changes = (*few, "--set", f'housing.box.wall="{wall}"')
        outcome = gearwhine("run", "steel-box", "-q", "--json", "-o", "out", *changes, *options)
        assert outcome.code == 0, outcome.err
        return outcome.document

    def pictures() -> set[str]:
        return {path.name for path in out.glob("mode-*.png")}

    (out / "mode-99-mine.png").write_bytes(b"mine")
    assert run("10 mm")["reused"] is False  # other modes are wanted than those kept
    first = pictures()
    other = run("12 mm")
    assert other["reused"] is False
    assert len(first) == 3
    assert first & pictures() == {"mode-99-mine.png"}
    # Without pictures none is left of other results, and nothing that draws is needed.
    monkeypatch.setattr(renderer, "_LIBRARIES", ())
    again = run("12 mm", "--no-pictures")
    assert again["reused"] is True
    assert again["housing"]["reused"] is True
    assert set(again["files"]) == {name for name in other["files"] if not name.endswith(".png")}
    assert {"modes.nc", "modes.vtu", "results.nc"} <= set(again["files"])
    assert pictures() == {"mode-99-mine.png"}
    refused = gearwhine("run", "steel-box", "-q", "-o", "out", *few)
    assert refused.code == 1
    assert "--no-pictures" in refused.err


DROPPED = """
import ctypes, os, sys
from gearwhine.cli import run_command
if os.getuid() == 0:
    # capabilities(7): version 3, this thread; effective, permitted and inheritable, the lower words first. Root keeps
    # its name and its own files, but without CAP_DAC_OVERRIDE (1) and CAP_DAC_READ_SEARCH (2) it obeys their modes.
    header, sets = (ctypes.c_uint32 * 2)(0x20080522, 0), (ctypes.c_uint32 * 6)()
    libc = ctypes.CDLL(None, use_errno=True)
    assert libc.capget(header, sets) == 0
    for word in range(3):
        sets[word] &= ~0b110
    assert libc.capset(header, sets) == 0
sys.exit(run_command(["modes", sys.argv[1], "-q", "-o", sys.argv[2]]))
"""


@pytest.mark.slow
def test_a_folder_that_takes_no_files_is_an_error() -> None:
    """Told before the work, to a user without rights on the folder; root gives up passing over modes."""
    root = Path(__file__).parent.parent.parent
    with tempfile.TemporaryDirectory() as name:
        case, folder = Path(name) / "case.toml", Path(name) / "out"
        shutil.copy(root / "gearwhine" / "cases" / "steel-box.toml", case)
        folder.mkdir(mode=0o555)
        Path(name).chmod(0o755)
        command = [sys.executable, "-c", DROPPED, str(case), str(folder)]
        done = subprocess.run(command, capture_output=True, text=True, cwd=root, check=False)
        assert done.returncode == 2, done.stderr
        assert "--output" in done.stderr
        assert "cannot be written to" in done.stderr
        assert "Traceback" not in done.stderr
        assert list(folder.iterdir()) == []
