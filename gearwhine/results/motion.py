"""Motion of a machine, integrated in time or periodic: how its mesh forces and the lines of its sensors are shown."""

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from gearwhine.output.quantity import Quantity
from gearwhine.output.sections import NOTHING, Column, Document, Table, percent, rms_of_band, table_of
from gearwhine.results.housing import shape_places
from gearwhine.results.line_columns import LINE_NAME, MECHANISMS, line_frequency

if TYPE_CHECKING:
    from gearwhine.coupling.machine.mounted_parts import GearMesh
    from gearwhine.coupling.periodic.response import PeriodicResponse
    from gearwhine.coupling.periodic.settling import SettledMotion
    from gearwhine.coupling.periodic.superposition import SuperposedResponse
    from gearwhine.coupling.signals.spectrum import SignalParts
    from gearwhine.coupling.time.transient import TransientFigures

_LEAST_ERROR = 0.03  # smallest error of a line that is shown
_LINES_OF_A_SENSOR = 6  # lines of a sensor in the report
_MOST_SHOWN_LINES = 5  # lines of a sensor on the terminal


class MeshFigures(NamedTuple):
    """Gear mesh, the figures of a motion by contact, and the number of the loaded contact."""

    mesh: "GearMesh"
    figures: "TransientFigures | PeriodicResponse | SettledMotion | SuperposedResponse"
    contact: int

    @property
    def mean_force(self) -> float:
        """Mean force of the flanks [N]."""
        return float(self.figures.mean_force[self.contact])

    @property
    def peak_force(self) -> float:
        """Largest force of the flanks [N]."""
        return float(self.figures.peak_force[self.contact])

    @property
    def contact_loss_fraction(self) -> float:
        """Part of the time that the flanks are apart."""
        return float(self.figures.contact_loss[self.contact])


class NamedParts(NamedTuple):
    """Bearing or gear: its name, and the mean and alternating parts of its signals."""

    name: str
    parts: "SignalParts"


MESH = (
    Quantity("driver", "mesh.driver.name", heading="driver"),
    Quantity("driven", "mesh.driven.name", heading="driven"),
    Quantity("mean_force_n", heading="mean force [N]", shown=".0f"),
    Quantity("peak_force_n", heading="largest force [N]", shown=".0f"),
    Quantity("contact_loss_fraction", heading="apart [%]", shown=".2f"),
)
"""Quantities of a gear mesh in motion; a row is a :class:`MeshFigures`."""

BEARING = (
    Quantity("name", heading="bearing"),
    Quantity("mean_force_n", lambda row: row.parts.mean[:3], heading="mean force x, y, z [N]", shown=".1f"),
    Quantity("rms_force_n", lambda row: row.parts.rms[:3], heading="a.c. force x, y, z [N rms]", shown=".2f"),
    Quantity("mean_moment_n_m", lambda row: row.parts.mean[3:], heading="mean moment x, y [N·m]", shown=".2f"),
    Quantity("rms_moment_n_m", lambda row: row.parts.rms[3:]),
)
"""Loads of a bearing: forces along x, y, z and moments about x and y; a row is a :class:`NamedParts`."""


SENSOR_COLUMNS = (
    Column("sensor", "name"),
    Column("rms [m/s²]", "rms_m_per_s2", ".3g"),
    Column(
        "highest lines: Hz (m/s², peak)",
        lambda row: "  ".join(_line(line) for line in row.get("peaks", row.get("lines", ()))[:_MOST_SHOWN_LINES]),
        numbers=tuple(
            f"{rows}.{place}.{key}"
            for rows in ("peaks", "lines")
            for place in range(_MOST_SHOWN_LINES)
            for key in ("frequency_hz", "amplitude_m_per_s2")
        ),
    ),
)


def sensor_columns(document: Document) -> tuple[Column, ...]:
    """Return columns of the sensors of a motion: name, rms over the band of the document, highest lines."""
    name, rms, lines = SENSOR_COLUMNS
    return (name, replace(rms, heading=f"{rms_of_band([document.get('trusted_below_hz')])} [m/s²]"), lines)


def path_place(sensor: str, frequency_hz: float) -> str:
    """Return the name of the place in the report that shows the path of a sensor's line."""
    return f"path {sensor} {frequency_hz:.1f} Hz"


def _shapes_of(row: Document) -> tuple[str, ...]:
    """Return the places of a line's operating shape, and of the housing mode with the largest part of the line."""
    shape = f"picture line-{row['frequency_hz']:.1f}Hz"
    return (shape, *shape_places(row["by_mode"])) if row["by_mode"] is not None else (shape,)


def shape_column(heading: str) -> Column:
    """Return the column of :func:`leading_lines` that names the leading housing mode and links to a picture of it."""
    return Column(heading, "by", link=_shapes_of)


def closing(error: float, spec: str = ".0e") -> str:
    """Return how well a balance or a period closes, such as ``to 3e-12``, or ``exactly`` without an error."""
    return f"to {error:{spec}}" if error else "exactly"


def damping_lines(parts: Iterable[Document]) -> list[str]:
    """Return the damping of the parts of a machine in words, like ones together, and what nobody gave."""
    alike: dict[str, list[str]] = {}
    for part in parts:
        words = part["damping"] + ("" if part["given"] else " (default)")
        alike.setdefault(words, []).append(part["part"])
    return [f"{', '.join(names)}: {words}" for words, names in alike.items()]


def damping_sentence(document: Document) -> list[str]:
    """Return the damping behind the lines of a document as a sentence; none where it has none."""
    lines = damping_lines(document.get("damping", ()))
    return [f"Damping of {'; '.join(lines)}."] if lines else []


def gear_body_lines(document: Document) -> list[str]:
    """Return the modes of each wheel with a web in words, and which of them the machine follows."""
    lines = []
    for body in document.get("gear_bodies", ()):
        first = [mode for mode in body["modes"] if "circle" not in mode["name"]][:4]
        modes = ", ".join(f"{mode['name']} {mode['frequency_hz']:.0f} Hz" for mode in first)
        kept, below = sum(mode["kept"] for mode in body["modes"]), f"{1e-3 * body['kept_below_hz']:.4g} kHz"
        ratio = f"{100.0 * body['damping_ratio']:.3g} % of critical, as {body['rotor']}"
        followed = (
            f"the {kept} modes below {below} are followed, with {ratio}"
            if kept
            else f"none is below {below}, so the body is rigid in them"
        )
        lines.append(f"{body['gear']} on a hub at rest: {modes}; {followed}")
    return lines


_NARROW_BAND = 0.5  # width of a band [dB] below which a line is shown with a digit more


def band_words(row: Document) -> str:
    """Return the band of a line by damping, such as ``-2.1 +3.4``; empty where there is none."""
    band = row.get("band_db")
    return NOTHING if band is None else "{:+z.1f} {:+z.1f}".format(*band)


def _width(row: Document) -> float:
    """Width of a line's band by damping [dB]; 0 where there is none."""
    below, above = row.get("band_db") or (0.0, 0.0)
    return float(above - below)


def amplitude_words(row: Document) -> str:
    """Return a line's amplitude with two digits, or three where its band by damping is narrow.

    One digit, all that a wide band leaves, would hide what a change of the machine does to the line.
    """
    width = _width(row)
    digits = 3 if width < _NARROW_BAND else 2
    amplitude = row.get("amplitude_m_per_s2")
    return NOTHING if amplitude is None else plain(amplitude, digits)


def level_words(row: Document) -> str:
    """Return a line's level [dB], with tenths where its band by damping is narrow."""
    level = row.get("level_db")
    return NOTHING if level is None else format(level, ".1f" if _width(row) < _NARROW_BAND else ".0f")


def plain(value: float, digits: int) -> str:
    """Return a number with as many digits, without an exponent where there are more before the point."""
    rounded = float(f"{value:.{digits}g}")
    return f"{rounded:g}" if rounded < 1e6 else f"{value:.{digits}g}"


_MINOR = 0.1  # part of a line's largest mechanism below which another one is not shown
_LARGEST_SUM_RATIO = 2.0  # factor between a line and the sum of its parts from which that is told


def mechanism_words(row: Document) -> str:
    """Return the mechanisms of a line with their amplitudes, the largest first; empty where nothing excites it."""
    parts = {name: value for name, value in (row.get("parts") or {}).items() if value > 0.0}
    if not parts:
        return NOTHING
    largest = max(parts.values())
    leading = sorted((name for name in parts if parts[name] >= _MINOR * largest), key=lambda name: -parts[name])
    words = ", ".join(f"{MECHANISMS[name]} {plain(parts[name], 2)}" for name in leading)
    amplitude, together = row.get("amplitude_m_per_s2"), row["parts_together_m_per_s2"]
    if amplitude is None or amplitude / _LARGEST_SUM_RATIO <= together <= amplitude * _LARGEST_SUM_RATIO:
        return words
    return f"{words}; by the linear model {plain(together, 2)} in all"


MECHANISM = Column(
    "excited by [m/s²]", mechanism_words, numbers=(*(f"parts.{name}" for name in MECHANISMS), "parts_together_m_per_s2")
)
"""Column of a line's mechanisms."""
CAUSE_COLUMNS = (
    Column("sensor", "sensor"),
    Column("Hz", "frequency_hz", ".0f"),
    Column("m/s², peak", "amplitude_m_per_s2", shown=lambda row: amplitude_words(row)),
    Column("damping × 2, / 2 [dB]", lambda row: band_words(row), numbers=("band_db.0", "band_db.1")),
    LINE_NAME,
    MECHANISM,
)
"""Columns of lines on a terminal: what they are, and what excites them."""

LINE_COLUMNS = (
    Column("sensor", "sensor"),
    line_frequency(lambda row: (path_place(row["sensor"], row["frequency_hz"]),)),
    Column("amplitude [m/s², peak]", "amplitude_m_per_s2", shown=amplitude_words),
    Column("level [dB re 1e-6 m/s²]", "level_db", shown=level_words),
    Column("by damping × 2 and / 2 [dB]", band_words, numbers=("band_db.0", "band_db.1")),
    Column("± by the modal basis [%]", "uncertainty", ".1f"),
    LINE_NAME,
    MECHANISM,
    shape_column("mostly by"),
)


def mesh_sentence(pair: Document) -> str:
    """Return the forces of a gear mesh in words."""
    side = " on its back flanks" if pair.get("flanks") == "back" else ""
    sentence = (
        f"Gear mesh {pair['driver']} → {pair['driven']}{side}: mean force {pair['mean_force_n']:.0f} N, "
        f"peak {pair['peak_force_n']:.0f} N, apart {percent(pair['contact_loss_fraction'])} of the time"
    )
    if other := pair.get("other_flanks"):
        sentence += (
            f"; its {'drive' if side else 'back'} flanks: mean {other['mean_force_n']:.0f} N, "
            f"peak {other['peak_force_n']:.0f} N; both together {other['net_mean_force_n']:.0f} N, "
            f"and apart {percent(other['both_apart_fraction'])} of the time"
        )
    return sentence


def leading_lines(sensors: Iterable[Document], key: str, most: int = _LINES_OF_A_SENSOR) -> list[dict[str, Any]]:
    """Return the highest lines of each sensor as rows; ``by`` is the housing mode with the largest part of a line."""
    rows: list[dict[str, Any]] = []
    for sensor in sensors:
        for line in sensor.get(key, ())[:most]:
            parts = line.get("contributions", {}).get("housing_modes", ())
            # The largest of all in size may work against the line.
            leading = max(parts, key=lambda part: part["share"], default={"name": None})
            by = {"by": leading["name"], "by_mode": leading.get("number")}
            rows.append({**line, "sensor": sensor["name"]} | by)
    return rows


def line_table(
    sensors: Iterable[Document], key: str, caption: str = "Highest lines of each sensor"
) -> tuple[Table, ...]:
    """Return the highest lines of each sensor, linked to their paths and to the housing's motion."""
    return table_of(LINE_COLUMNS, leading_lines(sensors, key), caption)


def _line(line: Document) -> str:
    """Return a sensor's line, such as ``733 (0.58)``, with its modal truncation error where that is large."""
    error = line.get("uncertainty", 0.0)
    beside = "" if error <= _LEAST_ERROR else f" ± {100.0 * error:.0f} %" if error < 1.0 else ", unsure"
    return f"{line['frequency_hz']:.0f} ({plain(line['amplitude_m_per_s2'], 2)}{beside})"
