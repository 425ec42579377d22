"""Main dimensions of rolling bearings by their designation, after ISO 15 and ISO 355.

A file may have no more of a bearing than what a maker calls it. The digits of a designation are its dimension series
and its bore: 6210-2Z has the series 02 and a bore of 50 mm. The standards have outer diameter and width of each.
"""

from __future__ import annotations

import re
from typing import NamedTuple


class MainDimensions(NamedTuple):
    """Bore, outer diameter and width of a bearing [m]."""

    bore: float
    outer_diameter: float
    width: float


class _Series(NamedTuple):
    """A dimension series: its diameter series, the first of its bores [mm], and the width [mm] from that bore on."""

    diameters: int
    first: int
    widths: tuple[float, ...]


_BORES = (10, 12, 15, 17, *range(20, 115, 5), 120)
_OUTER = {
    0: (26, 28, 32, 35, 42, 47, 55, 62, 68, 75, 80, 90, 95, 100, 110, 115, 125, 130, 140, 145, 150, 160, 170, 180),
    2: (30, 32, 35, 40, 47, 52, 62, 72, 80, 85, 90, 100, 110, 120, 125, 130, 140, 150, 160, 170, 180, 190, 200, 215),
    3: (35, 37, 42, 47, 52, 62, 72, 80, 90, 100, 110, 120, 130, 140, 150, 160, 170, 180, 190, 200, 215, 225, 240, 260),
}
"""Outer diameters [mm] of each diameter series, by bore."""
_ISO_15_10 = (8, 8, 9, 10, 12, 12, 13, 14, 15, 16, 16, 18, 18, 18, 20, 20, 22, 22, 24, 24, 24, 26, 28, 28)
_ISO_15_02 = (9, 10, 11, 12, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 28, 30, 32, 34, 36, 38, 40)
_ISO_15_03 = (11, 12, 13, 14, 15, 17, 19, 21, 23, 25, 27, 29, 31, 33, 35, 37, 39, 41, 43, 45, 47, 49, 50, 55)
_ISO_15_22 = (18, 20, 23, 23, 23, 23, 25, 28, 31, 31, 31, 33, 36, 40, 43, 46)
_ISO_355_02 = (15.25, 16.25, 17.25, 18.25, 19.75, 20.75, 21.75, 22.75, 23.75, 24.75, 26.25, 27.25, 28.25, 30.5, 32.5)
_ISO_355_03 = (16.25, 18.25, 20.75, 22.75, 25.25, 27.25, 29.25, 31.5, 33.5, 36, 38, 40, 42.5)
_ISO_355_20 = (15, 15, 17, 18, 19, 20, 20, 23, 23, 23, 25, 25, 29, 29, 32, 32, 32)
_ISO_355_30 = (17, 20, 21, 22, 24, 24, 27, 27, 27, 31, 31, 36)
_SERIES = {
    **{name: _Series(0, 10, _ISO_15_10) for name in ("60", "70", "NU10", "N10", "QJ10")},
    **{name: _Series(2, 10, _ISO_15_02) for name in ("62", "72", "NU2", "NJ2", "NUP2", "N2", "QJ2")},
    **{name: _Series(3, 10, _ISO_15_03) for name in ("63", "73", "NU3", "NJ3", "NUP3", "N3", "QJ3")},
    **{name: _Series(2, 25, _ISO_15_22) for name in ("222", "NU22", "NJ22", "NUP22")},
    "302": _Series(2, 20, _ISO_355_02),
    "303": _Series(3, 20, _ISO_355_03),
    "320": _Series(0, 20, _ISO_355_20),
    "330": _Series(0, 25, _ISO_355_30),
}
"""Dimension series by what a designation begins with."""
_BORE_OF_CODE = {"00": 10, "01": 12, "02": 15, "03": 17}
_DESIGNATION = re.compile(r"(NUP|NU|NJ|N|QJ)?\s?(\d{3,5})(?!\d)")


def dimensions_of(designation: str) -> MainDimensions | None:
    """Return the main dimensions of a designation such as 6210-2Z, NU 306 or 33014; None for one of another series."""
    match = _DESIGNATION.match(designation.strip().upper())
    if match is None:
        return None
    digits = match[2]
    series = _SERIES.get(f"{match[1] or ''}{digits[:-2]}")
    bore = _BORE_OF_CODE.get(digits[-2:], 5 * int(digits[-2:]))
    if series is None or bore not in _BORES or bore < series.first:
        return None
    place = _BORES.index(bore)
    width = place - _BORES.index(series.first)
    if width >= len(series.widths):
        return None
    return MainDimensions(bore * 1e-3, _OUTER[series.diameters][place] * 1e-3, series.widths[width] * 1e-3)


def dimensions_on_shaft(bore: float) -> MainDimensions:
    """Return the main dimensions of dimension series 02 of the nearest bore, scaled to a bore [m]."""
    place = min(range(len(_BORES)), key=lambda index: abs(_BORES[index] * 1e-3 - bore))
    scale = bore / (_BORES[place] * 1e-3)
    return MainDimensions(bore, _OUTER[2][place] * 1e-3 * scale, _ISO_15_02[place] * 1e-3 * scale)
