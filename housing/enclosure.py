"""Volume and centroid of a meshed body from its boundary alone, by the divergence theorem."""

import numpy as np
import numpy.typing as npt

from meshes import Mesh

FloatArray = npt.NDArray[np.float64]

_DEGREE = 6  # of p (p·n) on a curved quadratic facet: nothing is left to the quadrature


def enclosed(mesh: Mesh) -> tuple[float, FloatArray]:
    """What the boundary encloses: V = ∮ p·n dA / 3 and V c = ∮ p (p·n) dA / 4.

    Nothing of the elements' own quadrature has a part in it, so that it checks theirs. With n dA the cross product
    of the facet's tangents both integrands are polynomials, and taken exactly on curved facets too.

    Returns
    -------
    volume : float
        [m³].
    centroid : ndarray, shape (3,)
        [m].
    """
    # About the middle of the body, where the sums cancel least.
    middle = mesh.bounds.mean(axis=0)
    values, gradients, weights = _facet_functions(mesh.boundary.shape[1])
    nodes = mesh.points[mesh.boundary] - middle
    places = np.einsum("fai,qa->fqi", nodes, values)
    tangents = np.einsum("fai,qaj->fqij", nodes, gradients)
    flux = np.einsum("fqi,fqi,q->fq", places, np.cross(tangents[..., 0], tangents[..., 1]), weights)
    volume = float(flux.sum() / 3.0)
    return volume, np.asarray(middle + np.einsum("fqi,fq->i", places, flux) / (4.0 * volume))


def _facet_functions(n_shape: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    from skfem import ElementTriP1, ElementTriP2
    from skfem.quadrature import get_quadrature

    element = ElementTriP1() if n_shape == 3 else ElementTriP2()
    points, weights = get_quadrature(element.refdom, _DEGREE)
    pairs = [element.lbasis(points, number) for number in range(n_shape)]
    values = np.array([np.broadcast_to(value, weights.shape) for value, _ in pairs]).T
    gradients = np.array([np.broadcast_to(gradient, points.shape) for _, gradient in pairs]).transpose(2, 0, 1)
    return values, gradients, np.asarray(weights)
