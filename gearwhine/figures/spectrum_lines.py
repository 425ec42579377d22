"""Spectral lines on a logarithmic scale."""

import numpy as np
from matplotlib.axes import Axes

from coupling import Spectrum
from gearwhine.figures.style import BLUE

_MOST_LINES = 1 << 12
_DECADES = 5.0  # of the amplitude axis, below its highest line


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
