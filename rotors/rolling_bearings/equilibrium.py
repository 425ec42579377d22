"""Static equilibrium of a rolling bearing: displacement, tangent stiffness and element loads under a load.

With the energy φ(q) of all elements and the load f, the potential

    Π(q) = φ(q) − fᵀ q

is convex (`rotors.rolling_bearings.element_contacts`, `rotors.rolling_bearings.centrifugal_balls`) and grows faster
than linearly in every direction that the bearing holds. So it has a minimum for every load along those, which is the
equilibrium, and a trust region finds it from any start. The tangent stiffness is the Hessian of φ there; with it
`linearised_bearing` makes the linear bearing of a rotor. Krämer's formulas give a first estimate of the stiffness.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from rotors.errors import EquilibriumError, RotorError, require, require_count, require_finite
from rotors.model.bearing import Bearing
from rotors.numerics.trust_region import Local, minimise
from rotors.rolling_bearings.centrifugal_balls import CentrifugalBalls
from rotors.rolling_bearings.element_contacts import ElementLoads, RollerSlices, RowContacts, RowEnergy, StaticBalls
from rotors.rolling_bearings.rolling_bearing import RollingBearing, Row
from rotors.rolling_bearings.rows import BallRow

FloatArray = npt.NDArray[np.float64]

COORDINATES = ("x", "y", "z", "rx", "ry")
"""The inner ring's displacement against the outer: along x, y, z, and rotations about x and y."""

# Stiffness below this part of the largest, rotations scaled by the pitch circle, counts as zero.
_NO_STIFFNESS = 1e-9
# Share of a coordinate in such a motion above which it counts as free.
_TAKES_PART = 1e-6


@dataclass(frozen=True)
class RollingState:
    """A rolling bearing in equilibrium. Arrays of five are over `COORDINATES`: m and rad, N and N·m.

    Attributes
    ----------
    bearing
        The bearing.
    displacement
        (5,): of the inner ring against the outer.
    load
        (5,): external load on the inner ring, constraint forces included, the preload spring excluded.
    reaction
        (5,): force of the elements on the outer ring: ``load`` plus the spring's force, up to the residual.
    stiffness
        (5, 5): tangent, symmetric and positive semidefinite; ∂reaction/∂displacement.
    rows
        Element loads of each row.
    speed
        Of the inner ring, rad/s.
    residual
        Largest force out of balance over the sum of the loads at work.
    iterations
        Newton steps taken.
    """

    bearing: RollingBearing
    displacement: FloatArray
    load: FloatArray
    reaction: FloatArray
    stiffness: FloatArray
    rows: tuple[ElementLoads, ...] = field(repr=False)
    speed: float
    residual: float
    iterations: int

    @property
    def loaded(self) -> int:
        """Number of loaded elements in all rows."""
        return sum(row.loaded for row in self.rows)

    @property
    def peak_pressure(self) -> float:
        """Greatest contact pressure, Pa."""
        return max(row.peak_pressure for row in self.rows)

    @property
    def even_stiffness(self) -> FloatArray:
        """Stiffness with rotations as displacements of the pitch circle and moments as forces there, (5, 5), N/m."""
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


def rolling_equilibrium(
    bearing: RollingBearing,
    load: Sequence[float] | FloatArray,
    *,
    held: Mapping[str, float] | None = None,
    speed: float = 0.0,
    cage_angle: float = 0.0,
) -> RollingState:
    """Equilibrium of the inner ring under a load, some of its coordinates held where asked.

    Parameters
    ----------
    bearing
        By its geometry.
    load
        (5,): force x, y, z (N) and moment about x and y (N·m) on the inner ring at the bearing's centre. The constraint
        carries the load on a held coordinate.
    held
        Displacement of constrained coordinates, by their names in `COORDINATES`, m and rad. Rotations held at zero
        represent a stiff, aligned shaft.
    speed
        Of the inner ring, rad/s, the outer at rest: adds centrifugal forces on balls.
    cage_angle
        Azimuth of the first element of every row, rad.

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
    require_finite("speed", speed)
    require_finite("cage angle", cage_angle)
    pushed = applied[2] != 0.0 and "z" not in fixed and not bearing.has_axial_stiffness
    require(
        not pushed,
        f"axial load on {bearing.name}",
        float(applied[2]),
        "none, or z held: cylindrical rollers carry none",
    )

    contacts = [_contacts(row, speed, cage_angle) for row in bearing.rows]
    # Rotations as displacements of the pitch circle, so that all five are lengths.
    size = np.array([1.0, 1.0, 1.0, bearing.reach, bearing.reach])
    force = applied + bearing.axial_preload * np.eye(5)[2]
    free = np.array([name not in fixed for name in COORDINATES])
    start = np.array([fixed.get(name, 0.0) for name in COORDINATES])

    largest = max(row.element_diameter for row in bearing.rows)

    def displaced(lengths: FloatArray) -> FloatArray:
        q = start.copy()
        q[free] = lengths / size[free]
        return q

    def potential(lengths: FloatArray) -> Local:
        q = displaced(lengths)
        energy = _total([part.energy(q) for part in contacts])
        work = float(force[free] @ q[free])
        return Local(
            value=energy.value - work,
            gradient=((energy.gradient - force) / size)[free],
            hessian=(energy.hessian / np.outer(size, size))[np.ix_(free, free)],
            # Contacts are as deep as the rounded difference of two lengths of a tenth of an element or less.
            noise=energy.value + abs(work) + 0.1 * energy.force * largest,
            force=energy.force + float(np.abs(force / size).sum()) + _LEAST_FORCE * bearing.force_scale,
        )

    found = minimise(potential, np.zeros(int(free.sum())), 1e-3 * largest, _TOLERANCE)
    q = displaced(found.place)
    energy = _total([part.energy(q) for part in contacts])
    state = RollingState(
        bearing=bearing,
        displacement=q,
        load=np.where(free, applied, energy.gradient - force + applied),
        reaction=energy.gradient,
        stiffness=0.5 * (energy.hessian + energy.hessian.T),
        rows=tuple(part.loads(q) for part in contacts),
        speed=speed,
        residual=found.residual,
        iterations=found.iterations,
    )
    _require_proof(state)
    return state


def rolling_reaction(
    bearing: RollingBearing,
    displacement: Sequence[float] | FloatArray,
    *,
    speed: float = 0.0,
    cage_angle: float = 0.0,
) -> RollingState:
    """State of the bearing with its inner ring displaced by five given amounts (m and rad).

    Raises
    ------
    RotorError, EquilibriumError
        As `rolling_equilibrium`.
    """
    given = np.array(displacement, dtype=np.float64)
    require(given.shape == (5,), f"displacement of {bearing.name}", given.tolist(), "five numbers: x, y, z, rx, ry")
    held = dict(zip(COORDINATES, given.tolist(), strict=True))
    return rolling_equilibrium(bearing, np.zeros(5), held=held, speed=speed, cage_angle=cage_angle)


def _contacts(row: Row, speed: float, cage_angle: float) -> RowContacts:
    azimuths = cage_angle + 2.0 * math.pi * np.arange(row.count) / row.count
    if isinstance(row, BallRow):
        thrown = row.centrifugal_force(speed)
        return CentrifugalBalls(row, azimuths, thrown) if thrown > 0.0 else StaticBalls(row, azimuths)
    if speed != 0.0:
        raise RotorError(f"speed is {speed!r}; expected 0 for rollers, whose centrifugal forces are left out")
    return RollerSlices(row, azimuths)


def _total(rows: Sequence[RowEnergy]) -> RowEnergy:
    """Energy of rows that share their rings."""
    return RowEnergy(
        value=math.fsum(row.value for row in rows),
        gradient=np.sum([row.gradient for row in rows], axis=0),
        hessian=np.sum([row.hessian for row in rows], axis=0),
        force=math.fsum(row.force for row in rows),
    )


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
        if isinstance(row, BallRow):
            _require_grooves(name, number, row, loads)
    if state.residual > _ACCEPTED:
        raise EquilibriumError(
            f"{name}: no equilibrium after {state.iterations} steps, {state.residual:.3g} of the loads is left; "
            f"expected {_ACCEPTED:g}: check that load and geometry are in N, N·m and m"
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


def linearised_bearing(state: RollingState, name: str, at: float, *, damping: npt.ArrayLike | None = None) -> Bearing:
    """Linearise a rolling bearing about its equilibrium.

    Parameters
    ----------
    state
        From `rolling_equilibrium`.
    name, at
        Name of the bearing in messages, and place of its centre, m from the rotor's left end.
    damping
        (2, 2) or (5, 5), N·s/m and its like; zero if not given, as contact mechanics gives none.

    Raises
    ------
    EquilibriumError
        Clearance leaves the shaft loose in x or y at this load.
    RotorError
        As `Bearing`.
    """
    loose = [direction for direction in state.loose if direction in ("x", "y")]
    if loose:
        raise EquilibriumError(
            f"{state.bearing.name} leaves the shaft loose in {' and '.join(loose)} under {state.load.tolist()}; "
            "expected a load, a preload or less clearance, so that its elements hold the shaft all around"
        )
    damped = np.zeros((2, 2)) if damping is None else np.asarray(damping, dtype=np.float64)
    return Bearing(name, at, state.stiffness, damped)


def kramer_ball_stiffness(count: int, ball_diameter: float, load: float, contact_angle: float = 0.0) -> float:
    """Radial stiffness (N/m) in the direction of a radial load (N) by Krämer's formula, for a first estimate.

    k = 13e6 Z^{2/3} d^{1/3} F^{1/3} cos^{5/3} α in N and m (Krämer 1993, after Friswell et al. 2010, chapter 5): no
    clearance, grooves as usual.
    """
    _require_formula("balls", count, ball_diameter, load)
    return float(13e6 * (count**2 * ball_diameter * load) ** (1 / 3) * math.cos(contact_angle) ** (5 / 3))


def kramer_roller_stiffness(count: int, length: float, load: float, contact_angle: float = 0.0) -> float:
    """Return Krämer's stiffness of a roller bearing, k = 1.0e9 Z^{0.9} l^{0.8} F^{0.1} cos^{1.9} α, in N and m."""
    _require_formula("rollers", count, length, load)
    return float(1.0e9 * count**0.9 * length**0.8 * load**0.1 * math.cos(contact_angle) ** 1.9)


def _require_formula(what: str, count: int, size: float, load: float) -> None:
    require_count(f"count of {what}", count)
    require_finite(f"size of {what}", size, positive=True)
    require_finite(f"load on {what}", load, minimum=0.0)
