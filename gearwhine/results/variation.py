"""Varied gearboxes: distributions of their quantities, what they follow from, and the yield, as tables."""

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwhine.numerics.result_warnings import ResultWarning, warning
from gearwhine.output.named_quantities import part_of, shown_quantity
from gearwhine.output.quantity import RPM, Part, Quantity, Rows, document_of, in_file
from gearwhine.output.sections import Column, Document, Picture, Section, Table, table_of
from gearwhine.results.many_solutions import FAILED, ending, failed_sentences, failed_warnings, numbered

if TYPE_CHECKING:
    from gearwhine.numerics.sobol_indices import SobolIndices
    from gearwhine.variation.statistics import QuantityStatistics, VariedResult

_MOST_INPUTS = 3  # of a quantity in the table of what matters
_MOST_FAILURES = 5  # told one by one
_WIDE_INTERVAL = 0.2  # width of an index' interval above which more samples are advised


def _indices(which: str) -> Any:
    """Return the function that lists an index of each input with its interval."""

    def of(one: "QuantityStatistics") -> dict[str, list[float]] | None:
        found: SobolIndices | None = one.indices
        if found is None:
            return None
        values, intervals = getattr(found, which), getattr(found, f"{which}_interval")
        rows = zip(one.input_names, values.tolist(), intervals.tolist(), strict=True)
        return {name: [value, *interval] for name, value, interval in rows}

    return of


SHARE = (Quantity("share"), Quantity("low"), Quantity("high"))
"""Quantities of a part of the gearboxes, with its interval."""

QUANTITY = (
    Quantity("name"),
    Quantity("unit"),
    Quantity("nominal"),
    Quantity("mean"),
    Quantity("std", "deviation"),
    Quantity("quantiles"),
    Quantity(
        "limit", lambda one: None if one.limit is None else one.limit.model_dump(exclude_none=True), optional=True
    ),
    Part("within", "share", SHARE, optional=True),
    Quantity("explained", "explained"),
    Quantity("rank_correlation", "rank_correlations"),
    Quantity("sobol_first", _indices("first"), optional=True),
    Quantity("sobol_total", _indices("total"), optional=True),
    Quantity("worst"),
)
"""Quantities of a quantity's distribution; a row is a :class:`gearwhine.variation.statistics.QuantityStatistics`."""

CHANGE = (Quantity("difference"), Quantity("low"), Quantity("high"))
"""Quantities of a difference of two parts of the gearboxes, with its interval."""

WIDENED = (
    Quantity("input", "name"),
    Part("yield", "share", SHARE, optional=True),
    Part("change", "change", CHANGE, optional=True),
    Rows(
        "quantities",
        "quantities",
        (
            Quantity("name"),
            Quantity("std_before", "deviation_before"),
            Quantity("std", "deviation"),
            Quantity("quantile_before", "end_before"),
            Quantity("quantile", "end"),
        ),
    ),
)
"""Quantities of a wider input; a row is a :class:`gearwhine.variation.statistics.WidenedInput`."""

_EACH = "see quantity_unit"


def _names_of(parts: str) -> Callable[["VariedResult"], list[str]]:
    return lambda varied: [one.name for one in getattr(varied, parts)]


def _units_of(parts: str) -> Callable[["VariedResult"], list[str]]:
    return lambda varied: [one.unit or "1" for one in getattr(varied, parts)]


def _values(varied: "VariedResult") -> Any:
    """Return the values of all quantities, of a row for each sample."""
    values = [varied.all_values(one.name) for one in varied.quantities]
    return np.array(values).reshape(len(values), len(varied.outcomes)).T


def _nominal(varied: "VariedResult") -> list[float]:
    return [one.nominal for one in varied.quantities]


def _curves(varied: "VariedResult") -> Any:
    return np.array([varied.curve(name) for name in varied.nominal.curves]).swapaxes(0, 1)


VARIED = (
    Quantity("samples", lambda varied: len(varied.outcomes)),
    Quantity("representative", lambda varied: int(varied.representative.sum())),
    Quantity("resumed"),
    Rows(
        "inputs",
        lambda varied: list(zip(varied.inputs, varied.values.T, strict=True)),
        (
            Quantity("key", "0.name"),
            Quantity("unit", "0.unit"),
            Quantity("distribution", lambda row: type(row[0].law).__name__.lower()),
            Quantity("mean", lambda row: float(row[1].mean())),
            Quantity("std", lambda row: float(row[1].std())),
        ),
    ),
    FAILED,
    Rows("quantities", "quantities", QUANTITY),
    Quantity("headlines", lambda varied: [one.name for one in varied.headlines]),
    Part("yield", "yielded", SHARE, optional=True),
    Rows("widened", lambda varied: varied.widened or None, WIDENED, optional=True),
    *numbered("sample", lambda varied: len(varied.outcomes), "number of the gearbox"),
    in_file("input", "input", _names_of("inputs"), "varied key of the case"),
    in_file("input_unit", "input", _units_of("inputs")),
    in_file("quantity", "quantity", _names_of("quantities"), "name of the quantity, with its unit at the end"),
    in_file("quantity_unit", "quantity", _units_of("quantities")),
    in_file("input_value", "sample input", "values", "value of the varied key", "see input_unit"),
    in_file("value", "sample quantity", _values, "value of the quantity", _EACH),
    in_file("nominal", "quantity", _nominal, "value of the gearbox without changes", _EACH),
    in_file("representative", "sample", "representative", "whether it stands for the production"),
    Part(
        "",
        lambda varied: varied if varied.nominal.curves else None,
        (
            in_file("speed", "speed", lambda varied: np.abs(varied.speeds) * RPM, "speed of the first driver", "rpm"),
            in_file("curve", "curve", lambda varied: list(varied.nominal.curves), "name of the quantity over speed"),
            in_file("value_over_speed", "sample curve speed", _curves, "level over speed", "dB"),
        ),
    ),
)
"""Quantities of a varied case; the object is a :class:`gearwhine.variation.statistics.VariedResult`."""


def varied_document(varied: "VariedResult") -> dict[str, Any]:
    """Return a varied case as the command's JSON."""
    return document_of(VARIED, varied) | {"warnings": list(_warnings(varied))}


def _warnings(varied: "VariedResult") -> Iterator[ResultWarning]:
    yield from failed_warnings(varied, len(varied.outcomes), "failed samples", "gearboxes")
    wide = [
        one.name
        for one in varied.headlines
        if one.indices is not None and float(np.ptp(one.indices.total_interval, axis=1).max()) > _WIDE_INTERVAL
    ]
    if wide:
        message = (
            f"the total-order indices of {', '.join(wide[:3])} are known to no better than ±0.1: take more samples"
        )
        yield warning("few samples", message)


def _limit(row: Document) -> str:
    """Return the limit of a quantity in words."""
    limit, factor = row.get("limit") or {}, shown_quantity(row["name"])[1]
    ends = (("at_least", "≥"), ("at_most", "≤"))
    return ", ".join(f"{sign} {factor * limit[key]:.4g}" for key, sign in ends if key in limit)


def _share(row: Document) -> str:
    share = row.get("within")
    return "" if share is None else f"{100.0 * share['share']:.1f} %"


def _number(of: Callable[[Document], float | None], form: str = ".4g") -> Callable[[Document], str]:
    """Return the function that shows a number of a row in the unit that is shown."""

    def text(row: Document) -> str:
        value = of(row)
        return "" if value is None or value != value else format(shown_quantity(row["name"])[1] * value, form)

    return text


_INPUT_COLUMNS = (
    Column("key", "key"),
    Column("unit", "unit"),
    Column("distribution", "distribution"),
    Column("mean", "mean", ".5g"),
    Column("std", "std", ".3g"),
)
_COLUMNS = (
    Column("of", lambda row: part_of(row["name"])),
    Column("quantity", lambda row: shown_quantity(row["name"])[0]),
    Column("nominal", _number(lambda row: row["nominal"])),
    Column("mean", _number(lambda row: row["mean"])),
    Column("std", _number(lambda row: row["std"], ".3g")),
    Column("5 %", _number(lambda row: row["quantiles"]["0.05"])),
    Column("median", _number(lambda row: row["quantiles"]["0.5"])),
    Column("95 %", _number(lambda row: row["quantiles"]["0.95"])),
    Column("limit", _limit),
    Column("within", _share),
)


def _told(document: Document) -> list[Document]:
    """Return the quantities that have values."""
    return [row for row in document["quantities"] if row["mean"] is not None and row["mean"] == row["mean"]]


def sections(document: Document) -> tuple[Section, ...]:
    """Return the distributions, what matters, and the yield."""
    return (Section("", tuple(_content(document))),)


def report(document: Document) -> Section:
    """Return the chapter of the report."""
    pictures = (
        Picture("vary-distributions", "How the quantities scatter, with their limits and the gearbox without changes."),
        Picture("vary-importance", "Which inputs the scatter follows from."),
        Picture("vary-widening", "What wider tolerances cost in yield."),
        Picture("vary-scatter", "Each gearbox by the inputs that matter most."),
        Picture(
            "vary-speeds", "Levels over speed: the gearbox without changes, and the band of nine in ten gearboxes."
        ),
    )
    return Section("Varied gearboxes", tuple(_content(document)), pictures=pictures)


def _content(document: Document) -> Iterator[str | Table]:
    rows = _told(document)
    yield from table_of(_INPUT_COLUMNS, document["inputs"], "Varied keys")
    yield from table_of(_COLUMNS, rows, "Distributions")
    yield from _what_matters([row for row in rows if row["name"] in document["headlines"]])
    yield from _what_wider_ones_cost(document.get("widened", []))
    yield from failed_sentences(document, "gearbox", _MOST_FAILURES)
    if "yield" in document:
        share = document["yield"]
        low, value, high = (100.0 * share[key] for key in ("low", "share", "high"))
        yield f"Yield: {value:.1f} % of the gearboxes are within all limits (95 % interval {low:.1f} to {high:.1f} %)."
    standing = ""
    if document["representative"] < document["samples"]:
        standing = f", {document['representative']} of which stand for the production in the table of distributions"
    yield f"{document['samples']} gearboxes{standing}{ending(document)}"


def _what_matters(rows: Sequence[Document]) -> Iterator[str | Table]:
    """Yield a table of the most important inputs of the quantities that scatter, and which nothing explains."""
    shown, unexplained = list[Document](), list[str]()
    by_index = any("sobol_total" in row for row in rows)
    for row in rows:
        total, ranks = row.get("sobol_total"), row["rank_correlation"]
        values = {key: value[0] for key, value in total.items()} if total else row["explained"]
        first = sorted(values, key=lambda key: -values[key])[:_MOST_INPUTS]
        if not first:
            unexplained.append(f"{part_of(row['name'])}, {shown_quantity(row['name'])[0].partition(' [')[0]}")
        for place, key in enumerate(first):
            shown.append(
                {
                    "of": "" if place else part_of(row["name"]),
                    "quantity": "" if place else shown_quantity(row["name"])[0].partition(" [")[0],
                    "input": key,
                    "value": f"{values[key]:.2f}",
                    "interval": f"{total[key][1]:.2f} to {total[key][2]:.2f}" if total else "",
                    "alone": f"{row['sobol_first'][key][0]:.2f}" if total else "",
                    "rank": f"{ranks[key]:+.2f}" if key in ranks else "",
                }
            )
    caption = (
        "What matters: Sobol' indices, the part of the variance that goes with the input in all and alone"
        if by_index
        else "What matters: part of the variance that goes with the input alone, where the samples prove it"
    )
    columns = (
        Column("of", "of"),
        Column("quantity", "quantity"),
        Column("input", "input"),
        Column("in all" if by_index else "part", "value"),
        Column("95 % interval", "interval"),
        Column("alone", "alone"),
        Column("rank correlation", "rank"),
    )
    yield from table_of(columns, shown, caption)
    if unexplained:
        yield f"No input alone explains {'; '.join(unexplained)}: more samples, or --indices, may tell."


def _what_wider_ones_cost(rows: Sequence[Document]) -> Iterator[str | Table]:
    """Yield a table of wider inputs: the yield, its change, and how far the first quantity moves."""
    rows = [row for row in rows if row["quantities"]]
    if not rows:
        return
    first = rows[0]["quantities"][0]["name"]
    shown = [
        {
            "input": row["input"],
            "yield": f"{100.0 * row['yield']['share']:.1f} %" if "yield" in row else "",
            "change": f"{100.0 * row['change']['difference']:+.1f}" if "change" in row else "",
            "interval": f"{100.0 * row['change']['low']:+.1f} to {100.0 * row['change']['high']:+.1f}"
            if "change" in row
            else "",
            **row["quantities"][0],
        }
        for row in rows
    ]
    columns = (
        Column("wider input", "input"),
        Column("yield", "yield"),
        Column("change [points]", "change"),
        Column("95 % interval", "interval"),
        Column("std", _from_to("std_before", "std", ".3g")),
        Column("bad end", _from_to("quantile_before", "quantile", ".4g")),
    )
    of_first = f"std and bad end of {part_of(first)}, {shown_quantity(first)[0]}"
    caption = f"What wider tolerances cost, the dearest first; {of_first}"
    yield from table_of(columns, shown, caption)


def _from_to(before: str, after: str, form: str) -> Callable[[Document], str]:
    """Return the function that shows a number of a row before and after its input is widened."""
    numbers = _number(lambda row: row[before], form), _number(lambda row: row[after], form)
    return lambda row: " → ".join(number(row) for number in numbers)
