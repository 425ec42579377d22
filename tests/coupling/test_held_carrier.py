"""Planetary sets whose carrier is held against the same machine of parallel shafts, whose planets sit in a body.

The body is the carrier on its bearings and its torque support, put together here with rigid arms to the pins: nothing
of the machine of parallel shafts knows of a carrier, of planets or of a set.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from own_statics import FULL
from plane_planetary_set import STEEL, equal_angles, plane_set
from planetary_machines import MODULE, set_parts

from gearwhine.coupling import Machine
from gearwhine.coupling.description.gear_train import Output
from gearwhine.coupling.description.parts import TorqueSupport
from gearwhine.coupling.description.planetary import PlanetarySet
from gearwhine.coupling.gears import SquareStiffness
from gearwhine.coupling.machine.components import HousingComponent, RotorComponent
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.coupling.time.settings import TransientSettings
from gearwhine.coupling.time.transient import simulate
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import Bearing
from gearwhine.rotors.analyses.static_stiffness import static_shaft

SUPPORT = 2e6  # N m/rad, of the carrier
SPEED, TORQUE = 300.0, 80.0
HELIX = np.radians(12.0)
TEETH = SquareStiffness(2e8)


@cache
def plane() -> Machine:
    """Spur gears on bearings that hold their shafts in the plane, the pins on either side of the gears."""
    parts = plane_set(
        equal_angles(3),
        pressure_angle=np.radians(20.0),
        with_ring=True,
        damping=1e-5,
        material=STEEL,
        diameter=0.05,
        mode_count=1,
    )
    law = np.diag([5e7, 5e7, 1e7, 1e3, 1e3])
    held = [
        replace(one, bearing=Bearing(one.bearing.name, one.bearing.at, law, 1e-5 * law)) for one in parts["bearings"]
    ]
    planets = tuple(f"planet gear {number}" for number in (1, 2, 3))
    return Machine(
        **parts
        | {
            "bearings": held,
            "gear_pairs": [replace(one, stiffness=TEETH) for one in parts["gear_pairs"]],
            "torque_supports": [TorqueSupport("carrier", 0.05, stiffness=SUPPORT)],
            "outputs": [Output("ring")],
            "planetary_sets": [PlanetarySet("stage", planets, "carrier", sun="sun gear", ring="ring gear")],
            "speed": SPEED,
            "torque": TORQUE,
        }
    )


@cache
def spatial() -> Machine:
    """Helical gears on bearings with all cross terms, the carrier beside them and the pins beyond its end."""
    parts = set_parts(distance=0.5 * MODULE * 54 / np.cos(HELIX), held="c")
    right = {"s": 1.0}
    gears = [
        replace(one, gear=replace(one.gear, helix_angle=right.get(one.name, -1.0) * HELIX)) for one in parts["gears"]
    ]
    held = [
        replace(one, bearing=Bearing(one.bearing.name, one.bearing.at, FULL, 1e-5 * FULL)) for one in parts["bearings"]
    ]
    support = TorqueSupport("c", 0.03, stiffness=SUPPORT)
    pairs = [replace(one, stiffness=TEETH) for one in parts["gear_pairs"]]
    return Machine(**parts | {"gears": gears, "bearings": held, "gear_pairs": pairs, "torque_supports": [support]})


def in_parallel(machine: Machine, body: HousingComponent) -> Machine:
    """The machine with its planets in a body."""
    (support,) = machine.torque_supports
    planets = [one.name for one in machine.shafts if one.carrier is not None]
    return replace(
        machine,
        shafts=[replace(one, carrier=None) for one in machine.shafts if one.name != support.shaft],
        bearings=[
            replace(one, seat=one.bearing.name) if one.rotor in planets else one
            for one in machine.bearings
            if one.rotor != support.shaft
        ],
        torque_supports=(),
        planetary_sets=(),
        housing=body,
    )


def body_of(
    machine: Machine,
    section: Callable[[float], FloatArray],
    own: tuple[FloatArray, FloatArray],
) -> HousingComponent:
    """The carrier as a body.

    Parameters
    ----------
    machine
    section
        Motion of a section at a distance from the carrier's left end along and about x, y, z by n coordinates, (6, n).
    own
        Stiffness and damping of the carrier alone, (n, n) each.
    """
    (support,) = machine.torque_supports
    carrier = machine.shaft(support.shaft)
    stiffness, damping = (matrix.copy() for matrix in own)
    seats, seat_z = {}, {}
    for one in machine.bearings:
        if one.rotor == carrier.name:
            rows = section(one.bearing.at)[:5]
            stiffness += rows.T @ one.bearing.spatial_stiffness @ rows
            damping += rows.T @ one.bearing.spatial_damping @ rows
        planet = machine.shaft(one.rotor)
        if planet.carrier is not None:
            z = planet.start + one.bearing.at
            at = min(max(z - carrier.start, 0.0), carrier.rotor.length)
            arm = np.array([*np.subtract(planet.axis, carrier.axis), z - carrier.start - at])
            moved = section(at)
            # v + w x r
            along = moved[:3] + np.array([np.cross(turned, arm) for turned in moved[3:].T]).T
            seats[one.bearing.name], seat_z[one.bearing.name] = np.concatenate([along, moved[3:]]).T, z
    turned = section(support.at)[5]
    stiffness += support.stiffness * np.outer(turned, turned)
    damping += support.damping_time * support.stiffness * np.outer(turned, turned)
    n = len(stiffness)
    return HousingComponent(
        "body", ("housing",) * n, stiffness, damping, np.zeros((n, n)), seats=seats, seat_z=seat_z, sensors={}
    )


def in_motion(machine: Machine) -> Machine:
    """The machine of parallel shafts, its body by the carrier's modes."""
    (support,) = machine.torque_supports
    carrier = next(one for one in machine.rotor_components() if one.name == support.shaft)
    assert isinstance(carrier, RotorComponent)

    def section(at: float) -> FloatArray:
        return np.vstack([carrier.motions(at), carrier.rotation(at)])

    return in_parallel(machine, body_of(machine, section, (carrier.stiffness, carrier.damping)))


def at_rest(machine: Machine) -> Machine:
    """The machine of parallel shafts, its body by the exact stiffness between the carrier's stations."""
    (support,) = machine.torque_supports
    carrier = machine.shaft(support.shaft)
    places = [one.bearing.at for one in machine.bearings if one.rotor == carrier.name]
    for one in machine.bearings:
        planet = machine.shaft(one.rotor)
        if planet.carrier is not None:
            places.append(min(max(planet.start + one.bearing.at - carrier.start, 0.0), carrier.rotor.length))
    exact = static_shaft(machine.rotor(carrier.name), [*places, support.at])

    def section(at: float) -> FloatArray:
        rows = np.zeros((6, len(exact.stiffness)))
        first = 6 * exact.node(at)
        rows[:, first : first + 6] = np.eye(6)
        return rows

    return in_parallel(machine, body_of(machine, section, (exact.stiffness, 0.0 * exact.stiffness)))


MACHINES = pytest.mark.parametrize("made", [plane, spatial])


@MACHINES
def test_operating_point_is_that_of_parallel_shafts(made: Callable[[], Machine]) -> None:
    one, other = made().operating_point(), at_rest(made()).operating_point()
    for pair, expected in zip(one.pairs, other.pairs, strict=True):
        assert pair.names == expected.names
        assert pair.force == pytest.approx(expected.force, rel=1e-9)
        assert pair.k_h_beta == pytest.approx(expected.k_h_beta, rel=1e-9)
        assert pair.approach == pytest.approx(expected.approach, rel=0, abs=1e-9 * np.abs(expected.approach).max())
    pressed = max(np.abs(bearing.force).max() for bearing in other.bearings)
    for bearing in other.bearings:
        assert one.bearing(bearing.name).force == pytest.approx(bearing.force, rel=0, abs=1e-9 * pressed)
    largest = max(np.abs(shaft.displacement).max() for shaft in other.shafts)
    for shaft in other.shafts:
        assert one.shaft(shaft.name).displacement == pytest.approx(shaft.displacement, rel=0, abs=1e-9 * largest)


@MACHINES
def test_modes_are_those_of_parallel_shafts(made: Callable[[], Machine]) -> None:
    found, expected = made().modes().eigenvalues, in_motion(made()).modes().eigenvalues
    assert len(found) == len(expected)
    for value in expected:
        assert np.abs(found - value).min() < 1e-9 * abs(value) + 1e-6


@pytest.mark.parametrize("made", [plane, pytest.param(spatial, marks=pytest.mark.slow)])
def test_motion_is_that_of_parallel_shafts(made: Callable[[], Machine]) -> None:
    """Over four mesh periods from static equilibrium.

    Of planets the time integration lets modes of shafts above their limit respond statically; here none does.
    """
    machine = made()
    period = 1.0 / machine.mesh_frequencies[0]
    settings = TransientSettings(
        duration=4.0 * period, record_from=0.0, sample_interval=period / 64, largest_step=period / 64, tolerance=1e-3
    )
    motions = []
    for one in (machine.assembled, in_motion(machine).assembled):
        parts = tuple(
            replace(part, carrier=None) if isinstance(part, RotorComponent) else part for part in one.system.components
        )
        result = simulate(replace(one.system, components=parts), settings, transient_outputs(one))
        motions.append(histories(one, result))
    found, expected = motions
    for name, force in expected.mesh_force.items():
        assert np.ptp(force) > 1e-3 * force.max()
        assert found.mesh_force[name] == pytest.approx(force, rel=0, abs=1e-9 * np.abs(force).max())
    for name, load in expected.bearing_load.items():
        assert found.bearing_load[name] == pytest.approx(load, rel=0, abs=1e-9 * TORQUE / 0.01)
