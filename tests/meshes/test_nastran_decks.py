"""Bulk data of Nastran, written here by hand as the manuals have them, and by meshio."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from gearwhine.meshes import GeometryError, Mesh, read_mesh
from gearwhine.meshes.elements import KINDS
from gearwhine.meshes.formats.companions import companion_files

CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
BRICK = "CHEXA,1,4,1,2,3,4,5,6\n,7,8\n"
SECOND = "GRID,9,,0.,0.,2.\nGRID,10,,1.,0.,2.\nGRID,11,,1.,1.,2.\nGRID,12,,0.,1.,2.\n"
SECOND_BRICK = "CHEXA,2,5,5,6,7,8,9,10\n,11,12\n"


def _grids(system: str = "") -> str:
    return "".join(f"GRID,{number},{system},{x}.,{y}.,{z}.\n" for number, (x, y, z) in enumerate(CORNERS, start=1))


def _deck(folder: Path, text: str, name: str = "deck.bdf") -> Path:
    path = folder / name
    path.write_text(f"SOL 103\nCEND\nBEGIN BULK\n{text}ENDDATA\n", encoding="utf-8")
    return path


def _placed(mesh: Mesh) -> list[list[float]]:
    """Corners of the one brick, in its order."""
    return np.round(mesh.points[mesh.blocks[0].nodes[0]], 12).tolist()


def test_nodes_stand_in_their_coordinate_systems(tmp_path: Path) -> None:
    """A prism on a quarter of a ring, radius 1 to 2, height 1: its volume by chords is (4 - 1) / 2 sin 90°."""
    ring = [(1, 0, 0), (2, 0, 0), (2, 90, 0), (1, 90, 0), (1, 0, 1), (2, 0, 1), (2, 90, 1), (1, 90, 1)]
    grids = "".join(f"GRID,{number},3,{r}.,{turn}.,{z}.\n" for number, (r, turn, z) in enumerate(ring, start=1))
    # The axis along y from (0, 5, 0), angles counted from z, in a system that is 2 along z.
    systems = "CORD2R,7,,0.,0.,2.,0.,0.,3.\n,1.,0.,2.\nCORD2C,3,7,0.,5.,0.,0.,6.,0.\n,0.,5.,1.\n"
    mesh = read_mesh(_deck(tmp_path, systems + grids + BRICK))
    assert mesh.element_volumes.sum() == pytest.approx(1.5)
    # z turns into x about y.
    expected = [[0, 5, 3], [0, 5, 4], [2, 5, 2], [1, 5, 2], [0, 6, 3], [0, 6, 4], [2, 6, 2], [1, 6, 2]]
    assert _placed(mesh) == expected


def test_spherical_nodes_and_a_system_of_three_nodes(tmp_path: Path) -> None:
    """Nodes of a cube by radius, angle from the axis and angle about it; the system's nodes are 21 to 23."""
    centre = np.array(CORNERS) + 1.0
    radius = np.linalg.norm(centre, axis=1)
    tilt, turn = np.degrees(np.arccos(centre[:, 2] / radius)), np.degrees(np.arctan2(centre[:, 1], centre[:, 0]))
    grids = "".join(
        f"GRID*,{number},8,{r:.12f},{a:.12f}\n*,{b:.12f}\n"
        for number, (r, a, b) in enumerate(zip(radius, tilt, turn, strict=True), start=1)
    )
    # Origin at (3, 0, 0), axis along y, zero angle towards x.
    basis = "GRID,21,,3.,0.,0.\nGRID,22,,3.,4.,0.\nGRID,23,,9.,1.,0.\nCORD1R,9,1,2,3,8,21,22,23\n"
    basis = basis.replace("CORD1R,9,1,2,3", "CORD1S,9,21,22,23")
    mesh = read_mesh(_deck(tmp_path, grids + basis + BRICK))
    x, y, z = centre.T
    np.testing.assert_allclose(_placed(mesh), np.stack([3 + x, z, -y], axis=1), atol=1e-9)


def test_a_default_system_holds_where_a_node_names_none(tmp_path: Path) -> None:
    """GRDSET gives the blank field; a zero is the basic system (GRDSET, remark 1)."""
    system = "CORD2R,7,0,0.,0.,5.,0.,0.,6.\n+,1.,0.,5.\n"
    grids = _grids().replace("GRID,1,,", "GRID,1,0,")
    mesh = read_mesh(_deck(tmp_path, "GRDSET,,7\n" + system + grids + BRICK))
    assert [z for _, _, z in _placed(mesh)] == [0, 5, 5, 5, 6, 6, 6, 6]


def test_included_files_are_read_and_are_companions(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "more.inc").write_text("$ INCLUDE 'absent'\nInclude nodes.inc\n" + SECOND_BRICK)
    (tmp_path / "parts" / "nodes.inc").write_text(SECOND)
    path = _deck(tmp_path, _grids() + BRICK + "INCLUDE 'parts/\nmore.inc'\n")
    mesh = read_mesh(path)
    assert mesh.element_volumes == pytest.approx([1.0, 1.0])
    assert {name: members.tolist() for name, members in mesh.volumes.items()} == {"property-4": [0], "property-5": [1]}
    assert companion_files(path) == (tmp_path / "parts" / "more.inc", tmp_path / "parts" / "nodes.inc")


@pytest.mark.parametrize(
    "second",
    [
        "CHEXA*,2,5,5,6\n*,7,8,9,10\n*,11,12\n",
        f"{'CHEXA*':8}{2:<16}{5:<16}{5:<16}{6:<16}*A\n{'*A':8}{7:<16}{8:<16}{9:<16}{10:<16}\n{'*':8}{11:<16}{12:<16}\n",
        f"{'chexa':8}" + "".join(f"{n:<8}" for n in (2, 5, 5, 6, 7, 8, 9, 10)) + f"\n{'':8}{11:<8}{12:<8}$ comment\n",
        "CHEXA\t2\t5\t5\t6\t7\t8\t9\t10\n\t11\t12\n",
        "CHEXA,2,5,5,6,7,8,9,10,11,12\n",
        "  CHEXA, 2, 5, 5, 6, 7, 8, 9, 10, +B\n$ between\n+B, 11, 12\n",
    ],
    ids=["large free", "large", "small letters", "tabs", "one line", "blanks"],
)
def test_elements_in_every_form_of_fields(tmp_path: Path, second: str) -> None:
    mesh = read_mesh(_deck(tmp_path, _grids() + SECOND + BRICK + second))
    assert mesh.element_volumes == pytest.approx([1.0, 1.0])


def test_real_numbers_of_every_form(tmp_path: Path) -> None:
    ends = ["1.", "1.0", "10.-1", ".1+1", "1.D0", "1.0E+0", "+1."]
    grids = _grids()
    for number, text in enumerate(ends, start=2):
        x, y, z = CORNERS[number - 1]
        old = f"GRID,{number},,{x}.,{y}.,{z}.\n"
        grids = grids.replace(old, f"GRID,{number},,{text if x else ''},{text if y else ''},{text if z else '-0.'}\n")
    assert _placed(read_mesh(_deck(tmp_path, grids + BRICK))) == [list(map(float, place)) for place in CORNERS]


@pytest.mark.parametrize("form", ["fixed-small", "fixed-large"])
@pytest.mark.parametrize("kind", ["tetra", "tetra10", "wedge", "hexahedron"])
def test_decks_of_meshio_are_read(tmp_path: Path, kind: str, form: str) -> None:
    """Kinds and forms that meshio writes as the format has them, but for CTETRA_ in place of CTETRA."""
    places = np.array(KINDS[kind].places, dtype=np.float64)
    content = meshio.Mesh(places, [(kind, np.arange(len(places))[None])])
    meshio.nastran.write(tmp_path / "deck.nas", content, point_format=form, cell_format=form)
    mesh = read_mesh(tmp_path / "deck.nas")
    assert list(mesh.kinds) == [kind]
    np.testing.assert_allclose(mesh.points[mesh.blocks[0].nodes[0]], places, atol=1e-6)


def test_facets_of_shells_are_the_surface_of_their_property(tmp_path: Path) -> None:
    """With the angle of their material and their thicknesses after the nodes."""
    mesh = read_mesh(_deck(tmp_path, _grids() + BRICK + "CQUAD4,8,6,5,6,7,8,30.,0.\n,,,1.,1.,1.,1.\nCBAR,9,1,1,2,0.\n"))
    (facets,) = mesh.surface("property-6")
    assert (mesh.points[facets.nodes[0], 2] == 1.0).all()


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ("CPYRAM,2,1,5,6,7,8,9\n", "line 14: card CPYRAM is not known here; .* solids as CTETRA, CPENTA, CHEXA"),
        ("=,*(1),=\n", "line 14: card = is not known here"),
        ("CHEXA,2,1,1,2,3,4,5,6\n,7\n", "line 14: CHEXA 2 has 7 nodes; expected 8 or 20"),
        ("CHEXA,2,1,1,2,3,4,5,6\n,7,8,,9\n", "line 14: CHEXA 2 has 9 nodes; expected 8 or 20"),
        ("CTETRA,2,1,1,2,3,99\n", "line 14: CTETRA 2 names GRID 99, which is not there"),
        ("CTETRA,2,1,1,2,3,x\n", "line 14, card CTETRA: .*'x'; expected a number"),
        ("CQUAD4,2,1,1,2,3,99\n", "a shell with a GRID that is not there"),
        ("GRID,9,77,0.,0.,0.\n", "nodes in coordinate system 77, and no card of CORD1R"),
        ("GRID,8,,0.,0.,0.\n", "line 14: GRID 8 is there already, at another place"),
        ("GRID,9,5,0.,0.,0.\nCORD2R,5,,0.,0.,0.,0.,0.,1.\n,0.,0.,2.\n", "line 15: .* CORD2R 5 are on one line"),
        ("GRID,9,5,0.,0.,0.\nCORD1R,5,9,1,2\n", "line 15: coordinate system 5 is defined by itself"),
        ("GRID,9,5,0.,0.,0.\nCORD1R,5,98,1,2\n", "CORD1R 5 names GRID 98, which is not there"),
        ("INCLUDE 'absent.inc'\n", r"line 14 includes 'absent\.inc': no such file"),
        ("INCLUDE 'deck.bdf'\n", "does it include itself"),
        ("BEGIN SUPER=1\n", "line 14 begins bulk data again"),
        ("CHEXA,2,1,1,2,3,4,5,6,+A\n+B,7,8\n", "continuation '.B' of card CHEXA follows a line that ends with '.A'"),
        (f"{'GRID*':8}{9:<16}{'':16}{'0.':16}{'0.':16}\n{'+':8}{'0.':8}{'1.':8}\n", "card GRID: .*expected a number"),
    ],
)
def test_decks_that_cannot_be_taken_are_refused(tmp_path: Path, more: str, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        read_mesh(_deck(tmp_path, _grids() + BRICK + more))


@pytest.mark.parametrize(
    "text",
    [
        f"SOL 103\nCEND\nBEGIN BULK\n{{0}}{BRICK}ENDDATA\n",
        f"$ a deck of bulk data alone\n{{0}}{BRICK}",
        "init master(s)\nnastran system(442)=-1\nsol 103\ncend\nbegin bulk\n{0}" + BRICK.lower() + "enddata\n",
        "{0}INCLUDE 'brick.dat'\n",
    ],
)
def test_a_file_dat_with_cards_of_nastran_is_a_deck(tmp_path: Path, text: str) -> None:
    (tmp_path / "brick.dat").write_text(BRICK)
    path = tmp_path / "model.dat"
    path.write_text(text.replace("{0}", _grids()))
    assert read_mesh(path).element_volumes.tolist() == [1.0]
    assert companion_files(path) == ((tmp_path / "brick.dat",) if "INCLUDE" in text else ())


@pytest.mark.parametrize("text", ["$ENTER COMPONENT NAME = PART\n$COOR\n1 0. 0. 0.\n", "12.5 3.1\n1e3 4\n", ""])
def test_a_file_dat_of_another_program_is_no_deck(tmp_path: Path, text: str) -> None:
    path = tmp_path / "results.dat"
    path.write_text(text)
    with pytest.raises(GeometryError, match=r"results\.dat (is broken, or of a format|cannot be read|is empty)"):
        read_mesh(path)


def test_a_continuation_may_have_a_blank_where_the_next_line_has_a_plus_sign(tmp_path: Path) -> None:
    fields = "".join(f"{number:8d}" for number in (1, 4, 1, 2, 3, 4, 5, 6))
    deck = f"CHEXA   {fields} C 1\n+C 1    {7:8d}{8:8d}\n"
    assert read_mesh(_deck(tmp_path, _grids() + deck)).element_volumes.tolist() == [1.0]


def test_shells_of_one_property_may_lie_on_the_solids_in_part(tmp_path: Path) -> None:
    """One quadrilateral is the brick's lid, another stands above it: the region is the lid alone."""
    shells = "CQUAD4,20,6,5,6,7,8\nCQUAD4,21,6,9,10,11,12\nCQUAD4,22,7,9,10,11,12\n"
    mesh = read_mesh(_deck(tmp_path, _grids() + SECOND + BRICK + shells))
    assert list(mesh.surfaces) == ["property-6"]
    (lid,) = mesh.surface("property-6")
    np.testing.assert_array_equal(mesh.points[lid.nodes[0], 2], 1.0)
