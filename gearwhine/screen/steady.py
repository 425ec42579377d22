"""The steady state on the terminal: motions at the speed of operation, and what happens over speed."""

from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from gearwhine.screen.console import counted, line_text, open_console, percent, show_origin, show_written

_EVENTS = {
    "fold": "the motion jumps to another one",
    "period doubling": "the motion is taken over by one of twice the period",
    "Neimark-Sacker": "a second frequency comes in",
}
# A multiplier beyond +1 alone tells no fold: over many mesh periods it may be an even power of one beyond -1.
_UNSTABLE = {**_EVENTS, "fold": "disturbances grow without turning, the motion leaves for another one"}


def show_steady(document: dict[str, Any]) -> None:
    """What repeats, whether it is stable, and the events of a branch."""
    console = open_console()
    console.print(document["title"], style="bold")
    motions = document["motions"]
    superposed = document.get("method") == "superposed"
    what = "steady motion" if superposed else "periodic motion"
    console.print(
        f"{counted(len(motions), what)} at {document['speed_rpm']:.0f} rpm; {document['coordinates']} modal coordinates"
    )
    for number, motion in enumerate(motions, start=1):
        _show_motion(console, motion, f"Motion {number}: " if len(motions) > 1 else "")
    if curve := document.get("curve"):
        show_curve(console, curve)
    show_origin(console, document)
    show_written(console, document)


def _show_motion(console: Console, motion: dict[str, Any], name: str) -> None:
    if "excitations" in motion:
        console.print(
            "The excitations have no short common period: each has its own motion, other meshes linear about their "
            "mean load, and these are superposed"
        )
        for one in motion["excitations"]:
            _show_proof(console, one, f"  {one['name']}: ")
        for pair in motion["gear_pairs"]:
            console.print(
                f"  left out in {pair['driver']} → {pair['driven']}: {pair['neglected_force_n']:.3g} N rms, "
                f"{percent(pair['neglected_part'])} of its varying force"
            )
    else:
        _show_proof(console, motion, name)
    for pair in motion["gear_pairs"]:
        console.print(
            f"Gear mesh {pair['driver']} → {pair['driven']}: mean force {pair['mean_force_n']:.0f} N, "
            f"peak {pair['peak_force_n']:.0f} N, apart {percent(pair['contact_loss_fraction'])} of the time"
        )
    if motion["sensors"]:
        table = Table("sensor", "rms [m/s²]", "highest lines: Hz (m/s², peak)", box=SIMPLE_HEAD)
        table.columns[1].justify = "right"
        for sensor in motion["sensors"]:
            lines = "  ".join(line_text(line) for line in sensor["lines"][:5])
            table.add_row(sensor["name"], f"{sensor['rms_m_per_s2']:.3g}", lines)
        console.print(table)


def _show_proof(console: Console, motion: dict[str, Any], name: str) -> None:
    if motion["stable"]:
        stability = f"stable, disturbances fall by {motion['largest_multiplier']:.4g} each period"
    else:
        stability = f"unstable: {_UNSTABLE.get(motion['instability'] or '', 'disturbances grow')}"
    console.print(
        f"{name}period {1e3 * motion['period_s']:.6g} ms, {stability}; closes to {motion['residual']:.0e}, "
        f"changes by {motion['error']:.0e} with elements half as long",
        markup=False,
    )


def show_curve(console: Console, curve: dict[str, Any]) -> None:
    """The branch over speed: how far it was followed, the largest forces, what happens along it."""
    speeds = curve["speed_rpm"]
    unstable = sum(not stable for stable in curve["stable"])
    console.print(
        f"Followed from {speeds[0]:.0f} to {speeds[-1]:.0f} rpm in {counted(len(speeds), 'point')}, "
        f"{unstable} of them unstable"
    )
    if curve["ending"] != "end":
        console.print(f"[yellow]Left before the end of the range:[/yellow] {curve['account']}", highlight=False)
    for pair in curve["gear_pairs"]:
        worst = max(range(len(speeds)), key=pair["peak_force_n"].__getitem__)
        console.print(
            f"Gear mesh {pair['driver']} → {pair['driven']}: largest force {pair['peak_force_n'][worst]:.0f} N at "
            f"{speeds[worst]:.0f} rpm"
        )
    for event in curve["bifurcations"]:
        console.print(
            f"{event['speed_rpm']:9.1f} rpm: {event['kind']}; {_EVENTS.get(event['kind'], 'stability changes')}"
        )
