"""Natural modes of the housing, with the proof that none is missing.

Block Lanczos on the shifted inverse of K φ = λ M φ (:mod:`housing.lanczos`). The proof is Sylvester's law of inertia:
the number of negative pivots in K - σM = L D Lᵀ is the number of eigenvalues below σ, however many of them coincide.
A limit is itself the shift, so that one factor both counts the modes below it and finds them; for a number of modes
the shift lies just below zero, which keeps the shifted matrix positive definite for a free body too, and a second
factor counts up to the gap behind the last.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import linalg, sparse

from housing.errors import FactorizationError, HousingError, IncompleteModesError
from housing.factorization import Backend, Factorization, Factorizer
from housing.free_system import FreeSystem
from housing.lanczos import shift_invert
from housing.matrices import Matrices
from housing.reduction import Attachments, residual_attachments

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

RESIDUAL_BOUND = 1e-8
OVERLAP_BOUND = 1e-8
_ATTEMPTS = 3
_BELOW = 0.1  # part of the lowest elastic eigenvalue
_RELATIVE_GAP = 1e-5  # modes closer than this count as one multiple mode when a limit is placed between them


@dataclass(frozen=True)
class Certificate:
    """The proof of a set of modes.

    Attributes
    ----------
    limit : float
        The circular frequency up to which the set is complete [rad/s].
    expected : int
        Modes below the limit by the inertia of K - limit² M.
    found : int
        Modes in the set.
    max_residual : float
        Largest of |K φ - λ M φ| / ((λ + limit² + floor) |M φ|): the limit gives rigid modes a scale too, and the
        floor is never so small that the rounding of K alone would exceed the bound.
    max_overlap : float
        Largest |φᵢᵀ M φⱼ| of two modes: without it one mode found twice would hide another that is missing.
    """

    limit: float
    expected: int
    found: int
    max_residual: float
    max_overlap: float

    @property
    def complete(self) -> bool:
        """Whether nothing is missing, no mode stands twice and every mode is accurate."""
        proved = self.max_residual < RESIDUAL_BOUND and self.max_overlap < OVERLAP_BOUND
        return self.expected == self.found and proved


@dataclass(frozen=True)
class ModeSet:
    """Natural modes, ascending.

    Attributes
    ----------
    frequencies : ndarray, shape (n_modes,)
        ω [rad/s]; rigid-body modes are exactly 0.
    shapes : ndarray, shape (n_modes, n_nodes, 3)
        Displacement at each node, normalised to φᵀ M φ = 1 [1/√kg].
    certificate : Certificate
    seconds : dict of str to float
        Time taken by ``factorisation`` and ``eigensolver`` [s].
    backend : str
        Which factorisation was used.
    shift : float
        The eigenvalue about which the modes were searched [rad²/s²].
    threads : int
        Workers of the factorisation.
    attachments : Attachments or None
        What the modes lack of the static response to loads at the ports, where ports were given.
    """

    frequencies: FloatArray
    shapes: FloatArray
    certificate: Certificate
    seconds: dict[str, float]
    backend: str
    shift: float
    threads: int
    attachments: Attachments | None = None

    @property
    def frequencies_hz(self) -> FloatArray:
        """[Hz], shape (n_modes,)."""
        return self.frequencies / (2.0 * np.pi)

    def project(self, port: sparse.csr_array) -> FloatArray:
        """The modes' motions at a port, shape (n_modes, n_motions)."""
        return np.asarray((port @ self.shapes.reshape(len(self.shapes), -1).T).T)

    def project_all(self, port: sparse.csr_array) -> FloatArray:
        """Motions at a port of the modes, then of the attachments, shape (n_modes + n_attachments, n_motions)."""
        modes = self.project(port)
        return modes if self.attachments is None else np.vstack([modes, self.attachments.project(port)])


def solve_modes(
    matrices: Matrices,
    fixed: IntArray | None = None,
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
    ports: sparse.csr_array | None = None,
    backend: Backend | None = None,
    threads: int = 2,
    progress: Callable[[str], None] = lambda message: None,
) -> ModeSet:
    """All natural modes below a frequency, or the lowest of them by number.

    Parameters
    ----------
    matrices : Matrices
        Of n_nodes nodes, springs included.
    fixed : ndarray of int, optional
        Degrees of freedom held at zero.
    frequency_limit : float
        Every mode below it is found [rad/s]. Either this or ``count``.
    count : int
        The lowest so many; one or two more where the last would split a multiple mode.
    ports : scipy.sparse.csr_array, shape (r, 3 n_nodes), optional
        Motions whose static compliance the mode set is to hold exactly: it then has attachments.
    backend, threads
        See :class:`housing.factorization.Factorizer`.
    progress : callable
        Told in words what happens next.

    Raises
    ------
    HousingError
        Where neither or both of limit and count are given, or they ask for nothing or for everything.
    IncompleteModesError
        Where the certificate cannot be made good after three searches.
    ReductionError
        Where the static compliance at the ports fails its proof.
    """
    if (frequency_limit is None) == (count is None):
        raise HousingError("give a frequency limit or a number of modes, one of the two")
    system = FreeSystem(matrices, fixed)
    if count is not None and not 1 <= count < min(system.size - 1, 2000):
        raise HousingError(
            f"{count} modes asked of {system.size} degrees of freedom: give 1 to {min(system.size - 1, 2000) - 1}"
        )
    if frequency_limit is not None and frequency_limit <= 0.0:
        raise HousingError(f"frequency limit {frequency_limit} rad/s must be positive")

    search = _Search(system, Factorizer(backend=backend, threads=threads), system.floor(frequency_limit or 0.0))
    found = (
        search.below(frequency_limit, progress) if frequency_limit is not None else search.lowest(count or 0, progress)
    )
    values, vectors = found.values, _oriented(found.vectors)
    values[np.abs(values) < 1e-6 * search.floor] = 0.0
    if values[0] < -search.floor:
        raise _not_a_stiffness(f"the lowest eigenvalue of K is {values[0]:g} rad²/s²")
    attachments = None
    if ports is not None:
        start = time.perf_counter()
        progress("attaching the static response at the ports")
        attachments = residual_attachments(
            system.stiffness,
            system.mass,
            found.factor.solve,
            values,
            vectors,
            ports[:, system.free],
            shift=found.certificate.limit**2,
            floor=search.floor,
            free=system.free,
            n_nodes=system.n_nodes,
        )
        search.seconds["reduction"] = time.perf_counter() - start
    return ModeSet(
        frequencies=np.sqrt(np.maximum(values, 0.0)),
        shapes=system.expand(vectors),
        certificate=found.certificate,
        seconds=search.seconds,
        backend=found.factor.backend,
        shift=found.shift,
        threads=threads,
        attachments=attachments,
    )


@dataclass(frozen=True)
class _Found:
    """Certified modes, the shift of their search, and the factor of K - limit² M that counted them."""

    values: FloatArray
    vectors: FloatArray
    certificate: Certificate
    factor: Factorization
    shift: float


class _Search:
    """Searches that are made again, wider, until their certificate is good; the seconds of each step add up."""

    def __init__(self, system: FreeSystem, factorizer: Factorizer, floor: float) -> None:
        self.floor = floor
        self.seconds = {"factorisation": 0.0, "eigensolver": 0.0}
        self._system = system
        self._factorizer = factorizer

    def below(self, limit: float, progress: Callable[[str], None]) -> _Found:
        """All modes below a limit, which is itself the shift."""
        progress("counting the modes below the limit")
        shift = limit**2
        factor = self._factor(shift)
        count = factor.negative
        if count == 0:
            raise HousingError(f"the housing has no mode below {limit / (2 * np.pi):g} Hz; raise the limit")
        if count == self._system.size:
            raise HousingError(
                f"every mode of the mesh lies below {limit / (2 * np.pi):g} Hz; lower the limit or refine"
            )
        progress(f"searching {count} modes")
        certificate = Certificate(limit, count, 0, 0.0, 0.0)
        for attempt in range(_ATTEMPTS):
            values, vectors = self._modes(factor, shift, count, above=True, attempt=attempt)
            certificate, values, vectors = self._certify(values, vectors, limit, factor)
            if certificate.complete:
                return _Found(values, vectors, certificate, factor, shift)
        raise _incomplete(certificate)

    def lowest(self, count: int, progress: Callable[[str], None]) -> _Found:
        """The lowest modes by number, with the rest of the multiple mode that the last may be part of."""
        shift = -self.floor
        certificate = Certificate(0.0, count, 0, 0.0, 0.0)
        for attempt in range(_ATTEMPTS):
            progress("factoring")
            factor = self._factor(shift)
            if factor.negative:
                raise _not_a_stiffness(f"K - {shift:g} M has {factor.negative} negative pivots")
            progress(f"searching {count} modes")
            # Some more than asked for, to see the gap behind the last.
            wanted = min(count + 2 * 4**attempt, self._system.size - 1)
            values, vectors = self._modes(factor, shift, wanted, above=False, attempt=attempt)
            limit = _gap_after(values, count, self.floor)
            if limit == 0.0:
                continue
            progress("counting the modes found")
            del factor  # two at once would be the most memory that a search takes
            factor = self._factor(limit**2)
            certificate, values, vectors = self._certify(values, vectors, limit, factor)
            if certificate.complete:
                return _Found(values, vectors, certificate, factor, shift)
            if values.max(initial=0.0) > self.floor:
                # Farther from rigid modes, by the scale of the elastic ones: less of their rounding stands in these.
                shift = -max(self.floor, _BELOW * float(values[values > self.floor][0]))
        raise _incomplete(certificate)

    def _factor(self, shift: float) -> Factorization:
        start = time.perf_counter()
        factor = self._factorizer.factor(self._system.shifted(shift))
        self.seconds["factorisation"] += time.perf_counter() - start
        return factor

    def _modes(
        self, factor: Factorization, shift: float, count: int, *, above: bool, attempt: int
    ) -> tuple[FloatArray, FloatArray]:
        """Modes without a proof; of an attempt that does not converge, none, but for the last one's."""
        start = time.perf_counter()
        system = self._system
        try:
            return shift_invert(factor.solve, system.mass, shift, count, above=above, seed=attempt)
        except IncompleteModesError:
            if attempt + 1 == _ATTEMPTS:
                raise
            # The next one has a wider block, as modes of high multiplicity want it.
            return np.empty(0), np.empty((system.size, 0))
        finally:
            self.seconds["eigensolver"] += time.perf_counter() - start

    def _certify(
        self, values: FloatArray, vectors: FloatArray, limit: float, factor: Factorization
    ) -> tuple[Certificate, FloatArray, FloatArray]:
        """The certificate of the modes below a limit; and these, the most that their space gives."""
        start = time.perf_counter()
        values, vectors, residuals, overlap = _refined(self._system, values, vectors, limit**2 + self.floor)
        keep = values < limit**2
        certificate = Certificate(
            limit, factor.negative, int(keep.sum()), float(residuals[keep].max(initial=0.0)), overlap
        )
        self.seconds["eigensolver"] += time.perf_counter() - start
        return certificate, values[keep], vectors[:, keep]


def _incomplete(certificate: Certificate) -> IncompleteModesError:
    return IncompleteModesError(
        f"{certificate.found} modes found below {certificate.limit / (2 * np.pi):.6g} Hz where the inertia demands "
        f"{certificate.expected}, largest residual {certificate.max_residual:.1e}, largest overlap "
        f"{certificate.max_overlap:.1e}; move the limit a little or refine the mesh"
    )


def _not_a_stiffness(what: str) -> FactorizationError:
    return FactorizationError(f"{what}; the stiffness is not positive semidefinite")


def _refined(
    system: FreeSystem, values: FloatArray, vectors: FloatArray, scale: float
) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Modes by the quotients of K and M in the space of those found, their residuals and their largest overlap.

    The inverse's own eigenvalues would not do: about a shift hard beside rigid modes it is huge along these, and its
    rounding there, by λ / |σ| larger beside an elastic mode's own, stands in that mode. Vectors that overlap already
    are left as they are, to fail their certificate.
    """
    inertia, force = system.mass @ vectors, system.stiffness @ vectors
    overlaps = vectors.T @ inertia
    if np.abs(overlaps - np.eye(len(values))).max(initial=0.0) < OVERLAP_BOUND:
        values, mixture = linalg.eigh(vectors.T @ force, overlaps)
        vectors, inertia, force = vectors @ mixture, inertia @ mixture, force @ mixture
        overlaps = vectors.T @ inertia
    error = np.linalg.norm(force - inertia * values, axis=0)
    residuals = error / ((np.abs(values) + scale) * np.linalg.norm(inertia, axis=0))
    return values, vectors, residuals, float(np.abs(overlaps - np.eye(len(values))).max(initial=0.0))


def _gap_after(values: FloatArray, count: int, floor: float) -> float:
    """A circular frequency in the first gap after ``count`` modes; 0 where they run out within a multiple mode.

    ``floor`` [rad²/s²] is far above the rounding of rigid modes, whose differences are no gaps.
    """
    scale = max(float(np.abs(values).max(initial=0.0)), floor)
    for below, above in zip(values[count - 1 :], values[count:], strict=False):
        if above - below > _RELATIVE_GAP * scale:
            return float(np.sqrt(max(0.5 * (below + above), 0.0)))
    return 0.0


def _oriented(vectors: FloatArray) -> FloatArray:
    """The same vectors with their largest entry positive, so that equal input draws equal pictures."""
    largest = vectors[np.argmax(np.abs(vectors), axis=0), np.arange(vectors.shape[1])]
    return np.asarray(vectors * np.sign(largest))
