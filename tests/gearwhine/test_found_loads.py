"""Loads of rolling bearings and misalignment of flanks that a case leaves to the machine's operating point."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.case import CaseError, parse_case
from gearwhine.from_case.machine import describe_machine, rotor_bearings, solve_machine, solve_pairs
from gearwhine.solve.rotors import solve_rotors

BALLS = {"catalogue": {"type": "deep-groove", "bore": "30 mm", "outer_diameter": "72 mm", "width": "19 mm"}}
ROLLERS = {"catalogue": {"type": "cylindrical-roller", "bore": "30 mm", "outer_diameter": "62 mm", "width": "16 mm"}}


def document(misalignment: Any = "found", law: str = "linear") -> dict[str, Any]:
    """Two shafts on a ball and a roller bearing each, an overhung helical pair, and no load in any bearing."""
    bearings = [
        {
            "name": f"{rotor} {end}",
            "rotor": rotor,
            "at": at,
            "stiffness": {"rolling": {**rolling, "clearance": "8 um", "law": law}},
            "damping": {"xx": "400 N*s/m", "yy": "400 N*s/m"},
        }
        for rotor in ("input", "output")
        for end, at, rolling in (("left", "30 mm", BALLS), ("right", "150 mm", ROLLERS))
    ]
    gears = [
        {"name": name, "rotor": rotor, "at": "190 mm", "teeth": 29, "module": "2.5 mm", "face_width": "20 mm"}
        | {"pressure_angle": "20 deg", "helix_angle": angle, "bore": "30 mm"}
        for name, rotor, angle in (("pinion", "input", "12 deg"), ("wheel", "output", "-12 deg"))
    ]
    distance = 2.5e-3 * 29.0 / math.cos(math.radians(12.0))
    return {
        "material": {"steel": {"youngs_modulus": "207 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}},
        "rotor": [
            {"name": name, "axis": [x, "0 m"], "start": "0 m", "material": "steel"}
            | {"segments": [{"length": "210 mm", "diameter": "30 mm"}]}
            for name, x in (("input", "0 m"), ("output", f"{distance!r} m"))
        ],
        "bearing": bearings,
        "gear": gears,
        "gear_pair": [{"driver": "pinion", "driven": "wheel", "misalignment": misalignment}],
        "operation": {"speed": "1500 rpm", "torque": "60 N*m"},
    }


@pytest.fixture(scope="module")
def case() -> gw.Case:
    """The case of `document`."""
    return parse_case(document())


def test_bearings_are_linearised_where_the_machine_rests(case: gw.Case) -> None:
    """The coupled machine's mean bearing forces are those of the operating point, its stiffness the tangent there."""
    from coupling.statics.static_equilibrium import static_equilibrium

    point = describe_machine(case).operating_point()
    _, _, machine = solve_machine(case)
    q = static_equilibrium(machine.system)
    for load, connector in zip(point.bearings, machine.system.linear, strict=False):
        assert connector.offset is not None
        held = list(connector.axes)
        assert connector.stiffness == pytest.approx(load.stiffness[np.ix_(held, held)], rel=1e-12)
        force = connector.offset + connector.stiffness @ (connector.directions.T @ q)
        # One phase of the mesh in place of its mean, and a gear rigid on one section in place of its face.
        assert force[:2] == pytest.approx(load.force[:2], abs=5e-3 * float(np.hypot(*load.force[:2])))


def test_a_belt_in_the_case_loads_its_bearings(case: gw.Case) -> None:
    """600 N along y on the end of the input shaft, all of it and no more carried by its bearings, down to the signs."""
    belt = {"rotor": "input", "at": "210 mm", "y": "-600 N"}
    given = document()
    pulled = describe_machine(parse_case(given | {"operation": given["operation"] | {"force": [belt]}}))
    carried = [
        sum(one.force[:3] for one in machine.operating_point().bearings if one.mounted.rotor == "input")
        for machine in (describe_machine(case), pulled)
    ]
    assert carried[1] - carried[0] == pytest.approx([0.0, -600.0, 0.0], abs=1e-3)


def test_flanks_open_as_the_operating_point_finds(case: gw.Case) -> None:
    """The contact of a pair left to the operating point has the load over its face that was found there."""
    point = describe_machine(case).operating_point()
    (pair,) = solve_pairs(case, None)
    assert pair.contact.faces is not None
    assert pair.static.line_loads is not None
    (found,) = point.pairs
    assert np.ptp(pair.contact.faces.gap) == pytest.approx(np.ptp(found.gap), rel=1e-9)
    load = pair.static.line_loads.sum(axis=1)
    weights = np.gradient(pair.static.phases)
    mean = weights @ load / weights.sum()
    # The tilt changes the profile's side of the contact a little, which the pair's own contact leaves out.
    assert mean == pytest.approx(found.line_load, abs=0.02 * float(found.line_load.max()))
    (given,) = solve_pairs(parse_case(document(misalignment="0.2 mrad")), None)
    assert given.pair.misalignment == 2e-4
    assert not given.pair.face_gap


def test_rotors_alone_stand_on_the_same_bearings(case: gw.Case) -> None:
    """The rotors' own analyses take the bearings' tangent at the operating point, and the life at its load."""
    point = describe_machine(case, grounded=True).operating_point()
    solved = solve_rotors(case)
    for rotor in solved:
        for bearing in rotor.bearings:
            assert bearing.stiffness == pytest.approx(point.bearing(bearing.name).stiffness, rel=1e-12)
        assert set(rotor.rolling) == {bearing.name for bearing in rotor.bearings}


def test_nonlinear_bearings_start_at_their_load() -> None:
    """A bearing that follows its elements in motion is left to the operating point as well."""
    case = parse_case(document(law="nonlinear"))
    point = describe_machine(case).operating_point()
    _, _, machine = solve_machine(case)
    for connector in machine.system.nonlinear:
        assert connector.law.reference == pytest.approx(point.bearing(connector.name).deflection, rel=1e-12)


def test_a_given_load_is_taken() -> None:
    """A load that the case gives stays the one that the stiffness is made for."""
    changed = document()
    changed["bearing"][0]["load"] = {"x": "300 N", "y": "-900 N", "z": "200 N"}
    stiffness = rotor_bearings(parse_case(changed))["input"][0][0].stiffness
    assert np.abs(stiffness - rotor_bearings(parse_case(document()))["input"][0][0].stiffness).max() > 1e6


def test_a_bearing_without_any_load_is_refused(tmp_path: Path) -> None:
    """Without gear pairs nothing gives a bearing its load: the case names the key."""
    bare = document()
    for key in ("gear", "gear_pair", "operation"):
        del bare[key]
    with pytest.raises(CaseError, match=r"bearing\[0\]\.load.*the force of the shaft on it"):
        parse_case(bare)


def test_a_misalignment_is_an_angle_or_found() -> None:
    """Another word is refused with what would do."""
    with pytest.raises(CaseError, match=r"misalignment.*or \"found\""):
        parse_case(document(misalignment="some"))
