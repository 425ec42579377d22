"""Sweep: the points of its grid as a table."""

from collections.abc import Iterator
from functools import partial

from gearwhine.output.sections import Column, Document, Picture, Section, Table, counted, percent, table_of

_MOST_SENSORS, _MOST_MESHES = 5, 2  # with a column each


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
    for point in document["points"]:
        if point["status"] == "failed":
            where = ", ".join(f"{key}={text}" for key, text in point["settings"].items())
            yield f"Failed at {where}: {point['failure']}"
    resumed = f", {document['resumed']} of them by an earlier run" if document["resumed"] else ""
    failed = f"; {document['failed']} failed" if document["failed"] else ""
    yield f"{document['done']} of {counted(len(document['points']), 'point')} done{resumed}{failed}"


def _columns(document: Document, done: list[Document]) -> tuple[Column, ...]:
    """Return columns of the swept keys, some sensor levels, some mesh forces, and the energy balance."""
    first = done[0]
    columns = [
        Column(
            axis["name"] + (f" [{axis['unit']}]" if axis["unit"] else ""),
            partial(_value, axis["name"]),
        )
        for axis in document["axes"]
    ]
    columns += [
        Column(f"{sensor['name']}\nrms [m/s²]", partial(_level, sensor["name"]))
        for sensor in first["sensors"][:_MOST_SENSORS]
    ]
    for place, pair in enumerate(first["gear_pairs"][:_MOST_MESHES]):
        columns += [
            Column(
                f"{pair['driver']} → {pair['driven']}\nlargest [N]",
                partial(_force, place),
            ),
            Column("apart", partial(_apart, place)),
        ]
    if any("sound" in point for point in done):
        columns.append(Column("sound power\n[dB(A)]", partial(_sound, "total_db_a")))
    return (*columns, Column("energy\nerror", lambda point: f"{point['energy_error']:.0e}"))


def _value(name: str, point: Document) -> str:
    value = point["values"][name]
    return value if isinstance(value, str) else f"{value:g}"


def _force(place: int, point: Document) -> str:
    return f"{point['gear_pairs'][place]['peak_force_n']:.0f}"


def _apart(place: int, point: Document) -> str:
    return percent(point["gear_pairs"][place]["contact_loss_fraction"])


def _sound(key: str, point: Document) -> str:
    return f"{point['sound'][key]:.1f}" if "sound" in point else ""


def _level(name: str, point: Document) -> str:
    levels = {sensor["name"]: sensor["rms_m_per_s2"] for sensor in point["sensors"]}
    return f"{levels[name]:.3g}" if name in levels else ""
