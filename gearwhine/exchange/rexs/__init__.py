"""Gear units from REXS files, the exchange format of FVA for gear units, schema versions 1.0 to 1.7 and 2.0.0.

:func:`read_rexs` reads a file, :func:`case_of` makes a case of it. The schema is described at https://www.rexs.info.
"""

from gearwhine.exchange.rexs.errors import RexsError, RexsProblem
from gearwhine.exchange.rexs.importing import ImportedCase, case_of
from gearwhine.exchange.rexs.model import RexsModel
from gearwhine.exchange.rexs.notes import Note
from gearwhine.exchange.rexs.reading import read_content, read_rexs

__all__ = [
    "ImportedCase",
    "Note",
    "RexsError",
    "RexsModel",
    "RexsProblem",
    "case_of",
    "read_content",
    "read_rexs",
]
