"""Quantities of a case as text with a customary unit."""

from __future__ import annotations

import math


def mm(length: float) -> str:
    """Return a length [m] in mm."""
    return f"{_rounded(length * 1e3)} mm"


def um(length: float) -> str:
    """Return a length [m] in µm."""
    return f"{_rounded(length * 1e6)} um"


def deg(angle: float) -> str:
    """Return an angle [rad] in degrees."""
    return f"{_rounded(math.degrees(angle))} deg"


def rpm(speed: float) -> str:
    """Return a speed [rad/s] in revolutions per minute."""
    return f"{_rounded(speed * 30.0 / math.pi)} rpm"


def of(number: float, unit: str) -> str:
    """Return a number with its unit."""
    return f"{_rounded(number)} {unit}"


def plain(number: float) -> float:
    """Return a plain number, rounded as the quantities are."""
    return float(_rounded(number))


_NOISE = 1e-13
"""Part of a number by which conversions of units may change it."""


def _rounded(number: float) -> str:
    """Write a number by eleven digits, in the shorter way; by all that it has where that is no mere noise."""
    if abs(number) <= 1e-12:
        return "0"
    digits = 11 if abs(float(f"{number:.10e}") - number) <= _NOISE * abs(number) else 15
    mantissa, exponent = f"{number:.{digits - 1}e}".split("e")
    by_power = f"{mantissa.rstrip('0').rstrip('.')}e{int(exponent)}"
    return min(f"{number:.{digits}g}".replace("e+0", "e").replace("e-0", "e-").replace("e+", "e"), by_power, key=len)
