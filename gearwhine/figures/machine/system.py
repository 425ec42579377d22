"""Coupled system figures: Campbell diagram, transmissibility, lines of sensors with sidebands of carriers.

The Campbell diagram colours modes by the part that moves, and shows shaft and mesh orders as lines. The
transmissibility gives mesh forces, bearing forces and sensors per transmission error at one mesh, over frequency.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gearwhine.coupling import CoupledMachine
from gearwhine.coupling.analyses.modes_and_responses import SolvedSystem
from gearwhine.coupling.linear.campbell import SystemCampbell
from gearwhine.coupling.linear.excitation_orders import ExcitationLine
from gearwhine.coupling.linear.frequency_response import FrequencyResponse
from gearwhine.coupling.linear.lines_over_speed import LinesOverSpeed
from gearwhine.coupling.linear.mesh_harmonics import ResponseParts
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    HERTZ,
    INK,
    LEFT,
    NOTE,
    RED,
    RPM,
    SERIES,
    SHEET_WIDTH,
    Label,
    arrange,
    column_width,
    draw_column,
    draw_row,
    legend,
    legend_below,
    legend_height,
    log_axis,
    mark_operation,
    name_in_legend,
    name_lowest,
    panel,
    panel_title,
    sheet,
    shortened,
    stacked,
    stretches,
)
from gearwhine.numerics.arrays import FloatArray
from gearwhine.output import file_stems
from gearwhine.output.sections import arrowed

KIND_COLORS = {
    "rotor": BLUE,
    "housing": SERIES[1],
    "torsion": SERIES[2],
    "mesh": RED,
    "axial": SERIES[3],
    "body": SERIES[5],
    "pedestal": SERIES[7],
    "residual": "#c9ced3",
}
LINE_COLORS = {"mesh harmonic": INK, "planet pass": BLUE, "sideband": RED}
"""Colours of lines by their place beside a mesh harmonic."""
_PALE_GREY = "#c3c9ce"
_HEIGHT = 105.0  # height of the panel [mm]
_LARGEST_MARK_AREA = 30.0  # area of the mark of a mode whose strain is all in the teeth [points²]
_EXPONENT_STYLE: dict[str, Any] = {"ls": "", "color": INK, "ms": 3.2, "mew": 0.6}
_SAME_PLACE = 5e-3  # part of the diagram's height within which two marks are one
_MICROMETRE = 1e-6
_RESPONSE_HEIGHT, _RESPONSE_GAP = 38.0, 2.0  # height of a panel and gap between two [mm]
_DECADES = 4.0  # decades of amplitude that a panel shows at most
_MOST_COLOURED_CURVES = 8  # number of curves that a panel distinguishes by colour
_MOST_PANELS = 4  # sensors whose lines are drawn
_NAMED_LINES = 4  # highest lines of a sensor that have their name
_ABOVE_LINES = 10.0  # top of a panel of lines over its highest one: room for names
_NAMES_APART = 0.03  # part of a panel's width that names of lines which lean alike are apart
_LINE_GAP = 9.0  # gap between two panels of lines [mm]
_COLUMNS = 4  # columns of their names above it
_MOST_ORDERS = 6  # mesh harmonics over speed that are drawn
_ORDER_COLUMNS = 4  # columns of their names below
_CAMPBELL_COLUMNS = 8  # columns of the kinds of modes below the Campbell diagram


def draw_system_campbell(title: str, campbell: SystemCampbell, *, operating_speed: float | None = None) -> Figure:
    """Draw coupled modes over speed, up to the limit to which they were followed.

    Parameters
    ----------
    title : str
        Title of the sheet.
    campbell : SystemCampbell
    operating_speed : float, optional
        Speed of the leading rotor in operation, drawn as a line [rad/s].
    """
    note = (
        "lines: shaft orders (dotted), mesh orders (dashed); ● where a mesh order meets a mode, larger the more of its "
        "strain energy is in the teeth; ○ where a shaft order meets a bending mode"
    )
    if any(line.kind == "sideband" for line in campbell.lines):
        note = note.replace("mesh orders (dashed)", "mesh orders (dashed), their sidebands (pale)")
    speeds = RPM * np.abs(campbell.speeds)
    top, low, high = campbell.limit / HERTZ, float(speeds[0]), float(speeds[-1])
    # Lines of one order, as those of equal planets' meshes, are one with one name.
    lines: dict[tuple[str, float], list[ExcitationLine]] = {}
    for line in campbell.lines:
        lines.setdefault((line.kind, line.order), []).append(line)
    # Orders that leave the panel at its top are named above it, the others beside its right end.
    above, beside = [], []
    for (kind, order), alike in lines.items():
        if kind == "sideband":
            continue
        name = arrowed(alike[0].name) + (f" and {len(alike) - 1} more" if len(alike) > 1 else "")
        leaves = 60.0 * top / order
        if leaves >= high:
            beside.append(Label(name, high, order * high / 60.0, GREY))
        elif leaves > low:
            above.append(Label(name, leaves, top, GREY))
    width = SHEET_WIDTH - LEFT - column_width(beside)
    row = arrange(above, [(label.x - low) / (high - low) * width for label in above], width)
    kinds = {kind for row_of_kinds in campbell.kinds for kind in row_of_kinds if kind}
    # Branches are of frozen carriers where these turn.
    marks = [("+", "turning carriers", campbell.exponents), ("x", "seen by sensors", campbell.observed)]
    turning = [
        Line2D([], [], marker=marker, label=label, **_EXPONENT_STYLE)
        for marker, label, values in marks
        if values is not None
    ]
    foot = FOOT + legend_height(len(kinds) + len(turning) + (operating_speed is not None), _CAMPBELL_COLUMNS)
    figure = sheet(HEAD + row.height + 2.0 + _HEIGHT + foot, title, note)
    axes = panel(figure, foot, _HEIGHT, width=width)
    axes.set(xlim=(speeds[0], speeds[-1]), ylim=(0.0, top))
    axes.set(xlabel="speed of the first driver [rpm]", ylabel="damped frequency [Hz]")
    met = _draw_branches(axes, speeds, campbell)
    _mark_exponents(axes, speeds, campbell)
    for alike in lines.values():
        _draw_line(axes, alike[0], high)
    draw_row(axes, row, _HEIGHT + 1.0)
    draw_column(axes, beside)
    _mark_crossings(axes, campbell)
    handles = [Line2D([], [], color=KIND_COLORS.get(kind, INK), lw=1.4, label=kind) for kind in met]
    handles += turning
    if operating_speed is not None:
        handles.append(mark_operation(axes, operating_speed, "-."))
    legend_below(figure, handles, _CAMPBELL_COLUMNS)
    return figure


def _draw_branches(axes: Axes, speeds: FloatArray, campbell: SystemCampbell) -> list[str]:
    """Draw each branch in the colours of its kinds; return the kinds that occur, in the order of the colours."""
    met = set()
    for frequency, kinds in zip(campbell.frequencies_hz.T, campbell.kinds.T, strict=True):
        for run, kind in stretches(kinds.tolist()):
            if kind:
                met.add(kind)
                axes.plot(
                    speeds[run], frequency[run], color=KIND_COLORS.get(kind, INK), lw=1.1, zorder=3, label="branch"
                )
    return [kind for kind in KIND_COLORS if kind in met]


def _mark_exponents(axes: Axes, speeds: FloatArray, campbell: SystemCampbell) -> None:
    """Mark the exponents with turning carriers, and where fixed sensors see their motions elsewhere."""
    turning, observed = campbell.turning_frequencies_hz, campbell.observed_hz
    if turning is None:
        return
    at = np.broadcast_to(speeds[:, None], turning.shape)
    axes.plot(at.ravel(), turning.ravel(), marker="+", label="turning", zorder=4, **_EXPONENT_STYLE)
    if observed is not None:
        apart = np.where(np.abs(observed - turning) > _SAME_PLACE * campbell.limit / HERTZ, observed, np.nan)
        axes.plot(at.ravel(), apart.ravel(), marker="x", label="observed", zorder=4, **_EXPONENT_STYLE)
        axes.vlines(at.ravel(), turning.ravel(), apart.ravel(), color=INK, lw=0.5, zorder=3.5, label="seen elsewhere")


def _draw_line(axes: Axes, line: ExcitationLine, last: float) -> None:
    ends, heights = [0.0, last], [0.0, line.order / 60.0 * last]
    if line.kind == "sideband":
        axes.plot(ends, heights, color=_PALE_GREY, lw=0.5, zorder=1.5, label=line.name)
        return
    style = ":" if line.kind == "shaft" else (0, (5, 3))
    axes.plot(ends, heights, color=GREY, lw=0.8, ls=style, zorder=2, label=line.name)


def _mark_crossings(axes: Axes, campbell: SystemCampbell) -> None:
    for crossing in campbell.crossings:
        place = (RPM * abs(crossing.speed), crossing.eigenvalue.imag / HERTZ)
        color = KIND_COLORS.get(crossing.kind, INK)
        if crossing.line.kind == "mesh" and crossing.kind != "residual":
            area = 9.0 + _LARGEST_MARK_AREA * min(crossing.teeth, 1.0)
            axes.scatter(*place, s=area, color=color, edgecolors="white", linewidths=0.4, zorder=4, label="crossing")
        elif crossing.line.kind == "shaft" and crossing.kind == "rotor":
            axes.scatter(
                *place, s=14.0, facecolors="white", edgecolors=color, linewidths=0.9, zorder=4, label="crossing"
            )


def draw_transmissibility(
    title: str, response: FrequencyResponse, *, mesh_frequencies: Sequence[float] = (), limit: float | None = None
) -> Figure:
    """Draw amplitudes by a micrometre of transmission error, over frequency.

    Parameters
    ----------
    title : str
        Title of the sheet.
    response : FrequencyResponse
        Response to a unit transmission error [1/m].
    mesh_frequencies : sequence of float
        Mesh frequencies at the speed of operation [Hz]; they and their multiples are marked.
    limit : float, optional
        End of the frequency axis [Hz]; by default that of the response.
    """
    frequencies = response.frequencies / HERTZ
    resultants = {name: np.linalg.norm(force, axis=1) for name, force in response.bearing_force.items()}
    panels = [
        ("mesh force [N/µm]", {name: np.abs(force) for name, force in response.mesh_force.items()}),
        ("bearing force [N/µm]", resultants),
        ("acceleration [m/s²/µm]", {name: np.abs(a) for name, a in response.sensor_acceleration.items()}),
    ]
    quantities = [(quantity, curves) for quantity, curves in panels if curves]
    names = [legend_height(min(len(curves), _MOST_COLOURED_CURVES), _COLUMNS) for _, curves in quantities]
    note = "peak amplitudes by a harmonic error of 1 µm alone at any frequency, without load shuttling"
    if len(mesh_frequencies):
        note += "; dashed: mesh frequencies at operation, and multiples"
    figure = sheet(HEAD + len(quantities) * (_RESPONSE_HEIGHT + _RESPONSE_GAP) + sum(names) + FOOT, title, note)
    end = limit or float(frequencies[-1])
    bottom = FOOT
    for number, ((quantity, curves), above) in enumerate(zip(reversed(quantities), reversed(names), strict=True)):
        axes = panel(figure, bottom, _RESPONSE_HEIGHT)
        bottom += _RESPONSE_HEIGHT + above + _RESPONSE_GAP
        _draw(axes, frequencies, curves, end)
        axes.set_ylabel(quantity)
        axes.set_xlim(0.0, end)
        for base in mesh_frequencies:
            for harmonic in range(1, int(end / base) + 1 if base > 0.0 else 1):
                axes.axvline(harmonic * base, color=GREY, lw=0.7, ls=(0, (4, 3)), zorder=1, label="mesh frequency")
        if number == 0:
            axes.set_xlabel("frequency [Hz]")
        else:
            axes.tick_params(labelbottom=False)
    return figure


def _draw(axes: Axes, frequencies: FloatArray, curves: Mapping[str, FloatArray], end: float) -> None:
    inside = frequencies <= end
    top = 0.0
    handles = []
    peaks = {name: float(_MICROMETRE * values[inside].max(initial=0.0)) for name, values in curves.items()}
    # What an error does not reach has no decades.
    if any(peaks.values()):
        axes.set_yscale("log")
    # Of many curves the highest have a colour and a name each.
    named = (
        curves
        if len(curves) <= _MOST_COLOURED_CURVES
        else sorted(peaks, key=lambda name: -peaks[name])[: _MOST_COLOURED_CURVES - 1]
    )
    colours = dict(zip((name for name in curves if name in named), SERIES, strict=False))
    for name, values in curves.items():
        top = max(top, peaks[name])
        colour, label = colours.get(name, GREY), name_in_legend(name, 24)
        line = axes.plot(frequencies, _MICROMETRE * values, color=colour, lw=1.0, label=label, zorder=3)
        handles += line if name in named else []
    if others := len(curves) - len(named):
        handles.append(Line2D([], [], color=GREY, lw=1.0, label=f"{others} more"))
    if top > 0.0:
        least = min(
            float(_MICROMETRE * values[inside & (values > 0.0)].min(initial=np.inf)) for values in curves.values()
        )
        axes.set_ylim(max(0.7 * least, top * 10.0**-_DECADES), 2.5 * top)
    # Above the panel, where no curve is.
    axes.legend(
        handles=handles,
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncols=min(len(handles), _COLUMNS),
        fontsize=NOTE,
        frameon=False,
        handlelength=1.6,
        columnspacing=1.0,
        borderaxespad=0.1,
    )


def draw_order_lines(over: LinesOverSpeed, *, operating_speed: float) -> Figure:
    """Draw the mesh harmonics over speed, a panel for each sensor: the highest of them, and all lines together.

    Parameters
    ----------
    over : LinesOverSpeed
        Lines of one sensor or more.
    operating_speed : float
        Speed of operation, drawn as a line [rad/s].
    """
    sensors, speeds = over.sensors[:_MOST_PANELS], RPM * np.abs(over.speeds)
    heights = np.nan_to_num(over.amplitudes).max(axis=(0, 1))
    followed = np.isfinite(over.amplitudes).any(axis=(0, 2))
    chosen = np.sort(np.argsort(-heights)[:_MOST_ORDERS])
    handles = [
        Line2D([], [], color=SERIES[place], lw=1.1, label=name_in_legend(over.causes[number], 30))
        for place, number in enumerate(chosen.tolist())
    ]
    handles.append(Line2D([], [], color=INK, lw=0.8, label="all together, rms × √2"))
    room = FOOT + legend_height(len(handles) + 1, _ORDER_COLUMNS)
    note = "peak amplitudes of mesh harmonics below the limit of the modes, linear response about the mean load"
    figure, panels = stacked(
        len(sensors), _RESPONSE_HEIGHT, _LINE_GAP, "Mesh harmonics over speed", note, first=_LINE_GAP, foot=room
    )
    for place, (sensor, axes) in enumerate(zip(sensors, panels, strict=True)):
        together = np.sqrt(2.0) * over.rms[place]
        axes.plot(speeds[followed], together[followed], color=INK, lw=0.8, zorder=2)
        for series, number in enumerate(chosen.tolist()):
            axes.plot(speeds, over.amplitudes[place, :, number], color=SERIES[series], lw=1.1, zorder=3)
        top = float(together.max())
        if top > 0.0:
            log_axis(axes, top * 10.0**-_DECADES, 1.5 * top)
        operation = mark_operation(axes, operating_speed, "-.")
        axes.set(xlim=(speeds[followed].min(), speeds[followed].max()), ylabel="acceleration [m/s²]")
        panel_title(axes, sensor)
    name_lowest(panels, "speed of the first driver [rpm]")
    legend_below(figure, [*handles, operation], _ORDER_COLUMNS)
    return figure


def draw_sensor_lines(machine: CoupledMachine, lines: Sequence[ResponseParts]) -> Figure:
    """Draw the lines of the sensors at operation: mesh harmonics and their sidebands by carriers.

    Parameters
    ----------
    machine : CoupledMachine
        Machine with sensors.
    lines : sequence of ResponseParts
        Motions at its lines, one or more.
    """
    sensors = dict(list(machine.sensor_rows.items())[:_MOST_PANELS])
    note = "peak amplitudes, linear response about the mean load; numbers: mesh harmonic, and turns of carriers off it"
    count, title = len(sensors), "Lines of the sensors"
    figure, panels = stacked(count, _RESPONSE_HEIGHT, _LINE_GAP, title, note, first=_LINE_GAP)
    frequencies = np.array([line.frequency for line in lines]) / HERTZ
    for (name, row), axes in zip(sensors.items(), panels, strict=True):
        heights = np.array([line.frequency**2 * abs(row @ line.motion) for line in lines])
        top = float(heights.max())
        least = top * 10.0**-_DECADES
        axes.set_yscale("log")
        if top > 0.0:
            axes.set_ylim(least, _ABOVE_LINES * top)
        for kind, color in LINE_COLORS.items():
            own = np.array([line.kind == kind for line in lines]) & (heights > least)
            axes.vlines(frequencies[own], least, heights[own], color=color, lw=1.4, label=kind, zorder=3)
        low, high = 0.9 * float(frequencies.min()), 1.1 * float(frequencies.max())
        named: list[tuple[int, float]] = []
        for place in np.argsort(-heights)[: 2 * _NAMED_LINES].tolist():
            if len(named) == _NAMED_LINES or heights[place] <= least:
                break
            # Names of lines below and above a harmonic lean apart; one that would stand in another is left out.
            turns = sum(number for _, number in _nearest_harmonic(lines[place])[1])
            side = 0 if turns == 0 else 1 if turns > 0 else -1
            gap = _NAMES_APART * (high - low)
            if any(abs(frequencies[place] - at) < gap * (1 if side == other else 0.5) for other, at in named):
                continue
            named.append((side, float(frequencies[place])))
            axes.annotate(
                _place_beside_harmonic(lines[place]),
                (frequencies[place], heights[place]),
                (2 * side, 3),
                textcoords="offset points",
                rotation=60 * side,
                rotation_mode="anchor",
                ha=("right", "center", "left")[1 + side],
                fontsize=NOTE,
            )
        axes.set_xlim(low, high)
        axes.set_ylabel(f"{shortened(name, 14)} [m/s²]")
    name_lowest(panels, "frequency [Hz]")
    legend(figure, panels[0].get_legend_handles_labels()[0])
    return figure


def _place_beside_harmonic(line: ResponseParts) -> str:
    """Mesh harmonic of a line and the turns of carriers that it is off it, such as ``1 +3``."""
    harmonic, turns = _nearest_harmonic(line)
    return f"{harmonic}{''.join(f' {number:+g}' for _, number in turns)}"


def _nearest_harmonic(line: ResponseParts) -> tuple[int, tuple[tuple[str, float], ...]]:
    """Mesh harmonic that a line is the fewest turns of carriers off, and these."""
    rows = [(harmonic, one.turns) for (_, harmonic), one in zip(line.causes, line.sidebands, strict=True)]
    return min(rows, key=lambda row: sum(abs(number) for _, number in row[1]))


def draw_system(solved: SolvedSystem) -> Iterator[tuple[str, Figure]]:
    """Draw the linear analyses of a machine.

    Parameters
    ----------
    solved : SolvedSystem

    Yields
    ------
    str
        Name of the figure: ``system-campbell`` where there is a diagram, ``transmissibility-PAIR`` for each gear pair
        that touches, ``system-order-lines`` where sensors have lines over speed, ``system-lines`` where carriers turn
        and sensors have lines.
    matplotlib.figure.Figure
    """
    if solved.campbell is not None:
        yield (
            "system-campbell",
            draw_system_campbell("Coupled modes over speed", solved.campbell, operating_speed=solved.speed),
        )
    contacts = solved.machine.system.contacts[: len(solved.machine.meshes)]
    meshes = [abs(contact.mesh_frequency) for contact in contacts if contact.mesh_frequency != 0.0]
    pairs = [response.excitation.removeprefix("transmission error of ") for response in solved.responses]
    # An arrow is no letter of a file's name.
    named = [name.replace(" -> ", "-") for name in pairs]
    for stem, name, response in zip(file_stems(named, "transmissibility-"), pairs, solved.responses, strict=True):
        limit = float(response.frequencies[-1] / (2.0 * np.pi))
        heading = f"From the transmission error of {shortened(arrowed(name), 30)}"
        yield stem, draw_transmissibility(heading, response, mesh_frequencies=meshes, limit=limit)
    if solved.order_lines is not None:
        yield "system-order-lines", draw_order_lines(solved.order_lines, operating_speed=solved.speed)
    if any(line.sidebands for line in solved.lines) and solved.machine.sensor_rows:
        yield "system-lines", draw_sensor_lines(solved.machine, solved.lines)
