"""Speed and torque over time, from the case to the motion: run-up, free speed, ripple, tables."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Sequence
from importlib.resources import files
from typing import Any

import numpy as np
import pytest
from coupled_cases import about_operating_point, coupled

from gearwhine.case import Case, CaseError, dump_case, load_case, parse_case
from gearwhine.coupling import CoupledMachine, Torque, TransientError, periodic_response, static_equilibrium
from gearwhine.coupling.analyses.transient import SolvedTransient, solve_transient
from gearwhine.coupling.description.excitation import Driving, machine_driving
from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force
from gearwhine.coupling.machine.components import RotorComponent
from gearwhine.coupling.machine.loads import TorqueHistory, TorqueRipple, TorqueSlope, largest_torques
from gearwhine.coupling.machine.speed_profile import free_speed
from gearwhine.coupling.signals.spectrum import lines_at
from gearwhine.coupling.statics.mean_mesh import mean_meshes
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.from_case.machine import describe_machine, solve_gears
from gearwhine.output.terminal import shown_by
from gearwhine.results import check
from gearwhine.results.check import check_document
from gearwhine.results.run import transient_document
from gearwhine.solve.machine import plan_of, run_of

RPM = math.pi / 30.0
LINE = {"speed": ["0 rpm", "3000 rpm"], "torque": ["90 N*m", "0 N*m"]}
FREE = {"from": "600 rpm", "time": "20 ms"}


def spur_pair(transient: dict[str, Any], **operation: Any) -> dict[str, Any]:
    """The bundled pair, 28 on 28 teeth, run otherwise; without its unbalance and provenance."""
    document = tomllib.loads(files("gearwhine.cases").joinpath("spur-pair.toml").read_text(encoding="utf-8"))
    del document["provenance"], document["rotor"][0]["unbalance"]
    document["gear_pair"][0]["stiffness"] = {"model": "constant", "value": "2e8 N/m"}
    for bearing in document["bearing"]:
        bearing["damping"] = {"xx": "5e4 N*s/m", "yy": "5e4 N*s/m"}
    return document | {"transient": transient, "operation": document["operation"] | operation}


def run(case: Case) -> SolvedTransient:
    machine = coupled(case)
    # Nominal mesh frequencies matter to sampling alone.
    return solve_transient(machine, plan_of(case))


def driving_of(case: Case, rotors: Sequence[RotorComponent]) -> Driving:
    return machine_driving(describe_machine(case), rotors, run_of(case.transient))


@pytest.mark.parametrize(
    "given",
    [
        spur_pair({"run": {"from": "600 rpm", "to": "6000 rpm", "time": "10 s"}}),
        spur_pair({"run": {"times": [0, 1, 2], "speeds": ["1 rpm", "20 rpm", "3 rpm"]}, "discard": 0.1}),
        spur_pair({"run": FREE}, motor=LINE, load={"speed": [0, 400], "torque": [0, 30]}),
        spur_pair(
            {"revolutions": 4},
            over_time={"time": [0, "1 s"], "torque": ["0 N*m", "-5 N*m"]},
            ripple=[{"amplitude": "2 N*m", "order": 2, "phase": "30 deg"}, {"amplitude": 1, "frequency": "50 Hz"}],
        ),
        spur_pair(
            {"revolutions": 4},
            output=[
                {
                    "rotor": "output",
                    "torque": "71.77 N*m",
                    "over_time": {"time": [0], "torque": [0]},
                    "ripple": [{"amplitude": 1, "order": 0.5}],
                }
            ],
        ),
    ],
)
def test_written_cases_load_back_equal(given: dict[str, Any]) -> None:
    case = parse_case(given)
    assert parse_case(tomllib.loads(dump_case(case))) == case
    shown_by(check.sections)(check_document(case))


WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "nothing": (spur_pair({}), "transient.revolutions: expected a number above 0 of revolutions, or a 'run'"),
    "both": (
        spur_pair({"revolutions": 3, "run": {"from": 1, "to": 2, "time": 1}}),
        "transient.revolutions: expected no number of revolutions beside a 'run'",
    ),
    "no start": (spur_pair({"run": {"to": 2, "time": 1}}), "transient.run.from: expected a speed to start from"),
    "no time": (spur_pair({"run": {"from": 2, "to": 3}}), "transient.run.time: expected a time, or a table"),
    "standing": (
        spur_pair({"run": {"from": 0, "to": 0, "time": 1}}),
        "transient.run.to: expected a speed other than zero at one end",
    ),
    "table with an end": (
        spur_pair({"run": {"to": 2, "times": [0, 1], "speeds": [1, 2]}}),
        "transient.run.to: expected no such key beside 'times' and 'speeds'",
    ),
    "uneven table": (
        spur_pair({"run": {"times": [0, 1], "speeds": [1, 2, 3]}}),
        "transient.run.speeds: expected one value for each entry of 'times', 2 (there are 3)",
    ),
    "later start": (
        spur_pair({"run": {"times": [1, 2], "speeds": [1, 2]}}),
        "transient.run.times: expected two times or more, the first of them 0 s",
    ),
    "falling times": (
        spur_pair({"run": {"times": [0, 2, 2], "speeds": [1, 2, 3]}}),
        "transient.run.times: expected entries that ascend",
    ),
    "no motor": (spur_pair({"run": FREE}), "operation.motor: expected a torque over speed, which drives the free"),
    "no free run": (
        spur_pair({"revolutions": 3}, motor=LINE),
        "operation.motor: expected a [transient.run] without 'to', whose speed is free to follow it",
    ),
    "ripple of no pace": (
        spur_pair({"revolutions": 3}, ripple=[{"amplitude": 3}]),
        "operation.ripple[0].order: expected either an 'order' of the shaft's rotation or a 'frequency'",
    ),
    "time as a length": (
        spur_pair({"run": {"from": 1, "to": 2, "time": "1 m"}}),
        "transient.run.time: expected a time such as '10 s', got '1 m' (length)",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_runs_that_make_no_sense(name: str) -> None:
    document, message = WRONG[name]
    with pytest.raises(CaseError) as caught:
        parse_case(document)
    assert message in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def test_a_bearing_table_must_reach_as_far_as_the_run() -> None:
    document = spur_pair({"run": {"from": "600 rpm", "to": "6000 rpm", "time": "1 s"}})
    document["bearing"][0] |= {"speeds": ["1000 rpm", "7000 rpm"], "stiffness": {"xx": [1e8, 2e8], "yy": [1e8, 2e8]}}
    with pytest.raises(CaseError, match="600 to 6000 rpm"):
        parse_case(document)


def test_a_run_at_the_nominal_speed_is_the_steady_one() -> None:
    """The same to the rounding of its duration."""
    seconds = 4.0 * 60.0 / 5500.0
    steady = run(parse_case(spur_pair({"revolutions": 4, "discard": 2})))
    level = {"run": {"from": "5500 rpm", "to": "5500 rpm", "time": seconds}, "discard": 2}
    varied = run(parse_case(spur_pair(level)))
    for name, force in steady.histories.mesh_force.items():
        np.testing.assert_allclose(varied.histories.mesh_force[name], force, rtol=1e-12)


@pytest.mark.parametrize("speed", ["1000 rpm", "-1000 rpm"])
def test_run_up_torque(speed: str) -> None:
    """Mean mesh force: (T + J₂ dω/dt)/R, J₂ that of the far shaft."""
    given = {"run": {"from": "500 rpm", "to": "1500 rpm", "time": "0.2 s"}, "discard": 1, "points_per_revolution": 400}
    case = parse_case(spur_pair(given, speed=speed, torque="20 N*m"))
    solved = run(case)
    far = float(np.sum(solved.machine.rotors[1].turning ** 2))
    radius = solved.machine.meshes[0].geometry.driver.base_radius
    expected = (20.0 + far * 1000.0 * RPM / 0.2) / radius
    assert solved.result.mean_force[0] == pytest.approx(expected, rel=1e-3)
    document = transient_document(solved)["run"]
    assert (abs(document["from_rpm"]), abs(document["to_rpm"])) == pytest.approx((500.0, 1500.0))
    assert document["revolutions"] == pytest.approx(1000.0 / 60.0 * 0.2)


def linear(first: float, last: float, at: float) -> Any:
    return lambda speed: first + (last - first) * speed / at


def test_free_speed_approaches_its_end_exponentially() -> None:
    """J ω' = T₀(1 - ω/ω₀) - T₁ ω/ω₀: ω = ω₁ (1 - e^{-t/τ}), τ = J ω₀/(T₀ + T₁), ω₁ = ω₀ T₀/(T₀ + T₁)."""
    inertia, top, motor, load = 0.3, 300.0, 50.0, 20.0
    turning = free_speed(
        linear(motor, 0.0, top), linear(0.0, load, top), inertia, start=0.0, duration=5.0, nominal=200.0
    )
    end, constant = top * motor / (motor + load), inertia * top / (motor + load)
    expected = end * (1.0 - np.exp(-turning.times / constant))
    np.testing.assert_allclose(200.0 * turning.speed_ratios, expected, atol=1e-7 * end)


def test_machines_that_do_not_run_say_so() -> None:
    with pytest.raises(TransientError, match=r"cannot start: at rest its motor gives 5 N·m against a load of 8 N·m"):
        free_speed(linear(5.0, 0.0, 100.0), lambda _: 8.0, 0.1, start=0.0, duration=1.0, nominal=100.0)
    # ω' = -(3 + 5 ω/100)/0.1 from 50 rad/s: at rest after (100/5) 0.1 ln(1 + 5·50/(3·100)).
    when = 2.0 * math.log(1.0 + 2.5 / 3.0)
    with pytest.raises(TransientError, match=r"stalls at t = (\S+) s: it started at 477.465 rpm") as caught:
        free_speed(linear(5.0, 0.0, 100.0), lambda _: 8.0, 0.1, start=50.0, duration=10.0, nominal=100.0)
    assert float(str(caught.value).split("t = ")[1].split(" s")[0]) == pytest.approx(when, rel=1e-5)


def test_free_run_of_a_geared_machine() -> None:
    """Motor and load against the train's inertia, and the mean mesh force that the far shaft asks for."""
    load = {"speed": ["0 rpm", "3000 rpm"], "torque": ["10 N*m", "40 N*m"]}
    given = {"run": {"from": "600 rpm", "time": "30 ms"}, "points_per_revolution": 400}
    case = parse_case(spur_pair(given, speed="1500 rpm", motor=LINE, load=load))
    solved = run(case)
    assert solved.speed_profile is not None
    # 90 - 90 ω/ω₀ - 10 - 30 ω/ω₀ about its end.
    inertia, top = 2.0 * float(np.sum(solved.machine.rotors[0].turning ** 2)), 3000.0 * RPM
    assert solved.machine.train_inertia == pytest.approx(inertia, rel=1e-9)
    end, constant = top * 80.0 / 120.0, inertia * top / 120.0
    speed = end + (600.0 * RPM - end) * np.exp(-solved.speed_profile.times / constant)
    np.testing.assert_allclose(1500.0 * RPM * solved.speed_profile.speed_ratios, speed, rtol=1e-6)
    # From rest relative to the nominal rotation the mean over the run: impulse over time.
    gained, mean_speed = speed[-1] - speed[0], np.trapezoid(speed, solved.speed_profile.times) / 0.03
    far = 0.5 * inertia
    expected = (10.0 + 30.0 * mean_speed / top + far * gained / 0.03) / solved.machine.meshes[
        0
    ].geometry.driver.base_radius
    assert solved.result.mean_force[0] == pytest.approx(expected, rel=2e-3)


def test_the_mesh_of_a_free_run_is_that_of_its_mean_load() -> None:
    """Where load and motor meet at the nominal speed: mean force, load shuttling and loads of the steady operation."""
    lines = {
        "motor": {"speed": ["0 rpm", "3000 rpm", "3300 rpm"], "torque": ["300 N*m", "150 N*m", "0 N*m"]},
        "load": {"speed": ["0 rpm", "1000 rpm", "3000 rpm"], "torque": ["0 N*m", "20 N*m", "150 N*m"]},
    }
    document = tomllib.loads(files("gearwhine.cases").joinpath("helical-pair.toml").read_text(encoding="utf-8"))
    del document["provenance"]
    for rotor in document["rotor"]:
        rotor["modes"] = 2
    steady = parse_case(document)
    operation, transient = document["operation"] | lines, {"run": {"from": "2000 rpm", "time": "2 s"}}
    free = parse_case(document | {"operation": operation, "transient": transient})
    expected, machine = (coupled(case).system for case in (steady, free))
    np.testing.assert_allclose(machine.load, expected.load, rtol=1e-12)
    (mean,) = (one for one in mean_meshes(expected) if one is not None)
    (found,) = (one for one in mean_meshes(machine) if one is not None)
    assert found == mean
    shuttling = [load for load in expected.harmonic_loads if load.follows == "turning"]
    assert shuttling
    for one, other in zip(shuttling, machine.harmonic_loads, strict=True):
        np.testing.assert_allclose(other.amplitude, one.amplitude, rtol=1e-9)
    # At the start the load's line has 85 N m, at the end of a long run the two lines meet.
    shares = [share.value for share in describe_machine(steady).torques_from_outside(-65.0)]
    assert [load.values[0] for load in machine.timed_loads] == pytest.approx(shares)
    assert [load.values[-1] for load in machine.timed_loads] == pytest.approx([0.0, 0.0], abs=1e-3)


@pytest.mark.slow
def test_a_free_run_at_its_speed_has_the_lines_of_the_steady_motion() -> None:
    """Bearing forces at the mesh frequency, mostly of load shuttling: time integration against shooting.

    The lines of torque are all but level: a steep one damps the torsion of its shaft at the mesh frequency as well.
    """
    lines = {
        "motor": {"speed": ["0 rpm", "6000 rpm"], "torque": ["151 N*m", "149 N*m"]},
        "load": {"speed": ["0 rpm", "6000 rpm"], "torque": ["149 N*m", "151 N*m"]},
    }
    document = tomllib.loads(files("gearwhine.cases").joinpath("helical-pair.toml").read_text(encoding="utf-8"))
    del document["provenance"]
    for rotor in document["rotor"]:
        rotor["modes"] = 2
    steady = parse_case(document)
    transient = {"run": {"from": "3000 rpm", "time": "0.2 s"}, "discard": 5, "tolerance": 1e-4}
    free = parse_case(document | {"operation": document["operation"] | lines, "transient": transient})
    (mesh,) = steady.parts.mesh_frequencies
    machine = coupled(steady)
    response = periodic_response(machine.system)
    period = histories(machine, response.record(transient_outputs(machine), 256))
    run = solve_transient(coupled(free), plan_of(free)).histories
    interval = float(run.times[1] - run.times[0])
    for name, load in period.bearing_load.items():
        expected = np.abs(lines_at(load.T, response.period / 256, np.array([mesh]), "uniform"))[:2, 0]
        found = np.abs(lines_at(run.bearing_load[name].T, interval, np.array([mesh]), "hann"))[:2, 0]
        np.testing.assert_allclose(found, expected, atol=0.02 * expected.max())
        assert expected.max() > 1.0


def test_torques_of_a_case() -> None:
    """Outputs take what is added to the input in their proportions; everything in the sense of its torque."""
    document = spur_pair(
        {"revolutions": 4},
        over_time={"time": [0, 1], "torque": [0, 6]},
        ripple=[{"amplitude": 2, "order": 3}, {"amplitude": 1, "frequency": "50 Hz"}],
    )
    rotors = coupled(parse_case(document)).rotors
    steady, geared, added, taken, order, frequency = driving_of(parse_case(document), rotors).torques
    assert isinstance(steady, Torque)
    assert isinstance(geared, Torque)
    assert (steady.value, geared.value) == pytest.approx((71.77, 71.77))
    assert isinstance(added, TorqueHistory)
    assert isinstance(taken, TorqueHistory)
    # Both turn counter to each other, so that drive and load have one sign about z.
    np.testing.assert_allclose([added.values, taken.values], [[0.0, 6.0], [0.0, 6.0]])
    assert order == TorqueRipple("input", 0.0, 2.0, 0.0, order=3.0)
    assert frequency == TorqueRipple("input", 0.0, 1.0, 0.0, frequency=100.0 * math.pi)


def test_a_braked_train_rests_on_its_back_flanks() -> None:
    """The torque over the base radius presses the teeth behind, relieved and part of the time in pairs as they are."""
    case = load_case("spur-pair", ["operation.torque=-100 N*m"]).case
    standing = about_operating_point(case)
    pairs, machine = standing.pairs, standing.coupled
    drive, back = machine.system.contacts
    q = static_equilibrium(machine.system)
    compression = [float(contact.direction @ q) - contact.clearance for contact in (drive, back)]
    forces = [
        tooth_force(contact.phase + 1e-9, delta, 0.0, *contact.contact.kernel_arguments)[0]
        for contact, delta in zip((drive, back), compression, strict=True)
    ]
    assert forces == pytest.approx([0.0, 100.0 / pairs[0].geometry.driver.base_radius], rel=1e-9)


def test_a_braked_train_without_backlash_is_refused() -> None:
    with pytest.raises(CaseError, match="back flanks, which never meet"):
        load_case("spur-pair", ["operation.torque=-100 N*m", "gear_pair.0.backlash="])


def test_a_braked_train_on_spread_axes_meets_its_back_flanks() -> None:
    """Axes 0.2 mm further apart than nominal leave a gap behind standard teeth: 2 sin(α) times the spread, at first."""
    spread = ["rotor.1.axis=['44.65 mm', '0 mm']", "operation.torque=-100 N*m", "gear_pair.0.backlash="]
    case = load_case("spur-pair", spread).case
    (pair,) = describe_machine(case).loaded_pairs()
    assert pair.backlash == pytest.approx(0.4e-3 * math.sin(math.radians(20.0)), rel=0.01)
    assert solve_gears(case.parts)[0].backlash == pair.backlash


def test_a_braked_train_coasts_on_its_back_flanks() -> None:
    case = parse_case(spur_pair({"revolutions": 2, "discard": 1}, torque="-100 N*m"))
    solved = run(case)
    (pair,) = transient_document(solved)["gear_pairs"]
    assert pair["flanks"] == "back"
    assert pair["contact_loss_fraction"] == 0.0
    (mesh,) = solve_gears(case.parts)
    assert pair["mean_force_n"] == pytest.approx(100.0 / mesh.geometry.driver.base_radius, rel=1e-3)
    # One constant spring under a constant torque: the start is the motion, so nothing sets in.
    assert pair["peak_force_n"] == pytest.approx(pair["mean_force_n"], rel=1e-6)


def test_the_largest_torques_are_those_of_constants_and_histories_together() -> None:
    """A history that takes a constant torque down to nothing leaves the constant one as the largest."""
    times = np.array([0.0, 1.0])
    torques = [
        Torque("input", 0.0, 150.0),
        TorqueHistory("input", 0.0, times, np.array([-150.0, 0.0])),
        Torque("output", 0.1, -200.0),
        TorqueHistory("output", 0.1, np.array([0.0, 0.5]), np.array([-30.0, 20.0])),
        TorqueHistory("brake", 0.1, times, np.array([0.0, -5.0])),
    ]
    assert largest_torques(torques) == {"input": 150.0, "output": -230.0, "brake": -5.0}
    # Without a bearing along z the thrust of a helical pair is refused, free run or not.
    run = {"run": {"from": "0 rpm", "time": "1 s"}}
    line = {"speed": ["0 rpm", "3000 rpm", "3300 rpm"], "torque": ["300 N*m", "150 N*m", "0 N*m"]}
    load = {"speed": ["0 rpm", "3000 rpm"], "torque": ["0 N*m", "150 N*m"]}
    document = tomllib.loads(files("gearwhine.cases").joinpath("helical-pair.toml").read_text(encoding="utf-8"))
    del document["provenance"]
    for bearing in document["bearing"]:
        bearing["stiffness"] = {"xx": "2e8 N/m", "yy": "2e8 N/m"}
    operation = document["operation"] | {"motor": line, "load": load}

    def assemble(document: dict[str, Any]) -> CoupledMachine:
        case = parse_case(document)
        return coupled(case)

    for part in ({}, {"operation": operation, "transient": run}):
        with pytest.raises(ValueError, match="thrust"):
            assemble(document | part)


def two_motors(besides: dict[str, Any], **changed: Any) -> Case:
    """A pinion that drives one gear and is driven by another, all of 22 teeth: 20 and 10 N m in, 30 N m out."""
    steel = {"youngs_modulus": "207 GPa", "poisson_ratio": 0.3, "density": "7800 kg/m^3"}
    places = {"first": "0 mm", "taker": "88 mm", "giver": "-88 mm"}
    tooth = {"at": "100 mm", "teeth": 22, "module": "4 mm", "face_width": "20 mm"}
    operation: dict[str, Any] = {
        "speed": "1000 rpm",
        "torque": 20,
        "output": [{"rotor": "taker", "torque": 30} | besides, {"rotor": "giver", "torque": -10} | besides],
    }
    document: dict[str, Any] = {
        "material": {"steel": steel},
        "rotor": [
            {
                "name": name,
                "material": "steel",
                "axis": [place, 0],
                "segments": [{"length": "200 mm", "diameter": "30 mm"}],
            }
            for name, place in places.items()
        ],
        "gear": [{"name": f"{name} gear", "rotor": name} | tooth for name in places],
        "gear_pair": [
            {"driver": driver, "driven": driven, "stiffness": {"model": "constant", "value": "2e8 N/m"}}
            for driver, driven in (("first gear", "taker gear"), ("giver gear", "first gear"))
        ],
        "bearing": [
            {"name": f"{name} {at}", "rotor": name, "seat": "ground", "at": at, "stiffness": {"xx": 1e8, "yy": 1e8}}
            for name in places
            for at in ("10 mm", "190 mm")
        ],
        "operation": operation | changed.pop("operation", {}),
        "transient": {"revolutions": 2},
    }
    return parse_case(document | changed)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_torque_taken_off_besides_is_against_the_rotation_of_a_driving_output_too(sense: float) -> None:
    """A second motor of 10 N m from which 2 N m are taken besides gives 8 N m in the end; the taker takes 32 N m.

    At a positive speed both shafts turn clockwise from +z: what is taken off is positive about z, what is given is
    negative.
    """
    besides = {
        "over_time": {"time": [0, 1], "torque": [0, 2]},
        "ripple": [{"amplitude": 1, "order": 1, "phase": "30 deg"}],
    }
    torques = driving_of(two_motors(besides, operation={"speed": f"{1000 * sense} rpm"}), ()).torques
    steady = {torque.rotor: torque.value for torque in torques if isinstance(torque, Torque)}
    assert steady == pytest.approx({"first": 20.0 * sense, "taker": 30.0 * sense, "giver": -10.0 * sense})
    last = {torque.rotor: torque.values[-1] for torque in torques if isinstance(torque, TorqueHistory)}
    assert last == {"taker": 2.0 * sense, "giver": 2.0 * sense}
    largest = {"first": 20.0 * sense, "taker": 32.0 * sense, "giver": -10.0 * sense}
    assert largest_torques(torques) == pytest.approx(largest)
    ripples = {torque.rotor: torque.amplitude for torque in torques if isinstance(torque, TorqueRipple)}
    assert ripples == {"taker": sense, "giver": sense}


@pytest.mark.parametrize("sense", [1, -1])
def test_the_slope_of_a_driving_output_is_that_of_its_torque(sense: int) -> None:
    """The load's line rises by 0.2 N m s: 1.5 of it brakes the taker's shaft and damps it, 0.5 drives the giver's."""
    operation = {
        "speed": f"{1000 * sense} rpm",
        "motor": {"speed": [0, 500], "torque": [60, 60]},
        "load": {"speed": [0, 500], "torque": [0, 100]},
    }
    case = two_motors({}, operation=operation, transient={"run": {"from": "300 rpm", "time": "10 ms"}})
    rotors = coupled(case).rotors
    given = [torque for torque in driving_of(case, rotors).torques if isinstance(torque, TorqueSlope)]
    # 1000 rpm is 104.7 rad/s: the lines end at 4.77 times that, beyond which they are level.
    for ratio, part in ((0.8, 1.0), (4.7, 1.0), (4.8, 0.0)):
        slopes = {torque.rotor: float(np.interp(ratio, torque.speed_ratios, torque.slopes)) for torque in given}
        assert slopes == pytest.approx({"first": 0.0, "taker": -1.5 * 0.2 * part, "giver": 0.5 * 0.2 * part})
