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


def modes_line(console: Console, document: dict[str, Any]) -> None:
    """How many modes, how they are proved, and what they cost."""
    certificate, mesh = document["certificate"], document["mesh"]
    console.print(
        f"Housing: {counted(certificate['found'], 'mode')} below {certificate['limit_hz']:.5g} Hz, the inertia demands "
        f"{certificate['expected']}; largest residual {certificate['max_residual']:.0e}; {document['mass_kg']:.2f} kg, "
        f"{mesh['dofs']} degrees of freedom, {document['seconds']['total']:.1f} s"
    )
    show_origin(console, document)
