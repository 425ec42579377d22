"""Helical planets whose flanks swing as the carrier turns past a force, integrated as rigid bodies on their own."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from gearwhine.coupling import CoupledMachine, Machine
from gearwhine.coupling.gears.stiffness.models import SquareStiffness
from gearwhine.coupling.linear.line_mechanisms import LineMechanisms
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel
from gearwhine.coupling.machine.loads import ShaftForce
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.coupling.time.settings import TransientSettings
from gearwhine.coupling.time.transient import simulate
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.rotors import Bearing, ShaftMaterial
from tests.machines.plane_planetary_set import INERTIA, MASS, MODULE, RING_SUPPORT, plane_set
from tests.machines.turning_set import PRESSURE_ANGLE, TEETH, housing

HELIX, FACE, TOOTH, TORQUE, SPEED, PUSH = math.radians(10.0), 0.03, 4e8, 200.0, 300.0, 2000.0
ANGLES, NATURAL, LAG = np.radians([0.0, 130.0, 240.0]), (900.0, 1300.0), 3e-6
"""Planets that suppress no line, natural frequencies of the housing [Hz], and damping over stiffness [s]."""
BEARING, TILT = 1e8, 2.52e5
"""Stiffness of both bearings of a shaft, across and along it, and against tilting."""
BODIES = ("sun", "carrier", "ring", "planet", "planet", "planet")
pytestmark = pytest.mark.usefixtures("few_slices")
LIMIT = 2.0 * np.pi * 1300.0
RING = TEETH[0] + 2 * TEETH[1]
STIFF = ShaftMaterial(youngs_modulus=2e13, shear_modulus=8e12, density=1.0)
SOFTER = ShaftMaterial(youngs_modulus=2e12, shear_modulus=8e11, density=10.0)
"""Of shafts whose first modes let a motion take longer steps."""


@cache
def machine(
    push: float,
    material: ShaftMaterial = STIFF,
    friction: float = 0.0,
    deviations: tuple[float, ...] = (),
    **modes: int,
) -> CoupledMachine:
    """A set on short stiff shafts whose carrier a force pulls down at its end, and pitch deviations of its ring."""
    of_set = {"pressure_angle": PRESSURE_ANGLE, "with_ring": True, "damping": LAG, "material": material} | modes
    parts = plane_set(ANGLES, **of_set, diameter=0.05, teeth=TEETH)
    law = 0.5 * np.diag([BEARING, BEARING, BEARING, 2e3, 2e3])
    parts["bearings"] = [
        replace(
            one,
            bearing=Bearing(one.bearing.name, one.bearing.at, law, LAG * law),
            seat="seat" if one.rotor == "ring" else one.seat,
        )
        for one in parts["bearings"]
    ]
    of_teeth = {"module": MODULE * math.cos(HELIX), "face_width": FACE}
    parts["gears"] = [
        replace(one, gear=replace(one.gear, helix_angle=HELIX if one.gear.name == "sun gear" else -HELIX, **of_teeth))
        for one in parts["gears"]
    ]
    parts["gears"] = [
        replace(one, gear=replace(one.gear, pitch_deviations=deviations)) if one.gear.name == "ring gear" else one
        for one in parts["gears"]
    ]
    of_pair = {"stiffness": SquareStiffness(TOOTH), "misalignment": None, "damping": LAG * TOOTH, "friction": friction}
    parts["gear_pairs"] = [replace(one, corner_contact=False, **of_pair) for one in parts["gear_pairs"]]
    forces = [ShaftForce("carrier", 0.1, (0.0, -push, 0.0))] if push else []
    return (
        Machine(**parts, housing=housing(NATURAL), speed=SPEED, torque=TORQUE, forces=forces)
        .at_operating_point()
        .assembled
    )


def integrated(
    phases: FloatArray,
    push: float,
    friction: float = 0.0,
    gaps: FloatArray | None = None,
    slices: int = 21,
    steps: int = 4096,
) -> ComplexArray:
    """Lines of the housing along x and y over the third turn of the carrier, by their order (o, 2) [m/s²].

    Bodies have x, y, z and rotations about them in space, the housing two modes. The carrier sees the meshes stand:
    a slice at z whose contact is ξ from the pitch point approaches by n·(u + φ × r) of both gears. The first gear of a
    mesh slides past the other by the difference of their speeds times ξ, against Coulomb's friction; ``gaps`` are those
    of the ring's teeth in the order in which they enter, for each of its meshes.
    """
    sun, planet, ring = (0.5 * MODULE * z for z in (*TEETH, RING))
    distance, turn = sun + planet, SPEED * TEETH[0] / (TEETH[0] + RING)
    across = math.atan(math.tan(PRESSURE_ANGLE) / math.cos(HELIX))
    lead, pitch = math.tan(HELIX) * math.cos(across), math.pi * MODULE * math.cos(across)
    module = MODULE * math.cos(HELIX)

    def beyond(radius: float, tip: float) -> float:
        """Length of the path from the pitch point to a tip circle."""
        return math.sqrt(tip**2 - (radius * math.cos(across)) ** 2) - radius * math.sin(across)

    before = np.repeat([beyond(planet, planet + module), -beyond(ring, ring - 0.8 * module)], 3)
    behind = np.repeat([beyond(sun, sun + module), beyond(planet, planet + module)], 3)
    # Approach by its mean, its slope over z and over ξ, of the sun's and of the ring's meshes.
    by_body, by_friction, sense = np.zeros((6, 3, 6, 6)), np.zeros((6, 3, 6, 6)), np.zeros(6)
    spins = np.array([SPEED, turn, 0.0] + [turn - (SPEED - turn) * TEETH[0] / TEETH[1]] * 3)
    for mesh in range(6):
        number, of_ring = 3 + mesh % 3, mesh >= 3
        out = np.array([math.cos(ANGLES[number - 3]), math.sin(ANGLES[number - 3]), 0.0])
        along = np.array([-out[1], out[0], 0.0])
        line = (-1.0 if of_ring else 1.0) * math.cos(across) * along + math.sin(across) * out
        normal = line - np.array([0.0, 0.0, lead])
        place = (ring if of_ring else sun) * out
        first, second = (number, 2) if of_ring else (0, number)
        across_line = np.array([-line[1], line[0], 0.0])
        sense[mesh] = -np.sign(spins[first] - spins[second])
        for body, sign in ((first, 1.0), (second, -1.0)):
            arm = place - (distance * out if body == number else 0.0)
            for part, reach in enumerate((arm, np.array([0.0, 0.0, 1.0]), line)):
                by_body[mesh, part, body, 3:] = sign * np.cross(reach, normal)
                by_friction[mesh, part, body, 3:] = sign * np.cross(reach, across_line)
            by_body[mesh, 0, body, :3] = sign * normal
            by_friction[mesh, 0, body, :3] = sign * across_line
    rows, rubbing = by_body.reshape(6, 3, 36), by_friction.reshape(6, 3, 36)
    mass, held, pins = np.zeros((6, 6)), np.zeros((36, 36)), np.zeros((36, 36))
    radii = [sun * math.cos(PRESSURE_ANGLE), distance, ring * math.cos(PRESSURE_ANGLE)]
    radii += [planet * math.cos(PRESSURE_ANGLE)] * 3
    stiffness = np.array([BEARING] * 3 + [TILT] * 2 + [0.0])
    pushed, centrifugal = np.zeros((6, 6)), np.zeros((6, 6))
    for body, (name, radius) in enumerate(zip(BODIES, radii, strict=True)):
        own = slice(6 * body, 6 * body + 6)
        mass[body] = [MASS[name]] * 3 + [INERTIA[name] * radius**2] * 3
        if body < 3:
            held[own, own] = np.diag(stiffness)
            continue
        x, y = distance * np.array([math.cos(ANGLES[body - 3]), math.sin(ANGLES[body - 3])])
        moved = np.zeros((6, 36))
        moved[:, own] = np.eye(6)
        moved[:, 6:12] -= np.eye(6)
        moved[0, 11], moved[1, 11], moved[2, 9], moved[2, 10] = y, -x, -y, x
        pins += moved.T @ (stiffness[:, None] * moved)
        centrifugal[body, :2] = mass[body, 0] * turn**2 * np.array([x, y])
        # That of a pin follows the carrier.
        held[11, 11] += mass[body, 0] * turn**2 * distance**2
    held[17, 17] += RING_SUPPORT * radii[2] ** 2
    pushed[0, 5], pushed[1, 5], pushed[1, 1], pushed[1, 3] = (
        TORQUE,
        -TORQUE * (1.0 + RING / TEETH[0]),
        -push,
        push * 0.05,
    )
    z = FACE * ((np.arange(slices) + 0.5) / slices - 0.5)
    half = 0.5 * FACE * lead / slices
    natural = 2.0 * math.pi * np.array(NATURAL)
    damped = held - np.diag(np.eye(36)[11] * held[11, 11] + np.eye(36)[17] * held[17, 17])

    def rotated(motion: FloatArray, angle: float) -> FloatArray:
        c, s = math.cos(angle), math.sin(angle)
        return np.asarray(motion.reshape(6, 2, 3) @ [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).ravel()

    def acceleration(time: float, q: FloatArray, v: FloatArray) -> FloatArray:
        seen, rate = rotated(q[:36], turn * time), rotated(v[:36], turn * time)
        rate = rate - turn * rotated(seen, -0.5 * math.pi) * np.tile([1.0, 1.0, 0.0], 12)
        entered, place = np.divmod(phases + turn * RING / (2.0 * math.pi) * time, 1.0)
        along = (place[:, None, None] + np.arange(-1.0, 3.0)[:, None]) * pitch + lead * z
        end = (before + behind)[:, None, None]
        carrying = np.clip(np.minimum(along + half, end) - np.maximum(along - half, 0.0), 0.0, None) / (2.0 * half)
        xi = along - before[:, None, None]
        mean, slope, tilt = np.moveaxis(rows @ seen, 1, 0)[..., None, None]
        pressed = mean + slope * z + tilt * xi
        if gaps is not None:
            teeth = (entered[3:, None].astype(int) - np.arange(-1, 3)) % RING
            pressed[3:] -= gaps[np.arange(3)[:, None], teeth, None]
        mean, slope, tilt = np.moveaxis(rows @ rate, 1, 0)[..., None, None]
        load = TOOTH / slices * carrying * np.where(pressed > 0.0, pressed + LAG * (mean + slope * z + tilt * xi), 0.0)
        loads = np.array([load.sum((1, 2)), (load * z).sum((1, 2)), (load * xi).sum((1, 2))]).T
        force = centrifugal.ravel() - np.einsum("mp,mpn->n", loads, rows) - pins @ (seen + LAG * rate)
        if friction:
            rubbed = friction * math.hypot(1.0, lead) * load * np.clip(xi / half, -1.0, 1.0) * sense[:, None, None]
            loads = np.array([rubbed.sum((1, 2)), (rubbed * z).sum((1, 2)), (rubbed * xi).sum((1, 2))]).T
            force += np.einsum("mp,mpn->n", loads, rubbing)
        force = rotated(force, -turn * time) + pushed.ravel() - held @ q[:36] - LAG * damped @ v[:36]
        # Ring and housing by the seat.
        shift, swept = 0.2 * q[36:], 0.2 * v[36:]
        force[12:14] += BEARING * (shift + LAG * swept)
        seat = BEARING * (q[12:14] - shift + LAG * (v[12:14] - swept))
        force = force.reshape(6, 6)
        moment = mass[:, 5] * spins
        tilts = v[:36].reshape(6, 6)
        force[:, 3] -= moment * tilts[:, 4]
        force[:, 4] += moment * tilts[:, 3]
        return np.concatenate([(force / mass).ravel(), 0.2 * seat - natural * (0.06 * v[36:] + natural * q[36:])])

    step, q, v, found = 2.0 * math.pi / turn / steps, np.zeros(38), np.zeros(38), np.zeros((steps, 2))
    for number in range(3 * steps):
        time = number * step
        a = acceleration(time, q, v)
        b = acceleration(time + 0.5 * step, q + 0.5 * step * v, second := v + 0.5 * step * a)
        c = acceleration(time + 0.5 * step, q + 0.5 * step * second, third := v + 0.5 * step * b)
        d = acceleration(time + step, q + step * third, v + step * c)
        found[number % steps] = 0.2 * a[36:]
        q, v = q + step * (v + step * (a + b + c) / 6.0), v + step * (a + 2.0 * (b + c) + d) / 6.0
    return np.asarray(2.0 * np.fft.rfft(found, axis=0) / steps)


def _lines(model: MeshHarmonicModel) -> dict[int, ComplexArray]:
    """Accelerations of the housing along x and y, by their order in turns of the carrier (2,) [m/s²]."""
    carrier, rows = model.machine.speeds["carrier"], np.array([model.machine.sensor_rows[name] for name in "xy"])
    return {round(one.frequency / carrier): -(one.frequency**2) * (rows @ one.motion) for one in model.parts(LIMIT)}


@pytest.mark.slow
def test_lines_of_flanks_that_swing_are_those_of_an_integration() -> None:
    """Of a force past which the carrier turns there are lines at all turns; without it at odd ones alone."""
    assembled, still = machine(PUSH), machine(0.0)
    phases = np.array([contact.phase for contact in assembled.system.contacts])
    expected, mechanisms = integrated(phases, PUSH), LineMechanisms(assembled)
    carrier = assembled.speeds["carrier"]
    found, without = _lines(mechanisms.model), _lines(LineMechanisms(still).model)
    for turns in (-3, -2, -1, 0, 1, 2, 3):
        order = RING + turns
        assert np.abs(found[order] - expected[order]).max() < 0.09 * np.abs(expected[order]).max()
        if turns % 2 == 0:
            assert np.abs(expected[order]).max() > 0.2 * np.abs(expected[RING + 1]).max()
            assert np.abs(without.get(order, np.zeros(2))).max() < 0.01 * np.abs(expected[order]).max()
        parts = mechanisms.parts(order * carrier)
        assert [parts[name].together for name in "xy"] == pytest.approx(np.abs(found[order]).tolist(), rel=5e-3)


@pytest.mark.slow
def test_friction_of_flanks_that_swing_is_that_of_an_integration() -> None:
    """It halves some lines: the load on a slope has more friction on one side of the pitch line than on the other."""
    assembled = machine(PUSH, friction=0.08)
    expected = integrated(np.array([contact.phase for contact in assembled.system.contacts]), PUSH, friction=0.08)
    found, without = _lines(MeshHarmonicModel(assembled)), _lines(MeshHarmonicModel(machine(PUSH)))
    for turns in (-2, -1, 0, 1, 2):
        size = np.abs(expected[RING + turns]).max()
        assert np.abs(found[RING + turns] - expected[RING + turns]).max() < 0.16 * size
        if turns % 2 == 0:
            assert np.abs(without[RING + turns] - expected[RING + turns]).max() > 0.35 * size
    parts = LineMechanisms(assembled).parts((RING - 2) * assembled.speeds["carrier"])
    assert [parts[name].together for name in "xy"] == pytest.approx(np.abs(found[RING - 2]).tolist(), rel=0.01)


@pytest.mark.slow
def test_flanks_of_unequal_teeth_swing_as_those_of_an_integration() -> None:
    """Pitch deviations of the ring, of a tenth of the teeth's deflection, return in a turn of the carrier."""
    deviations = tuple((3e-7 * np.random.default_rng(3).standard_normal(RING)).tolist())
    assembled = machine(PUSH, deviations=deviations)
    contacts = assembled.system.contacts
    gaps = np.array([contact.contact.pitch_gaps for contact in contacts[3:]])
    expected = integrated(np.array([contact.phase for contact in contacts]), PUSH, gaps=gaps)
    mechanisms, carrier = LineMechanisms(assembled), assembled.speeds["carrier"]
    for turns in (-2, -1, 0, 1, 2):
        parts, size = mechanisms.parts((RING + turns) * carrier), np.abs(expected[RING + turns])
        found = [parts[name].together for name in "xy"]
        assert found == pytest.approx(size.tolist(), abs=0.1 * size.max()), turns


@pytest.mark.slow
@pytest.mark.parametrize(
    ("friction", "deviation", "agree", "at_even"), [(0.0, 0.0, 0.06, 0.06), (0.08, 3e-7, 0.07, 0.19)]
)
def test_motion_has_the_lines_of_flanks_that_swing(
    friction: float, deviation: float, agree: float, at_even: float
) -> None:
    """Over the third turn of the carrier; its contact law knows neither lines nor orders.

    At even turns friction takes away what the swing of the flanks does.
    """
    deviations = tuple((deviation * np.random.default_rng(3).standard_normal(RING)).tolist()) if deviation else ()
    assembled, count = machine(PUSH, SOFTER, friction, deviations, mode_count=1), 4096
    carrier = assembled.speeds["carrier"]
    turn = 2.0 * np.pi / carrier
    of_turn = {"record_from": 2.0 * turn, "sample_interval": turn / count, "largest_step": 0.5 * turn / count}
    settings = TransientSettings(duration=3.0 * turn, **of_turn)
    motion = histories(assembled, simulate(assembled.system, settings, transient_outputs(assembled)))
    spectra = np.array([2.0 * np.fft.rfft(motion.sensor_acceleration[name]) / count for name in "xy"])
    lines = _lines(MeshHarmonicModel(assembled))
    for turns in range(-3, 4):
        of_line = lines[RING + turns]
        bound = agree if turns % 2 else at_even
        assert np.abs(spectra[:, RING + turns] - of_line).max() < bound * np.abs(of_line).max()
