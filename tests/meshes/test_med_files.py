"""MED files: as gmsh writes them, and laid out here as Salome and Code_Aster do, with fields, families and profiles."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import h5py
import numpy as np
import pytest

from gearwhine.meshes import GeometryError, read_mesh, write_mesh
from gearwhine.meshes.elements import facet_nodes
from gearwhine.meshes.gmsh_meshing import gmsh_session
from gearwhine.meshes.shape_functions import shape_functions


def by_gmsh(path: Path, kind: str, serendipity: int = 1, groups: bool = True) -> Path:
    """A unit cube, extruded by gmsh: its lid is the group `lid`, all of it `body`."""
    with gmsh_session("cube") as gmsh:
        face = gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
        recombine = kind != "tetra"
        made = gmsh.model.occ.extrude([(2, face)], 0, 0, 1, numElements=[2] if recombine else [], recombine=recombine)
        gmsh.model.occ.synchronize()
        if groups:
            gmsh.model.addPhysicalGroup(3, [tag for dimension, tag in made if dimension == 3], name="body")
            gmsh.model.addPhysicalGroup(2, [made[0][1]], name="lid")
        gmsh.option.setNumber("Mesh.MeshSizeMin", 0.5)
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", serendipity)
        if kind == "hexahedron":
            gmsh.model.mesh.setTransfiniteSurface(face)
            gmsh.model.mesh.setRecombine(2, face)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        gmsh.write(str(path))
    return path


@pytest.mark.parametrize(
    ("kind", "serendipity", "expected"),
    [
        ("tetra", 1, "tetra10"),
        ("hexahedron", 1, "hexahedron20"),
        ("hexahedron", 0, "hexahedron27"),
        ("wedge", 1, "wedge15"),
    ],
)
def test_files_of_gmsh_have_their_nodes_in_place(tmp_path: Path, kind: str, serendipity: int, expected: str) -> None:
    """MED numbers its elements in a mirror, and the middles of a brick's faces in an order of its own."""
    mesh = read_mesh(by_gmsh(tmp_path / "cube.med", kind, serendipity))
    (block,) = mesh.blocks
    assert block.kind == expected
    assert mesh.element_volumes.sum() == pytest.approx(1.0)
    for place, number in zip(block.of.places, block.nodes.T, strict=True):
        weights, _ = shape_functions(block.of.corners, np.array(place)[:, None])
        straight = np.einsum("a,eai->ei", weights[0], mesh.points[block.corners])
        np.testing.assert_allclose(mesh.points[number], straight, atol=1e-9)
    assert set(mesh.volumes) == {"body"}
    assert len(mesh.volumes["body"]) == len(block)
    np.testing.assert_allclose(mesh.points[facet_nodes(mesh.surface("lid")), 2], 1.0)


def test_a_file_of_gmsh_without_groups_is_read(tmp_path: Path) -> None:
    mesh = read_mesh(by_gmsh(tmp_path / "cube.med", "tetra", groups=False))
    assert mesh.element_volumes.sum() == pytest.approx(1.0)
    assert mesh.volumes == {}


def test_wedges_of_eighteen_nodes_are_refused(tmp_path: Path) -> None:
    with pytest.raises(GeometryError, match="holds wedges of 18 nodes, which are not known here"):
        read_mesh(by_gmsh(tmp_path / "cube.med", "wedge", 0))


CUBE = np.array([[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0], [0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]], dtype=float)
"""Corners of a brick in MED's order, which turns the other way than VTK's."""


def by_salome(
    path: Path,
    cells: Mapping[str, Sequence[Sequence[int]]],
    *,
    families: Mapping[str, tuple[Sequence[int], Mapping[int, Sequence[str]]]] | None = None,
    points: np.ndarray = CUBE,
    name: str = "Mesh_1",
    step: bool = True,
    mode: str = "w",
) -> Path:
    """Write MED 3 and 4 as Salome lays them out, or MED 2 without a time step.

    `families` has the family of each element of a type, or of each node (NOE), and the groups of each family.
    """
    with h5py.File(path, mode) as file:
        info = file.require_group("INFOS_GENERALES")
        info.attrs.update({"MAJ": 4, "MIN": 1, "REL": 0})
        mesh = file.create_group(f"ENS_MAA/{name}")
        mesh.attrs.update({"DIM": 3, "ESP": 3, "TYP": 0})
        here = mesh.create_group("-0000000000000000001-0000000000000000001") if step else mesh
        places = here.create_dataset("NOE/COO", data=points.T.ravel())
        places.attrs["NBR"] = len(points)
        file.create_group(f"FAS/{name}/FAMILLE_ZERO").attrs["NUM"] = 0
        for kind, elements in cells.items():
            nodes = here.create_dataset(f"MAI/{kind}/NOD", data=np.array(elements).T.ravel())
            nodes.attrs["NBR"] = len(elements)
        for kind, (numbers, groups) in (families or {}).items():
            here.create_dataset("NOE/FAM" if kind == "NOE" else f"MAI/{kind}/FAM", data=np.array(numbers))
            for number, names in groups.items():
                owner = "NOEUD" if kind == "NOE" else "ELEME"
                family = file.require_group(f"FAS/{name}/{owner}/FAM_{number}_{kind}")
                family.attrs["NUM"] = number
                if names:
                    text = np.zeros((len(names), 80), dtype=np.int8)
                    for row, group in zip(text, names, strict=True):
                        row[: len(group)] = np.frombuffer(group.encode(), dtype=np.int8)
                    shape = np.dtype((np.int8, (80,)))
                    family.create_dataset("GRO/NOM", (len(names),), dtype=shape)[...] = text
    return path


BRICK = {"HE8": [[1, 2, 3, 4, 5, 6, 7, 8]], "QU4": [[5, 6, 7, 8], [1, 2, 3, 4]], "SE2": [[1, 2]], "PO1": [[1]]}


@pytest.mark.parametrize("step", [True, False])
def test_groups_of_solids_facets_and_nodes_are_regions(tmp_path: Path, step: bool) -> None:
    """A family has two groups; another has none, and none is known of a third; lines and points are passed over."""
    families = {
        "HE8": ([-6], {-6: ["body", "all of it"]}),
        "QU4": ([-7, -8], {-7: ["lid"], -8: []}),
        "NOE": ([2, 0, 0, 2, 2, 0, 0, 2], {2: ["side"]}),
    }
    mesh = read_mesh(by_salome(tmp_path / "brick.med", BRICK, families=families, step=step))
    assert mesh.element_volumes.tolist() == [1.0]
    assert {name: members.tolist() for name, members in mesh.volumes.items()} == {"body": [0], "all of it": [0]}
    assert set(mesh.surfaces) == {"lid", "side"}
    assert set(mesh.points[facet_nodes(mesh.surface("lid")), 2]) == {1.0}
    assert set(mesh.points[facet_nodes(mesh.surface("side")), 1]) == {0.0}


def test_results_beside_the_mesh_do_not_matter(tmp_path: Path) -> None:
    """A field on elements of one type alone, with a profile, as Code_Aster writes stresses and contact."""
    path = by_salome(tmp_path / "results.rmed", BRICK)
    with h5py.File(path, "a") as file:
        field = file.create_group("CHA/reslin__SIEF_ELGA/0000000000000000000100000000000000000001/MAI.HE8/part")
        field.create_dataset("CO", data=np.zeros(0))
        file.create_dataset("PROFILS/part/PFL", data=np.array([1]))
    assert read_mesh(path).element_volumes.tolist() == [1.0]


def test_a_mesh_of_lines_beside_that_of_solids_does_not_matter(tmp_path: Path) -> None:
    path = by_salome(tmp_path / "two.med", {"SE2": [[1, 2]]}, name="Wires")
    by_salome(path, BRICK, name="Solid", mode="a")
    assert read_mesh(path).element_volumes.tolist() == [1.0]
    by_salome(path, BRICK, name="Other", mode="a")
    with pytest.raises(GeometryError, match="holds 2 meshes, Other, Solid; write one of them"):
        read_mesh(path)


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:700])


def change(key: str, value: object) -> Callable[[Path], None]:
    def apply(path: Path) -> None:
        with h5py.File(path, "a") as file:
            step = next(iter(file["ENS_MAA/Mesh_1"].values()))
            del step[key]
            if value is not None:
                step[key] = value

    return apply


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (cut, "is no HDF5 file"),
        (lambda path: path.write_bytes(b""), "is no HDF5 file"),
        (change("NOE/COO", np.zeros(23)), r"brick.med has 23 coordinates of 7 nodes"),
        (change("NOE", None), r"^mesh file \S*brick.med holds no solid elements of tetra.*; it holds: nothing"),
        (change("MAI/HE8/NOD", np.arange(1, 8)), "has 7 nodes of hexahedron elements; expected 8 of each"),
        (change("MAI/HE8/NOD", np.arange(2, 10)), "node"),
        (change("MAI/HE8/NOD", None), "has not the groups and arrays of a MED file"),
        (change("MAI", None), "it holds: nothing"),
    ],
)
def test_damaged_files_are_named(tmp_path: Path, damage: Callable[[Path], None], message: str) -> None:
    path = by_salome(tmp_path / "brick.med", BRICK)
    damage(path)
    with pytest.raises(GeometryError, match=message):
        read_mesh(path)


def test_other_files_of_hdf5_are_named(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "other.med", "w") as file:
        file["x"] = 1.0
    with pytest.raises(GeometryError, match="HDF5 without a group ENS_MAA; expected a MED file"):
        read_mesh(tmp_path / "other.med")


@pytest.mark.parametrize(
    ("kind", "nodes", "said"), [("PY5", 5, "pyramids"), ("P13", 13, "pyramids"), ("POE", 4, "polyhedra")]
)
def test_solids_of_unknown_kinds_are_named(tmp_path: Path, kind: str, nodes: int, said: str) -> None:
    cells = BRICK | {kind: [list(range(1, nodes + 1))]}
    with pytest.raises(GeometryError, match=f"holds {said}, which are not known here"):
        read_mesh(by_salome(tmp_path / "p.med", cells))


def test_what_is_written_here_comes_back(tmp_path: Path) -> None:
    mesh = read_mesh(by_gmsh(tmp_path / "cube.med", "hexahedron"))
    write_mesh(mesh, tmp_path / "again.med")
    again = read_mesh(tmp_path / "again.med")
    np.testing.assert_array_equal(again.blocks[0].nodes, mesh.blocks[0].nodes)
    assert set(again.surfaces) == set(mesh.surfaces)
