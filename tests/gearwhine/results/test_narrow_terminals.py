"""Meshes, survey plans, sweeps and meshing teeth on the screen, from documents built by hand."""

import io
from contextlib import redirect_stdout
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearwhine.output.quantity import document_of
from gearwhine.output.sections import Column, Section, Table
from gearwhine.output.terminal import show
from gearwhine.results import motion, survey, sweep
from gearwhine.results.mesh import bore_line

Document = dict[str, Any]


def shown(document: Document, *sections: Section) -> str:
    with redirect_stdout(io.StringIO()) as out:
        show(document, sections)
    return out.getvalue()


def test_a_bore_is_told_by_its_diameter_place_and_length_in_millimetres() -> None:
    bore = {"center_m": [-1e-9, 0.08, -0.115], "diameter_m": 0.052, "length_m": 0.015, "axis": "z"}
    assert bore_line(bore) == "bore of 52 mm at (0, 80, -115) mm, 15 mm long"
    assert "along x" in bore_line(bore | {"axis": "x"})


def test_a_sensor_that_looks_against_an_axis_is_said_to() -> None:
    columns = survey._SENSORS
    along = next(column for column in columns if column.heading == "direction")
    for direction, said in (([0.0, 0.0, 1.0], "z"), ([0.0, -1.0, 0.0], "-y"), ([0.6, 0.8, 0.0], "0.600 0.800 0.000")):
        assert along.text({"direction": direction}) == said
    places = [column.text({"position_m": [0.01, 0.02, -0.03]}) for column in columns if column.heading.endswith("[mm]")]
    assert places == ["10.0", "20.0", "-30.0"]


def test_a_point_of_a_sweep_shows_the_largest_force_of_its_teeth() -> None:
    pair = {
        "driver": "a",
        "driven": "b",
        "mean_force_n": 100.0,
        "peak_force_n": 150.0,
        "contact_loss_fraction": 0.25,
    }
    point = {
        "status": "done",
        "values": {"torque": 20.0},
        "sensors": [{"name": "top", "rms_m_per_s2": 1.5}],
        "gear_pairs": [pair],
        "energy_error": 2e-4,
    }
    document = {
        "points": [point, {"status": "failed", "settings": {"torque": "9 N*m"}, "failure": "it stalls"}],
        "axes": [{"name": "torque", "unit": "N m"}],
        "missed_peaks": [],
        "resumed": 0,
        "failed": 1,
        "done": 1,
    }
    (section,) = sweep.sections(document)
    columns, rows = section.tables[0].filled()
    cells = dict(zip((column.heading for column in columns), rows[0], strict=True))
    assert cells == {
        "torque [N·m]": "20",
        "top\nrms [m/s²]": "1.5",
        "a → b\nlargest [N]": "150",
        "apart": "25 %",
        "energy\nerror": "2e-04",
    }
    assert section.sentences == ("Failed at torque=9 N*m: it stalls", "1 of 2 points done; 1 failed")


def test_figures_of_a_mesh_are_those_of_its_own_contact() -> None:
    mesh = SimpleNamespace(driver=SimpleNamespace(name="a"), driven=SimpleNamespace(name="b"))
    figures = SimpleNamespace(
        mean_force=np.array([1.0, 2.0]), peak_force=np.array([3.0, 4.0]), contact_loss=np.array([0.5, 0.25])
    )
    assert document_of(motion.MESH, motion.MeshFigures(mesh, figures, 1)) == {
        "driver": "a",
        "driven": "b",
        "mean_force_n": 2.0,
        "peak_force_n": 4.0,
        "contact_loss_fraction": 0.25,
    }


@pytest.mark.parametrize(
    ("doubt", "said"), [(0.0, "733 (0.58)"), (0.25, "733 (0.58 ± 25 %)"), (2.0, "733 (0.58, unsure)")]
)
def test_the_doubt_about_a_line_is_said_in_percent_of_it(doubt: float, said: str) -> None:
    line = {"frequency_hz": 733.1, "amplitude_m_per_s2": 0.58, "uncertainty": doubt}
    assert motion.SENSOR_COLUMNS[2].text({"lines": [line]}) == said


def test_numbers_end_together_and_words_begin_together() -> None:
    table = Table((Column("wheel", "name"), Column("mass [kg]", "mass", ".1f")), (
        {"name": "pinion", "mass": 1.0},
        {"name": "gear", "mass": 250.0},
    ))  # fmt: skip
    first, second = (line for line in shown({}, Section("", (table,))).splitlines() if "0" in line)
    assert first.index("pinion") == second.index("gear")
    assert first.rstrip().index("1.0") + 3 == second.rstrip().index("250.0") + 5


def test_a_file_that_was_only_read_is_not_among_the_written_ones() -> None:
    written = {"folder": "out", "files": ["modes.nc", "results.nc"]}
    assert "Written to out: modes.nc, results.nc" in shown(written)
    read = shown(written | {"reused": True, "modes_read_from": "out/modes.nc"})
    assert "Modes read from out/modes.nc" in read
    assert "Written to out: results.nc" in read
