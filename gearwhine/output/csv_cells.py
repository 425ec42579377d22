"""Cells of CSV files that no spreadsheet takes for a formula.

Programs run a cell that begins with ``=``, ``+``, ``-``, ``@``, a tab or a line end as a formula, and names of a case
may. Such a cell begins with an apostrophe here, which spreadsheets take for the mark of a text (OWASP, CSV injection).
"""

import re
from collections.abc import Iterable

_FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n")
# A signed number, and behind it a unit or words at most: nothing that calculates, calls or quotes.
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+|inf|nan)([eE][+-]?\d+)?( [^=+\-@*/^&|!'\"(){}\[\];:<>\t\r\n]*)?")


def plain_cell(cell: object) -> object:
    """Return a cell as it is written: a number as it is, a text that would be a formula behind an apostrophe."""
    if not isinstance(cell, str) or not cell.startswith(_FORMULA) or _NUMBER.fullmatch(cell):
        return cell
    return f"'{cell}"


def plain_cells(row: Iterable[object]) -> list[object]:
    """Return a row of cells, each as :func:`plain_cell` writes it."""
    return [plain_cell(cell) for cell in row]
