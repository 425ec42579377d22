"""Mesh files through the command: what it says of sound, doubtful and wrong ones."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearwhine.meshes import ElementBlock, Mesh, write_mesh
from gearwhine.meshes.elements import facet_centers, pick_facets

CASE = """
[material.steel]
youngs_modulus = "207 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"
[housing]
material = "steel"
modes = 8
mesh = {{ file = "{file}", unit = "{unit}" }}
"""


@pytest.fixture
def case(tmp_path: Path, block_of: Callable[..., Mesh]) -> Callable[..., str]:
    """``case(kind, ending, unit=..., change=...)``: a case on a written block of 200 x 150 x 20 mm."""

    def make(
        kind: str = "hexahedron20",
        ending: str = ".inp",
        *,
        unit: str = "mm",
        change: Callable[[Mesh], Mesh] = lambda mesh: mesh,
        more: str = "",
    ) -> str:
        mesh = change(block_of(kind, (200.0, 150.0, 20.0), (4, 3, 1)))
        write_mesh(mesh, tmp_path / f"block{ending}")
        (tmp_path / "case.toml").write_text(CASE.format(file=f"block{ending}", unit=unit) + more)
        return str(tmp_path / "case.toml")

    return make


def test_the_check_reads_the_file_and_says_what_is_in_it(gearwhine: Any, case: Any) -> None:
    def with_top(mesh: Mesh) -> Mesh:
        top = facet_centers(mesh.points, mesh.boundary)[:, 2] > 19.9
        surfaces = {"the top": pick_facets(mesh.boundary, top)}
        return replace(mesh, surfaces=surfaces, volumes={"left half": np.arange(6)})

    path = case("hexahedron", ".inp", change=with_top)
    document = gearwhine("check", path, "--json", "-q").document["housing"]
    assert document["kinds"] == {"hexahedron": 12}
    assert document["surfaces"] == ["the top"]
    assert document["volumes"] == ["left half"]
    assert document["size_m"] == pytest.approx([0.2, 0.15, 0.02])
    assert "mesh of 200 x 150 x 20 mm, 40 nodes, 12 bricks of 8 nodes" in " ".join(
        gearwhine("check", path, "-q").out.split()
    )


def test_a_mistaken_unit_is_a_warning_on_the_screen_and_in_the_document(gearwhine: Any, case: Any) -> None:
    outcome = gearwhine("modes", case("hexahedron20", unit="m"), "--json", "-q")
    assert outcome.code == 0
    doubt = "the part is 200 m long; is the unit 'm'? With 'mm' it would be 200 mm"
    assert outcome.err.count("warning:") == 3  # the others say that it floats freely, and that its elements are coarse
    assert f"warning: {doubt}\n" in outcome.err
    warning, coarse, floating = outcome.document["warnings"]
    assert (warning["name"], warning["message"]) == ("unit", doubt)
    assert (coarse["name"], floating["name"]) == ("discretisation", "case")
    assert floating["message"].endswith("it floats freely")
    assert f"warning: {doubt}" in gearwhine("mesh", case("hexahedron20", unit="m"), "-q").err
    assert f"warning: {doubt}" in gearwhine("check", case("hexahedron20", unit="m"), "-q").err


def test_simple_tetrahedra_and_large_elements_are_doubted(gearwhine: Any, case: Any) -> None:
    warnings = gearwhine("modes", case("tetra"), "--json", "-q").document["warnings"]
    # The last says that it floats freely.
    assert [warning["name"] for warning in warnings] == ["discretisation", "locking", "case"]
    coarse = gearwhine("check", "steel-box", "-q", "--set", "housing.frequency_limit=30 kHz", "--json")
    (warning,) = coarse.document["warnings"]
    assert warning["name"] == "size"
    assert "use a mesh_size of at most" in warning["message"]
    assert warning["message"] in coarse.err


def _halves(mesh: Mesh) -> Mesh:
    """The block once more behind itself, its nodes at the joint not merged."""
    (block,) = mesh.blocks
    points = np.vstack([mesh.points, mesh.points + [200.0, 0.0, 0.0]])
    return Mesh(points, (block, ElementBlock(block.kind, block.nodes + len(mesh.points))))


def test_half_a_file_is_an_error_that_names_it(gearwhine: Any, case: Any, tmp_path: Path) -> None:
    path, file = case("hexahedron", ".msh"), tmp_path / "block.msh"
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    outcome = gearwhine("mesh", path, "-q")
    assert outcome.code == 2
    assert "housing.mesh.file: expected a mesh of solid elements; " in outcome.err


@pytest.mark.parametrize("command", ["mesh", "modes", "check"])
def test_unmerged_bodies_are_an_error_that_names_the_file(gearwhine: Any, case: Any, command: str) -> None:
    outcome = gearwhine(command, case("hexahedron", change=_halves), "-q")
    assert outcome.code == 2
    assert (
        "housing.mesh.file: expected a sound mesh; disconnected: the mesh falls into 2 bodies whose nodes"
        in outcome.err
    )
    assert "whose nodes coincide at 8 places, the first at (0.2, 0, 0) m; merge them" in outcome.err
    assert "Traceback" not in outcome.err


def _with_ends(mesh: Mesh) -> Mesh:
    """Name the two facets where the first two bodies touch ``a`` and ``b``."""
    at_joint = np.isclose(facet_centers(mesh.points, mesh.boundary)[:, 0], 200.0)
    chosen = [np.isin(np.arange(len(at_joint)), part) for part in np.split(np.flatnonzero(at_joint), 2)]
    ends = {name: pick_facets(mesh.boundary, mask) for name, mask in zip(("a", "b"), chosen, strict=True)}
    return replace(mesh, surfaces=ends)


JOINT = """[[housing.joint]]
name = "bolts"
surfaces = ["a", "b"]
stiffness = { x = 1e9, y = 1e9, z = 1e9, rx = 1e6, ry = 1e6, rz = 1e6 }
"""


def test_bodies_that_a_joint_may_tie_are_no_error(gearwhine: Any, case: Any) -> None:
    mesh = case("hexahedron20", change=lambda one: _with_ends(_halves(one)), more=JOINT)
    outcome = gearwhine("modes", mesh, "--json", "-q")
    assert outcome.code == 0, outcome.err
    hertz = [mode["frequency_hz"] for mode in json.loads(outcome.out)["modes"]]
    assert hertz[:6] == [0.0] * 6
    assert hertz[6] > 0.0


def test_a_body_beside_joined_ones_is_an_error(gearwhine: Any, case: Any) -> None:
    def three(mesh: Mesh) -> Mesh:
        two = _halves(mesh)
        third = ElementBlock(mesh.blocks[0].kind, mesh.blocks[0].nodes + len(two.points))
        return _with_ends(Mesh(np.vstack([two.points, mesh.points + [400.0, 0.0, 0.0]]), (*two.blocks, third)))

    outcome = gearwhine("check", case("hexahedron", change=three, more=JOINT), "-q")
    assert outcome.code == 2
    assert "2 bodies whose nodes coincide at 8 places, the first at (0.4, 0, 0) m; merge them" in outcome.err


def test_files_that_hold_no_solids_are_errors_of_the_case(gearwhine: Any, tmp_path: Path) -> None:
    (tmp_path / "block.inp").write_text("*NODE\n1, 0, 0, 0\n")
    (tmp_path / "case.toml").write_text(CASE.format(file="block.inp", unit="m"))
    for command in ("check", "mesh", "modes"):
        outcome = gearwhine(command, str(tmp_path / "case.toml"), "-q")
        assert outcome.code == 2
        assert "block.inp holds no solid elements" in outcome.err
