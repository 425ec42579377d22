"""Mode shapes over a shaft, planar bending and torsion, each on a line of its own; static deflection.

The static deflection of a rotor under its load is drawn with its bearing reactions.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearwhine.figures.rotors.assembly import RotorAssembly
from gearwhine.figures.rotors.shaft import MM, ShaftView, lay_out
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    HERTZ,
    INK,
    MICRO,
    NOTE,
    PALE,
    SERIES,
    legend,
    panel,
    sheet,
    shortened,
)
from rotors.modes.lateral import LateralModes
from rotors.modes.torsional_and_axial import TorsionalModes

FloatArray = npt.NDArray[np.float64]

_PLACES = 201  # along a shaft, besides what it carries
_HIGHEST, _LOWEST = 20.0, 7.0  # a mode's share of the height, where modes are few and where they are many [mm]
_TOGETHER = 150.0  # height of all modes, as long as none gets lower than that [mm]
_SWING = 0.42  # of a shape to either side, in shares of its mode


def draw_lateral_modes(assembly: RotorAssembly, modes: LateralModes, *, most: int | None = None) -> Figure:
    """Planar bending modes, lowest on top, with the places of bearings (as Figs. 9 and 12 of TM-101442).

    Parameters
    ----------
    assembly
        The rotor, drawn above its modes on the same axis.
    modes
        Its modes in one plane.
    most
        Largest number of modes drawn; all where not given.
    """
    z, held, loaded = _places(assembly)
    shown = modes.frequencies[:most]
    note = _note(shown.size, modes.count, "each shape over its largest displacement", held, loaded)
    # Bearings hold no torsion, so they are marked on these lines alone.
    bearings = [bearing.at for bearing in assembly.bearings]
    return _stacked(assembly, "lateral modes", note, shown, z, modes.evaluate(z)[0], held, loaded, bearings)


def draw_torsional_modes(assembly: RotorAssembly, modes: TorsionalModes, *, most: int | None = None) -> Figure:
    """Free torsional modes, the rigid rotation first; see :func:`draw_lateral_modes`."""
    z, _, loaded = _places(assembly)
    shown = modes.frequencies[:most]
    note = _note(shown.size, modes.count, "each shape over its largest rotation", np.empty(0), loaded)
    return _stacked(assembly, "torsional modes", note, shown, z, modes.evaluate(z), np.empty(0), loaded, ())


def draw_along(axes: Axes, assembly: RotorAssembly, view: ShaftView, bearings: Sequence[float]) -> None:
    """Give a panel under a shaft its axis, and lines where bearings are (m)."""
    axes.set_xlim(view.low, view.high)
    view.show_length(axes, assembly.rotor.length)
    axes.grid(visible=False)
    axes.set_xlabel("z from the left end [mm]")
    for at in bearings:
        axes.axvline(MM * at, color=PALE, lw=1.0, zorder=0.5, label="bearing")


def _places(assembly: RotorAssembly) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Places (m) along the shaft, ascending, and among them those of bearings and of discs and gears."""
    length = assembly.rotor.length
    held = np.clip([bearing.at for bearing in assembly.bearings], 0.0, length)
    loaded = np.clip([*(d.at for d in assembly.discs), *(g.at for g in assembly.gears)], 0.0, length)
    along = np.linspace(0.0, length, _PLACES)
    return np.unique(np.concatenate([along, held, loaded])), np.unique(held), np.unique(loaded)


def _note(shown: int, count: int, scale: str, held: FloatArray, loaded: FloatArray) -> str:
    parts = [f"the lowest {shown} of {count}"] if shown < count else []
    parts.append(scale)
    parts += ["○ bearings"] * bool(held.size) + ["■ discs and gears"] * bool(loaded.size)
    return "; ".join(parts)


def _stacked(
    assembly: RotorAssembly,
    kind: str,
    note: str,
    frequencies: FloatArray,
    z: FloatArray,
    shapes: FloatArray,
    held: FloatArray,
    loaded: FloatArray,
    bearings: Sequence[float],
) -> Figure:
    """Shapes (at least m, len(z)), one below the other, under the shaft."""
    outline = lay_out(assembly, labelled=False)
    count = frequencies.size
    share = float(np.clip(_TOGETHER / max(count, 1), _LOWEST, _HIGHEST))
    height = share * max(count, 1)
    title = f"Rotor {assembly.rotor.name}: {kind}"
    figure = sheet(HEAD + outline.height + height + FOOT, title, "; ".join([note, *outline.remarks]))
    upper = outline.draw(figure, FOOT + height)
    upper.spines["bottom"].set_visible(False)
    upper.tick_params(bottom=False, labelbottom=False)

    axes = panel(figure, FOOT, height)
    draw_along(axes, assembly, outline.view, bearings)
    axes.set_ylim(-count + 0.5, 0.5)
    levels = -np.arange(count, dtype=np.float64)
    axes.hlines(levels, 0.0, MM * assembly.rotor.length, color=GREY, lw=0.5, zorder=1)
    for number, (level, shape) in enumerate(zip(levels, shapes, strict=False), start=1):
        line = level + _SWING * shape / np.abs(shape).max()
        axes.plot(MM * z, line, color=BLUE, lw=1.2, zorder=2, label=f"mode {number}")
        for places, marker, face in ((held, "o", "white"), (loaded, "s", BLUE)):
            at = np.searchsorted(z, places)
            axes.plot(
                MM * places, line[at], ls="", marker=marker, color=BLUE, markerfacecolor=face, ms=3.2, mew=0.8, zorder=3
            )
    names = [f"mode {number}\n{_frequency(value)}" for number, value in enumerate(frequencies / HERTZ, start=1)]
    axes.set_yticks(levels, names)
    axes.tick_params(axis="y", length=0.0, colors=INK)
    axes.spines["left"].set_visible(False)
    return figure


def _frequency(value: float) -> str:
    if value == 0.0:
        return "rigid"
    return f"{value:.4g} Hz" if value < 1e4 else f"{1e-3 * value:.4g} kHz"


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
