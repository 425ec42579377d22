"""The static transmission error of a gear pair: its curve with and without load, and the tones that it holds."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from coupling.gears import StaticMesh
from gearwhine.figures.style import BLUE, FOOT, GREY, HEAD, INK, NOTE, legend, panel, sheet

FloatArray = npt.NDArray[np.float64]

_CURVE, _HUNTING, _BARS, _BETWEEN = 58.0, 34.0, 36.0, 12.0  # heights and the room between [mm of paper]
_MICRO = 1e6
_SLIM = 0.36  # width of a bar, in harmonics


def draw_transmission_error(
    title: str,
    unloaded: StaticMesh,
    loaded: StaticMesh | None,
    harmonics: dict[str, FloatArray],
    *,
    hunting: StaticMesh | None = None,
) -> Figure:
    """Draw the transmission error about its mean over a mesh period, over the hunting period, and its harmonics.

    Parameters
    ----------
    title
        Of the sheet.
    unloaded, loaded
        Over one mesh period; None where there is no load.
    harmonics
        By ``"unloaded"`` and ``"loaded"``, those that are drawn: (h,), m, from the mesh frequency up.
    hunting
        Under the load over the whole hunting period, where mesh periods differ.
    """
    curves = [("unloaded", unloaded, GREY)] + ([("loaded", loaded, BLUE)] if loaded is not None else [])
    middle = _HUNTING + _BETWEEN if hunting is not None else 0.0
    note = "; ".join(_in_words(name, mesh) for name, mesh, _ in curves)
    if hunting is not None:
        note += f"; over the hunting period {_MICRO * hunting.peak_to_peak_transmission_error:.3f} µm peak to peak"
    figure = sheet(HEAD + _CURVE + _BETWEEN + middle + _BARS + FOOT, title, note)
    upper = panel(figure, FOOT + _BARS + _BETWEEN + middle, _CURVE)
    handles = []
    for name, mesh, color in curves:
        swing = _MICRO * (mesh.transmission_error - mesh.mean_transmission_error)
        what = "without load" if name == "unloaded" else f"under {mesh.force:.4g} N"
        handles += upper.plot(mesh.phases, swing, color=color, lw=1.4, label=what)
    upper.set(xlabel="mesh period", ylabel="about its mean [µm]", xlim=(0.0, 1.0))
    legend(figure, handles)
    if hunting is not None:
        axes = panel(figure, FOOT + _BARS + _BETWEEN, _HUNTING)
        about = _MICRO * (hunting.transmission_error - hunting.mean_transmission_error)
        axes.plot(hunting.phases, about, color=BLUE, lw=0.7, label="hunting")
        axes.set(xlabel="mesh periods of the hunting period", ylabel="about its mean [µm]")
        axes.set_xlim(0.0, round(float(hunting.phases[-1]) + 0.5))
    _draw_bars(panel(figure, FOOT, _BARS), harmonics)
    return figure


def _in_words(name: str, mesh: StaticMesh) -> str:
    mean, swing = _MICRO * mesh.mean_transmission_error, _MICRO * mesh.peak_to_peak_transmission_error
    return f"{name} {mean:.3f} µm in the mean, {swing:.3f} µm peak to peak"


def _draw_bars(axes: Axes, harmonics: dict[str, FloatArray]) -> None:
    largest = max((float(row.max(initial=0.0)) for row in harmonics.values()), default=0.0)
    shift = 0.5 * _SLIM * (len(harmonics) - 1)
    for number, (name, row) in enumerate(harmonics.items()):
        order = np.arange(1, row.size + 1) - shift + number * _SLIM
        axes.bar(order, _MICRO * row, _SLIM, color=BLUE if name == "loaded" else GREY, label=name)
        if name == "loaded" or len(harmonics) == 1:
            for x, amplitude in zip(order, row, strict=True):
                text = f"{_MICRO * amplitude:.3f}"
                place = (float(x), _MICRO * float(amplitude))
                axes.annotate(text, place, (0, 1.5), textcoords="offset points", size=NOTE, color=INK, ha="center")
    axes.set(xlabel="multiple of the mesh frequency", ylabel="amplitude [µm, peak]")
    axes.set_ylim(0.0, 1.18 * _MICRO * largest or 1.0)
    axes.xaxis.set_major_locator(MultipleLocator(1.0))
    axes.grid(visible=False, axis="x")
