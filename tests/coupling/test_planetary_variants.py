"""Planetary sets of other kinds: helical, on rolling bearings, with tooth friction, two in series, by closed forms."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from planetary_machines import AXIS, MODULE, gear, planets, set_parts, shaft, spring

from gearwhine.coupling import Machine, MountedBearing
from gearwhine.coupling.description.parts import TorqueSupport
from gearwhine.coupling.description.planetary import PlanetarySet
from gearwhine.coupling.gears import GearPairGeometry, SquareStiffness
from gearwhine.coupling.linear.complex_modes import stability
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.coupling.time.settings import TransientSettings
from gearwhine.coupling.time.transient import TransientResult, simulate
from gearwhine.rotors import Bearing
from gearwhine.rotors.rolling_bearings import catalogue_bearing

SUN, PLANET, RING, COUNT = 24, 30, 84, 3
HELIX = np.radians(12.0)
LAW = np.diag([1e8, 1e8, 5e7, 2e4, 2e4])
FRICTION = 0.06
BALLS = catalogue_bearing("deep-groove", 0.020, 0.042, 0.012, clearance=2e-6)


def on_springs(one: MountedBearing) -> MountedBearing:
    return replace(one, bearing=Bearing(one.bearing.name, one.bearing.at, LAW, 1e-5 * LAW))


@cache
def helical() -> Machine:
    parts = set_parts(distance=0.5 * MODULE * (SUN + PLANET) / np.cos(HELIX))
    right = {"s": 1.0}
    gears = [
        replace(one, gear=replace(one.gear, helix_angle=right.get(one.name, -1.0) * HELIX)) for one in parts["gears"]
    ]
    return Machine(**parts | {"gears": gears, "bearings": list(map(on_springs, parts["bearings"]))})


@cache
def on_balls() -> Machine:
    """Planets on deep-groove ball bearings, of which one of each holds its shaft along the axis."""
    parts = set_parts()
    held = [
        MountedBearing.from_elements(
            one.bearing.name, one.bearing.at, one.rotor, None, replace(BALLS, floating=one.bearing.at > 0.03)
        )
        if one.rotor.startswith("p")
        else on_springs(one)
        for one in parts["bearings"]
    ]
    return Machine(**parts | {"bearings": held})


@cache
def in_series() -> Machine:
    """The carrier of the first set is the shaft of the second sun."""
    drum = math.ceil(MODULE * (RING + 12) * 1e3) * 1e-3
    carriers = [shaft("c 1", 0.1, 0.18), shaft("c 2", 0.32)]
    shafts = [shaft("s"), shaft("r 1", bore=drum), shaft("r 2", 0.22, bore=drum), *carriers]
    gears = [gear("s 1", "s", SUN), replace(gear("s 2", "c 1", SUN), at=0.15)]
    gears += [gear(f"r {stage}", f"r {stage}", -RING) for stage in (1, 2)]
    places = {one.name: (0.02, 0.08) if one.name == "c 1" else (0.01, 0.05) for one in shafts}
    held = [MountedBearing(Bearing(f"{on} {at}", at, LAW, 1e-5 * LAW), on, None) for on in places for at in places[on]]
    pairs, sets = [], []
    for stage, carrier in enumerate(carriers, start=1):
        made = planets(PLANET, 0.5 * MODULE * (SUN + PLANET), carrier, [("s", "p"), ("p", "r")])
        own = {f"p {number}": f"p {stage}{number}" for number in range(1, COUNT + 1)}
        shafts += [
            replace(one, rotor=replace(one.rotor, name=own[one.name]), start=0.22 * (stage - 1)) for one in made.shafts
        ]
        gears += [replace(one, gear=replace(one.gear, name=own[one.name]), shaft=own[one.shaft]) for one in made.gears]
        held += [
            MountedBearing(Bearing(f"{name} {at}", at, LAW, 1e-5 * LAW), name, None)
            for name in own.values()
            for at in (0.01, 0.05)
        ]
        pairs += [spring(f"s {stage}", name) for name in own.values()]
        pairs += [spring(name, f"r {stage}") for name in own.values()]
        sets.append(
            PlanetarySet(f"stage {stage}", tuple(own.values()), carrier.name, sun=f"s {stage}", ring=f"r {stage}")
        )
    return Machine(
        shafts=shafts,
        gears=gears,
        bearings=held,
        gear_pairs=pairs,
        planetary_sets=sets,
        torque_supports=[TorqueSupport("r 1"), TorqueSupport("r 2")],
        speed=100.0,
        torque=20.0,
    )


@cache
def rubbing() -> Machine:
    """Spur gears with tooth friction, whose pairs of teeth share the load in equal parts."""
    parts = set_parts(count=2)
    pairs = [replace(one, stiffness=SquareStiffness(2e8), friction=FRICTION) for one in parts["gear_pairs"]]
    return Machine(**parts | {"gear_pairs": pairs})


@cache
def point_of(made: Callable[[], Machine]) -> OperatingPoint:
    return made().operating_point()


KINDS = pytest.mark.parametrize("made", [helical, on_balls, in_series])


@KINDS
def test_forces_on_teeth_and_pins_are_those_of_the_torques(made: Callable[[], Machine]) -> None:
    """T / (n r_b) on every mesh of a sun with the torque T, 2 T / (n r) along the circle on every pin.

    The radial forces of sun and ring on a planet cancel; its centrifugal force is left.
    """
    machine, point = made(), point_of(made)
    helix = machine.gears[0].gear.helix_angle
    radius = 0.5 * MODULE * SUN / math.cos(helix)
    base = radius * math.cos(math.atan(math.tan(math.radians(20.0)) / math.cos(helix)))
    for stage, placed in enumerate(machine.placed_sets):
        torque = machine.torque * (1.0 + RING / SUN) ** stage
        of_set = [pair for pair in point.pairs if set(pair.names) & set(placed.of.planets)]
        assert [pair.force for pair in of_set] == pytest.approx([torque / COUNT / base] * 2 * COUNT, rel=2e-3)
        forces = np.array([sum(pair.force for pair in of_set if name in pair.names) for name in placed.of.planets])
        assert forces.sum() == pytest.approx(2.0 * torque / base, rel=1e-9)
        along_circle = 0.0
        for name in placed.planet_shafts:
            on_pin = np.sum([load.force[:3] for load in point.bearings if load.mounted.rotor == name], axis=0)
            outward = np.subtract(machine.shaft(name).axis, AXIS) / math.dist(machine.shaft(name).axis, AXIS)
            distance = math.dist(machine.shaft(name).axis, AXIS)
            circling = machine.rotor(name).mass * distance * machine.speeds[placed.of.carrier] ** 2
            assert on_pin[:2] @ outward == pytest.approx(circling, abs=2e-3 * torque / radius)
            # Thrusts of sun and ring on a planet are opposite.
            assert on_pin[2] == pytest.approx(0.0, abs=1e-3 * torque / radius)
            along_circle += float(on_pin[:2] @ np.array([-outward[1], outward[0]])) * distance
        assert along_circle == pytest.approx(torque * (1.0 + RING / SUN), rel=1e-9)
    thrust = sum(load.force[2] for load in point.bearings if load.mounted.rotor == "s")
    # The fingers of the right hand along the rotation of a right-hand driver, the thumb shows its thrust.
    assert thrust == pytest.approx(machine.torque / radius * math.tan(helix), abs=1e-9 * machine.torque / radius)


@pytest.mark.parametrize("made", [helical, on_balls, pytest.param(in_series, marks=pytest.mark.slow)])
def test_the_rotation_as_a_whole_is_free_and_no_mode_grows(made: Callable[[], Machine]) -> None:
    modes = made().modes()
    assert np.sum(modes.eigenvalues == 0.0) == 1
    assert stability(modes).growing == ()


def over(machine: Machine, periods: int) -> TransientResult:
    """Motion over some mesh periods from static equilibrium."""
    period = 1.0 / min(machine.mesh_frequencies)
    settings = TransientSettings(
        duration=periods * period,
        record_from=0.0,
        sample_interval=period / 32,
        largest_step=period / 64,
        tolerance=2e-3,
    )
    return simulate(machine.assembled.system, settings, transient_outputs(machine.assembled))


@pytest.mark.slow
@KINDS
def test_nothing_excites_a_set_of_mesh_springs_in_motion(made: Callable[[], Machine]) -> None:
    """Forces stay those of the equilibrium as planets circle: their torques balance at every instant."""
    machine = made()
    found = histories(machine.assembled, over(machine, 4))
    for pair in point_of(made).pairs:
        force = found.mesh_force[pair.label]
        assert force == pytest.approx(np.full(len(force), pair.force), rel=1e-5)


def test_teeth_do_not_slide_at_the_pitch_point_of_planets() -> None:
    """The sliding velocity grows from there with the difference of the speeds over the path of contact."""
    machine = rubbing()
    speeds = {one.name: machine.speeds[one.shaft] for one in machine.gears}
    base_pitch = math.pi * MODULE * math.cos(math.radians(20.0))
    for contact, pair in zip(machine.assembled.system.contacts, machine.gear_pairs, strict=False):
        assert contact.sliding is not None
        at_start, along = contact.sliding.nominal
        assert at_start + contact.sliding.friction.pitch_point * along == pytest.approx(0.0, abs=1e-9 * abs(along))
        assert abs(along) == pytest.approx(base_pitch * abs(speeds[pair.driver] - speeds[pair.driven]), rel=1e-9)


def loss_factor(pair: GearPairGeometry) -> float:
    """Loss over rolling power and coefficient of friction, π |1/z1 + 1/z2| (1 - ε + ε1² + ε2²).

    Niemann & Winter, Maschinenelemente 2, 2003, section 21.11: pairs in touch share the load in equal parts.
    """
    lengths = []
    for one in (pair.driver, pair.driven):
        base = 0.5 * MODULE * one.teeth * math.cos(math.radians(20.0))
        tip = math.copysign(math.sqrt(one.tip_radius**2 - base**2), one.teeth)
        lengths.append((tip - base * math.tan(math.radians(20.0))) / (math.pi * MODULE * math.cos(math.radians(20.0))))
    teeth = abs(1.0 / pair.driver.teeth + 1.0 / pair.driven.teeth)
    return math.pi * teeth * (1.0 - sum(lengths) + sum(one**2 for one in lengths))


@pytest.mark.slow
def test_friction_of_a_set_takes_the_loss_of_its_rolling_power() -> None:
    """The power that passes through the meshes is that which the carrier sees, T (ω_s - ω_c)."""
    machine, periods = rubbing(), 2
    result = over(machine, periods)
    rolling = machine.torque * (machine.speeds["s"] - machine.speeds["c"])
    factors = sum(map(loss_factor, {pair.driven.teeth: pair for pair in machine.pair_geometries}.values()))
    time = periods / machine.mesh_frequencies[0]
    assert result.energy.friction == pytest.approx(FRICTION * factors * rolling * time, rel=0.01)
