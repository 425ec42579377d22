"""Sections of a result: sentences and tables over its document, for the terminal and the report alike.

They read the document by its keys alone, so that the report can be made of the summaries that commands leave in a
folder.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from gearwhine.output.quantity import Quantity, factor_of

Document = Mapping[str, Any]
Row = Mapping[str, Any]

NOTHING = ""
"""Text of a cell without a value."""


@dataclass(frozen=True)
class Column:
    """Column of a table.

    Attributes
    ----------
    heading : str
        Heading with the unit.
    of : str or callable
        Key of the value in a row, keys of parts before it, and places in lists from 0, with points between; or a
        callable that takes the text of the cell from the row, for a text that is no number.
    form : str
        Format of a number.
    scale : float, optional
        Factor of a number, or of those in a list; None: that from the key's unit to the heading's.
    link : callable, optional
        Returns names of places in the report for a row: the cell links to the first of them that exists.
    shown : callable, optional
        Takes the text of the cell from the row for the terminal and the report, in place of the value by its format.
    numbers : tuple of str
        Keys of further numbers in the text, which exported tables have in columns of their own.
    file : str, optional
        Key of the name of a file beside the report, to which the cell links.
    """

    heading: str
    of: str | Callable[[Row], str]
    form: str = ".4g"
    scale: float | None = None
    link: Callable[[Row], Sequence[str]] | None = None
    shown: Callable[[Row], str] | None = None
    numbers: tuple[str, ...] = ()
    file: str = ""

    def text(self, row: Row) -> str:
        """Return the cell of a row; empty where there is no value."""
        if self.shown is not None:
            return self.shown(row)
        value = self.value(row)
        if isinstance(value, bool):
            return "yes" if value else "no"
        if isinstance(value, int | float):
            return format(value, self.form)
        if isinstance(value, list):
            return ", ".join(format(entry, self.form) if isinstance(entry, float) else str(entry) for entry in value)
        return NOTHING if value is None else str(value)

    def value(self, row: Row) -> Any:
        """Return the value of a row in the unit of the heading, with all its digits; None where there is none."""
        if not isinstance(self.of, str):
            return self.of(row)
        return _scaled(value_at(row, self.of), factor_of(self.of, self.heading) if self.scale is None else self.scale)


def value_at(row: Row, key: str) -> Any:
    """Return the value at a key of a row, as :class:`Column` has it; None where there is none."""
    value: Any = row
    for step in key.split("."):
        if isinstance(value, Mapping):
            value = value.get(step)
        elif isinstance(value, list | tuple) and step.isdecimal() and int(step) < len(value):
            value = value[int(step)]
        else:
            return None
    return value


def _scaled(value: Any, scale: float) -> Any:
    if scale == 1.0 or isinstance(value, bool):
        return value
    if isinstance(value, int | float):
        return value * scale
    return [_scaled(entry, scale) for entry in value] if isinstance(value, list | tuple) else value


@dataclass(frozen=True)
class Table:
    """Rows under columns; columns in which no row has anything are left out.

    Attributes
    ----------
    columns : tuple of Column
    rows : tuple of mapping
    caption : str
    anchor : callable, optional
        Returns the name of a row's place in the report, for links to it.
    """

    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    caption: str = ""
    anchor: Callable[[Row], str] | None = None

    def filled(self) -> tuple[tuple[Column, ...], list[list[str]]]:
        """Return the columns that hold a value in any row, and the text of each row in them."""
        texts = {column: [column.text(row) for row in self.rows] for column in self.columns}
        filled = tuple(column for column in self.columns if any(text != NOTHING for text in texts[column]))
        return filled, [[texts[column][number] for column in filled] for number in range(len(self.rows))]


@dataclass(frozen=True)
class Finding:
    """Sentence that passes or fails.

    Attributes
    ----------
    text : str
    passed : bool or None
        Whether it passes; None of a warning.
    link : tuple of str
        Names of places in the report; the sentence links to the first of them that exists.
    """

    text: str
    passed: bool | None
    link: tuple[str, ...] = ()

    def __str__(self) -> str:
        """Return the sentence."""
        return self.text


@dataclass(frozen=True)
class Picture:
    """Pictures of a section in the report.

    Attributes
    ----------
    begins : str
        Beginning of the file names, before ``.png``.
    caption : str
        One sentence on the content of the picture and its main feature.
    small : bool
        Whether it stands in a row with others of its kind.
    sheet_of : str
        Beginning of the names of pictures that this one repeats on one sheet; it is left out where they exist.
    """

    begins: str
    caption: str = ""
    small: bool = False
    sheet_of: str = ""

    @property
    def place(self) -> str:
        """Name of its place in the report, for links to it."""
        return f"picture {self.begins}"


@dataclass(frozen=True)
class Curves:
    """Array of the results file that the interactive report draws: curves, or colours over two axes.

    Attributes
    ----------
    variable : str
        Name of the array.
    along : tuple of str
        Axes: the abscissa, and for colours the ordinate. Each entry of another dimension has a drawing of its own.
    caption : str
    logarithmic : bool
        Whether values are shown on a logarithmic scale.
    """

    variable: str
    along: tuple[str, ...]
    caption: str
    logarithmic: bool = True


@dataclass(frozen=True)
class Section:
    """Sentences and tables in their order under a title.

    Attributes
    ----------
    title : str
        Empty where the sentences need none.
    content : tuple of str, Finding or Table
    note : str
        Note beside the title.
    pictures : tuple of Picture
        Pictures of the report, in their order there.
    inner : tuple of Section
        Sections behind its own content.
    curves : tuple of Curves
        Curves of the interactive report.
    shows : Document or None
        Part of a command's document that the section shows; a report folds results that stand in it twice.
    """

    title: str
    content: tuple[str | Finding | Table, ...] = ()
    note: str = ""
    pictures: tuple[Picture, ...] = ()
    inner: tuple["Section", ...] = ()
    curves: tuple[Curves, ...] = ()
    shows: Document | None = field(default=None, compare=False)

    @property
    def place(self) -> str:
        """Name of its place in the report, for links to it."""
        return f"section {self.title}"

    @property
    def sentences(self) -> tuple[str, ...]:
        """Sentences of the section itself."""
        return tuple(item for item in self.content if isinstance(item, str))

    @property
    def tables(self) -> tuple[Table, ...]:
        """Tables of the section itself."""
        return tuple(item for item in self.content if isinstance(item, Table))


def columns_of(fields: Iterable[object]) -> tuple[Column, ...]:
    """Return the columns of declared quantities that have a heading."""
    return tuple(
        Column(
            quantity.heading,
            quantity.key,
            (quantity.shown if isinstance(quantity.shown, str) and quantity.shown else ".4g"),
            quantity.scale,
            shown=quantity.shown if callable(quantity.shown) else None,
            numbers=quantity.numbers,
        )
        for quantity in fields
        if isinstance(quantity, Quantity) and quantity.heading
    )


def table_of(
    columns: tuple[Column, ...],
    rows: Sequence[Row],
    caption: str = "",
    anchor: Callable[[Row], str] | None = None,
) -> tuple[Table, ...]:
    """Return a table, or none where there are no rows."""
    return (Table(columns, tuple(rows), caption, anchor),) if rows else ()


def arrowed(text: str) -> str:
    """Return a text for reading, in which an arrow stands between the gears of a pair."""
    return text.replace(" -> ", " → ")


def counted(number: int, noun: str) -> str:
    """Return a number of things in words, such as ``1 mode`` and ``2 modes``."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def significant(number: float) -> str:
    """Return a number of three significant digits without a power of ten, but for very small and very large ones."""
    return f"{float(f'{number:.3g}'):.10g}"


def rms_of_band(limits: Iterable[float | None]) -> str:
    """Name rms values by their band, above 0 Hz and up to the limit that all have [Hz], such as ``rms 0–2000 Hz``."""
    different = set(limits)
    limit = different.pop() if len(different) == 1 else None
    return "rms" if limit is None or not math.isfinite(limit) else f"rms 0–{limit:.5g} Hz"


def percent(part: float) -> str:
    """Return a part of the whole in per cent, shown as zero only where it is zero."""
    return "less than 0.01 %" if 0.0 < part < 1e-4 else f"{100 * part:.3g} %"


def is_number(text: str) -> bool:
    """Whether a cell is a number, with a unit at most: such columns are aligned to the right."""
    try:
        float(text.removesuffix("%").removesuffix("°").strip())
    except ValueError:
        return False
    return True
