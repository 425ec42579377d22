"""Mesh stiffness over a mesh period, and the load shares of the tooth pairs."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from coupling.gears import LoadedMesh, ToothContact, mesh_stiffness
from gearwhine.figures.style import BLUE, FOOT, GREY, HEAD, MEGA, NOTE, SERIES, legend, panel, sheet

FloatArray = npt.NDArray[np.float64]

_STIFFNESS, _SHARES, _BETWEEN = 66.0, 42.0, 5.0  # heights of the panels and the room between them [mm of paper]


def draw_mesh_stiffness(title: str, contact: ToothContact, mesh: LoadedMesh, *, shared: bool = True) -> Figure:
    """Draw the stiffness of all pairs on the path and of those that touch, and the share of each below.

    Parameters
    ----------
    title
        Of the sheet.
    contact, mesh
        The pair's law, and its statics over one mesh period.
    shared
        Whether there are single pairs to share the load, not the mesh as one spring. Without load none shares.
    """
    loaded = mesh.force > 0.0
    below = _SHARES + _BETWEEN if shared and loaded else 0.0
    note = f"mesh force {mesh.force:.5g} N; " if loaded else "without load; "
    note += f"mean stiffness of all pairs on the path of contact {MEGA * contact.mean_mesh_stiffness:.2f} N/µm"
    if loaded:
        note += f", of those that touch {MEGA * mesh.mean_mesh_stiffness:.2f} N/µm"
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
    """Name of a pair by the number of mesh periods since it entered."""
    if before <= 0:
        return "pair that enters at 0" if before == 0 else "pair that follows"
    return "pair before" if before == 1 else f"{before} pairs before"
