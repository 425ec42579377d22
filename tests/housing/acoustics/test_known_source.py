"""Known sources inside: their exact field, where they stand, and what they see that the other proofs do not."""

import numpy as np
import pytest
from test_floor import FLOOR, standing_box
from test_radiation import plate

from gearwhine.housing.acoustics import boundary_elements
from gearwhine.housing.acoustics.boundary_elements import BoundaryElements, SoundField
from gearwhine.housing.acoustics.boundary_integrals import linear_projection
from gearwhine.housing.acoustics.known_source import (
    NO_SOURCE,
    NOTHING_TO_PROVE,
    SOURCE_DEPTH,
    KnownField,
    KnownSources,
    depths,
    over_narrow_gap,
)
from gearwhine.housing.acoustics.medium import AIR, HardPlane
from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.housing.acoustics.radiation import LEAK, SOURCE_OFF
from tests.housing.acoustics.surfaces import BOX, at_corners, box, rectangle, sphere, uneven

PLACES = np.array([[0.03, 0.1, 0.05], [-0.05, 0.2, -0.02]])


def field_at(elements: BoundaryElements, hertz: float) -> SoundField:
    """Field of a body that breathes."""
    return elements.solve(hertz, np.ones(3 * len(elements.surface.triangles)))


@pytest.mark.parametrize("plane", [None, FLOOR])
def test_the_slope_is_the_derivative_of_the_pressure(plane):
    sources, wavenumber, step = KnownSources(PLACES, plane), 17.0, 1e-5
    generator = np.random.default_rng(4)
    points = np.array([0.0, 0.4, 0.0]) + 0.3 * generator.uniform(-1.0, 1.0, (20, 3)) + np.array([0.5, 0.0, 0.0])
    normals = generator.normal(size=(20, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    above, below = (sources.pressure(points + side * step * normals, wavenumber) for side in (1.0, -1.0))
    np.testing.assert_allclose(sources.slope(points, normals, wavenumber), (above - below) / (2.0 * step), rtol=1e-6)
    if plane is None:
        # A monopole alone: its amplitude does not depend on the direction, and its phase lags with the distance.
        r = np.linalg.norm(points - PLACES[1], axis=1)
        np.testing.assert_allclose(sources.pressure(points, wavenumber)[:, 1] * r, np.exp(-1j * wavenumber * r))
        np.testing.assert_allclose(sources.amplitude(points)[:, 1], 1.0 / r)
    else:
        on_floor = points * np.array([1.0, 0.0, 1.0])
        up = np.tile(plane.normal, (20, 1))
        assert np.abs(sources.slope(on_floor, up, wavenumber)).max() < 1e-9
        alone = KnownSources(PLACES).pressure(on_floor, wavenumber)
        np.testing.assert_allclose(sources.pressure(on_floor, wavenumber), 2.0 * alone)


def test_a_projection_keeps_linear_fields_and_the_mean_of_bent_ones():
    surface = box(BOX, 0.12)
    linear = linear_projection(
        surface, lambda points: (2.0 + points @ np.array([[1.0], [-3.0], [0.5]])).astype(complex)
    )
    np.testing.assert_allclose(linear[:, 0], 2.0 + surface.corners.reshape(-1, 3) @ np.array([1.0, -3.0, 0.5]))
    bent = linear_projection(surface, lambda points: (points[:, :1] ** 2).astype(complex))
    # ∫ x² over a triangle is its area times the mean of the squares at the middles of its edges.
    middles = 0.5 * (surface.corners + np.roll(surface.corners, 1, axis=1))[:, :, 0]
    np.testing.assert_allclose(bent.reshape(-1, 3).mean(axis=1), (middles**2).mean(axis=1), atol=1e-15)


@pytest.mark.parametrize(
    ("coarse", "fine", "order"),
    [(box(BOX, 0.05), box(BOX, 0.025), 1.9), (sphere(5, 0.15), sphere(10, 0.15), 1.3)],
    ids=["box", "sphere, whose edges also follow it the better"],
)
def test_the_error_falls_with_the_edge(coarse: RadiatingSurface, fine: RadiatingSurface, order: float):
    found = []
    for surface in (coarse, fine):
        elements = BoundaryElements(surface, AIR)
        # The same places, which on smaller triangles would lie nearer to the surface.
        elements.__dict__["known_sources"] = KnownSources(np.array([[0.02, -0.01, 0.03], [-0.03, 0.02, 0.01]]))
        found.append(field_at(elements, 700.0).source_error)
    assert np.log2(found[0].rms / found[1].rms) > order
    assert found[0].largest > 2.0 * found[1].largest


@pytest.mark.slow
def test_the_error_depends_little_on_the_place_of_the_source():
    elements = BoundaryElements(box(BOX, 0.025), AIR)
    deep = depths(elements.surface, elements._inner_points)
    chosen, deep = elements._inner_points[deep >= SOURCE_DEPTH], deep[deep >= SOURCE_DEPTH]
    elements.__dict__["known_sources"] = KnownSources(chosen)
    order = np.argsort(deep)
    shallow, deepest = order[: len(order) // 3], order[-len(order) // 3 :]
    assert len(order) > 200
    assert deep[shallow].max() < 1.6 * SOURCE_DEPTH < 2.2 * SOURCE_DEPTH < deep[deepest].max()
    # Near the source the linear functions err by the bend of 1/r; at few edges a wavelength that of the wave counts.
    for edges, largest, rms in ((12.0, 2.0, 1.2), (3.05, 1.1, 1.2)):
        known = field_at(elements, elements.highest_frequency(edges)).known
        assert known is not None
        for errors, bar in ((known.errors.max(axis=0), largest), (np.sqrt((known.errors**2).mean(axis=0)), rms)):
            assert 1.0 / bar < np.median(errors[shallow]) / np.median(errors[deepest]) < bar, edges
            assert errors.max() < 1.7 * bar * errors.min(), edges


def test_two_deep_places_far_from_each_other_are_chosen():
    long = BoundaryElements(box((1.0, 0.2, 0.25), 0.05), AIR)
    sources = long.known_sources
    assert len(sources.places) == 2
    assert depths(long.surface, sources.places).min() >= SOURCE_DEPTH
    assert np.linalg.norm(sources.places[0] - sources.places[1]) > 0.4
    np.testing.assert_array_equal(sources.places, BoundaryElements(long.surface, AIR).known_sources.places)
    # Of these points one alone is deep enough; and none.
    points = np.array([[0.0, 0.0, 0.1], [0.0, 0.0, 0.0], [0.0, 0.08, 0.0]])
    np.testing.assert_array_equal(KnownSources.inside(long.surface, points, None).places, points[1:2])
    assert len(KnownSources.inside(long.surface, points[[0, 2]], None).places) == 0
    assert len(KnownSources.inside(long.surface, points[:0], None).places) == 0


def test_a_depth_is_measured_in_edges_of_each_triangle():
    """Over one right triangle with legs of 3 and 4 cm, an edge of 5 cm, and one ten times as large 40 cm away."""
    small = np.array([[0.0, 0.0, 0.0], [0.03, 0.0, 0.0], [0.0, 0.04, 0.0]])
    large = 10.0 * small + np.array([0.0, 0.0, 0.4])
    pair = RadiatingSurface(np.vstack([small, large]), np.array([[0, 1, 2], [5, 4, 3]]))
    middle = small.mean(axis=0)
    above = middle + np.array([[0.0, 0.0, 0.02], [0.0, 0.0, 0.1], [0.0, 0.0, 0.2]])
    beside = 10.0 * middle + np.array([0.0, 0.0, 0.4])
    to_large = np.linalg.norm(above - beside, axis=1) / 0.5
    assert to_large[2] < 4.0
    np.testing.assert_allclose(depths(pair, above), np.minimum([0.4, 2.0, 4.0], to_large))


def test_thin_bodies_have_no_source_and_faces_need_none():
    thin = BoundaryElements(box((0.4, 0.4, 0.03), 0.04), AIR)
    field = field_at(thin, 300.0)
    assert field.known is None
    assert field.source_error == NO_SOURCE
    assert field.source_error_at(np.array([[1.0, 0.0, 0.0]])) == [np.inf]
    assert BoundaryElements(plate(0.3, 0.01, 5), AIR).known_sources.places.shape == (0, 3)
    face = BoundaryElements(rectangle(0.3, 0.2, 6, 4), AIR, HardPlane(np.zeros(3), np.array([0.0, 0.0, 1.0])))
    baffled = field_at(face, 300.0)
    assert baffled.source_error == NOTHING_TO_PROVE
    assert baffled.source_error_at(np.array([[0.0, 0.0, 1.0]])) == [0.0]


@pytest.mark.parametrize("plane", [None, FLOOR])
def test_the_sources_leave_the_motions_as_they_are(plane):
    surface = standing_box(0.05)
    elements, alone = BoundaryElements(surface, AIR, plane), BoundaryElements(surface, AIR, plane)
    alone.__dict__["known_sources"] = KnownSources(np.zeros((0, 3)), plane)
    velocity = at_corners(elements.surface, lambda points, normals: normals + 0.3j * points)
    one, other = (each.solve(700.0, velocity) for each in (elements, alone))
    assert one.known is not None
    assert other.known is None
    assert one.pressure.shape == one.inside.shape[:0] + (len(elements.surface.points), 3)
    np.testing.assert_allclose(one.pressure, other.pressure, rtol=0.0, atol=1e-11 * np.abs(one.pressure).max())
    # A motion that is the source's own has the same error as the source.
    own = elements.known_sources.flux(elements.surface, one.wavenumber) / (-1j * one.wavenumber * AIR.impedance)
    field = elements.solve(700.0, own)
    np.testing.assert_allclose(one.known.pressure, field.pressure, rtol=1e-9)
    heard = np.array([[0.6, 0.3, -0.2], [0.0, 0.7, 0.1], [-0.4, 0.0, 0.5]])
    sources = elements.known_sources
    apart = np.abs(field.pressure_at(heard) - sources.pressure(heard, one.wavenumber)) / sources.amplitude(heard)
    np.testing.assert_allclose(one.source_error_at(heard), apart.max(axis=1), rtol=1e-6)
    assert 0.0 < apart.max() < 0.02


def test_a_source_over_a_floor_has_its_image():
    elements = BoundaryElements(standing_box(0.04), AIR, FLOOR)
    field = field_at(elements, elements.highest_frequency(8.0))
    assert field.known is not None
    assert 0.005 < field.source_error.rms < field.source_error.largest < 0.12
    # Without its image the source is another one.
    bare = KnownField(
        elements.surface, KnownSources(field.known.sources.places), field.wavenumber, field.known.pressure
    )
    assert bare.error.largest > 0.9
    assert elements.known_sources.plane is FLOOR
    assert (elements.known_sources.places[:, 1] > 0.0).all()


def test_vertices_over_a_narrow_gap_do_not_count():
    """A body 0.02 edges above the floor, whose gap the triangles do not resolve, is outside as the one that stands."""
    size, edge = (0.3, 0.25, 0.2), 0.04
    found = {}
    for height in (0.0, 0.001, 0.012):
        elements = BoundaryElements(box(size, edge, low=(-0.1, height, -0.1)), AIR, FLOOR)
        # Places apart from the gap, the same for all.
        elements.__dict__["known_sources"] = KnownSources(np.array([[0.04, 0.15, -0.02], [0.0, 0.11, 0.03]]), FLOOR)
        field = field_at(elements, 1200.0)
        assert field.known is not None
        low = field.known.surface.points[:, 1] < height + 1e-9
        narrow = over_narrow_gap(field.known.surface, FLOOR)
        np.testing.assert_array_equal(narrow, low if height == 0.001 else np.zeros_like(low))
        outside = field.known.errors[~low].max()
        found[height] = field.source_error.largest, outside, field.known.errors[low].max()
    assert found[0.001][2] > 10.0 * found[0.0][1]
    assert found[0.001][0] == found[0.001][1] < 1.3 * found[0.0][1]
    assert found[0.012][0] == max(found[0.012][1:]) < 3.0 * found[0.0][1]


def test_a_vertex_that_the_equations_leave_free_is_seen_by_known_sources_alone(monkeypatch: pytest.MonkeyPatch):
    surface, drawn = uneven(0.76)
    bounded = field_at(BoundaryElements(surface, AIR), 1300.0)
    assert bounded.source_error.largest < 0.1 * SOURCE_OFF
    monkeypatch.setattr(boundary_elements, "_MOST_CURVATURE", np.inf)
    free = field_at(BoundaryElements(surface, AIR), 1300.0)
    error = free.source_error
    assert error.largest > 1.2 * SOURCE_OFF
    # Where nine tenths of a spike count as curvature: beside the vertex that is drawn.
    part = boundary_elements._curvature_correction(surface).tocsr().diagonal()
    assert part.max() == pytest.approx(0.9, abs=0.01)
    lost = int(np.argmax(part))
    assert error.place == pytest.approx(tuple(surface.points[lost]))
    assert (surface.triangles == lost).any(axis=1)[(surface.triangles == drawn).any(axis=1)].any()
    # Neither the balance of power nor the pressure inside knows of it.
    balance = 10.0 * np.log10(free.surface_resistance[0, 0] / free.resistance[0, 0])
    assert abs(balance) < 0.05
    assert free.interior_residual < 0.1 * LEAK
