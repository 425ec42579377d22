"""Flat faces of a mesh file with names by a point on them, the same in every result."""

from collections.abc import Callable
from pathlib import Path

import pytest
from case_housings import mesh_of

import gearwhine as gw
from gearwhine.case import CaseError, load_case
from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.housing.acoustics.surface_velocity import surface_velocity
from gearwhine.housing.acoustics.wrapping import wrap
from gearwhine.housing.fem.surface import flat_face_names
from gearwhine.housing.updating.housing_change import face_changes
from gearwhine.meshes import Mesh, write_mesh

CASE = """
[material.steel]
youngs_modulus = "207 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"
[housing]
material = "steel"
modes = 7
[housing.mesh]
file = "block.msh"
"""


@pytest.fixture
def write(tmp_path: Path, block_of: Callable[..., Mesh]) -> Callable[[str], Path]:
    """Write a case on a block of 200 x 100 x 50 mm, with more keys."""
    write_mesh(block_of("hexahedron20", (0.2, 0.1, 0.05), (4, 2, 1)), tmp_path / "block.msh")

    def made(more: str) -> Path:
        path = tmp_path / "case.toml"
        path.write_text(CASE + more, encoding="utf-8")
        return path

    return made


def test_a_face_has_one_name_everywhere(write: Callable[[str], Path]) -> None:
    """By its point, else by direction and middle: in the sound as in the sensitivities."""
    case = gw.load(write('[[housing.face]]\nname = "lid"\nat = ["120 mm", "100 mm", "20 mm"]\n')).case
    mesh = mesh_of(case)
    names = {face.name for face in flat_face_names(mesh)}
    assert names == {
        "lid",
        "-y at 100, 0, 25 mm",
        "-x at 0, 50, 25 mm",
        "+x at 200, 50, 25 mm",
        "-z at 100, 50, 0 mm",
        "+z at 100, 50, 50 mm",
    }
    assert {change.parameter for change in face_changes(mesh, ())} <= names
    surface: RadiatingSurface = wrap(mesh, 0.02, 0.02)
    assert set(surface_velocity(mesh, surface).face_of_triangles()) == names


@pytest.mark.parametrize(
    ("name", "at", "said"),
    [
        (
            "lid",
            '["120 mm", "160 mm", "20 mm"]',
            'housing.face[0].at (face "lid"): expected a point on the surface; this',
        ),
        ("lid", '["120 mm", "99 mm", "20 mm"]', ""),
    ],
)
def test_points_beside_the_surface_are_refused(write: Callable[[str], Path], name: str, at: str, said: str) -> None:
    case = gw.load(write(f'[[housing.face]]\nname = "{name}"\nat = {at}\n')).case
    if not said:
        assert name in mesh_of(case).surfaces
        return
    with pytest.raises(CaseError) as refused:
        mesh_of(case)
    assert said in str(refused.value)


def test_faces_of_a_box_have_names_already() -> None:
    with pytest.raises(CaseError, match="none of a box, whose faces are named already: left"):
        gw.load("steel-box", {"housing.face": [{"name": "lid", "at": ["0 mm", "160 mm", "0 mm"]}]})


def test_inner_sides_of_walls_have_the_names_of_their_outer_sides() -> None:
    """A box of walls of 10 mm: six outer sides by name, six inner ones behind them; feet have no inner side."""
    case = load_case("steel-box", ["housing.box.mesh_size=60 mm"]).case
    names = [face.name for face in flat_face_names(mesh_of(case))]
    inner = sorted(name for name in names if name.startswith("inside of "))
    assert [name.split()[2] for name in inner] == ["back", "bottom", "front", "left", "right", "top"]
    assert "inside of bottom at 0, 10, 0 mm" in inner
    assert "inside of top at 0, 150, 0 mm" in inner
