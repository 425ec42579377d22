"""Bodies that stand on a hard floor: against the closed body with its image, and against sources with theirs."""

import numpy as np
import pytest
from solids import cubes

from gearwhine.housing.acoustics.boundary_elements import BoundaryElements
from gearwhine.housing.acoustics.medium import HardPlane, Medium
from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.housing.acoustics.radiation import HousingRadiation
from gearwhine.housing.errors import HousingError
from tests.housing.acoustics.surfaces import at_corners, box

AIR = Medium(density=1.2, speed_of_sound=343.0)
FLOOR = HardPlane(np.zeros(3), np.array([0.0, 1.0, 0.0]))
SIZE = (0.3, 0.25, 0.2)
SOURCE = np.array([0.04, 0.09, -0.02])


def standing_box(edge: float) -> RadiatingSurface:
    return box(SIZE, edge, low=(-0.1, 0.0, -0.1))


def with_image(upper: RadiatingSurface) -> RadiatingSurface:
    """One closed surface of a surface that is open in the floor and its mirror image; the rim is theirs together."""
    above = np.flatnonzero(upper.points[:, 1] > 1e-9)
    image = np.arange(len(upper.points))
    image[above] = len(upper.points) + np.arange(len(above))
    points = np.vstack([upper.points, FLOOR.mirror(upper.points[above])])
    return RadiatingSurface(points, np.vstack([upper.triangles, image[upper.triangles][:, ::-1]]))


def test_a_standing_box_is_the_upper_half_of_the_box_with_its_image():
    standing = BoundaryElements(standing_box(0.06), AIR, FLOOR)
    upper = standing.surface
    whole = BoundaryElements(with_image(upper), AIR)
    generator = np.random.default_rng(3)
    velocity = generator.normal(size=(3 * len(upper.triangles), 2))
    mirrored = velocity.reshape(-1, 3, 2)[:, ::-1].reshape(-1, 2)
    # The same points inside, so that the equations are the same.
    inner, checks = standing._inner_points, standing._checks
    whole.__dict__["_inner_points"] = np.vstack([inner[:checks], inner[checks:], FLOOR.mirror(inner[checks:])])
    equations = len(inner) - checks
    standing._inner_count = lambda wavenumber: equations  # type: ignore[method-assign]
    whole._inner_count = lambda wavenumber: 2 * equations  # type: ignore[method-assign]
    one, both = standing.solve(700.0, velocity), whole.solve(700.0, np.vstack([velocity, mirrored]))
    size = np.abs(one.pressure).max()
    assert one.pressure == pytest.approx(both.pressure[: len(upper.points)], rel=1e-9, abs=1e-9 * size)
    assert one.resistance == pytest.approx(0.5 * both.resistance, rel=1e-9)
    assert one.surface_resistance == pytest.approx(0.5 * both.surface_resistance, rel=1e-9)
    assert one.velocity_products == pytest.approx(0.5 * both.velocity_products, rel=1e-9)


def test_a_source_in_a_standing_box_and_its_image_have_their_own_field():
    elements = BoundaryElements(standing_box(0.03), AIR, FLOOR)
    assert elements.surface.area == pytest.approx(2.0 * 0.25 * (0.3 + 0.2) + 0.3 * 0.2)  # without the sole
    assert elements.uncovered.sum() == len(elements.surface.triangles)
    hertz = 900.0
    wavenumber = 2.0 * np.pi * hertz / 343.0
    sources = np.array([SOURCE, FLOOR.mirror(SOURCE[None])[0]])

    def pressure(points):
        r = np.linalg.norm(points[:, None] - sources, axis=2)
        return (np.exp(-1j * wavenumber * r) / r).sum(axis=1)

    def slope(points, normals):
        arm = points[:, None] - sources
        r = np.linalg.norm(arm, axis=2)
        radial = np.exp(-1j * wavenumber * r) * (-1j * wavenumber / r - 1.0 / r**2)
        return np.einsum("es,esj,ej->e", radial / r, arm, normals)[:, None]

    field = elements.solve(hertz, at_corners(elements.surface, slope) / (-1j * wavenumber * AIR.impedance))
    # The last two lie on the floor, one of them at the foot of the box.
    heard = np.array([[0.6, 0.3, -0.2], [0.0, 0.7, 0.0], [-0.4, 0.0, 0.5], [0.21, 0.0, 0.0]])
    assert field.pressure_at(heard)[:, 0] == pytest.approx(pressure(heard), rel=0.02)
    best = at_corners(elements.surface, lambda points, normals: pressure(points)[:, None])
    means = [one.reshape(-1, 3).mean(axis=1) for one in (field.pressure_at_corners, best)]
    assert np.linalg.norm(means[0] - means[1]) < 0.01 * np.linalg.norm(means[1])
    twice = 2.0 * wavenumber * SOURCE[1]
    exact = 4.0 * np.pi * (1.0 + np.sin(twice) / twice) / AIR.impedance
    assert field.resistance[0, 0] == pytest.approx(exact, rel=0.01)
    assert field.surface_resistance[0, 0] == pytest.approx(exact, rel=0.01)
    assert field.interior_residual < 0.01


@pytest.mark.parametrize("height", [0.0, 4e-4, -4e-4])
def test_a_housing_radiates_without_its_sole(height):
    """The floor touches the sole, or is off by less than the wrap's accuracy of 2 % of an edge."""
    mesh = cubes(np.ones((4, 3, 3), dtype=bool), (0.05, 0.05, 0.05))
    floor = HardPlane(np.array([0.0, height, 0.0]), np.array([0.0, 1.0, 0.0]))
    shapes = np.zeros((1, len(mesh.points), 3))
    shapes[:, :, 1] = 2.0  # up and down as a whole: its top alone moves the air
    found = HousingRadiation.of_surface(mesh, shapes, edge=0.03, close_holes=0.0, medium=AIR, floor=floor)
    (elements,) = found.elements
    assert found.area == pytest.approx(2.0 * 0.15 * (0.2 + 0.15) + 0.2 * 0.15, rel=3e-3)
    assert np.abs(floor.height(elements.surface.points)).min() == pytest.approx(0.0, abs=1e-15)
    assert len(found.faces) == len(elements.surface.triangles) < len(elements.uncovered)
    assert len(found.modal[0]) == 3 * len(found.faces)
    sound = found.solve(30.0, [[1.0]])
    assert sound.mean_square_velocity * sound.area == pytest.approx(0.5 * 4.0 * 0.2 * 0.15, rel=1e-6)
    # A small source on a floor: W = rho omega² Q² / (4 pi c).
    flow = 2.0 * 0.2 * 0.15
    omega = 2.0 * np.pi * 30.0
    assert sound.power == pytest.approx(1.2 * omega**2 * flow**2 / (4.0 * np.pi * 343.0), rel=0.01)


def test_refuses_bodies_and_points_beside_the_air():
    surface = standing_box(0.06)
    raised = RadiatingSurface(surface.points + np.array([0.0, 1e-5, 0.0]), surface.triangles)
    with pytest.raises(HousingError, match=r"a gap of 0\.01 mm above the hard plane; expected none, or at least 0\.4"):
        BoundaryElements(raised, AIR, FLOOR)
    lowered = RadiatingSurface(surface.points - np.array([0.0, 1e-5, 0.0]), surface.triangles)
    with pytest.raises(HousingError, match=r"reaches 0\.01 mm behind the hard plane"):
        BoundaryElements(lowered, AIR, FLOOR)
    elements = BoundaryElements(surface, AIR, FLOOR)
    elements.require_in_air(np.array([[0.5, 0.0, 0.0], [0.5, -1e-12, 0.0]]))
    elements.require_in_air(np.zeros((0, 3)))
    for point, message in (
        ([0.5, -1e-6, 0.0], r"\(500, -0.001, 0\) mm is behind"),
        ([0.0, 0.0, 0.0], "is inside"),  # on the floor below the box
        ([0.0, 0.1, 0.0], "is inside"),
        ([0.0, 0.2501, 0.0], r"is 0\.1 mm from the radiating surface; expected at least 0\.8"),
    ):
        with pytest.raises(HousingError, match=message):
            elements.require_in_air(np.array([[0.5, 0.2, 0.0], point]))
    with pytest.raises(HousingError, match=f"velocities at {3 * len(surface.triangles)} corners; expected"):
        elements.solve(300.0, np.ones(3 * len(surface.triangles)))
