"""Condition indicators of gears and bearings by sensor, as tables of a run."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwhine.coupling.analyses.gear_condition import INDICATORS
from gearwhine.output.quantity import Quantity, Rows, document_of, in_file
from gearwhine.output.sections import Column, Document, Section, Table, table_of

if TYPE_CHECKING:
    from gearwhine.coupling.analyses.gear_condition import MachineCondition

_NOTE = (
    "Condition indicators of each gear: of the average over the turns of its shaft, up to {limit:.0f} Hz, the trusted "
    "limit; residual without the mesh harmonics and the first two orders of the shaft, difference also without their "
    "sidebands. Gaussian noise has FM4 3, M6A 15 and M8A 105. Shafts of one speed have one average."
)


def _values(row: Any) -> dict[str, float | None]:
    return {INDICATORS[name].key: value for name, value in row.values.items()}


def _in_file(part: str) -> Any:
    """Return the function that lists the values of all gears by sensor and indicator."""

    def of(condition: "MachineCondition") -> Any:
        rows = [one for one in condition.gears if one.sensors]
        if not rows:
            return None
        if part == "gears":
            return [one.gear.gear for one in rows]
        if part == "sensors":
            return [one.sensor for one in rows[0].sensors]
        names = list(rows[0].sensors[0].values)
        if part == "indicators":
            return [INDICATORS[name].key for name in names]
        values = [[[sensor.values[name] for name in names] for sensor in one.sensors] for one in rows]
        return np.array(values, dtype=np.float64)

    return of


_WHERE = ("watched_gear", "condition_sensor", "condition_indicator")
CONDITION = (
    Quantity("limit_hz", "limit_hz"),
    Rows(
        "gears",
        "gears",
        (
            Quantity("gear", "gear.gear"),
            Quantity("shaft", "gear.shaft"),
            Quantity("teeth", "gear.teeth"),
            Quantity("turn_hz", "gear.turn_hz"),
            Quantity("turns", "gear.turns"),
            Quantity("undefined", lambda row: row.gear.undefined or None, optional=True),
            Rows(
                "sensors",
                "sensors",
                (
                    Quantity("sensor"),
                    Quantity("indicators", _values),
                    Quantity("undefined", lambda row: row.undefined or None, optional=True),
                ),
            ),
        ),
    ),
    Rows(
        "tones",
        "tones",
        (Quantity("tone"), Quantity("frequency_hz", "frequency_hz"), Quantity("envelope", "amplitudes")),
    ),
    in_file("watched_gear", "watched_gear", _in_file("gears")),
    in_file("condition_sensor", "condition_sensor", _in_file("sensors")),
    in_file("condition_indicator", "condition_indicator", _in_file("indicators")),
    in_file(
        "condition",
        _WHERE,
        _in_file("values"),
        "condition indicator of the gear at the sensor, in the unit at the end of its name",
        "1",
    ),
    Quantity("", lambda row: list(row.envelopes) or None, "envelope_sensor", ("envelope_sensor",)),
    Quantity(
        "",
        lambda row: row.envelope_hz if row.envelopes else None,
        "envelope_frequency",
        ("envelope_frequency",),
        "Hz",
        "frequency of the envelope spectra",
    ),
    Quantity(
        "",
        lambda row: np.array(list(row.envelopes.values())) if row.envelopes else None,
        "envelope",
        ("envelope_sensor", "envelope_frequency"),
        "1",
        "amplitude of the squared envelope of the upper half of the band over its mean",
    ),
)
"""Quantities of a machine's condition; the object is a
:class:`gearwhine.coupling.analyses.gear_condition.MachineCondition`."""


def condition_document(condition: "MachineCondition") -> dict[str, Any]:
    """Return the condition of a machine as a part of a run's document."""
    return document_of(CONDITION, condition)


def _shown(name: str) -> Column:
    one = INDICATORS[name]
    unit = " [m/s²]" if one.key.endswith("_m_per_s2") else ""
    return Column(f"{one.title}{unit}", lambda row: _text(row["indicators"].get(one.key)))


def _text(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"


def _rows(document: Document) -> Iterator[Document]:
    for gear in document["gears"]:
        for place, sensor in enumerate(gear["sensors"]):
            yield sensor | {"gear": "" if place else gear["gear"]}


def content(document: Document) -> Iterator[str | Table]:
    """Yield the tables of the indicators by gear and sensor, with the reasons of those that are undefined."""
    rows = list(_rows(document))
    names = [name for name in INDICATORS if any(INDICATORS[name].key in row["indicators"] for row in rows)]
    # Narrow enough for a terminal.
    for part, caption in ((names[:7], "Condition of the gears"), (names[7:], "")):
        if part:
            columns = (Column("gear", "gear"), Column("sensor", "sensor"), *map(_shown, part))
            yield from table_of(columns, rows, caption)
    reasons = dict[str, None]()
    for gear in document["gears"]:
        if "undefined" in gear:
            reasons[f"Gear {gear['gear']!r} has no indicators: {gear['undefined']}."] = None
        for sensor in gear["sensors"]:
            for reason in dict.fromkeys(sensor.get("undefined", {}).values()):
                lacking = [INDICATORS[name].title for name, text in sensor["undefined"].items() if text == reason]
                where = f"gear {gear['gear']!r} at sensor {sensor['sensor']!r}"
                reasons[f"Undefined of {where}: {', '.join(lacking)}, as {reason}."] = None
    yield from reasons
    columns = (
        Column("bearing tone", "tone"),
        Column("Hz", "frequency_hz", ".1f"),
        Column("sensor", "sensor"),
        Column("envelope line / mean", lambda row: _text(row["envelope"])),
    )
    tones = [
        {**tone, "sensor": sensor, "envelope": value}
        for tone in document["tones"]
        for sensor, value in tone["envelope"].items()
    ]
    yield from table_of(columns, tones, "Envelope spectra at the tones of rolling bearings")
    if rows:
        yield _NOTE.format(limit=document["limit_hz"])


def report(document: Document) -> Section:
    """Return the section of the report."""
    return Section("Condition of gears and bearings", tuple(content(document)))
