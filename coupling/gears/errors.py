"""Errors of gears: one exception for each way in which a gear, a gear pair or a contact cannot be built."""

import math

from gearwhine.numerics.findings import FINITE, RefusedPartError, WorkFailedError


class GearError(RefusedPartError):
    """An input that no gear, gear pair or contact law can be built from."""


class UndercutError(GearError):
    """Undercut: the tool cuts away the foot of the involute."""


class PointedToothError(GearError):
    """Pointed teeth: the two flanks meet below the tip circle."""


class ThinTipError(PointedToothError):
    """The teeth are thinner at the tip than the required least thickness."""


class InterferenceError(GearError):
    """Interference: a tip cuts into the mating root, or the teeth jam in each other's spaces."""


class NoContactError(GearError):
    """The contact ratio is below one: between two pairs of teeth nothing touches."""


class MismatchedGearsError(GearError):
    """Two gears of different module, pressure angle or helix angle, or of the same hand, cannot mesh."""


class StiffnessModelError(GearError):
    """A stiffness model is unknown, or used outside its range."""


class ContactAccuracyError(WorkFailedError):
    """A table or an equilibrium fails its own accuracy check."""


def require_finite(label: str, value: float, *, minimum: float = -math.inf, strict: bool = False) -> None:
    """Raise `GearError` unless `value` is a finite number above `minimum`."""
    if not FINITE.accepts(value):
        raise GearError(f"{label} must be a finite number, got {value!r}")
    if value < minimum or (strict and value == minimum):
        raise GearError(f"{label} must be {'above' if strict else 'at least'} {minimum:g}, got {value!r}")
