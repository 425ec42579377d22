"""Mode shapes over a shaft: planar bending and torsion, each mode on a line of its own."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearwhine.figures.assembly import RotorAssembly
from gearwhine.figures.shaft import lay_out
from gearwhine.figures.shaft_view import MM, ShaftView
from gearwhine.figures.style import BLUE, FOOT, GREY, HEAD, HERTZ, INK, PALE, panel, sheet
from rotors import LateralModes, TorsionalModes

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
