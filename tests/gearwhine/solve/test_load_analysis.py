"""Operating point of cases: its document, arrays, warnings and text, against statics and the library's own call."""

import io
import json
import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from rich.console import Console

import gearwhine as gw
from gearwhine.analyses.result import Result
from gearwhine.case import CaseError
from gearwhine.cli import run_command
from gearwhine.coupling.load_analysis.load_warnings import _bearing_warnings, load_warnings
from gearwhine.coupling.load_analysis.solved_load import SolvedLoad
from gearwhine.output.terminal import show_section
from gearwhine.results import chapters_of
from gearwhine.results.operating_point import sections
from gearwhine.rotors.rolling_bearings import BallRow, RollerRow, spherical_groove
from gearwhine.rotors.rolling_bearings.rows import STEEL

WIDEST = 100  # columns of the terminal
# Pinion of `helical-pair`: 23 teeth of module 3 mm, 15 degrees of helix, 20 degrees of normal pressure angle.
TRANSVERSE = np.arctan(np.tan(np.radians(20.0)) / np.cos(np.radians(15.0)))
BASE_RADIUS = 0.5 * 23 * 3e-3 / np.cos(np.radians(15.0)) * np.cos(TRANSVERSE)
BASE_HELIX = np.arcsin(np.sin(np.radians(15.0)) * np.cos(np.radians(20.0)))
ROLLING = {
    "rolling": {
        "element": "ball",
        "count": 8,
        "element_diameter": "15.081 mm",
        "pitch_diameter": "65 mm",
        "dynamic_rating": "42.3 kN",
    }
}


@pytest.fixture(scope="module")
def helical() -> Result[SolvedLoad]:
    """The helical pair, over torque as well."""
    return gw.load("helical-pair").operating_point(over_torque=True)


def rolling(load: str) -> Result[SolvedLoad]:
    """The spur pair on a ball bearing of 6308's size (SKF) at one place, its stiffness made for a load."""
    force = dict(zip("xyz", load.split(","), strict=True))
    return gw.load("spur-pair", {"bearing.0.stiffness": ROLLING, "bearing.0.load": force}).operating_point()


def test_forces_are_those_of_statics(helical: Result[SolvedLoad]) -> None:
    (pair,) = helical.document["gear_pairs"]
    force = 150.0 / BASE_RADIUS
    assert pair["force_n"] == pytest.approx(force, rel=1e-8)
    # The pinion's helix is right-handed and it drives counter-clockwise: the wheel is pushed along -z.
    assert pair["thrust_n"] == pytest.approx(-force * np.tan(BASE_HELIX), rel=1e-8)
    carried = {name: np.zeros(3) for name in ("input", "output")}
    for bearing in helical.document["bearings"]:
        carried[bearing["shaft"]] += bearing["force_n"]
        assert (len(bearing["force_n"]), len(bearing["moment_n_m"]), len(bearing["displacement_m"])) == (3, 2, 3)
    assert carried["output"] == pytest.approx(-carried["input"], rel=1e-8, abs=1e-6)
    assert np.hypot(*carried["output"][:2]) == pytest.approx(force, rel=1e-8)
    assert carried["output"][2] == pytest.approx(pair["thrust_n"], rel=1e-8)


def test_the_document_has_what_the_library_finds(helical: Result[SolvedLoad]) -> None:
    document, point = helical.document, gw.load("helical-pair").machine.operating_point()
    (pair,), (told,) = point.pairs, document["gear_pairs"]
    assert (told["driver"], told["driven"]) == ("pinion", "wheel")
    assert set(told["misalignment_by_cause_rad"]) == {"shafts", "bearings", "housing", "carrier", "seats", "bodies"}
    assert sum(told["misalignment_by_cause_rad"].values()) == pytest.approx(told["misalignment_rad"], rel=1e-9)
    assert told["misalignment_rad"] == pytest.approx(pair.misalignment, rel=1e-9)
    assert told["misalignment_over_face_m"] == pytest.approx(pair.misalignment * 25e-3, rel=1e-9)
    assert told["k_h_beta"] == pytest.approx(pair.k_h_beta, rel=1e-9)
    assert told["mean_stiffness_n_per_m"] == pytest.approx(pair.mean_stiffness, rel=1e-9)
    assert told["transmission_error_m"]["peak_to_peak"] == pytest.approx(np.ptp(pair.transmission_error), rel=1e-9)
    assert told["line_load_n_per_m"]["mean"] == pytest.approx(told["force_n"] / 25e-3, rel=1e-9)
    assert told["line_load_n_per_m"]["maximum"] == pytest.approx(told["k_h_beta"] * told["force_n"] / 25e-3, rel=1e-9)
    assert told["line_load_n_per_m"]["peak"] == pytest.approx(pair.fine.line_load.max(), rel=1e-9)
    assert told["line_load_n_per_m"]["peak_of_tooth_pair"] == pytest.approx(pair.fine.pair_line_loads.max(), rel=1e-9)
    for one in document["bearings"]:
        found = point.bearing(one["name"])
        assert one["displacement_m"] == pytest.approx(found.deflection[:3], rel=1e-9)
        assert one["tilt_rad"] == pytest.approx(np.hypot(*found.deflection[3:]))
        assert np.array(one["stiffness"]) == pytest.approx(found.stiffness)
        assert one["life_h"] is None
    assert (document["seats"], helical.command) == ("rigid", "load")
    assert document["residual"] < 1e-9
    assert helical.proofs["residual"] == document["residual"]


def test_contact_pressure_is_that_of_hertz(helical: Result[SolvedLoad]) -> None:
    """At the place of the largest pressure, by the formula of line contact with radii of its own."""
    (pair,) = helical.solved.point.pairs
    (told,) = helical.document["gear_pairs"]
    geometry, contact = pair.pair.geometry, pair.pair.contact.tooth_contact
    loads = pair.mesh.line_loads
    assert loads is not None
    assert contact.faces is not None
    places = pair.mesh.positions[..., None] + contact.faces.shift
    along = geometry.driver.base_radius * geometry.driver_roll_angle(places)
    other = geometry.tangent_distance - along
    on_path = (places >= 0.0) & (places <= geometry.contact_ratio) & (loads > 0.0)
    radius = along * other / (geometry.tangent_distance * np.cos(BASE_HELIX))
    modulus = 206e9 / (2.0 * (1.0 - 0.3**2))
    pressure = np.sqrt(loads[on_path] * modulus / (np.pi * radius[on_path]))
    assert told["contact_pressure_max_pa"] == pytest.approx(pressure.max(), rel=1e-6)


def test_teeth_without_a_face_width_touch_in_one_point() -> None:
    """The bearings of tilting shafts share the force by the lever: no width of a face is known that would shift it.

    One bearing of each shaft is nearer to its gear than half a face of ten modules.
    """
    at = {"input": 0.16, "output": 0.16}
    pair = gw.build(
        material={"steel": {"youngs_modulus": 206e9, "poisson_ratio": 0.3, "density": 7850.0}},
        rotor=[
            {"name": name, "material": "steel", "axis": [x, 0.0], "segments": [{"length": 0.2, "diameter": 0.03}]}
            for name, x in (("input", 0.0), ("output", 0.1 / np.cos(np.radians(20.0))))
        ],
        bearing=[
            {"name": f"{name} {z}", "rotor": name, "at": z, "stiffness": {"xx": 1e8, "yy": 1e8}}
            for name in at
            for z in (0.02, 0.18)
        ],
        gear=[
            {"name": f"gear {name}", "rotor": name, "at": z, "teeth": 40, "base_radius": 0.05}
            | {"mass": 1.0, "polar_inertia": 1e-3, "diametral_inertia": 6e-4}
            for name, z in at.items()
        ],
        gear_pair=[
            {"driver": "gear input", "driven": "gear output", "stiffness": {"model": "constant", "value": 2e8}},
        ],
        operation={"speed": 100.0, "torque": 50.0},
    ).operating_point()
    force = 50.0 / 0.05
    shares = [np.linalg.norm(bearing["force_n"]) / force for bearing in pair.document["bearings"]]
    np.testing.assert_allclose(shares, [0.02 / 0.16, 0.14 / 0.16] * 2, rtol=1e-4)
    (told,) = pair.document["gear_pairs"]
    assert told["k_h_beta"] == pytest.approx(1.0, abs=0.01)
    assert told["line_load_n_per_m"] is told["contact_pressure_max_pa"] is told["face_width_m"] is None


def test_arrays_have_axes_and_units(helical: Result[SolvedLoad]) -> None:
    data = helical.dataset
    expected = {
        "shaft_displacement": (("deflected_shaft", "direction", "shaft_place"), "m"),
        "shaft_rotation": (("deflected_shaft", "shaft_rotation_axis", "shaft_place"), "rad"),
        "shaft_position": (("deflected_shaft", "shaft_place"), "m"),
        "bearing_mean_force": (("loaded_bearing", "direction"), "N"),
        "bearing_mean_moment": (("loaded_bearing", "rotation"), "N m"),
        "bearing_displacement": (("loaded_bearing", "direction"), "m"),
        "seat_displacement": (("loaded_bearing", "direction"), "m"),
        "misalignment_by_cause": (("loaded_pair", "cause"), "rad"),
        "face_mean_line_load": (("loaded_pair", "face_slice"), "N/m"),
        "face_line_load": (("loaded_pair", "load_phase", "face_slice"), "N/m"),
        "face_gap": (("loaded_pair", "face_slice"), "m"),
        "loaded_transmission_error": (("loaded_pair", "load_phase"), "m"),
        "face_load_factor_over_torque": (("load_torque", "loaded_pair"), "1"),
    }
    for name, (axes, unit) in expected.items():
        assert (data[name].dims, data[name].attrs["units"]) == (axes, unit), name
        assert data[name].attrs["long_name"]
    assert data["bearing_tangent_stiffness"].dims == ("loaded_bearing", "bearing_motion", "other_bearing_motion")
    (pair,) = helical.document["gear_pairs"]
    force = data["face_line_load"].values[0].mean(axis=0).sum() * 25e-3 / data.sizes["face_slice"]
    assert force == pytest.approx(pair["force_n"], rel=1e-9)
    carried = data["bearing_mean_force"].sel(loaded_bearing="input-left", direction="z")
    assert float(carried) == pytest.approx(helical.document["bearings"][0]["force_n"][2])
    middle = data["shaft_displacement"].sel(deflected_shaft="input").values[:2]
    assert np.hypot(*middle).max() == pytest.approx(helical.document["shafts"][0]["largest_deflection_m"])


def test_over_torque_the_machine_is_the_same_at_its_own_torque(helical: Result[SolvedLoad]) -> None:
    points = helical.document["over_torque"]
    assert [point["torque_n_m"] for point in points] == pytest.approx(np.linspace(15.0, 225.0, 15))
    (own,), (pair,) = points[9]["gear_pairs"], helical.document["gear_pairs"]
    for key in ("misalignment_rad", "k_h_beta", "mean_stiffness_n_per_m"):
        assert own[key] == pytest.approx(pair[key], rel=1e-6)
    # Crowned teeth carry on more of their face the more they carry.
    factors = [point["gear_pairs"][0]["k_h_beta"] for point in points]
    assert (np.diff(factors) < 0.0).all()
    assert helical.dataset["face_load_factor_over_torque"].values[:, 0] == pytest.approx(factors)
    assert helical.dataset["load_torque"].values == pytest.approx([point["torque_n_m"] for point in points])


def test_a_given_misalignment_is_held_against_the_one_found(helical: Result[SolvedLoad]) -> None:
    (entry,) = [one for one in helical.document["warnings"] if one["name"] == "misalignment"]
    assert entry["given_rad"] == pytest.approx(np.radians(0.005))
    assert entry["found_rad"] == helical.document["gear_pairs"][0]["misalignment_rad"]
    assert f"{1e6 * entry['given_rad']:.4g} µrad" in entry["message"]
    assert f"{1e6 * entry['found_rad']:.4g} µrad" in entry["message"]
    # Flanks apart over the face of 25 mm, and F_bn / c by the command `gears`.
    apart, deflected = (float(number) for number in re.findall(r"(\S+) µm", entry["message"]))
    (pair,) = (
        gw.load("helical-pair").gears(without=("harris-map", "relief")).document["pairs"]
    )  # of the given misalignment
    assert apart == pytest.approx(1e6 * 25e-3 * abs(entry["given_rad"] - entry["found_rad"]), rel=2e-3)
    assert deflected == pytest.approx(1e6 * pair["mean_force_n"] / pair["stiffness_n_per_m"]["loaded_mean"], rel=0.01)
    found = float(entry["found_rad"])
    near = gw.load("helical-pair", {"gear_pair.0.misalignment": 1.05 * found}).operating_point()
    assert not near.warnings


def test_the_terminal_is_compact(helical: Result[SolvedLoad], capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["load", "helical-pair", "-q"]) == 0
    told = capsys.readouterr()
    lines = told.out.splitlines()
    assert max(len(line.rstrip()) for line in lines) <= WIDEST
    assert "in rigid seats (no housing)" in told.out
    (row,) = [line.split() for line in lines if line.split()[:1] == ["input-left"]]
    assert [float(cell) for cell in row[1:4]] == pytest.approx(helical.document["bearings"][0]["force_n"], abs=0.51)
    rows = [line.split() for line in lines if line.split()[:2] == ["pinion", "wheel"]]
    assert float(rows[0][4]) == pytest.approx(helical.document["gear_pairs"][0]["k_h_beta"], abs=6e-4)
    causes = helical.document["gear_pairs"][0]["misalignment_by_cause_rad"]
    shown = [1e6 * part for cause, part in causes.items() if cause not in ("carrier", "seats")]
    assert [float(cell) for cell in rows[1][3:]] == pytest.approx(shown, abs=6e-3)
    assert "Forces balance to" in told.out
    assert "which nothing holds and no load drives: the rotation of 'input'" in told.out
    assert told.err.startswith("warning: gear pair 'pinion' -> 'wheel': the case gives a misalignment")


@pytest.mark.slow
def test_tables_of_long_names_fit_a_hundred_columns() -> None:
    """With every column there is: rolling bearings, all torques, all influences; no cell is cut or broken."""
    force = {"x": "-294 N", "y": "-807 N", "z": "0 N"}
    study = gw.load("spur-pair", {"bearing.0.stiffness": ROLLING, "bearing.0.load": force})
    document = json.loads(study.operating_point(over_torque=True, sensitivity=True).json())
    long, gears = "intermediate-front", {"driver": "pinion 1", "driven": "wheel 1"}
    for bearing in document["bearings"]:
        bearing |= {"name": long, "force_n": [-12345.6] * 3}
    for holder in (document, *document["over_torque"], *document["sensitivity"]):
        for pair in holder["gear_pairs"]:
            pair |= gears
    for influence in document["sensitivity"]:
        influence["parameter"] = long
    text = io.StringIO()
    console = Console(file=text, width=WIDEST, highlight=False, markup=False, force_terminal=True, color_system=None)
    for section in sections(document):
        show_section(console, section)
    lines = text.getvalue().splitlines()
    assert max(len(line.rstrip()) for line in lines) <= WIDEST
    assert "…" not in text.getvalue()
    rolling = [one for one in document["bearings"] if one["peak_pressure_pa"] is not None]
    named = [*document["bearings"], *rolling, *document["sensitivity"]]
    assert sum(long in line for line in lines) == len(named)
    assert sum("pinion 1 → wheel 1 " in line for line in lines) == len(document["over_torque"]) + len(
        document["sensitivity"]
    )


def test_nothing_that_loads_the_machine_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["load", "spur-pair", "-q", "--set", "operation.torque=0 N*m"]) == 2
    expected = (
        "operation.torque: expected a torque, a force or gravity, which load the shafts, "
        "or a preload of rolling bearings"
    )
    assert f"{expected}, got 0.0" in capsys.readouterr().err
    assert run_command(["load", "overhung-fan", "-q"]) == 2
    assert expected in capsys.readouterr().err
    with pytest.raises(CaseError, match="rotor"):
        gw.load("gear-62-62").operating_point()


def test_thrust_that_nothing_carries_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    stiffness = "bearing.0.stiffness={ xx = '2e8 N/m', yy = '2e8 N/m' }"
    damping = "bearing.0.damping={ xx = '8e2 N*s/m', yy = '8e2 N*s/m' }"
    assert run_command(["load", "helical-pair", "-q", "--set", stiffness, "--set", damping]) == 2
    assert "input" in capsys.readouterr().err


def test_weight_alone_loads_a_machine_without_gears() -> None:
    study = gw.load("overhung-fan", {"operation.gravity": [0.0, -9.81, 0.0]})
    document = study.operating_point().document
    carried = sum(bearing["force_n"][1] for bearing in document["bearings"])
    (shaft,) = study.machine.shafts
    assert carried == pytest.approx(-9.81 * study.machine.rotor(shaft.name).mass, rel=1e-6)
    assert document["gravity_m_per_s2"] == [0.0, -9.81, 0.0]
    assert document["gear_pairs"] == []


def test_life_of_a_ball_bearing_by_hand() -> None:
    """L10 = (C / P)^3 million revolutions, P the radial force (ISO 281); warned of where made for another load."""
    result = rolling("100 N,0 N,0 N")
    (bearing,) = [one for one in result.document["bearings"] if one["life_h"] is not None]
    radial = float(np.hypot(*bearing["force_n"][:2]))
    assert bearing["equivalent_load_n"] == pytest.approx(radial, rel=1e-9)
    assert bearing["life_h"] == pytest.approx(1e6 * (42.3e3 / radial) ** 3 / (60.0 * 5500.0), rel=1e-9)
    assert (bearing["dynamic_rating_n"], bearing["dynamic_rating_from"]) == (42.3e3, "case")
    # The most loaded ball is the one in the direction of the load or beside it.
    element = bearing["most_loaded_element"]
    along = np.arctan2(bearing["force_n"][1], bearing["force_n"][0])
    assert abs((element["azimuth_rad"] - along + np.pi) % (2.0 * np.pi) - np.pi) <= np.pi / 8 + 1e-9
    data = result.dataset
    loads = data["bearing_element_load"].sel(loaded_bearing=bearing["name"]).values
    assert loads.max() == pytest.approx(element["load_n"])
    assert loads.size == 8
    warned = [entry for entry in result.document["warnings"] if entry["name"] == "bearing load"]
    assert "made for a load of 100 N radial and 0 N axial, the equilibrium finds" in warned[0]["message"]


def test_reference_life_is_that_of_the_loads_of_the_balls() -> None:
    """By ISO/TS 16281 from the loads in the data, with ratings of the contacts made of C (its equations 18 to 21)."""
    result = rolling("-294 N,-807 N,0 N")
    (bearing,) = [one for one in result.document["bearings"] if one["life_h"] is not None]
    loads = result.dataset["bearing_element_load"].sel(loaded_bearing=bearing["name"]).values
    gamma, inner, outer = 15.081 / 65.0, 0.52, 0.53
    ratio = 1.044 * ((1 - gamma) / (1 + gamma)) ** 1.72 * (inner * (2 * outer - 1) / (outer * (2 * inner - 1))) ** 0.41
    whole = 42.3e3 / (0.407 * 8 * 1.0)
    rated_inner = whole * (1.0 + ratio ** (10.0 / 3.0)) ** 0.3
    rated_outer = 42.3e3 / (0.389 * 8) * (1.0 + ratio ** (-10.0 / 3.0)) ** 0.3
    mean_inner = np.mean(loads**3) ** (1.0 / 3.0)
    mean_outer = np.mean(loads ** (10.0 / 3.0)) ** 0.3
    damage = (rated_inner / mean_inner) ** (-10.0 / 3.0) + (rated_outer / mean_outer) ** (-10.0 / 3.0)
    assert bearing["reference_life_h"] == pytest.approx(1e6 * damage**-0.9 / (60.0 * 5500.0), rel=0.02)


def test_a_bearing_without_a_rating_has_that_of_its_geometry() -> None:
    bare = {"rolling": {key: value for key, value in ROLLING["rolling"].items() if key != "dynamic_rating"}}
    load = {"x": "-294 N", "y": "-807 N", "z": "0 N"}
    result = gw.load("spur-pair", {"bearing.0.stiffness": bare, "bearing.0.load": load}).operating_point()
    (bearing,) = [one for one in result.document["bearings"] if one["life_h"] is not None]
    assert bearing["dynamic_rating_from"] == "geometry"
    # SKF's 6308 has 42.3 kN.
    assert bearing["dynamic_rating_n"] == pytest.approx(42.3e3, rel=0.1)


def test_a_bearing_made_for_its_load_is_not_warned_of_it() -> None:
    # Half of the mesh force, 20 degrees from the line of centres, which is x.
    force = 0.5 * 71.77 / (0.5 * 28 * 3.175e-3 * np.cos(np.radians(20.0)))
    x, y = -force * np.sin(np.radians(20.0)), -force * np.cos(np.radians(20.0))
    result = rolling(f"{x:.1f} N,{y:.1f} N,0 N")
    assert not [entry for entry in result.document["warnings"] if entry["name"] == "bearing load"]


def test_overloaded_bearings_are_warned_of() -> None:
    weak = {"rolling": ROLLING["rolling"] | {"dynamic_rating": "2 kN", "element_diameter": "4 mm"}}
    given = {"x": "-294 N", "y": "-807 N", "z": "0 N"}
    result = gw.load("spur-pair", {"bearing.0.stiffness": weak, "bearing.0.load": given}).operating_point()
    (bearing,) = [one for one in result.document["bearings"] if one["life_h"] is not None]
    assert bearing["life_h"] < 1000.0
    messages = {entry["name"]: entry["message"] for entry in result.document["warnings"]}
    assert f"{bearing['life_h']:.3g} h" in messages["bearing life"]
    assert bearing["peak_pressure_pa"] < 4.2e9 or "ISO 76" in messages["static rating"]


def test_doubtful_points_are_warned_of(helical: Result[SolvedLoad]) -> None:
    """Static rating, tilt, uneven faces and loose parts, on a point whose numbers are changed."""
    result = rolling("-294 N,-807 N,0 N")
    solved = result.solved
    one = next(bearing for bearing in solved.bearings if bearing.load.rolling is not None)
    state = one.load.rolling
    assert state is not None
    pressed = replace(state.rows[0], inner_pressure=np.full(8, 4.3e9))
    tilted = replace(
        one.load, deflection=np.array([0.0, 0.0, 0.0, 0.0, 3.1e-3]), rolling=replace(state, rows=(pressed,))
    )
    point = replace(solved.point, free=("the tilt about x of shaft 'input'", "the rotation of shaft 'input'"))
    changed = replace(solved, bearings=(replace(one, load=tilted),), point=point)
    found = {entry["name"]: entry for entry in load_warnings(changed)}
    assert "4.3 GPa, beyond the 4.2 GPa" in found["static rating"]["message"]
    assert "10.7' out of line; deep groove ball bearings usually take 10'" in found["bearing tilt"]["message"]
    assert found["free motion"]["motion"] == "the tilt about x of shaft 'input'"


@pytest.mark.parametrize(
    ("row", "gigapascals"),
    [
        (BallRow(9, 8e-3, 40e-3), 4.2),
        (BallRow(14, 8e-3, 45e-3, 0.2, outer_groove=spherical_groove(8e-3, 45e-3, 0.2)), 4.6),
        (RollerRow(12, 8e-3, 8e-3, 40e-3), 4.0),
    ],
)
def test_elements_are_pressed_to_the_static_rating_of_their_kind(row: BallRow | RollerRow, gigapascals: float) -> None:
    """ISO 76: 4200 MPa of balls, 4600 MPa of self-aligning ones, 4000 MPa of rollers."""
    state = SimpleNamespace(bearing=SimpleNamespace(rows=[row]), peak_pressure=1.001e9 * gigapascals)
    bearing: Any = SimpleNamespace(load=SimpleNamespace(name="b", rolling=state))
    assert f"beyond the {gigapascals:g} GPa" in next(_bearing_warnings(bearing))["message"]


def test_uneven_faces_are_warned_of() -> None:
    """The idler shafts of the three-stage train bend: its gears carry on one side of their faces."""
    result = gw.load("three-stage").operating_point()
    uneven = [entry for entry in result.document["warnings"] if entry["name"] == "uneven face"]
    assert [entry["k_h_beta"] for entry in uneven] == [pair["k_h_beta"] for pair in result.document["gear_pairs"]]
    for pair in result.document["gear_pairs"]:
        parted = 1.0 - pair["carrying_part"]
        assert 0.0 < parted < 0.2
        assert any(f"{100.0 * parted:.3g} % of the face never touches" in message for message in result.warnings)


def test_report_has_the_tables_of_the_terminal(helical: Result[SolvedLoad]) -> None:
    (chapter,) = chapters_of(helical.document | {"command": "load"})
    assert chapter.title == "Operating point"
    assert all(picture.begins.startswith("load") for picture in chapter.pictures)
    (section,) = sections(helical.document)
    assert chapter.content == section.content
    tables: Any = {table.caption: table for table in chapter.tables}
    assert "Over torque" in tables


def test_lives_of_rotors_and_load_are_those_of_one_rating() -> None:
    """Under the load that the equilibrium finds, and without a C in the case: of its geometry in both."""
    bare = {"rolling": {key: value for key, value in ROLLING["rolling"].items() if key != "dynamic_rating"}}
    study = gw.load("spur-pair", {"bearing.0.stiffness": bare})
    (loaded,) = [one for one in study.operating_point().document["bearings"] if one["life_h"] is not None]
    (turning,) = [one for rotor in study.rotors().document["rotors"] for one in rotor["rolling_bearings"]]
    for key in ("dynamic_rating_n", "dynamic_rating_from", "life_h", "reference_life_h"):
        assert turning[key] == (loaded[key] if isinstance(loaded[key], str) else pytest.approx(loaded[key], rel=1e-9))


def test_fast_bearings_are_warned_of_the_centrifugal_force_that_is_left_out() -> None:
    """F = m d_m / 2 (½ (1 - D/d_m) Ω)² of a steel ball of 6308's size, by hand; at 5500 rpm n d_m is below 500 000."""
    load = {"x": "-294 N", "y": "-807 N", "z": "0 N"}
    changes = {"bearing.0.stiffness": ROLLING, "bearing.0.load": load}
    assert not [text for text in gw.load("spur-pair", changes).check().warnings if "n·d_m" in text]
    study = gw.load("spur-pair", changes | {"operation.speed": "8000 rpm"})
    mass = STEEL.element_density * np.pi / 6.0 * 15.081e-3**3
    cage = 0.5 * (1.0 - 15.081 / 65.0) * 8000.0 * np.pi / 30.0
    force = mass * 32.5e-3 * cage**2
    assert force == pytest.approx(44.0 * (8000.0 * 65.0 / 5e5) ** 2, rel=0.02)  # the figure in the docs
    for result in (study.operating_point(), study.check(), study.rotors()):
        (entry,) = [one for one in result.document["warnings"] if one["name"] == "bearing speed"]
        assert entry["speed_factor_mm_per_min"] == pytest.approx(8000.0 * 65.0)
        assert entry["centrifugal_force_n"] == pytest.approx(force, rel=1e-9)
        assert "n·d_m = 5.2e+05 mm/min (8000 rpm, pitch circle 65 mm)" in entry["message"]
        assert f"{force:.3g} N each" in entry["message"]


def test_pitch_deviations_are_in_the_transmission_error_over_the_hunting_period() -> None:
    """A pinion whose pitch runs out by ±14 µm has 28 µm of it, less the mean over the pairs in contact."""
    teeth = 28
    deviations = [f"{14.0 * np.cos(2.0 * np.pi * tooth / teeth):.6f} um" for tooth in range(teeth)]
    study = gw.load("spur-pair", {"gear.0.errors.pitch": deviations})
    (pair,) = study.operating_point().document["gear_pairs"]
    over_hunting_period = pair["transmission_error_over_hunting_period_m"]
    assert 0.9 * 28e-6 < over_hunting_period["peak_to_peak"] < 28e-6 + pair["transmission_error_m"]["peak_to_peak"]
    assert over_hunting_period["mean"] == pytest.approx(pair["transmission_error_m"]["mean"], abs=2e-6)
    (sound,) = gw.load("spur-pair").operating_point().document["gear_pairs"]
    assert sound["transmission_error_over_hunting_period_m"] is None
