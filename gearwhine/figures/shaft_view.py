"""Drawing scale of a shaft, the same along it and across it where space allows."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, MaxNLocator

from gearwhine.figures.assembly import RotorAssembly
from gearwhine.figures.style import PANEL_WIDTH, panel_size

FloatArray = npt.NDArray[np.float64]

MM = 1e3  # of a metre: shafts are drawn in millimetres

_MARGIN = 5.0  # beside the outermost of what is drawn [mm of paper]
_LEAST, _MOST = 14.0, 66.0  # height of a rotor between its largest diameters [mm of paper]
_TICKS_APART = 12.0  # at least [mm of paper]
_STRETCHES = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000)


@dataclass(frozen=True)
class ShaftView:
    """Position and scale of a shaft on paper.

    Attributes
    ----------
    low, high
        Ends of the axis along the shaft, mm from its left end.
    per_paper
        Millimetres of the shaft on one of the paper; both directions have it.
    stretch
        Exaggeration of the diameters, 1 where the picture is true to scale.
    half_height
        From the centre line to the largest radius, mm of paper.
    """

    low: float
    high: float
    per_paper: float
    stretch: int
    half_height: float

    def paper(self, z: float) -> float:
        """Position on paper of a station (m), mm from the left of the panel."""
        return (MM * z - self.low) / self.per_paper

    def length(self, paper: float) -> float:
        """A length on paper (mm) in the picture's coordinates."""
        return paper * self.per_paper

    def across(self, radius: float) -> float:
        """A radius (m) in the picture's coordinates."""
        return MM * radius * self.stretch

    def apply(self, axes: Axes, below: float) -> None:
        """Give a panel these limits, the centre line ``below`` mm of paper above its bottom."""
        bottom = -self.length(below)
        axes.set(xlim=(self.low, self.high), ylim=(bottom, bottom + self.length(panel_size(axes)[1])))

    def show_length(self, axes: Axes, length: float) -> None:
        """Give a panel an axis along the shaft, whose length is in m."""
        axes.set_xticks(_ticks(MM * length, MM * length / self.per_paper))
        axes.spines["bottom"].set_bounds(0.0, MM * length)

    def show_axes(self, axes: Axes, length: float, largest: float) -> None:
        """Give a panel axes along the shaft (its length in m) and of diameters up to the largest radius (m)."""
        self.show_length(axes, length)
        # Zero is the centre line, not a diameter worth a tick.
        half = 0.5 * self.stretch * _ticks(2.0 * MM * largest, 2.0 * self.half_height)[1:]
        axes.set_yticks([*(-half[::-1]), *half])
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{2.0 * abs(value) / self.stretch:g}"))
        axes.spines["left"].set_bounds(-self.across(largest), self.across(largest))
        low, high = axes.get_ylim()
        axes.set_ylabel("diameter [mm]")
        across, _ = axes.yaxis.label.get_position()
        axes.yaxis.set_label_coords(across, -low / (high - low))


def _ticks(largest: float, paper: float) -> FloatArray:
    """Round numbers from zero to the largest value, not closer than can be read where it has so much paper (mm)."""
    locator = MaxNLocator(nbins=max(int(paper / _TICKS_APART), 1), steps=[1, 2, 5, 10])
    ticks = np.asarray(locator.tick_values(0.0, largest))
    inside = ticks[(ticks >= 0.0) & (ticks <= largest * (1.0 + 1e-9))]
    return inside if inside.size > 1 else np.array([0.0, largest])


def fitted(assembly: RotorAssembly) -> ShaftView:
    """The largest true scale at which an assembly fits a panel; a slender one has its diameters stretched."""
    left, right = (MM * end for end in assembly.reach)
    radius = MM * assembly.largest_radius
    per_paper = max((right - left) / (PANEL_WIDTH - 2.0 * _MARGIN), 2.0 * radius / _MOST)
    stretch = next((step for step in _STRETCHES if 2.0 * radius * step / per_paper >= _LEAST), _STRETCHES[-1])
    middle, half = 0.5 * (left + right), 0.5 * PANEL_WIDTH * per_paper
    return ShaftView(middle - half, middle + half, per_paper, stretch, radius * stretch / per_paper)
