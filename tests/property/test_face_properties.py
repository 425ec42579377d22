"""Whatever gears can be cut and put in mesh, helical and deviating ones too: a contact that is finite and balances."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gearwhine.coupling.gears import (
    Gear,
    GearError,
    GearPairGeometry,
    HelixDeviation,
    PotentialEnergyStiffness,
    ProfileDeviation,
    TipRelief,
    loaded_transmission_error,
    mesh_stiffness,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force

PHASES = np.arange(12) / 12.0
SMALL = st.floats(-15e-6, 15e-6)


@st.composite
def pairs(draw: st.DrawFn) -> GearPairGeometry:
    module = draw(st.floats(1e-3, 8e-3))
    angle = math.radians(draw(st.sampled_from([14.5, 20.0, 25.0])))
    helix = math.radians(draw(st.floats(-35.0, 35.0)))
    width = module * draw(st.floats(3.0, 15.0))
    gears = []
    for name, hand in (("one", 1.0), ("two", -1.0)):
        try:
            gear = Gear(
                name,
                draw(st.integers(14, 90)),
                module,
                angle,
                width,
                profile_shift=draw(st.floats(-0.2, 0.6)),
                helix_angle=hand * helix,
                allow_undercut=True,
                tip_relief=draw(st.none() | st.just(TipRelief(10e-6, length=0.4 * module))),
                profile_deviation=draw(st.none() | st.builds(ProfileDeviation, slope=SMALL, crowning=SMALL)),
                helix_deviation=draw(st.none() | st.builds(HelixDeviation, slope=SMALL, crowning=SMALL)),
            )
        except GearError:
            assume(False)
        gears.append(gear)
    try:
        return GearPairGeometry(*gears)
    except GearError:
        assume(False)
        raise


@pytest.mark.slow
@settings(deadline=None, max_examples=12)
@given(pairs(), st.floats(-1e-3, 1e-3), st.floats(1e3, 3e5), st.sampled_from([1, -1]))
def test_every_mesh_balances_its_load_with_finite_stiffness(
    pair: GearPairGeometry, misalignment: float, line_load: float, sense: int
) -> None:
    faces = face_slices(pair, sense=sense, misalignment=misalignment, count=21)
    contact = tooth_contact(pair, PotentialEnergyStiffness(), corner_contact=True, faces=faces)
    force = line_load * pair.face_width
    mesh = loaded_transmission_error(contact, force, PHASES)
    np.testing.assert_allclose(mesh.pair_forces.sum(axis=1), force, rtol=1e-8)
    np.testing.assert_allclose(mesh.load_shares.sum(axis=1), 1.0, rtol=1e-8)
    assert mesh.line_loads is not None
    assert np.all(mesh.line_loads >= -1e-9 * line_load)
    assert np.all(np.isfinite(mesh.transmission_error))
    assert np.all(mesh.tangent_stiffness > 0.0)
    stiffness = mesh_stiffness(contact, PHASES)
    assert np.all(np.isfinite(stiffness))
    assert np.all(stiffness > 0.0)
    np.testing.assert_allclose(mesh_stiffness(contact, PHASES + 3.0), stiffness, rtol=1e-9)
    heavier = loaded_transmission_error(contact, 1.5 * force, PHASES)
    assert np.all(heavier.transmission_error > mesh.transmission_error)
    law = tooth_force(0.3, float(mesh.transmission_error[4]), 0.0, *contact.kernel_arguments)
    assert all(math.isfinite(value) for value in law)
