"""The mesh over the hunting period: the same as phase by phase, with few mesh periods solved."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.coupling.gears import (
    Gear,
    GearPairGeometry,
    PotentialEnergyStiffness,
    Spall,
    ToothContact,
    ToothCrack,
    Wear,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.gears.loaded.transmission_error import (
    along_one_pair,
    different_periods,
    hunting_period_mesh,
    mesh_period_phases,
)

PINION = Gear("pinion", 17, 3e-3, math.radians(20.0), 20e-3, profile_shift=0.2)
WHEEL = Gear("wheel", 22, 3e-3, math.radians(20.0), 20e-3, profile_shift=-0.2)
FORCE = 3000.0


def contact_of(*, helix: float = 0.0, pitched: bool = False) -> ToothContact:
    roll = PINION.roll_angle(PINION.pitch_radius)
    spall = Spall(9, roll - 0.05, roll + 0.05, 5e-6)
    pinion = replace(PINION, helix_angle=helix, faults=(ToothCrack(3, 2e-3), spall))
    wheel = replace(WHEEL, helix_angle=-helix, faults=(Wear(4e-6, tooth=5),))
    if pitched:
        wheel = replace(wheel, pitch_deviations=tuple(1e-6 * math.sin(n) for n in range(22)))
    pair = GearPairGeometry(pinion, wheel)
    faces = face_slices(pair, count=7) if helix else None
    return tooth_contact(pair, PotentialEnergyStiffness(), corner_contact=True, faces=faces)


@pytest.mark.parametrize(("helix", "pitched"), [(0.0, False), (0.0, True), (math.radians(15.0), False)])
def test_every_phase_is_that_of_the_mesh_by_itself(helix: float, pitched: bool) -> None:
    contact = contact_of(helix=helix, pitched=pitched)
    found = hunting_period_mesh(contact, FORCE, points=7)
    phases = mesh_period_phases(contact, 7, periods=17 * 22)
    expected = loaded_transmission_error(contact, FORCE, phases)
    np.testing.assert_allclose(found.phases, phases, rtol=0.0, atol=1e-12)
    for name in ("transmission_error", "positions", "pair_forces", "tangent_stiffness", "secant_stiffness"):
        # A phase in a later mesh period has fewer digits left for where in it the pairs are.
        values = getattr(expected, name)
        np.testing.assert_allclose(getattr(found, name), values, rtol=1e-7, atol=1e-9 * np.abs(values).max())
    assert found.line_loads is None


def test_the_load_of_one_pair_has_no_jump_along_its_path() -> None:
    """Corners take it up and hand it over; the pairs of one mesh period, which differ by their pitch, do not join."""
    contact = replace(contact_of(), pitch_gaps=6e-6 * np.sin(np.arange(17 * 22)))
    mesh = loaded_transmission_error(contact, FORCE, mesh_period_phases(contact, 2000))
    along, own = along_one_pair(contact, mesh)
    jumps = []
    for statics, present in ((along, own), (mesh, contact.pairs(mesh.phases).present)):
        order = np.argsort(statics.positions[present])
        jumps.append(np.abs(np.diff(statics.load_shares[present][order])).max())
    assert jumps[0] < 0.02 < 0.05 < jumps[1]
    shares = along.load_shares[own]
    assert shares[[0, -1]] == pytest.approx(0.0, abs=1e-3)
    # At every phase it is what the law gives it there.
    for phase in (0.3, 1.2, 1.5):
        states = contact.pairs([phase])
        alone = loaded_transmission_error(contact, FORCE, [phase])
        expected = alone.load_shares[states.entered == 0]
        assert np.interp(phase, along.positions[own], shares) == pytest.approx(expected.item(), abs=2e-3)


def test_damage_makes_few_mesh_periods_differ() -> None:
    first, which = different_periods(contact_of())
    assert which.size == 17 * 22
    assert first.size < 40
    none = np.zeros(0, dtype=np.int64)
    sound = replace(contact_of(), variants=(), pair_variants=none, back_pair_variants=none)
    assert hunting_period_mesh(sound, FORCE, points=5).phases.size < 2 * 17
