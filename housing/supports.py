"""Supports: patches of the surface that are fixed, or on springs and dashpots to the ground."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from housing.errors import HousingError
from housing.node_blocks import NOTHING, Additions
from housing.patches import Patch, spread
from housing.surface import IntArray
from meshes import Facets, Mesh, facet_nodes


@dataclass(frozen=True)
class Support:
    """A support of a patch of the surface, as of :class:`housing.Patch`; fixed or on springs and dashpots.

    Attributes
    ----------
    name : str
    surface : str, optional
        Name of a surface of the mesh.
    box : tuple of two points, optional
        Its low and high corners [m]; the facets inside belong to the patch.
    fixed : tuple of bool
        Whether x, y and z are held at zero.
    stiffness : tuple of float
        Springs to the ground along x, y, z [N/m], in all, spread evenly over the patch.
    damping : tuple of float
        Dashpots to the ground along x, y, z [N s/m], spread likewise.
    plane : tuple of two points, optional
        A point of a plane [m] and its normal; the facets on it belong to the patch.
    """

    name: str
    surface: str | None = None
    box: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None
    fixed: tuple[bool, bool, bool] = (False, False, False)
    stiffness: tuple[float, float, float] = (0.0, 0.0, 0.0)
    damping: tuple[float, float, float] = (0.0, 0.0, 0.0)
    plane: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None

    def __post_init__(self) -> None:
        if sum(place is not None for place in (self.surface, self.box, self.plane)) != 1:
            raise HousingError(f"support {self.name!r} needs a surface, a box or a plane, one of the three")
        if not (any(self.fixed) or any(self.stiffness) or any(self.damping)):
            raise HousingError(f"support {self.name!r} holds nothing: fix a component or give it stiffness or damping")
        for what, unit, amounts in (("stiffness", "N/m", self.stiffness), ("damping", "N s/m", self.damping)):
            if not all(0.0 <= amount < np.inf for amount in amounts):
                raise HousingError(f"support {self.name!r}: {what} {amounts} {unit} must be finite and not negative")

    def facets(self, mesh: Mesh) -> Facets:
        """The facets of the patch."""
        return Patch(self.surface, self.box, self.plane).facets(mesh)

    def additions(self, mesh: Mesh) -> Additions:
        """Springs and dashpots spread over the patch, and the freedoms that are fixed."""
        facets = self.facets(mesh)
        return Additions(
            fixed=fixed_freedoms(mesh, [self]),
            stiffness=spread(mesh, facets, self.stiffness) if any(self.stiffness) else NOTHING,
            damping=spread(mesh, facets, self.damping) if any(self.damping) else NOTHING,
        )


def fixed_freedoms(mesh: Mesh, supports: Sequence[Support]) -> IntArray:
    """Degrees of freedom held at zero, ascending."""
    held = [
        3 * facet_nodes(support.facets(mesh)) + component
        for support in supports
        for component in range(3)
        if support.fixed[component]
    ]
    return np.unique(np.concatenate(held)) if held else np.empty(0, dtype=np.int64)
