"""Chapters of the report: those parts of a command's document that are there, each by its own module."""

from collections.abc import Callable
from typing import Any

from gearwhine.output.sections import Document, Section, table_of
from gearwhine.results import columns, gears, rotors, run, steady, sweep, system


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
        (run.report, document if "steps" in document else {}),
        (sweep.report, document if "points" in document and "axes" in document else {}),
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
