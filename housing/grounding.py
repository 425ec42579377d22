"""Grounding check: rigid motions that the supports leave free, and the stiffness of each support."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.bushings import Mount
from housing.rigid import rigid_motions
from housing.supports import Support, fixed_freedoms
from meshes import Mesh

FloatArray = npt.NDArray[np.float64]

RIGID_MOTIONS = ("x", "y", "z", "rotation x", "rotation y", "rotation z")

_HELD = 1e-9  # part of the strongest hold below which a motion is free
_NAMED = 0.3  # a free motion is called after the directions that make up this much of it


@dataclass(frozen=True)
class SupportHold:
    """Stiffness of one support against rigid motions of the body.

    Attributes
    ----------
    name : str
    fixes : int
        Rigid motions that its fixed components alone would hold, 0 to 6.
    stiffness : ndarray, shape (6,)
        Of its springs against translations x, y, z [N/m] and rotations about the centre of gravity [N m/rad].
    share : ndarray, shape (6,)
        Of that of all supports' springs; 0 where there is none.
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
        All that connect to the ground.
    center : ndarray, shape (3,)
        Centre of gravity [m].
    """
    reach = 0.5 * float(np.linalg.norm(mesh.bounds[1] - mesh.bounds[0]))
    scale = np.array([1.0] * 3 + [1.0 / reach] * 3)
    fields = rigid_motions(mesh.points, center).reshape(-1, 6)
    springs = [_spring_stiffness(mesh, support, fields) for support in supports]
    held = [_fixed_rows(mesh, support, fields * scale) for support in supports]
    own = [_by_size(rows.T @ rows) for rows in held]
    total = np.sum(springs, axis=0) if springs else np.zeros((6, 6))
    whole = _by_size(total * np.outer(scale, scale)) + np.sum(own, axis=0) if springs else total
    values, motions = np.linalg.eigh(whole)
    free = motions[:, values <= _HELD]
    part = np.linalg.norm(free, axis=1)
    sums = total.diagonal()
    return Grounding(
        free_motions=free.shape[1],
        free_directions=tuple(name for name, size in zip(RIGID_MOTIONS, part, strict=True) if size > _NAMED),
        supports=tuple(
            SupportHold(
                name=support.name,
                fixes=int(np.count_nonzero(np.linalg.eigvalsh(fixed) > _HELD)),
                stiffness=stiffness.diagonal(),
                share=np.divide(stiffness.diagonal(), sums, out=np.zeros(6), where=sums > 0.0),
            )
            for support, fixed, stiffness in zip(supports, own, springs, strict=True)
        ),
    )


def _spring_stiffness(mesh: Mesh, support: Support | Mount, fields: FloatArray) -> FloatArray:
    """Rᵀ K R of the stiffness K of the support's springs, with the six rigid motions R, shape (6, 6)."""
    added = support.additions(mesh).stiffness
    return np.asarray(fields.T @ (added.matrix(len(mesh.points)) @ fields)) if len(added) else np.zeros((6, 6))


def _fixed_rows(mesh: Mesh, support: Support | Mount, fields: FloatArray) -> FloatArray:
    """The rigid motions at the degrees of freedom that a support holds, shape (n, 6)."""
    return fields[fixed_freedoms(mesh, [support])] if isinstance(support, Support) else fields[:0]


def _by_size(matrix: FloatArray) -> FloatArray:
    size = float(np.abs(matrix).max())
    return np.asarray(matrix / size) if size > 0.0 else matrix
