"""Transient simulation: time integration from static equilibrium, its record and its energy balance."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from coupling.errors import TransientError
from coupling.march_run import Checkpoint
from coupling.marching import integrate_blocks
from coupling.settings import RECORDED, MotionRecord, TransientOutputs, TransientSettings
from coupling.system import CoupledSystem
from coupling.turning import SpeedProfile

FloatArray = npt.NDArray[np.float64]

ENERGY_BOUND = 1e-2
_ROUNDING = 1e-9  # part of the stored energy that is rounding in a balance


@dataclass(frozen=True)
class EnergyBalance:
    """Energy balance of a time integration [J].

    Attributes
    ----------
    change : float
        Change of the kinetic energy and of the energy in springs and teeth.
    loads : float
        Work of the loads.
    lost : float
        Energy lost to damping.
    teeth : float
        Work of the rotation: of contacts whose stiffness and shape change under load, of rolling elements, and of
        friction on the coordinates.
    scale : float
        The largest of these, of the range of the stored energy, and of the kinetic energy at any step.
    friction : float
        Energy that tooth friction took from the nominal rotation, never negative: nearly all of it turned to heat, the
        rest went to the coordinates and is in ``teeth``. No part of the balance.
    """

    change: float
    loads: float
    lost: float
    teeth: float
    scale: float
    friction: float = 0.0

    @property
    def error(self) -> float:
        """Error of the balance, as a part of the scale."""
        return abs(self.change - self.loads + self.lost - self.teeth) / self.scale if self.scale > 0.0 else 0.0


@dataclass(frozen=True)
class TransientFigures:
    """Figures of a whole run; c contacts.

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
        Computing time of the steps, without compilation [s].
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


@dataclass(frozen=True, eq=False)
class TransientResult(TransientFigures, MotionRecord):
    """Record of a transient at even spacing, with the figures of the run."""


def simulate(
    system: CoupledSystem,
    settings: TransientSettings,
    outputs: TransientOutputs,
    *,
    turning: SpeedProfile | None = None,
    initial: tuple[FloatArray, FloatArray] | None = None,
    progress: Callable[[float], None] = lambda fraction: None,
) -> TransientResult:
    """Integrate the motion of the coupled system.

    Parameters
    ----------
    system : CoupledSystem
    settings : TransientSettings
    outputs : TransientOutputs
    turning : Turning, optional
        Speed over time; by default the nominal one.
    initial : tuple of ndarray, optional
        Coordinates and rates at t = 0, shape (n,) each; by default static equilibrium at rest.
    progress : callable
        Called with the finished part of the span, from 0 to 1.

    Raises
    ------
    TransientError
        Where the motion diverges, the step would have to be absurdly small, or the energies do not balance.

    See Also
    --------
    march_blocks : The same in blocks, for runs that are long or must be able to continue.
    """
    marched = integrate_blocks(system, settings, outputs, turning=turning, initial=initial, progress=progress)
    blocks = list(marched)
    figures = transient_figures(settings, blocks[-1].after)
    record: dict[str, Any] = {name: np.concatenate([getattr(block, name) for block in blocks]) for name in RECORDED}
    return TransientResult(**vars(figures), **record)


def transient_figures(settings: TransientSettings, end: Checkpoint) -> TransientFigures:
    """Figures of a run from its last checkpoint.

    Raises
    ------
    TransientError
        Where the energies do not balance.
    """
    # The rounding of the stored energy is no error of the balance.
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


def _balance(change: float, totals: FloatArray, held: float) -> EnergyBalance:
    loads, lost, teeth, motion, friction = (float(value) for value in totals)
    # Free vibration exchanges energy between motion and springs without any work or loss.
    scale = max(abs(loads), abs(lost), abs(teeth), held, motion)
    return EnergyBalance(change, loads, lost, teeth, scale, friction)
