"""Boundary integrals of the Helmholtz equation over flat triangles with linear shape functions.

The free-space Green's function of the time factor exp(+i omega t) is

``G(x, y) = exp(-i k r) / (4 pi r)``, ``r = |y - x|``

and its derivative along the normal n at y is ``-(1 + i k r) exp(-i k r) ((y - x) . n) / (4 pi r³)``.

Integrals over triangles far from the point x use Dunavant's rules; a triangle near x is divided until its pieces are
no longer than their distance; on a triangle with x as a corner the single layer is integrated in Duffy's coordinates,
whose Jacobian cancels 1/r, and the double layer is zero since (y - x) is normal to n.

Sources: D. A. Dunavant, "High degree efficient symmetrical Gaussian quadrature rules for the triangle", International
Journal for Numerical Methods in Engineering 21 (1985), 1129-1148; M. G. Duffy, "Quadrature over a pyramid or cube of
integrands with a singularity at a vertex", SIAM Journal on Numerical Analysis 19 (1982), 1260-1262.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numba
import numpy as np

from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.numerics.arrays import ComplexArray, FloatArray, IntArray

# Barycentric coordinates and weights of Dunavant's rules of degree 2, 4 and 6.
_DEGREE_2 = np.array([[2 / 3, 1 / 6, 1 / 6, 1 / 3], [1 / 6, 2 / 3, 1 / 6, 1 / 3], [1 / 6, 1 / 6, 2 / 3, 1 / 3]])


def _orbits(*orbits: tuple[float, float]) -> FloatArray:
    """Rule of points (1 - 2 a, a, a) in all orders, each with its weight."""
    rows = []
    for a, weight in orbits:
        b = 1.0 - 2.0 * a
        rows += [(b, a, a, weight), (a, b, a, weight), (a, a, b, weight)]
    return np.array(rows)


_DEGREE_4 = _orbits((0.445948490915965, 0.223381589678011), (0.091576213509771, 0.109951743655322))

_TO_CORNERS = 12.0 * np.linalg.inv(np.ones((3, 3)) + np.eye(3))  # turns moments of linear functions into their values

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(5)
_POINTS, _WEIGHTS = 0.5 * (_POINTS + 1.0), 0.5 * _WEIGHTS
_MOST_LEVELS = 7  # most halvings of a triangle near a point

# Python's error for a division by zero is a branch, with which no loop becomes vector code.
_OPTIONS: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}
_FUSED = {"contract", "arcp", "nsz"}
_compiled = numba.njit(**_OPTIONS, fastmath=_FUSED)
# Of kernels that kernels alone call.
_OF_INNER = _OPTIONS | {"no_cpython_wrapper": True}
_inner = numba.njit(**_OF_INNER, fastmath=_FUSED)
_summed = numba.njit(**_OF_INNER, fastmath=_FUSED | {"reassoc"})


@_inner
def _add_point(  # type: ignore[no-untyped-def]
    x, y0, y1, y2, normal, weight, k, b0, b1, b2, single, double, static
):
    """Add one quadrature point to the integrals of a triangle: G phi_a, dG/dn phi_a, dG_0/dn phi_a."""
    d0, d1, d2 = y0 - x[0], y1 - x[1], y2 - x[2]
    square = d0 * d0 + d1 * d1 + d2 * d2
    r = math.sqrt(square)
    scale = weight / (4.0 * math.pi * r)
    kr = k * r
    cosine, sine = math.cos(kr), math.sin(kr)
    projected = (d0 * normal[0] + d1 * normal[1] + d2 * normal[2]) / square
    g = complex(scale * cosine, -scale * sine)
    dg = -projected * complex(1.0, kr) * g
    dg0 = -projected * scale
    single[0] += b0 * g
    single[1] += b1 * g
    single[2] += b2 * g
    double[0] += b0 * dg
    double[1] += b1 * dg
    double[2] += b2 * dg
    static[0] += b0 * dg0
    static[1] += b1 * dg0
    static[2] += b2 * dg0


@_inner
def _near_triangle(x, corners, normal, area, k, rule, single, double, static, stack):  # type: ignore[no-untyped-def]
    """Integrate over a triangle near x, divided in four until each piece is no longer than its distance from x."""
    for i in range(3):
        for j in range(3):
            stack[0, i, j] = 1.0 if i == j else 0.0
    stack[0, 3, 0] = 0.0
    depth = 1
    piece = np.empty((4, 3))
    place = np.empty((3, 3))
    while depth > 0:
        depth -= 1
        for i in range(4):
            for j in range(3):
                piece[i, j] = stack[depth, i, j]  # as a whole would compile the message of shapes that differ
        level = piece[3, 0]
        for i in range(3):
            for j in range(3):
                place[i, j] = piece[i, 0] * corners[0, j] + piece[i, 1] * corners[1, j] + piece[i, 2] * corners[2, j]
        longest, away = 0.0, 0.0
        for i in range(3):
            edge = 0.0
            for j in range(3):
                edge += (place[i, j] - place[(i + 1) % 3, j]) ** 2
            longest = max(longest, edge)
        for j in range(3):
            away += ((place[0, j] + place[1, j] + place[2, j]) / 3.0 - x[j]) ** 2
        if away < 2.25 * longest and level < _MOST_LEVELS:
            for child in range(4):
                for i in range(3):
                    for j in range(3):
                        if child < 3:
                            stack[depth, i, j] = 0.5 * (piece[i, j] + piece[child, j])
                        else:
                            stack[depth, i, j] = 0.5 * (piece[i, j] + piece[(i + 1) % 3, j])
                stack[depth, 3, 0] = level + 1.0
                depth += 1
            continue
        part = area * 0.25**level
        for q in range(rule.shape[0]):
            b0 = rule[q, 0] * piece[0, 0] + rule[q, 1] * piece[1, 0] + rule[q, 2] * piece[2, 0]
            b1 = rule[q, 0] * piece[0, 1] + rule[q, 1] * piece[1, 1] + rule[q, 2] * piece[2, 1]
            b2 = rule[q, 0] * piece[0, 2] + rule[q, 1] * piece[1, 2] + rule[q, 2] * piece[2, 2]
            y0 = b0 * corners[0, 0] + b1 * corners[1, 0] + b2 * corners[2, 0]
            y1 = b0 * corners[0, 1] + b1 * corners[1, 1] + b2 * corners[2, 1]
            y2 = b0 * corners[0, 2] + b1 * corners[1, 2] + b2 * corners[2, 2]
            _add_point(x, y0, y1, y2, normal, part * rule[q, 3], k, b0, b1, b2, single, double, static)


@_inner
def _corner_triangle(corners, area, k, corner, points, weights, single):  # type: ignore[no-untyped-def]
    """Integrate G phi_a over a triangle with x at one of its corners, in Duffy's coordinates.

    y = x + u ((1 - v) e1 + v e2) has the Jacobian 2 area u, and r = u |(1 - v) e1 + v e2|.
    """
    after, last = (corner + 1) % 3, (corner + 2) % 3
    for q in range(points.size):
        v = points[q]
        length = 0.0
        for j in range(3):
            side = (1.0 - v) * corners[after, j] + v * corners[last, j] - corners[corner, j]
            length += side * side
        length = math.sqrt(length)
        for p in range(points.size):
            u = points[p]
            kr = k * u * length
            scale = 2.0 * area * weights[q] * weights[p] / (4.0 * math.pi * length)
            g = complex(scale * math.cos(kr), -scale * math.sin(kr))
            single[corner] += (1.0 - u) * g
            single[after] += u * (1.0 - v) * g
            single[last] += u * v * g


@_inner
def _sine_and_cosine(x):  # type: ignore[no-untyped-def]
    """Sine and cosine of a positive argument by Taylor's series about the nearest multiple of π/2.

    Error below 1e-13 for arguments below 1e4. Unlike the library's functions a loop over it becomes vector code.
    """
    turns = (x * (2.0 / math.pi) + _ROUNDING) - _ROUNDING
    y = x - turns * 1.5707963267341256
    y -= turns * 6.077100506506192e-11
    z = y * y
    s = y * (1.0 + z * (_S[0] + z * (_S[1] + z * (_S[2] + z * (_S[3] + z * (_S[4] + z * _S[5]))))))
    c = 1.0 + z * (_C[0] + z * (_C[1] + z * (_C[2] + z * (_C[3] + z * (_C[4] + z * (_C[5] + z * _C[6]))))))
    quarter = turns - 4.0 * ((0.25 * turns - 0.375 + _ROUNDING) - _ROUNDING)
    # 1 at odd multiples, where sine and cosine change places
    swapped = quarter - 2.0 * ((0.5 * quarter - 0.25 + _ROUNDING) - _ROUNDING)
    high = (quarter - swapped) * 0.5  # 1 in the third and fourth quarter
    sign_s = 1.0 - 2.0 * high
    sign_c = sign_s * (1.0 - 2.0 * swapped)
    return sign_s * (s + swapped * (c - s)), sign_c * (c + swapped * (s - c))


_ROUNDING = 1.5 * 2.0**52  # numbers up to 2^51 that are added to it and taken from it again are whole
_S = tuple((-1.0) ** (n + 1) / math.factorial(2 * n + 3) for n in range(6))
_C = tuple((-1.0) ** (n + 1) / math.factorial(2 * n + 2) for n in range(7))


@_inner
def _far_points(x, places, normals, weights, far, k, g, dg, dg0):  # type: ignore[no-untyped-def]
    """Weighted G, dG/dn and dG_0/dn at a quadrature point of some triangles; zero on those that are not far from x.

    Parameters
    ----------
    places, normals : ndarray, shape (3, n)
        Points y, and normals there.
    weights, far : ndarray, shape (n,)
        Weights, and 1 for a triangle that is far from x, else 0.
    g, dg : ndarray, shape (2, n)
        Filled with real and imaginary parts.
    dg0 : ndarray, shape (n,)
    """
    for e in range(weights.size):
        d0, d1, d2 = places[0, e] - x[0], places[1, e] - x[1], places[2, e] - x[2]
        square = d0 * d0 + d1 * d1 + d2 * d2
        r = math.sqrt(square)
        scale = weights[e] / r if far[e] > 0.0 else 0.0
        kr = k * r
        sine, cosine = _sine_and_cosine(kr)
        along = (d0 * normals[0, e] + d1 * normals[1, e] + d2 * normals[2, e]) / square
        projected = -scale * along if far[e] > 0.0 else 0.0
        g[0, e], g[1, e] = scale * cosine, -scale * sine
        dg[0, e], dg[1, e] = projected * (cosine + kr * sine), projected * (kr * cosine - sine)
        dg0[e] = projected


@_summed
def _sum(values):  # type: ignore[no-untyped-def]
    total = 0.0
    for e in range(values.size):
        total += values[e]
    return total


_BLOCK = 256  # triangles whose values at quadrature points are held at once: 30 kB, which the nearest cache has


@_inner
def _find_far(x, centers, reaches, far):  # type: ignore[no-untyped-def]
    """Set 1 where a triangle's centre is farther from x than the square root of its reach, else 0."""
    for e in range(far.size):
        away = (centers[0, e] - x[0]) ** 2 + (centers[1, e] - x[1]) ** 2 + (centers[2, e] - x[2]) ** 2
        far[e] = 1.0 if away > reaches[e] else 0.0


def _in_blocks(values: FloatArray) -> FloatArray:
    """Values of triangles, shape (..., n), in blocks of `_BLOCK` filled up with zeros, (n_blocks, ..., _BLOCK)."""
    count = values.shape[-1]
    blocks = -(-count // _BLOCK)
    filled = np.zeros((*values.shape[:-1], blocks * _BLOCK))
    filled[..., :count] = values
    return np.ascontiguousarray(np.moveaxis(filled.reshape(*values.shape[:-1], blocks, _BLOCK), -2, 0))


@_compiled
def _integrate_rows(  # type: ignore[no-untyped-def]
    targets, vertex, corners, triangles, normals, areas, reaches, centers, k, places, point_normals, weights,
    near_rule, duffy, duffy_weights, layer, double, static,
):  # fmt: skip
    """Integrals over all triangles for some points; `vertex` is the vertex at a point, or -1.

    With the three points of degree 2 the shape function of a corner is 2/3 at its own and 1/6 at the others.
    `centers` to `weights` are in blocks, see :func:`_in_blocks`; `layer`, `double` and `static` are added to.
    """
    count, blocks = triangles.shape[0], weights.shape[0]
    far, near = np.empty((blocks, _BLOCK)), np.empty(count, np.int64)
    far_g, far_dg, far_dg0 = np.empty((2, _BLOCK)), np.empty((3, 2, _BLOCK)), np.empty(_BLOCK)
    g, dg, dg0 = np.empty(3, np.complex128), np.empty(3, np.complex128), np.empty(3)
    stack = np.empty((4 * _MOST_LEVELS + 4, 4, 3))
    for t in range(targets.shape[0]):
        x = targets[t]
        total, found = 0.0, 0
        for block in range(blocks):
            start = block * _BLOCK
            length = min(_BLOCK, count - start)
            _find_far(x, centers[block], reaches[block], far[block])
            for e in range(length):
                if far[block, e] == 0.0:
                    near[found] = start + e
                    found += 1
            for q in range(3):
                _far_points(
                    x, places[block, q], point_normals[block], weights[block], far[block], k,
                    far_g, far_dg[q], far_dg0,
                )  # fmt: skip
                total += _sum(far_dg0)
                for part in range(2):
                    layer[t, part, q, start : start + length] += far_g[part, :length]
            for e in range(length):
                real = (far_dg[0, 0, e] + far_dg[1, 0, e] + far_dg[2, 0, e]) / 6.0
                imaginary = (far_dg[0, 1, e] + far_dg[1, 1, e] + far_dg[2, 1, e]) / 6.0
                for i in range(3):
                    value = complex(real + 0.5 * far_dg[i, 0, e], imaginary + 0.5 * far_dg[i, 1, e])
                    double[t, triangles[start + e, i]] += value
        for place in range(found):
            e = near[place]
            for i in range(3):
                g[i], dg[i], dg0[i] = 0.0, 0.0, 0.0
            corner = -1
            for i in range(3):
                if triangles[e, i] == vertex[t]:
                    corner = i
            if corner >= 0:
                _corner_triangle(corners[e], areas[e], k, corner, duffy, duffy_weights, g)
            else:
                _near_triangle(x, corners[e], normals[e], areas[e], k, near_rule, g, dg, dg0, stack)
            mean = (g[0] + g[1] + g[2]) / 3.0
            for i in range(3):
                # Values at the three points are S q of those at the corners, and S⁻¹ = 2 − 1/3.
                layer[t, 0, i, e] += 2.0 * g[i].real - mean.real
                layer[t, 1, i, e] += 2.0 * g[i].imag - mean.imag
                double[t, triangles[e, i]] += dg[i]
                total += dg0[i]
        static[t] += total


_LAYER = 4_000_000  # values of Green's function that are held at once: 32 MB
_ROWS = 64  # directions whose phases are held at once: 32 MB with 10,000 triangles


@dataclass(frozen=True)
class SourcePoints:
    """Quadrature points of degree 2 on each triangle, for points far from it.

    Attributes
    ----------
    places, normals : ndarray, shape (3, n)
        Places [m] and unit normals.
    weights : ndarray, shape (n,)
        Area that each stands for [m²].
    triangles : ndarray of int, shape (n_triangles, 3)
    """

    places: FloatArray
    normals: FloatArray
    weights: FloatArray
    triangles: IntArray

    @classmethod
    def of(cls, surface: RadiatingSurface) -> "SourcePoints":
        """Points of a surface."""
        places = np.einsum("qa,eaj->jeq", _DEGREE_2[:, :3], surface.corners).reshape(3, -1)
        normals = np.repeat(surface.normals, len(_DEGREE_2), axis=0).T
        weights = np.outer(surface.areas, _DEGREE_2[:, 3]).ravel()
        return cls(np.ascontiguousarray(places), np.ascontiguousarray(normals), weights, surface.triangles)


def linear_projection(surface: RadiatingSurface, field: Callable[[FloatArray], ComplexArray]) -> ComplexArray:
    """L2 projection of a field on the linear functions of each triangle, shape (3 n_triangles, n).

    Parameters
    ----------
    surface : RadiatingSurface
    field : callable
        Takes a point of each triangle, shape (n_triangles, 3) [m], to values, shape (n_triangles, n).
    """
    moments = sum(
        weight * shares[None, :, None] * field(np.einsum("a,eaj->ej", shares, surface.corners))[:, None]
        for *barycentric, weight in _DEGREE_4
        for shares in (np.array(barycentric),)
    )
    return np.asarray(np.einsum("ab,ebn->ean", _TO_CORNERS, moments).reshape(3 * len(surface.triangles), -1))


@dataclass(frozen=True)
class RealParts:
    """Complex columns as real ones, for products of real numbers: a velocity in phase has an imaginary flux alone.

    Attributes
    ----------
    parts : tuple of (complex, ndarray of int, ndarray)
        Factor 1 or i, the columns of which this part is not zero, and it, shape (m, n_of_them).
    columns : int
    """

    parts: tuple[tuple[complex, IntArray, FloatArray], ...]
    columns: int

    @classmethod
    def of(cls, values: ComplexArray) -> "RealParts":
        """Columns of shape (m, n)."""
        parts = []
        for factor, part in ((1.0 + 0.0j, values.real), (1.0j, values.imag)):
            filled = np.flatnonzero(part.any(axis=0))
            parts.append((factor, filled, np.ascontiguousarray(part[:, filled])))
        return cls(tuple(parts), values.shape[1])

    def times(self, real: FloatArray, imaginary: FloatArray) -> ComplexArray:
        """Return (real + i imaginary) x, matrices of shape (k, m)."""
        total = np.zeros((len(real), self.columns), dtype=np.complex128)
        for factor, filled, part in self.parts:
            total[:, filled] += factor * (real @ part + 1j * (imaginary @ part))
        return total


def point_flux(flux: ComplexArray) -> RealParts:
    """Flux at the quadrature points of degree 2 from that at the corners of the triangles, shape (3 n_triangles, n)."""
    columns = flux.shape[1]
    return RealParts.of(np.einsum("qa,ean->qen", _DEGREE_2[:, :3], flux.reshape(-1, 3, columns)).reshape(-1, columns))


@dataclass(frozen=True)
class SurfaceIntegrals:
    """Integrals over a surface for some points x.

    Attributes
    ----------
    single : ndarray, shape (n_points, n)
        ∫ G q dS.
    double : ndarray, shape (n_points, n_vertices)
        ∫ ∂G/∂n φ dS of each vertex's shape function.
    static : ndarray, shape (n_points,)
        ∫ ∂G₀/∂n dS.
    """

    single: ComplexArray
    double: ComplexArray
    static: FloatArray


def surface_integrals(
    surface: RadiatingSurface,
    points: FloatArray,
    own: IntArray | None,
    wavenumber: float,
    flux: RealParts,
    images: tuple[FloatArray, IntArray] | None = None,
) -> SurfaceIntegrals:
    """Integrate Green's function and its normal derivative over a surface.

    Parameters
    ----------
    surface : RadiatingSurface
    points : ndarray, shape (n_points, 3)
        x [m].
    own : ndarray of int, shape (n_points,), or None
        Vertex that each point is, or -1; None where no point is a vertex.
    wavenumber : float
        k [rad/m].
    flux : RealParts
        q, see :func:`point_flux`.
    images : tuple of ndarray, optional
        A further point for each, and the vertex that it is or -1, whose integrals are added: its mirror image.
    """
    vertex = np.full(len(points), -1) if own is None else own
    count = len(surface.triangles)
    double = np.zeros((len(points), len(surface.points)), dtype=np.complex128)
    static = np.zeros(len(points))
    single = np.zeros((len(points), flux.columns), dtype=np.complex128)
    shares = _DEGREE_2[:, :3]
    reaches, centers, quadrature, normals, weights = (
        _in_blocks(values)
        for values in (
            9.0 * surface.lengths**2,
            surface.corners.mean(axis=1).T,
            np.einsum("qa,eaj->qje", shares, surface.corners),
            surface.normals.T,
            surface.areas / (12.0 * math.pi),
        )
    )
    sets = [(np.ascontiguousarray(points), vertex)]
    if images is not None:
        sets.append((np.ascontiguousarray(images[0]), images[1]))
    rows = max(_LAYER // (6 * count), 1)
    layer = np.empty((min(rows, len(points)), 2, 3, count))
    for start in range(0, len(points), rows):
        some = slice(start, min(start + rows, len(points)))
        part = layer[: some.stop - start]
        part[:] = 0.0
        for places, vertices in sets:
            _integrate_rows(
                places[some], vertices[some], surface.corners, surface.triangles, surface.normals, surface.areas,
                reaches, centers, wavenumber, quadrature, normals, weights,
                _DEGREE_4, _POINTS, _WEIGHTS, part, double[some], static[some],
            )  # fmt: skip
        real, imaginary = np.moveaxis(part.reshape(-1, 2, 3 * count), 1, 0)
        single[some] = flux.times(real, imaginary)
    return SurfaceIntegrals(single, double, static)


@_compiled
def _direction_rows(  # type: ignore[no-untyped-def]
    directions, places, normals, weights, triangles, k, cosines, sines, double
):
    """Set cosine and sine of k d . y; add the weighted (d . n) exp(i k d . y) of each vertex's shape function."""
    for d in range(directions.shape[0]):
        d0, d1, d2 = directions[d, 0], directions[d, 1], directions[d, 2]
        for q in range(places.shape[1]):
            along = d0 * places[0, q] + d1 * places[1, q] + d2 * places[2, q]
            sine, cosine = _sine_and_cosine(math.fabs(k * along))
            cosines[d, q] = cosine
            sines[d, q] = math.copysign(1.0, along) * sine
        for e in range(triangles.shape[0]):
            at = 3 * e
            scale = weights[at] * (d0 * normals[0, at] + d1 * normals[1, at] + d2 * normals[2, at])
            real = (cosines[d, at] + cosines[d, at + 1] + cosines[d, at + 2]) / 6.0
            imaginary = (sines[d, at] + sines[d, at + 1] + sines[d, at + 2]) / 6.0
            for i in range(3):
                value = complex(real + 0.5 * cosines[d, at + i], imaginary + 0.5 * sines[d, at + i])
                double[d, triangles[e, i]] += scale * value


@_compiled
def _solid_angles(points, corners, angles):  # type: ignore[no-untyped-def]
    """Solid angles of all triangles together, see `solid_angles`."""
    to, length = np.empty((3, 3)), np.empty(3)
    for p in range(points.shape[0]):
        total = 0.0
        for e in range(corners.shape[0]):
            for i in range(3):
                for j in range(3):
                    to[i, j] = corners[e, i, j] - points[p, j]
                length[i] = math.sqrt(to[i, 0] * to[i, 0] + to[i, 1] * to[i, 1] + to[i, 2] * to[i, 2])
            above, below = 0.0, length[0] * length[1] * length[2]
            for j in range(3):
                k, m = (j + 1) % 3, (j + 2) % 3
                above += to[0, j] * (to[1, k] * to[2, m] - to[1, m] * to[2, k])
                below += length[2] * to[0, j] * to[1, j] + length[0] * to[1, j] * to[2, j]
                below += length[1] * to[2, j] * to[0, j]
            total += math.atan2(above, below)
        angles[p] = 2.0 * total


def far_field_amplitudes(
    source: SourcePoints, directions: FloatArray, center: FloatArray, wavenumber: float,
    pressure: ComplexArray, flux: ComplexArray,
) -> ComplexArray:  # fmt: skip
    """Amplitude F of the far field F exp(-i k r) / r of a surface, without images, shape (n_directions, n).

    ``F(d) = (1 / 4 pi) integral of (i k (d . n) p - q) exp(i k d . (y - center)) dS``
    """
    columns = pressure.shape[1]
    at_points = np.einsum("qa,ean->eqn", _DEGREE_2[:, :3], flux.reshape(-1, 3, columns)).reshape(-1, columns)
    rate = RealParts.of(source.weights[:, None] * at_points)
    far = np.empty((len(directions), columns), dtype=np.complex128)
    places = np.ascontiguousarray(source.places - center[:, None])
    for start in range(0, len(directions), _ROWS):
        some = np.ascontiguousarray(directions[start : start + _ROWS])
        phases = np.empty((2, len(some), places.shape[1]))
        double = np.zeros((len(some), len(pressure)), dtype=np.complex128)
        _direction_rows(
            some, places, source.normals, source.weights, source.triangles, wavenumber, phases[0], phases[1], double
        )
        far[start : start + _ROWS] = 1j * wavenumber * (double @ pressure) - rate.times(*phases)
    return far / (4.0 * math.pi)


def solid_angles(surface: RadiatingSurface, points: FloatArray) -> FloatArray:
    """Solid angle that a closed surface takes up seen from points [sr]: 4 pi inside, 0 outside.

    A. van Oosterom and J. Strackee, "The solid angle of a plane triangle", IEEE Transactions on Biomedical Engineering
    30 (1983), 125-126.
    """
    angles = np.empty(len(points))
    _solid_angles(np.ascontiguousarray(points, dtype=np.float64), surface.corners, angles)
    return angles
