"""Campbell diagram: whirl over a range of speeds, followed through its crossings.

Starting values at every speed come from one projection on planar modes, reduced once; the roots are then refined
on the exact equations, all speeds in one batch. Branches are followed from speed to speed by the eigenvalue that
continues them and the likeness of shapes. Motions that the bearings do not couple, such as forward and backward whirl
in isotropic ones, are followed separately, so that they cannot be confused where they cross.

Without damping the number of roots is proved at every speed (`rotors.whirl_count`). With damping a proof costs a
contour integral at each speed: it is made at a few speeds, or at all on request.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from .bearing import Bearing
from .branch_following import BranchPoint, refined_crossing
from .branches import Branch, characters, followed
from .campbell_roots import limits_behind, proved_at, roots_at_speeds
from .certificate import ACCEPTED
from .errors import IncompleteModesError, require, require_finite
from .exact_roots import refine_each
from .harmonic import finite_values
from .lateral import LateralModes
from .planar_basis import DEFAULT_COUNT
from .projection import ModalProjection
from .shaft import Rotor
from .spatial_chain import WhirlEquations, retied, whirl_reach
from .spatial_ties import coupled_motions
from .whirl import NEUTRAL, START_REACH, WhirlSolver
from .whirl_certificate import NO_OSCILLATION

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
BoolArray = npt.NDArray[np.bool_]
# With whirl direction and axial share in place of the shape.
Point = BranchPoint[tuple[float, float]]

# A root further from its starting value than this part of it belongs to another branch.
CROSSING_JUMP = 0.1
CROSSING_STEPS = 30
CROSSING_TOLERANCE = 1e-11


@dataclass(frozen=True)
class Crossing:
    """A speed at which a damped whirl frequency is a multiple of the speed of rotation.

    Attributes
    ----------
    speed
        Ω, rad/s.
    eigenvalue
        λ there, with Im λ = order · Ω; exact.
    order
        The multiple.
    direction
        Of the whirl, as in `rotors.WhirlModes`.
    branch
        Index in the diagram.
    axial_share
        Of the motion, as in `rotors.WhirlModes`.
    """

    speed: float
    eigenvalue: complex
    order: float
    direction: float
    branch: int
    axial_share: float = 0.0

    @property
    def log_decrement(self) -> float:
        """−2π Re λ / Im λ."""
        return float(-2.0 * np.pi * self.eigenvalue.real / self.eigenvalue.imag)


@dataclass(frozen=True)
class Campbell:
    """Whirl over speed, one column for each branch; NaN where a branch does not oscillate or is outside the range.

    Attributes
    ----------
    speeds
        (s,): Ω, rad/s.
    eigenvalues
        (s, m) complex, rad/s.
    direction
        (s, m), as in `rotors.WhirlModes`.
    axial_share
        (s, m), as in `rotors.WhirlModes`.
    proved
        (s,): speeds at which the number of roots was proved.
    """

    speeds: FloatArray
    eigenvalues: ComplexArray
    direction: FloatArray
    axial_share: FloatArray
    proved: BoolArray
    solver: WhirlSolver = field(repr=False)
    blocks: tuple[tuple[int, ...], ...] = field(repr=False)

    @property
    def frequencies(self) -> FloatArray:
        """Natural frequency |λ|, rad/s, (s, m)."""
        return np.asarray(np.abs(self.eigenvalues))

    @property
    def damped_frequencies(self) -> FloatArray:
        """Im λ, rad/s, (s, m)."""
        return np.asarray(self.eigenvalues.imag)

    @property
    def log_decrements(self) -> FloatArray:
        """−2π Re λ / Im λ, (s, m)."""
        return np.asarray(-2.0 * np.pi * self.eigenvalues.real / self.eigenvalues.imag)

    @property
    def unstable_from(self) -> float | None:
        """Lowest speed of the diagram, without its sense, at which a mode grows, rad/s; None where none does."""
        # Branches that do not oscillate at a speed are NaN there, which compares as stable.
        grows = (self.log_decrements < -2.0 * np.pi * NEUTRAL).any(axis=1)
        return float(np.abs(self.speeds[grows]).min()) if grows.any() else None

    def crossings(self, order: float = 1.0) -> tuple[Crossing, ...]:
        """Where branches cross Im λ = order · |Ω| within the range, each refined on the exact equations.

        Raises
        ------
        IncompleteModesError
            A crossing seen between two speeds cannot be refined; more speeds would separate it.
        """
        require_finite("order", order, positive=True)
        found = []
        for branch in range(self.eigenvalues.shape[1]):
            gap = self.eigenvalues[:, branch].imag - order * np.abs(self.speeds)
            for left in np.flatnonzero((gap[:-1] > 0.0) != (gap[1:] > 0.0)):
                if np.isfinite(gap[left]) and np.isfinite(gap[left + 1]) and gap[left] != gap[left + 1]:
                    found.append(self._crossing(branch, int(left), order))
        return tuple(sorted(found, key=lambda crossing: abs(crossing.speed)))

    def _crossing(self, branch: int, left: int, order: float) -> Crossing:
        """The crossing between two neighbouring speeds, each λ on the way refined from between its neighbours."""
        speeds, ends = self.speeds[left : left + 2].tolist(), self.eigenvalues[left : left + 2, branch]
        chain = self._chain(branch, float(np.abs(ends).max()), max(abs(speeds[0]), abs(speeds[1])))

        def solve(part: float, low: Point, high: Point) -> Point | None:
            speed = low.speed + part * (high.speed - low.speed)
            tied = retied(chain, self.solver.bearings, speed)
            start = np.array([low.eigenvalue + part * (high.eigenvalue - low.eigenvalue)])
            root = refine_each(tied, start, np.array([speed]))
            value = complex(root.eigenvalues[0])
            if root.residuals[0] > ACCEPTED or abs(value - start[0]) > CROSSING_JUMP * abs(value):
                return None
            direction, along = characters(tied, root, np.array([speed]))[0].tolist()
            return BranchPoint(speed, value, value.imag - order * abs(speed), (direction, along))

        points = [
            BranchPoint(speed, complex(value), float(value.imag - order * abs(speed)), (np.nan, np.nan))
            for speed, value in zip(speeds, ends, strict=True)
        ]
        found = refined_crossing(points[0], points[1], solve, tolerance=CROSSING_TOLERANCE, steps=CROSSING_STEPS)
        if found is None:
            raise IncompleteModesError(
                f"the crossing of order {order:g} between {speeds[0]:g} and {speeds[1]:g} rad/s does "
                "not settle; ask for more speeds about there"
            )
        return Crossing(found.speed, found.eigenvalue, order, found.shape[0], branch, found.shape[1])

    def _chain(self, branch: int, highest: float, speed: float) -> WhirlEquations:
        sets = self.blocks[branch]
        constant = [bearing.at_speed(_inside(bearing, speed)) for bearing in self.solver.bearings]
        return self.solver.equations(constant, sets, whirl_reach(START_REACH * highest, speed))


def campbell(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    speeds: npt.ArrayLike,
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
    basis: LateralModes | None = None,
    prove_all: bool = False,
    solver: WhirlSolver | None = None,
) -> Campbell:
    """Exact whirl modes over a range of speeds.

    Parameters
    ----------
    rotor, bearings
        The rotor and its bearings; tables over speed are read at each speed.
    speeds
        (s,): Ω, rad/s, ascending.
    frequency_limit
        rad/s: branches below it at some speed.
    count
        Number of branches, the lowest at every speed, instead of a limit; with neither, 12.
    basis
        From `rotors.whirl_basis`, to avoid building it.
    prove_all
        Whether the number of roots is proved at every speed where bearings damp, and not at a few only.
    solver
        A `rotors.WhirlSolver` of the same rotor and bearings, whose basis and equations are used.

    Raises
    ------
    RotorError
        Wrong arguments, or a speed beyond a table.
    IncompleteModesError
        A proof fails.
    """
    turning = finite_values("speeds", speeds)
    require(bool((np.diff(turning) > 0.0).all()), "speeds", turning.tolist(), "ascending speeds")
    shared = WhirlSolver(rotor, bearings, basis) if solver is None else solver
    same = shared.rotor is rotor and shared.bearings == tuple(bearings)
    require(same, "rotor of the solver", shared.rotor.name, f"{rotor.name}, on the same bearings")
    chosen = shared.planar_basis(frequency_limit, count)
    tabled = any(bearing.speeds is not None for bearing in bearings)
    at_speeds = [[b.at_speed(float(s)) for b in bearings] for s in turning] if tabled else [list(bearings)]
    sets = coupled_motions([bearing for row in at_speeds for bearing in row])
    wanted = None if frequency_limit is not None else count or DEFAULT_COUNT
    starts = []
    for blocks in sets:
        one = ModalProjection.of(rotor, at_speeds[0], blocks, chosen)
        if tabled:
            rows = [one.pencil(b).eigenvalues(turning[k : k + 1]) for k, b in enumerate(at_speeds)]
            values = np.concatenate(rows)
        else:
            values = one.pencil(at_speeds[0]).eigenvalues(turning)
        oscillates = (values.imag > NO_OSCILLATION * np.abs(values)) & (np.abs(values) > NO_OSCILLATION * one.floor)
        starts.append(np.where(oscillates, values, np.nan))
    limits = limits_behind(starts, frequency_limit, wanted)
    least = NO_OSCILLATION * chosen.floor
    undriven = shared.is_conservative_rotor([bearing for row in at_speeds for bearing in row])
    highest = max(whirl_reach(START_REACH * r, float(s)) for r, s in zip(limits, turning, strict=True))
    branches: list[Branch] = []
    owners: list[tuple[int, ...]] = []
    proved = np.ones(turning.size, dtype=np.bool_)
    for blocks, values in zip(sets, starts, strict=True):
        chain = shared.equations(at_speeds[0], blocks, highest)
        chains = [retied(chain, row, 0.0) for row in at_speeds] if tabled else [chain] * turning.size
        roots = roots_at_speeds(chains, values, turning, limits)
        proved &= proved_at(chains, roots, turning, least, limits, undriven, prove_all)
        for branch in followed(chain, roots, turning):
            if bool((np.abs(branch.eigenvalues) < limits).any()):
                branches.append(branch)
                owners.append(blocks)
    order = sorted(range(len(branches)), key=lambda k: branches[k].first_frequency)
    empty = np.zeros((turning.size, 0))
    return Campbell(
        speeds=turning,
        eigenvalues=np.stack([branches[k].eigenvalues for k in order], axis=1) if order else empty.astype(complex),
        direction=np.stack([branches[k].direction for k in order], axis=1) if order else empty,
        axial_share=np.stack([branches[k].axial_share for k in order], axis=1) if order else empty,
        proved=proved,
        solver=shared,
        blocks=tuple(owners[k] for k in order),
    )


def _inside(bearing: Bearing, speed: float) -> float:
    """The speed, or the nearest one in a bearing's table."""
    if bearing.speeds is None:
        return speed
    return float(np.clip(abs(speed), bearing.speeds[0], bearing.speeds[-1]))
