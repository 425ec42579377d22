"""Errors of the package, and the checks of arguments that raise them."""

import numbers

from gearwhine.numerics.findings import FINITE, RefusedPartError, WorkFailedError


class RotorError(RefusedPartError):
    """An invalid shaft, disc, bearing or request: the message names it, its value and the expected value."""


class IncompleteModesError(WorkFailedError):
    """The modes found do not agree with the root count, or a mode fails its energy check."""


class EquilibriumError(WorkFailedError):
    """A rolling bearing's equilibrium fails its proof or exceeds its theory; the message says why and what helps."""


def require(condition: bool, label: str, value: object, expected: str) -> None:
    """Raise `RotorError` naming ``label``, its ``value`` and what was ``expected`` unless ``condition``."""
    if not condition:
        raise RotorError(f"{label} is {value!r}; expected {expected}")


def require_count(label: str, value: int | None) -> None:
    """Raise `RotorError` unless ``value`` is None or a positive whole number."""
    whole = value is None or (isinstance(value, numbers.Integral) and value > 0)
    require(whole, label, value, "a positive whole number")


def require_finite(label: str, value: float, *, positive: bool = False, minimum: float | None = None) -> None:
    """Raise `RotorError` unless ``value`` is finite and, as asked, positive or not below ``minimum``."""
    if not FINITE.accepts(value):
        require(False, label, value, FINITE.expected)
    if positive:
        require(value > 0.0, label, value, "a positive number")
    if minimum is not None:
        require(value >= minimum, label, value, f"a number not below {minimum:g}")
