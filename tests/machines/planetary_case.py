"""A case with one planetary stage, its planet written once."""

import math
from typing import Any

STEEL = {"youngs_modulus": "207 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}


def rotor(name: str, start: str = "0 mm", diameter: str = "24 mm", **more: Any) -> dict[str, Any]:
    bore = {"bore": more.pop("bore")} if "bore" in more else {}
    segment = {"length": "60 mm", "diameter": diameter, **bore}
    axis = {} if name == "p" else {"axis": ["5 mm", "50 mm"]}
    return {"name": name, "start": start, "material": "steel", "segments": [segment], **axis, **more}


def bearings(of: str) -> list[dict[str, Any]]:
    stiffness = {"xx": "1e8 N/m", "yy": "1e8 N/m"}
    places = [("left", "5 mm"), ("right", "55 mm")]
    return [{"name": f"{of} {end}", "rotor": of, "at": at, "stiffness": stiffness} for end, at in places]


def gear(name: str, of: str, teeth: int, **more: Any) -> dict[str, Any]:
    size = {"teeth": teeth, "module": "2 mm", "face_width": "20 mm"}
    return {"name": name, "rotor": of, "at": "30 mm", **size, **more}


def stage(**of_set: Any) -> dict[str, Any]:
    """Sun 24, planets 30, ring 84 teeth; the ring held, unless the set's table says otherwise."""
    table = {"name": "stage", "sun": "s", "ring": "r", "planets": ["p"], "count": 3, "carrier": "carrier", "fixed": "r"}
    return {
        "material": {"steel": STEEL},
        "rotor": [
            rotor("sun"),
            rotor("p"),
            rotor("ring", diameter="230 mm", bore="200 mm"),
            rotor("carrier", start="90 mm", diameter="50 mm"),
        ],
        "bearing": [each for of in ("sun", "p", "ring", "carrier") for each in bearings(of)],
        "gear": [gear("s", "sun", 24), gear("p", "p", 30), gear("r", "ring", -84, addendum=0.8)],
        "planetary": [{key: value for key, value in {**table, **of_set}.items() if value is not None}],
        "operation": {"speed": "3000 rpm", "torque": "50 N*m"},
    }


def ravigneaux() -> dict[str, Any]:
    """Small sun 24, short planets 18, long planets 21 with two gears, large sun 33, ring 75; the carrier held."""
    apart = math.acos((42.0**2 + 54.0**2 - 39.0**2) / (2.0 * 42.0 * 54.0))
    short, long = rotor("short") | {"axis": [0.047, 0.05]}, rotor("long")
    long["axis"] = [0.005 + 0.054 * math.cos(apart), 0.05 + 0.054 * math.sin(apart)]
    document = stage(fixed="carrier", sun="s", planets=["short", "front"])
    document["rotor"] = [
        *(one for one in document["rotor"] if one["name"] != "p"),
        short,
        long,
        rotor("large", "40 mm"),
    ]
    document["bearing"] = [each for one in document["rotor"] for each in bearings(one["name"])]
    for name, length, places in (("sun", 35, (5, 30)), ("short", 35, (5, 30)), ("large", 45, (25, 40))):
        next(one for one in document["rotor"] if one["name"] == name)["segments"][0]["length"] = f"{length} mm"
        for each, at in zip((one for one in document["bearing"] if one["rotor"] == name), places, strict=True):
            each["at"] = f"{at} mm"
    front, back = {"at": "15 mm", "face_width": "15 mm"}, {"at": "48 mm", "face_width": "15 mm"}
    document["gear"] = [
        gear("s", "sun", 24, **front),
        gear("short", "short", 18, **front),
        gear("front", "long", 21, **front),
        gear("back", "long", 21, **back),
        gear("l", "large", 33, **(back | {"at": "8 mm"})),
        gear("r", "ring", -75, addendum=0.8, **front),
    ]
    second = {
        "name": "second",
        "sun": "l",
        "ring": "r",
        "planets": [f"back {n}" for n in (1, 2, 3)],
        "carrier": "carrier",
    }
    document["planetary"].append(second | {"ring": None, "fixed": None})
    document["planetary"][1] = {key: value for key, value in document["planetary"][1].items() if value is not None}
    return document


def stepped_stage() -> dict[str, Any]:
    """Sun 24 and large gears 36 of the planets, their small gears 18 and the ring 78, which is held."""
    document = stage(planets=["p", "q"])
    document["rotor"][1] = rotor("p") | {"segments": [{"length": "90 mm", "diameter": "24 mm"}]}
    small = gear("q", "p", 18) | {"at": "70 mm"}
    document["gear"] = [gear("s", "sun", 24), gear("p", "p", 36), small, gear("r", "ring", -78, addendum=0.8)]
    document["rotor"][2]["start"], document["rotor"][3]["start"] = "40 mm", "110 mm"
    next(one for one in document["bearing"] if one["name"] == "p right")["at"] = "85 mm"
    return document


def double_stage() -> dict[str, Any]:
    """Sun 24, planets 18 and 21 in mesh with each other, ring 75, which is held."""
    document = ravigneaux()
    document["planetary"] = [document["planetary"][0] | {"fixed": "r"}]
    for kind, of in (("rotor", "name"), ("bearing", "rotor"), ("gear", "rotor")):
        document[kind] = [one for one in document[kind] if one[of] != "large" and one["name"] != "back"]
    return document
