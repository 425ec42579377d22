"""Whirl at speed against the finite-element reference: every eigenvalue, for bearings of all kinds.

Rotors are drawn around Friswell's (two discs on a shaft between bearings); bearings have direct and cross terms of
stiffness and damping, tilting terms, and stand on the ground or on pedestals. The reference's own error in these
eigenvalues is 1e-12, by refining it and by closed form (below).
"""

import math

import numpy as np
import numpy.typing as npt
import pytest
from finite_element_whirl import spatial_matrices
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from gearwhine.rotors import Bearing, Disc, Pedestal, Rotor, Segment, ShaftMaterial, solve_whirl

CLOSE = 1e-10
COUNT = 8
# No shrinking: a case that fails is short as drawn.
SOME = settings(
    max_examples=12, deadline=None, suppress_health_check=list(HealthCheck), phases=[Phase.explicit, Phase.generate]
)
STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
SPRING = ShaftMaterial(211e9, 81.2e9, 0.0)


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda value: float(f"{value:.3g}"))


@st.composite
def friswell_like(draw: st.DrawFn) -> Rotor:
    spans = [Segment(draw(numbers(0.1, 0.6)), draw(numbers(0.03, 0.09)), 0.0, STEEL) for _ in range(4)]
    joints = np.cumsum([span.length for span in spans]).tolist()
    discs = [
        Disc.from_dimensions(at, draw(numbers(0.02, 0.1)), draw(numbers(0.1, 0.4)), 0.03, 7810.0) for at in joints[:3:2]
    ]
    return Rotor("drawn", spans, [*discs, Disc(joints[-1], draw(numbers(1.0, 20.0)), draw(numbers(0.0, 0.2)), 0.1)])


@st.composite
def bearing_sets(draw: st.DrawFn, rotor: Rotor, kind: str) -> list[Bearing]:
    bearings = []
    # Where shapes are not alike at both, and never at an end alone.
    for name, at in (("left", 0.0), ("right", float(rotor.joints[3]))):
        stiffness = np.diag([draw(numbers(2e5, 5e7)), draw(numbers(2e5, 5e7))])
        damping = np.zeros((2, 2))
        if kind != "undamped":
            damping = np.diag([draw(numbers(0.0, 3e3)), draw(numbers(0.0, 3e3))])
            stiffness = stiffness + np.array([[0.0, draw(numbers(-1e5, 1e5))], [draw(numbers(-1e5, 1e5)), 0.0]])
            damping = damping + draw(numbers(-200.0, 200.0)) * np.array([[0.0, 1.0], [1.0, 0.0]])
        pedestal = None
        if kind == "pedestals":
            pedestal = Pedestal(
                np.diag([draw(numbers(1e6, 1e8)), draw(numbers(1e6, 1e8))]),
                draw(numbers(0.0, 1e3)) * np.eye(2),
                draw(numbers(0.5, 50.0)),
            )
        if kind == "tilting":
            stiffness, damping = (_spatial(matrix) for matrix in (stiffness, damping))
            stiffness[3, 3], stiffness[4, 4] = draw(numbers(1e3, 1e5)), draw(numbers(1e3, 1e5))
            stiffness[0, 4] = stiffness[4, 0] = draw(numbers(-5e3, 5e3))
            stiffness[1, 3] = stiffness[3, 1] = draw(numbers(-5e3, 5e3))
            damping[3, 3] = damping[4, 4] = draw(numbers(0.0, 20.0))
        if kind == "thrust":
            # As of a loaded ball bearing: radial, axial and tilting all coupled, positive definite.
            stiffness, damping = (_spatial(matrix) for matrix in (stiffness, damping))
            lever = np.eye(5)
            lever[2, 0], lever[0, 4], lever[2, 4], lever[1, 3] = (draw(numbers(0.02, 0.2)) for _ in range(4))
            stiffness = stiffness + lever.T @ np.diag([0.0, 0.0, draw(numbers(1e5, 1e7)), 2e4, 2e4]) @ lever
        bearings.append(Bearing(name, at, stiffness, damping, pedestal=pedestal))
    return bearings


def _spatial(radial: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    whole = np.zeros((5, 5))
    whole[:2, :2] = radial
    return whole


def assert_same(found: npt.NDArray[np.complex128], reference: npt.NDArray[np.complex128]) -> None:
    """Assert that ours are the lowest of the reference's, each once, to `CLOSE` of its size."""
    distance = np.abs(found[:, None] - reference) / np.abs(reference)
    rows, columns = linear_sum_assignment(distance)
    assert distance[rows, columns].max() < CLOSE, f"{found} against {reference[: found.size + 2]}"
    lower = np.abs(reference) < np.abs(found[-1]) * (1.0 - 10.0 * CLOSE)
    assert set(np.flatnonzero(lower)) <= set(columns), f"{found} leave out some of {reference[lower]}"


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["undamped", "crossed", "tilting", "thrust", "pedestals"])
def test_every_eigenvalue_at_speed(kind: str) -> None:
    @SOME
    @given(st.data(), numbers(-1500.0, 1500.0))
    def holds(data: st.DataObject, speed: float) -> None:
        rotor = data.draw(friswell_like())
        bearings = data.draw(bearing_sets(rotor, kind))
        found = solve_whirl(rotor, bearings, speed, count=COUNT).eigenvalues
        assert found.size == COUNT
        matrices = spatial_matrices(rotor, bearings, 1.5 * float(np.abs(found).max()), axial=kind == "thrust")
        reference = matrices.eigenvalues(speed)
        assert_same(found, reference)

    holds()


@pytest.mark.parametrize("speed", [300.0, -2000.0])
def test_the_reference_whirls_as_a_disc_on_a_massless_shaft_does(speed: float) -> None:
    # With b = k + c λ of either bearing at a distance a, f and g the shaft's compliance to a force and of a half to its
    # tip's: m λ² (1/2b + f) + 1 = 0 cylindrical, (I_t λ² ± i I_p Ω λ)(1/b + g) + 2 a² = 0 conical, times b.
    mass, polar, diametral, half = 30.0, 0.5, 0.8, 0.25
    part = Segment(half, 0.05, 0.0, SPRING)
    rotor = Rotor("Jeffcott", [part] * 2, [Disc(half, mass, polar, diametral)])
    bearings = [Bearing.isotropic(str(at), at, 4e6, 2e3) for at in (0.0, 2 * half)]
    section, bearing = part.section(0.0), np.poly1d([2e3, 4e6])
    tip = half**3 / (3.0 * section.bending_stiffness) + half / section.shear_stiffness
    roots = [*(np.poly1d([mass, 0.0, 0.0]) * (1.0 + tip * bearing) + 2.0 * bearing).roots] * 2
    for sign in (1, -1):
        tilt = np.poly1d([diametral, sign * 1j * polar * speed, 0.0])
        roots += [*(tilt * (1.0 + tip * bearing) + 2.0 * half**2 * bearing).roots]
    # Those that oscillate; the reference has further ones, overdamped or of rounding's inertia.
    expected = np.array([root for root in roots if root.imag > 0.05 * abs(root)])
    found = spatial_matrices(rotor, bearings, 1e3).eigenvalues(speed)[: expected.size]
    np.testing.assert_allclose(found, expected[np.argsort(np.abs(expected))], rtol=1e-11)


def test_the_reference_holds_tilting_and_pedestals_in_closed_form() -> None:
    # One bearing under a disc, whose massless shaft carries nothing: each direction alone. With the pedestal below two
    # masses in a row, [k − mω², −k; −k, k + k_p − m_pω²]; the tilting terms about x and y each I_t ω² = k_φ, at rest.
    mass, diametral, k, tilt_x, tilt_y, foot, foot_mass = 20.0, 0.4, 3e6, 5e4, 8e4, 7e6, 4.0
    rotor = Rotor("disc", [Segment(0.1, 0.2, 0.0, SPRING)] * 2, [Disc(0.1, mass, 0.6, diametral)])
    bearing = Bearing(
        "middle",
        0.1,
        np.diag([k, k, 0.0, tilt_x, tilt_y]),
        np.zeros((5, 5)),
        pedestal=Pedestal(foot * np.eye(2), np.zeros((2, 2)), foot_mass),
    )
    pair = np.array([[k / mass, -k / math.sqrt(mass * foot_mass)], [0.0, (k + foot) / foot_mass]])
    pair[1, 0] = pair[0, 1]
    squared = [*np.linalg.eigvalsh(pair)] * 2 + [tilt_x / diametral, tilt_y / diametral]
    found = spatial_matrices(rotor, [bearing], 1e3).eigenvalues(0.0)[:6]
    np.testing.assert_allclose(found.imag, np.sort(np.sqrt(squared)), rtol=1e-11)
    # A tilt-displacement term turns slope in x, which is rotation about +y, and minus that in y, the right way.
    crossed = bearing.stiffness.copy()
    crossed[0, 4] = crossed[4, 0] = 1e5
    held = Bearing("middle", 0.1, crossed, np.zeros((5, 5)))
    plane = np.array([[k, 1e5], [1e5, tilt_y]]) / np.sqrt(np.outer([mass, diametral], [mass, diametral]))
    squared = [*np.linalg.eigvalsh(plane), k / mass, tilt_x / diametral]
    found = spatial_matrices(rotor, [held], 1e3).eigenvalues(0.0)[:4]
    np.testing.assert_allclose(found.imag, np.sort(np.sqrt(squared)), rtol=1e-11)


def test_the_reference_is_converged() -> None:
    rotor = Rotor("s", [Segment(0.4, 0.05, 0.0, STEEL)] * 3, [Disc.from_dimensions(0.4, 0.07, 0.28, 0.05, 7810.0)])
    crossed = np.array([[1e6, 2e5], [-1e5, 8e5]])
    bearings = [Bearing("left", 0.0, crossed, 1e3 * np.eye(2)), Bearing("right", 1.2, crossed.T, 1e2 * np.eye(2))]
    coarse, fine = (
        spatial_matrices(rotor, bearings, 5e3, degree=degree, reach=reach).eigenvalues(400.0)[:COUNT]
        for degree, reach in ((8, 2.0), (10, 1.0))
    )
    np.testing.assert_allclose(coarse, fine, rtol=3e-12)
