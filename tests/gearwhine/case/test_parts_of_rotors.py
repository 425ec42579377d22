"""Rotors, bearings and their analysis from the case file to the rotor room's own inputs, in SI."""

from __future__ import annotations

import math
import tomllib
from typing import Any

import numpy as np
import pytest

from gearwhine.case import Case, dump_case, load_case, parse_case, rotor_speeds
from gearwhine.rotors import Coupling, Rotor, Segment, ShaftMaterial

RPM = math.pi / 30.0
STEEL = {"youngs_modulus": "210 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}
BRONZE = {"youngs_modulus": "110 GPa", "poisson_ratio": 0.34, "density": "8800 kg/m^3"}
SHAFT: dict[str, Any] = {"name": "shaft", "material": "steel", "segments": [{"length": "1 m", "diameter": "50 mm"}]}
SPRING: dict[str, Any] = {"name": "spring", "rotor": "shaft", "at": 0, "stiffness": {"xx": 1e7, "yy": 2e7}}


def case_of(rotor: dict[str, Any] | None = None, bearing: dict[str, Any] | None = None, **tables: Any) -> Case:
    """Return a case of one shaft on one bearing, with these keys changed."""
    document = {"material": {"steel": STEEL, "bronze": BRONZE}, "rotor": [SHAFT | (rotor or {})]}
    return parse_case(document | {"bearing": [SPRING | (bearing or {})]} | tables)


def built(**keys: Any) -> Rotor:
    case = case_of(keys)
    return case.parts.rotors[0]


def test_a_segment_has_its_own_values_where_it_has_them_and_the_rotors_where_not() -> None:
    plain = {"length": "0.5 m", "diameter": "50 mm", "bore": "10 mm"}
    own = {"material": "bronze", "shear_coefficient": "hutchinson", "axial_force": 0}
    rotor = built(segments=[plain, plain | own], axial_force="-3 kN", shear_coefficient=0.85)
    first, second = rotor.segments
    assert isinstance(first, Segment)
    assert isinstance(second, Segment)
    assert (first.axial_force, second.axial_force) == (-3000.0, 0.0)
    assert (first.shear_coefficient, second.shear_coefficient) == (0.85, "hutchinson")
    assert first.material == ShaftMaterial.from_poisson_ratio(210e9, 0.3, 7850.0)
    assert second.material == ShaftMaterial.from_poisson_ratio(110e9, 0.34, 8800.0)
    assert not first.is_conical


def test_a_cone_is_a_frustum() -> None:
    """Volume of a frustum π h (D² + D d + d²) / 12, of the shaft less that of the bore."""
    (cone,) = built(
        segments=[{"length": "0.3 m", "diameter": "60 mm", "bore": "20 mm", "right_diameter": "90 mm"}]
    ).segments
    volume = math.pi * 0.3 / 12.0 * (0.06**2 + 0.06 * 0.09 + 0.09**2 - 3.0 * 0.02**2)
    assert cone.mass == pytest.approx(7850.0 * volume, rel=1e-13)
    (tube,) = built(
        segments=[{"length": "0.3 m", "diameter": "60 mm", "bore": "20 mm", "right_bore": "30 mm"}]
    ).segments
    volume = math.pi * 0.3 / 12.0 * (3.0 * 0.06**2 - 0.02**2 - 0.02 * 0.03 - 0.03**2)
    assert tube.mass == pytest.approx(7850.0 * volume, rel=1e-13)


def test_a_coupling_stands_in_the_row_with_its_own_numbers() -> None:
    numbers = {"lateral_stiffness": "2 N/um", "tilt_stiffness": "5 kN*m/rad", "torsional_stiffness": 2e4}
    coupling = numbers | {"axial_stiffness": "1e6 N/m", "mass": "2 kg", "polar_inertia": "0.02 kg*m^2"}
    piece = {"length": "100 mm", "diameter": "50 mm"}
    rotor = built(segments=[piece, {"length": "60 mm", "coupling": coupling}, piece])
    assert rotor.segments[1] == Coupling(0.06, 2e6, 5e3, 2e4, 1e6, 2.0, 0.02, 0.0)
    assert rotor.length == pytest.approx(0.26)


def test_a_coupling_carries_the_axial_force_of_its_rotor_or_its_own() -> None:
    numbers = {"lateral_stiffness": 2e6, "tilt_stiffness": 5e3, "torsional_stiffness": 2e4, "axial_stiffness": 1e6}
    piece, coupling = {"length": "100 mm", "diameter": "50 mm"}, {"length": "60 mm", "coupling": numbers}
    segments = [piece, coupling, piece, coupling | {"axial_force": 0}, piece, coupling | {"axial_force": "1 kN"}, piece]
    rotor = built(axial_force="-3 kN", segments=segments)
    assert [part.axial_force for part in rotor.segments] == [-3e3, -3e3, -3e3, 0.0, -3e3, 1e3, -3e3]
    assert [part.axial_force for part in built(segments=segments).segments] == [0.0] * 5 + [1e3, 0.0]


def test_a_coupling_passes_on_the_axial_force_that_the_shafts_on_both_sides_have() -> None:
    numbers = {"lateral_stiffness": 2e6, "tilt_stiffness": 5e3, "torsional_stiffness": 2e4, "axial_stiffness": 1e6}
    coupling = {"length": "60 mm", "coupling": numbers}
    pushed, pulled = ({"length": "100 mm", "diameter": "50 mm", "axial_force": force} for force in ("-2 kN", "5 kN"))
    rotor = built(axial_force="300 N", segments=[coupling, pushed, coupling, coupling, pushed, coupling, pulled])
    assert [part.axial_force for part in rotor.segments] == [300.0, -2e3, -2e3, -2e3, -2e3, 300.0, 5e3]
    rotor = built(segments=[pushed, coupling, pulled, coupling, pulled])
    assert [part.axial_force for part in rotor.segments] == [-2e3, 0.0, 5e3, 5e3, 5e3]
    rotor = built(segments=[pushed, coupling | {"axial_force": 0}, pushed])
    assert [part.axial_force for part in rotor.segments] == [-2e3, 0.0, -2e3]


def test_the_discs_of_the_friswell_rotor_are_those_of_the_book() -> None:
    """Discs 70 mm thick, 280 and 350 mm across, on a 50 mm bore, density 7810: the solid's formulas."""
    case = load_case("friswell-rotor").case
    for disc, (outer, at) in zip(case.parts.rotors[0].discs, [(0.28, 0.5), (0.35, 1.0)], strict=True):
        mass = 7810.0 * math.pi / 4.0 * (outer**2 - 0.05**2) * 0.07
        assert disc.at == at
        assert disc.mass == pytest.approx(mass, rel=1e-13)
        assert disc.polar_inertia == pytest.approx(mass * (outer**2 + 0.05**2) / 8.0, rel=1e-13)
        assert disc.diametral_inertia == pytest.approx(mass * ((outer**2 + 0.05**2) / 16.0 + 0.07**2 / 12.0), rel=1e-12)


def test_a_disc_is_of_its_own_material_its_own_density_or_the_rotors_material() -> None:
    ring = {"at": 0, "width": "40 mm", "diameter": "200 mm"}
    of_rotor, of_bronze, light = built(discs=[ring, ring | {"material": "bronze"}, ring | {"density": 1000.0}]).discs
    volume = math.pi / 4.0 * 0.2**2 * 0.04
    assert [disc.mass for disc in (of_rotor, of_bronze, light)] == pytest.approx(
        [7850.0 * volume, 8800.0 * volume, 1000.0 * volume], rel=1e-13
    )


def test_constants_and_lists_over_speed_make_one_table() -> None:
    stiffness = {"xx": ["1e7 N/m", "2e7 N/m"], "yy": "3e7 N/m", "yx": ["-1e6 N/m", 0]}
    case = case_of(bearing={"speeds": ["300 rpm", "900 rpm"], "stiffness": stiffness, "damping": {"xx": "5 N*s/mm"}})
    (bearing,) = case.parts.bearings_on("shaft")
    assert bearing.speeds is not None
    assert bearing.speeds.tolist() == pytest.approx([300.0 * RPM, 900.0 * RPM])
    assert bearing.stiffness.tolist() == [[[1e7, 0.0], [-1e6, 3e7]], [[2e7, 0.0], [0.0, 3e7]]]
    assert bearing.damping.tolist() == [[5e3, 0.0], [0.0, 0.0]]
    assert case.parts.table_range("shaft") == pytest.approx((300.0 * RPM, 900.0 * RPM))


def test_a_pedestal_stands_under_its_bearing() -> None:
    pedestal = {"mass": "40 kg", "stiffness": {"xx": 1e8, "yy": 2e8, "xy": 1e6}, "damping": {"yy": "200 N*s/m"}}
    (bearing,) = case_of(bearing={"pedestal": pedestal}).parts.bearings_on("shaft")
    assert bearing.pedestal is not None
    assert bearing.pedestal.mass == 40.0
    assert bearing.pedestal.stiffness.tolist() == [[1e8, 1e6], [0.0, 2e8]]
    assert bearing.pedestal.damping.tolist() == [[0.0, 0.0], [0.0, 200.0]]


def test_all_of_it_loads_back_equal() -> None:
    case = load_case("overhung-fan").case
    again = parse_case(tomllib.loads(dump_case(case)))
    assert again == case
    assert again.parts.bearings_on("fan") == case.parts.bearings_on("fan")


def in_rpm(speeds: tuple[float, ...]) -> list[float]:
    return [speed / RPM for speed in speeds]


def test_a_campbell_diagram_has_its_own_speeds_else_the_sweeps_else_those_around_operation() -> None:
    operation, sweep = {"speed": "1000 rpm"}, {"speed": ["100 rpm", "700 rpm"]}
    assert rotor_speeds(case_of(), "shaft").campbell == ()
    around = in_rpm(rotor_speeds(case_of(operation=operation), "shaft").campbell)
    assert around == pytest.approx(np.linspace(0.0, 1500.0, 51).tolist(), abs=1e-9)
    swept = case_of(operation=operation, sweep=sweep)
    assert in_rpm(rotor_speeds(swept, "shaft").campbell) == pytest.approx([100.0, 700.0])
    assert in_rpm(rotor_speeds(swept, "shaft").whirl) == pytest.approx([1000.0, 100.0, 700.0])
    own = {"speed": {"from": "0 rpm", "to": "300 rpm", "step": "150 rpm"}}
    case = case_of(operation=operation, sweep=sweep, rotor_analysis=own)
    assert in_rpm(rotor_speeds(case, "shaft").campbell) == pytest.approx([0.0, 150.0, 300.0])
    finer = in_rpm(rotor_speeds(case, "shaft").response)
    assert finer == pytest.approx(np.linspace(0.0, 300.0, 301).tolist(), abs=1e-9)
    chosen = own | {"unbalance_response": {"speed": ["5 rpm"]}}
    case = case_of(operation=operation, rotor_analysis=chosen)
    assert in_rpm(rotor_speeds(case, "shaft").response) == pytest.approx([5.0])


def test_speeds_are_in_the_sense_of_operation() -> None:
    """A machine that turns clockwise does so at every speed that its case lists."""
    clockwise = {"speed": "-1000 rpm"}
    swept = case_of(operation=clockwise, sweep={"speed": ["100 rpm", "700 rpm"]})
    assert in_rpm(rotor_speeds(swept, "shaft").whirl) == pytest.approx([-1000.0, -100.0, -700.0])
    assert in_rpm(rotor_speeds(swept, "shaft").campbell) == pytest.approx([-700.0, -100.0])
    own = {"speed": ["0 rpm", "300 rpm"], "unbalance_response": {"speed": ["20 rpm", "5 rpm"]}}
    case = case_of(operation=clockwise, rotor_analysis=own)
    assert in_rpm(rotor_speeds(case, "shaft").campbell) == pytest.approx([-300.0, 0.0])
    assert in_rpm(rotor_speeds(case, "shaft").response) == pytest.approx([-5.0, -20.0])
    # Its driven shaft turns the other way.
    pair = load_case("spur-pair", ["operation.speed=-5500 rpm", "sweep.speed=['1000 rpm']"]).case
    assert in_rpm(rotor_speeds(pair, "output").whirl) == pytest.approx([5500.0, 1000.0])


def test_speeds_that_nobody_named_stay_within_the_tables() -> None:
    table = {"speeds": ["300 rpm", "1200 rpm"], "stiffness": {"xx": [1e7, 2e7], "yy": 1e7}}
    speeds = in_rpm(rotor_speeds(case_of(bearing=table, operation={"speed": "-1000 rpm"}), "shaft").campbell)
    assert (speeds[0], speeds[-1], len(speeds)) == (pytest.approx(-1200.0), pytest.approx(-300.0), 51)
    (bearing,) = case_of(bearing=table).parts.bearings_on("shaft")
    for speed in speeds:
        assert bearing.at_speed(speed * RPM).speeds is None  # the table holds it


def test_a_driven_rotor_has_the_speeds_that_its_gears_give_it() -> None:
    case = load_case("spur-pair", ["gear.wheel.teeth=56", "rotor.output.axis=['88.9 mm', '0 mm']"]).case
    assert in_rpm(rotor_speeds(case, "output").whirl) == pytest.approx([-2750.0])
    assert in_rpm(rotor_speeds(case, "output").campbell)[0] == pytest.approx(-4125.0)
    assert in_rpm(rotor_speeds(case, "input").campbell)[-1] == pytest.approx(8250.0)


def test_a_stiffness_map_goes_in_equal_ratios_and_ends_where_it_says() -> None:
    given = {"stiffness_map": {"from": "1e5 N/m", "to": "1e9 N/m", "points": 9}}
    analysis = case_of(rotor_analysis=given).rotor_analysis
    assert analysis is not None
    assert analysis.stiffness_map is not None
    stiffnesses = np.array(analysis.stiffness_map.stiffnesses)
    assert stiffnesses[1:] / stiffnesses[:-1] == pytest.approx(np.full(8, math.sqrt(10.0)), rel=1e-12)
    assert stiffnesses[-1] == 1e9


def test_a_gear_without_a_face_width_is_a_disc_on_one_section() -> None:
    inertia = {"mass": "2 kg", "polar_inertia": "3e-3 kg*m^2", "diametral_inertia": "2e-3 kg*m^2"}
    gear = {"name": "pinion", "rotor": "shaft", "at": "0.5 m", "teeth": 40, "base_radius": "60 mm", **inertia}
    unknown, wide = (case_of(gear=[gear | width]) for width in ({}, {"face_width": "60 mm"}))
    rotor = unknown.parts.rotors[0]
    assert not rotor.stiffness_diameters
    assert [(disc.at, disc.mass) for disc in rotor.discs] == [(0.5, 2.0)]
    assert wide.parts.rotors[0].stiffness_diameters
