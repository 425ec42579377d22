"""Geometry checks of a box: walls, feet, ribs, fillets and bores, and the cover with its flange and bolts.

Each misfit names the dimension that does not fit and the value expected of it; all misfits are reported at once.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from gearwhine.meshes.box import layout
from gearwhine.meshes.box.layout import Block
from gearwhine.meshes.box.parts import FACES, OPPOSITE_FACES, Bolt, Bore, Box, Cover, Flange, Rib, plane_axes

SLACK = 1e-9
"""Rounding of lengths [m]."""


@dataclass(frozen=True)
class BoxMisfit:
    """A part of a box that does not fit.

    Attributes
    ----------
    location : tuple of str or int
        Attributes and indices from the :class:`~gearwhine.meshes.BoxGeometry` down, such as ``("ribs", 0, "at")``.
    expected : str
        The expected value, to be read after "expected".
    """

    location: tuple[str | int, ...]
    expected: str

    def __str__(self) -> str:
        """Write the misfit as a message."""
        place = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in self.location)
        return f"box: {place.lstrip('.')}: expected {self.expected}"


def mm(length: float) -> str:
    """Write a length [m] in mm for a message."""
    return f"{1e3 * length:.6g} mm"


_MOST_PER_EDGE = 200
_THINNEST_WALL = 1e-3
"""Thickness of a wall over the smallest size of its box."""


def cover_misfits(box: Box, cover: Cover) -> Iterator[BoxMisfit]:
    """Yield the misfits of a cover; bolts are checked only where the rim under them is sound."""
    sound = True
    for misfit in (*_flange_misfits(box, cover), *_bolt_sizes(cover)):
        sound = False
        yield misfit
    if box.feet is not None and cover.face == "bottom":
        sound = False
        yield BoxMisfit(("cover", "face"), "another face than the bottom, under which the feet stand")
    if sound and not cover.bonded:
        yield from _patch_misfits(box, cover)


def _flange_misfits(box: Box, cover: Cover) -> Iterator[BoxMisfit]:
    if cover.flange is None:
        return
    flange, normal = cover.flange, FACES[cover.face][0]
    depth = layout.cavity_block(box).size[normal]
    if not 0.0 < flange.thickness < depth:
        yield BoxMisfit(
            ("cover", "flange", "thickness"), f"a thickness above 0 and below the {mm(depth)} under the cover"
        )
    most = _widest_flange(box, cover, flange)
    if not 0.0 < flange.width < most:
        yield BoxMisfit(("cover", "flange", "width"), f"a width above 0 and below {mm(most)}")


def _widest_flange(box: Box, cover: Cover, flange: Flange) -> float:
    """Widest flange [m]: half of the opening inside; outside, up to the undersides of the feet."""
    axes = plane_axes(cover.face)
    if flange.side == "inside":
        return min(layout.cavity_block(box).size[axis] for axis in axes) / 2
    if box.feet is not None and 1 in axes:
        return box.feet.size[1]
    return max(box.size)


def _bolt_sizes(cover: Cover) -> Iterator[BoxMisfit]:
    location, bolts = ("cover", "bolts"), cover.bolts
    if bolts is None:
        if not cover.bonded:
            yield BoxMisfit(("cover",), "bolts, such as { diameter, per_edge }, or bonded = true")
        return
    if bolts.diameter <= 0.0:
        yield BoxMisfit((*location, "diameter"), "a diameter above 0")
    if (bolts.per_edge is None) == (not bolts.positions):
        yield BoxMisfit(location, "exactly one of 'per_edge' and 'positions'")
    for place, count in enumerate(bolts.per_edge or ()):
        if not 2 <= count <= _MOST_PER_EDGE:
            yield BoxMisfit((*location, "per_edge", place), f"from 2 to {_MOST_PER_EDGE} bolts, corners included")
    if bolts.patch_diameter is not None and bolts.patch_diameter <= bolts.diameter:
        yield BoxMisfit((*location, "patch_diameter"), f"a circle wider than the bolts, {mm(bolts.diameter)}")
    if bolts.grip is not None and bolts.grip <= 0.0:
        yield BoxMisfit((*location, "grip"), "a length above 0")


def _patch_misfits(box: Box, cover: Cover) -> Iterator[BoxMisfit]:
    """Yield bolts whose circles leave the rim or meet each other."""
    assert cover.bolts is not None
    bolts = layout.cover_bolts(box)
    by_place = bool(cover.bolts.positions)
    for index, bolt in enumerate(bolts):
        key: tuple[str | int, ...] = ("positions", index) if by_place else ("patch_diameter",)
        if not _on_rim(box, cover, bolt):
            expected = (
                f"circles of {mm(bolt.patch_diameter)} within the rim of the {cover.face} cover, which is "
                f"{mm(layout.rim_width(box, cover))} wide where it is narrowest (a flange makes it wider)"
            )
            yield BoxMisfit(("cover", "bolts", *key), expected)
            if not by_place:
                return
    for index, bolt in enumerate(bolts):
        for other in bolts[:index]:
            apart = math.dist(bolt.position, other.position)
            if apart <= bolt.patch_diameter:
                key = ("positions", index) if by_place else ("per_edge",)
                expected = (
                    f"bolts more than {mm(bolt.patch_diameter)} apart, the circle of each "
                    f"({bolt.name} and {other.name} are {mm(apart)} apart)"
                )
                yield BoxMisfit(("cover", "bolts", *key), expected)
                return


def _on_rim(box: Box, cover: Cover, bolt: Bolt) -> bool:
    """Whether a bolt's circle lies between the edge of the cover and the opening below it."""
    outer, opening = layout.plate_block(box, cover), layout.opening_block(box, cover)
    radius, axes = bolt.patch_diameter / 2, plane_axes(cover.face)
    place = [bolt.position[axis] for axis in axes]
    to_edge = [min(u - outer.low[axis], outer.high[axis] - u) for u, axis in zip(place, axes, strict=True)]
    beside = [max(opening.low[axis] - u, 0.0, u - opening.high[axis]) for u, axis in zip(place, axes, strict=True)]
    rounding = box.fillets.outside
    if max(to_edge) < rounding:  # in a corner of the rounded plate
        within = math.hypot(rounding - to_edge[0], rounding - to_edge[1]) + radius <= rounding + SLACK
    else:
        within = min(to_edge) >= radius - SLACK
    return within and math.hypot(*beside) >= radius - SLACK


_LEAST_CORNER = 0.25  # part of the thinner wall that must be left where an edge is rounded


def misfits(box: Box) -> Iterator[BoxMisfit]:
    """Yield everything that does not fit; checks that depend on an unsound part are left out.

    Ribs, cover and fillets are checked only where walls, feet and bores fit each other.
    """
    plain = [*_wall_misfits(box), *_foot_sizes(box)]
    for index, bore in enumerate(box.bores):
        plain += _bore_misfits(box, index, bore)
    plain += _bores_apart(box)
    if plain:
        yield from plain
        return
    sound = True
    for group in (_feet_misfits(box), _fillet_sizes(box), *(_rib_misfits(box, i) for i in range(len(box.ribs)))):
        for misfit in group:
            sound = False
            yield misfit
    if box.cover is not None:
        for misfit in cover_misfits(box, box.cover):
            sound = False
            yield misfit
    if sound:
        yield from _corner_misfits(box)
        yield from _rib_clashes(box)
        for index, bore in enumerate(box.bores):
            yield from _bore_clashes(box, index, bore)


def _wall_misfits(box: Box) -> Iterator[BoxMisfit]:
    """Yield walls that meet."""
    for axis, size, (low, high) in zip("xyz", box.size, OPPOSITE_FACES, strict=True):
        if box.wall.of(low) + box.wall.of(high) >= size:
            expected = f"{low} and {high} walls that leave room inside the {mm(size)} of the box along {axis}"
            yield BoxMisfit(("wall",), expected)
    least = _THINNEST_WALL * min(box.size)
    thin = [face for face in FACES if box.wall.of(face) < least]
    if thin:
        faces = "walls" if len(thin) == len(FACES) else f"{' and '.join(thin)} walls"
        yield BoxMisfit(("wall",), f"{faces} of at least {mm(least)}, a thousandth of the box: thinner ones are foil")


def _foot_sizes(box: Box) -> Iterator[BoxMisfit]:
    """Yield feet that touch: they would melt into one, and their undersides with them."""
    if box.feet is None:
        return
    base = layout.body_block(box).size
    for axis in (0, 2):
        if 2.0 * box.feet.size[axis] >= base[axis]:
            expected = f"feet of less than half the base along {'xyz'[axis]}, {mm(base[axis] / 2)}"
            yield BoxMisfit(("feet", "size", axis), expected)


def _bore_misfits(box: Box, index: int, bore: Bore) -> Iterator[BoxMisfit]:
    """Yield the misfits of a bore: in no end wall, or beyond its edge, with its boss or without."""
    half, location = box.size[2] / 2.0, ("bores", index)
    if layout.end_wall(box, bore) is None:
        expected = (
            f"z in the back wall, {mm(-half)} to {mm(-half + box.wall.back)}, "
            f"or in the front wall, {mm(half - box.wall.front)} to {mm(half)}: the seats of a box are bores through "
            "these walls; one between them, as around a ring gear, takes a housing from CAD or a mesh file"
        )
        yield BoxMisfit((*location, "center", 2), expected)
    if bore.boss is not None and bore.boss.length > box.size[2]:
        yield BoxMisfit((*location, "boss", "length"), f"a boss no longer than the box, {mm(box.size[2])}")
    x, y, _ = bore.center
    for feature, diameter in (("bore", bore.diameter), ("boss", bore.boss.diameter if bore.boss else 0.0)):
        over = max(abs(x) + diameter / 2.0 - box.size[0] / 2.0, diameter / 2.0 - y, y + diameter / 2.0 - box.size[1])
        if over > SLACK:
            expected = (
                f"a {feature} within its wall of {mm(box.size[0])} by {mm(box.size[1])}; around "
                f"x = {mm(x)}, y = {mm(y)} it reaches {mm(over)} beyond the edge"
            )
            yield BoxMisfit((*location, "diameter") if feature == "bore" else (*location, "boss", "diameter"), expected)
            return


def _bores_apart(box: Box) -> Iterator[BoxMisfit]:
    """Yield bores that touch another bore or its boss, which would break the cylinder of either."""
    for index, bore in enumerate(box.bores):
        for other in box.bores[:index]:
            wall = layout.end_wall(box, bore)
            if wall is None or wall != layout.end_wall(box, other):
                continue
            apart = math.hypot(bore.center[0] - other.center[0], bore.center[1] - other.center[1])
            bosses = [one.boss.diameter if one.boss else one.diameter for one in (bore, other)]
            needed = max(bore.diameter + bosses[1], bosses[0] + other.diameter) / 2.0
            if apart <= needed:
                expected = (
                    f'a bore clear of seat "{other.name}" and its boss (they overlap by {mm(needed - apart)}: centres '
                    f"{mm(apart)} apart, {mm(needed)} needed)"
                )
                yield BoxMisfit(("bores", index, "diameter"), expected)


def _feet_misfits(box: Box) -> Iterator[BoxMisfit]:
    if box.feet is None:
        return
    width, _, depth = box.feet.size
    patch = box.feet.bolt_patch
    if patch is not None and not 0.0 < patch < min(width, depth):
        yield BoxMisfit(
            ("feet", "bolt_patch"), f"a diameter above 0 and below that of the feet, {mm(min(width, depth))}"
        )
    if box.fillets.outside >= min(width, depth):
        yield BoxMisfit(("feet", "size"), f"feet larger than the rounding above them, {mm(box.fillets.outside)}")


def _fillet_sizes(box: Box) -> Iterator[BoxMisfit]:
    """Yield fillet radii for which a box's own edges leave no room."""
    for key, radius, block in (
        ("inside", box.fillets.inside, layout.cavity_block(box)),
        ("outside", box.fillets.outside, layout.body_block(box)),
    ):
        if radius < 0.0 or (radius > 0.0 and 2.0 * radius >= min(block.size)):
            where = "cavity" if key == "inside" else "box"
            yield BoxMisfit(
                ("fillets", key), f"a radius from 0 to less than half the {where}, {mm(min(block.size) / 2)}"
            )


def _corner_misfits(box: Box) -> Iterator[BoxMisfit]:
    """Yield an outer fillet that leaves too little wall at a sharper corner inside."""
    if box.fillets.outside == 0.0:
        return
    faces = [face for face in FACES if box.cover is None or face != box.cover.face]
    thinnest = math.inf
    for i, first in enumerate(faces):
        for second in faces[i + 1 :]:
            if FACES[first][0] != FACES[second][0]:
                walls = box.wall.of(first), box.wall.of(second)
                left = _corner_thickness(walls, box.fillets.outside, box.fillets.inside)
                thinnest = min(thinnest, left / min(walls))
    if thinnest < _LEAST_CORNER:
        expected = f"a radius that leaves a quarter of the wall at each edge; this one leaves {max(thinnest, 0.0):.0%}"
        yield BoxMisfit(("fillets", "outside"), f"{expected} (round the inside as well, or less outside)")


def _corner_thickness(walls: tuple[float, float], outside: float, inside: float) -> float:
    """Least material between a corner rounded outside and the one inside, in the plane across the edge [m]."""
    least = math.inf
    for step in range(33):
        angle = math.pi / 2 * step / 32
        u = walls[0] + inside * (1.0 - math.cos(angle))
        v = walls[1] + inside * (1.0 - math.sin(angle))
        if u < outside and v < outside:
            least = min(least, outside - math.hypot(outside - u, outside - v))
    return least


def _rib_misfits(box: Box, index: int) -> Iterator[BoxMisfit]:
    """Yield the dimensions of a rib that do not fit its wall."""
    rib, location = box.ribs[index], ("ribs", index)
    normal, _ = FACES[rib.face]
    if "xyz".index(rib.along) == normal:
        others = " or ".join(repr(axis) for axis in "xyz" if axis != "xyz"[normal])
        yield BoxMisfit((*location, "along"), f"{others}, which lie in the {rib.face} wall")
        return
    for key in ("height", "thickness"):
        if getattr(rib, key) <= 0.0:
            yield BoxMisfit((*location, key), "a length above 0")
            return
    limits = layout.rib_range(box, rib)
    across = 3 - normal - "xyz".index(rib.along)
    low, high = limits.low[across] + rib.thickness / 2, limits.high[across] - rib.thickness / 2
    if not low - SLACK <= rib.at <= high + SLACK:
        expected = f"a place on the wall, from {mm(low)} to {mm(high)} for a rib {mm(rib.thickness)} thick"
        yield BoxMisfit((*location, "at"), expected)
    yield from _rib_ends(rib, limits, location)
    room = layout.cavity_block(box).size[normal]
    if rib.side == "inside" and rib.height > room + SLACK:
        yield BoxMisfit((*location, "height"), f"at most the {mm(room)} inside the box")


def _rib_ends(rib: Rib, limits: Block, location: tuple[str | int, ...]) -> Iterator[BoxMisfit]:
    along = "xyz".index(rib.along)
    low, high = limits.low[along], limits.high[along]
    for key, end in (("start", rib.start), ("end", rib.end)):
        if end is not None and not low - SLACK <= end <= high + SLACK:
            expected = f"a place on the wall, which spans {rib.along} = {mm(low)} to {mm(high)} on its {rib.side}"
            yield BoxMisfit((*location, key), expected)
            return
    start, end = low if rib.start is None else rib.start, high if rib.end is None else rib.end
    if start >= end:
        yield BoxMisfit(
            (*location, "end" if rib.end is not None else "start"), f"an end beyond the start at {mm(start)}"
        )


def _rib_clashes(box: Box) -> Iterator[BoxMisfit]:
    """Yield ribs that run into feet, or across the joint of the cover into other ribs."""
    feet = layout.foot_blocks(box)
    blocks = [layout.rib_block(box, rib) for rib in box.ribs]
    for index, (rib, block) in enumerate(zip(box.ribs, blocks, strict=True)):
        if any(block.overlaps(foot) for foot in feet):
            yield BoxMisfit(("ribs", index), f"a rib clear of the feet on the {rib.face} wall")
        if not layout.on_cover(box, rib):
            continue
        for other, (its, its_block) in enumerate(zip(box.ribs, blocks, strict=True)):
            if not layout.on_cover(box, its) and block.overlaps(its_block):
                yield BoxMisfit(("ribs", index), f"a rib of the cover clear of the body's, ribs[{other}]")


def _bore_clashes(box: Box, index: int, bore: Bore) -> Iterator[BoxMisfit]:
    """Yield a bore that a part obstructs, or that crosses the joint of the cover."""
    start, end = box.bore_span(bore)
    radius = bore.diameter / 2
    x, y, _ = bore.center
    location = ("bores", index, "center")
    margin = 0.1 * (end - start)

    def stands_in(block: Block) -> bool:
        (x1, y1, z1), (x2, y2, z2) = block.low, block.high
        gap = math.hypot(max(x1 - x, 0.0, x - x2), max(y1 - y, 0.0, y - y2))
        return gap < radius - SLACK and z1 < end + margin and start - margin < z2

    for number, rib in enumerate(box.ribs):
        if stands_in(layout.rib_block(box, rib)):
            yield BoxMisfit(location, f"a bore clear of ribs; ribs[{number}] on the {rib.face} wall stands in it")
    if box.cover is not None:
        if any(stands_in(side) for side in layout.flange_sides(box, box.cover)):
            yield BoxMisfit(location, "a bore clear of the cover's flange")
        yield from _joint_clashes(box, index, bore)
    if box.fillets.inside > 0.0:
        cavity = layout.cavity_block(box).widened((0, 1), -box.fillets.inside)
        if any(
            value - radius < cavity.low[axis] - SLACK or value + radius > cavity.high[axis] + SLACK
            for axis, value in enumerate((x, y))
        ):
            yield BoxMisfit(location, f"a bore clear of the cavity's edges, rounded by {mm(box.fillets.inside)}")


def _joint_clashes(box: Box, index: int, bore: Bore) -> Iterator[BoxMisfit]:
    assert box.cover is not None
    normal, way = FACES[box.cover.face]
    radius = (bore.boss.diameter if bore.boss else bore.diameter) / 2
    if normal == 2:
        for bolt in box.bolts if layout.end_wall(box, bore) == box.cover.face else ():
            apart = math.hypot(bolt.position[0] - bore.center[0], bolt.position[1] - bore.center[1])
            if apart < bore.diameter / 2 + bolt.patch_diameter / 2:
                yield BoxMisfit(("bores", index, "center"), f"a bore clear of the cover's {bolt.name}")
        return
    plane = layout.parting_plane(box, box.cover.face)
    if way * (plane - bore.center[normal]) < radius - SLACK:
        feature = "boss" if bore.boss else "bore"
        expected = f"a {feature} clear of the joint under the {box.cover.face} cover, at {'xyz'[normal]} = {mm(plane)}"
        yield BoxMisfit(("bores", index, "center"), expected)
