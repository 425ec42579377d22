"""Digest of the inputs of a computation: equal only where all of them are equal bit for bit."""

import hashlib
import struct
from collections.abc import Mapping
from dataclasses import fields, is_dataclass

import numpy as np


def fingerprint(*parts: object) -> str:
    """SHA-256, as hexadecimal digits, over numbers, texts, arrays, and tuples, mappings and dataclasses of these.

    Numbers and arrays count by their bytes, so that 0 and -0 differ; mappings whatever their order.

    Raises
    ------
    TypeError
        For objects of any other type, whose difference the digest would not show.
    """
    total = hashlib.sha256()
    _feed(total, parts)
    return total.hexdigest()


def _feed(total: "hashlib._Hash", part: object) -> None:
    if isinstance(part, np.generic):
        part = part.item()
    if isinstance(part, np.ndarray) and part.dtype.kind in "biufc":
        total.update(f"array {part.dtype.str} {part.shape}\0".encode())
        total.update(np.ascontiguousarray(part).tobytes())
    elif isinstance(part, bool | int | None):
        total.update(f"{part!r}\0".encode())
    elif isinstance(part, float):
        total.update(b"float" + struct.pack("<d", part))
    elif isinstance(part, str):
        total.update(f"text {len(part)} {part}\0".encode())
    elif isinstance(part, tuple | list):
        total.update(f"{len(part)} of\0".encode())
        for inner in part:
            _feed(total, inner)
    elif isinstance(part, Mapping):
        _feed(total, sorted(part.items()))
    elif is_dataclass(part) and not isinstance(part, type):
        _feed(total, [(field.name, getattr(part, field.name)) for field in fields(part)])
    else:
        raise TypeError(f"a {type(part).__name__} has no fingerprint")
