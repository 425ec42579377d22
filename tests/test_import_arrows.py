"""The rooms' arrows: meshes -> housing -> coupling <- rotors, and gearwhine in front of all."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
ALLOWED = {
    "meshes": set(),
    "rotors": set(),
    "housing": {"meshes"},
    "coupling": {"housing", "rotors"},
    "gearwhine": {"meshes", "rotors", "housing", "coupling"},
}


def imported_rooms(path: Path) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            names.add(node.module.split(".")[0])
    return names & set(ALLOWED)


@pytest.mark.parametrize("room", ALLOWED)
def test_a_room_imports_only_what_its_arrows_allow(room: str) -> None:
    files = sorted((ROOT / room).rglob("*.py"))
    assert files, f"{room} has no modules"
    for path in files:
        forbidden = imported_rooms(path) - ALLOWED[room] - {room}
        assert not forbidden, f"{path.relative_to(ROOT)} imports {sorted(forbidden)}"


def loaded_after(statement: str) -> set[str]:
    code = f"{statement}\nimport sys\nprint(' '.join(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    return {name.split(".")[0] for name in done.stdout.split()}


@pytest.mark.parametrize("room", ["meshes", "housing", "rotors", "coupling", "coupling.gears"])
def test_importing_a_room_brings_neither_mesher_nor_renderer_nor_compiler(room: str) -> None:
    heavy = {"gmsh", "vtkmodules", "pyvista", "matplotlib", "numba", "pydantic"}
    assert not loaded_after(f"import {room}") & heavy


def test_help_imports_nothing_that_takes_long() -> None:
    heavy = {"gmsh", "vtkmodules", "pyvista", "matplotlib", "numba", "scipy", "numpy", "pint", "xarray", "skfem"}
    statement = "from gearwhine.cli import run_command\nassert run_command(['--help']) == 0"
    code = f"{statement}\nimport sys\nprint(' '.join(sorted(sys.modules)), file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert "Usage" in done.stdout
    assert not {name.split(".")[0] for name in done.stderr.split()} & heavy
