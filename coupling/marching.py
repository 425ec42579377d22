"""The march through time, block by block: each block's samples with the state from which the next one goes on.

Newmark's steps are in :mod:`coupling.march_run`, the exact march between tooth events in :mod:`coupling.exact_march`.
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
from coupling.settings import TransientOutputs, TransientSettings
from coupling.step import empty_samples
from coupling.system import CoupledSystem
from coupling.turning import Turning

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Block:
    """A stretch of the record, s samples, and where the march stands after it.

    Attributes
    ----------
    first : int
        Number of its first sample.
    times : ndarray, shape (s,)
        [s].
    displacement, velocity, acceleration : ndarray, shapes (s, k)
        The rows asked for.
    compression, force : ndarray, shape (s, c)
        Of each contact [m], [N].
    after : Checkpoint
    count : int
        Blocks of the whole run.
    """

    first: int
    times: FloatArray
    displacement: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    compression: FloatArray
    force: FloatArray
    after: Checkpoint
    count: int


def march_blocks(
    system: CoupledSystem,
    settings: TransientSettings,
    outputs: TransientOutputs,
    *,
    turning: Turning | None = None,
    initial: tuple[FloatArray, FloatArray] | None = None,
    after: Checkpoint | None = None,
    samples_per_block: int = SAMPLES_PER_BLOCK,
    progress: Callable[[float], None] = lambda fraction: None,
) -> Iterator[Block]:
    """March the coupled system through time and hand its record over block by block.

    Parameters
    ----------
    after : Checkpoint, optional
        Go on from here: the march must be the one that led to it, see :func:`march_key`.
    samples_per_block : int
        About how many a block holds. Time is cut where blocks end, so the last digits of a result depend on it.

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
            displacement=samples.displacement[written],
            velocity=samples.velocity[written],
            acceleration=samples.acceleration[written],
            compression=samples.compression[written],
            force=samples.force[written],
            after=state,
            count=len(run.ends) - 1,
        )


def march_key(
    system: CoupledSystem,
    settings: TransientSettings,
    outputs: TransientOutputs,
    *,
    turning: Turning | None = None,
    initial: tuple[FloatArray, FloatArray] | None = None,
    samples_per_block: int = SAMPLES_PER_BLOCK,
) -> str:
    """A digest of all that decides how a march goes, so that two with the same key go alike, bit for bit.

    It knows nothing of the code and of the processor: whoever keeps checkpoints must note these as well.
    """
    run, initial = _prepared(system, settings, outputs, turning, initial, samples_per_block)
    start = run.start(initial).as_arrays()
    return fingerprint(settings, run.turning, run.arrays, run.base, run.ends, run.reach, run.bounds(0), start)


def _prepared(
    system: CoupledSystem,
    settings: TransientSettings,
    outputs: TransientOutputs,
    turning: Turning | None,
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
    turning = turning or Turning.steady()
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
