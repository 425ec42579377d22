"""Outer skin of a mesh as triangles for pictures and 3D models; scale and file names of drawn modes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.errors import HousingError
from housing.modes import ModeSet
from meshes import Mesh

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

DRAWN_SCALE = 0.07
"""Largest displacement drawn, as a part of the housing's diagonal."""

# Facets by their number of nodes, cut so that middle nodes bend too; each triangle turns the way its facet does.
_CUTS = {
    3: [[0, 1, 2]],
    6: [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
    4: [[0, 1, 2], [0, 2, 3]],
    8: [[0, 4, 7], [4, 1, 5], [5, 2, 6], [6, 3, 7], [4, 5, 6], [4, 6, 7]],
    9: [[0, 4, 8], [4, 1, 8], [1, 5, 8], [5, 2, 8], [2, 6, 8], [6, 3, 8], [3, 7, 8], [7, 0, 8]],
}


@dataclass(frozen=True)
class Skin:
    """The outer surface of a mesh as flat triangles between neighbouring nodes.

    Attributes
    ----------
    nodes : ndarray of int, shape (n_points,)
        The mesh's nodes on the surface.
    triangles : ndarray of int, shape (n_triangles, 3)
        Places in ``nodes``, anticlockwise as seen from outside.
    """

    nodes: IntArray
    triangles: IntArray

    def normals(self, points: FloatArray) -> FloatArray:
        """Outward unit normals at places of the nodes of shape (n_points, 3): means of the triangles, by area."""
        a, b, c = np.moveaxis(points[self.triangles], 1, 0)
        doubled_areas = np.cross(b - a, c - a)
        sums = np.stack(
            [
                np.bincount(self.triangles.ravel(), np.repeat(doubled_areas[:, axis], 3), len(points))
                for axis in range(3)
            ],
            axis=1,
        )
        lengths = np.linalg.norm(sums, axis=1, keepdims=True)
        # Where two sheets cancel there is no outside; any unit vector will do.
        return np.where(lengths > 0.0, sums / np.where(lengths > 0.0, lengths, 1.0), [0.0, 0.0, 1.0])


def outer_skin(mesh: Mesh) -> Skin:
    """The boundary of a mesh; four triangles for each quadratic triangle, so that its middle nodes bend too."""
    cut = [block.nodes[:, _CUTS[block.nodes.shape[1]]].reshape(-1, 3) for block in mesh.boundary]
    nodes, places = np.unique(np.concatenate(cut), return_inverse=True)
    return Skin(nodes, places.reshape(-1, 3))


def drawn_name(modes: ModeSet, number: int) -> str:
    """The name of a mode's picture or model, without ending: ``mode-03-1007Hz``."""
    return f"mode-{number:02d}-{modes.frequencies_hz[number - 1]:.0f}Hz"


def check_numbers(modes: ModeSet, numbers: Sequence[int]) -> None:
    """Refuse numbers, from 1, of modes that are not there.

    Raises
    ------
    HousingError
        Where there is no mode of a number, or no number.
    """
    missing = [number for number in numbers if not 1 <= number <= len(modes.shapes)]
    if missing or not numbers:
        raise HousingError(f"modes {missing or 'none'} asked for; give numbers from 1 to {len(modes.shapes)}")
