"""Whirl mode shapes as orbits along the shaft, in oblique projection under its outline."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearwhine.figures.rotors.assembly import RotorAssembly
from gearwhine.figures.rotors.campbell import Sense, legend_lines, sense_of
from gearwhine.figures.rotors.mode_shapes import draw_along
from gearwhine.figures.rotors.shaft import MM, ShaftView, lay_out
from gearwhine.figures.style import FOOT, GREY, HEAD, HERTZ, INK, NOTE, RPM, legend, panel, sheet, shortened
from rotors import WhirlModes
from rotors.whirl.whirl_modes import MOSTLY_AXIAL

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_HEIGHT = 23.0  # of a mode [mm of paper]
_REACH = 8.5  # of its largest displacement [mm of paper]
_ORBITS, _ALONG = 17, 121  # orbits drawn, and places of the shaft's own line
# Cabinet projection: y is up, x goes back to the right at this length and angle.
_BACK = 0.6 * np.exp(1j * np.radians(35.0))
# An orbit ends short of its start, so that its sense is seen without colours too.
_TURN = np.linspace(0.0, 0.86 * 2.0 * np.pi, 60)


def draw_whirl_modes(assembly: RotorAssembly, whirl: WhirlModes, *, most: int | None = None) -> Figure:
    """Whirl modes at one speed, lowest on top: the orbits of places along the shaft, and the shaft at one instant.

    Each orbit begins at a dot, where the shaft is at that instant, and ends short of it. Its colour tells its own
    sense, which may change along a shaft whose bearings differ in x and y. Decay and growth are left out.

    Parameters
    ----------
    assembly
        The rotor, drawn above on the same axis.
    whirl
        Its modes; those that are for the most part along the axis are left out.
    most
        Largest number of modes drawn; all where not given.
    """
    outline = lay_out(assembly, labelled=False)
    view = outline.view
    lateral = np.flatnonzero(whirl.axial_share <= MOSTLY_AXIAL)
    count = min(lateral.size, most if most is not None else lateral.size)
    height = _HEIGHT * max(count, 1)
    some = [f"the lowest {count} of {lateral.size}"] if count < lateral.size else []
    note = "; ".join([*some, "orbits begin at the dot; each mode over its largest displacement", *outline.remarks])
    title = f"Rotor {shortened(assembly.rotor.name, 20)}: whirl at {abs(whirl.speed) * RPM:.5g} rpm"
    figure = sheet(HEAD + outline.height + height + FOOT, title, note)
    upper = outline.draw(figure, FOOT + height)
    upper.spines["bottom"].set_visible(False)
    upper.tick_params(bottom=False, labelbottom=False)

    axes = panel(figure, FOOT, height)
    draw_along(axes, assembly, view, [bearing.at for bearing in assembly.bearings])
    axes.set_ylim(0.0, height)
    places = np.linspace(0.0, assembly.rotor.length, _ALONG)
    x, y = whirl.evaluate(places)
    senses: list[Sense] = []
    levels = height - _HEIGHT * (np.arange(count) + 0.5)
    for number, level in zip(lateral[:count].tolist(), levels.tolist(), strict=True):
        motion = _scaled(x[number], y[number])
        senses += _draw_mode(axes, view, places, motion, level, -1.0 if whirl.speed < 0.0 else 1.0)
    _draw_directions(axes, view)
    axes.set_yticks(levels, [_name(whirl, number) for number in lateral[:count].tolist()])
    axes.tick_params(axis="y", length=0.0, colors=INK)
    axes.spines["left"].set_visible(False)
    legend(figure, legend_lines(senses, solid=True))
    return figure


def local_direction(x: ComplexArray, y: ComplexArray) -> FloatArray:
    """Circularity of the whirl at each station, 1 counter-clockwise to −1 clockwise: 2 Im(x ȳ) / (|x|² + |y|²)."""
    size = np.abs(x) ** 2 + np.abs(y) ** 2
    return np.asarray(2.0 * (x * y.conj()).imag / np.where(size > 0.0, size, 1.0))


def _scaled(x: ComplexArray, y: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Scale a mode to a largest semi-axis of one, and turn it to begin where that orbit is farthest out."""
    # A place moves by |x + iy|/2 one way round and |x − iy|/2 the other; the semi-axes are their sum and difference.
    major = 0.5 * (np.abs(x + 1j * y) + np.abs(x - 1j * y))
    top = int(major.argmax())
    squares = x[top] ** 2 + y[top] ** 2
    circular = abs(squares) < 1e-6 * major[top] ** 2
    turn = y[top] if circular else np.sqrt(squares)
    factor = np.exp(-1j * np.angle(turn)) / (major[top] or 1.0)
    return x * factor, y * factor


def _draw_mode(
    axes: Axes, view: ShaftView, z: FloatArray, motion: tuple[ComplexArray, ComplexArray], level: float, turning: float
) -> list[Sense]:
    x, y = motion
    axes.plot(MM * z[[0, -1]], (level, level), color=GREY, lw=0.5, zorder=1)
    senses = []
    directions = turning * local_direction(x, y)
    size = np.hypot(np.abs(x), np.abs(y))
    for index in np.linspace(0, z.size - 1, _ORBITS).round().astype(int):
        phase = np.exp(1j * _TURN)
        across, up = _project(view, MM * z[index], (x[index] * phase).real, (y[index] * phase).real, level)
        sense = sense_of(float(directions[index]))
        axes.plot(across, up, color=sense.color, lw=0.8, zorder=2, label="orbit")
        axes.plot(across[:1], up[:1], ls="", marker="o", markersize=2.2, color=sense.color, zorder=4)
        if size[index] > 0.02:  # the sense of next to nothing is no sense
            senses.append(sense)
    across, up = _project(view, MM * z, x.real, y.real, level)
    axes.plot(across, up, color=INK, lw=1.1, zorder=3, label="shaft")
    return senses


def _project(
    view: ShaftView, z: FloatArray | float, x: FloatArray, y: FloatArray, level: float
) -> tuple[FloatArray, FloatArray]:
    """Panel coordinates of displacements (one is the largest) at places z (mm): mm along the shaft, mm of paper up."""
    back = _BACK * x
    return np.asarray(z + view.length(_REACH) * back.real), np.asarray(level + _REACH * (y + back.imag))


def _draw_directions(axes: Axes, view: ShaftView) -> None:
    """Show where x and y point, left of the first mode and below its name."""
    start, low = view.low - view.length(11.0), axes.get_ylim()[1] - 0.5 * _HEIGHT - 10.5
    head = {"arrowstyle": "-|>,head_width=0.1,head_length=0.25", "color": GREY, "lw": 0.7, "shrinkA": 0, "shrinkB": 0}
    for name, (x, y) in (("x", (0.7, 0.0)), ("y", (0.0, 0.5))):
        across, up = _project(view, 0.0, np.array([x, 1.6 * x]), np.array([y, 1.5 * y]), 0.0)
        axes.annotate("", (start + across[0], low + up[0]), (start, low), arrowprops=head, annotation_clip=False)
        axes.text(start + across[1], low + up[1], name, fontsize=NOTE, color=GREY, ha="center", va="center")


def _name(whirl: WhirlModes, number: int) -> str:
    return f"mode {number + 1}\n{whirl.frequencies[number] / HERTZ:.4g} Hz"
