"""Springs and fixed patches."""

import numpy as np
import pytest

from gearwhine.housing import HousingError, Material, Support, assemble, attach_fixtures
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.model.supports import fixed_freedoms
from gearwhine.meshes import GeometryError, Mesh
from gearwhine.meshes.elements import facet_nodes

STIFFNESS = (5e8, 9e9, 3e8)


@pytest.mark.parametrize("name", ["box", "straight_box"])
def test_a_translated_patch_meets_its_stiffness(name: str, steel: Material, request: pytest.FixtureRequest) -> None:
    mesh = request.getfixturevalue(name)
    free = assemble(mesh, steel)
    held = attach_fixtures(free, mesh, [Support("foot", surface="foot-2", stiffness=STIFFNESS)])
    added = held.stiffness - free.stiffness
    for component, stiffness in enumerate(STIFFNESS):
        translation = np.zeros((len(mesh.points), 3))
        translation[:, component] = 1.0
        force = (added @ translation.ravel()).reshape(-1, 3)
        # To the rounding of K, whose entries are far larger than the patch's share.
        rounding = 1e-14 * abs(free.stiffness).max() * len(mesh.points)
        assert force[:, component].sum() == pytest.approx(stiffness, abs=rounding, rel=1e-9)
        assert np.abs(np.delete(force, component, axis=1)).max() == 0.0
        touched = np.flatnonzero(np.abs(force).max(axis=1))
        assert set(touched) <= set(facet_nodes(mesh.surface("foot-2")))


def test_springs_of_several_supports_add_up_and_leave_the_free_matrices_alone(
    box: Mesh, box_matrices: Matrices
) -> None:
    before = box_matrices.blocks.copy()
    feet = [Support(f"foot-{n}", surface=f"foot-{n}", stiffness=STIFFNESS) for n in (1, 2, 3, 4)]
    together = attach_fixtures(box_matrices, box, feet)
    one_by_one = box_matrices
    for foot in feet:
        one_by_one = attach_fixtures(one_by_one, box, [foot])
    assert np.array_equal(together.blocks, one_by_one.blocks)
    assert np.array_equal(box_matrices.blocks, before)
    assert together.node_mass is box_matrices.node_mass


def test_fixed_freedoms_are_the_components_of_the_nodes_of_the_patch(box: Mesh) -> None:
    supports = [
        Support("a", surface="foot-1", fixed=(True, False, True)),
        Support("b", surface="foot-2", fixed=(False, True, False)),
        Support("c", surface="foot-3", stiffness=STIFFNESS),
    ]
    expected = {3 * node + component for node in facet_nodes(box.surface("foot-1")) for component in (0, 2)}
    expected |= {3 * node + 1 for node in facet_nodes(box.surface("foot-2"))}
    held = fixed_freedoms(box, supports)
    assert held.tolist() == sorted(expected)
    assert fixed_freedoms(box, []).size == 0


def test_a_box_around_a_foot_finds_its_underside(box: Mesh) -> None:
    # foot-1 stands below x from -0.10 to -0.06 and z from -0.12 to -0.07 m.
    low, high = (-0.11, -0.0201, -0.13), (-0.0599, -0.0199, -0.0699)
    by_box = Support("a", box=(low, high), fixed=(True, True, True))
    by_name = Support("a", surface="foot-1", fixed=(True, True, True))
    assert np.array_equal(fixed_freedoms(box, [by_box]), fixed_freedoms(box, [by_name]))


def test_supports_that_hold_nothing_are_refused(box: Mesh) -> None:
    with pytest.raises(HousingError, match="'a' holds nothing"):
        Support("a", surface="foot-1")
    with pytest.raises(HousingError, match="'a' needs a surface, a box or a plane, one of the three"):
        Support("a", fixed=(True, True, True))
    with pytest.raises(HousingError, match="one of the three"):
        Support("a", surface="s", box=((0, 0, 0), (1, 1, 1)), fixed=(True, True, True))
    with pytest.raises(HousingError, match="each a finite number of at least 0"):
        Support("a", surface="s", stiffness=(1.0, -1.0, 0.0))
    with pytest.raises(GeometryError, match=r"no facet of the surface lies in the box.*the housing spans"):
        Support("a", box=((1, 1, 1), (2, 2, 2)), fixed=(True, True, True)).facets(box)
    with pytest.raises(GeometryError, match=r"no surface 'foot-5'.*foot-4"):
        fixed_freedoms(box, [Support("a", surface="foot-5", fixed=(True, True, True))])
