"""Rates of stiffness and mass against closed forms, assembled matrices and solved modes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import linalg

from gearwhine.housing import HousingError, Material, Support, assemble, attach_fixtures, solve_modes
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.material import element_constants
from gearwhine.housing.model.supports import fixed_freedoms
from gearwhine.housing.updating import ModelSensitivity, modal_sensitivities
from gearwhine.meshes import BoxGeometry, BoxMorph, Mesh
from gearwhine.numerics.arrays import FloatArray

STEP = 1e-4


@pytest.fixture(scope="module")
def constants(box: Mesh, steel: Material) -> FloatArray:
    return element_constants(box, steel, {})


@pytest.fixture(scope="module")
def shapes(box: Mesh) -> FloatArray:
    """Any fields will do where matrices are compared."""
    return np.random.default_rng(5).normal(size=(4, len(box.points), 3))


def test_rates_are_those_of_the_assembled_matrices(
    box: Mesh, geometry: BoxGeometry, steel: Material, constants: FloatArray, shapes: FloatArray
) -> None:
    """Richardson's extrapolation of central differences: curved elements at the bores, a wall, a boss, a foot."""
    other = replace(
        geometry,
        wall=replace(geometry.wall, top=0.021, left=0.019),
        bores=tuple(replace(bore, diameter=bore.diameter + 0.002) for bore in geometry.bores),
        feet=replace(geometry.feet, size=(0.042, 0.021, 0.05)) if geometry.feet else None,
    )
    velocity = BoxMorph(box, geometry).displacement(other)
    found = modal_sensitivities(box, constants, shapes, [ModelSensitivity(velocity=velocity)])
    flat = shapes.reshape(len(shapes), -1).T

    def difference(step: float) -> tuple[FloatArray, FloatArray]:
        either = [assemble(replace(box, points=box.points + way * velocity), steel) for way in (step, -step)]
        stiffness, mass = (
            [flat.T @ (getattr(matrices, name) @ flat) / (2.0 * step) for matrices in either]
            for name in ("stiffness", "mass")
        )
        return stiffness[0] - stiffness[1], mass[0] - mass[1]

    coarse, fine = difference(0.02), difference(0.01)
    for rate, one, two in zip((found.stiffness[0], found.mass[0]), coarse, fine, strict=True):
        expected = (4.0 * two - one) / 3.0
        assert np.abs(rate - expected).max() < 1e-6 * np.abs(expected).max()


def test_a_body_twice_as_large_sounds_an_octave_lower(box: Mesh, steel: Material, constants: FloatArray) -> None:
    """ω is as 1 / length, √E and 1 / √ρ, for every mode of a free body."""
    modes = solve_modes(assemble(box, steel), count=16)
    elastic = modes.frequencies > 1.0
    lam, mu, density = constants
    rates = [
        ModelSensitivity(velocity=box.points),
        ModelSensitivity(constants=np.stack([lam, mu, np.zeros_like(density)])),
        ModelSensitivity(constants=np.stack([np.zeros_like(lam), np.zeros_like(mu), density])),
    ]
    found = modal_sensitivities(box, constants, modes.shapes, rates).eigenvalues(modes.frequencies)
    slopes = found[:, elastic] / (2.0 * modes.frequencies[elastic] ** 2)
    assert elastic.sum() >= 8
    assert slopes == pytest.approx(np.array([-1.0, 0.5, -0.5])[:, None] * np.ones(elastic.sum()), rel=1e-7)


def test_turning_and_shifting_a_body_changes_no_frequency(box: Mesh, steel: Material, constants: FloatArray) -> None:
    modes = solve_modes(assemble(box, steel), count=12)
    turn = np.cross(np.array([0.3, -0.5, 0.8]), box.points) + np.array([0.1, 0.2, 0.3])
    found = modal_sensitivities(box, constants, modes.shapes, [ModelSensitivity(velocity=turn)]).eigenvalues(
        modes.frequencies
    )
    elastic = modes.frequencies > 1.0
    assert np.abs(found[0, elastic] / modes.frequencies[elastic] ** 2).max() < 1e-7


@pytest.mark.slow
def test_frequency_slopes_are_those_of_solved_modes(
    box: Mesh, geometry: BoxGeometry, steel: Material, constants: FloatArray
) -> None:
    """A wall and a spring, against Richardson's extrapolation of true solutions, to 1e-6 of the largest."""
    supports = [Support("feet", surface="foot-1", fixed=(True, True, True))]
    spring = (3e7, 4e7, 5e7)
    fixed = fixed_freedoms(box, supports)
    morph = BoxMorph(box, geometry)
    velocity = morph.displacement(replace(geometry, wall=replace(geometry.wall, top=0.021, front=0.0205)))

    def frequencies(wall: float, springs: float) -> FloatArray:
        mesh = replace(box, points=box.points + wall * velocity)
        held = [Support("spring", surface="foot-3", stiffness=tuple((1.0 + springs) * k for k in spring))]  # type: ignore[arg-type]
        return solve_modes(attach_fixtures(assemble(mesh, steel), mesh, held).held(fixed), count=6).frequencies

    held = Support("spring", surface="foot-3", stiffness=spring)
    matrices = attach_fixtures(assemble(box, steel), box, [held])
    modes = solve_modes(matrices.held(fixed), count=6)
    n = len(box.points)
    fastened = held.additions(box).stiffness.matrix(n)
    shares = [
        (held.additions(replace(box, points=box.points + way * STEP * velocity)).stiffness.matrix(n)) for way in (1, -1)
    ]
    rates = [
        ModelSensitivity(velocity=velocity, stiffness=(shares[0] - shares[1]) / (2.0 * STEP)),
        ModelSensitivity(stiffness=fastened),
    ]
    slopes = modal_sensitivities(box, constants, modes.shapes, rates).eigenvalues(modes.frequencies) / (
        2.0 * modes.frequencies
    )
    for number, step in enumerate((0.02, 0.01)):
        one, two = (
            (frequencies(*np.eye(2)[number] * h) - frequencies(*np.eye(2)[number] * -h)) / (2.0 * h)
            for h in (2.0 * step, step)
        )
        expected = (4.0 * two - one) / 3.0
        assert np.abs(slopes[number] - expected).max() < 1e-6 * np.abs(expected).max()


def test_shapes_mix_as_solved_modes_do(cube: tuple[Mesh, Matrices], steel: Material) -> None:
    """With all modes of a small body at hand the rate of each shape is complete, and exact to 1e-6."""
    brick = cube[0]
    constants = element_constants(brick, steel, {})
    x, y, z = brick.points.T
    bend = np.stack([0.2 * y, 3.0 * x**2, 0.3 * z], axis=1)
    # Middles half way between their edges' ends: elements that are affine stay so, with the same quadrature.
    (block,) = brick.blocks
    for middle, (first, last) in enumerate(((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)), start=4):
        bend[block.nodes[:, middle]] = (bend[block.nodes[:, first]] + bend[block.nodes[:, last]]) / 2

    def solved(step: float) -> tuple[FloatArray, FloatArray]:
        matrices = assemble(replace(brick, points=brick.points + step * bend), steel)
        # A corner on springs, so that no mode is rigid and no two are alike.
        springs = np.zeros(3 * len(brick.points))
        springs[:9] = 1e9 * np.arange(1, 10)
        values, vectors = linalg.eigh(matrices.stiffness.toarray() + np.diag(springs), matrices.mass.toarray())
        return values, vectors

    values, vectors = solved(0.0)
    shapes = vectors.T.reshape(len(values), -1, 3)
    rates = modal_sensitivities(brick, constants, shapes, [ModelSensitivity(velocity=bend)])
    slopes = vectors @ rates.mixtures(np.sqrt(values))[0]

    def difference(step: float) -> FloatArray:
        either = []
        for way in (step, -step):
            moved = solved(way)[1]
            either.append(moved * np.sign((moved * vectors).sum(axis=0)))
        return (either[0] - either[1]) / (2.0 * step)

    expected = (4.0 * difference(5e-4) - difference(1e-3)) / 3.0
    lowest = slice(0, 12)
    assert np.abs(slopes - expected)[:, lowest].max() < 1e-6 * np.abs(expected[:, lowest]).max()


def test_arrays_that_do_not_fit_are_refused(box: Mesh, constants: FloatArray, shapes: FloatArray) -> None:
    with pytest.raises(HousingError, match="velocity of shape"):
        modal_sensitivities(box, constants, shapes, [ModelSensitivity(velocity=np.zeros((3, 3)))])
    with pytest.raises(HousingError, match="constants' rates"):
        modal_sensitivities(box, constants, shapes, [ModelSensitivity(constants=np.zeros((3, 2)))])
