"""Detectability of a fault by sensor and indicator, as tables."""

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwhine.coupling.analyses.gear_condition import INDICATORS
from gearwhine.numerics.result_warnings import ResultWarning, warning
from gearwhine.output.quantity import Part, Quantity, Rows, document_of
from gearwhine.output.sections import Column, Document, Picture, Section, Table, table_of

if TYPE_CHECKING:
    import xarray as xr

    from gearwhine.detection.detectability import DetectionResult

_MOST_FAILURES = 5  # told one by one
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
            Quantity("low", lambda one: _finite(one.low)),
            Quantity("high", lambda one: _finite(one.high)),
            Quantity("false_alarm_low"),
            Quantity("false_alarm_high"),
            Quantity("law"),
            Quantity("goodness"),
        ),
    ),
    Quantity("method", lambda one: None if one.detection is None else one.detection.method),
    Quantity("a90"),
    Quantity("a90_95"),
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
    Rows(
        "failed",
        lambda found: list(found.failures.items()),
        (
            Quantity("number", "0"),
            Quantity("message", "1.message"),
            Quantity("traceback", lambda row: row[1].traceback or None, optional=True),
        ),
    ),
    Quantity("samples"),
    Quantity("resumed"),
)
"""Quantities of a detection study; the object is a :class:`gearwhine.detection.detectability.DetectionResult`."""


def _of_known(values: Any, of: Callable[[Any], Any]) -> float | None:
    known = values[np.isfinite(values)]
    return float(of(known)) if known.size > 1 else None


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def detection_document(found: "DetectionResult") -> dict[str, Any]:
    """Return a detection study as the command's JSON."""
    return document_of(DETECTION, found) | {"warnings": list(_warnings(found))}


def _warnings(found: "DetectionResult") -> Iterator[ResultWarning]:
    if failed := len(found.failures):
        first = next(iter(found.failures.values()))
        yield warning(
            "failed samples",
            f"{failed} of {found.samples} gearboxes cannot be solved: {first.message}",
            failed=failed,
        )
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


def detection_dataset(found: "DetectionResult", title: str) -> "xr.Dataset":
    """Return every value of every gearbox, with thresholds and sizes that are seen, as one labelled dataset."""
    import xarray as xr

    from gearwhine import __version__

    shape = len(found.monitor.sensors), len(found.monitor.indicators)
    where = ("sensor", "indicator")
    keys = [INDICATORS[name].key for name in found.monitor.indicators]

    def table(of: Callable[[Any], Any]) -> Any:
        rows = [of(one) for one in found.parts]
        return np.array([np.nan if row is None else row for row in rows], dtype=np.float64).reshape(shape)

    def values(of: Callable[[Any], Any]) -> Any:
        rows = np.array([of(one) for one in found.parts])
        return rows.reshape(*shape, rows.shape[-1])

    unit = "in SI, as the key of the fault has it"
    each = {"units": "see the end of the indicator's name"}
    variables: dict[str, Any] = {
        "healthy": ((*where, "healthy_sample"), values(lambda one: one.healthy), each | {"long_name": "healthy value"}),
        "faulty": ((*where, "faulty_sample"), values(lambda one: one.responses), each | {"long_name": "faulty value"}),
        "threshold": (
            where,
            table(lambda one: None if one.threshold is None else one.threshold.value),
            each | {"long_name": "threshold"},
        ),
        "a90": (where, table(lambda one: one.a90), {"long_name": f"size that is found with 0.9, {unit}"}),
        "a90_95": (where, table(lambda one: one.a90_95), {"long_name": f"the same with a confidence of 95 %, {unit}"}),
    }
    coordinates: dict[str, Any] = {
        "sensor": ("sensor", list(found.monitor.sensors), {"long_name": "sensor"}),
        "indicator": ("indicator", keys, {"long_name": "condition indicator, with its unit at the end"}),
        "fault_size": ("faulty_sample", found.parts[0].sizes, {"long_name": f"size of the fault, {unit}"}),
    }
    return xr.Dataset(variables, coordinates, {"title": title, "source": f"gearwhine {__version__}"})


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
    yield from table_of(_best_columns(document), list(_best_rows(document)), "Best indicator of each sensor")
    for reason in dict.fromkeys(row["undefined"] for row in document["detectability"] if "undefined" in row):
        where = [
            f"{INDICATORS[row['indicator']].title} at {row['sensor']}"
            for row in document["detectability"]
            if row.get("undefined") == reason
        ]
        more = f" and {len(where) - _MOST_NAMED} more" if len(where) > _MOST_NAMED else ""
        yield f"Undefined: {', '.join(where[:_MOST_NAMED])}{more}: {reason}."
    for failure in document["failed"][:_MOST_FAILURES]:
        yield f"Gearbox {failure['number']} failed: {failure['message']}"
    noise = document["sensor_noise_m_per_s2"]
    alike = "" if document["is_varied"] else "; no key varies: healthy records of the one gearbox differ by noise alone"
    against = "; indicators over those of an earlier record of the same gearbox" if document["has_own_baseline"] else ""
    yield (
        f"Averages by the turns of {document['gear']!r}, {document['turns']:.0f} turns simulated, up to "
        f"{document['limit_hz']:.0f} Hz; noise of {noise:.3g} m/s² at each sensor, averaged over "
        f"{document['averages']} turns; a false-alarm rate of {document['false_alarm']:g} of each indicator "
        f"alone{alike}{against}"
    )
    resumed = f", {document['resumed']} of them by an earlier run" if document["resumed"] else ""
    failed = f"; {len(document['failed'])} failed" if document["failed"] else ""
    yield f"{document['samples']} gearboxes{resumed}{failed}"


def _best_rows(document: Document) -> Iterator[Document]:
    for sensor, indicator in document["best"].items():
        rows = [one for one in document["detectability"] if one["sensor"] == sensor and one["indicator"] == indicator]
        yield rows[0] if rows else {"sensor": sensor, "indicator": None}


def _best_columns(document: Document) -> tuple[Column, ...]:
    def text(of: Callable[[Document], str]) -> Callable[[Document], str]:
        return lambda row: of(row) if row["indicator"] is not None else ""

    def found(place: int) -> Callable[[Document], str]:
        return text(lambda row: f"{row['found'][place]['found']}/{row['found'][place]['total']}")

    def threshold(row: Document) -> str:
        limit = row["threshold"]
        low, high = (f"{limit[key]:.3g}" if limit[key] is not None else "∞" for key in ("low", "high"))
        return f"{limit['value']:.4g} ({low} to {high})"

    return (
        Column("sensor", "sensor"),
        Column("indicator", lambda row: "none" if row["indicator"] is None else INDICATORS[row["indicator"]].title),
        Column("healthy mean", text(lambda row: f"{row['healthy_mean']:.4g}")),
        Column("threshold (95 %)", text(threshold)),
        Column("by", text(lambda row: row["method"])),
        *(Column(severity, found(place)) for place, severity in enumerate(document["severities"])),
    )
