"""Elements of a report: sections, tables and findings as HTML, and the links between their places.

Every text comes from outside and is escaped here.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from urllib.parse import quote

from gearwhine.output.report.pictures import Shown, figure
from gearwhine.output.sections import NOTHING, Column, Finding, Row, Section, Table, arrowed, is_number

NO_BREAK = "\N{NO-BREAK SPACE}"
_LONGEST_IDENTIFIER = 60  # length of the longest identifier [characters]
_MARKS = {True: ("passed", "✓"), False: ("failed", "✗"), None: ("warned", "!")}  # classes and marks of findings
_WRAPPED = 20  # characters of a cell from which on its column may wrap
_UNIT = re.compile(r" (?=[→%])|(?<=\d) (?=(?:Hz|kHz|rpm|mm|µm|N|kg)\b)")
_NUMBERED = re.compile(r"(?<=[^\W\d_]) (?=\d+\b(?![.,]\d))")  # before the number of a wheel, mode or bearing


def worded(text: str) -> str:
    """Return a text as HTML, an arrow between the gears of a pair."""
    return escape(arrowed(text))


def in_cell(text: str) -> str:
    """Return the text of a cell as HTML: no line ends within a name such as ``wheel 1``, before an arrow or a unit."""
    text_with_units = _UNIT.sub(NO_BREAK, arrowed(text))
    return escape(_NUMBERED.sub(NO_BREAK, text_with_units))


class Places:
    """Places of a report by the names that sections, rows and pictures have for links.

    A name belongs to one result, such as that of ``gearwhine run``; a link looks there first, then in all others.
    """

    def __init__(self) -> None:
        self._identifiers: dict[tuple[str, str], str] = {}
        self._used: set[str] = set()

    def add(self, result: str, name: str) -> None:
        """Give a name of a result an identifier, once."""
        if (result, name) in self._identifiers:
            return
        stem = (
            re.sub(r"[^a-z0-9]+", "-", f"{result} {name}".lower()).strip("-")[:_LONGEST_IDENTIFIER].strip("-")
            or "place"
        )
        identifier, number = stem, 1
        while identifier in self._used:
            number += 1
            identifier = f"{stem}-{number}"
        self._used.add(identifier)
        self._identifiers[result, name] = identifier

    def add_sections(self, result: str, sections: Iterable[Section], pictures: Mapping[int, Sequence[Shown]]) -> None:
        """Add the sections of a result with the rows and pictures in them."""
        for section in sections:
            self.add(result, section.place)
            for table in section.tables:
                if (anchor := table.anchor) is not None:
                    for row in table.rows:
                        self.add(result, anchor(row))
            for picture in pictures.get(id(section), ()):
                self.add(result, picture.place)
            self.add_sections(result, section.inner, pictures)

    def identifier(self, result: str, name: str) -> str:
        """Return the identifier of a name that was added."""
        return self._identifiers[result, name]

    def find(self, result: str, names: Sequence[str]) -> str | None:
        """Return the identifier of the first name that exists, first in this result; pictures by their beginning."""
        for name in names:
            keys = [key for key in self._identifiers if key[1] == name]
            if name.startswith("picture "):
                keys = [key for key in self._identifiers if key[1].startswith(name)]
            if keys:
                return self._identifiers[min(keys, key=lambda key: key[0] != result)]
        return None


class Writer:
    """Writes sections of one result as HTML, with links to the places of all.

    Parameters
    ----------
    result : str
        Name of the result that the sections belong to.
    places : Places
        Places of the whole report.
    pictures : mapping of int to sequence of Shown
        Pictures by the identity of their section.
    live : mapping of int to str
        HTML that the interactive form puts at the end of a section, by its identity.
    """

    def __init__(
        self,
        result: str,
        places: Places,
        pictures: Mapping[int, Sequence[Shown]],
        live: Mapping[int, str],
    ) -> None:
        self._result, self._places = result, places
        self._pictures, self._live = pictures, live
        self._placed: set[str] = set()

    def chapter(self, section: Section, level: int = 3, *, folded: bool = False) -> str:
        """Return a foldable section with its content and the sections in it."""
        heading = f"<h{level}>{worded(section.title)}{self._note(section)}</h{level}>"
        identifier = self._places.identifier(self._result, section.place)
        inner = "".join(
            self.chapter(inner_section, level + 1) if inner_section.title else self.content(inner_section)
            for inner_section in section.inner
        )
        return (
            f'<details{"" if folded else " open"} class="level{level}" id="{identifier}"><summary>{heading}</summary>\n'
            f"{self.content(section)}{inner}</details>\n"
        )

    def content(self, section: Section) -> str:
        """Return the sentences, tables and pictures of a section."""
        parts = []
        for item in section.content:
            if isinstance(item, Table):
                parts.append(self._table(item))
            elif isinstance(item, Finding):
                parts.append(self._finding(item))
            else:
                parts.append(f"<p>{worded(item.strip())}</p>\n")
        pictures = self._pictures.get(id(section), ())
        for small, row in ((False, "figures"), (True, "figures small")):
            shown = [item for item in pictures if item.small is small]
            if figures := [figure(item, self._places.identifier(self._result, item.place)) for item in shown]:
                parts.append(f'<div class="{row}">\n{"".join(figures)}</div>\n')
        parts.append(self._live.get(id(section), ""))
        return "".join(parts)

    def _note(self, section: Section) -> str:
        note = section.note.strip()
        return f' <span class="note">{worded(note)}</span>' if note else ""

    def _finding(self, finding: Finding) -> str:
        kind, mark = _MARKS[finding.passed]
        more = ""
        for name in finding.link:
            if target := self._places.find(self._result, [name]):
                more = f' <a href="#{target}">{worded(name.partition(" ")[2])}</a>'
                break
        content = f'<span class="mark">{mark}</span> <span>{worded(finding.text)}{more}</span>'
        return f'<p class="finding {kind}">{content}</p>\n'

    def _table(self, table: Table) -> str:
        columns, texts = table.filled()
        # A column is text where none of its values is a number.
        words = [not any(is_number(row[place]) for row in texts) for place in range(len(columns))]
        longest = [max(len(row[place]) for row in texts) for place in range(len(columns))]
        classes = [
            f' class="text{" long" if length > _WRAPPED else ""}"' if word else ""
            for word, length in zip(words, longest, strict=True)
        ]
        head = "".join(
            f'<th scope="col"{kind}>{worded(column.heading)}</th>'
            for column, kind in zip(columns, classes, strict=True)
        )
        body = "".join(
            f"<tr{self._row_identifier(table, row)}>{self._cells(columns, row, cells, classes)}</tr>\n"
            for row, cells in zip(table.rows, texts, strict=True)
        )
        caption = f"<caption>{worded(table.caption)}</caption>" if table.caption else ""
        return (
            f'<div class="table"><table>{caption}<thead><tr>{head}</tr></thead>\n<tbody>{body}</tbody></table></div>\n'
        )

    def _row_identifier(self, table: Table, row: Row) -> str:
        if table.anchor is None:
            return ""
        identifier = self._places.identifier(self._result, table.anchor(row))
        if identifier in self._placed:
            return ""
        self._placed.add(identifier)
        return f' id="{identifier}"'

    def _cells(self, columns: Sequence[Column], row: Row, texts: Sequence[str], classes: Sequence[str]) -> str:
        parts = []
        for column, text, kind in zip(columns, texts, classes, strict=True):
            content = in_cell(text) if text != NOTHING else "–"
            place = self._places.find(self._result, column.link(row)) if column.link and text != NOTHING else None
            target = quote(str(row[column.file])) if row.get(column.file) else f"#{place}" if place else None
            parts.append(f"<td{kind}>" + (f'<a href="{target}">{content}</a>' if target else content) + "</td>")
        return "".join(parts)


def fragment(sections: Sequence[Section]) -> str:
    """Return sections without pictures as a piece of HTML, such as a notebook shows; it brings its few styles."""
    places = Places()
    places.add_sections("", sections, {})
    writer = Writer("", places, {}, {})
    body = "".join(writer.chapter(section) if section.title else writer.content(section) for section in sections)
    return f'<div class="gearwhine"><style>{_FRAGMENT_STYLE}</style>\n{body}</div>'


_FRAGMENT_STYLE = """
.gearwhine table { border-collapse: collapse; margin: .5em 0; font-variant-numeric: tabular-nums; }
.gearwhine caption { text-align: left; opacity: .7; }
.gearwhine th, .gearwhine td { text-align: right; padding: .15em .7em; border-bottom: 1px solid #8884; }
.gearwhine th.text, .gearwhine td.text { text-align: left; }
.gearwhine .table { overflow-x: auto; }
.gearwhine summary h3, .gearwhine summary h4, .gearwhine summary h5 { display: inline; }
.gearwhine .failed { color: #b5382a; }
"""
