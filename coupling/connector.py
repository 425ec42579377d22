"""Connectors between components: bearings, couplings and tooth contacts.

A connector is a matrix of directions D, shape (n, d), that turns the n coordinates of the whole system into
relative deflections δ = Dᵀ q, and a law that turns deflections, rates and phase into forces f. It adds -D f to the
equations of motion, so the two sides feel equal and opposite forces, whatever the law.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.bearing_law import BearingLaw
from coupling.errors import CouplingError
from coupling.gears import SlidingFriction, ToothContact

FloatArray = npt.NDArray[np.float64]

_JUST_AFTER = 1e-9  # mesh periods


@dataclass(frozen=True)
class LinearConnector:
    """A connector whose law is f = K δ + C δ': a bearing, a coupling, a mount.

    Attributes
    ----------
    name : str
    directions : ndarray, shape (n, d)
        D.
    stiffness : ndarray, shape (d, d)
        K [N/m], not necessarily symmetric.
    damping : ndarray, shape (d, d)
        C [N s/m].
    over_speed : SpeedTable, optional
        K and C at other speeds than the nominal one, where they depend on it.
    axes : tuple of int
        Of a bearing, the axis of each direction: x, y, z and the rotations about x and y (0 to 4); empty otherwise.
    """

    name: str
    directions: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    over_speed: "SpeedTable | None" = None
    axes: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        d = self.directions.shape[1]
        for what, matrix in (("stiffness", self.stiffness), ("damping", self.damping)):
            if matrix.shape != (d, d):
                raise CouplingError(f"{self.name}: {what} of shape {matrix.shape}; expected ({d}, {d})")


@dataclass(frozen=True)
class SpeedTable:
    """A linear law over speed, linear between t speeds and constant beyond them.

    Attributes
    ----------
    rates : ndarray, shape (t,)
        Speeds as parts of the nominal one, ascending.
    stiffness : ndarray, shape (t, d, d)
        K [N/m].
    damping : ndarray, shape (t, d, d)
        C [N s/m].
    """

    rates: FloatArray
    stiffness: FloatArray
    damping: FloatArray

    def at(self, rate: float) -> tuple[FloatArray, FloatArray]:
        """K and C at a speed."""
        after = min(max(int(np.searchsorted(self.rates, rate)), 1), len(self.rates) - 1)
        gap = self.rates[after] - self.rates[after - 1]
        part = min(max(float((rate - self.rates[after - 1]) / gap), 0.0), 1.0)
        first, second = (
            matrix[after - 1] + part * (matrix[after] - matrix[after - 1]) for matrix in (self.stiffness, self.damping)
        )
        return first, second


@dataclass(frozen=True)
class NonlinearConnector:
    """A connector with a nonlinear bearing law, in place of the linear law of its tangent.

    The linear connector of the same bearing stays among the system's, so that linear analyses see the tangent K about
    the bearing's mean load; this one adds f(δ) - K δ to it.

    Attributes
    ----------
    name : str
    directions : ndarray, shape (n, d)
        D.
    axes : ndarray of int, shape (d,)
        Axis of each direction: x, y, z and the rotations about x and y, 0 to 4.
    law : BearingLaw
    stiffness : ndarray, shape (d, d)
        K [N/m], symmetric.
    speed : float
        Signed speed of the shaft [rad/s], which carries the rolling elements round.
    """

    name: str
    directions: FloatArray
    axes: npt.NDArray[np.int64]
    law: BearingLaw
    stiffness: FloatArray
    speed: float

    def __post_init__(self) -> None:
        d = self.directions.shape[1]
        if self.axes.shape != (d,) or self.stiffness.shape != (d, d):
            raise CouplingError(
                f"{self.name}: {self.axes.shape} axes and a stiffness of shape {self.stiffness.shape}; "
                f"expected ({d},) and ({d}, {d})"
            )


@dataclass(frozen=True)
class Sliding:
    """Sliding of the flanks of a tooth contact, see :mod:`coupling.sliding`.

    Attributes
    ----------
    friction : SlidingFriction
    directions : ndarray, shape (n, 2)
        a and b: a pair at the position x along its path slides by (a + x b)ᵀ q' beside the nominal rotation.
    nominal : ndarray, shape (2,)
        W_a [m/s] and W_b [m/s per base pitch]: it slides by W_a + x W_b in the nominal rotation.
    """

    friction: SlidingFriction
    directions: FloatArray
    nominal: FloatArray


@dataclass(frozen=True)
class ContactConnector:
    """A connector whose law is a tooth contact: one line of action of a gear pair.

    With the mesh phase p(t) = phase + rate t and the runout error e(t) = Σ a cos(w t + c), the compression is
    δ = dᵀ q - e(t) - clearance and the force is :func:`coupling.gears.kernels.tooth_force`.

    Attributes
    ----------
    name : str
    direction : ndarray, shape (n,)
        d, the compression by each coordinate.
    contact : ToothContact
    phase : float
        At t = 0 [mesh periods].
    rate : float
        Mesh frequency [Hz]; negative for flanks met in the opposite order.
    errors : ndarray, shape (h, 3)
        a [m], w [rad/s] and c [rad] of each harmonic of the runout error.
    clearance : float
        Gap to close before the flanks touch [m]: 0 for the drive flanks, the backlash for the back flanks.
    drives : bool
        Whether these flanks carry the mean load.
    greatest_compression : float
        Largest compression that the teeth can follow [m]; a motion that exceeds it is refused.
    sliding : Sliding or None
        Friction, which adds μ Σ ± F_j (a + x_j b) to what the pairs' forces F_j do along d; None for none.
    """

    name: str
    direction: FloatArray
    contact: ToothContact
    phase: float
    rate: float
    errors: FloatArray
    clearance: float = 0.0
    drives: bool = True
    sliding: Sliding | None = None
    compression_limit: float = np.inf

    @property
    def friction_law(self) -> tuple[FloatArray, bool]:
        """Law table by which the pairs share friction, and whether it is by slices of the face."""
        shares = np.zeros(0) if self.sliding is None else self.sliding.friction.shares
        return (shares, True) if shares.size else (self.contact.kernel_arguments[0], False)

    def runout(self, time: float) -> float:
        """Runout error at a time [m]."""
        return float(np.sum(self.errors[:, 0] * np.cos(self.errors[:, 1] * time + self.errors[:, 2])))

    def phase_after(self, time: float) -> float:
        """Mesh phase just after a time [mesh periods]: a pair that enters contact then counts."""
        return self.phase + self.rate * time + _JUST_AFTER

    def event_times(self, start: float, end: float) -> FloatArray:
        """Times in (start, end) at which a pair enters or leaves its path of contact or a relief begins [s].

        The force may jump at the former; at the latter its rate and the power of the turning teeth do. With friction
        also those at which a pair passes the pitch point.
        """
        turns = () if self.sliding is None else self.sliding.friction.event_phases
        marks = np.unique([*self.contact.event_phases, *self.contact.corner_phases, *turns])
        if self.rate == 0.0 or not marks.size:
            return np.empty(0)
        first, last = sorted((self.phase + self.rate * start, self.phase + self.rate * end))
        whole = np.arange(np.floor(first) - 1.0, np.ceil(last) + 1.0)
        phases = (whole[:, None] + marks).ravel()
        times = np.sort((phases - self.phase) / self.rate)
        return np.asarray(times[(times > start) & (times < end)])
