"""Tables that are set on pages while the site is built: keys of a case, options of commands, published values."""

import json
import sys
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "scripts"))

import reference_pages  # noqa: E402

_VALUES = "| quantity | published | ours | unit | difference | tolerance |\n|---|---:|---:|---|---:|---:|"


def validation(page: str) -> str:
    """The page of the validation with a table of the values of each source, in place of its mark."""
    sources = json.loads((ROOT / "docs" / "validation.json").read_text(encoding="utf-8"))
    parts = []
    for source, rows in sources.items():
        parts.append("\n".join([f"### {source}\n", _VALUES, *("| " + " | ".join(row) + " |" for row in rows)]))
    return page.replace("<!-- values -->", "\n\n".join(parts))


FILLED: dict[str, Callable[[str], str]] = {
    "docs/case-file": reference_pages.case_file,
    "docs/commands": reference_pages.commands,
    "docs/validation": validation,
}
"""Functions from the text of a page as it stands in the tree to that of the site, by the name of the page."""
