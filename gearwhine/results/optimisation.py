"""Optimised designs: the best beside the start by keys, aims and limits, the Pareto front, and the check in motion."""

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwhine.numerics.distributions import Discrete
from gearwhine.numerics.result_warnings import ResultWarning, warning
from gearwhine.output.quantity import RPM, document_of, in_file, unit_of
from gearwhine.output.sections import Column, Document, Picture, Section, Table, table_of
from gearwhine.results.many_solutions import failed_sentences, failed_solutions, failed_warnings, finite, numbered
from gearwhine.variation.named_quantities import part_of, shown_quantity, statistic_of

if TYPE_CHECKING:
    from gearwhine.optimisation.goals import LimitEnd
    from gearwhine.optimisation.optimised import Optimised
    from gearwhine.optimisation.verification import Motion, Verification
    from gearwhine.solutions import Failure

_MOST_FRONT = 12  # rows of the front on the page
_ENDED = {
    "budget": "all evaluations are spent",
    "converged": "the search has converged",
    "complete": "every combination has been tried",
}


def optimised_document(optimised: "Optimised") -> dict[str, Any]:
    """Return an optimisation as the command's JSON."""
    chosen = [(number, label, optimised.designs[number]) for number, label in optimised.chosen.items()]
    at_bounds = optimised.at_bounds
    files = {number: {"case": file} for file, number in reversed(optimised.cases.items())}
    document: dict[str, Any] = {
        "method": optimised.method,
        "designs": len(optimised.designs),
        "within_limits": len(optimised.within),
        "gearboxes_about_each": optimised.gearboxes,
        "ended": optimised.ended,
        "resumed": optimised.resumed,
        "chosen": [{"number": number + 1, "design": label} | files.get(number, {}) for number, label, _ in chosen],
        "keys": [
            {
                "key": one.name,
                "with": [
                    {
                        "key": part.name,
                        "start": optimised.shown_along(place, part, optimised.start),
                        "designs": [optimised.shown_along(place, part, design) for _, _, design in chosen],
                        "allowed": _allowed(part),
                    }
                    for part in one.along
                ],
                "start": optimised.written[place],
                "designs": [optimised.shown_value(place, design) for _, _, design in chosen],
                "allowed": _allowed(one),
                "at_bound": at_bounds.get(one.name, ""),
            }
            for place, one in enumerate(optimised.inputs)
        ],
        "aims": [
            {
                "name": goal.name,
                "unit": unit_of(goal.name),
                "sense": "least" if goal.sign > 0.0 else "most",
                "weight": goal.weight,
                "start": finite(float(optimised.start.aims[place])),
                "designs": [finite(float(design.aims[place])) for _, _, design in chosen],
            }
            for place, goal in enumerate(optimised.goals.aims)
        ],
        "limits": [
            {
                "name": limit.name,
                "unit": unit_of(limit.name),
                "at_most" if limit.sign > 0.0 else "at_least": limit.end,
                "start": finite(limit.value(optimised.start.sides)),
                "designs": [finite(limit.value(design.sides)) for _, _, design in chosen],
                "margin": None if not chosen else finite(-limit.excess(chosen[0][2].sides)),
                "active": limit in optimised.active_limits,
            }
            for limit in optimised.goals.limits
        ],
        "front": [
            {
                "number": number + 1,
                "keys": [
                    optimised.shown_value(place, optimised.designs[number]) for place in range(len(optimised.inputs))
                ],
                "aims": optimised.designs[number].aims.tolist(),
            }
            | files.get(number, {})
            for number in (optimised.front if optimised.goals.count > 1 else [])
        ],
    } | document_of((failed_solutions(first=1),), optimised)
    if not optimised.front and chosen:
        document["missed"] = [_missed(limit, value) for limit, value in optimised.missed]
    if optimised.verification is not None:
        document["verification"] = _verification(optimised.verification)
    return document | {"warnings": list(_warnings(optimised))}


def _of(name: str) -> str:
    """Return what a quantity is of; of several ones as they are named."""
    return statistic_of(name)[1].rpartition(".")[0] if "*" in name else part_of(name)


def _allowed(one: Any) -> str:
    """Return the values that a key may have, in words."""
    if one.words:
        return ", ".join(one.words)
    if isinstance(one.law, Discrete):
        return f"{', '.join(f'{value:g}' for value in one.law.values)} {one.unit}".strip()
    return f"{one.law.low:g} to {one.law.high:g} {one.unit}".strip()


def _missed(limit: "LimitEnd", value: float) -> dict[str, Any]:
    name, factor = shown_quantity(limit.name)
    word = "at most" if limit.sign > 0.0 else "at least"
    by = limit.sign * (value - limit.end)
    text = f"{_of(limit.name)}, {name}: {factor * value:.4g}, {word} {factor * limit.end:.4g} is asked for"
    return {
        "name": limit.name,
        "limit": limit.key,
        "value": value,
        "by": by,
        "text": f"{text}: missed by {factor * by:.3g}",
    }


def _verification(checked: "Verification") -> dict[str, Any]:
    return {
        "speeds_rpm": [RPM * abs(speed) for speed in checked.speeds],
        "start": _motion(checked.start),
        "designs": [_motion(one) for one in checked.designs],
        "contradicted": checked.contradicted,
    }


def _motion(motion: "Motion | Failure") -> dict[str, Any]:
    from gearwhine.solutions import Failure

    if isinstance(motion, Failure):
        return {"failure": motion.message}
    return {
        "linear_level_db": dict(motion.linear),
        "motion_level_db": dict(motion.motion),
        "peak_force_ratio": {name: finite(value) for name, value in motion.peak_force_ratio.items()},
        "contact_loss": dict(motion.contact_loss),
        "highest_level_db": {sensor: level for sensor, (level, _) in motion.highest.items()},
        "loudest_speed_rpm": {sensor: RPM * speed for sensor, (_, speed) in motion.highest.items()},
        "range_speeds": len(motion.speeds),
    }


def _warnings(optimised: "Optimised") -> Iterator[ResultWarning]:
    yield from failed_warnings(optimised, len(optimised.designs), "failed designs", "designs")
    without = [one for one in optimised.designs if not np.all(np.isfinite([*one.aims, *one.excesses]))]
    if count := len(without) - len(optimised.failures):
        message = f"{count} of {len(optimised.designs)} designs have no finite value of an aim or a limited quantity"
        yield warning("designs without value", f"{message}, and count as failed")
    if optimised.best is not None and not optimised.front:
        missed = "; ".join(_missed(limit, value)["text"] for limit, value in optimised.missed)
        yield warning("missed limits", f"no design meets all limits; the nearest one misses {missed}")
    checked = optimised.verification
    if checked is not None and checked.contradicted:
        names = ", ".join(checked.contradicted)
        message = (
            f"the transient does not confirm the linear ranking at {names}: its level does not change as that of the "
            "mesh harmonics; parting teeth, unbalance or runout may decide there"
        )
        yield warning("transient disagrees", message)
    for sensor, levels in () if checked is None else checked.passed_by.items():
        said = [f"{highest:.1f} dB in place of {level:.1f} dB" for level, highest in levels]
        message = (
            f"sensor {sensor} is louder between the speeds of the study than at them: the start {said[0]}, the "
            f"proposed {'designs' if len(said) > 2 else 'design'} {', '.join(said[1:])}; give more speeds, as "
            "neighbouring ones a per cent apart pass no resonance by"
        )
        yield warning("resonances between speeds", message)


def _sides(optimised: "Optimised") -> Any:
    """Return both sides of all quantities of each design, NaN where it has none."""
    rows = [[one.sides.get(name, (np.nan, np.nan)) for name in _names(optimised)] for one in optimised.designs]
    return np.array(rows, dtype=np.float64).reshape(len(rows), len(_names(optimised)), 2)


def _names(optimised: "Optimised") -> list[str]:
    return list(dict.fromkeys(name for one in (optimised.start, *optimised.designs) for name in one.sides))


def _aims(optimised: "Optimised") -> Any:
    return np.array([one.aims for one in optimised.designs]).reshape(-1, len(optimised.goals.aims))


OPTIMISED = (
    *numbered("design", lambda found: len(found.designs), "number of the design, in the order of trial", first=1),
    in_file("input", "input", lambda found: [one.name for one in found.inputs], "designed key of the case"),
    in_file("input_unit", "input", lambda found: [one.unit or "1" for one in found.inputs]),
    in_file("aim", "aim", lambda found: [goal.name for goal in found.goals.aims], "name of the aim"),
    in_file("aim_unit", "aim", lambda found: [unit_of(goal.name) or "1" for goal in found.goals.aims]),
    in_file("quantity", "quantity", _names, "name of the quantity, with its unit at the end"),
    in_file("quantity_unit", "quantity", lambda found: [unit_of(name) or "1" for name in _names(found)]),
    in_file("side", "side", lambda found: ["low", "high"], "side of the scatter; both are the value without scatter"),
    in_file(
        "input_value",
        "design input",
        lambda found: found.values(),
        "value of the designed key, the number of a word from 0",
        "see input_unit",
    ),
    in_file("aim_value", "design aim", _aims, "value of the aim", "see aim_unit"),
    in_file(
        "excess",
        "design",
        lambda optimised: [one.excess for one in optimised.designs],
        "sum of the excesses over the limits, each over its limit",
        "1",
    ),
    in_file("value", "design quantity side", _sides, "value, low and high side of its scatter", "see quantity_unit"),
    in_file(
        "on_front",
        "design",
        lambda optimised: np.isin(np.arange(len(optimised.designs)), optimised.front),
        "whether on the front",
    ),
)
"""Quantities of every design, for the file; the object is a :class:`gearwhine.optimisation.optimised.Optimised`."""


def sections(document: Document) -> tuple[Section, ...]:
    """Return the best design beside the start, the front, and the check in motion."""
    return (Section("", tuple(_content(document))),)


def report(document: Document) -> Section:
    """Return the chapter of the report."""
    pictures = (
        Picture("optimise-convergence", "Every design in the order of its trial, and the best so far."),
        Picture("optimise-front", "Designs by their aims: the Pareto front, the start, and the chosen ones."),
        Picture("optimise-keys", "The aim over each designed key."),
        Picture("optimise-levels", "Start and proposed designs over the whole speed range, by the linear machine."),
    )
    return Section("Optimised design", tuple(_content(document)), pictures=pictures)


def _content(document: Document) -> Iterator[str | Table]:
    yield from summary(document)
    yield from _front(document)
    yield from _checked(document)
    yield from _sentences(document)


def summary(document: Document) -> Iterator[str | Table]:
    """Yield the proposed designs beside the start: keys, aims and limits."""
    labels = [one["design"] for one in document["chosen"]]
    with_numbers = [f"{one['design']}: design {one['number']}" for one in document["chosen"]]
    yield from _answer(document)
    columns = (Column("proposed", "design"), Column("design", "number", "d"), Column("case", "case", file="case"))
    yield from table_of(columns, [one for one in document["chosen"] if "case" in one], "Cases to open")
    keys = [row for key in document["keys"] for row in (key, *({**one, "with": key["key"]} for one in key["with"]))]
    yield from table_of(
        (
            Column("key", "key"),
            Column("start", "start"),
            *_designs(with_numbers, lambda row, value: str(value)),
            Column("allowed", "allowed"),
            Column("at its bound", "at_bound"),
            Column("in step with", lambda row: row["with"] if isinstance(row["with"], str) else ""),
        ),
        keys,
        "Designed keys",
    )
    shown = (
        Column("start", lambda row: _text(row, row["start"])),
        *_designs(labels, _text),
    )
    named = (
        Column("of", lambda row: _of(row["name"])),
        Column("quantity", lambda row: shown_quantity(row["name"])[0]),
    )
    yield from table_of(
        (
            *named,
            Column("aim", "sense"),
            Column("weight", "weight"),
            *shown,
            Column(f"change to {labels[0]}" if len(labels) > 1 else "change", _change),
        ),
        document["aims"],
        "Aims",
    )
    yield from table_of(
        (*named, Column("limit", _limit), *shown, Column("margin", _margin)), document["limits"], "Limits"
    )


def _answer(document: Document) -> Iterator[str]:
    """Yield what the first proposed design wins by each aim, and whether it is within the limits."""
    for one in document["chosen"][:1]:
        gains = [
            f"{shown_quantity(aim['name'])[0]} of {_of(aim['name'])} {_text(aim, aim['start'])} → "
            f"{_text(aim, aim['designs'][0])}"
            for aim in document["aims"]
        ]
        missed = "limits are missed" if document.get("missed") else "all limits are met"
        held = f"; {missed}" if document["limits"] else ""
        yield f"Design {one['number']} ({one['design']} of {document['designs']}): {', '.join(gains)}{held}."


def _designs(labels: Sequence[str], text: Callable[[Document, Any], str]) -> Iterator[Column]:
    """Yield a column for each chosen design."""
    for place, label in enumerate(labels):
        yield Column(label, lambda row, place=place: text(row, row["designs"][place]))  # type: ignore[misc]


def _text(row: Document, value: float | None) -> str:
    return "" if value is None else format(shown_quantity(row["name"])[1] * value, ".5g")


def _change(row: Document) -> str:
    """Return the change of the first design against the start."""
    start, best = row["start"], next(iter(row["designs"]), None)
    if start is None or best is None:
        return ""
    if row["unit"] == "dB":
        return f"{best - start:+.1f} dB"
    return f"{100.0 * (best - start) / abs(start):+.1f} %" if start else ""


def _limit(row: Document) -> str:
    factor = shown_quantity(row["name"])[1]
    return next(f"{sign} {factor * row[key]:.5g}" for key, sign in (("at_most", "≤"), ("at_least", "≥")) if key in row)


def _margin(row: Document) -> str:
    margin = row["margin"]
    if margin is None:
        return ""
    if margin < 0.0:
        return f"missed by {-100.0 * margin:.2g} %"
    return "reached" if row["active"] else f"{100.0 * margin:.2g} %"


def _front(document: Document) -> Iterator[Table]:
    front = document["front"]
    places = sorted({round(at) for at in np.linspace(0, len(front) - 1, min(len(front), _MOST_FRONT)).tolist()})
    aims, keys = document["aims"], document["keys"]

    def aim(place: int) -> Callable[[Document], str]:
        return lambda row: format(shown_quantity(aims[place]["name"])[1] * row["aims"][place], ".5g")

    columns = [Column("design", "number", "d", file="case")]
    for place, one in enumerate(aims):
        columns.append(Column(f"{_of(one['name'])}, {shown_quantity(one['name'])[0]}", aim(place)))
    columns += [Column(one["key"], lambda row, place=place: row["keys"][place]) for place, one in enumerate(keys)]  # type: ignore[misc]
    part = f", {len(places)} of {len(front)} designs" if len(places) < len(front) else ""
    yield from table_of(tuple(columns), [front[place] for place in places], f"Pareto front{part}")


def _checked(document: Document) -> Iterator[str | Table]:
    """Yield start and proposed designs by the transient."""
    checked = document.get("verification")
    if checked is None:
        return
    labels = ["start", *(one["design"] for one in document["chosen"])]
    motions = dict(zip(labels, (checked["start"], *checked["designs"]), strict=True))
    for label, motion in motions.items():
        if "failure" in motion:
            yield f"The transient of the design {label!r} cannot be solved: {motion['failure']}"
    solved = {label: motion for label, motion in motions.items() if "failure" not in motion}
    rows = [
        {
            "of": f"{kind}{of}",
            "quantity": name,
            **{label: _as_text(one.get(key, {}).get(of), form) for label, one in solved.items()},
        }
        for key, kind, name, form in _MOTION_ROWS
        for of in dict.fromkeys(of for one in solved.values() for of in one.get(key, ()))
    ]
    columns = (Column("of", "of"), Column("quantity", "quantity"), *(Column(label, _cell(label)) for label in solved))
    speeds = ", ".join(f"{speed:.5g}" for speed in sorted(checked["speeds_rpm"], key=abs))
    yield from table_of(columns, rows, f"Start and proposed designs by the full machine at {speeds} rpm")
    if len(solved) == len(motions) and checked["start"]["linear_level_db"] and not checked["contradicted"]:
        yield "The transient confirms the ranking by the linear machine."


_MOTION_ROWS = (
    ("linear_level_db", "sensor ", "lines of the teeth, linear [dB re 1 µm/s²]", ".1f"),
    ("motion_level_db", "sensor ", "transient [dB re 1 µm/s²]", ".1f"),
    ("peak_force_ratio", "", "largest tooth force / mean", ".3f"),
    ("contact_loss", "", "part of the time without contact", ".3f"),
    ("highest_level_db", "sensor ", "highest over the speed range, linear [dB re 1 µm/s²]", ".1f"),
    ("loudest_speed_rpm", "sensor ", "at the speed [rpm]", ".0f"),
)
"""Key of a motion in the document, the kind of what it is of, its name and form."""


def _cell(label: str) -> Callable[[Document], str]:
    return lambda row: row[label]


def _as_text(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)


def _proven_yield(document: Document, about: int) -> Iterator[str]:
    """Yield how well the gearboxes about the first design know its yield."""
    from gearwhine.variation.statistics import Share

    row = next((row for row in (*document["aims"], *document["limits"]) if row["name"] == "yield"), None)
    if row is not None and row["designs"] and row["designs"][0] is not None:
        share = Share.of(round(row["designs"][0] * about), about)
        yield (
            f"Yield: {share.good} of {about} gearboxes about the {document['chosen'][0]['design']} design are within "
            f"all limits, 95 % interval {100.0 * share.low:.0f} to {100.0 * share.high:.0f} %; vary has more of them"
        )


def _sentences(document: Document) -> Iterator[str]:
    for row in document["keys"]:
        if row["at_bound"]:
            if "list" in row["at_bound"]:
                yield f"{row['key']} is the {row['at_bound']}: a longer list may be better."
            else:
                yield f"{row['key']} is at its {row['at_bound']} value: a wider range may be better."
    for row in document.get("missed", ()):
        yield f"Missed: {row['text']}."
    yield from failed_sentences(document, "design")
    about = document["gearboxes_about_each"]
    yield from _proven_yield(document, about)
    scatter = f", {about} gearboxes about each" if about > 1 else ""
    resumed = f"; {document['resumed']} evaluations by an earlier run" if document["resumed"] else ""
    within = f", {document['within_limits']} within all limits" if document["limits"] else ""
    tried = f"{document['designs']} designs{scatter}{within}, by {document['method']}"
    yield f"{tried}: {_ENDED[document['ended']]}{resumed}"
