"""Every kind of wrong bearing is reported by key path, value and expectation."""

from __future__ import annotations

import pytest
from broken_cases import check_one_wrong

ONE_WRONG = {
    # ranges
    "bearing stiffness": ("bearing.0.stiffness.xx", "0 N/m", "bearing[0].stiffness.xx", "above 0 N/m"),
    # keys, forms and choices
    "load of a spring": ("bearing.0.load", {"x": "5 N"}, "bearing[0].load", "only the stiffness of a rolling bearing"),
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
        "'deep-groove', 'angular-contact' or 'cylindrical-roller'",
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
        {"matrix": [[0.0] * 3 + [-1.0] * 2] * 5},
        "bearing[0].stiffness.matrix[3][3]",
        "at least 0",
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
