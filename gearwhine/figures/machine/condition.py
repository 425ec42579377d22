"""Figure of a machine's condition: envelope spectra of the sensors with the tones of rolling bearings."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from gearwhine.coupling.analyses.gear_condition import MachineCondition
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    SERIES,
    legend_below,
    legend_height,
    name_in_legend,
    name_lowest,
    panel_title,
    shortened,
    stacked,
)

_HEIGHT, _GAP = 34.0, 9.0  # of a panel, and between two [mm]
_MOST_SENSORS, _MOST_TONES = 8, 6
_HARMONICS = 3  # multiples of a tone that are marked
_SHOWN = 1.1  # shown frequencies over the highest one that is marked


def draw_envelopes(title: str, condition: MachineCondition) -> Figure:
    """Draw the envelope spectra of up to eight sensors, with the highest tones of bearings and their multiples."""
    sensors = list(condition.envelopes)[:_MOST_SENSORS]

    def height(tone: str) -> float:
        found = next(one for one in condition.tones if one.tone == tone)
        return max((value or 0.0 for value in found.amplitudes.values()), default=0.0)

    tones = sorted((one.tone for one in condition.tones), key=height, reverse=True)[:_MOST_TONES]
    frequency = {one.tone: one.frequency_hz for one in condition.tones}
    low = legend_height(len(tones), 3)
    limit_hz = condition.limit_hz
    middle_hz = 0.5 * limit_hz
    note = (
        f"{shortened(title, 40)}; squared envelope of {middle_hz:.0f} to {limit_hz:.0f} Hz "
        "over its mean; dotted: multiples of the bearings' tones, which a damaged part raises"
    )
    figure, panels = stacked(len(sensors), _HEIGHT, _GAP, "Envelope spectra", note, first=5.0, foot=FOOT + low)
    end = min(float(condition.envelope_hz[-1]), _SHOWN * _HARMONICS * max(frequency[tone] for tone in tones))
    within = (condition.envelope_hz > 0.0) & (condition.envelope_hz <= end)
    for sensor, axes in zip(sensors, panels, strict=True):
        for color, tone in zip(SERIES[1:], tones, strict=False):
            for multiple in range(1, _HARMONICS + 1):
                axes.axvline(multiple * frequency[tone], color=color, lw=1.0, ls=":", zorder=1)
        values = np.where(within, condition.envelopes[sensor], 0.0)
        axes.plot(condition.envelope_hz[within], values[within], color=BLUE, lw=1.1, zorder=2)
        axes.set_xlim(0.0, end)
        axes.set_ylim(0.0, 1.1 * max(float(values.max()), 1e-12))
        axes.yaxis.set_major_locator(MaxNLocator(4))
        axes.set_ylabel("line / mean")
        panel_title(axes, sensor)
    name_lowest(panels, "modulation frequency [Hz]")
    marks = [
        Line2D([], [], color=color, lw=1.0, ls=":", label=f"{name_in_legend(tone, 36)}, {frequency[tone]:.1f} Hz")
        for color, tone in zip(SERIES[1:], tones, strict=False)
    ]
    legend_below(figure, marks, columns=3)
    return figure
