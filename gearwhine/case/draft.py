"""Readable tables of a case, sound or not, so that the checks see all of them at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from pydantic import ValidationError

from gearwhine.case.analysis import RotorAnalysis
from gearwhine.case.attachments import Joint, LumpedMass, Mount
from gearwhine.case.box import Box
from gearwhine.case.fields import Table
from gearwhine.case.gears import Gear, GearPair
from gearwhine.case.housing import Seat, Sensor, Support
from gearwhine.case.model import Case
from gearwhine.case.problems import look_up
from gearwhine.case.rotors import Rotor
from gearwhine.case.running import Operation, Sweep, Transient
from gearwhine.case.shafts import Bearing

AnyTable = TypeVar("AnyTable", bound=Table)
Entries = tuple[tuple[int, AnyTable], ...]
"""The entries of a list that could be read, each with its place in the list."""


@dataclass(frozen=True)
class Draft:
    """The readable parts of a case.

    Attributes
    ----------
    document
        The nested tables and lists of the case file.
    broken
        Top-level tables in which something could not be read; what they lack proves nothing.
    box, operation, transient, sweep, analysis
        None where there is none or it could not be read.
    """

    document: Mapping[str, Any]
    broken: frozenset[str]
    box: Box | None
    seats: Entries[Seat]
    supports: Entries[Support]
    mounts: Entries[Mount]
    joints: Entries[Joint]
    masses: Entries[LumpedMass]
    sensors: Entries[Sensor]
    rotors: Entries[Rotor]
    bearings: Entries[Bearing]
    gears: Entries[Gear]
    gear_pairs: Entries[GearPair]
    operation: Operation | None
    transient: Transient | None
    sweep: Sweep | None
    analysis: RotorAnalysis | None

    def rotor(self, name: str | None) -> Rotor | None:
        """Return the rotor of this name, if it could be read."""
        return next((rotor for _, rotor in self.rotors if rotor.name == name), None)

    def gear(self, name: str) -> Gear | None:
        """Return the gear of this name, if it could be read."""
        return next((gear for _, gear in self.gears if gear.name == name), None)

    def raw_entries(self, *keys: str) -> Iterator[tuple[int, Mapping[str, Any]]]:
        """Yield the tables of a list as they stand in the document, readable or not, each with its place."""
        entries = look_up(self.document, keys)
        for index, entry in enumerate(entries if isinstance(entries, (list, tuple)) else ()):
            if isinstance(entry, Mapping):
                yield index, entry

    def names(self, *keys: str) -> tuple[str, ...]:
        """Return the names given in a list of tables, in order, whether the entries are sound or not."""
        return tuple(e["name"] for _, e in self.raw_entries(*keys) if isinstance(e.get("name"), str))


def draft_of_case(case: Case, document: Mapping[str, Any]) -> Draft:
    """Return a sound case as a draft; `document` is what it was read from."""
    housing = case.housing
    return Draft(
        document=document,
        broken=frozenset(),
        box=housing.box if housing else None,
        seats=tuple(enumerate(housing.seat if housing else ())),
        supports=tuple(enumerate(housing.support if housing else ())),
        mounts=tuple(enumerate(housing.mount if housing else ())),
        joints=tuple(enumerate(housing.joint if housing else ())),
        masses=tuple(enumerate(housing.mass if housing else ())),
        sensors=tuple(enumerate(housing.sensor if housing else ())),
        rotors=tuple(enumerate(case.rotor)),
        bearings=tuple(enumerate(case.bearing)),
        gears=tuple(enumerate(case.gear)),
        gear_pairs=tuple(enumerate(case.gear_pair)),
        operation=case.operation,
        transient=case.transient,
        sweep=case.sweep,
        analysis=case.rotor_analysis,
    )


def draft_of_document(document: Mapping[str, Any], broken: frozenset[str], context: Mapping[str, Any]) -> Draft:
    """Read what can be read of a document in which something is wrong, entry by entry."""

    def table(kind: type[AnyTable], *keys: str) -> AnyTable | None:
        return _read(kind, look_up(document, keys), context)

    def entries(kind: type[AnyTable], *keys: str) -> Entries[AnyTable]:
        raw = look_up(document, keys)
        read = ((i, _read(kind, e, context)) for i, e in enumerate(raw if isinstance(raw, list) else ()))
        return tuple((index, entry) for index, entry in read if entry is not None)

    return Draft(
        document=document,
        broken=broken,
        box=table(Box, "housing", "box"),
        seats=entries(Seat, "housing", "seat"),
        supports=entries(Support, "housing", "support"),
        mounts=entries(Mount, "housing", "mount"),
        joints=entries(Joint, "housing", "joint"),
        masses=entries(LumpedMass, "housing", "mass"),
        sensors=entries(Sensor, "housing", "sensor"),
        rotors=entries(Rotor, "rotor"),
        bearings=entries(Bearing, "bearing"),
        gears=entries(Gear, "gear"),
        gear_pairs=entries(GearPair, "gear_pair"),
        operation=table(Operation, "operation"),
        transient=table(Transient, "transient"),
        sweep=table(Sweep, "sweep"),
        analysis=table(RotorAnalysis, "rotor_analysis"),
    )


def _read(kind: type[AnyTable], raw: object, context: Mapping[str, Any]) -> AnyTable | None:
    """Read one table; None where it is not sound."""
    if not isinstance(raw, Mapping):
        return None
    try:
        return kind.model_validate(raw, context=dict(context))
    except ValidationError:
        return None
