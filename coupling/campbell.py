"""The Campbell diagram of the whole machine: coupled modes over speed, and where the excitations meet them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from coupling.branches import ModesAtSpeed, matched
from coupling.contact_state import ContactState, linear_matrices, mean_contact
from coupling.crossings import order_crossing
from coupling.errors import CouplingError
from coupling.excitation import ExcitationLine, excitation_lines
from coupling.machine import CoupledMachine
from coupling.modes import coupled_modes
from rotors.branch_following import extended_branches

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_AT_REST = 1e-6  # of the highest speed, in place of zero: forward and backward whirl of a round shaft are then apart
_ABOVE = 1.15  # modes up to this over the limit are followed, so that none is lost that dips below it


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
        As in :class:`coupling.CoupledModes`.
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
        Those of :func:`coupling.excitation_lines` where not given.
    contact : ContactState, optional
        At every speed; that of :func:`coupling.mean_contact` under the machine's load where not given.
    progress : callable
        Told the part done.

    Raises
    ------
    CouplingError
        For speeds that do not ascend or a limit that is not positive.
    ModesError
        Where a mode fails its proof.
    """
    turning = np.asarray(speeds, dtype=np.float64)
    one_sense = turning.ndim == 1 and turning.size >= 2 and bool(np.all(np.diff(np.abs(turning)) > 0.0))
    if not (one_sense and np.all(turning * turning[-1] >= 0.0)):
        raise CouplingError(f"speeds {turning.tolist()} rad/s; expected two or more of one sense, ascending in size")
    if not frequency_limit > 0.0:
        raise CouplingError(f"a frequency limit of {frequency_limit:g} rad/s; expected it above 0")
    chosen = excitation_lines(machine) if lines is None else tuple(lines)
    stand_in = np.where(turning == 0.0, _AT_REST * turning[-1], turning)
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
    sizes = np.abs(_along(branches, [one.modes.values for one in known], np.nan))
    table = branches[:, np.any(sizes < frequency_limit, axis=0)]
    eigenvalues = _along(table, [one.modes.values for one in known], complex(np.nan, np.nan))
    kinds, where = (_along(table, [np.array(getattr(one, key)) for one in known], "") for key in ("kinds", "where"))
    whirl, teeth = (_along(table, [getattr(one, key) for one in known], np.nan) for key in ("whirl", "teeth"))
    crossings, unsettled = [], []
    for line in chosen:
        gap = eigenvalues.imag - line.order * np.abs(stand_in)[:, None]
        for left, branch in np.argwhere((gap[:-1] > 0.0) != (gap[1:] > 0.0)):
            if not np.all(np.isfinite(gap[left : left + 2, branch])):
                continue
            ends = [(known[i].modes, int(table[i, branch])) for i in (left, left + 1)]
            found = order_crossing(machine, line.order, ends, state)
            if found is None:
                unsettled.append(
                    f"{line.name} meets the mode at {eigenvalues[left, branch].imag / (2.0 * np.pi):.5g} Hz between "
                    f"{turning[left]:.6g} and {turning[left + 1]:.6g} rad/s, but where does not settle; more speeds "
                    "about there would tell"
                )
                continue
            speed, value = found
            if abs(value) < frequency_limit:
                at = int(left if abs(speed - stand_in[left]) < abs(speed - stand_in[left + 1]) else left + 1)
                named = (str(kinds[at, branch]), str(where[at, branch]), float(teeth[at, branch]))
                crossings.append(SystemCrossing(speed, line, value, int(branch), *named))
    return SystemCampbell(
        speeds=turning,
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
    """The oscillating modes below a limit at a speed."""
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


def _along(table: npt.NDArray[np.intp], values: Sequence[npt.NDArray[Any]], missing: Any) -> npt.NDArray[Any]:
    """Values of the modes at each speed along the branches, (s, b)."""
    columns = [
        np.where(row >= 0, of[np.maximum(row, 0)] if of.size else missing, missing)
        for row, of in zip(table, values, strict=True)
    ]
    return np.array(columns).reshape(table.shape)
