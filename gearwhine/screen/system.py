"""The coupled system on the terminal: modes, stability, crossings with the orders, transmissibility."""

from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from gearwhine.screen.console import counted, open_console, show_origin, show_written
from gearwhine.screen.health import static_error_line

_NAMES = {"components": "", "bearings": "", "gear_meshes": "teeth of "}
_CROSSINGS = 30  # shown at most, those nearest to operation
_WHIRL = 0.5  # from which a sense of whirl is named


def show_system(document: dict[str, Any]) -> None:
    """Coupled modes, up to twice the frequency below which the housing's modes are all there, and what follows."""
    console = open_console()
    modes, trusted = document["modes"], document.get("trusted_below_hz")
    shown = [mode for mode in modes if not trusted or mode["frequency_hz"] <= 2.0 * trusted]
    phase = document.get("mesh_phase")
    about = "" if phase is None else f", the first pair's teeth at {phase:g} of their period"
    console.print(f"{document['coordinates']} coordinates at {document['speed_rpm']:.0f} rpm{about}")
    for mesh in document.get("mesh_stiffness", ()):
        console.print(_mesh_stiffness(mesh))
    console.print(_modes_table(shown))
    console.print("Shares of the kinetic energy; teeth: share of the strain energy.")
    if any(mode["kind"] == "residual" for mode in shown):
        console.print("Residual: local compliance at the seats, no mode of the housing; its frequency means nothing.")
    if certificate := document.get("certificate"):
        console.print(
            f"{certificate['found']} of {certificate['expected']} eigenvalues found, {certificate['zeros']} of them "
            f"zero; residuals up to {certificate['max_residual']:.0e}, sum rule kept to {certificate['sum_rule']:.0e}."
        )
    if "stability" in document:
        _show_stability(console, document["stability"])
    if error := document.get("static_error"):
        console.print(static_error_line(error))
    if trusted and len(shown) < len(modes):
        console.print(f"{counted(len(modes) - len(shown), 'more mode')} above {2.0 * trusted:.5g} Hz.")
    for response in document.get("transmissibility", ()):
        _show_response(console, response)
    if campbell := document.get("campbell"):
        _show_crossings(console, campbell)
    show_origin(console, document)
    show_written(console, document)


def _mesh_stiffness(mesh: dict[str, Any]) -> str:
    """Which mesh stiffness the modes are about, and the mean without load beside it."""
    taken, unloaded = 1e-6 * mesh["stiffness_n_per_m"], 1e-6 * mesh["unloaded_mean_n_per_m"]
    under = f" of {mesh['force_n']:.5g} N" if mesh["force_n"] else ""
    beside = "" if mesh["taken"] == "mean without load" else f"; mean without load {unloaded:.4g} N/µm"
    return f"Mesh stiffness of {mesh['name']}: {taken:.4g} N/µm, {mesh['taken']}{under}{beside}."


def _modes_table(shown: list[dict[str, Any]]) -> Table:
    # Few machines have motions along the axis or pedestals: no columns of zeros for the others.
    rare = [kind for kind in ("axial", "pedestal") if any(mode["energy"][kind] > 0.0 for mode in shown)]
    shares_of = ("housing", "rotor", "torsion", *rare, "residual", "mesh")
    heads = ["teeth" if kind == "mesh" else kind for kind in shares_of]
    strained = any("strain_energy" in mode for mode in shown)
    table = Table("frequency [Hz]", "damping ratio", "kind", *heads, box=SIMPLE_HEAD)
    for column in table.columns:
        column.justify = "right"
    if strained:
        table.add_column("strained most")
    for mode in shown:
        # A rigid mode is the free turning of the train: its shares say nothing of vibration.
        kinds = () if mode["kind"] == "rigid" else shares_of
        shares = [f"{100 * mode['energy'][kind]:z.0f} %" for kind in kinds]
        held = [_strained(mode)] if strained and kinds else []
        table.add_row(f"{mode['frequency_hz']:z.2f}", f"{mode['damping_ratio']:z.4f}", _named(mode), *shares, *held)
    return table


def _named(mode: dict[str, Any]) -> str:
    """A mode's kind, its place, and the sense of its whirl about z."""
    kind, where = mode["kind"], mode.get("where")
    if not where or where == kind or kind in ("rigid", "mesh", "residual"):
        return str(kind)
    whirl = mode.get("whirl", {}).get(where, 0.0) if kind == "rotor" else 0.0
    sense = "" if abs(whirl) < _WHIRL else " ↺" if whirl > 0.0 else " ↻"
    return f"{kind}: {where}{sense}"


def _strained(mode: dict[str, Any]) -> str:
    """The part with the most strain energy."""
    parts = [(share, _NAMES[group] + name) for group, of in mode["strain_energy"].items() for name, share in of.items()]
    share, name = max(parts)
    return f"{name} {100 * share:.0f} %"


def _show_stability(console: Console, stability: dict[str, Any]) -> None:
    if stability["stable"]:
        least = stability["least_damped"]
        said = "Stable: no mode grows."
        if least is not None:
            said += f" Least damped: {least['damping_ratio']:.4f} at {least['frequency_hz']:.1f} Hz ({_named(least)})."
        console.print(said)
        return
    console.print(f"UNSTABLE: {counted(len(stability['growing']), 'mode')} grow from any disturbance.", style="bold")
    for one in stability["growing"]:
        fed = ", ".join(f"{feeder['name']} ({feeder['share']:.2g})" for feeder in one["fed_by"][:3])
        console.print(
            f"  {one['frequency_hz']:.2f} Hz ({_named(one)}), damping ratio {one['damping_ratio']:.2g}, "
            f"doubling in {one['doubling_time_s']:.3g} s; fed by {fed or 'nothing single'}"
        )


def _show_response(console: Console, response: dict[str, Any]) -> None:
    """Where the dynamic mesh force and the sensors answer most to a micrometre of error."""
    rows = [("mesh force [N/µm]", name, peaks) for name, peaks in response["mesh_force_n"].items()]
    rows += [("acceleration [m/s²/µm]", n, peaks) for n, peaks in response["sensor_acceleration_m_per_s2"].items()]
    table = Table("peak amplitude of", "at", "highest: Hz (by 1 µm)", box=SIMPLE_HEAD)
    for what, name, peaks in rows:
        highest = "  ".join(f"{peak['frequency_hz']:.0f} ({1e-6 * peak['amplitude']:.3g})" for peak in peaks[:4])
        table.add_row(what, name, highest)
    console.print(f"Response to the {response['excitation']}, 1 µm at any frequency:")
    console.print(table)


def _show_crossings(console: Console, campbell: dict[str, Any]) -> None:
    """Resonant speeds: mesh orders on all modes of the machine, shaft orders on those that bend shafts."""
    met = [
        one
        for one in campbell["crossings"]
        if one["kind"] == "rotor" or (one["kind"] != "residual" and _kind_of(campbell, one) == "mesh")
    ]
    nearest = sorted(met, key=lambda one: abs(one["margin"]))[:_CROSSINGS]
    speeds = campbell["speeds_rpm"]
    span = f"{min(map(abs, speeds)):.0f} to {max(map(abs, speeds)):.0f} rpm"
    if not met:
        console.print(f"No order of a shaft or mesh meets a mode that it excites from {span}.")
    else:
        table = Table("speed [rpm]", "from operation", "order", "frequency [Hz]", "damping ratio", "mode", "teeth")
        table.box = SIMPLE_HEAD
        for column in (0, 1, 3, 4, 6):
            table.columns[column].justify = "right"
        for one in sorted(nearest, key=lambda one: abs(one["speed_rpm"])):
            table.add_row(
                f"{abs(one['speed_rpm']):.1f}",
                f"{100 * one['margin']:+.1f} %",
                one["line"],
                f"{one['frequency_hz']:.2f}",
                f"{one['damping_ratio']:.4f}",
                _named(one),
                f"{100 * one['teeth']:.1f} %",
            )
        console.print(f"Resonant speeds from {span} (of the first driver), modes about the mean contact:")
        console.print(table)
    rest = len(campbell["crossings"]) - len(nearest)
    if rest:
        console.print(
            f"{counted(rest, 'more crossing')} in the JSON, further off or of orders that hardly excite the mode."
        )
    for sentence in campbell["unsettled"]:
        console.print(sentence)


def _kind_of(campbell: dict[str, Any], crossing: dict[str, Any]) -> str:
    return next(str(line["kind"]) for line in campbell["lines"] if line["name"] == crossing["line"])
