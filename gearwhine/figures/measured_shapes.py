"""Measured mode shapes beside the model's at the survey's points, as wireframes of one scale and phase."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from gearwhine.figures.style import GREY, HEAD, INK, NOTE, PALE, SHEET_WIDTH, sheet, shortened

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_MARGIN, _GAP, _CAPTION = 4.0, 3.0, 9.0  # beside the panels, between two pairs, and for a pair's words [mm]
_IN_A_ROW = 2  # pairs
_LONGEST = 56  # caption [letters]
_REACH = 0.09  # largest displacement drawn, as a part of the survey's diagonal
_FAINTEST = 0.3  # opacity of what is farthest from the eye


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
    title: str, positions: FloatArray, edges: IntArray, pairs: Sequence[ShapePair], towards_eye: FloatArray
) -> Figure:
    """Draw pairs of shapes, two pairs in a row, the measured one left.

    Parameters
    ----------
    title : str
    positions : ndarray, shape (n_points, 3)
        Of the survey [m].
    edges : ndarray of int, shape (n_edges, 2)
        Points to join.
    pairs : sequence of ShapePair
    towards_eye : ndarray, shape (3,)
        From the survey to the camera, a unit vector; y points up.
    """
    flat, depth = _projected(positions, towards_eye)
    reach = _REACH * float(np.linalg.norm(np.ptp(positions, axis=0)))
    low, high = flat.min(axis=0) - reach, flat.max(axis=0) + reach
    width = (SHEET_WIDTH - 2.0 * _MARGIN - (_IN_A_ROW - 1) * _GAP) / (2 * _IN_A_ROW)
    tall = width * float(np.clip((high - low)[1] / (high - low)[0], 0.4, 1.6))
    rows = -(-len(pairs) // _IN_A_ROW)
    height = HEAD + rows * (tall + _CAPTION) + _MARGIN
    note = "left: measured, right: model; same camera and phase, shapes of one size; colours by part of the largest"
    figure = sheet(height, title, note)
    near = (depth - depth.min()) / (np.ptp(depth) or 1.0)
    for number, pair in enumerate(pairs):
        row, column = divmod(number, _IN_A_ROW)
        left = _MARGIN + column * (2.0 * width + _GAP)
        up = height - HEAD - (row + 1) * (tall + _CAPTION)
        figure.text(
            left / SHEET_WIDTH, (up + tall + 4.0) / height, shortened(pair.heading, _LONGEST), fontsize=NOTE + 0.5,
            color=INK, parse_math=False,
        )  # fmt: skip
        largest = max(float(np.linalg.norm(shape, axis=1).max()) for shape in (pair.measured, pair.model)) or 1.0
        for side, (name, shape) in enumerate((("measured", pair.measured), ("model", pair.model))):
            place = (left + side * width) / SHEET_WIDTH, up / height, width / SHEET_WIDTH, tall / height
            axes = figure.add_axes(place)
            axes.set_axis_off()
            axes.set_xlim(low[0], high[0])
            axes.set_ylim(low[1], high[1])
            axes.set_aspect("equal")
            axes.text(0.02, 1.0, name, transform=axes.transAxes, fontsize=NOTE - 0.5, color=GREY, va="bottom")
            moved, _ = _projected(positions + shape * (reach / largest), towards_eye)
            _wires(axes, flat, moved, np.linalg.norm(shape, axis=1) / largest, edges, near)
    return figure


def _projected(positions: FloatArray, towards_eye: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Places on the picture, shape (n, 2), and nearness to the eye, shape (n,)."""
    right = np.cross([0.0, 1.0, 0.0], towards_eye)
    right /= np.linalg.norm(right)
    upward = np.cross(towards_eye, right)
    return positions @ np.stack([right, upward], axis=1), positions @ towards_eye


def _wires(
    axes: Axes, rest: FloatArray, moved: FloatArray, amplitude: FloatArray, edges: IntArray, near: FloatArray
) -> None:
    """The wires at rest in grey, and moved, the far ones fainter and behind."""
    order = np.argsort(near[edges].mean(axis=1)) if len(edges) else np.zeros(0, dtype=np.int64)
    edges = edges[order]
    axes.add_collection(LineCollection(list(rest[edges]), colors=PALE, linewidths=0.5, zorder=1))
    colours = colormaps["viridis"](amplitude[edges].mean(axis=1))
    colours[:, 3] = _FAINTEST + (1.0 - _FAINTEST) * near[edges].mean(axis=1)
    axes.add_collection(LineCollection(list(moved[edges]), colors=colours, linewidths=0.9, zorder=2))
    dots = colormaps["viridis"](amplitude)
    dots[:, 3] = _FAINTEST + (1.0 - _FAINTEST) * near
    axes.scatter(moved[:, 0], moved[:, 1], s=2.0, c=dots, linewidths=0.0, zorder=3)
