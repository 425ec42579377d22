"""Pictures of planetary sets under load: front view with the forces on sun, planets and pins; sharing over a turn."""

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch

from gearwhine.coupling.description.planetary import PlacedSet
from gearwhine.coupling.load_analysis.planetary_load import CarrierTurn, PlanetaryLoad
from gearwhine.coupling.load_analysis.solved_load import SolvedLoad
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    INK,
    LABEL,
    NOTE,
    PALE,
    RED,
    SERIES,
    legend,
    name_in_legend,
    panel,
    sheet,
)
from gearwhine.numerics.arrays import FloatArray

_SIDE = 118.0  # side of the square panel [mm of paper]
_LEFT = 21.0  # its left edge [mm of paper]
_LONGEST_ARROW = 0.34  # of the largest force, as a part of the ring's or the planets' outermost radius
_HEIGHT = 56.0  # of a panel over a turn [mm of paper]
_MM = 1e3


def draw_planetary_set(title: str, placed: PlacedSet, load: PlanetaryLoad, solved: SolvedLoad) -> Figure:
    """Draw the front view of a set with the mesh forces on its planets and their forces on the pins.

    Parameters
    ----------
    title : str
    placed : PlacedSet
    load : PlanetaryLoad
    solved : SolvedLoad
    """
    note = (
        f"looking against z; blue: mesh forces on the planets, red: forces of the planets on their pins; load shares; "
        f"K_γ = {load.mesh_load_factor:.3f}"
    )
    figure = sheet(HEAD + _SIDE + FOOT, title, note)
    axes = panel(figure, FOOT, _SIDE, left=_LEFT, width=_SIDE)
    axes.set_aspect("equal")
    center = np.array(solved.machine.shaft(placed.of.carrier).axis)
    radii = {name: abs(gear.pitch_radius) for name, gear in placed.gears.items()}
    reach = max(
        *(math.hypot(*place) + max(radii[gear] for gear in placed.of.planets) for place in placed.places.values()),
        radii[placed.of.ring] if placed.of.ring is not None else 0.0,
    )
    for name in (placed.of.sun, placed.of.ring):
        if name is not None:
            _circle(axes, center, radii[name], filled=name == placed.of.sun)
    for name in placed.of.planets:
        middle = center + placed.places[placed.shafts[name]]
        axes.plot(*_MM * np.column_stack([center, middle]), color=GREY, lw=3.0, alpha=0.5, zorder=1)
        _circle(axes, middle, radii[name], filled=True)
    forces = [*_mesh_forces(placed, solved), *_pin_forces(placed, solved, center)]
    largest = max((float(np.hypot(*force)) for _, force, _ in forces), default=0.0)
    for at, force, color in forces:
        if largest > 0.0:
            _arrow(axes, at, force * (_LONGEST_ARROW * reach / largest), color)
    for planet in load.planets:
        at = center + placed.places[planet.shaft]
        # Beside the arrow of the pin's force, which begins at the axis.
        force = next((force for place, force, color in forces if color == RED and np.allclose(place, at)), np.zeros(2))
        size = float(np.hypot(*force))
        at = at if size == 0.0 else at - 0.4 * max(radii[name] for name in placed.of.planets) * force / size
        text = f"{planet.shaft}\n{100.0 * planet.load_share:.2f} %"
        box = {"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.75}
        axes.annotate(
            text, tuple(_MM * at), size=NOTE, color=INK, ha="center", va="center", zorder=6, bbox=box, parse_math=False
        )
    limit = 1.12 * _MM * reach
    axes.set_xlim(_MM * center[0] - limit, _MM * center[0] + limit)
    axes.set_ylim(_MM * center[1] - limit, _MM * center[1] + limit)
    axes.set_xlabel("x [mm]", size=LABEL)
    axes.set_ylabel("y [mm]", size=LABEL)
    scale = f"longest arrow: {largest:.4g} N"
    axes.annotate(scale, (0.99, 0.01), xycoords="axes fraction", size=NOTE, color=GREY, ha="right", va="bottom")
    return figure


def _circle(axes: Axes, center: FloatArray, radius: float, *, filled: bool) -> None:
    face = PALE if filled else "none"
    axes.add_patch(Circle(tuple(_MM * center), _MM * radius, fc=face, ec=INK, lw=0.9, zorder=2))


def _arrow(axes: Axes, at: FloatArray, arrow: FloatArray, color: str) -> None:
    ends = tuple(_MM * at), tuple(_MM * (at + arrow))
    axes.add_patch(FancyArrowPatch(*ends, arrowstyle="-|>", mutation_scale=7.0, lw=1.3, color=color, zorder=5))


def _mesh_forces(placed: PlacedSet, solved: SolvedLoad) -> list[tuple[FloatArray, FloatArray, str]]:
    """Mesh forces on the planets at their pitch points [m, N]."""
    found = []
    for mesh in placed.meshes:
        pair = solved.point.pairs[mesh.number]
        for gear, flank in ((pair.pair.driver, pair.pair.line.driver), (pair.pair.driven, pair.pair.line.driven)):
            if gear.name in placed.of.planets:
                at = np.array(solved.machine.shaft(gear.shaft).axis) + np.array(flank.arm)
                # The driver feels -e, the driven gear +e.
                found.append((at, -flank.side * pair.force * np.array(flank.push), BLUE))
    return found


def _pin_forces(placed: PlacedSet, solved: SolvedLoad, center: FloatArray) -> list[tuple[FloatArray, FloatArray, str]]:
    """Resultant forces of the planets on their pins [m, N]."""
    found = []
    for shaft, place in placed.places.items():
        total = np.sum([load.force[:2] for load in solved.point.bearings if load.mounted.rotor == shaft], axis=0)
        found.append((center + np.array(place), np.asarray(total), RED))
    return found


def draw_carrier_turn(title: str, turn: CarrierTurn) -> Figure:
    """Draw the load shares of the planets over a turn of their carrier.

    Parameters
    ----------
    title : str
    turn : CarrierTurn
    """
    figure = sheet(HEAD + _HEIGHT + FOOT, title, "static equilibrium at each angle of the carrier")
    axes = panel(figure, FOOT, _HEIGHT)
    degrees = np.append(np.degrees(turn.angles), 360.0)
    handles = list[Line2D]()
    for one in turn.sets[0]:
        shares = turn.load_shares(one.name)
        closed = np.vstack([shares, shares[:1]])
        for number, planet in enumerate(one.planets):
            color = SERIES[len(handles) % len(SERIES)]
            handles += axes.plot(
                degrees, closed[:, number], color=color, lw=1.3, marker=".", ms=3, label=name_in_legend(planet.shaft)
            )
    axes.set_xlim(0.0, 360.0)
    axes.set_xticks(np.arange(0.0, 361.0, 45.0))
    axes.set_xlabel("turn of the carrier [°]")
    axes.set_ylabel("load share")
    legend(figure, handles[:8])
    return figure
