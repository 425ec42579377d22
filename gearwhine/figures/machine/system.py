"""Coupled system figures: Campbell diagram and transmissibility.

In the Campbell diagram the modes are coloured by the part that moves, with shaft and mesh orders across. The
transmissibility gives mesh forces, bearing forces and sensors per transmission error at one mesh, over frequency.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from coupling.linear.campbell import SystemCampbell
from coupling.linear.frequency_response import FrequencyResponse
from coupling.signals.excitation import ExcitationLine
from gearwhine.case import Case, mesh_frequencies
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    HERTZ,
    INK,
    NOTE,
    PANEL_WIDTH,
    RED,
    RPM,
    SERIES,
    Label,
    arrange,
    draw_row,
    legend,
    mark_operation,
    panel,
    sheet,
    shortened,
    stretches,
)
from gearwhine.output import file_stems
from gearwhine.solve.coupled_system import SolvedSystem

FloatArray = npt.NDArray[np.float64]

KIND_COLORS = {
    "rotor": BLUE,
    "housing": SERIES[1],
    "torsion": SERIES[2],
    "mesh": RED,
    "axial": SERIES[3],
    "pedestal": SERIES[7],
    "residual": "#c9ced3",
}
_PALE_GREY = "#c3c9ce"
_HEIGHT = 105.0  # of the panel [mm]
_LARGEST = 30.0  # area of the mark of a mode whose strain is all in the teeth [points²]
_MICROMETRE = 1e-6
_RESPONSE_HEIGHT, _RESPONSE_GAP = 38.0, 4.0  # of a panel and the room between two [mm]
_DECADES = 4.0  # of amplitude that a panel shows at most
_NAMED = 8  # curves that a panel tells apart by colour


def draw_system_campbell(title: str, campbell: SystemCampbell, *, operating_speed: float | None = None) -> Figure:
    """Draw coupled modes over speed, up to the limit to which they were followed.

    Parameters
    ----------
    title
        Of the sheet.
    campbell
        The diagram.
    operating_speed
        Of the leading rotor, rad/s, drawn as a line.
    """
    note = (
        "lines: shaft orders (dotted), mesh orders (dashed); ● where a mesh order meets a mode, larger the more of its "
        "strain energy is in the teeth; ○ where a shaft order meets a bending mode"
    )
    if any(line.kind == "sideband" for line in campbell.lines):
        note = note.replace("mesh orders (dashed)", "mesh orders (dashed), their sidebands (pale)")
    speeds = RPM * np.abs(campbell.speeds)
    top, low, high = campbell.limit / HERTZ, float(speeds[0]), float(speeds[-1])
    # Orders that leave the panel at its top are named above it, the others at its right end.
    named = [line for line in campbell.lines if line.kind != "sideband"]
    leaving = [(line, 60.0 * top / line.order) for line in named if low < 60.0 * top / line.order < high]
    labels = [Label(line.name, speed, top, GREY) for line, speed in leaving]
    row = arrange(labels, [(speed - low) / (high - low) * PANEL_WIDTH for _, speed in leaving], PANEL_WIDTH)
    figure = sheet(HEAD + row.height + 2.0 + _HEIGHT + FOOT, title, note)
    axes = panel(figure, FOOT, _HEIGHT)
    axes.set(xlim=(speeds[0], speeds[-1]), ylim=(0.0, top))
    axes.set(xlabel="speed of the first driver [rpm]", ylabel="damped frequency [Hz]")
    met = _draw_branches(axes, speeds, campbell)
    for line in campbell.lines:
        _draw_line(axes, line, high, top)
    draw_row(axes, row, _HEIGHT + 1.0)
    _mark_crossings(axes, campbell)
    handles = [Line2D([], [], color=KIND_COLORS.get(kind, INK), lw=1.4, label=kind) for kind in met]
    if operating_speed is not None:
        handles.append(mark_operation(axes, operating_speed, "-."))
    legend(figure, handles)
    return figure


def _draw_branches(axes: Axes, speeds: FloatArray, campbell: SystemCampbell) -> list[str]:
    """Each branch in the colours of what moves in it; returns the kinds met, in the order of the colours."""
    met = set()
    for frequency, kinds in zip(campbell.frequencies_hz.T, campbell.kinds.T, strict=True):
        for run, kind in stretches(kinds.tolist()):
            if kind:
                met.add(kind)
                axes.plot(
                    speeds[run], frequency[run], color=KIND_COLORS.get(kind, INK), lw=1.1, zorder=3, label="branch"
                )
    return [kind for kind in KIND_COLORS if kind in met]


def _draw_line(axes: Axes, line: ExcitationLine, last: float, top: float) -> None:
    """Draw the line of an order, named at its end where that is at the right of the panel."""
    slope = line.order / 60.0
    if line.kind == "sideband":
        axes.plot([0.0, last], [0.0, slope * last], color=_PALE_GREY, lw=0.5, zorder=1.5, label=line.name)
        return
    style = ":" if line.kind == "shaft" else (0, (5, 3))
    axes.plot([0.0, last], [0.0, slope * last], color=GREY, lw=0.8, ls=style, zorder=2, label=line.name)
    if slope * last < top:
        # Low orders lie close together: their names stand beside each other.
        place = last * (0.86 if line.kind == "shaft" and round(line.order) % 2 == 0 else 1.0)
        axes.annotate(
            shortened(line.name, 34),
            (place, slope * place),
            (-2.0, 1.5),
            textcoords="offset points",
            fontsize=NOTE,
            color=GREY,
            ha="right",
            va="bottom",
            parse_math=False,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5},
        )


def _mark_crossings(axes: Axes, campbell: SystemCampbell) -> None:
    for one in campbell.crossings:
        place = (RPM * abs(one.speed), one.eigenvalue.imag / HERTZ)
        color = KIND_COLORS.get(one.kind, INK)
        if one.line.kind == "mesh" and one.kind != "residual":
            area = 9.0 + _LARGEST * min(one.teeth, 1.0)
            axes.scatter(*place, s=area, color=color, edgecolors="white", linewidths=0.4, zorder=4, label="crossing")
        elif one.line.kind == "shaft" and one.kind == "rotor":
            axes.scatter(
                *place, s=14.0, facecolors="white", edgecolors=color, linewidths=0.9, zorder=4, label="crossing"
            )


def draw_transmissibility(
    title: str, response: FrequencyResponse, *, mesh_frequencies: Sequence[float] = (), limit: float | None = None
) -> Figure:
    """Draw amplitudes by a micrometre of transmission error, over frequency.

    Parameters
    ----------
    title
        Of the sheet.
    response
        To a unit transmission error [1/m].
    mesh_frequencies
        At the speed of operation, Hz; they and their multiples are marked.
    limit
        End of the frequency axis, Hz; that of the response where not given.
    """
    frequencies = response.frequencies / HERTZ
    resultants = {name: np.linalg.norm(force, axis=1) for name, force in response.bearing_force.items()}
    panels = [
        ("mesh force [N/µm]", {name: np.abs(force) for name, force in response.mesh_force.items()}),
        ("bearing force [N/µm]", resultants),
        ("acceleration [m/s²/µm]", {name: np.abs(a) for name, a in response.sensor_acceleration.items()}),
    ]
    shown = [(what, curves) for what, curves in panels if curves]
    height = HEAD + len(shown) * (_RESPONSE_HEIGHT + _RESPONSE_GAP) + FOOT
    note = "peak amplitudes by a harmonic error of 1 µm at any frequency"
    if len(mesh_frequencies):
        note += "; dashed: mesh frequencies at operation, and multiples"
    figure = sheet(height, title, note)
    end = limit or float(frequencies[-1])
    for number, (what, curves) in enumerate(reversed(shown)):
        axes = panel(figure, FOOT + number * (_RESPONSE_HEIGHT + _RESPONSE_GAP), _RESPONSE_HEIGHT)
        _draw(axes, frequencies, curves, end)
        axes.set_ylabel(what)
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
    axes.set_yscale("log")
    inside = frequencies <= end
    top = 0.0
    for number, (name, values) in enumerate(curves.items()):
        size = _MICROMETRE * values
        top = max(top, float(size[inside].max(initial=0.0)))
        label = shortened(name, 24) if number < _NAMED else "_nolegend_"
        axes.plot(frequencies, size, color=SERIES[number % _NAMED], lw=1.0, label=label, zorder=3)
    if top > 0.0:
        least = min(
            float(_MICROMETRE * values[inside & (values > 0.0)].min(initial=np.inf)) for values in curves.values()
        )
        axes.set_ylim(max(0.7 * least, top * 10.0**-_DECADES), 2.5 * top)
    axes.legend(
        loc="lower right",
        ncols=min(len(curves), 4),
        fontsize=NOTE,
        frameon=True,
        framealpha=0.85,
        edgecolor="none",
        handlelength=1.6,
        columnspacing=1.0,
        borderaxespad=0.3,
        bbox_to_anchor=(1.0, 0.0, 0.0, PANEL_WIDTH),
    )


def draw_system(case: Case, solved: SolvedSystem) -> Iterator[tuple[str, Figure]]:
    """Draw the linear analyses of a case.

    Parameters
    ----------
    case : Case
    solved : SolvedSystem
        Of the case.

    Yields
    ------
    str
        Name of the figure: ``system-campbell`` where there is a diagram, ``transmissibility-PAIR`` for each gear pair
        that touches.
    matplotlib.figure.Figure
    """
    assert case.operation is not None
    if solved.campbell is not None:
        speed = case.operation.speed
        yield (
            "system-campbell",
            draw_system_campbell("Coupled modes over speed", solved.campbell, operating_speed=speed),
        )
    meshes = [frequency for frequency in mesh_frequencies(case) if frequency > 0.0] if case.gear_pair else []
    pairs = [one.excitation.removeprefix("transmission error of ") for one in solved.responses]
    # An arrow is no letter of a file's name.
    named = [name.replace(" -> ", "-") for name in pairs]
    for stem, name, response in zip(file_stems(named, "transmissibility-"), pairs, solved.responses, strict=True):
        limit = float(response.frequencies[-1] / (2.0 * np.pi))
        heading = f"From the transmission error of {shortened(name, 26)}"
        yield stem, draw_transmissibility(heading, response, mesh_frequencies=meshes, limit=limit)
