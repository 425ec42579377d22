"""The main job that runs everything."""

from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from gearwhine.screen.console import counted, line_text, open_console, percent, show_written
from gearwhine.screen.housing import comparison_table, modes_line

_STEPS = {"newmark": "steps", "exact": "exact elements"}


def show_run(document: dict[str, Any]) -> None:
    """The main job's outcome."""
    console = open_console()
    console.print(document["title"], style="bold")
    if "housing" in document:
        modes_line(console, document["housing"])
    if "compare" in document:
        comparison_table(console, document["compare"])
    for pair in document.get("gear_pairs", ()):
        side = " on its back flanks" if pair.get("flanks") == "back" else ""
        console.print(
            f"Gear mesh {pair['driver']} → {pair['driven']}{side}: mean force {pair['mean_force_n']:.0f} N, "
            f"peak {pair['peak_force_n']:.0f} N, apart {percent(pair['contact_loss_fraction'])} of the time"
        )
        if pair.get("friction"):
            console.print(f"  friction between its teeth takes {pair['friction']['mean_power_w']:.3g} W")
    if document.get("sensors"):
        _sensors(console, document)
    if "steps" in document:
        console.print(
            f"Transient: {document['steps']} {_STEPS[document['method']]}, "
            f"{document['steps_per_second']:.0f} a second; energy balance closes "
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
        lines = "  ".join(line_text(peak) for peak in sensor["peaks"][:5])
        table.add_row(sensor["name"], f"{sensor['rms_m_per_s2']:.3g}", lines)
    console.print(table)
    _signature(console, document)


def _signature(console: Console, document: dict[str, Any]) -> None:
    """What the leading lines are, and which housing modes and bearings they come from."""
    table = Table("sensor", "Hz", "dB", "what it is", "near", "by housing modes", "by bearings", box=SIMPLE_HEAD)
    for column in (1, 2):
        table.columns[column].justify = "right"
    for sensor in document["sensors"]:
        for number, peak in enumerate(sensor["peaks"][:3]):
            if "contributions" not in peak:
                continue
            near = peak["near_mode"]
            parts = peak["contributions"]
            table.add_row(
                sensor["name"] if number == 0 else "",
                f"{peak['frequency_hz']:.0f}",
                f"{peak['level_db']:.0f}",
                peak["name"] if peak["kind"] != "mode" else f"free {peak['name']}",
                "" if near is None else f"{near['frequency_hz']:.0f} Hz {near['kind']}",
                ", ".join(f"{part.get('number', 'local')}: {_share(part)}" for part in parts["housing_modes"][:3]),
                ", ".join(f"{part['name']}: {_share(part)}" for part in _with_free(parts)[:3]),
            )
    if table.rows:
        console.print(table)
        console.print("Levels of rms values re 1 µm/s²; shares in phase with the line, all of which add up to it.")


def _with_free(parts: dict[str, Any]) -> list[dict[str, Any]]:
    """Bearings, and free vibration where it counts."""
    both = [*parts["bearings"], parts["free_vibration"]]
    return sorted(both, key=lambda part: -part["amplitude_m_per_s2"])


def _share(part: dict[str, Any]) -> str:
    return f"{100.0 * part['share']:.0f} %"
