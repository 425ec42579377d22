"""What a person sees on the terminal."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from gearwhine.screen_health import show_detail, show_health, static_error_line

_WIDTH = 120
_PLANAR = 1e-3  # a whirl direction this near to zero is a line, neither forward nor backward


def show_run(document: dict[str, Any]) -> None:
    """The main job's outcome."""
    console = _console()
    console.print(document["title"], style="bold")
    if "housing" in document:
        _modes_line(console, document["housing"])
    if "compare" in document:
        _comparison(console, document["compare"])
    for pair in document.get("gear_pairs", ()):
        console.print(
            f"Gear mesh {pair['driver']} → {pair['driven']}: mean force {pair['mean_force_n']:.0f} N, "
            f"peak {pair['peak_force_n']:.0f} N, apart {_percent(pair['contact_loss_fraction'])} of the time"
        )
    if document.get("sensors"):
        _sensors(console, document)
    if "steps" in document:
        console.print(
            f"Transient: {document['steps']} steps, {document['steps_per_second']:.0f} a second; energy balance closes "
            f"to {document['energy_error']:.1e}; {document['coordinates']} modal coordinates"
        )
    elif "system" in document:
        console.print(f"Coupled system: {_count(len(document['system']['modes']), 'mode')}")
    _files(console, document)
    console.print(f"Time: {document['seconds']['total']:.1f} s")


def show_check(document: dict[str, Any]) -> None:
    """What the case means, a line for each part."""
    table = Table.grid(padding=(0, 2))
    table.add_column(style="bold")
    table.add_column()
    for part, text in _parts(document):
        table.add_row(part, text)
    console = _console()
    console.print(document["title"], style="bold")
    console.print(table)


def _parts(document: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """The parts of a case in words; a part's name stands on its first line only."""
    if "housing" in document:
        yield from _named("housing", _housing_lines(document["housing"]))
    yield from _named("rotors", [_rotor_line(rotor) for rotor in document.get("rotors", ())])
    bearings = [f"{one['name']}: {one['rotor']} on {one['seat']}" for one in document.get("bearings", ())]
    yield from _named("bearings", bearings)
    yield from _named("gear pairs", [line for pair in document.get("gear_pairs", ()) for line in _pair_lines(pair)])
    if "operation" in document:
        operation = document["operation"]
        lines = [f"{operation['speed_rpm']:.6g} rpm, {operation['torque_n_m']:.6g} N·m"]
        for torque in operation["torques"]:
            place = "" if torque["at_m"] is None else f" at {1e3 * torque['at_m']:.4g} mm"
            lines.append(f"torque on {torque['rotor']}{place}: {torque['torque_n_m']:+.6g} N·m about z")
        yield from _named("operation", lines)
    if "transient" in document:
        given = document["transient"]
        recorded, all_of_them = given["recorded_revolutions"], given["revolutions"]
        yield (
            "transient",
            f"{all_of_them:g} revolutions, the last {recorded:g} recorded; tolerance {given['tolerance']:g}",
        )
    if "sweep" in document:
        yield "sweep", _count(document["sweep"]["speeds"], "speed")
    if "measured" in document:
        yield "measured", ", ".join(f"{one:g}" for one in document["measured"]["frequencies_hz"]) + " Hz"
    yield from _named("standing", [f"{key}: {text}" for key, text in document.get("provenance", {}).items()])


def _named(part: str, lines: Sequence[str]) -> Iterator[tuple[str, str]]:
    for number, line in enumerate(lines):
        yield ("" if number else part), line


def _housing_lines(housing: dict[str, Any]) -> list[str]:
    shape = housing["geometry"]
    if "size_m" in housing:
        shape += f" of {' x '.join(f'{1e3 * length:.6g}' for length in housing['size_m'])} mm"
    if "mesh_size_m" in housing:
        shape += f", elements of {1e3 * housing['mesh_size_m']:g} mm"
    if "mesh" in housing:
        shape += f", {housing['mesh']['nodes']} nodes, {_kinds(housing['kinds'])}"
    limit, count = housing["frequency_limit_hz"], housing["modes"]
    wanted = f"all modes below {limit:g} Hz" if limit else f"the lowest {count or 20} modes"
    lines = [f"{shape}, {housing['material']}; {wanted}"]
    lines += [f"{kind}: {', '.join(housing[kind])}" for kind in ("regions", "seats", "supports") if housing[kind]]
    for kind in ("mounts", "joints"):
        lines += [_bushing_line(kind[:-1], one) for one in housing[kind]]
    if housing.get("cover_bolts"):
        first, *others = housing["cover_bolts"]
        lines.append(_bushing_line("cover", first) + (f"; so {_count(len(others), 'more bolt')}" if others else ""))
    lines += [_bore_line(bore) for bore in housing.get("bores", ())]
    if housing["masses"]:
        lines.append("masses: " + ", ".join(f"{one['name']} {one['mass_kg']:g} kg" for one in housing["masses"]))
    return lines + ([f"sensors: {', '.join(housing['sensors'])}"] if housing["sensors"] else [])


def _bushing_line(kind: str, bushing: dict[str, Any]) -> str:
    between = f" ({' to '.join(bushing['surfaces'])})" if "surfaces" in bushing else ""
    parts = [
        f"{motion} {amount:.4g} {unit}"
        for key, unit in (
            ("stiffness_n_per_m", "N/m"),
            ("stiffness_n_m_per_rad", "N·m/rad"),
            ("damping_n_s_per_m", "N·s/m"),
            ("damping_n_m_s_per_rad", "N·m·s/rad"),
        )
        for motion, amount in bushing.get(key, {}).items()
    ]
    return f"{kind} {bushing['name']}{between}: {', '.join(parts)}"


def _bore_line(bore: dict[str, Any]) -> str:
    place = ", ".join(f"{1e3 * value + 0.0:.5g}" for value in bore["center_m"])
    return f"bore of {1e3 * bore['diameter_m']:.5g} mm at ({place}) mm, {1e3 * bore['length_m']:.4g} mm long"


def _rotor_line(rotor: dict[str, Any]) -> str:
    speed = "" if rotor["speed_rpm"] is None else f", {rotor['speed_rpm']:+.6g} rpm"
    return f"{rotor['name']}: {1e3 * rotor['length_m']:g} mm, {rotor['mass_kg']:.4g} kg, {rotor['mass_model']}{speed}"


def _pair_lines(pair: dict[str, Any]) -> list[str]:
    lines = [
        f"{pair['driver']} → {pair['driven']}: ratio {pair['ratio']:.6g}, contact ratio {pair['contact_ratio']:.5f}, "
        f"stiffness {pair['stiffness_model']}",
        f"shafts {1e3 * pair['centre_distance_m']:.6g} mm apart, working pressure angle "
        f"{pair['working_pressure_angle_deg']:.4g}°",
    ]
    if pair["mesh_frequency_hz"] is not None:
        lines.append(f"mesh frequency {pair['mesh_frequency_hz']:.2f} Hz, mean mesh force {pair['mean_force_n']:.1f} N")
    return lines


def show_mesh(document: dict[str, Any]) -> None:
    """The mesh's size and quality."""
    console = _console()
    mesh, edge, shape = document["mesh"], document["edge_length_m"], document["shape_number"]
    console.print(f"{mesh['nodes']} nodes, {_kinds(document['kinds'])}")
    console.print(f"Volume {document['volume_m3']:.6g} m³; median edge {1e3 * edge['median']:.3g} mm")
    console.print(f"Shape number (1 is ideal): median {shape['median']:.2f}, smallest {shape['min']:.2f}")
    console.print(f"Surfaces: {', '.join(document['surfaces']) or 'none named'}")
    console.print(f"Volumes: {', '.join(document['volumes']) or 'none named'}")
    for bore in document["bores"]:
        console.print(_bore_line(bore).capitalize())
    _files(console, document)


def _kinds(kinds: dict[str, int]) -> str:
    """How many elements of which kind, in words."""
    words = {
        "tetra": "tetrahedra of 4 nodes",
        "tetra10": "tetrahedra of 10 nodes",
        "hexahedron": "bricks of 8 nodes",
        "hexahedron20": "bricks of 20 nodes",
        "hexahedron27": "bricks of 27 nodes",
        "wedge": "wedges of 6 nodes",
        "wedge15": "wedges of 15 nodes",
    }
    return " and ".join(f"{count} {words[kind]}" for kind, count in kinds.items())


def show_modes(document: dict[str, Any]) -> None:
    """Housing modes and their certificate."""
    console = _console()
    table = Table("mode", "frequency [Hz]", "damping", "strength [1/kg]", box=SIMPLE_HEAD)
    for column in table.columns:
        column.justify = "right"
    for mode in document["modes"]:
        strength = "" if mode["strength"] is None else f"{mode['strength']:.3e}"
        table.add_row(str(mode["number"]), f"{mode['frequency_hz']:.2f}", f"{mode['damping_ratio']:.4g}", strength)
    console.print(table)
    _modes_line(console, document)
    show_health(console, document)
    _files(console, document)


def show_modes_in_detail(document: dict[str, Any]) -> None:
    """The same, with effective masses, supports and the modes that matter between bearings and sensors."""
    show_modes(document)
    show_detail(_console(), document)


def show_rotors(document: dict[str, Any]) -> None:
    """Each rotor's frequencies."""
    console = _console()
    for rotor in document["rotors"]:
        console.print(Text.assemble((rotor["name"], "bold"), f"  {rotor['mass_kg']:.3f} kg"))
        rows = [("lateral at rest [Hz]", rotor["lateral_hz"]), ("torsional [Hz]", rotor["torsional_hz"])]
        rows += [(f"whirl at {whirl['speed_rpm']:.0f} rpm [Hz]", whirl["frequency_hz"]) for whirl in rotor["whirl"]]
        for name, values in rows:
            console.print(f"  {name:26s} {'  '.join(f'{value:.5g}' for value in values[:10])}")
        console.print(_critical_speeds(rotor))
        console.print(f"  {_rotor_proof(rotor['certificate'])}")
    _files(console, document)


def _rotor_proof(certificate: dict[str, Any]) -> str:
    if certificate["expected"] is None:
        return "no count: the bearings' stiffness couples the planes"
    found, counted = certificate["found"], certificate["expected"]
    return f"complete below {certificate['limit_hz']:.5g} Hz: {found} found, {counted} counted"


def _critical_speeds(rotor: dict[str, Any]) -> str:
    """Critical speeds on one line; those of backward whirl carry a mark, since unbalance hardly excites them."""
    speeds = rotor["critical_speeds_rpm"][:10]
    directions = rotor.get("critical_directions") or [0.0] * len(speeds)
    backward = [direction < -_PLANAR for direction in directions[: len(speeds)]]
    marked = [f"{speed:.5g}{' (b)' if back else ''}" for speed, back in zip(speeds, backward, strict=True)]
    note = "   (b): backward whirl" if any(backward) else ""
    return f"  {'critical speeds [rpm]':26s} {'  '.join(marked)}{note}"


def show_gears(document: dict[str, Any]) -> None:
    """Each gear pair's figures."""
    console = _console()
    for pair in document["pairs"]:
        stiffness, error = pair["stiffness_n_per_m"], pair["transmission_error_m"]
        console.print(Text.assemble((f"{pair['driver']} → {pair['driven']}", "bold"), f"  {pair['model']}"))
        console.print(f"  contact ratio {pair['contact_ratio']:.5f}")
        if pair["mesh_frequency_hz"] is not None:
            console.print(
                f"  mesh frequency {pair['mesh_frequency_hz']:.2f} Hz, mesh force {pair['mean_force_n']:.1f} N"
            )
        console.print(
            f"  mesh stiffness {1e-6 * stiffness['mean']:.2f} N/µm in the mean, {1e-6 * stiffness['min']:.2f} to "
            f"{1e-6 * stiffness['max']:.2f}"
        )
        console.print(f"  static transmission error {_error(error)}")
        if error.get("over_hunting_period"):
            console.print(f"    over the hunting period: {_error(error['over_hunting_period'])}")
    _files(console, document)


def _error(error: dict[str, Any]) -> str:
    return f"{1e6 * error['mean']:.3f} µm in the mean, {1e6 * error['peak_to_peak']:.3f} µm peak to peak"


def show_system(document: dict[str, Any]) -> None:
    """Coupled modes, up to twice the frequency below which the housing's modes are all there."""
    console = _console()
    modes, trusted = document["modes"], document.get("trusted_below_hz")
    shown = [mode for mode in modes if not trusted or mode["frequency_hz"] <= 2.0 * trusted]
    console.print(f"{document['coordinates']} coordinates at {document['speed_rpm']:.0f} rpm")
    shares_of = ("housing", "rotor", "torsion", "residual", "teeth")
    table = Table("frequency [Hz]", "damping ratio", "kind", *shares_of, box=SIMPLE_HEAD)
    for column in table.columns:
        column.justify = "right"
    for mode in shown:
        # A rigid mode is the free turning of the train: its shares say nothing of vibration.
        kinds = () if mode["kind"] == "rigid" else ("housing", "rotor", "torsion", "residual", "mesh")
        shares = [f"{100 * mode['energy'][kind]:z.0f} %" for kind in kinds]
        table.add_row(f"{mode['frequency_hz']:z.2f}", f"{mode['damping_ratio']:z.4f}", mode["kind"], *shares)
    console.print(table)
    console.print("Shares of the kinetic energy; teeth: share of the strain energy.")
    if any(mode["kind"] == "residual" for mode in shown):
        console.print("Residual: local compliance at the seats, no mode of the housing; its frequency means nothing.")
    if error := document.get("static_error"):
        console.print(static_error_line(error))
    if trusted and len(shown) < len(modes):
        console.print(f"{_count(len(modes) - len(shown), 'more mode')} above {2.0 * trusted:.5g} Hz.")
    _origin(console, document)
    _files(console, document)


def show_comparison(document: dict[str, Any]) -> None:
    """Measured beside model modes."""
    console = _console()
    _comparison(console, document)
    _origin(console, document)
    _files(console, document)


def show_examples(document: dict[str, Any]) -> None:
    """The bundled cases."""
    console = _console()
    table = Table("name", "what it is", box=SIMPLE_HEAD)
    for example in document["examples"]:
        table.add_row(example["name"], example["title"])
    console.print(table)
    console.print("Run one:   gearwhine run NAME\nChange one: gearwhine examples copy NAME")


def show_files(document: dict[str, Any]) -> None:
    """What was written."""
    console = _console()
    _origin(console, document)
    _files(console, document)


def _comparison(console: Console, document: dict[str, Any]) -> None:
    table = Table("mode", "measured [Hz]", "model [Hz]", "error", "strength [1/kg]", box=SIMPLE_HEAD)
    for column in table.columns:
        column.justify = "right"
    for pair in document["pairs"]:
        table.add_row(
            str(pair["mode"]),
            f"{pair['measured_hz']:.0f}",
            f"{pair['model_hz']:.1f}",
            f"{pair['error_percent']:+.2f} %",
            f"{pair['strength']:.2e}",
        )
    console.print(table)
    count = document["model_modes"]
    agree = "agree" if document["measures_agree"] else "do not all agree"
    gap = document["gap"]
    distance = "no other mode in the band"
    if gap is not None and math.isfinite(gap):
        distance = f"ln {gap:.3f} (below 0.1 the choice is a coin toss)"
    console.print(
        f"Paired by {document['pairing']}: largest error {document['max_error_percent']:.2f} %, "
        f"rms {document['rms_error_percent']:.2f} %; "
        f"{_count(count['count'], 'model mode')} below {count['below_hz']:.0f} Hz."
    )
    console.print(
        f"Gap between the last chosen mode and the next: {distance}; the three measures of dominance {agree}."
    )
    console.print(
        "Such a match is weak evidence where the model was calibrated to these frequencies: see the case's notes."
    )


def _sensors(console: Console, document: dict[str, Any]) -> None:
    table = Table("sensor", "rms [m/s²]", "highest lines: Hz (m/s², peak)", box=SIMPLE_HEAD)
    table.columns[1].justify = "right"
    for sensor in document["sensors"]:
        lines = "  ".join(
            f"{peak['frequency_hz']:.0f} ({peak['amplitude_m_per_s2']:.2g})" for peak in sensor["peaks"][:5]
        )
        table.add_row(sensor["name"], f"{sensor['rms_m_per_s2']:.3g}", lines)
    console.print(table)


def _modes_line(console: Console, document: dict[str, Any]) -> None:
    certificate, mesh = document["certificate"], document["mesh"]
    console.print(
        f"Housing: {_count(certificate['found'], 'mode')} below {certificate['limit_hz']:.5g} Hz, the inertia demands "
        f"{certificate['expected']}; largest residual {certificate['max_residual']:.0e}; {document['mass_kg']:.2f} kg, "
        f"{mesh['dofs']} degrees of freedom, {document['seconds']['total']:.1f} s"
    )
    _origin(console, document)


def _origin(console: Console, document: dict[str, Any]) -> None:
    if document.get("reused"):
        console.print(f"Modes read from {document['modes_read_from']} (unchanged housing)")


def _files(console: Console, document: dict[str, Any]) -> None:
    read = document["modes_read_from"].rpartition("/")[2] if document.get("reused") else None
    written = [name for name in document.get("files", ()) if name != read]
    if written:
        console.print(f"Written to {document['folder']}: {', '.join(written)}")


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _percent(part: float) -> str:
    return "less than 0.01 %" if 0.0 < part < 1e-4 else f"{100 * part:.3g} %"


def _console() -> Console:
    # Without markup a bracket is a bracket: units and the names in a case are printed as they stand.
    console = Console(highlight=False, markup=False, emoji=False)
    if console.is_terminal:
        return console
    # Where there is no terminal, lines are not cut at the 80 columns that rich then assumes.
    return Console(highlight=False, markup=False, emoji=False, width=_WIDTH, soft_wrap=True)
