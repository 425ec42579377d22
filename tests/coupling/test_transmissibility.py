"""Responses over frequency: a gear pair in closed form, reciprocity, Newton's third law, superposition and solving."""

from dataclasses import replace

import numpy as np
import pytest

from gearwhine.coupling import (
    CoupledMachine,
    CoupledSystem,
    CouplingError,
    GearMesh,
    MachineLoads,
    MountedBearing,
    MountedGear,
    Unbalance,
    assemble_machine,
    coupled_modes,
    receptance,
)
from gearwhine.coupling.gears import ConstantStiffness, Gear, GearPairGeometry, ToothContact, tooth_contact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.linear.frequency_response import (
    BasisError,
    mesh_error_response,
    resonance_grid,
    sensor_force_response,
    unbalance_response,
)
from gearwhine.coupling.machine.components import Component, HousingComponent, rotor_component
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.coupling.machine.loads import BowReactions, TorqueRipple
from gearwhine.coupling.statics.mean_mesh import contact_at
from gearwhine.rotors import (
    Bearing,
    Disc,
    ModalRotor,
    Rotor,
    Segment,
    ShaftMaterial,
    solve_lateral_modes,
    solve_torsional_modes,
)
from gearwhine.rotors import Unbalance as RotorUnbalance
from gearwhine.rotors import unbalance_response as rotor_unbalance_response
from gearwhine.rotors.modes.residual_modes import add_attachment_modes

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
NO_ERRORS = np.empty((0, 3))


def geared(speed: float, *, housing: bool = True, cross: float = 0.0) -> CoupledMachine:
    """Two shafts with discs and gears; on a plate of four modes with two sensors, or on the ground."""
    wheels = [Gear(name, teeth, 0.003, np.radians(20.0), face_width=0.02) for name, teeth in (("p", 20), ("w", 50))]
    pair = GearPairGeometry(wheels[0], wheels[1])
    parts, bearings, mounted = [], [], []
    rng = np.random.default_rng(3)
    seats, z = {}, {}
    for number, name in enumerate(("fast", "slow")):
        rotor = Rotor(name, [Segment(0.3, 0.03, 0.0, STEEL)], [Disc(0.1, 2.0, 0.004, 0.002)])
        stiffness = np.array([[4e7, cross], [-cross, 3e7]])
        held = [Bearing(f"{name} {at}", at, stiffness, 200.0 * np.eye(2)) for at in (0.0, 0.3)]
        lateral = solve_lateral_modes(rotor, [bearing.mean_support for bearing in held], count=4)
        basis = add_attachment_modes(lateral, forces_at=[0.0, 0.1, 0.3])
        parts.append(
            rotor_component(
                name, ModalRotor(basis, solve_torsional_modes(rotor, count=2)), start=0.0, damping_ratio=0.01
            )
        )
        bearings += [MountedBearing(bearing, name, bearing.name if housing else None) for bearing in held]
        seats |= {bearing.name: 0.2 * rng.normal(size=(4, 6)) for bearing in held}
        z |= {bearing.name: bearing.at for bearing in held}
        mounted.append(MountedGear(wheels[number].name, name, 0.1, (number * pair.working_centre_distance, 0.0)))
    omega = np.array([900.0, 1700.0, 2600.0, 4000.0])
    plate = HousingComponent(
        name="plate",
        kinds=("housing",) * 4,
        stiffness=np.diag(omega**2),
        damping=np.diag(0.02 * omega),
        gyroscopic=np.zeros((4, 4)),
        seats=seats,
        seat_z=z,
        sensors={name: 0.2 * rng.normal(size=4) for name in ("top", "side")},
    )
    mesh = GearMesh(mounted[0], mounted[1], pair, tooth_contact(pair, ConstantStiffness(2e8)))
    return assemble_machine(
        parts,
        plate if housing else None,
        speeds={"fast": speed, "slow": -0.4 * speed},
        bearings=bearings,
        meshes=[mesh],
        loads=MachineLoads(unbalances=[Unbalance("fast", 0.1, 3e-4, 0.7)]),
    )


def test_gear_pair_in_closed_form() -> None:
    """Two inertias, one mesh: F = (k + iwc)(x - e) with (k - m w² + iwc) x = (k + iwc) e and 1/m = 1/a + 1/b."""
    inertia, radius, k, c = np.array([0.01, 0.04]), np.array([0.05, 0.08]), 1e7, 150.0
    law = ToothContact(1.0, piecewise.constant(k, 1.0), piecewise.constant(0.0, 1.0), c)
    direction = radius / np.sqrt(inertia)
    parts = tuple(Component(name, ("torsion",), *np.zeros((3, 1, 1))) for name in ("a", "b"))
    system = CoupledSystem(parts, (0.0, 0.0), contacts=(ContactConnector("m", direction, law, 0.0, 0.0, NO_ERRORS),))
    pair = geared(1.0).meshes
    bare = CoupledMachine((), None, (), pair, system)
    mass = 1.0 / np.sum(direction**2)
    modes = coupled_modes(system)
    w = resonance_grid(modes, 100.0, 1e5)
    assert modes.frequencies_hz[1] == pytest.approx(np.sqrt(k / mass) / (2.0 * np.pi), rel=1e-9)
    law_of_mesh = k + 1j * w * c
    motion = law_of_mesh / (law_of_mesh - mass * w**2)
    for chosen in (None, modes):
        found = mesh_error_response(bare, w, modes=chosen)
        np.testing.assert_allclose(found.mesh_force["m"], law_of_mesh * (motion - 1.0), rtol=1e-9)


@pytest.mark.parametrize("cross", [0.0, 5e5])
def test_superposition_is_the_solution(cross: float) -> None:
    machine = geared(300.0, cross=cross)
    modes = coupled_modes(machine.system)
    w = resonance_grid(modes, 50.0, 2e5)
    by_modes, direct = (mesh_error_response(machine, w, modes=chosen) for chosen in (modes, None))
    for name in ("sensor_acceleration", "bearing_force", "mesh_force"):
        for one, other in zip(getattr(by_modes, name).values(), getattr(direct, name).values(), strict=True):
            np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-10 * np.abs(other).max())
    by_modes, direct = (sensor_force_response(machine, w, sensor="top", modes=chosen) for chosen in (modes, None))
    scale = np.abs(direct.coordinates).max()
    np.testing.assert_allclose(by_modes.coordinates, direct.coordinates, rtol=0.0, atol=1e-10 * scale)


def test_basis_error_by_solving_at_every_frequency() -> None:
    """Twice the largest relative difference of two machines within 1.5 % of a frequency, here by direct solution."""
    ours, others = geared(300.0), geared(300.0, cross=4e6)
    frequencies = np.array([650.0, 1500.0, 2500.0])
    found = BasisError(ours, others).at(frequencies)
    assert list(found) == ["top", "side"]
    for number, w in enumerate(frequencies):
        near = w * (1.0 + np.linspace(-0.015, 0.015, 7))
        for name, values in found.items():
            motions = [
                receptance(one.system, one.sensor_rows[name][None], one.system.contacts[0].direction[None], near)
                for one in (ours, others)
            ]
            apart = np.abs(motions[1] - motions[0]) / np.abs(motions[0])
            assert values[number] == pytest.approx(np.clip(2.0 * apart.max(), 0.005, 10.0), rel=1e-7)


def test_reciprocity() -> None:
    """Force here, motion there: the same the other way, with the shafts turning the other way."""
    one, other = geared(300.0), geared(-300.0)
    # The push of the teeth turns its direction with the sense of rotation; the springs must not, so it is kept.
    kept = replace(other.system, contacts=one.system.contacts)
    rows = np.random.default_rng(5).normal(size=(3, one.system.size))
    w = np.array([200.0, 900.0, 4000.0])
    there = receptance(one.system, rows[:1], rows[1:], w)
    back = receptance(kept, rows[1:], rows[:1], w)
    np.testing.assert_allclose(there, back.transpose(0, 2, 1), rtol=1e-9)
    # Without the reversal the gyroscopic terms tell the two ways apart.
    same_sense = receptance(one.system, rows[1:], rows[:1], w).transpose(0, 2, 1)
    assert np.abs(there - same_sense).max() > 1e-6 * np.abs(there).max()
    hammered = sensor_force_response(one, w, sensor="side").sensor_acceleration["top"]
    turned = sensor_force_response(replace(other, system=kept), w, sensor="top").sensor_acceleration["side"]
    np.testing.assert_allclose(turned, hammered, rtol=1e-9)


def test_mesh_and_bearing_forces_move_the_rotors() -> None:
    """Newton's second law of each shaft as a whole, and the third between them: m a = ±F e - Σ bearing forces.

    What a rotor's mass times the acceleration of its centre is, is taken from the rigid motion that its basis holds.
    """
    machine = geared(300.0, housing=False)
    w = np.linspace(300.0, 6000.0, 40)
    found = mesh_error_response(machine, w)
    force = next(iter(found.mesh_force.values()))
    mesh = machine.meshes[0]
    angle = mesh.geometry.line_of_action_angle(0.0, 1)
    start = 0
    for rotor, sign in zip(machine.rotors, (-1.0, 1.0), strict=True):
        q = found.coordinates[:, start : start + rotor.size]
        start += rotor.size
        for axis in (0, 1):
            at = np.linspace(0.0, 0.3, 7)
            rows = np.array([rotor.direction(float(place), axis) for place in at])
            # Of all coordinates that move every section by one, the free ones: those without strain.
            null = np.flatnonzero(np.diag(rotor.stiffness) == 0.0)
            free = np.zeros(rotor.size)
            free[null] = np.linalg.lstsq(rows[:, null], np.ones(7), rcond=1e-10)[0]
            np.testing.assert_allclose(rows @ free, 1.0, atol=1e-6)
            assert free @ free == pytest.approx(2.0 + 0.3 * np.pi / 4 * 0.03**2 * 7810.0, rel=1e-6)
            inertia = -(w**2) * (q @ free)
            push = sign * force * (np.cos(angle) if axis == 0 else np.sin(angle))
            held = sum(found.bearing_force[f"{rotor.name} {place}"][:, axis] for place in (0.0, 0.3))
            np.testing.assert_allclose(inertia, push - held, rtol=0.0, atol=1e-6 * np.abs(push).max())


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_unbalance_against_the_rotor_alone(sense: float) -> None:
    """A mesh that is hardly there: each bearing of the unbalanced shaft carries what the rotor room says.

    A bow and a ripple of torque at the speed of the shaft are no unbalances.
    """
    machine = geared(300.0, housing=False)
    loose = replace(machine.meshes[0], contact=tooth_contact(machine.meshes[0].geometry, ConstantStiffness(1.0)))
    bow = BowReactions("fast", np.array([0.05, 0.15, 0.25]), np.array([-500.0, 1000.0 + 200.0j, -500.0 - 200.0j]))
    loads = replace(machine.loads, bows=[bow], torques=[TorqueRipple("fast", 0.1, 50.0, order=1.0)])
    alone = replace(machine, meshes=(loose,), loads=loads)
    speeds = sense * np.array([100.0, 350.0, 800.0])
    found = unbalance_response(alone, speeds, rotor="fast")
    rotor = Rotor("fast", [Segment(0.3, 0.03, 0.0, STEEL)], [Disc(0.1, 2.0, 0.004, 0.002)])
    held = [one.bearing for one in machine.bearings if one.rotor == "fast"]
    exact = rotor_unbalance_response(rotor, held, [RotorUnbalance(0.1, 3e-4, 0.7)], speeds)
    for bearing in held:
        x, y = (part[:, 0] for part in exact.reading([bearing.at]))
        motion = np.array([x, y]).T
        force = motion @ bearing.radial_stiffness.T + 1j * speeds[:, None] * motion @ bearing.radial_damping.T
        # The shaft's own damping is in the coupled system alone.
        np.testing.assert_allclose(found.bearing_force[bearing.name], force, rtol=0.0, atol=3e-4 * np.abs(force).max())


def test_contact_of_an_instant_carries_the_error() -> None:
    machine = geared(300.0)
    pressed = replace(machine.system, load=1e3 * machine.system.contacts[0].direction)
    state = contact_at(pressed, 0.0)
    w = np.array([500.0, 2000.0])
    one, mean = mesh_error_response(machine, w, contact=state), mesh_error_response(machine, w)
    np.testing.assert_allclose(one.mesh_force["p -> w"], mean.mesh_force["p -> w"], rtol=1e-9)
    apart = replace(state, stiffness=0.0 * state.stiffness)
    with pytest.raises(CouplingError, match="does not touch"):
        mesh_error_response(machine, w, contact=apart)


def test_what_is_not_there() -> None:
    machine = geared(300.0, housing=False)
    with pytest.raises(CouplingError, match="gear mesh number 1 of 1"):
        mesh_error_response(machine, np.ones(1), mesh=1)
    with pytest.raises(CouplingError, match="no sensor 'top'; there are: none"):
        sensor_force_response(machine, np.ones(1), sensor="top")
    with pytest.raises(CouplingError, match="'slow' has no unbalance"):
        unbalance_response(machine, [100.0], rotor="slow")
    with pytest.raises(CouplingError, match="expected 0 < from < to"):
        resonance_grid(coupled_modes(machine.system), 2.0, 1.0)
