"""Mesh resolution: element size against the shortest structural wave, and locking of linear tetrahedra."""

from dataclasses import dataclass

import numpy as np

from meshes.ailments import MeshDefect, mesh_defect
from meshes.lengths import length_text
from meshes.mesh import Mesh
from meshes.quality import edge_lengths

# Longest edge of elements of order 1 and 2, as a part of the shortest wave: the usual rule of six nodes for each wave.
_PARTS = {1: 6.0, 2: 3.0}
# Too stiff in bending by this times (edge / thickness)²: measured with bars of one to four tetrahedra through the
# thickness, where it lies between 2.6 and 2.9.
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
        # Of a quadrilateral by its diagonals, of a triangle by two sides: half the product in both.
        last = corners[:, -1] - corners[:, 1] if block.of.n_corners == 4 else corners[:, 2] - corners[:, 1]
        area += 0.5 * float(np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], last), axis=1).sum())
    return 2.0 * float(mesh.corner_volumes.sum()) / area


def resolution_defects(mesh: Mesh, wave: WaveCarrier) -> tuple[MeshDefect, ...]:
    """Find elements that are too large or of too low an order, with the size that suffices."""
    thickness = wall_thickness(mesh)
    length = wave.shortest_wave(thickness)
    longest = np.concatenate([edge_lengths(mesh.points, block).max(axis=1) for block in mesh.blocks])
    orders = np.concatenate([np.full(len(block), block.of.order) for block in mesh.blocks])
    defects = []
    for order, part in _PARTS.items():
        coarse = (orders == order) & (longest > length / part)
        if coarse.any():
            number, worst = int(coarse.sum()), int(np.argmax(np.where(coarse, longest, 0.0)))
            what = (
                f"{number} of {mesh.n_elements} elements have edges longer than 1/{part:g} of the shortest wave, "
                f"{length_text(length)} at {wave.frequency / (2.0 * np.pi):.4g} Hz in walls about "
                f"{length_text(thickness)} thick"
            )
            advice = (
                f"modes near that frequency come out too high; use elements of at most {length_text(length / part)}"
            )
            which = f"the worst of {length_text(longest[worst])} at"
            defects.append(mesh_defect("size", "warning", what, advice, number, mesh.centers[worst], which=which))
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
