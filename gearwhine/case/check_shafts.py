"""Checks of stations on rotors, and of rotor axes against bearing seats."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from gearwhine.case.analysis import HarmonicTorque, Probe, TorsionProbe, TorsionSpring
from gearwhine.case.draft import Draft
from gearwhine.case.housing import Seat
from gearwhine.case.problems import UNSAID, Finding, Location
from gearwhine.case.rotors import Rotor
from gearwhine.case.shafts import Bearing

NEAREST_POINTS = 1e-6
"""Distance between two points of a bow below which they are one, as a part of the rotor's length."""


def millimetres(length: float) -> str:
    """Write a length [m] in mm, for a message."""
    return f"{length * 1e3:.6g} mm"


def check_shafts(draft: Draft) -> Iterator[Finding]:
    """Yield stations beyond the ends of their rotor, bow points in one place, and bearings away from their seats."""
    for index, rotor in draft.rotors:
        stations = {
            "discs": [disc.at for disc in rotor.discs],
            "unbalance": [unbalance.at for unbalance in rotor.unbalance],
            "bow": [bow.at for bow in rotor.bow],
        }
        for kind, places in stations.items():
            for place, at in enumerate(places):
                yield from check_station(rotor, at, ("rotor", index, kind, place, "at"))
        yield from _check_bow(index, rotor)
    for keys, entries in _analysed(draft):
        for place, entry in enumerate(entries):
            watched = draft.rotor(entry.rotor)
            if watched is not None:
                yield from check_station(watched, entry.at, ("rotor_analysis", *keys, place, "at"))
    for index, bearing in draft.bearings:
        supported = draft.rotor(bearing.rotor)
        if supported is None:
            continue
        yield from check_station(supported, bearing.at, ("bearing", index, "at"))
        seat = next((seat for _, seat in draft.seats if seat.name == bearing.seat), None)
        if seat is not None:
            yield from _check_seat(draft, index, bearing, supported, seat)
    for index, gear in draft.gears:
        carrier = draft.rotor(gear.rotor)
        if carrier is not None and gear.at is not None:
            yield from check_station(carrier, gear.at, ("gear", index, "at"))


def _analysed(
    draft: Draft,
) -> Iterator[tuple[tuple[str, str], Sequence[Probe | HarmonicTorque | TorsionSpring | TorsionProbe]]]:
    """Yield what an analysis of rotors puts on their stations, with its keys."""
    if draft.analysis is None:
        return
    yield ("unbalance_response", "probes"), draft.analysis.unbalance_response.probes
    torsion = draft.analysis.torsional_response
    if torsion is not None:
        yield ("torsional_response", "torques"), torsion.torques
        yield ("torsional_response", "springs"), torsion.springs
        yield ("torsional_response", "probes"), torsion.probes


def check_station(rotor: Rotor, at: float, location: Location) -> Iterator[Finding]:
    """Yield a finding where a station lies beyond the right end of its rotor."""
    if at > rotor.length * (1.0 + 1e-9):
        yield Finding(location, f'a station on rotor "{rotor.name}", which is {millimetres(rotor.length)} long')


def _check_bow(index: int, rotor: Rotor) -> Iterator[Finding]:
    """Yield a bow of one point, which bends nothing, and points of a bow where another one stands already."""
    if len(rotor.bow) == 1:
        expected = (
            "two points or more: the centre line through one is straight and bends no shaft; add the points that stay "
            "on the axis, such as the bearings', with an amplitude of 0"
        )
        yield Finding(("rotor", index, "bow"), expected, UNSAID)
    for place, point in enumerate(rotor.bow):
        if any(abs(point.at - other.at) <= NEAREST_POINTS * rotor.length for other in rotor.bow[:place]):
            yield Finding(
                ("rotor", index, "bow", place, "at"), "a station of its own; another point of the bow is here"
            )


def _check_seat(draft: Draft, index: int, bearing: Bearing, rotor: Rotor, seat: Seat) -> Iterator[Finding]:
    """Yield findings where a rotor's axis or a bearing's place along it misses the seat."""
    from coupling.gear_train import LARGEST_OFFSET

    offset = math.hypot(rotor.axis[0] - seat.center[0], rotor.axis[1] - seat.center[1])
    if offset > LARGEST_OFFSET:
        expected = (
            f'a seat on the axis of rotor "{rotor.name}"; the seat\'s centre is {millimetres(offset)} off it '
            f"(axis at {millimetres(rotor.axis[0])}, {millimetres(rotor.axis[1])}; "
            f"centre at {millimetres(seat.center[0])}, {millimetres(seat.center[1])})"
        )
        yield Finding(("bearing", index, "seat"), expected)
    wall = 0.0
    if draft.box is not None:
        wall = draft.box.walls.front if seat.center[2] > 0.0 else draft.box.walls.back
    reach = seat.diameter / 2.0 + wall + (seat.boss.length if seat.boss is not None else 0.0)
    gap = rotor.start + bearing.at - seat.center[2]
    if abs(gap) > reach and bearing.at <= rotor.length:  # beyond the rotor is a finding of its own
        expected = (
            f'a station within {millimetres(reach)} of seat "{seat.name}" along z (this one is at '
            f"z = {millimetres(rotor.start + bearing.at)}, the seat at {millimetres(seat.center[2])})"
        )
        yield Finding(("bearing", index, "at"), expected)
