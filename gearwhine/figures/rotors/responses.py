"""Rotor responses: unbalance response over speed, torsional response over frequency.

The unbalance response shows amplitude and phase at probes, with critical speeds and the operating range; the torsional
response the angle at probes and the torque in the shaft, with the natural frequencies.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gearwhine.figures.style import (
    FOOT,
    GREY,
    HEAD,
    HERTZ,
    INK,
    PANEL_WIDTH,
    RPM,
    SERIES,
    Label,
    arrange,
    degree_axis,
    draw_row,
    legend_beside_title,
    name_in_legend,
    name_lowest,
    panel,
    sheet,
    stacked,
)
from gearwhine.numerics.arrays import ComplexArray, FloatArray

_AMPLITUDE, _PHASE, _BETWEEN = 70.0, 40.0, 4.0  # heights of the panels and the gap between them [mm of paper]
_PEAK_TO_PEAK = 2e6  # peak-to-peak µm of an amplitude of one metre
_DECADES = 5.0  # decades of a logarithmic amplitude below its highest


@dataclass(frozen=True)
class ProbeResponse:
    """Response at a probe over speed.

    Parameters
    ----------
    name : str
        Name of the probe.
    amplitude : ndarray of complex, shape (s,)
        The displacement along the probe is Re(amplitude e^{i|Ω|t}), with the unbalance's angle at Ωt from x [m]; of a
        clockwise rotor that is the conjugate of a response at its negative Ω.
    major_axis : ndarray, shape (s,), optional
        Semi-major axis of the orbit there, where known [m].
    """

    name: str
    amplitude: ComplexArray
    major_axis: FloatArray | None = None


def draw_unbalance_response(
    title: str,
    speeds: npt.ArrayLike,
    probes: Sequence[ProbeResponse],
    *,
    critical_speeds: npt.ArrayLike = (),
    operating_range: tuple[float, float] | None = None,
    logarithmic: bool = False,
) -> Figure:
    """Draw peak-to-peak amplitude and phase lag over speed (a Bode plot, as API 617 asks for).

    Parameters
    ----------
    title : str
        Title of the sheet.
    speeds : array_like, shape (s,)
        Two or more ascending speeds [rad/s].
    probes : sequence of ProbeResponse
    critical_speeds : array_like, shape (c,)
        Critical speeds [rad/s], marked where they are in the range.
    operating_range : tuple of float, optional
        Lowest and highest speed of operation, shaded [rad/s]; a single speed given twice is a line.
    logarithmic : bool
        Whether the amplitude has a logarithmic axis.

    Raises
    ------
    ValueError
        Fewer than two speeds, or a response of another length.
    """
    turning = np.asarray(speeds, dtype=np.float64)
    wrong = [probe.name for probe in probes if np.shape(probe.amplitude) != turning.shape]
    if turning.ndim != 1 or turning.size < 2 or not bool((np.diff(turning) > 0.0).all()) or wrong:
        raise ValueError(f"speeds {turning.shape} are not two or more ascending ones, or do not fit the probes {wrong}")
    low, high = float(turning[0]), float(turning[-1])
    marked = [speed for speed in np.atleast_1d(critical_speeds).tolist() if low <= speed <= high]

    moving = max((_largest(probe) for probe in probes), default=0.0)
    # A logarithmic axis has no place for zero.
    logarithmic, top = logarithmic and moving > 0.0, moving or 1.0
    ceiling = 2.0 * top if logarithmic else 1.08 * top
    labels = [Label(f"{RPM * speed:.4g}", RPM * speed, ceiling) for speed in marked]
    row = arrange(labels, [(label.x / RPM - low) / (high - low) * PANEL_WIDTH for label in labels], PANEL_WIDTH)
    notes = ["peak to peak", "phase lag behind the unbalance"]
    notes += ["dashed: major axis of the orbit"] * any(probe.major_axis is not None for probe in probes)
    notes += ["above: critical speeds in rpm"] * bool(marked)
    notes += [f"{row.left_out} of them not named"] * bool(row.left_out)
    figure = sheet(HEAD + row.height + 2.0 + _AMPLITUDE + _BETWEEN + _PHASE + FOOT, title, "; ".join(notes))
    upper, lower = panel(figure, FOOT + _PHASE + _BETWEEN, _AMPLITUDE), panel(figure, FOOT, _PHASE)
    handles: list[Artist] = []
    for axes in (upper, lower):
        axes.set_xlim(RPM * low, RPM * high)
        for speed in marked:
            axes.axvline(RPM * speed, color=GREY, lw=0.7, zorder=1, label="critical speed")
        if operating_range is not None:
            begin, end = (RPM * abs(speed) for speed in operating_range)
            if begin == end:
                mark: Artist = axes.axvline(begin, color=INK, lw=0.8, ls=":", zorder=1, label="operation")
            else:
                mark = axes.axvspan(begin, end, color=GREY, alpha=0.14, lw=0.0, zorder=0.2, label="operation")
            handles = [mark]
    for number, probe in enumerate(probes):
        color = SERIES[number % len(SERIES)]
        size = _PEAK_TO_PEAK * np.abs(probe.amplitude)
        name = name_in_legend(probe.name)
        handles += upper.plot(RPM * turning, size, color=color, lw=1.2, zorder=3, label=name)
        if probe.major_axis is not None:
            axis = _PEAK_TO_PEAK * np.asarray(probe.major_axis)
            upper.plot(RPM * turning, axis, color=color, lw=0.9, ls=(0, (4, 2)), zorder=2.5, label="_major axis")
        lower.plot(RPM * turning, phase_lag(probe.amplitude), color=color, lw=1.2, zorder=3)
    if logarithmic:
        least = min((_least(probe) for probe in probes), default=top)
        upper.set(yscale="log", ylim=(max(0.7 * least, top * 10.0**-_DECADES), ceiling))
    else:
        upper.set_ylim(0.0, ceiling)
    upper.tick_params(labelbottom=False)
    upper.set_ylabel("amplitude [µm peak to peak]")
    lower.set(xlabel="speed of rotation [rpm]", ylabel="phase lag [°]")
    degree_axis(lower)
    legend_beside_title(figure, upper, handles)
    draw_row(upper, row, _AMPLITUDE + 1.0)
    return figure


def phase_lag(amplitude: ComplexArray) -> FloatArray:
    """Return the lag of a response behind the unbalance [°], without jumps over speed, first between −90 and 270.

    Without motion the phase is NaN.
    """
    moving = np.abs(amplitude) > 0.0
    lag = np.full(np.shape(amplitude), np.nan)
    if moving.any():
        turned = np.degrees(np.unwrap(-np.angle(amplitude[moving])))
        lag[moving] = turned - 360.0 * np.floor((turned[0] + 90.0) / 360.0)
    return lag


def _largest(probe: ProbeResponse) -> float:
    readings = [np.abs(probe.amplitude)] + ([np.asarray(probe.major_axis)] if probe.major_axis is not None else [])
    return _PEAK_TO_PEAK * max(float(np.nanmax(reading)) for reading in readings)


def _least(probe: ProbeResponse) -> float:
    size = _PEAK_TO_PEAK * np.abs(probe.amplitude)
    return float(size[size > 0.0].min(initial=np.inf))


_RESPONSE_HEIGHT, _RESPONSE_GAP = 56.0, 4.0  # height of each panel and gap between them [mm of paper]
_AMPLITUDE_DECADES = 6.0  # decades shown below the highest amplitude


@dataclass(frozen=True)
class TorsionalReading:
    """Torsional response at one station of a shaft.

    Parameters
    ----------
    name : str
        Name of the place.
    angle, torque : ndarray, shape (b,)
        Angle [rad] and torque [N m], zero to peak.
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
    title : str
        Title of the sheet.
    frequencies : array_like, shape (b,)
        Two or more ascending frequencies [rad/s].
    readings : sequence of TorsionalReading
        Readings at each place.
    natural_frequencies : array_like
        Natural frequencies [rad/s], marked where they are in the range.

    Raises
    ------
    ValueError
        Fewer than two frequencies, or readings of another length.
    """
    omega = np.asarray(frequencies, dtype=np.float64)
    wrong = [
        reading.name for reading in readings if not np.shape(reading.angle) == np.shape(reading.torque) == omega.shape
    ]
    if omega.ndim != 1 or omega.size < 2 or not bool((np.diff(omega) > 0.0).all()) or wrong:
        raise ValueError(f"frequencies {omega.shape} are not two or more ascending ones, or do not fit {wrong}")
    low, high = float(omega[0]), float(omega[-1])
    marked = [value for value in np.atleast_1d(natural_frequencies).tolist() if low <= value <= high]
    tops = [
        max((float(np.max(getattr(reading, quantity))) for reading in readings), default=0.0)
        for quantity in ("angle", "torque")
    ]

    labels = [Label(f"{value / HERTZ:.4g}", value / HERTZ, 2.0 * (tops[0] or 1.0)) for value in marked]
    row = arrange(labels, [(value - low) / (high - low) * PANEL_WIDTH for value in marked], PANEL_WIDTH)
    note = "zero to peak; torque in the shaft to the right of each place"
    note += "; above: natural frequencies in Hz, free to turn" * bool(marked)
    figure, panels = stacked(2, _RESPONSE_HEIGHT, _RESPONSE_GAP, title, note, first=row.height + 2.0)
    handles: list[Line2D] = []
    shown = zip(panels, ("angle", "torque"), tops, ("angle [rad]", "torque [N·m]"), strict=True)
    for axes, quantity, top, name in shown:
        axes.set_xlim(low / HERTZ, high / HERTZ)
        for value in marked:
            axes.axvline(value / HERTZ, color=GREY, lw=0.7, zorder=1, label="natural frequency")
        lines = []
        for number, reading in enumerate(readings):
            values = getattr(reading, quantity)
            if values.max(initial=0.0) > 0.0:
                label = name_in_legend(reading.name)
                color = SERIES[number % len(SERIES)]
                lines += axes.plot(omega / HERTZ, values, color=color, lw=1.2, zorder=3, label=label)
        if top > 0.0:
            axes.set(yscale="log", ylim=(top * 10.0**-_AMPLITUDE_DECADES, 2.0 * top))
        axes.set_ylabel(name)
        handles = max(handles, lines, key=len)
    name_lowest(panels, "frequency [Hz]")
    legend_beside_title(figure, panels[0], handles)
    draw_row(panels[0], row, _RESPONSE_HEIGHT + 1.0)
    return figure
