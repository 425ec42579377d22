"""Bearings by 5x5 matrix and by rolling geometry, through the command."""

import copy
import json
import math
import tomllib
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from coupled_cases import coupled

from gearwhine.case import CaseError, RollingStiffness, parse_case
from gearwhine.cli import run_command
from gearwhine.coupling import coupled_modes
from gearwhine.output.manifest import opened_dataset
from gearwhine.results.rotors import rotors_document
from gearwhine.rotors.rolling_bearings import (
    FourPointRow,
    RingFit,
    RollerRow,
    RollingBearing,
    SphericalRollerRow,
    TaperedRollerRow,
    operating_clearance,
    static_rating,
)
from gearwhine.solve.rotors import solve_rotors

FRISWELL = tomllib.loads(files("gearwhine.cases").joinpath("friswell-rotor.toml").read_text(encoding="utf-8"))
RINGS = {"bore": "50 mm", "outer_diameter": "90 mm", "width": "20 mm"}
ISO = {"count": 7, "element_diameter": "11.5 mm", "pitch_diameter": "43.5 mm"}


def journals(diameter: str) -> list[dict[str, str]]:
    """Segments of the published rotor, its ends turned down to the bore of small bearings."""
    lengths = {"0.02 m": diameter, "0.48 m": "50 mm"}
    end = [{"length": length, "diameter": thick} for length, thick in lengths.items()]
    return [*end, {"length": "0.5 m", "diameter": "50 mm"}, *end[::-1]]


def inline(tables: list[dict[str, str]]) -> str:
    """The tables in TOML on one line."""
    rows = ("{ " + ", ".join(f"{key} = '{value}'" for key, value in table.items()) + " }" for table in tables)
    return "[" + ", ".join(rows) + "]"


def friswell(journal: str = "50 mm", **bearing: Any) -> dict[str, Any]:
    """The published rotor with both bearings changed, and its journals."""
    document = copy.deepcopy(FRISWELL)
    document["rotor"][0]["segments"] = journals(journal)
    for entry in document["bearing"]:
        entry.update(copy.deepcopy(bearing))
    return document


def test_the_iso_bearing_under_a_case() -> None:
    case = parse_case(friswell("30 mm", stiffness={"rolling": ISO}, load={"x": "1 kN"}))
    state = case.parts.rolling_states[case.bearing[0].name]
    assert state is not None
    assert 1e6 * state.displacement[0] == pytest.approx(15.110, rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    "rolling",
    [
        {"catalogue": {"type": "deep-groove", "bore": "50 mm", "outer_diameter": "90 mm", "width": "20 mm"}},
        {
            "catalogue": {"type": "angular-contact", "bore": "50 mm", "outer_diameter": "90 mm", "width": "20 mm"},
            "arrangement": "back to back",
            "spacing": "20 mm",
            "preload": "400 N",
        },
        {
            "catalogue": {"type": "angular-contact", "bore": "50 mm", "outer_diameter": "90 mm", "width": "20 mm"},
            "carries": "-z",
            "preload": "600 N",
        },
        {
            "element": "roller",
            "count": 16,
            "element_diameter": "11 mm",
            "element_length": "11 mm",
            "pitch_diameter": "70 mm",
        },
        {
            "element": "tapered-roller",
            "count": 17,
            "element_diameter": "9 mm",
            "element_length": "14 mm",
            "pitch_diameter": "61 mm",
            "contact_angle": "14 deg",
            "arrangement": "face to face",
            "spacing": "25 mm",
            "preload": "800 N",
        },
        {"catalogue": {**RINGS, "type": "four-point"}, "clearance": "-2 um"},
        {"catalogue": {**RINGS, "type": "double-row-angular-contact", "width": "30.2 mm"}, "clearance": "-4 um"},
    ],
)
def test_rolling_geometry_is_the_matrix_that_it_makes(rolling: dict[str, Any]) -> None:
    """Frequencies at rest, whirl and the coupled system agree with those of the printed 5x5 matrix."""
    case = parse_case(friswell(stiffness={"rolling": rolling}, load={"y": "-400 N"}))
    (solved,) = solve_rotors(case, mode_count=4)
    document = rotors_document((solved,))["rotors"][0]
    told = document["rolling_bearings"][0]
    assert told["loaded_elements"] > 0
    assert told["residual"] < 1e-10
    assert told["load_n"] == pytest.approx([0.0, -400.0, 0.0], abs=1e-6)
    # Pressed down it goes down; what the preload pushes along +z or -z is told by its displacement.
    assert told["displacement_m"][1] < 0.0
    if rolling.get("arrangement") is None and "carries" in rolling:
        assert told["displacement_m"][2] != 0.0
    # A matrix has no damping of its own, rolling elements have 8 µs times their stiffness.
    by_matrix = parse_case(friswell(stiffness={"matrix": told["stiffness"]}, damping={"over_stiffness": "8 us"}))
    same = rotors_document(solve_rotors(by_matrix, mode_count=4))["rotors"][0]
    np.testing.assert_allclose(same["lateral_hz"], document["lateral_hz"], rtol=1e-9)
    np.testing.assert_allclose(same["whirl"][0]["frequency_hz"], document["whirl"][0]["frequency_hz"], rtol=1e-9)
    machine = coupled(case)
    of_machine = coupled_modes(machine.system).frequencies_hz
    # The system keeps more modes and damps the shaft by half a percent; its lowest whirl is the rotor's own.
    lowest = sorted(frequency for frequency in of_machine if frequency > 1.0)[:4]
    np.testing.assert_allclose(lowest, document["whirl"][0]["frequency_hz"][:4], rtol=2e-3)


def test_every_element_of_a_case_is_the_row_of_its_numbers() -> None:
    """Rows, directions and angles of the built bearing, against the library's own rows."""
    size = {"count": 17, "element_diameter": "9 mm", "pitch_diameter": "61 mm", "contact_angle": "0.2 rad"}
    length, angle = {"element_length": "10 mm"}, 0.2

    def built(**rolling: Any) -> RollingBearing:
        case = parse_case(friswell(stiffness={"rolling": rolling}, load={"x": "1 kN", "z": "100 N"}))
        stiffness = case.bearing[0].stiffness
        assert isinstance(stiffness, RollingStiffness)
        return stiffness.rolling.build("left")

    tapered = built(**size, **length, element="tapered-roller", carries="-z", axial_offset="5 um")
    assert tapered.rows == (TaperedRollerRow(17, 9e-3, 10e-3, 61e-3, angle=angle, axial_offset=5e-6, direction=-1),)
    spherical = built(**size, **length, element="spherical-roller", osculation=0.97)
    assert [row.direction for row in spherical.rows] == [1, -1]
    assert spherical.rows[0] == SphericalRollerRow(17, 9e-3, 10e-3, 61e-3, angle=angle, osculation=0.97)
    four = built(**size, element="four-point-ball", inner_groove=0.515)
    assert four.rows == (FourPointRow(17, 9e-3, 61e-3, angle, 0.515, 0.53),)
    aligning = built(**size, element="self-aligning-ball")
    assert [row.position for row in aligning.rows] == pytest.approx(
        [-30.5e-3 * math.tan(angle), 30.5e-3 * math.tan(angle)]
    )
    size.pop("contact_angle")
    flanged = built(**size, **length, element="roller", flanges="one", flange_stiffness="2e7 N/m", preload="100 N")
    assert flanged.rows == (RollerRow(17, 9e-3, 10e-3, 61e-3, flanges="one", flange_stiffness=2e7),)
    assert flanged.axial_preload == 100.0
    factor = built(catalogue={**RINGS, "type": "tapered-roller", "axial_factor": 1.6}, static_rating="80 kN")
    assert math.tan(factor.rows[0].contact_angle) == pytest.approx(0.25)
    assert static_rating(factor.rows[0]) == pytest.approx(80e3)
    assert factor.estimated
    assert not flanged.estimated


def test_fits_and_heat_change_the_clearance() -> None:
    """As the library's thick rings have it, with raceways at the pitch circle less and plus the ball."""
    fits = {"inner_interference": "12 um", "smoothing": "2 um", "shaft_bore": "20 mm", "inner_rise": "50 K"}
    housing = {"outer_interference": "5 um", "housing_modulus": "70 GPa", "housing_expansion": "23e-6 1/K"}
    more = {"outer_rise": "40 K", "housing_rise": "30 K", "housing_diameter": "120 mm", "housing_poisson_ratio": 0.33}
    rings = {"bore": "40 mm", "outer_diameter": "80 mm"}
    sizes = {"count": 9, "element_diameter": "12 mm", "pitch_diameter": "60 mm", "clearance": "15 um"}
    rolling = {**sizes, "mounting": {**fits, **housing, **more, **rings}}
    case = parse_case(friswell(stiffness={"rolling": rolling}, load={"x": "1 kN"}))
    state = case.parts.rolling_states[case.bearing[0].name]
    assert state is not None
    expected = operating_clearance(
        15e-6,
        40e-3,
        48e-3,
        72e-3,
        80e-3,
        shaft=RingFit(12e-6, 20e-3, 2e-6, temperature_rise=50.0),
        housing=RingFit(5e-6, 0.12, 2e-6, 70e9, 0.33, 23e-6, 30.0),
        inner_rise=50.0,
        outer_rise=40.0,
    )
    assert expected.clearance < 10e-6
    assert state.bearing.rows[0].clearance == pytest.approx(expected.clearance, rel=1e-12)


def test_a_rolling_bearing_stands_on_a_pedestal_with_damping_over_speed() -> None:
    stands = {"stiffness": {"rolling": ISO}, "load": {"x": "1 kN"}}
    tabled = {"speeds": [0.0, 1000.0], "damping": {"xx": [100.0, 300.0], "yy": 50.0}}
    pedestal = {"mass": "4 kg", "stiffness": {"xx": 1e8, "yy": 2e8}}
    case = parse_case(friswell("30 mm", **stands, **tabled, pedestal=pedestal))
    bearing = case.parts.bearings_on("shaft")[0]
    state = case.parts.rolling_states[case.bearing[0].name]
    assert state is not None
    assert bearing.pedestal is not None
    assert bearing.pedestal.mass == 4.0
    turning = bearing.at_speed(1000.0)
    np.testing.assert_array_equal(turning.spatial_stiffness, state.stiffness)
    np.testing.assert_array_equal(turning.radial_damping, np.diag([300.0, 50.0]))


def test_damping_by_matrix_damps_tilting() -> None:
    matrix = np.diag([1e6, 1e6, 0.0, 1e4, 1e4])
    tilting = np.diag([0.0, 0.0, 0.0, 50.0, 50.0])
    case = parse_case(friswell(stiffness={"matrix": matrix.tolist()}, damping={"matrix": tilting.tolist()}))
    assert case.parts.bearings_on("shaft")[0].spatial_damping[4, 4] == 50.0
    (solved,) = solve_rotors(case)
    assert solved.whirl[0].damping_ratios.min() > 0.0


def test_a_bearing_that_its_load_does_not_hold_is_the_users_to_mend(
    gearwhine: Callable[..., Any], tmp_path: Any
) -> None:
    loose = friswell("30 mm", stiffness={"rolling": {**ISO, "clearance": "20 um"}}, load={"z": "0 N"})
    with pytest.raises(CaseError, match=r"bearing\[0\].stiffness.rolling .*loose in x and y"):
        parse_case(loose).parts.bearings_on("shaft")
    changes = (
        f"rotor.shaft.segments={inline(journals('30 mm'))}",
        "bearing.left.stiffness={ rolling = { count = 7, element_diameter = 0.0115, pitch_diameter = 0.0435 } }",
    )
    options = [part for change in changes for part in ("--set", change)]
    outcome = gearwhine("rotors", "friswell-rotor", *options, "--set", 'bearing.left.load={ x = "900 kN" }')
    assert outcome.code == 2
    assert "of their diameter" in outcome.err


def test_a_rated_life_stands_in_document_file_terminal_and_report(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """C/P = 10 for balls: 1000 million revolutions; at 3000 rpm 5555.6 h."""
    ring = "type = 'deep-groove', bore = '30 mm', outer_diameter = '62 mm', width = '16 mm'"
    rated = f"{{ rolling = {{ catalogue = {{ {ring} }}, dynamic_rating = '10 kN' }} }}"
    unrated = f"{{ rolling = {{ catalogue = {{ {ring} }} }} }}"
    changes = [
        f"rotor.shaft.segments={inline(journals('30 mm'))}",
        f"bearing.left.stiffness={rated}",
        f"bearing.right.stiffness={unrated}",
        "bearing.left.load={ y = '-1 kN' }",
        "bearing.right.load={ y = '-1 kN' }",
        "operation.speed=3000 rpm",
    ]
    options = [part for change in changes for part in ("--set", change)]
    assert run_command(["rotors", "friswell-rotor", "-q", "-o", str(tmp_path), *options]) == 0
    printed = capsys.readouterr().out
    assert "rated life L10 [h]" in printed
    assert "5560" in printed
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    left, right = summary["rotors"][0]["rolling_bearings"]
    assert left["life_h"] == pytest.approx(1e9 / (3000.0 * 60.0))
    assert (left["dynamic_rating_n"], left["dynamic_rating_from"]) == (10e3, "case")
    # Without a printed C the one of the geometry by ISO 281; SKF's 6206 has 20.3 kN.
    assert right["dynamic_rating_from"] == "geometry"
    assert right["dynamic_rating_n"] == pytest.approx(20.3e3, rel=0.1)
    assert right["life_h"] == pytest.approx(left["life_h"] * (right["dynamic_rating_n"] / 10e3) ** 3)
    # Without clearance and with nine balls the elements' loads have nearly the life of ISO 281.
    assert left["reference_life_h"] == pytest.approx(left["life_h"], rel=0.05)
    assert right["reference_life_h"] == pytest.approx(right["life_h"], rel=0.05)
    assert left["estimated"]
    passing = left["characteristic_frequencies_hz"]
    assert passing["inner raceway"] + passing["outer raceway"] == pytest.approx(left["elements"] * 50.0)
    with opened_dataset(tmp_path / "results.nc") as data:
        life = data["rolling_bearing_life"]
        assert life.attrs["units"] == "h"
        assert "ISO 281" in life.attrs["long_name"]
        assert float(life.sel(rolling_bearing="shaft: left")) == pytest.approx(1e9 / (3000.0 * 60.0))
        assert float(life.sel(rolling_bearing="shaft: right")) == pytest.approx(right["life_h"])
        reference = float(data["rolling_bearing_reference_life"].sel(rolling_bearing="shaft: left"))
        assert reference == pytest.approx(left["reference_life_h"])
    assert run_command(["report", "friswell-rotor", "-q", "-o", str(tmp_path), *options]) == 0
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "rated life L10 [h]" in page
    assert "5560" in page
