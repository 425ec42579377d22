"""The coupled system: components side by side, tied by connectors, driven by loads."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from coupling.component import Component
from coupling.connector import ContactConnector, LinearConnector
from coupling.errors import CouplingError

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class HarmonicLoad:
    """A load F(t) = Re(amplitude e^{i w t}) on the coordinates: unbalance is one for each rotor.

    Attributes
    ----------
    frequency : float
        w [rad/s].
    amplitude : ndarray of complex, shape (n,)
    """

    frequency: float
    amplitude: ComplexArray


@dataclass(frozen=True)
class CoupledSystem:
    """All components, connectors and loads in one set of coordinates.

    The equation of motion is q'' + C q' + K q + Σ d f(δ, δ', t) = F + Σ Re(F_w e^{iwt}) with the tooth contacts
    in the sum, everything linear in C and K.

    Attributes
    ----------
    components : tuple of Component
        Their coordinates follow each other.
    speeds : tuple of float
        Signed speed of rotation of each component [rad/s]; 0 for the housing.
    linear : tuple of LinearConnector
    contacts : tuple of ContactConnector
    load : ndarray, shape (n,)
        F, constant; zero by default.
    harmonic_loads : tuple of HarmonicLoad
    """

    components: tuple[Component, ...]
    speeds: tuple[float, ...]
    linear: tuple[LinearConnector, ...] = ()
    contacts: tuple[ContactConnector, ...] = ()
    load: FloatArray = field(default_factory=lambda: np.zeros(0))
    harmonic_loads: tuple[HarmonicLoad, ...] = ()

    def __post_init__(self) -> None:
        if len(self.speeds) != len(self.components):
            raise CouplingError(f"{len(self.speeds)} speeds for {len(self.components)} components; expected as many")
        if self.load.shape == (0,):
            object.__setattr__(self, "load", np.zeros(self.size))
        if self.load.shape != (self.size,):
            raise CouplingError(f"a load of shape {self.load.shape}; expected ({self.size},)")

    @cached_property
    def size(self) -> int:
        """Number of coordinates, n."""
        return sum(component.size for component in self.components)

    @cached_property
    def kinds(self) -> tuple[str, ...]:
        """What each coordinate moves."""
        return tuple(kind for component in self.components for kind in component.kinds)

    @cached_property
    def resolved(self) -> npt.NDArray[np.bool_]:
        """Coordinates whose own vibration is to be followed in time, shape (n,): all but the residual ones.

        A residual coordinate answers as a spring does. The frequency that its stiffness and mass make is an artefact
        of the reduction, above every frequency that the component is good for.
        """
        return np.array([kind != "residual" for kind in self.kinds])

    @cached_property
    def stiffness(self) -> FloatArray:
        """K without the tooth contacts [1/s²], shape (n, n)."""
        total = self._blocks([component.stiffness for component in self.components])
        for connector in self.linear:
            total += connector.directions @ connector.stiffness @ connector.directions.T
        return total

    @cached_property
    def damping(self) -> FloatArray:
        """C with the gyroscopic terms and without the tooth contacts [1/s], shape (n, n)."""
        pairs = zip(self.components, self.speeds, strict=True)
        total = self._blocks([component.damping + speed * component.gyroscopic for component, speed in pairs])
        for connector in self.linear:
            total += connector.directions @ connector.damping @ connector.directions.T
        return total

    @cached_property
    def contact_directions(self) -> FloatArray:
        """Directions of the tooth contacts, shape (n, n_contacts)."""
        return np.array([contact.direction for contact in self.contacts]).reshape(-1, self.size).T

    def mean_stiffness(self) -> FloatArray:
        """K with every drive flank at its mean mesh stiffness [1/s²], shape (n, n)."""
        return self.stiffness + self._contact_sum([c.contact.mean_stiffness for c in self.contacts])

    def mean_damping(self) -> FloatArray:
        """C with every drive flank's damping [1/s], shape (n, n)."""
        return self.damping + self._contact_sum([c.contact.damping for c in self.contacts])

    def _contact_sum(self, values: Sequence[float]) -> FloatArray:
        """Σ value d dᵀ over the flanks that drive."""
        touching = np.array([v * c.drives for v, c in zip(values, self.contacts, strict=True)])
        return np.asarray((self.contact_directions * touching) @ self.contact_directions.T)

    def _blocks(self, matrices: Sequence[FloatArray]) -> FloatArray:
        total = np.zeros((self.size, self.size))
        start = 0
        for matrix in matrices:
            end = start + len(matrix)
            total[start:end, start:end] = matrix
            start = end
        return total


def embed(components: Sequence[Component], which: int, direction: FloatArray) -> FloatArray:
    """A component's direction as one of the whole system, shape (n,)."""
    row = np.zeros(sum(component.size for component in components))
    start = sum(component.size for component in components[:which])
    row[start : start + components[which].size] = direction
    return row
