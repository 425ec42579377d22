"""Lines of sensors over speed by one assembled machine, against the machine made anew at each speed."""

from dataclasses import replace

import numpy as np
import pytest
from sounding_gearbox import small_gearbox

from gearwhine.coupling import CouplingError
from gearwhine.coupling.analyses.loaded_machine import load_machine
from gearwhine.coupling.analyses.modes_and_responses import solve_system
from gearwhine.coupling.linear.lines_over_speed import housing_rates, lines_over_speed, sensor_rms
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel
from gearwhine.output.quantity import document_of
from gearwhine.results.system import SYSTEM

LIMIT = 2.0 * np.pi * 6000.0


def test_each_speed_has_the_lines_of_the_machine_at_that_speed() -> None:
    machine = small_gearbox().machine
    point = machine.operating_point()
    coupled = load_machine(machine, point).coupled
    # At the lowest speed more orders couple than in the machine there, and than are kept at the others.
    parts = (0.05, 0.62, 1.0, 1.4)
    found = lines_over_speed(coupled, [part * machine.speed for part in parts], LIMIT, of_housing=True)
    assert found.sensors == tuple(coupled.sensor_rows)
    assert len(found.sensors) == 2
    felt = list[float]()
    for place, part in enumerate(parts):
        there = load_machine(replace(machine, speed=part * machine.speed), point).coupled
        tolerance = 1e-7 if place else 2e-3
        lines = MeshHarmonicModel(there).responses(LIMIT)
        mean = MeshHarmonicModel(there, stiffness_varies=False).responses(LIMIT)
        sensors, housing = np.array(list(there.sensor_rows.values())), there.housing
        assert housing is not None
        amplitudes = found.amplitudes[:, place]
        assert np.isfinite(amplitudes[0]).sum() == len(lines)
        expected, constant = (
            np.array([line.frequency**2 * np.abs(sensors @ line.motion) for line in some]).T for some in (lines, mean)
        )
        moves = there.rows(housing.name, np.eye(housing.size))
        rates = np.array([1j * line.frequency * (moves @ line.motion) for line in lines])
        felt.append(np.max(np.abs(expected / constant - 1.0)))
        assert np.allclose(amplitudes[:, : len(lines)], expected, rtol=tolerance, atol=1e-10 * expected.max())
        assert np.allclose(
            found.orders[: len(lines)] * part * abs(machine.speed), [line.frequency for line in lines], rtol=1e-12
        )
        assert np.allclose(found.rates[place, : len(lines)], rates, rtol=tolerance, atol=1e-9 * np.abs(rates).max())
        assert not found.rates[place, len(lines) :].any()
        assert np.allclose(housing_rates(there, LIMIT)[1], rates, rtol=tolerance, atol=1e-9 * np.abs(rates).max())
        together = np.sqrt(np.sum((expected / np.sqrt(2.0)) ** 2, axis=1))
        assert np.allclose(found.rms[:, place], together, rtol=tolerance)
        assert np.allclose(sensor_rms(there, LIMIT), together, rtol=tolerance)
    assert max(felt) > 0.05


def test_a_diagram_has_the_lines_at_its_resonances_and_at_operation() -> None:
    machine = small_gearbox().machine
    machine = replace(machine, speed=0.4 * machine.speed)
    coupled = load_machine(machine, machine.operating_point()).coupled
    solved = solve_system(coupled, over_speed=(0.8 * machine.speed, 1.1 * machine.speed))
    over, campbell = solved.order_lines, solved.campbell
    assert over is not None
    assert campbell is not None
    here = over.speeds.tolist().index(machine.speed)
    known = {cause: place for place, cause in enumerate(over.causes)}
    assert len(solved.lines) == 2
    for line in solved.lines:
        heights = [line.frequency**2 * abs(row @ line.motion) for row in coupled.sensor_rows.values()]
        assert over.amplitudes[:, here, known[line.cause(coupled)]] == pytest.approx(heights, rel=1e-9)
    met = [one for one in campbell.crossings if one.line.kind == "mesh"]
    assert len(met) >= 3
    assert {one.speed for one in met} <= set(over.speeds.tolist())
    assert (np.diff(np.abs(over.speeds)) > 0.0).all()
    document = document_of(SYSTEM, solved)
    for number, row in enumerate(document["order_lines"]):
        assert row["cause"] == over.causes[number]
        for sensor, peak in row["highest"].items():
            amplitudes = over.amplitudes[over.sensors.index(sensor), :, number]
            assert peak["amplitude_m_per_s2"] == np.nanmax(amplitudes)
            place = int(np.nanargmax(amplitudes))
            assert peak["speed_rpm"] == pytest.approx(abs(over.speeds[place]) * 30.0 / np.pi)
            assert peak["frequency_hz"] == pytest.approx(over.orders[number] * peak["speed_rpm"] / 60.0)


@pytest.mark.slow
@pytest.mark.usefixtures("mechanisms_left_out")
@pytest.mark.parametrize(("speed", "harmonics", "tolerance"), [(1500, 4, 0.01), (2500, 2, 0.015)])
def test_lines_of_the_machine_are_those_of_its_motion(speed: int, harmonics: int, tolerance: float) -> None:
    """Far below the resonance of the mesh, whose high harmonics come back through the stiffness that varies.

    With the mean mesh stiffness a fourth harmonic is 4.4 % low at 1500 rpm, a second one 3.2 % high at 2500 rpm.
    """
    settings = ["rotor.input.unbalance=", "transient.revolutions=8", "transient.discard=6"]
    motion = small_gearbox().changed([*settings, f"operation.speed={speed} rpm"]).simulate().solved.transient
    lines, mean = (
        MeshHarmonicModel(motion.machine, stiffness_varies=varies).responses(2.0 * np.pi * 2900.0)
        for varies in (True, False)
    )
    assert len(lines) == harmonics
    missed = list[float]()
    for sensor, row in motion.machine.sensor_rows.items():
        signal = motion.histories.sensor_acceleration[sensor]
        spectrum = 2.0 * np.abs(np.fft.rfft(signal)) / len(signal)  # of two turns
        for line, other in zip(lines, mean, strict=True):
            recorded = spectrum[round(2.0 * line.frequency / abs(motion.speed))]
            assert line.frequency**2 * abs(row @ line.motion) == pytest.approx(recorded, rel=tolerance)
            missed.append(abs(other.frequency**2 * abs(row @ other.motion) / recorded - 1.0))
    assert max(missed) > 2.0 * tolerance


def test_speeds_of_the_other_sense_or_of_standstill_are_refused() -> None:
    machine = small_gearbox().machine
    coupled = load_machine(machine, machine.operating_point()).coupled
    for wrong in (0.0, -100.0):
        with pytest.raises(CouplingError, match="expected one sense"):
            lines_over_speed(coupled, [wrong], LIMIT)
