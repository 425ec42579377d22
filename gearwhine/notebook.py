"""Display in notebooks: cases, studies, machines, housing modes and results as tables.

Studies and results show themselves (``_repr_html_``). The library's own objects know nothing of HTML: where gearwhine
is imported under IPython, :func:`register` gives them a formatter there.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from gearwhine.output.quantity import RPM
from gearwhine.output.report.elements import fragment
from gearwhine.output.sections import Column, Finding, Section, table_of

if TYPE_CHECKING:
    from gearwhine.case import Case
    from gearwhine.coupling import Machine
    from gearwhine.housing import HousingModes

_MM = 1e3
_MOST_MODES = 30

_MODES = (
    Column("mode", "number"),
    Column("frequency [Hz]", "frequency_hz", ".1f"),
    Column("damping ratio [%]", "damping_ratio", ".3g", 100.0),
)


def register() -> None:
    """Give IPython, where it runs, formatters for machines, housing modes and cases."""
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    if shell is None:
        return
    formatter = shell.display_formatter.formatters["text/html"]
    formatter.for_type_by_name("gearwhine.coupling.machine_description", "Machine", machine_html)
    formatter.for_type_by_name("gearwhine.housing.housing", "HousingModes", modes_html)
    formatter.for_type_by_name("gearwhine.case.model", "Case", case_html)


def case_html(case: Case) -> str:
    """Return the machine of a case, as the first page of a report has it."""
    from gearwhine.results.first_page import machine_section

    section = machine_section(case)
    return fragment([Section(case.title or section.title, section.content)])


def result_html(command: str, title: str, document: dict[str, Any]) -> str:
    """Return the warnings and chapters of a command's document, as the report has them."""
    from gearwhine.results import chapters_of

    warnings = tuple(Finding(str(entry["message"]), passed=False) for entry in document["warnings"])
    head = Section("", (f"gearwhine {command}: {title}", *warnings))
    return fragment([head, *chapters_of(document | {"command": command})])


def machine_html(machine: Machine) -> str:
    """Return the shafts and gear pairs of a machine, with their speeds and mesh frequencies."""
    from gearwhine.results.first_page import PAIR_COLUMNS, SHAFT_COLUMNS

    shafts = [
        {
            "name": shaft.name,
            "speed_rpm": machine.speeds[shaft.name] * RPM,
            "length_mm": _MM * shaft.rotor.length,
            "mass_kg": float(shaft.rotor.mass),
            "bearings": ", ".join(mounted.bearing.name for mounted in machine.bearings if mounted.rotor == shaft.name),
            "gears": ", ".join(entry.gear.name for entry in machine.gears if entry.shaft == shaft.name),
        }
        for shaft in machine.shafts
    ]
    geometries: Sequence[Any] = machine.pair_geometries
    pairs = [
        {
            "name": f"{pair.driver} → {pair.driven}",
            "teeth": f"{geometry.driver.teeth} : {geometry.driven.teeth}",
            "ratio": abs(float(geometry.ratio)),
            "contact_ratio": float(geometry.total_contact_ratio),
            "mesh_frequency_hz": float(frequency),
        }
        for pair, geometry, frequency in zip(machine.gear_pairs, geometries, machine.mesh_frequencies, strict=True)
    ]
    stand = "in a housing" if machine.housing is not None else "on the ground"
    operation = f"{machine.speed * RPM:.5g} rpm, {machine.torque:.5g} N·m; bearings {stand}"
    return fragment([Section("", (operation, *table_of(SHAFT_COLUMNS, shafts), *table_of(PAIR_COLUMNS, pairs)))])


def modes_html(modes: HousingModes) -> str:
    """Return the lowest natural frequencies of a housing, and the certificate of all."""
    certificate = modes.modes.certificate
    rows = [
        {"number": number, "frequency_hz": float(frequency), "damping_ratio": float(ratio)}
        for number, (frequency, ratio) in enumerate(
            zip(modes.frequencies_hz, modes.total_damping_ratios, strict=True), start=1
        )
    ]
    count = len(rows)
    proof = Finding(
        f"{certificate.found} modes found, {certificate.expected} counted by the matrix's inertia",
        passed=certificate.complete,
    )
    more = (f"and {count - _MOST_MODES} more",) if count > _MOST_MODES else ()
    return fragment([Section("", (proof, *table_of(_MODES, rows[:_MOST_MODES]), *more))])
