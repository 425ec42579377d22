"""Solids of hexahedra for the tests of radiating surfaces: bodies of cubic cells, and a spherical shell."""

import numpy as np
import numpy.typing as npt

from gearwhine.meshes import ElementBlock, Mesh
from gearwhine.meshes.elements import KINDS


def cubes(cells: npt.NDArray[np.bool_], sizes: tuple[float, float, float]) -> Mesh:
    """Mesh the true cells of a grid from the origin, each of some sizes [m], with eight-node hexahedra."""
    offsets = np.array(KINDS["hexahedron"].places, dtype=np.int64)
    corners = (np.argwhere(cells)[:, None] + offsets).reshape(-1, 3)
    places, numbers = np.unique(corners, axis=0, return_inverse=True)
    return Mesh(places * np.array(sizes), (ElementBlock("hexahedron", numbers.reshape(-1, 8)),))


def hollow_box(hole: int) -> Mesh:
    """Box of 300 x 240 x 200 mm with walls of 10 mm, and a square hole of some cells of 10 mm in its +z face."""
    cells = np.ones((30, 24, 20), dtype=bool)
    cells[1:-1, 1:-1, 1:-1] = False
    first = 12 - hole // 2
    cells[first : first + hole, first : first + hole, -1] = False
    return cubes(cells, (0.01, 0.01, 0.01))


def spherical_shell(inner: float, outer: float, cells: int) -> Mesh:
    """Mesh a spherical shell with hexahedra, six squares of some cells a side, by equal angles."""
    angles = np.tan(np.linspace(-np.pi / 4, np.pi / 4, cells + 1))
    u, v = np.meshgrid(angles, angles, indexing="ij")
    points, blocks = [], []
    number = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    ring = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    for axis in range(3):
        for sign in (1.0, -1.0):
            face = np.empty((cells + 1, cells + 1, 3))
            face[..., axis], face[..., (axis + 1) % 3], face[..., (axis + 2) % 3] = sign, sign * u, v
            face /= np.linalg.norm(face, axis=-1, keepdims=True)
            start = 2 * len(points) * number.size
            points.append(np.concatenate([inner * face.reshape(-1, 3), outer * face.reshape(-1, 3)]))
            blocks.append(np.hstack([ring, ring + number.size]) + start)
    together = np.concatenate(points)
    _, first, merged = np.unique(np.round(together, 9), axis=0, return_index=True, return_inverse=True)
    return Mesh(together[first], (ElementBlock("hexahedron", merged.ravel()[np.concatenate(blocks)]),))
