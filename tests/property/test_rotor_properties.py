"""What must hold for any rotor: the shapes, the symmetries, the static response and the scaling of its modes.

Frequencies against an independent model are in `test_no_missed_roots` and `test_whirl_reference`.
"""

import itertools
import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.polynomial import legendre

from gearwhine.rotors import (
    Disc,
    RadialSupport,
    Rotor,
    Segment,
    ShaftMaterial,
    solve_lateral_modes,
)

STEEL = ShaftMaterial(207e9, 79.6e9, 7850.0)
BRASS = ShaftMaterial(100e9, 37e9, 8500.0)
FEW = settings(max_examples=8, deadline=None, suppress_health_check=[HealthCheck.too_slow])


def reals(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda value: round(value, 4))


PLACES = st.integers(0, 24).map(lambda k: k / 24)


@st.composite
def random_segments(draw: st.DrawFn) -> list[Segment]:
    segments = []
    for _ in range(draw(st.integers(1, 4))):
        outer = draw(reals(0.02, 0.15))
        bore = outer * draw(st.sampled_from([0.0, 0.5, 0.9]))
        material = draw(st.sampled_from([STEEL, BRASS]))
        segments.append(Segment(draw(reals(0.05, 0.6)), outer, bore, material))
    return segments


@st.composite
def random_discs(draw: st.DrawFn, length: float) -> Disc:
    """Disc of any body: its polar moment of inertia is at most twice the diametral one, as of a thin disc."""
    diametral = draw(reals(0.0, 0.2))
    polar = 2.0 * diametral * draw(reals(0.0, 1.0))
    return Disc(length * draw(PLACES), draw(reals(0.1, 30.0)), polar, diametral)


@st.composite
def random_rotors(draw: st.DrawFn) -> Rotor:
    segments = draw(random_segments())
    length = math.fsum(segment.length for segment in segments)
    discs = [draw(random_discs(length)) for _ in range(draw(st.integers(0, 3)))]
    return Rotor("random", segments, discs)


@st.composite
def random_supports(draw: st.DrawFn, rotor: Rotor) -> list[RadialSupport]:
    stiffness = st.one_of(st.just(math.inf), reals(4.0, 10.0).map(lambda power: 10.0**power))
    return [RadialSupport(rotor.length * draw(PLACES), draw(stiffness)) for _ in range(draw(st.integers(0, 3)))]


def supported_rotors() -> st.SearchStrategy[tuple[Rotor, list[RadialSupport]]]:
    return random_rotors().flatmap(lambda rotor: st.tuples(st.just(rotor), random_supports(rotor)))


@FEW
@given(supported_rotors())
def test_shapes_are_orthonormal_and_continue_between_stations(case: tuple[Rotor, list[RadialSupport]]) -> None:
    rotor, supports = case
    modes = solve_lateral_modes(rotor, supports, count=8)
    # Integrated here span by span with another rule, in SI, against the definition of the modal mass.
    gauss, weight = legendre.leggauss(40)
    mass = np.zeros((modes.count, modes.count))
    for left, right in zip(modes.stations[:-1], modes.stations[1:], strict=True):
        z = (left + right) / 2 + (right - left) / 2 * gauss
        index = min(int(np.searchsorted(rotor.joints, (left + right) / 2)) - 1, len(rotor.segments) - 1)
        part = rotor.segments[index].section(0.5)
        x, b = modes.evaluate(z)
        density = part.material.density * weight * (right - left) / 2
        mass += (x * density * part.area) @ x.T + (b * density * part.second_moment) @ b.T
    for disc in rotor.discs:
        x, b = modes.evaluate([disc.at])
        mass += disc.mass * x @ x.T + disc.diametral_inertia * b @ b.T
    np.testing.assert_allclose(mass, np.eye(modes.count), atol=1e-9)
    x, b = modes.evaluate(modes.stations)
    np.testing.assert_allclose(x, modes.displacement, atol=1e-9 * np.abs(x).max())
    np.testing.assert_allclose(b, modes.slope, atol=1e-9 * np.abs(b).max())
    assert np.linalg.eigvalsh(modes.polar_inertia_matrix).min() > -1e-9


def test_lumping_converges_to_the_distributed_shaft() -> None:
    pins = [RadialSupport(0.0, math.inf), RadialSupport(1.0, math.inf)]
    exact = solve_lateral_modes(Rotor("d", [Segment(1.0, 0.05, 0.0, STEEL)]), pins, count=2).frequencies
    errors = []
    for pieces in (8, 16, 32):
        lumped = Rotor("l", [Segment(1.0 / pieces, 0.05, 0.0, STEEL)] * pieces, mass_model="lumped")
        errors.append(np.abs(solve_lateral_modes(lumped, pins, count=2).frequencies / exact - 1.0))
    # Second order in the length of the segments.
    for coarse, fine in itertools.pairwise(errors):
        np.testing.assert_allclose(coarse / fine, 4.0, rtol=0.1)
    assert errors[-1] == pytest.approx(0.0, abs=1e-2)
