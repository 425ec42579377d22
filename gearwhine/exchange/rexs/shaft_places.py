"""Places of shafts that a file does not state: from gear to gear by centre distances, along an axis by couplings.

From the axis of gear 1 that of gear 2 lies a centre distance away, in the direction of w turned by
``rotating_angle_around_neg_u_axis`` about -u: at 90° less this angle from x, which is v, to y, which is w.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from gearwhine.exchange.rexs.gear_unit import BEARINGS, COUPLINGS, GearUnit
from gearwhine.exchange.rexs.model import Component

Origin = tuple[float, float, float]


def place_shafts(unit: GearUnit) -> None:
    """Find the origins of shafts without a `support_vector`, as far as others lead to them; the first one's is 0."""
    shafts = list(unit.model.of_kind("shaft"))
    unplaced = {shaft.number: shaft for shaft in shafts if not shaft.has("support_vector")}
    if not unplaced or len(shafts) == 1:
        return
    if len(unplaced) == len(shafts):
        del unplaced[shafts[0].number]
    steps = [*_meshes(unit), *_joints(unit)]
    found = True
    while unplaced and found:
        found = False
        for known, other, move, reason in steps:
            if known.number not in unplaced and other.number in unplaced:
                x, y, z = (float(value) for value in unit.placement(known).origin)
                unit.moved[other.number] = (x + move[0], y + move[1], z + move[2])
                unit.notes.assumed(other.label, f"no support_vector: its place by {reason.label}")
                del unplaced[other.number]
                found = True


def _meshes(unit: GearUnit) -> Iterator[tuple[Component, Component, Origin, Component]]:
    """Yield the way from shaft to shaft by each pair of gears, in both senses, and its stage."""
    for relation in unit.model.of_relation("stage"):
        stage, gears = (
            unit.component(relation.role("stage")),
            [unit.component(relation.role(f"gear_{n}")) for n in (1, 2)],
        )
        if stage is None or gears[0] is None or gears[1] is None:
            continue
        shafts = [unit.model.assembly_of(gear.number, "shaft") for gear in gears if gear is not None]
        distance = stage.positive("center_distance", "m")
        if shafts[0] is None or shafts[1] is None or distance is None:
            continue
        turned = stage.number_of("rotating_angle_around_neg_u_axis", "rad") or 0.0
        along = [gear.number_of("u_coordinate_on_shaft", "m") or 0.0 for gear in gears if gear is not None]
        x, y = distance * math.sin(turned), distance * math.cos(turned)
        z = along[0] - along[1]
        yield shafts[0], shafts[1], (x, y, z), stage
        yield shafts[1], shafts[0], (-x, -y, -z), stage


def _joints(unit: GearUnit) -> Iterator[tuple[Component, Component, Origin, Component]]:
    """Yield the way from shaft to shaft by each coupling and bearing between two, in both senses."""
    for connection in unit.connections((*COUPLINGS, *BEARINGS)):
        inner, outer = connection.sides
        if inner is None or outer is None or {inner.kind, outer.kind} != {"shaft"}:
            continue
        first, second = connection.station(inner), connection.station(outer)
        if first is not None and second is not None:
            yield inner, outer, (0.0, 0.0, first - second), connection.component
            yield outer, inner, (0.0, 0.0, second - first), connection.component
