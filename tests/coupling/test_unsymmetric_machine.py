"""The library's calls on a machine with nothing alike and nothing at zero: three shafts, two meshes, a plate.

The first and the last shaft turn alike, the bearings' matrices are not symmetric, one bearing stands on a pedestal, the
ground shakes, and every kind of load acts.
"""

from dataclasses import fields
from functools import cache

import numpy as np
import numpy.typing as npt
import pytest

from gearwhine.coupling import (
    BaseMotion,
    CoupledMachine,
    GearMesh,
    MachineLoads,
    MountedBearing,
    MountedGear,
    Torque,
    Unbalance,
    assemble_machine,
    receptance,
)
from gearwhine.coupling.gears import ConstantStiffness, Gear, GearPairGeometry, tooth_contact
from gearwhine.coupling.linear.frequency_response import mesh_error_response, unbalance_response
from gearwhine.coupling.machine.base_motion import BaseHarmonic, BaseHistory
from gearwhine.coupling.machine.components import HousingComponent, pedestal_component, rotor_component
from gearwhine.coupling.machine.loads import BowReactions, Drive, TorqueRipple
from gearwhine.coupling.machine.shaft_dashpots import ShaftDashpots
from gearwhine.rotors import Bearing, Disc, Pedestal, Rotor, Segment, ShaftMaterial, modal_rotor
from gearwhine.rotors.analyses.harmonic_response import frequency_response

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
SHAFTS = ("one", "two", "three")
TEETH = {"one": 24, "two": 31, "three": 24}
STARTS = {"one": -0.07, "two": -0.02, "three": 0.05}
TABLE = np.array([100.0, 400.0])
"""Of the second shaft's bearings [rad/s]."""
PEDESTAL = Pedestal(np.array([[5e7, 9e6], [-4e6, 3e7]]), np.array([[900.0, 50.0], [-30.0, 700.0]]), 6.0)
SPEED = 260.0


def bearings_of(name: str) -> list[Bearing]:
    """Two, of which those of the second shaft change with its speed; the last one of all stands on a pedestal."""
    number = SHAFTS.index(name)
    stiffness = np.array([[4e7 + 1e6 * number, 8e6], [-3e6, 3e7]])
    damping = np.array([[300.0, 40.0], [-90.0, 200.0 + 10.0 * number]])
    if name == "two":
        table = np.array([stiffness, 1.6 * stiffness])
        return [Bearing(f"two {at}", at, table, damping, TABLE) for at in (0.02, 0.28)]
    return (
        [
            Bearing("three 0.0", 0.0, stiffness, damping),
            Bearing("three 0.3", 0.3, 1.2 * stiffness, damping, pedestal=PEDESTAL),
        ]
        if name == "three"
        else [Bearing(f"one {at}", at, (1.0 + at) * stiffness, damping) for at in (0.0, 0.25)]
    )


@cache
def parts() -> tuple[tuple[object, ...], HousingComponent]:
    """Shafts and plate, which are the same at every speed."""
    found = []
    for name in SHAFTS:
        disc = Disc(0.12, 2.0 + 0.3 * len(name), 0.004, 0.002)
        rotor = Rotor(name, [Segment(0.2, 0.03, 0.0, STEEL), Segment(0.12, 0.025, 0.0, STEEL)], [disc])
        held = [bearing.at_speed(200.0) for bearing in bearings_of(name)]
        modal = modal_rotor(rotor, held, count=4, gears_at=[0.12 - STARTS[name]], forces_at=[0.05, 0.1, 0.17])
        axis = {"one": (0.0, 0.02), "two": (0.0825, 0.02), "three": (0.165, 0.02)}[name]
        found.append(rotor_component(name, modal, start=STARTS[name], damping_ratio=0.01, axis=axis))
    rng = np.random.default_rng(5)
    seats = {bearing.name: 0.2 * rng.normal(size=(4, 6)) for name in ("one", "two") for bearing in bearings_of(name)}
    heights = {
        bearing.name: STARTS[name] + bearing.at + 0.01 for name in ("one", "two") for bearing in bearings_of(name)
    }
    omega = np.array([900.0, 1700.0, 2600.0, 4000.0])
    plate = HousingComponent(
        name="plate",
        kinds=("housing",) * 4,
        stiffness=np.diag(omega**2),
        damping=np.diag(0.02 * omega),
        gyroscopic=np.zeros((4, 4)),
        seats=seats,
        seat_z=heights,
        sensors={name: 0.2 * rng.normal(size=4) for name in ("top", "side")},
        participation=rng.normal(size=(4, 6)),
    )
    return tuple(found), plate


def machine(speed: float = SPEED, unbalanced: tuple[str, ...] = SHAFTS) -> CoupledMachine:
    """Coupled at a speed of the first shaft."""
    rotors, plate = parts()
    wheels = {
        name: Gear(f"gear {name}", TEETH[name], 0.003, np.radians(20.0), face_width=0.02, eccentricity=size,
                   eccentricity_phase=phase)
        for name, size, phase in (("one", 3e-6, 0.4), ("two", 5e-6, -1.1), ("three", 4e-6, 2.0))
    }  # fmt: skip
    axes = {name: rotor.axis for name, rotor in zip(SHAFTS, rotors, strict=True)}  # type: ignore[attr-defined]
    at = {name: 0.12 - STARTS[name] for name in SHAFTS}
    meshes = []
    for driver, driven, stiffness in (("one", "two", 2e8), ("two", "three", 1.3e8)):
        pair = GearPairGeometry(wheels[driver], wheels[driven])
        mounted = [MountedGear(wheels[name].name, name, at[name], axes[name]) for name in (driver, driven)]
        meshes.append(GearMesh(mounted[0], mounted[1], pair, tooth_contact(pair, ConstantStiffness(stiffness))))
    speeds = {"one": speed, "two": -speed * 24 / 31, "three": speed}
    shaking = BaseHarmonic(300.0, np.array([1.0, 2.0j, 0.0, 3.0 - 1.0j, 5.0, 0.0]))
    history = BaseHistory(np.array([0.0, 0.2]), np.array([[0.0, 1.0, 0.0, 0.0, 0.0, 0.0], [2.0] + [0.0] * 5]))
    return assemble_machine(
        rotors,  # type: ignore[arg-type]
        plate,
        speeds=speeds,
        bearings=[
            MountedBearing(bearing, name, None if name == "three" else bearing.name)
            for name in SHAFTS
            for bearing in bearings_of(name)
        ],
        meshes=meshes,
        dashpots=[ShaftDashpots("coupling 1 of two", "two", 0.05, 0.1, 90.0, 3.0, 2.0, 40.0)],
        loads=MachineLoads(
            unbalances=[
                Unbalance(name, 0.1, 1e-4 * (number + 1), 0.7 + number)
                for number, name in enumerate(SHAFTS)
                if name in unbalanced
            ],
            bows=[BowReactions("one", np.array([0.05, 0.17]), np.array([30.0 + 8.0j, -30.0 - 8.0j]))],
            torques=[
                Torque("one", 0.0, 20.0),
                Torque("three", 0.3, -20.0),
                TorqueRipple("one", 0.0, 3.0, 0.3, order=2.0),
            ],
            drives=[Drive("one", 0.0)],
            base=BaseMotion((shaking, history), (0.1, -0.2, 0.3)),
            gravity=(1.0, -9.0, 2.0),
        ),
    )


@pytest.mark.parametrize("speed", [150.0, 410.0, -230.0])
def test_a_machine_at_another_speed_is_the_one_built_there(speed: float) -> None:
    turned, built = machine().at_speed(speed), machine(speed)
    assert turned.speeds == pytest.approx(built.speeds, rel=1e-14)
    assert turned.dashpots == built.dashpots
    for name in ("unbalances", "drives", "gravity"):
        assert getattr(turned.loads, name) == getattr(built.loads, name)
    assert list(turned.loads.torques) == list(built.loads.torques)
    for name in ("stiffness", "damping", "load"):
        expected = getattr(built.system, name)
        np.testing.assert_allclose(
            getattr(turned.system, name), expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max()
        )
    assert len(turned.system.harmonic_loads) == len(built.system.harmonic_loads) > 4
    for one, other in zip(turned.system.harmonic_loads, built.system.harmonic_loads, strict=True):
        assert one.frequency == pytest.approx(other.frequency, rel=1e-14)
        np.testing.assert_allclose(one.amplitude, other.amplitude, rtol=1e-12)
    assert len(turned.system.timed_loads) == len(built.system.timed_loads) > 0
    for one, other in zip(turned.system.timed_loads, built.system.timed_loads, strict=True):
        for field in fields(one):
            np.testing.assert_allclose(getattr(one, field.name), getattr(other, field.name), rtol=1e-12)
    for one, other in zip(turned.system.contacts, built.system.contacts, strict=True):
        assert (one.mesh_frequency, one.phase) == pytest.approx((other.mesh_frequency, other.phase))
        np.testing.assert_allclose(one.errors, other.errors, rtol=1e-12)
        np.testing.assert_allclose(one.direction, other.direction, rtol=1e-12)
    assert (turned.system.acceleration_load is None) == (built.system.acceleration_load is None)
    if built.system.acceleration_load is not None:
        np.testing.assert_allclose(turned.system.acceleration_load, built.system.acceleration_load, rtol=1e-12)


def test_runout_of_both_gears_moves_them_along_the_line_of_action() -> None:
    """e_err = -e (ε_driver - ε_driven), ε (cos, sin)(Ωt + phase); e at the pressure angle off the tangent."""
    parts_of = machine()
    for contact, mesh, sense in zip(parts_of.system.contacts, parts_of.meshes, (1.0, -1.0), strict=True):
        line = np.subtract(mesh.driven.axis, mesh.driver.axis)
        n = line / np.hypot(*line)
        tangent = sense * np.array([-n[1], n[0]])
        push = np.cos(np.radians(20.0)) * tangent + np.sin(np.radians(20.0)) * n
        for time in (0.0, 0.0013, 0.02):
            expected = 0.0
            for side, mounted, gear in (
                (1.0, mesh.driver, mesh.geometry.driver),
                (-1.0, mesh.driven, mesh.geometry.driven),
            ):
                angle = parts_of.speeds[mounted.rotor] * time + gear.eccentricity_phase
                expected -= side * gear.eccentricity * float(push @ [np.cos(angle), np.sin(angle)])
            found = sum(size * np.cos(rate * time + phase) for size, rate, phase in contact.errors)
            assert found == pytest.approx(expected, abs=1e-9)


def test_a_pedestal_off_the_origin_feels_the_base_turn() -> None:
    """-√m (a + α × r) along x and y, r from the point that the base's acceleration is told at."""
    parts_of = machine()
    names = [part.name for part in parts_of.system.components]
    sizes = [part.size for part in parts_of.system.components]
    first = sum(sizes[: names.index("three 0.3")])
    (shaken,) = (one for one in parts_of.system.harmonic_loads if one.frequency == 300.0)
    assert parts_of.loads.base is not None
    (harmonic, _) = parts_of.loads.base.parts
    assert isinstance(harmonic, BaseHarmonic)
    place = np.array([0.165, 0.02, STARTS["three"] + 0.3]) - [0.1, -0.2, 0.3]
    moved = harmonic.amplitude[:3] + np.cross(harmonic.amplitude[3:], place)
    np.testing.assert_allclose(shaken.amplitude[first : first + 2], -np.sqrt(6.0) * moved[:2], rtol=1e-12)
    # And its own weight.
    np.testing.assert_allclose(
        parts_of.system.load[first : first + 2], np.sqrt(6.0) * np.array([1.0, -9.0]), rtol=1e-12
    )


def test_a_pedestal_yields_by_its_own_matrices() -> None:
    part = pedestal_component("foot", PEDESTAL)
    moved = part.motion @ np.linalg.solve(part.stiffness, part.motion.T @ [3.0, -5.0])
    np.testing.assert_allclose(moved, np.linalg.solve(PEDESTAL.stiffness, [3.0, -5.0]), rtol=1e-12)
    damped = part.motion @ np.linalg.solve(part.damping, part.motion.T @ [3.0, -5.0])
    np.testing.assert_allclose(damped, np.linalg.solve(PEDESTAL.damping, [3.0, -5.0]), rtol=1e-12)


def test_responses_to_a_mesh_error_are_the_parts_forces() -> None:
    """Bearings by their own matrices over the relative motion; a mesh by its compression, the error its own."""
    parts_of, w = machine(), np.array([700.0, 1500.0, 2900.0])
    names = [part.name for part in parts_of.system.components]
    cuts = np.cumsum([0, *(part.size for part in parts_of.system.components)])
    for number in range(2):
        found = mesh_error_response(parts_of, w, mesh=number)

        def of(name: str, q: npt.NDArray[np.complex128] = found.coordinates) -> npt.NDArray[np.complex128]:
            which = names.index(name)
            return q[:, cuts[which] : cuts[which + 1]]

        for mounted in parts_of.bearings:
            rotor = parts_of.rotors[SHAFTS.index(mounted.rotor)]
            relative = of(rotor.name) @ rotor.motions(mounted.bearing.at)[:2].T
            if mounted.seat is not None:
                assert parts_of.housing is not None
                seat = parts_of.housing.seat_motions(mounted.seat, rotor.start + mounted.bearing.at)
                relative = relative - of("plate") @ seat[:2].T
            elif mounted.bearing.pedestal is not None:
                relative = relative - of(mounted.bearing.name) @ (np.eye(2) / np.sqrt(6.0))
            law = mounted.bearing.at_speed(parts_of.speeds[mounted.rotor])
            dynamic = law.stiffness + 1j * w[:, None, None] * law.damping
            expected = np.einsum("fij,fj->fi", dynamic, relative)
            np.testing.assert_allclose(found.bearing_load[mounted.bearing.name][:, :2], expected, rtol=1e-9)
        for which, contact in enumerate(parts_of.system.contacts):
            pressed = found.coordinates @ contact.direction - (which == number)
            stiffness = found.mesh_force[contact.name] / pressed
            np.testing.assert_allclose(stiffness.real, (2e8, 1.3e8)[which], rtol=1e-2)
        assert parts_of.housing is not None
        for sensor, row in parts_of.housing.sensors.items():
            np.testing.assert_allclose(found.sensor_acceleration[sensor], -(w**2) * (of("plate") @ row), rtol=1e-12)


def test_unbalances_of_one_shaft_alone() -> None:
    """Though another turns as fast; w is that shaft's own signed speed."""
    whole = machine()
    for name in SHAFTS:
        found = unbalance_response(whole, [200.0, 350.0], rotor=name)
        ratio = -24 / 31 if name == "two" else 1.0
        np.testing.assert_allclose(found.frequencies, np.array([200.0, 350.0]) * ratio)
        alone = unbalance_response(machine(unbalanced=(name,)), [200.0, 350.0], rotor=name)
        np.testing.assert_allclose(
            found.coordinates, alone.coordinates, rtol=1e-9, atol=1e-12 * np.abs(alone.coordinates).max()
        )


def test_receptance_has_a_row_for_each_output_and_is_conjugate_at_negative_frequency() -> None:
    system = machine().system
    rng = np.random.default_rng(2)
    outputs, inputs = rng.normal(size=(3, system.size)), rng.normal(size=(2, system.size))
    ahead = receptance(system, outputs, inputs, np.array([800.0, 1900.0]))
    assert ahead.shape == (2, 3, 2)
    back = receptance(system, outputs, inputs, np.array([-800.0, -1900.0]))
    np.testing.assert_allclose(back, ahead.conj(), rtol=1e-9)
    single = receptance(system, outputs[2:], inputs[1:], np.array([800.0, 1900.0]))
    np.testing.assert_allclose(ahead[:, 2:, 1:], single, rtol=1e-12)


def test_receptances_of_a_shaft_have_a_row_for_each_place_read() -> None:
    rotor = Rotor("shaft", [Segment(0.4, 0.03, 0.0, STEEL)], [Disc(0.3, 3.0, 0.004, 0.002)])
    held = [Bearing(str(at), at, np.array([[4e6, 8e5], [-3e5, 3e6]]), 50.0 * np.eye(2)) for at in (0.0, 0.4)]
    loaded, read = [(0.1, "x"), (0.2, "y"), (0.3, "x")], [(0.05, "y"), (0.35, "x")]
    found = frequency_response(rotor, held, loaded, read, [300.0, 900.0], speed=200.0)
    assert found.shape == (2, 2, 3)
    for i, place in enumerate(read):
        for j, load in enumerate(loaded):
            one = frequency_response(rotor, held, [load], [place], [300.0, 900.0], speed=200.0)
            np.testing.assert_allclose(found[:, i, j], one[:, 0, 0], rtol=1e-9)


def test_bearings_have_planes_of_their_own_and_tables_for_either_sense() -> None:
    tilting = Bearing("b", 0.1, np.diag([1e7, 2e7, 3e7, 4e4, 5e4]), np.zeros((5, 5)))
    # The slope in x is the rotation about y.
    for direction, stiffness, tilt in ((0, 1e7, 5e4), (1, 2e7, 4e4)):
        support = tilting.plane_support(direction)
        assert tuple(getattr(support, field.name) for field in fields(support))[:3] == (0.1, stiffness, tilt)
    tabled = bearings_of("two")[0]
    np.testing.assert_array_equal(tabled.at_speed(-250.0).stiffness, tabled.at_speed(250.0).stiffness)
    assert not np.array_equal(tabled.at_speed(250.0).stiffness, tabled.at_speed(100.0).stiffness)
