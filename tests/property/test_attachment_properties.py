"""What holds for everything attached: it knows no frame, and a heavier or softer housing never rises in frequency."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from gearwhine.housing import (
    Bushing,
    Joint,
    LumpedMass,
    Material,
    Mount,
    Patch,
    assemble,
    attach_fixtures,
    modal_damping,
    solve_modes,
)
from gearwhine.housing.model.fixtures import Fixture
from gearwhine.housing.model.patches import rigid_body
from gearwhine.meshes import BoxGeometry, Feet, Mesh, WallThickness, mesh_box
from gearwhine.numerics.arrays import FloatArray

STEEL = Material(207e9, 0.3, 7850.0)
few = settings(max_examples=8, deadline=None)

amounts = st.tuples(*[st.floats(0.1, 1.0)] * 6)
angles = st.tuples(*[st.floats(-np.pi, np.pi)] * 3)


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    return mesh_box(BoxGeometry((0.20, 0.16, 0.24), WallThickness.uniform(0.03), (), Feet((0.04, 0.02, 0.05))), 0.09)


@pytest.fixture(scope="module")
def turned_mesh() -> Callable[[Mesh, FloatArray, FloatArray], Mesh]:
    return lambda mesh, turn, shift: Mesh(mesh.points @ turn.T + shift, mesh.blocks, surfaces=mesh.surfaces)


def _things(stiffness: tuple[float, ...], turn: FloatArray, shift: FloatArray) -> list[Fixture]:
    """A mount, a strut, a motor on a patch and a sensor, all moved as one rigid body."""

    def point(*place: float) -> tuple[float, float, float]:
        x, y, z = turn @ place + shift
        return float(x), float(y), float(z)

    frame = Rotation.from_euler("xyz", (0.3, -0.5, 1.1)).as_matrix()
    axes = tuple(tuple(float(v) for v in turn @ row) for row in frame)
    springs = tuple(v * s for v, s in zip(stiffness, (1e8, 2e8, 3e8, 1e5, 2e5, 3e5), strict=True))
    dashpots = tuple(v * 1e-4 for v in springs)
    inertia = turn @ np.array([[0.02, 0.003, 0.0], [0.003, 0.03, 0.002], [0.0, 0.002, 0.025]]) @ turn.T
    tensor = tuple(tuple(float(v) for v in row) for row in 0.5 * (inertia + inertia.T))
    ox, oy, oz = turn @ [0.03, 0.05, -0.02]
    return [
        Mount("mount", Patch("foot-1"), Bushing(springs, dashpots, axes)),
        Mount("other", Patch("foot-3"), Bushing(springs, dashpots, axes), point(0.02, -0.05, 0.1)),
        Joint("strut", Patch("foot-2"), Patch("foot-4"), Bushing(springs, dashpots, axes)),
        LumpedMass("motor", 4.0, Patch("left"), inertia=tensor, offset=(float(ox), float(oy), float(oz))),
        LumpedMass("sensor", 0.3, position=point(0.013, 0.16, 0.031)),
    ]


@pytest.mark.slow
@few
@given(stiffness=amounts, angles=angles, shift=st.tuples(*[st.floats(-0.5, 0.5)] * 3))
def test_turning_and_moving_everything_changes_no_frequency_and_no_damping(
    mesh: Mesh,
    turned_mesh: Callable[[Mesh, FloatArray, FloatArray], Mesh],
    stiffness: tuple[float, ...],
    angles: tuple[float, float, float],
    shift: tuple[float, float, float],
) -> None:
    turn, still = Rotation.from_euler("xyz", angles).as_matrix(), np.zeros(3)
    other = turned_mesh(mesh, turn, np.array(shift))
    found = []
    for body, things in (
        (mesh, _things(stiffness, np.eye(3), still)),
        (other, _things(stiffness, turn, np.array(shift))),
    ):
        matrices = attach_fixtures(assemble(body, STEEL), body, things)
        modes = solve_modes(matrices, frequency_limit=2 * np.pi * 3500.0)
        whole = rigid_body(body.points, matrices)
        found.append((modes, np.trace(modal_damping(modes, matrices)), whole))
    (here, damped, body_here), (there, damped_there, body_there) = found
    np.testing.assert_allclose(there.frequencies, here.frequencies, rtol=1e-9)
    assert damped_there == pytest.approx(damped, rel=1e-8)
    np.testing.assert_allclose(body_there.center, turn @ body_here.center + shift, atol=1e-12)
    expected = turn @ body_here.inertia @ turn.T
    np.testing.assert_allclose(body_there.inertia, expected, atol=1e-11 * np.abs(expected).max())


@pytest.mark.slow
@few
@given(mass=st.floats(0.1, 50.0), inertia=st.floats(0.0, 1.0), offset=st.tuples(*[st.floats(-0.2, 0.2)] * 3))
def test_added_mass_raises_no_frequency(
    mesh: Mesh, mass: float, inertia: float, offset: tuple[float, float, float]
) -> None:
    """Rayleigh: more kinetic energy for the same motion lowers every natural frequency or leaves it."""
    held = attach_fixtures(assemble(mesh, STEEL), mesh, _things((1.0,) * 6, np.eye(3), np.zeros(3))[:3])
    tensor = ((inertia, 0.0, 0.0), (0.0, inertia, 0.0), (0.0, 0.0, inertia))
    lighter = LumpedMass("a", 0.5 * mass, Patch("top"), inertia=tensor, offset=offset)
    steps = [held, attach_fixtures(held, mesh, [lighter]), attach_fixtures(held, mesh, [lighter, lighter])]
    frequencies = [solve_modes(matrices, count=8).frequencies[:8] for matrices in steps]
    for before, after in pairwise(frequencies):
        assert (after <= before * (1 + 1e-9)).all()
