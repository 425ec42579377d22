"""Spectra figures: spectral lines on a logarithmic scale, waterfall diagrams, and level maps (Campbell plots).

Waterfalls and level maps show spectra over speed, with mesh harmonics and the housing's natural frequencies.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gearwhine.coupling.signals.spectrum import Spectrum, decibels
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    INK,
    LABEL,
    LEFT,
    MM_PER_INCH,
    RED,
    SERIES,
    SHEET_WIDTH,
    TICK,
    Label,
    arrange,
    column_width,
    draw_column,
    draw_row,
    legend,
    name_in_legend,
    panel,
    panel_size,
    plain,
    sheet,
)
from gearwhine.numerics.arrays import FloatArray, IndexArray

_MOST_LINES = 1 << 12
_DENSEST = 2.5  # lines in a millimetre of paper up to which they are drawn one by one
_DECADES = 5.0  # decades of the amplitude axis below its highest line

_ROW_DECADES = 4.0  # decades that a row shows below the highest line of all
_ROW_HEIGHT_RATIO = 1.7  # height of a row over the distance to the next
_MOST_HARMONICS = 12
_MOST_ROWS = 40  # largest number of legible rows
_LEVELS = 60.0  # decibels below the highest level that a map shows
_LEVEL_MAP, _LEVEL_BAR, _MARKS = 100.0, 14.0, 3.0  # a map's height, width of its scale, height of marks above it [mm]
_LOWEST_PANEL, _ROW_HEIGHT, _HIGHEST_PANEL = 40.0, 3.4, 175.0  # heights of a waterfall and its rows [mm of paper]


def draw_lines(axes: Axes, spectrum: Spectrum, limit: float, color: str = BLUE) -> None:
    """Draw the lines of one signal above 0 Hz and up to a limit [Hz], and set the axes to them."""
    inside = (spectrum.frequencies > 0.0) & (spectrum.frequencies <= limit)
    frequencies, amplitude = spectrum.frequencies[inside], spectrum.amplitude[inside]
    if (together := len(amplitude) // _MOST_LINES) > 1:
        # Where lines are too close to be seen apart the highest is drawn: a path of all takes hundreds of megabytes.
        # The last group may have fewer lines than the others.
        groups = np.array_split(amplitude, range(together, len(amplitude), together))
        highest = np.array([group.argmax() for group in groups]) + np.arange(0, len(amplitude), together)
        frequencies, amplitude = frequencies[highest], amplitude[highest]
    top = float(amplitude.max(initial=0.0))
    if top > 0.0:
        floor = top * 10.0**-_DECADES
        axes.set_yscale("log")
        axes.set_ylim(floor, top * 3.0)
        if spectrum.window == "hann" or np.count_nonzero(amplitude > floor) > _DENSEST * panel_size(axes)[0]:
            # Lines so close, or of tones that spread over several, are one blue area.
            heights = np.maximum(amplitude, floor)
            axes.fill_between(frequencies, floor, heights, color=color, alpha=0.22, lw=0.0)
            axes.plot(frequencies, heights, color=color, lw=0.6)
            axes.set_xlim(0.0, limit)
            return
        # One broken line, which is drawn several times sooner than thousands of them.
        heights = np.stack(
            [np.full_like(amplitude, floor), np.maximum(amplitude, floor), np.full_like(amplitude, np.nan)]
        )
        axes.plot(np.repeat(frequencies, 3), heights.T.ravel(), color=color, lw=0.9, solid_capstyle="butt")
    axes.set_xlim(0.0, limit)


def draw_waterfall(
    title: str,
    values: npt.ArrayLike,
    frequencies: npt.ArrayLike,
    amplitudes: npt.ArrayLike,
    *,
    value_name: str,
    unit: str,
    note: str = "",
    mesh_frequencies: npt.ArrayLike = (),
    mesh_names: Sequence[str] = (),
    housing_frequencies: npt.ArrayLike = (),
) -> Figure:
    """Draw spectra as rows over the value they belong to, each on the same logarithmic scale.

    Parameters
    ----------
    title : str
        Title of the sheet.
    values : array_like, shape (s,)
        Distinct values of the rows, such as speeds.
    frequencies : array_like, shape (s, m)
        Frequencies of each spectrum's lines [Hz].
    amplitudes : array_like, shape (s, m)
        Peak amplitudes; NaN where a spectrum has no such line. Rows of NaN alone are left out.
    value_name, unit : str
        Name of the axis of values, and unit of the amplitudes.
    note : str
        Begin of the note below the title.
    mesh_frequencies : array_like, shape (s, p)
        Mesh frequencies of each gear pair [Hz]; dashed with their harmonics, which are numbered at the edge of the
        panel.
    mesh_names : sequence of str
        Names of the gear pairs.
    housing_frequencies : array_like, shape (s, n)
        Natural frequencies [Hz], NaN where there are fewer; marked under each row.

    Raises
    ------
    ValueError
        Arrays whose shapes do not fit, or no spectrum at all.
    """
    at, lines, heights = _spectra(values, frequencies, amplitudes)
    meshes, modes = (_table(table, at.size) for table in (mesh_frequencies, housing_frequencies))
    rows = _chosen_rows(at, heights)
    highest = float(np.nanmax(np.where(lines > 0.0, heights, np.nan), initial=0.0)) or 1.0
    limit = float(np.nanmax(np.where(np.isfinite(heights), lines, np.nan)))
    spacing = _spacing(at[rows])

    harmonics = _mesh_harmonics(at[rows], meshes[rows], list(mesh_names), limit)
    above = [harmonic.label for harmonic in harmonics if harmonic.at_top]
    beside = [harmonic.label for harmonic in harmonics if not harmonic.at_top]
    width = SHEET_WIDTH - LEFT - column_width(beside)
    row = arrange(above, [label.x / limit * width for label in above], width)
    tall = min(_LOWEST_PANEL + _ROW_HEIGHT * rows.size, _HIGHEST_PANEL)
    remarks = [note] if note else []
    remarks.append(
        f"each row {plain(highest * 10.0**-_ROW_DECADES, 2)} to {plain(highest, 2)} {unit} peak, logarithmic"
    )
    figure = sheet(HEAD + row.height + 2.0 + tall + FOOT, title, "; ".join(remarks))
    axes = panel(figure, FOOT, tall, width=width)
    axes.set(xlim=(0.0, limit), ylim=(at[rows[0]] - 0.35 * spacing, at[rows[-1]] + (_ROW_HEIGHT_RATIO + 0.2) * spacing))
    axes.set(xlabel="frequency [Hz]", ylabel=value_name)
    axes.grid(visible=False, axis="y")

    for depth, number in enumerate(rows):
        place, zorder = float(at[number]), 3.0 + 0.01 * (rows.size - depth)
        _draw_row(axes, lines[number], heights[number], place, spacing, highest, zorder=zorder)
        _mark_modes(axes, modes[number], place, spacing, limit)
    handles = _draw_harmonics(axes, harmonics)
    draw_row(axes, row, tall + 1.0)
    draw_column(axes, beside)
    if modes.size:
        handles["modes"] = Line2D([], [], color=INK, marker="|", ms=5, ls="", label="housing mode")
    legend(figure, list(handles.values()))
    return figure


def draw_level_map(
    title: str,
    values: npt.ArrayLike,
    frequencies: FloatArray,
    amplitudes: FloatArray,
    *,
    value_name: str,
    unit: str,
    note: str = "",
    mesh_frequencies: npt.ArrayLike = (),
    mesh_names: Sequence[str] = (),
    housing_frequencies: FloatArray | None = None,
) -> Figure:
    """Draw the level of spectra by colours over frequency and the value that they belong to.

    Parameters
    ----------
    title : str
        Title of the sheet.
    values : array_like, shape (s,)
        Values of the spectra, such as speeds, that ascend or descend.
    frequencies : ndarray, shape (m,)
        Frequencies of the lines [Hz].
    amplitudes : ndarray, shape (s, m)
        Peak amplitudes, in ``unit``.
    value_name, unit : str
        Name of the axis of values, and unit of the amplitudes; levels are re a millionth of it.
    note : str
        Note below the title.
    mesh_frequencies, mesh_names
        See :func:`draw_waterfall`.
    housing_frequencies : ndarray, shape (n,), optional
        Natural frequencies [Hz], marked above the panel.
    """
    at = np.asarray(values, dtype=np.float64)
    meshes = _table(mesh_frequencies, at.size)
    limit = float(frequencies[-1])
    lines = frequencies > 0.0
    levels = decibels(amplitudes[:, lines])
    top = 5.0 * np.ceil(float(levels.max()) / 5.0) if np.isfinite(levels.max()) else 0.0
    rising = np.argsort(at, kind="stable")
    harmonics = _mesh_harmonics(at[rising], meshes[rising], list(mesh_names), limit)
    above = [harmonic.label for harmonic in harmonics if harmonic.at_top]
    beside = [harmonic.label for harmonic in harmonics if not harmonic.at_top]
    names = column_width(beside)
    width = SHEET_WIDTH - LEFT - names - _LEVEL_BAR
    row = arrange(above, [label.x / limit * width for label in above], width)
    figure = sheet(HEAD + row.height + _MARKS + _LEVEL_MAP + FOOT, title, note)
    axes = panel(figure, FOOT, _LEVEL_MAP, width=width)
    colors = axes.pcolormesh(
        frequencies[lines],
        at,
        np.maximum(levels, top - _LEVELS),
        cmap="viridis",
        vmin=top - _LEVELS,
        vmax=top,
        shading="nearest",
        rasterized=True,
        label="_levels",
    )
    axes.grid(visible=False)
    axes.set(xlim=(0.0, limit), ylim=(float(at.min()), float(at.max())))
    axes.set(xlabel="frequency [Hz]", ylabel=value_name)
    handles = _draw_harmonics(axes, harmonics, color="white")
    draw_row(axes, row, _LEVEL_MAP + _MARKS)
    draw_column(axes, beside)
    if housing_frequencies is not None and housing_frequencies.size:
        inside = housing_frequencies[housing_frequencies <= limit]
        axes.plot(
            inside, np.full(inside.size, 1.015), "v", color=INK, ms=3.0, transform=axes.get_xaxis_transform(),
            clip_on=False, label="_modes",
        )  # fmt: skip
        handles["modes"] = Line2D([], [], color=INK, marker="v", ms=3.0, ls="", label="housing mode")
    for line in handles.values():
        if line.get_linestyle() == "--":
            # White lines on the map are grey ones on the sheet.
            handles[str(line.get_label())] = Line2D([], [], color=GREY, lw=0.8, ls=(0, (4, 3)), label=line.get_label())
    legend(figure, list(handles.values()))
    box, across = axes.get_position(), float(figure.get_size_inches()[0]) * MM_PER_INCH
    bar = figure.colorbar(colors, cax=figure.add_axes((box.x1 + names / across, box.y0, 2.5 / across, box.height)))
    bar.ax.tick_params(labelsize=TICK, colors=INK)
    bar.set_label(f"level [dB re 1 µ{unit}]", size=LABEL, color=INK)
    return figure


def _chosen_rows(values: FloatArray, heights: FloatArray) -> IndexArray:
    """Return the spectra that are drawn, ascending in their value: at most `_MOST_ROWS` that are not all NaN.

    Raises
    ------
    ValueError
        Where there is none.
    """
    finite_rows = np.flatnonzero(np.isfinite(heights).any(axis=1))
    if not finite_rows.size:
        raise ValueError("no spectrum to draw")
    rows = finite_rows[np.argsort(values[finite_rows])]
    return np.asarray(rows[np.unique(np.linspace(0, rows.size - 1, min(rows.size, _MOST_ROWS)).round().astype(int))])


@dataclass(frozen=True)
class _MeshHarmonic:
    """A multiple of a mesh frequency through the rows [Hz], and its label where it leaves the panel."""

    name: str
    color: str
    frequencies: FloatArray
    values: FloatArray
    label: Label
    at_top: bool


def _mesh_harmonics(values: FloatArray, meshes: FloatArray, names: list[str], limit: float) -> list[_MeshHarmonic]:
    """Return the multiples of mesh frequencies that lie below a limit [Hz]; pairs of one frequency are one."""
    harmonics: list[_MeshHarmonic] = []
    groups: dict[bytes, list[int]] = {}
    for pair in range(meshes.shape[1]):
        groups.setdefault(np.nan_to_num(meshes[:, pair]).round(9).tobytes(), []).append(pair)
    for place, pairs in enumerate(groups.values()):
        frequencies = meshes[:, pairs[0]]
        is_known = np.isfinite(frequencies) & (frequencies > 0.0)
        color = (RED, *SERIES[1:])[place % len(SERIES)]
        listed = ", ".join(names[pair] for pair in pairs if pair < len(names))
        name = "mesh harmonics" if len(groups) == 1 or not listed else f"harmonics of {name_in_legend(listed, 26)}"
        for harmonic in range(1, _MOST_HARMONICS + 1):
            across, up = harmonic * frequencies[is_known], values[is_known]
            inside = np.flatnonzero(across <= limit)
            if not inside.size:
                break
            last = int(inside[-1])
            x, y, at_top = float(across[last]), float(up[last]), last + 1 == across.size
            if not at_top and across[last + 1] > x:
                # It leaves the panel between two rows.
                x, y = limit, float(np.interp(limit, across[last : last + 2], up[last : last + 2]))
            harmonics.append(_MeshHarmonic(name, color, across, up, Label(f"{harmonic}×", x, y, color), at_top))
    return harmonics


def _draw_harmonics(axes: Axes, harmonics: Sequence[_MeshHarmonic], color: str = "") -> dict[str, Line2D]:
    """Draw mesh harmonics through the rows, in one color or their own; return a line of each name for the legend."""
    handles: dict[str, Line2D] = {}
    for harmonic in harmonics:
        (line,) = axes.plot(
            harmonic.frequencies,
            harmonic.values,
            color=color or harmonic.color,
            lw=0.8,
            ls=(0, (4, 3)),
            zorder=4.5,
            label=harmonic.name,
        )
        handles.setdefault(harmonic.name, line)
    return handles


def _draw_row(
    axes: Axes, lines: FloatArray, heights: FloatArray, base: float, spacing: float, highest: float, *, zorder: float
) -> None:
    """Draw one spectrum on its base line; it hides rows behind it."""
    is_known = np.isfinite(heights) & (lines > 0.0)
    decades = np.log10(np.maximum(heights[is_known], 1e-300) / highest) + _ROW_DECADES
    tops = base + _ROW_HEIGHT_RATIO * spacing * np.clip(decades, 0.0, None) / _ROW_DECADES
    axes.fill_between(lines[is_known], base, tops, color="white", lw=0.0, zorder=zorder)
    axes.plot(lines[is_known], tops, color=BLUE, lw=0.6, zorder=zorder + 0.001)


def _mark_modes(axes: Axes, modes: FloatArray, base: float, spacing: float, limit: float) -> None:
    inside = modes[np.isfinite(modes) & (modes <= limit)]
    if inside.size:
        axes.vlines(inside, base - 0.22 * spacing, base, color=INK, lw=0.7, zorder=5.0)


def _spectra(
    values: npt.ArrayLike, frequencies: npt.ArrayLike, amplitudes: npt.ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray]:
    at = np.asarray(values, dtype=np.float64)
    lines, heights = np.asarray(frequencies, dtype=np.float64), np.asarray(amplitudes, dtype=np.float64)
    if not lines.shape == heights.shape == (at.size, lines.shape[-1]):
        raise ValueError(
            f"values {at.shape}, frequencies {lines.shape} and amplitudes {heights.shape}: not (s,), (s, m)"
        )
    return at, lines, heights


def _table(values: npt.ArrayLike, rows: int) -> FloatArray:
    table = np.asarray(values, dtype=np.float64)
    if table.size == 0:
        return np.empty((rows, 0))
    if table.shape[0] != rows or table.ndim != 2:
        raise ValueError(f"a table of shape {table.shape} beside {rows} spectra")
    return table


def _spacing(values: Sequence[float] | FloatArray) -> float:
    """Median spacing of neighbouring rows."""
    return float(np.median(np.diff(values))) if len(values) > 1 else max(abs(float(values[0])), 1.0)
