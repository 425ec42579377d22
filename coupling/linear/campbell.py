"""Campbell diagram of the whole machine: coupled modes followed over speed, and their crossings with excitations.

Modes are followed from speed to speed, through places where they cross and where they veer.

Two modes of neighbouring speeds are held for one where both of their left and right vectors say so. With the
normalisation pᴴ (2 λ I + C) q = 1 the modes of one speed have pᵢᴴ ((λᵢ + λⱼ) I + C) qⱼ = δᵢⱼ, so that

    likeness = |pᵢᴴ ((λᵢ + μⱼ) I + C) rⱼ · sⱼᴴ ((λᵢ + μⱼ) I + D) qᵢ|

of a mode (λ, q, p) of C and one (μ, r, s) of D is 1 for one and the same and 0 for two of one system: the modal
assurance criterion of damped, gyroscopic modes. Where it decides nothing, speeds are put between: near enough to each
other, modes that veer change their shapes little by little, and those that cross keep them.

The crossing of an excitation order with a coupled mode (critical speed) is refined between two speeds of a branch to
ten digits.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.assembly import CoupledMachine
from coupling.errors import CouplingError
from coupling.linear.complex_modes import coupled_modes
from coupling.linear.eigenpairs import refine_pair
from coupling.linear.excitation_orders import ExcitationLine, excitation_lines
from coupling.statics.mean_mesh import ContactState, linear_matrices, mean_contact
from rotors.numerics.branch_following import (
    BranchPoint,
    along_branches,
    extended_branches,
    order_intervals,
    paired_modes,
    refined_crossing,
)

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]
Point = BranchPoint[ComplexArray]

_ALIKE = 0.8  # likeness from which two modes are one beyond doubt
_ONE = 1e-6  # eigenvalues nearer to each other than this part of them are not told apart
_JUMP = 0.05  # a step of an eigenvalue by this part of it weighs as much as no likeness at all
_MOST_JUMPS = 4.0  # such steps, beyond which the length of a step makes no further difference
_FARTHEST = 0.3  # a branch that would have to jump by this part of its frequency has ended
_HALVINGS = 6  # of a step of speed
_CROSSING = 1e-10  # of a frequency, to which a crossing is found
_STEPS = 40
_RESIDUAL = 1e-9
_AT_REST = 1e-6  # of the highest speed, in place of zero: forward and backward whirl of a round shaft are then apart
_ABOVE = 1.15  # modes up to this over the limit are followed, so that none is lost that dips below it


@dataclass(frozen=True)
class ModesAtSpeed:
    """Oscillating modes at a speed, m of them.

    Attributes
    ----------
    speed : float
        [rad/s].
    values : ndarray of complex, shape (m,)
    right, left : ndarray of complex, shapes (m, n)
        Normalised as in :class:`coupling.linear.eigenpairs.Eigenpairs`.
    damping : ndarray, shape (n, n)
        C at that speed.
    """

    speed: float
    values: ComplexArray
    right: ComplexArray
    left: ComplexArray
    damping: FloatArray


def likeness(one: ModesAtSpeed, other: ModesAtSpeed) -> FloatArray:
    """How far each mode of one is each of the other, shape (m, m'), 0 to 1."""
    return np.asarray(np.minimum(np.abs(_products(one, other)), 1.0))


def _products(one: ModesAtSpeed, other: ModesAtSpeed) -> ComplexArray:
    """Correlate modes by biorthogonality, with the phase: over modes of one eigenvalue the products add up."""
    sums = one.values[:, None] + other.values[None, :]
    there = sums * (one.left.conj() @ other.right.T) + one.left.conj() @ one.damping @ other.right.T
    back = sums * (one.right @ other.left.conj().T) + one.right @ other.damping.T @ other.left.conj().T
    return np.asarray(there * back)


def matched(
    one: ModesAtSpeed,
    other: ModesAtSpeed,
    solve: Callable[[float], ModesAtSpeed],
    limit: float,
    halvings: int = _HALVINGS,
) -> IntArray:
    """For each mode of one the place of the same mode in the other, or -1, shape (m,).

    Parameters
    ----------
    one, other : ModesAtSpeed
    solve : callable
        The modes at a speed between.
    limit : float
        Modes above it [rad/s] need not be told apart.
    halvings : int
        How often the step may be halved.
    """
    products = _products(one, other)
    alike = np.minimum(np.abs(products), 1.0)
    jump = np.abs(other.values[None, :] - one.values[:, None]) / np.abs(one.values)[:, None]
    found = paired_modes(
        jump, alike, jump_scale=_JUMP, most_jumps=_MOST_JUMPS, longest_jump=_FARTHEST, sure_likeness=_ALIKE
    )
    wanted = np.abs(one.values) < limit
    # Of modes that have one frequency at every speed, as of equal shafts, no step tells which is which: nor need it.
    gaps = np.abs(other.values[:, None] - other.values[None, :])
    together = np.abs(products @ (gaps <= _ONE * np.abs(other.values)))
    surest = np.where(found >= 0, together[np.arange(found.size), found], 0.0)
    if halvings == 0 or not np.any(wanted & (surest < _ALIKE)):
        return found
    middle = solve(0.5 * (one.speed + other.speed))
    first = matched(one, middle, solve, limit, halvings - 1)
    second = matched(middle, other, solve, limit, halvings - 1)
    return np.where(first >= 0, second[first], -1)


def order_crossing(
    machine: CoupledMachine, order: float, ends: Sequence[tuple[ModesAtSpeed, int]], contact: ContactState
) -> tuple[float, complex] | None:
    """Speed and eigenvalue where a branch has the frequency of an order, between two neighbours on it.

    At each speed on the way Newton's method on the eigenpair begins between its neighbours. None where that leads away
    from the branch.

    Parameters
    ----------
    machine : CoupledMachine
    order : float
        Frequency over the speed of the leading rotor.
    ends : two of (ModesAtSpeed, int)
        Modes at the speeds on either side, and the place of the branch among them.
    contact : ContactState
        Of all speeds.
    """

    def point(speed: float, value: complex, shape: ComplexArray) -> Point:
        # Shapes are known up to a factor; each is turned into line with the first, to be averaged with others.
        aligned = np.asarray(shape * np.exp(-1j * np.angle(np.vdot(first, shape))))
        return BranchPoint(speed, value, value.imag - order * abs(speed), aligned)

    def solve(part: float, low: Point, high: Point) -> Point | None:
        speed = low.speed + part * (high.speed - low.speed)
        stiffness, damping = linear_matrices(machine.at_speed(speed).system, contact)
        start = low.eigenvalue + part * (high.eigenvalue - low.eigenvalue)
        shape = (1.0 - part) * low.shape + part * high.shape
        value, shape, residual = refine_pair(stiffness, damping, start, shape)
        if residual > _RESIDUAL or not _between(value, (low.eigenvalue, high.eigenvalue)):
            return None
        return point(speed, value, shape)

    first = ends[0][0].right[ends[0][1]]
    low, high = (point(modes.speed, complex(modes.values[at]), modes.right[at]) for modes, at in ends)
    found = refined_crossing(low, high, solve, tolerance=_CROSSING, steps=_STEPS)
    return None if found is None else (found.speed, found.eigenvalue)


def _between(value: complex, ends: Sequence[complex]) -> bool:
    """Whether an eigenvalue is near two on its branch, and not one of another branch."""
    reach = 2.0 * abs(ends[1] - ends[0]) + 1e-3 * abs(ends[0])
    return min(abs(value - end) for end in ends) <= reach


@dataclass(frozen=True)
class SystemCrossing:
    """A speed at which an excitation has the damped frequency of a mode.

    Attributes
    ----------
    speed : float
        Of the leading rotor [rad/s], signed as in the diagram.
    line : ExcitationLine
    eigenvalue : complex
        λ there [1/s], with Im λ = order |Ω|.
    branch : int
    kind, where : str
        The mode's, at the nearest speed of the diagram.
    teeth : float
        The gear meshes' share of its strain energy there.
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
        """-Re λ / |λ|."""
        return float(-self.eigenvalue.real / abs(self.eigenvalue))


@dataclass(frozen=True)
class SystemCampbell:
    """Coupled modes at s speeds along b branches; NaN and empty words where a branch is not.

    Attributes
    ----------
    speeds : ndarray, shape (s,)
        Of the leading rotor [rad/s].
    eigenvalues : ndarray of complex, shape (s, b)
        λ [1/s].
    kinds, where : ndarray of str, shape (s, b)
        As in :class:`coupling.linear.complex_modes.CoupledModes`.
    whirl : ndarray, shape (s, b)
        Sense of the bending of the rotor that whirls most, about +z.
    teeth : ndarray, shape (s, b)
        The gear meshes' share of the strain energy.
    lines : tuple of ExcitationLine
    crossings : tuple of SystemCrossing
        By speed.
    unsettled : tuple of str
        Crossings seen between two speeds that no refinement could prove, in words.
    limit : float
        Highest frequency that was followed [rad/s].
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
    progress: Callable[[float], None] = lambda fraction: None,
) -> SystemCampbell:
    """Follow the coupled modes about the mean contact over speed, and refine where excitations meet them.

    Parameters
    ----------
    machine : CoupledMachine
        That turns; its rotors keep their ratios.
    speeds : sequence of float
        Signed speeds of the leading rotor [rad/s], two or more of one sense, ascending in size; zero may begin them.
    frequency_limit : float
        Branches below it at some speed are followed [rad/s].
    lines : sequence of ExcitationLine, optional
        Those of :func:`coupling.linear.excitation_orders.excitation_lines` where not given.
    contact : ContactState, optional
        At every speed; :func:`coupling.statics.mean_mesh.mean_contact` under the machine's load where not given.
    progress : callable
        Called with the finished part, from 0 to 1.

    Raises
    ------
    CouplingError
        For speeds that do not ascend or a limit that is not positive.
    ModesError
        Where a mode fails its proof.
    """
    leading_speeds = np.asarray(speeds, dtype=np.float64)
    one_sense = (
        leading_speeds.ndim == 1 and leading_speeds.size >= 2 and bool(np.all(np.diff(np.abs(leading_speeds)) > 0.0))
    )
    if not (one_sense and np.all(leading_speeds * leading_speeds[-1] >= 0.0)):
        raise CouplingError(
            f"speeds {leading_speeds.tolist()} rad/s; expected two or more of one sense, ascending in size"
        )
    if not frequency_limit > 0.0:
        raise CouplingError(f"a frequency limit of {frequency_limit:g} rad/s; expected it above 0")
    chosen = excitation_lines(machine) if lines is None else tuple(lines)
    stand_in = np.where(leading_speeds == 0.0, _AT_REST * leading_speeds[-1], leading_speeds)
    limit = _ABOVE * frequency_limit
    state = mean_contact(machine.system) if contact is None else contact

    def solve(speed: float) -> ModesAtSpeed:
        return _described(machine, speed, limit, state).modes

    known: list[_Described] = []
    branches = np.zeros((0, 0), dtype=np.intp)
    for number, speed in enumerate(stand_in):
        here = _described(machine, float(speed), limit, state)
        partner = matched(known[-1].modes, here.modes, solve, limit) if known else np.zeros(0, dtype=np.intp)
        branches = extended_branches(branches, partner, here.modes.values.size)
        known.append(here)
        progress((number + 1) / stand_in.size)
    sizes = np.abs(along_branches(branches, [one.modes.values for one in known], np.nan))
    table = branches[:, np.any(sizes < frequency_limit, axis=0)]
    eigenvalues = along_branches(table, [one.modes.values for one in known], complex(np.nan, np.nan))
    kinds, where = (
        along_branches(table, [np.array(getattr(one, key)) for one in known], "") for key in ("kinds", "where")
    )
    whirl = along_branches(table, [one.whirl for one in known], np.nan)
    teeth = along_branches(table, [one.teeth for one in known], np.nan)
    crossings, unsettled = [], []
    for line in chosen:
        for left, branch in order_intervals(eigenvalues.imag, line.order, stand_in):
            ends = [(known[i].modes, int(table[i, branch])) for i in (left, left + 1)]
            found = order_crossing(machine, line.order, ends, state)
            if found is None:
                unsettled.append(
                    f"{line.name} meets the mode at {eigenvalues[left, branch].imag / (2.0 * np.pi):.5g} Hz between "
                    f"{leading_speeds[left]:.6g} and {leading_speeds[left + 1]:.6g} rad/s, "
                    "but the crossing does not converge; take more speeds about there"
                )
                continue
            speed, value = found
            if abs(value) < frequency_limit:
                at = left if abs(speed - stand_in[left]) < abs(speed - stand_in[left + 1]) else left + 1
                named = (str(kinds[at, branch]), str(where[at, branch]), float(teeth[at, branch]))
                crossings.append(SystemCrossing(speed, line, value, branch, *named))
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
    )


@dataclass(frozen=True)
class _Described:
    """Oscillating modes at a speed with what names them, one entry for each."""

    modes: ModesAtSpeed
    kinds: tuple[str, ...]
    where: tuple[str, ...]
    whirl: FloatArray
    teeth: FloatArray


def _described(machine: CoupledMachine, speed: float, limit: float, contact: ContactState) -> _Described:
    """Return the oscillating modes below a limit at a speed."""
    system = machine.at_speed(speed).system
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
