"""Rated lives of rolling bearings: quantities of any analysis that loads them, and lives in words."""

from gearwhine.output.quantity import Quantity
from gearwhine.output.sections import Document, significant

LONGEST_LIFE = 1e6
"""Life above which the bearing is hardly loaded, and only this bound is shown [h]."""


def life_in_words(hours: float | None) -> str:
    """Return a life for a table, three digits; empty where there is none."""
    if hours is None:
        return ""
    return significant(hours) if hours <= LONGEST_LIFE else f"> {LONGEST_LIFE:.0e}".replace("e+0", "e")


def life_quantities(name: str, headings: tuple[str, str]) -> tuple[Quantity, ...]:
    """Rating and lives of a bearing, of a row that has them as its ``rated``.

    Parameters
    ----------
    name : str
        Name of the bearings in the NetCDF file, such as ``bearing``.
    headings : tuple of str
        Headings of the columns of both lives.
    """

    def life(key: str, attribute: str, heading: str) -> Quantity:
        def words(row: Document) -> str:
            return life_in_words(row.get(key))

        return Quantity(key, f"rated.{attribute}", f"{name}_{attribute}", heading=heading, shown=words)

    return (
        Quantity("dynamic_rating_n", "rated.rating"),
        Quantity("dynamic_rating_from", "rated.rating_from"),
        life("life_h", "life", headings[0]),
        life("reference_life_h", "reference_life", headings[1]),
    )
