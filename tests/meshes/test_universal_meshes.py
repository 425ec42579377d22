"""Meshes in universal files: as gmsh writes them, and laid out here after the published formats of the data sets."""

from pathlib import Path

import numpy as np
import pytest
from universal_layouts import dataset, integers, points_2411, units

from gearwhine.meshes import GeometryError, read_mesh
from gearwhine.meshes.elements import facet_nodes
from gearwhine.meshes.gmsh_meshing import gmsh_session
from gearwhine.meshes.shape_functions import shape_functions

CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1), (9, 9, 9)]
NODES = {11 + number: list(map(float, place)) for number, place in enumerate(CORNERS)}


@pytest.mark.parametrize(
    ("kind", "order"), [(kind, order) for kind in ("tetra", "hexahedron", "wedge") for order in (1, 2)]
)
def test_files_of_gmsh_have_their_nodes_in_place(tmp_path: Path, kind: str, order: int) -> None:
    path = tmp_path / "cube.unv"
    with gmsh_session("cube") as gmsh:
        face = gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
        prism = kind != "tetra"
        made = gmsh.model.occ.extrude([(2, face)], 0, 0, 1, numElements=[2] if prism else [], recombine=prism)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [tag for dimension, tag in made if dimension == 3], name="body")
        gmsh.model.addPhysicalGroup(2, [made[0][1]], name="lid")
        for name, value in (("MeshSizeMin", 0.5), ("MeshSizeMax", 0.5), ("SecondOrderIncomplete", 1)):
            gmsh.option.setNumber(f"Mesh.{name}", value)
        if kind == "hexahedron":
            gmsh.model.mesh.setTransfiniteSurface(face)
            gmsh.model.mesh.setRecombine(2, face)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(order)
        gmsh.write(str(path))
    mesh = read_mesh(path)
    (block,) = mesh.blocks
    assert (block.of.corners, block.of.order) == (kind, order)
    assert mesh.element_volumes.sum() == pytest.approx(1.0)
    for place, number in zip(block.of.places, block.nodes.T, strict=True):
        weights, _ = shape_functions(block.of.corners, np.array(place)[:, None])
        straight = np.einsum("a,eai->ei", weights[0], mesh.points[block.corners])
        np.testing.assert_allclose(mesh.points[number], straight, atol=1e-9)
    assert len(mesh.volumes["body"]) == len(block)
    np.testing.assert_allclose(mesh.points[facet_nodes(mesh.surface("lid")), 2], 1.0)


def elements(*more: str) -> str:
    """A brick, a shell on its lid and one in the air, and a beam, whose nodes stand after its orientation."""
    brick = [integers(5, 115, 1, 1, 7, 8), integers(*range(11, 19))]
    shells = [integers(6, 94, 1, 1, 7, 4), integers(15, 16, 17, 18), integers(7, 91, 1, 1, 7, 3), integers(11, 12, 19)]
    beam = [integers(8, 21, 1, 1, 7, 2), integers(0, 1, 1), integers(11, 19)]
    return dataset(2412, [*beam, *brick, *shells, *more])


def group(name: str, *members: tuple[int, int], number: int = 2467) -> str:
    """Two members a line, each with its type (7 node, 8 element), number, leaf and component; older ones have two."""
    wide = number >= 2435
    numbers = [value for kind, label in members for value in ((kind, label, 0, 0) if wide else (kind, label))]
    lines = [integers(1, 0, 0, 0, 0, 0, 0, len(members)), name]
    lines += [integers(*numbers[start : start + 8]) for start in range(0, len(numbers), 8)]
    return dataset(number, lines)


@pytest.mark.parametrize("number", [2430, 2432, 2435, 2452, 2467, 2477])
def test_groups_of_elements_and_nodes_are_regions(tmp_path: Path, number: int) -> None:
    path = tmp_path / "brick.unv"
    groups = group("body", (8, 5), (8, 8), number=number) + group("skin", (8, 6), (8, 7), number=number)
    groups += group("foot", *((7, node) for node in (11, 12, 13, 14, 19)), number=number)
    path.write_text(points_2411(NODES) + elements() + groups, encoding="ascii")
    mesh = read_mesh(path, unit=0.5)
    assert mesh.element_volumes.tolist() == [0.125]
    assert {name: members.tolist() for name, members in mesh.volumes.items()} == {"body": [0]}
    assert set(mesh.surfaces) == {"skin", "foot"}
    assert set(mesh.points[facet_nodes(mesh.surface("skin")), 2]) == {0.5}
    assert set(mesh.points[facet_nodes(mesh.surface("foot")), 2]) == {0.0}


def test_the_unit_that_a_file_states_counts(tmp_path: Path) -> None:
    path = tmp_path / "brick.unv"
    path.write_text(units(5, 1000.0, 1000.0) + points_2411(NODES) + elements(), encoding="ascii")
    for unit in (1.0, 1e-3):
        assert read_mesh(path, unit=unit).element_volumes[0] == pytest.approx(1e-9)
    with pytest.raises(GeometryError, match=r"states that its unit of length is 0\.001 m, and not 0\.01 m"):
        read_mesh(path, unit=1e-2)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("nothing of the kind\n", "is no universal file, or cut short"),
        (points_2411(NODES) + elements()[:-8], "is no universal file, or cut short"),
        (points_2411(NODES), "holds no solid elements"),
        (points_2411({node: NODES[node] for node in (11, 12)}) + elements(), "names node 13, which is not in it"),
        (
            points_2411(NODES) + elements(integers(9, 101, 1, 1, 7, 5), integers(11, 12, 13, 14, 15)),
            "solid of type 101",
        ),
        (points_2411(NODES) + elements(integers(9, 115, 1, 1, 7, 8), integers(11, 12)), "has 2 nodes; expected 8"),
        (points_2411(NODES) + elements(integers(9, 115, 1)), "data set 2412 from line 24 is cut short, or not of"),
        (points_2411(NODES) + elements() + dataset(2467, [integers(1, 0, 0, 0, 0, 0, 0, 9), "a"]), "expected 9"),
        (points_2411(NODES).replace("1.0000000000000000D+00", "x", 1) + elements(), "expected three coordinates"),
    ],
)
def test_files_that_cannot_be_taken_are_named(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "brick.unv"
    path.write_text(text, encoding="ascii")
    with pytest.raises(GeometryError, match=message) as raised:
        read_mesh(path)
    assert "brick.unv" in str(raised.value)
