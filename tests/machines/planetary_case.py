"""A case with one planetary stage, its planet written once."""

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
