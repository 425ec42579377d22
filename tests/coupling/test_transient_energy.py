"""Newmark's march: the energy it keeps, the order it has, and the settings that betray it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from gearwhine.coupling import (
    CoupledSystem,
    TransientError,
    TransientOutputs,
    TransientSettings,
    simulate,
    static_equilibrium,
)
from gearwhine.coupling.gears import (
    Gear,
    GearPairGeometry,
    PotentialEnergyStiffness,
    TipRelief,
    ToothContact,
    tooth_contact,
)
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.machine.speed_profile import SpeedProfile
from gearwhine.coupling.time.transient import EnergyBalance, TransientResult
from gearwhine.numerics.arrays import FloatArray

SIZE = 4
STEPS = 100_000
IN_A_STRETCH = 64  # steps between two cuts of an uneventful time span, so that samples can fall on steps


def spring(value: float) -> ToothContact:
    return ToothContact(1.0, piecewise.constant(value, 1.0), piecewise.constant(0.0, 1.0))


def square(value: float, ratio: float) -> ToothContact:
    return ToothContact(ratio, piecewise.constant(value, ratio), piecewise.constant(0.0, ratio))


def component(stiffness: FloatArray, damping: FloatArray | None = None) -> Component:
    zeros = np.zeros_like(stiffness)
    return Component("body", ("rotor",) * len(stiffness), stiffness, zeros if damping is None else damping, zeros)


def drawn_stiffness(seed: int = 7) -> FloatArray:
    matrix = np.random.default_rng(seed).normal(size=(SIZE, SIZE))
    return np.asarray(matrix @ matrix.T + 0.3 * np.eye(SIZE))


DIRECTION = np.array([0.6, -0.3, 0.5, 0.2])


def contact_system(contact: ToothContact, rate: float, load: float = 3.0) -> CoupledSystem:
    """Four coordinates on a contact, the load pressing it."""
    tooth = ContactConnector("contact", DIRECTION, contact, 0.0, rate, np.empty((0, 3)))
    return CoupledSystem((component(drawn_stiffness()),), (0.0,), contacts=(tooth,), load=load * DIRECTION)


def everything(size: int = SIZE) -> TransientOutputs:
    return TransientOutputs(np.eye(size), np.eye(size), np.eye(size))


def aligned(step: float, count: int, beta: float = 0.25, gamma: float = 0.5) -> TransientSettings:
    """Equal steps, none refined, a sample every 64th."""
    interval = IN_A_STRETCH * step
    return TransientSettings(
        interval * (count // IN_A_STRETCH), 0.0, interval, step * (1.0 + 1e-9), tolerance=1.0, beta=beta, gamma=gamma
    )


def held_energy(system: CoupledSystem, result: TransientResult) -> FloatArray:
    """Of motion, springs and contact, less the potential of the load, about the equilibrium [J]."""
    q = result.displacement - static_equilibrium(system)
    strain = 0.5 * np.einsum("si,ij,sj->s", q, system.mean_stiffness, q)
    return np.asarray(0.5 * (result.velocity**2).sum(axis=1) + strain)


def struck(system: CoupledSystem, settings: TransientSettings, speed: float = 0.3) -> TransientResult:
    velocity = speed * np.array([1.0, -0.5, 0.25, 0.8])
    return simulate(system, settings, everything(system.size), initial=(static_equilibrium(system), velocity))


# Steps whose size has more digits than a round number: the matrices of the step must be those of this size.
@pytest.mark.parametrize("step", [0.02, 0.0123456789012345, 0.2 / 3.0])
def test_energy_is_kept(step: float) -> None:
    system = contact_system(spring(2.0), 0.37)
    result = struck(system, aligned(step, STEPS))
    assert result.contact_loss[0] == 0.0
    assert STEPS - IN_A_STRETCH <= result.steps <= 1.001 * STEPS
    energy = held_energy(system, result)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-6)
    assert result.energy.error < 1e-6


def test_other_parameters_do_not_keep_it() -> None:
    """The check above can fail: γ > 1/2 damps, and β ≠ 1/4 makes the energy swing with the motion."""
    system = contact_system(spring(2.0), 0.37)
    damped = held_energy(system, struck(system, aligned(0.02, 5000, gamma=0.51)))
    assert damped[-1] < 0.99 * damped[0]
    for beta in (1.0 / 6.0, 0.3):
        swinging = held_energy(system, struck(system, aligned(0.05, 5000, beta=beta)))
        assert np.ptp(swinging) / swinging[0] > 1e-4


def test_numerical_damping_does_not_pass_the_balance() -> None:
    system = CoupledSystem((component(drawn_stiffness()),), (0.0,), load=np.zeros(SIZE))
    with pytest.raises(TransientError, match="energies do not balance"):
        struck(system, aligned(0.05, 5000, gamma=0.55))


@pytest.mark.parametrize("duration", [0.5, 10.0, 2.0 * np.pi, 20.0 * np.pi])
def test_free_vibration_balances(duration: float) -> None:
    """Nothing comes in and nothing goes out: the scale of the balance is the motion's own energy."""
    mass = CoupledSystem((component(np.eye(1)),), (0.0,), load=np.zeros(1))
    settings = TransientSettings(duration, 0.0, duration / 40.0, 0.05)
    result = simulate(mass, settings, everything(1), initial=(np.ones(1), np.zeros(1)))
    assert result.energy.error < 1e-9
    assert result.energy.scale == pytest.approx(0.5 * np.sin(min(duration, np.pi / 2.0)) ** 2, rel=1e-2)
    np.testing.assert_allclose(result.displacement[:, 0], np.cos(result.times), atol=1e-3 * duration)
    np.testing.assert_allclose(result.velocity[:, 0], -np.sin(result.times), atol=1e-3 * duration)
    np.testing.assert_allclose(result.acceleration[:, 0], -np.cos(result.times), atol=1e-3 * duration)


def test_work_of_a_harmonic_load_and_of_damping() -> None:
    """At resonance in the steady state the load feeds what the damper takes: π F X a cycle."""
    ratio, force, cycles = 0.05, 2.0, 40
    system = CoupledSystem(
        (component(np.eye(1), np.full((1, 1), 2.0 * ratio)),),
        (0.0,),
        load=np.zeros(1),
        harmonic_loads=(HarmonicLoad(1.0, np.array([force + 0.0j])),),
    )
    amplitude = force / (2.0 * ratio)
    # Steady from the start: F cos t drives X sin t.
    start = (np.zeros(1), np.full(1, amplitude))
    settings = TransientSettings(2.0 * np.pi * cycles, 0.0, 0.1, 0.02, tolerance=1e-4)
    result = simulate(system, settings, everything(1), initial=start)
    expected = np.pi * force * amplitude * cycles
    assert result.energy.loads == pytest.approx(expected, rel=1e-3)
    assert result.energy.lost == pytest.approx(expected, rel=1e-3)
    np.testing.assert_allclose(result.displacement[:, 0], amplitude * np.sin(result.times), atol=2e-3 * amplitude)


class ExactSquareMesh:
    """Motion with a square-wave mesh stiffness, from matrix exponentials over its constant stretches."""

    def __init__(self, stiffness: float, ratio: float, rate: float, load: float, damping: float) -> None:
        self.contact = square(stiffness, ratio)
        self.damping = damping * drawn_stiffness()
        self.body = component(drawn_stiffness(), self.damping)
        tooth = ContactConnector("mesh", DIRECTION, self.contact, 0.0, rate, np.empty((0, 3)))
        self.load = load * DIRECTION
        self.system = CoupledSystem((self.body,), (0.0,), contacts=(tooth,), load=self.load)
        self.stretches = [(np.ceil(ratio), (ratio % 1.0) / rate), (np.floor(ratio), (1.0 - ratio % 1.0) / rate)]
        self.pair = stiffness * np.outer(DIRECTION, DIRECTION)
        self.teeth = 0.0

    def after(self, periods: int, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
        """State at the end of whole mesh periods; adds up the work of the teeth that come and go."""
        transitions = []
        for pairs, length in self.stretches:
            matrix = np.zeros((2 * SIZE + 1, 2 * SIZE + 1))
            matrix[:SIZE, SIZE:-1] = np.eye(SIZE)
            matrix[SIZE:-1, :SIZE] = -(self.body.stiffness + pairs * self.pair)
            matrix[SIZE:-1, SIZE:-1] = -self.damping
            matrix[SIZE:-1, -1] = self.load
            transitions.append(expm(matrix * length))
        state = np.concatenate([q, v, [1.0]])
        for period in range(periods):
            for which, transition in enumerate(transitions):
                if period or which:
                    jump = self.stretches[which][0] - self.stretches[which - 1][0]
                    self.teeth += 0.5 * jump * state[:SIZE] @ self.pair @ state[:SIZE]
                state = transition @ state
        return state[:SIZE], state[SIZE:-1]


def test_second_order_with_events_on_the_steps() -> None:
    rate, periods = 0.7, 12
    exact = ExactSquareMesh(stiffness=2.0, ratio=1.6, rate=rate, load=6.0, damping=0.002)
    start = (static_equilibrium(exact.system), 0.05 * np.array([1.0, -0.5, 0.25, 0.8]))
    q, v = exact.after(periods, *start)
    errors, teeth = [], []
    for halvings in range(3):
        # 24 and 16 steps in the two stretches, then twice and four times as many; half a period more lets the
        # sample at the end of the last one be taken.
        step = 1.0 / rate / 40.0 / 2.0**halvings * (1.0 + 1e-9)
        settings = TransientSettings((periods + 0.5) / rate, periods / rate, 0.4 / rate, step, tolerance=1.0)
        result = simulate(exact.system, settings, everything(), initial=start)
        assert result.contact_loss[0] == 0.0
        off = np.concatenate([result.displacement[0] - q, result.velocity[0] - v])
        errors.append(np.linalg.norm(off))
        shorter = TransientSettings(periods / rate, 0.0, 1.0, step, tolerance=1.0)
        balance = simulate(exact.system, shorter, everything(), initial=start).energy
        teeth.append(abs(balance.teeth - exact.teeth) / abs(exact.teeth))
    ratios = np.array(errors[:-1]) / np.array(errors[1:])
    np.testing.assert_allclose(ratios, 4.0, rtol=0.05)
    assert errors[-1] < 1e-2 * np.linalg.norm(np.concatenate([q - start[0], v]))
    assert teeth[-1] < 1e-3
    assert teeth[0] / teeth[-1] == pytest.approx(16.0, rel=0.3)


def test_refinement_reaches_the_tolerance() -> None:
    exact = ExactSquareMesh(stiffness=2.0, ratio=1.6, rate=0.7, load=6.0, damping=0.002)
    start = (static_equilibrium(exact.system), 0.05 * np.array([1.0, -0.5, 0.25, 0.8]))
    q, _ = exact.after(12, *start)
    errors = []
    for tolerance in (1e-3, 1e-4, 1e-5):
        settings = TransientSettings(12.5 / 0.7, 12.0 / 0.7, 0.5, 1.0, tolerance=tolerance)
        result = simulate(exact.system, settings, everything(), initial=start)
        assert result.error <= tolerance
        errors.append(float(np.abs(result.displacement[0] - q).max() / np.abs(q - start[0]).max()))
    # A phase error of 1e-3 a radian, over up to 40 rad of the fastest mode.
    assert errors[0] < 5e-2
    assert errors[2] < errors[1] < errors[0]
    assert errors[2] < 5e-4


@pytest.fixture(scope="module")
def helical_mesh() -> CoupledSystem:
    """A mass on helical teeth under an uneven load: slice after slice meets the corners of the profiles."""
    relief, helix = TipRelief(12e-6, length=2e-3), float(np.radians(15.0))
    pinion = Gear("pinion", 21, 2e-3, np.radians(20.0), 28e-3, helix_angle=helix, tip_relief=relief)
    pair = GearPairGeometry(pinion, replace(pinion, name="wheel", teeth=49, helix_angle=-helix))
    faces = face_slices(pair, misalignment=1e-4)
    contact = tooth_contact(pair, PotentialEnergyStiffness(), 60.0, corner_contact=True, faces=faces)
    tooth = ContactConnector("mesh", np.ones(1), contact, 0.0, 1015.0, np.empty((0, 3)))
    return CoupledSystem((component(np.ones((1, 1))),), (0.0,), contacts=(tooth,), load=np.array([1200.0]))


@pytest.mark.parametrize("end", [1.0, 1.003, 1.03])
def test_a_slow_ramp_on_helical_teeth_balances_the_better_the_finer_the_steps(
    helical_mesh: CoupledSystem, end: float
) -> None:
    turning = SpeedProfile(np.array([0.0, 0.3]), np.array([1.0, end]))
    coarse, fine = (
        simulate(
            helical_mesh,
            TransientSettings(0.3, 0.0, 1e-4, 1e-4, tolerance=tolerance),
            everything(1),
            speed_profile=turning,
        )
        for tolerance in (2e-3, 1e-4)
    )
    assert coarse.contact_loss[0] == 0.0
    assert coarse.energy.error < 5e-3
    # Newmark's method is of the second order.
    expected = coarse.energy.error * (coarse.steps / fine.steps) ** 2
    assert fine.energy.error == pytest.approx(expected, rel=0.3)


@pytest.mark.parametrize("wrong", ["change", "loads", "lost", "teeth", "scale"])
def test_a_balance_with_a_part_that_is_no_number_does_not_close(wrong: str) -> None:
    balance = EnergyBalance(change=1.0, loads=3.0, lost=2.0, teeth=0.0, scale=3.0)
    assert balance.error == 0.0
    assert replace(balance, **{wrong: float("nan")}).error == float("inf")
