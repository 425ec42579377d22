"""Housings from files through the real command: what works at once, and what is wrong told by its key."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearwhine.meshes import read_mesh, write_mesh
from gearwhine.meshes.gmsh_meshing import gmsh_session
from gearwhine.results.mesh import bore_line

STEEL = """
[material.steel]
youngs_modulus = "207 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"
"""
CAD = (
    STEEL
    + """
[housing]
material = "steel"
modes = 4
cad = { file = "case.step", mesh_size = "45 mm" }
[[housing.seat]]
name = "input"
center = ["-40 mm", "75 mm", "-55 mm"]
diameter = "40 mm"
[[housing.support]]
name = "base"
plane = { axis = "y", at = "0 mm" }
fixed = ["x", "y", "z"]
[[housing.sensor]]
name = "top"
position = ["0 mm", "150 mm", "0 mm"]
"""
)
SOLID = 0.2 * 0.15 * 0.12 - 0.18 * 0.13 * 0.10 - 2 * 0.01 * np.pi * 0.02**2  # m³


@pytest.fixture(scope="module")
def drawing(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A STEP file by gmsh's own kernel: 200 x 150 x 120 mm, walls of 10 mm, a bore of 40 mm through both ends."""
    path = tmp_path_factory.mktemp("drawing") / "case.step"
    with gmsh_session("case") as gmsh:
        occ = gmsh.model.occ
        walls, _ = occ.cut(
            [(3, occ.addBox(-100, 0, -60, 200, 150, 120))], [(3, occ.addBox(-90, 10, -50, 180, 130, 100))]
        )
        occ.cut(walls, [(3, occ.addCylinder(-40, 75, -70, 0, 0, 140, 20))])
        occ.synchronize()
        gmsh.write(str(path))
    return path.read_text()


@pytest.fixture
def case(drawing: str, tmp_path: Path) -> Callable[[str], str]:
    """``case(text)``: a case file beside the drawing."""

    def make(text: str = CAD) -> str:
        (tmp_path / "case.step").write_text(drawing)
        (tmp_path / "case.toml").write_text(text)
        return str(tmp_path / "case.toml")

    return make


def test_a_drawing_becomes_a_mesh_file_of_the_default_format(gearwhine: Any, case: Any, tmp_path: Path) -> None:
    outcome = gearwhine("mesh", case(), "-o", "out", "--json", "-q")
    assert outcome.code == 0, outcome.err
    assert outcome.document["bores"][0]["diameter_m"] == pytest.approx(0.04)
    (bore,) = [one for one in outcome.document["bores"] if one["center_m"][2] < 0.0]
    assert bore_line(bore) == "bore of 40 mm at (-40, 75, -55) mm, 10 mm long"
    mesh = read_mesh(tmp_path / "out" / "mesh.msh")
    assert mesh.element_volumes.sum() == pytest.approx(SOLID, rel=1e-3)
    assert list(mesh.surfaces) == ["input"]


def test_a_bolted_cover_is_not_doubted_for_being_bolted(gearwhine: Any) -> None:
    """Its elements and the body's do not match where they lie on each other; the bolts are what joins them."""
    outcome = gearwhine("mesh", "ribbed-box", "-o", "out", "--json", "-q", "--set", "housing.box.mesh_size=50 mm")
    assert outcome.code == 0, outcome.err
    assert sorted(outcome.document["volumes"]) == ["body", "cover"]
    assert "non-conforming" not in [warning["name"] for warning in outcome.document["warnings"]]


# What is wrong, the changes, and what the message must say.
WRONG: list[tuple[str, list[str], list[str]]] = [
    (
        "a plane that touches nothing",
        ['housing.support.base.plane.at="-33 mm"'],
        ["housing.support[0].plane", "the housing spans 0 to 0.15 m", "lies at 0 m"],
    ),
    (
        "a sensor in the cavity",
        ['housing.sensor.top.position=["0 mm", "75 mm", "0 mm"]'],
        ["housing.sensor[0].position", "within 13.9 mm of the surface", "(0, 75, 0) mm is not"],
    ),
    (
        "a box around nothing",
        ["housing.support.base.plane=", "housing.support.base.box=[[1, 1, 1], [2, 2, 2]]"],
        ["housing.support[0].box", "no facet of the surface lies in the box"],
    ),
    (
        "a surface without that name",
        ["housing.support.base.plane=", "housing.support.base.surface=inputs"],
        ["housing.support[0].surface", "did you mean 'input'", "got 'inputs'"],
    ),
    ("a wrong diameter", ['housing.seat.input.diameter="43 mm"'], ["housing.seat[0]", "no bore of 43 mm", "40 mm at"]),
    (
        "metres for millimetres",
        ["housing.seat.input.center=[-0.04, 0.075, -55]"],
        ["housing.seat[0]", "no bore of 40 mm around (-40, 75, -55000) mm"],
    ),
    ("elements of 25 m", ["housing.cad.mesh_size=25"], ["housing.cad.mesh_size", "200 mm", "did you mean 25 mm"]),
    ("elements of 10 µm", ['housing.cad.mesh_size="10 um"'], ["housing.cad.mesh_size", "1e+13", "at least 1.52 mm"]),
    ("no such file", ["housing.cad.file=none.step"], ["housing.cad.file", "an existing file", "none.step"]),
    ("a folder", ["housing.cad.file=."], ["housing.cad.file", "an existing file"]),
    ("an empty file", ["housing.cad.file=empty.step"], ["housing.cad.file", "empty.step: it is empty or broken"]),
    ("half a file", ["housing.cad.file=half.step"], ["housing.cad.file", "half.step: it is empty or broken"]),
    ("another kind of file", ["housing.cad.file=case.toml"], ["housing.cad.file", "its ending is none of .step"]),
    ("a region that is not there", ['housing.region=[{name="a",material="steel",volume="b"}]'], ["region[0].volume"]),
]


@pytest.mark.slow
@pytest.mark.parametrize(("changes", "said"), [row[1:] for row in WRONG], ids=[row[0] for row in WRONG])
def test_what_is_wrong_is_told_by_the_check(
    gearwhine: Any, case: Any, drawing: str, tmp_path: Path, changes: list[str], said: list[str]
) -> None:
    (tmp_path / "empty.step").touch()
    (tmp_path / "half.step").write_text(drawing[: len(drawing) // 2])
    path = case()
    before = sorted(tmp_path.iterdir())
    outcome = gearwhine("check", path, "-q", *(part for change in changes for part in ("--set", change)))
    assert outcome.code == 2, outcome.out
    for text in said:
        assert text in outcome.err
    assert "Traceback" not in outcome.err
    assert sorted(tmp_path.iterdir()) == before


def test_all_that_finds_no_place_is_told_at_once_and_before_solving(gearwhine: Any, case: Any, tmp_path: Path) -> None:
    wrong = ['housing.support.base.plane.at="-33 mm"', 'housing.sensor.top.position=["0 mm", "75 mm", "0 mm"]']
    outcome = gearwhine("modes", case(), "-o", "out", *(part for change in wrong for part in ("--set", change)))
    assert outcome.code == 2
    assert "2 problems in the case" in outcome.err
    assert "assembling" not in outcome.err
    assert not (tmp_path / "out").exists()


def test_a_mesh_that_few_computers_solve_is_doubted_by_the_check(gearwhine: Any) -> None:
    """Walls of 2.1e-3 m³ hold over 600 000 regular tetrahedra of 3 mm, with over 2.5 million degrees of freedom."""
    fine = gearwhine("check", "steel-box", "--json", "-q", "--set", "housing.box.mesh_size=3 mm").document
    assert "load" in [warning["name"] for warning in fine["warnings"]]
    assert "load" not in [one["name"] for one in gearwhine("check", "steel-box", "--json", "-q").document["warnings"]]


@pytest.mark.parametrize("size", ["0.1 mm", "3 m"])
@pytest.mark.parametrize("command", ["check", "modes"])
def test_a_box_of_absurd_elements_is_refused_before_it_is_meshed(gearwhine: Any, size: str, command: str) -> None:
    outcome = gearwhine(command, "steel-box", "-q", "--set", f"housing.box.mesh_size={size}")
    assert outcome.code == 2
    assert "housing.box.mesh_size: expected another size of elements; elements of" in outcome.err


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("modes", "4000", "housing.modes: expected what this model has; 4000 modes asked of"),
        (
            "frequency_limit",
            "1 Hz",
            "housing.frequency_limit: expected what this model has; the housing has no mode below",
        ),
    ],
)
def test_modes_that_the_model_does_not_have_are_told_by_their_key(
    gearwhine: Any, case: Any, key: str, value: str, said: str
) -> None:
    text = CAD.replace("modes = 4", f'{key} = "{value}"' if " " in value else f"{key} = {value}")
    outcome = gearwhine("modes", case(text), "-q")
    assert outcome.code == 2
    assert said in outcome.err


MESH = (
    STEEL
    + """
[housing]
material = "steel"
modes = 4
mesh = { file = "FILE", unit = "mm" }
"""
)


def test_a_mistaken_unit_is_named_where_it_makes_places_miss(gearwhine: Any, case: Any, tmp_path: Path) -> None:
    """The doubt about the unit is not lost with the failure that it causes."""
    assert gearwhine("mesh", case(), "-o", "out", "-q").code == 0
    mesh = read_mesh(tmp_path / "out" / "mesh.msh", unit=1e3)  # as numbers of millimetres
    write_mesh(mesh, tmp_path / "numbers.vtu")
    support = '[[housing.support]]\nname = "base"\nplane = { axis = "x", at = "-100 mm" }\nfixed = ["y"]\n'
    (tmp_path / "case.toml").write_text(MESH.replace("FILE", "numbers.vtu").replace('"mm"', '"m"') + support)
    for command in ("check", "modes"):
        outcome = gearwhine(command, "case.toml", "-q")
        assert outcome.code == 2
        assert "warning: the part is 200 m long; is the unit 'm'? With 'mm' it would be 200 mm" in outcome.err
        assert "housing.support[0].plane" in outcome.err
