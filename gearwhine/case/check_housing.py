"""Checks of the housing: one geometry, and everything in its place on a box."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from gearwhine.case.box import Box
from gearwhine.case.box_shape import box_misfits
from gearwhine.case.check_shafts import millimetres
from gearwhine.case.draft import Draft
from gearwhine.case.housing import Seat
from gearwhine.case.patches import Patch
from gearwhine.case.problems import NOTHING, Finding, Location, did_you_mean

_SLACK = 1e-9
"""Room for rounding where two lengths may just touch [m]."""


def check_housing_form(draft: Draft) -> Iterator[Finding]:
    """Yield choices that are not made exactly once: the geometry, and how many modes."""
    housing = draft.document.get("housing")
    if not isinstance(housing, Mapping):
        return
    forms = [key for key in ("box", "cad", "mesh") if key in housing]
    if len(forms) != 1:
        value = forms or NOTHING
        expected = "exactly one of [housing.box], [housing.cad] and [housing.mesh]"
        yield Finding(("housing",), expected, value)
    limits = [key for key in ("frequency_limit", "modes") if key in housing]
    if len(limits) != 1:
        expected = "exactly one of 'frequency_limit' (such as '3.2 kHz') and 'modes' (such as 25)"
        yield Finding(("housing",), expected, limits or NOTHING)
    ratios, modes = housing.get("damping_ratio"), housing.get("modes")
    if isinstance(ratios, list) and isinstance(modes, int) and len(ratios) != modes:
        yield Finding(("housing", "damping_ratio"), f"a ratio for each of the {modes} modes (there are {len(ratios)})")


def check_box(draft: Draft) -> Iterator[Finding]:
    """Yield what does not fit a box: its walls and parts, seats, supports and sensors."""
    box = draft.box
    if box is None:
        return
    plain = list(_check_walls(box))
    for index, seat in draft.seats:
        plain += _check_seat(box, index, seat)
    plain += _check_seats_apart(draft, box)
    yield from plain
    if not plain:
        # Only where walls and bores are sound does it mean something where ribs, cover and fillets meet them.
        yield from box_misfits(box, draft.seats)
    yield from _check_surfaces(draft, box)
    boss = max((seat.boss.length for _, seat in draft.seats if seat.boss is not None), default=0.0)
    for location, patch in _patches(draft):
        yield from _check_patch(box, location, patch, boss)
    for index, sensor in draft.sensors:
        found = list(_check_on_surface(box, ("housing", "sensor", index, "position"), sensor.position, boss))
        yield from found or _check_in_bore(draft, box, ("housing", "sensor", index, "position"), sensor.position)
    for index, mass in draft.masses:
        if mass.position is not None:
            yield from _check_on_surface(box, ("housing", "mass", index, "position"), mass.position, boss)


def _patches(draft: Draft) -> Iterator[tuple[Location, Patch]]:
    """Yield all that is fastened to one patch, with its place in the case."""
    for kind, entries in (("support", draft.supports), ("mount", draft.mounts), ("mass", draft.masses)):
        for index, entry in entries:
            yield ("housing", kind, index), entry


def _check_walls(box: Box) -> Iterator[Finding]:
    """Yield walls that meet, and feet that overlap."""
    walls = box.walls
    pairs = (("left", "right"), ("bottom", "top"), ("back", "front"))
    for axis, size, (low, high) in zip("xyz", box.size, pairs, strict=True):
        if getattr(walls, low) + getattr(walls, high) >= size:
            expected = f"{low} and {high} walls that leave room inside the {millimetres(size)} of the box along {axis}"
            yield Finding(("housing", "box", "wall"), expected)
    if box.feet is not None:
        for place, axis in ((0, "x"), (2, "z")):
            if 2.0 * box.feet.size[place] > box.size[place] + _SLACK:
                expected = f"feet of at most half the base along {axis}, {millimetres(box.size[place] / 2)}"
                yield Finding(("housing", "box", "feet", "size", place), expected)


def _wall_of(box: Box, seat: Seat) -> str | None:
    """Return which end wall a seat is in; None for neither."""
    z, half = seat.center[2], box.size[2] / 2.0
    if -half - _SLACK <= z <= -half + box.walls.back + _SLACK:
        return "back"
    return "front" if half - box.walls.front - _SLACK <= z <= half + _SLACK else None


def _check_seat(box: Box, index: int, seat: Seat) -> Iterator[Finding]:
    """Yield a seat that is in no end wall, or whose bore or boss leaves it."""
    location, half = ("housing", "seat", index), box.size[2] / 2.0
    if _wall_of(box, seat) is None:
        expected = (
            f"z in the back wall, {millimetres(-half)} to {millimetres(-half + box.walls.back)}, "
            f"or in the front wall, {millimetres(half - box.walls.front)} to {millimetres(half)}"
        )
        yield Finding((*location, "center", 2), expected)
    for kind, diameter in (("bore", seat.diameter), ("boss", seat.boss.diameter if seat.boss else 0.0)):
        x, y, radius = seat.center[0], seat.center[1], diameter / 2.0
        over = max(abs(x) + radius - box.upper[0], radius - y, y + radius - box.upper[1])
        if over > _SLACK:
            key = (*location, "diameter") if kind == "bore" else (*location, "boss", "diameter")
            expected = (
                f"a {kind} within its wall of {millimetres(box.size[0])} by {millimetres(box.size[1])}; around "
                f"x = {millimetres(x)}, y = {millimetres(y)} it reaches {millimetres(over)} beyond the edge"
            )
            yield Finding(key, expected)
            return


def _check_seats_apart(draft: Draft, box: Box) -> Iterator[Finding]:
    """Yield bores that touch another bore or its boss."""
    for place, (index, seat) in enumerate(draft.seats):
        for _, other in draft.seats[:place]:
            if _wall_of(box, seat) is None or _wall_of(box, seat) != _wall_of(box, other):
                continue
            apart = math.hypot(seat.center[0] - other.center[0], seat.center[1] - other.center[1])
            bosses = [s.boss.diameter if s.boss else s.diameter for s in (seat, other)]
            needed = max(seat.diameter + bosses[1], bosses[0] + other.diameter) / 2.0
            if apart <= needed:
                expected = (
                    f'a bore clear of seat "{other.name}" and its boss (they overlap by '
                    f"{millimetres(needed - apart)}: centres {millimetres(apart)} apart, {millimetres(needed)} needed)"
                )
                yield Finding(("housing", "seat", index, "diameter"), expected)


def _check_surfaces(draft: Draft, box: Box) -> Iterator[Finding]:
    """Yield surfaces that the box does not have, under supports and whatever else is fastened to it."""
    seats = draft.names("housing", "seat")
    known = (*box.surfaces, *seats)
    listed = [name for name in known if not name.startswith("bolt-")]
    named: list[tuple[Location, str | None]] = [
        ((*place, "surface"), patch.surface) for place, patch in _patches(draft)
    ]
    for index, joint in draft.joints:
        for end, surface in enumerate(joint.surfaces or ()):
            named.append((("housing", "joint", index, "surfaces", end), surface))
    for location, name in named:
        if name is not None and name not in known:
            feet = "" if box.feet is not None else "; it has no feet"
            bolts = ", bolt-1-cover …" if len(listed) < len(known) else ""
            expected = f"a surface of the box ({', '.join(listed)}{bolts}{feet})"
            yield Finding(location, expected + did_you_mean(name, known))


def _check_patch(box: Box, place: Location, patch: Patch, boss: float) -> Iterator[Finding]:
    """Yield a patch whose box holds no material: outside the housing, or all in its cavity.

    ``boss`` is how far the longest boss stands out of the end walls [m].
    """
    foot, out = box.feet.size[1] if box.feet is not None else 0.0, box.stands_out
    bottom = (box.lower[0] - out, box.lower[1] - max(foot, out), box.lower[2] - max(boss, out))
    top = (box.upper[0] + out, box.upper[1] + out, box.upper[2] + max(boss, out))
    if patch.plane is not None:
        normal, at = "xyz".index(patch.plane.axis), patch.plane.at
        if not bottom[normal] - _SLACK <= at <= top[normal] + _SLACK:
            spans = f"{patch.plane.axis} = {millimetres(bottom[normal])} to {millimetres(top[normal])}"
            yield Finding((*place, "plane", "at"), f"a plane that meets the housing, which spans {spans}")
    if patch.corners is None:
        return
    low, high = patch.corners
    walls = box.walls
    inside_low = (box.lower[0] + walls.left, box.lower[1] + walls.bottom, box.lower[2] + walls.back)
    inside_high = (box.upper[0] - walls.right, box.upper[1] - walls.top, box.upper[2] - walls.front)
    location = (*place, "box")
    for axis, least, most, begin, end in zip("xyz", low, high, bottom, top, strict=True):
        if least > end + _SLACK or most < begin - _SLACK:
            expected = f"a box that meets the housing, which spans {axis} = {millimetres(begin)} to {millimetres(end)}"
            yield Finding(location, expected)
            return
    if not box.furnished and all(
        a > b and c < d for a, b, c, d in zip(low, inside_low, high, inside_high, strict=True)
    ):
        yield Finding(location, "a box that meets the housing's walls; this one is all in its cavity")


def _check_in_bore(
    draft: Draft, box: Box, location: Location, position: tuple[float, float, float]
) -> Iterator[Finding]:
    """Yield a point in the air of a bore, further from its rim than the wall is thick."""
    half = 0.5 * box.size[2]
    for _, seat in draft.seats:
        wall = _wall_of(box, seat)
        if wall is None:
            continue
        low, high = (-half, -half + box.walls.back) if wall == "back" else (half - box.walls.front, half)
        apart = math.hypot(position[0] - seat.center[0], position[1] - seat.center[1])
        deep = 0.5 * seat.diameter - apart
        if deep > high - low and low - _SLACK <= position[2] <= high + _SLACK:
            expected = f'a point on the surface of the box; this one is in the bore of seat "{seat.name}", '
            yield Finding(location, expected + f"{millimetres(deep)} from its rim")
            return


def _check_on_surface(
    box: Box, location: Location, position: tuple[float, float, float], boss: float
) -> Iterator[Finding]:
    """Yield a point that is further from the box's surface than its walls are thick."""
    walls = box.walls
    names = ("left", "bottom", "back", "right", "top", "front")  # the order of the depths below
    depths = [
        *(p - low for p, low in zip(position, box.lower, strict=True)),
        *(high - p for p, high in zip(position, box.upper, strict=True)),
    ]
    outside = math.hypot(*(min(a, b, 0.0) for a, b in zip(depths[:3], depths[3:], strict=True)))
    thickness = [getattr(walls, name) for name in names]
    foot = box.feet.size[1] if box.feet is not None else 0.0
    if outside > max(*thickness, boss, foot, box.stands_out) + _SLACK:
        expected = f"a point on the surface of the box; this one is {millimetres(outside)} outside"
        yield Finding(location, expected)
    elif box.furnished or outside > 0.0:
        return
    elif all(depth > wall + _SLACK for depth, wall in zip(depths, thickness, strict=True)):
        nearest = min(range(6), key=lambda face: depths[face])
        expected = (
            f"a point on the surface of the box; this one is in its cavity, {millimetres(depths[nearest])} from "
            f"the {names[nearest]} face"
        )
        yield Finding(location, expected)
