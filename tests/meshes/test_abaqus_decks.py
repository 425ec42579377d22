"""Input decks of Abaqus and CalculiX, written here by hand as the manuals have them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearwhine.housing.model.patches import patch_center
from gearwhine.meshes import GeometryError, mesh_quality, read_mesh, write_mesh
from gearwhine.meshes.elements import KINDS, facet_nodes
from gearwhine.meshes.formats.companions import companion_files

# Two unit cubes side by side along x, node numbers with gaps.
CUBES = """\
*HEADING
two cubes
** a comment, *NODE, that is none
*NODE, NSET=all nodes
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
15, 0., 0., 1.
16, 1., 0., 1.
17, 1., 1., 1.
18, 0., 1., 1.
102, 2., 0.
103, 2., 1., 0.
106, 2.D0, 0., 1.
107, 2., 1., 1.
*Element, type=C3D8R
5, 1, 2, 3, 4, 15, 16, 17,
18
*ELEMENT, TYPE=C3D8I, ELSET="right part"
9, 2, 102, 103, 3, 16, 106, 107, 17
*ELEMENT, TYPE=MASS, ELSET=weights
77, 1
*ELEMENT, TYPE=S4, ELSET=skin
80, 1, 2, 3, 4
"""


def _deck(folder: Path, text: str) -> Path:
    path = folder / "deck.inp"
    path.write_text(text, encoding="utf-8")
    return path


def test_elements_sets_and_shells(tmp_path: Path) -> None:
    mesh = read_mesh(_deck(tmp_path, CUBES))
    assert mesh.kinds == {"hexahedron": 2}
    assert mesh_quality(mesh).volume == pytest.approx(2.0)
    assert {name: members.tolist() for name, members in mesh.volumes.items()} == {"right part": [1]}
    assert set(mesh.surfaces) == {"all nodes", "skin"}
    assert np.ptp(mesh.points[facet_nodes(mesh.surface("skin"))], axis=0).tolist() == [1.0, 1.0, 0.0]
    assert len(mesh.surface("all nodes")[0]) == 10  # the whole outside of both


def test_sets_by_range_by_name_and_in_several_pieces(tmp_path: Path) -> None:
    """A set may name another in any case, go on under the same name, and count by a step."""
    more = """\
*ELSET, ELSET=odd, GENERATE
5, 9, 4
*ELSET, ELSET=again
ODD,
*ELSET, ELSET=pieces
5,
*ELSET, ELSET=pieces
9,
*NSET, NSET=base
1, 2, 3, 4, 102
*NSET, NSET=base
103
*NSET, NSET=same base, UNSORTED
base
*NSET, NSET=lid, GENERATE
15, 18
*NSET, NSET=lid, GENERATE
106, 107, 1
"""
    mesh = read_mesh(_deck(tmp_path, CUBES + more))
    for name in ("odd", "again", "pieces"):
        assert mesh.volumes[name].tolist() == [0, 1]
    for name, height in (("base", 0.0), ("same base", 0.0), ("lid", 1.0)):
        nodes = facet_nodes(mesh.surface(name))
        assert len(nodes) == 6
        assert (mesh.points[nodes, 2] == height).all()


@pytest.mark.parametrize(
    ("label", "place"),
    [("S1", (2, 0)), ("S2", (2, 1)), ("S3", (1, 0)), ("S4", (0, 2)), ("S5", (1, 1)), ("S6", (0, 1))],
)
def test_surfaces_of_brick_faces(tmp_path: Path, label: str, place: tuple[int, int]) -> None:
    """S1 is the base 1-2-3-4, S2 the lid, S3 to S6 go round the sides (Abaqus, three-dimensional solid elements)."""
    axis, value = place
    more = f"*ELSET, ELSET=_s, INTERNAL\n9\n*SURFACE, TYPE=ELEMENT, NAME=seat\n_s, {label}\n"
    mesh = read_mesh(_deck(tmp_path, CUBES + more))
    nodes = facet_nodes(mesh.surface("seat"))
    assert len(nodes) == 4
    assert (mesh.points[nodes, axis] == value).all()
    assert "_s" not in mesh.volumes


@pytest.mark.parametrize(
    ("kind", "labels"),
    [
        ("tetra", {"S1": {0, 1, 2}, "S2": {0, 1, 3}, "S3": {1, 2, 3}, "S4": {0, 2, 3}}),
        ("wedge", {"S1": {0, 1, 2}, "S2": {3, 4, 5}, "S3": {0, 1, 3, 4}, "S4": {1, 2, 4, 5}, "S5": {0, 2, 3, 5}}),
    ],
)
def test_surfaces_of_tetrahedra_and_wedges(tmp_path: Path, kind: str, labels: dict[str, set[int]]) -> None:
    places = KINDS[kind].places
    deck = "*NODE\n" + "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in enumerate(places, start=1))
    deck += f"*ELEMENT, TYPE=C3D{len(places)}\n1, " + ", ".join(str(n + 1) for n in range(len(places))) + "\n"
    deck += "".join(f"*SURFACE, NAME={label}\n1, {label}\n" for label in labels)
    mesh = read_mesh(_deck(tmp_path, deck))
    assert {name: set(facet_nodes(facets).tolist()) for name, facets in mesh.surfaces.items()} == labels


def test_quadratic_bricks_go_on_over_lines(tmp_path: Path) -> None:
    """Base, lid, then uprights; of the 27-node brick the centre, then the faces S1 to S6."""
    corners = np.array(KINDS["hexahedron"].places)
    groups = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    faces = [range(8), (0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 4, 5), (1, 2, 5, 6), (2, 3, 6, 7), (0, 3, 4, 7)]
    for number, more in ((20, []), (27, faces)):
        places = [*corners, *(corners[list(group)].mean(axis=0) for group in (*groups, *more))]
        deck = "*NODE\n" + "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in enumerate(places, start=1))
        nodes = [str(n + 1) for n in range(number)]
        deck += f"*ELEMENT, TYPE=C3D{number}\n1, {', '.join(nodes[:9])},\n{', '.join(nodes[9:])}\n"
        mesh = read_mesh(_deck(tmp_path, deck))
        (block,) = mesh.blocks
        np.testing.assert_allclose(mesh.points[block.nodes[0]], np.array(KINDS[f"hexahedron{number}"].places))


def test_included_files_are_read_and_a_circle_is_told(tmp_path: Path) -> None:
    (tmp_path / "nodes of it.inp").write_text(CUBES)
    mesh = read_mesh(_deck(tmp_path, '*INCLUDE, INPUT="nodes of it.inp"\n*ELSET, ELSET=one\n5\n'))
    assert mesh.volumes["one"].tolist() == [0]
    with pytest.raises(GeometryError, match="does it include itself"):
        read_mesh(_deck(tmp_path, "*INCLUDE, INPUT=deck.inp\n"))
    with pytest.raises(GeometryError, match=r"includes 'absent\.inp': no such file"):
        read_mesh(_deck(tmp_path, "*INCLUDE, INPUT=absent.inp\n"))


def test_one_part_and_one_instance_are_read(tmp_path: Path) -> None:
    deck = f"*PART, NAME=box\n{CUBES}*END PART\n*ASSEMBLY, NAME=a\n*INSTANCE, NAME=box-1, PART=box\n*END INSTANCE\n"
    deck += "*ELSET, ELSET=left, INSTANCE=box-1\n5\n*SURFACE, TYPE=ELEMENT, NAME=side\nbox-1.left, S6\n*END ASSEMBLY\n"
    mesh = read_mesh(_deck(tmp_path, deck))
    assert mesh.volumes["left"].tolist() == [0]
    assert (mesh.points[facet_nodes(mesh.surface("side")), 0] == 0.0).all()


def test_only_the_part_that_is_instanced_is_read(tmp_path: Path) -> None:
    """Both parts count their nodes and elements from the same numbers; the shaft is twice as long."""
    shaft = CUBES.replace("102, 2.,", "102, 3.,").replace("15, 0., 0., 1.", "15, 0., 0., 5.")
    deck = f"*PART, NAME=Shaft\n{shaft}*ELEMENT, TYPE=C3D4\n500, 1, 2, 3, 15\n*END PART\n"
    deck += f"*PART, NAME=Housing\n{CUBES}*END PART\n"
    deck += "*ASSEMBLY, NAME=a\n*INSTANCE, NAME=h, PART=HOUSING\n*END INSTANCE\n*END ASSEMBLY\n"
    for text in (deck, deck.replace("PART=HOUSING", 'PART="Housing"')):
        mesh = read_mesh(_deck(tmp_path, text))
        assert mesh.kinds == {"hexahedron": 2}
        assert mesh.element_volumes == pytest.approx([1.0, 1.0])
    with pytest.raises(GeometryError, match="line 58: instance of part 'gear', which is not there"):
        read_mesh(_deck(tmp_path, deck.replace("PART=HOUSING", "PART=gear")))
    with pytest.raises(GeometryError, match="2 parts and no instance; write one flat deck"):
        read_mesh(_deck(tmp_path, deck.partition("*ASSEMBLY")[0]))


def _assembly(*instances: str, more: str = "") -> str:
    wall = CUBES.replace('ELSET="right part"', "ELSET=right").replace("all nodes", "every")
    lid = "*NODE, NSET=every\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 0., 1., 0.\n4, 0., 0., 1.\n"
    lid += "*ELEMENT, TYPE=C3D4\n5, 1, 2, 3, 4\n"
    parts = f"*PART, NAME=Wall\n{wall}*END PART\n*PART, NAME=Lid\n{lid}*ELSET, ELSET=own\n5\n*END PART\n"
    return (
        parts + "*ASSEMBLY, NAME=a\n" + "".join(f"{one}*END INSTANCE\n" for one in instances) + more + "*END ASSEMBLY\n"
    )


def test_instances_stand_where_they_are_moved_to(tmp_path: Path) -> None:
    """The lid is shifted by (0, 1, 2), then turned by 90° about the line through (1, 0, 0) along z.

    The turn takes (x, y) to (1 - y, x - 1). A reference point of the assembly has the number of a node of the parts.
    """
    more = "*NODE\n1, 50., 50., 50.\n*NSET, NSET=reference\n1\n"
    deck = _assembly(
        "*INSTANCE, NAME=wall-1, PART=Wall\n",
        "*INSTANCE, NAME=lid-1, PART=Lid\n0., 1., 2.\n1., 0., 0., 1., 0., 7., 90.\n",
        more=more,
    )
    mesh = read_mesh(_deck(tmp_path, deck))
    assert mesh.kinds == {"hexahedron": 2, "tetra": 1}
    lid = next(block for block in mesh.blocks if block.kind == "tetra")
    places = {tuple(place) for place in np.round(mesh.points[lid.nodes[0]], 12).tolist()}
    assert places == {(0.0, -1.0, 2.0), (0.0, 0.0, 2.0), (-1.0, -1.0, 2.0), (0.0, -1.0, 3.0)}
    assert mesh.points.max() == 3.0
    assert mesh.element_volumes.sum() == pytest.approx(2.0 + 1.0 / 6.0)


def test_sets_of_instances_have_their_own_name_or_that_of_the_instance_before_it(tmp_path: Path) -> None:
    """Two lids beside one wall, which all have nodes called `every`; only the lids share elements called `own`."""
    more = "*ELSET, ELSET=picked, INSTANCE=lid-2\n5\n*SURFACE, TYPE=ELEMENT, NAME=base\nlid-2.own, S1\nlid-1.own, S2\n"
    more += "*SURFACE, TYPE=ELEMENT, NAME=end\nwall-1.right, S4\nwall-1.5, S6\n"
    deck = _assembly(
        "*INSTANCE, NAME=wall-1, PART=Wall\n",
        "*INSTANCE, NAME=lid-1, PART=Lid\n0., 0., 9.\n",
        "*INSTANCE, NAME=lid-2, PART=Lid\n0., 0., 5.\n",
        more=more,
    )
    mesh = read_mesh(_deck(tmp_path, deck))
    heights = {name: mesh.centers[members][:, 2].round(6).tolist() for name, members in mesh.volumes.items()}
    assert heights == {"right": [0.5], "lid-1.own": [9.25], "lid-2.own": [5.25], "picked": [5.25]}
    faces = mesh.points[facet_nodes(mesh.surface("base"))]
    assert sorted(set(faces[:, 2])) == [5.0, 9.0, 10.0]
    assert set(mesh.points[facet_nodes(mesh.surface("end")), 0]) == {0.0, 2.0}
    assert {"wall-1.every", "lid-1.every", "lid-2.every"} <= set(mesh.surfaces)


@pytest.mark.parametrize(
    ("system", "axes"),
    [
        ("1., 2., 3.\n", [[1, 0, 0], [0, 1, 0], [0, 0, 1]]),
        ("1., 2., 3., 1., 9., 3.\n", [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]),
        ("1., 2., 3., 1., 2., 4.\n1., 3., 4.\n", [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]),
    ],
)
def test_nodes_of_a_local_system(tmp_path: Path, system: str, axes: list[list[int]]) -> None:
    """Its origin (1, 2, 3), a point on its x and one in its x, y plane; after an empty *SYSTEM nodes are global."""
    deck = f"*SYSTEM\n{system}{CUBES}*SYSTEM\n*NODE\n900, 70., 0., 0.\n901, 71., 0., 0.\n"
    deck += "902, 70., 1., 0.\n903, 70., 0., 1.\n*ELEMENT, TYPE=C3D4\n900, 900, 901, 902, 903\n"
    plain, mesh = read_mesh(_deck(tmp_path, CUBES)), read_mesh(_deck(tmp_path, deck))
    np.testing.assert_allclose(mesh.points[:12], np.array([1, 2, 3]) + plain.points @ np.array(axes), atol=1e-12)
    assert mesh.points[12].tolist() == [70.0, 0.0, 0.0]


def test_cylindrical_nodes(tmp_path: Path) -> None:
    """A prism on a quarter of a ring, radius 1 to 2, height 1: its volume by chords is (4 - 1) / 2 sin 90°."""
    ring = [(1, 0, 0), (2, 0, 0), (2, 90, 0), (1, 90, 0), (1, 0, 1), (2, 0, 1), (2, 90, 1), (1, 90, 1)]
    nodes = "".join(f"{number}, {r}, {turn}, {z}\n" for number, (r, turn, z) in enumerate(ring, start=1))
    element = "*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"
    mesh = read_mesh(_deck(tmp_path, f"*NODE, SYSTEM=C\n{nodes}{element}"))
    assert mesh.element_volumes.sum() == pytest.approx(1.5)
    np.testing.assert_allclose(mesh.points[2], [0.0, 2.0, 0.0], atol=1e-12)
    with pytest.raises(GeometryError, match=r"line 1: \*NODE, SYSTEM=S is not known here"):
        read_mesh(_deck(tmp_path, f"*NODE, SYSTEM=S\n{nodes}{element}"))


def test_lines_of_data_in_files_of_their_own(tmp_path: Path) -> None:
    """They are companions; those of keywords that are not read may be missing."""
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "second.txt").write_text("** the second\n\n9, 2, 102, 103, 3, 16, 106, 107, 17\n")
    head, _, tail = CUBES.partition("9, 2, 102")
    deck = head.replace('ELSET="right part"', "ELSET=right, INPUT=parts/second.txt") + tail.partition("\n")[2]
    path = _deck(tmp_path, deck + "*AMPLITUDE, NAME=a, INPUT=absent.txt\n")
    mesh = read_mesh(path)
    assert mesh.element_volumes == pytest.approx([1.0, 1.0])
    assert mesh.volumes["right"].tolist() == [1]
    assert companion_files(path) == (tmp_path / "parts" / "second.txt",)
    with pytest.raises(GeometryError, match=r"includes 'absent\.txt': no such file"):
        read_mesh(_deck(tmp_path, CUBES + "*ELSET, ELSET=a, INPUT=absent.txt\n"))
    (tmp_path / "keyword.txt").write_text("*ELSET\n")
    with pytest.raises(GeometryError, match=r"keyword\.txt has a keyword, '\*ELSET'; expected lines of data alone"):
        read_mesh(_deck(tmp_path, CUBES + "*ELSET, ELSET=a, INPUT=keyword.txt\n"))


def test_a_face_that_is_listed_twice_counts_once(tmp_path: Path) -> None:
    """The lid of both cubes: its middle is that of a rectangle 2 x 1, whatever sets name its elements."""
    more = "*ELSET, ELSET=all\n9, 5\n*SURFACE, NAME=lid\nall, S2\n5, S2\n*SURFACE, NAME=skin\n9, S1\n5, S1\n5, S1\n"
    mesh = read_mesh(_deck(tmp_path, CUBES + more))
    np.testing.assert_allclose(patch_center(mesh, mesh.surface("lid")), [1.0, 0.5, 1.0], atol=1e-12)
    # The surface of the same name as the set of shells has the facet of the shell as well.
    np.testing.assert_allclose(patch_center(mesh, mesh.surface("skin")), [1.0, 0.5, 0.0], atol=1e-12)
    (facets,) = mesh.surface("lid")
    assert mesh.points[facets.nodes[0], 0].max() == 2.0  # in the order of the file


def test_names_of_sets_are_one_in_any_case(tmp_path: Path) -> None:
    more = "*ELSET, ELSET=Both\n5\n*ELSET, ELSET=BOTH\n9\n*SURFACE, NAME=top\nboth, S2\n*SURFACE, NAME=TOP\n9, S1\n"
    mesh = read_mesh(_deck(tmp_path, CUBES + more))
    assert {name: members.tolist() for name, members in mesh.volumes.items()} == {"right part": [1], "Both": [0, 1]}
    assert {name for name in mesh.surfaces if name.upper() == "TOP"} == {"top"}
    assert sum(len(block) for block in mesh.surface("top")) == 3
    twice = replace(mesh, volumes={"a": mesh.volumes["Both"], "A": mesh.volumes["right part"]})
    with pytest.raises(GeometryError, match="the names 'a' and 'A' differ in case alone"):
        write_mesh(twice, tmp_path / "twice.inp")


def test_numbers_are_as_short_as_calculix_reads_them(tmp_path: Path) -> None:
    """CalculiX refuses -1.3877787807814457e-17, which has 23 characters; it reads 20."""
    mesh = read_mesh(_deck(tmp_path, CUBES))
    points = mesh.points.copy()
    points[0] = -1.3877787807814457e-17, 1.0 / 3.0, -123456.78901234567
    write_mesh(replace(mesh, points=points), tmp_path / "long.inp")
    line = (tmp_path / "long.inp").read_text().splitlines()[1]
    fields = line.split(", ")[1:]
    assert max(map(len, fields)) <= 20
    np.testing.assert_allclose([float(field) for field in fields], points[0], rtol=1e-12)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ("*ELGEN, ELSET=a\n5, 2, 4, 1\n", r"deck\.inp, line 26: \*ELGEN is not known here; write the deck with every"),
        ("*NCOPY, CHANGE NUMBER=100\n", r"\*NCOPY is not known here"),
        ("*NGEN\n1, 3\n", r"\*NGEN is not known here"),
        ("*ElCopy\n", r"\*ELCOPY is not known here"),
        ("*System\n1., 0.\n", r"\*SYSTEM has 2 coordinates; expected those of 1, 2 or 3 points"),
        ("*System\n0., 0., 0., 1., 0., 0.\n2., 0., 0.\n", r"the points of \*SYSTEM lie on one line"),
        ("*ELEMENT, TYPE=C3D5\n6, 1, 2, 3, 4, 15\n", "elements of type C3D5, which are not known here"),
        ("*ELEMENT, TYPE=C3D4\n6, 1, 2, 3\n", "elements of type C3D4 have 4 nodes each"),
        ("*ELEMENT, TYPE=C3D4\n6, 1, 2, 3, 999\n", "names node 999, which is not in it"),
        ("*NSET, NSET=a\n999\n", "names node 999"),
        ("*ELSET, ELSET=a\nabsent\n", "names a set 'absent' that is not in it"),
        ("*SURFACE, NAME=s\n5, S7\n", "names face 'S7' of a hexahedron; expected S1 to S6"),
        ("*SURFACE, NAME=s\n5, SNEG\n", "names face 'SNEG'"),
        ("*SURFACE, NAME=s\n77, S1\n", "names element 77, which is no solid"),
        ("*PART, NAME=q\n*END PART\n*INSTANCE, NAME=a, PART=p\n", "instance of part 'p', which is not there"),
        (
            "*INSTANCE, NAME=a, PART=p\n1., 0., 0.\n1., 0., 0., 2., 0., 0.\n",
            "moved by 2 lines; expected 3 numbers, and 7",
        ),
        ("*INSTANCE, NAME=a, PART=p\n0.\n1., 0., 0., 1., 0., 0., 9.\n", "turned about an axis of no length"),
        ("*ELEMENT, TYPE=C3D4\n6, 1, two, 3, 4\n", r"cannot be read: ValueError.*'two'"),
    ],
)
def test_decks_that_cannot_be_taken_are_refused(tmp_path: Path, more: str, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        read_mesh(_deck(tmp_path, CUBES + more))


def test_a_deck_without_solids_is_refused(tmp_path: Path) -> None:
    with pytest.raises(GeometryError, match="holds no solid elements"):
        read_mesh(_deck(tmp_path, "*NODE\n1, 0., 0., 0.\n"))
