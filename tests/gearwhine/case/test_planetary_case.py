"""Planetary sets in a case: planets written once, members held, what `check` tells, and refusals at keys."""

import json
import math
from typing import Any

import pytest
from planetary_case import bearings, gear, ravigneaux, rotor, stage

import gearwhine as gw
from gearwhine.case import CaseError, dump_case, parse_case
from gearwhine.case.model import Case
from gearwhine.results.check import check_document, sections, summary
from gearwhine.results.planetary import set_lines


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
    parts = read(ravigneaux()).parts
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
    "no axis": (_changed("rotor", "carrier", axis=1e30), ['axis (rotor "carrier")', "expected a list, got 1e+30"]),
    "no name": (
        lambda document: document["bearing"][2].update(name=[1, 2]),
        ["bearing[2].name: expected a name of 1 to 100 characters", "got [1, 2]"],
    ),
    "no errors": (_changed("planetary", "stage", pin_errors=1.0), ["pin_errors", "expected a list, got 1.0"]),
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


def test_one_planet_alone_has_a_fault() -> None:
    document = stage()
    crack = {"kind": "crack", "tooth": 4, "depth": "1 mm", "planet": 2, "flank": "back"}
    pitch = ["0 um"] * 29 + ["5 um"]
    document["gear"][1] |= {
        "fault": [crack, {"kind": "wear", "depth": "2 um"}],
        "errors": {"pitch": pitch, "planet": 3},
    }
    case = read(document)
    gears = [one for one in case.gear if one.name.startswith("p")]
    assert [[fault.kind for fault in one.fault] for one in gears] == [["wear"], ["crack", "wear"], ["wear"]]
    assert [bool(one.errors.pitch) for one in gears] == [False, False, True]
    built = case.parts.gears["p 2"].faults[0]
    assert (built.tooth, built.flank) == (4, "back")
    assert dump_case(case).count('kind = "crack"') == 1


@pytest.mark.parametrize(("name", "planet"), [("p", 4), ("s", 1)])
def test_no_such_planet_has_a_fault(name: str, planet: int) -> None:
    document = stage()
    index = {"s": 0, "p": 1}[name]
    document["gear"][index]["fault"] = {"kind": "missing-tooth", "tooth": 4, "planet": planet}
    with pytest.raises(CaseError) as refused:
        read(document)
    assert [problem.key for problem in refused.value.problems] == [f"gear[{index}].fault[0].planet"]
    assert "of the `count` that a [[planetary]] mounts" in str(refused.value)


def with_spalls(*faults: dict[str, Any]) -> dict[str, Any]:
    """The set with rolling elements in the left bearings of the planets, which are damaged."""
    document = stage()
    document["rotor"][1]["segments"] = [{"length": "60 mm", "diameter": "40 mm", "bore": "32 mm"}]
    balls = {"count": 10, "element_diameter": "6 mm", "pitch_diameter": "20 mm", "clearance": "-1 um"}
    document["bearing"][2] |= {"stiffness": {"rolling": {**balls, "law": "nonlinear"}}, "fault": list(faults)}
    return document


def test_one_planet_alone_has_a_spalled_bearing() -> None:
    """A spall of a pin stands to its planet as that of the first one; an element's angle is against its raceway."""
    size = {"length": "1 mm", "depth": "0.1 mm"}
    pin = {"on": "inner", "azimuth": "-20 deg", **size}
    case = read(with_spalls({**pin, "planet": 3}, {"on": "element", "azimuth": "10 deg", **size}, pin))
    spalls = [one.fault for one in case.bearing if one.name.startswith("p left")]
    assert [[fault.on for fault in of] for of in spalls] == [
        *[["element", "inner"]] * 2,
        ["inner", "element", "inner"],
    ]
    angles = [[math.degrees(fault.azimuth) for fault in of] for of in spalls]
    expected = ([10.0, -20.0], [10.0, 100.0], [220.0, 10.0, 220.0])
    assert all(found == pytest.approx(known) for found, known in zip(angles, expected, strict=True))
    built = [mounted for mounted in case.parts.bearings if mounted.spalls]
    assert [len(mounted.spalls) for mounted in built] == [2, 2, 3]


@pytest.mark.parametrize(("place", "planet"), [(2, 4), (0, 1)])
def test_no_such_planet_has_a_spalled_bearing(place: int, planet: int) -> None:
    document = with_spalls()
    document["bearing"][place] |= {
        "stiffness": document["bearing"][2]["stiffness"],
        "fault": {"on": "outer", "length": "1 mm", "depth": "0.1 mm", "planet": planet},
    }
    with pytest.raises(CaseError) as refused:
        read(document)
    assert [problem.key for problem in refused.value.problems] == [f"bearing[{place}].fault[0].planet"]
    assert "mounts of this bearing" in str(refused.value)


def test_check_tells_rates_of_faults() -> None:
    """By hand: the carrier turns at 50 · 24/108 Hz, the sun 38.889 Hz faster, a planet on its pin 24/30 of that."""
    document = stage()
    document["rotor"][1]["segments"] = [
        {"length": "30 mm", "diameter": "40 mm", "bore": "32 mm"},
        {"length": "30 mm", "diameter": "10 mm", "bore": "5 mm"},
    ]
    balls = {"count": 10, "element_diameter": "6 mm", "pitch_diameter": "20 mm", "clearance": "-1 um"}
    for place, ring in ((2, {}), (3, {"turning_ring": "inner"})):
        document["bearing"][place]["stiffness"] = {"rolling": {**balls, **ring}}
    (one,) = check_document(read(document))["planetary"]
    carrier, sun = 50.0 * 24 / 108, 50.0 * 84 / 108
    planet = sun * 24 / 30
    assert one["planet_pass_hz"] == pytest.approx(3.0 * carrier)
    rates = {fault["gear"]: fault for fault in one["tooth_faults"]}
    assert rates["s"]["working_flank_hz"] == rates["s"]["tooth_hz"] == pytest.approx(3.0 * sun)
    assert rates["r"]["working_flank_hz"] == pytest.approx(3.0 * carrier)
    assert (rates["p 2"]["working_flank_mates"], rates["p 2"]["back_flank_mates"]) == (["s"], ["r"])
    found = [rates["p 2"][key] for key in ("turn_hz", "working_flank_hz", "back_flank_hz", "tooth_hz")]
    assert found == pytest.approx([planet, planet, planet, 2.0 * planet])
    meet = {mesh["kind"]: mesh["same_teeth_hz"] for mesh in one["meshes"]}
    # 24 and 30 teeth meet again after 120 mesh periods, 30 and 84 after 420.
    assert meet == pytest.approx({"sun": 24 * sun / 120, "ring": 24 * sun / 420})
    bearings = {row["name"]: row["characteristic_frequencies_hz"] for row in one["planet_bearings"]}
    passes = {"outer raceway": 5.0 * 0.7 * planet, "inner raceway": 5.0 * 1.3 * planet}
    strikes = {"rolling element": (10 / 3) * (1.0 - 0.09) * planet}
    # The planet's bore turns around the pin and takes the cage along by more than half.
    assert bearings["p left 1"] == pytest.approx({"cage": 0.65 * planet, **passes, **strikes})
    assert bearings["p right 1"] == pytest.approx({"cage": 0.35 * planet, **passes, **strikes})
    text = "\n".join(map(str, set_lines(one)))
    assert "planets pass a sensor at 33.33 Hz; the same teeth meet again at 7.778, 2.222 Hz" in text
    assert "sun 116.67 Hz; planet 31.111 Hz on the flank at s (working) or r (back), 62.222 Hz on both; ring" in text
    assert text.count("inner raceway 202.22 Hz") == 2


def test_planets_in_mesh_with_each_other_touch_one_mate_with_either_flank() -> None:
    (one, second) = check_document(read(ravigneaux()))["planetary"]
    mates = {fault["gear"]: (fault["working_flank_mates"], fault["back_flank_mates"]) for fault in one["tooth_faults"]}
    assert mates["short 1"] == (["s"], ["front 1"])
    assert mates["front 1"] == (["short 1"], ["r"])
    assert {fault["gear"]: fault["back_flank_mates"] for fault in second["tooth_faults"]}["back 2"] == []


def test_elements_are_within_a_planet_that_turns_around_them() -> None:
    document = stage()
    document["rotor"][1]["segments"] = [{"length": "60 mm", "diameter": "40 mm", "bore": "18 mm"}]
    balls = {"count": 10, "element_diameter": "6 mm", "pitch_diameter": "20 mm", "clearance": "-1 um"}
    document["bearing"][2]["stiffness"] = {"rolling": balls}
    with pytest.raises(CaseError, match=r"within the bore of the shaft, 18 mm wide there.* they reach to 26 mm"):
        read(document)


def test_planets_on_elastic_pins() -> None:
    document = stage()
    document["rotor"][1]["pin"] = {"walls": ["-5 mm", "65 mm"], "diameter": "20 mm", "bore": "5 mm"}
    parts = read(document).parts
    pins = [one.pin for one in parts.shafts if one.carrier]
    assert [(pin.walls, pin.diameter, pin.bore) for pin in pins] == [((-0.005, 0.065), 0.02, 0.005)] * 3
    assert pins[0].material.youngs_modulus == pytest.approx(207e9)
    document["rotor"][1]["pin"] = {"at": "30 mm", "stiffness": "2e8 N/m", "tilt_stiffness": "1e5 N*m/rad"}
    springs = read(document).parts.shafts[1].pin
    assert (springs.at, springs.radial, springs.tilt) == (0.03, 2e8, 1e5)


@pytest.mark.parametrize(
    ("pin", "key", "told"),
    [
        ({"walls": ["0 mm"]}, "diameter", "'diameter' beside the others"),
        ({"diameter": "9 mm"}, "walls", "'walls' beside the others"),
        ({"stiffness": "1e8 N/m", "at": "0 mm"}, "tilt_stiffness", "'tilt_stiffness' beside the others"),
        ({}, "at", "'walls' and 'diameter', or 'at', 'stiffness' and 'tilt_stiffness'"),
        ({"walls": ["0 mm"], "diameter": "9 mm", "stiffness": "1e8 N/m"}, "stiffness", "nothing beside walls"),
        ({"walls": ["0 mm", "0 mm"], "diameter": "9 mm"}, "walls", "each wall once"),
        ({"walls": ["0 mm"], "diameter": "9 mm", "material": "brass"}, "material", "steel"),
        ({"walls": ["0 mm"], "diameter": "20 mm"}, "", "thinner than the bore of the planet around it, 18 mm"),
    ],
)
def test_no_such_pin_of_a_planet(pin: dict[str, Any], key: str, told: str) -> None:
    document = stage()
    document["rotor"][1]["segments"][0]["bore"] = "18 mm"
    document["rotor"][1]["pin"] = pin
    with pytest.raises(CaseError) as refused:
        read(document)
    assert [problem.key for problem in refused.value.problems] == [f"rotor[1].pin{key and '.'}{key}"]
    assert told in str(refused.value)


def test_a_sun_has_no_pin() -> None:
    document = stage()
    document["rotor"][0]["pin"] = {"walls": ["0 mm"], "diameter": "9 mm"}
    with pytest.raises(CaseError, match=r"rotor\[0\].pin.* without a carrier"):
        read(document)


def test_a_broken_set_is_one_problem_and_no_missing_drive() -> None:
    """Two degrees of freedom of a train without its set do not follow from the mistake."""
    for wrong in ({"pin_errors": ["20 um", "0 um"]}, {"count": "3"}):
        with pytest.raises(CaseError) as refused:
            read(stage(**wrong))
        assert [problem.key.split("[")[0] for problem in refused.value.problems] == ["planetary"]
        assert "drives that fix every speed" not in str(refused.value)


@pytest.mark.parametrize(("diameter", "warned"), [("4 mm", False), ("3.9 mm", False), ("4.2 mm", True)])
def test_needles_of_a_planet_may_roll_on_its_bore(diameter: str, warned: bool) -> None:
    """Pitch diameter 14 mm and rollers of 4 mm touch a bore of 18 mm, which is their raceway."""
    document = stage()
    planet = next(one for one in document["rotor"] if one["name"] == "p")
    planet["segments"][0]["bore"] = "18 mm"
    needles = {"element": "roller", "count": 10, "element_diameter": diameter, "element_length": "5 mm"}
    for one in document["bearing"]:
        if one["rotor"] == "p":
            one["stiffness"] = {"rolling": {**needles, "pitch_diameter": "14 mm"}}
    warnings = gw.build(**document).warnings
    assert any("expected rolling elements within" in str(one) for one in warnings) is warned
