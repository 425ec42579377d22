"""Commands that share an output folder: each keeps its own results, and none replaces another's."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from gearwhine.output.manifest import opened_dataset

pytestmark = pytest.mark.usefixtures("few_reliefs_tried")

FEW = ("rotor.input.modes=2", "rotor.output.modes=2")
QUICK = (*FEW, "rotor.input.unbalance=", "gear_pair.0.backlash='80 um'", "sweep.speed=['5400 rpm', '5600 rpm']")
FEW_WHIRLS = "rotor_analysis={ modes = 2, speed = ['3000 rpm'] }"
SHORT = ("--set", "transient.revolutions=3", "--set", "transient.discard=1")


def contents(folder: Path, but: str) -> dict[str, bytes]:
    """Of all files outside one sub-folder."""
    found = (
        path
        for path in folder.rglob("*")
        if path.is_file() and path.name != ".gearwhine.json" and path.relative_to(folder).parts[0] != but
    )
    return {str(path.relative_to(folder)): path.read_bytes() for path in found}


@pytest.mark.slow
def test_results_of_a_run_outlive_those_of_every_other_command(gearwhine: Callable[..., Any], tmp_path: Path) -> None:
    out, few = tmp_path / "out", [part for change in (*FEW, FEW_WHIRLS) for part in ("--set", change)]
    assert gearwhine("run", "spur-pair", "-q", "-o", "out", "--no-pictures", *few, *SHORT).code == 0
    before = contents(out, "")
    for command in ("rotors", "gears", "system"):
        outcome = gearwhine(command, "spur-pair", "-q", "--json", "-o", "out", *few)
        assert outcome.code == 0, outcome.err
        assert f"{command}/results.nc" in outcome.document["files"]
        assert all((out / name).is_file() for name in outcome.document["files"])
        kept = json.loads((out / command / "summary.json").read_text(encoding="utf-8"))
        assert kept == outcome.document
        assert contents(out, command) == before
        before = contents(out, "")
    with opened_dataset(out / "results.nc") as run, opened_dataset(out / "rotors" / "results.nc") as rotors:
        assert "mesh_force" in run
        assert "mesh_force" not in rotors

    # Once more: its own results alone are new.
    gearwhine("gears", "spur-pair", "-q", "-o", "out", *few, "--set", "gear_pair.0.friction=0.05")
    assert contents(out, "gears") == {name: data for name, data in before.items() if not name.startswith("gears/")}
    assert gearwhine("report", "spur-pair", "-q", "-o", "out", *few, *SHORT).code == 0
    page = (out / "report.html").read_text(encoding="utf-8")
    assert page.index("gearwhine gears") < page.index("gearwhine system") < page.index("gearwhine run")
    assert "gear_pair.0.friction was 0.05, is" in page
    # Its transient does not, where only the default was asked for.
    assert "transient.revolutions was" in page


@pytest.mark.parametrize("how", ["file", "link"])
def test_a_sub_folder_that_is_none_is_refused_before_the_work(
    gearwhine: Callable[..., Any], tmp_path: Path, how: str
) -> None:
    (tmp_path / "out").mkdir()
    if how == "file":
        (tmp_path / "out" / "gears").write_text("", encoding="utf-8")
    else:
        (tmp_path / "out" / "gears").symlink_to(tmp_path)
    outcome = gearwhine("gears", "spur-pair", "-q", "-o", "out")
    assert outcome.code == 2
    assert "'gears', where that command's go, is no folder" in outcome.err


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "option", "settings", "key", "array", "picture"),
    [
        ("system", ("--campbell",), FEW, "campbell", "system_campbell_frequency", "system-campbell.png"),
        ("steady", ("--curve", "--points", "8"), QUICK, "curve", "branch_peak_force", "steady-curve.png"),
    ],
)
def test_results_over_speed_outlive_the_command_without_the_option(
    gearwhine: Callable[..., Any],
    tmp_path: Path,
    command: str,
    option: tuple[str, ...],
    settings: tuple[str, ...],
    key: str,
    array: str,
    picture: str,
) -> None:
    out = tmp_path / "out"
    shared = ("-q", "--json", "-o", "out", *(part for change in settings for part in ("--set", change)))
    first = gearwhine(command, "spur-pair", *option, *shared)
    assert first.code == 0, first.err
    with opened_dataset(out / "results.nc") as data:
        before = data[array].load()
    drawn = (out / picture).read_bytes()
    second = gearwhine(command, "spur-pair", *shared)
    assert second.code == 0, second.err
    document = second.document
    assert document["kept"][0] == key
    assert all(document[one] == first.document[one] for one in document["kept"])
    assert json.loads((out / "summary.json").read_text(encoding="utf-8")) == document
    assert picture in document["files"]
    assert (out / picture).read_bytes() == drawn
    with opened_dataset(out / "results.nc") as data:
        xr.testing.assert_identical(data[array].load(), before)
    # Those of another case go.
    other = gearwhine(command, "spur-pair", *shared, "--set", "operation.torque=50 N*m").document
    assert not {"kept", key} & set(other)
    assert not (out / picture).exists()
