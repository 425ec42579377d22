"""Known sources inside a radiating surface: monopoles whose sound field is exact, to prove boundary elements.

A monopole at y inside a closed surface radiates, for the time factor exp(+i ω t),

``p(x) = exp(−i k r) / r``, ``r = |x − y|``

over a hard plane together with its image. That is a sound field of the air outside, and it is the solution for its own
normal velocity on the surface. The boundary elements solve for the same velocity, beside those of the housing and with
the same factorisation; their pressure is compared with the exact one, at every vertex and at points in the air.

This proof sees what others do not: where the equations leave one vertex nearly free, its pressure has no part in
them, and hence none in the pressure inside and hardly any in the power.

The error is relative to the amplitude of the source at the same place, Σ 1/r over source and image, which has no
zeros, so that an error counts alike near the source and far from it. Two sources stand apart from each other, so that
each part of a long body is near one.

Vertices over a floor that is nearer than a tenth of an edge do not count. Like a thin plate's, the equations of a face
and of its image are nearly the same there, and the pressure in such a gap is lost, but not that outside of it: a sole
of 26 mm triangles 1 mm above the floor errs by 400 % and all other vertices by 5 %, as they do without a gap.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.housing.acoustics.boundary_integrals import linear_projection
from gearwhine.housing.acoustics.medium import HardPlane
from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.numerics.arrays import ComplexArray, FloatArray

SOURCE_DEPTH = 1.0
"""Longest edges from the centre of every triangle that a source has to stand away from.

The linear functions of a triangle follow exp(−i k r) / r the worse the nearer the source is. From this distance on
the wavelength alone counts: at six edges a wavelength, and at three, sources three times as deep have
the same error within a tenth; at twelve the largest is less than twice as much.
"""

_GAP = 0.1  # longest edges between a triangle and the floor that it faces, below which its vertices do not count
_FACING_FLOOR_COSINE = -0.5  # cosine of its normal against the floor's
_LEAST_SECOND_DEPTH = 0.6  # least depth of the second source, as a part of the largest depth
_ROWS = 64  # points whose distances from all triangles are held at once


@dataclass(frozen=True)
class SourceError:
    """Error of the pressure of known sources.

    Attributes
    ----------
    largest : float
        Largest error of all vertices that count, relative to the amplitude of the source there. Infinite where no
        source can stand, zero where there is nothing to prove.
    rms : float
        Root mean square over the vertices.
    place : tuple of float
        Vertex of the largest error [m].
    """

    largest: float
    rms: float
    place: tuple[float, float, float] = (np.nan, np.nan, np.nan)


NOTHING_TO_PROVE = SourceError(0.0, 0.0)
"""Source error of a flat face and of an estimate, which solve no equations."""
NO_SOURCE = SourceError(np.inf, np.inf)
"""Source error of a body that is too thin, beside its triangles, for a source inside."""


@dataclass(frozen=True)
class KnownSources:
    """Monopoles inside a surface, each alone or with its image in a hard plane.

    Attributes
    ----------
    places : ndarray, shape (n, 3)
        Places [m].
    plane : HardPlane or None
    """

    places: FloatArray
    plane: HardPlane | None = None

    @classmethod
    def inside(cls, surface: RadiatingSurface, candidates: FloatArray, plane: HardPlane | None) -> "KnownSources":
        """Choose two of some points inside a surface: the deepest, and one that is deep and far from it.

        Parameters
        ----------
        surface : RadiatingSurface
        candidates : ndarray, shape (n, 3)
            Points inside [m].
        plane : HardPlane or None

        Returns
        -------
        KnownSources
            None, one or two of the points, each at least `SOURCE_DEPTH` deep.
        """
        deep = depths(surface, candidates)
        if not len(deep) or deep.max() < SOURCE_DEPTH:
            return cls(np.zeros((0, 3)), plane)
        first = int(np.argmax(deep))
        deep_enough = deep >= max(_LEAST_SECOND_DEPTH * deep[first], SOURCE_DEPTH)
        apart = np.where(deep_enough, np.linalg.norm(candidates - candidates[first], axis=1), 0.0)
        second = int(np.argmax(apart))
        return cls(candidates[[first, second] if apart[second] > 0.0 else [first]], plane)

    def _arms(self, points: FloatArray) -> list[FloatArray]:
        """Points from the sources and from their images [m], each of shape (n_points, n, 3)."""
        sets = [self.places] if self.plane is None else [self.places, self.plane.mirror(self.places)]
        return [points[:, None] - places for places in sets]

    def amplitude(self, points: FloatArray) -> FloatArray:
        """Σ 1/r over source and image [1/m], shape (n_points, n)."""
        return np.asarray(sum(1.0 / np.linalg.norm(arm, axis=2) for arm in self._arms(points)))

    def pressure(self, points: FloatArray, wavenumber: float) -> ComplexArray:
        """Exact pressure exp(−i k r) / r of source and image, shape (n_points, n)."""
        pressure = np.zeros((len(points), len(self.places)), dtype=np.complex128)
        for arm in self._arms(points):
            r = np.linalg.norm(arm, axis=2)
            pressure += np.exp(-1j * wavenumber * r) / r
        return pressure

    def slope(self, points: FloatArray, normals: FloatArray, wavenumber: float) -> ComplexArray:
        """Exact derivative ∂p/∂n of the pressure along normals, shape (n_points, n)."""
        slope = np.zeros((len(points), len(self.places)), dtype=np.complex128)
        for arm in self._arms(points):
            r = np.linalg.norm(arm, axis=2)
            along = np.einsum("psj,pj->ps", arm, normals)
            slope -= (1.0 + 1j * wavenumber * r) * np.exp(-1j * wavenumber * r) * along / r**3
        return slope

    def flux(self, surface: RadiatingSurface, wavenumber: float) -> ComplexArray:
        """∂p/∂n at the corners of the triangles as linear functions, shape (3 n_triangles, n)."""
        return linear_projection(surface, lambda points: self.slope(points, surface.normals, wavenumber))

    def linear_pressure(self, surface: RadiatingSurface, wavenumber: float) -> ComplexArray:
        """Exact pressure as linear functions that equal it on the average, at the vertices, shape (n_vertices, n).

        Each triangle has its own linear function; a vertex has the mean of those of its triangles.
        """
        corners = linear_projection(surface, lambda points: self.pressure(points, wavenumber))
        totals = np.zeros((len(surface.points), corners.shape[1]), dtype=np.complex128)
        np.add.at(totals, surface.triangles.ravel(), corners)
        return np.asarray(totals / np.bincount(surface.triangles.ravel())[:, None])


@dataclass(frozen=True)
class KnownField:
    """Pressure that boundary elements found for known sources at one frequency.

    Attributes
    ----------
    surface : RadiatingSurface
    sources : KnownSources
        The sources, at least one.
    wavenumber : float
        k [rad/m].
    pressure : ndarray, shape (n_vertices, n)
        The computed pressure, in the unit of the sources' amplitude.
    """

    surface: RadiatingSurface
    sources: KnownSources
    wavenumber: float
    pressure: ComplexArray

    @cached_property
    def errors(self) -> FloatArray:
        """Error at every vertex, relative to the amplitude there, shape (n_vertices, n)."""
        exact = self.sources.linear_pressure(self.surface, self.wavenumber)
        return np.asarray(np.abs(self.pressure - exact) / self.sources.amplitude(self.surface.points))

    @cached_property
    def error(self) -> SourceError:
        """Error of the source whose error is largest, at the vertices that do not lie over a narrow gap."""
        counted = np.flatnonzero(~over_narrow_gap(self.surface, self.sources.plane))
        errors = self.errors[counted]
        x, y, z = self.surface.points[counted[np.argmax(errors.max(axis=1))]].tolist()
        return SourceError(float(errors.max()), float(np.sqrt((errors**2).mean(axis=0)).max()), (x, y, z))

    def errors_of(self, points: FloatArray, pressure: ComplexArray) -> FloatArray:
        """Error of the pressure found at points in the air, relative to the amplitude there, shape (n_points,).

        Parameters
        ----------
        points : ndarray, shape (n_points, 3)
            Points [m].
        pressure : ndarray, shape (n_points, n)
            Pressure of each source.
        """
        apart = np.abs(pressure - self.sources.pressure(points, self.wavenumber)) / self.sources.amplitude(points)
        return np.asarray(apart.max(axis=1))


def over_narrow_gap(surface: RadiatingSurface, plane: HardPlane | None) -> npt.NDArray[np.bool_]:
    """Whether each vertex belongs to a triangle that faces a floor nearer than a tenth of its longest edge."""
    narrow = np.zeros(len(surface.points), dtype=bool)
    if plane is not None:
        heights = plane.height(surface.points)[surface.triangles].max(axis=1)
        facing = surface.normals @ plane.normal < _FACING_FLOOR_COSINE
        narrow[surface.triangles[facing & (heights < _GAP * surface.lengths)]] = True
    return narrow


def depths(surface: RadiatingSurface, points: FloatArray) -> FloatArray:
    """Distance of points from the centre of the nearest triangle in its longest edges, shape (n_points,)."""
    centers = surface.corners.mean(axis=1)
    parts = [np.zeros(0)]
    for start in range(0, len(points), _ROWS):
        apart = np.linalg.norm(points[start : start + _ROWS, None] - centers, axis=2)
        parts.append((apart / surface.lengths).min(axis=1))
    return np.concatenate(parts)
