"""Campbell diagram: whirl eigenvalues over a range of speeds, crossings with orders of the speed, stability limit.

Starting values at every speed come from one modal projection, reduced once; the roots are then refined on the exact
equations, all speeds in one batch. Branches are followed from speed to speed, through the places where they cross, by
the eigenvalue that continues them and the modal assurance criterion of the shapes. Motions that the bearings do not
couple, such as forward and backward whirl in isotropic ones, are followed separately, so that they cannot be confused
where they cross.

Without damping the number of roots is proved at every speed (`gearwhine.rotors.whirl.completeness`). With damping a
proof costs a contour integral at each speed: it is made at a few speeds, or at all on request.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import BoolArray, ComplexArray, FloatArray, IndexArray
from gearwhine.numerics.branch_following import (
    BranchPoint,
    along_branches,
    extended_branches,
    order_intervals,
    paired_modes,
    refined_crossing,
)
from gearwhine.rotors.analyses.harmonic_response import finite_values
from gearwhine.rotors.certificate import ACCEPTED
from gearwhine.rotors.errors import IncompleteModesError, require, require_finite
from gearwhine.rotors.model.bearing import Bearing
from gearwhine.rotors.model.shaft import Rotor
from gearwhine.rotors.whirl.circular_coordinates import coupled_motions
from gearwhine.rotors.whirl.completeness import NO_OSCILLATION, certified_roots, negative_count, oscillating
from gearwhine.rotors.whirl.eigenvalues import (
    NEAR,
    ExactRoots,
    Speed,
    apart,
    constant_speed,
    distinct,
    refine_each,
    refine_roots,
)
from gearwhine.rotors.whirl.equations import WhirlEquations, equations_at_speed, whirl_reach
from gearwhine.rotors.whirl.modal_projection import ModalProjection
from gearwhine.rotors.whirl.motion import ShaftMotion
from gearwhine.rotors.whirl.planar_basis import DEFAULT_COUNT
from gearwhine.rotors.whirl.whirl_modes import NEUTRAL, START_REACH, ComplexFrequencies, WhirlSolver

# Relative jump of an eigenvalue that costs as much as zero likeness, and the largest cost of a jump in such jumps.
JUMP_SCALE = 0.1
MOST_JUMPS = 100.0
# Relative jump of a frequency beyond which a branch ends.
LONGEST_JUMP = 0.5
# Number of speeds, spread over the range, at which damped sets are proved.
PROOFS = 3
# Factor on the limit up to which branches are followed at every speed.
WINDOW = 1.1
# Least relative gap between starting values; narrower gaps may vanish between the roots.
WIDE_GAP = 1e-3
# A branch point with whirl direction and axial share in place of the shape.
Point = BranchPoint[tuple[float, float]]
# Largest relative distance of a root from its starting value on the same branch.
CROSSING_JUMP = 0.1
CROSSING_STEPS = 30
CROSSING_TOLERANCE = 1e-11


@dataclass(frozen=True)
class Branch:
    """One mode over the speeds; NaN where it is not among the roots.

    Attributes
    ----------
    eigenvalues : ndarray of complex, shape (s,)
        Eigenvalues [rad/s].
    direction, axial_share : ndarray, shape (s,)
        Directions and shares as in `gearwhine.rotors.WhirlModes`.
    """

    eigenvalues: ComplexArray
    direction: FloatArray
    axial_share: FloatArray

    @property
    def first_frequency(self) -> float:
        """|λ| where the branch begins [rad/s]."""
        return float(np.abs(self.eigenvalues[np.isfinite(self.eigenvalues)][0]))


def followed(equations: WhirlEquations, roots: Sequence[ExactRoots], speeds: FloatArray) -> list[Branch]:
    """Branches through the roots (one set a speed) of one set of equations.

    A root's jump is its distance from the linear continuation of the branch; shapes are compared by the modal assurance
    criterion of the nodes' displacements.
    """
    inside = equations.layout.displacements.ravel()
    shapes = [root_set.solutions[:, inside] for root_set in roots]
    shapes = [root_set / np.maximum(np.linalg.norm(root_set, axis=1, keepdims=True), 1e-300) for root_set in shapes]
    table = np.zeros((0, 0), dtype=np.intp)
    for k, root_set in enumerate(roots):
        partner = np.zeros(0, dtype=np.intp)
        if k:
            expected = _continued(roots[max(k - 2, 0) : k], table, speeds[max(k - 2, 0) : k + 1])
            jump = np.abs(expected[:, None] - root_set.eigenvalues) / np.abs(root_set.eigenvalues)
            likeness = np.abs(shapes[k - 1].conj() @ shapes[k].T) ** 2
            partner = paired_modes(
                jump, likeness, jump_scale=JUMP_SCALE, most_jumps=MOST_JUMPS, longest_jump=LONGEST_JUMP
            )
        table = extended_branches(table, partner, root_set.eigenvalues.size)
    values = along_branches(table, [root_set.eigenvalues for root_set in roots], complex(np.nan, np.nan))
    ways = along_branches(table, _characters_of_all(equations, roots, speeds), np.nan)
    return [
        Branch(eigenvalues, direction, axial_share)
        for eigenvalues, direction, axial_share in zip(values.T, ways[:, :, 0].T, ways[:, :, 1].T, strict=True)
    ]


def characters(equations: WhirlEquations, roots: ExactRoots, speeds: FloatArray) -> FloatArray:
    """Whirl direction and axial share of roots at speeds, as in `gearwhine.rotors.WhirlModes`, (w, 2)."""
    if len(equations.blocks) == 1:
        return np.tile([float(equations.blocks[0]), 0.0 if equations.blocks[0] else 1.0], (roots.eigenvalues.size, 1))
    motion = ShaftMotion.of(equations, roots.eigenvalues, speeds.astype(np.complex128), roots.solutions, roots.scales)
    return np.stack([motion.direction, motion.axial_share], axis=-1)


def _characters_of_all(equations: WhirlEquations, roots: Sequence[ExactRoots], speeds: FloatArray) -> list[FloatArray]:
    sizes = [one.eigenvalues.size for one in roots]
    together = ExactRoots(
        np.concatenate([one.eigenvalues for one in roots]),
        np.concatenate([one.solutions for one in roots]),
        np.concatenate([one.residuals for one in roots]),
        np.concatenate([one.scales for one in roots]),
    )
    every = characters(equations, together, np.repeat(speeds, sizes))
    return np.split(every, np.cumsum(sizes)[:-1])


def _continued(roots: Sequence[ExactRoots], table: IndexArray, speeds: FloatArray) -> ComplexArray:
    """Linear continuation of the last speed's roots to the next speed, along the branches of a table, (w,).

    ``roots`` are the roots of the last two speeds, or of the first speed; ``speeds`` are their speeds and the next one.
    """
    expected = roots[-1].eigenvalues.copy()
    if len(roots) > 1:
        part = (speeds[2] - speeds[1]) / (speeds[1] - speeds[0])
        before, last = table[-2:, (table[-2] >= 0) & (table[-1] >= 0)]
        values = roots[1].eigenvalues[last]
        expected[last] = values + part * (values - roots[0].eigenvalues[before])
    return expected


def limits_behind(starts: Sequence[ComplexArray], frequency_limit: float | None, count: int | None) -> FloatArray:
    """Limit at every speed, (s,): a frequency in a gap above the wanted branches."""
    sizes = np.sort(np.abs(np.concatenate(starts, axis=1)), axis=1)
    if count is None:
        assert frequency_limit is not None
        return np.full(sizes.shape[0], frequency_limit)
    limits = np.empty(sizes.shape[0])
    for k, row in enumerate(sizes):
        ascending = row[np.isfinite(row)]
        last = min(count, ascending.size)
        # Starting values are not exact: a gap must be wide enough to be one.
        while last < ascending.size and ascending[last] < ascending[last - 1] * (1.0 + WIDE_GAP):
            last += 1
        beyond = ascending[last] if last < ascending.size else 1.01 * ascending[-1]
        limits[k] = np.sqrt(ascending[last - 1] * beyond)
    return limits


def roots_at_speeds(
    equation_sets: Sequence[WhirlEquations], values: ComplexArray, speeds: FloatArray, limits: FloatArray
) -> list[ExactRoots]:
    """Exact roots at every speed: separated ones of all speeds in one batch, clusters at their own speed."""
    chosen = [row[np.abs(row) < WINDOW * limit] for row, limit in zip(values, limits, strict=True)]
    same = all(equations is equation_sets[0] for equations in equation_sets)
    near = [not same or not apart(row, NEAR) for row in chosen]
    owner = np.concatenate([np.full(row.size, k) for k, row in enumerate(chosen)])
    alone = ~np.array(near)[owner]
    batch = refine_each(equation_sets[0], np.concatenate(chosen)[alone], speeds[owner[alone]])
    batch_owner = owner[alone]
    roots = []
    for k, row in enumerate(chosen):
        if near[k]:
            roots.append(refine_roots(equation_sets[k], row, constant_speed(float(speeds[k]))))
        else:
            roots_here = batch.take(batch_owner == k)
            good = roots_here.residuals <= ACCEPTED
            if not good.all():
                roots_here = refine_roots(equation_sets[k], roots_here.eigenvalues, constant_speed(float(speeds[k])))
            roots.append(distinct(roots_here))
    return roots


def proved_at(
    equation_sets: Sequence[WhirlEquations],
    roots: list[ExactRoots],
    speeds: FloatArray,
    least: float,
    limits: FloatArray,
    undriven: bool,
    prove_all: bool,
) -> BoolArray:
    """Prove the number of roots at every speed, or at a few; where one is missing it is searched for."""
    if undriven:
        chosen = np.arange(speeds.size)
        expected = _expected(equation_sets, speeds, least, limits)
        counts = [
            int(oscillating(least, float(limit)).holds(one.eigenvalues).sum())
            for one, limit in zip(roots, limits, strict=True)
        ]
        doubtful = np.flatnonzero(expected != np.array(counts))
    else:
        chosen = np.arange(speeds.size) if prove_all else np.linspace(0, speeds.size - 1, PROOFS).round().astype(int)
        doubtful = np.unique(chosen)
    for k in doubtful.tolist():
        sector = oscillating(least, float(limits[k]))
        inside, _ = certified_roots(equation_sets[k], roots[k], constant_speed(float(speeds[k])), sector, undriven)
        beyond = roots[k].take(~sector.holds(roots[k].eigenvalues))
        roots[k] = inside.joined(beyond)
    proved = np.zeros(speeds.size, dtype=np.bool_)
    proved[chosen] = True
    return proved


def _expected(
    equation_sets: Sequence[WhirlEquations], speeds: FloatArray, least: float, limits: FloatArray
) -> npt.NDArray[np.intp]:
    """Roots below the limits by inertia, (s,)."""
    if all(equations is equation_sets[0] for equations in equation_sets):
        twice = np.tile(speeds, 2).astype(np.complex128)
        counts = negative_count(equation_sets[0], np.concatenate([limits, np.full(speeds.size, least)]), Speed(twice))
        return np.asarray(counts[: speeds.size] - counts[speeds.size :])
    rows = [
        negative_count(equations, np.array([limit, least]), constant_speed(float(speed)))
        for equations, limit, speed in zip(equation_sets, limits, speeds, strict=True)
    ]
    return np.array([row[0] - row[1] for row in rows])


@dataclass(frozen=True)
class Crossing:
    """A speed at which a damped whirl frequency is a multiple of the speed of rotation.

    Attributes
    ----------
    speed : float
        Speed of rotation Ω [rad/s].
    eigenvalue : complex
        Exact eigenvalue λ with Im λ = order · Ω [rad/s].
    order : float
        Multiple of the speed.
    direction : float
        Whirl direction, as in `gearwhine.rotors.WhirlModes`.
    branch : int
        Index in the diagram.
    axial_share : float
        Axial share of the motion, as in `gearwhine.rotors.WhirlModes`.
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
class Campbell(ComplexFrequencies):
    """Whirl over speed, one column for each branch; NaN where a branch does not oscillate or is outside the range.

    Attributes
    ----------
    speeds : ndarray, shape (s,)
        Speed of rotation Ω of the rotor [rad/s].
    eigenvalues : ndarray of complex, shape (s, m)
        Eigenvalues [rad/s].
    direction : ndarray, shape (s, m)
        Direction of the whirl, 1 counter-clockwise, -1 clockwise. It is that of `gearwhine.rotors.WhirlModes`.
    axial_share : ndarray, shape (s, m)
        Share of motion along the axis in the kinetic energy of whirl.
    proved : ndarray of bool, shape (s,)
        Speeds at which the number of roots was proved.
    onset : (float, int) or None
        Stability limit: lowest speed of rotation, without its sense, from which a branch grows [rad/s], and that
        branch; None where all are stable.
    """

    speeds: FloatArray
    eigenvalues: ComplexArray
    direction: FloatArray
    axial_share: FloatArray
    proved: BoolArray
    solver: WhirlSolver = field(repr=False)
    blocks: tuple[tuple[int, ...], ...] = field(repr=False)
    onset: tuple[float, int] | None = None

    @property
    def unstable_from(self) -> float | None:
        """Lowest speed of rotation, without its sense, from which a mode grows [rad/s]; None where none does."""
        return None if self.onset is None else self.onset[0]

    def crossings(self, order: float = 1.0) -> tuple[Crossing, ...]:
        """Where branches cross Im λ = order · |Ω| within the range, each refined on the exact equations.

        Raises
        ------
        IncompleteModesError
            A crossing seen between two speeds cannot be refined; more speeds would separate it.
        """
        require_finite("order", order, positive=True)
        intervals = order_intervals(self.damped_frequencies, order, self.speeds)
        crossings = [self._crossing(branch, left, order) for left, branch in intervals]
        return tuple(sorted(crossings, key=lambda crossing: (abs(crossing.speed), crossing.branch)))

    def _crossing(self, branch: int, left: int, order: float) -> Crossing:
        """Find the crossing between two neighbouring speeds."""
        found = self._zero(branch, left, lambda value, speed: value.imag - order * abs(speed))
        if found is None:
            raise IncompleteModesError(
                f"the crossing of order {order:g} between {self.speeds[left]:g} and {self.speeds[left + 1]:g} rad/s "
                "does not settle; ask for more speeds about there"
            )
        return Crossing(found.speed, found.eigenvalue, order, found.shape[0], branch, found.shape[1])

    def stability_onset(self) -> tuple[float, int] | None:
        """Find the lowest speed from which a branch grows, Re λ = 0, refined on the exact equations, and that branch.

        A branch that grows at the lowest speed of the diagram, or from the first speed at which it oscillates, has its
        onset there. One that neither decays nor grows at the speed before has it at that speed.
        """
        # Branches that do not oscillate at a speed are NaN there, which compares as stable.
        ratios = -self.eigenvalues.real / np.abs(self.eigenvalues)
        rows, branches = np.nonzero(ratios < -NEUTRAL)
        if not rows.size:
            return None
        sizes = np.abs(self.speeds)
        first = sizes[rows].min()
        onsets = [
            (self._onset(row, branch), branch)
            for row, branch in zip(rows.tolist(), branches.tolist(), strict=True)
            if sizes[row] == first
        ]
        return min(onsets)

    def _onset(self, row: int, branch: int) -> float:
        """Speed without its sense from which a branch grows that does so at one speed, and at none nearer to rest."""
        before = row - 1 if self.speeds[row] > 0.0 else row + 1
        speed = float(abs(self.speeds[row]))
        if not 0 <= before < self.speeds.size or np.isnan(self.eigenvalues[before, branch]):
            return speed
        value = complex(self.eigenvalues[before, branch])
        if value.real >= -NEUTRAL * abs(value):
            return float(abs(self.speeds[before]))
        found = self._zero(branch, min(row, before), lambda value, speed: value.real)
        return speed if found is None else abs(found.speed)

    def _zero(self, branch: int, left: int, gap: Callable[[complex, float], float]) -> Point | None:
        """Find where a gap of λ and Ω vanishes between two neighbouring speeds, every λ refined on the exact equations.

        None where it does not settle.
        """
        speeds, ends = self.speeds[left : left + 2].tolist(), self.eigenvalues[left : left + 2, branch]
        equations = self._equations(branch, float(np.abs(ends).max()), max(abs(speeds[0]), abs(speeds[1])))

        def solve(part: float, low: Point, high: Point) -> Point | None:
            speed = low.speed + part * (high.speed - low.speed)
            own_equations = equations_at_speed(equations, self.solver.bearings, speed)
            start = np.array([low.eigenvalue + part * (high.eigenvalue - low.eigenvalue)])
            root = refine_each(own_equations, start, np.array([speed]))
            value = complex(root.eigenvalues[0])
            if root.residuals[0] > ACCEPTED or abs(value - start[0]) > CROSSING_JUMP * abs(value):
                return None
            direction, along = characters(own_equations, root, np.array([speed]))[0].tolist()
            return BranchPoint(speed, value, gap(value, speed), (direction, along))

        points = [
            BranchPoint(speed, value, gap(value, speed), (np.nan, np.nan))
            for speed, value in zip(speeds, ends.tolist(), strict=True)
        ]
        return refined_crossing(points[0], points[1], solve, tolerance=CROSSING_TOLERANCE, steps=CROSSING_STEPS)

    def _equations(self, branch: int, highest: float, speed: float) -> WhirlEquations:
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
    prove_all: bool = False,
    solver: WhirlSolver | None = None,
) -> Campbell:
    """Exact whirl modes over a range of speeds.

    Parameters
    ----------
    rotor, bearings : Rotor, sequence of Bearing
        The rotor and its bearings; tables over speed are read at each speed.
    speeds : array_like, shape (s,)
        Speeds of rotation Ω, ascending [rad/s].
    frequency_limit : float, optional
        Frequency below which a branch lies at some speed [rad/s].
    count : int, optional
        Number of branches, the lowest at every speed, instead of a limit; with neither, 12.
    prove_all : bool
        Whether the number of roots is proved at every speed where bearings damp, and not at a few only.
    solver : WhirlSolver, optional
        A `gearwhine.rotors.WhirlSolver` of the same rotor and bearings, whose basis and equations are used.

    Raises
    ------
    RotorError
        Wrong arguments, or a speed beyond a table.
    IncompleteModesError
        A proof fails.
    """
    turning = finite_values("speeds", speeds)
    rotor.require_speed(float(turning[np.abs(turning).argmax()]))
    require(bool((np.diff(turning) > 0.0).all()), "speeds", turning.tolist(), "ascending speeds")
    shared = WhirlSolver(rotor, bearings) if solver is None else solver
    same = shared.rotor is rotor and shared.bearings == tuple(bearings)
    require(same, "rotor of the solver", shared.rotor.name, f"{rotor.name}, on the same bearings")
    chosen = shared.planar_basis(frequency_limit, count)
    tabled = any(bearing.speeds is not None for bearing in bearings)
    at_speeds = [[b.at_speed(float(s)) for b in bearings] for s in turning] if tabled else [list(bearings)]
    sets = coupled_motions([bearing for row in at_speeds for bearing in row])
    wanted = None if frequency_limit is not None else count or DEFAULT_COUNT
    starts = []
    for blocks in sets:
        projection = ModalProjection.of(rotor, at_speeds[0], blocks, chosen)
        if tabled:
            rows = [projection.pencil(b).eigenvalues(turning[k : k + 1]) for k, b in enumerate(at_speeds)]
            values = np.concatenate(rows)
        else:
            values = projection.pencil(at_speeds[0]).eigenvalues(turning)
        oscillates = (values.imag > NO_OSCILLATION * np.abs(values)) & (
            np.abs(values) > NO_OSCILLATION * projection.floor
        )
        starts.append(np.where(oscillates, values, np.nan))
    limits = limits_behind(starts, frequency_limit, wanted)
    least = NO_OSCILLATION * chosen.floor
    undriven = shared.is_conservative_rotor([bearing for row in at_speeds for bearing in row])
    highest = max(whirl_reach(START_REACH * r, float(s)) for r, s in zip(limits, turning, strict=True))
    branches: list[Branch] = []
    owners: list[tuple[int, ...]] = []
    proved = np.ones(turning.size, dtype=np.bool_)
    for blocks, values in zip(sets, starts, strict=True):
        equations = shared.equations(at_speeds[0], blocks, highest)
        equation_sets = (
            [equations_at_speed(equations, row, 0.0) for row in at_speeds] if tabled else [equations] * turning.size
        )
        roots = roots_at_speeds(equation_sets, values, turning, limits)
        proved &= proved_at(equation_sets, roots, turning, least, limits, undriven, prove_all)
        for branch in followed(equations, roots, turning):
            if bool((np.abs(branch.eigenvalues) < limits).any()):
                branches.append(branch)
                owners.append(blocks)
    order = sorted(range(len(branches)), key=lambda k: branches[k].first_frequency)
    empty = np.zeros((turning.size, 0))
    diagram = Campbell(
        speeds=turning,
        eigenvalues=np.stack([branches[k].eigenvalues for k in order], axis=1) if order else empty.astype(complex),
        direction=np.stack([branches[k].direction for k in order], axis=1) if order else empty,
        axial_share=np.stack([branches[k].axial_share for k in order], axis=1) if order else empty,
        proved=proved,
        solver=shared,
        blocks=tuple(owners[k] for k in order),
    )
    return replace(diagram, onset=diagram.stability_onset())


def _inside(bearing: Bearing, speed: float) -> float:
    """Clip a speed [rad/s] to the range of a bearing's tables."""
    if bearing.speeds is None:
        return speed
    return float(np.clip(abs(speed), bearing.speeds[0], bearing.speeds[-1]))
