"""Tolerance zones of ISO 286-1:2010 for lengths up to 500 mm: limit deviations of holes and shafts.

A zone is a letter, which places it by its fundamental deviation, and a grade, which is its width: ``H7``, ``k6``. The
tables hold the standard's values in µm for the ranges of length up to the sizes of `_SIZES`.
"""

import re

import numpy as np

from gearwhine.numerics.findings import Finding, RefusedPartError, refuse

_SIZES = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)  # mm
_WIDTHS = {
    4: (3, 4, 4, 5, 6, 7, 8, 10, 12, 14, 16, 18, 20),
    5: (4, 5, 6, 8, 9, 11, 13, 15, 18, 20, 23, 25, 27),
    6: (6, 8, 9, 11, 13, 16, 19, 22, 25, 29, 32, 36, 40),
    7: (10, 12, 15, 18, 21, 25, 30, 35, 40, 46, 52, 57, 63),
    8: (14, 18, 22, 27, 33, 39, 46, 54, 63, 72, 81, 89, 97),
    9: (25, 30, 36, 43, 52, 62, 74, 87, 100, 115, 130, 140, 155),
    10: (40, 48, 58, 70, 84, 100, 120, 140, 160, 185, 210, 230, 250),
    11: (60, 75, 90, 110, 130, 160, 190, 220, 250, 290, 320, 360, 400),
}
# Fundamental deviation of shafts: the upper one of letters up to h, the lower one of letters from k.
_UPPER = {
    "e": (14, 20, 25, 32, 40, 50, 60, 72, 85, 100, 110, 125, 135),
    "f": (6, 10, 13, 16, 20, 25, 30, 36, 43, 50, 56, 62, 68),
    "g": (2, 4, 5, 6, 7, 9, 10, 12, 14, 15, 17, 18, 20),
    "h": (0,) * 13,
}
_LOWER = {
    "k": (0, 1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 5),
    "m": (2, 4, 6, 7, 8, 9, 11, 13, 15, 17, 20, 21, 23),
    "n": (4, 8, 10, 12, 15, 17, 20, 23, 27, 31, 34, 37, 40),
    "p": (6, 12, 15, 18, 22, 26, 32, 37, 43, 50, 56, 62, 68),
}
_LETTERS = ("e", "f", "g", "h", "js", "k", "m", "n", "p")
_MICRO = 1e-6


class ToleranceZoneError(RefusedPartError):
    """A tolerance zone that is not known."""


def limit_deviations(zone: str, length: float) -> tuple[float, float]:
    """Lower and upper limit deviation of a length in a tolerance zone [m].

    Parameters
    ----------
    zone : str
        ``H7`` or ``k6``: capitals are of holes. Letters e, f, g, h, js, k, m, n, p; grades 4 to 11.
    length : float
        Nominal length [m].

    Raises
    ------
    ToleranceZoneError
        For another zone, or a length above 500 mm.
    """
    part = ("tolerance zone", zone)
    found = re.fullmatch(r"([A-Za-z]{1,2})(\d{1,2})", zone)
    letter, grade = ("", 0) if found is None else (found[1], int(found[2]))
    one_case = letter in (letter.lower(), letter.upper())
    if letter.lower() not in _LETTERS or grade not in _WIDTHS or not one_case:
        expected = f"a letter of {', '.join(_LETTERS)} or its capital, and a grade from 4 to 11, such as 'H7' or 'k6'"
        refuse([Finding(part, "", None, expected)], ToleranceZoneError)
    if not 0.0 < length <= _SIZES[-1] * 1e-3:
        refuse([Finding(part, "length", float(length), "a length above 0, up to 0.5 m")], ToleranceZoneError)
    place = int(np.searchsorted(_SIZES, length * 1e3 * (1.0 - 1e-12)))
    width = _WIDTHS[grade][place]
    low = _lower_of_hole(letter.lower(), grade, place) if letter.isupper() else _lower_of_shaft(letter, grade, place)
    return _MICRO * low, _MICRO * (low + width)


def _lower_of_shaft(letter: str, grade: int, place: int) -> float:
    """Lower deviation of a shaft [µm]."""
    width = _WIDTHS[grade][place]
    if letter in _UPPER:
        return -_UPPER[letter][place] - width
    if letter == "js":
        return -0.5 * width
    # k has its deviation in the grades 4 to 7 alone.
    return 0 if letter == "k" and grade > 7 else _LOWER[letter][place]


def _lower_of_hole(letter: str, grade: int, place: int) -> float:
    """Lower deviation of a hole [µm]: the mirror of the shaft's; of K, M, N up to grade 8 and P up to 7 less Δ.

    Δ = IT(n) - IT(n - 1) gives a hole of a grade with a shaft of the finer one the fit of the shaft's letter. In the
    first range of lengths it is 0.
    """
    width = _WIDTHS[grade][place]
    if letter in _UPPER:
        return _UPPER[letter][place]
    if letter == "js":
        return -0.5 * width
    finest = {"p": 7}.get(letter, 8)
    delta = 0 if place == 0 or grade > finest or grade - 1 not in _WIDTHS else width - _WIDTHS[grade - 1][place]
    if letter == "n" and grade > 8:
        upper = -_LOWER["n"][0] if place == 0 else 0
    elif letter == "k" and grade > 8:
        upper = 0
    else:
        upper = -_LOWER[letter][place] + delta
    # ISO 286-1 sets M6 of 250 to 315 mm to -9, not -11.
    if letter == "m" and grade == 6 and _SIZES[place] == 315:
        upper = -9
    return upper - width
