"""Harris map: transmission error over a mesh period for a range of torques, and its peak to peak over torque."""

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from coupling.gears import HarrisMap
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    HEAD,
    INK,
    LABEL,
    LEFT,
    MICRO,
    MM_PER_INCH,
    NOTE,
    PANEL_WIDTH,
    RED,
    TICK,
    legend,
    panel,
    sheet,
)

_CURVES, _SWING, _MAP_GAP = 78.0, 42.0, 12.0  # heights of the panels and the room between them [mm of paper]
_SCALE, _BESIDE, _NUMBERS = 3.0, 3.0, 13.0  # the colours' bar, the room before it and for its numbers [mm of paper]
_COLORS = colormaps["viridis"]
_BRIGHTEST = 0.92  # of the colours: yellow on white is hard to see


def draw_harris_map(title: str, harris: HarrisMap, base_radius: float, torque: float | None = None) -> Figure:
    """Draw a curve for each torque in the torque's colour, and peak to peak over torque below.

    Parameters
    ----------
    title
        Of the sheet.
    harris
        Transmission error by force and phase; two forces or more.
    base_radius
        Of the driver, which turns forces into torques, m.
    torque
        Of operation, marked in both panels where it is in the map's range, N m.

    Raises
    ------
    ValueError
        Fewer than two forces.
    """
    if harris.forces.size < 2:
        raise ValueError(f"a Harris map is drawn of two or more loads, got {harris.forces.size}")
    torques, swing = harris.forces * base_radius, MICRO * harris.peak_to_peak
    best = int(swing.argmin())
    note = f"quietest of these torques: {torques[best]:.4g} N·m with {swing[best]:.3f} µm peak to peak"
    figure = sheet(HEAD + _CURVES + _MAP_GAP + _SWING + FOOT, title, note)
    width = PANEL_WIDTH - _BESIDE - _SCALE - _NUMBERS
    upper = panel(figure, FOOT + _SWING + _MAP_GAP, _CURVES, width=width)
    lower = panel(figure, FOOT, _SWING, width=width)
    scale = Normalize(float(torques[0]), float(torques[-1]) / _BRIGHTEST)
    for load, curve in zip(torques, harris.transmission_error, strict=True):
        upper.plot(harris.phases, MICRO * curve, color=_COLORS(scale(load)), lw=1.0, label="_torque")
    upper.set(xlabel="mesh period", ylabel="transmission error [µm]", xlim=(0.0, 1.0))
    across, up = (float(inches) * MM_PER_INCH for inches in figure.get_size_inches())
    place = ((LEFT + width + _BESIDE) / across, (FOOT + _SWING + _MAP_GAP) / up, _SCALE / across, _CURVES / up)
    bar = figure.colorbar(ScalarMappable(scale, _COLORS), cax=figure.add_axes(place))
    bar.ax.set_ylim(float(torques[0]), float(torques[-1]))
    bar.ax.tick_params(labelsize=TICK, colors=INK)
    bar.set_label("torque on the driver [N·m]", size=LABEL, color=INK)

    lower.plot(torques, swing, color=BLUE, lw=1.3, marker="o", ms=2.5, label="_peak to peak")
    lower.plot(torques[best], swing[best], marker="o", ms=5.5, mfc="none", mec=INK, mew=0.9, label="_quietest")
    lower.set(xlabel="torque on the driver [N·m]", ylabel="peak to peak [µm]")
    lower.set_xlim(0.0, 1.02 * float(torques[-1]))
    lower.set_ylim(0.0, 1.1 * float(swing.max()) or 1.0)
    if torque is not None and torques[0] <= torque <= torques[-1]:
        nearest = int(np.abs(torques - torque).argmin())
        upper.plot(harris.phases, MICRO * harris.transmission_error[nearest], color=RED, lw=1.6, label="_operation")
        lower.axvline(torque, color=RED, lw=1.0, zorder=1, label="_operation")
        lower.annotate(
            f"{np.interp(torque, torques, swing):.3f} µm",
            (torque, 1.0),
            (3, -2),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            size=NOTE,
            color=RED,
            va="top",
        )
        legend(figure, [Line2D([], [], color=RED, lw=1.4, label=f"operation, {torque:.4g} N·m")])
    return figure
