"""The worked examples of machines in motion against statics and resonances."""

from typing import Any

import numpy as np
import pytest

import gearwhine as gw

# Of the pinion of `two_gears.toml` [m]: module times teeth over two, at 20 degrees.
BASE_RADIUS = 3e-3 * 28 / 2 * np.cos(np.radians(20.0))


def mesh_resonance_rpm(study: gw.CaseStudy) -> float:
    """Speed at which the mesh frequency of 28 teeth meets the first elastic mode of the coupled machine."""
    frequencies = study.system().dataset["system_frequency"].values
    return float(60.0 / 28.0 * frequencies[frequencies > 1.0].min())


def test_spectrum_of_two_shafts_has_the_mean_force_and_the_mesh_frequency(example: Any) -> None:
    found = example("two_shafts_to_a_spectrum")
    assert found["mean_force"] == pytest.approx(60.0 / BASE_RADIUS, rel=5e-3)
    assert found["machine"].speeds["output"] == pytest.approx(-2400.0 * 28 / 42 * np.pi / 30.0)
    spectrum = found["spectrum"]
    loudest = spectrum.frequencies[spectrum.amplitude[1:].argmax() + 1] / (2400.0 / 60.0 * 28)
    assert loudest == pytest.approx(round(loudest), abs=1e-6)


@pytest.mark.slow
def test_run_up_is_loudest_at_the_resonance(example: Any) -> None:
    found = example("run_up", "waterfall.png")
    # Windows of the run-up are some 90 rpm apart.
    assert found["peak_rpm"] == pytest.approx(mesh_resonance_rpm(found["study"]), abs=90.0)


@pytest.mark.slow
def test_steady_state_is_loudest_at_the_resonance(example: Any) -> None:
    found = example("steady_state_over_speed", "curve.png")
    assert found["peak_rpm"] == pytest.approx(mesh_resonance_rpm(found["study"]), rel=0.01)


def test_operating_point_follows_from_levers_and_springs(example: Any) -> None:
    found = example("operating_point", "face.png")
    force = 60.0 / BASE_RADIUS
    # Bearings at 10 and 150 mm, the gears at 45 mm; the uneven load acts within a thousandth of that.
    carried = {name: np.hypot(*values[:2]) for name, values in found["forces"].to_pandas().iterrows()}
    assert carried["input-back"] == pytest.approx(force * 105 / 140, rel=2e-3)
    assert carried["input-front"] == pytest.approx(force * 35 / 140, rel=5e-3)
    # Springs of 3e8 N/m give way by different lengths, so both shafts tilt away from each other at the back.
    tilt = force * (105 - 35) / 140 / 3e8 / 0.14
    assert found["pair"]["misalignment_by_cause_rad"]["bearings"] == pytest.approx(-2.0 * tilt, rel=5e-3)


@pytest.mark.slow
def test_read_results_finds_the_mean_force_and_mesh_harmonics(example: Any) -> None:
    found = example("read_results")
    loudest = found["loudest"]
    assert loudest[0.0] == pytest.approx(60.0 / BASE_RADIUS, rel=1e-3)
    order = loudest.index.to_numpy() / (2400.0 / 60.0 * 28)
    assert order == pytest.approx(np.round(order), abs=1e-6)
    assert found["units"]["mesh_force"] == "N"
