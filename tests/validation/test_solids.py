"""Published natural frequencies of solids.

Sources, and the scatter that they allow:

- *Free ring*: code_aster, Validation V2.03.109, "SDLS109 -- Fréquences propres d'un anneau cylindrique épais" (±0.5 %).
- *Free solid cylinder*: FinEtools, vibration examples, after the Abaqus C3D10 benchmark (±0.1 %). Its first torsional
  mode has the closed form √(G/ρ) / 2L.
- *FV32*, "Cantilevered tapered membrane": NAFEMS, The Standard NAFEMS Benchmarks, TNSB Rev. 3, 1990 (±0.1 %). Here the
  membrane is half of a solid plate: its middle plane does not move across, its outer face is free, as in plane stress.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from housing import Material, ModeSet, Support, assemble, fixed_freedoms, solve_modes
from meshes import Mesh, read_mesh
from meshes.gmsh_session import gmsh_session

Published = Callable[..., None]

RING = "code_aster V2.03.109 (SDLS109), free thick ring"
CYLINDER = "FinEtools, free solid cylinder, after the Abaqus C3D10 benchmark"
FV32 = "NAFEMS FV32 (TNSB Rev. 3, 1990), cantilevered tapered membrane"

RING_HZ = [205.89, 205.89, 210.55, 210.55, 587.92, 587.92, 588.88, 588.88]
CYLINDER_HZ = [2546.8, 2546.8, 2560.7, 4100.0, 4693.3, 4693.3, 5121.3]
FV32_HZ = [44.623, 130.03, 162.70, 246.05, 379.90, 391.44]


def _solid(build: Callable[[Any], None], size: float, path: Path) -> Mesh:
    """A mesh of ten-node tetrahedra of a shape that ``build`` makes with gmsh."""
    with gmsh_session(path.stem) as gmsh:
        build(gmsh)
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMin", size)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        gmsh.write(str(path))
    return read_mesh(path)


def _check(published: Published, source: str, printed: list[float], modes: ModeSet, rigid: int, rel: float) -> None:
    assert modes.certificate.complete
    assert (modes.frequencies[:rigid] == 0.0).all()
    elastic = modes.frequencies_hz[rigid : rigid + len(printed)]
    for number, (value, ours) in enumerate(zip(printed, elastic, strict=True), start=1):
        published(source, f"elastic mode {number}" if rigid else f"mode {number}", value, ours, "Hz", rel=rel)


def test_free_ring(tmp_path: Path, published: Published) -> None:
    mean, thickness, length = 0.369, 0.048, 0.05

    def ring(gmsh: Any) -> None:
        outer, inner = (
            gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, length, mean + side * thickness / 2) for side in (1, -1)
        )
        gmsh.model.occ.cut([(3, outer)], [(3, inner)])

    mesh = _solid(ring, 0.03, tmp_path / "ring.msh")
    matrices = assemble(mesh, Material(185e9, 0.3, 7800.0))
    assert matrices.total_mass == pytest.approx(7800.0 * 2 * np.pi * mean * thickness * length, rel=1e-4)
    modes = solve_modes(matrices, frequency_limit=2 * np.pi * 700.0)
    assert len(modes.frequencies) == 6 + len(RING_HZ)
    _check(published, RING, RING_HZ, modes, rigid=6, rel=0.005)


def test_free_solid_cylinder(tmp_path: Path, published: Published) -> None:
    radius, length = 0.1524, 0.6096
    material = Material(70e9, 0.33, 2700.0)

    def cylinder(gmsh: Any) -> None:
        gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, length, radius)

    modes = solve_modes(assemble(_solid(cylinder, 0.04, tmp_path / "cylinder.msh"), material), count=13)
    assert len(modes.frequencies) == 13
    _check(published, CYLINDER, CYLINDER_HZ, modes, rigid=6, rel=0.001)
    torsion_hz = np.sqrt(material.lame[1] / material.density) / (2 * length)
    published(CYLINDER, "elastic mode 3, by √(G/ρ) / 2L", torsion_hz, modes.frequencies_hz[8], "Hz", rel=2e-4)


def test_fv32_tapered_cantilever_membrane(tmp_path: Path, published: Published) -> None:
    length, deep, shallow, thickness = 10.0, 5.0, 1.0, 0.05

    def half_plate(gmsh: Any) -> None:
        occ = gmsh.model.occ
        corners = [(0, -deep / 2), (length, -shallow / 2), (length, shallow / 2), (0, deep / 2)]
        points = [occ.addPoint(x, y, 0) for x, y in corners]
        lines = [occ.addLine(start, end) for start, end in zip(points, points[1:] + points[:1], strict=True)]
        face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
        occ.extrude([(2, face)], 0, 0, thickness / 2, numElements=[1])

    mesh = _solid(half_plate, 0.5, tmp_path / "membrane.msh")
    tiny = 1e-6
    clamp = ((-tiny, -deep, -tiny), (tiny, deep, thickness))
    middle = ((-tiny, -deep, -tiny), (length + tiny, deep, tiny))
    supports = [
        Support("deep end", box=clamp, fixed=(True, True, False)),
        Support("middle plane", box=middle, fixed=(False, False, True)),
    ]
    matrices = assemble(mesh, Material(200e9, 0.3, 8000.0))
    assert matrices.total_mass == pytest.approx(8000.0 * length * (deep + shallow) / 2 * thickness / 2, rel=1e-9)
    modes = solve_modes(matrices, fixed_freedoms(mesh, supports), frequency_limit=2 * np.pi * 400.0)
    assert len(modes.frequencies) == len(FV32_HZ)
    _check(published, FV32, FV32_HZ, modes, rigid=0, rel=0.001)
