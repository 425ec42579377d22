"""The coupled system as the plain arrays that the time-stepping kernels take."""

from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from coupling.kernel_arrays import Contacts, Dynamics, Outputs, Samples, Segments, StepMatrices
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]


class _Rows(Protocol):
    @property
    def displacement(self) -> FloatArray: ...
    @property
    def velocity(self) -> FloatArray: ...
    @property
    def acceleration(self) -> FloatArray: ...


class _Grid(Protocol):
    @property
    def duration(self) -> float: ...
    @property
    def record_from(self) -> float: ...
    @property
    def sample_interval(self) -> float: ...


class KernelArrays(NamedTuple):
    """Everything that stays the same through a march."""

    dynamics: Dynamics
    contacts: Contacts
    outputs: Outputs


def kernel_arrays(system: CoupledSystem, outputs: _Rows, beta: float, gamma: float) -> KernelArrays:
    """Lay out the system and the rows to record."""
    rows = (np.ascontiguousarray(rows) for rows in (outputs.displacement, outputs.velocity, outputs.acceleration))
    return KernelArrays(_dynamics(system, beta, gamma), _contacts(system), Outputs(*rows))


def empty_samples(system: CoupledSystem, outputs: _Rows, grid: _Grid) -> Samples:
    """Room for the samples from ``record_from`` up to, not including, the end."""
    count = int(np.ceil((grid.duration - grid.record_from) / grid.sample_interval - 1e-6))
    return Samples(
        first=grid.record_from,
        interval=grid.sample_interval,
        displacement=np.zeros((count, len(outputs.displacement))),
        velocity=np.zeros((count, len(outputs.velocity))),
        acceleration=np.zeros((count, len(outputs.acceleration))),
        compression=np.zeros((count, len(system.contacts))),
        force=np.zeros((count, len(system.contacts))),
    )


class StepCache:
    """The matrices of every step size met so far; see :mod:`coupling.newmark` for what they are.

    Few sizes occur: the stretches between events repeat with the mesh period. Sizes that agree to nine digits are
    one.
    """

    def __init__(self, system: CoupledSystem, beta: float, gamma: float) -> None:
        self._system, self._beta, self._gamma = system, beta, gamma
        self._kinds: dict[float, int] = {}
        self._parts: list[tuple[FloatArray, ...]] = []
        self._stacked: StepMatrices | None = None

    def kind(self, size: float) -> int:
        """The number of a step size [s]."""
        key = float(f"{size:.9e}")
        if key not in self._kinds:
            self._kinds[key] = len(self._parts)
            self._parts.append(self._build(key))
            self._stacked = None
        return self._kinds[key]

    def matrices(self) -> StepMatrices:
        """All of them, stacked."""
        if not self._parts:
            self.kind(1.0)
        if self._stacked is None:
            self._stacked = StepMatrices(
                *(np.ascontiguousarray(np.stack(part)) for part in zip(*self._parts, strict=True))
            )
        return self._stacked

    def _build(self, h: float) -> tuple[FloatArray, ...]:
        system, n = self._system, self._system.size
        stiffness, damping = system.stiffness, system.damping
        inverse = np.linalg.inv(np.eye(n) + self._gamma * h * damping + self._beta * h * h * stiffness)
        cosine, sine = _harmonics(system)
        directions = system.contact_directions
        return (
            np.array(h),
            np.vstack([(inverse @ stiffness).T, (inverse @ damping).T]),
            inverse @ system.load,
            cosine @ inverse.T,
            sine @ inverse.T,
            (inverse @ directions).T,
            directions.T @ inverse @ directions,
        )


def cut(cache: StepCache, bounds: FloatArray, step: float) -> Segments:
    """Stretches between bounds, each cut into at least two equal steps no longer than ``step`` [s]."""
    start, end = bounds[:-1], bounds[1:]
    counts = np.maximum(np.ceil((end - start) / step - 1e-9), 2).astype(np.int64)
    kinds = np.array([cache.kind(float(size)) for size in (end - start) / counts], dtype=np.int64)
    return Segments(np.ascontiguousarray(start), np.ascontiguousarray(end), counts, kinds)


def _harmonics(system: CoupledSystem) -> tuple[FloatArray, FloatArray]:
    amplitudes = np.array([load.amplitude for load in system.harmonic_loads], dtype=np.complex128)
    amplitudes = amplitudes.reshape(-1, system.size)
    return np.ascontiguousarray(amplitudes.real), np.ascontiguousarray(amplitudes.imag)


def _dynamics(system: CoupledSystem, beta: float, gamma: float) -> Dynamics:
    stiffness, damping = system.stiffness, system.damping
    skew = 0.5 * (stiffness - stiffness.T)
    symmetric = 0.5 * (damping + damping.T)
    # Components damp their own coordinates; connectors add a few directions, found here as eigenvectors.
    diagonal = np.concatenate([component.damping.diagonal() for component in system.components])
    values, vectors = np.linalg.eigh(symmetric - np.diag(diagonal))
    kept = np.abs(values) > 1e-12 * max(float(np.abs(values).max(initial=0.0)), 1e-300)
    cosine, sine = _harmonics(system)
    return Dynamics(
        stiffness=np.ascontiguousarray(stiffness.T),
        damping=np.ascontiguousarray(damping.T),
        skew=np.ascontiguousarray(skew.T),
        has_skew=bool(np.abs(skew).max() > 1e-12 * np.abs(stiffness).max()),
        loss_diagonal=diagonal,
        loss_rows=np.ascontiguousarray(vectors[:, kept].T),
        loss_weights=values[kept],
        constant=system.load,
        resolved=np.flatnonzero(system.resolved),
        frequency=np.array([load.frequency for load in system.harmonic_loads], dtype=np.float64),
        cosine=cosine,
        sine=sine,
        beta=beta,
        gamma=gamma,
    )


def _contacts(system: CoupledSystem) -> Contacts:
    c = len(system.contacts)
    arguments = [contact.contact.kernel_arguments for contact in system.contacts]
    harmonics = max((len(contact.errors) for contact in system.contacts), default=0)
    errors = np.zeros((c, harmonics, 3))
    for k, contact in enumerate(system.contacts):
        errors[k, : len(contact.errors)] = contact.errors
    entering = [argument[6] for argument in arguments]
    return Contacts(
        direction=np.ascontiguousarray(system.contact_directions.T),
        reach=np.array([argument[:3] for argument in arguments], dtype=np.float64).reshape(c, 3),
        curves=_padded([argument[3] for argument in arguments], 3),
        damping=np.array([argument[4] for argument in arguments], dtype=np.float64),
        damping_depth=np.array([argument[5] for argument in arguments], dtype=np.float64),
        phase=np.array([contact.phase for contact in system.contacts], dtype=np.float64),
        rate=np.array([contact.rate for contact in system.contacts], dtype=np.float64),
        errors=errors,
        clearance=np.array([contact.clearance for contact in system.contacts], dtype=np.float64),
        entering=_padded(entering, 2),
        faces=_padded([argument[7] for argument in arguments], 4),
        face_depth=np.array([argument[8] for argument in arguments], dtype=np.float64),
        pairs=np.array([len(pairs) for pairs in entering], dtype=np.int64),
    )


def _padded(arrays: list[FloatArray], dimensions: int) -> FloatArray:
    """All of them in one, with zeros up to the longest of each axis."""
    shape = np.array([array.shape for array in arrays], dtype=np.int64).reshape(-1, dimensions).max(axis=0, initial=0)
    together = np.zeros((len(arrays), *shape))
    for one, array in zip(together, arrays, strict=True):
        one[tuple(slice(length) for length in array.shape)] = array
    return together
