"""Rated lives of rolling bearings: quantities of any analysis that loads them, and lives in words."""

from collections.abc import Callable
from typing import Any

from gearwhine.output.quantity import Quantity
from gearwhine.output.sections import Document

LONGEST_LIFE = 1e6
"""Life above which the bearing is hardly loaded, and only this bound is shown [h]."""


def life_in_words(hours: float | None) -> str:
    """Return a life for a table, three digits; empty where there is none."""
    if hours is None:
        return ""
    return f"{hours:.3g}" if hours <= LONGEST_LIFE else f"> {LONGEST_LIFE:.0e}".replace("e+0", "e")


def life_quantities(
    rated: Callable[[str], Callable[[Any], Any]], name: str, headings: tuple[str, str]
) -> tuple[Quantity, ...]:
    """Rating and lives of a bearing.

    Parameters
    ----------
    rated : callable
        Maps the name of an attribute of
        :class:`gearwhine.rotors.rolling_bearings.rated_life.BearingLife` to a function of
        a row.
    name : str
        Name of the bearings in the NetCDF file, such as ``bearing``.
    headings : tuple of str
        Headings of the columns of both lives.
    """

    def of(key: str) -> Callable[[Document], str]:
        return lambda row: life_in_words(row.get(key))

    return (
        Quantity("dynamic_rating_n", rated("rating")),
        Quantity("dynamic_rating_from", rated("rating_from")),
        Quantity(
            "life_h",
            rated("life"),
            f"{name}_life",
            unit="h",
            long_name="basic rating life L10 by ISO 281 at the speed of operation",
            heading=headings[0],
            shown=of("life_h"),
        ),
        Quantity(
            "reference_life_h",
            rated("reference_life"),
            f"{name}_reference_life",
            unit="h",
            long_name="basic reference rating life L10r by ISO/TS 16281 of the elements' loads, at the speed of "
            "operation",
            heading=headings[1],
            shown=of("reference_life_h"),
        ),
    )
