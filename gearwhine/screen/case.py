"""A case before anything is solved: what it means, its mesh, the bundled ones."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.table import Table

from gearwhine.screen.console import counted, open_console, show_written


def show_check(document: dict[str, Any]) -> None:
    """What the case means, a line for each part."""
    table = Table.grid(padding=(0, 2))
    table.add_column(style="bold")
    table.add_column()
    for part, text in _parts(document):
        table.add_row(part, text)
    console = open_console()
    console.print(document["title"], style="bold")
    console.print(table)


def _parts(document: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """The parts of a case in words; a part's name stands on its first line only."""
    if "housing" in document:
        yield from _named("housing", _housing_lines(document["housing"]))
    yield from _named("rotors", [_rotor_line(rotor) for rotor in document.get("rotors", ())])
    yield from _named("bearings", [_bearing_line(bearing) for bearing in document.get("bearings", ())])
    yield from _named("analysis", [line for one in document.get("rotor_analysis", ()) for line in _analysis_lines(one)])
    yield from _named("gear pairs", [line for pair in document.get("gear_pairs", ()) for line in _pair_lines(pair)])
    if "operation" in document:
        operation = document["operation"]
        lines = [f"{operation['speed_rpm']:.6g} rpm, {operation['torque_n_m']:.6g} N·m"]
        for torque in operation["torques"]:
            place = "" if torque["at_m"] is None else f" at {1e3 * torque['at_m']:.4g} mm"
            lines.append(f"torque on {torque['rotor']}{place}: {torque['torque_n_m']:+.6g} N·m about z")
        for key in ("motor", "load"):
            if key in operation:
                points = zip(operation[key]["speed_rpm"], operation[key]["torque_n_m"], strict=True)
                lines.append(f"{key}: " + ", ".join(f"{torque:.6g} N·m at {speed:.6g} rpm" for speed, torque in points))
        if "gravity_m_per_s2" in operation:
            lines.append("gravity: " + ", ".join(f"{part:g}" for part in operation["gravity_m_per_s2"]) + " m/s²")
        if "base" in operation:
            base = operation["base"]
            moves = [f"{frequency:.6g} Hz" for frequency in base["harmonics_hz"]]
            lines.append("base moves: " + ", ".join(moves + ["a table over time"] * base["over_time"]))
        yield from _named("operation", lines)
    if "transient" in document:
        yield "transient", _transient_line(document["transient"])
    if "sweep" in document:
        yield "sweep", counted(document["sweep"]["speeds"], "speed")
    if "measured" in document:
        yield from _named("measured", _measured_lines(document["measured"]))
    yield from _named("standing", [f"{key}: {text}" for key, text in document.get("provenance", {}).items()])


def _measured_lines(given: dict[str, Any]) -> list[str]:
    """The measured modes; of a file also what was read from it."""
    lines = []
    if "frequencies_hz" in given:
        lines.append(", ".join(f"{one:.6g}" for one in given["frequencies_hz"]) + " Hz")
    if "points" in given:
        kind = "" if "frequencies_hz" not in given else f"; {'complex' if given['complex'] else 'real'} shapes"
        size = " x ".join(f"{1e3 * side:.4g}" for side in given["extent_m"])
        points = f"{counted(given['points'], 'point')} over {size} mm"
        lines.append(f"{points}, {counted(given['degrees_of_freedom'], 'measured direction')}{kind}")
    if "responses" in given:
        found = given["responses"]
        lines.append(
            f"responses in {found['of']} to {counted(found['references'], 'force')}, {found['lines']} lines from "
            f"{found['from_hz']:.6g} to {found['to_hz']:.6g} Hz"
        )
    return lines


def _transient_line(given: dict[str, Any]) -> str:
    tolerance = f"tolerance {given['tolerance']:g}"
    if "run" not in given:
        recorded = given["recorded_revolutions"]
        return f"{given['revolutions']:g} revolutions, the last {recorded:g} recorded; {tolerance}"
    run = given["run"]
    speeds = " → ".join(f"{speed:.6g}" for speed in dict.fromkeys(run["speeds_rpm"]))
    line = f"free from {speeds} rpm" if run["free"] else f"{speeds} rpm"
    discarded = given["discarded_revolutions"]
    first = f", the first {discarded:g} revolutions not recorded" if discarded else ""
    return f"{line} in {run['seconds']:g} s{first}; {tolerance}"


def _named(part: str, lines: Sequence[str]) -> Iterator[tuple[str, str]]:
    for number, line in enumerate(lines):
        yield ("" if number else part), line


def _housing_lines(housing: dict[str, Any]) -> list[str]:
    shape = {"box": "box", "cad": "CAD file", "mesh": "mesh"}[housing["geometry"]]
    if "size_m" in housing:
        shape += f" of {' x '.join(f'{1e3 * length:.6g}' for length in housing['size_m'])} mm"
    if "mesh_size_m" in housing:
        shape += f", elements of {1e3 * housing['mesh_size_m']:g} mm"
    if "mesh" in housing:
        shape += f", {housing['mesh']['nodes']} nodes, {_kinds(housing['kinds'])}"
    limit, count = housing["frequency_limit_hz"], housing["modes"]
    wanted = f"all modes below {limit:g} Hz" if limit else f"the lowest {counted(count, 'mode')}"
    lines = [f"{shape}, {housing['material']}; {wanted}"]
    lines += [f"{kind}: {', '.join(housing[kind])}" for kind in ("regions", "seats", "supports") if housing[kind]]
    for kind in ("mounts", "joints"):
        lines += [_bushing_line(kind[:-1], one) for one in housing[kind]]
    if housing.get("cover_bolts"):
        first, *others = housing["cover_bolts"]
        lines.append(_bushing_line("cover", first) + (f"; so {counted(len(others), 'more bolt')}" if others else ""))
    lines += [_bore_line(bore) for bore in housing.get("bores", ())]
    if housing["masses"]:
        lines.append("masses: " + ", ".join(f"{one['name']} {one['mass_kg']:g} kg" for one in housing["masses"]))
    return lines + ([f"sensors: {', '.join(housing['sensors'])}"] if housing["sensors"] else [])


def _bushing_line(kind: str, bushing: dict[str, Any]) -> str:
    between = f" ({' to '.join(bushing['surfaces'])})" if "surfaces" in bushing else ""
    if "diameter_m" in bushing:
        place = ", ".join(f"{1e3 * value:.6g}" for value in bushing["center_m"])
        between = f" (circles of {1e3 * bushing['diameter_m']:.6g} mm at {place} mm)"
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
    place = ", ".join(f"{round(1e3 * value, 3) + 0.0:.6g}" for value in bore["center_m"])
    along = "" if bore["axis"] == "z" else f" along {bore['axis']}"
    return f"bore of {1e3 * bore['diameter_m']:.5g} mm{along} at ({place}) mm, {1e3 * bore['length_m']:.4g} mm long"


def _rotor_line(rotor: dict[str, Any]) -> str:
    speed = "" if rotor["speed_rpm"] is None else f", {rotor['speed_rpm']:+.6g} rpm"
    length = f"{1e3 * rotor['length_m']:g} mm"
    parts = f" with {counted(rotor['couplings'], 'coupling')}" if rotor["couplings"] else ""
    return f"{rotor['name']}: {length}{parts}, {rotor['mass_kg']:.4g} kg, {rotor['mass_model']}{speed}"


def _bearing_line(bearing: dict[str, Any]) -> str:
    line = f"{bearing['name']}: {bearing['rotor']} on {bearing['seat']}"
    if bearing["pedestal_kg"] is not None:
        line += f", by a pedestal of {bearing['pedestal_kg']:g} kg"
    if bearing["table_rpm"] is not None:
        line += ", tables over {:.6g} to {:.6g} rpm".format(*bearing["table_rpm"])
    return line


def _analysis_lines(analysis: dict[str, Any]) -> Iterator[str]:
    for key, what in (("campbell_rpm", "Campbell diagram"), ("response_rpm", "response to unbalance and bow")):
        if analysis[key] is not None:
            low, high, count = analysis[key]
            yield f"{analysis['rotor']}: {what} at {counted(count, 'speed')}, {low:.6g} to {high:.6g} rpm"
    if analysis["torques"]:
        yield f"{analysis['rotor']}: torsional response to {counted(analysis['torques'], 'torque')}"


def _pair_lines(pair: dict[str, Any]) -> list[str]:
    lines = [
        f"{pair['driver']} → {pair['driven']}: ratio {pair['ratio']:.6g}, {contact_ratios(pair)}, "
        f"stiffness {pair['stiffness_model']}",
        f"shafts {1e3 * pair['centre_distance_m']:.6g} mm apart, working pressure angle "
        f"{pair['working_pressure_angle_deg']:.4g}°{_backlash(pair['backlash_m'])}",
    ]
    lines += [tooth_line(gear) for gear in pair["geometry"]["gears"]]
    if pair["mesh_frequency_hz"] is not None:
        lines.append(f"mesh frequency {pair['mesh_frequency_hz']:.2f} Hz, mean mesh force {pair['mean_force_n']:.1f} N")
    return lines


def contact_ratios(pair: dict[str, Any]) -> str:
    """The contact ratio; of helical gears with the overlap."""
    text = f"contact ratio {pair['contact_ratio']:.5f}"
    if pair["overlap_ratio"] == 0.0:
        return text
    return f"{text} + overlap {pair['overlap_ratio']:.5f} = {pair['total_contact_ratio']:.5f}"


def tooth_line(gear: dict[str, Any]) -> str:
    """A gear's circles, and the span over its teeth."""
    angle = math.degrees(gear["helix_angle_rad"])
    helix = f", helix {abs(angle):.6g}° {'right' if angle > 0.0 else 'left'}" if angle else ""
    circles = ", ".join(f"{name} {1e3 * gear['diameters_m'][name]:.6g}" for name in ("tip", "form", "root"))
    span = gear["span"]
    measured = "" if span is None else f"; span of {span['teeth']}: {1e3 * span['length_m']:.6g} mm"
    cut = " (undercut)" if gear["undercut"] else ""
    return f"{gear['name']}: {gear['teeth']} teeth{helix}, diameters {circles} mm{cut}{measured}"


def _backlash(backlash: dict[str, float]) -> str:
    """The backlash by centre distance and thickness, where there is any that could be measured."""
    clearance = 1e3 * backlash["circumferential"]
    return "" if abs(clearance) < 1e-6 else f", backlash of the teeth {clearance:.4g} mm"


def show_mesh(document: dict[str, Any]) -> None:
    """The mesh's size and quality."""
    console = open_console()
    mesh, edge, shape = document["mesh"], document["edge_length_m"], document["shape_number"]
    console.print(f"{mesh['nodes']} nodes, {_kinds(document['kinds'])}")
    console.print(f"Volume {document['volume_m3']:.6g} m³; median edge {1e3 * edge['median']:.3g} mm")
    console.print(f"Shape number (1 is ideal): median {shape['median']:.2f}, smallest {shape['min']:.2f}")
    console.print(f"Surfaces: {', '.join(document['surfaces']) or 'none named'}")
    console.print(f"Volumes: {', '.join(document['volumes']) or 'none named'}")
    for bore in document["bores"]:
        console.print(_bore_line(bore).capitalize())
    show_written(console, document)


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


def show_examples(document: dict[str, Any]) -> None:
    """The bundled cases."""
    console = open_console()
    table = Table("name", "what it is", box=SIMPLE_HEAD)
    for example in document["examples"]:
        table.add_row(example["name"], example["title"])
    console.print(table)
    console.print("Run one:   gearwhine run NAME\nChange one: gearwhine examples copy NAME")
