"""Shaft drawing to scale, alone or above a panel that shares its axis."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Patch, Polygon

from gearwhine.figures.assembly import RotorAssembly
from gearwhine.figures.labels import Label, LabelRow, arrange, draw_row
from gearwhine.figures.shaft_outline import TINTS, draw_outline, materials
from gearwhine.figures.shaft_view import MM, ShaftView, fitted
from gearwhine.figures.style import FOOT, HEAD, INK, PANEL_WIDTH, RED, legend, name_in_legend, panel, sheet, shortened
from gearwhine.figures.support_signs import depth, draw_support
from rotors import Coupling

_CLEAR = 1.5  # between what is drawn and leaders that slant, and round the panel [mm of paper]
_SPOT, _PROBE = 0.8, 2.4  # radius of an unbalance's dot, height of a probe [mm of paper]


@dataclass(frozen=True)
class OutlinePanel:
    """A panel with a shaft in it, laid out before the sheet is made: sizes in mm of paper."""

    assembly: RotorAssembly
    view: ShaftView
    above: LabelRow
    below: LabelRow
    rise: float
    drop: float
    labelled: bool

    @property
    def height(self) -> float:
        """Of the whole panel."""
        return self.above.height + self.rise + self.drop + self.below.height + 2.0 * _CLEAR

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
        centre = _CLEAR + self.below.height + self.drop
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
    """Draw a rotor in section through its axis, to scale, with its bearings and what else belongs to it.

    Lengths and diameters have one scale, unless the shaft is so slender that its diameters could not be seen: the
    note in the head then says by how much they are stretched.

    Parameters
    ----------
    assembly
        The rotor and what goes with it.
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
        rise=view.half_height + _CLEAR + marks,
        drop=max([view.half_height, *stands]) + _CLEAR,
        labelled=labelled,
    )


def _arranged(labels: Sequence[Label], view: ShaftView) -> LabelRow:
    return arrange(labels, [(label.x - view.low) / view.per_paper for label in labels], PANEL_WIDTH)


def _labels_above(assembly: RotorAssembly, view: ShaftView) -> list[Label]:
    labels = []
    for part, left in zip(assembly.parts, assembly.rotor.joints.tolist(), strict=False):
        if isinstance(part, Coupling):
            middle = left + 0.5 * part.length
            labels.append(Label("coupling", MM * middle, view.across(assembly.shaft_radius(middle))))
        elif part.axial_force:
            middle, sense = left + 0.5 * part.length, "tension" if part.axial_force > 0.0 else "compression"
            text = f"{sense} {1e-3 * abs(part.axial_force):.3g} kN"
            labels.append(Label(text, MM * middle, view.across(assembly.shaft_radius(middle))))
    for disc in assembly.discs:
        ring = assembly.ring(disc)
        labels.append(Label(f"{disc.mass:.3g} kg", MM * disc.at, view.across(ring[0]) if ring else 0.0))
    for gear in assembly.gears:
        text = gear.name if gear.teeth is None else f"{shortened(gear.name)}, {gear.teeth} teeth"
        labels.append(Label(text, MM * gear.at, 0.5 * view.across(gear.tip_diameter)))
    for unbalance in assembly.unbalances:
        # 1 kg·m is a million gram-millimetres.
        text = f"{1e6 * unbalance.moment:.3g} g·mm at {math.degrees(unbalance.phase):.4g}°"
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
    """Unbalances as dots on the surface, probes as points towards it."""
    for unbalance in assembly.unbalances:
        middle = view.across(assembly.outer_radius(unbalance.at)) + view.length(_SPOT)
        dot = Circle((MM * unbalance.at, middle), view.length(_SPOT), color=RED, lw=0.0, zorder=5, label="unbalance")
        axes.add_patch(dot)
    for probe in assembly.probes:
        place, low = MM * probe.at, view.across(assembly.outer_radius(probe.at)) + view.length(0.5)
        half, high = view.length(0.3 * _PROBE), low + view.length(_PROBE)
        corners = [(place, low), (place - half, high), (place + half, high)]
        axes.add_patch(Polygon(corners, facecolor=INK, lw=0.0, zorder=5, label="probe"))
