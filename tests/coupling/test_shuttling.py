"""Load shuttling: where the load on helical teeth has its centre, and what its moment does to the shafts."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from helical_pairs import couple_pairs, helical

from gearwhine.coupling import static_equilibrium
from gearwhine.coupling.gears import (
    GearPair,
    GearPairGeometry,
    PotentialEnergyStiffness,
    SquareStiffness,
    load_gear_pair,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.machine.load_shuttling import load_arms, mean_load_arms, shuttling_loads

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


TEETH = np.arange(41)
WAVE = 6e-6 * np.sin(2.0 * np.pi * TEETH / 41.0)


def with_pitch_deviations(deviations: npt.NDArray[np.float64], driver: tuple[float, ...] = ()) -> GearPairGeometry:
    """Helical pair with pitch deviations of its wheel [m], and of its pinion."""
    pair = helical(1.0)
    return replace(
        pair,
        driver=replace(pair.driver, pitch_deviations=driver),
        driven=replace(pair.driven, pitch_deviations=tuple(deviations.tolist())),
    )


def shuttling_of(pair: GearPairGeometry) -> tuple[float, npt.NDArray[np.complex128]]:
    """Constant load and six mesh harmonics of one coordinate [N m]."""
    contact = tooth_contact(pair, PotentialEnergyStiffness(), corner_contact=True, faces=face_slices(pair))
    constant, harmonics = shuttling_loads(contact, pair, FORCE, 0.27, np.ones(1), 0.1, 300.0)
    orders = [round(one.frequency / (2.0 * np.pi * 300.0)) for one in harmonics]
    spectrum = np.zeros(7, dtype=np.complex128)
    spectrum[orders] = [one.amplitude[0] for one in harmonics]
    return float(constant[0]), spectrum


def test_shuttling_does_not_know_which_tooth_is_the_first() -> None:
    """The same wheel, its teeth numbered from another: the mesh harmonics are those of all its mesh periods."""
    constant, harmonics = shuttling_of(with_pitch_deviations(WAVE))
    for first in (10, 27):
        other = shuttling_of(with_pitch_deviations(np.roll(WAVE, first)))
        assert other[0] == pytest.approx(constant, rel=1e-6)
        np.testing.assert_allclose(other[1], harmonics, rtol=0.0, atol=1e-6 * np.abs(harmonics).max())


def test_shuttling_is_even_in_the_amplitude_of_a_long_wave() -> None:
    """Half a turn of the wheel changes the wave's sign: what goes in proportion has no part in the mesh harmonics."""
    constant, harmonics = shuttling_of(with_pitch_deviations(WAVE))
    negative = shuttling_of(with_pitch_deviations(-WAVE))
    alike = shuttling_of(helical(1.0))
    largest = float(np.abs(harmonics).max())
    np.testing.assert_allclose(negative[1], harmonics, rtol=0.0, atol=2e-3 * largest)
    assert negative[0] == pytest.approx(constant, abs=2e-3 * largest)
    # Half the wave has a quarter of the change.
    half = shuttling_of(with_pitch_deviations(0.5 * WAVE))
    whole_change, half_change = abs(harmonics[1] - alike[1][1]), abs(half[1][1] - alike[1][1])
    assert 3.0 * half_change < whole_change < 0.1 * largest


def test_many_different_mesh_periods_have_the_mean_of_some() -> None:
    """23 and 41 teeth that differ make 943 mesh periods; a part of them, evenly spread, has nearly the mean of all."""
    driver = tuple((2e-6 * np.cos(2.0 * np.pi * np.arange(23) / 23.0)).tolist())
    pair = with_pitch_deviations(WAVE, driver)
    contact = tooth_contact(pair, SquareStiffness(4e8), faces=face_slices(pair, count=15))
    phases = np.array([0.2, 0.7])
    every = load_arms(contact, pair, FORCE, (np.arange(943)[:, None] + phases).ravel())
    expected = every.reshape(943, 2, 2).mean(axis=0)
    found = mean_load_arms(contact, pair, FORCE, phases)
    np.testing.assert_allclose(found, expected, atol=0.02 * every.std(axis=0).max())


def test_the_damping_ratio_does_not_know_which_tooth_is_the_first() -> None:
    """It refers to the mean stiffness of all mesh periods."""
    pair = GearPair("pinion", "wheel", damping_ratio=0.05)
    damping = [
        load_gear_pair(
            pair, with_pitch_deviations(np.roll(WAVE, first)), torque=100.0, inertias=(1e-3, 5e-3)
        ).contact.damping
        for first in (0, 11, 30)
    ]
    assert damping == pytest.approx([damping[0]] * 3, rel=1e-9)
