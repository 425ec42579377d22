"""Checks across the tables of a case, and warnings about a sound one."""

from __future__ import annotations

from collections.abc import Iterator

from gearwhine.case.check_bearings import check_bearings
from gearwhine.case.check_gears import check_gears
from gearwhine.case.check_housing import check_box, check_housing_form
from gearwhine.case.check_names import check_names
from gearwhine.case.check_provenance import check_provenance
from gearwhine.case.check_running import check_running
from gearwhine.case.check_shafts import check_shafts
from gearwhine.case.draft import Draft
from gearwhine.case.model import Case
from gearwhine.case.problems import Finding


def check(draft: Draft) -> Iterator[Finding]:
    """Yield everything that does not go together in what could be read of a case."""
    yield from check_names(draft)
    yield from check_housing_form(draft)
    yield from check_box(draft)
    yield from check_shafts(draft)
    yield from check_bearings(draft)
    yield from check_gears(draft)
    yield from check_running(draft)
    yield from check_provenance(draft)


def warnings_of(case: Case) -> tuple[str, ...]:
    """Return what is allowed in a sound case but likely not meant, a sentence each."""
    found = []
    housing = case.housing
    if housing is not None and case.transient is not None and not housing.sensor:
        found.append("[housing] has no [[housing.sensor]]: the transient will show no acceleration of the housing")
    if housing is not None and case.rotor and all(bearing.grounded for bearing in case.bearing):
        found.append("no bearing stands in a seat of [housing]: rotors and housing do not feel each other")
    if housing is not None and not housing.support and not housing.mount:
        found.append("[housing] has no [[housing.support]] and no [[housing.mount]]: it floats freely")
    elif housing is not None and not (any(s.holds for s in housing.support) or any(m.holds for m in housing.mount)):
        found.append("[housing] stands on dashpots alone: it is not held and creeps away under load")
    if case.operation is not None and case.operation.torque > 0.0 and not case.gear_pair and not case.operation.output:
        found.append("operation.torque has nothing to work against: there are no gear pairs and no outputs")
    for bearing in case.bearing:
        if bearing.pedestal is not None and bearing.pedestal.mass == 0.0:
            found.append(f'bearing "{bearing.name}": its pedestal has no mass: `rotors` alone takes it')
    for rotor in case.rotor:
        given = [rotor.shear_coefficient, *(getattr(part, "shear_coefficient", None) for part in rotor.segments)]
        above = [value for value in given if isinstance(value, float) and value > 1.0]
        if above:
            told = f"a shear coefficient of {above[0]:g}, above 1"
            found.append(f'rotor "{rotor.name}": {told}: round sections have 0.5 to 0.93; is its reciprocal meant?')
        if rotor.saved is not None:
            found += [f'rotor "{rotor.name}": {remark}' for remark in rotor.saved.warnings]
        held = rotor.saved is not None and rotor.saved.bearings
        if not held and not any(bearing.rotor == rotor.name for bearing in case.bearing):
            found.append(f'rotor "{rotor.name}" has no [[bearing]]: it floats freely')
    return tuple(found)
