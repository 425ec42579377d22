"""Fixtures: supports, mounts, joints and masses that add to the matrices of the solid through the motion of a patch.

The motion of a patch is a few numbers r = P u of the nodes' displacements u. Springs, dashpots or a mass that act on
r, with small matrices K₆, C₆ or M₆, are Pᵀ K₆ P, Pᵀ C₆ P and Pᵀ M₆ P on the nodes, by the equality of work.

A lumped mass is a point mass on the surface, or a rigid body on a patch, such as a motor on its bracket.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy import sparse

from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.matrices import NOTHING, Additions, Matrices, NodeBlocks
from gearwhine.housing.fem.nearest_point import SurfacePoint, surface_point
from gearwhine.housing.model.patches import Patch, Point, RigidBody, patch_matrix, point_matrix
from gearwhine.meshes import GeometryError, Mesh
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, Instance, Number, Numbers, Rule, Text, attribute_findings, refuse
from gearwhine.numerics.own_copies import keep_tuples

MOST_PATCH_NODES = 2000
"""Largest number of nodes of one fixture. Each pair of them joins the matrices: 2000 nodes are 36 million entries."""

Tensor = tuple[Point, Point, Point]

NO_INERTIA: Tensor = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
_INERTIA_ROUNDING = 1e-9  # part of the tensor's trace: rounding of numbers typed for a thin body


class Fixture(Protocol):
    """A fixture: a support, mount, joint or lumped mass, with its additions to the matrices of a mesh."""

    @property
    def name(self) -> str:
        """Its name, for messages."""

    def additions(self, mesh: Mesh) -> Additions:
        """Its additions to stiffness, mass, damping and fixed degrees of freedom.

        Raises
        ------
        HousingError, gearwhine.meshes.GeometryError
            Where it does not fit the mesh.
        """


def fixture_kind(fixture: Fixture) -> str:
    """Kind of a fixture, as the key of a case has it."""
    return "mass" if isinstance(fixture, LumpedMass) else type(fixture).__name__.lower()


def attach_fixtures(matrices: Matrices, mesh: Mesh, fixtures: Iterable[Fixture]) -> Matrices:
    """Attach supports, mounts, joints and masses to the matrices of a housing.

    Raises
    ------
    HousingError
        With a finding for each that does not fit the mesh; its part is the kind and the name of the fixture.
    """
    additions, misfits = Additions(), list[Finding]()
    for fixture in fixtures:
        try:
            additions += fixture.additions(mesh)
        except (HousingError, GeometryError) as error:
            misfits.append(Finding((fixture_kind(fixture), fixture.name), "", None, f"what fits the mesh; {error}"))
    refuse(misfits, HousingError)
    return matrices.plus(additions)


def port_fixture_matrices(
    port: sparse.csr_array,
    *,
    name: str,
    stiffness: FloatArray | None = None,
    mass: FloatArray | None = None,
    damping: FloatArray | None = None,
) -> Additions:
    """Project small symmetric matrices on the motions of a port to the nodes: Pᵀ S P.

    Parameters
    ----------
    port : scipy.sparse.csr_array, shape (n_motions, 3 n_nodes)
        P.
    name : str
        Owner of the port, for the message.
    stiffness, mass, damping : ndarray, shape (n_motions, n_motions), optional

    Raises
    ------
    HousingError
        Where the port has more than :data:`MOST_PATCH_NODES` nodes.
    """
    nodes = len(np.unique(port.indices // 3))
    if nodes > MOST_PATCH_NODES:
        raise HousingError(
            f"{name} ties {nodes} nodes to each other, and at most {MOST_PATCH_NODES} are bearable: take a smaller "
            "patch or larger elements on it, or a support, whose springs are spread and tie nothing"
        )

    def blocks(small: FloatArray | None) -> NodeBlocks:
        return NOTHING if small is None else NodeBlocks.congruent(port, small)

    return Additions(blocks(stiffness), blocks(mass), blocks(damping))


_FARTHEST_OFFSET = 10.0
"""Distance of the centre of gravity of a mass from its patch that no gearbox has [m]."""


@dataclass(frozen=True)
class LumpedMass:
    """A rigid body that moves with a patch, or a point mass on a point of the surface.

    On a patch the body has the six motions r = P u of the patch's middle, and adds Pᵀ M₆ P to the mass matrix, with M₆
    the mass matrix of the rigid body about that point: total mass, centre of gravity and inertia of the housing change
    exactly as rigid-body mechanics demands, on any mesh. A point of a solid has no rotation, so that only the mass
    itself acts on it.

    Attributes
    ----------
    name : str
    mass : float
        Mass [kg].
    patch : Patch, optional
        Patch that it is fastened to; either this or ``position``.
    position : tuple of float, optional
        A point [m]; the nearest one of the surface carries the mass.
    inertia : three rows of three floats
        Inertia tensor about the body's own centre of gravity, along the global axes [kg m²]; on a patch only.
    offset : tuple of float
        Vector from the middle of the patch to the body's centre of gravity [m]; on a patch only.

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
        """Keep own copies; check mass, place and inertia."""
        keep_tuples(self, "position", "inertia", "offset")
        rules: dict[str, Rule] = {
            "name": Text(),
            "mass": Number(above=0.0, unit="kg"),
            "patch": Instance(Patch, "a patch, or None", optional=True),
            "offset": Numbers(3),
        }
        if self.position is not None:
            rules["position"] = Numbers(3)
        refuse(attribute_findings(("mass", str(self.name)), self, **rules), HousingError)
        refuse(self._findings(), HousingError)

    def _findings(self) -> Iterator[Finding]:
        """Yield an offset too far, a body on a point or on nothing, and a tensor that no real body has."""
        part = ("mass", self.name)
        if not np.linalg.norm(self.offset) <= _FARTHEST_OFFSET:
            yield Finding(part, "offset", self.offset, f"an offset of at most {_FARTHEST_OFFSET:g} m")
        if (self.patch is None) == (self.position is None):
            yield Finding(part, "", None, "a patch or a position, one of the two")
        for attribute, nothing in (("inertia", NO_INERTIA), ("offset", (0.0, 0.0, 0.0))):
            value = getattr(self, attribute)
            if self.position is not None and value != nothing:
                yield Finding(part, attribute, value, "a patch with it: a single point does not turn a body")
        tensor = np.array(self.inertia, dtype=np.float64)
        if tensor.shape != (3, 3) or not np.isfinite(tensor).all() or not np.array_equal(tensor, tensor.T):
            yield Finding(part, "inertia", self.inertia, "a symmetric tensor, three rows of three numbers")
            return
        # ∫ r rᵀ dm = ½ tr(I) - I of a real body has no negative eigenvalue: no principal moment exceeds the two others.
        spread = 0.5 * np.trace(tensor) * np.eye(3) - tensor
        if np.linalg.eigvalsh(spread)[0] < -_INERTIA_ROUNDING * np.trace(tensor):
            moments = ", ".join(f"{moment:g}" for moment in np.linalg.eigvalsh(tensor))
            expected = "an inertia that a body can have: no principal moment above the sum of the two others"
            yield Finding(part, "inertia", self.inertia, f"{expected}; they are {moments} kg m²")

    def place(self, mesh: Mesh) -> SurfacePoint:
        """Return the point of the surface that carries a mass given by its position."""
        if self.position is None:
            raise HousingError(f"mass {self.name!r} is on a patch, not at a point")
        return surface_point(mesh, mesh.boundary, np.array(self.position))

    def additions(self, mesh: Mesh) -> Additions:
        """Pᵀ M₆ P, or m on the translations of a point; see :class:`gearwhine.housing.model.fixtures.Fixture`."""
        name = f"mass {self.name!r}"
        if self.patch is None:
            return port_fixture_matrices(point_matrix(mesh, self.place(mesh)), name=name, mass=self.mass * np.eye(3))
        body = RigidBody(self.mass, np.array(self.offset), np.array(self.inertia))
        port = patch_matrix(mesh, self.patch.facets(mesh), name=name)
        return port_fixture_matrices(port, name=name, mass=body.matrix(about=np.zeros(3)))
