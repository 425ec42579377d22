"""Supports: patches of the surface that are fixed, or on springs and dashpots to the ground.

The grounding check finds the rigid motions that the supports leave free, and the stiffness of each support.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.matrices import NOTHING, Additions
from gearwhine.housing.model.bushings import Mount
from gearwhine.housing.model.patches import Patch, rigid_motions, spread
from gearwhine.meshes import Mesh
from gearwhine.meshes.elements import Facets, facet_nodes
from gearwhine.numerics.arrays import FloatArray, IntArray
from gearwhine.numerics.findings import Flags, Number, Numbers, Rule, Text, attribute_findings, refuse
from gearwhine.numerics.own_copies import keep_tuples


@dataclass(frozen=True)
class Support:
    """A support of a patch of the surface, as of :class:`gearwhine.housing.Patch`; fixed or on springs and dashpots.

    Attributes
    ----------
    name : str
    surface : str, optional
        Name of a surface of the mesh.
    box : tuple of two points, optional
        Low and high corners of a box [m]; the facets inside belong to the patch.
    fixed : tuple of bool
        Whether x, y and z are held at zero.
    stiffness : tuple of float
        Springs to the ground along x, y, z [N/m], in all, spread evenly over the patch.
    damping : tuple of float
        Dashpots to the ground along x, y, z [N s/m], in all, spread evenly over the patch.
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
        """Check that the support is given in exactly one way and holds something, and its amounts."""
        rules: dict[str, Rule] = {
            "name": Text(),
            "surface": Text(optional=True),
            "fixed": Flags(3),
            "stiffness": Numbers(3, Number(at_least=0.0, unit="N/m")),
            "damping": Numbers(3, Number(at_least=0.0, unit="N s/m")),
        }
        refuse(attribute_findings(("support", str(self.name)), self, **rules), HousingError)
        keep_tuples(self, "box", "fixed", "stiffness", "damping", "plane")
        if sum(place is not None for place in (self.surface, self.box, self.plane)) != 1:
            raise HousingError(f"support {self.name!r} needs a surface, a box or a plane, one of the three")
        if not (any(self.fixed) or any(self.stiffness) or any(self.damping)):
            raise HousingError(f"support {self.name!r} holds nothing: fix a component or give it stiffness or damping")

    def facets(self, mesh: Mesh) -> Facets:
        """Return the facets of the patch."""
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
    freedoms = [
        3 * facet_nodes(support.facets(mesh)) + component
        for support in supports
        for component in range(3)
        if support.fixed[component]
    ]
    return np.unique(np.concatenate(freedoms)) if freedoms else np.empty(0, dtype=np.int64)


RIGID_MOTIONS = ("x", "y", "z", "rotation x", "rotation y", "rotation z")

_HELD_MOTION_SHARE = 1e-9  # part of the strongest hold below which a motion is free
_NAMED_DIRECTION_SHARE = 0.3  # a free motion is called after the directions that make up this much of it


@dataclass(frozen=True)
class SupportHold:
    """Stiffness of one support against rigid motions of the body.

    Attributes
    ----------
    name : str
    fixes : int
        Rigid motions that its fixed components alone would hold, 0 to 6.
    stiffness : ndarray, shape (6,)
        Stiffness of its springs against translations x, y, z [N/m] and rotations about the centre of gravity [N m/rad].
    share : ndarray, shape (6,)
        Part of the stiffness of all supports' springs; 0 where there is none.
    """

    name: str
    fixes: int
    stiffness: FloatArray
    share: FloatArray


@dataclass(frozen=True)
class Grounding:
    """Rigid motions of the body that the supports leave free, and the stiffness of each support.

    Attributes
    ----------
    free_motions : int
        Rigid motions that neither fixed freedoms nor springs resist: as many rigid modes belong to the housing.
    free_directions : tuple of str
        Main components of these motions.
    supports : tuple of SupportHold
    """

    free_motions: int
    free_directions: tuple[str, ...]
    supports: tuple[SupportHold, ...]


def grounding(mesh: Mesh, supports: Sequence[Support | Mount], center: FloatArray) -> Grounding:
    """Find the rigid motions that the supports leave free.

    A rigid motion r is free where it moves no fixed freedom and strains no spring: where
    rᵀ [Σ_fixed R Rᵀ + Σ_springs R K Rᵀ] r vanishes, each of the two sums taken by its own size, and
    rotations measured as displacement at half the body's diagonal.

    Parameters
    ----------
    mesh : Mesh
    supports : sequence of Support or Mount
        All fixtures that connect to the ground.
    center : ndarray, shape (3,)
        Centre of gravity [m].
    """
    reach = 0.5 * float(np.linalg.norm(mesh.bounds[1] - mesh.bounds[0]))
    scale = np.array([1.0] * 3 + [1.0 / reach] * 3)
    fields = rigid_motions(mesh.points, center).reshape(-1, 6)
    springs = [_spring_stiffness(mesh, support, fields) for support in supports]
    fixed_rows = [_fixed_rows(mesh, support, fields * scale) for support in supports]
    support_stiffness = [_by_size(rows.T @ rows) for rows in fixed_rows]
    total = np.sum(springs, axis=0) if springs else np.zeros((6, 6))
    whole = _by_size(total * np.outer(scale, scale)) + np.sum(support_stiffness, axis=0) if springs else total
    values, motions = np.linalg.eigh(whole)
    free = motions[:, values <= _HELD_MOTION_SHARE]
    part = np.linalg.norm(free, axis=1)
    sums = total.diagonal()
    return Grounding(
        free_motions=free.shape[1],
        free_directions=tuple(
            name for name, size in zip(RIGID_MOTIONS, part, strict=True) if size > _NAMED_DIRECTION_SHARE
        ),
        supports=tuple(
            SupportHold(
                name=support.name,
                fixes=int(np.count_nonzero(np.linalg.eigvalsh(fixed) > _HELD_MOTION_SHARE)),
                stiffness=stiffness.diagonal(),
                share=np.divide(stiffness.diagonal(), sums, out=np.zeros(6), where=sums > 0.0),
            )
            for support, fixed, stiffness in zip(supports, support_stiffness, springs, strict=True)
        ),
    )


def _spring_stiffness(mesh: Mesh, support: Support | Mount, fields: FloatArray) -> FloatArray:
    """Rᵀ K R of the stiffness K of the support's springs, with the six rigid motions R, shape (6, 6)."""
    added = support.additions(mesh).stiffness
    return np.asarray(fields.T @ (added.matrix(len(mesh.points)) @ fields)) if len(added) else np.zeros((6, 6))


def _fixed_rows(mesh: Mesh, support: Support | Mount, fields: FloatArray) -> FloatArray:
    """Return the rigid motions at the degrees of freedom that a support holds, shape (n, 6)."""
    return fields[fixed_freedoms(mesh, [support])] if isinstance(support, Support) else fields[:0]


def _by_size(matrix: FloatArray) -> FloatArray:
    size = float(np.abs(matrix).max())
    return np.asarray(matrix / size) if size > 0.0 else matrix
