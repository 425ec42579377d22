"""Model frequencies over measured ones with a band of ±5 %, and their errors; with shapes, the MAC of each pair.

Circles whose area is the MAC, at the frequencies of both modes, are the FMAC of Fotsch and Ewins (2000): one picture of
shapes, frequencies and what the survey confuses.
"""

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from gearwhine.figures.labels import Label, LabelRow, arrange, draw_row
from gearwhine.figures.style import BLUE, FOOT, GREY, HEAD, HERTZ, NOTE, PALE, PANEL_WIDTH, RED, panel, sheet
from housing import Comparison

FloatArray = npt.NDArray[np.float64]

_BAND = 0.05  # within which the source's model was (TM-104434, Table II)
_PLANE, _BETWEEN, _ERRORS = 92.0, 8.0, 34.0  # heights of the panels and the room between them [mm of paper]
_LARGEST = 60.0  # area of the circle of MAC 1 [points²]
_FAINT = 0.05  # MACs below it are not drawn
_TICK = 0.018  # length of an unpaired mode's mark, as a part of the panel


def draw_comparison(title: str, comparison: Comparison, model_frequencies: FloatArray) -> Figure:
    """Draw pairs of modes on the plane of measured and model frequency, and their errors in per cent.

    Parameters
    ----------
    title
        Of the sheet.
    comparison
        With pairs or without.
    model_frequencies
        (n,): of all the model's modes, rad/s; those without a partner are marked on their axis.
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
        _draw_macs(plane, comparison, highest)
        handles.append(_dot("other MACs, by area", GREY, filled=False))
    sizes = [_LARGEST * (1.0 if pair.mac is None else pair.mac) for pair in comparison.pairs]
    at = np.array([[pair.measured, pair.model] for pair in comparison.pairs]).reshape(-1, 2).T / HERTZ
    plane.scatter(at[0], at[1], s=sizes, color=BLUE, edgecolors="white", linewidths=0.5, zorder=5, label="pairs")
    handles.append(_dot("pairs", BLUE))
    _mark_unpaired(plane, comparison, measured, model[model <= highest])
    if comparison.shapes is not None and (comparison.shapes.unpaired_measured or comparison.shapes.unpaired_model):
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
    return np.array([pair.measured for pair in comparison.pairs]) / HERTZ


def _note(comparison: Comparison) -> str:
    if not comparison.pairs:
        return f"paired by {comparison.pairing}: none"
    worst, rms = comparison.max_error_percent, comparison.rms_error_percent
    return f"paired by {comparison.pairing}: largest error {worst:.2f} %, rms {rms:.2f} %"


def _draw_macs(axes: Axes, comparison: Comparison, highest: float) -> None:
    shapes = comparison.shapes
    assert shapes is not None
    values = shapes.mac.copy()
    for pair in comparison.pairs:
        values[pair.mode - 1, pair.measured_mode - 1] = 0.0
    i, j = np.nonzero((values >= _FAINT) & (shapes.model_frequencies[:, None] <= HERTZ * highest))
    axes.scatter(
        shapes.measured_frequencies[j] / HERTZ,
        shapes.model_frequencies[i] / HERTZ,
        s=_LARGEST * values[i, j],
        facecolors="none",
        edgecolors=GREY,
        linewidths=0.6,
        zorder=4,
        label="other MACs",
    )


def _mark_unpaired(axes: Axes, comparison: Comparison, measured: FloatArray, model: FloatArray) -> None:
    """Short marks on the axes at modes without a partner: red where one was to be expected."""
    shapes = comparison.shapes
    paired = {pair.mode for pair in comparison.pairs}
    expected = set() if shapes is None else set(shapes.unpaired_model)
    for number, frequency in enumerate(model, start=1):
        if number not in paired:
            color = RED if number in expected else GREY
            axes.axhline(frequency, 0.0, _TICK, color=color, lw=1.2, zorder=3, label="_unpaired model")
    for number in () if shapes is None else shapes.unpaired_measured:
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
