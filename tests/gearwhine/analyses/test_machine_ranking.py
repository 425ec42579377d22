"""Ranking of a machine's parts from Python, beside that of the same machine in a case."""

import json
from dataclasses import replace

import pytest
from case_housings import described_housing

import gearwhine as gw
from gearwhine.coupling import CouplingError
from gearwhine.solve.machine import reduce_housing

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
    case, solved = study.case, study.housing
    assert solved is not None
    assert case.housing is not None
    assert isinstance(case.housing.damping_ratio, float)
    modes = described_housing(case, solved.mesh).modes(below_hz=case.housing.frequency_limit, bearings=solved.bearings)
    machine = replace(study.machine, housing=modes)
    found = gw.Study(machine, study.settings).operating_point(sensitivity=True).document
    expected = study.operating_point(sensitivity=True).document
    assert {row["kind"] for row in expected["sensitivity"]} == {"face", "bearing stiffness", "bearing position"}
    assert found["sensor_lines"]
    assert found["loudest_lines"]
    for key in RANKED:
        assert _alike(found.get(key), expected.get(key)), key

    without_mesh = replace(study.machine, housing=reduce_housing(case, solved))
    reduced = gw.Study(without_mesh, study.settings).operating_point(sensitivity=True)
    rows = [row for row in expected["sensitivity"] if row["kind"] != "face"]
    assert [row["gear_pairs"] for row in reduced.document["sensitivity"]] == [row["gear_pairs"] for row in rows]
    assert any("walls are not ranked" in message for message in reduced.warnings)


def _alike(found: object, expected: object) -> bool:
    """Whether two documents have the same words, and the same numbers to 1e-6 of each."""
    if isinstance(expected, dict) and isinstance(found, dict):
        return found.keys() == expected.keys() and all(_alike(found[key], expected[key]) for key in expected)
    if isinstance(expected, list) and isinstance(found, list):
        return len(found) == len(expected) and all(map(_alike, found, expected))
    return bool(found == pytest.approx(expected, rel=1e-6)) if isinstance(expected, float) else found == expected
