"""Transmissibility: mesh forces, bearing forces and sensors per transmission error at one mesh, over frequency."""

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coupling import FrequencyResponse
from gearwhine.figures.style import FOOT, GREY, HEAD, HERTZ, NOTE, PANEL_WIDTH, SERIES, panel, sheet, shortened

FloatArray = npt.NDArray[np.float64]

_MICROMETRE = 1e-6
_RESPONSE_HEIGHT, _RESPONSE_GAP = 38.0, 4.0  # of a panel and the room between two [mm]
_DECADES = 4.0  # of amplitude that a panel shows at most
_NAMED = 8  # curves that a panel tells apart by colour


def draw_transmissibility(
    title: str, response: FrequencyResponse, *, mesh_frequencies: Sequence[float] = (), limit: float | None = None
) -> Figure:
    """Draw amplitudes by a micrometre of transmission error, over frequency.

    Parameters
    ----------
    title
        Of the sheet.
    response
        To a unit transmission error [1/m].
    mesh_frequencies
        At the speed of operation, Hz; they and their multiples are marked.
    limit
        End of the frequency axis, Hz; that of the response where not given.
    """
    frequencies = response.frequencies / HERTZ
    resultants = {name: np.linalg.norm(force, axis=1) for name, force in response.bearing_force.items()}
    panels = [
        ("mesh force [N/µm]", {name: np.abs(force) for name, force in response.mesh_force.items()}),
        ("bearing force [N/µm]", resultants),
        ("acceleration [m/s²/µm]", {name: np.abs(a) for name, a in response.sensor_acceleration.items()}),
    ]
    shown = [(what, curves) for what, curves in panels if curves]
    height = HEAD + len(shown) * (_RESPONSE_HEIGHT + _RESPONSE_GAP) + FOOT
    note = "peak amplitudes by a harmonic error of 1 µm at any frequency"
    if len(mesh_frequencies):
        note += "; dashed: mesh frequencies at operation, and multiples"
    figure = sheet(height, title, note)
    end = limit or float(frequencies[-1])
    for number, (what, curves) in enumerate(reversed(shown)):
        axes = panel(figure, FOOT + number * (_RESPONSE_HEIGHT + _RESPONSE_GAP), _RESPONSE_HEIGHT)
        _draw(axes, frequencies, curves, end)
        axes.set_ylabel(what)
        axes.set_xlim(0.0, end)
        for base in mesh_frequencies:
            for harmonic in range(1, int(end / base) + 1 if base > 0.0 else 1):
                axes.axvline(harmonic * base, color=GREY, lw=0.7, ls=(0, (4, 3)), zorder=1, label="mesh frequency")
        if number == 0:
            axes.set_xlabel("frequency [Hz]")
        else:
            axes.tick_params(labelbottom=False)
    return figure


def _draw(axes: Axes, frequencies: FloatArray, curves: Mapping[str, FloatArray], end: float) -> None:
    axes.set_yscale("log")
    inside = frequencies <= end
    top = 0.0
    for number, (name, values) in enumerate(curves.items()):
        size = _MICROMETRE * values
        top = max(top, float(size[inside].max(initial=0.0)))
        label = shortened(name, 24) if number < _NAMED else "_nolegend_"
        axes.plot(frequencies, size, color=SERIES[number % _NAMED], lw=1.0, label=label, zorder=3)
    if top > 0.0:
        least = min(
            float(_MICROMETRE * values[inside & (values > 0.0)].min(initial=np.inf)) for values in curves.values()
        )
        axes.set_ylim(max(0.7 * least, top * 10.0**-_DECADES), 2.5 * top)
    axes.legend(
        loc="lower right",
        ncols=min(len(curves), 4),
        fontsize=NOTE,
        frameon=True,
        framealpha=0.85,
        edgecolor="none",
        handlelength=1.6,
        columnspacing=1.0,
        borderaxespad=0.3,
        bbox_to_anchor=(1.0, 0.0, 0.0, PANEL_WIDTH),
    )
