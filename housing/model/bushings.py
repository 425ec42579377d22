"""Bushings: springs and dashpots in all six motions, as mounts to the ground or joints between two patches."""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.matrices import Additions
from gearwhine.housing.model.fixtures import port_fixture_matrices
from gearwhine.housing.model.patches import Patch, Point, patch_matrix
from gearwhine.meshes import Mesh
from gearwhine.meshes.elements import facet_nodes
from gearwhine.numerics.arrays import FloatArray, IntArray
from gearwhine.numerics.own_copies import keep_tuples

Six = tuple[float, float, float, float, float, float]
Axes = tuple[Point, Point, Point]

GLOBAL_AXES: Axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
_SQUARE_AXES_TOLERANCE = 1e-9  # largest deviation of axes from unit vectors at right angles


@dataclass(frozen=True)
class Axial:
    """Stiffness or damping that is symmetric about one axis, such as a bolt's or a rubber buffer's.

    Attributes
    ----------
    axial, shear : float
        Amounts along the axis and across it [N/m or N s/m].
    tilting, torsional : float
        Amounts about a line across the axis and about the axis [N m/rad or N m s/rad].
    """

    axial: float = 0.0
    shear: float = 0.0
    tilting: float = 0.0
    torsional: float = 0.0


@dataclass(frozen=True)
class Bushing:
    """Six springs and six dashpots about a point, along and about three axes of their own.

    Attributes
    ----------
    stiffness : tuple of six floats
        Springs along its axes x, y, z [N/m] and about them [N m/rad].
    damping : tuple of six floats
        Dashpots along its axes x, y, z [N s/m] and about them [N m s/rad].
    axes : tuple of three unit vectors
        Axes x, y, z of the bushing in the global frame, right-handed.

    Raises
    ------
    HousingError
        Where an amount is negative or not finite, all are zero, or the axes are not at right angles.
    """

    stiffness: Six = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    damping: Six = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    axes: Axes = GLOBAL_AXES

    def __post_init__(self) -> None:
        """Check stiffness, damping and axes."""
        keep_tuples(self, "stiffness", "damping", "axes")
        for label, amounts in (("stiffness", self.stiffness), ("damping", self.damping)):
            if np.shape(amounts) != (6,) or not all(0.0 <= amount < np.inf for amount in amounts):
                raise HousingError(f"{label} {amounts}: expected six finite numbers, none of them negative")
        if not any(self.stiffness) and not any(self.damping):
            raise HousingError("six springs and dashpots that are all zero hold nothing: give one of them an amount")
        frame = np.array(self.axes, dtype=np.float64)
        off_square = np.abs(frame @ frame.T - np.eye(3)).max() if frame.shape == (3, 3) else np.inf
        if not (off_square < _SQUARE_AXES_TOLERANCE and np.linalg.det(frame) > 0.0):
            raise HousingError(f"axes {self.axes}: expected three unit vectors at right angles, right-handed")

    @classmethod
    def along(cls, axis: Point, stiffness: Axial, damping: Axial | None = None) -> "Bushing":
        """Make springs and dashpots that are symmetric about an axis z, given by a vector of any length.

        Raises
        ------
        HousingError
            Where the axis has no length.
        """
        return cls(_six(stiffness), _six(damping or Axial()), axes_along(axis))

    def matrix(self, amounts: Six) -> FloatArray:
        """T^T diag(amounts) T in the global frame, with T = diag(axes, axes), shape (6, 6)."""
        turn = np.kron(np.eye(2), np.array(self.axes))
        return np.asarray(turn.T @ np.diag(amounts) @ turn)

    def additions(self, port: sparse.csr_array, name: str) -> Additions:
        """Matrices of the bushing on the six motions of a port of shape (6, 3 n_nodes)."""
        stiffness, damping = self.matrix(self.stiffness), self.matrix(self.damping)
        return port_fixture_matrices(port, name=name, stiffness=stiffness, damping=damping)


def axes_along(axis: Point, across: Point | None = None) -> Axes:
    """Right-handed axes whose z has a given direction, and whose x is as near as possible to another one.

    Raises
    ------
    HousingError
        Where a direction has no length, or both are the same.
    """
    along = _unit(np.array(axis, dtype=np.float64), f"axis {axis}")
    if across is None:
        # The global axis farthest from it: with one axis of symmetry every direction across it is equivalent.
        across = GLOBAL_AXES[int(np.argmin(np.abs(along)))]
    reference = _unit(np.array(across, dtype=np.float64), f"axis {across}")
    x = _unit(reference - (reference @ along) * along, f"axis {across} beside {axis}", least=1e-6)
    y = np.cross(along, x)
    frame = [(float(row[0]), float(row[1]), float(row[2])) for row in (x, y, along)]
    return frame[0], frame[1], frame[2]


@dataclass(frozen=True)
class Mount:
    """A mount: the rigid motion of a patch on six springs and dashpots to the ground.

    Attributes
    ----------
    name : str
    patch : Patch
    bushing : Bushing
    center : tuple of float, optional
        Point where its axes meet, so that translations do not tilt it [m]; the middle of the patch where not given.
    """

    name: str
    patch: Patch
    bushing: Bushing
    center: Point | None = None

    def __post_init__(self) -> None:
        """Keep own copies."""
        keep_tuples(self, "center")

    def additions(self, mesh: Mesh) -> Additions:
        """Pᵀ K₆ P and Pᵀ C₆ P; see :class:`gearwhine.housing.model.fixtures.Fixture`."""
        center = None if self.center is None else np.array(self.center)
        port = patch_matrix(mesh, self.patch.facets(mesh), center, name=f"mount {self.name!r}")
        return self.bushing.additions(port, f"mount {self.name!r}")


@dataclass(frozen=True)
class Joint:
    """A joint: six springs and dashpots between two patches, such as a bolt between a cover and its flange.

    It resists the motion of the second patch relative to the first, each taken as a rigid body's at one and the same
    point, δ = (P₂ - P₁) u. A rigid motion that both share therefore meets no resistance, however far apart they are.

    Attributes
    ----------
    name : str
    first, second : Patch
    bushing : Bushing
    center : tuple of float, optional
        Point where its axes meet [m]; halfway between the middles of the patches where not given.

    Raises
    ------
    HousingError
        Where both patches are the same.
    """

    name: str
    first: Patch
    second: Patch
    bushing: Bushing
    center: Point | None = None

    def __post_init__(self) -> None:
        """Check that the joint has two different patches."""
        keep_tuples(self, "center")
        if self.first == self.second:
            raise HousingError(f"joint {self.name!r} ties a patch to itself; give two patches")

    def nodes(self, mesh: Mesh) -> IntArray:
        """Return the nodes of both patches."""
        return np.concatenate([facet_nodes(patch.facets(mesh)) for patch in (self.first, self.second)])

    def additions(self, mesh: Mesh) -> Additions:
        """(P₂ - P₁)ᵀ K₆ (P₂ - P₁) and the same with C₆; see :class:`gearwhine.housing.model.fixtures.Fixture`."""
        name = f"joint {self.name!r}"
        if self.center is None:
            center = 0.5 * (self.first.center(mesh) + self.second.center(mesh))
        else:
            center = np.array(self.center)
        first, second = (
            patch_matrix(mesh, patch.facets(mesh), center, name=name) for patch in (self.first, self.second)
        )
        return self.bushing.additions(sparse.csr_array(second - first), name)


def _six(amounts: Axial) -> Six:
    return (amounts.shear, amounts.shear, amounts.axial, amounts.tilting, amounts.tilting, amounts.torsional)


def _unit(vector: FloatArray, name: str, *, least: float = 1e-100) -> FloatArray:
    length = float(np.linalg.norm(vector))
    if not least < length < np.inf:
        raise HousingError(f"{name}: expected a direction, of some length and not along another axis")
    return np.asarray(vector / length)
