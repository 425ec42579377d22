"""Labelled arrays: values with dimensions, unit and name; and the SHA-256 digest of such arrays."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class LabelledArray:
    """An array with its dimensions, unit and name.

    Attributes
    ----------
    dimensions : tuple of str
        A name for each axis.
    values : ndarray
        Numbers, or text.
    units : str
        ``"1"`` where it has none.
    long_name : str
        Name of the quantity in words.
    attributes : mapping of str to str
        Further attributes.
    """

    dimensions: tuple[str, ...]
    values: npt.NDArray[Any]
    units: str
    long_name: str
    attributes: Mapping[str, str] = field(default_factory=dict)

    @property
    def is_text(self) -> bool:
        """Whether the entries are text."""
        return self.values.dtype.kind in "UO"


def canonical_json(document: Mapping[str, Any]) -> str:
    """Canonical JSON of a document, the same for equal documents: keys in order, no blanks, no NaN."""
    return json.dumps(document, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)


def content_key(document: Mapping[str, Any]) -> str:
    """SHA-256 of a document's canonical JSON, as hexadecimal digits."""
    return hashlib.sha256(_bytes(document)).hexdigest()


def digest(arrays: Mapping[str, LabelledArray], attributes: Mapping[str, Any] | None = None) -> str:
    """SHA-256 over names, labels and every byte of the values, whatever the order in the mapping.

    Numbers count by their bytes, so two arrays share a digest only where they are the same bit for bit.
    """
    total = hashlib.sha256(_bytes({"attributes": dict(attributes or {})}))
    for name in sorted(arrays):
        array = arrays[name]
        values = np.ascontiguousarray(array.values)
        labels = {
            "name": name,
            "dimensions": list(array.dimensions),
            "shape": list(array.values.shape),
            "type": "text" if array.is_text else values.dtype.newbyteorder("<").str,
            "units": array.units,
            "long_name": array.long_name,
            "attributes": dict(array.attributes),
        }
        if array.is_text:
            labels["text"] = [str(entry) for entry in values.ravel()]
        total.update(_bytes(labels))
        if not array.is_text:
            total.update(values.astype(values.dtype.newbyteorder("<"), copy=False).reshape(-1).view(np.uint8).data)
    return total.hexdigest()


def _bytes(document: Mapping[str, Any]) -> bytes:
    # Text of a damaged file may hold halves of characters: those count too.
    return canonical_json(document).encode("utf-8", "surrogatepass")
