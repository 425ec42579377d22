"""An updated housing as the command's JSON, and as the case file that holds what was found."""

from typing import Any

import numpy as np
import numpy.typing as npt
import tomli_w

from gearwhine.case import Case, UpdateParameter
from gearwhine.case.check_provenance import without_changed
from gearwhine.case.problems import Location, key_of
from gearwhine.output.dataset import LabelledArrays, file_attributes
from gearwhine.stages.update_keys import FittedNumber, unit_in_si, with_entry
from gearwhine.stages.update_worth import NullTest
from gearwhine.stages.updating import SolvedUpdate
from housing.netcdf import Variables
from housing.updating import UNPAIRED, HeldBack, Misfit, NullFit

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi
_AT_END = 1e-3  # part of a range that counts as its end
_PARTS = 4  # parameters named of each combination


def update_document(case: Case, solved: SolvedUpdate) -> dict[str, Any]:
    """What was fitted, how well, and what that is worth."""
    target, fine = solved.target, solved.misfit_after
    paired = [pair for pair in fine.pairs if pair != UNPAIRED]
    document: dict[str, Any] = {
        "title": case.title,
        "parameters": _parameters(solved),
        "pairs": _pairs(solved),
        "rms_error_percent": fine.rms_percent,
        "max_error_percent": fine.max_percent,
        "pairing": "dominance in order of frequency" if target.shapes is None else "MAC, best assignment",
        **_choice(fine),
        "wrong_pairs": len(fine.pairs) - len(paired),
        "before": _misfit(solved.misfit_before),
        "search": {
            "mesh_dofs": 3 * len(solved.start.mesh.points),
            "steps": [
                {
                    "promised": step.promised,
                    "found": step.found,
                    "accepted": step.accepted,
                    "trust": step.trust,
                    "rms_error_percent": step.rms_percent,
                }
                for step in solved.steps
            ],
        },
        "mesh": {"nodes": len(solved.after.mesh.points), "dofs": 3 * len(solved.after.mesh.points)},
        "identifiability": _identifiability(solved),
        "seconds": {**solved.seconds, "total": sum(solved.seconds.values())},
    }
    if solved.left_out:
        message = f"{solved.left_out} degrees of freedom were not measured in every mode and took no part"
        document["warnings"] = [{"name": "shapes", "message": message}]
    if target.count is not None:
        document["model_modes"] = {"below_hz": target.count.limit / _HERTZ, "count": fine.count}
    if solved.held_back:
        document["held_back"] = [_held_back(row) for row in solved.held_back]
    if solved.null:
        document["null"] = _null(solved.null)
    return document


def _misfit(misfit: Misfit) -> dict[str, Any]:
    return {
        "misfit": misfit.value,
        "rms_error_percent": misfit.rms_percent,
        "max_error_percent": misfit.max_percent,
        **_choice(misfit),
        "model_modes": misfit.count,
    }


def _choice(misfit: Misfit) -> dict[str, Any]:
    """How clearly the modes paired are the dominant ones; null where shapes pair them."""
    if misfit.mac is not None:
        return {"gap": None, "measures_agree": None}
    return {"gap": misfit.gap, "measures_agree": misfit.measures_agree}


def update_arrays(case: Case, solved: SolvedUpdate) -> LabelledArrays:
    """Fitted parameters and the pairs of modes before and after as labelled arrays."""
    rows, pairs = _parameters(solved), _pairs(solved)

    def column(table: list[dict[str, Any]], key: str) -> FloatArray:
        return np.array([np.nan if row[key] is None else row[key] for row in table], dtype=np.float64)

    variables: Variables = {}
    for name, key, what in (
        ("value_before", "before", "value before the fit, in the unit of the parameter"),
        ("value_after", "after", "value after the fit, in the unit of the parameter"),
        ("value_deviation", "standard_deviation", "standard deviation of the value, in the unit of the parameter"),
    ):
        variables[name] = ("parameter", column(rows, key), {"long_name": what})
    for name, key, unit, what in (
        ("measured_frequency", "measured_hz", "Hz", "measured frequency"),
        ("frequency_before", "before_hz", "Hz", "frequency of the model before the fit"),
        ("frequency_after", "model_hz", "Hz", "frequency of the model after the fit"),
        ("error_before", "before_error_percent", "percent", "error of the frequency before the fit"),
        ("error_after", "error_percent", "percent", "error of the frequency after the fit"),
    ):
        variables[name] = ("pair", column(pairs, key), {"units": unit, "long_name": what})
    coordinates: Variables = {
        "parameter": ("parameter", [row["name"] for row in rows], {"long_name": "name of the parameter"}),
        "unit": ("parameter", [row["unit"] or "1" for row in rows], {"long_name": "unit of the parameter"}),
    }
    return LabelledArrays(variables, coordinates, file_attributes(case))


def _parameters(solved: SolvedUpdate) -> list[dict[str, Any]]:
    parameters = [number.parameter for number in solved.fitted.numbers]
    rows = []
    values = solved.posterior.values(parameters)
    for place, (number, (after, deviation)) in enumerate(zip(solved.fitted.numbers, values, strict=True)):
        parameter = number.parameter
        slack = _AT_END * (parameter.high - parameter.low)
        rows.append(
            {
                "name": parameter.name,
                "keys": [key_of(location) for location in number.places],
                "factor": number.given.factor,
                "unit": number.given.unit,
                "unit_in_si": unit_in_si(number.given),
                "before": number.start,
                "after": after,
                "standard_deviation": deviation,
                "prior": {"nominal": parameter.nominal, "spread": parameter.spread},
                "range": [parameter.low, parameter.high],
                "at_end_of_range": bool(after - parameter.low < slack or parameter.high - after < slack),
                "left_of_prior_spread": float(solved.posterior.deviations[place]),
            }
        )
    return rows


def _pairs(solved: SolvedUpdate) -> list[dict[str, Any]]:
    rows = []
    before, after = solved.misfit_before, solved.misfit_after
    left = solved.posterior.frequency_deviations()
    strengths = solved.after.state.dominance.acceleration
    for place, measured in enumerate(solved.target.frequencies):
        error, old = float(after.errors[place]), float(before.errors[place])
        mode = int(after.pairs[place])
        rows.append(
            {
                "measured_hz": float(measured) / _HERTZ,
                "before_hz": _known(measured * np.exp(old) / _HERTZ),
                "model_hz": _known(measured * np.exp(error) / _HERTZ),
                "before_error_percent": _known(100.0 * np.expm1(old)),
                "error_percent": _known(100.0 * np.expm1(error)),
                "mode": None if mode == UNPAIRED else mode + 1,
                "mac": None if after.mac is None else float(after.mac[place]),
                "before_mac": None if before.mac is None else float(before.mac[place]),
                "strength": None if mode == UNPAIRED else float(strengths[mode]),
                "left_uncertain_percent": None if mode == UNPAIRED else 100.0 * float(left[mode]),
            }
        )
    return rows


def _known(value: float) -> float | None:
    """None for what an unpaired mode has not."""
    return float(value) if np.isfinite(value) else None


def _identifiability(solved: SolvedUpdate) -> dict[str, Any]:
    names = [number.parameter.name for number in solved.fitted.numbers]
    after = solved.posterior
    combinations = []
    for information, direction in zip(after.information, after.directions, strict=True):
        leading = np.argsort(-np.abs(direction))[:_PARTS]
        sign = np.sign(direction[leading[0]])
        parts = {names[place]: float(sign * direction[place]) for place in leading}
        combinations.append({"information": float(information), "parts": parts})
    return {
        "parameters": len(names),
        "learned_combinations": after.n_learned,
        "combinations": combinations,
        "confounded": [
            {"parameters": [names[i], names[j]], "correlation": correlation} for i, j, correlation in after.confounded
        ],
    }


def _held_back(row: HeldBack) -> dict[str, Any]:
    return {
        "measured_hz": row.measured / _HERTZ,
        "predicted_hz": _known(row.predicted / _HERTZ),
        "error_percent": _known(row.error_percent),
        "standard_deviation_percent": _known(100.0 * row.deviation),
        "before_error_percent": _known(row.start_error_percent),
        "before_standard_deviation_percent": _known(100.0 * row.prior_deviation),
        "rms_error_percent_of_the_others": _known(row.rms_percent),
    }


def _null(test: NullTest) -> dict[str, Any]:
    fits, own = test.fits, test.measured

    def part(meets: Any) -> float:
        return sum(1 for fit in fits if meets(fit)) / len(fits)

    return {
        "sets": len(fits),
        "as_good_in_rms": part(lambda fit: fit.rms_percent <= own.rms_percent),
        "all_met": part(lambda fit: fit.is_met),
        "within_5_percent": part(lambda fit: fit.max_percent <= 5.0),
        "within_2_percent": part(lambda fit: fit.max_percent <= 2.0),
        "within_1_percent": part(lambda fit: fit.max_percent <= 1.0),
        "within_2_percent_and_clear": part(
            lambda fit: fit.max_percent <= 2.0 and fit.gap >= 0.1 and fit.measures_agree
        ),
        "median_rms_error_percent": float(np.median([fit.rms_percent for fit in fits])),
        "measured_likewise": _null_fit(own),
        "fits": [_null_fit(fit) for fit in fits],
    }


def _null_fit(fit: NullFit) -> dict[str, Any]:
    return {
        "frequencies_hz": (fit.frequencies / _HERTZ).tolist(),
        "rms_error_percent": fit.rms_percent,
        "max_error_percent": fit.max_percent,
        "gap": fit.gap,
        "measures_agree": fit.measures_agree,
        "model_modes": fit.count,
        "all_met": fit.is_met,
    }


def updated_case(case: Case, solved: SolvedUpdate) -> str:
    """The case with what was found, as TOML; what each number was, is and why stands at the top and in [provenance].

    The prior stays where it was: an update of the updated case begins at what was found, and is drawn to what was
    nominal.
    """
    fitted, fine = solved.fitted, solved.misfit_after
    parameters = [number.parameter for number in fitted.numbers]
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
    for place, (number, (after, deviation)) in enumerate(
        zip(fitted.numbers, solved.posterior.values(parameters), strict=True)
    ):
        was, now, give = (_shown(value, number.given) for value in (number.start, after, deviation))
        remarks.append(f"#   {number.parameter.name}: {was} -> {now}, give or take {give}")
        why = f"found: by updating to the measured frequencies; {was} before, {now} give or take {give} after"
        for location, value in number.entries(number.as_written(after)):
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
