"""Load sharing, contact pressure and sliding velocity along the path of contact."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coupling.gears import GearPairGeometry, LoadedMesh, ToothContact, path_of_contact, specific_sliding
from gearwhine.figures.style import BLUE, FOOT, GREY, HEAD, INK, LABEL, MEGA, SERIES, legend, panel, sheet

FloatArray = npt.NDArray[np.float64]

_SHARE, _PRESSURE, _SLIDING, _BETWEEN, _LETTERS = 40.0, 40.0, 36.0, 4.0, 5.0  # [mm of paper]
_NAMES = "ABCDE"
_STEEPEST = 4.0  # specific sliding beyond this is cut off: it has no bound towards a base circle


def draw_contact_path(
    title: str, pair: GearPairGeometry, contact: ToothContact, mesh: LoadedMesh, pressure: FloatArray | None = None
) -> Figure:
    """Draw share of the load, Hertzian pressure and specific sliding over the driver's roll angle.

    Parameters
    ----------
    title
        Of the sheet.
    pair, contact, mesh
        Under a load, over one mesh period.
    pressure
        (n, m): of the pairs of `mesh`, Pa, NaN where it has no meaning; None leaves its panel out.
    """
    present = contact.pairs(mesh.phases).present
    order = np.argsort(mesh.positions[present], kind="stable")
    positions = mesh.positions[present][order]
    rolls = np.degrees(pair.driver_roll_angle(positions))
    below = FOOT + _SLIDING + _BETWEEN
    middle = _PRESSURE + _BETWEEN if pressure is not None else 0.0
    note = (
        "A, E: the driver's active profile starts and ends; B: the pair before leaves; C: pitch point; D: the next one"
    )
    if contact.contact_range[0] < 0.0:
        note += "; beyond A and E " + ("the face's other parts" if contact.faces is not None else "corners touch")
    figure = sheet(HEAD + _LETTERS + _SHARE + _BETWEEN + middle + _SLIDING + FOOT, title, note)
    share = panel(figure, below + middle, _SHARE)
    share.plot(rolls, 100.0 * mesh.load_shares[present][order], color=BLUE, lw=1.4, label="_share")
    share.set(ylabel="share of the load [%]", ylim=(0.0, 104.0))
    panels = [share]
    if pressure is not None:
        axes = panel(figure, below, _PRESSURE)
        axes.plot(rolls, MEGA * pressure[present][order], color=BLUE, lw=1.4, label="_pressure")
        axes.set(ylabel="contact pressure [MPa]")
        axes.set_ylim(0.0, 1.1 * MEGA * float(np.nanmax(pressure[np.isfinite(pressure)], initial=0.0)) or 1.0)
        panels.append(axes)
    axes = panel(figure, FOOT, _SLIDING)
    on_path = np.linspace(0.0, pair.contact_ratio, 201)
    handles = []
    for name, color, sliding in zip(
        ("driver", "driven gear"), (BLUE, SERIES[1]), specific_sliding(pair, on_path), strict=True
    ):
        shown = np.where(sliding < -_STEEPEST, np.nan, sliding)
        handles += axes.plot(np.degrees(pair.driver_roll_angle(on_path)), shown, color=color, lw=1.3, label=name)
    axes.axhline(0.0, color=GREY, lw=0.6, zorder=1)
    axes.set(xlabel="roll angle of the driver [°]", ylabel="specific sliding")
    legend(figure, handles)
    panels.append(axes)
    for axes in panels:
        axes.set_xlim(float(rolls[0]), float(rolls[-1]))
        axes.tick_params(labelbottom=axes is panels[-1])
    mark_points(panels, np.degrees(path_of_contact(pair).driver_roll_angle))
    return figure


def mark_points(panels: list[Axes], places: FloatArray) -> None:
    """Lines at the named points of the path in all panels, and their letters above the first."""
    for letter, place in zip(_NAMES, places.tolist(), strict=True):
        for axes in panels:
            axes.axvline(place, color=GREY, lw=0.7, ls=(0, (2, 2)), zorder=1, label="_point")
        panels[0].annotate(
            letter,
            (place, 1.0),
            (0, 3),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            size=LABEL,
            color=INK,
            ha="center",
        )
