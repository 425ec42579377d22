"""Input that no command can use: refused in words, by `check` as by what would fail on it, before any work."""

import errno
import os
import random
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from gearwhine.output import staging

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "benchmarks"))

CRACK = 'gear.0.fault=[{kind="crack", tooth=1, depth="20 mm"}]'
ALL_MISSING = "gear.0.fault=[" + ",".join(f'{{kind="missing-tooth", tooth={n}}}' for n in range(28)) + "]"
IN_A_BORE = 'housing.sensor.0.position=["-44.45 mm", "80 mm", "-80 mm"]'
NO_MASS = 'bearing.0.pedestal={stiffness={xx="1e8 N/m", yy="1e8 N/m"}}'
BOLTS = 'housing.box.cover={face="front", bolts={diameter="6 mm", material="nobody"}}'
NO_NUMBER = 'update.parameter.0.keys=["housing.material"]'


@pytest.mark.parametrize(
    ("case", "changes", "told"),
    [
        ("spur-pair", [CRACK], "gear[0].fault[0].depth"),
        ("spur-pair", [ALL_MISSING], "no teeth meet"),
        ("small-gearbox", [IN_A_BORE], 'in the bore of seat "input-back", 26 mm from its rim'),
        ("spur-pair", [NO_MASS], "a mass above 0, to be followed in time"),
        ("steel-box", [BOLTS], "housing.box.cover.bolts.material"),
        ("nasa-gear-noise-rig-nominal", [NO_NUMBER], "a number; housing.material is none"),
        ("spur-pair", ["transient.revolutions=1e-9", "transient.discard=0"], "0.01 or more revolutions"),
        ("spur-pair", ["transient.revolutions=20", "transient.discard=19.9999999"], "0.01 or more revolutions"),
        ("spur-pair", ["operation.speed=1e30"], "an angular speed of at most 1e+06 rad/s"),
        ("spur-pair", ["bearing.0.stiffness.xx=1e300"], "a stiffness of at most 1e+15 N/m"),
        ("spur-pair", ["rotor.0.modes=1000"], "a whole number from 1 to 300"),
        ("spur-pair", [f"{'x' * 40_000}=1"], "xxx"),
    ],
)
def test_check_refuses_what_no_command_can_use(gearwhine: Any, case: str, changes: list[str], told: str) -> None:
    outcome = gearwhine("check", case, "-q", *(part for change in changes for part in ("--set", change)))
    assert outcome.code == 2
    assert told in outcome.err
    assert "Traceback" not in outcome.err
    assert len(outcome.err) < 10_000


@pytest.mark.parametrize("command", ["report", "export"])
def test_a_folder_that_is_none_is_not_taken_for_a_case(gearwhine: Any, command: str) -> None:
    outcome = gearwhine(command, "no-folder")
    assert outcome.code == 2
    assert "expected a folder of results, or a case that has one; there is none here, got 'no-folder'" in outcome.err
    assert "did you mean 'spur-pair'?" in gearwhine(command, "spur-pear").err


def test_a_rib_of_ten_metres_ends(gearwhine: Any) -> None:
    outcome = gearwhine(
        "mesh", "ribbed-box", "-q", "--set", "housing.box.ribs.0.height=10 m", "--set", "housing.box.mesh_size=80 mm"
    )
    assert outcome.code in (0, 2), outcome.err


def test_a_shaft_with_hundreds_of_modes_is_refused(gearwhine: Any) -> None:
    """Rubber in place of steel: a thousand modes below 8 kHz would each be a coordinate."""
    outcome = gearwhine("system", "spur-pair", "-q", "--set", "material.steel.youngs_modulus=2 kPa")
    assert outcome.code == 2
    assert "bending modes below 8000 Hz" in outcome.err
    assert "expected 300 or fewer" in outcome.err


def test_idle_gears_rattle_by_an_unbalance(gearwhine: Any) -> None:
    idle = ("operation.torque=0", 'rotor.0.unbalance=[{at="60 mm", moment="2e-5 kg*m"}]')
    short = ("transient.revolutions=3", "transient.discard=1")
    changes = [part for change in (*idle, *short) for part in ("--set", change)]
    outcome = gearwhine("run", "spur-pair", "-q", "--json", "--no-pictures", *changes)
    assert outcome.code == 0, outcome.err
    (pair,) = outcome.document["gear_pairs"]
    assert pair["contact_loss_fraction"] > 0.0


@pytest.mark.parametrize(
    ("folder", "told"),
    [
        ("", "--output is empty"),
        ("dangling/in", "a link that leads nowhere"),
        ("a" * 300, "at most 255 bytes"),
        ("taken", "'results.nc', where a file would go, is a folder"),
    ],
)
def test_output_folders_that_take_no_results(gearwhine: Any, tmp_path: Path, folder: str, told: str) -> None:
    (tmp_path / "dangling").symlink_to("nowhere")
    (tmp_path / "taken" / "results.nc").mkdir(parents=True)
    before = sorted(tmp_path.rglob("*"))
    outcome = gearwhine("run", "spur-pair", "-q", "-o", folder)
    assert outcome.code == 2
    assert told in outcome.err
    assert sorted(tmp_path.rglob("*")) == before


def test_no_space_left_names_the_place(tmp_path: Path) -> None:
    """Writers of arrays raise without a file's name; the folder that is full is told all the same."""
    with pytest.raises(OSError, match="No space left") as caught, staging(tmp_path / "full"):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    assert caught.value.filename == str(tmp_path / "full")


@pytest.mark.slow
def test_a_terminal_of_ascii_shows_what_it_can(tmp_path: Path) -> None:
    environment = os.environ | {"PYTHONIOENCODING": "ascii", "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "gearwhine", "check", "spur-pair"]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.isascii()


@pytest.mark.slow
def test_mutated_cases_and_damaged_files_end_in_words(tmp_path: Path) -> None:
    """A short form of benchmarks/fuzz.py: bundled cases with changes, and copies of CAD, mesh and survey files."""
    from fuzz import case_outcomes, file_outcomes

    quick = ("step", "brep", "msh", "vtu", "inp", "unv", "csv")
    ends = []
    for outcomes in (
        case_outcomes(random.Random(3), 8, tmp_path),
        file_outcomes(random.Random(3), 1, tmp_path, formats=quick),
    ):
        for what, place, outcome in outcomes:
            assert not outcome.fault or outcome.fault.startswith("took"), (what, place.read_bytes()[:2000], outcome)
            ends.append(outcome.code)
    assert ends.count(2) > 6
    assert ends.count(0) > 8  # at least the sound files
