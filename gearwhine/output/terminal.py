"""Results on the terminal: the sections of a document, its files and its time."""

from collections.abc import Callable, Iterable, Sequence
from textwrap import wrap
from typing import Any, Literal

from rich.box import SIMPLE_HEAD
from rich.cells import cell_len
from rich.console import Console
from rich.constrain import Constrain
from rich.padding import Padding
from rich.table import Table as Grid
from rich.text import Text

from gearwhine.output.sections import Column, Document, Section, Table, arrowed, is_number

_WIDTH, _WIDEST = 120, 10_000  # of a table that is not on a terminal, and where its words are longer
_MOST_LISTED_FILES = 12  # largest number of files that are named
_BETWEEN = 3  # columns between the cells of a table
_NARROWEST = 20  # least number of columns of a wrapped text


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


def show_section(console: Console, section: Section, indent: int = 0) -> None:
    """Print a section; content under a title is set in by two columns."""
    if section.title:
        note = _hanging(console, section.note, indent + len(section.title))
        console.print(Text.assemble(" " * indent, (section.title, "bold"), note))
        indent += 2
    for item in section.content:
        if isinstance(item, Table):
            if item.caption:
                console.print(f"{' ' * indent}{arrowed(item.caption)}")
            for grid in _fitting(console, item, indent):
                least = 1 + sum(_BETWEEN + (column.min_width or 0) for column in grid.columns)
                padded = Padding(grid, (0, 0, 1, indent), expand=False)
                console.print(padded if console.is_terminal else Constrain(padded, max(_WIDTH, indent + least)))
        else:
            console.print(f"{' ' * indent}{_hanging(console, arrowed(str(item)), indent)}")
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
    lines = wrap(text.strip(), width, break_long_words=False, break_on_hyphens=False) or [""]
    return lead + f"\n{' ' * (before + len(lead))}".join(lines)


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


def _filled(table: Table) -> tuple[tuple[Column, ...], list[list[str]]]:
    columns, rows = table.filled()
    return columns, [[arrowed(cell) for cell in row] for row in rows]


def _fitting(console: Console, table: Table, indent: int) -> list[Grid]:
    """Return a table as it fits a terminal: its rows become columns, a few beside each other, where it is too wide."""
    columns, rows = _filled(table)
    headings = [column.heading for column in columns]
    room = (console.width if console.is_terminal else _WIDTH) - indent

    def width(cells: Sequence[str]) -> int:
        return _BETWEEN + max((cell_len(line) for cell in cells for line in cell.split("\n")), default=0)

    whole = sum(width([heading, *(row[place] for row in rows)]) for place, heading in enumerate(headings))
    first = width(headings)
    widest = max((width(row) for row in rows), default=0)
    if not console.is_terminal:
        return [_grid(table, breaks_words=whole <= room)]
    if whole <= room or first + widest > room:  # nothing is won where not even one row fits beside the headings
        return [_grid(table)]
    beside = (room - first) // widest
    groups = [rows[start : start + beside] for start in range(0, len(rows), beside)]
    return [_turned(headings, group) for group in groups]


def _turned(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> Grid:
    """Return rows as columns, the first of their cells on top."""
    grid = Grid(box=SIMPLE_HEAD, show_edge=False)
    grid.add_column(headings[0])
    for row in rows:
        grid.add_column(row[0], justify="right")
    for place, heading in enumerate(headings[1:], start=1):
        grid.add_row(heading, *(row[place] for row in rows))
    return grid


def _grid(table: Table, *, breaks_words: bool = True) -> Grid:
    """Return a table in rows; where words are not broken it may be wider than the console."""
    columns, rows = _filled(table)
    grid = Grid(box=SIMPLE_HEAD, show_edge=False)
    for place, column in enumerate(columns):
        numbers = any(is_number(row[place]) for row in rows)
        cells = [row[place] for row in rows]
        # A key path has no spaces to wrap at; what would be cut off is what the paths differ in.
        words = " ".join([column.heading, *cells]).split()
        least = None if breaks_words else max(map(cell_len, words), default=None)
        justify: Literal["left", "right"] = "right" if numbers else "left"
        # A column of paths keeps its width, else the widest is cut first. A column whose heading is wider
        # than its cells may wrap the heading instead.
        widest = max(map(cell_len, cells), default=0)
        is_path = not any(" " in cell for cell in cells) and widest >= cell_len(column.heading)
        whole = is_path and not breaks_words
        grid.add_column(column.heading, justify=justify, overflow="fold", min_width=least, no_wrap=whole)
    for row in rows:
        grid.add_row(*row)
    return grid
