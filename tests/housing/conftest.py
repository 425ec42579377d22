"""Small solids for the housing's tests: a box with everything, and blocks whose mesh is laid by hand."""

from collections.abc import Callable
from itertools import product

import numpy as np
import numpy.typing as npt
import pytest

from gearwhine.housing import Material, assemble
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.meshes import Bore, Boss, BoxGeometry, Feet, Mesh, WallThickness, mesh_box

_EDGES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])


@pytest.fixture(scope="session")
def steel() -> Material:
    return Material(youngs_modulus=207e9, poisson_ratio=0.3, density=7850.0)


@pytest.fixture(scope="session")
def geometry() -> BoxGeometry:
    return BoxGeometry(
        size=(0.20, 0.16, 0.24),
        wall=WallThickness.uniform(0.02),
        bores=(
            Bore("front-seat", (-0.03, 0.08, 0.12), 0.05, Boss(0.07, 0.01)),
            Bore("back-seat", (0, 0.08, -0.12), 0.05),
        ),
        feet=Feet((0.04, 0.02, 0.05)),
    )


@pytest.fixture(scope="session")
def box(geometry: BoxGeometry) -> Mesh:
    """Ten-node tetrahedra, curved at the bores."""
    return mesh_box(geometry, 0.05, order=2)


@pytest.fixture(scope="session")
def straight_box(geometry: BoxGeometry) -> Mesh:
    """Four-node tetrahedra."""
    return mesh_box(geometry, 0.05, order=1)


@pytest.fixture(scope="session")
def box_matrices(box: Mesh, steel: Material) -> Matrices:
    return assemble(box, steel)


@pytest.fixture(scope="session")
def block() -> Callable[..., Mesh]:
    """``block(size, cells, order)``: a solid block from the origin, with the surfaces bottom and top at z min and max.

    Each cell is cut into 24 tetrahedra around its centre and the centres of its faces, so that a cube's mesh has all
    48 symmetries of the cube and its double and triple modes are exactly so.
    """
    return _block


@pytest.fixture(scope="session")
def cube(steel: Material) -> tuple[Mesh, Matrices]:
    """A free solid cube of 0.1 m: 65 nodes, small enough for dense eigenvalues."""
    mesh = _block((0.1, 0.1, 0.1), (1, 1, 1))
    return mesh, assemble(mesh, steel)


@pytest.fixture(scope="session")
def beam(steel: Material) -> tuple[Mesh, Matrices]:
    """A solid of 0.3 x 0.06 x 0.05 m, 405 degrees of freedom: small enough for dense algebra."""
    mesh = _block((0.05, 0.06, 0.3), (1, 1, 3))
    return mesh, assemble(mesh, steel)


def _block(size: tuple[float, float, float], cells: tuple[int, int, int] = (1, 1, 1), order: int = 2) -> Mesh:
    numbers: dict[tuple[int, ...], int] = {}

    def node(*place: int) -> int:
        return numbers.setdefault(place, len(numbers))

    tetrahedra = []
    for cell in product(*(range(n) for n in cells)):
        low = [2 * index for index in cell]
        center = [value + 1 for value in low]
        for axis, side in product(range(3), (0, 2)):
            middle = list(center)
            middle[axis] = low[axis] + side
            first, second = (other for other in range(3) if other != axis)
            ring = []
            for da, db in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                corner = list(middle)
                corner[first] += da
                corner[second] += db
                ring.append(node(*corner))
            for start, end in zip(ring, ring[1:] + ring[:1], strict=True):
                tetrahedra.append([node(*center), node(*middle), start, end])
    steps = np.array(sorted(numbers, key=numbers.__getitem__), dtype=np.float64)
    points = steps / 2 / np.array(cells) * np.array(size)
    corners = np.array(tetrahedra)
    edges = points[corners]
    negative = np.linalg.det(edges[:, 1:] - edges[:, :1]) < 0
    corners[negative] = corners[negative][:, [0, 1, 3, 2]]
    linear = Mesh.of_tetrahedra(points, corners)
    mesh = linear if order == 1 else _quadratic(points, corners)
    (boundary,), (cells,) = mesh.boundary, mesh.blocks
    facets = boundary.nodes
    height = mesh.points[boundary.corners, 2]
    surfaces = {"bottom": facets[(height == 0).all(axis=1)], "top": facets[np.isclose(height, size[2]).all(axis=1)]}
    return Mesh.of_tetrahedra(mesh.points, cells.nodes, surfaces)


def _quadratic(points: npt.NDArray[np.float64], corners: npt.NDArray[np.int64]) -> Mesh:
    pairs = np.sort(corners[:, _EDGES], axis=2).reshape(-1, 2)
    unique, inverse = np.unique(pairs, axis=0, return_inverse=True)
    cells = np.hstack([corners, len(points) + inverse.reshape(-1, 6)])
    return Mesh.of_tetrahedra(np.vstack([points, points[unique].mean(axis=1)]), cells)


@pytest.fixture(scope="session")
def rigid_fields() -> Callable[[npt.NDArray[np.float64]], npt.NDArray[np.float64]]:
    """``rigid_fields(points)``: three translations and three rotations about the origin, shape (6, 3 n_nodes)."""

    def fields(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        axes = np.eye(3)
        translations = [np.tile(axis, (len(points), 1)) for axis in axes]
        rotations = [np.cross(axis, points) for axis in axes]
        return np.array([field.ravel() for field in translations + rotations])

    return fields
