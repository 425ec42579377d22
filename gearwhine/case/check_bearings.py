"""Checks of bearings: tables over speed that fit and reach far enough, pedestals on the ground."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import pi

from gearwhine.case.draft import Draft
from gearwhine.case.problems import NOTHING, Finding
from gearwhine.case.running import listed
from gearwhine.case.shafts import Bearing, RadialDamping, RadialStiffness

_ROUNDING = 1e-9  # what a printed speed may miss of the one it stands for
_RPM = 30.0 / pi


def check_bearings(draft: Draft) -> Iterator[Finding]:
    """Yield tables that do not fit their speeds or end too early, and pedestals in the housing."""
    ratios = _ratios(draft)
    for index, bearing in draft.bearings:
        yield from _check_tables(index, bearing)
        if bearing.pedestal is not None and not bearing.grounded:
            expected = f'no pedestal under a bearing in seat "{bearing.seat}", which moves with the housing'
            yield Finding(("bearing", index, "pedestal"), expected)
        if draft.transient is not None and bearing.pedestal is not None and bearing.pedestal.mass == 0.0:
            yield Finding(("bearing", index, "pedestal", "mass"), "a mass above 0, to be followed in time", NOTHING)
        if bearing.speeds is not None and bearing.rotor in ratios:
            yield from _check_reach(draft, index, bearing, bearing.speeds, abs(float(ratios[bearing.rotor])))


def _check_tables(index: int, bearing: Bearing) -> Iterator[Finding]:
    """Yield lists of another length than the speeds, and speeds or lists without the other."""
    tabled = False
    for kind in ("stiffness", "damping"):
        table = getattr(bearing, kind)
        if not isinstance(table, RadialStiffness | RadialDamping):
            continue
        for key in ("xx", "yy", "xy", "yx"):
            given = getattr(table, key)
            if not isinstance(given, tuple):
                continue
            tabled = True
            count = 0 if bearing.speeds is None else len(bearing.speeds)
            if bearing.speeds is None:
                expected = "one value, or with this list the key 'speeds' of the bearing"
                yield Finding(("bearing", index, kind, key), expected)
            elif len(given) != count:
                expected = f"one value for each of the {count} speeds (there are {len(given)})"
                yield Finding(("bearing", index, kind, key), expected)
    if bearing.speeds is not None and not tabled:
        yield Finding(("bearing", index, "speeds"), "a list for each of these speeds in 'stiffness' or 'damping'")


def _check_reach(
    draft: Draft, index: int, bearing: Bearing, table: tuple[float, ...], ratio: float
) -> Iterator[Finding]:
    """Yield a table that does not hold every speed that the case names."""
    needed = [ratio * abs(speed) for speed in _named_speeds(draft)]
    if needed and (min(needed) < table[0] * (1.0 - _ROUNDING) or max(needed) > table[-1] * (1.0 + _ROUNDING)):
        expected = (
            f'a table that holds the speeds of rotor "{bearing.rotor}" in this case, {min(needed) * _RPM:.6g} to '
            f"{max(needed) * _RPM:.6g} rpm (it goes from {table[0] * _RPM:.6g} to {table[-1] * _RPM:.6g} rpm)"
        )
        yield Finding(("bearing", index, "speeds"), expected)


def _named_speeds(draft: Draft) -> list[float]:
    """Return the speeds of the first driver's rotor that a case names."""
    speeds = [] if draft.operation is None else [draft.operation.speed]
    if draft.transient is not None and draft.transient.run is not None:
        speeds += draft.transient.run.line[1]
    speeds += draft.sweep.speeds if draft.sweep is not None else ()
    if draft.analysis is not None:
        for given in (draft.analysis.speed, draft.analysis.unbalance_response.speed):
            speeds += () if given is None else listed(given)
    return speeds


def _ratios(draft: Draft) -> dict[str, Fraction]:
    """Return each rotor's speed over the first driver's; empty where the train is not readable."""
    if draft.broken & {"rotor", "gear", "gear_pair"}:
        return {}
    if not draft.gear_pairs:
        return {name: Fraction(1) for name in draft.names("rotor")}
    return dict(draft.train.ratios) if draft.train is not None else {}
