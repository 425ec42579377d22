"""Surface points of a box: whether a place is on its surface within the thickness of its walls."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from gearwhine.meshes.box.geometry import BoxGeometry
from gearwhine.meshes.box.parts import FACES
from gearwhine.numerics.findings import in_mm

_SLACK = 1e-9
"""Room for rounding where two lengths may just touch [m]."""

Point = tuple[float, float, float]


def point_off_surface(
    position: Point,
    size: Point,
    walls: Mapping[str, float],
    *,
    stands_out: float = 0.0,
    furnished: bool = False,
    bores: Sequence[tuple[str, Point, float]] = (),
) -> str:
    """Say why a place is not on the surface of a box; empty where it is.

    Parameters
    ----------
    position : tuple of float
        Place [m].
    size : tuple of float
        Outside lengths of the box along x, y, z [m].
    walls : mapping of str to float
        Thickness of the wall of each face [m]: a place may be off the surface by as much.
    stands_out : float
        Height of the highest part outside the walls [m].
    furnished : bool
        Whether parts lie inside, on which a place may be.
    bores : sequence of (str, tuple of float, float)
        Name, centre and diameter [m] of each bore, in whose air no place is.

    Returns
    -------
    str
        To be read after "expected".
    """
    low, high = (-0.5 * size[0], 0.0, -0.5 * size[2]), (0.5 * size[0], size[1], 0.5 * size[2])
    faces = ("left", "bottom", "back", "right", "top", "front")
    depths = [
        *(p - least for p, least in zip(position, low, strict=True)),
        *(most - p for p, most in zip(position, high, strict=True)),
    ]
    thickness = [walls[face] for face in faces]
    outside = math.hypot(*(min(a, b, 0.0) for a, b in zip(depths[:3], depths[3:], strict=True)))
    if outside > max(*thickness, stands_out) + _SLACK:
        return f"a point on the surface of the box; this one is {in_mm(outside)} outside"
    if not furnished and outside == 0.0 and all(d > t + _SLACK for d, t in zip(depths, thickness, strict=True)):
        nearest = min(range(6), key=lambda face: depths[face])
        return (
            f"a point on the surface of the box; this one is in its cavity, {in_mm(depths[nearest])} from "
            f"the {faces[nearest]} face"
        )
    for name, center, diameter in bores:
        deep = 0.5 * diameter - math.hypot(position[0] - center[0], position[1] - center[1])
        for begin, end in ((low[2], low[2] + walls["back"]), (high[2] - walls["front"], high[2])):
            through = all(begin - _SLACK <= z <= end + _SLACK for z in (center[2], position[2]))
            if through and deep > end - begin:
                return (
                    f'a point on the surface of the box; this one is in the bore of seat "{name}", '
                    f"{in_mm(deep)} from its rim"
                )
    return ""


def point_off_box(position: Point, box: BoxGeometry) -> str:
    """Say why a place [m] is not on the surface of a box, as :func:`point_off_surface`."""
    flange = box.cover.flange if box.cover is not None else None
    heights = [rib.height for rib in box.ribs if rib.side == "outside"]
    heights += [bore.boss.length for bore in box.bores if bore.boss is not None]
    heights += [box.feet.size[1]] if box.feet is not None else []
    heights += [flange.width] if flange is not None and flange.side == "outside" else []
    inside = any(rib.side == "inside" for rib in box.ribs) or box.fillets.inside > 0.0
    return point_off_surface(
        position,
        box.size,
        {face: box.wall.of(face) for face in FACES},
        stands_out=max(heights, default=0.0),
        furnished=inside or (flange is not None and flange.side == "inside"),
        bores=[(bore.name, bore.center, bore.diameter) for bore in box.bores],
    )
