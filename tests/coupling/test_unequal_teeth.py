"""Lines of meshes against Fourier's integral, the mechanisms of single lines, and the motion."""

from dataclasses import fields, replace
from functools import cache, cached_property
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from reducer_case import reducer
from sounding_gearbox import small_gearbox

import gearwhine as gw
from gearwhine.coupling import CoupledMachine, TransientOutputs, TransientSettings, simulate
from gearwhine.coupling.analyses.loaded_machine import load_machine
from gearwhine.coupling.gears import GearError
from gearwhine.coupling.gears.loaded.transmission_error import HuntingCurve, hunting_period_mesh, polygon_phasors
from gearwhine.coupling.linear.line_mechanisms import LineMechanisms
from gearwhine.coupling.linear.lines_over_speed import housing_rates, lines_over_speed, sensor_rms
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel
from gearwhine.coupling.linear.unequal_teeth import DampedMachine, lines_of_meshes
from gearwhine.coupling.statics.mean_mesh import linear_matrices
from gearwhine.coupling.sweep.line_sound import RadiatedPower

PITCH = np.random.default_rng(3).normal(scale=3.0, size=28)


def pitch(size: float) -> str:
    """Change of a case with these pitch deviations, or a part of them."""
    return "gear.pinion.errors.pitch=[" + ", ".join(f'"{size * one:.5f} um"' for one in PITCH) + "]"


CHANGES = ["rotor.input.unbalance=", pitch(1.0), "gear.wheel.errors.runout=4 um"]
LIMIT = 2.0 * np.pi * 2900.0


@cache
def uneven(torque: str = "71.77 N*m") -> gw.Machine:
    """The small gearbox with pitch deviations of one gear and runout of the other."""
    return small_gearbox().changed([*CHANGES, f"operation.torque={torque}"]).machine


@cache
def uneven_machine(torque: str = "71.77 N*m") -> CoupledMachine:
    machine = uneven(torque)
    return load_machine(machine, machine.operating_point()).coupled


def test_amplitudes_between_mesh_harmonics_are_fouriers_integrals() -> None:
    """Of the polygon through uneven places that return in each of five mesh periods, also beyond one order."""
    rng = np.random.default_rng(1)
    first = np.sort(rng.uniform(0.0, 0.98, 7))
    phases = (np.arange(5)[:, None] + first).ravel()
    values = rng.normal(size=35)
    cycles = np.array([1, 2, 4, 5, 7, 23])
    found = HuntingCurve.through(phases, values, 5).amplitudes(cycles)
    np.testing.assert_allclose(found, polygon_phasors(phases, values, cycles / 5.0, 5), rtol=1e-10, atol=1e-13)
    moved = phases.copy()
    moved[9] += 1e-3
    with pytest.raises(GearError, match="return in each mesh period"):
        HuntingCurve.through(moved, values, 5)


@pytest.mark.parametrize("torque", ["71.77 N*m", "-71.77 N*m"])
def test_each_line_has_what_its_mechanisms_have_there(torque: str) -> None:
    """Of constant stiffness: pitch errors and runout, found for a line alone, at both sensors; also on other flanks."""
    machine = uneven_machine(torque)
    model, mechanisms = MeshHarmonicModel(machine), LineMechanisms(machine)
    (mesh,) = model.varying_meshes(LIMIT)
    mesh = replace(mesh, stiffness=0.0 * mesh.stiffness)
    stiffness, damping = linear_matrices(machine.system, model.contact)
    rows = np.array(list(machine.sensor_rows.values()))
    shaft = abs(machine.speed)
    found = lines_of_meshes(
        [mesh],
        model.contact,
        machine.system.contact_directions,
        rows,
        DampedMachine(stiffness, damping),
        {},
        limit=LIMIT,
    )
    orders = np.round(found.frequency / shaft).astype(int)
    np.testing.assert_array_equal(orders, sorted(set(range(1, 32)) - {28}))
    np.testing.assert_array_equal(mesh.damped, [False] * 15 + [True])
    for order in (1, 2, 11, 14, 27, 29):
        known = mechanisms.motions(order * shaft, 1e-6 * shaft)
        moved = sum(motion for _, by in known for name, motion in by.items() if name in ("pitch_errors", "runout"))
        expected = -((order * shaft) ** 2) * (rows @ moved)
        np.testing.assert_allclose(found.between[:, orders == order][:, 0], expected, rtol=1e-6)


def test_mechanisms_add_up_to_the_lines_of_the_teeth() -> None:
    """At a mesh harmonic and between them, with the stiffness that varies; the unbalance has a part of its own."""
    machine = uneven_machine()
    model, mechanisms = MeshHarmonicModel(machine), LineMechanisms(machine)
    rows = np.array(list(machine.sensor_rows.values()))
    damped = DampedMachine(*linear_matrices(machine.system, model.contact))
    mean = {cause: damped.motion(load.frequency, load.load) for load in model.loads(np.inf) for cause in load.causes}
    meshes, directions = model.varying_meshes(), machine.system.contact_directions
    found = lines_of_meshes(meshes, model.contact, directions, rows, damped, mean)
    shaft = abs(machine.speed)
    (harmonic,) = (one for one in model.responses(LIMIT) if one.causes == ((0, 1),))
    for order in (1, 11, 13, 27, 28, 29, 42):
        ((_, by_mechanism),) = mechanisms.motions(order * shaft, 1e-6 * shaft)
        # A wheel's eccentricity and unbalance turn with one shaft, pitch with the other.
        moved = -((order * shaft) ** 2) * (rows @ sum(q for name, q in by_mechanism.items() if name != "unbalance"))
        if order == 28:
            # Teeth that are alike have more phases in a mesh period than all teeth of the hunting period.
            np.testing.assert_allclose(moved, -(harmonic.frequency**2) * (rows @ harmonic.motion), rtol=2e-3)
            continue
        place = int(np.argmin(np.abs(found.frequency - order * shaft)))
        np.testing.assert_allclose(found.between[:, place], moved, rtol=1e-6)
        assert (
            np.linalg.norm(rows @ by_mechanism["varying_stiffness"]) * (order * shaft) ** 2 > 1e-3 * np.abs(moved).max()
        )


def test_answers_of_a_machine_without_modes_are_solved_directly() -> None:
    """Free masses have two equal eigenvectors each, which span nothing: they move as the load on them accelerates."""
    free, frequency = np.zeros((3, 3)), np.arange(80.0).reshape(2, 40)
    found = DampedMachine(free, free).answers(np.eye(3), np.array([1.0, 0.0, -2.0]), frequency)
    known = np.divide(1.0, frequency**2, out=np.zeros((2, 40)), where=frequency > 0.0)
    np.testing.assert_allclose(found, [-known, 0.0 * known, 2.0 * known], rtol=1e-12)


def test_another_speed_has_the_lines_of_the_machine_at_that_speed() -> None:
    """All together, as of the machine that is made anew there; mesh harmonics apart."""
    machine = uneven()
    point = machine.operating_point()
    found = lines_over_speed(uneven_machine(), [0.7 * machine.speed, machine.speed], LIMIT)
    there = load_machine(replace(machine, speed=0.7 * machine.speed), point).coupled
    np.testing.assert_allclose(sensor_rms(there, LIMIT), found.rms[:, 0], rtol=1e-7)
    meshes = np.sqrt(0.5 * np.nansum(found.amplitudes[:, 0] ** 2, axis=1))
    np.testing.assert_allclose(found.rms[:, 0] ** 2, meshes**2 + found.between[:, 0] ** 2, rtol=1e-12)
    assert np.all(found.between > 0.2 * found.rms)


def test_teeth_that_hardly_differ_have_the_mesh_harmonics_of_teeth_that_are_alike() -> None:
    """Their stiffness is that of a table over the hunting period, and of equilibria of one mesh period."""
    alike = small_gearbox().changed(CHANGES[:1])
    amplitudes = []
    for study in (alike, alike.changed([pitch(1e-4)])):
        machine = study.machine
        coupled = load_machine(machine, machine.operating_point()).coupled
        speeds = [0.3 * machine.speed, 0.6 * machine.speed, machine.speed]
        amplitudes.append(lines_over_speed(coupled, speeds, LIMIT).amplitudes)
    np.testing.assert_allclose(amplitudes[1], amplitudes[0], rtol=5e-3)


def test_teeth_that_are_alike_have_no_lines_between() -> None:
    machine = small_gearbox().changed(CHANGES[:1]).machine
    coupled = load_machine(machine, machine.operating_point()).coupled
    assert not lines_over_speed(coupled, [machine.speed], LIMIT).between.any()


class Watched(CoupledMachine):
    """A machine without a housing, with a sensor of what the first mesh is compressed by."""

    @cached_property
    def sensor_rows(self) -> dict[str, np.ndarray]:
        return {"first mesh": self.system.contact_directions[:, 0]}


def test_pitch_errors_of_a_wheel_add_with_their_phase_to_the_next_mesh(tmp_path: Path) -> None:
    """Order 19 of the middle shaft is the mesh of its pinion: |h + p|² + |h - p|² = 2 |h|² + 2 |p|²."""
    (tmp_path / "reducer.toml").write_text(reducer((21, 30, 19, 56)))
    errors = 2.0 * np.sin(2.0 * np.pi * 19.0 * np.arange(30) / 30.0)
    found, parts = [], []
    for sign in (0.0, 1.0, -1.0):
        listed = ", ".join(f'"{sign * one:.6f} um"' for one in errors)
        machine = gw.load(tmp_path / "reducer.toml", {"gear.b.errors.pitch": f"[{listed}]"}).machine
        coupled = load_machine(machine, machine.operating_point()).coupled
        watched = Watched(**{one.name: getattr(coupled, one.name) for one in fields(coupled) if one.init})
        over = lines_over_speed(watched, [watched.speed], 1.2 * 19.0 * 0.7 * abs(watched.speed))
        (place,) = np.flatnonzero(np.isclose(over.orders, 19.0 * 0.7))
        found.append(over.amplitudes[0, 0, place])
        line = LineMechanisms(watched).parts(19.0 * 0.7 * abs(watched.speed))["first mesh"]
        parts.append(line.amplitudes.get("pitch_errors", 0.0))
        # The errors have the order 30 - 19 of the shaft, too, between the harmonics of the meshes.
        other = LineMechanisms(watched).parts(11.0 * 0.7 * abs(watched.speed)).get("first mesh")
        apart = 0.0 if other is None else other.amplitudes["pitch_errors"] / np.sqrt(2.0)
        assert over.between[0, 0] == pytest.approx(apart, rel=0.05)
    alike, plus, minus = found
    assert abs(plus - minus) > 0.05 * alike
    by_errors = np.sqrt(0.5 * (plus**2 + minus**2) - alike**2)
    assert by_errors == pytest.approx(parts[1], rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("size", [1.0, 0.1])
def test_lines_are_those_of_the_motion(size: float) -> None:
    """Against the transient of whole hunting periods: the mesh harmonic, and the lines between, of errors of 3 µm too.

    A machine with the mean mesh stiffness has 1.09 times the mesh harmonic and 0.81 times the lines between.
    """
    settings = ["transient.revolutions=14", "transient.discard=8"]
    study = small_gearbox().changed([CHANGES[0], pitch(size), *settings])
    motion = study.simulate().solved.transient
    found = lines_over_speed(motion.machine, [motion.speed], LIMIT)
    for number, sensor in enumerate(found.sensors):
        signal = motion.histories.sensor_acceleration[sensor]
        lines = 2.0 * np.abs(np.fft.rfft(signal))[::6] / len(signal)
        between = np.sqrt(0.5 * np.sum(np.delete(lines[: 1 + round(LIMIT / motion.speed)], [0, 28]) ** 2))
        assert found.amplitudes[number, 0, 0] == pytest.approx(lines[28], rel=0.015)
        assert found.between[number, 0] == pytest.approx(between, rel=0.025)


@pytest.mark.slow
def test_sound_power_is_that_of_the_motion_over_time() -> None:
    """Of a housing with one radiation resistance for all its coordinates, by Parseval: R times their mean square rates.

    The mesh harmonic alone has 0.6 of it.
    """
    resistance, shaft = 3e-3, abs(uneven().speed)
    machine = uneven_machine()
    frequencies, rates = housing_rates(machine, LIMIT)
    radiation = SimpleNamespace(
        method="erp", equivalent_power=lambda moved: 0.5 * resistance * np.sum(np.abs(moved) ** 2, axis=0)
    )
    radiated = RadiatedPower(radiation, None, 20.0, 2900.0)  # type: ignore[arg-type]
    level, _ = radiated.levels(frequencies / (2.0 * np.pi), rates)
    assert machine.housing is not None
    moves = machine.rows(machine.housing.name, np.eye(machine.housing.size))
    turn, samples = 2.0 * np.pi / shaft, 1024
    # The wheel's runout returns with the wheel alone, which has as many teeth as the pinion.
    settings = TransientSettings(14.0 * turn, 8.0 * turn, turn / samples, 1e-5, tolerance=1e-3)
    motion = simulate(machine.system, settings, TransientOutputs(moves[:0], moves, moves[:0]))
    lines = np.fft.rfft(motion.velocity[: 6 * samples], axis=0)
    orders = np.arange(len(lines)) / 6.0
    lines[(orders * shaft > LIMIT) | (orders == 0.0)] = 0.0
    over_time = np.fft.irfft(lines, 6 * samples, axis=0)
    power = resistance * np.sum(np.mean(over_time**2, axis=0))
    assert level == pytest.approx(10.0 * np.log10(power / 1e-12), abs=0.25)
    (mesh,) = np.flatnonzero(np.isclose(frequencies, 28.0 * shaft))
    alone, _ = radiated.levels(frequencies[[mesh]] / (2.0 * np.pi), rates[[mesh]])
    assert alone < level - 2.0


def test_faint_lines_are_left_out_of_the_sound() -> None:
    """All but a millionth of the power, with or without weighting by frequency, which low lines have little of."""
    solved = list[int]()

    def power(moved: np.ndarray) -> np.ndarray:
        solved.append(moved.shape[1])
        return np.asarray(np.sum(np.abs(moved) ** 2, axis=0))

    radiation = SimpleNamespace(method="erp", equivalent_power=power)
    radiated = RadiatedPower(radiation, None, 20.0, 2900.0)  # type: ignore[arg-type]
    hertz = np.array([10.0, 10.0**1.5, 1000.0, 2000.0, 3000.0])
    rates = 1e-3 * np.array([[1.0], [1.0], [1e-2], [1e-5], [1.0]], dtype=np.complex128)
    level, weighted = radiated.levels(hertz, rates)
    assert level == pytest.approx(60.0 + 10.0 * np.log10(1.0 + 1e-4), abs=1e-5)
    # Those that are heard are estimated at once, then two of them found alone. A-weighting of 31.6 Hz is -39.4 dB.
    assert solved == [3, 1, 1]
    assert weighted == pytest.approx(10.0 * np.log10(10.0 ** (6.0 - 3.94) + 10.0**2), abs=0.05)
    assert radiated.levels(hertz[:1], rates[:1]) == (-np.inf, -np.inf)


def test_mesh_that_a_contact_keeps_is_that_of_its_force_and_points() -> None:
    contact = uneven_machine().system.contacts[0].contact
    hunting_period_mesh(contact, 1500.0)
    for force, points in ((1500.01, 60), (1500.0, 20)):
        found, anew = (hunting_period_mesh(one, force, points) for one in (contact, replace(contact)))
        assert found.force == force
        np.testing.assert_array_equal(found.transmission_error, anew.transmission_error)
    assert hunting_period_mesh(contact, 1500.0 * (1.0 + 1e-12), 20) is found


def test_modes_answer_as_the_machine_with_pairs_and_with_overdamped_modes() -> None:
    """Unsymmetric matrices, of which two motions decay without swinging."""
    rng = np.random.default_rng(5)
    size, w = 6, np.linspace(3.0, 400.0, 60)
    stiffness = np.diag(np.linspace(20.0, 300.0, size) ** 2) + rng.normal(0.0, 90.0, (size, size))
    damping = np.diag([90.0, 3.0, 900.0, 4.0, 5.0, 6.0]) + rng.normal(0.0, 1.0, (size, size))
    machine, outputs, direction = DampedMachine(stiffness, damping), rng.normal(size=(2, size)), rng.normal(size=size)
    values, _ = machine._modes
    assert 0 < np.count_nonzero(values.imag == 0.0) < values.size
    dynamic = stiffness + 1j * w[:, None, None] * damping - w[:, None, None] ** 2 * np.eye(size)
    expected = outputs @ np.linalg.solve(dynamic, direction[:, None])[:, :, 0].T
    np.testing.assert_allclose(machine._by_modes(outputs, direction, w), expected, rtol=1e-10)
    np.testing.assert_allclose(machine.answers(outputs, direction, w), expected, rtol=1e-10)
