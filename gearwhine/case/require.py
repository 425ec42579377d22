"""Required tables: the error for a table that a command needs and a case lacks."""

from __future__ import annotations

from gearwhine.case.model import Case
from gearwhine.case.problems import NOTHING, CaseError, Problem

_LISTS = ("rotor", "bearing", "gear", "gear_pair")
_PURPOSES = {
    "housing": "the box, CAD or mesh file whose modes are wanted",
    "rotor": "at least one shaft",
    "bearing": "at least one bearing",
    "gear": "at least one gear",
    "gear_pair": "at least one pair of gears",
    "operation": "a speed such as speed = '5500 rpm'",
    "transient": "a length of run such as revolutions = 40",
    "sweep": "speeds such as speed = { from = '1500 rpm', to = '6000 rpm', step = '250 rpm' }",
    "measured": "frequencies such as ['658 Hz', '1049 Hz'], or a file of them",
    "update": "what is fitted, such as [[update.parameter]] name = 'top', keys = ['housing.box.wall.top']",
}


def require(case: Case, *tables: str, command: str) -> None:
    """Raise where a case lacks tables that a command needs.

    Parameters
    ----------
    case
        The case.
    tables
        Keys of the top level, such as ``"housing"``.
    command
        Command that needs them, for the message.

    Raises
    ------
    CaseError
        With a problem for each table that is missing.
    """
    missing = [table for table in tables if not getattr(case, table)]
    if missing:
        raise CaseError(_lacking(table, command) for table in missing)


def _lacking(table: str, command: str) -> Problem:
    shown = f"[[{table}]]" if table in _LISTS else f"[{table}]"
    purpose = _PURPOSES.get(table, "its table")
    return Problem(table, NOTHING, f"{purpose}: '{command}' needs {shown}, which this case does not have")
