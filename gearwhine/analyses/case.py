"""The bundled cases, and a results folder as a page."""

from pathlib import Path
from typing import Any

from gearwhine.case import Case, CaseError, Problem, bundled_case, bundled_cases
from gearwhine.output import staging
from gearwhine.output.sections import Column, Document, Section, table_of


def list_examples() -> dict[str, Any]:
    """Return the names and titles of the bundled cases."""
    return {"examples": [{"name": name, "title": title} for name, title in bundled_cases().items()]}


def sections(document: Document) -> tuple[Section, ...]:
    """Return the bundled cases as a table."""
    columns = (Column("name", "name"), Column("what it is", "title"))
    usage = ("Run one:   gearwhine run NAME", "Change one: gearwhine examples copy NAME")
    return (Section("", (*table_of(columns, document["examples"]), *usage)),)


def copy_example(name: str | None, folder: Path) -> dict[str, Any]:
    """Copy a bundled case into a folder; a file of that name there is left alone."""
    known = ", ".join(bundled_cases())
    source = bundled_case(name) if name is not None else None
    if source is None:
        raise CaseError([Problem("examples copy", name, f"one of: {known}")])
    target = folder / source.name
    if target.exists():
        raise CaseError([Problem("examples copy", str(target), "a place where no file of that name stands yet")])
    content = source.read_text(encoding="utf-8")
    with staging(folder) as place:
        (place / source.name).write_text(content, encoding="utf-8")
    return {"folder": str(folder), "files": [source.name]}


def report_case(case: Case, folder: Path) -> dict[str, Any]:
    """Write the results in a folder as one HTML page, which marks those that no longer fit the case."""
    from gearwhine.output.html import report_page
    from gearwhine.results.chapters import chapters_of

    page = report_page(folder, chapters_of, case)
    with staging(folder) as place:
        (place / "report.html").write_text(page, encoding="utf-8")
    return {"folder": str(folder), "files": ["report.html"]}
