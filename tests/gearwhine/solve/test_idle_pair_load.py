"""Operating point of a train with an idle gear pair: what a pair without load has not is null, and never a number."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from reducer_case import reducer

import gearwhine as gw
from gearwhine.analyses.result import Result
from gearwhine.coupling.load_analysis.solved_load import SolvedLoad
from gearwhine.output.terminal import show
from gearwhine.results.operating_point import sections

pytestmark = pytest.mark.slow

OF_LOAD = {
    "k_h_beta",
    "mean_stiffness_n_per_m",
    "transmission_error_m",
    "line_load_n_per_m",
    "contact_pressure_max_pa",
    "carrying_part",
    "transmission_error_over_hunting_period_m",
}
IN_DATA = ("face_load_factor", "mesh_mean_stiffness", "maximum_line_load", "face_mean_line_load", "face_line_load")


@pytest.fixture(scope="module")
def idle(tmp_path_factory: pytest.TempPathFactory) -> Result[SolvedLoad]:
    """The reducer with its torque taken off the middle shaft: the second pair turns and carries nothing."""
    file = tmp_path_factory.mktemp("idle") / "case.toml"
    file.write_text(reducer() + f'output = [{{ rotor = "middle", torque = {60.0 * 72.0 / 21.0} }}]\n', encoding="utf-8")
    return gw.load(file).operating_point(over_torque=True)


def test_an_idle_pair_has_no_values_of_a_load(idle: Result[SolvedLoad], tmp_path: Path) -> None:
    idle.write(tmp_path)
    document = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    loaded, unloaded = document["gear_pairs"]
    assert {key for key, value in unloaded.items() if value is None} == OF_LOAD
    # Teeth that are alike have one mesh period.
    assert {key for key, value in loaded.items() if value is None} == {"transmission_error_over_hunting_period_m"}
    assert (unloaded["force_n"], unloaded["thrust_n"]) == (0.0, 0.0)
    # Its shafts bend all the same: the middle one under the first pair.
    assert unloaded["misalignment_rad"] != 0.0
    for point in document["over_torque"]:
        first, second = point["gear_pairs"]
        assert None not in first.values()
        nulls = {key for key, value in second.items() if value is None}
        assert nulls == {"k_h_beta", "mean_stiffness_n_per_m", "transmission_error_peak_to_peak_m"}


def test_an_idle_pair_is_missing_in_the_data(idle: Result[SolvedLoad]) -> None:
    data = idle.dataset
    for name in (*IN_DATA, "face_load_factor_over_torque", "transmission_error_peak_to_peak_over_torque"):
        values = data[name].transpose("loaded_pair", ...).values
        assert np.isfinite(values[0]).all(), name
        assert np.isnan(values[1]).all(), name
    assert float(data["mesh_mean_force"][1]) == 0.0
    # The whole force of the first pair by hand, T / r_b.
    assert float(data["mesh_mean_force"][0]) == pytest.approx(60.0 / (21e-3 * math.cos(math.radians(20.0))), rel=1e-9)


def test_tables_and_figures_leave_an_idle_pair_out(
    idle: Result[SolvedLoad], capsys: pytest.CaptureFixture[str]
) -> None:
    names = [name for name, _ in idle.figures()]
    assert [name for name in names if name.startswith("load-face")] == ["load-face-a-b"]
    assert "load-over-torque" in names
    show(idle.document, sections(idle.document))
    printed = capsys.readouterr().out
    assert "nan" not in printed
    assert "None" not in printed
    (row,) = [line.split() for line in printed.splitlines() if line.split()[:3] == ["c", "d", "0"]]
    assert len(row) == 4
    assert not any("c' -> 'd" in text for text in idle.warnings)
