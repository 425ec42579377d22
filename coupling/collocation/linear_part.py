r"""Linear part of the machine: eigenvalues at the mean mesh stiffness, and the steady response to the loads.

With K̄ and C̄ those of the system and of every drive flank at its mean stiffness and damping, and the runout errors
e and clearances taken to the loads, the reference

    q'' + C̄ q' + K̄ q = F + Σ Re(F_w e^{iwt}) + Σ d (k̄ (e + clearance) + c̄ e')

has a periodic response in closed form, by a solution at each frequency (its receptance). The teeth's excess over the
mean acts through its eigenvalues. Motions that nothing resists, such as gears that roll together, take no part in
either: they oscillate freely under the harmonic loads, about a mean position of zero.

Over speed, eigenvectors follow from those of the neighbouring matrix by perturbation. With right vectors X and left
ones Y = X⁻¹ of the neighbour, B = Y A X is all but diagonal, and to the first order

    X ← X (1 + E),    Y ← (1 + E)⁻¹ Y,        E_ij = B_ij / (B_jj - B_ii),    i ≠ j,

which squares the error each time. Where eigenvalues are too close for that, the correction fails.

- G. W. Stewart, J. Sun, *Matrix Perturbation Theory*, 1990, chapter V.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from gearwhine.coupling.collocation.arrays import Reference
from gearwhine.coupling.errors import CouplingError, PeriodicError
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.numerics.arrays import ComplexArray, FloatArray

_LARGEST = 0.05  # largest entry of E for which the correction converges
_SMALLEST = 1e-8  # entry of E at which the corrections stop: its square is rounding
_ROUNDING = 1e-13  # rounding of B over the largest eigenvalue
_STEPS = 5
_MISSED = 1e-12  # largest residual X diag(λ) Y - A, over the sum of its terms' sizes


def corrected_eigenvectors(
    matrix: FloatArray, values: ComplexArray, right: ComplexArray, left: ComplexArray
) -> tuple[ComplexArray, ComplexArray, ComplexArray] | None:
    """Correct a neighbour's eigenvalues and vectors to a real matrix; None where they are too far from it.

    Parameters
    ----------
    matrix : ndarray, shape (2 N, 2 N)
    values : ndarray of complex, shape (m,)
        Eigenvalues of the neighbour, one of each conjugate pair.
    right, left : ndarray of complex, shapes (2 N, m) and (m, 2 N)
        Right eigenvectors, scaled for both of a conjugate pair, and left eigenvectors.

    Returns
    -------
    values, right, left
        Corrected, in the same order.
    """
    oscillating = values.imag > 0.0
    weights = np.where(oscillating, 2.0, 1.0)
    single = right / weights
    x = np.concatenate([single, single[:, oscillating].conj()], axis=1)
    y = np.concatenate([left, left[oscillating].conj()])
    if x.shape[1] != len(matrix):
        return None
    identity, size = np.eye(len(matrix)), np.inf
    for _ in range(_STEPS):
        projected = y @ (matrix @ x)
        quotients = np.diagonal(projected)
        apart = quotients[None, :] - quotients[:, None] + identity
        # Any vectors serve for a multiple eigenvalue: their coupling is rounding.
        coupled = (identity == 0.0) & (np.abs(projected) > _ROUNDING * np.abs(quotients).max())
        move = np.where(coupled, projected / np.where(apart == 0.0, 1e-300, apart), 0.0)
        size = float(np.abs(move).max())
        if not size < _LARGEST:
            return None
        x = x + x @ move
        y = y - move @ (y - move @ y)
        y = 2.0 * y - y @ (x @ y)  # its inverse to rounding
        if size < _SMALLEST:
            break
    quotients = np.diagonal(y @ (matrix @ x)).copy()
    missed = np.abs((x * quotients) @ y - matrix)
    sizes = np.abs(x) @ np.abs(quotients[:, None] * y)
    if (
        size >= _SMALLEST
        or np.any(missed > _MISSED * sizes.max())
        or np.any(quotients[: len(values)][oscillating].imag <= 0.0)
    ):
        return None
    eigenvalues, vectors, rows = quotients[: len(values)], x[:, : len(values)], y[: len(values)]
    # Vectors of a real eigenvalue are real but for rounding.
    eigenvalues[~oscillating], vectors[:, ~oscillating], rows[~oscillating] = (
        part[...].real for part in (eigenvalues[~oscillating], vectors[:, ~oscillating], rows[~oscillating])
    )
    return eigenvalues, np.ascontiguousarray(vectors * weights), np.ascontiguousarray(rows)


_RIGID = 1e-12  # stiffness below this part of the largest is a motion that nothing resists
_NO_WORK = 1e-9  # part of the damping forces in a free motion that may be along it where they do no work
_BALANCE = 1e-6  # largest part of the load on a rigid-body motion
_DEFECT = 1e-7  # largest residual of eigenvalues and vectors, relative


@dataclass(frozen=True, eq=False)
class LinearPart:
    """Linear reference of a system; n coordinates, N of them without rigid-body motions, m eigenvalues, h harmonics.

    Attributes
    ----------
    system : CoupledSystem
    rate_unit : float
        Unit of the rates, in which they compare with displacements [1/s].
    basis, rigid : ndarray, shapes (n, N) and (n, n - N)
        Orthonormal bases of the resisted motions and of the rigid-body motions, which nothing resists.
    eigenvalues : ndarray of complex, shape (m,)
        [1/s]; one of each conjugate pair.
    right : ndarray of complex, shape (2 N, m)
        The state (basisᵀ q, basisᵀ q' / rate_unit) is Re(right z).
    left : ndarray of complex, shape (m, 2 N)
        The amplitudes z of a state.
    mean : ndarray, shape (n,)
        Mean of the reference's own response.
    frequencies : ndarray, shape (h,)
        Circular frequencies of that response [rad/s].
    amplitudes : ndarray of complex, shape (h, n)
    matrices : tuple of ndarray
        K̄ and C̄ on the whole coordinates, shape (n, n) each, from which basis and eigenvalues are computed.
    """

    system: CoupledSystem
    rate_unit: float
    basis: FloatArray
    rigid: FloatArray
    eigenvalues: ComplexArray
    right: ComplexArray
    left: ComplexArray
    mean: FloatArray
    frequencies: FloatArray
    amplitudes: ComplexArray
    matrices: tuple[FloatArray, FloatArray] = field(repr=False)

    @property
    def states(self) -> int:
        """Number of states of the resisted motions, 2 N."""
        return len(self.right)

    def own_response(self, time: float) -> tuple[FloatArray, FloatArray]:
        """Evaluate the linear reference's displacements and rates at a time, shape (n,) each."""
        phasors = self.amplitudes * np.exp(1j * self.frequencies * time)[:, None]
        return self.mean + phasors.real.sum(axis=0), -(self.frequencies[:, None] * phasors.imag).sum(axis=0)

    def state(self, displacement: FloatArray, velocity: FloatArray, time: float = 0.0) -> FloatArray:
        """State of a motion relative to the reference's own, shape (2 N,)."""
        q, v = self.own_response(time)
        return np.concatenate([self.basis.T @ (displacement - q), self.basis.T @ (velocity - v) / self.rate_unit])

    def motion(self, state: FloatArray, time: float = 0.0) -> tuple[FloatArray, FloatArray]:
        """Displacements and rates of a state, shape (n,) each."""
        q, v = self.own_response(time)
        half = len(state) // 2
        return q + self.basis @ state[:half], v + self.rate_unit * (self.basis @ state[half:])

    def amplitudes_of(self, state: FloatArray, time: float | FloatArray = 0.0) -> FloatArray:
        """Amplitudes of a state and of the loads, as in the kernels, shape (2 M,); or (K, 2 M) of states at K times."""
        reference = np.exp(np.multiply.outer(time, self.reference.eigenvalue[len(self.eigenvalues) :]))
        whole = np.concatenate([state @ self.left.T, reference], axis=-1)
        return np.concatenate([whole.real, whole.imag], axis=-1)

    @cached_property
    def to_amplitudes(self) -> FloatArray:
        """Matrix to the amplitudes of a state, real parts and then nonzero imaginary ones, shape (2 N, 2 N)."""
        oscillating = self.eigenvalues.imag > 0.0
        return np.concatenate([self.left.real, self.left.imag[oscillating]])

    @cached_property
    def from_amplitudes(self) -> FloatArray:
        """Matrix from amplitudes to a state, the inverse of `to_amplitudes`, shape (2 N, 2 N)."""
        oscillating = self.eigenvalues.imag > 0.0
        return np.concatenate([self.right.real, -self.right.imag[:, oscillating]], axis=1)

    @cached_property
    def displacement_rows(self) -> FloatArray:
        """Rows of all coordinates over the amplitudes, those of the loads included, shape (n, 2 M)."""
        return self._rows(self.basis @ self.right[: self.states // 2], self.amplitudes.T, self.mean)

    @cached_property
    def velocity_rows(self) -> FloatArray:
        """Rows of all rates over the amplitudes, shape (n, 2 M)."""
        moving = self.rate_unit * (self.basis @ self.right[self.states // 2 :])
        return self._rows(moving, (1j * self.frequencies[:, None] * self.amplitudes).T, np.zeros_like(self.mean))

    def _rows(self, modes: ComplexArray, harmonics: ComplexArray, mean: FloatArray) -> FloatArray:
        # Runout errors have amplitudes too, but move no coordinate.
        count = len(self.reference.eigenvalue) - modes.shape[1] - harmonics.shape[1] - 1
        none = np.zeros((len(mean), count))
        return real_rows(np.concatenate([modes, harmonics, none, mean[:, None]], axis=1))

    @cached_property
    def reference(self) -> Reference:
        """The reference over the motion at its contacts, as arrays for the kernels."""
        contacts, half = self.system.contacts, self.states // 2
        directions = self.basis.T @ self.system.contact_directions
        frequencies = list(self.frequencies)
        phasors = [list(row) for row in (self.amplitudes @ self.system.contact_directions).T]
        for k, contact in enumerate(contacts):
            for amplitude, frequency, phase in contact.errors:
                frequencies.append(frequency)
                for other, row in enumerate(phasors):
                    row.append(-amplitude * np.exp(1j * phase) if other == k else 0.0)
        mean = self.mean @ self.system.contact_directions - [contact.clearance for contact in contacts]
        phasor = np.array(phasors, dtype=np.complex128).reshape(len(contacts), len(frequencies))
        exponents = 1j * np.array(frequencies)
        from_contacts = np.zeros((len(frequencies) + 1, len(contacts)))
        still = np.zeros((len(contacts), 1))
        displacement = [directions.T @ self.right[:half], phasor, mean[:, None]]
        rate = [self.rate_unit * (directions.T @ self.right[half:]), exponents * phasor, still]
        return Reference(
            eigenvalue=np.concatenate([self.eigenvalues, exponents, [0.0]]),
            source=np.concatenate([self.left[:, half:] @ directions / self.rate_unit, from_contacts]),
            displacement=real_rows(np.concatenate(displacement, axis=1)),
            rate=real_rows(np.concatenate(rate, axis=1)),
            stiffness=self.system.loaded_flank_stiffness,
            damping=self.system.loaded_flank_damping,
            full_damping=np.array([contact.contact.damping for contact in contacts], dtype=np.float64),
        )


def real_rows(rows: ComplexArray) -> FloatArray:
    """Real rows (k, 2 m) over Re z, Im z whose product is Re(d z), from complex rows d."""
    return np.concatenate([rows.real, -rows.imag], axis=1)


def linear_part(
    system: CoupledSystem, rate_unit: float, like: LinearPart | None = None, *, repeats: bool = True
) -> LinearPart:
    """Linear reference of a system, at the mean mesh stiffness.

    Parameters
    ----------
    system : CoupledSystem
    rate_unit : float
        See :class:`LinearPart`.
    like : LinearPart, optional
        Linear part of the same machine at another speed: its basis is reused where the rigid-body motions are the same,
        its eigenvectors where its matrices are.
    repeats : bool
        Whether the motion is periodic, so that the loads on rigid-body motions must balance. They have no part in the
        reference in either case.

    Raises
    ------
    CouplingError
        Where the motion is periodic and a load drives a rigid-body motion.
    PeriodicError
        Where the reference has a load at an undamped natural frequency, or eigenvectors that do not separate.
    """
    directions = system.contact_directions
    k_mean, c_mean = system.loaded_flank_stiffness, system.loaded_flank_damping
    stiffness, damping = system.mean_stiffness, system.mean_damping
    same = like is not None and all(map(np.array_equal, like.matrices, (stiffness, damping)))
    if like is not None and (same or _splits(like, stiffness, damping, directions)):
        basis, rigid = like.basis, like.rigid
    else:
        basis, rigid = _split(stiffness, damping, directions)

    constant = system.load + directions @ (k_mean * [contact.clearance for contact in system.contacts])
    harmonics: dict[float, ComplexArray] = {}
    for load in system.harmonic_loads:
        harmonics[load.frequency] = harmonics.get(load.frequency, 0.0) + load.amplitude
    for k, contact in enumerate(system.contacts):
        for amplitude, frequency, phase in contact.errors:
            force = (k_mean[k] + 1j * frequency * c_mean[k]) * amplitude * np.exp(1j * phase) * contact.direction
            harmonics[frequency] = harmonics.get(frequency, 0.0) + force
    constant = constant + np.asarray(harmonics.pop(0.0, np.zeros(system.size))).real
    if repeats and np.any(np.abs(rigid.T @ constant) > _BALANCE * (np.abs(rigid.T) @ np.abs(constant))):
        raise CouplingError(
            "the loads do not balance: they would accelerate a motion that nothing resists, such as the train's "
            "rotation, and no motion would repeat; check the torques in and out against the gear ratios"
        )
    within, resisting = basis.T @ stiffness @ basis, basis.T @ damping @ basis
    if len(within) and np.linalg.cond(within) > 1.0 / _RIGID:
        free = np.linalg.svd(within)[2][-1]
        if abs(free @ resisting @ free) <= _NO_WORK * np.linalg.norm(resisting @ free):
            raise PeriodicError(
                "the train's own turning meets Coriolis forces of planets that circle, so that it has no mean that "
                "shooting could start from; settled_response finds the motion in which such a machine settles "
                "(`steady`)"
            )
        raise PeriodicError(
            "a motion has no stiffness but meets damping, or a contact that is apart in the mean: nothing says where "
            "its mean is; hold it with a soft spring"
        )
    frequencies = np.array(sorted(harmonics), dtype=np.float64)
    amplitudes = np.zeros((len(frequencies), system.size), dtype=np.complex128)
    identity = np.eye(basis.shape[1])
    try:
        mean = basis @ np.linalg.solve(within, basis.T @ constant)
        for row, w in zip(amplitudes, frequencies, strict=True):
            row[:] = basis @ np.linalg.solve(within + 1j * w * resisting - w * w * identity, basis.T @ harmonics[w])
            row -= rigid @ (rigid.T @ harmonics[w]) / w**2
    except np.linalg.LinAlgError as error:
        raise PeriodicError(
            "a load stands at an undamped natural frequency of the machine with its mean contact: no bounded reference "
            "to start from; give the machine some damping"
        ) from error
    if like is not None and same:
        ratio = np.repeat([1.0, like.rate_unit / rate_unit], basis.shape[1])
        eigenvalues, right, left = like.eigenvalues, like.right * ratio[:, None], like.left / ratio
    else:
        eigenvalues, right, left = _eigenvectors(within, resisting, rate_unit, like)
    matrices = (stiffness, damping)
    return LinearPart(
        system, rate_unit, basis, rigid, eigenvalues, right, left, mean, frequencies, amplitudes, matrices
    )


def _split(stiffness: FloatArray, damping: FloatArray, directions: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Orthonormal bases of the resisted motions and of the rigid-body motions, shapes (n, N) and (n, n - N)."""
    parts = [stiffness, stiffness.T, damping, damping.T]
    scaled = [part / (np.abs(part).max() or 1.0) for part in parts]
    scaled.append((directions / (np.abs(directions).max(initial=0.0) or 1.0)).T)
    _, values, rows = np.linalg.svd(np.vstack(scaled), full_matrices=False)
    # Soft motions are far above: a stiffness is the square of a frequency.
    free = values < _RIGID * values[0]
    return np.ascontiguousarray(rows[~free].T), np.ascontiguousarray(rows[free].T)


def _splits(like: LinearPart, stiffness: FloatArray, damping: FloatArray, directions: FloatArray) -> bool:
    """Whether ``like`` has the rigid-body motions of this system; extra ones show in the remaining stiffness."""
    if like.rigid.shape[0] != len(stiffness):
        return False
    for part in (stiffness, stiffness.T, damping, damping.T, directions.T):
        if np.abs(part @ like.rigid).max(initial=0.0) > _RIGID * np.abs(part).max(initial=0.0):
            return False
    return True


def _eigenvectors(
    stiffness: FloatArray, damping: FloatArray, rate_unit: float, like: LinearPart | None = None
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Eigenvalues, one of each conjugate pair, with right vectors that count for both, and left vectors."""
    half = len(stiffness)
    state = np.block([[np.zeros((half, half)), rate_unit * np.eye(half)], [-stiffness / rate_unit, -damping]])
    if like is not None and len(like.right) == len(state):
        # Of the same machine at a neighbouring speed they are a few corrections away.
        scale = np.repeat([1.0, like.rate_unit / rate_unit], half)
        near = corrected_eigenvectors(state, like.eigenvalues, like.right * scale[:, None], like.left / scale)
        if near is not None:
            return near
    values, vectors = np.linalg.eig(state)
    vectors = np.asarray(vectors, dtype=np.complex128)
    inverse = np.linalg.inv(vectors)
    size = np.abs(vectors) @ np.abs(values[:, None] * inverse)
    missing = np.abs((vectors * values) @ inverse - state).max(initial=0.0)
    if missing > _DEFECT * np.abs(state).max(initial=1e-300):
        raise PeriodicError(
            f"the eigenvectors of the mean machine do not separate: they miss it by {missing:.1e} of "
            f"{size.max():.1e}; an exactly critical damping is the usual reason, change it slightly"
        )
    upper = values.imag >= 0.0
    weights = np.where(values.imag > 0.0, 2.0, 1.0)[upper]
    return (
        np.ascontiguousarray(values[upper], dtype=np.complex128),
        np.ascontiguousarray(vectors[:, upper] * weights),
        np.ascontiguousarray(inverse[upper]),
    )
