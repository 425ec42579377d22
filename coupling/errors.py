"""What can go wrong between the components and the coupled answer."""


class CouplingError(ValueError):
    """The components, connectors or loads do not fit each other; the message says what was expected."""


class DeflectionError(CouplingError):
    """A motion beyond what the parts can follow: teeth pressed in by more than they can be."""


class TransientError(RuntimeError):
    """A time integration that cannot be trusted: it diverged, stalled, or its energies do not balance."""


class ModesError(RuntimeError):
    """Coupled modes, or a response made of them, that fail their own proof."""


class PeriodicError(RuntimeError):
    """A periodic motion that was not found, or cannot be trusted; the message says what to try."""
