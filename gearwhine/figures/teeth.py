"""Teeth in contact at their true shape: both outlines around the pitch point, and where the flanks touch."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from coupling.gears import (
    Gear,
    GearPairGeometry,
    gear_outline,
    meshing_rotations,
    path_of_contact,
)
from gearwhine.figures.style import BLUE, FOOT, GREY, HEAD, INK, NOTE, PANEL_WIDTH, RED, legend, panel, save, sheet
from gearwhine.output import file_stems

_HEIGHT = 92.0  # of the panel [mm]
_SEEN = 4.2  # modules above and below the pitch point
_UPWARD = math.pi / 2.0  # the driven gear stands above the driver
_TINTS = {"driver": "#dde7f2", "driven": "#f1e4dd"}
_LETTERS = "ABCDE"  # of the points of contact, as ISO 21771 names them


def draw_teeth_of_pairs(folder: Path, geometries: Sequence[GearPairGeometry]) -> list[str]:
    """Draw the teeth of each pair into a file of its own."""
    names = [f"{geometry.driver.name}-{geometry.driven.name}" for geometry in geometries]
    return [
        save(draw_teeth(geometry), folder / f"{stem}.png")
        for stem, geometry in zip(file_stems(names, "teeth-"), geometries, strict=True)
    ]


def draw_teeth(geometry: GearPairGeometry, phase: float | None = None) -> Figure:
    """Draw the teeth of a pair around its pitch point, in the transverse plane, driver below and turning clockwise.

    Parameters
    ----------
    geometry : GearPairGeometry
    phase : float or None
        Mesh phase [base pitches]; None where one pair of teeth touches at the pitch point.

    Returns
    -------
    Figure
    """
    phase = geometry.pitch_point_position if phase is None else phase
    figure = sheet(
        _HEIGHT + HEAD + FOOT,
        f"{geometry.driver.name} → {geometry.driven.name}",
        f"{geometry.driver.teeth} and {geometry.driven.teeth} teeth of module {1e3 * geometry.driver.module:.5g} mm at "
        f"{1e3 * geometry.working_centre_distance:.6g} mm, working pressure angle "
        f"{math.degrees(geometry.working_pressure_angle):.4g}°, contact ratio {geometry.contact_ratio:.4g}. "
        "Contact from A, the driver's root, to E, its tip; alone between B and D; C pitch point",
    )
    axes = panel(figure, FOOT, _HEIGHT)
    rotations = meshing_rotations(geometry, phase, centre_line_angle=_UPWARD, sense=-1)
    # The pitch point is the origin, so that the scales read from there.
    down, up = geometry.working_pitch_radii
    for role, gear, rotation, centre in (
        ("driver", geometry.driver, rotations[0], -down),
        ("driven", geometry.driven, rotations[1], up),
    ):
        outline = 1e3 * gear_outline(gear, rotation, (0.0, centre), points=60)
        axes.fill(*outline.T, facecolor=_TINTS[role], edgecolor=INK, lw=0.7, zorder=2, label=role)
        _circles(axes, gear, abs(centre), centre)
    _path(axes, geometry, phase)
    reach = 1e3 * _SEEN * geometry.driver.module
    axes.set(xlim=(-reach * PANEL_WIDTH / _HEIGHT, reach * PANEL_WIDTH / _HEIGHT), ylim=(-reach, reach))
    axes.set(xlabel="across the line of centres [mm]", ylabel="along it [mm]")
    axes.grid(visible=False)
    handles = (
        Line2D([], [], color=RED, lw=1.0, label="path of contact"),
        Line2D([], [], color=RED, marker="o", ms=3.0, lw=0.0, label="touching"),
        Line2D([], [], color=GREY, lw=0.6, ls="--", label="base circle"),
        Line2D([], [], color=BLUE, lw=0.6, ls="-.", label="pitch circle"),
    )
    legend(figure, handles)
    return figure


def _circles(axes: Axes, gear: Gear, pitch_radius: float, centre: float) -> None:
    """Draw a gear's base circle and the circle that rolls on its mate's."""
    angle = np.linspace(0.0, 2.0 * math.pi, 2001)
    for radius, colour, dashes in ((gear.base_radius, GREY, "--"), (pitch_radius, BLUE, "-.")):
        x, y = 1e3 * radius * np.cos(angle), 1e3 * (radius * np.sin(angle) + centre)
        axes.plot(x, y, color=colour, lw=0.6, ls=dashes, zorder=3)


def _path(axes: Axes, geometry: GearPairGeometry, phase: float) -> None:
    """Draw the line of action, the path of contact with its named points, and where pairs of teeth touch."""
    push = geometry.line_of_action_angle(_UPWARD, sense=-1)
    along = 1e3 * np.array([math.cos(push), math.sin(push)])
    to_pitch_point = geometry.driver.base_radius * math.tan(geometry.working_pressure_angle)
    ends = np.outer([-to_pitch_point, geometry.tangent_distance - to_pitch_point], along)
    axes.plot(*ends.T, color=GREY, lw=0.5, zorder=4, label="line of action")
    path = path_of_contact(geometry)
    places = (path.position - geometry.pitch_point_position) * geometry.base_pitch
    axes.plot(*np.outer(places[[0, -1]], along).T, color=RED, lw=1.0, zorder=5, label="path of contact")
    for number, (letter, place) in enumerate(zip(_LETTERS, places, strict=True)):
        axes.plot(*(place * along), color=RED, marker="|", ms=7.0, zorder=5)
        # By turns above and below the line, as two points may be close.
        offset = (-2.0, 6.0) if number % 2 == 0 else (-1.0, -11.0)
        axes.annotate(
            letter, tuple(place * along), xytext=offset, textcoords="offset points", size=NOTE, color=RED, zorder=6
        )
    touching = phase % 1.0 + np.arange(math.ceil(geometry.contact_ratio))
    touching = touching[touching <= geometry.contact_ratio]
    points = np.outer((touching - geometry.pitch_point_position) * geometry.base_pitch, along)
    axes.plot(*points.T, color=RED, marker="o", ms=3.0, lw=0.0, zorder=6, label="touching")
