"""Errors of the housing's model, its modes and its measured data."""

from gearwhine.numerics.findings import RefusedPartError, WorkFailedError


class HousingError(RefusedPartError):
    """The housing's description does not fit its mesh; the message says what was expected."""


class TriangleSizeError(HousingError):
    """The triangles of a radiating surface are too large or too many; the message says what edge to take."""


class IncompleteModesError(WorkFailedError):
    """The modes found are incomplete or not accurate enough: an incomplete set is never returned."""


class FactorizationError(WorkFailedError):
    """A matrix could not be factored, or its factor does not solve; the message says what to try."""


class ReductionError(WorkFailedError):
    """A reduced housing fails its own proof; the message gives the error and what to try."""


class HealthError(WorkFailedError):
    """The housing's model contradicts its geometry or itself; the message names every check that failed."""


class ModeFileError(HousingError):
    """A mode-set file cannot be used: missing, damaged, of another kind or another version."""


class MeasuredDataError(HousingError):
    """A file of measured data cannot be used, or does not belong to the model; the message says what was expected."""


class RendererUnavailableError(WorkFailedError):
    """No library that draws without a screen is installed, or it fails; the message says what to do."""


class EncoderUnavailableError(WorkFailedError):
    """No program that encodes films is installed, or it fails; the message says what to do."""
