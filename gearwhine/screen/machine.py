"""The coupled system, and the main job that runs everything."""

from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from gearwhine.screen.console import counted, open_console, percent, show_origin, show_written
from gearwhine.screen.health import static_error_line
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


def show_system(document: dict[str, Any]) -> None:
    """Coupled modes, up to twice the frequency below which the housing's modes are all there."""
    console = open_console()
    modes, trusted = document["modes"], document.get("trusted_below_hz")
    shown = [mode for mode in modes if not trusted or mode["frequency_hz"] <= 2.0 * trusted]
    console.print(f"{document['coordinates']} coordinates at {document['speed_rpm']:.0f} rpm")
    # Few machines have motions along the axis or pedestals: no columns of zeros for the others.
    rare = [kind for kind in ("axial", "pedestal") if any(mode["energy"][kind] > 0.0 for mode in shown)]
    shares_of = ("housing", "rotor", "torsion", *rare, "residual", "mesh")
    heads = ["teeth" if kind == "mesh" else kind for kind in shares_of]
    table = Table("frequency [Hz]", "damping ratio", "kind", *heads, box=SIMPLE_HEAD)
    for column in table.columns:
        column.justify = "right"
    for mode in shown:
        # A rigid mode is the free turning of the train: its shares say nothing of vibration.
        kinds = () if mode["kind"] == "rigid" else shares_of
        shares = [f"{100 * mode['energy'][kind]:z.0f} %" for kind in kinds]
        table.add_row(f"{mode['frequency_hz']:z.2f}", f"{mode['damping_ratio']:z.4f}", mode["kind"], *shares)
    console.print(table)
    console.print("Shares of the kinetic energy; teeth: share of the strain energy.")
    if any(mode["kind"] == "residual" for mode in shown):
        console.print("Residual: local compliance at the seats, no mode of the housing; its frequency means nothing.")
    if error := document.get("static_error"):
        console.print(static_error_line(error))
    if trusted and len(shown) < len(modes):
        console.print(f"{counted(len(modes) - len(shown), 'more mode')} above {2.0 * trusted:.5g} Hz.")
    show_origin(console, document)
    show_written(console, document)
