"""What `run` writes of a run-up, of friction and of back flanks, held against what it must be."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from lopsided_case import FEW_WHIRLS, GEARS, SPEEDS, lopsided

from gearwhine.cli import run_command
from gearwhine.output.manifest import opened_dataset
from gearwhine.results.motion import mesh_sentence

pytestmark = pytest.mark.slow


def run(folder: Path, case: str, *changes: str) -> tuple[xr.Dataset, dict[str, Any]]:
    settings = [part for change in (FEW_WHIRLS, *changes) for part in ("--set", change)]
    assert run_command(["run", case, "-q", "--no-pictures", "-o", str(folder / "out"), *settings]) == 0
    summary = json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8"))
    with opened_dataset(folder / "out" / "results.nc") as data:
        return data.load(), summary


def test_a_run_up_s_spectra_and_orders(tmp_path: Path) -> None:
    case = tmp_path / "lopsided.toml"
    case.write_text(lopsided(housing=False), encoding="utf-8")
    transient = "run = { from = '600 rpm', to = '3600 rpm', time = '1 s' }, points_per_revolution = 200"
    data, summary = run(tmp_path, str(case), f"transient={{ {transient}, tolerance = 5e-3 }}")
    assert summary["run"] == {
        "from_rpm": pytest.approx(600.0),
        "to_rpm": pytest.approx(3600.0),
        "seconds": pytest.approx(1.0),
        "revolutions": pytest.approx(35.0, rel=1e-6),
        "train_inertia_kg_m2": summary["run"]["train_inertia_kg_m2"],
        "accelerating_torque_n_m": summary["run"]["accelerating_torque_n_m"],
    }
    # Torque is inertia times angular acceleration: 3000 rpm in a second.
    torque = summary["run"]["train_inertia_kg_m2"] * 100.0 * np.pi
    assert summary["run"]["accelerating_torque_n_m"] == {
        "least": pytest.approx(torque),
        "largest": pytest.approx(torque),
    }
    units = {
        "run_speed": "rpm", "run_frequency": "Hz", "order_speed": "rpm", "order": "1", "run_order_number": "1",
    }  # fmt: skip
    assert {name: data[name].attrs["units"] for name in units} == units
    assert data.run_unit.values.tolist() == ["N", "N"]
    assert data.run_signal.values.tolist() == ["a -> b", "c -> d"]
    for speeds in (data.run_speed.values, data.order_speed.values):
        assert (np.diff(speeds) > 0.0).all()
        # The low-pass filter of a long record takes a sixtieth of a second at its begin.
        assert speeds[0] == pytest.approx(600.0, rel=0.1)
        assert speeds[-1] == pytest.approx(3600.0, rel=0.01)
    ratio = abs(SPEEDS["middle"] / SPEEDS["input"])
    orders = {"1× a -> b": 23.0, "2× a -> b": 46.0, "1× c -> d": 21.0 * ratio, "1× input": 1.0}
    numbers = dict(zip(data.named_order.values.tolist(), data.run_order_number.values.tolist(), strict=True))
    for name, order in orders.items():
        assert numbers[name] == pytest.approx(order)
    # Each mesh's own force swings most at its own orders, and its line goes up with the speed; speeds are away from
    # those where a free vibration outweighs it.
    for signal, own in (("a -> b", 23.0), ("c -> d", 21.0 * ratio)):
        row = data.run_spectrum.sel(run_signal=signal)
        for number in (3, -1):
            hertz = own * float(data.run_speed[number]) / 60.0
            spectrum = row.isel(run_speed=number)
            near = spectrum.sel(run_frequency=slice(0.85 * hertz, 1.15 * hertz))
            found = float(near.run_frequency[int(np.argmax(near.values))])
            assert found == pytest.approx(hertz, rel=0.06), (signal, number)
        named = data.run_order_amplitude.sel(run_signal=signal)
        mean = {name: float(named.sel(named_order=name).mean()) for name in orders}
        assert max(mean, key=mean.__getitem__).endswith(signal)
        table = data.run_orders.sel(run_signal=signal)
        at = int(np.abs(data.order.values - own).argmin())
        exact = named.sel(named_order=f"1× {signal}").values
        if abs(float(data.order[at]) - own) < 1e-9:
            # The line of a window is a mean over it, the cut is the amplitude at its middle.
            assert np.median(table.isel(order=at).values / exact) == pytest.approx(1.0, abs=0.1)
    for told in summary["run_signature"]["orders"]:
        along = data.run_order_amplitude.sel(run_signal=told["signal"], named_order=told["name"])
        assert told["highest_amplitude"] == pytest.approx(float(along.max()), rel=1e-5)
        assert told["at_rpm"] == pytest.approx(float(along.order_speed[int(np.argmax(along.values))]))
        assert told["frequency_hz"] == pytest.approx(told["order"] * told["at_rpm"] / 60.0)
    assert summary["run_signature"]["from_rpm"] < summary["run_signature"]["to_rpm"]


def test_friction_takes_power(tmp_path: Path) -> None:
    """μ F at most across the line of action, and a per cent or so of the power that goes through."""
    data, summary = run(
        tmp_path, "spur-pair", "gear_pair.0.friction=0.06", "transient.revolutions=4", "transient.discard=2"
    )
    (contact,) = data.friction_contact.values[:1]
    force, power = (data[name].sel(friction_contact=contact).values for name in ("friction_force", "friction_power"))
    assert (data.friction_force.attrs["units"], data.friction_power.attrs["units"]) == ("N", "W")
    pressed = data.mesh_force.sel(contact=contact).values
    assert np.abs(force).max() <= 0.06 * pressed.max() * (1.0 + 1e-5)
    assert np.abs(force).max() > 0.05 * pressed.mean()
    assert force.min() < 0.0 < force.max()
    through = 71.77 * 5500.0 * np.pi / 30.0
    assert 0.003 * through < power.mean() < 0.03 * through
    told = summary["gear_pairs"][0]["friction"]
    assert told == {
        "mean_power_w": pytest.approx(power.mean(), rel=1e-4),
        "peak_power_w": pytest.approx(power.max(), rel=1e-4),
        "peak_force_n": pytest.approx(np.abs(force).max(), rel=1e-4),
    }
    energy = summary["energy_j"]
    assert energy["friction"] > 0.0  # from the nominal rotation, beside the balance
    assert energy["change"] == pytest.approx(
        energy["loads"] + energy["teeth"] - energy["lost"], abs=1e-3 * energy["lost"]
    )


def test_back_flanks_are_told_with_their_own_pair(tmp_path: Path) -> None:
    """All but unloaded and dropped into mesh, teeth rattle; each pair's back flanks have a force of their own."""
    case = tmp_path / "lopsided.toml"
    case.write_text(lopsided(housing=False), encoding="utf-8")
    changes = [f"gear_pair.{number}.backlash='0.3 um'" for number in range(2)]
    rattle = "transient={ revolutions = 6, discard = 1, start = 'unloaded', points_per_revolution = 200 }"
    data, summary = run(tmp_path, str(case), "operation.torque='0.8 N*m'", rattle, *changes)
    contacts = data.contact.values.tolist()
    assert contacts == ["a -> b", "c -> d", "a -> b, back", "c -> d, back"]
    peaks = []
    for pair in summary["gear_pairs"]:
        name = f"{pair['driver']} -> {pair['driven']}"
        sampled = float(data.mesh_force.sel(contact=f"{name}, back").max())
        peaks.append(pair["back_flank_peak_force_n"])
        assert peaks[-1] >= sampled * (1.0 - 1e-3)
        assert peaks[-1] <= 1.5 * sampled + 60.0
        apart = float((data.mesh_force.sel(contact=name) == 0.0).mean())
        assert pair["contact_loss_fraction"] == pytest.approx(apart, abs=0.02)
        drive, back = (data.mesh_force.sel(contact=f"{name}{side}").values.astype(float) for side in ("", ", back"))
        if (other := pair["other_flanks"]) is None:
            assert back.max() == 0.0
            continue
        assert other["mean_force_n"] == pytest.approx(back.mean(), rel=0.05, abs=0.1)
        assert other["net_mean_force_n"] == pytest.approx(drive.mean() - back.mean(), rel=0.05)
        assert other["both_apart_fraction"] == pytest.approx(((drive == 0.0) & (back == 0.0)).mean(), abs=0.02)
        assert f"its back flanks: mean {other['mean_force_n']:.0f} N" in mesh_sentence(pair)
    assert peaks[0] != peaks[1]
    assert GEARS["a"].teeth == 23
