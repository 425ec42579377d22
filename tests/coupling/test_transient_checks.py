"""What the march promises around the motion: its grid, its repeatability, its figures, and its refusals."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from gearwhine.coupling import (
    CoupledSystem,
    CouplingError,
    TransientError,
    TransientOutputs,
    TransientSettings,
    coupled_modes,
    simulate,
    static_equilibrium,
)
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector, LinearConnector
from gearwhine.coupling.machine.coupled_system import HarmonicLoad, TimedLoad
from gearwhine.coupling.time.integration import Checkpoint
from gearwhine.coupling.time.transient import TransientResult, integrate_blocks
from gearwhine.numerics.arrays import FloatArray


def pair_contact(ratio: float, damping: float = 0.0) -> ToothContact:
    return ToothContact(ratio, piecewise.quadratic(0.8, 1.2, 0.8, ratio), piecewise.constant(0.0, ratio), damping)


def two_masses(
    contact: ToothContact,
    rate: float,
    *,
    load: float = 1.0,
    phase: float = 0.0,
    clearance: float = 0.0,
    ground: float = 0.2,
    errors: tuple[tuple[float, float, float], ...] = (),
) -> CoupledSystem:
    """Two unit masses pressed together by their loads, the first on a spring to ground."""
    zeros = np.zeros((2, 2))
    body = Component("masses", ("torsion", "torsion"), np.diag([ground, 0.1]), 0.02 * np.eye(2), zeros)
    harmonics = np.array(errors).reshape(-1, 3)
    tooth = ContactConnector("contact", np.array([1.0, -1.0]), contact, phase, rate, harmonics, clearance)
    return CoupledSystem((body,), (0.0,), contacts=(tooth,), load=load * np.array([1.0, -1.0]))


def all_rows(system: CoupledSystem) -> TransientOutputs:
    rows = np.eye(system.size)
    return TransientOutputs(rows, rows, rows)


SETTINGS = TransientSettings(duration=60.0, record_from=20.0, sample_interval=0.1, largest_step=0.1, tolerance=1e-4)


def arrays(result: TransientResult) -> dict[str, Any]:
    names = ("times", "displacement", "velocity", "acceleration", "compression", "force", "mean_force", "peak_force")
    return {name: getattr(result, name) for name in (*names, "contact_loss")}


def test_bit_for_bit() -> None:
    system = two_masses(pair_contact(1.6, damping=0.05), 0.45, errors=((0.2, 0.3, 0.1),))
    one, two = (simulate(system, SETTINGS, all_rows(system)) for _ in range(2))
    for name, values in arrays(one).items():
        np.testing.assert_array_equal(values, arrays(two)[name], err_msg=name)
    assert one.energy == two.energy
    assert (one.steps, one.rejected, one.error) == (two.steps, two.rejected, two.error)


def test_does_not_touch_its_arguments() -> None:
    system = two_masses(pair_contact(1.6), 0.45)
    start = (np.array([0.3, -0.2]), np.array([0.1, 0.4]))
    kept = [array.copy() for array in start]
    simulate(system, SETTINGS, all_rows(system), initial=start)
    np.testing.assert_array_equal(start, kept)


def test_grid() -> None:
    system = two_masses(pair_contact(1.6), 0.45)
    for duration, interval, count in ((60.0, 0.1, 400), (60.0, 7.0, 6), (60.0, 40.0, 1), (60.0, 41.0, 1)):
        settings = replace(SETTINGS, duration=duration, sample_interval=interval)
        result = simulate(system, settings, all_rows(system))
        assert result.times.shape == (count,)
        np.testing.assert_allclose(result.times, 20.0 + interval * np.arange(count), rtol=1e-14)
        for name in ("displacement", "velocity", "acceleration"):
            assert getattr(result, name).shape == (count, 2)
        assert result.force.shape == result.compression.shape == (count, 1)
        assert result.mean_force.shape == result.peak_force.shape == result.contact_loss.shape == (1,)


def test_samples_do_not_depend_on_where_they_start() -> None:
    """The rows of a later record are those of an earlier one, to the tolerance of the steps."""
    system = two_masses(pair_contact(1.6), 0.45)
    late = simulate(system, SETTINGS, all_rows(system))
    early = simulate(system, replace(SETTINGS, record_from=0.0), all_rows(system))
    np.testing.assert_allclose(early.times[200:], late.times, rtol=1e-12)
    np.testing.assert_allclose(early.displacement[200:], late.displacement, atol=2e-3 * np.abs(late.displacement).max())
    np.testing.assert_allclose(early.velocity[200:], late.velocity, atol=2e-2 * np.abs(late.velocity).max())


def test_samples_fit_each_other() -> None:
    """Force and compression belong to the displacement; velocity is its derivative; Newton's law holds."""
    contact = ToothContact(1.0, piecewise.constant(1.5, 1.0), piecewise.constant(0.0, 1.0))
    system = two_masses(contact, 0.0, errors=((0.3, 0.9, 0.2),))
    settings = replace(SETTINGS, sample_interval=0.01, tolerance=1e-5)
    result = simulate(system, settings, all_rows(system))
    error = 0.3 * np.cos(0.9 * result.times + 0.2)
    closing = result.displacement[:, 0] - result.displacement[:, 1] - error
    np.testing.assert_allclose(result.compression[:, 0], closing, atol=1e-12)
    np.testing.assert_allclose(result.force[:, 0], 1.5 * np.maximum(closing, 0.0), atol=1e-12)
    slope = np.gradient(result.displacement, 0.01, axis=0)
    np.testing.assert_allclose(slope[1:-1], result.velocity[1:-1], atol=1e-4)
    push = system.load - result.force * np.array([1.0, -1.0])
    inertia = push - result.velocity @ system.damping.T - result.displacement @ system.stiffness.T
    np.testing.assert_allclose(result.acceleration, inertia, atol=1e-3)


def test_starts_at_rest_in_equilibrium() -> None:
    """Nothing moves where nothing changes."""
    contact = ToothContact(1.0, piecewise.constant(1.5, 1.0), piecewise.constant(0.0, 1.0))
    system = two_masses(contact, 0.45)
    result = simulate(system, SETTINGS, all_rows(system))
    # k q + F = load with δ = F / 1.5: solved by hand for the two springs 0.2 and 0.1 to ground.
    force = 1.0 / (1.0 + 1.0 / (1.5 * (1.0 / 0.2 + 1.0 / 0.1)))
    np.testing.assert_allclose(static_equilibrium(system), [(1.0 - force) / 0.2, -(1.0 - force) / 0.1], rtol=1e-10)
    np.testing.assert_allclose(result.force, force, rtol=1e-10)
    np.testing.assert_allclose(result.velocity, 0.0, atol=1e-12)
    np.testing.assert_allclose(result.mean_force, force, rtol=1e-10)
    assert result.contact_loss[0] == 0.0


@pytest.mark.parametrize("rate", [0.1, 0.3, 0.7, 1.1, 1.3])
def test_mean_over_whole_mesh_periods(rate: float) -> None:
    """A record from an event on: its first stretch counts, whatever rounding makes of the two times.

    Whole-mesh stiffness and load alike all along, so that the force stands still.
    """
    ratio = 2.0
    # Two pairs, each of a stiffness that the other's makes up to 2, with an event at every period's start.
    contact = ToothContact(
        ratio,
        piecewise.polyline(np.array([0.0, 1.0, 2.0]), np.array([0.8, 1.0, 1.2])),
        piecewise.constant(0.0, ratio),
    )
    assert contact.event_phases == (0.0,)
    rigid = two_masses(contact, rate)
    for periods in (3, 7, 11, 13, 17, 29):
        for start in (periods / rate, periods * (1.0 / rate)):
            settings = TransientSettings(start + 5.0 / rate, start, 0.004, 0.02, tolerance=1.0)
            result = simulate(rigid, settings, all_rows(rigid))
            # The sum of the two pairs rises from 1.8 to 2.2 within a period: the force follows a little.
            assert result.mean_force[0] == pytest.approx(result.force.mean(), rel=2e-3)
            assert result.peak_force[0] >= result.force.max() * (1.0 - 1e-3)


def test_flanks_driven_apart() -> None:
    """A mass that leaves at once never touches again; one held off by the gap never touches at all."""
    contact = pair_contact(1.6)
    apart = two_masses(contact, 0.45, load=0.0, clearance=0.5)
    result = simulate(apart, SETTINGS, all_rows(apart), initial=(np.array([-1.0, 1.0]), np.array([-0.1, 0.1])))
    assert result.contact_loss[0] < 1.0
    held = two_masses(contact, 0.45, load=-1.0)
    result = simulate(held, SETTINGS, all_rows(held))
    assert result.contact_loss[0] == pytest.approx(1.0, rel=1e-12)
    np.testing.assert_array_equal(result.force, 0.0)
    np.testing.assert_array_equal([result.mean_force, result.peak_force], 0.0)
    assert np.all(result.compression < 0.0)


def test_contact_lost_for_a_known_part_of_the_time() -> None:
    """A profile error a cos(wt), slow beside a critically damped mass, whose few bounces are short."""
    spring, damping, w, amplitude = 25.0, 10.0, 0.05, 2.0
    body = Component("mass", ("torsion",), np.full((1, 1), spring), np.full((1, 1), damping), np.zeros((1, 1)))
    contact = ToothContact(1.0, piecewise.constant(1e4, 1.0), piecewise.constant(0.0, 1.0))
    tooth = ContactConnector("contact", np.ones(1), contact, 0.0, 0.0, np.array([[amplitude, w, 0.0]]))
    system = CoupledSystem((body,), (0.0,), contacts=(tooth,), load=np.array([spring]))

    def force(angle: float) -> float:
        """What the contact carries while the mass follows the error: load - k x - c x' - x''."""
        x, rate = amplitude * np.cos(angle), -amplitude * w * np.sin(angle)
        return float(spring * (1.0 - x) - damping * rate + w**2 * x)

    # It leaves where that force is spent, comes to rest at x = 1, and is met there again.
    leaves, met = brentq(force, np.pi, 2.0 * np.pi), 2.0 * np.pi + np.arccos(1.0 / amplitude)
    period = 2.0 * np.pi / w
    settings = TransientSettings(3.0 * period, period, period / 500.0, 0.5, tolerance=1e-3)
    result = simulate(system, settings, all_rows(system))
    assert result.contact_loss[0] == pytest.approx((met - leaves) / (2.0 * np.pi), abs=3e-3)
    assert result.peak_force[0] == pytest.approx(force(np.pi), rel=1e-2)


@pytest.mark.parametrize("contact_damping", [0.04, 0.1, 0.6])
def test_impacts_on_a_damped_contact(contact_damping: float) -> None:
    """Damping that fades in keeps the force continuous; against an adaptive solver with very small steps."""
    damping, amplitude, w, depth = 0.05, 2.0, 0.8, 0.1
    body = Component("mass", ("torsion",), np.zeros((1, 1)), np.full((1, 1), damping), np.zeros((1, 1)))
    law = ToothContact(1.0, piecewise.constant(1.0, 1.0), piecewise.constant(0.0, 1.0))
    contact = law.with_damping(contact_damping, depth)
    tooth = ContactConnector("contact", np.ones(1), contact, 0.0, 0.0, np.array([[amplitude, w, 0.0]]))
    system = CoupledSystem((body,), (0.0,), contacts=(tooth,), load=np.ones(1))

    def motion(time: float, state: FloatArray) -> list[float]:
        closing = state[0] - amplitude * np.cos(w * time)
        rate = state[1] + amplitude * w * np.sin(w * time)
        faded = contact_damping * min(1.0, max(closing, 0.0) / depth)
        return [state[1], 1.0 - damping * state[1] - max(max(closing, 0.0) + faded * rate, 0.0)]

    start = (np.full(1, 3.0), np.zeros(1))
    times = 0.1 * np.arange(400)
    exact = solve_ivp(motion, (0.0, 40.0), [3.0, 0.0], t_eval=times, rtol=1e-9, atol=1e-9, max_step=0.01).y[0]
    result = simulate(system, TransientSettings(40.0, 0.0, 0.1, 0.5, tolerance=1e-4), all_rows(system), initial=start)
    assert 0.1 < result.contact_loss[0] < 0.8
    assert result.steps < 200_000
    np.testing.assert_allclose(result.displacement[:, 0], exact, rtol=0.0, atol=2e-3 * np.abs(exact).max())
    assert result.energy.error < 1e-4


def test_load_that_nothing_resists() -> None:
    contact = pair_contact(1.6)
    system = two_masses(contact, 0.45, ground=0.0)
    floating = replace(system, components=(replace(system.components[0], stiffness=np.zeros((2, 2))),))
    with pytest.raises(CouplingError, match="do not balance"):
        simulate(replace(floating, load=np.array([1.0, -0.9])), SETTINGS, all_rows(floating))
    result = simulate(floating, SETTINGS, all_rows(floating))
    # The masses press each other and go nowhere together.
    np.testing.assert_allclose(result.displacement.sum(axis=1), 0.0, atol=1e-9)


def test_absurd_tolerance() -> None:
    system = two_masses(pair_contact(1.6), 0.45)
    with pytest.raises(TransientError, match=r"asks for steps below .* raise the tolerance"):
        simulate(system, replace(SETTINGS, tolerance=1e-14), all_rows(system))


def test_divergence() -> None:
    zeros = np.zeros((1, 1))
    body = Component("mass", ("torsion",), np.ones((1, 1)), np.full((1, 1), -0.8), zeros)
    pushed = CoupledSystem((body,), (0.0,), load=np.ones(1), harmonic_loads=(HarmonicLoad(1.1, np.ones(1, complex)),))
    assert coupled_modes(pushed).damping_ratios[0] == pytest.approx(-0.4, rel=1e-12)
    settings = TransientSettings(4000.0, 0.0, 1000.0, 0.1, tolerance=1e-2)
    with pytest.raises(TransientError, match=r"diverged after t = .* negative damping ratios"):
        simulate(pushed, settings, all_rows(pushed))


@pytest.mark.parametrize(
    "wrong",
    [
        {"record_from": 60.0},
        {"record_from": -1.0},
        {"duration": math.inf},
        {"duration": math.nan},
        {"sample_interval": 0.0},
        {"largest_step": -1.0},
        {"largest_step": math.nan},
        {"tolerance": 0.0},
        {"tolerance": math.inf},
        {"beta": 0.0},
    ],
)
def test_settings_that_make_no_sense(wrong: dict[str, float]) -> None:
    with pytest.raises(CouplingError, match="expected"):
        replace(SETTINGS, **wrong)


def test_parts_that_do_not_fit() -> None:
    system = two_masses(pair_contact(1.6), 0.45)
    with pytest.raises(CouplingError, match="2 speeds for 1 components"):
        replace(system, speeds=(0.0, 0.0))
    with pytest.raises(CouplingError, match="a load of shape"):
        replace(system, load=np.zeros(3))
    with pytest.raises(CouplingError, match=r"damping of shape \(1, 1\); expected \(2, 2\)"):
        LinearConnector("bearing", np.eye(2), np.eye(2), np.eye(1))


def test_progress_ends_at_one() -> None:
    system = two_masses(pair_contact(1.6), 0.45)
    seen: list[float] = []
    simulate(system, SETTINGS, all_rows(system), progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(1.0)


def test_event_times() -> None:
    """Pairs enter at whole phases and leave at the contact ratio's fraction; relief's corners count too."""
    gap = piecewise.polyline(np.array([0.0, 0.25, 1.35, 1.6]), np.array([0.1, 0.0, 0.0, 0.1]))
    contact = ToothContact(1.6, piecewise.constant(1.0, 1.6), gap)
    marks = np.array([0.0, 0.6, 0.25, 0.35])
    for phase, rate in ((0.0, 2.0), (0.3, 2.0), (0.3, -2.0)):
        tooth = ContactConnector("contact", np.ones(1), contact, phase, rate, np.empty((0, 3)))
        times = tooth.event_times(0.05, 2.05)
        # A span of four mesh periods meets every mark four times; none of them is at its ends.
        assert times.size == 16
        assert np.all(np.diff(times) > 0.0)
        fractions = (phase + rate * times) % 1.0
        distance = np.abs((fractions[:, None] - marks + 0.5) % 1.0 - 0.5).min(axis=1)
        assert distance.max() < 1e-9
    assert ContactConnector("still", np.ones(1), contact, 0.0, 0.0, np.empty((0, 3))).event_times(0.0, 9.0).size == 0


@pytest.mark.parametrize("faster", [1.0, 1000.0])
def test_teeth_that_part_for_good_are_named(faster: float) -> None:
    """The load turns round after 10 s: nothing presses the masses together any more, and no spring holds them.

    On stiffer teeth of a quicker machine the same happens in less time: it is mesh periods that count.
    """
    zeros = np.zeros((2, 2))
    body = Component("masses", ("torsion", "torsion"), zeros, zeros, zeros)
    apart = np.array([1.0, -1.0])
    stiffness = piecewise.quadratic(0.8 * faster**2, 1.2 * faster**2, 0.8 * faster**2, 1.6)
    teeth = ToothContact(1.6, stiffness, piecewise.constant(0.0, 1.6), 0.0)
    tooth = ContactConnector("pinion -> wheel", apart, teeth, 0.0, 0.45 * faster, np.empty((0, 3)))
    turning_round = TimedLoad(np.array([10.0, 11.0]) / faster, np.array([0.0, -2.0]), apart)
    system = CoupledSystem((body,), (0.0,), contacts=(tooth,), load=apart, timed_loads=(turning_round,))
    settings = TransientSettings(
        duration=1000.0 / faster, record_from=0.0, sample_interval=1.0 / faster, largest_step=0.1 / faster
    )
    with pytest.raises(TransientError, match=r"pinion -> wheel came apart at t = \S+ s and did not meet again") as told:
        simulate(system, settings, all_rows(system))
    moment = float(str(told.value).partition("t = ")[2].partition(" s")[0])
    assert 10.0 < faster * moment < 12.0


def test_blocks_make_the_run() -> None:
    """Handed over block by block, or gone on with from a checkpoint kept as arrays, a run is the same bit for bit."""
    system = two_masses(pair_contact(1.6, damping=0.05), 0.45, errors=((0.2, 0.3, 0.1),))
    settings = replace(SETTINGS, duration=3000.0, sample_interval=0.02)
    whole = simulate(system, settings, all_rows(system))
    blocks = list(integrate_blocks(system, settings, all_rows(system)))
    assert len(blocks) > 3
    np.testing.assert_array_equal(np.concatenate([block.displacement for block in blocks]), whole.displacement)
    assert [block.first for block in blocks] == np.cumsum([0, *(len(block.force) for block in blocks)])[:-1].tolist()
    kept = {name: np.array(value) for name, value in blocks[1].after.as_arrays().items()}
    later = list(integrate_blocks(system, settings, all_rows(system), after=Checkpoint.from_arrays(kept)))
    assert len(later) == len(blocks) - 2
    for one, other in zip(later, blocks[2:], strict=True):
        for name in ("first", "displacement", "velocity", "acceleration", "compression", "force"):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    last, same = (run[-1].after.as_arrays() for run in (blocks, later))
    for name in last.keys() - {"seconds"}:
        np.testing.assert_array_equal(last[name], same[name], err_msg=name)
