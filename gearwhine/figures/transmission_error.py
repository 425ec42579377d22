"""Static transmission error of a gear pair: its curve with and without load, and its harmonics."""

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from coupling.gears import LoadedMesh
from coupling.gears.static import period_mean
from gearwhine.figures.style import BLUE, FOOT, GREY, HEAD, INK, MICRO, NOTE, legend, panel, sheet

FloatArray = npt.NDArray[np.float64]

_CURVE, _HUNTING, _BARS, _CURVE_GAP = 58.0, 34.0, 36.0, 12.0  # heights and the room between [mm of paper]
_SLIM = 0.42  # width of a bar, in harmonics


def draw_transmission_error(
    title: str,
    phases: FloatArray,
    unloaded: FloatArray,
    harmonics: dict[str, FloatArray],
    *,
    loaded: LoadedMesh | None = None,
    hunting: LoadedMesh | None = None,
) -> Figure:
    """Draw the transmission error about its mean over a mesh period, over the hunting period, and its harmonics.

    Parameters
    ----------
    title
        Of the sheet.
    phases, unloaded
        (n,): without load over one mesh period, m.
    harmonics
        By ``"unloaded"`` and ``"loaded"``, those that are drawn: (h,), m, from the mesh frequency up.
    loaded
        Over the same period.
    hunting
        Under the load over the whole hunting period, where mesh periods differ.
    """
    curves = [("without load", phases, unloaded, GREY)]
    if loaded is not None:
        curves.append((f"under {loaded.force:.4g} N", loaded.phases, loaded.transmission_error, BLUE))
    middle = _HUNTING + _CURVE_GAP if hunting is not None else 0.0
    note = "; ".join(
        f"{name} {MICRO * period_mean(at, curve):.3f} µm in the mean, {MICRO * np.ptp(curve):.3f} µm peak to peak"
        for name, at, curve, _ in curves
    )
    if hunting is not None:
        note += f"; over the hunting period {MICRO * hunting.peak_to_peak_transmission_error:.3f} µm peak to peak"
    figure = sheet(HEAD + _CURVE + _CURVE_GAP + middle + _BARS + FOOT, title, note)
    upper = panel(figure, FOOT + _BARS + _CURVE_GAP + middle, _CURVE)
    handles: list[Artist] = []
    for name, at, curve, color in curves:
        handles += upper.plot(at, MICRO * (curve - period_mean(at, curve)), color=color, lw=1.4, label=name)
    upper.set(xlabel="mesh period", ylabel="about its mean [µm]", xlim=(0.0, 1.0))
    legend(figure, handles)
    if hunting is not None:
        axes = panel(figure, FOOT + _BARS + _CURVE_GAP, _HUNTING)
        about = MICRO * (hunting.transmission_error - hunting.mean_transmission_error)
        axes.plot(hunting.phases, about, color=BLUE, lw=0.7, label="hunting")
        axes.set(xlabel="mesh periods of the hunting period", ylabel="about its mean [µm]")
        axes.set_xlim(0.0, round(float(hunting.phases[-1]) + 0.5))
    _draw_bars(panel(figure, FOOT, _BARS), harmonics)
    return figure


def _draw_bars(axes: Axes, harmonics: dict[str, FloatArray]) -> None:
    largest = max((float(row.max(initial=0.0)) for row in harmonics.values()), default=0.0)
    shift = 0.5 * _SLIM * (len(harmonics) - 1)
    for number, (name, row) in enumerate(harmonics.items()):
        order = np.arange(1, row.size + 1) - shift + number * _SLIM
        axes.bar(order, MICRO * row, _SLIM, color=BLUE if name == "loaded" else GREY, label=name)
        if name == "loaded" or len(harmonics) == 1:
            for x, amplitude in zip(order, row, strict=True):
                text = f"{MICRO * amplitude:.2g}"
                # From the bar's own left edge: another bar may stand higher beside it.
                place = (float(x) - 0.5 * _SLIM, MICRO * float(amplitude))
                axes.annotate(text, place, (1, 1.5), textcoords="offset points", size=NOTE, color=INK, ha="left")
    axes.set(xlabel="multiple of the mesh frequency", ylabel="amplitude [µm, peak]")
    axes.set_ylim(0.0, 1.18 * MICRO * largest or 1.0)
    axes.xaxis.set_major_locator(MultipleLocator(1.0))
    axes.grid(visible=False, axis="x")
