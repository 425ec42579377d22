"""Exterior Helmholtz equation by boundary elements: direct collocation with CHIEF points, least squares.

For the time factor exp(+i ω t) the pressure p and the outward normal velocity v of a closed surface S satisfy

``c(x) p(x) = ∫ (p(y) ∂G/∂n(x, y) + i ω ρ v(y) G(x, y)) dS``, ``c(x) = 1 + ∫ ∂G₀/∂n(x, y) dS``

at a point x of S, where c is the part of the directions that leads into the air. G₀ is Green's function of Laplace's
equation; both integrals over G and G₀ use the same points, so that a constant pressure is represented exactly. The
pressure is linear on each triangle and continuous, the velocity linear on each triangle and discontinuous at edges.

At the natural frequencies of the air *inside* S with p = 0 on the wall the equation at the vertices alone is singular.
Points in the inside, where the right-hand side is zero, complete it (combined Helmholtz integral equation formulation,
CHIEF): H. A. Schenck, "Improved integral formulation for acoustic radiation problems", Journal of the Acoustical
Society of America 44 (1968), 41-58. Many points, spread at random, and least squares make an accident unlikely that
all lie on nodal surfaces; points that were not used prove it, see :attr:`SoundField.interior_residual`.

A curved pressure and its linear functions should be equal on the average over a triangle. Functions through its values
at the vertices deviate to one side everywhere: on a triangle with the edges e, the mean of a pressure with the second
derivatives H lies ``Σ eᵀ H e / 24`` below that of the linear function through its corners. The value in the equation of
a vertex is therefore ``p − B p`` with the matrix B of :func:`_curvature_correction`, except at edges and corners of the
surface, where the pressure has no second derivatives. Powers and reciprocity are two to five times as exact as without.

A hard plane mirrors the surface. Where a body stands on it, the triangles that lie in the plane are covered: they do
not radiate and are left out, and what is left is one closed body with its mirror image.

The equation of Burton and Miller, which couples the normal derivative, needs a smooth surface at the vertices and
spoils weak radiators at low frequencies; on a sphere and on boxes CHIEF was the more accurate.

Every solution of a closed surface includes the field of known sources inside, which proves it at every vertex, see
:mod:`gearwhine.housing.acoustics.known_source`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import sparse

from gearwhine.housing.acoustics.boundary_integrals import (
    RealParts,
    SourcePoints,
    SurfaceIntegrals,
    far_field_amplitudes,
    point_flux,
    solid_angles,
    surface_integrals,
)
from gearwhine.housing.acoustics.known_source import NO_SOURCE, NOTHING_TO_PROVE, KnownField, KnownSources, SourceError
from gearwhine.housing.acoustics.medium import AIR, HardPlane, Medium
from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.housing.errors import HousingError, TriangleSizeError
from gearwhine.numerics.arrays import ComplexArray, FloatArray, IntArray
from gearwhine.numerics.dense_least_squares import solve_least_squares

_TWO_PI = 2.0 * np.pi
_INNER_WEIGHT = 5.0  # weight of a CHIEF equation against one of a vertex: the box's errors are least from 3 to 10
_CHECK_POINTS = 12
_FEWEST_INNER = 30
_ROWS = 256  # equations that are assembled at once
_VAIN_ROUNDS = 50  # rounds of 64 trials without a point inside after which the search ends
# Longest edges from a triangle below which the quadrature fails: 0.3 % at 0.003 edges, 10 % at 0.001.
_NEAREST_DISTANCE = 0.01
_LEAST_SMOOTH_COSINE = np.cos(
    np.deg2rad(15.0)
)  # least cosine between a triangle's normal and the mean one of a vertex that is on no edge
_MOST_CURVATURE = 0.35
"""Largest part of a spike at a vertex that the correction takes for curvature: without a bound it is a quarter to a
half on even triangles, and nine tenths where edges differ by half. Known sources in a box of uneven triangles were off
by 140 % at a bound of 0.5, by 16 % at this one and by 7 % at 0.2; powers, reciprocity and points far away have the
correction's whole use from 0.3 on."""
_MASS = (np.ones((3, 3)) + np.eye(3)) / 12.0  # linear shape functions' mass matrix on a triangle of unit area

MOST_TRIANGLES = 16_000
"""Largest number of triangles: their matrix takes 1.4 GB, and their factorisation minutes."""


@dataclass(frozen=True)
class FarSphere:
    """Far field over all directions into the air.

    Attributes
    ----------
    weights : ndarray, shape (n_directions,)
        Solid angle that each direction stands for [sr].
    amplitudes : ndarray of complex, shape (n_directions, n)
        Amplitude F of the far field F exp(−i k r) / r [Pa m].
    """

    weights: FloatArray
    amplitudes: ComplexArray


@dataclass(frozen=True)
class SoundField:
    """Solution for some distributions of normal velocity at one frequency.

    Attributes
    ----------
    surface : RadiatingSurface
        The radiating surface.
    medium : Medium
    plane : HardPlane or None
    frequency_hz : float
    velocity : ndarray, shape (3 n_triangles, n)
        Normal velocity at the corners of each triangle [m/s].
    pressure : ndarray, shape (n_points, n)
        Pressure at the vertices [Pa], of linear functions that equal the pressure on the average over a triangle.
    inside : ndarray, shape (n_checks, n)
        Pressure at points inside that the solution did not use [Pa], where zero is exact. Empty for a baffled face,
        which has no inside, and where no point inside is far enough from the surface, as in a thin plate.
    known : KnownField or None
        Solution for known sources inside by the same equations. None for a baffled face, and where no source can stand.
    far : FarSphere or None
        The far field, where it is known already.
    """

    surface: RadiatingSurface
    medium: Medium
    plane: HardPlane | None
    frequency_hz: float
    velocity: ComplexArray
    pressure: ComplexArray
    inside: ComplexArray
    known: KnownField | None = None
    far: FarSphere | None = None

    @property
    def wavenumber(self) -> float:
        """Wavenumber k = ω / c [rad/m]."""
        return self.medium.wavenumber(self.frequency_hz)

    @property
    def baffled(self) -> bool:
        """Whether the surface is a flat face in a baffle, which has no inside."""
        return self.plane is not None and _lies_in(self.surface, self.plane)

    @property
    def interior_residual(self) -> float:
        """Root mean square of the pressure inside relative to that on the surface; the largest of all distributions.

        Zero for a baffled face. Infinite where there is an inside but no point to prove the solution.
        """
        if self.baffled:
            return 0.0
        if not len(self.inside):
            return np.inf
        size, left = (np.sqrt((np.abs(one) ** 2).mean(axis=0)) for one in (self.pressure, self.inside))
        return float((left / np.where(size > 0.0, size, 1.0)).max())

    @property
    def source_error(self) -> SourceError:
        """Error of the pressure of known sources inside at the vertices, see :class:`SourceError`."""
        if self.known is not None:
            return self.known.error
        return NOTHING_TO_PROVE if self.baffled else NO_SOURCE

    @property
    def flux(self) -> ComplexArray:
        """Normal derivative of the pressure, −i ω ρ v [Pa/m]."""
        return self.medium.flux(self.frequency_hz, self.velocity)

    @cached_property
    def velocity_products(self) -> ComplexArray:
        """∫ v̄ᵢ vⱼ dS [m⁴/s²], shape (n, n)."""
        return surface_product(self.surface, self.velocity, self.velocity)

    @property
    def pressure_at_corners(self) -> ComplexArray:
        """Pressure at the corners of each triangle [Pa], shape (3 n_triangles, n)."""
        return self.pressure[self.surface.triangles].reshape(len(self.velocity), -1)

    @cached_property
    def surface_resistance(self) -> FloatArray:
        """The radiation resistance by the intensity on the surface, Re ½∫ (v̄ᵢ pⱼ + vⱼ p̄ᵢ) dS, shape (n, n)."""
        product = surface_product(self.surface, self.velocity, self.pressure_at_corners)
        return np.asarray(0.5 * (product + product.conj().T).real)

    @cached_property
    def reciprocity_error(self) -> float:
        """Largest difference of ∫ vᵢ pⱼ dS and ∫ vⱼ pᵢ dS relative to √(∫vᵢpᵢ ∫vⱼpⱼ) in size, of two distributions."""
        product = surface_product(self.surface, self.velocity.conj(), self.pressure_at_corners)
        size = np.sqrt(np.abs(np.diag(product)))
        return float(np.max(np.abs(product - product.T) / np.outer(size, size)))

    @cached_property
    def resistance(self) -> FloatArray:
        """Radiation resistance R from the far field [W], shape (n, n): distributions times a have the power ½ aᴴ R a.

        The factors a are numbers beside velocities in m/s. Where the distributions are those of modes, per unit of the
        rates q̇ [√kg m/s] of their coordinates, a is q̇ and R is in W s²/(kg m²).

        ``R = (1 / ρ c) ∫ F̄ᵢ Fⱼ dΩ`` over the directions into the air, where F exp(−i k r) / r is the far field. R is
        positive semidefinite by construction; an error ε of the pressure that is out of phase with the velocity, which
        spoils the surface's power of a weak radiator, changes it by ε² only.
        """
        far = self.over_sphere(self.degree) if self.far is None else self.far
        return np.asarray(((far.amplitudes.conj().T * far.weights) @ far.amplitudes).real / self.medium.impedance)

    @property
    def degree(self) -> int:
        """Degree of spherical harmonics up to which the field's squares are integrated over the directions."""
        center = self.surface.points.mean(axis=0)
        reach = np.linalg.norm(self.surface.points - center, axis=1).max()
        if self.plane is not None:
            reach += abs(float(self.plane.height(center[None])[0]))
        return int(np.ceil(self.wavenumber * reach)) + 9

    def far_field(self, directions: FloatArray) -> ComplexArray:
        """Amplitude F of the far field F exp(−i k r) / r [Pa m], shape (n_directions, n).

        Parameters
        ----------
        directions : ndarray, shape (n_directions, 3)
            Unit vectors. Distances r are from the centre of the surface's vertices, or its foot on the hard plane.
        """
        far = self._without_image(directions)
        if self.plane is not None:
            images = directions - 2.0 * np.outer(directions @ self.plane.normal, self.plane.normal)
            far = far + self._without_image(images)
        return far

    def over_sphere(self, degree: int) -> FarSphere:
        """Far field in the directions into the air that integrate products of spherical harmonics of a degree."""
        if self.plane is None:
            directions, weights = _directions(degree, np.array([0.0, 1.0, 0.0]))
            return FarSphere(weights, self.far_field(directions))
        directions, weights = _directions(degree, self.plane.normal)
        of_circles = self._without_image(directions).reshape(-1, 2 * degree + 2, self.pressure.shape[1])
        upper = (of_circles + of_circles[::-1])[len(of_circles) // 2 :]
        return FarSphere(weights[len(weights) // 2 :], upper.reshape(-1, self.pressure.shape[1]))

    def _without_image(self, directions: FloatArray) -> ComplexArray:
        """Amplitude of the far field of the surface alone."""
        center = self.surface.points.mean(axis=0)
        if self.plane is not None:
            center = center - self.plane.height(center[None])[0] * self.plane.normal
        sources = SourcePoints.of(self.surface)
        return far_field_amplitudes(sources, directions, center, self.wavenumber, self.pressure, self.flux)

    def pressure_at(self, points: FloatArray) -> ComplexArray:
        """Sound pressure at points in the air [Pa], shape (n_points, n).

        Raises
        ------
        HousingError
            As :func:`require_in_air`.
        """
        require_in_air(self.surface, self.plane, points)
        return _represent(self.surface, self.plane, points, self.wavenumber, self.pressure, self.flux)

    def source_error_at(self, points: FloatArray) -> FloatArray:
        """Error of the pressure of known sources at points in the air, relative to their amplitude, shape (n_points,).

        Zero for a baffled face, infinite where no source can stand.

        Raises
        ------
        HousingError
            As :func:`require_in_air`.
        """
        if self.known is None:
            return np.full(len(points), self.source_error.largest)
        require_in_air(self.surface, self.plane, points)
        known_field = self.known
        flux = known_field.sources.flux(self.surface, self.wavenumber)
        pressure = _represent(self.surface, self.plane, points, self.wavenumber, known_field.pressure, flux)
        return known_field.errors_of(points, pressure)


class BoundaryElements:
    """Boundary elements of a closed surface in a medium, or of a flat face in a baffle.

    A flat face that lies in the hard plane radiates as Rayleigh's integral says, ``p = 2 i ω ρ ∫ v G dS``: the image
    doubles the single layer and cancels the double layer, so that there is nothing to solve (Lord Rayleigh, The Theory
    of Sound, vol. 2, §278).

    Parameters
    ----------
    surface : RadiatingSurface
        Surface, closed or flat in the hard plane.
    medium : Medium
    plane : HardPlane, optional
        A hard floor, or the baffle of a flat face.

    Attributes
    ----------
    surface : RadiatingSurface
        The given surface without its triangles that lie in the floor.
    uncovered : ndarray of bool, shape (n_given_triangles,)
        Triangles of the given surface that radiate.
    baffled : bool
        Whether the surface is a flat face in a baffle.

    Raises
    ------
    HousingError
        Where the surface is neither closed nor flat in the plane, is turned inside out, reaches behind the plane, or
        leaves a gap above it that is too narrow for its triangles.
    """

    def __init__(self, surface: RadiatingSurface, medium: Medium = AIR, plane: HardPlane | None = None) -> None:
        self.surface, self.medium, self.plane = surface, medium, plane
        self.uncovered = np.ones(len(surface.triangles), dtype=bool)
        heights = np.zeros(0) if plane is None else plane.height(surface.points)
        self.baffled = plane is not None and _lies_in(surface, plane)
        if self.baffled:
            return
        surface.require_closed()
        self._volume = surface.volume
        if plane is not None:
            if heights.min() < -surface.rounding:
                raise HousingError(f"the radiating surface reaches {-1e3 * heights.min():.3g} mm behind the hard plane")
            of_triangles = heights[surface.triangles]
            self.uncovered = np.asarray((of_triangles > surface.rounding).any(axis=1))
            if not self.uncovered.all():
                self.surface = surface.part(self.uncovered)
            # The image of a vertex is twice as far from it as the plane.
            narrow = (of_triangles > surface.rounding) & (
                of_triangles < 0.5 * _NEAREST_DISTANCE * surface.lengths[:, None]
            )
            if narrow.any():
                raise HousingError(
                    f"the radiating surface leaves a gap of {1e3 * of_triangles[narrow].min():.3g} mm above the hard "
                    f"plane; expected none, or at least {500.0 * _NEAREST_DISTANCE * surface.lengths.max():.3g} mm, a "
                    f"{2.0 / _NEAREST_DISTANCE:.0f}th of its longest edge"
                )

    def highest_frequency(self, elements: float = 6.0) -> float:
        """Highest frequency that the surface resolves [Hz], see :meth:`RadiatingSurface.highest_frequency`."""
        return self.surface.highest_frequency(self.medium.speed_of_sound, elements)

    def require_resolved(self, frequency_hz: float, elements: float = 3.0) -> None:
        """Refuse a frequency at which the triangles are too large.

        Raises
        ------
        TriangleSizeError
            With the edge length that is needed.
        """
        limit = self.highest_frequency(elements)
        if frequency_hz > limit:
            edge = self.medium.speed_of_sound / (6.0 * frequency_hz)
            raise TriangleSizeError(
                f"the triangles of the radiating surface are too large for {frequency_hz:.0f} Hz: {elements:g} edges a "
                f"wavelength end at {limit:.0f} Hz; six need edges of {1e3 * edge:.3g} mm"
            )

    def require_few(self) -> None:
        """Refuse more triangles than a dense matrix can hold.

        Raises
        ------
        TriangleSizeError
            With the memory that they take.
        """
        count = len(self.surface.triangles)
        if count > MOST_TRIANGLES and not self.baffled:
            edge = float(np.median(self.surface.lengths)) * np.sqrt(count / MOST_TRIANGLES)
            memory = 16.0 * (1.0 + 1.0 / 3.0) * len(self.surface.points) ** 2  # a third as many points inside
            raise TriangleSizeError(
                f"{count} triangles of the radiating surface take {1e-9 * memory:.3g} GB for the matrix of each "
                f"frequency; expected at most {MOST_TRIANGLES} triangles: take edges of {1e3 * edge:.3g} mm or longer"
            )

    def require_in_air(self, points: FloatArray) -> None:
        """Refuse points that are not in the air, see :func:`require_in_air`."""
        require_in_air(self.surface, self.plane, points)

    @cached_property
    def _inner_points(self) -> FloatArray:
        """Points inside, at least 0.6 edges from the middle of every triangle; the first few are checks.

        They are random means of four vertices, so that they turn and grow with the surface. A thin body has none.
        """
        generator = np.random.default_rng(1968)
        inner: list[FloatArray] = []
        most = max(_FEWEST_INNER, len(self.surface.points) // 3) + _CHECK_POINTS
        centers, reach = self.surface.corners.mean(axis=1), 0.6 * self.surface.lengths
        for trials in range(400):
            chosen = generator.integers(len(self.surface.points), size=(64, 4))
            trial = np.einsum("ti,tij->tj", generator.dirichlet(np.ones(4), size=64), self.surface.points[chosen])
            trial = trial[(np.linalg.norm(trial[:, None] - centers, axis=2) > reach).all(axis=1)]
            inner += list(trial[_inside(self.surface, self.plane, trial) > 0.99])
            if len(inner) >= most or (trials >= _VAIN_ROUNDS and not inner):
                break
        return np.array(inner[:most]).reshape(-1, 3)

    @cached_property
    def known_sources(self) -> KnownSources:
        """Sources inside that prove each solution, two of the points inside; none in a thin body."""
        return KnownSources.inside(self.surface, self._inner_points, self.plane)

    @property
    def _checks(self) -> int:
        """Number of the points inside that prove the solution: at most half of all."""
        return min(_CHECK_POINTS, (len(self._inner_points) + 1) // 2)

    @cached_property
    def _correction(self) -> sparse.csr_array:
        return _curvature_correction(self.surface)

    def _inner_count(self, wavenumber: float) -> int:
        """Twice the natural frequencies of the inside, by Weyl's law, within 5 % of this one, and a few more."""
        expected = 0.2 * self._volume * wavenumber**3 / (2.0 * np.pi**2)
        return min(_FEWEST_INNER + int(expected), len(self._inner_points) - self._checks)

    def solve(
        self,
        frequency_hz: float,
        velocity: npt.ArrayLike,
        progress: Callable[[float], None] = lambda fraction: None,
    ) -> SoundField:
        """Solve for the sound field of some distributions of normal velocity.

        Parameters
        ----------
        frequency_hz : float
        velocity : array_like, shape (3 n_triangles, n)
            Outward normal velocity at the corners of each triangle that radiates [m/s].
        progress : callable
            Called with the fraction of the equations that is assembled.

        Raises
        ------
        HousingError
            Where the frequency is not positive, the triangles are too large for it or too many, or the velocity does
            not belong to the triangles of :attr:`surface`.
        """
        if frequency_hz <= 0.0:
            raise HousingError(f"a frequency of {frequency_hz:g} Hz; expected a positive one")
        self.require_resolved(frequency_hz)
        self.require_few()
        velocities = np.asarray(velocity, dtype=np.complex128)
        if len(velocities) != 3 * len(self.surface.triangles):
            raise HousingError(
                f"velocities at {len(velocities)} corners; expected {3 * len(self.surface.triangles)}, three of each "
                "triangle that radiates"
            )
        velocities = np.ascontiguousarray(velocities.reshape(len(velocities), -1))
        wavenumber, flux = self.medium.wavenumber(frequency_hz), self.medium.flux(frequency_hz, velocities)
        if self.baffled:
            assert self.plane is not None
            vertices = self.surface.points
            vertex_numbers = np.arange(len(vertices))
            pressure = (
                -2.0 * surface_integrals(self.surface, vertices, vertex_numbers, wavenumber, point_flux(flux)).single
            )
            inside = np.zeros((0, velocities.shape[1]), dtype=np.complex128)
            return SoundField(self.surface, self.medium, self.plane, frequency_hz, velocities, pressure, inside)
        every = self._solve_closed(wavenumber, self.with_known_sources(wavenumber, flux), progress)
        return self.field(frequency_hz, velocities, every)

    def with_known_sources(self, wavenumber: float, flux: ComplexArray) -> ComplexArray:
        """Return the flux of distributions with that of the known sources behind it."""
        return np.hstack([flux, self.known_sources.flux(self.surface, wavenumber)])

    def field(self, frequency_hz: float, velocity: ComplexArray, every: ComplexArray) -> SoundField:
        """Return the field of a closed surface whose pressure is found, with what proves it.

        Parameters
        ----------
        frequency_hz : float
        velocity : ndarray, shape (3 n_triangles, n)
            Normal velocity at the corners of the triangles [m/s].
        every : ndarray, shape (n_points, n + n_sources)
            Pressure at the vertices, of these distributions and of the known sources [Pa].
        """
        wavenumber, columns = self.medium.wavenumber(frequency_hz), velocity.shape[1]
        pressure, known_field = every[:, :columns].copy(), None
        if len(self.known_sources.places):
            known_field = KnownField(self.surface, self.known_sources, wavenumber, every[:, columns:].copy())
        inside = np.zeros((0, columns), dtype=np.complex128)
        if self._checks:
            checks = self._inner_points[: self._checks]
            flux = self.medium.flux(frequency_hz, velocity)
            inside = _represent(self.surface, self.plane, checks, wavenumber, pressure, flux)
        return SoundField(self.surface, self.medium, self.plane, frequency_hz, velocity, pressure, inside, known_field)

    def _solve_closed(self, wavenumber: float, flux: ComplexArray, progress: Callable[[float], None]) -> ComplexArray:
        """Solve for the pressure at the vertices, q = ∂p/∂n."""
        matrix, right = self.equations(wavenumber, flux, np.arange(len(self.surface.points)), progress)
        try:
            return solve_least_squares(matrix, right)
        except np.linalg.LinAlgError as error:
            raise HousingError(f"the boundary elements are singular at {wavenumber:.6g} rad/m") from error

    def equations(
        self,
        wavenumber: float,
        flux: ComplexArray,
        vertices: IntArray,
        progress: Callable[[float], None] = lambda fraction: None,
    ) -> tuple[ComplexArray, ComplexArray]:
        """Assemble the equations ``c p − ∫ p ∂G/∂n dS = −∫ q G dS`` of some vertices, and those of the points inside.

        At a point inside c is 0. At a vertex the double layer leaves its jump, so that c is the part of the directions
        that leads into the air.

        Parameters
        ----------
        wavenumber : float
            k [rad/m].
        flux : ndarray, shape (3 n_triangles, n)
            q at the corners of the triangles.
        vertices : ndarray of int, shape (n_rows,)
        progress : callable
            Called with the assembled fraction.

        Returns
        -------
        matrix : ndarray, shape (n_rows + n_inner, n_points)
            In Fortran order, as LAPACK works in place.
        right : ndarray, shape (n_rows + n_inner, n)
        """
        inner = self._inner_points[self._checks :][: self._inner_count(wavenumber)]
        points = np.concatenate([self.surface.points[vertices], inner])
        own = np.concatenate([vertices, np.full(len(inner), -1)])
        count, rows = len(vertices), len(points)
        weights = np.where(own >= 0, 1.0, _INNER_WEIGHT)
        if self.plane is not None:
            # A vertex in the plane is its own image: of the body with its image all others have two equations.
            weights[:count][np.abs(self.plane.height(points[:count])) <= self.surface.rounding] = np.sqrt(0.5)
        matrix = np.empty((rows, len(self.surface.points)), dtype=np.complex128, order="F")
        right = np.empty((rows, flux.shape[1]), dtype=np.complex128)
        free, at_points = np.empty(rows), point_flux(flux)
        for start in range(0, rows, _ROWS):
            part = slice(start, start + _ROWS)
            integrals = _integrals(self.surface, self.plane, points[part], own[part], wavenumber, at_points)
            np.multiply(integrals.double, -weights[part, None], out=matrix[part])
            np.multiply(integrals.single, -weights[part, None], out=right[part])
            free[part] = weights[part] * (1.0 + integrals.static)
            progress(min(start + _ROWS, rows) / rows)
        matrix[np.arange(count), vertices] += free[:count]
        correction = self._correction[vertices].tocoo()
        matrix[correction.row, correction.col] -= free[correction.row] * correction.data
        return matrix, right


def _curvature_correction(surface: RadiatingSurface) -> sparse.csr_array:
    """Matrix B of the difference between averaging linear functions p and the curved pressure p − B p, at n vertices.

    On the average over the triangles around a vertex the second derivatives count as isotropic, ``Σ eᵀ H e = ½ Σ e²
    Δp``, and Δp there follows from the stiffness matrix K of linear finite elements, ``∫ ∇φᵢ·∇p dS = −Aᵢ Δp`` with a
    third Aᵢ of the area of its triangles: ``(B p)ᵢ = Σ_T (Σ e²)_T (K_T p)ᵢ / 48 Aᵢ``. It is zero for a linear pressure
    on a plane. Rows whose diagonal is above `_MOST_CURVATURE`, around vertices of uneven triangles, are reduced to
    that.
    """
    count, triangles = len(surface.points), surface.triangles
    areas, corners = np.bincount(triangles.ravel(), np.repeat(surface.areas / 3.0, 3), count), surface.corners
    mean = np.zeros((count, 3))
    np.add.at(mean, triangles, (surface.areas[:, None] * surface.normals)[:, None])
    cosines = np.einsum("eaj,ej->ea", mean[triangles], surface.normals) / np.linalg.norm(mean, axis=1)[triangles]
    least = np.ones(count)
    np.minimum.at(least, triangles, cosines)
    opposite = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)  # edge that lies opposite to each corner
    stiffness = np.einsum("eaj,ebj->eab", opposite, opposite) / (4.0 * surface.areas)[:, None, None]
    values = (opposite**2).sum(axis=(1, 2))[:, None, None] / 48.0 * stiffness
    weights = np.where(least > _LEAST_SMOOTH_COSINE, 1.0 / areas, 0.0)
    values = weights[triangles][:, :, None] * values
    places = np.repeat(triangles, 3, axis=1).ravel(), np.tile(triangles, (1, 3)).ravel()
    correction = sparse.csr_array((values.ravel(), places), shape=(count, count))
    # Where the whole of a spike at a vertex is taken for curvature, p − B p no longer sees it.
    part = correction.diagonal()
    factor = np.where(part > _MOST_CURVATURE, _MOST_CURVATURE / np.where(part > _MOST_CURVATURE, part, 1.0), 1.0)
    return sparse.csr_array(sparse.diags_array(factor) @ correction)


def _integrals(
    surface: RadiatingSurface,
    plane: HardPlane | None,
    points: FloatArray,
    own: IntArray | None,
    wavenumber: float,
    flux: RealParts,
) -> SurfaceIntegrals:
    """Integrals over a surface and its image in a hard plane; points in the plane are vertices of both."""
    if plane is None:
        return surface_integrals(surface, points, own, wavenumber, flux)
    vertices = np.full(len(points), -1) if own is None else own
    in_plane = np.where(np.abs(plane.height(points)) <= surface.rounding, vertices, -1)
    return surface_integrals(surface, points, vertices, wavenumber, flux, (plane.mirror(points), in_plane))


def _represent(
    surface: RadiatingSurface,
    plane: HardPlane | None,
    points: FloatArray,
    wavenumber: float,
    pressure: ComplexArray,
    flux: ComplexArray,
) -> ComplexArray:
    """∫ (p ∂G/∂n − q G) dS at points off the surface, with the images in a hard plane."""
    integrals = _integrals(surface, plane, points, None, wavenumber, point_flux(flux))
    return np.asarray(integrals.double @ pressure - integrals.single)


def _lies_in(surface: RadiatingSurface, plane: HardPlane) -> bool:
    """Whether a surface is flat and lies in a plane, but for a part in a million of its extent."""
    return bool(np.abs(plane.height(surface.points)).max() <= 1e3 * surface.rounding)


def _inside(surface: RadiatingSurface, plane: HardPlane | None, points: FloatArray) -> FloatArray:
    """Part of all directions in which points see the inner side of a surface and its mirror image: 1 inside, else 0."""
    angles = solid_angles(surface, points)
    if plane is not None:
        angles = angles + solid_angles(surface, plane.mirror(points))
    return np.asarray(angles / (2.0 * _TWO_PI))


def require_in_air(surface: RadiatingSurface, plane: HardPlane | None, points: FloatArray) -> None:
    """Refuse points whose sound pressure cannot be found.

    Parameters
    ----------
    surface : RadiatingSurface
        Surface, closed alone or with its mirror image, or flat in the plane.
    plane : HardPlane or None
        Floor; points on it are in the air.
    points : ndarray, shape (n_points, 3)
        Places [m].

    Raises
    ------
    HousingError
        Where a point is inside the surface or behind the hard plane, or nearer to a triangle than a hundredth of its
        longest edge, where the integrals over it are not accurate.
    """
    if not len(points):
        return
    if plane is not None:
        rounding = max(surface.rounding, 1e-9 * float(np.abs(points).max()))
        behind = np.flatnonzero(plane.height(points) < -rounding)
        if behind.size:
            raise HousingError(f"the point {_place(points[behind[0]])} is behind the hard plane")
    near, triangles, distances = surface.nearer_than(points, _NEAREST_DISTANCE)
    if near.size:
        raise HousingError(
            f"the point {_place(points[near[0]])} is {1e3 * distances[0]:.3g} mm from the radiating surface; expected "
            f"at least {1e3 * _NEAREST_DISTANCE * surface.lengths[triangles[0]]:.3g} mm, a hundredth of the edge there"
        )
    inside = np.flatnonzero(_inside(surface, plane, points) > 0.5)
    if inside.size:
        raise HousingError(f"the point {_place(points[inside[0]])} is inside the radiating surface")


def surface_product(
    surface: RadiatingSurface, first: FloatArray | ComplexArray, second: FloatArray | ComplexArray
) -> ComplexArray:
    """∫ ūᵢ wⱼ dS of fields that are linear on each triangle, given at its corners."""
    return np.asarray(first.conj().T @ surface_load(surface, second))


def surface_load(surface: RadiatingSurface, field: FloatArray | ComplexArray) -> ComplexArray:
    """∫ φ w dS of fields w with the linear shape function φ of every corner, shape (3 n_triangles, n)."""
    weighted = np.einsum("e,ab,ebn->ean", surface.areas, _MASS, field.reshape(len(surface.areas), 3, -1))
    return np.asarray(weighted.reshape(3 * len(surface.areas), -1))


def _directions(degree: int, axis: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return unit vectors and weights that integrate products of two spherical harmonics of a degree.

    Gauss's points along an axis, an even number of them, times even steps around it: circles, the lowest first, of
    2 degree + 2 directions each. Upper and lower ones mirror each other.
    """
    heights, weights = np.polynomial.legendre.leggauss(degree + 1 + (degree + 1) % 2)
    angles = np.pi * np.arange(2 * degree + 2) / (degree + 1)
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    around = np.outer(np.cos(angles), first) + np.outer(np.sin(angles), np.cross(axis, first))
    directions = heights[:, None, None] * axis + np.sqrt(1.0 - heights**2)[:, None, None] * around
    return directions.reshape(-1, 3), np.repeat(weights, len(angles)) * np.pi / (degree + 1)


def _place(point: FloatArray) -> str:
    x, y, z = 1e3 * point
    return f"({x:.4g}, {y:.4g}, {z:.4g}) mm"
