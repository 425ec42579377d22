"""Inspection charts of flanks: profile over the roll angle, helix across the face, pitch tooth by tooth."""

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from coupling.gears import Gear, GearPairGeometry, TipRelief, flank_gap, path_of_contact
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
    SERIES,
    legend,
    panel,
    sheet,
    shortened,
)

FloatArray = npt.NDArray[np.float64]

_ROW, _BETWEEN, _NAMES, _GAP = 50.0, 12.0, 5.0, 14.0  # height of a row, rooms below it, above all and between [mm]
_PLACES = 400  # along a flank


def has_charts(pair: GearPairGeometry) -> bool:
    """Whether any flank differs from a perfect involute."""
    return bool(_rows(pair, None))


def draw_flank_charts(title: str, pair: GearPairGeometry, best: TipRelief | None = None) -> Figure:
    """Draw what the flanks of both gears differ from perfect ones, material outward upward; the driver at the left.

    Parameters
    ----------
    title
        Of the sheet.
    pair
        Rows without any deviation are left out, except the profile's where `best` is drawn.
    best
        A relief to draw beside that of the gears.

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
    """The rows of the chart, each a function that draws one gear's."""
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
    """Roll angles from the form circle to the tip [rad], and what the flank stands out there [m]."""
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
        if end - begin > 1e-6:
            axes.axvspan(begin, end, color=PALE, lw=0.0, zorder=0.2, label="_inactive")
    axes.set(xlabel="profile: roll angle from form circle to tip [°]", xlim=(degrees[0], degrees[-1]))


def _draw_helix(axes: Axes, gear: Gear) -> None:
    z = np.linspace(-0.5, 0.5, _PLACES) * gear.face_width
    deviation = np.zeros_like(z) if gear.helix_deviation is None else gear.helix_deviation.at(z, gear.face_width)
    axes.plot(MILLI * z, MICRO * deviation, color=BLUE, lw=1.3, zorder=3, label="_helix")
    axes.set(xlabel="helix: from the middle of the face [mm]", xlim=(MILLI * z[0], MILLI * z[-1]))


def _draw_pitch(axes: Axes, gear: Gear) -> None:
    deviations = MICRO * np.array(gear.pitch_deviations or np.zeros(gear.teeth))
    axes.bar(np.arange(gear.teeth), deviations, 0.8, color=BLUE, label="_pitch")
    axes.set(xlabel="pitch: number of the tooth", xlim=(-0.7, gear.teeth - 0.3))
