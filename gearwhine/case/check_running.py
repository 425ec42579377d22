"""Checks of operation: a train in which every shaft turns, balanced torques, a transient that can be run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from gearwhine.case.check_shafts import check_station
from gearwhine.case.draft import Draft
from gearwhine.case.gears import GearPair
from gearwhine.case.model import Case
from gearwhine.case.motion import pair_torques
from gearwhine.case.problems import NOTHING, UNSAID, Finding
from gearwhine.case.running import Operation
from gearwhine.case.train import shaft_of

LARGEST_RATIO = 1e12
"""Speed over the first driver's beyond which a train is a mistake, long before numbers overflow."""

_NO_TORQUE = 1e-9
"""Part of the input torque below which a gear pair carries none but for rounding."""


def check_running(draft: Draft) -> Iterator[Finding]:
    """Yield what keeps a case from running as it says."""
    document, operation = draft.document, draft.operation
    if all(document.get(key, []) == [] for key in ("housing", "rotor", "gear", "gear_pair")):
        yield Finding((), "at least one of [housing], [[rotor]] and [[gear_pair]]", UNSAID)
    if "transient" in document and "operation" not in document:
        yield Finding(("operation",), "a speed to run the [transient] at", NOTHING)
    if "rotor_analysis" in document and not document.get("rotor"):
        yield Finding(("rotor",), "at least one [[rotor]] for the [rotor_analysis]", NOTHING)
    if operation is None:
        return
    turning = any(key in document for key in ("rotor", "gear"))
    if not turning:
        yield Finding(("operation",), "a [[rotor]] or [[gear]] to turn", NOTHING)
    if "transient" in document and operation.speed == 0.0:
        yield Finding(("operation", "speed"), "a speed other than zero for the [transient]")
    yield from _check_run(draft, operation)
    yield from _check_method(draft, operation)
    if draft.broken & {"rotor", "gear", "gear_pair"} or not turning:
        return  # half a train does not say which shafts it turns
    yield from _check_stations(draft, operation)
    yield from _check_train(draft, operation)


def _check_run(draft: Draft, operation: Operation) -> Iterator[Finding]:
    """Yield a run on a base that tilts, or free without a motor or an output, and torque lines that none follows."""
    run = None if draft.transient is None else draft.transient.run
    if run is not None and operation.base is not None and operation.base.tilts:
        expected = "no turning about x or y during a [transient.run]: gyroscopic moments of a base are for one speed"
        yield Finding(("operation", "base"), expected, UNSAID)
    if run is not None and run.free:
        if operation.motor is None:
            yield Finding(("operation", "motor"), "a torque over speed, which drives the free [transient.run]", NOTHING)
        if not draft.gear_pairs and not operation.output:
            yield Finding(("operation", "output"), "an output, on the rotor that the free run drives", NOTHING)
    elif draft.transient is not None:
        for key in ("motor", "load"):
            if getattr(operation, key) is not None:
                yield Finding(("operation", key), "a [transient.run] without 'to', whose speed is free to follow it")


def _check_method(draft: Draft, operation: Operation) -> Iterator[Finding]:
    """Yield what the exact march, where it is asked for, knows nothing of."""
    given = draft.transient
    if given is None or given.method != "exact":
        return
    unknown = [f"friction between the teeth (gear_pair[{i}])" for i, pair in draft.gear_pairs if pair.friction > 0.0]
    unknown += [f"a bearing's own law (bearing[{i}])" for i, bearing in draft.bearings if bearing.follows_own_law]
    unknown += ["a speed that varies (transient.run)"] * (given.run is not None)
    torques = [operation.over_time, *(output.over_time for output in operation.output)]
    unknown += ["a torque given over time"] * any(torque is not None for torque in torques)
    if unknown:
        yield Finding(("transient", "method"), f"'newmark' or 'auto'; the exact march knows nothing of {unknown[0]}")


def _check_stations(draft: Draft, operation: Operation) -> Iterator[Finding]:
    """Yield torques that are put on a rotor beyond its end."""
    for place, output in enumerate(operation.output):
        rotor = draft.rotor(output.rotor)
        if rotor is not None and output.at is not None:
            yield from check_station(rotor, output.at, ("operation", "output", place, "at"))


def _check_train(draft: Draft, operation: Operation) -> Iterator[Finding]:
    """Yield shafts that nothing turns, and outputs that do not balance the input."""
    shafts = draft.names("rotor") or draft.names("gear")
    train = draft.train
    if any(shaft_of(gear) not in shafts for _, gear in draft.gears) or any(
        draft.gear(name) is None for _, pair in draft.gear_pairs for name in (pair.driver, pair.driven)
    ):
        return  # names that lead nowhere are findings of their own
    ratios = dict.fromkeys(shafts, Fraction(1))
    if draft.gear_pairs:
        ratios = {} if train is None else dict(train.ratios)
    first = next(iter(ratios), None)
    for index, shaft in enumerate(shafts):
        if shaft not in ratios:
            kind = "rotor" if draft.rotors else "gear"
            expected = f'a gear pair that turns it: no pair leads here from "{first}", the first driver'
            yield Finding((kind, index, "name"), expected)
    if any(not 1.0 / LARGEST_RATIO <= abs(ratio) <= LARGEST_RATIO for ratio in ratios.values()):
        expected = f"pairs that gear no shaft up or down more than {LARGEST_RATIO:g} times in all"
        yield Finding(("gear_pair",), expected, UNSAID)
        return
    if train is not None and train.contradictions:
        return
    rotor = draft.rotor(first) if draft.gear_pairs else None
    if rotor is not None and operation.at is not None:
        yield from check_station(rotor, operation.at, ("operation", "at"))
    if draft.gear_pairs:
        for place, output in enumerate(operation.output):
            if output.rotor == first:
                expected = f'a rotor other than "{first}", where the torque comes in'
                yield Finding(("operation", "output", place, "rotor"), expected)
    if any(output.rotor not in ratios for output in operation.output):
        return
    if not draft.gear_pairs and len(shafts) > 1:
        yield from _check_each_shaft(draft, operation)
        return
    imbalances = list(_check_balance(operation, ratios))
    yield from imbalances
    if draft.gear_pairs and not imbalances and all(shaft in ratios for shaft in shafts):
        yield from _check_flow(draft, operation)


def _check_balance(operation: Operation, ratios: Mapping[str, Fraction]) -> Iterator[Finding]:
    """Yield outputs that, through the gears, take another power than comes in."""
    if not operation.output:
        return
    taken = sum(output.torque * abs(float(ratios[output.rotor])) for output in operation.output)
    if not _balance(operation.torque, taken):
        expected = (
            f"outputs that balance the input torque of {operation.torque:g} N*m; through the tooth ratios they "
            f"amount to {taken:g} N*m"
        )
        yield Finding(("operation", "output"), expected, [f"{output.torque:g} N*m" for output in operation.output])


def _balance(entering: float, leaving: float) -> bool:
    """Whether two torques are the same within the tolerance of the library."""
    from coupling.gear_train import LARGEST_IMBALANCE

    return abs(leaving - entering) <= LARGEST_IMBALANCE * max(abs(entering), abs(leaving))


def _check_each_shaft(draft: Draft, operation: Operation) -> Iterator[Finding]:
    """Yield shafts, none geared to another, whose own torques do not balance; the first output's takes the input."""
    kind = "rotor" if draft.rotors else "gear"
    first: dict[str, int] = {}
    for place, output in enumerate(operation.output):
        first.setdefault(output.rotor, place)
    for shaft, place in first.items():
        entering = operation.torque if place == 0 else 0.0
        taken = sum(output.torque for output in operation.output if output.rotor == shaft)
        if not _balance(entering, taken):
            expected = (
                f'torques that balance on {kind} "{shaft}", as no gear pair leads to or from it; it takes in '
                f"{entering:g} N*m and gives out {taken:g} N*m"
            )
            yield Finding(("operation", "output", place), expected, UNSAID)


def _check_flow(draft: Draft, operation: Operation) -> Iterator[Finding]:
    """Yield gear pairs whose driven gear drives the driver."""
    names = draft.names("gear")
    if operation.torque == 0.0 or len(set(names)) < len(names):
        return
    turning = Case.model_construct(
        rotor=tuple(rotor for _, rotor in draft.rotors),
        gear=tuple(gear for _, gear in draft.gears),
        gear_pair=tuple(pair for _, pair in draft.gear_pairs),
        operation=operation,
    )
    sense = 1.0 if operation.torque > 0.0 else -1.0
    for (index, pair), torque in zip(draft.gear_pairs, pair_torques(turning), strict=True):
        if sense * torque < -_NO_TORQUE * abs(operation.torque):
            expected = "power to flow from driver to driven; swap the two names"
            yield Finding(("gear_pair", index), expected, UNSAID)
        elif torque < -_NO_TORQUE * abs(operation.torque) and not _has_backlash(turning, pair):
            expected = (
                "a backlash: the torque is negative, so the driven gear drives by the back flanks, which never meet "
                "without one"
            )
            yield Finding(("gear_pair", index, "backlash"), expected, NOTHING)


def _has_backlash(case: Case, pair: GearPair) -> bool:
    """Whether a backlash is given, or the teeth are thinned for one."""
    thinned = any(case.gear_named(name).tooth_thinning > 0.0 for name in (pair.driver, pair.driven))
    return pair.backlash is not None or thinned
