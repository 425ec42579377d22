"""Tolerance zones of ISO 286-1:2010 for lengths up to 500 mm: limit deviations of holes and shafts.

A zone is a letter, which places it by its fundamental deviation, and a grade, which is its width: ``H7``, ``k6``. The
tables hold the standard's values in µm for the ranges of length up to the sizes of `_SIZES`.
"""

import re

import numpy as np

from gearwhine.numerics.findings import Finding, RefusedPartError, refuse

_SIZES = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)  # mm
_INTERMEDIATE_SIZES = (
    *(3, 6, 10, 14, 18, 24, 30, 40, 50, 65, 80, 100, 120),
    *(140, 160, 180, 200, 225, 250, 280, 315, 355, 400, 450, 500),
)  # mm, of the letters whose deviation differs within a range of `_SIZES`
_WIDTHS = {
    3: (2, 2.5, 2.5, 3, 4, 4, 5, 6, 8, 10, 12, 13, 15),
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
    "c": (
        *(60, 70, 80, 95, 95, 110, 110, 120, 130, 140, 150, 170, 180),
        *(200, 210, 230, 240, 260, 280, 300, 330, 360, 400, 440, 480),
    ),
    "d": (20, 30, 40, 50, 65, 80, 100, 120, 145, 170, 190, 210, 230),
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
    "r": (
        *(10, 15, 19, 23, 23, 28, 28, 34, 34, 41, 43, 51, 54),
        *(63, 65, 68, 77, 80, 84, 94, 98, 108, 114, 126, 132),
    ),
    "s": (
        *(14, 19, 23, 28, 28, 35, 35, 43, 43, 53, 59, 71, 79),
        *(92, 100, 108, 122, 130, 140, 158, 170, 190, 208, 232, 252),
    ),
    "t": (
        *(np.nan,) * 6,  # the standard has no t up to 24 mm
        *(41, 48, 54, 66, 75, 91, 104, 122, 134, 146, 166, 180, 196, 218, 240, 268, 294, 330, 360),
    ),
    "u": (
        *(18, 23, 28, 33, 33, 41, 48, 60, 70, 87, 102, 124, 144),
        *(170, 190, 210, 236, 258, 284, 315, 350, 390, 435, 490, 540),
    ),
}
# Zones about the nominal size, by grade: lower deviation of the shafts j, upper one of the holes J.
_LOWER_J = {
    5: (-2, -2, -2, -3, -4, -5, -7, -9, -11, -13, -16, -18, -20),
    6: (-2, -2, -2, -3, -4, -5, -7, -9, -11, -13, -16, -18, -20),
    7: (-4, -4, -5, -6, -8, -10, -12, -15, -18, -21, -26, -28, -32),
}
_UPPER_J = {
    6: (2, 5, 5, 6, 8, 10, 13, 16, 18, 22, 25, 29, 33),
    7: (4, 6, 8, 10, 12, 14, 18, 22, 26, 30, 36, 39, 43),
    8: (6, 10, 12, 15, 20, 24, 28, 34, 41, 47, 55, 60, 66),
}
_LETTERS = (*_UPPER, "js", "j", *_LOWER)
_MICRO = 1e-6


class ToleranceZoneError(RefusedPartError):
    """A tolerance zone that is not known."""


def limit_deviations(zone: str, length: float) -> tuple[float, float]:
    """Lower and upper limit deviation of a length in a tolerance zone [m].

    Parameters
    ----------
    zone : str
        ``H7`` or ``k6``: capitals are of holes. Letters c to h, js, j, k, m, n, p, r to u; grades 3 to 11, of j 5 to 7
        and of J 6 to 8; t above 24 mm.
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
        expected = f"a letter of {', '.join(_LETTERS)} or its capital, and a grade from 3 to 11, such as 'H7' or 'k6'"
        refuse([Finding(part, "", None, expected)], ToleranceZoneError)
    about_nominal = {"j": _LOWER_J, "J": _UPPER_J}.get(letter)
    if about_nominal is not None and grade not in about_nominal:
        grades = ", ".join(map(str, about_nominal))
        refuse([Finding(part, "", None, f"a grade of {grades}, which alone have {letter}")], ToleranceZoneError)
    if not 0.0 < length <= _SIZES[-1] * 1e-3:
        refuse([Finding(part, "length", float(length), "a length above 0, up to 0.5 m")], ToleranceZoneError)
    if letter.lower() == "t" and np.isnan(_at(_LOWER["t"], length)):
        refuse(
            [Finding(part, "length", float(length), "more than 0.024 m, from which on there is t")], ToleranceZoneError
        )
    low = _lower_of_hole(letter.lower(), grade, length) if letter.isupper() else _lower_of_shaft(letter, grade, length)
    return _MICRO * low, _MICRO * (low + _at(_WIDTHS[grade], length))


def _at(values: tuple[float, ...], length: float) -> float:
    """Value of the range in which a length lies [µm]."""
    sizes = _SIZES if len(values) == len(_SIZES) else _INTERMEDIATE_SIZES
    return values[int(np.searchsorted(sizes, length * 1e3 * (1.0 - 1e-12)))]


def _lower_of_shaft(letter: str, grade: int, length: float) -> float:
    """Lower deviation of a shaft [µm]."""
    width = _at(_WIDTHS[grade], length)
    if letter in _UPPER:
        return -_at(_UPPER[letter], length) - width
    if letter == "js":
        return -0.5 * width
    if letter == "j":
        return _at(_LOWER_J[grade], length)
    # k has its deviation in the grades 4 to 7 alone.
    return 0 if letter == "k" and not 4 <= grade <= 7 else _at(_LOWER[letter], length)


def _lower_of_hole(letter: str, grade: int, length: float) -> float:
    """Lower deviation of a hole [µm]: the mirror of the shaft's; of K, M, N up to grade 8 and from P up to 7 less Δ.

    Δ = IT(n) - IT(n - 1) gives a hole of a grade with a shaft of the finer one the fit of the shaft's letter. In the
    first range of lengths it is 0.
    """
    width = _at(_WIDTHS[grade], length)
    if letter in _UPPER:
        return _at(_UPPER[letter], length)
    if letter == "js":
        return -0.5 * width
    if letter == "j":
        return _at(_UPPER_J[grade], length) - width
    first = length * 1e3 <= _SIZES[0]
    finest = 8 if letter in ("k", "m", "n") else 7
    delta = 0.0 if first or grade > finest else width - _at(_WIDTHS[grade - 1], length)
    if letter == "n" and grade > 8:
        upper = -_at(_LOWER["n"], length) if first else 0.0
    elif letter == "k" and grade > 8:
        upper = 0.0
    else:
        upper = -_at(_LOWER[letter], length) + delta
    # ISO 286-1 sets M6 of 250 to 315 mm to -9, not -11.
    if letter == "m" and grade == 6 and 250.0 < length * 1e3 <= 315.0:
        upper = -9.0
    return upper - width
