"""Planetary sets in a case: planets written once, members held, what `check` tells, and refusals at keys."""

import json
import math
from typing import Any

import pytest
from planetary_case import bearings, gear, rotor, stage

import gearwhine as gw
from gearwhine.case import CaseError, dump_case, parse_case
from gearwhine.case.model import Case
from gearwhine.results.check import check_document, sections, summary


def read(document: dict[str, Any]) -> Case:
    return parse_case(document)


@pytest.fixture(scope="module")
def case() -> Case:
    return read(stage(pin_errors=["20 um", ["1 um", "2 um"], "0 um"]))


def test_a_planet_that_is_written_once_is_mounted_count_times(case: Case) -> None:
    planets = [one for one in case.rotor if one.carrier is not None]
    assert [one.name for one in planets] == ["p 1", "p 2", "p 3"]
    for number, one in enumerate(planets):
        angle = 2.0 * math.pi * number / 3.0
        assert one.axis == pytest.approx((0.005 + 0.054 * math.cos(angle), 0.05 + 0.054 * math.sin(angle)), abs=1e-15)
    assert [one.pin_error for one in planets] == [(0.0, 20e-6), (1e-6, 2e-6), (0.0, 0.0)]
    assert [(one.driver, one.driven) for one in case.gear_pair] == [
        *(("s", f"p {n}") for n in (1, 2, 3)),
        *((f"p {n}", "r") for n in (1, 2, 3)),
    ]
    assert {one.seat for one in case.bearing if one.rotor.startswith("p")} == {"carrier"}
    machine = case.parts.machine
    assert machine is not None
    assert [one.shaft for one in machine.torque_supports] == ["ring"]
    assert machine.placed_sets[0].angles == pytest.approx([0.0, 2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0])


def test_pairs_that_the_file_has_are_taken_and_the_others_made() -> None:
    document = stage()
    document["gear_pair"] = [{"driver": "s", "driven": "p", "friction": 0.05}]
    pairs = read(document).gear_pair
    assert [(one.driver, one.driven, one.friction) for one in pairs] == [
        *(("s", f"p {n}", 0.05) for n in (1, 2, 3)),
        *((f"p {n}", "r", 0.0) for n in (1, 2, 3)),
    ]


def test_the_resolved_case_is_the_same_case(case: Case) -> None:
    import tomllib

    again = read(tomllib.loads(dump_case(case)))
    assert again.rotor == case.rotor
    assert again.gear_pair == case.gear_pair
    assert again.planetary == case.planetary
    assert again.planetary[0].count is None


def test_check_tells_members_places_and_phases(case: Case) -> None:
    document = check_document(case)
    (one,) = document["planetary"]
    members = {member["name"]: member for member in one["members"]}
    assert members["carrier"]["speed_rpm"] == pytest.approx(3000.0 * 24 / 108, rel=1e-12)
    assert members["ring"]["torque_n_m"] == pytest.approx(50.0 * 84 / 24, rel=1e-12)
    assert members["carrier"]["power_w"] == pytest.approx(-members["sun"]["power_w"], rel=1e-12)
    assert one["assembly_number"] == 108
    assert one["clearance_m"] == pytest.approx(0.054 * math.sqrt(3.0) - 0.064, rel=1e-9)
    assert [row["suppressed_modes"] for row in one["mesh_harmonics"]] == [["translational"]] * 6
    text = "\n".join(str(line) for section in sections(document) for line in (section.note, *section.content))
    assert "ring held, +0 rpm, +175 N·m; carrier driven, +666.667 rpm, -225 N·m" in text
    assert "planets at 0, 120, 240°, of 108 places at which teeth fit; neighbours 29.53 mm clear" in text
    assert "; 15.71 kW enter, 12.22 kW pass through the meshes" in text
    assert "mesh harmonics 1, 2, 3, 4, 5, 6 excite rotational modes" in text
    json.dumps(document)


def test_meshes_that_are_alike_by_symmetry_are_one_line() -> None:
    """Meshes of another set, and one whose teeth have another law, stay apart."""
    document = stage()
    document["gear_pair"] = [{"driver": "s", "driven": "p"}]
    found = check_document(read(document))

    def lines(told: Any) -> list[str]:
        (section,) = [one for one in told if one.title == "gear pairs"]
        return [str(line).strip() for line in (section.note, *section.content)]

    first, second = lines(summary(found))
    assert first.startswith("s → p 1, p 2, p 3: 24 : 30 teeth, ")
    assert second.startswith("p 1, p 2, p 3 → r: 30 : -84 teeth, ")
    told = lines(sections(found))
    assert [line for line in told if " → " in line] == [told[0], told[len(told) // 2]]
    assert sum(line.startswith("p 1, p 2, p 3: 30 teeth") for line in told) == 2
    # All six are in the document, and so is what sets two of them apart.
    assert len(found["gear_pairs"]) == 6
    found["gear_pairs"][1]["stiffness_model"] = "another"
    assert [line.split(":")[0] for line in lines(summary(found))] == ["s → p 1, p 3", "s → p 2", "p 1, p 2, p 3 → r"]
    assert len(lines(summary(found | {"planetary": []}))) == 6


@pytest.mark.parametrize(
    ("fixed", "operation", "speeds"),
    [
        ("carrier", {}, {"ring": -24 / 84}),
        ("s", {"rotor": "ring"}, {"ring": 1.0, "carrier": 84 / 108, "sun": 0.0}),
        ("r", {"rotor": "carrier"}, {"carrier": 1.0, "sun": 108 / 24}),
        ("1e7 N*m/rad", {}, {"carrier": 24 / 108}),
        ({"member": "ring", "stiffness": "1e7 N*m/rad", "at": "10 mm"}, {}, {"carrier": 24 / 108}),
        (None, {"drive": [{"rotor": "ring", "speed": "-600 rpm"}]}, {"carrier": (24 - 84 / 5) / 108}),
    ],
)
def test_members_that_are_held_or_driven(fixed: Any, operation: dict[str, Any], speeds: dict[str, float]) -> None:
    """Willis: z_s ω_s + |z_r| ω_r = (z_s + |z_r|) ω_c."""
    document = stage(fixed=fixed)
    document["operation"] |= operation
    parts = read(document).parts
    machine = parts.machine
    assert machine is not None
    assert parts.speeds == pytest.approx(machine.speeds, rel=1e-12)
    found = {name: machine.speeds[name] / machine.speed for name in speeds}
    assert found == pytest.approx(speeds, rel=1e-12, abs=1e-12)
    if isinstance(fixed, dict):
        assert (machine.torque_supports[0].at, machine.torque_supports[0].stiffness) == (0.01, 1e7)
    power = sum(torque.value * machine.speeds[torque.rotor] for torque in machine.constant_torques)
    assert power == pytest.approx(0.0, abs=1e-9 * 50.0 * 314.0)


def test_planets_that_are_named_each() -> None:
    document = stage(planets=["a", "b"], count=None)
    for name, y in (("a", "104 mm"), ("b", "-4 mm")):
        document["rotor"].append(rotor(name) | {"axis": ["5 mm", y]})
        document["bearing"] += bearings(name)
        document["gear"].append(gear(name, name, 30))
    for kind in ("rotor", "gear", "bearing"):
        document[kind] = [one for one in document[kind] if one["name"].split()[0] != "p"]
    case = read(document)
    assert [one.carrier for one in case.rotor if one.name in "ab"] == ["carrier", "carrier"]
    assert case.parts.placed_sets[0].angles == pytest.approx([0.5 * math.pi, 1.5 * math.pi])


def test_a_set_behind_a_parallel_stage_and_key_paths_to_a_planet() -> None:
    document = stage()
    document["rotor"].append(rotor("input", start="-100 mm") | {"axis": ["5 mm", "120 mm"]})
    document["bearing"] += bearings("input")
    document["rotor"][0]["start"] = "-100 mm"
    document["rotor"][0]["segments"] = [{"length": "160 mm", "diameter": "24 mm"}]
    document["bearing"][1]["at"] = "100 mm"
    document["gear"][0]["at"] = "130 mm"
    document["gear"] += [gear("pinion", "input", 20), gear("wheel", "sun", 50)]
    document["gear_pair"] = [{"driver": "pinion", "driven": "wheel"}]
    document["provenance"] = {"gear.p.teeth": "published", 'rotor."p".segments': "nominal"}
    case = read(document)
    assert case.parts.speeds["carrier"] == pytest.approx(case.parts.speeds["input"] * -20 / 50 * 24 / 108, rel=1e-12)
    assert set(case.provenance) == {
        *(f'gear."p {n}".teeth' for n in (1, 2, 3)),
        *(f'rotor."p {n}".segments' for n in (1, 2, 3)),
    }


def test_a_ravigneaux_set_of_two_sets_that_share_planets_and_ring() -> None:
    """Small sun 24, short 18, long 21, large sun 33, ring 75; ratios by the stationary ratios 75/24 and -75/33."""
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
    parts = read(document).parts
    assert parts.speeds["ring"] / parts.speeds["sun"] == pytest.approx(24 / 75, rel=1e-12)
    assert parts.speeds["large"] / parts.speeds["ring"] == pytest.approx(-75 / 33, rel=1e-12)
    assert [len(one.meshes) for one in parts.placed_sets] == [9, 3]
    assert parts.placed_sets[0].assembly_number == 75 - 24


def _changed(kind: str, name: str, **changes: Any) -> Any:
    def change(document: dict[str, Any]) -> None:
        entry = next(one for one in document[kind] if one["name"] == name)
        entry.update(changes)

    return change


def _without_pin(document: dict[str, Any]) -> None:
    document["bearing"] = [one for one in document["bearing"] if one["rotor"] != "p"]


REFUSED: dict[str, tuple[Any, list[str]]] = {
    "touching": (_changed("planetary", "stage", count=5), ["planetary[0].planets", "room for 4 of them"]),
    "assembly": (
        lambda document: [_changed("gear", "s", teeth=25)(document), _changed("gear", "r", teeth=-85)(document)],
        ["planetary[0].planets", "multiples of 360/110 deg, as 0, 121.091", "is 108 or 111"],
    ),
    "ring": (_changed("gear", "r", teeth=-70), ["planetary[0]", "jam", "a ring of 84 teeth"]),
    "free": (_changed("planetary", "stage", fixed="x"), ["planetary[0].fixed", "the name of a gear or rotor"]),
    "module": (_changed("gear", "p", module="2.5 mm"), ["gears of one module"]),
    "helix": (_changed("gear", "p", helix_angle="10 deg"), ["equal helix angle"]),
    "ground": (
        lambda document: [one.update(seat="ground") for one in document["bearing"] if one["rotor"] == "p"],
        ['bearing[2].seat (bearing "p left")', '"carrier", the carrier'],
    ),
    "bearing": (_without_pin, ['rotor[1] (rotor "p")', "on its pin"]),
    "axis": (_changed("rotor", "ring", axis=["5 mm", "60 mm"]), ["rotor[2].axis", "it is 10 mm off it"]),
    "carrier": (_changed("planetary", "stage", carrier="sum"), ["planetary[0].carrier", "did you mean 'sun'?"]),
    "errors": (_changed("planetary", "stage", pin_errors=["1 um"]), ["pin_errors", "one for each of 3 planets"]),
    "count": (_changed("planetary", "stage", count=2, angles=["0 deg"]), ["count", "as many planets as angles, 1"]),
}


@pytest.mark.parametrize("refused", REFUSED)
def test_sets_that_cannot_be_are_refused_at_their_keys(refused: str) -> None:
    change, parts = REFUSED[refused]
    document = stage()
    change(document)
    with pytest.raises(CaseError) as error:
        read(document)
    for part in parts:
        assert part in str(error.value)


def test_a_member_that_nothing_holds_is_refused_with_what_would_work() -> None:
    with pytest.raises(CaseError, match=r"2 degrees of freedom .* expected 1 more of 'carrier', 'ring' held"):
        read(stage(fixed=None))
    document = stage(fixed=None)
    document["operation"]["drive"] = [{"rotor": "nose", "speed": "1 rpm"}]
    with pytest.raises(CaseError, match=r"operation.drive\[0\].rotor"):
        read(document)


def test_the_study_of_a_case_has_the_sets(tmp_path: Any) -> None:
    study = gw.build(**stage())
    machine = study.case.parts.machine
    assert machine is not None
    assert machine.members_of(machine.placed_sets[0])[0].role == "sun"
