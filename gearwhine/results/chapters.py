"""Chapters of the report: those parts of a command's document that are there, each by its own module."""

from collections.abc import Callable
from typing import Any

from gearwhine.output.sections import Document, Section, Table, table_of
from gearwhine.results import columns, comparison, gears, housing, rotors, update

_MOST_MODES = 60  # of the coupled system that a table holds
_LINES_OF_A_SENSOR = 6


def chapters_of(document: Document) -> tuple[Section, ...]:
    """The chapters of a command's document, those without anything left out."""
    modes = document.get("housing", document if "certificate" in document and "mesh" in document else {})
    makers: tuple[tuple[Callable[[Document], Section], Any], ...] = (
        (housing.report, modes),
        (comparison.report, document.get("compare", document if "pairing" in document else {})),
        (update.report, document if "parameters" in document else {}),
        (rotors.report, document if document.get("rotors") else {}),
        (gears.report, document if any("contact_ratio" in pair for pair in document.get("pairs", ())) else {}),
        (_system, document.get("system", document if "stability" in document else {})),
        (_transient, document if "steps" in document else {}),
        (_steady, document if "motions" in document else {}),
    )
    return tuple(make(given) for make, given in makers if given)


def _system(document: Document) -> Section:
    modes, sentences = document.get("modes", ()), []
    if stability := document.get("stability"):
        growing = len(stability["growing"])
        sentences.append("No mode grows." if stability["stable"] else f"Unstable: {growing} of the modes grow.")
    if len(modes) > _MOST_MODES:
        sentences.append(f"The lowest {_MOST_MODES} of {len(modes)} modes.")
    tables = table_of(columns.SYSTEM, modes[:_MOST_MODES])
    return Section("Coupled system", (*sentences, *tables), pictures=("campbell", "transmissibility", "system"))


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


def _steady(document: Document) -> Section:
    sentences: list[str] = []
    tables: tuple[Table, ...] = ()
    for motion in document["motions"]:
        stable = "stable" if motion["stable"] else "unstable"
        if "excitations" in motion:
            names = "; ".join(one["name"] for one in motion["excitations"])
            worst = 100.0 * max((pair["neglected_part"] for pair in motion["gear_pairs"]), default=0.0)
            sentences.append(
                f"The excitations have no short common period: each has its own motion, the other meshes linear about "
                f"their mean load, and these are superposed ({names}); {stable}. The sum leaves out at most "
                f"{worst:.2g} % of a mesh's varying force."
            )
        else:
            sentences.append(f"Period {1e3 * motion['period_s']:.6g} ms, {stable}.")
        tables += table_of(columns.MESHES, motion["gear_pairs"])
        tables += table_of(columns.LINES, _lines(motion, "lines"))
    tables += table_of(columns.EVENTS, document.get("curve", {}).get("bifurcations", ()), "Over speed")
    return Section("Steady state", (*sentences, *tables), pictures=("steady",))
