"""Materials of a REXS file as `[material.NAME]`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from gearwhine.exchange.rexs.gear_unit import GearUnit
from gearwhine.exchange.rexs.model import Component
from gearwhine.exchange.rexs.quantities import of, plain

PROPERTIES = (
    ("youngs_modulus", "elastic_modulus", "Pa"),
    ("poisson_ratio", "poisson_ratio", ""),
    ("density", "density", "kg/m^3"),
)
"""Key of a material, attribute and SI unit of each property."""
_STEEL = (210e9, 0.3, 7850.0)  # Young's modulus [Pa], Poisson's ratio, density [kg/m³]
_STIFFER_THAN_MATTER = 2e12  # Young's modulus [Pa] of no material, by which programs mean a rigid part
_DENSITY_OF_NO_MASS = 1.0  # kg/m³


@dataclass
class Materials:
    """The materials that parts of the case have, made as they are asked for.

    Attributes
    ----------
    unit : GearUnit
    tables : dict
        Table of each material, by name.
    rigid : list of str
        Names of those by which the file means rigid parts.
    """

    unit: GearUnit
    tables: dict[str, dict[str, Any]] = field(default_factory=dict)
    rigid: list[str] = field(default_factory=list)

    def name_for(self, component: Component, *others: Component) -> str:
        """Return the name of a component's material, else that of one of some others, else steel."""
        for one in (component, *others):
            material = self.unit.material_of(one)
            if material is not None:
                return self._table_of(material)
        self.unit.notes.assumed(component.label, "no material: steel", "material", "steel")
        if "steel" not in self.tables:
            self.tables["steel"] = _table(*_STEEL)
        return "steel"

    def is_rigid(self, component: Component) -> bool:
        """Whether a component is of a material by which a program means a rigid part without mass."""
        material = self.unit.material_of(component)
        modulus = None if material is None else material.positive("elastic_modulus", "Pa")
        return modulus is not None and modulus >= _STIFFER_THAN_MATTER

    def _table_of(self, material: Component) -> str:
        name = self.unit.names.of(material)
        if name in self.tables:
            return name
        notes, values = self.unit.notes, []
        given = [material.positive(name, measure) for _, name, measure in PROPERTIES]
        for (key, _, _), value, steel in zip(PROPERTIES, given, _STEEL, strict=True):
            if value is None:
                rigid = key == "density" and (given[0] or 0.0) >= _STIFFER_THAN_MATTER
                value = _DENSITY_OF_NO_MASS if rigid else steel
                meant = "that of no mass, as of a rigid part" if rigid else "that of steel"
                notes.assumed(material.label, f"no {key.replace('_', ' ')}: {meant}", "material", name, key)
            values.append(value)
        self.tables[name] = _table(*values)
        if values[0] >= _STIFFER_THAN_MATTER:
            self.rigid.append(name)
        return name


def _table(modulus: float, poisson_ratio: float, density: float) -> dict[str, Any]:
    return {
        "youngs_modulus": of(modulus / 1e9, "GPa"),
        "poisson_ratio": plain(poisson_ratio),
        "density": of(density, "kg/m^3"),
    }
