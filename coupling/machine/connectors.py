r"""Connectors between components: bearings (5x5 stiffness), nonlinear bearing laws, shaft couplings, tooth contacts.

A connector is a matrix of directions D, shape (n, d), that turns the n coordinates of the whole system into
relative deflections δ = Dᵀ q, and a law that turns deflections, velocities and phase into forces f. It adds -D f to the
equations of motion, so the two sides feel equal and opposite forces, whatever the law.

The law of a linear bearing is its stiffness and damping matrix, at most 5x5 over x, y, z and the rotations about x and
y. Nonlinear bearing laws are rolling elements with clearance, and gaps that close: such a law turns the deflections δ
of the shaft against its seat (x, y, z and the rotations about x and y) into the forces of the shaft on the seat;
:mod:`coupling.connector_forces.bearing_kernels` is its compiled form.

`MountedBearing`, `MountedGear` and `GearMesh` give bearings and gears their places in the machine.

Dashpots of flexible shaft couplings are internal damping, which rotates with the shaft. A coupling of length L yields
by the sway of its right end over its left one, δ = u_r - u_l - L (φ_l + φ_r)/2 across the axis, by the tilt φ_r - φ_l,
and along and about the axis by the differences of its ends. Dashpots resist their velocities in the rotating shaft.
Across the axis that is, in the frame at rest and at a speed Ω,

    f = c (δ' + Ω (δ_y, -δ_x)),

damping and a circulatory stiffness: internal damping, which feeds forward whirl above its natural frequency (Genta,
Dynamics of Rotating Systems, 2005, section 4.4).
"""

import math
from dataclasses import dataclass, field
from math import atan2

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError
from coupling.gears import GearPairGeometry, ToothContact
from coupling.gears.contact.sliding_friction import SlidingFriction
from coupling.gears.geometry.pair import pair_label
from coupling.machine.components import RotorComponent
from coupling.machine.mesh_kinematics import LineOfAction, line_of_action
from rotors import Bearing
from rotors.rolling_bearings import FourPointRow, RollerRow, RollingBearing, RollingState

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RollingLaw:
    """Hertzian force of every rolling element, with the clearance, as the cage carries the elements round.

    The elements have no inertia. The compliance of the bearing depends on the cage angle, so it varies with the
    element-passing frequency.

    Attributes
    ----------
    state : RollingState
        The bearing at its mean load: start of the search for equilibrium, and position of the ring along directions
        in which the shaft cannot move.
    cage_angle : float
        Azimuth of the first element of every row at t = 0 [rad].

    Raises
    ------
    CouplingError
        Balls in four-point contact, or cylindrical rollers with flanges, which have no law in the time domain.
    """

    state: RollingState
    cage_angle: float = 0.0

    def __post_init__(self) -> None:
        """Require rows whose elements have a law in the time domain."""
        for row in self.state.bearing.rows:
            flanged = isinstance(row, RollerRow) and row.flanges != "none"
            if flanged or isinstance(row, FourPointRow):
                kind = "cylindrical rollers between flanges" if flanged else "balls in four-point contact"
                raise CouplingError(
                    f"{self.state.bearing.name} has {kind}; expected other elements where a law follows each of them: "
                    'linearise it, law = "linear" of a case'
                )

    @property
    def reference(self) -> FloatArray:
        """Displacement at the mean load [m, rad], shape (5,)."""
        return self.state.displacement

    @property
    def floats(self) -> bool:
        """Whether the outer ring slides in its seat along z, without axial force."""
        return self.state.bearing.floating


@dataclass(frozen=True)
class GapLaw:
    """Radial gap law of a ring around the shaft: beyond the gap the force is F (penetration / depth)^n.

    :mod:`coupling.connector_forces.bearing_kernels` has its compiled form.

    Attributes
    ----------
    force : float
        Force F at a penetration of ``depth`` [N].
    depth : float
        Penetration beyond the gap at which the force is F [m].
    exponent : float
        Exponent n, at least 1.
    gap : float
        Radial gap [m]; 0 for a spring of this law without a gap.
    """

    force: float
    depth: float
    exponent: float = 1.0
    gap: float = 0.0

    def __post_init__(self) -> None:
        """Require a positive force and depth, an exponent of 1 or more and no negative gap."""
        for attribute in ("force", "depth"):
            value = getattr(self, attribute)
            if not (math.isfinite(value) and value > 0.0):
                raise CouplingError(f"{attribute} of a gap's law of {value!r}; expected a positive number")
        if not (math.isfinite(self.exponent) and self.exponent >= 1.0):
            raise CouplingError(f"exponent of a gap's law of {self.exponent!r}; expected 1 or more")
        if not (math.isfinite(self.gap) and self.gap >= 0.0):
            raise CouplingError(f"gap of {self.gap!r} m; expected 0 or more")

    @property
    def reference(self) -> FloatArray:
        """Displacement at which the search for equilibrium begins: the centre, shape (5,)."""
        return np.zeros(5)

    def at(self, place: npt.ArrayLike) -> tuple[float, FloatArray, FloatArray]:
        """Energy [J], force of the shaft on the ring (2,) [N] and tangent (2, 2) [N/m] at a radial place (2,) [m]."""
        position = np.asarray(place, dtype=np.float64)
        radius = float(np.hypot(*position))
        beyond = radius - self.gap
        if beyond <= 0.0:
            return 0.0, np.zeros(2), self.tangent(np.zeros(2))
        size, away = self.force * (beyond / self.depth) ** self.exponent, position / radius
        return size * beyond / (self.exponent + 1.0), size * away, self._loaded_tangent(size, beyond, away)

    def tangent(self, load: npt.ArrayLike) -> FloatArray:
        """Tangent stiffness over x, y [N/m] under a radial load (2,) [N].

        Without a load it is the tangent within the gap: zero, except for a linear spring without a gap.
        """
        push = np.asarray(load, dtype=np.float64)
        size = float(np.hypot(*push))
        if size == 0.0:
            return np.zeros((2, 2)) if self.gap > 0.0 or self.exponent > 1.0 else self.force / self.depth * np.eye(2)
        beyond = self.depth * (size / self.force) ** (1.0 / self.exponent)
        return self._loaded_tangent(size, beyond, push / size)

    def _loaded_tangent(self, size: float, beyond: float, away: FloatArray) -> FloatArray:
        """Tangent at a force F of this size: with r the radial place, n F / (r - gap) along it and F / r across it.

        ``beyond`` is r - gap, ``away`` the unit vector of the place.
        """
        along = np.outer(away, away)
        across = size / (self.gap + beyond)
        return np.asarray(self.exponent * size / beyond * along + across * (np.eye(2) - along))


BearingLaw = RollingLaw | GapLaw


@dataclass(frozen=True)
class MountedBearing:
    """A bearing between a rotor and a seat of the housing; where ``seat`` is None, its pedestal or the ground.

    With a ``law``, motion follows it in place of the bearing's stiffness, which linear analyses use. With
    ``rolling``, the machine's static equilibrium is that of the bearing's elements; a ``bearing`` without stiffness
    gets its stiffness from there.

    Attributes
    ----------
    bearing : rotors.Bearing
    rotor : str
    seat : str or None
        None for the ground.
    law : BearingLaw or None
    rolling : RollingBearing or None
    offset : ndarray, shape (5,), or None
        Force of the linear law at zero deflection [N, N m]: force at the operating point less K times the deflection.
    """

    bearing: Bearing
    rotor: str
    seat: str | None
    law: BearingLaw | None = None
    rolling: RollingBearing | None = None
    offset: FloatArray | None = field(default=None, compare=False)

    @classmethod
    def from_elements(
        cls, name: str, at: float, rotor: str, seat: str | None, rolling: RollingBearing, *, damping: float = 0.0
    ) -> "MountedBearing":
        """Mount a rolling bearing whose stiffness follows from its load at the machine's operating point.

        Parameters
        ----------
        name : str
        at : float
            Distance from the rotor's left end [m].
        rotor : str
        seat : str or None
            None for the ground.
        rolling : RollingBearing
            Such as that of :func:`rotors.rolling_bearings.catalogue_bearing`.
        damping : float
            Along x and y [N s/m].

        Raises
        ------
        rotors.RotorError
            For a place or a damping that no bearing has.
        """
        return cls(
            Bearing(name, at, np.zeros((5, 5)), np.diag([damping, damping, 0.0, 0.0, 0.0])),
            rotor,
            seat,
            rolling=rolling,
        )

    @property
    def elements(self) -> RollingBearing | None:
        """The rolling bearing by its elements; None for a bearing that is described by its stiffness."""
        if self.rolling is None and isinstance(self.law, RollingLaw):
            return self.law.state.bearing
        return self.rolling

    @property
    def needs_load(self) -> bool:
        """Whether the stiffness is still to follow from the load at the operating point."""
        return self.elements is not None and not np.any(self.bearing.stiffness)


@dataclass(frozen=True)
class MountedGear:
    """Place of a gear: its rotor, its middle from the rotor's left end, and the axis in the x-y plane [m]."""

    name: str
    rotor: str
    at: float
    axis: tuple[float, float]


@dataclass(frozen=True)
class GearMesh:
    """A driver and a driven gear with the law of their contact.

    Attributes
    ----------
    driver, driven : MountedGear
    geometry : GearPairGeometry
    contact : ToothContact
    backlash : float, optional
        Gap between the back flanks along their line of action [m]; None where they can never meet.
    friction : float
        Coefficient of friction between the teeth, from 0 to 0.5.
    """

    driver: MountedGear
    driven: MountedGear
    geometry: GearPairGeometry
    contact: ToothContact
    backlash: float | None = None
    friction: float = 0.0

    @property
    def name(self) -> str:
        """Names of both gears."""
        return f"{self.driver.name} -> {self.driven.name}"

    @property
    def centre_line_angle(self) -> float:
        """Angle from x of the line from the driver's centre to the driven gear's [rad]."""
        x, y = self._centre_line
        return atan2(y, x)

    @property
    def _centre_line(self) -> tuple[float, float]:
        return self.driven.axis[0] - self.driver.axis[0], self.driven.axis[1] - self.driver.axis[1]

    def line_of_action(self, sense: int) -> LineOfAction:
        """Line of action of the flanks that the driver closes by a rotation of this sense, 1 or -1."""
        return line_of_action(self.geometry, self._centre_line, sense)

    @property
    def stations(self) -> tuple[float, float]:
        """Where the mesh force acts on both rotors: the middle of the common face from their left ends [m]."""
        driver, driven = self.geometry.common_middles
        return self.driver.at + driver, self.driven.at + driven

    @property
    def label(self) -> str:
        """The pair's name in messages."""
        return pair_label(self.driver.name, self.driven.name)


_JUST_AFTER = 1e-9  # mesh periods


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
    """

    name: str
    directions: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    over_speed: "SpeedTable | None" = None
    axes: tuple[int, ...] = ()
    offset: FloatArray | None = None

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
        Signed speed of the shaft [rad/s], which carries the rolling elements round.
    """

    name: str
    directions: FloatArray
    axes: npt.NDArray[np.int64]
    law: BearingLaw
    stiffness: FloatArray
    speed: float

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
    """Sliding of the flanks of a tooth contact, see :mod:`coupling.machine.tooth_friction`.

    Attributes
    ----------
    friction : SlidingFriction
    directions : ndarray, shape (n, 2)
        Directions a and b: a pair at the position x along its path slides by (a + x b)ᵀ q' beside the nominal rotation.
    nominal : ndarray, shape (2,)
        Rates W_a [m/s] and W_b [m/s per base pitch]: a pair slides by W_a + x W_b in the nominal rotation.
    """

    friction: SlidingFriction
    directions: FloatArray
    nominal: FloatArray


@dataclass(frozen=True)
class ContactConnector:
    """A connector whose law is a tooth contact: one line of action of a gear pair.

    Backlash is two one-sided contacts: a gear pair has one such connector for its drive flanks and, where it has a
    backlash, one for its back flanks with the backlash as ``clearance``.

    With the mesh phase p(t) = phase + f t at a mesh frequency f and the runout error e(t) = Σ a cos(w t + c), the
    compression is δ = dᵀ q - e(t) - clearance and the force is
    :func:`coupling.gears.contact.tooth_force_kernels.tooth_force`.

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
        Backlash, for the back flanks; 0 for the drive flanks [m].
    loaded : bool
        Whether these flanks carry the mean load.
    compression_limit : float
        Largest compression that the teeth can follow [m]; a motion that exceeds it is refused.
    sliding : Sliding or None
        Friction of the flanks; None without. To the generalised force d Σ F_j of the pairs j with forces F_j it adds
        μ Σ ± F_j (a + x_j b), x_j their positions along the path of contact.
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


@dataclass(frozen=True)
class ShaftDashpots:
    """Dashpots of a flexible coupling in a rotor.

    Attributes
    ----------
    name, rotor : str
    left, right : float
        Ends of the coupling, from the rotor's left end [m].
    lateral, axial : float
        Damping coefficients [N s/m].
    tilt, torsional : float
        Damping coefficients [N m s/rad].
    """

    name: str
    rotor: str
    left: float
    right: float
    lateral: float = 0.0
    tilt: float = 0.0
    torsional: float = 0.0
    axial: float = 0.0


def shaft_dashpots(
    dashpots: ShaftDashpots, rotor: RotorComponent, speed: float, speed_range: tuple[float, float] = (1.0, 1.0)
) -> tuple[FloatArray, LinearConnector]:
    """Deflections of a coupling by its rotor's coordinates, shape (6, m), and the law of its dashpots as a connector.

    Parameters
    ----------
    speed : float
        Ω, signed [rad/s].
    speed_range : tuple of float
        Lowest and highest speed of the run, as parts of Ω: the circulatory stiffness is proportional to the speed.
    """
    left, right = rotor.motions(dashpots.left), rotor.motions(dashpots.right)
    middle = 0.5 * (dashpots.right - dashpots.left) * (left[3:] + right[3:])
    # A tilt about y moves what is further along z to +x, one about x to -y.
    sway = right[:2] - left[:2] - np.array([middle[1], -middle[0]])
    tilt = right[3:] - left[3:]
    turn = rotor.rotation(dashpots.right) - rotor.rotation(dashpots.left)
    rows = np.vstack([sway, tilt, turn[None], right[2:3] - left[2:3]])
    damping = np.diag(
        [dashpots.lateral, dashpots.lateral, dashpots.tilt, dashpots.tilt, dashpots.torsional, dashpots.axial]
    )
    circulating = np.zeros((6, 6))
    for first, value in ((0, dashpots.lateral), (2, dashpots.tilt)):
        circulating[first, first + 1], circulating[first + 1, first] = speed * value, -speed * value
    table = None
    if speed_range[0] != speed_range[1] and np.any(circulating):
        ends = np.array(speed_range)
        table = SpeedTable(ends, ends[:, None, None] * circulating, np.stack([damping, damping]))
    return rows, LinearConnector(dashpots.name, rows.T, circulating, damping, over_speed=table)
