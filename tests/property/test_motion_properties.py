"""Laws of motion in time: an energy balance by hand, reciprocity, Newton's third law.

Each is written out anew from the record: nothing of the march's own accounting is used. The systems are bare matrices;
machines of rotors and gears are held to the same laws in ``test_machine_motion_properties.py``.
"""

from dataclasses import replace

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gearwhine.coupling import CoupledSystem, TransientOutputs, TransientSettings, simulate, static_equilibrium
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector, LinearConnector
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.time.transient import TransientResult
from gearwhine.numerics.arrays import FloatArray

patient = settings(deadline=None, max_examples=15)
seeds = st.integers(0, 2**32 - 1)


def passive(rng: np.random.Generator, name: str, size: int) -> Component:
    stiffness, damping, turn = rng.normal(size=(3, size, size))
    return Component(
        name,
        ("rotor",) * size,
        stiffness @ stiffness.T + 0.5 * np.eye(size),
        0.03 * damping @ damping.T,
        0.5 * (turn - turn.T),
    )


def law(rng: np.random.Generator, *, constant: bool) -> ToothContact:
    if constant:
        return ToothContact(1.0, piecewise.constant(3.0, 1.0), piecewise.constant(0.0, 1.0), 0.05)
    gap = piecewise.polyline(1.6 * np.array([0.0, 0.2, 0.8, 1.0]), rng.uniform(0.0, 0.3) * np.array([1, 0, 0, 1]))
    return ToothContact(1.6, piecewise.quadratic(0.8, rng.uniform(1.5, 4.0), 0.8, 1.6), gap, 0.05)


def system(seed: int, *, constant: bool = False) -> CoupledSystem:
    """Two turning components, a bearing between them, a contact that the load presses; all symmetric but what turns."""
    rng = np.random.default_rng(seed)
    parts = (passive(rng, "one", 3), passive(rng, "two", 2))
    root = rng.normal(size=(2, 2))
    bearing = LinearConnector("bearing", rng.normal(size=(5, 2)), root @ root.T, 0.05 * root @ root.T)
    direction = rng.normal(size=5) / np.sqrt(5.0)
    runout = np.array([[rng.uniform(0.0, 0.1), rng.uniform(0.1, 2.0), rng.uniform(0.0, 6.0)]])
    tooth = ContactConnector(
        "contact", direction, law(rng, constant=constant), 0.0, 0.17, np.empty((0, 3)) if constant else runout
    )
    return CoupledSystem(parts, tuple(rng.uniform(-2.0, 2.0, 2)), (bearing,), (tooth,), 4.0 * direction)


def everything(
    of: CoupledSystem,
    duration: float,
    interval: float,
    initial: tuple[FloatArray, FloatArray] | None = None,
    tolerance: float = 2e-5,
) -> TransientResult:
    rows = np.eye(of.size)
    chosen = TransientSettings(duration, 0.0, interval, 0.2, tolerance=tolerance)
    return simulate(of, chosen, TransientOutputs(rows, rows, rows), initial=initial)


@patient
@given(seeds, st.floats(0.3, 2.5), st.floats(-0.3, 0.3))
def test_power_written_out_by_hand(seed: int, frequency: float, skew: float) -> None:
    """Kinetic energy and springs' gain what the loads give, less what dampers, skew bearings and teeth take.

    The integral is the trapezoidal rule over the record, whose own error is that of its spacing: a jump of the tooth
    force within one interval, at most.
    """
    of = system(seed)
    (bearing,), (tooth,) = of.linear, of.contacts
    rng = np.random.default_rng(seed)
    bearing = replace(bearing, stiffness=bearing.stiffness + skew * np.array([[0.0, 1.0], [-1.0, 0.0]]))
    turning = HarmonicLoad(frequency, 0.2 * (rng.normal(size=5) + 1j * rng.normal(size=5)))
    result = everything(replace(of, linear=(bearing,), harmonic_loads=(turning,)), 30.0, 0.002)
    q, v, times = result.displacement, result.velocity, result.times
    symmetric = 0.5 * (bearing.stiffness + bearing.stiffness.T)
    stretch, rate = q @ bearing.directions, v @ bearing.directions
    held = 0.5 * np.sum(v**2, axis=1) + 0.5 * np.einsum("si,ij,sj->s", stretch, symmetric, stretch)
    lost = np.einsum("si,ij,sj->s", rate, bearing.damping, rate)
    lost += np.einsum("si,ij,sj->s", rate, bearing.stiffness - symmetric, stretch)
    for part, block in zip(of.components, (slice(0, 3), slice(3, 5)), strict=True):
        held += 0.5 * np.einsum("si,ij,sj->s", q[:, block], part.stiffness, q[:, block])
        lost += np.einsum("si,ij,sj->s", v[:, block], part.damping, v[:, block])
    push = of.load + (turning.amplitude * np.exp(1j * frequency * times[:, None])).real
    power = np.sum(v * push, axis=1) - lost - result.force[:, 0] * (v @ tooth.direction)
    gained = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(times))])
    scale = np.ptp(held) + np.ptp(gained)
    np.testing.assert_allclose(held - held[0], gained, atol=1e-3 * scale)


def pushed(of: CoupledSystem, load: FloatArray, seen: FloatArray) -> tuple[FloatArray, bool]:
    """Motion along ``seen`` after ``load`` has come on at once at rest, and whether the teeth stayed in contact."""
    rest = static_equilibrium(of)
    start = (rest, np.zeros(of.size))
    result = everything(replace(of, load=of.load + load), 15.0, 0.05, start)
    return np.asarray((result.displacement - rest) @ seen), result.contact_loss.max() == 0.0


@patient
@given(seeds, st.booleans())
def test_reciprocity_in_time(seed: int, turning: bool) -> None:
    """What a load here moves there, the same load there moves here, once the rotation is stopped or reversed.

    Through a mesh of constant stiffness that stays closed: teeth that come and go are not reciprocal.
    """
    of = system(seed, constant=True)
    here, there = 0.3 * np.random.default_rng(seed + 1).normal(size=(2, of.size))
    speeds = of.speeds if turning else (0.0, 0.0)
    one, closed = pushed(replace(of, speeds=speeds), here, there)
    other, also_closed = pushed(replace(of, speeds=tuple(-speed for speed in speeds)), there, here)
    assume(closed and also_closed)
    np.testing.assert_allclose(one, other, atol=1e-3 * np.abs(one).max())


def test_rotation_breaks_reciprocity() -> None:
    """The check above can fail: the same system, turning the same way in both runs."""
    of = replace(system(5, constant=True), speeds=(2.0, 1.5))
    here, there = 0.1 * np.random.default_rng(6).normal(size=(2, of.size))
    (one, closed), (other, also_closed) = pushed(of, here, there), pushed(of, there, here)
    assert closed
    assert also_closed
    assert np.abs(one - other).max() > 0.05 * np.abs(one).max()


@patient
@given(seeds)
def test_momentum_of_two_free_bodies(seed: int) -> None:
    """Two bodies in the plane that touch through teeth and a spring: only forces from outside change their momentum.

    Momenta are exact, whatever the step: Newmark's rule sums forces that cancel at every instant.
    """
    rng = np.random.default_rng(seed)
    mass, inertia = rng.uniform(0.5, 3.0, (2, 2))
    places, (at_teeth, at_spring) = rng.normal(size=(2, 2)), rng.normal(size=(2, 2))

    def between(point: FloatArray, along: FloatArray) -> FloatArray:
        """Approach of the two bodies' points along a unit vector, by x √m, y √m and θ √J of each."""
        rows = []
        for side, body in ((1.0, 0), (-1.0, 1)):
            x, y = point - places[body]
            moment = x * along[1] - y * along[0]
            rows += [side * along / np.sqrt(mass[body]), [side * moment / np.sqrt(inertia[body])]]
        return np.concatenate(rows)

    angle = rng.uniform(0.0, 2.0 * np.pi)
    line = between(at_teeth, np.array([np.cos(angle), np.sin(angle)]))
    root = rng.normal(size=(2, 2))
    spring = LinearConnector(
        "spring", np.array([between(at_spring, unit) for unit in np.eye(2)]).T, root @ root.T, 0.1 * root @ root.T
    )
    zeros = np.zeros((3, 3))
    bodies = tuple(Component(name, ("rotor",) * 3, zeros, zeros, zeros) for name in ("one", "two"))
    outside = 0.1 * rng.normal(size=6)
    tooth = ContactConnector("teeth", line, law(rng, constant=False), 0.0, 0.17, np.empty((0, 3)))
    free = CoupledSystem(bodies, (0.0, 0.0), (spring,), (tooth,), 2.0 * line + outside)
    start = (np.zeros(6), 0.3 * rng.normal(size=6))
    result = everything(free, 20.0, 0.05, start, tolerance=1e-3)
    assert result.peak_force[0] > 0.1
    # x, y, and about the origin: Σ m (X × v) + J ω.
    rows = np.zeros((3, 6))
    for body in range(2):
        root_of_mass, (x, y) = np.sqrt(mass[body]), places[body]
        rows[:2, 3 * body : 3 * body + 2] = root_of_mass * np.eye(2)
        rows[2, 3 * body : 3 * body + 3] = [-y * root_of_mass, x * root_of_mass, np.sqrt(inertia[body])]
    momenta = result.velocity @ rows.T
    expected = rows @ start[1] + result.times[:, None] * (rows @ outside)
    np.testing.assert_allclose(momenta, expected, atol=1e-8 * (1.0 + np.abs(result.velocity).max()))


@patient
@given(st.floats(1e-8, 1.0), st.floats(0.1, 100.0))
def test_a_free_body_falls(shaking: float, load: float) -> None:
    """x = F t²/2, however little shakes what stands beside it: a drift is no divergence."""
    stiffness = np.diag([0.0, 50.0])
    parts = (Component("both", ("rotor",) * 2, stiffness, 0.0 * stiffness, 0.0 * stiffness),)
    shaken = HarmonicLoad(3.0, np.array([0.0, shaking + 0.0j]))
    of = CoupledSystem(parts, (0.0,), (), (), np.array([load, 0.0]), (shaken,))
    result = everything(of, 20.0, 0.5, (np.zeros(2), np.zeros(2)), tolerance=1e-3)
    # Newmark's rule is exact under a constant force.
    np.testing.assert_allclose(result.displacement[:, 0], 0.5 * load * result.times**2, rtol=1e-9)
