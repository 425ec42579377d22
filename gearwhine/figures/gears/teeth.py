"""Tooth figures: a tooth pair in mesh, and inspection charts of the flanks.

The pair is drawn with its true tooth shapes, line of action and points of contact. The charts show the profile over
the roll angle, the helix across the face, and the pitch tooth by tooth.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch, Polygon

from gearwhine.coupling.gears import Gear, GearPairGeometry, TipRelief, path_of_contact
from gearwhine.coupling.gears.contact.tooth_pair import flank_gap
from gearwhine.coupling.gears.geometry.profile import pair_outlines
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    INK,
    LABEL,
    LEFT,
    MICRO,
    MILLI,
    PALE,
    PANEL_WIDTH,
    RED,
    SERIES,
    legend,
    panel,
    sheet,
    shortened,
)
from gearwhine.numerics.arrays import FloatArray

_HEIGHT = 104.0  # height of the panel [mm of paper]
_PITCHES = 5.6  # number of teeth side by side
_POINTS = 60  # points on each curve of a tooth
_AROUND = 721  # points around the outside of a ring
_LETTERS = "ABCDE"  # usual names of points on the path of contact
_UP = 0.5 * math.pi  # the driven gear stands above the driver
_OUTLINES = (BLUE, SERIES[1])
_DASHES = {"pitch circles": (0, (8, 2, 1.5, 2)), "base circles": (0, (3, 2)), "tip circles": (0, (1, 1.6))}


def draw_tooth_pair(pair: GearPairGeometry, phase: float | None = None) -> Figure:
    """Draw the teeth around the pitch point to one scale in both directions, those of the driver below.

    Parameters
    ----------
    pair : GearPairGeometry
        Helical gears are drawn in the transverse section where tooth 0 has the phase.
    phase : float, optional
        Phase in mesh periods; by default midway between the entry of a pair and the exit of another.
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
    drawn = zip(outlines, (pair.driver, pair.driven), centres, _OUTLINES, strict=True)
    for outline, gear, centre, color in drawn:
        body = outline - pitch
        if gear.is_internal:
            body = _ring(body, centre, gear.outer_radius)
        # Not as a patch: the axes would look for the limits of each of its sides, which takes longer than all the rest.
        shape = Polygon(MILLI * body, fc=to_rgba(color, 0.12), ec=color, lw=1.0, label="_outline")
        axes.add_artist(shape)
    _circles(axes, pair, centres)
    _line_of_action(axes, pair, phase, centres[0])
    _senses(axes, half, centres)
    for centre, gear in zip((-1.0, 1.0), (pair.driver, pair.driven), strict=True):
        name = f"{shortened(gear.name, 24)}, {gear.tooth_count} teeth"
        side = "top" if centre > 0.0 else "bottom"
        place = (0.02, 0.5 + 0.47 * centre)
        axes.text(*place, name, va=side, transform=axes.transAxes, size=LABEL, color=INK, parse_math=False)
    handles = [Line2D([], [], color=INK, lw=0.8, label="line of action")]
    handles += [Line2D([], [], color=GREY, lw=0.8, ls=dashes, label=name) for name, dashes in _DASHES.items()]
    legend(figure, handles)
    return figure


def _ring(inside: FloatArray, centre: FloatArray, radius: float) -> FloatArray:
    """Outline of a ring (n, 2) around its inside, joined on the side of the centre away from the pitch point [m]."""
    away = math.atan2(centre[1], centre[0])
    across = np.angle(np.exp(-1j * away) * ((inside - centre) @ np.array([1.0, 1j])))
    inside = np.roll(inside, -int(np.argmin(np.abs(across))), axis=0)
    around = away + np.linspace(0.0, 2.0 * math.pi, _AROUND)
    outside = centre + radius * np.column_stack([np.cos(around), np.sin(around)])
    return np.concatenate([outside, inside[:1], inside[::-1]])


def _circles(axes: Axes, pair: GearPairGeometry, centres: tuple[FloatArray, FloatArray]) -> None:
    for gear, rolling, centre in zip((pair.driver, pair.driven), pair.working_pitch_radii, centres, strict=True):
        for radius, dashes in zip((rolling, gear.base_radius, gear.tip_radius), _DASHES.values(), strict=True):
            circle = Circle(
                tuple(MILLI * centre), MILLI * abs(radius), fill=False, ec=GREY, lw=0.6, ls=dashes, label="_circle"
            )
            axes.add_patch(circle)


def _line_of_action(axes: Axes, pair: GearPairGeometry, phase: float, centre: FloatArray) -> None:
    """Draw the line of action, the named points on it, and the points of contact at the phase."""
    angle = pair.line_of_action_angle(_UP)
    along = np.array([math.cos(angle), math.sin(angle)])
    across = pair.flank_sense(1) * np.array([math.sin(angle), -math.cos(angle)])
    # At the tangent point the line meets a radius of the driver's base circle at a right angle.
    tangent = centre + pair.driver.base_radius * across

    def place(position: npt.ArrayLike) -> FloatArray:
        distance = pair.start_distance + pair.base_pitch * np.asarray(position, dtype=np.float64)
        return np.asarray(MILLI * (tangent + distance[..., None] * along), dtype=np.float64)

    # Between the tangent points, outside of which an internal pair has its path of contact.
    path = pair.start_distance, pair.start_distance + pair.path_length
    limits = (0.0, pair.tangent_distance, *(path if pair.is_internal else ()))
    ends = MILLI * (tangent + np.outer([min(limits), max(limits)], along))
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


def _senses(axes: Axes, half: float, centres: tuple[FloatArray, FloatArray]) -> None:
    """Arrows of rotation: the driver counter-clockwise, the driven clockwise or, of an internal pair, alike."""
    reach, height = 0.12 * half, 0.62 * half * _HEIGHT / PANEL_WIDTH
    rightward = bool(centres[0][1] > 0.0)
    for level, centre in zip((-height, height), centres, strict=True):
        start, end = (0.9 * half, level), (0.9 * half - 2.0 * reach, level)
        if rightward:
            start, end = end, start
        bend = 0.18 if bool(centre[1] < 0.0) is not rightward else -0.18
        arrow = FancyArrowPatch(
            start, end, connectionstyle=f"arc3,rad={bend}", arrowstyle="-|>", mutation_scale=8, color=INK, lw=0.9
        )
        axes.add_patch(arrow)


_ROW, _BETWEEN, _NAMES, _GAP = 50.0, 12.0, 5.0, 14.0  # height of a row, gaps below it, above all and between [mm]
_PLACES = 400  # places along a flank


def has_charts(pair: GearPairGeometry) -> bool:
    """Whether any flank differs from a perfect involute."""
    return bool(_rows(pair, None))


def draw_flank_charts(title: str, pair: GearPairGeometry, best: TipRelief | None = None) -> Figure:
    """Draw the deviations of both gears' flanks from perfect ones, outward material upward; the driver at the left.

    Parameters
    ----------
    title : str
        Title of the sheet.
    pair : GearPairGeometry
        Rows without any deviation are left out, except the profile's where `best` is drawn.
    best : TipRelief, optional
        Relief to draw beside that of the gears.

    Raises
    ------
    ValueError
        Where there is nothing to draw.
    """
    rows = _rows(pair, best)
    if not rows:
        raise ValueError(f"{pair.label}: perfect involutes have no chart")
    note = (
        "material over the perfect flank, profile and helix along the line of action, pitch along the pitch circle; "
        "shaded: outside the active profile"
    )
    figure = sheet(HEAD + _NAMES + len(rows) * (_ROW + _BETWEEN) - _BETWEEN + FOOT, title, note)
    width = 0.5 * (PANEL_WIDTH - _GAP)
    handles: list[Artist] = []
    for number, draw in enumerate(rows):
        bottom = FOOT + (len(rows) - 1 - number) * (_ROW + _BETWEEN)
        pair_of_axes = [panel(figure, bottom, _ROW, left=LEFT + side * (width + _GAP), width=width) for side in (0, 1)]
        for axes, gear in zip(pair_of_axes, (pair.driver, pair.driven), strict=True):
            axes.axhline(0.0, color=GREY, lw=0.8, zorder=1)
            draw(axes, gear)
            if number == 0:
                axes.set_title(shortened(gear.name), size=LABEL, color=INK, parse_math=False, pad=4)
        pair_of_axes[0].set_ylabel("deviation [µm]")
        limits = np.array([axes.get_ylim() for axes in pair_of_axes])
        for axes in pair_of_axes:
            axes.set_ylim(limits[:, 0].min(), limits[:, 1].max())
    handles.append(Line2D([], [], color=BLUE, lw=1.3, label="as given"))
    if best is not None:
        handles.append(Line2D([], [], color=SERIES[1], lw=1.2, ls=(0, (4, 2)), label="best relief"))
        legend(figure, handles)
    return figure


def _rows(pair: GearPairGeometry, best: TipRelief | None) -> Sequence[Callable[[Axes, Gear], None]]:
    """Return the rows of the chart, each a function that draws one gear's."""
    gears = pair.driver, pair.driven
    path = path_of_contact(pair)
    active = {id(pair.driver): path.driver_roll_angle[[0, -1]], id(pair.driven): path.driven_roll_angle[[-1, 0]]}
    rows: list[Callable[[Axes, Gear], None]] = []
    if best is not None or any(np.any(_profile(gear)[1]) for gear in gears):
        rows.append(lambda axes, gear: _draw_profile(axes, gear, active[id(gear)], best))
    if any(gear.helix_deviation is not None for gear in gears):
        rows.append(_draw_helix)
    if any(any(gear.pitch_deviations) for gear in gears):
        rows.append(_draw_pitch)
    return rows


def _profile(gear: Gear) -> tuple[FloatArray, FloatArray]:
    """Return roll angles from the form circle to the tip [rad], and the material over the involute there [m]."""
    roll = np.linspace(gear.roll_angle(gear.form_radius), gear.roll_angle(gear.tip_radius), _PLACES)
    return roll, -flank_gap(gear, roll)


def _draw_profile(axes: Axes, gear: Gear, active: FloatArray, best: TipRelief | None) -> None:
    roll, deviation = _profile(gear)
    degrees = np.degrees(roll)
    if best is not None:
        depth = best.depth(roll, float(roll[-1]), gear.base_radius)
        axes.plot(degrees, -MICRO * depth, color=SERIES[1], lw=1.2, ls=(0, (4, 2)), zorder=2, label="_best")
    axes.plot(degrees, MICRO * deviation, color=BLUE, lw=1.3, zorder=3, label="_profile")
    for begin, end in ((degrees[0], np.degrees(active[0])), (np.degrees(active[1]), degrees[-1])):
        if gear.sign * (end - begin) > 1e-6:
            axes.axvspan(begin, end, color=PALE, lw=0.0, zorder=0.2, label="_inactive")
    axes.set(xlabel="profile: roll angle from form circle to tip [°]", xlim=(degrees[0], degrees[-1]))


def _draw_helix(axes: Axes, gear: Gear) -> None:
    z = np.linspace(-0.5, 0.5, _PLACES) * gear.face_width
    deviation = np.zeros_like(z) if gear.helix_deviation is None else gear.helix_deviation.at(z, gear.face_width)
    axes.plot(MILLI * z, MICRO * deviation, color=BLUE, lw=1.3, zorder=3, label="_helix")
    axes.set(xlabel="helix: from the middle of the face [mm]", xlim=(MILLI * z[0], MILLI * z[-1]))


def _draw_pitch(axes: Axes, gear: Gear) -> None:
    deviations = MICRO * np.array(gear.pitch_deviations or np.zeros(gear.tooth_count))
    axes.bar(np.arange(gear.tooth_count), deviations, 0.8, color=BLUE, label="_pitch")
    axes.set(xlabel="pitch: number of the tooth", xlim=(-0.7, gear.tooth_count - 0.3))
