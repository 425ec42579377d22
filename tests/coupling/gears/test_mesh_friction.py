"""Friction of a mesh: where it turns, its power balance, and the closed form of a pair's loss."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.coupling.gears import (
    Gear,
    GearError,
    GearPairGeometry,
    PotentialEnergyStiffness,
    SquareStiffness,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.gears.loaded.mesh_friction import mesh_friction

PINION = Gear("pinion", 20, 4e-3, math.radians(20.0), 20e-3)
PAIR = GearPairGeometry(PINION, replace(PINION, name="wheel", teeth=47))
PHASES = np.arange(500) / 500.0
MU = 0.06


def test_the_force_turns_at_the_pitch_point() -> None:
    contact = tooth_contact(PAIR, PotentialEnergyStiffness())
    pitch = PAIR.pitch_point_position
    before, after = (
        mesh_friction(PAIR, contact, loaded_transmission_error(contact, 1000.0, [pitch + step]), MU).force[0]
        for step in (-1e-6, 1e-6)
    )
    assert (before, after) == (pytest.approx(MU * 1000.0), pytest.approx(-MU * 1000.0))


def test_moments_and_loss_balance_at_any_speed() -> None:
    contact = tooth_contact(PAIR, PotentialEnergyStiffness(), corner_contact=False)
    friction = mesh_friction(PAIR, contact, loaded_transmission_error(contact, 3000.0, PHASES), MU)
    # What friction takes from the driven gear, less what it gives the driver, is lost.
    np.testing.assert_allclose(friction.driven_moment / PAIR.ratio - friction.driver_moment, friction.loss, rtol=1e-12)
    assert np.all(friction.loss >= 0.0)


def test_loss_of_pairs_that_share_the_load_by_halves() -> None:
    # Square stiffness: one pair carries F between the points B and D of the path, F/2 outside; it slides in proportion
    # to its distance from the pitch point.
    contact = tooth_contact(PAIR, SquareStiffness(3e8))
    force = 2000.0
    friction = mesh_friction(
        PAIR, contact, loaded_transmission_error(contact, force, (np.arange(20000) + 0.5) / 20000), MU
    )
    eps, pitch = PAIR.contact_ratio, PAIR.pitch_point_position
    s = np.linspace(0.0, eps, 200001)
    alone = (s >= eps - 1.0) & (s < 1.0)
    share = np.where(alone, 1.0, 0.5)
    per_turn = np.trapezoid(share * np.abs(s - pitch), s) * PAIR.base_pitch * (1.0 + 1.0 / PAIR.ratio)
    expected = 1.0 - MU * per_turn / PINION.base_radius
    assert friction.efficiency == pytest.approx(expected, rel=1e-6)
    assert 0.97 < friction.efficiency < 0.995


def test_slices_of_an_even_face_are_the_whole() -> None:
    efficiencies = []
    for faces in (None, face_slices(PAIR)):
        contact = tooth_contact(PAIR, PotentialEnergyStiffness(), corner_contact=True, faces=faces)
        mesh = loaded_transmission_error(contact, 2500.0, PHASES)
        efficiencies.append(mesh_friction(PAIR, contact, mesh, MU).efficiency)
    assert efficiencies[1] == pytest.approx(efficiencies[0], rel=1e-9)


def test_a_negative_coefficient_is_refused() -> None:
    contact = tooth_contact(PAIR, PotentialEnergyStiffness())
    with pytest.raises(GearError, match="friction coefficient must be at least 0"):
        mesh_friction(PAIR, contact, loaded_transmission_error(contact, 1e3, PHASES), -0.1)
