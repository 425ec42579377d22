"""Comparison figures of housing modes: frequencies, MAC matrix, coordinate criteria and mode shapes.

Model frequencies stand over measured ones with a band of ±5 %, beside their errors. With shapes, the MAC of each pair
is drawn as circles whose area is the MAC, at the frequencies of both modes: the FMAC of Fotsch and Ewins (2000), one
picture of shapes, frequencies and what the survey confuses.

A correlation matrix such as the MAC has a cell for each two modes, with its number where it fits, pairs outlined.
COMAC and enhanced COMAC are bars over the survey's degrees of freedom, the worst named. Measured mode shapes stand
beside the model's at the survey's points, as wireframes of one scale and phase.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    HERTZ,
    INK,
    LABEL,
    MM_PER_INCH,
    NOTE,
    PALE,
    PANEL_WIDTH,
    RED,
    SHEET_WIDTH,
    TICK,
    Label,
    LabelRow,
    arrange,
    draw_row,
    panel,
    sheet,
    sheet_height,
    shortened,
)
from gearwhine.housing.correlation.comparison import Comparison, ModePair, ShapeCorrelation
from gearwhine.housing.measured import MeasuredGeometry
from gearwhine.numerics.arrays import FloatArray, IntArray
from gearwhine.results.comparison import coordinate_names

_BAND = 0.05  # error within which the source's model is (TM-104434, Table II)
_PLANE, _BETWEEN, _ERRORS = 92.0, 8.0, 34.0  # heights of the panels and the gap between them [mm of paper]
_AREA_OF_MAC_ONE = 60.0  # area of the circle of MAC 1 [points²]
_LEAST_DRAWN_MAC = 0.05  # MACs below it are not drawn
_TICK = 0.018  # length of an unpaired mode's mark, as a part of the panel

_COLORS = LinearSegmentedColormap.from_list("likeness", ["#ffffff", "#cfdeec", BLUE, "#0b2540"])
_LEFT, _BESIDE, _SCALE, _NUMBERS = 24.0, 3.0, 3.0, 11.0  # widths of row names, gap, colour bar and its numbers [mm]
_BELOW = 11.0  # height of the columns' upright names [mm]
_CELL, _LEAST_CELL, _TALLEST = 9.0, 2.6, 190.0  # largest and least height of a cell, and largest of all [mm]
_FITS = (4.2, 2.8)  # least width and height of a cell with a number of two digits [mm]
_NOTHING = 0.05  # values below it are left blank
_LEAST_VALUE_IN_WHITE = 0.5  # values above it are written in white
_CRITERIA_HEIGHT, _CRITERIA_GAP = 40.0, 5.0  # height of a panel, and gap between panels [mm of paper]
_MOST_NAMED_DOFS = 6  # largest number of degrees of freedom that are named
_STANDS_OUT = 2.0  # enhanced criterion over its median from which a degree of freedom is named
_MARGIN, _GAP, _CAPTION = 4.0, 3.0, 9.0  # margin beside the panels, gap between pairs, and height of a caption [mm]
_IN_A_ROW = 2  # pairs in a row
_MOST_LETTERS = 56  # length of the longest caption [letters]
_REACH = 0.09  # largest displacement drawn, as a part of the survey's diagonal
_FAINTEST = 0.3  # opacity of the farthest lines


def draw_comparison(title: str, comparison: Comparison, model_frequencies: FloatArray) -> Figure:
    """Draw pairs of modes on the plane of measured and model frequency, and their errors in per cent.

    Parameters
    ----------
    title : str
        Title of the sheet.
    comparison : Comparison
        Comparison, also one without pairs.
    model_frequencies : ndarray, shape (n,)
        Frequencies of all the model's modes [rad/s]; those without a partner are marked on their axis.
    """
    measured = _measured(comparison)
    model = np.asarray(model_frequencies) / HERTZ
    highest = 1.06 * max(float(measured.max()), max((pair.model / HERTZ for pair in comparison.pairs), default=0.0))
    row = _error_labels(comparison, highest)
    above = _ERRORS + row.height + 2.0 + _BETWEEN
    figure = sheet(HEAD + _PLANE + above + FOOT, title, _note(comparison))
    plane = panel(figure, FOOT + above, _PLANE)
    below = panel(figure, FOOT, _ERRORS)
    ends = np.array([0.0, highest])
    plane.fill_between(ends, (1.0 - _BAND) * ends, (1.0 + _BAND) * ends, color=PALE, lw=0.0, zorder=1)
    plane.plot(ends, ends, color=GREY, lw=0.7, zorder=2, label="_equal")
    handles: list[Artist] = [Patch(color=PALE, label="±5 %")]
    if comparison.shapes is not None:
        _draw_macs(plane, comparison.shapes, comparison.pairs, highest)
        handles.append(_dot("other MACs, by area", GREY, filled=False))
    sizes = [_AREA_OF_MAC_ONE * (1.0 if pair.mac is None else pair.mac) for pair in comparison.pairs]
    at = np.array([[pair.measured, pair.model] for pair in comparison.pairs]).reshape(-1, 2).T / HERTZ
    plane.scatter(at[0], at[1], s=sizes, color=BLUE, edgecolors="white", linewidths=0.5, zorder=5, label="pairs")
    handles.append(_dot("pairs", BLUE))
    _mark_unpaired(plane, comparison, measured, model[model <= highest])
    lone = comparison.unpaired_measured or ()
    if lone or (
        comparison.shapes is not None and (comparison.shapes.unpaired_measured or comparison.shapes.unpaired_model)
    ):
        handles.append(Line2D([], [], color=RED, lw=1.2, label="without a partner"))
    if comparison.shapes is None and np.count_nonzero(model <= highest) > len(comparison.pairs):
        handles.append(Line2D([], [], color=GREY, lw=1.2, label="other model modes"))
    plane.set(xlim=(0.0, highest), ylim=(0.0, highest), ylabel="model [Hz]")
    plane.tick_params(labelbottom=False)
    _draw_errors(below, comparison, highest)
    draw_row(below, row, _ERRORS + 1.0)
    key = plane.legend(handles=handles, loc="lower right", frameon=False, fontsize=NOTE, labelspacing=0.35)
    key.set_zorder(6)
    return figure


def _measured(comparison: Comparison) -> FloatArray:
    """Every measured frequency, paired or not [Hz]."""
    if comparison.shapes is not None:
        return comparison.shapes.measured_frequencies / HERTZ
    alone = [mode.frequency for mode in comparison.unpaired_measured or ()]
    return np.array(sorted([*(pair.measured for pair in comparison.pairs), *alone])) / HERTZ


def _note(comparison: Comparison) -> str:
    if not comparison.pairs:
        return f"paired by {comparison.rule}: none"
    largest, rms = comparison.max_error_percent, comparison.rms_error_percent
    return f"paired by {comparison.rule}: largest error {largest:.2f} %, rms {rms:.2f} %"


def _draw_macs(axes: Axes, shapes: ShapeCorrelation, pairs: Iterable[ModePair], highest: float) -> None:
    values = shapes.mac.copy()
    for pair in pairs:
        values[pair.mode - 1, pair.measured_mode - 1] = 0.0
    i, j = np.nonzero((values >= _LEAST_DRAWN_MAC) & (shapes.model_frequencies[:, None] <= HERTZ * highest))
    axes.scatter(
        shapes.measured_frequencies[j] / HERTZ,
        shapes.model_frequencies[i] / HERTZ,
        s=_AREA_OF_MAC_ONE * values[i, j],
        facecolors="none",
        edgecolors=GREY,
        linewidths=0.6,
        zorder=4,
        label="other MACs",
    )


def _mark_unpaired(axes: Axes, comparison: Comparison, measured: FloatArray, model: FloatArray) -> None:
    """Draw short marks on the axes at modes without a partner: red where one is expected."""
    shapes = comparison.shapes
    paired = {pair.mode for pair in comparison.pairs}
    expected = set() if shapes is None else set(shapes.unpaired_model)
    for number, frequency in enumerate(model, start=1):
        if number not in paired:
            color = RED if number in expected else GREY
            axes.axhline(frequency, 0.0, _TICK, color=color, lw=1.2, zorder=3, label="_unpaired model")
    lone = [mode.number for mode in comparison.unpaired_measured or ()]
    for number in lone if shapes is None else shapes.unpaired_measured:
        axes.axvline(measured[number - 1], 0.0, 1.5 * _TICK, color=RED, lw=1.2, zorder=3, label="_unpaired measured")


def _draw_errors(axes: Axes, comparison: Comparison, highest: float) -> None:
    errors = np.array([pair.error_percent for pair in comparison.pairs])
    reach = max(1.15 * float(np.abs(errors).max(initial=0.0)), 130.0 * _BAND)
    axes.axhspan(-100.0 * _BAND, 100.0 * _BAND, color=PALE, lw=0.0, zorder=1)
    axes.axhline(0.0, color=GREY, lw=0.7, zorder=2)
    places = np.array([pair.measured for pair in comparison.pairs]) / HERTZ
    axes.vlines(places, 0.0, errors, color=BLUE, lw=1.6, zorder=3)
    axes.plot(places, errors, color=BLUE, marker="o", ms=3.5, ls="", zorder=4, label="error")
    axes.set(xlim=(0.0, highest), ylim=(-reach, reach), xlabel="measured [Hz]", ylabel="error [%]")


def _error_labels(comparison: Comparison, highest: float) -> LabelRow:
    pairs = comparison.pairs
    labels = [
        Label(f"{round(pair.error_percent, 1) + 0.0:+.1f}", pair.measured / HERTZ, pair.error_percent) for pair in pairs
    ]
    return arrange(labels, [PANEL_WIDTH * label.x / highest for label in labels], PANEL_WIDTH)


def _dot(name: str, color: str, *, filled: bool = True) -> Line2D:
    return Line2D([], [], color=color, marker="o", ms=4.5, mfc=color if filled else "none", mew=0.7, ls="", label=name)


def draw_mac_matrix(
    title: str,
    values: FloatArray,
    rows: Sequence[str],
    columns: Sequence[str],
    *,
    outlined: Collection[tuple[int, int]] = (),
    axes_named: tuple[str, str] = ("model mode", "measured mode"),
    named: str = "MAC",
    note: str = "",
) -> Figure:
    """Draw a matrix of values from 0 to 1, its first row at the bottom.

    Parameters
    ----------
    title, note : str
        Title and note of the sheet.
    values : ndarray, shape (n, m)
    rows, columns : sequence of str
        Names of modes, such as ``3  1049 Hz``.
    outlined : collection of (int, int)
        Cells of pairs: row and column from 0.
    axes_named : tuple of str
        Titles of rows and columns.
    named : str
        Name of the values.

    Raises
    ------
    ValueError
        Names that do not fit the values, or no values.
    """
    if values.shape != (len(rows), len(columns)) or values.size == 0:
        raise ValueError(f"{len(rows)} and {len(columns)} names for values of shape {values.shape}")
    room = SHEET_WIDTH - _LEFT - _BESIDE - _SCALE - _NUMBERS
    high = float(np.clip(_TALLEST / len(rows), _LEAST_CELL, _CELL))
    wide = min(room / len(columns), 1.6 * high)
    width, height = wide * len(columns), high * len(rows)
    figure = sheet(HEAD + height + _BELOW + FOOT, title, note)
    axes = panel(figure, FOOT + _BELOW, height, left=_LEFT, width=width)
    axes.grid(visible=False)
    scale = Normalize(0.0, 1.0)
    axes.pcolormesh(values, cmap=_COLORS, norm=scale, edgecolors="white", linewidth=0.3)
    for row, column in outlined:
        axes.add_patch(Rectangle((column, row), 1.0, 1.0, fill=False, edgecolor=RED, lw=1.2, zorder=4))
    if wide >= _FITS[0] and high >= _FITS[1]:
        for (row, column), value in np.ndenumerate(values):
            if value >= _NOTHING:
                color, size = "white" if value > _LEAST_VALUE_IN_WHITE else INK, min(1.05 * wide, 5.5)
                text = f"{value:.2f}"
                axes.text(column + 0.5, row + 0.5, text, ha="center", va="center", size=size, color=color)
    _name(axes.xaxis, columns, wide, upright=True)
    _name(axes.yaxis, rows, high, upright=False)
    axes.tick_params(length=0.0)
    axes.set(xlabel=axes_named[1], ylabel=axes_named[0])
    axes.yaxis.set_label_coords(-(_LEFT - 3.0) / width, 0.5)
    across, up = (float(inches) * MM_PER_INCH for inches in figure.get_size_inches())
    place = ((_LEFT + width + _BESIDE) / across, (FOOT + _BELOW) / up, _SCALE / across, height / up)
    bar = figure.colorbar(ScalarMappable(scale, _COLORS), cax=figure.add_axes(place))
    bar.ax.tick_params(labelsize=TICK, colors=INK)
    bar.set_label(named, size=LABEL, color=INK)
    return figure


def _name(axis: Axis, names: Sequence[str], size: float, *, upright: bool) -> None:
    """Write names at the middles of the cells, every other one or fewer where they would touch."""
    step = max(int(np.ceil(2.6 / size)), 1)
    places = range(0, len(names), step)
    axis.set_ticks([place + 0.5 for place in places])
    axis.set_ticklabels([names[place] for place in places], size=NOTE, rotation=90.0 if upright else 0.0)


def draw_coordinate_criteria(title: str, comac: FloatArray, enhanced: FloatArray, names: Sequence[str]) -> Figure:
    """Draw both criteria as bars in the survey's order; red: large by the one that depends on signs and gains.

    Parameters
    ----------
    title : str
        Title of the sheet.
    comac, enhanced : ndarray, shape (n,)
        Both criteria; NaN where unknown.
    names : sequence of str
        Names of the degrees of freedom, such as ``12 +z``.

    Raises
    ------
    ValueError
        Arrays that do not fit.
    """
    count = len(names)
    if comac.shape != (count,) or enhanced.shape != (count,) or count == 0:
        raise ValueError(f"criteria of shapes {comac.shape} and {enhanced.shape} for {count} degrees of freedom")
    finite = np.flatnonzero(np.isfinite(enhanced))
    largest_dofs = finite[np.argsort(-enhanced[finite], kind="stable")][:_MOST_NAMED_DOFS]
    largest_dofs = (
        largest_dofs[enhanced[largest_dofs] > _STANDS_OUT * np.median(enhanced[finite])]
        if finite.size
        else largest_dofs
    )
    labels = [Label(names[dof], float(dof + 1), float(enhanced[dof]), RED) for dof in largest_dofs]
    row = arrange(labels, [PANEL_WIDTH * (dof + 0.5) / count for dof in largest_dofs], PANEL_WIDTH)
    note = "COMAC: 1 where pairs agree in amplitude; enhanced COMAC: 0 where they agree in sign and size too"
    figure = sheet(HEAD + 2.0 * _CRITERIA_HEIGHT + 2.0 * _CRITERIA_GAP + row.height + 2.0 + FOOT, title, note)
    lower = panel(figure, FOOT, _CRITERIA_HEIGHT)
    upper = panel(figure, FOOT + _CRITERIA_HEIGHT + row.height + _CRITERIA_GAP + 2.0, _CRITERIA_HEIGHT)
    _bars(upper, comac, largest_dofs)
    _bars(lower, enhanced, largest_dofs)
    upper.set(ylim=(0.0, 1.0), ylabel="COMAC")
    upper.tick_params(labelbottom=False)
    largest = float(np.nanmax(enhanced)) if finite.size else 0.0
    lower.set(ylim=(0.0, max(1.08 * largest, 0.1)), ylabel="enhanced COMAC")
    lower.set(xlabel="measured degree of freedom, in the survey's order")
    draw_row(lower, row, _CRITERIA_HEIGHT + 1.0)
    return figure


def _bars(axes: Axes, values: FloatArray, highlighted: npt.NDArray[np.int64]) -> None:
    places = np.arange(1, len(values) + 1)
    colors = [RED if place - 1 in highlighted else BLUE for place in places]
    axes.bar(places, np.nan_to_num(values), width=0.85, color=colors, lw=0.0)
    axes.set_xlim(0.5, len(values) + 0.5)
    axes.grid(visible=False, axis="x")


def draw_comparison_figures(
    title: str,
    comparison: Comparison,
    model_frequencies: FloatArray,
    geometry: MeasuredGeometry | None = None,
) -> Iterator[tuple[str, Figure]]:
    """Draw measured and model modes beside each other; with shapes also the matrices, and COMAC at each point.

    Parameters
    ----------
    title : str
        Title of the case.
    comparison, geometry
        See :func:`gearwhine.results.comparison.write_comparison`.
    model_frequencies : ndarray, shape (n,)
        Frequencies of all the model's modes [rad/s].

    Yields
    ------
    str
        Name of the figure: ``comparison``; ``mac`` with shapes, ``auto-mac`` of the measured ones,
        ``cross-orthogonality`` where the survey allows it, ``comac`` where there are pairs.
    matplotlib.figure.Figure
    """
    yield "comparison", draw_comparison(f"Measured and model modes: {title}", comparison, model_frequencies)
    if (shapes := comparison.shapes) is not None:
        yield from _draw_matrices(title, comparison, shapes)
        if shapes.comac is not None and shapes.enhanced_comac is not None:
            heading, names = f"Where shapes differ: {title}", coordinate_names(len(shapes.comac), geometry)
            yield "comac", draw_coordinate_criteria(heading, shapes.comac, shapes.enhanced_comac, names)


def _draw_matrices(title: str, comparison: Comparison, shapes: ShapeCorrelation) -> Iterator[tuple[str, Figure]]:
    model, measured = shapes.model_frequencies / HERTZ, shapes.measured_frequencies / HERTZ
    paired = {pair.mode - 1: pair.measured_mode - 1 for pair in comparison.pairs}
    near = (model >= 0.9 * measured[0]) & (model <= 1.1 * measured[-1])
    drawn_modes = [int(mode) for mode in range(len(model)) if near[mode] or mode in paired]
    columns = _mode_names(range(len(measured)), measured)
    if drawn_modes:
        outlined = [(row, paired[mode]) for row, mode in enumerate(drawn_modes) if mode in paired]
        note = "pairs outlined; close modes are paired by their span, not by the single values"
        figure = draw_mac_matrix(
            f"MAC: {title}",
            shapes.mac[drawn_modes],
            _mode_names(drawn_modes, model),
            columns,
            outlined=outlined,
            note=note,
        )
        yield "mac", figure
    note = "large values off the diagonal: modes found twice, or that the survey cannot tell apart"
    named = ("measured mode", "measured mode")
    figure = draw_mac_matrix(
        f"Auto-MAC of the test: {title}", shapes.measured_auto_mac, columns, columns, axes_named=named, note=note
    )
    yield "auto-mac", figure
    if shapes.cross_orthogonality is not None:
        modes = [number - 1 for number in shapes.orthogonality_modes]
        note = "in the model's mass, reduced to the survey by SEREP; squares of a column add up to 1"
        outlined = [(row, paired[mode]) for row, mode in enumerate(modes) if mode in paired]
        figure = draw_mac_matrix(
            f"Cross-orthogonality: {title}",
            shapes.cross_orthogonality,
            _mode_names(modes, model),
            columns,
            outlined=outlined,
            named="cross-orthogonality",
            note=note,
        )
        yield "cross-orthogonality", figure


def _mode_names(modes: Iterable[int], hertz: FloatArray) -> list[str]:
    return [f"{mode + 1}   {hertz[mode]:.0f} Hz" for mode in modes]


@dataclass(frozen=True)
class ShapePair:
    """A measured shape and the model's.

    Attributes
    ----------
    heading : str
    measured, model : ndarray, shape (n_points, 3)
        Displacements at the same phase, to the same scale.
    """

    heading: str
    measured: FloatArray
    model: FloatArray


def draw_measured_shapes(
    title: str,
    positions: FloatArray,
    edges: IntArray,
    pairs: Sequence[ShapePair],
    towards_eye: FloatArray,
    upwards: FloatArray | None = None,
) -> Figure:
    """Draw pairs of shapes, two pairs in a row, the measured one left.

    Parameters
    ----------
    title : str
    positions : ndarray, shape (n_points, 3)
        Positions of the survey's points [m].
    edges : ndarray of int, shape (n_edges, 2)
        Points that the wires join.
    pairs : sequence of ShapePair
    towards_eye : ndarray, shape (3,)
        Unit vector from the survey to the camera.
    upwards : ndarray, shape (3,), optional
        Unit vector that points upwards; by default y.
    """
    upwards = np.array([0.0, 1.0, 0.0]) if upwards is None else upwards
    flat, depth = _projected(positions, towards_eye, upwards)
    reach = _REACH * float(np.linalg.norm(np.ptp(positions, axis=0)))
    low, high = flat.min(axis=0) - reach, flat.max(axis=0) + reach
    width = (SHEET_WIDTH - 2.0 * _MARGIN - (_IN_A_ROW - 1) * _GAP) / (2 * _IN_A_ROW)
    tall = width * float(np.clip((high - low)[1] / (high - low)[0], 0.4, 1.6))
    rows = -(-len(pairs) // _IN_A_ROW)
    height = HEAD + rows * (tall + _CAPTION) + _MARGIN
    note = "left: measured, right: model; same camera and phase, shapes of one size; colours by part of the largest"
    figure = sheet(height, title, note)
    whole = sheet_height(figure)
    near = (depth - depth.min()) / (np.ptp(depth) or 1.0)
    for number, pair in enumerate(pairs):
        row, column = divmod(number, _IN_A_ROW)
        left = _MARGIN + column * (2.0 * width + _GAP)
        up = height - HEAD - (row + 1) * (tall + _CAPTION)
        figure.text(
            left / SHEET_WIDTH, (up + tall + 4.0) / whole, shortened(pair.heading, _MOST_LETTERS), fontsize=NOTE + 0.5,
            color=INK, parse_math=False,
        )  # fmt: skip
        largest = max(float(np.linalg.norm(shape, axis=1).max()) for shape in (pair.measured, pair.model)) or 1.0
        for side, (name, shape) in enumerate((("measured", pair.measured), ("model", pair.model))):
            place = (left + side * width) / SHEET_WIDTH, up / whole, width / SHEET_WIDTH, tall / whole
            axes = figure.add_axes(place)
            axes.set_axis_off()
            axes.set_xlim(low[0], high[0])
            axes.set_ylim(low[1], high[1])
            axes.set_aspect("equal")
            axes.text(0.02, 1.0, name, transform=axes.transAxes, fontsize=NOTE - 0.5, color=GREY, va="bottom")
            moved, _ = _projected(positions + shape * (reach / largest), towards_eye, upwards)
            _wires(axes, flat, moved, np.linalg.norm(shape, axis=1) / largest, edges, near)
    return figure


def _projected(positions: FloatArray, towards_eye: FloatArray, up: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return places on the picture, shape (n, 2), and nearness to the eye, shape (n,)."""
    right = np.cross(up, towards_eye)
    right /= np.linalg.norm(right)
    upward = np.cross(towards_eye, right)
    return positions @ np.stack([right, upward], axis=1), positions @ towards_eye


def _wires(
    axes: Axes, rest: FloatArray, moved: FloatArray, amplitude: FloatArray, edges: IntArray, near: FloatArray
) -> None:
    """Draw the wireframe at rest in grey, and deformed, the far wires fainter and behind."""
    order = np.argsort(near[edges].mean(axis=1)) if len(edges) else np.zeros(0, dtype=np.int64)
    edges = edges[order]
    axes.add_collection(LineCollection(list(rest[edges]), colors=PALE, linewidths=0.5, zorder=1))
    colours = colormaps["viridis"](amplitude[edges].mean(axis=1))
    colours[:, 3] = _FAINTEST + (1.0 - _FAINTEST) * near[edges].mean(axis=1)
    axes.add_collection(LineCollection(list(moved[edges]), colors=colours, linewidths=0.9, zorder=2))
    dots = colormaps["viridis"](amplitude)
    dots[:, 3] = _FAINTEST + (1.0 - _FAINTEST) * near
    axes.scatter(moved[:, 0], moved[:, 1], s=2.0, c=dots, linewidths=0.0, zorder=3)
