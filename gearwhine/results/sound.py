"""Sound: quantities of the housing's radiation and of the sound of a motion's lines, and how they are shown."""

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from gearwhine.housing.acoustics.sound_levels import BOX_MICROPHONES, power_level, pressure_level
from gearwhine.output.quantity import Part, Quantity, Rows, document_of, in_file
from gearwhine.output.sections import (
    Column,
    Document,
    Picture,
    Section,
    Table,
    arrowed,
    columns_of,
    counted,
    percent,
    table_of,
)
from gearwhine.results.line_columns import MECHANISMS, line_frequency

if TYPE_CHECKING:
    from gearwhine.coupling.sound.solution import SolvedSound, SoundLine

_METHODS = {
    "boundary-elements": "boundary elements over the whole surface",
    "rayleigh": "Rayleigh's integral over flat faces in baffles",
    "erp": "equivalent radiated power, an estimate",
}
_MOST_LISTED = 3  # faces, lines or microphones that a sentence lists, and lines listed for each microphone
_TERMINAL_LINES = 12  # lines in the table of the terminal
_BRIEF_LINES = 5  # lines in that table beside another analysis
_LEAST_LEFT_OUT = 1e-3  # part of the power from which lines left out are mentioned
_MODE_NAME = "housing mode "
_LOCAL = "local compliance"
_LEAST_SHARE = 0.02  # share of a power from which a mode, bearing or face is listed


SURFACE = (
    Quantity("triangles", lambda radiation: sum(len(part.surface.triangles) for part in radiation.elements)),
    Quantity("area_m2", lambda radiation: sum(part.surface.area for part in radiation.elements)),
    Quantity("caps_m2", "cap_area"),
    Quantity("velocity_error", "transfer_error"),
    Quantity(
        "resolved_below_hz",
        lambda radiation: radiation.highest_frequency if np.isfinite(radiation.highest_frequency) else None,
    ),
)
"""Quantities of the radiating surface."""

MODE = (
    Quantity("number", "number", "sound_mode", unit="1", long_name="number of the housing mode"),
    Quantity(
        "frequency_hz",
        "frequency_hz",
        "sound_mode_frequency",
        long_name="natural frequency",
        heading="natural frequency [Hz]",
        shown=".1f",
    ),
    Quantity(
        "radiation_efficiency",
        "radiation_efficiency",
        "radiation_efficiency",
        unit="1",
        long_name="radiation efficiency of the mode at its natural frequency",
        heading="radiation efficiency",
        shown=".3g",
    ),
    Quantity("faces", lambda mode: {face: part for face, part in mode.face_shares.items() if abs(part) > _LEAST_SHARE}),
    Quantity("power_balance_db", "power_balance_db"),
    Quantity("interior_pressure"),
    Quantity(
        "known_source_error",
        "known_source.largest",
        "sound_mode_known_source_error",
        unit="1",
        long_name="largest error of a known source's pressure on the surface at the natural frequency",
    ),
    Quantity("known_source_rms", "known_source.rms"),
)
"""Quantities of the sound of one housing mode."""

MODE_COLUMNS = (
    Column("mode", "number", "d"),
    *columns_of(MODE),
    Column("radiating faces", lambda row: _parts(row["faces"]), numbers=("faces",)),
)


class _Entry(NamedTuple):
    """Sound, and one of its lines."""

    solved: "SolvedSound"
    line: "SoundLine"


def _contributions(row: _Entry) -> dict[str, list[dict[str, Any]]]:
    solved, line = row
    power = line.sound.power
    alone = dict(zip(solved.bearings, power_level(line.sound.power_alone).tolist(), strict=True))
    return {
        "housing_modes": parts_of_modes(line.sound.by_mode, len(solved.mode_frequencies), power),
        "bearings": [
            part | {"alone_db": alone[part["name"]]}
            for part in _largest_shares(zip(solved.bearings, line.sound.by_motion.tolist(), strict=True), power)
        ],
        "faces": _largest_shares(line.sound.by_face.items(), power),
    }


def parts_of_modes(by_mode: npt.NDArray[np.float64], natural: int, power: float) -> list[dict[str, Any]]:
    """Return the housing modes with a large part in the power of a line, the largest part first.

    Parameters
    ----------
    by_mode : ndarray, shape (n_modes,)
        Power of each mode and residual mode [W].
    natural : int
        Number of the modes, before the residual modes: these are the local compliance together.
    power : float
        Power of the line [W].
    """
    modes = [(f"{_MODE_NAME}{number}", float(part)) for number, part in enumerate(by_mode[:natural], start=1)]
    return _largest_shares([*modes, (_LOCAL, float(by_mode[natural:].sum()))], power)


def _largest_shares(parts: Iterable[tuple[str, float]], power: float) -> list[dict[str, Any]]:
    return [
        {"name": name, "share": part / power}
        for name, part in sorted(parts, key=lambda pair: -abs(pair[1]))
        if abs(part) > _LEAST_SHARE * power
    ]


def _of_lines(name: str, of: Any, unit: str, long_name: str) -> Quantity:
    """Declare an array over the lines."""

    def values(solved: "SolvedSound") -> Any:
        return np.array([of(line) for line in solved.lines])

    return in_file(name, "sound_line", values, long_name, unit)


ENTRY = (
    Quantity("frequency_hz", "line.frequency_hz"),
    Quantity("order", "line.order"),
    Quantity("name", "line.name"),
    Quantity("sound_power_db", "line.level_db"),
    Quantity("sound_power_db_a", "line.level_db_a"),
    Quantity("equivalent_power_db", "line.equivalent_db"),
    Quantity(
        "parts_equivalent_power_db",
        lambda row: {name: float(power_level(power)) for name, power in row.line.mechanism_powers.items()},
    ),
    Quantity("radiation_efficiency", "line.sound.radiation_efficiency"),
    Quantity("surface_power_db", lambda row: float(power_level(row.line.sound.surface_power))),
    Quantity("power_balance_db", "line.power_balance_db"),
    Quantity("interior_pressure", "line.interior_pressure"),
    Quantity("known_source_error", "line.known_source.largest"),
    Quantity("known_source_rms", "line.known_source.rms"),
    Quantity("contributions", _contributions),
    Quantity(
        "microphones_db",
        lambda row: {
            name: float(pressure_level(row.line.microphones[place]))
            for place, name in enumerate(row.solved.microphones)
        },
    ),
)
"""Quantities of a line."""


def _picture_of(row: Document) -> tuple[str, ...]:
    """Return the place in the report that shows where the housing radiates at a line."""
    return (f"picture sound-faces-{row['frequency_hz']:.1f}Hz",)


def _leading(parts: list[dict[str, Any]]) -> dict[str, Any] | None:
    """Return the part with the largest share; the first, largest in size, may take power back."""
    return max(parts, key=lambda part: float(part["share"]), default=None)


def _leading_mode(line: Mapping[str, Any]) -> dict[str, Any] | None:
    return _leading(line["contributions"]["housing_modes"])


def _largest(heading: str, group: str) -> Column:
    """Return the column that names the largest part of a line's power, with its share."""

    def text(row: Document) -> str:
        part = _leading(row["contributions"][group])
        if part is None:
            return ""
        name = str(part["name"]).removeprefix(_MODE_NAME).replace(_LOCAL, "local")
        return f"{name}, {100.0 * part['share']:.0f} %"

    return Column(heading, text, numbers=(f"contributions.{group}",))


_LINE = line_frequency(_picture_of)
_ORDER = Column("order", "order", ".4g")
_LEVELS = (Column("L_W [dB]", "sound_power_db", ".1f"), Column("L_WA [dB]", "sound_power_db_a", ".1f"))
_NAME = Column("what it is", lambda row: arrowed(str(row["name"])))
_MODE, _FACE = _largest("by mode", "housing_modes"), _largest("by face", "faces")
_BEARING = _largest("by bearing", "bearings")

_WEAKER = 10.0  # distance of a mechanism from the strongest one of a line up to which it is told [dB]


def _mechanisms(row: Document) -> str:
    """Return what excites a line, the strongest mechanism first, and how far weaker ones are below it."""
    levels = row.get("parts_equivalent_power_db") or {}
    if not levels:
        return ""
    highest = max(levels.values())
    leading = sorted((name for name in levels if levels[name] > highest - _WEAKER), key=lambda name: -levels[name])
    first, *others = leading
    return ", ".join([MECHANISMS[first], *(f"{MECHANISMS[name]} {levels[name] - highest:z.0f} dB" for name in others)])


_EXCITED = Column("excited by", _mechanisms, numbers=tuple(f"parts_equivalent_power_db.{name}" for name in MECHANISMS))

LOUDEST_COLUMNS = (_LINE, *_LEVELS, _NAME, _EXCITED, _MODE, _BEARING, _FACE)
"""Columns of a line, on the terminal and the first page."""

LINE_COLUMNS = (
    _LINE,
    _ORDER,
    _NAME,
    _EXCITED,
    *_LEVELS,
    Column("ERP [dB]", "equivalent_power_db", ".1f"),
    Column("efficiency", "radiation_efficiency", ".2g"),
    _MODE,
    _BEARING,
    _FACE,
)
"""Columns of a line, in the report."""


def _mode_number(line: Mapping[str, Any]) -> int | None:
    mode = _leading_mode(line)
    return None if mode is None or mode["name"] == _LOCAL else int(mode["name"].removeprefix(_MODE_NAME))


def _mode_text(row: Mapping[str, Any]) -> str:
    """Return the mode that carries a line with its natural frequency and its part in words."""
    if row["mode_share"] is None:
        return ""
    name = "local" if row["mode"] is None else f"{row['mode']} at {row['mode_frequency_hz']:.0f} Hz"
    return f"{name}, {100.0 * row['mode_share']:.0f} %"


class SweptLine(NamedTuple):
    """Entry of a line in the document of a sweep's point, and the natural frequencies of the housing there [Hz]."""

    line: Mapping[str, Any]
    housing_frequencies_hz: npt.NDArray[np.float64]


SWEPT_LINE = (
    Quantity(
        "name",
        lambda row: row.line["name"],
        "sound_line_name",
        long_name="name of the loudest lines",
        heading="loudest line",
        shown=lambda row: arrowed(str(row["name"])),
    ),
    Quantity(
        "frequency_hz",
        lambda row: row.line["frequency_hz"],
        "sound_line_frequency",
        long_name="frequency of the loudest lines",
        heading="at [Hz]",
        shown=".1f",
    ),
    Quantity(
        "order",
        lambda row: row.line["order"],
        "sound_line_order",
        unit="1",
        long_name="order of the loudest lines over the speed of the first driver",
    ),
    Quantity(
        "sound_power_db",
        lambda row: row.line["sound_power_db"],
        "sound_line_level",
        long_name="sound power level of the loudest lines re 1 pW",
        heading="its L_W [dB]",
        shown=".1f",
    ),
    Quantity(
        "mode",
        lambda row: _mode_number(row.line),
        "sound_line_mode",
        unit="1",
        long_name="number of the housing mode with the largest part of the line's power",
        heading="most by mode",
        shown=_mode_text,
        numbers=("mode_frequency_hz", "mode_share"),
    ),
    Quantity(
        "mode_frequency_hz",
        lambda row: None if (number := _mode_number(row.line)) is None else row.housing_frequencies_hz[number - 1],
        "sound_line_mode_frequency",
        long_name="natural frequency of that mode",
    ),
    Quantity(
        "mode_share",
        lambda row: None if (mode := _leading_mode(row.line)) is None else mode["share"],
        "sound_line_mode_share",
        unit="1",
        long_name="part of that mode in the line's power",
    ),
)
"""Quantities of a line of a sweep's point; a row is a :class:`SweptLine`."""

PARTS = (
    "Parts are shares of the line's power with phase: the motions by all bearings add up as complex amplitudes, and "
    "the part of one is what its own motion radiates in the pressure of all. They are signed and sum to 100 %"
)
"""Meaning of the parts of a line."""

LEFT_OUT = (
    Quantity("name"),
    Quantity("frequency_hz", "frequency_hz"),
    Quantity("share"),
)
"""Quantities of a line whose sound is not solved; the share is None where the modes are not complete."""


class _Microphone(NamedTuple):
    """Microphone: its name, position [m], level and A-weighted level [dB], and the error of a known source there."""

    name: str
    position: npt.NDArray[np.float64]
    level: float | None
    level_a: float | None
    known_source_error: float | None


MICROPHONE = (
    Quantity("name", heading="microphone"),
    Quantity("position_m"),
    Quantity("level_db", heading="sound pressure [dB re 20 µPa]", shown=".1f"),
    Quantity("level_db_a", "level_a", heading="A-weighted [dB]", shown=".1f"),
    Quantity(
        "known_source_error",
        "known_source_error",
        "microphone_known_source_error",
        unit="1",
        long_name="largest error of a known source's pressure at the microphone",
    ),
)
"""Quantities of a microphone."""


HEARD_COLUMNS = (
    Column("microphone", "microphone"),
    line_frequency(),
    _NAME,
    Column("sound pressure [dB re 20 µPa]", "level_db", ".1f"),
)
"""Columns of one of the loudest lines at a microphone."""


def _heard(document: Document) -> list[Document]:
    """Return the loudest lines at each microphone."""
    rows = []
    for microphone in document["microphones"]:
        name = microphone["name"]
        loudest = sorted(document["lines"], key=lambda line: -float(line["microphones_db"][name]))[:_MOST_LISTED]
        rows += [line | {"microphone": name, "level_db": line["microphones_db"][name]} for line in loudest]
    return rows


def _microphones(solved: "SolvedSound") -> list[_Microphone]:
    levels, weighted = solved.microphone_levels(), solved.microphone_levels(weighted=True)
    errors = solved.microphone_errors
    return [
        _Microphone(
            name,
            place,
            levels[name] if solved.lines else None,
            weighted[name] if solved.lines else None,
            errors.get(name),
        )
        for name, place in solved.microphones.items()
    ]


def _bands(solved: "SolvedSound") -> list[dict[str, float]]:
    return [
        {"frequency_hz": hertz, "sound_power_db": level, "sound_power_db_a": weighted}
        for hertz, level, weighted in zip(*(values.tolist() for values in solved.bands), strict=True)
        if np.isfinite(level)
    ]


SOUND = (
    Quantity("method", "radiation.method"),
    Quantity("highest_frequency_hz", "limit_hz"),
    Part("surface", "radiation", SURFACE),
    Rows("lines", lambda solved: [_Entry(solved, line) for line in solved.lines], ENTRY),
    Quantity("covered", lambda solved: solved.covered if solved.lines else None),
    Rows("left_out", "left_out", LEFT_OUT),
    Quantity("total_db", lambda solved: solved.total_db if solved.lines else None),
    Quantity("total_db_a", lambda solved: solved.total_db_a if solved.lines else None),
    Quantity("power_balance_db", "power_balance_db"),
    Quantity("interior_pressure"),
    Quantity("known_source_error", "known_source.largest"),
    Quantity("known_source_rms", "known_source.rms"),
    Quantity("third_octaves", _bands),
    Quantity("faces_w", "by_face"),
    Rows("modes", "modes", MODE, "sound_mode"),
    Rows("microphones", _microphones, MICROPHONE, "microphone"),
    Quantity("box_power_db", "box_level_db"),
    Quantity("microphone_error", "histories.error"),
    in_file("microphone_time", "microphone_time", "histories.times", "time", "s", common=True),
    in_file(
        "microphone_pressure",
        "microphone microphone_time",
        "histories.pressure",
        "sound pressure at the microphone",
        "Pa",
    ),
    _of_lines("sound_frequency", lambda line: line.frequency_hz, "Hz", "frequency of the line"),
    in_file(
        "sound_known_source_error",
        "sound_line",
        lambda solved: (
            np.array([np.nan if line.known_source is None else line.known_source.largest for line in solved.lines])
            if any(line.known_source is not None for line in solved.lines)
            else None
        ),
        "largest error of a known source's pressure on the surface at the frequency of the line",
        "1",
    ),
    _of_lines("sound_name", lambda line: line.name, "", "name of the line"),
    _of_lines("sound_order", lambda line: line.order, "1", "order over the speed of the first driver"),
    _of_lines("sound_power", lambda line: line.sound.power, "W", "sound power of the line"),
    _of_lines(
        "equivalent_radiated_power",
        lambda line: line.sound.equivalent_power,
        "W",
        "equivalent radiated power of the line",
    ),
    in_file("microphone", "microphone", lambda solved: list(solved.microphones) or None, common=True),
    in_file(
        "microphone_position",
        "microphone coordinate",
        lambda solved: np.array(list(solved.microphones.values())) if solved.microphones else None,
        "position of the microphone",
        "m",
        common=True,
    ),
    in_file(
        "sound_pressure",
        "sound_line microphone part",
        lambda solved: (
            np.array([[np.stack([v.real, v.imag], -1) for v in line.microphones] for line in solved.lines])
            if solved.microphones and solved.lines
            else None
        ),
        "complex amplitude of the sound pressure",
        "Pa",
    ),
)
"""Quantities of the sound of a case."""


def sound_document(solved: "SolvedSound") -> dict[str, Any]:
    """Return the sound as the command's JSON."""
    return document_of(SOUND, solved)


def _parts(faces: Document) -> str:
    """Return parts of a power in words, the largest first."""
    ordered = sorted(faces.items(), key=lambda face: -face[1])[:_MOST_LISTED]
    return ", ".join(f"{face} {100.0 * part:.0f} %" for face, part in ordered)


def loudest_lines(document: Document) -> list[Document]:
    """Return the lines of a document, the loudest first."""
    return sorted(document["lines"], key=lambda line: -float(line["sound_power_db"]))


def total_sentence(document: Document) -> str:
    """Return the sound power level of all lines in words; empty without lines."""
    if document["total_db"] is None:
        return ""
    return (
        f"Sound power level L_W of {counted(len(document['lines']), 'line')} together: {document['total_db']:.1f} dB "
        f"re 1 pW, A-weighted L_WA {document['total_db_a']:.1f} dB"
    )


def known_source_sentence(document: Document) -> str:
    """Return the error of known sources inside in words, or that there is no such proof."""
    if (error := document["known_source_error"]) is not None:
        microphone_errors = [microphone.get("known_source_error") for microphone in document["microphones"]]
        errors = [value for value in microphone_errors if value is not None]
        at_most = f", {percent(max(errors))} at the microphones" if errors else ""
        return (
            f"Proof by a known source inside: its pressure on the surface is off by at most {percent(error)}, "
            f"{percent(document['known_source_rms'])} in the root mean square{at_most}"
        )
    why = {
        "rayleigh": "flat faces in baffles have no inside",
        "erp": "an estimate solves no equations",
    }.get(document["method"])
    if why is None:
        if not document["lines"] and not document["modes"]:
            return ""
        why = "the housing is too thin for a source inside it, or no line or mode radiates enough to be checked"
    return f"No proof by a known source: {why}"


def left_out_sentence(document: Document) -> str:
    """Return the lines whose sound is not solved in words; empty where they have hardly any power."""
    left_out = document["left_out"]
    parts = []
    estimated = [line for line in left_out if line["share"] is not None]
    rest = 1.0 - document["covered"] if estimated else 0.0
    if estimated and (
        rest >= _LEAST_LEFT_OUT or any(line["frequency_hz"] > document["highest_frequency_hz"] for line in estimated)
    ):
        parts.append(
            f"{percent(max(rest, 0.0))} of the power by the estimate, most of it {_named(estimated, shares=True)}"
        )
    if without_estimate := [line for line in left_out if line["share"] is None]:
        parts.append(f"{_named(without_estimate)}, where the housing's modes are not complete")
    return f"Left out: {'; '.join(parts)}" if parts else ""


def _named(lines: list[Document], *, shares: bool = False) -> str:
    """Return the first lines with their frequencies, and the number of further ones."""
    names = [
        f"{arrowed(str(line['name']))} at {line['frequency_hz']:.0f} Hz"
        + (f" ({percent(line['share'])})" if shares else "")
        for line in lines[:_MOST_LISTED]
    ]
    return ", ".join(names) + (f" and {len(lines) - _MOST_LISTED} more" if len(lines) > _MOST_LISTED else "")


def brief(document: Document) -> Iterator[str | Table]:
    """Yield the sound of a motion in sentences and its loudest lines, for the terminal of another analysis."""
    if total := total_sentence(document):
        yield total
        if left_out := left_out_sentence(document):
            yield left_out
        yield from table_of(LOUDEST_COLUMNS, loudest_lines(document)[:_BRIEF_LINES], "Loudest lines of the sound")
    if document["microphone_error"] is not None:
        names = [str(microphone["name"]) for microphone in document["microphones"]]
        listed = ", ".join(names[:_MOST_LISTED]) + (
            f" and {len(names) - _MOST_LISTED} more" if len(names) > _MOST_LISTED else ""
        )
        yield f"Sound pressure over time at {counted(len(names), 'microphone')} ({listed}): gearwhine export --wav"


def _microphones_by_place(document: Document) -> tuple[list[Document], list[Document]]:
    """Return the microphones of the case, and those on the box of ISO 3744, which come last."""
    microphones = document["microphones"]
    first_on_box = len(microphones) - (0 if document["box_power_db"] is None else BOX_MICROPHONES)
    return microphones[:first_on_box], microphones[first_on_box:]


def _content(document: Document) -> Iterator[str | Table]:
    surface = document["surface"]
    yield (
        f"Sound by {_METHODS[document['method']]}: {surface['triangles']} triangles, {surface['area_m2']:.3g} m², "
        f"of which {surface['caps_m2']:.2g} m² close holes; up to {document['highest_frequency_hz']:.0f} Hz"
    )
    if total := total_sentence(document):
        yield f"{total}; by an estimate {percent(document['covered'])} of the whole"
        if left_out := left_out_sentence(document):
            yield left_out
        power = sum(document["faces_w"].values())
        if power > 0.0:
            yield f"Radiating faces: {_parts({face: part / power for face, part in document['faces_w'].items()})}"
    if proof := known_source_sentence(document):
        yield proof
    if document["box_power_db"] is not None:
        levels = [microphone["level_db"] for microphone in _microphones_by_place(document)[1]]
        yield (
            f"By the mean pressure on the box of microphones (ISO 3744): L_W {document['box_power_db']:.1f} dB; "
            f"pressure {min(levels):.1f} to {max(levels):.1f} dB re 20 µPa"
        )


def sections(document: Document) -> tuple[Section, ...]:
    """Return the levels, the lines, the microphones and the modes for the terminal."""
    microphones, _ = _microphones_by_place(document)
    tables = (
        *table_of(
            LOUDEST_COLUMNS, loudest_lines(document)[:_TERMINAL_LINES], "Loudest lines, and the largest part of each"
        ),
        *((PARTS,) if document["lines"] else ()),
        *table_of(columns_of(MICROPHONE), microphones, "All lines at the microphones"),
        *table_of(MODE_COLUMNS, document["modes"], "Modes; a radiation efficiency of 1 is that of a plane wave"),
    )
    return (Section("", (*_content(document), *tables)),)


def report(document: Document) -> Section:
    """Chapter of the report."""
    tables = (
        *table_of(LINE_COLUMNS, loudest_lines(document), "Lines, the loudest first, and the largest part of each"),
        *table_of(columns_of(MICROPHONE), document["microphones"], "All lines at the microphones"),
        *table_of(HEARD_COLUMNS, _heard(document), "Loudest lines at each microphone"),
        *table_of(MODE_COLUMNS, document["modes"], "Radiation of the housing's modes"),
    )
    notes = (_READING_NOTE,) if document["lines"] else ()
    return Section("Sound", (*_content(document), *notes, *tables), pictures=_PICTURES)


_READING_NOTE = (
    "L_W is the sound power level re 1 pW, L_WA the same A-weighted. The equivalent radiated power (ERP) is an "
    "estimate that takes a radiation efficiency of 1. The order is the frequency over that of the first driver's "
    f"rotation. {PARTS}: others that work against the largest one make it exceed that. Mode local is the compliance "
    "around the bearings beyond the housing's modes."
)

_PICTURES = (
    Picture(
        "sound-power",
        "Sound power level of each line, the loudest with names, and of third octaves; marks where ERP differs "
        "from the line: the housing radiates less or more than a plane wave of its velocity.",
    ),
    Picture(
        "sound-faces-all",
        "Mean sound intensity out of the housing over all lines, from two sides: red radiates, blue absorbs, where the "
        "pressure from other places works against the wall's own motion. The estimate by ERP absorbs nowhere.",
    ),
    Picture("sound-faces", "The same at one of the loudest lines.", small=True),
    Picture(
        "sound-directivity",
        "Sound pressure level of the far field over direction at the loudest lines, in three planes through the "
        "middle.",
    ),
    Picture(
        "sound-efficiency",
        "Radiation efficiency of each housing mode at its natural frequency; 1 is that of a plane wave. Modes far "
        "below 1 may move much and are hardly heard.",
    ),
)
"""Figures of the sound: power of lines and third octaves, radiating faces, directivity, efficiency of the modes."""
