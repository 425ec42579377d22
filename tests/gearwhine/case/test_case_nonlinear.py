"""Friction of teeth, nonlinear rolling bearings and stops in a case: what is read, what is refused, what moves."""

import copy
import math
import tomllib
from importlib.resources import files
from typing import Any

import numpy as np
import pytest
from coupled_cases import about_operating_point

from gearwhine.case import CaseError, dump_case, parse_case
from gearwhine.coupling import GapLaw, RollingLaw
from gearwhine.coupling.analyses.condition_record import bearing_tones
from gearwhine.coupling.analyses.transient import solve_transient
from gearwhine.coupling.machine.driving_frequencies import element_passes, spall_strikes
from gearwhine.coupling.signals import line_names
from gearwhine.results.run import transient_document
from gearwhine.rotors.rolling_bearings import CageFault, CageSlip, RollingSpall
from gearwhine.solve.machine import plan_of

SPUR_PAIR = tomllib.loads(files("gearwhine.cases").joinpath("spur-pair.toml").read_text(encoding="utf-8"))
DEEP_GROOVE = {"count": 9, "element_diameter": "9 mm", "pitch_diameter": "46 mm", "clearance": "6 um"}
SPALL = {"on": "outer", "length": "1 mm", "depth": "40 um", "azimuth": "90 deg"}
CAGE = {"on": "cage", "length": "0.5 mm", "element": 3}
STOP = {"force": "1 kN", "depth": "10 um", "exponent": 1.5, "gap": "50 um"}


def spur_pair(*, pair: dict[str, Any] | None = None, **bearing: Any) -> Any:
    """The bundled pair with its gear pair and its first bearing changed."""
    document = copy.deepcopy(SPUR_PAIR)
    document["gear_pair"][0].update(pair or {})
    document["bearing"][0].update(copy.deepcopy(bearing))
    document["transient"] = {"revolutions": 1, "discard": 0, "tolerance": 1e-3}
    return parse_case(document)


def rolling(law: str) -> dict[str, Any]:
    return {"stiffness": {"rolling": DEEP_GROOVE | {"law": law}}, "load": {"x": "300 N", "y": "800 N"}}


def test_what_is_read_is_written() -> None:
    case = spur_pair(pair={"friction": 0.06}, **rolling("nonlinear"))
    assert case.gear_pair[0].friction == 0.06
    again = parse_case(tomllib.loads(dump_case(case)))
    assert again.gear_pair == case.gear_pair
    assert again.bearing == case.bearing
    stopped = spur_pair(stiffness={"stop": STOP})
    assert parse_case(tomllib.loads(dump_case(stopped))).bearing == stopped.bearing


def test_a_worn_cage_that_slips() -> None:
    """In the law, at its rate, named, and warned of where the element would touch the next one."""
    case = spur_pair(**rolling("nonlinear"), fault=CAGE, slip={"mean": 0.02, "scatter": 0.01, "seed": 7})
    law = case.parts.bearings[0].law
    assert isinstance(law, RollingLaw)
    assert law.spalls == (CageFault(5e-4, element=3),)
    assert law.slip == CageSlip(0.02, 0.01, 7)
    assert parse_case(tomllib.loads(dump_case(case))).bearing == case.bearing
    machine = case.parts.machine
    assert machine is not None
    speed = abs(machine.speeds["input"]) / (2.0 * math.pi)
    cage = 0.98 * 0.5 * (1.0 - 9.0 / 46.0) * speed
    tones = bearing_tones(machine)
    assert tones["input-back: cage"] == pytest.approx(cage)
    assert tones["input-back: outer raceway"] == pytest.approx(9 * cage)
    assert tones["input-back: inner raceway"] == pytest.approx(9 * (speed - cage))
    assert element_passes(machine.assembled.system)["input-back"] == pytest.approx((9 * cage,))
    (strikes,) = spall_strikes(machine.assembled.system)
    assert (strikes.name, strikes.frequency) == ("cage of input-back", pytest.approx(cage))
    assert strikes.half_width == pytest.approx(math.pi * 0.01**2 / 9 * cage)
    (line,) = line_names(machine.assembled, [3.0 * cage + 26.0 * strikes.half_width], 1e-6 * cage)
    assert line.name == "3× cage of input-back"
    (line,) = line_names(machine.assembled, [3.0 * cage + 28.0 * strikes.half_width], 1e-6 * cage)
    assert "cage" not in line.name
    with pytest.raises(CaseError, match="the gap to the next element"):
        spur_pair(**rolling("nonlinear"), fault=CAGE | {"length": "8 mm"})
    # A phase of f / f_e times that of the passing elements has a random walk of as many times their steps.
    case = spur_pair(**rolling("nonlinear"), fault=SPALL | {"on": "element"}, slip={"mean": 0.02, "scatter": 0.01})
    (strikes,) = spall_strikes(case.parts.machine.assembled.system)
    assert strikes.frequency == pytest.approx(2.0 * cage * 46.0 / 9.0 * (1.0 + 9.0 / 46.0))
    assert strikes.half_width == pytest.approx(math.pi * 0.01**2 * strikes.frequency**2 / (9 * cage))


def test_laws_of_bearings() -> None:
    assert spur_pair().parts.bearings[0].law is None
    assert spur_pair(**rolling("linear")).parts.bearings[0].law is None
    law = spur_pair(**rolling("nonlinear")).parts.bearings[0].law
    assert isinstance(law, RollingLaw)
    np.testing.assert_allclose(law.state.load[:2], [300.0, 800.0])
    assert spur_pair(stiffness={"stop": STOP}).parts.bearings[0].law == GapLaw(1000.0, 1e-5, 1.5, 5e-5)
    # Linear analyses find nothing where the shaft does not press on its stop.
    idle = spur_pair(stiffness={"stop": STOP})
    assert not idle.parts.bearings_on("input")[0].stiffness.any()
    pressed = spur_pair(stiffness={"stop": STOP}, load={"x": "1 kN"})
    np.testing.assert_allclose(
        pressed.parts.bearings_on("input")[0].stiffness, np.diag([1.5 * 1000.0 / 1e-5, 1000.0 / 6e-5]), atol=1e-3
    )


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"pair": {"friction": 0.51}}, "gear_pair[0].friction"),
        ({"pair": {"friction": -0.01}}, "gear_pair[0].friction"),
        ({"pair": {"friction": 0.1, "stiffness": {"model": "constant", "value": "1e8 N/m"}}}, "gear_pair[0].friction"),
        (rolling("quadratic"), "bearing[0].stiffness.rolling.law"),
        ({"stiffness": {"stop": STOP | {"depth": "0 um"}}}, "bearing[0].stiffness.stop.depth"),
        ({"stiffness": {"stop": STOP | {"exponent": 0.5}}}, "bearing[0].stiffness.stop.exponent"),
        ({"stiffness": {"stop": STOP | {"gap": "-1 um"}}}, "bearing[0].stiffness.stop.gap"),
        (rolling("linear") | {"fault": SPALL}, "bearing[0].fault"),
        ({"fault": SPALL}, "bearing[0].fault"),
        (rolling("nonlinear") | {"fault": SPALL | {"on": "ring"}}, "bearing[0].fault[0].on"),
        (rolling("nonlinear") | {"fault": SPALL | {"on": "cage"}}, "bearing[0].fault[0].depth"),
        (rolling("nonlinear") | {"fault": {"on": "outer", "length": "1 mm"}}, "bearing[0].fault[0].depth"),
        (rolling("nonlinear") | {"fault": CAGE | {"azimuth": "3 deg"}}, "bearing[0].fault[0].azimuth"),
        (rolling("nonlinear") | {"slip": {"mean": 0.6}}, "bearing[0].slip.mean"),
        (rolling("nonlinear") | {"slip": {"scatter": -0.01}}, "bearing[0].slip.scatter"),
        (rolling("linear") | {"slip": {"mean": 0.01}}, "bearing[0].slip"),
        (rolling("nonlinear") | {"fault": SPALL | {"element": 2}}, "bearing[0].fault[0].element"),
        (rolling("nonlinear") | {"fault": SPALL | {"depth": "0 mm"}}, "bearing[0].fault[0].depth"),
    ],
)
def test_what_cannot_be_is_refused_by_its_key(changes: dict[str, Any], key: str) -> None:
    with pytest.raises(CaseError) as caught:
        spur_pair(**changes)
    assert key in str(caught.value)


def test_spalls_are_those_of_the_law_under_its_load() -> None:
    """One table or a list, in SI; written as they were read."""
    case = spur_pair(**rolling("nonlinear"), fault=SPALL)
    law = case.parts.bearings[0].law
    assert isinstance(law, RollingLaw)
    np.testing.assert_allclose(law.state.load[:2], [300.0, 800.0])
    assert law.spalls == (RollingSpall("outer", 1e-3, 40e-6, 0.5 * np.pi),)
    assert case.parts.bearings[0].spalls == law.spalls
    assert parse_case(tomllib.loads(dump_case(case))).bearing == case.bearing
    of_ball = {"on": "element", "length": "2 mm", "depth": "0.1 mm", "element": 4}
    several = spur_pair(**rolling("nonlinear"), fault=[SPALL, of_ball]).parts.bearings[0].spalls
    assert several[1] == RollingSpall("element", 2e-3, 1e-4, element=4)


@pytest.mark.parametrize(
    ("fault", "key", "said"),
    [
        ([SPALL, SPALL | {"row": 1}], "bearing[0].fault[1]", "row of a spall"),
        (SPALL | {"on": "element", "element": 9}, "bearing[0].fault[0]", "one of 9"),
        (SPALL | {"length": "50 mm"}, "bearing[0].fault[0]", "a quarter of the circumference"),
        (SPALL | {"width": "1 mm"}, "bearing[0].fault[0]", "none under balls"),
    ],
)
def test_a_spall_that_the_bearing_cannot_have_is_refused(fault: Any, key: str, said: str) -> None:
    with pytest.raises(CaseError) as caught:
        spur_pair(**rolling("nonlinear"), fault=fault)
    (problem,) = caught.value.problems
    assert problem.key == key
    assert said in problem.expected


def test_all_of_it_moves_together() -> None:
    """Energies add up, the load's share of the first bearing comes out, and friction costs about half a percent."""
    case = spur_pair(pair={"friction": 0.06, "backlash": "60 um"}, **rolling("nonlinear"))
    standing = about_operating_point(case)
    machine = standing.coupled
    solved = solve_transient(machine, plan_of(case))
    document = transient_document(solved)
    assert document["energy_error"] < 5e-3
    assert case.operation is not None
    turned = 2.0 * np.pi * abs(case.operation.torque)
    assert 0.002 < document["energy_j"]["friction"] / turned < 0.02
    force = solved.histories.bearing_force["input-back"].mean(axis=0)
    other = solved.histories.bearing_force["input-front"].mean(axis=0)
    # Gear and bearings stand in a row, the gear in the middle.
    np.testing.assert_allclose(force, other, rtol=0.05, atol=0.05 * np.linalg.norm(other))
