"""Campbell diagram of a rotor: whirl frequencies and damping over the speed of rotation.

Forward and backward whirl have their colours, lines and words here, for all figures of rotors.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    HERTZ,
    INK,
    NOTE,
    PANEL_WIDTH,
    RED,
    RPM,
    SERIES,
    Label,
    arrange,
    draw_row,
    legend,
    mark_operation,
    panel,
    sheet,
    stretches,
)
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import Campbell
from gearwhine.rotors.whirl.whirl_modes import MOSTLY_AXIAL, NEUTRAL

# Below this part of a circular whirl a mode as a whole has no sense.
PLANAR = 0.05
_HEIGHT, _DAMPING_HEIGHT, _BETWEEN = 78.0, 32.0, 4.0  # heights of both panels and gap between them [mm of paper]
_BRANCHES = 6  # least number of lowest branches that are shown
_ABOVE = 1.6  # top of the frequency axis over the highest order's frequency at top speed
_ALMOST_ALL = 0.9  # part of the decrements that their axis shows


@dataclass(frozen=True)
class Sense:
    """Sense of whirl: its name, colour and line style."""

    name: str
    color: str
    line: Any


FORWARD = Sense("forward", BLUE, "-")

BACKWARD = Sense("backward", RED, (0, (5, 2)))

MIXED = Sense("planar or mixed", "#6b747c", (0, (6, 2, 1.2, 2)))

AXIAL = Sense("along the axis", SERIES[3], (0, (1.2, 1.8)))


def sense_of(direction: float, axial_share: float = 0.0) -> Sense:
    """Return the sense of a whirl direction from −1 (circular backward) to 1 (circular forward), or axial motion."""
    if axial_share > MOSTLY_AXIAL:
        return AXIAL
    if abs(direction) < PLANAR:
        return MIXED
    return FORWARD if direction > 0.0 else BACKWARD


def with_rotation(directions: npt.ArrayLike, speeds: npt.ArrayLike) -> FloatArray:
    """Return directions about +z, (s, ...), in the sense of rotation at speeds (s,); at rest as they are."""
    values, turning = np.asarray(directions, dtype=np.float64), np.asarray(speeds, dtype=np.float64)
    sign = np.where(turning < 0.0, -1.0, 1.0)
    # A run-up against +z begins at rest, where it has the sense of the run.
    if bool((turning <= 0.0).all()) and bool((turning < 0.0).any()):
        sign = -np.ones_like(turning)
    return np.asarray(values * sign.reshape(-1, *(1,) * (values.ndim - 1)))


def legend_lines(senses: Sequence[Sense], *, solid: bool = False) -> list[Line2D]:
    """Return a line for each sense that occurs: forward, backward, mixed, axial; ``solid`` for colour alone."""
    return [
        Line2D([], [], color=sense.color, ls="-" if solid else sense.line, lw=1.3, label=sense.name)
        for sense in (FORWARD, BACKWARD, MIXED, AXIAL)
        if sense in senses
    ]


def draw_campbell(
    title: str,
    diagram: Campbell,
    *,
    critical_speeds: npt.ArrayLike = (),
    critical_directions: npt.ArrayLike = (),
    critical_orders: npt.ArrayLike = 1.0,
    orders: Sequence[float] = (1.0,),
    operating_speed: float | None = None,
    frequency_limit: float | None = None,
) -> Figure:
    """Draw whirl frequencies over speed, and below them the logarithmic decrement where there is damping.

    Parameters
    ----------
    title : str
        Title of the sheet.
    diagram : Campbell
        Diagram of :func:`gearwhine.rotors.campbell`, at two or more speeds of one sign, ascending or descending.
    critical_speeds, critical_directions : array_like, shape (c,)
        Critical speeds [rad/s], and their directions, 1 forward to −1 backward in the sense of rotation.
    critical_orders : array_like, shape (c,) or ()
        Multiples of the speed on whose lines they are marked.
    orders : sequence of float
        Multiples of the speed of rotation that are drawn as lines.
    operating_speed : float, optional
        Speed of operation, drawn as a line [rad/s].
    frequency_limit : float, optional
        Top of the frequency axis [rad/s]; by default it shows the lowest six branches and all that the orders cross.

    Raises
    ------
    ValueError
        Fewer than two speeds.
    """
    if diagram.speeds.size < 2:
        raise ValueError(f"a Campbell diagram at {diagram.speeds.size} speed; expected two or more speeds")
    order = np.argsort(np.abs(diagram.speeds))
    turning, values = np.abs(diagram.speeds)[order], diagram.frequencies[order]
    ratios, axial = diagram.damping_ratios[order], diagram.axial_share[order]
    senses = with_rotation(diagram.direction, diagram.speeds)[order]
    if turning[0] == 0.0:
        # At rest a whirl has no sense, and the shapes of double roots are arbitrary.
        senses[0] = senses[1]
    top = frequency_limit or _top(turning, values, orders)
    low, high = float(turning[0]), float(turning[-1])
    # A branch that never comes below the top of the axis has no place in the damping either.
    branches = np.flatnonzero((np.nan_to_num(values, nan=np.inf) < top).any(axis=0))
    values, ratios, senses, axial = values[:, branches], ratios[:, branches], senses[:, branches], axial[:, branches]

    multiples = np.broadcast_to(critical_orders, np.shape(np.atleast_1d(critical_speeds)))
    criticals = _criticals(critical_speeds, critical_directions, multiples, low, high, top)
    labels = [
        Label(f"{RPM * speed:.4g}", RPM * speed, multiple * speed / HERTZ, sense.color)
        for speed, sense, multiple in criticals
    ]
    onset = diagram.onset
    if onset is not None:
        speed, branch = onset
        height = float(np.interp(speed, turning, diagram.frequencies[order, branch])) / HERTZ
        labels.append(Label(f"unstable above {RPM * speed:.4g}", RPM * speed, min(height, top / HERTZ)))
    row = arrange(labels, [(label.x / RPM - low) / (high - low) * PANEL_WIDTH for label in labels], PANEL_WIDTH)
    is_damped = bool((np.abs(np.nan_to_num(ratios)) > NEUTRAL).any())
    lower = _DAMPING_HEIGHT + _BETWEEN if is_damped else 0.0

    note = (
        "speeds in rpm above the diagram: critical speeds, ● forward, ○ backward"
        if criticals
        else f"no critical speed from {RPM * low:.0f} to {RPM * high:.0f} rpm"
    )
    note += f"; {row.left_out} not named" * bool(row.left_out)
    figure = sheet(HEAD + row.height + 2.0 + _HEIGHT + lower + FOOT, title, note)
    axes = panel(figure, FOOT + lower, _HEIGHT)
    axes.set(xlim=(RPM * low, RPM * high), ylim=(0.0, top / HERTZ), ylabel="whirl frequency [Hz]")
    met = _draw_branches(axes, turning, values / HERTZ, senses, axial)
    for multiple in orders:
        _draw_order(axes, multiple, low, high, top)
    for speed, sense, multiple in criticals:
        face = sense.color if sense.name == "forward" else "white"
        height = multiple * speed / HERTZ
        axes.plot(RPM * speed, height, marker="o", ms=4.5, color=sense.color, mfc=face, zorder=4, label="critical")
    draw_row(axes, row, _HEIGHT + 1.0)
    lowest = axes
    if is_damped:
        lowest = panel(figure, FOOT, _DAMPING_HEIGHT)
        _draw_decrement(lowest, turning, ratios, senses, axial)
        lowest.set_xlim(axes.get_xlim())
        axes.tick_params(labelbottom=False)
    lowest.set_xlabel("speed of rotation [rpm]")
    handles = legend_lines(met)
    for any_axes in {axes, lowest}:
        if operating_speed is not None:
            handles = [*legend_lines(met), mark_operation(any_axes, operating_speed, ":")]
        if onset is not None:
            any_axes.axvspan(RPM * onset[0], RPM * high, color=GREY, alpha=0.14, lw=0.0, zorder=0.2, label="unstable")
    legend(figure, handles)
    return figure


def _top(speeds: FloatArray, frequencies: FloatArray, orders: Sequence[float]) -> float:
    """Return the top of the frequency axis, above the lowest branches and all crossings of the orders [rad/s]."""
    highest = np.sort(np.where(np.isnan(frequencies), -np.inf, frequencies).max(axis=0))
    highest = highest[highest > 0.0]
    if not highest.size:
        return max(orders, default=1.0) * float(speeds[-1]) or 1.0
    top = max(
        _ABOVE * max(orders, default=0.0) * float(speeds[-1]), 1.05 * float(highest[min(_BRANCHES, highest.size) - 1])
    )
    return min(top, 1.05 * float(highest[-1]))


def _criticals(
    speeds: npt.ArrayLike, directions: npt.ArrayLike, orders: npt.ArrayLike, low: float, high: float, top: float
) -> list[tuple[float, Sense, float]]:
    """Return the critical speeds within the diagram, each with its sense and its order."""
    rows = zip(*(np.atleast_1d(values).tolist() for values in (speeds, directions, orders)), strict=True)
    return [
        (speed, sense_of(direction), order)
        for speed, direction, order in rows
        if low <= speed <= high and order * speed <= top
    ]


def _draw_branches(
    axes: Axes, speeds: FloatArray, values: FloatArray, directions: FloatArray, axial: FloatArray
) -> list[Sense]:
    """Draw each branch, (s, w), in the colours and lines of its senses; returns the senses."""
    met = []
    middles = [0.5 * (table[1:] + table[:-1]).T for table in (directions, axial)]
    for values_of, *ways in zip(values.T, *middles, strict=True):
        for run, sense in stretches([sense_of(*way) for way in zip(*(way.tolist() for way in ways), strict=True)]):
            axes.plot(
                RPM * speeds[run], values_of[run], color=sense.color, ls=sense.line, lw=1.2, zorder=3, label="branch"
            )
            met.append(sense)
    return met


def _draw_order(axes: Axes, multiple: float, low: float, high: float, top: float) -> None:
    """Draw the line of a multiple of the speed, named where it leaves the panel."""
    ends = np.array([low, high])
    axes.plot(RPM * ends, multiple * ends / HERTZ, color=GREY, lw=0.8, zorder=2, label=f"{multiple:g}×")
    leaves_above = multiple * high > top
    place = (RPM * (top / multiple if leaves_above else high), min(multiple * high, top) / HERTZ)
    axes.annotate(
        f"{multiple:g}×",
        place,
        (-3.0, -3.0) if leaves_above else (-2.0, 2.0),
        textcoords="offset points",
        fontsize=NOTE,
        color=GREY,
        ha="right",
        va="top" if leaves_above else "bottom",
    )


def _draw_decrement(
    axes: Axes, speeds: FloatArray, ratios: FloatArray, directions: FloatArray, axial: FloatArray
) -> None:
    """Draw the logarithmic decrement 2πζ / √(1 − ζ²) of each branch."""
    decrement = 2.0 * np.pi * ratios / np.sqrt(np.maximum(1.0 - ratios**2, 1e-12))
    _draw_branches(axes, speeds, decrement, directions, axial)
    axes.axhline(0.0, color=INK, lw=0.7, zorder=1)
    # A heavily damped branch would compress all others, and their stability, into the line of zero.
    finite = decrement[np.isfinite(decrement)]
    least, most = min(float(finite.min()), 0.0), float(np.quantile(finite, _ALMOST_ALL))
    axes.set_ylim(1.15 * least - 0.03 * max(most, 0.0), max(1.15 * most, -0.1 * least, 1e-3))
    axes.set_ylabel("log. decrement [1]")
