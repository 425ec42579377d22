"""The bundled cases, what follows from a case without solving it, and a results folder as a page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearwhine.case import Case, CaseError, Problem, bundled_cases, bundled_files
from gearwhine.output import staging
from gearwhine.output.sections import Column, Document, Section, table_of
from gearwhine.progress import Progress, silent

if TYPE_CHECKING:
    from gearwhine.analyses.result import Result
    from gearwhine.solve.case_summary import CheckedCase


def check(case: Case, *, progress: Progress = silent) -> Result[CheckedCase]:
    """Derive what follows from a case by arithmetic: ratios, mesh frequencies, contact ratios, sizes.

    Parameters
    ----------
    case : Case
    progress : callable
        Told where the file of a geometry is read.

    Raises
    ------
    CaseError, housing.HousingError, rotors.RotorError, coupling.CouplingError
        Where something in the case cannot be built.
    """
    from gearwhine.analyses.result import Result
    from gearwhine.output.quantity import document_of
    from gearwhine.results.check import CHECK
    from gearwhine.solve.case_summary import check_case

    checked = check_case(case, progress)
    return Result("check", case, checked, document_of(CHECK, checked))


def list_examples() -> dict[str, Any]:
    """Return the names and titles of the bundled cases."""
    return {"examples": [{"name": name, "title": title} for name, title in bundled_cases().items()]}


def sections(document: Document) -> tuple[Section, ...]:
    """Return the bundled cases as a table."""
    columns = (Column("name", "name"), Column("what it is", "title"))
    usage = ("Run one:   gearwhine run NAME", "Change one: gearwhine examples copy NAME")
    return (Section("", (*table_of(columns, document["examples"]), *usage)),)


def copy_example(name: str | None, folder: Path) -> dict[str, Any]:
    """Copy a bundled case into a folder, with the files that it reads; none of their names may stand there yet."""
    known = ", ".join(bundled_cases())
    sources = bundled_files(name) if name is not None else ()
    if not sources:
        raise CaseError([Problem("examples copy", name, f"one of: {known}")])
    taken = [str(folder / source.name) for source in sources if (folder / source.name).exists()]
    if taken:
        expected = "a place where no file of that name stands yet"
        raise CaseError([Problem("examples copy", target, expected) for target in taken])
    with staging(folder) as place:
        for source in sources:
            (place / source.name).write_bytes(source.read_bytes())
    return {"folder": str(folder), "files": [source.name for source in sources]}


def report_case(case: Case, folder: Path) -> dict[str, Any]:
    """Write the results in a folder as one HTML page, which marks those that no longer fit the case."""
    return _report(folder, case)


def report_folder(folder: Path, *, other: Path | None = None) -> dict[str, Any]:
    """Write the results in a folder as one HTML page; those that do not fit the case of the newest are marked.

    Parameters
    ----------
    folder : path
        Of results.
    other : path, optional
        Another folder that is asked for.

    Raises
    ------
    CaseError
        Where two folders are given, or the folder holds no results.
    """
    if other is not None:
        raise CaseError([Problem("--output", str(other), f"none beside the results folder {str(folder)!r}")])
    return _report(folder, None)


def _report(folder: Path, case: Case | None) -> dict[str, Any]:
    from gearwhine.output.html import report_page
    from gearwhine.results import chapters_of

    page = report_page(folder, chapters_of, case)
    with staging(folder) as place:
        (place / "report.html").write_text(page, encoding="utf-8")
    return {"folder": str(folder), "files": ["report.html"]}
