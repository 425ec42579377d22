"""Element tables of a ROSS file, read with messages that name the file and the key.

``rotor.save("x.toml")`` of ROSS 2 and 3 writes ``ross_version`` (since 2.1), a table ``parameters``, and for each
element a table named by its class and its tag, such as ``["ShaftElement_Shaft Element 0"]``, that holds the arguments
of its constructor in SI, except those that are None. With the suffix ``.json`` it writes the same as JSON.

`Remarks` collects the properties that a file format cannot hold, each once for all elements concerned.
"""

import json
import math
import os
import tomllib
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np
import numpy.typing as npt

from gearwhine.rotors.errors import RotorError


class Remarks:
    """Collects remarks on elements; equal texts become one."""

    def __init__(self) -> None:
        self._places: defaultdict[str, list[str]] = defaultdict(list)

    def add(self, place: str, text: str) -> None:
        """Add a remark on a place."""
        if place not in self._places[text]:
            self._places[text].append(place)

    def sentences(self) -> tuple[str, ...]:
        """One sentence for each text, in the order in which they came up."""
        return tuple(
            f"{places[0]}{f' and {len(places) - 1} more' if places[1:] else ''}: {text}"
            for text, places in self._places.items()
        )


LARGEST_FILE = 50_000_000
"""Size of the largest file that is read [bytes]."""

_NOT_ELEMENTS = ("parameters", "ross_version")
_SPEEDS_OF_OPERATION = {"min_w", "max_w", "rated_w"}


@dataclass(frozen=True)
class Entry:
    """One element of the file.

    Attributes
    ----------
    file : str
        Name of the file, for messages.
    key : str
        Key of the element's table, such as ``ShaftElement_Shaft Element 0``.
    values : mapping of str to Any
        Keys and values of the table as they stand in the file.
    version : str
        Version of ROSS that saved the file; empty where it does not say.
    """

    file: str
    key: str
    values: Mapping[str, Any]
    version: str = ""

    @property
    def of_ross_3(self) -> bool:
        """Whether the file says that it is of ROSS 3 or later, whose ``frequency`` is that of whirl."""
        major = self.version.partition(".")[0]
        return major.isdecimal() and int(major) >= 3

    @property
    def place(self) -> str:
        """File and key, for remarks."""
        return f"{self.file}: {self.key}"

    @property
    def kind(self) -> str:
        """The class of the element; those of six degrees of freedom had names of their own before ROSS 2."""
        return self.key.partition("_")[0].removesuffix("6DoF")

    @property
    def tag(self) -> str:
        """Name of the element; without one, the rest of its key."""
        tag = self.values.get("tag")
        return tag if isinstance(tag, str) and tag else self.key.partition("_")[2] or self.key

    def error(self, name: str, expected: str) -> RotorError:
        """Error of a key, with file, key and value."""
        value = self.values.get(name, "missing")
        return RotorError(f"{self.file}: {self.key}.{name} is {value!r}; expected {expected}")

    def inner(self, name: str) -> "Entry":
        """Return a table within this one."""
        value = self.values.get(name)
        if not isinstance(value, Mapping):
            raise self.error(name, "a table")
        return Entry(self.file, f"{self.key}.{name}", value, self.version)

    def number(self, name: str, default: float | None = None) -> float:
        """Return a finite number; without a default the key must be there."""
        value = self.values.get(name, default)
        if not _is_number(value):
            raise self.error(name, "a finite number")
        return float(value)

    def node(self, name: str = "n") -> int | None:
        """Return the number of a node, or None where the key is missing."""
        value = self.values.get(name)
        if value is None:
            return None
        if not _is_number(value) or value != int(value) or value < 0:
            raise self.error(name, "a node: a whole number from 0")
        return int(value)

    def required_node(self) -> int:
        """Return the node that the element stands on, which must be given."""
        node = self.node()
        if node is None:
            raise self.error("n", "a node: a whole number from 0")
        return node

    def flag(self, name: str) -> bool:
        """Return a flag, which is true where the key is missing."""
        value = self.values.get(name, True)
        if not isinstance(value, bool):
            raise self.error(name, "true or false")
        return value

    def series(self, name: str, default: float | None = 0.0) -> list[float]:
        """Return a number, or a list of them, as a list; without a default the key must be there."""
        value = self.values.get(name, default)
        values = value if isinstance(value, list) else [value]
        if not values or not all(_is_number(entry) for entry in values):
            raise self.error(name, "a finite number, or a list of them")
        return [float(entry) for entry in values]

    def nested(self, name: str, default: float | None = 0.0) -> npt.NDArray[np.float64]:
        """Return a number, a list of them or a list of lists of one length, as an array."""
        value = self.values.get(name, default)
        if isinstance(value, list) and value and all(isinstance(row, list) for row in value):
            rows = [[float(entry) for entry in row if _is_number(entry)] for row in value]
            if len(set(map(len, rows))) == 1 and sum(map(len, rows)) == sum(map(len, value)) > 0:
                return np.array(rows)
            raise self.error(name, "lists of finite numbers, of one length")
        return np.array(self.series(name, default))


def read_entries(path: str | os.PathLike[str], remarks: Remarks) -> list[Entry]:
    """Elements of a file in its order.

    Raises
    ------
    RotorError
        No such file, not one of ROSS's, or not TOML (JSON where it is named so).
    """
    place = Path(path)
    document = _document(place)
    entries = []
    version = str(document.get("ross_version", ""))
    for key, value in document.items():
        if key in _NOT_ELEMENTS or key.startswith("_"):
            continue
        if not isinstance(value, Mapping):
            raise RotorError(f"{place.name}: {key} is {value!r}; expected a table, an element of a rotor saved by ROSS")
        entries.append(Entry(place.name, key, value, version))
    if not entries:
        raise RotorError(f"{place.name}: no elements; expected a rotor saved by ROSS, with tables ShaftElement_…")
    parameters = document.get("parameters", {})
    if isinstance(parameters, Mapping):
        for name in sorted(set(parameters) - _SPEEDS_OF_OPERATION):
            if parameters[name] not in (0, None):  # ROSS 3 writes damping of zero or none
                remarks.add(f"{place.name}: parameters", f"{name} is not read")
    return entries


def _document(place: Path) -> Mapping[str, Any]:
    try:
        size = place.stat().st_size
        if size > LARGEST_FILE:
            raise RotorError(f"{place}: {size} bytes; expected a rotor's file of at most {LARGEST_FILE // 10**6} MB")
        text = place.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise RotorError(f"{place.name}: byte {error.start} is not UTF-8; expected text") from None
    except OSError as error:
        raise RotorError(f"{place}: {error.strerror or error}; expected a rotor saved by ROSS") from None
    is_json = place.suffix.lower() == ".json"
    try:
        document = json.loads(text) if is_json else tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise RotorError(f"{place.name}: {error}; expected {'JSON' if is_json else 'TOML'}") from None
    if not isinstance(document, dict):
        raise RotorError(f"{place.name}: {type(document).__name__}; expected a table of elements")
    return document


def _is_number(value: object) -> TypeGuard[float]:
    """Whether a value is a finite number: flags are none, and no integer beyond a float's range is one."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:
        return False
