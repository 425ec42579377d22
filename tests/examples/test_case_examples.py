"""The worked examples of whole cases: a bundled gearbox, the noise rig, and a parameter study."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

# Module times teeth over two, at 20 degrees [m]: the pinion of `two_gears.toml`, and the rig's.
BASE_RADIUS = 3e-3 * 28 / 2 * np.cos(np.radians(20.0))
RIG_BASE_RADIUS = 3.175e-3 * 28 / 2 * np.cos(np.radians(20.0))


@pytest.mark.slow
@pytest.mark.usefixtures("larger_elements")
def test_first_steps_find_all_modes_and_the_mesh_harmonics(example: Any, tmp_path: Path) -> None:
    found = example("first_steps")
    certificate = found["modes"].proofs["certificate"]
    assert certificate["complete"]
    assert certificate["expected"] == len(found["frequencies"])
    # 28 teeth at 3000 rpm; what is beside the mesh harmonics comes from unbalance and runout.
    assert found["top"]["name"] == "top"
    assert found["top"]["peaks"][0]["frequency_hz"] % (28 * 50.0) == pytest.approx(0.0, abs=1e-3)
    spectrum = found["run"].dataset["sensor_spectrum"].sel(sensor="top", frequency=slice(0.0, 3000.0))
    assert float(spectrum.idxmax()) % (28 * 50.0) == pytest.approx(0.0, abs=1e-6)
    assert (tmp_path / "results" / "results.nc").is_file()


@pytest.mark.slow
@pytest.mark.usefixtures("swept_here")
def test_dynamic_factor_does_not_depend_on_torque(example: Any) -> None:
    """While flanks stay together the equations are linear in the load, whatever the stiffness does over time."""
    found = example("parameter_study", "sweep")
    factor = found["dynamic_factor"].squeeze()
    low, high = (factor.isel(operation_torque=number).values for number in (0, -1))
    assert low == pytest.approx(high, rel=1e-5)
    means = found["data"]["mesh_force_mean"].mean("gear_pair_0_damping_ratio").values.ravel()
    assert means == pytest.approx(np.array([20.0, 80.0]) / BASE_RADIUS, rel=5e-3)


@pytest.mark.slow
@pytest.mark.usefixtures("larger_elements")
def test_noise_rig_carries_its_torque_and_names_the_measured_modes(example: Any) -> None:
    found = example("noise_rig_end_to_end", "rig")
    assert found["mean_force"] == pytest.approx(71.77 / RIG_BASE_RADIUS, rel=2e-3)
    # TM-104434, Table II.
    pairs = found["run"].document["compare"]["pairs"]
    measured = [658.0, 1049.0, 1710.0, 2000.0, 2276.0, 2536.0, 2722.0, 2962.0]
    assert [pair["measured_hz"] for pair in pairs] == pytest.approx(measured)
