"""Writes notebooks of worked examples from their scripts: docs/notebooks/NAME.ipynb from scripts/examples/NAME.py.

The script's docstring becomes the title, and groups of lines between blank ones become cells, of which the imports are
one. A cell that makes one of the objects that notebooks show as tables ends by showing it. What a script does with its
arguments, at its end, is left out: its figure is shown in place.
"""

import ast
import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES, NOTEBOOKS = ROOT / "scripts" / "examples", ROOT / "docs" / "notebooks"
NAMES = ("operating_point", "two_shafts_to_a_spectrum", "compare_and_update")

_SHOWN = ("study", "machine", "point", "fit")
_NAMED_FILE = 'Path(__file__).with_name("{}")'


def notebook(name: str) -> dict[str, Any]:
    """Return the notebook of an example, without outputs."""
    source = (EXAMPLES / f"{name}.py").read_text(encoding="utf-8")
    module = ast.parse(source)
    title = (ast.get_docstring(module) or name).split("\n\n")
    cells = [_cell("markdown", "\n\n".join([f"# {title[0].rstrip('.')}", *title[1:]]))]
    for group in _groups(source, module.body[1:]):
        cells.append(_cell("code", "\n".join(group)))
    cells[1]["source"] = "%matplotlib inline\n" + cells[1]["source"]
    for number, cell in enumerate(cells):
        cell["id"] = f"cell-{number}"
        for file in EXAMPLES.glob("*.toml"):
            near = f'Path("../../scripts/examples/{file.name}")'
            cell["source"] = cell["source"].replace(_NAMED_FILE.format(file.name), near)
        cell["source"] = cell["source"].splitlines(keepends=True)
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}


def _groups(source: str, statements: Sequence[ast.stmt]) -> Iterator[list[str]]:
    """Yield the lines of each cell."""
    lines = source.splitlines()
    group: list[str] = []
    shown = ""
    end = statements[0].lineno - 1
    importing = True
    for statement in statements:
        first, last = statement.lineno - 1, statement.end_lineno or statement.lineno
        is_import = isinstance(statement, ast.Import | ast.ImportFrom)
        if group and any(not line.strip() for line in lines[end:first]) and not (importing and is_import):
            yield group + ([shown] if shown else [])
            group, shown = [], ""
        importing = importing and is_import
        if "sys.argv" in (ast.get_source_segment(source, statement) or ""):
            shown = "figure"
        elif not is_import or "sys" not in (one.name for one in statement.names):
            group += [line for line in lines[end:first] if line.startswith("#")] + lines[first:last]
            shown = next((name for name in _assigned(statement) if name in _SHOWN), shown)
        end = last
    yield group + ([shown] if shown else [])


def _assigned(statement: ast.stmt) -> list[str]:
    targets = statement.targets if isinstance(statement, ast.Assign) else []
    return [target.id for target in targets if isinstance(target, ast.Name)]


def _cell(kind: str, source: str) -> dict[str, Any]:
    more = {"execution_count": None, "outputs": []} if kind == "code" else {}
    return {"cell_type": kind, "id": "", "metadata": {}, "source": source} | more


def text_of(name: str) -> str:
    """Return the notebook's file."""
    return json.dumps(notebook(name), indent=1, ensure_ascii=False) + "\n"


def main() -> int:
    """Write all notebooks."""
    NOTEBOOKS.mkdir(exist_ok=True)
    for name in NAMES:
        (NOTEBOOKS / f"{name}.ipynb").write_text(text_of(name), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
