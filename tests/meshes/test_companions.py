"""Files that are read with a mesh file: a mesh is another one where any of them has changed."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearwhine.meshes import BoxGeometry, Mesh, WallThickness, mesh_box, read_mesh, write_mesh
from gearwhine.meshes.formats.companions import companion_files


@pytest.fixture(scope="module")
def box() -> Mesh:
    return mesh_box(BoxGeometry((0.1, 0.08, 0.12), WallThickness.uniform(0.03)), 0.05)


def test_included_decks_are_companions_however_deep(box: Mesh, tmp_path: Path) -> None:
    """Nodes two levels down, in a folder of their own, under any ending, and a keyword over two lines."""
    write_mesh(box, tmp_path / "flat.inp")
    lines = (tmp_path / "flat.inp").read_text().splitlines()
    begin = next(number for number, line in enumerate(lines) if line.upper().startswith("*NODE"))
    end = next(number for number in range(begin + 1, len(lines)) if lines[number].startswith("*"))
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "nodes.inc").write_text("\n".join(lines[begin:end]) + "\n")
    (tmp_path / "parts" / "all.txt").write_text("*Include,\n input=nodes.inc\n")
    deck = [*lines[:begin], "** *INCLUDE, INPUT=flat.inp", "*INCLUDE, INPUT=parts/all.txt", *lines[end:]]
    (tmp_path / "deck.inp").write_text("\n".join(deck) + "\n")
    # A number in a deck has at most 20 characters.
    np.testing.assert_allclose(read_mesh(tmp_path / "deck.inp").points, box.points, rtol=1e-12, atol=1e-16)
    assert companion_files(tmp_path / "deck.inp") == (tmp_path / "parts" / "all.txt", tmp_path / "parts" / "nodes.inc")
    assert companion_files(tmp_path / "flat.inp") == ()
    # A circle and an absent file are refused by the reader, not here.
    (tmp_path / "circle.inp").write_text("*INCLUDE, INPUT=parts/../circle.inp\n*INCLUDE, INPUT=absent.inp\n*INCLUDE\n")
    assert companion_files(tmp_path / "circle.inp") == ()


def test_arrays_of_xdmf_are_its_companions(box: Mesh, tmp_path: Path) -> None:
    write_mesh(box, tmp_path / "x.xdmf")
    (tmp_path / "other.h5").write_bytes(b"")
    assert companion_files(tmp_path / "x.xdmf") == (tmp_path / "x.h5",)
    longer = replace(box, points=box.points * np.array([1.0, 1.1, 1.0]))
    before = (tmp_path / "x.xdmf").read_bytes(), (tmp_path / "x.h5").read_bytes()
    write_mesh(longer, tmp_path / "x.xdmf")
    assert (tmp_path / "x.xdmf").read_bytes() == before[0]
    assert (tmp_path / "x.h5").read_bytes() != before[1]
    (tmp_path / "broken.xdmf").write_text("<Xdmf")
    assert companion_files(tmp_path / "broken.xdmf") == ()


def test_files_of_a_set_are_companions_of_each_other(tmp_path: Path) -> None:
    for name in ("a.node", "a.ele", "a.face", "b.xml", "b_region.xml", "bc.xml"):
        (tmp_path / name).write_text("")
    assert companion_files(tmp_path / "a.node") == (tmp_path / "a.ele",)
    assert companion_files(tmp_path / "a.ele") == (tmp_path / "a.node",)
    assert companion_files(tmp_path / "b.xml") == (tmp_path / "b_region.xml",)
    assert companion_files(tmp_path / "bc.xml") == ()
