"""What holds the housing: patches that are fixed, or on springs to the ground."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from housing.errors import HousingError
from housing.matrices import Matrices
from housing.surface import IntArray, facets_in_box, surface_quadrature
from meshes import Facets, Mesh, facet_nodes

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Support:
    """A held patch of the surface: a named surface or the facets in a box; fixed or on springs.

    Attributes
    ----------
    name : str
    surface : str, optional
        Name of a surface of the mesh.
    box : tuple of two points, optional
        Its low and high corners [m]; the facets inside belong to the patch.
    fixed : tuple of bool
        Which of x, y, z are held at zero.
    stiffness : tuple of float
        Springs to the ground along x, y, z [N/m], in all, spread evenly over the patch.
    """

    name: str
    surface: str | None = None
    box: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None
    fixed: tuple[bool, bool, bool] = (False, False, False)
    stiffness: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if (self.surface is None) == (self.box is None):
            raise HousingError(f"support {self.name!r} needs a surface or a box, one of the two")
        if not any(self.fixed) and not any(self.stiffness):
            raise HousingError(f"support {self.name!r} holds nothing: fix a component or give it a stiffness")
        if min(self.stiffness) < 0.0:
            raise HousingError(f"support {self.name!r}: stiffness {self.stiffness} N/m must not be negative")

    def facets(self, mesh: Mesh) -> Facets:
        """The facets of the patch."""
        if self.surface is not None:
            return mesh.surface(self.surface)
        assert self.box is not None
        return facets_in_box(mesh, np.array(self.box[0]), np.array(self.box[1]))


def fixed_freedoms(mesh: Mesh, supports: Sequence[Support]) -> IntArray:
    """Degrees of freedom held at zero, ascending."""
    held = [
        3 * facet_nodes(support.facets(mesh)) + component
        for support in supports
        for component in range(3)
        if support.fixed[component]
    ]
    return np.unique(np.concatenate(held)) if held else np.empty(0, dtype=np.int64)


def with_springs(matrices: Matrices, mesh: Mesh, supports: Sequence[Support]) -> Matrices:
    """The matrices with the supports' springs added.

    A patch of area A with stiffness k along a component adds (k / A) ∫ N_a N_b dA to it: a translation of the
    whole patch meets k, and the springs' energy is that of the field, not of single nodes.
    """
    blocks = matrices.blocks.copy()
    n_nodes = matrices.n_nodes
    row = np.repeat(np.arange(n_nodes), np.diff(matrices.pointer))
    keys = row * n_nodes + matrices.neighbors
    for support in supports:
        if not any(support.stiffness):
            continue
        patches = surface_quadrature(mesh, support.facets(mesh))
        area = sum(patch.area for patch in patches)
        for patch in patches:
            products = np.einsum("fq,qa,qb->fab", patch.areas, patch.shape_values, patch.shape_values) / area
            n_shape = patch.facets.shape[1]
            pairs = np.repeat(patch.facets, n_shape, axis=1).ravel() * n_nodes + np.tile(patch.facets, n_shape).ravel()
            slots = np.searchsorted(keys, pairs)
            for component, stiffness in enumerate(support.stiffness):
                np.add.at(blocks[:, component, component], slots, stiffness * products.ravel())
    return replace(matrices, blocks=blocks)
