"""Steady-state figures: one period of the mesh forces with their lines, and the branch of motions over speed."""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from coupling.periodic.continuation import ResponseCurve
from gearwhine.case import Case
from gearwhine.figures.spectra import draw_lines
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    INK,
    MM_PER_INCH,
    NOTE,
    RED,
    RPM,
    SERIES,
    name_in_legend,
    panel,
    sheet,
    tidy,
)
from gearwhine.solve.steady_state import SolvedSteady, SteadyMotion

FloatArray = npt.NDArray[np.float64]

_HEIGHT, _BETWEEN = 46.0, 6.0  # of the panels of a branch, and between them [mm]
_HEAD, _LEGEND = HEAD + 4.0, 8.6  # room above the panels, and the legend's place below the upper edge [mm]
_UNSTABLE = (0, (3, 2))
_MARKS = {  # marker, colour of its edge, and within: folds, where a machine jumps, stand out
    "fold": ("o", RED, RED),
    "period doubling": ("s", INK, "white"),
    "Neimark-Sacker": ("D", INK, "white"),
    "branch point": ("^", INK, "white"),
}


def draw_steady(case: Case, solved: SolvedSteady) -> Iterator[tuple[str, Figure]]:
    """Draw what was found: yields ``steady-motion`` and, over speed, ``steady-curve``, each with its figure."""
    if solved.machine.meshes:
        yield "steady-motion", _motion_sheet(case, solved)
    if solved.curve is not None:
        yield "steady-curve", draw_response_curve(f"Steady motions over speed: {case.title}", solved, solved.curve)


def draw_response_curve(title: str, solved: SolvedSteady, curve: ResponseCurve) -> Figure:
    """Draw a branch: vibration in the teeth, largest force, contact loss and sensors over speed; unstable dashed."""
    drives = [solved.machine.system.contacts[number].name for number in solved.machine.loaded_contacts]
    quantities: list[tuple[str, dict[str, FloatArray]]] = []
    if drives:
        table = dict(zip(drives, solved.machine.loaded_contacts, strict=True))
        quantities += [
            ("compression, a.c. rms [µm]", {name: 1e6 * curve.rms_compression[:, i] for name, i in table.items()}),
            ("largest mesh force [N]", {name: curve.peak_force[:, i] for name, i in table.items()}),
        ]
        if curve.contact_loss.max() > 0.0:
            quantities.append(
                ("teeth apart [%]", {name: 100.0 * curve.contact_loss[:, i] for name, i in table.items()})
            )
    if solved.branch_rms:
        quantities.append(("acceleration, rms [m/s²]", solved.branch_rms))
    note = "dash-dotted: speed of operation"
    if curve.ending != "end":
        note += f"; left at {RPM * abs(curve.speeds[-1]):.4g} rpm"
    figure = sheet(_HEAD + len(quantities) * (_HEIGHT + _BETWEEN) - _BETWEEN + FOOT, title, note)
    speeds = RPM * np.abs(curve.speeds)
    for number, (what, lines) in enumerate(reversed(quantities)):
        axes = panel(figure, FOOT + number * (_HEIGHT + _BETWEEN), _HEIGHT)
        _draw_branch(axes, speeds, lines, curve)
        axes.axvline(RPM * abs(solved.motions[0].speed), color=INK, lw=0.8, ls="-.", zorder=1)
        axes.set(xlim=(speeds.min(), speeds.max()), ylabel=what)
        axes.set_ylim(bottom=0.0)
        if number:
            axes.tick_params(labelbottom=False)
        else:
            axes.set_xlabel("speed of the first driver [rpm]")
        if len(lines) > 1:
            axes.legend(loc="best", fontsize=6.5, frameon=False)
    met = {event.kind for event in curve.bifurcations}
    lines_of = [Line2D([], [], color=INK, lw=1.2, label="stable")]
    if not curve.stable.all():
        lines_of.append(Line2D([], [], color=INK, lw=1.2, ls=_UNSTABLE, label="unstable"))
    marks = [
        Line2D([], [], ls="", marker=marker, color=color, mfc=inside, ms=4, label=kind)
        for kind, (marker, color, inside) in _MARKS.items()
        if kind in met
    ]
    handles = [*lines_of, *marks]
    # In a line of its own: a title may be long.
    figure.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(0.0, 1.0 - _LEGEND / (MM_PER_INCH * figure.get_size_inches()[1])),
        ncols=len(handles),
        frameon=False,
        fontsize=NOTE,
        handlelength=2.0,
        columnspacing=1.2,
    )
    return figure


def _draw_branch(axes: Axes, speeds: FloatArray, lines: dict[str, FloatArray], curve: ResponseCurve) -> None:
    stable = curve.stable
    for number, (name, values) in enumerate(lines.items()):
        color = SERIES[number % len(SERIES)]
        label = name_in_legend(name, 30)
        start = 0
        for end in range(1, len(stable) + 1):
            if end < len(stable) and stable[end] == stable[start]:
                continue
            run = slice(start, min(end + 1, len(stable)))
            style = "-" if stable[start] else _UNSTABLE
            axes.plot(speeds[run], values[run], color=color, lw=1.2, ls=style, label=label, zorder=3)
            label, start = "_", end
        for event in curve.bifurcations:
            marker, tint, inside = _MARKS[event.kind]
            axes.plot(
                speeds[event.index],
                values[event.index],
                marker=marker,
                color=tint,
                mfc=inside,
                ms=3.2,
                mew=0.8,
                ls="",
                zorder=4,
            )


def _motion_sheet(case: Case, solved: SolvedSteady) -> Figure:
    drives = [solved.machine.system.contacts[number].name for number in solved.machine.loaded_contacts]
    figure = Figure(figsize=(9.0, 0.7 + 2.8 * len(drives)), layout="constrained")
    rows = figure.subplots(len(drives), 2, squeeze=False)
    stable = [motion for motion in solved.motions if motion.response.stable]
    for (left, right), name in zip(rows, drives, strict=True):
        if solved.superposed is None:
            for motion in solved.motions:
                color = BLUE if motion.response.stable else GREY
                left.plot(1e3 * motion.histories.times, motion.histories.mesh_force[name], color=color, lw=0.9)
            left.set_xlabel("time [ms]")
            _spectrum(right, (stable or list(solved.motions))[:1], name)
        else:
            for motion, color in zip(solved.motions, SERIES * len(solved.motions), strict=False):
                force = motion.histories.mesh_force[name]
                part = np.arange(len(force)) / len(force)
                left.plot(part, force, color=color, lw=0.9, label=name_in_legend(motion.excitation, 40))
            left.set_xlabel("part of each motion's period")
            left.legend(loc="best", fontsize=6.5, frameon=False)
            _spectrum(right, list(solved.motions), name)
        left.set_ylabel("mesh force [N]")
        left.set_title(f"{name}: one period", fontsize=10, loc="left", parse_math=False)
        tidy(left)
        tidy(right)
    assert case.operation is not None
    speed = f"{case.operation.speed * RPM:.0f} rpm"
    grey = "" if len(stable) == len(solved.motions) else " (grey: unstable)"
    what = "periodic motion" if solved.superposed is None else "superposed motions of each excitation"
    figure.suptitle(f"{case.title}: {what} at {speed}{grey}", fontsize=11, parse_math=False)
    return figure


def _spectrum(axes: Axes, motions: list[SteadyMotion], name: str) -> None:
    spectra = [motion.spectrum(motion.histories.mesh_force[name]) for motion in motions]
    limit = min(1.02 * motions[0].trusted_limit, *(float(spectrum.frequencies[-1]) for spectrum in spectra))
    # The highest last: it sets the axis.
    tops = [float(spectrum.amplitude[1:].max(initial=0.0)) for spectrum in spectra]
    for number in np.argsort(tops, kind="stable"):
        draw_lines(axes, spectra[number], limit, SERIES[number % len(SERIES)] if len(motions) > 1 else BLUE)
    axes.set(xlabel="frequency [Hz]", ylabel="mesh force [N, peak]")
    axes.set_title("its lines", fontsize=10, loc="left")
