"""A sweep: a line for each point."""

from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from gearwhine.screen.console import counted, open_console, percent, show_written

_MOST_SENSORS, _MOST_MESHES = 5, 2  # with a column each


def show_sweep(document: dict[str, Any]) -> None:
    """The points of a sweep and what came of them."""
    console = open_console()
    console.print(document["title"], style="bold")
    done = [point for point in document["points"] if point["status"] == "done"]
    if done:
        _table(console, document, done)
    for point in document["points"]:
        if point["status"] == "failed":
            where = ", ".join(f"{key}={text}" for key, text in point["settings"].items())
            console.print(f"Failed at {where}: {point['failure']}")
    total = len(document["points"])
    resumed = f", {document['resumed']} of them by an earlier run" if document["resumed"] else ""
    failed = f"; {document['failed']} failed" if document["failed"] else ""
    console.print(f"{document['done']} of {counted(total, 'point')} done{resumed}{failed}")
    show_written(console, document)
    console.print(f"Time: {document['seconds']['total']:.1f} s")


def _table(console: Console, document: dict[str, Any], done: list[dict[str, Any]]) -> None:
    sensors = [sensor["name"] for sensor in done[0]["sensors"]][:_MOST_SENSORS]
    meshes = [f"{pair['driver']} → {pair['driven']}" for pair in done[0]["gear_pairs"]][:_MOST_MESHES]
    heads = [axis["name"] + (f" [{axis['unit']}]" if axis["unit"] else "") for axis in document["axes"]]
    heads += [f"{name}\nrms [m/s²]" for name in sensors]
    for name in meshes:
        heads += [f"{name}\nlargest [N]", "apart"]
    table = Table(*heads, "energy\nerror", box=SIMPLE_HEAD)
    for column in table.columns:
        column.justify = "right"
    for point in done:
        values = [f"{value:g}" if not isinstance(value, str) else value for value in point["values"].values()]
        levels = {sensor["name"]: f"{sensor['rms_m_per_s2']:.3g}" for sensor in point["sensors"]}
        forces = []
        for pair in point["gear_pairs"][:_MOST_MESHES]:
            forces += [f"{pair['peak_force_n']:.0f}", percent(pair["contact_loss_fraction"])]
        table.add_row(*values, *(levels.get(name, "") for name in sensors), *forces, f"{point['energy_error']:.0e}")
    console.print(table)
