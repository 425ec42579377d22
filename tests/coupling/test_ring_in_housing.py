"""Ring gears whose teeth move with the bore of a housing: harmonics of the bore, and moving forces on its modes."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from gearwhine.coupling import CoupledMachine, Machine
from gearwhine.coupling.analyses import modes_and_responses
from gearwhine.coupling.analyses.modes_and_responses import solve_system
from gearwhine.coupling.description.gear_train import Output
from gearwhine.coupling.description.parts import TorqueSupport
from gearwhine.coupling.gears import SquareStiffness
from gearwhine.coupling.linear.line_mechanisms import LineMechanisms
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel
from gearwhine.coupling.linear.turning_response import TurningResponse
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.coupling.statics.mean_mesh import mean_contact
from gearwhine.coupling.sweep.resonances import find_resonances
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.coupling.time.settings import TransientSettings
from gearwhine.coupling.time.transient import simulate
from gearwhine.housing.model.patches import patch_center, rigid_motions, ring_matrix
from gearwhine.meshes import ElementBlock, Mesh
from tests.machines.plane_planetary_set import STEEL, equal_angles, plane_set

FloatArray = npt.NDArray[np.float64]


def _tube(around: int = 96, radius: float = 0.1, thickness: float = 0.02, length: float = 0.03) -> Mesh:
    """A tube about an axis off the origin, of hexahedra, with its bore as a named surface."""
    angles = 2.0 * np.pi * np.arange(around) / around
    rings = [
        np.column_stack([0.3 + r * np.cos(angles), r * np.sin(angles) - 0.2, np.full(around, z)])
        for z in (0.0, length)
        for r in (radius, radius + thickness)
    ]
    inner, outer, inner_top, outer_top = (around * place + np.arange(around) for place in range(4))
    after = np.roll(np.arange(around), -1)
    corners = [part for low in ((inner, outer), (inner_top, outer_top)) for part in low]
    a, b, c, d = corners
    cells = np.column_stack([a, b, b[after], a[after], c, d, d[after], c[after]])
    facets = np.column_stack([a, a[after], c[after], c])
    return Mesh(
        np.concatenate(rings), (ElementBlock("hexahedron", cells),), surfaces={"bore": (ElementBlock("quad", facets),)}
    )


def test_rows_of_a_bore_read_its_harmonics_and_no_rigid_motion() -> None:
    mesh, center = _tube(), np.array([0.3, -0.2, 0.015])
    facets = mesh.surface("bore")
    assert np.allclose(patch_center(mesh, facets), center, atol=1e-12)
    rows = ring_matrix(mesh, facets, center, 3)
    assert np.abs(rows @ rigid_motions(mesh.points, center).reshape(-1, 6)).max() < 1e-12
    x, y = (mesh.points[:, axis] - center[axis] for axis in (0, 1))
    angle = np.arctan2(y, x)
    radial, along = np.stack([np.cos(angle), np.sin(angle)], 1), np.stack([-np.sin(angle), np.cos(angle)], 1)
    for order in (2, 3):
        field = np.zeros((len(angle), 3))
        field[:, :2] = 2.0 * np.cos(order * angle)[:, None] * radial - 0.5 * np.sin(order * angle)[:, None] * along
        expected = np.zeros(14)
        expected[4 * order - 2], expected[4 * order + 1] = 2.0, -0.5
        # Chords of 96 facets stand for the circle.
        assert rows @ field.ravel() == pytest.approx(expected, abs=0.01)


def _ring_housing() -> HousingComponent:
    """A ring that bends in its plane: u_r = cos nθ and u_t = -sin nθ / n and their quarter turns, n = 2 and 3."""
    frequencies = 2.0 * np.pi * np.array([900.0, 900.0, 2400.0, 2400.0])
    motions = np.zeros((4, 14))
    for place, (order, size) in enumerate(((2, 0.5), (2, 0.5), (3, 0.4), (3, 0.4))):
        first = 4 * order - 2
        if place % 2 == 0:
            motions[place, first], motions[place, first + 3] = size, -size / order
        else:
            motions[place, first + 1], motions[place, first + 2] = size, size / order
    return HousingComponent(
        name="housing",
        kinds=("housing",) * 4,
        stiffness=np.diag(frequencies**2),
        damping=np.diag(0.02 * frequencies),
        gyroscopic=np.zeros((4, 4)),
        seats={"bore": np.zeros((4, 6))},
        seat_z={"bore": 0.05},
        sensors={"top": motions[:, 6] + motions[:, 10]},  # radial at θ = 0
        ring_motions={"bore": motions},
    )


def _machine(speed: float = 300.0) -> CoupledMachine:
    parts = plane_set(
        equal_angles(3), pressure_angle=np.radians(20.0), with_ring=True, damping=1e-5, material=STEEL, diameter=0.05
    )
    parts["shafts"] = [replace(shaft, rim_seat="bore") if shaft.name == "ring" else shaft for shaft in parts["shafts"]]
    return Machine(**parts, housing=_ring_housing(), speed=speed, torque=200.0).assembled


def _varying(held: str) -> CoupledMachine:
    """The machine with meshes whose stiffness varies, its ring or its carrier held."""
    parts = plane_set(
        equal_angles(3), pressure_angle=np.radians(20.0), with_ring=True, damping=1e-5, material=STEEL, diameter=0.05
    )
    parts["shafts"] = [replace(shaft, rim_seat="bore") if shaft.name == "ring" else shaft for shaft in parts["shafts"]]
    parts["gear_pairs"] = [replace(pair, stiffness=SquareStiffness(3e8)) for pair in parts["gear_pairs"]]
    if held == "carrier":
        parts |= {"torque_supports": [TorqueSupport("carrier", 0.05, stiffness=2e6)], "outputs": [Output("ring")]}
    housing = replace(_ring_housing(), complete_below=2.0 * np.pi * 3e3)
    return Machine(**parts, housing=housing, speed=300.0, torque=200.0).assembled


def test_motion_by_harmonic_balance_satisfies_the_equations_in_time() -> None:
    machine = _machine()
    system = machine.system
    model = TurningResponse(system, mean_contact(system), sidebands=12)
    carrier = machine.speeds["carrier"]
    assert model.rates == pytest.approx([2.0 * carrier, 3.0 * carrier]) or model.rates == pytest.approx([carrier])
    number = next(n for n, contact in enumerate(system.contacts) if contact.name == "planet gear 1 -> ring gear")
    w = 2.0 * np.pi * 950.0
    motion = {order: moved[0] for order, moved in model.respond(w, [model.mesh_error(number, w)]).items()}
    times = np.linspace(0.0, 2.0 * np.pi / carrier, 9)
    orders = [(w + model.shift(order), q) for order, q in motion.items()]
    for time in times:
        q, v, a = (
            sum(
                ((1j * rate) ** power * np.exp(1j * rate * time) * part for rate, part in orders), np.zeros(system.size)
            )
            for power in (0, 1, 2)
        )
        left = a + (system.own_damping + system.gyroscopic) @ v + system.own_stiffness @ q
        largest = 0.0
        state = mean_contact(system)
        laws = [(one.directions, one.stiffness, one.damping, one.turning, 0.0) for one in system.linear]
        laws += [
            (one.direction[:, None], np.diag([k]), np.diag([c]), one.turning, float(place == number))
            for place, (one, k, c) in enumerate(zip(system.contacts, state.stiffness, state.damping, strict=True))
        ]
        for directions, stiffness, damping, turning, error in laws:
            now = directions + sum(part.change(time) for part in turning)
            step = 1e-7
            rate = sum((part.change(time + step) - part.change(time - step) for part in turning), 0.0) / (2.0 * step)
            e = error * np.exp(1j * w * time)
            force = stiffness @ (now.T @ q - e)
            force = force + damping @ (now.T @ v + (np.transpose(rate) @ q if turning else 0.0) - 1j * w * e)
            left = left + now @ force
            largest = max(largest, float(np.abs(now @ force).max()))
        assert np.abs(left).max() < 1e-6 * largest


def test_no_lines_of_frozen_carriers_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three meshes in phase push the third order of the bore, which a sensor hears beside the mesh harmonic alone."""
    monkeypatch.setattr(modes_and_responses, "resonance_grid", lambda *_: np.array([2e3, 5e3]))
    turning, held = _varying("ring"), _varying("carrier")
    w = 2.0 * np.pi * abs(turning.system.contacts[0].mesh_frequency)
    frozen = MeshHarmonicModel(turning)
    (number,) = [n for n, one in enumerate(turning.system.contacts) if one.name == "planet gear 1 -> ring gear"]
    assert turning.system.contacts[number].turning
    model, row = TurningResponse(turning.system, frozen.contact), turning.sensor_rows["top"]
    (line,) = frozen.parts(1.1 * w)
    errors, load = dict[int, complex](), np.zeros(turning.system.size, dtype=np.complex128)
    for contact, harmonic in line.causes:
        tooth, law = turning.system.contacts[contact], frozen.contact.stiffness[contact]
        error = frozen._errors[contact][harmonic - 1]
        if tooth.turning:
            errors[contact] = law * error / (law + 1j * w * frozen.contact.damping[contact])
        else:
            load += law * error * tooth.direction
    motion = model.respond(w, [({model.still: load}, errors)])
    heard = {order: abs(row @ moved[0]) for order, moved in motion.items()}
    assert heard[model.still] < 1e-9 * max(heard.values())
    assert abs(row @ line.motion) > 0.5 * max(heard.values())

    assert solve_system(turning).lines == ()
    assert LineMechanisms(turning).parts(w) == {}
    assert find_resonances(turning, 3e3) is None
    # Where the carrier stands still there are no sidebands.
    w = 2.0 * np.pi * abs(held.system.contacts[0].mesh_frequency)
    assert len(solve_system(held).lines) > 0
    assert LineMechanisms(held).parts(w)["top"].together > 0.0
    assert find_resonances(held, 3e3) is not None


@pytest.mark.slow
def test_sidebands_at_a_sensor_are_those_of_moving_forces() -> None:
    """Modes of the ring under the recorded mesh forces, which circle with the carrier: a closed form at each line."""
    speed, turns = 300.0, 4
    machine, housing = _machine(speed), _ring_housing()
    carrier = machine.speeds["carrier"]
    period = 2.0 * np.pi / carrier
    count = 8192
    settings = TransientSettings(
        duration=2.0 * turns * period,
        record_from=turns * period,
        sample_interval=turns * period / count,
        largest_step=period / 4096,
        tolerance=5e-4,
    )
    result = simulate(machine.system, settings, transient_outputs(machine))
    found = np.fft.rfft(histories(machine, result).sensor_acceleration["top"]) / count
    times = result.times
    modal = np.zeros((4, count))
    names = [contact.name for contact in machine.system.contacts]
    pressure = np.radians(20.0)
    motions = housing.ring_motions["bore"]
    for planet in range(3):
        force = result.force[:, names.index(f"planet gear {planet + 1} -> ring gear")]
        angle = 2.0 * np.pi * planet / 3.0 + carrier * times
        # The planet, driven clockwise, pushes the ring outward and against the circle.
        outward, along = np.sin(pressure) * force, -np.cos(pressure) * force
        for order in (2, 3):
            a, b, c, d = motions[:, 4 * order - 2 : 4 * order + 2].T[..., None]
            modal += (a * np.cos(order * angle) + b * np.sin(order * angle)) * outward
            modal += (c * np.cos(order * angle) + d * np.sin(order * angle)) * along
    w = 2.0 * np.pi * np.fft.rfftfreq(count, settings.sample_interval)
    natural, damping = np.diag(housing.stiffness)[:, None], np.diag(housing.damping)[:, None]
    answer = -(w**2) * np.fft.rfft(modal, axis=1) / count / (natural + 1j * w * damping - w**2)
    expected = housing.sensors["top"] @ answer
    lines = np.argsort(np.abs(expected[: count // 8]))[-12:]
    assert found[lines] == pytest.approx(expected[lines], rel=0.02, abs=0.01 * np.abs(expected[lines]).max())
    # Equal planets in phase leave lines at multiples of three turns of the carrier; a line is `turns` bins a turn.
    strong = np.flatnonzero(np.abs(found[: count // 8]) > 1e-3 * np.abs(found[: count // 8]).max())
    assert np.all(strong % (3 * turns) == 0)
