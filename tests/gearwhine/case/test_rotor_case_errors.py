"""Every wrong key of rotors, bearings and their analysis is reported by key path, value and expectation."""

from __future__ import annotations

from typing import Any

import pytest
from broken_cases import GONE, broken, check_one_wrong, check_several_wrong, problems

from gearwhine.case import parse_case

COUPLING = {
    "lateral_stiffness": "2e7 N/m",
    "tilt_stiffness": "5e3 N*m/rad",
    "torsional_stiffness": "2e4 N*m/rad",
    "axial_stiffness": "1e6 N/m",
    "mass": "2 kg",
}
SOUND: dict[str, Any] = {
    "material": {"steel": {"youngs_modulus": "210 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}},
    "rotor": [
        {
            "name": "fan",
            "material": "steel",
            "axial_force": "-2 kN",
            "shear_coefficient": 0.9,
            "segments": [
                {"length": "300 mm", "diameter": "60 mm", "bore": "10 mm"},
                {"length": "100 mm", "diameter": "60 mm", "right_diameter": "80 mm", "axial_force": 0},
                {"length": "50 mm", "coupling": COUPLING},
            ],
            "discs": [
                {"at": "0 mm", "width": "40 mm", "diameter": "400 mm", "bore": "60 mm"},
                {"at": "300 mm", "mass": "1 kg"},
            ],
            "unbalance": [{"at": "0 mm", "moment": "1e-4 kg*m"}],
            "bow": [{"at": "0 mm", "amplitude": "20 um"}, {"at": "200 mm", "amplitude": "5 um", "phase": "90 deg"}],
        }
    ],
    "bearing": [
        {
            "name": "left",
            "rotor": "fan",
            "at": "100 mm",
            "speeds": ["500 rpm", "1500 rpm", "4000 rpm"],
            "stiffness": {"xx": ["1e7 N/m", "2e7 N/m", "3e7 N/m"], "yy": "2e7 N/m"},
            "damping": {"xx": "1e4 N*s/m", "yy": ["1e4 N*s/m", "8e3 N*s/m", "6e3 N*s/m"]},
            "pedestal": {"mass": "50 kg", "stiffness": {"xx": "1e8 N/m", "yy": "3e8 N/m"}},
        },
        {"name": "right", "rotor": "fan", "at": "400 mm", "stiffness": {"xx": "2e7 N/m", "yy": "2e7 N/m"}},
    ],
    "operation": {"speed": "3000 rpm"},
    "rotor_analysis": {
        "speed": {"from": "500 rpm", "to": "4000 rpm", "step": "500 rpm"},
        "modes": 6,
        "stiffness_map": {"from": "1e6 N/m", "to": "1e9 N/m", "points": 5},
        "unbalance_response": {"speed": ["600 rpm"], "probes": [{"name": "a", "rotor": "fan", "at": "100 mm"}]},
        "gravity": ["0 m/s^2", "-9.81 m/s^2", 0],
    },
}
CONE, LINK, ROUND, POINT = (f"rotor.0.{part}" for part in ("segments.1", "segments.2", "discs.0", "discs.1"))
LINK_AT = "rotor[0].segments[2].coupling"
RESPONSE = "rotor_analysis.unbalance_response"

ONE_WRONG = {
    # segments
    "cone to nothing": (f"{CONE}.right_diameter", "0 mm", "rotor[0].segments[1].right_diameter", "above 0 m"),
    "cone into its bore": ("rotor.0.segments.0.right_diameter", "9 mm", "rotor[0].segments[0].right_diameter", "bore"),
    "bore of a cone": (f"{CONE}.right_bore", "80 mm", "rotor[0].segments[1].right_bore", "0.08 m at the right end"),
    "force in kg": (f"{CONE}.axial_force", "3 kg", "rotor[0].segments[1].axial_force", "a force such as '1 kN'"),
    "force of a rotor": ("rotor.0.axial_force", "much", "rotor[0].axial_force", "a force"),
    "shear formula": (
        "rotor.0.shear_coefficient",
        "couper",
        "rotor[0].shear_coefficient",
        "'cowper', 'hutchinson', or",
    ),
    "shear coefficient upside down": (f"{CONE}.shear_coefficient", 1.8, "rotor[0].segments[1].shear_coefficient", "1"),
    "no shear": (f"{CONE}.shear_coefficient", 0, "rotor[0].segments[1].shear_coefficient", "above 0"),
    # couplings
    "no stiffness": (
        f"{LINK}.coupling.tilt_stiffness",
        GONE,
        f"{LINK_AT}.tilt_stiffness",
        "a tilting stiffness above 0 N*m/rad",
    ),
    "rigid": (f"{LINK}.coupling.axial_stiffness", "inf N/m", f"{LINK_AT}.axial_stiffness", "a stiffness"),
    "torsion in N/m": (
        f"{LINK}.coupling.torsional_stiffness",
        "2e4 N/m",
        f"{LINK_AT}.torsional_stiffness",
        "(stiffness)",
    ),
    "unknown of a coupling": (f"{LINK}.coupling.stiffness", 1, f"{LINK_AT}.stiffness", "did you mean"),
    "a coupling has no diameter": (
        f"{LINK}.diameter",
        "60 mm",
        "rotor[0].segments[2].diameter",
        "another form of this",
    ),
    "a coupling has length": (f"{LINK}.length", "0 mm", "rotor[0].segments[2].length", "above 0 m"),
    "a name for a coupling": (f"{LINK}.coupling", "disc", "rotor[0].segments[2].coupling", "a table"),
    # discs
    "disc in its bore": (f"{ROUND}.bore", "0.4 m", "rotor[0].discs[0].bore", "smaller than the diameter of 0.4 m"),
    "two densities": (
        ROUND,
        {"at": 0, "width": 1, "diameter": 1, "material": "steel", "density": 1},
        "rotor[0].discs[0].density",
        "not both",
    ),
    "disc of what": (f"{ROUND}.material", "steal", "rotor[0].discs[0].material", "did you mean 'steel'?"),
    "mass of a size": (f"{ROUND}.mass", "4 kg", "rotor[0].discs[0].mass", "another form of this table"),
    "half a size": (f"{ROUND}.width", GONE, "rotor[0].discs[0].width", "a length above 0 m"),
    "point without mass": (f"{POINT}.mass", GONE, "rotor[0].discs[1].mass", "a mass of at least 0 kg"),
    # what is kept, and bows
    "no modes": ("rotor.0.modes", 0, "rotor[0].modes", "a whole number from 1"),
    "no limit": ("rotor.0.frequency_limit", "0 Hz", "rotor[0].frequency_limit", "above 0 Hz"),
    "bow off the shaft": ("rotor.0.bow.0.at", "1 m", "rotor[0].bow[0].at", "which is 450 mm long"),
    "bow twice": ("rotor.0.bow.1.at", "0 mm", "rotor[0].bow[1].at", "another point of the bow is here"),
    "bow without size": ("rotor.0.bow.0.amplitude", GONE, "rotor[0].bow[0].amplitude", "a length"),
    # bearings
    "one speed": ("bearing.0.speeds", ["500 rpm"], "bearing[0].speeds", "at least 2 entries"),
    "speeds back": ("bearing.0.speeds.2", "900 rpm", "bearing[0].speeds[2]", "above the one before it"),
    "table of two": ("bearing.0.stiffness.xx", [1, 2], "bearing[0].stiffness.xx", "each of the 3 speeds (there are 2)"),
    "table of dampings": ("bearing.0.damping.xy", [1], "bearing[0].damping.xy", "each of the 3 speeds (there are 1)"),
    "table of what": ("bearing.1.stiffness.xx", [1, 2], "bearing[1].stiffness.xx", "the key 'speeds' of the bearing"),
    "speeds of nothing": ("bearing.1.speeds", [1, 500], "bearing[1].speeds", "a list for each of these speeds"),
    "entry of a table": (
        "bearing.0.stiffness.xx",
        [1, "0 N", 3],
        "bearing[0].stiffness.xx[1]",
        "a stiffness such as '1.2e8 N/m'",
    ),
    "early end": ("operation.speed", "4500 rpm", "bearing[0].speeds", "500 to 4500 rpm (it goes from 500 to 4000 rpm)"),
    "early end of a sweep": ("sweep", {"speed": ["0 rpm"]}, "bearing[0].speeds", "0 to 4000 rpm (it goes from 500"),
    "early end of an analysis": ("rotor_analysis.speed", ["100 rpm"], "bearing[0].speeds", "100 to 3000 rpm"),
    "early end of a response": (f"{RESPONSE}.speed", ["9000 rpm"], "bearing[0].speeds", "500 to 9000 rpm"),
    "loose pedestal": ("bearing.0.pedestal.stiffness", GONE, "bearing[0].pedestal.stiffness", "a table with xx"),
    "pedestal that falls": (
        "bearing.0.pedestal.stiffness",
        {"xx": 1e6, "yy": 1e6, "xy": 1e6, "yx": 1e6},
        "bearing[0].pedestal.stiffness.xy",
        "so that it holds",
    ),
    "pedestal over speed": (
        "bearing.0.pedestal.stiffness.xx",
        [1, 2, 3],
        "bearing[0].pedestal.stiffness.xx",
        "a stiffness such as",
    ),
    "heavy on nothing": ("bearing.0.pedestal.mass", "-1 kg", "bearing[0].pedestal.mass", "of at least 0 kg"),
    # analysis
    "modes of an analysis": ("rotor_analysis.modes", 0, "rotor_analysis.modes", "a whole number from 1 to 200"),
    "speeds of an analysis": ("rotor_analysis.speed", [], "rotor_analysis.speed", "at least 1 entries"),
    "map backwards": ("rotor_analysis.stiffness_map.to", "1e5 N/m", "rotor_analysis.stiffness_map.to", "above 'from'"),
    "map of a point": ("rotor_analysis.stiffness_map.points", 1, "rotor_analysis.stiffness_map.points", "from 2"),
    "map from nowhere": (
        "rotor_analysis.stiffness_map",
        {"to": "1e9 N/m"},
        "rotor_analysis.stiffness_map.from",
        "a stiffness above 0 N/m",
    ),
    "probe of what": (f"{RESPONSE}.probes.0.rotor", "fna", f"{RESPONSE}.probes[0].rotor", "did you mean 'fan'?"),
    "probe off the shaft": (f"{RESPONSE}.probes.0.at", "1 m", f"{RESPONSE}.probes[0].at", "which is 450 mm long"),
    "probe at an angle": (f"{RESPONSE}.probes.0.angle", "20 %", f"{RESPONSE}.probes[0].angle", "an angle"),
    "gravity as a speed": ("rotor_analysis.gravity.1", "9.81 m/s", "rotor_analysis.gravity[1]", "an acceleration"),
    "gravity downwards": ("rotor_analysis.gravity", "9.81 m/s^2", "rotor_analysis.gravity", "a list"),
    "crushing gravity": ("rotor_analysis.gravity.0", 1e5, "rotor_analysis.gravity[0]", "at most 10000 m/s^2"),
    "misspelt": ("rotor_analysis.stifness_map", {}, "rotor_analysis.stifness_map", "did you mean 'stiffness_map'?"),
}


@pytest.mark.parametrize("kind", ONE_WRONG)
def test_one_wrong_value_is_named_with_its_place_and_what_was_expected(kind: str) -> None:
    check_one_wrong(*ONE_WRONG[kind], sound=SOUND)


def test_the_sound_case_is_sound() -> None:
    assert parse_case(SOUND).rotor[0].length == pytest.approx(0.45)


SEVERAL_WRONG = {
    "modes and a limit": (
        [("rotor.0.modes", 3), ("rotor.0.frequency_limit", "2 kHz")],
        "rotor[0].frequency_limit",
        "not both",
    ),
    "a pedestal in the housing": (
        [("bearing.0.seat", "bore"), ("housing", {"seat": [{"name": "bore"}]})],
        "bearing[0].pedestal",
        'no pedestal under a bearing in seat "bore"',
    ),
    "two probes of one name": (
        [(f"{RESPONSE}.probes", [{"name": "a", "rotor": "fan", "at": 0}] * 2)],
        f"{RESPONSE}.probes[1].name",
        f"{RESPONSE}.probes[0] has this one",
    ),
    "an analysis of no rotor": ([("rotor", GONE), ("bearing", GONE)], "rotor", "for the [rotor_analysis]"),
}


@pytest.mark.parametrize("kind", SEVERAL_WRONG)
def test_what_does_not_go_together_is_named(kind: str) -> None:
    check_several_wrong(*SEVERAL_WRONG[kind], sound=SOUND)


def test_everything_wrong_comes_at_once() -> None:
    report = problems(
        broken(
            (f"{CONE}.right_bore", "90 mm"),
            (f"{LINK}.coupling.mass", "-2 kg"),
            ("bearing.1.stiffness.xy", [1.0]),
            ("rotor_analysis.modes", 1.5),
            ("bearing.0.stiffness.yy", [1, 2]),
            sound=SOUND,
        )
    )
    assert len(report) == 5
    assert any('bearing[0].stiffness.yy (bearing "left")' in line for line in report)
