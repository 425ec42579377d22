"""Ranking of a machine's parts from Python, beside that of the same machine in a case."""

import json
from dataclasses import replace

import numpy as np
import pytest
from planetary_machines import AXIS as SET_AXIS
from planetary_machines import set_parts

import gearwhine as gw
from gearwhine.case.box import FACES
from gearwhine.case.model import housing_table
from gearwhine.coupling import CouplingError
from gearwhine.coupling.load_analysis.box_walls import wall_changes
from gearwhine.coupling.load_analysis.housing_fields import bearing_ports
from gearwhine.coupling.load_analysis.line_model import turning_carriers
from gearwhine.coupling.load_analysis.ranking import rank_parts
from gearwhine.from_case.parametric_housing import geometry_of
from gearwhine.meshes import Bore, BoxGeometry, WallThickness

AXIS = (SET_AXIS[0], 0.075)
RANKED = ("sensitivity", "sensor_lines", "loudest_lines", "loudest_lines_db_a", "lines_without")


def test_bearings_of_a_machine_are_ranked_as_in_the_case() -> None:
    study = gw.load("spur-pair")
    found = gw.Study(study.machine, study.settings).operating_point(sensitivity=True)
    expected = study.operating_point(sensitivity=True)
    assert len(expected.document["sensitivity"]) == 8
    assert json.dumps(found.document["sensitivity"]) == json.dumps(expected.document["sensitivity"])
    assert found.dataset["misalignment_change"].identical(expected.dataset["misalignment_change"])
    assert [entry["name"] for entry in found.document["warnings"]] == [
        entry["name"] for entry in expected.document["warnings"]
    ]
    with pytest.raises(CouplingError, match="line 'roof': expected one of the highest lines: none"):
        gw.Study(study.machine).operating_point(line="roof")


def test_walls_around_planets_are_ranked_without_lines_and_the_ranking_says_why() -> None:
    box = BoxGeometry((0.2, 0.15, 0.1), WallThickness.uniform(0.02), (Bore("bore", (*AXIS, 0.05), 0.05),))
    floor = gw.Support("floor", surface="bottom", fixed=(True, True, True))
    iron, roof = gw.Material(130e9, 0.26, 7200.0), gw.Sensor("roof", (0.0, 0.15, 0.0))
    housing = gw.Housing.from_box(box, 0.06, iron, fixtures=[floor], sensors=[roof]).modes(count=3)

    def machine(held: str) -> gw.Machine:
        parts = set_parts(count=2, held=held)
        above = [replace(one, axis=(one.axis[0], one.axis[1] + AXIS[1] - SET_AXIS[1])) for one in parts["shafts"]]
        seats = {"s 0.05": "bore", "p 0.01 1": "c"}
        seated = [replace(one, seat=seats.get(one.bearing.name)) for one in parts["bearings"]]
        off = [replace(one, bearing=replace(one.bearing, at=0.053)) if one.seat == "bore" else one for one in seated]
        return gw.Machine(**parts | {"shafts": above, "bearings": off, "housing": housing})

    turning = machine("r")
    found = rank_parts(turning, turning.operating_point())
    assert found.note == "lines of sensors and sound are not ranked, as the carrier 'c' turns"
    assert found.lines is None
    assert {one.kind for one in found.influences} == {"housing", "bearing stiffness", "bearing position"}
    assert turning_carriers(turning) == ("c",)
    assert turning_carriers(machine("c")) == ()
    # A housing that turns as a rigid body carries a bearing along that is 3 mm beside the middle of its seat.
    spin = np.array([1.0, -2.0, 0.5])
    ports = bearing_ports(housing.housing, turning)
    carried = [*np.cross(spin, (*AXIS, 0.053)), spin[0], spin[1]]
    np.testing.assert_allclose(ports["s 0.05"] @ np.cross(spin, housing.mesh.points).ravel(), carried, rtol=1e-6)

    # The outer faces of a wall that grows stand still, and its inner face moves inwards as much as it grows.
    points = housing.mesh.points
    middle, half = 0.5 * (points.min(axis=0) + points.max(axis=0)), np.array([0.07, 1.0, 0.025])
    inside = (np.abs(points - middle) < half).all(axis=1)
    changes = wall_changes(housing.housing, box, turning)
    walls = {change.parameter: change.rate.velocity for change in changes}
    for wall, inner, outer, way in (("bottom wall", 0.02, 0.0, 1.0), ("top wall", 0.13, 0.15, -1.0)):
        for height, speed in ((inner, way), (outer, 0.0)):
            face = inside & (np.abs(points[:, 1] - height) < 1e-9)
            assert face.any()
            moved = walls[wall][face]
            np.testing.assert_allclose(moved, np.tile([0.0, speed, 0.0], (len(moved), 1)), atol=1e-6)
    # A housing that only shifts carries all along alike, whatever its walls.
    for change in changes:
        for port in (*change.bearings.values(), *change.sensors.values()):
            assert np.abs(port @ np.ones(points.size)).max() < 1e-6


@pytest.mark.slow
def test_faces_lines_and_sound_of_a_machine_in_a_housing_of_python_are_those_of_the_case() -> None:
    """A box with rounded edges, whose faces the case ranks, too; and the same box reduced to its motions at seats."""
    changes = {
        "housing.box.mesh_size": "60 mm",
        "housing.box.fillets": {"inside": "8 mm"},
        "housing.frequency_limit": "4 kHz",
        "acoustics.method": "erp",
        "acoustics.mesh_size": "40 mm",
    }
    study = gw.load("small-gearbox", changes)
    assert study.housing is not None
    assert study.case.housing is not None
    described = study.housing.housing
    modes = described.modes(below_hz=study.case.housing.frequency_limit, bearings=study.housing.bearings)
    machine = replace(study.machine, housing=modes)
    found = gw.Study(machine, study.settings).operating_point(sensitivity=True).document
    expected = study.operating_point(sensitivity=True).document
    assert {row["kind"] for row in expected["sensitivity"]} == {"face", "bearing stiffness", "bearing position"}
    assert found["sensor_lines"]
    assert found["loudest_lines"]
    for key in RANKED:
        assert _alike(found.get(key), expected.get(key)), key

    reduced = replace(machine, housing=machine.housing_component)
    result = gw.Study(reduced, study.settings).operating_point(sensitivity=True)
    rows = [row for row in expected["sensitivity"] if row["kind"] != "face"]
    assert _alike([row["gear_pairs"] for row in result.document["sensitivity"]], [row["gear_pairs"] for row in rows])
    assert any("walls are not ranked" in message for message in result.warnings)


@pytest.mark.slow
def test_walls_of_a_box_of_python_are_those_of_the_case() -> None:
    """The box is described, meshed and solved by `gw.Housing`; derivatives by its walls take another step."""
    changes = {"housing.box.mesh_size": "60 mm", "housing.frequency_limit": "4 kHz", "gear.*.at": "70 mm"}
    study = gw.load("small-gearbox", changes)
    box = geometry_of(housing_table(study.case, "load"))
    assert box is not None
    assert study.housing is not None
    given = study.housing.housing
    housing = gw.Housing.from_box(
        box, 0.06, given.material, fixtures=given.fixtures, sensors=given.sensors, damping_ratio=given.damping_ratio
    )
    modes = housing.modes(below_hz=4e3, bearings=study.housing.bearings)
    result = gw.Study(replace(study.machine, housing=modes), study.settings).operating_point(sensitivity=True)
    found, expected = (
        {(row["parameter"], row["kind"]): row for row in one.document["sensitivity"]}
        for one in (result, study.operating_point(sensitivity=True))
    )
    assert found.keys() == expected.keys()
    assert {f"{face} wall" for face in FACES} <= {parameter for parameter, _ in found}
    largest = max(abs(row["gear_pairs"][0]["misalignment_rad"]) for row in expected.values())
    for key, row in expected.items():
        other = found[key]
        assert other["step_words"] == row["step_words"]
        misalignments = [one["gear_pairs"][0]["misalignment_rad"] for one in (other, row)]
        assert misalignments[0] == pytest.approx(misalignments[1], rel=1e-5, abs=1e-6 * largest)
        for one, of_case in zip(other["lines"], row["lines"], strict=True):
            assert one["level_db"] == pytest.approx(of_case["level_db"], abs=1e-3)
            assert one["first_order_db"] == pytest.approx(of_case["first_order_db"], abs=1e-3)


def _alike(found: object, expected: object) -> bool:
    """Whether two documents have the same words, and the same numbers to 1e-6 of each."""
    if isinstance(expected, dict) and isinstance(found, dict):
        return found.keys() == expected.keys() and all(_alike(found[key], expected[key]) for key in expected)
    if isinstance(expected, list) and isinstance(found, list):
        return len(found) == len(expected) and all(map(_alike, found, expected))
    return bool(found == pytest.approx(expected, rel=1e-6)) if isinstance(expected, float) else found == expected
