"""The worked examples under `scripts/examples`, each run once as a program."""

import runpy
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from gearwhine.from_case import mesh

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "scripts" / "examples"

Example = Callable[..., dict[str, Any]]


@pytest.fixture(scope="module", autouse=True)
def _less_effort(solved_once: None, mechanisms_left_out: None, few_points: None) -> None:
    """Solve nothing again that another test has solved, and nothing that no example looks at."""


@pytest.fixture
def larger_elements(monkeypatch: pytest.MonkeyPatch) -> None:
    """Mesh boxes by elements of at least 60 mm, for examples whose statements do not depend on them."""
    mesh_box = mesh.mesh_box
    monkeypatch.setattr(mesh, "mesh_box", lambda box, size, **how: mesh_box(box, max(size, 0.06), **how))


@pytest.fixture
def example(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Example:
    """``example("run_up", "figure.png")``: run the program with a file or folder to write; its names afterwards."""

    def run(name: str, output: str | None = None) -> dict[str, Any]:
        path = EXAMPLES / f"{name}.py"
        arguments = [] if output is None else [str(tmp_path / output)]
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", [str(path), *arguments])
        found = runpy.run_path(str(path), run_name="__main__")
        if output is not None:
            written = tmp_path / output
            assert any(written.iterdir()) if written.is_dir() else written.stat().st_size > 10_000
        return found

    return run
