"""Mean forces that torques alone do not fix, in a loop of pairs as of a power split: `check` says what they assume."""

from dataclasses import replace
from typing import Any

import pytest

import gearwhine as gw
from gearwhine.coupling.description.gear_train import GearedShafts, gear_train
from gearwhine.coupling.statics.mean_mesh import mean_meshes
from gearwhine.results.check import sections

STEEL = {"youngs_modulus": "207 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}


def test_pairs_in_a_loop_share_the_torque() -> None:
    """Two layshafts between input and output, and a pair behind them that carries all."""
    pairs = [("in", "one"), ("in", "two"), ("one", "out"), ("two", "out"), ("out", "last")]
    train = gear_train([GearedShafts(driver, driven, (20, 20)) for driver, driven in pairs])
    assert train.shares_torque == (True, True, True, True, False)
    assert gear_train([GearedShafts("in", "out", (20, 40))] * 2).shares_torque == (True, True)


@pytest.fixture(scope="module")
def split() -> gw.CaseStudy:
    """Two equal pairs between two shafts; the second is near the end where the torque leaves."""
    gears: list[dict[str, Any]] = [
        {"name": f"{rotor} {number}", "rotor": rotor, "at": at, "teeth": teeth, "module": "2 mm", "face_width": "15 mm"}
        for rotor, teeth in (("in", 25), ("out", 50))
        for number, at in ((1, "40 mm"), (2, "160 mm"))
    ]
    bearings = [
        {"name": f"{rotor} {end}", "rotor": rotor, "at": at, "stiffness": {"xx": "3e8 N/m", "yy": "3e8 N/m"}}
        for rotor in ("in", "out")
        for end, at in (("left", "10 mm"), ("right", "190 mm"))
    ]
    return gw.build(
        material={"steel": STEEL},
        rotor=[
            {"name": name, "axis": [x, "0 m"], "start": "0 m", "material": "steel"}
            | {"segments": [{"length": "200 mm", "diameter": "24 mm"}]}
            for name, x in (("in", "0 m"), ("out", "75 mm"))
        ],
        bearing=bearings,
        gear=gears,
        gear_pair=[{"driver": f"in {number}", "driven": f"out {number}", "misalignment": "0 rad"} for number in (1, 2)],
        operation={
            "speed": "1500 rpm",
            "torque": "60 N*m",
            "at": "0 mm",
            "output": [{"rotor": "out", "torque": "120 N*m", "at": "200 mm"}],
        },
    )


def test_check_says_what_shares_of_a_power_split_assume(split: gw.CaseStudy) -> None:
    """Equal shares are those of equal meshes; shafts that twist make them uneven, which `load` finds."""
    document = split.check().document
    forces = [pair["mean_force_n"] for pair in document["gear_pairs"]]
    assert forces[0] == pytest.approx(forces[1])
    assert [pair["mean_force_from"] for pair in document["gear_pairs"]] == ["equal meshes"] * 2
    found = [pair["force_n"] for pair in split.operating_point().document["gear_pairs"]]
    assert sum(found) == pytest.approx(sum(forces), rel=1e-6)
    assert abs(found[0] - found[1]) > 0.03 * sum(found)
    # Gear pairs in a machine have the law of their own share, and so have its linear analyses, in which the tangent of
    # the tilted face stands for the face.
    pairs = split.gears(without=("harris-map", "relief")).document["pairs"]
    assert [pair["mean_force_from"] for pair in pairs] == ["operating point"] * 2
    assert [pair["mean_force_n"] for pair in pairs] == pytest.approx(found, rel=1e-9)
    tilted = replace(split.machine, gear_pairs=[replace(one, misalignment=None) for one in split.machine.gear_pairs])
    assert [mean.force for mean in mean_meshes(tilted.assembled.system) if mean] == pytest.approx(found, rel=3e-3)
    lines = [text for section in sections(document) for text in (section.note or "", *section.sentences)]
    told = "if the meshes of its loop of pairs are equally stiff; `gearwhine load` finds the shares"
    assert sum(told in line for line in lines) == 2


def test_a_single_path_fixes_its_forces() -> None:
    (pair,) = gw.load("spur-pair").check().document["gear_pairs"]
    assert pair["mean_force_from"] == "torques"
