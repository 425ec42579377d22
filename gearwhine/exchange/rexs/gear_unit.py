"""A gear unit of a REXS file as its mapping sees it: model, places in the machine's frame, names and notes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from gearwhine.exchange.rexs.model import Component, RexsModel
from gearwhine.exchange.rexs.notes import Notes
from gearwhine.exchange.rexs.placement import Placement, Placements, along

_LONGEST_NAME = 80
BEARINGS = ("concept_bearing", "rolling_bearing_with_catalog_geometry", "rolling_bearing_with_detailed_geometry")
COUPLINGS = ("coupling", "switchable_coupling")


@dataclass
class Names:
    """Names of a case's entries, each unlike the others: that of the component, else its type and number."""

    _taken: set[str] = field(default_factory=set)
    _given: dict[int, str] = field(default_factory=dict)

    def of(self, component: Component) -> str:
        """Return the name of a component's entry, always the same."""
        if component.number not in self._given:
            name = readable(component.name)
            if name in ("", "ground", "housing"):
                name = f"{component.kind} {component.number}"
            if name in self._taken:
                name = f"{name} ({component.number})"
            while name in self._taken:
                name += "*"
            self._given[component.number] = name
            self._taken.add(name)
        return self._given[component.number]


def readable(text: str) -> str:
    """Return a text without slashes and characters that nobody sees, as names of a case have it."""
    letters = ("-" if letter in "/\\" else letter if letter.isprintable() else " " for letter in text)
    return " ".join("".join(letters).split())[:_LONGEST_NAME].strip()


@dataclass(frozen=True)
class Connection:
    """A component between two sides: a bearing or a coupling.

    Attributes
    ----------
    component : Component
    inner, outer : Component or None
        Components of its two sides.
    """

    component: Component
    inner: Component | None
    outer: Component | None

    @property
    def sides(self) -> tuple[Component | None, Component | None]:
        """Both sides, the inner one first."""
        return self.inner, self.outer

    def station(self, side: Component) -> float | None:
        """Return the coordinate on a shaft that is one of its sides [m]; None where it has none."""
        first = self.inner is not None and side.number == self.inner.number
        sides = ("inner_side", "side_1") if first else ("outer_side", "side_2")
        return self.component.number_of([f"u_coordinate_on_shaft_{name}" for name in sides], "m")


@dataclass
class GearUnit:
    """What the mapping of each part needs.

    Attributes
    ----------
    model : RexsModel
        Components with the attributes of the chosen load case.
    places : Placements
    names : Names
    notes : Notes
    moved : dict of int to tuple
        Origins of shafts whose places the file does not have, found from their gears [m].
    """

    model: RexsModel
    places: Placements
    names: Names = field(default_factory=Names)
    notes: Notes = field(default_factory=Notes)
    moved: dict[int, tuple[float, float, float]] = field(default_factory=dict)

    def component(self, number: int | None) -> Component | None:
        """Return a component by its number."""
        return None if number is None else self.model.components.get(number)

    def placement(self, component: Component) -> Placement:
        """Return the place of a component in the machine's frame."""
        placed = self.places.of(component)
        if component.number not in self.moved:
            return placed
        import numpy as np

        return Placement(np.array(self.moved[component.number]), placed.axes)

    def height(self, shaft: Component, coordinate: float) -> float:
        """Return z of a coordinate on a shaft [m]."""
        placed = self.placement(shaft)
        return float(placed.origin[2]) + along(placed) * coordinate

    def connections(self, kinds: Sequence[str]) -> list[Connection]:
        """Return the components of some types with their two sides."""
        found = []
        for relation in self.model.of_relation("side"):
            between = self.component(relation.role("assembly"))
            if between is not None and between.kind in kinds:
                sides = (self.component(relation.role(role)) for role in ("inner_part", "outer_part"))
                found.append(Connection(between, *sides))
        return found

    def is_engaged(self, coupling: Component) -> bool:
        """Whether a coupling connects its sides, in the gear that is engaged."""
        if coupling.kind != "switchable_coupling":
            return True
        unit = next(self.model.of_kind("gear_unit"), None)
        index = 1 if unit is None else unit.whole("gear_shift_index") or 1
        engaged = coupling.flag("is_engaged", max(index - 1, 0))
        return engaged is not False

    def material_of(self, component: Component) -> Component | None:
        """Return the material that a component refers to."""
        return next(iter(self.model.referenced(component.number, "material")), None)
