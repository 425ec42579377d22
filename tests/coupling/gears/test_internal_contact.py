"""Contact of an internal pair: curvature and pressure, load sharing, transmission error, corners and friction."""

import math
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.path import Path
from scipy.optimize import brentq

from gearwhine.coupling.gears import (
    GearPairGeometry,
    SquareStiffness,
    TipRelief,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.gears.geometry.faults import MissingTooth, Wear
from gearwhine.coupling.gears.geometry.path_of_contact import corner_contact_range, flank_contact_points
from gearwhine.coupling.gears.geometry.pitch_deviations import pitch_gaps
from gearwhine.coupling.gears.geometry.profile import gear_outline, meshing_rotations
from gearwhine.coupling.gears.loaded.contact_pressure import contact_curvature_radius, contact_modulus, contact_pressure
from gearwhine.coupling.gears.loaded.mesh_friction import mesh_friction
from gearwhine.coupling.gears.stiffness.hertz import line_contact
from tests.machines.internal_pairs import ALPHA, depth_of_overlap, pinion, placed_outlines, ring

PAIR = GearPairGeometry(pinion(), ring())
OTHER = GearPairGeometry(PAIR.driven, PAIR.driver)
MODEL = SquareStiffness(3e8)


def test_convex_and_concave_flank_press_each_other_less() -> None:
    # At the pitch point the radii of curvature are 20 sin(20 deg) and -60 sin(20 deg): 1 / rho = 1 / 6.84 - 1 / 20.52.
    rho = 20e-3 * math.sin(ALPHA) * 60.0 / 40.0
    for pair in (PAIR, OTHER):
        at = pair.pitch_point_position
        assert float(contact_curvature_radius(pair, at)) == pytest.approx(rho, rel=1e-12)
        pressure = math.sqrt(1e5 * contact_modulus(pair) / (math.pi * rho))
        assert float(contact_pressure(pair, at, 1e5)) == pytest.approx(pressure, rel=1e-12)
        contact = line_contact(pair, at)
        assert contact.curvature_radius[0] == pytest.approx(rho, rel=1e-9)
        assert contact.depths.min() > 0.0
    # Everywhere else rho = rho_1 rho_2 / (rho_2 - rho_1), with rho_2 - rho_1 = a sin(w).
    at = np.linspace(0.0, PAIR.contact_ratio, 7)
    first = PAIR.driver.base_radius * PAIR.driver_roll_angle(at)
    second = first + 40e-3 * math.sin(ALPHA)
    np.testing.assert_allclose(contact_curvature_radius(PAIR, at), first * second / (second - first), rtol=1e-10)


def test_exchanging_driver_and_driven_mirrors_the_path() -> None:
    eps = PAIR.contact_ratio
    assert OTHER.contact_ratio == pytest.approx(eps, rel=1e-12)
    here, there = (tooth_contact(pair, MODEL, corner_contact=True) for pair in (PAIR, OTHER))
    start, end = here.contact_range
    position = np.linspace(start, end, 67)
    np.testing.assert_allclose(here.deviation(position), there.deviation(eps - position), atol=3e-13)
    left_over = 2.0 * eps - PAIR.back_flank_offset - OTHER.back_flank_offset
    assert left_over == pytest.approx(round(left_over), abs=1e-9)


@pytest.mark.parametrize("pair", [PAIR, OTHER], ids=lambda pair: pair.label)
def test_gap_at_the_corners_is_that_of_the_drawn_teeth(pair: GearPairGeometry) -> None:
    before, beyond = corner_contact_range(pair)
    for position, tipped in ((-0.8 * before, 1), (pair.contact_ratio + 0.8 * beyond, 0)):
        gap = float(flank_contact_points(pair, position).gap[0])
        assert gap > 1e-6
        assert not corner_touches(pair, position, tipped, gap - 3e-7)
        assert corner_touches(pair, position, tipped, gap + 3e-7)


def corner_touches(pair: GearPairGeometry, position: float, tipped: int, closing: float) -> bool:
    """Whether a corner of the tip of tooth 0 of a gear (0 the driver) stands in the other's teeth, turned to close."""
    gears, centres = (pair.driver, pair.driven), (0.0, pair.working_centre_distance)
    rotations = list(meshing_rotations(pair, position))
    rotations[1 - tipped] += pair.flank_sense(1) * closing / gears[1 - tipped].base_radius
    gear, mating = gears[tipped], gears[1 - tipped]
    outline = Path(gear_outline(mating, rotations[1 - tipped], (centres[1 - tipped], 0.0), points=300))
    angles = [rotations[tipped] + half for half in (gear.tip_half_angle, -gear.tip_half_angle)]
    corners = [(centres[tipped] + gear.tip_radius * math.cos(a), gear.tip_radius * math.sin(a)) for a in angles]
    return any(outline.contains_point(corner) is not mating.is_internal for corner in corners)


def test_loaded_transmission_error_of_square_springs_with_relief() -> None:
    # By hand: n pairs of stiffness k with gaps d_j carry F = sum k max(0, delta - d_j).
    relief = TipRelief(12e-6, length=2e-3)
    pair = GearPairGeometry(replace(pinion(), tip_relief=relief), replace(ring(), tip_relief=relief))
    contact = tooth_contact(pair, MODEL)
    force = 2000.0
    mesh = loaded_transmission_error(contact, force, np.arange(16) / 16.0)
    ends = (0.0, pair.contact_ratio)
    expected = []
    for phase in np.arange(16) / 16.0:
        positions = np.arange(phase, pair.contact_ratio, 1.0)
        along = positions * pair.base_pitch
        # Distance from each end of the path, where one of the tips has the full relief.
        gaps = [
            12e-6 * max(0.0, 1.0 - abs(place - ends[0] * pair.base_pitch) / 2e-3)
            + 12e-6 * max(0.0, 1.0 - abs(place - ends[1] * pair.base_pitch) / 2e-3)
            for place in along
        ]
        expected.append(brentq(lambda d, g=gaps: sum(3e8 * max(0.0, d - one) for one in g) - force, 0.0, 1e-3))
    np.testing.assert_allclose(mesh.transmission_error, expected, rtol=1e-6)


def test_slices_of_an_even_face_are_the_whole() -> None:
    force = 2500.0
    errors = []
    for faces in (None, face_slices(PAIR)):
        errors.append(loaded_transmission_error(tooth_contact(PAIR, MODEL, faces=faces), force).transmission_error)
    np.testing.assert_allclose(errors[1], errors[0], rtol=1e-9)
    # A helical pair of one hand: the section at larger z leads with a right hand that turns counter-clockwise.
    helix = math.radians(12.0)
    pair = GearPairGeometry(pinion(helix_angle=helix), ring(helix_angle=helix))
    slices = face_slices(pair, sense=1)
    turned = pair.driver.turn_along(slices.z[-1]) * pair.driver.teeth / (2.0 * math.pi)
    assert slices.shift[-1] == pytest.approx(turned, rel=1e-9)
    other = face_slices(GearPairGeometry(pair.driven, pair.driver), sense=1)
    assert other.shift[-1] == pytest.approx(turned, rel=1e-9)


@pytest.mark.parametrize("pair", [PAIR, OTHER], ids=lambda pair: pair.label)
def test_friction_loses_less_than_between_external_gears(pair: GearPairGeometry) -> None:
    # As between external gears, with the speed of sliding (w_1 - w_2) of gears that turn the same way.
    mu, force = 0.06, 2000.0
    contact = tooth_contact(pair, MODEL)
    phases = (np.arange(4000) + 0.5) / 4000.0
    friction = mesh_friction(pair, contact, loaded_transmission_error(contact, force, phases), mu)
    s = np.linspace(0.0, pair.contact_ratio, 100001)
    share = np.where((s >= pair.contact_ratio - 1.0) & (s < 1.0), 1.0, 0.5)
    moved = np.trapezoid(share * np.abs(s - pair.pitch_point_position), s) * pair.base_pitch
    ratio = abs(pair.ratio)
    per_turn = moved * abs(1.0 - 1.0 / ratio)
    assert friction.efficiency == pytest.approx(1.0 - mu * per_turn / abs(pair.driver.base_radius), rel=1e-6)
    assert np.all(friction.loss >= 0.0)
    np.testing.assert_allclose(friction.driven_moment / ratio - friction.driver_moment, friction.loss, rtol=1e-12)


def test_faults_and_pitch_deviations_are_on_the_teeth_of_a_ring() -> None:
    deviations = tuple(1e-6 * n for n in range(60))
    pair = GearPairGeometry(pinion(), ring(pitch_deviations=deviations))
    gaps = pitch_gaps(pair)
    np.testing.assert_allclose(gaps, -np.array(deviations) * math.cos(ALPHA), rtol=1e-12)
    worn = GearPairGeometry(pinion(), ring(faults=(Wear(5e-6, shape="uniform"), MissingTooth(59))))
    contact = tooth_contact(worn, MODEL, corner_contact=True)
    assert contact.hunting_period == 60
    with pytest.raises(ValueError, match=r"faults\[0\].tooth is 60; expected a tooth from 0 to 59"):
        ring(faults=(MissingTooth(60),))


def test_back_flanks_mate_as_they_are_drawn() -> None:
    # With the driver turned back by the backlash the teeth that mate touch with their back flanks.
    pair = GearPairGeometry(pinion(profile_shift=0.3), ring(profile_shift=0.2), -38.7e-3)
    drawn = placed_outlines(pair, 0.3, 1, 0.0, closing=-pair.backlash)
    assert depth_of_overlap(*drawn) < 3e-7
