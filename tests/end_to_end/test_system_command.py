"""The linear analyses through the command: shares, stability, diagram over speed, transmissibility, files."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearwhine.output.manifest import opened_dataset

# Coarser than the case's own mesh: here the housing only has to be one.
COARSE = ("--set", "housing.box.mesh_size='50 mm'", "--set", "housing.frequency_limit='2 kHz'")
HELD = "{{matrix=[[{0},0,0,0,0],[0,{0},0,0,0],[0,0,{0},0,0],[0,0,0,0,0],[0,0,0,0,0]]}}"
HELICAL = (
    *(*COARSE, "--set", "operation.speed='1500 rpm'", "--set", "gear.*.at='80 mm'"),
    *("--set", "gear.*.face_width='30 mm'", "--set", "gear.*.module='3.0668 mm'"),
    *("--set", "gear.0.helix_angle='15 deg'", "--set", "gear.1.helix_angle='-15 deg'"),
    *("--set", "gear.*.tip_relief={amount='10 um', length='1.5 mm'}"),
    *("--set", f"bearing.0.stiffness={HELD.format(1.2e8)}", "--set", f"bearing.0.damping={HELD.format(500.0)}"),
    *("--set", f"bearing.2.stiffness={HELD.format(1.2e8)}", "--set", f"bearing.2.damping={HELD.format(500.0)}"),
)
"""The small gearbox with helical gears out of the middle of their shafts, whose back bearings carry the thrust."""


@pytest.fixture(scope="module", autouse=True)
def _less_effort(few_points: None) -> None:
    """Find each mechanism's part of a line, which stand in table and document."""


@pytest.mark.slow
def test_lines_of_sensors_by_error_and_by_shuttling(gearwhine: Any, tmp_path: Path) -> None:
    """Helical gears out of the middle: shuttling leads at the mesh frequency, which the transmissibility does not have.

    The lines are those of `load --sensitivity`, which has more modes at the sensors.
    """
    outcome = gearwhine("system", "small-gearbox", *HELICAL, "-o", "out", "-q")
    assert outcome.code == 0, outcome.err
    _says_what_excites_beside_transmission_error(outcome.out)
    document = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    lines = document["mesh_lines"]
    assert document["conventions"].keys() <= lines[0].keys() | lines[0]["sensor_acceleration_m_per_s2"].keys()
    first = 28 * 1500.0 / 60.0
    assert [line["frequency_hz"] for line in lines] == pytest.approx([first, 2.0 * first])
    assert [line["cause"] for line in lines] == ["1× pinion -> wheel", "2× pinion -> wheel"]
    for line in lines:
        acceleration = line["sensor_acceleration_m_per_s2"]
        for sensor in ("top", "right wall"):
            error, shuttling, both = (
                acceleration[name][sensor] for name in ("by_transmission_error", "by_load_shuttling", "together")
            )
            assert abs(error - shuttling) <= both <= error + shuttling
    with opened_dataset(tmp_path / "out" / "results.nc") as data:
        found = data["system_line_by_load_shuttling"].sel(system_line_sensor="top").isel(system_line=0)
        assert found.attrs["units"] == "m s-2"
        at_top = lines[0]["sensor_acceleration_m_per_s2"]
        assert found.item() == pytest.approx(at_top["by_load_shuttling"]["top"])
        assert at_top["by_load_shuttling"]["top"] > at_top["by_transmission_error"]["top"]
    load = gearwhine("load", "small-gearbox", *HELICAL, "--sensitivity", "--json", "-q").document
    by_load = {(one["sensor"], round(one["frequency_hz"])): one["amplitude_m_per_s2"] for one in load["sensor_lines"]}
    for line in lines:
        for sensor, together in line["sensor_acceleration_m_per_s2"]["together"].items():
            assert together == pytest.approx(by_load[sensor, round(line["frequency_hz"])], rel=0.05)


def _says_what_excites_beside_transmission_error(told: str) -> None:
    assert "by transmission error alone" in told
    assert "by shuttling" in told
    assert "load --sensitivity" in told
    rows = [line.split() for line in told.splitlines() if "× pinion" in line]
    for sensor in ("top", "right"):
        together = [float(row[-3]) for row in rows if row[0] == sensor]
        assert len(together) == 2
        assert together == sorted(together, reverse=True)


def test_contact_of_an_instant(gearwhine: Any) -> None:
    """One pair in contact at most phases of a spur pair, two at the others: softer and stiffer mesh modes."""
    meshes = []
    for phase in ("0.2", "0.8"):
        document = gearwhine("system", "spur-pair", "--mesh-phase", phase, "--json", "-q").document
        assert document["mesh_phase"] == float(phase)
        shares = [mode["energy"]["mesh"] for mode in document["modes"]]
        meshes.append(document["modes"][int(np.argmax(shares))]["frequency_hz"])
    assert meshes[0] > 1.05 * meshes[1]
    told = gearwhine("system", "spur-pair", "--mesh-phase", "0.2", "-q").out
    assert "by transmission error alone" in told
    assert "Highest lines" not in told


def test_what_cannot_be_asked(gearwhine: Any) -> None:
    refused = gearwhine("system", "friswell-rotor", "--mesh-phase", "0.5", "-q")
    assert refused.code == 2
    assert "[[gear_pair]]" in refused.err
    refused = gearwhine("system", "spur-pair", "--mesh-phase", "1.5", "-q")
    assert refused.code == 2
    assert "0 to 1" in refused.err
    still = gearwhine("system", "friswell-rotor", "--campbell", "--set", "operation.speed=0", "-q")
    assert still.code == 2
    assert "a machine that turns" in still.err


def test_an_unstable_machine_says_what_feeds_it(gearwhine: Any) -> None:
    """Friswell's rotor with cross-coupled bearings and no damping but the shaft's own."""
    change = "bearing.0.stiffness={ xx = '1e6 N/m', yy = '1e6 N/m', xy = '5e4 N/m', yx = '-5e4 N/m' }"
    outcome = gearwhine("system", "friswell-rotor", "--set", change, "-q")
    assert outcome.code == 0
    assert "UNSTABLE" in outcome.out
    document = gearwhine("system", "friswell-rotor", "--set", change, "--json", "-q").document
    growing = document["stability"]["growing"]
    names = {feeder["name"] for one in growing for feeder in one["fed_by"]}
    assert names == {"left"}
    assert all(one["damping_ratio"] < 0.0 < one["doubling_time_s"] for one in growing)
