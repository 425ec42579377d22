"""Lumped masses: point masses on the surface, and rigid bodies on a patch, such as a motor on its bracket."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.errors import HousingError
from housing.fem.matrices import Additions
from housing.fem.surface import SurfacePoint, surface_point
from housing.model.fixtures import port_fixture_matrices
from housing.model.patches import Patch, Point, RigidBody, patch_matrix, point_matrix
from meshes import Mesh

FloatArray = npt.NDArray[np.float64]
Tensor = tuple[Point, Point, Point]

NO_INERTIA: Tensor = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
_ROUNDING = 1e-9  # of the tensor's trace: rounding of numbers typed for a thin body


@dataclass(frozen=True)
class LumpedMass:
    """A rigid body that moves with a patch, or a point mass on a point of the surface.

    On a patch the body has the six motions r = P u of the patch's middle, and adds Pᵀ M₆ P to the mass matrix, with M₆
    the mass matrix of the rigid body about that point: total mass, centre of gravity and inertia of the housing change
    exactly as rigid-body mechanics demands, on any mesh. A point of a solid has no rotation, so that only the mass
    itself acts there.

    Attributes
    ----------
    name : str
    mass : float
        [kg].
    patch : Patch, optional
        Patch that it is fastened to; either this or ``position``.
    position : tuple of float, optional
        A point [m]; the nearest one of the surface carries the mass.
    inertia : three rows of three floats
        Inertia tensor about the body's own centre of gravity, along the global axes [kg m²]; on a patch only.
    offset : tuple of float
        From the middle of the patch to the body's centre of gravity [m]; on a patch only.

    Raises
    ------
    HousingError
        Where the mass is not positive, both or neither of patch and position are given, a point has inertia or an
        offset, or no body can have that inertia.
    """

    name: str
    mass: float
    patch: Patch | None = None
    position: Point | None = None
    inertia: Tensor = NO_INERTIA
    offset: Point = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        """Check mass, place and inertia; a tensor that no real body has is refused."""
        if not 0.0 < self.mass < np.inf:
            raise HousingError(f"mass {self.name!r} of {self.mass} kg: expected a positive one")
        if (self.patch is None) == (self.position is None):
            raise HousingError(f"mass {self.name!r} needs a patch or a position, one of the two")
        if self.position is not None and (self.inertia != NO_INERTIA or any(self.offset)):
            raise HousingError(f"mass {self.name!r}: inertia and offset need a patch; a point does not turn a body")
        tensor = np.array(self.inertia, dtype=np.float64)
        if tensor.shape != (3, 3) or not np.isfinite(tensor).all() or not np.array_equal(tensor, tensor.T):
            raise HousingError(f"mass {self.name!r}: inertia {self.inertia} is no symmetric tensor")
        # ∫ r rᵀ dm = ½ tr(I) - I of a real body has no negative eigenvalue: no principal moment exceeds the two others.
        spread = 0.5 * np.trace(tensor) * np.eye(3) - tensor
        if np.linalg.eigvalsh(spread)[0] < -_ROUNDING * np.trace(tensor):
            moments = ", ".join(f"{moment:g}" for moment in np.linalg.eigvalsh(tensor))
            raise HousingError(
                f"mass {self.name!r}: no body has principal moments of inertia of {moments} kg m²: each must be at "
                "least 0 and at most the sum of the two others"
            )

    def place(self, mesh: Mesh) -> SurfacePoint:
        """Return the point of the surface that carries a mass given by its position."""
        if self.position is None:
            raise HousingError(f"mass {self.name!r} is on a patch, not at a point")
        return surface_point(mesh, mesh.boundary, np.array(self.position))

    def additions(self, mesh: Mesh) -> Additions:
        """Pᵀ M₆ P, or m on the translations of a point; see :class:`housing.model.fixtures.Fixture`."""
        name = f"mass {self.name!r}"
        if self.patch is None:
            return port_fixture_matrices(point_matrix(mesh, self.place(mesh)), name=name, mass=self.mass * np.eye(3))
        body = RigidBody(self.mass, np.array(self.offset), np.array(self.inertia))
        port = patch_matrix(mesh, self.patch.facets(mesh), name=name)
        return port_fixture_matrices(port, name=name, mass=body.matrix(about=np.zeros(3)))
