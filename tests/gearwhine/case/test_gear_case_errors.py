"""Every kind of wrong gear or pair of gears is reported by key path, value and expectation."""

from __future__ import annotations

from typing import Any

import pytest
from broken_cases import GEARBOX, GONE, check_one_wrong, check_several_wrong

from gearwhine.case import parse_case
from gearwhine.case.checks.whole_case import warnings_of

ONE_WRONG = {
    # units and numbers
    "percent for an angle": ("gear.0.pressure_angle", "20 %", "gear[0].pressure_angle", "an angle"),
    # ranges
    "four teeth": ("gear.0.teeth", 4, "gear[0].teeth", "a whole number from 5"),
    "half a tooth": ("gear.0.teeth", 28.5, "gear[0].teeth", "a whole number from 5"),
    "pressure angle": ("gear.0.pressure_angle", "40 deg", "gear[0].pressure_angle", "at most 35 deg"),
    "damping ratio": ("gear_pair.0.damping_ratio", 1.5, "gear_pair[0].damping_ratio", "below 1"),
    "bore of a gear": ("gear.0.bore", "84 mm", "gear[0].bore", "smaller than the root circle"),
    "web without a rim": ("gear.0.web", "2 mm", "gear[0].web", "no web, or a rim around it"),
    # keys, forms and choices
    "misspelt key": ("gear.0.facewidth", "6 mm", "gear[0].facewidth", "did you mean 'face_width'?"),
    "word of the field": ("gear.0.crowning", "4 um", "gear[0].crowning", "did you mean 'errors.helix.crowning'?"),
    "angle of the helix": ("gear.0.helix", "28 deg", "gear[0].helix", "did you mean 'helix_angle'?"),
    "lead by its name": ("gear.0.errors", {"lead": "4 um"}, "gear[0].errors.lead", "did you mean 'helix.slope'?"),
    "symbol of the field": ("gear.0.beta", "28 deg", "gear[0].beta", "did you mean 'helix_angle'?"),
    "unknown table": ("gaer", [], "gaer", "did you mean 'gear'?"),
    "fault without its kind": ("gear.0.fault", {"tooth": 1}, "gear[0].fault[0].kind", "missing-tooth"),
    "fault on no tooth": (
        "gear.0.fault",
        {"kind": "missing-tooth", "tooth": 99},
        "gear[0].fault[0].tooth",
        "a tooth from 0 to",
    ),
    "spall that ends first": (
        "gear.0.fault",
        {"kind": "spall", "tooth": 1, "depth": "1 um", "start_roll_angle": "20 deg", "end_roll_angle": "19 deg"},
        "gear[0].fault[0].end_roll_angle",
        "beyond start_roll_angle",
    ),
    "crack of a part of the face": (
        "gear.0.fault",
        {"kind": "crack", "tooth": 1, "depth": "1 mm", "width": "2 mm"},
        "gear[0].fault[0].width",
        "no 'width' of a fault of kind 'crack', got '2 mm'",
    ),
    "one fault's value": (
        "gear.0.fault",
        {"kind": "missing-tooth", "tooth": 99},
        "gear[0].fault[0].tooth",
        "a tooth from 0 to 27, got 99",
    ),
    "ring support of an external gear": (
        "gear.0.ring_support",
        {"kind": "clamped"},
        "gear[0].ring_support",
        "none of an external gear",
    ),
    "bolts without their number": (
        "gear.0.ring_support",
        {"kind": "bolts", "seat_width": "10 mm"},
        "gear[0].ring_support.count",
        "a value beside kind = 'bolts'",
    ),
    "relief from nowhere": ("gear.0.tip_relief", {"amount": "10 um"}, "gear[0].tip_relief", "exactly one of"),
    "end relief without length": (
        "gear.0.errors",
        {"helix": {"end_relief": "5 um"}},
        "gear[0].errors.helix.end_relief_length",
        "length of the end relief",
    ),
    "profile table of one row": (
        "gear.0.errors",
        {"profile": {"table": [["20 deg", "1 um"]]}},
        "gear[0].errors.profile.table",
        "two rows or more",
    ),
    "eccentric twice": (
        "gear.0.errors",
        {"eccentricity": "5 um", "runout": "10 um"},
        "gear[0].errors.runout",
        "eccentricity or runout",
    ),
    "spacing of too few teeth": (
        "gear.0.errors",
        {"spacing": ["1 um", "2 um"]},
        "gear[0].errors.spacing",
        "one deviation for each",
    ),
    "web without rim": ("gear.0.web", "5 mm", "gear[0].web", "a rim around it"),
    "steep helix": ("gear.0.helix_angle", "70 deg", "gear[0].helix_angle", "at most 60 deg"),
    "no addendum": ("gear.0.addendum", 0, "gear[0].addendum", "above 0 and of at most 3"),
    "pitch as a length": ("gear.0.diametral_pitch", "8 mm", "gear[0].diametral_pitch", "such as '8 1/in'"),
    "undercut by a word": ("gear.0.allow_undercut", "certainly", "gear[0].allow_undercut", "true or false"),
    "profile that is no table": ("gear.0.errors", {"profile": "1 um"}, "gear[0].errors.profile", "table"),
    "pitch of some teeth": ("gear.0.errors", {"pitch": ["1 um"] * 27}, "gear[0].errors.pitch", "each of 28 teeth"),
    "pitch of one tooth": ("gear.0.errors", {"pitch": "1 um"}, "gear[0].errors.pitch", "a list"),
    "pitch by weight": ("gear.0.errors", {"pitch": ["0 um", "1 kg"]}, "gear[0].errors.pitch[1]", "a length"),
    "pitch in millimetres": ("gear.0.errors", {"pitch": [0, 5]}, "gear[0].errors.pitch[1]", "at most 0.001 m"),
    "missing key": ("gear.0.teeth", GONE, "gear[0].teeth", "a whole number from 5"),
    "stiffness model": ("gear_pair.0.stiffness.model", "cornel", "gear_pair[0].stiffness.model", "'constant'"),
    "constant of nothing": (
        "gear_pair.0.stiffness",
        {"model": "constant"},
        "gear_pair[0].stiffness.value",
        "a stiffness",
    ),
    "table without file": ("gear_pair.0.stiffness", {"model": "table"}, "gear_pair[0].stiffness.file", "a file"),
    "two modules": ("gear.0.base_radius", "40 mm", "gear[0]", "exactly one of 'module', 'diametral_pitch' and"),
    "module and pitch": ("gear.0.diametral_pitch", "8 1/in", "gear[0]", "exactly one of 'module'"),
    "half an inertia": ("gear.0.mass", "1 kg", "gear[0]", "or none of them"),
    # names
    "rotor of a gear": ("gear.0.rotor", "x", "gear[0].rotor", "'input', 'output'"),
    "gear": ("gear_pair.0.driven", "weel", "gear_pair[0].driven", "did you mean 'wheel'?"),
    # places
    "gear off the rotor": ("gear.0.at", "201 mm", "gear[0].at", "which is 200 mm long"),
    # gears and running
    "module": ("gear.1.module", "3 mm", "gear_pair[0].driven", "gears of one module"),
    "angle": ("gear.1.pressure_angle", "25 deg", "gear_pair[0].driven", "gears of one pressure angle"),
    "helix of one gear": ("gear.0.helix_angle", "10 deg", "gear_pair[0].driven", 'has +10 deg, "wheel" +0 deg'),
    "planes": ("gear.1.at", "104 mm", "gear_pair[0].driven", "they are 4 mm apart along z"),
    "itself": ("gear_pair.0.driven", "pinion", "gear_pair[0].driven", "another gear than the driver itself"),
    "too few teeth": ("gear.1.teeth", 26, "gear_pair[0]", "the teeth lose contact at a centre distance of 88.9 mm"),
    "too many teeth": ("gear.1.teeth", 30, "gear_pair[0]", "the teeth jam at a centre distance of 88.9 mm"),
    "distance": ("gear_pair.0.centre_distance", "89 mm", "gear_pair[0].centre_distance", "axes, 88.9 mm"),
}

WHEEL = {"name": "wheel", "rotor": "output", "at": "100 mm", "teeth": 28}
SEVERAL_WRONG: dict[str, tuple[list[tuple[str, Any]], str, str]] = {
    "a loop that locks": (
        [
            (
                "gear",
                [
                    *GEARBOX["gear"],
                    {**GEARBOX["gear"][0], "name": "third", "teeth": 29},
                    {**GEARBOX["gear"][1], "name": "fourth", "teeth": 27},
                ],
            ),
            ("gear_pair", [*GEARBOX["gear_pair"], {"driver": "third", "driven": "fourth"}]),
        ],
        "gear_pair[1]",
        "a loop that can turn",
    ),
    "two gears on one rotor": (
        [("gear.1.rotor", "input")],
        "gear_pair[0].driven",
        'another rotor than "input"',
    ),
    "a shape for potential energy": (
        [("gear.1", {**WHEEL, "base_radius": "41.77 mm", "mass": 1, "polar_inertia": 1, "diametral_inertia": 1})],
        "gear_pair[0].stiffness.model",
        'gear "wheel" has no face_width',
    ),
    "a helix over no face": (
        [
            (
                "gear.1",
                {
                    **WHEEL,
                    "base_radius": "41.77 mm",
                    "helix_angle": "10 deg",
                    "mass": 1,
                    "polar_inertia": 1,
                    "diametral_inertia": 1,
                },
            )
        ],
        "gear[1].face_width",
        "the face width of a helical gear",
    ),
    "base radii of other teeth": (
        [("gear.1", {**WHEEL, "base_radius": "45 mm", "face_width": "6.35 mm"})],
        "gear_pair[0].driven",
        "gears of one module",
    ),
    "a gear without its rotor": ([("gear.1.rotor", GONE), ("gear.1.at", GONE)], "gear[1].rotor", "'input', 'output'"),
}


@pytest.mark.parametrize("kind", ONE_WRONG)
def test_one_wrong_value_is_named_with_its_place_and_what_was_expected(kind: str) -> None:
    check_one_wrong(*ONE_WRONG[kind])


@pytest.mark.parametrize("kind", SEVERAL_WRONG)
def test_what_does_not_go_together_is_named(kind: str) -> None:
    check_several_wrong(*SEVERAL_WRONG[kind])


@pytest.mark.parametrize(
    ("key", "size"), [("module", "60 mm"), ("diametral_pitch", "16.6666 1/m"), ("base_radius", "789.36 mm")]
)
def test_a_module_that_hardly_any_gear_has_is_doubted_at_the_key_that_gives_it(key: str, size: str) -> None:
    """Of 28 teeth of 60 mm the base circle has a radius of 28 × 30 mm cos 20°."""
    wide = {"teeth": 28, key: size, "face_width": "600 mm", "pressure_angle": "20 deg", "material": "steel"}
    pair = {"driver": "a", "driven": "b", "centre_distance": "1681 mm", "stiffness": {"model": "potential-energy"}}
    gears = {"gear": [wide | {"name": name} for name in "ab"], "gear_pair": [pair]}
    case = parse_case({"title": "mill", "material": {"steel": GEARBOX["material"]["steel"]}} | gears)
    doubts = [text for text in warnings_of(case) if "as gears have" in text]
    assert [text.partition(" ")[0] for text in doubts] == [f"gear[0].{key}", f"gear[1].{key}"]
