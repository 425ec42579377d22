"""Mesh files: what is written comes back, and what cannot be used is refused with its name."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest

from gearwhine.meshes import ElementBlock, GeometryError, Mesh, diagnose, mesh_quality, read_mesh, write_mesh
from gearwhine.meshes.elements import KINDS, SOLIDS, facet_centers, facet_nodes, facets_of, pick_facets
from gearwhine.meshes.formats.files import WRITABLE
from gearwhine.meshes.gmsh_meshing import gmsh_session
from gearwhine.meshes.shape_functions import shape_functions

POINTS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])


def _with_regions(mesh: Mesh) -> Mesh:
    """Surfaces that overlap, one with a blank and a comma in its name; two volumes that do not."""
    centers, half = facet_centers(mesh.points, mesh.boundary), mesh.n_elements // 2
    top = centers[:, 2] > 1.0 - 1e-9
    surfaces = {
        "the left, upper side": pick_facets(mesh.boundary, centers[:, 0] < 1e-9),
        "top": pick_facets(mesh.boundary, top),
        "corner": pick_facets(mesh.boundary, top & (centers[:, 0] < 0.6)),
    }
    return replace(mesh, surfaces=surfaces, volumes={"part one": np.arange(half), "two": np.arange(half, 2 * half)})


def _assert_same(back: Mesh, mesh: Mesh) -> None:
    np.testing.assert_allclose(back.points, mesh.points, rtol=1e-14, atol=1e-16)
    assert [block.kind for block in back.blocks] == [block.kind for block in mesh.blocks]
    for ours, theirs in zip(back.blocks, mesh.blocks, strict=True):
        np.testing.assert_array_equal(ours.nodes, theirs.nodes)
    assert set(back.surfaces) == set(mesh.surfaces)
    for name, facets in mesh.surfaces.items():
        for ours, theirs in zip(back.surface(name), facets, strict=True):
            assert ours.kind == theirs.kind
            assert {tuple(sorted(f)) for f in ours.nodes.tolist()} == {tuple(sorted(f)) for f in theirs.nodes.tolist()}
            assert len(ours) == len(theirs)
    assert set(back.volumes) == set(mesh.volumes)
    for name, members in mesh.volumes.items():
        np.testing.assert_array_equal(back.volumes[name], members)


@pytest.mark.parametrize("kind", SOLIDS)
@pytest.mark.parametrize("ending", WRITABLE)
def test_every_kind_comes_back_with_its_regions(
    block_of: Callable[..., Mesh], tmp_path: Path, ending: str, kind: str
) -> None:
    mesh = _with_regions(block_of(kind, cells=(2, 2, 1)))
    path = tmp_path / f"block{ending}"
    if (ending, kind) == (".med", "hexahedron27"):
        with pytest.raises(GeometryError, match=r"\.med files hold no hexahedron27 elements"):
            write_mesh(mesh, path)
        assert not list(tmp_path.iterdir())
        return
    write_mesh(mesh, path)
    _assert_same(read_mesh(path), mesh)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("ending", WRITABLE)
def test_mixed_kinds_come_back_with_their_regions(
    block_of: Callable[..., Mesh], tmp_path: Path, ending: str, order: int
) -> None:
    """Bricks beside wedges, with triangles and quadrilaterals in one surface."""
    kinds = ("wedge", "hexahedron") if order == 1 else ("wedge15", "hexahedron20")
    left, right = (block_of(kind, (0.5, 1.0, 1.0), (1, 2, 2)) for kind in kinds)
    both = np.vstack([left.points, right.points + [0.5, 0.0, 0.0]])
    points, inverse = np.unique(np.round(8 * both), axis=0, return_inverse=True)
    right_nodes = inverse[right.blocks[0].nodes + len(left.points)]
    blocks = (ElementBlock(kinds[0], inverse[left.blocks[0].nodes]), ElementBlock(kinds[1], right_nodes))
    mesh = _with_regions(Mesh(points / 8, blocks))
    assert diagnose(mesh) == ()
    facets = mesh.boundary
    mesh = replace(mesh, surfaces={**mesh.surfaces, "both": facets})
    assert len(facets) == 2
    path = tmp_path / f"block{ending}"
    if (ending, order) == (".xdmf", 2):
        with pytest.raises(GeometryError, match=r"\.xdmf files of wedge15 and hexahedron20 elements cannot be read"):
            write_mesh(mesh, path)
        return
    write_mesh(mesh, path)
    back = read_mesh(path)
    if ending == ".med":  # MED puts the kinds in an order of its own, and the elements' numbers with them
        assert back.kinds == mesh.kinds
        assert {name: facet_nodes(facets).tolist() for name, facets in back.surfaces.items()} == {
            name: facet_nodes(facets).tolist() for name, facets in mesh.surfaces.items()
        }
        for name, members in mesh.volumes.items():
            ours = np.sort(back.centers[back.volumes[name]].sum(axis=1))
            np.testing.assert_allclose(ours, np.sort(mesh.centers[members].sum(axis=1)))
    else:
        _assert_same(back, mesh)


def test_regions_that_a_format_cannot_hold_are_refused(block_of: Callable[..., Mesh], tmp_path: Path) -> None:
    mesh = _with_regions(block_of("tetra"))
    overlapping = replace(mesh, volumes={"all": np.arange(6), "some": np.arange(3)})
    with pytest.raises(GeometryError, match=r"volumes 'all' and 'some' overlap, and \.msh files know one"):
        write_mesh(overlapping, tmp_path / "a.msh")
    write_mesh(overlapping, tmp_path / "a.med")
    _assert_same(read_mesh(tmp_path / "a.med"), overlapping)
    with pytest.raises(GeometryError, match="a volume and a surface are both named 'top'"):
        write_mesh(replace(mesh, volumes={"top": np.arange(6)}), tmp_path / "a.msh")
    with pytest.raises(GeometryError, match="'größe' cannot be that of a group in MED"):
        write_mesh(replace(mesh, volumes={"größe": np.arange(6)}), tmp_path / "b.med")
    with pytest.raises(GeometryError, match="cannot stand in an input deck"):
        write_mesh(replace(mesh, volumes={'12" wide': np.arange(6)}), tmp_path / "b.inp")
    stray = replace(mesh, surfaces={"inside": facets_of(np.array([[0, 5, 6]]))})
    for ending in (".inp", ".xdmf"):
        with pytest.raises(GeometryError, match="surface 'inside' has facets that are no faces of elements"):
            write_mesh(stray, tmp_path / f"c{ending}")


def test_node_sets_become_surfaces(block_of: Callable[..., Mesh], tmp_path: Path) -> None:
    """Of a set with a face's nodes and a stray one, the face; a set that holds no whole facet is none."""
    mesh = block_of("hexahedron20", cells=(2, 2, 1))
    base = np.flatnonzero(mesh.points[:, 2] == 0.0)
    apex = np.flatnonzero((mesh.points == 1.0).all(axis=1))
    content = meshio.Mesh(
        mesh.points,
        [("hexahedron20", mesh.blocks[0].nodes)],
        point_sets={"the base": np.union1d(base, apex), "apex": apex},
    )
    meshio.write(tmp_path / "sets.inp", content)
    back = read_mesh(tmp_path / "sets.inp")
    assert set(back.surfaces) == {"the base"}
    assert np.array_equal(facet_nodes(back.surface("the base")), base)
    assert [(block.kind, len(block)) for block in back.surface("the base")] == [("quad8", 4)]


def test_facets_take_the_middle_nodes_and_the_side_of_their_elements(
    block_of: Callable[..., Mesh], tmp_path: Path
) -> None:
    """Linear triangles on quadratic tetrahedra, seen from inside, become quadratic ones seen from outside."""
    mesh = block_of("tetra10")
    corners = mesh.boundary[0].nodes[:, [2, 1, 0]]
    blocks = [("tetra10", mesh.blocks[0].nodes), ("triangle", corners)]
    groups = {"gmsh:physical": [np.zeros(6, dtype=int), np.full(12, 7)], "gmsh:geometrical": [np.ones(6), np.ones(12)]}
    meshio.write(
        tmp_path / "m.msh",
        meshio.Mesh(mesh.points, blocks, cell_data=groups, field_data={"skin of it": np.array([7, 2])}),
        file_format="gmsh22",
    )
    back = read_mesh(tmp_path / "m.msh")
    (skin,) = back.surface("skin of it")
    assert skin.kind == "triangle6"
    np.testing.assert_array_equal(skin.nodes, mesh.boundary[0].nodes)
    assert back.volumes == {}


def test_facets_of_shells_are_left_out_and_half_attached_ones_refused(
    block_of: Callable[..., Mesh], tmp_path: Path
) -> None:
    mesh = block_of("hexahedron")
    points = np.vstack([mesh.points, mesh.points[:4] + [0.0, 0.0, 9.0]])
    nodes = mesh.blocks[0].nodes
    shell, base = np.arange(8, 12)[None], mesh.boundary[0].nodes[:1]
    for quads, surfaces in ((shell, set()), (base, {"plate"}), (np.vstack([base, shell]), None)):
        arrays = {"surface:plate": [np.zeros(1, dtype=int), np.ones(len(quads), dtype=int)]}
        blocks = [("hexahedron", nodes), ("quad", quads), ("line", np.array([[0, 1]]))]
        arrays["surface:plate"].append(np.zeros(1, dtype=int))
        meshio.write(tmp_path / "m.vtu", meshio.Mesh(points, blocks, cell_data=arrays))
        if surfaces is None:
            with pytest.raises(GeometryError, match="1 of the 2 facets of surface 'plate' are no faces of solid"):
                read_mesh(tmp_path / "m.vtu")
        else:
            assert set(read_mesh(tmp_path / "m.vtu").surfaces) == surfaces


@pytest.mark.parametrize("serendipity", [0, 1])
@pytest.mark.parametrize("kind", ["hexahedron", "wedge"])
def test_bricks_and_wedges_of_gmsh_have_their_middle_nodes_in_place(
    tmp_path: Path, kind: str, serendipity: int
) -> None:
    """gmsh itself extrudes a plane mesh: its own numbering of 15, 18, 20 and 27 nodes differs from VTK's."""
    path = tmp_path / "prism.msh"
    with gmsh_session("prism") as gmsh:
        face = gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
        gmsh.model.occ.extrude([(2, face)], 0, 0, 1, numElements=[2], recombine=True)
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMin", 0.5)
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", serendipity)
        if kind == "hexahedron":
            gmsh.model.mesh.setTransfiniteSurface(face)
            gmsh.model.mesh.setRecombine(2, face)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        gmsh.write(str(path))
    if (kind, serendipity) == ("wedge", 0):
        with pytest.raises(GeometryError, match="holds wedge18 elements, which are not known here"):
            read_mesh(path)
        return
    mesh = read_mesh(path)
    assert list(mesh.kinds) == [{"wedge": "wedge15", "hexahedron": f"hexahedron{20 if serendipity else 27}"}[kind]]
    assert mesh.element_volumes.sum() == pytest.approx(1.0)
    of, nodes = mesh.blocks[0].of, mesh.blocks[0].nodes
    for place, number in zip(of.places, nodes.T, strict=True):
        # The element is straight: each node lies where the corners' own map of its reference place puts it.
        weights, _ = shape_functions(of.corners, np.array(place)[:, None])
        expected = np.einsum("a,eai->ei", weights[0], mesh.points[nodes[:, : of.n_corners]])
        np.testing.assert_allclose(mesh.points[number], expected, atol=1e-9)


def test_nastran_bricks_have_their_middle_nodes_in_place(tmp_path: Path) -> None:
    """CHEXA with twenty nodes as the format numbers them: base, uprights, lid; the property is a region."""
    corners = np.array(KINDS["hexahedron"].places)
    edges = [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 5), (2, 6), (3, 7), (4, 5), (5, 6), (6, 7), (7, 4)]
    places = [*corners, *(corners[list(edge)].mean(axis=0) for edge in edges)]
    lines = ["SOL 103", "CEND", "BEGIN BULK"]
    lines += [f"GRID,{number},,{x},{y},{z}" for number, (x, y, z) in enumerate(places, start=1)]
    lines += ["CHEXA,1,4,1,2,3,4,5,6,+A", "+A,7,8,9,10,11,12,13,14,+B", "+B,15,16,17,18,19,20", "ENDDATA"]
    (tmp_path / "brick.bdf").write_text("\n".join(lines) + "\n")
    mesh = read_mesh(tmp_path / "brick.bdf")
    (block,) = mesh.blocks
    assert block.kind == "hexahedron20"
    np.testing.assert_allclose(mesh.points[block.nodes[0]], np.array(KINDS["hexahedron20"].places))
    assert {name: members.tolist() for name, members in mesh.volumes.items()} == {"property-4": [0]}


@pytest.mark.parametrize("given", ["part.node", "part.ele"])
def test_tetgen_files_without_their_other_half_are_refused(tmp_path: Path, given: str) -> None:
    """meshio waits for ever for the first line of an empty one."""
    (tmp_path / given).write_text("1 3 0 0\n1 0 0 0\n")
    with pytest.raises(GeometryError, match=r"belong together, and part\..* is missing or empty"):
        read_mesh(tmp_path / given)
    (tmp_path / "part.node").write_text("")
    (tmp_path / "part.ele").write_text("# nothing\n")
    with pytest.raises(GeometryError, match=r"part\.node is missing or empty"):
        read_mesh(tmp_path / given)


def test_tetgen_files_are_read(tmp_path: Path) -> None:
    (tmp_path / "part.node").write_text(
        "4 3 0 0\n" + "".join(f"{n} {x} {y} {z}\n" for n, (x, y, z) in enumerate(POINTS))
    )
    (tmp_path / "part.ele").write_text("1 4 1\n0 0 1 2 3 5\n")
    mesh = read_mesh(tmp_path / "part.ele")
    assert mesh.kinds == {"tetra": 1}
    assert list(mesh.volumes) == ["region-5"]


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
    with pytest.raises(GeometryError, match=r"empty\.vtu is empty"):
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


def test_nastran_bulk_data_alone_with_blank_continuations_are_read(tmp_path: Path) -> None:
    """As for an INCLUDE: no BEGIN BULK, no ENDDATA, lines not filled up; the second line begins with a blank field."""
    places = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.5, 0, 0), (0.5, 0.5, 0), (0, 0.5, 0)]
    places += [(0, 0, 0.5), (0.5, 0, 0.5), (0, 0.5, 0.5)]
    lines = [
        f"GRID    {number:<8}{'':8}" + "".join(f"{value:<8}" for value in place)
        for number, place in enumerate(places, start=1)
    ]
    lines += ["CTETRA  1       1       1       2       3       4       5       6", "        7       8       9       10"]
    path = tmp_path / "part.bdf"
    path.write_text("$ one element\n" + "\n".join(lines) + "\n")
    mesh = read_mesh(path)
    assert mesh.kinds == {"tetra10": 1}
    assert mesh.element_volumes == pytest.approx([1 / 6])
    np.testing.assert_allclose(mesh.points[mesh.blocks[0].nodes[0]], places)


@pytest.mark.parametrize("node", [-1, 4, 10**12])
def test_nodes_that_are_not_there_are_refused_by_element_and_number(tmp_path: Path, node: int) -> None:
    """The second of three elements has a node that the file lacks, or one of a negative number."""
    cells = np.array([[0, 1, 2, 3], [0, 1, 2, node], [0, 1, 2, 3]])
    path = tmp_path / "wrong.vtu"
    meshio.write(path, meshio.Mesh(POINTS, [("tetra", cells)]))
    with pytest.raises(GeometryError, match=rf"wrong.vtu .*tetra element 1 .* has node {node}, and there are 4 nodes"):
        read_mesh(path)
    with pytest.raises(GeometryError, match=rf"the mesh .*tetra element 1 .* has node {node}, and there are 4 nodes"):
        Mesh.of_tetrahedra(POINTS, cells)
