"""The exact march: against matrix exponentials, another integrator, and Newmark's method with tiny steps."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from gearwhine.coupling import (
    CoupledSystem,
    CouplingError,
    SpeedProfile,
    TransientError,
    TransientOutputs,
    TransientSettings,
    simulate,
    static_equilibrium,
)
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.coupling.machine.coupled_system import HarmonicLoad, TimedLoad
from gearwhine.coupling.time.exponential_collocation import integration_method
from gearwhine.coupling.time.transient import TransientResult, integrate_blocks
from gearwhine.numerics.arrays import FloatArray

SIZE = 4
DIRECTION = np.array([0.6, -0.3, 0.5, 0.2])
OTHER = np.array([-0.2, 0.5, 0.4, 0.3])


def square(value: float, ratio: float, damping: float = 0.0) -> ToothContact:
    return ToothContact(ratio, piecewise.constant(value, ratio), piecewise.constant(0.0, ratio), damping=damping)


def arched(ratio: float = 1.6, damping: float = 0.02) -> ToothContact:
    return ToothContact(ratio, piecewise.quadratic(0.8, 1.2, 0.8, ratio), piecewise.constant(0.0, ratio), damping)


def tooth(
    contact: ToothContact, rate: float, direction: FloatArray = DIRECTION, errors: Sequence[Sequence[float]] = ()
) -> ContactConnector:
    return ContactConnector("teeth", direction, contact, 0.3, rate, np.array(errors, dtype=float).reshape(-1, 3))


def body(
    contacts: Sequence[ContactConnector], load: FloatArray, harmonic: Sequence[HarmonicLoad] = ()
) -> CoupledSystem:
    """Four coordinates with gyroscopic terms and damping that is not proportional to the stiffness."""
    rng = np.random.default_rng(5)
    root, loss = rng.normal(size=(2, SIZE, SIZE))
    skew = np.triu(np.ones((SIZE, SIZE)), 1)
    stiffness, damping = root @ root.T + 0.3 * np.eye(SIZE), 0.02 * loss @ loss.T + 0.01 * np.eye(SIZE)
    part = Component("body", ("rotor",) * SIZE, stiffness, damping, skew - skew.T)
    return CoupledSystem((part,), (0.4,), (), tuple(contacts), load, tuple(harmonic))


def one_mass(contact: ToothContact, rate: float, back: float | None = None, load: float = 1.0) -> CoupledSystem:
    """A mass that the teeth alone hold, between two flanks where there is a backlash."""
    mass = Component("mass", ("torsion",), np.zeros((1, 1)), np.full((1, 1), 0.06), np.zeros((1, 1)))
    drive = ContactConnector("teeth", np.ones(1), contact, 0.0, rate, np.empty((0, 3)))
    flanks = [drive]
    if back is not None:
        flanks.append(replace(drive, name="back", direction=-np.ones(1), clearance=back, loaded=False))
    force = HarmonicLoad(0.31, np.array([0.5 * load + 0.0j]))
    return CoupledSystem((mass,), (0.0,), contacts=tuple(flanks), load=np.array([load]), harmonic_loads=(force,))


def ends_after(duration: float, step: float = 1.0, tolerance: float = 1e-10) -> TransientSettings:
    """Two samples, at the start and the end of a duration."""
    return TransientSettings(duration * 1.001, 0.0, duration, step, tolerance, method="exact")


def everything(size: int) -> TransientOutputs:
    return TransientOutputs(np.eye(size), np.eye(size), np.eye(size))


def last_state(result: TransientResult) -> FloatArray:
    return np.concatenate([result.displacement[-1], result.velocity[-1]])


def exponentials(system: CoupledSystem, start: FloatArray, duration: float) -> FloatArray:
    """A system whose teeth stay closed and have constant stiffness between events: a product of matrix exponentials.

    Of the state, the load's 1, and cosine and sine of every harmonic load.
    """
    n, loads = system.size, system.harmonic_loads
    times = np.unique(np.concatenate([[0.0, duration], *(c.event_times(0.0, duration) for c in system.contacts)]))
    state = np.concatenate([start, [1.0], np.tile([1.0, 0.0], len(loads))])
    for begin, end in pairwise(times):
        stiffness, damping, load = system.stiffness.copy(), system.damping.copy(), system.load.copy()
        for contact in system.contacts:
            pairs = contact.contact.pairs(np.array([contact.phase + contact.mesh_frequency * 0.5 * (begin + end)]))
            k = pairs.stiffness[pairs.present].sum()
            stiffness += k * np.outer(contact.direction, contact.direction)
            damping += contact.contact.damping * np.outer(contact.direction, contact.direction)
        matrix = np.zeros((len(state), len(state)))
        matrix[:n, n : 2 * n] = np.eye(n)
        matrix[n : 2 * n, :n], matrix[n : 2 * n, n : 2 * n], matrix[n : 2 * n, 2 * n] = -stiffness, -damping, load
        for i, one in enumerate(loads):
            column = 2 * n + 1 + 2 * i
            matrix[n : 2 * n, column], matrix[n : 2 * n, column + 1] = one.amplitude.real, -one.amplitude.imag
            matrix[column, column + 1], matrix[column + 1, column] = -one.frequency, one.frequency
        state = expm(matrix * (end - begin)) @ state
    return np.asarray(state[: 2 * n])


SHAKEN = [HarmonicLoad(w, np.array([0.2, 0.1j, -0.1, 0.05 + 0.1j])) for w in (0.9, -2.3)]


@pytest.mark.parametrize("ratio", [1.35, 2.4])
@pytest.mark.parametrize("second", [None, 0.41 * np.sqrt(2.0)])
def test_rectangular_meshes_against_matrix_exponentials(ratio: float, second: float | None) -> None:
    """One mesh, whose stretches repeat, and two without a common period, whose stretches never do."""
    contacts = [tooth(square(0.4, ratio, 0.1), 0.41)]
    if second is not None:
        contacts.append(tooth(square(0.3, 1.7), second, OTHER))
    system = body(contacts, 20.0 * DIRECTION + 15.0 * OTHER, SHAKEN)
    start = np.concatenate([static_equilibrium(system), 0.02 * np.ones(SIZE)])
    result = simulate(system, ends_after(40.0), everything(SIZE), initial=(start[:SIZE], start[SIZE:]))
    assert result.contact_loss.max() == 0.0
    exact = exponentials(system, start, 40.0)
    np.testing.assert_allclose(last_state(result), exact, atol=1e-10 * np.abs(exact - start).max())


def test_linear_machine_needs_no_resolution() -> None:
    """Without teeth, elements of any length are exact: modes, loads, and what nothing resists."""
    part = body([], np.zeros(SIZE)).components[0]
    free = Component("free", ("torsion",), np.zeros((1, 1)), np.zeros((1, 1)), np.zeros((1, 1)))
    shaken = tuple(HarmonicLoad(one.frequency, np.append(one.amplitude, 0.3 - 0.2j)) for one in SHAKEN)
    load = np.array([1.0, -0.5, 0.3, 0.2, 0.01])
    system = CoupledSystem((part, free), (0.4, 0.0), (), (), load, shaken)
    start = np.arange(10.0) / 10.0
    result = simulate(system, ends_after(60.0, step=100.0), everything(5), initial=(start[:5], start[5:]))
    assert result.steps < 60
    exact = exponentials(system, start, 60.0)
    np.testing.assert_allclose(last_state(result), exact, atol=1e-11 * np.abs(exact).max())
    np.testing.assert_allclose(
        result.acceleration[-1], np.gradient(_velocities(system, start, 60.0, 1e-3), 1e-3, axis=0)[1], atol=1e-5
    )


def _velocities(system: CoupledSystem, start: FloatArray, time: float, step: float) -> FloatArray:
    return np.array([exponentials(system, start, time + k * step)[system.size :] for k in (-1, 0, 1)])


def test_falls_by_the_order_of_gauss() -> None:
    """While the teeth stay closed the state errs by h to the 2 s = 10."""
    whole = replace(tooth(arched(1.0), 0.25), phase=0.0)
    system = body([whole], 20.0 * DIRECTION)
    start = (static_equilibrium(system), 0.05 * np.ones(SIZE))
    states = []
    # Five places in an element: 4 and 8 elements a mesh period, and many.
    for step in (0.2, 0.1, 0.02):
        march = TransientSettings(20.02, 0.0, 20.0, step, 0.9, method="exact")
        result = simulate(system, march, everything(SIZE), initial=start)
        assert result.contact_loss[0] == 0.0
        states.append(last_state(result))
    errors = [np.linalg.norm(state - states[-1]) for state in states[:-1]]
    assert errors[0] > 1e-12
    assert np.log2(errors[0] / errors[1]) > 8.5


@pytest.mark.parametrize("back", [None, 0.5])
@pytest.mark.parametrize("damping", [0.0, 0.05])
def test_lost_contact_and_backlash_against_another_integrator(back: float | None, damping: float) -> None:
    """Runge and Kutta's eighth order, stopped at every change of contact, on the law as the sources write it."""
    rate, duration, swing = 0.13, 45.0, 0.31
    contact = ToothContact(1.0, piecewise.quadratic(0.7, 1.3, 0.7, 1.0), piecewise.constant(0.0, 1.0), damping)
    system = one_mass(contact, rate, back)
    start = (np.array([3.0]), np.zeros(1))
    result = simulate(system, ends_after(duration, step=0.2), everything(1), initial=start)
    assert 0.05 < result.contact_loss[0] < 1.0
    assert result.peak_force.min() > 0.0

    def rates(time: float, state: FloatArray) -> list[float]:
        x, v = state
        u = (rate * time) % 1.0
        k = 0.7 + 4.0 * 0.6 * u * (1.0 - u)
        force = max(0.0, k * x + damping * v) if x > 0.0 else 0.0
        gap = 0.0 if back is None else -x - back
        if gap > 0.0:
            force -= max(0.0, k * gap - damping * v)
        return [v, 1.0 + 0.5 * np.cos(swing * time) - 0.06 * v - force]

    end = solve_ivp(rates, (0.0, duration), [3.0, 0.0], "DOP853", rtol=1e-11, atol=1e-12, max_step=0.01).y[:, -1]
    np.testing.assert_allclose(last_state(result), end, atol=3e-7)


def two_masses(errors: Sequence[Sequence[float]] = ()) -> CoupledSystem:
    """Two masses on springs that the teeth press together, with a runout, a ripple, and a back flank."""
    zeros = np.zeros((2, 2))
    masses = Component("masses", ("torsion", "torsion"), np.diag([0.2, 0.1]), 0.02 * np.eye(2), zeros)
    direction = np.array([1.0, -1.0])
    drive = tooth(arched(damping=0.05), 0.45, direction, errors)
    back = replace(drive, name="back", direction=-direction, clearance=0.3, loaded=False)
    ripple = HarmonicLoad(0.7, np.array([0.3 + 0.1j, -0.2]))
    return CoupledSystem((masses,), (0.0,), (), (drive, back), 0.5 * direction, (ripple,))


RUNOUT = ((0.2, 0.3, 0.1), (0.1, 0.9, 1.0))
SETTINGS = TransientSettings(60.0, 20.0, 0.05, 0.1, tolerance=1e-8, method="exact")


def test_tells_what_newmark_tells() -> None:
    """Histories, forces, contact loss and every part of the energy balance, the steps of the other being tiny."""
    system = two_masses(RUNOUT)
    # Samples off the events, where accelerations jump.
    march = replace(SETTINGS, sample_interval=0.0507)
    exact = simulate(system, march, everything(2))
    steps = simulate(system, replace(march, method="newmark", tolerance=1.0, largest_step=1e-4), everything(2))
    assert exact.steps < steps.steps / 100
    assert 0.02 < exact.contact_loss[0] < 0.9
    for what in ("displacement", "velocity", "acceleration", "compression", "force"):
        found, expected = getattr(exact, what), getattr(steps, what)
        np.testing.assert_allclose(found, expected, atol=2e-5 * np.abs(expected).max(), err_msg=what)
    np.testing.assert_allclose(exact.mean_force, steps.mean_force, atol=1e-5)
    np.testing.assert_allclose(exact.contact_loss, steps.contact_loss, atol=1e-4)
    np.testing.assert_allclose(exact.peak_force, steps.peak_force, rtol=0.02)
    for what in ("change", "loads", "lost", "teeth"):
        scale = steps.energy.scale
        assert getattr(exact.energy, what) == pytest.approx(getattr(steps.energy, what), abs=2e-5 * scale), what
    assert exact.energy.error < 1e-5


def test_the_error_measure_is_the_error() -> None:
    """The state at the end is off by about the tolerance, and never by much more."""
    system = two_masses(RUNOUT)
    reference = simulate(system, replace(SETTINGS, tolerance=1e-11), everything(2)).displacement
    measured = []
    for tolerance in (1e-3, 1e-5, 1e-7):
        result = simulate(system, replace(SETTINGS, tolerance=tolerance, largest_step=1.0), everything(2))
        assert result.error <= tolerance
        measured.append(np.abs(result.displacement - reference).max() / np.abs(reference).max())
        assert measured[-1] < 20.0 * tolerance
    assert measured[2] < 1e-3 * measured[0] + 1e-9


@given(cut=st.integers(0, 2), phase=st.floats(0.0, 1.0), rate=st.floats(0.2, 0.9))
@settings(max_examples=5, deadline=None)
def test_goes_on_from_a_checkpoint_bit_for_bit(cut: int, phase: float, rate: float) -> None:
    system = two_masses(((0.2, 0.3, phase),))
    system = replace(system, contacts=tuple(replace(contact, mesh_frequency=rate) for contact in system.contacts))
    march = replace(SETTINGS, sample_interval=4e-4, tolerance=1e-6)
    rows = TransientOutputs(np.eye(2)[:1], np.eye(2)[:1], np.eye(2)[:1])
    whole = list(integrate_blocks(system, march, rows))
    assert len(whole) > 3
    rest = list(integrate_blocks(system, march, rows, after=whole[cut].after))
    assert len(rest) == len(whole) - cut - 1
    for one, other in zip(whole[cut + 1 :], rest, strict=True):
        for what in ("displacement", "velocity", "acceleration", "compression", "force"):
            np.testing.assert_array_equal(getattr(one, what), getattr(other, what), err_msg=what)
        ours, theirs = one.after.as_arrays(), other.after.as_arrays()
        for name in ours.keys() - {"seconds"}:
            np.testing.assert_array_equal(ours[name], theirs[name], err_msg=name)


def test_where_it_does_not_apply() -> None:
    """A reason is given, or Newmark's method marches, bit for bit as if it had been asked for."""
    system = two_masses()
    rows = everything(2)
    slowing = SpeedProfile(np.array([0.0, 60.0]), np.array([1.0, 0.5]))
    with pytest.raises(TransientError, match="the speed varies"):
        simulate(system, SETTINGS, rows, speed_profile=slowing)
    table = TimedLoad(np.array([0.0, 30.0]), np.array([0.0, 0.1]), np.array([1.0, 0.0]))
    loaded = replace(system, timed_loads=(table,))
    with pytest.raises(TransientError, match="table over time; use Newmark's"):
        simulate(loaded, SETTINGS, rows)
    dragged = Component("mass", ("torsion",), np.zeros((1, 1)), np.full((1, 1), 0.1), np.zeros((1, 1)))
    with pytest.raises(TransientError, match="no stiffness but meets damping"):
        simulate(CoupledSystem((dragged,), (0.0,), load=np.ones(1)), SETTINGS, everything(1))
    coarse = replace(SETTINGS, tolerance=1e-3)
    either = simulate(loaded, replace(coarse, method="auto"), rows)
    newmark = simulate(loaded, replace(coarse, method="newmark"), rows)
    np.testing.assert_array_equal(either.displacement, newmark.displacement)
    assert integration_method(loaded, replace(coarse, method="auto"), SpeedProfile.steady()) == "newmark"
    assert integration_method(system, replace(coarse, method="auto"), SpeedProfile.steady()) == "exact"
    assert integration_method(system, replace(coarse, method="newmark"), SpeedProfile.steady()) == "newmark"
    with pytest.raises(CouplingError, match="expected one of newmark, exact, auto"):
        replace(SETTINGS, method="fast")  # type: ignore[arg-type]


def test_teeth_that_fly_apart_for_good_are_named() -> None:
    system = replace(two_masses(), contacts=two_masses().contacts[:1], load=np.array([-4.0, 4.0]))
    masses = replace(system.components[0], stiffness=np.zeros((2, 2)), damping=np.zeros((2, 2)))
    thrown = replace(system, components=(masses,), harmonic_loads=())
    start = (np.array([0.1, -0.1]), np.zeros(2))
    with pytest.raises(TransientError, match=r"teeth came apart at t = .* did not meet again"):
        simulate(thrown, replace(SETTINGS, duration=4000.0), everything(2), initial=start)
