"""Every command on a bundled case, as a user runs it: the contract's JSON, the files, the screen."""

import json
import subprocess
from pathlib import Path
from unittest import mock

import numpy as np
import pytest
from PIL import Image

from gearwhine.cli import run_command

pytestmark = [pytest.mark.rendered, pytest.mark.slow, pytest.mark.usefixtures("few_reliefs_tried")]

COARSE = ("--set", "housing.box.mesh_size=45 mm")


def without_seconds(document: object) -> object:
    """A document without what depends on the clock."""
    if isinstance(document, dict):
        timed = ("seconds", "steps_per_second")
        return {key: without_seconds(value) for key, value in document.items() if key not in timed}
    return [without_seconds(value) for value in document] if isinstance(document, list) else document


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results of the main job on the small gearbox, whose pictures of the housing one process draws."""
    folder = tmp_path_factory.mktemp("run") / "out"
    shorter = ("--set", "transient.revolutions=6", "--set", "transient.discard=4", *COARSE)
    with mock.patch("subprocess.Popen", wraps=subprocess.Popen) as started:
        assert run_command(["run", "small-gearbox", "-q", "-o", str(folder), *shorter]) == 0
    assert ["gearwhine.drawing_process" in call.args[0] for call in started.call_args_list].count(True) == 1
    return folder


@pytest.fixture(scope="module")
def run_summary(run_folder: Path) -> dict:
    return json.loads((run_folder / "summary.json").read_text(encoding="utf-8"))


def test_run_leaves_the_promised_files(run_folder: Path, run_summary: dict) -> None:
    present = {path.name for path in run_folder.glob("[!.]*")}
    assert set(run_summary["files"]) == present
    assert {"results.nc", "summary.json", "case.toml", "spectrum.png", "mesh-force.png", "orbits.png"} <= present
    assert any(name.startswith("mode-") for name in present)
    for path in run_folder.glob("*.png"):
        with Image.open(path) as image:
            assert min(image.size) > 250  # the lowest is a bar of one gear pair
            colours = np.asarray(image.convert("RGB").reduce(4)) @ [1 << 16, 1 << 8, 1]
            assert np.unique(colours).size > 50


def test_every_mode_that_the_lines_name_is_drawn(run_folder: Path, run_summary: dict) -> None:
    parts = [line["contributions"]["housing_modes"] for one in run_summary["sensors"] for line in one["peaks"][:6]]
    leading = [max(modes, key=lambda mode: mode["share"]) for modes in parts]
    named = {mode["number"] for mode in leading if "number" in mode}
    assert len(named) > 1
    drawn = {int(path.name.split("-")[1]) for path in run_folder.glob("mode-*.png")}
    assert named <= drawn
    assert len(drawn) < len(run_summary["housing"]["modes"])


def test_the_resolved_case_runs_to_the_same_numbers(gearwhine, run_folder: Path, run_summary: dict) -> None:
    outcome = gearwhine("gears", str(run_folder / "case.toml"), "--json", "-q")
    assert outcome.code == 0
    # `gears` looks at other torques too, which the main job does not.
    for alone, of_run in zip(outcome.document["pairs"], run_summary["pairs"], strict=True):
        # Outside the folder of the run the seats are rigid; a box alike on both sides has no misalignment but rounding.
        assert alone["misalignment_rad"] == pytest.approx(of_run["misalignment_rad"], abs=1e-7)
        of_seats = {"misalignment_seats", "misalignment_rad"}
        extra = {key for key in alone if alone[key] != of_run.get(key)} - of_seats
        assert extra == {"harris_map", "optimal_tip_relief"}
        assert all(of_run[key] is None for key in extra)


def test_modes(gearwhine, answer, tmp_path: Path) -> None:
    outcome = gearwhine("modes", "steel-box", "--json", "-q", "-o", "out", *COARSE)
    document = outcome.document
    certificate = document["certificate"]
    assert certificate["complete"] is True
    assert certificate["expected"] == certificate["found"] == len(document["modes"])
    assert certificate["max_residual"] < 1e-8
    assert document["mesh"]["dofs"] == 3 * document["mesh"]["nodes"]
    assert {path.name for path in (tmp_path / "out").glob("[!.]*")} == set(document["files"])
    again = answer("modes", "steel-box", "--json", "-q", *COARSE).document
    assert without_seconds({"modes": again["modes"]}) == without_seconds({"modes": document["modes"]})


def test_compare(gearwhine) -> None:
    document = gearwhine("compare", "small-gearbox", "--json", "-q", "-o", "out", *COARSE).document
    assert {"comparison.csv", "comparison.png"} <= set(document["files"])
    for pair in document["pairs"]:
        assert pair["error_percent"] == pytest.approx(100 * (pair["model_hz"] / pair["measured_hz"] - 1))
    errors = [abs(pair["error_percent"]) for pair in document["pairs"]]
    assert document["max_error_percent"] == pytest.approx(max(errors))
    assert {"gap", "measures_agree", "rms_error_percent"} <= set(document)
    assert document["pairing"] == "dominance"


def test_check_sums_up_in_a_dozen_lines_and_shows_all_when_asked(gearwhine) -> None:
    brief = gearwhine("check", "nasa-gear-noise-rig", "-q").out.splitlines()
    assert len(brief) <= 16
    assert "housing     box of 279 x 254 x 330 mm, elements of 12 mm, steel; all modes below 3200 Hz" in brief
    assert "            4 seats, 4 supports, 3 sensors" in brief
    assert "bearings    4 in seats of the housing" in brief
    assert brief[-1] == "All of it: gearwhine check CASE --verbose"
    (pair,) = (line for line in brief if line.startswith("gear pairs  driver → driven: "))
    assert pair.endswith("28 : 28 teeth, contact ratio 1.638, mesh frequency 2566.67 Hz, mean force 1718.2 N")
    long = gearwhine("check", "nasa-gear-noise-rig", "-q", "--verbose").out
    assert "standing    gear.*.teeth: published: Table I" in long
    assert "All of it" not in long


@pytest.mark.parametrize(
    ("command", "case", "said"),
    [
        ("check", "nasa-gear-noise-rig", ["2566.67", "contact ratio"]),
        ("rotors", "friswell-rotor", ["bending, both planes", "Critical speeds from", "found"]),
        ("gears", "gear-62-62", ["1.78978", "N/µm"]),
        ("system", "spur-pair", ["coordinates", "kinetic energy"]),
        ("modes", "steel-box", ["inertia demands"]),
        ("compare", "small-gearbox", ["coin toss", "weak evidence"]),
        ("examples", None, ["friswell-rotor"]),
    ],
)
def test_the_screen_is_for_people(gearwhine, command: str, case: str | None, said: list[str]) -> None:
    coarse = COARSE if command in ("modes", "compare") else ()
    outcome = gearwhine(command, *([case, "-q", *coarse] if case else []))
    assert outcome.code == 0
    for text in said:
        assert text in outcome.out
