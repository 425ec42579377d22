"""Figures of varied gearboxes: distributions, what they follow from, scatter over inputs, and bands over speed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.ticker import MaxNLocator

from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    INK,
    LEFT,
    PALE,
    RED,
    TICK,
    cut_within,
    name_lowest,
    panel,
    panel_pair,
    panel_title,
    sheet,
    shortened,
    stacked,
)
from gearwhine.figures.style import HEAD as STYLE_HEAD
from gearwhine.numerics.arrays import FloatArray
from gearwhine.variation.inputs import Pitches
from gearwhine.variation.named_quantities import part_of, shown_quantity, shown_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from gearwhine.variation.statistics import QuantityStatistics, VariedResult

_MOST_QUANTITIES = 6
_MOST_INPUTS = 8
_MOST_SCATTERS = 3
_FAR = 0.6  # part of the range of values beyond which a limit is not drawn
_HEIGHT, _GAP = 38.0, 16.0  # of a panel, and between two [mm]
HEAD = STYLE_HEAD + 5.0  # for the titles of the upper panels [mm]
_BAR = 5.0  # height of a bar [mm]
_NAMES = 52.0  # width for the names of inputs beside bars [mm]
_MOST_CURVES = 8
_NO_LINE = -100.0  # highest level that stands for none [dB]
_MOST_WIDENED = 20


def draw_variation(title: str, varied: VariedResult) -> Iterator[tuple[str, Figure]]:
    """Draw a varied case: yields the name of each figure and the figure."""
    headlines = varied.headlines[:_MOST_QUANTITIES]
    if not headlines:
        return
    yield "vary-distributions", _distributions(title, headlines)
    drawn = [one for one in headlines if _leading(one)]
    if drawn:
        yield "vary-importance", _importance(title, drawn)
    if any(one.change is not None for one in varied.widened):
        yield "vary-widening", _widening(title, varied)
    for number, one in enumerate(drawn[:_MOST_SCATTERS], start=1):
        yield f"vary-scatter-{number}", _scatter(title, varied, one)
    if len(varied.speeds) > 1 and varied.nominal.curves:
        yield "vary-speeds", _over_speed(title, varied)


def _begins(title: str, letters: int) -> str:
    """Return the begin of a note with the title, where there is one."""
    return f"{shortened(title, letters)}; " if title else ""


def _distributions(title: str, quantities: Sequence[QuantityStatistics]) -> Figure:
    columns = min(len(quantities), 2)
    rows, below = -(-len(quantities) // columns), 2.0
    limited = any(one.limit is not None for one in quantities)
    figure = sheet(
        HEAD + FOOT + below + rows * _HEIGHT + (rows - 1) * _GAP,
        "Distributions of varied gearboxes",
        f"{_begins(title, 50)}blue: without changes, {'red: limit, ' if limited else ''}grey: 5 %, median, 95 %.",
    )
    for number, one in enumerate(quantities):
        row, column = divmod(number, columns)
        _histogram(_place(figure, FOOT + below + (rows - 1 - row) * (_HEIGHT + _GAP), column, columns), one)
    return figure


def _place(figure: Figure, bottom: float, column: int, columns: int) -> Axes:
    """Return a panel of a row of one or two."""
    if columns == 1:
        return panel(figure, bottom, _HEIGHT)
    pair = panel_pair(figure, bottom, _HEIGHT)
    pair[1 - column].remove()
    return pair[column]


def _histogram(axes: Axes, one: QuantityStatistics) -> None:
    name, factor = shown_quantity(one.name)
    values = factor * one.found
    bins = min(max(int(np.sqrt(values.size)), 8), 40) if one.scatters else 1
    axes.hist(values, bins=bins, color=PALE, edgecolor=GREY, linewidth=0.5)
    for value in one.quantiles.values():
        axes.axvline(factor * value, color=GREY, lw=0.8)
    axes.axvline(factor * one.nominal, color=BLUE, lw=1.2)
    for end in _limits(one, factor):  # however far: the axis reaches to it
        axes.axvline(end, color=RED, lw=1.2)
    axes.set_xlabel(name)
    axes.set_ylabel("gearboxes")
    axes.xaxis.set_major_locator(MaxNLocator(5))
    axes.yaxis.set_major_locator(MaxNLocator(4, integer=True))
    share = one.share
    within = "" if share is None else f": {100.0 * share.share:.1f} % within"
    panel_title(axes, f"{part_of(one.name)}{within}")


def _limits_near(one: QuantityStatistics, values: FloatArray, factor: float) -> list[float]:
    """Return the ends of a limit that are near enough to the values to be drawn beside them."""
    if one.limit is None:
        return []
    low, high = float(values.min()), float(values.max())
    reach = _FAR * (high - low)
    return [end for end in _limits(one, factor) if low - reach <= end <= high + reach]


def _limits(one: QuantityStatistics, factor: float) -> list[float]:
    """Return the ends of a limit in the unit that is shown."""
    ends = () if one.limit is None else (one.limit.at_least, one.limit.at_most)
    return [factor * end for end in ends if end is not None]


def _leading(one: QuantityStatistics) -> dict[str, float]:
    """Return how much each input matters, the most first; where none explains a part, the rank correlations."""
    importance = one.importance()
    if not importance:
        return one.leading_ranks
    return {name: importance[name] for name in sorted(importance, key=lambda name: -importance[name])}


def _importance(title: str, quantities: Sequence[QuantityStatistics]) -> Figure:
    by_index = quantities[0].indices is not None
    note = "total-order Sobol' index, its 95 % interval" if by_index else "inputs that the samples prove to matter"
    counts = [min(len(_leading(one)), _MOST_INPUTS) for one in quantities]
    heights = [count * _BAR for count in counts]
    gap = 17.0
    figure = sheet(
        HEAD + FOOT + sum(heights) + gap * (len(heights) - 1), "What matters", f"{_begins(title, 60)}{note}."
    )
    bottom = FOOT
    for one, height in reversed(list(zip(quantities, heights, strict=True))):
        axes = panel(figure, bottom, height, left=LEFT + _NAMES, width=160.0 - LEFT - _NAMES - 6.0)
        _bars(axes, one)
        bottom += height + gap
    return figure


def _bars(axes: Axes, one: QuantityStatistics) -> None:
    leading = _leading(one)
    names = list(leading)[:_MOST_INPUTS]
    places = np.arange(len(names))[::-1]
    if one.indices is None:
        values = np.array([leading[name] for name in names])
        axes.barh(places, values, height=0.62, color=BLUE)
        axes.set_xlim(0.0 if one.explained else -1.0, 1.0)
        axes.set_xlabel("part of the variance by the input alone" if one.explained else "rank correlation")
        if not one.explained:
            axes.axvline(0.0, color=GREY, lw=0.8)
    else:
        axes.set_xlabel("total-order index")
        rows = [one.input_names.index(name) for name in names]
        values, interval = one.indices.total[rows], one.indices.total_interval[rows]
        axes.barh(places, values, height=0.62, color=BLUE)
        axes.hlines(places, interval[:, 0], interval[:, 1], color=INK, lw=0.9)
        axes.set_xlim(0.0, max(1.0, float(interval.max())))
    axes.set_yticks(places, [cut_within(name, 40) for name in names], fontsize=TICK)
    axes.set_ylim(-0.6, len(names) - 0.4)
    axes.grid(visible=False, axis="y")
    panel_title(axes, f"{part_of(one.name)}: {shown_quantity(one.name)[0].partition(' [')[0]}")


def _widening(title: str, varied: VariedResult) -> Figure:
    """Draw the change of the yield by each wider input, with its interval."""
    rows = [one for one in varied.widened if one.change is not None][:_MOST_WIDENED]
    height = max(len(rows), 2) * _BAR
    figure = sheet(
        HEAD + FOOT + height,
        f"What tolerances wider by a factor of {varied.widening:g} cost",
        f"{_begins(title, 50)}the same gearboxes with one input wider; line: 95 % interval.",
    )
    axes = panel(figure, FOOT, height, left=LEFT + _NAMES, width=160.0 - LEFT - _NAMES - 6.0)
    places = np.arange(len(rows))[::-1]
    changes = 100.0 * np.array([[one.change.difference, one.change.low, one.change.high] for one in rows if one.change])
    axes.barh(places, changes[:, 0], height=0.62, color=BLUE)
    axes.hlines(places, changes[:, 1], changes[:, 2], color=INK, lw=0.9)
    axes.axvline(0.0, color=GREY, lw=0.8)
    axes.set_yticks(places, [cut_within(one.name, 40) for one in rows], fontsize=TICK)
    axes.set_ylim(-0.6, len(rows) - 0.4)
    axes.grid(visible=False, axis="y")
    axes.set_xlabel("change of the yield [percentage points]")
    return figure


def _scatter(title: str, varied: VariedResult, one: QuantityStatistics) -> Figure:
    """Draw a quantity over the inputs that matter most to it."""
    names = list(_leading(one))[:4]
    columns = min(len(names), 2)
    rows = -(-len(names) // columns)
    label, factor = shown_quantity(one.name)
    words, _, unit_of_label = label.partition(" [")
    beyond = "" if one.limit is None else ", red where it is beyond the limit"
    figure = sheet(
        HEAD + FOOT + rows * _HEIGHT + (rows - 1) * _GAP,
        f"{part_of(one.name)}: {words}",
        f"{_begins(title, 60)}each dot is a gearbox{beyond}.",
    )
    chosen = np.isfinite(one.values)
    good = np.array([one.limit is None or one.limit.holds(value) for value in one.values.tolist()])
    for number, name in enumerate(names):
        row, column = divmod(number, columns)
        axes = _place(figure, FOOT + (rows - 1 - row) * (_HEIGHT + _GAP), column, columns)
        place = one.input_names.index(name)
        of_input = varied.inputs[place]
        unit, scale = shown_unit(of_input.unit)
        for mask, colour in ((chosen & good, BLUE), (chosen & ~good, RED)):
            of_quantity = factor * one.values[mask]
            axes.plot(scale * one.inputs[mask, place], of_quantity, ".", color=colour, ms=2.2, alpha=0.6)
        for end in _limits_near(one, factor * one.values[chosen], factor):
            axes.axhline(end, color=RED, lw=0.8)
        of_range = ", range" if isinstance(of_input.law, Pitches) else ""
        axes.set_xlabel(f"{cut_within(name, 36)}{of_range} [{unit}]" if unit else cut_within(name, 44))
        if of_input.words:
            shown = range(len(of_input.words))
            axes.set_xticks(list(shown), [shortened(word, 12) for word in of_input.words])
        else:
            axes.xaxis.set_major_locator(MaxNLocator(5))
        if column == 0:
            axes.set_ylabel(unit_of_label.rstrip("]") or label)  # the title has the rest
    return figure


def _heard(levels: FloatArray) -> FloatArray:
    """Return levels [dB] without those that stand for no line, as where the mesh frequency is beyond the modes."""
    return np.where(levels > _NO_LINE, levels, np.nan)


def _over_speed(title: str, varied: VariedResult) -> Figure:
    curves = list(varied.nominal.curves)[:_MOST_CURVES]
    red = ", red: limit" if any(name in varied.limits for name in curves) else ""
    note = f"{_begins(title, 32)}line: without changes, band: 5 to 95 % of the gearboxes, dashed: the highest{red}."
    figure, panels = stacked(len(curves), 34.0, 8.0, "Levels over speed", note, first=HEAD - STYLE_HEAD)
    rpm = np.abs(varied.speeds) * 30.0 / np.pi
    order = np.argsort(rpm)
    for name, axes in zip(curves, panels, strict=True):
        values = varied.curve(name)[varied.representative]
        values = values[np.all(np.isfinite(values), axis=1)][:, order]
        if len(values):
            low, high = map(_heard, np.quantile(values, (0.05, 0.95), axis=0))
            axes.fill_between(rpm[order], low, high, color=PALE, edgecolor=GREY, lw=0.5)
            axes.plot(rpm[order], _heard(values.max(axis=0)), "--", color=GREY, lw=0.8)
        axes.plot(rpm[order], _heard(varied.nominal.curves[name][order]), ".-", color=BLUE, lw=1.2, ms=4.0)
        limit = varied.limits.get(name)
        for end in () if limit is None else (limit.at_least, limit.at_most):
            if end is not None:
                axes.axhline(end, color=RED, lw=1.0)
        axes.set_ylabel("level [dB]")
        quantity = shown_quantity(name)[0].partition(" [")[0].removeprefix("highest ").removesuffix(" over speed")
        panel_title(axes, f"{part_of(name)}, {quantity}")
    name_lowest(panels, "speed [rpm]")
    return figure
