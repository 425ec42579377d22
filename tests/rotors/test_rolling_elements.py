"""Energy of a bearing's elements over the inner ring's displacement: its slopes, and energies found another way."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import optimize

from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.trust_region import Local, minimise
from gearwhine.rotors import EquilibriumError, RotorError
from gearwhine.rotors.rolling_bearings import (
    BallRow,
    FourPointRow,
    RollerRow,
    RollingBearing,
    RollingElements,
    SphericalRollerRow,
    TaperedRollerRow,
    paired,
    rolling_equilibrium,
    rolling_state,
    spherical_groove,
)

ANGULAR = BallRow(13, 8.1e-3, 38.5e-3, math.radians(25.0))
ROLLERS = RollerRow(14, 11e-3, 11e-3, 60e-3, clearance=5e-6)
FLANGED = replace(ROLLERS, flanges="both", flange_stiffness=5e6, axial_clearance=10e-6)
TAPERED = TaperedRollerRow(17, 9e-3, 14e-3, 61e-3, angle=math.radians(14.0), position=2e-3)
SPHERICAL = SphericalRollerRow(18, 11e-3, 10e-3, 66e-3, angle=math.radians(11.0), clearance=8e-6)
FOUR_POINT = FourPointRow(13, 9.5e-3, 50e-3, math.radians(35.0), clearance=6e-6)
SELF_ALIGNING = BallRow(14, 8e-3, 45e-3, 0.2, outer_groove=spherical_groove(8e-3, 45e-3, 0.2))
PLACE = np.array([8e-6, -12e-6, 15e-6, 2e-4, -1e-4])


def differences(elements: RollingElements, place: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Slopes of the energy (5,) and of the gradient (5, 5) by central differences.

    The second step is short: the tangent of a slice that just touches grows as δ^{1/9}.
    """
    slope, tangent = np.empty(5), np.empty((5, 5))
    for i, step in enumerate((1e-8, 1e-8, 1e-8, 1e-6, 1e-6)):
        ahead, behind = (elements.at(place + sign * step * np.eye(5)[i]) for sign in (1.0, -1.0))
        slope[i] = (ahead.value - behind.value) / (2.0 * step)
        ahead, behind = (elements.at(place + sign * 1e-2 * step * np.eye(5)[i]) for sign in (1.0, -1.0))
        tangent[i] = (ahead.gradient - behind.gradient) / (2e-2 * step)
    return slope, tangent


BEARINGS = {
    "deep groove": (RollingBearing([BallRow(7, 11.5e-3, 43.5e-3, clearance=5e-6)]), 0.0),
    "spring": (RollingBearing([ANGULAR], axial_preload=200.0), 0.0),
    "in motion": (RollingBearing([ANGULAR], axial_preload=200.0), 900.0),
    "paired": (paired(ANGULAR, "back to back", 15e-3, preload=150.0), 0.0),
    "rollers": (RollingBearing([ROLLERS]), 0.0),
    "thrown rollers": (RollingBearing([ROLLERS]), 900.0),
    "flanges": (RollingBearing([FLANGED], axial_preload=50.0), 0.0),
    "tapered": (RollingBearing([TAPERED]), 0.0),
    "thrown tapered": (RollingBearing([TAPERED.facing(-1)]), 900.0),
    "paired tapered": (paired(TAPERED, "face to face", 25e-3, preload=1500.0), 0.0),
    "spherical": (RollingBearing([SPHERICAL.facing(1), SPHERICAL.facing(-1)]), 0.0),
    "four-point": (RollingBearing([FOUR_POINT]), 0.0),
    "thrown four-point": (RollingBearing([FOUR_POINT]), 2000.0),
    "thrown self-aligning": (paired(SELF_ALIGNING, "face to face", 45e-3 * math.tan(0.2)), 600.0),
    "self-aligning": (paired(SELF_ALIGNING, "face to face", 45e-3 * math.tan(0.2)), 0.0),
    "floating": (RollingBearing([BallRow(7, 11.5e-3, 43.5e-3, clearance=5e-6)], floating=True), 0.0),
    "thrown floating": (RollingBearing([BallRow(7, 11.5e-3, 43.5e-3, clearance=5e-6)], floating=True), 900.0),
    "floating four-point": (RollingBearing([FOUR_POINT], floating=True), 0.0),
    "floating spherical": (RollingBearing([SPHERICAL.facing(1), SPHERICAL.facing(-1)], floating=True), 0.0),
}


@pytest.mark.parametrize("kind", BEARINGS)
def test_force_and_tangent_are_slopes_of_the_energy(kind: str) -> None:
    elements = RollingElements(*BEARINGS[kind], cage_angle=0.2)
    slope, tangent = differences(elements, PLACE)
    here = elements.at(PLACE)
    size = np.array([1.0, 1.0, 1.0, *[elements.bearing.reach] * 2])
    np.testing.assert_allclose(here.gradient / size, slope / size, atol=1e-5 * np.abs(slope / size).max())
    even = np.outer(size, size)
    np.testing.assert_allclose(here.hessian / even, tangent / even, atol=1e-6 * np.abs(tangent / even).max())
    np.testing.assert_array_equal(here.hessian, here.hessian.T)


def in_plane(row: TaperedRollerRow, azimuth: float, q: FloatArray) -> tuple[FloatArray, float]:
    """Displacement of the inner ring at a roller's middle (radial, axial), and its rotation in the roller's plane."""
    radial = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    turned = np.array([q[3], q[4], 0.0])
    moved = q[:3] + np.cross(turned, 0.5 * row.pitch_diameter * radial + [0.0, 0.0, row.position])
    # A rotation that takes the radius towards z.
    return np.array([moved @ radial, moved[2]]), float(np.cross(turned, radial)[2])


def tapered_energy(row: TaperedRollerRow, q: FloatArray, thrown: float = 0.0) -> tuple[float, list[float]]:
    """Least energy over every roller's motion across its axis and its tilt; slices at both raceways, a rigid rib.

    Returns the energy and the inner raceway's load on every roller.
    """
    half, slender = 0.0, row.roller_diameter / row.pitch_diameter
    for _ in range(100):
        half = math.atan(slender * math.sin(row.angle - half))
    sign, axis = row.direction, row.angle - half
    along, across = (
        np.array([math.sin(axis), -sign * math.cos(axis)]),
        np.array([math.cos(axis), sign * math.sin(axis)]),
    )
    normals = [math.cos(half) * across + side * math.sin(half) * along for side in (1.0, -1.0)]
    stiffness = 2.0 ** (10.0 / 9.0) * row.stiffness / row.slices
    # Lines of contact, inclined by half the angle of the cone, from the roller's cross-section in the middle.
    lines = [math.cos(half) * along + side * math.sin(half) * across for side in (-1.0, 1.0)]
    middles = [side * 0.5 * row.roller_diameter * across for side in (-1.0, 1.0)]
    total, loads = 0.0, []
    for roller in range(row.count):
        azimuth = 2.0 * math.pi * roller / row.count
        shift, turn = in_plane(row, azimuth, q)

        def swept(place: FloatArray, angle: float) -> FloatArray:
            return angle * np.array([-place[1], place[0]])

        def depths(part: FloatArray, shift: FloatArray = shift, turn: float = turn) -> list[FloatArray]:
            moved = (along @ shift) * along + 1e-6 * part[0] * across
            angle, result = 1e-4 * part[1], []
            for side in (0, 1):
                deep = np.empty(row.slices)
                for k, x in enumerate(row.slice_places):
                    place = middles[side] + x * lines[side]
                    own = moved + swept(place, angle)
                    ring = shift + swept(place, turn) if side == 0 else np.zeros(2)
                    deep[k] = normals[side] @ (ring - own) * (1.0 if side == 0 else -1.0) - row.slice_drops[k]
                result.append(np.maximum(deep, 0.0))
            return result

        def energy(part: FloatArray, shift: FloatArray = shift) -> float:
            moved = (along @ shift) * along[0] + 1e-6 * part[0] * across[0]
            stored = sum(float((deep ** (19.0 / 9.0)).sum()) for deep in depths(part))
            return 1e3 * (9.0 / 19.0 * stiffness * stored - thrown * moved)

        start = [1e6 * 0.5 * float(across @ shift), 1e4 * 0.5 * turn]
        found = optimize.minimize(energy, start, method="Nelder-Mead", options={"xatol": 1e-8, "fatol": 1e-13})
        total += 1e-3 * found.fun
        loads.append(stiffness * float((depths(found.x)[0] ** (10.0 / 9.0)).sum()))
    return total, loads


@pytest.mark.parametrize("direction", [1, -1])
def test_tapered_rollers_balance_between_raceways_and_rib(direction: int) -> None:
    """The rollers' own motions minimise the energy of both raceways: no slice of the row need know of them."""
    row = replace(TAPERED, direction=direction, count=5, slices=15)
    place = np.array([15e-6, -8e-6, direction * 60e-6, 5e-4, -4e-4])
    total, loads = tapered_energy(row, place)
    state = rolling_state(RollingBearing([row]), place)
    assert RollingElements(RollingBearing([row])).at(place).value == pytest.approx(total, rel=1e-7)
    np.testing.assert_allclose(state.rows[0].inner_load, loads, rtol=1e-4, atol=1e-4 * max(loads))


def test_thrown_tapered_rollers_lean_on_cup_and_rib() -> None:
    """A straight roller without tilt bears its centrifugal force alike in every slice; energy but for a constant."""
    row, speed = replace(TAPERED, profile="straight", count=5, slices=5), 3000.0
    place, other = np.array([5e-6, 3e-6, 60e-6, 0.0, 0.0]), np.array([2e-6, 0.0, 30e-6, 0.0, 0.0])
    thrown = row.centrifugal_force(speed)
    expected = tapered_energy(row, place, thrown)[0] - tapered_energy(row, other, thrown)[0]
    elements = RollingElements(RollingBearing([row]), speed)
    assert elements.at(place).value - elements.at(other).value == pytest.approx(expected, rel=1e-6)


def test_forces_on_every_tapered_roller_balance() -> None:
    """Both raceways, the rib along the roller's axis, and the centrifugal force, over radius and axis."""
    speed = 1200.0
    state = rolling_equilibrium(RollingBearing([TAPERED]), [2000.0, 500.0, 3000.0, 0.0, 0.0], speed=speed)
    (row,) = state.rows
    assert row.rib_load is not None
    axis = TAPERED.angle - TAPERED.roller_angle
    inner = row.inner_load * np.array([np.cos(row.inner_angle), np.sin(row.inner_angle)])
    outer = row.outer_load * np.array([np.cos(row.outer_angle), np.sin(row.outer_angle)])
    rib = row.rib_load * np.array([[-math.sin(axis)], [math.cos(axis)]])
    thrown = np.array([[TAPERED.centrifugal_force(speed)], [0.0]])
    assert np.abs(inner + rib + thrown - outer).max() < 1e-12 * row.outer_load.max()
    assert (inner + rib)[1].sum() == pytest.approx(3000.0, rel=1e-9)
    # All cones meet in one point of the axis.
    apex = 0.5 * TAPERED.pitch_diameter / math.tan(axis)
    foot = 0.5 * TAPERED.pitch_diameter + 0.5 * TAPERED.roller_diameter * math.cos(axis)
    height = apex - 0.5 * TAPERED.roller_diameter * math.sin(axis)
    assert foot / height == pytest.approx(math.tan(TAPERED.angle), rel=1e-12)


def test_spherical_rollers_carry_no_moment() -> None:
    state = rolling_equilibrium(BEARINGS["spherical"][0], [3000.0, 0.0, 700.0, 0.0, 0.0], held={"rx": 2e-3, "ry": 0.0})
    assert np.abs(state.load[3:]).max() < 1e-12
    assert state.loose == ("rx", "ry")
    assert state.rows[0].inner_load.sum() > state.rows[1].inner_load.sum()


def test_self_aligning_balls_carry_no_moment() -> None:
    """Their force lines meet in the centre but for the ring's own displacement, of some micrometres."""
    bearing = BEARINGS["self-aligning"][0]
    tilted = rolling_state(bearing, [15e-6, 0.0, 20e-6, 1e-3, 0.0])
    assert np.abs(tilted.load[3:]).max() < 2e-3 * bearing.reach * np.abs(tilted.load[:3]).max()
    assert tilted.load[0] > 0.0
    assert bearing.rows[0].outer_contact.ellipticity == 1.0  # type: ignore[union-attr]


def test_flanges_are_springs_with_play() -> None:
    """Of 14 rollers each 5e6 N/m beyond 5 µm; tilted, (14/2) k R² in the direction of the tilt."""
    bearing = RollingBearing([replace(ROLLERS, flanges="one", flange_stiffness=5e6, axial_clearance=10e-6)])
    state = rolling_equilibrium(bearing, [0.0, 0.0, 700.0, 0.0, 0.0], held={"rx": 0.0, "ry": 0.0})
    assert state.displacement[2] == pytest.approx(5e-6 + 700.0 / (14 * 5e6), rel=1e-9)
    assert state.stiffness[3, 3] == pytest.approx(7 * 5e6 * 0.03**2, rel=1e-9)
    assert state.rows[0].rib_load is not None
    assert state.rows[0].rib_load.sum() == pytest.approx(700.0)
    both = rolling_state(RollingBearing([FLANGED]), [0.0, 0.0, -8e-6, 0.0, 0.0])
    assert both.load[2] == pytest.approx(-14 * 5e6 * 3e-6, rel=1e-9)
    with pytest.raises(EquilibriumError, match="carry axial load one way only"):
        rolling_equilibrium(bearing, [0.0, 0.0, -700.0, 0.0, 0.0])


@pytest.mark.parametrize("speed", [0.0, 2500.0])
def test_energy_of_balls_in_four_point_contact_is_the_least_over_their_places(speed: float) -> None:
    """⅖ K (|c − p| − A)^{5/2} of two inner and two outer arcs, by Nelder and Mead's method for every ball."""
    row, thrown = FOUR_POINT, FOUR_POINT.centrifugal_force(speed)
    arms = (row.inner_groove - 0.5) * row.ball_diameter, (row.outer_groove - 0.5) * row.ball_diameter
    cosine, sine = math.cos(row.contact_angle), math.sin(row.contact_angle)
    for place in ([12e-6, 4e-6, 9e-6, 1e-4, 2e-4], [2e-6, 0.0, 40e-6, 0.0, 0.0], [1e-6, 0.0, 0.0, 0.0, 0.0]):
        x, y, z, rx, ry = place
        total = 0.0
        for ball in range(row.count):
            c, s = math.cos(2.0 * math.pi * ball / row.count), math.sin(2.0 * math.pi * ball / row.count)
            centres = []
            for side in (1.0, -1.0):
                radius, height = 0.5 * row.pitch_diameter + arms[0] * cosine, side * arms[0] * sine
                tilt = ry * c - rx * s
                moved = [x * c + y * s + height * tilt - 0.5 * row.clearance, z - radius * tilt]
                centres.append(
                    (row.inner_contact.stiffness, arms[0], arms[0] * np.array([cosine, side * sine]) + moved)
                )
                centres.append((row.outer_contact.stiffness, arms[1], -arms[1] * np.array([cosine, side * sine])))

            def energy(p: FloatArray, centres: list[tuple[float, float, FloatArray]] = centres) -> float:
                stored = sum(
                    0.4 * k * max(float(np.linalg.norm(centre - 1e-5 * p)) - arm, 0.0) ** 2.5
                    for k, arm, centre in centres
                )
                return 1e3 * (stored - thrown * 1e-5 * float(p[0]))

            options = {"xatol": 1e-9, "fatol": 1e-14, "maxiter": 2000}
            total += 1e-3 * optimize.minimize(energy, [0.1, 0.1], method="Nelder-Mead", options=options).fun
        found = RollingElements(RollingBearing([row]), speed).at(np.array(place)).value
        assert found == pytest.approx(total, rel=1e-7, abs=1e-12)


def test_light_four_point_contact_is_two_rows_of_angular_contact() -> None:
    """To first order in approach over groove distance the diagonals do not know of each other."""
    row = replace(FOUR_POINT, inner_groove=0.6, outer_groove=0.6)
    place = np.array([2e-6, 3e-6, 1e-6, 1e-5, 0.0])
    four = RollingElements(RollingBearing([row])).at(place)
    two = RollingElements(RollingBearing(row.arcs)).at(place)
    assert four.value == pytest.approx(two.value, rel=1e-2)
    assert four.value <= two.value * (1.0 + 1e-2)
    np.testing.assert_allclose(four.gradient, two.gradient, atol=1e-2 * np.abs(two.gradient).max())


def test_four_point_balls_carry_thrust_both_ways() -> None:
    for sign in (1.0, -1.0):
        state = rolling_equilibrium(RollingBearing([FOUR_POINT]), [0.0, 0.0, sign * 500.0, 0.0, 0.0], speed=4000.0)
        (loads,) = state.rows
        thrust = loads.inner_load * np.sin(loads.inner_angle)
        assert thrust.sum() == pytest.approx(sign * 500.0, rel=1e-8)
        assert loads.loaded == 13
        # Thrown balls touch three arcs: one of the inner ring, both of the outer.
        assert np.count_nonzero(loads.inner_load) == 13
        assert np.count_nonzero(loads.outer_load) == 26


def test_energy_of_a_thrown_ball_is_the_least_over_its_place() -> None:
    """⅖ K_i (|v − p| − A_i)^{5/2} + ⅖ K_o (|p| − A_o)^{5/2} − F_c p_r, minimised over the ball's centre p."""
    speed, row = 1500.0, ANGULAR
    thrown = row.centrifugal_force(speed)
    arms = (row.inner_groove - 0.5) * row.ball_diameter, (row.outer_groove - 0.5) * row.ball_diameter
    radius = 0.5 * row.pitch_diameter + arms[0] * math.cos(row.contact_angle)
    height = arms[0] * math.sin(row.contact_angle)
    x, y, z, rx, ry = PLACE
    total = 0.0
    for ball in range(row.count):
        c, s = math.cos(2.0 * math.pi * ball / row.count), math.sin(2.0 * math.pi * ball / row.count)
        v = sum(arms) * np.array([math.cos(row.contact_angle), math.sin(row.contact_angle)])
        v = v + [x * c + y * s + height * (ry * c - rx * s), z - radius * (ry * c - rx * s)]

        def energy(p: FloatArray, v: FloatArray = v) -> float:
            inside, outside = (
                contact.stiffness * max(float(np.linalg.norm(along)) - arm, 0.0) ** 2.5
                for contact, along, arm in zip(
                    (row.inner_contact, row.outer_contact), (v - 1e-3 * p, 1e-3 * p), arms, strict=True
                )
            )
            return 1e3 * (0.4 * (inside + outside) - thrown * 1e-3 * float(p[0]))

        start = 1e3 * v * arms[1] / sum(arms)
        found = optimize.minimize(energy, start, method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-14})
        total += found.fun * 1e-3
    assert RollingElements(RollingBearing([row]), speed).at(PLACE).value == pytest.approx(total, rel=1e-8)


def test_a_machine_that_adds_bearings_to_a_spring_finds_its_rest() -> None:
    """A rigid shaft on two bearings 0.2 m apart: minimum of the energies' sum, and the moment balance of its load."""
    bearings = [RollingElements(RollingBearing([replace(ANGULAR, direction=sign)], sign * 300.0)) for sign in (1, -1)]
    maps = []
    for place in (-0.1, 0.1):
        motion = np.eye(5)
        motion[0, 4], motion[1, 3] = place, -place
        maps.append(motion)
    load = np.array([0.0, -2000.0, 400.0, 30.0, 0.0])
    size = np.array([1.0, 1.0, 1.0, 10.0, 10.0])

    def potential(lengths: FloatArray) -> Local:
        q = lengths * size
        parts = [(motion, elements.at(motion @ q)) for motion, elements in zip(maps, bearings, strict=True)]
        return Local(
            value=sum(part.value for _, part in parts) - float(load @ q),
            gradient=size * (sum(motion.T @ part.gradient for motion, part in parts) - load),
            hessian=np.outer(size, size) * sum(motion.T @ part.hessian @ motion for motion, part in parts),
            noise=sum(part.noise for _, part in parts) + abs(float(load @ q)),
            force=sum(part.force for _, part in parts) + 2430.0,
        )

    found = minimise(potential, np.zeros(5), 1e-5, 1e-13)
    q = found.place * size
    states = [rolling_state(one.bearing, motion @ q) for one, motion in zip(bearings, maps, strict=True)]
    np.testing.assert_allclose(states[0].load[:3] + states[1].load[:3], load[:3], atol=1e-8 * 2000.0)
    moment = states[0].load[3] + states[1].load[3] - 0.1 * (states[1].load[1] - states[0].load[1])
    assert moment == pytest.approx(30.0, abs=1e-7 * 200.0)


@pytest.mark.parametrize("kind", BEARINGS)
def test_a_state_at_an_equilibrium_s_displacement_is_that_equilibrium(kind: str) -> None:
    bearing, speed = BEARINGS[kind]
    load = np.array([700.0, -300.0, 250.0 * bearing.has_axial_stiffness, 1.0, -0.5])
    if kind.endswith(("spherical", "self-aligning")):
        load[3:] = 0.0
    if kind == "thrown tapered":
        load[2] = -2500.0
    expected = rolling_equilibrium(bearing, load, speed=speed)
    state = rolling_state(bearing, expected.displacement, speed=speed)
    assert state.residual == 0.0
    np.testing.assert_allclose(state.load, load, atol=1e-9 * np.abs(load).sum())
    np.testing.assert_array_equal(state.stiffness, expected.stiffness)
    assert state.loaded == expected.loaded


def test_a_displacement_is_five_finite_numbers() -> None:
    with pytest.raises(RotorError, match=r"displacement of .* expected five finite numbers"):
        rolling_state(RollingBearing([ANGULAR]), [0.0, math.nan, 0.0, 0.0, 0.0])
    with pytest.raises(RotorError, match="speed is nan"):
        RollingElements(RollingBearing([ANGULAR]), math.nan)
