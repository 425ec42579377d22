"""Quantity of a result, declared once: the JSON document, the NetCDF file, terminal and report are made from it.

A result is declared as a tree over the objects that the library solved: quantities, parts that hold quantities, and
rows of like objects::

    ROTORS = (
        Rows("rotors", ".", dimension="rotor", fields=(
            Quantity("name", "rotor.name", "rotor", heading="rotor"),
            Quantity("length_m", "rotor.length", "rotor_length", heading="length [mm]", shown=".1f"),
            Part("campbell", "campbell", (
                Quantity("frequency_hz", "frequencies", "campbell_frequency", ("campbell_step", "whirl_branch")),
            )),
        )),
    )

A row says the attribute, the names in document and file, and how tables show it. What is said elsewhere is not said
again: the unit in the file is that at the end of the key; frequencies and speeds, in rad/s inside, are converted to the
unit of the key; the factor of a column is that from the key's unit to the heading's; the long name in the file is the
first sentence of the attribute's own docstring.

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

from gearwhine.output.attributes import meaning_at, value_at

HERTZ: Final = 2.0 * np.pi
"""Radians per second in one hertz."""
RPM: Final = 60.0 / (2.0 * np.pi)
"""Revolutions per minute in one radian per second."""

Document = dict[str, Any]


class Absent:
    """Type of :data:`ABSENT`."""


ABSENT: Final = Absent()
"""Value of a quantity whose key the document leaves out; None stands in it as null."""

Getter = str | Callable[[Any], Any]
"""Attribute of a solved object, see :func:`gearwhine.output.attributes.value_at`, or a function of it."""
Row = Mapping[str, Any]

UNITS: Final = {
    "_m_per_s2": "m/s2",
    "_m_per_s": "m/s",
    "_n_per_m": "N/m",
    "_n_m": "N m",
    "_kg_m2": "kg m2",
    "_kg": "kg",
    "_rad": "rad",
    "_deg": "degree",
    "_hz": "Hz",
    "_rpm": "rpm",
    "_pa": "Pa",
    "_n": "N",
    "_m": "m",
    "_m2": "m2",
    "_s": "s",
    "_h": "h",
    "_w": "W",
    "_j": "J",
    "_db": "dB",
    "_db_a": "dB",
    "_percent": "percent",
}
"""Unit in the file that the end of a key says."""

_FROM_SI: Final[dict[str, Callable[[Any], Any]]] = {
    "Hz": lambda value: value / HERTZ,
    "rpm": lambda value: value * RPM,
    "degree": np.degrees,
}
"""Conversion from the unit inside, rad/s or rad, to that of files and documents."""

_SHOWN: Final = {
    "mm": ("m", 1e3),
    "µm": ("m", 1e6),
    "nm": ("m", 1e9),
    "µrad": ("rad", 1e6),
    "mrad": ("rad", 1e3),
    "N/µm": ("N/m", 1e-6),
    "N/mm": ("N/m", 1e-3),
    "GPa": ("Pa", 1e-9),
    "MPa": ("Pa", 1e-6),
    "kN": ("N", 1e-3),
    "krpm": ("rpm", 1e-3),
    "%": ("", 100.0),
}
"""Units that headings show in place of the key's: that unit, and the factor from it."""


def _end(name: str) -> str:
    """Return the end of a name that says its unit; empty where none does."""
    return max((end for end in UNITS if name.endswith(end)), key=len, default="")


def shown_product(unit: str) -> str:
    """Return a unit of a file as texts show it: files have a blank between units, as UDUNITS reads them."""
    return unit.replace("N m", "N·m").replace("N*m", "N·m")


def unit_of(key: str) -> str:
    """Return the unit that a key says at the end of its last step that says one; empty where none does."""
    return next((UNITS[end] for step in reversed(key.split(".")) if (end := _end(step))), "")


def factor_of(key: str, heading: str) -> float:
    """Return the factor from the unit of a key to the one in brackets in the heading of its column."""
    unit, factor = _SHOWN.get(heading.rpartition("[")[2].partition("]")[0].split(",")[0].split(" ")[0], ("", 1.0))
    return factor if unit == unit_of(key) else 1.0


@dataclass(frozen=True)
class Quantity:
    """One quantity: which attribute it is, its names and unit, and how a table shows it.

    Attributes
    ----------
    key : str
        Key in the JSON document, with its unit; empty for a quantity of the file alone.
    of : str or callable
        Attribute of the solved object: a number, a text, a truth value, an array, or a mapping of labels to these.
        None where there is none. Empty: the attribute that the key names before its unit, or the name in the file. A
        function of the object has the value in the unit of key and file; :data:`ABSENT` of it leaves the key out.
    name : str
        Name in the NetCDF file; empty for a quantity of the document alone. A variable that is named for its only
        dimension is the coordinate along it.
    dimensions : tuple of str
        Dimensions of one value, behind the dimension of the rows that the quantity stands in. The labels of a mapping
        are the coordinate along the first.
    unit : str
        CF unit in the file; empty: the one that the key says.
    long_name : str
        Long name in the file; empty: the first sentence of the attribute's own docstring.
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
    scale : float, optional
        Factor of the number in its column; None: that from the key's unit to the heading's.
    numbers : tuple of str
        Keys of further numbers that ``shown`` tells, see :class:`gearwhine.output.sections.Column`.
    optional : bool
        Whether the document leaves the key out where there is no value.
    """

    key: str
    of: Getter = ""
    name: str = ""
    dimensions: tuple[str, ...] = ()
    unit: str = ""
    long_name: str = ""
    document: Callable[[Any], Any] | None = None
    attributes: Callable[[Any], dict[str, Any]] | None = None
    common: bool = False
    heading: str = ""
    shown: str | Callable[[Row], str] = ""
    scale: float | None = None
    numbers: tuple[str, ...] = ()
    optional: bool = False

    @property
    def file_unit(self) -> str:
        """CF unit in the file."""
        return self.unit or unit_of(self.key)

    @property
    def attribute(self) -> str:
        """Attribute of the solved object; empty where a function takes the value."""
        if self.of:
            return self.of if isinstance(self.of, str) else ""
        return self.key.removesuffix(_end(self.key)) or self.name

    def value_of(self, solved: Any) -> Any:
        """Return the value of an object in the unit of key and file."""
        if callable(self.of):
            return self.of(solved)
        value, convert = value_at(solved, self.attribute), _FROM_SI.get(self.file_unit)
        # Inside, frequencies are in rad/s, and only names that end so are in another unit.
        is_inside = convert is not None and unit_of(self.attribute) != self.file_unit
        return convert(value) if convert is not None and is_inside and value is not None else value

    def meaning_in(self, solved: Any) -> str:
        """Return the long name in the file: the given one, or what the docstring of the object's attribute says."""
        return self.long_name or meaning_at(solved, self.attribute)


def in_file(
    name: str, along: str | tuple[str, ...], of: Getter, long_name: str = "", unit: str = "", **more: Any
) -> Quantity:
    """Declare a quantity of the file alone.

    Parameters
    ----------
    name : str
    along : str or tuple of str
        Its dimensions, in one text with blanks between.
    of, long_name, unit, **more
        As the attributes of :class:`Quantity`.
    """
    dimensions = tuple(along.split()) if isinstance(along, str) else along
    return Quantity("", of, name, dimensions, unit, long_name, **more)


@dataclass(frozen=True)
class Part:
    """Quantities of one object within another: a dictionary of the document under its key.

    Attributes
    ----------
    key : str
        Key in the document; empty where the quantities stand beside those around.
    of : str or callable
        Attribute that is the object, ``.`` for the solved object itself, or a function of it; None where there is none,
        which the document shows as null.
    fields : tuple of Quantity, Part or Rows
    optional : bool
        Whether the document leaves the key out where there is none.
    """

    key: str
    of: Getter
    fields: "Fields"
    optional: bool = False

    def value_of(self, solved: Any) -> Any:
        """Return the object within a solved one."""
        return value_at(solved, self.of) if isinstance(self.of, str) else self.of(solved)


@dataclass(frozen=True)
class Rows:
    """Quantities of like objects: a list of the document, and a dimension of the file.

    Attributes
    ----------
    key : str
        Key in the document; empty for rows of the file alone.
    of : str or callable
        Attribute that holds the objects, ``.`` for the solved object itself, or a function of it; None where there are
        none, which the document shows as null.
    fields : tuple of Quantity, Part or Rows
    dimension : str
        Dimension in the file, along which the rows of all objects around stand one after the other; empty for rows of
        the document alone.
    optional : bool
        Whether the document leaves the key out where there are none.
    """

    key: str
    of: Getter
    fields: "Fields"
    dimension: str = ""
    optional: bool = False

    def value_of(self, solved: Any) -> Any:
        """Return the objects within a solved one."""
        return value_at(solved, self.of) if isinstance(self.of, str) else self.of(solved)


Field = Quantity | Part | Rows
Fields = tuple[Field, ...]


def document_of(fields: Iterable[Field], solved: Any) -> dict[str, Any]:
    """Return the declared quantities of a solved object as a document for JSON, keys in the order of declaration."""
    document: dict[str, Any] = {}
    for field in fields:
        if isinstance(field, Quantity) and not field.key:
            continue
        value = field.value_of(solved)
        if field.optional and value is None:
            continue
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
