"""Periodic motion of machines whose carriers turn: closed forms, linear lines, multipliers by Magnus's series."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from test_floquet_exponents import multipliers

from gearwhine.coupling import CoupledSystem, CouplingError, PeriodicError
from gearwhine.coupling.analyses.steady_state import solve_steady
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import LinearConnector, TurningPart
from gearwhine.coupling.periodic import SettledMotion, common_period, periodic_response, settled_response, settling
from gearwhine.coupling.periodic.leading_multipliers import leading_multipliers
from gearwhine.coupling.periodic.response import FloquetMultipliers
from gearwhine.coupling.periodic.settled_curve import settled_curve
from gearwhine.coupling.periodic.settling import _States
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.coupling.time.settings import TransientOutputs
from gearwhine.rotors import Unbalance
from tests.machines.turning_set import turning_machine, turning_set

FloatArray = npt.NDArray[np.float64]
ANISOTROPIC, UNEQUAL = (900.0, 1300.0), (0.0, 130.0, 240.0)
TWO_PI = 2.0 * np.pi

# A unit mass on springs of a frame that turns at Ω, under a constant force: z = R(-Ωt) q is pulled round at -Ω.
STIFFNESS, DAMPING, TURN = np.array([[4.0, 0.5], [0.5, 9.0]]), np.array([[0.02, 0.01], [0.01, 0.05]]), 1.3
QUARTER = np.array([[0.0, -1.0], [1.0, 0.0]])
FORCE = np.array([0.7, -0.2])


def carousel(load: FloatArray = FORCE) -> CoupledSystem:
    zeros = np.zeros((2, 2))
    body = Component("body", ("rotor",) * 2, zeros, zeros, zeros)
    springs = LinearConnector(
        "springs", np.eye(2), STIFFNESS, DAMPING, turning=(TurningPart(TURN, np.eye(2), QUARTER),)
    )
    return CoupledSystem((body,), (0.0,), (springs,), load=load)


def test_mass_on_springs_that_turn_has_the_motion_of_its_rotating_frame() -> None:
    """z'' + (C + 2ΩJ) z' + (K - Ω²) z = R(-Ωt) F, whose circular parts e^{±iΩt} are solved each."""
    settled = settled_response(carousel(), closure=1e-6, step_tolerance=1e-6)
    assert settled.period == pytest.approx(TWO_PI / TURN, rel=1e-12)
    times = settled.period * np.arange(64) / 64
    exact = np.zeros((64, 2))
    for sense in (1, -1):
        # R(-Ωt) F = Σ ½ (F ∓ i J F) e^{∓iΩt}, of J F the quarter turn.
        phasor, w = 0.5 * (FORCE - 1j * sense * QUARTER @ FORCE), -sense * TURN
        dynamic = STIFFNESS - TURN**2 * np.eye(2) - w**2 * np.eye(2) + 1j * w * (DAMPING + 2.0 * TURN * QUARTER)
        exact += (np.linalg.solve(dynamic, phasor) * np.exp(1j * w * times)[:, None]).real
    turned = np.array(
        [[[np.cos(TURN * t), -np.sin(TURN * t)], [np.sin(TURN * t), np.cos(TURN * t)]] for t in times.tolist()]
    )
    found = settled.record(TransientOutputs(np.eye(2), np.eye(2), np.eye(2)), 64)
    expected = np.einsum("tij,tj->ti", turned, exact)
    np.testing.assert_allclose(found.displacement, expected, atol=1e-4 * np.abs(expected).max())
    np.testing.assert_allclose(found.times, times)
    # Its disturbances are those of the rotating frame: two pairs of exponents.
    frame = np.block(
        [[np.zeros((2, 2)), np.eye(2)], [TURN**2 * np.eye(2) - STIFFNESS, -DAMPING - 2.0 * TURN * QUARTER]]
    )
    decay = np.exp(np.linalg.eigvals(frame).real.max() * settled.period)
    assert settled.floquet.largest == pytest.approx(decay, rel=1e-3)
    assert settled.stable
    assert settled.residual <= 1e-6


@pytest.fixture
def stability_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Do not find multipliers, which take half of the time."""
    known = FloquetMultipliers(np.array([0.5 + 0.0j]), 1.0, np.array([0.01]))
    monkeypatch.setattr(settling, "_multipliers", lambda *_, **__: known)


@pytest.mark.slow
@pytest.mark.usefixtures("stability_left_out")
def test_lines_of_the_settled_motion_are_the_linear_ones() -> None:
    """Of planets at unequal angles, which cancel no line."""
    machine = turning_machine(ANISOTROPIC, angles_deg=UNEQUAL)
    settled = settled_response(machine.system)
    period, count = TWO_PI / machine.speeds["carrier"], 8192
    assert settled.period == pytest.approx(period, rel=1e-9)
    motion = histories(machine, settled.record(transient_outputs(machine), count)).sensor_acceleration
    found, checked = MeshHarmonicModel(machine).parts(TWO_PI * 2500.0), 0
    for sensor, row in machine.sensor_rows.items():
        spectrum = 2.0 * np.fft.rfft(motion[sensor]) / count
        expected = {
            round(line.frequency * period / TWO_PI): -(line.frequency**2) * complex(row @ line.motion) for line in found
        }
        highest = max(map(abs, expected.values()))
        strong = [at for at, amplitude in expected.items() if abs(amplitude) > 1e-2 * highest]
        for at in strong:
            assert abs(spectrum[at] - expected[at]) < 0.01 * abs(expected[at])
        checked += len(strong)
    assert checked >= 4
    assert settled.contact_loss.max() == 0.0


@pytest.mark.slow
def test_multipliers_are_those_of_a_turn() -> None:
    """The largest is that of the monodromy by Magnus's series, within its error."""
    machine = turning_machine(ANISOTROPIC, speed=3000.0)
    settled = settled_response(machine.system, closure=1e-6)
    exact = multipliers(machine.system, settled.period, 60)
    # Without the rotation of the train and the torsion of shafts that no force moves, which nothing damps.
    largest = np.abs(exact[np.abs(exact) < 1.0 - 1e-4]).max()
    assert largest == pytest.approx(0.7345, abs=1e-4)
    assert settled.floquet.largest_error < 0.5 * (1.0 - largest) + 0.01
    assert settled.floquet.largest == pytest.approx(largest, abs=1e-3)
    assert settled.stability == "stable"


def test_no_multiplier_of_non_normal_maps_lies_beyond_the_error_of_the_largest() -> None:
    """Close spirals of eigenvalues with conditions of up to 300, by few products, against all of the matrix."""
    rng, products, decided = np.random.default_rng(3), 0, 0
    for _ in range(60):
        pairs, basis = 40, np.linalg.qr(rng.standard_normal((80, 80)))[0]
        radii = np.repeat(rng.uniform(0.5, 1.1) * np.exp(-0.5 * np.arange(pairs) ** rng.uniform(0.3, 1.0)), 2)
        turns = np.exp(1j * rng.uniform(0.0, np.pi, pairs))
        diagonal = np.repeat(turns.real, 2) * radii
        across = np.zeros((80, 80))
        across[::2, 1::2] = np.diag(turns.imag * radii[::2])
        stretched = basis * 10.0 ** rng.uniform(0.0, rng.uniform(0.0, 2.5), 80)
        matrix = stretched @ (np.diag(diagonal) + across - across.T) @ np.linalg.inv(stretched)

        def product(v: FloatArray, sense: float, matrix: FloatArray = matrix) -> FloatArray:
            return np.asarray(matrix @ v)

        found = leading_multipliers(rng.standard_normal(80), product, product, ratio=4.0)
        largest, error = abs(found.values[0]), found.errors[0]
        assert abs(largest - radii[0]) <= error * (1.0 + 1e-9)
        decided += error < abs(1.0 - largest)
        products += found.disturbances
    assert decided >= 57
    assert products < 60 * 45


DAMPED = 0.02 * np.eye(2)


def rotating_shaft(turn: float, damping: FloatArray) -> tuple[CoupledSystem, FloatArray]:
    """An unsymmetric shaft that turns with its dashpots, of 4 and 9 N/m at 1 kg, and its exact multipliers' moduli."""
    zeros, stiffness = np.zeros((2, 2)), np.diag([4.0, 9.0])
    springs = LinearConnector("shaft", np.eye(2), stiffness, damping, turning=(TurningPart(turn, np.eye(2), QUARTER),))
    system = CoupledSystem((Component("disc", ("rotor",) * 2, zeros, zeros, zeros),), (0.0,), (springs,), load=FORCE)
    frame = np.block([[zeros, np.eye(2)], [turn**2 * np.eye(2) - stiffness, -damping - 2.0 * turn * QUARTER]])
    return system, np.sort(np.abs(np.exp(np.linalg.eigvals(frame) * TWO_PI / turn)))[::-1]


@pytest.mark.parametrize(
    ("turn", "damping", "tolerance", "verdict"),
    [
        (1.3, DAMPED, 5e-4, "stable"),
        (1.95, DAMPED, 5e-4, "stable"),  # 0.9917
        (2.5, DAMPED, 5e-4, "unstable"),  # between the critical speeds 2 and 3 rad/s of both planes
        (2.02, 0.1 * np.eye(2), 5e-4, "unstable"),
        (2.001, DAMPED, 1e-7, "unstable"),  # 1.059, which would pass for the error of a rough estimate
        (2.0, DAMPED, 5e-4, "not decided"),  # exactly 1
        (1.3, np.zeros((2, 2)), 5e-4, "not decided"),  # all four on the unit circle
    ],
)
def test_stability_of_an_unsymmetric_shaft_is_told_within_its_error(
    turn: float, damping: FloatArray, tolerance: float, verdict: str
) -> None:
    """Its motion under a constant force is unstable between its critical speeds; also then the search finds it."""
    system, exact = rotating_shaft(turn, damping)
    settled = settled_response(system, step_tolerance=tolerance)
    assert settled.stability == verdict
    assert settled.stable is (verdict == "stable")
    assert settled.floquet.largest_error is not None
    assert abs(settled.floquet.largest - exact[0]) <= settled.floquet.largest_error
    assert settled.floquet.largest_error < 0.06
    assert settled.floquet.leaving == ("fold" if verdict == "unstable" else None)


@pytest.mark.parametrize(
    ("values", "errors", "verdict", "growing"),
    [
        ([0.97], [0.02], "stable", 0),
        ([0.97], [0.04], "not decided", 0),
        ([1.03], [0.04], "not decided", 0),
        ([1.03, 0.5], [0.02, 0.6], "unstable", 1),
        ([0.9, 0.5], [0.02, 0.6], "not decided", 0),
    ],
)
def test_a_verdict_is_told_by_whole_intervals(
    values: list[float], errors: list[float], verdict: str, growing: int
) -> None:
    multipliers = FloquetMultipliers(np.array(values, dtype=complex), 1.0, np.array(errors))
    assert (multipliers.stability, multipliers.growing) == (verdict, growing)
    assert multipliers.largest_error == errors[0]
    assert multipliers.stable is (verdict == "stable")


def test_a_disturbance_that_the_search_never_meets_decides() -> None:
    """A second shaft without a load rests while the first is found; it turns between its critical speeds."""
    system, _ = rotating_shaft(1.3, DAMPED)
    (shaft,), (disc,) = system.linear, system.components

    def moved(rows: FloatArray, number: int) -> FloatArray:
        return np.roll(np.vstack([rows, np.zeros((2, 2))]), 2 * number, axis=0)

    shafts = tuple(
        replace(
            shaft,
            name=f"shaft {number}",
            directions=moved(shaft.directions, number),
            stiffness=factor * shaft.stiffness,
            turning=tuple(
                replace(part, cosine=moved(part.cosine, number), sine=moved(part.sine, number))
                for part in shaft.turning
            ),
        )
        for number, factor in ((0, 1.0), (1, 0.25))
    )
    discs = (disc, replace(disc, name="second disc"))
    settled = settled_response(CoupledSystem(discs, (0.0, 0.0), shafts, load=np.concatenate([FORCE, np.zeros(2)])))
    assert np.abs(settled.displacement[2:]).max() < 1e-12
    assert settled.stability == "unstable"


def test_a_motion_of_long_period_is_refused_with_what_to_leave_out() -> None:
    described = turning_set(ANISOTROPIC)
    uneven = [
        replace(shaft, unbalances=[Unbalance(0.05, 1e-5, 0.0)]) if shaft.name == "planet 1" else shaft
        for shaft in described.shafts
    ]
    system = replace(described, shafts=uneven).assembled.system
    # Sun 25, ring 83, planets 29: the planet turns 1 - 83/29 times in a turn of the carrier.
    assert common_period(system) == pytest.approx(29.0 * common_period(described.assembled.system), rel=1e-9)
    with pytest.raises(PeriodicError, match="2407 cycles of the fastest one; expected at most 2000: leave out runout"):
        settled_response(system)


@pytest.mark.usefixtures("stability_left_out")
def test_machine_and_analysis_take_the_motion_that_settles() -> None:
    """Planets in a housing and planets on the ground, whose coordinates all stand in the carrier's frame."""
    described = turning_set(ANISOTROPIC)
    bearings = [replace(one, seat=None) for one in described.bearings]
    grounded = replace(described, housing=None, bearings=bearings)
    for machine, turns in ((described, True), (grounded, False)):
        system = machine.assembled.system
        assert system.turns is turns
        with pytest.raises(PeriodicError, match="settled_response"):
            periodic_response(system)
    motion = grounded.steady()
    assert isinstance(motion, SettledMotion)
    assert motion.residual < 1e-4
    with pytest.raises(CouplingError, match="1 points from 200 to 400; expected two or more"):
        solve_steady(described.assembled, over_speed=(200.0, 400.0), points=1)


def test_a_curve_through_the_critical_speeds_of_an_unsymmetric_shaft() -> None:
    """Its amplitude under a constant force has a closed form; its turning dashpots leave it unstable from the first."""
    told: list[float] = []
    curve = settled_curve(lambda turn: rotating_shaft(turn, DAMPED)[0], 1.5, 3.5, points=11, progress=told.append)
    assert told == pytest.approx(np.arange(1, 12) / 11.0)
    assert curve.speeds == pytest.approx(np.linspace(1.5, 3.5, 11))
    assert curve.gaps == ()
    assert curve.ending == "end"
    largest = np.array([rotating_shaft(turn, DAMPED)[1][0] for turn in curve.speeds.tolist()])
    assert curve.stable.tolist() == (largest < 1.0).tolist() == [True] * 3 + [False] * 8
    ((kind, index),) = [(event.kind, event.index) for event in curve.bifurcations]
    assert (kind, index) == ("branch point", 3)
    for turn, motion in zip(curve.speeds.tolist(), curve.responses, strict=True):
        # At t = 0 the frame is not turned: the displacement is the sum of both circular parts.
        exact = np.zeros(2)
        for sense in (1, -1):
            phasor, w = 0.5 * (FORCE - 1j * sense * QUARTER @ FORCE), -sense * turn
            stiffness = np.diag([4.0, 9.0]) - (turn**2 + w**2) * np.eye(2)
            dynamic = stiffness + 1j * w * (DAMPED + 2.0 * turn * QUARTER)
            exact += np.linalg.solve(dynamic, phasor).real
        np.testing.assert_allclose(motion.displacement, exact, atol=1e-2 * np.abs(exact).max())
    (between,) = curve.at(3.45)
    assert isinstance(between, SettledMotion)
    alone = settled_response(rotating_shaft(3.45, DAMPED)[0])
    np.testing.assert_allclose(between.displacement, alone.displacement, atol=1e-2 * np.abs(alone.displacement).max())


@pytest.mark.slow
@pytest.mark.usefixtures("stability_left_out")
def test_sensors_over_speed_are_those_of_the_linear_lines() -> None:
    described = turning_set(ANISOTROPIC)
    steady = solve_steady(described.assembled, over_speed=(290.0, 310.0), points=2)
    assert steady.curve is not None
    assert steady.curve.speeds == pytest.approx([290.0, 310.0])
    (motion,) = steady.motions
    assert isinstance(motion.response, SettledMotion)
    assert motion.response.residual < 1e-4
    for number, speed in enumerate(steady.curve.speeds.tolist()):
        machine = described.assembled.at_speed(speed)
        lines = MeshHarmonicModel(machine).parts(TWO_PI * 3000.0)
        for sensor, row in machine.sensor_rows.items():
            amplitudes = [line.frequency**2 * abs(complex(row @ line.motion)) for line in lines]
            assert steady.branch_rms[sensor][number] == pytest.approx(
                np.linalg.norm(amplitudes) / np.sqrt(2.0), rel=0.01
            )


def test_motions_that_nothing_resists_have_no_place_and_no_mean_rate() -> None:
    """A mass on a spring along x that drifts along y by 0.6 m in 2 s."""
    zeros = np.zeros((2, 2))
    spring = LinearConnector("spring", np.eye(2)[:, :1], np.array([[4.0]]), np.zeros((1, 1)))
    system = CoupledSystem((Component("body", ("rotor",) * 2, zeros, zeros, zeros),), (0.0,), (spring,))
    states = _States(system, period=2.0, rate_unit=10.0)
    before, after = (
        states.joined(np.array(q), np.array(v)) for q, v in (([0.0, 0.3], [0, 0.3]), ([0.1, 0.9], [0.2, 0.31]))
    )
    q, v = states.parted(states.held(before, after))
    assert q == pytest.approx([0.1, 0.0], abs=1e-12)
    assert v == pytest.approx([0.2, 0.01], abs=1e-12)
