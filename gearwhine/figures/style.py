"""How every figure looks: colours, sizes on paper, axes, and the file it goes to."""

import warnings
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

FloatArray = npt.NDArray[np.float64]

INK, BLUE, RED, GREY, PALE = "#202428", "#1f5a96", "#b5382a", "#8a9097", "#e4e7ea"
SERIES = (BLUE, "#c77d1e", "#3b7d4f", "#7a4f9a", "#5b6770", "#a3485f")
SHEET_WIDTH = 160.0  # of a figure made for print [mm]
NOTE, TICK, LABEL, TITLE = 6.5, 7.5, 8.0, 9.0  # letters on such a sheet [points]

_SCREEN_DPI, _PRINT_DPI = 130, 200
_MM_PER_INCH = 25.4


def tidy(axes: Axes, *, size: float = 9.0) -> None:
    """Two spines, a pale grid below the data, ink of one colour."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(colors=INK, labelsize=size)
    axes.grid(visible=True, color=PALE, lw=0.6)
    axes.set_axisbelow(True)


def sheet(height: float) -> Figure:
    """An empty sheet for print, 160 mm wide and ``height`` mm high."""
    return Figure(figsize=(SHEET_WIDTH / _MM_PER_INCH, height / _MM_PER_INCH), dpi=_PRINT_DPI)


def sheet_height(figure: Figure) -> float:
    """Height of a sheet [mm]."""
    return float(figure.get_size_inches()[1]) * _MM_PER_INCH


def panel(figure: Figure, left: float, bottom: float, width: float, height: float) -> Axes:
    """Axes at a place of a sheet, all in mm from its lower left corner, so that a scale can be true."""
    across, up = SHEET_WIDTH, sheet_height(figure)
    axes = figure.add_axes((left / across, bottom / up, width / across, height / up))
    tidy(axes, size=TICK)
    axes.xaxis.label.set(size=LABEL, color=INK)
    axes.yaxis.label.set(size=LABEL, color=INK)
    return axes


def head(figure: Figure, title: str, note: str = "") -> None:
    """A sheet's title at its upper left, and a note in grey below; nine millimetres in all."""
    up = sheet_height(figure)
    # Names are the user's: a dollar sign in one is no formula.
    figure.text(0.02, 1.0 - 1.5 / up, title, size=TITLE, color=INK, va="top", parse_math=False)
    if note:
        figure.text(0.02, 1.0 - 6.0 / up, note, size=NOTE, color=GREY, va="top", parse_math=False)


def shortened(text: str, most: int = 28) -> str:
    """A text on one line, cut with an ellipsis where it is longer than ``most`` letters."""
    line = " ".join(text.split())
    return line if len(line) <= most else f"{line[: most - 1].rstrip()}…"


def save(figure: Figure, path: Path) -> str:
    """Write a figure as PNG and return the file's name; sheets for print are finer than figures for the screen."""
    with warnings.catch_warnings():
        # A letter that no font here has is drawn as a box, which says as much as a warning would.
        warnings.filterwarnings("ignore", message="Glyph .* missing from", category=UserWarning)
        figure.savefig(path, dpi=max(_SCREEN_DPI, int(figure.dpi)))
    return path.name
