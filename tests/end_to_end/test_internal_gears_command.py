"""An internal pair between two shafts through the whole command: files, pictures, motion and report."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from gearwhine.cli import run_command
from gearwhine.output.manifest import opened_dataset

pytestmark = pytest.mark.slow

ROWS = ["2e8 N/m, 0, 0, 0, 0", "0, 2e8 N/m, 0, 0, 0", "0, 0, 1e8 N/m, 0, 0", "0, 0, 0, 0, 0", "0, 0, 0, 0, 0"]
HELD = [[0 if entry == "0" else entry for entry in row.split(", ")] for row in ROWS]
CASE = """
title = "Pinion in a ring"
[material.steel]
youngs_modulus = "210 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"
[[rotor]]
name = "input"
axis = ["40 mm", "0 mm"]
segments = [{ length = "120 mm", diameter = "25 mm" }]
[[rotor]]
name = "output"
start = "104 mm"
segments = [{ length = "150 mm", diameter = "34 mm" }]
[[gear]]
name = "pinion"
rotor = "input"
at = "105 mm"
teeth = 20
module = "2 mm"
face_width = "16 mm"
tip_relief = { amount = "10 um", length = "2 mm" }
[[gear]]
name = "ring"
rotor = "output"
at = "0 mm"
teeth = 60
internal = true
module = "2 mm"
face_width = "20 mm"
addendum = 0.7
rim = "10 mm"
[[gear_pair]]
driver = "pinion"
driven = "ring"
friction = 0.04
backlash = "0.08 mm"
[operation]
speed = "1500 rpm"
torque = "50 N m"
[transient]
revolutions = 6
discard = 2
"""


def bearings() -> str:
    """Two bearings on each shaft."""
    places = {"input": (20, 80), "output": (40, 140)}
    return "".join(
        f'[[bearing]]\nname = "{rotor}-{at}"\nrotor = "{rotor}"\nat = "{at} mm"\n'
        f"stiffness = {{ matrix = {json.dumps(HELD)} }}\n"
        f'damping = {{ xx = "800 N*s/m", yy = "800 N*s/m" }}\n'
        for rotor, stations in places.items()
        for at in stations
    )


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("internal")
    case = folder / "ring.toml"
    rotors = CASE.replace("[[rotor]]", '[[rotor]]\nmaterial = "steel"')
    case.write_text(rotors.replace("[[gear]]", bearings() + "[[gear]]", 1), encoding="utf-8")
    assert run_command(["run", str(case), "-q", "-o", str(folder / "out")]) == 0
    return folder / "out"


def test_shafts_turn_the_same_way_and_balance_their_energy(results: Path) -> None:
    summary = json.loads((results / "summary.json").read_text(encoding="utf-8"))
    assert summary["energy_error"] < 1e-4
    (pair,) = summary["gear_pairs"]
    assert pair["contact_loss_fraction"] == 0.0
    force = 50.0 / (20e-3 * math.cos(math.radians(20.0)))
    assert pair["mean_force_n"] == pytest.approx(force, rel=0.01)
    with opened_dataset(results / "results.nc") as data:
        mean = data["bearing_force"].mean("time")
        carried = {
            rotor: sum(mean.sel(bearing=f"{rotor}-{at}", axis=["x", "y"]).values for at in stations)
            for rotor, stations in {"input": (20, 80), "output": (40, 140)}.items()
        }
    # At the pitch point, on the far side of the pinion, the ring is pushed up and outward; friction tilts it.
    expected = np.array([50.0 / 20e-3 * math.tan(math.radians(20.0)), 50.0 / 20e-3])
    np.testing.assert_allclose(carried["output"], expected, rtol=0.04)
    np.testing.assert_allclose(carried["input"], -expected, rtol=0.04)


def test_report_shows_the_ring(results: Path) -> None:
    assert run_command(["report", str(results)]) == 0
    page = (results / "report.html").read_text(encoding="utf-8")
    assert "ring" in page
    assert (results / "gears-pinion-ring-teeth.png").is_file()
    assert "NaN" not in (results / "summary.json").read_text(encoding="utf-8")
