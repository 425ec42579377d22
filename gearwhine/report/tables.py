"""Tables of a report: rows of a command's document under columns, each with its unit."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Row = Mapping[str, Any]


@dataclass(frozen=True)
class Column:
    """One column of a table: where its values stand in a row, its heading, how a number is written, and its scale."""

    key: str
    heading: str
    form: str = ".4g"
    scale: float = 1.0

    def text(self, row: Row) -> str:
        """The value of a row in words; a dash where there is none."""
        value: Any = row
        for step in self.key.split("."):
            value = value.get(step) if isinstance(value, Mapping) else None
        if isinstance(value, bool):
            return "yes" if value else "no"
        if isinstance(value, int | float):
            return format(value * self.scale if self.scale != 1.0 else value, self.form)
        if isinstance(value, list):
            return ", ".join(format(entry, self.form) if isinstance(entry, float) else str(entry) for entry in value)
        return "–" if value is None else str(value)


@dataclass(frozen=True)
class Table:
    """Rows of one kind under columns; columns in which no row has anything are left out."""

    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    caption: str = ""

    def filled(self) -> tuple[tuple[Column, ...], list[list[str]]]:
        """The columns that say something, and the text of each row in them."""
        texts = {column: [column.text(row) for row in self.rows] for column in self.columns}
        kept = tuple(column for column in self.columns if any(text != "–" for text in texts[column]))
        return kept, [[texts[column][number] for column in kept] for number in range(len(self.rows))]


def table_of(columns: tuple[Column, ...], rows: Sequence[Row], caption: str = "") -> tuple[Table, ...]:
    """A table, or none where there are no rows."""
    return (Table(columns, tuple(rows), caption),) if rows else ()
