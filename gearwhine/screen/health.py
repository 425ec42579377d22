"""The housing's health on the terminal: its checks, effective masses, supports and dominant modes."""

from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

_SHORT = {"rotation_x": "rot x", "rotation_y": "rot y", "rotation_z": "rot z"}
_SHOWN = 1e-3  # of effective mass: less is left blank, so that what counts is seen


def show_health(console: Console, document: dict[str, Any], *, detail: bool = False) -> None:
    """What the checks found: in detail each with its value and its bound, else those beyond theirs."""
    lines = document["health"]["lines"]
    bounded = [line for line in lines if line["bound"] is not None]
    broken = [line for line in bounded if not line["ok"]]
    if detail or broken:
        console.print(_checks(lines if detail else broken))
    if not detail:
        kept = len(bounded) - len(broken)
        console.print(f"Health of the model: {kept} of {len(bounded)} checks keep their bounds (--detail shows all).")
    if error := document["static_error"]:
        console.print(static_error_line(error))


def _checks(lines: list[dict[str, Any]]) -> Table:
    table = Table("check", "value", "bound", "", "what it says", box=SIMPLE_HEAD)
    table.columns[1].justify = table.columns[2].justify = "right"
    for line in lines:
        bound = "" if line["bound"] is None else f"{line['bound']:.0e}" if line["bound"] else "0"
        verdict = "" if line["bound"] is None else "ok" if line["ok"] else "look"
        value = f"{line['value']:.0f}" if line["bound"] == 0 else f"{line['value']:.1e}"
        table.add_row(line["name"], value, bound, verdict, line["why"])
    return table


def static_error_line(error: dict[str, Any]) -> str:
    """The static compliance at the bearings in words."""
    count = error["attachments"]
    return (
        f"Static compliance at the bearings: the modes alone lack up to {100 * error['without_attachments']:.3g} %; "
        f"with {count} residual attachment{'' if count == 1 else 's'} {error['with_attachments']:.0e} of it is left."
    )


def show_detail(console: Console, document: dict[str, Any]) -> None:
    """Effective masses, what the supports hold, and the modes that carry the forces."""
    _effective_mass(console, document)
    if document["health"]["supports"]:
        _supports(console, document["health"]["supports"], document["effective_mass"]["directions"])
    if document["selection"] is not None:
        _selection(console, document["selection"])


def _effective_mass(console: Console, document: dict[str, Any]) -> None:
    mass = document["effective_mass"]
    table = Table("mode", "frequency [Hz]", *_directions(mass["directions"]), box=SIMPLE_HEAD)
    for column in table.columns:
        column.justify = "right"
    for mode in document["modes"]:
        table.add_row(str(mode["number"]), f"{mode['frequency_hz']:.2f}", *map(_part, mode["effective_mass"]))
    table.add_section()
    table.add_row("", "these modes", *map(_part, mass["captured"]))
    table.add_row("", "higher modes", *map(_part, mass["missing"]))
    if any(mass["held_by_supports"]):
        table.add_row("", "fixed patches", *map(_part, mass["held_by_supports"]))
    console.print("Effective modal mass, as a part of the whole; rotations about the centre of gravity")
    console.print(table)


def _supports(console: Console, supports: list[dict[str, Any]], directions: list[str]) -> None:
    table = Table("support", "fixes", *_directions(directions), box=SIMPLE_HEAD)
    for column in table.columns[1:]:
        column.justify = "right"
    for support in supports:
        fixes = f"{support['fixes']} of 6" if support["fixes"] else ""
        table.add_row(support["name"], fixes, *(_part(support["share"][name]) for name in directions))
    console.print("What the supports hold of the housing as a whole; shares of the springs' stiffness")
    console.print(table)


def _selection(console: Console, selection: dict[str, Any]) -> None:
    kept = len(selection["keep"])
    modes = ", ".join(str(number) for number in selection["keep"]) or "none"
    low, high = selection["band_hz"]
    console.print(
        f"From {', '.join(selection['from'])} to {', '.join(selection['to'])}, {low:.4g} to {high:.4g} Hz: "
        f"{kept} of {len(selection['ranking'])} modes carry the receptance to "
        f"{100 * selection['error_left'][kept]:.2g} % of its largest: {modes}."
    )


def _directions(names: list[str]) -> list[str]:
    return [_SHORT.get(name, name) for name in names]


def _part(value: float) -> str:
    return f"{100 * value:.1f} %" if abs(value) >= _SHOWN else ""
