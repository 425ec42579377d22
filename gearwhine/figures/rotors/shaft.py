"""Shaft drawing to scale, alone or above a panel that shares its axis.

The scale is the same along the shaft and across it where space allows. The outline is a section through the axis with
segments, couplings, discs and gears. Supports have symbols: a spring or a rolling bearing, on ground, seat or pedestal.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Patch, Polygon, Rectangle
from matplotlib.ticker import FuncFormatter, MaxNLocator

from gearwhine.figures.rotors.assembly import DrawnGear, RotorAssembly
from gearwhine.figures.style import (
    FOOT,
    GREY,
    HEAD,
    INK,
    PANEL_WIDTH,
    RED,
    Label,
    LabelRow,
    arrange,
    draw_row,
    legend,
    name_in_legend,
    panel,
    panel_size,
    plain,
    sheet,
    shortened,
)
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import Bearing, Coupling, Disc, ElasticMaterial, Segment

MM = 1e3  # millimetres of a metre: shafts are drawn in millimetres

_MARGIN = 5.0  # margin beside the outermost parts [mm of paper]
_LEAST, _MOST = 14.0, 66.0  # least and largest height of a rotor between its largest diameters [mm of paper]
_TICKS_APART = 12.0  # least distance of ticks [mm of paper]
_STRETCHES = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000)


@dataclass(frozen=True)
class ShaftView:
    """Position and scale of a shaft on paper.

    Attributes
    ----------
    low, high : float
        Ends of the axis along the shaft, from its left end [mm].
    per_paper : float
        Millimetres of the shaft on one of the paper, in both directions.
    stretch : int
        Exaggeration of the diameters, 1 where the picture is true to scale.
    half_height : float
        Distance from the centre line to the largest radius [mm of paper].
    """

    low: float
    high: float
    per_paper: float
    stretch: int
    half_height: float

    def paper(self, z: float) -> float:
        """Return the position on paper of a station [m], from the left of the panel [mm]."""
        return (MM * z - self.low) / self.per_paper

    def length(self, paper: float) -> float:
        """Return a length on paper [mm] in the picture's coordinates."""
        return paper * self.per_paper

    def across(self, radius: float) -> float:
        """Return a radius [m] in the picture's coordinates."""
        return MM * radius * self.stretch

    def apply(self, axes: Axes, below: float) -> None:
        """Give a panel these limits, the centre line ``below`` mm of paper above its bottom."""
        bottom = -self.length(below)
        axes.set(xlim=(self.low, self.high), ylim=(bottom, bottom + self.length(panel_size(axes)[1])))

    def show_length(self, axes: Axes, length: float) -> None:
        """Give a panel an axis along the shaft, ``length`` [m]."""
        axes.set_xticks(_ticks(MM * length, MM * length / self.per_paper))
        axes.spines["bottom"].set_bounds(0.0, MM * length)

    def show_axes(self, axes: Axes, length: float, largest: float) -> None:
        """Give a panel axes along the shaft, ``length`` [m], and of diameters up to the largest radius [m]."""
        self.show_length(axes, length)
        # Zero is the centre line and has no tick.
        half = 0.5 * self.stretch * _ticks(2.0 * MM * largest, 2.0 * self.half_height)[1:]
        axes.set_yticks([*(-half[::-1]), *half])
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{2.0 * abs(value) / self.stretch:g}"))
        axes.spines["left"].set_bounds(-self.across(largest), self.across(largest))
        low, high = axes.get_ylim()
        axes.set_ylabel("diameter [mm]")
        across, _ = axes.yaxis.label.get_position()
        axes.yaxis.set_label_coords(across, -low / (high - low))


def _ticks(largest: float, paper: float) -> FloatArray:
    """Return round numbers from zero to the largest value, legibly apart on an axis of ``paper`` millimetres."""
    locator = MaxNLocator(nbins=max(int(paper / _TICKS_APART), 1), steps=[1, 2, 5, 10])
    ticks = np.asarray(locator.tick_values(0.0, largest))
    inside = ticks[(ticks >= 0.0) & (ticks <= largest * (1.0 + 1e-9))]
    return inside if inside.size > 1 else np.array([0.0, largest])


def fitted(assembly: RotorAssembly) -> ShaftView:
    """Return the largest true scale at which an assembly fits a panel; a slender one has its diameters stretched."""
    left, right = (MM * end for end in assembly.reach)
    radius = MM * assembly.largest_radius
    per_paper = max((right - left) / (PANEL_WIDTH - 2.0 * _MARGIN), 2.0 * radius / _MOST)
    stretch = next((step for step in _STRETCHES if 2.0 * radius * step / per_paper >= _LEAST), _STRETCHES[-1])
    middle, half = 0.5 * (left + right), 0.5 * PANEL_WIDTH * per_paper
    return ShaftView(middle - half, middle + half, per_paper, stretch, radius * stretch / per_paper)


TINTS = ("#c9d5e0", "#e6d6b8", "#cfdfc9", "#dccbd9", "#d9d9d2")

_BORE, _DISC, _GEAR, _TEETH = "#f6f8f9", "#a9b8c6", "#c3b48f", "#e2d9c0"
_EDGE = 0.6  # width of outlines [points]
_HUB = 1.5  # radius of a coupling's hubs over that of the shafts beside it
_POINT = 1.1  # radius of a point mass [mm of paper]
_CENTRE_LINE_OVERHANG = 2.5  # overhang of centre and pitch lines [mm of paper]
_CHAIN = (0, (8, 2, 1.5, 2))


def materials(assembly: RotorAssembly) -> list[ElasticMaterial]:
    """Return the segments' materials, in the order in which they come."""
    return list(dict.fromkeys(part.material for part in assembly.parts if isinstance(part, Segment)))


def draw_outline(axes: Axes, assembly: RotorAssembly, view: ShaftView) -> None:
    """Draw a rotor without its supports."""
    kinds = materials(assembly)
    for part, left, right in zip(assembly.parts, assembly.rotor.joints, assembly.rotor.joints[1:], strict=False):
        if isinstance(part, Segment):
            _segment(axes, view, part, float(left), float(right), TINTS[kinds.index(part.material) % len(TINTS)])
        else:
            _coupling(axes, assembly, view, part, float(left), float(right))
    for disc in assembly.discs:
        _disc(axes, assembly, view, disc)
    for gear in assembly.gears:
        _gear(axes, view, gear)
    ends = (
        MM * assembly.reach[0] - view.length(_CENTRE_LINE_OVERHANG),
        MM * assembly.reach[1] + view.length(_CENTRE_LINE_OVERHANG),
    )
    axes.plot(ends, (0.0, 0.0), color=INK, lw=0.5, ls=_CHAIN, zorder=4, label="centre line")


def _segment(axes: Axes, view: ShaftView, part: Segment, left: float, right: float, tint: str) -> None:
    (outer, bore), (right_outer, right_bore) = part.end_diameters
    places = MM * np.array([left, right, right, left])
    for ends, color, name, order in (
        ((outer, right_outer), tint, "segment", 2.0),
        ((bore, right_bore), _BORE, "bore", 2.2),
    ):
        if max(ends) > 0.0:
            low, high = (0.5 * view.across(end) for end in ends)
            corners = np.column_stack([places, [-low, -high, high, low]])
            axes.add_patch(Polygon(corners, facecolor=color, edgecolor=INK, lw=_EDGE, zorder=order, label=name))


def _coupling(axes: Axes, assembly: RotorAssembly, view: ShaftView, part: Coupling, left: float, right: float) -> None:
    """Draw two hubs and bellows between them."""
    radius = view.across(_HUB * min(assembly.shaft_radius(left), assembly.shaft_radius(right)))
    low, high = MM * left, MM * right
    hub = 0.2 * (high - low)
    waves = np.linspace(low + hub, high - hub, 9)
    heights = radius * np.where(np.arange(9) % 2 == 0, 0.9, 0.6)
    inside = np.concatenate([heights, -heights[::-1]])
    bellows = np.column_stack([np.concatenate([waves, waves[::-1]]), inside])
    axes.add_patch(Polygon(bellows, facecolor=_BORE, edgecolor=INK, lw=_EDGE, zorder=2.3, label="coupling"))
    for start in (low, high - hub):
        axes.add_patch(
            Rectangle((start, -radius), hub, 2.0 * radius, facecolor=_DISC, edgecolor=INK, lw=_EDGE, zorder=2.4)
        )


def _disc(axes: Axes, assembly: RotorAssembly, view: ShaftView, disc: Disc) -> None:
    ring = assembly.ring(disc)
    if ring is None:
        # A circle in the picture's coordinates is one on paper too.
        point = Circle((MM * disc.at, 0.0), view.length(_POINT), facecolor=INK, lw=0.0, zorder=5, label="point mass")
        axes.add_patch(point)
        return
    radius, width = view.across(ring[0]), MM * ring[1]
    corner = (MM * disc.at - 0.5 * width, -radius)
    axes.add_patch(
        Rectangle(corner, width, 2.0 * radius, facecolor=_DISC, edgecolor=INK, lw=_EDGE, zorder=1.8, label="disc")
    )


def _gear(axes: Axes, view: ShaftView, gear: DrawnGear) -> None:
    """Draw body, teeth, and the pitch line in chain dots (ISO 2203)."""
    left, width = MM * (gear.at - 0.5 * gear.face_width), MM * gear.face_width
    tip, root = (0.5 * view.across(size) for size in (gear.tip_diameter, gear.root_diameter))
    for radius, color, order, name in ((tip, _TEETH, 1.9, "gear"), (root, _GEAR, 1.95, "")):
        patch = Rectangle((left, -radius), width, 2.0 * radius, facecolor=color, edgecolor=INK, lw=_EDGE, zorder=order)
        patch.set_label(name)
        axes.add_patch(patch)
    beyond = view.length(0.5 * _CENTRE_LINE_OVERHANG)
    pitch = 0.5 * view.across(gear.pitch_diameter)
    for height in (-pitch, pitch):
        ends = (left - beyond, left + width + beyond)
        axes.plot(ends, (height, height), color=GREY, lw=0.6, ls=(0, (4, 1.2, 1, 1.2)), zorder=4, label="pitch line")


_SIGN = 4.0  # side of a bearing's sign [mm of paper, as all sizes here]
_SEAT, _GROUND, _MASS, _SPRING = 2.4, 1.6, 2.2, 4.0
_LINE = 0.7  # [points]


def depth(assembly: RotorAssembly, bearing: Bearing) -> float:
    """Return the depth of a bearing's symbol below the shaft's surface [mm of paper]."""
    if bearing.name in assembly.seats:
        return _SIGN + _SEAT
    return _SIGN + _GROUND + (_MASS + _SPRING if bearing.pedestal is not None else 0.0)


def draw_support(axes: Axes, assembly: RotorAssembly, view: ShaftView, bearing: Bearing) -> None:
    """Draw the sign of one bearing under (and, where it is a rolling one, over) the shaft."""
    place, radius = MM * bearing.at, view.across(assembly.shaft_radius(bearing.at))
    half, side = view.length(0.5 * _SIGN), view.length(_SIGN)
    if bearing.name in assembly.rolling:
        # The simplified sign of ISO 8826: a square with an upright cross.
        for low in (radius, -radius - side):
            axes.add_patch(
                Rectangle(
                    (place - half, low),
                    side,
                    side,
                    facecolor="white",
                    edgecolor=INK,
                    lw=_LINE,
                    zorder=3,
                    label="rolling",
                )
            )
            middle, arm = low + half, 0.6 * half
            axes.plot((place - arm, place + arm), (middle, middle), color=INK, lw=_LINE, zorder=3.1)
            axes.plot((place, place), (middle - arm, middle + arm), color=INK, lw=_LINE, zorder=3.1)
    else:
        corners = [(place, -radius), (place - half, -radius - side), (place + half, -radius - side)]
        axes.add_patch(Polygon(corners, facecolor="white", edgecolor=INK, lw=_LINE, zorder=3, label="bearing"))
    _draw_stand(axes, assembly, view, bearing, -radius - side)


def _draw_stand(axes: Axes, assembly: RotorAssembly, view: ShaftView, bearing: Bearing, top: float) -> None:
    place, wide = MM * bearing.at, view.length(1.6 * _SIGN)
    if bearing.name in assembly.seats:
        low = top - view.length(_SEAT)
        block = Rectangle((place - 0.5 * wide, low), wide, top - low, facecolor=GREY, lw=0.0, zorder=3, label="seat")
        axes.add_patch(block)
        return
    if bearing.pedestal is not None:
        low = top - view.length(_MASS)
        mass = Rectangle((place - 0.5 * wide, low), wide, top - low, facecolor="#a9b8c6", edgecolor=INK, lw=_LINE)
        mass.set(zorder=3, label="pedestal")
        axes.add_patch(mass)
        turns = np.linspace(low, low - view.length(_SPRING), 8)
        swing = view.length(0.3 * _SIGN) * np.array([0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 0.0, 0.0])
        axes.plot(place + swing, turns, color=INK, lw=_LINE, zorder=3)
        top = float(turns[-1])
    _draw_ground(axes, view, place, top, wide)


def _draw_ground(axes: Axes, view: ShaftView, place: float, top: float, wide: float) -> None:
    """Draw the ground: a line with strokes below it."""
    axes.plot((place - 0.5 * wide, place + 0.5 * wide), (top, top), color=INK, lw=1.2 * _LINE, zorder=3, label="ground")
    drop = view.length(0.8 * _GROUND)
    starts = place + np.linspace(-0.35, 0.5, 5) * wide
    # One line with gaps rather than five lines.
    across = np.column_stack([starts, starts - drop, np.full(5, np.nan)]).ravel()
    down = np.tile([top, top - drop, np.nan], 5)
    axes.plot(across, down, color=INK, lw=0.7 * _LINE, zorder=3)


_CLEARANCE = 1.5  # gap between the drawing and slanting leaders, and round the panel [mm of paper]
_SPOT, _PROBE = 0.8, 2.4  # radius of an unbalance's dot, height of a probe [mm of paper]


@dataclass(frozen=True)
class OutlinePanel:
    """A panel with a shaft in it, laid out before the sheet is made; sizes in mm of paper."""

    assembly: RotorAssembly
    view: ShaftView
    above: LabelRow
    below: LabelRow
    rise: float
    drop: float
    labelled: bool

    @property
    def height(self) -> float:
        """Height of the whole panel."""
        return self.above.height + self.rise + self.drop + self.below.height + 2.0 * _CLEARANCE

    @property
    def remarks(self) -> list[str]:
        """Remarks below the drawing."""
        remarks = []
        if self.view.stretch > 1:
            remarks.append(f"diameters {self.view.stretch} times as large as lengths")
        if any(self.assembly.ring(disc) for disc in self.assembly.discs):
            remarks.append("discs as rings of equal inertia")
        if left_out := self.above.left_out + self.below.left_out:
            remarks.append(f"{left_out} labels left out")
        return remarks

    def draw(self, figure: Figure, bottom: float) -> Axes:
        """Draw it into a sheet, its lower edge ``bottom`` mm above the sheet's."""
        axes = panel(figure, bottom, self.height)
        centre = _CLEARANCE + self.below.height + self.drop
        self.view.apply(axes, centre)
        self.view.show_axes(axes, self.assembly.rotor.length, self.assembly.largest_radius)
        axes.grid(visible=False)
        draw_outline(axes, self.assembly, self.view)
        for bearing in self.assembly.bearings:
            draw_support(axes, self.assembly, self.view, bearing)
        if self.labelled:
            _draw_marks(axes, self.assembly, self.view)
        draw_row(axes, self.above, centre + self.rise)
        draw_row(axes, self.below, centre - self.drop, above=False)
        return axes


def draw_shaft(assembly: RotorAssembly) -> Figure:
    """Draw a rotor in section through its axis, to scale, with its bearings and other parts.

    Lengths and diameters have one scale, unless the shaft is too slender: then the note in the head gives the stretch
    of the diameters.

    Parameters
    ----------
    assembly : RotorAssembly
    """
    outline = lay_out(assembly, labelled=True)
    rotor = assembly.rotor
    facts = [f"{rotor.mass:.4g} kg, {MM * rotor.length:.4g} mm", *outline.remarks]
    figure = sheet(HEAD + outline.height + FOOT, f"Rotor {rotor.name}", "; ".join(facts))
    axes = outline.draw(figure, FOOT)
    axes.set_xlabel("z from the left end [mm]")
    kinds = materials(assembly)
    if len(kinds) > 1:
        names = [
            assembly.materials.get(kind, f"E {1e-9 * kind.youngs_modulus:.4g} GPa, {kind.density:.4g} kg/m³")
            for kind in kinds
        ]
        tints = [TINTS[index % len(TINTS)] for index in range(len(kinds))]
        patches = [
            Patch(facecolor=tint, edgecolor=INK, lw=0.5, label=name_in_legend(name, 20))
            for tint, name in zip(tints, names, strict=True)
        ]
        legend(figure, patches)
    return figure


def lay_out(assembly: RotorAssembly, *, labelled: bool) -> OutlinePanel:
    """Lay out a shaft's panel: with all labels, unbalances and probes, or with the bearings and their names alone."""
    view = fitted(assembly)
    stands = [view.across(assembly.shaft_radius(b.at)) / view.per_paper + depth(assembly, b) for b in assembly.bearings]
    marks = 0.0
    if labelled:
        marks = _PROBE + 1.0 if assembly.probes else 2.0 * _SPOT if assembly.unbalances else 0.0
    return OutlinePanel(
        assembly=assembly,
        view=view,
        above=_arranged(_labels_above(assembly, view) if labelled else [], view),
        below=_arranged(_labels_below(assembly, view), view),
        rise=view.half_height + _CLEARANCE + marks,
        drop=max([view.half_height, *stands]) + _CLEARANCE,
        labelled=labelled,
    )


def _arranged(labels: Sequence[Label], view: ShaftView) -> LabelRow:
    return arrange(labels, [(label.x - view.low) / view.per_paper for label in labels], PANEL_WIDTH)


def _labels_above(assembly: RotorAssembly, view: ShaftView) -> list[Label]:
    labels = []
    for part, left in zip(assembly.parts, assembly.rotor.joints.tolist(), strict=False):
        words = ["coupling"] if isinstance(part, Coupling) else []
        if part.axial_force:
            sense = "tension" if part.axial_force > 0.0 else "compression"
            words.append(f"{sense} {1e-3 * abs(part.axial_force):.3g} kN")
        if words:
            middle = left + 0.5 * part.length
            labels.append(Label(", ".join(words), MM * middle, view.across(assembly.shaft_radius(middle))))
    for disc in assembly.discs:
        ring = assembly.ring(disc)
        labels.append(Label(f"{plain(disc.mass)} kg", MM * disc.at, view.across(ring[0]) if ring else 0.0))
    for gear in assembly.gears:
        text = gear.name if gear.teeth is None else f"{shortened(gear.name)}, {gear.teeth} teeth"
        labels.append(Label(text, MM * gear.at, 0.5 * view.across(gear.tip_diameter)))
    for unbalance in assembly.unbalances:
        # 1 kg·m is a million gram-millimetres.
        text = f"{plain(1e6 * unbalance.moment)} g·mm at {math.degrees(unbalance.phase):.4g}°"
        spot = view.across(assembly.outer_radius(unbalance.at)) + view.length(2.0 * _SPOT)
        labels.append(Label(text, MM * unbalance.at, spot, RED))
    for probe in assembly.probes:
        top = view.across(assembly.outer_radius(probe.at)) + view.length(_PROBE + 0.5)
        labels.append(Label(f"{probe.name}, {math.degrees(probe.angle):.4g}°", MM * probe.at, top))
    return labels


def _labels_below(assembly: RotorAssembly, view: ShaftView) -> list[Label]:
    return [
        Label(
            bearing.name,
            MM * bearing.at,
            -view.across(assembly.shaft_radius(bearing.at)) - view.length(depth(assembly, bearing)),
        )
        for bearing in assembly.bearings
    ]


def _draw_marks(axes: Axes, assembly: RotorAssembly, view: ShaftView) -> None:
    """Draw unbalances as dots on the surface, probes as points towards it."""
    for unbalance in assembly.unbalances:
        middle = view.across(assembly.outer_radius(unbalance.at)) + view.length(_SPOT)
        dot = Circle((MM * unbalance.at, middle), view.length(_SPOT), color=RED, lw=0.0, zorder=5, label="unbalance")
        axes.add_patch(dot)
    for probe in assembly.probes:
        place, low = MM * probe.at, view.across(assembly.outer_radius(probe.at)) + view.length(0.5)
        half, high = view.length(0.3 * _PROBE), low + view.length(_PROBE)
        corners = [(place, low), (place - half, high), (place + half, high)]
        axes.add_patch(Polygon(corners, facecolor=INK, lw=0.0, zorder=5, label="probe"))
