"""Modes of wheels with webs: what `check` and the coupled system say of them."""

from typing import Any

import pytest

import gearwhine as gw
from gearwhine.case import parse_case
from gearwhine.results.check import check_document, sections
from gearwhine.results.motion import gear_body_lines
from gearwhine.results.system import sections as system_sections


def document(**wheel: Any) -> dict[str, Any]:
    """Two shafts with a helical pair, whose wheel has a web."""
    thrust = {"matrix": [[1e8 * (row == column) for column in range(5)] for row in range(5)]}
    return {
        "material": {"steel": {"youngs_modulus": "207 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}},
        "rotor": [
            {"name": name, "axis": [x, "0 m"], "start": "0 m", "material": "steel", "frequency_limit": "3 kHz"}
            | {"segments": [{"length": "180 mm", "diameter": "30 mm"}], "damping_ratio": ratio}
            for name, x, ratio in (("in", "0 m", 0.005), ("out", "77.646 mm", 0.007))
        ],
        "bearing": [
            {"name": f"{rotor} {end}", "rotor": rotor, "at": at, "stiffness": thrust}
            for rotor in ("in", "out")
            for end, at in (("left", "20 mm"), ("right", "160 mm"))
        ],
        "gear": [
            {"name": name, "rotor": name, "at": "90 mm", "teeth": teeth, "module": "2 mm", "face_width": "15 mm"}
            | {"helix_angle": f"{helix} deg"}
            | body
            for name, teeth, helix, body in (
                ("in", 25, 15, {}),
                ("out", 50, -15, {"bore": "30 mm", "rim": "6 mm", "web": "4 mm"} | wheel),
            )
        ],
        "gear_pair": [{"driver": "in", "driven": "out"}],
        "operation": {"speed": "1500 rpm", "torque": "30 N*m"},
    }


def test_check_says_which_modes_of_a_wheel_are_followed() -> None:
    checked = check_document(parse_case(document()))
    (body,) = checked["gear_bodies"]
    assert (body["gear"], body["kept_below_hz"], body["damping_ratio"]) == ("out", 6000.0, 0.007)
    kept = {mode["name"]: mode["kept"] for mode in body["modes"]}
    assert list(kept)[:2] == ["umbrella", "1 nodal diameter"]
    assert all(mode["kept"] == (mode["frequency_hz"] < 6000.0) for mode in body["modes"])
    assert kept["umbrella"]
    assert not kept["3 nodal diameters"]
    assert "gear bodies" in [section.title for section in sections(checked)]
    (line,) = gear_body_lines(checked)
    assert "modes below 6 kHz are followed, with 0.7 % of critical, as out" in line


def test_check_says_that_a_stiff_wheel_is_rigid() -> None:
    case = parse_case(document(web="14 mm", rim="20 mm"))
    (line,) = gear_body_lines(check_document(case))
    assert line.endswith("none is below 6 kHz, so the body is rigid in them")
    assert "gear_bodies" not in check_document(parse_case(document(web=None, rim=None)))


def test_the_coupled_system_has_the_modes_that_it_says() -> None:
    found = gw.build(**document()).system().document
    (body,) = found["gear_bodies"]
    pairs = [mode for mode in body["modes"] if mode["kept"] and "2 nodal" in mode["name"]]
    near = [mode["frequency_hz"] for mode in found["modes"] if mode["kind"] == "body"]
    assert len(near) == 2 * len(pairs) > 0
    # The teeth hold one of the two standing waves.
    assert near[0] == pytest.approx(pairs[0]["frequency_hz"], rel=0.03)
    assert near[0] < near[1] < 1.12 * near[0]
    assert any("Gear body out on a hub at rest" in str(section) for section in system_sections(found))
