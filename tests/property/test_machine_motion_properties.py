"""Laws of motion of whole machines: Newton's third law through gears and bearings, and no frame that counts.

Two geared rotors with gyroscopic discs on unsymmetric bearings in a free rigid housing, put together by
:func:`gearwhine.coupling.assemble_machine` and marched in time, teeth entering and leaving contact.
"""

from functools import cache

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwhine.coupling import (
    CoupledMachine,
    GearMesh,
    MachineLoads,
    MountedBearing,
    MountedGear,
    Torque,
    TransientOutputs,
    TransientSettings,
    Unbalance,
    assemble_machine,
    simulate,
)
from gearwhine.coupling.gears import Gear, GearPairGeometry, PotentialEnergyStiffness, tooth_contact
from gearwhine.coupling.machine.components import HousingComponent, RotorComponent, rotor_component
from gearwhine.coupling.time.histories import Histories, histories, transient_outputs
from gearwhine.numerics.arrays import FloatArray
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
from gearwhine.rotors.modes.residual_modes import add_attachment_modes

few = settings(deadline=None, max_examples=6)
angles = st.floats(-3.1, 3.1)

STEEL = ShaftMaterial.from_poisson_ratio(207e9, 0.3, 7850.0)
LENGTH, GEAR_AT, SPEED, TORQUE = 0.3, 0.12, 300.0, 90.0
MASS, INERTIA = 20.0, 0.7  # of the housing, the latter about every axis through the origin


def free_rotor(name: str, disc: float) -> RotorComponent:
    """On the free shaft's modes, which hold its rigid motions exactly, and what bearings and gear add."""
    shaft = Rotor(name, [Segment(0.1, 0.04, 0.0, STEEL)] * 3, [Disc(GEAR_AT, disc, 0.004 * disc, 0.0025 * disc)])
    lateral = add_attachment_modes(solve_lateral_modes(shaft, count=4), forces_at=[0.0, LENGTH, GEAR_AT])
    modal = ModalRotor(lateral, solve_torsional_modes(shaft, count=3), None)
    return rotor_component(name, modal, start=-0.15, damping_ratio=0.01)


@cache
def both_rotors() -> tuple[RotorComponent, RotorComponent]:
    """Solved when a test asks, not on import: every process that shares the tests would compile for it at once."""
    return free_rotor("input", 2.0), free_rotor("output", 5.0)


def pair(turned: float) -> GearPairGeometry:
    """Eccentric gears, the offsets turned by an angle."""
    gears = (
        Gear(name, teeth, 3e-3, np.radians(20.0), 0.02, eccentricity=1e-5, eccentricity_phase=phase + turned)
        for name, teeth, phase in (("pinion", 24, 0.3), ("wheel", 36, -1.0))
    )
    return GearPairGeometry(*gears, 90.3e-3)


def seat(centre: FloatArray) -> FloatArray:
    """Motions at a point of the housing by its three translations and three rotations, of mass one each."""
    motion = np.zeros((6, 6))
    for axis, unit in enumerate(np.eye(3)):
        motion[axis, :3] = unit / np.sqrt(MASS)
        motion[3 + axis, :3] = np.cross(unit, centre) / np.sqrt(INERTIA)
        motion[3 + axis, 3:] = unit / np.sqrt(INERTIA)
    return motion


def plane_turn(angle: float) -> FloatArray:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def machine(seed: int, sense: int, psi: float, *, turned: float = 0.0, unbalanced: bool = True) -> CoupledMachine:
    """The line of centres at an angle psi; everything turned about z by another."""
    rng, turn, geometry = np.random.default_rng(seed), plane_turn(turned), pair(turned)
    centre = rng.normal(0.0, 0.1, 2)
    line = geometry.working_centre_distance * np.array([np.cos(psi), np.sin(psi)])
    axes = {"input": turn @ centre, "output": turn @ (centre + line)}
    bearings, seats = [], {}
    for rotor in both_rotors():
        for end, at in (("front", 0.0), ("back", LENGTH)):
            name = f"{rotor.name} {end}"
            seats[name] = np.array([*axes[rotor.name], rotor.start + at])
            root = rng.normal(size=(2, 2))
            law = 2e7 * (root @ root.T + np.eye(2)) + rng.uniform(-5e6, 5e6) * np.array([[0.0, 1.0], [-1.0, 0.0]])
            bearing = Bearing(name, at, turn @ law @ turn.T, 1e-5 * (turn @ law @ turn.T))
            bearings.append(MountedBearing(bearing, rotor.name, name))
    gears = [MountedGear(f"{name} gear", name, GEAR_AT, (axis[0], axis[1])) for name, axis in axes.items()]
    zeros = np.zeros((6, 6))
    kinds = ("housing",) * 6
    seat_z = {name: float(place[2]) for name, place in seats.items()}
    motions = {name: seat(place) for name, place in seats.items()}
    masses = (Unbalance("input", 0.2, 3e-5, 0.4 + turned), Unbalance("output", 0.1, 8e-5, -2.0 + turned))
    return assemble_machine(
        both_rotors(),
        HousingComponent("housing", kinds, zeros, zeros, zeros, motions, seat_z, {}),
        speeds={"input": sense * SPEED, "output": -sense * SPEED / geometry.ratio},
        bearings=bearings,
        meshes=[GearMesh(*gears, geometry, tooth_contact(geometry, PotentialEnergyStiffness(), 300.0), 4e-5)],
        loads=MachineLoads(
            unbalances=masses if unbalanced else (),
            torques=[Torque("input", 0.0, sense * TORQUE), Torque("output", LENGTH, sense * TORQUE * geometry.ratio)],
        ),
    )


def settings_of(duration: float, tolerance: float) -> TransientSettings:
    return TransientSettings(duration, 0.0, 2e-5, 1e-4, tolerance=tolerance)


def from_rest(of: CoupledMachine) -> tuple[FloatArray, FloatArray]:
    """A free machine has no equilibrium: straight shafts and teeth that just touch, and the torque comes on at once."""
    return np.zeros(of.system.size), np.zeros(of.system.size)


def whole_motions(of: CoupledMachine) -> FloatArray:
    """Coordinates that move everything as one body along x, along y and about z, shape (3, n)."""
    axes = {gear.rotor: gear.axis for gear in (of.meshes[0].driver, of.meshes[0].driven)}
    coordinates = []
    for rotor in of.rotors:
        places = np.linspace(0.0, LENGTH, 15)
        rows = np.array([row for at in places for row in (*rotor.motions(at)[:2], rotor.rotation(at))])
        x, y = axes[rotor.name]
        wanted = np.tile([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-y, x, 1.0]], len(places))
        solution, *_ = np.linalg.lstsq(rows, wanted.T, rcond=1e-10)
        np.testing.assert_allclose(rows @ solution, wanted.T, atol=1e-9)
        coordinates.append(solution.T)
    own = np.zeros((3, 6))
    own[0, 0] = own[1, 1] = np.sqrt(MASS)
    own[2, 5] = np.sqrt(INERTIA)
    return np.hstack([*coordinates, own])


@few
@given(st.integers(0, 2**32 - 1), st.sampled_from([1, -1]), angles)
def test_momentum_of_a_free_machine(seed: int, sense: int, psi: float) -> None:
    """Teeth, bearings and gyroscopic moments leave linear momentum alone; angular momentum grows by the torques."""
    of = machine(seed, sense, psi, unbalanced=False)
    rows = whole_motions(of)
    n = of.system.size
    outputs = TransientOutputs(np.empty((0, n)), np.vstack([rows, np.eye(n)]), np.empty((0, n)))
    result = simulate(of.system, settings_of(0.01, 1e-3), outputs, initial=from_rest(of))
    drive = result.force[:, 0]
    assert drive.max() > TORQUE / of.meshes[0].geometry.driver.base_radius
    momenta, rates = result.velocity[:, :3], result.velocity[:, 3:]
    torque = sense * TORQUE * (1.0 + of.meshes[0].geometry.ratio)
    expected = result.times[:, None] * np.array([0.0, 0.0, torque])
    # What single coordinates carry is the measure of what cancels.
    np.testing.assert_allclose(momenta, expected, atol=1e-8 * np.abs(rows).max() * np.abs(rates).max())


def moved(of: CoupledMachine) -> Histories:
    result = simulate(of.system, settings_of(0.005, 1e-5), transient_outputs(of), initial=from_rest(of))
    return histories(of, result)


@few
@given(st.integers(0, 2**32 - 1), st.sampled_from([1, -1]), angles, angles)
def test_a_machine_turned_about_z_moves_the_same_way_turned(seed: int, sense: int, psi: float, turned: float) -> None:
    """Gears, bearings' axes, unbalance and eccentricity turned with it; the pair's phase too is the same."""
    here, there = moved(machine(seed, sense, psi)), moved(machine(seed, sense, psi, turned=turned))
    turn = plane_turn(turned)
    for name, force in here.mesh_force.items():
        np.testing.assert_allclose(there.mesh_force[name], force, atol=2e-3 * max(force.max(), 1.0))
    for name, motion in here.gear_motion.items():
        expected = np.column_stack([motion[:, :2] @ turn.T, motion[:, 2]])
        scale = np.abs(expected).max(axis=0)
        assert np.all(np.abs(there.gear_motion[name] - expected).max(axis=0) < 2e-3 * scale.max(initial=0.0))
    for name, force in here.bearing_force.items():
        np.testing.assert_allclose(there.bearing_force[name], force @ turn.T, atol=2e-3 * np.abs(force).max())
