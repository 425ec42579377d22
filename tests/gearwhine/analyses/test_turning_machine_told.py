"""What results say of a machine whose directions turn: lines by kind and phasing, exponents, warnings."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import gearwhine as gw
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel
from gearwhine.coupling.linear.sensor_level import SensorLevel
from gearwhine.figures.machine.system import draw_system_campbell
from gearwhine.results.system import sections
from tests.machines.turning_set import TEETH, turning_machine, turning_set

NATURAL = (900.0, 1300.0)
RING = TEETH[0] + 2 * TEETH[1]


def test_analyses_that_freeze_the_carriers_warn_of_it() -> None:
    machine = turning_machine(NATURAL)
    modes = turning_set(NATURAL).modes()
    level = SensorLevel(MeshHarmonicModel(machine), 0, "x", {1: 1.0})
    for warnings in (modes.warnings, level.warnings):
        (told,) = warnings
        assert told["name"] == "carrier frozen"
        assert set(told["turning"]) == {
            f"planet gear {number} -> ring gear{part}" for number in (1, 2, 3) for part in ("", ", tilt")
        }
        assert told["turning_hz"] == pytest.approx(machine.speeds["carrier"] / (2.0 * np.pi), rel=1e-12)


def test_a_campbell_diagram_over_frozen_carriers_warns_of_it() -> None:
    diagram = turning_set(NATURAL).campbell([280.0, 300.0], frequency_limit=4000.0)
    assert [told["name"] for told in diagram.warnings] == ["carrier frozen"]
    turning, observed = diagram.turning_frequencies_hz, diagram.observed_hz
    assert turning is not None
    assert observed is not None
    solved = ~np.isnan(turning)
    assert np.count_nonzero(solved) > 4
    # Sensors on the housing see a mode at its exponent's frequency and whole turns of the carrier beside it.
    for number, speed in enumerate((280.0, 300.0)):
        carrier = turning_machine(NATURAL).speeds["carrier"] / 300.0 * speed / (2.0 * np.pi)
        plus, minus = ((observed + sign * turning)[number][solved[number]] / carrier for sign in (1.0, -1.0))
        off = [np.abs(turns - np.round(turns)) for turns in (plus, minus)]
        assert np.minimum(*off).max() < 1e-4
    figure = draw_system_campbell("Coupled modes over speed", diagram)
    (axes,) = figure.axes
    marks = {line.get_label(): line for line in axes.lines if line.get_label() in ("turning", "observed")}
    assert np.count_nonzero(~np.isnan(marks["turning"].get_ydata())) == np.count_nonzero(solved)
    assert 0 < np.count_nonzero(~np.isnan(marks["observed"].get_ydata())) <= np.count_nonzero(solved)


@pytest.mark.slow
@pytest.mark.usefixtures("few_points")
def test_system_tells_sidebands_exponents_and_the_error_of_frozen_carriers(tmp_path: Path) -> None:
    machine = turning_set(NATURAL)
    result = gw.Study(machine).system()
    document = result.document
    carrier = machine.assembled.speeds["carrier"] / (2.0 * np.pi)
    strongest = max(document["mesh_lines"], key=lambda line: line["sensor_acceleration_m_per_s2"]["together"]["x"])
    # Of 83 teeth, three planets keep the line one turn above the first harmonic.
    assert strongest["frequency_hz"] == pytest.approx((RING + 1) * carrier, rel=1e-9)
    assert strongest["cause"] == "1× planets' meshes + 1× carrier"
    assert strongest["kind"] == "planet pass"
    assert (strongest["harmonic"], strongest["turns"]) == (1, {"carrier": 1.0})
    assert strongest["phasing"] == pytest.approx(strongest["ideal_phasing"], abs=1e-9)
    limits = document["mesh_line_limits"]
    (followed,) = limits["carriers"]
    assert (followed["turns"], followed["planets"], followed["symmetry"]) == (6.0, 3, 3)
    (meshes,) = limits["meshes"]
    assert meshes["harmonics"] == int(limits["limit_hz"] / (RING * carrier))
    assert not strongest["suppressed"]
    assert strongest["order"] == pytest.approx((RING + 1) * carrier * 2.0 * np.pi / 300.0, rel=1e-9)
    (cancelled,) = (
        line for line in document["mesh_lines"] if line["frequency_hz"] == pytest.approx((RING - 1) * carrier, rel=1e-9)
    )
    assert cancelled["suppressed"]
    text = [str(one) for section in sections(document) for one in section.content if isinstance(one, str)]
    tables = [table.filled() for section in sections(document) for table in section.tables]
    (answers,) = (rows for columns, rows in tables if columns[0].heading == "by 1 µm of")
    assert len(answers) == len(document["transmissibility"]) == 6
    for row, response in zip(answers, document["transmissibility"], strict=True):
        peaks = response["sensor_acceleration_m_per_s2"]["x"]
        shown = [f"{peak['frequency_hz']:.0f} ({1e-6 * peak['amplitude']:.3g})" for peak in peaks]
        assert row[0] == response["excitation"]
        assert row[2] in (shown[int(np.argmax([peak["amplitude"] for peak in peaks]))] if peaks else "none")
    (told,) = (one for one in text if one.startswith("Equal planets would cancel in"))
    count = sum((round(line["frequency_hz"] / carrier) % 3) != 0 for line in document["mesh_lines"])
    assert f"in {count} of {len(document['mesh_lines'])} lines" in told
    assert "Of the cancelled lines less than 0.1 % of the highest line is left." in text
    (told,) = (one for one in text if one.startswith("Mesh frequency of planets' meshes"))
    above = (meshes["harmonics"] + 1) * RING * carrier
    assert above > limits["limit_hz"]
    assert f"{meshes['harmonics'] + 1}× is left out" in told

    over_speed = sections(
        document | {"campbell": {"lines": [], "crossings": [], "speeds_rpm": [2865.0], "unsettled": []}}
    )
    left_out = "Lines of the meshes over speed are left out where carriers turn"
    assert any(str(one).startswith(left_out) for section in over_speed for one in section.content)
    assert not any(one.startswith(left_out) for one in text)

    (frozen,) = (one for one in document["warnings"] if one["name"] == "carrier frozen")
    listed = [mode for mode in document["modes"] if mode["turning_frequency_hz"] is not None]
    errors = [mode["frequency_hz"] / mode["turning_frequency_hz"] - 1.0 for mode in listed]
    assert len(listed) > 15
    assert frozen["largest_error"] == pytest.approx(max(errors, key=abs), rel=1e-9)
    assert 1e-3 < abs(frozen["largest_error"]) < 0.02
    assert f"{100.0 * frozen['largest_error']:+.2g} %" in frozen["message"]

    result.write(tmp_path)
    with xr.open_dataset(tmp_path / "results.nc") as stored:
        kinds = stored["system_line_kind"].values.tolist()
        assert kinds == [line["kind"] for line in document["mesh_lines"]]
        assert stored["system_line_phasing"].values == pytest.approx(
            [line["phasing"] for line in document["mesh_lines"]], abs=1e-12
        )
    assert (tmp_path / "system-lines.png").exists()
