"""Campbell diagram of the coupled machine: modes coloured by the part that moves, shaft and mesh orders across."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from coupling import ExcitationLine, SystemCampbell
from gearwhine.figures.labels import Label, arrange, draw_row
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
    legend,
    panel,
    sheet,
    shortened,
)

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
        handles.append(
            axes.axvline(RPM * abs(operating_speed), color=INK, lw=0.8, ls="-.", zorder=1, label="operation")
        )
    legend(figure, handles)
    return figure


def _draw_branches(axes: Axes, speeds: FloatArray, campbell: SystemCampbell) -> list[str]:
    """Each branch in the colours of what moves in it; returns the kinds met, in the order of the colours."""
    met = set()
    for frequency, kinds in zip(campbell.frequencies_hz.T, campbell.kinds.T, strict=True):
        start = 0
        for end in range(1, len(kinds) + 1):
            if end < len(kinds) and kinds[end] == kinds[start]:
                continue
            if kinds[start]:
                run = slice(start, end + 1)
                met.add(str(kinds[start]))
                color = KIND_COLORS.get(str(kinds[start]), INK)
                axes.plot(speeds[run], frequency[run], color=color, lw=1.1, zorder=3, label="branch")
            start = end
    return [kind for kind in KIND_COLORS if kind in met]


def _draw_line(axes: Axes, line: ExcitationLine, last: float, top: float) -> None:
    """An order, named at its end where that is at the right of the panel."""
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
