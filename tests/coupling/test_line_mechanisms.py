"""Parts of lines by their mechanisms, against loaded teeth that turn slowly and machines with less that excites."""

from dataclasses import replace

import numpy as np
import pytest
from helical_pairs import couple_pairs
from test_teeth_friction import machine as with_friction

from gearwhine.coupling import CoupledMachine, Torque, static_equilibrium
from gearwhine.coupling.gears import Gear, GearPairGeometry, PotentialEnergyStiffness, tooth_contact
from gearwhine.coupling.linear.line_mechanisms import LineMechanisms, LineParts
from gearwhine.numerics.arrays import ComplexArray

SAMPLES = {1: 240, 36: 720}
"""By the number of mesh periods."""
SLOW = 0.01
"""Part of a speed at which inertia is without effect: the motion is a row of equilibria, the mean force on all."""


def slowly(machine: CoupledMachine) -> CoupledMachine:
    return machine.at_speed(SLOW * machine.speeds[machine.leading_rotor])


def equilibria(machine: CoupledMachine, cycles: int, periods: int = 1) -> ComplexArray:
    """Line of all coordinates of teeth that turn slowly, a number of cycles in some mesh periods, shape (n,)."""
    system = machine.system
    samples = SAMPLES[periods]
    times = periods * (np.arange(samples) + 0.5) / samples / abs(system.contacts[0].mesh_frequency)
    motion = []
    for time in times.tolist():
        pushed = [(one.amplitude * np.exp(1j * one.frequency * time)).real for one in system.harmonic_loads]
        still = replace(system, load=system.load + sum(pushed), harmonic_loads=())
        motion.append(static_equilibrium(still, time))
    turned = np.exp(-2j * np.pi * cycles * (np.arange(samples) + 0.5) / samples)
    return np.asarray(2.0 / samples * turned @ np.array(motion))


def predicted(machine: CoupledMachine, order: float) -> dict[str, ComplexArray]:
    """Motions by the mechanisms at a multiple of the mesh frequency."""
    mesh = 2.0 * np.pi * abs(machine.system.contacts[0].mesh_frequency)
    ((at, motions),) = LineMechanisms(machine).motions(order * mesh)
    assert at == pytest.approx(order * mesh, rel=1e-12)
    return motions


def off(found: ComplexArray, expected: ComplexArray) -> float:
    return float(np.linalg.norm(found - expected) / np.linalg.norm(expected))


def braked(machine: CoupledMachine) -> CoupledMachine:
    """The same with torques of the other sign, which the back flanks carry."""
    torques = [replace(torque, value=-torque.value) for torque in machine.loads.torques if isinstance(torque, Torque)]
    return replace(machine, loads=replace(machine.loads, torques=tuple(torques)))


@pytest.mark.parametrize(("sense", "carries", "order"), [(1, "drive", 1), (-1, "drive", 3), (1, "back", 3)])
def test_friction_and_transmission_error_are_those_of_slow_teeth_with_friction_and_without(
    sense: int, carries: str, order: int
) -> None:
    given = [with_friction(mu, sense=sense, backlash=1e-4) for mu in (0.0, 0.08)]
    smooth, rough = (slowly(one if carries == "drive" else braked(one)) for one in given)
    without, whole = (equilibria(one, order) for one in (smooth, rough))
    motions = predicted(rough, order)
    assert list(motions) == ["transmission_error", "friction", "varying_stiffness"]
    # The force that friction adds to the mean one meets a stiffness that varies.
    changed = motions["friction"] + motions["varying_stiffness"]
    assert off(changed, whole - without) < off(motions["friction"], whole - without)
    # The mean force alone is the same at each phase, about which the stiffness makes no difference.
    alone = predicted(smooth, order)
    assert np.linalg.norm(alone["varying_stiffness"]) < 1e-3 * np.linalg.norm(without)
    assert off(motions["transmission_error"], without) < 0.01
    # Friction changes the mesh force as well, by its moments: of the second order in its coefficient.
    assert off(motions["friction"], whole - without) < 0.02


@pytest.mark.parametrize("hand", [1.0, -1.0])
def test_load_shuttling_is_what_its_moments_do(hand: float) -> None:
    machine = slowly(couple_pairs(hand, thrust_stiffness=1e8, sliced=True))
    system = machine.system
    still = replace(machine, system=replace(system, harmonic_loads=()))
    whole, without = equilibria(machine, 1), equilibria(still, 1)
    motions = predicted(machine, 1)
    assert set(motions) == {"transmission_error", "load_shuttling", "varying_stiffness"}
    assert np.linalg.norm(motions["varying_stiffness"]) < 0.01 * np.linalg.norm(without)
    assert off(motions["transmission_error"], without) < 0.01
    assert off(motions["load_shuttling"], whole - without) < 0.01


TEETH = (12, 18)
WAVES = tuple(np.random.default_rng(5).uniform(-3e-6, 3e-6, teeth) for teeth in TEETH)
HUNTING = 36  # mesh periods after which teeth meet again


def with_waves(scale: float, sense: int) -> CoupledMachine:
    """Slow shafts with a law of teeth whose pitch deviations are scaled."""
    gears = [
        Gear(str(n), n, 4e-3, np.radians(25.0), 12e-3, pitch_deviations=tuple((scale * waves).tolist()))
        for n, waves in zip(TEETH, WAVES, strict=True)
    ]
    law = tooth_contact(GearPairGeometry(*gears), PotentialEnergyStiffness(), 100.0)
    machine = slowly(with_friction(0.0, sense=sense))
    (contact,) = machine.system.contacts
    return replace(machine, system=replace(machine.system, contacts=(replace(contact, contact=law),)))


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("order", [13 / 12, 2 / 3])
def test_pitch_errors_are_what_teeth_that_differ_have_beyond_teeth_that_are_alike(sense: int, order: float) -> None:
    """Teeth that are alike have no line between the mesh harmonics."""
    every = equilibria(with_waves(1.0, sense), round(order * HUNTING), HUNTING)
    motions = predicted(with_waves(1.0, sense), order)
    assert off(motions["pitch_errors"], every) < 0.03


@pytest.mark.parametrize("sense", [1, -1])
def test_small_pitch_errors_leave_the_mesh_harmonics(sense: int) -> None:
    """To the first order their mean over the hunting period is zero at each phase of the mesh."""
    motions = predicted(with_waves(1.0, sense), 1)
    small = np.linalg.norm(motions.get("pitch_errors", 0.0))
    assert small < 1e-6 * np.linalg.norm(motions["transmission_error"])


def test_a_line_that_does_not_resolve_the_hunting_period_has_all_its_pitch_errors() -> None:
    """Each harmonic of the hunting period within reach, those of a mesh harmonic among them, moves as it does alone."""
    waved = with_waves(1.0, 1)
    spacing = 2.0 * np.pi * abs(waved.system.contacts[0].mesh_frequency) / HUNTING
    groups = LineMechanisms(waved).motions(HUNTING * spacing, 1.2 * spacing)
    errors = {round(at / spacing): motions["pitch_errors"] for at, motions in groups if "pitch_errors" in motions}
    assert set(errors) == {HUNTING - 1, HUNTING, HUNTING + 1}
    for cycles, motion in errors.items():
        alone = predicted(waved, cycles / HUNTING)["pitch_errors"]
        assert np.linalg.norm(alone) > 0.0
        assert off(motion, alone) < 1e-9


def test_a_line_adds_its_parts_with_their_phases_and_unresolved_ones_by_their_squares() -> None:
    parts = LineParts.of([{"transmission_error": 3.0, "load_shuttling": -1.0 + 2.0j}, {"unbalance": 2.0j}])
    assert parts.together == pytest.approx(np.sqrt(abs(2.0 + 2.0j) ** 2 + 4.0))
    assert list(parts.amplitudes) == ["transmission_error", "load_shuttling", "unbalance"]
    assert parts.amplitudes["load_shuttling"] == pytest.approx(np.sqrt(5.0))
    assert parts.shares == pytest.approx(
        {"transmission_error": 0.5, "load_shuttling": 1.0 / 6.0, "unbalance": 1.0 / 3.0}
    )
