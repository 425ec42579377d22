"""Housing modes with their proof and health, beside measured ones, and as pictures."""

import math
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from gearwhine.screen.console import counted, open_console, show_origin, show_written
from gearwhine.screen.correlation import show_shapes
from gearwhine.screen.health import show_detail, show_health


def show_modes(document: dict[str, Any]) -> None:
    """Housing modes, their certificate and the model's health."""
    console = open_console()
    _modes(console, document)
    show_written(console, document)


def show_modes_in_detail(document: dict[str, Any]) -> None:
    """The same, with effective masses, supports and the modes that matter between bearings and sensors."""
    console = open_console()
    _modes(console, document, detail=True)
    show_detail(console, document)
    show_written(console, document)


def _modes(console: Console, document: dict[str, Any], *, detail: bool = False) -> None:
    seats = any(mode["strength"] is not None for mode in document["modes"])
    table = Table("mode", "frequency [Hz]", "damping", *(["strength [1/kg]"] if seats else []), box=SIMPLE_HEAD)
    for column in table.columns:
        column.justify = "right"
    for mode in document["modes"]:
        strength = [f"{mode['strength']:.3e}"] if seats else []
        table.add_row(str(mode["number"]), f"{mode['frequency_hz']:.2f}", f"{mode['damping_ratio']:.4g}", *strength)
    console.print(table)
    modes_line(console, document)
    show_health(console, document, detail=detail)


def show_comparison(document: dict[str, Any]) -> None:
    """Measured beside model modes."""
    console = open_console()
    comparison_table(console, document)
    if "survey" in document:
        survey_lines(console, document["survey"])
    show_origin(console, document)
    show_written(console, document)


def show_files(document: dict[str, Any]) -> None:
    """What was written."""
    console = open_console()
    show_origin(console, document)
    show_written(console, document)


def comparison_table(console: Console, document: dict[str, Any]) -> None:
    """Pairs of measured and model modes, and how much the pairing is worth."""
    shapes = "auto_mac_off_diagonal" in document
    driven = any(pair["strength"] is not None for pair in document["pairs"])
    heads = ["MAC", "confidence"] if shapes else []
    heads += ["strength [1/kg]"] if driven else []
    table = Table("mode", "measured [Hz]", "model [Hz]", "error", *heads, box=SIMPLE_HEAD)
    for column in table.columns:
        column.justify = "right"
    for pair in document["pairs"]:
        cells = [f"{pair['mac']:.3f}", f"{pair['confidence']:.2f}"] if shapes else []
        cells += [f"{pair['strength']:.2e}"] if driven else []
        table.add_row(
            str(pair["mode"]),
            f"{pair['measured_hz']:.0f}",
            f"{pair['model_hz']:.1f}",
            f"{pair['error_percent']:+.2f} %",
            *cells,
        )
    console.print(table)
    if shapes:
        show_shapes(console, document)
        return
    count = document["model_modes"]
    agree = "agree" if document["measures_agree"] else "do not all agree"
    gap = document["gap"]
    distance = "no other mode in the band"
    if gap is not None and math.isfinite(gap):
        distance = f"ln {gap:.3f} (below 0.1 the choice is a coin toss)"
    console.print(
        f"Paired by {document['pairing']}: largest error {document['max_error_percent']:.2f} %, "
        f"rms {document['rms_error_percent']:.2f} %; "
        f"{counted(count['count'], 'model mode')} below {count['below_hz']:.0f} Hz."
    )
    console.print(
        f"Gap between the last chosen mode and the next: {distance}; the three measures of dominance {agree}."
    )
    console.print(
        "Such a match is weak evidence where the model was calibrated to these frequencies: see the case's notes."
    )


def show_survey(document: dict[str, Any]) -> None:
    """Where to measure, and what it is worth."""
    console = open_console()
    table = Table("point", "x [mm]", "y [mm]", "z [mm]", "direction", "independence", box=SIMPLE_HEAD)
    for column in table.columns:
        column.justify = "right"
    for row in document["sensors"]:
        cells = [f"{1e3 * value:.1f}" for value in row["position_m"]]
        table.add_row(row["point"], *cells, _direction_text(row["direction"]), f"{row['independence']:.3f}")
    console.print(table)
    console.print(
        f"{counted(len(document['sensors']), 'sensor')} of {document['candidates']} places for "
        f"{counted(len(document['modes']), 'mode')} up to {document['modes_hz'][-1]:.0f} Hz: modes look at most "
        f"{document['auto_mac_largest']:.3f} alike (auto-MAC), condition {document['condition']:.3g}."
    )
    for number, place in enumerate(document["hammer"]):
        where = ", ".join(f"{1e3 * value:.1f}" for value in place["position_m"])
        console.print(
            f"{'and' if number else 'Hammer:'} at ({where}) mm along {_direction_text(place['direction'])}: "
            f"the least excited mode has {100.0 * place['least_residue']:.2g} % of its largest driving-point residue"
        )
    show_origin(console, document)
    show_written(console, document)


def _direction_text(direction: list[float]) -> str:
    """An axis by its name, any other direction by its numbers."""
    for axis, value in zip("xyz", direction, strict=True):
        if abs(value) > 1.0 - 1e-9:
            return axis if value > 0.0 else f"-{axis}"
    return " ".join(f"{value:.3f}" for value in direction)


def survey_lines(console: Console, survey: dict[str, Any]) -> None:
    """How the measured survey lies on the model."""
    far = survey["far_points"]
    console.print(
        f"Survey: {counted(survey['points'], 'point')}, {counted(survey['degrees_of_freedom'], 'measured direction')}; "
        f"{1e3 * survey['rms_distance_m']:.3g} mm from the surface in the mean, "
        f"{1e3 * survey['worst_distance_m']:.3g} mm at worst (point {survey['worst_point']})."
    )
    if far:
        shown = ", ".join(far[:10]) + (", …" if len(far) > 10 else "")
        console.print(f"Farther than {1e3 * survey['tolerance_m']:.3g} mm: {shown}.")
    if "alignment" in survey:
        alignment = survey["alignment"]
        console.print(
            f"Aligned by {alignment['by']}, turned by {alignment['turned_degrees']:.1f}°; "
            f"{1e3 * alignment['rms_m']:.3g} mm left in the mean, {1e3 * alignment['largest_m']:.3g} mm at most."
        )
        for remark in alignment["remarks"]:
            console.print(f"Note: {remark}.")


def modes_line(console: Console, document: dict[str, Any]) -> None:
    """How many modes, how they are proved, and what they cost."""
    certificate, mesh = document["certificate"], document["mesh"]
    console.print(
        f"Housing: {counted(certificate['found'], 'mode')} below {certificate['limit_hz']:.5g} Hz, the inertia demands "
        f"{certificate['expected']}; largest residual {certificate['max_residual']:.0e}; {document['mass_kg']:.2f} kg, "
        f"{mesh['dofs']} degrees of freedom, {document['seconds']['total']:.1f} s"
    )
    show_origin(console, document)
