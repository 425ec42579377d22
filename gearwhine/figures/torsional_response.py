"""Torsional response over frequency: angle at probes and torque in the shaft, with the natural frequencies."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gearwhine.figures.labels import Label, arrange, draw_row
from gearwhine.figures.style import (
    FOOT,
    GREY,
    HEAD,
    HERTZ,
    PANEL_WIDTH,
    SERIES,
    legend_beside_title,
    name_in_legend,
    panel,
    sheet,
)

FloatArray = npt.NDArray[np.float64]

_RESPONSE_HEIGHT, _RESPONSE_GAP = 56.0, 4.0  # of each panel and the room between them [mm of paper]
_AMPLITUDE_DECADES = 6.0  # shown below the highest


@dataclass(frozen=True)
class TorsionalReading:
    """Torsional response at one station of a shaft.

    Parameters
    ----------
    name
        Of the place.
    angle, torque
        (b,): zero to peak, rad and N·m.
    """

    name: str
    angle: FloatArray
    torque: FloatArray


def draw_torsional_response(
    title: str,
    frequencies: npt.ArrayLike,
    readings: Sequence[TorsionalReading],
    *,
    natural_frequencies: npt.ArrayLike = (),
) -> Figure:
    """Draw angle and torque over frequency, zero to peak, on logarithmic axes.

    Parameters
    ----------
    title
        Of the sheet.
    frequencies
        (b,): two or more, ascending, rad/s.
    readings
        At each place, each (b,).
    natural_frequencies
        rad/s, marked where they are in the range.

    Raises
    ------
    ValueError
        Fewer than two frequencies, or readings of another length.
    """
    omega = np.asarray(frequencies, dtype=np.float64)
    wrong = [one.name for one in readings if not np.shape(one.angle) == np.shape(one.torque) == omega.shape]
    if omega.ndim != 1 or omega.size < 2 or not bool((np.diff(omega) > 0.0).all()) or wrong:
        raise ValueError(f"frequencies {omega.shape} are not two or more ascending ones, or do not fit {wrong}")
    low, high = float(omega[0]), float(omega[-1])
    marked = [value for value in np.atleast_1d(natural_frequencies).tolist() if low <= value <= high]
    tops = [max((float(np.max(getattr(one, what))) for one in readings), default=0.0) for what in ("angle", "torque")]

    labels = [Label(f"{value / HERTZ:.4g}", value / HERTZ, 2.0 * (tops[0] or 1.0)) for value in marked]
    row = arrange(labels, [(value - low) / (high - low) * PANEL_WIDTH for value in marked], PANEL_WIDTH)
    note = "zero to peak; torque in the shaft to the right of each place"
    note += "; above: natural frequencies in Hz, free to turn" * bool(marked)
    figure = sheet(HEAD + row.height + 2.0 + 2.0 * _RESPONSE_HEIGHT + _RESPONSE_GAP + FOOT, title, note)
    upper, lower = (
        panel(figure, FOOT + _RESPONSE_HEIGHT + _RESPONSE_GAP, _RESPONSE_HEIGHT),
        panel(figure, FOOT, _RESPONSE_HEIGHT),
    )
    handles: list[Line2D] = []
    for axes, what, top, name in (
        (upper, "angle", tops[0], "angle [rad]"),
        (lower, "torque", tops[1], "torque [N m]"),
    ):
        axes.set_xlim(low / HERTZ, high / HERTZ)
        for value in marked:
            axes.axvline(value / HERTZ, color=GREY, lw=0.7, zorder=1, label="natural frequency")
        lines = []
        for number, one in enumerate(readings):
            values = getattr(one, what)
            if values.max(initial=0.0) > 0.0:
                label = name_in_legend(one.name)
                color = SERIES[number % len(SERIES)]
                lines += axes.plot(omega / HERTZ, values, color=color, lw=1.2, zorder=3, label=label)
        if top > 0.0:
            axes.set(yscale="log", ylim=(top * 10.0**-_AMPLITUDE_DECADES, 2.0 * top))
        axes.set_ylabel(name)
        handles = max(handles, lines, key=len)
    upper.tick_params(labelbottom=False)
    lower.set_xlabel("frequency [Hz]")
    legend_beside_title(figure, upper, handles)
    draw_row(upper, row, _RESPONSE_HEIGHT + 1.0)
    return figure
