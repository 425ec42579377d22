"""Operating point figures: deflected shafts with their forces, load over the gear faces, causes of misalignment."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch, Patch, Polygon

from gearwhine.coupling.load_analysis.solved_load import DeflectedShaft, SolvedLoad
from gearwhine.coupling.statics.operating_point import CAUSES, PairLoad
from gearwhine.figures.gears.contact import draw_contact_pattern
from gearwhine.figures.machine.planetary_sets import draw_carrier_turn, draw_planetary_set
from gearwhine.figures.rotors import shaft_assembly
from gearwhine.figures.rotors.assembly import RotorAssembly
from gearwhine.figures.rotors.shaft import MM, ShaftView
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    INK,
    LABEL,
    MEGA,
    MICRO,
    MILLI,
    NOTE,
    RED,
    SERIES,
    SHEET_WIDTH,
    Label,
    arrange,
    draw_row,
    legend,
    name_in_legend,
    name_lowest,
    panel,
    panel_size,
    sheet,
    shortened,
    stacked,
)
from gearwhine.numerics.arrays import FloatArray
from gearwhine.output import file_stems
from gearwhine.rotors import Segment

_TALLEST, _SLIMMEST = 34.0, 7.0  # largest and least height of a shaft with its gears [mm of paper]
_BESIDE, _BETWEEN = 6.0, 6.0  # margins and gap between the two planes [mm of paper]
_LARGEST, _ARROW, _WORDS = 5.0, 13.0, 5.0  # largest deflection, longest arrow and height of its number [mm of paper]
_STEPS = (1, 2, 5)
_ROW, _GLYPH, _ARC = 12.0, 2.5, 1.5  # row of thrusts or moments, its middle from its top, radius [mm of paper]
_LEAST_DRAWN_FORCE = 1e-3  # part of the largest force below which none is drawn
_LEAST_MOMENT = 0.02  # part of the largest moment below which none is drawn
_BODY, _SHAFT = "#d9cfb4", "#c9d5e0"
_N_PER_MM = 1e-3


@dataclass(frozen=True)
class DrawnForce:
    """A force on a shaft.

    Attributes
    ----------
    at : float
        Place from the left end [m].
    force : tuple of float
        Force along x and y [N].
    of_gear : bool
        Whether a gear exerts it, rather than a bearing.
    thrust : float
        Force along z [N].
    moment : tuple of float
        Moment about x and y [N m].
    """

    at: float
    force: tuple[float, float]
    of_gear: bool
    thrust: float = 0.0
    moment: tuple[float, float] = (0.0, 0.0)

    def turning(self, plane: int) -> float:
        """Moment in the x-z (0) or y-z plane (1) [N m], positive from z towards the other axis: M_y or -M_x."""
        return self.moment[1] if plane == 0 else -self.moment[0]

    @property
    def color(self) -> str:
        """Colour of its arrows."""
        return RED if self.of_gear else INK


def draw_deflected_shaft(
    title: str, assembly: RotorAssembly, shaft: DeflectedShaft, forces: Sequence[DrawnForce]
) -> Figure:
    """Draw a shaft to scale in both planes, its deflection exaggerated, with the forces on it as arrows.

    Rows below have the thrusts, and the moments in the plane.

    Parameters
    ----------
    title : str
    assembly : RotorAssembly
        The shaft with its gears.
    shaft : DeflectedShaft
    forces : sequence of DrawnForce
        Forces of bearings and gears.
    """
    width = 0.5 * (SHEET_WIDTH - 2.0 * _BESIDE - _BETWEEN)
    view = _view(assembly, width)
    across, _ = shaft.largest
    factor = _exaggeration(across, view)
    strongest = max((abs(part) for force in forces for part in (*force.force, force.thrust)), default=0.0) or 1.0
    below, above = _extent(assembly, view, shaft, forces, factor, strongest)
    thrusts = [force for force in forces if abs(force.thrust) >= _LEAST_DRAWN_FORCE * strongest]
    largest = max((abs(part) for force in forces for part in force.moment), default=0.0)
    turned = [[force for force in forces if abs(force.turning(plane)) > _LEAST_MOMENT * largest] for plane in range(2)]
    # Moments of a thousandth of a millimetre of arm are rounding of the picture.
    turned = turned if largest > 1e-6 * strongest else [[], []]
    rows = bool(thrusts) + any(turned)
    lowest, below = below, below + rows * _ROW
    height = below + above
    note = f"deflections {factor:g} times as large as lengths, {MICRO * across:.3g} µm at most"
    note = note if across else "no deflection across the axis"
    rows_shown = " and ".join(["thrusts"] * bool(thrusts) + ["moments"] * any(turned))
    note += "; arrows: forces on the shaft" + (f", below them {rows_shown}" if rows_shown else "")
    if view.stretch > 1:
        note += f"; diameters {view.stretch} times as large as lengths"
    figure = sheet(HEAD + 4.0 + height + FOOT, title, note)
    for plane, name in enumerate("xy"):
        axes = panel(figure, FOOT, height, left=_BESIDE + plane * (width + _BETWEEN), width=width)
        axes.grid(visible=False)
        axes.spines["left"].set_visible(False)
        axes.set_yticks([])
        view.apply(axes, below)
        view.show_length(axes, assembly.rotor.length)
        axes.set_xlabel("z from the left end [mm]")
        axes.set_title(f"{name}–z plane, {name} upwards", size=LABEL, color=INK, pad=2.0)
        moved = MM * factor * shaft.motion[plane]
        _draw_bodies(axes, assembly, view, shaft.at, np.zeros(shaft.at.size), at_rest=True)
        _draw_bodies(axes, assembly, view, shaft.at, moved, at_rest=False)
        axes.plot(MM * shaft.at, moved, color=BLUE, lw=1.3, zorder=5, label="deflection")
        for force in forces:
            _draw_force(axes, assembly, view, force, plane, strongest, float(np.interp(force.at, shaft.at, moved)))
        level = below - lowest - _GLYPH
        if thrusts:
            _draw_thrusts(axes, view, thrusts, level, below, strongest)
        if turned[plane]:
            _draw_moments(axes, view, turned[plane], plane, level - _ROW * bool(thrusts), below)
    handles = [
        Line2D([], [], color=GREY, lw=0.8, ls="--", label="without load"),
        Line2D([], [], color=BLUE, lw=1.3, label="centre line"),
        Line2D([], [], color=INK, lw=1.2, label="by bearings"),
        Line2D([], [], color=RED, lw=1.2, label="by gears"),
    ]
    legend(figure, handles)
    return figure


def _view(assembly: RotorAssembly, width: float) -> ShaftView:
    left, right = (MM * end for end in assembly.reach)
    radius = MM * assembly.largest_radius
    per_paper = max((right - left) / (width - 6.0), 2.0 * radius / _TALLEST)
    stretch = next((step for step in (1, 2, 5, 10, 20, 50) if 2.0 * radius * step / per_paper >= _SLIMMEST), 50)
    middle, half = 0.5 * (left + right), 0.5 * width * per_paper
    return ShaftView(middle - half, middle + half, per_paper, stretch, radius * stretch / per_paper)


def _extent(
    assembly: RotorAssembly,
    view: ShaftView,
    shaft: DeflectedShaft,
    forces: Sequence[DrawnForce],
    factor: float,
    strongest: float,
) -> tuple[float, float]:
    """Return the height below and above the axis that shaft and arrows take in either plane [mm of paper]."""
    moved = MM * factor * shaft.motion[:2] / view.per_paper
    room = [view.half_height + max(0.0, float((sense * moved).max())) for sense in (-1.0, 1.0)]
    for force in forces:
        for value, shift in zip(force.force, moved, strict=True):
            if abs(value) < _LEAST_DRAWN_FORCE * strongest:
                continue
            side, sense = (0, -1.0) if value > 0.0 else (1, 1.0)
            surface = view.across(_surface(assembly, force)) / view.per_paper
            arrow = _arrow_length(value, strongest) + _WORDS
            room[side] = max(room[side], surface + arrow + sense * float(np.interp(force.at, shaft.at, shift)))
    return room[0] + 2.0, room[1] + 2.0


def _surface(assembly: RotorAssembly, force: DrawnForce) -> float:
    """Radius at which a force's arrow ends [m]."""
    return assembly.outer_radius(force.at) if force.of_gear else assembly.shaft_radius(force.at)


def _arrow_length(value: float, strongest: float) -> float:
    return max(_ARROW * abs(value) / strongest, 2.5)


def _exaggeration(largest: float, view: ShaftView) -> float:
    """Return a round factor at which the largest deflection [m] has about `_LARGEST` on paper; 1 without one."""
    if largest == 0.0:
        return 1.0
    factor = _LARGEST * view.per_paper / (MM * largest)
    power = 10.0 ** np.floor(np.log10(factor))
    return float(max(step * power for step in _STEPS if step * power <= factor * (1.0 + 1e-9)))


def _draw_bodies(
    axes: Axes, assembly: RotorAssembly, view: ShaftView, at: FloatArray, moved: FloatArray, *, at_rest: bool
) -> None:
    """Draw the outlines of segments, discs and gears, every section shifted by the deflection there."""
    bodies = []
    for part, left, right in zip(assembly.parts, assembly.rotor.joints, assembly.rotor.joints[1:], strict=False):
        if isinstance(part, Segment):
            (outer, _), (right_outer, _) = part.end_diameters
            bodies.append((float(left), float(right), 0.5 * outer, 0.5 * right_outer, _SHAFT))
    for disc in assembly.discs:
        if (ring := assembly.ring(disc)) is not None:
            bodies.append((disc.at - 0.5 * ring[1], disc.at + 0.5 * ring[1], ring[0], ring[0], _BODY))
    for gear in assembly.gears:
        radius, half = 0.5 * gear.tip_diameter, 0.5 * gear.face_width
        bodies.append((gear.at - half, gear.at + half, radius, radius, _BODY))
    for left, right, first, last, color in bodies:
        places = np.unique(np.concatenate([[left, right], at[(at > left) & (at < right)]]))
        shift = np.interp(places, at, moved)
        edge = view.stretch * MM * np.interp(places, [left, right], [first, last])
        corners = np.column_stack(
            [MM * np.concatenate([places, places[::-1]]), np.concatenate([shift + edge, (shift - edge)[::-1]])]
        )
        look = (
            {"facecolor": "none", "edgecolor": GREY, "lw": 0.5, "ls": "--", "zorder": 4}
            if at_rest
            else {"facecolor": color, "edgecolor": INK, "lw": 0.5, "zorder": 2}
        )
        axes.add_patch(Polygon(corners, closed=True, label="at rest" if at_rest else "loaded", **look))


def _draw_force(
    axes: Axes,
    assembly: RotorAssembly,
    view: ShaftView,
    force: DrawnForce,
    plane: int,
    strongest: float,
    moved: float,
) -> None:
    """Draw a force's component in a plane as an arrow that pushes the surface, with its number at the tail."""
    value = force.force[plane]
    if abs(value) < _LEAST_DRAWN_FORCE * strongest:
        return
    sense = 1.0 if value > 0.0 else -1.0
    tip = moved - sense * view.across(_surface(assembly, force))
    tail = tip - sense * view.length(_arrow_length(value, strongest))
    color = force.color
    arrow = {"arrowstyle": "-|>,head_width=0.16,head_length=0.4", "color": color, "lw": 1.2, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (MM * force.at, tip), (MM * force.at, tail), arrowprops=arrow, zorder=6)
    axes.annotate(
        f"{abs(value):.4g} N",
        (MM * force.at, tail),
        (0.0, -2.0 * sense),
        textcoords="offset points",
        fontsize=NOTE,
        color=color,
        ha="center",
        va="top" if sense > 0.0 else "bottom",
        zorder=7,
        # A disc beside the bearing may stand behind its number.
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.3},
    )


def _draw_thrusts(
    axes: Axes, view: ShaftView, thrusts: Sequence[DrawnForce], level: float, below: float, strongest: float
) -> None:
    """Draw thrusts as arrows along the shaft in a row, ``level`` [mm of paper] from the panel's bottom."""
    y = view.length(level - below)
    for force in thrusts:
        half = 0.5 * view.length(_arrow_length(force.thrust, strongest)) * (1.0 if force.thrust > 0.0 else -1.0)
        _add_arrow(axes, (MM * force.at - half, y), (MM * force.at + half, y), force.color, "_thrust")
    _name_row(axes, view, [(force, f"{abs(force.thrust):.4g} N") for force in thrusts], y, level)


def _draw_moments(
    axes: Axes, view: ShaftView, turned: Sequence[DrawnForce], plane: int, level: float, below: float
) -> None:
    """Draw moments in a plane as arcs with an arrow in their sense in a row, as thrusts."""
    y, radius = view.length(level - below), view.length(_ARC)
    for force in turned:
        sense = 1.0 if force.turning(plane) > 0.0 else -1.0
        angles = np.radians(np.linspace(-40.0, 200.0, 40))
        across, up = MM * force.at + sense * radius * np.cos(angles), y + radius * np.sin(angles)
        axes.plot(across[:-4], up[:-4], color=force.color, lw=1.1, zorder=6, label="_arc", solid_capstyle="butt")
        _add_arrow(axes, (across[-6], up[-6]), (across[-1], up[-1]), force.color, "_moment")
    _name_row(axes, view, [(force, f"{abs(force.turning(plane)):.3g} N·m") for force in turned], y, level)


def _add_arrow(axes: Axes, tail: tuple[float, float], tip: tuple[float, float], color: str, label: str) -> None:
    arrow = FancyArrowPatch(
        tail,
        tip,
        arrowstyle="-|>,head_width=1.5,head_length=2.8",
        mutation_scale=1.0,
        shrinkA=0.0,
        shrinkB=0.0,
        color=color,
        lw=1.1,
        zorder=6,
        label=label,
    )
    axes.add_patch(arrow)


def _name_row(axes: Axes, view: ShaftView, named: Sequence[tuple[DrawnForce, str]], y: float, level: float) -> None:
    """Write the numbers of a row below its arrows."""
    labels = [Label(text, MM * force.at, y - view.length(_ARC), force.color) for force, text in named]
    row = arrange(labels, [view.paper(force.at) for force, _ in named], panel_size(axes)[0])
    draw_row(axes, row, level - _ARC, above=False)


_GAP_PANEL, _LOAD_PANEL, _ROOM = 34.0, 46.0, 4.0  # heights [mm of paper]


def draw_face_load(title: str, pair: PairLoad) -> Figure:
    """Draw the gap of the flanks before the load, and the line load of all tooth pairs together, over the face.

    Parameters
    ----------
    title : str
    pair : PairLoad
        Pair under a force.
    """
    width = pair.pair.geometry.face_width
    z, gap = MILLI * pair.z, pair.gap
    whole_gap = gap + pair.pair.contact.flank_gap
    load, phases = pair.line_load, pair.fine.line_load
    note = (
        f"K_Hβ = {pair.k_h_beta:.3f}; flanks {MICRO * pair.misalignment * width:z.2f} µm out of line over the face, "
        f"open towards +z where positive; mean mesh force {pair.force:.4g} N"
    )
    figure = sheet(HEAD + _GAP_PANEL + _ROOM + _LOAD_PANEL + FOOT, title, note)
    upper = panel(figure, FOOT + _LOAD_PANEL + _ROOM, _GAP_PANEL)
    lower = panel(figure, FOOT, _LOAD_PANEL)
    modified = np.ptp(pair.pair.contact.flank_gap) > 0.0
    color, style = (GREY, "--") if modified else (BLUE, "-")
    upper.plot(z, MICRO * (gap - gap.min()), color=color, lw=1.3, ls=style, label="by deflection")
    if modified:
        upper.plot(z, MICRO * (whole_gap - whole_gap.min()), color=BLUE, lw=1.4, label="with modifications")
    upper.fill_between(z, 0.0, MICRO * (whole_gap - whole_gap.min()), color="#dfe7ef", lw=0.0, zorder=1)
    # Gaps of nanometres are no gaps.
    upper.set_ylim(0.0, max(1.15 * MICRO * float(max(np.ptp(whole_gap), np.ptp(gap))), 0.1))
    upper.set_ylabel("gap before the load [µm]")
    upper.tick_params(labelbottom=False)
    lower.fill_between(
        z,
        _N_PER_MM * phases.min(axis=0),
        _N_PER_MM * phases.max(axis=0),
        color="#e6ebf1",
        lw=0.0,
        zorder=1,
        label="over the mesh period",
    )
    lower.plot(z, _N_PER_MM * load, color=BLUE, lw=1.5, label="mean")
    lower.axhline(_N_PER_MM * load.mean(), color=GREY, lw=0.9, ls="--", label="even")
    lower.set_ylim(0.0, 1.12 * _N_PER_MM * float(phases.max()))
    lower.set(xlabel="z from the middle of the face [mm]", ylabel="line load, all tooth pairs [N/mm]")
    for axes in (upper, lower):
        axes.set_xlim(-0.5 * MILLI * width, 0.5 * MILLI * width)
    for axes in (upper, lower):
        axes.legend(loc="best", ncols=3, fontsize=NOTE, framealpha=0.85, edgecolor="none", handlelength=1.8)
    return figure


_NARROWEST = 1.0  # least range on either side of zero [µrad]
_LEAST_DRAWN_MISALIGNMENT = 1e-8  # misalignment by each cause up to which there is nothing to draw [rad]
_BAR = 11.0  # height of a pair's row [mm of paper]
_NAMES, _SUMS = 26.0, 30.0  # widths of the pairs' names and of their sums [mm of paper]


def draw_misalignment(title: str, pairs: Sequence[PairLoad]) -> Figure:
    """Draw the misalignment of every gear pair as a stack of bars by cause, and their sum.

    Parameters
    ----------
    title : str
    pairs : sequence of PairLoad
    """
    height = _BAR * len(pairs) + 4.0
    note = "positive where the flanks open towards +z"
    figure = sheet(HEAD + height + FOOT, title, note)
    axes = panel(figure, FOOT, height, left=_NAMES, width=SHEET_WIDTH - _NAMES - _SUMS)
    axes.grid(visible=False, axis="y")
    axes.use_sticky_edges = False  # a bar of no length would end the axis at the longest one
    handles: list[Artist] = []
    for number, cause in enumerate(CAUSES):
        color = SERIES[number]
        for row, pair in enumerate(pairs):
            part = MICRO * pair.misalignment_by_cause[cause]
            before = [MICRO * pair.misalignment_by_cause[other_cause] for other_cause in CAUSES[:number]]
            start = sum(value for value in before if (value > 0.0) == (part > 0.0))
            axes.barh(-row, part, left=start, height=0.5, color=color, lw=0.0, zorder=3, label=f"_{cause}")
        if any(pair.misalignment_by_cause[cause] for pair in pairs):  # rigid seats give none
            handles.append(Patch(color=color, label=cause))
    for row, pair in enumerate(pairs):
        whole = MICRO * pair.misalignment
        axes.plot([whole, whole], [-row - 0.34, -row + 0.34], color=INK, lw=1.8, zorder=5, label="_sum")
        over = f"{whole * pair.pair.geometry.face_width:z.2f} µm over the face"
        axes.annotate(over, (1.01, -row), xycoords=("axes fraction", "data"), size=NOTE, color=INK, va="center")
    handles.append(Line2D([], [], color=INK, lw=1.8, label="sum"))
    axes.axvline(0.0, color=GREY, lw=0.7, zorder=2)
    names = [f"{shortened(pair.pair.driver.name, 14)}\n→ {shortened(pair.pair.driven.name, 14)}" for pair in pairs]
    axes.set_yticks([-row for row in range(len(pairs))], names)
    for text in axes.get_yticklabels():
        text.set_parse_math(False)
    axes.set_ylim(-len(pairs) + 0.4, 0.6)
    # Angles of nanoradians are rounding of the case, and look like it.
    low, high = axes.get_xlim()
    axes.set_xlim(min(low, -_NARROWEST), max(high, _NARROWEST))
    axes.set_xlabel("misalignment [µrad]")
    legend(figure, handles)
    return figure


_SMALL, _SMALL_ROOM = 30.0, 4.0  # height of a panel over torque and gap between two [mm of paper]


def draw_over_torque(title: str, solved: SolvedLoad) -> Figure:
    """Draw misalignment, face load factor, stiffness and transmission error of every gear pair over torque.

    Parameters
    ----------
    title : str
    solved : SolvedLoad
        Operating point with equilibria over torque.
    """
    torques = np.array(list(solved.over_torque))
    rows = list(solved.over_torque.values())
    quantities: tuple[tuple[str, Callable[[PairLoad], float]], ...] = (
        ("TE p-p [µm]", lambda pair: MICRO * float(np.ptp(pair.transmission_error))),
        ("stiffness [N/µm]", lambda pair: MEGA * pair.mean_stiffness),
        ("K_Hβ", lambda pair: pair.k_h_beta),
        ("misalignment [µrad]", lambda pair: MICRO * pair.misalignment),
    )
    note = "dashed: torque of operation"
    figure, panels = stacked(len(quantities), _SMALL, _SMALL_ROOM, title, note, first=_SMALL_ROOM)
    handles: list[Line2D] = []
    for number, ((label, value_of), axes) in enumerate(zip(quantities, reversed(panels), strict=True)):
        for place, pair in enumerate(solved.point.pairs):
            if pair.force == 0.0:
                continue
            name = f"{name_in_legend(pair.pair.driver.name)} → {name_in_legend(pair.pair.driven.name)}"
            values = [value_of(row.pairs[place]) for row in rows]
            color = SERIES[place % len(SERIES)]
            (line,) = axes.plot(torques, values, color=color, lw=1.3, marker=".", ms=3, label=name)
            handles += [line] if number == 0 else []
        axes.axvline(solved.machine.torque, color=GREY, lw=0.8, ls="--", zorder=1)
        if number in (0, 3):
            axes.axhline(0.0, color=GREY, lw=0.6, zorder=1)
        axes.set_ylabel(label)
        axes.set_xlim(*sorted((0.0, float(torques[np.abs(torques).argmax()]))))
    name_lowest(panels, "torque of the first driver [N·m]")
    legend(figure, handles[:4])
    return figure


def _drawn(at: float, force: FloatArray, *, of_gear: bool) -> DrawnForce:
    """Return a force of components along x, y, z and about x, y on a shaft."""
    x, y, z, about_x, about_y = force.tolist()
    return DrawnForce(at, (x, y), of_gear, z, (about_x, about_y))


def forces_on_shafts(solved: SolvedLoad) -> dict[str, list[DrawnForce]]:
    """Return what is drawn on each shaft: forces and moments of its bearings, of those that sit in it, of its gears.

    They are in balance but for the shaft's weight.
    """
    machine, acting = solved.machine, {shaft.name: list[DrawnForce]() for shaft in solved.shafts}
    seated, gears = dict[tuple[str, float], FloatArray](), dict[tuple[str, float], FloatArray]()
    for load in solved.point.bearings:
        acting[load.mounted.rotor].append(_drawn(load.mounted.bearing.at, -load.force, of_gear=False))
        name = machine.shaft_around(load.mounted)
        if name is not None:
            around, held = machine.shaft(name), machine.shaft(load.mounted.rotor)
            place = held.start + load.mounted.bearing.at - around.start
            at = min(max(place, 0.0), around.rotor.length)
            # A pin is beside the axis, and may be beyond the shaft's end: its force there has a moment about the axis.
            arm = np.array([*np.subtract(held.axis, around.axis), place - at])
            force = load.force + np.concatenate([np.zeros(3), np.cross(arm, load.force[:3])[:2]])
            seated[name, at] = seated.get((name, at), np.zeros(5)) + force
    for number, pair in enumerate(solved.point.pairs):
        for gear, force in zip((pair.pair.driver, pair.pair.driven), solved.point.gear_forces(number), strict=True):
            gears[gear.shaft, gear.at] = gears.get((gear.shaft, gear.at), np.zeros(5)) + force[:5]
    for together, of_gear in ((seated, False), (gears, True)):
        for (name, at), force in together.items():
            acting[name].append(_drawn(at, force, of_gear=of_gear))
    return acting


def draw_load(solved: SolvedLoad) -> Iterator[tuple[str, Figure]]:
    """Draw the operating point of a machine.

    Parameters
    ----------
    solved : SolvedLoad

    Yields
    ------
    str
        Name of the figure: ``load-shaft-NAME``, ``load-misalignment``, ``load-face-PAIR``, ``load-pattern-PAIR``,
        ``load-over-torque``, ``load-planetary-SET`` and ``load-carrier-turn-CARRIER``.
    matplotlib.figure.Figure
    """
    acting = forces_on_shafts(solved)
    stems = file_stems([shaft.name for shaft in solved.shafts], "load-shaft-")
    for stem, shaft in zip(stems, solved.shafts, strict=True):
        on_shaft = [load.mounted.bearing for load in solved.point.bearings if load.mounted.rotor == shaft.name]
        assembly = shaft_assembly(solved.machine, shaft.name, on_shaft)
        title = f"Shaft {shortened(shaft.name, 20)} under load"
        yield stem, draw_deflected_shaft(title, assembly, shaft, acting[shaft.name])
    pairs = [pair for pair in solved.point.pairs if pair.force > 0.0]
    causes = [abs(pair.misalignment_by_cause[cause]) for pair in pairs for cause in CAUSES]
    if max(causes, default=0.0) > _LEAST_DRAWN_MISALIGNMENT:
        yield "load-misalignment", draw_misalignment("Misalignment of the flanks by cause", pairs)
    names = [f"{pair.pair.driver.name}-{pair.pair.driven.name}" for pair in pairs]
    faces, patterns = file_stems(names, "load-face-"), file_stems(names, "load-pattern-")
    for face, pattern, pair in zip(faces, patterns, pairs, strict=True):
        name = f"{shortened(pair.pair.driver.name, 14)} → {shortened(pair.pair.driven.name, 14)}"
        yield face, draw_face_load(f"{name}: load over the face", pair)
        contact = pair.pair.contact.tooth_contact
        yield (
            pattern,
            draw_contact_pattern(f"{name}: contact pattern of the machine", pair.pair.geometry, contact, pair.mesh),
        )
    if solved.over_torque and solved.point.pairs:
        yield "load-over-torque", draw_over_torque("Gear pairs over torque", solved)
    sets = file_stems([one.name for one in solved.planetary], "load-planetary-")
    placed = {one.of.name: one for one in solved.machine.placed_sets}
    for stem, one in zip(sets, solved.planetary, strict=True):
        yield stem, draw_planetary_set(f"Planetary set {shortened(one.name, 20)}", placed[one.name], one, solved)
    turns = file_stems([turn.carrier for turn in solved.carrier_turns], "load-carrier-turn-")
    for stem, turn in zip(turns, solved.carrier_turns, strict=True):
        yield stem, draw_carrier_turn(f"Load shares over a turn of {shortened(turn.carrier, 20)}", turn)
