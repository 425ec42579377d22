"""Labels in a row without overlap, each with a leader."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.transforms import Affine2D
from scipy.optimize import isotonic_regression

from gearwhine.figures.style import GREY, INK, MM_PER_INCH, NOTE, missing_glyphs_as_boxes, panel_size, shortened

FloatArray = npt.NDArray[np.float64]

_GAP = 2.0  # between neighbouring labels [mm]
_RISE = 4.0  # of a leader between the last of what is drawn and the row [mm]
_LONGEST = 40  # letters of a label: a line's frequency and the names of two gears
_MEASURING_DPI = 200


@dataclass(frozen=True)
class Label:
    """A text, the point that it names (data coordinates of its axes), and its colour."""

    text: str
    x: float
    y: float
    color: str = INK


@dataclass(frozen=True)
class LabelRow:
    """Labels with places of their own.

    Attributes
    ----------
    labels
        Those that have room, from left to right.
    places
        (n,): of their middles, mm from the left of the panel.
    upright
        Whether they stand rather than lie.
    height
        Height of the row with its leaders, mm.
    left_out
        Number of labels without room.
    """

    labels: tuple[Label, ...]
    places: FloatArray
    upright: bool
    height: float
    left_out: int


def spread(centres: npt.ArrayLike, widths: npt.ArrayLike, low: float, high: float, gap: float) -> FloatArray:
    """Places for labels of given widths, in their order, apart, and as near as can be to where they belong.

    Minimises the sum of squared displacements with neighbours at least ``gap`` apart. Less the room that the labels
    before it need, a label's place may only rise: that is isotonic regression (Barlow et al. 1972), and bounds are
    held by clipping its solution.

    Parameters
    ----------
    centres
        (n,): ascending, where they belong.
    widths
        (n,): theirs.
    low, high
        Bounds, which hold where the labels fit between them.
    gap
        Between neighbours.
    """
    wanted, wide = np.asarray(centres, dtype=np.float64), np.asarray(widths, dtype=np.float64)
    if wanted.size == 0:
        return wanted
    room = np.concatenate([[0.0], np.cumsum(0.5 * (wide[1:] + wide[:-1]) + gap)])
    free = np.asarray(isotonic_regression(wanted - room).x, dtype=np.float64)
    first, last = low + 0.5 * wide[0], high - 0.5 * wide[-1] - room[-1]
    return np.asarray(np.clip(free, min(first, last), max(first, last)) + room)


def arrange(labels: Sequence[Label], at: Sequence[float], width: float) -> LabelRow:
    """Place labels in one row over a panel.

    They lie where they fit so, and stand where they do not. Where even standing they do not fit, an even choice of
    them stays.

    Parameters
    ----------
    labels
        In any order.
    at
        Where each belongs, mm from the left of the panel.
    width
        Of the panel, mm.
    """
    order = np.argsort(at, kind="stable")
    chosen, wanted = [labels[index] for index in order], np.asarray(at, dtype=np.float64)[order]
    if not chosen:
        return LabelRow((), np.empty(0), False, 0.0, 0)
    sizes = np.array([_size(label.text) for label in chosen])
    upright = bool(sizes[:, 0].sum() + _GAP * (len(chosen) - 1) > width)
    along, across = (sizes[:, 1], sizes[:, 0]) if upright else (sizes[:, 0], sizes[:, 1])
    fit = max(int((width + _GAP) / (along.max() + _GAP)), 1) if upright else len(chosen)
    keep = np.unique(np.linspace(0, len(chosen) - 1, min(fit, len(chosen))).round().astype(int))
    return LabelRow(
        labels=tuple(chosen[index] for index in keep),
        places=spread(wanted[keep], along[keep], 0.0, width, _GAP),
        upright=upright,
        height=_RISE + float(across[keep].max()),
        left_out=len(chosen) - len(keep),
    )


def draw_row(axes: Axes, row: LabelRow, level: float, *, above: bool = True) -> None:
    """Write a row of labels and lead each to its point.

    Parameters
    ----------
    axes
        A panel, with its final limits.
    row
        From :func:`arrange` for the panel's width.
    level
        Where the leaders begin to slant, mm from the bottom of the panel; it must be clear of what is drawn.
    above
        Whether the row stands above what it names.
    """
    width, height = panel_size(axes)
    paper = Affine2D().scale(1.0 / width, 1.0 / height) + axes.transAxes
    sense = 1.0 if above else -1.0
    for label, place in zip(row.labels, row.places.tolist(), strict=True):
        x, y = paper.inverted().transform(axes.transData.transform((label.x, label.y)))
        bends = [(x, y), (x, level), (place, level + sense * (_RISE - 1.6)), (place, level + sense * (_RISE - 0.6))]
        axes.plot(*zip(*bends, strict=True), transform=paper, color=GREY, lw=0.5, zorder=1.5, clip_on=False)
        axes.text(
            place,
            level + sense * _RISE,
            shortened(label.text, _LONGEST),
            transform=paper,
            color=label.color,
            fontsize=NOTE,
            rotation=90.0 if row.upright else 0.0,
            ha="center",
            va="bottom" if above else "top",
            parse_math=False,
        )


def _size(text: str) -> tuple[float, float]:
    """Width and height of a label that lies, mm."""
    figure = Figure(dpi=_MEASURING_DPI)
    FigureCanvasAgg(figure)
    with missing_glyphs_as_boxes():
        extent = figure.text(0.0, 0.0, shortened(text, _LONGEST), fontsize=NOTE, parse_math=False).get_window_extent()
    return extent.width / _MEASURING_DPI * MM_PER_INCH, extent.height / _MEASURING_DPI * MM_PER_INCH
