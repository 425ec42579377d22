"""Rolling bearings against closed forms and independent computations."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import integrate, optimize, special

from gearwhine.rotors import EquilibriumError, RotorError
from gearwhine.rotors.rolling_bearings import (
    BallRow,
    ContactElasticity,
    FourPointRow,
    RollerRow,
    RollingBearing,
    SphericalRollerRow,
    TaperedRollerRow,
    linearised_bearing,
    paired,
    point_contact,
    preload_offset,
    rolling_equilibrium,
    rolling_state,
)

DEEP = BallRow(7, 11.5e-3, 43.5e-3)
ANGULAR = BallRow(13, 8.1e-3, 38.5e-3, math.radians(25.0))
ROLLERS = RollerRow(14, 11e-3, 11e-3, 60e-3, profile="straight")
ALIGNED = {"rx": 0.0, "ry": 0.0}


def test_ellipticity_satisfies_the_equation_of_the_plain_integrals() -> None:
    """Johnson's B/A = (κ² E − K) / (K − E), by scipy's plain integrals where they do not cancel."""
    for ratio in (1.5, 4.0, 20.0, 300.0):
        kappa = point_contact(1.0, ratio, 1.0).ellipticity
        m = 1.0 - 1.0 / kappa**2
        first, second = special.ellipk(m), special.ellipe(m)
        assert (kappa**2 * second - first) / (first - second) == pytest.approx(ratio, rel=1e-12)


def test_sphere_on_a_plane_is_the_circle_of_hertz() -> None:
    radius, modulus = 0.01, 115e9
    contact = point_contact(1.0 / radius, 1.0 / radius, modulus)
    assert contact.ellipticity == 1.0
    assert contact.stiffness == pytest.approx(4.0 / 3.0 * modulus * math.sqrt(radius), rel=1e-14)
    assert contact.unit_semi_major == pytest.approx((0.75 * radius / modulus) ** (1.0 / 3.0), rel=1e-14)


def test_thrust_bearing_is_a_root_of_one_equation() -> None:
    """Z K (|v| − A)^{3/2} sin α' = F with one approach for all balls, by a scalar root of its own."""
    force, angle = 800.0, ANGULAR.contact_angle
    distance = (ANGULAR.inner_groove + ANGULAR.outer_groove - 1.0) * ANGULAR.ball_diameter

    def excess(z: float) -> float:
        length = math.hypot(distance * math.cos(angle), distance * math.sin(angle) + z)
        sine = (distance * math.sin(angle) + z) / length
        return 13 * ANGULAR.stiffness * (length - distance) ** 1.5 * sine - force

    z = optimize.brentq(excess, 1e-9, 1e-3, xtol=1e-18)
    state = rolling_equilibrium(RollingBearing([ANGULAR]), [0.0, 0.0, force, 0.0, 0.0])
    assert state.displacement[2] == pytest.approx(z, rel=1e-10)
    assert state.loaded == 13


def test_many_balls_without_clearance_have_sjoevalls_integral() -> None:
    """F = Z K δ^{3/2} J with J = (1/2π) ∫ cos^{5/2} ψ over the loaded half (Sjövall 1933)."""
    integral = integrate.quad(lambda psi: math.cos(psi) ** 2.5, -0.5 * math.pi, 0.5 * math.pi)[0] / (2.0 * math.pi)
    assert integral == pytest.approx(0.2288, abs=1e-4)  # the table's value for ε = 1/2
    row = BallRow(300, 1e-3, 0.2)
    state = rolling_state(RollingBearing([row]), [2e-6, 0.0, 0.0, 0.0, 0.0])
    assert state.reaction[0] == pytest.approx(300 * row.stiffness * (2e-6) ** 1.5 * integral, rel=1e-5)


@pytest.mark.parametrize("arrangement", ["back to back", "face to face"])
def test_preloaded_pair_presses_as_asked(arrangement: str) -> None:
    pair = paired(ANGULAR, arrangement, 15e-3, preload=150.0)  # type: ignore[arg-type]
    state = rolling_equilibrium(pair, np.zeros(5))
    assert np.abs(state.displacement).max() < 1e-15
    for row in state.rows:
        assert (row.inner_load * np.sin(row.inner_angle)).sum() == pytest.approx(150.0, rel=1e-12)
    # Each row gives half: the pair is twice as stiff as one row pressed so.
    alone = rolling_equilibrium(RollingBearing([ANGULAR]), [0.0, 0.0, 150.0, 0.0, 0.0])
    assert state.stiffness[2, 2] == pytest.approx(2.0 * alone.stiffness[2, 2], rel=1e-10)
    assert preload_offset(ANGULAR, 150.0) == pytest.approx(alone.displacement[2], rel=1e-10)


@pytest.mark.parametrize(("arrangement", "directions"), [("back to back", (1, -1)), ("face to face", (-1, 1))])
def test_preloaded_pair_has_the_closed_form_of_its_stiffness(arrangement: str, directions: tuple[int, int]) -> None:
    """All balls are alike: cos² ψ sums to Z/2, the stiffness along a contact is 3/2 K δ^{1/2} and across it Q/|v|."""
    spacing = 15e-3
    pair = paired(ANGULAR, arrangement, spacing, preload=200.0)  # type: ignore[arg-type]
    state = rolling_equilibrium(pair, np.zeros(5))
    angle, load = float(state.rows[0].inner_angle[0]), float(state.rows[0].inner_load[0])
    approach = (load / ANGULAR.stiffness) ** (2.0 / 3.0)
    along, across = 1.5 * load / approach, load / (ANGULAR.groove_distance + approach)
    arm = (ANGULAR.inner_groove - 0.5) * ANGULAR.ball_diameter
    radius = 0.5 * ANGULAR.pitch_diameter + arm * math.cos(ANGULAR.contact_angle)
    cosine, sine = math.cos(angle), math.sin(angle)
    tilting = 0.0
    for side, direction in zip((-1.0, 1.0), directions, strict=True):
        place = side * 0.5 * spacing + direction * arm * math.sin(ANGULAR.contact_angle)
        pressing, sliding = place * cosine - radius * direction * sine, place * direction * sine + radius * cosine
        tilting += 13 / 2 * (along * pressing**2 + across * sliding**2)
    assert state.stiffness[4, 4] == pytest.approx(tilting, rel=1e-9)
    assert state.stiffness[3, 3] == pytest.approx(tilting, rel=1e-9)
    assert state.stiffness[2, 2] == pytest.approx(2 * 13 * (along * sine**2 + across * cosine**2), rel=1e-9)
    assert state.stiffness[0, 0] == pytest.approx(13 * (along * cosine**2 + across * sine**2), rel=1e-9)


def test_straight_rollers_in_line_have_the_closed_form() -> None:
    """Q = 35 948 L^{8/9} δ^{10/9} (N, mm) summed over the loaded rollers by hand."""
    shift, clearance = 12e-6, 6e-6
    state = rolling_state(RollingBearing([replace(ROLLERS, clearance=clearance)]), [shift, 0.0, 0.0, 0.0, 0.0])
    azimuths = 2.0 * np.pi * np.arange(14) / 14
    deep = np.maximum(shift * np.cos(azimuths) - 0.5 * clearance, 0.0)
    loads = 35948.0 * 11.0 ** (8.0 / 9.0) * (1e3 * deep) ** (10.0 / 9.0)
    np.testing.assert_allclose(state.rows[0].inner_load, loads, rtol=1e-12)
    assert state.reaction[0] == pytest.approx((loads * np.cos(azimuths)).sum(), rel=1e-12)
    assert state.stiffness[2, 2] == 0.0


def test_tilted_straight_roller_is_the_integral_along_its_length() -> None:
    """Finer slices converge to ∫ (c/L) (x cos ψ + z θ)^{10/9} dz of the fully loaded roller."""
    shift, tilt = 20e-6, 1e-3
    fine = RollingBearing([replace(ROLLERS, slices=400)])
    state = rolling_state(fine, [shift, 0.0, 0.0, 0.0, tilt])
    load = integrate.quad(lambda z: (shift + z * tilt) ** (10.0 / 9.0), -5.5e-3, 5.5e-3)[0] * ROLLERS.stiffness / 11e-3
    moment = integrate.quad(lambda z: z * (shift + z * tilt) ** (10.0 / 9.0), -5.5e-3, 5.5e-3)[0]
    loads = state.rows[0].slice_loads
    assert loads is not None
    assert loads[0].sum() == pytest.approx(load, rel=1e-5)
    places = np.linspace(-5.5e-3, 5.5e-3, 401)
    assert (loads[0] * 0.5 * (places[1:] + places[:-1])).sum() == pytest.approx(
        moment * ROLLERS.stiffness / 11e-3, rel=1e-4
    )


def test_logarithmic_profile_takes_the_load_off_the_ends() -> None:
    state = rolling_equilibrium(
        RollingBearing([replace(ROLLERS, profile="logarithmic")]), [2e3, 0, 0, 0, 0], held=ALIGNED
    )
    loads = state.rows[0].slice_loads
    assert loads is not None
    assert loads[0].argmax() == 15
    assert loads[0, 0] == 0.0
    assert np.diff(loads[0, :16]).min() >= 0.0


@pytest.mark.parametrize("speed", [0.3, 40.0, 2500.0])
def test_every_ball_in_motion_is_in_balance(speed: float) -> None:
    """Both contact forces and the centrifugal force of each ball, and the closure of its triangle of centres."""
    state = rolling_equilibrium(RollingBearing([ANGULAR]), [150.0, 40.0, 300.0, 0.0, 0.2], speed=speed)
    row, thrown = state.rows[0], ANGULAR.centrifugal_force(speed)
    inner = row.inner_load * np.array([np.cos(row.inner_angle), np.sin(row.inner_angle)])
    outer = row.outer_load * np.array([np.cos(row.outer_angle), np.sin(row.outer_angle)])
    balance = outer - inner - np.array([[thrown], [0.0]])
    assert np.abs(balance).max() < 1e-11 * row.outer_load.max()
    touching = row.inner_load > 0.0
    assert touching.any()
    reach = [
        ((groove - 0.5) * ANGULAR.ball_diameter + (load / contact.stiffness) ** (2.0 / 3.0))
        * np.array([np.cos(a), np.sin(a)])
        for groove, load, contact, a in (
            (ANGULAR.inner_groove, row.inner_load, ANGULAR.inner_contact, row.inner_angle),
            (ANGULAR.outer_groove, row.outer_load, ANGULAR.outer_contact, row.outer_angle),
        )
    ]
    x, y, z, rx, ry = state.displacement
    arm = (ANGULAR.inner_groove - 0.5) * ANGULAR.ball_diameter
    angle, distance = ANGULAR.contact_angle, ANGULAR.groove_distance
    radius, place = 0.5 * ANGULAR.pitch_diameter + arm * math.cos(angle), arm * math.sin(angle)
    cosine, sine = np.cos(row.azimuths), np.sin(row.azimuths)
    radial = distance * math.cos(angle) + x * cosine + y * sine + place * (ry * cosine - rx * sine)
    axial = distance * math.sin(angle) + z + radius * (rx * sine - ry * cosine)
    np.testing.assert_allclose((reach[0] + reach[1])[:, touching], np.array([radial, axial])[:, touching], rtol=1e-11)


def test_slow_balls_are_those_at_rest() -> None:
    still = rolling_equilibrium(RollingBearing([DEEP]), [900.0, 0.0, 200.0, 0.0, 0.0])
    slow = rolling_equilibrium(RollingBearing([DEEP]), [900.0, 0.0, 200.0, 0.0, 0.0], speed=1e-3)
    np.testing.assert_allclose(slow.displacement, still.displacement, rtol=1e-6, atol=1e-12)


def test_ceramic_balls_press_in_less() -> None:
    """The whole problem scales with E*, so δ goes as E*^{−2/3} at one load."""
    ceramic = ContactElasticity(element_modulus=310e9, element_poisson_ratio=0.27, element_density=3200.0)
    hybrid = RollingBearing([replace(DEEP, elasticity=ceramic)])
    steel = rolling_equilibrium(RollingBearing([DEEP]), [500.0, 0.0, 0.0, 0.0, 0.0])
    state = rolling_equilibrium(hybrid, [500.0, 0.0, 0.0, 0.0, 0.0])
    moduli = ceramic.contact_modulus / DEEP.elasticity.contact_modulus
    assert steel.displacement[0] / state.displacement[0] == pytest.approx(moduli ** (2.0 / 3.0), rel=1e-10)


def test_free_contact_angle_of_a_deep_groove_bearing_with_play() -> None:
    """cos α₀ = 1 − s / 2A; a light thrust has the balls at this angle."""
    row = replace(DEEP, clearance=20e-6)
    free = math.acos(1.0 - 10e-6 / (0.05 * 11.5e-3))
    state = rolling_equilibrium(RollingBearing([row]), [0.0, 0.0, 1e-3, 0.0, 0.0])
    assert state.rows[0].inner_angle[0] == pytest.approx(free, rel=1e-4)


def test_play_without_load_has_no_stiffness() -> None:
    state = rolling_equilibrium(RollingBearing([replace(DEEP, clearance=10e-6)]), np.zeros(5))
    assert state.loaded == 0
    assert not state.stiffness.any()
    assert state.loose == ("x", "y", "z", "rx", "ry")
    with pytest.raises(EquilibriumError, match=r"loose in x and y .* expected a load, a preload or less clearance"):
        linearised_bearing(state, "left", 0.0)


def test_bearing_takes_the_tangent() -> None:
    state = rolling_equilibrium(RollingBearing([ANGULAR]), [100.0, 0.0, 400.0, 0.0, 0.0], held=ALIGNED)
    bearing = linearised_bearing(state, "left", 0.1, damping=[[50.0, 0.0], [0.0, 50.0]])
    np.testing.assert_array_equal(bearing.spatial_stiffness, state.stiffness)
    assert bearing.spatial_damping[1, 1] == 50.0
    assert state.load[4] != 0.0  # what holds the shaft in line


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: BallRow(7, 20e-3, 43.5e-3), "ball diameter is 0.02; expected less than"),
        (lambda: BallRow(2, 1e-3, 43.5e-3), "count of balls is 2; expected three or more"),
        (lambda: replace(DEEP, inner_groove=0.5), "inner_groove is 0.5; expected a groove radius over 0.5"),
        (lambda: replace(DEEP, clearance=2e-3), "clearance is 0.002; expected less than"),
        (lambda: replace(DEEP, contact_angle=1.6), "contact angle is 1.6"),
        (lambda: replace(DEEP, direction=0), "direction of a row is 0; expected 1 or -1"),
        (lambda: replace(ROLLERS, profile="barrel"), "roller profile is 'barrel'"),
        (lambda: RollingBearing([]), "has no rows"),
        (lambda: RollingBearing([ROLLERS], axial_preload=5.0), "cylindrical rollers carry no axial load"),
        (
            lambda: rolling_equilibrium(RollingBearing([ROLLERS]), [0, 0, 5, 0, 0]),
            "axial load .* is 5.0; expected none",
        ),
        (lambda: replace(ROLLERS, flanges="one"), "flange stiffness is 0.0; expected a positive number"),
        (lambda: replace(ROLLERS, flange_stiffness=1e6), "flange stiffness is 1000000.0; expected none"),
        (lambda: replace(ROLLERS, flanges="two"), "flanges is 'two'; expected 'none', 'one' or 'both'"),
        (
            lambda: TaperedRollerRow(14, 11e-3, 11e-3, 60e-3, angle=0.0),
            "contact angle is 0.0; expected an angle above 0",
        ),
        (lambda: SphericalRollerRow(14, 11e-3, 11e-3, 60e-3, osculation=1.0), "osculation is 1.0; expected"),
        (lambda: FourPointRow(7, 11.5e-3, 43.5e-3), "contact angle of four-point balls is 0.0; expected more than 0"),
        (
            lambda: replace(DEEP, outer_groove=3.0),
            "outer_groove is 3.0; expected a groove radius over 0.5 and up to 2.3",
        ),
        (lambda: preload_offset(ROLLERS, 50.0), "preload of a row is 50.0; expected none: its rollers carry no axial"),
        (lambda: rolling_equilibrium(RollingBearing([DEEP]), [1, 2]), "expected five finite numbers"),
        (lambda: rolling_equilibrium(RollingBearing([DEEP]), np.zeros(5), held={"w": 0}), "held coordinate .* is 'w'"),
        (lambda: paired(DEEP, "tandem", 0.01, preload=5.0), "preload of rows in tandem is 5.0"),
        (lambda: ContactElasticity(ring_modulus=0.0), "contact ring_modulus is 0.0"),
    ],
)
def test_wrong_inputs_are_named(make: object, message: str) -> None:
    with pytest.raises(RotorError, match=message):
        make()  # type: ignore[operator]


def test_why_there_is_no_answer_is_told() -> None:
    with pytest.raises(EquilibriumError, match=r"pressed by .* % of their diameter; expected at most 2 %"):
        rolling_equilibrium(RollingBearing([DEEP]), [3e5, 0.0, 0.0, 0.0, 0.0])
    one_shoulder = replace(ANGULAR, groove_limits=(0.0, 0.5 * math.pi))
    with pytest.raises(
        EquilibriumError, match=r"beyond its groove; expected contact angles of 0° to 90°: more axial load"
    ):
        rolling_equilibrium(RollingBearing([one_shoulder]), [0.0, 0.0, -400.0, 0.0, 0.0])
