"""What was fitted to the measured modes, and what that is worth."""

import math
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from gearwhine.screen.console import counted, open_console, show_written


def show_update(document: dict[str, Any]) -> None:
    """Parameters, modes, what the data cannot tell apart, and the tests of the fit."""
    console = open_console()
    _parameters(console, document)
    _modes(console, document)
    _identifiability(console, document["identifiability"])
    if "held_back" in document:
        _held_back(console, document["held_back"])
    if "null" in document:
        _null(console, document)
    else:
        random = "How often random frequencies are fitted as well: --null 20. " if document["gap"] is not None else ""
        console.print(random + "Modes held back: --held-back.")
    for warning in document.get("warnings", ()):
        console.print(f"Mind: {warning['message']}.")
    show_written(console, document)


def _parameters(console: Console, document: dict[str, Any]) -> None:
    table = Table("parameter", "before", "after", "give or take", "of the prior's", "", box=SIMPLE_HEAD)
    for column in table.columns[1:5]:
        column.justify = "right"
    for row in document["parameters"]:
        unit, scale = row["unit"], row["unit_in_si"]
        was, now, give = (
            f"{value / scale:.4g} {unit}".strip() for value in (row["before"], row["after"], row["standard_deviation"])
        )
        end = "at the end of its range" if row["at_end_of_range"] else ""
        table.add_row(row["name"], was, now, give, f"{100 * row['left_of_prior_spread']:.0f} %", end)
    console.print(table)


def _modes(console: Console, document: dict[str, Any]) -> None:
    table = Table("mode", "measured [Hz]", "before [Hz]", "error", "after [Hz]", "error", box=SIMPLE_HEAD)
    for column in table.columns:
        column.justify = "right"
    for pair in document["pairs"]:
        table.add_row(
            "none" if pair["mode"] is None else str(pair["mode"]),
            f"{pair['measured_hz']:.0f}",
            _known(pair["before_hz"], ".1f"),
            _known(pair["before_error_percent"], "+.2f", " %"),
            _known(pair["model_hz"], ".1f"),
            _known(pair["error_percent"], "+.2f", " %"),
        )
    console.print(table)
    counts = document.get("model_modes")
    count = "" if counts is None else f"; {counted(counts['count'], 'model mode')} below {counts['below_hz']:.0f} Hz"
    console.print(
        f"Paired by {document['pairing']}: largest error {document['max_error_percent']:.2f} %, rms "
        f"{document['rms_error_percent']:.2f} % (before: {document['before']['rms_error_percent']:.2f} %){count}; "
        f"{_choice(document)}."
    )
    solved, mesh = document["search"], document["mesh"]
    console.print(
        f"{counted(len(solved['steps']), 'design')} solved on the way, the first on a mesh of {solved['mesh_dofs']} "
        f"degrees of freedom, verified on one of {mesh['dofs']}; {document['seconds']['total']:.0f} s."
    )


def _known(value: float | None, form: str, unit: str = "") -> str:
    return "none" if value is None else f"{value:{form}}{unit}"


def _choice(document: dict[str, Any]) -> str:
    """How clearly the modes paired are the ones that were measured."""
    if document["gap"] is None:
        values = [pair["mac"] for pair in document["pairs"]]
        alone = f", {document['wrong_pairs']} without a partner" if document["wrong_pairs"] else ""
        return f"MAC from {min(values):.2f} to {max(values):.2f}{alone}"
    agree = "agree" if document["measures_agree"] else "do not all agree"
    if not math.isfinite(document["gap"]):
        return "no mode of the band is left out of the pairs"
    return f"gap {document['gap']:.2f}, the three measures of dominance {agree}"


def _identifiability(console: Console, told: dict[str, Any]) -> None:
    learned = counted(told["learned_combinations"], "combination")
    console.print(
        f"Of {told['parameters']} parameters the data tell {learned} better than the prior did; the rest stays what "
        "was assumed."
    )
    for row in told["confounded"][:6]:
        one, other = row["parameters"]
        console.print(f"  not told apart: {one} and {other} (correlation {row['correlation']:+.2f})")


def _held_back(console: Console, rows: list[dict[str, Any]]) -> None:
    table = Table(
        "held back [Hz]", "predicted [Hz]", "error", "expected", "error before", "rms of others", box=SIMPLE_HEAD
    )
    for column in table.columns:
        column.justify = "right"
    for row in rows:
        table.add_row(
            f"{row['measured_hz']:.0f}",
            _known(row["predicted_hz"], ".1f"),
            _known(row["error_percent"], "+.2f", " %"),
            "±" + _known(row["standard_deviation_percent"], " .2f", " %"),
            _known(row["before_error_percent"], "+.2f", " %"),
            _known(row["rms_error_percent_of_the_others"], ".2f", " %"),
        )
    console.print(table)


def _null(console: Console, document: dict[str, Any]) -> None:
    null = document["null"]
    five, two, one, met, rms = (
        f"{100 * null[key]:.0f} %"
        for key in ("within_5_percent", "within_2_percent", "within_1_percent", "all_met", "as_good_in_rms")
    )
    own = null["measured_likewise"]
    console.print(
        f"Of {null['sets']} random sets of as many frequencies the same search on the coarser mesh fits {five} within "
        f"5 %, {two} within 2 % and {one} within 1 % each, and meets for {met} all that is asked for. The measured "
        f"ones come to an rms of {own['rms_error_percent']:.2f} % there, largest {own['max_error_percent']:.2f} %; "
        f"{rms} of the random sets do as well."
    )
    if null["as_good_in_rms"] > 0.05:
        console.print("So the errors alone say little of this housing: it is a plausible one, calibrated.")
