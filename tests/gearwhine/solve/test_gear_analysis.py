"""The analysis of gear pairs: each figure against the room's own functions, closed forms, or another way to it."""

import math
import subprocess
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from coupled_cases import coupled

from gearwhine.case import Case, load_case, parse_case
from gearwhine.coupling.analyses.gear_pairs import PairAnalysis, solve_over_torques
from gearwhine.coupling.gears import (
    Gear,
    GearPairGeometry,
    HelixDeviation,
    TipRelief,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.face_slices import face_slices, face_stations
from gearwhine.coupling.gears.geometry.path_of_contact import POINTS_OF_CONTACT
from gearwhine.coupling.gears.loaded.optimal_relief import transmission_error_harmonics
from gearwhine.coupling.gears.loaded.transmission_error import mesh_period_phases
from gearwhine.coupling.linear.frequency_response import mesh_error_response
from gearwhine.coupling.linear.sensor_level import SensorLevel
from gearwhine.coupling.statics.mean_mesh import mean_contact
from gearwhine.from_case.machine import solve_gears
from gearwhine.output.dataset import arrays_of, labelled, labels_of
from gearwhine.output.manifest import opened_dataset
from gearwhine.output.terminal import show
from gearwhine.results.gears import GEARS, gears_document, sections
from gearwhine.solve.gear_pairs import analyse_pairs, relief_aims
from gearwhine.solve.housing_modes import solve_housing


@cache
def case_of(name: str, *settings: str) -> Case:
    return load_case(name, settings).case


@cache
def analysed(name: str, *settings: str) -> PairAnalysis:
    case = case_of(name, *settings)
    solved = solve_gears(case.parts)
    (pair,) = solve_over_torques(analyse_pairs(case, solved), aims=relief_aims(case, solved))
    return pair


def document(name: str, *settings: str) -> dict[str, Any]:
    (pair,) = gears_document((analysed(name, *settings),))["pairs"]
    return dict(pair)


EVEN = ("spur-pair",)  # relieved, perfect pitch
PITCHED = ("nasa-gear-noise-rig",)


def test_the_load_is_shared_out_whole() -> None:
    pair = analysed(*EVEN)
    parts = pair.pairs_in_contact
    assert sum(parts.values()) == pytest.approx(1.0)
    assert set(parts) == {1, 2}
    # Relief keeps teeth apart where they enter and leave.
    assert parts[2] < pair.solved.geometry.contact_ratio - 1.0
    assert pair.loaded_contact_ratio == pytest.approx(1.0 + parts[2])
    assert pair.corner_force == 0.0


def test_without_relief_pairs_carry_all_along_the_path() -> None:
    """The contact ratio is then the mean number of pairs, and alone for 2 minus it of the time; corners add to it."""
    pair = analysed("gear-62-62", "gear_pair.0.corner_contact=false")
    assert pair.loaded_contact_ratio == pytest.approx(1.7897798668, abs=1e-3)
    assert pair.pairs_in_contact[1] == pytest.approx(2.0 - 1.7897798668, abs=1e-3)
    assert np.abs(pair.unloaded).max() < 1e-15
    cornered = analysed("gear-62-62")
    assert 1.9 < cornered.loaded_contact_ratio < 2.3
    assert cornered.corner_force > 0.0


def test_pressure_at_the_pitch_point_is_the_nominal_one_of_iso_6336() -> None:
    """28 and 28 teeth, one pair alone at the pitch point: Z_H Z_E sqrt(2 F_t / (d b))."""
    pair = analysed(*EVEN)
    zone = math.sqrt(2.0 / (math.cos(math.radians(20.0)) * math.sin(math.radians(20.0))))
    elasticity = math.sqrt(207e9 / (2.0 * math.pi * (1.0 - 0.3**2)))
    tangential = 71.77 / 0.04445
    nominal = zone * elasticity * math.sqrt(2.0 * tangential / (0.0889 * 0.00635))
    assert pair.pitch_pressure == pytest.approx(nominal, rel=1e-9)
    assert pair.pressure is not None
    assert float(np.nanmax(pair.pressure)) >= nominal


def test_harmonics_are_those_of_the_curve() -> None:
    """Against a plain sum over many even phases; the curve has no steps at this torque."""
    pair = analysed(*EVEN)
    phases = np.arange(20_000) / 20_000
    curve = loaded_transmission_error(pair.solved.contact, pair.solved.static.force, phases).transmission_error
    expected = 2.0 * np.abs(np.fft.rfft(curve))[1:9] / phases.size
    np.testing.assert_allclose(pair.harmonics, expected, atol=2e-4 * expected[0])
    of_none = np.fft.rfft(pair.solved.contact.pairs(phases).deviation.min(axis=1))
    np.testing.assert_allclose(pair.unloaded_harmonics, 2.0 * np.abs(of_none)[1:9] / phases.size, atol=2e-4 * 5e-6)


def test_harmonics_of_the_mesh_over_the_hunting_period() -> None:
    """Lines of the whole period's spectrum at whole multiples of its number of mesh periods."""
    pair = analysed(*PITCHED)
    periods, points = pair.solved.contact.hunting_period, 400
    assert periods == 28
    phases = np.arange(periods * points) / points
    curve = loaded_transmission_error(pair.solved.contact, pair.solved.static.force, phases).transmission_error
    lines = 2.0 * np.abs(np.fft.rfft(curve))[periods::periods][:8] / phases.size
    np.testing.assert_allclose(pair.harmonics, lines, atol=4e-3 * lines[0])


def test_the_harris_map_is_of_gears_with_all_teeth_alike() -> None:
    pair, even = analysed(*PITCHED), analysed(*EVEN)
    for one in (pair, even):
        assert one.harris is not None
        ratio = one.harris.forces / one.solved.static.force
        np.testing.assert_allclose(ratio, np.linspace(0.1, 2.0, 20))
    assert even.as_given == pytest.approx(even.solved.static.peak_to_peak_transmission_error, rel=2e-2)
    geometry = pair.solved.geometry
    alike = replace(
        geometry,
        driver=replace(geometry.driver, pitch_deviations=()),
        driven=replace(geometry.driven, pitch_deviations=()),
    )
    contact = tooth_contact(alike, pair.solved.model)
    expected = loaded_transmission_error(contact, pair.solved.static.force)
    assert pair.as_given == pytest.approx(expected.peak_to_peak_transmission_error, rel=2e-2)


def test_the_best_relief_is_better_than_any_neighbour() -> None:
    pair = analysed(*EVEN)
    assert pair.optimum is not None
    assert pair.as_given is not None
    best, force = pair.optimum.relief, pair.solved.static.force
    found = float(pair.optimum.peak_to_peak[0])
    assert found < pair.as_given < float(pair.optimum.unmodified[0])
    geometry = pair.solved.geometry
    for amount, length in ((1.1, 1.0), (0.9, 1.0), (1.0, 1.1), (1.0, 0.9)):
        assert best.length is not None
        other = TipRelief(amount * best.amount, length=length * best.length)
        relieved = replace(
            geometry,
            driver=replace(geometry.driver, tip_relief=other),
            driven=replace(geometry.driven, tip_relief=other),
        )
        mesh = loaded_transmission_error(tooth_contact(relieved, pair.solved.model), force)
        assert mesh.peak_to_peak_transmission_error > found


def test_corners_are_found_in_the_contact() -> None:
    """A contact with corners has all its studies with corners, whatever the case says."""
    case = case_of(*EVEN)
    (solved,) = solve_gears(case.parts)
    force = 3.0 * solved.static.force
    contact = tooth_contact(solved.geometry, solved.model, corner_contact=True)
    rounded = replace(solved, undamped=contact, static=loaded_transmission_error(contact, force))
    (pair,) = analyse_pairs(case, (rounded,))
    assert pair.corner_force > 0.0
    assert pair.loaded_contact_ratio > solved.geometry.contact_ratio
    positions = np.asarray(arrays_of(GEARS, (pair,))["path_position"][1])[0]
    assert positions[0] < 0.0
    assert (np.diff(positions) >= 0.0).all()


def test_a_crowned_face() -> None:
    case = case_of(*EVEN)
    (solved,) = solve_gears(case.parts)
    crowned = replace(solved.geometry.driver, helix_deviation=HelixDeviation(crowning=10e-6))
    geometry = replace(solved.geometry, driver=crowned)
    faces = face_slices(geometry, count=11)
    contact = tooth_contact(geometry, solved.model, faces=faces)
    static = loaded_transmission_error(contact, solved.static.force)
    (pair,) = analyse_pairs(case, (replace(solved, geometry=geometry, undamped=contact, static=static),))
    (even,) = analyse_pairs(case, (solved,))
    assert pair.pressure is not None
    assert even.pitch_pressure is not None
    assert pair.pressure.shape == (*static.positions.shape, 11)
    # All of it in the middle: more than the even load's.
    assert pair.pitch_pressure is not None
    assert pair.pitch_pressure > 1.1 * even.pitch_pressure


def test_a_coarser_face_is_the_one_that_would_be_cut_so() -> None:
    pair = GearPairGeometry(
        replace(analysed(*EVEN).solved.geometry.driver, helix_angle=0.2),
        replace(analysed(*EVEN).solved.geometry.driven, helix_angle=-0.2),
    )
    tilts = [turn * face_stations(pair.face_width) for turn in (1e-5, -1e-5)]
    fine, expected = (
        face_slices(pair, misalignment=1e-4, gap_changes=tilts, path_slope=1e-5, count=count) for count in (None, 21)
    )
    coarse = fine.in_slices(21)
    for name in ("z", "width", "shift", "gap", "flattening", "coupling", "changes", "path_slope"):
        np.testing.assert_allclose(getattr(coarse, name), getattr(expected, name), rtol=1e-12, atol=1e-17)


def test_all_recess_gears_have_no_pressure_at_their_pitch_point(capsys: pytest.CaptureFixture[str]) -> None:
    """A driven gear whose tips end below the pitch circle: contact begins when the pitch point has been passed."""
    case = case_of(*EVEN)
    (solved,) = solve_gears(case.parts)
    angle = math.radians(20.0)
    driver = Gear("pinion", 60, 3e-3, angle, 0.02, profile_shift=0.5, addendum=1.3)
    driven = Gear("wheel", 90, 3e-3, angle, 0.02, profile_shift=-0.5, addendum=0.4, dedendum=1.7)
    geometry = GearPairGeometry(driver, driven)
    assert geometry.pitch_point_position < 0.0
    contact = tooth_contact(geometry, solved.model)
    static = loaded_transmission_error(contact, 1000.0)
    (pair,) = analyse_pairs(case, (replace(solved, geometry=geometry, undamped=contact, static=static),))
    assert pair.pitch_pressure is None
    show(gears_document((pair,)), sections(gears_document((pair,))))
    assert "MPa at most, at" in (out := capsys.readouterr().out)
    assert "at the pitch point" not in out


def test_the_document_of_a_loaded_pair() -> None:
    pair = document(*EVEN)
    driver, driven = pair["gears"]
    assert [driver["name"], driven["name"]] == [pair["driver"], pair["driven"]] == ["pinion", "wheel"]
    assert driver["diameters_m"]["reference"] == pytest.approx(0.0889)
    assert driver["diameters_m"]["tip"] == pytest.approx(0.09525)
    assert driver["tip_relief"]["start_roll_angle_rad"] == pytest.approx(math.radians(24.0))
    assert pair["torque_n_m"] == pytest.approx(71.77)
    assert pair["centre_distance_m"] == pytest.approx(0.0889)
    points = {point["point"]: point for point in pair["path_of_contact"]}
    assert list(points) == list(POINTS_OF_CONTACT)
    # The same teeth: where one begins the other ends, and the flanks roll without sliding at the pitch point.
    assert points["SAP"]["driver_radius_m"] == pytest.approx(points["EAP"]["driven_radius_m"])
    assert points["EAP"]["driver_radius_m"] == pytest.approx(0.5 * driver["diameters_m"]["tip"])
    assert points["pitch point"]["driver_specific_sliding"] == pytest.approx(0.0, abs=1e-12)
    assert len(pair["roll_angle_rad"]) == len(pair["stiffness"])
    assert len(pair["harris_map"]["torque_n_m"]) == len(pair["harris_map"]["peak_to_peak_m"]) == 20
    best = pair["optimal_tip_relief"]
    tip = math.sqrt((driver["diameters_m"]["tip"] / driver["diameters_m"]["base"]) ** 2 - 1.0)
    start = tip - best["length_m"] / (0.5 * driver["diameters_m"]["base"])
    assert best["driver_start_roll_angle_rad"] == pytest.approx(start)
    assert best["peak_to_peak_m"] < best["peak_to_peak_as_given_m"] < best["peak_to_peak_without_relief_m"]
    assert pair["contact_pressure_pa"]["max"] >= pair["contact_pressure_pa"]["pitch_point"]


def test_what_needs_a_load_is_left_out_without_one() -> None:
    pair = document("gear-62-62", "operation=")
    for key in ("load_sharing", "contact_pressure_pa", "harris_map", "optimal_tip_relief", "mesh_frequency_hz"):
        assert pair[key] is None
    assert pair["mean_force_n"] == 0.0
    assert len(pair["path_of_contact"]) == 5


def test_what_needs_pairs_of_teeth_is_left_out_with_one_spring() -> None:
    spring = 'gear_pair.0.stiffness={model="constant", value=1e8}'
    pair = document("gear-62-62", spring)
    for key in ("load_sharing", "contact_pressure_pa", "optimal_tip_relief"):
        assert pair[key] is None
    # A spring of 1e8 N/m yields in proportion to the torque, and never swings.
    assert max(pair["harris_map"]["peak_to_peak_m"]) < 1e-12
    assert pair["transmission_error_m"]["mean"] == pytest.approx(pair["mean_force_n"] / 1e8)


def test_gears_by_base_radius_have_no_width_to_press_on() -> None:
    def gear(name: str, teeth: int) -> dict[str, Any]:
        inertia = {"mass": 0, "polar_inertia": 1e-4, "diametral_inertia": 0}
        return {"name": name, "teeth": teeth, "base_radius": 1.5e-3 * teeth, **inertia}

    spring = {"model": "square", "value": 2e8}
    case = parse_case(
        {
            "gear": [gear("a", 31), gear("b", 25)],
            "gear_pair": [{"driver": "a", "driven": "b", "stiffness": spring}],
            "operation": {"speed": "1000 rpm", "torque": "77.5 N*m"},
        }
    )
    (pair,) = solve_over_torques(analyse_pairs(case, solve_gears(case.parts)))
    (given,) = gears_document((pair,))["pairs"]
    assert given["contact_pressure_pa"] is None
    assert [one["face_width_m"] for one in given["gears"]] == [None, None]
    # Equal springs: two carry F / 2k, one F / k, and a relief whose two gaps add up to F / k evens that out wholly.
    force, error = given["mean_force_n"], given["transmission_error_m"]
    assert error["peak_to_peak"] == pytest.approx(force / 4e8)
    assert given["optimal_tip_relief"]["peak_to_peak_m"] < 1e-3 * error["peak_to_peak"]


def test_the_results_file_has_labelled_curves(tmp_path: Path) -> None:
    pair = analysed(*PITCHED)
    path = tmp_path / "results.nc"
    labelled(labels_of(case_of(*PITCHED)), (GEARS, (pair,))).write(path)
    with opened_dataset(path) as data:
        curves = data.isel(gear_pair=0)
        assert all("units" in data[name].attrs for name in data.data_vars)
        shares = curves.load_share.sum("tooth_pair")
        np.testing.assert_allclose(shares, 1.0, rtol=1e-9)
        carried = (curves.load_share > 0.0).sum("tooth_pair").mean()
        assert float(carried) == pytest.approx(pair.loaded_contact_ratio, abs=5e-3)
        assert pair.harris is not None
        swing = curves.harris_transmission_error.max("harris_step") - curves.harris_transmission_error.min(
            "harris_step"
        )
        np.testing.assert_allclose(swing, pair.harris.peak_to_peak)
        np.testing.assert_allclose(curves.harris_torque, 71.77 * np.linspace(0.1, 2.0, 20))
        # Table I: relief of 0.023 and 0.025 mm at the tips.
        np.testing.assert_allclose(curves.flank_deviation.isel(flank_place=-1), [-23e-6, -25e-6], rtol=1e-9)
        assert curves.hunting_phase[-1] < 28.0


@pytest.mark.slow
def test_the_command_compiles_nothing_and_draws_nothing_unasked() -> None:
    """What the work does not need is not loaded."""
    heavy = {"numba", "matplotlib", "xarray", "skfem", "gmsh"}
    code = (
        f"import sys; from gearwhine.cli import run_command; run_command(['gears', 'gear-62-62', '--json', '-q']); "
        f"print(sorted({heavy!r} & set(sys.modules)), file=sys.stderr)"
    )
    outcome = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert outcome.stderr.strip() == "[]"


def test_damage_shows_over_the_hunting_period() -> None:
    fault = "gear.pinion.fault={kind='crack',tooth=3,depth='3 mm'}"
    case = case_of("spur-pair", fault)
    (solved,) = solve_gears(case.parts)
    assert solved.hunting is not None
    sound = analysed(*EVEN).solved.static
    phases, error = solved.hunting.phases, solved.hunting.transmission_error
    # Tooth 3 meets from phase 3 to 3 and the contact ratio; corners reach half a base pitch further at most.
    touched = (phases > 2.5) & (phases < 3.5 + solved.geometry.contact_ratio)
    away = np.interp(phases % 1.0, sound.phases, sound.transmission_error)
    np.testing.assert_allclose(error[~touched], away[~touched], atol=1e-8)
    assert error.max() > sound.transmission_error.max() + 1e-6
    over = gears_document(analyse_pairs(case, (solved,)))["pairs"][0]["transmission_error_m"]["over_hunting_period"]
    assert over["peak_to_peak"] == pytest.approx(float(np.ptp(error)))


def test_mesh_stiffness_of_a_cracked_gear_is_of_all_its_teeth() -> None:
    """Over even phases of the hunting period, 28 mesh periods; a crack takes as much stiffness from any tooth.

    So the mean falls by the same for tooth 3, which the first mesh period does not have, as for tooth 0, and lies
    between least and greatest.
    """
    sound = document("spur-pair")["stiffness_n_per_m"]
    for tooth in (3, 0):
        pair = analysed("spur-pair", f"gear.pinion.fault={{kind='crack',tooth={tooth},depth='3 mm'}}")
        cracked = gears_document((pair,))["pairs"][0]
        told, phases = cracked["stiffness_n_per_m"], 28.0 * (np.arange(28000) + 0.5) / 28000
        values = pair.solved.carrying_flanks.mesh_stiffness(phases, sound=False)
        assert told["mean"] == pytest.approx(values.mean(), rel=1e-4)
        assert told["min"] == pytest.approx(values.min(), rel=1e-3)
        assert told["max"] == pytest.approx(sound["max"], rel=1e-4)
        assert told["min"] < 0.95 * sound["min"]
        assert told["sound_mean"] == sound["mean"] > told["mean"] * 1.001
        assert pair.solved.hunting is not None
        assert told["loaded_mean"] == pair.solved.hunting.mean_mesh_stiffness < sound["loaded_mean"]
    assert "sound_mean" not in sound


def test_what_the_curves_leave_out_or_no_teeth_bear_is_said() -> None:
    def names(*settings: str) -> list[str]:
        case = case_of("spur-pair", *settings)
        found = gears_document(analyse_pairs(case, solve_gears(case.parts))).get("warnings", [])
        return [warning["name"] for warning in found]

    assert names() == []
    assert names("gear.pinion.errors.runout='30 um'") == ["runout"]
    assert names("operation.torque='1000 N*m'") == []
    assert names("operation.torque='5000 N*m'") == ["overload"]


def test_teeth_relieved_below_the_pitch_point_yield_as_much_under_a_torque() -> None:
    """The driven gear lags by a tenth of a millimetre without load already, which no tooth has yielded."""
    relief = "tip_relief={amount='0.3 mm',start_roll_angle='19 deg'}"
    yielding = []
    for settings in ((), (f"gear.pinion.{relief}", f"gear.wheel.{relief}")):
        case = case_of("spur-pair", "operation.torque='3000 N*m'", *settings)
        (pair,) = analyse_pairs(case, solve_gears(case.parts))
        (message,) = [one["message"] for one in gears_document((pair,))["warnings"] if one["name"] == "overload"]
        yielding.append(float(message.partition("the teeth yield ")[2].partition(" µm")[0]))
    assert float(pair.unloaded.mean()) > 0.1e-3
    assert yielding[1] == pytest.approx(yielding[0], rel=0.1)


def test_the_relief_is_sought_for_the_aim_of_the_case() -> None:
    """Weighted harmonics from the case; the sensor's weights are its transmissibility over the root of two."""
    pair = analysed("spur-pair", "gear_pair.0.relief_aim.harmonics.2=1")
    aim = document("spur-pair", "gear_pair.0.relief_aim.harmonics.2=1")["optimal_tip_relief"]["aim"]
    assert (aim["kind"], aim["weights"], aim["unit"]) == ("harmonics", {"2": 1.0}, "m")
    assert aim["best"] < aim["without_relief"]
    assert pair.optimum is not None
    assert aim["best"] == pair.optimum.value[0]


@pytest.mark.slow
def test_the_level_at_a_sensor_is_an_aim() -> None:
    """Of spur gears in the middle, which shuttle no load: the transmissibility, by the spring alone, times the error.

    The transmissibility lets the mesh damper feel the error's velocity; the teeth's own deviations do not move it.
    """
    case = case_of("small-gearbox", "gear_pair.0.relief_aim.sensor=top", "operation.speed=1500 rpm")
    solved = solve_gears(case.parts)
    housing = solve_housing(case)
    (aim,) = relief_aims(case, solved)
    assert isinstance(aim, SensorLevel)
    assert aim.weights == {1: 1.0, 2: 1.0, 3: 1.0, 4: 1.0}
    machine = coupled(case, housing)
    contact, frequency = solved[0].contact, solved[0].mesh_frequency
    assert frequency is not None
    aim = replace(aim, model=replace(aim.model, stiffness_varies=False))
    mesh = loaded_transmission_error(contact, solved[0].static.force, mesh_period_phases(contact, 200))
    w = 2.0 * math.pi * frequency * np.arange(1, 5)
    through = mesh_error_response(machine, w).sensor_acceleration["top"]
    state = mean_contact(machine.system)
    through = through / (1.0 + 1j * w * state.damping[0] / state.stiffness[0])
    amplitudes = np.abs(through) * transmission_error_harmonics(mesh, 4)
    assert aim.of(mesh, contact) == pytest.approx(float(np.linalg.norm(amplitudes)) / math.sqrt(2.0), rel=1e-6)
