"""Undamped critical-speed map: critical speeds over bearing stiffness, with the bearings' own stiffness."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from gearwhine.figures.style import (
    BLUE,
    FOOT,
    HEAD,
    INK,
    MM_PER_INCH,
    NOTE,
    PANEL_WIDTH,
    RPM,
    SERIES,
    Label,
    arrange,
    draw_row,
    legend,
    panel,
    sheet,
    shortened,
)
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import Bearing

_HEIGHT = 92.0  # height of the panel [mm of paper]
_SAMPLES = 80  # samples of a bearing's table over speed
_VALUE = np.array([9.0, 2.8])  # width and height of a value [mm of paper]
_POINTS_PER_MM = 72.0 / MM_PER_INCH
_LINES = (("k_xx", "-"), ("k_yy", (0, (5, 2))))


@dataclass(frozen=True)
class _Curve:
    """A bearing's own stiffness [N/m] at speeds [rad/s], shapes (n,), with the name, colour and style of its line."""

    name: str
    color: str
    line: Any
    turning: FloatArray
    stiffness: FloatArray


def draw_critical_map(
    title: str,
    stiffnesses: npt.ArrayLike,
    critical_speeds: npt.ArrayLike,
    *,
    bearings: Sequence[Bearing] = (),
    operating_speed: float | None = None,
    whirl: str = "forward",
) -> Figure:
    """Draw critical speeds over bearing stiffness on logarithmic axes.

    Marks with values show where a bearing's own line meets a critical speed, and at which stiffness operation would be
    critical.

    Parameters
    ----------
    title : str
        Title of the sheet.
    stiffnesses : array_like, shape (k,)
        Stiffness of every bearing in every direction, ascending and positive [N/m].
    critical_speeds : array_like, shape (k, c)
        Critical speeds, each branch down a column [rad/s]; zero (a rigid motion) and NaN are not drawn.
    bearings : sequence of Bearing
        Bearings whose k_xx and k_yy, over speed where they have tables, are drawn over the map.
    operating_speed : float, optional
        Speed of operation, drawn as a line [rad/s].
    whirl : {"forward", "backward"}
        Sense of whirl of the critical speeds.

    Raises
    ------
    ValueError
        Arrays whose shapes do not fit, or stiffnesses that are not positive and ascending.
    """
    springs, speeds = np.asarray(stiffnesses, dtype=np.float64), np.asarray(critical_speeds, dtype=np.float64)
    ascending = springs.ndim == 1 and springs.size > 1 and bool((springs[0] > 0.0) & (np.diff(springs) > 0.0).all())
    if not ascending or speeds.ndim != 2 or speeds.shape[0] != springs.size:
        raise ValueError(
            f"stiffnesses {springs.shape} and critical speeds {speeds.shape} are not two or more ascending positive "
            "stiffnesses (k,) and an array (k, c)"
        )
    speeds = np.where(speeds > 0.0, speeds, np.nan)
    low, high = _limits(speeds, operating_speed)
    curves = _curves(bearings, low, high)
    labels = [Label(curve.name, float(curve.stiffness[-1]), RPM * float(curve.turning[-1])) for curve in curves]
    inside = [label for label in labels if springs[0] <= label.x <= springs[-1]]
    span = np.log(springs[-1] / springs[0])
    row = arrange(inside, [PANEL_WIDTH * np.log(label.x / springs[0]) / span for label in inside], PANEL_WIDTH)

    notes = [f"{whirl} whirl, all bearings of one stiffness"]
    notes += ["○ at a bearing's own stiffness, in rpm"] * bool(curves)
    notes += ["● where operation is critical"] * (operating_speed is not None)
    figure = sheet(HEAD + row.height + 2.0 + _HEIGHT + FOOT, title, "; ".join(notes))
    axes = panel(figure, FOOT, _HEIGHT)
    axes.set(xscale="log", yscale="log", xlim=(springs[0], springs[-1]), ylim=(RPM * low, RPM * high))
    axes.set(xlabel="bearing stiffness [N/m]", ylabel="critical speed [rpm]")
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    for number, branch in enumerate(speeds.T, start=1):
        axes.plot(springs, RPM * branch, color=BLUE, lw=1.2, zorder=3, label="critical speed")
        _number(axes, springs, branch, number)
    marked = []
    for curve in curves:
        axes.plot(
            curve.stiffness, RPM * curve.turning, color=curve.color, ls=curve.line, lw=1.0, zorder=2, label=curve.name
        )
        for stiffness, speed in map_intersections(springs, speeds, curve.turning, curve.stiffness):
            axes.plot(
                stiffness, RPM * speed, marker="o", ms=4.0, color=curve.color, mfc="white", zorder=4, label="meeting"
            )
            marked.append(Label(f"{RPM * speed:.0f}", stiffness, RPM * speed, curve.color))
    _write_beside(axes, marked)
    if operating_speed is not None:
        at = abs(operating_speed)
        line = axes.axhline(RPM * at, color=INK, lw=0.8, ls=":", zorder=1, label="operation")
        for stiffness in _reached(springs, speeds, at):
            axes.plot(stiffness, RPM * at, marker="o", ms=4.0, color=INK, zorder=4, label="operation is critical")
        legend(figure, [line])
    draw_row(axes, row, _HEIGHT + 1.0)
    return figure


def map_intersections(
    stiffnesses: FloatArray, critical_speeds: FloatArray, turning: FloatArray, stiffness: FloatArray
) -> list[tuple[float, float]]:
    """Return stiffness [N/m] and speed [rad/s] of the intersections of a bearing's stiffness with critical speeds.

    Both are straight between their points on logarithmic axes.

    Parameters
    ----------
    stiffnesses, critical_speeds : ndarray, shapes (k,) and (k, c)
        As in :func:`draw_critical_map`.
    turning, stiffness : ndarray, shape (n,)
        Ascending speeds [rad/s], and the bearing's stiffness at them [N/m].
    """
    met = []
    ends = np.log(turning[[0, -1]])
    for branch in critical_speeds.T:
        moving = np.flatnonzero(branch > 0.0)
        x, y = np.log(stiffnesses[moving]), np.log(branch[moving])
        # A table may end between two points of the branch; beyond it the stiffness is unknown.
        rising = moving.size > 0 and bool((np.diff(y) >= 0.0).all())
        inside = ends[(ends > y[0]) & (ends < y[-1])] if rising else np.empty(0)
        x, y = np.append(x, np.interp(inside, y, x)) if inside.size else x, np.append(y, inside)
        order = np.argsort(x, kind="stable")
        x, y = x[order], y[order]
        # Logarithm of the bearing's stiffness at a critical speed over the stiffness that belongs to that speed.
        excess = np.interp(y, np.log(turning), np.log(stiffness), left=np.nan, right=np.nan) - x
        for index in np.flatnonzero((excess[1:] <= 0.0) & (excess[:-1] > 0.0)):
            part = excess[index] / (excess[index] - excess[index + 1])
            met.append(tuple(np.exp(line[index] + part * (line[index + 1] - line[index])).item() for line in (x, y)))
    return met


def _reached(stiffnesses: FloatArray, critical_speeds: FloatArray, speed: float) -> list[float]:
    """Return stiffnesses [N/m] at which a given speed [rad/s] is critical; lines are straight on logarithmic axes."""
    reached = []
    for branch in critical_speeds.T:
        moving = np.flatnonzero(branch > 0.0)
        x, gap = (
            np.log(stiffnesses[moving]),
            np.log(branch[moving]) - np.log(speed) if speed > 0.0 else np.ones(moving.size),
        )
        for index in np.flatnonzero((gap[1:] > 0.0) != (gap[:-1] > 0.0)):
            part = gap[index] / (gap[index] - gap[index + 1])
            reached.append(float(np.exp(x[index] + part * (x[index + 1] - x[index]))))
    return reached


def _number(axes: Axes, stiffnesses: FloatArray, branch: FloatArray, number: int) -> None:
    """Write the number of a branch's critical speed where the branch begins."""
    moving = np.flatnonzero(branch > 0.0)
    if moving.size:
        place = (float(stiffnesses[moving[0]]), RPM * float(branch[moving[0]]))
        axes.annotate(f"{number}", place, (2.0, 2.0), textcoords="offset points", fontsize=NOTE, color=BLUE)


def _write_beside(axes: Axes, marked: Sequence[Label]) -> None:
    """Write values below their marks to the right, else above to the left, unless both would touch other values."""
    per_mm = axes.figure.dpi / MM_PER_INCH
    places = [axes.transData.transform((label.x, label.y)) / per_mm for label in marked]
    used: list[FloatArray] = []
    for label, place in sorted(zip(marked, places, strict=True), key=lambda pair: tuple(pair[1])):
        for (right, up), side in (((1.2, -3.2), "left"), ((-1.2, 0.8), "right")):
            middle = place + (right + (0.5 if side == "left" else -0.5) * _VALUE[0], up + 0.5 * _VALUE[1])
            if all(bool((np.abs(middle - used_place) > _VALUE).any()) for used_place in used):
                offset = (right * _POINTS_PER_MM, up * _POINTS_PER_MM)
                point = (label.x, label.y)
                axes.annotate(
                    label.text,
                    point,
                    offset,
                    textcoords="offset points",
                    fontsize=NOTE,
                    color=label.color,
                    ha=side,
                    bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.3},
                )
                used.append(middle)
                break


def _limits(speeds: FloatArray, operating: float | None) -> tuple[float, float]:
    """Return the ends of the axis of speeds [rad/s]."""
    values = speeds[np.isfinite(speeds)].tolist() + ([abs(operating)] if operating else [])
    return (0.8 * min(values), 1.25 * max(values)) if values else (1.0, 10.0)


def _curves(bearings: Sequence[Bearing], low: float, high: float) -> list[_Curve]:
    """Return the bearings' stiffness in x and y between two speeds [rad/s]; equal curves are one."""
    named: dict[tuple[bytes, bytes], tuple[list[str], FloatArray, FloatArray]] = {}
    for bearing in bearings:
        turning = np.geomspace(low, high, _SAMPLES)
        if bearing.speeds is not None:
            begin, end = max(low, float(bearing.speeds[0])), min(high, float(bearing.speeds[-1]))
            if end <= begin:
                continue
            turning = np.geomspace(begin, end, _SAMPLES)
        stiffness = np.array([np.diag(bearing.at_speed(speed).radial_stiffness) for speed in turning])
        key = turning.tobytes(), stiffness.tobytes()
        named.setdefault(key, ([], turning, stiffness))[0].append(bearing.name)
    curves = []
    for number, (names, turning, stiffness) in enumerate(named.values()):
        alike = bool((stiffness[:, 0] == stiffness[:, 1]).all())
        label = shortened(", ".join(names), 18)
        color = SERIES[1 + number % (len(SERIES) - 1)]
        for column, (symbol, line) in enumerate(_LINES):
            if (stiffness[:, column] > 0.0).all() and not (alike and column):
                name = f"{label}: k_xx = k_yy" if alike else f"{label}: {symbol}"
                curves.append(_Curve(name, color, line, turning, stiffness[:, column]))
    return curves
