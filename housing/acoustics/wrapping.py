"""Wrapping of a housing's mesh in a closed radiating surface of even triangles.

The skin is marked in cells of a grid. Air that a ball as wide as the largest hole to be closed can reach from outside
is outside; what remains is a cavity with its holes where little of its border is open, and else a concave corner or a
gap between ribs, which stays outside. The border of the cells is turned into a mesh with one vertex for each corner of
cells that sees both sides (surface nets). Its vertices are then moved onto the skin: each face takes the plane of the
skin's point that is nearest in place and direction, and each vertex minimises the sum of squared distances from the
planes of its faces, so that edges and corners of the housing are kept; what the planes leave free is smoothed.

Sources: S. F. F. Gibson, "Constrained elastic surface nets: generating smooth surfaces from binary segmented data",
MICCAI 1998, Lecture Notes in Computer Science 1496, 888-898 (the mesh); T. Ju, F. Losasso, S. Schaefer and J. Warren,
"Dual contouring of Hermite data", ACM Transactions on Graphics 21 (2002), 339-346 (the squared distances from planes).
"""

from dataclasses import dataclass
from functools import cache, cached_property
from itertools import product

import numpy as np
from scipy import ndimage, sparse
from scipy.spatial import cKDTree

from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.housing.acoustics.skin import skin_of
from gearwhine.housing.errors import HousingError, TriangleSizeError
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import BoolArray, FloatArray, IntArray
from gearwhine.numerics.progress import Progress, silent

_FINE_CELLS_PER_CELL = 3  # fine cells along a cell of the wrap
_MOST_CELLS = 3e7  # cells of the fine grid: about 2 GB
_FILLED = 0.3  # least part of a cell's fine cells that makes it solid: a plate of one layer is a third
_LARGEST_OPEN_BORDER = 0.2  # largest open part of the border of a cavity: a cube without its lid has a sixth
_WIDER = 1.4  # steps of the ball that seeks a leak
_INSIDE = 0.15  # part of the whole above which a cavity that is open is a leak
_ROUNDS = 14  # rounds that move the vertices onto the skin
_TURN = 0.7  # cells that a right angle between face and skin counts as distance, over sqrt(2)
_LEAST_SKIN_COSINE = 0.3  # least cosine between a face and the skin that it is moved to
_LEAST_FACE_WEIGHT = 0.2  # square cells added to each face's area where faces are weighted
_RANK = 0.05  # part of the largest eigenvalue below which the planes of a vertex leave a direction free

_FIRST_REACH, _REACH = 1.5, 0.8  # cells from the skin within which faces are moved onto it: at first, and later
_FOLD = -0.8  # cosine between neighbours below which the surface is folded
_UNFOLDINGS = 20
_MENDINGS = 3  # rounds of mending badly shaped triangles
_POOR = 0.55  # shape below which a triangle is mended: 1 of an equilateral one
_COLLAPSIBLE_EDGE = 0.6  # cells below which an edge may collapse
_HALVED_EDGE = 1.7  # cells above which an edge is halved in the end
_LARGEST_MENDING_MOVE = 0.1  # cells that mending may move the surface; shape below which a triangle has no plane


def wrap(mesh: Mesh, edge: float, close_holes: float, progress: Progress = silent) -> RadiatingSurface:
    """Wrap a housing in a closed surface of triangles of about the same size.

    Parameters
    ----------
    mesh : Mesh
        The housing's finite elements.
    edge : float
        Mean edge of the triangles [m].
    close_holes : float
        Diameter of the largest bore or opening of the cavity that is capped [m].
    progress : callable
        Called with the words of each step, and its completed fraction in long ones.

    Returns
    -------
    RadiatingSurface
        Closed surface.

    Raises
    ------
    TriangleSizeError
        Where the edge takes too many cells.
    HousingError
        Where a size is not positive, where an opening wider than `close_holes` lets the air
        inside, or where the surface does not close.
    """
    if not (0.0 < edge < np.inf and 0.0 <= close_holes < np.inf):
        raise HousingError(
            f"a wrap with an edge of {1e3 * edge:.4g} mm and holes of {1e3 * close_holes:.4g} mm; expected a positive "
            "edge, and 0 or more for close_holes"
        )
    cell = edge / 1.05  # two edges of a triangle are a cell long, and one is a diagonal
    fine = cell / _FINE_CELLS_PER_CELL
    skin = skin_of(mesh, mesh.boundary)
    low = mesh.bounds[0] - 0.5 * (np.ceil(np.ptp(mesh.bounds, axis=0) / cell) * cell - np.ptp(mesh.bounds, axis=0))
    around = _FINE_CELLS_PER_CELL * (2 + int(np.ceil(0.5 * close_holes / cell)))
    shape = np.ceil(np.ptp(mesh.bounds, axis=0) / cell - 1e-9).astype(np.int64) * _FINE_CELLS_PER_CELL + 2 * around
    if np.prod(shape.astype(np.float64)) > _MOST_CELLS:
        raise TriangleSizeError(
            f"a wrap with an edge of {1e3 * edge:.4g} mm takes {np.prod(shape.astype(np.float64)):.3g} cells; expected "
            f"at most {_MOST_CELLS:.3g}: give a longer edge"
        )
    progress("cells of the housing")
    origin = low - around * fine
    hit = np.zeros(shape, dtype=bool)
    hit[tuple(np.floor((skin.samples(0.6 * fine)[0] - origin) / fine).astype(np.int64).T)] = True
    solid = _filled(_closed(hit), 0.5 * close_holes / fine + 1.0)
    blocks = solid.reshape(
        shape[0] // _FINE_CELLS_PER_CELL,
        _FINE_CELLS_PER_CELL,
        shape[1] // _FINE_CELLS_PER_CELL,
        _FINE_CELLS_PER_CELL,
        shape[2] // _FINE_CELLS_PER_CELL,
        _FINE_CELLS_PER_CELL,
    )
    coarse = _manifold(_large_bodies(~_outside(blocks.mean(axis=(1, 3, 5)) < _FILLED)))
    progress("openings")
    _require_tight(coarse, origin, cell, close_holes)
    points, quads = _surface_net(coarse)
    places, owners = skin.samples(cell / 3.0)
    # A sample with air before it is an outer one.
    ahead = np.floor((places + 1.5 * fine * skin.normals[owners] - origin) / fine).astype(np.int64)
    outer = ~solid[tuple(ahead.T)]
    surface = RadiatingSurface(
        *_on_skin(origin + cell * points, quads, _OuterSkin(places[outer], skin.normals[owners[outer]], cell), progress)
    )
    surface.require_closed()
    return surface


def _outside(free: BoolArray) -> BoolArray:
    """Free cells that are connected through faces with the corner of the grid."""
    labels, _ = ndimage.label(free)
    return np.asarray(labels == labels[0, 0, 0])


def _large_bodies(solid: BoolArray) -> BoolArray:
    """Leave out bodies of less than a hundredth of the largest: bits of parts that are thinner than the cells."""
    labels, _ = ndimage.label(solid)
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    return np.asarray((sizes >= 0.01 * sizes.max())[labels] & (labels > 0))


def _closed(cells: BoolArray) -> BoolArray:
    """Morphological closing of cells by a cube of three cells a side."""
    grown = ndimage.maximum_filter(cells.view(np.uint8), 3)
    return np.asarray(ndimage.minimum_filter(grown, 3).view(bool))


def _filled(solid: BoolArray, radius: float) -> BoolArray:
    """Fill the cavities that a ball of a radius [cells] cannot enter, with their holes."""
    free = ~solid
    ball = _outside(ndimage.distance_transform_edt(free) >= radius)
    air = ndimage.distance_transform_edt(~ball) < radius
    rest = free & ~air
    # A gap of one cell between a hole's rim and the ball would join the cavity with corners outside.
    cores, count = ndimage.label(ndimage.binary_erosion(rest))
    regions = np.where(cores > 0, cores, np.where(rest, ndimage.maximum_filter(cores, 3), 0))
    open_faces, all_faces = np.zeros(count + 1), np.zeros(count + 1)
    for axis in range(3):
        for near, far in ((slice(None, -1), slice(1, None)), (slice(1, None), slice(None, -1))):
            region = regions[(slice(None),) * axis + (near,)]
            other = tuple([slice(None)] * axis + [far])
            border = (region > 0) & (regions[other] != region)
            all_faces += np.bincount(region[border], minlength=count + 1)
            open_faces += np.bincount(region[border & free[other]], minlength=count + 1)
    enclosed = open_faces < _LARGEST_OPEN_BORDER * all_faces
    enclosed[0] = False
    return np.asarray(~_outside(free & ~enclosed[regions]))


def _require_tight(solid: BoolArray, origin: FloatArray, cell: float, close_holes: float) -> None:
    """Refuse a wrap with an inside that is open to the air.

    The wrap has one where a ball wider than the holes to be closed finds a large cavity that it cannot enter.
    """
    radius, largest = max(0.5 * close_holes / cell, 1.0), 0.5 * max(np.ptp(np.argwhere(solid), axis=0) + 1)
    tight = radius
    while (tight := _WIDER * tight) < largest:
        cavity, opening = _large_cavity(solid, tight)
        if cavity == 0.0:
            continue
        leaking = tight / _WIDER
        for _ in range(6):
            middle = 0.5 * (leaking + tight)
            larger = _large_cavity(solid, middle)
            if larger[0] > 0.0:
                tight, opening = middle, larger[1]
            else:
                leaking = middle
        x, y, z = 1e3 * (origin + cell * (opening + 0.5))
        raise HousingError(
            f"an opening near ({x:.4g}, {y:.4g}, {z:.4g}) mm wider than close_holes of {1e3 * close_holes:.4g} mm lets "
            f"the air into a cavity of {1e3 * cavity * cell**3:.3g} l; expected the inside to be closed: give "
            f"close_holes of about {5.0 * np.ceil(2e3 * tight * cell / 5.0):.4g} mm"
        )


def _large_cavity(solid: BoolArray, radius: float) -> tuple[float, FloatArray]:
    """Volume of the largest cavity that a ball cannot enter, and the middle of its widest opening [cells].

    The volume is 0 where it is a small part of the whole.
    """
    around = int(np.ceil(radius)) + 2
    wide = np.pad(solid, around)
    filled = _filled(wide, radius)
    labels, count = ndimage.label(filled & ~wide)
    sizes = np.bincount(labels.ravel(), minlength=count + 1)[1:]
    if count == 0 or sizes.max() < _INSIDE * np.count_nonzero(filled):
        return 0.0, np.zeros(3)
    cavity = labels == 1 + int(np.argmax(sizes))
    rim, count = ndimage.label(cavity & ndimage.binary_dilation(~filled), np.ones((3, 3, 3)))
    widest = 1 + int(np.argmax(np.bincount(rim.ravel(), minlength=count + 1)[1:]))
    return float(sizes.max()), np.argwhere(rim == widest).mean(axis=0) - around


_BLOCK = np.array(list(product((0, 1), repeat=3)))  # places of the cells of a block of 2 x 2 x 2


@cache
def _repairs() -> IntArray:
    """For each pattern of solid cells in a block of eight, the solid cells that make the surface manifold there.

    Solid cells and others then each hang together through faces: the surface passes once.
    """
    near = np.abs(_BLOCK[:, None] - _BLOCK[None]).sum(axis=2) == 1

    def joined(pattern: int) -> bool:
        members = [cell for cell in range(8) if pattern >> cell & 1]
        reached = members[:1]
        for cell in reached:
            reached += [other for other in members if near[cell, other] and other not in reached]
        return len(reached) == len(members)

    sound = np.array([joined(pattern) and joined(255 - pattern) for pattern in range(256)])
    patterns = np.arange(256)
    sizes = np.array([bin(pattern).count("1") for pattern in range(256)])
    repaired = []
    for pattern in range(256):
        possible = patterns[sound & ((patterns & pattern) == pattern)]
        repaired.append(possible[np.argmin(sizes[possible])])
    return np.array(repaired)


def _patterns(solid: BoolArray) -> IntArray:
    """Pattern of the solid cells in each block of eight, as bits."""
    nx, ny, nz = (length - 1 for length in solid.shape)
    total = np.zeros((nx, ny, nz), dtype=np.int64)
    for bit, (i, j, k) in enumerate(_BLOCK.tolist()):
        total += solid[i : i + nx, j : j + ny, k : k + nz].astype(np.int64) << bit
    return total


def _manifold(solid: BoolArray) -> BoolArray:
    """Fill cells until the border of the solid passes each corner of cells once."""
    solid = solid.copy()
    repairs = _repairs()
    while True:
        patterns = _patterns(solid)
        wrong = np.argwhere(repairs[patterns] != patterns)
        if len(wrong) == 0:
            return ~_outside(~solid)
        wanted = repairs[patterns[tuple(wrong.T)]]
        for bit, offset in enumerate(_BLOCK):
            solid[tuple((wrong[(wanted >> bit & 1) == 1] + offset).T)] = True


def _surface_net(solid: BoolArray) -> tuple[FloatArray, IntArray]:
    """Vertices [cells] and quadrilaterals of the border of solid cells, outward."""
    patterns = _patterns(solid)
    mixed = (patterns > 0) & (patterns < 255)
    number = np.full(mixed.shape, -1, dtype=np.int64)
    number[mixed] = np.arange(np.count_nonzero(mixed))
    faces = []
    for axis in range(3):
        second, third = (axis + 1) % 3, (axis + 2) % 3
        below = np.moveaxis(solid, axis, 0)[:-1]
        above = np.moveaxis(solid, axis, 0)[1:]
        for looks_up in (True, False):
            cells = np.argwhere(below & ~above if looks_up else ~below & above)
            place = np.empty_like(cells)
            rest = [direction for direction in range(3) if direction != axis]
            place[:, axis], place[:, rest[0]], place[:, rest[1]] = cells.T
            ring = []
            for step in ((-1, -1), (0, -1), (0, 0), (-1, 0)):
                corner = place.copy()
                corner[:, second] += step[0]
                corner[:, third] += step[1]
                ring.append(number[tuple(corner.T)])
            faces.append(np.stack(ring if looks_up else ring[::-1], axis=1))
    return np.argwhere(mixed).astype(np.float64) + 1.0, np.concatenate(faces)


@dataclass(frozen=True)
class _OuterSkin:
    """Samples of the skin that the air touches: places [m] and outward normals, shape (n, 3), and the cell [m]."""

    places: FloatArray
    normals: FloatArray
    cell: float

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(np.hstack([self.places, _TURN * self.cell * self.normals]))

    def nearest(self, places: FloatArray, normals: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the place and normal of the sample that is nearest to each place in place and direction."""
        _, sample_numbers = self._tree.query(np.hstack([places, _TURN * self.cell * normals]))
        return self.places[sample_numbers], self.normals[sample_numbers]


def _on_skin(points: FloatArray, quads: IntArray, skin: _OuterSkin, progress: Progress) -> tuple[FloatArray, IntArray]:
    """Move the vertices of a net onto the skin and split its quadrilaterals."""
    for number in range(_ROUNDS):
        progress("vertices onto the skin", number / _ROUNDS)
        points = _moved(points, quads, skin, (_FIRST_REACH if number < _ROUNDS // 3 else _REACH) * skin.cell)
    triangles = _split(points, quads)
    for number in range(_MENDINGS):
        progress("badly shaped triangles", number / _MENDINGS)
        points, triangles = _mended(points, triangles, skin.cell)
        for _ in range(3):
            points = _moved(points, triangles, skin, _REACH * skin.cell)
    return _divided(*_mended(_unfolded(points, triangles), triangles, skin.cell), _HALVED_EDGE * skin.cell)


def _moved(points: FloatArray, faces: IntArray, skin: _OuterSkin, reach: float) -> FloatArray:
    """Move each vertex onto the planes of its faces, and along them to the centroid of its faces.

    Faces farther from the skin than the reach [m], such as faces over holes, have no plane.
    """
    cell = skin.cell
    corners = points[faces]
    center = corners.mean(axis=1)
    last = corners[:, 3] - corners[:, 1] if faces.shape[1] == 4 else corners[:, 2] - corners[:, 1]
    normal = np.cross(corners[:, 2] - corners[:, 0], last)
    area = np.linalg.norm(normal, axis=1)
    normal /= np.maximum(area, 1e-300)[:, None]
    plane, direction = skin.nearest(center, normal)
    agree = (np.linalg.norm(plane - center, axis=1) < reach) & ((direction * normal).sum(axis=1) > _LEAST_SKIN_COSINE)
    share = (
        area + _LEAST_FACE_WEIGHT * cell**2
    )  # a narrow face keeps its say, so that the rims of thin plates do not shrink
    weight = np.where(agree, share / cell**2, 0.0)
    rows = np.repeat(np.arange(len(faces)), faces.shape[1])
    incident = sparse.csr_array((np.ones(faces.size), (faces.ravel(), rows)), shape=(len(points), len(faces)))
    outer = weight[:, None, None] * direction[:, :, None] * direction[:, None]
    matrix = np.asarray(incident @ outer.reshape(-1, 9)).reshape(-1, 3, 3)
    side = incident @ ((weight * (plane * direction).sum(axis=1))[:, None] * direction)
    mean = (incident @ (share[:, None] * center)) / (incident @ share)[:, None]
    values, vectors = np.linalg.eigh(matrix)
    determined = values > _RANK * np.maximum(values[:, -1:], 1e-6)
    inverse = np.where(determined, 1.0 / np.where(determined, values, 1.0), 0.0)
    gap = side - np.einsum("vij,vj->vi", matrix, mean)
    target = mean + np.einsum("vij,vj,vkj,vk->vi", vectors, inverse, vectors, gap, optimize=True)
    step = target - points
    length = np.linalg.norm(step, axis=1, keepdims=True)
    return np.asarray(points + step * np.minimum(1.0, cell / np.maximum(length, 1e-300)))


def _unfolded(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Smooth the vertices of triangles that lie folded upon each other, off the skin."""
    ends = np.concatenate([triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    order = np.lexsort(np.sort(ends, axis=1).T)
    pairs = (order % len(triangles)).reshape(-1, 2)  # each edge of a closed surface has two triangles
    for _ in range(_UNFOLDINGS):
        _, normals = _shapes(points[triangles])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        folded = pairs[np.einsum("ei,ei->e", *normals[pairs.T]) < _FOLD]
        if len(folded) == 0:
            break
        moved = np.unique(triangles[folded])
        around = np.isin(ends[:, 0], moved)
        sums = np.zeros_like(points)
        np.add.at(sums, ends[around, 0], points[ends[around, 1]])
        points = points.copy()
        points[moved] += 0.5 * (sums[moved] / np.bincount(ends[around, 0])[moved, None] - points[moved])
    return points


def _split(points: FloatArray, quads: IntArray) -> IntArray:
    """Split quadrilaterals along the diagonal that leaves the larger least angle."""
    first = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 2, 3)
    second = quads[:, [0, 1, 3, 1, 2, 3]].reshape(-1, 2, 3)
    better = least_angles(points[first]).min(axis=1) >= least_angles(points[second]).min(axis=1)
    return np.asarray(np.where(better[:, None, None], first, second).reshape(-1, 3))


def _mended(points: FloatArray, triangles: IntArray, cell: float) -> tuple[FloatArray, IntArray]:
    """Collapse short edges and flip the long edges of flat triangles.

    Only the surroundings of badly shaped triangles change: an edge collapses where it is short, and is flipped where
    its four points nearly lie in a plane; both only where the worst shape around becomes better and no triangle turns
    over.
    """
    points, corners = points.copy(), [tuple(row) for row in triangles.tolist()]
    around: list[set[int]] = [set() for _ in points]
    for number, triangle in enumerate(corners):
        for vertex in triangle:
            around[vertex].add(number)
    alive = np.ones(len(corners), dtype=bool)
    waiting = np.flatnonzero(_shapes(points[triangles])[0] < _POOR).tolist()
    for number in waiting:
        if not alive[number] or _shapes(points[list(corners[number])])[0] >= _POOR:
            continue
        triangle = corners[number]
        lengths = [float(np.linalg.norm(points[triangle[i]] - points[triangle[(i + 1) % 3]])) for i in range(3)]
        longest, shortest = int(np.argmax(lengths)), int(np.argmin(lengths))
        a, b = triangle[longest], triangle[(longest + 1) % 3]
        if _flip(points, corners, around, number, a, b, cell):
            continue
        a, b = triangle[shortest], triangle[(shortest + 1) % 3]
        if lengths[shortest] < _COLLAPSIBLE_EDGE * cell:
            for gone in _collapse(points, corners, around, a, b, cell):
                alive[gone] = False
    remaining = np.array(corners)[alive]
    used, renumbered = np.unique(remaining, return_inverse=True)
    return points[used], renumbered.reshape(-1, 3)


def _divided(points: FloatArray, triangles: IntArray, longest: float) -> tuple[FloatArray, IntArray]:
    """Halve edges that are longer than a length [m], longest first, without moving the surface.

    The faces of ribs and plates that are a cell or two thick span them with one triangle however wide they are.
    """
    while True:
        ends = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        edges, inverse = np.unique(ends, axis=0, return_inverse=True)
        lengths = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
        if lengths.max() <= longest:
            return points, triangles
        sides = inverse.reshape(-1, 3)  # edge i of a triangle goes from its corner i to the next
        # The longest edge of each triangle, the first of equal ones; an edge that is the longest on both sides is
        # halved.
        order = np.lexsort((np.arange(len(edges)), -lengths))
        rank = np.empty(len(edges), dtype=np.int64)
        rank[order] = np.arange(len(edges))
        best = rank[sides].argmin(axis=1)
        chosen = sides[np.arange(len(sides)), best]
        halved = (np.bincount(chosen, minlength=len(edges)) == 2) & (lengths > longest)
        new = np.full(len(edges), -1, dtype=np.int64)
        new[halved] = len(points) + np.arange(int(halved.sum()))
        points = np.vstack([points, points[edges[halved]].mean(axis=1)])
        cut = halved[chosen]
        turned = np.take_along_axis(triangles[cut], (best[cut, None] + np.arange(3)) % 3, axis=1)
        first, second, third, middle = *turned.T, new[chosen[cut]]
        halves = [np.column_stack([first, middle, third]), np.column_stack([middle, second, third])]
        triangles = np.vstack([triangles[~cut], *halves])


def _flip(
    points: FloatArray, corners: list[tuple[int, ...]], around: list[set[int]], number: int, a: int, b: int, cell: float
) -> bool:
    """Flip the edge from a to b of a triangle, where that helps."""
    (other,) = (around[a] & around[b]) - {number}
    c = next(vertex for vertex in corners[number] if vertex not in (a, b))
    d = next(vertex for vertex in corners[other] if vertex not in (a, b))
    if around[c] & around[d]:
        return False
    old = points[[list(corners[number]), list(corners[other])]]
    new = points[[[a, d, c], [d, b, c]]]
    before, normal = _shapes(old)
    after, turned = _shapes(new)
    total = normal.sum(axis=0)
    offset = abs(float(np.dot(points[d] - points[a], np.cross(points[b] - points[a], points[c] - points[a]))))
    area = float(np.linalg.norm(total))
    if after.min() <= before.min() or (turned @ total).min() <= 0.0 or offset > _LARGEST_MENDING_MOVE * cell * area:
        return False
    corners[number], corners[other] = (a, d, c), (d, b, c)
    around[a].discard(other)
    around[b].discard(number)
    around[c].add(other)
    around[d].add(number)
    return True


def _collapse(
    points: FloatArray, corners: list[tuple[int, ...]], around: list[set[int]], a: int, b: int, cell: float
) -> tuple[int, ...]:
    """Collapse an edge a, b into the best of its ends and its middle where that helps; return the triangles lost."""
    gone = around[a] & around[b]
    ring_a = {vertex for number in around[a] for vertex in corners[number]} - {a, b}
    ring_b = {vertex for number in around[b] for vertex in corners[number]} - {a, b}
    if len(ring_a & ring_b) != 2:  # the surface would touch itself
        return ()
    moved = sorted((around[a] | around[b]) - gone)
    old = np.array([corners[number] for number in moved])
    before, normal = _shapes(points[old])
    lost, lost_normal = _shapes(points[[list(corners[number]) for number in sorted(gone)]])
    # The planes of the triangles around hold the vertex; a triangle that is too flat has none.
    normals = np.concatenate([normal[before > _LARGEST_MENDING_MOVE], lost_normal[lost > _LARGEST_MENDING_MOVE]])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    bases = np.concatenate(
        [
            points[old[before > _LARGEST_MENDING_MOVE, 0]],
            points[[corners[n][0] for n in sorted(gone)]][lost > _LARGEST_MENDING_MOVE],
        ]
    )
    best: tuple[float, FloatArray] | None = None
    for place in (points[a], points[b], 0.5 * (points[a] + points[b])):
        trial = points[old]
        trial[(old == a) | (old == b)] = place
        after, turned = _shapes(trial)
        # A triangle without area has no normal: the cosine times both lengths, which are then zero, needs none.
        along = 0.5 * np.linalg.norm(turned, axis=1) * np.linalg.norm(normal, axis=1)
        sound = ((turned * normal).sum(axis=1) > along) | (before < 0.5 * _POOR)
        is_held = np.abs(((place - bases) * normals).sum(axis=1)).max(initial=0.0) < _LARGEST_MENDING_MOVE * cell
        if is_held and sound.all() and (best is None or after.min() > best[0]):
            best = float(after.min()), place.copy()
    if best is None or best[0] <= min(before.min(), lost.min()):
        return ()
    points[a] = best[1]
    for number in moved:
        corners[number] = tuple(a if vertex == b else vertex for vertex in corners[number])
    around[a] = set(moved)
    around[b] = set()
    for vertex in ring_a | ring_b:
        around[vertex] -= gone
    return tuple(gone)


def _shapes(corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Shape of triangles, 1 of an equilateral one and 0 of a flat one, and their normals of twice the area."""
    normal = np.cross(corners[..., 1, :] - corners[..., 0, :], corners[..., 2, :] - corners[..., 0, :])
    squares = ((corners - np.roll(corners, 1, axis=-2)) ** 2).sum(axis=(-1, -2))
    return np.asarray(np.sqrt(12.0) * np.linalg.norm(normal, axis=-1) / squares), normal


def least_angles(corners: FloatArray) -> FloatArray:
    """Smallest angle of triangles [rad], corners of shape (..., 3, 3)."""
    to, back = np.roll(corners, -1, axis=-2) - corners, np.roll(corners, 1, axis=-2) - corners
    sine = np.linalg.norm(np.cross(to, back), axis=-1)
    return np.asarray(np.arctan2(sine, (to * back).sum(axis=-1)).min(axis=-1))
