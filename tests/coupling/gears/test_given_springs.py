"""Given springs of helical teeth: one law in static solutions, in the equilibrium of the machine and in motion."""

import math

import numpy as np
import pytest

from gearwhine.coupling.gears import (
    ConstantStiffness,
    Gear,
    GearPairGeometry,
    SquareStiffness,
    TableStiffness,
    ToothContact,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.contact_law import places_on_line_of_action
from gearwhine.coupling.gears.contact.face_slices import face_slices, face_stations
from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force
from gearwhine.coupling.gears.loaded.face_load import FaceContact
from gearwhine.coupling.gears.stiffness.models import StiffnessModel
from gearwhine.numerics.arrays import FloatArray

FORCE = 2800.0
ALPHA = math.radians(20.0)
PHASES = (np.arange(97) + 0.3) / 97.0


def pair_of(degrees: float, width: float = 30e-3) -> GearPairGeometry:
    helix = math.radians(degrees)
    return GearPairGeometry(
        Gear("pinion", 22, 2e-3, ALPHA, width, helix_angle=helix),
        Gear("wheel", 71, 2e-3, ALPHA, width, helix_angle=-helix),
    )


def law(pair: GearPairGeometry, model: StiffnessModel, misalignment: float = 0.0) -> ToothContact:
    return tooth_contact(pair, model, faces=face_slices(pair, misalignment=misalignment))


def machine_equilibrium(contact: ToothContact, pair: GearPairGeometry, force: float = FORCE) -> tuple[FloatArray, ...]:
    """Deflection and stiffness of the mesh as the operating point of a machine has them, at `PHASES`."""
    face = FaceContact(contact, pair, face_stations(pair.face_width), axial=0.3)
    load = face.under_force(force, np.zeros(face.size), PHASES)
    return load.deflection, face.stiffness_of(load)


def contact_line_length(pair: GearPairGeometry, phase: float) -> float:
    """Length of all contact lines over the face, in face widths: each from where it enters the path to its end."""
    shifts = 0.5 * pair.overlap_ratio * np.array([-1.0, 1.0])
    total = 0.0
    for behind in range(-9, 10):
        ends = np.clip(phase + behind + shifts, 0.0, pair.contact_ratio)
        total += float(ends[1] - ends[0]) / pair.overlap_ratio
    return total


@pytest.mark.parametrize("degrees", [-25.0, 8.0, 18.0])
@pytest.mark.parametrize("misalignment", [0.0, 4e-5])
def test_a_constant_spring_is_constant(degrees: float, misalignment: float) -> None:
    """TE = F/k, also of flanks so little misaligned that they touch over the whole face."""
    stiffness = 4.346e8
    pair = pair_of(degrees)
    contact = law(pair, ConstantStiffness(stiffness), misalignment)
    static = loaded_transmission_error(contact, FORCE, PHASES)
    np.testing.assert_allclose(static.transmission_error, FORCE / stiffness, rtol=1e-12)
    np.testing.assert_allclose(static.tangent_stiffness, stiffness, rtol=1e-12)
    np.testing.assert_allclose(contact.mesh_stiffness(PHASES), stiffness, rtol=1e-12)
    for found, expected in zip(machine_equilibrium(contact, pair), (FORCE / stiffness, stiffness), strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-12)
    for phase in PHASES:
        assert force_in_motion(contact, phase, FORCE / stiffness) == pytest.approx(FORCE, rel=1e-9)


def force_in_motion(contact: ToothContact, phase: float, compression: float) -> float:
    return float(tooth_force(phase, compression, 0.0, *contact.kernel_arguments)[0])


@pytest.mark.parametrize(("degrees", "width"), [(18.0, 30e-3), (12.0, 18e-3), (-30.0, 50e-3)])
def test_a_square_law_goes_with_the_length_of_the_contact_lines(degrees: float, width: float) -> None:
    stiffness = 2e8
    pair = pair_of(degrees, width)
    contact = law(pair, SquareStiffness(stiffness))
    mesh = stiffness * np.array([contact_line_length(pair, phase) for phase in PHASES])
    static = loaded_transmission_error(contact, FORCE, PHASES)
    np.testing.assert_allclose(static.transmission_error, FORCE / mesh, rtol=1e-9)
    np.testing.assert_allclose(contact.mesh_stiffness(PHASES), mesh, rtol=1e-9)
    for found, expected in zip(machine_equilibrium(contact, pair), (FORCE / mesh, mesh), strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-9)
    for phase, expected in zip(PHASES, mesh, strict=True):
        assert force_in_motion(contact, phase, FORCE / expected) == pytest.approx(FORCE, rel=1e-6)
    # Over a period every slice of the face carries for the contact ratio.
    assert contact.unloaded_mean_mesh_stiffness == pytest.approx(stiffness * pair.contact_ratio, rel=1e-9)


def test_a_table_of_the_whole_mesh_is_not_smeared_over_the_helix() -> None:
    pair = pair_of(18.0)
    position, stiffness = np.array([0.0, 0.3, 0.7, 1.0]), np.array([4e8, 5e8, 3e8, 4e8])
    contact = law(pair, TableStiffness(position, stiffness))
    at = np.array([0.0, 0.3, 0.7])
    static = loaded_transmission_error(contact, FORCE, at)
    np.testing.assert_allclose(static.transmission_error, FORCE / stiffness[:3], rtol=1e-6)
    np.testing.assert_allclose(contact.mesh_stiffness(at), stiffness[:3], rtol=1e-6)


def test_misaligned_springs_open_as_independent_springs_do() -> None:
    """A wedge of springs under F: they touch over the width a with F = k γ a²/2b, and the edge yields by γ a."""
    pair, stiffness, angle = pair_of(0.0), 4e8, 8e-4
    wide = math.sqrt(2.0 * FORCE * pair.face_width / (stiffness * angle))
    assert wide < 0.9 * pair.face_width
    contact = law(pair, ConstantStiffness(stiffness), angle)
    static = loaded_transmission_error(contact, FORCE, PHASES[:2])
    edge = static.transmission_error + 0.5 * angle * pair.face_width
    np.testing.assert_allclose(edge, angle * wide, rtol=2e-3)


def test_the_spring_of_a_whole_mesh_stands_in_the_middle_of_the_path() -> None:
    pair = pair_of(18.0)
    contact = law(pair, ConstantStiffness(4e8))
    places = places_on_line_of_action(contact, pair, np.array([[0.1, 0.9]]))
    middle = 0.5 * pair.path_length - pair.pitch_point_position * pair.base_pitch
    np.testing.assert_allclose(places, middle, rtol=1e-12)
