"""Circular coordinates of forward and backward whirl, and bearings and pedestals in them.

With x, y and the slopes β_x, β_y of both planes, where β_x is the rotation about y and β_y minus the
rotation about x, circular coordinates are

    r± = (x ± i y)/√2,    β± = (β_x ± i β_y)/√2 .

The change is unitary, so a symmetric matrix of a bearing becomes a Hermitian one. It is diagonal between + and −
exactly where the bearing is alike in every direction, cross-coupling k_xy = −k_yx included.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.rotors.model.bearing import Bearing

# Rows r+, β+, r−, β−, z; columns x, y, z and the rotations about x and about y, as in `gearwhine.rotors.Bearing`.
CIRCULAR = np.array(
    [
        [1.0, 1.0j, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, -1.0j, 1.0],
        [1.0, -1.0j, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0j, 1.0],
        [0.0, 0.0, np.sqrt(2.0), 0.0, 0.0],
    ]
) / np.sqrt(2.0)
CARTESIAN = np.eye(5, dtype=np.complex128)
# Members of the five circular coordinates by kind of block: forward, backward, axial.
BLOCK_COORDINATES = {1: (0, 1), -1: (2, 3), 0: (4,)}
# Lateral displacements among the five coordinates: Cartesian and circular.
RADIAL = {False: (0, 1), True: (0, 2)}
# Part of a matrix's largest entry below which an entry is rounding of the change of coordinates.
NO_COUPLING = 1e-14


@dataclass(frozen=True)
class NodeBearing:
    """A bearing at a node of a discretised shaft, in scaled units, along directions of its own.

    Where it couples forward and backward motion, its directions are x, y and their like: circular coordinates would mix
    a stiff direction with a soft one, and lose the soft one's digits. Directions without stiffness and damping are left
    out.

    Attributes
    ----------
    node : int
        Index of its node.
    directions : tuple of int, shape (m,)
        Indices into x, y, z and the rotations about x and y, or into r+, β+, r−, β−, z where it is ``circular``.
    frame : ndarray of complex, shape (m, n)
        Displacements along the directions from those of the node.
    stiffness, damping : ndarray of complex, shape (m, m)
        Force on the bearing's carrier.
    foot : tuple of int, shape (f,)
        Positions in ``directions`` that its pedestal shares; empty without a pedestal.
    foot_stiffness, foot_damping, foot_mass : ndarray of complex, shape (f, f)
        Stiffness, damping and mass of the pedestal against the ground.
    """

    node: int
    directions: tuple[int, ...]
    circular: bool
    frame: ComplexArray
    stiffness: ComplexArray
    damping: ComplexArray
    foot: tuple[int, ...]
    foot_stiffness: ComplexArray
    foot_damping: ComplexArray
    foot_mass: ComplexArray

    def dynamic_stiffness(self, eigenvalues: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Dynamic stiffness at every λ: K + λC of the bearing (b, m, m), K + λC + λ²M of the pedestal (b, f, f)."""
        at = eigenvalues[:, None, None]
        bearing = self.stiffness + at * self.damping
        return bearing, self.foot_stiffness + at * self.foot_damping + at**2 * self.foot_mass


def coupled_motions(bearings: Sequence[Bearing]) -> tuple[tuple[int, ...], ...]:
    """Return the sets of motions that the bearings couple: 1 (forward), −1 (backward) and 0 (axial).

    Axial motion appears only where a bearing couples it to lateral motion; alone it is no whirl.
    """
    matrices = [m for bearing in bearings for m in (bearing.spatial_stiffness, bearing.spatial_damping) if m.any()]
    for bearing in bearings:
        if bearing.pedestal is not None:
            for radial in (bearing.pedestal.stiffness, bearing.pedestal.damping):
                whole = np.zeros((5, 5))
                whole[:2, :2] = radial
                matrices.append(whole)
    circular = np.abs(CIRCULAR @ np.array(matrices).reshape(-1, 5, 5) @ CIRCULAR.conj().T)
    # Forces and moments differ in unit: each place is small or not beside its own row's and column's.
    couples = (circular > NO_COUPLING * circular.max(axis=(1, 2), initial=0.0)[:, None, None]).any(axis=0)
    couples |= couples.T

    def coupled(first: int, second: int) -> bool:
        return bool(couples[list(BLOCK_COORDINATES[first])][:, BLOCK_COORDINATES[second]].any())

    if coupled(0, 1) or coupled(0, -1):
        return ((1, -1, 0),)
    return ((1, -1),) if coupled(1, -1) else ((1,), (-1,))


def bearing_at_node(bearing: Bearing, node: int, blocks: tuple[int, ...], units: FloatArray) -> NodeBearing:
    """Return a bearing of constant coefficients at a node, for some blocks; ``units`` (n,) are of their coordinates."""
    members = [member for block in blocks for member in BLOCK_COORDINATES[block]]
    circular = len(blocks) == 1
    if circular:
        turn, unit_of, names = CIRCULAR, dict(zip(members, units.tolist(), strict=True)), members
    else:
        turn, names = CARTESIAN, [0, 1, 2, 3, 4] if 0 in blocks else [0, 1, 3, 4]
        unit_of = {0: units[0], 1: units[0], 2: units[0], 3: units[1], 4: units[1]}
    matrices = np.array([bearing.spatial_stiffness, bearing.spatial_damping], dtype=np.complex128)
    if circular:
        matrices = turn @ matrices @ turn.conj().T
    acts = (matrices[0] != 0.0) | (matrices[1] != 0.0)
    acts = acts[names][:, names]
    busy = [names[k] for k in np.flatnonzero(acts.any(axis=0) | acts.any(axis=1)).tolist()]
    unit = np.array([unit_of[k] for k in busy])
    scale = unit[:, None] * unit
    stiffness, damping = (m[busy][:, busy] * scale for m in matrices)
    # Coordinates have one unit in both senses, so that it cancels between the two sets of directions.
    frame = (turn @ CIRCULAR.conj().T)[busy][:, members]
    pedestal = bearing.pedestal
    foot = () if pedestal is None else tuple(position for position, k in enumerate(busy) if k in RADIAL[circular])
    ground = [np.zeros((len(foot), len(foot)), dtype=np.complex128)] * 3
    if pedestal is not None:
        foot_directions = [busy[position] for position in foot]
        for index, matrix in enumerate((pedestal.stiffness, pedestal.damping, pedestal.mass * np.eye(2))):
            whole = np.zeros((5, 5))
            whole[:2, :2] = matrix
            ground[index] = (turn @ whole @ turn.conj().T)[np.ix_(foot_directions, foot_directions)] * scale[
                np.ix_(foot, foot)
            ]
    return NodeBearing(node, tuple(busy), circular, frame, stiffness, damping, foot, *ground)
