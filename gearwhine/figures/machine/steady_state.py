"""Steady-state figures: one period of the mesh forces with their lines, and the branch of motions over speed."""

from collections.abc import Iterator

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gearwhine.coupling.analyses.steady_state import SolvedSteady, SteadyMotion, spectra_of_sum
from gearwhine.coupling.periodic.continuation import ResponseCurve
from gearwhine.figures.spectra import draw_lines
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    INK,
    MICRO,
    MILLI,
    NOTE,
    RED,
    RPM,
    SERIES,
    legend_below,
    legend_height,
    name_in_legend,
    name_lowest,
    panel_pair,
    panel_title,
    sheet,
    stacked,
    stretches,
)
from gearwhine.numerics.arrays import FloatArray
from gearwhine.output.sections import arrowed, rms_of_band

_HEIGHT, _BETWEEN = 46.0, 6.0  # height of a branch's panels, and gap between them [mm]
_ROW, _ROW_GAP, _FIRST = 42.0, 18.0, 5.0  # height of a motion's rows, gaps between them and above the first [mm]
_SUM_POINTS = 2000  # times of a sum of motions
_MOST_TEETH, _FEW_TEETH = 24, 6  # largest number of mesh periods drawn, and the number drawn of longer periods
_COLUMNS = 2  # columns of the names of excitations
_UNSTABLE = (0, (3, 2))
_MARKS = {  # marker, colour of its edge, and within: folds, where a machine jumps, stand out
    "fold": ("o", RED, RED),
    "period doubling": ("s", INK, "white"),
    "Neimark-Sacker": ("D", INK, "white"),
    "branch point": ("^", INK, "white"),
}


def draw_steady(title: str, solved: SolvedSteady) -> Iterator[tuple[str, Figure]]:
    """Draw a steady state: yield ``steady-motion`` and, over speed, ``steady-curve``, each with its figure."""
    if solved.machine.meshes:
        yield "steady-motion", _motion_sheet(title, solved)
    if solved.curve is not None:
        yield "steady-curve", draw_response_curve("Steady motions over speed", solved, solved.curve, note=title)


def draw_response_curve(title: str, solved: SolvedSteady, curve: ResponseCurve, *, note: str = "") -> Figure:
    """Draw a branch: vibration in the teeth, largest force, contact loss and sensors over speed; unstable dashed."""
    remarks = [note] if note else []
    drives = [solved.machine.system.contacts[number].name for number in solved.machine.loaded_contacts]
    quantities: list[tuple[str, dict[str, FloatArray]]] = []
    if drives:
        table = dict(zip(drives, solved.machine.loaded_contacts, strict=True))
        quantities += [
            ("compression, a.c. rms [µm]", {name: MICRO * curve.rms_compression[:, i] for name, i in table.items()}),
            ("largest mesh force [N]", {name: curve.peak_force[:, i] for name, i in table.items()}),
        ]
        # The back flanks of a pair with backlash are apart nearly always; the drive flanks count.
        if curve.contact_loss[:, list(table.values())].max() > 0.0:
            quantities.append(
                ("teeth apart [%]", {name: 100.0 * curve.contact_loss[:, i] for name, i in table.items()})
            )
    if solved.branch_rms:
        quantities.append((f"acceleration, {rms_of_band([solved.motions[0].trusted_limit])} [m/s²]", solved.branch_rms))
    speeds = RPM * np.abs(curve.speeds)
    operation = RPM * abs(solved.motions[0].speed)
    remarks.append(f"{speeds.min():.0f} to {speeds.max():.0f} rpm")
    if speeds.min() <= operation <= speeds.max():
        remarks.append("dash-dotted: speed of operation")
    if curve.gaps:
        widest = max(curve.gaps, key=lambda gap: gap[1] - gap[0])
        low, high = sorted(RPM * abs(end) for end in widest)
        more = f" and {len(curve.gaps) - 1} more ranges" if len(curve.gaps) > 1 else ""
        remarks.append(f"nothing between {low:.4g} and {high:.4g} rpm{more}")
    foot = FOOT + legend_height(1)
    figure, panels = stacked(len(quantities), _HEIGHT, _BETWEEN, title, "; ".join(remarks), foot=foot)
    # Panels with the same names have them once, in the uppermost.
    legends = {tuple(lines): quantity for quantity, lines in reversed(quantities) if len(lines) > 1}
    for (quantity, lines), axes in zip(quantities, panels, strict=True):
        _draw_branch(axes, speeds, lines, curve)
        axes.axvline(operation, color=INK, lw=0.8, ls="-.", zorder=1)
        axes.set(xlim=(speeds.min(), speeds.max()), ylabel=quantity)
        axes.set_ylim(bottom=0.0)
        if legends.get(tuple(lines)) == quantity:
            axes.legend(loc="best", fontsize=NOTE, frameon=False)
    name_lowest(panels, "speed of the first driver [rpm]")
    met = {event.kind for event in curve.bifurcations}
    lines_of = [Line2D([], [], color=INK, lw=1.2, label="stable")]
    if not curve.stable.all():
        label = "unstable or not decided" if curve.settled else "unstable"
        lines_of.append(Line2D([], [], color=INK, lw=1.2, ls=_UNSTABLE, label=label))
    marks = [
        Line2D([], [], ls="", marker=marker, color=color, mfc=inside, ms=4, label=kind)
        for kind, (marker, color, inside) in _MARKS.items()
        if kind in met
    ]
    handles = [*lines_of, *marks]
    legend_below(figure, handles, len(_MARKS) + 2)
    return figure


def _draw_branch(axes: Axes, speeds: FloatArray, lines: dict[str, FloatArray], curve: ResponseCurve) -> None:
    for number, (name, values) in enumerate(lines.items()):
        color = SERIES[number % len(SERIES)]
        label = name_in_legend(name, 30)
        for piece in curve.slices:
            for run, steady in stretches(curve.stable[piece].tolist()):
                style = "-" if steady else _UNSTABLE
                axes.plot(speeds[piece][run], values[piece][run], color=color, lw=1.2, ls=style, label=label, zorder=3)
                label = "_"
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
                clip_on=False,  # whole on the axis, too: teeth that never part are at zero
            )


def _motion_sheet(title: str, solved: SolvedSteady) -> Figure:
    contacts = solved.machine.system.contacts
    drives = [contacts[number].name for number in solved.machine.loaded_contacts]
    stable = [motion for motion in solved.motions if motion.response.stable]
    machine = solved.machine
    speed = f"{machine.speed * RPM:.0f} rpm, {machine.input_torque:.4g} N·m"
    unstable = "" if len(stable) == len(solved.motions) else "; grey: unstable"
    superposed = "" if solved.superposed is None else "; superposed from the motion by each excitation"
    # Names of excitations are long, and the same in all panels: they stand once, below.
    named = [] if solved.superposed is None else [arrowed(motion.excitation) for motion in solved.motions]
    below = legend_height(len(named), _COLUMNS)
    rows, meshes = len(drives), [abs(contact.mesh_frequency) for contact in contacts[: len(machine.meshes)]]
    figure = sheet(
        HEAD + _FIRST + rows * _ROW + (rows - 1) * _ROW_GAP + FOOT + below,
        "Periodic motion: gear-mesh force",
        f"{title}, {speed}{superposed}{unstable}",
    )
    handles: list[Artist] = []
    for number, name in enumerate(drives):
        left, right = panel_pair(figure, FOOT + below + (rows - 1 - number) * (_ROW + _ROW_GAP), _ROW)
        if solved.superposed is None:
            for motion in solved.motions:
                color = BLUE if motion.response.stable else GREY
                left.plot(MILLI * motion.histories.times, motion.histories.mesh_force[name], color=color, lw=0.9)
            end, span = float(solved.motions[0].histories.times[-1]), "one period"
            # Many teeth in a row merge into an area: each needs the width of some eight lines.
            if end * meshes[number] > _MOST_TEETH:
                end, span = _FEW_TEETH / meshes[number], f"{_FEW_TEETH} mesh periods"
            left.set(xlabel="time [ms]", xlim=(0.0, MILLI * end))
            _spectrum(right, (stable or list(solved.motions))[:1], name)
        else:
            end, span = _FEW_TEETH / meshes[number], f"sum over {_FEW_TEETH} mesh periods"
            times = np.linspace(0.0, end, _SUM_POINTS)
            left.plot(MILLI * times, _sum_of(solved, name, times), color=INK, lw=0.9)
            left.set(xlabel="time [ms]", xlim=(0.0, MILLI * end))
            handles = handles or [
                Line2D([], [], color=color, lw=1.2, label=name_in_legend(motion.excitation, 40))
                for motion, color in zip(solved.motions, SERIES * len(solved.motions), strict=False)
            ]
            _spectrum(right, list(solved.motions), name)
        left.set_ylabel("mesh force [N]")
        panel_title(left, f"{name}: {span}")
    legend_below(figure, handles, _COLUMNS)
    return figure


def _sum_of(solved: SolvedSteady, name: str, times: FloatArray) -> FloatArray:
    """Return the force of a mesh under all superposed excitations at some times [s], each motion with its period."""
    forces = [
        np.interp(times, motion.histories.times, motion.histories.mesh_force[name], period=motion.response.period)
        for motion in solved.motions
    ]
    # Each motion has the mean force.
    means = [float(motion.histories.mesh_force[name].mean()) for motion in solved.motions]
    weights = np.array([motion.group.weight for motion in solved.motions])
    return np.asarray(weights @ np.array(forces) - (weights.sum() - 1) * np.mean(means))


def _spectrum(axes: Axes, motions: list[SteadyMotion], name: str) -> None:
    spectra = spectra_of_sum(motions, [motion.histories.mesh_force[name] for motion in motions])
    limit = min(1.02 * motions[0].trusted_limit, *(float(spectrum.frequencies[-1]) for spectrum in spectra))
    # The highest last: it sets the axis.
    tops = [float(spectrum.amplitude[1:].max(initial=0.0)) for spectrum in spectra]
    for number in np.argsort(tops, kind="stable"):
        draw_lines(axes, spectra[number], limit, SERIES[number % len(SERIES)] if len(motions) > 1 else BLUE)
    axes.set(xlabel="frequency [Hz]", ylabel="mesh force [N, peak]")
    panel_title(axes, "its lines")
