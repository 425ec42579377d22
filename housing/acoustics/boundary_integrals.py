"""Boundary integrals of the Helmholtz equation over flat triangles with linear shape functions.

The free-space Green's function of the time factor exp(+i omega t) is

``G(x, y) = exp(-i k r) / (4 pi r)``, ``r = |y - x|``

and its derivative along the normal n at y is ``-(1 + i k r) exp(-i k r) ((y - x) . n) / (4 pi r³)``.

Integrals over triangles far from the point x use Dunavant's rules; a triangle near x is divided until its pieces are no
longer than their distance; on a triangle with x as a corner the single layer is integrated in Duffy's coordinates, whose
Jacobian cancels 1/r, and the double layer is zero since (y - x) is normal to n.

Sources: D. A. Dunavant, "High degree efficient symmetrical Gaussian quadrature rules for the triangle", International
Journal for Numerical Methods in Engineering 21 (1985), 1129-1148; M. G. Duffy, "Quadrature over a pyramid or cube of
integrands with a singularity at a vertex", SIAM Journal on Numerical Analysis 19 (1982), 1260-1262.
"""

import math

import numba
import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.int64]

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

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(5)
_POINTS, _WEIGHTS = 0.5 * (_POINTS + 1.0), 0.5 * _WEIGHTS
_MOST_LEVELS = 7  # of division by two of a triangle near a point

_compiled = numba.njit(cache=True, nogil=True, fastmath={"contract", "arcp", "nsz"})


@_compiled
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


@_compiled
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
        piece[:] = stack[depth]
        level = piece[3, 0]
        for i in range(3):
            for j in range(3):
                place[i, j] = (
                    piece[i, 0] * corners[0, j] + piece[i, 1] * corners[1, j] + piece[i, 2] * corners[2, j]
                )
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


@_compiled
def _corner_triangle(corners, area, k, corner, points, weights, single):  # type: ignore[no-untyped-def]
    """Integrate G phi_a over a triangle with x at one of its corners, in Duffy's coordinates.

    y = x + u ((1 - v) e1 + v e2) has the Jacobian 2 area u, and r = u |(1 - v) e1 + v e2|.
    """
    one, two = (corner + 1) % 3, (corner + 2) % 3
    for q in range(points.size):
        v = points[q]
        length = 0.0
        for j in range(3):
            side = (1.0 - v) * corners[one, j] + v * corners[two, j] - corners[corner, j]
            length += side * side
        length = math.sqrt(length)
        for p in range(points.size):
            u = points[p]
            kr = k * u * length
            scale = 2.0 * area * weights[q] * weights[p] / (4.0 * math.pi * length)
            g = complex(scale * math.cos(kr), -scale * math.sin(kr))
            single[corner] += (1.0 - u) * g
            single[one] += u * (1.0 - v) * g
            single[two] += u * v * g


@_compiled
def _integrate_rows(  # type: ignore[no-untyped-def]
    targets, own, points, triangles, normals, areas, sizes, k, far_rule, middle_rule, duffy, weights, single, double, static
):
    """Integrals of all triangles for some points; `own` is the vertex that a point is, or -1."""
    corners = np.empty((3, 3))
    g, dg, dg0 = np.empty(3, np.complex128), np.empty(3, np.complex128), np.empty(3)
    stack = np.empty((4 * _MOST_LEVELS + 4, 4, 3))
    for t in range(targets.shape[0]):
        x = targets[t]
        for e in range(triangles.shape[0]):
            for i in range(3):
                g[i], dg[i], dg0[i] = 0.0, 0.0, 0.0
                for j in range(3):
                    corners[i, j] = points[triangles[e, i], j]
            corner = -1
            for i in range(3):
                if triangles[e, i] == own[t]:
                    corner = i
            if corner >= 0:
                _corner_triangle(corners, areas[e], k, corner, duffy, weights, g)
            else:
                away = 0.0
                for j in range(3):
                    away += ((corners[0, j] + corners[1, j] + corners[2, j]) / 3.0 - x[j]) ** 2
                size = sizes[e]
                if away < 2.25 * size * size:
                    _near_triangle(x, corners, normals[e], areas[e], k, middle_rule, g, dg, dg0, stack)
                elif away < 16.0 * size * size or k * size > 1.0:
                    for q in range(middle_rule.shape[0]):
                        b0, b1, b2 = middle_rule[q, 0], middle_rule[q, 1], middle_rule[q, 2]
                        y0 = b0 * corners[0, 0] + b1 * corners[1, 0] + b2 * corners[2, 0]
                        y1 = b0 * corners[0, 1] + b1 * corners[1, 1] + b2 * corners[2, 1]
                        y2 = b0 * corners[0, 2] + b1 * corners[1, 2] + b2 * corners[2, 2]
                        _add_point(x, y0, y1, y2, normals[e], areas[e] * middle_rule[q, 3], k, b0, b1, b2, g, dg, dg0)
                else:
                    for q in range(far_rule.shape[0]):
                        b0, b1, b2 = far_rule[q, 0], far_rule[q, 1], far_rule[q, 2]
                        y0 = b0 * corners[0, 0] + b1 * corners[1, 0] + b2 * corners[2, 0]
                        y1 = b0 * corners[0, 1] + b1 * corners[1, 1] + b2 * corners[2, 1]
                        y2 = b0 * corners[0, 2] + b1 * corners[1, 2] + b2 * corners[2, 2]
                        _add_point(x, y0, y1, y2, normals[e], areas[e] * far_rule[q, 3], k, b0, b1, b2, g, dg, dg0)
            for i in range(3):
                single[t, 3 * e + i] = g[i]
                double[t, triangles[e, i]] += dg[i]
                static[t] += dg0[i]
