"""Case model: all tables of the file in SI, as one frozen object, as a draft, and as TOML again.

A draft holds the readable tables of a case, sound or not, so that the checks see all of them at once.
:func:`require` raises the error for a table that a command needs and a case lacks. :func:`dump_case` writes the
resolved case: defaults included, every quantity with its unit.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Protocol, TypeVar

import tomli_w
from pydantic import Field, PrivateAttr, ValidationError, ValidationInfo, model_validator

from gearwhine.case.acoustics import Acoustics
from gearwhine.case.bearings import Bearing
from gearwhine.case.box import Box
from gearwhine.case.detection import Detection
from gearwhine.case.errors import NOTHING, UNSAID, CaseError, Location, Problem, look_up
from gearwhine.case.fields import MOST_ENTRIES, Name, Table, wrong
from gearwhine.case.fixtures import Joint, LumpedMass, Mount
from gearwhine.case.gears import Gear, GearPair, readable_pairs, train_of_pairs
from gearwhine.case.housing import Housing, Material, Seat, Sensor, Support
from gearwhine.case.input_files import InputFiles, files_of, paths_in
from gearwhine.case.measured import Measured, Update
from gearwhine.case.operation import Operation, Sweep, Transient
from gearwhine.case.optimisation import Optimisation
from gearwhine.case.planetary import HeldMember, Planetary, train_members
from gearwhine.case.reduced_housing import ReducedHousing
from gearwhine.case.rotors import Rotor, RotorAnalysis
from gearwhine.case.variation import Variation

if TYPE_CHECKING:
    from gearwhine.case.parts import Parts
    from gearwhine.coupling.description.gear_train import GearTrain

Text = Annotated[str, Field(max_length=10_000)]

KEY_OF_FORM = {"reduced_housing": "housing"}
"""Key in the file of each table that stands there under the key of another form."""


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

    Attributes are named as the keys of the case file and hold SI floats: m, kg, s, N, rad, rad/s; frequencies are in
    Hz. Entries of a list keep the order of the file. A table that the case has not is None, a list empty.
    """

    title: Annotated[str, Field(max_length=500)] = ""
    """Title of the case, shown with its results."""
    notes: Text = ""
    """Text for readers of the case."""
    material: dict[Name, Material] = Field(default={}, max_length=1000)
    """Materials by name, `[material.NAME]`."""
    housing: Housing | None = None
    """Housing; without it bearings stand on the ground."""
    reduced_housing: ReducedHousing | None = None
    """Housing of reduced matrices: the table `[housing]` where it has `reduced`."""
    rotor: tuple[Rotor, ...] = Field(default=(), max_length=1000)
    """Shafts, `[[rotor]]`."""
    bearing: tuple[Bearing, ...] = Field(default=(), max_length=1000)
    """Bearings, `[[bearing]]`."""
    gear: tuple[Gear, ...] = Field(default=(), max_length=1000)
    """Gears, `[[gear]]`."""
    gear_pair: tuple[GearPair, ...] = Field(default=(), max_length=1000)
    """Gear pairs, `[[gear_pair]]`."""
    planetary: tuple[Planetary, ...] = Field(default=(), max_length=100)
    """Planetary sets, `[[planetary]]`."""
    torque_support: tuple[HeldMember, ...] = Field(default=(), max_length=100)
    """Gears or rotors that are held from turning, `[[torque_support]]`."""
    operation: Operation | None = None
    """Speed and torque."""
    transient: Transient | None = None
    """Motion over time."""
    sweep: Sweep | None = None
    """Speeds of a sweep."""
    rotor_analysis: RotorAnalysis | None = None
    """Analyses of rotors alone."""
    measured: Measured | None = None
    """Measured modes of the housing."""
    update: Update | None = None
    """Parameters that are fitted to the measured modes."""
    acoustics: Acoustics | None = None
    """Sound that the housing radiates."""
    variation: Variation | None = None
    """Distributions of keys, and limits of what follows from them."""
    detection: Detection | None = None
    """Fault that grows, and what is told of it at the sensors."""
    optimisation: Optimisation | None = None
    """Keys that are designed, with aims and limits."""
    unusual: tuple[Annotated[str, Field(max_length=1000)], ...] = Field(default=(), max_length=MOST_ENTRIES)
    """Key paths, `*` for any entry, whose unlikely values are meant: at them and below them no implausible value is
    warned of. What cannot be stays an error."""
    provenance: dict[str, Text] = Field(default={}, max_length=MOST_ENTRIES)
    """Standing of each number: from key path (`*` for any entry) to "published", "nominal" or "found", with text after
    a colon."""

    _files: InputFiles = PrivateAttr(default_factory=InputFiles)

    @model_validator(mode="before")
    @classmethod
    def _housing_by_form(cls, document: Any) -> Any:
        if not isinstance(document, Mapping):
            return document
        if "reduced_housing" in document:
            raise wrong("no such key: matrices are the table [housing.reduced]", "reduced_housing")
        return _with_form(document)

    @model_validator(mode="after")
    def _with_files(self, info: ValidationInfo) -> Case:
        self._files = files_of(info).among(paths_in(self))
        return self

    @property
    def input_files(self) -> InputFiles:
        """The files that the case names, as they were when it was read."""
        return self._files

    def rotor_named(self, name: str) -> Rotor:
        """Return the rotor of this name; KeyError where there is none."""
        return _named(self.rotor, name)

    def gear_named(self, name: str) -> Gear:
        """Return the gear of this name; KeyError where there is none."""
        return _named(self.gear, name)

    @cached_property
    def parts(self) -> Parts:
        """The library's objects of the tables, each made once."""
        from gearwhine.case.parts import Parts  # it brings the library

        housing = self.housing or self.reduced_housing
        limit = None if housing is None else housing.frequency_limit
        return Parts(
            self.material,
            self.rotor,
            self.bearing,
            self.gear,
            self.gear_pair,
            self.operation,
            self.input_files,
            limit or 0.0,
            self.planetary,
            self.torque_support,
        )

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Case:
        """Return a copy with other values of some tables, whose parts are made anew."""
        copied = super().model_copy(update=update, deep=deep)
        copied._files = self._files.among(paths_in(copied))
        copied.__dict__.pop("parts", None)
        return copied


def _with_form(document: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return a document whose housing stands under the name of its form."""
    housing = document.get("housing")
    if not isinstance(housing, Mapping) or "reduced" not in housing:
        return document
    return {"reduced_housing" if key == "housing" else key: value for key, value in document.items()}


AnyTable = TypeVar("AnyTable", bound=Table)
Entries = tuple[tuple[int, AnyTable], ...]
"""The entries of a list that could be read, each with its place in the list."""


@dataclass(frozen=True)
class Draft:
    """The readable parts of a case.

    Attributes
    ----------
    document : mapping
        Nested tables and lists of the case file.
    broken : frozenset of str
        Top-level tables that are readable in parts only; a missing entry in them proves nothing.
    box, operation, transient, sweep, analysis, acoustics, measured
        Tables; None where one is missing or cannot be read.
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
    planetary: Entries[Planetary]
    torque_supports: Entries[HeldMember]
    operation: Operation | None
    transient: Transient | None
    sweep: Sweep | None
    analysis: RotorAnalysis | None
    acoustics: Acoustics | None
    measured: Measured | None

    @cached_property
    def readable_pairs(self) -> list[tuple[int, Gear, Gear]]:
        """Driver and driven gear of each pair on two shafts, with its place in the list."""
        return readable_pairs([gear for _, gear in self.gears], self.gear_pairs)

    @cached_property
    def held(self) -> list[tuple[Location, HeldMember]]:
        """Members that are held from turning, each with its place in the case."""
        of_sets = [(("planetary", index, "fixed"), one.fixed) for index, one in self.planetary if one.fixed is not None]
        return [*of_sets, *((("torque_support", index), one) for index, one in self.torque_supports)]

    @cached_property
    def train(self) -> GearTrain | None:
        """The gear train of these pairs; None where there are none."""
        if not self.readable_pairs:
            return None
        gears = [gear for _, gear in self.gears]
        held = [one for _, one in self.held]
        members = train_members([rotor for _, rotor in self.rotors], gears, held, self.operation)
        return train_of_pairs(self.readable_pairs, members=members)

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
    "acoustics": (Acoustics, ("acoustics",)),
    "measured": (Measured, ("measured",)),
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
    "planetary": (Planetary, ("planetary",)),
    "torque_supports": (HeldMember, ("torque_support",)),
}
"""Where the tables and lists of a draft stand in a case, and the class of each."""


def draft_of_case(case: Case, document: Mapping[str, Any]) -> Draft:
    """Return a valid case as a draft; `document` is its source."""

    def at(keys: tuple[str, ...]) -> Any:
        value: Any = case
        for key in keys:
            value = getattr(value, key, None)
        return value

    tables = {name: at(keys) for name, (_, keys) in _DRAFT_TABLES.items()}
    lists: dict[str, Any] = {name: tuple(enumerate(at(keys) or ())) for name, (_, keys) in _DRAFT_LISTS.items()}
    return Draft(document=document, broken=frozenset(), **tables, **lists)


def draft_of_document(document: Mapping[str, Any], broken: frozenset[str], context: Mapping[str, Any]) -> Draft:
    """Read the valid entries of a document with errors, one by one."""

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
    """Read one table; None where it is not valid."""
    if not isinstance(raw, Mapping):
        return None
    try:
        return kind.model_validate(raw, context=dict(context))
    except ValidationError:
        return None


_LISTS = ("rotor", "bearing", "gear", "gear_pair", "planetary", "torque_support")
_PURPOSES = {
    "housing": "the box, CAD or mesh file whose modes are wanted",
    "rotor": "at least one shaft",
    "bearing": "at least one bearing",
    "gear": "at least one gear",
    "gear_pair": "at least one pair of gears",
    "operation": "a speed such as speed = '5500 rpm'",
    "transient": "a length of run such as revolutions = 40",
    "sweep": "speeds such as speed = { from = '1500 rpm', to = '6000 rpm', step = '250 rpm' }",
    "measured": "frequencies such as ['658 Hz', '1049 Hz'], or a file of them",
    "acoustics": "at least an empty table, for boundary elements in free air",
    "variation": "distributions of keys under [variation.vary]",
    "detection": "fault = 'gear.pinion.fault.depth' and severities = ['1 mm', '2 mm']",
    "optimisation": "values of keys under [optimisation.design] and what is best under [optimisation.aim]",
    "update": "what is fitted, such as [[update.parameter]] name = 'top', keys = ['housing.box.wall.top']",
}


def require(case: Case, *tables: str, command: str) -> None:
    """Raise where a case lacks tables that a command needs.

    Parameters
    ----------
    case : Case
    *tables : str
        Keys of the top level, such as ``"housing"``.
    command : str
        Command that needs them, for the message.

    Raises
    ------
    CaseError
        With a problem for each table that is missing.
    """
    if any(not getattr(case, table) for table in tables):
        raise lacking(case, *tables, command=command)


def lacking(case: Case, *tables: str, command: str) -> CaseError:
    """Return the error of a case that lacks some of the tables that a command needs."""
    missing = [table for table in tables if not getattr(case, table)]
    if "housing" in missing and case.reduced_housing is not None:
        expected = (
            f"a box, CAD or mesh file: '{command}' needs a mesh and the shapes of its modes, which reduced matrices do "
            "not have; `modes` lists their natural frequencies"
        )
        return CaseError([Problem("housing.reduced", UNSAID, expected)])
    return CaseError(_lacking(table, command) for table in missing)


def housing_table(case: Case, command: str) -> Housing:
    """Return the table of a case's housing, for a command that needs it.

    Raises
    ------
    CaseError
        Where the case has no housing.
    """
    if case.housing is None:
        raise lacking(case, "housing", command=command)
    return case.housing


def measured_table(case: Case, command: str) -> Measured:
    """Return the table of the modes that were measured of a case's housing, for a command that needs both.

    Raises
    ------
    CaseError
        Where the case lacks one of them.
    """
    has_housing = case.housing is not None or (command == "compare" and case.reduced_housing is not None)
    if case.measured is None or not has_housing:
        raise lacking(case, *(() if has_housing else ("housing",)), "measured", command=command)
    return case.measured


def _lacking(table: str, command: str) -> Problem:
    table_name = f"[[{table}]]" if table in _LISTS else f"[{table}]"
    purpose = _PURPOSES.get(table, "its table")
    return Problem(table, NOTHING, f"{purpose}: '{command}' needs {table_name}, which this case does not have")


def case_document(case: Case) -> dict[str, Any]:
    """Return a case as nested tables and lists with quantities as text; what is None or empty is left out."""
    document = case.model_dump(mode="json", by_alias=True, exclude_none=True)
    return {KEY_OF_FORM.get(key, key): value for key, value in document.items() if value not in ("", [], {})}


def dump_case(case: Case) -> str:
    """Return a case as TOML that loads back to an equal case.

    Quantities are in SI units, or in degrees and rpm where these give back the very same number.
    """
    return tomli_w.dumps(case_document(case))
