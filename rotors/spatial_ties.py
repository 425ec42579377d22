"""Bearings and pedestals in circular coordinates: what ties the forward and the backward motion of a shaft.

With x, y and the slopes β_x, β_y of both planes, where β_x is the rotation about y and β_y minus the
rotation about x, circular coordinates are

    r± = (x ± i y)/√2,    β± = (β_x ± i β_y)/√2 .

The change is unitary, so a symmetric matrix of a bearing becomes a Hermitian one. It is diagonal between + and −
exactly where the bearing is alike in every direction, cross-coupling k_xy = −k_yx included.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .bearing import Bearing

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

# Rows r+, β+, r−, β−, z; columns x, y, z and the rotations about x and about y, as in `rotors.Bearing`.
CIRCULAR = np.array(
    [
        [1.0, 1.0j, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, -1.0j, 1.0],
        [1.0, -1.0j, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0j, 1.0],
        [0.0, 0.0, np.sqrt(2.0), 0.0, 0.0],
    ]
) / np.sqrt(2.0)
# Members of the five circular coordinates by kind of block: forward, backward, axial.
MEMBERS = {1: (0, 1), -1: (2, 3), 0: (4,)}
# Terms this small beside a matrix's largest come from rounding in the change of coordinates.
NO_COUPLING = 1e-14


@dataclass(frozen=True)
class Tie:
    """A bearing at a node, in circular coordinates and scaled units, over the blocks of a chain.

    Attributes
    ----------
    node
        Where it holds the shaft.
    stiffness, damping
        (n, n) complex: force on what carries it.
    foot
        Indices of those coordinates that its pedestal shares, (f,); empty on a rigid one.
    foot_stiffness, foot_damping, foot_mass
        (f, f) complex: of the pedestal against the ground.
    """

    node: int
    stiffness: ComplexArray
    damping: ComplexArray
    foot: tuple[int, ...]
    foot_stiffness: ComplexArray
    foot_damping: ComplexArray
    foot_mass: ComplexArray

    def dynamic_stiffness(self, eigenvalues: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """K + λC of the bearing, (b, n, n), and K + λC + λ²M of its pedestal, (b, f, f), at every λ (b,)."""
        at = eigenvalues[:, None, None]
        bearing = self.stiffness + at * self.damping
        return bearing, self.foot_stiffness + at * self.foot_damping + at**2 * self.foot_mass


def block_sets(bearings: Sequence[Bearing]) -> tuple[tuple[int, ...], ...]:
    """Which motions the bearings tie to each other: sets of 1 (forward), −1 (backward) and 0 (axial).

    Axial motion appears only where a bearing ties it to the lateral one; alone it is no whirl.
    """
    matrices = [m for bearing in bearings for m in (bearing.spatial_stiffness, bearing.spatial_damping)]
    for bearing in bearings:
        if bearing.pedestal is not None:
            for radial in (bearing.pedestal.stiffness, bearing.pedestal.damping):
                whole = np.zeros((5, 5))
                whole[:2, :2] = radial
                matrices.append(whole)
    circular = [CIRCULAR @ matrix @ CIRCULAR.conj().T for matrix in matrices]

    def tied(first: int, second: int) -> bool:
        one, other = list(MEMBERS[first]), list(MEMBERS[second])
        for matrix in circular:
            between = max(np.abs(matrix[np.ix_(one, other)]).max(), np.abs(matrix[np.ix_(other, one)]).max())
            # Forces and moments differ in unit: each place is small or not beside its own row's and column's.
            if between > NO_COUPLING * np.abs(matrix).max(initial=0.0):
                return True
        return False

    if tied(0, 1) or tied(0, -1):
        return ((1, -1, 0),)
    return ((1, -1),) if tied(1, -1) else ((1,), (-1,))


def make_tie(bearing: Bearing, node: int, blocks: tuple[int, ...], units: FloatArray) -> Tie:
    """The tie of a bearing of constant coefficients to some blocks; ``units`` are those of their coordinates, (n,)."""
    members = [member for block in blocks for member in MEMBERS[block]]

    def taken(matrix: FloatArray, rows: list[int]) -> ComplexArray:
        return np.asarray((CIRCULAR @ matrix @ CIRCULAR.conj().T)[np.ix_(rows, rows)])

    scale = np.outer(units, units)
    foot = tuple(members.index(member) for member in (0, 2) if member in members) if bearing.pedestal else ()
    empty = np.zeros((5, 5))
    radial = []
    for what in ("stiffness", "damping", "mass"):
        whole = empty.copy()
        if bearing.pedestal is not None:
            given = getattr(bearing.pedestal, what)
            whole[:2, :2] = given * np.eye(2) if what == "mass" else given
        radial.append(taken(whole, [members[f] for f in foot]) * scale[np.ix_(foot, foot)])
    return Tie(
        node,
        taken(bearing.spatial_stiffness, members) * scale,
        taken(bearing.spatial_damping, members) * scale,
        foot,
        *radial,
    )
