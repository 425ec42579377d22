"""Newmark's method with connectors that turn, against closed forms and the same machine in the rotating frame."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from planetary_machines import set_parts
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from gearwhine.coupling import (
    CoupledSystem,
    CouplingError,
    Machine,
    MountedBearing,
    PeriodicError,
    TransientError,
    TransientOutputs,
    TransientSettings,
    assemble_machine,
    periodic_response,
    simulate,
)
from gearwhine.coupling.connector_forces.kernel_arrays import Bearings, bearing_arrays
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.gears.contact.sliding_friction import SlidingFriction
from gearwhine.coupling.machine.bearing_laws import RollingLaw
from gearwhine.coupling.machine.components import Component, rotor_component
from gearwhine.coupling.machine.connectors import (
    ContactConnector,
    LinearConnector,
    NonlinearConnector,
    Sliding,
    SpeedTable,
    TurningPart,
)
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.machine.speed_profile import SpeedProfile
from gearwhine.coupling.time import transient
from gearwhine.coupling.time.condensation import condensed, with_static_attachments
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.coupling.time.transient import TransientResult
from gearwhine.coupling.time.turning_directions import law_directions, mixing, turning_arrays
from gearwhine.rotors import Bearing, Disc, Rotor, Segment, ShaftMaterial, modal_rotor
from gearwhine.rotors.rolling_bearings import BallRow, RollingBearing, rolling_state

FloatArray = npt.NDArray[np.float64]

QUARTER = np.array([[0.0, -1.0], [1.0, 0.0]])
SPEED = 1.3


def body(stiffness: FloatArray, damping: FloatArray, gyroscopic: FloatArray | None = None) -> Component:
    zeros = np.zeros_like(stiffness)
    kinds = ("rotor",) * len(stiffness)
    return Component("body", kinds, stiffness, damping, zeros if gyroscopic is None else gyroscopic)


def everything(n: int) -> TransientOutputs:
    return TransientOutputs(np.eye(n), np.eye(n), np.eye(n))


def turning(directions: FloatArray, speed: float = SPEED) -> tuple[TurningPart]:
    """Whole directions in x, y (and coordinates that stand still) that turn."""
    quarter = np.zeros((len(directions),) * 2)
    quarter[:2, :2] = QUARTER
    plane = np.zeros_like(directions)
    plane[:2] = directions[:2]
    return (TurningPart(speed, plane, quarter @ directions),)


# ------------------------------------------------------------------------------------ a mass on two springs that turn

STIFFNESS, DAMPING = np.array([[4.0, 0.5], [0.5, 9.0]]), np.array([[0.02, 0.0], [0.0, 0.05]])


def rotation(angle: float) -> FloatArray:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def carousel(damping: FloatArray = DAMPING, stiffness: FloatArray = STIFFNESS) -> CoupledSystem:
    """A free unit mass on springs and dashpots of a frame that turns."""
    zeros = np.zeros((2, 2))
    held = LinearConnector("springs", np.eye(2), stiffness, damping, turning=turning(np.eye(2)))
    return CoupledSystem((body(zeros, zeros),), (0.0,), (held,))


def in_rotating_frame(time: float, q: FloatArray, v: FloatArray, damping: FloatArray = DAMPING) -> FloatArray:
    """Coordinates and rates: z'' + (C + 2ΩJ) z' + (K - Ω²) z = 0 for z = R(-Ωt) q."""
    matrix = np.zeros((4, 4))
    matrix[:2, 2:] = np.eye(2)
    matrix[2:, :2] = SPEED**2 * np.eye(2) - STIFFNESS
    matrix[2:, 2:] = -damping - 2.0 * SPEED * QUARTER
    z = expm(matrix * time) @ np.concatenate([q, v - SPEED * QUARTER @ q])
    turn = rotation(SPEED * time)
    return np.concatenate([turn @ z[:2], turn @ (z[2:] + SPEED * QUARTER @ z[:2])])


START = np.array([0.2, -0.1]), np.array([0.3, 0.5])


def test_springs_that_turn_have_coriolis_and_centripetal_terms_in_their_frame() -> None:
    settings = TransientSettings(9.0, 0.0, 0.5, 1.0, tolerance=1e-6)
    result = simulate(carousel(), settings, everything(2), initial=START)
    exact = np.array([in_rotating_frame(time, *START) for time in result.times])
    size = np.abs(exact).max(axis=0)
    np.testing.assert_allclose(result.displacement, exact[:, :2], atol=1e-4 * size[:2].max())
    np.testing.assert_allclose(result.velocity, exact[:, 2:], atol=1e-4 * size[2:].max())


@pytest.mark.parametrize("damping", [np.zeros((2, 2)), DAMPING])
def test_the_rotation_works_on_springs_that_turn(damping: FloatArray) -> None:
    """Without damping ½ z'² + ½ zᵀ(K - Ω²) z stays, so the energy ½ q'² + ½ zᵀ K z changes by the rotation's work."""
    settings = TransientSettings(8.0, 0.0, 0.5, 1.0, tolerance=1e-6)
    result = simulate(carousel(damping), settings, everything(2), initial=START)

    def energy(time: float, state: FloatArray) -> float:
        z = rotation(-SPEED * time) @ state[:2]
        return float(0.5 * state[2:] @ state[2:] + 0.5 * z @ STIFFNESS @ z)

    start = energy(0.0, np.concatenate(START))
    change = energy(8.0, in_rotating_frame(8.0, *START, damping)) - start
    assert abs(change) > 0.2 * start
    assert result.energy.change == pytest.approx(change, abs=1e-4 * start)
    assert result.energy.error < 1e-4
    if not damping.any():
        assert result.energy.lost == 0.0
        assert result.energy.teeth == pytest.approx(change, abs=1e-4 * start)


def test_the_order_is_two() -> None:
    errors = []
    for halvings in range(3):
        settings = TransientSettings(6.0, 5.0, 1.0, 0.02 / 2.0**halvings, tolerance=1.0)
        result = simulate(carousel(), settings, everything(2), initial=START)
        exact = in_rotating_frame(5.0, *START)
        errors.append(np.linalg.norm(np.concatenate([result.displacement[0], result.velocity[0]]) - exact))
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 4.0, rtol=0.05)


def test_a_follower_stiffness_takes_energy() -> None:
    """The skew part of a stiffness, as of a journal bearing, does the work of a loss."""
    skew = STIFFNESS + 0.05 * QUARTER
    settings = TransientSettings(9.0, 0.0, 0.5, 1.0, tolerance=1e-6)
    result = simulate(carousel(stiffness=skew), settings, everything(2), initial=START)
    assert result.energy.error < 1e-4
    even = simulate(carousel(), settings, everything(2), initial=START)
    assert abs(result.energy.lost - even.energy.lost) > 1e-3


def test_springs_follow_speed_as_they_turn() -> None:
    """A run-up: angle and stiffness by the speed, the mass in coordinates at rest."""
    rates, scales = np.array([0.5, 1.0, 2.0]), np.array([1.0, 1.4, 1.5])
    law = scales[:, None, None]
    system = carousel()
    table = SpeedTable(rates, law * STIFFNESS, law * DAMPING)
    system = replace(system, linear=(replace(system.linear[0], over_speed=table),))
    profile = SpeedProfile(np.array([0.0, 8.0]), np.array([0.6, 1.8]))

    def slope(time: float, state: FloatArray) -> FloatArray:
        rate = 0.6 + 0.15 * time
        turn = rotation(SPEED * (0.6 * time + 0.075 * time**2))
        scale = np.interp(rate, rates, scales)
        z = turn.T @ state[:2]
        moved = turn.T @ state[2:] - SPEED * rate * QUARTER @ z
        return np.concatenate([state[2:], -turn @ (scale * (STIFFNESS @ z + DAMPING @ moved))])

    # Matrices stay the same for some steps: with many steps the law follows the speed closely.
    settings = TransientSettings(8.0, 0.0, 0.5, 5e-4, tolerance=1e-4)
    result = simulate(system, settings, everything(2), speed_profile=profile, initial=START)
    exact = solve_ivp(
        slope, (0.0, 8.0), np.concatenate(START), "DOP853", t_eval=result.times, rtol=1e-10, atol=1e-12
    ).y.T
    np.testing.assert_allclose(result.displacement, exact[:, :2], atol=2e-4 * np.abs(exact[:, :2]).max())
    assert result.energy.error < 1e-3


# -------------------------------------------------- all laws, in coordinates at rest and in those of the turning frame

FRAME = 0.9
PLANE = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
BEARING = RollingBearing([BallRow(9, 12e-3, 60e-3, clearance=-8e-6)])
UNIT = 1e-4  # displacement [m] at a coordinate of 1


def whole_machine(*, turns: bool, damping: float = 0.02) -> CoupledSystem:
    """Two lateral coordinates and a torsion on teeth that rub, a ball bearing, and springs; all but the torsion turns.

    In the frame y'' + (C + 2ΩJ) y' + (K - Ω² + ΩCJ) y = F, with still directions and loads.
    """
    resisting = damping * np.diag([1.0, 1.0, 0.7])
    torsion = np.diag([0.0, 0.0, 0.8])
    if turns:
        part = body(torsion, resisting)
    else:
        plane = np.diag([1.0, 1.0, 0.0])
        part = body(torsion - FRAME**2 * plane + FRAME * resisting @ PLANE, resisting, 2.0 * PLANE)
    rub = np.array([[0.4, 0.3, -0.5], [-0.1, 0.2, 0.3]]).T
    law = ToothContact(1.6, piecewise.quadratic(0.9, 1.3, 0.9, 1.6), piecewise.constant(0.0, 1.6), 0.05)
    sliding = Sliding(SlidingFriction(0.2, 0.87, 1.6), rub, np.array([-0.87, 1.0]))
    first = np.array([0.6, -0.3, 0.5])
    contacts = [ContactConnector("rubbing", first, law, 0.0, 0.21, np.array([[0.03, 0.4, 0.2]]), sliding=sliding)]
    contacts.append(ContactConnector("back", -first, law, 0.3, -0.21, np.empty((0, 3)), 0.5, loaded=False))
    contacts.append(ContactConnector("plain", np.array([-0.2, 0.7, 0.1]), law, 0.4, 0.21, np.empty((0, 3))))
    axes = np.array([0, 1])
    tangent = 1e8 * np.eye(2)
    rolling = RollingLaw(rolling_state(BEARING, np.zeros(5)), cage_angle=0.2)
    # In the coordinates balls of some 1e8 N/m are as stiff as the springs of 1 N/m.
    balls = NonlinearConnector("balls", UNIT * np.eye(3)[:, :2], axes, rolling, tangent, 2.0)
    linear = [LinearConnector("balls", UNIT * np.eye(3)[:, :2], tangent, 1e6 * np.eye(2))]
    linear.append(
        LinearConnector("springs", np.eye(3)[:, [1, 2]], np.array([[2.0, 0.3], [0.3, 1.5]]), 0.03 * np.eye(2))
    )
    pushing = np.array([2.0, 0.5, 1.5])
    if not turns:
        return CoupledSystem((part,), (FRAME,), tuple(linear), tuple(contacts), pushing, nonlinear=(balls,))

    def parts(directions: FloatArray) -> tuple[TurningPart, ...]:
        return turning(directions, FRAME)

    linear = [replace(one, turning=parts(one.directions)) for one in linear]
    for number, contact in enumerate(contacts):
        rubbing = contact.sliding and replace(contact.sliding, turning=parts(contact.sliding.directions))
        contacts[number] = replace(contact, turning=parts(contact.direction[:, None]), sliding=rubbing)
    balls = replace(balls, turning=parts(balls.directions))
    plane = np.array([*pushing[:2], 0.0])
    loads = (HarmonicLoad(FRAME, plane - 1j * PLANE @ plane, "turning"),)
    return CoupledSystem((part,), (0.0,), tuple(linear), tuple(contacts), pushing - plane, loads, nonlinear=(balls,))


def of_frame(result: TransientResult, which: str = "displacement") -> FloatArray:
    """Coordinates at rest by those of the frame."""
    turns = [np.eye(3) + np.sin(FRAME * t) * PLANE + (1.0 - np.cos(FRAME * t)) * PLANE @ PLANE for t in result.times]
    y, rate = result.displacement, result.velocity
    if which == "velocity":
        y = rate + FRAME * y @ PLANE.T
    return np.array([turn @ one for turn, one in zip(turns, y, strict=True)])


def test_every_law_turns_as_in_its_frame() -> None:
    """Teeth with friction and backlash, balls and springs: the same motion and forces, found in another frame."""
    settings = TransientSettings(12.0, 0.0, 0.25, 4e-4, tolerance=1e-2)
    y0, y1 = np.array([1.5, 0.6, 0.4]), np.array([0.2, -0.3, 0.5])
    still = simulate(whole_machine(turns=False), settings, everything(3), initial=(y0, y1))
    start = y0, y1 + FRAME * PLANE @ y0
    turned = simulate(whole_machine(turns=True), settings, everything(3), initial=start)
    size = np.abs(still.displacement).max()
    np.testing.assert_allclose(turned.displacement, of_frame(still), atol=2e-5 * size)
    speeds = of_frame(still, "velocity")
    np.testing.assert_allclose(turned.velocity, speeds, atol=1e-4 * np.abs(speeds).max())
    np.testing.assert_allclose(turned.compression, still.compression, atol=1e-4 * np.abs(still.compression).max())
    np.testing.assert_allclose(turned.force, still.force, atol=2e-3 * np.abs(still.force).max())
    np.testing.assert_allclose(turned.mean_force, still.mean_force, atol=1e-4 * still.mean_force.max())
    np.testing.assert_allclose(turned.energy.friction, still.energy.friction, rtol=1e-4)
    # All springs stand still in the frame: only its own rotation works there.
    assert turned.energy.error < 1e-4
    assert still.energy.error < 1e-4


def test_few_columns_carry_all_directions() -> None:
    """Directions by their columns are those of their parts, at any time; those that depend on others are no columns."""
    system = whole_machine(turns=True)
    arrays, columns, _ = turning_arrays(system, _no_bearings())
    assert columns is not None
    # x, y and θ in all, and each combination of them, at most.
    assert len(columns) <= 6
    for time in (0.0, 0.4, 17.0):
        mix, mix_rate = mixing(arrays, time)
        expected = [
            law.directions + sum((part.change(time) for part in law.turning), np.zeros_like(law.directions))
            for law in law_directions(system)
        ]
        np.testing.assert_allclose(columns.T @ mix, np.hstack(expected), atol=1e-13)
        later, _ = mixing(arrays, time + 1e-6)
        earlier, _ = mixing(arrays, time - 1e-6)
        np.testing.assert_allclose(mix_rate, (later - earlier) / 2e-6, atol=1e-8)


def _no_bearings() -> Bearings:
    return bearing_arrays(whole_machine(turns=True).nonlinear)


# ------------------------------------------------------------------------------------------- condensation and refusals


def test_stiff_residual_coordinates_are_condensed_beside_what_turns() -> None:
    """A residual coordinate that only a still bearing feels follows; one that a turning one moves stays."""
    kinds = ("housing", "housing", "residual", "residual")
    stiffness = np.diag([4.0, 6.0, 1e4, 1e4])
    zeros = np.zeros((4, 4))
    part = Component("body", kinds, stiffness, 0.01 * np.eye(4), zeros)
    still = LinearConnector("still", np.array([[1.0, 0.2, 30.0, 0.0]]).T, 3.0 * np.eye(1), np.zeros((1, 1)))
    rows = np.array([[0.5, 0.1, 0.0, 10.0], [0.0, 0.8, 0.0, -5.0]]).T
    parts = (TurningPart(0.7, rows, np.roll(rows, 1, axis=1) * [-1.0, 1.0]),)
    turning_one = LinearConnector("turning", rows, np.diag([2.0, 5.0]), np.zeros((2, 2)), turning=parts)
    system = CoupledSystem((part,), (0.0,), (still, turning_one), load=np.array([1.0, 0.5, 0.0, 0.0]))
    followed = condensed(system)
    np.testing.assert_array_equal(followed.kept, [0, 1, 3])
    settings = TransientSettings(10.0, 0.0, 0.5, 0.01, tolerance=1e-4)
    start = np.zeros(4), np.array([0.3, -0.2, 0.0, 0.0])
    result = simulate(system, settings, everything(4), initial=start)
    exact = solve_ivp(
        lambda time, state: np.concatenate([state[4:], _accelerations(system, time, state)]),
        (0.0, 10.0), np.concatenate(start), "DOP853", t_eval=result.times, rtol=1e-8, atol=1e-10,
    ).y.T  # fmt: skip
    np.testing.assert_allclose(result.displacement[:, :2], exact[:, :2], atol=3e-3 * np.abs(exact[:, :2]).max())


def _accelerations(system: CoupledSystem, time: float, state: FloatArray) -> FloatArray:
    still, turning_one = system.linear
    (part,) = turning_one.turning
    rows = part.cosine * np.cos(0.7 * time) + part.sine * np.sin(0.7 * time)
    stiffness = system.own_stiffness + 3.0 * still.directions @ still.directions.T
    stiffness = stiffness + rows @ turning_one.stiffness @ rows.T
    return np.asarray(system.load - stiffness @ state[:4] - system.own_damping @ state[4:])


def test_methods_without_directions_that_turn_name_those() -> None:
    settings = TransientSettings(1.0, 0.0, 0.1, 0.1, method="exact")
    with pytest.raises(TransientError, match=r"the directions of springs turn.*use Newmark's method"):
        simulate(carousel(), settings, everything(2), initial=START)
    with pytest.raises(PeriodicError, match="directions that turn, those of springs; settled_response finds"):
        periodic_response(carousel())
    by_itself = simulate(carousel(), replace(settings, method="auto"), everything(2), initial=START)
    newmark = simulate(carousel(), replace(settings, method="newmark"), everything(2), initial=START)
    np.testing.assert_array_equal(by_itself.displacement, newmark.displacement)


def test_a_connector_has_at_most_five_directions_that_turn() -> None:
    rows = np.eye(6)
    many = LinearConnector("many", rows, np.eye(6), np.zeros((6, 6)), turning=(TurningPart(1.0, rows, rows),))
    system = CoupledSystem((body(np.eye(6), np.eye(6)),), (0.0,), (many,))
    with pytest.raises(CouplingError, match="many: 6 directions that turn; expected at most 5 of one connector"):
        simulate(system, TransientSettings(1.0, 0.0, 0.1, 0.1), everything(6))


# ----------------------------------------------------------------------------------------------------- forces recorded


@pytest.mark.parametrize("profile", [None, SpeedProfile(np.array([0.0, 2e-3]), np.array([0.5, 1.5]))])
def test_the_force_of_a_bearing_that_turns_follows_its_directions(profile: SpeedProfile | None) -> None:
    steel = ShaftMaterial.from_poisson_ratio(207e9, 0.3, 7850.0)
    shaft = Rotor("shaft", [Segment(0.1, 0.04, 0.0, steel)] * 2, [Disc(0.1, 2.0, 8e-3, 4e-3)])
    stiffness = np.array([[1e8, 2e7], [2e7, 3e8]])
    bearings = [Bearing(name, at, stiffness, 1e-5 * stiffness) for name, at in (("left", 0.0), ("right", 0.2))]
    rotor = rotor_component("shaft", modal_rotor(shaft, bearings, count=2), start=0.0)
    mounted = [MountedBearing(bearing, "shaft", None) for bearing in bearings]
    machine = assemble_machine([rotor], None, speeds={"shaft": 300.0}, bearings=mounted)
    left, right = machine.system.linear
    part = TurningPart(700.0, left.directions, np.roll(left.directions, 1, axis=1) * np.array([-1.0, 1.0]))
    load = 1e3 * left.directions[:, 0] + 300.0 * right.directions[:, 1]
    system = replace(machine.system, linear=(replace(left, turning=(part,)), right), load=load)
    machine = replace(machine, system=system, speed_profile=profile)
    outputs, n = transient_outputs(machine), system.size
    both = replace(
        outputs,
        displacement=np.vstack([outputs.displacement, np.eye(n)]),
        velocity=np.vstack([outputs.velocity, np.eye(n)]),
    )
    result = simulate(system, TransientSettings(2e-3, 0.0, 1e-4, 1e-5, tolerance=1e-2), both, speed_profile=profile)
    found = histories(machine, result).bearing_reaction
    nominal_time, rates, _ = (profile or SpeedProfile.steady()).at(result.times)
    for row, (s, rate) in enumerate(zip(nominal_time, rates, strict=True)):
        q, v = result.displacement[row, -n:], result.velocity[row, -n:]
        c, sn = np.cos(700.0 * s), np.sin(700.0 * s)
        directions, slope = part.cosine * c + part.sine * sn, 700.0 * rate * (part.sine * c - part.cosine * sn)
        expected = stiffness @ (directions.T @ q + 1e-5 * (directions.T @ v + slope.T @ q))
        np.testing.assert_allclose(found["left"][row], expected, rtol=1e-9, atol=1e-6)
        expected = stiffness @ (right.directions.T @ (q + 1e-5 * v))
        np.testing.assert_allclose(found["right"][row], expected, rtol=1e-9, atol=1e-6)


# ------------------------------------------------------------------------------------------ modes of short shafts


@pytest.mark.slow
def test_static_modes_of_planets_ask_for_no_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Forces of a set with all modes followed, and with those above 8 kHz as springs; both start at rest."""
    parts = set_parts()
    stiffness = np.diag([1e8, 2e8])
    # Bearings that are not alike all round stand still, and the meshes of sun and ring turn.
    parts["bearings"] = [
        one
        if one.rotor.startswith("p")
        else replace(one, bearing=Bearing(one.bearing.name, one.bearing.at, stiffness, 1e-5 * stiffness))
        for one in parts["bearings"]
    ]
    machine = Machine(**(parts | {"speed": 100.0 * np.pi}))
    system = machine.assembled.system
    reduced = with_static_attachments(system)
    assert len(system.turning_names) >= 8
    assert reduced.size == system.size
    assert reduced.highest_frequency < 0.2 * system.highest_frequency
    few = machine.simulate(revolutions=0.2, discard=0.05, tolerance=1e-4).result
    monkeypatch.setattr(transient, "with_static_attachments", lambda system: system)
    many = machine.simulate(revolutions=0.2, discard=0.05, tolerance=1e-3).result
    # The fewer steps meet a tolerance that is ten times finer.
    assert few.steps < 0.6 * many.steps
    np.testing.assert_allclose(few.mean_force, many.mean_force, rtol=1e-4)
    np.testing.assert_allclose(few.peak_force, many.peak_force, rtol=1e-3)
    assert few.energy.error < 1e-3
