"""Sweep: the points of its grid as a table, and the peaks that it passes by."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from gearwhine.coupling.signals.spectrum import from_decibels, rms_of_peak
from gearwhine.output.quantity import ABSENT, Quantity, shown_product
from gearwhine.output.sections import (
    Column,
    Document,
    Picture,
    Section,
    Table,
    arrowed,
    columns_of,
    counted,
    percent,
    rms_of_band,
    table_of,
)
from gearwhine.results.sound import SWEPT_LINE

_SOUND = "sound"  # output of a peak of the sound power

_MOST_SENSORS, _MOST_MESHES = 5, 2  # with a column each
_MOST_PEAKS = 8  # on the terminal


def _peak_between(row: Mapping[str, Any]) -> str:
    """Return the points on either side of a peak."""
    others = (f"{key}={text}" for key, text in row["settings"].items())
    return ", ".join([f"{row['below_rpm']:g} and {row['above_rpm']:g}", *others])


def _peak_level(row: Mapping[str, Any]) -> str:
    """Return the level of a peak: that of the sound power, or the rms acceleration of a sensor."""
    if row["output"] == _SOUND:
        return f"L_W {row['level_db']:.1f} dB"
    return f"{row['output']} {_rms(row['level_db']):.3g} m/s²"


def _rms(level_db: float) -> float:
    """Root mean square of an acceleration by its level [m/s²]."""
    return float(rms_of_peak(from_decibels(level_db)))


PEAK = (
    Quantity("settings"),
    Quantity("below_rpm", "below_rpm"),
    Quantity("above_rpm", "above_rpm"),
    Quantity(
        "line",
        "line",
        "missed_peak_line",
        long_name="line of a peak between two points",
        heading="line",
        shown=lambda row: arrowed(str(row["line"])),
    ),
    Quantity(
        "mode", "mode", "missed_peak_mode", long_name="coupled mode that the line meets there", heading="meets the mode"
    ),
    Quantity("frequency_hz", "frequency_hz", heading="at [Hz]", shown=".1f"),
    Quantity("damping_ratio"),
    Quantity(
        "speed_rpm",
        "speed_rpm",
        "missed_peak_speed",
        long_name="speed of the peak, of the first driver",
        heading="speed [rpm]",
        shown=".1f",
    ),
    Quantity("half_width_rpm", "half_width_rpm", heading="half-power\nwidth ± [rpm]", shown=".2g"),
    Quantity("output", "output", "missed_peak_output", long_name="sound, or the sensor that peaks"),
    Quantity(
        "level_db",
        "level_db",
        "missed_peak_level",
        long_name="estimated level of the line there: of sound power re 1 pW, of an rms acceleration re 1e-6 m/s2",
    ),
    Quantity(
        "level_re",
        lambda peak: "1 pW" if peak.output == _SOUND else "1e-6 m/s2 rms",
        "missed_peak_level_reference",
        long_name="reference of that level",
    ),
    Quantity("rms_m_per_s2", lambda peak: ABSENT if peak.output == _SOUND else _rms(peak.level_db)),
    Quantity("found_over_linear_db", "found_over_linear_db"),
    Quantity("rise_db", "rise_db", heading="above the louder\npoint [dB]", shown=".1f"),
)
"""Quantities of a peak between two points of a sweep over speed, see :class:`gearwhine.sweep.resolution.MissedPeak`."""

*_OF_PEAK, _RISE = columns_of(PEAK)
_PEAK_COLUMNS = (
    Column("between [rpm]", _peak_between, numbers=("below_rpm", "above_rpm")),
    *_OF_PEAK,
    Column("estimate", _peak_level, numbers=("level_db", "rms_m_per_s2")),
    _RISE,
)


def sections(document: Document) -> tuple[Section, ...]:
    """Return the points of a sweep and their results as a table."""
    return (Section("", tuple(_content(document))),)


def report(document: Document) -> Section:
    """Chapter of the report."""
    return Section("Sweep", tuple(_content(document)), pictures=_PICTURES)


_PICTURES = (
    Picture("sweep-rms", "Level of each sensor over the sweep: peaks are resonances of the machine."),
    Picture("sweep-mesh-force", "Largest and mean mesh force over the sweep, and the time that the flanks are apart."),
    Picture(
        "sweep-sound",
        "Sound power level over the sweep, and the frequencies of the loudest lines: where they meet a mode it rises.",
    ),
    Picture(
        "waterfall",
        "Spectra over the sweep: slanted lines are orders, upright ones modes; they meet in resonances.",
    ),
)


def _content(document: Document) -> Iterator[str | Table]:
    done = [point for point in document["points"] if point["status"] == "done"]
    if done:
        yield from table_of(_columns(document, done), done)
        heard = [point for point in done if "sound" in point]
        yield from table_of(_sound_columns(document), heard, "Sound of each point, and its loudest line")
    for point in document["points"]:
        if point["status"] == "failed":
            where = ", ".join(f"{key}={text}" for key, text in point["settings"].items())
            yield f"Failed at {where}: {point['failure']}"
    resumed = f", {document['resumed']} of them by an earlier run" if document["resumed"] else ""
    failed = f"; {document['failed']} failed" if document["failed"] else ""
    yield from _missed(document)
    yield f"{document['done']} of {counted(len(document['points']), 'point')} done{resumed}{failed}"


def _missed(document: Document) -> Iterator[str | Table]:
    """Yield the peaks between the points, and the speeds that resolve them."""
    peaks = document["missed_peaks"]
    if not peaks:
        return
    of_sensors = "" if peaks[0]["output"] == _SOUND else "; of sensors the rms of the line"
    caption = f"Peaks between the points, by the linear response{of_sensors}"
    yield from table_of(_PEAK_COLUMNS, peaks[:_MOST_PEAKS], caption)
    speeds = ", ".join(f"{speed:g} rpm" for speed in document["speeds_to_add_rpm"])
    more = f", of which the table has {_MOST_PEAKS}" if len(peaks) > _MOST_PEAKS else ""
    yield (
        f"The points pass by {counted(len(peaks), 'peak')} narrower than their spacing{more}. Add {speeds}; in the "
        f"same folder, what is done stays: gearwhine sweep CASE {document['over_with_peaks']}"
    )


def _columns(document: Document, done: list[Document]) -> tuple[Column, ...]:
    """Return columns of the swept keys, some sensor levels, some mesh forces, and the energy balance."""
    first = done[0]
    columns = _axes(document)
    rms = rms_of_band(point.get("trusted_below_hz") for point in done)
    columns += [
        Column(
            f"{sensor['name']}\n{rms} [m/s²]", f"sensors.{place}.rms_m_per_s2", shown=partial(_level, sensor["name"])
        )
        for place, sensor in enumerate(first["sensors"][:_MOST_SENSORS])
    ]
    for place, pair in enumerate(first["gear_pairs"][:_MOST_MESHES]):
        columns += [
            Column(
                f"{pair['driver']} → {pair['driven']}\nlargest [N]",
                f"gear_pairs.{place}.peak_force_n",
                ".0f",
            ),
            Column("apart", f"gear_pairs.{place}.contact_loss_fraction", shown=partial(_apart, place)),
        ]
    return (*columns, Column("energy\nerror", "energy_error", ".0e"))


def _axes(document: Document) -> list[Column]:
    """Return columns of the swept keys."""
    return [
        Column(
            axis["name"] + (f" [{shown_product(axis['unit'])}]" if axis["unit"] else ""), f"values.{axis['name']}", "g"
        )
        for axis in document["axes"]
    ]


def _sound_columns(document: Document) -> tuple[Column, ...]:
    """Return columns of the swept keys, the sound power levels, and the loudest line with the mode that carries it."""
    return (
        *_axes(document),
        Column("L_W [dB]", "sound.total_db", ".1f"),
        Column("L_WA [dB]", "sound.total_db_a", ".1f"),
        *(_loudest(column) for column in columns_of(SWEPT_LINE)),
    )


def _apart(place: int, point: Document) -> str:
    return percent(point["gear_pairs"][place]["contact_loss_fraction"])


def _loudest(column: Column) -> Column:
    """Return a column of a line as that of the loudest line of a point."""
    return replace(
        column,
        of=f"sound.loudest.{column.of}",
        shown=lambda point: column.text(point["sound"]["loudest"]),
        numbers=tuple(f"sound.loudest.{key}" for key in column.numbers),
    )


def _level(name: str, point: Document) -> str:
    levels = {sensor["name"]: sensor["rms_m_per_s2"] for sensor in point["sensors"]}
    return f"{levels[name]:.3g}" if name in levels else ""
