"""Figure style: colours, sizes on paper, axes, and saving to a file."""

import warnings
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from math import pi
from pathlib import Path
from textwrap import wrap

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

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
