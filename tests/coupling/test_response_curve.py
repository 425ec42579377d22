"""Branches of periodic motions over speed: folds, jumps, period doubling, and a linear machine's own curve."""

import gc
import weakref
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from gearwhine.coupling import CoupledSystem, CouplingError, TransientOutputs, TransientSettings, simulate
from gearwhine.coupling.analyses.steady_state import SolvedSteady
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.periodic import periodic_response, response_curve
from gearwhine.coupling.periodic.continuation import _Follower
from gearwhine.coupling.periodic.response import PeriodicResponse
from gearwhine.numerics.arrays import FloatArray
from gearwhine.output.quantity import RPM

ROW = np.ones((1, 1))


def waving(depth: float) -> ToothContact:
    stiffness = piecewise.tabulated(lambda s: 1.0 + depth * np.cos(2.0 * np.pi * s), 1.0, tolerance=1e-7)
    return ToothContact(1.0, stiffness, piecewise.constant(0.0, 1.0))


DEEP, SHALLOW = waving(0.3), waving(0.15)


def one_mass(speed: float, contact: ToothContact, damping: float) -> CoupledSystem:
    mass = Component("mass", ("torsion",), np.zeros((1, 1)), np.full((1, 1), 2.0 * damping), np.zeros((1, 1)))
    teeth = ContactConnector("teeth", np.ones(1), contact, 0.0, speed / (2.0 * np.pi), np.empty((0, 3)))
    return CoupledSystem((mass,), (0.0,), contacts=(teeth,), load=np.ones(1))


def deep(speed: float) -> CoupledSystem:
    return one_mass(speed, DEEP, 0.05)


@pytest.mark.slow
def test_the_branch_turns_at_two_folds() -> None:
    """Contact loss bends the resonance to lower speeds: three motions between the folds, the middle one unstable."""
    up = response_curve(deep, 0.6, 1.2, points=50)
    assert [event.kind for event in up.bifurcations] == ["fold", "fold"]
    high, low = up.folds
    assert low.speed < high.speed
    assert up.speeds[0] == 0.6
    assert up.speeds[-1] == pytest.approx(1.2, rel=1e-11)
    # A motion has one multiplier of 1 at its fold.
    for fold in up.folds:
        values = up.responses[fold.index].floquet.values
        assert np.abs(values - 1.0).min() < 1e-4
    assert up.stable[: high.index].all()
    assert not up.stable[high.index + 1 : low.index].any()
    assert up.stable[low.index + 1 :].all()
    three = up.at(0.78)
    assert [motion.stable for motion in three] == [True, False, True]
    swings = [float(motion.rms_compression[0]) for motion in three]
    assert swings == sorted(swings)
    assert len(up.at(0.9)) == 1
    # The other way round the same branch has the same folds.
    down = response_curve(deep, 1.2, 0.6, points=60)
    assert [fold.speed for fold in down.folds] == pytest.approx([low.speed, high.speed], abs=1e-7)
    with pytest.raises(CouplingError, match="was followed from"):
        up.at(2.0)


def test_a_machine_jumps_where_the_branch_turns() -> None:
    """The transient, let go on either side of the lower fold at the motion that turns there."""
    curve = response_curve(deep, 0.9, 0.6, points=50, most_points=200)
    fold = curve.folds[0]
    at_fold = curve.responses[fold.index]
    lost = []
    for part in (0.995, 1.005):
        period = 2.0 * np.pi / (part * fold.speed)
        settings = TransientSettings(120.0 * period, 100.0 * period, period / 40.0, period / 200.0, tolerance=1.0)
        start = (at_fold.displacement, at_fold.velocity)
        result = simulate(deep(part * fold.speed), settings, TransientOutputs(ROW, ROW, ROW), initial=start)
        lost.append(result.contact_loss[0])
    assert lost[0] == 0.0
    assert lost[1] == pytest.approx(at_fold.contact_loss[0], abs=0.05)
    assert lost[1] > 0.4


def test_period_doubling_of_mathieu() -> None:
    """Closed teeth near twice their natural frequency: stability is lost and won where Hill's determinant says."""
    depth, damping = 0.15, 0.02
    curve = response_curve(lambda speed: one_mass(speed, SHALLOW, damping), 1.7, 2.4, points=30)
    assert [event.kind for event in curve.bifurcations] == ["period doubling", "period doubling"]
    for event in curve.bifurcations:
        period = 2.0 * np.pi / event.speed

        def rates(time: float, state: FloatArray, speed: float = event.speed) -> FloatArray:
            x, v = state.reshape(2, 2)
            return np.concatenate([v, -2.0 * damping * v - (1.0 + depth * np.cos(speed * time)) * x])

        end = solve_ivp(rates, (0.0, period), np.eye(2).ravel(), rtol=1e-10, atol=1e-12).y[:, -1]
        values = np.linalg.eigvals(end.reshape(2, 2))
        assert np.abs(values + 1.0).min() < 1e-5
    inside = slice(curve.bifurcations[0].index + 1, curve.bifurcations[1].index)
    assert not curve.stable[inside].any()
    assert curve.responses[inside.start].floquet.leaving == "period doubling"


def test_double_period_after_period_doubling() -> None:
    """Within the tongue the teeth part, in a motion of twice the period that the transient settles to."""
    system = one_mass(2.0, SHALLOW, 0.02)
    once = periodic_response(system)
    assert not once.stable
    assert once.floquet.leaving == "period doubling"
    period = once.period
    settings = TransientSettings(400.5 * period, 398.0 * period, period / 40.0, period / 400.0, tolerance=1.0)
    start = (1.1 * once.displacement, once.velocity)
    result = simulate(system, settings, TransientOutputs(ROW, ROW, ROW), initial=start)
    twice = periodic_response(system, period=2.0 * period, start=(result.displacement[0], result.velocity[0]))
    assert twice.stable
    assert twice.contact_loss[0] > 0.0
    record = twice.record(TransientOutputs(ROW, ROW, ROW), 80)
    np.testing.assert_allclose(record.displacement, result.displacement[:80], atol=1e-3)
    assert twice.rms_compression[0] > 2.0 * once.rms_compression[0]


@pytest.mark.slow
def test_a_rotor_with_unbalance_follows_its_receptance() -> None:
    """Two planes with gyroscopic coupling; forces with the square of the speed."""
    stiffness, damping = np.diag([1.0, 1.3]), 0.05 * np.eye(2)
    gyroscopic = np.array([[0.0, 0.4], [-0.4, 0.0]])
    part = Component("rotor", ("rotor", "rotor"), stiffness, damping, gyroscopic)

    def system_at(speed: float) -> CoupledSystem:
        load = HarmonicLoad(speed, 0.1 * speed**2 * np.array([1.0, -1.0j]))
        return CoupledSystem((part,), (speed,), harmonic_loads=(load,))

    curve = response_curve(system_at, 0.4, 2.2, points=40)
    assert curve.bifurcations == ()
    assert curve.stable.all()
    assert np.all(np.diff(curve.speeds) > 0.0)
    assert len(curve.speeds) >= 40
    for speed, response in zip(curve.speeds, curve.responses, strict=True):
        matrix = stiffness + 1j * speed * (damping + speed * gyroscopic) - speed**2 * np.eye(2)
        exact = np.linalg.solve(matrix, 0.1 * speed**2 * np.array([1.0, -1.0j]))
        np.testing.assert_allclose(response.displacement, exact.real, atol=1e-9 * np.abs(exact).max())
        np.testing.assert_allclose(response.velocity, -speed * exact.imag, atol=1e-9 * np.abs(exact).max())


def test_a_curve_keeps_no_motion_s_course_and_makes_it_again() -> None:
    shown: list[tuple[float, FloatArray]] = []
    alive: list[weakref.ref[PeriodicResponse]] = []

    def seen(speed: float, response: PeriodicResponse) -> None:
        shown.append((speed, response.peak_force))
        alive.append(weakref.ref(response))

    curve = response_curve(deep, 0.6, 1.2, points=30, seen=seen)
    gc.collect()
    assert not any(response() for response in alive)
    assert [speed for speed, _ in shown] == curve.speeds.tolist()
    np.testing.assert_array_equal([force for _, force in shown], curve.peak_force)
    for index in (0, curve.folds[0].index, len(curve.speeds) - 1):
        kept, motion = curve.responses[index], curve.motion(index)
        assert motion.residual < 1e-9
        assert motion.switches == kept.switches
        np.testing.assert_allclose(motion.displacement, kept.displacement, rtol=1e-12)
        np.testing.assert_allclose(motion.floquet.values, kept.floquet.values, atol=1e-9)
        for name in ("mean_force", "peak_force", "mean_compression", "rms_compression", "contact_loss"):
            np.testing.assert_allclose(getattr(motion, name), getattr(kept, name), rtol=1e-9, atol=1e-12)
        # The largest force is looked for at sixteen places of few elements; no other element has a larger one.
        force = motion.record(TransientOutputs(ROW, ROW, ROW), 4000).force.max()
        assert kept.peak_force[0] == pytest.approx(force, rel=2e-4)


def test_wrong_ranges() -> None:
    with pytest.raises(CouplingError, match="expected a range"):
        response_curve(deep, 0.6, 0.6)


def test_a_range_that_the_first_branch_leaves_is_followed_from_its_other_end() -> None:
    """From between the folds the branch turns back to where it begins; motions above the fold lie on another piece."""
    whole = response_curve(deep, 0.6, 1.2, points=50)
    high, low = whole.folds
    between = 0.5 * (high.speed + low.speed)
    curve = response_curve(deep, between, 1.2, points=50)
    assert curve.endings == ("start", "start")
    assert curve.gaps == ()
    assert curve.ending == "end"
    assert [fold.speed for fold in curve.folds] == pytest.approx([high.speed], abs=1e-7)
    assert curve.speeds[curve.slices[1]].tolist() == sorted(curve.speeds[curve.slices[1]], reverse=True)
    for speed in (0.5 * (between + high.speed), 0.95, 1.15):
        found, expected = (sorted(float(one.rms_compression[0]) for one in at(speed)) for at in (curve.at, whole.at))
        assert found == pytest.approx(expected, rel=1e-6)


def with_undamped_mass(speed: float) -> CoupledSystem:
    """Beside the teeth's mass there is one of frequency 3.5 that nothing damps, and that the teeth just move."""
    mass = Component("mass", ("torsion",) * 2, np.diag([0.0, 3.5**2]), np.diag([0.1, 0.0]), np.zeros((2, 2)))
    direction = np.array([1.0, 0.03])
    teeth = ContactConnector("teeth", direction, SHALLOW, 0.0, speed / (2.0 * np.pi), np.empty((0, 3)))
    return CoupledSystem((mass,), (0.0,), contacts=(teeth,), load=np.array([1.0, 0.0]))


def test_resonances_that_nothing_damps_are_stepped_over_and_told() -> None:
    """The second harmonic of a speed of 1.75 has the frequency 3.5, where the motion has no bound."""
    curve = response_curve(with_undamped_mass, 1.55, 1.95, points=40)
    assert curve.gaps
    covered = 0.4 - sum(high - low for low, high in curve.gaps)
    assert covered > 0.9 * 0.4
    assert [low < 1.75 < high for low, high in curve.gaps] == [True]
    assert "the motion grows without a top at one speed" in curve.account
    assert curve.passes(1.6)
    assert not curve.passes(1.75)
    with pytest.raises(CouplingError, match=r"no motion at 1\.75"):
        curve.at(1.75)
    # No motion on the way up to it is left on the curve.
    alone = response_curve(lambda speed: one_mass(speed, SHALLOW, 0.05), 1.55, 1.95, points=40)
    assert curve.rms_compression.max() == pytest.approx(alone.rms_compression.max(), rel=0.05)
    assert len(curve.speeds) < 300


def test_what_is_not_followed_is_told() -> None:
    curve = response_curve(deep, 0.6, 1.2, points=50, most_points=8)
    ((low, high),) = curve.gaps
    assert (low, high) == (pytest.approx(curve.speeds.max()), 1.2)
    assert curve.ending == "points"
    assert f"Nothing was followed between {low:.6g} and 1.2" in curve.account
    solved = SolvedSteady(machine=None, motions=(), curve=curve)  # type: ignore[arg-type]
    (warned,) = solved.branch_warnings()
    assert warned["name"] == "branch range"
    assert (warned["from_rpm"], warned["to_rpm"]) == pytest.approx((RPM * low, RPM * 1.2))
    assert SolvedSteady(machine=None, motions=(), curve=response_curve(deep, 1.1, 1.2)).branch_warnings() == []  # type: ignore[arg-type]


def test_a_point_between_two_of_a_branch_is_on_it_where_it_is_as_near_as_predictions_are() -> None:
    """Between speeds 1 and 2 the states go along a line; beside it by 2 % of a motion is another branch."""
    times = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)[:, None]
    shape, change = np.sin(times), 3.0 * np.cos(times)

    def motion(part: float, aside: float = 0.0) -> tuple[FloatArray, FloatArray]:
        return shape + part * change + aside, part * shape

    nodes = [SimpleNamespace(displacements=q, velocities=v / 4.0, period=4.0) for q, v in map(motion, (0.0, 1.0))]
    branch: Any = SimpleNamespace(speeds=[1.0, 2.0], motions=nodes)

    def holds(speed: float, part: float, aside: float = 0.0) -> bool:
        q, v = motion(part, aside)
        response = SimpleNamespace(at_nodes=lambda segments: (q, v / 5.0), period=5.0)
        point: Any = SimpleNamespace(speed=speed, response=response, ready=SimpleNamespace(segments=np.arange(16)))
        return _Follower.has(branch, point)

    assert holds(1.25, 0.25)
    assert holds(2.0, 1.0)
    assert not holds(1.25, 0.75)
    assert not holds(1.25, 0.25, aside=0.3)
    assert not holds(2.5, 1.5)
    branch.speeds = [1.25, 1.25]
    assert holds(1.25, 0.0)


@pytest.mark.parametrize(("climbed", "ending", "kept"), [(0.31, "steep", 0), (0.29, "points", 8)])
def test_points_on_the_way_up_without_a_top_are_left_out(climbed: float, ending: str, kept: int) -> None:
    """Eight points since the speed last moved: they end the branch, unless the motion has grown by 0.3 over them."""
    flushed: list[float] = []
    follower: Any = SimpleNamespace(speeds=[1.0] * 4, pending=[1.0] * 8, tries=0, by_arclength=False, climbed=climbed)
    follower._flush = lambda: flushed.extend(follower.pending)
    follower._followed = lambda *limits: _Follower._followed(follower, *limits)
    most_points = 12 if ending == "points" else 13
    assert _Follower.follow(follower, most_points, 10, lambda _: None) == ending
    assert len(flushed) == kept
