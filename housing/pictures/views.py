"""Directions of view: by name, for a housing that stands upright, and the corner that shows most motion."""

from collections.abc import Mapping

import numpy as np

from gearwhine.housing.errors import HousingError
from gearwhine.housing.pictures.drawn_shapes import DrawnHousing, DrawnShape
from gearwhine.numerics.arrays import FloatArray

AUTO = "auto"
"""The corner from which most of a shape's motion is seen."""

# Vectors from the housing to the eye, of a housing whose y points up.
_CORNERS = {
    "iso": (1.0, 0.75, 1.25),
    "iso-left": (-1.0, 0.75, 1.25),
    "iso-back": (1.0, 0.75, -1.25),
    "iso-back-left": (-1.0, 0.75, -1.25),
    "iso-below": (1.0, -0.75, 1.25),
    "iso-left-below": (-1.0, -0.75, 1.25),
    "iso-back-below": (1.0, -0.75, -1.25),
    "iso-opposite": (-1.0, -0.75, -1.25),
}
_SIDES = {
    "front": (0.0, 0.0, 1.0),
    "back": (0.0, 0.0, -1.0),
    "left": (-1.0, 0.0, 0.0),
    "right": (1.0, 0.0, 0.0),
    "top": (0.0, 1.0, 0.001),
}
VIEWS = (AUTO, *_CORNERS, *_SIDES)
"""Names of the directions of view."""

IN_WORDS = {
    "iso-left": "seen from the left",
    "iso-back": "seen from behind",
    "iso-back-left": "seen from behind on the left",
    "iso-below": "seen from below",
    "iso-left-below": "seen from below on the left",
    "iso-back-below": "seen from behind and below",
    "iso-opposite": "seen from behind and below on the left",
}
"""Corners other than the usual one, in words for a caption."""

_AS_GOOD = 0.7  # part of the motion seen from the best corner with which the usual one is kept
_CELLS = 64  # cells along the housing's diagonal in which the nearest triangle hides those behind it
_LARGER = 2.0  # least size of a cell, in square roots of the triangles' mean area
_SLANT = 2.0  # depth within one cell of a face seen aslant, in cells


def check_view(view: str) -> None:
    """Refuse a view that is not there.

    Raises
    ------
    HousingError
        For any name but those of :data:`VIEWS`.
    """
    if view not in VIEWS:
        raise HousingError(f"no view {view!r}; there are {', '.join(VIEWS)}")


def viewing_direction(view: str, up: FloatArray | None = None) -> FloatArray:
    """Return the viewing direction: the unit vector from the housing towards the eye.

    Parameters
    ----------
    view : str
        One of :data:`VIEWS`; that which depends on the shape stands for "iso".
    up : ndarray, shape (3,), optional
        Unit vector that points upwards; by default y. The view is turned with it, the shortest way.
    """
    check_view(view)
    towards = np.array(_SIDES.get(view) or _CORNERS["iso" if view == AUTO else view])
    return np.asarray(_turn(np.array([0.0, 1.0, 0.0]) if up is None else up) @ towards / np.linalg.norm(towards))


def _turn(up: FloatArray) -> FloatArray:
    """Return the least rotation that takes y to a unit vector u: I + K + K²/(1 + y·u), K the cross product by y × u."""
    y = np.array([0.0, 1.0, 0.0])
    if up @ y < -1.0 + 1e-9:
        return np.diag([-1.0, -1.0, 1.0])
    a, b, c = np.cross(y, up)
    cross = np.array([[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / (1.0 + up @ y))


def view_of_most_motion(housing: DrawnHousing, shape: DrawnShape, seen: Mapping[str, FloatArray] | None = None) -> str:
    """Name the corner from which most of a shape's motion is seen; the usual one where that shows about as much.

    What is seen is the sum of amplitude squared times projected area over the triangles that face the eye and have no
    other before them. ``seen`` are these areas, see :func:`seen_areas`, computed here where they are not given.
    """
    swing = shape.amplitude if shape.values is None else np.abs(shape.values)
    strength = (swing[housing.triangles] ** 2).mean(axis=1)
    areas = seen_areas(housing) if seen is None else seen
    shown = {name: float(area @ strength) for name, area in areas.items()}
    best = max(shown, key=lambda name: shown[name])
    return "iso" if shown["iso"] >= _AS_GOOD * shown[best] else best


def seen_areas(housing: DrawnHousing) -> dict[str, FloatArray]:
    """Projected area of each triangle as seen from each corner [m²], shape (n_triangles,); 0 of those that are hidden.

    They are of the housing at rest: one computation serves all its shapes.
    """
    a, b, c = np.moveaxis(housing.rest[housing.triangles], 1, 0)
    areas, centres = 0.5 * np.cross(b - a, c - a), (a + b + c) / 3.0
    return {name: _seen(housing, areas, centres, viewing_direction(name, housing.up)) for name in _CORNERS}


def _seen(housing: DrawnHousing, areas: FloatArray, centres: FloatArray, towards: FloatArray) -> FloatArray:
    projected = areas @ towards
    facing = np.flatnonzero(projected > 0.0)
    right = np.cross(housing.up, towards)
    right /= np.linalg.norm(right)
    across = centres[facing] @ np.stack([right, np.cross(towards, right)], axis=1)
    # Larger than the triangles, so that no cell of a near face is empty.
    cell = max(housing.diagonal / _CELLS, _LARGER * float(np.sqrt(np.linalg.norm(areas, axis=1).mean())))
    rows = np.floor((across - across.min(axis=0, initial=0.0)) / cell).astype(np.int64)
    cells, depth = rows[:, 0] * (rows[:, 1].max(initial=0) + 1) + rows[:, 1], centres[facing] @ towards
    nearest = np.full(cells.max(initial=-1) + 1, -np.inf)
    np.maximum.at(nearest, cells, depth)
    unhidden = facing[depth >= nearest[cells] - _SLANT * cell]
    seen = np.zeros(len(areas))
    seen[unhidden] = projected[unhidden]
    return seen
