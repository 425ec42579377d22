"""Layout of a box: places of its parts as plain blocks, rims and bolts [m]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from gearwhine.meshes.box.parts import FACES, Bolt, Bore, Box, Cover, Face, Point, Rib, plane_axes

_SLACK = 1e-9  # depth to which blocks that only touch may overlap by rounding [m]
RIB_DEPTH_IN_WALL = 0.5
"""Ribs reach into the walls they meet by this part of the thickness, so that rounded edges leave no gap below."""


@dataclass(frozen=True)
class Block:
    """A box along the axes: its corner of least x, y, z and its lengths [m]."""

    low: Point
    size: Point

    @property
    def high(self) -> Point:
        """The corner of greatest x, y, z [m]."""
        x, y, z = (a + length for a, length in zip(self.low, self.size, strict=True))
        return x, y, z

    def overlaps(self, other: Block) -> bool:
        """Whether the two have volume in common."""
        return all(
            a + _SLACK < d and c + _SLACK < b
            for a, b, c, d in zip(self.low, self.high, other.low, other.high, strict=True)
        )

    def replaced(self, axis: int, low: float | None = None, high: float | None = None) -> Block:
        """Return the block with other ends along one axis."""
        lows, lengths = list(self.low), list(self.size)
        if low is not None:
            lows[axis] = low
        if low is not None or high is not None:
            lengths[axis] = (self.high[axis] if high is None else high) - lows[axis]
        return Block((lows[0], lows[1], lows[2]), (lengths[0], lengths[1], lengths[2]))

    def widened(self, axes: tuple[int, int], by: float) -> Block:
        """Return the block with both ends along some axes moved outward."""
        block = self
        for axis in axes:
            block = block.replaced(axis, self.low[axis] - by, self.high[axis] + by)
        return block


def end_wall(box: Box, bore: Bore) -> Literal["back", "front"] | None:
    """Return the end wall that a bore goes through, by the z of its centre; None for neither."""
    z, half = bore.center[2], box.size[2] / 2
    slack = 1e-9 + 1e-6 * half
    if -half - slack <= z <= -half + box.wall.back + slack:
        return "back"
    return "front" if half - box.wall.front - slack <= z <= half + slack else None


def outer_block(box: Box) -> Block:
    """Return the outer block of the walls."""
    width, _, depth = box.size
    return Block((-width / 2, 0.0, -depth / 2), box.size)


def cavity_block(box: Box) -> Block:
    """Return the cavity inside the walls."""
    (x, y, z), (width, height, depth), wall = outer_block(box).low, box.size, box.wall
    return Block(
        (x + wall.left, y + wall.bottom, z + wall.back),
        (width - wall.left - wall.right, height - wall.bottom - wall.top, depth - wall.back - wall.front),
    )


def body_block(box: Box) -> Block:
    """Return the outer block of the walls without the cover."""
    return outer_block(box) if box.cover is None else _beside(box, outer_block(box), box.cover, plate=False)


def plate_block(box: Box, cover: Cover) -> Block:
    """Return the cover's plate, extended over an outside flange."""
    plate = _beside(box, outer_block(box), cover, plate=True)
    if cover.flange is not None and cover.flange.side == "outside":
        return plate.widened(plane_axes(cover.face), cover.flange.width)
    return plate


def parting_plane(box: Box, face: Face) -> float:
    """Place of the plane between cover and body along the normal of the cover's face [m]."""
    normal, way = FACES[face]
    outer = outer_block(box)
    return (outer.high if way > 0 else outer.low)[normal] - way * box.wall.of(face)


def _beside(box: Box, block: Block, cover: Cover, *, plate: bool) -> Block:
    """Cut a block at the parting plane: the part on the cover's side, or on the body's."""
    normal, way = FACES[cover.face]
    plane = parting_plane(box, cover.face)
    return block.replaced(normal, low=plane) if (way > 0) == plate else block.replaced(normal, high=plane)


def opening_block(box: Box, cover: Cover) -> Block:
    """Return the opening below the cover: the cavity up to its rim, without an inside flange."""
    cavity = cavity_block(box)
    if cover.flange is not None and cover.flange.side == "inside":
        return cavity.widened(plane_axes(cover.face), -cover.flange.width)
    return cavity


def flange_block(box: Box, cover: Cover) -> Block | None:
    """Return the layer of the flange, up to its outer edges; None without a flange."""
    if cover.flange is None:
        return None
    normal, way = FACES[cover.face]
    plane = parting_plane(box, cover.face)
    return plate_block(box, cover).replaced(
        normal, min(plane, plane - way * cover.flange.thickness), max(plane, plane - way * cover.flange.thickness)
    )


def flange_sides(box: Box, cover: Cover) -> tuple[Block, ...]:
    """Return the four sides of the flange beyond the walls, outward or inward; they overlap in the corners."""
    layer = flange_block(box, cover)
    if layer is None or cover.flange is None:
        return ()
    outside = cover.flange.side == "outside"
    hole = outer_block(box) if outside else opening_block(box, cover)
    frame = layer if outside else _within(layer, cavity_block(box), plane_axes(cover.face))
    sides = []
    for axis in plane_axes(cover.face):
        sides.append(frame.replaced(axis, high=hole.low[axis]))
        sides.append(frame.replaced(axis, low=hole.high[axis]))
    return tuple(sides)


def _within(block: Block, limits: Block, axes: tuple[int, int]) -> Block:
    for axis in axes:
        block = block.replaced(axis, limits.low[axis], limits.high[axis])
    return block


def foot_blocks(box: Box) -> tuple[Block, ...]:
    """Return the feet in the order foot-1 (−x −z), foot-2 (+x −z), foot-3 (+x +z), foot-4 (−x +z)."""
    if box.feet is None:
        return ()
    body = body_block(box)
    fx, fy, fz = box.feet.size
    (low_x, base, low_z), (high_x, _, high_z) = body.low, body.high
    corners = ((low_x, low_z), (high_x - fx, low_z), (high_x - fx, high_z - fz), (low_x, high_z - fz))
    return tuple(Block((x, base - fy, z), box.feet.size) for x, z in corners)


def on_cover(box: Box, rib: Rib) -> bool:
    """Whether a rib stands on the cover's plate."""
    return box.cover is not None and box.cover.face == rib.face


def rib_range(box: Box, rib: Rib) -> Block:
    """Space for a rib on its wall; by default a rib runs along all of it."""
    if on_cover(box, rib):
        assert box.cover is not None
        return plate_block(box, box.cover) if rib.side == "outside" else opening_block(box, box.cover)
    return body_block(box) if rib.side == "outside" else cavity_block(box)


def rib_block(box: Box, rib: Rib) -> Block:
    """Return a rib from the wall that it stands on to its top."""
    normal, way = FACES[rib.face]
    along = "xyz".index(rib.along)
    across = 3 - normal - along
    limits = rib_range(box, rib)
    outward = way if rib.side == "outside" else -way
    walls = outer_block(box) if rib.side == "outside" else cavity_block(box)
    foot = (walls.high if way > 0 else walls.low)[normal]
    top = foot + outward * rib.height
    return (
        limits.replaced(normal, min(foot, top), max(foot, top))
        .replaced(across, rib.at - rib.thickness / 2, rib.at + rib.thickness / 2)
        .replaced(along, rib.start, rib.end)
    )


def sunk_rib_block(box: Box, rib: Rib) -> Block:
    """Extend a rib by its roots, into its own wall and, inside, into every wall at which it ends."""
    block, cavity = rib_block(box, rib), cavity_block(box)
    if rib.side == "outside" or on_cover(box, rib):
        normal, way = FACES[rib.face]
        inward = -way if rib.side == "outside" else way
        return _lengthened(block, normal, inward, RIB_DEPTH_IN_WALL * box.wall.of(rib.face))
    for face, (axis, way) in FACES.items():
        end, wall = (block.high[axis], cavity.high[axis]) if way > 0 else (block.low[axis], cavity.low[axis])
        if abs(end - wall) < 1e-9:
            block = _lengthened(block, axis, way, RIB_DEPTH_IN_WALL * box.wall.of(face))
    return block


def _lengthened(block: Block, axis: int, way: int, by: float) -> Block:
    if way > 0:
        return block.replaced(axis, high=block.high[axis] + by)
    return block.replaced(axis, low=block.low[axis] - by)


def rim_width(box: Box, cover: Cover) -> float:
    """Width of the rim under the cover where it is narrowest [m]."""
    walls = [box.wall.of(face) for face, (normal, _) in FACES.items() if normal != FACES[cover.face][0]]
    return min(walls) + (cover.flange.width if cover.flange is not None else 0.0)


def cover_bolts(box: Box) -> tuple[Bolt, ...]:
    """Place the bolts of the cover in order: rows go round the rim from its lowest corner; none where it is bonded."""
    cover = box.cover
    if cover is None or cover.bonded or cover.bolts is None:
        return ()
    pattern, (normal, way) = cover.bolts, FACES[cover.face]
    thickness = box.wall.of(cover.face)
    depth = pattern.diameter if cover.flange is None else min(cover.flange.thickness, pattern.diameter)
    bolts = []
    for number, place in enumerate(pattern.positions or _rows(box, cover), start=1):
        position, axis = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        position[normal], axis[normal] = parting_plane(box, cover.face), float(way)
        for plane_axis, value in zip(plane_axes(cover.face), place, strict=True):
            position[plane_axis] = value
        bolts.append(
            Bolt(
                name=f"bolt-{number}",
                position=(position[0], position[1], position[2]),
                axis=(axis[0], axis[1], axis[2]),
                diameter=pattern.diameter,
                grip=thickness + depth / 2 if pattern.grip is None else pattern.grip,
                patch_diameter=2 * pattern.diameter if pattern.patch_diameter is None else pattern.patch_diameter,
                cover_thickness=thickness,
            )
        )
    return tuple(bolts)


def _rows(box: Box, cover: Cover) -> list[tuple[float, float]]:
    """Even rows on the middle line of the rim, once round from its lowest corner."""
    assert cover.bolts is not None
    outer, opening = plate_block(box, cover), opening_block(box, cover)
    (a, b), (n_a, n_b) = plane_axes(cover.face), cover.bolts.per_edge or (2, 2)
    low_a, high_a = (outer.low[a] + opening.low[a]) / 2, (outer.high[a] + opening.high[a]) / 2
    low_b, high_b = (outer.low[b] + opening.low[b]) / 2, (outer.high[b] + opening.high[b]) / 2
    along = [low_a + (high_a - low_a) * i / (n_a - 1) for i in range(n_a)]
    across = [low_b + (high_b - low_b) * i / (n_b - 1) for i in range(n_b)]
    places = [(u, low_b) for u in along] + [(high_a, v) for v in across[1:]]
    return places + [(u, high_b) for u in along[-2::-1]] + [(low_a, v) for v in across[-2:0:-1]]
