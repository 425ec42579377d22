"""Helical gears through the whole command: the transient on the tabled faces, and what their thrust does."""

import json
import math
from pathlib import Path

import pytest
import xarray as xr

from gearwhine.cli import run_command


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("helical") / "out"
    shorter = ("--set", "transient.revolutions=3", "--set", "transient.discard=1")
    assert run_command(["run", "helical-pair", "-q", "-o", str(folder), *shorter]) == 0
    return folder


def test_helical_gears_run_and_balance_their_energy(results: Path) -> None:
    summary = json.loads((results / "summary.json").read_text(encoding="utf-8"))
    assert summary["energy_error"] < 1e-4
    (pair,) = summary["gear_pairs"]
    transverse = math.atan(math.tan(math.radians(20.0)) / math.cos(math.radians(15.0)))
    base_radius = 0.5 * 23 * 3e-3 / math.cos(math.radians(15.0)) * math.cos(transverse)
    assert pair["mean_force_n"] == pytest.approx(150.0 / base_radius, rel=1e-3)
    assert pair["contact_loss_fraction"] == 0.0


def test_helical_gears_excite_less_than_spur_gears_of_the_same_size(results: Path, tmp_path: Path) -> None:
    straight = [
        argument
        for change in ("gear.0.helix_angle=0", "gear.1.helix_angle=0", "gear_pair.0.centre_distance=96 mm")
        for argument in ("--set", change)
    ]
    axes = ["--set", 'rotor.0.axis=["-48 mm", "0 mm"]', "--set", 'rotor.1.axis=["48 mm", "0 mm"]']
    shorter = ["--set", "transient.revolutions=3", "--set", "transient.discard=1"]
    folder = tmp_path / "spur"
    assert run_command(["run", "helical-pair", "-q", "-o", str(folder), *straight, *axes, *shorter]) == 0
    swings = []
    for each in (results, folder):
        with xr.open_dataset(each / "results.nc") as data:
            force = data["mesh_force"].isel(contact=0)
            swings.append(float(force.max() - force.min()) / float(force.mean()))
    assert swings[0] < 0.5 * swings[1]
