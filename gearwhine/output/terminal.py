"""Results on the terminal: the sections of a document, its files and its time."""

import re
import sys
from collections.abc import Callable, Iterable, Sequence
from textwrap import wrap
from typing import Any, Literal

from rich.box import SIMPLE_HEAD
from rich.cells import cell_len
from rich.console import Console
from rich.padding import Padding
from rich.table import Table as Grid
from rich.text import Text

from gearwhine.output.sections import Document, Section, Table, arrowed, is_number

_WIDTH, _WIDEST = 120, 10_000  # of a table that is not on a terminal, and where its words are longer
_MOST_LISTED_FILES = 12  # largest number of files that are named
_BETWEEN, _LEAST_BETWEEN = 3, 1  # columns between the cells of a table, and where it is narrow
_NARROWEST = 20  # least number of columns of a wrapped text
_BEFORE_UNIT = re.compile(r"(?<=\d) (?=(?:[%°]|[kMGmµ]?[A-Za-zµ][A-Za-z]{0,2}(?:[·/²³][\w·/²³]*)?)(?:[\s,;.)']|$))")
"""Space between a figure and its unit."""


def open_console() -> Console:
    """Return a console for standard output, as wide as the terminal."""
    # Without markup a bracket is a bracket: units and the names in a case are printed as they stand.
    console = Console(highlight=False, markup=False, emoji=False)
    if console.is_terminal:
        return console
    # Where there is no terminal, lines are not cut at the 80 columns that rich then assumes, nor words at any.
    return Console(highlight=False, markup=False, emoji=False, width=_WIDEST, soft_wrap=True)


def shown_by(
    sections: Callable[[Document], Iterable[Section]], *, timed: bool = False
) -> Callable[[dict[str, Any]], None]:
    """Return a function that prints a command's document by its sections, with the time where ``timed``."""
    return lambda document: show(document, sections(document), timed=timed)


def show(document: Document, sections: Iterable[Section], *, timed: bool = False) -> None:
    """Print the title of a case, the sections of its document, where modes come from and which files were written."""
    console = open_console()
    if "title" in document:
        console.print(document["title"], style="bold")
    for section in sections:
        show_section(console, section)
    show_origin(console, document)
    show_written(console, document)
    if timed:
        console.print(f"Time: {document['seconds']['total']:.1f} s")


def show_files(document: Document) -> None:
    """Print the written files, for commands that show nothing else."""
    show(document, ())


def say_warning(message: str) -> None:
    """Write a warning on standard error, wrapped at the width of a terminal."""
    lead = "warning: "
    sys.stderr.write(f"{lead}{_hanging(Console(stderr=True), message, len(lead))}\n")


def show_section(console: Console, section: Section, indent: int = 0) -> None:
    """Print a section; content under a title is set in by two columns."""
    if section.title:
        note = _hanging(console, section.note, indent + len(section.title))
        console.print(Text.assemble(" " * indent, (section.title, "bold"), note))
        indent += 2
    for item in section.content:
        if isinstance(item, Table):
            if item.caption:
                console.print(f"{' ' * indent}{_hanging(console, arrowed(item.caption), indent)}")
            for grid in _fitting(console, item, indent):
                console.print(Padding(grid, (0, 0, 1, indent), expand=False))
        else:
            # A command to copy may be one long word, which a line end inside would spoil.
            console.print(f"{' ' * indent}{_hanging(console, arrowed(str(item)), indent)}", soft_wrap=True)
    for inner in section.inner:
        show_section(console, inner, indent)


def _hanging(console: Console, text: str, before: int) -> str:
    """Wrap a text at the width of a terminal; its further lines begin below its first letter.

    ``before`` is the number of columns in front of it.
    """
    if not console.is_terminal:
        return text
    lead = text[: len(text) - len(text.lstrip())]
    width = max(console.width - before - len(lead), _NARROWEST)
    lines = wrap(_held(text.strip()), width, break_long_words=False, break_on_hyphens=False) or [""]
    return lead + f"\n{' ' * (before + len(lead))}".join(lines).replace("\u00a0", " ")


def show_written(console: Console, document: Document) -> None:
    """Show the files written, many as their number; a mode file that was only read is not among them."""
    read = document["modes_read_from"].rpartition("/")[2] if document.get("reused") else None
    written = [name for name in document.get("files", ()) if name != read]
    if written:
        listed = ", ".join(written) if len(written) <= _MOST_LISTED_FILES else f"{len(written)} files"
        console.print(f"Written to {document['folder']}: {listed}")
    if moved := document.get("moved"):
        console.print(f"Earlier results of {moved['command']} in this folder are now in {moved['to']}")


def show_origin(console: Console, document: Document) -> None:
    """Show the file that modes were read from in place of being solved for."""
    if document.get("reused"):
        console.print(f"Modes read from {document['modes_read_from']} (unchanged housing)")


def _fitting(console: Console, table: Table, indent: int) -> list[Grid]:
    """Return a table in rows, whose texts wrap between words; on a narrow terminal its rows become columns.

    Where not even one row fits beside the headings nothing is won: words are then broken.
    """
    columns, rows = table.filled()
    cells = [[column.heading for column in columns], *([arrowed(cell) for cell in row] for row in rows)]
    room = (console.width if console.is_terminal else _WIDTH) - indent
    for between in (_BETWEEN, _LEAST_BETWEEN):
        widths = _widths([list(column) for column in zip(*cells, strict=True)], room - between * len(columns))
        if sum(widths) + between * len(widths) <= room:
            return [_grid(cells, widths, between)]
    if not console.is_terminal:
        return [_grid(cells, widths, _BETWEEN)]
    first, *others = (_BETWEEN + max(map(_width, row), default=0) for row in cells)
    if first + max(others) > room:
        while sum(widths) + _LEAST_BETWEEN * len(widths) > room and max(widths) > 1:
            widths[widths.index(max(widths))] -= 1
        return [_grid(cells, widths, _LEAST_BETWEEN)]
    beside = (room - first) // max(others)
    return [_turned(cells[0], cells[start : start + beside]) for start in range(1, len(cells), beside)]


def _width(text: str) -> int:
    """Return the number of terminal columns of a text's widest line."""
    return max(map(cell_len, text.split("\n")))


def _widths(columns: Sequence[Sequence[str]], room: int) -> list[int]:
    """Return the widths of columns, each its heading and its cells, whose sum fits a room if words allow it.

    The widest column gives way first: at first only headings wrap, then cells, each down to its longest word.
    """
    widths = [max(map(_width, column)) for column in columns]
    words = [max(_width(word) for text in column for word in _words(text)) for column in columns]
    cells = [max(map(_width, column[1:]), default=0) for column in columns]
    for least in ([max(pair) for pair in zip(words, cells, strict=True)], words):
        while sum(widths) > room:
            wide = [place for place, width in enumerate(widths) if width > least[place]]
            if not wide:
                break
            widths[max(wide, key=lambda place: widths[place])] -= 1
    return widths


def _words(text: str) -> list[str]:
    """Return the words of a text, a figure with its unit as one."""
    return _held(text).split(" ") if "\n" not in text else [word for line in text.split("\n") for word in _words(line)]


def _held(text: str) -> str:
    """Return a text with a no-break space between a figure and its unit."""
    return _BEFORE_UNIT.sub("\u00a0", text)


def _wrapped(text: str, width: int) -> str:
    """Wrap a text between words, a figure with its unit as one; a longer word is broken, at its hyphens first."""
    lines = list[str]()
    for line in text.split("\n"):
        is_broken = any(_width(word) > width for word in _words(line))
        lines += wrap(_held(line), width, break_on_hyphens=is_broken) or [""]
    return "\n".join(lines).replace("\u00a0", " ")


def _turned(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> Grid:
    """Return rows as columns, the first of their cells on top."""
    grid = Grid(box=SIMPLE_HEAD, show_edge=False)
    grid.add_column(headings[0])
    for row in rows:
        grid.add_column(row[0], justify="right")
    for place, heading in enumerate(headings[1:], start=1):
        grid.add_row(heading, *(row[place] for row in rows))
    return grid


def _grid(cells: Sequence[Sequence[str]], widths: Sequence[int], between: int) -> Grid:
    """Return a table in rows, the first of its cells the headings, wrapped at the widths of its columns."""
    grid = Grid(box=SIMPLE_HEAD, show_edge=False, padding=(0, between // 2))
    for place, width in enumerate(widths):
        numbers = any(is_number(row[place]) for row in cells[1:])
        justify: Literal["left", "right"] = "right" if numbers else "left"
        grid.add_column(_wrapped(cells[0][place], width), justify=justify, no_wrap=True, min_width=width)
    for row in cells[1:]:
        grid.add_row(*(_wrapped(cell, width) for cell, width in zip(row, widths, strict=True)))
    return grid
