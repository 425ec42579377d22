"""`[[torque_support]]`: gears and rotors that are held from turning, in a planetary set or without its table."""

import tomllib
from typing import Any

import pytest
from planetary_case import bearings, gear, rotor, stage

from gearwhine.case import CaseError, dump_case, parse_case
from gearwhine.case.checks.whole_case import warnings_of
from gearwhine.from_case.rexs.exporting import rexs_of

BOLTS: dict[str, Any] = {
    "circle": "220 mm",
    "angles": ["0 deg", "120 deg", "240 deg"],
    "tangential_stiffness": "2e8 N/m",
    "radial_stiffness": "1e8 N/m",
}


def held(*supports: dict[str, Any], fixed: Any = None, **operation: Any) -> dict[str, Any]:
    """The stage with supports of its own table in place of those of the set."""
    document = stage(fixed=fixed)
    document["operation"] |= operation
    return document | {"torque_support": list(supports)}


def without_set(*supports: dict[str, Any]) -> dict[str, Any]:
    """Sun 24, two planets 30 that are written each, ring 84, and no table of the set."""
    document = held(*supports)
    del document["planetary"]
    for kind in ("rotor", "gear", "bearing"):
        document[kind] = [one for one in document[kind] if one["name"].split()[0] != "p"]
    for name, y in (("a", "104 mm"), ("b", "-4 mm")):
        document["rotor"].append(rotor(name) | {"axis": ["5 mm", y], "carrier": "carrier"})
        document["bearing"] += [one | {"seat": "carrier"} for one in bearings(name)]
        document["gear"].append(gear(name, name, 30))
    document["gear_pair"] = [
        {"driver": driver, "driven": driven} for planet in "ab" for driver, driven in (("s", planet), (planet, "r"))
    ]
    return document


@pytest.mark.parametrize(
    ("document", "speeds"),
    [
        (held({"member": "r"}), {"carrier": 24 / 108, "ring": 0.0}),
        (held({"member": "ring", "stiffness": "1e7 N*m/rad"}), {"carrier": 24 / 108}),
        (held({"member": "carrier"}), {"ring": -24 / 84}),
        (held({"member": "s"}, rotor="ring"), {"carrier": 84 / 108, "sun": 0.0}),
        # As with the ring that the set holds, power flows from the ring's side to the sun.
        (held({"member": "r"}, rotor="carrier"), {"sun": 108 / 24}),
        (without_set({"member": "r"}), {"carrier": 24 / 108}),
    ],
)
def test_a_support_holds_a_member_of_a_train(document: dict[str, Any], speeds: dict[str, float]) -> None:
    """Willis: z_s ω_s + |z_r| ω_r = (z_s + |z_r|) ω_c."""
    case = parse_case(document)
    machine = case.parts.machine
    assert machine is not None
    assert {name: machine.speeds[name] / machine.speed for name in speeds} == pytest.approx(speeds, abs=1e-12)
    assert case.parts.speeds == pytest.approx(machine.speeds, rel=1e-12)
    assert parse_case(tomllib.loads(dump_case(case))) == case


def test_stations_and_stiffness_of_a_support() -> None:
    support = {"member": "r", "stiffness": "1e7 N*m/rad", "damping_time": "1e-5 s"}
    for given, at in ((support, 0.03), (support | {"member": "ring"}, 0.0), (support | {"at": "12 mm"}, 0.012)):
        machine = parse_case(held(given)).parts.machine
        assert machine is not None
        (found,) = machine.torque_supports
        assert (found.shaft, found.at, found.stiffness, found.seat) == ("ring", at, 1e7, None)
        assert found.damping_time == 1e-5


def test_bolts_hold_a_ring_without_bearings() -> None:
    document = held({"member": "r", "bolts": BOLTS})
    document["bearing"] = [one for one in document["bearing"] if one["rotor"] != "ring"]
    assert not [told for told in warnings_of(parse_case(document)) if "floats freely" in told]
    document["torque_support"] = [{"member": "r", "stiffness": "1e7 N*m/rad"}]
    assert [told for told in warnings_of(parse_case(document)) if '"ring"' in told and "floats freely" in told]


@pytest.mark.parametrize(
    ("support", "key", "expected"),
    [
        ({"member": "rng"}, "torque_support[0].member", "the name of a gear or rotor of this case"),
        ({"member": "p 2"}, "torque_support[0].member", 'a planet, whose axis turns with "carrier"'),
        ({"member": "r", "seat": "front"}, "torque_support[0].seat", "seat"),
        ({"member": "r", "at": "61 mm"}, "torque_support[0].at", "60 mm"),
        ({"member": "r", "stiffness": "1 N*m/rad", "bolts": BOLTS}, "torque_support[0].stiffness", "none beside"),
        ({"stiffness": "1 N*m/rad"}, "torque_support[0].member", "expected"),
        ({"member": "r", "stifness": "1 N*m/rad"}, "torque_support[0].stifness", "did you mean 'stiffness'"),
    ],
)
def test_no_such_support(support: dict[str, Any], key: str, expected: str) -> None:
    with pytest.raises(CaseError) as refused:
        parse_case(held(support))
    told = str(refused.value)
    assert key in told
    assert expected in told
    # What cannot be read proves nothing of the train.
    assert key.endswith("member") or "held by a torque support" not in told


def test_members_that_are_held_twice_cannot_turn() -> None:
    with pytest.raises(CaseError, match="held"):
        parse_case(held({"member": "carrier"}, fixed="r"))
    with pytest.raises(CaseError, match=r"planetary\[0\].fixed.at.*60 mm"):
        parse_case(stage(fixed={"member": "r", "at": "61 mm"}))


def test_a_support_goes_out_as_a_coupling_to_the_casing() -> None:
    model = rexs_of(parse_case(held({"member": "r", "stiffness": "1e6 N*m/rad", "at": "12 mm"}))).model
    (coupling,) = (one for one in model.components.values() if one.kind == "coupling")
    assert coupling.name == 'torque support of "r"'
    assert coupling.attributes["rotational_stiffness"].value == pytest.approx(1e9)  # N mm/rad
