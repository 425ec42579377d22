r"""Points of a housing's skin that a radiating surface moves with: its normal velocity, and how it changes with a mesh.

The displacement of a point is Σ N_a(ξ) u_a over the nodes of its facet. It lies in a plane triangle between three of
them, with the shares s_c of its corners, x = Σ s_c x_c and ξ = Σ s_c ξ_c. Where the nodes move at the velocity V and
the point stays, as on a wall whose mesh slides along it, its reference coordinates change by

    dξ = -Ξ (EᵀE)⁻¹ Eᵀ Σ s_c V_c,      E = (x₁ - x₀, x₂ - x₁),      Ξ = (ξ₁ - ξ₀, ξ₂ - ξ₁),

and its displacement, with those of the nodes held, by Σ (∂N_a/∂ξ · dξ) u_a.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import sparse

from gearwhine.numerics.arrays import BoolArray, ComplexArray, FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class FacetPoints:
    """Points of facets of one kind, with a nodes each.

    Attributes
    ----------
    rows : ndarray of int, shape (m,)
        Numbers of the points among all.
    nodes : ndarray of int, shape (m, a)
        Nodes of their facets.
    shape : ndarray, shape (m, a)
        N_a.
    gradients : ndarray, shape (m, a, 2)
        ∂N_a/∂ξ.
    corners : ndarray of int, shape (m, 3)
        Nodes of the plane triangles that they lie in.
    reference : ndarray, shape (m, 3, 2)
        ξ_c of these in the facets.
    shares : ndarray, shape (m, 3)
        s_c.
    """

    rows: IntArray
    nodes: IntArray
    shape: FloatArray
    gradients: FloatArray
    corners: IntArray
    reference: FloatArray
    shares: FloatArray


@dataclass(frozen=True, eq=False)
class SkinPoints:
    """Points of a skin that the triangles of a radiating surface move with; those that do not move are left out.

    Attributes
    ----------
    places : ndarray, shape (n_nodes, 3)
        Places of the mesh's nodes [m].
    groups : tuple of FacetPoints
    normals : ndarray, shape (n_points, 3)
        Normals of the radiating surface at all points.
    projection : csr_array, shape (3 n_triangles, n_points)
        Normal velocities at the corners of the triangles from those of all points.
    """

    places: FloatArray
    groups: tuple[FacetPoints, ...]
    normals: FloatArray
    projection: sparse.csr_array

    def on(self, triangles: BoolArray) -> "SkinPoints":
        """Return the points of some of the triangles, shape (n_triangles,)."""
        return replace(self, projection=self.projection[np.repeat(triangles, 3)])

    @cached_property
    def transfer(self) -> sparse.csr_array:
        """Matrix from nodal velocities to normal velocities at the corners, shape (3 n_triangles, 3 n_nodes)."""
        size = (len(self.normals), self.places.size)
        if not self.groups:
            return sparse.csr_array((self.projection.shape[0], size[1]))
        rows, columns, values = [], [], []
        for group in self.groups:
            values.append((group.shape[:, :, None] * self.normals[group.rows][:, None]).ravel())
            columns.append((3 * group.nodes[:, :, None] + np.arange(3)).ravel())
            rows.append(np.repeat(group.rows, 3 * group.nodes.shape[1]))
        at_points = sparse.csr_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), size)
        return sparse.csr_array(self.projection @ at_points)

    def sliding(self, velocity: FloatArray, motion: ComplexArray) -> ComplexArray:
        """Change of the normal motion at the corners as the nodes move along the surface, which stays.

        Parameters
        ----------
        velocity : ndarray, shape (n_nodes, 3)
            Velocity V of the nodes per unit of a parameter [m].
        motion : ndarray of complex, shape (n_nodes, 3)
            Motion of the nodes, such as their displacement u [m].

        Returns
        -------
        ndarray of complex, shape (3 n_triangles,)
            In the motion's unit, per unit of the parameter.
        """
        change = np.zeros(len(self.normals), dtype=np.complex128)
        for group in self.groups:
            carried = np.einsum("mc,mci->mi", group.shares, velocity[group.corners])
            if not carried.any():
                continue
            edges = np.diff(self.places[group.corners], axis=1)
            metric = np.einsum("mki,mli->mkl", edges, edges)
            against = np.einsum("mki,mi->mk", edges, carried)
            # Along the edges from corner to corner, by which ξ changes alike.
            along = -np.linalg.solve(metric, against[..., None])[..., 0]
            moved = np.einsum("mkr,mk->mr", np.diff(group.reference, axis=1), along)
            outward = np.einsum("mai,mi->ma", motion[group.nodes], self.normals[group.rows])
            change[group.rows] = np.einsum("mak,mk,ma->m", group.gradients, moved, outward)
        return np.asarray(self.projection @ change)
