"""Natural modes of the housing, with the proof that none is missing (:mod:`gearwhine.housing.modes.certificate`).

Residual attachment modes can be added to an existing mode set, read from a file or solved for with other ports.
"""

import hashlib
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, get_args

import numpy as np
import numpy.typing as npt
from scipy import sparse

from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.factorization import Backend, Factorization, Factorizer
from gearwhine.housing.fem.linear_algebra import Precision
from gearwhine.housing.fem.matrices import FreeSystem, Matrices
from gearwhine.housing.fem.slepc import SlepcRanks
from gearwhine.housing.modes.certificate import MOST_MODES, Certificate, CertifiedSearch, indefinite_stiffness_error
from gearwhine.housing.modes.eigensolver import DEFAULT_SOLVER, LoadResponses, Solver
from gearwhine.housing.modes.residual_modes import (
    ResidualModes,
    extended_residual_modes,
    missing_harmonic_responses,
    port_motions,
    residual_attachment_modes,
)
from gearwhine.numerics.arrays import FloatArray

_MOST_LOADS = 32  # loads in a block of the search: of more, the basis takes longer than sweeps
_LARGEST_ENTRY_TOLERANCE = 1e-6  # part of the largest entry by which another may be smaller and count as large


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
        Certificate of the modes as computed; the residual modes then reduce their residuals further.
    seconds : dict of str to float
        Time taken by ``factorisation``, ``eigensolver`` and, where ports were given, ``reduction`` [s].
    backend : str
        Name of the factorisation, with its precision where that is not double.
    shift : float
        The eigenvalue about which the modes were searched [rad²/s²].
    threads : int
        Workers of the factorisation.
    residual_modes : ResidualModes or None
        Residual modes, which complete the static response to loads at the ports, where ports were given.
    discretisation_errors : ndarray, shape (n_modes,), or None
        Estimate of each frequency's relative error by the mesh, where the mesh is known; see
        :mod:`gearwhine.housing.modes.discretisation_error`.
    """

    frequencies: FloatArray
    shapes: FloatArray
    certificate: Certificate
    seconds: dict[str, float]
    backend: str
    shift: float
    threads: int
    residual_modes: ResidualModes | None = None
    discretisation_errors: FloatArray | None = None

    @property
    def frequencies_hz(self) -> FloatArray:
        """Natural frequencies [Hz], shape (n_modes,)."""
        return self.frequencies / (2.0 * np.pi)

    def project(self, port: sparse.csr_array) -> FloatArray:
        """Project a port on the modes: their motions at it, shape (n_modes, n_motions)."""
        return port_motions(port, self.shapes)

    def project_all(self, port: sparse.csr_array) -> FloatArray:
        """Motions at a port of the modes, then of the residual modes, shape (n_modes + n_residual, n_motions)."""
        modes = self.project(port)
        return modes if self.residual_modes is None else np.vstack([modes, self.residual_modes.project(port)])

    def displacement(self, coordinates: FloatArray, nodes: npt.NDArray[np.int64]) -> FloatArray:
        """Displacement of nodes by coordinates of the modes, then of the residual modes [m], shape (n_nodes, 3)."""
        count = len(self.shapes)
        moved = _superposed(coordinates[:count], self.shapes, nodes)
        if self.residual_modes is not None:
            moved = moved + _superposed(coordinates[count:], self.residual_modes.shapes, nodes)
        return moved


def _superposed(coordinates: FloatArray, shapes: FloatArray, nodes: npt.NDArray[np.int64]) -> FloatArray:
    """Sum of shapes (k, n_nodes, 3) by coordinates (k,) at some nodes; of all nodes no shape is copied."""
    if len(nodes) < shapes.shape[1]:
        shapes, nodes = shapes[:, nodes], np.arange(len(nodes))
    every = coordinates @ shapes.reshape(len(shapes), -1)
    return np.asarray(every.reshape(-1, 3)[nodes])


def solve_modes(
    matrices: Matrices,
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
    draft: bool = False,
    ports: sparse.csr_array | None = None,
    port_orders: int = 1,
    solver: Solver = DEFAULT_SOLVER,
    backend: Backend | None = None,
    precision: Precision | None = None,
    threads: int = 2,
    progress: Callable[[str], None] = lambda message: None,
    found: Callable[[FloatArray, FloatArray], None] | None = None,
) -> ModeSet:
    """Solve for all natural modes below a frequency, or for a number of the lowest.

    Parameters
    ----------
    matrices : Matrices
        Matrices of n_nodes nodes, with the supports and whatever else is attached to them, see
        :func:`gearwhine.housing.attach_fixtures`.
    frequency_limit : float
        Every mode below it is found [rad/s]. Either this or ``count``.
    count : int
        Number of the lowest modes; a multiple mode at the end is completed.
    draft : bool
        With ``count``, skip the inertia count behind the last mode, in two thirds of the time. The last modes are less
        accurate (their λ to some 1e-8), and the certificate is not complete.
    ports : scipy.sparse.csr_array, shape (r, 3 n_nodes), optional
        Motions whose static compliance the mode set is to hold exactly, by residual modes.
    port_orders : int
        Responses for each of these motions: 1, the static one; 2, that at the limit too; see
        :func:`gearwhine.housing.modes.residual_modes.residual_attachment_modes`.
    solver : {"lanczos", "eigsh", "slepc"}
        Block Lanczos or ``scipy.sparse.linalg.eigsh``, both on the same factor, or SLEPc with MUMPS on ranks of MPI,
        see :mod:`gearwhine.housing.fem.slepc`; all with the same certificate.
    backend, precision, threads
        See :class:`gearwhine.housing.fem.factorization.Factorizer`; not for SLEPc, which has as many ranks as threads
        unless the environment says otherwise. With a factor in single precision the modes are
        corrected by residuals in double, and certified in double as any others.
    progress : callable
        Called with a line of text before each step.
    found : callable, optional
        Called with certified frequencies [rad/s] and shapes before the residual modes are sought, which turn the shapes
        by no more than their error.

    Raises
    ------
    HousingError
        Where neither or both of limit and count are given, they ask for nothing or for everything, or the solver is
        unknown.
    SlepcUnavailableError
        Where the ranks of SLEPc cannot be started.
    IncompleteModesError
        Where the certificate is not complete after three searches.
    ReductionError
        Where the static compliance at the ports fails its proof.
    """
    if (frequency_limit is None) == (count is None):
        raise HousingError("give a frequency limit or a number of modes, one of the two")
    system = FreeSystem(matrices, threads=threads)
    most = min(system.size - 2, MOST_MODES)
    if count is not None and not 1 <= count <= most:
        raise HousingError(f"{count} modes asked of {system.size} degrees of freedom: give 1 to {most}")
    if draft and (count is None or ports is not None):
        raise HousingError("a draft is of a number of modes, without ports")
    if frequency_limit is not None and frequency_limit <= 0.0:
        raise HousingError(f"frequency limit {frequency_limit} rad/s must be positive")

    if solver not in get_args(Solver):
        raise HousingError(f"eigensolver {solver!r}; expected one of {', '.join(map(repr, get_args(Solver)))}")
    factorizer: Factorizer | SlepcRanks
    if solver == "slepc":
        if backend is not None or precision is not None:
            raise HousingError("the solver 'slepc' has a factorisation of its own, in double precision: leave out both")
        factorizer = SlepcRanks(*system.assembled_pair(), threads)
    else:
        factorizer = Factorizer(backend=backend, precision=precision, threads=threads, progress=progress)
        factorizer.order_ahead(system.shifted(0.0))
    search = CertifiedSearch(system, factorizer, system.floor(frequency_limit or 0.0), solver)
    responses = None
    if ports is not None and ports.shape[0] <= _MOST_LOADS:
        responses = LoadResponses(ports[:, system.free].T.toarray(), port_orders)
    solution = (
        search.below(frequency_limit, progress, responses)
        if frequency_limit is not None
        else search.lowest(count or 0, progress, draft=draft)
    )
    values, vectors = solution.values, _oriented(solution.vectors)
    values[np.abs(values) < 1e-6 * search.floor] = 0.0
    if values[0] < -search.floor:
        raise indefinite_stiffness_error(f"the lowest eigenvalue of K is {values[0]:g} rad²/s²")
    frequencies = np.sqrt(np.maximum(values, 0.0))
    if found is not None:
        found(frequencies, system.expand(vectors))
    residual_modes = None
    if ports is not None:
        start = time.perf_counter()
        work = "attaching the static response at the ports"
        progress(work)
        residual_modes, vectors = residual_attachment_modes(
            system.stiffness,
            system.mass,
            solution.factor.solve,
            values,
            vectors,
            ports[:, system.free],
            shift=solution.certificate.limit**2,
            floor=search.floor,
            free=system.free,
            n_nodes=system.n_nodes,
            orders=port_orders,
            begin=responses.found if responses is not None else (),
            solve_approximately=solution.factor.solve_approximately,
            threads=threads,
            progress=lambda step: progress(f"{work}: {step}"),
        )
        search.seconds["reduction"] = time.perf_counter() - start
    return ModeSet(
        frequencies=frequencies,
        shapes=system.expand(vectors),
        certificate=solution.certificate,
        seconds=search.seconds,
        backend=solution.factor.name,
        shift=solution.shift,
        threads=threads,
        residual_modes=residual_modes,
    )


def _oriented(vectors: FloatArray) -> FloatArray:
    """Orient mode shapes so that the largest entry is positive, and equal input draws equal pictures.

    Among entries that symmetry makes equally large, the first counts, or rounding would choose.
    """
    size = np.abs(vectors)
    largest = np.argmax(size >= (1.0 - _LARGEST_ENTRY_TOLERANCE) * size.max(axis=0), axis=0)
    return np.asarray(vectors * np.sign(vectors[largest, np.arange(vectors.shape[1])]))


class ModeSetExtension:
    """Extension of a mode set by further residual modes; its span keeps all that it has.

    One factor of K - σM, σ at the limit of the modes, serves all of them; none is made where all responses are known.

    Parameters
    ----------
    matrices : Matrices
        The matrices of the modes, supports included.
    modes : ModeSet
        Complete up to its limit.
    known : mapping of str to ndarray, optional
        Responses of an earlier extension of the same modes.
    backend, threads
        See :class:`gearwhine.housing.fem.factorization.Factorizer`.

    Attributes
    ----------
    responses : dict of str to ndarray, shape (k, n_nodes, 3)
        Displacements that were added to the residual modes, by a digest of what they respond to.
    """

    def __init__(
        self,
        matrices: Matrices,
        modes: ModeSet,
        *,
        known: Mapping[str, FloatArray] | None = None,
        backend: Backend | None = None,
        threads: int = 2,
    ) -> None:
        self._system = FreeSystem(matrices, threads=threads)
        self._shift = modes.certificate.limit**2
        self._factorizer = Factorizer(backend=backend, threads=threads)
        self._vectors = modes.shapes.reshape(len(modes.shapes), -1).T[self._system.free]
        self._known = known or {}
        self.responses: dict[str, FloatArray] = {}

    @cached_property
    def _factor(self) -> Factorization:
        return self._factorizer.factor(self._system.shifted(self._shift))

    def with_ports(
        self,
        modes: ModeSet,
        ports: Sequence[sparse.csr_array] | sparse.csr_array,
        *,
        orders: int,
        progress: Callable[[str], None] = lambda message: None,
    ) -> ModeSet:
        """Add residual modes of further ports, such as sensors.

        Parameters
        ----------
        modes : ModeSet
            The modes of this extension, with any residual modes.
        ports : sparse array of shape (r, 3 n_nodes), or a sequence of them
        orders : int
            Number of orders, as `port_orders` of :func:`solve_modes`.
        progress : callable
            Called with a line of text before each step.

        Raises
        ------
        HousingError, ReductionError
            See :func:`gearwhine.housing.modes.residual_modes.residual_attachment_modes`.
        """
        system, port = self._system, stacked(ports)

        def solved() -> ResidualModes:
            progress("factorisation at the limit of the modes")
            return residual_attachment_modes(
                system.stiffness,
                system.mass,
                self._factor.solve,
                modes.frequencies**2,
                self._vectors,
                port[:, system.free],
                shift=self._shift,
                floor=system.floor(modes.certificate.limit),
                free=system.free,
                n_nodes=system.n_nodes,
                orders=orders,
                solve_approximately=self._factor.solve_approximately,
                threads=system.threads,
                progress=progress,
            )[0]

        if modes.residual_modes is None:
            return replace(modes, residual_modes=solved())
        key = _digest(np.array(orders), port.data, port.indices, port.indptr)
        return self._joined(modes, key, lambda: solved().shapes)

    def with_harmonic_responses(
        self,
        modes: ModeSet,
        loads: Sequence[tuple[float, FloatArray]],
        progress: Callable[[str], None] = lambda message: None,
    ) -> ModeSet:
        """Add to the residual modes what they lack of the responses to some harmonic loads, so that these are exact.

        Parameters
        ----------
        modes : ModeSet
            The modes of this extension, with residual modes.
        loads : sequence of (float, ndarray of shape (3 n_nodes, m))
            Frequencies ω below the limit [rad/s], and amplitudes of loads [N].
        progress : callable
            Called with a line of text before each sweep.

        Raises
        ------
        HousingError
            For a frequency at the limit or above.
        ReductionError
            Where the sweeps do not converge.
        """
        if modes.residual_modes is None:
            raise HousingError("harmonic responses of modes without residual modes; add those of ports first")
        beyond = [frequency for frequency, _ in loads if frequency**2 >= self._shift]
        if beyond:
            raise HousingError(f"a harmonic load at {beyond[0]:g} rad/s; expected one below the limit of the modes")
        if not loads:
            return modes
        system, residual = self._system, modes.residual_modes

        def missing() -> FloatArray:
            found = missing_harmonic_responses(
                system.stiffness,
                system.mass,
                self._factor.solve_approximately,
                [(frequency, load[system.free]) for frequency, load in loads],
                self._vectors,
                np.asarray(system.mass @ self._vectors),
                residual.shapes.reshape(len(residual.shapes), -1).T[system.free],
                residual.frequencies,
                system.threads,
                progress,
            )
            return system.expand(np.hstack(found))

        parts = [part for frequency, load in loads for part in (np.array(frequency), load)]
        return self._joined(modes, _digest(residual.frequencies, *parts), missing)

    def _joined(self, modes: ModeSet, key: str, solve: Callable[[], FloatArray]) -> ModeSet:
        """Add displacements to the residual modes: known ones, or those that are solved for."""
        assert modes.residual_modes is not None
        system, known = self._system, self._known.get(key)
        self.responses[key] = response = solve() if known is None else known
        joined = extended_residual_modes(
            system.stiffness,
            system.mass,
            modes.residual_modes,
            response.reshape(len(response), math.prod(response.shape[1:])).T[system.free],
            self._vectors,
            system.free,
            system.threads,
        )
        return replace(modes, residual_modes=joined)


def _digest(*arrays: npt.NDArray[Any]) -> str:
    """SHA-256 of arrays, shortened to 16 digits."""
    total = hashlib.sha256()
    for array in arrays:
        total.update(f"{array.shape}{array.dtype.str}".encode())
        total.update(np.ascontiguousarray(array).tobytes())
    return total.hexdigest()[:16]


def stacked(ports: Sequence[sparse.csr_array] | sparse.csr_array) -> sparse.csr_array:
    """Several ports as one, their motions in order."""
    if isinstance(ports, sparse.csr_array):
        return ports
    return sparse.csr_array(sparse.vstack(list(ports), format="csr"))
