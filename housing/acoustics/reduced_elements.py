"""Boundary elements in the span of solutions at a few frequencies: least squares over some equations, proved by others.

The surface pressure of any motion of a housing lies, to a part in a thousand, in the span of the pressures of its modes
at a few frequencies around: their wavelengths are alike, and resonances of the air, as in a gap above a floor, are in
all of them. With an orthonormal basis V of that span, a thousandth of its largest singular value being the least,

``p ≈ V y``,  ``min ‖A_s V y − b_s‖``

over the equations s of about twice as many vertices as V has columns and of the points inside. Only these are
assembled, a few of all, and nothing is factored but a small matrix. It is the least-squares Petrov-Galerkin method of
reduced bases (K. Carlberg, C. Farhat, J. Cortial and D. Amsallem, "The GNAT method for nonlinear model reduction",
Journal of Computational Physics 242 (2013), 623-647, section 3), whose vertices are drawn by their leverage in V
(M. W. Mahoney, "Randomized algorithms for matrices and data", Foundations and Trends in Machine Learning 3 (2011),
123-224, section 4).

Equations of further vertices, which had no part in it, prove each solution: what they leave over, relative to the
pressure, is :meth:`ReducedElements.solve`'s error. A larger one than `LARGEST_MISFIT` is no solution; all equations are
then to be solved. Everything that proves a solution of all equations stays: the pressure inside, known sources, and the
power by two ways.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.housing.acoustics.boundary_elements import BoundaryElements, SoundField
from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.housing.storage.netcdf import LabelledArray
from gearwhine.numerics.arrays import ComplexArray, FloatArray, IntArray
from gearwhine.numerics.dense_least_squares import solve_least_squares
from gearwhine.numerics.progress import in_order

LARGEST_MISFIT = 1.5e-2
"""Largest root mean square of what equations without a part in a solution leave over, relative to the pressure."""

SPACING = 6.0
"""Largest mean distance of the frequencies of a span, as wavenumber times the largest extent of the surface."""

_NEIGHBOURS = 4  # frequencies around one whose solutions span its own
_LEAST_SINGULAR_VALUE = 1e-3  # of the largest one
_CLOSER = 0.8  # power of even steps by which the frequencies of a span lie closer at high ones
_EQUATIONS = 2.0  # vertices whose equations are taken, over the columns of the basis
_WORTH = 2.0  # frequencies at which fields are wanted for each at which all modes are solved, above which these pay
_PROVING = 150  # vertices whose equations prove it
_MOST = 0.6  # part of the vertices that a span may ask for equations: above it all are as cheap


@dataclass(frozen=True, eq=False)
class SpanningSolutions:
    """Solutions for unit rates of a housing's modes at some frequencies.

    Attributes
    ----------
    frequencies : ndarray, shape (f,)
        Ascending [Hz].
    pressure : ndarray of complex, shape (f, n_points, n_modes + n_sources)
        Pressure of the modes and of the known sources at the vertices.
    """

    frequencies: FloatArray
    pressure: npt.NDArray[np.complex64]

    def arrays(self) -> dict[str, LabelledArray]:
        """Return the solutions as labelled arrays."""
        axis, parts = "span_frequency", self.pressure.view(np.float32).reshape(*self.pressure.shape, 2)
        return {
            axis: LabelledArray((axis,), self.frequencies, "Hz", "frequency of the solutions that span others"),
            "span_pressure": LabelledArray(
                (axis, "radiating_vertex", "span_column", "part"),
                parts,
                "Pa s kg-0.5 m-1",
                "sound pressure at the radiating surface, of unit rates of the modes and of known sources",
            ),
        }

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, LabelledArray]) -> "SpanningSolutions":
        """Return the solutions of labelled arrays, equal bit for bit."""
        parts = np.ascontiguousarray(arrays["span_pressure"].values)
        return cls(arrays["span_frequency"].values, parts.view(np.complex64)[..., 0])

    def hold(self, frequencies: FloatArray) -> bool:
        """Whether frequencies lie within these."""
        return bool(self.frequencies[0] <= frequencies.min() and frequencies.max() <= self.frequencies[-1])


@dataclass(frozen=True, eq=False)
class Basis:
    """Span of the solutions at neighbouring frequencies."""

    columns: ComplexArray
    solved: IntArray  # vertices whose equations are solved
    proving: IntArray  # and those that prove the solution


@dataclass(frozen=True, eq=False)
class ReducedElements:
    """Boundary elements in the span of solutions at some frequencies.

    Attributes
    ----------
    elements : BoundaryElements
        Closed surface.
    modal : ndarray, shape (3 n_triangles, n_modes)
        Normal velocities of the modes.
    solutions : SpanningSolutions
    bases : tuple of Basis
        Span of each few neighbouring solutions.
    """

    elements: BoundaryElements
    modal: FloatArray
    solutions: SpanningSolutions
    bases: tuple[Basis, ...]

    @classmethod
    def of(cls, elements: BoundaryElements, modal: FloatArray, solutions: SpanningSolutions) -> "ReducedElements":
        """Make the bases of all solutions' neighbours."""
        count = max(len(solutions.frequencies) - _NEIGHBOURS + 1, 1)

        def basis(first: int) -> Basis:
            return _basis(elements.surface, solutions.pressure[first : first + _NEIGHBOURS])

        return cls(elements, modal, solutions, in_order(basis, range(count), "span of the solutions"))

    def solve(self, frequency_hz: float, rates: ComplexArray) -> SoundField | None:
        """Solve for the field of some rates of the modes' coordinates; None where the span does not hold it.

        Parameters
        ----------
        frequency_hz : float
        rates : ndarray, shape (n_modes, n)
        """
        velocity = np.asarray(self.modal @ rates, dtype=np.complex128)
        frequencies = self.solutions.frequencies
        same = np.flatnonzero(frequencies == frequency_hz)
        if len(same):
            of_modes, of_sources = np.split(self.solutions.pressure[same[0]], [len(rates)], axis=1)
            return self.elements.field(frequency_hz, velocity, np.hstack([of_modes @ rates, of_sources]))
        if not frequencies[0] < frequency_hz < frequencies[-1]:
            return None
        above = int(np.searchsorted(frequencies, frequency_hz))
        basis = self.bases[int(np.clip(above - _NEIGHBOURS // 2, 0, len(self.bases) - 1))]
        medium = self.elements.medium
        wavenumber = medium.wavenumber(frequency_hz)
        flux = self.elements.with_known_sources(wavenumber, medium.flux(frequency_hz, velocity))
        vertices = np.concatenate([basis.proving, basis.solved])
        matrix, right = self.elements.equations(wavenumber, flux, vertices)
        small, count = matrix.astype(np.complex64) @ basis.columns, len(basis.proving)
        factors = solve_least_squares(np.asfortranarray(small[count:], dtype=np.complex128), right[count:].copy())
        every = basis.columns @ factors
        left = _mean_square(small[:count] @ factors - right[:count])
        if np.any(left > LARGEST_MISFIT * _mean_square(every)):
            return None
        return self.elements.field(frequency_hz, velocity, every)


def spanning_frequencies(
    wanted: FloatArray, between: tuple[float, float], elements: BoundaryElements, modes: int
) -> FloatArray | None:
    """Return the frequencies at which solutions span those at some others, ascending; None where they do not pay.

    That is where few fields are wanted, or the surface is small for the number of modes. The frequencies lie closer
    together where waves are short, and are of those at which fields are wanted where these are near.

    Parameters
    ----------
    wanted : ndarray, shape (n,)
        Frequencies at which fields are wanted, each once [Hz].
    between : tuple of float
        Lowest and highest frequency [Hz].
    elements : BoundaryElements
    modes : int
        Number of modes.
    """
    low, high = between
    columns = _NEIGHBOURS * (modes + len(elements.known_sources.places))
    reach = elements.medium.wavenumber(high - low) * float(np.ptp(elements.surface.points, axis=0).max())
    count = max(int(np.ceil(reach / SPACING)) + 2, _NEIGHBOURS)
    if len(wanted) <= _WORTH * count or _EQUATIONS * columns + _PROVING > _MOST * len(elements.surface.points):
        return None
    even = low + (high - low) * np.linspace(0.0, 1.0, count) ** _CLOSER
    for place in range(1, count - 1):
        near = float(wanted[np.abs(wanted - even[place]).argmin()])
        if abs(near - even[place]) < 0.25 * (even[place + 1] - even[place]):
            even[place] = near
    return even


def _basis(surface: RadiatingSurface, pressure: npt.NDArray[np.complex64]) -> Basis:
    """Span of some solutions, each of unit size."""
    count = len(surface.points)
    sizes = np.sqrt(np.bincount(surface.triangles.ravel(), np.repeat(surface.areas / 3.0, 3), count))[:, None]
    solutions = np.concatenate([*pressure], axis=1) * sizes
    lengths = np.linalg.norm(solutions, axis=0)
    solutions = solutions[:, lengths > 0.0] / lengths[lengths > 0.0]
    squares, mixtures = np.linalg.eigh(solutions.conj().T @ solutions)
    chosen = squares > _LEAST_SINGULAR_VALUE**2 * squares[-1]
    columns = solutions @ (mixtures[:, chosen] / np.sqrt(squares[chosen]))
    wanted = int(_EQUATIONS * columns.shape[1])
    # Without replacement: the largest of log-weights with Gumbel's noise.
    generator = np.random.default_rng(2013)
    leverage = (np.abs(columns) ** 2).sum(axis=1)
    drawn = np.argsort(-np.log(leverage) - generator.gumbel(size=count), kind="stable")
    proving = generator.choice(drawn[wanted:], _PROVING, replace=False)
    return Basis((columns / sizes).astype(np.complex64), np.sort(drawn[:wanted]), np.sort(proving))


def _mean_square(values: ComplexArray) -> FloatArray:
    return np.asarray(np.sqrt((np.abs(values) ** 2).mean(axis=0)))
