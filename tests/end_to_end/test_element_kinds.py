"""Every kind of solid element that is documented, through every command that takes elements of a housing."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from meshio._mesh import topological_dimension

from gearwhine.meshes import Mesh, read_mesh, write_mesh
from gearwhine.meshes.elements import SOLIDS

CASE = """
title = "block"
[material.steel]
youngs_modulus = "207 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"
[housing]
material = "steel"
damping_ratio = 0.01
modes = 6
mesh = { file = "FILE", unit = "mm" }
[[housing.support]]
name = "base"
plane = { axis = "y", at = "0 mm" }
fixed = ["x", "y", "z"]
[[housing.sensor]]
name = "top"
position = ["100 mm", "150 mm", "60 mm"]
[measured]
frequencies = ["3 kHz", "4 kHz"]
[acoustics]
mesh_size = "40 mm"
highest_frequency = "1 kHz"
in_run = true
[[acoustics.microphone]]
name = "above"
position = ["100 mm", "1 m", "60 mm"]
"""
OF_ELEMENTS = (
    ("mesh", "--format", "vtu"),
    ("modes",),
    ("render", "--modes", "1"),
    ("render", "--modes", "1", "--format", "glb"),
    ("sound",),
)
OF_MODES = (
    ("check",),
    ("compare",),
    ("survey", "--sensors", "3", "--modes", "2"),
    ("run", "--no-pictures"),
    ("report",),
    ("export",),
)
"""Commands that take the modes, whatever the elements were: of one kind."""

# CPENTA lists the middles of the edges along the axis before those of the upper triangle.
NASTRAN = """BEGIN BULK
CPENTA,1,1,1,2,3,4,5,6
,7,8,9,13,14,15,10,11
,12
PSOLID,1,1
MAT1,1,207000.,,0.3,7.85-9
{grid}
ENDDATA
"""


@pytest.fixture(autouse=True)
def _meshio_as_installed() -> Iterator[None]:
    """Undo what other tests add to meshio's table of dimensions, which lacks wedges of 15 nodes."""
    with pytest.MonkeyPatch.context() as patch:
        patch.delitem(topological_dimension, "wedge15", raising=False)
        yield


def _case(folder: Path, file: str, *, more: str = CASE) -> None:
    (folder / "case.toml").write_text(more.replace("FILE", file), encoding="utf-8")


@pytest.mark.parametrize("source", ["abaqus", "nastran"])
def test_one_wedge_of_fifteen_nodes_has_modes_and_shapes(
    gearwhine: Any, tmp_path: Path, block_of: Callable[..., Mesh], source: str
) -> None:
    block = block_of("wedge15", (100.0, 100.0, 100.0))
    (wedge,) = block.blocks
    points = block.points[wedge.nodes[0]]
    if source == "nastran":
        grid = "\n".join(f"GRID,{n},,{x:g}.,{y:g}.,{z:g}." for n, (x, y, z) in enumerate(points, start=1))
        (tmp_path / "one.bdf").write_text(NASTRAN.format(grid=grid), encoding="utf-8")
        _case(tmp_path, "one.bdf", more=CASE.partition("[[housing.support]]")[0])
    else:
        write_mesh(block, tmp_path / "one.inp")
        _case(tmp_path, "one.inp", more=CASE.partition("[[housing.support]]")[0])
    document = gearwhine("modes", "case.toml", "--json", "-q", "-o", "out").document
    shapes = read_mesh(tmp_path / "out" / "modes.vtu")
    assert list(shapes.kinds) == ["wedge15"]
    volume = 1e-3 / (2.0 if source == "nastran" else 1.0)
    assert document["mass_kg"] == pytest.approx(7850.0 * volume)


@pytest.mark.slow
@pytest.mark.parametrize("kind", SOLIDS)
def test_every_kind_goes_through_every_command(
    gearwhine: Any, tmp_path: Path, block_of: Callable[..., Mesh], kind: str
) -> None:
    write_mesh(block_of(kind, (200.0, 150.0, 120.0), (2, 2, 2)), tmp_path / "block.inp")
    _case(tmp_path, "block.inp")
    for command, *options in OF_ELEMENTS if kind != SOLIDS[-1] else (*OF_ELEMENTS, *OF_MODES):
        outcome = gearwhine(command, "case.toml", *options, "-q", "-o", "out")
        assert outcome.code == 0, f"{command} of {kind}: {outcome.err}"
        assert "Traceback" not in outcome.err
    pictures = {path.name for path in (tmp_path / "out").rglob("mode-01-*")}
    assert {Path(name).suffix for name in pictures} == {".png", ".glb"}
    assert list(read_mesh(tmp_path / "out" / "modes.vtu").kinds) == [kind]
