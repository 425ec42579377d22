"""Load shuttling: where the load on helical teeth has its centre, and what its moment does to the shafts."""

from dataclasses import replace

import numpy as np
import pytest
from helical_pairs import couple_pairs, helical

from coupling import static_equilibrium
from coupling.gears import SquareStiffness, tooth_contact
from coupling.gears.contact.face_slices import face_slices
from coupling.machine.load_shuttling import load_arms

FORCE = 4000.0


def test_the_centre_of_an_even_load_is_that_of_the_contact_lines() -> None:
    """Closed form: lines of even load per width, each from where it enters the zone of action to where it leaves it."""
    pair = helical(1.0)
    # Teeth that do not pass shear on carry evenly, wherever they touch.
    faces = replace(face_slices(pair), coupling=0.0)
    contact = tooth_contact(pair, SquareStiffness(2e8), faces=faces)
    phases = np.array([0.07, 0.31, 0.56, 0.83])
    b, overlap, along = pair.face_width, pair.overlap_ratio, pair.contact_ratio
    lead = float(np.sign(faces.shift[-1]))
    expected = []
    for phase in phases:
        ends = []
        for start in phase + np.arange(-4.0, 5.0):
            z = np.sort(lead * b / overlap * (np.array([0.0, along]) - start)).clip(-0.5 * b, 0.5 * b)
            if z[1] > z[0]:
                ends.append((*z, start))
        z1, z2, start = np.array(ends).T
        length = z2 - z1
        middle = 0.5 * (z1 + z2)
        on_path = start + lead * overlap * middle / b - pair.pitch_point_position
        expected.append([np.average(middle, weights=length), pair.base_pitch * np.average(on_path, weights=length)])
    found = load_arms(contact, pair, FORCE, phases)
    np.testing.assert_allclose(found, expected, atol=0.006 * b)  # a third of a slice
    assert np.ptp(found[:, 0]) > 0.02 * b


@pytest.mark.parametrize("hand", [1.0, -1.0])
def test_bearings_bear_the_moment_of_the_load_where_it_acts(hand: float) -> None:
    """Equilibrium of the driven shaft: its bearings against the force of the teeth at the centre of their load."""
    machine = couple_pairs(hand, thrust_stiffness=1e8, speed=1e-3, sliced=True)
    system, (mesh,) = machine.system, machine.meshes
    (contact,) = system.contacts
    missed, moved = [], []
    for time in np.arange(16) / 16.0 / abs(contact.mesh_frequency):
        moments = [(one.amplitude * np.exp(1j * one.frequency * time)).real for one in system.harmonic_loads]
        q = static_equilibrium(replace(system, load=system.load + sum(moments), harmonic_loads=()), float(time))
        # Of the shaft on its bearings, about the middle of the gear.
        force, moment = np.zeros(3), np.zeros(3)
        for mounted, tie in zip(machine.bearings, system.linear, strict=False):
            if mounted.rotor == mesh.driven.rotor:
                push = np.zeros(5)
                push[list(tie.axes)] = tie.stiffness @ (tie.directions.T @ q)
                force += push[:3]
                moment += np.cross([0.0, 0.0, mounted.bearing.at - mesh.driven.at], push[:3])
        size = float(np.linalg.norm(force[:2]))
        phase = float(contact.phase + contact.mesh_frequency * time)
        z, xi = load_arms(contact.contact, mesh.geometry, size, [phase])[0]
        along = force[:2] / size
        # The driver sits on the driven gear's -x side.
        pitch_point = np.array([-mesh.geometry.working_pitch_radii[1], 0.0, 0.0])
        place = pitch_point + [xi * along[0], xi * along[1], z]
        missed.append(moment[:2] - np.cross(place, force)[:2])
        moved.append(moment[:2] - np.cross(pitch_point, force)[:2])
    # The loads end with the sixth harmonic; the curve has steep flanks where lines of contact enter.
    assert np.linalg.norm(missed) < 0.15 * np.linalg.norm(moved)
    assert np.abs(moved).max() > 0.01 * size * mesh.geometry.face_width
