"""Connectors between components: linear bearings (5x5 stiffness), nonlinear bearings, tooth contacts.

A connector is a matrix of directions D, shape (n, d), that turns the n coordinates of the whole system into
relative deflections δ = Dᵀ q, and a law that turns deflections, velocities and phase into forces f. It adds -D f to the
equations of motion, so the two sides feel equal and opposite forces, whatever the law.

The law of a linear bearing is its stiffness and damping matrix, at most 5x5 over x, y, z and the rotations about x and
y; nonlinear laws of bearings are those of :mod:`gearwhine.coupling.machine.bearing_laws`, that of teeth is
:class:`gearwhine.coupling.gears.ToothContact`.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears.contact.sliding_friction import SlidingFriction
from gearwhine.coupling.machine.bearing_laws import BearingLaw
from gearwhine.numerics.arrays import ComplexArray, FloatArray, IntArray

_JUST_AFTER = 1e-9  # mesh periods


@dataclass(frozen=True)
class TurningPart:
    """Part of a connector's directions that turns against the coordinates of a component.

    A connector between parts of different frames, such as the mesh of a planet whose axis turns with a carrier and a
    sun whose coordinates stand still, has directions D(s) = D(0) + Σ (A (cos w s - 1) + B sin w s) by the nominal time
    s; its ``directions`` are those at s = 0, A is part of them.

    Attributes
    ----------
    rate : float
        w, the speed of the connector's frame over the component's [rad/s].
    cosine, sine : ndarray, shape (n, d)
        A and B.
    """

    rate: float
    cosine: FloatArray
    sine: FloatArray

    def change(self, time: float) -> FloatArray:
        """Change of the directions from s = 0 to a nominal time [s], shape (n, d)."""
        angle = self.rate * time
        return np.asarray(self.cosine * (np.cos(angle) - 1.0) + self.sine * np.sin(angle))

    def projected(self, recovery: FloatArray) -> "TurningPart":
        """Return the part over other coordinates x, of which q = T x; T has the shape (n, m)."""
        return replace(self, cosine=recovery.T @ self.cosine, sine=recovery.T @ self.sine)


def turned(directions: FloatArray, parts: Iterable[TurningPart], time: float) -> FloatArray:
    """Directions (n, d) at a nominal time [s], of those at the nominal time 0 and their turning parts."""
    return np.asarray(sum((part.change(time) for part in parts), directions))


_Turning = TypeVar("_Turning", "LinearConnector", "NonlinearConnector", "Sliding")


def standing(connector: _Turning, time: float) -> _Turning:
    """Return a connector, or the sliding of one, whose directions stand as they do at a nominal time [s]."""
    if not connector.turning:
        return connector
    return replace(connector, directions=turned(connector.directions, connector.turning, time), turning=())


@dataclass(frozen=True)
class LinearConnector:
    """A connector whose law is f = f₀ + K δ + C δ': a bearing, a shaft coupling, a torque over speed, condensed parts.

    Attributes
    ----------
    name : str
    directions : ndarray, shape (n, d)
        D.
    stiffness : ndarray, shape (d, d)
        K, not necessarily symmetric: N/m among displacements, N/rad and N m/m between these and rotations, N m/rad.
    damping : ndarray, shape (d, d)
        C, in the units of K times s.
    over_speed : SpeedTable, optional
        K and C at other speeds than the nominal one, where they depend on it.
    axes : tuple of int
        Axis of each direction of a bearing: x, y, z and the rotations about x and y (0 to 4); empty otherwise.
    offset : ndarray, shape (d,), or None
        Force f₀ of a law that is linearised about a deflection [N]; the system's constant loads contain -D f₀.
    of_contact : int or None
        Number of the tooth contact whose flanks resist tilting by this connector
        (:mod:`gearwhine.coupling.machine.mesh_face`).
    turning : tuple of TurningPart
        Parts of the directions that turn; ``directions`` are those at the nominal time 0.
    """

    name: str
    directions: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    over_speed: "SpeedTable | None" = None
    axes: tuple[int, ...] = ()
    offset: FloatArray | None = None
    of_contact: int | None = None
    turning: tuple[TurningPart, ...] = ()

    def __post_init__(self) -> None:
        """Require stiffness and damping of shape (d, d) for d directions."""
        d = self.directions.shape[1]
        for label, matrix in (("stiffness", self.stiffness), ("damping", self.damping)):
            if matrix.shape != (d, d):
                raise CouplingError(f"{self.name}: {label} of shape {matrix.shape}; expected ({d}, {d})")


@dataclass(frozen=True)
class SpeedTable:
    """A linear law over speed, linear between t speeds and constant beyond them.

    Attributes
    ----------
    speed_ratios : ndarray, shape (t,)
        Speeds as parts of the nominal one, ascending.
    stiffness : ndarray, shape (t, d, d)
        K [N/m].
    damping : ndarray, shape (t, d, d)
        C [N s/m].
    """

    speed_ratios: FloatArray
    stiffness: FloatArray
    damping: FloatArray

    def at(self, speed_ratio: float) -> tuple[FloatArray, FloatArray]:
        """K and C at a part of the nominal speed."""
        ratios = self.speed_ratios
        after = min(max(int(np.searchsorted(ratios, speed_ratio)), 1), len(ratios) - 1)
        gap = ratios[after] - ratios[after - 1]
        part = min(max(float((speed_ratio - ratios[after - 1]) / gap), 0.0), 1.0)
        first, second = (
            matrix[after - 1] + part * (matrix[after] - matrix[after - 1]) for matrix in (self.stiffness, self.damping)
        )
        return first, second


@dataclass(frozen=True)
class NonlinearConnector:
    """A connector with a nonlinear bearing law, in place of the linear law of its tangent.

    The linear connector of the same bearing stays in the system, so that linear analyses have the tangent K about
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
        Signed speed of the shaft against what holds the other ring [rad/s], which carries the rolling elements round.
    turning : tuple of TurningPart
        Parts of the directions that turn; ``directions`` are those at the nominal time 0.
    holder_speed : float
        Signed speed of what holds the other ring, as of a hollow shaft, against the directions [rad/s]: it carries
        the rolling elements round, too.
    """

    name: str
    directions: FloatArray
    axes: npt.NDArray[np.int64]
    law: BearingLaw
    stiffness: FloatArray
    speed: float
    turning: tuple[TurningPart, ...] = ()
    holder_speed: float = 0.0

    def __post_init__(self) -> None:
        """Require an axis for each direction, and a stiffness of shape (d, d)."""
        d = self.directions.shape[1]
        if self.axes.shape != (d,) or self.stiffness.shape != (d, d):
            raise CouplingError(
                f"{self.name}: {self.axes.shape} axes and a stiffness of shape {self.stiffness.shape}; "
                f"expected ({d},) and ({d}, {d})"
            )


@dataclass(frozen=True)
class Sliding:
    """Sliding of the flanks of a tooth contact, see :mod:`gearwhine.coupling.machine.tooth_friction`.

    Attributes
    ----------
    friction : SlidingFriction
    directions : ndarray, shape (n, 2)
        Directions a and b: a pair at the position x along its path slides by (a + x b)ᵀ q' beside the nominal rotation.
    nominal : ndarray, shape (2,)
        Rates W_a [m/s] and W_b [m/s per base pitch]: a pair slides by W_a + x W_b in the nominal rotation.
    turning : tuple of TurningPart
        Parts of the directions that turn; ``directions`` are those at the nominal time 0.
    """

    friction: SlidingFriction
    directions: FloatArray
    nominal: FloatArray
    turning: tuple[TurningPart, ...] = ()


@dataclass(frozen=True)
class ContactConnector:
    """A connector whose law is a tooth contact: one line of action of a gear pair.

    Backlash is two one-sided contacts: a gear pair has one such connector for its drive flanks and, where it has a
    backlash, one for its back flanks with the backlash as ``clearance``.

    With the mesh phase p(t) = phase + f t at a mesh frequency f and the runout error e(t) = Σ a cos(w t + c), the
    compression is δ = dᵀ q - e(t) - clearance and the force is
    :func:`gearwhine.coupling.gears.contact.tooth_force_kernels.tooth_force`.

    Attributes
    ----------
    name : str
    direction : ndarray, shape (n,)
        Compression d by each coordinate.
    contact : ToothContact
    phase : float
        Mesh phase at t = 0 [mesh periods].
    mesh_frequency : float
        f [Hz]; negative for flanks met in the opposite order.
    errors : ndarray, shape (h, 3)
        a [m], w [rad/s] and c [rad] of each harmonic of the runout error.
    clearance : float
        Compression dᵀ q at which even flanks touch [m]: the backlash, for the back flanks, 0 for the drive flanks. For
        flanks that carry the mean load it includes what their mean tilt adds to the compression at the stiffness
        centre, where d is taken (:mod:`gearwhine.coupling.machine.mesh_face`).
    loaded : bool
        Whether these flanks carry the mean load.
    compression_limit : float
        Largest compression that the teeth can follow [m]; a motion that exceeds it is refused.
    sliding : Sliding or None
        Friction of the flanks; None without. To the generalised force d Σ F_j of the pairs j with forces F_j it adds
        μ Σ ± F_j (a + x_j b), x_j their positions along the path of contact.
    turning : tuple of TurningPart
        Parts of the direction that turn, of shape (n, 1); ``direction`` is that at the nominal time 0.
    """

    name: str
    direction: FloatArray
    contact: ToothContact
    phase: float
    mesh_frequency: float
    errors: FloatArray
    clearance: float = 0.0
    loaded: bool = True
    sliding: Sliding | None = None
    compression_limit: float = np.inf
    turning: tuple[TurningPart, ...] = ()

    @property
    def friction_law(self) -> tuple[FloatArray, bool]:
        """Law table by which the pairs share friction, and whether it is by slices of the face."""
        shares = np.zeros(0) if self.sliding is None else self.sliding.friction.shares
        return (shares, True) if shares.size else (self.contact.kernel_arguments[0], False)

    def with_law(self, law: ToothContact) -> "ContactConnector":
        """Return the contact with another law of its flanks, which their friction follows."""
        sliding = None if self.sliding is None else replace(self.sliding, friction=self.sliding.friction.under(law))
        return replace(self, contact=law, sliding=sliding)

    def direction_at(self, time: float) -> FloatArray:
        """Compression by each coordinate at a nominal time [s], shape (n,)."""
        return turned(self.direction[:, None], self.turning, time)[:, 0] if self.turning else self.direction

    def standing(self, time: float) -> "ContactConnector":
        """Return the contact whose directions stand as they do at a nominal time [s]."""
        sliding = None if self.sliding is None else standing(self.sliding, time)
        return replace(self, direction=self.direction_at(time), turning=(), sliding=sliding)

    def at_time_zero(self, phasors: ComplexArray, order: float | IntArray | FloatArray) -> ComplexArray:
        """Return phasors of orders of the mesh by its phase as those at t = 0, by e^{iωt} with ω > 0."""
        sense = np.sign(self.mesh_frequency)
        shifted = np.exp(2j * np.pi * sense * order * self.phase)
        return np.asarray((phasors.conj() if sense < 0.0 else phasors) * shifted)

    def runout(self, time: float) -> float:
        """Runout error at a time [m]."""
        return float(np.sum(self.errors[:, 0] * np.cos(self.errors[:, 1] * time + self.errors[:, 2])))

    def phase_after(self, time: float) -> float:
        """Mesh phase just after a time [mesh periods]: a pair that enters contact then counts."""
        return self.phase + self.mesh_frequency * time + _JUST_AFTER

    def event_times(self, start: float, end: float) -> FloatArray:
        """Return times in (start, end) at which a pair enters or leaves its path of contact or a relief begins [s].

        The force may jump where a pair enters or leaves; where a relief begins, its slope and the power of the rotating
        teeth jump. With friction the times at which a pair passes the pitch point are included.
        """
        turns = () if self.sliding is None else self.sliding.friction.event_phases
        marks = np.unique([*self.contact.event_phases, *self.contact.corner_phases, *turns])
        if self.mesh_frequency == 0.0 or not marks.size:
            return np.empty(0)
        first, last = sorted((self.phase + self.mesh_frequency * start, self.phase + self.mesh_frequency * end))
        whole = np.arange(np.floor(first) - 1.0, np.ceil(last) + 1.0)
        phases = (whole[:, None] + marks).ravel()
        times = np.sort((phases - self.phase) / self.mesh_frequency)
        return np.asarray(times[(times > start) & (times < end)])
