"""Transmission error figures: static transmission error, mesh stiffness and Harris map of a gear pair.

The transmission error is drawn over a mesh period with and without load, and by its harmonics; the mesh stiffness with
the load shares of the tooth pairs; the Harris map for a range of torques, with the peak to peak over torque.
"""

import numpy as np
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from gearwhine.coupling.gears import LoadedMesh, ToothContact, mesh_stiffness
from gearwhine.coupling.gears.loaded.optimal_relief import HarrisMap
from gearwhine.coupling.gears.loaded.transmission_error import (
    MeshStiffnessFigures,
    mesh_stiffness_figures,
    period_mean,
)
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    INK,
    LABEL,
    LEFT,
    MEGA,
    MICRO,
    MM_PER_INCH,
    NOTE,
    PANEL_WIDTH,
    RED,
    SERIES,
    TICK,
    legend,
    panel,
    sheet,
)
from gearwhine.numerics.arrays import FloatArray

_STIFFNESS, _SHARES, _BETWEEN = 66.0, 42.0, 5.0  # heights of the panels and the gap between them [mm of paper]


def draw_mesh_stiffness(
    title: str,
    contact: ToothContact,
    mesh: LoadedMesh,
    *,
    shared: bool = True,
    figures: MeshStiffnessFigures | None = None,
) -> Figure:
    """Draw the stiffness of all pairs on the path and of those that touch, and the share of each below.

    Parameters
    ----------
    title : str
        Title of the sheet.
    contact : ToothContact
    mesh : LoadedMesh
        Statics over one mesh period.
    shared : bool
        Whether single pairs share the load, rather than the mesh as one spring. Without load none shares.
    figures : MeshStiffnessFigures, optional
        Means of the subtitle; by default of this mesh period.
    """
    figures = figures or mesh_stiffness_figures(contact, mesh)
    loaded = mesh.force > 0.0
    below = _SHARES + _BETWEEN if shared and loaded else 0.0
    note = f"mesh force {mesh.force:.5g} N; " if loaded else "without load; "
    over = " over the hunting period" if figures.over_hunting_period else ""
    note += f"mean stiffness{over} of all pairs on the path of contact {MEGA * figures.mean:.2f} N/µm"
    if loaded:
        note += f", of those that touch {MEGA * figures.loaded_mean:.2f} N/µm"
    if figures.over_hunting_period:
        note += "; drawn: the first mesh period"
    figure = sheet(HEAD + _STIFFNESS + below + FOOT, title, note)
    upper = panel(figure, FOOT + below, _STIFFNESS)
    on_path = mesh_stiffness(contact, mesh.phases)
    handles = upper.plot(mesh.phases, MEGA * on_path, color=GREY, lw=1.2, label="all pairs on the path")
    if loaded:
        touching = MEGA * mesh.tangent_stiffness
        handles += upper.plot(mesh.phases, touching, color=BLUE, lw=1.4, label="pairs that touch under the load")
    upper.set(ylabel="mesh stiffness [N/µm]", xlim=(0.0, 1.0))
    upper.set_ylim(0.0, 1.08 * MEGA * max(float(on_path.max()), float(mesh.tangent_stiffness.max())))
    mark_events(upper, contact)
    legend(figure, handles)
    if below:
        upper.tick_params(labelbottom=False)
        lower = panel(figure, FOOT, _SHARES)
        _draw_shares(lower, contact, mesh)
        mark_events(lower, contact)
    figure.axes[-1].set_xlabel("mesh period")
    return figure


def mark_events(axes: Axes, contact: ToothContact) -> None:
    """Thin lines where pairs enter their path of contact and where they leave it."""
    for phase in contact.event_phases:
        axes.axvline(phase, color=GREY, lw=0.7, ls=(0, (2, 2)), zorder=1, label="_event")


def _draw_shares(axes: Axes, contact: ToothContact, mesh: LoadedMesh) -> None:
    present = contact.pairs(mesh.phases).present
    for column in np.flatnonzero(present.any(axis=0)):
        before = round(float(mesh.positions[0, column] - mesh.phases[0] % 1.0))
        share = np.where(present[:, column], 100.0 * mesh.load_shares[:, column], np.nan)
        axes.plot(mesh.phases, share, color=SERIES[before % len(SERIES)], lw=1.3, label=_name(before))
    axes.set(ylabel="share of the load [%]", xlim=(0.0, 1.0), ylim=(-4.0, 104.0))
    axes.yaxis.set_major_locator(MultipleLocator(25.0))
    axes.legend(loc="best", fontsize=NOTE, framealpha=0.9, edgecolor="none")


def _name(before: int) -> str:
    """Name of a pair by the number of mesh periods since it entered, each its own."""
    if before == 0:
        return "pair that enters at 0"
    if before < 0:
        return "pair that follows" if before == -1 else f"{-before} pairs after"
    return "pair before" if before == 1 else f"{before} pairs before"


_CURVE, _HUNTING, _BARS, _CURVE_GAP = 58.0, 34.0, 36.0, 12.0  # heights and the gap between them [mm of paper]
_NOTHING = 1e-6  # part of the largest harmonic up to which another counts as zero
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
    title : str
        Title of the sheet.
    phases, unloaded : ndarray, shape (n,)
        Phases, and transmission error without load over one mesh period [m].
    harmonics : dict of str to ndarray, shape (h,)
        Harmonics from the mesh frequency up [m], by ``"unloaded"`` and ``"loaded"``.
    loaded : LoadedMesh, optional
        Statics under the load over the same period.
    hunting : LoadedMesh, optional
        Statics under the load over the whole hunting period, where mesh periods differ.
    """
    curves = [("without load", phases, unloaded, GREY)]
    if loaded is not None:
        curves.append((f"under {loaded.force:.4g} N", loaded.phases, loaded.transmission_error, BLUE))
    middle = _HUNTING + _CURVE_GAP if hunting is not None else 0.0
    note = "; ".join(
        f"{name} {MICRO * period_mean(at, curve):z.3f} µm in the mean, {MICRO * np.ptp(curve):.3f} µm peak to peak"
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
    # Perfect involutes without load have no harmonics: bars under load then stand at their numbers.
    harmonics = {name: row for name, row in harmonics.items() if row.max(initial=0.0) > _NOTHING * largest} or harmonics
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


_CURVES, _SWING, _MAP_GAP = 78.0, 42.0, 12.0  # heights of the panels and the gap between them [mm of paper]
_SCALE, _BESIDE, _NUMBERS = 3.0, 3.0, 13.0  # widths of the colour bar, of the gap before it and of its numbers [mm]
_COLORS = colormaps["viridis"]
_BRIGHTEST = 0.92  # end of the colour scale: yellow on white is hard to see


def draw_harris_map(title: str, harris: HarrisMap, base_radius: float, torque: float | None = None) -> Figure:
    """Draw a curve for each torque in the torque's colour, and peak to peak over torque below.

    Parameters
    ----------
    title : str
        Title of the sheet.
    harris : HarrisMap
        Transmission error by force and phase; two forces or more.
    base_radius : float
        Base radius of the driver, which turns forces into torques [m].
    torque : float, optional
        Torque of operation, marked in both panels where it is in the map's range [N m].

    Raises
    ------
    ValueError
        Fewer than two forces.
    """
    if harris.forces.size < 2:
        raise ValueError(f"a Harris map is drawn of two or more loads, got {harris.forces.size}")
    torques, swing = harris.forces * base_radius, MICRO * harris.peak_to_peak
    best = int(swing.argmin())
    note = f"quietest of these torques: {torques[best]:.4g} N·m with {swing[best]:.3f} µm peak to peak"
    figure = sheet(HEAD + _CURVES + _MAP_GAP + _SWING + FOOT, title, note)
    width = PANEL_WIDTH - _BESIDE - _SCALE - _NUMBERS
    upper = panel(figure, FOOT + _SWING + _MAP_GAP, _CURVES, width=width)
    lower = panel(figure, FOOT, _SWING, width=width)
    scale = Normalize(float(torques[0]), float(torques[-1]) / _BRIGHTEST)
    for load, curve in zip(torques, harris.transmission_error, strict=True):
        upper.plot(harris.phases, MICRO * curve, color=_COLORS(scale(load)), lw=1.0, label="_torque")
    upper.set(xlabel="mesh period", ylabel="transmission error [µm]", xlim=(0.0, 1.0))
    across, up = (float(inches) * MM_PER_INCH for inches in figure.get_size_inches())
    place = ((LEFT + width + _BESIDE) / across, (FOOT + _SWING + _MAP_GAP) / up, _SCALE / across, _CURVES / up)
    bar = figure.colorbar(ScalarMappable(scale, _COLORS), cax=figure.add_axes(place))
    bar.ax.set_ylim(float(torques[0]), float(torques[-1]))
    bar.ax.tick_params(labelsize=TICK, colors=INK)
    bar.set_label("torque on the driver [N·m]", size=LABEL, color=INK)

    lower.plot(torques, swing, color=BLUE, lw=1.3, marker="o", ms=2.5, label="_peak to peak")
    lower.plot(torques[best], swing[best], marker="o", ms=5.5, mfc="none", mec=INK, mew=0.9, label="_quietest")
    lower.set(xlabel="torque on the driver [N·m]", ylabel="peak to peak [µm]")
    lower.set_xlim(0.0, 1.02 * float(torques[-1]))
    lower.set_ylim(0.0, 1.1 * float(swing.max()) or 1.0)
    if torque is not None and torques[0] <= torque <= torques[-1]:
        nearest = int(np.abs(torques - torque).argmin())
        upper.plot(harris.phases, MICRO * harris.transmission_error[nearest], color=RED, lw=1.6, label="_operation")
        lower.axvline(torque, color=RED, lw=1.0, zorder=1, label="_operation")
        lower.annotate(
            f"{np.interp(torque, torques, swing):.3f} µm",
            (torque, 1.0),
            (3, -2),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            size=NOTE,
            color=RED,
            va="top",
        )
        legend(figure, [Line2D([], [], color=RED, lw=1.4, label=f"operation, {torque:.4g} N·m")])
    return figure
