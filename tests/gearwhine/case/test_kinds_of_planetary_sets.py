"""Simple, stepped and double planets in a case: forces of the meshes by hand, modes that stay, mean of the motion."""

import math
from typing import Any

import numpy as np
import pytest
from planetary_case import double_stage, ravigneaux, stage, stepped_stage

import gearwhine as gw

SUN_FORCE = 50.0 / (3.0 * 0.024 * math.cos(math.radians(20.0)))
"""50 N m on 24 teeth of 2 mm with three planets [N]."""
# Force of the last mesh over that of the first: a stepped planet is a lever, others hand the force on.
KINDS = {"simple": (stage, 1.0), "stepped": (stepped_stage, 36 / 18), "double": (double_stage, 1.0)}


@pytest.fixture(scope="module", params=KINDS)
def studied(request: pytest.FixtureRequest) -> tuple[Any, float]:
    made, lever = KINDS[request.param]
    return gw.build(**made()), lever


def test_mesh_forces_are_those_of_the_torques(studied: tuple[Any, float]) -> None:
    study, lever = studied
    pairs = study.operating_point().document["gear_pairs"]
    forces = {(one["driver"][0], one["driven"][0]): one["force_n"] for one in pairs}
    first, last = (next(force for ends, force in forces.items() if name in ends) for name in "sr")
    assert first == pytest.approx(SUN_FORCE, rel=1e-6)
    assert last == pytest.approx(lever * SUN_FORCE, rel=1e-6)


def test_a_set_that_turns_as_one_neither_comes_back_nor_runs_away(studied: tuple[Any, float]) -> None:
    """Centrifugal forces of planets that circle balance at any rotation of the set."""
    modes = studied[0].case.parts.machine.modes()
    assert modes.kinds[0] == "rigid"
    assert modes.eigenvalues.real.max() <= 0.0
    assert np.count_nonzero(modes.frequencies_hz < 100.0) == 1


@pytest.mark.slow
def test_the_mean_of_the_motion_is_the_static_force() -> None:
    study = gw.build(**(double_stage() | {"transient": {"revolutions": 2, "discard": 1}}))
    means = {(one["driver"], one["driven"]): one["mean_force_n"] for one in study.simulate().document["gear_pairs"]}
    for member in "sr":
        assert [force for ends, force in means.items() if member in ends] == pytest.approx([SUN_FORCE] * 3, rel=5e-3)


def test_a_set_that_runs_idle_has_no_shares_and_no_warnings_of_its_faces() -> None:
    """The large sun of a Ravigneaux gearbox turns along without a torque."""
    result = gw.build(**ravigneaux()).operating_point()
    assert [one["name"] for one in result.document["planetary"]] == ["stage"]
    told = [one["name"] for one in result.document["warnings"]]
    assert set(told) == {"idle gear pair"}


def test_a_long_pinion_meets_a_sun_at_either_end() -> None:
    """The long planet of a Ravigneaux gearbox as one gear, in place of one for each sun."""
    document = ravigneaux()
    document["gear"] = [one for one in document["gear"] if one["name"] != "back"]
    long = next(one for one in document["gear"] if one["name"] == "front")
    long |= {"at": "31.5 mm", "face_width": "48 mm"}
    document["planetary"][1]["planets"] = [f"front {number}" for number in (1, 2, 3)]
    study = gw.build(**document)
    pairs = study.operating_point().document["gear_pairs"]
    ends = {(one["driver"][0], one["driven"][0]) for one in pairs}
    assert ends == {("s", "s"), ("s", "f"), ("f", "r"), ("l", "f")}
    assert [one["force_n"] for one in pairs if one["driven"] == "r"] == pytest.approx([SUN_FORCE] * 3, rel=5e-2)
    long["at"] = "56 mm"
    with pytest.raises(gw.CaseError, match="in one plane, within half a face width, 24 mm; they are 41 mm apart"):
        gw.build(**document)
