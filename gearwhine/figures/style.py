"""Figure style: colours, sizes on paper, axes, labels in a row or a column without overlap, and saving to a file."""

import warnings
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from math import pi
from pathlib import Path
from textwrap import wrap
from typing import TypeVar

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, MultipleLocator, NullFormatter
from matplotlib.transforms import Affine2D
from scipy.optimize import isotonic_regression

from gearwhine.numerics.arrays import FloatArray
from gearwhine.output.sections import arrowed

Kind = TypeVar("Kind")

INK, BLUE, RED, GREY, PALE = "#202428", "#1f5a96", "#b5382a", "#8a9097", "#e4e7ea"
SERIES = (BLUE, "#c77d1e", "#3b7d4f", "#7a4f9a", "#5b6770", "#a3485f", "#2a8c8c", "#8c6d1f")
SHEET_WIDTH = 160.0  # of a figure made for print [mm]
LEFT, RIGHT = 15.0, 4.0  # margins of such a sheet beside its panels [mm]
HEAD, FOOT = 13.0, 11.0  # margins for its title and a note of two lines, and for an axis with its name [mm]
PANEL_WIDTH = SHEET_WIDTH - LEFT - RIGHT
HALF_GAP = 17.0  # gap between two panels side by side, for the second one's numbers and name [mm]
HALF_WIDTH = 0.5 * (PANEL_WIDTH - HALF_GAP)
NOTE, TICK, LABEL, TITLE = 6.5, 7.0, 7.5, 9.0  # sizes of letters [points]
MM_PER_INCH = 25.4
RPM = 9.549296585513721  # revolutions per minute of 1 rad/s
HERTZ = 2.0 * pi  # rad/s of 1 Hz
MILLI, MICRO, MEGA = 1e3, 1e6, 1e-6  # factors from m to mm, from m to µm, from Pa to MPa and from N/m to N/µm

_SPARE = (5.4, 2.6, 0.0)  # height of the head that a note of no, one and two lines leaves empty [mm]
_IN_HEAD = 4  # largest number of a legend's entries beside the title
_LEGEND_ROW, _LEGEND_MARGIN = 3.6, 1.5  # height of a row and margin of a legend below the panels [mm]
_NOTE_LETTERS = 124  # letters of a note in one line
_NAME_OF_AXIS = 11.2  # distance of an axis's name from the left of its panel [mm]
_SCREEN_DPI, _PRINT_DPI = 130, 200
_GAP = 2.0  # gap between neighbouring labels [mm]
_RISE = 4.0  # rise of a leader between the drawing and the row [mm]
_LEAD, _ASIDE = 1.6, 2.2  # end of a leader and begin of its label beside a panel [mm]
_PANEL_TITLE = 48  # letters of a title over half a sheet
_LEAST_LABEL_GAP = 0.3  # gap between labels one above the other [mm]
_RIGHT_ANGLE = 90.0  # degrees
_MILLION = 1e6
_FEW_DECADES = 60.0  # ratio of the ends of a logarithmic axis below which powers of ten are too few marks
_LONGEST_LABEL = 40  # letters of a label: a line's frequency and the names of two gears
_MEASURING_DPI = 200


def tidy(axes: Axes, *, size: float = 9.0) -> None:
    """Two spines, a pale grid below the data, ink of one colour."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(which="both", colors=INK, labelsize=size)
    axes.grid(visible=True, color=PALE, lw=0.6)
    axes.set_axisbelow(True)


def sheet(height: float, title: str, note: str = "") -> Figure:
    """Return a sheet for print, 160 mm wide, with a title and a grey note at its upper left.

    ``height`` [mm] holds a head of `HEAD`; a short note makes the sheet lower. A title may share its line with a
    legend, so it is cut after 60 letters; a note takes two lines at most.
    """
    wrapped = wrap(note, _NOTE_LETTERS, max_lines=2, placeholder=" …")
    height -= _SPARE[len(wrapped)]
    figure = Figure(figsize=(SHEET_WIDTH / MM_PER_INCH, height / MM_PER_INCH), dpi=_PRINT_DPI)
    # Names come from the user: a dollar sign in one begins no formula.
    lines = "\n".join(wrapped)
    for text, size, color, down in ((shortened(title, 60), TITLE, INK, 1.5), (lines, NOTE, GREY, 6.2)):
        if text:
            figure.text(0.0125, 1.0 - down / height, text, size=size, color=color, va="top", parse_math=False)
    return figure


def sheet_height(figure: Figure) -> float:
    """Height of a sheet [mm]."""
    return float(figure.get_size_inches()[1]) * MM_PER_INCH


def panel(figure: Figure, bottom: float, height: float, *, left: float = LEFT, width: float = PANEL_WIDTH) -> Axes:
    """Return axes at a place of a sheet, in mm from its lower left corner, so that a scale can be true."""
    across, up = (float(inches) * MM_PER_INCH for inches in figure.get_size_inches())
    axes = figure.add_axes((left / across, bottom / up, width / across, height / up))
    tidy(axes, size=TICK)
    axes.xaxis.label.set(size=LABEL, color=INK)
    axes.yaxis.label.set(size=LABEL, color=INK)
    # The same place on every sheet, clear of five-digit numbers.
    axes.yaxis.set_label_coords(-_NAME_OF_AXIS / width, 0.5)
    return axes


def panel_pair(figure: Figure, bottom: float, height: float) -> tuple[Axes, Axes]:
    """Return two panels side by side, ``bottom`` and ``height`` in mm."""
    left, right = (
        panel(figure, bottom, height, left=LEFT + side * (HALF_WIDTH + HALF_GAP), width=HALF_WIDTH) for side in (0, 1)
    )
    return left, right


def stacked(
    count: int, height: float, gap: float, title: str, note: str = "", *, first: float = 0.0, foot: float = FOOT
) -> tuple[Figure, list[Axes]]:
    """Return a sheet with panels of one height below each other, the first on top.

    ``gap`` between two and ``first`` above the first one are the room for their titles [mm].
    """
    figure = sheet(HEAD + first + count * height + (count - 1) * gap + foot, title, note)
    return figure, [panel(figure, foot + (count - 1 - number) * (height + gap), height) for number in range(count)]


def name_lowest(panels: Sequence[Axes], text: str) -> None:
    """Give stacked panels over one axis its name, and its numbers, at the lowest alone."""
    for axes in panels[:-1]:
        axes.tick_params(labelbottom=False)
    panels[-1].set_xlabel(text)


def panel_title(axes: Axes, text: str, most: int = _PANEL_TITLE) -> None:
    """Write the title of a panel at its upper left, with a user's names unchanged."""
    axes.set_title(shortened(arrowed(text), most), fontsize=LABEL, color=INK, loc="left", pad=3.0, parse_math=False)


def degree_axis(axes: Axes) -> None:
    """Give an axis of phases [°] ticks at multiples of 45, 90, 180 or 360, and limits at such ticks."""
    low, high = axes.get_ylim()
    span = high - low
    step = next((candidate for candidate in (45.0, 90.0, 180.0) if span <= 6.0 * candidate), 360.0)
    first, last = step * np.floor(low / step + 1e-9), step * np.ceil(high / step - 1e-9)
    if last - first < _RIGHT_ANGLE:
        first, last = (first, first + _RIGHT_ANGLE) if high >= -low else (last - _RIGHT_ANGLE, last)
    axes.set_ylim(first, last)
    axes.yaxis.set_major_locator(MultipleLocator(step))


def log_axis(axes: Axes, low: float, high: float) -> None:
    """Give a panel a logarithmic axis with limits; over a decade or two it has plain numbers at 1, 2 and 5."""
    axes.set_yscale("log")
    axes.set_ylim(low, high)
    if high < _FEW_DECADES * low:
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: plain(value)))
        axes.yaxis.set_minor_formatter(NullFormatter())


def panel_size(axes: Axes) -> tuple[float, float]:
    """Return width and height of a panel [mm]."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    across, up = figure.get_size_inches()
    place = axes.get_position()
    return place.width * float(across) * MM_PER_INCH, place.height * float(up) * MM_PER_INCH


def mark_operation(axes: Axes, speed: float, line: str) -> Line2D:
    """Draw the operating speed [rad/s] as a line in a given style across a diagram over speed in rpm."""
    return axes.axvline(RPM * abs(speed), color=INK, lw=0.8, ls=line, zorder=1, label="operation")


def stretches(kinds: Sequence[Kind]) -> Iterator[tuple[slice, Kind]]:
    """Yield the stretches of a curve whose samples share one kind: slices that overlap in one sample, and the kind."""
    start = 0
    for end in range(1, len(kinds) + 1):
        if end == len(kinds) or kinds[end] != kinds[start]:
            yield slice(start, end + 1), kinds[start]
            start = end


def legend(figure: Figure, handles: Sequence[Artist]) -> None:
    """Explain lines and tints in the upper right corner of a sheet, in one line, or many of them in two."""
    if handles:  # an empty one would warn
        figure.legend(
            handles=handles,
            loc="upper right",
            ncols=len(handles) if len(handles) <= _IN_HEAD else (len(handles) + 1) // 2,
            frameon=False,
            fontsize=NOTE,
            handlelength=2.0,
            columnspacing=1.2,
        )


def legend_beside_title(figure: Figure, axes: Axes, handles: Sequence[Artist]) -> None:
    """Explain a few lines beside the title, and more of them within the axes."""
    if len(handles) <= _IN_HEAD:
        legend(figure, handles)
    else:
        axes.legend(handles=handles, loc="best", ncols=2, framealpha=0.9, edgecolor="none", fontsize=NOTE)


def legend_below(figure: Figure, handles: Sequence[Artist], columns: int = 4) -> None:
    """Explain many lines at the foot of a sheet, which has room for them by :func:`legend_height`."""
    if handles:
        figure.legend(
            handles=handles,
            loc="lower center",
            ncols=min(columns, len(handles)),
            frameon=False,
            fontsize=NOTE,
            handlelength=2.0,
            columnspacing=1.6,
            borderaxespad=0.2,
        )


def legend_height(entries: int, columns: int = 4) -> float:
    """Height of a legend below the panels [mm]."""
    return _LEGEND_MARGIN + _LEGEND_ROW * -(-entries // columns) if entries else 0.0


def plain(value: float, digits: int = 3) -> str:
    """Return a number with ``digits`` digits, without powers of ten up to a million."""
    text = f"{value:.{digits}g}"
    return f"{float(text):.0f}" if "e+" in text and abs(value) < _MILLION else text


def name_in_legend(text: str, most: int = 16) -> str:
    """Return a user's name on one line and cut, in which a dollar sign begins no formula."""
    return shortened(arrowed(text), most).replace("$", r"\$")


def shortened(text: str, most: int = 28) -> str:
    """Return a text on one line, cut with an ellipsis where it is longer than ``most`` letters."""
    line = " ".join(text.split())
    return line if len(line) <= most else f"{line[: most - 1].rstrip()}…"


def cut_within(text: str, most: int) -> str:
    """Return a text on one line, cut before its last third where it is longer: names alike differ at their ends."""
    line = " ".join(text.split())
    kept = most // 3
    return line if len(line) <= most else f"{line[: most - kept - 1].rstrip()}…{line[-kept:].lstrip()}"


@contextmanager
def missing_glyphs_as_boxes() -> Iterator[None]:
    """Draw letters that no font has as boxes, without a warning."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from", category=UserWarning)
        yield


_COMPRESSION = 4
"""Level of the compression of a PNG: by the default of 6 a fifth more time gives files that are 1 % smaller."""


def save(figure: Figure, path: Path) -> str:
    """Write a figure as PNG and return the file's name; sheets for print are finer than figures for a monitor."""
    with missing_glyphs_as_boxes():
        figure.savefig(path, dpi=max(_SCREEN_DPI, int(figure.dpi)), pil_kwargs={"compress_level": _COMPRESSION})
    return path.name


def save_all(figures: Iterable[tuple[str, Figure]], folder: Path) -> list[str]:
    """Write named figures into a folder, each as NAME.png, and return the files' names."""
    return [save(figure, folder / f"{name}.png") for name, figure in figures]


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
    labels : tuple of Label
        Labels that have room, from left to right.
    places : ndarray, shape (n,)
        Places of their middles, from the left of the panel [mm].
    upright : bool
        Whether they stand rather than lie.
    height : float
        Height of the row with its leaders [mm].
    left_out : int
        Number of labels without room.
    """

    labels: tuple[Label, ...]
    places: FloatArray
    upright: bool
    height: float
    left_out: int


def spread(centres: npt.ArrayLike, widths: npt.ArrayLike, low: float, high: float, gap: float) -> FloatArray:
    """Return places for labels of given widths, in their order, apart, and as near as possible to their centres.

    The places minimise the sum of squared displacements with neighbours at least ``gap`` apart. Less the room that the
    labels before it need, a label's place may only rise: that is isotonic regression (Barlow et al. 1972), and bounds
    are held by clipping its solution.

    Parameters
    ----------
    centres : array_like, shape (n,)
        Ascending places to which the labels belong.
    widths : array_like, shape (n,)
        Widths of the labels.
    low, high : float
        Bounds, which hold where the labels fit between them.
    gap : float
        Gap between neighbours.
    """
    positions, wide = np.asarray(centres, dtype=np.float64), np.asarray(widths, dtype=np.float64)
    if positions.size == 0:
        return positions
    room = np.concatenate([[0.0], np.cumsum(0.5 * (wide[1:] + wide[:-1]) + gap)])
    free = np.asarray(isotonic_regression(positions - room).x, dtype=np.float64)
    first, last = low + 0.5 * wide[0], high - 0.5 * wide[-1] - room[-1]
    return np.asarray(np.clip(free, min(first, last), max(first, last)) + room)


def arrange(labels: Sequence[Label], at: Sequence[float], width: float) -> LabelRow:
    """Place labels in one row over a panel.

    They lie where they fit so, else they stand. Where even upright labels do not fit, an even choice of them stays.

    Parameters
    ----------
    labels : sequence of Label
        Labels in any order.
    at : sequence of float
        Place to which each belongs, from the left of the panel [mm].
    width : float
        Width of the panel [mm].
    """
    order = np.argsort(at, kind="stable")
    chosen, positions = [labels[index] for index in order], np.asarray(at, dtype=np.float64)[order]
    if not chosen:
        return LabelRow((), np.empty(0), False, 0.0, 0)
    sizes = np.array([_size(label.text) for label in chosen])
    upright = bool(sizes[:, 0].sum() + _GAP * (len(chosen) - 1) > width)
    along, across = (sizes[:, 1], sizes[:, 0]) if upright else (sizes[:, 0], sizes[:, 1])
    fit = max(int((width + _GAP) / (along.max() + _GAP)), 1) if upright else len(chosen)
    keep = np.unique(np.linspace(0, len(chosen) - 1, min(fit, len(chosen))).round().astype(int))
    return LabelRow(
        labels=tuple(chosen[index] for index in keep),
        places=spread(positions[keep], along[keep], 0.0, width, _GAP),
        upright=upright,
        height=_RISE + float(across[keep].max()),
        left_out=len(chosen) - len(keep),
    )


def draw_row(axes: Axes, row: LabelRow, level: float, *, above: bool = True) -> None:
    """Write a row of labels and lead each to its point.

    Parameters
    ----------
    axes : Axes
        Panel with its final limits.
    row : LabelRow
        Row of :func:`arrange` for the panel's width.
    level : float
        Height at which the leaders begin to slant, from the bottom of the panel [mm]; it must be clear of the drawing.
    above : bool
        Whether the row stands above the points that it names.
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
            cut_within(label.text, _LONGEST_LABEL),
            transform=paper,
            color=label.color,
            fontsize=NOTE,
            rotation=90.0 if row.upright else 0.0,
            ha="center",
            va="bottom" if above else "top",
            parse_math=False,
        )


def column_width(labels: Iterable[Label]) -> float:
    """Return the width of labels beside a panel with their leaders [mm]; `RIGHT` where there are none."""
    return max([RIGHT, *(_ASIDE + 1.8 + _size(label.text)[0] for label in labels)])


def draw_column(axes: Axes, labels: Sequence[Label]) -> None:
    """Write labels beside the right edge of a panel, apart, each with a leader from its height there.

    Parameters
    ----------
    axes : Axes
        Panel with its final limits, and :func:`column_width` beside it.
    labels : sequence of Label
        Labels in any order.
    """
    width, height = panel_size(axes)
    paper = Affine2D().scale(1.0 / width, 1.0 / height) + axes.transAxes
    heights = [float(paper.inverted().transform(axes.transData.transform((label.x, label.y)))[1]) for label in labels]
    order = np.argsort(heights, kind="stable")
    sizes = np.array([_size(labels[index].text)[1] for index in order])
    places = spread(np.array(heights)[order], sizes, 0.0, height, _LEAST_LABEL_GAP)
    for index, place in zip(order.tolist(), places.tolist(), strict=True):
        label = labels[index]
        ends = [(width, heights[index]), (width + _LEAD, place)]
        axes.plot(*zip(*ends, strict=True), transform=paper, color=GREY, lw=0.5, clip_on=False, label="_leader")
        axes.text(
            width + _ASIDE,
            place,
            cut_within(label.text, _LONGEST_LABEL),
            transform=paper,
            color=label.color,
            fontsize=NOTE,
            va="center_baseline",
            parse_math=False,
        )


@lru_cache(maxsize=1024)
def _size(text: str) -> tuple[float, float]:
    """Return width and height of a label that lies [mm]."""
    figure = Figure(dpi=_MEASURING_DPI)
    FigureCanvasAgg(figure)
    with missing_glyphs_as_boxes():
        extent = figure.text(
            0.0, 0.0, cut_within(text, _LONGEST_LABEL), fontsize=NOTE, parse_math=False
        ).get_window_extent()
    return extent.width / _MEASURING_DPI * MM_PER_INCH, extent.height / _MEASURING_DPI * MM_PER_INCH
