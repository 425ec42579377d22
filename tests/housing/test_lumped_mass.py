"""Lumped masses: rigid-body mechanics to the last digit, and bars with a mass at their end in closed form."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import brentq

from gearwhine.housing import HousingError, LumpedMass, Material, Patch, Support, assemble, attach_fixtures, solve_modes
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.model.patches import RigidBody, rigid_body
from gearwhine.meshes import Mesh

INERTIA = ((0.020, 0.003, -0.001), (0.003, 0.030, 0.002), (-0.001, 0.002, 0.025))
SLACK = Material(youngs_modulus=210e9, poisson_ratio=0.0, density=7800.0)


def test_the_block_alone_is_the_textbooks(block: Callable[..., Mesh], steel: Material) -> None:
    a, b, c = 0.10, 0.07, 0.05
    mesh = block((a, b, c))
    body = rigid_body(mesh.points, assemble(mesh, steel))
    mass = 7850.0 * a * b * c
    assert body.mass == pytest.approx(mass, rel=1e-13)
    np.testing.assert_allclose(body.center, (a / 2, b / 2, c / 2), rtol=1e-12)
    moments = mass / 12.0 * np.array([b * b + c * c, a * a + c * c, a * a + b * b])
    np.testing.assert_allclose(body.inertia, np.diag(moments), rtol=1e-12, atol=1e-12 * moments.max())


@pytest.mark.parametrize("order", [1, 2])
def test_a_mass_on_a_patch_adds_up_as_rigid_bodies_do(block: Callable[..., Mesh], steel: Material, order: int) -> None:
    """Steiner: each body's inertia about the common centre of gravity is its own and m (d² I - d dᵀ)."""
    mesh = block((0.10, 0.07, 0.05), (2, 1, 1), order)
    free = assemble(mesh, steel)
    offset = np.array([0.03, -0.02, 0.08])
    motor = LumpedMass("motor", 3.7, Patch(surface="top"), inertia=INERTIA, offset=tuple(offset))
    whole = rigid_body(mesh.points, both := attach_fixtures(free, mesh, [motor]))
    bare = rigid_body(mesh.points, free)
    place = np.array([0.05, 0.035, 0.05]) + offset
    mass = bare.mass + 3.7
    center = (bare.mass * bare.center + 3.7 * place) / mass
    inertia = bare.inertia + INERTIA
    for part, at in ((bare.mass, bare.center), (3.7, place)):
        d = at - center
        inertia = inertia + part * (d @ d * np.eye(3) - np.outer(d, d))
    assert both.total_mass == pytest.approx(mass, rel=1e-13)
    assert whole.mass == pytest.approx(mass, rel=1e-13)
    np.testing.assert_allclose(whole.center, center, rtol=1e-11)
    np.testing.assert_allclose(whole.inertia, inertia, rtol=0.0, atol=1e-11 * np.abs(inertia).max())


def test_a_point_mass_adds_up_too(box: Mesh, box_matrices: Matrices) -> None:
    place = np.array([0.03, 0.16, -0.05])
    sensor = LumpedMass("sensor", 0.25, position=tuple(place))
    np.testing.assert_allclose(sensor.place(box).position, place, atol=1e-12)
    bare, whole = (rigid_body(box.points, m) for m in (box_matrices, attach_fixtures(box_matrices, box, [sensor])))
    assert whole.mass == pytest.approx(bare.mass + 0.25, rel=1e-13)
    center = (bare.mass * bare.center + 0.25 * place) / whole.mass
    np.testing.assert_allclose(whole.center, center, rtol=1e-10)
    expected = bare.matrix(center) + RigidBody(0.25, place, np.zeros((3, 3))).matrix(center)
    np.testing.assert_allclose(whole.matrix(center), expected, rtol=0.0, atol=1e-10 * np.abs(expected).max())


def test_lengthwise_modes_of_a_bar_with_an_end_mass(block: Callable[..., Mesh]) -> None:
    """Clamped bar of mass m with M at its end: β tan β = m / M, ω = β c / L. With ν = 0 the bar is one-dimensional."""
    length, side, heavy = 0.2, 0.05, 2.0
    mesh = block((side, side, length), (1, 1, 6))
    bar = SLACK.density * side**2 * length
    supports = [Support("root", surface="bottom", fixed=(True, True, True))]
    tip = LumpedMass("tip", heavy, Patch(surface="top"))
    matrices = attach_fixtures(assemble(mesh, SLACK), mesh, [*supports, tip])
    speed = np.sqrt(SLACK.youngs_modulus / SLACK.density)
    roots = [brentq(lambda b: b * np.tan(b) - bar / heavy, low + 1e-9, low + np.pi / 2 - 1e-9) for low in (0.0, np.pi)]
    modes = solve_modes(matrices, frequency_limit=1.05 * roots[1] * speed / length)
    for root, tolerance in zip(roots, (1e-6, 1e-4), strict=True):
        assert np.abs(modes.frequencies / (root * speed / length) - 1).min() < tolerance


def test_bending_of_a_cantilever_with_a_body_at_its_tip(block: Callable[..., Mesh]) -> None:
    """Euler and Bernoulli's beam w, a rigid body (M, J about its centre of gravity, d beyond the tip) at its end:

    EI w'' = ω² (J w' + M d (w + d w')) and EI w''' = -ω² M (w + d w') at the tip, w = w' = 0 at the root.
    Slender enough (40 : 1) that shear makes 0.1 % in the first mode, 0.2 % in the second.
    """
    length, side, heavy, inertia, arm = 1.0, 0.025, 3.0, 0.04, 0.10
    mesh = block((side, side, length), (1, 1, 20))
    # Slim about the beam's axis, so that torsion lies above the two modes of either plane.
    tensor = ((inertia, 0, 0), (0, inertia, 0), (0, 0, 0.05 * inertia))
    tip = LumpedMass("tip", heavy, Patch(surface="top"), inertia=tensor, offset=(0.0, 0.0, arm))
    root = Support("root", surface="bottom", fixed=(True, True, True))
    matrices = attach_fixtures(assemble(mesh, SLACK), mesh, [root, tip])
    stiffness, line = SLACK.youngs_modulus * side**4 / 12.0, SLACK.density * side**2

    def determinant(omega: float) -> float:
        b = (line * omega**2 / stiffness) ** 0.25
        x = b * length
        c, s, ch, sh = np.cos(x), np.sin(x), np.cosh(x), np.sinh(x)
        columns = []
        for w, w1, w2, w3 in ((c - ch, -s - sh, -c - ch, s - sh), (s - sh, c - ch, -s - sh, -c - ch)):
            moved = w + arm * b * w1
            bending = stiffness * b**2 * w2 - omega**2 * (inertia * b * w1 + heavy * arm * moved)
            shear = stiffness * b**3 * w3 + omega**2 * heavy * moved
            columns.append((bending / (stiffness * b**2), shear / (stiffness * b**3)))
        (a11, a21), (a12, a22) = columns
        return float((a11 * a22 - a12 * a21) / ch**2)

    grid = np.linspace(1.0, 1500.0, 3000)
    signs = np.sign([determinant(omega) for omega in grid])
    expected = [brentq(determinant, grid[i], grid[i + 1]) for i in np.flatnonzero(np.diff(signs))[:2]]
    modes = solve_modes(matrices, count=6)
    np.testing.assert_allclose(modes.frequencies[:4], np.repeat(expected, 2), rtol=5e-3)


def test_masses_that_make_no_sense_are_refused(box: Mesh) -> None:
    lid = Patch(surface="foot-1")
    with pytest.raises(HousingError, match="mass is 0; expected a finite number above 0 kg"):
        LumpedMass("m", 0.0, lid)
    with pytest.raises(HousingError, match="a patch or a position, one of the two"):
        LumpedMass("m", 1.0)
    with pytest.raises(HousingError, match="a single point does not turn a body"):
        LumpedMass("m", 1.0, position=(0.0, 0.0, 0.0), offset=(0.1, 0.0, 0.0))
    with pytest.raises(HousingError, match=r"inertia is .*; expected a symmetric tensor"):
        LumpedMass("m", 1.0, lid, inertia=((1, 0.1, 0), (0, 1, 0), (0, 0, 1)))
    with pytest.raises(HousingError, match=r"sum of the two others; they are 1, 1, 3 kg m²"):
        LumpedMass("m", 1.0, lid, inertia=((1, 0, 0), (0, 1, 0), (0, 0, 3)))
    LumpedMass("thin disc", 1.0, lid, inertia=((1, 0, 0), (0, 1, 0), (0, 0, 2)))
    with pytest.raises(HousingError, match="on a patch, not at a point"):
        LumpedMass("m", 1.0, lid).place(box)
