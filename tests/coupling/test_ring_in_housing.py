"""Ring gears whose teeth move with the bore of a housing: harmonics of the bore, and moving forces on its modes."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from gearwhine.coupling import CoupledMachine, CouplingError, Machine
from gearwhine.coupling.linear.carriers.carrier_sidebands import farthest_turns, forced_sidebands
from gearwhine.coupling.linear.carriers.turning_response import SIDEBANDS, TurningResponse
from gearwhine.coupling.linear.complex_modes import coupled_modes
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.coupling.signals.line_names import line_names
from gearwhine.coupling.signals.transfer_paths import housing_connections, housing_paths
from gearwhine.coupling.statics.mean_mesh import mean_contact
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.coupling.time.settings import TransientOutputs, TransientSettings
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


def _described(speed: float = 300.0, planets: int = 3) -> Machine:
    angle = np.radians(20.0)
    parts = plane_set(
        equal_angles(planets),
        pressure_angle=angle,
        with_ring=True,
        damping=1e-5,
        material=STEEL,
        diameter=0.05,
        mode_count=1,
    )
    parts["shafts"] = [replace(shaft, rim_seat="bore") if shaft.name == "ring" else shaft for shaft in parts["shafts"]]
    return Machine(**parts, housing=_ring_housing(), speed=speed, torque=200.0)


def _machine(speed: float = 300.0) -> CoupledMachine:
    return _described(speed).assembled


@pytest.mark.parametrize("planets", [2, 3, 4])
def test_a_bore_of_fewer_orders_than_planets_is_warned_of(planets: int) -> None:
    """The mean forces of N equal planets add up in the orders N, 2 N, … alone, and this bore has three."""
    circle = np.exp(1j * 2.0 * np.pi / planets * np.outer(np.arange(4), np.arange(planets))).sum(axis=1)
    is_excited = np.abs(circle[1:]).max() > 1e-9
    warnings = [text for text in _described(planets=planets).warnings if "ring_orders" in text]
    assert bool(warnings) != is_excited


@pytest.mark.parametrize("turns", [None, 4.05, 4.0])
def test_motion_by_harmonic_balance_satisfies_the_equations_in_time(turns: float | None) -> None:
    """At 950 Hz, and at or near four turns of the carrier, where a motion of the free train stands or nearly so."""
    machine = _machine()
    system = machine.system
    model = TurningResponse(system, mean_contact(system), sidebands=12)
    carrier = machine.speeds["carrier"]
    assert model.rates == pytest.approx([2.0 * carrier, 3.0 * carrier]) or model.rates == pytest.approx([carrier])
    number = next(n for n, contact in enumerate(system.contacts) if contact.name == "planet gear 1 -> ring gear")
    w = 2.0 * np.pi * 950.0 if turns is None else turns * abs(carrier)
    motion = {order: moved[0] for order, moved in model.respond(w, [({}, {number: 1.0})]).items()}
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


def test_forces_on_the_housing_are_all_that_move_it() -> None:
    """Meshes that circle in the ring, its support and the bearings: their paths add up to the housing's motion."""
    machine, housing = _machine(), _ring_housing()
    rows = transient_outputs(machine)
    n = machine.system.size
    start = sum(part.size for part in machine.system.components) - housing.size
    own = np.eye(n)[start:]
    assert machine.system.components[-1].name == "housing"
    outputs = TransientOutputs(
        *(np.vstack([part, own]) for part in (rows.displacement, rows.velocity, rows.acceleration))
    )
    result = simulate(machine.system, TransientSettings(2e-3, 0.0, 1e-5, 1e-5), outputs)
    q, v, a = (part[:, -housing.size :] for part in (result.displacement, result.velocity, result.acceleration))
    left = a + v @ housing.damping + q @ housing.stiffness
    found = histories(machine, result).forces_on_housing
    connections = {one.name: one for one in housing_connections(machine)}
    assert [name for name in connections if "ring gear" in name] == [f"planet gear {k} -> ring gear" for k in (1, 2, 3)]
    pushing = -sum(found[name] @ one.directions.T for name, one in connections.items())
    # Samples between steps are interpolated. Equal planets cancel the order 2 of the ring.
    assert np.abs(left - pushing).max() < 1e-5 * np.abs(pushing).max()
    assert np.ptp(pushing[:, 2:], axis=0).min() > 0.1 * np.abs(pushing).max()
    w = np.array([3000.0])
    with pytest.raises(CouplingError, match="planet gear 1 -> ring gear: forces of shape none"):
        housing_paths(machine, w, {name: part[:1] for name, part in found.items() if "ring gear" not in name})


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


def test_names_of_all_sidebands_are_those_that_the_linear_response_follows() -> None:
    """Lines of a bore of three orders: each is named as the harmonic balance has it, none as free vibration."""
    machine = _machine()
    carrier = machine.speeds["carrier"]
    model = MeshHarmonicModel(machine)
    followed = farthest_turns(forced_sidebands(machine))
    # Bores of 2 and 3 waves: half again as far as 3 turns is less than what is handed on six times by one turn each.
    assert followed == {"carrier": max(SIDEBANDS, 1.5 * 3)}
    model_orders = {abs(dict(one.turns)["carrier"]) for one in model.turning.followed}
    assert max(model_orders) == followed["carrier"]
    frequency = abs(machine.system.contacts[0].mesh_frequency)
    modes = coupled_modes(machine.system, model.contact)
    turns = range(-int(followed["carrier"]), int(followed["carrier"]) + 1)
    lines = [harmonic * frequency + k * carrier / (2.0 * np.pi) for harmonic in (1, 2) for k in turns]
    named = line_names(machine, lines, 1e-3 * carrier / (2.0 * np.pi), modes)
    for number, one in enumerate(named):
        harmonic, k = 1 + number // len(turns), turns[number % len(turns)]
        off = f" {'-' if k < 0 else '+'} {abs(k)}× carrier" if k else ""
        assert one.name == f"{harmonic}× planets' meshes{off}"
        assert one.kind == ("sideband" if k else "mesh")
    # The mean load that circles has the orders of the carrier alone.
    (mean,) = line_names(machine, [3.0 * carrier / (2.0 * np.pi)], 1e-3 * carrier, modes)
    assert (mean.kind, mean.name) == ("shaft", "3× carrier")
    beyond = line_names(machine, [frequency + (followed["carrier"] + 1) * carrier / (2.0 * np.pi)], 1e-3, modes)
    assert beyond[0].kind not in ("sideband", "mesh")
