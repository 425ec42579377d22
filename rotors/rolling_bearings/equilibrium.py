"""Static equilibrium of a rolling bearing: displacement, 5x5 tangent stiffness and element loads under a load.

With the energy φ(q) of all elements and the load f, the potential

    Π(q) = φ(q) − fᵀ q

is convex (`gearwhine.rotors.rolling_bearings.element_contacts`, `gearwhine.rotors.rolling_bearings.centrifugal_balls`)
and grows faster than linearly in every direction that the bearing holds. So it has a minimum for every load along
those, which is the equilibrium, and a trust region finds it from any start. The tangent stiffness is the Hessian of φ
there; with it `linearised_bearing` makes the linear bearing of a rotor. `RollingElements` gives φ and its derivatives
at any displacement, so that a machine can minimise the energy of its shafts and all its bearings together. Krämer's
formulas give a first estimate of the stiffness.

The outer ring of a floating bearing slides along z without friction. Its energy is the least over the place w of the
inner ring against it,

    ψ(x, y, φ_x, φ_y) = min_w φ(x, y, w, φ_x, φ_y),

which is convex as well. At the minimum ∂φ/∂w = 0: there is no axial force, the other forces are those of φ, and the
Hessian is condensed, H − h hᵀ / h_ww with the column h of w. Where clearance leaves h_ww zero, h is zero too, as H is
positive semidefinite.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.trust_region import Local, minimise
from gearwhine.rotors.errors import EquilibriumError, require, require_finite
from gearwhine.rotors.model.bearing import Bearing
from gearwhine.rotors.rolling_bearings.centrifugal_balls import CentrifugalBalls
from gearwhine.rotors.rolling_bearings.element_contacts import ElementLoads, RowContacts, RowEnergy, StaticBalls
from gearwhine.rotors.rolling_bearings.four_point_balls import FourPointBalls
from gearwhine.rotors.rolling_bearings.frequencies import pressed_azimuth
from gearwhine.rotors.rolling_bearings.ratings import Row
from gearwhine.rotors.rolling_bearings.roller_rows import LineContactRow
from gearwhine.rotors.rolling_bearings.roller_slices import RollerSlices
from gearwhine.rotors.rolling_bearings.rolling_bearing import RollingBearing
from gearwhine.rotors.rolling_bearings.rows import BallRow, FourPointRow

COORDINATES = ("x", "y", "z", "rx", "ry")
"""The inner ring's displacement against the outer: along x, y, z, and rotations about x and y."""

# Part of the largest stiffness below which a stiffness counts as zero, rotations scaled by the pitch circle.
_NO_STIFFNESS = 1e-9
# Share of a coordinate in a motion without stiffness above which it counts as free.
_TAKES_PART = 1e-6


@dataclass(frozen=True)
class RollingState:
    """A rolling bearing in equilibrium. Arrays of five are over `COORDINATES`: m and rad, N and N·m.

    Attributes
    ----------
    bearing : RollingBearing
        The bearing.
    displacement : ndarray, shape (5,)
        Displacement of the inner ring against the outer; for a floating bearing z follows from the other four.
    load : ndarray, shape (5,)
        External load on the inner ring, constraint forces included, the preload spring excluded.
    reaction : ndarray, shape (5,)
        Force of the elements on the outer ring: ``load`` plus the spring's force, up to the residual.
    stiffness : ndarray, shape (5, 5)
        Tangent stiffness ∂reaction/∂displacement, symmetric and positive semidefinite.
    rows : tuple of ElementLoads
        Element loads of each row.
    row_thrusts : tuple of float
        Axial force of each row's elements on the outer ring along the row's direction [N].
    speed : float
        Speed of the inner ring [rad/s].
    residual : float
        Largest force out of balance over the sum of the acting loads.
    iterations : int
        Number of Newton steps.
    """

    bearing: RollingBearing
    displacement: FloatArray
    load: FloatArray
    reaction: FloatArray
    stiffness: FloatArray
    rows: tuple[ElementLoads, ...] = field(repr=False)
    row_thrusts: tuple[float, ...]
    speed: float
    residual: float
    iterations: int

    @property
    def loaded(self) -> int:
        """Number of loaded elements in all rows."""
        return sum(row.loaded for row in self.rows)

    @property
    def peak_pressure(self) -> float:
        """Greatest contact pressure [Pa]."""
        return max(row.peak_pressure for row in self.rows)

    @property
    def even_stiffness(self) -> FloatArray:
        """Stiffness with rotations as displacements of the pitch circle and moments as forces there, (5, 5) [N/m]."""
        size = np.array([1.0, 1.0, 1.0, self.bearing.reach, self.bearing.reach])
        return np.asarray(self.stiffness / np.outer(size, size))

    @property
    def loose(self) -> tuple[str, ...]:
        """Coordinates of motions without stiffness, because of clearance or of the bearing's type."""
        values, vectors = np.linalg.eigh(self.even_stiffness)
        free = vectors[:, values <= _NO_STIFFNESS * max(values[-1], 1.0)]
        weight = (free**2).sum(axis=1)
        return tuple(name for name, part in zip(COORDINATES, weight.tolist(), strict=True) if part > _TAKES_PART)


# Largest approach of the rings over the element's diameter: beyond, Hertz's theory of small contacts and the elasticity
# of steel do not hold. It is reached at about five times the static load rating of ISO 76.
LARGEST_APPROACH = 0.02
# Unbalanced force relative to the loads: target and largest accepted. For an unloaded ring the reference is a small
# part of E* D² instead, a hundredth of a newton for a ball of 10 mm.
_TOLERANCE = 1e-14
_ACCEPTED = 1e-10
_LEAST_FORCE = 1e-9
# Step of a floating ring over the element's diameter at which its iteration ends, and the largest number of steps.
_SEATED = 1e-12
_SEATING_STEPS = 100


@dataclass(frozen=True)
class RollingElements:
    """Elements of a bearing between its rings: their energy over the inner ring's displacement, prepared once.

    The displacement of a floating bearing is against the seat; its z has no energy.

    Parameters
    ----------
    bearing : RollingBearing
        The bearing, by its geometry.
    speed : float
        Speed of the inner ring [rad/s], the outer at rest: adds centrifugal forces on the elements.
    cage_angle : float
        Azimuth of the first element of every row [rad].

    Raises
    ------
    RotorError
        A speed or angle that is not finite.
    """

    bearing: RollingBearing
    speed: float = 0.0
    cage_angle: float = 0.0

    def __post_init__(self) -> None:
        """Check that speed and cage angle are finite."""
        require_finite("speed", self.speed)
        require_finite("cage angle", self.cage_angle)

    def at(self, displacement: FloatArray) -> Local:
        """Energy of elements and preload spring with the inner ring displaced, convex in the displacement.

        Parameters
        ----------
        displacement : ndarray, shape (5,)
            Displacement over `COORDINATES` [m, rad].

        Returns
        -------
        Local
            Energy φ(q) − P z [J] with the spring's force P; its gradient, the force (5,) of the shaft on the inner ring
            (N and N·m); its Hessian, the tangent stiffness (5, 5); ``noise`` [J] and ``force`` [N], the scales of the
            rounding of energy and forces.
        """
        q = self.seated(displacement)
        return self.together(q, [row.energy(q) for row in self.contacts])

    def together(self, q: FloatArray, rows: Sequence[RowEnergy]) -> Local:
        """Sum of the rows' energies at a seated displacement (5,), with the preload spring; see :meth:`at`."""
        value, load = sum(row.value for row in rows), sum(row.force for row in rows)
        preload = self.bearing.axial_preload
        gradient, hessian = rows[0].gradient, rows[0].hessian
        for row in rows[1:]:
            gradient, hessian = gradient + row.gradient, hessian + row.hessian
        gradient = gradient.copy()
        gradient[2] -= preload
        work = preload * float(q[2])
        local = Local(
            value=value - work,
            gradient=gradient,
            hessian=0.5 * (hessian + hessian.T),
            # Contacts are as deep as the rounded difference of two lengths of a tenth of an element or less.
            noise=value + abs(work) + 0.1 * load * self.bearing.largest_element,
            force=load + abs(preload) + _LEAST_FORCE * self.bearing.force_scale,
        )
        return _released(local) if self.bearing.floating else local

    def seated(self, displacement: FloatArray) -> FloatArray:
        """Displacement of the inner ring against the outer one, (5,): of a floating bearing with the z of no force."""
        q = np.array(displacement, dtype=np.float64)
        if not self.bearing.floating:
            return q
        # Newton's method on the axial force, which rises with z, within the bracket of its signs.
        q[2], low, high = 0.0, -math.inf, math.inf
        for _ in range(_SEATING_STEPS):
            rows = [row.energy(q) for row in self.contacts]
            force = float(sum(row.gradient[2] for row in rows))
            stiffness = float(sum(row.hessian[2, 2] for row in rows))
            if stiffness <= 0.0 or abs(force) <= _SEATED * self.bearing.largest_element * stiffness:
                break
            low, high = (low, float(q[2])) if force > 0.0 else (float(q[2]), high)
            place = float(q[2]) - force / stiffness
            q[2] = place if low < place < high else 0.5 * (low + high)
        return q

    def loads(self, displacement: FloatArray) -> tuple[ElementLoads, ...]:
        """Element loads of each row with the inner ring displaced, (5,)."""
        q = self.seated(displacement)
        found = [contacts.loads(q) for contacts in self.contacts]
        return tuple(
            replace(loads, azimuths=loads.azimuths - pressed_azimuth(row, 0.0))
            for row, loads in zip(self.bearing.rows, found, strict=True)
        )

    @cached_property
    def contacts(self) -> tuple[RowContacts, ...]:
        """Contacts of each row."""
        return tuple(_contacts(row, self.speed, self.cage_angle) for row in self.bearing.rows)


def rolling_equilibrium(
    bearing: RollingBearing,
    load: Sequence[float] | FloatArray,
    *,
    held: Mapping[str, float] | None = None,
    speed: float = 0.0,
    cage_angle: float = 0.0,
) -> RollingState:
    """Equilibrium of the inner ring under a load, with the coordinates ``held`` prescribed.

    Parameters
    ----------
    bearing : RollingBearing
        The bearing, by its geometry.
    load : sequence of float or ndarray, shape (5,)
        Force x, y, z [N] and moment about x and y [N·m] on the inner ring at the bearing's centre. The constraint
        carries the load on a held coordinate.
    held : mapping of str to float, optional
        Displacement of constrained coordinates, by their names in `COORDINATES`, m and rad. Rotations held at zero
        represent a stiff, aligned shaft.
    speed : float
        Speed of the inner ring [rad/s], the outer at rest: adds centrifugal forces on the elements.
    cage_angle : float
        Azimuth of the first element of every row [rad].

    Returns
    -------
    RollingState
        The equilibrium, unique without clearance; otherwise one of several along a loose coordinate.

    Raises
    ------
    RotorError
        Wrong arguments, such as an axial load on cylindrical rollers.
    EquilibriumError
        Contacts outside their groove, a load beyond the theory, or a result that fails its proof.
    """
    applied = np.array(load, dtype=np.float64)
    finite = applied.shape == (5,) and bool(np.isfinite(applied).all())
    require(finite, f"load on {bearing.name}", applied.tolist(), "five finite numbers: x, y, z, moments about x and y")
    fixed = dict(held or {})
    for name, value in fixed.items():
        require(name in COORDINATES, f"held coordinate of {bearing.name}", name, f"one of {', '.join(COORDINATES)}")
        require_finite(f"displacement {name} of {bearing.name}", value)
    elements = RollingElements(bearing, speed, cage_angle)
    pushed = applied[2] != 0.0 and "z" not in fixed and not bearing.has_axial_stiffness
    require(
        not pushed,
        f"axial load on {bearing.name}",
        float(applied[2]),
        "none, or z held: "
        + ("its outer ring floats" if bearing.floating else "cylindrical rollers without flanges carry none"),
    )

    # Rotations as displacements of the pitch circle, so that all five are lengths.
    size = np.array([1.0, 1.0, 1.0, bearing.reach, bearing.reach])
    free = np.array([name not in fixed for name in COORDINATES])
    start = np.array([fixed.get(name, 0.0) for name in COORDINATES])

    def displaced(lengths: FloatArray) -> FloatArray:
        q = start.copy()
        q[free] = lengths / size[free]
        return q

    def potential(lengths: FloatArray) -> Local:
        q = displaced(lengths)
        local = elements.at(q)
        work = float(applied[free] @ q[free])
        return Local(
            value=local.value - work,
            gradient=((local.gradient - applied) / size)[free],
            hessian=(local.hessian / np.outer(size, size))[np.ix_(free, free)],
            noise=local.noise + abs(work),
            force=local.force + float(np.abs(applied / size).sum()),
        )

    minimum = minimise(potential, np.zeros(int(free.sum())), 1e-3 * bearing.largest_element, _TOLERANCE)
    q = displaced(minimum.place)
    return _state(elements, q, np.where(free, applied, elements.at(q).gradient), minimum.residual, minimum.iterations)


def rolling_state(
    bearing: RollingBearing,
    displacement: Sequence[float] | FloatArray,
    *,
    speed: float = 0.0,
    cage_angle: float = 0.0,
) -> RollingState:
    """State of the bearing with its inner ring at a given displacement, as a machine's equilibrium finds it.

    Parameters
    ----------
    bearing : RollingBearing
        The bearing, by its geometry.
    displacement : sequence of float or ndarray, shape (5,)
        Displacement over `COORDINATES` [m, rad].
    speed, cage_angle : float
        See `rolling_equilibrium`.

    Returns
    -------
    RollingState
        State whose load holds the ring at the displacement; its residual is zero.

    Raises
    ------
    RotorError, EquilibriumError
        As `rolling_equilibrium`.
    """
    q = np.array(displacement, dtype=np.float64)
    finite = q.shape == (5,) and bool(np.isfinite(q).all())
    require(finite, f"displacement of {bearing.name}", q.tolist(), "five finite numbers: x, y, z, rx, ry")
    return state_of_elements(RollingElements(bearing, speed, cage_angle), q)


def state_of_elements(elements: RollingElements, displacement: FloatArray) -> RollingState:
    """Return the state of prepared elements, see `rolling_state`."""
    return _state(elements, displacement, None, residual=0.0, iterations=0)


def _state(
    elements: RollingElements, displacement: FloatArray, applied: FloatArray | None, residual: float, iterations: int
) -> RollingState:
    """State under a load, by default that of the elements."""
    bearing, seated = elements.bearing, elements.seated(displacement)
    rows = [contacts.energy(seated) for contacts in elements.contacts]
    local = elements.together(seated, rows)
    state = RollingState(
        bearing=bearing,
        displacement=seated,
        load=local.gradient if applied is None else applied,
        reaction=local.gradient + bearing.axial_preload * np.eye(5)[2],
        stiffness=local.hessian,
        rows=elements.loads(displacement),
        row_thrusts=tuple(
            row.direction * float(energy.gradient[2]) for row, energy in zip(bearing.rows, rows, strict=True)
        ),
        speed=elements.speed,
        residual=residual,
        iterations=iterations,
    )
    _require_proof(state)
    return state


def _released(local: Local) -> Local:
    """Energy minimised over z near its minimum, by the quadratic; no force remains along z."""
    gradient, hessian = local.gradient.copy(), local.hessian.copy()
    push, column, stiffness = float(gradient[2]), hessian[:, 2].copy(), float(hessian[2, 2])
    value = local.value
    if stiffness > 0.0:
        value -= 0.5 * push**2 / stiffness
        gradient -= push / stiffness * column
        hessian -= np.outer(column, column) / stiffness
    gradient[2] = hessian[2, :] = hessian[:, 2] = 0.0
    return replace(local, value=value, gradient=gradient, hessian=hessian)


def _contacts(row: Row, speed: float, cage_angle: float) -> RowContacts:
    azimuths = pressed_azimuth(row, cage_angle) + 2.0 * math.pi * np.arange(row.count) / row.count
    thrown = row.centrifugal_force(speed)
    if isinstance(row, LineContactRow):
        return RollerSlices(row, azimuths, thrown)
    if isinstance(row, FourPointRow):
        return FourPointBalls(row, azimuths, thrown)
    return CentrifugalBalls(row, azimuths, thrown) if thrown > 0.0 else StaticBalls(row, azimuths)


def _require_proof(state: RollingState) -> None:
    """Raise unless the state is a stable equilibrium within the limits of the theory."""
    name = state.bearing.name
    for number, (row, loads) in enumerate(zip(state.bearing.rows, state.rows, strict=True), start=1):
        deepest = float(loads.approach.max()) / row.element_diameter
        if deepest > LARGEST_APPROACH:
            raise EquilibriumError(
                f"{name}: the elements of row {number} are pressed by {100 * deepest:.3g} % of their diameter; "
                f"expected at most {100 * LARGEST_APPROACH:g} %: less load, preload, interference or tilt, or a larger "
                "bearing"
            )
        if isinstance(row, BallRow) and not isinstance(row, FourPointRow):
            _require_grooves(name, number, row, loads)
    if state.residual > _ACCEPTED:
        raise EquilibriumError(
            f"{name}: no equilibrium after {state.iterations} steps, {state.residual:.3g} of the loads is left; "
            f"expected {_ACCEPTED:g}: check that load and geometry are in N, N·m and m, and that rows which "
            "carry axial load one way only have it, or an opposed row, a preload or z held"
        )
    values = np.linalg.eigvalsh(state.even_stiffness)
    if values[0] < -1e-9 * max(values[-1], 1.0):
        raise EquilibriumError(
            f"{name}: its tangent stiffness has the eigenvalue {values[0]:.3g}; expected none below 0"
        )


def _require_grooves(name: str, number: int, row: BallRow, loads: ElementLoads) -> None:
    low, high = row.groove_limits
    slack = 1e-9
    for ring, angle, load in (
        ("inner", loads.inner_angle, loads.inner_load),
        ("outer", loads.outer_angle, loads.outer_load),
    ):
        outside = (load > 0.0) & ((angle < low - slack) | (angle > high + slack))
        if outside.any():
            worst = math.degrees(float(angle[np.argmax(np.where(outside, load, -1.0))]))
            raise EquilibriumError(
                f"{name}: balls of row {number} touch the {ring} ring at {worst:.4g}°, beyond its groove; "
                f"expected contact angles of {math.degrees(low):.4g}° to {math.degrees(high):.4g}°: more axial load or "
                "preload along the row's direction keeps them there, or less of it where they climb the shoulder"
            )


ROLLING_DAMPING_TIME = 0.8e-5
"""Damping of a rolling bearing over its stiffness where nobody gives another [s].

Krämer (1993), *Dynamics of Rotors and Foundations*, chapter 4, has 0.25e-5 to 2.5e-5 s over measured bearings; this is
the geometric mean. It follows the load as the stiffness does, and is a loss factor of 0.05 at 1 kHz.
"""


def linearised_bearing(state: RollingState, name: str, at: float, *, damping: npt.ArrayLike | None = None) -> Bearing:
    """Linearise a rolling bearing about its equilibrium.

    Parameters
    ----------
    state : RollingState
        State from `rolling_equilibrium`.
    name, at : str, float
        Name of the bearing in messages, and place of its centre from the rotor's left end [m].
    damping : array_like, shape (2, 2) or (5, 5), optional
        Damping [N·s/m and its like]; zero if not given, as contact mechanics gives none.

    Raises
    ------
    EquilibriumError
        Clearance leaves the shaft loose in x or y at this load.
    RotorError
        As `Bearing`.
    """
    require_held(state)
    damped = np.zeros((2, 2)) if damping is None else np.asarray(damping, dtype=np.float64)
    return Bearing(name, at, state.stiffness, damped)


def require_held(state: RollingState) -> None:
    """Raise `EquilibriumError` where clearance leaves the shaft loose in x or y."""
    loose = [direction for direction in state.loose if direction in ("x", "y")]
    if loose:
        raise EquilibriumError(
            f"{state.bearing.name} leaves the shaft loose in {' and '.join(loose)} under {state.load.tolist()}; "
            "expected a load, a preload or less clearance, so that its elements hold the shaft all around"
        )
