"""Regions of the surface of any mesh by place: facets in a box, on a plane, in a circle, of a bore."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from gearwhine.meshes.bores import (
    LEAST_ROUND,
    CylindricalBore,
    describe_bore,
    find_bores,
    fits_circle,
    joined_by_span,
    unit_vector,
)
from gearwhine.meshes.elements import Facets, facet_centers, facet_corners, facet_normals, pick_facets
from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.mesh import Mesh
from gearwhine.numerics.arrays import FloatArray

_PLANE_SLACK = 1e-4  # part of the mesh's diagonal
_LEAST_NORMAL_COSINE = 0.99  # least cosine between a facet's normal and that of the plane it lies on
_CIRCLE_SLACK = 0.01  # part of the bore's diameter
_MOST_LISTED_BORES = 5


def box_facets(mesh: Mesh, low: Sequence[float], high: Sequence[float]) -> Facets:
    """Boundary facets whose corners all lie in the box from ``low`` to ``high`` [m].

    Raises
    ------
    GeometryError
        Where there is none.
    """
    inside = np.all((mesh.points >= np.asarray(low)) & (mesh.points <= np.asarray(high)), axis=1)
    facets = pick_facets(mesh.boundary, _all_corners(mesh, inside))
    if not facets:
        raise GeometryError(
            f"no facet of the surface lies in the box from {_triple(low)} to {_triple(high)} m; "
            f"the housing spans {_triple(mesh.bounds[0])} to {_triple(mesh.bounds[1])} m"
        )
    return facets


def plane_facets(mesh: Mesh, point: Sequence[float], normal: Sequence[float]) -> Facets:
    """Boundary facets on a plane, of either orientation.

    Parameters
    ----------
    mesh : Mesh
    point : sequence of float
        A point of the plane [m].
    normal : sequence of float
        Normal of the plane, of any length.

    Raises
    ------
    GeometryError
        Where there is none; the message says between which planes the housing lies, and the nearest one that holds a
        flat part of its surface.

    Notes
    -----
    A facet lies on the plane where its corners are within 1e-4 of the housing's diagonal of it, and its own normal is
    within 8° of the plane's.
    """
    axis = unit_vector(normal)
    level = float(np.dot(point, axis))
    heights = mesh.points @ axis
    slack = _PLANE_SLACK * float(np.linalg.norm(mesh.bounds[1] - mesh.bounds[0]))
    along = np.abs(facet_normals(mesh.points, mesh.boundary) @ axis) > _LEAST_NORMAL_COSINE
    facets = pick_facets(mesh.boundary, _all_corners(mesh, np.abs(heights - level) <= slack) & along)
    if facets:
        return facets
    ends = heights[mesh.used_nodes]
    message = (
        f"no facet of the surface lies on the plane at {level:.6g} m along {_triple(axis)}; the housing spans "
        f"{ends.min():.6g} to {ends.max():.6g} m along it"
    )
    flat = pick_facets(mesh.boundary, along)
    if flat:
        levels = heights[facet_corners(flat)]
        message += (
            f", and the nearest facet that looks that way lies at {levels[np.abs(levels - level).argmin()]:.6g} m"
        )
    raise GeometryError(message)


def circle_facets(mesh: Mesh, center: Sequence[float], normal: Sequence[float], diameter: float) -> Facets:
    """Boundary facets of a flat face in a circle, such as the area of a part that a bolt clamps.

    Parameters
    ----------
    mesh : Mesh
    center : sequence of float
        Middle of the circle, on the face or near it [m].
    normal : sequence of float
        Outward normal of the face, of any length.
    diameter : float
        Diameter of the circle [m]; facets whose middles lie in the circle belong to it.

    Raises
    ------
    GeometryError
        Where there is none within half a diameter of the centre along the normal.

    Notes
    -----
    Among several such faces one behind the other, as on both sides of a thin plate, the nearest to the centre counts.
    """
    axis = unit_vector(normal)
    offset = facet_centers(mesh.points, mesh.boundary) - np.asarray(center)
    height = offset @ axis
    beside = np.linalg.norm(offset - height[:, None] * axis, axis=1)
    looks = facet_normals(mesh.points, mesh.boundary) @ axis > _LEAST_NORMAL_COSINE
    chosen = looks & (beside <= diameter / 2.0) & (np.abs(height) <= diameter / 2.0)
    if not chosen.any():
        raise GeometryError(
            f"no facet of the surface that looks along {_triple(axis)} lies in a circle of {diameter:.6g} m around "
            f"{_triple(center)} m; is it wider than the elements there?"
        )
    level = height[chosen][np.abs(height[chosen]).argmin()]
    slack = _PLANE_SLACK * float(np.linalg.norm(mesh.bounds[1] - mesh.bounds[0]))
    return pick_facets(mesh.boundary, chosen & (np.abs(height - level) <= slack))


def cylinder_facets(
    mesh: Mesh,
    center: Sequence[float],
    diameter: float,
    *,
    axis: Sequence[float] = (0.0, 0.0, 1.0),
    length: float | None = None,
) -> Facets:
    """Find the facets of the bore nearest to a place.

    Parameters
    ----------
    mesh : Mesh
    center : sequence of float
        A point on the bore's axis [m], at most a diameter beyond its ends. Among several bores on that axis, the one
        with its middle nearest along the axis counts.
    diameter : float
        Diameter [m].
    axis : sequence of float
        Direction of the axis, of any length.
    length : float, optional
        Length of the part that is wanted, half of it to each side of the centre [m]; by default all of the bore.

    Returns
    -------
    tuple of ElementBlock
        Facets whose corners lie on the cylinder and that look towards its axis: the bore, not the outside of a boss
        of the same diameter.

    Raises
    ------
    GeometryError
        Where there is no such bore; the message lists the bores near by.

    Notes
    -----
    Corners may be off the circle by 1 % of the diameter, in place and in radius together. Parts at the same height
    belong together, whether or not they touch: the halves of a bore that is split at its axis, the sides of a keyway.
    Together they must go round at least 45 % of the circle.
    """
    direction = unit_vector(axis)
    if not diameter > 0.0:
        raise GeometryError(f"a bore of {diameter} m diameter: the diameter must be positive")
    place = np.asarray(center, dtype=np.float64)
    on = fits_circle(mesh, place, diameter / 2, direction, _CIRCLE_SLACK * diameter)
    if length is not None:
        heights = (mesh.points - place) @ direction
        on &= _all_corners(mesh, np.abs(heights) <= length / 2 + _CIRCLE_SLACK * diameter)
    bores = joined_by_span(mesh, pick_facets(mesh.boundary, on), place, direction) if on.any() else ()
    bores = tuple(bore for bore in bores if bore.roundness >= LEAST_ROUND)
    along = [abs(float(np.dot(np.subtract(bore.center, place), direction))) for bore in bores]
    # A centre far away on the axis is a mistake, and would give the seat a long lever arm.
    if bores and min(along) <= diameter + bores[int(np.argmin(along))].length / 2:
        return bores[int(np.argmin(along))].facets
    raise GeometryError(_no_bore(mesh, place, diameter, direction))


def with_bore(mesh: Mesh, name: str, center: Sequence[float], diameter: float) -> Mesh:
    """Return the mesh with a bore along z as a named surface; unchanged where it has a surface of that name already.

    Parameters and errors are those of :func:`cylinder_facets`.
    """
    if name in mesh.surfaces:
        return mesh
    return replace(mesh, surfaces={**mesh.surfaces, name: cylinder_facets(mesh, center, diameter)})


def _no_bore(mesh: Mesh, center: FloatArray, diameter: float, axis: FloatArray) -> str:
    """Message that names the bore asked for and the bores of the mesh, nearest first."""
    message = f"no bore of {1e3 * diameter:.5g} mm around {_place(center)} mm"
    bores = find_bores(mesh, axis=axis)
    if not bores:
        return f"{message}; the mesh has no bore along {_triple(axis)}"

    def distance(bore: CylindricalBore) -> float:
        return float(np.linalg.norm(np.subtract(bore.center, center))) + abs(bore.diameter - diameter)

    near = sorted(bores, key=distance)[:_MOST_LISTED_BORES]
    more = f" and {len(bores) - len(near)} more" if len(bores) > len(near) else ""
    return f"{message}; bores found: {'; '.join(describe_bore(bore) for bore in near)}{more}"


def _all_corners(mesh: Mesh, nodes: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """For each boundary facet, whether all its corners are among some nodes."""
    return np.concatenate([nodes[block.corners].all(axis=1) for block in mesh.boundary])


def _triple(values: Sequence[float] | FloatArray) -> str:
    return "(" + ", ".join(f"{value:g}" for value in values) + ")"


def _place(values: Sequence[float] | FloatArray) -> str:
    return "(" + ", ".join(f"{1e3 * value:.5g}" for value in values) + ")"
