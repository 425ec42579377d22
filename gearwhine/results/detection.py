"""Detectability of a fault by sensor and indicator, as tables."""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwhine.coupling.analyses.gear_condition import INDICATORS
from gearwhine.numerics.result_warnings import ResultWarning, warning
from gearwhine.output.quantity import Part, Quantity, Rows, document_of, in_file
from gearwhine.output.sections import Column, Document, Picture, Section, Table, table_of
from gearwhine.results.many_solutions import ending, failed_sentences, failed_solutions, failed_warnings, finite

if TYPE_CHECKING:
    from gearwhine.detection.detectability import DetectionResult

_MOST_NAMED = 3

DETECTABILITY = (
    Quantity("sensor"),
    Quantity("indicator"),
    Quantity("healthy_mean", lambda one: _of_known(one.healthy, np.mean)),
    Quantity("healthy_std", lambda one: _of_known(one.healthy, lambda known: np.std(known, ddof=1))),
    Quantity("healthy", lambda one: int(np.isfinite(one.healthy).sum())),
    Part(
        "threshold",
        "threshold",
        (
            Quantity("value"),
            Quantity("low", lambda one: finite(one.low)),
            Quantity("high", lambda one: finite(one.high)),
            Quantity("false_alarm_low"),
            Quantity("false_alarm_high"),
            Quantity("law"),
            Quantity("goodness"),
        ),
    ),
    Quantity("method", lambda one: None if one.detection is None else one.detection.method),
    Quantity("a90"),
    Quantity("a90_95"),
    Quantity("contradicted", lambda one: one.detection is not None and one.detection.is_contradicted),
    Rows(
        "found",
        lambda one: None if one.detection is None else one.detection.shares,
        (
            Quantity("size"),
            Quantity("found"),
            Quantity("total"),
            Quantity("low", lambda share: share.interval[0]),
            Quantity("high", lambda share: share.interval[1]),
            Quantity("probability", lambda share: share.found / share.total),
        ),
    ),
    Quantity("undefined", lambda one: one.undefined or None, optional=True),
)
"""Quantities of the detectability by an indicator at a sensor; a row is a
:class:`gearwhine.detection.detectability.Detectability`."""

_EACH, _IN_SI = "see the end of the indicator's name", "in SI, as the key of the fault has it"


def _keys(found: "DetectionResult") -> list[str]:
    return [INDICATORS[name].key for name in found.monitor.indicators]


def _in_file(name: str, of: Callable[[Any], Any], long_name: str, unit: str = "", *along: str) -> Quantity:
    """Declare values of every sensor and indicator for the file, NaN where there is none."""

    def values(found: "DetectionResult") -> Any:
        rows = np.array([np.nan if (row := of(one)) is None else row for one in found.parts], dtype=np.float64)
        return rows.reshape(len(found.monitor.sensors), len(found.monitor.indicators), *rows.shape[1:])

    return in_file(name, ("sensor", "indicator", *along), values, long_name, unit)


DETECTION = (
    Quantity("fault"),
    Quantity("gear"),
    Quantity("severities", lambda found: list(found.severities.values())),
    Quantity("sizes", lambda found: list(found.severities)),
    Quantity("shown_unit", "shown_unit.0"),
    Quantity("shown_factor", "shown_unit.1"),
    Quantity("sensor_names", "monitor.sensors"),
    Quantity("indicator_names", "monitor.indicators"),
    Quantity("sensor_noise_m_per_s2", "monitor.sensor_noise"),
    Quantity("averages", "monitor.averages"),
    Quantity("false_alarm", "monitor.false_alarm"),
    Quantity("is_varied"),
    Quantity("has_own_baseline", "monitor.has_own_baseline"),
    Quantity("turns"),
    Quantity("limit_hz", "limit_hz"),
    Rows("detectability", "parts", DETECTABILITY),
    Quantity(
        "best",
        lambda found: {sensor: None if one is None else one.indicator for sensor, one in found.best.items()},
    ),
    failed_solutions(),
    Quantity("samples"),
    Quantity("resumed"),
    in_file("sensor", "sensor", "monitor.sensors", "sensor"),
    in_file("indicator", "indicator", _keys, "condition indicator, with its unit at the end"),
    in_file("fault_size", "faulty_sample", lambda found: found.parts[0].sizes, f"size of the fault, {_IN_SI}"),
    _in_file("healthy", lambda one: one.healthy, "healthy value", _EACH, "healthy_sample"),
    _in_file("faulty", lambda one: one.responses, "faulty value", _EACH, "faulty_sample"),
    _in_file("threshold", lambda one: None if one.threshold is None else one.threshold.value, "threshold", _EACH),
    _in_file("a90", lambda one: one.a90, f"size that is found with 0.9, {_IN_SI}"),
    _in_file("a90_95", lambda one: one.a90_95, f"the same with a confidence of 95 %, {_IN_SI}"),
)
"""Quantities of a detection study; the object is a :class:`gearwhine.detection.detectability.DetectionResult`."""


def _of_known(values: Any, of: Callable[[Any], Any]) -> float | None:
    known = values[np.isfinite(values)]
    return float(of(known)) if known.size > 1 else None


def detection_document(found: "DetectionResult") -> dict[str, Any]:
    """Return a detection study as the command's JSON."""
    return document_of(DETECTION, found) | {"warnings": list(_warnings(found))}


def _warnings(found: "DetectionResult") -> Iterator[ResultWarning]:
    yield from failed_warnings(found, found.samples, "failed samples", "gearboxes")
    odd = [
        f"{INDICATORS[one.indicator].title} at {one.sensor}"
        for one in found.parts
        if one.threshold is not None and not one.threshold.fits
    ]
    if odd:
        more = f" and {len(odd) - _MOST_NAMED} more" if len(odd) > _MOST_NAMED else ""
        message = (
            f"the healthy values of {', '.join(odd[:_MOST_NAMED])}{more} are not of the distribution that is fitted to "
            'them: its threshold has another false-alarm rate than that; threshold = "order" holds for any distribution'
        )
        yield warning("distribution of healthy values", message, parts=len(odd))


def _size(document: Document, row: Document, key: str) -> str:
    """Return a size in the unit that is shown, a dash where none is seen."""
    size = row[key]
    if size is None:
        return "–"
    # A curve that is above 0.9 from the smallest size on says no more than that.
    sign = "≤ " if size <= min(document["sizes"]) else ""
    return f"{sign}{document['shown_factor'] * size:.3g}"


def _a90(document: Document, row: Document) -> str:
    if row["a90"] is None:
        return "undefined" if "undefined" in row else "–"
    return f"{_size(document, row, 'a90')} ({_size(document, row, 'a90_95')})"


def sections(document: Document) -> tuple[Section, ...]:
    """Return the sizes that are seen, and by what."""
    return (Section("", tuple(_content(document))),)


def report(document: Document) -> Section:
    """Return the chapter of the report."""
    pictures = (
        Picture("detection-matrix", "Size that is found with a probability of 0.9, by sensor and indicator."),
        Picture("detection-responses", "Indicator over the size of the fault at each sensor, with its threshold."),
        Picture("detection-probability", "Probability of detection over the size of the fault at each sensor."),
    )
    return Section("Detectability of a fault", tuple(_content(document)), pictures=pictures)


def _content(document: Document) -> Iterator[str | Table]:
    by_indicator: dict[str, dict[str, Document]] = {}
    for row in document["detectability"]:
        by_indicator.setdefault(row["indicator"], {})[row["sensor"]] = row
    unit = f" [{document['shown_unit']}]" if document["shown_unit"] else ""

    def of_sensor(sensor: str) -> Column:
        return Column(sensor, lambda rows: _a90(document, rows[sensor]))

    matrix = [rows | {"indicator": INDICATORS[name].title} for name, rows in by_indicator.items()]
    yield from table_of(
        (Column("indicator", "indicator"), *(of_sensor(sensor) for sensor in document["sensor_names"])),
        matrix,
        f"Size that is found with a probability of 0.9, a90 (a90/95){unit}: {document['fault']}",
    )
    rows = list(_best_rows(document))
    best, found = _best_columns(document)
    yield from table_of(
        best, rows, "Best indicator of each sensor: the smallest a90, of equal ones the smallest a90/95"
    )
    yield from table_of(found, rows, "Gearboxes in which it finds the fault, by size")
    if missing := [sensor for sensor in document["sensor_names"] if sensor not in [row["sensor"] for row in rows]]:
        yield (
            f"No indicator at {', '.join(missing)} finds any of these sizes with a probability of 0.9: larger sizes, "
            "more healthy gearboxes for a lower threshold, or less scatter between records may tell."
        )
    for row in rows:
        if row["alike"]:
            title = INDICATORS[row["indicator"]].title
            yield f"Others that see as small a fault at {row['sensor']} as {title}: {row['alike']}."
    if unbounded := [row for row in document["detectability"] if row["a90"] is not None and row["a90_95"] is None]:
        yield (
            f"Without a90/95: {_where(unbounded)}. The gearboxes with the fault are too few for a confidence of 95 %; "
            "take more `faulty` ones, or more sizes. At one size alone it takes 29 of 29."
        )
    if contradicted := [row for row in document["detectability"] if row["contradicted"]]:
        yield (
            f"Hits contradict the fitted curve of {_where(contradicted)}: fewer are found from its a90 on than 0.9 of "
            "them. Such an indicator is the best of none but where no other sees the fault."
        )
    for reason in dict.fromkeys(row["undefined"] for row in document["detectability"] if "undefined" in row):
        where = _where([row for row in document["detectability"] if row.get("undefined") == reason])
        yield f"Undefined: {where}: {reason}."
    yield from failed_sentences(document, "gearbox")
    noise = document["sensor_noise_m_per_s2"]
    alike = "" if document["is_varied"] else "; no key varies: healthy records of the one gearbox differ by noise alone"
    against = "; indicators over those of an earlier record of the same gearbox" if document["has_own_baseline"] else ""
    yield (
        f"Averages by the turns of {document['gear']!r}, {document['turns']:.0f} turns simulated, up to "
        f"{document['limit_hz']:.0f} Hz; noise of {noise:.3g} m/s² at each sensor, averaged over "
        f"{document['averages']} turns; a false-alarm rate of {document['false_alarm']:g} of each indicator "
        f"alone{alike}{against}"
    )
    yield f"{document['samples']} gearboxes{ending(document)}"


def _where(rows: Sequence[Document]) -> str:
    """Return the indicators of some rows with their sensors, the first by name."""
    named = [f"{INDICATORS[row['indicator']].title} at {row['sensor']}" for row in rows]
    more = f" and {len(named) - _MOST_NAMED} more" if len(named) > _MOST_NAMED else ""
    return f"{', '.join(named[:_MOST_NAMED])}{more}"


def _best_rows(document: Document) -> Iterator[Document]:
    """Yield the best indicator of each sensor, with the names of others that see the same sizes."""
    for sensor, indicator in document["best"].items():
        of_sensor = [one for one in document["detectability"] if one["sensor"] == sensor]
        best = next((one for one in of_sensor if one["indicator"] == indicator), None)
        if best is None:
            continue
        keys = ("a90", "a90_95", "contradicted")
        alike = [one for one in of_sensor if one is not best and all(one[key] == best[key] for key in keys)]
        yield best | {"alike": ", ".join(INDICATORS[one["indicator"]].title for one in alike)}


def _best_columns(document: Document) -> tuple[tuple[Column, ...], tuple[Column, ...]]:
    """Return the columns of the best indicators with their thresholds, and of the sizes that they find."""
    unit = f" [{document['shown_unit']}]" if document["shown_unit"] else ""

    def found(place: int) -> Callable[[Document], str]:
        return lambda row: f"{row['found'][place]['found']}/{row['found'][place]['total']}"

    def threshold(row: Document) -> str:
        value, *ends = (row["threshold"][key] for key in ("value", "low", "high"))
        # As many digits as tell both ends from the threshold.
        apart = [abs(end / value - 1.0) for end in ends if end is not None and value and end != value]
        digits = max([4, *(2 - math.floor(math.log10(one)) for one in apart)])
        low, high = (f"{end:.{digits - 1}g}" if end is not None else "∞" for end in ends)
        return f"{value:.{digits}g} ({low} to {high})"

    sensor = Column("sensor", "sensor")
    best = (
        sensor,
        Column("indicator", lambda row: INDICATORS[row["indicator"]].title),
        Column(f"a90 (a90/95){unit}", lambda row: _a90(document, row)),
        Column("healthy mean", lambda row: f"{row['healthy_mean']:.4g}"),
        Column("threshold (95 %)", threshold),
        Column("curve by", lambda row: row["method"]),
    )
    return best, (sensor, *(Column(severity, found(place)) for place, severity in enumerate(document["severities"])))
