"""Published natural frequencies of solids.

Sources, and the scatter that they allow:

- *Free ring*: code_aster, Validation V2.03.109, "SDLS109 -- Fréquences propres d'un anneau cylindrique épais" (±0.5 %).
- *Free solid cylinder*: FinEtools, vibration examples, after the Abaqus C3D10 benchmark (±0.1 %). Its first torsional
  mode has the closed form √(G/ρ) / 2L.
- *FV32*, "Cantilevered tapered membrane": NAFEMS, The Standard NAFEMS Benchmarks, TNSB Rev. 3, 1990 (±0.1 %). Here the
  membrane is half of a solid plate: its middle plane does not move across, its outer face is free, as in plane stress.
- *FV12*, "Free thin square plate", and *FV16*, "Cantilevered thin square plate", of the same benchmarks, as FinEALE has
  them (github.com/PetrKryslUCSD/FinEALE; ±0.7 %). Its values are of thin plates; here they are solids, clamped in all
  directions along the edge.

Each shape is met from gmsh's geometry, and from mesh files with other kinds of elements.
"""

import warnings
from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from gearwhine.housing import Material, ModeSet, Support, assemble, attach_fixtures, solve_modes
from gearwhine.meshes import ElementBlock, Mesh, read_mesh, write_mesh
from gearwhine.meshes.formats.files import WRITABLE
from gearwhine.meshes.gmsh_meshing import gmsh_session
from gearwhine.numerics.arrays import FloatArray

Published = Callable[..., None]

RING = "code_aster V2.03.109 (SDLS109), free thick ring"
CYLINDER = "FinEtools, free solid cylinder, after the Abaqus C3D10 benchmark"
FV32 = "NAFEMS FV32 (TNSB Rev. 3, 1990), cantilevered tapered membrane"

FV12 = "NAFEMS FV12 (TNSB Rev. 3, 1990), free thin square plate"
FV16 = "NAFEMS FV16 (TNSB Rev. 3, 1990), cantilevered thin square plate"

RING_HZ = [205.89, 205.89, 210.55, 210.55, 587.92, 587.92, 588.88, 588.88]
CYLINDER_HZ = [2546.8, 2546.8, 2560.7, 4100.0, 4693.3, 4693.3, 5121.3]
FV32_HZ = [44.623, 130.03, 162.70, 246.05, 379.90, 391.44]

FV12_HZ = [1.622, 2.360, 2.922, 4.190, 4.190, 7.356, 7.356, 7.668]
FV16_HZ = [0.421, 1.029, 2.582, 3.306, 3.753, 6.555]


def _solid(build: Callable[[Any], None], size: float, path: Path) -> Mesh:
    """A mesh of a shape that ``build`` makes with gmsh: ten-node tetrahedra, or what its own extrusion gives."""
    with gmsh_session(path.stem) as gmsh:
        build(gmsh)
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMin", size)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
        gmsh.option.setNumber("Mesh.BdfFieldFormat", 2)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        gmsh.write(str(path))
    return read_mesh(path)


def _through_file(mesh: Mesh, path: Path) -> Mesh:
    """The mesh as its file has it: ours, or one that meshio itself writes."""
    if path.suffix in WRITABLE:
        write_mesh(mesh, path)
    else:
        # meshio's writer of Nastran decks gives up where a number does not fit its field of 16 letters.
        content = meshio.Mesh(np.round(mesh.points, 9), [(block.kind, block.nodes) for block in mesh.blocks])
        with redirect_stdout(StringIO()), warnings.catch_warnings(action="ignore"):
            meshio.write(path, content)
    found = read_mesh(path)
    assert found.kinds == mesh.kinds
    return found


def _check(
    published: Published,
    source: str,
    printed: list[float],
    modes: ModeSet,
    rigid: int,
    rel: float,
    mesh: str = "",
) -> None:
    assert modes.certificate.complete
    assert (modes.frequencies[:rigid] == 0.0).all()
    elastic = modes.frequencies_hz[rigid : rigid + len(printed)]
    for number, (value, ours) in enumerate(zip(printed, elastic, strict=True), start=1):
        quantity = f"elastic mode {number}" if rigid else f"mode {number}"
        published(source, f"{quantity}, {mesh}" if mesh else quantity, value, ours, "Hz", rel=rel)


MEAN, THICKNESS, LENGTH = 0.369, 0.048, 0.05


def test_free_ring(tmp_path: Path, published: Published) -> None:
    def ring(gmsh: Any) -> None:
        outer, inner = (
            gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, LENGTH, MEAN + side * THICKNESS / 2) for side in (1, -1)
        )
        gmsh.model.occ.cut([(3, outer)], [(3, inner)])

    _check_ring(_solid(ring, 0.03, tmp_path / "ring.msh"), published)


@pytest.mark.parametrize(
    ("kind", "ending", "of"),
    [("hexahedron20", ".inp", "bricks of 20 nodes"), ("hexahedron27", ".vtu", "bricks of 27 nodes")],
)
def test_free_ring_from_mesh_files(
    tmp_path: Path, published: Published, block_of: Callable[..., Mesh], kind: str, ending: str, of: str
) -> None:
    def bend(points: FloatArray) -> FloatArray:
        radius, angle = MEAN + THICKNESS * (points[:, 0] - 0.5), 2 * np.pi * points[:, 1]
        return np.stack([radius * np.cos(angle), radius * np.sin(angle), LENGTH * points[:, 2]], axis=1)

    opened = block_of(kind, cells=(2, 32, 2), bend=bend)
    # The seam is closed by making one node of each two.
    _, first, number = np.unique(np.round(opened.points, 9) + 0.0, axis=0, return_index=True, return_inverse=True)
    (block,) = opened.blocks
    closed = Mesh(opened.points[first], (ElementBlock(kind, number[block.nodes]),))
    _check_ring(_through_file(closed, tmp_path / f"ring{ending}"), published, f"{of} from {ending}")


def _check_ring(mesh: Mesh, published: Published, of: str = "") -> None:
    matrices = assemble(mesh, Material(185e9, 0.3, 7800.0))
    assert matrices.total_mass == pytest.approx(7800.0 * 2 * np.pi * MEAN * THICKNESS * LENGTH, rel=1e-4)
    modes = solve_modes(matrices, frequency_limit=2 * np.pi * 700.0)
    assert len(modes.frequencies) == 6 + len(RING_HZ)
    _check(published, RING, RING_HZ, modes, rigid=6, rel=0.005, mesh=of)


RADIUS, HEIGHT = 0.1524, 0.6096
ALUMINIUM = Material(70e9, 0.33, 2700.0)


@pytest.mark.slow
def test_free_solid_cylinder(tmp_path: Path, published: Published) -> None:
    modes = _check_cylinder(_solid(_cylinder, 0.04, tmp_path / "cylinder.msh"), published)
    torsion_hz = np.sqrt(ALUMINIUM.lame[1] / ALUMINIUM.density) / (2 * HEIGHT)
    published(CYLINDER, "elastic mode 3, by √(G/ρ) / 2L", torsion_hz, modes.frequencies_hz[8], "Hz", rel=2e-4)


def test_free_solid_cylinder_of_wedges_from_gmsh(tmp_path: Path, published: Published) -> None:
    def layers(gmsh: Any) -> None:
        disk = gmsh.model.occ.addDisk(0, 0, 0, RADIUS, RADIUS)
        gmsh.model.occ.extrude([(2, disk)], 0, 0, HEIGHT, numElements=[9], recombine=True)

    mesh = _solid(layers, 0.06, tmp_path / "cylinder.msh")
    assert set(mesh.kinds) == {"wedge15"}
    _check_cylinder(mesh, published, "wedges of 15 nodes from gmsh's .msh")


def test_free_solid_cylinder_from_a_nastran_deck(tmp_path: Path, published: Published) -> None:
    mesh = _solid(_cylinder, 0.05, tmp_path / "cylinder.bdf")
    assert set(mesh.kinds) == {"tetra10"}
    _check_cylinder(mesh, published, "tetrahedra of 10 nodes from gmsh's .bdf")


def _cylinder(gmsh: Any) -> None:
    gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, HEIGHT, RADIUS)


def _check_cylinder(mesh: Mesh, published: Published, of: str = "") -> ModeSet:
    modes = solve_modes(assemble(mesh, ALUMINIUM), count=13)
    assert len(modes.frequencies) == 13
    _check(published, CYLINDER, CYLINDER_HZ, modes, rigid=6, rel=0.001, mesh=of)
    return modes


SPAN, DEEP, SHALLOW, THIN = 10.0, 5.0, 1.0, 0.05


def test_fv32_tapered_cantilever_membrane(tmp_path: Path, published: Published) -> None:
    def half_plate(gmsh: Any) -> None:
        occ = gmsh.model.occ
        corners = [(0, -DEEP / 2), (SPAN, -SHALLOW / 2), (SPAN, SHALLOW / 2), (0, DEEP / 2)]
        points = [occ.addPoint(x, y, 0) for x, y in corners]
        lines = [occ.addLine(start, end) for start, end in zip(points, points[1:] + points[:1], strict=True)]
        face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
        occ.extrude([(2, face)], 0, 0, THIN / 2, numElements=[1])

    _check_membrane(_solid(half_plate, 0.5, tmp_path / "membrane.msh"), published)


@pytest.mark.parametrize(
    ("kind", "ending", "of"),
    [
        ("hexahedron20", ".bdf", "bricks of 20 nodes"),
        ("hexahedron27", ".msh", "bricks of 27 nodes"),
        ("wedge15", ".inp", "wedges of 15 nodes"),
    ],
)
def test_fv32_from_mesh_files(
    tmp_path: Path, published: Published, block_of: Callable[..., Mesh], kind: str, ending: str, of: str
) -> None:
    def taper(points: FloatArray) -> FloatArray:
        depth = DEEP + (SHALLOW - DEEP) * points[:, 0]
        return np.stack([SPAN * points[:, 0], depth * (points[:, 1] - 0.5), THIN / 2 * points[:, 2]], axis=1)

    mesh = block_of(kind, cells=(20, 10, 1), bend=taper)
    _check_membrane(_through_file(mesh, tmp_path / f"membrane{ending}"), published, f"{of} from {ending}")


def _check_membrane(mesh: Mesh, published: Published, of: str = "") -> None:
    tiny = 1e-6
    clamp = ((-tiny, -DEEP, -tiny), (tiny, DEEP, THIN))
    middle = ((-tiny, -DEEP, -tiny), (SPAN + tiny, DEEP, tiny))
    supports = [
        Support("deep end", box=clamp, fixed=(True, True, False)),
        Support("middle plane", box=middle, fixed=(False, False, True)),
    ]
    matrices = assemble(mesh, Material(200e9, 0.3, 8000.0))
    assert matrices.total_mass == pytest.approx(8000.0 * SPAN * (DEEP + SHALLOW) / 2 * THIN / 2, rel=1e-9)
    modes = solve_modes(attach_fixtures(matrices, mesh, supports), frequency_limit=2 * np.pi * 400.0)
    assert len(modes.frequencies) == len(FV32_HZ)
    _check(published, FV32, FV32_HZ, modes, rigid=0, rel=0.001, mesh=of)


def test_thin_square_plates(published: Published, block_of: Callable[..., Mesh]) -> None:
    """A side of 10 m, 50 mm thick, one brick of 20 nodes across."""
    mesh = block_of("hexahedron20", cells=(20, 20, 1), bend=lambda points: points * [10.0, 10.0, THIN])
    plate = assemble(mesh, Material(200e9, 0.3, 8000.0))
    _check(published, FV12, FV12_HZ, solve_modes(plate, count=6 + len(FV12_HZ)), rigid=6, rel=0.007)
    edge = Support("edge", box=((-1e-6, -1.0, -1.0), (1e-6, 11.0, 1.0)), fixed=(True, True, True))
    held = solve_modes(attach_fixtures(plate, mesh, [edge]), count=len(FV16_HZ))
    _check(published, FV16, FV16_HZ, held, rigid=0, rel=0.007)
