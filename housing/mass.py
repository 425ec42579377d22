"""Mass properties of a meshed solid: mass and centre of mass from the geometry of the elements."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.material import Material, element_constants
from meshes import Mesh
from meshes.mapping import element_moments

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class MassProperties:
    """Mass and centre of mass of a solid.

    Attributes
    ----------
    mass : float
        ∫ ρ dV [kg].
    center : ndarray, shape (3,)
        ∫ ρ x dV / mass [m].
    """

    mass: float
    center: FloatArray


def mass_properties(mesh: Mesh, material: Material, materials: Mapping[str, Material] | None = None) -> MassProperties:
    """Mass and centre of mass of a meshed solid, curved sides included.

    They need no mass matrix, and serve to check one: its rigid-body mass must be the same.

    Parameters
    ----------
    mesh, material, materials
        As for :func:`housing.assemble`.
    """
    density = element_constants(mesh, material, materials or {})[2]
    moments = [element_moments(mesh.points, block.nodes, block.kind) for block in mesh.blocks]
    mass = density @ np.concatenate([moment.volume for moment in moments])
    first = density @ np.concatenate([moment.first for moment in moments])
    return MassProperties(float(mass), np.asarray(first / mass))
