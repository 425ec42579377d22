"""Lines between the mesh harmonics against Fourier's integral, the mechanisms of single lines, and the motion."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from sounding_gearbox import small_gearbox

import gearwhine as gw
from gearwhine.coupling import CoupledMachine
from gearwhine.coupling.analyses.loaded_machine import load_machine
from gearwhine.coupling.gears import GearError
from gearwhine.coupling.gears.loaded.transmission_error import phasors_between, polygon_phasors
from gearwhine.coupling.linear.line_mechanisms import LineMechanisms
from gearwhine.coupling.linear.lines_over_speed import lines_over_speed, sensor_rms
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel
from gearwhine.coupling.linear.unequal_teeth import UnequalTeeth, unequal_teeth, unequal_teeth_rms
from gearwhine.coupling.statics.mean_mesh import linear_matrices

PITCH = np.random.default_rng(3).normal(scale=3.0, size=28)
CHANGES = [
    "rotor.input.unbalance=",
    "gear.pinion.errors.pitch=[" + ", ".join(f'"{one:.4f} um"' for one in PITCH) + "]",
    "gear.wheel.errors.runout=4 um",
]
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
    orders = np.array([1, 2, 4, 5, 7, 23])
    found = phasors_between(phases, values, orders)
    np.testing.assert_allclose(found, polygon_phasors(phases, values, orders / 5.0, 5), rtol=1e-10, atol=1e-13)
    moved = phases.copy()
    moved[9] += 1e-3
    with pytest.raises(GearError, match="return in each mesh period"):
        phasors_between(moved, values, orders)


@pytest.mark.parametrize("torque", ["71.77 N*m", "-71.77 N*m"])
def test_each_line_has_what_its_mechanisms_have_there(torque: str) -> None:
    """Pitch errors and runout of a line, found for that line alone, at both sensors; also on the other flanks."""
    machine = uneven_machine(torque)
    model, mechanisms = MeshHarmonicModel(machine), LineMechanisms(machine)
    teeth = unequal_teeth(model, LIMIT)
    stiffness, damping = linear_matrices(machine.system, model.contact)
    rows = np.array(list(machine.sensor_rows.values()))
    shaft = abs(machine.speed)
    assert set(np.round(teeth.frequency / shaft).astype(int)) == set(range(1, 32)) - {28}
    assert np.count_nonzero(teeth.damped) == 1
    for order in (1, 2, 11, 27, 29):
        here = np.abs(teeth.frequency / shaft - order) < 1e-6
        one = UnequalTeeth(*(values[here] for values in (teeth.frequency, teeth.contact, teeth.error, teeth.damped)))
        found = unequal_teeth_rms(model, one, rows, 1.0, stiffness, damping, LIMIT)
        known = mechanisms.motions(order * shaft, 1e-6 * shaft)
        moved = sum(motion for _, by in known for name, motion in by.items() if name in ("pitch_errors", "runout"))
        expected = (order * shaft) ** 2 * np.abs(rows @ moved) / np.sqrt(2.0)
        np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_lines_of_a_machine_without_modes_are_solved_directly() -> None:
    """Free masses have two equal eigenvectors each, which span nothing: their acceleration is the load on them."""
    machine = uneven_machine()
    model = MeshHarmonicModel(machine)
    teeth, rows = unequal_teeth(model, LIMIT), np.array(list(machine.sensor_rows.values()))
    rows = np.vstack([rows, machine.system.contacts[0].direction])
    free = np.zeros((machine.system.size, machine.system.size))
    few = UnequalTeeth(*(values[2:8] for values in (teeth.frequency, teeth.contact, teeth.error, teeth.damped)))
    assert not few.damped.any()
    found = unequal_teeth_rms(model, few, rows, 1.0, free, free, LIMIT)
    number = int(few.contact[0])
    forces = model.contact.stiffness[number] * np.abs(few.error)
    known = np.abs(rows @ machine.system.contacts[number].direction) * np.sqrt(0.5 * np.sum(forces**2))
    np.testing.assert_allclose(found, known, rtol=1e-9, atol=1e-12 * known.max())


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


def test_teeth_that_are_alike_have_no_lines_between() -> None:
    machine = small_gearbox().changed(CHANGES[:1]).machine
    coupled = load_machine(machine, machine.operating_point()).coupled
    assert unequal_teeth(MeshHarmonicModel(coupled), LIMIT).frequency.size == 0
    assert not lines_over_speed(coupled, [machine.speed], LIMIT).between.any()


@pytest.mark.slow
def test_the_motion_grows_by_pitch_deviations_as_the_lines_say() -> None:
    """Against the transient of one hunting period, whose mesh lines are those of a stiffness that varies."""
    settings = ["transient.revolutions=14", "transient.discard=8"]
    motion, lines = [], []
    for changes in (CHANGES[:1], CHANGES[:2]):
        study = small_gearbox().changed([*changes, *settings])
        solved = study.simulate().solved.transient
        machine = study.machine
        coupled = load_machine(machine, machine.operating_point()).coupled
        limit = machine.housing_component.complete_below
        motion.append(np.array([solved.sensor_rms(name) for name in coupled.sensor_rows]))
        lines.append(sensor_rms(coupled, limit))
    grown = [np.sqrt(after**2 - before**2) for before, after in (motion, lines)]
    np.testing.assert_allclose(grown[1], grown[0], rtol=0.25)
    np.testing.assert_allclose(lines[1], motion[1], rtol=0.1)
