"""Notebooks: those of the repository are their scripts', run in a kernel, and show objects as tables and figures."""

import json
import runpy
from pathlib import Path

import nbclient
import nbformat
import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
MAKER = runpy.run_path(str(ROOT / "scripts" / "make_notebooks.py"))
NAMES = MAKER["NAMES"]
EXECUTED = "operating_point"
"""Notebook that runs in a kernel; the code of all of them runs as scripts in the tests of the examples."""


@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_is_made_of_its_script(name: str) -> None:
    written = (ROOT / "docs" / "notebooks" / f"{name}.ipynb").read_text(encoding="utf-8")
    assert written == MAKER["text_of"](name), "renew it by scripts/make_notebooks.py"
    nbformat.validate(json.loads(written))


def test_a_notebook_runs_and_shows_tables_and_figures() -> None:
    notebook = nbformat.read(ROOT / "docs" / "notebooks" / f"{EXECUTED}.ipynb", as_version=4)
    folder = {"metadata": {"path": str(ROOT / "docs" / "notebooks")}}
    nbclient.NotebookClient(notebook, timeout=300, resources=folder).execute()
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    shown = [output.data for output in outputs if "data" in output]
    assert any("<table>" in data.get("text/html", "") for data in shown)
    assert any("image/png" in data for data in shown)
