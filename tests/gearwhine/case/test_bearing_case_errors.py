"""Every kind of wrong bearing is reported by key path, value and expectation."""

from __future__ import annotations

from typing import get_args

import pytest
from broken_cases import check_one_wrong

from gearwhine.case.bearings import CatalogueType
from gearwhine.rotors.rolling_bearings.catalogue import CatalogueType as LibraryType

BALLS = {"count": 7, "element_diameter": "8 mm", "pitch_diameter": "43.5 mm"}
ROLLERS = {**BALLS, "element_length": "8 mm"}
RINGS = {"type": "deep-groove", "bore": "25 mm", "outer_diameter": "52 mm", "width": "15 mm"}
ONE_WRONG = {
    # ranges
    # keys, forms and choices
    "load of a spring": ("bearing.0.load", {"x": "5 N"}, "bearing[0].load", "only the stiffness of a rolling bearing"),
    "no stiffness along x": (
        "bearing.2.stiffness",
        {"yy": "1e8 N/m"},
        "bearing[2].stiffness.xx",
        "a stiffness such as '1.2e8 N/m'",
    ),
    "rollers without length": (
        "bearing.2.stiffness",
        {"rolling": {"element": "roller", "count": 7, "element_diameter": "8 mm", "pitch_diameter": "43.5 mm"}},
        "bearing[2].stiffness.rolling.element_length",
        "the length of the rollers",
    ),
    "preload on rollers": (
        "bearing.2.stiffness",
        {
            "rolling": {
                "catalogue": {"type": "cylindrical-roller", "bore": 0.025, "outer_diameter": 0.052, "width": 0.015},
                "preload": "50 N",
            }
        },
        "bearing[2].stiffness.rolling.preload",
        "cylindrical rollers carry no axial load",
    ),
    "static rating of a geometry": (
        "bearing.2.stiffness",
        {"rolling": {**BALLS, "static_rating": "20 kN"}},
        "bearing[2].stiffness.rolling.static_rating",
        "it belongs to another form of this table",
    ),
    "catalogue in inches": (
        "bearing.2.stiffness",
        {"rolling": {"catalogue": {"type": "deep-groove", "bore": "5 cm", "outer_diameter": "2 in", "width": "x"}}},
        "bearing[2].stiffness.rolling.catalogue.width",
        "a length",
    ),
    "ring inside out": (
        "bearing.2.stiffness",
        {"rolling": {"catalogue": {"type": "deep-groove", "bore": 0.06, "outer_diameter": 0.05, "width": 0.015}}},
        "bearing[2].stiffness.rolling.catalogue.outer_diameter",
        "more than the bore of 0.06 m",
    ),
    "unknown catalogue": (
        "bearing.2.stiffness",
        {"rolling": {"catalogue": {"type": "tapered", "bore": 0.03, "outer_diameter": 0.05, "width": 0.015}}},
        "bearing[2].stiffness.rolling.catalogue.type",
        "'tapered-roller' or 'spherical-roller'",
    ),
    "tapered rollers without angle": (
        "bearing.2.stiffness",
        {"rolling": {**ROLLERS, "element": "tapered-roller"}},
        "bearing[2].stiffness.rolling.contact_angle",
        "more than 0, the contact angle of a tapered-roller",
    ),
    "angle of cylindrical rollers": (
        "bearing.2.stiffness",
        {"rolling": {**ROLLERS, "element": "roller", "contact_angle": "15 deg"}},
        "bearing[2].stiffness.rolling.contact_angle",
        'rollers are cylindrical; element = "tapered-roller" has one',
    ),
    "grooves of rollers": (
        "bearing.2.stiffness",
        {"rolling": {**ROLLERS, "element": "roller", "inner_groove": 0.52}},
        "bearing[2].stiffness.rolling.inner_groove",
        "only balls run in grooves",
    ),
    "groove of a sphere": (
        "bearing.2.stiffness",
        {"rolling": {**BALLS, "element": "self-aligning-ball", "contact_angle": "10 deg", "outer_groove": 0.53}},
        "bearing[2].stiffness.rolling.outer_groove",
        "the outer raceway is a sphere",
    ),
    "profile of balls": (
        "bearing.2.stiffness",
        {"rolling": {**BALLS, "profile": "straight"}},
        "bearing[2].stiffness.rolling.profile",
        "only cylindrical and tapered rollers",
    ),
    "osculation of tapered rollers": (
        "bearing.2.stiffness",
        {"rolling": {**ROLLERS, "element": "tapered-roller", "contact_angle": "15 deg", "osculation": 0.98}},
        "bearing[2].stiffness.rolling.osculation",
        "only spherical rollers have a contour",
    ),
    "two spherical bearings": (
        "bearing.2.stiffness",
        {
            "rolling": {
                **ROLLERS,
                "element": "spherical-roller",
                "arrangement": "tandem",
                "spacing": "20 mm",
            }
        },
        "bearing[2].stiffness.rolling.arrangement",
        "'single': a spherical-roller bearing carries axial load both ways by itself",
    ),
    "offset of a pair": (
        "bearing.2.stiffness",
        {
            "rolling": {
                **BALLS,
                "contact_angle": "25 deg",
                "arrangement": "back to back",
                "spacing": "20 mm",
                "axial_offset": "5 um",
            }
        },
        "bearing[2].stiffness.rolling.axial_offset",
        "two rows have the preload between them",
    ),
    "flanges of balls": (
        "bearing.2.stiffness",
        {"rolling": {**BALLS, "flanges": "one", "flange_stiffness": "1e8 N/m"}},
        "bearing[2].stiffness.rolling.flanges",
        "only cylindrical rollers run between flanges",
    ),
    "flanges without stiffness": (
        "bearing.2.stiffness",
        {"rolling": {**ROLLERS, "element": "roller", "flanges": "both"}},
        "bearing[2].stiffness.rolling.flange_stiffness",
        "of each roller between its flanges",
    ),
    "four-point law": (
        "bearing.2.stiffness",
        {"rolling": {**BALLS, "element": "four-point-ball", "contact_angle": "35 deg", "law": "nonlinear"}},
        "bearing[2].stiffness.rolling.law",
        "'linear': four-point balls have no law in the transient",
    ),
    "mounting without rings": (
        "bearing.2.stiffness",
        {"rolling": {**BALLS, "mounting": {"inner_interference": "10 um", "bore": "30 mm"}}},
        "bearing[2].stiffness.rolling.mounting.outer_diameter",
        "the outer diameter of the bearing",
    ),
    "mounting with rings twice": (
        "bearing.2.stiffness",
        {"rolling": {"catalogue": RINGS, "mounting": {"bore": "25 mm"}}},
        "bearing[2].stiffness.rolling.mounting.bore",
        "the catalogue has it",
    ),
    "angle of a deep groove": (
        "bearing.2.stiffness",
        {"rolling": {"catalogue": {**RINGS, "contact_angle": "15 deg"}}},
        "bearing[2].stiffness.rolling.catalogue.contact_angle",
        "a deep-groove bearing has none",
    ),
    "axial factor of balls": (
        "bearing.2.stiffness",
        {"rolling": {"catalogue": {**RINGS, "axial_factor": 1.6}}},
        "bearing[2].stiffness.rolling.catalogue.axial_factor",
        "only tapered and spherical rollers",
    ),
    "angle given twice": (
        "bearing.2.stiffness",
        {
            "rolling": {
                "catalogue": {**RINGS, "type": "tapered-roller", "axial_factor": 1.6, "contact_angle": "14 deg"},
            }
        },
        "bearing[2].stiffness.rolling.catalogue.axial_factor",
        "nothing beside contact_angle",
    ),
    "pair without spacing": (
        "bearing.2.stiffness",
        {
            "rolling": {
                "count": 7,
                "element_diameter": "11.5 mm",
                "pitch_diameter": "43.5 mm",
                "preload": "10 N",
                "arrangement": "tandem",
            }
        },
        "bearing[2].stiffness.rolling.spacing",
        "the distance between the two rows",
    ),
    "matrix that pushes": (
        "bearing.0.stiffness",
        {"matrix": [[0.0] * 3 + ["-1 N/m"] * 2] * 5},
        "bearing[0].stiffness.matrix[0][3]",
        "a force per angle",
    ),
    "matrix of four rows": (
        "bearing.1.damping",
        {"matrix": [[1.0] * 5] * 4},
        "bearing[1].damping.matrix",
        "five rows of five",
    ),
    "matrix": ("bearing.0.stiffness", {"matrix": [[1.0]]}, "bearing[0].stiffness.matrix", "five rows of five"),
    # names
    "rotor of a bearing": ("bearing.0.rotor", "inptu", "bearing[0].rotor", "did you mean 'input'?"),
    "seat": ("bearing.0.seat", "input-bakc", "bearing[0].seat", "did you mean 'input-back'?"),
    # places
    "bearing off the rotor": ("bearing.0.at", "1 m", "bearing[0].at", "which is 200 mm long"),
    "bearing off its wall": ("bearing.0.at", "100 mm", "bearing[0].at", 'of seat "input-back" along z'),
}


@pytest.mark.parametrize("kind", ONE_WRONG)
def test_one_wrong_value_is_named_with_its_place_and_what_was_expected(kind: str) -> None:
    check_one_wrong(*ONE_WRONG[kind])


def test_a_case_has_the_library_s_types_of_bearings() -> None:
    assert get_args(CatalogueType) == get_args(LibraryType)
