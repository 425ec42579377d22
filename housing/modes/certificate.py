"""Certificate of a set of modes by its Sturm count (Sylvester's inertia): none missing, none twice, each accurate.

The eigensolver works on the shifted inverse of K φ = λ M φ: block Lanczos or scipy's ``eigsh``
(:mod:`gearwhine.housing.modes.eigensolver`), or SLEPc on the ranks of MPI (:mod:`gearwhine.housing.fem.slepc`). The
proof is Sylvester's law of inertia: the number of negative pivots in K - σM = L D Lᵀ is the number of eigenvalues below
σ, multiple ones counted by their multiplicity. The search is repeated more widely until this count proves it complete.
A frequency limit is itself the shift, so that one factor both counts the modes below it and finds them. For a number of
modes the shift lies just below zero, which keeps the shifted matrix positive definite for a free body too, and a second
factor counts up to the gap behind the last.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from gearwhine.housing.errors import FactorizationError, HousingError, IncompleteModesError
from gearwhine.housing.fem.factorization import Factorization, Factorizer, checked_factor
from gearwhine.housing.fem.linear_algebra import BlockAlgebra
from gearwhine.housing.fem.matrices import FreeSystem
from gearwhine.housing.fem.slepc import SlepcRanks
from gearwhine.housing.modes.davidson import davidson_modes
from gearwhine.housing.modes.eigensolver import DEFAULT_SOLVER, LoadResponses, Solver, nearest_modes
from gearwhine.numerics.arrays import FloatArray

RESIDUAL_BOUND = 1e-8
OVERLAP_BOUND = 1e-8
NOT_COUNTED = -1
"""Stands for the expected number of modes where no inertia was computed."""


@dataclass(frozen=True)
class Certificate:
    """The proof of a set of modes.

    Attributes
    ----------
    limit : float
        The circular frequency up to which the set is complete [rad/s].
    expected : int
        Modes below the limit by the inertia of K - limit² M; :data:`NOT_COUNTED` where it was not computed.
    found : int
        Modes in the set.
    max_residual : float
        Largest of |K φ - λ M φ| / ((λ + limit² + floor) |M φ|): the limit gives rigid modes a scale too, and the
        floor is never so small that the rounding of K alone would exceed the bound.
    max_overlap : float
        Largest |φᵢᵀ M φⱼ| of two modes: a mode found twice, which would hide a missing one, has an overlap of 1.
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


_ATTEMPTS = 3
_ASIDE = (1e-3, -1e-3, 1e-5, -1e-5)  # parts of a shift by which to step away from a mode beside it
MOST_MODES = 2000
"""Largest number of modes of one search: the basis of more would exceed any memory."""
_DRAFT = 1e-4  # residual of the last modes of a draft; modes of half their frequency then have all digits
_IN_SINGLE = 0.5 * RESIDUAL_BOUND  # residual of the modes of a factor in single precision
_BELOW = 0.1  # part of the lowest elastic eigenvalue
_RELATIVE_GAP = 1e-5  # modes closer than this count as one multiple mode when a limit is placed between them


@dataclass(frozen=True)
class CertifiedModes:
    """Certified modes, the shift of their search, and the factor of K - limit² M that counted them.

    In a draft, which is not counted, the factor is that of the search.
    """

    values: FloatArray
    vectors: FloatArray
    certificate: Certificate
    factor: Factorization
    shift: float


class CertifiedSearch:
    """Search for modes, repeated more widely until the certificate is complete; the seconds of each step add up."""

    def __init__(
        self, system: FreeSystem, factorizer: Factorizer | SlepcRanks, floor: float, solver: Solver = DEFAULT_SOLVER
    ) -> None:
        self.floor = floor
        self.seconds = {"factorisation": 0.0, "eigensolver": 0.0}
        self._system = system
        self._factorizer = factorizer
        self._solver = solver

    def below(
        self, limit: float, progress: Callable[[str], None], responses: LoadResponses | None = None
    ) -> CertifiedModes:
        """All modes below a limit, which is itself the shift; the first attempt may find responses to loads beside."""
        progress("counting the modes below the limit")
        shift = limit**2
        factor = self._factor(shift)
        if isinstance(self._factorizer, Factorizer):
            self._factorizer.forget_ordering()  # a second factor is hardly ever needed
        count = factor.negative
        if count == 0:
            raise HousingError(f"the housing has no mode below {limit / (2 * np.pi):g} Hz; raise the limit")
        if count > MOST_MODES:
            raise HousingError(
                f"the housing has {count} modes below {limit / (2 * np.pi):g} Hz, more than the {MOST_MODES} that are "
                "solved for at most: lower the limit"
            )
        if count == self._system.size:
            raise HousingError(
                f"every mode of the mesh lies below {limit / (2 * np.pi):g} Hz; lower the limit or refine"
            )
        progress(f"searching {count} modes")
        certificate = Certificate(limit, count, 0, 0.0, 0.0)
        pole, place = factor, shift
        for attempt in range(_ATTEMPTS):
            beside = responses if attempt == 0 else None
            values, vectors = self._modes(pole, place, count, above=True, attempt=attempt, responses=beside)
            certificate, values, vectors = self._certify(values, vectors, limit, count)
            if certificate.complete:
                return CertifiedModes(values, vectors, certificate, factor, shift)
            if pole is factor and certificate.found == count:
                pole, place = self._beside(factor, shift)
        raise _incomplete(certificate)

    def _beside(self, factor: Factorization, shift: float) -> tuple[Factorization, float]:
        """Factor at a small distance from a shift that nearly coincides with a mode, with as many modes below.

        At the shift itself the inverse is so large along that mode that rounding hides the others.
        """
        for part in _ASIDE:
            aside = shift * (1.0 + part)
            other = self._factor(aside)
            if other.negative == factor.negative:
                return other, aside
        return factor, shift

    def lowest(self, count: int, progress: Callable[[str], None], *, draft: bool = False) -> CertifiedModes:
        """Find the lowest modes by number; a multiple mode at the end is completed.

        A draft is not counted, and its last modes are less accurate.
        """
        shift = -self.floor
        certificate = Certificate(0.0, count, 0, 0.0, 0.0)
        for attempt in range(_ATTEMPTS):
            progress("factoring")
            factor = self._factor(shift)
            if factor.negative:
                raise indefinite_stiffness_error(f"K - {shift:g} M has {factor.negative} negative pivots")
            progress(f"searching {count} modes")
            # Some more than asked for, to see the gap behind the last.
            wanted = min(count + 2 * 4**attempt, self._system.size - 1)
            values, vectors = self._modes(factor, shift, wanted, above=False, attempt=attempt, draft=draft)
            limit = _gap_after(values, count, self.floor)
            if limit == 0.0:
                continue
            if not draft:
                progress("counting the modes found")
                del factor  # two at once would be the most memory that a search takes
                factor = self._factor(limit**2)
            below = NOT_COUNTED if draft else factor.negative
            certificate, values, vectors = self._certify(values, vectors, limit, below)
            if certificate.complete or (draft and certificate.max_overlap < OVERLAP_BOUND):
                return CertifiedModes(values, vectors, certificate, factor, shift)
            if values.max(initial=0.0) > self.floor:
                # Farther from rigid modes, by the scale of the elastic ones: less of their rounding stands in these.
                shift = -max(self.floor, _BELOW * float(values[values > self.floor][0]))
        raise _incomplete(certificate)

    def _factor(self, shift: float) -> Factorization:
        start = time.perf_counter()
        if isinstance(self._factorizer, SlepcRanks):
            numeric = self._factorizer.factor(shift)
            factor = checked_factor("mumps", numeric, self._system.shifted(shift), time.perf_counter() - start)
        else:
            factor = self._factorizer.factor(self._system.shifted(shift))
        self.seconds["factorisation"] += time.perf_counter() - start
        return factor

    def _modes(
        self,
        factor: Factorization,
        shift: float,
        count: int,
        *,
        above: bool,
        attempt: int,
        draft: bool = False,
        responses: LoadResponses | None = None,
    ) -> tuple[FloatArray, FloatArray]:
        """Uncertified modes; none where an attempt before the last does not converge."""
        start = time.perf_counter()
        system = self._system
        try:
            if isinstance(self._factorizer, SlepcRanks):
                return self._factorizer.modes(shift, count, above=above, seed=attempt)
            if factor.precision == "single" and self._solver == "lanczos":
                return davidson_modes(
                    system.size,
                    system.products,
                    factor.solve_approximately,
                    count,
                    floor=self.floor,
                    tolerance=_IN_SINGLE,
                    seed=attempt,
                    threads=system.threads,
                )
            return nearest_modes(
                self._solver,
                factor.solve,
                system.mass,
                shift,
                count,
                above=above,
                seed=attempt,
                threads=system.threads,
                tolerance=_DRAFT if draft else None,
                responses=responses,
            )
        except IncompleteModesError:
            if attempt + 1 == _ATTEMPTS:
                raise
            # The next attempt has a wider block, which modes of high multiplicity need.
            return np.empty(0), np.empty((system.size, 0))
        finally:
            self.seconds["eigensolver"] += time.perf_counter() - start

    def _certify(
        self, values: FloatArray, vectors: FloatArray, limit: float, below: int
    ) -> tuple[Certificate, FloatArray, FloatArray]:
        """Refine the modes below ``limit`` by Rayleigh-Ritz and certify them against the inertia count ``below``."""
        start = time.perf_counter()
        values, vectors, residuals, overlap = _refined(self._system, values, vectors, limit**2 + self.floor)
        keep = values < limit**2
        certificate = Certificate(limit, below, int(keep.sum()), float(residuals[keep].max(initial=0.0)), overlap)
        self.seconds["eigensolver"] += time.perf_counter() - start
        return certificate, values[keep], vectors[:, keep]


def _incomplete(certificate: Certificate) -> IncompleteModesError:
    if certificate.limit == 0.0:
        return IncompleteModesError(
            f"no search of the lowest {certificate.expected} modes came to a gap behind the last; ask for another "
            "number, or give a frequency limit"
        )
    return IncompleteModesError(
        f"{certificate.found} modes found below {certificate.limit / (2 * np.pi):.6g} Hz where the inertia demands "
        f"{certificate.expected}, largest residual {certificate.max_residual:.1e}, largest overlap "
        f"{certificate.max_overlap:.1e}; move the limit a little or refine the mesh"
    )


def indefinite_stiffness_error(finding: str) -> FactorizationError:
    """Error for a stiffness with negative energies."""
    return FactorizationError(f"{finding}; the stiffness is not positive semidefinite")


def _refined(
    system: FreeSystem, values: FloatArray, vectors: FloatArray, scale: float
) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Rayleigh-Ritz modes of K and M in the space of those found, their residuals and their largest overlap.

    The eigenvalues of the inverse are not accurate enough: with a shift close to rigid modes the inverse is huge along
    these, and its rounding contaminates each elastic mode by a factor of λ / |σ|. Vectors that overlap already are left
    as they are, so that they fail their certificate.
    """
    algebra = BlockAlgebra(system.size, system.threads)
    force, inertia = system.products(vectors)
    overlaps = algebra.products(vectors, inertia)
    if np.abs(overlaps - np.eye(len(values))).max(initial=0.0) < OVERLAP_BOUND:
        values, mixture = linalg.eigh(algebra.products(vectors, force), overlaps)
        vectors, inertia, force = (algebra.combined(columns, mixture) for columns in (vectors, inertia, force))
        overlaps = algebra.products(vectors, inertia)
    error = np.linalg.norm(force - inertia * values, axis=0)
    residuals = error / ((np.abs(values) + scale) * np.linalg.norm(inertia, axis=0))
    return values, vectors, residuals, float(np.abs(overlaps - np.eye(len(values))).max(initial=0.0))


def _gap_after(values: FloatArray, count: int, floor: float) -> float:
    """Return a circular frequency in the first gap after ``count`` modes; 0 where they end within a multiple mode.

    ``floor`` [rad²/s²] is far above the rounding of rigid modes, whose differences are no gaps.
    """
    scale = max(float(np.abs(values).max(initial=0.0)), floor)
    for below, above in zip(values[count - 1 :], values[count:], strict=False):
        if above - below > _RELATIVE_GAP * scale:
            return float(np.sqrt(max(0.5 * (below + above), 0.0)))
    return 0.0
