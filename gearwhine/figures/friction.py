"""Tooth friction over time: force across the line of action, and power loss."""

import numpy as np
from matplotlib.figure import Figure

from coupling import Histories
from gearwhine.figures.style import BLUE, GREY, RED, tidy

_PERIODS = 6  # of the mesh that are drawn


def draw_friction(title: str, histories: Histories, mesh_frequencies: dict[str, float]) -> Figure:
    """Draw six mesh periods of each contact with friction.

    Parameters
    ----------
    title
        Of the figure.
    histories
        With friction.
    mesh_frequencies
        Of the contacts, Hz.
    """
    shown = {name: found for name, found in histories.mesh_friction.items() if name in mesh_frequencies}
    figure = Figure(figsize=(9.0, 0.7 + 2.8 * len(shown)), layout="constrained")
    rows = figure.subplots(len(shown), 2, squeeze=False)
    for (left, right), (name, found) in zip(rows, shown.items(), strict=True):
        times = 1e3 * (histories.times - histories.times[0])
        kept = times <= 1e3 * _PERIODS / mesh_frequencies[name]
        left.plot(times[kept], found[kept, 0], color=BLUE, lw=1.0)
        left.axhline(0.0, color=GREY, lw=0.6)
        left.set(xlabel="time [ms]", ylabel="friction force [N]")
        left.set_title(f"{name}: across the line of action", fontsize=10, loc="left", parse_math=False)
        mean = float(np.mean(found[:, 1]))
        right.plot(times[kept], found[kept, 1], color=RED, lw=1.0)
        right.axhline(mean, color=GREY, lw=0.8, ls="--")
        right.set(xlabel="time [ms]", ylabel="friction takes [W]")
        right.set_title(f"{mean:.3g} W in the mean", fontsize=10, loc="left")
        tidy(left)
        tidy(right)
    figure.suptitle(title, fontsize=11, parse_math=False)
    return figure
