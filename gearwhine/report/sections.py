"""What a report shows of the documents that commands write: sections of tables, each column with its unit.

A command's document is read by its keys alone, so that a report can be made of whatever command filled the folder.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

Document = Mapping[str, Any]
Row = Mapping[str, Any]


@dataclass(frozen=True)
class Column:
    """One column of a table: where its values stand in a row, its heading, how a number is written, and its scale."""

    key: str
    heading: str
    form: str = ".4g"
    scale: float = 1.0

    def text(self, row: Row) -> str:
        """The value of a row in words; a dash where there is none."""
        value: Any = row
        for step in self.key.split("."):
            value = value.get(step) if isinstance(value, Mapping) else None
        if isinstance(value, bool):
            return "yes" if value else "no"
        if isinstance(value, int | float):
            return format(value * self.scale if self.scale != 1.0 else value, self.form)
        if isinstance(value, list):
            return ", ".join(format(entry, self.form) if isinstance(entry, float) else str(entry) for entry in value)
        return "–" if value is None else str(value)


@dataclass(frozen=True)
class Table:
    """Rows of one kind under columns; columns in which no row has anything are left out."""

    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    caption: str = ""

    def filled(self) -> tuple[tuple[Column, ...], list[list[str]]]:
        """The columns that say something, and the text of each row in them."""
        texts = {column: [column.text(row) for row in self.rows] for column in self.columns}
        kept = tuple(column for column in self.columns if any(text != "–" for text in texts[column]))
        return kept, [[texts[column][number] for column in kept] for number in range(len(self.rows))]


@dataclass(frozen=True)
class Section:
    """A heading, sentences, tables, and the pictures whose names begin with one of some words."""

    title: str
    sentences: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()
    pictures: tuple[str, ...] = field(default=())


_MODES = (
    Column("number", "mode", "d"),
    Column("frequency_hz", "frequency [Hz]", ".2f"),
    Column("damping_ratio", "damping ratio", ".4f"),
    Column("strength", "strength [1/kg]", ".4g"),
)
_PAIRS = (
    Column("measured_hz", "measured [Hz]", ".1f"),
    Column("model_hz", "model [Hz]", ".1f"),
    Column("error_percent", "error [%]", "+.2f"),
    Column("mode", "mode", "d"),
    Column("mac", "MAC", ".3f"),
    Column("confidence", "confidence", ".2f"),
    Column("strength", "strength [1/kg]", ".4g"),
)
_GEARS = (
    Column("driver", "driver"),
    Column("driven", "driven"),
    Column("contact_ratio", "contact ratio", ".4f"),
    Column("mesh_frequency_hz", "mesh frequency [Hz]", ".2f"),
    Column("stiffness_n_per_m.mean", "mean stiffness [N/µm]", ".1f", 1e-6),
    Column("transmission_error_m.mean", "mean transmission error [µm]", ".2f", 1e6),
    Column("transmission_error_m.peak_to_peak", "peak to peak [µm]", ".3f", 1e6),
)
_MESHES = (
    Column("driver", "driver"),
    Column("driven", "driven"),
    Column("mean_force_n", "mean force [N]", ".0f"),
    Column("peak_force_n", "largest force [N]", ".0f"),
    Column("contact_loss_fraction", "apart [%]", ".2f", 100.0),
    Column("friction.mean_power_w", "friction takes [W]", ".3g"),
    Column("rms_compression_m", "a.c. compression [µm rms]", ".3g", 1e6),
)
_ORDERS = (
    Column("signal", "signal"),
    Column("name", "order"),
    Column("highest_amplitude", "highest [peak]", ".3g"),
    Column("unit", "unit"),
    Column("at_rpm", "at [rpm]", ".0f"),
    Column("frequency_hz", "that is [Hz]", ".0f"),
)
_LINES = (
    Column("sensor", "sensor"),
    Column("frequency_hz", "line [Hz]", ".1f"),
    Column("amplitude_m_per_s2", "amplitude [m/s², peak]", ".3g"),
    Column("level_db", "level [dB re 1e-6 m/s²]", ".1f"),
    Column("name", "what it is"),
    Column("by", "mostly by"),
)
_SYSTEM = (
    Column("frequency_hz", "frequency [Hz]", ".2f"),
    Column("damping_ratio", "damping ratio", ".4f"),
    Column("kind", "kind"),
    Column("where", "where"),
)
_ROTORS = (
    Column("name", "rotor"),
    Column("mass_kg", "mass [kg]", ".3f"),
    Column("lateral_hz", "bending at rest [Hz]", ".1f"),
    Column("torsional_hz", "torsion [Hz]", ".1f"),
    Column("critical_speeds_rpm", "critical speeds [rpm]", ".0f"),
)
_BEARINGS = (
    Column("name", "bearing"),
    Column("mean_force_n", "mean force x, y [N]", ".1f"),
    Column("rms_force_n", "a.c. force x, y [N rms]", ".2f"),
)
_PARAMETERS = (
    Column("name", "parameter"),
    Column("before", "before (SI)", ".5g"),
    Column("after", "after (SI)", ".5g"),
    Column("standard_deviation", "± (SI)", ".2g"),
)
_HELD_BACK = (
    Column("measured_hz", "held back [Hz]", ".1f"),
    Column("predicted_hz", "predicted [Hz]", ".1f"),
    Column("error_percent", "error [%]", "+.2f"),
    Column("standard_deviation_percent", "expected ± [%]", ".2f"),
    Column("before_error_percent", "error before [%]", "+.2f"),
    Column("rms_error_percent_of_the_others", "rms of the others [%]", ".2f"),
)
_EVENTS = (Column("speed_rpm", "speed [rpm]", ".1f"), Column("kind", "what happens"))
_MOST_MODES = 60  # of the coupled system that a table holds
_LINES_OF_A_SENSOR = 6


def sections_of(document: Document) -> tuple[Section, ...]:
    """The sections of a command's document, those without anything left out."""
    housing = document.get("housing", document if "certificate" in document and "mesh" in document else {})
    makers: tuple[tuple[Callable[[Document], Section], Any], ...] = (
        (_housing, housing),
        (_comparison, document.get("compare", document if "pairing" in document else {})),
        (_update, document if "parameters" in document else {}),
        (_rotors, document if document.get("rotors") else {}),
        (_gears, document if any("contact_ratio" in pair for pair in document.get("pairs", ())) else {}),
        (_system, document.get("system", document if "stability" in document else {})),
        (_transient, document if "steps" in document else {}),
        (_steady, document if "motions" in document else {}),
    )
    return tuple(make(given) for make, given in makers if given)


def _table(columns: tuple[Column, ...], rows: Sequence[Row], caption: str = "") -> tuple[Table, ...]:
    return (Table(columns, tuple(rows), caption),) if rows else ()


def _housing(document: Document) -> Section:
    sentences = []
    if certificate := document.get("certificate"):
        complete = "complete" if certificate.get("complete") else "NOT complete"
        sentences.append(
            f"{certificate['found']} modes below {certificate['limit_hz']:.0f} Hz, {complete}: the inertia count "
            f"demands {certificate['expected']}; largest relative residual {certificate['max_residual']:.0e}."
        )
    if mesh := document.get("mesh"):
        sentences.append(
            f"{mesh['elements']} elements, {mesh['dofs']} degrees of freedom, {document.get('mass_kg', 0.0):.2f} kg."
        )
    tables = _table(_MODES, document.get("modes", ()))
    return Section("Housing modes", tuple(sentences), tables, ("modes", "mode-", "gallery"))


def _comparison(document: Document) -> Section:
    sentences = [f"Paired by {document['pairing']}."]
    if document.get("rms_error_percent") is not None:
        sentences.append(
            f"Errors: {document['rms_error_percent']:.2f} % root mean square, "
            f"{document['max_error_percent']:.2f} % at most."
        )
    if document.get("gap") is not None:
        agree = "agree" if document.get("measures_agree") else "do not agree"
        sentences.append(f"Gap of dominance {document['gap']:.3f}; the three measures {agree}.")
    pictures = ("comparison", "mac", "auto-mac", "comac", "cross-orthogonality")
    return Section("Measured and modelled", tuple(sentences), _table(_PAIRS, document.get("pairs", ())), pictures)


def _update(document: Document) -> Section:
    before, learned = document["before"], document["identifiability"]
    sentences = [
        f"Before: {before['rms_error_percent']:.2f} % root mean square, {before['max_error_percent']:.2f} % at most.",
        f"The data tell {learned['learned_combinations']} combinations of the {learned['parameters']} numbers better "
        "than the prior.",
    ]
    if null := document.get("null"):
        sentences.append(
            f"Of {null['sets']} random sets of as many frequencies the same search fits "
            f"{100 * null['within_5_percent']:.0f} % within 5 %, {100 * null['within_2_percent']:.0f} % within 2 % and "
            f"{100 * null['within_1_percent']:.0f} % within 1 % each; {100 * null['as_good_in_rms']:.0f} % as well as "
            "the measured ones in rms."
        )
    else:
        sentences.append("Not known is how often random frequencies are fitted as well (--null).")
    tables = _table(_PARAMETERS, document["parameters"])
    tables += _table(_HELD_BACK, document.get("held_back", ()), "Each mode predicted by a fit to the others")
    return Section("Updated numbers", tuple(sentences), tables, ("update",))


def _rotors(document: Document) -> Section:
    pictures = ("rotor", "shaft", "campbell-rotor", "critical", "unbalance")
    return Section("Rotors", (), _table(_ROTORS, document["rotors"]), pictures)


def _gears(document: Document) -> Section:
    return Section("Gears", (), _table(_GEARS, document["pairs"]), ("gears-",))


def _system(document: Document) -> Section:
    modes, sentences = document.get("modes", ()), []
    if stability := document.get("stability"):
        growing = len(stability["growing"])
        sentences.append("No mode grows." if stability["stable"] else f"Unstable: {growing} of the modes grow.")
    if len(modes) > _MOST_MODES:
        sentences.append(f"The lowest {_MOST_MODES} of {len(modes)} modes.")
    tables = _table(_SYSTEM, modes[:_MOST_MODES])
    return Section("Coupled system", tuple(sentences), tables, ("campbell", "transmissibility", "system"))


def _transient(document: Document) -> Section:
    sentences = [
        f"{document['steps']} steps at {document['speed_rpm']:.0f} rpm, {document['coordinates']} modal coordinates; "
        f"the energy balance closes to {document['energy_error']:.1e}."
    ]
    if document.get("trusted_below_hz"):
        sentences.append(f"The model's modes are complete up to {document['trusted_below_hz']:.0f} Hz.")
    tables = _table(_MESHES, document.get("gear_pairs", ()), "Gear meshes")
    tables += _table(_LINES, [*_lines(document, "peaks")], "Highest lines of each sensor")
    tables += _table(_BEARINGS, document.get("bearings", ()), "Bearings")
    tables += _table(_ORDERS, document.get("run_signature", {}).get("orders", ()), "Orders along the run")
    pictures = (
        "spectrum",
        "contributions",
        "mesh-force",
        "orbits",
        "modal-coordinates",
        "friction",
        "run-up",
        "waterfall",
        "sweep",
    )
    return Section("Motion", tuple(sentences), tables, pictures)


def _lines(document: Document, key: str) -> list[dict[str, Any]]:
    rows = []
    for sensor in document.get("sensors", ()):
        for line in sensor.get(key, ())[:_LINES_OF_A_SENSOR]:
            parts = line.get("contributions", {}).get("housing_modes", ())
            rows.append({**line, "sensor": sensor["name"], "by": parts[0]["name"] if parts else None})
    return rows


def _steady(document: Document) -> Section:
    sentences: list[str] = []
    tables: tuple[Table, ...] = ()
    for motion in document["motions"]:
        stable = "stable" if motion["stable"] else "unstable"
        sentences.append(f"Period {1e3 * motion['period_s']:.6g} ms, {stable}.")
        tables += _table(_MESHES, motion["gear_pairs"])
        tables += _table(_LINES, _lines(motion, "lines"))
    tables += _table(_EVENTS, document.get("curve", {}).get("bifurcations", ()), "Over speed")
    return Section("Steady state", tuple(sentences), tables, ("steady",))
