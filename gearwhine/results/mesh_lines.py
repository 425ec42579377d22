"""Lines of sensors at mesh harmonics and their sidebands: how far they are followed, and how they are shown."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from gearwhine.output.quantity import ABSENT, HERTZ, Part, Quantity
from gearwhine.output.sections import Column, Document, Table, counted, percent, table_of
from gearwhine.results.motion import band_words

if TYPE_CHECKING:
    from gearwhine.coupling.analyses.modes_and_responses import SolvedSystem

_LINES = 3  # of each sensor, the highest
_SIDEBANDS = 8  # of each sensor, the highest, where carriers turn
_LISTED_LEFT = 6  # lines that equal planets would not have, the highest
_FAINT_LINE = 1e-3  # part of a sensor's highest line below which what is left of a line is not listed
_OTHER_PART = 0.01  # part of a line by others than its meshes from which it is listed
_ROUNDING = 1e-9  # part of a sensor's highest line up to which a line is not listed
_IN_ALL_KEY = "parts_together_m_per_s2"
_PARTS = ("by_transmission_error", "by_varying_stiffness", "by_load_shuttling", "by_friction", "together")


# --------------------------------------------------------------------------- how far lines are followed


def _meshes(solved: "SolvedSystem") -> list[dict[str, Any]]:
    """Return each mesh frequency with the names of its meshes, and the number of its harmonics among the lines."""
    from gearwhine.coupling.linear.excitation_orders import joined_causes
    from gearwhine.coupling.linear.mesh_harmonics import HARMONICS

    machine, housing = solved.machine, solved.machine.housing
    together: dict[float, list[str]] = {}
    for number, mesh in zip(machine.loaded_contacts, machine.meshes, strict=True):
        if frequency := abs(machine.system.contacts[number].mesh_frequency):
            together.setdefault(round(frequency, 9), []).append(mesh.name)
    limit = 0.0 if housing is None or housing.complete_below is None else housing.complete_below / HERTZ
    return [
        {
            "name": joined_causes(machine, names),
            "frequency_hz": frequency,
            "harmonics": min(HARMONICS, int(limit / frequency)),
            "most_harmonics": HARMONICS,
        }
        for frequency, names in sorted(together.items())
    ]


def _carriers(solved: "SolvedSystem") -> list[dict[str, Any]] | object:
    """Return each carrier whose turns lines are off, how many are followed, and what the outermost lines still have.

    The outermost are those that are not zero by symmetry: alike supports leave odd numbers of turns alone.
    """
    from gearwhine.coupling.linear.carriers.carrier_sidebands import farthest_turns, forced_sidebands
    from gearwhine.coupling.linear.carriers.planet_phasing import PlanetPhasing

    machine = solved.machine
    carried, rows = PlanetPhasing(machine).carried, list(machine.sensor_rows.values())
    heights = [max((line.frequency**2 * abs(row @ line.motion) for row in rows), default=0.0) for line in solved.lines]
    found = []
    for name, turns in farthest_turns(forced_sidebands(machine)).items():
        off = [farthest_turns(line.sidebands).get(name, 0.0) for line in solved.lines]
        reached = max(off, default=0.0)
        outermost = max((height for height, number in zip(heights, off, strict=True) if number == reached), default=0.0)
        planets = carried.get(name)
        found.append(
            {
                "name": name,
                "frequency_hz": abs(machine.speeds[name]) / HERTZ,
                "turns": turns,
                "outermost_turns": reached,
                "outermost_share": float(outermost / max([*heights, 1e-300])) if reached else 0.0,
                "planets": None if planets is None else len(planets.groups),
                "symmetry": None if planets is None else planets.symmetry,
            }
        )
    return found or ABSENT


LINE_LIMITS = Part(
    "mesh_line_limits",
    lambda solved: solved if solved.lines else ABSENT,
    (
        Quantity("limit_hz", lambda solved: solved.machine.housing.complete_below / HERTZ),
        Quantity("meshes", _meshes),
        Quantity("carriers", _carriers),
    ),
)
"""Quantities of how far the lines of sensors are followed: by harmonics, and by turns of carriers."""


def _limit_sentences(limits: Document) -> Iterator[str]:
    """Yield which harmonics and sidebands the lines are, and which are left out."""
    for mesh in limits["meshes"]:
        within, first = mesh["harmonics"], mesh["frequency_hz"]
        listed = f"{first:.5g} Hz" if within == 1 else f"{first:.5g} Hz and its harmonics up to {within}×"
        above = (
            f"{within + 1}× is left out, above {limits['limit_hz']:.5g} Hz, up to which all modes of the housing are "
            "there: raise housing.frequency_limit for it"
            if within < mesh["most_harmonics"]
            else "higher ones are left out"
        )
        yield f"Mesh frequency of {mesh['name']}: {listed if within else f'{first:.5g} Hz'}; {above}."
    for carrier in limits.get("carriers", ()):
        share = carrier["outermost_share"]
        left = "less than 0.01 %" if share < 1e-4 else percent(share)
        yield (
            f"Sidebands by {carrier['name']}, {carrier['frequency_hz']:.5g} Hz, are followed up to k = "
            f"±{carrier['turns']:g} turns, which its bores and frames force; the outermost, at "
            f"±{carrier['outermost_turns']:g}, have {left} of the highest line."
        )


# ------------------------------------------------------------------------------------------ tables


def line_content(document: Document) -> Iterator[str | Table]:
    """Yield the highest lines of each sensor by each mechanism of the teeth, by these and by all."""
    lines = document.get("mesh_lines", [])
    rows: list[dict[str, Any]] = []
    turning = any("kind" in line for line in lines)
    keys = ("frequency_hz", "cause", "harmonic", "turns", "kind", "phasing", "ideal_phasing")
    for sensor in lines[0]["sensor_acceleration_m_per_s2"]["together"] if lines else ():
        of_sensor = [
            {"sensor": sensor}
            | {key: line[key] for key in keys if key in line}
            | {name: parts[name][sensor] for name in _PARTS if name in (parts := line["sensor_acceleration_m_per_s2"])}
            | ({"band_db": line["band_db"][sensor]} if "band_db" in line else {})
            | {"in_all": (line["sensor_acceleration_m_per_s2"]["together"] | line.get(_IN_ALL_KEY, {}))[sensor]}
            for line in lines
        ]
        highest = sorted(of_sensor, key=lambda row: -row["in_all"])
        least = _ROUNDING * highest[0]["in_all"]
        rows += [row for row in highest if row["in_all"] > least][: _SIDEBANDS if turning else _LINES]
    limits = document.get("mesh_line_limits")
    if rows:
        yield "Highest lines of the sensors at operation, linear response about the mean load [m/s²]:"
        short = turning and limits is not None and len(limits["meshes"]) == len(limits.get("carriers", ())) == 1
        more = any(abs(row["in_all"] - row["together"]) > _OTHER_PART * row["in_all"] for row in rows)
        columns = _turning_columns(short=short) if turning else _LINE_COLUMNS
        yield from table_of((*columns[:-1], _IN_ALL, columns[-1]) if more else columns, rows)
        if short:
            yield "Lines n f_m + k f_c: n harmonic of the planets' meshes, k turns of the carrier, see below."
        yield (
            "By error: transmission error with the mean mesh stiffness; by stiffness: what its variation with the "
            "phase adds; together: the sum with phase, above or below each part." + (_ALL_WORDS if more else "")
        )
    if turning:
        yield (
            "Phasing: the housing's motion by all planets over the sum of its motions by the meshes of each planet "
            "alone, 1 where planets add, 0 where they cancel; in brackets what equal planets at these angles have. "
            "Planet pass: a line beside the harmonic in which equal planets add, of an order in turns of the carrier "
            "that is a multiple of their number, where the ring stands still."
        )
    if rows and limits is not None:
        yield from _limit_sentences(limits)
    if turning:
        yield from _left_lines(lines, document.get("load", {}))


def _left_lines(lines: Sequence[Document], load: Document) -> Iterator[str]:
    """Yield what unequal planets leave of lines in which equal ones cancel each other, the highest first."""
    cancelled = [line for line in lines if line.get("suppressed")]
    if not cancelled:
        return
    top = max(max(line["sensor_acceleration_m_per_s2"]["together"].values()) for line in lines)
    left = []
    for line in cancelled:
        sensor, height = max(line["sensor_acceleration_m_per_s2"]["together"].items(), key=lambda one: one[1])
        left.append((height, sensor, line))
    left.sort(key=lambda one: -one[0])
    listed = [one for one in left if one[0] > _FAINT_LINE * top]
    yield (
        f"Equal planets would cancel in {len(cancelled)} of {counted(len(lines), 'line')}, by their angles and numbers "
        f"of teeth. {''.join(f'{one}. ' for one in _differences(load))}".rstrip()
    )
    if not listed:
        yield f"Of the cancelled lines less than {percent(_FAINT_LINE)} of the highest line is left."
        return
    words = [
        f"{line['frequency_hz']:.1f} Hz ({line['cause']}) {height:.3g} m/s² at {sensor}, phasing {line['phasing']:.2f}"
        for height, sensor, line in listed[:_LISTED_LEFT]
    ]
    rest = len(cancelled) - len(words)
    more = f"; less of {counted(rest, 'other')}" if rest else ""
    yield f"Left of the cancelled lines, the highest first: {'; '.join(words)}{more}."


def _differences(load: Document) -> Iterator[str]:
    """Yield how unequal the planets of each set are under the mean load, and by what."""
    over_turn = {one["name"]: one["load_shares"] for one in load.get("planetary_over_turn", ())}
    for one in load.get("planetary", ()):
        means = over_turn.get(one["name"])
        shares = [share["mean"] for share in means] if means else [planet["load_share"] for planet in one["planets"]]
        errors = [max(map(abs, planet["pin_error_m"])) for planet in one["planets"]]
        causes = [f"pins up to {1e6 * max(errors):.3g} µm off their places"] if max(errors) > 0.0 else []
        causes += ["gravity"] if load.get("gravity_m_per_s2") else []
        causes += ["a housing that yields differently around the set"] if load.get("seats") == "housing" else []
        by = f", by {' and '.join(causes)}" if causes else ""
        listed, mean = ", ".join(f"{share:.4f}" for share in shares), ""
        if means:
            least, most = min(share["min"] for share in means), max(share["max"] for share in means)
            mean = f" in the mean over a turn, {least:.4f} to {most:.4f} at its angles"
        yield f"The planets of {one['name']} carry {listed} of the torque{mean}{by}"


def _beside_harmonic(row: Document) -> str:
    """Return the place of a line of one mesh frequency and one carrier, such as ``2f_m-1f_c``."""
    if "harmonic" not in row:
        return str(row["cause"])
    # In one word, which no table breaks.
    return f"{row['harmonic']}f_m" + "".join(f"{number:+g}f_c" for number in row["turns"].values())


def _phasing(row: Document) -> str:
    ideal = row.get("ideal_phasing")
    return f"{row['phasing']:.2f}" + ("" if ideal is None else f" ({ideal:.0f})")


_LINE_COLUMNS = (
    Column("sensor", "sensor"),
    Column("frequency [Hz]", "frequency_hz", ".1f"),
    Column("harmonic", "cause"),
    Column("by error", "by_transmission_error", ".3g"),
    Column("by stiffness", "by_varying_stiffness", ".3g"),
    Column("by shuttling", "by_load_shuttling", ".3g"),
    Column("by friction", "by_friction", ".3g"),
    Column("together", "together", ".3g"),
    Column("by damping × 2 and / 2 [dB]", band_words, numbers=("band_db.0", "band_db.1")),
)


_IN_ALL = Column("in all", "in_all", ".3g")
_ALL_WORDS = (
    " In all: with what else excites at the frequency, such as pitch deviations of the other gears of a shaft, whose "
    "orders meet the harmonic."
)


def _turning_columns(*, short: bool) -> tuple[Column, ...]:
    """Columns of lines with sidebands; with one mesh frequency and one carrier their places in short."""
    place = Column("line", "cause", shown=_beside_harmonic) if short else Column("harmonic", "cause")
    phasing = Column("phasing", "phasing", shown=_phasing, numbers=("ideal_phasing",))
    kind = Column("kind", "kind")
    frequency = Column("Hz", "frequency_hz", ".1f")
    return (_LINE_COLUMNS[0], frequency, place, kind, phasing, *_LINE_COLUMNS[3:])
