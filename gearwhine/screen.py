"""What a person sees on the terminal."""

from collections.abc import Iterator, Sequence
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

_WIDTH = 100


def show_run(document: dict[str, Any]) -> None:
    """The main job's outcome."""
    console = _console()
    console.print(f"[bold]{escape(document['title'])}[/bold]")
    if "housing" in document:
        _modes_line(console, document["housing"])
    if "compare" in document:
        _comparison(console, document["compare"])
    for pair in document.get("gear_pairs", ()):
        console.print(
            f"Gear mesh {escape(pair['driver'])} → {escape(pair['driven'])}: mean force {pair['mean_force_n']:.0f} N, "
            f"peak {pair['peak_force_n']:.0f} N, apart {100 * pair['contact_loss_fraction']:.2g} % of the time"
        )
    if document.get("sensors"):
        _sensors(console, document)
    if "steps" in document:
        console.print(
            f"Transient: {document['steps']} steps, {document['steps_per_second']:.0f} a second; energy balance closes "
            f"to {document['energy_error']:.1e}; {document['coordinates']} modal coordinates"
        )
    elif "system" in document:
        console.print(f"Coupled system: {len(document['system']['modes'])} modes")
    _files(console, document)
    console.print(f"Time: {document['seconds']['total']:.1f} s")


def show_check(document: dict[str, Any]) -> None:
    """What the case means, a line for each part."""
    table = Table.grid(padding=(0, 2))
    for part, text in _parts(document):
        table.add_row(f"[bold]{part}[/bold]", escape(text))
    console = _console()
    console.print(f"[bold]{escape(document['title'])}[/bold]")
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
        yield "sweep", f"{document['sweep']['speeds']} speeds"
    if "measured" in document:
        yield "measured", ", ".join(f"{one:g}" for one in document["measured"]["frequencies_hz"]) + " Hz"
    yield from _named("standing", [f"{key}: {text}" for key, text in document.get("provenance", {}).items()])


def _named(part: str, lines: Sequence[str]) -> Iterator[tuple[str, str]]:
    for number, line in enumerate(lines):
        yield ("" if number else part), line


def _housing_lines(housing: dict[str, Any]) -> list[str]:
    shape = housing["geometry"]
    if "size_m" in housing:
        size = " x ".join(f"{1e3 * length:g}" for length in housing["size_m"])
        shape += f" of {size} mm, elements of {1e3 * housing['mesh_size_m']:g} mm"
    limit, count = housing["frequency_limit_hz"], housing["modes"]
    wanted = f"all modes below {limit:g} Hz" if limit else f"the lowest {count or 20} modes"
    lines = [f"{shape}, {housing['material']}; {wanted}"]
    return lines + [f"{kind}: {', '.join(housing[kind])}" for kind in ("seats", "supports", "sensors") if housing[kind]]


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
    console.print(f"{mesh['nodes']} nodes, {mesh['elements']} tetrahedra of order {document['order']}")
    console.print(f"Volume {document['volume_m3']:.6g} m³; median edge {1e3 * edge['median']:.3g} mm")
    console.print(f"Shape number (1 is regular): median {shape['median']:.2f}, smallest {shape['min']:.2f}")
    console.print(f"Surfaces: {escape(', '.join(document['surfaces'])) or 'none named'}")
    _files(console, document)


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
    _files(console, document)


def show_rotors(document: dict[str, Any]) -> None:
    """Each rotor's frequencies."""
    console = _console()
    for rotor in document["rotors"]:
        console.print(f"[bold]{escape(rotor['name'])}[/bold]  {rotor['mass_kg']:.3f} kg")
        rows = [("lateral at rest [Hz]", rotor["lateral_hz"]), ("torsional [Hz]", rotor["torsional_hz"])]
        rows += [(f"whirl at {whirl['speed_rpm']:.0f} rpm [Hz]", whirl["frequency_hz"]) for whirl in rotor["whirl"]]
        rows += [("critical speeds [rpm]", rotor["critical_speeds_rpm"])]
        for name, values in rows:
            console.print(f"  {name:26s} {'  '.join(f'{value:.5g}' for value in values[:10])}")
        certificate = rotor["certificate"]
        console.print(f"  complete below {certificate['limit_hz']:.5g} Hz: {certificate['found']} found, "
                      f"{certificate['expected']} counted")  # fmt: skip
    _files(console, document)


def show_gears(document: dict[str, Any]) -> None:
    """Each gear pair's figures."""
    console = _console()
    for pair in document["pairs"]:
        stiffness, error = pair["stiffness_n_per_m"], pair["transmission_error_m"]
        console.print(f"[bold]{escape(pair['driver'])} → {escape(pair['driven'])}[/bold]  {pair['model']}")
        console.print(f"  contact ratio {pair['contact_ratio']:.5f}")
        if pair["mesh_frequency_hz"] is not None:
            console.print(
                f"  mesh frequency {pair['mesh_frequency_hz']:.2f} Hz, mesh force {pair['mean_force_n']:.1f} N"
            )
        console.print(
            f"  mesh stiffness {1e-6 * stiffness['mean']:.2f} N/µm in the mean, {1e-6 * stiffness['min']:.2f} to "
            f"{1e-6 * stiffness['max']:.2f}"
        )
        console.print(
            f"  static transmission error {1e6 * error['mean']:.3f} µm in the mean, "
            f"{1e6 * error['peak_to_peak']:.3f} µm peak to peak"
        )
    _files(console, document)


def show_system(document: dict[str, Any]) -> None:
    """Coupled modes."""
    console = _console()
    console.print(f"{document['coordinates']} coordinates at {document['speed_rpm']:.0f} rpm")
    table = Table("frequency [Hz]", "damping ratio", "kind", "housing", "rotor", "torsion", "teeth", box=SIMPLE_HEAD)
    for column in table.columns:
        column.justify = "right"
    for mode in document["modes"]:
        shares = [f"{100 * mode['energy'][kind]:.0f} %" for kind in ("housing", "rotor", "torsion", "mesh")]
        table.add_row(f"{mode['frequency_hz']:.2f}", f"{mode['damping_ratio']:.4f}", mode["kind"], *shares)
    console.print(table)
    console.print("Shares of the kinetic energy; teeth: share of the strain energy.")
    _files(console, document)


def show_comparison(document: dict[str, Any]) -> None:
    """Measured beside model modes."""
    console = _console()
    _comparison(console, document)
    _files(console, document)


def show_examples(document: dict[str, Any]) -> None:
    """The bundled cases."""
    console = _console()
    table = Table("name", "what it is", box=SIMPLE_HEAD)
    for example in document["examples"]:
        table.add_row(escape(example["name"]), escape(example["title"]))
    console.print(table)
    console.print("Run one:   gearwhine run NAME\nChange one: gearwhine examples copy NAME")


def show_files(document: dict[str, Any]) -> None:
    """What was written."""
    _files(_console(), document)


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
    console.print(
        f"Paired by {document['pairing']}: largest error {document['max_error_percent']:.2f} %, "
        f"rms {document['rms_error_percent']:.2f} %; {count['count']} model modes below {count['below_hz']:.0f} Hz."
    )
    console.print(
        f"Gap between the last chosen mode and the next: ln {document['gap']:.3f} (below 0.1 the choice is a coin "
        f"toss); the three measures of dominance {agree}."
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
        table.add_row(escape(sensor["name"]), f"{sensor['rms_m_per_s2']:.3g}", lines)
    console.print(table)


def _modes_line(console: Console, document: dict[str, Any]) -> None:
    certificate, mesh = document["certificate"], document["mesh"]
    console.print(
        f"Housing: {certificate['found']} modes below {certificate['limit_hz']:.5g} Hz, the inertia demands "
        f"{certificate['expected']}; largest residual {certificate['max_residual']:.0e}; {document['mass_kg']:.2f} kg, "
        f"{mesh['dofs']} degrees of freedom, {document['seconds']['total']:.1f} s"
    )


def _files(console: Console, document: dict[str, Any]) -> None:
    if document.get("files"):
        console.print(f"Written to {escape(document['folder'])}: {escape(', '.join(document['files']))}")


def _console() -> Console:
    console = Console(highlight=False)
    # Where there is no terminal, lines are not cut at the 80 columns that rich then assumes.
    return console if console.is_terminal else Console(highlight=False, width=_WIDTH, soft_wrap=True)
