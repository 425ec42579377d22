"""A machine of Python of which only the necessary is said is that of a case of which only the same is said."""

from __future__ import annotations

import math
from dataclasses import MISSING, fields, is_dataclass, replace
from importlib import import_module
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.coupling import ShaftGear
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.coupling.description.parts import LATERAL_LIMIT_HZ as LIMIT_HZ
from gearwhine.coupling.gears import Gear
from gearwhine.meshes import BoxGeometry, WallThickness
from gearwhine.rotors import ShaftMaterial

APART = 88.9e-3
SAME_KEYS = {
    "acoustics.Acoustics": "coupling.sound.acoustics.Acoustics",
    "bearings.BearingFault": "rotors.rolling_bearings.spalls.RollingSpall",
    "bearings.CageSlip": "rotors.rolling_bearings.CageSlip",
    "bearings.Stop": "coupling.GapLaw",
    "box.CoverBolts": "meshes.box.parts.CoverBolts",
    "box.Feet": "meshes.box.parts.Feet",
    "box.Fillets": "meshes.box.parts.Fillets",
    "box.Flange": "meshes.box.parts.Flange",
    "box.Rib": "meshes.box.parts.Rib",
    "gears.HelixErrors": "coupling.gears.HelixDeviation",
    "gears.ProfileErrors": "coupling.gears.ProfileDeviation",
    "gears.Relief": "coupling.gears.TipRelief",
    "gears.RingSupport": "coupling.gears.RingSupport",
    "measured.Pairing": "housing.correlation.pairing.PairingRule",
    "operation.OrderTracking": "coupling.analyses.run_up.OrderTracking",
    "operation.TorqueRipple": "coupling.machine.loads.Ripple",
    "rotors.Coupling": "rotors.Coupling",
    "rotors.Disc": "rotors.Disc",
    "rotors.Unbalance": "rotors.Unbalance",
}
"""Tables of a case, in `gearwhine.case`, and the objects with their keys."""
_TWO_PI = 2.0 * math.pi


def said() -> gw.CaseStudy:
    """Return a case with the keys that it has to have, and no other."""
    names = ("in", "out")
    return gw.build(
        material={"steel": {"youngs_modulus": 207e9, "poisson_ratio": 0.3, "density": 7850.0}},
        housing={
            "material": "steel",
            "modes": 1,
            "box": {"size": [0.2, 0.16, 0.16], "wall": 0.01, "mesh_size": 0.05},
            "support": [{"name": "floor", "surface": "bottom", "fixed": ["x", "y", "z"]}],
            "sensor": [{"name": "top", "position": [0.0, 0.16, 0.0]}],
        },
        rotor=[
            {"name": name, "axis": [x, 0.08], "material": "steel", "segments": [{"length": 0.2, "diameter": 0.03}]}
            for name, x in zip(names, (0.0, APART), strict=True)
        ],
        bearing=[
            {"name": f"{name} {at}", "rotor": name, "at": at, "seat": "ground", "stiffness": {"xx": 1e8, "yy": 1e8}}
            for name in names
            for at in (0.02, 0.18)
        ],
        gear=[
            {"name": f"gear {name}", "rotor": name, "at": 0.1, "teeth": 28, "module": 3.175e-3, "face_width": 6.35e-3}
            for name in names
        ],
        gear_pair=[{"driver": "gear in", "driven": "gear out"}],
        operation={"speed": 500.0, "torque": 70.0},
        transient={"revolutions": 10},
    )


def made() -> gw.Machine:
    """Return the same machine of Python's objects; None of a shaft's limit stands for the number that a case writes."""
    steel = ShaftMaterial(207e9, 207e9 / 2.6, 7850.0)
    names, places = ("in", "out"), (0.0, APART)
    shafts = [
        gw.Shaft(gw.Rotor(name, [gw.Segment(0.2, 0.03, 0.0, steel)]), (x, 0.08), frequency_limit=_TWO_PI * LIMIT_HZ)
        for name, x in zip(names, places, strict=True)
    ]
    bearings = [
        gw.MountedBearing(gw.Bearing.isotropic(f"{name} {at}", at, 1e8), name, None)
        for name in names
        for at in (0.02, 0.18)
    ]
    gears = [
        ShaftGear(Gear(f"gear {name}", 28, 3.175e-3, math.radians(20.0), 6.35e-3, youngs_modulus=207e9), name, 0.1)
        for name in names
    ]
    return gw.Machine(shafts, bearings, gears, [gw.GearPair("gear in", "gear out")], speed=500.0, torque=70.0)


def differences(found: Any, expected: Any, at: str = "") -> list[str]:
    """Return the attributes in which two objects differ, numbers beyond their rounding."""
    if type(found) is type(expected) and is_dataclass(found):
        return [
            difference
            for field in fields(found)
            for difference in differences(
                getattr(found, field.name), getattr(expected, field.name), f"{at}.{field.name}"
            )
        ]
    if isinstance(found, list | tuple) and isinstance(expected, list | tuple) and len(found) == len(expected):
        pairs = enumerate(zip(found, expected, strict=True))
        return [difference for n, (one, other) in pairs for difference in differences(one, other, f"{at}[{n}]")]
    if isinstance(found, float | np.ndarray) and isinstance(expected, float | int | np.ndarray):
        if np.shape(found) == np.shape(expected) and np.allclose(found, expected, rtol=1e-12, atol=0.0):
            return []
    elif found == expected:
        return []
    return [f"{at}: {found!r}, in a case {expected!r}"]


def test_parts_of_a_machine_have_the_defaults_of_a_case() -> None:
    found, study = made(), said()
    expected = study.machine
    for part in ("shafts", "bearings", "gears", "gear_pairs", "outputs"):
        assert not differences(getattr(found, part), getattr(expected, part), part)


def taken(place: str) -> Any:
    module, _, name = place.rpartition(".")
    return getattr(import_module(f"gearwhine.{module}"), name)


@pytest.mark.parametrize("table", SAME_KEYS)
def test_a_table_has_the_keys_and_the_defaults_of_its_object(table: str) -> None:
    keys = taken(f"case.{table}").model_fields
    found = {key: one.get_default(call_default_factory=True) for key, one in keys.items() if not one.is_required()}
    expected = {one.name: one.default for one in fields(taken(SAME_KEYS[table])) if one.default is not MISSING}
    common = found.keys() & expected.keys()
    assert common
    assert len(common) >= len(expected) - 2
    assert {key: found[key] for key in common} == {key: expected[key] for key in common}


def test_a_housing_has_the_damping_of_a_case() -> None:
    walls = WallThickness.uniform(0.01)
    found = gw.Housing.from_box(BoxGeometry((0.2, 0.16, 0.16), walls), 0.05, gw.STEEL)
    expected = said().case.housing
    assert expected is not None
    assert found.damping_ratio == expected.damping_ratio


def test_a_transient_has_the_settings_of_a_case() -> None:
    found, transient = TransientPlan(10), said().case.transient
    assert transient is not None
    assert found.discarded == 5.0
    assert not differences(replace(found, discard=found.discarded), transient.build(), "plan")
