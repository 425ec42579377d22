"""What `gearwhine gears` says of each pair: its gears, how they meet, what they do under load, and what suits them."""

import math
from collections.abc import Sequence
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from gearwhine.screen.console import open_console, percent, show_written

_MM, _MICRO, _MEGA = 1e3, 1e6, 1e-6
_HARMONICS = 4  # of the transmission error, named
_WORTH_IT = 0.9  # a relief with less than this part of the given one's error is worth naming as better


def show_gears(document: dict[str, Any]) -> None:
    """Each gear pair: geometry, path of contact, stiffness, transmission error, load, and the best relief."""
    console = open_console()
    for pair in document["pairs"]:
        title = f"  mesh stiffness by the model {pair['model']!r}"
        console.print(Text.assemble((f"{pair['driver']} → {pair['driven']}", "bold"), title))
        _gears(console, pair)
        _path(console, pair)
        for line in (*_mesh(pair), *_load(pair), *_relief(pair)):
            console.print(f"  {line}")
    show_written(console, document)


def _gears(console: Console, pair: dict[str, Any]) -> None:
    """The proportions of both gears, and what a micrometer reads over some of their teeth."""
    first = pair["gears"][0]
    title = f"Gears: module {_MM * first['module_m']:.5g} mm, pressure angle {_degrees(first['pressure_angle_rad'])}"
    if helix := first["helix_angle_rad"]:
        title += f", helix angle {_degrees(abs(helix))}, the driver's {'right' if helix > 0.0 else 'left'}-hand"
    shifted = any(gear["profile_shift"] for gear in pair["gears"])
    head = ["[mm]", "teeth", *["shift [modules]"] * shifted, "face", "tip ⌀", "pitch ⌀", "base ⌀", "root ⌀"]
    head += ["tip width", "clearance", "span"]
    rows = []
    for gear in pair["gears"]:
        diameters, span = gear["diameters_m"], gear["span"]
        row = [gear["name"], str(gear["teeth"]), *[f"{gear['profile_shift']:.4g}"] * shifted]
        row.append("" if gear["face_width_m"] is None else f"{_MM * gear['face_width_m']:.5g}")
        row += [f"{_MM * diameters[name]:.3f}" for name in ("tip", "reference", "base", "root")]
        row += [f"{_MM * gear['normal_thickness_m']['tip']:.3f}", f"{_MM * gear['tip_clearance_m']:.3f}"]
        row.append("" if span is None else f"{_MM * span['length_m']:.3f} over {span['teeth']}")
        rows.append(row)
    _show(console, title, head, rows)


def _path(console: Console, pair: dict[str, Any]) -> None:
    """The named points of the path of contact on both gears."""
    rows = []
    for point in pair["path_of_contact"]:
        row = [point["point"]]
        for side in ("driver", "driven"):
            row.append(_degrees(point[f"{side}_roll_angle_rad"], ".2f"))
            row += [f"{2 * _MM * point[f'{side}_radius_m']:.3f}", _sliding(point[f"{side}_specific_sliding"])]
        rows.append(row)
    head = ["", *("driver: roll", "⌀ [mm]", "sliding"), *("driven: roll", "⌀ [mm]", "sliding")]
    _show(console, "Path of contact, with roll angles and specific sliding", head, rows)


def _degrees(angle: float, form: str = ".5g") -> str:
    return f"{math.degrees(angle):{form}}°"


def _sliding(value: float) -> str:
    """To two places; endless where a flank does not move along itself."""
    return f"{value:z.2f}" if math.isfinite(value) else "-∞"


def _mesh(pair: dict[str, Any]) -> list[str]:
    """How the two stand, how often they mesh, how stiff they are and how they err."""
    ratio = f"Contact ratio {pair['contact_ratio']:.5f}"
    if pair["overlap_ratio"]:
        ratio += f", with the overlap of {pair['overlap_ratio']:.4f} in all {pair['total_contact_ratio']:.4f}"
    ratio += f"; shafts {_MM * pair['centre_distance_m']:.4f} mm apart"
    ratio += f", working pressure angle {_degrees(pair['working_pressure_angle_rad'], '.6g')}"
    lines = [ratio]
    if pair["backlash_m"] is not None:
        lines[0] += f", backlash {_MM * pair['backlash_m']:.4g} mm"
    if pair["mesh_frequency_hz"] is not None:
        lines.append(f"Mesh frequency {pair['mesh_frequency_hz']:.2f} Hz")
        lines[-1] += f", torque on the driver {pair['torque_n_m']:.5g} N·m, mesh force {pair['mean_force_n']:.1f} N"
    stiffness, error = pair["stiffness_n_per_m"], pair["transmission_error_m"]
    lines.append(
        f"Mesh stiffness {_MEGA * stiffness['mean']:.2f} N/µm in the mean, {_MEGA * stiffness['min']:.2f} to "
        f"{_MEGA * stiffness['max']:.2f}"
    )
    if pair["mean_force_n"]:
        lines[-1] += f"; of the teeth that touch under the load {_MEGA * stiffness['loaded_mean']:.2f} in the mean"
    state = "Static transmission error" if pair["mean_force_n"] else "Transmission error without load"
    lines.append(f"{state} {_error(error)}")
    if error["over_hunting_period"]:
        lines[-1] += " in the first mesh period"
        lines.append(f"  over the hunting period: {_error(error['over_hunting_period'])}")
    if error["peak_to_peak"] > 0.0:
        named = ", ".join(f"{_MICRO * amplitude:.3f}" for amplitude in error["harmonics"][:_HARMONICS])
        lines.append(f"  at the mesh frequency and its multiples: {named} µm")
    return lines


def _error(error: dict[str, Any]) -> str:
    return f"{_MICRO * error['mean']:.3f} µm in the mean, {_MICRO * error['peak_to_peak']:.3f} µm peak to peak"


def _load(pair: dict[str, Any]) -> list[str]:
    """Who carries for how long, and how hard the flanks press."""
    lines = []
    if sharing := pair["load_sharing"]:
        parts = ", ".join(f"{count} for {percent(part)}" for count, part in sharing["pairs_in_contact"].items() if part)
        lines.append(
            f"Pairs of teeth that carry: {parts} of the time, {sharing['loaded_contact_ratio']:.4f} in the mean; "
            f"one carries {percent(sharing['largest_share'])} at most"
        )
        if sharing["corner_force_n"]:
            lines.append(f"Corners carry up to {sharing['corner_force_n']:.4g} N beyond the path of contact")
    if pressure := pair["contact_pressure_pa"]:
        where = _degrees(pressure["at_driver_roll_angle_rad"], ".2f")
        lines.append(f"Contact pressure {_MEGA * pressure['max']:.0f} MPa at most, at {where} roll of the driver")
        if pressure["pitch_point"] is not None:
            lines[-1] += f"; {_MEGA * pressure['pitch_point']:.0f} MPa at the pitch point"
    return lines


def _relief(pair: dict[str, Any]) -> list[str]:
    """What the given relief does, which torque it suits best, and what would suit the case's torque."""
    best = pair["optimal_tip_relief"]
    if best is None:
        return []
    without, given, least = (
        _MICRO * best[f"peak_to_peak_{which}"] for which in ("without_relief_m", "as_given_m", "m")
    )
    at = f"at {best['torque_n_m']:.4g} N·m"
    alike = ", all teeth alike" if pair["transmission_error_m"]["over_hunting_period"] else ""
    if any(gear["tip_relief"] for gear in pair["gears"]):
        lines = [
            f"The relief of {_given(pair)} leaves {given:.2f} µm peak to peak {at}{alike}, none {without:.2f} µm",
        ]
        # At the least of the torques, any pair is quiet.
        if (quietest := pair["harris_map"]["quietest_torque_n_m"]) > pair["harris_map"]["torque_n_m"][0]:
            lines.append(f"  it is quietest near {quietest:.3g} N·m")
    else:
        lines = [f"Without relief {given:.2f} µm peak to peak {at}{alike}"]
    aim = best["aim"]
    if best["length_m"] is None:
        return [*lines, f"No tip relief, the same on both gears, lowers the {_aim(aim)}: leave it out"]
    starts = [math.degrees(best[f"{side}_start_roll_angle_rad"]) for side in ("driver", "driven")]
    text = (
        f"{_MM * best['amount_m']:.4f} mm on both gears from {_alike(starts, '.2f', '°')} of roll, over "
        f"{_MM * best['length_m']:.2f} mm of the line of action: {least:.2f} µm"
    )
    if aim["kind"] != "peak-to-peak":
        lines.append(
            f"Aim, the {_aim(aim)}: {_value(aim, 'without_relief')} without relief, {_value(aim, 'best')} with the best"
        )
        return [*lines, f"Best {best['shape']} relief: {text} peak to peak"]
    close = least > _WORTH_IT * given
    return [*lines, f"Hardly better would be {text}" if close else f"Best {best['shape']} relief: {text}"]


def _aim(aim: dict[str, Any]) -> str:
    """What the relief is sought for."""
    if aim["kind"] == "peak-to-peak":
        return "peak-to-peak transmission error"
    if aim["kind"] == "sensor":
        return f"level at {aim['sensor']}, rms over the multiples of the mesh frequency"
    weights = ", ".join(f"{weight:.4g} at {n}" for n, weight in aim["weights"].items())
    return f"weighted harmonics of the mesh frequency ({weights})"


def _value(aim: dict[str, Any], key: str) -> str:
    return f"{aim[key]:.4g} m/s²" if aim["kind"] == "sensor" else f"{_MICRO * aim[key]:.3f} µm"


def _given(pair: dict[str, Any]) -> str:
    """The reliefs of both gears in short, such as ``0.023/0.025 mm from 24°``."""
    reliefs = [gear["tip_relief"] for gear in pair["gears"]]
    amounts = [_MM * relief["amount_m"] if relief else 0.0 for relief in reliefs]
    starts = [math.degrees(relief["start_roll_angle_rad"]) for relief in reliefs if relief]
    return f"{_alike(amounts, '.4g', ' mm')} from {_alike(starts, '.4g', '°')}"


def _alike(values: Sequence[float], form: str, unit: str) -> str:
    """Two figures with a stroke between, or one where they read the same."""
    shown = list(dict.fromkeys(f"{value:{form}}" for value in values))
    return "/".join(shown) + unit


def _show(console: Console, title: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    table = Table(*head, box=SIMPLE_HEAD, show_edge=False)
    for column in table.columns[1:]:
        column.justify = "right"
    for row in rows:
        table.add_row(*row)
    console.print(f"  {title}")
    console.print(Padding(table, (0, 0, 1, 2), expand=False))
