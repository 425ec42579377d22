"""Varied gearboxes: distributions of their quantities, what they follow from, and the yield, as tables."""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwhine.case.errors import key_of
from gearwhine.numerics.result_warnings import ResultWarning, warning
from gearwhine.output.quantity import RPM, Part, Quantity, Rows, document_of, in_file
from gearwhine.output.sections import Column, Document, Picture, Section, Table, counted, table_of
from gearwhine.results.bearing_lives import LONGEST_LIFE, life_in_words
from gearwhine.results.many_solutions import ending, failed_sentences, failed_solutions, failed_warnings, numbered
from gearwhine.variation.named_quantities import part_of, shown_quantity, shown_unit

if TYPE_CHECKING:
    from gearwhine.case.gears import Gear
    from gearwhine.numerics.sobol_indices import SobolIndices
    from gearwhine.variation.inputs import Input
    from gearwhine.variation.statistics import QuantityStatistics, VariedResult

_MOST_INPUTS = 3  # of a quantity in the table of what matters
_MOST_RANKS, _MOST_RANKED = 3, 4  # worst gearboxes of a quantity, and quantities up to which they are told
_MANY_AT_END = 0.05  # part of the gearboxes that are the loudest at an end of the speeds above which it is warned of
_SAMPLES_OF_AN_INPUT = 10  # gearboxes for each input below which they are said to be too few to rank inputs
_TINY = 1e-6  # probability by chance below which it is not told
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


SHARE = (Quantity("share"), Quantity("low"), Quantity("high"), Quantity("good"), Quantity("total"))
"""Quantities of a part of the gearboxes, with its interval and the numbers that it is of."""

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
    Quantity("rank_chance", "rank_chances"),
    Quantity("leading_ranks"),
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
            Quantity("tolerance", "0.tolerance"),
            Quantity("entries", lambda row: len(row[0].keys)),
            Quantity("mean", lambda row: float(row[1].mean())),
            Quantity("std", lambda row: float(row[1].std())),
        ),
    ),
    failed_solutions(),
    Rows("quantities", "quantities", QUANTITY),
    Quantity("headlines", lambda varied: [one.name for one in varied.headlines]),
    Quantity("speeds_rpm", lambda varied: (np.abs(varied.speeds) * RPM).tolist()),
    Rows(
        "worst",
        "worst_gearboxes",
        (
            Quantity("quantity", "name"),
            Quantity("rank"),
            Quantity("gearbox", "number"),
            Quantity("value"),
            Quantity("speed_rpm", lambda one: None if one.speed is None else abs(one.speed) * RPM, optional=True),
            Quantity("case", "file", optional=True),
        ),
    ),
    Part("yield", "yielded", SHARE, optional=True),
    Quantity("widening", optional=True),
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
    yield from _lacking_warnings(varied)
    widths = {
        one.name: float(np.ptp(one.indices.total_interval, axis=1).max())
        for one in varied.headlines
        if one.indices is not None
    }
    wide = {name: width for name, width in widths.items() if width > _WIDE_INTERVAL}
    if wide and varied.design is not None:
        # Intervals fall with the root of the number of samples, of which powers of two are best.
        needed = varied.design.rows * (max(wide.values()) / _WIDE_INTERVAL) ** 2
        message = (
            f"the total-order indices of {', '.join(list(wide)[:3])} are known to no better than ±0.1: take more "
            f"samples, some {2 ** int(np.ceil(np.log2(needed)))} in place of {varied.design.rows}"
        )
        yield warning("few samples", message)
    for one in varied.headlines:
        part = varied.at_end_of_speeds(one.name)
        if part is not None and part > _MANY_AT_END:
            message = (
                f"{part_of(one.name)} is the loudest at an end of the speeds, {_speeds(varied.speeds)}, in "
                f"{100.0 * part:.0f} % of the gearboxes: beyond that end the level may be higher; take a wider range"
            )
            yield warning("loudest speed", message, share=part)


def _lacking_warnings(varied: "VariedResult") -> Iterator[ResultWarning]:
    """Warn of quantities that some gearboxes do not have, such as the frequency of a mode that is not found again."""
    solved = len(varied.outcomes) - len(varied.failures)
    for one in varied.quantities:
        lacking = solved - int(np.sum(~np.isnan(varied.all_values(one.name))))
        if lacking:
            what = f"{part_of(one.name)}, {shown_quantity(one.name)[0].partition(' [')[0]}"
            why = ": the mode is not found again there" if ".natural_frequency_" in one.name else ""
            limited = "; these count as beyond its limit" if one.limit is not None else ""
            message = f"{lacking} of {solved} gearboxes have no {what}{why}{limited}"
            yield warning("missing values", message, quantity=one.name, gearboxes=lacking)


def runout_twice_warnings(inputs: Sequence["Input"], gears: Sequence["Gear"] = ()) -> Iterator[ResultWarning]:
    """Warn of gears whose eccentricity counts twice: as their runout, and in the slow part of their pitches.

    Parameters
    ----------
    inputs : sequence of Input
    gears : sequence of Gear
        Gears of the case: what these have without being varied counts, too.
    """
    varied = {key for one in inputs for key, _ in one.keys}
    written = dict[str, str]()
    for gear in gears:
        for key in ("pitch", "spacing", "runout", "eccentricity"):
            if getattr(gear.errors, key):
                written[key_of(("gear", gear.name, "errors", key))] = "written"
    told = written | dict.fromkeys(varied, "varied")
    for table in sorted({key.rpartition(".")[0] for key in varied if ".errors." in key}):
        pitches, offsets = (
            [key for name in names if (key := f"{table}.{name}") in told]
            for names in (("pitch", "spacing"), ("runout", "eccentricity"))
        )
        if pitches and offsets and {*pitches, *offsets} & varied:
            message = (
                f"{pitches[0]} is {told[pitches[0]]} and {offsets[0]} is {told[offsets[0]]}: the deviations of all "
                "pitches have a slow part over the turn, which is the eccentricity of the teeth that a runout is, too; "
                "give one of them, or it counts twice"
            )
            yield warning("runout twice", message)


def _speeds(speeds: Any) -> str:
    """Return the ends of some speeds [rad/s] in words."""
    rpm = np.abs(np.asarray(speeds)) * RPM
    return f"{rpm.min():.5g} to {rpm.max():.5g} rpm"


def _limit(row: Document) -> str:
    """Return the limit of a quantity in words."""
    limit, factor = row.get("limit") or {}, shown_quantity(row["name"])[1]
    ends = (("at_least", "≥"), ("at_most", "≤"))
    return ", ".join(f"{sign} {factor * limit[key]:.4g}" for key, sign in ends if key in limit)


def _percents(share: Document) -> str:
    """Return a part of the gearboxes with its interval."""
    low, value, high = (100.0 * share[key] for key in ("low", "share", "high"))
    return f"{value:.1f} % ({low:.1f} to {high:.1f} %)"


def _number(of: Callable[[Document], float | None], form: str = ".4g") -> Callable[[Document], str]:
    """Return the function that shows a number of a row in the unit that is shown."""

    def text(row: Document) -> str:
        value, name = of(row), row["name"] if "name" in row else row["quantity"]
        if value is None or value != value:
            return ""
        if name.endswith("life_h") and value > LONGEST_LIFE:
            return life_in_words(value)
        shown = format(shown_quantity(name)[1] * value, form)
        return f"{float(shown):.0f}" if "e+0" in shown else shown

    return text


def _is_drawn_number(row: Document) -> bool:
    """Tell whether an input has a mean: words have none, and of pitches the file holds the range."""
    return row["distribution"] != "pitches" and bool(row["unit"] or row["distribution"] != "discrete")


def _mean(row: Document) -> str:
    """Return the mean of an input in the unit that is shown, to the digits of its standard deviation."""
    if not _is_drawn_number(row):
        return ""
    mean, deviation = (shown_unit(row["unit"])[1] * row[key] for key in ("mean", "std"))
    return f"{mean:z.{max(2 - math.floor(math.log10(deviation)), 0)}f}" if deviation > 0.0 else f"{mean:.4g}"


def _deviation(row: Document) -> str:
    return f"{shown_unit(row['unit'])[1] * row['std']:.3g}" if _is_drawn_number(row) else ""


def _alike(row: Document) -> str:
    """Return that several entries have one value, where they do."""
    entries = row.get("entries", 1)  # not in results of earlier versions
    return f"; one value for {entries} entries" if entries > 1 else ""


_INPUT_COLUMNS = (
    Column("key", "key"),
    Column("tolerance", lambda row: (row["tolerance"] or row["distribution"]) + _alike(row)),
    Column("unit", lambda row: shown_unit(row["unit"])[0] if _is_drawn_number(row) else ""),
    Column("mean", _mean),
    Column("std", _deviation),
)
_LIMIT_COLUMNS = (
    Column("of", lambda row: part_of(row["name"])),
    Column("quantity", lambda row: shown_quantity(row["name"])[0]),
    Column("limit", _limit),
    Column("nominal", _number(lambda row: row["nominal"])),
    Column("beyond", lambda row: f"{row['within']['total'] - row['within']['good']} of {row['within']['total']}"),
    Column("within", lambda row: _percents(row["within"])),
)
_WORST_COLUMNS = (
    Column("of", lambda row: part_of(row["quantity"])),
    Column("quantity", lambda row: shown_quantity(row["quantity"])[0]),
    Column("gearbox", "gearbox", "d", file="case"),
    Column("value", _number(lambda row: row["value"], ".5g")),
    Column("at [rpm]", "speed_rpm", ".5g"),
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
)


def _told(document: Document) -> list[Document]:
    """Return the quantities that have values."""
    return [row for row in document["quantities"] if row["mean"] is not None and row["mean"] == row["mean"]]


def sections(document: Document) -> tuple[Section, ...]:
    """Return the yield and the worst gearboxes, the inputs, the distributions, and what matters."""
    return (Section("", (*summary(document), *_content(document))),)


def summary(document: Document) -> Iterator[str | Table]:
    """Yield what a quality engineer asks first: the yield, gearboxes beyond each limit, the worst, speeds, inputs."""
    if "yield" in document:
        share = document["yield"]
        of_all = _percents(share).replace("(", "(95 % interval ")
        yield f"Yield: {share['good']} of {share['total']} gearboxes are within all limits, {of_all}."
    limited = [row for row in _told(document) if "within" in row]
    yield from table_of(
        _LIMIT_COLUMNS, limited, "Gearboxes beyond the limits; nominal: without changes, in brackets: 95 % interval"
    )
    yield from _about_nominal(limited, document)
    ranks = _MOST_RANKS if len(document["headlines"]) <= _MOST_RANKED else 1
    files = ", each with a case of its own, worst-….toml" if any("case" in row for row in document["worst"]) else ""
    worst = [row for row in document["worst"] if row["rank"] <= ranks]
    yield from table_of(_WORST_COLUMNS, worst, f"Worst gearboxes{files}")
    if speeds := document["speeds_rpm"]:
        ends = _speeds(np.array(speeds) / RPM) if len(speeds) > 1 else f"{speeds[0]:.5g} rpm"
        yield f"{counted(len(speeds), 'speed')} of the first driver: {ends}."
    yield from _what_matters([row for row in _told(document) if row["name"] in document["headlines"]])
    few = _SAMPLES_OF_AN_INPUT * len(document["inputs"])
    if document["representative"] < few and not any("sobol_total" in row for row in document["quantities"]):
        yield (
            f"{document['representative']} gearboxes are too few to rank {counted(len(document['inputs']), 'input')}: "
            f"take {few} or more."
        )
    yield from table_of(_INPUT_COLUMNS, document["inputs"], "Varied keys; mean and standard deviation as drawn")


def _about_nominal(limited: Sequence[Document], document: Document) -> Iterator[str]:
    """Yield which limits the gearbox without changes breaks, and why it may lie outside the production."""
    beyond, outside = list[str](), list[str]()
    for row in limited:
        limit, nominal, ends = row["limit"], row["nominal"], row["quantiles"]
        name = f"{part_of(row['name'])}, {shown_quantity(row['name'])[0].partition(' [')[0]}"
        if not limit.get("at_least", -math.inf) <= nominal <= limit.get("at_most", math.inf):
            beyond.append(name)
        if not ends["0.05"] <= nominal <= ends["0.95"]:
            outside.append(name)
    if beyond:
        yield f"The gearbox without changes itself is beyond the limit of {'; '.join(beyond)}."
    if outside:
        of_class = any(row["tolerance"].startswith("class") for row in document["inputs"])
        reason = ": it has none of the deviations that a class adds" if of_class else ""
        yield f"The gearbox without changes lies outside 5 to 95 % of the production in {'; '.join(outside)}{reason}."


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
    return Section("Varied gearboxes", (*summary(document), *_content(document)), pictures=pictures)


def _content(document: Document) -> Iterator[str | Table]:
    rows = _told(document)
    yield from table_of(_COLUMNS, rows, "Distributions; nominal: the gearbox without changes")
    leading = [row for row in rows if row["name"] in document["headlines"]]
    by_range = [row["key"] for row in document["inputs"] if row["key"].endswith(".errors.pitch")]
    explaining = {key for row in leading for key in row["explained"]}
    if set(by_range) - explaining and not any("sobol_total" in row for row in leading):
        yield (
            "Pitch deviations of all teeth are judged by their range alone here, which may explain little of what they "
            "do: --indices counts all of them, and --widen tells what their class costs."
        )
    yield from _what_wider_ones_cost(document)
    yield from failed_sentences(document, "gearbox")
    standing = ""
    if document["representative"] < document["samples"]:
        standing = f", {document['representative']} of which stand for the production in the table of distributions"
    yield f"{document['samples']} gearboxes were drawn{standing}{ending(document)}."


def _what_matters(rows: Sequence[Document]) -> Iterator[str | Table]:
    """Yield a table of the most important inputs of the quantities that scatter, and which nothing explains."""
    shown, unexplained = list[Document](), list[str]()
    by_index = any("sobol_total" in row for row in rows)
    for row in rows:
        total, ranks, proven = row.get("sobol_total"), row["rank_correlation"], row["leading_ranks"]
        values = {key: value[0] for key, value in total.items()} if total else row["explained"]
        first = (sorted(values, key=lambda key: -values[key]) or list(proven))[:_MOST_INPUTS]
        if not first:
            unexplained.append(f"{part_of(row['name'])}, {shown_quantity(row['name'])[0].partition(' [')[0]}")
        for key in first:
            shown.append(
                {
                    "of": part_of(row["name"]),
                    "quantity": shown_quantity(row["name"])[0].partition(" [")[0],
                    "input": key,
                    "value": f"{values[key]:.2f}" if key in values else "",
                    "interval": f"{total[key][1]:.2f} to {total[key][2]:.2f}" if total else "",
                    "alone": f"{row['sobol_first'][key][0]:.2f}" if total else "",
                    "rank": _rank(ranks[key], row["rank_chance"][key]) if key in (total or proven) else "",
                }
            )
    caption = (
        "What matters: Sobol' indices, the part of the variance that goes with the input in all and alone"
        if by_index
        else "What matters: part of the variance by the input alone, and rank correlation, where the samples prove one"
    )
    columns = (
        Column("of", "of"),
        Column("quantity", "quantity"),
        Column("input", "input"),
        Column("in all" if by_index else "part", "value"),
        Column("95 % interval", "interval"),
        Column("alone", "alone"),
        Column("rank correlation (p: by chance)", "rank"),
    )
    yield from table_of(columns, shown, caption)
    if unexplained:
        yield (
            f"No input alone explains {'; '.join(unexplained)}, and no rank correlation is beyond chance: more "
            "samples, or --indices, may tell."
        )


def _rank(correlation: float, chance: float) -> str:
    """Return a rank correlation with its probability by chance."""
    return f"{correlation:+.2f} (p {f'= {chance:.0e}' if chance > _TINY else f'< {_TINY:.0e}'})"


def _what_wider_ones_cost(document: Document) -> Iterator[str | Table]:
    """Yield a table of wider inputs: the yield, its change, and how far the first quantity moves."""
    rows = [row for row in document.get("widened", ()) if row["quantities"]]
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
    caption = f"What tolerances wider by a factor of {document['widening']:g} cost, the dearest first; {of_first}"
    yield from table_of(columns, shown, caption)
    yield from _unproven(document)


def _unproven(document: Document) -> Iterator[str]:
    """Yield a sentence where every change of the yield may be chance, with how many gearboxes may prove the largest."""
    changes = [row for row in document["widened"] if "change" in row]
    if not changes or any(row["change"]["low"] > 0.0 or row["change"]["high"] < 0.0 for row in changes):
        return
    text = "No change of the yield is proven: each interval contains 0"
    largest = max(changes, key=lambda row: abs(row["change"]["difference"]))
    if difference := abs(largest["change"]["difference"]):
        # Half of an interval falls with the root of the number of gearboxes.
        half = 0.5 * (largest["change"]["high"] - largest["change"]["low"])
        count = document["representative"] * max(half / difference, 1.0) ** 2
        text += (
            f". About {float(f'{count:.1g}'):.0f} gearboxes of each in place of {document['representative']} would "
            f"prove that of {largest['input']} if it stays as large"
        )
    yield f"{text}."


def _from_to(before: str, after: str, form: str) -> Callable[[Document], str]:
    """Return the function that shows a number of a row before and after its input is widened."""
    numbers = _number(lambda row: row[before], form), _number(lambda row: row[after], form)
    return lambda row: " → ".join(number(row) for number in numbers)
