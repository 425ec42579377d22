"""The main job that runs everything."""

from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from gearwhine.screen.console import counted, open_console, percent, show_written
from gearwhine.screen.housing import comparison_table, modes_line


def show_run(document: dict[str, Any]) -> None:
    """The main job's outcome."""
    console = open_console()
    console.print(document["title"], style="bold")
    if "housing" in document:
        modes_line(console, document["housing"])
    if "compare" in document:
        comparison_table(console, document["compare"])
    for pair in document.get("gear_pairs", ()):
        console.print(
            f"Gear mesh {pair['driver']} → {pair['driven']}: mean force {pair['mean_force_n']:.0f} N, "
            f"peak {pair['peak_force_n']:.0f} N, apart {percent(pair['contact_loss_fraction'])} of the time"
        )
    if document.get("sensors"):
        _sensors(console, document)
    if "steps" in document:
        console.print(
            f"Transient: {document['steps']} steps, {document['steps_per_second']:.0f} a second; energy balance closes "
            f"to {document['energy_error']:.1e}; {document['coordinates']} modal coordinates"
        )
    elif "system" in document:
        console.print(f"Coupled system: {counted(len(document['system']['modes']), 'mode')}")
    show_written(console, document)
    console.print(f"Time: {document['seconds']['total']:.1f} s")


def _sensors(console: Console, document: dict[str, Any]) -> None:
    table = Table("sensor", "rms [m/s²]", "highest lines: Hz (m/s², peak)", box=SIMPLE_HEAD)
    table.columns[1].justify = "right"
    for sensor in document["sensors"]:
        lines = "  ".join(
            f"{peak['frequency_hz']:.0f} ({peak['amplitude_m_per_s2']:.2g})" for peak in sensor["peaks"][:5]
        )
        table.add_row(sensor["name"], f"{sensor['rms_m_per_s2']:.3g}", lines)
    console.print(table)
