"""The documentation's Python runs, and shows the same code as the worked examples."""

import ast
import importlib
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "scripts" / "examples"


def blocks(page: str) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```$", (ROOT / page).read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def body(example: str) -> str:
    """The code of an example below its docstring."""
    text = (EXAMPLES / example).read_text(encoding="utf-8")
    after = ast.parse(text).body[1].lineno
    return "".join(text.splitlines(keepends=True)[after - 1 :])


def test_readme_and_tutorial_show_the_first_example() -> None:
    assert blocks("README.md") == [body("first_steps.py")]
    assert blocks("docs/tutorial.md")[0] == body("first_steps.py")


def test_every_example_is_short_and_listed() -> None:
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    for path in sorted(EXAMPLES.glob("*.py")):
        assert len(path.read_text(encoding="utf-8").splitlines()) <= 40, path.name
        assert f"(../scripts/examples/{path.name})" in page


def test_links_of_the_pages_lead_to_files() -> None:
    for page in [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]:
        for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
            assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_every_page_is_in_the_index() -> None:
    index = (ROOT / "docs" / "README.md").read_text(encoding="utf-8")
    for path in (ROOT / "docs").glob("*.md"):
        assert path.name == "README.md" or f"({path.name})" in index, path.name


def test_the_page_on_python_runs(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": "__main__"}
    for block in blocks("docs/python.md"):
        exec(compile(block, "docs/python.md", "exec"), names)  # noqa: S102 - the page is ours
    assert (tmp_path / "results" / "results.nc").is_file()
    assert names["machine"].mesh_frequencies[0] == pytest.approx(28 * 5500 / 60)
    # Torque over base radius, of 28 teeth at module 3.175 mm and 20 degrees.
    mean = 71.77 / (3.175e-3 * 28 / 2 * np.cos(np.radians(20.0)))
    assert float(names["force"].mean()) == pytest.approx(mean, rel=5e-3)


def test_the_page_on_the_report_runs(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    (block,) = blocks("docs/report.md")
    names: dict[str, Any] = {"__name__": "__main__"}
    exec(compile(block, "docs/report.md", "exec"), names)  # noqa: S102 - the page is ours
    assert names["page"] == Path("out", "report.html")
    assert "<h2 id=" in names["page"].read_text(encoding="utf-8")


def test_files_that_contributing_names_exist() -> None:
    """A path in the tables of the tree is that of a file or folder."""
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    places = re.findall(r"`([\w./-]+/[\w.-]+)`", page)
    assert len(places) >= 40
    assert not [place for place in places if not (ROOT / place).exists() and not place.startswith(".venv")]


def test_names_of_the_glossary_exist() -> None:
    """Every row names a module and something in it."""
    page = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")
    rows = [line for line in page.splitlines() if line.startswith("| ") and not line.startswith("| term")]
    assert len(rows) >= 60
    for row in rows:
        module, _, name = row.split("`")[1].rpartition(".")
        assert hasattr(importlib.import_module(module), name), row
