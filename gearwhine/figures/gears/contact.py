"""Tooth contact figures: load sharing, pressure and sliding along the path of contact, and the contact pattern.

The contact pattern shows load and pressure over the flank while a pair of teeth passes through its mesh.
"""

import numpy as np
import numpy.typing as npt
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearwhine.coupling.gears import GearPairGeometry, LoadedMesh, ToothContact, path_of_contact
from gearwhine.coupling.gears.geometry.path_of_contact import specific_sliding
from gearwhine.coupling.gears.loaded.contact_pressure import mesh_pressure
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    INK,
    LABEL,
    MEGA,
    MILLI,
    MM_PER_INCH,
    PANEL_WIDTH,
    SERIES,
    TICK,
    legend,
    panel,
    sheet,
)
from gearwhine.numerics.arrays import FloatArray

_SHARE, _PRESSURE, _SLIDING, _BETWEEN, _LETTERS = 40.0, 40.0, 36.0, 4.0, 5.0  # [mm of paper]
_NAMES = "ABCDE"
_STEEPEST = 4.0  # specific sliding beyond this is cut off: it has no bound towards a base circle


def draw_contact_path(
    title: str,
    pair: GearPairGeometry,
    contact: ToothContact,
    along: tuple[LoadedMesh, npt.NDArray[np.bool_]],
    pressure: FloatArray | None = None,
) -> Figure:
    """Draw share of the load, Hertzian pressure and specific sliding over the driver's roll angle.

    Parameters
    ----------
    title : str
        Title of the sheet.
    pair : GearPairGeometry
    contact : ToothContact
    along : (LoadedMesh, ndarray of bool, shape (n, m))
        As of `gearwhine.coupling.gears.loaded.transmission_error.along_one_pair`.
    pressure : ndarray, shape (n, m), or None
        Pressure of the pairs of the mesh [Pa], NaN where it has no meaning; None leaves its panel out.
    """
    mesh, present = along
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
    if contact.hunting_period > 1:
        note += "; of teeth 0 of both gears: pairs differ by their pitch"
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
        drawn_sliding = np.where(sliding < -_STEEPEST, np.nan, sliding)
        handles += axes.plot(
            np.degrees(pair.driver_roll_angle(on_path)), drawn_sliding, color=color, lw=1.3, label=name
        )
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
    """Draw lines at the named points of the path in all panels, and their letters above the first."""
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


_MAP, _MAP_GAP, _MAP_LETTERS = 52.0, 6.0, 5.0  # height of a map, and gaps between maps and above them [mm of paper]
_SCALE, _BESIDE, _NUMBERS = 3.0, 3.0, 13.0  # widths of the colour bar, of the gap before it and of its numbers [mm]
_PLACES = 240  # places along the path of contact
_N_PER_MM = 1e-3


def draw_contact_pattern(title: str, pair: GearPairGeometry, contact: ToothContact, mesh: LoadedMesh) -> Figure:
    """Draw a tooth pair's line load and contact pressure over the driver's roll angle and the face.

    Parameters
    ----------
    title : str
        Title of the sheet.
    pair : GearPairGeometry
    contact : ToothContact
        Contact with faces.
    mesh : LoadedMesh
        Statics under a load, over one mesh period.

    Raises
    ------
    ValueError
        For a contact whose faces are loaded evenly.
    """
    faces = contact.faces
    if faces is None or mesh.line_loads is None:
        raise ValueError(f"{pair.label}: the load is the same all over the face, which is no map")
    reach = float(np.abs(faces.shift).max())
    places = np.linspace(contact.contact_range[0] + reach, contact.contact_range[1] - reach, _PLACES)
    present = contact.pairs(mesh.phases).present
    pressure = mesh_pressure(pair, contact, mesh)
    loads, pressures = (
        over_flank(values, mesh.positions, present, faces.shift, places) for values in (mesh.line_loads, pressure)
    )
    carried = np.where(present[..., None], mesh.line_loads, 0.0)
    most = np.unravel_index(int(carried.argmax()), carried.shape)
    even = mesh.force / (faces.face_width * pair.contact_ratio)
    note = (
        f"peak line load of a tooth pair {_N_PER_MM * carried[most]:.4g} N/mm at z = {MILLI * faces.z[most[2]]:.3g} mm,"
        f" {carried[most] / even:.3g} times the even load of the mean number of pairs; pale lines: contact at one time"
    )
    figure = sheet(HEAD + _MAP_LETTERS + 2.0 * _MAP + _MAP_GAP + FOOT, title, note)
    rolls = np.degrees(pair.driver_roll_angle(places))
    edges = MILLI * np.concatenate([faces.z - 0.5 * faces.width, [faces.z[-1] + 0.5 * faces.width]])
    panels = []
    for bottom, values, quantity in (
        (FOOT + _MAP + _MAP_GAP, _N_PER_MM * loads, "line load of a tooth pair [N/mm]"),
        (FOOT, MEGA * pressures, "contact pressure [MPa]"),
    ):
        axes = panel(figure, bottom, _MAP, width=PANEL_WIDTH - _BESIDE - _SCALE - _NUMBERS)
        _draw_map(figure, axes, rolls, edges, values, quantity)
        # Contact lines at one time, the middle of the mesh period.
        row = int(np.abs(mesh.phases - 0.5).argmin())
        for position in mesh.positions[row][contact.pairs(mesh.phases[row : row + 1]).present[0]]:
            roll = np.degrees(pair.driver_roll_angle(position + faces.shift))
            axes.plot(roll, MILLI * faces.z, color="white", alpha=0.7, lw=0.9, zorder=3, label="_contact line")
        panels.append(axes)
    panels[0].tick_params(labelbottom=False)
    panels[1].set_xlabel("roll angle of the driver [°]")
    mark_points(panels, np.degrees(path_of_contact(pair).driver_roll_angle))
    return figure


def over_flank(
    values: FloatArray, positions: FloatArray, present: npt.NDArray[np.bool_], shift: FloatArray, places: FloatArray
) -> FloatArray:
    """Return values of slices (n, m, s) of the pairs at `positions` (n, m), by slice and place along the path, (s, p).

    Places between NaN values stay NaN; places that no slice reaches have zero.
    """
    by_slice = np.zeros((shift.size, places.size))
    at, rows = positions[present], values[present]
    order = np.argsort(at, kind="stable")
    for number, slice_shift in enumerate(shift):
        by_slice[number] = np.interp(places, at[order] + slice_shift, rows[order, number], left=0.0, right=0.0)
    return by_slice


def _draw_map(
    figure: Figure, axes: Axes, rolls: FloatArray, edges: FloatArray, values: FloatArray, quantity: str
) -> None:
    half = 0.5 * (rolls[1] - rolls[0])
    sides = np.concatenate([rolls - half, [rolls[-1] + half]])
    loaded = np.ma.masked_where(~(values > 0.0), values)
    colors = axes.pcolormesh(sides, edges, loaded, cmap=colormaps["viridis"], vmin=0.0, rasterized=True, label="_map")
    axes.grid(visible=False)
    axes.set(ylabel="z across the face [mm]", xlim=(rolls[0], rolls[-1]), ylim=(edges[0], edges[-1]))
    across, up = (float(inches) * MM_PER_INCH for inches in figure.get_size_inches())
    box = axes.get_position()
    place = (box.x1 + _BESIDE / across, box.y0, _SCALE / across, _MAP / up)
    bar = figure.colorbar(colors, cax=figure.add_axes(place))
    bar.ax.tick_params(labelsize=TICK, colors=INK)
    bar.set_label(quantity, size=LABEL, color=INK)
