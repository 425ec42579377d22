"""Fits that `check` warns of: bearings in seats and on shafts, gears on shafts, bearings without a seat."""

from typing import Any

import pytest

import gearwhine as gw
from gearwhine.case import load_case
from gearwhine.case.checks.whole_case import warnings_of

BALLS = {"type": "deep-groove", "bore": "30 mm", "outer_diameter": "52 mm", "width": "13 mm"}


def rolling(**changes: str) -> dict[str, Any]:
    return {"rolling": {"catalogue": BALLS | changes}}


def found(name: str, changes: dict[str, Any]) -> dict[tuple[str, str], dict[str, Any]]:
    """Warnings of parts that do not fit, by their kind and the part."""
    document = gw.load(name, changes).check().document
    kinds = ("bearing seat", "bearing place", "part on shaft", "gear faces", "sensor place")
    return {
        (one["name"], one["message"].split('"')[1]): one for one in document.get("warnings", ()) if one["name"] in kinds
    }


@pytest.mark.slow
def test_slips_of_a_drawn_housing_are_named_with_both_sizes() -> None:
    """One check of the reducer with five slips; its bores are found in the drawing, 52 mm long about z = -98 mm."""
    size = "bearing.input-back.stiffness.rolling.catalogue"
    told = found(
        "two-stage-reducer",
        {
            f"{size}.outer_diameter": "62 mm",
            f"{size}.width": "16 mm",
            "bearing.output-back.at": "28 mm",
            "bearing.intermediate-back.stiffness.rolling.catalogue.bore": "35 mm",
            "gear.wheel 1.bore": "45 mm",
            "housing.sensor.roof.position": ["80 mm", "346 mm", "0 mm"],
        },
    )
    assert set(told) == {
        ("bearing seat", "input-back"),
        ("bearing place", "output-back"),
        ("part on shaft", "intermediate-back"),
        ("part on shaft", "wheel 1"),
        ("sensor place", "roof"),
    }
    sits = 'sensor "roof": its position is 10 mm from the surface; it sits at (80, 336, 0) mm'
    assert told["sensor place", "roof"]["message"] == sits
    seat = told["bearing seat", "input-back"]["message"]
    assert seat == (
        'bearing "input-back": its outside diameter of 62 mm is not the 72 mm of the bore of seat "input-back"'
    )
    # The middle at -98 + 28 mm, the bore's end at -98 + 26 mm.
    place = told["bearing place", "output-back"]
    assert place["beyond_m"] == pytest.approx(2e-3, abs=1e-4)
    assert (
        'its middle at z = -70 mm lies 2 mm beyond the bore, z = -124 mm to -72 mm, of seat "output-back"'
        in (place["message"])
    )
    shaft = 'its bore of 35 mm is not the diameter of rotor "intermediate" at 11 mm, 40 mm'
    assert shaft in told["part on shaft", "intermediate-back"]["message"]
    wheel = 'gear "wheel 1": its bore of 45 mm is not the diameter of rotor "intermediate" at 135 mm, 48 mm'
    assert told["part on shaft", "wheel 1"]["message"] == wheel


def test_fits_of_a_box() -> None:
    """Bores of 52 mm through walls of 10 mm that end at z = -80 and 80 mm; the left ends of the shafts at -100 mm."""
    load = {"x": "300 N", "y": "100 N", "z": "0 N"}
    fitting = {"bearing.input-back.stiffness": rolling(), "bearing.input-back.load": load}
    assert found("small-gearbox", fitting) == {}
    assert found("small-gearbox", fitting | {"bearing.input-back.at": "25 mm"}) == {}
    (place,) = found("small-gearbox", fitting | {"bearing.input-back.at": "34 mm"}).values()
    assert place["beyond_m"] == pytest.approx(4e-3)
    assert "z = -80 mm to -70 mm" in place["message"]
    (wide,) = found(
        "small-gearbox", fitting | {"bearing.input-back.stiffness": rolling(outer_diameter="55 mm")}
    ).values()
    assert (wide["outside_diameter_m"], wide["seat_diameter_m"]) == pytest.approx((55e-3, 52e-3))
    # Sizes of a bearing by its geometry are those of its mounting; without any there is nothing to compare.
    balls = {"count": 9, "element_diameter": "7 mm", "pitch_diameter": "41 mm"}
    bare = fitting | {"bearing.input-back.stiffness": {"rolling": balls}}
    assert found("small-gearbox", bare) == {}
    mounted = {"rolling": balls | {"mounting": {"bore": "28 mm", "outer_diameter": "52 mm"}}}
    assert set(found("small-gearbox", bare | {"bearing.input-back.stiffness": mounted})) == {
        ("part on shaft", "input-back")
    }


def test_a_part_across_a_step_fits_either_diameter() -> None:
    steps = [{"length": "100 mm", "diameter": "40 mm"}, {"length": "140 mm", "diameter": "50 mm"}]
    for bore, fits in (("40 mm", True), ("50 mm", True), ("45 mm", False)):
        changes = {"rotor.input.segments": steps, "gear.pinion.at": "100 mm", "gear.wheel.at": "100 mm"}
        told = found("helical-pair", changes | {"gear.pinion.bore": bore})
        assert (("part on shaft", "pinion") not in told) is fits
    cone = [{"length": "240 mm", "diameter": "40 mm", "right_diameter": "50 mm"}]
    assert ("part on shaft", "pinion") not in found(
        "helical-pair", {"rotor.input.segments": cone, "gear.pinion.bore": "45 mm"}
    )


def test_gears_that_meet_on_a_part_of_the_narrower_face_are_named() -> None:
    """Faces of 30 mm and 24 mm, the narrow one about 120 mm: the wide one hides a shift of 3 mm, and no more."""
    wide = {"gear.pinion.face_width": "30 mm", "gear.wheel.face_width": "24 mm"}
    assert found("helical-pair", wide | {"gear.pinion.at": "123 mm"}) == {}
    (told,) = found("helical-pair", wide | {"gear.pinion.at": "115 mm"}).values()
    assert (told["common_m"], told["narrower_m"]) == pytest.approx((22e-3, 24e-3))
    assert "have 22 mm in common, which carries; the narrower one is 24 mm wide" in told["message"]


def test_a_bearing_without_a_seat_beside_a_housing_is_named() -> None:
    assert warnings_of(load_case("two-stage-reducer").case) == ()
    (told,) = warnings_of(load_case("small-gearbox", ["bearing.output-front.seat="]).case)
    assert told == (
        "bearing \"output-front\" has no 'seat': it stands on the ground, not in [housing]; give the name of a "
        '[[housing.seat]], or seat = "ground" where that is meant'
    )
    two = ["bearing.output-front.seat=", "bearing.input-back.seat="]
    (told,) = warnings_of(load_case("small-gearbox", two).case)
    assert told.startswith('bearings "input-back", "output-front" have no \'seat\': they stand on the ground')
    assert warnings_of(load_case("small-gearbox", ["bearing.output-front.seat=ground"]).case) == ()
    (told,) = warnings_of(load_case("small-gearbox", ["bearing.*.seat=ground"]).case)
    assert "no bearing stands in a seat" in told


@pytest.mark.slow
def test_a_mass_and_a_sensor_beside_a_box_are_told_where_they_sit() -> None:
    """Both 15 mm above the roof at 160 mm: they sit on it."""
    changes = {
        "housing.box.mesh_size": "60 mm",
        "housing.mass": [{"name": "motor", "mass": "5 kg", "position": ["20 mm", "175 mm", "30 mm"]}],
        "housing.sensor.top.position": ["20 mm", "175 mm", "30 mm"],
    }
    study = gw.load("small-gearbox", changes)
    told = {one["name"]: one for one in study.modes().document["warnings"]}
    for kind, name in (("mass", "motor"), ("sensor", "top")):
        assert told[f"{kind} place"][kind] == name
        assert told[f"{kind} place"]["beside_m"] == pytest.approx(15e-3, abs=1e-6)
        assert "15 mm from the surface; it sits at (20, 160, 30) mm" in told[f"{kind} place"]["message"]
