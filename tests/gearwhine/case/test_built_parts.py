"""Shafts, bearings, gears and loads of a case as the library has them: each number in its own place and sense."""

import math

import numpy as np
import pytest

from gearwhine.case import Material, Rotor
from gearwhine.case.bearings import Pedestal, RadialStiffness, RollingGeometry, Stop
from gearwhine.case.gears import Gear, HelixErrors
from gearwhine.case.operation import Base, TorqueHistory, TorqueRipple
from gearwhine.rotors.rolling_bearings import rolling_equilibrium

STEEL = {"steel": Material(youngs_modulus=210e9, poisson_ratio=0.25, density=7800.0)}
ROTOR = Rotor.model_validate(
    {
        "name": "shaft",
        "material": "steel",
        "axial_force": "300 N",
        "segments": [
            {"length": 0.2, "diameter": 0.05, "bore": 0.01, "right_diameter": 0.06, "right_bore": 0.02},
            {"length": 0.3, "diameter": 0.04, "axial_force": "-100 N"},
        ],
        "unbalance": [{"at": 0.1, "moment": "20 g*mm", "phase": "30 deg"}],
        "bow": [
            {"at": 0.1, "amplitude": "10 um", "phase": "90 deg"},
            {"at": 0.3, "amplitude": "20 um", "phase": "-45 deg"},
        ],
    }
)


def test_a_shaft_is_as_thick_hollow_heavy_and_pulled_as_it_is_given() -> None:
    built = ROTOR.build(STEEL)
    cone, thin = built.segments
    # The frustum's volume: π h/12 (d² + d D + D²), of the outside less that of the bore.
    volume = math.pi * 0.2 / 12.0 * ((0.05**2 + 0.05 * 0.06 + 0.06**2) - (0.01**2 + 0.01 * 0.02 + 0.02**2))
    assert built.mass == pytest.approx(7800.0 * (volume + math.pi / 4.0 * 0.04**2 * 0.3), rel=1e-6)
    assert (cone.axial_force, thin.axial_force) == (300.0, -100.0)
    # G = E / (2 (1 + ν)) is below E.
    assert thin.material.youngs_modulus == 210e9
    assert thin.material.shear_modulus == pytest.approx(84e9, rel=1e-12)


def test_unbalance_and_bow_lie_at_their_angles_counter_clockwise() -> None:
    (unbalance,) = ROTOR.build_unbalance()
    assert (unbalance.at, unbalance.moment) == (0.1, pytest.approx(2e-5))
    assert unbalance.phase == pytest.approx(math.radians(30.0))
    bow = ROTOR.build_bow()
    assert bow is not None
    assert bow.phase is not None
    centre_line = bow.offset * np.exp(1j * bow.phase)
    np.testing.assert_allclose(centre_line, [10e-6j, 20e-6 * (1 - 1j) / math.sqrt(2.0)], atol=1e-18)


def test_radial_matrices_are_rows_of_forces_over_columns_of_motions() -> None:
    given = RadialStiffness.model_validate({"xx": 1e8, "xy": [2e7, 3e7], "yx": -4e7, "yy": 5e8})
    np.testing.assert_array_equal(given.build(), [[[1e8, 2e7], [-4e7, 5e8]], [[1e8, 3e7], [-4e7, 5e8]]])
    table = {"mass": 3.0, "stiffness": {"xx": 1e8, "yy": 2e8}, "damping": {"xx": 10.0, "yy": 20.0}}
    pedestal = Pedestal.model_validate(table).build()
    np.testing.assert_array_equal(pedestal.stiffness, np.diag([1e8, 2e8]))
    np.testing.assert_array_equal(pedestal.damping, np.diag([10.0, 20.0]))
    assert pedestal.mass == 3.0


def test_torques_over_time_and_ripple_act_in_the_sense_of_their_torque() -> None:
    history = TorqueHistory.model_validate({"time": [0.0, 1.0], "torque": [3.0, 5.0]}).build().on("shaft", 0.1, -2.0)
    np.testing.assert_array_equal(history.values, [-6.0, -10.0])
    ripple = TorqueRipple.model_validate({"amplitude": 2.0, "phase": "90 deg", "frequency": "50 Hz"})
    against = ripple.build().on("shaft", 0.1, -1.0)
    assert (against.amplitude, against.order) == (-2.0, None)
    assert against.phase == pytest.approx(0.5 * math.pi)
    assert against.frequency == pytest.approx(100.0 * math.pi)


def test_the_ground_moves_as_it_is_said_to() -> None:
    """2 cos(2 π 50 t + π/2) along x, and along y from 0 to 4 within 1 s; about a point of its own."""
    given = {
        "point": [0.1, 0.2, 0.3],
        "harmonic": [{"frequency": "50 Hz", "x": 2.0, "phase": "90 deg"}],
        "over_time": {"time": [0.0, 1.0], "y": [0.0, 4.0]},
    }
    base = Base.model_validate(given).build()
    times = np.array([0.0, 0.005, 0.25])
    moved = base.acceleration(times)
    np.testing.assert_allclose(moved[:, 0], 2.0 * np.cos(2.0 * math.pi * 50.0 * times + 0.5 * math.pi), atol=1e-12)
    np.testing.assert_allclose(moved[:, 1], 4.0 * times)
    assert base.point == (0.1, 0.2, 0.3)


def test_a_helix_deviation_keeps_its_slope() -> None:
    built = HelixErrors.model_validate({"slope": "5 um", "crowning": "2 um"}).build()
    assert (built.slope, built.crowning) == (pytest.approx(5e-6), pytest.approx(2e-6))


def test_a_gear_has_the_errors_the_bore_and_the_metal_that_it_is_given() -> None:
    """Aluminium weighs a third of steel; the bore takes its cylinder out of the blank."""
    table = {"name": "a", "teeth": 30, "module": 2e-3, "pressure_angle": "20 deg", "face_width": 0.02, "bore": 0.02}
    errors = {"eccentricity": "12 um", "phase": "40 deg", "helix": {"slope": "5 um"}}
    built = Gear.model_validate(table | {"errors": errors}).build(STEEL["steel"])
    assert (built.eccentricity, built.eccentricity_phase) == (pytest.approx(12e-6), pytest.approx(math.radians(40.0)))
    assert built.helix_deviation is not None
    assert built.helix_deviation.slope == pytest.approx(5e-6)
    assert (built.youngs_modulus, built.poisson_ratio) == (210e9, 0.25)
    light = Gear.model_validate(table).build(Material(youngs_modulus=70e9, poisson_ratio=0.33, density=2600.0))
    assert built.mass / light.mass == pytest.approx(3.0, rel=1e-12)
    solid = Gear.model_validate(table | {"bore": 0.0}).build(STEEL["steel"])
    assert solid.mass - built.mass == pytest.approx(7800.0 * math.pi / 4.0 * 0.02**2 * 0.02, rel=1e-9)


@pytest.mark.parametrize(("carries", "sense"), [("+z", 1.0), ("-z", -1.0)])
def test_a_spring_presses_a_row_of_balls_in_the_way_that_it_carries(carries: str, sense: float) -> None:
    """Only then does the preload press the balls: without any load of the shaft, its force is in balance."""
    table = {
        "element_diameter": "12 mm",
        "pitch_diameter": "60 mm",
        "count": 10,
        "contact_angle": "25 deg",
        "carries": carries,
        "preload": "400 N",
    }
    built = RollingGeometry.model_validate(table).build("front")
    assert built.axial_preload == sense * 400.0
    state = rolling_equilibrium(built, [0.0] * 5, held={"rx": 0.0, "ry": 0.0})
    assert sense * state.displacement[2] > 0.0


def test_a_stop_gives_its_force_at_its_depth_by_its_own_exponent() -> None:
    law = Stop.model_validate({"force": "100 N", "depth": "10 um", "exponent": 2.0, "gap": "5 um"}).build()
    # A quarter of the force is reached at half the depth, 10 µm from the centre: n F / d along it, F / r across.
    np.testing.assert_allclose(law.tangent([25.0, 0.0]), np.diag([2.0 * 25.0 / 5e-6, 25.0 / 10e-6]), rtol=1e-9)
