"""gmsh comes late, leaves always, and is missed politely."""

import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from gearwhine.meshes import BoxGeometry, GeometryError, WallThickness, mesh_box
from gearwhine.meshes.gmsh_meshing import SYSTEM_PACKAGES, gmsh_session


def _run(script: str) -> subprocess.CompletedProcess[str]:
    command = "import sys; sys.path[:0] = " + repr(sys.path) + "\n" + textwrap.dedent(script)
    return subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, timeout=60, check=False)


def test_a_gmsh_that_cannot_be_loaded_is_answered_with_the_packages_to_install() -> None:
    done = _run("""
        class Blocker:
            def find_spec(self, name, path=None, target=None):
                if name == "gmsh":
                    raise OSError("libGLU.so.1: cannot open shared object file: No such file or directory")
        sys.meta_path.insert(0, Blocker())
        from gearwhine.meshes import BoxGeometry, WallThickness, mesh_box
        from gearwhine.meshes.errors import MesherUnavailableError
        try:
            mesh_box(BoxGeometry((0.2, 0.2, 0.2), WallThickness.uniform(0.02)), 0.1)
        except MesherUnavailableError as error:
            print(error)
    """)
    assert "libGLU.so.1" in done.stdout, done.stderr
    assert all(package in done.stdout for package in SYSTEM_PACKAGES)


def test_failures_of_gmsh_become_ours_and_the_session_ends() -> None:
    with pytest.raises(GeometryError, match="gmsh could not mesh nothing"), gmsh_session("nothing") as gmsh:
        gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, 0, 1)
    assert not gmsh.isInitialized()


def test_errors_of_the_caller_pass_through_and_the_session_ends() -> None:
    with pytest.raises(KeyError), gmsh_session("nothing") as gmsh:
        raise KeyError("x")
    assert not gmsh.isInitialized()


def test_gmsh_says_nothing_and_works_again_after_a_failure(capfd: pytest.CaptureFixture[str]) -> None:
    mesh_box(BoxGeometry((0.2, 0.2, 0.2), WallThickness.uniform(0.03)), 0.1)
    captured = capfd.readouterr()
    assert captured.out == captured.err == ""


def test_the_script_for_system_libraries_finds_what_it_imports() -> None:
    """It is the first of ours that runs on a new machine, before any test."""
    script = (Path(__file__).parents[2] / "scripts" / "system_libraries.sh").read_text(encoding="utf-8")
    code = script.split("<<'PY'\n")[1].split("\nPY\n")[0]
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
