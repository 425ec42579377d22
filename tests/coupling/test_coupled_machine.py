"""A machine of rotors, housing, bearings and gears: equal and opposite forces, directions, frames, static balance."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy import linalg

from gearwhine.coupling import (
    CoupledMachine,
    CouplingError,
    GearMesh,
    MachineLoads,
    MountedBearing,
    MountedGear,
    Torque,
    Unbalance,
    assemble_machine,
    coupled_modes,
    static_equilibrium,
)
from gearwhine.coupling.gears import ConstantStiffness, Gear, GearPairGeometry, tooth_contact
from gearwhine.coupling.machine.components import HousingComponent, RotorComponent, rotor_component
from gearwhine.coupling.statics.mean_mesh import mean_contact
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import (
    Bearing,
    Disc,
    ModalRotor,
    Rotor,
    Segment,
    ShaftMaterial,
    solve_axial_modes,
    solve_lateral_modes,
    solve_torsional_modes,
)
from gearwhine.rotors.modes.residual_modes import add_attachment_modes

STEEL = ShaftMaterial.from_poisson_ratio(207e9, 0.3, 7850.0)
PRESSURE_ANGLE = np.radians(20.0)
PAIR = GearPairGeometry(
    Gear("pinion", 24, 3e-3, PRESSURE_ANGLE, 0.02), Gear("wheel", 36, 3e-3, PRESSURE_ANGLE, 0.02), 90.3e-3
)
DISTANCE = PAIR.working_centre_distance
MESH_STIFFNESS = 2e8
BACKLASH = 40e-6
SPEED = 300.0
LENGTH = 0.3
# Both gears lie in the plane z = -30 mm.
START = {"input": -0.15, "output": -0.13}
GEAR_AT = {"input": 0.12, "output": 0.10}
BEARINGS_AT = (0.0, LENGTH)


def free_rotor(name: str, disc: float, *, along: bool = False) -> RotorComponent:
    """On the free shaft's modes, which hold its two rigid motions exactly, and what bearings and gear add.

    Where bearings resist it the shaft also moves ``along`` its axis.
    """
    at = GEAR_AT[name]
    shaft = Rotor(name, [Segment(0.1, 0.04, 0.0, STEEL)] * 3, [Disc(at, disc, 0.004 * disc, 0.0025 * disc)])
    lateral = add_attachment_modes(solve_lateral_modes(shaft, count=5), forces_at=[*BEARINGS_AT, at])
    axial = solve_axial_modes(shaft, count=3) if along else None
    return rotor_component(name, ModalRotor(lateral, solve_torsional_modes(shaft, count=4), axial), start=START[name])


@cache
def both_rotors(*, along: bool = False) -> tuple[RotorComponent, RotorComponent]:
    """Solved when a test asks, not on import: every process that shares the tests would compile for it at once."""
    return free_rotor("input", 2.0, along=along), free_rotor("output", 5.0, along=along)


# Over x, y, z and the rotations about x and y, positive definite, with an arm between forces and moments.
TILTING = np.array(
    [
        [5e7, 0.4e7, 1e6, 1e5, -6e5],
        [0.4e7, 4e7, 2e6, 5e5, 1e5],
        [1e6, 2e6, 1e7, 3e4, 2e4],
        [1e5, 5e5, 3e4, 4e4, 2e3],
        [-6e5, 1e5, 2e4, 2e3, 5e4],
    ]
)


def rigid_housing(centres: dict[str, FloatArray]) -> HousingComponent:
    """A free rigid body of 20 kg: three translations and three rotations about the origin, of mass one."""
    mass, inertia = 20.0, 0.7
    seats = {}
    for name, centre in centres.items():
        motion = np.zeros((6, 6))
        for axis in range(3):
            unit = np.eye(3)[axis]
            motion[axis, :3] = unit / np.sqrt(mass)
            motion[3 + axis, :3] = np.cross(unit, centre) / np.sqrt(inertia)
            motion[3 + axis, 3:] = unit / np.sqrt(inertia)
        seats[name] = motion
    seat_z = {name: float(centre[2]) for name, centre in centres.items()}
    zeros = np.zeros((6, 6))
    return HousingComponent("housing", ("housing",) * 6, zeros, zeros, zeros, seats, seat_z, {})


def machine(
    *,
    psi: float = 0.3,
    sense: int = 1,
    torque: float = 0.0,
    stiffness: FloatArray | None = None,
    housing: bool = False,
    backlash: float | None = None,
    unbalances: tuple[Unbalance, ...] = (),
) -> CoupledMachine:
    """Two rotors; the line of centres from driver to driven at an angle psi, the torque with the rotation."""
    matrix = 5e7 * np.eye(2) if stiffness is None else stiffness
    rotors = both_rotors(along=matrix.shape != (2, 2))
    axes = {"input": np.zeros(2), "output": DISTANCE * np.array([np.cos(psi), np.sin(psi)])}
    bearings, centres = [], {}
    for rotor in rotors:
        for end, at in zip(("front", "back"), BEARINGS_AT, strict=True):
            name = f"{rotor.name} {end}"
            # Seats whose centres are not where the bearings are: the housing's rotation counts.
            centres[name] = np.array([*axes[rotor.name], rotor.start + at + 0.011])
            bearing = Bearing(name, at, matrix, 1e-5 * matrix)
            bearings.append(MountedBearing(bearing, rotor.name, name if housing else None))
    gears = [MountedGear(f"{name} gear", name, GEAR_AT[name], (axis[0], axis[1])) for name, axis in axes.items()]
    mesh = GearMesh(gears[0], gears[1], PAIR, tooth_contact(PAIR, ConstantStiffness(MESH_STIFFNESS)), backlash)
    return assemble_machine(
        rotors,
        rigid_housing(centres) if housing else None,
        speeds={"input": sense * SPEED, "output": -sense * SPEED / PAIR.ratio},
        bearings=bearings,
        meshes=[mesh],
        loads=MachineLoads(
            unbalances=unbalances,
            torques=[Torque("input", 0.0, sense * torque), Torque("output", LENGTH, sense * torque * PAIR.ratio)],
        ),
    )


def rigid_motion(parts: CoupledMachine, translation: FloatArray, rotation: FloatArray) -> FloatArray:
    """Coordinates that move everything as one body: u = t + r × (x, y, z)."""
    coordinates = []
    axes = {gear.rotor: gear.axis for gear in (parts.meshes[0].driver, parts.meshes[0].driven)}
    for rotor in parts.rotors:
        axis = axes[rotor.name]
        places = np.linspace(0.0, LENGTH, 15)
        rows, wanted = [], []
        for at in places:
            moved = translation + np.cross(rotation, [*axis, rotor.start + at])
            rows += [rotor.direction(at, 0), rotor.direction(at, 1), rotor.rotation(at)]
            wanted += [moved[0], moved[1], rotation[2]]
            if rotor.modal.axial is not None:
                rows.append(rotor.motions(at)[2])
                wanted.append(moved[2])
        solution, *_ = np.linalg.lstsq(np.array(rows), np.array(wanted), rcond=1e-10)
        np.testing.assert_allclose(np.array(rows) @ solution, wanted, atol=1e-9)
        coordinates.append(solution)
    if parts.housing is not None:
        coordinates.append(np.concatenate([translation * np.sqrt(20.0), rotation * np.sqrt(0.7)]))
    return np.concatenate(coordinates)


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("psi", [0.0, 0.3, 2.0, -2.5])
@pytest.mark.parametrize("stiffness", [None, TILTING], ids=["radial", "five motions"])
def test_a_rigid_motion_deflects_nothing(psi: float, sense: int, stiffness: FloatArray | None) -> None:
    """So the forces of bearings and gears have no resultant force or moment, about any axis: Newton's third law."""
    parts = machine(psi=psi, sense=sense, housing=True, backlash=BACKLASH, stiffness=stiffness)
    assert parts.system.linear[0].directions.shape[1] == (2 if stiffness is None else 5)
    rng = np.random.default_rng(3)
    for translation, rotation in ((rng.normal(size=3), np.zeros(3)), (np.zeros(3), rng.normal(size=3))):
        q = rigid_motion(parts, translation, rotation)
        for connector in parts.system.linear:
            np.testing.assert_allclose(connector.directions.T @ q, 0.0, atol=1e-9)
        assert len(parts.system.contacts) == 2
        for contact in parts.system.contacts:
            assert abs(contact.direction @ q) < 1e-9
    # And the check can fail: the deflections of one part alone are not zero.
    q[: parts.rotors[0].size] = 0.0
    assert abs(parts.system.contacts[0].direction @ q) > 1e-3


@pytest.mark.parametrize("matrix", [None, TILTING], ids=["radial", "five motions"])
def test_free_machine_has_its_rigid_motions(matrix: FloatArray | None) -> None:
    """Six of the body, of which z moves radial bearings' housing alone, and the train's own rotation of the shafts."""
    parts = machine(housing=True, stiffness=matrix)
    stiffness = parts.system.mean_stiffness
    np.testing.assert_allclose(stiffness, stiffness.T, rtol=0.0, atol=1e-12 * np.abs(stiffness).max())
    values = np.linalg.eigvalsh(0.5 * (stiffness + stiffness.T))
    zero = np.abs(values) < 1e-9 * values[-1]
    # x, y, z, about x, about y, about z, and the train: 7.
    assert zero.sum() == 7
    assert values[~zero].min() > 0.0


@pytest.mark.parametrize("angle", [0.4, np.pi / 2.0, 2.9])
@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("tilting", [False, True])
def test_frame_rotation(angle: float, sense: int, tilting: bool) -> None:
    """The machine turned about z, its bearings' axes with it, has the same eigenvalues."""
    stiffness = np.array([[5e7, 1e7], [-0.3e7, 3e7]])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    if tilting:
        stiffness, turn = TILTING, linalg.block_diag(turn, 1.0, turn)
    one = coupled_modes(machine(psi=0.3, sense=sense, stiffness=stiffness).system)
    turned = machine(psi=0.3 + angle, sense=sense, stiffness=turn @ stiffness @ turn.T)
    two = coupled_modes(turned.system)
    low = 25
    np.testing.assert_allclose(two.eigenvalues[1:low], one.eigenvalues[1:low], rtol=1e-6)
    assert two.kinds[:low] == one.kinds[:low]
    # Turning the gears alone is another machine.
    three = coupled_modes(machine(psi=0.3 + angle, sense=sense, stiffness=stiffness).system)
    assert np.abs(three.eigenvalues[1:low] / one.eigenvalues[1:low] - 1.0).max() > 1e-3


def test_mirror() -> None:
    """Mirrored in the x-z plane the shafts turn the other way, ψ and the cross terms change sign."""
    stiffness = np.array([[5e7, 1e7], [-0.3e7, 3e7]])
    mirror = np.diag([1.0, -1.0])
    one = coupled_modes(machine(psi=0.3, sense=1, stiffness=stiffness).system)
    two = coupled_modes(machine(psi=-0.3, sense=-1, stiffness=mirror @ stiffness @ mirror).system)
    np.testing.assert_allclose(two.eigenvalues[1:25], one.eigenvalues[1:25], rtol=1e-6)


def compression(parts: CoupledMachine, q: FloatArray) -> FloatArray:
    """Of the drive flanks and, where they are, of the back flanks [m]."""
    return np.array([contact.direction @ q - contact.clearance for contact in parts.system.contacts])


def shaft_forces(parts: CoupledMachine, q: FloatArray) -> dict[str, FloatArray]:
    """Resultant of each shaft's forces on its bearings, x and y [N]."""
    total = {rotor.name: np.zeros(2) for rotor in parts.rotors}
    for mounted, connector in zip(parts.bearings, parts.system.linear, strict=True):
        total[mounted.rotor] += connector.stiffness @ (connector.directions.T @ q)
    return total


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("psi", [0.0, 2.2])
def test_torque_balance(psi: float, sense: int) -> None:
    torque = 90.0
    parts = machine(psi=psi, sense=sense, torque=torque, backlash=BACKLASH)
    q = static_equilibrium(parts.system)
    drive, back = compression(parts, q)
    force = torque / PAIR.driver.base_radius
    assert MESH_STIFFNESS * drive == pytest.approx(force, rel=1e-9)
    assert back < 0.0
    # The driver pushes the driven gear away, and the way its near side moves: up where it turns counter-clockwise
    # on the left. The working pressure angle comes from the base radii and the distance alone.
    working = np.arccos((PAIR.driver.base_radius + PAIR.driven.base_radius) / DISTANCE)
    line, across = np.array([np.cos(psi), np.sin(psi)]), np.array([-np.sin(psi), np.cos(psi)])
    expected = force * (np.sin(working) * line + sense * np.cos(working) * across)
    forces = shaft_forces(parts, q)
    np.testing.assert_allclose(forces["output"], expected, rtol=1e-8)
    np.testing.assert_allclose(forces["input"], -expected, rtol=1e-8)
    # A shaft under one torque at its end and its gear's torque twists against the latter.
    driver = both_rotors()[0]
    twist = (driver.rotation(0.0) - driver.rotation(GEAR_AT["input"])) @ q[: driver.size]
    assert np.sign(twist) == sense


@pytest.mark.parametrize("sense", [1, -1])
def test_back_flank_carries_a_reversed_torque(sense: int) -> None:
    torque, psi = 90.0, 0.3
    forward = machine(psi=psi, sense=sense, torque=torque, backlash=BACKLASH)
    reverse = machine(psi=psi, sense=sense, torque=-torque, backlash=BACKLASH)
    q = static_equilibrium(reverse.system)
    drive, back = compression(reverse, q)
    force = torque / PAIR.driver.base_radius
    assert drive < 0.0
    assert MESH_STIFFNESS * back == pytest.approx(force, rel=1e-9)
    working = PAIR.working_pressure_angle
    line, across = np.array([np.cos(psi), np.sin(psi)]), np.array([-np.sin(psi), np.cos(psi)])
    expected = force * (np.sin(working) * line - sense * np.cos(working) * across)
    np.testing.assert_allclose(shaft_forces(reverse, q)["output"], expected, rtol=1e-8)
    # Unloaded the flanks are the backlash apart.
    assert compression(forward, np.zeros(q.size)).sum() == -BACKLASH
    # Mirror of the forward load but for the gap: the same centres' motion along the line, opposite across it.
    ahead = shaft_forces(forward, static_equilibrium(forward.system))["output"]
    assert ahead @ line == pytest.approx(expected @ line, rel=1e-8)
    assert ahead @ across == pytest.approx(-(expected @ across), rel=1e-8)


def test_gap_in_between() -> None:
    parts = machine(torque=0.0, backlash=BACKLASH)
    q = static_equilibrium(parts.system)
    np.testing.assert_allclose(q, 0.0, atol=1e-20)
    # Turning the driver alone through the gap closes the back flanks and opens the drive flanks by as much.
    driver = both_rotors()[0]
    first = 2 * driver.modal.lateral.count
    q[first] = -BACKLASH / PAIR.driver.base_radius / driver.rotation(GEAR_AT["input"])[first]
    np.testing.assert_allclose(compression(parts, q), [-BACKLASH, 0.0], atol=1e-18)


def test_torques_that_do_not_balance() -> None:
    parts = machine(torque=90.0)
    for factor in (0.9, 1.001, -1.0):
        load = parts.system.load.copy()
        load[both_rotors()[0].size :] *= factor
        with pytest.raises(CouplingError, match="do not balance"):
            static_equilibrium(replace(parts.system, load=load))


def test_unbalance_turns_with_the_shaft() -> None:
    for sense in (1, -1):
        parts = machine(
            sense=sense, unbalances=(Unbalance("input", 0.2, 3e-5, 0.4), Unbalance("output", 0.1, 0.0, 0.0))
        )
        (load,) = parts.system.harmonic_loads
        for time in (0.0, 0.003, 0.011):
            force = (load.amplitude * np.exp(1j * load.frequency * time)).real
            angle = sense * SPEED * time + 0.4
            radial = 3e-5 * SPEED**2 * np.array([np.cos(angle), np.sin(angle)])
            rotor = both_rotors()[0]
            expected = radial[0] * rotor.direction(0.2, 0) + radial[1] * rotor.direction(0.2, 1)
            np.testing.assert_allclose(force[: rotor.size], expected, rtol=1e-9, atol=1e-9)
            np.testing.assert_array_equal(force[rotor.size :], 0.0)


def test_wrong_names() -> None:
    bearing = Bearing.isotropic("front", 0.0, 1e7)
    speeds = {"input": 1.0, "output": -1.0}
    with pytest.raises(CouplingError, match="no rotor is named 'middle'"):
        assemble_machine(both_rotors(), None, speeds=speeds, bearings=[MountedBearing(bearing, "middle", None)])
    with pytest.raises(CouplingError, match="no seat 'hole'"):
        assemble_machine(both_rotors(), None, speeds=speeds, bearings=[MountedBearing(bearing, "input", "hole")])
    with pytest.raises(CouplingError, match="no seat 'hole'"):
        assemble_machine(
            both_rotors(), rigid_housing({}), speeds=speeds, bearings=[MountedBearing(bearing, "input", "hole")]
        )
    with pytest.raises(CouplingError, match="no rotor is named 'middle'"):
        assemble_machine(both_rotors(), None, speeds=speeds, loads=MachineLoads(torques=[Torque("middle", 0.0, 1.0)]))
    with pytest.raises(CouplingError, match="no speed for output"):
        assemble_machine(both_rotors(), None, speeds={"input": 1.0})
    with pytest.raises(CouplingError, match="expected each name once"):
        assemble_machine([both_rotors()[0], both_rotors()[0]], None, speeds=speeds)


def test_linear_analyses_stand_on_the_flanks_that_the_torque_presses() -> None:
    """A machine that coasts is linear about its back flanks, under the same force along the mirrored line."""
    reverse = machine(torque=-90.0, backlash=BACKLASH)
    assert [contact.loaded for contact in reverse.system.contacts] == [False, True]
    force = 90.0 / PAIR.driver.base_radius
    state = mean_contact(reverse.system)
    np.testing.assert_allclose(state.stiffness, [0.0, MESH_STIFFNESS], rtol=1e-12)
    np.testing.assert_allclose(state.force, [0.0, force], rtol=1e-6)


def test_coasting_without_back_flanks_is_refused() -> None:
    with pytest.raises(CouplingError, match="back flanks never meet"):
        static_equilibrium(machine(torque=-90.0).system)
