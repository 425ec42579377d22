"""Helical gears in the coupled system: motions that strain no mesh, and the thrust and moments that bearings take."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helical_pairs import helical

import gearwhine as gw
from gearwhine.coupling import (
    GearMesh,
    MachineLoads,
    MountedBearing,
    MountedGear,
    Torque,
    assemble_machine,
    static_equilibrium,
)
from gearwhine.coupling.gears import GearError, PotentialEnergyStiffness, load_gear_pair, tooth_contact
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.machine.components import rotor_component
from gearwhine.rotors import Bearing, Rotor, Segment, ShaftMaterial, modal_rotor

STEEL = ShaftMaterial.from_poisson_ratio(2.1e11, 0.3, 7850.0)
SHAFT = Rotor("", [Segment(0.1, 0.05, 0.0, STEEL)] * 4)
ANGLE = math.radians(18.0)
TORQUE = 200.0


def machine(hand: float, sense: int, line: float = 0.6):  # type: ignore[no-untyped-def]
    """Two shafts on two bearings each, the left ones holding along z as well; gears in the middle."""
    pair = helical(hand, ANGLE)
    distance = pair.working_centre_distance
    held = [
        Bearing("left", 0.0, np.diag([2e8, 2e8, 3e8, 0.0, 0.0]), np.zeros((5, 5))),
        Bearing("right", 0.4, np.diag([2e8, 2e8]), np.zeros((2, 2))),
    ]
    rotors, bearings = [], []
    for name in ("one", "two"):
        rotors.append(rotor_component(name, modal_rotor(SHAFT, held, count=10, gears_at=[0.2]), start=0.0))
        bearings += [MountedBearing(bearing, name, None) for bearing in held]
    axis = (distance * math.cos(line), distance * math.sin(line))
    contact = tooth_contact(pair, PotentialEnergyStiffness(), corner_contact=True, faces=face_slices(pair, sense=sense))
    mesh = GearMesh(
        MountedGear("pinion", "one", 0.2, (0.0, 0.0)), MountedGear("wheel", "two", 0.2, axis), pair, contact
    )
    ratio = pair.ratio
    return assemble_machine(
        rotors,
        None,
        speeds={"one": sense * 100.0, "two": -sense * 100.0 / ratio},
        bearings=bearings,
        meshes=[mesh],
        loads=MachineLoads(torques=[Torque("one", 0.2, sense * TORQUE), Torque("two", 0.2, sense * TORQUE * ratio)]),
    )


def forces_on(parts, rotor: int) -> np.ndarray:  # type: ignore[no-untyped-def]
    """Force of a shaft's bearings on it at static equilibrium: x, y, z of the left one, x, y of the right one."""
    q = static_equilibrium(parts.system, 0.0)
    total = [-connector.stiffness @ connector.directions.T @ q for connector in parts.system.linear]
    return np.concatenate(total[2 * rotor : 2 * rotor + 2])


@pytest.mark.parametrize("hand", [1.0, -1.0])
@pytest.mark.parametrize("sense", [1, -1])
def test_bearings_carry_thrust_and_its_moment(hand: float, sense: int) -> None:
    parts = machine(hand, sense)
    pair = parts.meshes[0].geometry
    tangential = TORQUE / pair.driver.base_radius  # along the transverse line of action
    thrust = tangential * math.tan(pair.driver.base_helix_angle)
    for rotor, side in ((0, 1.0), (1, -1.0)):
        left, right = np.split(forces_on(parts, rotor), [3])
        # The teeth push the driver along -n, n = e - s tan(beta_b) z; the bearings answer.
        assert left[2] == pytest.approx(-side * sense * thrust, rel=1e-6)
        # Moments about the left end, by statics: radial force half way, thrust at the pitch point.
        line = 0.6
        towards = side * np.array([math.cos(line), math.sin(line)])
        angle = pair.line_of_action_angle(line, sense)
        push = side * tangential * np.array([math.cos(angle), math.sin(angle)])
        radius = pair.working_pitch_radii[rotor]
        # The teeth's own force on the shaft has the axial part +side s tan(beta_b) F, at r.
        on_shaft = side * sense * thrust
        expected = 0.5 * push + on_shaft * radius * towards / 0.4
        # Corner contact shifts the load's mean place along the face by some hundredths of a millimetre.
        np.testing.assert_allclose(right, expected, rtol=0.0, atol=5e-4 * tangential)
        np.testing.assert_allclose(left[:2] + right, push, rtol=1e-6, atol=1e-6 * tangential)


def test_a_screw_along_its_own_helix_strains_no_mesh() -> None:
    parts = machine(1.0, 1)
    driver = parts.rotors[0]
    contact = parts.system.contacts[0].direction[: driver.size]
    turn = driver.rotation(0.2)
    along = driver.motions(0.2)[2]
    # Unit turn, and what its lead takes it forward: a rigid motion in rotation and axial coordinates alone.
    gear = parts.meshes[0].geometry.driver
    rows = np.array([turn, along])
    q = np.linalg.lstsq(rows, np.array([1.0, gear.lead / (2.0 * math.pi)]), rcond=None)[0]
    lateral = driver.motions(0.2)[[0, 1, 3, 4]]
    np.testing.assert_allclose(lateral @ q, 0.0, atol=1e-12)
    assert contact @ q == pytest.approx(0.0, abs=1e-9)
    back = np.linalg.lstsq(rows, np.array([1.0, -gear.lead / (2.0 * math.pi)]), rcond=None)[0]
    assert contact @ back == pytest.approx(2.0 * gear.base_radius, rel=1e-9)


@pytest.mark.parametrize("stiffening", [1.0, 1e6])
def test_transmission_error_is_that_of_the_flanks_as_the_equilibrium_misaligns_them(stiffening: float) -> None:
    """Of shafts and bearings that hardly yield, it is that of the aligned pair by itself."""
    steel, angle = replace(gw.STEEL, youngs_modulus=2.1e11 * stiffening), math.radians(12.0)
    bearing = np.diag([2e8, 2e8, 1e8, 0.0, 0.0]) * stiffening
    gears = [
        gw.Gear(name, teeth, 3e-3, math.radians(20.0), 0.03, helix_angle=helix, bore=0.03)
        for name, teeth, helix in (("a", 27, angle), ("b", 41, -angle))
    ]
    axes = {"i": (0.0, 0.0), "o": (1.5e-3 * (27 + 41) / math.cos(angle), 0.0)}
    described = gw.Machine(
        [gw.Shaft(gw.Rotor(name, [gw.Segment(0.1, 0.03, 0.0, steel)]), axis=axis) for name, axis in axes.items()],
        [
            gw.MountedBearing(gw.Bearing(f"{name}{at}", at, bearing, np.zeros((5, 5))), name, None)
            for name in axes
            for at in (0.02, 0.08)
        ],
        [gw.ShaftGear(gear, name, at=0.05) for gear, name in zip(gears, axes, strict=True)],
        [gw.GearPair("a", "b")],
        speed=100.0,
        torque=300.0,
    )
    point = described.operating_point()
    (load,), (pair,) = point.pairs, described.at_operating_point(point).loaded_pairs()
    error = load.peak_to_peak_transmission_error
    assert error == pytest.approx(pair.static.peak_to_peak_transmission_error, rel=1e-9)
    alone = load_gear_pair(gw.GearPair("a", "b"), described.pair_geometries[0], torque=300.0)
    away = error / alone.static.peak_to_peak_transmission_error - 1.0
    assert abs(away) < 1e-5 if stiffening > 1.0 else abs(away) > 5e-3
    with pytest.raises(GearError, match="expected the inertias that rotate with its gears"):
        _ = alone.contact
