"""Radiation of a housing's modes: proofs, what is exempt from them, long waves, and refusals before the work."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.special import j1

from gearwhine.housing.acoustics import boundary_elements
from gearwhine.housing.acoustics.boundary_elements import BoundaryElements
from gearwhine.housing.acoustics.known_source import NO_SOURCE, NOTHING_TO_PROVE, SourceError
from gearwhine.housing.acoustics.medium import HardPlane, Medium
from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.housing.acoustics.radiation import HousingRadiation, RadiatedSound, require_proved
from gearwhine.housing.errors import HousingError, TriangleSizeError
from gearwhine.meshes import Mesh
from tests.housing.acoustics.surfaces import at_corners, box, disc, rectangle

UNIT = Medium(density=1.0, speed_of_sound=1.0)
BOX = (0.28, 0.25, 0.33)


def at_wavenumber(elements: BoundaryElements, wavenumber: float, velocity: Any) -> Any:
    return elements.solve(wavenumber / (2.0 * np.pi), velocity)


def plate(radius: float, thickness: float, rings: int) -> RadiatingSurface:
    """Closed circular plate about the origin."""
    face = disc(radius, rings)
    count = len(face.points)
    rim = np.arange(count - 6 * rings, count)
    following = np.roll(rim, -1)
    side = np.vstack(
        [np.stack(one, axis=1) for one in ((rim, rim + count, following), (following, rim + count, following + count))]
    )
    up = np.array([0.0, 0.0, 0.5 * thickness])
    return RadiatingSurface(
        np.vstack([face.points + up, face.points - up]),
        np.vstack([face.triangles, face.triangles[:, ::-1] + count, side]),
    )


@pytest.mark.parametrize("ka", [0.5, 1.0, 2.0])
def test_a_thin_plate_that_breathes_is_two_pistons_in_a_baffle(ka):
    """By symmetry its middle plane is a hard baffle: L. L. Beranek, Acoustics, eq. 5.10, on either side."""
    thin = plate(1.0, 0.01, 8)
    outward = np.abs(np.repeat(thin.normals[:, 2], 3))
    elements = BoundaryElements(thin, UNIT)
    field = at_wavenumber(elements, ka, outward)
    assert field.resistance[0, 0] == pytest.approx(2.0 * np.pi * (1.0 - j1(2.0 * ka) / ka), rel=0.01)
    assert field.interior_residual == np.inf
    sound = RadiatedSound(1.0, UNIT, (field,), (outward[:, None],), np.ones((1, 1)), ("rim",) * len(thin.triangles))
    assert sound.doubt == "no point inside the radiating surface is far enough from it to prove the solution"


@pytest.mark.parametrize("count", [1, 5, 20, 60])
def test_few_points_inside_are_shared_between_equations_and_proof(count):
    elements = BoundaryElements(box(BOX, 0.07))
    elements.__dict__["_inner_points"] = elements._inner_points[:count]
    field = elements.solve(300.0, at_corners(elements.surface, lambda points, normals: normals[:, :1]))
    assert elements._checks == {1: 1, 5: 3, 20: 10, 60: 12}[count]
    assert 0.0 < field.interior_residual < 0.05


def test_long_waves_hear_the_volume_flow_alone():
    """Of a small source in air W = rho omega² Q² / (8 pi c); in a baffle, which doubles the pressure, twice that."""
    wavenumber = 0.02

    def uneven(points, normals):
        return (1.0 + points[:, 0] - 3.0 * points[:, 1] ** 2)[:, None]

    face, body = rectangle(1.0, 0.8, 10, 8), box((0.9, 1.0, 1.3), 0.2)
    # Integrals of the velocity: over the face, 0.8 (1 + 1/2) - 0.8³; over the box, area - 3 int y² dS.
    flow = 0.8 * 1.5 - 0.8**3
    baffle = HardPlane(np.zeros(3), np.array([0.0, 0.0, 1.0]))
    found = at_wavenumber(BoundaryElements(face, UNIT, baffle), wavenumber, at_corners(face, uneven))
    assert 0.5 * found.resistance[0, 0] == pytest.approx(wavenumber**2 * flow**2 / (4.0 * np.pi), rel=1e-3)
    assert 0.5 * found.surface_resistance[0, 0] == pytest.approx(wavenumber**2 * flow**2 / (4.0 * np.pi), rel=1e-3)
    squares = 2.0 * (0.9 * 1.3 * 0.25 + (0.9 + 1.3) / 12.0)
    flow = 2.0 * (0.9 * 1.0 + 0.9 * 1.3 + 1.0 * 1.3) - 3.0 * squares
    found = at_wavenumber(BoundaryElements(body, UNIT), wavenumber, at_corners(body, uneven))
    assert 0.5 * found.resistance[0, 0] == pytest.approx(wavenumber**2 * flow**2 / (8.0 * np.pi), rel=2e-3)


def test_pressure_is_exact_down_to_a_hundredth_of_an_edge():
    """A source in a box: beside the surface the pressure is as exact as far from it, and nearer it is refused."""
    surface, source = box(BOX, 0.04), np.array([0.03, -0.02, 0.05])
    wavenumber = 12.0

    def slope(points, normals):
        arm = points - source
        r = np.linalg.norm(arm, axis=1)
        radial = np.exp(-1j * wavenumber * r) * (-1j * wavenumber / r - 1.0 / r**2)
        return (radial / r * np.einsum("ej,ej->e", arm, normals))[:, None]

    elements = BoundaryElements(surface, UNIT)
    field = at_wavenumber(elements, wavenumber, at_corners(surface, slope) / (-1j * wavenumber))
    generator = np.random.default_rng(0)
    chosen = generator.integers(len(surface.triangles), size=60)
    feet = np.einsum("pa,paj->pj", generator.dirichlet(np.ones(3), size=60), surface.corners[chosen])
    near = 0.0101 * surface.lengths.max()
    errors = []
    for height in (near, 0.3 * surface.lengths.max()):
        points = feet + height * surface.normals[chosen]
        r = np.linalg.norm(points - source, axis=1)
        exact = np.exp(-1j * wavenumber * r) / r
        errors.append(np.linalg.norm(field.pressure_at(points)[:, 0] - exact) / np.linalg.norm(exact))
    assert max(errors) < 0.025
    with pytest.raises(HousingError, match=r"from the radiating surface; expected at least .* a hundredth of the edge"):
        field.pressure_at(feet + 0.5 * near * surface.normals[chosen])
    with pytest.raises(HousingError, match="is inside the radiating surface"):
        elements.require_in_air(np.array([[0.5, 0.0, 0.0], [0.0, 0.0, 0.0]]))


@dataclass(frozen=True)
class Powers:
    """Field of given powers, of a square metre that moves with a mean square velocity of 2 (m/s)²."""

    through: float
    far: float
    interior_residual: float = 0.0
    source_error: SourceError = NOTHING_TO_PROVE

    @property
    def surface(self) -> Any:
        return rectangle(1.0, 1.0, 1, 1)

    @property
    def velocity_products(self) -> Any:
        return np.full((1, 1), 4.0)

    @property
    def resistance(self) -> Any:
        return np.full((1, 1), 2.0 * self.far)

    @property
    def surface_resistance(self) -> Any:
        return np.full((1, 1), 2.0 * self.through)


def sound(through: float, far: float, leak: float = 0.0, source: SourceError = NOTHING_TO_PROVE) -> RadiatedSound:
    field: Any = Powers(through, far, leak, source)
    return RadiatedSound(100.0, UNIT, (field,), (), np.ones((1, 1)), ())


def test_sounds_that_count_have_to_balance():
    loud, faint = sound(1.05, 1.0), sound(3e-5, 1e-5)
    assert sound(1.0, 1.0).radiation_efficiency == pytest.approx(0.5)
    assert require_proved([loud, faint]) == [loud]
    assert require_proved([loud, faint], alone=True) == [loud]
    with pytest.raises(
        HousingError, match=r"at 100\.0 Hz the sound power is 0\.0011 W through the surface and 0\.001 W"
    ):
        require_proved([loud, sound(0.0011001, 0.001)])
    # A line whose far field hides what its surface claims.
    with pytest.raises(HousingError, match="expected a difference of at most 10 %"):
        require_proved([loud, sound(0.1, 1e-6)])
    weak = sound(0.0004, 0.0003)  # an efficiency of 1.5e-4
    with pytest.raises(HousingError, match=r"0\.0003 W in the far field"):
        require_proved([weak], alone=True)
    assert len(require_proved([sound(9.0, 9.0), weak])) == 1  # 4e-5 of the whole power


def test_a_pressure_inside_is_doubted():
    assert sound(1.0, 1.0, 0.09).doubt is None
    assert sound(1.0, 1.0, 0.234).doubt == (
        "the pressure inside the radiating surface is 23 % of that on it, where zero is exact; use smaller triangles"
    )
    assert sound(1.0, 1.0, np.inf).interior_residual == np.inf


def off(error: float) -> SourceError:
    return SourceError(error, 0.1 * error, (0.1, -0.02, 0.25))


def test_a_known_source_that_is_off_is_doubted_and_one_that_is_lost_refused():
    assert sound(1.0, 1.0).source_doubt is None
    assert sound(1.0, 1.0, source=off(0.99)).source_doubt is None
    doubted = sound(1.0, 1.0, source=off(1.02))
    assert doubted.source_doubt == (
        "the pressure of a known source inside is off by 102 % at the vertex (100, -20, 250) mm of the radiating "
        "surface; use triangles of another size, best smaller ones"
    )
    assert require_proved([doubted]) == [doubted]
    lost = sound(1.0, 1.0, source=off(10.1))
    with pytest.raises(
        HousingError, match=r"at 100\.0 Hz the pressure of .* off by 1010 % .*; expected at most 1000 %"
    ):
        require_proved([lost])
    loud = sound(1e6, 1e6)
    assert require_proved([loud, lost]) == [loud]  # the lost one is too weak to count
    unproved = sound(1.0, 1.0, source=NO_SOURCE)
    assert unproved.source_doubt == (
        "no place inside the radiating surface is far enough from its triangles for a known source"
    )
    assert require_proved([unproved]) == [unproved]
    assert sound(1.0, 1.0, np.inf, NO_SOURCE).source_doubt is None  # the missing points inside are told


def test_residual_modes_need_not_be_carried(block: Callable[..., Mesh]):
    mesh = block((0.3, 0.2, 0.24), (6, 4, 5))
    smooth = np.zeros((2, len(mesh.points), 3))
    smooth[0, :, 2], smooth[1, :, 0] = 1.0, mesh.points[:, 1]
    rough = np.random.default_rng(4).normal(size=(3, len(mesh.points), 3))
    shapes = np.concatenate([smooth, rough])
    given: dict[str, Any] = {"edge": 0.06, "close_holes": 0.0}
    found = HousingRadiation.of_surface(mesh, shapes, natural_modes=2, **given)
    assert found.transfer_error == pytest.approx(HousingRadiation.of_surface(mesh, smooth, **given).transfer_error)
    assert found.modal[0].shape[1] == 5
    with pytest.raises(TriangleSizeError, match=r"of the 5 shapes .* take triangles with shorter edges"):
        HousingRadiation.of_surface(mesh, shapes, **given)


def test_refuses_triangles_before_the_work(block: Callable[..., Mesh], monkeypatch):
    mesh = block((0.3, 0.2, 0.24), (6, 4, 5))
    shapes = np.ones((1, len(mesh.points), 3))
    given: dict[str, Any] = {"edge": 0.04, "close_holes": 0.0}
    with pytest.raises(TriangleSizeError, match=r"too large for 4000 Hz: .* six need edges of 14\.3 mm"):
        HousingRadiation.of_surface(mesh, shapes, highest_frequency=4000.0, **given)
    whole = HousingRadiation.of_surface(mesh, shapes, highest_frequency=2000.0, **given)
    whole.require_in_air(np.array([[1.0, 0.0, 0.0]]))
    count, points = len(whole.faces), len(whole.elements[0].surface.points)
    monkeypatch.setattr(boundary_elements, "MOST_TRIANGLES", count)
    whole.elements[0].require_few()
    monkeypatch.setattr(boundary_elements, "MOST_TRIANGLES", count - 1)
    # An estimate solves no equations.
    estimate = HousingRadiation.of_surface(mesh, shapes, method="erp", highest_frequency=9000.0, **given)
    with pytest.raises(HousingError, match="needs boundary elements, or Rayleigh's integral of one face"):
        estimate.require_in_air(np.array([[1.0, 0.0, 0.0]]))
    message = (
        rf"{count} triangles .* take {1e-9 * 16.0 * 4.0 / 3.0 * points**2:.3g} GB .* at most {count - 1} triangles"
    )
    for work in (
        lambda: HousingRadiation.of_surface(mesh, shapes, **given),
        lambda: whole.solve(500.0, np.ones((1, 1))),
    ):
        with pytest.raises(TriangleSizeError, match=message):
            work()
    with pytest.raises(TriangleSizeError, match="give a longer edge"):
        HousingRadiation.of_surface(mesh, shapes, edge=0.0005, close_holes=0.0)
