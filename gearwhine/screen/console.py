"""Where the lines go, and what every command ends with: where modes come from, which files were written."""

from typing import Any

from rich.console import Console

_WIDTH = 120


def open_console() -> Console:
    """Standard output, as wide as the terminal."""
    # Without markup a bracket is a bracket: units and the names in a case are printed as they stand.
    console = Console(highlight=False, markup=False, emoji=False)
    if console.is_terminal:
        return console
    # Where there is no terminal, lines are not cut at the 80 columns that rich then assumes.
    return Console(highlight=False, markup=False, emoji=False, width=_WIDTH, soft_wrap=True)


def show_written(console: Console, document: dict[str, Any]) -> None:
    """The files written; a mode file that was only read is not among them."""
    read = document["modes_read_from"].rpartition("/")[2] if document.get("reused") else None
    written = [name for name in document.get("files", ()) if name != read]
    if written:
        console.print(f"Written to {document['folder']}: {', '.join(written)}")


def show_origin(console: Console, document: dict[str, Any]) -> None:
    """Where modes were read from in place of being solved for."""
    if document.get("reused"):
        console.print(f"Modes read from {document['modes_read_from']} (unchanged housing)")


def counted(number: int, what: str) -> str:
    """A number of things, such as ``1 mode`` and ``2 modes``."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def percent(part: float) -> str:
    """A part of the whole that is never shown as nothing where there is some."""
    return "less than 0.01 %" if 0.0 < part < 1e-4 else f"{100 * part:.3g} %"
