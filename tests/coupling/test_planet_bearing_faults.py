"""Spalled bearings of planets: an integration of rigid bodies in the carrier's frame, and lines by kinematics.

A planet turns by Ω_p - Ω_c on its pin, with the outer ring of its bearing, while the pin's load stands still in the
carrier's frame. With γ = D / D_pw its outer raceway is struck ½ Z (1 - γ) |Ω_p - Ω_c| / 2π times in a second, the pin
½ Z (1 + γ) |Ω_p - Ω_c| / 2π times. A sensor of a housing that moves as a body has the turns of the carrier beside them.
"""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import gearwhine as gw
from gearwhine.coupling import Machine, RollingLaw, TransientOutputs, TransientSettings, simulate
from gearwhine.coupling.connector_forces.bearing_kernels import bearing_force
from gearwhine.coupling.connector_forces.kernel_arrays import bearing_arrays
from gearwhine.coupling.machine.connectors import NonlinearConnector
from gearwhine.coupling.machine.coordinates import MachineCoordinates
from gearwhine.coupling.machine.driving_frequencies import element_passes, spall_strikes
from gearwhine.coupling.signals import line_names
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import ShaftMaterial
from gearwhine.rotors.rolling_bearings import (
    BallRow,
    RollingBearing,
    RollingSpall,
    linearised_bearing,
    rolling_equilibrium,
)
from tests.machines.plane_planetary_set import (
    BEARING_STIFFNESS,
    MASS,
    MODULE,
    TEETH,
    equal_angles,
    independent_matrices,
    plane_set,
)
from tests.machines.turning_set import turning_set

ROW = BallRow(9, 8e-3, 40e-3, clearance=-4e-6, outer_turns=True)
STATE = rolling_equilibrium(RollingBearing([ROW]), [0.0, 800.0, 0.0, 0.0, 0.0], held={"z": 0.0, "rx": 0.0, "ry": 0.0})
CAGE_ANGLE, DAMPING_TIME = 0.3, 1e-5
PLANET = 2
ALONG = 2.0 * math.pi / 3.0 + 0.5 * math.pi
"""Direction in which the second planet pushes its pin at t = 0, where the carrier turns towards y."""


def with_rolling_pin(machine: Machine, *spalls: RollingSpall, in_both: bool) -> Machine:
    """The second planet on balls, with spalls in both bearings or in the left one."""
    linear = linearised_bearing(STATE, "pin", 0.0)
    bearings = [
        replace(
            mounted,
            bearing=replace(mounted.bearing, stiffness=linear.stiffness, damping=DAMPING_TIME * linear.stiffness),
            law=RollingLaw(STATE, CAGE_ANGLE, spalls if in_both or "left" in mounted.bearing.name else ()),
        )
        if mounted.rotor == f"planet {PLANET}"
        else mounted
        for mounted in machine.bearings
    ]
    return replace(machine, bearings=bearings)


def drops(spall: RollingSpall, azimuth: FloatArray, turn: float, time: float) -> FloatArray:
    """Drop of each ball into a spall, with the outer ring turning at ``turn``, the inner one at rest."""
    middle, radius = 0.5 * ROW.pitch_diameter, 0.5 * ROW.ball_diameter
    if spall.on == "element":
        spin = 0.5 * abs(turn) * (ROW.pitch_diameter / ROW.ball_diameter - ROW.ball_diameter / ROW.pitch_diameter)
        turned = np.where(np.arange(ROW.count) == spall.element, spall.azimuth + spin * time, 0.5 * math.pi)
        pairs = [(radius, middle - radius, turned), (radius, -middle - radius, turned + math.pi)]
    elif spall.on == "inner":
        pairs = [(middle - radius, radius, azimuth - spall.azimuth)]
    else:
        pairs = [(-middle - radius, radius, azimuth - spall.azimuth - turn * time)]
    total = np.zeros(ROW.count)
    for p, s, angle in pairs:
        a = np.maximum(0.5 * spall.length / abs(p) - np.abs((angle + math.pi) % (2.0 * math.pi) - math.pi), 0.0)
        free = p * (1.0 - np.cos(a)) + s - math.copysign(1.0, s) * np.sqrt(s**2 - (p * np.sin(a)) ** 2)
        total += np.minimum(free, spall.depth)
    return total


def push_on_planet(spall: RollingSpall, moved: FloatArray, turn: float, time: float) -> FloatArray:
    """Force of the balls of one bearing on the planet, whose bore has moved by (x, y) against the pin [N]."""
    cage = 0.5 * turn * (1.0 + ROW.ball_diameter / ROW.pitch_diameter)
    azimuth = CAGE_ANGLE + cage * time + 2.0 * math.pi * np.arange(ROW.count) / ROW.count
    outward = np.array([np.cos(azimuth), np.sin(azimuth)])
    # A bore that moves away from a ball leaves it room.
    deep = -outward.T @ moved - 0.5 * ROW.clearance - drops(spall, azimuth, turn, time)
    return np.asarray(outward @ (ROW.stiffness * np.maximum(deep, 0.0) ** 1.5))


@pytest.mark.parametrize("on", ["inner", "outer", "element"])
def test_the_force_on_a_planet_is_that_of_the_balls_opposite_to_its_motion(on: str) -> None:
    """Over a turn of the cage, the planet pushed along y; without the spall it is another one at times."""
    turn, push = -186.0, np.array([0.0, 9e-6, 0.0, 0.0, 0.0])
    place = {"inner": -0.5 * math.pi, "outer": 1.0, "element": 0.2}[on]
    spall = RollingSpall(on, 3e-3, 1e-4, azimuth=place, element=4 if on == "element" else 0)  # type: ignore[arg-type]
    law = RollingLaw(STATE, CAGE_ANGLE, (spall,))
    sound = replace(law, spalls=())
    made = [NonlinearConnector("pin", np.eye(5), np.arange(5), one, STATE.stiffness, turn) for one in (law, sound)]
    arrays, tangent, felt = bearing_arrays(made), np.zeros((5, 5)), []
    for time in np.linspace(0.0, 2.0 * math.pi / (0.6 * abs(turn)), 300).tolist():
        forces = np.zeros((2, 5))
        for number in range(2):
            bearing_force(arrays, number, time, push.copy(), forces[number], tangent)
        expected = -push_on_planet(spall, push[:2], turn, time)
        np.testing.assert_allclose(forces[0, :2], expected, atol=1e-6 * np.abs(forces[1]).max())
        felt.append(np.abs(forces[0] - forces[1]).max() / np.abs(forces[1]).max())
    assert np.max(felt) > 0.1


@pytest.mark.slow
@pytest.mark.parametrize(
    "spall",
    [
        RollingSpall("inner", 8e-4, 5e-6, azimuth=ALONG + math.pi),
        RollingSpall("outer", 8e-4, 5e-6, azimuth=ALONG + math.pi + 2.0),
        RollingSpall("element", 8e-4, 5e-6, azimuth=0.2, element=1),
    ],
    ids=lambda spall: spall.on,
)
def test_a_planet_on_a_damaged_pin_moves_as_rigid_bodies_in_the_carriers_frame(spall: RollingSpall) -> None:
    pressure, torque, speed = math.radians(20.0), 200.0, 300.0
    angles = equal_angles(3)
    parts = plane_set(
        angles,
        pressure_angle=pressure,
        with_ring=True,
        damping=DAMPING_TIME,
        material=ShaftMaterial(2e13, 8e12, 0.5),
        diameter=0.05,
    )
    # Dashpots on the ground would turn against the frame.
    parts["bearings"] = [
        one if one.rotor.startswith("planet") else replace(one, bearing=replace(one.bearing, damping=np.zeros((5, 5))))
        for one in parts["bearings"]
    ]
    machine = with_rolling_pin(Machine(**parts, speed=speed, torque=torque), spall, in_both=True)
    system = machine.assembled.system
    coordinates = MachineCoordinates(system.components, machine.assembled.speeds)
    rows = np.vstack(
        [coordinates.rows(name, coordinates.rotor(name).motions(0.05))[:2] for name in (f"planet {PLANET}", "ring")]
    )
    interval, duration = 5e-5, 0.012
    found = simulate(
        system,
        TransientSettings(duration, 0.0, interval, 2e-6, tolerance=2e-5),
        TransientOutputs(rows, rows[:0], rows[:0]),
    )

    carrier = speed * TEETH[0] / (2 * TEETH[0] + 2 * TEETH[1])
    turn = -(speed - carrier) * TEETH[0] / TEETH[1]
    mass, coriolis, stiffness = independent_matrices(
        angles, pressure_angle=pressure, with_ring=True, carrier_speed=carrier
    )
    still, _, other = independent_matrices(angles, pressure_angle=pressure, with_ring=True)
    # Bodies are carrier, sun, ring and planets, each with x, y and the rotation as a motion of its radius.
    size, first = len(mass), 9 + 3 * (PLANET - 1)
    pin = np.zeros((2, size))
    tangent = (-math.sin(angles[PLANET - 1]), math.cos(angles[PLANET - 1]))
    for axis in range(2):
        pin[axis, first + axis], pin[axis, axis], pin[axis, 2] = 1.0, -1.0, -tangent[axis]
    stiffness -= BEARING_STIFFNESS * pin.T @ pin
    assert np.abs(still - mass).max() == 0.0
    # Springs between bodies have dashpots, those on the ground none; the pin's is by its own stiffness.
    grounded = np.zeros((size, size))
    for body in range(3):
        grounded[3 * body, 3 * body] = grounded[3 * body + 1, 3 * body + 1] = BEARING_STIFFNESS
    grounded[8, 8] = 1e9
    damping = coriolis + DAMPING_TIME * (other - grounded - BEARING_STIFFNESS * pin.T @ pin)
    damping += 2.0 * DAMPING_TIME * pin.T @ STATE.stiffness[:2, :2] @ pin
    load = np.zeros(size)
    radius = 0.5 * MODULE * TEETH[0] * math.cos(pressure)
    distance = 0.5 * MODULE * sum(TEETH)
    load[5] = torque / radius
    load[2] = -torque * (2 + 2 * TEETH[1] / TEETH[0]) / distance
    for number, angle in enumerate(angles):
        throw = MASS["planet"] * distance * carrier**2
        load[9 + 3 * number : 11 + 3 * number] = throw * math.cos(angle), throw * math.sin(angle)

    def force(q: FloatArray, time: float) -> FloatArray:
        return load - stiffness @ q + 2.0 * pin.T @ push_on_planet(spall, pin @ q, turn, time)

    begin = np.zeros(size)
    for _ in range(60):
        slopes = np.column_stack(
            [(force(begin + step, 0.0) - force(begin - step, 0.0)) / 2e-9 for step in 1e-9 * np.eye(size)]
        )
        begin -= np.linalg.lstsq(slopes, force(begin, 0.0), rcond=1e-9)[0]
    assert np.abs(force(begin, 0.0)).max() < 1e-5 * torque / radius
    inverse = np.linalg.inv(mass)

    def slope(time: float, state: FloatArray) -> FloatArray:
        q, rate = np.split(state, 2)
        return np.concatenate([rate, inverse @ (force(q, time) - damping @ rate)])

    start = np.concatenate([begin, np.zeros(size)])
    known = solve_ivp(slope, (0.0, duration), start, "DOP853", found.times, rtol=1e-7, atol=1e-12, max_step=1e-4)
    places = known.y[[first, first + 1, 6, 7]] - known.y[[first, first + 1, 6, 7], :1]
    moved = found.displacement.T - found.displacement.T[:, :1]
    # Elements that pass without a spall move the planet by less than a third of this.
    assert np.ptp(places[:2]) > 2.5e-6
    np.testing.assert_allclose(moved, places, atol=0.01 * np.ptp(places))


GAMMA = ROW.ball_diameter / ROW.pitch_diameter


@cache
def in_a_housing(on: str) -> Machine:
    """The set whose ring is in a housing that moves along x and y, and whose meshes excite nothing."""
    machine = turning_set((700.0, 900.0), unbalanced="sun")
    machine = replace(machine, shafts=[replace(shaft, unbalances=[]) for shaft in machine.shafts])
    spall = RollingSpall(on, 1.5e-3, 5e-5, azimuth=ALONG + math.pi)  # type: ignore[arg-type]
    return with_rolling_pin(machine, spall, in_both=False)


def rates(machine: Machine) -> tuple[float, float, float]:
    """Turns of the planet on its pin and of its cage against the pin, and of the carrier, in a second."""
    speeds = machine.speeds
    turn = abs(speeds[f"planet {PLANET}"] - speeds["carrier"]) / (2.0 * math.pi)
    return turn, 0.5 * (1.0 + GAMMA) * turn, abs(speeds["carrier"]) / (2.0 * math.pi)


@pytest.mark.parametrize(
    ("on", "part", "carried"),
    [("outer", "outer raceway", "outer ring"), ("inner", "inner raceway", ""), ("element", "rolling element", "cage")],
)
def test_a_sensor_has_the_strikes_beside_the_turns_of_spall_and_carrier(on: str, part: str, carried: str) -> None:
    machine = in_a_housing(on)
    turn, cage, carrier = rates(machine)
    struck = {
        "outer": 4.5 * (1.0 - GAMMA) * turn,
        "inner": 4.5 * (1.0 + GAMMA) * turn,
        "element": (1.0 - GAMMA**2) / GAMMA * turn,
    }[on]
    through = {"outer": turn, "inner": 0.0, "element": cage}[on]
    (found,) = spall_strikes(machine.assembled.system)
    assert (found.frequency, found.turning_frequency) == pytest.approx((struck, through))
    passes = element_passes(machine.assembled.system)
    assert [passes[f"planet {PLANET} {end}"] for end in ("left", "right")] == [pytest.approx((9 * cage,))] * 2
    part = f"{part} of planet {PLANET} left"
    asked = {
        7.0 * struck + carrier: f"7× {part} + 1× carrier",
        11.0 * struck - carrier: f"11× {part} - 1× carrier",
        2.0 * 9 * cage + carrier: f"2× elements of planet {PLANET} right + 1× carrier",
    }
    if carried:
        carried = f"{carried} of planet {PLANET} left"
        asked |= {
            7.0 * struck + 2.0 * through - carrier: f"7× {part} + 2× {carried} - 1× carrier",
            5.0 * struck - through + carrier: f"5× {part} - 1× {carried} + 1× carrier",
        }
    for frequency, expected in asked.items():
        (line,) = line_names(machine.assembled, [frequency], 1e-4)
        assert expected in line.name.split(", ")
        assert line.kind == "sideband"


@pytest.mark.slow
@pytest.mark.usefixtures("mechanisms_left_out")
@pytest.mark.parametrize(("on", "tone"), [("outer", "outer raceway"), ("inner", "inner raceway")])
def test_the_envelope_of_a_sensor_has_the_rate_of_the_damaged_part(on: str, tone: str) -> None:
    """Its line stands out of those of the sound parts; of a pin, all high lines are a turn of the carrier beside it."""
    machine = in_a_housing(on)
    run = gw.Study(machine, gw.Settings("spalled planet bearing")).simulate(revolutions=16, discard=4)
    found = {one.tone: one for one in run.solved.indicators(["envelope"]).tones}
    heard = {name: found[f"planet {PLANET} left: {name}"].amplitudes["x"] or 0.0 for name in TONES}
    assert heard[tone] > 2.0 * max(value for name, value in heard.items() if name != tone)
    lines = run.document["sensors"][0]["peaks"][:8]
    assert all(f"of planet {PLANET} left" in line["name"] or "elements" in line["name"] for line in lines)
    if on == "inner":
        turn, _, carrier = rates(machine)
        struck = 4.5 * (1.0 + GAMMA) * turn
        resolution = 1.0 / (12.0 * 2.0 * math.pi / machine.speed)
        for line in lines[:6]:
            off = abs(line["frequency_hz"] - struck * round(line["frequency_hz"] / struck))
            assert off == pytest.approx(carrier, abs=0.5 * resolution)


TONES = ("outer raceway", "inner raceway", "rolling element")
