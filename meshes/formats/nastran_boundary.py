"""Boundary of an external superelement of Nastran: the points of its matrices' rows, and the axes of their motions.

Format: NX Nastran Quick Reference Guide, case control EXTSEOUT and bulk data EXTRN. EXTSEOUT writes the matrices to an
OUTPUT4 file, or as DMIG, and the card EXTRN with the points of the rows, in their order, to a punch file.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.formats.nastran import Card, grid_points, grid_system, read_bulk, where
from gearwhine.numerics.arrays import FloatArray


@dataclass(frozen=True)
class Boundary:
    """Boundary of an external superelement, in the order of the rows of its matrices.

    Attributes
    ----------
    points : tuple of (int, str)
        Number of each point, and its components, such as "123456"; "0" of a scalar point.
    axes : dict of int to ndarray, shape (3, 3)
        Axes along and about which a grid point moves, as rows in the basic coordinate system, where its card GRID names
        a coordinate system of its motions.
    """

    points: tuple[tuple[int, str], ...]
    axes: dict[int, FloatArray]


def read_boundary(path: Path, most: int) -> Boundary:
    """Read the boundary of an external superelement.

    Parameters
    ----------
    path : path
    most : int
        Number of points beyond which the file is refused.

    Raises
    ------
    GeometryError
        Where there is no card EXTRN, it has a point twice or without components, or references lead nowhere.
    """
    bulk = read_bulk(path)
    points = dict[int, str]()
    for card in bulk.boundary:
        for first, last, components in _pairs(card):
            if last - first >= most - len(points):
                raise GeometryError(f"{where(card.place)}: expected at most {most} points in the card EXTRN")
            for number in range(first, last + 1):
                if number in points:
                    raise GeometryError(f"{where(card.place)}: point {number} stands twice in the card EXTRN")
                points[number] = components
    if not points:
        raise GeometryError(f"{path.name} has no card EXTRN, by which EXTSEOUT names the rows of matrices")
    axes = dict[int, FloatArray]()
    for grid, place in zip(bulk.grids, grid_points(bulk, path), strict=True):
        own = bulk.motion_systems[grid]
        number = bulk.default_motion_system if own is None else own
        if number and grid in points:
            axes[grid] = grid_system(bulk, number, path, ()).axes_at(place)
    return Boundary(tuple(points.items()), axes)


def _pairs(card: Card) -> Iterator[tuple[int, int, str]]:
    """Yield first and last point, and the components, of each pair of a card EXTRN."""
    words = [text for text in card.fields if text]
    while words:
        first, *words = words
        last = first
        if len(words) > 1 and words[0].upper() == "THRU":
            _, last, *words = words
        components, words = (words[0], words[1:]) if words else ("", [])
        is_number = re.fullmatch(r"\d{1,9}", first) and re.fullmatch(r"\d{1,9}", last)
        if not is_number or int(last) < int(first) or not re.fullmatch("0|[1-6]{1,6}", components):
            raise GeometryError(
                f"{where(card.place)}: card EXTRN has point {first!r} with components {components!r}; expected such as "
                "101 123456, or 900 THRU 909 0"
            )
        yield int(first), int(last), components
