"""Spectra figures: spectral lines on a logarithmic scale, and waterfall diagrams.

A waterfall shows spectra over speed, with mesh orders and the housing's natural frequencies.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coupling.signals.spectrum import Spectrum
from gearwhine.figures.style import BLUE, GREY, INK, NOTE, RED, tidy

_MOST_LINES = 1 << 12
_DECADES = 5.0  # of the amplitude axis, below its highest line
FloatArray = npt.NDArray[np.float64]

_ROW_DECADES = 4.0  # that a row shows, below the highest line of all
_OVERLAP = 1.7  # height of a row over the distance to the next
_MOST_HARMONICS = 12
_MOST_ROWS = 40  # that one can still tell apart


def draw_lines(axes: Axes, spectrum: Spectrum, limit: float, color: str = BLUE) -> None:
    """Draw the lines of one signal above 0 Hz and up to a limit [Hz], and set the axes to them."""
    shown = (spectrum.frequencies > 0.0) & (spectrum.frequencies <= limit)
    frequencies, amplitude = spectrum.frequencies[shown], spectrum.amplitude[shown]
    if (together := len(amplitude) // _MOST_LINES) > 1:
        # Of lines closer than the eye can part the highest is drawn: a path of all takes hundreds of megabytes.
        groups = amplitude[: len(amplitude) // together * together].reshape(-1, together)
        highest = np.arange(len(groups)) * together + groups.argmax(axis=1)
        frequencies, amplitude = frequencies[highest], amplitude[highest]
    top = float(amplitude.max(initial=0.0))
    if top > 0.0:
        axes.set_yscale("log")
        axes.set_ylim(top * 10.0**-_DECADES, top * 3.0)
        floor = top * 10.0**-_DECADES
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
    mesh_frequencies: npt.ArrayLike = (),
    housing_frequencies: npt.ArrayLike = (),
) -> Figure:
    """Draw spectra as rows over the value they belong to, each on the same logarithmic scale.

    Parameters
    ----------
    title
        Of the figure.
    values
        (s,): such as speeds, distinct.
    frequencies
        (s, m): of each spectrum's lines, Hz.
    amplitudes
        (s, m): peak amplitudes; NaN where a spectrum has no such line. Rows of NaN alone are left out.
    value_name, unit
        Names of the axis of values, and of the amplitudes.
    mesh_frequencies
        (s, p): of each gear pair, Hz; dashed with their harmonics.
    housing_frequencies
        (s, n): natural frequencies, Hz, NaN where there are fewer; marked under each row.

    Raises
    ------
    ValueError
        Arrays whose shapes do not fit, or no spectrum at all.
    """
    at = np.asarray(values, dtype=np.float64)
    lines, heights = np.asarray(frequencies, dtype=np.float64), np.asarray(amplitudes, dtype=np.float64)
    meshes, modes = (_table(table, at.size) for table in (mesh_frequencies, housing_frequencies))
    if not lines.shape == heights.shape == (at.size, lines.shape[-1]):
        raise ValueError(
            f"values {at.shape}, frequencies {lines.shape} and amplitudes {heights.shape}: not (s,), (s, m)"
        )
    shown = np.flatnonzero(np.isfinite(heights).any(axis=1))
    if not shown.size:
        raise ValueError("no spectrum to draw")
    rows = shown[np.argsort(at[shown])]
    rows = rows[np.unique(np.linspace(0, rows.size - 1, min(rows.size, _MOST_ROWS)).round().astype(int))]
    highest = float(np.nanmax(np.where(lines > 0.0, heights, np.nan), initial=0.0)) or 1.0
    limit = float(np.nanmax(np.where(np.isfinite(heights), lines, np.nan)))
    spacing = _spacing(at[rows])

    figure = Figure(figsize=(9.0, min(3.2 + 0.28 * rows.size, 11.0)), layout="constrained")
    axes = figure.subplots()
    for depth, row in enumerate(rows):
        _draw_row(
            axes, lines[row], heights[row], float(at[row]), spacing, highest, zorder=3.0 + 0.01 * (rows.size - depth)
        )
        _mark_modes(axes, modes[row], float(at[row]), spacing, limit)
    _draw_orders(axes, at[rows], meshes[rows], limit)
    axes.set(xlim=(0.0, limit), ylim=(at[rows[0]] - 0.35 * spacing, at[rows[-1]] + (_OVERLAP + 0.2) * spacing))
    axes.set(xlabel="frequency [Hz]", ylabel=value_name)
    tidy(axes)
    axes.grid(visible=False, axis="y")
    figure.suptitle(title, fontsize=11, parse_math=False)
    note = f"each row: {highest * 10.0**-_ROW_DECADES:.2g} to {highest:.2g} {unit} peak, logarithmic"
    if meshes.size:
        note += "    dashed: mesh frequency and harmonics"
    if modes.size:
        note += "    |  housing modes"
    axes.set_title(note, fontsize=8, loc="right", color=GREY)
    return figure


def _draw_row(
    axes: Axes, lines: FloatArray, heights: FloatArray, base: float, spacing: float, highest: float, *, zorder: float
) -> None:
    """One spectrum on its base line; it hides what lies behind it."""
    known = np.isfinite(heights) & (lines > 0.0)
    decades = np.log10(np.maximum(heights[known], 1e-300) / highest) + _ROW_DECADES
    tops = base + _OVERLAP * spacing * np.clip(decades, 0.0, None) / _ROW_DECADES
    axes.fill_between(lines[known], base, tops, color="white", lw=0.0, zorder=zorder)
    axes.plot(lines[known], tops, color=BLUE, lw=0.6, zorder=zorder + 0.001)


def _mark_modes(axes: Axes, modes: FloatArray, base: float, spacing: float, limit: float) -> None:
    inside = modes[np.isfinite(modes) & (modes <= limit)]
    if inside.size:
        axes.vlines(inside, base - 0.22 * spacing, base, color=INK, lw=0.7, zorder=5.0)


def _draw_orders(axes: Axes, values: FloatArray, meshes: FloatArray, limit: float) -> None:
    """Each mesh frequency with its harmonics through all rows, named at the highest row that it reaches."""
    for pair in range(meshes.shape[1]):
        frequencies = meshes[:, pair]
        known = np.isfinite(frequencies) & (frequencies > 0.0)
        if not known.any():
            continue
        for harmonic in range(1, _MOST_HARMONICS + 1):
            inside = known & (harmonic * frequencies <= limit)
            if not inside.any():
                break
            axes.plot(
                harmonic * frequencies[known], values[known], color=RED, lw=0.8, ls=(0, (4, 3)), zorder=4.5, alpha=0.8
            )
            top = int(np.flatnonzero(inside)[-1])
            axes.annotate(
                f"{harmonic}×",
                (harmonic * frequencies[top], values[top]),
                (2.0, 3.0),
                textcoords="offset points",
                color=RED,
                fontsize=NOTE,
                zorder=6.0,
                annotation_clip=True,
            )


def _table(values: npt.ArrayLike, rows: int) -> FloatArray:
    table = np.asarray(values, dtype=np.float64)
    if table.size == 0:
        return np.empty((rows, 0))
    if table.shape[0] != rows or table.ndim != 2:
        raise ValueError(f"a table of shape {table.shape} beside {rows} spectra")
    return table


def _spacing(values: Sequence[float] | FloatArray) -> float:
    """Spacing between neighbouring rows, in the middle."""
    return float(np.median(np.diff(values))) if len(values) > 1 else max(abs(float(values[0])), 1.0)
