"""A base that moves, and gravity: participation, a hand-integrated motion, exact deflections, a spin that is tilted."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from gearwhine.coupling import (
    BaseMotion,
    CoupledMachine,
    CouplingError,
    MachineLoads,
    MountedBearing,
    TransientOutputs,
    TransientSettings,
    assemble_machine,
    simulate,
    static_equilibrium,
)
from gearwhine.coupling.machine.base_motion import BaseHarmonic, BaseHistory, participations
from gearwhine.coupling.machine.components import rotor_component
from gearwhine.rotors import Bearing, Disc, Pedestal, Rotor, Segment, ShaftMaterial, modal_rotor, static_deflection

STEEL = ShaftMaterial.from_poisson_ratio(207e9, 0.3, 7850.0)
SHAFT = Rotor(
    "shaft",
    [Segment(0.5, 0.05, 0.0, STEEL), Segment(0.4, 0.06, 0.02, STEEL, right_outer_diameter=0.09)],
    [Disc(0.3, 30.0, 0.3, 0.2)],
)
START, AXIS = -0.2, (0.3, -0.1)
POINT = (0.05, 0.02, 0.4)


def component(bearings: list[Bearing], count: int = 6, shaft: Rotor = SHAFT):  # type: ignore[no-untyped-def]
    return rotor_component(shaft.name, modal_rotor(shaft, bearings, count=count), start=START, axis=AXIS)


def inertia(about: float) -> float:
    """Diametral inertia of the shaft about a place on its axis, summed over thin slices."""
    total = 0.0
    for part, left in zip(SHAFT.segments, SHAFT.joints[:-1], strict=True):
        assert isinstance(part, Segment)
        total += part.diametral_inertia + part.mass * (left + part.mass_centre - about) ** 2
    return total + sum(disc.diametral_inertia + disc.mass * (disc.at - about) ** 2 for disc in SHAFT.discs)


def test_free_shafts_move_as_rigid_bodies() -> None:
    """Rigid motions lie in a free shaft's modes, so squares of participation are its masses and inertias."""
    held = participations([component([])], POINT, {})
    x, y = np.subtract(AXIS, POINT[:2])
    about = inertia(POINT[2] - START)
    expected = [SHAFT.mass, SHAFT.mass, 0.0, about, about, SHAFT.polar_inertia + SHAFT.mass * (x**2 + y**2)]
    np.testing.assert_allclose((held**2).sum(axis=0), expected, rtol=1e-9)
    # Products: a turn about z moves the centre of mass by (-y, x).
    assert held[:, 0] @ held[:, 5] == pytest.approx(-SHAFT.mass * y, rel=1e-9)
    assert held[:, 1] @ held[:, 5] == pytest.approx(SHAFT.mass * x, rel=1e-9)
    arm = START + SHAFT.centre_of_mass - POINT[2]
    assert held[:, 0] @ held[:, 4] == pytest.approx(SHAFT.mass * arm, rel=1e-9)
    assert held[:, 1] @ held[:, 3] == pytest.approx(-SHAFT.mass * arm, rel=1e-9)


def test_rigid_motions_of_a_shaft_on_bearings_are_its_participation() -> None:
    """Its modes and attachment modes span them; the slopes of these jump at bearings, where no segment ends."""
    law = 1e9 * np.eye(2)
    part = component([Bearing(str(at), at, law, 0.0 * law) for at in (0.17, 0.61)])
    held = participations([part], POINT, {})
    for at in (0.0, 0.17, 0.4, 0.61, 0.9):
        arm = START + at - POINT[2]
        expected = np.array([[1, 0, 0, arm], [0, 1, -arm, 0], [0, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        assert part.motions(at) @ held[:, [0, 1, 3, 4]] == pytest.approx(expected, abs=1e-9)


def test_thrust_bearings_let_the_shaft_be_shaken_along_its_axis() -> None:
    matrix = np.diag([1e7, 1e7, 1e7, 0.0, 0.0])
    part = component([Bearing("one", 0.0, matrix, 0.0 * matrix)])
    held = participations([part], POINT, {})[part.size - part.modal.axial.count :]
    x, y = np.subtract(AXIS, POINT[:2])
    # α × r along z: α_x y - α_y x.
    np.testing.assert_allclose((held**2).sum(axis=0), SHAFT.mass * np.array([0, 0, 1.0, y**2, x**2, 0]), rtol=1e-9)
    np.testing.assert_allclose(held[:, 3] * x, -held[:, 4] * y, rtol=1e-12)


def machine(bearings: list[Bearing], *, count: int = 6, speed: float = 0.0, **loads: object) -> CoupledMachine:
    mounted = [MountedBearing(bearing, "shaft", None) for bearing in bearings]
    rotor = component(bearings, count)
    acting = MachineLoads(**loads)  # type: ignore[arg-type]
    return assemble_machine([rotor], None, speeds={"shaft": speed}, bearings=mounted, loads=acting)


@pytest.mark.parametrize("pedestal", [None, Pedestal(np.diag([4e6, 3e6]), np.zeros((2, 2)), 7.0)])
def test_weight_deflects_as_the_rotor_alone(pedestal: Pedestal | None) -> None:
    """Against the shaft's transfer equations under its weight; the pedestal's own weight by hand."""
    gravity = (3.0, -9.8, 0.0)
    stiffness = np.array([[2e6, 1e5], [1e5, 1e6]])
    bearings = [Bearing("left", 0.0, stiffness, np.zeros((2, 2)))]
    bearings.append(Bearing("right", 0.8, stiffness, np.zeros((2, 2)), pedestal=pedestal))
    parts = machine(bearings, count=20, gravity=gravity)
    q = static_equilibrium(parts.system)
    exact = static_deflection(SHAFT, bearings, gravity=gravity)
    places = np.array([0.0, 0.2, 0.45, 0.9])
    found = np.array([parts.system.components[0].motions(at)[:2] @ q[: parts.rotors[0].size] for at in places]).T
    expected = exact.evaluate(places)[:2]
    if pedestal is not None:
        # The pedestal sinks by its own weight, and the shaft with it turns about the other bearing.
        expected = expected + np.outer(np.linalg.solve(pedestal.stiffness, 7.0 * np.array(gravity[:2])), places / 0.8)
    np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())


def test_one_mass_on_a_shaken_base() -> None:
    """m u'' + c u' + k u = -m a(t), integrated by other means: a stiff body on soft bearings."""
    body = Rotor("shaft", [Segment(0.1, 0.1, 0.0, STEEL)] * 2)
    bearings = [Bearing(str(at), at, 2e4 * np.eye(2), 60.0 * np.eye(2)) for at in (0.0, 0.2)]
    times, values = np.array([0.0, 0.1, 0.15, 0.4]), np.zeros((4, 6))
    values[:, 1] = [0.0, 4.0, -6.0, 0.0]
    amplitude = np.array([0, 2.0 * np.exp(0.3j), 0, 0, 0, 0])
    base = BaseMotion((BaseHistory(times, values), BaseHarmonic(70.0, amplitude)))
    rotor = rotor_component("shaft", modal_rotor(body, bearings, count=2), start=0.0)
    mounted = [MountedBearing(bearing, "shaft", None) for bearing in bearings]
    parts = assemble_machine([rotor], None, speeds={"shaft": 0.0}, bearings=mounted, loads=MachineLoads(base=base))
    row = np.pad(rotor.direction(0.1, 1), (0, parts.system.size - rotor.size))[None, :]
    settings = TransientSettings(0.6, 0.0, 1e-3, 2e-4, tolerance=1e-4)
    result = simulate(parts.system, settings, TransientOutputs(row, row, row))

    def shaken(time: float) -> float:
        return float(np.interp(time, times, values[:, 1]) + 2.0 * np.cos(70.0 * time + 0.3))

    found = solve_ivp(
        lambda t, s: [s[1], -shaken(t) - (120.0 * s[1] + 4e4 * s[0]) / body.mass],
        (0.0, 0.6),
        [0.0, 0.0],
        t_eval=result.times,
        rtol=1e-9,
        atol=1e-12,
        max_step=1e-3,
    )
    # The body bends a little: one part in ten thousand.
    np.testing.assert_allclose(result.displacement[:, 0], found.y[0], atol=1e-3 * np.abs(found.y[0]).max())
    relative = result.acceleration[:, 0] + base.acceleration(result.times)[:, 1]
    spring = -(120.0 * found.y[1] + 4e4 * found.y[0]) / body.mass
    np.testing.assert_allclose(relative, spring, atol=5e-3 * np.abs(spring).max())


@pytest.mark.parametrize("about", ["x", "y"])
@pytest.mark.parametrize("table", [False, True])
def test_tilting_base_feels_the_spin(about: str, table: bool) -> None:
    """dL/dt = ω × I_p Ω: on a slowly tilting base a shaft loads its bearings with a moment I_p Ω ω."""
    spin, rate = 500.0, 0.02
    column = 3 if about == "x" else 4
    stiffness = 1e8 * np.eye(2)
    bearings = [Bearing(str(at), at, stiffness, 0.0 * stiffness) for at in (0.0, 0.9)]
    if table:
        # A short push to the rate, and steady after it.
        values = np.zeros((3, 6))
        values[1, column] = 2.0 * rate
        base = BaseMotion((BaseHistory(np.array([0.0, 0.5, 1.0]), values),))
        parts = machine(bearings, speed=spin, base=base)
        load = sum(one.at(5.0) for one in parts.system.timed_loads)
        q = np.linalg.lstsq(parts.system.stiffness, load, rcond=1e-12)[0]
    else:
        frequency = 1e-3
        amplitude = np.zeros(6, dtype=np.complex128)
        amplitude[column] = 1j * frequency * rate
        parts = machine(bearings, speed=spin, base=BaseMotion((BaseHarmonic(frequency, amplitude),)))
        (harmonic,) = parts.system.harmonic_loads
        q = np.linalg.lstsq(parts.system.stiffness, harmonic.amplitude, rcond=1e-12)[0].real
    moment = SHAFT.polar_inertia * spin * rate
    forces = np.array([connector.stiffness @ connector.directions.T @ q for connector in parts.system.linear])
    # ω_x: L turns by -ω_x L along y, for which forces on the shaft need M_y = Σ z F_x < 0; the bearings feel the
    # opposite. ω_y: L turns by +ω_y L along x, M_x = -Σ z F_y > 0.
    across = forces[:, 0] if about == "x" else forces[:, 1]
    np.testing.assert_allclose(across * 0.9, [-moment, moment], rtol=2e-2)
    along = forces[:, 1] if about == "x" else forces[:, 0]
    assert np.abs(along).max() < 2e-2 * np.abs(across).max()


def test_absolute_acceleration_of_a_place() -> None:
    """a + α × (r - p), along a direction."""
    amplitude = np.array([1.0, -2.0, 0.5, 0.3, 0.7, -0.2])
    base = BaseMotion((BaseHarmonic(10.0, amplitude.astype(np.complex128)),), POINT)
    place, direction = np.array([0.4, 0.2, -0.3]), np.array([0.6, 0.0, 0.8])
    full = amplitude[:3] + np.cross(amplitude[3:], place - POINT)
    times = np.linspace(0.0, 1.0, 5)
    np.testing.assert_allclose(base.acceleration_at(place, direction, times), full @ direction * np.cos(10.0 * times))


def test_tables_of_another_shape() -> None:
    with pytest.raises(CouplingError, match="expected six finite accelerations for each"):
        BaseHistory(np.array([0.0, 1.0]), np.zeros((2, 3)))
