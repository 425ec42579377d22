"""Sensor spectra, a panel each, their leading lines named."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from coupling.signature import decibels
from gearwhine.figures.labels import Label, arrange, draw_row
from gearwhine.figures.spectrum_lines import draw_lines
from gearwhine.figures.style import (
    FOOT,
    GREY,
    HEAD,
    INK,
    LABEL,
    LEFT,
    NOTE,
    RED,
    SHEET_WIDTH,
    legend,
    panel,
    panel_size,
    sheet,
    shortened,
)
from gearwhine.stages.signature import TracedLine
from gearwhine.stages.transient import SolvedTransient

FloatArray = npt.NDArray[np.float64]

_HEIGHT, _BETWEEN, _RIGHT = 40.0, 7.0, 14.0  # of a panel, above it, and beside it for levels [mm]
_NAMED = 6  # lines in a panel
_LEAST = 1e-4  # of the highest line, below which none is named


def draw_sensor_spectra(
    title: str,
    solved: SolvedTransient,
    lines: dict[str, tuple[TracedLine, ...]],
    *,
    mesh_frequencies: Sequence[float] = (),
    marked: FloatArray,
    marked_as: str = "housing modes",
) -> Figure:
    """Draw amplitudes in m/s², levels in dB beside them, and what the leading lines are above each panel.

    Parameters
    ----------
    title
        Of the sheet.
    solved
        The transient.
    lines
        Of each sensor, highest first.
    mesh_frequencies
        Hz; they and their multiples are marked.
    marked
        (n,): frequencies of modes, Hz.
    marked_as
        Names of the quantities.
    """
    width, limit = SHEET_WIDTH - LEFT - _RIGHT, solved.trusted_limit
    rows = {}
    for name, spectrum in solved.sensor_spectra.items():
        told = [line for line in lines[name] if abs(line.value) >= _LEAST * abs(lines[name][0].value)][:_NAMED]
        labels = [Label(shortened(_text(line)), line.frequency, abs(line.value), _color(line)) for line in told]
        rows[name] = (spectrum, arrange(labels, [label.x / limit * width for label in labels], width))
    height = HEAD + FOOT + sum(_HEIGHT + _BETWEEN + row.height for _, row in rows.values())
    note = f"{title}; peak amplitudes, levels of their rms values re 1 µm/s²"
    figure = sheet(height, "Housing acceleration", note)
    bottom = FOOT
    for number, (name, (spectrum, row)) in enumerate(reversed(rows.items())):
        axes = panel(figure, bottom, _HEIGHT, width=width)
        draw_lines(axes, spectrum, limit)
        low, high = axes.get_ylim()
        for base in mesh_frequencies:
            for harmonic in range(1, int(limit / base * (1.0 + 1e-9)) + 1):
                axes.axvline(harmonic * base, color=RED, lw=0.7, ls=(0, (4, 3)), zorder=0)
        inside = marked[marked <= limit]
        places = np.full(inside.size, 0.02)
        axes.plot(inside, places, marker=6, color=GREY, ms=4, ls="", transform=axes.get_xaxis_transform())
        axes.set_ylabel("acceleration [m/s²]", fontsize=LABEL)
        beside = axes.twinx()
        beside.set_ylim(*decibels([low, high]).tolist())
        beside.set_ylabel("level [dB]", fontsize=LABEL, color=INK)
        beside.tick_params(labelsize=NOTE, colors=INK)
        beside.spines[["top"]].set_visible(False)
        draw_row(axes, row, panel_size(axes)[1] + 0.8)
        axes.annotate(
            name, (0.99, 0.95), xycoords="axes fraction", fontsize=LABEL, ha="right", va="top", parse_math=False
        )
        if number:
            axes.tick_params(labelbottom=False)
        else:
            axes.set_xlabel("frequency [Hz]")
        bottom += _HEIGHT + _BETWEEN + row.height
    handles = []
    if len(mesh_frequencies):
        handles.append(Line2D([], [], color=RED, lw=0.7, ls=(0, (4, 3)), label="mesh harmonic"))
    if marked.size:
        handles.append(Line2D([], [], color=GREY, marker=6, ms=4, ls="", label=marked_as))
    legend(figure, handles)
    return figure


def _text(line: TracedLine) -> str:
    name = line.named.name.replace(" mode of ", " ")
    return f"{line.frequency:.0f} Hz {'free ' if line.named.kind == 'mode' else ''}{name}"


def _color(line: TracedLine) -> str:
    return RED if line.named.kind == "mesh" else INK
