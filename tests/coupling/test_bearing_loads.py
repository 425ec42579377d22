"""Bearing loads that a case gives, against those that a run finds."""

import numpy as np

from gearwhine.case import load_case
from gearwhine.coupling.analyses.operation_warnings import bearing_load_warnings
from gearwhine.from_case.machine import describe_machine

BALLS = (
    'bearing.0.stiffness={ rolling = { catalogue = { type = "deep-groove", bore = "35 mm", '
    'outer_diameter = "72 mm", width = "17 mm" } } }',
    'bearing.0.load={ x = "1000 N", y = "0 N", z = "300 N" }',
)


def test_a_load_more_than_a_tenth_off_is_told_with_both_numbers() -> None:
    case = load_case("spur-pair", BALLS).case
    bearings, name = describe_machine(case).bearings, case.bearing[0].name
    for force in ([1050.0, 0.0, 300.0], [1000.0, 60.0, 320.0]):
        assert bearing_load_warnings(bearings, {name: np.array(force)}) == []
    for force in ([1300.0, 0.0, 300.0], [0.0, 1000.0, 300.0], [1000.0, 0.0, -300.0]):
        (found,) = bearing_load_warnings(bearings, {name: np.array(force)})
        assert found["assumed_force_n"] == [1000.0, 0.0, 300.0]
        assert found["mean_force_n"] == force
        assert "1000 N radial and 300 N axial" in found["message"]


def test_a_stiffness_that_is_given_depends_on_no_load() -> None:
    case = load_case("spur-pair").case
    bearings = describe_machine(case).bearings
    assert bearing_load_warnings(bearings, {one.bearing.name: np.full(3, 1e4) for one in bearings}) == []
