"""The transient: from static equilibrium through a time span, its record and the proof of it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.errors import TransientError
from coupling.march_run import Checkpoint
from coupling.marching import Block, march_blocks
from coupling.settings import TransientOutputs, TransientSettings
from coupling.system import CoupledSystem
from coupling.turning import Turning

FloatArray = npt.NDArray[np.float64]

ENERGY_BOUND = 1e-2
_ROUNDING = 1e-9  # part of the energy held that a balance cannot speak of


@dataclass(frozen=True)
class EnergyBalance:
    """Where the energy went [J].

    Attributes
    ----------
    change : float
        Of kinetic energy, springs and teeth together.
    loads : float
        Work of the loads.
    lost : float
        To damping.
    teeth : float
        Work of what turns: the stiffness and shape of the contacts change under load, rolling elements go round, and
        what slides rubs on the coordinates.
    scale : float
        The largest of these, of the swing of the energy held, and of the kinetic energy at any step.
    friction : float
        What friction between the teeth took from the nominal rotation, never negative: nearly all of it turned to heat,
        the rest came to the coordinates and is in ``teeth``. No part of the balance.
    """

    change: float
    loads: float
    lost: float
    teeth: float
    scale: float
    friction: float = 0.0

    @property
    def error(self) -> float:
        """What does not add up, as a part of the scale."""
        return abs(self.change - self.loads + self.lost - self.teeth) / self.scale if self.scale > 0.0 else 0.0


@dataclass(frozen=True)
class TransientFigures:
    """What a whole run comes to; c contacts.

    Attributes
    ----------
    mean_force, peak_force : ndarray, shape (c,)
        Over the recorded span, from every step [N].
    contact_loss : ndarray, shape (c,)
        Part of the recorded span in which the flanks were apart.
    energy : EnergyBalance
        Over the whole span.
    steps, rejected : int
        Steps taken and steps repeated.
    smallest_step : float
        [s].
    error : float
        Largest of the accepted error measures.
    seconds : float
        Time taken by the stepping, compilation apart [s].
    """

    mean_force: FloatArray
    peak_force: FloatArray
    contact_loss: FloatArray
    energy: EnergyBalance
    steps: int
    rejected: int
    smallest_step: float
    error: float
    seconds: float


@dataclass(frozen=True)
class TransientResult(TransientFigures):
    """Histories at even spacing, and the proof of them; s samples, c contacts.

    Attributes
    ----------
    times : ndarray, shape (s,)
        [s].
    displacement, velocity, acceleration : ndarray, shapes (s, k)
        The rows asked for.
    compression : ndarray, shape (s, c)
        δ of each contact [m].
    force : ndarray, shape (s, c)
        [N].
    """

    times: FloatArray
    displacement: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    compression: FloatArray
    force: FloatArray


def simulate(
    system: CoupledSystem,
    settings: TransientSettings,
    outputs: TransientOutputs,
    *,
    turning: Turning | None = None,
    initial: tuple[FloatArray, FloatArray] | None = None,
    progress: Callable[[float], None] = lambda fraction: None,
) -> TransientResult:
    """March the coupled system through time.

    Parameters
    ----------
    system : CoupledSystem
    settings : TransientSettings
    outputs : TransientOutputs
    turning : Turning, optional
        Speed over time; by default the nominal one all along.
    initial : tuple of ndarray, optional
        Coordinates and rates at t = 0, shape (n,) each; by default static equilibrium at rest.
    progress : callable
        Told the finished part of the span, from 0 to 1.

    Raises
    ------
    TransientError
        Where the motion diverges, the step would have to be absurdly small, or the energies do not balance.

    See Also
    --------
    march_blocks : The same, handing the record over piece by piece, for runs that are long or must be able to go on.
    """
    marched = march_blocks(system, settings, outputs, turning=turning, initial=initial, progress=progress)
    blocks = list(marched)
    figures = transient_figures(settings, blocks[-1].after)
    return TransientResult(
        **vars(figures),
        times=_joined(blocks, "times"),
        displacement=_joined(blocks, "displacement"),
        velocity=_joined(blocks, "velocity"),
        acceleration=_joined(blocks, "acceleration"),
        compression=_joined(blocks, "compression"),
        force=_joined(blocks, "force"),
    )


def transient_figures(settings: TransientSettings, end: Checkpoint) -> TransientFigures:
    """What a march came to at its end.

    Raises
    ------
    TransientError
        Where the energies do not balance.
    """
    # What rounding can do to the energy held is beyond any balance.
    held = max(end.highest - end.lowest, _ROUNDING * max(abs(end.highest), abs(end.lowest)))
    balance = _balance(end.energy - end.start_energy, end.totals, held)
    if balance.error > ENERGY_BOUND or end.unsettled > 0.01 * end.steps:
        raise TransientError(
            f"the energies do not balance: {100 * balance.error:.2g} % is missing, and {end.unsettled} of {end.steps} "
            "steps left the teeth's forces unsettled; lower the tolerance"
        )
    span = settings.duration - settings.record_from
    return TransientFigures(
        mean_force=end.contact_totals[:, 0] / span,
        peak_force=end.contact_totals[:, 2],
        contact_loss=end.contact_totals[:, 1] / span,
        energy=balance,
        steps=end.steps,
        rejected=end.rejected,
        smallest_step=end.smallest,
        error=end.worst,
        seconds=end.seconds,
    )


def _joined(blocks: list[Block], what: str) -> FloatArray:
    parts = [getattr(block, what) for block in blocks]
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _balance(change: float, totals: FloatArray, held: float) -> EnergyBalance:
    loads, lost, teeth, motion, friction = (float(value) for value in totals)
    # Free vibration swaps its energy between motion and springs without any of it coming or going.
    scale = max(abs(loads), abs(lost), abs(teeth), held, motion)
    return EnergyBalance(change, loads, lost, teeth, scale, friction)
