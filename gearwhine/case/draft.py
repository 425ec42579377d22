"""Readable tables of a case, sound or not, so that the checks see all of them at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

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
from gearwhine.case.train import readable_pairs, train_of_pairs

if TYPE_CHECKING:
    from coupling.gear_train import GearTrain

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

    @cached_property
    def readable_pairs(self) -> list[tuple[int, Gear, Gear]]:
        """Driver and driven gear of each pair on two shafts, with its place in the list."""
        return readable_pairs([gear for _, gear in self.gears], self.gear_pairs)

    @cached_property
    def train(self) -> GearTrain | None:
        """The gear train of these pairs; None where there are none."""
        return train_of_pairs(self.readable_pairs) if self.readable_pairs else None

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


_DRAFT_TABLES: dict[str, tuple[type[Table], tuple[str, ...]]] = {
    "box": (Box, ("housing", "box")),
    "operation": (Operation, ("operation",)),
    "transient": (Transient, ("transient",)),
    "sweep": (Sweep, ("sweep",)),
    "analysis": (RotorAnalysis, ("rotor_analysis",)),
}
_DRAFT_LISTS: dict[str, tuple[type[Table], tuple[str, ...]]] = {
    "seats": (Seat, ("housing", "seat")),
    "supports": (Support, ("housing", "support")),
    "mounts": (Mount, ("housing", "mount")),
    "joints": (Joint, ("housing", "joint")),
    "masses": (LumpedMass, ("housing", "mass")),
    "sensors": (Sensor, ("housing", "sensor")),
    "rotors": (Rotor, ("rotor",)),
    "bearings": (Bearing, ("bearing",)),
    "gears": (Gear, ("gear",)),
    "gear_pairs": (GearPair, ("gear_pair",)),
}
"""Where the tables and lists of a draft stand in a case, and the class of each."""


def draft_of_case(case: Case, document: Mapping[str, Any]) -> Draft:
    """Return a sound case as a draft; `document` is what it was read from."""

    def at(keys: tuple[str, ...]) -> Any:
        found: Any = case
        for key in keys:
            found = getattr(found, key, None)
        return found

    tables = {name: at(keys) for name, (_, keys) in _DRAFT_TABLES.items()}
    lists: dict[str, Any] = {name: tuple(enumerate(at(keys) or ())) for name, (_, keys) in _DRAFT_LISTS.items()}
    return Draft(document=document, broken=frozenset(), **tables, **lists)


def draft_of_document(document: Mapping[str, Any], broken: frozenset[str], context: Mapping[str, Any]) -> Draft:
    """Read what can be read of a document in which something is wrong, entry by entry."""

    def entries(kind: type[AnyTable], keys: tuple[str, ...]) -> Entries[AnyTable]:
        raw = look_up(document, keys)
        read = ((i, _read(kind, e, context)) for i, e in enumerate(raw if isinstance(raw, list) else ()))
        return tuple((index, entry) for index, entry in read if entry is not None)

    tables: dict[str, Any] = {
        name: _read(kind, look_up(document, keys), context) for name, (kind, keys) in _DRAFT_TABLES.items()
    }
    lists: dict[str, Any] = {name: entries(kind, keys) for name, (kind, keys) in _DRAFT_LISTS.items()}
    return Draft(document=document, broken=broken, **tables, **lists)


def _read(kind: type[AnyTable], raw: object, context: Mapping[str, Any]) -> AnyTable | None:
    """Read one table; None where it is not sound."""
    if not isinstance(raw, Mapping):
        return None
    try:
        return kind.model_validate(raw, context=dict(context))
    except ValidationError:
        return None
