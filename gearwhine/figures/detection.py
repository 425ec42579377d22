"""Figures of the detectability of a fault: sizes that are seen, responses over the size, probability of detection."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, MaxNLocator

from gearwhine.coupling.analyses.gear_condition import INDICATORS
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    INK,
    LABEL,
    LEFT,
    RED,
    SERIES,
    TICK,
    legend_below,
    legend_height,
    log_axis,
    name_in_legend,
    panel,
    panel_title,
    plain,
    sheet,
    shortened,
    stacked,
)
from gearwhine.numerics.detection_probability import CONFIDENCE, SignalResponse

if TYPE_CHECKING:
    import numpy.typing as npt
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from gearwhine.detection.detectability import Detectability, DetectionResult

_HEIGHT, _GAP = 36.0, 12.0  # of a panel, and between two [mm]
_ROW, _NAMES = 8.0, 46.0  # height of a row of the matrix, and width of the names beside it [mm]
_MOST_RESPONSES = 4
_MOST_CURVES = 4
_SAME_CURVE = 1e-3  # difference of probabilities up to which two curves lie on each other
_MOST_SENSORS = 8
_DETECTED = 0.9
_LONG_NAME = 24  # letters beyond which the name of an axis is smaller
_WIDE = 50.0  # ratio of the largest value to the least beyond which an axis is logarithmic
_DASH = 5.0  # length of a dash of lines that lie on each other, in line widths
_SPREAD = 0.006  # shift of dots beside each other, over the width of the panel


def draw_detection(title: str, found: DetectionResult) -> Iterator[tuple[str, Figure]]:
    """Draw a detection study: yields the name of each figure and the figure."""
    yield "detection-matrix", _matrix(title, found)
    ranked = _ranked(found)
    for number, indicator in enumerate(ranked[:_MOST_RESPONSES], start=1):
        yield f"detection-responses-{number}", _responses(title, found, indicator)
    if any(one.detection is not None for one in found.parts):
        yield "detection-probability", _probabilities(title, found)


def _ranked(found: DetectionResult) -> list[str]:
    """Return the indicators by the smallest fault that each sees at any sensor, of two alike the first."""

    def rank(column: int) -> tuple[int, float]:
        sizes = found.matrix[:, column]
        seen = sizes[np.isfinite(sizes)]
        return (-len(seen), float(np.sum(seen)))

    order = sorted(range(len(found.monitor.indicators)), key=rank)
    drawn = [found.monitor.indicators[column] for column in order if np.isfinite(found.matrix[:, column]).any()]
    return drawn or [found.monitor.indicators[0]]


def _in_brackets(found: DetectionResult) -> str:
    unit = found.shown_unit[0].replace("um", "µm")
    return f" [{unit}]" if unit else ""


def _size_label(found: DetectionResult) -> str:
    return shortened(f"{found.fault}{_in_brackets(found)}", 60)


def _matrix(title: str, found: DetectionResult) -> Figure:
    """Draw the sizes that are found with a probability of 0.9 by sensor and indicator."""
    indicators, sensors = found.monitor.indicators, found.monitor.sensors
    factor, height = found.shown_unit[1], _ROW * len(found.monitor.indicators)
    figure = sheet(
        HEAD + FOOT + height,
        f"Size of the fault that is found{_in_brackets(found)}",
        f"{shortened(title, 40)}; a90, with a90/95 in brackets: {found.fault}. Dash: none of these sizes, "
        "empty: undefined.",
    )
    width = 160.0 - LEFT - _NAMES
    axes = panel(figure, FOOT, height, left=LEFT + _NAMES - 8.0, width=width)
    low, high = min(found.severities), max(found.severities)
    for row, indicator in enumerate(reversed(indicators)):
        for column, sensor in enumerate(sensors):
            one = found.part(sensor, indicator)
            share = 0.0 if one.a90 is None else 0.15 + 0.6 * (high - one.a90) / (high - low)
            axes.fill_between([column - 0.5, column + 0.5], row - 0.5, row + 0.5, color=BLUE, alpha=share, lw=0.0)
            axes.text(column, row, _cell(one, factor, low), ha="center", va="center", fontsize=TICK, color=INK)
    axes.set_xlim(-0.5, len(sensors) - 0.5)
    axes.set_ylim(-0.5, len(indicators) - 0.5)
    axes.set_xticks(range(len(sensors)), [shortened(name, int(60 / len(sensors)) + 4) for name in sensors])
    axes.set_yticks(range(len(indicators)), [INDICATORS[name].title for name in reversed(indicators)])
    axes.grid(visible=False)
    axes.tick_params(length=0.0)
    for side in axes.spines.values():
        side.set_visible(False)
    axes.set_xlabel("sensor")
    return figure


def _cell(one: Detectability, factor: float, least: float) -> str:
    if one.detection is None:
        return ""
    if one.a90 is None:
        return "–"

    def text(size: float | None) -> str:
        if size is None:
            return "–"
        return ("≤ " if size <= least else "") + plain(factor * size)

    return f"{text(one.a90)} ({text(one.a90_95)})"


def _axis_of(found: DetectionResult, indicator: str) -> str:
    """Return the name of an indicator's axis, with its unit."""
    one = INDICATORS[indicator]
    if found.monitor.has_own_baseline and one.growth != "itself":
        return f"{one.title}, {'over' if one.growth == 'ratio' else 'less'} earlier"
    return f"{one.title} [m/s²]" if one.key.endswith("_m_per_s2") else one.title


def _sheet(found: DetectionResult, heading: str, note: str, foot: float) -> tuple[Figure, list[Axes], tuple[str, ...]]:
    sensors = found.monitor.sensors[:_MOST_SENSORS]
    return *stacked(len(sensors), _HEIGHT, _GAP, heading, note, first=5.0, foot=foot), sensors


def _responses(title: str, found: DetectionResult, indicator: str) -> Figure:
    """Draw an indicator over the size of the fault at every sensor."""
    factor = found.shown_unit[1]
    figure, panels, sensors = _sheet(
        found,
        f"{INDICATORS[indicator].title} over the size of the fault",
        f"{shortened(title, 40)}; dots: gearboxes, at 0 healthy ones; red: threshold of a false-alarm rate of "
        f"{found.monitor.false_alarm:g} with its 95 % interval, as far as it has ends; blue: median, and "
        "line where one is fitted.",
        FOOT,
    )
    for axes, sensor in zip(panels, sensors, strict=True):
        one = found.part(sensor, indicator)
        largest = factor * max(found.severities)
        rng = np.random.default_rng(1)
        healthy = one.healthy[np.isfinite(one.healthy)]
        axes.plot(_SPREAD * largest * rng.normal(size=healthy.size), healthy, ".", color=GREY, ms=2.5, alpha=0.5)
        beside = _SPREAD * largest * rng.normal(size=one.sizes.size)
        axes.plot(factor * one.sizes + beside, one.responses, ".", color=BLUE, ms=3.5, alpha=0.7)
        sizes = np.unique(one.sizes)
        medians = [
            float(np.median(values)) if (values := _known(one, size)).size else np.nan for size in sizes.tolist()
        ]
        axes.plot(factor * sizes, medians, "_", color=BLUE, ms=9.0, mew=1.3)
        if one.detection is not None and isinstance(one.detection.curve, SignalResponse):
            grid = np.linspace(float(sizes[0]), float(sizes[-1]), 100)
            line = one.detection.curve
            values = line.coefficients[0] + line.coefficients[1] * (np.log(grid) if line.log_size else grid)
            axes.plot(factor * grid, np.exp(values) if line.log_response else values, color=BLUE, lw=1.0)
        if one.threshold is not None:
            axes.axhline(one.threshold.value, color=RED, lw=1.1)
            # An end that the samples do not bound is none to draw.
            low, high = (
                end if np.isfinite(end) else one.threshold.value for end in (one.threshold.low, one.threshold.high)
            )
            axes.axhspan(low, high, color=RED, alpha=0.12, lw=0.0)
        _scale(axes, [healthy, one.responses, [] if one.threshold is None else [one.threshold.value]])
        name = _axis_of(found, indicator)
        axes.set_ylabel(name, size=TICK if len(name) > _LONG_NAME else LABEL)
        seen = "not seen" if one.a90 is None else f"a90 = {_cell(one, factor, min(found.severities))}"
        panel_title(axes, f"{sensor}: {one.undefined or seen}")
    panels[-1].set_xlabel(_size_label(found))
    return figure


def _scale(axes: Axes, parts: Sequence[npt.ArrayLike]) -> None:
    """Give a panel the axis of its values: logarithmic where these are positive and span decades."""
    values = np.concatenate([np.asarray(part, dtype=np.float64).ravel() for part in parts])
    values = values[np.isfinite(values)]
    if values.size and values.min() > 0.0 and values.max() > _WIDE * values.min():
        margin = (values.max() / values.min()) ** 0.06
        log_axis(axes, float(values.min() / margin), float(values.max() * margin))
    else:
        axes.yaxis.set_major_locator(MaxNLocator(5))
        # A power of ten above the axis would stand in the panel's title.
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.6g}"))


def _known(one: Detectability, size: float) -> np.ndarray:
    values = one.responses[one.sizes == size]
    return np.asarray(values[np.isfinite(values)])


def _drawn_curves(found: DetectionResult) -> list[str]:
    """Return the indicators whose curves are drawn: the best of every sensor, then those that see the most."""
    best = dict.fromkeys(one.indicator for one in found.best.values() if one is not None)
    return list(best | dict.fromkeys(_ranked(found)))[: min(max(len(best), _MOST_CURVES), len(SERIES))]


def _probabilities(title: str, found: DetectionResult) -> Figure:
    """Draw the probability of detection over the size at every sensor, of the indicators that see the most."""
    factor = found.shown_unit[1]
    drawn = _drawn_curves(found)
    colours = dict(zip(drawn, SERIES, strict=False))
    foot = FOOT + legend_height(len(drawn))
    figure, panels, sensors = _sheet(
        found,
        "Probability of detection",
        f"{shortened(title, 40)}; dots: share found of each size; band: down to the lower 95 % bound, of the sensor's "
        "best indicator; dashes of several colours: curves that lie on each other.",
        foot,
    )
    handles = [
        Line2D([], [], color=colour, lw=1.3, label=name_in_legend(INDICATORS[indicator].title, 24))
        for indicator, colour in colours.items()
    ]
    grid = np.linspace(min(found.severities), max(found.severities), 120)
    for axes, sensor in zip(panels, sensors, strict=True):
        best = found.best[sensor]
        seen_by = {name: by for name in drawn if (by := found.part(sensor, name).detection) is not None}
        curves = {name: np.array([one.curve.probability(a) for a in grid.tolist()]) for name, one in seen_by.items()}
        for indicator, one in seen_by.items():
            values, colour = curves[indicator], colours[indicator]
            alike = [name for name, other in curves.items() if np.allclose(other, values, atol=_SAME_CURVE)]
            rank, count = alike.index(indicator), len(alike)
            dashes = "-" if count == 1 else (rank * _DASH, (_DASH, (count - 1) * _DASH))
            axes.plot(factor * grid, values, color=colour, lw=1.3, ls=dashes, label=indicator, dash_capstyle="butt")
            if best is not None and best.indicator == indicator:
                bound = [one.curve.bound(size, CONFIDENCE) for size in grid.tolist()]
                axes.fill_between(factor * grid, bound, values, color=colour, alpha=0.15, lw=0.0)
            hits = [share.found / share.total for share in one.shares]
            # Dots on each other: the larger ones are below.
            size = 4.0 + 2.0 * (count - 1 - rank)
            axes.plot([factor * share.size for share in one.shares], hits, ".", color=colour, ms=size)
        axes.axhline(_DETECTED, color=GREY, lw=0.8, ls=":")
        axes.set_ylim(-0.04, 1.04)
        axes.set_ylabel("probability")
        seen = "none sees it" if best is None else f"{INDICATORS[best.indicator].title}, a90 = "
        seen += "" if best is None else _cell(best, factor, min(found.severities))
        panel_title(axes, f"{sensor}: {seen}")
    panels[-1].set_xlabel(_size_label(found))
    legend_below(figure, handles)
    return figure
