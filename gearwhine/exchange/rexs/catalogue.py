"""Main dimensions of rolling bearings by their designation, of the diameter series 0, 2 and 3 of ISO 15.

A file may have no more of a bearing than what a maker calls it. Bore and series follow from the digits of the
designation; ISO 15 has outer diameter and width of each bore and series.
"""

from __future__ import annotations

import re
from typing import NamedTuple


class MainDimensions(NamedTuple):
    """Bore, outer diameter and width of a bearing [m]."""

    bore: float
    outer_diameter: float
    width: float


_BORES = (10, 12, 15, 17, *range(20, 115, 5), 120)
_OUTER = {
    0: (26, 28, 32, 35, 42, 47, 55, 62, 68, 75, 80, 90, 95, 100, 110, 115, 125, 130, 140, 145, 150, 160, 170, 180),
    2: (30, 32, 35, 40, 47, 52, 62, 72, 80, 85, 90, 100, 110, 120, 125, 130, 140, 150, 160, 170, 180, 190, 200, 215),
    3: (35, 37, 42, 47, 52, 62, 72, 80, 90, 100, 110, 120, 130, 140, 150, 160, 170, 180, 190, 200, 215, 225, 240, 260),
}
"""Outer diameters [mm] of each diameter series, by bore."""
_WIDTH = {
    0: (8, 8, 9, 10, 12, 12, 13, 14, 15, 16, 16, 18, 18, 18, 20, 20, 22, 22, 24, 24, 24, 26, 28, 28),
    2: (9, 10, 11, 12, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 28, 30, 32, 34, 36, 38, 40),
    3: (11, 12, 13, 14, 15, 17, 19, 21, 23, 25, 27, 29, 31, 33, 35, 37, 39, 41, 43, 45, 47, 49, 50, 55),
}
"""Widths [mm] of width series 1 of diameter series 0, and of width series 0 of the others, by bore."""
_BORE_OF_CODE = {"00": 10, "01": 12, "02": 15, "03": 17}
_NARROW = re.compile(r"(?:NUP|NU|NJ|NF|N|QJ)?\s?(?:[67]?)([023])(\d\d)(?!\d)")


def dimensions_of(designation: str) -> MainDimensions | None:
    """Return the main dimensions of a designation such as 6210-2Z or NU 306; None for one of another series."""
    match = _NARROW.match(designation.strip().upper())
    if match is None or (designation.strip()[:1].isdigit() and designation.strip()[:1] not in "67"):
        return None
    series, code = int(match[1]), match[2]
    bore = _BORE_OF_CODE.get(code, 5 * int(code))
    if bore not in _BORES:
        return None
    place = _BORES.index(bore)
    return MainDimensions(bore * 1e-3, _OUTER[series][place] * 1e-3, _WIDTH[series][place] * 1e-3)


def dimensions_on_shaft(bore: float) -> MainDimensions:
    """Return the main dimensions of diameter series 2 of the nearest bore, scaled to a bore [m]."""
    place = min(range(len(_BORES)), key=lambda index: abs(_BORES[index] * 1e-3 - bore))
    scale = bore / (_BORES[place] * 1e-3)
    return MainDimensions(bore, _OUTER[2][place] * 1e-3 * scale, _WIDTH[2][place] * 1e-3 * scale)
