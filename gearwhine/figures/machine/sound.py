"""Sound figures: sound power of the lines and third octaves, radiation efficiency of the modes, and directivity."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MultipleLocator

from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    INK,
    LABEL,
    MM_PER_INCH,
    NOTE,
    PALE,
    PANEL_WIDTH,
    RED,
    SERIES,
    SHEET_WIDTH,
    Label,
    arrange,
    draw_row,
    legend,
    log_axis,
    panel,
    panel_size,
    sheet,
    sheet_height,
    shortened,
)
from gearwhine.housing.acoustics.sound_levels import pressure_level
from gearwhine.numerics.arrays import FloatArray

if TYPE_CHECKING:
    from gearwhine.coupling.sound.solution import SolvedSound, SoundLine
    from gearwhine.housing.acoustics.boundary_elements import SoundField

_POWER, _BANDS, _BETWEEN = 48.0, 34.0, 13.0  # heights of the panels of sound power, and gap between them [mm]
_ABOVE = 2.0  # height above the panel for the leaders of the names [mm]
_MOST_NAMED_LINES = 5  # number of lines with names
_RANGE = 60.0  # range of levels below the highest that is drawn [dB]
_HEARD = 25.0  # range below the loudest line in which lines have names and directivities [dB]
_STEP = 10.0  # step of the axis of levels [dB]
_FEWEST_BANDS = 8
_EFFICIENCY = 62.0  # height of the panel of efficiencies [mm]
_ROSE, _ROSE_ROOM = 41.0, 14.0  # diameter of a directivity and gap between two of them [mm]
_ROSE_RANGE = 30.0  # range of levels of a directivity [dB]
_LOUDEST = 2  # number of lines whose directivity is drawn
_ANGLES = np.radians(np.arange(0.0, 360.5, 2.0))
_PLANES = (  # heading, axes of the plane to the right and upwards, and their names
    ("horizontal, seen from above", (1.0, 0.0, 0.0), (0.0, 0.0, -1.0), ("x", "−z")),
    ("vertical, seen from +z", (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), ("x", "y")),
    ("vertical, seen from +x", (0.0, 0.0, -1.0), (0.0, 1.0, 0.0), ("−z", "y")),
)


def loudest_lines(solved: "SolvedSound", below: float = np.inf) -> "list[SoundLine]":
    """Return the lines with a sound power, the loudest first, down to a level `below` that of the loudest [dB]."""
    lines = sorted((line for line in solved.lines if line.sound.power > 0.0), key=lambda line: -line.level_db)
    return [line for line in lines if line.level_db >= lines[0].level_db - below]


def draw_sound_power(title: str, solved: "SolvedSound") -> Figure:
    """Draw the sound power level of every line with its estimate, the loudest named, and of the third octaves.

    Parameters
    ----------
    title : str
    solved : SolvedSound
        Sound with a line that radiates.
    """
    lines = loudest_lines(solved, _RANGE)
    limit = 1.02 * max(solved.limit_hz, *(line.frequency_hz for line in lines))
    loudest = loudest_lines(solved, _HEARD)[:_MOST_NAMED_LINES]
    named = [Label(_text(line), line.frequency_hz, line.level_db) for line in loudest]
    row = arrange(named, [label.x / limit * PANEL_WIDTH for label in named], PANEL_WIDTH)
    note = (
        f"{shortened(title, 60)}; sound power levels re 1 pW, together {solved.total_db:.1f} dB or "
        f"{solved.total_db_a:.1f} dB(A)"
    )
    figure = sheet(HEAD + row.height + _ABOVE + _POWER + _BETWEEN + _BANDS + FOOT, "Sound power of the housing", note)
    above = panel(figure, FOOT + _BANDS + _BETWEEN, _POWER)
    _draw_power(above, solved, lines, limit)
    draw_row(above, row, panel_size(above)[1] + _ABOVE)
    _draw_bands(panel(figure, FOOT, _BANDS), solved)
    handles = [
        Line2D([], [], color=BLUE, marker="o", ms=2.6, lw=0.9, label="line"),
        Line2D([], [], color=RED, marker="_", ms=5, ls="", label="ERP, an estimate"),
        Line2D([], [], color=GREY, marker=6, ms=4, ls="", label="housing modes"),
    ]
    legend(figure, handles if solved.radiation.method != "erp" else [handles[0], handles[2]])
    return figure


def _text(line: "SoundLine") -> str:
    return f"{line.frequency_hz:.0f} Hz {line.name}".replace(" -> ", "→")


def _draw_power(axes: Axes, solved: "SolvedSound", lines: "Sequence[SoundLine]", limit: float) -> None:
    levels = np.array([line.level_db for line in lines])
    estimates = np.array([line.equivalent_db for line in lines])
    frequencies = [line.frequency_hz for line in lines]
    low, high = _level_limits(levels, estimates)
    axes.vlines(frequencies, low, levels, color=BLUE, lw=0.9, zorder=3)
    axes.plot(frequencies, levels, marker="o", color=BLUE, ms=2.6, ls="", zorder=4, label="_lines")
    if solved.radiation.method != "erp":
        axes.plot(frequencies, estimates, marker="_", color=RED, ms=5, mew=0.9, ls="", zorder=3.5, label="_estimates")
    modes = solved.mode_frequencies[solved.mode_frequencies <= limit]
    axes.plot(modes, np.full(modes.size, 0.02), marker=6, color=GREY, ms=4, ls="", transform=axes.get_xaxis_transform())
    axes.set(xlim=(0.0, limit), ylim=(low, high), xlabel="frequency [Hz]", ylabel="sound power level [dB]")
    axes.yaxis.set_major_locator(MultipleLocator(_STEP))


def _draw_bands(axes: Axes, solved: "SolvedSound") -> None:
    """Draw the levels of third octaves as bars, and A-weighted as lines across them."""
    nominal, levels, weighted = solved.bands
    low, high = _level_limits(levels[levels >= levels.max() - _RANGE])
    first = max(min(int(np.argmax(levels > low)), len(levels) - _FEWEST_BANDS), 0)
    nominal, levels, weighted = nominal[first:], levels[first:], weighted[first:]
    places, drawn_bands = np.arange(len(nominal)), levels > low
    axes.bar(
        places[drawn_bands], levels[drawn_bands] - low, bottom=low, width=0.8, color=BLUE, alpha=0.85, lw=0.0, zorder=3
    )
    axes.hlines(
        weighted[drawn_bands], places[drawn_bands] - 0.4, places[drawn_bands] + 0.4, color="#c77d1e", lw=1.6, zorder=4
    )
    every = -(-len(nominal) // 20)
    axes.set_xticks(places[::every], [_nominal(hertz) for hertz in nominal[::every]])
    axes.grid(visible=False, axis="x")
    axes.set(xlim=(-0.6, len(nominal) - 0.4), ylim=(low, high), ylabel="third octaves [dB]")
    axes.set_xlabel("mid-band frequency [Hz]")
    handles = [
        Patch(color=BLUE, alpha=0.85, label="unweighted"),
        Line2D([], [], color="#c77d1e", lw=1.6, label="A-weighted"),
    ]
    axes.legend(
        handles=handles, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, frameon=False, fontsize=NOTE,
        borderaxespad=0.1, handlelength=1.6,
    )  # fmt: skip


def _nominal(hertz: float) -> str:
    return f"{hertz / 1e3:g} k" if hertz >= 1e3 else f"{hertz:g}"


def _level_limits(*levels: FloatArray) -> tuple[float, float]:
    """Return even limits around levels [dB], at most 60 dB below the highest of the first."""
    finite = np.concatenate([values[np.isfinite(values)] for values in levels])
    high = _STEP * np.ceil((float(finite.max()) + 2.0) / _STEP)
    lowest = max(float(finite.min()) - 3.0, float(levels[0].max()) - _RANGE)
    return float(min(_STEP * np.floor(lowest / _STEP), high - 4.0 * _STEP)), float(high)


def draw_radiation_efficiency(title: str, solved: "SolvedSound") -> Figure:
    """Draw the radiation efficiency of the modes at their natural frequencies, numbered, and of the lines.

    Parameters
    ----------
    title : str
    solved : SolvedSound
        Sound with a mode that radiates.
    """
    modes = [mode for mode in solved.modes if mode.radiation_efficiency > 0.0]
    frequencies = np.array([mode.frequency_hz for mode in modes])
    values = np.array([mode.radiation_efficiency for mode in modes])
    of_lines = [(line.frequency_hz, line.sound.radiation_efficiency) for line in loudest_lines(solved, _RANGE)]
    note = f"{shortened(title, 60)}; 1: as a plane wave; numbers: housing modes"
    figure = sheet(HEAD + _EFFICIENCY + FOOT, "Radiation efficiency", note)
    axes = panel(figure, FOOT, _EFFICIENCY)
    axes.axhline(1.0, color=INK, lw=0.8, zorder=2, label="_one")
    if of_lines:
        axes.plot(*np.array(of_lines).T, marker="x", color=GREY, ms=3, mew=0.8, ls="", zorder=2.5, label="_lines")
    axes.plot(frequencies, values, marker="o", color=BLUE, ms=4, ls="", zorder=4, label="_modes")
    everything = np.concatenate([values, [value for _, value in of_lines], [1.0]])
    axes.set(
        xlim=(0.0, 1.02 * max(solved.limit_hz, float(frequencies.max()))),
        xlabel="frequency [Hz]",
        ylabel="radiation efficiency σ",
    )
    log_axis(axes, 10.0 ** np.floor(np.log10(everything.min())), 1.6 * everything.max())
    # The first mode of a crowd, from the most efficient, has its number; the others are in the table.
    labelled: list[FloatArray] = []
    for place in np.argsort(-values):
        at = axes.transData.transform((frequencies[place], values[place])) / figure.dpi * MM_PER_INCH
        if all(abs(at[0] - label_at[0]) > 5.0 or abs(at[1] - label_at[1]) > 3.5 for label_at in labelled):
            axes.annotate(
                str(modes[place].number), (frequencies[place], values[place]), (0.0, 3.0), ha="center",
                textcoords="offset points", fontsize=NOTE, color=INK, zorder=5,
            )  # fmt: skip
            labelled.append(at)
    handles = [Line2D([], [], color=BLUE, marker="o", ms=4, ls="", label="mode at its natural frequency")]
    if of_lines:
        handles.append(Line2D([], [], color=GREY, marker="x", ms=3, ls="", label="line of the motion"))
    legend(figure, handles)
    return figure


def sound_field(line: "SoundLine") -> "SoundField | None":
    """Return the field of a line by boundary elements; None by any other method."""
    from gearwhine.housing.acoustics.boundary_elements import SoundField

    fields = [field for field in line.sound.fields if isinstance(field, SoundField)]
    return fields[0] if len(fields) == 1 and not fields[0].baffled else None


def draw_directivity(title: str, lines: "Sequence[SoundLine]") -> Figure:
    """Draw the far field's sound pressure level, referred to 1 m from the centre, over the direction in three planes.

    Parameters
    ----------
    title : str
    lines : sequence of SoundLine
        Lines solved by boundary elements.
    """
    fields = [field for line in lines if (field := sound_field(line)) is not None]
    curves = []
    for _, right, up, _ in _PLANES:
        directions = np.outer(np.cos(_ANGLES), right) + np.outer(np.sin(_ANGLES), up)
        curves.append([_directed(field, directions) for field in fields])
    top = 5.0 * np.ceil(max(float(np.nanmax(curve)) for plane in curves for curve in plane) / 5.0)
    note = f"{shortened(title, 50)}; far field, referred to 1 m from the middle; level [dB re 20 µPa]"
    figure = sheet(HEAD + 6.0 + _ROSE + 8.0, "Directivity at the loudest lines", note)
    for place, ((heading, _, _, names), plane) in enumerate(zip(_PLANES, curves, strict=True)):
        left, tall = 8.0 + place * (_ROSE + _ROSE_ROOM), sheet_height(figure)
        box = (left / SHEET_WIDTH, 6.0 / tall, _ROSE / SHEET_WIDTH, _ROSE / tall)
        axes = figure.add_axes(box, projection="polar")
        assert isinstance(axes, PolarAxes)
        for number, (line, curve) in enumerate(zip(lines, plane, strict=True)):
            level = np.maximum(curve, top - _ROSE_RANGE)
            axes.plot(_ANGLES, level, color=SERIES[number], lw=1.2, label=_text(line), zorder=3)
        axes.set_rlim(top - _ROSE_RANGE, top)
        rings = np.arange(top - _ROSE_RANGE + 10.0, top + 1.0, 10.0)
        axes.set_yticks(rings, [f"{ring:.0f}" for ring in rings])
        axes.set_rlabel_position(67.5)
        axes.tick_params(axis="y", labelsize=NOTE - 0.5, labelcolor=GREY)
        axes.tick_params(axis="x", labelsize=NOTE, labelcolor=INK, pad=-2.0)
        ends = [f"{sign}{name}".replace("+−", "−").replace("−−", "+") for sign in "+−" for name in names]
        axes.set_xticks(np.radians(np.arange(0.0, 360.0, 45.0)), [ends[0], "", ends[1], "", ends[2], "", ends[3], ""])
        axes.grid(color=PALE, lw=0.6)
        axes.spines["polar"].set(color=GREY, lw=0.6)
        axes.set_title(heading, fontsize=LABEL, color=INK, pad=5.0)
    handles = [Line2D([], [], color=SERIES[n], lw=1.2, label=_text(line)) for n, line in enumerate(lines)]
    legend(figure, handles)
    return figure


def _directed(field: "SoundField", directions: FloatArray) -> FloatArray:
    """Return levels of the far field at 1 m [dB]; NaN behind a hard plane."""
    levels = pressure_level(field.far_field(directions).sum(axis=1))
    behind = np.zeros(len(levels), dtype=bool) if field.plane is None else directions @ field.plane.normal < -1e-9
    return np.where(behind, np.nan, levels)


def draw_sound(title: str, solved: "SolvedSound") -> Iterator[tuple[str, Figure]]:
    """Draw the figures of a sound.

    Parameters
    ----------
    title : str
    solved : SolvedSound

    Yields
    ------
    str
        Name of the figure: ``sound-power``, ``sound-directivity`` and ``sound-efficiency``.
    matplotlib.figure.Figure
    """
    if loudest_lines(solved):
        yield "sound-power", draw_sound_power(title, solved)
    directed = [line for line in loudest_lines(solved, _HEARD)[:_LOUDEST] if sound_field(line) is not None]
    if directed:
        yield "sound-directivity", draw_directivity(title, directed)
    if any(mode.radiation_efficiency > 0.0 for mode in solved.modes) and solved.radiation.method != "erp":
        yield "sound-efficiency", draw_radiation_efficiency(title, solved)
