"""Mass and its centre: closed forms, and the mass matrix as an independent witness."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.housing import LumpedMass, Material, Patch, assemble, attach_fixtures
from gearwhine.housing.material import mass_properties
from gearwhine.housing.model.patches import rigid_body
from gearwhine.meshes import Mesh
from gearwhine.meshes.elements import SOLIDS


@pytest.mark.parametrize("kind", SOLIDS)
def test_a_block_of_two_materials(block_of: Callable[..., Mesh], steel: Material, kind: str) -> None:
    size = np.array([1.0, 0.6, 0.4])
    mesh = block_of(kind, tuple(size), (2, 1, 1))
    light = Material(70e9, 0.33, 2700.0)
    right = np.flatnonzero(mesh.centers[:, 0] > 0.5)
    parts = mass_properties(replace(mesh, volumes={"right": right}), steel, {"right": light})
    assert parts.mass == pytest.approx(size.prod() * (steel.density + light.density) / 2)
    middle = (0.25 * steel.density + 0.75 * light.density) / (steel.density + light.density)
    np.testing.assert_allclose(parts.center, [middle, 0.3, 0.2], rtol=1e-12)


@pytest.mark.parametrize("kind", SOLIDS)
def test_curved_elements_weigh_what_their_mass_matrix_weighs(
    block_of: Callable[..., Mesh], steel: Material, kind: str
) -> None:
    """Rᵀ M x for a translation R and the field x = place: both are integrals of polynomials, exact up to quadrature."""
    mesh = block_of(
        kind, cells=(2, 1, 1), bend=lambda p: p + 0.1 * np.stack([p[:, 1] * p[:, 2], p[:, 0] ** 2, p[:, 0]], 1)
    )
    found = mass_properties(mesh, steel)
    mass = assemble(mesh, steel).mass
    push = np.zeros((len(mesh.points), 3))
    push[:, 0] = 1.0
    assert push.ravel() @ mass @ push.ravel() == pytest.approx(found.mass, rel=1e-3)
    for axis in range(3):
        place = np.zeros((len(mesh.points), 3))
        place[:, 0] = mesh.points[:, axis]
        assert push.ravel() @ mass @ place.ravel() == pytest.approx(found.mass * found.center[axis], rel=2e-3)


def test_inertia_is_about_the_centre_of_gravity_wherever_the_nodes_lie(
    block: Callable[..., Mesh], steel: Material
) -> None:
    """A block and a heavy mass beside it, by the parallel axes."""
    mesh = block((0.10, 0.07, 0.05), (2, 1, 1))
    own = rigid_body(mesh.points, assemble(mesh, steel))
    tip = LumpedMass("tip", 5.0, Patch(surface="top"), offset=(0.03, -0.01, 0.2))
    whole = rigid_body(mesh.points, attach_fixtures(assemble(mesh, steel), mesh, [tip]))
    facets = mesh.points[np.unique(np.concatenate([part.nodes.ravel() for part in mesh.surface("top")]))]
    place = facets.mean(axis=0)
    place[:2] = mesh.points[:, :2].mean(axis=0)
    place = place + [0.03, -0.01, 0.2]
    mass = own.mass + 5.0
    center = (own.mass * own.center + 5.0 * place) / mass
    assert whole.center == pytest.approx(center, abs=1e-9)
    expected = own.inertia.copy()
    for size, at in ((own.mass, own.center), (5.0, place)):
        arm = at - center
        expected += size * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    np.testing.assert_allclose(whole.inertia, expected, atol=1e-9 * expected.max())
