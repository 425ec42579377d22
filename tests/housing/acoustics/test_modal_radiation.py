"""Radiation of modes over frequency: interpolated power and pressure against solutions, and against a sphere's."""

from dataclasses import fields, replace

import numpy as np
import pytest
from scipy.special import spherical_jn, spherical_yn

from gearwhine.housing.acoustics.boundary_elements import BoundaryElements
from gearwhine.housing.acoustics.medium import Medium
from gearwhine.housing.acoustics.modal_radiation import ARRAYS, ModalRadiation
from gearwhine.housing.acoustics.radiation import HousingRadiation
from gearwhine.housing.errors import HousingError
from tests.housing.acoustics.surfaces import at_corners, sphere

UNIT = Medium(density=1.0, speed_of_sound=1.0)  # k = ω
PLACES = np.array([[3.0, 0.0, 0.0], [0.0, 1.0, 4.0]])
LOWEST, HIGHEST = 0.02, 0.45  # [Hz]: ka up to 2.8


def harmonics(points, normals):
    """Spherical harmonics 0 to 2 of the height z."""
    cosine = points[:, 2] / np.linalg.norm(points, axis=1)
    return np.stack([np.polynomial.legendre.Legendre.basis(n)(cosine) for n in range(3)], axis=1)


@pytest.fixture(scope="module")
def radiation() -> HousingRadiation:
    surface = sphere(4)
    modal = np.ascontiguousarray(at_corners(surface, harmonics).real)
    labels = ("sphere",) * len(surface.triangles)
    return HousingRadiation("boundary-elements", (BoundaryElements(surface, UNIT),), (modal,), labels, ())


@pytest.fixture(scope="module")
def table(radiation: HousingRadiation) -> ModalRadiation:
    return ModalRadiation.solve(radiation, PLACES, LOWEST, HIGHEST, points=17)


@pytest.mark.parametrize("part", [0.11, 0.33, 0.52, 0.7, 0.98])
def test_power_and_pressure_between_the_frequencies_are_those_of_a_solution(radiation, table, part):
    hertz = LOWEST + part * (HIGHEST - LOWEST)
    rates = np.array([1.0 + 0.5j, -2.0j, 0.7])
    solved = radiation.solve(hertz, rates)
    power, surface, error = table.power(hertz, rates)
    # The number of points inside, which grows with the frequency by steps, moves a solution on so few triangles, too.
    assert power == pytest.approx(solved.power, rel=max(error, 3e-4))
    assert surface == pytest.approx(solved.surface_power, rel=max(error, 3e-4))
    assert error < 0.02
    heard = table.pressure_at(np.array([hertz]))[0] @ rates
    exact = solved.pressure_at(PLACES)
    size = np.abs(table.pressure_at(np.array([hertz]))[0]).max(axis=1)
    assert np.all(np.abs(heard - exact) <= 3.0 * table.pressure_error * size)
    assert table.pressure_error < 1e-3


def test_parts_of_modes_have_the_power_that_they_exchange(radiation, table):
    """Sums of harmonics, whose fields act on each other."""
    mix = np.array([[1.0, 1.0, 0.0], [0.0, 1.0, 1.0], [0.5, 0.0, 1.0]])
    matrices = ("resistance", "surface_resistance", "surface_reactance")
    mixed = replace(table, **{name: mix.T @ getattr(table, name) @ mix for name in matrices})
    hertz, rates = 0.2, np.array([1.0 + 0.5j, -2.0j, 0.7])
    solved = replace(radiation, modal=(radiation.modal[0] @ mix,)).solve(hertz, rates)
    parts = mixed.by_mode(hertz, rates)
    assert parts.sum() == pytest.approx(mixed.power(hertz, rates)[1], rel=1e-9)
    assert parts == pytest.approx(solved.by_mode, abs=2e-3 * solved.surface_power)
    alone = replace(mixed, surface_reactance=np.zeros_like(mixed.surface_reactance)).by_mode(hertz, rates)
    assert np.abs(parts - alone).max() > 0.1 * solved.surface_power


def test_breathing_sphere(table):
    """Pressure of a pulsating sphere, p = ρ c v (a / r) i k a / (1 + i k a) exp(−i k (r − a))."""
    hertz = 0.2
    k = 2.0 * np.pi * hertz
    outgoing = spherical_jn(0, k) - 1j * spherical_yn(0, k)
    derivative = spherical_jn(0, k, derivative=True) - 1j * spherical_yn(0, k, derivative=True)
    power, _, error = table.power(hertz, np.array([2.0, 0.0, 0.0]))
    assert error < 1e-2
    assert power == pytest.approx(0.5 * 2.0**2 * 4.0 * np.pi * (-1j * outgoing / derivative).real, rel=0.02)
    distance = np.linalg.norm(PLACES, axis=1)
    exact = 1j * k / (1.0 + 1j * k) / distance * np.exp(-1j * k * (distance - 1.0))
    heard = table.pressure_at(np.array([hertz]))[0, :, 0]
    np.testing.assert_allclose(heard, exact, rtol=0.02)


def test_a_weak_radiator_has_a_large_estimate(table):
    """The second harmonic radiates with the sixth power of frequency: near the lowest no cubic follows it."""
    *_, weak = table.power(0.026, np.array([0.0, 0.0, 1.0]))
    *_, strong = table.power(0.3, np.array([0.0, 0.0, 1.0]))
    assert weak > 0.5
    assert strong < 0.01


def test_arrays_hold_the_table_bit_for_bit(table):
    nowhere = {"pressure": table.pressure[:, :0], "delays": table.delays[:0]}
    nowhere["point_source_error"] = table.point_source_error[:, :0]
    for given in (table, replace(table, **nowhere)):
        again = ModalRadiation.of_arrays(given.arrays())
        assert tuple(given.arrays()) == ARRAYS[: 10 if len(given.delays) else 7]
        for one in fields(ModalRadiation):
            np.testing.assert_array_equal(getattr(again, one.name), getattr(given, one.name))


def test_a_table_holds_the_error_of_known_sources_of_each_solution(radiation, table):
    rates = np.array([1.0, 0.0, 0.0])
    for place in (0, 8, 16):
        hertz = float(table.frequencies[place])
        solved = radiation.solve(hertz, rates)
        error = solved.source_error
        assert (table.source_error[place], table.source_rms[place]) == pytest.approx((error.largest, error.rms))
        assert table.point_source_error[place] == pytest.approx(solved.source_error_at(PLACES), rel=1e-6)
    falling = np.arange(len(table.frequencies), 0.0, -1.0)
    middle = 0.5 * (table.frequencies[3] + table.frequencies[4])
    assert (table.around(middle, falling), table.around(middle, falling[::-1])) == (falling[3], falling[::-1][4])
    assert (table.around(LOWEST, falling), table.around(HIGHEST, falling[::-1])) == (falling[0], falling[0])
    assert table.around(middle, np.zeros((len(falling), 0))) == 0.0  # without points
    # With the frequency on the same triangles: from the linear functions' own error to that of short waves.
    assert 0.0 < table.source_error[0] < 0.5 * table.source_error[-1] < 0.3
    assert 0.0 < table.point_source_error.max() < 0.05


def test_what_the_table_does_not_hold_is_refused(radiation, table):
    with pytest.raises(HousingError, match=r"radiation at 0.5 Hz; expected a frequency from 0.02 to 0.45 Hz"):
        table.power(0.5, np.zeros(3))
    with pytest.raises(HousingError, match=r"at 16 frequencies; expected an odd number from 5 on"):
        ModalRadiation.solve(radiation, PLACES, LOWEST, HIGHEST, points=16)
