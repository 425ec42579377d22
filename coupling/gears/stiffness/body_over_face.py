r"""Deflection of a gear body that neighbouring teeth share, under a load that varies over the face: an elastic ring.

:mod:`gearwhine.coupling.gears.stiffness.ring_body` is plane: the same load all over the face. Under a load that varies
over the face the body yields less, the more so the narrower the face is against its radius: the sections of the ring
hold each other by shear. The ring from the circle where it is held to the root circle is a solid here, of the face's
width and with free ends. Its displacements are

    u_r = U(r, z) cos n t,    u_t = V(r, z) sin n t,    u_z = W(r, z) cos n t

in each wave n around it, zero at the held circle, and U, V, W are polynomials in ln r and z of the least elastic energy
(Ritz) under tractions on the root circle that are Legendre's polynomials p_m over the face,

    p_m(z) = sqrt(2 m + 1) P_m(2 z / b),        mean p_m p_l = 1 where m = l, else 0.

Even loads move U and V by even polynomials and W by odd ones, and the reverse. Between the teeth the waves add up as in
the plane ring, with the tractions of the plane stamp in every section. The moved root arc, along the line of action,
then has the compliances C_ml: the part p_m of its motion by a load p_l on the next tooth. C_00 is that of an even load;
this module gives the ratios C_ml / C_00, which multiply the compliance of the plane ring.

Short waves, ``n > _WAVES``, do not reach the next tooth and count in plane strain.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.geometry.profile import root_half_angle
from gearwhine.coupling.gears.stiffness.elastic_ring import root_stamp
from gearwhine.coupling.gears.stiffness.foundation import held_radius
from gearwhine.coupling.gears.stiffness.ring_body import body_rings, kolosov, root_loads, solid_rings
from gearwhine.numerics.arrays import FloatArray

FACE_SHAPES = 3
"""Shapes p_1, p_2, p_3 of the load over the face besides the even one; a fourth has 2 % of the even compliance."""

_WAVES = 48
_OVER_FACE = 7
_OVER_RADIUS = 14


def uneven_shares(gear: Gear, radius: float, width: float, *, twists: bool = True) -> FloatArray:
    """Compliance that neighbouring teeth share under uneven loads over the face, relative to that under an even load.

    Parameters
    ----------
    gear : Gear
        A spur gear. A rim on a web counts as a body of the full width, which is stiffer in tilt.
    radius : float
        Radius of the loaded points [m].
    width : float
        Face width over the root radius, positive.
    twists : bool
        Whether the twist of the whole body about its bore is shared, as for
        `gearwhine.coupling.gears.stiffness.ring_body.neighbour_compliance`.

    Returns
    -------
    ndarray, shape (m, m)
        ``C_ml / C_00`` over `FACE_SHAPES`; symmetric, no eigenvalue below 0.
    """
    nu = gear.poisson_ratio
    twists = twists and held_radius(gear) is not None
    rings = body_rings(gear) if twists else solid_rings(gear)
    stamp = root_stamp(rings, abs(root_half_angle(gear)), nu, kolosov(gear, "plane-strain"))
    over_face = wave_flexibility_over_face(rings[0].held, width, nu)
    load = root_loads(gear, np.array(radius))
    waves, uniform = np.einsum("j,jna->na", load, stamp.waves), load @ stamp.uniform
    phase = np.exp(-2j * math.pi / abs(gear.teeth) * np.arange(1, waves.shape[0] + 1))
    # Hermitian, as the tangential traction of the plane ring is a quarter wave behind the radial one.
    work = np.einsum("na,nb,ab,n->nab", waves.conj(), waves, np.array([[1.0, 1j], [-1j, 1.0]]), phase).real / math.pi
    long = work[:_WAVES]
    matrix = np.einsum("nab,nmlab->ml", long, over_face[1 : long.shape[0] + 1])
    matrix += np.eye(len(matrix)) * np.sum(work[_WAVES:] * stamp.flexibility[_WAVES:])
    even = over_face[0].copy()
    if not twists:
        even[..., 1, 1] = 0.0
    matrix += np.einsum("a,mlab,b->ml", uniform, even, uniform) / (2.0 * math.pi)
    # By reciprocity the transpose is the motion of the next tooth by a load on this one.
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T)[1:, 1:] / matrix[0, 0])
    return np.asarray(vectors * np.maximum(values, 0.0) @ vectors.T)


@lru_cache(maxsize=32)
def wave_flexibility_over_face(held: float, width: float, poisson_ratio: float) -> FloatArray:
    """Displacement (u_r, u_t) of the root circle, times 2 mu, by waves around the ring and polynomials over the face.

    Parameters
    ----------
    held, width : float
        Radius where the ring is held, inside the root circle or outside it, and its width, in root circle radii.
    poisson_ratio : float

    Returns
    -------
    ndarray, shape (waves + 1, m + 1, m + 1, 2, 2)
        Part p_m of the displacement under tractions ``p_l (cos n t, sin n t)``, from n = 0.
    """
    count = FACE_SHAPES + 1
    flexibility = np.zeros((_WAVES + 1, count, count, 2, 2))
    n = np.arange(_WAVES + 1.0)[:, None, None]
    for parity in (0, 1):
        # Quadratic in n, so that three waves give the energy of all.
        none, single, double = (_elastic_energy(held, width, poisson_ratio, parity, wave) for wave in (0.0, 1.0, 2.0))
        second = 0.5 * (double - 2.0 * single + none)
        energy = none + n * (single - none - second) + n**2 * second
        shapes = np.arange(parity, count, 2)
        across = len(range(parity, _OVER_FACE, 2))
        load = np.zeros((energy.shape[1] // _OVER_RADIUS, 2, shapes.size))
        for component in (0, 1):
            load[component * across + np.arange(shapes.size), component, np.arange(shapes.size)] = 1.0
        # Every polynomial over the radius is 1 at the root circle.
        load = np.repeat(load.reshape(len(load), -1), _OVER_RADIUS, axis=0)
        moved = load.T @ np.linalg.solve(energy, load[None])
        moved = moved.reshape(-1, 2, shapes.size, 2, shapes.size).transpose(0, 2, 4, 1, 3)
        flexibility[:, shapes[:, None], shapes] = moved
    flexibility.setflags(write=False)
    return flexibility


def _elastic_energy(held: float, width: float, poisson_ratio: float, parity: int, n: float) -> FloatArray:
    """Elastic energy by the coefficients of U, V and W, times 2, with 2 mu = 1; U and V even over the face or odd."""
    x, weight, value, slope = _legendre(_OVER_RADIUS + 10, _OVER_RADIUS)
    depth = math.log(1.0 / held)
    radius = np.exp(-0.5 * depth * (1.0 - x))
    per_x = 0.5 * depth * radius
    rotation = 0.5 * value * (1.0 + x)[:, None]
    rise = 0.5 * (slope * (1.0 + x)[:, None] + value) / per_x[:, None]
    over = rotation / radius[:, None]
    _, z_weight, face, face_slope = _legendre(_OVER_FACE + 2, _OVER_FACE + 1)
    scale = np.sqrt(2.0 * np.arange(_OVER_FACE + 1) + 1.0)
    face, face_slope = face * scale, face_slope * scale * 2.0 / width
    measure = np.outer(0.5 * z_weight, weight * np.abs(per_x) * radius).ravel()
    across, along = slice(parity, _OVER_FACE, 2), slice(1 - parity, None, 2)
    p, q, p_slope, q_slope = face[:, across], face[:, along], face_slope[:, across], face_slope[:, along]
    p_over, p_rise = _products(p, over), _products(p, rise)
    none, none_along = np.zeros_like(p_over), np.zeros((measure.size, q.shape[1] * _OVER_RADIUS))
    radial = np.hstack([p_rise, none, none_along])
    around = np.hstack([p_over, n * p_over, none_along])
    axial = np.hstack([none, none, _products(q_slope, rotation)])
    shears = (
        np.hstack([-n * p_over, p_rise - p_over, none_along]),
        np.hstack([_products(p_slope, rotation), none, _products(q, rise)]),
        np.hstack([none, _products(p_slope, rotation), -n * _products(q, over)]),
    )
    lame = poisson_ratio / (1.0 - 2.0 * poisson_ratio)
    strains = [(lame, radial + around + axial), (1.0, radial), (1.0, around), (1.0, axial)]
    strains += [(0.5, shear) for shear in shears]
    return np.asarray(sum(modulus * (strain.T * measure) @ strain for modulus, strain in strains), dtype=np.float64)


@lru_cache(maxsize=8)
def _legendre(points: int, count: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Points and weights of Gauss's quadrature with Legendre's polynomials and their slopes there, (points, count)."""
    x, weight = np.polynomial.legendre.leggauss(points)
    slopes = [np.polynomial.Legendre.basis(degree).deriv()(x) for degree in range(count)]
    values = np.polynomial.legendre.legvander(x, count - 1)
    return x, weight, np.asarray(values, dtype=np.float64), np.asarray(np.column_stack(slopes), dtype=np.float64)


def _products(over_face: FloatArray, over_radius: FloatArray) -> FloatArray:
    """Products of functions at all pairs of points, (points, functions)."""
    points = over_face.shape[0] * over_radius.shape[0]
    return np.asarray(np.einsum("za,rb->zrab", over_face, over_radius).reshape(points, -1))
