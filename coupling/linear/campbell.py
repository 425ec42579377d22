"""Campbell diagram of the whole machine: coupled modes followed over speed, and their crossings with excitations.

Modes are followed from speed to speed, through places where they cross and where they veer.

Two modes of neighbouring speeds count as the same where both their left and right vectors say so. With the
normalisation pᴴ (2 λ I + C) q = 1 the modes of one speed have pᵢᴴ ((λᵢ + λⱼ) I + C) qⱼ = δᵢⱼ, so that

    likeness = |pᵢᴴ ((λᵢ + μⱼ) I + C) rⱼ · sⱼᴴ ((λᵢ + μⱼ) I + D) qᵢ|

of a mode (λ, q, p) of C and one (μ, r, s) of D is 1 for one and the same and 0 for two of one system: the modal
assurance criterion of damped, gyroscopic modes. Where it decides nothing, speeds are put between: near enough to each
other, modes that veer change their shapes little by little, and those that cross keep them.

The crossing of an excitation order with a coupled mode (critical speed) is refined between two speeds of a branch to
ten digits.

Where directions turn with planet carriers, branches and crossings are those of frozen carriers. Beside them stand, at
some of the speeds, the Floquet exponents of the machine as it turns
(:mod:`gearwhine.coupling.linear.carriers.floquet_exponents`), and the frequencies at which fixed sensors see their
motions.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.linear.carriers.floquet_exponents import floquet_exponents, observed_frequencies
from gearwhine.coupling.linear.carriers.frozen_directions import frozen_warnings
from gearwhine.coupling.linear.carriers.turning_response import TurningResponse
from gearwhine.coupling.linear.complex_modes import coupled_modes
from gearwhine.coupling.linear.eigenpairs import pair_residuals, refine_pair
from gearwhine.coupling.linear.excitation_orders import ExcitationLine, excitation_lines
from gearwhine.coupling.statics.mean_mesh import ContactState, linear_matrices, mean_contact
from gearwhine.numerics.arrays import ComplexArray, FloatArray, IndexArray
from gearwhine.numerics.branch_following import (
    BranchPoint,
    along_branches,
    extended_branches,
    order_intervals,
    paired_modes,
    refined_crossing,
)
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import ResultWarning

Point = BranchPoint[ComplexArray]

_SURE_LIKENESS = 0.8  # likeness from which two modes are certainly the same
_SAME_EIGENVALUE_DISTANCE = 1e-6  # relative distance of eigenvalues below which their modes are not distinguished
_JUMP = 0.05  # relative step of an eigenvalue that costs as much as zero likeness
_MOST_JUMPS = 4.0  # largest cost of a step, in steps of `_JUMP`
_FARTHEST = 0.3  # relative step of a frequency beyond which a branch ends
_HALVINGS = 6  # largest number of halvings of a speed step
_CROSSING = 1e-10  # relative tolerance of a crossing's frequency
_STEPS = 40
_NEWTON_STEPS = 8
_RESIDUAL = 1e-9
_AT_REST = 1e-6  # part of the highest speed in place of zero, to separate forward and backward whirl
_TURNING_SPEEDS = 9  # speeds at which exponents with turning carriers are solved, at most
_TURNING_MODES = 24  # modes whose exponents are solved at each, the lowest
_ABOVE = 1.15  # factor on the limit up to which modes are followed, as some dip below the limit


@dataclass(frozen=True)
class ModesAtSpeed:
    """Oscillating modes at a speed, m of them.

    Attributes
    ----------
    speed : float
        Speed [rad/s].
    values : ndarray of complex, shape (m,)
    right, left : ndarray of complex, shapes (m, n)
        Vectors, normalised as in :class:`gearwhine.coupling.linear.eigenpairs.Eigenpairs`.
    damping : ndarray, shape (n, n)
        C at that speed.
    """

    speed: float
    values: ComplexArray
    right: ComplexArray
    left: ComplexArray
    damping: FloatArray


def likeness(modes: ModesAtSpeed, other: ModesAtSpeed) -> FloatArray:
    """Likeness of each mode at one speed and each mode at the other, shape (m, m'), 0 to 1."""
    return np.asarray(np.minimum(np.abs(_products(modes, other)), 1.0))


def _products(modes: ModesAtSpeed, other: ModesAtSpeed) -> ComplexArray:
    """Correlate modes by biorthogonality, with the phase: over modes of one eigenvalue the products add up."""
    sums = modes.values[:, None] + other.values[None, :]
    forward = sums * (modes.left.conj() @ other.right.T) + modes.left.conj() @ modes.damping @ other.right.T
    backward = sums * (modes.right @ other.left.conj().T) + modes.right @ other.damping.T @ other.left.conj().T
    return np.asarray(forward * backward)


def matched(
    modes: ModesAtSpeed,
    other: ModesAtSpeed,
    solve: Callable[[float], ModesAtSpeed],
    limit: float,
    halvings: int = _HALVINGS,
) -> IndexArray:
    """Index of the same mode at the other speed for each mode, or -1, shape (m,).

    Parameters
    ----------
    modes, other : ModesAtSpeed
    solve : callable
        Gives the modes at a speed in between.
    limit : float
        Frequency above which modes need not be distinguished [rad/s].
    halvings : int
        Largest number of halvings of the step.
    """
    products = _products(modes, other)
    alike = np.minimum(np.abs(products), 1.0)
    jump = np.abs(other.values[None, :] - modes.values[:, None]) / np.abs(modes.values)[:, None]
    partners = paired_modes(
        jump, alike, jump_scale=_JUMP, most_jumps=_MOST_JUMPS, longest_jump=_FARTHEST, sure_likeness=_SURE_LIKENESS
    )
    wanted = np.abs(modes.values) < limit
    # Modes with the same frequency at every speed, as of equal shafts, cannot be and need not be distinguished.
    gaps = np.abs(other.values[:, None] - other.values[None, :])
    together = np.abs(products @ (gaps <= _SAME_EIGENVALUE_DISTANCE * np.abs(other.values)))
    surest = np.where(partners >= 0, together[np.arange(partners.size), partners], 0.0)
    if halvings == 0 or not np.any(wanted & (surest < _SURE_LIKENESS)):
        return partners
    middle = solve(0.5 * (modes.speed + other.speed))
    first = matched(modes, middle, solve, limit, halvings - 1)
    second = matched(middle, other, solve, limit, halvings - 1)
    return np.where(first >= 0, second[first], -1)


Matrices = Callable[[float], tuple[FloatArray, FloatArray]]
"""Stiffness K [1/s²] and damping C [1/s] of a machine at a speed [rad/s]."""


def order_crossing(
    matrices: Matrices, order: float, ends: Sequence[tuple[ModesAtSpeed, int]]
) -> tuple[float, complex] | None:
    """Speed and eigenvalue at which a branch has the frequency of an order, between two neighbouring speeds.

    Newton's method on the eigenpair and the speed together; where that leads away, the speed is bracketed, and at each
    trial speed Newton's method on the eigenpair starts between the neighbours. The result is None where that leads away
    from the branch, too.

    Parameters
    ----------
    matrices : callable
        Matrices of the machine at a speed.
    order : float
        Frequency over the speed of the leading rotor.
    ends : two of (ModesAtSpeed, int)
        Modes at the speeds on either side, and the place of the branch among them.
    """

    def point(speed: float, value: complex, shape: ComplexArray) -> Point:
        # Shapes are known up to a factor; each is rotated in phase with the first before they are averaged.
        aligned = np.asarray(shape * np.exp(-1j * np.angle(np.vdot(first, shape))))
        return BranchPoint(speed, value, value.imag - order * abs(speed), aligned)

    def solve(part: float, low: Point, high: Point) -> Point | None:
        speed = low.speed + part * (high.speed - low.speed)
        start = low.eigenvalue + part * (high.eigenvalue - low.eigenvalue)
        shape = (1.0 - part) * low.shape + part * high.shape
        value, shape, residual = refine_pair(*matrices(speed), start, shape)
        if residual > _RESIDUAL or not _between(value, (low.eigenvalue, high.eigenvalue)):
            return None
        return point(speed, value, shape)

    first = ends[0][0].right[ends[0][1]]
    low, high = (point(modes.speed, complex(modes.values[at]), modes.right[at]) for modes, at in ends)
    crossing = _crossing_by_newton(matrices, order, low, high)
    if crossing is not None:
        return crossing
    bracketed = refined_crossing(low, high, solve, tolerance=_CROSSING, steps=_STEPS)
    return None if bracketed is None else (bracketed.speed, bracketed.eigenvalue)


def _crossing_by_newton(matrices: Matrices, order: float, low: Point, high: Point) -> tuple[float, complex] | None:
    """Solve (λ² I + λ C(Ω) + K(Ω)) q = 0, uᴴ q = 1 and Im λ = n |Ω| by Newton's method; None where it leads away.

    Derivatives by Ω are those of the chord between both ends.
    """
    part = low.gap / (low.gap - high.gap)
    speed = low.speed + part * (high.speed - low.speed)
    value = low.eigenvalue + part * (high.eigenvalue - low.eigenvalue)
    shape = (1.0 - part) * low.shape + part * high.shape
    slopes = [
        (b - a) / (high.speed - low.speed) for a, b in zip(matrices(low.speed), matrices(high.speed), strict=True)
    ]
    n, sense = len(shape), np.sign(high.speed)
    bordered = np.zeros((n + 1, n + 1), dtype=np.complex128)
    for _ in range(_NEWTON_STEPS):
        shape = shape / np.linalg.norm(shape)
        stiffness, damping = matrices(speed)
        gap = value.imag - order * abs(speed)
        residual = float(pair_residuals(stiffness, damping, np.array([value]), shape[None])[0])
        if residual <= _RESIDUAL and abs(gap) <= _CROSSING * abs(value):
            return (speed, value) if _between(value, (low.eigenvalue, high.eigenvalue)) else None
        dynamic = stiffness + value * damping
        dynamic[np.diag_indices(n)] += value**2
        bordered[:n, :n], bordered[n, :n] = dynamic, shape.conj()
        bordered[:n, n] = 2.0 * value * shape + damping @ shape
        loads = np.zeros((n + 1, 2), dtype=np.complex128)
        loads[:n, 0], loads[:n, 1] = -dynamic @ shape, -(slopes[0] @ shape + value * (slopes[1] @ shape))
        try:
            still, over_speed = np.linalg.solve(bordered, loads).T
        except np.linalg.LinAlgError:
            return None
        step = (gap + still[n].imag) / (order * sense - over_speed[n].imag)
        shape, value = shape + still[:n] + step * over_speed[:n], complex(value + still[n] + step * over_speed[n])
        speed = float(speed + step)
        if not min(low.speed, high.speed) <= speed <= max(low.speed, high.speed):
            return None
    return None


def _between(value: complex, ends: Sequence[complex]) -> bool:
    """Whether an eigenvalue is near those of its branch on both sides, and so not on another branch."""
    reach = 2.0 * abs(ends[1] - ends[0]) + 1e-3 * abs(ends[0])
    return min(abs(value - end) for end in ends) <= reach


@dataclass(frozen=True)
class SystemCrossing:
    """A speed at which an excitation has the damped frequency of a mode.

    Attributes
    ----------
    speed : float
        Speed of the leading rotor, the first driver's, at the crossing [rad/s], signed as in the diagram.
    line : ExcitationLine
    eigenvalue : complex
        Eigenvalue λ [1/s] with Im λ = order |Ω|.
    branch : int
    kind, where : str
        Kind and place of the mode, at the nearest speed of the diagram.
    teeth : float
        Share of the gear meshes in the mode's strain energy there.
    """

    speed: float
    line: ExcitationLine
    eigenvalue: complex
    branch: int
    kind: str
    where: str
    teeth: float

    @property
    def damping_ratio(self) -> float:
        """Damping ratio at the crossing, -Re λ / |λ|."""
        return float(-self.eigenvalue.real / abs(self.eigenvalue))


@dataclass(frozen=True)
class SystemCampbell:
    """Coupled modes at s speeds along b branches; NaN and empty words where a branch does not exist.

    Attributes
    ----------
    speeds : ndarray, shape (s,)
        Speed of the leading rotor, the first driver's [rad/s].
    eigenvalues : ndarray of complex, shape (s, b)
        λ [1/s].
    kinds, where : ndarray of str, shape (s, b)
        Kinds and places as in :class:`gearwhine.coupling.linear.complex_modes.CoupledModes`.
    whirl : ndarray, shape (s, b)
        Whirl sense about +z of the rotor that whirls most.
    teeth : ndarray, shape (s, b)
        Share of the gear meshes in the strain energy.
    lines : tuple of ExcitationLine
    crossings : tuple of SystemCrossing
        Crossings in the order of speed.
    unsettled : tuple of str
        Crossings between two speeds that no refinement could prove, in words.
    limit : float
        Highest frequency that was followed [rad/s].
    warnings : tuple of dict
        Warnings: that its branches are those of frozen carriers.
    exponents : ndarray of complex, shape (s, b), or None
        Floquet exponents of the machine as its carriers turn [1/s], NaN where they are not solved; None where no
        directions turn.
    observed : ndarray, shape (s, b), or None
        Frequencies at which the machine's sensors, which stand still, see these motions most [rad/s]; None without
        sensors too.
    """

    speeds: FloatArray
    eigenvalues: ComplexArray
    kinds: npt.NDArray[np.str_]
    where: npt.NDArray[np.str_]
    whirl: FloatArray
    teeth: FloatArray
    lines: tuple[ExcitationLine, ...]
    crossings: tuple[SystemCrossing, ...]
    unsettled: tuple[str, ...]
    limit: float
    warnings: tuple[ResultWarning, ...] = ()
    exponents: ComplexArray | None = None
    observed: FloatArray | None = None

    @property
    def turning_frequencies_hz(self) -> FloatArray | None:
        """Damped frequencies Im λ / 2π of the exponents [Hz], shape (s, b)."""
        return None if self.exponents is None else np.asarray(self.exponents.imag / (2.0 * np.pi))

    @property
    def turning_damping_ratios(self) -> FloatArray | None:
        """-Re λ / |λ| of the exponents, shape (s, b)."""
        return None if self.exponents is None else np.asarray(-self.exponents.real / np.abs(self.exponents))

    @property
    def observed_hz(self) -> FloatArray | None:
        """Frequencies at which fixed sensors see the motions of the exponents most [Hz], shape (s, b)."""
        return None if self.observed is None else np.asarray(self.observed / (2.0 * np.pi))

    @property
    def frequencies_hz(self) -> FloatArray:
        """Damped frequencies Im λ / 2π [Hz], shape (s, b): those that an excitation meets."""
        return np.asarray(self.eigenvalues.imag / (2.0 * np.pi))

    @property
    def damping_ratios(self) -> FloatArray:
        """-Re λ / |λ|, shape (s, b)."""
        return np.asarray(-self.eigenvalues.real / np.abs(self.eigenvalues))


def system_campbell(
    machine: CoupledMachine,
    speeds: Sequence[float] | FloatArray,
    *,
    frequency_limit: float,
    lines: Sequence[ExcitationLine] | None = None,
    contact: ContactState | None = None,
    progress: Progress = silent,
) -> SystemCampbell:
    """Follow the coupled modes about the mean contact over speed, and refine where excitations meet them.

    Parameters
    ----------
    machine : CoupledMachine
        Rotating machine; its rotors keep their speed ratios.
    speeds : sequence of float
        Signed speeds of the leading rotor [rad/s], two or more of one sense, ascending in size; zero may begin them.
    frequency_limit : float
        Frequency limit: branches below it at some speed are followed [rad/s].
    lines : sequence of ExcitationLine, optional
        Lines; by default those of :func:`gearwhine.coupling.linear.excitation_orders.excitation_lines`.
    contact : ContactState, optional
        Contact at every speed; by default :func:`gearwhine.coupling.statics.mean_mesh.mean_contact` under the machine's
        load.
    progress : callable

    Raises
    ------
    CouplingError
        For speeds that do not ascend or a limit that is not positive.
    ModesError
        Where a mode fails its proof.
    """
    leading_speeds = np.asarray(speeds, dtype=np.float64)
    one_sense = (
        leading_speeds.ndim == 1
        and leading_speeds.size >= 2
        and bool(np.all(np.isfinite(leading_speeds)))
        and bool(np.all(np.diff(np.abs(leading_speeds)) > 0.0))
    )
    if not (one_sense and np.all(np.sign(leading_speeds) * np.sign(leading_speeds[-1]) >= 0.0)):
        raise CouplingError(
            f"speeds {leading_speeds.tolist()} rad/s; expected two or more finite ones of one sense, ascending in size"
        )
    if not 0.0 < frequency_limit < np.inf:
        raise CouplingError(f"a frequency limit of {frequency_limit:g} rad/s; expected it above 0")
    chosen = excitation_lines(machine) if lines is None else tuple(lines)
    stand_in = np.where(leading_speeds == 0.0, _AT_REST * leading_speeds[-1], leading_speeds)
    limit = _ABOVE * frequency_limit
    state = mean_contact(machine.system) if contact is None else contact

    def solve(speed: float) -> ModesAtSpeed:
        return _described(machine, speed, limit, state).modes

    points: list[_Described] = []
    branches = np.zeros((0, 0), dtype=np.intp)
    for number, speed in enumerate(stand_in):
        described = _described(machine, float(speed), limit, state)
        partner = matched(points[-1].modes, described.modes, solve, limit) if points else np.zeros(0, dtype=np.intp)
        branches = extended_branches(branches, partner, described.modes.values.size)
        points.append(described)
        progress("coupled modes over speed", (number + 1) / stand_in.size)
    sizes = np.abs(along_branches(branches, [point.modes.values for point in points], np.nan))
    table = branches[:, np.any(sizes < frequency_limit, axis=0)]
    eigenvalues = along_branches(table, [point.modes.values for point in points], complex(np.nan, np.nan))
    kinds, where = (
        along_branches(table, [np.array(getattr(point, key)) for point in points], "") for key in ("kinds", "where")
    )
    whirl = along_branches(table, [point.whirl for point in points], np.nan)
    teeth = along_branches(table, [point.teeth for point in points], np.nan)
    crossings, unsettled = [], []
    matrices = lru_cache(maxsize=3)(
        lambda speed: linear_matrices(machine.at_speed(speed, keep_faces=True).system, state)
    )
    # Lines of one order, as those of equal planets, meet a branch at one speed.
    met: dict[tuple[int, int, float], tuple[float, complex] | None] = {}
    meetings = [
        (left, branch, line)
        for line in chosen
        for left, branch in order_intervals(eigenvalues.imag, line.order, stand_in)
    ]
    for number, (left, branch, line) in enumerate(sorted(meetings, key=lambda meeting: meeting[0])):
        if (left, branch, line.order) not in met:
            ends = [(points[i].modes, int(table[i, branch])) for i in (left, left + 1)]
            met[left, branch, line.order] = order_crossing(matrices, line.order, ends)
        progress("crossings with excitation orders", (number + 1) / len(meetings))
        crossing = met[left, branch, line.order]
        if crossing is None:
            unsettled.append(
                f"{line.name} meets the mode at {eigenvalues[left, branch].imag / (2.0 * np.pi):.5g} Hz between "
                f"{leading_speeds[left]:.6g} and {leading_speeds[left + 1]:.6g} rad/s, "
                "but the crossing does not converge; take more speeds about there"
            )
            continue
        speed, value = crossing
        if abs(value) < frequency_limit:
            at = left if abs(speed - stand_in[left]) < abs(speed - stand_in[left + 1]) else left + 1
            named = (str(kinds[at, branch]), str(where[at, branch]), float(teeth[at, branch]))
            crossings.append(SystemCrossing(speed, line, value, branch, *named))
    exponents, observed, effect = None, None, None
    if machine.system.turns:
        exponents, observed = _turning(machine, points, table, kinds, state, frequency_limit, progress)
        effect = _error_of_frozen_carriers(leading_speeds, eigenvalues, exponents)
    return SystemCampbell(
        speeds=leading_speeds,
        eigenvalues=eigenvalues,
        kinds=kinds,
        where=where,
        whirl=whirl,
        teeth=teeth,
        lines=chosen,
        crossings=tuple(sorted(crossings, key=lambda one: (abs(one.speed), one.line.order))),
        unsettled=tuple(unsettled),
        limit=frequency_limit,
        warnings=frozen_warnings(
            machine.system, "the natural frequencies of the Campbell diagram, and its crossings,", effect
        ),
        exponents=exponents,
        observed=observed,
    )


def _turning(
    machine: CoupledMachine,
    points: Sequence["_Described"],
    table: IndexArray,
    kinds: npt.NDArray[np.str_],
    contact: ContactState,
    limit: float,
    progress: Progress,
) -> tuple[ComplexArray, FloatArray | None]:
    """Exponents of the lowest modes at some of the speeds, and at which frequencies sensors see them."""
    exponents = np.full(table.shape, complex(np.nan, np.nan))
    observed = np.full(table.shape, np.nan)
    sensors = np.array(list(machine.sensor_rows.values()))
    chosen = np.unique(np.linspace(0, len(points) - 1, _TURNING_SPEEDS).astype(int))
    for turn, number in enumerate(chosen):
        modes = points[number].modes
        values = along_branches(table[[number]], [modes.values], complex(np.nan, np.nan))[0]
        proper = ~np.isin(kinds[number], ("", "residual", "rigid")) & (np.abs(values) < limit)
        lowest = np.flatnonzero(proper)
        lowest = lowest[np.argsort(np.abs(values[lowest]), kind="stable")][:_TURNING_MODES]
        own = table[number, lowest]
        model = TurningResponse(machine.at_speed(modes.speed, keep_faces=True).system, contact)
        found = floquet_exponents(
            model, modes.values[own], modes.right[own], modes.left[own], _one_of(len(chosen), turn, progress)
        )
        exponents[number, lowest] = found
        if sensors.size:
            observed[number, lowest] = observed_frequencies(model, found, modes.right[own], sensors)
    return exponents, observed if sensors.size else None


def _one_of(count: int, number: int, progress: Progress) -> Progress:
    """Progress of one of several equal parts of a work, as progress of that work."""

    def report(message: str, fraction: float | None = None) -> None:
        progress(message, (number + (fraction or 0.0)) / count)

    return report


def _error_of_frozen_carriers(speeds: FloatArray, frozen: ComplexArray, exponents: ComplexArray) -> str | None:
    """Return the largest error of a frozen frequency in words; None where no exponent is solved."""
    if np.all(np.isnan(exponents)):
        return None
    errors = np.abs(frozen) / np.abs(exponents) - 1.0
    at, branch = np.unravel_index(int(np.nanargmax(np.abs(errors))), errors.shape)
    return (
        f"beside them stand the exponents with turning carriers at {np.count_nonzero(~np.isnan(errors).all(axis=1))} "
        f"speeds, from which the largest error of a frequency is {100.0 * errors[at, branch]:+.2g} %, of the mode at "
        f"{abs(exponents[at, branch]) / (2.0 * np.pi):.5g} Hz and {abs(speeds[at]) * 60.0 / (2.0 * np.pi):.0f} rpm"
    )


@dataclass(frozen=True)
class _Described:
    """Oscillating modes at a speed with kind, place, whirl and mesh share of each."""

    modes: ModesAtSpeed
    kinds: tuple[str, ...]
    where: tuple[str, ...]
    whirl: FloatArray
    teeth: FloatArray


def _described(machine: CoupledMachine, speed: float, limit: float, contact: ContactState) -> _Described:
    """Return the oscillating modes below a limit at a speed."""
    system = machine.at_speed(speed, keep_faces=True).system
    modes = coupled_modes(system, contact)
    damping = linear_matrices(system, contact)[1]
    chosen = np.flatnonzero((modes.eigenvalues.imag > 0.0) & (np.abs(modes.eigenvalues) < limit))
    bending = np.where(np.isnan(modes.whirl[chosen]), -1.0, modes.shares.kinetic[chosen])
    most = np.argmax(bending, axis=1)
    contacts = np.array([part.kind == "contact" for part in modes.shares.parts])
    return _Described(
        modes=ModesAtSpeed(speed, modes.eigenvalues[chosen], modes.shapes[chosen], modes.left[chosen], damping),
        kinds=tuple(modes.kinds[i] for i in chosen),
        where=tuple(modes.where[i] for i in chosen),
        whirl=modes.whirl[chosen, most],
        teeth=modes.shares.strain[chosen][:, contacts].sum(axis=1),
    )
