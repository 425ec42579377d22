"""Signs and parts of loads that symmetric machines do not show: helical thrust, shuttling, a base that turns."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearwhine.coupling.description.thrust import ThrustPair, axial_forces
from gearwhine.coupling.gears import Gear, GearPairGeometry
from gearwhine.coupling.gears.stiffness.hertz import line_contact
from gearwhine.coupling.gears.stiffness.iso6336 import iso6336_stiffness
from gearwhine.coupling.machine.base_motion import BaseHistory, _velocities, participations
from gearwhine.coupling.machine.components import HousingComponent, rotor_component
from gearwhine.coupling.machine.load_shuttling import load_arms, shuttling_loads
from gearwhine.coupling.signals.spectrum import averaged_spectrum
from gearwhine.rotors import Rotor, Segment, ShaftMaterial, modal_rotor

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)


def helical(helix: float = 0.3) -> GearPairGeometry:
    return GearPairGeometry(
        Gear("p", 23, 2e-3, np.radians(20.0), 18e-3, helix_angle=helix),
        Gear("w", 41, 2e-3, np.radians(20.0), 18e-3, helix_angle=-helix),
    )


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_thrust_turns_with_the_sense_of_the_driver(sense: float) -> None:
    """A right-hand driver that turns counter-clockwise and drives is pushed one way, clockwise the other."""
    pair = helical()
    speeds = {"one": 100.0 * sense, "two": -100.0 * sense * 23 / 41}
    torques = {"one": 40.0 * sense, "two": 40.0 * sense * 41 / 23}
    found = axial_forces([ThrustPair(("one", "two"), ("p", "w"), pair)], speeds, torques)
    size = 40.0 / pair.driver.base_radius * np.tan(pair.driver.base_helix_angle)
    assert found["one"].forces == pytest.approx((sense * size,))
    assert found["two"].forces == pytest.approx((-sense * size,))


def test_flanks_of_helical_teeth_are_flatter_in_their_normal_section() -> None:
    pair = helical()
    at = 0.4 * pair.contact_ratio
    first, second = (
        np.sqrt(radius**2 - gear.base_radius**2)
        for radius, gear in ((pair.driver_radius(at), pair.driver), (pair.driven_radius(at), pair.driven))
    )
    expected = first * second / (first + second) / np.cos(pair.driver.base_helix_angle)
    assert line_contact(pair, at).curvature_radius == pytest.approx(expected)


def test_each_profile_shift_has_its_own_terms_in_the_norm() -> None:
    """ISO 6336-1, q' of the basic tooth shape [mm µm/N]."""
    pair = GearPairGeometry(
        Gear("p", 19, 2e-3, np.radians(20.0), 18e-3, profile_shift=0.4),
        Gear("w", 43, 2e-3, np.radians(20.0), 18e-3, profile_shift=-0.15),
    )
    x1, x2, z1, z2 = 0.4, -0.15, 19, 43
    flexibility = 0.04723 + 0.15551 / z1 + 0.25791 / z2 - 0.00635 * x1 - 0.11654 * x1 / z1 - 0.00193 * x2
    flexibility += -0.24188 * x2 / z2 + 0.00529 * x1**2 + 0.00182 * x2**2
    assert iso6336_stiffness(pair).theoretical == pytest.approx(1e9 / flexibility)


@pytest.mark.parametrize("rate", [350.0, -350.0])
def test_shuttling_goes_through_the_mesh_period_with_the_rotation(rate: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """-F arm(phase + rate t) on the coordinates, of an arm that is not the same backwards."""

    def arm(phases: Any) -> Any:
        turned = 2.0 * np.pi * np.asarray(phases)
        return 1e-4 * (0.7 + np.cos(turned - 0.4) + 0.5 * np.cos(2.0 * turned + 1.1))

    monkeypatch.setattr(
        "gearwhine.coupling.machine.load_shuttling.load_arms",
        lambda *given: np.column_stack([arm(given[3]), np.zeros(len(given[3]))]),
    )
    assert callable(load_arms)
    contact: Any = SimpleNamespace(faces=SimpleNamespace(face_width=0.02), hunting_period=1)
    tilting, force, phase = np.array([2.0, -1.0]), 500.0, 0.23
    constant, harmonics = shuttling_loads(contact, helical(), force, 0.0, tilting, phase, rate)
    for time in (0.0, 0.0004, 0.0011):
        total = constant + sum((one.amplitude * np.exp(1j * one.frequency * time)).real for one in harmonics)
        expected = -force * float(arm(phase + rate * time)) * tilting
        np.testing.assert_allclose(total, expected, rtol=1e-9)


def test_a_housing_s_participation_about_another_point() -> None:
    """Of a mass at r, √m e · (a + α × (r - p)) for its motions e along the axes."""
    mass, place, point = 4.0, np.array([0.3, -0.2, 0.5]), (0.1, 0.4, -0.3)
    about_origin = np.sqrt(mass) * np.hstack([np.eye(3), np.array([np.cross(place, e) for e in np.eye(3)])])
    housing = HousingComponent(
        "housing", ("housing",) * 3, np.eye(3), np.zeros((3, 3)), np.zeros((3, 3)), {}, {}, {}, about_origin
    )
    expected = np.sqrt(mass) * np.hstack([np.eye(3), np.array([np.cross(place - point, e) for e in np.eye(3)])])
    np.testing.assert_allclose(participations([housing], point, {}), expected, atol=1e-12)


def test_a_base_that_turns_about_z_holds_the_shaft_back_by_its_inertia() -> None:
    rotor = Rotor("shaft", [Segment(0.3, 0.04, 0.0, STEEL)])
    part = rotor_component("shaft", modal_rotor(rotor, [], count=3), start=0.0, axis=(0.0, 0.0))
    held = participations([part], (0.0, 0.0, 0.0), {})
    assert part.turning @ held[:, 5] == pytest.approx(rotor.polar_inertia)


def test_the_rate_of_a_base_is_the_integral_of_its_acceleration() -> None:
    values = np.zeros((2, 6))
    values[1, 3] = 2.0
    times, velocities = _velocities(BaseHistory(np.array([0.0, 1.0]), values))
    np.testing.assert_allclose(velocities[:, 3], times**2, atol=1e-12)


def test_the_mean_of_averaged_stretches_is_the_mean_of_their_means() -> None:
    rows = [np.full(16, 1.0), np.full(16, 3.0)]
    assert averaged_spectrum(rows, 0.1).amplitude[0] == pytest.approx(2.0)
    assert averaged_spectrum([replace_sign(rows[0]), rows[1]], 0.1).amplitude[0] == pytest.approx(1.0)


def replace_sign(row: Any) -> Any:
    return -row
