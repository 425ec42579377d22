"""Planetary sets of a checked case: members, assembly, phasing of the meshes, and how the terminal shows them."""

import math
import re
from collections.abc import Iterator, Sequence
from typing import Any

from gearwhine.output.quantity import HERTZ, RPM, Quantity, Rows
from gearwhine.output.sections import Document, counted

_NUMBER_OF_COPY = re.compile(r" \d+$")
"""Number behind the name of a planet that is made of one."""
_HARMONICS = 6
"""Mesh harmonics of which the document has the sums over the planets."""


MEMBER = (
    Quantity("role"),
    Quantity("name", "shaft", heading="member"),
    Quantity("speed_rpm", lambda member: member.speed * RPM, heading="speed\n[rpm]", shown=".5g"),
    Quantity("relative_speed_rpm", lambda member: member.relative_speed * RPM),
    Quantity("torque_n_m", "torque", heading="torque\n[N·m]", shown=".5g"),
    Quantity("power_w", "power", heading="power\n[W]", shown=".5g"),
    Quantity("rolling_power_w", "rolling_power"),
    Quantity("state", heading="is"),
)
"""Quantities of a member of a planetary set; a row is a :class:`SetMember`."""


def _of_meshes(checked: Any, attribute: str) -> list[float | None]:
    values = getattr(checked, attribute)
    return [None] * len(checked.placed.meshes) if values is None else list(values)


def _same_teeth(checked: Any) -> list[float | None]:
    return [None if rate is None else rate / HERTZ for rate in _of_meshes(checked, "same_teeth")]


PLANETARY = (
    Quantity("name", "placed.of.name"),
    Quantity("sun", "placed.of.sun"),
    Quantity("ring", "placed.of.ring"),
    Quantity("carrier", "placed.of.carrier"),
    Quantity("planets", "placed.of.planets"),
    Quantity("teeth", lambda checked: {name: gear.teeth for name, gear in checked.placed.gears.items()}),
    Quantity("angles_deg", lambda checked: [math.degrees(angle) for angle in checked.placed.angles]),
    Quantity("assembly_number", "placed.assembly_number"),
    Quantity("misfits", "placed.misfits"),
    Quantity("clearance_m", lambda checked: checked.placed.clearances[0].gap if checked.placed.clearances else None),
    Rows("members", "members", MEMBER),
    Rows(
        "meshes",
        lambda checked: list(
            zip(checked.placed.meshes, _of_meshes(checked, "phases"), _same_teeth(checked), strict=True)
        ),
        (
            Quantity("driver", lambda row: row[0].driver),
            Quantity("driven", lambda row: row[0].driven),
            Quantity("kind", lambda row: row[0].kind),
            Quantity("common_factor", lambda row: row[0].common_factor),
            Quantity("phase", lambda row: row[1]),
            Quantity("same_teeth_hz", lambda row: row[2]),
        ),
    ),
    Quantity("planet_pass_hz", lambda checked: None if checked.planet_pass is None else checked.planet_pass / HERTZ),
    Rows(
        "tooth_faults",
        "faults",
        (
            Quantity("gear"),
            Quantity("role"),
            Quantity("turn_hz", lambda rate: rate.turn / HERTZ),
            Quantity("working_flank_mates", "working"),
            Quantity("working_flank_hz", lambda rate: rate.working_rate / HERTZ),
            Quantity("back_flank_mates", "back"),
            Quantity("back_flank_hz", lambda rate: rate.back_rate / HERTZ),
            Quantity("tooth_hz", lambda rate: rate.tooth_rate / HERTZ),
        ),
    ),
    Rows(
        "planet_bearings",
        lambda checked: list(checked.planet_bearings.items()),
        (
            Quantity("name", lambda row: row[0]),
            Quantity(
                "characteristic_frequencies_hz",
                lambda row: {name: rate / HERTZ for name, rate in row[1].named().items()},
            ),
        ),
    ),
    Rows(
        "mesh_harmonics",
        lambda checked: [(harmonic, checked.placed) for harmonic in range(1, _HARMONICS + 1)],
        (
            Quantity("harmonic", lambda row: row[0]),
            Quantity("torque_sum", lambda row: row[1].excitation(row[0])[0]),
            Quantity("force_sum", lambda row: row[1].excitation(row[0])[1]),
            Quantity("suppressed_modes", lambda row: row[1].suppressed(row[0])),
        ),
    ),
)
"""Quantities of a planetary set."""


def set_summary(one: Document) -> Iterator[str]:
    """Yield a set in two lines: its gears, and its members in operation."""
    teeth, planets = one["teeth"], one["planets"]
    named = [f"{role} {one[role]} ({abs(teeth[one[role]])})" for role in ("sun", "ring") if one[role] is not None]
    counts = ", ".join(str(number) for number in dict.fromkeys(abs(teeth[name]) for name in planets))
    yield f"{one['name']}: {', '.join(named)}, {counted(len(planets), 'planet gear')} ({counts}) on {one['carrier']}"
    central = [member for member in one["members"] if member["role"] != "planet"]
    if central:
        yield "; ".join(map(_member_line, central))


def set_lines(one: Document) -> Iterator[str]:
    """Yield all lines on a set."""
    yield from set_summary(one)
    planets = [member for member in one["members"] if member["role"] == "planet"]
    if planets:
        speeds = dict.fromkeys(f"{each['relative_speed_rpm']:+.6g}" for each in planets)
        yield f"planets turn at {', '.join(speeds)} rpm on their pins{_power_words(one['members'])}"
    yield _place_line(one)
    yield from _phase_lines(one)
    yield from _harmonic_lines(one["mesh_harmonics"])
    yield from _rate_lines(one)


def _member_line(member: Document) -> str:
    return f"{member['role']} {member['state']}, {member['speed_rpm'] + 0.0:+.6g} rpm, {member['torque_n_m']:+.6g} N·m"


def _power_words(members: Sequence[Document]) -> str:
    """Return the power that enters the set, and the part of it that passes through rolling teeth."""
    entering = sum(member["power_w"] for member in members if member["power_w"] > 0.0)
    rolling = sum(member["rolling_power_w"] for member in members if member["rolling_power_w"] > 0.0)
    return f"; {1e-3 * entering:.4g} kW enter, {1e-3 * rolling:.4g} kW pass through the meshes" if entering else ""


def _place_line(one: Document) -> str:
    first = one["angles_deg"][0]
    angles = ", ".join(f"{(angle - first) % 360.0:.6g}" for angle in one["angles_deg"])
    line = f"planets at {angles}°"
    if one["assembly_number"]:
        line += f", of {one['assembly_number']} places at which teeth fit"
    if one["clearance_m"] is not None:
        line += f"; neighbours {1e3 * one['clearance_m']:.4g} mm clear of each other"
    return line


def _phase_lines(one: Document) -> Iterator[str]:
    for kind, name in (("sun", "sun meshes"), ("planets", "planets' meshes"), ("ring", "ring meshes")):
        meshes = [mesh for mesh in one["meshes"] if mesh["kind"] == kind]
        if not meshes:
            continue
        factors = sorted({mesh["common_factor"] for mesh in meshes})
        words = "hunting teeth" if factors == [1] else f"common factor {', '.join(map(str, factors))} of the teeth"
        phases = "" if meshes[0]["phase"] is None else ", ".join(f"{mesh['phase']:.4g}" for mesh in meshes)
        yield f"{name}: {f'phases {phases} periods, ' if phases else ''}{words}"


def _harmonic_lines(harmonics: Sequence[Document]) -> Iterator[str]:
    """Yield which mesh harmonics excite which kinds of modes of equal planets."""
    excited: dict[str, list[int]] = {}
    for row in harmonics:
        kinds = [kind for kind in ("rotational", "translational") if kind not in row["suppressed_modes"]]
        excited.setdefault(" and ".join(kinds) or "planet", []).append(row["harmonic"])
    parts = [f"{', '.join(map(str, numbers))} excite {kinds} modes" for kinds, numbers in excited.items()]
    yield f"mesh harmonics {'; '.join(parts)}"


def _rate_lines(one: Document) -> Iterator[str]:
    """Yield the rates of faults of each member once, planets and bearings that are alike together."""
    faults = dict.fromkeys(_fault_words(fault, one["planets"]) for fault in one["tooth_faults"])
    if not faults:
        return
    meet = dict.fromkeys(f"{mesh['same_teeth_hz']:.4g}" for mesh in one["meshes"])
    passing = f"planets pass a sensor at {one['planet_pass_hz']:.4g} Hz; " if one["planet_pass_hz"] else ""
    yield f"{passing}the same teeth meet again at {', '.join(meet)} Hz"
    yield f"a tooth fault strikes: {'; '.join(faults)}"
    bearings = dict.fromkeys(map(_bearing_words, one["planet_bearings"]))
    if bearings:
        yield f"faults of the planets' bearings: {'; '.join(bearings)}"


def _fault_words(fault: Document, planets: Sequence[str]) -> str:
    """Return the rates of a gear's tooth fault; planets that are alike differ in their number alone."""
    words = f"{fault['role']} {fault['working_flank_hz']:.5g} Hz"
    if fault["role"] != "planet" or not fault["back_flank_mates"]:
        return words
    names = [*fault["working_flank_mates"], *fault["back_flank_mates"]]
    mates = {name: _NUMBER_OF_COPY.sub("", name) if name in planets else name for name in names}
    sides = (
        f"{', '.join(mates[name] for name in fault[f'{flank}_flank_mates'])} ({flank})" for flank in ("working", "back")
    )
    return f"{words} on the flank at {' or '.join(sides)}, {fault['tooth_hz']:.5g} Hz on both"


def _bearing_words(bearing: Document) -> str:
    return ", ".join(f"{name} {rate:.5g} Hz" for name, rate in bearing["characteristic_frequencies_hz"].items())
