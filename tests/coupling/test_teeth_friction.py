"""Friction between the teeth in motion: forces and moments, where they turn, order of the steps, heat, refusals."""

import sys
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from gearwhine.coupling import (
    CoupledMachine,
    CoupledSystem,
    GearMesh,
    MachineLoads,
    MountedBearing,
    MountedGear,
    PeriodicError,
    Torque,
    TransientOutputs,
    TransientSettings,
    assemble_machine,
    periodic_response,
    simulate,
    static_equilibrium,
)
from gearwhine.coupling.gears import (
    ConstantStiffness,
    Gear,
    GearError,
    GearPairGeometry,
    HelixDeviation,
    PotentialEnergyStiffness,
    TipRelief,
    ToothContact,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.gears.contact.sliding_friction import SlidingFriction, sliding_direction_means, sliding_friction
from gearwhine.coupling.gears.loaded.mesh_friction import mesh_friction
from gearwhine.coupling.gears.loaded.transmission_error import mesh_period_phases, polygon_phasors
from gearwhine.coupling.machine.components import Component, rotor_component
from gearwhine.coupling.machine.connectors import ContactConnector, Sliding
from gearwhine.coupling.machine.tooth_friction import alike_teeth
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.coupling.time.transient import TransientResult
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import Bearing, Disc, Rotor, Segment, ShaftMaterial, modal_rotor

STEEL = ShaftMaterial.from_poisson_ratio(207e9, 0.3, 7850.0)
RELIEF = TipRelief(0.02e-3, length=3e-3)
PINION = Gear("pinion", 24, 3e-3, np.radians(20.0), 0.02, tip_relief=RELIEF)
WHEEL = Gear("wheel", 36, 3e-3, np.radians(20.0), 0.02, tip_relief=RELIEF)
PAIR = GearPairGeometry(PINION, WHEEL)
CONTACT = tooth_contact(PAIR, PotentialEnergyStiffness(), 1000.0)
TORQUE, COEFFICIENT, SPEED = 80.0, 0.08, 300.0


def machine(friction: float, *, sense: int = 1, psi: float = 0.4, backlash: float | None = None) -> CoupledMachine:
    """Two short shafts on the ground, the driver turning in a sense, the line of centres at an angle psi."""
    axes = {"input": np.zeros(2), "output": PAIR.working_centre_distance * np.array([np.cos(psi), np.sin(psi)])}
    rotors, bearings, gears = [], [], []
    for (name, axis), gear in zip(axes.items(), (PINION, WHEEL), strict=True):
        disc = Disc(0.1, gear.mass, gear.polar_inertia, gear.diametral_inertia)
        shaft = Rotor(name, [Segment(0.1, 0.04, 0.0, STEEL)] * 2, [disc])
        held = [Bearing.isotropic(f"{name} {at:g}", at, 1e8, 2e3) for at in (0.0, 0.2)]
        rotors.append(
            rotor_component(name, modal_rotor(shaft, held, count=3, gears_at=[0.1]), start=0.0, damping_ratio=0.02)
        )
        bearings += [MountedBearing(bearing, name, None) for bearing in held]
        gears.append(MountedGear(gear.name, name, 0.1, (axis[0], axis[1])))
    return assemble_machine(
        rotors,
        None,
        speeds={"input": sense * SPEED, "output": -sense * SPEED / PAIR.ratio},
        bearings=bearings,
        meshes=[GearMesh(gears[0], gears[1], PAIR, CONTACT, backlash, friction)],
        loads=MachineLoads(
            torques=[Torque("input", 0.0, sense * TORQUE), Torque("output", 0.2, sense * TORQUE * PAIR.ratio)]
        ),
    )


def force_of(contact: ContactConnector, system: CoupledSystem, q: FloatArray) -> FloatArray:
    """What the mesh does to the coordinates in equilibrium: all that balances load and springs."""
    return np.asarray(system.stiffness @ q - system.load)


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("phase", [0.05, 0.3, 0.55, 0.9])
def test_forces_and_moments_are_those_of_the_flanks(sense: int, phase: float) -> None:
    """On each shaft the normal force along the line of action, ±Q across it and the moments of the static analysis."""
    parts = machine(COEFFICIENT, sense=sense)
    system, (contact,) = parts.system, parts.system.contacts
    time = (phase - contact.phase) / contact.mesh_frequency
    q = static_equilibrium(system, time)
    found = force_of(contact, system, q)
    compression = float(contact.direction @ q)
    normal = float(CONTACT.pair_forces(phase + 1e-9, compression).sum())
    mesh = loaded_transmission_error(CONTACT, normal, [phase + 1e-9])
    friction = mesh_friction(PAIR, CONTACT, mesh, COEFFICIENT)
    angle = 0.4 + sense * (np.pi / 2.0 - PAIR.working_pressure_angle)
    across = sense * np.array([-np.sin(angle), np.cos(angle)])
    expected = -normal * contact.direction
    moments = sense * friction.driver_moment[0], sense * friction.driven_moment[0]
    start = 0
    for rotor, side, moment in zip(parts.rotors, (1.0, -1.0), moments, strict=True):
        part = slice(start, start + rotor.size)
        start += rotor.size
        for axis in (0, 1):
            expected[part] += side * friction.force[0] * across[axis] * rotor.direction(0.1, axis)
        expected[part] += moment * rotor.rotation(0.1)
    # What would brake the train as a whole is held by what keeps its speed.
    rolling = np.concatenate([parts.speeds[rotor.name] * rotor.turning for rotor in parts.rotors])
    rolling /= np.linalg.norm(rolling)
    expected -= rolling * (rolling @ expected)
    np.testing.assert_allclose(found, expected, atol=1e-7 * np.abs(expected).max())
    without = machine(0.0, sense=sense)
    assert np.abs(found - force_of(contact, without.system, static_equilibrium(without.system, time))).max() > 1.0


@pytest.mark.parametrize("half_line", [0.01, 0.2, 0.7])
def test_a_contact_line_turns_piece_by_piece(half_line: float) -> None:
    """The share that acts is the mean over the line, here of many points."""
    for position in np.linspace(-0.4, 2.0, 41):
        points = position + half_line * (2.0 * (np.arange(20001) + 0.5) / 20001 - 1.0)
        on_path = points[(points >= 0.0) & (points <= 1.6)]
        if not on_path.size:
            on_path = np.array([0.0 if position < 0.0 else 1.6])
        sign = np.sign(on_path - 0.83)
        expected = sign.mean(), (sign * on_path).mean()
        np.testing.assert_allclose(sliding_direction_means(position, half_line, 0.83, 1.6), expected, atol=4e-4)


@settings(deadline=None, max_examples=60)
@given(st.floats(0.0, 30.0), st.floats(1e-7, 1e-4), st.floats(0.1, 400.0))
def test_the_nominal_rotation_always_heats_the_flanks(phase: float, compression: float, speed: float) -> None:
    """Σ E_j |w_j| of the pairs, the sliding speeds from the roll angles."""
    from gearwhine.coupling.gears.contact.tooth_force_kernels import friction_shares

    law = sliding_friction(PAIR, CONTACT, COEFFICIENT)
    place = law.pitch_point, law.path_end
    a, b, _, _ = friction_shares(phase, compression, *CONTACT.kernel_arguments, False, *place)
    states = CONTACT.pairs(phase)
    forces = CONTACT.pair_forces(phase, compression)
    if forces.sum() == 0.0:
        assert (a, b) == (0.0, 0.0)
        return
    at = states.position
    driver, driven = PAIR.driver_roll_angle(at) * PINION.base_radius, PAIR.driven_roll_angle(at) * WHEEL.base_radius
    sliding = speed * (driver - driven / PAIR.ratio)
    first = float(PAIR.driver_roll_angle(0.0)), float(PAIR.driven_roll_angle(0.0))
    begin = speed * (first[0] * PINION.base_radius - first[1] * WHEEL.base_radius / PAIR.ratio)
    rise = speed * PAIR.base_pitch * (1.0 + 1.0 / PAIR.ratio)
    np.testing.assert_allclose(
        a * begin + b * rise, (forces * np.abs(sliding)).sum() / forces.sum(), rtol=1e-9, atol=1e-12 * speed
    )


@pytest.mark.parametrize(("helix", "even", "agree"), [(2.0, True, 5e-4), (15.0, True, 5e-4), (15.0, False, 5e-3)])
def test_helical_faces_turn_slice_by_slice(helix: float, even: bool, agree: float) -> None:
    """Force across and heat of the law against sums over the loaded slices, which no table is behind.

    Tables know a pair by its own compression alone. Where the bodies that pairs share deflect unevenly over the face,
    the load of one pair also depends on where the other is loaded, which the tables leave out.
    """
    from gearwhine.coupling.gears.contact.tooth_force_kernels import friction_shares

    angle = np.radians(helix)
    crowned = HelixDeviation(crowning=5e-6)
    pinion = replace(PINION, helix_angle=angle, helix_deviation=crowned)
    pair = GearPairGeometry(pinion, replace(WHEEL, helix_angle=-angle))
    contact = tooth_contact(pair, PotentialEnergyStiffness(), corner_contact=True, faces=face_slices(pair))
    assert contact.faces is not None
    if even:
        contact = replace(contact, faces=replace(contact.faces, shared=face_slices(pair).shared))
    force = 4000.0
    mesh = loaded_transmission_error(contact, force, np.arange(48) / 48.0)
    expected = mesh_friction(pair, contact, mesh, COEFFICIENT)
    law = sliding_friction(pair, contact, COEFFICIENT)
    assert law.event_phases == ()
    shares = np.array(
        [
            friction_shares(phase, deep, law.shares, 0, True, law.pitch_point, law.path_end)
            for phase, deep in zip(mesh.phases, mesh.transmission_error, strict=True)
        ]
    )
    across = -law.coefficient * force * shares[:, 0]
    np.testing.assert_allclose(across, expected.force, atol=0.02 * COEFFICIENT * force)
    rolls = pair.driver_roll_angle([0.0, 1.0]) * pinion.base_radius
    rolls = rolls - pair.driven_roll_angle([0.0, 1.0]) * pair.driven.base_radius / pair.ratio
    lost = law.coefficient * force * (shares[:, 0] * rolls[0] + shares[:, 1] * (rolls[1] - rolls[0]))
    assert lost.mean() == pytest.approx(expected.loss.mean(), rel=agree)
    # The slopes, against differences.
    step = 1e-9
    phase, deep = 0.3, float(mesh.transmission_error[14])
    below, here, above = (
        friction_shares(phase, deep + change, law.shares, 0, True, law.pitch_point, law.path_end)
        for change in (-step, 0.0, step)
    )
    np.testing.assert_allclose((np.array(above[:2]) - below[:2]) / (2.0 * step), here[2:], rtol=1e-3, atol=1.0)


def test_friction_at_mesh_harmonics_is_the_mean_of_all_pairs_of_unequal_helical_teeth() -> None:
    """To the first order in the gaps of the pairs, whose mean is none."""
    from gearwhine.coupling.gears.contact.tooth_force_kernels import friction_history

    pairs, force = 5, 4000.0
    pinion = replace(PINION, helix_angle=np.radians(15.0))
    pair = GearPairGeometry(pinion, replace(WHEEL, helix_angle=-np.radians(15.0)))
    gaps = np.random.default_rng(2).normal(0.0, 1e-6, pairs)
    contact = replace(
        tooth_contact(pair, PotentialEnergyStiffness(), faces=face_slices(pair)),
        pitch_gaps=gaps - gaps.mean(),
        tooth_counts=(pairs, pairs + 1),
    )
    friction = sliding_friction(pair, contact, COEFFICIENT)
    connector = replace(small_system().contacts[0], contact=contact, sliding=Sliding(friction, RUBBING, np.ones(2)))
    phases = np.arange(pairs * 96) / 96.0
    mesh = loaded_transmission_error(contact, force, phases)
    shares = friction_history(
        phases, mesh.transmission_error, friction.shares, True, friction.pitch_point, friction.path_end
    )
    of_all = friction.coefficient * force * shares
    alike, of_alike = alike_teeth(connector, force)
    assert of_alike is not None
    expected = polygon_phasors(phases, of_all, [1, 2], periods=pairs)
    found = polygon_phasors(alike.phases, of_alike, [1, 2])
    np.testing.assert_allclose(found, expected, atol=0.03 * np.abs(expected).max())


# ------------------------------------------------------------- a small system, against an integration of another kind

SIZE = 4
DIRECTION = np.array([0.6, -0.3, 0.5, 0.2])
RUBBING = np.array([[0.4, 0.3, -0.5, 0.1], [-0.1, 0.2, 0.3, 0.25]]).T
SMALL = SlidingFriction(0.3, 0.87, 1.6)
RATE = 0.21


def small_system(damping: float = 0.0) -> CoupledSystem:
    """Four coordinates on a contact that the load presses, its pairs rubbing: a tangent far from symmetric."""
    matrix = np.random.default_rng(7).normal(size=(SIZE, SIZE))
    zeros = np.zeros((SIZE, SIZE))
    part = Component("body", ("rotor",) * SIZE, matrix @ matrix.T + 0.3 * np.eye(SIZE), 0.25 * np.eye(SIZE), zeros)
    law = ToothContact(1.6, piecewise.quadratic(0.4, 1.2, 0.4, 1.6), piecewise.constant(0.0, 1.6), damping)
    sliding = Sliding(SMALL, RUBBING, np.array([-0.87, 1.0]))
    contact = ContactConnector("contact", DIRECTION, law, 0.0, RATE, np.empty((0, 3)), sliding=sliding)
    return CoupledSystem((part,), (0.0,), contacts=(contact,), load=3.0 * DIRECTION)


def stretches(end: float) -> Iterator[tuple[float, float]]:
    """Between pairs' entering, leaving and passing the pitch point."""
    marks = [number + place for number in range(-2, int(end * RATE) + 2) for place in (0.0, 0.6, 0.87)]
    times = sorted({0.0, end, *(mark / RATE for mark in marks if 0.0 < mark / RATE < end)})
    yield from pairwise(times)


def reference(system: CoupledSystem, start: FloatArray, end: float) -> FloatArray:
    """State at the end, pair by pair, by an adaptive method of the eighth order that starts afresh at every event."""
    (contact,) = system.contacts
    assert contact.sliding is not None

    def slope(time: float, state: FloatArray, middle: float) -> FloatArray:
        q, v = state[:SIZE], state[SIZE:]
        first = np.floor(RATE * middle)
        a = system.load - system.stiffness @ q - system.damping @ v
        positions = np.array([RATE * time - first + j for j in range(2) if RATE * middle - first + j < 1.6])
        signs = np.array([np.sign(RATE * middle - first + j - 0.87) for j in range(len(positions))])
        elastic = contact.contact.stiffness(positions) * (DIRECTION @ q)
        pushed = elastic * (1.0 + contact.contact.damping * (DIRECTION @ v) / elastic.sum())
        for force, sign, position in zip(pushed, signs, positions, strict=True):
            a = a - force * (DIRECTION + SMALL.coefficient * sign * (RUBBING[:, 0] + position * RUBBING[:, 1]))
        return np.concatenate([v, a])

    state = start
    for begin, stop in stretches(end):
        found = solve_ivp(slope, (begin, stop), state, "DOP853", args=(0.5 * (begin + stop),), rtol=1e-11, atol=1e-13)
        state = found.y[:, -1]
    return np.asarray(state)


@pytest.mark.parametrize("damping", [0.0, 0.2])
def test_steps_are_of_second_order_through_the_pitch_points(damping: float) -> None:
    system = small_system(damping)
    start = static_equilibrium(system), 0.05 * np.array([1.0, -0.5, 0.25, 0.8])
    # The last sample is at the last of these events, where no interpolation stands between it and a step.
    end = 3.6 / RATE
    expected = reference(system, np.concatenate(start), end)
    rows, errors = np.eye(SIZE), []
    for step in (0.04, 0.02, 0.01):
        chosen = TransientSettings(end * (1.0 + 1e-3), 0.0, end / 2, step, tolerance=1.0)
        result = simulate(system, chosen, TransientOutputs(rows, rows, rows), initial=start)
        assert result.contact_loss[0] == 0.0
        assert result.energy.error < 1e-3 * step / 0.04
        last = np.concatenate([result.displacement[-1], result.velocity[-1]])
        errors.append(float(np.linalg.norm(last - expected) / np.linalg.norm(expected)))
    assert errors[1] < 0.28 * errors[0]
    assert errors[2] < 0.28 * errors[1]
    assert errors[2] < 5e-4


# ------------------------------------------------------------------------------------------------- the whole machine


def settled(parts: CoupledMachine, periods: int = 12) -> TransientResult:
    period = 1.0 / parts.system.contacts[0].mesh_frequency
    chosen = TransientSettings(periods * period, 0.0, period / 64, period / 16, tolerance=1e-3)
    return simulate(parts.system, chosen, transient_outputs(parts))


def test_what_the_rotation_loses_is_the_loss_of_the_static_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    """Per radian by `mesh_friction` over a mesh period: at a low speed the forces are those of the static mesh."""
    monkeypatch.setattr(sys.modules[__name__], "SPEED", 0.5 * SPEED)
    parts = machine(COEFFICIENT)
    result = settled(parts)
    mesh = loaded_transmission_error(CONTACT, TORQUE / PINION.base_radius, mesh_period_phases(CONTACT))
    friction = mesh_friction(PAIR, CONTACT, mesh, COEFFICIENT)
    turned = 12 * 2.0 * np.pi / PINION.teeth
    expected = (1.0 - friction.efficiency) * TORQUE * turned
    assert result.energy.friction == pytest.approx(expected, rel=0.002)
    assert result.energy.error < 2e-3


def test_friction_shakes_across_the_line_of_action() -> None:
    """At mesh frequency and with hardly anything else changed: the mean force stays, and the train keeps its speed."""
    found = {}
    for friction in (0.0, COEFFICIENT):
        parts = machine(friction)
        result = settled(parts, 30)
        named = histories(parts, result)
        angle = PAIR.line_of_action_angle(0.4)
        motion = named.gear_motion["pinion"][-640:]
        across = motion[:, 0] * -np.sin(angle) + motion[:, 1] * np.cos(angle)
        turning = TORQUE / PINION.base_radius
        # The moments of friction take from the normal force what their arms are to the base circles.
        assert result.mean_force[0] == pytest.approx(turning, rel=0.02)
        drift = named.gear_motion["pinion"][:, 2]
        assert abs(drift[-640:].mean() - drift[:640].mean()) < 0.2 * np.ptp(drift[-640:])
        found[friction] = float(across.std())
    assert found[COEFFICIENT] > 5.0 * found[0.0]


def test_without_friction_nothing_slides() -> None:
    assert machine(0.0).system.is_smooth
    parts = machine(COEFFICIENT, backlash=1e-4)
    assert not parts.system.is_smooth
    drive, back = parts.system.contacts
    assert drive.sliding is not None
    assert back.sliding is not None
    # Both sides of the teeth slide fastest, by the same, at the ends of their paths; neither does at its pitch point.
    for sliding in (drive.sliding, back.sliding):
        assert sliding.nominal[0] + sliding.nominal[1] * PAIR.pitch_point_position == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(np.abs(drive.sliding.nominal), np.abs(back.sliding.nominal), rtol=1e-12)


def test_impossible_frictions_are_refused() -> None:
    for coefficient in (-0.01, 0.51, np.nan):
        with pytest.raises(GearError, match="friction coefficient"):
            sliding_friction(PAIR, CONTACT, coefficient)
    with pytest.raises(GearError, match="place of each pair"):
        sliding_friction(PAIR, tooth_contact(PAIR, ConstantStiffness(2e8)), 0.05)
    with pytest.raises(PeriodicError, match="friction"):
        periodic_response(small_system())
