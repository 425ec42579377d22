"""Shaft outline in section through its axis: segments, couplings, discs, gears."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon, Rectangle

from gearwhine.figures.assembly import DrawnGear, RotorAssembly
from gearwhine.figures.shaft_view import MM, ShaftView
from gearwhine.figures.style import GREY, INK
from rotors import Coupling, Disc, Segment, ShaftMaterial

TINTS = ("#c9d5e0", "#e6d6b8", "#cfdfc9", "#dccbd9", "#d9d9d2")

_BORE, _DISC, _GEAR, _TEETH = "#f6f8f9", "#a9b8c6", "#c3b48f", "#e2d9c0"
_EDGE = 0.6  # of outlines [points]
_HUB = 1.5  # hubs of a coupling over the shafts beside it
_POINT = 1.1  # radius of a point mass [mm of paper]
_BEYOND = 2.5  # centre and pitch lines reach so far beyond what they belong to [mm of paper]
_CHAIN = (0, (8, 2, 1.5, 2))


def materials(assembly: RotorAssembly) -> list[ShaftMaterial]:
    """The segments' materials, in the order in which they come."""
    return list(dict.fromkeys(part.material for part in assembly.parts if isinstance(part, Segment)))


def draw_outline(axes: Axes, assembly: RotorAssembly, view: ShaftView) -> None:
    """Draw a rotor without what holds it."""
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
    ends = MM * assembly.reach[0] - view.length(_BEYOND), MM * assembly.reach[1] + view.length(_BEYOND)
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
    """Two hubs and bellows between them."""
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
    """Body, teeth, and the pitch line in chain dots, as drawing practice has it (ISO 2203)."""
    left, width = MM * (gear.at - 0.5 * gear.face_width), MM * gear.face_width
    tip, root = (0.5 * view.across(size) for size in (gear.tip_diameter, gear.root_diameter))
    for radius, color, order, name in ((tip, _TEETH, 1.9, "gear"), (root, _GEAR, 1.95, "")):
        patch = Rectangle((left, -radius), width, 2.0 * radius, facecolor=color, edgecolor=INK, lw=_EDGE, zorder=order)
        patch.set_label(name)
        axes.add_patch(patch)
    beyond = view.length(0.5 * _BEYOND)
    pitch = 0.5 * view.across(gear.pitch_diameter)
    for height in (-pitch, pitch):
        ends = (left - beyond, left + width + beyond)
        axes.plot(ends, (height, height), color=GREY, lw=0.6, ls=(0, (4, 1.2, 1, 1.2)), zorder=4, label="pitch line")
