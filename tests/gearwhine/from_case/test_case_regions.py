"""`[[housing.region]]`: parts of the housing in another material, and every way to get them wrong."""

import copy
import json
import tomllib
from collections.abc import Callable
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from case_housings import materials_on
from scipy.optimize import brentq

from gearwhine.case import CaseError, load_case, parse_case
from gearwhine.cli import run_command
from gearwhine.meshes import Mesh, write_mesh

BOX = tomllib.loads(files("gearwhine.cases").joinpath("steel-box.toml").read_text(encoding="utf-8"))
COVER = {"name": "cover", "material": "aluminium", "box": [[-1.0, "150 mm", -1.0], [1.0, "170 mm", 1.0]]}
ALUMINIUM = {"youngs_modulus": "70 GPa", "poisson_ratio": 0.33, "density": "2700 kg/m^3"}


def _case(*regions: dict[str, Any]) -> dict[str, Any]:
    document = copy.deepcopy(BOX)
    document["material"]["aluminium"] = ALUMINIUM
    document["housing"]["region"] = list(regions)
    return document


def _problems(*regions: dict[str, Any]) -> list[str]:
    with pytest.raises(CaseError) as caught:
        parse_case(_case(*regions), source="case.toml")
    return str(caught.value).splitlines()


def test_a_sound_region_is_read_in_si() -> None:
    (region,) = parse_case(_case(COVER), source="case.toml").housing.region  # type: ignore[union-attr]
    assert region.box == ((-1.0, 0.15, -1.0), (1.0, 0.17, 1.0))
    assert region.material == "aluminium"


@pytest.mark.parametrize(
    ("change", "key", "expected"),
    [
        ({"material": "aluminum"}, "housing.region[0].material", "did you mean 'aluminium'?"),
        ({"volume": "lid"}, "housing.region[0]", "exactly one of 'volume' and 'box'"),
        ({"box": None}, "housing.region[0]", "exactly one of 'volume' and 'box'"),
        ({"name": None}, "housing.region[0].name", "nothing"),
        ({"box": [[0, 0, 0]]}, "housing.region[0].box", "[1]"),
        ({"box": [[0, 0, "3 kg"], [1, 1, 1]]}, "housing.region[0].box[0][2]", "(mass)"),
        ({"colour": "red"}, "housing.region[0].colour", "no such key"),
    ],
)
def test_each_mistake_is_named(change: dict[str, Any], key: str, expected: str) -> None:
    region = {name: value for name, value in (COVER | change).items() if value is not None}
    (line,) = _problems(region)
    assert key in line
    assert expected in line


def test_two_regions_of_one_name_are_refused() -> None:
    (line,) = _problems(COVER, COVER)
    assert "housing.region[1].name" in line
    assert "a name of its own (housing.region[0] has this one)" in line


def test_regions_that_do_not_fit_the_mesh_are_told_all_at_once(block_of: Callable[..., Mesh]) -> None:
    mesh = replace(block_of("hexahedron", (0.2, 0.16, 0.24), (4, 1, 1)), volumes={"lid": np.array([3])})
    half = {"material": "aluminium", "box": [[0, 0, 0], ["100 mm", 1.0, 1.0]]}
    regions = (
        {"name": "half", **half},
        {"name": "again", **half},
        {"name": "nowhere", "material": "aluminium", "box": [[5, 5, 5], [6, 6, 6]]},
        {"name": "cap", "material": "steel", "volume": "housing"},
    )
    with pytest.raises(CaseError) as caught:
        materials_on(parse_case(_case(*regions), source="case.toml"), mesh)
    keys = {problem.key: problem.expected for problem in caught.value.problems}
    assert set(keys) == {"housing.region[1].box", "housing.region[2].box", "housing.region[3].volume"}
    assert '2 of its 2 are in region "half" too' in keys["housing.region[1].box"]
    assert "0 to 200 x 0 to 160 x 0 to 240 mm" in keys["housing.region[2].box"]
    assert keys["housing.region[3].volume"] == "a volume of the mesh (lid)"


def _stepped_bar(stiffness: tuple[float, float], density: tuple[float, float], length: float) -> list[float]:
    """Natural frequencies [Hz] of a free bar of two equal halves in axial motion: Z₁ tan(ωl/c₁) + Z₂ tan(ωl/c₂) = 0.

    Each half has cos(ω x / c) from its free end; motion and force are those of the other half where they meet.
    """
    speeds = [np.sqrt(e / rho) for e, rho in zip(stiffness, density, strict=True)]
    impedances = [np.sqrt(e * rho) for e, rho in zip(stiffness, density, strict=True)]

    def condition(omega: float) -> float:
        (a, b), (za, zb) = [omega * length / 2 / c for c in speeds], impedances
        return float(za * np.sin(a) * np.cos(b) + zb * np.sin(b) * np.cos(a))

    grid = np.linspace(1.0, 2 * np.pi * 12000.0, 4000)
    signs = np.array([condition(omega) for omega in grid])
    roots = [brentq(condition, a, b) for a, b, s, t in zip(grid, grid[1:], signs, signs[1:], strict=False) if s * t < 0]
    return [float(root / (2 * np.pi)) for root in roots]


@pytest.mark.parametrize("by", ["volume", "box"])
def test_a_bar_of_two_materials_has_the_modes_of_the_stepped_bar(
    block_of: Callable[..., Mesh], tmp_path: Path, capsys: pytest.CaptureFixture[str], by: str
) -> None:
    """Held against all but axial motion, with ν = 0; mass, its centre and frequencies are closed forms."""
    length, side = 1.0, 0.05
    mesh = block_of("hexahedron20", (length, side, side), (24, 1, 1))
    mesh = replace(mesh, volumes={"steel half": np.arange(12), "light half": np.arange(12, 24)})
    write_mesh(mesh, tmp_path / "bar.msh")
    region = 'volume = "light half"' if by == "volume" else 'box = [["500 mm", -1.0, -1.0], [2.0, 1.0, 1.0]]'
    (tmp_path / "bar.toml").write_text(f"""
[material.heavy]
youngs_modulus = "200 GPa"
poisson_ratio = 0.0
density = "8000 kg/m^3"
[material.light]
youngs_modulus = "50 GPa"
poisson_ratio = 0.0
density = "3000 kg/m^3"
[housing]
material = "heavy"
modes = 4
mesh = {{ file = "bar.msh" }}
[[housing.region]]
name = "light half"
material = "light"
{region}
[[housing.support]]
name = "guide"
box = [[-1.0, -1.0, -1.0], [2.0, 1.0, 1.0]]
fixed = ["y", "z"]
""")
    assert run_command(["modes", str(tmp_path / "bar.toml"), "--json", "-q"]) == 0
    document = json.loads(capsys.readouterr().out)
    found = [mode["frequency_hz"] for mode in document["modes"][:4]]
    expected = [0.0, *_stepped_bar((200e9, 50e9), (8000.0, 3000.0), length)[:3]]
    assert found == pytest.approx(expected, rel=3e-5, abs=1e-3)
    half = side**2 * length / 2
    assert document["mass_kg"] == pytest.approx(half * (8000 + 3000))
    center = [(8000 * 0.25 + 3000 * 0.75) / 11000, side / 2, side / 2]
    assert document["center_of_mass_m"] == pytest.approx(center)


def test_the_check_says_which_region_is_of_what(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = files("gearwhine.cases").joinpath("steel-box.toml").read_text(encoding="utf-8")
    text += '\n[[housing.region]]\nname = "cover"\nmaterial = "steel"\nbox = [[-1, 0.15, -1], [1, 1, 1]]\n'
    text = (
        text.replace("[provenance]\n", "")
        .replace('"material.*" = "nominal"\n', "")
        .replace('"housing.*" = "nominal"\n', "")
    )
    (tmp_path / "case.toml").write_text(text)
    assert load_case(str(tmp_path / "case.toml")).case.housing is not None
    assert run_command(["check", str(tmp_path / "case.toml"), "-q", "-v"]) == 0
    assert "regions: cover of steel" in capsys.readouterr().out
