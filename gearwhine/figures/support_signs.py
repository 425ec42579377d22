"""Symbols of supports under a shaft: spring or rolling bearing; ground, seat or pedestal."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon, Rectangle

from gearwhine.figures.assembly import RotorAssembly
from gearwhine.figures.shaft_view import MM, ShaftView
from gearwhine.figures.style import GREY, INK
from rotors import Bearing

_SIGN = 4.0  # side of a bearing's sign [mm of paper, as all sizes here]
_SEAT, _GROUND, _MASS, _SPRING = 2.4, 1.6, 2.2, 4.0
_LINE = 0.7  # [points]


def depth(assembly: RotorAssembly, bearing: Bearing) -> float:
    """Depth of a bearing's symbol below the shaft's surface, mm of paper."""
    if bearing.name in assembly.seats:
        return _SIGN + _SEAT
    return _SIGN + _GROUND + (_MASS + _SPRING if bearing.pedestal is not None else 0.0)


def draw_support(axes: Axes, assembly: RotorAssembly, view: ShaftView, bearing: Bearing) -> None:
    """Draw the sign of one bearing under (and, where it is a rolling one, over) the shaft."""
    place, radius = MM * bearing.at, view.across(assembly.shaft_radius(bearing.at))
    half, side = view.length(0.5 * _SIGN), view.length(_SIGN)
    if bearing.name in assembly.rolling:
        # The simplified sign of ISO 8826: a square with an upright cross.
        for low in (radius, -radius - side):
            axes.add_patch(
                Rectangle(
                    (place - half, low),
                    side,
                    side,
                    facecolor="white",
                    edgecolor=INK,
                    lw=_LINE,
                    zorder=3,
                    label="rolling",
                )
            )
            middle, arm = low + half, 0.6 * half
            axes.plot((place - arm, place + arm), (middle, middle), color=INK, lw=_LINE, zorder=3.1)
            axes.plot((place, place), (middle - arm, middle + arm), color=INK, lw=_LINE, zorder=3.1)
    else:
        corners = [(place, -radius), (place - half, -radius - side), (place + half, -radius - side)]
        axes.add_patch(Polygon(corners, facecolor="white", edgecolor=INK, lw=_LINE, zorder=3, label="bearing"))
    _draw_stand(axes, assembly, view, bearing, -radius - side)


def _draw_stand(axes: Axes, assembly: RotorAssembly, view: ShaftView, bearing: Bearing, top: float) -> None:
    place, wide = MM * bearing.at, view.length(1.6 * _SIGN)
    if bearing.name in assembly.seats:
        low = top - view.length(_SEAT)
        block = Rectangle((place - 0.5 * wide, low), wide, top - low, facecolor=GREY, lw=0.0, zorder=3, label="seat")
        axes.add_patch(block)
        return
    if bearing.pedestal is not None:
        low = top - view.length(_MASS)
        mass = Rectangle((place - 0.5 * wide, low), wide, top - low, facecolor="#a9b8c6", edgecolor=INK, lw=_LINE)
        mass.set(zorder=3, label="pedestal")
        axes.add_patch(mass)
        turns = np.linspace(low, low - view.length(_SPRING), 8)
        swing = view.length(0.3 * _SIGN) * np.array([0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 0.0, 0.0])
        axes.plot(place + swing, turns, color=INK, lw=_LINE, zorder=3)
        top = float(turns[-1])
    _draw_ground(axes, view, place, top, wide)


def _draw_ground(axes: Axes, view: ShaftView, place: float, top: float, wide: float) -> None:
    """A line with strokes below it."""
    axes.plot((place - 0.5 * wide, place + 0.5 * wide), (top, top), color=INK, lw=1.2 * _LINE, zorder=3, label="ground")
    drop = view.length(0.8 * _GROUND)
    starts = place + np.linspace(-0.35, 0.5, 5) * wide
    # One line with gaps rather than five lines.
    across = np.column_stack([starts, starts - drop, np.full(5, np.nan)]).ravel()
    down = np.tile([top, top - drop, np.nan], 5)
    axes.plot(across, down, color=INK, lw=0.7 * _LINE, zorder=3)
