"""Gear units to REXS files and back: every number that the schema can hold is the same, and all others are noted."""

import fnmatch
import math
from collections.abc import Iterator, Mapping
from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rexs_files import helical_stage

from gearwhine.case import Case, CaseError, load_case, parse_case
from gearwhine.case.bearings import Element, RollingStiffness
from gearwhine.case.load import imported_case
from gearwhine.case.rotors import RoundDisc
from gearwhine.exchange.rexs import read_content
from gearwhine.exchange.rexs.model import Component, RexsModel
from gearwhine.from_case.rexs import ExportedUnit, rexs_of
from gearwhine.rotors.rolling_bearings import RollingElements
from gearwhine.rotors.rolling_bearings.catalogue import CatalogueType

BUNDLED = (
    *("spur-pair", "helical-pair", "small-gearbox", "three-stage", "two-stage-reducer", "nasa-gear-noise-rig"),
    *("planetary-stage", "planetary-helical"),
)
"""Bundled cases with gears on rotors; gear-62-62 has no rotors."""
NOT_HELD = {
    "housing*": "[housing]",
    "transient*": "[transient]",
    "measured*": "[measured]",
    "provenance*": "[provenance]",
    "rotor.*.unbalance*": "unbalance",
    "rotor.*.damping_ratio": "damping_ratio",
    "rotor.*.frequency_limit": "frequency_limit",
    "rotor.*.pin_error.*": "pin_error",
    "rotor.*.rim_seat": "rim_seat",
    "rotor.*.coupling.torsional_damping": "coupling: torsional_damping",
    "bearing.*.damping*": "damping",
    "bearing.*.seat": "its seat in the housing is the casing",
    "gear.*.mass": "mass and moments of inertia",
    "gear.*.polar_inertia": "mass and moments of inertia",
    "gear.*.diametral_inertia": "mass and moments of inertia",
    "gear.*.stiffens_shaft": "stiffens_shaft",
    "gear.*.ring_support*": "ring_support",
    "gear.*.errors.eccentricity": "errors.eccentricity",
    "gear.*.errors.runout": "errors.runout",
    "gear.*.errors.phase": "errors.phase",
    "gear.*.errors.pitch*": "errors.pitch",
    "gear_pair.*.stiffness.model": "stiffness",
    "gear_pair.*.damping_ratio": "damping_ratio",
    "gear_pair.*.misalignment": "misalignment",
    "planetary.*.fixed.seat": "fixed.seat",
}
"""What the schema cannot hold, by the keys of the cases, and how the notes of the export name it."""
SAID_OTHERWISE = {
    "title": "the import adds the name of the file",
    "notes": "those of the import",
    "gear_pair.*.centre_distance": "that of the axes, for which it is checked",
    "material.cast-iron.*": "of the housing, referred to by the casing: no part that comes back has it",
    "planetary.*.fixed.member": "the gear's rotor in its place",
    "planetary.*.fixed.stiffness": "written, and beyond 1e7 N m/rad read as rigid",
    "sweep.speed*": "the same speeds as a list, compared for themselves",
    "operation.rotor": "the default is named",
    "operation.at": "the default is named",
    "operation.output*": "the outputs in balance with the input are named",
}
"""What is the same in other words; torques and speeds are compared as the machine has them."""


def flat(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Every value of nested tables by its path; entries of a list by name, or pair of names, or place."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from flat(inner, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list | tuple):
        for place, inner in enumerate(value):
            key: object = place
            if isinstance(inner, Mapping):
                key = inner.get("name", f"{inner['driver']} {inner['driven']}" if "driver" in inner else place)
            yield from flat(inner, f"{path}.{key}")
    else:
        yield path, value


def values_of(case: Case) -> dict[str, Any]:
    """Values of a case in SI, discs of width and diameter by the mass and inertias of a hollow cylinder."""
    document = case.model_dump()
    for rotor, table in zip(case.rotor, document["rotor"], strict=True):
        table["discs"] = [
            cylinder(disc, case.material[str(disc.material or rotor.material)].density)
            if isinstance(disc, RoundDisc)
            else disc.model_dump()
            for disc in rotor.discs
        ]
    return {path: value for path, value in flat(document) if value is not None}


def cylinder(disc: RoundDisc, density: float | None) -> dict[str, float]:
    assert density is not None
    mass = density * math.pi / 4.0 * (disc.diameter**2 - disc.bore**2) * disc.width
    polar = mass * (disc.diameter**2 + disc.bore**2) / 8.0
    diametral = 0.5 * polar + mass * disc.width**2 / 12.0
    return {"at": disc.at, "mass": mass, "polar_inertia": polar, "diametral_inertia": diametral}


def differ(one: Any, other: Any) -> bool:
    if isinstance(one, float | int) and isinstance(other, float | int) and not isinstance(one, bool):
        return abs(one - other) > 1e-12 * max(abs(one), abs(other))
    return bool(one != other)


def returned(case: Case, load: Mapping[str, Any] | None = None) -> tuple[ExportedUnit, Case]:
    """The case as it comes back from a file, and what was exported."""
    exported = rexs_of(case, load)
    return exported, parse_case(imported_case("unit.rexs", exported.xml.encode()).document)


def test_a_load_spectrum_comes_back_as_the_sweep_that_it_became() -> None:
    """Speeds, the chosen load case and its torque are the same; a sweep without the speed of operation is noted."""
    case = parse_case(imported_case("unit.rexs", helical_stage().xml()).document)
    assert case.sweep is not None
    assert case.operation is not None
    assert len(case.sweep.speeds) > 1
    exported, back = returned(case)
    assert back.sweep is not None
    assert back.operation is not None
    assert back.sweep.speeds == pytest.approx(case.sweep.speeds, rel=1e-12)
    assert back.operation.speed == pytest.approx(case.operation.speed, rel=1e-12)
    assert [torque.value for torque in back.parts.torques] == pytest.approx(
        [torque.value for torque in case.parts.torques], rel=1e-9
    )
    assert not any("[sweep]" in note.about for note in exported.notes)
    rig = load_case("nasa-gear-noise-rig").case
    _, of_rig = returned(rig)
    assert rig.sweep is not None
    assert of_rig.sweep is not None
    assert of_rig.sweep.speeds == pytest.approx(rig.sweep.speeds, rel=1e-12)
    document = imported_case("unit.rexs", helical_stage().xml()).document
    document["sweep"] = {"speed": ["100 rpm", "200 rpm"]}
    exported, back = returned(parse_case(document))
    assert back.sweep is None
    assert any("[sweep]" in note.about for note in exported.notes)


def differences(case: Case, back: Case) -> list[str]:
    """Paths of values that are not the same, or that only one of both has."""
    before, after = values_of(case), values_of(back)
    missing = object()
    return [
        path
        for path in {**before, **after}
        if differ(before.get(path, missing), after.get(path, missing))
        and not (path not in before and path.rpartition(".")[2] in ("right_diameter", "right_bore"))
    ]


def unexpected(paths: list[str]) -> list[str]:
    return [
        path
        for path in paths
        if not any(fnmatch.fnmatchcase(path, pattern) for pattern in (*NOT_HELD, *SAID_OTHERWISE))
    ]


@pytest.fixture(scope="module", params=BUNDLED)
def unit(request: pytest.FixtureRequest) -> tuple[Case, ExportedUnit, Case]:
    case = load_case(request.param).case
    return case, *returned(case)


def test_every_number_that_the_schema_can_hold_comes_back(unit: tuple[Case, ExportedUnit, Case]) -> None:
    case, _, back = unit
    assert unexpected(differences(case, back)) == []


def test_speeds_and_torques_are_those_of_the_machine(unit: tuple[Case, ExportedUnit, Case]) -> None:
    case, _, back = unit
    assert back.parts.speeds == pytest.approx(case.parts.speeds, rel=1e-12)
    before, after = (
        sorted((torque.rotor, torque.at, torque.value) for torque in one.parts.torques) for one in (case, back)
    )
    assert [one[0] for one in before] == [one[0] for one in after]
    for one, other in zip(before, after, strict=True):
        assert other[1:] == pytest.approx(one[1:], rel=1e-12)


def test_whatever_does_not_come_back_is_noted(unit: tuple[Case, ExportedUnit, Case]) -> None:
    case, exported, back = unit
    said = {note.text for note in exported.notes} | {note.about for note in exported.notes}
    for path in differences(case, back):
        for pattern, words in NOT_HELD.items():
            if fnmatch.fnmatchcase(path, pattern):
                assert any(words in text for text in said), path


def test_nothing_is_listed_that_comes_back() -> None:
    cases = [load_case(name).case for name in BUNDLED]
    found = {path for case in cases for path in differences(case, returned(case)[1])}
    for pattern in (*NOT_HELD, *SAID_OTHERWISE):
        assert fnmatch.filter(found, pattern), pattern


def everything() -> dict[str, Any]:
    """A case with what the bundled ones do not have."""
    rolling = {
        "balls": {
            "element": "ball",
            "count": 9,
            "element_diameter": "11.1 mm",
            "pitch_diameter": "46 mm",
            "inner_groove": 0.52,
            "outer_groove": 0.53,
            "clearance": "5 um",
            "dynamic_rating": "20 kN",
        },
        "angled": {
            "element": "ball",
            "count": 12,
            "element_diameter": "11 mm",
            "pitch_diameter": "46 mm",
            "contact_angle": "25 deg",
            "carries": "-z",
            "preload": "250 N",
        },
        "rollers": {
            "element": "roller",
            "count": 14,
            "element_diameter": "9 mm",
            "element_length": "9.5 mm",
            "pitch_diameter": "46 mm",
            "dynamic_rating": "31 kN",
        },
        "cones": {
            "catalogue": {
                "type": "tapered-roller",
                "bore": "30 mm",
                "outer_diameter": "62 mm",
                "width": "17.25 mm",
                "axial_factor": 1.6,
            },
            "axial_offset": "-4 um",
            "dynamic_rating": "50 kN",
            "static_rating": "56 kN",
        },
    }
    shaft = {"material": "steel", "segments": [{"length": "150 mm", "diameter": "30 mm"}]}
    return {
        "material": {
            "steel": {"youngs_modulus": "206 GPa", "poisson_ratio": 0.29, "density": "7800 kg/m^3"},
            "bronze": {"youngs_modulus": "110 GPa", "poisson_ratio": 0.34, "density": "8800 kg/m^3"},
        },
        "rotor": [
            {
                "name": "in",
                "axis": ["0 mm", "10 mm"],
                "start": "-40 mm",
                "material": "steel",
                "segments": [
                    {"length": "60 mm", "diameter": "30 mm", "right_diameter": "34 mm", "bore": "8 mm"},
                    {"length": "90 mm", "diameter": "30 mm", "bore": "8 mm", "right_bore": "6 mm"},
                    {"length": "20 mm", "diameter": "28 mm", "material": "bronze"},
                ],
            },
            {"name": "out", "axis": ["0 mm", "110 mm"], "start": "-40 mm", **shaft},
        ],
        "bearing": [
            {"name": "balls", "rotor": "in", "at": "10 mm", "stiffness": {"rolling": rolling["balls"]}},
            {"name": "rollers", "rotor": "in", "at": "140 mm", "stiffness": {"rolling": rolling["rollers"]}},
            {"name": "cones", "rotor": "out", "at": "10 mm", "stiffness": {"rolling": rolling["cones"]}},
            {"name": "angled", "rotor": "out", "at": "140 mm", "stiffness": {"rolling": rolling["angled"]}},
        ],
        "gear": [
            {
                "name": "pinion",
                "rotor": "in",
                "at": "75 mm",
                "teeth": 23,
                "module": "4 mm",
                "bore": "30 mm",
                "face_width": "30 mm",
                "helix_angle": "12 deg",
                "profile_shift": 0.31,
                "pressure_angle": "22 deg",
                "addendum": 0.96,
                "dedendum": 1.31,
                "root_radius": "0.9 mm",
                "material": "bronze",
                "root_relief": {"amount": "7 um", "length": "1.2 mm"},
                "tip_relief": {"amount": "11 um", "start_roll_angle": "30 deg", "shape": "parabolic"},
                "errors": {
                    "profile": {"crowning": "3 um"},
                    "helix": {"crowning": "4 um", "end_relief": "6 um", "end_relief_length": "2.5 mm"},
                },
            },
            {
                "name": "wheel",
                "rotor": "out",
                "at": "75 mm",
                "teeth": 24,
                "module": "4 mm",
                "bore": "30 mm",
                "face_width": "28 mm",
                "helix_angle": "-12 deg",
                "pressure_angle": "22 deg",
                "profile_shift": 0.2,
                "tooth_thinning": "33 um",
                "rim": "9 mm",
                "web": "10 mm",
            },
        ],
        "gear_pair": [{"driver": "pinion", "driven": "wheel", "backlash": "0.12 mm"}],
        "operation": {
            "speed": "-1234 rpm",
            "torque": "87 N*m",
            "at": "170 mm",
            "gravity": [0.0, "-9 m/s^2", "1.5 m/s^2"],
            "force": [{"rotor": "out", "at": "150 mm", "x": "120 N", "y": "-75 N", "z": "33 N"}],
        },
    }


def test_what_the_bundled_cases_do_not_have_comes_back_too() -> None:
    case = parse_case(everything())
    exported, back = returned(case)
    assert unexpected(differences(case, back)) == []
    assert sorted(torque.value for torque in back.parts.torques) == pytest.approx(
        sorted(torque.value for torque in case.parts.torques), rel=1e-12
    )
    assert {note.text for note in exported.notes} == set()


ANGLES = {
    "four-point": 35,
    "four-point-ball": 30,
    "self-aligning-ball": 10,
    "tapered-roller": 14,
    "spherical-roller": 9,
}


@st.composite
def rolling_bearings(draw: st.DrawFn) -> dict[str, Any]:
    """A rolling bearing of any type, by its main dimensions or its elements, with what such a one may have."""
    by_catalogue = draw(st.booleans())
    kind = str(draw(st.sampled_from(get_args(CatalogueType if by_catalogue else Element))))
    angle = {"contact_angle": f"{ANGLES.get(kind, 25)} deg"}
    if by_catalogue:
        catalogue: dict[str, Any] = {"type": kind, "bore": "30 mm", "outer_diameter": "62 mm", "width": "24 mm"}
        is_angled = kind not in ("deep-groove", "cylindrical-roller") and draw(st.booleans())
        rolling: dict[str, Any] = {"catalogue": catalogue | (angle if is_angled else {})}
    else:
        size = {"count": 11, "element_diameter": "9 mm", "pitch_diameter": "46 mm"}
        rolling = {"element": kind, **size} | ({"element_length": "9.5 mm"} if kind.endswith("roller") else {})
        is_angled = kind in ANGLES or (kind == "ball" and draw(st.booleans()))
        rolling |= angle if is_angled else {}
    one_way = kind in ("angular-contact", "tapered-roller") or (kind == "ball" and is_angled)
    cylinders = kind in ("cylindrical-roller", "roller")
    more = {"clearance": "-4 um", "carries": "-z", "dynamic_rating": "31 kN"}
    if (one_way or kind in ("deep-groove", "ball")) and draw(st.booleans()):
        arrangement = draw(st.sampled_from(["back to back", "face to face", "tandem"]))
        rolling |= {"arrangement": arrangement, "spacing": "27 mm"}
        more |= {"preload": "80 N"}
    elif not cylinders:
        more |= {"preload": "80 N", "axial_offset": "-3 um"}
    if not (one_way or cylinders or "arrangement" in rolling) and draw(st.booleans()):
        rolling |= {"floating": True}
        more = {"clearance": "-4 um", "dynamic_rating": "31 kN"}
    return rolling | {key: more[key] for key in draw(st.sets(st.sampled_from(sorted(more))))}


@settings(max_examples=60, deadline=None)
@given(rolling_bearings())
def test_every_rolling_bearing_comes_back_with_its_forces(rolling: dict[str, Any]) -> None:
    """The inner ring displaced, elements, preload, clearance and arrangement have the same forces; C is the same."""
    document = everything()
    document["bearing"][0]["stiffness"] = {"rolling": rolling}
    case = parse_case(document)
    exported, back = returned(case)
    assert exported.notes == ()
    before, after = (one.bearing[0].stiffness for one in (case, back))
    assert isinstance(before, RollingStiffness)
    assert isinstance(after, RollingStiffness)
    assert after.rolling.kind == before.rolling.kind
    assert after.rolling.dynamic_rating == before.rolling.dynamic_rating
    built = [one.rolling.build("balls") for one in (before, after)]
    assert built[0].floating == built[1].floating
    moved = np.array([7e-6, -4e-6, 9e-6, 1e-4, -2e-4])
    forces, returned_forces = (RollingElements(one).at(moved).gradient for one in built)
    np.testing.assert_allclose(returned_forces, forces, rtol=1e-9, atol=1e-9 * np.abs(forces).max())


@pytest.mark.parametrize(
    ("ours", "written", "kind"),
    [
        ("angular_contact_ball_bearing", "double_row_angular_contact_bearing", "double-row-angular-contact"),
        ("radial_self_aligning_ball_bearing", "radial_self-aligning_ball_bearing", "self-aligning-ball"),
    ],
)
def test_names_of_types_in_other_files_are_read(ours: str, written: str, kind: str) -> None:
    """That of earlier exports, and that of the schema 1.0."""
    document = everything()
    size = {"type": kind, "bore": "30 mm", "outer_diameter": "62 mm", "width": "24 mm"}
    document["bearing"][0]["stiffness"] = {"rolling": {"catalogue": size}}
    xml = rexs_of(parse_case(document)).xml
    back = parse_case(imported_case("unit.rexs", xml.replace(ours, written, 1).encode()).document)
    assert isinstance(back.bearing[0].stiffness, RollingStiffness)
    assert back.bearing[0].stiffness.rolling.kind == kind


def numbers(model: RexsModel, kind: str, name: str, unit: str) -> list[float | None]:
    return [one.number_of(name, unit) for one in model.of_kind(kind)]


def test_units_are_those_of_the_schema() -> None:
    model = read_content(rexs_of(load_case("planetary-stage").case).xml.encode())
    units = {
        name: attribute.unit
        for component in model.components.values()
        for name, attribute in component.attributes.items()
    }
    expected = {
        "normal_module": "mm",
        "elastic_modulus": "N / mm^2",
        "density": "kg / dm^3",
        "radial_stiffness": "N / m",
        "rotational_stiffness": "N mm / rad",
        "rotational_speed": "1 / min",
        "torque_around_u_axis": "N m",
        "helix_angle_reference_diameter": "deg",
        "moment_of_inertia_u_axis": "kg m^2",
        "number_of_teeth": "none",
    }
    assert {name: units[name] for name in expected} == expected
    # 24 teeth of 2 mm, with an addendum of one module; a ring of 90 with 0.85 modules.
    assert numbers(model, "cylindrical_gear", "tip_diameter", "m")[0] == pytest.approx(0.052, rel=1e-14)
    assert numbers(model, "ring_gear", "tip_diameter", "m") == pytest.approx([0.1766], rel=1e-14)
    assert numbers(model, "ring_gear", "root_diameter", "m") == pytest.approx([0.185], rel=1e-14)
    (held,) = [one for one in model.of_kind("coupling") if one.has("rotational_stiffness")]
    assert held.number_of("rotational_stiffness", "N*m/rad") == pytest.approx(3e7, rel=1e-14)


def test_the_operating_point_is_a_load_case() -> None:
    """Half of the tooth force, 71.77 N m on a base radius of 14 x 3.175 mm cos 20°, is on each bearing of a shaft."""
    import gearwhine as gw

    study = gw.load("spur-pair")
    exported = rexs_of(study.case, study.operating_point().document)
    model = read_content(exported.xml.encode())
    assert len(model.load_cases) == 1
    seen = model.in_load_case(model.load_cases[0])
    speeds = {one.name: one.number_of("rotational_speed", "rad/s") for one in seen.of_kind("shaft")}
    assert speeds == pytest.approx({"input": 5500.0 * math.pi / 30.0, "output": -5500.0 * math.pi / 30.0}, rel=1e-12)
    back = parse_case(imported_case("unit.rexs", exported.xml.encode()).document)
    assert unexpected(differences(study.case, back)) == []
    half = 0.5 * 71.77 / (14.0 * 3.175e-3)
    for bearing in seen.of_kind("concept_bearing"):
        # The wheel pushes the pinion down, against its turn, and apart; bearings push the pinion's shaft up.
        sense = 1.0 if bearing.name.startswith("input") else -1.0
        apart = half * math.tan(math.radians(20.0))
        assert force(bearing, "inner") == pytest.approx([0.0, sense * apart, sense * half], rel=1e-3, abs=1e-6)
        assert force(bearing, "outer") == pytest.approx([-part for part in force(bearing, "inner")])


def test_an_operating_point_in_rigid_seats_is_noted_beside_a_housing() -> None:
    case = load_case("small-gearbox").case
    for seats, is_noted in (("rigid", True), ("housing", False)):
        notes = rexs_of(case, {"seats": seats, "bearings": []}).notes
        assert any("rigid seats" in note.text for note in notes) == is_noted


def force(bearing: Component, side: str) -> list[float]:
    return [bearing.required(f"force_acting_on_{side}_component_{axis}", "N") for axis in "uvw"]


@pytest.mark.parametrize("name", ["steel-box", "ribbed-box", "overhung-fan", "gear-62-62"])
def test_a_case_without_gears_on_rotors_is_refused_by_what_it_lacks(name: str) -> None:
    with pytest.raises(CaseError, match=r"'export --rexs' needs \[\[(gear|rotor)\]\]"):
        rexs_of(load_case(name).case)


def test_a_coupling_without_a_shaft_behind_it_is_refused() -> None:
    document = everything()
    stiff = {
        "lateral_stiffness": "1e6 N/m",
        "axial_stiffness": "1e6 N/m",
        "tilt_stiffness": "1e3 N*m/rad",
        "torsional_stiffness": "1e4 N*m/rad",
    }
    document["rotor"][0]["segments"].append({"length": "20 mm", "coupling": stiff})
    with pytest.raises(CaseError, match=r"rotor\[0\].segments: expected a piece of shaft on either side"):
        rexs_of(parse_case(document))


def test_stiffness_that_differs_by_direction_is_its_mean_and_noted() -> None:
    document = everything()
    document["bearing"][0]["stiffness"] = {"xx": "1e8 N/m", "yy": "3e8 N/m", "xy": "1e6 N/m"}
    exported, back = returned(parse_case(document))
    assert unexpected(differences(parse_case(document), back)) == [
        f"bearing.balls.stiffness.{key}" for key in ("xx", "yy", "xy")
    ]
    assert dict(flat(back.bearing[0].model_dump()))["stiffness.xx"] == 2e8
    assert [note.text for note in exported.notes] == [
        "its stiffness is the mean of x and y, without what couples directions"
    ]
