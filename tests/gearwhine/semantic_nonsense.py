"""A hundred machines that cannot be, or hardly are: bundled cases changed in a few places, formally right.

Each names the kind of nonsense; none may be silent.
"""

from __future__ import annotations

import copy
from typing import Any

from odd_but_sound import bundled, changed, gear, pair, shaft

SPUR, BOX, GEARBOX, ROTOR = "spur-pair", "steel-box", "small-gearbox", "friswell-rotor"
PINION_BEARING = {"name": "copy", "rotor": "input", "at": "60 mm", "stiffness": {"xx": "1e8 N/m", "yy": "1e8 N/m"}}


def more(name: str, key: str, *entries: dict[str, Any], **keys: Any) -> dict[str, Any]:
    """Return a bundled case with further entries in a list, and other values at dotted paths (`__` for dots)."""
    document = changed(name, *((path.replace("__", "."), value) for path, value in keys.items()))
    document[key] = [*document.get(key, ()), *entries]
    return document


def rolling(**changes: Any) -> dict[str, Any]:
    """Return the spur pair with one rolling bearing by its geometry."""
    row = {"count": 9, "element_diameter": "8 mm", "pitch_diameter": "46 mm"} | changes
    return changed(SPUR, ("bearing.0.stiffness", {"rolling": row}), ("bearing.0.load", {"y": "-900 N"}))


def disc(**changes: Any) -> dict[str, Any]:
    """Return a shaft with a disc."""
    return shaft(discs=[{"at": "0.5 m"} | changes])


def teeth(**changes: Any) -> dict[str, Any]:
    """Return a pair whose pinion is changed."""
    return pair(gear("p", 20, **changes), gear("w", 40))


def operated(**operation: Any) -> dict[str, Any]:
    """Return a pair of gears in another operation."""
    case = pair(gear("p", 20), gear("w", 40))
    return case | {"operation": case["operation"] | operation}


def of_steel(base: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """Return a case with other numbers of its steel."""
    case = copy.deepcopy(base)
    for material in case["material"].values():
        material.update(changes)
    return case


def idle(at: str, **changes: Any) -> dict[str, Any]:
    """Return a third gear on the input shaft of the spur pair."""
    return {"name": "idle", "rotor": "input", "at": at, "teeth": 28, "module": "3.175 mm", "face_width": "6.35 mm"} | (
        changes
    )


def renamed(name: str) -> dict[str, Any]:
    """Return the spur pair whose output shaft has another name."""
    return changed(
        SPUR,
        ("rotor.1.name", name),
        ("bearing.2.rotor", name),
        ("bearing.3.rotor", name),
        ("gear.1.rotor", name),
    )


TIP = "gear.0.tip_relief"
NONSENSE: dict[str, dict[str, Any]] = {
    # materials a thousand times off
    "steel in MPa": of_steel(bundled(BOX), youngs_modulus="207 MPa"),
    "steel of 207": of_steel(bundled(BOX), youngs_modulus=207),
    "steel of 207 kPa": of_steel(bundled(SPUR), youngs_modulus="207 kPa"),
    "steel of 207 TPa": of_steel(bundled(SPUR), youngs_modulus="207 TPa"),
    "density in g/cm3": of_steel(bundled(BOX), density=7.85),
    "density a thousand times": of_steel(bundled(SPUR), density="7850 g/cm^3"),
    "shaft of air": of_steel(shaft(), density=1.2),
    "incompressible steel": of_steel(bundled(BOX), poisson_ratio=0.49999),
    "gears of rubber": of_steel(teeth(), youngs_modulus="5 MPa"),
    "gears lighter than cork": of_steel(teeth(), density="100 kg/m^3"),
    # shafts and discs
    "shaft as thick as the root circle": changed(SPUR, ("rotor.0.segments.0.diameter", "81 mm")),
    "shaft through the other shaft": changed(SPUR, *((f"rotor.{i}.segments.0.diameter", "95 mm") for i in (0, 1))),
    "shaft through the other's gear": more(
        SPUR, "gear", idle("150 mm") | {"rotor": "output"}, rotor__0__segments__1__diameter="84 mm",
    ),
    "shaft in metres": changed(SPUR, *((f"rotor.0.segments.{i}", {"length": 100, "diameter": 30}) for i in (0, 1))),
    "disc through the other shaft": changed(
        SPUR, ("rotor.0.discs", [{"at": "60 mm", "width": "9 mm", "diameter": "150 mm"}])
    ),
    "disc through the gear": changed(
        SPUR, ("rotor.0.discs", [{"at": "101 mm", "width": "9 mm", "diameter": "60 mm", "bore": "30 mm"}])
    ),
    "disc wider than the shaft is long": disc(width="1.5 m", diameter="200 mm"),
    "disc of too much polar inertia": disc(mass="4 kg", polar_inertia="0.03 kg*m^2", diametral_inertia="0.01 kg*m^2"),
    "disc of no diametral inertia": disc(mass="4 kg", polar_inertia="0.02 kg*m^2"),
    "disc of a gram and a tonne": disc(mass="1 g", polar_inertia="9 kg*m^2", diametral_inertia="5 kg*m^2"),
    "disc of 7.85 kg/m3": disc(width="50 mm", diameter="0.3 m", density="7.85 kg/m^3"),
    "disc of 10 g/m3": disc(width="50 mm", diameter="0.3 m", density="10 g/m^3"),
    "unbalance in g mm": changed(SPUR, ("rotor.0.unbalance.0.moment", 20)),
    "unbalance as heavy as the rotor": changed(SPUR, ("rotor.0.unbalance.0.moment", "0.08 kg*m")),
    "unbalance of a tenth of the radius": changed(SPUR, ("rotor.0.unbalance.0.moment", "0.01 kg*m")),
    "shaft damped by 99 %": shaft(damping_ratio=0.99),
    "shaft damped by a third": changed(SPUR, ("rotor.1.damping_ratio", 0.33)),
    # gears in their places
    "gear on the bearing": changed(SPUR, ("gear.0.at", "20 mm"), ("gear.1.at", "20 mm")),
    "gear beside the bearing's middle": changed(SPUR, ("gear.0.at", "22 mm"), ("gear.1.at", "22 mm")),
    "bearing within the gear": more(SPUR, "bearing", PINION_BEARING | {"at": "101 mm"}),
    "gear half off the shaft": changed(SPUR, ("gear.0.at", "200 mm"), ("gear.1.at", "200 mm")),
    "gear at the shaft's left end": changed(SPUR, ("gear.0.at", 0), ("gear.1.at", 0)),
    "two gears in one place": more(SPUR, "gear", idle("100 mm")),
    "two gears that overlap": more(SPUR, "gear", idle("104 mm")),
    "gear through a wheel it does not mesh with": more(SPUR, "gear", idle("94 mm", teeth=30)),
    "gear through the other shaft": more(SPUR, "gear", idle("60 mm", teeth=60)),
    "face of metres": changed(SPUR, ("gear.0.face_width", 6.35), ("gear.1.face_width", 6.35)),
    "face as wide as the shaft": changed(SPUR, ("gear.0.face_width", "190 mm"), ("gear.1.face_width", "190 mm")),
    "face of a hair": changed(SPUR, ("gear.0.face_width", "0.1 mm"), ("gear.1.face_width", "0.1 mm")),
    "face of 70 modules": pair(*(gear(n, z, face_width="140 mm") for n, z in (("p", 20), ("w", 40)))),
    "face of half a module": pair(*(gear(n, z, face_width="1 mm") for n, z in (("p", 20), ("w", 40)))),
    "module of a micrometre's order": pair(
        *(gear(n, z, module="20 um", face_width="0.2 mm", bore="0.1 mm") for n, z in (("p", 20), ("w", 40)))
    ),
    "module of 120 mm": pair(*(gear(n, z, module="120 mm", face_width="2 m") for n, z in (("p", 20), ("w", 40)))),
    "thirty pairs in contact": pair(
        *(gear(n, z, face_width="100 mm", helix_angle=f"{s}35 deg", module="1 mm", bore="8 mm")
          for n, z, s in (("p", 20, ""), ("w", 40, "-")))
    ),
    # flanks
    "relief of 10 mm": changed(SPUR, (f"{TIP}.amount", "10 mm")),
    "relief of half a module": teeth(tip_relief={"amount": "1 mm", "length": "1 mm"}),
    "relief of a tenth of the module": teeth(tip_relief={"amount": "0.2 mm", "length": "1 mm"}),
    "root relief of 2 mm": teeth(root_relief={"amount": "2 mm", "length": "1 mm"}),
    "runout of 20 mm": teeth(errors={"runout": "20 mm"}),
    "eccentricity of a millimetre": teeth(errors={"eccentricity": "1 mm"}),
    "pitch error of a millimetre": teeth(errors={"pitch": ["1 mm", *["0 mm"] * 19]}),
    "spacing error of a millimetre": teeth(errors={"spacing": ["1 mm", *["0 mm"] * 19]}),
    "profile slope of a millimetre": teeth(errors={"profile": {"slope": "1 mm"}}),
    "profile form of 0.3 mm": teeth(errors={"profile": {"form": "0.3 mm"}}),
    "profile crowning of 0.9 mm": teeth(errors={"profile": {"crowning": "0.9 mm"}}),
    "helix slope of a millimetre": teeth(errors={"helix": {"slope": "1 mm"}}),
    "helix crowning of 0.6 mm": teeth(errors={"helix": {"crowning": "0.6 mm"}}),
    "end relief of 5 mm": teeth(errors={"helix": {"end_relief": "5 mm", "end_relief_length": "2 mm"}}),
    # meshes
    "backlash of 10 mm": changed(SPUR, ("gear_pair.0.backlash", "10 mm")),
    "backlash of half a module": changed(SPUR, ("gear_pair.0.backlash", "1.6 mm")),
    "misalignment of 0.1 rad": changed(SPUR, ("gear_pair.0.misalignment", 0.1)),
    "misalignment in degrees": changed(SPUR, ("gear_pair.0.misalignment", "4 deg")),
    "mesh damped by 0.9": changed(SPUR, ("gear_pair.0.damping_ratio", 0.9)),
    # operation
    "torque a hundred times": changed(SPUR, ("operation.torque", 7177)),
    "torque thirty times": changed(SPUR, ("operation.torque", "2150 N*m")),
    "torque in kN m": changed(SPUR, ("operation.torque", "71.77 kN*m")),
    "torque a thousand times, without shafts": operated(torque="50 kN*m"),
    "speed of 500000 rpm": changed(SPUR, ("operation.speed", "500000 rpm")),
    "speed of 60000 rpm": changed(SPUR, ("operation.speed", "60000 rpm")),
    "speed in Hz": operated(speed="5500 Hz"),
    "torque in where it leaves": changed(SPUR, ("operation.rotor", "output")),
    "torque per angle": operated(torque="71.77 N*m/deg"),
    "torque per radian": operated(torque="71.77 N*m/rad"),
    "gravity in mm/s2": changed(SPUR, ("operation.gravity", [0, -9810, 0])),
    "gravity in km/s2": changed(SPUR, ("operation.gravity", [0, "-9.81 mm/s^2", 0])),
    "force from nowhere": changed(SPUR, ("operation.force", [{"rotor": "input", "at": "50 mm", "y": "1e7 N"}])),
    # units
    "length per angle": changed(SPUR, ("gear.0.module", "3.175 mm/deg")),
    "stiffness per angle": changed(SPUR, ("bearing.0.stiffness.xx", "1.2e8 N/m/rad")),
    "mass per angle": disc(mass="4 kg/deg"),
    "inertia per angle": disc(mass="4 kg", polar_inertia="0.02 kg*m^2/rad", diametral_inertia="0.01 kg*m^2"),
    # bearings
    "two bearings in one place": more(SPUR, "bearing", PINION_BEARING | {"at": "20 mm"}),
    "pitch circle inside the shaft": rolling(pitch_diameter="28 mm", element_diameter="6 mm"),
    "inner race inside the shaft": rolling(pitch_diameter="36 mm"),
    "rollers of a metre": rolling(element="roller", element_length="1 m"),
    "interference of 3 mm": rolling(clearance="-3 mm"),
    "balls of a metre": rolling(element_diameter="1 m"),
    "rows that overlap": rolling(arrangement="back to back", spacing="2 mm", contact_angle="25 deg", preload="90 N"),
    "bearing inside the other gear": rolling(pitch_diameter="190 mm") | {
        "gear": [one | {"at": "22 mm"} for one in bundled(SPUR)["gear"]]},
    "bearing that does nothing": changed(SPUR, ("bearing.0", {"name": "b", "rotor": "input", "at": "20 mm",
                                                              "stiffness": {"xx": 0, "yy": 0}})),
    "bearing that pushes": changed(SPUR, ("bearing.0.stiffness.xx", "-1.2e8 N/m")),
    "shaft wider than its seat": changed(GEARBOX, ("housing.seat.0.diameter", "5 mm")),
    "shaft as wide as its seat": changed(GEARBOX, ("housing.seat.1.diameter", "30 mm")),
    # housing
    "housing lower than its gears": changed(
        GEARBOX, ("housing.box.size.1", "100 mm"), ("housing.sensor.0.position.1", "100 mm"),
    ),
    "gears in the side wall": changed(GEARBOX, ("housing.box.size.0", "180 mm"),
                                      ("housing.sensor.1.position.0", "90 mm")),
    "gears in the end wall": changed(GEARBOX, ("gear.0.at", "172 mm"), ("gear.1.at", "172 mm"),
                                     ("bearing.1.at", "185 mm"), ("bearing.3.at", "185 mm")),
    "boss of a metre": changed(GEARBOX, ("housing.seat.0.boss", {"diameter": "70 mm", "length": "1 m"})),
    "wall of foil": changed(GEARBOX, ("housing.box.wall", "0.1 mm")),
    "mass 50 m away": more(BOX, "notes_unused") | {"housing": bundled(BOX)["housing"] | {
        "mass": [{"name": "m", "mass": "1 kg", "surface": "top", "offset": [0, 50, 0]}]}},
    "housing damped by a half": changed(GEARBOX, ("housing.damping_ratio", 0.5)),
    # air
    "air in g/m3": changed(GEARBOX, ("acoustics", {"density": "1.2 g/m^3"})),
    "housing in water": changed(GEARBOX, ("acoustics", {"density": 1000, "speed_of_sound": 1480})),
    "speed of light": changed(GEARBOX, ("acoustics", {"speed_of_sound": "90 km/s"})),
    "sound below all modes": changed(GEARBOX, ("acoustics", {"highest_frequency": "10 Hz"})),
    # names
    "Cyrillic name": renamed("іnput"),
    "name with a blank of no width": renamed("in\u200bput"),
    "names in capitals": renamed("INPUT"),
    "accents apart": changed(
        SPUR, ("gear.0.name", "caf\u00e9"), ("gear.1.name", "cafe\u0301"), ("gear_pair.0.driver", "caf\u00e9"),
        ("gear_pair.0.driven", "cafe\u0301"),
    ),
    "material that looks like another": of_steel(shaft()) | {"material": shaft()["material"] | {
        "stееl": shaft()["material"]["steel"]}},
}  # fmt: skip
for _case in NONSENSE.values():
    _case.pop("notes_unused", None)
