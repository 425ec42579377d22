"""Numbers that say whether a mesh can be trusted."""

from dataclasses import dataclass

import numpy as np

from meshes.mesh import Mesh

_EDGES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])


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
        Smallest and median shape number, 1 for the regular tetrahedron and 0 for a flat one:
        ``12 (3 V)^(2/3) / sum(edge²)``, the mean-ratio measure of Liu and Joe (1994).
    """

    volume: float
    edge_length: tuple[float, float, float]
    shape: tuple[float, float]


def mesh_quality(mesh: Mesh) -> MeshQuality:
    """Measure the elements of a mesh by their corners."""
    corners = mesh.points[mesh.cells[:, :4]]
    edges = np.linalg.norm(corners[:, _EDGES[:, 0]] - corners[:, _EDGES[:, 1]], axis=2)
    volumes = mesh.corner_volumes
    shape = 12.0 * (3.0 * volumes) ** (2.0 / 3.0) / (edges**2).sum(axis=1)
    return MeshQuality(
        volume=float(volumes.sum()),
        edge_length=(float(edges.min()), float(np.median(edges)), float(edges.max())),
        shape=(float(shape.min()), float(np.median(shape))),
    )
