"""Case: all tables of the file, in SI."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Protocol, TypeVar

from pydantic import Field

from gearwhine.case.analysis import RotorAnalysis
from gearwhine.case.fields import MOST_ENTRIES, Name, Table
from gearwhine.case.gears import Gear, GearPair
from gearwhine.case.housing import Housing, Material, Seat
from gearwhine.case.measured import Measured
from gearwhine.case.rotors import Rotor
from gearwhine.case.running import Operation, Sweep, Transient
from gearwhine.case.shafts import Bearing
from gearwhine.case.updating import Update

Text = Annotated[str, Field(max_length=10_000)]


class _Named(Protocol):
    @property
    def name(self) -> str: ...


NamedEntry = TypeVar("NamedEntry", bound=_Named)


def _named(entries: Iterable[NamedEntry], name: str) -> NamedEntry:
    """Return the entry of this name; KeyError where there is none."""
    for entry in entries:
        if entry.name == name:
            return entry
    raise KeyError(name)


class Case(Table):
    """A case: rotors only, a housing only, gears only, or all.

    Attributes are named as the keys of the case file and hold SI floats: m, kg, s, N, rad, rad/s; frequencies
    are in Hz. Entries of a list keep the order of the file.

    Attributes
    ----------
    title, notes
        Text for people.
    material
        Materials by name.
    housing, operation, transient, sweep, rotor_analysis, measured, update
        None where the case has no such table.
    rotor, bearing, gear, gear_pair
        Empty where the case has none.
    provenance
        From key path (`*` for any entry) to "published", "nominal" or "found", with text after a colon.
    """

    title: Annotated[str, Field(max_length=500)] = ""
    notes: Text = ""
    material: dict[Name, Material] = Field(default={}, max_length=1000)
    housing: Housing | None = None
    rotor: tuple[Rotor, ...] = Field(default=(), max_length=1000)
    bearing: tuple[Bearing, ...] = Field(default=(), max_length=1000)
    gear: tuple[Gear, ...] = Field(default=(), max_length=1000)
    gear_pair: tuple[GearPair, ...] = Field(default=(), max_length=1000)
    operation: Operation | None = None
    transient: Transient | None = None
    sweep: Sweep | None = None
    rotor_analysis: RotorAnalysis | None = None
    measured: Measured | None = None
    update: Update | None = None
    provenance: dict[str, Text] = Field(default={}, max_length=MOST_ENTRIES)

    def rotor_named(self, name: str) -> Rotor:
        """Return the rotor of this name; KeyError where there is none."""
        return _named(self.rotor, name)

    def gear_named(self, name: str) -> Gear:
        """Return the gear of this name; KeyError where there is none."""
        return _named(self.gear, name)

    def seat_named(self, name: str) -> Seat:
        """Return the housing's seat of this name; KeyError where there is none."""
        return _named(self.housing.seat if self.housing else (), name)

    def material_of_gear(self, gear: Gear) -> Material | None:
        """Return a gear's material: its own, else its rotor's, else the case's only one; or None."""
        name = gear.material
        if name is None and gear.rotor is not None:
            name = self.rotor_named(gear.rotor).material
        if name is None and len(self.material) == 1:
            return next(iter(self.material.values()))
        return self.material[name] if name is not None else None
