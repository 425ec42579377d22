"""Fixtures: supports, mounts, joints and masses that add to the matrices of the solid through the motion of a patch.

The motion of a patch is a few numbers r = P u of the nodes' displacements u. Springs, dashpots or a mass that act on
r, with small matrices K₆, C₆ or M₆, are Pᵀ K₆ P, Pᵀ C₆ P and Pᵀ M₆ P on the nodes, by the equality of work.
"""

from collections.abc import Iterable
from typing import Protocol

import numpy as np
import numpy.typing as npt
from scipy import sparse

from housing.errors import HousingError
from housing.fem.matrices import NOTHING, Additions, Matrices, NodeBlocks
from meshes import Mesh

FloatArray = npt.NDArray[np.float64]

MOST_PATCH_NODES = 2000
"""Largest number of nodes of one fixture. Each pair of them joins the matrices: 2000 nodes are 36 million entries."""


class Fixture(Protocol):
    """A fixture: a support, mount, joint or lumped mass, with its additions to the matrices of a mesh."""

    @property
    def name(self) -> str:
        """Its name, for messages."""

    def additions(self, mesh: Mesh) -> Additions:
        """Its additions to stiffness, mass, damping and fixed degrees of freedom.

        Raises
        ------
        HousingError, meshes.GeometryError
            Where it does not fit the mesh.
        """


def attach_fixtures(matrices: Matrices, mesh: Mesh, fixtures: Iterable[Fixture]) -> Matrices:
    """Attach supports, mounts, joints and masses to the matrices of a housing.

    Raises
    ------
    HousingError, meshes.GeometryError
        Where one of them does not fit the mesh.
    """
    additions = sum((attachment.additions(mesh) for attachment in fixtures), Additions())
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
