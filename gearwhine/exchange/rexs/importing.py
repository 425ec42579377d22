"""Import of a gear unit from a REXS file: its model as the document of a case, with notes on what was done.

The import fills the tables of a case and computes no more than geometry: places, profile shifts of a centre distance,
and speeds and torques by the ratios of the train.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from gearwhine.exchange.rexs.bearings import bearing_table, find_bearings, support_table
from gearwhine.exchange.rexs.errors import RexsError, RexsProblem, wrong
from gearwhine.exchange.rexs.flanks import MODIFICATIONS_LEFT_OUT
from gearwhine.exchange.rexs.gear_unit import GearUnit, readable
from gearwhine.exchange.rexs.gears import Mesh, find_meshes, find_teeth, gear_table, settle_heights, settle_shifts
from gearwhine.exchange.rexs.materials import Materials
from gearwhine.exchange.rexs.model import RexsModel
from gearwhine.exchange.rexs.notes import Note, in_words
from gearwhine.exchange.rexs.operation import (
    chosen_load_case,
    described_load_case,
    find_drive,
    loads_of,
    operation_table,
    speed_of,
    swept_speeds,
)
from gearwhine.exchange.rexs.placement import Placements
from gearwhine.exchange.rexs.quantities import rpm
from gearwhine.exchange.rexs.reduced_casing import casing_of, housing_table
from gearwhine.exchange.rexs.shaft_places import place_shafts
from gearwhine.exchange.rexs.shafts import Body, find_bodies, rotor_table
from gearwhine.exchange.rexs.toml_text import toml_text
from gearwhine.exchange.rexs.trains import (
    PlanetSet,
    find_train,
    in_order_of_power,
    pair_table,
    planetary_table,
)

_MOST_OF_A_KIND = 3000
_LONGEST_NOTES = 9000
_TAKEN = {
    *("gear_unit", "gear_casing", "shaft", "shaft_section", "side_plate", "planet_carrier", "planetary_stage"),
    *("cylindrical_gear", "ring_gear", "cylindrical_stage", "gear_body", "material", "external_load"),
    *("coupling", "switchable_coupling", "concept_bearing", "additional_mass"),
    *("rolling_bearing_with_catalog_geometry", "rolling_bearing_with_detailed_geometry", "rolling_bearing_row"),
    *("rolling_element", "cylindrical_gear_flank", "flank_geometry", "rack_shaped_tool", "cutter_wheel_tool"),
    *("tip_relief", "root_relief", "profile_crowning", "helix_crowning"),
    *("end_relief_datum_face", "end_relief_non_datum_face"),
    *MODIFICATIONS_LEFT_OUT,
}
"""Types of components that an import takes, or notes one by one."""
_SAID_ELSEWHERE = {
    *("reference_component_for_position", "support_vector", "u_axis_vector", "w_axis_vector", "name", "manufacturer"),
    *("u_coordinate_on_shaft", "u_coordinate_on_shaft_inner_side", "u_coordinate_on_shaft_outer_side"),
    *("number_of_gears", "gear_shift_index", "material_designation", "defines_speed", "defines_torque"),
    *("transmits_torque", "flag_designation_addendum_modification", "rotating_angle_around_neg_u_axis"),
    *("number_of_bearing_rows", "common_face_width", "folder"),
}
"""Attributes that are not noted where they are not taken: places and names, and what follows from others."""
_MOST_ATTRIBUTES = 8
_WHY_LEFT_OUT = {
    "lubricant": "a case has no lubricant: damping and friction are keys of its bearings and gear pairs",
    "stage_gear_data": "results of the file's program",
    "cylindrical_stage_gear_data": "results of the file's program",
    "assembly_group": "no reduced stiffness of the casing against the ground: finite elements and CAD are not taken",
    "reduction_point": "no reduced stiffness of the casing is taken",
    "bevel_stage": "a case has cylindrical gears on parallel shafts alone",
    "worm_stage": "a case has cylindrical gears on parallel shafts alone",
}


@dataclass(frozen=True)
class ImportedCase:
    """A gear unit as the document of a case.

    Attributes
    ----------
    document : dict
        Tables and lists of a case.
    notes : tuple of Note
        What was assumed, changed and left out.
    origin : str
        File, schema version, program and date.
    load_cases : tuple of str
        Load cases of the file, in words; the chosen one first.
    """

    document: dict[str, Any]
    notes: tuple[Note, ...]
    origin: str
    load_cases: tuple[str, ...]

    @property
    def summary(self) -> str:
        """The number of notes of each kind, in a sentence."""
        counts = Counter(note.kind for note in self.notes)
        shown = ", ".join(f"{counts[kind]} {kind}" for kind in ("assumed", "changed", "left out") if counts[kind])
        return f"imported from {self.origin}: {shown or 'nothing assumed'}; `gearwhine import` lists them"

    @property
    def toml(self) -> str:
        """The case as TOML, with a comment at each value that was assumed or changed."""
        comments = [(note.at, str(note)) for note in self.notes if note.at]
        return toml_text(self.document, comments, [f"Imported from {self.origin}."])


def case_of(model: RexsModel, name: str = "", load_case: str = "") -> ImportedCase:
    """Return the case of a gear unit.

    Parameters
    ----------
    model : RexsModel
    name : str
        Name of the file, for the origin.
    load_case : str
        Number of the load case; by default the first.

    Raises
    ------
    RexsError
        Where the file has no gear unit that a case can hold.
    """
    chosen = chosen_load_case(model, load_case)
    unit = GearUnit(model if chosen is None else model.in_load_case(chosen), Placements(model))
    _require_moderate(model)
    place_shafts(unit)
    materials = Materials(unit)
    bodies = find_bodies(unit, materials)
    teeth = find_teeth(unit, bodies)
    meshes = find_meshes(unit, teeth)
    if not meshes:
        raise wrong("the file", "a cylindrical_stage with a relation 'stage' to two gears on shafts")
    settle_shifts(unit, meshes)
    settle_heights(unit, meshes)
    speed = speed_of(unit, bodies)
    train = find_train(unit, bodies, in_order_of_power(meshes, None if speed is None else speed[0]), teeth)
    loads = loads_of(unit, bodies)
    document: dict[str, Any] = {"title": _title(model, name)}
    operation: dict[str, Any] | None = None
    sweep: dict[str, Any] | None = None
    if speed is None:
        unit.notes.left_out("operation", "no shaft with a rotational_speed: the case has no operation")
    else:
        ratios = train.ratios_to(speed[0])
        drive = find_drive(unit, speed, loads, ratios)
        train.meshes = in_order_of_power(meshes, drive.body)
        speeds = {name: ratio * speed[1] for name, ratio in ratios.items()}
        operation = operation_table(unit, drive, loads, speeds)
        swept = swept_speeds(unit, bodies, model, ratios.get(drive.body.name, 1.0))
        if len(swept) > 1:
            sweep = {"speed": [rpm(value) for value in swept]}
            text = f"the speeds of {len(model.load_cases)} load cases, with the torque of the one that is taken"
            unit.notes.changed("load_spectrum", text, "sweep", "speed")
    geared = _turning(train.meshes, train.sets)
    standing = [body for body in bodies.bodies if body not in geared and bodies.holds(body)]
    idle = [body for body in bodies.bodies if body not in geared and body not in standing]
    for body in standing:
        unit.notes.left_out(body.label, "it stands still in the casing: what turns on it stands on the ground")
    for body in idle:
        unit.notes.left_out(body.label, "no gear pair turns it")
    rotors = [rotor_table(unit, materials, body, place) for place, body in enumerate(geared)]
    document["material"] = materials.tables
    unusual = [f"material.{json.dumps(name)}.youngs_modulus" for name in materials.rigid]
    if unusual:
        document["unusual"] = unusual
    document["rotor"] = rotors
    casing = casing_of(unit.model)
    on_ground: dict[int, dict[str, Any]] = {}
    mounted = [one for one in find_bearings(unit, bodies, train.carriers, standing) if one.body in geared]
    bearings: list[dict[str, Any]] = []
    for one in mounted:
        table = bearing_table(unit, one, len(bearings))
        if table is not None:
            bearings.append(table)
            on_ground[one.component.number] = table
    for body in geared:
        for coupling in bodies.holds(body):
            table = support_table(unit, body, coupling, len(bearings))
            if table is not None:
                bearings.append(table)
    if casing is not None and (housing := housing_table(unit, casing, name, on_ground)) is not None:
        document["housing"] = housing
    if bearings:
        document["bearing"] = bearings
    in_mesh = dict.fromkeys(gear for mesh in train.meshes for gear in (mesh.first, mesh.second))
    document["gear"] = [gear_table(unit, materials, one, place) for place, one in enumerate(in_mesh)]
    for gear in teeth.values():
        if gear not in in_mesh:
            unit.notes.left_out(gear.component.label, "it meshes with no gear")
    document["gear_pair"] = [pair_table(unit, mesh) for mesh in train.meshes]
    sets = [planetary_table(unit, one, train, bodies) for one in train.sets]
    if sets:
        document["planetary"] = sets
    if operation is not None:
        document["operation"] = operation
    if sweep is not None:
        document["sweep"] = sweep
    _note_the_rest(unit, () if casing is None else ("assembly_group", "reduction_point"))
    _note_attributes(unit)
    origin = f"{readable(name) or 'a file'} ({model.origin})"
    shown = [] if chosen is None else [described_load_case(model, chosen)]
    shown += [described_load_case(model, one) for one in model.load_cases if one is not chosen]
    if len(model.load_cases) > 1 and not load_case:
        unit.notes.assumed("load_spectrum", f"{len(model.load_cases)} load cases: the first, {shown[0]}", "operation")
    if model.spectra > 1:
        unit.notes.left_out("load_spectrum", f"{model.spectra - 1} further spectra")
    notes = tuple(unit.notes)
    heading = {"title": document.pop("title"), "notes": _text_of(origin, shown[:1] if chosen else [], notes)}
    if "unusual" in document:
        heading["unusual"] = document.pop("unusual")
    document = {**heading, **document}
    return ImportedCase(document, notes, readable_origin(origin), tuple(shown))


def readable_origin(origin: str) -> str:
    """Return an origin without characters that nobody sees."""
    return " ".join("".join(letter if letter.isprintable() else " " for letter in origin).split())


def _title(model: RexsModel, name: str) -> str:
    unit = next(model.of_kind("gear_unit"), None)
    named = readable(unit.text("model_name") or unit.name) if unit is not None else ""
    return f"{named or 'Gear unit'}, from {readable(name) or 'a REXS file'}"


def _turning(meshes: list[Mesh], sets: list[PlanetSet]) -> list[Body]:
    """Return the bodies that gears or planets turn, in the order of the power."""
    bodies = [gear.body for mesh in meshes for gear in (mesh.first, mesh.second)] + [one.carrier for one in sets]
    return list(dict.fromkeys(bodies))


def _require_moderate(model: RexsModel) -> None:
    """Refuse more shafts, sections, gears or bearings than a machine has."""
    counts = Counter(component.kind for component in model.components.values())
    problems = [
        RexsProblem(f"components of type {kind}", f"at most {_MOST_OF_A_KIND}", count)
        for kind, count in counts.items()
        if kind in _TAKEN and count > _MOST_OF_A_KIND
    ]
    if problems:
        raise RexsError(problems)


def _note_the_rest(unit: GearUnit, taken: tuple[str, ...]) -> None:
    """Note each type of component that nothing was taken of, once with all that are of it."""
    kinds: dict[str, list[str]] = {}
    for component in unit.model.components.values():
        if component.kind not in _TAKEN and component.kind not in taken:
            kinds.setdefault(component.kind, []).append(str(component.number))
    for kind, numbers in kinds.items():
        unit.notes.left_out(_numbered(kind, numbers), _WHY_LEFT_OUT.get(kind, "not taken"))


def _numbered(kind: str, numbers: Sequence[str]) -> str:
    """Return a type with the numbers of its components, the first six."""
    return f"{readable(kind)} {', '.join(numbers[:6])}" + (f" and {len(numbers) - 6} more" if len(numbers) > 6 else "")


def _note_attributes(unit: GearUnit) -> None:
    """Note the attributes that nothing asked for of the components that are taken, once for each type.

    Where others of the type have been asked for all of theirs, the note has the numbers of the components.
    """
    unasked: dict[str, dict[str, None]] = {}
    lacking: dict[str, dict[str, None]] = {}
    taken: dict[str, int] = {}
    for component in unit.model.components.values():
        if component.kind not in _TAKEN:
            continue
        taken[component.kind] = taken.get(component.kind, 0) + 1
        for name, attribute in component.attributes.items():
            is_empty = attribute.value is None or attribute.value == ""
            if not is_empty and name not in component.looked_up and name not in _SAID_ELSEWHERE:
                unasked.setdefault(component.kind, {})[name] = None
                lacking.setdefault(component.kind, {})[str(component.number)] = None
    for kind, names in unasked.items():
        shown = [readable(name) for name in names][:_MOST_ATTRIBUTES]
        more = f" and {len(names) - len(shown)} more" if len(names) > len(shown) else ""
        of_all = len(lacking[kind]) == taken[kind]
        whose = readable(kind) if of_all else _numbered(kind, list(lacking[kind]))
        unit.notes.left_out(whose, f"the attribute{'s' * (len(names) > 1)} {', '.join(shown)}{more}")


def _text_of(origin: str, load_cases: list[str], notes: tuple[Note, ...]) -> str:
    """Return the origin and the notes as the text of a case."""
    lines = [f"Imported from {readable_origin(origin)}."]
    lines += [f"Taken: {readable_origin(text)}." for text in load_cases]
    length = sum(map(len, lines))
    sentences = in_words(notes)
    for number, sentence in enumerate(sentences):
        line = readable_origin(sentence)
        length += len(line) + 1
        if length > _LONGEST_NOTES:
            lines.append(f"... and {len(sentences) - number} more notes")
            break
        lines.append(line)
    return "\n".join(lines) + "\n"
