"""A plane planetary set in coordinates at rest, its meshes and pins turning, against an integration of another kind.

The bodies and connectors are those of J. Lin and R. G. Parker, "Analytical characterization of the unique properties of
planetary gear free vibration", J. Vib. Acoust. 121 (1999) 316: sun, carrier, ring and planets, each with x, y and θ, on
springs along the lines of action and at the pins. They write the equations in the carrier's frame, with Coriolis and
centripetal terms; here all coordinates stand still, and the directions of meshes and pins turn. The equations are
written anew below, from the angles of one instant, and integrated by an adaptive method of the eighth order.
"""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from gearwhine.coupling import CoupledSystem, TransientOutputs, TransientSettings, simulate
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector, LinearConnector, TurningPart
from gearwhine.coupling.machine.speed_profile import SpeedProfile
from gearwhine.numerics.arrays import FloatArray

ALPHA = np.radians(24.6)
BASE = {"sun": 0.024, "planet": 0.030, "ring": 0.084}  # base radii [m]
PIN_CIRCLE = (BASE["sun"] + BASE["planet"]) / np.cos(ALPHA)
PLANETS = 3
ANGLES = 2.0 * np.pi * np.arange(PLANETS) / PLANETS
SUN, CARRIER, RING, FIRST = 0, 1, 2, 3
MASSES = np.array([0.4, 5.4, 2.3] + [0.66] * PLANETS)
INERTIAS = np.array([0.4 * 0.024**2, 6.0 * 0.06**2, 3.0 * 0.09**2] + [0.6 * 0.03**2] * PLANETS)
SIZE = 3 * (FIRST + PLANETS)
SCALE = np.column_stack([MASSES, MASSES, INERTIAS]).ravel() ** -0.5  # displacement by each normalised coordinate
SPEED = 250.0  # of the carrier [rad/s]
MESH_FREQUENCY = 84 * SPEED / (2.0 * np.pi)
MESH, DEPTH = 2e7, 0.2
PHASES = np.array([[0.0, 0.37, 0.71], [0.5, 0.87, 0.21]])  # of the suns' and the ring's meshes with each planet
PIN = np.array([[2e7, 1e6], [1e6, 4e7]])  # radial and tangential
TORQUE = 50.0
DURATION = 8e-3  # the carrier turns by 115 degrees


def body(which: int, x: float = 0.0, y: float = 0.0, rotation: float = 0.0) -> FloatArray:
    row = np.zeros(SIZE)
    row[3 * which : 3 * which + 3] = x, y, rotation
    return row


def mesh_row(of_ring: bool, planet: int, angle: float) -> FloatArray:
    """Compression of a mesh by all coordinates, the planet being at an angle.

    The sun, which turns counter-clockwise, pushes the planet along the line of action; the planet pushes the ring.
    """
    line = angle + (ALPHA - np.pi / 2.0 if of_ring else np.pi / 2.0 - ALPHA)
    x, y = np.cos(line), np.sin(line)
    own = FIRST + planet
    if of_ring:
        row = body(own, x, y, -BASE["planet"]) + body(RING, -x, -y, BASE["ring"])
    else:
        row = body(SUN, x, y, BASE["sun"]) + body(own, -x, -y, BASE["planet"])
    return row * SCALE


def pin_rows(planet: int, angle: float) -> FloatArray:
    """Radial and tangential displacement of a planet from its pin, shape (n, 2)."""
    x, y, own = np.cos(angle), np.sin(angle), FIRST + planet
    radial = body(own, x, y) - body(CARRIER, x, y)
    tangential = body(own, -y, x) - body(CARRIER, -y, x, PIN_CIRCLE)
    return np.array([radial, tangential]).T * SCALE[:, None]


STANDING = np.diag(
    np.concatenate([[5e6, 5e6, 0.0], [1e8, 6e7, 0.0], [1e8, 5e7, 4e6 * BASE["ring"] ** 2], np.zeros(3 * PLANETS)])
    * SCALE**2
)


def load() -> FloatArray:
    """Torques in balance, and the weight of all."""
    whole = body(SUN, rotation=TORQUE) - body(CARRIER, rotation=TORQUE * (1.0 + BASE["ring"] / BASE["sun"]))
    whole[1::3] = -9.81 * MASSES
    return whole * SCALE


def turned(rows: Callable[[float], FloatArray], angle: float) -> tuple[FloatArray, tuple[TurningPart]]:
    """Directions at the start, and the part that turns: all lateral coordinates."""
    lateral = (np.arange(SIZE) % 3 < 2)[:, None]
    start, quarter = rows(angle), rows(angle + 0.5 * np.pi)
    return start, (TurningPart(SPEED, np.where(lateral, start, 0.0), np.where(lateral, quarter, 0.0)),)


def planetary_set(damping: float) -> CoupledSystem:
    """The set with damping in proportion to stiffness [s], and a little of all motion."""
    parts = tuple(
        Component(name, ("rotor",) * 3, np.zeros((3, 3)), 300.0 * bool(damping) * np.eye(3), np.zeros((3, 3)))
        for name in ("sun", "carrier", "ring", *(f"planet {n}" for n in range(PLANETS)))
    )
    linear = [LinearConnector("bearings", np.eye(SIZE), STANDING, damping * STANDING)]
    contacts = []
    stiffness = piecewise.tabulated(lambda s: MESH * (1.0 + DEPTH * np.cos(2.0 * np.pi * s)), 1.0, tolerance=1e-7)
    law = ToothContact(1.0, stiffness, piecewise.constant(0.0, 1.0), damping * MESH)
    for planet, angle in enumerate(ANGLES.tolist()):
        directions, parts_of_pin = turned(lambda at, planet=planet: pin_rows(planet, at), angle)
        linear.append(LinearConnector(f"pin {planet}", directions, PIN, damping * PIN, turning=parts_of_pin))
        for of_ring in (False, True):
            directions, turning = turned(
                lambda at, of_ring=of_ring, planet=planet: mesh_row(of_ring, planet, at)[:, None], angle
            )
            name, phase = f"{'ring' if of_ring else 'sun'} {planet}", float(PHASES[int(of_ring), planet])
            contacts.append(
                ContactConnector(name, directions[:, 0], law, phase, MESH_FREQUENCY, np.empty((0, 3)), turning=turning)
            )
    return CoupledSystem(parts, (0.0,) * len(parts), tuple(linear), tuple(contacts), load())


def directions_at(angle: float) -> FloatArray:
    """Directions that turn where the carrier is at an angle, (n, 4 planets): meshes and pin of each planet."""
    return np.column_stack(
        [
            part
            for planet, start in enumerate(ANGLES.tolist())
            for part in (
                mesh_row(False, planet, start + angle),
                mesh_row(True, planet, start + angle),
                pin_rows(planet, start + angle),
            )
        ]
    )


# Every entry is constant or a sine: three angles tell it.
MEAN = 0.5 * (directions_at(0.0) + directions_at(np.pi))
COSINE, SINE = directions_at(0.0) - MEAN, directions_at(0.5 * np.pi) - MEAN
PINS = np.kron(np.eye(PLANETS), np.block([[np.zeros((2, 4))], [np.zeros((2, 2)), PIN]]))
MESHES = np.flatnonzero(np.arange(4 * PLANETS) % 4 < 2)


def stiffness_at(nominal_time: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Directions, shape (n, d), their rates by the nominal time, and stiffness, shape (d, d)."""
    c, s = np.cos(SPEED * nominal_time), np.sin(SPEED * nominal_time)
    stiffness = PINS.copy()
    phases = PHASES.T.ravel() + MESH_FREQUENCY * nominal_time
    stiffness[MESHES, MESHES] = MESH * (1.0 + DEPTH * np.cos(2.0 * np.pi * phases))
    return MEAN + COSINE * c + SINE * s, SPEED * (SINE * c - COSINE * s), stiffness


DAMPED = PINS + np.diag(np.isin(np.arange(4 * PLANETS), MESHES) * MESH)


def start() -> FloatArray:
    """Equilibrium at the start, of least norm: the train may turn."""
    columns, _, stiffness = stiffness_at(0.0)
    return np.linalg.lstsq(STANDING + columns @ stiffness @ columns.T, load(), rcond=1e-11)[0]


def independent(
    times: FloatArray, damping: float, nominal: Callable[[float], tuple[float, float]]
) -> tuple[FloatArray, FloatArray]:
    """Coordinates and rates at some times; ``nominal`` gives nominal time and relative speed."""
    pushing = load()

    def slope(time: float, state: FloatArray) -> FloatArray:
        q, v = state[:SIZE], state[SIZE:]
        nominal_time, speed = nominal(time)
        columns, slopes, stiffness = stiffness_at(nominal_time)
        deflection, rate = columns.T @ q, columns.T @ v + speed * slopes.T @ q
        force = stiffness @ deflection + damping * DAMPED @ rate
        resisting = STANDING @ (q + damping * v) + 300.0 * bool(damping) * v
        return np.concatenate([v, pushing - resisting - columns @ force])

    # Teeth stay in contact, and no stiffness jumps.
    state = np.concatenate([start(), np.zeros(SIZE)])
    found = solve_ivp(slope, (0.0, times[-1]), state, "DOP853", t_eval=times, rtol=1e-10, atol=1e-14).y.T
    return found[:, :SIZE], found[:, SIZE:]


RUN_UP = SpeedProfile(np.array([0.0, DURATION]), np.array([0.3, 1.1]))


def speeding(time: float) -> tuple[float, float]:
    gain = 0.8 / DURATION
    return 0.3 * time + 0.5 * gain * time**2, 0.3 + gain * time


@pytest.mark.parametrize(
    ("damping", "profile"), [(0.0, None), (2e-6, None), (1e-5, RUN_UP)], ids=["undamped", "damped", "run-up"]
)
def test_a_planetary_set_moves_as_its_own_equations(damping: float, profile: SpeedProfile | None) -> None:
    settings = TransientSettings(DURATION, 0.0, DURATION / 64.0, 1e-7, tolerance=1e-3)
    everything = TransientOutputs(np.eye(SIZE), np.eye(SIZE), np.eye(SIZE))
    at_rest = start(), np.zeros(SIZE)
    result = simulate(planetary_set(damping), settings, everything, speed_profile=profile, initial=at_rest)
    assert not result.contact_loss.any()
    assert result.force.min() > 0.0
    nominal = (lambda time: (time, 1.0)) if profile is None else speeding
    moved, rates = independent(result.times, damping, nominal)
    # Each direction of each kind of body by its own size.
    for axis in range(3):
        for which in ([SUN], [CARRIER], [RING], list(range(FIRST, FIRST + PLANETS))):
            among = [3 * one + axis for one in which]
            size = np.abs(moved[:, among] - moved[0, among]).max()
            np.testing.assert_allclose(result.displacement[:, among], moved[:, among], atol=1e-4 * size)
            size = np.abs(rates[:, among]).max()
            np.testing.assert_allclose(result.velocity[:, among], rates[:, among], atol=1e-4 * size)
    assert result.energy.error < 1e-4
    # The turning works as much as the loads do: without it the balance would not close.
    assert abs(result.energy.teeth) > 0.01 * result.energy.scale
