"""Mesh files: what is written comes back, and what cannot be used is refused with its name."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from meshes import GeometryError, Mesh, mesh_quality, read_mesh, write_mesh
from meshes.files import WRITABLE
from meshes.gmsh_session import gmsh_session

POINTS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("ending", WRITABLE)
def test_nodes_and_elements_come_back(straight: Mesh, curved: Mesh, tmp_path: Path, ending: str, order: int) -> None:
    mesh = straight if order == 1 else curved
    write_mesh(mesh, tmp_path / f"housing{ending}")
    back = read_mesh(tmp_path / f"housing{ending}")
    np.testing.assert_allclose(back.points, mesh.points, rtol=1e-14, atol=1e-16)
    assert np.array_equal(back.blocks[0].nodes, mesh.blocks[0].nodes)


@pytest.mark.parametrize("ending", [".msh", ".inp"])
def test_named_surfaces_come_back(curved: Mesh, tmp_path: Path, ending: str) -> None:
    write_mesh(curved, tmp_path / f"housing{ending}")
    back = read_mesh(tmp_path / f"housing{ending}")
    assert set(back.surfaces) == set(curved.surfaces)
    for name, facets in curved.surfaces.items():
        assert np.array_equal(back.surface(name)[0].nodes, facets[0].nodes), name


def test_region_numbers_are_written_for_paraview(curved: Mesh, tmp_path: Path) -> None:
    write_mesh(curved, tmp_path / "housing.vtu")
    content = meshio.read(tmp_path / "housing.vtu")
    regions = np.concatenate(content.cell_data["region"])
    assert np.count_nonzero(regions == 0) == len(curved.blocks[0].nodes)
    for number, name in enumerate(sorted(curved.surfaces), start=1):
        assert np.count_nonzero(regions == number) == len(curved.surface(name)[0])


def test_unit_scales_the_nodes(straight: Mesh, tmp_path: Path) -> None:
    write_mesh(straight, tmp_path / "housing.msh")
    back = read_mesh(tmp_path / "housing.msh", unit=1e-3)
    np.testing.assert_allclose(back.points, straight.points * 1e-3, rtol=1e-14, atol=1e-18)
    assert mesh_quality(back).volume == pytest.approx(1e-9 * mesh_quality(straight).volume)
    for unit in (0.0, -1.0, float("nan")):
        with pytest.raises(GeometryError, match="unit of length"):
            read_mesh(tmp_path / "housing.msh", unit=unit)


def test_a_file_replaces_its_forerunner_and_leaves_nothing_beside(straight: Mesh, tmp_path: Path) -> None:
    path = tmp_path / "new" / "housing.vtu"
    write_mesh(straight, path)
    first = path.read_bytes()
    write_mesh(straight, path)
    assert path.read_bytes() == first
    assert [entry.name for entry in path.parent.iterdir()] == ["housing.vtu"]
    write_mesh(straight, path.with_suffix(".xdmf"))
    assert sorted(entry.name for entry in path.parent.iterdir()) == ["housing.h5", "housing.vtu", "housing.xdmf"]
    ordinary = path.with_name("ordinary")
    ordinary.touch()
    assert path.stat().st_mode == ordinary.stat().st_mode


@pytest.mark.parametrize("ending", [".stl", ".ply", ".off", ".xyz", ""])
def test_formats_that_would_lose_elements_are_refused(straight: Mesh, tmp_path: Path, ending: str) -> None:
    with pytest.raises(GeometryError, match=r"known endings: \.inp"):
        write_mesh(straight, tmp_path / f"housing{ending}")
    assert not list(tmp_path.iterdir())


def test_missing_broken_and_unknown_files_are_named(tmp_path: Path) -> None:
    with pytest.raises(GeometryError, match=r"absent\.msh: no such file"):
        read_mesh(tmp_path / "absent.msh")
    (tmp_path / "broken.msh").write_text("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\nmany\n")
    with pytest.raises(GeometryError, match=r"broken\.msh cannot be read"):
        read_mesh(tmp_path / "broken.msh")
    (tmp_path / "notes.docx").write_text("a letter")
    with pytest.raises(GeometryError, match=r"notes\.docx"):
        read_mesh(tmp_path / "notes.docx")
    (tmp_path / "empty.vtu").touch()
    with pytest.raises(GeometryError, match=r"empty\.vtu is broken, or of a format"):
        read_mesh(tmp_path / "empty.vtu")


def test_a_file_without_solids_is_refused_with_what_it_holds(tmp_path: Path) -> None:
    meshio.write(tmp_path / "skin.vtu", meshio.Mesh(POINTS, [("triangle", np.array([[0, 1, 2]]))]))
    with pytest.raises(GeometryError, match=r"holds no solid elements of tetra, .*; it holds: triangle"):
        read_mesh(tmp_path / "skin.vtu")


def test_pyramids_are_not_dropped_in_silence(tmp_path: Path) -> None:
    points = np.vstack([POINTS, POINTS + [0.0, 0.0, 2.0]])
    blocks = [("tetra", np.array([[0, 1, 2, 3]])), ("pyramid", np.array([[0, 1, 2, 4, 5]]))]
    meshio.write(tmp_path / "mixed.vtu", meshio.Mesh(points, blocks))
    with pytest.raises(GeometryError, match="holds pyramid elements, which are not known here"):
        read_mesh(tmp_path / "mixed.vtu")


def test_left_handed_elements_are_turned(curved: Mesh, tmp_path: Path) -> None:
    # Seen in a mirror every element is left-handed, and so are its middle nodes' edges.
    mirrored = meshio.Mesh(curved.points * [-1.0, 1.0, 1.0], [("tetra10", curved.blocks[0].nodes)])
    meshio.write(tmp_path / "mirrored.vtu", mirrored)
    back = read_mesh(tmp_path / "mirrored.vtu")
    assert mesh_quality(back).volume == pytest.approx(mesh_quality(curved).volume, rel=1e-12)
    corners, middles = back.points[back.blocks[0].nodes[:, :4]], back.points[back.blocks[0].nodes[:, 4:]]
    edges = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]]
    offset = np.linalg.norm(corners[:, edges].mean(axis=2) - middles, axis=2)
    # A node moved to another edge would be off by about half an edge; a node on a bore is off by its sagitta.
    lengths = np.linalg.norm(np.diff(corners[:, edges], axis=2)[:, :, 0], axis=2)
    assert (offset < 0.35 * lengths).all()
    assert np.count_nonzero(offset > 1e-6) < 0.1 * offset.size


def test_nodes_outside_the_solid_are_left_out(tmp_path: Path) -> None:
    points = np.vstack([[9.0, 9.0, 9.0], POINTS])
    meshio.write(tmp_path / "stray.vtu", meshio.Mesh(points, [("tetra", np.array([[1, 2, 3, 4]]))]))
    np.testing.assert_array_equal(read_mesh(tmp_path / "stray.vtu").points, POINTS)


@pytest.mark.parametrize("version", [2.2, 4.1])
def test_physical_groups_of_gmsh_are_read_once(tmp_path: Path, version: float) -> None:
    """gmsh counts the triangles itself; a face in two groups belongs to both."""
    path = tmp_path / "cube.msh"
    with gmsh_session("cube") as gmsh:
        solid = gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
        gmsh.model.occ.synchronize()
        faces = [tag for _, tag in gmsh.model.getEntities(2)]
        gmsh.model.addPhysicalGroup(3, [solid], name="solid")
        gmsh.model.addPhysicalGroup(2, faces[:1], name="one")
        gmsh.model.addPhysicalGroup(2, faces[:3], name="three")
        for option, value in (("MeshSizeMin", 0.5), ("MeshSizeMax", 0.5), ("MshFileVersion", version)):
            gmsh.option.setNumber(f"Mesh.{option}", value)
        gmsh.model.mesh.generate(3)
        gmsh.write(str(path))
        counts = [len(gmsh.model.mesh.getElementsByType(2, face)[0]) for face in faces[:3]]
        elements = len(gmsh.model.mesh.getElementsByType(4)[0])
    mesh = read_mesh(path)
    assert {name: len(facets[0]) for name, facets in mesh.surfaces.items()} == {"one": counts[0], "three": sum(counts)}
    np.testing.assert_array_equal(np.sort(mesh.volumes["solid"]), np.arange(elements))
