"""Triangulated spheres, boxes and rectangles whose sound fields are known."""

import numpy as np

from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.numerics.arrays import ComplexArray, FloatArray

BOX = (0.28, 0.25, 0.33)
_T = (1.0 + 5.0**0.5) / 2.0
_ICOSAHEDRON = np.array(
    [[-1, _T, 0], [1, _T, 0], [-1, -_T, 0], [1, -_T, 0], [0, -1, _T], [0, 1, _T]]
    + [[0, -1, -_T], [0, 1, -_T], [_T, 0, -1], [_T, 0, 1], [-_T, 0, -1], [-_T, 0, 1]]
)
_FACES = [[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2]]
_FACES += [[10, 7, 6], [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5]]
_FACES += [[2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1]]


def joined(triangles: FloatArray) -> RadiatingSurface:
    """Surface of triangles given by their corners, shape (n, 3, 3)."""
    rounded = np.round(triangles.reshape(-1, 3), 9) + 0.0
    _, first, number = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    return RadiatingSurface(triangles.reshape(-1, 3)[first], number.reshape(-1, 3))


def _grid(corner: FloatArray, one: FloatArray, two: FloatArray, n: int, m: int) -> list[list[FloatArray]]:
    """Rectangle from a corner along two sides, its normal along their cross product, in right triangles."""

    def at(i: int, j: int) -> FloatArray:
        return corner + one * (i / n) + two * (j / m)

    found = []
    for i in range(n):
        for j in range(m):
            q = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
            found += (
                [[q[0], q[1], q[2]], [q[0], q[2], q[3]]] if (i + j) % 2 else [[q[0], q[1], q[3]], [q[1], q[2], q[3]]]
            )
    return found


def rectangle(length: float, width: float, n: int, m: int) -> RadiatingSurface:
    """Rectangle in the plane z = 0 from the origin, its normal along z."""
    return joined(np.array(_grid(np.zeros(3), np.array([length, 0, 0]), np.array([0, width, 0]), n, m)))


def disc(radius: float, rings: int) -> RadiatingSurface:
    """Disc in the plane z = 0 about the origin, its normal along z, of the area of the circle.

    The rings are narrower towards the rim, where the pressure drops steeply.
    """
    points, triangles, start = [np.zeros(2)], [], 0
    for ring in range(1, rings + 1):
        angles = 2.0 * np.pi * np.arange(6 * ring) / (6 * ring)
        points += [radius * np.sin(0.5 * np.pi * ring / rings) * np.array([np.cos(a), np.sin(a)]) for a in angles]
        first = start + (6 * (ring - 1) if ring > 1 else 1)
        for i in range(6 * ring):
            side, step = divmod(i, ring)
            inner = [start + (side * (ring - 1) + s) % max(6 * (ring - 1), 1) for s in (step, step + 1)]
            triangles.append([first + i, first + (i + 1) % (6 * ring), inner[0]])
            if step < ring - 1:
                triangles.append([first + (i + 1) % (6 * ring), inner[1], inner[0]])
        start = first
    flat = np.column_stack([np.array(points), np.zeros(len(points))])
    surface = RadiatingSurface(flat, np.array(triangles))
    return RadiatingSurface(flat * np.sqrt(np.pi * radius**2 / surface.area), surface.triangles)


def sphere(frequency: int, radius: float = 1.0) -> RadiatingSurface:
    """Icosahedron whose edges are divided by a frequency, 20 frequency² triangles, of the volume of the sphere."""
    found = []
    for face in _FACES:
        a, b, c = _ICOSAHEDRON[face]

        def at(i: int, j: int, a: FloatArray = a, b: FloatArray = b, c: FloatArray = c) -> FloatArray:
            place = a + (b - a) * (i / frequency) + (c - a) * (j / frequency)
            return np.asarray(place / np.linalg.norm(place))

        for i in range(frequency):
            for j in range(frequency - i):
                found.append([at(i, j), at(i + 1, j), at(i, j + 1)])
                if j < frequency - i - 1:
                    found.append([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
    surface = joined(np.array(found))
    scale = radius * (4.0 / 3.0 * np.pi / surface.volume) ** (1.0 / 3.0)
    return RadiatingSurface(surface.points * scale, surface.triangles)


def box(
    size: tuple[float, float, float], edge: float, low: tuple[float, float, float] | None = None
) -> RadiatingSurface:
    """Box about the origin, or from its lowest corner, in right triangles with legs of about an edge."""
    extent = np.array(size)
    count = np.maximum(1, np.round(extent / edge).astype(int))
    start = -extent / 2 if low is None else np.array(low)
    found: list[list[FloatArray]] = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        one, two = np.eye(3)[u] * extent[u], np.eye(3)[v] * extent[v]
        found += _grid(start + np.eye(3)[axis] * extent[axis], one, two, count[u], count[v])
        found += _grid(start, two, one, count[v], count[u])
    return joined(np.array(found))


_A, _B = 0.445948490915965, 0.091576213509771
_RULE = np.array(
    [
        [1 - 2 * a if i == j else a for j in range(3)] + [w]
        for a, w in ((_A, 0.223381589678011), (_B, 0.109951743655322))
        for i in range(3)
    ]
)


def at_corners(surface: RadiatingSurface, field: "np.ufunc") -> ComplexArray:
    """Best linear functions on each triangle for a field of points and normals, shape (3 n_triangles, n)."""
    right = 0.0
    for share in _RULE:
        points = np.einsum("a,eaj->ej", share[:3], surface.corners)
        right = right + share[3] * share[None, :3, None] * np.asarray(field(points, surface.normals))[:, None, :]
    mass = (np.ones((3, 3)) + np.eye(3)) / 12.0
    return np.asarray(np.einsum("ab,ebn->ean", np.linalg.inv(mass), right).reshape(3 * len(surface.areas), -1))


def uneven(part: float) -> tuple[RadiatingSurface, int]:
    """Box with a vertex that is drawn towards its nearest neighbour by a part of the way, and its number."""
    even = box(BOX, 0.04)
    points = even.points.copy()
    flat = [
        vertex
        for vertex in range(len(points))
        if np.ptp(even.normals[(even.triangles == vertex).any(axis=1)], axis=0).max() < 1e-9
    ]
    vertex = flat[len(flat) // 2]
    beside = np.setdiff1d(even.triangles[(even.triangles == vertex).any(axis=1)], vertex)
    nearest = beside[np.argmin(np.linalg.norm(points[beside] - points[vertex], axis=1))]
    points[vertex] += part * (points[nearest] - points[vertex])
    return RadiatingSurface(points, even.triangles), vertex
