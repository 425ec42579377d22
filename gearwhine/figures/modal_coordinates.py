"""Modal coordinates in time and frequency, after Figs. 7, 8, 10 and 11 of NASA TM-101442."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from coupling import Window, amplitude_spectrum, signal_parts
from gearwhine.figures.style import SERIES, tidy

FloatArray = npt.NDArray[np.float64]

_MODES = 4  # that a panel tells apart
_LONGEST = 6000  # points of a curve


def draw_modal_coordinates(
    title: str, times: FloatArray, coordinates: Mapping[str, FloatArray], limit: float, window: Window
) -> Figure:
    """Draw each kind of coordinates of each part: left over time, right their spectra without the d.c. part.

    Parameters
    ----------
    title
        Of the figure.
    times
        (s,): s, evenly spaced.
    coordinates
        (s,) each, named ``part: kind number``, with an axis after a comma.
    limit
        Of the frequency axis, Hz.
    window
        Of the spectra.
    """
    groups: dict[str, dict[str, FloatArray]] = {}
    for name, values in coordinates.items():
        kind, _, axis = name.partition(", ")
        head, _, number = kind.rpartition(" ")
        groups.setdefault(f"{head}, {axis}" if axis else head, {})[number] = values
    figure = Figure(figsize=(10.0, 0.7 + 2.1 * len(groups)), layout="constrained")
    interval, every = float(times[1] - times[0]), max(1, times.size // _LONGEST)
    rows = figure.subplots(len(groups), 2, squeeze=False)
    for (left, right), (name, group) in zip(rows, groups.items(), strict=True):
        top = 0.0
        for color, (number, values) in zip(SERIES, list(group.items())[:_MODES], strict=False):
            parts = signal_parts(values)
            label = f"mode {number}: d.c. {float(parts.mean):.2e}, a.c. {float(parts.rms):.1e} rms"
            left.plot(1e3 * (times - times[0])[::every], values[::every], color=color, lw=0.7, label=label)
            spectrum = amplitude_spectrum(values, interval, window)
            shown = (spectrum.frequencies > 0.0) & (spectrum.frequencies <= limit)
            right.plot(spectrum.frequencies[shown], spectrum.amplitude[shown], color=color, lw=0.8)
            top = max(top, float(spectrum.amplitude[shown].max(initial=0.0)))
        if top > 0.0:
            right.set_yscale("log")
            right.set_ylim(1e-5 * top, 3.0 * top)
        right.set_xlim(0.0, limit)
        left.legend(fontsize=7, frameon=False, loc="upper left", bbox_to_anchor=(0.0, 1.0), ncols=1)
        low, high = left.get_ylim()
        left.set_ylim(low, high + 0.45 * (high - low))
        left.set_title(name, fontsize=9, loc="left", parse_math=False)
        for axes in (left, right):
            tidy(axes, size=8.0)
    left.set_xlabel("time [ms]")
    right.set_xlabel("frequency [Hz]; peak amplitudes")
    figure.suptitle(f"{title} [m √kg; torsion: rad √(kg m²)]", fontsize=11, parse_math=False)
    return figure
