"""Faces of a box whose places follow from its dimensions: planes along the axes, cylinders of bores and bosses."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meshes.box import layout
from meshes.box.geometry import BoxGeometry
from meshes.box.layout import Block
from meshes.elements import FloatArray
from meshes.errors import GeometryError


class MorphError(GeometryError):
    """A mesh cannot follow its geometry: the geometry needs a new mesh."""


@dataclass(frozen=True)
class Plane:
    """A rectangle normal to an axis: its place and its extent."""

    axis: int
    at: float
    low: FloatArray
    high: FloatArray


@dataclass(frozen=True)
class Cylinder:
    """A cylinder along z: axis in x and y, radius, span in z."""

    center: FloatArray
    radius: float
    span: tuple[float, float]


def carried(places: FloatArray, before: Cylinder, after: Cylinder) -> FloatArray:
    """Displacements in x and y of points of a cylinder that moves [m]."""
    return np.asarray(
        after.center - before.center + (after.radius / before.radius - 1.0) * (places[:, :2] - before.center)
    )


def on_cylinders(
    places: FloatArray, cylinders: list[Cylinder], slack: float
) -> tuple[npt.NDArray[np.bool_], list[tuple[int, npt.NDArray[np.bool_]]]]:
    """Find the facets whose corners lie on a cylinder, and the cylinder of each."""
    upright = np.ptp(places[:, :, 2], axis=1) > 1e2 * slack  # the end faces' facets have all corners at one height
    any_, members = np.zeros(len(places), dtype=bool), []
    for number, cylinder in enumerate(cylinders):
        radius = np.linalg.norm(places[:, :, :2] - cylinder.center, axis=2)
        inside = (places[:, :, 2] > cylinder.span[0] - slack) & (places[:, :, 2] < cylinder.span[1] + slack)
        member = upright & (np.abs(radius - cylinder.radius) < slack).all(axis=1) & inside.all(axis=1)
        if member.any():
            members.append((number, member))
            any_ |= member
    return any_, members


def check_faces(box: BoxGeometry) -> None:
    if box.fillets.inside or box.fillets.outside:
        raise MorphError("a box with rounded edges: its mesh is not moved, its dimensions cannot be fitted")
    if box.bolts or (box.feet is not None and box.feet.bolt_patch is not None):
        raise MorphError("a box with circles of bolts: its mesh is not moved, its dimensions cannot be fitted")


def parts_of(box: BoxGeometry) -> tuple[object, ...]:
    """Features that two geometries must share so that the mesh of one can be morphed to the other."""
    bores = tuple((bore.name, box.end_wall(bore), bore.boss is None) for bore in box.bores)
    ribs = tuple((rib.face, rib.along, rib.side, rib.start is None, rib.end is None) for rib in box.ribs)
    cover = None if box.cover is None else (box.cover.face, box.cover.flange is None, box.cover.bonded)
    return bores, ribs, cover, box.feet is None


def _blocks(box: BoxGeometry) -> list[Block]:
    blocks = [layout.outer_block(box), layout.cavity_block(box), *layout.foot_blocks(box)]
    blocks += [layout.rib_block(box, rib) for rib in box.ribs]
    if box.cover is not None:
        blocks += [layout.plate_block(box, box.cover), layout.opening_block(box, box.cover)]
        flange = layout.flange_block(box, box.cover)
        blocks += [] if flange is None else [flange]
    return blocks


def planes_of(box: BoxGeometry) -> list[Plane]:
    planes = []
    for block in _blocks(box):
        low, high = np.array(block.low), np.array(block.high)
        for axis in range(3):
            for at in (low[axis], high[axis]):
                near, far = low.copy(), high.copy()
                near[axis] = far[axis] = at
                planes.append(Plane(axis, float(at), near, far))
    for bore in box.bores:
        if bore.boss is not None:
            start, end = box.bore_span(bore)
            at = start if box.end_wall(bore) == "back" else end
            x, y, _ = bore.center
            r = bore.boss.diameter / 2
            planes.append(Plane(2, at, np.array([x - r, y - r, at]), np.array([x + r, y + r, at])))
    return planes


def cylinders_of(box: BoxGeometry) -> list[Cylinder]:
    cylinders = []
    for bore in box.bores:
        center, span = np.array(bore.center[:2]), box.bore_span(bore)
        cylinders.append(Cylinder(center, bore.diameter / 2, span))
        if bore.boss is not None:
            cylinders.append(Cylinder(center, bore.boss.diameter / 2, span))
    return cylinders
