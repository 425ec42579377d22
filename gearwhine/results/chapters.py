"""Chapters of the report: those parts of a command's document that are there, each by its own module."""

from collections.abc import Callable
from typing import Any

from gearwhine.output.sections import Document, Section, Table, table_of
from gearwhine.results import columns, gears, rotors, steady, system

_LINES_OF_A_SENSOR = 6


def chapters_of(document: Document) -> tuple[Section, ...]:
    """The chapters of a command's document, those without anything left out."""
    housing = document.get("housing", document if "certificate" in document and "mesh" in document else {})
    makers: tuple[tuple[Callable[[Document], Section], Any], ...] = (
        (_housing, housing),
        (_comparison, document.get("compare", document if "pairing" in document else {})),
        (_update, document if "parameters" in document else {}),
        (rotors.report, document if document.get("rotors") else {}),
        (gears.report, document if any("contact_ratio" in pair for pair in document.get("pairs", ())) else {}),
        (system.report, document.get("system", document if "stability" in document else {})),
        (_transient, document if "steps" in document else {}),
        (steady.report, document if "motions" in document else {}),
    )
    return tuple(make(given) for make, given in makers if given)


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
    tables = table_of(columns.MODES, document.get("modes", ()))
    return Section("Housing modes", (*sentences, *tables), pictures=("modes", "mode-", "gallery"))


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
    tables = table_of(columns.PAIRS, document.get("pairs", ()))
    return Section("Measured and modelled", (*sentences, *tables), pictures=pictures)


def _update(document: Document) -> Section:
    before, learned = document["before"], document["identifiability"]
    sentences = [
        f"Before: {before['rms_error_percent']:.2f} % root mean square, {before['max_error_percent']:.2f} % at most.",
        f"The data tell {learned['learned_combinations']} combinations of the {learned['parameters']} numbers better "
        "than the prior.",
    ]
    if null := document.get("null"):
        own = null["measured_likewise"]
        sentences.append(
            f"Of {null['sets']} random sets of as many frequencies the same search on the coarser mesh fits "
            f"{100 * null['within_5_percent']:.0f} % within 5 %, {100 * null['within_2_percent']:.0f} % within 2 % "
            f"and {100 * null['within_1_percent']:.0f} % within 1 % each, and meets for "
            f"{100 * null['all_met']:.0f} % all that is asked for."
        )
        sentences.append(
            f"The measured ones come there to {own['rms_error_percent']:.2f} % root mean square, "
            f"{own['max_error_percent']:.2f} % at most; "
            f"{100 * null['as_good_in_rms']:.0f} % of the random sets do as well."
        )
    else:
        sentences.append("Not known is how often random frequencies are fitted as well (--null).")
    tables = table_of(columns.PARAMETERS, document["parameters"])
    tables += table_of(columns.HELD_BACK, document.get("held_back", ()), "Each mode predicted by a fit to the others")
    return Section("Updated numbers", (*sentences, *tables), pictures=("update",))


def _transient(document: Document) -> Section:
    sentences = [
        f"{document['steps']} steps at {document['speed_rpm']:.0f} rpm, {document['coordinates']} modal coordinates; "
        f"the energy balance closes to {document['energy_error']:.1e}."
    ]
    if document.get("trusted_below_hz"):
        sentences.append(f"The model's modes are complete up to {document['trusted_below_hz']:.0f} Hz.")
    sentences += _basis_error(document)
    tables = table_of(columns.MESHES, document.get("gear_pairs", ()), "Gear meshes")
    tables += table_of(columns.LINES, [*_lines(document, "peaks")], "Highest lines of each sensor")
    tables += table_of(columns.BEARINGS, document.get("bearings", ()), "Bearings")
    tables += table_of(columns.ORDERS, document.get("run_signature", {}).get("orders", ()), "Orders along the run")
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
    return Section("Motion", (*sentences, *tables), pictures=pictures)


def _basis_error(document: Document) -> list[str]:
    """The error that the modal basis may leave in responses, at worst in each band."""
    parts = []
    for band in document.get("basis_error", ()):
        worst = max((sensor["largest"] for sensor in band["sensors"]), default=0.0)
        parts.append(f"{100.0 * worst:.2g} % up to {band['to_hz']:.0f} Hz")
    return [f"Error left by the modal basis, at the worst sensor and frequency: {', '.join(parts)}."] if parts else []


def _lines(document: Document, key: str) -> list[dict[str, Any]]:
    rows = []
    for sensor in document.get("sensors", ()):
        for line in sensor.get(key, ())[:_LINES_OF_A_SENSOR]:
            parts = line.get("contributions", {}).get("housing_modes", ())
            rows.append({**line, "sensor": sensor["name"], "by": parts[0]["name"] if parts else None})
    return rows
