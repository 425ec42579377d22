"""Boundary elements in the span of solutions at a few frequencies: against closed forms and all equations."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import spherical_jn, spherical_yn

from gearwhine.housing.acoustics import reduced_elements
from gearwhine.housing.acoustics.boundary_elements import BoundaryElements
from gearwhine.housing.acoustics.medium import AIR, HardPlane, Medium
from gearwhine.housing.acoustics.radiation import HousingRadiation
from gearwhine.housing.acoustics.reduced_elements import SpanningSolutions, spanning_frequencies
from tests.housing.acoustics.surfaces import at_corners, box, sphere

UNIT = Medium(density=1.0, speed_of_sound=1.0)  # k = ω
BETWEEN = (0.02, 0.6)  # [Hz]: ka up to 3.8
FLOOR = HardPlane(np.array([0.0, -0.17, 0.0]), np.array([0.0, 1.0, 0.0]))  # 20 mm below the box


def harmonics(points, normals):
    """Spherical harmonics 0 to 3 of the height z."""
    cosine = points[:, 2] / np.linalg.norm(points, axis=1)
    return np.stack([np.polynomial.legendre.Legendre.basis(n)(cosine) for n in range(4)], axis=1)


def bending(points, normals):
    """Shapes as those of a box's modes: products of cosines along its sides, times a number for each face."""
    generator = np.random.default_rng(3)
    shapes = []
    for _ in range(16):
        waves, phases = generator.integers(0, 4, 3), generator.uniform(0.0, np.pi, 3)
        along = np.prod(np.cos(np.pi * waves * points / (0.4, 0.3, 0.2) + phases), axis=1)
        shapes.append(along * (normals @ generator.normal(size=3)))
    return np.stack(shapes, axis=1)


def radiation_of(elements: BoundaryElements, field) -> HousingRadiation:
    modal = np.ascontiguousarray(at_corners(elements.surface, field).real)
    return HousingRadiation("boundary-elements", (elements,), (modal,), ("face",) * len(elements.surface.triangles), ())


@pytest.fixture(scope="module")
def ball() -> HousingRadiation:
    radiation = radiation_of(BoundaryElements(sphere(7), UNIT), harmonics)
    return radiation.spanned(np.linspace(*BETWEEN, 20), BETWEEN)


@pytest.fixture(scope="module")
def standing() -> HousingRadiation:
    """A box over a floor, with a gap in which air resonates."""
    elements = BoundaryElements(box((0.4, 0.3, 0.2), 0.025), AIR, FLOOR)
    return radiation_of(elements, bending).spanned(np.linspace(100.0, 2000.0, 20), (20.0, 2000.0))


@pytest.mark.parametrize("hertz", [0.05, 0.17, 0.31, 0.44, 0.58])
def test_harmonics_of_a_sphere_radiate_as_their_closed_form(ball: HousingRadiation, hertz: float) -> None:
    """A pulsating, an oscillating and two higher spheres: W = ½ ρ c |v|² Re(i h/h') 4π a² / (2 n + 1)."""
    k = 2.0 * np.pi * hertz
    assert ball.reduced is not None
    assert ball.reduced.solve(hertz, np.eye(4)) is not None
    powers = ball.solve(hertz, np.eye(4)).power_alone
    for n, power in enumerate(powers):
        outgoing, slope = (
            spherical_jn(n, k, derivative=derived) - 1j * spherical_yn(n, k, derivative=derived)
            for derived in (False, True)
        )
        exact = 0.5 * 4.0 * np.pi / (2 * n + 1) * (-1j * outgoing / slope).real
        assert power == pytest.approx(exact, rel=0.03), n


def test_pressure_and_power_are_those_of_all_equations(standing: HousingRadiation) -> None:
    """At random frequencies, each proved by equations that had no part in the solution."""
    generator, alone = np.random.default_rng(8), replace(standing, reduced=None)
    reduced = standing.reduced
    assert reduced is not None
    frequencies = generator.uniform(60.0, 1980.0, 8)
    assert not np.isin(frequencies, reduced.solutions.frequencies).any()
    for hertz in frequencies.tolist():
        rates = generator.normal(size=(16, 3)) + 1j * generator.normal(size=(16, 3))
        field, exact = reduced.solve(hertz, rates), alone.solve(hertz, rates)
        assert field is not None
        whole = exact.fields[0].pressure
        misfit = np.linalg.norm(field.pressure - whole, axis=0) / np.linalg.norm(whole, axis=0)
        assert misfit.max() < 3.0 * reduced_elements.LARGEST_MISFIT
        sound = standing.solve(hertz, rates)
        for power, other in ((sound.power, exact.power), (sound.surface_power, exact.surface_power)):
            assert 10.0 * np.log10(power / other) == pytest.approx(0.0, abs=0.05)
        assert sound.interior_residual == pytest.approx(exact.interior_residual, abs=5e-3)
        # Known sources are solved in the span, too: what that lacks shows as a larger error of theirs.
        assert -0.02 < sound.source_error.largest - exact.source_error.largest < 0.15


def test_at_its_frequencies_the_span_has_the_solutions_themselves(standing: HousingRadiation) -> None:
    assert standing.reduced is not None
    hertz = float(standing.reduced.solutions.frequencies[2])
    rates = np.arange(16.0)[:, None] + 1j
    exact = replace(standing, reduced=None).solve(hertz, rates)
    found = standing.solve(hertz, rates)
    assert found.fields[0].pressure == pytest.approx(exact.fields[0].pressure, rel=1e-4)
    assert found.power == pytest.approx(exact.power, rel=1e-5)
    assert found.source_error.largest == pytest.approx(exact.source_error.largest, rel=1e-4)


def test_what_other_equations_do_not_prove_is_solved_by_all(standing: HousingRadiation, monkeypatch) -> None:
    """So is what lies outside the frequencies of the span."""
    rates, alone = np.eye(16)[:, :2], replace(standing, reduced=None)
    assert standing.reduced is not None
    assert standing.reduced.solve(19.0, rates) is None
    assert standing.reduced.solve(2001.0, rates) is None
    monkeypatch.setattr(reduced_elements, "LARGEST_MISFIT", 1e-9)
    assert standing.reduced.solve(760.0, rates) is None
    assert standing.solve(760.0, rates).power == alone.solve(760.0, rates).power


def test_a_motion_that_no_solution_has_is_no_part_of_the_span(standing: HousingRadiation) -> None:
    """A small patch of a wall that moves alone."""
    reduced = standing.reduced
    assert reduced is not None
    patch = np.zeros((len(reduced.modal), 16))
    patch[:3, 0] = 1.0
    strange = replace(reduced, modal=patch)
    assert strange.solve(760.0, np.eye(16)[:, :1]) is None


def test_arrays_hold_the_solutions_bit_for_bit(standing: HousingRadiation) -> None:
    assert standing.reduced is not None
    given = standing.reduced.solutions
    again = SpanningSolutions.of_arrays(given.arrays())
    np.testing.assert_array_equal(again.frequencies, given.frequencies)
    np.testing.assert_array_equal(again.pressure, given.pressure)
    radiation = replace(standing, reduced=None)
    kept = radiation.spanned([300.0, 1200.0], (20.0, 2000.0), known=again)
    assert kept.reduced is not None
    assert kept.reduced.solutions is again
    fewer = replace(radiation, modal=(radiation.modal[0][:, :9],))
    assert fewer.spanned([300.0, 1200.0], (20.0, 2000.0), known=again) is fewer  # of other modes
    assert radiation.spanned([300.0, 2100.0], (20.0, 2000.0), known=again) is radiation  # few, and one beyond


def test_frequencies_of_a_span_lie_closer_at_short_waves(standing: HousingRadiation) -> None:
    (elements,) = standing.elements
    wanted = np.linspace(100.0, 2000.0, 200)
    chosen = spanning_frequencies(wanted, (20.0, 2000.0), elements, 16)
    assert chosen is not None
    assert (chosen[0], chosen[-1]) == (20.0, 2000.0)
    assert np.isin(chosen[1:-1], wanted).all()
    steps = np.diff(chosen)
    assert steps[-1] < steps[0]
    # Largest extent 0.4 m: waves of 0.17 m.
    assert 2.0 * np.pi * 2000.0 / AIR.speed_of_sound * 0.4 / (len(chosen) - 1) < 5.3
    assert spanning_frequencies(wanted[:5], (20.0, 2000.0), elements, 16) is None
    assert spanning_frequencies(wanted, (20.0, 2000.0), elements, 80) is None  # 834 vertices


def test_other_methods_have_nothing_to_span(standing: HousingRadiation) -> None:
    estimate = replace(standing, method="erp", reduced=None)
    assert estimate.spanned(np.linspace(100.0, 2000.0, 20), (20.0, 2000.0)) is estimate


def test_solutions_that_depend_on_others_widen_no_span() -> None:
    """Three harmonics, and mixtures of them with rounding of single precision, one of them zero: a span of three."""
    surface = sphere(7)
    first = harmonics(surface.points, surface.points).astype(np.complex64)
    mixed = np.stack([first[:, 0] + 2j * first[:, 1], first[:, 2] - first[:, 1], 0.0 * first[:, 0]], axis=1)
    basis = reduced_elements._basis(surface, np.array([first[:, :3], mixed]).astype(np.complex64))
    found = np.linalg.lstsq(basis.columns, first[:, :3], rcond=None)[0]
    np.testing.assert_allclose(basis.columns @ found, first[:, :3], atol=1e-5)
    assert basis.columns.shape[1] == 3
