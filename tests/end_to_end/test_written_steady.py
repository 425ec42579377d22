"""What `steady` writes: one period of each motion and the branch over speed, held against what they must be."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from lopsided_case import GEARS, PAIRS, SPEEDS, bearing_forces, force, lopsided

from gearwhine.cli import run_command
from gearwhine.output.manifest import opened_dataset

pytestmark = pytest.mark.slow

FEW = ("rotor.input.modes=2", "rotor.output.modes=2", "rotor.input.unbalance=")
SWEPT = "sweep.speed=['4000 rpm', '6000 rpm']"
BACKLASH = "gear_pair.0.backlash='80 um'"
MESH_FORCE = 71.77 / (0.5 * 28 * 3.175e-3 * np.cos(np.radians(20.0)))


def solved(folder: Path, case: str, *options: str) -> tuple[xr.Dataset, dict[str, Any]]:
    assert run_command(["steady", case, "-q", "-o", str(folder / "out"), *options]) == 0
    summary = json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8"))
    with opened_dataset(folder / "out" / "results.nc") as data:
        return data.load(), summary


@pytest.fixture(scope="module")
def curve(tmp_path_factory: pytest.TempPathFactory) -> tuple[xr.Dataset, dict[str, Any]]:
    """The spur pair's motion from 4000 to 6000 rpm, at 5500 rpm on the way."""
    changes = [part for change in (*FEW, BACKLASH, SWEPT) for part in ("--set", change)]
    return solved(tmp_path_factory.mktemp("steady"), "spur-pair", "--curve", "--points", "12", *changes)


def test_one_period_at_operation(curve: tuple[xr.Dataset, dict[str, Any]]) -> None:
    data, summary = curve
    (motion,) = summary["motions"]
    assert data.steady_mesh_force.dims == ("steady_motion", "contact", "period_time")
    assert data.steady_mesh_force.attrs["units"] == "N"
    assert (data.period_time.dims, data.period_time.attrs["units"]) == (("period_time",), "s")
    period = 60.0 / 5500.0 / 28.0
    times = data.period_time.values
    assert times[-1] + times[1] == pytest.approx(period, rel=1e-9)
    pressed = data.contact.values.tolist().index("pinion -> wheel")
    signal = data.steady_mesh_force.values[0, pressed]
    assert signal.mean() == pytest.approx(MESH_FORCE, rel=1e-3)
    (pair,) = motion["gear_pairs"]
    assert pair["peak_force_n"] == pytest.approx(signal.max(), rel=5e-3)
    assert pair["mean_force_n"] == pytest.approx(MESH_FORCE, rel=1e-9)
    lines = 2.0 * np.fft.rfft(signal) / signal.size
    for line in pair["force_lines"]:
        order = round(line["frequency_hz"] * period)
        assert line["frequency_hz"] * period == pytest.approx(order)
        found = line["amplitude_n"] * np.exp(1j * line["phase_rad"])
        assert found == pytest.approx(lines[order], rel=1e-3)
    # The other contact is that of the back flanks, which do not meet.
    assert data.sizes["contact"] == 2
    others = [row for row in range(data.sizes["contact"]) if row != pressed]
    assert np.abs(data.steady_mesh_force.values[0, others]).max(initial=0.0) == 0.0


def test_multipliers_are_conjugate_and_inside_the_circle(curve: tuple[xr.Dataset, dict[str, Any]]) -> None:
    """Of a real motion; and their largest says whether it is stable."""
    data, summary = curve
    values = (
        data.floquet_multiplier.sel(part="real").values[0]
        + 1j * data.floquet_multiplier.sel(part="imaginary").values[0]
    )
    assert np.sort_complex(values) == pytest.approx(np.sort_complex(values.conj()), abs=1e-9)
    assert (np.abs(values.imag) > 0.1).any()
    (motion,) = summary["motions"]
    assert motion["largest_multiplier"] == pytest.approx(np.abs(values).max(), rel=1e-6)
    assert bool(data.steady_stable[0]) is motion["stable"] is True


def test_the_branch_over_speed(curve: tuple[xr.Dataset, dict[str, Any]]) -> None:
    data, summary = curve
    units = {name: data[name].attrs["units"] for name in ("branch_speed", "branch_compression", "branch_peak_force")}
    assert units == {"branch_speed": "rpm", "branch_compression": "m", "branch_peak_force": "N"}
    speeds = data.branch_speed.values
    assert speeds[[0, -1]] == pytest.approx([4000.0, 6000.0])
    told = summary["curve"]
    assert speeds == pytest.approx(told["speed_rpm"])
    row = data.sel(contact="pinion -> wheel")
    # All of it is stable but what lies between folds.
    assert data.branch_stable.values.tolist() == told["stable"]
    assert data.branch_stable.values[[0, -1]].all()
    assert (row.branch_peak_force.values > MESH_FORCE).all()
    loss = row.branch_contact_loss.values
    assert loss[0] == 0.0
    assert ((loss >= 0.0) & (loss < 1.0)).all()
    rms = row.branch_compression.values
    # Where it swings most its peak is among the highest.
    at = int(rms.argmax())
    assert row.branch_peak_force.values[at] > 0.9 * row.branch_peak_force.values.max()
    assert 1e-8 < rms.min() < rms.max() < 1e-4


def test_meshes_without_common_period_have_a_motion_each(tmp_path: Path) -> None:
    case = tmp_path / "lopsided.toml"
    case.write_text(lopsided(housing=False), encoding="utf-8")
    # By the lever the force acts in the middle of the face: on flanks out of line it would not.
    keys = ("rotor.input.unbalance=", "rotor.output.unbalance=", "gear_pair.*.misalignment=0 rad")
    data, summary = solved(tmp_path, str(case), *(part for key in keys for part in ("--set", key)))
    contacts = [" -> ".join(pair) for pair in PAIRS]
    assert data.contact.values.tolist() == contacts
    assert data.excitation_mesh_force.dims == ("excitation", "contact", "period_part")
    (motion,) = summary["motions"]
    # By the lever, under the mean mesh forces: each group's motion has them, and so has the sum.
    statics = bearing_forces({pair: complex(force(pair)) for pair in PAIRS})
    assert {one["name"] for one in motion["bearings"]} == set(statics)
    for one in motion["bearings"]:
        expected = [part.real for part in statics[one["name"]]]
        assert one["mean_force_n"][:2] == pytest.approx(expected, abs=2e-3 * max(map(force, PAIRS)))
        assert max(one["rms_force_n"]) > 0.0
    for number, name in enumerate(data.excitation.values.tolist()):
        (own,) = (row for row, contact in enumerate(contacts) if contact in name)
        driver = GEARS[PAIRS[own][0]]
        period = 2.0 * np.pi / abs(SPEEDS[driver.rotor]) / driver.teeth
        assert float(data.excitation_period[number]) == pytest.approx(period)
        assert data.excitation_period.attrs["units"] == "s"
        signals = data.excitation_mesh_force.values[number]
        assert signals.mean(axis=-1) == pytest.approx([force(pair) for pair in PAIRS], rel=2e-3)
        swings = signals.std(axis=-1)
        assert swings[own] > 0.0
        told = motion["excitations"][number]
        assert told["name"] == name
        assert bool(data.excitation_stable[number]) is told["stable"]
    # A line that several motions have is the sum of theirs.
    periods = data.excitation_period.values
    for row, pair in enumerate(motion["gear_pairs"]):
        lines = [2.0 * np.fft.rfft(force) / force.size for force in data.excitation_mesh_force.values[:, row]]
        for line in pair["force_lines"]:
            orders = line["frequency_hz"] * periods
            have = np.flatnonzero(np.abs(orders - np.round(orders)) < 1e-6 * orders)
            assert line["excitation"] in data.excitation.values[have]
            together = sum(lines[number][round(orders[number])] for number in have)
            assert line["amplitude_n"] == pytest.approx(abs(together), rel=1e-6)


def test_contacts_are_named_without_a_branch_too(tmp_path: Path) -> None:
    changes = [part for change in (*FEW, BACKLASH) for part in ("--set", change)]
    data, _ = solved(tmp_path, "spur-pair", *changes)
    peak = {name: float(data.steady_mesh_force.sel(contact=name).max()) for name in data.contact.values.tolist()}
    assert peak["pinion -> wheel"] > MESH_FORCE
    assert peak["pinion -> wheel, back"] == 0.0
