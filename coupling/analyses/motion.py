"""Motion of a machine over time with what is read off its record: lines by origin, and orders along a run."""

from collections.abc import Callable
from dataclasses import dataclass

from gearwhine.coupling.analyses.loaded_machine import LoadedMachine
from gearwhine.coupling.analyses.recording import Blocks, TransientPlan
from gearwhine.coupling.analyses.run_up import OrderTracking, RunSignature, solve_run_signature
from gearwhine.coupling.analyses.signature import SolvedSignature, solve_signature
from gearwhine.coupling.analyses.transient import SolvedTransient, has_traced_lines, solve_transient
from gearwhine.coupling.linear.complex_modes import CoupledModes
from gearwhine.numerics.progress import Progress, silent


@dataclass(frozen=True)
class MachineMotion:
    """Motion of a machine over time, and what is read off its record.

    Attributes
    ----------
    transient : SolvedTransient
    signature : SolvedSignature or None
        Lines of sensors and mesh forces by their origin; None along a run, and where the base moves.
    run_signature : RunSignature or None
        Spectra and orders along a run.
    tracking : OrderTracking
    """

    transient: SolvedTransient
    signature: SolvedSignature | None
    run_signature: RunSignature | None
    tracking: OrderTracking


def solve_motion(
    machine: LoadedMachine,
    plan: TransientPlan,
    tracking: OrderTracking,
    modes: CoupledModes,
    progress: Progress = silent,
    *,
    keep: Callable[[str], Blocks] | None = None,
) -> MachineMotion:
    """Integrate the motion of a machine, and trace the lines and the orders of its record.

    The parameters are those of :func:`gearwhine.coupling.analyses.transient.solve_transient`; ``modes`` are those of
    the coupled system, which lines are named after.
    """
    transient = solve_transient(machine.coupled, plan, progress, keep=keep)
    signature = None
    if has_traced_lines(machine.coupled):
        housing = machine.coupled.housing
        signature = solve_signature(transient, modes, None if housing is None else housing.frequencies_hz)
    return MachineMotion(transient, signature, solve_run_signature(transient, tracking), tracking)
