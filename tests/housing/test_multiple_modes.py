"""Double and triple modes of free cubes and rings, complete in each of thirty random runs.

The cube's group of symmetries has representations of one, two and three dimensions, the ring's of one and two, and so
many modes share one frequency. Meshes that have the symmetry themselves (grids of bricks; rings of equal sectors) have
multiple modes that are so to rounding. Each run draws size, material, kind and number of elements, place and
orientation in space, limit, number of modes and backend. Two proofs, apart from the certificate: all eigenvalues of the
same matrices by dense algebra; and that every symmetry of the body maps the space of the modes found onto itself, which
it cannot where one of a pair or a triple is missing.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
import pytest
from scipy import linalg
from scipy.spatial import KDTree

from gearwhine.housing import Material, ModeSet, assemble, solve_modes
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.modes.certificate import OVERLAP_BOUND, RESIDUAL_BOUND
from gearwhine.meshes import ElementBlock, Mesh
from gearwhine.meshes.gmsh_meshing import collect, gmsh_session, mesh_solids
from gearwhine.numerics.arrays import FloatArray

Blocks = Callable[..., Mesh]

RUNS = 10  # of either shape
SPREAD = 1e-9  # of the frequencies of one multiple mode, as a part of them
SPLIT = 1e-6  # frequencies farther apart, as a part of them, are different modes
DISTINCT = 1e-3  # part of the highest eigenvalue found: a gap this wide always ends a search by number
# By kind the fewest and the most cells: along a cube's side, round a ring.
CUBES = {"hexahedron": (3, 4), "hexahedron20": (2, 2), "hexahedron27": (2, 2), "tetra10": (1, 1), "tetra": (1, 2)}
RINGS = {"hexahedron": (7, 24), "hexahedron20": (5, 10), "hexahedron27": (5, 7), "wedge15": (5, 10), "wedge": (9, 24)}


@dataclass(frozen=True)
class Body:
    """A symmetric body, somewhere in space, with generators of its group of rotations."""

    mesh: Mesh
    matrices: Matrices
    turns: tuple[tuple[npt.NDArray[np.int64], FloatArray], ...]  # where each node goes, and the rotation
    values: FloatArray  # all eigenvalues, ascending [rad²/s²]

    def groups(self, closeness: float = SPLIT) -> list[int]:
        """Numbers of modes at which a multiple mode ends."""
        roots = np.sqrt(self.values[6:])
        ends = 7 + np.flatnonzero(np.diff(roots) > closeness * roots[1:])
        return [6, *ends.tolist()]


def _cube(rng: np.random.Generator, block: Blocks, block_of: Blocks) -> Body:
    kind = str(rng.choice(list(CUBES)))
    cells = int(rng.integers(*CUBES[kind], endpoint=True))
    side = 10.0 ** rng.uniform(-2.5, 1.0)
    if kind.startswith("tetra"):
        mesh = block((side,) * 3, (cells,) * 3, 2 if kind == "tetra10" else 1)
    else:
        mesh = block_of(kind, (side,) * 3, (cells,) * 3)
    mesh = replace(mesh, points=mesh.points - side / 2, surfaces={})
    return _placed(rng, mesh, side, (_rotation(2, np.pi / 2), _rotation(0, np.pi / 2)))


def _ring(rng: np.random.Generator, block: Blocks, block_of: Blocks) -> Body:
    kind = str(rng.choice(list(RINGS)))
    sectors = int(rng.integers(*RINGS[kind], endpoint=True))
    radius = 10.0 ** rng.uniform(-2.5, 1.0)
    thickness, length = radius * rng.uniform(0.1, 0.5, 2)

    def bend(points: FloatArray) -> FloatArray:
        away, angle = radius + thickness * (points[:, 0] - 0.5), 2 * np.pi * points[:, 1]
        return np.stack([away * np.cos(angle), away * np.sin(angle), length * (points[:, 2] - 0.5)], axis=1)

    mesh = _closed(block_of(kind, cells=(1, sectors, 1), bend=bend), 1e-6 * radius)
    # A half turn about x only where the cut into elements has it; wedges are cut one way round.
    turns = [_rotation(2, 2 * np.pi / sectors)]
    if kind.startswith("hexahedron"):
        turns.append(_rotation(0, np.pi))
    return _placed(rng, mesh, radius, tuple(turns))


def _closed(mesh: Mesh, slack: float) -> Mesh:
    """The mesh with nodes that coincide, at the seam of a ring, made one."""
    twin = np.arange(len(mesh.points))
    pairs = KDTree(mesh.points).query_pairs(slack, output_type="ndarray")
    twin[pairs.max(axis=1)] = pairs.min(axis=1)
    kept, number = np.unique(twin, return_inverse=True)
    return Mesh(mesh.points[kept], tuple(ElementBlock(block.kind, number[block.nodes]) for block in mesh.blocks))


def _rotation(axis: int, angle: float) -> FloatArray:
    first, second = (axis + 1) % 3, (axis + 2) % 3
    turn = np.eye(3)
    turn[[first, second], [first, second]] = np.cos(angle)
    turn[[first, second], [second, first]] = -np.sin(angle), np.sin(angle)
    return turn


def _placed(rng: np.random.Generator, mesh: Mesh, size: float, turns: tuple[FloatArray, ...]) -> Body:
    """The body in random orientation, at a random place, of a random material."""
    tree = KDTree(mesh.points)
    images = []
    for turn in turns:
        distance, image = tree.query(mesh.points @ turn.T)
        assert distance.max() < 1e-9 * size
        images.append(image)
    frame = linalg.qr(rng.standard_normal((3, 3)))[0]
    frame *= linalg.det(frame)  # a rotation, not a mirror
    placed = replace(mesh, points=mesh.points @ frame.T + rng.uniform(-2 * size, 2 * size, 3))
    material = Material(10.0 ** rng.uniform(9.0, 11.6), rng.uniform(0.0, 0.45), 10.0 ** rng.uniform(2.7, 4.3))
    matrices = assemble(placed, material)
    values = linalg.eigh(matrices.stiffness.toarray(), matrices.mass.toarray(), eigvals_only=True)
    own = tuple((image, frame @ turn @ frame.T) for image, turn in zip(images, turns, strict=True))
    return Body(placed, matrices, own, values)


def _check(body: Body, modes: ModeSet) -> None:
    """Everything but the number of modes."""
    certificate, roots = modes.certificate, modes.frequencies
    assert certificate.complete
    assert certificate.expected == certificate.found == len(roots)
    assert certificate.max_residual < RESIDUAL_BOUND
    assert certificate.max_overlap < OVERLAP_BOUND
    assert (roots[:6] == 0.0).all()
    dense = np.sqrt(body.values[6 : len(roots)])
    np.testing.assert_allclose(roots[6:], dense, rtol=SPREAD)
    ends = [end for end in body.groups() if end <= len(roots)]
    for begin, end in pairwise(ends):
        assert np.ptp(roots[begin:end]) < SPREAD * roots[begin]
    inertia = body.matrices.mass @ modes.shapes.reshape(len(roots), -1).T
    for image, turn in body.turns:
        turned = np.empty_like(modes.shapes)
        turned[:, image] = modes.shapes @ turn.T
        kept = np.linalg.norm(turned.reshape(len(roots), -1) @ inertia, axis=1)
        np.testing.assert_allclose(kept, 1.0, atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("run", range(RUNS))
@pytest.mark.parametrize(("shape", "most"), [(_cube, 3), (_ring, 2)], ids=["cube", "ring"])
def test_multiple_modes_come_complete_by_limit_and_by_number(
    block: Blocks, block_of: Blocks, shape: Callable[..., Body], most: int, run: int
) -> None:
    rng = np.random.default_rng(run)
    body = shape(rng, block, block_of)
    backend: Literal["rslab", "superlu"] = "superlu" if rng.random() < 0.2 else "rslab"
    ends = [end for end in body.groups() if end <= min(60, len(body.values) // 2)]
    sizes = np.diff(ends)
    assert set(sizes) <= set(range(1, most + 1))
    assert most in sizes

    # Anywhere in the gap behind a mode, often hard beside one of its two ends.
    place = int(rng.integers(1, len(ends) - 1))
    low, high = np.sqrt(body.values[ends[place] - 1 : ends[place] + 1])
    part = rng.choice([rng.uniform(0.1, 0.9), 1e-3, 1.0 - 1e-3])
    below = solve_modes(body.matrices, frequency_limit=float(low + part * (high - low)), backend=backend)
    assert len(below.frequencies) == ends[place]
    _check(body, below)

    # Within a multiple mode, so that the number asked for would split it.
    manifold = int(rng.choice(np.flatnonzero(sizes > 1)))
    asked = int(rng.integers(ends[manifold] + 1, ends[manifold + 1]))
    lowest = solve_modes(body.matrices, count=asked, backend=backend)
    found = len(lowest.frequencies)
    assert found in body.groups()
    assert found >= ends[manifold + 1]
    gap = body.values[ends[manifold + 1]] - body.values[ends[manifold + 1] - 1]
    if gap > DISTINCT * body.values[found]:
        assert found == ends[manifold + 1]
    _check(body, lowest)


def test_modes_more_manifold_than_the_block_is_wide(block_of: Blocks) -> None:
    """Five cubes apart from each other: thirty rigid motions, and every elastic mode of one cube five times."""
    cube = block_of("hexahedron20", (0.1, 0.1, 0.1), (2, 2, 2))
    (elements,) = cube.blocks
    points = np.vstack([cube.points + [0.3 * place, 0.0, 0.0] for place in range(5)])
    nodes = np.vstack([elements.nodes + place * len(cube.points) for place in range(5)])
    steel = Material(207e9, 0.3, 7850.0)
    one, five = (assemble(mesh, steel) for mesh in (cube, Mesh(points, (ElementBlock(elements.kind, nodes),))))
    values = linalg.eigh(one.stiffness.toarray(), one.mass.toarray(), eigvals_only=True)
    values[:6] = 0.0
    expected = np.repeat(np.sqrt(values), 5)
    assert expected[30] == pytest.approx(expected[39], rel=1e-9)
    assert expected[40] > 1.001 * expected[39]
    for asked in ({"count": 31}, {"frequency_limit": 0.5 * float(expected[39] + expected[40])}):
        modes = solve_modes(five, **asked)
        assert modes.certificate.complete
        assert (modes.frequencies[:30] == 0.0).all()
        np.testing.assert_allclose(modes.frequencies[30:], expected[30:40], rtol=SPREAD)


def _gmsh_cube(gmsh: Any, rng: np.random.Generator) -> float:
    gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    return float(rng.uniform(0.4, 0.7))


def _gmsh_ring(gmsh: Any, rng: np.random.Generator) -> float:
    thickness, length = rng.uniform(0.25, 0.5, 2)
    outer, inner = (gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, length, 1 + side * thickness / 2) for side in (1, -1))
    gmsh.model.occ.cut([(3, outer)], [(3, inner)])
    return float(rng.uniform(0.6, 0.8))


@pytest.mark.parametrize("run", range(3))
@pytest.mark.parametrize("shape", [_gmsh_cube, _gmsh_ring], ids=["cube", "ring"])
def test_modes_that_an_irregular_mesh_has_split_come_complete(shape: Callable[..., float], run: int) -> None:
    """On the mesher's tetrahedra the members of a multiple mode are close, each a mode of its own."""
    rng = np.random.default_rng(run)
    with gmsh_session("body") as gmsh:
        size = shape(gmsh, rng)
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.RandomSeed", run)
        mesh_solids(gmsh, size, 2)
        mesh = collect(gmsh, 2, {}, {}).mesh()
    body = _placed(rng, mesh, 1.0, ())
    roots = np.sqrt(body.values[6:12])
    assert np.count_nonzero(np.diff(roots) < 0.01 * roots[1:]) >= 2
    for number in rng.choice(5, 2, replace=False):
        below = solve_modes(body.matrices, frequency_limit=float(0.5 * (roots[number] + roots[number + 1])))
        assert len(below.frequencies) == 7 + number
        lowest = solve_modes(body.matrices, count=7 + int(number))
        # Members that differ by less than the gap that a search by number needs come together.
        assert 7 + number <= len(lowest.frequencies) <= 9 + number
        _check(body, below)
        _check(body, lowest)
