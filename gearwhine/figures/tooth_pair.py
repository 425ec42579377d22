"""Tooth pair in mesh: true tooth shapes, line of action and points of contact."""

import math

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch, Polygon

from coupling.gears import GearPairGeometry, pair_outlines, path_of_contact
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    INK,
    LABEL,
    MILLI,
    PANEL_WIDTH,
    RED,
    SERIES,
    legend,
    panel,
    sheet,
    shortened,
)

FloatArray = npt.NDArray[np.float64]

_HEIGHT = 104.0  # of the panel [mm of paper]
_PITCHES = 5.6  # teeth side by side
_POINTS = 60  # on each curve of a tooth
_LETTERS = "ABCDE"  # of the path of contact, as everywhere in the field
_UP = 0.5 * math.pi  # the driven gear stands above the driver
_OUTLINES = (BLUE, SERIES[1])
_DASHES = {"pitch circles": (0, (8, 2, 1.5, 2)), "base circles": (0, (3, 2)), "tip circles": (0, (1, 1.6))}


def draw_tooth_pair(pair: GearPairGeometry, phase: float | None = None) -> Figure:
    """Draw the teeth around the pitch point to one scale in both directions, the driver below.

    Parameters
    ----------
    pair
        Helical gears are drawn in the transverse section where tooth 0 has the phase.
    phase
        In mesh periods; None: midway between where a pair enters and where one leaves.
    """
    if phase is None:
        phase = 0.5 * (pair.contact_ratio % 1.0)
    title = f"{shortened(pair.driver.name, 20)} → {shortened(pair.driven.name, 20)}: teeth in contact"
    section = "transverse section; " if pair.driver.helix_angle else ""
    note = (
        f"{section}A, E: the driver's active profile starts and ends; B: the pair before leaves; C: pitch point; "
        "D: the next pair enters; red: where teeth touch now"
    )
    figure = sheet(HEAD + _HEIGHT + FOOT, title, note)
    axes = panel(figure, FOOT, _HEIGHT)
    axes.grid(visible=False)
    half = 0.5 * MILLI * _PITCHES * math.pi * pair.driver.transverse_module
    axes.set(xlim=(-half, half), ylim=(-half * _HEIGHT / PANEL_WIDTH, half * _HEIGHT / PANEL_WIDTH))
    axes.set(xlabel="across the line of centres [mm]", ylabel="from the pitch point [mm]")

    pitch = np.array([0.0, pair.working_pitch_radii[0]])
    centres = -pitch, np.array([0.0, pair.working_centre_distance]) - pitch
    outlines = pair_outlines(pair, phase, centre_line_angle=_UP, points=_POINTS)
    for outline, color in zip(outlines, _OUTLINES, strict=True):
        # Not as a patch: the axes would look for the limits of each of its sides, which takes longer than all the rest.
        shape = Polygon(MILLI * (outline - pitch), fc=to_rgba(color, 0.12), ec=color, lw=1.0, label="_outline")
        axes.add_artist(shape)
    _circles(axes, pair, centres)
    _line_of_action(axes, pair, phase, centres[0])
    _senses(axes, half)
    for centre, gear in zip((-1.0, 1.0), (pair.driver, pair.driven), strict=True):
        name = f"{shortened(gear.name, 24)}, {gear.teeth} teeth"
        side = "top" if centre > 0.0 else "bottom"
        place = (0.02, 0.5 + 0.47 * centre)
        axes.text(*place, name, va=side, transform=axes.transAxes, size=LABEL, color=INK, parse_math=False)
    handles = [Line2D([], [], color=INK, lw=0.8, label="line of action")]
    handles += [Line2D([], [], color=GREY, lw=0.8, ls=dashes, label=name) for name, dashes in _DASHES.items()]
    legend(figure, handles)
    return figure


def _circles(axes: Axes, pair: GearPairGeometry, centres: tuple[FloatArray, FloatArray]) -> None:
    for gear, rolling, centre in zip((pair.driver, pair.driven), pair.working_pitch_radii, centres, strict=True):
        for radius, dashes in zip((rolling, gear.base_radius, gear.tip_radius), _DASHES.values(), strict=True):
            circle = Circle(
                tuple(MILLI * centre), MILLI * radius, fill=False, ec=GREY, lw=0.6, ls=dashes, label="_circle"
            )
            axes.add_patch(circle)


def _line_of_action(axes: Axes, pair: GearPairGeometry, phase: float, centre: FloatArray) -> None:
    """The line, the named points on it, and the places of contact at the phase."""
    angle = pair.line_of_action_angle(_UP)
    along, across = np.array([math.cos(angle), math.sin(angle)]), np.array([math.sin(angle), -math.cos(angle)])
    # The tangent point is where the line meets the driver's base circle at a right angle.
    tangent = centre + pair.driver.base_radius * across

    def place(position: npt.ArrayLike) -> FloatArray:
        distance = pair.start_distance + pair.base_pitch * np.asarray(position, dtype=np.float64)
        return np.asarray(MILLI * (tangent + distance[..., None] * along), dtype=np.float64)

    ends = MILLI * np.array([tangent, tangent + pair.tangent_distance * along])
    axes.plot(*ends.T, color=INK, lw=0.7, zorder=3, label="_line of action")
    axes.plot(*place([0.0, pair.contact_ratio]).T, color=INK, lw=1.8, zorder=3, label="_path of contact")
    # Letters on either side in turn: B, C and D may be near to each other.
    for number, (letter, point) in enumerate(zip(_LETTERS, place(path_of_contact(pair).position), strict=True)):
        axes.plot(*point, marker="o", ms=3.0, mfc="white", mec=INK, mew=0.8, zorder=4, label="_point")
        offset = tuple((7.0 if number % 2 == 0 else -7.0) * across)
        axes.annotate(
            letter, point, offset, textcoords="offset points", size=LABEL, color=INK, ha="center", va="center"
        )
    first = phase % 1.0
    touching = place(np.arange(first, pair.contact_ratio, 1.0))
    axes.plot(*touching.T, ls="none", marker="o", ms=4.5, color=RED, mec="white", mew=0.6, zorder=5, label="_contact")


def _senses(axes: Axes, half: float) -> None:
    """Arrows of rotation: the driver counter-clockwise, the driven clockwise."""
    reach, height = 0.12 * half, 0.62 * half * _HEIGHT / PANEL_WIDTH
    for level, bend in ((-height, 0.18), (height, -0.18)):
        start, end = (0.9 * half, level), (0.9 * half - 2.0 * reach, level)
        arrow = FancyArrowPatch(
            start, end, connectionstyle=f"arc3,rad={bend}", arrowstyle="-|>", mutation_scale=8, color=INK, lw=0.9
        )
        axes.add_patch(arrow)
