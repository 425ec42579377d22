"""Page of a report: a first page that sums up, contents at the side, and each command's results, newest first.

The static form has no script at all. It prints as it reads, and follows the reader's choice of light or dark.
"""

import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

from gearwhine import __version__
from gearwhine.case import Case, CaseError, Problem, dump_case
from gearwhine.output.files import SUMMARY
from gearwhine.output.report.elements import Places, Writer, worded
from gearwhine.output.report.freshness import mismatches, moment, stored_case
from gearwhine.output.report.interactive import MovingShape, Scripts, live_parts
from gearwhine.output.report.pictures import Shown, distribute, figure, pictures_in
from gearwhine.output.sections import Document, Section
from gearwhine.output.store import stored_results

_POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"
_SUMMARY, _SHAPES = "summary", "shapes"


@dataclass(frozen=True)
class Contents:
    """Makers of a report's content.

    Attributes
    ----------
    chapters : callable
        Returns the chapters of a command's document.
    first_page : callable, optional
        Returns the sections of the first page from the case, all documents, and sentences on results that do not fit
        the case any more. The first existing picture of those that the sections declare is shown.
    """

    chapters: Callable[[Document], Iterable[Section]]
    first_page: Callable[[Case | None, Sequence[Document], Sequence[str]], Sequence[Section]] | None = None


@dataclass(frozen=True, eq=False)
class _Result:
    """Results of one command: their folder, document, chapters, and remarks on what no longer fits the case.

    ``repeated`` are the titles of chapters that another result shows as well.
    """

    place: Path
    document: Mapping[str, Any]
    chapters: tuple[Section, ...]
    stale: tuple[str, ...]
    repeated: frozenset[str] = frozenset()

    @property
    def command(self) -> str:
        command = self.document.get("command")
        return command if isinstance(command, str) else ""

    @property
    def heading(self) -> str:
        return f"gearwhine {self.command}" if self.command else "Results"

    @cached_property
    def name(self) -> str:
        """Name in links: no two results of a folder stand in one place."""
        return self.command or self.place.name

    @cached_property
    def pictures(self) -> tuple[dict[int, list[Shown]], list[Path]]:
        """Pictures by section, and those that none declares."""
        return distribute(self.chapters, pictures_in(self.place))


def report_page(
    folder: Path, contents: Contents, case: Case | None = None, *, shapes: Sequence[MovingShape] | None = None
) -> str:
    """Return all results in a folder as HTML, the newest first, each with its time and whether it fits the case.

    Parameters
    ----------
    folder : path
        Output folder of one command or several.
    contents : Contents
        Makers of the first page, and of the chapters of a command's document.
    case : Case, optional
        Case with which the case of each result is compared; by default that of the newest result.
    shapes : sequence of MovingShape, optional
        Shapes of the interactive form, which also draws curves and sorts tables; None makes the static one.

    Raises
    ------
    CaseError
        Where the folder holds no results, or a summary cannot be read.
    """
    stored = _stored(folder)
    present = stored_case(folder / stored[0][0]) if case is None else tomllib.loads(dump_case(case))
    results = [_result(folder / place, document, present, contents) for place, document in stored]
    title = str(results[0].document.get("title") or (present or {}).get("title") or folder.name)
    places = Places()
    first = (
        ()
        if contents.first_page is None
        else contents.first_page(case, [one.document for one in results], _stale(results))
    )
    titled = [section for section in first if section.title]
    places.add(_SUMMARY, _SUMMARY)
    places.add_sections(_SUMMARY, titled, {})
    results = _folded(results)
    for result in results:
        places.add(result.name, result.heading)
        places.add_sections(result.name, result.chapters, result.pictures[0])
        for path in result.pictures[1]:
            places.add(result.name, Shown(path, "").place)
    scripts = None if shapes is None else Scripts(shapes)
    for shape in shapes or ():
        places.add(_SHAPES, shape.place)
    body = (
        f"<h1>{escape(title)}</h1>\n"
        f'<p class="note">Report of gearwhine {escape(__version__)}; amplitudes are peaks unless they say rms.</p>\n'
        + _first_page(first, results, places)
        + ("" if scripts is None else _moving(scripts, places))
        + "".join(_chapters(result, places, scripts) for result in results)
    )
    listed = _contents(titled, results, places, moving=bool(shapes))
    policy = _POLICY if scripts is None else scripts.policy()
    at_the_end = "" if scripts is None else scripts.written()
    folded = f'<nav class="contents" aria-label="Contents"><details><summary>Contents</summary>{listed}</details></nav>'
    style = (files(__package__) / "style.css").read_text(encoding="utf-8")
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}"><style>\n{style}</style></head><body>\n'
        f'<nav class="side" aria-label="Contents">{listed}</nav>\n<main>{folded}\n{body}</main>\n'
        f"{at_the_end}</body></html>\n"
    )


def _stored(folder: Path) -> list[tuple[Path, Mapping[str, Any]]]:
    expected = f"a results folder with {SUMMARY}, as `gearwhine run CASE -o {folder}` leaves it"
    results = stored_results(folder)
    if (folder / SUMMARY).exists() and not any(place == Path() for place, _ in results):
        raise CaseError([Problem("report", str(folder / SUMMARY), f"{expected}; this one is damaged")])
    if not results:
        raise CaseError([Problem("report", str(folder), expected)])
    return results


def _result(place: Path, document: Mapping[str, Any], present: Mapping[str, Any] | None, contents: Contents) -> _Result:
    chapters = tuple(contents.chapters(document))
    if warnings := document.get("warnings"):
        messages = [str(entry.get("message", entry)) for entry in warnings if isinstance(entry, Mapping)]
        chapters = (Section("Warnings", tuple(messages)), *chapters)
    return _Result(place, document, chapters, tuple(mismatches(place, document, present)))


def _folded(results: Sequence[_Result]) -> list[_Result]:
    """Return the results with the chapters that another one shows as well told apart, with a note of where.

    A chapter of an analysis that a command includes gives way to that analysis' own results, and to newer ones.
    """
    folded = []
    for number, result in enumerate(results):
        chapters = []
        repeated = set()
        for section in result.chapters:
            elsewhere = next(
                (
                    other.heading
                    for place, other in enumerate(results)
                    for same in other.chapters
                    if place != number
                    and same.title == section.title
                    and (place < number or same.shows is other.document)
                    and _same_results(section, same)
                ),
                None,
            )
            if section.shows is not result.document and elsewhere is not None:
                section = replace(section, note=f"the same as under {elsewhere}")
                repeated.add(section.title)
            chapters.append(section)
        folded.append(replace(result, chapters=tuple(chapters), repeated=frozenset(repeated)))
    return folded


def _same_results(section: Section, other: Section) -> bool:
    """Whether all that a chapter shows stands in another one."""
    mine, theirs = section.shows, other.shows
    return mine is not None and theirs is not None and all(theirs.get(key) == value for key, value in mine.items())


def _stale(results: Sequence[_Result]) -> list[str]:
    return [
        f"{result.heading} does not fit the case any more: {remark}." for result in results for remark in result.stale
    ]


def _first_page(first: Sequence[Section], results: Sequence[_Result], places: Places) -> str:
    """Return the sections of the first page one below the other, and the first picture that exists."""
    if not first:
        return ""
    writer = Writer(_SUMMARY, places, {}, {})
    available = [path for result in results for path in pictures_in(result.place)]
    parts = []
    for section in first:
        chosen = next(
            (
                Shown(path, declared.caption)
                for declared in section.pictures
                for path in available
                if path.stem.startswith(declared.begins)
            ),
            None,
        )
        content = writer.content(section)
        if chosen is not None:
            content += f'<div class="figures">{figure(chosen, "first-picture")}</div>\n'
        if section.title:
            identifier = places.identifier(_SUMMARY, section.place)
            content = f'<section id="{identifier}"><h2>{worded(section.title)}</h2>\n{content}</section>\n'
        parts.append(content)
    return f'<div class="first" id="{places.identifier(_SUMMARY, _SUMMARY)}">{"".join(parts)}</div>\n'


def _moving(scripts: Scripts, places: Places) -> str:
    """Return the viewer of the shapes that move."""
    viewer = scripts.viewer([places.identifier(_SHAPES, shape.place) for shape in scripts.shapes])
    return f'<section id="{_SHAPES}"><h2>Shapes that move</h2>\n{viewer}</section>\n' if viewer else ""


def _chapters(result: _Result, places: Places, scripts: Scripts | None) -> str:
    """Return one command's results."""
    by_section, undeclared = result.pictures
    writer = Writer(result.name, places, by_section, live_parts(scripts, result.place, result.chapters))
    parts = [
        writer.chapter(section, folded=section.title in result.repeated) if section.title else writer.content(section)
        for section in result.chapters
    ]
    if undeclared:
        pictures = [Shown(path, "") for path in undeclared]
        further = "".join(figure(picture, places.identifier(result.name, picture.place)) for picture in pictures)
        parts.append(
            '<details open class="level3"><summary><h3>Further pictures</h3></summary>\n'
            f'<div class="figures">{further}</div></details>\n'
        )
    identifier = places.identifier(result.name, result.heading)
    made_at = result.document.get("made_at")
    notes = f'<p class="note">Made {escape(moment(made_at))}.</p>\n' if made_at else ""
    notes += "".join(
        f'<p class="finding failed"><span class="mark">✗</span> '
        f"<span>Does not fit the case any more: {worded(remark)}.</span></p>\n"
        for remark in result.stale
    )
    return (
        f'<section class="result"><h2 id="{identifier}">{escape(result.heading)}</h2>\n{notes}{"".join(parts)}'
        f"{_case(result.place)}</section>\n"
    )


def _case(place: Path) -> str:
    try:
        text = (place / "case.toml").read_text(encoding="utf-8")
    except (OSError, ValueError):
        return ""
    heading = "<h3>Case, as it was resolved</h3>"
    return f'<details class="level3"><summary>{heading}</summary><pre>{escape(text)}</pre></details>\n'


def _contents(first: Sequence[Section], results: Sequence[_Result], places: Places, *, moving: bool) -> str:
    """Return the contents: the first page's sections, and each command with its chapters."""

    def entry(result: str, name: str, title: str, inner: str = "") -> str:
        return f'<li><a href="#{places.identifier(result, name)}">{worded(title)}</a>{inner}</li>\n'

    def chapters(name: str, sections: Iterable[Section]) -> str:
        listed = "".join(entry(name, section.place, section.title) for section in sections if section.title)
        return f"<ul>{listed}</ul>" if listed else ""

    parts = [entry(_SUMMARY, _SUMMARY, "Summary", chapters(_SUMMARY, first))] if first else []
    parts += [f'<li><a href="#{_SHAPES}">Shapes that move</a></li>\n'] if moving else []
    parts += [
        entry(result.name, result.heading, result.heading, chapters(result.name, result.chapters)) for result in results
    ]
    return f"<ul>{''.join(parts)}</ul>"
