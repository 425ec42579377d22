"""Components and relations of a REXS model as they are made, and notes of what it does not hold."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from gearwhine.case.fields import Table
from gearwhine.exchange.rexs.gear_unit import readable
from gearwhine.exchange.rexs.model import Attribute, Component, LoadCase, Relation
from gearwhine.exchange.rexs.notes import Notes
from gearwhine.exchange.rexs.units import WRITTEN, in_unit

Attributes = Mapping[str, Attribute]


def quantity(number: float, measure: str, unit: str = "") -> Attribute:
    """Return an amount in SI as an attribute in a unit of the schema, by default that of most of its measure."""
    unit = unit or WRITTEN[measure]
    return Attribute(in_unit(number, unit), unit)


def quantities(values: Mapping[str, float | None], measure: str, unit: str = "") -> dict[str, Attribute]:
    """Return amounts of one measure by their attributes, without those that are None."""
    return {name: quantity(value, measure, unit) for name, value in values.items() if value is not None}


def plain(value: Any) -> Attribute:
    """Return a text, a flag, a whole number or a list of plain numbers as an attribute."""
    return Attribute(value, "none")


def vector(values: Iterable[float]) -> Attribute:
    """Return a place [m] as an attribute."""
    return Attribute(tuple(in_unit(value, "mm") for value in values), "mm")


@dataclass
class Sheet:
    """What has been made of a model.

    Attributes
    ----------
    components, relations : list
    notes : Notes
    changed : dict of int to dict
        Attributes that components have in the load case, by number.
    """

    components: list[Component] = field(default_factory=list)
    relations: list[Relation] = field(default_factory=list)
    notes: Notes = field(default_factory=Notes)
    changed: dict[int, dict[str, Attribute]] = field(default_factory=dict)

    def add(self, kind: str, name: str = "", attributes: Attributes | None = None) -> int:
        """Add a component; return its number."""
        number = len(self.components) + 1
        self.components.append(Component(number, kind, readable(name), dict(attributes or {})))
        return number

    def part(self, of: int, kind: str, name: str = "", attributes: Attributes | None = None) -> int:
        """Add a component that is a part of another one; return its number."""
        number = self.add(kind, name, attributes)
        self.relate("assembly", assembly=of, part=number)
        return number

    def relate(self, kind: str, **roles: int) -> None:
        """Add a relation of components by their roles."""
        self.relate_in_order(kind, 0, **roles)

    def relate_in_order(self, kind: str, order: int, **roles: int) -> None:
        """Add a relation with its place, from 1, among those of its kind and assembly; 0 for none."""
        self.relations.append(Relation(len(self.relations) + 1, kind, tuple(roles.items()), order))

    def in_load_case(self, number: int, attributes: Attributes) -> None:
        """Give a component attributes in the load case."""
        self.changed.setdefault(number, {}).update(attributes)

    @property
    def load_cases(self) -> list[LoadCase]:
        """The load case, where any component has attributes in it."""
        kinds = {one.number: one for one in self.components}
        changed = tuple(
            Component(number, kinds[number].kind, kinds[number].name, attributes)
            for number, attributes in self.changed.items()
        )
        return [LoadCase(1, changed)] if changed else []

    def left_out(self, about: str, table: Table, held: Iterable[str], prefix: str = "") -> None:
        """Note the keys of a table that differ from their default and are not held.

        Parameters
        ----------
        about : str
            Entry that the table is of, such as ``gear "pinion"``.
        table : Table
        held : iterable of str
            Keys that the model holds, or that are noted otherwise.
        prefix : str
            Key of the table in its entry, with a dot.
        """
        known = set(held)
        for name, info in type(table).model_fields.items():
            if name not in known and getattr(table, name) != info.get_default(call_default_factory=True):
                self.notes.left_out(about, f"{prefix}{info.alias or name}")
