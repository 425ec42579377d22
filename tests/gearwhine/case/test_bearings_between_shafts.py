"""A bearing of a case between two shafts on one axis: `seat` is the name of the other rotor."""

from typing import Any

import pytest

import gearwhine as gw
from gearwhine.case import CaseError, parse_case
from gearwhine.cli import run_command


def tables(**pilot: Any) -> dict[str, Any]:
    """An inner shaft on a ground bearing and in an outer shaft, which stands on two bearings; 1 kN on the inner one."""
    stiff = {"xx": "1e9 N/m", "yy": "1e9 N/m"}
    segment = {"length": "200 mm", "diameter": "60 mm"}
    return {
        "material": {"steel": {"youngs_modulus": "206 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}},
        "rotor": [
            {"name": "inner", "material": "steel", "segments": [segment]},
            {
                "name": "outer",
                "material": "steel",
                "start": "150 mm",
                "segments": [{**segment, "length": "300 mm", "diameter": "100 mm", "bore": "70 mm"}],
            },
        ],
        "bearing": [
            {"name": "ground", "rotor": "inner", "at": "0 mm", "stiffness": stiff},
            {"name": "pilot", "rotor": "inner", "at": "200 mm", "seat": "outer", "stiffness": stiff, **pilot},
            {"name": "left", "rotor": "outer", "at": "0 mm", "stiffness": stiff},
            {"name": "right", "rotor": "outer", "at": "300 mm", "stiffness": stiff},
        ],
        "operation": {"speed": "100 rpm", "force": [{"rotor": "inner", "at": "50 mm", "y": "-1000 N"}]},
    }


def test_its_force_passes_from_one_shaft_to_the_other() -> None:
    """Levers: 1/4 of the force at the pilot, of which 5/6 and 1/6 at the bearings of the outer shaft."""
    point = gw.build(**tables()).operating_point().document
    forces = {bearing["name"]: bearing["force_n"][1] for bearing in point["bearings"]}
    assert forces == pytest.approx(
        {"ground": -750.0, "pilot": -250.0, "left": -250.0 * 5 / 6, "right": -250.0 / 6}, rel=1e-6
    )


def test_check_counts_it_apart(tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    from gearwhine.case import dump_case

    (tmp_path / "case.toml").write_text(dump_case(parse_case(tables())))
    assert run_command(["check", str(tmp_path / "case.toml")]) == 0
    assert "3 on the ground, 1 between shafts" in capsys.readouterr().out


def test_bearings_of_planets_are_not_counted_with_them() -> None:
    from planetary_case import stage

    from gearwhine.results.check import check_document, summary

    (line,) = [one.note for one in summary(check_document(parse_case(stage()))) if one.title == "bearings"]
    assert "on pins of planets" in line
    assert "between" not in line
    assert "seats" not in line


def test_the_name_of_no_rotor_and_no_seat_is_refused() -> None:
    with pytest.raises(CaseError, match="expected the name of a seat"):
        parse_case(tables(seat="outr"))


def test_a_shaft_on_another_axis_and_the_shaft_itself_are_refused() -> None:
    aside = tables()
    aside["rotor"][1]["axis"] = ["5 mm", "0 mm"]
    for document in (aside, tables(seat="inner")):
        with pytest.raises(ValueError, match='another shaft on the axis of "inner"'):
            gw.build(**document).operating_point()
