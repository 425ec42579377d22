"""Loads of a rotor: unbalance, residual bow, harmonic forces."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Number, attribute_findings, refuse
from gearwhine.rotors.errors import RotorError, require, require_finite


@dataclass(frozen=True)
class Unbalance:
    """An unbalance: a mass off the axis of rotation.

    Parameters
    ----------
    at : float
        Position from the rotor's left end [m].
    moment : float
        Mass times eccentricity [kg·m].
    phase : float
        Angle of the unbalance on the rotor from x, counter-clockwise seen from +z [rad].
    """

    at: float
    moment: float
    phase: float = 0.0

    def __post_init__(self) -> None:
        """Check that position, moment and phase are finite, and none of the first two negative."""
        at, moment = Number(at_least=0.0, unit="m"), Number(at_least=0.0, unit="kg·m")
        rules = {"at": at, "moment": moment, "phase": Number(unit="rad")}
        refuse(attribute_findings(("unbalance", ""), self, **rules), RotorError)

    @property
    def vector(self) -> complex:
        """Moment times e^{i phase}."""
        return complex(self.moment * np.exp(1j * self.phase))


@dataclass(frozen=True)
class HarmonicForce:
    """A force and moment Re[F e^{iωt}] at a place.

    Parameters
    ----------
    at : float
        Position from the rotor's left end [m].
    x, y : complex
        Complex amplitudes of the force [N].
    slope_x, slope_y : complex
        Complex amplitudes of the moments that turn the section in the plane of x and of y [N·m]: about y, and about −x.
    """

    at: float
    x: complex = 0.0
    y: complex = 0.0
    slope_x: complex = 0.0
    slope_y: complex = 0.0

    def __post_init__(self) -> None:
        """Check that position, forces and moments are finite."""
        require_finite("force position", self.at, minimum=0.0)
        for attribute in ("x", "y", "slope_x", "slope_y"):
            value = complex(getattr(self, attribute))
            require(bool(np.isfinite(value)), f"force {attribute}", value, "a finite complex number")

    @property
    def circular(self) -> tuple[complex, complex, complex, complex, complex]:
        """Loads over r+, β+, r−, β− and z."""
        root = np.sqrt(0.5)
        x, y, bx, by = self.x, self.y, self.slope_x, self.slope_y
        return (
            complex(root * (x + 1j * y)),
            complex(root * (bx + 1j * by)),
            complex(root * (x - 1j * y)),
            complex(root * (bx - 1j * by)),
            0j,
        )


@dataclass(frozen=True, eq=False)
class Bow:
    """Residual bow: the shape of the unloaded shaft, measured at some places.

    Parameters
    ----------
    at : ndarray, shape (k,)
        Positions from the rotor's left end [m].
    offset : ndarray, shape (k,)
        Distances of the centre line from the axis of rotation [m].
    phase : ndarray, shape (k,) or None
        Angles of the offsets on the rotor from x, counter-clockwise seen from +z [rad]; zero if not given.
    """

    at: FloatArray
    offset: FloatArray
    phase: FloatArray | None = None

    def __post_init__(self) -> None:
        """Check that every point has a place of its own and finite values; freeze the arrays."""
        at, offset = np.array(self.at, dtype=np.float64), np.array(self.offset, dtype=np.float64)
        phase = np.zeros_like(offset) if self.phase is None else np.array(self.phase, dtype=np.float64)
        fits = at.ndim == 1 and at.size > 0 and at.shape == offset.shape == phase.shape
        require(fits, "bow shapes", (at.shape, offset.shape, phase.shape), "one position, offset and phase per point")
        finite = bool(np.isfinite(np.concatenate([at, offset, phase])).all())
        require(finite, "bow", (at.tolist(), offset.tolist(), phase.tolist()), "finite numbers")
        apart = np.unique(at).size == at.size
        require(apart, "bow positions", at.tolist(), "each place once")
        for attribute, value in (("at", at), ("offset", offset), ("phase", phase)):
            value.setflags(write=False)
            object.__setattr__(self, attribute, value)

    @property
    def vectors(self) -> npt.NDArray[np.complex128]:
        """Offsets times e^{i phase}, (k,)."""
        assert self.phase is not None
        return np.asarray(self.offset * np.exp(1j * self.phase))
