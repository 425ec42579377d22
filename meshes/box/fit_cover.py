"""Geometry checks of a box's cover, its flange and its bolts."""

from __future__ import annotations

import math
from collections.abc import Iterator

from meshes.box import layout
from meshes.box.misfit import SLACK, BoxMisfit, mm
from meshes.box.parts import FACES, Bolt, Box, Cover, Flange, plane_axes

_MOST_PER_EDGE = 200


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
    """Bolts whose circles leave the rim or meet each other."""
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
    if max(to_edge) < rounding:  # in a corner, rounded where the plate is
        within = math.hypot(rounding - to_edge[0], rounding - to_edge[1]) + radius <= rounding + SLACK
    else:
        within = min(to_edge) >= radius - SLACK
    return within and math.hypot(*beside) >= radius - SLACK
