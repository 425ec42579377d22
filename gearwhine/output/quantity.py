"""Quantity of a result, declared once: the JSON document, the NetCDF file, terminal and report are made from it.

A result is declared as a tree over the objects that the library solved: quantities, parts that hold quantities, and
rows of like objects::

    ROTORS = (
        Rows("rotors", lambda solved: solved, dimension="rotor", fields=(
            Quantity("name", lambda solved: solved.rotor.name, "rotor", heading="rotor"),
            Quantity("mass_kg", lambda solved: solved.rotor.mass, heading="mass [kg]", shown=".3f"),
            Part("campbell", lambda solved: solved.campbell, (
                Quantity("frequency_hz", lambda diagram: diagram.frequencies / HERTZ,
                         "campbell_frequency", ("campbell_step", "whirl_branch"), "Hz", "natural frequency of whirl"),
            )),
        )),
    )

:func:`document_of` makes the document of it, :func:`gearwhine.output.dataset.arrays_of` the arrays of the file, and
:func:`gearwhine.output.sections.columns_of` the columns of a table. None of them knows any physics.

Every document has a list ``warnings`` of entries with a ``name``, a ``message`` and the figures that belong to it:
results that are formally right and physically questionable. The command prints the messages on standard error, the
report shows them first.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

HERTZ: Final = 2.0 * np.pi
"""Radians per second in one hertz."""
RPM: Final = 60.0 / (2.0 * np.pi)
"""Revolutions per minute in one radian per second."""

Document = dict[str, Any]


class Absent:
    """Type of :data:`ABSENT`."""


ABSENT: Final = Absent()
"""Value of a quantity whose key the document leaves out; None stands in it as null."""

Getter = Callable[[Any], Any]
Row = Mapping[str, Any]


@dataclass(frozen=True)
class Quantity:
    """One quantity: how it is taken from the solved object, its names and units, and how a table shows it.

    Attributes
    ----------
    key : str
        Key in the JSON document, with its unit; empty for a quantity of the file alone.
    of : callable
        Takes the value out of the solved object: a number, a text, a truth value, an array, or a mapping of labels to
        these. None where there is none; :data:`ABSENT` where the key is left out, too.
    name : str
        Name in the NetCDF file; empty for a quantity of the document alone. A variable that is named for its only
        dimension is the coordinate along it.
    dimensions : tuple of str
        Dimensions of one value, behind the dimension of the rows that the quantity stands in. The labels of a mapping
        are the coordinate along the first.
    unit : str
        CF unit in the file.
    long_name : str
        Long name in the file.
    document : callable, optional
        Converts the value from the file's form to the document's: another unit, or fewer entries.
    attributes : callable, optional
        Takes further attributes of the variable from the solved object.
    common : bool
        Whether rows have the value in common: it stands in the file once, without their dimension.
    heading : str
        Heading of its column in a table, with the unit; empty for a quantity that tables do not show.
    shown : str or callable
        Format of the number in its column, or the text of a row of the document.
    scale : float
        Factor of the number in its column.
    numbers : tuple of str
        Keys of further numbers that ``shown`` tells, see :class:`gearwhine.output.sections.Column`.
    """

    key: str
    of: Getter
    name: str = ""
    dimensions: tuple[str, ...] = ()
    unit: str = ""
    long_name: str = ""
    document: Callable[[Any], Any] | None = None
    attributes: Callable[[Any], dict[str, Any]] | None = None
    common: bool = False
    heading: str = ""
    shown: str | Callable[[Row], str] = ""
    scale: float = 1.0
    numbers: tuple[str, ...] = ()


@dataclass(frozen=True)
class Part:
    """Quantities of one object within another: a dictionary of the document under its key.

    Attributes
    ----------
    key : str
        Key in the document; empty where the quantities stand beside those around.
    of : callable
        Takes the object; None where there is none, which the document shows as null.
    fields : tuple of Quantity, Part or Rows
    """

    key: str
    of: Getter
    fields: "Fields"


@dataclass(frozen=True)
class Rows:
    """Quantities of like objects: a list of the document, and a dimension of the file.

    Attributes
    ----------
    key : str
        Key in the document; empty for rows of the file alone.
    of : callable
        Takes the objects; None where there are none, which the document shows as null.
    fields : tuple of Quantity, Part or Rows
    dimension : str
        Dimension in the file, along which the rows of all objects around stand one after the other; empty for rows of
        the document alone.
    """

    key: str
    of: Getter
    fields: "Fields"
    dimension: str = ""


Field = Quantity | Part | Rows
Fields = tuple[Field, ...]


def document_of(fields: Iterable[Field], solved: Any) -> dict[str, Any]:
    """Return the declared quantities of a solved object as a document for JSON, keys in the order of declaration."""
    document: dict[str, Any] = {}
    for field in fields:
        if isinstance(field, Quantity) and not field.key:
            continue
        value = field.of(solved)
        if isinstance(field, Part) and not field.key:
            document |= {} if value is None else document_of(field.fields, value)
        elif field.key and value is not ABSENT:
            document[field.key] = None if value is None else _entry(field, value)
    return document


def _entry(field: Field, value: Any) -> Any:
    if isinstance(field, Part):
        return document_of(field.fields, value)
    if isinstance(field, Rows):
        return [document_of(field.fields, item) for item in value]
    return plain(value if field.document is None else field.document(value))


def plain(value: Any) -> Any:
    """Return a value in JSON's own types."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    return value


def add_warnings(document: Document, warnings: Iterable[Mapping[str, Any]] = ()) -> None:
    """Append warnings to those that a document has; a message that it has already is not repeated."""
    listed = list(document.get("warnings", ()))
    messages = {entry["message"] for entry in listed}
    for entry in warnings:
        if entry["message"] not in messages:
            listed.append(dict(entry))
            messages.add(entry["message"])
    document["warnings"] = listed


def joined(*documents: Mapping[str, Any]) -> Document:
    """Merge documents: the keys of later ones win, the warnings of all are joined."""
    whole: Document = {}
    for document in documents:
        warnings = document.get("warnings", ())
        add_warnings(whole, warnings)
        whole |= {key: value for key, value in document.items() if key != "warnings"}
    return whole
