"""Orbits of gears: mean position of each centre, and its motion about it."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from gearwhine.figures.style import BLUE, GREY, INK, NOTE, RED, tidy

FloatArray = npt.NDArray[np.float64]


def draw_orbits(title: str, motions: Mapping[str, FloatArray]) -> Figure:
    """Draw each gear's centre from where it stands without load, and below enlarged about its mean.

    Parameters
    ----------
    title
        Of the figure.
    motions
        x, y of each gear's centre [m] in the first columns, shape (s, 2 or more). Gears of a row have one scale.
    """
    figure = Figure(figsize=(max(3.6 * len(motions), 5.0), 7.6), layout="constrained")
    rows = figure.subplots(2, len(motions), squeeze=False)
    orbits = {name: 1e6 * motion[:, :2] for name, motion in motions.items()}
    reach = [1.12 * max(float(np.abs(orbit).max()) for orbit in orbits.values()) or 1.0, 0.0]
    reach[1] = 1.12 * max(float(np.abs(orbit - orbit.mean(axis=0)).max()) for orbit in orbits.values()) or 1.0
    for column, (name, orbit) in enumerate(orbits.items()):
        above, below = rows[:, column]
        center = orbit.mean(axis=0)
        above.annotate("", center, (0.0, 0.0), arrowprops={"arrowstyle": "->", "color": RED, "lw": 0.9})
        above.plot([0.0], [0.0], marker="+", color=GREY, ms=7)
        above.plot(orbit[:, 0], orbit[:, 1], color=BLUE, lw=0.8)
        below.plot(*(orbit - center).T, color=BLUE, lw=0.5)
        below.plot([0.0], [0.0], marker="+", color=RED, ms=7)
        for axes, what, size in ((above, "x, y", reach[0]), (below, "about the mean: x, y", reach[1])):
            axes.set(xlim=(-size, size), ylim=(-size, size), aspect="equal", xlabel=f"{what} [µm]")
            tidy(axes)
        above.set_title(name, fontsize=10, parse_math=False)
        swing = 0.5 * np.ptp(orbit, axis=0)
        note = f"d.c. ({center[0]:.3g}, {center[1]:.3g}) µm\na.c. ±({swing[0]:.2g}, {swing[1]:.2g}) µm"
        above.text(0.03, 0.97, note, transform=above.transAxes, fontsize=NOTE + 1.0, color=INK, va="top")
    figure.suptitle(title, fontsize=11, parse_math=False)
    return figure
