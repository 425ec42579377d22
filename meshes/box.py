"""A gearbox housing as a welded box: walls, bores for the bearings, bosses around them, feet below.

The box stands in the global frame with its shafts along z. The origin is the middle of the box in x and z and
the underside of its base in y; feet reach below y = 0.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from meshes.elements import IntArray
from meshes.errors import GeometryError
from meshes.gmsh_session import gmsh_session
from meshes.mesh import Mesh

# gmsh numbers the last two middle nodes of a ten-node tetrahedron the other way round than VTK does.
_GMSH_TO_VTK = {4: [0, 1, 2, 3], 10: [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]}
_FACES = ("left", "right", "bottom", "top", "back", "front", "foot-1", "foot-2", "foot-3", "foot-4")


@dataclass(frozen=True)
class WallThickness:
    """Thickness of each wall [m]: left/right are x min/max, bottom/top y, back/front z."""

    left: float
    right: float
    bottom: float
    top: float
    back: float
    front: float

    @classmethod
    def uniform(cls, thickness: float) -> "WallThickness":
        """The same thickness [m] all round."""
        return cls(thickness, thickness, thickness, thickness, thickness, thickness)


@dataclass(frozen=True)
class Boss:
    """A cylinder on the outside of the wall, concentric with the bore: diameter and length [m]."""

    diameter: float
    length: float


@dataclass(frozen=True)
class Bore:
    """A bearing's bore through the front or the back wall.

    Attributes
    ----------
    name : str
        The name of its surface in the mesh.
    center : tuple of float
        A point of its axis [m]; its z says which wall.
    diameter : float
        [m].
    boss : Boss, optional
        Material around the bore on the outside of the wall.
    """

    name: str
    center: tuple[float, float, float]
    diameter: float
    boss: Boss | None = None


@dataclass(frozen=True)
class Feet:
    """Four blocks under the corners, flush with the walls: x, y, z sizes [m]. Undersides: foot-1 … foot-4."""

    size: tuple[float, float, float]


@dataclass(frozen=True)
class BoxGeometry:
    """A closed box with walls, bores and feet.

    Attributes
    ----------
    size : tuple of float
        Outside lengths along x, y, z [m], without bosses and feet.
    wall : WallThickness
        [m].
    bores : tuple of Bore
    feet : Feet, optional

    Raises
    ------
    GeometryError
        Where the walls meet, a bore leaves its wall, touches another, or lies in neither end wall.
    """

    size: tuple[float, float, float]
    wall: WallThickness
    bores: tuple[Bore, ...] = ()
    feet: Feet | None = None

    def __post_init__(self) -> None:
        wall = self.wall
        pairs = ((wall.left, wall.right), (wall.bottom, wall.top), (wall.back, wall.front))
        for axis, length, (low, high) in zip("xyz", self.size, pairs, strict=True):
            if not all(value > 0.0 for value in (length, low, high)):
                raise GeometryError(f"box along {axis}: size {length} m and walls {low}, {high} m must be positive")
            if low + high >= length:
                raise GeometryError(f"walls of {low} m and {high} m leave no room in a box {length} m along {axis}")
        if self.feet is not None:
            width, height, depth = self.feet.size
            # Feet that touch would melt into one, and their undersides with them.
            if min(self.feet.size) <= 0.0 or 2 * width >= self.size[0] or 2 * depth >= self.size[2]:
                raise GeometryError(
                    f"feet of {width} x {height} x {depth} m do not fit under a base of "
                    f"{self.size[0]} x {self.size[2]} m: give positive sizes, less than half the base each"
                )
        for bore in self.bores:
            self._check_bore(bore)
        for i, first in enumerate(self.bores):
            for second in self.bores[i + 1 :]:
                self._check_apart(first, second)

    def end_wall(self, bore: Bore) -> Literal["back", "front"]:
        """The wall that a bore goes through.

        Raises
        ------
        GeometryError
            Where the bore's centre lies in neither the back nor the front wall.
        """
        half = self.size[2] / 2
        slack = 1e-9 + 1e-6 * half
        for name, start, thickness in (
            ("back", -half, self.wall.back),
            ("front", half - self.wall.front, self.wall.front),
        ):
            if start - slack <= bore.center[2] <= start + thickness + slack:
                return "back" if name == "back" else "front"
        raise GeometryError(
            f"seat {bore.name!r} at z = {bore.center[2]:g} m lies in neither end wall: the back wall spans "
            f"{-half:g} to {-half + self.wall.back:g} m, the front wall {half - self.wall.front:g} to {half:g} m"
        )

    def bore_span(self, bore: Bore) -> tuple[float, float]:
        """Where along z the bore's surface lies, boss included [m]."""
        half = self.size[2] / 2
        length = bore.boss.length if bore.boss else 0.0
        if self.end_wall(bore) == "back":
            return (-half - length, -half + self.wall.back)
        return (half - self.wall.front, half + length)

    @property
    def inside_height(self) -> tuple[float, float]:
        """Where the cavity begins and ends along y [m]."""
        return (self.wall.bottom, self.size[1] - self.wall.top)

    def _check_bore(self, bore: Bore) -> None:
        if bore.name in _FACES:
            raise GeometryError(f"a seat cannot be named {bore.name!r}, which is a surface of the box itself")
        self.end_wall(bore)
        if bore.diameter <= 0.0:
            raise GeometryError(f"seat {bore.name!r}: diameter {bore.diameter} m must be positive")
        radius = bore.diameter / 2
        if bore.boss is not None:
            if bore.boss.diameter <= bore.diameter or bore.boss.length <= 0.0:
                raise GeometryError(
                    f"seat {bore.name!r}: a boss of {bore.boss.diameter} m diameter and {bore.boss.length} m length "
                    f"needs a positive length and more than the bore's {bore.diameter} m"
                )
            radius = bore.boss.diameter / 2
        x, y, _ = bore.center
        if abs(x) + radius > self.size[0] / 2 or y - radius < 0.0 or y + radius > self.size[1]:
            raise GeometryError(
                f"seat {bore.name!r}: a circle of radius {radius:g} m around x = {x:g}, y = {y:g} m leaves "
                f"its wall of {self.size[0]:g} x {self.size[1]:g} m"
            )

    def _check_apart(self, first: Bore, second: Bore) -> None:
        if first.name == second.name:
            raise GeometryError(f"two seats are named {first.name!r}")
        if self.end_wall(first) != self.end_wall(second):
            return
        distance = float(np.hypot(first.center[0] - second.center[0], first.center[1] - second.center[1]))
        # A bore may touch a neighbour's boss no more than its bore: both would break the cylinder.
        for bore, other in ((first, second), (second, first)):
            reach = bore.diameter / 2 + (other.boss.diameter if other.boss else other.diameter) / 2
            if distance <= reach:
                raise GeometryError(
                    f"seats {first.name!r} and {second.name!r} overlap: centres {distance:g} m apart, "
                    f"more than {reach:g} m needed"
                )


def mesh_box(geometry: BoxGeometry, mesh_size: float, *, order: int = 2) -> Mesh:
    """Mesh a box housing with tetrahedra.

    Parameters
    ----------
    geometry : BoxGeometry
    mesh_size : float
        Edge length aimed at [m].
    order : {1, 2}
        Polynomial order of the elements; with 2, middle nodes lie on the bores' cylinders.

    Returns
    -------
    Mesh
        With the surfaces left, right, bottom, top, back, front (outer faces), the undersides of the feet, and
        one surface for each bore under its own name.

    Raises
    ------
    GeometryError
        Where gmsh cannot build or mesh the shape.
    """
    if mesh_size <= 0.0 or order not in (1, 2):
        raise GeometryError(f"mesh size {mesh_size} m must be positive and order {order} be 1 or 2")
    with gmsh_session("housing box") as gmsh:
        _build_solid(gmsh, geometry)
        named = _named_surfaces(gmsh, geometry)
        gmsh.option.setNumber("Mesh.MeshSizeMin", mesh_size)
        gmsh.option.setNumber("Mesh.MeshSizeMax", mesh_size)
        gmsh.option.setNumber("Mesh.Algorithm3D", 1)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(order)
        if order == 2:
            _unfold(gmsh)
        return _collect(gmsh, order, named)


def _unfold(gmsh: Any) -> None:
    """Bend elements back whose curved side folds them: it happens where they are large beside a bore's radius."""
    tags, _ = gmsh.model.mesh.getElementsByType(11)
    if gmsh.model.mesh.getElementQualities(tags, "minSJ").min() < 0.05:
        gmsh.model.mesh.optimize("HighOrder")


def _build_solid(gmsh: Any, geometry: BoxGeometry) -> None:
    occ = gmsh.model.occ
    (width, height, depth), wall = geometry.size, geometry.wall
    left, back = -width / 2, -depth / 2
    body = [(3, occ.addBox(left, 0.0, back, width, height, depth))]
    additions = []
    if geometry.feet is not None:
        fx, fy, fz = geometry.feet.size
        for x, z in _foot_corners(geometry):
            additions.append((3, occ.addBox(x, -fy, z, fx, fy, fz)))
    for bore in geometry.bores:
        if bore.boss is not None:
            start, end = geometry.bore_span(bore)
            x, y, _ = bore.center
            additions.append((3, occ.addCylinder(x, y, start, 0.0, 0.0, end - start, bore.boss.diameter / 2)))
    if additions:
        body, _ = occ.fuse(body, additions)
    cuts = [
        (
            3,
            occ.addBox(
                left + wall.left,
                wall.bottom,
                back + wall.back,
                width - wall.left - wall.right,
                height - wall.bottom - wall.top,
                depth - wall.back - wall.front,
            ),
        )
    ]
    for bore in geometry.bores:
        start, end = geometry.bore_span(bore)
        margin = 0.1 * (end - start)
        x, y, _ = bore.center
        cuts.append((3, occ.addCylinder(x, y, start - margin, 0.0, 0.0, end - start + 2 * margin, bore.diameter / 2)))
    occ.cut(body, cuts)
    occ.synchronize()
    if len(gmsh.model.getEntities(3)) != 1:
        raise GeometryError("the box falls into several parts; its walls, bores and feet must hang together")


def _foot_corners(geometry: BoxGeometry) -> list[tuple[float, float]]:
    """Lower x and z of each foot, in the order foot-1 (−x −z), foot-2 (+x −z), foot-3 (+x +z), foot-4 (−x +z)."""
    assert geometry.feet is not None
    width, _, depth = geometry.size
    fx, _, fz = geometry.feet.size
    low_x, high_x, low_z, high_z = -width / 2, width / 2 - fx, -depth / 2, depth / 2 - fz
    return [(low_x, low_z), (high_x, low_z), (high_x, high_z), (low_x, high_z)]


def _named_surfaces(gmsh: Any, geometry: BoxGeometry) -> dict[str, list[int]]:
    """Which CAD faces make up each named surface, found by where they lie."""
    (width, height, depth), tolerance = geometry.size, 1e-7 * max(geometry.size)
    outer = {"left": (0, -width / 2), "right": (0, width / 2), "bottom": (1, 0.0), "top": (1, height)}
    outer |= {"back": (2, -depth / 2), "front": (2, depth / 2)}
    tests: dict[str, Callable[[str, np.ndarray], bool]] = {
        name: _on_plane(axis, value, tolerance) for name, (axis, value) in outer.items()
    }
    if geometry.feet is not None:
        fx, fy, fz = geometry.feet.size
        for number, (x, z) in enumerate(_foot_corners(geometry), start=1):
            tests[f"foot-{number}"] = _inside((x, -fy, z), (x + fx, -fy, z + fz), tolerance, kind="Plane")
    for bore in geometry.bores:
        start, end = geometry.bore_span(bore)
        x, y, _ = bore.center
        r = bore.diameter / 2
        tests[bore.name] = _inside((x - r, y - r, start), (x + r, y + r, end), tolerance, kind="Cylinder")

    named: dict[str, list[int]] = {name: [] for name in tests}
    for _, face in gmsh.model.getEntities(2):
        kind = gmsh.model.getType(2, face)
        # OpenCASCADE widens its bounding boxes by its own tolerance of 1e-7, in the model's unit.
        box = np.array(gmsh.model.getBoundingBox(2, face)).reshape(2, 3) + [[1e-7] * 3, [-1e-7] * 3]
        for name, belongs in tests.items():
            if belongs(kind, box):
                named[name].append(face)
    missing = [name for name, faces in named.items() if not faces]
    if missing:
        raise GeometryError(f"no face of the finished shape makes up {', '.join(missing)}: the parts cover it")
    return named


def _on_plane(axis: int, value: float, tolerance: float) -> Callable[[str, np.ndarray], bool]:
    def belongs(kind: str, box: np.ndarray) -> bool:
        return kind == "Plane" and bool(np.all(np.abs(box[:, axis] - value) < tolerance + 1e-6))

    return belongs


def _inside(
    low: tuple[float, float, float], high: tuple[float, float, float], tolerance: float, *, kind: str
) -> Callable[[str, np.ndarray], bool]:
    slack = tolerance + 1e-6

    def belongs(face_kind: str, box: np.ndarray) -> bool:
        return face_kind == kind and bool(
            np.all(box[0] > np.array(low) - slack) and np.all(box[1] < np.array(high) + slack)
        )

    return belongs


def _collect(gmsh: Any, order: int, named: dict[str, list[int]]) -> Mesh:
    """Nodes, elements and named facets of the current gmsh model, numbered from zero."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags] = np.arange(len(tags))
    points = np.asarray(coordinates, dtype=np.float64).reshape(-1, 3)

    tetrahedron, n_nodes = {1: (4, 4), 2: (11, 10)}[order]
    _, connectivity = gmsh.model.mesh.getElementsByType(tetrahedron)
    cells = number[np.asarray(connectivity, dtype=np.int64)].reshape(-1, n_nodes)[:, _GMSH_TO_VTK[n_nodes]]

    triangle, n_facet = {1: (2, 3), 2: (9, 6)}[order]
    # gmsh orders a six-node triangle 01, 12, 20: our 01, 12, 02 are the same nodes.
    surfaces: dict[str, IntArray] = {}
    for name, faces in named.items():
        parts = [gmsh.model.mesh.getElementsByType(triangle, face)[1] for face in faces]
        surfaces[name] = number[np.concatenate(parts).astype(np.int64)].reshape(-1, n_facet)
    return Mesh.of_tetrahedra(points, cells, surfaces, {"housing": np.arange(len(cells))})
