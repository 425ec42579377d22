"""Boundary elements against exact sound fields: spheres, sources in a box, pistons and plates in a baffle."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import j1, spherical_jn, spherical_yn, struve

from gearwhine.housing.acoustics.boundary_elements import BoundaryElements, SoundField
from gearwhine.housing.acoustics.medium import HardPlane, Medium
from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.housing.errors import HousingError
from tests.housing.acoustics.surfaces import BOX, at_corners, box, disc, rectangle, sphere, uneven

UNIT = Medium(density=1.0, speed_of_sound=1.0)  # k = ω
LABORATORY = Medium(density=1.2, speed_of_sound=343.0)


def decibels(ratio):
    return 10.0 * np.log10(ratio)


def at_wavenumber(elements: BoundaryElements, wavenumber: float, velocity) -> SoundField:
    return elements.solve(wavenumber * elements.medium.speed_of_sound / (2.0 * np.pi), velocity)


def harmonics(points, normals):
    cosine = points[:, 2] / np.linalg.norm(points, axis=1)
    return np.stack([np.polynomial.legendre.Legendre.basis(n)(cosine) for n in range(4)], axis=1)


def efficiency(n: int, ka: float) -> float:
    """Radiation efficiency of a sphere's spherical harmonic, Re(-i h_n / h_n') for exp(+i omega t)."""
    outgoing = spherical_jn(n, ka) - 1j * spherical_yn(n, ka)
    derivative = spherical_jn(n, ka, derivative=True) - 1j * spherical_yn(n, ka, derivative=True)
    return float((-1j * outgoing / derivative).real)


def sphere_efficiencies(surface: RadiatingSurface, ka: float) -> tuple[np.ndarray, SoundField]:
    velocity = at_corners(surface, harmonics)
    field = at_wavenumber(BoundaryElements(surface, UNIT), ka, velocity)
    return np.diag(field.resistance) / np.diag(field.velocity_products).real, field


# π and 4.4934 are natural frequencies of the air inside, at which the plain equation fails.
@pytest.mark.slow
@pytest.mark.parametrize("ka", [0.25, 1.0, np.pi, 4.493409457909064, 5.0])
def test_sphere(sphere_2000, ka):
    found, field = sphere_efficiencies(sphere_2000, ka)
    for n in range(4):
        exact = efficiency(n, ka)
        assert abs(found[n] - exact) <= (0.01 * exact if exact >= 1e-4 else 1e-6), (n, found[n], exact)
    assert np.all(np.abs(decibels(np.diag(field.surface_resistance) / np.diag(field.resistance))) < 0.25)
    assert field.interior_residual < 0.02
    assert field.reciprocity_error < 1e-3


@pytest.fixture(scope="module")
def sphere_2000() -> RadiatingSurface:
    return sphere(10)


def test_pressure_converges_with_the_square_of_the_edge():
    ka, errors = 2.0, []
    for frequency in (5, 10):
        surface = sphere(frequency)
        _, field = sphere_efficiencies(surface, ka)
        worst = []
        for n in range(4):
            outgoing = spherical_jn(n, ka) - 1j * spherical_yn(n, ka)
            derivative = spherical_jn(n, ka, derivative=True) - 1j * spherical_yn(n, ka, derivative=True)
            exact = -1j * outgoing / derivative * harmonics(surface.points, None)[:, n]
            worst.append(np.linalg.norm(field.pressure[:, n] - exact) / np.linalg.norm(exact))
        errors.append(max(worst))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.2)


SOURCE = np.array([0.03, -0.02, 0.05])
ALONG = np.array([1.0, 2.0, -0.5]) / np.sqrt(5.25)


def sources(wavenumber):
    """Normal derivative of the potential of a monopole exp(-ikr)/r and of a dipole, its derivative along a line."""

    def field(points, normals):
        arm = points - SOURCE
        r = np.linalg.norm(arm, axis=1)[:, None]
        towards, wave = arm / r, np.exp(-1j * wavenumber * r)
        slope = wave * (-1j * wavenumber / r - 1.0 / r**2)
        bend = wave * (-(wavenumber**2) / r + 2j * wavenumber / r**2 + 2.0 / r**3)
        cosine = (towards @ ALONG)[:, None]
        dipole = bend * cosine * towards + slope / r * (ALONG - cosine * towards)
        return np.stack([np.einsum("ej,ej->e", one, normals) for one in (slope * towards, dipole)], axis=1)

    return field


# Natural frequencies of the air inside the box, (c/2) √Σ(nᵢ/lᵢ)², and frequencies beside them.
@pytest.mark.slow
@pytest.mark.parametrize(
    ("hz", "bar"),
    [(1060.6, 0.02), (1075, 0.02), (3000, 0.02), (5000, 0.05), (5020, 0.05)],
)
def test_sources_inside_a_box(fine_box, coarse_box, hz, bar):
    surface = fine_box if hz > 2000 else coarse_box
    wavenumber = 2.0 * np.pi * hz / 343.0
    flux = at_corners(surface, sources(wavenumber))
    velocity = flux / (-1j * wavenumber * LABORATORY.impedance)
    field = BoundaryElements(surface, LABORATORY).solve(hz, velocity)
    exact = np.array([4.0 * np.pi, wavenumber**2 * 4.0 * np.pi / 3.0]) / LABORATORY.impedance
    assert np.all(np.abs(decibels(np.diag(field.resistance) / exact)) < bar)
    assert np.all(np.abs(decibels(np.diag(field.surface_resistance) / np.diag(field.resistance))) < 0.01)
    far = np.array([[0.6, 0.3, -0.2], [0.0, -0.5, 0.0], [-0.4, 0.2, 0.5]])
    r = np.linalg.norm(far - SOURCE, axis=1)
    exact = np.exp(-1j * wavenumber * r) / r
    assert np.abs(field.pressure_at(far)[:, 0] / exact - 1.0).max() < (0.005 if hz < 4000 else 0.03)


@pytest.fixture(scope="module")
def fine_box() -> RadiatingSurface:
    """Box of 3,316 triangles."""
    return box(BOX, 0.0172)


@pytest.fixture(scope="module")
def coarse_box() -> RadiatingSurface:
    return box(BOX, 0.022)


@pytest.mark.parametrize("part", [0.0, 0.5, 0.65, 0.75])
def test_a_vertex_of_uneven_triangles_has_the_pressure_of_the_others(part):
    """A monopole inside, and a vertex that is drawn towards a neighbour."""
    surface, vertex = uneven(part)
    wavenumber = 2.0 * np.pi * 800.0 / 343.0
    velocity = at_corners(surface, sources(wavenumber))[:, :1] / (-1j * wavenumber * LABORATORY.impedance)
    field = BoundaryElements(surface, LABORATORY).solve(800.0, velocity)
    r = np.linalg.norm(surface.points - SOURCE, axis=1)
    exact = np.exp(-1j * wavenumber * r) / r
    error = np.abs(field.pressure[:, 0] - exact) / np.abs(exact).max()
    assert error[vertex] < 0.03


def test_a_floor_is_the_mirrored_pair():
    upper = box((0.3, 0.2, 0.25), 0.05, low=(-0.1, 0.04, -0.1))
    floor = HardPlane(np.zeros(3), np.array([0.0, 1.0, 0.0]))
    generator = np.random.default_rng(3)
    velocity = generator.normal(size=(3 * len(upper.triangles), 2))
    single = BoundaryElements(upper, LABORATORY, floor).solve(700.0, velocity)
    flipped = upper.points * np.array([1.0, -1.0, 1.0])
    both = RadiatingSurface(
        np.vstack([upper.points, flipped]), np.vstack([upper.triangles, upper.triangles[:, ::-1] + len(flipped)])
    )
    mirrored = velocity.reshape(-1, 3, 2)[:, ::-1].reshape(-1, 2)
    pair = BoundaryElements(both, LABORATORY)
    # The same inner points above and below, so that the two systems of equations are the same.
    inner = BoundaryElements(upper, LABORATORY, floor)._inner_points
    pair.__dict__["_inner_points"] = np.vstack([inner[:12], inner[12:], floor.mirror(inner[12:])])
    pair._inner_count = lambda wavenumber: 2 * len(inner[12:])  # type: ignore[method-assign]
    one = BoundaryElements(upper, LABORATORY, floor)
    one._inner_count = lambda wavenumber: len(inner[12:])  # type: ignore[method-assign]
    single, whole = one.solve(700.0, velocity), pair.solve(700.0, np.vstack([velocity, mirrored]))
    assert single.pressure == pytest.approx(
        whole.pressure[: len(flipped)], rel=1e-6, abs=1e-6 * np.abs(single.pressure).max()
    )
    assert single.resistance == pytest.approx(0.5 * whole.resistance, rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("ka", [0.25, 0.5, 1.0, 2.0, 5.0])
def test_piston_in_a_baffle(piston, ka):
    """L. L. Beranek, Acoustics, eq. 5.10: R = 1 - J1(2ka)/ka, X = H1(2ka)/ka, in units of rho c pi a²."""
    baffle = HardPlane(np.zeros(3), np.array([0.0, 0.0, 1.0]))
    field = at_wavenumber(BoundaryElements(piston, UNIT, baffle), ka, np.ones(3 * len(piston.triangles)))
    impedance = np.einsum("e,ea->", piston.areas / 3.0, field.pressure[piston.triangles][..., 0]) / piston.area
    exact = 1.0 - j1(2.0 * ka) / ka
    assert field.resistance[0, 0] / piston.area == pytest.approx(exact, rel=2e-3)
    assert impedance.real == pytest.approx(exact, rel=2e-3)
    assert impedance.imag == pytest.approx(struve(1, 2.0 * ka) / ka, rel=2e-3)


@pytest.fixture(scope="module")
def piston() -> RadiatingSurface:
    return disc(1.0, 26)


def plate_efficiency(m: int, n: int, length: float, width: float, k: float) -> float:
    """Simply supported plate mode by Gauss quadrature of its directivity over the half sphere."""
    theta, weight = np.polynomial.legendre.leggauss(80)
    theta, weight = 0.25 * np.pi * (theta + 1.0), 0.25 * np.pi * weight
    phi = 2.0 * np.pi * np.arange(160) / 160
    sine = np.sin(theta)[:, None]

    def moment(order, side, wavenumber):
        x, w = np.polynomial.legendre.leggauss(60)
        x, w = 0.5 * side * (x + 1.0), 0.5 * side * w
        return np.tensordot(np.exp(1j * wavenumber[..., None] * x), w * np.sin(order * np.pi * x / side), axes=1)

    far = moment(m, length, k * sine * np.cos(phi)) * moment(n, width, k * sine * np.sin(phi))
    power = (np.abs(far) ** 2 * sine * weight[:, None]).sum() * 2.0 * np.pi / 160 * k**2 / (8.0 * np.pi**2)
    return float(power / (0.5 * length * width / 4.0))


@pytest.mark.slow
@pytest.mark.parametrize("k", [1.0, 4.0, 9.0])
def test_simply_supported_plate(k):
    modes = [(1, 1), (1, 2), (2, 2), (1, 3), (3, 3)]
    length, width = 1.0, 0.8
    plate = rectangle(length, width, 30, 24)

    def shape(points, normals):
        x, y = points[:, 0], points[:, 1]
        return np.column_stack([np.sin(m * np.pi * x / length) * np.sin(n * np.pi * y / width) for m, n in modes])

    baffle = HardPlane(np.zeros(3), np.array([0.0, 0.0, 1.0]))
    field = at_wavenumber(BoundaryElements(plate, UNIT, baffle), k, at_corners(plate, shape))
    found = np.diag(field.resistance) / np.diag(field.velocity_products).real
    assert found == pytest.approx([plate_efficiency(*mode, length, width, k) for mode in modes], rel=5e-3)


@settings(max_examples=5)
@given(
    st.floats(0.2, 3.0),
    st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(0.2, 1)).map(np.array),
    st.floats(0.1, 3.0),
)
def test_power_does_not_change_with_rotation_and_scales_with_area(scale, axis, angle):
    surface = box((0.9, 1.0, 1.3), 0.3)
    generator = np.random.default_rng(5)
    velocity = generator.normal(size=(3 * len(surface.triangles), 2))
    direct = at_wavenumber(BoundaryElements(surface, UNIT), 1.7, velocity).resistance
    unit = axis / np.linalg.norm(axis)
    cross = np.cross(np.eye(3), unit)
    rotation = np.eye(3) - np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    moved = RadiatingSurface(scale * surface.points @ rotation.T + 2.0, surface.triangles)
    turned = at_wavenumber(BoundaryElements(moved, UNIT), 1.7 / scale, velocity).resistance
    assert turned / scale**2 == pytest.approx(direct, rel=2e-3, abs=2e-3 * np.abs(direct).max())


def test_refuses_what_it_cannot_solve():
    whole = box((0.3, 0.3, 0.3), 0.1)
    with pytest.raises(HousingError, match=r"not closed: .* open edges, the first at"):
        BoundaryElements(RadiatingSurface(whole.points, whole.triangles[1:]))
    with pytest.raises(HousingError, match="point inward"):
        BoundaryElements(RadiatingSurface(whole.points, whole.triangles[:, ::-1]))
    elements = BoundaryElements(whole)
    with pytest.raises(HousingError, match=r"too large for 3000 Hz: .* six need edges of 19\.1 mm"):
        elements.solve(3000.0, np.ones(3 * len(whole.triangles)))
    field = elements.solve(300.0, np.ones(3 * len(whole.triangles)))
    with pytest.raises(HousingError, match=r"\(50, 0, 0\) mm is inside"):
        field.pressure_at(np.array([[1.0, 0, 0], [0.05, 0.0, 0.0]]))
    with pytest.raises(HousingError, match="150 mm behind the hard plane"):
        BoundaryElements(whole, plane=HardPlane(np.zeros(3), np.array([0.0, 1.0, 0.0])))
