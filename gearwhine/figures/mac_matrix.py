"""Correlation matrix such as the MAC: a cell for each two modes, its number where it fits, pairs outlined."""

from collections.abc import Collection, Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.axis import Axis
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from gearwhine.figures.style import (
    BLUE,
    FOOT,
    HEAD,
    INK,
    LABEL,
    MM_PER_INCH,
    NOTE,
    RED,
    SHEET_WIDTH,
    TICK,
    panel,
    sheet,
)

FloatArray = npt.NDArray[np.float64]

_COLORS = LinearSegmentedColormap.from_list("likeness", ["#ffffff", "#cfdeec", BLUE, "#0b2540"])
_LEFT, _BESIDE, _SCALE, _NUMBERS = 24.0, 3.0, 3.0, 11.0  # beside the cells: row names, gap, colours, their numbers [mm]
_BELOW = 11.0  # for the columns' names, which stand [mm]
_CELL, _LEAST_CELL, _TALLEST = 9.0, 2.6, 190.0  # a cell's largest and least height, and the most of all [mm]
_FITS = (4.2, 2.8)  # a cell from which on a number of two digits can be read in it [mm]
_NOTHING = 0.05  # values below it are left blank
_DARK = 0.5  # values above it are written in white


def draw_mac_matrix(
    title: str,
    values: FloatArray,
    rows: Sequence[str],
    columns: Sequence[str],
    *,
    outlined: Collection[tuple[int, int]] = (),
    axes_named: tuple[str, str] = ("model mode", "measured mode"),
    named: str = "MAC",
    note: str = "",
) -> Figure:
    """Draw a matrix of values from 0 to 1, its first row at the bottom.

    Parameters
    ----------
    title, note
        Of the sheet.
    values
        (n, m).
    rows, columns
        Names of modes, such as ``3  1049 Hz``.
    outlined
        Cells of pairs: row and column from 0.
    axes_named
        Titles of rows and columns.
    named
        Name of the values.

    Raises
    ------
    ValueError
        Names that do not fit the values, or no values.
    """
    if values.shape != (len(rows), len(columns)) or values.size == 0:
        raise ValueError(f"{len(rows)} and {len(columns)} names for values of shape {values.shape}")
    room = SHEET_WIDTH - _LEFT - _BESIDE - _SCALE - _NUMBERS
    high = float(np.clip(_TALLEST / len(rows), _LEAST_CELL, _CELL))
    wide = min(room / len(columns), 1.6 * high)
    width, height = wide * len(columns), high * len(rows)
    figure = sheet(HEAD + height + _BELOW + FOOT, title, note)
    axes = panel(figure, FOOT + _BELOW, height, left=_LEFT, width=width)
    axes.grid(visible=False)
    scale = Normalize(0.0, 1.0)
    axes.pcolormesh(values, cmap=_COLORS, norm=scale, edgecolors="white", linewidth=0.3)
    for row, column in outlined:
        axes.add_patch(Rectangle((column, row), 1.0, 1.0, fill=False, edgecolor=RED, lw=1.2, zorder=4))
    if wide >= _FITS[0] and high >= _FITS[1]:
        for (row, column), value in np.ndenumerate(values):
            if value >= _NOTHING:
                color, size = "white" if value > _DARK else INK, min(1.05 * wide, 5.5)
                text = f"{value:.2f}"
                axes.text(column + 0.5, row + 0.5, text, ha="center", va="center", size=size, color=color)
    _name(axes.xaxis, columns, wide, upright=True)
    _name(axes.yaxis, rows, high, upright=False)
    axes.tick_params(length=0.0)
    axes.set(xlabel=axes_named[1], ylabel=axes_named[0])
    axes.yaxis.set_label_coords(-(_LEFT - 3.0) / width, 0.5)
    across, up = (float(inches) * MM_PER_INCH for inches in figure.get_size_inches())
    place = ((_LEFT + width + _BESIDE) / across, (FOOT + _BELOW) / up, _SCALE / across, height / up)
    bar = figure.colorbar(ScalarMappable(scale, _COLORS), cax=figure.add_axes(place))
    bar.ax.tick_params(labelsize=TICK, colors=INK)
    bar.set_label(named, size=LABEL, color=INK)
    return figure


def _name(axis: Axis, names: Sequence[str], size: float, *, upright: bool) -> None:
    """Names in the middles of the cells, every other one or fewer where they would touch."""
    step = max(int(np.ceil(2.6 / size)), 1)
    places = range(0, len(names), step)
    axis.set_ticks([place + 0.5 for place in places])
    axis.set_ticklabels([names[place] for place in places], size=NOTE, rotation=90.0 if upright else 0.0)
