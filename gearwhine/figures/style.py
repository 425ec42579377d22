"""Figure style: colours, sizes on paper, axes, labels in a row without overlap, and saving to a file."""

import warnings
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
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
from matplotlib.transforms import Affine2D
from scipy.optimize import isotonic_regression

FloatArray = npt.NDArray[np.float64]
Kind = TypeVar("Kind")

INK, BLUE, RED, GREY, PALE = "#202428", "#1f5a96", "#b5382a", "#8a9097", "#e4e7ea"
SERIES = (BLUE, "#c77d1e", "#3b7d4f", "#7a4f9a", "#5b6770", "#a3485f", "#2a8c8c", "#8c6d1f")
SHEET_WIDTH = 160.0  # of a figure made for print [mm]
LEFT, RIGHT = 15.0, 4.0  # margins of such a sheet beside its panels [mm]
HEAD, FOOT = 13.0, 11.0  # ... for its title and note, and for an axis with its name [mm]
PANEL_WIDTH = SHEET_WIDTH - LEFT - RIGHT
NOTE, TICK, LABEL, TITLE = 6.5, 7.0, 7.5, 9.0  # letters on it [points]
MM_PER_INCH = 25.4
RPM = 9.549296585513721  # revolutions per minute of 1 rad/s
HERTZ = 2.0 * pi  # rad/s of 1 Hz
MILLI, MICRO, MEGA = 1e3, 1e6, 1e-6  # factors from m to mm, from m to µm, from Pa to MPa and from N/m to N/µm

_IN_HEAD = 4  # entries of a legend beside the title at most
_NOTE_LETTERS = 124  # of a note in one line
_NAME_OF_AXIS = 11.2  # left of a panel [mm]
_SCREEN_DPI, _PRINT_DPI = 130, 200
_GAP = 2.0  # between neighbouring labels [mm]
_RISE = 4.0  # of a leader between the last of what is drawn and the row [mm]
_LONGEST_LABEL = 40  # letters of a label: a line's frequency and the names of two gears
_MEASURING_DPI = 200


def tidy(axes: Axes, *, size: float = 9.0) -> None:
    """Two spines, a pale grid below the data, ink of one colour."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(colors=INK, labelsize=size)
    axes.grid(visible=True, color=PALE, lw=0.6)
    axes.set_axisbelow(True)


def sheet(height: float, title: str, note: str = "") -> Figure:
    """Return a sheet for print, 160 mm wide and ``height`` mm high, with a title and a grey note at its upper left.

    A title may share its line with a legend, so it is cut after 60 letters; a note takes two lines at most.
    """
    figure = Figure(figsize=(SHEET_WIDTH / MM_PER_INCH, height / MM_PER_INCH), dpi=_PRINT_DPI)
    # Names are the user's: a dollar sign in one is no formula.
    lines = "\n".join(wrap(note, _NOTE_LETTERS, max_lines=2, placeholder=" …"))
    for text, size, color, down in ((shortened(title, 60), TITLE, INK, 1.5), (lines, NOTE, GREY, 6.2)):
        if text:
            figure.text(0.0125, 1.0 - down / height, text, size=size, color=color, va="top", parse_math=False)
    return figure


def panel(figure: Figure, bottom: float, height: float, *, left: float = LEFT, width: float = PANEL_WIDTH) -> Axes:
    """Axes at a place of a sheet, all in mm from its lower left corner, so that a scale can be true."""
    across, up = (float(inches) * MM_PER_INCH for inches in figure.get_size_inches())
    axes = figure.add_axes((left / across, bottom / up, width / across, height / up))
    tidy(axes, size=TICK)
    axes.xaxis.label.set(size=LABEL, color=INK)
    axes.yaxis.label.set(size=LABEL, color=INK)
    # At one place on every sheet, clear of numbers of five digits.
    axes.yaxis.set_label_coords(-_NAME_OF_AXIS / width, 0.5)
    return axes


def panel_size(axes: Axes) -> tuple[float, float]:
    """Width and height of a panel, mm."""
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


def name_in_legend(text: str, most: int = 16) -> str:
    """Return a user's name on one line and cut, in which a dollar sign begins no formula."""
    return shortened(text, most).replace("$", r"\$")


def shortened(text: str, most: int = 28) -> str:
    """Return a text on one line, cut with an ellipsis where it is longer than ``most`` letters."""
    line = " ".join(text.split())
    return line if len(line) <= most else f"{line[: most - 1].rstrip()}…"


@contextmanager
def missing_glyphs_as_boxes() -> Iterator[None]:
    """Draw a letter that no font here has as a box, which says as much as a warning would."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from", category=UserWarning)
        yield


def save(figure: Figure, path: Path) -> str:
    """Write a figure as PNG and return the file's name; sheets for print are finer than figures for a monitor."""
    with missing_glyphs_as_boxes():
        figure.savefig(path, dpi=max(_SCREEN_DPI, int(figure.dpi)))
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
            shortened(label.text, _LONGEST_LABEL),
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
        extent = figure.text(
            0.0, 0.0, shortened(text, _LONGEST_LABEL), fontsize=NOTE, parse_math=False
        ).get_window_extent()
    return extent.width / _MEASURING_DPI * MM_PER_INCH, extent.height / _MEASURING_DPI * MM_PER_INCH
