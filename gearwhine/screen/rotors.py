"""What `gearwhine rotors` says of each rotor: what it does at rest and at speed, and how far from trouble it runs."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from gearwhine.screen.console import counted, open_console, show_written

_MOST = 12  # rows of a table
_MAP_ROWS = 5  # of the critical-speed map
_REACH = 2.0  # critical speeds beyond so many times the speed of operation are only counted
_MOSTLY_AXIAL, _PARTLY_AXIAL = 0.9, 0.05  # parts of the kinetic energy: of a motion called axial, and worth a word
_PLANAR = 1e-3  # a whirl direction this near to zero is a line, neither forward nor backward
_NEUTRAL = 1e-9  # a damping ratio this near to zero neither grows nor decays
_ROUNDING = 1e-9  # a torque that is no more than this part of the largest is none
_SAME = 1e-9  # two frequencies nearer than this part of them are one that both planes have


def show_rotors(document: dict[str, Any]) -> None:
    """Each rotor: what it does at rest and at speed, its critical speeds, and what proves the list complete."""
    console = open_console()
    for rotor in document["rotors"]:
        title = f"  {rotor['mass_kg']:.5g} kg, {1e3 * rotor['length_m']:.5g} mm long"
        console.print(Text.assemble((rotor["name"], "bold"), title))
        _at_rest(console, rotor)
        _whirl(console, rotor)
        _critical_speeds(console, rotor)
        if rotor["rolling_bearings"]:
            _rolling(console, rotor["rolling_bearings"])
        _weight(console, rotor["static"])
        if rotor["unbalance_response"] is not None:
            _response(console, rotor["unbalance_response"])
        if rotor["torsional_response"] is not None:
            _torsion_response(console, rotor["torsional_response"])
        if rotor["stiffness_map"] is not None:
            _stiffness_map(console, rotor["stiffness_map"])
        if rotor["campbell"]:
            console.print(f"  {_stability(rotor['campbell'])}")
        console.print(f"  {_proof(rotor['certificate'])}")
    show_written(console, document)


def _at_rest(console: Console, rotor: dict[str, Any]) -> None:
    """Frequencies at rest with their kind, ascending as far as bending and torsion are both listed."""
    bending, torsion = (
        list(_bending(rotor["lateral_hz"], rotor["lateral_axial_share"])),
        list(_torsion(rotor["torsional_hz"])),
    )
    axial = [(frequency, "axial") for frequency in rotor["axial_hz"]]
    known = min(rows[-1][0] for rows in (bending, torsion) if rows) if bending or torsion else 0.0
    rows = [row for row in sorted([*bending, *torsion, *axial], key=lambda row: row[0]) if row[0] <= known]
    title = f"At rest{_with_bearings_at(rotor['rest_bearings_at_rpm'])}"
    _show(console, title, ("frequency [Hz]", "kind"), [(f"{f:.5g}", kind) for f, kind in rows[:_MOST]])


def _with_bearings_at(speed: float | None) -> str:
    """Which of their tables' speeds bearings are taken at; None: they have no tables."""
    return "" if speed is None else f", with the bearings' coefficients at {speed:.6g} rpm"


def _bending(frequencies: Sequence[float], axial_shares: Sequence[float]) -> Iterator[tuple[float, str]]:
    place = 0
    while place < len(frequencies):
        frequency = frequencies[place]
        double = place + 1 < len(frequencies) and frequencies[place + 1] - frequency <= _SAME * frequencies[place + 1]
        kind = "bending" if frequency > 0.0 else "moves freely"
        planes = "both planes" if double else "one plane"
        yield frequency, f"{kind}, {planes}{_with_axial(axial_shares[place])}"
        place += 2 if double else 1


def _torsion(frequencies: Sequence[float]) -> Iterator[tuple[float, str]]:
    for frequency in frequencies:
        yield frequency, "torsion" if frequency > 0.0 else "turns freely"


def _whirl(console: Console, rotor: dict[str, Any]) -> None:
    """Whirl at operation, which comes first; without operation, at the last speed of the sweep."""
    if not rotor["whirl"]:
        return
    whirl = rotor["whirl"][0 if rotor["operation_rpm"] is not None else -1]
    rows = []
    keys = ("frequency_hz", "direction", "axial_share", "log_decrement", "damping_ratio")
    columns = zip(*(whirl[key] for key in keys), _strained_most(rotor["bearings"], whirl["strain_energy"]), strict=True)
    for frequency, direction, along, decrement, damping, strained in columns:
        turning = math.copysign(1.0, whirl["speed_rpm"]) * direction
        state = "GROWS" if damping < -_NEUTRAL else "undamped" if damping <= _NEUTRAL else "decays"
        rows.append(
            (
                f"{frequency:.5g}",
                _whirl_name(turning, along),
                "0" if state == "undamped" else f"{decrement:.3g}",
                state,
                strained,
            )
        )
    head = ("frequency [Hz]", "whirl", "log decrement", "", "most strain energy")
    _show(console, f"Turning at {whirl['speed_rpm']:.6g} rpm", head, rows[:_MOST])


def _strained_most(bearings: Sequence[str], shares: dict[str, Any]) -> Iterator[str]:
    """For each mode the part with the largest share of its strain energy; nothing for one that strains nothing."""
    names = {
        "segments": [f"segment {number}" for number in range(1, len((shares["segments"] or [[]])[0]) + 1)],
        "bearings": list(bearings),
        "pedestals": [f"pedestal of {name}" for name in bearings],
    }
    for mode in range(len(shares["segments"])):
        parts = [part for kind, rows in shares.items() for part in zip(rows[mode], names[kind], strict=True)]
        share, name = max(parts)
        yield f"{100.0 * share:.0f} % {name}" if share > 0.0 else ""


def _critical_speeds(console: Console, rotor: dict[str, Any]) -> None:
    """Critical speeds: where the Campbell diagram has them, damped; without a diagram, undamped."""
    campbell = rotor["campbell"]
    if campbell is not None and campbell["critical_speeds"] is not None:
        _crossings(console, rotor, campbell)
    else:
        _undamped(console, rotor)
        if campbell is not None:
            console.print(f"  No damped critical speeds: {campbell['why_no_critical_speeds']}")
    if campbell is not None and campbell["orders"]:
        _orders(console, campbell)


def _orders(console: Console, campbell: dict[str, Any]) -> None:
    """Where whirl has another multiple of the speed of rotation for its frequency."""
    turning = -1.0 if min(campbell["speed_rpm"]) < 0.0 else 1.0
    rows = []
    for one in campbell["orders"]:
        order = f"{one['order']:g}×"
        if one["critical_speeds"] is None:
            rows.append((order, one["why_no_critical_speeds"], ""))
        rows += [
            (order, f"{abs(each['speed_rpm']):.5g}", _whirl_name(turning * each["direction"], each["axial_share"]))
            for each in one["critical_speeds"] or ()
        ]
    if rows:
        _show(console, f"Other orders from {_span(campbell)}", ("order", "speed [rpm]", "whirl"), rows[: 2 * _MOST])
    else:
        console.print(f"  None of the other orders meets a whirl frequency from {_span(campbell)}")


def _crossings(console: Console, rotor: dict[str, Any], campbell: dict[str, Any]) -> None:
    """Damped critical speeds, which way they whirl, how fast that decays, and how far they are from operation."""
    turning = -1.0 if min(campbell["speed_rpm"]) < 0.0 else 1.0
    title = f"Critical speeds from {_span(campbell)}"
    head, rows = ("speed [rpm]", "whirl", "log decrement", "from operation"), []
    excited = []
    for one in campbell["critical_speeds"]:
        speed, way, margin = abs(one["speed_rpm"]), turning * one["direction"], one["margin"]
        decrement = f"{one['log_decrement']:.3g}" if abs(one["log_decrement"]) > _NEUTRAL else "0"
        whirl = _whirl_name(way, one["axial_share"])
        rows.append((f"{speed:.5g}", whirl, decrement, "" if margin is None else _beside(margin)))
        if margin is not None and way >= -1.0 + _PLANAR:  # circular backward whirl takes no work from unbalance
            excited.append((abs(margin), speed, margin))
    if rows:
        _show(console, title, head if rotor["operation_rpm"] is not None else head[:3], rows[:_MOST])
    else:
        lowest = (
            f"; undamped, the lowest is {rotor['critical_speeds_rpm'][0]:.5g} rpm"
            if rotor["critical_speeds_rpm"]
            else ""
        )
        console.print(f"  No critical speed from {_span(campbell)}{lowest}")
    if excited:
        _nearest(console, excited)


def _undamped(console: Console, rotor: dict[str, Any]) -> None:
    """Undamped critical speeds, which way they whirl, and how far they are from the speed of operation."""
    speeds, directions, margins = (rotor[f"critical_{key}"] for key in ("speeds_rpm", "directions", "margins"))
    names = [_whirl_name(*one) for one in zip(directions, rotor["critical_axial_share"], strict=True)]
    title = "Undamped critical speeds"
    if margins is None:
        listed = [(f"{speed:.5g}", name) for speed, name in zip(speeds, names, strict=True)]
        _show(console, title, ("speed [rpm]", "whirl"), listed[:_MOST])
        return
    reach = sum(margin <= _REACH - 1.0 for margin in margins) + 1  # and the first beyond
    rows = [
        (f"{speed:.5g}", name, _beside(margin))
        for speed, name, margin in list(zip(speeds, names, margins, strict=True))[: min(reach, _MOST)]
    ]
    _show(console, title, ("speed [rpm]", "whirl", "from operation"), rows)
    excited = [
        (abs(margin), speed, margin)
        for speed, way, margin in zip(speeds, directions, margins, strict=True)
        if way >= -1.0 + _PLANAR  # circular backward whirl takes no work from unbalance
    ]
    if excited:
        _nearest(console, excited)


def _nearest(console: Console, excited: Sequence[tuple[float, float, float]]) -> None:
    """The critical speed nearest to operation of some, each with its distance, speed and margin."""
    _, speed, margin = min(excited)
    console.print(f"  Of those that unbalance excites, {speed:.5g} rpm is nearest: {_beside(margin)} operation")


def _rolling(console: Console, bearings: Sequence[dict[str, Any]]) -> None:
    """How stiff each rolling bearing is under its load, how many of its elements carry that, and how hard."""
    rows = [
        (
            bearing["name"],
            ", ".join(f"{load:z.5g}" for load in bearing["load_n"]),
            f"{bearing['loaded_elements']} of {bearing['elements']}",
            f"{1e-9 * bearing['peak_pressure_pa']:.3g}",
            ", ".join(f"{bearing['stiffness'][motion][motion]:.3g}" for motion in range(3)),
        )
        for bearing in bearings
    ]
    head = ("bearing", "x, y, z [N]", "loaded", "peak [GPa]", "stiffness [N/m]")
    _show(console, "Rolling bearings under their loads", head, rows)


def _weight(console: Console, static: dict[str, Any]) -> None:
    """What the bearings carry of the rotor's weight, and how far it sags."""
    if static["bearings"] is None:
        console.print(f"  No static deflection: {static['why_not']}")
        return
    rows = [(bearing["name"], *(f"{load:z.5g}" for load in bearing["load_n"][:2])) for bearing in static["bearings"]]
    title = f"Under its weight{_with_bearings_at(static['bearings_at_rpm'])}"
    _show(console, title, ("bearing carries", "x [N]", "y [N]"), rows)
    sag, place = 1e6 * static["largest_deflection_m"], 1e3 * static["largest_deflection_at_m"]
    console.print(f"  It sags most at {place:.5g} mm, by {sag:.3g} µm")


def _response(console: Console, response: dict[str, Any]) -> None:
    """What each probe reads of unbalance and bow, at operation and at its largest."""
    rows = []
    for probe in response["probes"][:_MOST]:
        at_operation = ("", "")
        if probe["operation_amplitude_m"] is not None:
            at_operation = (
                f"{1e6 * probe['operation_amplitude_m']:.3g}",
                f"{probe['operation_phase_lag_deg']:.0f}°",
            )
        largest = f"{1e6 * probe['largest_amplitude_m']:.3g} at {probe['largest_at_rpm']:.5g} rpm"
        place = f"{probe['name']}, {1e3 * probe['at_m']:.5g} mm, {probe['angle_deg']:.0f}°"
        rows.append((place, *at_operation, largest))
    _show(
        console,
        "Response to unbalance and bow",
        ("probe", "at operation [µm, peak]", "lag", "largest [µm, peak]"),
        rows,
    )


def _torsion_response(console: Console, response: dict[str, Any]) -> None:
    """The largest angle and torque at each probe, and the largest torque of the whole shaft."""
    nothing = _ROUNDING * response["largest_torque_n_m"]
    rows = [
        (
            f"{probe['name']}, {1e3 * probe['at_m']:.5g} mm",
            f"{1e3 * probe['largest_angle_rad']:.3g} at {probe['largest_angle_at_hz']:.5g} Hz",
            f"{probe['largest_torque_n_m']:.4g} at {probe['largest_torque_at_hz']:.5g} Hz"
            if probe["largest_torque_n_m"] > nothing
            else "0",
        )
        for probe in response["probes"][:_MOST]
    ]
    low, high = response["frequency_hz"][0], response["frequency_hz"][-1]
    title = f"Response to torques from {low:.5g} to {high:.5g} Hz"
    _show(console, title, ("probe", "largest angle [mrad, peak]", "largest torque [N m, peak]"), rows)
    console.print(
        f"  The shaft carries most at {1e3 * response['largest_torque_at_m']:.5g} mm: "
        f"{response['largest_torque_n_m']:.4g} N m at {response['largest_torque_at_hz']:.5g} Hz"
    )


def _stiffness_map(console: Console, given: dict[str, Any]) -> None:
    """Critical speeds from the softest to the stiffest bearings; the rest is in the files."""
    whirl = "forward" if "forward_critical_speeds_rpm" in given else "backward"
    stiffnesses, speeds = given["stiffness_n_per_m"], given[f"{whirl}_critical_speeds_rpm"]
    chosen = sorted({round(part * (len(stiffnesses) - 1) / (_MAP_ROWS - 1)) for part in range(_MAP_ROWS)})
    rows = [
        (f"{stiffnesses[row]:.3g}", "  ".join(f"{speed:.5g}" for speed in speeds[row] if math.isfinite(speed)))
        for row in chosen
    ]
    _show(console, "Over the stiffness of all bearings", ("stiffness [N/m]", f"{whirl} critical speeds [rpm]"), rows)


def _beside(margin: float) -> str:
    """How far a critical speed is from operation, which it exceeds by ``margin`` times operation."""
    if margin > _REACH - 1.0:
        return f"{1.0 + margin:.3g} times"
    return f"{100.0 * abs(margin):.3g} % {'above' if margin > 0.0 else 'below'}"


def _whirl_name(direction: float, axial_share: float) -> str:
    if axial_share > _MOSTLY_AXIAL:
        return "along the axis"
    way = "in a plane" if abs(direction) <= _PLANAR else "forward" if direction > 0.0 else "backward"
    return way + _with_axial(axial_share)


def _with_axial(share: float) -> str:
    """How much of a lateral motion is along the axis, where it is worth a word."""
    return f", {100.0 * share:.0f} % along the axis" if share >= _PARTLY_AXIAL else ""


def _stability(campbell: dict[str, Any]) -> str:
    """Up to which speed no mode grows."""
    span = f"{counted(len(campbell['speed_rpm']), 'speed')} from {_span(campbell)}"
    onset = campbell["unstable_from_rpm"]
    return f"Stable at {span}" if onset is None else f"UNSTABLE from {onset:.6g} rpm on, of {span}"


def _span(campbell: dict[str, Any]) -> str:
    speeds = [abs(speed) for speed in campbell["speed_rpm"]]
    return f"{min(speeds):.6g} to {max(speeds):.6g} rpm"


def _proof(certificate: dict[str, Any]) -> str:
    found, expected = certificate["found"], certificate["expected"]
    return f"Bending at rest complete below {certificate['limit_hz']:.5g} Hz: {found} found, {expected} counted"


def _show(console: Console, title: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    table = Table(*head, box=SIMPLE_HEAD, show_edge=False)
    table.columns[0].justify = "right" if "[" in head[0] else "left"  # numbers have a unit
    for row in rows:
        table.add_row(*row)
    console.print(f"  {title}")
    console.print(Padding(table, (0, 0, 1, 2), expand=False))
