"""Errors of the coupled machine and its analyses."""

from gearwhine.numerics.findings import RefusedPartError, WorkFailedError


class CouplingError(RefusedPartError):
    """The components, connectors or loads do not fit each other; the message says what was expected."""


class AcousticsError(CouplingError):
    """Acoustics that do not fit each other, their method or the housing; the message says what was expected."""


class DeflectionError(CouplingError):
    """A motion beyond the deflection that the parts can follow: teeth compressed too far."""


class TransientError(WorkFailedError):
    """A time integration that diverged, stalled, or whose energies do not balance."""


class ModesError(WorkFailedError):
    """Coupled modes, or a response made of them, that fail their own proof."""


class PeriodicError(WorkFailedError):
    """A periodic motion that was not found, or fails its proof; the message says what to try."""


class EquilibriumNotFoundError(WorkFailedError):
    """A static equilibrium of the machine that was not found, or whose forces do not balance."""
