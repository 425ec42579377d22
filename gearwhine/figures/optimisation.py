"""Figures of an optimisation: convergence, the Pareto front, and the aim over the designed keys."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import combinations
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    INK,
    LABEL,
    RED,
    RPM,
    SERIES,
    TICK,
    legend_below,
    legend_height,
    name_in_legend,
    name_lowest,
    panel,
    panel_pair,
    panel_title,
    sheet,
    shortened,
    stacked,
)
from gearwhine.optimisation.verification import Motion, Verification
from gearwhine.variation.named_quantities import part_of, shown_quantity, shown_unit, statistic_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from gearwhine.numerics.arrays import FloatArray
    from gearwhine.optimisation.optimised import Optimised

Mask = npt.NDArray[np.bool_]
_HEIGHT, _GAP = 42.0, 16.0  # of a panel, and between two [mm]
_TITLES = 5.0  # for the titles of the upper panels [mm]
_MOST_PANELS = 6
_LONG_LABEL = 34  # letters beyond which a label is smaller than a panel's height


def draw_optimisation(title: str, optimised: Optimised) -> Iterator[tuple[str, Figure]]:
    """Draw an optimisation: yields the name of each figure and the figure."""
    if not optimised.chosen:
        return
    begins = f"{shortened(title, 40)}; " if title else ""
    yield "optimise-convergence", _convergence(begins, optimised)
    if optimised.goals.count > 1:
        yield "optimise-front", _fronts(begins, optimised)
    yield "optimise-keys", _over_keys(optimised)
    checked = optimised.verification
    if checked is not None and isinstance(checked.start, Motion) and checked.start.over_speed:
        yield "optimise-levels", _over_speed(begins, optimised.chosen.values(), checked, checked.start)


def _over_speed(begins: str, labels: Iterable[str], checked: Verification, start: Motion) -> Figure:
    """Draw the levels of start and proposed designs over the speed range."""
    sensors = list(start.over_speed)[:_MOST_PANELS]
    designs = [("start", start), *zip(labels, checked.designs, strict=True)][: len(SERIES)]
    solved = [(label, one) for label, one in designs if isinstance(one, Motion)]
    low = legend_height(len(solved))
    note = f"{begins}lines of the teeth by the linear machine under load."
    title = "Levels over the speed range"
    figure, panels = stacked(len(sensors), _HEIGHT, _GAP, title, note, first=_TITLES, foot=FOOT + low)
    for sensor, axes in zip(sensors, panels, strict=True):
        for color, (_, one) in zip((GREY, *SERIES), solved, strict=False):
            axes.plot(RPM * one.speeds, one.over_speed[sensor], color=color, lw=1.2)
        axes.set_ylabel("level [dB re 1 µm/s²]")
        panel_title(axes, sensor)
    name_lowest(panels, "speed [rpm]")
    marks = [
        Line2D([], [], color=color, lw=1.2, label=name_in_legend(label, 36))
        for color, (label, _) in zip((GREY, *SERIES), solved, strict=False)
    ]
    legend_below(figure, marks)
    return figure


def _masks(optimised: Optimised) -> tuple[Mask, Mask]:
    """Masks of the designs within all limits, and of those that miss some, shape (n,)."""
    solved = np.array([one.failure is None for one in optimised.designs])
    within = np.isin(np.arange(len(optimised.designs)), optimised.within)
    return within, solved & ~within


def _values(optimised: Optimised, place: int) -> FloatArray:
    """Values of an aim of each design as they are shown, shape (n,)."""
    factor = shown_quantity(optimised.goals.aims[place].name)[1]
    return factor * np.array([one.aims[place] for one in optimised.designs])


def _label(optimised: Optimised, place: int) -> str:
    name = optimised.goals.aims[place].name
    of = statistic_of(name)[1].rpartition(".")[0] if "*" in name else part_of(name)
    return f"{of}, {shown_quantity(name)[0]}".removeprefix(", ")


def _set_label(axes: Axes, text: str, *, across: bool) -> None:
    size = TICK if len(text) > _LONG_LABEL else LABEL
    (axes.set_xlabel if across else axes.set_ylabel)(shortened(text, 60), size=size, parse_math=False)


def _convergence(begins: str, optimised: Optimised) -> Figure:
    aims = list(range(len(optimised.goals.aims)))[:_MOST_PANELS]
    note = f"{begins}blue: within the limits, red: beyond; line: best so far, dashed: start."
    figure, panels = stacked(len(aims), _HEIGHT, _GAP, "Convergence", note, first=_TITLES)
    within, beyond = _masks(optimised)
    numbers = 1 + np.arange(len(optimised.designs))
    for place, axes in zip(aims, panels, strict=True):
        values, sign = _values(optimised, place), optimised.goals.aims[place].sign
        axes.plot(numbers[beyond], values[beyond], ".", color=RED, ms=3.0)
        axes.plot(numbers[within], values[within], ".", color=BLUE, ms=3.5)
        if optimised.goals.count == 1:
            # Of the one that is best so far by the sum of the aims.
            ranks = np.where(within, [one.merit[1] for one in optimised.designs], np.inf)
            best = [int(np.argmin(ranks[: number + 1])) for number in range(len(ranks))]
            so_far = np.where(np.isfinite(np.minimum.accumulate(ranks)), values[best], np.nan)
        else:
            so_far = sign * np.minimum.accumulate(np.where(within, sign * values, np.inf))
            so_far = np.where(np.isfinite(so_far), so_far, np.nan)
        axes.step(numbers, so_far, where="post", color=INK, lw=0.9)
        factor = shown_quantity(optimised.goals.aims[place].name)[1]
        axes.axhline(factor * float(optimised.start.aims[place]), color=GREY, lw=0.9, ls="--")
        axes.set_xlabel("design")
        axes.xaxis.set_major_locator(MaxNLocator(8, integer=True))
        of, _, unit = _label(optimised, place).partition(" [")
        axes.set_ylabel(unit.removesuffix("]"), size=TICK)
        panel_title(axes, of, 80)
    return figure


def _fronts(begins: str, optimised: Optimised) -> Figure:
    pairs = list(combinations(range(len(optimised.goals.aims)), 2))[:_MOST_PANELS]
    note = f"{begins}blue: front, ring: proposed, grey: others, red: beyond the limits, cross: start."
    figure, panels = stacked(len(pairs), 1.5 * _HEIGHT, _GAP, "Pareto front", note)
    within, beyond = _masks(optimised)
    front, chosen = optimised.front, [number for number in optimised.chosen if number in optimised.front]
    for (first, second), axes in zip(pairs, panels, strict=True):
        across, up = _values(optimised, first), _values(optimised, second)
        axes.plot(across[beyond], up[beyond], ".", color=RED, ms=2.5, alpha=0.6)
        axes.plot(across[within], up[within], ".", color=GREY, ms=3.0)
        order = sorted(front, key=lambda number: across[number])
        axes.plot(across[order], up[order], ".", color=BLUE, ms=5.0)
        if len(pairs) == 1:
            # Between two designs of the front the worse one in the first aim stands for what is to be had.
            where: Literal["post", "pre"] = "post" if optimised.goals.aims[first].sign > 0.0 else "pre"
            axes.step(across[order], up[order], where=where, color=BLUE, lw=0.9)
        axes.plot(across[chosen], up[chosen], "o", mfc="none", color=INK, ms=7.0)
        factors = [shown_quantity(optimised.goals.aims[place].name)[1] for place in (first, second)]
        start = [factor * float(optimised.start.aims[p]) for factor, p in zip(factors, (first, second), strict=True)]
        axes.plot(*start, "x", color=INK, ms=6.0)
        _set_label(axes, _label(optimised, first), across=True)
        _set_label(axes, _label(optimised, second), across=False)
    return figure


def _over_keys(optimised: Optimised) -> Figure:
    """Draw the first aim over each designed key."""
    inputs = optimised.inputs[:_MOST_PANELS]
    columns = min(len(inputs), 2)
    rows = -(-len(inputs) // columns)
    best = next(iter(optimised.chosen))
    figure = sheet(
        HEAD + _TITLES + FOOT + rows * _HEIGHT + (rows - 1) * _GAP,
        "Designs by their keys",
        f"{_label(optimised, 0)}; blue: within the limits, red: beyond, ring: design {best + 1}.",
    )
    within, beyond = _masks(optimised)
    values, points = _values(optimised, 0), optimised.values()
    for number, one in enumerate(inputs):
        row, column = divmod(number, columns)
        bottom = FOOT + (rows - 1 - row) * (_HEIGHT + _GAP)
        if columns == 1:
            axes = panel(figure, bottom, _HEIGHT)
        else:
            pair = panel_pair(figure, bottom, _HEIGHT)
            axes = pair[column]
            pair[1 - column].remove()
        unit, scale = shown_unit(one.unit)
        at = scale * points[:, number]
        axes.plot(at[beyond], values[beyond], ".", color=RED, ms=2.5, alpha=0.6)
        axes.plot(at[within], values[within], ".", color=BLUE, ms=3.5, alpha=0.8)
        axes.plot(at[best], values[best], "o", mfc="none", color=INK, ms=7.0)
        if one.words:
            axes.set_xticks(range(len(one.words)), [shortened(word, 12) for word in one.words])
        else:
            axes.xaxis.set_major_locator(MaxNLocator(5))
        axes.set_xlabel(unit or "value" if not one.words else "")
        panel_title(axes, shortened(one.name, 44))
    return figure
