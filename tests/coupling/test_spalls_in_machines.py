"""Spalled bearings in machines: against a time integration of the equations alone, on a housing that yields, and tones.

Drops, forces and integration here are written anew from the geometry and by scipy; of the machine are taken the modes
of its shaft, which have nothing to do with spalls.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, root

from gearwhine.coupling import (
    CoupledMachine,
    MachineLoads,
    MountedBearing,
    RollingLaw,
    TransientOutputs,
    TransientSettings,
    assemble_machine,
    simulate,
)
from gearwhine.coupling.connector_forces.bearing_kernels import bearing_force
from gearwhine.coupling.connector_forces.kernel_arrays import bearing_arrays
from gearwhine.coupling.machine.components import HousingComponent, rotor_component
from gearwhine.coupling.machine.connectors import NonlinearConnector
from gearwhine.coupling.machine.driving_frequencies import element_passes, spall_strikes
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import Bearing, Disc, Rotor, Segment, ShaftMaterial, modal_rotor
from gearwhine.rotors.rolling_bearings import (
    NO_SLIP,
    BallRow,
    CageFault,
    CageSlip,
    RollerRow,
    RollingBearing,
    RollingSpall,
    SphericalRollerRow,
    TaperedRollerRow,
    linearised_bearing,
    paired,
    rolling_equilibrium,
    rolling_state,
)

STEEL = ShaftMaterial.from_poisson_ratio(207e9, 0.3, 7850.0)
SPEED = 2.0 * math.pi * 25.0
PLACES = {"left": 0.05, "right": 0.35}
WEIGHT = 9.81
DAMPING = 3e4
HELD = {"z": 0.0, "rx": 0.0, "ry": 0.0}
BALLS = BallRow(9, 12e-3, 60e-3, clearance=10e-6)
ROLLERS = RollerRow(13, 9e-3, 9e-3, 50e-3, clearance=8e-6, profile="straight", slices=3)
# Two modes of a housing, in which the left seat moves obliquely and turns, and a sensor of it.
SEATS = {
    "left": np.array([[0.3, 0.1, 0.0, 0.2, -0.4, 0.0], [-0.05, 0.25, 0.0, 0.5, 0.1, 0.0]]),
    "right": np.array([[0.1, 0.1, 0.0, 0.0, 0.3, 0.0], [0.05, -0.15, 0.0, -0.2, 0.0, 0.0]]),
}
HOUSING = np.diag((2.0 * math.pi * np.array([310.0, 870.0])) ** 2)
HOUSING_DAMPING = np.diag(2.0 * 0.03 * 2.0 * math.pi * np.array([310.0, 870.0]))
SENSOR = np.array([0.2, 0.4])


def machine(
    bearing: RollingBearing,
    *spalls: RollingSpall | CageFault,
    housing: bool,
    held: dict[str, float] | None = None,
    slip: CageSlip = NO_SLIP,
) -> CoupledMachine:
    """A shaft with a disc, its weight on two rolling bearings, the first of which is damaged."""
    state = rolling_equilibrium(bearing, [0.0, -500.0, 0.0, 0.0, 0.0], held=HELD if held is None else held)
    shaft = Rotor("shaft", [Segment(0.1, 0.04, 0.0, STEEL)] * 4, [Disc(0.2, 50.0, 0.5, 0.3)])
    bearings = [
        replace(linearised_bearing(state, name, at), damping=DAMPING * np.eye(2)) for name, at in PLACES.items()
    ]
    modal = modal_rotor(shaft, bearings, count=3)
    laws = [RollingLaw(state, 0.2, spalls, slip), RollingLaw(state, 0.2)]
    box = None
    if housing:
        box = HousingComponent(
            "housing",
            ("housing",) * 2,
            HOUSING,
            HOUSING_DAMPING,
            np.zeros((2, 2)),
            SEATS,
            PLACES,
            {"top": SENSOR},
            np.zeros((2, 6)),
        )
    mounted = [
        MountedBearing(one, "shaft", name if housing else None, law)
        for one, name, law in zip(bearings, PLACES, laws, strict=True)
    ]
    return assemble_machine(
        [rotor_component("shaft", modal, start=0.0, damping_ratio=0.02)],
        box,
        speeds={"shaft": SPEED},
        bearings=mounted,
        loads=MachineLoads(gravity=(0.0, -WEIGHT, 0.0)),
    )


@cache
def deviations(slip: CageSlip) -> FloatArray:
    """Those of the left bearing's cage, drawn once."""
    return slip.deviations("left", 0) if slip.scatter else np.zeros(2)


def rolled(row: BallRow | RollerRow, slip: CageSlip, time: float) -> float:
    """Time in which a cage without slip would turn as far."""
    passing = (
        4.0 * math.pi / (row.count * SPEED * (1.0 - row.element_diameter / row.pitch_diameter) * (1.0 - slip.mean))
    )
    walk = deviations(slip)
    return (1.0 - slip.mean) * (time + passing * float(np.interp(time / passing, np.arange(len(walk)), walk)))


def drops(
    spall: RollingSpall, row: BallRow | RollerRow, azimuth: FloatArray, time: float, cage_time: float
) -> FloatArray:
    """Drop of each element of a bearing without contact angle into a spall of a raceway, or of its own."""
    middle, radius = 0.5 * row.pitch_diameter, 0.5 * row.element_diameter
    spin = 0.5 * SPEED * (row.pitch_diameter / row.element_diameter - row.element_diameter / row.pitch_diameter)
    if spall.on == "element":
        turned = np.where(np.arange(row.count) == spall.element, spall.azimuth + spin * cage_time, 0.5 * math.pi)
        pairs = [(radius, middle - radius, turned), (radius, -middle - radius, turned + math.pi)]
    elif spall.on == "inner":
        pairs = [(middle - radius, radius, azimuth - spall.azimuth - SPEED * time)]
    else:
        pairs = [(-middle - radius, radius, azimuth - spall.azimuth)]
    total = np.zeros(row.count)
    for p, s, angle in pairs:
        a = np.maximum(0.5 * spall.length / abs(p) - np.abs((angle + math.pi) % (2.0 * math.pi) - math.pi), 0.0)
        free = p * (1.0 - np.cos(a)) + s - math.copysign(1.0, s) * np.sqrt(s**2 - (p * np.sin(a)) ** 2)
        total += np.minimum(free, spall.depth)
    return total


def bearing_law(
    row: BallRow | RollerRow,
    spalls: Sequence[RollingSpall | CageFault],
    q: FloatArray,
    time: float,
    slip: CageSlip = NO_SLIP,
) -> FloatArray:
    """Force of the shaft on the elements by x, y, z and the tilts about x and y [N, N m], shape (5,)."""
    cage_time = rolled(row, slip, time)
    cage = 0.2 + 0.5 * SPEED * (1.0 - row.element_diameter / row.pitch_diameter) * cage_time
    azimuth = cage + 2.0 * math.pi * np.arange(row.count) / row.count
    for one in spalls:
        if isinstance(one, CageFault):
            azimuth[one.element] += one.length / (0.5 * row.pitch_diameter)
    c, s = np.cos(azimuth), np.sin(azimuth)
    away, tilt = q[0] * c + q[1] * s, q[4] * c - q[3] * s
    into = [drops(one, row, azimuth, time, cage_time) for one in spalls if isinstance(one, RollingSpall)]
    less = sum(into, np.zeros(row.count))
    if isinstance(row, BallRow):
        between = (row.inner_groove + row.outer_groove - 1.0) * row.ball_diameter
        arm = 0.5 * row.pitch_diameter + (row.inner_groove - 0.5) * row.ball_diameter
        radial, axial = between - 0.5 * row.clearance + away, q[2] - arm * tilt
        length = np.hypot(radial, axial)
        load = row.stiffness * np.maximum(length - between - less, 0.0) ** 1.5
        # The tilt moves the inner groove along z by its arm, and a force along z turns the shaft by it.
        across, along = load * radial / length, load * axial / length
        parts = [across * c, across * s, along, along * arm * s, -along * arm * c]
    else:
        place = ((np.arange(row.slices) + 0.5) / row.slices - 0.5)[:, None] * row.length
        deep = np.maximum(away + place * tilt - 0.5 * row.clearance - less, 0.0)
        load = row.stiffness / row.slices * deep ** (10.0 / 9.0)
        parts = [load * c, load * s, 0.0 * load, -load * place * s, load * place * c]
    return np.array([np.sum(part) for part in parts])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("row", "spalls", "slip"),
    [
        (BALLS, [RollingSpall("outer", 2e-3, 1e-4, azimuth=-1.5)], NO_SLIP),
        (
            BALLS,
            [RollingSpall("inner", 2e-3, 6e-6, azimuth=-2.5), RollingSpall("element", 1e-3, 1e-4, 0.3, element=7)],
            CageSlip(0.03, 0.05, 2),
        ),
        (
            ROLLERS,
            [RollingSpall("element", 1e-3, 1e-4, element=10), RollingSpall("outer", 1e-3, 1e-4, azimuth=-1.2)],
            NO_SLIP,
        ),
        (ROLLERS, [CageFault(8e-4, element=9), CageFault(2e-4, element=2)], CageSlip(0.02)),
    ],
    ids=["balls", "several", "rollers", "cage"],
)
def test_motion_on_a_housing_that_yields(
    row: BallRow | RollerRow, spalls: list[RollingSpall | CageFault], slip: CageSlip
) -> None:
    """Acceleration of its sensor, and the shaft's motion in both bearings, over the strikes of some elements."""
    parts = machine(RollingBearing([row]), *spalls, housing=True, slip=slip)
    (shaft,) = parts.rotors
    size = shaft.size
    rows = {name: np.hstack([shaft.motions(at), -SEATS[name].T[:5]]) for name, at in PLACES.items()}
    stiffness, damping = np.zeros((size + 2, size + 2)), np.zeros((size + 2, size + 2))
    stiffness[:size, :size], damping[:size, :size] = shaft.stiffness, shaft.damping + SPEED * shaft.gyroscopic
    stiffness[size:, size:], damping[size:, size:] = HOUSING, HOUSING_DAMPING
    for one in rows.values():
        damping += DAMPING * one[:2].T @ one[:2]
    weight = parts.system.load
    damaged = {"left": (spalls, slip), "right": ([], NO_SLIP)}

    def forces(q: FloatArray, time: float) -> FloatArray:
        held = []
        for name, d in rows.items():
            faults, slipping = damaged[name]
            held.append(d.T @ bearing_law(row, faults, d @ q, time, slipping))
        return weight - stiffness @ q - sum(held)

    def slope(time: float, state: FloatArray) -> FloatArray:
        q, rate = np.split(state, 2)
        return np.concatenate([rate, forces(q, time) - damping @ rate])

    interval, duration = 1e-4, 0.01
    outputs = np.vstack([rows["left"][:2], rows["right"][:2]])
    top = np.concatenate([np.zeros(size), SENSOR])[None]
    chosen = TransientSettings(duration, 0.0, interval, 2e-6, tolerance=1e-4)
    found = simulate(parts.system, chosen, TransientOutputs(outputs, outputs[:0], top))
    # Nothing drives or holds the shaft's rotation, nor its place along rollers.
    held = np.diag(parts.system.stiffness) > 1.0
    begin = np.zeros(size + 2)

    def unbalanced(place: FloatArray) -> FloatArray:
        begin[held] = place
        return forces(begin, 0.0)[held]

    pressed = np.concatenate([one.law.reference[:2] for one in parts.system.nonlinear])
    guess = np.linalg.lstsq(outputs[:, held], pressed)[0]
    begin[held] = root(unbalanced, guess, tol=1e-13).x
    assert np.abs(unbalanced(begin[held])).max() < 1e-6
    np.testing.assert_allclose(outputs @ begin, found.displacement[0], atol=1e-10)
    start = np.concatenate([begin, np.zeros(size + 2)])
    known = solve_ivp(slope, (0.0, duration), start, "DOP853", found.times, rtol=1e-7, atol=1e-12, max_step=5e-5)
    places = outputs @ known.y[: size + 2]
    moved = np.ptp(places, axis=1).max()
    assert moved > (1e-7 if isinstance(spalls[0], CageFault) else 5e-7)
    np.testing.assert_allclose(found.displacement.T, places, atol=0.005 * moved)
    accelerations = [
        float(top[0] @ slope(time, state)[size + 2 :]) for time, state in zip(known.t.tolist(), known.y.T, strict=True)
    ]
    rms = np.sqrt(np.mean(np.square(accelerations)))
    assert np.sqrt(np.mean((found.acceleration[:, 0] - accelerations) ** 2)) < 0.01 * rms


def felt(bearing: RollingBearing, spall: RollingSpall, times: FloatArray) -> FloatArray:
    """Energy that a spall takes from a bearing whose rings are held in the middle."""
    state, energies = rolling_state(bearing, np.zeros(5)), []
    for spalls in ((spall,), ()):
        law = RollingLaw(state, 0.3, spalls)
        arrays = bearing_arrays([NonlinearConnector("b", np.eye(5), np.arange(5), law, state.stiffness, SPEED)])
        force, tangent = np.zeros(5), np.zeros((5, 5))
        energies.append([bearing_force(arrays, 0, time, np.zeros(5), force, tangent)[0] for time in times.tolist()])
    return np.asarray(np.subtract(energies[1], energies[0]))


SPHERICAL = SphericalRollerRow(14, 10e-3, 11e-3, 70e-3, angle=0.2, clearance=-8e-6)
PRESSED = {
    "deep-groove": RollingBearing([replace(BALLS, clearance=-10e-6)]),
    "angular contact": RollingBearing([replace(BALLS, contact_angle=0.6, clearance=-10e-6)]),
    "cylindrical": RollingBearing([replace(ROLLERS, clearance=-8e-6)]),
    "tapered, two rows": paired(TaperedRollerRow(15, 8e-3, 12e-3, 55e-3, 0.25), "face to face", 0.02, preload=3e3),
    "spherical, two rows": RollingBearing([replace(SPHERICAL, position=7e-3 * one, direction=one) for one in (-1, 1)]),
}


@pytest.mark.parametrize("kind", list(PRESSED))
@pytest.mark.parametrize("on", ["outer", "inner", "element"])
def test_a_spall_is_struck_at_the_characteristic_frequency_of_its_part(kind: str, on: str) -> None:
    """Strikes counted where all elements carry alike, in the last row, against the kinematics of pure rolling."""
    bearing = PRESSED[kind]
    row = bearing.rows[-1]
    tilt = row.contact_angle
    if isinstance(row, TaperedRollerRow):
        # Cones of one apex: the roller's axis is half its own angle off the outer raceway's normal.
        size = row.element_diameter / row.pitch_diameter
        tilt -= brentq(lambda half: math.tan(half) - size * math.sin(row.contact_angle - half), 0.0, row.contact_angle)
    across = row.element_diameter * math.cos(tilt) / row.pitch_diameter
    tones = {
        "outer": 0.5 * row.count * (1.0 - across) * SPEED,
        "inner": 0.5 * row.count * (1.0 + across) * SPEED,
        "element": row.pitch_diameter / row.element_diameter * (1.0 - across**2) * SPEED,
    }
    spall = RollingSpall(on, 1e-3, 1e-3, azimuth=1.1, row=len(bearing.rows) - 1)  # type: ignore[arg-type]
    assert spall.tone(row, SPEED) == pytest.approx(tones[on], rel=1e-9)
    period = 2.0 * math.pi / spall.tone(row, SPEED)
    struck = felt(bearing, spall, np.arange(20 * 160) * period / 160.0)
    assert struck.max() > 0.0
    begins = np.flatnonzero((struck[1:] > 0.0) & (struck[:-1] <= 0.0))
    assert abs(len(begins) - 20) <= 1
    np.testing.assert_allclose(np.diff(begins[::2]), 320.0, atol=1.01)
    if on != "element":
        np.testing.assert_allclose(struck[160:], struck[:-160], atol=1e-6 * struck.max())


def test_a_bearing_in_a_shaft_that_turns_is_carried_round_with_it() -> None:
    """Between two turning rings the cage has the mean of the speeds of their rolling surfaces (Harris)."""
    bearing = PRESSED["deep-groove"]
    inner, outer = 40.0, -90.0
    row = bearing.rows[0]
    gamma = row.element_diameter / row.pitch_diameter
    cage = 0.5 * ((1.0 - gamma) * inner + (1.0 + gamma) * outer)
    shafts = {
        name: Rotor(name, [Segment(0.1, 0.04, bore, STEEL)] * 4) for name, bore in (("inner", 0.0), ("outer", 0.03))
    }
    spring = 1e8 * np.eye(2)
    springs = {name: [Bearing(f"{name} {at}", at, spring, 0.0 * spring) for at in (0.05, 0.35)] for name in shafts}
    state = rolling_state(bearing, np.zeros(5))
    between = linearised_bearing(state, "between", 0.2)
    spall = RollingSpall("outer", 1e-3, 1e-3, azimuth=0.5)
    mounted = [MountedBearing(one, name, None) for name, several in springs.items() for one in several]
    parts = assemble_machine(
        [rotor_component(name, modal_rotor(one, springs[name], count=2), start=0.0) for name, one in shafts.items()],
        None,
        speeds={"inner": inner, "outer": outer},
        bearings=[*mounted, MountedBearing(between, "inner", "outer", RollingLaw(state, 0.3, (spall,)))],
    )
    (one,) = parts.system.nonlinear
    assert element_passes(parts.system)["between"] == pytest.approx((row.count * abs(cage) / (2.0 * math.pi),))
    (strikes,) = spall_strikes(parts.system)
    assert strikes.frequency == pytest.approx(0.5 * row.count * (1.0 - gamma) * abs(inner - outer) / (2.0 * math.pi))
    assert (strikes.turning, strikes.turning_frequency) == (
        "outer ring of between",
        pytest.approx(90.0 / (2.0 * math.pi)),
    )
    # Pressed aside, the sound bearing has the force of its elements where the cage has carried them, and the spall
    # stands where the ring has carried it.
    q, time = np.array([8e-6, 3e-6, 0.0, 0.0, 0.0]), 0.0123
    sound = replace(one, law=replace(one.law, spalls=()), directions=np.eye(5), axes=np.arange(5), stiffness=np.eye(5))
    force = np.zeros(5)
    bearing_force(bearing_arrays([sound]), 0, time, q, force, np.zeros((5, 5)))
    known = rolling_state(bearing, q, cage_angle=0.3 + cage * time).reaction
    np.testing.assert_allclose(force, known, rtol=1e-9, atol=1e-6)
    damaged = replace(sound, law=one.law)
    standing = replace(spall, azimuth=0.5 + outer * time)
    held = replace(damaged, law=RollingLaw(state, 0.3 + cage * time, (standing,)), speed=0.0, holder_speed=0.0)
    energies = [
        bearing_force(bearing_arrays([law]), 0, at, q, np.zeros(5), np.zeros((5, 5)))[0]
        for law, at in ((damaged, time), (held, 0.0))
    ]
    assert energies[0] == pytest.approx(energies[1], rel=1e-12)
