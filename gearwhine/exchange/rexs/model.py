"""Neutral model of a REXS file: components with attributes, relations between them, and load cases.

Values stand as the file has them, as text of XML or as numbers of JSON. They are read where they are asked for, as a
number in SI, a list, a flag or a text, and refused there by component and attribute.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from gearwhine.exchange.rexs.errors import RexsError, RexsProblem, wrong
from gearwhine.exchange.rexs.units import unit_named

_NUMBER = re.compile(r"\s*[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,4})?\s*")
_LONGEST_NUMBER = 100
_LARGEST = 1e50
"""Amount beyond which a number is no quantity, and below whose inverse it is 0: products of some stay finite."""
SCHEMA_VERSIONS = ("1.0", "1.1", "1.2", "1.3", "1.4", "1.5", "1.6", "1.7", "2.0", "2.0.0")


@dataclass(frozen=True)
class Attribute:
    """Value of an attribute as the file has it, and its unit's name."""

    value: Any
    unit: str = ""


def finite_number(value: object) -> float | None:
    """Return a number or its text as a float; None where it is none, or beyond all quantities."""
    if isinstance(value, str):
        if len(value) > _LONGEST_NUMBER or _NUMBER.fullmatch(value) is None:
            return None
        number = float(value)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:
            return None
    else:
        return None
    if not abs(number) <= _LARGEST:
        return None
    return number if abs(number) >= 1.0 / _LARGEST else 0.0


@dataclass(frozen=True)
class Component:
    """A component: number, type, name, and attributes by name.

    Attributes
    ----------
    number : int
        Its ``id``.
    kind : str
        Its ``type``, such as ``shaft_section``.
    name : str
    attributes : mapping of str to Attribute
    looked_up : set of str
        Names of attributes that an import asked for, of the component and of what load cases make of it.
    """

    number: int
    kind: str
    name: str = ""
    attributes: Mapping[str, Attribute] = field(default_factory=dict)
    looked_up: set[str] = field(default_factory=set, compare=False, repr=False)

    @property
    def label(self) -> str:
        """Type, number and name, as messages show them."""
        return f'{self.kind} {self.number} "{self.name[:60]}"' if self.name else f"{self.kind} {self.number}"

    def has(self, *names: str) -> bool:
        """Whether one of these attributes has a value."""
        self.looked_up.update(names)
        return any(name in self.attributes and self.attributes[name].value is not None for name in names)

    def number_of(self, names: str | Sequence[str], unit: str = "") -> float | None:
        """Return an attribute in an SI unit, the first of some names that the component has; None without any.

        Parameters
        ----------
        names : str or sequence of str
            Name of the attribute, and its names in other versions of the schema.
        unit : str
            SI unit of what it measures, such as ``N*m/rad``; empty for a plain number.

        Raises
        ------
        RexsError
            Where it is no finite number, or its unit measures something else.
        """
        for name in (names,) if isinstance(names, str) else names:
            if self.has(name):
                return self._scaled(name, self.attributes[name].value, unit)
        return None

    def required(self, names: str | Sequence[str], unit: str = "") -> float:
        """Return an attribute as :meth:`number_of` does.

        Raises
        ------
        RexsError
            As there, and where the component has none of the names.
        """
        number = self.number_of(names, unit)
        if number is None:
            first = names if isinstance(names, str) else names[0]
            raise wrong(self.label, f"the attribute {first}")
        return number

    def positive(self, names: str | Sequence[str], unit: str = "") -> float | None:
        """Return an attribute as :meth:`number_of` does; None also for 0 and less, which stand for no value."""
        number = self.number_of(names, unit)
        return number if number is not None and number > 0.0 else None

    def vector(self, name: str, unit: str | None = "m") -> tuple[float, float, float] | None:
        """Return an attribute of three numbers in an SI unit, without one as they stand; None without the attribute.

        Raises
        ------
        RexsError
            Where it is no list of three finite numbers.
        """
        if not self.has(name):
            return None
        value = self.attributes[name].value
        if not isinstance(value, tuple | list) or len(value) != 3:
            raise wrong(f"{self.label}: {name}", "three numbers", value)
        x, y, z = (self._scaled(name, entry, unit) for entry in value)
        return x, y, z

    def flag(self, name: str, place: int = 0) -> bool | None:
        """Return an attribute that is true or false, of a list the entry at a place; None where it is neither."""
        value = self.attributes[name].value if self.has(name) else None
        if isinstance(value, tuple | list):
            value = value[min(place, len(value) - 1)] if value else None
        if isinstance(value, str):
            return {"true": True, "false": False, "1": True, "0": False}.get(value.strip().lower())
        return value if isinstance(value, bool) else None

    def text(self, *names: str) -> str:
        """Return the first of these attributes that is a text, without blanks around it; else an empty text."""
        for name in names:
            value = self.attributes[name].value if self.has(name) else None
            if isinstance(value, str) and value.strip():
                return value.strip()
        return ""

    def whole(self, name: str) -> int | None:
        """Return an attribute that is a whole number; None where there is none.

        Raises
        ------
        RexsError
            Where it is no whole number.
        """
        number = self.number_of(name)
        if number is None:
            return None
        if number != int(number):
            raise wrong(f"{self.label}: {name}", "a whole number", number)
        return int(number)

    def _scaled(self, name: str, value: object, unit: str | None) -> float:
        number = finite_number(value)
        if number is None:
            raise wrong(f"{self.label}: {name}", "a finite number", value)
        if unit is None:
            return number
        written = self.attributes[name].unit
        scale = unit_named(written)
        if scale is None or (scale.si != unit and scale.si != ""):
            raise wrong(f"{self.label}: {name}", f"a unit of the schema for {unit or 'a plain number'}", written)
        if scale.si != unit:
            raise wrong(f"{self.label}: {name}", f"a value with a unit, as the schema has it, in {unit}", value)
        return number * scale.factor + scale.offset

    def changed(self, attributes: Mapping[str, Attribute]) -> Component:
        """Return the component with further attributes, as a load case gives them."""
        return replace(self, attributes={**self.attributes, **attributes})


@dataclass(frozen=True)
class Relation:
    """A relation: its type, and the components by their roles.

    Attributes
    ----------
    number : int
    kind : str
    roles : tuple of tuple of str and int
        Role and component of each reference, in the order of the file.
    order : int
        Place among others of the same kind; 0 where there is none.
    """

    number: int
    kind: str
    roles: tuple[tuple[str, int], ...]
    order: int = 0

    def role(self, name: str) -> int | None:
        """Return the component of a role; None where there is none."""
        return next((number for role, number in self.roles if role == name), None)

    @property
    def label(self) -> str:
        """Type and number, as messages show them."""
        return f"relation {self.number} ({self.kind})"


@dataclass(frozen=True)
class LoadCase:
    """A load case of a spectrum: its number, and the components with the attributes that they have in it."""

    number: int
    components: tuple[Component, ...]


@dataclass(frozen=True)
class RexsModel:
    """Content of a REXS file.

    Attributes
    ----------
    version : str
        Version of the schema.
    program, program_version, date : str
        Origin of the file, as it states it.
    components : mapping of int to Component
    relations : tuple of Relation
    load_cases : tuple of LoadCase
        Those of the first spectrum.
    spectra : int
        Number of spectra.
    """

    version: str
    program: str
    program_version: str
    date: str
    components: Mapping[int, Component]
    relations: tuple[Relation, ...]
    load_cases: tuple[LoadCase, ...] = ()
    spectra: int = 0

    @property
    def origin(self) -> str:
        """Schema version, program and date, in words."""
        program = " ".join(filter(None, (self.program, self.program_version))) or "an unnamed program"
        return f"REXS {self.version}, written by {program}{f' on {self.date}' if self.date else ''}"

    def of_kind(self, *kinds: str) -> Iterator[Component]:
        """Yield the components of these types, in the order of the file."""
        return (component for component in self.components.values() if component.kind in kinds)

    def of_relation(self, *kinds: str) -> Iterator[Relation]:
        """Yield the relations of these types, ordered ones in their order."""
        return (relation for kind in kinds for relation in self._by_kind.get(kind, ()))

    @cached_property
    def _by_kind(self) -> dict[str, list[Relation]]:
        found: dict[str, list[Relation]] = {}
        for relation in sorted(self.relations, key=lambda relation: relation.order):
            found.setdefault(relation.kind, []).append(relation)
        return found

    def parts_of(self, number: int, *kinds: str) -> list[Component]:
        """Return the parts of an assembly, of some types, in their order."""
        return [self.components[part] for part in self._parts.get(number, ()) if self.components[part].kind in kinds]

    def assembly_of(self, number: int, *kinds: str) -> Component | None:
        """Return the assembly of some types that a component is a part of; None where there is none."""
        return next(
            (
                self.components[whole]
                for whole in self._assemblies.get(number, ())
                if self.components[whole].kind in kinds
            ),
            None,
        )

    def referenced(self, number: int, *kinds: str) -> list[Component]:
        """Return the components of some types that a component refers to."""
        return [
            self.components[other] for other in self._references.get(number, ()) if self.components[other].kind in kinds
        ]

    @cached_property
    def _parts(self) -> dict[int, dict[int, None]]:
        return self._joined("assembly", "part", "assembly", "ordered_assembly")

    @cached_property
    def _assemblies(self) -> dict[int, dict[int, None]]:
        return self._joined("part", "assembly", "assembly", "ordered_assembly")

    @cached_property
    def _references(self) -> dict[int, dict[int, None]]:
        return self._joined("origin", "referenced", "reference", "ordered_reference")

    def _joined(self, first: str, second: str, *kinds: str) -> dict[int, dict[int, None]]:
        """Return the components of a second role by that of the first, each once and in order."""
        found: dict[int, dict[int, None]] = {}
        for relation in self.of_relation(*kinds):
            one, other = relation.role(first), relation.role(second)
            if one is not None and other is not None:
                found.setdefault(one, {})[other] = None
        return found

    def in_load_case(self, load_case: LoadCase) -> RexsModel:
        """Return the model with the attributes of a load case."""
        components = dict(self.components)
        for changed in load_case.components:
            components[changed.number] = components[changed.number].changed(changed.attributes)
        return replace(self, components=components)


def checked_model(
    version: str,
    origin: tuple[str, str, str],
    components: Iterable[Component],
    relations: Sequence[Relation],
    spectra: Sequence[Sequence[LoadCase]],
) -> RexsModel:
    """Make the model of what a file has, once its version is known, its numbers are unique and its references lead on.

    Raises
    ------
    RexsError
        With everything of that which is wrong.
    """
    if version not in SCHEMA_VERSIONS:
        raise wrong("model: version", "a version of the REXS schema from 1.0 to 1.7, or 2.0.0", version)
    by_number: dict[int, Component] = {}
    problems = []
    for component in components:
        if component.number in by_number:
            problems.append(RexsProblem(component.label, "a number that no other component has", component.number))
        by_number[component.number] = component
    for relation in relations:
        for role, number in relation.roles:
            if number not in by_number:
                problems.append(RexsProblem(f"{relation.label}: {role}", "the number of a component", number))
    load_cases = tuple(spectra[0]) if spectra else ()
    for load_case in load_cases:
        for changed in load_case.components:
            if changed.number not in by_number:
                place = f"load_case {load_case.number}: {changed.label}"
                problems.append(RexsProblem(place, "the number of a component", changed.number))
    if not problems:
        problems += _circles(by_number, relations)
    if problems:
        raise RexsError(problems[:50])
    return RexsModel(version, *origin, by_number, tuple(relations), load_cases, len(spectra))


def _circles(components: Mapping[int, Component], relations: Iterable[Relation]) -> list[RexsProblem]:
    """Return a problem for an assembly that is a part of itself, however many assemblies lie between."""
    parts: dict[int, set[int]] = {}
    for relation in relations:
        whole, part = relation.role("assembly"), relation.role("part")
        if relation.kind in ("assembly", "ordered_assembly") and whole is not None and part is not None:
            parts.setdefault(whole, set()).add(part)
    # An assembly whose parts are no assemblies is taken away from what it is a part of, until only circles are left.
    inner = {whole: {part for part in its if part in parts} for whole, its in parts.items()}
    around: dict[int, list[int]] = {}
    for whole, its in inner.items():
        for part in its:
            around.setdefault(part, []).append(whole)
    ended = [whole for whole, its in inner.items() if not its]
    while ended:
        part = ended.pop()
        del inner[part]
        for whole in around.get(part, ()):
            inner[whole].discard(part)
            if not inner[whole]:
                ended.append(whole)
    if not inner:
        return []
    # Some stand around a circle: the way down from any of them ends in one.
    one, passed = min(inner), set[int]()
    while one not in passed:
        passed.add(one)
        one = min(inner[one])
    return [RexsProblem(components[one].label, "an assembly that is no part of itself, by way of others either")]
