"""COMAC and enhanced COMAC over the degrees of freedom of a survey, the worst of them named."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearwhine.figures.labels import Label, arrange, draw_row
from gearwhine.figures.style import BLUE, FOOT, HEAD, PANEL_WIDTH, RED, panel, sheet

FloatArray = npt.NDArray[np.float64]

_CRITERIA_HEIGHT, _CRITERIA_GAP = 40.0, 5.0  # of a panel, and between them [mm of paper]
_NAMED = 6  # at most, of the degrees of freedom that stand out
_STANDS_OUT = 2.0  # times the median of the enhanced criterion


def draw_coordinate_criteria(title: str, comac: FloatArray, enhanced: FloatArray, names: Sequence[str]) -> Figure:
    """Draw both criteria as bars in the survey's order; red what stands out by the one that sees signs and gains.

    Parameters
    ----------
    title
        Of the sheet.
    comac, enhanced
        (n,): NaN where unknown.
    names
        (n,): of the degrees of freedom, such as ``12 +z``.

    Raises
    ------
    ValueError
        Arrays that do not fit.
    """
    count = len(names)
    if comac.shape != (count,) or enhanced.shape != (count,) or count == 0:
        raise ValueError(f"criteria of shapes {comac.shape} and {enhanced.shape} for {count} degrees of freedom")
    known = np.flatnonzero(np.isfinite(enhanced))
    worst = known[np.argsort(-enhanced[known], kind="stable")][:_NAMED]
    worst = worst[enhanced[worst] > _STANDS_OUT * np.median(enhanced[known])] if known.size else worst
    labels = [Label(names[dof], float(dof + 1), float(enhanced[dof]), RED) for dof in worst]
    row = arrange(labels, [PANEL_WIDTH * (dof + 0.5) / count for dof in worst], PANEL_WIDTH)
    note = "COMAC: 1 where pairs agree in amplitude; enhanced COMAC: 0 where they agree in sign and size too"
    figure = sheet(HEAD + 2.0 * _CRITERIA_HEIGHT + 2.0 * _CRITERIA_GAP + row.height + 2.0 + FOOT, title, note)
    lower = panel(figure, FOOT, _CRITERIA_HEIGHT)
    upper = panel(figure, FOOT + _CRITERIA_HEIGHT + row.height + _CRITERIA_GAP + 2.0, _CRITERIA_HEIGHT)
    _bars(upper, comac, worst)
    _bars(lower, enhanced, worst)
    upper.set(ylim=(0.0, 1.0), ylabel="COMAC")
    upper.tick_params(labelbottom=False)
    largest = float(np.nanmax(enhanced)) if known.size else 0.0
    lower.set(ylim=(0.0, max(1.08 * largest, 0.1)), ylabel="enhanced COMAC")
    lower.set(xlabel="measured degree of freedom, in the survey's order")
    draw_row(lower, row, _CRITERIA_HEIGHT + 1.0)
    return figure


def _bars(axes: Axes, values: FloatArray, worst: npt.NDArray[np.int64]) -> None:
    places = np.arange(1, len(values) + 1)
    colors = [RED if place - 1 in worst else BLUE for place in places]
    axes.bar(places, np.nan_to_num(values), width=0.85, color=colors, lw=0.0)
    axes.set_xlim(0.5, len(values) + 0.5)
    axes.grid(visible=False, axis="x")
