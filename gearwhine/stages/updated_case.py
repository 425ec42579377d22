"""Updated case: the case file with the fitted numbers, their provenance and their prior."""

from typing import Any

import tomli_w

from gearwhine.case import Case, UpdateParameter
from gearwhine.case.check_provenance import without_changed
from gearwhine.case.problems import Location, key_of
from gearwhine.stages.update_keys import FittedNumber, unit_in_si, with_entry
from gearwhine.stages.updating import SolvedUpdate
from housing.updating import Misfit


def updated_case(case: Case, solved: SolvedUpdate) -> str:
    """The case with what was found, as TOML; what each number was, is and why stands at the top and in [provenance].

    The prior stays where it was: an update of the updated case begins at what was found, and is drawn to what was
    nominal.
    """
    fitted, fine = solved.fitted, solved.misfit_after
    document, changed = fitted.document, set[Location]()
    provenance: dict[str, str] = {}
    old = solved.misfit_before
    remarks = [
        f"# Updated to {len(fine.pairs)} measured frequencies by 'gearwhine update'; errors:",
        f"#   before: rms {old.rms_percent:.2f} %, largest {old.max_percent:.2f} %",
        f"#   after:  rms {fine.rms_percent:.2f} %, largest {fine.max_percent:.2f} %, {_clear(fine)}",
        "# Each parameter before and after, with one standard deviation of what prior and measurement leave of it:",
    ]
    prior: dict[int, dict[str, Any]] = {}
    for place, found in enumerate(solved.found):
        number = found.number
        was, now, give = (_shown(value, number.given) for value in (number.start, found.value, found.deviation))
        remarks.append(f"#   {number.parameter.name}: {was} -> {now}, give or take {give}")
        why = f"found: by updating to the measured frequencies; {was} before, {now} give or take {give} after"
        for location, value in number.entries(number.as_written(found.value)):
            text = f"{value:.10g}" if number.given.factor or not number.given.unit else _shown(value, number.given)
            document = with_entry(document, location, float(text) if _is_number(text) else text)
            changed.add(location)
            provenance[key_of(location)] = why
        prior[place] = _prior(number)
    before = fitted.document
    for place, entry in prior.items():
        document = with_entry(
            document, ("update", "parameter", place), {**document["update"]["parameter"][place], **entry}
        )
    document = without_changed(dict(document), before, changed)
    document["provenance"] = {**document.get("provenance", {}), **provenance}
    return "\n".join(remarks) + "\n\n" + tomli_w.dumps(document)


def _clear(misfit: Misfit) -> str:
    if misfit.mac is not None:
        return f"least MAC {misfit.mac.min():.2f}"
    return f"gap of dominance {misfit.gap:.2f}"


def _prior(number: FittedNumber) -> dict[str, Any]:
    """The prior as it was, now that the case's own number is another one."""
    parameter, given = number.parameter, number.given
    if given.factor:
        return {}
    return {"nominal": _exact(parameter.nominal, given), "spread": _exact(parameter.spread, given)}


def _exact(value: float, given: UpdateParameter) -> str | float:
    return f"{value / unit_in_si(given):.12g} {given.unit}" if given.unit else value


def _shown(value: float, given: UpdateParameter) -> str:
    """A value in the unit of its range, to four digits or to a hundredth of a millimetre's like."""
    return f"{value / unit_in_si(given):.5g} {given.unit}".strip()


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
