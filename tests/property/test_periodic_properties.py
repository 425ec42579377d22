"""Periodic motions at every speed: stiffness that steps or rises steeply, flanks that part, with and without backlash.

The law of the teeth is written out anew: the equation of motion is held to it, and another integrator, which stops at
every tooth event and change of contact, repeats the motions.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from gearwhine.coupling import CoupledSystem, TransientOutputs, TransientSettings, simulate
from gearwhine.coupling.errors import PeriodicError
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.coupling.periodic import PeriodicResponse, periodic_response
from gearwhine.numerics.arrays import FloatArray

RISE = 0.02
"""Part of a base pitch in which the stiffness of a steep trapezoid rises."""


@dataclass(frozen=True)
class Teeth:
    """Teeth of mean stiffness one: of a pair's stiffness a rectangle or a trapezoid, in base pitches."""

    ratio: float
    steep: bool
    damping: float
    depth: float
    backlash: float | None

    def contact(self) -> ToothContact:
        if self.steep:
            knots = np.array([0.0, RISE, self.ratio - RISE, self.ratio])
            stiffness = piecewise.polyline(knots, np.array([0.1, 1.0, 1.0, 0.1]) / self.ratio)
        else:
            stiffness = piecewise.constant(1.0 / self.ratio, self.ratio)
        gap = piecewise.constant(0.0, self.ratio)
        return ToothContact(self.ratio, stiffness, gap, damping=self.damping, damping_depth=self.depth)

    def stiffness(self, phase: FloatArray | float) -> FloatArray:
        """Sum over the pairs in contact."""
        total = np.zeros_like(np.asarray(phase, dtype=float))
        for pair in range(int(np.ceil(self.ratio))):
            s = np.asarray(phase) % 1.0 + pair
            shape = (
                np.interp(s, [0.0, RISE, self.ratio - RISE, self.ratio], [0.1, 1.0, 1.0, 0.1]) if self.steep else 1.0
            )
            total += np.where(s < self.ratio, shape, 0.0) / self.ratio
        return total

    def force(self, phase: FloatArray | float, x: FloatArray | float, v: FloatArray | float) -> FloatArray:
        """Force that opposes the compression x of the drive flanks, of back flanks too."""
        total = self._one_side(phase, np.asarray(x), np.asarray(v))
        if self.backlash is not None:
            total = total - self._one_side(phase, -np.asarray(x) - self.backlash, -np.asarray(v))
        return total

    def _one_side(self, phase: FloatArray | float, x: FloatArray, v: FloatArray) -> FloatArray:
        faded = np.clip(x / self.depth, 0.0, 1.0) if self.depth else 1.0
        return np.where(x > 0.0, np.maximum(self.stiffness(phase) * x + self.damping * faded * v, 0.0), 0.0)

    def events(self) -> list[float]:
        """Phases at which the stiffness steps or bends."""
        corners = [0.0, RISE, self.ratio - RISE, self.ratio] if self.steep else [0.0, self.ratio]
        return sorted({corner % 1.0 for corner in corners})


@dataclass(frozen=True)
class Train:
    """Unit masses on springs and dampers, and the teeth between them, each with its part of the fastest mesh's rate."""

    stiffness: FloatArray
    damping: FloatArray
    load: FloatArray
    meshes: Sequence[tuple[Teeth, FloatArray, float, float]]

    def system(self, speed: float) -> CoupledSystem:
        size = len(self.load)
        part = Component("masses", ("torsion",) * size, self.stiffness, self.damping, np.zeros((size, size)))
        contacts = []
        for number, (teeth, direction, phase, ratio) in enumerate(self.meshes):
            rate = ratio * speed / (2.0 * np.pi)
            drive = ContactConnector(f"teeth {number}", direction, teeth.contact(), phase, rate, np.empty((0, 3)))
            contacts.append(drive)
            if teeth.backlash is not None:
                back = replace(drive, direction=-direction, clearance=teeth.backlash, loaded=False)
                contacts.append(replace(back, name=f"back {number}"))
        return CoupledSystem((part,), (0.0,), contacts=tuple(contacts), load=self.load)

    def acceleration(self, speed: float, times: FloatArray | float, q: FloatArray, v: FloatArray) -> FloatArray:
        """Acceleration by the equation of motion, q and v with the coordinates last."""
        total = self.load - q @ self.stiffness - v @ self.damping
        for teeth, direction, phase, ratio in self.meshes:
            at = phase + ratio * speed / (2.0 * np.pi) * np.asarray(times)
            total = total - np.multiply.outer(teeth.force(at, q @ direction, v @ direction), direction)
        return np.asarray(total)

    def stops(self, speed: float, period: float) -> FloatArray:
        """Times of a period at which the stiffness of any teeth steps or bends, and its ends."""
        times = [np.array([0.0, period])]
        for teeth, _, phase, ratio in self.meshes:
            rate = ratio * speed / (2.0 * np.pi)
            for event in teeth.events():
                all_of_them = (np.arange(-1, rate * period + 2) + event - phase) / rate
                times.append(all_of_them[(all_of_them > 0.0) & (all_of_them < period)])
        return np.unique(np.concatenate(times))

    def integrated(self, speed: float, period: float, state: FloatArray, tolerance: float) -> FloatArray:
        """State after a period by Runge and Kutta's eighth order, stopped at tooth events and changes of contact."""
        size = len(self.load)

        def rates(time: float, y: FloatArray) -> FloatArray:
            return np.concatenate([y[size:], self.acceleration(speed, time, y[:size], y[size:])])

        flanks = [crossing(direction, gap) for direction, gap in self._flanks()]
        stops = self.stops(speed, period)
        for begin, end in pairwise(stops):
            # Just inside, where the pairs are those between the two events.
            inside = 1e-13 * period
            time, last = begin + inside, end - inside
            while time < last:
                found = solve_ivp(rates, (time, last), state, "DOP853", events=flanks, rtol=tolerance, atol=1e-13)
                state, done = found.y[:, -1], found.t[-1]
                if found.status == 1:
                    # A little beyond the change, so that the same one is not found again.
                    beyond = min(1e-9, last - done)
                    state, done = state + beyond * rates(done + beyond, state), done + beyond
                time = done
        return np.asarray(state)

    def _flanks(self) -> list[tuple[FloatArray, float]]:
        flanks = []
        for teeth, direction, _, _ in self.meshes:
            flanks += [(direction, 0.0), (direction, teeth.depth)]
            if teeth.backlash is not None:
                flanks += [(direction, -teeth.backlash), (direction, -teeth.backlash - teeth.depth)]
        return flanks


def crossing(direction: FloatArray, at: float) -> Callable[[float, FloatArray], float]:
    """Terminal event of an integrator: flanks meet or part, or their damping is full."""

    def value(time: float, state: FloatArray) -> float:
        return float(state[: len(direction)] @ direction) - at

    value.terminal = True  # type: ignore[attr-defined]
    return value


def one_mass(teeth: Teeth) -> Train:
    return Train(np.zeros((1, 1)), np.full((1, 1), 0.002), np.ones(1), [(teeth, np.ones(1), 0.0, 1.0)])


def two_masses(teeth: Teeth) -> Train:
    direction = np.array([0.9, 0.5])
    return Train(np.diag([0.3, 0.05]), np.diag([0.01, 0.005]), 1.5 * direction, [(teeth, direction, 0.0, 1.0)])


def residual(train: Train, speed: float, response: PeriodicResponse) -> float:
    """Largest defect of the equation of motion at 400 times of the period, over the largest acceleration."""
    unit = np.eye(len(train.load))
    record = response.record(TransientOutputs(unit, unit, unit), 400)
    expected = train.acceleration(speed, record.times, record.displacement, record.velocity)
    # At a step itself either side is right.
    steps = np.abs(record.times[:, None] - train.stops(speed, response.period)).min(axis=1) < 1e-6 * response.period
    defect = np.abs(expected - record.acceleration)[~steps]
    return float(defect.max() / np.abs(record.acceleration).max())


@pytest.mark.parametrize("depth", [0.0, 0.05])
@pytest.mark.parametrize("backlash", [None, 0.3])
@pytest.mark.parametrize("steep", [False, True])
@pytest.mark.parametrize("train", [one_mass, two_masses])
def test_every_speed_has_its_motion(
    train: Callable[[Teeth], Train], steep: bool, backlash: float | None, depth: float
) -> None:
    """Thirty speeds through the parametric resonances 2 w_n / k: a closed motion that obeys the law, and its stability.

    The damping is light: the flanks part at several speeds, and some motions are unstable.
    """
    many = train(Teeth(1.6, steep, 0.04, depth, backlash))
    parted = unstable = 0
    for speed in np.linspace(0.15, 2.3, 30):
        response = periodic_response(many.system(speed))
        assert response.residual < 1e-8
        assert residual(many, speed, response) < 1e-6, speed
        # Impulse of all forces over the period: none.
        unit = np.eye(len(many.load))
        mean = response.record(TransientOutputs(unit, unit, unit), 4000).displacement.mean(axis=0)
        pushed = sum(
            force * contact.direction
            for force, contact in zip(response.mean_force, many.system(speed).contacts, strict=True)
        )
        np.testing.assert_allclose(many.stiffness @ mean + pushed, many.load, atol=1e-3)
        parted += int(response.contact_loss[0] > 0.0)
        unstable += int(not response.stable)
    assert parted >= 5
    assert unstable >= 2


@pytest.mark.parametrize("speed", [0.45, 0.89, 1.85])
@pytest.mark.parametrize("backlash", [None, 0.3])
@pytest.mark.parametrize("steep", [False, True])
def test_motions_repeat_under_an_integrator_that_stops_at_events(
    steep: bool, backlash: float | None, speed: float
) -> None:
    train = two_masses(Teeth(1.6, steep, 0.04, 0.05, backlash))
    response = periodic_response(train.system(speed), tolerance=1e-9)
    start = np.concatenate([response.displacement, response.velocity])
    end = train.integrated(speed, response.period, start, 1e-10)
    # An unstable motion multiplies the errors of both.
    np.testing.assert_allclose(end, start, atol=2e-8 * max(response.floquet.largest, 1.0) * np.abs(start).max())


def three_masses(damping: float) -> Train:
    """Two meshes whose frequencies are as 8 to 5."""
    one, other = (Teeth(ratio, False, damping, 0.0, None) for ratio in (1.6, 1.3))
    first, second = np.array([1.0, 0.8, 0.0]), np.array([0.0, 0.7, 1.0])
    return Train(
        np.diag([0.2, 0.1, 0.05]),
        0.002 * np.eye(3),
        first + second,
        [(one, first, 0.0, 1.0), (other, second, 0.2, 5.0 / 8.0)],
    )


@pytest.mark.parametrize("speed", [1.7, 1.95, 2.25])
def test_motions_that_time_integration_leaves_are_found(speed: float) -> None:
    """Two meshes: the motion is unstable, a disturbance grows several times a period, and it obeys the law."""
    train = three_masses(0.04)
    response = periodic_response(train.system(speed))
    assert response.floquet.largest > 3.0
    assert response.residual < 1e-8
    assert residual(train, speed, response) < 1e-6


@pytest.mark.slow
def test_chaos_is_told_by_the_growth_of_a_disturbance() -> None:
    """Two meshes 8 : 5, hardly damped: no motion is found, and neighbours part as fast under Newmark's steps."""
    train = three_masses(0.01)
    # At most speeds an unstable motion is found; at which ones none is, the last digit of the search decides.
    found = None
    for speed in np.arange(2.15, 2.2, 0.0025).tolist():
        try:
            periodic_response(train.system(speed))
        except PeriodicError as error:
            growing = r"chaotic, a disturbance grows by a factor of ([\d.e+]+) a period.* ([\d.]+) times the damping"
            found = re.search(growing, str(error))
            break
    assert found is not None
    told, factor = float(found[1]), float(found[2])

    period, unit = 8.0 * 2.0 * np.pi / speed, np.eye(3)
    system, outputs = train.system(speed), TransientOutputs(unit, unit, unit)

    def after(state: FloatArray, periods: int) -> FloatArray:
        """State after some periods by Newmark's steps; its samples are the first and the last instant."""
        length = periods * period
        march = TransientSettings(1.001 * length, 0.0, length, period / 4000.0, tolerance=1.0)
        moved = simulate(system, march, outputs, initial=(state[:3], state[3:]))
        return np.concatenate([moved.displacement[-1], moved.velocity[-1]])

    state, apart, growth = after(np.zeros(6), 300), np.ones(6), []
    for _ in range(80):
        apart = 1e-6 * apart / np.linalg.norm(apart)
        following = after(state, 1)
        apart = after(state + apart, 1) - following
        growth.append(np.log(np.linalg.norm(apart) / 1e-6))
        state = following
    # Means over 64 and 32 periods of a growth that scatters.
    assert np.exp(np.mean(growth[16:])) == pytest.approx(told, rel=0.35)
    assert told > 1.2

    # With that much more damping there is a motion.
    damped = replace(
        train,
        meshes=[
            (replace(teeth, damping=factor * teeth.damping), direction, phase, ratio)
            for teeth, direction, phase, ratio in train.meshes
        ],
    )
    assert residual(damped, speed, periodic_response(damped.system(speed))) < 1e-6
