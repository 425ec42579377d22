"""Time integration in blocks: the samples of each block, with the checkpoint from which the next one continues.

The driver is in :mod:`coupling.march_run`; its steppers are in :mod:`coupling.newmark_stepper` and
:mod:`coupling.exact_march`.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.boundaries import SAMPLES_PER_BLOCK
from coupling.condensation import condensed
from coupling.errors import CouplingError
from coupling.exact_march import CollocationStepper, exact_part
from coupling.fingerprint import fingerprint
from coupling.march_run import Checkpoint, Integration, sample_times
from coupling.newmark_stepper import NewmarkStepper
from coupling.settings import RECORDED, MotionRecord, TransientOutputs, TransientSettings
from coupling.step import empty_samples
from coupling.system import CoupledSystem
from coupling.turning import SpeedProfile

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Block(MotionRecord):
    """A block of the record, and the checkpoint after it.

    Attributes
    ----------
    first : int
        Number of its first sample.
    after : Checkpoint
    count : int
        Blocks of the whole run.
    """

    first: int
    after: Checkpoint
    count: int


def integrate_blocks(
    system: CoupledSystem,
    settings: TransientSettings,
    outputs: TransientOutputs,
    *,
    turning: SpeedProfile | None = None,
    initial: tuple[FloatArray, FloatArray] | None = None,
    after: Checkpoint | None = None,
    samples_per_block: int = SAMPLES_PER_BLOCK,
    progress: Callable[[float], None] = lambda fraction: None,
) -> Iterator[Block]:
    """Integrate the motion of the coupled system, and yield its record block by block.

    Parameters
    ----------
    after : Checkpoint, optional
        Checkpoint to continue from, of the same run; see :func:`integration_key`.
    samples_per_block : int
        Approximate length of a block. Time is cut where blocks end, so the last digits of a result depend on it.

    Other parameters and errors are those of :func:`coupling.simulate`.
    """
    run, initial = _prepared(system, settings, outputs, turning, initial, samples_per_block)
    state = after or run.start(initial)
    total = settings.samples
    for number in range(state.block, len(run.ends) - 1):
        first = state.sample
        last = number == len(run.ends) - 2
        count = total - first if last else _samples_until(settings, float(run.ends[number + 1]), first, total)
        samples = empty_samples(run.arrays, settings.record_from, settings.sample_interval, first, count)
        state = run.through(number, state, samples, progress)
        written = slice(state.sample - first)
        yield Block(
            first=first,
            times=sample_times(settings, first, state.sample - first),
            **{name: getattr(samples, name)[written] for name in RECORDED[1:]},
            after=state,
            count=len(run.ends) - 1,
        )


def integration_key(
    system: CoupledSystem,
    settings: TransientSettings,
    outputs: TransientOutputs,
    *,
    turning: SpeedProfile | None = None,
    initial: tuple[FloatArray, FloatArray] | None = None,
    samples_per_block: int = SAMPLES_PER_BLOCK,
) -> str:
    """Digest of all inputs of a time integration: runs with the same key agree bit for bit.

    It does not cover the code and the processor: these must be stored with checkpoints as well.
    """
    run, initial = _prepared(system, settings, outputs, turning, initial, samples_per_block)
    start = run.start(initial).as_arrays()
    return fingerprint(settings, run.turning, run.arrays, run.base, run.ends, run.reach, run.bounds(0), start)


def _prepared(
    system: CoupledSystem,
    settings: TransientSettings,
    outputs: TransientOutputs,
    turning: SpeedProfile | None,
    initial: tuple[FloatArray, FloatArray] | None,
    samples_per_block: int,
) -> tuple[Integration, tuple[FloatArray, FloatArray] | None]:
    """Integration of the condensed coordinates by the method that the settings ask for, and their initial state."""
    if samples_per_block < 1:
        raise CouplingError(f"blocks of {samples_per_block} samples; expected at least one")
    followed = condensed(system)
    if followed.system is not system:
        system, rows = followed.system, (outputs.displacement, outputs.velocity, outputs.acceleration)
        outputs = TransientOutputs(*(row @ followed.recovery for row in rows))
        initial = None if initial is None else (initial[0][followed.kept], initial[1][followed.kept])
    turning = turning or SpeedProfile.steady()
    part = exact_part(system, settings, turning)
    stepper = (
        NewmarkStepper(system, settings, outputs, turning)
        if part is None
        else CollocationStepper(part, settings, outputs, turning)
    )
    return Integration(stepper, settings, turning, samples_per_block), initial


def _samples_until(settings: TransientSettings, end: float, first: int, total: int) -> int:
    """Room for the samples up to the end of a block: rounding may let one more or less fall into it."""
    upto = int(np.ceil((end - settings.record_from) / settings.sample_interval)) + 2
    return min(max(upto - first, 0), total - first)
