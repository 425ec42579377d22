"""What measured shapes say below the table of pairs: what is missing, double, close or alike; if the survey serves."""

import math
from typing import Any

from rich.console import Console

from gearwhine.screen.console import counted

_POOR = 0.3  # MACs between different modes from which on a survey is said to confuse them
_REAL = 0.9  # modal phase collinearity below which a shape is said to be complex


def show_shapes(console: Console, document: dict[str, Any]) -> None:
    """Sentences below the table of a comparison by shapes."""
    count = document["model_modes"]
    held = counted(count["count"], "model mode")
    if document["pairs"]:
        console.print(
            f"Paired by {document['pairing']}: largest error {document['max_error_percent']:.2f} %, "
            f"rms {document['rms_error_percent']:.2f} %; {held} below {count['below_hz']:.0f} Hz."
        )
        console.print(
            "Confidence: what the best assignment loses without the pair, as a part of its score; no probability."
        )
    else:
        console.print(f"Paired by {document['pairing']}: no measured mode is like one of {held}.")
    for mode in document["unpaired_measured"]:
        console.print(
            f"Measured mode {mode['measured_mode']} ({mode['measured_hz']:.0f} Hz) has no partner: most like mode "
            f"{mode['most_like']}, MAC {mode['mac']:.2f}."
        )
    if document["unpaired_model"]:
        names = ", ".join(f"{mode['mode']} ({mode['model_hz']:.0f} Hz)" for mode in document["unpaired_model"])
        console.print(f"Model modes in the measured band that no measured mode is: {names}.")
    for pair in document["duplicates"]:
        console.print(f"Measured modes {_both(pair)} may be one mode found twice (MAC {pair['mac']:.2f}).")
    for whose, pairs in document["look_alikes"].items():
        for pair in pairs:
            console.print(
                f"The survey cannot tell {whose} modes {_both(pair)} apart (MAC {pair['mac']:.2f}): "
                "it needs more points."
            )
    for group in document["close_modes"]:
        angle = group["largest_angle_deg"]
        apart = "" if angle is None or math.isnan(angle) else f", largest angle {angle:.1f}°"
        console.print(
            f"Modes {_listed(group['modes'])} are close and compared as one space: measured "
            f"{_listed(group['measured_modes'])}{apart}."
        )
    worst = document["auto_mac_off_diagonal"]
    remark = "; a survey with more points would tell modes apart better" if worst["model"] > _POOR else ""
    console.print(
        f"Largest MAC between different modes: {worst['measured']:.2f} of the test, {worst['model']:.2f} of the model"
        f"{remark}."
    )
    bent = [number for number, value in enumerate(document["phase_collinearity"], start=1) if value < _REAL]
    if bent:
        console.print(f"Complex shapes (phase collinearity below {_REAL:g}): measured {_listed(bent)}.")
    _show_responses(console, document.get("responses"))
    if document["cross_orthogonality"]["missing_because"]:
        console.print(f"No cross-orthogonality: {document['cross_orthogonality']['missing_because']}.")


def _show_responses(console: Console, responses: dict[str, Any] | None) -> None:
    if responses is None:
        return
    if "missing_because" in responses:
        console.print(f"No likeness of responses: {responses['missing_because']}.")
    elif responses["mean"] is not None:
        values = [value for row in responses["frac"] for value in row if value is not None]
        console.print(
            f"Likeness of {counted(len(values), 'response')} over {responses['lines']} lines from "
            f"{responses['from_hz']:.0f} to {responses['to_hz']:.0f} Hz (FRAC): mean {responses['mean']:.2f}, from "
            f"{min(values):.2f} to {max(values):.2f}; a resonance a few per cent off costs most of it."
        )


def _both(pair: dict[str, Any]) -> str:
    return " and ".join(str(number) for number in pair["modes"])


def _listed(numbers: list[int]) -> str:
    return ", ".join(str(number) for number in numbers)
