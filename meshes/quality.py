"""Mesh quality: edge lengths and shape numbers of the elements, and resolution of structural waves.

The resolution compares the element size with the shortest structural wave, and finds locking of linear tetrahedra.
"""

from dataclasses import dataclass

import numpy as np

from gearwhine.meshes.elements import KINDS, ElementBlock
from gearwhine.meshes.lengths import length_text
from gearwhine.meshes.mesh import Mesh, MeshDefect, mesh_defect
from gearwhine.meshes.shape_functions import determinants, jacobians, shape_functions
from gearwhine.numerics.arrays import FloatArray

# Edges of a corner tetrahedron of the ideal element, as columns: of a regular tetrahedron, of a cube and of a
# right prism on an equilateral triangle, all of unit edge. A mean ratio does not depend on their size.
_HALF, _ROOT = 0.5, np.sqrt(3.0) / 2.0
_IDEAL = {
    "tetra": np.array([[1.0, _HALF, _HALF], [0.0, _ROOT, _ROOT / 3.0], [0.0, 0.0, np.sqrt(2.0 / 3.0)]]),
    "hexahedron": np.eye(3),
    "wedge": np.array([[1.0, _HALF, 0.0], [0.0, _ROOT, 0.0], [0.0, 0.0, 1.0]]),
}


@dataclass(frozen=True)
class MeshQuality:
    """Sizes and shapes of the elements.

    Attributes
    ----------
    volume : float
        Sum of the elements' volumes between their corners [m³].
    edge_length : tuple of float
        Smallest, median and largest edge [m].
    shape : tuple of float
        Smallest and median shape number; see :func:`shape_numbers`.
    """

    volume: float
    edge_length: tuple[float, float, float]
    shape: tuple[float, float]


def mesh_quality(mesh: Mesh) -> MeshQuality:
    """Measure the elements of a mesh by their corners."""
    edges = np.concatenate([edge_lengths(mesh.points, block).ravel() for block in mesh.blocks])
    shape = shape_numbers(mesh)
    return MeshQuality(
        volume=float(mesh.corner_volumes.sum()),
        edge_length=(float(edges.min()), float(np.median(edges)), float(edges.max())),
        shape=(float(shape.min()), float(np.median(shape))),
    )


def edge_lengths(points: FloatArray, block: ElementBlock) -> FloatArray:
    """Distance between the ends of each edge [m], shape (n_elements, n_edges)."""
    ends = points[block.nodes[:, block.of.edges]]
    return np.asarray(np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2))


def shape_numbers(mesh: Mesh) -> FloatArray:
    """Compute the shape number of each element, 1 for the ideal and 0 for a flat one, shape (n_elements,).

    The mean ratio 3 det(S)^(2/3) / |S|² (Liu and Joe 1994; Knupp 2001 for bricks and wedges), S the map from the
    ideal element -- regular tetrahedron, cube, prism on an equilateral triangle -- and |S| its Frobenius norm; the
    least over the element's corners, and 0 where the element is inverted at a corner.
    """
    return np.concatenate([_block_shape(mesh.points, block) for block in mesh.blocks])


def _block_shape(points: FloatArray, block: ElementBlock) -> FloatArray:
    corners = block.of.corners
    places = np.array(KINDS[corners].places).T
    if corners == "tetra":
        places = places[:, :1]  # the map is affine, so that one corner is enough
    _, gradients = shape_functions(corners, places)
    jacobian = jacobians(points, block.corners, gradients)
    mapped = np.einsum("ijeq,jk->ikeq", jacobian, np.linalg.inv(_IDEAL[corners]))
    volume = np.maximum(determinants(mapped), 0.0)
    return np.asarray((3.0 * np.cbrt(volume) ** 2 / (mapped**2).sum(axis=(0, 1))).min(axis=1))


# Longest edge of elements of order 1 and 2, as a part of the shortest wave. Three elements of order 2 to a wave, as
# the rule of six nodes has it, make the modes of a thin-walled box 15 to 30 % too high, and eight about 3 %.
_PARTS = {1: 16.0, 2: 8.0}
# Relative excess stiffness in bending over (edge / thickness)²: measured with bars of one to four tetrahedra through
# the thickness, where it lies between 2.6 and 2.9.
_LOCKING = 2.8


@dataclass(frozen=True)
class WaveCarrier:
    """Material and highest frequency, which determine the shortest wavelength.

    Attributes
    ----------
    youngs_modulus : float
        E [Pa].
    poisson_ratio : float
        ν.
    density : float
        ρ [kg/m³].
    frequency : float
        Highest circular frequency of interest [rad/s].
    """

    youngs_modulus: float
    poisson_ratio: float
    density: float
    frequency: float

    def shortest_wave(self, thickness: float) -> float:
        """Compute the shortest wavelength [m] in a wall of a thickness [m].

        Bending waves are the slowest, λ = 2π (E t² / (12 (1 - ν²) ρ))^(1/4) / √ω of Kirchhoff's plate, until in thick
        walls or at high frequencies shear waves are, λ = 2π √(G / ρ) / ω (Cremer, Heckl, Petersson: Structure-Borne
        Sound, chapter 3).
        """
        e, nu, rho, omega = self.youngs_modulus, self.poisson_ratio, self.density, self.frequency
        bending = (e * thickness**2 / (12.0 * (1.0 - nu**2) * rho)) ** 0.25 / np.sqrt(omega)
        shear = np.sqrt(e / (2.0 * (1.0 + nu)) / rho) / omega
        return float(2.0 * np.pi * min(bending, shear))


def wall_thickness(mesh: Mesh) -> float:
    """Estimate the mean wall thickness [m]: twice the volume over the surface, exact for a wide plate."""
    area = 0.0
    for block in mesh.boundary:
        corners = mesh.points[block.corners]
        # The area of a quadrilateral by its diagonals, of a triangle by two sides: half the product in both.
        last = corners[:, -1] - corners[:, 1] if block.of.n_corners == 4 else corners[:, 2] - corners[:, 1]
        area += 0.5 * float(np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], last), axis=1).sum())
    return 2.0 * float(mesh.corner_volumes.sum()) / area


def resolving_size(wave: float, order: int) -> float:
    """Longest edge of elements of an order that resolve a wave [m]."""
    return wave / _PARTS[order]


def resolution_defects(mesh: Mesh, wave: WaveCarrier) -> tuple[MeshDefect, ...]:
    """Find elements that are too large or of too low an order, with the size that suffices."""
    thickness = wall_thickness(mesh)
    length = wave.shortest_wave(thickness)
    longest = np.concatenate([edge_lengths(mesh.points, block).max(axis=1) for block in mesh.blocks])
    orders = np.concatenate([np.full(len(block), block.of.order) for block in mesh.blocks])
    defects = []
    for order, part in _PARTS.items():
        coarse = (orders == order) & (longest > resolving_size(length, order))
        if coarse.any():
            number, worst = int(coarse.sum()), int(np.argmax(np.where(coarse, longest, 0.0)))
            finding = (
                f"{number} of {mesh.n_elements} elements have edges longer than 1/{part:g} of the shortest wave, "
                f"{length_text(length)} at {wave.frequency / (2.0 * np.pi):.4g} Hz in walls about "
                f"{length_text(thickness)} thick"
            )
            enough = length_text(resolving_size(length, order))
            advice = f"modes near that frequency come out too high; use elements of at most {enough}"
            which = f"the worst of {length_text(longest[worst])} at"
            defects.append(mesh_defect("size", "warning", finding, advice, number, mesh.centers[worst], which=which))
    defects += _locking(mesh, thickness)
    return tuple(defects)


def _locking(mesh: Mesh, thickness: float) -> list[MeshDefect]:
    """Locking of four-node tetrahedra, whose strain is constant, in bending."""
    first, simple, edges = 0, [], []
    for block in mesh.blocks:
        if block.kind == "tetra":
            simple.append(np.arange(first, first + len(block)))
            edges.append(edge_lengths(mesh.points, block).ravel())
        first += len(block)
    if not simple:
        return []
    members: np.ndarray = np.concatenate(simple)
    edge = float(np.median(np.concatenate(edges)))
    excess = locking_excess(edge, thickness)
    high = np.sqrt(1.0 + excess) - 1.0
    message = (
        f"{len(members)} elements are four-node tetrahedra: with edges of {length_text(edge)} in walls about "
        f"{length_text(thickness)} thick these are about {_percent(excess)} too stiff in bending, and its "
        f"frequencies {_percent(high)} too high; use ten-node ones"
    )
    return [MeshDefect("locking", "warning", message, len(members), mesh.centers[members[0]])]


def locking_excess(edge: float, thickness: float) -> float:
    """Relative excess stiffness in bending of four-node tetrahedra of an edge length in a wall, approximately."""
    return _LOCKING * (edge / thickness) ** 2


def _percent(part: float) -> str:
    return f"{float(f'{100 * part:.2g}'):g} %"
