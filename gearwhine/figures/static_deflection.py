"""Static deflection of a rotor under its load, and its bearing reactions."""

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.figure import Figure

from gearwhine.figures.assembly import RotorAssembly
from gearwhine.figures.mode_shapes import draw_along
from gearwhine.figures.shaft import lay_out
from gearwhine.figures.shaft_view import MM
from gearwhine.figures.style import BLUE, FOOT, GREY, HEAD, INK, MICRO, NOTE, SERIES, legend, panel, sheet, shortened

FloatArray = npt.NDArray[np.float64]

_HEIGHT = 60.0  # of the panel [mm of paper]
_ARROW = 0.26  # of the panel's height, for the largest load
_WORD, _EDGE = 0.08, 0.03  # ... for what a load is called, and beside all [of the height]
_NEGLIGIBLE = 1e-6  # of the deflection in y: less in x is not drawn


def draw_static_deflection(
    assembly: RotorAssembly,
    z: npt.ArrayLike,
    deflection: npt.ArrayLike,
    bearing_loads: npt.ArrayLike,
) -> Figure:
    """Draw the deflected centre line under the shaft, with each bearing's force on the rotor as an arrow.

    Parameters
    ----------
    assembly
        The rotor.
    z
        (n,): ascending places, m from the left end.
    deflection
        (n, 2): in x and y there, m; y is up.
    bearing_loads
        (b, 2): force of each bearing on the rotor in x and y, N, in the order of the assembly's bearings. The
        arrows show y; the labels give the magnitude where x bears a part.

    Raises
    ------
    ValueError
        Arrays whose shapes do not fit.
    """
    places, moved = np.asarray(z, dtype=np.float64), np.asarray(deflection, dtype=np.float64)
    loads = np.asarray(bearing_loads, dtype=np.float64).reshape(-1, 2)
    if moved.shape != (places.size, 2) or len(loads) != len(assembly.bearings):
        raise ValueError(
            f"deflection {moved.shape} and bearing loads {loads.shape} are not ({places.size}, 2) and "
            f"({len(assembly.bearings)}, 2)"
        )
    outline = lay_out(assembly, labelled=False)
    title = f"Rotor {shortened(assembly.rotor.name, 20)}: static deflection and bearing loads"
    carried = f"bearings carry {np.linalg.norm(loads.sum(axis=0)):.5g} N"
    figure = sheet(HEAD + outline.height + _HEIGHT + FOOT, title, "; ".join([carried, *outline.remarks]))
    upper = outline.draw(figure, FOOT + _HEIGHT)
    upper.spines["bottom"].set_visible(False)
    upper.tick_params(bottom=False, labelbottom=False)

    axes = panel(figure, FOOT, _HEIGHT)
    draw_along(axes, assembly, outline.view, [bearing.at for bearing in assembly.bearings])
    axes.axhline(0.0, color=GREY, lw=0.5, zorder=1)
    largest = float(np.abs(moved).max(initial=0.0))
    curves: list[Artist] = []
    for column, name in ((1, "y"), (0, "x")):
        if np.abs(moved[:, column]).max(initial=0.0) > _NEGLIGIBLE * largest or column == 1:
            color = BLUE if column else SERIES[1]
            curves += axes.plot(MM * places, MICRO * moved[:, column], color=color, lw=1.3, zorder=3, label=name)
    low, high = min(0.0, MICRO * float(moved.min())), max(0.0, MICRO * float(moved.max()))
    span = (high - low) or 1.0
    # Room for the longest arrow and what it is called, below the line and, where a bearing pulls down, above it.
    upward, downward = bool((loads[:, 1] >= 0.0).any()), bool((loads[:, 1] < 0.0).any())
    height = span / (1.0 - (_ARROW + _WORD) * (upward + downward) - 2.0 * _EDGE)
    below, above = (_EDGE + (_ARROW + _WORD) * present for present in (upward, downward))
    axes.set_ylim(low - below * height, high + above * height)
    strongest = float(np.abs(loads[:, 1]).max(initial=0.0)) or 1.0
    arrow = {"arrowstyle": "-|>,head_width=0.16,head_length=0.4", "color": INK, "lw": 1.0, "shrinkA": 0, "shrinkB": 0}
    for bearing, load in zip(assembly.bearings, loads, strict=True):
        tip = MICRO * float(np.interp(bearing.at, places, moved[:, 1]))
        tail = tip - _ARROW * height * float(load[1]) / strongest
        axes.annotate("", (MM * bearing.at, tip), (MM * bearing.at, tail), arrowprops=arrow, zorder=4)
        axes.annotate(
            f"{np.linalg.norm(load):.4g} N",
            (MM * bearing.at, tail),
            (0.0, -2.0 if load[1] >= 0.0 else 2.0),
            textcoords="offset points",
            fontsize=NOTE,
            color=INK,
            ha="center",
            va="top" if load[1] >= 0.0 else "bottom",
        )
    axes.set_ylabel("deflection [µm]")
    if len(curves) > 1:
        legend(figure, curves)
    return figure
