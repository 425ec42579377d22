"""Export of a case's gear unit: its tables as a REXS model, with notes on what the schema does not hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import gearwhine
from gearwhine.case import Case, require
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.exchange.rexs.gear_unit import readable
from gearwhine.exchange.rexs.model import RexsModel, checked_model
from gearwhine.exchange.rexs.notes import Note
from gearwhine.exchange.rexs.xml_writer import xml_text
from gearwhine.from_case.rexs.bearings import add_bearings
from gearwhine.from_case.rexs.casing import add_casing_stiffness
from gearwhine.from_case.rexs.gears import add_gears, add_stages
from gearwhine.from_case.rexs.loads import add_load_case, add_loads, add_sweep, gravity_of
from gearwhine.from_case.rexs.shafts import Shafts, add_materials, add_shafts
from gearwhine.from_case.rexs.sheet import Sheet, plain

VERSION = "1.7"
"""Version of the schema that is written."""
_TABLES = {
    "transient": "settings of the computation",
    "rotor_analysis": "settings of the computation",
    "sweep": "speeds of a sweep",
    "measured": "measured modes of the housing",
    "update": "settings of the computation",
    "acoustics": "settings of the computation",
    "provenance": "where each number comes from",
}


@dataclass(frozen=True)
class ExportedUnit:
    """A gear unit as a REXS model.

    Attributes
    ----------
    model : RexsModel
    notes : tuple of Note
        What is changed or left out.
    """

    model: RexsModel
    notes: tuple[Note, ...]

    @property
    def xml(self) -> str:
        """The model as XML."""
        return xml_text(self.model)


def rexs_of(case: Case, load: Mapping[str, Any] | None = None, housing: HousingComponent | None = None) -> ExportedUnit:
    """Return the gear unit of a case as a REXS model.

    Parameters
    ----------
    case : Case
    load : mapping, optional
        Document of its operating point, as ``gearwhine load`` writes it: the model then has a load case.
    housing : HousingComponent, optional
        Solved housing, whose static stiffness at the seats the model then has.

    Raises
    ------
    CaseError
        Where the case has no gears on rotors, or a part that no component stands for.
    """
    require(case, "rotor", "gear", "gear_pair", command="export --rexs")
    sheet = Sheet()
    title = {"model_name": plain(readable(case.title))} if readable(case.title) else {}
    unit = sheet.add("gear_unit", case.title, title | gravity_of(case.operation))
    casing = sheet.part(unit, "gear_casing", "casing")
    shafts = Shafts(sheet, unit, casing, add_materials(sheet, case.material))
    if case.housing is not None and case.housing.material is not None:
        sheet.relate("reference", origin=casing, referenced=shafts.materials[case.housing.material])
    add_shafts(case.rotor, case.material, shafts)
    gears = add_gears(case, shafts)
    add_stages(case, shafts, gears)
    bearings = add_bearings(case, shafts)
    given = add_loads(case, shafts)
    has_sweep = add_sweep(case, shafts, given)
    if load is not None:
        add_load_case(shafts, given, bearings, load)
        if case.housing is not None and load["seats"] == "rigid":
            sheet.notes.changed("load case", "the operating point is that of rigid seats, without the housing")
    has_stiffness = housing is not None and add_casing_stiffness(case, shafts, bearings, housing)
    if case.housing is not None or case.reduced_housing is not None:
        stands = "its static stiffness at the seats is written" if has_stiffness else "bearings stand in the casing"
        sheet.notes.left_out("[housing]", f"the housing: {stands}")
    for key, text in _TABLES.items():
        if getattr(case, key) and not (key == "sweep" and has_sweep):
            sheet.notes.left_out(f"[{key}]", text)
    made = datetime.now(UTC).isoformat(timespec="seconds")
    origin = ("Gearwhine", gearwhine.__version__, made)
    spectra = [sheet.load_cases] if sheet.load_cases else []
    model = checked_model(VERSION, origin, sheet.components, sheet.relations, spectra)
    return ExportedUnit(model, tuple(sheet.notes))
