"""Geometries of another frame than the machine's, bores along every axis, and rounded slots, which are none."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from case_housings import mesh_of

from gearwhine.case import CadFile, load_case
from gearwhine.from_case.mesh import bores_along_axes
from gearwhine.meshes import GeometryError, find_bores, mesh_cad
from gearwhine.meshes.gmsh_meshing import gmsh_session

AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}


@pytest.fixture(scope="module")
def cut_block(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """A block of 120 x 90 x 60 mm as a STEP file, less cylinders (origin, axis, radius) and boxes (origin, size)."""
    folder = tmp_path_factory.mktemp("blocks")

    def cut(name: str, cylinders: list[tuple], boxes: list[tuple] = []) -> Path:  # noqa: B006
        path = folder / f"{name}.step"
        with gmsh_session("a block") as gmsh:
            occ = gmsh.model.occ
            block = (3, occ.addBox(0.0, 0.0, 0.0, 120.0, 90.0, 60.0))
            tools = [(3, occ.addCylinder(*place, *axis, radius)) for place, axis, radius in cylinders]
            tools += [(3, occ.addBox(*place, *size)) for place, size in boxes]
            occ.cut([block], tools)
            occ.synchronize()
            gmsh.write(str(path))
        return path

    return cut


@pytest.fixture(scope="module")
def bored(cut_block: Callable[..., Path]) -> Path:
    """A shaft bore of 40 mm along x, and an oil hole of 16 mm along y."""
    return cut_block("bored", [((-1, 45, 30), (122, 0, 0), 20.0), ((60, -1, 12), (0, 92, 0), 4.0)])


def test_shafts_along_x_of_the_file_lie_along_z_of_the_machine(bored: Path) -> None:
    changes = [
        "housing.box=",
        f'housing.cad={{file="{bored}", mesh_size="15 mm", shafts_along="x"}}',
        'housing.seat=[{name="main", center=["45 mm", "30 mm", "60 mm"], diameter="40 mm"}]',
    ]
    case = load_case("steel-box", [*changes, "housing.support=", "housing.sensor="]).case
    mesh = mesh_of(case)
    np.testing.assert_allclose(mesh.bounds, [[0.0, 0.0, 0.0], [0.09, 0.06, 0.12]], atol=1e-9)
    assert "main" in mesh.surfaces
    rows = bores_along_axes(mesh)
    assert [(axis, round(1e3 * bore.diameter)) for axis, bore in rows] == [("z", 40), ("x", 8)]
    assert rows[0][1].center == pytest.approx([0.045, 0.03, 0.06], abs=1e-4)


def test_a_turn_is_the_same_as_a_change_of_axes() -> None:
    """A third of a turn about the diagonal takes x to y, y to z and z to x."""
    by_axes = CadFile(file=__file__, mesh_size="10 mm", shafts_along="y").rotation
    turned = CadFile(file=__file__, mesh_size="10 mm", turn={"axis": [1, 1, 1], "angle": "120 deg"}).rotation
    np.testing.assert_allclose(turned, by_axes, atol=1e-15)
    np.testing.assert_allclose(np.array(by_axes) @ [0.0, 1.0, 0.0], [0.0, 0.0, 1.0])
    quarter = CadFile(file=__file__, mesh_size="10 mm", turn={"axis": "x", "angle": "90 deg"}).rotation
    np.testing.assert_allclose(np.array(quarter) @ [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], atol=1e-15)
    with pytest.raises(ValueError, match="not both"):
        CadFile(file=__file__, mesh_size="10 mm", shafts_along="x", turn={"axis": "x", "angle": "90 deg"})


def test_what_is_no_rotation_is_refused(bored: Path) -> None:
    mesh = mesh_cad(bored, 0.015, order=1).mesh
    for wrong in (np.diag([1.0, 1.0, -1.0]), 2.0 * np.eye(3), np.eye(2)):
        with pytest.raises(GeometryError, match="is no rotation"):
            mesh.rotated(wrong)


def test_round_ends_of_a_slot_are_no_bores_and_half_bores_are(cut_block: Callable[..., Path]) -> None:
    """A slot of 6 mm through the block, and half a bore of 40 mm in its upper face, as of a split housing."""
    slot = [((30, 45, -1), (0, 0, 62), 3.0), ((60, 45, -1), (0, 0, 62), 3.0)]
    half = ((90, 90, -1), (0, 0, 62), 20.0)
    path = cut_block("slotted", [*slot, half], [((30, 42, -1), (30, 6, 62))])
    (found,) = find_bores(mesh_cad(path, 0.012, order=1).mesh)
    assert found.diameter == pytest.approx(0.04, rel=1e-3)
    assert found.roundness == pytest.approx(0.5, abs=0.02)
