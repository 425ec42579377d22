"""Mode shapes over a shaft: planar bending, torsion and static deflection as lines, whirl as orbits, axial as arrows.

Planar modes stand on a line each; the static deflection of a rotor under its load is drawn with its bearing reactions.
Whirl modes are orbits along the shaft in oblique projection.
"""

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gearwhine.figures.rotors.assembly import RotorAssembly
from gearwhine.figures.rotors.campbell import AXIAL, Sense, legend_lines, sense_of
from gearwhine.figures.rotors.shaft import MM, OutlinePanel, ShaftView, lay_out
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
    RPM,
    SERIES,
    legend,
    panel,
    sheet,
    shortened,
)
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.rotors import WhirlModes
from gearwhine.rotors.analyses.rest_frequencies import RestFrequencies
from gearwhine.rotors.modes.lateral import LateralModes
from gearwhine.rotors.modes.torsional_and_axial import TorsionalModes
from gearwhine.rotors.whirl.whirl_modes import MOSTLY_AXIAL

_PLACES = 201  # even places along a shaft, besides those of its parts
_HIGHEST, _LOWEST = 20.0, 7.0  # largest and least height of a mode [mm]
_TOGETHER = 150.0  # height of all modes, unless they would be lower than the least [mm]
_SWING = 0.42  # largest displacement of a shape to either side, over the height of its mode
_MODE_HEIGHT = 23.0  # height of a mode [mm of paper]
_REACH = 8.5  # length of its largest displacement [mm of paper]
_ORBITS, _ALONG = 17, 121  # number of orbits, and of places of the centre line
# Cabinet projection: y is up, x goes back to the right at this length and angle.
_BACK = 0.6 * np.exp(1j * np.radians(35.0))
# An orbit ends short of its start, so that its sense is seen without colours too.
_TURN = np.linspace(0.0, 0.86 * 2.0 * np.pi, 60)
_EDGEWISE = 0.5  # part of the largest displacement seen upwards below which a mode is seen from the other side
_ARROWS, _SHORTEST = 13, 0.5  # number of arrows of an axial motion, and the shortest length [mm of paper]
_UNSHRUNK_ARROW = {"shrinkA": 0, "shrinkB": 0}  # arrows begin and end at their points
_HEIGHT = 60.0  # height of the panel [mm of paper]
_ARROW = 0.26  # arrow of the largest load, over the panel's height
_WORD, _EDGE = 0.08, 0.03  # height of a load's label, and margin, over the panel's height
_LEAST_DRAWN_SHAPE = 0.02  # part of a mode's largest displacement below which a direction is not drawn
_LEAST_DRAWN_DEFLECTION = 1e-6  # part of the deflection in y below which that in x is not drawn


def draw_lateral_modes(assembly: RotorAssembly, modes: LateralModes, *, most: int | None = None) -> Figure:
    """Draw planar bending modes, lowest on top, with the places of bearings (as Figs. 9 and 12 of TM-101442).

    Parameters
    ----------
    assembly : RotorAssembly
        The rotor, drawn above its modes on the same axis.
    modes : LateralModes
        Modes in one plane.
    most : int, optional
        Largest number of modes drawn; by default all.
    """
    z, at_bearings, loaded = _places(assembly)
    frequencies = modes.frequencies[:most]
    note = _note(frequencies.size, modes.count, "each shape over its largest displacement", at_bearings, loaded)
    # Bearings hold no torsion, so they are marked on these lines alone.
    bearings = [bearing.at for bearing in assembly.bearings]
    shapes = {"": modes.evaluate(z)[0]}
    return _stacked(assembly, "lateral modes", note, frequencies, z, shapes, at_bearings, loaded, bearings)


def draw_rest_modes(assembly: RotorAssembly, rest: RestFrequencies, *, most: int | None = None) -> Figure:
    """Draw the modes at rest on the bearings as they are, with what moves in x, y and along the axis.

    Parameters
    ----------
    assembly : RotorAssembly
        The rotor, drawn above its modes on the same axis.
    rest : RestFrequencies
    most : int, optional
        Largest number of modes drawn; by default all.
    """
    z, at_bearings, loaded = _places(assembly)
    frequencies = rest.frequencies[:most]
    scale = "each mode over its largest displacement in x, y or along the axis"
    note = _note(frequencies.size, rest.frequencies.size, scale, at_bearings, loaded)
    bearings = [bearing.at for bearing in assembly.bearings]
    shapes = dict(zip(("x", "y", "along the axis"), np.moveaxis(rest.evaluate(z), 1, 0), strict=True))
    return _stacked(assembly, "modes at rest", note, frequencies, z, shapes, at_bearings, loaded, bearings)


def draw_torsional_modes(assembly: RotorAssembly, modes: TorsionalModes, *, most: int | None = None) -> Figure:
    """Draw free torsional modes, the rigid rotation first; see :func:`draw_lateral_modes`."""
    z, _, loaded = _places(assembly)
    frequencies = modes.frequencies[:most]
    note = _note(frequencies.size, modes.count, "each shape over its largest rotation", np.empty(0), loaded)
    shapes = {"": modes.evaluate(z)}
    return _stacked(assembly, "torsional modes", note, frequencies, z, shapes, np.empty(0), loaded, ())


def draw_along(axes: Axes, assembly: RotorAssembly, view: ShaftView, bearings: Sequence[float]) -> None:
    """Give a panel under a shaft its axis, and lines at the places of bearings [m]."""
    axes.set_xlim(view.low, view.high)
    view.show_length(axes, assembly.rotor.length)
    axes.grid(visible=False)
    axes.set_xlabel("z from the left end [mm]")
    for at in bearings:
        axes.axvline(MM * at, color=PALE, lw=1.0, zorder=0.5, label="bearing")


def _sheet_below_shaft(
    outline: OutlinePanel, height: float, title: str, remarks: Sequence[str], bearings: Sequence[float]
) -> tuple[Figure, Axes]:
    """Return a sheet with a shaft at its top, and the panel of a height [mm] below on the same axis."""
    figure = sheet(HEAD + outline.height + height + FOOT, title, "; ".join([*remarks, *outline.remarks]))
    upper = outline.draw(figure, FOOT + height)
    upper.spines["bottom"].set_visible(False)
    upper.tick_params(bottom=False, labelbottom=False)
    axes = panel(figure, FOOT, height)
    draw_along(axes, outline.assembly, outline.view, bearings)
    return figure, axes


def _places(assembly: RotorAssembly) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return places along the shaft, ascending, and among them those of bearings and of discs and gears [m]."""
    length = assembly.rotor.length
    at_bearings = np.clip([bearing.at for bearing in assembly.bearings], 0.0, length)
    loaded = np.clip([*(d.at for d in assembly.discs), *(g.at for g in assembly.gears)], 0.0, length)
    along = np.linspace(0.0, length, _PLACES)
    return np.unique(np.concatenate([along, at_bearings, loaded])), np.unique(at_bearings), np.unique(loaded)


def _note(n_shown: int, count: int, scale: str, at_bearings: FloatArray, loaded: FloatArray) -> str:
    parts = [f"the lowest {n_shown} of {count}"] if n_shown < count else []
    parts.append(scale)
    parts += ["○ bearings"] * bool(at_bearings.size) + ["■ discs and gears"] * bool(loaded.size)
    return "; ".join(parts)


def _stacked(
    assembly: RotorAssembly,
    kind: str,
    note: str,
    frequencies: FloatArray,
    z: FloatArray,
    shapes: Mapping[str, FloatArray],
    at_bearings: FloatArray,
    loaded: FloatArray,
    bearings: Sequence[float],
) -> Figure:
    """Draw shapes by their directions, each (at least m, len(z)), one mode below the other, under the shaft."""
    outline = lay_out(assembly, labelled=False)
    count = frequencies.size
    share = float(np.clip(_TOGETHER / max(count, 1), _LOWEST, _HIGHEST))
    height = share * max(count, 1)
    title = f"Rotor {assembly.rotor.name}: {kind}"
    figure, axes = _sheet_below_shaft(outline, height, title, [note], bearings)
    axes.set_ylim(-count + 0.5, 0.5)
    levels = -np.arange(count, dtype=np.float64)
    axes.hlines(levels, 0.0, MM * assembly.rotor.length, color=GREY, lw=0.5, zorder=1)
    curves: dict[str, Line2D] = {}
    for number, level in enumerate(levels.tolist()):
        largest = max(float(np.abs(shape[number]).max()) for shape in shapes.values()) or 1.0
        for (direction, shape), color in zip(shapes.items(), (BLUE, SERIES[1], GREY), strict=False):
            if np.abs(shape[number]).max() < _LEAST_DRAWN_SHAPE * largest:
                continue
            line = level + _SWING * shape[number] / largest
            label = f"mode {number + 1} {direction}".rstrip()
            (curves[direction],) = axes.plot(MM * z, line, color=color, lw=1.2, zorder=2, label=label)
            for places, marker, face in ((at_bearings, "o", "white"), (loaded, "s", color)):
                at = np.searchsorted(z, places)
                axes.plot(
                    MM * places, line[at], ls="", marker=marker, color=color, markerfacecolor=face, ms=3.2, mew=0.8,
                    zorder=3,
                )  # fmt: skip
    if len(shapes) > 1:
        legend(figure, [Line2D([], [], color=curve.get_color(), lw=1.2, label=name) for name, curve in curves.items()])
    names = [f"mode {number}\n{_frequency(value)}" for number, value in enumerate(frequencies / HERTZ, start=1)]
    axes.set_yticks(levels, names)
    axes.tick_params(axis="y", length=0.0, colors=INK)
    axes.spines["left"].set_visible(False)
    return figure


def _frequency(value: float) -> str:
    if value == 0.0:
        return "rigid"
    return f"{value:.4g} Hz" if value < 1e4 else f"{1e-3 * value:.4g} kHz"


def draw_static_deflection(
    assembly: RotorAssembly,
    z: npt.ArrayLike,
    deflection: npt.ArrayLike,
    bearing_loads: npt.ArrayLike,
) -> Figure:
    """Draw the deflected centre line under the shaft, with each bearing's force on the rotor as an arrow.

    Parameters
    ----------
    assembly : RotorAssembly
    z : array_like, shape (n,)
        Ascending places from the left end [m].
    deflection : array_like, shape (n, 2)
        Deflection along x and y there [m]; y is up.
    bearing_loads : array_like, shape (b, 2)
        Force of each bearing on the rotor along x and y, in the order of the assembly's bearings [N]. The arrows show
        y; the labels give the magnitude where x has a part in it.

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
    at_bearings = [bearing.at for bearing in assembly.bearings]
    figure, axes = _sheet_below_shaft(outline, _HEIGHT, title, [carried], at_bearings)
    axes.axhline(0.0, color=GREY, lw=0.5, zorder=1)
    largest = float(np.abs(moved).max(initial=0.0))
    curves: list[Artist] = []
    for column, name in ((1, "y"), (0, "x")):
        if np.abs(moved[:, column]).max(initial=0.0) > _LEAST_DRAWN_DEFLECTION * largest or column == 1:
            color = BLUE if column else SERIES[1]
            curves += axes.plot(MM * places, MICRO * moved[:, column], color=color, lw=1.3, zorder=3, label=name)
    low, high = min(0.0, MICRO * float(moved.min())), max(0.0, MICRO * float(moved.max()))
    span = (high - low) or 1.0
    # Room for the longest arrow and its label, below the line and, where a bearing pulls down, above it.
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


def draw_whirl_modes(assembly: RotorAssembly, whirl: WhirlModes, *, most: int | None = None) -> Figure:
    """Draw whirl modes at one speed, lowest on top: orbits of places along the shaft, and the shaft at one instant.

    Each orbit begins at a dot, where the shaft is at that instant, and ends short of it. Its colour is that of its own
    sense, which may change along a shaft whose bearings differ in x and y. Decay and growth are left out. A mode that
    is mostly along the axis is drawn by arrows along it, from the places at rest. A mode in a plane that is seen
    edgewise is drawn with x to the lower right, as the axes beside it show.

    Parameters
    ----------
    assembly : RotorAssembly
        The rotor, drawn above on the same axis.
    whirl : WhirlModes
    most : int, optional
        Largest number of modes drawn; by default all.
    """
    outline = lay_out(assembly, labelled=False)
    view = outline.view
    whole = int(whirl.frequencies.size)
    count = min(whole, most if most is not None else whole)
    height = _MODE_HEIGHT * max(count, 1)
    along = [number for number in range(count) if whirl.axial_share[number] > MOSTLY_AXIAL]
    remarks = [f"the lowest {count} of {whole}"] if count < whole else []
    remarks += ["orbits begin at the dot"] * (len(along) < count) + ["arrows: motion along the axis"] * bool(along)
    remarks.append("each mode over its largest displacement")
    title = f"Rotor {shortened(assembly.rotor.name, 20)}: whirl at {abs(whirl.speed) * RPM:.5g} rpm"
    figure, axes = _sheet_below_shaft(outline, height, title, remarks, [bearing.at for bearing in assembly.bearings])
    axes.set_ylim(0.0, height)
    places = np.linspace(0.0, assembly.rotor.length, _ALONG)
    x, y = whirl.evaluate(places)
    z = whirl.evaluate_axial(places)
    senses: list[Sense] = []
    levels = height - _MODE_HEIGHT * (np.arange(count) + 0.5)
    turning = -1.0 if whirl.speed < 0.0 else 1.0
    for number, level in enumerate(levels.tolist()):
        if number in along:
            _draw_axial_mode(axes, view, places, z[number], level)
            senses.append(AXIAL)
            continue
        motion = _scaled(x[number], y[number])
        back = _view_of(*motion)
        senses += _draw_mode(axes, view, places, motion, level, turning, back)
        if number == min(set(range(count)) - set(along)) or back != _BACK:
            _draw_directions(axes, view, level, back)
    axes.set_yticks(levels, [_name(whirl, number) for number in range(count)])
    axes.tick_params(axis="y", length=0.0, colors=INK)
    axes.spines["left"].set_visible(False)
    legend(figure, legend_lines(senses, solid=True))
    return figure


def _view_of(x: ComplexArray, y: ComplexArray) -> complex:
    """Return the direction of x in the projection: to the lower right where a mode would else be seen edgewise."""

    def seen(back: complex) -> float:
        up = y + back.imag * x
        return float(np.abs(up).max())

    mirrored = _BACK.conjugate()
    return complex(mirrored if seen(_BACK) < _EDGEWISE * seen(mirrored) else _BACK)


def _draw_axial_mode(axes: Axes, view: ShaftView, z: FloatArray, motion: ComplexArray, level: float) -> None:
    """Draw a motion along the axis at the instant of its largest displacement: arrows from places at rest."""
    top = int(np.abs(motion).argmax())
    moved = (motion * np.exp(-1j * np.angle(motion[top]))).real / (np.abs(motion[top]) or 1.0)
    axes.plot(MM * z[[0, -1]], (level, level), color=GREY, lw=0.5, zorder=1)
    head = {"arrowstyle": "-|>,head_width=0.14,head_length=0.3", "color": AXIAL.color, "lw": 1.1} | _UNSHRUNK_ARROW
    for index in np.linspace(0, z.size - 1, _ARROWS).round().astype(int).tolist():
        start, end = MM * float(z[index]), MM * float(z[index]) + view.length(_REACH) * float(moved[index])
        axes.plot((start, start), (level - 1.4, level + 1.4), color=GREY, lw=0.6, zorder=2, label="at rest")
        if abs(end - start) > view.length(_SHORTEST):
            axes.annotate("", (end, level), (start, level), arrowprops=head, zorder=3, annotation_clip=False)
    axes.plot(MM * z, level + 0.0 * z, lw=0.0, label="axial")


def local_direction(x: ComplexArray, y: ComplexArray) -> FloatArray:
    """Circularity of the whirl at each station, 1 counter-clockwise to −1 clockwise: 2 Im(x ȳ) / (|x|² + |y|²)."""
    size = np.abs(x) ** 2 + np.abs(y) ** 2
    return np.asarray(2.0 * (x * y.conj()).imag / np.where(size > 0.0, size, 1.0))


def _scaled(x: ComplexArray, y: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Scale a mode to a largest semi-axis of one, and turn it to begin where that orbit is farthest out."""
    # The forward circle has radius |x + iy|/2, the backward one |x − iy|/2; the semi-axes are their sum and difference.
    major = 0.5 * (np.abs(x + 1j * y) + np.abs(x - 1j * y))
    top = int(major.argmax())
    squares = x[top] ** 2 + y[top] ** 2
    circular = abs(squares) < 1e-6 * major[top] ** 2
    turn = y[top] if circular else np.sqrt(squares)
    factor = np.exp(-1j * np.angle(turn)) / (major[top] or 1.0)
    return x * factor, y * factor


def _draw_mode(
    axes: Axes,
    view: ShaftView,
    z: FloatArray,
    motion: tuple[ComplexArray, ComplexArray],
    level: float,
    turning: float,
    back: complex,
) -> list[Sense]:
    x, y = motion
    axes.plot(MM * z[[0, -1]], (level, level), color=GREY, lw=0.5, zorder=1)
    senses = []
    directions = turning * local_direction(x, y)
    size = np.hypot(np.abs(x), np.abs(y))
    for index in np.linspace(0, z.size - 1, _ORBITS).round().astype(int):
        phase = np.exp(1j * _TURN)
        across, up = _project(view, MM * z[index], (x[index] * phase).real, (y[index] * phase).real, level, back)
        sense = sense_of(float(directions[index]))
        axes.plot(across, up, color=sense.color, lw=0.8, zorder=2, label="orbit")
        axes.plot(across[:1], up[:1], ls="", marker="o", markersize=2.2, color=sense.color, zorder=4)
        if size[index] > 0.02:  # smaller orbits have no clear sense
            senses.append(sense)
    across, up = _project(view, MM * z, x.real, y.real, level, back)
    axes.plot(across, up, color=INK, lw=1.1, zorder=3, label="shaft")
    return senses


def _project(
    view: ShaftView, z: FloatArray | float, x: FloatArray, y: FloatArray, level: float, back: complex
) -> tuple[FloatArray, FloatArray]:
    """Return panel coordinates [mm along the shaft, mm of paper up] of displacements, 1 the largest, at z [mm]."""
    behind = back * x
    return np.asarray(z + view.length(_REACH) * behind.real), np.asarray(level + _REACH * (y + behind.imag))


def _draw_directions(axes: Axes, view: ShaftView, level: float, back: complex) -> None:
    """Show where x and y point, left of a mode and below its name."""
    start, low = view.low - view.length(11.0), level - 10.5
    head = {"arrowstyle": "-|>,head_width=0.1,head_length=0.25", "color": GREY, "lw": 0.7} | _UNSHRUNK_ARROW
    for name, (x, y) in (("x", (0.7, 0.0)), ("y", (0.0, 0.5))):
        across, up = _project(view, 0.0, np.array([x, 1.6 * x]), np.array([y, 1.5 * y]), 0.0, back)
        axes.annotate("", (start + across[0], low + up[0]), (start, low), arrowprops=head, annotation_clip=False)
        axes.text(start + across[1], low + up[1], name, fontsize=NOTE, color=GREY, ha="center", va="center")


def _name(whirl: WhirlModes, number: int) -> str:
    return f"mode {number + 1}\n{_frequency(float(whirl.frequencies[number]) / HERTZ)}"
