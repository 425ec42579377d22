"""Enclosed volume and centroid of a meshed body from its boundary alone, by the divergence theorem."""

import numpy as np
import numpy.typing as npt

from meshes import Mesh
from meshes.shapes import quadrature, shape_functions

FloatArray = npt.NDArray[np.float64]

_DEGREE = 6  # of p (p·n) on a curved quadratic facet: nothing is left to the quadrature


def enclosed_volume(mesh: Mesh) -> tuple[float, FloatArray]:
    """Volume and centroid enclosed by the boundary: V = ∮ p·n dA / 3 and V c = ∮ p (p·n) dA / 4.

    The result is independent of the elements' own quadrature and so checks it. With n dA the cross product of the
    facet's tangents both integrands are polynomials, integrated exactly on curved facets too.

    Returns
    -------
    volume : float
        [m³].
    centroid : ndarray, shape (3,)
        [m].
    """
    # About the middle of the body, where the sums cancel least.
    middle = mesh.bounds.mean(axis=0)
    volume, moment = 0.0, np.zeros(3)
    for block in mesh.boundary:
        places, weights = quadrature(block.kind, _DEGREE)
        values, gradients = shape_functions(block.kind, places)
        nodes = mesh.points[block.nodes] - middle
        points = np.einsum("fai,qa->fqi", nodes, values, optimize=True)
        tangents = np.einsum("fai,qaj->fqij", nodes, gradients, optimize=True)
        flux = np.einsum("fqi,fqi,q->fq", points, np.cross(tangents[..., 0], tangents[..., 1]), weights)
        volume += float(flux.sum() / 3.0)
        moment += np.einsum("fqi,fq->i", points, flux) / 4.0
    return volume, np.asarray(middle + moment / volume)
