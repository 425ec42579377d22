"""The worked examples of machines in motion against statics, resonances and the linearity of their equations."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gearwhine as gw

# Of the pinion of `two_gears.toml` and of the rig [m]: module times teeth over two, at 20 degrees.
BASE_RADIUS = 3e-3 * 28 / 2 * np.cos(np.radians(20.0))
RIG_BASE_RADIUS = 3.175e-3 * 28 / 2 * np.cos(np.radians(20.0))


def mesh_resonance_rpm(study: gw.Study) -> float:
    """Speed at which the mesh frequency of 28 teeth meets the first elastic mode of the coupled machine."""
    frequencies = study.system().dataset["system_frequency"].values
    return float(60.0 / 28.0 * frequencies[frequencies > 1.0].min())


def test_first_steps_find_all_modes_and_the_mesh_harmonics(example: Any, tmp_path: Path) -> None:
    found = example("first_steps")
    certificate = found["modes"].proofs["certificate"]
    assert certificate["complete"]
    assert certificate["expected"] == len(found["frequencies"])
    # 28 teeth at 3000 rpm; what is beside the mesh harmonics comes from unbalance and runout.
    assert float(found["spectrum"].idxmax()) % (28 * 50.0) == pytest.approx(0.0, abs=1e-6)
    assert (tmp_path / "results" / "results.nc").is_file()


def test_spectrum_of_two_shafts_has_the_mean_force_and_the_mesh_frequency(example: Any) -> None:
    found = example("two_shafts_to_a_spectrum")
    assert found["mean_force"] == pytest.approx(60.0 / BASE_RADIUS, rel=5e-3)
    assert found["machine"].speeds["output"] == pytest.approx(-2400.0 * 28 / 42 * np.pi / 30.0)
    spectrum = found["spectrum"]
    loudest = spectrum.frequencies[spectrum.amplitude[1:].argmax() + 1] / (2400.0 / 60.0 * 28)
    assert loudest == pytest.approx(round(loudest), abs=1e-6)


def test_run_up_is_loudest_at_the_resonance(example: Any) -> None:
    found = example("run_up", "waterfall.png")
    # Windows of the run-up are some 90 rpm apart.
    assert found["peak_rpm"] == pytest.approx(mesh_resonance_rpm(found["study"]), abs=90.0)


def test_steady_state_is_loudest_at_the_resonance(example: Any) -> None:
    found = example("steady_state_over_speed", "curve.png")
    assert found["peak_rpm"] == pytest.approx(mesh_resonance_rpm(found["study"]), rel=0.01)


def test_read_results_finds_the_mean_force_and_mesh_harmonics(example: Any) -> None:
    found = example("read_results")
    loudest = found["loudest"]
    assert loudest[0.0] == pytest.approx(60.0 / BASE_RADIUS, rel=1e-3)
    order = loudest.index.to_numpy() / (2400.0 / 60.0 * 28)
    assert order == pytest.approx(np.round(order), abs=1e-6)
    assert found["units"]["mesh_force"] == "N"


def test_dynamic_factor_does_not_depend_on_torque(example: Any) -> None:
    """While flanks stay together the equations are linear in the load, whatever the stiffness does over time."""
    found = example("parameter_study", "sweep")
    factor = found["dynamic_factor"].squeeze()
    low, high = (factor.isel(operation_torque=number).values for number in (0, -1))
    assert low == pytest.approx(high, rel=1e-5)
    means = found["data"]["mesh_force_mean"].mean("gear_pair_0_damping_ratio").values.ravel()
    assert means == pytest.approx(np.array([20.0, 80.0]) / BASE_RADIUS, rel=5e-3)


def test_noise_rig_carries_its_torque_and_names_the_measured_modes(example: Any) -> None:
    found = example("noise_rig_end_to_end", "rig")
    assert found["mean_force"] == pytest.approx(71.77 / RIG_BASE_RADIUS, rel=2e-3)
    # TM-104434, Table II.
    pairs = found["run"].document["compare"]["pairs"]
    measured = [658.0, 1049.0, 1710.0, 2000.0, 2276.0, 2536.0, 2722.0, 2962.0]
    assert [pair["measured_hz"] for pair in pairs] == pytest.approx(measured)
