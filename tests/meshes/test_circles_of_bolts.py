"""Circles on faces that look at each other, found by place on two blocks that touch and are not glued."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from gearwhine.meshes import GeometryError, circle_facets, diagnose, mesh_cad
from gearwhine.meshes.elements import facet_centers, facet_normals
from gearwhine.meshes.gmsh_meshing import gmsh_session


@pytest.fixture(scope="module")
def drawing(tmp_path_factory: pytest.TempPathFactory) -> Callable[[float], Path]:
    """Two plates of 100 x 10 x 80 mm as a STEP file, the second one so many mm above the middle of the first."""

    def draw(height: float) -> Path:
        path = tmp_path_factory.mktemp("plates") / "plates.step"
        with gmsh_session("plates") as gmsh:
            gmsh.model.occ.addBox(0, 0, 0, 100, 10, 80)
            gmsh.model.occ.addBox(0, height, 0, 100, 10, 80)
            gmsh.model.occ.synchronize()
            gmsh.write(str(path))
        return path

    return draw


def test_each_face_of_a_joint_is_found_by_the_way_it_looks(drawing: Callable[[float], Path]) -> None:
    found = mesh_cad(drawing(10.0), 0.008, glue=False)
    mesh = found.mesh
    assert found.solids == ("solid-1", "solid-2")
    assert "disconnected" in {one.name for one in diagnose(mesh)}
    center, diameter = (0.04, 0.01, 0.03), 0.03
    normals = facet_normals(mesh.points, mesh.boundary)
    for way in (1.0, -1.0):
        facets = circle_facets(mesh, center, (0.0, 2.0 * way, 0.0), diameter)
        middles = facet_centers(mesh.points, facets)
        np.testing.assert_allclose(middles[:, 1], 0.01, atol=1e-9)
        np.testing.assert_allclose(facet_normals(mesh.points, facets), [[0.0, way, 0.0]] * len(middles), atol=1e-9)
        assert (np.hypot(middles[:, 0] - 0.04, middles[:, 2] - 0.03) <= diameter / 2).all()
        # The other sides of the plates, 10 mm away, look the same way and lie within reach of the circle too.
        assert ((normals[:, 1] * way > 0.9).sum()) > len(middles)
    with pytest.raises(GeometryError, match=r"is it wider than the elements there\?"):
        circle_facets(mesh, (0.5, 0.01, 0.03), (0.0, 1.0, 0.0), diameter)


def test_glued_plates_have_no_faces_between_them(drawing: Callable[[float], Path]) -> None:
    mesh = mesh_cad(drawing(10.0), 0.008).mesh
    assert "disconnected" not in {one.name for one in diagnose(mesh)}
    with pytest.raises(GeometryError, match="no facet of the surface that looks along"):
        circle_facets(mesh, (0.04, 0.01, 0.03), (0.0, 1.0, 0.0), 0.01)


@pytest.mark.parametrize("glue", [True, False])
def test_plates_that_overlap_are_refused(drawing: Callable[[float], Path], glue: bool) -> None:
    with pytest.raises(GeometryError, match=r"of 1\.6e\+04, between \(0, 8, 0\) and \(100, 10, 80\)"):
        mesh_cad(drawing(8.0), 0.01, glue=glue)
