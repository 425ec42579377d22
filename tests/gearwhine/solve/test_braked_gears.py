"""Gears of a case under a torque that brakes, against those of the exchanged pair, which the same flanks drive."""

from functools import cache

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.case import Case, case_document, load_case, parse_case
from gearwhine.coupling.analyses.gear_pairs import PairAnalysis, first_touch, solve_over_torques
from gearwhine.coupling.gears import loaded_transmission_error, mesh_stiffness
from gearwhine.coupling.gears.loaded.contact_pressure import mesh_pressure
from gearwhine.coupling.sweep.resonances import find_resonances
from gearwhine.from_case.machine import solve_gears
from gearwhine.results.system import sections
from gearwhine.solve.gear_pairs import analyse_pairs

HELICAL = (
    "gear.*.module=3.066814498467792 mm",  # at 15 degrees the same centre distance
    "gear.*.face_width=30 mm",
    "gear.pinion.helix_angle=15 deg",
    "gear.wheel.helix_angle=-15 deg",
    # Were both gears alike, drive and back flanks would be, too.
    "gear.pinion.tip_relief={amount='15 um', length='2.5 mm'}",
    "gear.wheel.tip_relief=",
    "gear_pair.0.misalignment=0.3 mrad",
    "operation.speed=1500 rpm",
)


def braked_case() -> Case:
    return load_case("small-gearbox", [*HELICAL, "operation.torque=-71.77 N*m"]).case


def exchanged_case() -> Case:
    """Both gears have 28 teeth, so that the torque is the same at either."""
    document = case_document(load_case("small-gearbox", [*HELICAL, "operation.torque=71.77 N*m"]).case)
    pair = document["gear_pair"][0]
    pair["driver"], pair["driven"] = pair["driven"], pair["driver"]
    document["operation"]["speed"] = "-1500 rpm"
    document.pop("provenance")
    return parse_case(document)


@cache
def analysed(*, braked: bool) -> PairAnalysis:
    case = braked_case() if braked else exchanged_case()
    (pair,) = analyse_pairs(case, solve_gears(case.parts))
    return pair


def test_stress_and_curves_of_a_braked_pair_are_those_of_its_back_flanks() -> None:
    """A place of the path is as far from its beginning as it is from the end of the exchanged pair's."""
    braked, driving = analysed(braked=True), analysed(braked=False).solved
    phases = driving.geometry.contact_ratio - braked.solved.static.phases
    mesh = loaded_transmission_error(driving.contact, driving.static.force, phases)
    pressure = mesh_pressure(driving.geometry, driving.contact, mesh)
    largest = braked.largest_pressure
    assert largest is not None
    assert largest[0] == pytest.approx(float(np.nanmax(pressure)), rel=1e-9)
    assert braked.pitch_pressure == pytest.approx(analysed(braked=False).pitch_pressure, rel=1e-9)
    np.testing.assert_allclose(braked.solved.static.transmission_error, mesh.transmission_error, rtol=1e-9)
    np.testing.assert_allclose(braked.stiffness, mesh_stiffness(driving.contact, phases), rtol=1e-9)
    np.testing.assert_allclose(braked.unloaded, first_touch(driving.contact, phases), rtol=0.0, atol=1e-15)
    assert braked.shares is not None
    assert braked.shares[1].max() == pytest.approx(float(mesh.load_shares.max()), rel=1e-9)
    curves = braked.curves()
    mesh = loaded_transmission_error(
        driving.contact, driving.static.force, driving.geometry.contact_ratio - curves.phases
    )
    np.testing.assert_allclose(curves.mesh.transmission_error, mesh.transmission_error, rtol=1e-9)


@pytest.mark.slow
def test_harris_map_and_relief_of_a_braked_pair_are_those_of_its_back_flanks() -> None:
    braked, driving = (solve_over_torques([analysed(braked=way)])[0] for way in (True, False))
    assert braked.as_given == pytest.approx(driving.as_given, rel=5e-3)
    assert braked.optimum is not None
    assert driving.optimum is not None
    assert braked.optimum.unmodified[0] == pytest.approx(driving.optimum.unmodified[0], rel=5e-3)


@pytest.mark.slow
def test_transmissibility_lines_and_resonances_of_a_braked_machine_are_those_of_its_back_flanks() -> None:
    """The machine is the same whichever gear is called the driver: its flanks that touch, and how it answers them."""
    found = []
    for case in (braked_case(), exchanged_case()):
        document = case_document(case)
        document["housing"]["box"]["mesh_size"] = "60 mm"
        for bearing in document["bearing"]:
            bearing["stiffness"] = {"matrix": np.diag([1.2e8, 1.2e8, 5e7, 0.0, 0.0]).tolist()}
        study = gw.build(**document)
        result, machine = study.system(), study.machine.assembled
        resonances = find_resonances(machine, 2500.0)
        assert resonances is not None
        (response,) = result.solved.responses
        (force,) = response.mesh_force.values()
        found.append(
            ({**response.sensor_acceleration, "force": force}, result.document["mesh_lines"], resonances, result)
        )
    (accelerations, lines, resonances, result), (others, other_lines, other_resonances, other_result) = found
    assert list(accelerations) == ["top", "right wall", "force"]
    # Phases are sampled from the other end of the path, where slices come into touch between other ones: the mean mesh
    # stiffness differs by 6e-4, by half of which resonances move. Where responses nearly cancel more of them is left.
    stiffness = [one.document["mesh_stiffness"][0]["stiffness_n_per_m"] for one in (result, other_result)]
    assert stiffness[0] == pytest.approx(stiffness[1], rel=1e-3)
    for sensor, acceleration in accelerations.items():
        np.testing.assert_allclose(acceleration, others[sensor], rtol=0.0, atol=1e-3 * np.abs(acceleration).max())
        np.testing.assert_allclose(acceleration, others[sensor], rtol=5e-3, atol=1e-6 * np.abs(acceleration).max())
    assert len(lines) > 2
    for line, other in zip(lines, other_lines, strict=True):
        for by, of_sensors in line["sensor_acceleration_m_per_s2"].items():
            # The mean over a mesh period is sampled from another start, which moves a resonance by some 1e-4 of itself.
            assert of_sensors == pytest.approx(other["sensor_acceleration_m_per_s2"][by], rel=0.02, abs=1e-6)
    np.testing.assert_allclose(resonances.frequencies, other_resonances.frequencies, rtol=1e-4)
    np.testing.assert_allclose(resonances.line_levels, other_resonances.line_levels, atol=0.1)
    shown = "".join(str(part) for section in sections(result.document) for part in section.content)
    assert "by transmission error alone" in shown
