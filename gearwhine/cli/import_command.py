"""Command that makes a case of a gear unit in another program's file: import."""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from gearwhine.cli.common import Common, hand_over

if TYPE_CHECKING:
    from gearwhine.exchange.rexs import ImportedCase
    from gearwhine.output.sections import Document, Section


def import_(
    file: Annotated[str, Parameter(help="A gear unit in a REXS file: .rexs, .rexsj or .rexsz.")],
    *,
    output: Annotated[
        Path | None,
        Parameter(name=["--output", "-o"], help="Case file to write. Default: the file's name with .toml, here."),
    ] = None,
    load_case: Annotated[
        str, Parameter(name=["--load-case"], help="Number of the load case of a load spectrum. Default: the first.")
    ] = "",
    housing: Annotated[
        Path | None,
        Parameter(name=["--housing"], help="Reduced stiffness (and mass) of the housing, a seat under each bearing."),
    ] = None,
    mass: Annotated[
        Path | None, Parameter(name=["--mass"], help="Reduced mass of the housing, where it is in another file.")
    ] = None,
    mapping: Annotated[
        Path | None,
        Parameter(name=["--mapping"], help="Nodes of the matrices' rows. Default: .dof, .mapping or .pch beside them."),
    ] = None,
    json: Annotated[bool, Parameter(name="--json", negative=(), help="Print one JSON document and nothing else.")] = (
        False
    ),
    quiet: Annotated[bool, Parameter(name=["--quiet", "-q"], negative=(), help="As of all commands.")] = False,
) -> None:
    """Make a case of a gear unit in a REXS file, and list what was assumed, changed and left out.

    The case is checked as it is written: where it cannot be solved as it stands, the file is there to be completed.
    """
    from gearwhine.output.terminal import shown_by

    hand_over(
        _import(file, output, load_case, housing, mass, mapping), Common(json=json, quiet=quiet), shown_by(_sections)
    )


def _import(
    file: str,
    output: Path | None,
    load_case: str,
    housing: Path | None,
    mass: Path | None,
    mapping: Path | None,
) -> dict[str, Any]:
    from gearwhine.case import CaseError, Problem
    from gearwhine.case import load_case as read_case
    from gearwhine.case.load import imported_case, read_rexs_file
    from gearwhine.exchange.file_names import bare_name
    from gearwhine.output import staging
    from gearwhine.output.quantity import document_of
    from gearwhine.results.check import IMPORTED

    target = Path(f"{bare_name(file)}.toml") if output is None else output
    if target.suffix != ".toml":
        raise CaseError([Problem("--output", str(target), "a case file, which ends in .toml")])
    if target.exists():
        raise CaseError([Problem("--output", str(target), "a place where no file of that name stands yet")])
    imported = imported_case(*read_rexs_file(file), load_case)
    if "housing" in imported.document:
        # The matrix of the casing stays in the file: the case names it by the way from its own folder.
        way = os.path.relpath(file, target.parent)
        imported.document["housing"]["reduced"]["stiffness"] = Path(way).as_posix()
    for option, given in (("--mass", mass), ("--mapping", mapping)):
        if given is not None and housing is None:
            raise CaseError([Problem(option, str(given), "--housing beside it")])
    if housing is not None:
        from gearwhine.from_case.housing_of_matrices import with_reduced_housing

        imported = with_reduced_housing(imported, housing, mass, target.parent, mapping)
    with staging(target.parent, listed=False) as place:  # the case is the user's
        (place / target.name).write_text(imported.toml, encoding="utf-8")
    try:
        warnings = read_case(target).warnings
    except CaseError as error:
        error.add_note(f"{target} is written; it is to be completed:")
        raise
    return {
        "folder": str(target.parent),
        "files": [target.name],
        "case": str(target),
        **_summary(imported),
        "imported": document_of(IMPORTED, imported),
        "warnings": [{"key": "case", "message": message} for message in warnings],
    }


def _summary(imported: "ImportedCase") -> dict[str, Any]:
    """Return the number of parts by table of the case, what it has not, and values that the file does not have."""
    from gearwhine.case.errors import NOTHING, key_of, look_up

    def value(place: tuple[str | int, ...]) -> object:
        found = look_up(imported.document, place) if place else NOTHING
        return None if found is NOTHING else found

    notes = imported.notes
    return {
        "taken": {kind: len(entries) for kind, entries in imported.document.items() if isinstance(entries, list)},
        "left_out": [{"component": one.about, "why": one.text} for one in notes if one.kind == "left out"],
        "assumed": [
            {"key": key_of(one.at) if one.at else "", "value": value(one.at), "why": f"{one.about}: {one.text}"}
            for one in notes
            if one.kind == "assumed"
        ],
    }


def _sections(document: "Document") -> "tuple[Section, ...]":
    """Return what was imported, and the warnings of the case."""
    from gearwhine.output.sections import Section
    from gearwhine.results.check import imported_lines

    first, *lines = imported_lines(document["imported"])
    warnings = tuple(f"warning: {one['message']}" for one in document["warnings"])
    return (Section("Imported", tuple(lines), note=f" {first}"), *((Section("", warnings),) if warnings else ()))
