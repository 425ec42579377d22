"""Checks of how a case runs: that everything turns, that torques balance, that there is something to run."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from gearwhine.case.check_shafts import check_station
from gearwhine.case.draft import Draft
from gearwhine.case.problems import NOTHING, Finding
from gearwhine.case.running import Operation
from gearwhine.case.train import gear_train, shaft_of

LARGEST_IMBALANCE = 0.01
"""How far given outputs may be from the input, as a part of it."""


def check_running(draft: Draft) -> Iterator[Finding]:
    """Yield what keeps a case from running as it says."""
    document, operation = draft.document, draft.operation
    if "transient" in document and "operation" not in document:
        yield Finding(("operation",), "a speed to run the [transient] at", NOTHING)
    if operation is None:
        return
    turning = any(key in document for key in ("rotor", "gear"))
    if not turning:
        yield Finding(("operation",), "a [[rotor]] or [[gear]] to turn", NOTHING)
    if "transient" in document and operation.speed == 0.0:
        yield Finding(("operation", "speed"), "a speed other than zero for the [transient]")
    if draft.broken & {"rotor", "gear", "gear_pair"} or not turning:
        return  # what turns what cannot be told from half a train
    yield from _check_stations(draft, operation)
    yield from _check_train(draft, operation)


def _check_stations(draft: Draft, operation: Operation) -> Iterator[Finding]:
    """Yield torques that are put on a rotor beyond its end."""
    for place, output in enumerate(operation.output):
        rotor = draft.rotor(output.rotor)
        if rotor is not None and output.at is not None:
            yield from check_station(rotor, output.at, ("operation", "output", place, "at"))


def _check_train(draft: Draft, operation: Operation) -> Iterator[Finding]:
    """Yield shafts that nothing turns, and outputs that do not balance the input."""
    shafts = draft.names("rotor") or draft.names("gear")
    train = gear_train([gear for _, gear in draft.gears], draft.gear_pairs)
    if any(shaft_of(gear) not in shafts for _, gear in draft.gears) or any(
        draft.gear(name) is None for _, pair in draft.gear_pairs for name in (pair.driver, pair.driven)
    ):
        return  # names that lead nowhere are findings of their own
    ratios = dict(train.ratios) if draft.gear_pairs else dict.fromkeys(shafts, Fraction(1))
    first = next(iter(ratios), None)
    for index, shaft in enumerate(shafts):
        if shaft not in ratios:
            kind = "rotor" if draft.rotors else "gear"
            expected = f'a gear pair that turns it: no pair leads here from "{first}", the first driver'
            yield Finding((kind, index, "name"), expected)
    if train.clashes:
        return
    rotor = draft.rotor(first) if draft.gear_pairs else None
    if rotor is not None and operation.at is not None:
        yield from check_station(rotor, operation.at, ("operation", "at"))
    if draft.gear_pairs:
        for place, output in enumerate(operation.output):
            if output.rotor == first:
                expected = f'a rotor other than "{first}", where the torque comes in'
                yield Finding(("operation", "output", place, "rotor"), expected)
    if not operation.output or any(output.rotor not in ratios for output in operation.output):
        return
    taken = sum(output.torque * abs(float(ratios[output.rotor])) for output in operation.output)
    if abs(taken - operation.torque) > LARGEST_IMBALANCE * max(operation.torque, taken):
        expected = (
            f"outputs that balance the input torque of {operation.torque:g} N*m; through the tooth ratios they "
            f"amount to {taken:g} N*m"
        )
        yield Finding(("operation", "output"), expected, [f"{output.torque:g} N*m" for output in operation.output])
