"""CAD files: solids, units and names against closed forms, and what is said of files that are no good.

The files are written here by gmsh's own kernel, from shapes whose volumes are known.
"""

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest

from gearwhine.meshes import GeometryError, cylinder_facets, find_bores, mesh_cad, plane_facets
from gearwhine.meshes.cad.reading import _errors_of, _reading_limit
from gearwhine.meshes.elements import facet_centers
from gearwhine.meshes.errors import MeshSizeError
from gearwhine.meshes.gmsh_meshing import gmsh_session

SIZE, WALL, BORE = np.array([200.0, 150.0, 120.0]), 10.0, 40.0  # mm
# The box without its cavity and without two discs of the walls.
VOLUME = float(SIZE.prod() - (SIZE - 2 * WALL).prod() - 2 * WALL * np.pi * BORE**2 / 4)
Draw = Callable[[Any], object]


def _case(gmsh: Any) -> None:
    """A closed box, its middle at the origin in x and z, with a bore of 40 mm along z through both end walls."""
    occ, (x, y, z) = gmsh.model.occ, SIZE
    outside = occ.addBox(-x / 2, 0, -z / 2, x, y, z)
    inside = occ.addBox(-x / 2 + WALL, WALL, -z / 2 + WALL, x - 2 * WALL, y - 2 * WALL, z - 2 * WALL)
    walls, _ = occ.cut([(3, outside)], [(3, inside)])
    occ.cut(walls, [(3, occ.addCylinder(-40, 75, -z, 0, 0, 2 * z, BORE / 2))])


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, Draw], Path]:
    """``drawn(name, draw)``: the file of a shape drawn in millimetres."""
    folder = tmp_path_factory.mktemp("cad")

    def make(name: str, draw: Draw) -> Path:
        if not (folder / name).exists():
            with gmsh_session(name) as gmsh:
                draw(gmsh)
                gmsh.model.occ.synchronize()
                gmsh.write(str(folder / name))
        return folder / name

    return make


@pytest.mark.parametrize("ending", ["step", "iges", "brep"])
def test_every_kind_of_file_is_the_same_solid(drawn: Any, ending: str) -> None:
    """BREP states no unit and IGES holds surfaces, which are sewn: neither changes volume, size or bores."""
    found = mesh_cad(drawn(f"case.{ending}", _case), 0.03)
    assert found.unit == pytest.approx(1e-3)
    # Curved elements of order 2 miss the bores' circle by far less than a straight polygon would.
    assert found.mesh.element_volumes.sum() == pytest.approx(1e-9 * VOLUME, rel=2e-4)
    np.testing.assert_allclose(found.mesh.bounds, 1e-3 * np.array([[-100, 0, -60], [100, 150, 60]]), atol=1e-8)
    bores = find_bores(found.mesh)
    assert [bore.diameter for bore in bores] == pytest.approx([0.04, 0.04], rel=1e-6)
    assert sorted(bore.center[2] for bore in bores) == pytest.approx([-0.055, 0.055])


def _recess(gmsh: Any) -> None:
    """A block of 20 mm in the recess of a U, free of it."""
    occ = gmsh.model.occ
    occ.cut([(3, occ.addBox(0, 0, 0, 100, 60, 40))], [(3, occ.addBox(20, 20, -1, 60, 60, 42))])
    occ.addBox(40, 30, 10, 20, 20, 20)


def _rounded(gmsh: Any) -> None:
    """A box with a cavity whose edges are rounded by 60 mm, and bores of 60 and 52 mm through both end walls."""
    occ = gmsh.model.occ
    cavity = occ.addBox(10, 10, 10, 280, 180, 180)
    occ.synchronize()
    faces = gmsh.model.getBoundary([(3, cavity)], oriented=False)
    edges = {edge for _, edge in gmsh.model.getBoundary(faces, combined=False, oriented=False)}
    rounded = occ.fillet([cavity], sorted(edges), [60.0])
    holes = [(3, occ.addCylinder(x, 100, -10, 0, 0, 300, radius)) for x, radius in ((100, 30), (200, 26))]
    occ.cut([(3, occ.addBox(0, 0, 0, 300, 200, 200))], [*rounded, *holes])


def test_few_facets_of_coarse_fillets_are_no_bores(drawn: Any) -> None:
    mesh = mesh_cad(drawn("rounded.step", _rounded), 0.04, order=1).mesh
    assert [bore.diameter for bore in find_bores(mesh)] == pytest.approx([0.06, 0.06, 0.052, 0.052])
    assert find_bores(mesh, axis=(1.0, 0.0, 0.0)) == find_bores(mesh, axis=(0.0, 1.0, 0.0)) == ()


def _void_in_a_void(gmsh: Any) -> None:
    """A hollow box, in it a loose block with a void of its own."""
    occ = gmsh.model.occ
    occ.cut([(3, occ.addBox(0, 0, 0, 100, 60, 40))], [(3, occ.addBox(10, 10, 10, 80, 40, 20))])
    occ.cut([(3, occ.addBox(40, 20, 12, 20, 20, 16))], [(3, occ.addBox(45, 25, 16, 10, 10, 8))])


@pytest.mark.parametrize(
    ("name", "draw", "volume"),
    [
        ("recess", _recess, 100 * 60 * 40 - 60 * 40 * 40 + 20**3),
        ("nested", _void_in_a_void, 100 * 60 * 40 - 80 * 40 * 20 + 20 * 20 * 16 - 10 * 10 * 8),
    ],
)
@pytest.mark.parametrize("ending", ["step", "iges"])
def test_solids_in_recesses_and_voids_of_others(drawn: Any, name: str, draw: Draw, volume: float, ending: str) -> None:
    """The box around a recess is that of the whole; IGES has no solids, and STEP has these two."""
    found = mesh_cad(drawn(f"{name}.{ending}", draw), 0.008)
    assert len(found.solids) == 2
    assert found.mesh.element_volumes.sum() == pytest.approx(1e-9 * volume, rel=1e-6)


def test_seats_and_faces_are_found_by_where_they_lie(drawn: Any) -> None:
    mesh = mesh_cad(drawn("case.step", _case), 0.03).mesh
    bore = cylinder_facets(mesh, (-0.04, 0.075, -0.055), 0.04)
    assert facet_centers(mesh.points, bore)[:, 2].max() < -0.05  # the nearer of the two on this axis
    base = facet_centers(mesh.points, plane_facets(mesh, (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
    np.testing.assert_allclose(base[:, 1], 0.0, atol=1e-9)


def test_elements_are_smaller_around_places_where_that_is_asked(drawn: Any) -> None:
    path, place = drawn("case.step", _case), ((-0.04, 0.075, -0.055), 0.04)
    even = mesh_cad(path, 0.04, order=1).mesh
    finer = mesh_cad(path, 0.04, order=1, refine=[place], refined_size=0.01).mesh
    near = [np.linalg.norm(mesh.centers - place[0], axis=1) < 0.03 for mesh in (even, finer)]
    assert near[1].sum() > 2 * near[0].sum()


def test_solids_that_touch_share_nodes_under_names_of_their_own(drawn: Any) -> None:
    """Two blocks on each other: one body, two volumes, and no third for the whole, which .msh could not hold."""

    def two(gmsh: Any) -> None:
        gmsh.model.occ.addBox(0, 0, 0, 100, 100, 20)
        gmsh.model.occ.addBox(0, 0, 20, 100, 100, 30)

    found = mesh_cad(drawn("two.step", two), 0.05, order=1)
    assert found.solids == ("solid-1", "solid-2")
    volumes = [found.mesh.element_volumes[found.mesh.volumes[name]].sum() for name in found.solids]
    assert volumes == pytest.approx([2e-4, 3e-4])
    assert sorted(found.mesh.volumes) == ["solid-1", "solid-2"]
    nodes = [np.unique(found.mesh.blocks[0].nodes[found.mesh.volumes[name]]) for name in found.solids]
    shared = found.mesh.points[np.intersect1d(*nodes)]
    assert len(shared) > 3
    np.testing.assert_allclose(shared[:, 2], 0.02, atol=1e-9)


def _overlapping(gmsh: Any) -> None:
    gmsh.model.occ.addBox(0, 0, 0, 100, 100, 20)
    gmsh.model.occ.addBox(0, 0, 10, 100, 100, 20)


def _sheets(gmsh: Any) -> None:
    gmsh.model.occ.addRectangle(0, 0, 0, 100, 100)


def _pin(gmsh: Any) -> None:
    gmsh.model.occ.addBox(0, 0, 0, 0.33, 0.2, 0.2)


@pytest.mark.parametrize(
    ("name", "draw", "said"),
    [
        (
            "overlapping.step",
            _overlapping,
            r"'solid-2' overlap in .* between \(0, 0, 10\) and \(100, 100, 20\)",
        ),
        ("sheets.step", _sheets, "1 surfaces and no solid, and they do not close: 4 edges are open"),
        ("pin.step", _pin, "the part is 0.33 mm long, in the millimetres that the file states; is the unit metres"),
    ],
)
def test_shapes_that_are_no_housing_are_told_by_what_they_are(drawn: Any, name: str, draw: Draw, said: str) -> None:
    with pytest.raises(GeometryError, match=said):
        mesh_cad(drawn(name, draw), 0.03)


def test_a_unit_that_makes_sense_of_the_part_holds_against_the_files_own(drawn: Any) -> None:
    found = mesh_cad(drawn("pin.step", _pin), 0.1, unit=1.0, order=1)
    assert np.ptp(found.mesh.bounds, axis=0).max() == pytest.approx(0.33)
    assert any("it is read in metres, the unit given" in remark for remark in found.remarks)


@pytest.mark.parametrize("content", [b"", b"ISO-10303-21;\nHEADER;", bytes(range(256)) * 8])
def test_broken_files_are_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "broken.step").write_bytes(content)
    with pytest.raises(GeometryError, match=r"broken\.step: it is empty or broken, or no STEP file"):
        mesh_cad(tmp_path / "broken.step", 0.03)


def test_a_file_that_ends_too_early_is_refused(drawn: Any, tmp_path: Path) -> None:
    text = drawn("case.step", _case).read_text()
    (tmp_path / "cut.step").write_text(text[: len(text) // 2])
    with pytest.raises(GeometryError, match="empty or broken"):
        mesh_cad(tmp_path / "cut.step", 0.03)


@pytest.mark.parametrize(
    ("size", "said"),
    [
        (1e-5, r"would be about 1e\+13 in number, more than any solver takes \(3e\+06\); expected at least 1.52 mm"),
        (25.0, "elements of 25 m are larger than the part, whose longest side is 200 mm; did you mean 25 mm"),
    ],
)
def test_sizes_that_no_computer_takes_are_refused_with_one_that_it_does(drawn: Any, size: float, said: str) -> None:
    """8.49 V / h³ tetrahedra: of 1.25e-3 m³ at 10 µm that is 1.06e13, and 3e6 of them are 1.52 mm long."""
    with pytest.raises(MeshSizeError, match=said):
        mesh_cad(drawn("case.step", _case), size)


def test_files_of_other_kinds_and_missing_ones_are_refused(tmp_path: Path) -> None:
    with pytest.raises(GeometryError, match=r"its ending is none of \.step \.stp"):
        mesh_cad(tmp_path / "part.dwg", 0.03)
    with pytest.raises(GeometryError, match="cannot be read: No such file"):
        mesh_cad(tmp_path / "part.step", 0.03)


_PARENT = """
import subprocess, sys
worker = "import sys, time; from pathlib import Path; from gearwhine.meshes.cad.worker import end_with; " \\
    "end_with(int(sys.argv[2]), Path(sys.argv[1])); print(flush=True); time.sleep(60)"
import os
child = subprocess.Popen([sys.executable, "-c", worker, sys.argv[1], str(os.getpid())], stdout=subprocess.PIPE)
child.stdout.readline()
print(child.pid, flush=True)
child.wait()
"""


def test_the_reader_ends_with_a_parent_that_is_killed_and_takes_its_folder_along(tmp_path: Path) -> None:
    folder = tmp_path / "gearwhine-cad"
    folder.mkdir()
    (folder / "request.json").write_text("{}")
    with subprocess.Popen([sys.executable, "-c", _PARENT, str(folder)], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        worker = psutil.Process(int(parent.stdout.readline()))
        parent.kill()
    # Where nobody collects orphans, the ended one stays as a zombie.
    limit = time.monotonic() + 10.0
    while worker.is_running() and worker.status() != psutil.STATUS_ZOMBIE:
        assert time.monotonic() < limit, "the reader lives on"
        time.sleep(0.02)
    assert not folder.exists()


def test_a_reader_is_given_time_by_the_size_of_its_file(tmp_path: Path) -> None:
    """Five seconds, and five minutes for each megabyte."""
    path = tmp_path / "large.step"
    with path.open("wb") as file:
        file.truncate(2_000_000)
    assert _reading_limit(path) == pytest.approx(605.0)
    with path.open("wb") as file:
        file.truncate(10**9)
    assert _reading_limit(path) == 3600.0


@pytest.mark.parametrize("stage", ["reading it", "meshing it"])
def test_the_file_size_limits_reading_and_not_meshing(stage: str, tmp_path: Path) -> None:
    (tmp_path / "stage").write_text(stage, encoding="utf-8")
    works = "[(time.sleep(0.3), spent.write_text(str(0.3 * n))) for n in range(5)]; sys.stderr.write('done')"
    program = f"import pathlib, sys, time; spent = pathlib.Path(sys.argv[1], 'spent'); {works}"
    slow = [sys.executable, "-c", program, str(tmp_path)]
    with subprocess.Popen(slow, stderr=subprocess.PIPE) as worker:
        if stage == "meshing it":
            assert _errors_of(worker, tmp_path, 0.1, 60.0) == b"done"
        else:
            with pytest.raises(subprocess.TimeoutExpired):
                _errors_of(worker, tmp_path, 0.1, 60.0)
            worker.kill()
