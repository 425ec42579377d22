"""Model updating: quantities of the fitted numbers, the pairs and the tests of the fit, and how they are shown."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

from gearwhine.case.errors import key_of
from gearwhine.numerics.result_warnings import warning
from gearwhine.output.dataset import LabelledArrays, arrays_of, file_attributes, labels_of
from gearwhine.output.quantity import ABSENT, Part, Quantity, Rows, document_of
from gearwhine.output.sections import Column, Document, Picture, Section, Table, columns_of, counted, table_of

if TYPE_CHECKING:
    from gearwhine.case import Case
    from gearwhine.solve.updating import SolvedUpdate


def _known(value: float) -> float | None:
    """None in place of NaN, which an unpaired mode has."""
    return None if math.isnan(value) else float(value)


PARAMETER = (
    Quantity("name", "parameter.name", "parameter", long_name="name of the parameter", heading="parameter"),
    Quantity("keys", lambda row: [key_of(location) for location in row.number.places]),
    Quantity("factor", "number.given.factor"),
    Quantity("unit", "unit", "unit", long_name="unit of the values before and after"),
    Quantity("written_unit", "number.given.unit"),
    Quantity("written_unit_in_si", "unit_in_si"),
    Quantity(
        "before",
        "number.start",
        "value_before",
        long_name="value before the fit, in its SI unit",
        heading="before (SI)",
        shown=".5g",
    ),
    Quantity(
        "after",
        "value",
        "value_after",
        long_name="value after the fit, in its SI unit",
        heading="after (SI)",
        shown=".5g",
    ),
    Quantity(
        "standard_deviation",
        "deviation",
        "value_deviation",
        long_name="standard deviation of the value, in its SI unit",
        heading="± (SI)",
        shown=".2g",
    ),
    Quantity("prior", lambda row: {"nominal": row.parameter.nominal, "spread": row.parameter.spread}),
    Quantity("range", lambda row: [row.parameter.low, row.parameter.high]),
    Quantity("at_end_of_range", "is_at_end"),
    Quantity("left_of_prior_spread", "left"),
)
"""Quantities of a fitted number."""

PAIR = (
    Quantity("measured_hz", "measured", "measured_frequency", long_name="measured frequency"),
    Quantity(
        "before_hz", "before", "frequency_before", long_name="frequency of the model before the fit", document=_known
    ),
    Quantity("model_hz", "after", "frequency_after", long_name="frequency of the model after the fit", document=_known),
    Quantity(
        "before_error_percent",
        "before_error_percent",
        "error_before",
        long_name="error of the frequency before the fit",
        document=_known,
    ),
    Quantity(
        "error_percent",
        "error_percent",
        "error_after",
        long_name="error of the frequency after the fit",
        document=_known,
    ),
    Quantity("mode"),
    Quantity("mac"),
    Quantity("before_mac"),
    Quantity("strength"),
    Quantity("left_uncertain_percent", lambda pair: None if pair.uncertainty is None else 100.0 * pair.uncertainty),
)
"""Quantities of a measured mode and its partner before and after the fit."""

CHOICE = (  # of the dominant modes, where these are paired
    Quantity("gap", lambda misfit: misfit.gap if misfit.by_dominance else ABSENT),
    Quantity("measures_agree", lambda misfit: misfit.measures_agree if misfit.by_dominance else ABSENT),
)
MISFIT = (
    Quantity("misfit", "value"),
    Quantity("rms_error_percent", "rms_percent"),
    Quantity("max_error_percent", "max_percent"),
    *CHOICE,
    Quantity("model_modes", "count"),
)
"""Misfit of a design to the measured modes."""

STEP = (
    Quantity("promised"),
    Quantity("found"),
    Quantity("accepted"),
    Quantity("trust"),
    Quantity("rms_error_percent", "rms_percent"),
)
"""Quantities of a step of the search."""


class _Combination(NamedTuple):
    """Information of the data on a combination of parameters, and its leading parts by name."""

    information: float
    parts: dict[str, float]


class _Confounded(NamedTuple):
    """Names of two parameters, and their correlation."""

    parameters: list[str]
    correlation: float


IDENTIFIABILITY = (
    Quantity("parameters", lambda solved: len(solved.fitted.numbers)),
    Quantity("learned_combinations", "posterior.n_learned"),
    Rows(
        "combinations",
        lambda solved: [_Combination(*each) for each in solved.combinations],
        (Quantity("information"), Quantity("parts")),
    ),
    Rows(
        "confounded",
        lambda solved: [
            _Confounded([solved.found[first].parameter.name, solved.found[second].parameter.name], correlation)
            for first, second, correlation in solved.posterior.confounded
        ],
        (Quantity("parameters"), Quantity("correlation")),
    ),
)
"""Combinations of parameters that the data determine, and pairs that they cannot tell apart."""

HELD_BACK = (
    Quantity("measured_hz", heading="held back [Hz]", shown=".1f"),
    Quantity("predicted_hz", document=_known, heading="predicted [Hz]", shown=".1f"),
    Quantity("error_percent", "error_percent", document=_known, heading="error [%]", shown="+.2f"),
    Quantity(
        "standard_deviation_percent",
        lambda row: 100.0 * row.deviation,
        document=_known,
        heading="expected ± [%]",
        shown=".2f",
    ),
    Quantity("before_error_percent", "start_error_percent", document=_known, heading="error before [%]", shown="+.2f"),
    Quantity("before_standard_deviation_percent", lambda row: 100.0 * row.prior_deviation, document=_known),
    Quantity(
        "rms_error_percent_of_the_others",
        "rms_percent",
        document=_known,
        heading="rms of the others [%]",
        shown=".2f",
        scale=1.0,
    ),
)
"""Quantities of a mode that the fit leaves out and predicts."""

NULL_FIT = (
    Quantity("frequencies_hz"),
    Quantity("rms_error_percent", "rms_percent"),
    Quantity("max_error_percent", "max_percent"),
    Quantity("gap", optional=True),
    Quantity("measures_agree", optional=True),
    Quantity("model_modes", "count"),
    Quantity("all_met", "is_met"),
)
"""Quantities of the fit of one set of frequencies."""

NULL = (
    Quantity("sets", lambda test: len(test.fits)),
    Quantity("as_good_in_rms"),
    Quantity("all_met"),
    Quantity("within_5_percent", lambda test: test.within(5.0)),
    Quantity("within_2_percent", lambda test: test.within(2.0)),
    Quantity("within_1_percent", lambda test: test.within(1.0)),
    Quantity(
        "within_2_percent_and_clear", lambda test: ABSENT if test.measured.gap is None else test.within(2.0, clear=True)
    ),
    Quantity("median_rms_error_percent", "median_rms_percent"),
    Part("measured_likewise", "measured", NULL_FIT),
    Rows("fits", "fits", NULL_FIT),
)
"""Quantities of random sets of frequencies: the parts of them that the search fits well."""

_RULES = {
    "dominance": "dominance in order of frequency",
    "nearest": "nearest frequencies in order",
    "order": "order of frequency, the first with the first",
}

UPDATE = (
    Rows("parameters", "found", PARAMETER, "parameter"),
    Rows("pairs", "pairs", PAIR, "pair"),
    Quantity("rms_error_percent", "misfit_after.rms_percent"),
    Quantity("max_error_percent", "misfit_after.max_percent"),
    Quantity("pairing", lambda solved: "shapes" if solved.target.shapes is not None else solved.target.pairing),
    Quantity(
        "pairing_rule",
        lambda solved: "MAC, best assignment" if solved.target.shapes is not None else _RULES[solved.target.pairing],
    ),
    Part("", "misfit_after", CHOICE),
    Quantity("wrong_pairs", lambda solved: sum(pair.mode is None for pair in solved.pairs)),
    Part("before", "misfit_before", MISFIT),
    Part(
        "search",
        ".",
        (
            Quantity("mesh_dofs", lambda solved: 3 * len(solved.start.mesh.points)),
            Rows("steps", "steps", STEP),
        ),
    ),
    Part(
        "mesh",
        "after.mesh.points",
        (Quantity("nodes", len), Quantity("dofs", lambda points: 3 * len(points))),
    ),
    Part("identifiability", ".", IDENTIFIABILITY),
    Quantity("seconds", lambda solved: {**solved.seconds, "total": sum(solved.seconds.values())}),
    Part(
        "model_modes",
        lambda solved: ABSENT if solved.target.count is None else solved,
        (
            Quantity("below_hz", "target.count.limit"),
            Quantity("count", "misfit_after.count"),
        ),
    ),
    Rows("held_back", lambda solved: solved.held_back or ABSENT, HELD_BACK),
    Part("null", lambda solved: solved.null or ABSENT, NULL),
)
"""Quantities of an updated housing."""


def update_document(case: "Case", solved: "SolvedUpdate") -> dict[str, Any]:
    """Return the fitted numbers, the quality of the fit and its validation as the command's JSON."""
    document = {"title": case.title} | document_of(UPDATE, solved)
    if solved.left_out:
        message = f"{solved.left_out} degrees of freedom were not measured in every mode and took no part"
        document["warnings"] = [warning("shapes", message)]
    return document


def update_arrays(case: "Case", solved: "SolvedUpdate") -> LabelledArrays:
    """Fitted parameters and the pairs of modes before and after as labelled arrays."""
    variables = arrays_of(UPDATE, solved)
    return LabelledArrays(variables, {"unit": variables.pop("unit")}, file_attributes(labels_of(case)))


_FEW_RANDOM_SETS = 0.05  # part of random sets fitted as well, above which the errors alone show little


def report(document: Document) -> Section:
    """Return the chapter of the report: the fitted numbers, and the validation of the fit."""
    before, learned = document["before"], document["identifiability"]
    sentences = [
        f"Before: {before['rms_error_percent']:.2f} % root mean square, {before['max_error_percent']:.2f} % at most.",
        f"The data tell {counted(learned['learned_combinations'], 'combination')} of the {learned['parameters']} "
        "numbers better than the prior.",
    ]
    if null := document.get("null"):
        sentences += _null(null)
    else:
        sentences.append("Not known is how often random frequencies are fitted as well (--null).")
    tables = table_of(columns_of(PARAMETER), document["parameters"])
    held_back = document.get("held_back", ())
    tables += table_of(columns_of(HELD_BACK), held_back, "Each mode predicted by a fit to the others")
    return Section(
        "Updated numbers", (*sentences, *tables), pictures=(Picture("update", "Fitted numbers before and after."),)
    )


def sections(document: Document) -> tuple[Section, ...]:
    """Return parameters, modes, combinations that the data do not determine, and the tests of the fit."""
    return (Section("", tuple(_content(document))),)


def _in_unit(heading: str, key: str) -> Column:
    """Column of a parameter's value in the unit that it is written in."""

    def text(row: Document) -> str:
        return f"{row[key] / row['written_unit_in_si']:.4g} {row['written_unit']}".strip()

    return Column(heading, text, numbers=(key, "written_unit_in_si") if key == "before" else (key,))


def _value(heading: str, key: str, form: str, before: str = "", unit: str = "") -> Column:
    """Column of a value that an unpaired mode has not."""

    def text(row: Document) -> str:
        return before + ("none" if row[key] is None else f"{row[key]:{form}}{unit}")

    return Column(heading, key, shown=text)


_PARAMETERS = (
    Column("parameter", "name"),
    _in_unit("before", "before"),
    _in_unit("after", "after"),
    _in_unit("give or take", "standard_deviation"),
    Column("of the prior's", "left_of_prior_spread", shown=lambda row: f"{100 * row['left_of_prior_spread']:.0f} %"),
    Column("", lambda row: "at the end of its range" if row["at_end_of_range"] else ""),
)
_PAIRS = (
    _value("mode", "mode", "d"),
    Column("measured [Hz]", "measured_hz", ".0f"),
    _value("before [Hz]", "before_hz", ".1f"),
    _value("error", "before_error_percent", "+.2f", unit=" %"),
    _value("after [Hz]", "model_hz", ".1f"),
    _value("error", "error_percent", "+.2f", unit=" %"),
)
_PREDICTED = (
    Column("held back [Hz]", "measured_hz", ".0f"),
    _value("predicted [Hz]", "predicted_hz", ".1f"),
    _value("error", "error_percent", "+.2f", unit=" %"),
    _value("expected", "standard_deviation_percent", ".2f", before="± ", unit=" %"),
    _value("error before", "before_error_percent", "+.2f", unit=" %"),
    _value("rms of others", "rms_error_percent_of_the_others", ".2f", unit=" %"),
)


def _content(document: Document) -> Iterator[str | Table]:
    yield from table_of(_PARAMETERS, document["parameters"])
    yield from table_of(_PAIRS, document["pairs"])
    yield from _fit(document)
    yield from _identifiability(document["identifiability"])
    yield from table_of(_PREDICTED, document.get("held_back", ()))
    if "null" in document:
        yield from _null(document["null"])
        if document["null"]["as_good_in_rms"] > _FEW_RANDOM_SETS:
            yield "So the errors alone say little of this housing: it is a plausible one, calibrated."
    else:
        by_shapes = document["pairs"][0]["mac"] is not None
        random = "" if by_shapes else "How often random frequencies are fitted as well: --null 20. "
        yield random + "Modes held back: --held-back."
    for entry in document.get("warnings", ()):
        yield f"Mind: {entry['message']}."


def _fit(document: Document) -> Iterator[str]:
    counts = document.get("model_modes")
    count = "" if counts is None else f"; {counted(counts['count'], 'model mode')} below {counts['below_hz']:.0f} Hz"
    yield (
        f"Paired by {document['pairing_rule']}: largest error {document['max_error_percent']:.2f} %, rms "
        f"{document['rms_error_percent']:.2f} % (before: {document['before']['rms_error_percent']:.2f} %){count}; "
        f"{_choice(document)}."
    )
    solved, mesh = document["search"], document["mesh"]
    yield (
        f"{counted(len(solved['steps']), 'design')} solved on the way, the first on a mesh of {solved['mesh_dofs']} "
        f"degrees of freedom, verified on one of {mesh['dofs']}; {document['seconds']['total']:.0f} s."
    )


def _choice(document: Document) -> str:
    """Return lines on how certain the pairing of model and measured modes is."""
    values = [pair["mac"] for pair in document["pairs"] if pair["mac"] is not None]
    if values:
        alone = f", {document['wrong_pairs']} without a partner" if document["wrong_pairs"] else ""
        return f"MAC from {min(values):.2f} to {max(values):.2f}{alone}"
    if "gap" not in document:
        return "no shapes and no dominance tell which modes are which"
    agree = "agree" if document["measures_agree"] else "do not all agree"
    if document["gap"] is None or not math.isfinite(document["gap"]):
        return "no mode of the band is left out of the pairs"
    return f"gap {document['gap']:.2f}, the three measures of dominance {agree}"


def _identifiability(identifiability: Document) -> Iterator[str]:
    learned = counted(identifiability["learned_combinations"], "combination")
    yield (
        f"Of {identifiability['parameters']} parameters the data tell {learned} better than the prior did; the rest "
        "stays what was assumed."
    )
    for row in identifiability["confounded"][:6]:
        first, second = row["parameters"]
        yield f"  not told apart: {first} and {second} (correlation {row['correlation']:+.2f})"


def _null(null: Document) -> Iterator[str]:
    """Yield lines on how often random frequencies are fitted as well as the measured ones."""
    within_5, within_2, within_1, met, rms = (
        f"{100 * null[key]:.0f} %"
        for key in ("within_5_percent", "within_2_percent", "within_1_percent", "all_met", "as_good_in_rms")
    )
    measured = null["measured_likewise"]
    yield (
        f"Of {null['sets']} random sets of as many frequencies the same search on the coarser mesh fits {within_5} "
        f"within 5 %, {within_2} within 2 % and {within_1} within 1 % each, and meets for {met} all that is asked for."
    )
    yield (
        f"The measured ones come there to {measured['rms_error_percent']:.2f} % root mean square, "
        f"{measured['max_error_percent']:.2f} % at most; {rms} of the random sets do as well."
    )
