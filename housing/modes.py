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
from scipy import sparse

from housing.errors import FactorizationError, HousingError, IncompleteModesError
from housing.factorization import Backend, Factorizer
from housing.lanczos import shift_invert
from housing.matrices import Matrices
from housing.reduction import Attachments, residual_attachments

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

RESIDUAL_BOUND = 1e-8
OVERLAP_BOUND = 1e-8
_ATTEMPTS = 3
_RELATIVE_GAP = 1e-5  # modes closer than this count as one multiple mode when a limit is placed between them
_BELOW = 0.1  # part of the lowest elastic eigenvalue
_FLOOR = 0.06  # part of the limit: its square is small beside the wanted eigenvalues
_ROUNDING = 3e-8  # part of the largest K_ii / M_ii: well clear of the rounding of K


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
    free = _free_freedoms(3 * matrices.n_nodes, fixed)
    reduced = _Reduced(matrices, free)
    if count is not None and not 1 <= count < min(len(free) - 1, 2000):
        raise HousingError(
            f"{count} modes asked of {len(free)} degrees of freedom: give 1 to {min(len(free) - 1, 2000) - 1}"
        )
    if frequency_limit is not None and frequency_limit <= 0.0:
        raise HousingError(f"frequency limit {frequency_limit} rad/s must be positive")

    start = time.perf_counter()
    factorizer = Factorizer(reduced.shifted(0.0), backend=backend, threads=threads)
    expected = 0
    # Far above the rounding of K, and its root small beside the wanted frequencies.
    floor = _ROUNDING * float(np.max(reduced.stiffness.diagonal() / reduced.mass.diagonal()))
    if frequency_limit is not None:
        floor = max(floor, (_FLOOR * frequency_limit) ** 2)
    above = frequency_limit is not None
    shift = -floor if frequency_limit is None else frequency_limit**2
    progress("counting the modes below the limit" if above else "factoring")
    factor = factorizer.factor(reduced.shifted(shift))
    if frequency_limit is not None:
        expected = factor.negative
        if expected == 0:
            raise HousingError(f"the housing has no mode below {frequency_limit / (2 * np.pi):g} Hz; raise the limit")
        if expected == len(free):
            raise HousingError(
                f"every mode of the mesh lies below {frequency_limit / (2 * np.pi):g} Hz; lower the limit or refine"
            )
    elif factor.negative:
        raise _not_a_stiffness(f"K - {shift:g} M has {factor.negative} negative pivots")
    factored = time.perf_counter() - start
    start = time.perf_counter()
    progress(f"searching {expected or count} modes")
    for attempt in range(_ATTEMPTS):
        # Some more than asked for, to see the gap behind the last; of all below a limit there are no more.
        wanted = expected if count is None else min(count + 2 * 4**attempt, len(free) - 1)
        try:
            values, vectors = shift_invert(
                factor.solve, reduced.stiffness, reduced.mass, wanted, above=above, seed=attempt
            )
        except IncompleteModesError:
            if attempt + 1 < _ATTEMPTS:
                continue  # with a wider block, as modes of high multiplicity want it
            raise
        if frequency_limit is not None:
            limit = frequency_limit
        else:
            assert count is not None
            limit = _gap_after(values, count, floor)
            expected = factorizer.factor(reduced.shifted(limit**2)).negative if limit > 0.0 else -1
        keep = values < limit**2
        residual, overlap = _proofs(reduced, values[keep], vectors[:, keep], limit**2 + floor)
        certificate = Certificate(limit, expected, int(keep.sum()), residual, overlap)
        if certificate.complete:
            break
        if count is not None and values[-1] > floor:
            # Farther from rigid modes, by the scale of the elastic ones: less of their rounding stands in these.
            shift = -max(floor, _BELOW * float(values[values > floor][0]))
            factor = factorizer.factor(reduced.shifted(shift))
    else:
        raise IncompleteModesError(
            f"{certificate.found} modes found below {limit / (2 * np.pi):.6g} Hz where the inertia demands "
            f"{certificate.expected}, largest residual {certificate.max_residual:.1e}, largest overlap "
            f"{certificate.max_overlap:.1e}; move the limit a little or refine the mesh"
        )
    vectors, values = _oriented(vectors[:, keep]), values[keep]
    values[np.abs(values) < 1e-6 * floor] = 0.0
    if values[0] < -floor:
        raise _not_a_stiffness(f"the lowest eigenvalue of K is {values[0]:g} rad²/s²")
    seconds = {"factorisation": factored, "eigensolver": time.perf_counter() - start}
    shapes = np.zeros((certificate.found, 3 * matrices.n_nodes))
    shapes[:, free] = vectors.T
    attachments = None
    if ports is not None:
        start = time.perf_counter()
        progress("attaching the static response at the ports")
        attachments = residual_attachments(
            reduced.stiffness,
            reduced.mass,
            factor.solve,
            values,
            vectors,
            ports[:, free],
            shift=shift,
            floor=floor,
            free=free,
            n_nodes=matrices.n_nodes,
        )
        seconds["reduction"] = time.perf_counter() - start
    return ModeSet(
        frequencies=np.sqrt(np.maximum(values, 0.0)),
        shapes=shapes.reshape(len(shapes), -1, 3),
        certificate=certificate,
        seconds=seconds,
        backend=factor.backend,
        shift=shift,
        threads=threads,
        attachments=attachments,
    )


def _not_a_stiffness(what: str) -> FactorizationError:
    return FactorizationError(f"{what}; the stiffness is not positive semidefinite")


class _Reduced:
    """The matrices without the fixed degrees of freedom."""

    def __init__(self, matrices: Matrices, free: IntArray) -> None:
        self._matrices = matrices
        self._free = free
        self._all = len(free) == 3 * matrices.n_nodes
        self.stiffness = self._reduce(matrices.stiffness)
        self.mass = self._reduce(matrices.mass)

    def shifted(self, shift: float) -> sparse.csr_array:
        return self._reduce(self._matrices.shifted(shift))

    def _reduce(self, matrix: sparse.csr_array) -> sparse.csr_array:
        return matrix if self._all else sparse.csr_array(matrix[self._free][:, self._free])


def _free_freedoms(size: int, fixed: IntArray | None) -> IntArray:
    held = np.zeros(size, dtype=bool)
    if fixed is not None:
        held[fixed] = True
    if held.all():
        raise HousingError("every degree of freedom is fixed")
    return np.flatnonzero(~held)


def _proofs(reduced: _Reduced, values: FloatArray, vectors: FloatArray, scale: float) -> tuple[float, float]:
    """The largest residual and the largest overlap of the modes; see :class:`Certificate`."""
    inertia = reduced.mass @ vectors
    error = reduced.stiffness @ vectors - inertia * values
    residuals = np.linalg.norm(error, axis=0) / ((np.abs(values) + scale) * np.linalg.norm(inertia, axis=0))
    overlaps = vectors.T @ inertia - np.eye(len(values))
    return float(residuals.max(initial=0.0)), float(np.abs(overlaps).max(initial=0.0))


def _gap_after(values: FloatArray, count: int, floor: float) -> float:
    """A circular frequency in the first gap after ``count`` modes; 0 where they run out within a multiple mode.

    ``floor`` [rad²/s²] is far above the rounding of rigid modes, whose differences are no gaps.
    """
    scale = max(float(np.abs(values).max()), floor)
    for below, above in zip(values[count - 1 :], values[count:], strict=False):
        if above - below > _RELATIVE_GAP * scale:
            return float(np.sqrt(max(0.5 * (below + above), 0.0)))
    return 0.0


def _oriented(vectors: FloatArray) -> FloatArray:
    """The same vectors with their largest entry positive, so that equal input draws equal pictures."""
    largest = vectors[np.argmax(np.abs(vectors), axis=0), np.arange(vectors.shape[1])]
    return np.asarray(vectors * np.sign(largest))
