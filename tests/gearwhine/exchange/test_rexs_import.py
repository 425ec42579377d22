"""Cases of gear units in REXS files: places, sections, teeth, bearings, loads, planetary sets, and notes on them."""

import math
import tomllib
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from rexs_files import CENTRE_DISTANCE, HELIX, PLANET, RING, SUN, RexsFile, helical_stage, planetary_stage

import gearwhine as gw
from gearwhine.case import CaseError, parse_case
from gearwhine.case.model import Case
from gearwhine.exchange.rexs import ImportedCase, RexsError, case_of, read_content
from gearwhine.exchange.rexs.catalogue import dimensions_of
from gearwhine.exchange.rexs.operation import find_drive


def imported(file: RexsFile, load_case: str = "") -> ImportedCase:
    """The case of a file, each of whose notes about a value stands as a comment beside it."""
    made = case_of(read_content(file.xml()), "unit.rexs", load_case)
    text = made.toml
    assert [str(note) for note in made.notes if note.at and f"# {note}" not in text] == []
    return made


def case(file: RexsFile) -> Case:
    return parse_case(imported(file).document)


def refusal(file: RexsFile) -> str:
    with pytest.raises(RexsError) as caught:
        imported(file)
    return str(caught.value)


def notes(file: RexsFile, kind: str) -> list[str]:
    return [f"{note.about}: {note.text}" for note in imported(file).notes if note.kind == kind]


def entry(document: dict[str, Any], kind: str, name: str) -> dict[str, Any]:
    return next(one for one in document[kind] if one["name"] == name)


@pytest.fixture(scope="module")
def helical() -> Case:
    return case(helical_stage())


@pytest.fixture(scope="module")
def planetary() -> Case:
    return case(planetary_stage())


def test_the_toml_is_the_document_with_a_comment_at_each_assumed_value() -> None:
    for file in (helical_stage(), planetary_stage()):
        made = imported(file)
        text = made.toml
        assert tomllib.loads(text) == made.document
        for note in made.notes:
            assert (f"# {note}" in text) == bool(note.at)
        assert text.startswith(f"# Imported from unit.rexs (REXS {file.version}, written by Test 1.2 on 2024-05-06).")
        assert made.document["notes"].startswith("Imported from unit.rexs")


def test_names_that_would_end_a_text_or_a_comment_are_harmless() -> None:
    file = helical_stage()
    for place, name in enumerate(("a'''b\"\"\"\n[x]\ny = 1", "\x07bell\x00", "''", "#\u2028", "\\", "ground", "")):
        file.components[3 + 3 * place]["name"] = name
    content = file.json()
    made = case_of(read_content(content), "unit\n.rexs")
    assert tomllib.loads(made.toml) == made.document
    parse_case(made.document)


def test_shafts_have_their_places_and_sections(helical: Case) -> None:
    first, second = helical.rotor
    assert (first.name, first.axis, first.start) == ("input", (0.0, 0.0), pytest.approx(-0.010))
    # x, y, z are v, w, u.
    assert second.axis == pytest.approx((0.060, -0.080))
    assert second.start == 0.0
    assert [(one.length, one.diameter, one.bore) for one in second.segments] == [
        (0.025, 0.035, 0.010),
        (0.075, 0.045, 0.010),
    ]
    steel = helical.material[second.material or ""]
    assert (steel.youngs_modulus, steel.poisson_ratio, steel.density) == (206e9, 0.3, 7850.0)


def turned(file: RexsFile, rotation: list[list[float]]) -> RexsFile:
    """Return the file with every place and axis rotated, rows of the rotation matrix over u, v, w."""
    for one in file.components:
        for name in ("support_vector", "u_axis_vector", "w_axis_vector"):
            if name in one["attributes"]:
                old, unit = one["attributes"][name]
                new = [sum(a * b for a, b in zip(row, old, strict=True)) for row in rotation]
                one["attributes"][name] = (new, unit)
        # Absolute from now on.
        one["attributes"].pop("reference_component_for_position", None)
    return file


def test_a_unit_that_lies_otherwise_in_its_file_is_the_same_machine() -> None:
    angle = 0.7
    about_v = [
        [math.cos(angle), 0.0, math.sin(angle)],
        [0.0, 1.0, 0.0],
        [-math.sin(angle), 0.0, math.cos(angle)],
    ]
    cyclic = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    for rotation in (about_v, cyclic):
        for build in (helical_stage, planetary_stage):
            other, usual = case(turned(build(), rotation)), case(build())
            for one, twin in zip(other.rotor, usual.rotor, strict=True):
                assert one.axis == pytest.approx(twin.axis, abs=1e-12)
                assert one.start == pytest.approx(twin.start, abs=1e-12)
            assert [one.at for one in other.bearing] == pytest.approx([one.at for one in usual.bearing], abs=1e-12)


def test_places_relative_to_another_component_add_up() -> None:
    file = helical_stage()
    gear, shaft = file.named("wheel"), file.number("output")
    gear["support_vector"] = ([45.0, 0.0, 0.0], "mm")
    gear["reference_component_for_position"] = (shaft, "none")
    assert case(file).gear_named("wheel").at == pytest.approx(0.045)
    gear["support_vector"] = ([47.0, 0.0, 0.0], "mm")
    assert case(file).gear_named("wheel").at == pytest.approx(0.047)


def test_a_shaft_that_points_the_other_way_is_the_same_shaft() -> None:
    """The output described from its other end: 100 mm long, its coordinates run against z."""
    file, usual = helical_stage(), case(helical_stage())
    shaft = file.named("output")
    shaft["support_vector"] = ([100.0, 60.0, -80.0], "mm")
    shaft["u_axis_vector"] = ([-1.0, 0.0, 0.0], "mm")
    for one in file.components:
        attributes = one["attributes"]
        if one["type"] == "shaft_section" and attributes["inner_diameter_begin"][0] == 10.0:
            begin, length = attributes["u_coordinate_on_shaft"][0], attributes["length"][0]
            attributes["u_coordinate_on_shaft"] = (100.0 - begin - length, "mm")
    for name in ("wheel", "NU 207", "rear", "machine"):
        for key in ("u_coordinate_on_shaft", "u_coordinate_on_shaft_inner_side"):
            if key in file.named(name):
                file.named(name)[key] = (100.0 - file.named(name)[key][0], "mm")
    other = case(file)
    assert other.rotor_named("output") == usual.rotor_named("output")
    assert other.gear == usual.gear
    assert other.bearing == usual.bearing
    assert other.operation == usual.operation


def test_shafts_without_a_place_stand_by_centre_distance_and_angle() -> None:
    """From the input to (60, -80) mm: 143.13 degrees from w about -u; the gears stand at 55 and 45 mm."""
    file, usual = helical_stage(), case(helical_stage())
    for name in ("input", "output"):
        del file.named(name)["support_vector"]
    file.named("stage")["rotating_angle_around_neg_u_axis"] = (math.degrees(math.atan2(60.0, -80.0)), "deg")
    made = case(file)
    assert made.rotor_named("input").axis == (0.0, 0.0)
    assert made.rotor_named("output").axis == pytest.approx(usual.rotor_named("output").axis)
    starts = [made.rotor_named(name).start for name in ("input", "output")]
    assert starts == pytest.approx([0.0, 0.010])
    assert made.gear == usual.gear
    assert any("no support_vector: its place by cylindrical_stage" in text for text in notes(file, "assumed"))


def test_a_shaft_without_a_place_stands_on_the_axis_of_its_coupling() -> None:
    file = helical_stage()
    shaft = file.part("shaft", 1, "motor shaft")
    file.part("shaft_section", shaft, length=(60.0, "mm"), outer_diameter_begin=(22.0, "mm"))
    file.relate("reference", origin=shaft, referenced=3)
    stations = {"u_coordinate_on_shaft_inner_side": (60.0, "mm"), "u_coordinate_on_shaft_outer_side": (0.0, "mm")}
    coupling = file.add("coupling", "flange", **stations)
    file.relate("side", assembly=coupling, inner_part=shaft, outer_part=file.number("input"))
    rotor = case(file).rotor_named("input")
    assert (rotor.start, rotor.length) == pytest.approx((-0.070, 0.180))


def test_places_relative_to_a_component_that_points_the_other_way_are_turned() -> None:
    file = helical_stage()
    file.named("output").update(support_vector=([100.0, 60.0, -80.0], "mm"), u_axis_vector=([-1.0, 0.0, 0.0], "mm"))
    file.named("wheel").update(
        support_vector=([55.0, 0.0, 0.0], "mm"), reference_component_for_position=(file.number("output"), "none")
    )
    # The shaft spans 0 to 100 mm, and the wheel stands 55 mm before its right end.
    assert entry(imported(file).document, "gear", "wheel")["at"] == "45 mm"


def test_cones_keep_their_diameters_from_either_end() -> None:
    file = helical_stage()
    sections = [one["attributes"] for one in file.components if one["type"] == "shaft_section"]
    sections[2]["outer_diameter_end"] = (20.0, "mm")
    cone = case(file).rotor_named("input").segments[-1]
    assert (cone.diameter, cone.right_diameter) == pytest.approx((0.025, 0.020))
    shaft = file.named("input")
    shaft["u_axis_vector"] = ([-1.0, 0.0, 0.0], "mm")
    first = file_segments(file, "input")[0]
    assert (first["diameter"], first["right_diameter"]) == ("20 mm", "25 mm")


def file_segments(file: RexsFile, name: str) -> list[dict[str, Any]]:
    """Segments of a rotor of whose other places nothing is asked."""
    for one in list(file.components):
        if one["type"] in ("external_load",) or "bearing" in one["type"]:
            one["type"] = "point_list"
    for gear in ("pinion", "wheel"):
        file.named(gear)["u_coordinate_on_shaft"] = (45.0, "mm")
    return entry(imported(file).document, "rotor", name)["segments"]  # type: ignore[no-any-return]


def test_teeth_have_the_diameters_of_the_file(helical: Case) -> None:
    from gearwhine.coupling.gears import GearPairGeometry

    pinion, wheel = (helical.gear_named(name).build() for name in ("pinion", "wheel"))
    for gear, tip, root in ((pinion, 55.6, 44.8), (wheel, 152.2, 141.4)):
        assert 2e3 * gear.tip_radius == pytest.approx(tip, abs=1e-9)
        assert 2e3 * gear.root_circle_radius == pytest.approx(root, abs=1e-9)
        assert 2e3 * gear.pitch_radius == pytest.approx(2.4 * gear.teeth / math.cos(HELIX), rel=1e-12)
    # Without thinning the teeth close at the centre distance: the sum of profile shifts is that of the distance.
    from dataclasses import replace

    pair = GearPairGeometry(pinion, replace(wheel, tooth_thinning=0.0))
    assert pair.working_centre_distance == pytest.approx(1e-3 * CENTRE_DISTANCE, rel=1e-10)


def test_a_profile_shift_of_the_file_is_taken_and_the_lacking_one_noted() -> None:
    assert case(helical_stage()).gear_named("pinion").profile_shift == 0.3
    (noted,) = [text for text in notes(helical_stage(), "assumed") if "profile shift" in text]
    assert noted.startswith('cylindrical_gear 12 "wheel": no profile shift: ')
    assert noted.endswith('by the centre distance of cylindrical_stage 17 "stage"')


def test_the_base_tangent_deviation_thins_the_teeth(helical: Case) -> None:
    """A_sn = A_W / cos(alpha_n), of the mean of -40 and -60 um."""
    assert helical.gear_named("wheel").tooth_thinning == pytest.approx(50e-6 / math.cos(math.radians(20.0)), rel=1e-9)


def test_flank_modifications_are_taken(helical: Case) -> None:
    pinion = helical.gear_named("pinion")
    assert pinion.tip_relief is not None
    assert pinion.tip_relief.amount == pytest.approx(12e-6)
    base = helical.parts.gears["pinion"].base_radius
    assert pinion.tip_relief.start_roll_angle == pytest.approx(math.sqrt((0.027 / base) ** 2 - 1.0), rel=1e-9)
    assert pinion.errors.helix is not None
    assert pinion.errors.helix.crowning == pytest.approx(4e-6)
    assert helical.gear_named("wheel").tip_relief is None


def test_a_relief_by_its_length_and_of_another_shape() -> None:
    file = helical_stage()
    relief = file.named("relief")
    del relief["tip_relief_datum_diameter"]
    relief |= {"tip_relief_datum_length": (1.5, "mm"), "shape_of_relief": ("circular", "none")}
    taken = case(file).gear_named("pinion").tip_relief
    assert taken is not None
    assert (taken.length, taken.shape) == (pytest.approx(1.5e-3), "parabolic")
    assert any("circular relief is taken as a parabolic one" in text for text in notes(file, "changed"))


def test_bearings_by_catalogue_by_rows_and_by_springs(helical: Case) -> None:
    made = {one.name: one for one in helical.bearing}
    catalogue = made["6205"].stiffness.rolling  # type: ignore[union-attr]
    assert catalogue.catalogue.type == "deep-groove"
    size = catalogue.catalogue
    assert (size.bore, size.outer_diameter, size.width) == (0.025, 0.052, 0.015)
    assert (catalogue.clearance, catalogue.dynamic_rating, catalogue.static_rating) == (
        pytest.approx(10e-6),
        pytest.approx(14.8e3),
        pytest.approx(7.8e3),
    )
    rows = made["NU 207"].stiffness.rolling  # type: ignore[union-attr]
    assert (rows.element, rows.count) == ("roller", 14)
    assert (rows.element_diameter, rows.element_length, rows.pitch_diameter) == (0.009, 0.009, 0.054)
    assert made["front"].stiffness.xx == 3e8  # type: ignore[union-attr]
    matrix = made["rear"].stiffness.matrix  # type: ignore[union-attr]
    assert [matrix[place][place] for place in range(5)] == [3e8, 3e8, 1e8, 0.0, 0.0]
    assert [made[name].at for name in ("6205", "front", "NU 207", "rear")] == pytest.approx([0.105, 0.015, 0.012, 0.09])


def test_angled_bearings_carry_thrust_in_the_sense_of_the_file() -> None:
    for sense, carries in (("positive", "+z"), ("negative", "-z")):
        file = helical_stage()
        file.named("6205").update(
            bearing_type=("radial_tapered_roller_bearing", "none"),
            axial_force_absorption=(sense, "none"),
            axial_factor_y_2=(1.6, "none"),
        )
        del file.named("6205")["operating_radial_bearing_clearance"]
        rolling = entry(imported(file).document, "bearing", "6205")["stiffness"]["rolling"]
        assert rolling["carries"] == carries
        assert rolling["catalogue"]["axial_factor"] == 1.6


def test_the_sense_of_thrust_is_along_the_bearings_own_axis() -> None:
    file = helical_stage()
    file.named("6205").update(
        bearing_type=("angular_contact_ball_bearing", "none"),
        axial_force_absorption=("positive", "none"),
        u_axis_vector=([-1.0, 0.0, 0.0], "mm"),
    )
    assert entry(imported(file).document, "bearing", "6205")["stiffness"]["rolling"]["carries"] == "-z"


def test_a_part_a_little_beyond_the_end_of_its_shaft_stands_at_the_end() -> None:
    file = helical_stage()
    file.named("6205")["u_coordinate_on_shaft_inner_side"] = (126.0, "mm")
    assert entry(imported(file).document, "bearing", "6205")["at"] == "120 mm"
    assert any('it stands 6 mm beyond the end of "input"' in text for text in notes(file, "changed"))
    file.named("6205")["u_coordinate_on_shaft_inner_side"] = (-30.0, "mm")
    assert 'a place on the shaft "input", from 0 to 120 mm' in refusal(file)


def test_a_bearing_known_by_its_designation_has_the_sizes_of_iso_15() -> None:
    file = helical_stage()
    for key in ("inner_diameter", "outer_diameter", "width"):
        del file.named("6205")[key]
    file.named("6205")["catalogue_designation"] = ("6305-2Z", "none")
    catalogue = entry(imported(file).document, "bearing", "6205")["stiffness"]["rolling"]["catalogue"]
    assert [catalogue[key] for key in ("bore", "outer_diameter", "width")] == ["25 mm", "62 mm", "17 mm"]
    file.named("6205")["catalogue_designation"] = ("HK 2512", "none")
    catalogue = entry(imported(file).document, "bearing", "6205")["stiffness"]["rolling"]["catalogue"]
    assert catalogue["bore"] == "25 mm"  # of the shaft there
    assert any("look up those of HK 2512" in text for text in notes(file, "assumed"))


@pytest.mark.parametrize(
    ("designation", "sizes"),
    [  # makers' catalogues
        ("6000", (10, 26, 8)),
        ("6210-2Z", (50, 90, 20)),
        ("6306", (30, 72, 19)),
        ("7208 B", (40, 80, 18)),
        ("NU 306", (30, 72, 19)),
        ("NU212", (60, 110, 22)),
        ("NU 2205", (25, 52, 18)),
        ("NUP204E", (20, 47, 14)),
        ("22220", (100, 180, 46)),
        ("30206", (30, 62, 17.25)),
        ("32008 X", (40, 68, 19)),
        ("33014", (70, 110, 31)),
        ("33016", (80, 125, 36)),
    ],
)
def test_designations_have_the_sizes_of_catalogues(designation: str, sizes: tuple[float, float, float]) -> None:
    found = dimensions_of(designation)
    assert found is not None
    assert tuple(1e3 * size for size in found) == pytest.approx(sizes)


@pytest.mark.parametrize("designation", ["", "bearing", "618/8", "6", "60", "6099", "33001", "HK 2512", "K 50x58x25"])
def test_other_designations_have_none(designation: str) -> None:
    assert dimensions_of(designation) is None


def test_a_stiffness_that_stands_for_rigid_is_bounded_and_noted() -> None:
    file = helical_stage()
    file.named("front")["radial_stiffness"] = (1e20, "N / m")
    del file.named("rear")["radial_stiffness"]
    made = imported(file).document
    assert entry(made, "bearing", "front")["stiffness"]["xx"] == "1e10 N/m"
    assert entry(made, "bearing", "rear")["stiffness"]["matrix"][0][0] == "1e10 N/m"
    assert any("radial_stiffness of 1.0e+20 N/m" in text for text in notes(file, "changed"))
    assert any("no radial_stiffness: rigid" in text for text in notes(file, "assumed"))


def test_the_first_load_case_is_taken_or_one_by_its_number() -> None:
    first = imported(helical_stage())
    assert (first.document["operation"]["speed"], first.document["operation"]["torque"]) == ("1200 rpm", "80 N*m")
    second = imported(helical_stage(), "2")
    assert (second.document["operation"]["speed"], second.document["operation"]["torque"]) == ("1800 rpm", "40 N*m")
    assert second.load_cases[0].startswith("load case 2: 30 % of the time, 1800 rpm at input")
    assert second.document["sweep"]["speed"] == ["1200 rpm", "1800 rpm"]
    with pytest.raises(RexsError, match="a load case among 1, 2"):
        imported(helical_stage(), "7")
    file = helical_stage()
    file.load_cases = []
    alone = imported(file).document
    assert alone["operation"]["speed"] == "1500 rpm"
    assert "sweep" not in alone


def test_power_leaves_where_the_file_takes_it_off(helical: Case) -> None:
    operation = helical.operation
    assert operation is not None
    (output,) = operation.output
    assert output.rotor == "output"
    assert output.torque == pytest.approx(80.0 * 59 / 20, rel=1e-9)
    assert output.at == pytest.approx(0.1)
    (force,) = operation.force
    assert (force.rotor, force.at, force.x, force.y, force.z) == ("input", 0.0, 250.0, 0.0, 0.0)


def test_a_torque_that_is_stated_at_the_output_is_brought_to_the_input() -> None:
    """236 N m taken off at 1200 rpm · 20/59: the input has 80 N m."""
    file = helical_stage()
    file.load_cases = []
    file.named("input")["rotational_speed"] = (1200.0, "1 / min")
    del file.named("motor")["torque_around_u_axis"]
    file.named("motor")["defines_torque"] = (False, "none")
    # The output turns against z, and the torque of the machine brakes it.
    file.named("machine").update(torque_around_u_axis=(236.0, "N m"), defines_torque=(True, "none"))
    operation = imported(file).document["operation"]
    assert (operation["rotor"], operation["speed"], operation["torque"]) == ("input", "1200 rpm", "80 N*m")
    assert operation["output"] == [{"rotor": "output", "torque": "236 N*m", "at": "100 mm"}]


def test_a_speed_that_is_stated_at_the_output_is_brought_to_the_input() -> None:
    file = helical_stage()
    file.load_cases = []
    del file.named("input")["rotational_speed"]
    file.named("output")["rotational_speed"] = (-400.0, "1 / min")
    operation = imported(file).document["operation"]
    assert (operation["rotor"], operation["speed"], operation["torque"]) == ("input", "1180 rpm", "60 N*m")
    # 236 N m taken off there are 80 N m at the input.
    del file.named("motor")["torque_around_u_axis"]
    file.named("machine").update(torque_around_u_axis=(236.0, "N m"), defines_torque=(True, "none"))
    operation = imported(file).document["operation"]
    assert (operation["rotor"], operation["speed"], operation["torque"]) == ("input", "1180 rpm", "80 N*m")
    shaft = file.number("output")
    file.load_cases = [{shaft: {"rotational_speed": (speed, "1 / min")}} for speed in (-400.0, -600.0)]
    assert imported(file).document["sweep"]["speed"] == ["1180 rpm", "1770 rpm"]


def test_the_driver_is_the_gear_that_power_reaches_first() -> None:
    file = helical_stage()
    stage = next(one for one in file.relations if one["type"] == "stage")
    (_, pinion), (_, wheel) = stage["roles"][1:]
    stage["roles"][1:] = [("gear_1", wheel), ("gear_2", pinion)]
    made = imported(file).document
    assert made["gear_pair"] == [{"driver": "pinion", "driven": "wheel"}]
    assert made["operation"]["torque"] == "80 N*m"


def test_power_in_place_of_torque() -> None:
    file = helical_stage()
    file.load_cases = []
    del file.named("motor")["torque_around_u_axis"]
    file.named("motor")["power"] = (9.0, "kW")
    torque = float(imported(file).document["operation"]["torque"].split()[0])
    assert torque == pytest.approx(9000.0 / (1500.0 * math.pi / 30.0), rel=1e-9)


@pytest.mark.parametrize(
    ("stated", "torques", "others", "driven"),
    [
        (100.0, {"output": 10.0}, (), ("input", 100.0, 5.0, None)),  # taken out at -50 rad/s: 500 W
        (100.0, {"output": 10.0, "input": 0.0}, (), ("input", 100.0, 5.0, "input")),
        (100.0, {"output": -10.0}, (), ("output", -50.0, 10.0, "output")),  # along its speed
        (100.0, {"input": -10.0}, (), ("input", 100.0, 10.0, "input")),  # brakes the only shaft: taken as driving it
        (-100.0, {"output": 0.0}, ("no torque",), ("input", -100.0, 0.0, None)),
    ],
)
def test_power_comes_in_where_a_load_drives_or_else_where_the_speed_is_stated(
    stated: float, torques: dict[str, float], others: tuple[str, ...], driven: tuple[Any, ...]
) -> None:
    """Of two shafts, the output turns half as fast the other way; torques about +z."""
    bodies = {name: SimpleNamespace(name=name) for name in ("input", "output")}
    noted = list[str]()
    notes = SimpleNamespace(
        assumed=lambda *given: noted.append("no torque"), changed=lambda *given: noted.append("brakes")
    )
    component = SimpleNamespace(flag=lambda name: None, label="a load")
    loads: Any = [
        SimpleNamespace(component=component, body=bodies[name], torque=torque, power=None)
        for name, torque in torques.items()
    ]
    unit: Any = SimpleNamespace(notes=notes)
    found = find_drive(unit, (cast(Any, bodies["input"]), stated), loads, {"input": 1.0, "output": -0.5})
    load = None if found.load is None else found.load.body.name
    assert (found.body.name, found.speed, found.torque, load) == driven
    assert tuple(noted) == (("brakes",) if torques == {"input": -10.0} else others)


def test_weight_is_along_the_stated_direction() -> None:
    file = helical_stage()
    file.of(1).update(
        {
            "account_for_gravity": (True, "none"),
            "direction_vector_gravity_u": (0.0, "none"),
            "direction_vector_gravity_v": (0.0, "none"),
            "direction_vector_gravity_w": (-2.0, "none"),
        }
    )
    assert imported(file).document["operation"]["gravity"] == ["0 m/s^2", "-9.80665 m/s^2", "0 m/s^2"]


def test_bearing_loads_are_those_of_levers(tmp_path: Path) -> None:
    """Forces of the teeth and of the belt on the input shaft, by hand: two springs across, one of them axial.

    The driver turns counter-clockwise seen from +z: the wheel holds it back along -t, t = z x e with e from its axis to
    the wheel's, pushes it away along -e, and its left-hand teeth along -z.
    """
    file = helical_stage()
    file.components[file.number("6205") - 1].update(
        type="concept_bearing",
        attributes={
            "u_coordinate_on_shaft_inner_side": (105.0, "mm"),
            "radial_stiffness": (3e8, "N / m"),
            "axial_stiffness": (1e8, "N / m"),
            "axial_force_absorption": ("both_directions", "none"),
        },
    )
    (tmp_path / "unit.rexs").write_bytes(file.xml())
    result = gw.load(tmp_path / "unit.rexs").operating_point().document
    found = {one["name"]: one["force_n"] for one in result["bearings"]}

    radius = 0.1 * 20 / 79
    tangential = 80.0 / radius
    cosine = 2.4e-3 * 79 / math.cos(HELIX) / 2.0 / 0.1
    transverse = math.atan(math.tan(math.radians(20.0)) / math.cos(HELIX))
    radial = tangential * math.tan(math.acos(cosine * math.cos(transverse)))
    axial = -tangential * math.tan(HELIX) / cosine
    e, t = (0.6, -0.8), (0.8, 0.6)
    teeth = [-tangential * t[place] - radial * e[place] for place in (0, 1)]
    belt = (250.0, 0.0)
    for place in (0, 1):
        moment = 0.040 * teeth[place] - 0.015 * belt[place] - radius * e[place] * axial
        rear = moment / 0.090
        assert found["6205"][place] == pytest.approx(rear, abs=0.03 * tangential)
        assert found["front"][place] == pytest.approx(teeth[place] + belt[place] - rear, abs=0.03 * tangential)
    assert found["6205"][2] == pytest.approx(axial, rel=1e-3)
    assert found["front"][2] == 0.0


def test_a_planetary_set_has_its_members_and_its_carrier(planetary: Case) -> None:
    (one,) = planetary.planetary
    assert (one.sun, one.ring, one.carrier) == ("sun", "ring", "carrier")
    assert one.planets == ("planet 1", "planet 2", "planet 3")
    assert one.fixed is not None
    assert one.fixed.member == "ring shaft"
    assert {planetary.rotor_named(f"planet shaft {place}").carrier for place in (1, 2, 3)} == {"carrier"}
    assert {bearing.seat for bearing in planetary.bearing if bearing.name.startswith("pin bearing")} == {"carrier"}
    # Willis: with the ring held the carrier turns at z_s / (z_s + z_r) of the sun.
    speeds = planetary.parts.speeds
    assert speeds["carrier"] == pytest.approx(-900.0 * math.pi / 30.0 * SUN / (SUN + RING), rel=1e-12)
    relative = (speeds["sun shaft"] - speeds["carrier"]) * -SUN / PLANET
    assert speeds["planet shaft 2"] - speeds["carrier"] == pytest.approx(relative, rel=1e-12)
    (output,) = planetary.operation.output  # type: ignore[union-attr]
    assert output.torque == pytest.approx(10e3 / abs(speeds["carrier"]), rel=1e-9)


def test_planets_stand_around_the_axis_of_the_sun(planetary: Case) -> None:
    angles = []
    for place in (1, 2, 3):
        x, y = planetary.rotor_named(f"planet shaft {place}").axis
        assert math.hypot(x, y) == pytest.approx(0.054, abs=1e-12)
        angles.append(math.degrees(math.atan2(y, x)) % 360.0)
    assert angles == pytest.approx([90.0, 330.0, 210.0])


def test_a_carrier_is_one_body_of_its_plates_shaft_and_pins(planetary: Case) -> None:
    carrier = planetary.rotor_named("carrier")
    assert carrier.length == pytest.approx(0.140)
    assert carrier.start == pytest.approx(-0.010)
    lengths = [segment.length for segment in carrier.segments]
    assert lengths == pytest.approx([0.010, 0.040, 0.010, 0.080])
    assert hasattr(carrier.segments[1], "coupling")
    # Three steel pins of 25 x 60 mm on a circle of 54 mm.
    mass = 3.0 * 7850.0 * math.pi / 4.0 * 0.025**2 * 0.060
    (disc,) = carrier.discs
    assert disc.mass == pytest.approx(mass, rel=1e-9)
    assert disc.polar_inertia == pytest.approx(mass * (0.054**2 + 0.025**2 / 8.0), rel=1e-9)  # type: ignore[union-attr]
    assert disc.at == pytest.approx(0.030)


def test_a_carrier_may_be_a_shaft_alone() -> None:
    """Planets on bearings straight to the carrier's shaft, without plates, pins and a planet_carrier."""
    file = planetary_stage()
    shaft = file.number("carrier shaft")
    pins = {file.number(f"pin {place}") for place in (1, 2, 3)}
    for one in file.components:
        if one["type"] in ("side_plate", "planet_carrier", "coupling") or one["id"] in pins:
            one["type"] = "point_list"
    for relation in file.relations:
        relation["roles"] = [(role, shaft if number in pins else number) for role, number in relation["roles"]]
    file.relations = [one for one in file.relations if one["type"] != "planet_pin"]
    for place in (1, 2, 3):
        for at in (10, 30):
            del file.named(f"pin bearing {place} at {at}")["u_coordinate_on_shaft_inner_side"]
    made = imported(file).document
    (one,) = made["planetary"]
    assert one["carrier"] == "carrier shaft"
    assert {segment["diameter"] for segment in entry(made, "rotor", "carrier shaft")["segments"]} == {"60 mm"}
    assert entry(made, "bearing", "pin bearing 2 at 30")["seat"] == "carrier shaft"
    parse_case(made)


def test_planets_without_a_carrier_and_gears_that_the_casing_holds_are_refused() -> None:
    file = planetary_stage()
    file.relations = [one for one in file.relations if one["type"] not in ("planet_carrier_shaft", "assembly")] + [
        one
        for one in file.relations
        if one["type"] == "assembly" and dict(one["roles"])["part"] != file.number("carrier")
    ]
    assert 'planetary_stage 8 "set": expected a carrier' in refusal(file)
    file = helical_stage()
    coupling = file.add("coupling", "lock", rotational_stiffness=(1e9, "N mm / rad"))
    file.relate("side", assembly=coupling, inner_part=file.number("output"), outer_part=2)
    assert "a coupling holds it in the casing" in refusal(file)


def test_the_brake_may_give_way_or_be_open() -> None:
    file = planetary_stage()
    file.named("brake")["rotational_stiffness"] = (4e9, "N mm / rad")
    assert imported(file).document["planetary"][0]["fixed"] == {"member": "ring shaft", "stiffness": "4e6 N*m/rad"}
    file.named("brake")["is_engaged"] = ([False], "none")
    made = imported(file)
    assert "fixed" not in made.document["planetary"][0]
    assert any("not engaged" in note.text for note in made.notes)


def test_a_ring_has_the_sign_and_hand_by_which_it_fits() -> None:
    file = planetary_stage()
    for place in (1, 2, 3):
        file.named(f"planet {place}")["helix_angle_reference_diameter"] = (0.0, "deg")
    flanks = [one["attributes"] for one in file.components if one["type"] == "cylindrical_gear_flank"]
    for flank in flanks:
        flank["addendum_modification_coefficient"] = (0.1, "none")
    sun_flank, ring_flank, *_ = flanks
    sun_flank["addendum_modification_coefficient"] = (-0.1, "none")
    # An internal pair closes at its distance where x_1 + x_2 = 0, whichever sign a file writes.
    for written in (0.1, -0.1):
        ring_flank["addendum_modification_coefficient"] = (written, "none")
        assert entry(imported(file).document, "gear", "ring")["profile_shift"] == -0.1


def test_an_assumed_tip_ends_where_the_involute_of_its_mate_begins() -> None:
    """The tip of the ring would reach below the flanks of its planets; the case refuses one that is longer by 1 %."""
    file = planetary_stage()
    del file.named("ring")["tip_diameter"]
    document = imported(file).document
    parse_case(document)
    ring = entry(document, "gear", "ring")
    assert ring["addendum"] < 1.0
    ring["addendum"] += 0.01
    with pytest.raises(CaseError, match=r"the tip of 'ring' reaches .* below the involute of 'planet 1'"):
        parse_case(document)


@pytest.mark.parametrize(("shift", "undercut"), [(-0.25, None), (-0.33, True)])
def test_teeth_that_their_tool_undercuts_are_told_and_accepted(shift: float, undercut: bool | None) -> None:
    """A rack whose straight flank ends a module below its line: from 1 - z sin² α_t / (2 cos β) = -0.287 on."""
    file = helical_stage()
    flanks = [one["attributes"] for one in file.components if one["type"] == "cylindrical_gear_flank"]
    for gear, flank, own in zip(("pinion", "wheel"), flanks, (shift, 0.3 - shift), strict=True):
        del file.named(gear)["tip_diameter"], file.named(gear)["root_diameter"]
        flank["addendum_modification_coefficient"] = (own, "none")
    assert entry(imported(file).document, "gear", "pinion").get("allow_undercut") is undercut
    assert any("its tool undercuts the teeth" in text for text in notes(file, "changed")) is bool(undercut)


@pytest.mark.parametrize(
    ("bending", "rotational", "expected"),
    [
        (2e5, 6e6, (200.0, 6e3)),
        (None, 1e12, (1e7, 1e7)),  # rigid is what is not given, and what is stiffer than that
        (0.0, 6e6, (1e-3, 6e3)),
    ],
)
def test_a_coupling_between_shafts_is_one_of_their_rotor(
    bending: float | None, rotational: float, expected: tuple[float, float]
) -> None:
    file = helical_stage()
    shaft = file.part("shaft", 1, "motor shaft", support_vector=([-90.0, 0.0, 0.0], "mm"))
    file.part("shaft_section", shaft, length=(60.0, "mm"), outer_diameter_begin=(22.0, "mm"))
    file.relate("reference", origin=shaft, referenced=3)
    tilt = {} if bending is None else {"bending_stiffness": (bending, "N mm / rad")}
    coupling = file.add(
        "coupling",
        "bellows",
        radial_stiffness=(1e6, "N / m"),
        axial_stiffness=(1e5, "N / m"),
        rotational_stiffness=(rotational, "N mm / rad"),
        **tilt,
    )
    file.relate("side", assembly=coupling, inner_part=shaft, outer_part=file.number("input"))
    rotor = case(file).rotor_named("input")
    assert rotor.start == pytest.approx(-0.090)
    assert [segment.length for segment in rotor.segments] == pytest.approx([0.060, 0.020, 0.030, 0.060, 0.030])
    between = rotor.segments[1].coupling  # type: ignore[union-attr]
    assert (between.lateral_stiffness, between.axial_stiffness) == (1e6, 1e5)
    assert (between.tilt_stiffness, between.torsional_stiffness) == expected
    assert any("no bending_stiffness: rigid" in text for text in notes(file, "assumed")) is (bending is None)
    assert any("bending_stiffness of 0 N*m/rad: 0.001" in text for text in notes(file, "changed")) is (bending == 0.0)


def test_a_bearing_between_two_shafts_stands_on_the_other_one() -> None:
    file = helical_stage()
    bearing = file.add("concept_bearing", "pilot", u_coordinate_on_shaft_inner_side=(5.0, "mm"))
    file.relate("side", assembly=bearing, inner_part=file.number("input"), outer_part=file.number("output"))
    pilot = entry(imported(file).document, "bearing", "pilot")
    assert (pilot["rotor"], pilot["seat"], pilot["at"]) == ("input", "output", "5 mm")


@pytest.mark.parametrize(
    ("bearing", "attribute", "value", "kind", "said"),
    [
        ("6205", "axial_force_absorption", ("positive", "none"), "changed", "it locates its shaft in both senses, not"),
        (
            "6205",
            "radial_bearing_clearance",
            (12.0, "mum"),
            "changed",
            "its clearance before mounting is taken",
        ),
        ("NU 207", "axial_force_absorption", ("positive", "none"), "changed", "rollers without flanges, which take no"),
        ("6205", "misalignment_in_v_direction", (20.0, "mum"), "left out", "seats of a case on the ground have no off"),
        ("6205", "misalignment_in_w_direction", (20.0, "mum"), "left out", "seats of a case on the ground have no off"),
    ],
)
def test_what_a_bearing_does_otherwise_is_told(
    bearing: str, attribute: str, value: tuple[Any, str], kind: str, said: str
) -> None:
    file = helical_stage()
    assert not any(said in text for text in notes(file, kind))
    if attribute == "radial_bearing_clearance":
        del file.named(bearing)["operating_radial_bearing_clearance"]
    file.named(bearing)[attribute] = value
    assert sum(said in text and bearing in text for text in notes(file, kind)) == 1


def test_the_summary_counts_the_notes_of_each_kind() -> None:
    file = helical_stage()
    file.named("6205")["axial_force_absorption"] = ("positive", "none")
    found = imported(file)
    numbers = [(len(notes(file, kind)), kind) for kind in ("assumed", "changed", "left out")]
    assert min(numbers)[0] > 0
    assert f": {', '.join(f'{number} {kind}' for number, kind in numbers)}; `gearwhine import`" in found.summary


def test_what_is_not_taken_is_listed_once_with_its_components() -> None:
    file = helical_stage()
    file.add("sn_curve", "curve")
    file.add("sn_curve", "other")
    left_out = notes(file, "left out")
    assert sum(text.startswith("lubricant") for text in left_out) == 1
    (curves,) = [text for text in left_out if text.startswith("sn_curve")]
    assert curves == f"sn_curve {len(file.components) - 1}, {len(file.components)}: not taken"


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda file: file.named("pinion").pop("number_of_teeth"), '"pinion": expected the attribute number_of_teeth'),
        (lambda file: file.named("pinion").pop("normal_module"), '"pinion": expected the attribute normal_module'),
        (lambda file: file.named("pinion").pop("face_width"), '"pinion": expected the attribute face_width'),
        (lambda file: file.named("pinion").update(number_of_teeth=(20.5, "none")), "a whole number"),
        (lambda file: file.named("pinion").update(number_of_teeth=(3, "none")), "a number from 5 to 2000"),
        (lambda file: file.named("pinion").update(normal_module=(2.4, "m")), "a module from 0.01 to 200 mm"),
        (lambda file: file.named("pinion").update(u_coordinate_on_shaft=(900.0, "mm")), 'a place on the shaft "input"'),
        (lambda file: file.named("output").update(u_axis_vector=([0.0, 1.0, 0.0], "mm")), "all shafts of a case"),
        (lambda file: file.named("output").update(u_axis_vector=([0.0, 0.0, 0.0], "mm")), "with a direction"),
        (lambda file: file.named("output").update(support_vector=([1.0, 2.0], "mm")), "three numbers"),
        (lambda file: file.named("output").update(support_vector=([0.0, 0.0, 0.0], "mm")), "gears on axes apart"),
        (lambda file: file.named("front").update(radial_stiffness=(-1.0, "N / m")), "a stiffness of 0 N/m or more"),
        (lambda file: file.components[16].update(type="bevel_stage"), "cylindrical_stage"),
    ],
)
def test_a_unit_that_no_case_can_hold_is_refused_by_its_component(spoil: Any, said: str) -> None:
    file = helical_stage()
    spoil(file)
    assert said in refusal(file)


def test_places_in_a_circle_are_refused() -> None:
    file = helical_stage()
    first, second = file.number("input"), file.number("output")
    file.of(first)["reference_component_for_position"] = (second, "none")
    file.of(second)["reference_component_for_position"] = (first, "none")
    assert "a place that is not relative to itself" in refusal(file)


def test_a_gap_between_sections_is_refused() -> None:
    file = helical_stage()
    section = next(one for one in file.components if one["type"] == "shaft_section")
    section["attributes"]["length"] = (20.0, "mm")
    assert "sections that join, got 'a gap of 10 mm'" in refusal(file)


def test_attributes_that_nothing_asks_for_are_noted_once_for_each_type() -> None:
    """A value that the file states and the case does not have is never passed over in silence."""

    def unasked(file: RexsFile) -> dict[str, str]:
        notes = case_of(read_content(file.xml())).notes
        return {note.about: note.text for note in notes if note.text.startswith("the attribute")}

    file = helical_stage()
    before = unasked(file)
    assert "cylindrical_gear" not in before
    for gear in ("pinion", "wheel"):
        file.named(gear)["chamfer_at_tooth_end"] = (0.5, "mm")
    assert unasked(file) == before | {"cylindrical_gear": "the attribute chamfer_at_tooth_end"}
    # One without a value does not count, and a long list is cut.
    file.named("wheel")["nothing"] = ("", "none")
    for number in range(9):
        file.named("wheel")[f"custom_{number}"] = (1.0, "none")
    names = ", ".join(f"custom_{number}" for number in range(7))
    expected = f"the attributes chamfer_at_tooth_end, {names} and 2 more"
    assert unasked(file)["cylindrical_gear"] == expected
    # Those of one component alone are not said of its type.
    file.of(file.number("pinion")).pop("chamfer_at_tooth_end")
    noted = unasked(file)
    assert "cylindrical_gear" not in noted
    assert noted[f"cylindrical_gear {file.number('wheel')}"] == expected


def test_slopes_of_flanks_are_noted_with_their_amounts() -> None:
    """The schema has no word on their sign, so that only a user can take them, and then needs the amount."""
    file = helical_stage()
    (flank,) = {
        dict(one["roles"])["left"] for one in file.relations if ("gear", file.number("pinion")) in one["roles"]
    } - {None}
    for kind, amount in (("profile_slope", 0.006), ("helix_slope", -0.0125)):
        slope = file.add(kind, **{kind: (amount, "mm")})
        file.relate("reference", origin=flank, referenced=slope)
    said = {note.about.split()[0]: note.text for note in imported(file).notes if "slope" in note.about}
    assert said["profile_slope"].startswith("6 um: the schema states no sign of it; give it as `errors.profile.slope`")
    assert said["helix_slope"].startswith("-12.5 um: the schema states no sign of it and no face")
    assert case(file).gear_named("pinion").tip_relief is not None
