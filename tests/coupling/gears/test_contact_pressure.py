"""Hertzian pressure: against a calculation by hand, the formula of ISO 6336-2, and what must stay when gears swap."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearwhine.coupling.gears import (
    Gear,
    GearError,
    GearPairGeometry,
    HelixDeviation,
    PotentialEnergyStiffness,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.gears.loaded.contact_pressure import (
    contact_curvature_radius,
    contact_modulus,
    contact_pressure,
    mesh_pressure,
)
from gearwhine.coupling.gears.loaded.gear_pair import operation_findings

ANGLE = math.radians(20.0)


def gear(name: str, teeth: int, *, helix: float = 0.0, width: float = 0.02, **more: Any) -> Gear:
    return Gear(name, teeth, 3e-3, ANGLE, width, helix_angle=helix, **more)


def test_by_hand_at_the_pitch_point() -> None:
    """Module 3, 20 and 40 teeth, 20 deg, steel: curvatures 30 and 60 sin 20 mm, so rho = 20 sin 20 = 6.8404 mm.

    E* = 207 GPa / (2 (1 - 0.09)) = 113.736 GPa; with 100 N/mm p = sqrt(1e5 113.736e9 / (pi 6.8404e-3)) = 727.501 MPa.
    """
    pair = GearPairGeometry(gear("a", 20), gear("b", 40))
    at = pair.pitch_point_position
    assert contact_modulus(pair) == pytest.approx(113.73626e9, rel=1e-7)
    assert float(contact_curvature_radius(pair, at)) == pytest.approx(6.840403e-3, rel=1e-6)
    assert float(contact_pressure(pair, at, 1e5)) == pytest.approx(727.501e6, rel=1e-6)


@given(
    teeth=st.tuples(st.integers(20, 60), st.integers(20, 60)),
    helix=st.floats(-0.5, 0.5),
    shift=st.floats(0.0, 0.3),
    torque=st.floats(1.0, 500.0),
)
def test_iso_6336_at_the_pitch_point(teeth: tuple[int, int], helix: float, shift: float, torque: float) -> None:
    """Nominal pressure of ISO 6336-2, equations of Z_H and Z_E, with all other factors one."""
    pair = GearPairGeometry(
        gear("a", teeth[0], helix=helix, profile_shift=shift), gear("b", teeth[1], helix=-helix, profile_shift=shift)
    )
    driver, working = pair.driver, pair.working_pressure_angle
    transverse = driver.transverse_pressure_angle
    zone = math.sqrt(
        2.0 * math.cos(driver.base_helix_angle) * math.cos(working) / (math.cos(transverse) ** 2 * math.sin(working))
    )
    elasticity = math.sqrt(1.0 / (math.pi * 2.0 * (1.0 - 0.3**2) / 207e9))
    tangential, diameter, ratio = torque / driver.pitch_radius, 2.0 * driver.pitch_radius, teeth[1] / teeth[0]
    nominal = zone * elasticity * math.sqrt(tangential / (diameter * pair.face_width) * (ratio + 1.0) / ratio)
    load = torque / driver.base_radius / pair.face_width
    assert float(contact_pressure(pair, pair.pitch_point_position, load)) == pytest.approx(nominal, rel=1e-10)


def test_driver_and_driven_exchanged_have_the_same_pressure() -> None:
    pair = GearPairGeometry(gear("a", 23, helix=0.2), gear("b", 41, helix=-0.2))
    back = GearPairGeometry(pair.driven, pair.driver)
    at = np.linspace(0.0, pair.contact_ratio, 9)
    mirrored = contact_pressure(back, pair.contact_ratio - at, 2e5)
    np.testing.assert_allclose(contact_pressure(pair, at, 2e5), mirrored, rtol=1e-9)


def test_what_has_no_hertzian_pressure() -> None:
    pair = GearPairGeometry(gear("a", 20), gear("b", 40))
    off = np.array([-0.01, pair.contact_ratio + 0.01])
    assert np.isnan(contact_pressure(pair, off, 1.0)).all()
    assert (contact_pressure(pair, off, 0.0) == 0.0).all()
    for wrong in (-1.0, math.nan):
        with pytest.raises(GearError, match="at least 0 N/m"):
            contact_pressure(pair, 0.5, [1.0, wrong])


def test_a_mesh_s_pressure_is_that_of_its_loads() -> None:
    pair = GearPairGeometry(gear("a", 28), gear("b", 28))
    contact = tooth_contact(pair, PotentialEnergyStiffness(), corner_contact=True)
    mesh = loaded_transmission_error(contact, 3000.0)
    pressure = mesh_pressure(pair, contact, mesh)
    on_path = (mesh.positions > 0.0) & (mesh.positions < pair.contact_ratio)
    alone = on_path & np.isclose(mesh.pair_forces, 3000.0)
    assert alone.any()
    expected = contact_pressure(pair, mesh.positions[alone], 3000.0 / 0.02)
    np.testing.assert_allclose(pressure[alone], expected, rtol=1e-9)
    # Unrelieved teeth under load touch with their corners as well.
    assert np.isnan(pressure[~on_path & (mesh.pair_forces > 0.0)]).any()


def test_a_crowned_face_bears_most_in_its_middle() -> None:
    """Loads of the slices add up to the pair's; pressure goes with their root, so that it is even where they are."""
    crowned = HelixDeviation(crowning=20e-6)
    pair = GearPairGeometry(gear("a", 28, helix_deviation=crowned), gear("b", 28))
    contact = tooth_contact(pair, PotentialEnergyStiffness(), faces=face_slices(pair, count=21))
    mesh = loaded_transmission_error(contact, 2000.0, [0.3])
    pressure = mesh_pressure(pair, contact, mesh)
    most = np.unravel_index(int(np.nanargmax(pressure)), pressure.shape)
    assert most[2] == 10
    assert contact.faces is not None
    squares = (pressure**2).sum(axis=2) * contact.faces.width
    radii = contact_curvature_radius(pair, mesh.positions)
    carried = squares * np.pi * radii / contact_modulus(pair)
    np.testing.assert_allclose(np.where(mesh.pair_forces > 0.0, carried, 0.0), mesh.pair_forces, rtol=1e-9)


@pytest.mark.parametrize("helix", [0.0, 20.0])
def test_a_load_that_teeth_do_not_bear_has_the_pressure_of_hertz_at_the_pitch_point(helix: float) -> None:
    """p = √(w E* / (π R)) of cylinders in line contact, on the length of contact b ε_α / cos β_b of helical teeth.

    K. L. Johnson, Contact mechanics, 1985, section 4.2(c).
    """
    driver, driven = (
        Gear(name, teeth, 4e-3, np.radians(20.0), 25e-3, helix_angle=np.radians(turn * helix))
        for name, teeth, turn in (("pinion", 24, 1.0), ("wheel", 60, -1.0))
    )
    geometry, torque = GearPairGeometry(driver, driven), 9000.0
    transverse = np.arctan(np.tan(np.radians(20.0)) / np.cos(np.radians(helix)))
    base = np.arcsin(np.sin(np.radians(helix)) * np.cos(np.radians(20.0)))
    radii = [0.5 * teeth * 4e-3 / np.cos(np.radians(helix)) for teeth in (24, 60)]
    along = torque / (radii[0] * np.cos(transverse))  # in the transverse plane
    length = 25e-3 / np.cos(base) * (geometry.contact_ratio if helix else 1.0)
    curvature = sum(np.cos(base) / (radius * np.sin(transverse)) for radius in radii)
    modulus = driver.youngs_modulus / (2.0 * (1.0 - driver.poisson_ratio**2))
    pressure = np.sqrt(along / np.cos(base) / length * modulus * curvature / np.pi)
    assert pressure > 3e9
    (found,) = operation_findings(geometry, -torque, 100.0)
    assert (found.part, found.attribute, found.value) == (("gear pair", "pinion -> wheel"), "torque", -torque)
    root = 3.5 * along / (25e-3 * 4e-3)
    assert f"{along:.4g} N press their flanks with {1e-9 * pressure:.3g} GPa" in found.expected
    assert f"bend their roots with {1e-9 * root:.3g} GPa, where steel bears 3 GPa and 2 GPa at most" in found.expected
    (found,) = operation_findings(geometry, 100e3, 100.0)
    assert found.expected.endswith("; is it a thousand times too much?")
    assert list(operation_findings(geometry, 100.0, 1e3)) == []
    (fast,) = operation_findings(geometry, 100.0, -1.001 * 600.0 / radii[0])
    assert "a pitch-line speed at which no rim bursts, at most 600 m/s; it is 600.6 m/s" in fast.expected
