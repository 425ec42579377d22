"""One housing with every feature that the box geometry has, meshed once at each order."""

import pytest

from gearwhine.meshes import Bore, Boss, BoxGeometry, Feet, Mesh, WallThickness, mesh_box


@pytest.fixture(scope="session")
def geometry() -> BoxGeometry:
    """Six different walls, bores with and without bosses in both end walls, four feet."""
    return BoxGeometry(
        size=(0.20, 0.16, 0.24),
        wall=WallThickness(left=0.010, right=0.012, bottom=0.015, top=0.011, back=0.013, front=0.014),
        bores=(
            Bore("input-back", (-0.035, 0.08, -0.12), 0.04, Boss(0.06, 0.01)),
            Bore("output-back", (0.045, 0.08, -0.115), 0.03),
            Bore("input-front", (-0.035, 0.08, 0.12), 0.04),
        ),
        feet=Feet((0.03, 0.02, 0.04)),
    )


@pytest.fixture(scope="session")
def straight(geometry: BoxGeometry) -> Mesh:
    """Four-node tetrahedra: flat facets, so the bores are polygons."""
    return mesh_box(geometry, 0.02, order=1)


@pytest.fixture(scope="session")
def curved(geometry: BoxGeometry) -> Mesh:
    """Ten-node tetrahedra, with middle nodes on the bores' cylinders."""
    return mesh_box(geometry, 0.02, order=2)
