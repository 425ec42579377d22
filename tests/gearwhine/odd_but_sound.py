"""Sixty odd but sound machines, each a bundled case changed in places, and why it is sound."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from typing import Any

STEEL = {"youngs_modulus": "206 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}


def bundled(name: str) -> dict[str, Any]:
    """Return the tables of a bundled case without its provenance, whose keys changes may remove."""
    document = tomllib.loads(files("gearwhine.cases").joinpath(f"{name}.toml").read_text(encoding="utf-8"))
    document.pop("provenance", None)
    return document


def gear(name: str, teeth: int, **changes: Any) -> dict[str, Any]:
    """Return a gear of 2 mm module, 20 mm wide, with a bore of half its reference diameter."""
    bore = f"{teeth} mm" if teeth >= 20 else "8 mm"
    return {"name": name, "teeth": teeth, "module": "2 mm", "face_width": "20 mm", "bore": bore} | changes


def pair(first: dict[str, Any], second: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """Return a case of two gears without shafts."""
    mesh = {"driver": first["name"], "driven": second["name"], "stiffness": {"model": "potential-energy"}} | changes
    operation = {"speed": "1500 rpm", "torque": "50 N*m"}
    return {"material": {"steel": STEEL}, "gear": [first, second], "gear_pair": [mesh], "operation": operation}


def helical(angle: float, **changes: Any) -> dict[str, Any]:
    """Return a helical pair of 20 and 40 teeth."""
    hands = (f"{sign}{angle} deg" for sign in ("", "-"))
    first, second = (
        gear(name, teeth, helix_angle=hand, bore=bore)
        for name, teeth, hand, bore in zip(("p", "w"), (20, 40), hands, ("8 mm", "24 mm"), strict=True)
    )
    return pair(first | changes, second | changes)


def shaft(diameter: str = "50 mm", length: str = "1 m", **changes: Any) -> dict[str, Any]:
    """Return a case of one shaft on two grounded bearings."""
    rotor = {"name": "s", "material": "steel", "segments": [{"length": length, "diameter": diameter}]} | changes
    ends = (("l", "0 mm"), ("r", length))
    bearings = [{"name": n, "rotor": "s", "at": at, "stiffness": {"xx": "1e7 N/m", "yy": "1e7 N/m"}} for n, at in ends]
    return {
        "material": {"steel": STEEL},
        "rotor": [rotor],
        "bearing": bearings,
        "operation": {"speed": "3000 rpm"},
    }


def bearing(name: str = "m", at: str = "0.5 m", **changes: Any) -> dict[str, Any]:
    """Return one more bearing of that shaft."""
    return {"name": name, "rotor": "s", "at": at} | changes


def with_bearing(case: dict[str, Any], *more: dict[str, Any]) -> dict[str, Any]:
    """Return the case with further bearings."""
    return case | {"bearing": [*case["bearing"], *more]}


def ball(**changes: Any) -> dict[str, Any]:
    """Return the stiffness of a 6210."""
    size = {"type": "deep-groove", "bore": "50 mm", "outer_diameter": "90 mm", "width": "20 mm"}
    return {"rolling": {"catalogue": size} | changes}


def on_balls(**operation: Any) -> dict[str, Any]:
    """Return a shaft on two ball bearings without gears."""
    case = shaft(length="0.2 m")
    stiffness = (ball(), ball(floating=True))
    bearings = [one | {"stiffness": by} for one, by in zip(case["bearing"], stiffness, strict=True)]
    return case | {"bearing": bearings, "operation": {"speed": "1500 rpm"} | operation}


def changed(name: str, *changes: tuple[str, Any]) -> dict[str, Any]:
    """Return a bundled case with values set at dotted paths."""
    document = bundled(name)
    for path, value in changes:
        *way, last = [int(step) if step.isdecimal() else step for step in path.split(".")]
        here: Any = document
        for step in way:
            here = here[step]
        here[last] = value
    return document


DAMPER = {"stiffness": {"xx": 0, "yy": 0}, "damping": {"xx": "2e4 N*s/m", "yy": "2e4 N*s/m"}}
SEAL = {
    "stiffness": {"xx": "-1e6 N/m", "yy": "-1e6 N/m", "xy": "2e5 N/m", "yx": "-2e5 N/m"},
    "damping": {"xx": "800 N*s/m", "yy": "800 N*s/m"},
}
MAGNETIC = [[f"{k} {unit}" for k, unit in row] for row in [
    [(-5e5, "N/m"), (0, "N/m"), (0, "N/m"), (0, "N/rad"), (0, "N/rad")],
    [(0, "N/m"), (-5e5, "N/m"), (0, "N/m"), (0, "N/rad"), (0, "N/rad")],
    [(0, "N/m"), (0, "N/m"), (-1e5, "N/m"), (0, "N/rad"), (0, "N/rad")],
    [(0, "N/rad"), (0, "N/rad"), (0, "N/rad"), (0, "N*m/rad"), (0, "N*m/rad")],
    [(0, "N/rad"), (0, "N/rad"), (0, "N/rad"), (0, "N*m/rad"), (0, "N*m/rad")],
]]  # fmt: skip
LUMPED = {"mass": "4 kg", "polar_inertia": "0.02 kg*m^2"}

MACHINES: dict[str, dict[str, Any]] = {
    # helical teeth carry without break by their overlap, ISO 21771: the total contact ratio is the sum
    "helix of 45 degrees": helical(45),
    "helix of 48 degrees": helical(48),
    "helix of 50 degrees": helical(50),
    "helix of 55 degrees, wide": helical(55, face_width="40 mm"),
    "axial overlap of one exactly": helical(15, face_width="24.28 mm"),
    "narrow helical face": helical(10, face_width="8 mm"),
    # profile shifts within pointing
    "shift of 0.9 on 40 teeth": pair(gear("p", 40, profile_shift=0.9), gear("w", 60)),
    "shift of 1.1 on 80 teeth": pair(gear("p", 80, profile_shift=1.1), gear("w", 60, addendum=0.9)),
    "all recess action": pair(gear("p", 24, profile_shift=1.0, addendum=1.0), gear("w", 90, profile_shift=-1.0)),
    "ten teeth, shifted": pair(gear("p", 10, profile_shift=0.5), gear("w", 40)),
    "undercut, taken as it is": pair(
        gear("p", 14, allow_undercut=True), gear("w", 40, addendum=0.8)
    ),
    "long addendum, high contact ratio": pair(
        gear("p", 45, addendum=1.25, dedendum=1.5), gear("w", 60, addendum=1.25, dedendum=1.5)
    ),
    "stub teeth": pair(gear("p", 20, addendum=0.8, dedendum=1.0), gear("w", 40, addendum=0.8, dedendum=1.0)),
    "pressure angle of 14.5 degrees": pair(
        gear("p", 40, pressure_angle="14.5 deg"), gear("w", 80, pressure_angle="14.5 deg")
    ),
    "pressure angle of 28 degrees": pair(
        gear("p", 18, pressure_angle="28 deg", dedendum=1.2), gear("w", 40, pressure_angle="28 deg", dedendum=1.2)
    ),
    # bodies
    "small bore in a large wheel": pair(gear("p", 20), gear("w", 90, bore="20 mm")),
    "tiny bore": pair(gear("p", 20), gear("w", 90, bore="6 mm")),
    "thin ring, by the exact elastic ring": pair(
        gear("p", 20), gear("w", 90, bore="155 mm"), stiffness={"model": "elastic-ring"}
    ),
    "plastic gears": pair(gear("p", 20), gear("w", 40))
    | {"material": {"steel": STEEL | {"youngs_modulus": "2.7 GPa", "density": "1410 kg/m^3", "poisson_ratio": 0.38}}},
    "magnesium": pair(gear("p", 20), gear("w", 40))
    | {"material": {"steel": STEEL | {"youngs_modulus": "45 GPa", "density": "1770 kg/m^3"}}},
    "tungsten carbide": pair(gear("p", 20), gear("w", 40))
    | {"material": {"steel": STEEL | {"youngs_modulus": "620 GPa", "density": "14900 kg/m^3", "poisson_ratio": 0.22}}},
    "fine module": pair(
        *(gear(n, z, module="0.2 mm", face_width="2 mm", bore="1.5 mm") for n, z in (("p", 20), ("w", 60)))
    )
    | {"operation": {"speed": "12000 rpm", "torque": "2 N*mm"}},
    "module of 30 mm": pair(
        *(gear(n, z, module="30 mm", face_width="400 mm", bore="300 mm") for n, z in (("p", 20), ("w", 60)))
    )
    | {"operation": {"speed": "6 rpm", "torque": "150 kN*m"}},
    "2000 teeth": pair(gear("p", 40), gear("w", 2000, bore="1 m")),
    "large backlash on purpose": pair(gear("p", 20), gear("w", 40), backlash="0.4 mm"),
    "no damping": pair(gear("p", 20), gear("w", 40), damping_ratio=0.0),
    "teeth thinned for backlash": pair(gear("p", 20, tooth_thinning="0.1 mm"), gear("w", 40)),
    "braked by its torque": pair(gear("p", 20), gear("w", 40), backlash="0.1 mm")
    | {"operation": {"speed": "1500 rpm", "torque": "-50 N*m"}},
    "idle": pair(gear("p", 20), gear("w", 40)) | {"operation": {"speed": "1500 rpm", "torque": 0}},
    "turned backwards": pair(gear("p", 20), gear("w", 40)) | {"operation": {"speed": "-1500 rpm", "torque": "9 N*m"}},
    # bearings
    "damper without stiffness": with_bearing(shaft(), bearing(**DAMPER)),
    "seal of negative stiffness": with_bearing(shaft(), bearing(**SEAL)),
    "magnetic bearing": with_bearing(shaft(), bearing(stiffness={"matrix": MAGNETIC})),
    "stiff one way, free the other": with_bearing(shaft(), bearing(stiffness={"xx": "1e7 N/m", "yy": 0})),
    "oil film of strong cross-coupling": with_bearing(
        shaft(), bearing(stiffness={"xx": "1e7 N/m", "yy": "2e7 N/m", "xy": "1.5e7 N/m", "yx": "-9e6 N/m"})
    ),
    "belt on ball bearings": on_balls(force=[{"rotor": "s", "at": "0.1 m", "y": "-4000 N"}]),
    "weight on ball bearings": on_balls(gravity=[0, "-9.81 m/s^2", 0]),
    "thrust on ball bearings": on_balls(
        force=[{"rotor": "s", "at": "0.1 m", "y": "-900 N"}, {"rotor": "s", "at": 0, "z": "500 N"}]
    ),
    "very soft bearings": shaft() | {
        "bearing": [one | {"stiffness": {"xx": "2e3 N/m", "yy": "2e3 N/m"}} for one in shaft()["bearing"]]
    },
    "two bearings side by side": with_bearing(
        shaft(), bearing("l2", "50 mm", stiffness={"xx": "1e7 N/m", "yy": "1e7 N/m"})
    ),
    "one bearing, overhung at both ends": shaft() | {
        "bearing": [bearing("m", stiffness={"matrix": [
            ["1e8 N/m", 0, 0, 0, 0], [0, "1e8 N/m", 0, 0, 0], [0, 0, "1e8 N/m", 0, 0],
            [0, 0, 0, "1e5 N*m/rad", 0], [0, 0, 0, 0, "1e5 N*m/rad"]]})]
    },
    "a free shaft": shaft() | {"bearing": []},
    # shafts
    "hollow shaft": shaft(segments=[{"length": "1 m", "diameter": "80 mm", "bore": "70 mm"}]),
    "cone": shaft(segments=[{"length": "1 m", "diameter": "30 mm", "right_diameter": "60 mm"}]),
    "stepped shaft": shaft(segments=[{"length": "0.5 m", "diameter": d} for d in ("40 mm", "160 mm")]),
    "long thin shaft": shaft("20 mm", "6 m"),
    "short thick shaft": shaft("300 mm", "0.2 m"),
    "lumped mass": shaft(mass="lumped", segments=[{"length": "0.1 m", "diameter": "50 mm"}] * 10),
    "composite shaft": shaft()
    | {"material": {"steel": {"youngs_modulus": "120 GPa", "poisson_ratio": 0.3, "density": "1600 kg/m^3"}}},
    "massless shaft with a disc": shaft(discs=[{"at": "0.5 m", **LUMPED, "diametral_inertia": "0.01 kg*m^2"}])
    | {"material": {"steel": STEEL | {"density": "1 kg/m^3"}}},
    "point mass": shaft(discs=[{"at": "0.5 m", "mass": "4 kg"}]),
    "thin disc": shaft(discs=[{"at": "0.5 m", **LUMPED, "diametral_inertia": "0.01 kg*m^2"}]),
    "printed inertias of a thin disc": shaft(
        discs=[{"at": "0.5 m", "mass": "4 kg", "polar_inertia": "0.0201 kg*m^2", "diametral_inertia": "0.01 kg*m^2"}]
    ),
    "long drum": shaft(discs=[{"at": "0.5 m", "width": "300 mm", "diameter": "200 mm", "bore": "50 mm"}]),
    "overhung disc": shaft(discs=[{"at": "1 m", "width": "40 mm", "diameter": "400 mm"}]),
    "axial pull": shaft(axial_force="20 kN"),
    # machines
    "gear overhung past its bearing": changed(
        "spur-pair", ("gear.0.at", "196 mm"), ("gear.1.at", "196 mm"), ("bearing.1.at", "150 mm"),
        ("bearing.3.at", "150 mm"),
    ),
    "gears half out of line": changed("spur-pair", ("gear.1.at", "102 mm")),
    "no bores: gears cut into their shafts": changed("spur-pair", ("gear.0.bore", 0), ("gear.1.bore", 0)),
    "shaft through the wall, twice as long": changed(
        "small-gearbox", ("rotor.0.segments.1.length", "300 mm")
    ),
    "gear with tip relief of 60 um": changed("spur-pair", ("gear.0.tip_relief.amount", "60 um")),
    "housing of aluminium": changed(
        "steel-box", ("material.steel", {"youngs_modulus": "70 GPa", "poisson_ratio": 0.33, "density": 2700})
    ),
    "housing on the softest feet": changed(
        "small-gearbox", *((f"housing.support.{i}.stiffness", {"x": "1e5 N/m", "y": "1e5 N/m", "z": "1e5 N/m"})
                           for i in range(4))
    ),
    "torque of a feather": changed("spur-pair", ("operation.torque", "0.01 N*m")),
    "turbo gear": changed("spur-pair", ("operation.speed", "30000 rpm"), ("operation.torque", "20 N*m")),
}  # fmt: skip
