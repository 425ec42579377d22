"""A geared machine that runs up: its inertia through the teeth, its bearings over speed, its loads over time."""

from dataclasses import replace

import numpy as np
import pytest

from gearwhine.coupling import (
    CoupledMachine,
    CouplingError,
    GearMesh,
    MachineLoads,
    MountedBearing,
    MountedGear,
    SpeedProfile,
    Torque,
    TransientOutputs,
    TransientSettings,
    assemble_machine,
    simulate,
)
from gearwhine.coupling.gears import ConstantStiffness, Gear, GearPairGeometry, tooth_contact
from gearwhine.coupling.machine.components import rotor_component
from gearwhine.coupling.machine.loads import Drive, TorqueHistory, TorqueRipple, TorqueSlope
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.coupling.time.transient import TransientResult
from gearwhine.rotors import Bearing, Disc, Rotor, RotorError, Segment, ShaftMaterial, modal_rotor

STEEL = ShaftMaterial.from_poisson_ratio(207e9, 0.3, 7850.0)
PAIR = GearPairGeometry(
    Gear("pinion", 24, 3e-3, np.radians(20.0), 0.02), Gear("wheel", 36, 3e-3, np.radians(20.0), 0.02), 90.3e-3
)
RATIO = 24.0 / 36.0
LENGTH, GEAR_AT = 0.2, 0.1
SHAFTS = {
    name: Rotor(name, [Segment(0.1, 0.04, 0.0, STEEL)] * 2, [Disc(GEAR_AT, mass, 0.004 * mass, 0.002 * mass)])
    for name, mass in (("input", 2.0), ("output", 6.0))
}
STIFF = 3e8 * np.eye(2)


def machine(speed: float, *, ends: tuple[float, float] = (0.0, LENGTH), **loads: object) -> CoupledMachine:
    """24 on 36 teeth of constant stiffness, on stiff bearings."""
    rotors, mounted = [], []
    for name, shaft in SHAFTS.items():
        bearings = [Bearing(f"{name} {at}", at, STIFF, 1e-5 * STIFF) for at in ends]
        modal = modal_rotor(shaft, bearings, count=2, gears_at=[GEAR_AT])
        rotors.append(rotor_component(name, modal, start=0.0, damping_ratio=0.02))
        mounted += [MountedBearing(bearing, name, None) for bearing in bearings]
    gears = [
        MountedGear("pinion", "input", GEAR_AT, (0.0, 0.0)),
        MountedGear("wheel", "output", GEAR_AT, (PAIR.working_centre_distance, 0.0)),
    ]
    contact = tooth_contact(PAIR, ConstantStiffness(2e8), damping=2e3)
    return assemble_machine(
        rotors,
        None,
        speeds={"input": speed, "output": -speed * RATIO},
        bearings=mounted,
        meshes=[GearMesh(*gears, PAIR, contact)],
        loads=MachineLoads(**loads),  # type: ignore[arg-type]
    )


def balanced(torque: float) -> tuple[Torque, Torque]:
    return Torque("input", 0.0, torque), Torque("output", LENGTH, torque / RATIO)


def marched(
    parts: CoupledMachine, turning: SpeedProfile | None, duration: float, record_from: float = 0.0
) -> TransientResult:
    settings = TransientSettings(duration, record_from, 1e-5, 2e-5, tolerance=1e-4)
    return simulate(parts.system, settings, transient_outputs(parts), speed_profile=turning)


@pytest.mark.parametrize("drive", [Drive("input", 0.0), Drive("output", LENGTH)])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_inertia_passes_the_teeth(drive: Drive, sense: float) -> None:
    """The mean mesh force is what the far shaft's torque and inertia ask for: F R = T + J dω/dt."""
    speed, torque, duration, gain = 200.0, 30.0, 0.2, 2.5
    parts = machine(sense * speed, torques=balanced(sense * torque), drives=[drive])
    turning = SpeedProfile(np.array([0.0, duration]), np.array([0.5, 0.5 + gain * duration]))
    result = marched(parts, turning, duration, 0.1)
    radius = PAIR.driver.base_radius
    if drive.rotor == "input":
        at_wheel = torque / RATIO + SHAFTS["output"].polar_inertia * speed * RATIO * gain
        expected = at_wheel * RATIO / radius
    else:
        expected = (torque - SHAFTS["input"].polar_inertia * speed * gain) / radius
    assert result.mean_force[0] == pytest.approx(expected, rel=2e-3)
    # A sum of torques that is not the inertia's would carry the train away from its nominal rotation.
    assert np.abs(histories(replace(parts, speed_profile=turning), result).gear_motion["wheel"][:, 2]).max() < 1e-3


def test_the_train_as_a_whole_is_not_loaded() -> None:
    system = machine(200.0).system
    rigid = np.concatenate(
        [speed * rotor.turning for speed, rotor in zip(system.speeds, machine(200.0).rotors, strict=True)]
    )
    assert abs(rigid @ system.acceleration_load) < 1e-12 * np.abs(rigid) @ np.abs(system.acceleration_load)
    # Each shaft turns as a whole, and weighs its polar inertia.
    for rotor in machine(200.0).rotors:
        for at in (0.0, 0.07, LENGTH):
            assert rotor.rotation(at) @ rotor.turning == pytest.approx(1.0, abs=1e-9)
        assert np.sum(rotor.turning**2) == pytest.approx(SHAFTS[rotor.name].polar_inertia, rel=1e-9)


def test_a_train_has_one_drive() -> None:
    with pytest.raises(CouplingError, match="of one train are said to drive it; expected one"):
        machine(200.0, drives=[Drive("input", 0.0), Drive("output", 0.0)])


TABLE = np.array([50.0, 150.0, 400.0])
BY_SPEED = np.array([1.0, 1.6, 1.9])[:, None, None] * 1e7 * np.eye(2)


def on_tables(speed: float, rates: tuple[float, float]) -> CoupledMachine:
    shaft = SHAFTS["input"]
    bearings = [Bearing(str(at), at, BY_SPEED, 1e-4 * BY_SPEED, TABLE) for at in (0.0, LENGTH)]
    modal = modal_rotor(shaft, [one.at_speed(speed) for one in bearings], count=2)
    rotor = rotor_component("input", modal, start=0.0)
    mounted = [MountedBearing(one, "input", None) for one in bearings]
    return assemble_machine([rotor], None, speeds={"input": speed}, bearings=mounted, speed_range=rates)


@pytest.mark.parametrize("rate", [0.25, 0.4, 0.75, 1.1, 2.0])
def test_bearings_follow_their_tables(rate: float) -> None:
    """Between the least and the highest speed the law is the bearing's own at each."""
    system = on_tables(200.0, (0.25, 2.0)).system
    for connector in system.linear:
        assert connector.over_speed is not None
        stiffness, damping = connector.over_speed.at(rate)
        law = Bearing("one", 0.0, BY_SPEED, 1e-4 * BY_SPEED, TABLE).at_speed(200.0 * rate)
        np.testing.assert_allclose(stiffness, law.stiffness, rtol=1e-3)
        np.testing.assert_allclose(damping, law.damping, rtol=1e-3)


def test_steady_bearings_keep_one_law() -> None:
    assert all(connector.over_speed is None for connector in on_tables(200.0, (1.0, 1.0)).system.linear)
    with pytest.raises(RotorError, match="a speed in its table"):
        on_tables(200.0, (0.1, 1.0))


@pytest.mark.parametrize("speed", [250.0, 100.0, -160.0, 300.0])
def test_a_machine_at_another_speed_runs_between_the_same_speeds(speed: float) -> None:
    """From 100 to 260 rad/s, and at the speed itself where that is none of these."""
    system = on_tables(200.0, (0.5, 1.3)).at_speed(speed).system
    for absolute in (100.0, 130.0, 150.0, 200.0, 260.0, abs(speed)):
        law = Bearing("one", 0.0, BY_SPEED, 1e-4 * BY_SPEED, TABLE).at_speed(absolute)
        for connector in system.linear:
            assert connector.over_speed is not None
            stiffness, damping = connector.over_speed.at(absolute / abs(speed))
            np.testing.assert_allclose(stiffness, law.stiffness, rtol=1e-3)
            np.testing.assert_allclose(damping, law.damping, rtol=1e-3)
    assert all(part.over_speed is None for part in on_tables(200.0, (1.0, 1.0)).at_speed(speed).system.linear)


def test_bearing_forces_over_speed() -> None:
    """Forces of a recorded motion, whatever it is, are those of the bearings at the speed of each moment."""
    parts = on_tables(200.0, (0.5, 1.5))
    rng = np.random.default_rng(3)
    outputs = transient_outputs(parts)
    k, s = len(outputs.displacement), 7
    result = marched(parts, None, 1e-3)
    result = replace(
        result, times=np.linspace(0.0, 1.0, s), displacement=rng.normal(size=(s, k)), velocity=rng.normal(size=(s, k))
    )
    turning = SpeedProfile(np.array([0.0, 1.0]), np.array([0.5, 1.5]))
    forces = histories(replace(parts, speed_profile=turning), result).bearing_force["0.0"]
    for i, rate in enumerate(turning.at(result.times)[1]):
        law = Bearing("one", 0.0, BY_SPEED, 1e-4 * BY_SPEED, TABLE).at_speed(200.0 * float(rate))
        expected = law.stiffness @ result.displacement[i, :2] + law.damping @ result.velocity[i, :2]
        np.testing.assert_allclose(forces[i], expected, rtol=1e-3)


def test_torques_over_time_and_by_order() -> None:
    """A rigid rotor's rotation: θ'' = T(t)/J, integrated by hand."""
    shaft = SHAFTS["input"]
    rotor = rotor_component("input", modal_rotor(shaft, [], count=1), start=0.0)
    inertia, speed = shaft.polar_inertia, 100.0
    # Two cycles of a triangle: no torque in the mean, at rest at the start.
    times, values = np.array([0.0, 0.1, 0.3, 0.4]), np.array([0.0, 2.0, -2.0, 0.0])
    parts = assemble_machine(
        [rotor],
        None,
        speeds={"input": speed},
        loads=MachineLoads(
            torques=[TorqueHistory("input", 0.0, times, values), TorqueRipple("input", 0.0, 3.0, 0.4, order=2.0)]
        ),
    )
    row = parts.rotors[0].rotation(0.0)[None, :]
    settings = TransientSettings(0.4, 0.0, 1e-4, 2e-5, tolerance=1e-4)
    start = np.zeros(parts.system.size), np.zeros(parts.system.size)
    result = simulate(parts.system, settings, TransientOutputs(row, row, row), initial=start)
    ripple = 3.0 * np.cos(2.0 * speed * result.times + 0.4)
    expected = (np.interp(result.times, times, values) + ripple) / inertia
    np.testing.assert_allclose(result.acceleration[:, 0], expected, atol=2e-3 * np.abs(expected).max())


def test_a_slope_of_torque_resists() -> None:
    """J ω' = -c ω: a rotor beside its nominal speed comes back to it."""
    shaft = SHAFTS["input"]
    rotor = rotor_component("input", modal_rotor(shaft, [], count=1), start=0.0)
    slope = TorqueSlope("motor", "input", 0.0, np.array([0.0, 1.0]), np.array([-0.2, -0.2]))
    parts = assemble_machine([rotor], None, speeds={"input": 100.0}, loads=MachineLoads(torques=[slope]))
    row = parts.rotors[0].rotation(0.0)[None, :]
    settings = TransientSettings(0.1, 0.0, 1e-3, 1e-4, tolerance=1e-4)
    start = np.zeros(parts.system.size), 3.0 * parts.rotors[0].turning
    result = simulate(parts.system, settings, TransientOutputs(row, row, row), initial=start)
    expected = 3.0 * np.exp(-0.2 * result.times / shaft.polar_inertia)
    np.testing.assert_allclose(result.velocity[:, 0], expected, rtol=1e-5)


@pytest.mark.parametrize("speed", [50.0, 80.0, -120.0, 150.0, 0.0])
def test_the_slope_of_a_torque_is_that_of_the_speed(speed: float) -> None:
    """A motor of dT/dω = -0.1 N m s below 60 rad/s, falling to -0.4 at 120: in a machine set to another speed too."""
    rotor = rotor_component("input", modal_rotor(SHAFTS["input"], [], count=1), start=0.0)
    slope = TorqueSlope("motor", "input", 0.0, np.array([0.6, 1.2]), np.array([-0.1, -0.4]))
    parts = assemble_machine([rotor], None, speeds={"input": 100.0}, loads=MachineLoads(torques=[slope]))
    system = parts.at_speed(speed).system
    expected = np.interp(abs(speed), [60.0, 120.0], [0.1, 0.4])
    assert system.linear[0].damping[0, 0] == pytest.approx(expected, rel=1e-12)
    if speed:
        damping = system.connector_matrices(90.0 / abs(speed))[1]
        row = system.linear[0].directions[:, 0]
        np.testing.assert_allclose(damping, 0.25 * np.outer(row, row), atol=1e-12 * np.abs(row).max() ** 2)


@pytest.mark.parametrize("phase", [0.0, -1.2])
def test_a_ripple_swings_the_train_and_does_not_move_it_off(phase: float) -> None:
    """As one body the train swings by A/(J w²) about where it is, whatever the phase at which it starts."""
    amplitude, frequency = 3.0, 300.0
    ripple = TorqueRipple("input", 0.0, amplitude, phase, frequency=frequency)
    parts = machine(200.0, torques=[*balanced(30.0), ripple])
    result = marched(parts, None, 40.0 * np.pi / frequency)
    angle = histories(parts, result).gear_motion["pinion"][:, 2]
    inertia = SHAFTS["input"].polar_inertia + SHAFTS["output"].polar_inertia * RATIO**2
    drift = np.polyfit(result.times, angle, 1)[0]
    assert abs(drift) < 0.02 * amplitude / (inertia * frequency)
    # Well below the train's own torsional modes it moves as one body.
    assert 0.5 * np.ptp(angle) == pytest.approx(amplitude / (inertia * frequency**2), rel=0.05)
