"""The published rotors twice: under each source's own discretisation, to its printed digits, and converged.

A number printed for a coarse mesh proves little of an exact model. So the sources' own elements stand here too, built
in the finite-element reference of `tests/rotors`: what they printed comes out, which proves the model understood; the
same model with elements refined to 1e-12 is what the package must find.

- Friswell, Penny, Garvey & Lees, Dynamics of Rotating Machines (2010), examples 5.9.1 and 5.9.2: six two-node elements.
- RAPPID, after the ROSS validation notebook: seven lumped stations on a massless shaft.
- Friswell et al., example 9.7.1: a chain in torsion.
- Rao, Shiau & Chang (1998): two geared shafts, one two-node element per span.
"""

import math

import numpy as np
import numpy.typing as npt
import pytest
from finite_element_rotor import bending_model, condensed, rod_model
from finite_element_whirl import spatial_matrices
from scipy import linalg

from gearwhine.rotors import (
    Bearing,
    Disc,
    Rotor,
    Segment,
    ShaftMaterial,
    rest_frequencies,
    solve_lateral_modes,
    solve_torsional_modes,
    solve_whirl,
)
from gearwhine.rotors.modes.torsional_and_axial import solve_torsional_chain

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
DISCS = [Disc.from_dimensions(at, 0.07, diameter, 0.05, 7810.0) for at, diameter in ((0.5, 0.28), (1.0, 0.35))]
FRISWELL = Rotor("Friswell 5.9.1", [Segment(0.25, 0.05, 0.0, STEEL)] * 6, DISCS)
TURN = 2.0 * np.pi / 60.0
# A frequency so low that no span is cut.
UNCUT = 1.0


def at_ends(k_xx: float, k_yy: float) -> list[Bearing]:
    stiffness = np.diag([k_xx, k_yy])
    return [Bearing(name, z, stiffness, np.zeros((2, 2))) for name, z in (("left", 0.0), ("right", 1.5))]


@pytest.mark.parametrize(
    ("k_yy", "speed", "printed"),
    [
        # 716.786 by the source's own element, which it printed as 716.78: cut off, not rounded.
        (1e6, 0.0, [86.66, 86.66, 274.31, 274.31, 716.786]),
        (1e6, 4000.0, [85.39, 87.80, 251.78, 294.71, 600.18]),
        (8e5, 0.0, [82.65, 86.66, 254.52, 274.31]),
        (8e5, 4000.0, [82.33, 86.86, 239.64, 287.25, 583.49]),
    ],
)
def test_friswell_by_six_of_his_elements_and_converged(k_yy: float, speed: float, printed: list[float]) -> None:
    bearings, count = at_ends(1e6, k_yy), len(printed)
    source = spatial_matrices(FRISWELL, bearings, UNCUT, two_node=True).eigenvalues(speed * TURN).imag
    np.testing.assert_allclose(source[:count], printed, rtol=0.0, atol=0.00501)
    converged = spatial_matrices(FRISWELL, bearings, 2e3).eigenvalues(speed * TURN).imag
    # Elements err upward at rest: six of them by up to 3e-4 in the third pair.
    if speed == 0.0:
        assert (converged[:count] < source[:count]).all()
        found = rest_frequencies(FRISWELL, bearings, count=count).frequencies
        np.testing.assert_allclose(found[:count], converged[:count], rtol=1e-11)
    found = solve_whirl(FRISWELL, bearings, speed * TURN, count=count).damped_frequencies
    np.testing.assert_allclose(found, converged[:count], rtol=1e-11)


def test_friswell_torsion_is_converged() -> None:
    # Printed 650.41 for six elements.
    source = condensed(rod_model(FRISWELL, "torsion", UNCUT)).natural_frequencies(1e3)
    assert source[1] == pytest.approx(650.41, abs=0.00501)
    converged = rod_model(FRISWELL, "torsion", 1e4).natural_frequencies(1e4)
    assert converged[1] < source[1]
    found = solve_torsional_modes(FRISWELL, frequency_limit=1e4).frequencies
    np.testing.assert_allclose(found, converged, rtol=1e-11, atol=1e-6)


def test_rappid_lumped_and_converged() -> None:
    # The source's own model is the lumped one, with κ = 3/4; converged, the third pair is 8 % higher.
    printed = np.array([14.6152, 15.3284, 43.3459, 46.9251, 105.902, 112.760, 150.907, 155.810])
    steel = ShaftMaterial(211e9, 81.2e9, 3.83395 / (0.25 * np.pi / 4 * 0.05**2))
    discs = [Disc.from_dimensions(z, 0.07, 0.28, 0.05, 7810.0) for z in (0.5, 1.0)]
    bearings, speed = at_ends(1e6, 0.8e6), 500.0 * TURN
    for model, close in (("lumped", 3e-5), ("distributed", math.inf)):
        rotor = Rotor("RAPPID", [Segment(0.25, 0.05, 0.0, steel, 0.75)] * 6, discs, mass_model=model)  # type: ignore[arg-type]
        reference = spatial_matrices(rotor, bearings, 3e3).eigenvalues(speed).imag[:8]
        if math.isfinite(close):
            np.testing.assert_allclose(reference / (2.0 * np.pi), printed, rtol=close)
        else:
            assert (reference[4:6] / (2.0 * np.pi) / printed[4:6] > 1.07).all()
        found = solve_whirl(rotor, bearings, speed, count=8).damped_frequencies
        np.testing.assert_allclose(found, reference, rtol=1e-11)


def test_torsional_chain_by_its_matrices() -> None:
    # Example 9.7.1 has no discretisation: its five inertias' matrices are the whole model.
    inertias, springs = [3.5e-3, 3.5e-3, 3.5e-3, 0.15, 0.05], [12e3, 12e3, 14e3, 10e3]
    stiffness = np.zeros((5, 5))
    for place, spring in enumerate(springs):
        stiffness[place : place + 2, place : place + 2] += spring * np.array([[1.0, -1.0], [-1.0, 1.0]])
    exact = np.sqrt(np.maximum(linalg.eigh(stiffness, np.diag(inertias), eigvals_only=True), 0.0))
    np.testing.assert_allclose(exact[1:] / (2 * np.pi), [81.21, 141.21, 378.95, 536.36], rtol=0.0, atol=0.00501)
    np.testing.assert_allclose(solve_torsional_chain(inertias, springs).frequencies[1:], exact[1:], rtol=1e-11)


SPANS = ([(0.1, 0.3), (4.24, 0.3), (1.16, 0.22), (0.3, 0.22)], [(0.3, 0.15), (5.0, 0.15), (0.1, 0.15)])
TURBO_STEEL = ShaftMaterial(207e9, 79.5e9, 7800.0)
TURBO_DISCS = (
    [Disc(0.1, 525.7, 32.2, 16.1), Disc(4.34, 116.04, 6.23, 3.115), Disc(5.8, 726.4, 113.9, 56.95)],
    [Disc(0.0, 5.0, 0.004, 0.002), Disc(5.3, 7.45, 0.149, 0.0745)],
)
SHAFTS = [
    Rotor("turbo-generator", [Segment(length, diameter, 0.0, TURBO_STEEL) for length, diameter in spans], discs)
    for spans, discs in zip(SPANS, TURBO_DISCS, strict=True)
]
HELD = [
    [Bearing(str(at), at, np.diag(stiffness), 3e3 * np.eye(2)) for at in places]
    for places, stiffness in (((0.0, 5.5), (183.9e6, 200.4e6)), ((0.3, 5.4), (10.1e6, 41.6e6)))
]


def turbo_generator(highest: float, two_node: bool) -> npt.NDArray[np.complex128]:
    """Eigenvalues of both shafts in bending and torsion, tied by the teeth, by ascending imaginary part."""
    angle, speeds = np.radians(90.0 - 22.5), (1500.0 * TURN, -1500.0 * TURN * 328.0 / 23.0)
    masses, stiffnesses, dampings, direction = [], [], [], []
    for rotor, held, speed, at, radius, sign in zip(
        SHAFTS, HELD, speeds, (5.8, 0.0), (0.5086, 0.03567), (1.0, -1.0), strict=True
    ):
        bending = spatial_matrices(rotor, held, highest, two_node=two_node)
        plane = bending_model(rotor, [], highest, places=[bearing.at for bearing in held])
        twist = rod_model(rotor, "torsion", highest, springs=[(bearing.at, 0.0) for bearing in held])
        if two_node:
            plane, twist = condensed(plane), condensed(twist)
        masses += [bending.mass, twist.assembled("mass")]
        stiffnesses += [bending.stiffness, twist.assembled("stiffness")]
        dampings += [bending.damping + speed * bending.gyroscopic, np.zeros_like(masses[-1])]
        node, both = plane.elements.node(at), 2 * plane.held.size
        line = np.zeros(both + twist.held.size)
        line[[2 * node, both // 2 + 2 * node]] = sign * np.cos(angle), sign * np.sin(angle)
        line[both + twist.elements.node(at)] = radius
        direction.append(line)
    teeth = np.concatenate(direction)
    mass, stiffness, damping = (linalg.block_diag(*blocks) for blocks in (masses, stiffnesses, dampings))
    stiffness = stiffness + 1e8 * np.outer(teeth, teeth)
    # Modes at a shift below zero, for the train turns freely; as many as matter, far beyond those compared.
    shift = 100.0
    squared, shapes = linalg.eigh(stiffness + shift * mass, mass, subset_by_index=(0, min(120, len(mass)) - 1))
    gyroscopic = shapes.T @ damping @ shapes
    unit, nothing = np.eye(squared.size), np.zeros((squared.size, squared.size))
    values = linalg.eigvals(np.block([[nothing, unit], [np.diag(shift - squared), -gyroscopic]]))
    values = values[values.imag > 1.0]
    return np.asarray(values[np.argsort(values.imag)])


def test_turbo_generator_by_one_element_per_span() -> None:
    printed = [11.641, 12.284, 17.268, 18.458, 23.956, 37.681, 49.889, 50.861, 56.248, 57.752, 59.188, 63.113, 74.203]
    found = turbo_generator(UNCUT, two_node=True).imag[:13] / (2.0 * np.pi)
    np.testing.assert_allclose(found, printed, rtol=0.0, atol=0.000501)


def test_turbo_generator_converged() -> None:
    # The geared rotors' test holds the package to eight of ROSS's elements per span: these, to their own error.
    eight = [
        10.7504,
        11.3214,
        16.9663,
        18.0645,
        23.5118,
        34.999,
        43.137,
        48.635,
        53.651,
        55.842,
        56.539,
        60.503,
        73.125,
    ]
    found = turbo_generator(2e3, two_node=False).imag[:13] / (2.0 * np.pi)
    np.testing.assert_allclose(found, eight, rtol=5e-4)


@pytest.mark.parametrize("shaft", [0, 1])
def test_turbo_generator_shafts_alone(shaft: int) -> None:
    rotor, bearings = SHAFTS[shaft], HELD[shaft]
    for plane in (0, 1):
        supports = [bearing.plane_support(plane) for bearing in bearings]
        modes = solve_lateral_modes(rotor, supports, frequency_limit=3e3)
        converged = bending_model(rotor, supports, 3e3).natural_frequencies(3e3)
        np.testing.assert_allclose(modes.frequencies, converged, rtol=1e-11)
        # Rao's own mesh, one element per span, lies above.
        coarse = condensed(bending_model(rotor, supports, UNCUT)).natural_frequencies(3e3)
        assert (coarse >= converged[: coarse.size] * (1.0 - 1e-9)).all()
        assert (coarse[:3] > 1.005 * converged[:3]).any()
    twist = rod_model(rotor, "torsion", 3e4).natural_frequencies(3e4)
    found = solve_torsional_modes(rotor, frequency_limit=3e4).frequencies
    np.testing.assert_allclose(found, twist, rtol=1e-11, atol=1e-5)
    speed = 1500.0 * TURN
    eigenvalues = spatial_matrices(rotor, bearings, 3e3).eigenvalues(speed)[:8]
    np.testing.assert_allclose(solve_whirl(rotor, bearings, speed, count=8).eigenvalues, eigenvalues, rtol=1e-11)
