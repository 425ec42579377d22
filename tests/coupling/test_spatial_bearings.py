"""Bearings of five motions, tables and pedestals in the coupled system, against the rotor alone and by hand."""

import numpy as np
import pytest

from gearwhine.coupling import (
    CouplingError,
    Machine,
    MountedBearing,
    Shaft,
    ShaftForce,
    assemble_machine,
    coupled_modes,
)
from gearwhine.coupling.machine.components import HousingComponent, housing_component, rotor_component
from gearwhine.coupling.statics.static_equilibrium import static_equilibrium
from gearwhine.rotors import (
    Bearing,
    Disc,
    ModalRotor,
    Pedestal,
    Rotor,
    Segment,
    ShaftMaterial,
    modal_rotor,
    solve_whirl,
)

STEEL = ShaftMaterial.from_poisson_ratio(2.1e11, 0.3, 7850.0)
SHAFT = Rotor("shaft", [Segment(0.25, 0.05, 0.0, STEEL)] * 4, [Disc(0.25, 12.0, 0.09, 0.05)])
SPEED = 400.0
TILTING = np.diag([4e7, 5e7, 0.0, 3e5, 2e5])
# A thrust from the tilt and back: the row of an angular-contact bearing.
TILTING[0, 4] = TILTING[4, 0] = 4e5
TILTING[1, 3] = TILTING[3, 1] = -4e5
BEARINGS = (
    Bearing("left", 0.0, TILTING, np.diag([800.0, 500.0, 0.0, 2.0, 3.0])),
    Bearing("right", 1.0, np.diag([3e7, 4e7]), np.zeros((2, 2))),
)


def machine(bearings: tuple[Bearing, ...], speed: float = SPEED):  # type: ignore[no-untyped-def]
    reduced = modal_rotor(SHAFT, [one.at_speed(speed) for one in bearings], count=12, gears_at=[0.25])
    component = rotor_component("shaft", reduced, start=0.0)
    mounted = [MountedBearing(bearing, "shaft", None) for bearing in bearings]
    return assemble_machine([component], None, speeds={"shaft": speed}, bearings=mounted)


def whirl_of(parts) -> np.ndarray:  # type: ignore[no-untyped-def]
    modes = coupled_modes(parts.system)
    keep = np.array([kind == "rotor" for kind in modes.kinds]) & (modes.eigenvalues.imag > 1.0)
    return np.asarray(modes.eigenvalues[keep])


def test_grounded_rotor_in_the_coupled_system_whirls_as_it_does_alone() -> None:
    exact = solve_whirl(SHAFT, BEARINGS, SPEED, count=4).eigenvalues
    found = whirl_of(machine(BEARINGS))[:4]
    assert np.abs(found - exact).max() < 1e-5 * np.abs(exact).max()


def test_tables_are_read_at_the_speed_of_their_rotor() -> None:
    stiffness = np.array([np.diag([2e7, 3e7]), np.diag([4e7, 5e7])])
    tabled = tuple(
        Bearing(name, at, stiffness, np.zeros((2, 2)), np.array([100.0, 400.0]))
        for name, at in (("a", 0.0), ("b", 1.0))
    )
    fixed = tuple(Bearing(name, at, stiffness[1], np.zeros((2, 2))) for name, at in (("a", 0.0), ("b", 1.0)))
    assert np.array_equal(machine(tabled).system.stiffness, machine(fixed).system.stiffness)


def test_pedestal_is_a_mass_between_bearing_and_ground() -> None:
    """A rigid pedestal is none; a heavy soft one adds its own two frequencies; in between, exactly in series."""
    plain = machine(BEARINGS)
    stiff = Pedestal(1e14 * np.eye(2), np.zeros((2, 2)), 1.0)
    on_rock = tuple(Bearing(b.name, b.at, b.stiffness, b.damping, None, stiff) for b in BEARINGS)
    assert np.abs(whirl_of(machine(on_rock))[:4] / whirl_of(plain)[:4] - 1.0).max() < 1e-5
    # Far below the pedestals' own frequency they are springs in series with the bearings.
    light = Pedestal(np.diag([6e7, 8e7]), np.zeros((2, 2)), 1e-3)
    radial = tuple(Bearing.isotropic(b.name, b.at, 5e7) for b in BEARINGS)
    on_springs = tuple(Bearing(b.name, b.at, b.stiffness, b.damping, None, light) for b in radial)
    series = np.linalg.inv(np.linalg.inv(5e7 * np.eye(2)) + np.linalg.inv(light.stiffness))
    together = tuple(Bearing(b.name, b.at, series, b.damping) for b in radial)
    assert np.abs(whirl_of(machine(on_springs))[:4] / whirl_of(machine(together))[:4] - 1.0).max() < 1e-4
    system = machine(on_springs).system
    assert system.kinds.count("pedestal") == 4


def test_pedestal_without_mass_is_refused() -> None:
    bare = Pedestal(1e8 * np.eye(2), np.zeros((2, 2)))
    held = (BEARINGS[0], Bearing("right", 1.0, 3e7 * np.eye(2), np.zeros((2, 2)), None, bare))
    with pytest.raises(CouplingError, match="without mass"):
        machine(held)


def rigid_seat(mass: float, inertia: float, z: float) -> HousingComponent:
    """A free rigid body as housing, with one seat at a height above its centre; six motions of unit modal mass."""
    from gearwhine.housing import Certificate, ModeSet

    modes = ModeSet(np.zeros(6), np.zeros((6, 1, 3)), Certificate(1.0, 6, 6, 0.0, 0.0), {}, "", 0.0, 1)
    motion = np.diag([1.0 / np.sqrt(mass)] * 3 + [1.0 / np.sqrt(inertia)] * 3)
    # Rotations of the body move the seat's centre sideways.
    motion[4, 0], motion[3, 1] = z / np.sqrt(inertia), -z / np.sqrt(inertia)
    return housing_component(modes, np.zeros(6), seats={"seat": motion}, seat_z={"seat": z}, sensors={})


def test_rigid_motion_of_rotor_and_seat_together_strains_no_bearing() -> None:
    """The whole machine turned about any lateral axis, or moved: a bearing of five motions feels nothing."""
    reduced = ModalRotor(modal_rotor(SHAFT, (), count=6).lateral, modal_rotor(SHAFT, (), count=6).torsional)
    component = rotor_component("shaft", reduced, start=-0.3)
    housing = rigid_seat(20.0, 3.0, 0.1)
    bearing = Bearing("b", 0.45, TILTING, np.zeros((5, 5)))
    parts = assemble_machine(
        [component], housing, speeds={"shaft": 0.0}, bearings=[MountedBearing(bearing, "shaft", "seat")]
    )
    rows = parts.system.linear[0].directions.T
    assert rows.shape[0] == 4  # z is held by nothing here
    # Coordinates of rigid motions of the shaft, by its own displacement and slope, x = 1 and x = z.
    lateral = reduced.lateral
    places = np.linspace(0.0, 1.0, 9)
    displacement = component.plane_basis.T @ lateral.evaluate(places)[0]
    for shift, tilt in ((1.0, 0.0), (0.0, 1.0), (0.4, -2.0)):
        target = shift + tilt * (component.start + places)
        q = np.linalg.lstsq(displacement.T, target, rcond=None)[0]
        whole = np.zeros(parts.system.size)
        whole[: lateral.count] = q
        body = np.zeros(6)
        body[0], body[4] = shift * np.sqrt(20.0), tilt * np.sqrt(3.0)
        whole[component.size :] = body
        assert np.abs(rows @ whole).max() < 1e-8


@pytest.mark.parametrize("crossing", ["forces by tilt", "moments by displacement"])
@pytest.mark.parametrize("tabled", [False, True])
def test_unsymmetric_bearing_drives_the_same_whirl_by_rows_as_by_columns(crossing: str, tabled: bool) -> None:
    """Forces by a tilt that no moment resists make the shaft unstable, as it is found alone."""
    radial = np.diag([2e7, 2e7, 0.0, 0.0, 0.0])
    crossed = radial.copy()
    crossed[0, 4], crossed[1, 3] = 3e6, -3e6
    if crossing == "moments by displacement":
        crossed = crossed.T
    stiffness = np.array([radial, crossed]) if tabled else crossed
    speeds = np.array([0.5 * SPEED, SPEED]) if tabled else None
    bearings = (
        Bearing("left", 0.0, stiffness, np.diag([500.0, 500.0]), speeds),
        Bearing("right", 0.9, 1e7 * np.eye(2), 300.0 * np.eye(2)),
    )
    exact = solve_whirl(SHAFT, bearings, SPEED, count=4).eigenvalues
    assert exact.real.max() > 1.0
    found = whirl_of(machine(bearings))[:4]
    assert np.abs(found - exact).max() < 1e-5 * np.abs(exact).max()


def test_force_across_by_a_motion_along_the_axis_acts_where_nothing_resists_that_motion_there() -> None:
    """A thrust F at the right bearing moves the shaft by F / k_z; k_xz of the left one is carried by its own k_xx."""
    along, across, thrust = 5e7, 1e7, 400.0
    slanted = np.diag([4e7, 4e7, 0.0, 0.0, 0.0])
    slanted[0, 2] = across
    bearings = (
        Bearing("left", 0.1, slanted, np.zeros((2, 2))),
        Bearing("right", 0.9, np.diag([3e7, 3e7, along, 0.0, 0.0]), np.zeros((2, 2))),
    )
    whole = Machine(
        [Shaft(SHAFT)],
        [MountedBearing(bearing, "shaft", None) for bearing in bearings],
        speed=SPEED,
        forces=[ShaftForce("shaft", 0.9, (0.0, 0.0, thrust))],
    )
    place = static_equilibrium(whole.assembled.system)
    x, _, z = whole.assembled.rotors[0].motions(0.1)[:3] @ place
    assert z == pytest.approx(thrust / along, rel=1e-6)
    assert x == pytest.approx(-across * thrust / along / 4e7, rel=1e-6)
