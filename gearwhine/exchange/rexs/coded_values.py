"""Numbers of a REXS file that are coded: base64 of little-endian floats or integers."""

from __future__ import annotations

import base64
import binascii
import struct

from gearwhine.exchange.rexs.errors import wrong

_FORMATS = {"float32": ("f", 4), "float64": ("d", 8), "int32": ("i", 4)}


def decoded(code: str, text: str, place: str) -> tuple[float, ...]:
    """Return the numbers of a coded array.

    Raises
    ------
    RexsError
        For an unknown code, and text that is no base64 of whole numbers of bytes.
    """
    if code not in _FORMATS:
        raise wrong(place, f"a code among {', '.join(_FORMATS)}", code)
    letter, size = _FORMATS[code]
    try:
        content = base64.b64decode("".join(text.split()), validate=True)
    except (binascii.Error, ValueError):
        raise wrong(place, f"base64 of numbers of {code}") from None
    if len(content) % size:
        raise wrong(place, f"base64 of numbers of {code}, {size} bytes each", f"{len(content)} bytes")
    return struct.unpack(f"<{len(content) // size}{letter}", content)


def rows_of(numbers: tuple[float, ...], rows: object, columns: object, place: str) -> tuple[tuple[float, ...], ...]:
    """Return the rows of a coded matrix, by its stated numbers of rows and columns; square where none are stated.

    Raises
    ------
    RexsError
        Where the numbers are not as many.
    """
    side = round(len(numbers) ** 0.5)
    height, width = (side if size is None else _count(size, place) for size in (rows, columns))
    if height * width != len(numbers):
        raise wrong(place, f"{height} x {width} numbers", f"{len(numbers)} numbers")
    return tuple(numbers[row * width : (row + 1) * width] for row in range(height))


def _count(size: object, place: str) -> int:
    text = str(size)
    if not text.isdecimal() or len(text) > 6:
        raise wrong(place, "a number of rows and of columns", size)
    return int(text)
