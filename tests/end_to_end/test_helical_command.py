"""Helical gears through the whole command: the transient on the tabled faces, and what their thrust does."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from coupled_cases import coupled

from gearwhine.case import load_case
from gearwhine.cli import run_command
from gearwhine.coupling import coupled_modes
from gearwhine.coupling.linear.frequency_response import mesh_error_response
from gearwhine.output.manifest import opened_dataset

pytestmark = pytest.mark.slow

SHORTER = ("transient.revolutions=3", "transient.discard=1")


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("helical") / "out"
    changes = [part for change in SHORTER for part in ("--set", change)]
    assert run_command(["run", "helical-pair", "-q", "-o", str(folder), *changes]) == 0
    return folder


def test_the_results_hold_the_axial_force_and_the_moments_of_bearings(results: Path) -> None:
    with opened_dataset(results / "results.nc") as data:
        thrust = data["bearing_axial_force"].sel(bearing="input-left").mean().item()
        assert data["bearing_moment"].dims == ("bearing", "time", "moment_axis")
        assert data["bearing_force"].sel(axis="x").dims == ("bearing", "time")
    assert abs(thrust) == pytest.approx(1125.0, rel=2e-3)
    summary = json.loads((results / "summary.json").read_text(encoding="utf-8"))
    (left,) = [row for row in summary["bearings"] if row["name"] == "input-left"]
    assert left["mean_force_n"][2] == pytest.approx(thrust, rel=1e-5)
    assert left["mean_moment_n_m"] == [0.0, 0.0]


def test_the_spectra_hold_the_axial_force_and_the_moments_of_bearings(results: Path) -> None:
    """Held against a Fourier sum of the histories on file; a radial bearing's line of no axial force is none.

    Both have Hann's window, since so short a record still rings from its start.
    """
    case = load_case("helical-pair", SHORTER).case
    (mesh,) = case.parts.mesh_frequencies
    with opened_dataset(results / "results.nc") as data:
        times = data["time"].values
        hann = np.sin(np.pi * np.arange(times.size) / times.size) ** 2
        turns = hann / hann.sum() * np.exp(-2j * np.pi * mesh * times)
        for name in ("force", "axial_force", "moment"):
            spectrum = data[f"bearing_{name}_spectrum"].sel(frequency=mesh, method="nearest")
            assert spectrum.frequency.item() == pytest.approx(mesh, rel=1e-9)
            course = data[f"bearing_{name}"].astype(float).transpose("bearing", ..., "time").values
            assert data[f"bearing_{name}_spectrum"].attrs["window"] == "hann"
            direct = 2.0 * np.abs(course @ turns)
            np.testing.assert_allclose(spectrum.values, direct, rtol=1e-6, atol=1e-6 * direct.max())
        lines = data["bearing_axial_force_spectrum"].sel(frequency=mesh, method="nearest")
        assert lines.sel(bearing="input-left").item() > 1.0
        assert lines.sel(bearing="input-right").item() == 0.0


def test_the_response_to_an_error_holds_the_thrust_that_bearings_take() -> None:
    """Far below all modes the bearings of a shaft take the axial part of the teeth's force: F_bt tan β_b."""
    case = load_case("helical-pair").case
    found = mesh_error_response(coupled(case), np.array([2.0 * np.pi]))
    base = math.asin(math.sin(math.radians(15.0)) * math.cos(math.radians(20.0)))
    (force,) = found.mesh_force.values()
    axial = {
        shaft: sum(load[0, 2] for name, load in found.bearing_load.items() if name.startswith(shaft))
        for shaft in ("input", "output")
    }
    assert abs(axial["input"]) == pytest.approx(abs(force[0]) * math.tan(base), rel=1e-3)
    assert abs(axial["input"] + axial["output"]) < 1e-3 * abs(axial["input"])


def test_the_mesh_mode_does_not_lean_on_more_modes_of_the_shafts() -> None:
    """Tilting moments and thrust at the teeth find the shafts' own compliance, however few modes are kept."""
    found = []
    for limit in ("8 kHz", "40 kHz"):
        case = load_case("helical-pair", [f'rotor.{name}.frequency_limit="{limit}"' for name in (0, 1)]).case
        modes = coupled_modes(coupled(case).system)
        found.append(next(f for f, kind in zip(modes.frequencies_hz, modes.kinds, strict=True) if kind == "mesh"))
    # What modes lack over the face is a compliance without mass: it answers the motion as at rest.
    assert found[0] == pytest.approx(found[1], rel=1e-3)
