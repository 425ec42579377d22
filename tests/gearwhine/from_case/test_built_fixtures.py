"""Mounts, joints and masses of a case as the housing has them: which way they face, and where they weigh."""

import math
from typing import Any

import numpy as np
import pytest

from gearwhine.case import parse_case
from gearwhine.case.fixtures import Joint, LumpedMass, Mount
from gearwhine.from_case.mesh import cover_joints
from gearwhine.housing import Material, bolted_joint


def test_a_bolt_between_two_faces_presses_each_from_its_own_side() -> None:
    """The two faces look at each other: one along the bolt, the other against it."""
    table = {"name": "bolt", "diameter": "20 mm", "center": [0.0, 0.1, 0.2], "axis": [0.0, 3.0, 4.0]}
    joint = Joint.model_validate(table | {"stiffness": {"axial": "1e8 N/m", "shear": "2e7 N/m"}}).build()
    assert joint.first.circle is not None
    assert joint.second.circle is not None
    assert joint.first.circle == ((0.0, 0.1, 0.2), pytest.approx((0.0, 0.6, 0.8)), 0.02)
    assert joint.second.circle == ((0.0, 0.1, 0.2), pytest.approx((0.0, -0.6, -0.8)), 0.02)
    assert joint.bushing.axes[2] == pytest.approx((0.0, 0.6, 0.8))
    assert joint.bushing.stiffness == (2e7, 2e7, 1e8, 0.0, 0.0, 0.0)


def test_own_axes_of_a_mount_are_right_handed_from_x_to_y() -> None:
    """x lies as it is given, y in the plane of both, on the side of the given one, z at right angles to them."""
    given = [[1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]
    stiffness = {"x": "1 N/m", "y": "2 N/m", "z": "3 N/m", "rx": "4 N*m/rad", "ry": "5 N*m/rad", "rz": "6 N*m/rad"}
    mount = Mount.model_validate({"name": "bush", "surface": "foot", "axes": given, "stiffness": stiffness}).build()
    x, y, z = np.array(mount.bushing.axes)
    half = math.sqrt(0.5)
    np.testing.assert_allclose([x, y, z], [[half, half, 0.0], [-half, half, 0.0], [0.0, 0.0, 1.0]], atol=1e-15)
    assert mount.bushing.stiffness == (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    assert mount.patch.surface == "foot"


def test_a_fastened_body_weighs_where_it_is_and_turns_by_its_own_tensor() -> None:
    inertia = {"xx": 0.02, "yy": 0.03, "zz": 0.04, "xy": -0.001, "xz": 0.002, "yz": -0.003}
    table = {"name": "motor", "surface": "top", "mass": "6 kg", "inertia": inertia, "offset": ["10 mm", 0.02, -0.03]}
    body = LumpedMass.model_validate(table).build()
    assert body.offset == (0.01, 0.02, -0.03)
    tensor = np.array(body.inertia)
    np.testing.assert_array_equal(tensor, tensor.T)
    for key, value in inertia.items():
        row, column = ("xyz".index(axis) for axis in key)
        assert tensor[row, column] == value


@pytest.mark.parametrize(
    ("regions", "body", "cover"),
    [
        ([{"volume": "cover"}], "steel", "aluminium"),
        ([{"volume": "body"}], "aluminium", "steel"),
        ([{"box": [["1 m", "240 mm", "1 m"], ["-1 m", "1 m", "-1 m"]]}], "steel", "aluminium"),
        # A half, of cover and body, with the first bolt and without: bolts go round from the lowest x.
        ([{"box": [["-1 m", "-1 m", "-1 m"], ["0 m", "1 m", "1 m"]]}], "aluminium", "aluminium"),
        ([{"box": [["0 m", "-1 m", "-1 m"], ["1 m", "1 m", "1 m"]]}], "steel", "steel"),
    ],
)
def test_bolts_of_a_cover_clamp_the_materials_that_are_there(
    regions: list[dict[str, Any]], body: str, cover: str
) -> None:
    """A cover of 10 mm on a flange: 10 mm of its material in the grip, and 4 mm, half the bolt's diameter, below."""
    steel = {"youngs_modulus": "207 GPa", "poisson_ratio": 0.3, "density": "7800 kg/m^3"}
    aluminium = {"youngs_modulus": "70 GPa", "poisson_ratio": 0.33, "density": "2700 kg/m^3"}
    box = {
        "size": ["300 mm", "250 mm", "200 mm"],
        "wall": "10 mm",
        "mesh_size": "40 mm",
        "cover": {
            "face": "top",
            "flange": {"width": "20 mm", "thickness": "12 mm"},
            "bolts": {"diameter": "8 mm", "per_edge": [3, 3]},
        },
    }
    table = {"material": "steel", "modes": 8, "box": box}
    table["region"] = [{"name": "other", "material": "aluminium"} | region for region in regions]
    case = parse_case({"material": {"steel": steel, "aluminium": aluminium}, "housing": table})
    materials = {"steel": Material(207e9, 0.3, 7800.0), "aluminium": Material(70e9, 0.33, 2700.0)}
    expected = bolted_joint(
        0.008, 0.014, materials[body], materials["steel"], cover=(materials[cover], 0.010), outer=0.030
    ).stiffness
    built = cover_joints(case.housing, case.material)[0].bushing.stiffness
    assert built == pytest.approx((*[expected.shear] * 2, expected.axial, *[expected.tilting] * 2, expected.torsional))
